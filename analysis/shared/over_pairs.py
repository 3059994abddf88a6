"""Means and wins over many pairs of shapes, and verdicts on them. The unit is the pair: one ratio, or one winner, a pair.

The pairs are taken for a sample of all that could have been chosen, so an interval says how far the choice of pairs may have
moved a mean. What one time is worth is another question: with one round a pair, noise widens the spread between pairs.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt
import scipy.stats

from analysis.shared import tables
from analysis.shared.statistics import CONFIDENCE, NO_DATA, Estimate, student_half_width
from analysis.shared.verdicts import ERROR, FAILS, HOLDS, OPEN, UNTESTED, Verdict

Wins = npt.NDArray[np.bool_]  # one a pair


def arithmetic_mean(values: npt.ArrayLike) -> Estimate:
    """The mean with Student's interval, which is near 95 % where pairs are many and no few of them make the sum. One value has
    no interval.
    """
    x = np.asarray(values, dtype=np.float64).ravel()
    if not len(x):
        return NO_DATA
    middle = float(np.mean(x))
    if len(x) == 1:
        return Estimate(middle, math.nan, math.nan, 1, 0.0)
    half = student_half_width(x)
    return Estimate(middle, middle - half, middle + half, len(x), CONFIDENCE)


def geometric_mean(ratios: npt.ArrayLike) -> Estimate:
    """The same of the logarithms of positive ratios: A/B and B/A give inverse means, and no outlier rules it."""
    logs = arithmetic_mean(np.log(np.asarray(ratios, dtype=np.float64)))
    if not logs.n:
        return NO_DATA
    return Estimate(math.exp(logs.value), math.exp(logs.low), math.exp(logs.high), logs.n, logs.coverage)


def mean_at_least(claim: str, mean: Estimate, bar: float, what: str) -> Verdict:
    """A claim that a mean over pairs is `bar` or more."""
    if not mean.n:
        return Verdict(claim, UNTESTED, "no pair with both")
    known = mean.has_interval and mean.coverage >= CONFIDENCE
    outcome = HOLDS if known and mean.low >= bar else FAILS if known and mean.high < bar else OPEN
    return Verdict(claim, outcome, f"{what} {tables.estimate(mean)} over {mean.n} pairs")


def share_near(claim: str, count: int, of: int, share: float, within: float) -> Verdict:
    """A claim that so large a share of the pairs is something, to within `within`: by the interval of Clopper and Pearson."""
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
    """One-sided p-value of "`more` wins no more often than `less`": pairs that one of them alone wins are tosses of a coin
    (McNemar's exact test). Without such a pair 1.
    """
    ours, theirs = int((more & ~less).sum()), int((less & ~more).sum())
    return float(scipy.stats.binomtest(ours, ours + theirs, alternative="greater").pvalue) if ours + theirs else 1.0


def wins_more(claim: str, ahead: Mapping[str, Wins], behind: Mapping[str, Wins], verb: str = "wins") -> Verdict:
    """A claim that each of `ahead` wins more pairs than each of `behind`.

    It holds where every comparison is separated: no correction is needed (an intersection-union test, Berger 1982). It does not hold
    where some comparison is separated the other way; these depend on each other, so the least p-value is multiplied by
    their number (Bonferroni).
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
    """Who wins each pair: all whose cost is at most `within` times the least. NaN: no answer, which never wins."""
    if not costs:
        return {}
    table = np.array([np.asarray(cost, dtype=np.float64) for cost in costs.values()])
    least = np.min(np.where(np.isnan(table), np.inf, table), axis=0, initial=np.inf)
    return {name: np.asarray(row <= within * least) & np.isfinite(row) for name, row in zip(costs, table)}
