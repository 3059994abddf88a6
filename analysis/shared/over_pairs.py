"""Judges claims over many pairs of shapes, each of which gives one ratio or one winner.

The pairs count as a random sample of all possible pairs, so an interval says how much the choice of
pairs may have moved the mean. Noise in single times widens it too.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt
import scipy.optimize
import scipy.special
import scipy.stats

from analysis.shared import numerals
from analysis.shared.columns import Floats
from analysis.shared.estimates import CONFIDENCE, NO_DATA, Estimate, student_half_width
from analysis.shared.verdicts import (
    ERROR,
    FAILS,
    HOLDS,
    NOT_JUDGED,
    OPEN,
    UNTESTED,
    Ratio,
    Verdict,
    weighed,
    why,
)

Wins = npt.NDArray[np.bool_]  # one per pair


def _student(x: Floats) -> Estimate:
    """Returns the mean with Student's 95 % interval (exact for normal values). A single value has
    no interval."""
    middle = float(np.mean(x))
    if len(x) == 1:
        return Estimate(middle, math.nan, math.nan, 1, 0.0)
    half = student_half_width(x)
    return Estimate(middle, middle - half, middle + half, len(x), CONFIDENCE)


@functools.cache
def _chi_square(degrees: int) -> Floats:
    """Returns 400 quantiles of the chi-square distribution at equal steps of probability."""
    return np.asarray(scipy.stats.chi2.ppf((np.arange(400) + 0.5) / 400, degrees))


def _lognormal(x: Floats) -> tuple[float, float]:
    """Returns the generalized confidence interval for the mean of lognormal values (Krishnamoorthy
    and Mathew 2003).

    It covers 95 % even for few values. Let m be the mean of the n logarithms and v their variance.
    If v were known, the log of the mean would be normal about m + v/2, with variance v/n. For v
    itself we take 400 equally likely values: the sample variance times (n - 1), over quantiles of
    the chi-square distribution. The interval runs between quantiles of this mixture.
    """
    logs, n = np.log(x), len(x)
    variance = np.var(logs, ddof=1) * (n - 1) / _chi_square(n - 1)
    if not variance.max() > 0:
        return float(x[0]), float(x[0])
    middle, deviation = np.mean(logs) + variance / 2, np.sqrt(variance / n)
    low, high = [
        scipy.optimize.brentq(
            lambda t, share=share: float(np.mean(scipy.special.ndtr((t - middle) / deviation)))
            - share,
            float((middle - 9 * deviation).min()),
            float((middle + 9 * deviation).max()),
        )
        for share in ((1 - CONFIDENCE) / 2, (1 + CONFIDENCE) / 2)
    ]
    return math.exp(low), math.exp(high) if high < 700 else math.inf


def arithmetic_mean(ratios: npt.ArrayLike) -> Estimate:
    """Returns the mean of positive ratios, with an interval of 95 % for normal and for lognormal
    ratios.

    The interval contains both Student's and the lognormal one. Student's alone would miss the mean
    of 5 to 10 lognormal ratios in 10 % of the cases or more.
    """
    x = np.asarray(ratios, dtype=np.float64).ravel()
    if not len(x):
        return NO_DATA
    mean = _student(x)
    if mean.n == 1:
        return mean
    low, high = _lognormal(x)
    return replace(mean, low=min(mean.low, low), high=max(mean.high, high))


def geometric_mean(ratios: npt.ArrayLike) -> Estimate:
    """Returns the geometric mean of positive ratios: A/B and B/A have inverse means, and no outlier
    dominates.

    The interval is Student's for the logarithms, so it covers 95 % if the ratios are lognormal.
    """
    x = np.asarray(ratios, dtype=np.float64).ravel()
    if not len(x):
        return NO_DATA
    logs = _student(np.log(x))
    return Estimate(
        math.exp(logs.value), math.exp(logs.low), math.exp(logs.high), logs.n, logs.coverage
    )


def mean_at_least(claim: str, mean: Estimate, bar: float, what: str) -> Verdict:
    """Judges a claim that the mean over all possible pairs is at least `bar`.

    The verdict is wrong in at most 5 % of cases if the interval covers 95 %; see arithmetic_mean
    and geometric_mean.
    """
    if not mean.n:
        return Verdict(claim, UNTESTED, "no pair with both")
    reliable = mean.has_interval and mean.coverage >= CONFIDENCE
    outcome = (
        HOLDS if reliable and mean.low >= bar else FAILS if reliable and mean.high < bar else OPEN
    )
    return weighed(
        Verdict(
            claim,
            outcome,
            f"{what} {numerals.estimate(mean, limit=bar)} over {mean.n} pairs",
            ratio=Ratio.of(mean, bar),
        ),
        [mean],
    )


def on_average(claim: str, ratios: Sequence[Estimate], bar: float = 1.0) -> Verdict:
    """Judges a claim that ratios are above `bar` on average, by their geometric mean over the
    pairs.

    The outcome is 'not separated' if some pair has no ratio.
    """
    values = [x.value for x in ratios if x.n]
    if not values:
        return Verdict(claim, UNTESTED, f"no pair with both{why(ratios)}")
    mean = geometric_mean(values)
    verdict = mean_at_least(claim, mean, bar, "geometric mean")
    if (
        verdict.outcome == HOLDS and not mean.low > bar
    ):  # low == bar, for example if all counts are equal
        return replace(verdict, outcome=OPEN)
    if len(values) < len(ratios):
        return replace(
            verdict,
            outcome=verdict.outcome if verdict.outcome == NOT_JUDGED else OPEN,
            evidence=f"{verdict.evidence}, no ratio for {len(ratios) - len(values)}{why(ratios)}",
        )
    return verdict


def share_near(claim: str, count: int, of: int, share: float, within: float) -> Verdict:
    """Judges a claim that a property is found in `share` of the pairs, plus or minus `within`
    (Clopper-Pearson interval)."""
    if not of:
        return Verdict(claim, UNTESTED, "no pairs")
    interval = scipy.stats.binomtest(count, of).proportion_ci(CONFIDENCE, method="exact")
    inside = share - within <= interval.low and interval.high <= share + within
    outside = interval.high < share - within or interval.low > share + within
    return Verdict(
        claim,
        HOLDS if inside else FAILS if outside else OPEN,
        f"{count} of {of} pairs, {numerals.number(100 * count / of)} % {numerals.bounds(interval.low, interval.high, times=100)}; near means within "
        f"{100 * within:g} points",
    )


def chance(more: Wins, less: Wins) -> float:
    """Returns the one-sided p-value of "`more` wins no more often than `less`", by McNemar's exact
    test.

    The test uses only pairs that exactly one of the two wins. Without such a pair the p-value is 1.
    """
    only_more, only_less = int((more & ~less).sum()), int((less & ~more).sum())
    return (
        float(scipy.stats.binomtest(only_more, only_more + only_less, alternative="greater").pvalue)
        if only_more + only_less
        else 1.0
    )


def wins_more(
    claim: str, ahead: Mapping[str, Wins], behind: Mapping[str, Wins], verb: str = "wins"
) -> Verdict:
    """Judges a claim that each of `ahead` wins more pairs than each of `behind`.

    It holds if every comparison is significant, without correction (an intersection-union test,
    Berger 1982). It does not hold if some comparison is significant in the other direction, after
    multiplying the least p-value by the number of comparisons (Bonferroni), because they depend on
    each other.
    """
    both = [(a, b) for a in ahead for b in behind]
    pairs = len(next(iter(ahead.values()))) if ahead else 0
    if not both or not pairs:
        return Verdict(claim, UNTESTED, "no pairs" if not pairs else "nothing to compare with")
    clear = [chance(ahead[a], behind[b]) <= ERROR for a, b in both]
    against = [(a, b) for a, b in both if chance(behind[b], ahead[a]) * len(both) <= ERROR]
    outcome = FAILS if against else HOLDS if all(clear) else OPEN
    best = max(behind, key=lambda name: int(behind[name].sum()))
    least = min(ahead, key=lambda name: int(ahead[name].sum()))
    ours = f"{least} {verb} {int(ahead[least].sum())}" + (
        f", the fewest of {len(ahead)}," if len(ahead) > 1 else ""
    )
    parts = [
        f"{ours} of {pairs} pairs, and "
        + (f"of the others {best} most: " if len(behind) > 1 else f"{best} ")
        + f"{int(behind[best].sum())}",
        f"{sum(clear)} of {len(both)} comparisons separated in its favour" if len(both) > 1 else "",
    ]
    if len(both) > 1 and against:
        parts.append(
            f"separated against it: {', '.join(f'{b} more often than {a}' for a, b in against[:3])}"
        )
    return Verdict(claim, outcome, "; ".join(part for part in parts if part))


def shared_wins(costs: Mapping[str, Sequence[float]], within: float = 1.05) -> dict[str, Wins]:
    """Returns the pairs that each solver wins: its cost is at most `within` times the least cost.
    NaN (no answer) never wins."""
    if not costs:
        return {}
    table = np.array([np.asarray(cost, dtype=np.float64) for cost in costs.values()])
    least = np.min(np.where(np.isnan(table), np.inf, table), axis=0, initial=np.inf)
    return {
        name: np.asarray(row <= within * least) & np.isfinite(row)
        for name, row in zip(costs, table)
    }
