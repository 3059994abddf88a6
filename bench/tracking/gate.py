"""What blocks of base and candidate say. Pure functions; the statistics are those of analysis/shared/statistics.py.

A block is a fresh process, and its time the least of its repeats. Blocks come in fours, base, candidate, candidate, base, or the other way
round: each of the candidate is paired with the one of the base that ran beside it, and each build has two for itself. The median of the
log ratios of the pairs has a sign-test interval, which assumes nothing about how times are distributed. With many cases one interval in
twenty would be wrong by chance, so each has the confidence 1 - 5 % / cases (Bonferroni).

A case alarms where the lower end of its ratio is above 1 + LEAST; it has become slower where a second, independent run alarms too.
The gate proves itself each time: a build beside itself must not alarm, and a slowdown of PLANTED that is planted in a case must.
"""

from __future__ import annotations

import math
import statistics
from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import IntEnum

from analysis.shared.statistics import NO_DATA, Estimate, paired_ratio

LEAST = 0.03  # a slowdown of less is no alarm
PLANTED = 0.05  # of the solve time: what the gate must see to be believed
ERROR = 0.05  # the chance of a wrong interval, over all cases
LEAST_BLOCKS = 20  # of each side; an even number, see above


class Verdict(IntEnum):
    """What the program exits with; 2 is a mistake in what it was asked."""

    passed = 0
    slower = 3
    inconclusive = 4
    nothing_measured = 5

    @property
    def words(self) -> str:
        return self.name.replace("_", " ")


@dataclass
class Sides:
    """Seconds of one case by block, in the order of time. `planted` is the candidate with a slowdown, of one case alone."""

    base: list[float] = field(default_factory=list)
    candidate: list[float] = field(default_factory=list)
    planted: list[float] = field(default_factory=list)


@dataclass(frozen=True)
class Judged:
    """The ratios of one case: candidate to base, each build to itself, planted to candidate (none where nothing was planted)."""

    name: str
    base_seconds: float
    ratio: Estimate
    null: Estimate
    planted: Estimate
    second: Estimate = NO_DATA  # of the second run, where the first alarmed

    @property
    def alarms(self) -> bool:
        return alarms(self.ratio)

    @property
    def slower(self) -> bool:
        return self.alarms and alarms(self.second)

    @property
    def sees(self) -> float:
        """The least slowdown that these blocks would have alarmed at: what each build beside itself leaves of an interval's lower end."""
        return (1 + LEAST) / self.null.low - 1 if self.null.has_interval else math.nan


def confidence(cases: int) -> float:
    """Of each interval, so that all of `cases` hold with 95 %."""
    return 1 - ERROR / max(1, cases)


def compare(candidate: Sequence[float], base: Sequence[float], cases: int) -> Estimate:
    """The ratio of paired blocks. ValueError where so few blocks cannot give the confidence that so many cases need."""
    ratio = paired_ratio(candidate, base, confidence(cases))
    if ratio.coverage < confidence(cases):
        raise ValueError(f"{ratio.n} blocks give {ratio.coverage:.4f}, and {cases} cases need {confidence(cases):.4f}: ask for more blocks")
    return ratio


def alarms(ratio: Estimate) -> bool:
    return ratio.has_interval and ratio.low > 1 + LEAST


def judge(name: str, sides: Sides, cases: int) -> Judged:
    both = (sides.base, sides.candidate)
    null = compare([x for side in both for x in side[1::2]], [x for side in both for x in side[::2]], cases)
    return Judged(name, statistics.median(sides.base), compare(sides.candidate, sides.base, cases), null,
                  compare(sides.planted, sides.candidate, cases) if sides.planted else NO_DATA)


def self_test(judged: Sequence[Judged]) -> list[str]:
    """What the gate cannot be believed for: empty where it saw what was planted, and nothing where there is nothing."""
    failures = [f"{one.name}: a build beside itself is {one.null.value:.3f} times as slow: the machine is not quiet"
                for one in judged if alarms(one.null) or alarms(inverse(one.null))]
    planted = [one for one in judged if one.planted.n]
    failures += [f"{one.name}: a planted slowdown of {100 * PLANTED:.0f} % was not seen ({one.planted.value:.3f}, lower end {one.planted.low:.3f})"
                 for one in planted if not alarms(one.planted)]
    return failures if planted else [*failures, "no slowdown was planted"]


def inverse(ratio: Estimate) -> Estimate:
    return Estimate(1 / ratio.value, 1 / ratio.high, 1 / ratio.low, ratio.n, ratio.coverage)


def verdict_of_times(judged: Sequence[Judged]) -> tuple[Verdict, list[str]]:
    """The verdict, and why. Times that cannot be believed say nothing, alarms among them."""
    if not judged:
        return Verdict.nothing_measured, ["no case that base and candidate know"]
    if failures := self_test(judged):
        return Verdict.inconclusive, failures
    if slower := [one for one in judged if one.slower]:
        return Verdict.slower, [f"{one.name}: {100 * (one.ratio.value - 1):+.1f} %, and in a second run {100 * (one.second.value - 1):+.1f} %"
                                for one in slower]
    return Verdict.passed, [f"{one.name}: alarmed once ({100 * (one.ratio.value - 1):+.1f} %), and not again" for one in judged if one.alarms]


def whole(verdicts: Sequence[Verdict]) -> Verdict:
    """Of all tiers: slower where one is, else inconclusive where one is; what was not measured spoils nothing that was."""
    for worst in (Verdict.slower, Verdict.inconclusive, Verdict.passed):
        if worst in verdicts:
            return worst
    return Verdict.nothing_measured
