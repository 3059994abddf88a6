"""Means and wins over many pairs of shapes, and verdicts on them. The unit is the pair: it gives one ratio or one winner.

The pairs are treated as a sample of all pairs that could have been chosen, so an interval says how far the choice of
pairs may have moved a mean. It does not say how precise one time is: with one round per pair, noise widens the spread between pairs.
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

from analysis.shared import tables
from analysis.shared.columns import Floats
from analysis.shared.statistics import CONFIDENCE, NO_DATA, Estimate, student_half_width
from analysis.shared.verdicts import ERROR, FAILS, HOLDS, NOT_JUDGED, OPEN, UNTESTED, Ratio, Verdict, weighed, why

Wins = npt.NDArray[np.bool_]  # one per pair


def _student(x: Floats) -> Estimate:
    """Returns the mean with Student's interval, of 95 % if the values are normal. A single value has no interval."""
    middle = float(np.mean(x))
    if len(x) == 1:
        return Estimate(middle, math.nan, math.nan, 1, 0.0)
    half = student_half_width(x)
    return Estimate(middle, middle - half, middle + half, len(x), CONFIDENCE)


@functools.cache
def _chi_square(degrees: int) -> Floats:
    """Returns 400 equally likely values of the chi-square distribution."""
    return np.asarray(scipy.stats.chi2.ppf((np.arange(400) + 0.5) / 400, degrees))


def _lognormal(x: Floats) -> tuple[float, float]:
    """Returns the generalized confidence interval for the mean of lognormal values (Krishnamoorthy and Mathew 2003).

    It keeps its 95 % with few values too. Let m be the mean of the logarithms and v their variance. If v were known,
    the log of the mean would be normal about m + v/2, with variance v/n; v itself follows from the variance of the
    sample by a chi-square. The interval runs between the quantiles of this mixture, which are computed, not drawn at random.
    """
    logs, n = np.log(x), len(x)
    variance = np.var(logs, ddof=1) * (n - 1) / _chi_square(n - 1)
    if not variance.max() > 0:
        return float(x[0]), float(x[0])
    middle, deviation = np.mean(logs) + variance / 2, np.sqrt(variance / n)
    low, high = [scipy.optimize.brentq(lambda t, share=share: float(np.mean(scipy.special.ndtr((t - middle) / deviation))) - share,
                                       float((middle - 9 * deviation).min()), float((middle + 9 * deviation).max()))
                 for share in ((1 - CONFIDENCE) / 2, (1 + CONFIDENCE) / 2)]
    return math.exp(low), math.exp(high) if high < 700 else math.inf


