"""Intervals, which every bound of this package is, and the exception for those that do not decide a
question."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Union

Number = Union["Interval", float]


class Undecided(Exception):
    """An interval contains both answers to a yes/no question. `interval` holds, and says how much
    is known.

    The text says what may decide: a finer tolerance, more time, or another length.
    """

    interval: Interval | None

    def __init__(self, text: str, interval: Interval | None = None) -> None:
        super().__init__(text)
        self.interval = interval


def _outward(value: float, digits: int, up: bool) -> str:
    """Returns a number with this many significant digits, rounded up or down."""
    from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal

    if value == 0 or value - value != 0:  # infinite or NaN
        return f"{value:g}"
    rounded = Context(prec=digits, rounding=ROUND_CEILING if up else ROUND_FLOOR).plus(
        Decimal(value)
    )
    if not -5 <= rounded.adjusted() < 16:
        return f"{rounded.normalize():e}"
    return f"{rounded.normalize():f}"


class Interval:
    """A value between `lower` and `upper`, ends included: a distance with the unit of the input, or
    a share from 0 to 1.

    Comparisons never guess: `interval < 0.1` is True if every value inside is below 0.1, False if
    none is, and raises Undecided otherwise. float(interval) is an error: to report one number,
    report `upper`. Two intervals are equal (`==`) if both of their ends are equal. Printing rounds
    outward, so that the printed interval holds; repr() is exact.
    """

    __slots__ = ("_lower", "_upper")
    __array_ufunc__ = None  # numpy's scalars leave comparisons to this class
    _lower: float
    _upper: float

    def __init__(self, lower: float, upper: float) -> None:
        lower, upper = (
            float(end) if isinstance(end, float) else end for end in (lower, upper)
        )  # not numpy's, whose repr() is another one
        if not lower <= upper:
            raise ValueError(f"lower is {lower!r}, not at most upper, {upper!r}: exchange them")
        self._lower = lower
        self._upper = upper

    @property
    def lower(self) -> float:
        """The value is at least this."""
        return self._lower

    @property
    def upper(self) -> float:
        """The value is at most this."""
        return self._upper

    @property
    def width(self) -> float:
        """upper - lower, rounded."""
        return self._upper - self._lower

    def contains(self, value: float) -> bool:
        """Returns whether `value` may be the value."""
        return bool(self._lower <= exact(value) <= self._upper)

    def __iter__(self) -> Iterator[float]:
        """Gives the ends: lower, upper = interval."""
        return iter((self._lower, self._upper))

    def __eq__(self, other: object) -> bool:
        if isinstance(other, Interval):
            return self._lower == other._lower and self._upper == other._upper
        if hasattr(type(other), "__float__"):
            raise TypeError(
                "an interval does not equal a number: ask interval.contains(number), or compare with < or >"
            )
        return NotImplemented

    def __hash__(self) -> int:
        return hash((self._lower, self._upper))

    def __bool__(self) -> bool:
        raise TypeError("an interval is neither true nor false: compare it, as in interval > 0")

    def _decide(self, sign: str, other: Number, yes: bool, no: bool) -> bool:
        if yes or no:
            return bool(yes)  # not numpy's
        raise Undecided(
            f"{self} {sign} {other} is undecided: ask with a finer tolerance, or compare .lower or .upper",
            self,
        )

    def __lt__(self, other: Number) -> bool:
        lower, upper = _ends(other)
        return self._decide("<", other, self._upper < lower, self._lower >= upper)

    def __le__(self, other: Number) -> bool:
        lower, upper = _ends(other)
        return self._decide("<=", other, self._upper <= lower, self._lower > upper)

    def __gt__(self, other: Number) -> bool:
        lower, upper = _ends(other)
        return self._decide(">", other, self._lower > upper, self._upper <= lower)

    def __ge__(self, other: Number) -> bool:
        lower, upper = _ends(other)
        return self._decide(">=", other, self._lower >= upper, self._upper < lower)

    def __str__(self) -> str:
        return self.__format__("")

    def __format__(self, spec: str) -> str:
        """Formats with 9 significant digits, or with N for the format ".N" or ".Ng"."""
        digits = spec.removeprefix(".").removesuffix("g") if spec else "9"
        if not digits.isdecimal() or int(digits) < 1 or (spec and not spec.startswith(".")):
            raise ValueError(
                f"an interval has no format {spec!r}: give the number of digits, as in '.3g'"
            )
        return f"[{_outward(self._lower, int(digits), False)}, {_outward(self._upper, int(digits), True)}]"

    def __repr__(self) -> str:
        return f"Interval({self._lower!r}, {self._upper!r})"

    def __reduce__(self) -> tuple[type[Interval], tuple[float, float]]:
        return Interval, (self._lower, self._upper)


def _ends(value: Number) -> tuple[float, float]:
    if isinstance(value, Interval):
        return value._lower, value._upper
    if not hasattr(type(value), "__float__"):
        raise TypeError(f"an interval cannot be compared with a {type(value).__name__}")
    if value != value:
        raise ValueError("an interval cannot be compared with NaN")
    number = exact(value)
    return number, number


def exact(value: Any) -> Any:
    """Returns a scalar of numpy as one of Python, which compares numbers exactly; numpy would round
    its integers."""
    return value.item() if hasattr(value, "item") else value
