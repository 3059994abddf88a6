"""Formats numbers for tables and text: rounded to nearest, or outward if they are bounds."""

from __future__ import annotations

import math
from collections.abc import Iterable
from decimal import ROUND_CEILING, ROUND_FLOOR, ROUND_HALF_EVEN, Context, Decimal

from analysis.shared.estimates import CONFIDENCE, Estimate

NOTHING = "—"  # not measured, or unknown


def _rounded(
    x: float | Decimal, digits: int, rounding: str, times: float = 1.0, over: float = 1.0
) -> str:
    """Formats x * times / over, rounded once; `times` and `over` are positive."""
    if math.isnan(x) or math.isnan(over):
        return NOTHING
    if math.isinf(x):
        return "inf" if x > 0 else "-inf"
    if x == 0:
        return "0"
    context = Context(prec=800, rounding=rounding)
    value = context.divide(
        context.multiply(x if isinstance(x, Decimal) else Decimal(float(x)), Decimal(float(times))),
        Decimal(float(over)),
    )
    exponent = value.adjusted()
    if exponent < -4 or exponent > 9:
        (
            mantissa,
            power,
        ) = f"{Context(prec=digits, rounding=rounding).plus(value):.{digits - 1}e}".split("e")
        return f"{mantissa}e{int(power)}"
    decimals = max(0, digits - 1 - exponent)
    rounded = value.quantize(Decimal(1).scaleb(-decimals), context=context)
    return f"{rounded:.{max(0, decimals - 1) if rounded.adjusted() > exponent else decimals}f}"


def number(x: float, digits: int = 3) -> str:
    """Formats x with `digits` significant digits; below 1e10, digits before the point are not
    rounded. NaN becomes '—'."""
    return _rounded(x, digits, ROUND_HALF_EVEN)


def at_least(low: float | Decimal, digits: int = 3, times: float = 1.0, over: float = 1.0) -> str:
    """Formats the lower bound low * times / over like number(), rounded down, so that it is still a
    bound."""
    return _rounded(low, digits, ROUND_FLOOR, times, over)


def at_most(high: float | Decimal, digits: int = 3, times: float = 1.0, over: float = 1.0) -> str:
    """Formats the upper bound high * times / over like number(), rounded up, so that it is still a
    bound."""
    return _rounded(high, digits, ROUND_CEILING, times, over)


def bounds(
    low: float | Decimal,
    high: float | Decimal,
    digits: int = 3,
    times: float = 1.0,
    over: float = 1.0,
    limit: float = math.nan,
    form: str = "[{}, {}]",
) -> str:
    """Formats an interval, rounded outward: '[1.50, 2.51]'. If it excludes `limit`, it gets as many
    digits as show this."""

    def excludes(least: float, most: float) -> bool:
        return least > limit or most < limit

    if math.isnan(low) or math.isnan(high):
        return NOTHING
    ends = at_least(low, digits, times, over), at_most(high, digits, times, over)
    if (
        digits < 20
        and excludes(float(low) * times / over, float(high) * times / over)
        and not excludes(*map(float, ends))
    ):
        return bounds(low, high, digits + 1, times, over, limit, form)
    return form.format(*ends)


def value(low: float, high: float, digits: int = 3, over: float = 1.0) -> str:
    """Formats a value that lies in [low, high], over `over`: rounded, if both ends round to the
    same text; otherwise as the interval."""
    ends = {_rounded(end, digits, ROUND_HALF_EVEN, over=over) for end in (low, high)}
    return ends.pop() if len(ends) == 1 else bounds(low, high, digits, over=over)


def estimate(x: Estimate, scale: float = 1.0, limit: float = math.nan) -> str:
    """Formats an estimate and its interval: '2.10 [2.05, 2.31]'; '2.10' without an interval, '—'
    without data. The ends are statistics and no bounds, so they are rounded to nearest; if the
    interval excludes `limit`, they get as many digits as show this.
    """
    if x.n == 0:
        return NOTHING
    if not x.has_interval or x.n == 1:  # a single time, or a count, which is exact
        return number(x.value * scale)
    for digits in range(3, 17):
        low, high = number(x.low * scale, digits), number(x.high * scale, digits)
        if not (x.low * scale > limit >= float(low) or x.high * scale < limit <= float(high)):
            break
    return f"{number(x.value * scale)} [{low}, {high}]"


def ends(low: float, high: float) -> str:
    """Formats the interval of a statistic, such as an exponent, with two decimals, rounded to
    nearest."""
    return f"[{low:.2f}, {high:.2f}]"


def ratio(x: Estimate) -> str:
    """Formats a ratio like estimate(), and adds '(not separated)' if its interval contains 1, or
    '(not judged, n = 3)' if n is too small for 95 %.
    """
    if x.n == 0:
        return NOTHING
    return (
        estimate(x, limit=1.0)
        if x.separated
        else f"{estimate(x)} ({f'not judged, n = {x.n}' if x.coverage < CONFIDENCE else 'not separated'})"
    )


def time_unit(seconds: Iterable[float]) -> tuple[str, float]:
    """Chooses the unit for a table of times: ('ms', 1000) if their median is below 0.1 s, else
    ('s', 1)."""
    finite = sorted(x for x in seconds if math.isfinite(x))
    return ("ms", 1000.0) if finite and finite[len(finite) // 2] < 0.1 else ("s", 1.0)
