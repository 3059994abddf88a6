"""Judges blocks of base and candidate. Pure functions; the statistics come from
analysis/shared/estimates.py.

A block is a fresh process; its time is the least of its repeats. Blocks come in pairs of base and
candidate that share a core. Two pairs make a turn: the base begins one, the candidate the other.
The median of the log ratios of the pairs has a sign-test interval, which assumes nothing about the
distribution of times. Each interval has the confidence 1 - 5 % / cases (Bonferroni), so that all of
them hold with 95 %.

Every case has SCREENING blocks per side. A case alarms if the lower end of its ratio is above 1 +
LEAST. If its median ratio is above 1 + SUSPECT, it gets more blocks until they cannot change
whether it alarms. This alarms no more often than if all cases had as many blocks, so the confidence
is kept. A case is red if it alarms in a second, independent run, too. The gate tests itself in one
case, with the base beside itself: its times must not alarm, and must if one side is multiplied by 1
+ PLANTED.
"""

from __future__ import annotations

import math
import statistics
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from enum import IntEnum

from analysis.shared.estimates import NO_DATA, Estimate, order_statistic_rank, paired_ratio

LEAST = 0.03  # smaller slowdowns do not alarm
PLANTED = 0.05  # the slowdown that the gate must detect to be believed
ERROR = 0.05  # the chance of a wrong interval, over all cases
SCREENING = (
    24  # blocks per side; half as many would give the confidence that about a dozen cases need
)
SUSPECT = (
    0.02  # cases with a smaller median excess get no more blocks; an alarm needs more than LEAST
)


class Verdict(IntEnum):
    """The exit code of the program; 2 is a usage error."""

    passed = 0
    red = 3
    inconclusive = 4
    nothing_measured = 5

    @property
    def words(self) -> str:
        return self.name.replace("_", " ")


@dataclass
class Sides:
    """Seconds of each block of a case, two per turn."""

    base: list[float] = field(default_factory=list)
    candidate: list[float] = field(default_factory=list)


@dataclass(frozen=True)
class Judged:
    """Ratios of times of a case: candidate to base; in the self-test also the base to itself, with
    a planted slowdown."""

    name: str
    base_seconds: float
    ratio: Estimate
    planted: Estimate = NO_DATA
    second: Estimate = NO_DATA  # from the second run, if the first alarmed

    @property
    def itself(self) -> Estimate:
        """Returns the ratio of the self-test without the planted slowdown."""
        return times(self.planted, 1 / (1 + PLANTED))

    @property
    def alarms(self) -> bool:
        return alarms(self.ratio)

    @property
    def red(self) -> bool:
        return self.alarms and alarms(self.second)

    @property
    def sees(self) -> float:
        """Returns the least slowdown that would have alarmed with an interval of this width."""
        return (
            (1 + LEAST) * self.ratio.value / self.ratio.low - 1
            if self.ratio.has_interval
            else math.nan
        )


def confidence(cases: int) -> float:
    """Returns the confidence of each interval, such that all of `cases` hold with 95 %."""
    return 1 - ERROR / max(1, cases)


def compare(candidate: Sequence[float], base: Sequence[float], cases: int) -> Estimate:
    """Returns the ratio of paired blocks. Raises ValueError if there are too few blocks for the
    confidence that so many cases need."""
    ratio = paired_ratio(candidate, base, confidence(cases))
    if ratio.coverage < confidence(cases):
        raise ValueError(
            f"{ratio.n} pairs of blocks give {ratio.coverage:.4f}, and {cases} cases need {confidence(cases):.4f}: ask for more blocks"
        )
    return ratio


def alarms(ratio: Estimate) -> bool:
    return ratio.has_interval and ratio.low > 1 + LEAST


def suspected(sides: Sides) -> bool:
    """Returns whether the case needs more blocks; true for every case that alarms."""
    return paired_ratio(sides.candidate, sides.base).value > 1 + SUSPECT


def decided(sides: Sides, count: int, cases: int) -> bool:
    """Returns whether further blocks, up to `count` in all, cannot change whether the case alarms.

    That is so if enough ratios are on one side of 1 + LEAST already. SCREENING blocks are always
    measured, because fewer give no confidence.
    """
    rank = order_statistic_rank(count, confidence(cases))  # of the lower end
    above = sum(
        candidate > (1 + LEAST) * base
        for candidate, base in zip(sides.candidate, sides.base, strict=True)
    )
    below = len(sides.base) - above
    return above + below >= min(count, SCREENING) and (
        above + below >= count or below >= rank or above > count - rank
    )


def judge(name: str, sides: Sides, cases: int) -> Judged:
    return Judged(name, statistics.median(sides.base), compare(sides.candidate, sides.base, cases))


def times(ratio: Estimate, factor: float) -> Estimate:
    return replace(
        ratio, value=factor * ratio.value, low=factor * ratio.low, high=factor * ratio.high
    )


def inverse(ratio: Estimate) -> Estimate:
    return Estimate(1 / ratio.value, 1 / ratio.high, 1 / ratio.low, ratio.n, ratio.coverage)


def self_test(judged: Sequence[Judged]) -> list[str]:
    """Returns the reasons to distrust the gate: none if it detected the planted slowdown and no
    difference of the base from itself."""
    failures = [
        f"{case.name}: the base is {case.itself.value:.3f} times as slow as itself: the difference is not between the builds"
        for case in judged
        if case.planted.n and (alarms(case.itself) or alarms(inverse(case.itself)))
    ]
    planted = [case for case in judged if case.planted.n]
    failures += [
        f"{case.name}: a planted slowdown of {100 * PLANTED:.0f} % was not seen ({case.planted.value:.3f}, lower end {case.planted.low:.3f})"
        for case in planted
        if not alarms(case.planted)
    ]
    return failures if planted else [*failures, "no slowdown was planted"]


def verdict_of_times(judged: Sequence[Judged]) -> tuple[Verdict, list[str]]:
    """Returns the verdict and its reasons. If the self-test fails, alarms do not count."""
    if not judged:
        return Verdict.nothing_measured, ["base and candidate have no case in common"]
    if failures := self_test(judged):
        return Verdict.inconclusive, failures
    reasons = [
        f"{case.name}: slower by {100 * (case.ratio.value - 1):.1f} %, and in a second run by {100 * (case.second.value - 1):.1f} %"
        for case in judged
        if case.red
    ]
    verdict = Verdict.red if reasons else Verdict.passed
    reasons += [
        f"{case.name}: an alarm ({100 * (case.ratio.value - 1):+.1f} %), which a second run did not repeat "
        f"({100 * (case.second.value - 1):+.1f} %)"
        for case in judged
        if case.alarms and not case.red
    ]
    if blurred := [case.name for case in judged if not case.sees <= PLANTED + LEAST]:
        reasons.append(
            f"too noisy to see a slowdown of {100 * (PLANTED + LEAST):.0f} %: {', '.join(blurred)}"
        )
    return verdict, reasons


def whole(verdicts: Sequence[Verdict]) -> Verdict:
    """Combines the verdicts of all tiers: red if one is red, else inconclusive if one is. A tier
    that was not measured does not spoil others."""
    for worst in (Verdict.red, Verdict.inconclusive, Verdict.passed):
        if worst in verdicts:
            return worst
    return Verdict.nothing_measured
