"""Medians and ratios with intervals that assume nothing about the distribution of times.

Pure functions. An interval runs between order statistics, so its coverage follows from the binomial distribution alone
(David and Nagaraja, Order Statistics, section 7.1). Few repeats cannot give 95 %: the interval is then the whole range,
and `coverage` says what it is worth.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Estimate:
    """A median or a ratio, with the interval that covers the true one with probability `coverage` or more.

    n = 0: no data, everything is NaN. n = 1: no interval, `low` and `high` are NaN and the coverage is 0.
    """

    value: float
    low: float
    high: float
    n: int
    coverage: float

    @property
    def has_interval(self) -> bool:
        return math.isfinite(self.low) and math.isfinite(self.high)

    @property
    def separated(self) -> bool:
        """For a ratio: the interval leaves out 1. Without an interval nothing is separated."""
        return self.has_interval and not self.low <= 1.0 <= self.high

    def shifted(self, by: float) -> Estimate:
        return Estimate(self.value + by, self.low + by, self.high + by, self.n, self.coverage)


NO_DATA = Estimate(math.nan, math.nan, math.nan, 0, 0.0)


def order_statistic_rank(n: int, confidence: float) -> int:
    """The largest k for which [x_(k), x_(n+1-k)] (1-based) covers the median with `confidence`, or 0 if none does."""
    k, tail, term = 0, 0.0, 0.5**n
    for i in range(n // 2):
        tail += term  # P(Binomial(n, 1/2) <= i)
        if 2 * tail > 1 - confidence:
            break
        k = i + 1
        term *= (n - i) / (i + 1)
    return k


def coverage_of_rank(n: int, k: int) -> float:
    """The probability that [x_(k), x_(n+1-k)] covers the median of a continuous distribution."""
    return float(1 - 2 * sum(math.comb(n, i) for i in range(k)) / 2**n)


def median(values: npt.ArrayLike, confidence: float = 0.95) -> Estimate:
    """The sample median and its order-statistic interval. NaNs are the caller's mistake: ValueError. O(n log n)."""
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


def ratio_of_medians(numerator: npt.ArrayLike, denominator: npt.ArrayLike, confidence: float = 0.95) -> Estimate:
    """median(numerator) / median(denominator) of positive times measured apart.

    Each median gets an interval of half the error; the ratio of their ends covers by Bonferroni. Conservative, and the
    same on every machine (no resampling).
    """
    half = 1 - (1 - confidence) / 2
    a, b = median(numerator, half), median(denominator, half)
    if a.n == 0 or b.n == 0 or b.value <= 0:
        return NO_DATA
    if not a.has_interval or not b.has_interval or b.low <= 0:
        return Estimate(a.value / b.value, math.nan, math.nan, min(a.n, b.n), 0.0)
    return Estimate(a.value / b.value, a.low / b.high, a.high / b.low, min(a.n, b.n),
                    max(0.0, a.coverage + b.coverage - 1))


def ratio_by_round(numerator: dict[int, float], denominator: dict[int, float],
                   confidence: float = 0.95) -> Estimate:
    """Of times by round, measured side by side; NO_DATA where too few rounds are shared for the confidence."""
    rounds = sorted(numerator.keys() & denominator.keys())
    if order_statistic_rank(len(rounds), confidence) == 0:
        return NO_DATA
    return paired_ratio([numerator[i] for i in rounds], [denominator[i] for i in rounds], confidence)


def paired_ratio(numerator: npt.ArrayLike, denominator: npt.ArrayLike, confidence: float = 0.95) -> Estimate:
    """The median of the ratios of pairs that were measured side by side (interleaved), with its sign-test interval."""
    a, b = np.asarray(numerator, dtype=np.float64), np.asarray(denominator, dtype=np.float64)
    if a.shape != b.shape:
        raise ValueError(f"{len(a)} times cannot be paired with {len(b)}")
    if (a <= 0).any() or (b <= 0).any():
        raise ValueError("a paired time is not positive")
    logs = median(np.log(a) - np.log(b), confidence)
    return Estimate(math.exp(logs.value), math.exp(logs.low), math.exp(logs.high), logs.n, logs.coverage)
