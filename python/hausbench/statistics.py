"""Statistics of the distance between two shapes."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, NoReturn

from hausbench.answers import STATUSES
from hausbench.arguments import number
from hausbench.errors import InputError
from hausbench.interval import Interval
from hausbench.options import INFINITY, progress_of

if TYPE_CHECKING:
    from hausbench._core import Pair, Query

OVER = ("source", "target", "larger", "mean_of_both", "harmonic_mean", "pooled")


def _listed(values: object) -> list[object]:
    """Returns the values of an iterable, or the one value that was given."""
    if (
        isinstance(values, Iterable)
        and not isinstance(values, (str, bytes))
        and getattr(values, "ndim", 1) > 0
    ):
        return list(values)
    return [values]


def _quantile(level: object) -> str:
    value = number(level, "quantiles")
    if not 0 < value <= 1:
        raise InputError(
            f"quantiles: the level {level!r} is not above 0 and at most 1: the 95 % quantile has the level 0.95"
        )
    return f"quantile {value!r}"


def _share(length: object) -> str:
    value = number(length, "within")
    if not 0 <= value < INFINITY:
        raise InputError(f"within: {length!r} is not a length: give a finite number of at least 0")
    return f"within {value!r}"


class Distribution:
    """Bounds of statistics, made by `hausbench.distribution`. What was not listed there is computed
    on first use and kept."""

    def __init__(
        self,
        pair: Pair,
        query: Query,
        over: str,
        statistics: object,
        quantiles: object,
        within: object,
        progress: Callable[[dict[str, Interval]], object] | None = None,
    ) -> None:
        if over not in OVER:
            raise InputError(f"over: {over!r} is not one of {', '.join(OVER)}")
        others = [*map(_quantile, _listed(quantiles)), *map(_share, _listed(within))]
        names = _listed(statistics) if statistics is not None else [] if others else ["mean", "rms"]
        self._pair, self._query, self._progress = pair, query, progress
        self._over = "" if over == "source" else f" {over}"
        self._known: dict[str, Interval] = {}
        self._status = "converged"
        self._ask([*map(str, names), *others])

    def _ask(self, wanted: list[str]) -> None:
        names = list(dict.fromkeys(wanted))
        if not names:
            return
        full_names = [name + self._over for name in names]
        bounds, answer = self._pair.distribution(
            full_names, self._query, progress_of(self._progress, names)
        )
        self._status = STATUSES[answer[0]]
        self._known.update(
            (name, Interval(lower, upper)) for name, (lower, upper) in zip(names, bounds)
        )

    def _get(self, name: str) -> Interval:
        if name not in self._known:
            self._ask([name])
        return self._known[name]

    def __getitem__(self, name: str) -> Interval:
        """Returns a statistic by its name, such as "mean" or "quantile 0.95"."""
        return self._get(name)

    @property
    def status(self) -> str:
        """Why the last run ended, see Answer."""
        return self._status

    @property
    def mean(self) -> Interval:
        """The mean distance."""
        return self._get("mean")

    @property
    def rms(self) -> Interval:
        """The root of the mean of the squared distance."""
        return self._get("rms")

    @property
    def deviation(self) -> Interval:
        """The standard deviation."""
        return self._get("deviation")

    @property
    def maximum(self) -> Interval:
        """The largest distance: h(A,B) over the source, H(A,B) for "larger"."""
        return self._get("maximum")

    @property
    def median(self) -> Interval:
        """The quantile of level 0.5."""
        return self._get("median")

    def quantile(self, level: float) -> Interval:
        """Returns the least length t such that a share of at least `level` (above 0, at most 1) is
        at most t away."""
        return self._get(_quantile(level))

    def share_within(self, length: float) -> Interval:
        """Returns the share, from 0 to 1, that is at most `length` away."""
        return self._get(_share(length))

    def __reduce__(self) -> NoReturn:
        raise TypeError("a Distribution cannot be pickled: take the intervals that you need")

    def __repr__(self) -> str:
        return f"<Distribution: {', '.join(f'{name} {value}' for name, value in self._known.items()) or 'nothing asked yet'}>"
