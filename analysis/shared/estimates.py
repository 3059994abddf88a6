"""Medians and ratios with intervals that assume nothing about the distribution of times.

Repeats inside one process are not independent, so `by_round` first reduces each round (a fresh
process) to one number. Intervals run between order statistics, so their coverage follows from the
binomial distribution (David and Nagaraja, Order Statistics, section 7.1). It takes six rounds for
95 %. With fewer, the interval is the whole range, `coverage` says how likely it is to hold, and
nothing counts as separated.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
import scipy.stats

from analysis.shared.columns import Floats

CONFIDENCE = 0.95


@dataclass(frozen=True)
class Estimate:
    """A median or a ratio, with an interval that covers the true value with probability `coverage`
    or more.

    n = 0: no data, everything is NaN. n = 1: no interval, `low` and `high` are NaN and the coverage
    is 0. p_above and p_below apply to ratios only: one-sided p-values against "the true ratio is at
    most 1" and "at least 1". p_least is the smallest p-value that this number of rounds can give,
    whatever the data.
    """

    value: float
    low: float
    high: float
    n: int
    coverage: float
    p_above: float = 1.0
    p_below: float = 1.0
    p_least: float = 1.0
    reason: str = ""  # why there is no data

    @property
    def has_interval(self) -> bool:
        return math.isfinite(self.low) and math.isfinite(self.high)

    @property
    def separated(self) -> bool:
        """True if the interval of a ratio excludes 1 and its coverage is at least 95 %."""
        return (
            self.has_interval and self.coverage >= CONFIDENCE and not self.low <= 1.0 <= self.high
        )


NO_DATA = Estimate(math.nan, math.nan, math.nan, 0, 0.0)


def no_data(reason: str) -> Estimate:
    return replace(NO_DATA, reason=reason)


def by_round(rounds: Iterable[int], values: Iterable[float]) -> dict[int, float]:
    """Returns the median of the repeats of each round."""
    values_of_round: dict[int, list[float]] = {}
    for number, value in zip(rounds, values, strict=True):
        values_of_round.setdefault(int(number), []).append(float(value))
    return {number: float(np.median(repeats)) for number, repeats in values_of_round.items()}


def order_statistic_rank(n: int, confidence: float) -> int:
    """Returns the largest k for which [x_(k), x_(n+1-k)] covers the median with `confidence`; 0 if
    none does.

    x_(k) is the k-th smallest of n values, counted from 1.
    """
    below = scipy.stats.binom.cdf(
        np.arange((n + 1) // 2), n, 0.5
    )  # P(Binomial(n, 1/2) <= 0, 1, ...)
    return int(np.searchsorted(2 * below, 1 - confidence, side="right"))


def coverage_of_rank(n: int, k: int) -> float:
    """Returns the probability that the interval from the k-th smallest to the k-th largest of n
    values covers the median."""
    return float(1 - 2 * scipy.stats.binom.cdf(k - 1, n, 0.5))


def median(values: npt.ArrayLike, confidence: float = CONFIDENCE) -> Estimate:
    """Returns the sample median and its order-statistic interval.

    The values must be independent: one per round, or one per seed that has processes of its own.
    Raises ValueError for NaN.
    """
    x = np.sort(np.asarray(values, dtype=np.float64).ravel())
    n = len(x)
    if n == 0:
        return NO_DATA
    if np.isnan(x).any():
        raise ValueError("a time is NaN")
    middle = float(np.median(x))
    if n == 1:
        return Estimate(middle, math.nan, math.nan, 1, 0.0)
    k = max(1, order_statistic_rank(n, confidence))
    return Estimate(middle, float(x[k - 1]), float(x[n - k]), n, coverage_of_rank(n, k))


def ratio_of_medians(
    numerator: npt.ArrayLike, denominator: npt.ArrayLike, confidence: float = CONFIDENCE
) -> Estimate:
    """Returns median(numerator) / median(denominator) of positive times that cannot be paired.

    Each median gets an interval with half the error, and dividing their ends gives the interval of
    the ratio (Bonferroni). This is conservative and involves no resampling. An interval of 95 %
    needs seven values on each side.
    """
    half = 1 - (1 - confidence) / 2
    a, b = median(numerator, half), median(denominator, half)
    if a.n == 0 or b.n == 0 or b.value <= 0:
        return NO_DATA
    if not a.has_interval or not b.has_interval or b.low <= 0:
        return Estimate(a.value / b.value, math.nan, math.nan, min(a.n, b.n), 0.0)
    n = min(a.n, b.n)
    return Estimate(
        a.value / b.value,
        a.low / b.high,
        a.high / b.low,
        n,
        max(0.0, a.coverage + b.coverage - 1),
        _chance(numerator, denominator),
        _chance(denominator, numerator),
        min(1.0, 2 * 0.5**n),
    )


def _chance(greater: npt.ArrayLike, less: npt.ArrayLike) -> float:
    """Returns the one-sided p-value of median(greater) <= median(less): the least error at which
    their intervals are disjoint."""
    a, b = np.sort(np.asarray(greater, dtype=np.float64)), np.sort(
        np.asarray(less, dtype=np.float64)
    )
    tails = [scipy.stats.binom.cdf(np.arange((len(x) + 1) // 2), len(x), 0.5) for x in (a, b)]
    for tail in np.unique(np.concatenate(tails)):
        k, m = (int(np.searchsorted(levels, tail, side="right")) for levels in tails)
        if k and m and a[k - 1] > b[len(b) - m]:
            return min(1.0, 2 * float(tail))
    return 1.0


def ratio_by_round(
    numerator: Mapping[int, float], denominator: Mapping[int, float], confidence: float = CONFIDENCE
) -> Estimate:
    """Returns the paired_ratio() of the times in the rounds (or seeds) that both have; NO_DATA if
    there are none."""
    shared = sorted(numerator.keys() & denominator.keys())
    numerators = [numerator[i] for i in shared]
    denominators = [denominator[i] for i in shared]
    return paired_ratio(numerators, denominators, confidence)


def paired_ratio(
    numerator: npt.ArrayLike, denominator: npt.ArrayLike, confidence: float = CONFIDENCE
) -> Estimate:
    """Returns the median of the ratios of paired times, taken in alternation, with its sign-test
    interval."""
    a, b = np.asarray(numerator, dtype=np.float64), np.asarray(denominator, dtype=np.float64)
    if a.shape != b.shape:
        raise ValueError(f"{len(a)} times cannot be paired with {len(b)}")
    if (a <= 0).any() or (b <= 0).any():
        raise ValueError("a paired time is not positive")
    logs = median(np.log(a) - np.log(b), confidence)
    if logs.n == 0:
        return NO_DATA
    # A tie counts for neither direction, which makes both p-values conservative.
    p_above, p_below = (
        float(scipy.stats.binomtest(int(count), logs.n, alternative="greater").pvalue)
        for count in ((a > b).sum(), (a < b).sum())
    )
    return Estimate(
        math.exp(logs.value),
        math.exp(logs.low),
        math.exp(logs.high),
        logs.n,
        logs.coverage,
        p_above,
        p_below,
        0.5**logs.n,
    )


def student_half_width(values: Floats) -> float:
    """Returns the half width of Student's interval for the mean of at least two values.

    Its coverage is near 95 % unless a few values dominate the sum.
    """
    return float(
        scipy.stats.t.ppf((1 + CONFIDENCE) / 2, len(values) - 1)
        * np.std(values, ddof=1)
        / math.sqrt(len(values))
    )


def exact(ratio: float) -> Estimate:
    """Returns a ratio that is known without error, such as a ratio of deterministic counts."""
    if math.isnan(ratio):
        return NO_DATA
    return Estimate(
        ratio, ratio, ratio, 1, 1.0, 0.0 if ratio > 1 else 1.0, 0.0 if ratio < 1 else 1.0, 0.0
    )


def one_draw(ratio: float) -> Estimate:
    """Returns a ratio without an interval: the counts of a randomized solver that ran with a single
    seed."""
    return NO_DATA if math.isnan(ratio) else Estimate(ratio, math.nan, math.nan, 1, 0.0)


def ratio_of_counts(
    numerator: Mapping[int, float],
    denominator: Mapping[int, float],
    seeded: tuple[bool, bool] = (False, False),
) -> Estimate:
    """Returns the ratio of counts, which are given by seed. `seeded` says which of the two solvers
    are randomized.

    The ratio is exact if neither is. Counts of the same seed are paired. With a single seed it has
    no interval.
    """
    if (
        not numerator
        or not denominator
        or min(denominator.values()) <= 0
        or min(numerator.values()) <= 0
    ):
        return NO_DATA  # an external program counts nothing
    if not any(seeded):
        return exact(next(iter(numerator.values())) / next(iter(denominator.values())))
    if not seeded[0]:
        numerator = dict.fromkeys(denominator, next(iter(numerator.values())))
    if not seeded[1]:
        denominator = dict.fromkeys(numerator, next(iter(denominator.values())))
    if not (shared := sorted(numerator.keys() & denominator.keys())):
        return NO_DATA
    ratios = {seed: numerator[seed] / denominator[seed] for seed in shared}
    return (
        one_draw(ratios[shared[0]]) if len(shared) == 1 else ratio_by_round(numerator, denominator)
    )


def simes(chances: Iterable[float]) -> float:
    """Returns the p-value of "all of these null hypotheses are true" (Simes 1986): min over k of n
    * p_(k) / k.

    p_(k) is the k-th smallest of n p-values. The result is exact for independent p-values and
    conservative for positively dependent ones (Sarkar 1998). Ratios of different scenes are
    independent, as they come from different processes.
    """
    p = np.sort(np.fromiter(chances, dtype=np.float64))
    return float(min(1.0, (len(p) * p / np.arange(1, len(p) + 1)).min())) if len(p) else 1.0
