"""Ratios of times for rows that may have been stopped at a limit: then the time is only known to be
longer."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Final

from analysis.shared import numerals, style
from analysis.shared.cells import MEASURES
from analysis.shared.comparable import Origin, apart, origins
from analysis.shared.results import Results
from analysis.shared.estimates import NO_DATA, Estimate, exact, median, ratio_by_round
from analysis.shared.verdicts import FAILS, HOLDS, OPEN, UNTESTED, Ratio, Verdict, weighed, why

ENDED: Final = ("ok", "floor")  # statuses of rows that ended by themselves
STOPPED: Final = ("timeout", "budget")


@dataclass(frozen=True)
class Row:
    """One row: its times by round, or the time at which it was stopped."""

    status: str
    times: dict[int, float]
    limit: float  # seconds until it was stopped, by the same clock; 0: not stopped, or unknown
    work: dict[str, float]  # by MEASURES, until the end or the limit
    origins: frozenset[Origin] = frozenset()  # of its times; empty for times that a paper prints

    @property
    def ended(self) -> bool:
        return self.status in ENDED

    @property
    def time(self) -> Estimate:
        return median(list(self.times.values())) if self.ended else NO_DATA

    def text(self, scale: float) -> str:
        if self.ended:
            return numerals.estimate(self.time, scale)
        return (
            f"> {numerals.number(self.limit * scale)}"
            if self.limit
            else style.status_word(self.status)
        )


def row_of(results: Results, row: int) -> Row:
    cases, status = results.cases, results.cases.status[row]
    work = {}
    for measure, names in MEASURES.items():
        work[measure] = float(
            sum(int(cases.counters[name][row]) for name in names if name in cases.counters)
        )
    times = results.total_by_round(row)
    # The time of a killed solver is unknown. The limit cannot replace it: it is wall time, so CPU
    # time may be less.
    stopped = min(times.values(), default=0.0) if status in STOPPED else 0.0
    return Row(status, times if status in ENDED else {}, stopped, work, origins(results, [row]))


@dataclass(frozen=True)
class Bounded:
    """A ratio of two costs. If one of the two solvers was stopped, only a lower or an upper bound
    is known."""

    estimate: Estimate = NO_DATA
    at_least: float = 0.0
    at_most: float = float("inf")

    def text(self) -> str:
        if self.estimate.n:
            return numerals.ratio(self.estimate)
        if self.at_least:
            return f"> {numerals.at_least(self.at_least)}"
        return (
            f"< {numerals.at_most(self.at_most)}"
            if self.at_most < float("inf")
            else numerals.NOTHING
        )


def time_ratio(slow: Row | None, fast: Row | None) -> Bounded:
    """Returns the ratio of times, or a bound if one was stopped: conservatively, from the upper end
    of the other's interval."""
    if slow is None or fast is None:
        return Bounded()
    if lacking := apart(slow.origins | fast.origins):
        return Bounded(lacking)
    if slow.ended and fast.ended:
        return Bounded(ratio_by_round(slow.times, fast.times))
    if slow.limit and fast.ended and fast.time.n:
        return Bounded(
            at_least=slow.limit / (fast.time.high if fast.time.has_interval else fast.time.value)
        )
    if fast.limit and slow.ended and slow.time.n:
        return Bounded(
            at_most=(slow.time.high if slow.time.has_interval else slow.time.value) / fast.limit
        )
    return Bounded()


def work_ratio(slow: Row | None, fast: Row | None, measure: str) -> Bounded:
    """Returns the ratio of counted work, or a bound if one was stopped, because its count is then
    only a lower bound."""
    if slow is None or fast is None or min(slow.work[measure], fast.work[measure]) <= 0:
        return Bounded()
    ratio = slow.work[measure] / fast.work[measure]
    if slow.ended and fast.ended:
        return Bounded(exact(ratio))
    return (
        Bounded(at_least=ratio)
        if fast.ended
        else Bounded(at_most=ratio)
        if slow.ended
        else Bounded()
    )


def ratio_of(slow: Row | None, fast: Row | None, measure: str) -> Bounded:
    """Returns the ratio of times, or of counts MEASURES[measure]."""
    return work_ratio(slow, fast, measure) if measure else time_ratio(slow, fast)


def above(claim: str, ratio: Bounded, times: float) -> Verdict:
    """Judges the claim that a ratio is above `times`."""
    x, against = ratio.estimate, f", against {times:,g}" if times != 1 else ""
    if x.n:
        scaled = replace(x, value=x.value / times, low=x.low / times, high=x.high / times)
        outcome = OPEN if not scaled.separated else HOLDS if scaled.low > 1 else FAILS
        return weighed(
            Verdict(
                claim,
                outcome,
                f"ratio {numerals.estimate(x, limit=times)}{against}",
                ratio=Ratio.of(scaled),
            ),
            [x],
        )
    if ratio.at_least:
        return Verdict(
            claim,
            HOLDS if ratio.at_least > times else OPEN,
            f"ratio above {numerals.at_least(ratio.at_least)}, because the slower "
            f"was stopped{against}",
            ratio=Ratio(math.nan, ratio.at_least / times, math.inf),
        )
    if ratio.at_most < float("inf"):
        return Verdict(
            claim,
            FAILS if ratio.at_most < times else OPEN,
            f"ratio below {numerals.at_most(ratio.at_most)}, because the faster "
            f"was stopped{against}",
            ratio=Ratio(math.nan, 0.0, ratio.at_most / times),
        )
    return Verdict(claim, UNTESTED, f"no ratio{why([x])}")