def arithmetic_mean(ratios: npt.ArrayLike) -> Estimate:
    """Returns the mean of positive ratios. Its interval is of 95 % if the ratios are normal or lognormal.

    It contains both Student's interval and the one for lognormal ratios. Student's alone misses the mean of few skewed
    ratios far more often: for 5 to 10 lognormal ones in 10 % of the cases and more.
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
    """Returns the geometric mean of positive ratios: A/B and B/A give inverse means, and no outlier dominates it.

    The interval is Student's for the logarithms, so it is of 95 % if the ratios are lognormal.
    """
    x = np.asarray(ratios, dtype=np.float64).ravel()
    if not len(x):
        return NO_DATA
    logs = _student(np.log(x))
    return Estimate(math.exp(logs.value), math.exp(logs.low), math.exp(logs.high), logs.n, logs.coverage)


def mean_at_least(claim: str, mean: Estimate, bar: float, what: str) -> Verdict:
    """Judges a claim that the mean over all pairs that could have been chosen is at least `bar`.

    The verdict errs with at most 5 % if the interval of the mean is of 95 %; arithmetic_mean and geometric_mean say for
    which ratios it is.
    """
    if not mean.n:
        return Verdict(claim, UNTESTED, "no pair with both")
    known = mean.has_interval and mean.coverage >= CONFIDENCE
    outcome = HOLDS if known and mean.low >= bar else FAILS if known and mean.high < bar else OPEN
    return weighed(Verdict(claim, outcome, f"{what} {tables.estimate(mean)} over {mean.n} pairs", ratio=Ratio.of(mean, bar)), [mean])


def on_average(claim: str, ratios: Sequence[Estimate], bar: float = 1.0) -> Verdict:
    """Judges a claim that ratios are above `bar` on average, by their geometric mean over the pairs.

    Pairs without a ratio leave it open.
    """
    known = [x.value for x in ratios if x.n]
    if not known:
        return Verdict(claim, UNTESTED, f"no pair with both{why(ratios)}")
    mean = geometric_mean(known)
    verdict = mean_at_least(claim, mean, bar, "geometric mean")
    if verdict.outcome == HOLDS and not mean.low > bar:  # for example if all counts are the same
        return replace(verdict, outcome=OPEN)
    if len(known) < len(ratios):
        return replace(verdict, outcome=verdict.outcome if verdict.outcome == NOT_JUDGED else OPEN, evidence=f"{verdict.evidence}, no ratio for {len(ratios) - len(known)}{why(ratios)}")
    return verdict


def share_near(claim: str, count: int, of: int, share: float, within: float) -> Verdict:
    """Judges a claim that this share of the pairs has a property, to within `within`, by the interval of Clopper and Pearson."""
    if not of:
        return Verdict(claim, UNTESTED, "no pairs")
    found = scipy.stats.binomtest(count, of).proportion_ci(CONFIDENCE, method="exact")
    inside = share - within <= found.low and found.high <= share + within
    outside = found.high < share - within or found.low > share + within
    percent = [tables.number(100 * x) for x in (count / of, found.low, found.high)]
    return Verdict(claim, HOLDS if inside else FAILS if outside else OPEN,
                   f"{count} of {of} pairs, {percent[0]} % [{percent[1]}, {percent[2]}]; near means within "
                   f"{100 * within:g} points")


def chance(more: Wins, less: Wins) -> float:
    """Returns the one-sided p-value of "`more` wins no more often than `less`".

    Pairs that only one of them wins are tosses of a coin (McNemar's exact test). Without such a pair the p-value is 1.
    """
    ours, theirs = int((more & ~less).sum()), int((less & ~more).sum())
    return float(scipy.stats.binomtest(ours, ours + theirs, alternative="greater").pvalue) if ours + theirs else 1.0


def wins_more(claim: str, ahead: Mapping[str, Wins], behind: Mapping[str, Wins], verb: str = "wins") -> Verdict:
    """Judges a claim that each of `ahead` wins more pairs than each of `behind`.

    It holds if every comparison is separated; no correction is needed (an intersection-union test, Berger 1982). It
    does not hold if some comparison is separated the other way; these comparisons depend on each other, so the least
    p-value is multiplied by their number (Bonferroni).
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
    ours = f"{least} {verb} {int(ahead[least].sum())}" + (f", the fewest of {len(ahead)}," if len(ahead) > 1 else "")
    parts = [f"{ours} of {pairs} pairs, and "
             + (f"of the others {best} most: " if len(behind) > 1 else f"{best} ") + f"{int(behind[best].sum())}",
             f"{sum(clear)} of {len(both)} comparisons separated" if len(both) > 1 else ""] \
        + [f"more: {', '.join(f'{b} than {a}' for a, b in against[:3])}"] * (len(both) > 1 and bool(against))
    return Verdict(claim, outcome, "; ".join(part for part in parts if part))


def shared_wins(costs: Mapping[str, Sequence[float]], within: float = 1.05) -> dict[str, Wins]:
    """Returns the winners of each pair: all whose cost is at most `within` times the least. NaN means no answer, and never wins."""
    if not costs:
        return {}
    table = np.array([np.asarray(cost, dtype=np.float64) for cost in costs.values()])
    least = np.min(np.where(np.isnan(table), np.inf, table), axis=0, initial=np.inf)
    return {name: np.asarray(row <= within * least) & np.isfinite(row) for name, row in zip(costs, table)}
