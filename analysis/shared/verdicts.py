"""Judges a paper's claims by the data: 'holds', 'does not hold', 'not separated' or 'not judged'.

'Not separated' means that times are too few or too noisy to decide. A verdict is wrong with a
probability of at most 5 %; the docstrings say how this is kept over many ratios. Claims about time
are also judged in counted work, which does not depend on the machine.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import Final

import numpy as np
import scipy.stats

from analysis.shared import numerals
from analysis.shared.estimates import NO_DATA, Estimate, median, simes

HOLDS: Final = "holds"
FAILS: Final = "does not hold"
OPEN: Final = "not separated"
NOT_JUDGED: Final = "not judged"  # too few rounds for any verdict (n < 6 for one ratio)
NOT_REFUTED: Final = "not refuted"  # in place of HOLDS for claims that no number of cases can prove
UNTESTED: Final = "not tested"  # no data
OUTCOMES: Final = (HOLDS, FAILS, OPEN, NOT_JUDGED, NOT_REFUTED, UNTESTED)

ERROR: Final = 0.05
RARE: Final = (
    0.1  # "never" counts as not refuted only after enough trials to exclude this failure rate
)


@dataclass(frozen=True)
class Ratio:
    """A ratio measured / claimed; values above 1 support the claim.

    `low` and `high` are the ends of its interval: NaN for a single time, equal to `value` for a
    count. If `value` is NaN, they are the least and the greatest of several ratios.
    """

    value: float
    low: float
    high: float

    @staticmethod
    def of(x: Estimate, claimed: float = 1.0) -> Ratio:
        return Ratio(x.value / claimed, x.low / claimed, x.high / claimed)


@dataclass(frozen=True)
class Verdict:
    claim: str
    outcome: str
    evidence: str
    counted: dict[str, Verdict] = field(default_factory=dict)  # by the kind of counted work
    ratio: Ratio | None = None  # for claims about ratios

    def with_counts(self, counted: dict[str, Verdict]) -> Verdict:
        return replace(self, counted=counted)

    def line(self) -> str:
        here = "Here it" if self.outcome in (HOLDS, FAILS) else "Here:"
        text = f"Claim: {self.claim}. {here} {self.outcome} ({self.evidence})."
        if self.counted:
            text += (
                " Counted in "
                + "; in ".join(
                    f"{measure} it {'' if verdict.outcome in (HOLDS, FAILS) else 'is '}{verdict.outcome} ({verdict.evidence})"
                    for measure, verdict in self.counted.items()
                )
                + "."
            )
        return text


def weighed(verdict: Verdict, ratios: Iterable[Estimate]) -> Verdict:
    """Replaces 'not separated' with 'not judged' if some ratio has too few rounds for an interval
    of 95 %."""
    n = min((x.n for x in ratios if x.n and x.coverage < 1 - ERROR), default=0)
    return (
        replace(verdict, outcome=NOT_JUDGED, evidence=f"n = {n}; {verdict.evidence}")
        if n and verdict.outcome == OPEN
        else verdict
    )


def everywhere(claim: str, ratios: Sequence[Estimate], what: str = "pairs") -> Verdict:
    """Judges a claim that every one of the ratios is above 1.

    It holds if each ratio is known and separated above 1. This needs no correction (an
    intersection-union test, Berger 1982): if one ratio is truly not above 1, the verdict is wrong
    only if that ratio is separated too, which happens with at most 5 %. It does not hold if some
    ratio is below 1. Here each ratio adds a chance to err, so Simes' test of "none is below 1"
    combines their one-sided sign tests, with an error of 5 % in total.
    """
    known_ratios = [x for x in ratios if x.n]
    if not known_ratios:
        return Verdict(claim, UNTESTED, f"no ratios{why(ratios)}")
    above = sum(x.separated and x.low > 1 for x in known_ratios)
    below = sum(x.separated and x.high < 1 for x in known_ratios)
    outcome = (
        HOLDS
        if above == len(ratios)
        else FAILS
        if simes(x.p_below for x in known_ratios) <= ERROR
        else OPEN
    )
    values = [x.value for x in known_ratios]
    least, most = min(values), max(values)
    rest, lost = len(known_ratios) - above - below, len(ratios) - len(known_ratios)
    hopeless = simes(x.p_least for x in known_ratios) > ERROR
    parts = [f"above 1 for {above} of {len(known_ratios)} {what}"]
    if below:
        parts.append(f"below 1 for {below}")
    if rest:
        parts.append(f"not separated for {rest}")
    if lost:
        parts.append(f"no ratio for {lost}{why(ratios)}")
    parts.append(f"ratio {numerals.bounds(least, most, limit=1.0, form='{} to {}')}")
    if outcome == OPEN:
        parts.append(power_of(known_ratios, what))
    verdict = Verdict(
        claim,
        outcome,
        ", ".join(part for part in parts if part),
        ratio=Ratio(math.nan, least, most),
    )
    return weighed(verdict, known_ratios if hopeless else [])


def why(ratios: Iterable[Estimate]) -> str:
    """Returns the reasons why ratios have no data: ' (reason, reason)'; empty if none is known."""
    reasons = dict.fromkeys(x.reason for x in ratios if not x.n and x.reason)
    return f" ({', '.join(reasons)})" if reasons else ""


def power_of(ratios: Sequence[Estimate], what: str) -> str:
    """Says how many ratios below 1 `everywhere` needs for 'does not hold' with this number of
    rounds; empty if one is enough."""
    chances, of = sorted(x.p_least for x in ratios), len(ratios)
    n = min(x.n for x in ratios)
    needed = next((k for k in range(1, of + 1) if of * chances[k - 1] / k <= ERROR), of + 1)
    if needed == 1:
        return ""
    return (
        f"{'1 round is' if n == 1 else f'{n} rounds are'} too few to refute it for {of} {what}"
        if needed > of
        else f"{'1 round refutes' if n == 1 else f'{n} rounds refute'} it only if at least {needed} of {of} {what} are below 1"
    )


def most_of(claim: str, ratios: Sequence[Estimate], what: str = "pairs") -> Verdict:
    """Judges a claim that more than half of the ratios are above 1.

    To show that at least k of n are above 1, the k - 1 with the least p-values are left out: if
    fewer than k were above 1, the others would include one that is not. Simes' test combines their
    p-values (a partial conjunction, Benjamini and Heller 2008). The claim does not hold if the same
    test shows that at least half are below 1. Unknown ratios count for neither.
    """
    n, values = len(ratios), [x.value for x in ratios if x.n]
    if not values:
        return Verdict(claim, UNTESTED, f"no {what}{why(ratios)}")
    above = sorted(x.p_above for x in ratios)
    below = sorted(x.p_below for x in ratios)
    outcome = (
        HOLDS
        if simes(above[n // 2 :]) <= ERROR
        else FAILS
        if simes(below[(n + 1) // 2 - 1 :]) <= ERROR
        else OPEN
    )
    clear_above = sum(chance <= ERROR / 2 for chance in above)
    clear_below = sum(chance <= ERROR / 2 for chance in below)
    verdict = Verdict(
        claim,
        outcome,
        f"above 1 for {clear_above} of {n} {what}, below 1 for {clear_below}, "
        f"ratio {numerals.number(min(values))} to {numerals.number(max(values))}",
        ratio=Ratio(math.nan, min(values), max(values)),
    )
    return weighed(
        verdict, ratios if simes(sorted(x.p_least for x in ratios)[n // 2 :]) > ERROR else []
    )


def least_of(ratios: Sequence[Estimate]) -> Estimate:
    """Returns the least of several ratios, for example of the times of all rivals to the time of
    one solver.

    It is separated above 1 if all ratios are, and below 1 if one of them is after a correction for
    their number (Bonferroni).
    """
    if not ratios or not all(x.n for x in ratios):
        return NO_DATA
    least = min(ratios, key=lambda x: x.value)
    missed = sum(1 - x.coverage for x in ratios)
    low = min(x.low for x in ratios)
    high = min(x.high for x in ratios)
    n = min(x.n for x in ratios)
    p_above = max(x.p_above for x in ratios)
    p_below = min(1.0, len(ratios) * min(x.p_below for x in ratios))
    p_least = max(x.p_least for x in ratios)
    return Estimate(least.value, low, high, n, max(0.0, 1 - missed), p_above, p_below, p_least)


def above_one(claim: str, ratio: Estimate, what: str = "ratio") -> Verdict:
    """Judges a claim that one ratio is above 1."""
    if not ratio.n:
        return Verdict(claim, UNTESTED, f"no ratio{why([ratio])}")
    outcome = OPEN if not ratio.separated else HOLDS if ratio.low > 1 else FAILS
    return weighed(
        Verdict(
            claim, outcome, f"{what} {numerals.estimate(ratio, limit=1.0)}", ratio=Ratio.of(ratio)
        ),
        [ratio],
    )


def never(
    claim: str,
    wrong: int,
    of: int,
    what: str,
    independent: int | None = None,
    bar: float = RARE,
    against: str = "",
) -> Verdict:
    """Judges a claim that something never happens. One case refutes it, and no number of cases
    proves it.

    If it never happened, the evidence is the greatest rate still possible at 95 % after
    `independent` (default: `of`) trials (Clopper and Pearson 1934). If this rate is not below
    `bar`, there were too few trials. `against` describes a bar other than RARE, such as the rate at
    which a variant goes wrong in the same trials.
    """
    if not of:
        return Verdict(claim, UNTESTED, f"no {what}")
    if wrong:
        return Verdict(claim, FAILS, f"{wrong} of {of:,} {what}")
    trials = of if independent is None else independent
    rate = (
        scipy.stats.binomtest(0, trials, alternative="less")
        .proportion_ci(1 - ERROR, method="exact")
        .high
    )
    return Verdict(
        claim,
        NOT_REFUTED if rate < bar else OPEN,
        f"0 of {of:,} {what}; the rate is below {numerals.at_most(rate, 2, times=100)} % at 95 %"
        + (f", from {trials} independent trials" if trials != of else "")
        + (f", against {numerals.number(100 * bar, 2)} % {against}" if against else ""),
    )


def never_chosen(claim: str, wrong: int, of: int, what: str) -> Verdict:
    """Judges a claim that something never happens, on cases chosen to provoke it. They are not a
    sample, so no rate follows."""
    if not of or wrong:
        return Verdict(
            claim,
            FAILS if wrong else UNTESTED,
            f"{wrong} of {of:,} {what}" if wrong else f"no {what}",
        )
    return Verdict(
        claim,
        NOT_REFUTED,
        f"0 of {of:,} {what}; the cases were chosen, not drawn, so no rate follows",
    )


def all_of(claim: str, unlike: int, seen: int, total: int, what: str) -> Verdict:
    """Judges a claim about each of `total` things: it fails if any was `unlike`, and holds once all
    were `seen`. No statistics."""
    if not seen:
        return Verdict(claim, UNTESTED, f"no {what}")
    outcome = FAILS if unlike else HOLDS if seen >= total else OPEN
    return Verdict(
        claim,
        outcome,
        f"so for {seen - unlike} of {seen} {what}" + (f" out of {total}" if seen < total else ""),
    )


def rising(claim: str, x: Sequence[float], y: Sequence[float]) -> Verdict:
    """Judges a claim that y grows with x, by Kendall's tau. The points (x, y) must be
    independent."""
    if len(x) < 2:
        return Verdict(claim, UNTESTED, "fewer than two sizes")
    tau, chance = scipy.stats.kendalltau(x, y)
    if math.isnan(tau):  # all x or all y are equal
        tau, chance = 0.0, 1.0
    outcome = OPEN if chance > ERROR else HOLDS if tau > 0 else FAILS
    return Verdict(
        claim, outcome, f"Kendall's tau {tau:.2f} over {len(x)}, p = {numerals.number(chance, 2)}"
    )


def rising_by_run(claim: str, runs: Sequence[tuple[Sequence[float], Sequence[float]]]) -> Verdict:
    """Judges a claim that y grows with x, if the points of a run depend on each other.

    Each independent run (a seed) gives one Kendall's tau; the interval is over runs.
    """
    taus = [float(np.nan_to_num(scipy.stats.kendalltau(x, y)[0])) for x, y in runs if len(x) > 1]
    if not taus:
        return Verdict(claim, UNTESTED, "fewer than two sizes")
    tau = median(taus)
    reliable = tau.has_interval and tau.coverage >= 1 - ERROR
    outcome = HOLDS if reliable and tau.low > 0 else FAILS if reliable and tau.high < 0 else OPEN
    return weighed(
        Verdict(
            claim,
            outcome,
            f"Kendall's tau {numerals.estimate(tau, limit=0.0)}, over {tau.n} independent runs",
        ),
        [tau],
    )


def constant(claim: str, places: Sequence[Sequence[float]], within: float) -> Verdict:
    """Judges a claim that a positive quantity, measured by independent runs at each of several
    places, is constant.

    Constant means that its medians differ by at most the factor `within`. All intervals of medians
    hold at once with 95 % (Bonferroni), and so does the interval of this factor, which follows from
    them.
    """
    medians = [median(values, 1 - ERROR / len(places)) for values in places]
    bounded = [x for x in medians if x.has_interval]
    if len(places) < 3 or not bounded:
        return Verdict(claim, UNTESTED, "fewer than three places")
    values = [x.value for x in bounded]
    lows = [x.low for x in bounded]
    highs = [x.high for x in bounded]
    factor = max(values) / min(values)
    least = max(1.0, max(lows) / min(highs))
    most = max(highs) / min(lows)
    sure = sum(1 - x.coverage for x in medians) <= ERROR
    outcome = OPEN if not sure else HOLDS if most <= within else FAILS if least > within else OPEN
    return Verdict(
        claim,
        outcome,
        f"from {numerals.number(min(values))} to "
        f"{numerals.number(max(values))}, a factor of {numerals.number(factor)}"
        + (f" {numerals.bounds(least, most, limit=within)}" if sure else "")
        + f"; constant means within {within:g}",
    )


def greatest(claim: str, ratios: Sequence[Estimate], rival: Estimate, what: str) -> Verdict:
    """Judges a claim that a quantity is greatest at one place. `ratios` are value there / value at
    each other place.

    It holds if all ratios are known and separated above 1 (an intersection-union test, as in
    `everywhere`). It does not hold if `rival` is separated below 1. This is the ratio to a single
    other place, which must be chosen without looking at the values compared here, so no correction
    is needed.
    """
    known_ratios = [x for x in ratios if x.n]
    if not known_ratios:
        return Verdict(claim, UNTESTED, what + why(ratios))
    outcome = (
        HOLDS
        if all(x.n and x.separated and x.low > 1 for x in ratios)
        else FAILS
        if rival.n and rival.separated and rival.high < 1
        else OPEN
    )
    return weighed(Verdict(claim, outcome, what), [rival] if rival.n else known_ratios)


def least_among(
    claim: str, rivals: Sequence[tuple[str, Sequence[Estimate]]], best: str, among: Sequence[str]
) -> Verdict:
    """Judges a claim that the least time is at one of the settings `among`. `best` is the setting
    with the least time here.

    Each rival, another setting, comes with its ratios to all of `among`, above 1 if the rival is
    slower. The claim holds if one of `among` is separated from all rivals (an intersection-union
    test, one-sided at 2.5 %, so two settings together err with 5 %; more settings divide the 5 %
    among them). It does not hold if a rival is faster than all of `among`. Rivals are compared with
    the same times and so depend on each other: the greatest p-value of each rival over `among` is
    multiplied by the number of rivals (Bonferroni).
    """
    if not rivals:
        return Verdict(claim, UNTESTED, "no times")
    allowed = min(ERROR / 2, ERROR / len(among))

    def beats_rivals(i: int) -> bool:
        return all(x[i].separated and x[i].p_above <= allowed for _, x in rivals)

    def is_faster(x: Sequence[Estimate]) -> bool:
        return max(y.p_below for y in x) * len(rivals) <= ERROR

    def is_below(x: Sequence[Estimate]) -> bool:
        return all(y.separated and y.high < 1 for y in x)

    def is_slower(x: Sequence[Estimate]) -> bool:
        return any(y.separated and y.low > 1 for y in x)

    def cannot_refute(x: Sequence[Estimate]) -> bool:
        return max(y.p_least for y in x) * len(rivals) > ERROR

    faster = [name for name, x in rivals if is_faster(x)]
    below = [name for name, x in rivals if name not in faster and is_below(x)]
    level = [name for name, x in rivals if name not in faster + below and not is_slower(x)]
    clear = any(beats_rivals(i) for i in range(len(among)))
    outcome = HOLDS if clear else FAILS if faster else OPEN
    parts = [f"least at {best}"]
    if faster:
        parts.append(f"faster than {' and '.join(among)}: {', '.join(faster)}")
    if below:
        parts.append(
            f"less time, but not less than one of {len(rivals)} may take by chance: {', '.join(below)}"
        )
    if level:
        parts.append(f"not separated from it: {', '.join(level)}")
    if outcome == OPEN and all(cannot_refute(x) for _, x in rivals):
        fewest = min(y.n for _, x in rivals for y in x)
        parts.append(f"{fewest} rounds are too few to refute it for {len(rivals)} rivals")
    return Verdict(claim, outcome, "; ".join(parts))
