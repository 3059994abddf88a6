"""Motions of Tang et al. 2009: one model moves towards another, and each solver computes H at each
pose.

Intervals of times are over rounds, not poses, because one process answers all poses of a round and
neighbouring poses are alike. Counted work is the same in all rounds.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from typing import Final

import numpy as np

from analysis.shared import claims, numerals, style
from analysis.shared.cells import MEASURES, in_time_and_work
from analysis.shared.columns import Floats
from analysis.shared.comparable import Origin, apart, origins, reason_apart
from analysis.shared.results import Results
from analysis.shared.estimates import NO_DATA, Estimate, exact, median, ratio_by_round
from analysis.shared.verdicts import (
    FAILS,
    HOLDS,
    OPEN,
    UNTESTED,
    Ratio,
    Verdict,
    all_of,
    everywhere,
    most_of,
    rising_by_run,
)

BACK: Final = " (B to A)"
QUERIES: Final = ("closest_point_queries",)
AIM_OF_CULLING: Final = 0.99
AIM_OF_DEPTH: Final = 10
AIM_OF_SUBDIVIDING: Final = 0.01
AIM_OF_WARM: Final = 0.67


class Run:
    """The rows of one solver (by label) on one scene, in the order of poses."""

    def __init__(self, results: Results, rows: Sequence[int]) -> None:
        self.results, self.rows = results, sorted(
            rows, key=lambda row: int(results.cases.pose_index[row])
        )

    @cached_property
    def origins(self) -> frozenset[Origin]:
        return origins(self.results, self.rows)

    @property
    def complete(self) -> bool:
        return bool(self.rows) and all(self.results.cases.status[row] == "ok" for row in self.rows)

    @cached_property
    def by_round(self) -> dict[int, Floats]:
        """The time of each pose in seconds, for rounds with all poses. Empty if a pose has no
        answer."""
        if not self.complete:
            return {}
        times_by_pose = [self.results.solve_by_round(row) for row in self.rows]
        shared = set.intersection(*(set(times) for times in times_by_pose))
        by_round = {}
        for number in sorted(shared):
            by_round[number] = np.array([times[number] for times in times_by_pose])
        return by_round

    @property
    def mean(self) -> Estimate:
        """The mean time of a pose, with an interval over rounds."""
        return median([float(times.mean()) for times in self.by_round.values()])

    @property
    def per_pose(self) -> Floats:
        """The time of each pose (median over rounds)."""
        return (
            np.asarray(np.median(list(self.by_round.values()), axis=0))
            if self.by_round
            else np.empty(0)
        )

    @cached_property
    def distance(self) -> Floats:
        """H (the middle of the proven interval) / longest side of A."""
        cases = self.results.cases
        return np.array(
            [self.results.middle(row) / float(cases.source_longest[row]) for row in self.rows]
        )

    def counted(self, names: Sequence[str]) -> Floats:
        counters = self.results.cases.counters
        reported = [counters[name] for name in names if name in counters]
        totals = []
        for row in self.rows:
            totals.append(float(sum(int(counts[row]) for counts in reported)))
        return np.array(totals)

    def told(self, name: str) -> Floats:
        """Returns an extra number that the solver reports, by its name: a row per pose, a column
        per direction; NaN if missing."""
        extras = [self.results.extras(row) for row in self.rows]
        return np.array(
            [[extra.get(name, math.nan), extra.get(name + BACK, math.nan)] for extra in extras]
        )

    @cached_property
    def deepest(self) -> Floats:
        """The depth of subdivision at each pose, the maximum of both directions; NaN if the solver
        does not report it."""
        return np.asarray(np.fmax(*self.told("depth").T))

    def stage(self, name: str) -> Floats:
        """Returns the seconds of one stage at each pose, the sum of both directions."""
        return np.asarray(np.nansum(self.told(f"seconds: {name}"), axis=1))

    def mean_told(self, name: str) -> float:
        values = self.told(name)
        return float(np.nanmean(values)) if np.isfinite(values).any() else math.nan


class Motion:
    """A motion: one scene, with the Run of each solver, by label."""

    def __init__(self, results: Results, scene: str) -> None:
        cases, self.scene = results.cases, scene
        rows = results.rows(scene=scene)
        self.first = rows[0]
        self.labels = style.order((cases.solver[row], cases.label[row]) for row in rows)
        self.runs: dict[str, Run] = {}
        for _, label in self.labels:
            self.runs[label] = Run(results, [row for row in rows if cases.label[row] == label])
        self.sizes = results.sizes(self.first)
        self.note = cases.scene_note[self.first]

    def work_ratio(self, slow: str, fast: str, names: Sequence[str]) -> Estimate:
        """Returns the median ratio of counted work over the poses, without the first, which has no
        warm start."""
        if not all(label in self.runs and self.runs[label].complete for label in (slow, fast)):
            return NO_DATA
        above, below = (self.runs[label].counted(names)[1:] for label in (slow, fast))
        counted = (above > 0) & (below > 0)
        return (
            exact(float(np.median(above[counted] / below[counted]))) if counted.any() else NO_DATA
        )


def motions(results: Results) -> list[Motion]:
    return [Motion(results, scene) for scene in results.scenes]


def labels_of(motions: Sequence[Motion]) -> list[tuple[str, str]]:
    return style.order(pair for motion in motions for pair in motion.labels)


def each(
    claim: str, values: Sequence[float], most: float, noun: str, scale: float = 1.0
) -> Verdict:
    """Judges a claim that all `values`, which are exact, are at most `most`."""
    if not values or not all(map(math.isfinite, values)):
        return Verdict(
            claim,
            UNTESTED if not any(map(math.isfinite, values)) else OPEN,
            f"a number is missing among {len(values)} {noun}",
        )
    over = sum(value > most for value in values)
    return Verdict(
        claim,
        FAILS if over else HOLDS,
        f"{numerals.bounds(min(values), max(values), times=scale, form='{} to {}')} on {len(values)} {noun}"
        + (f", more on {over}" if over else ""),
        ratio=Ratio(math.nan, *(most / x if x else math.inf for x in (max(values), min(values)))),
    )


def culling(motions: Sequence[Motion], label: str) -> list[Verdict]:
    """Judges the paper's culling rate, by the mean over poses and directions of each pair.

    The ratio is the share of triangles that may be left / the share that is left.
    """
    verdicts = []
    for side in ("A", "B"):
        left = [
            1 - motion.runs[label].mean_told(f"culled on {side}")
            for motion in motions
            if label in motion.runs
        ]
        verdict = most_of(
            claims.of("tang2009", "culling", side=side),
            [below(share, 1 - AIM_OF_CULLING) for share in left],
        )
        finite = [100 * share for share in left if math.isfinite(share)]
        spread = (
            f"; left: {numerals.number(min(finite))} to {numerals.number(max(finite))} %"
            if finite
            else ""
        )
        verdicts.append(replace(verdict, evidence=verdict.evidence + spread))
    return verdicts


def below(value: float, bar: float) -> Estimate:
    """Returns bar / value as an exact ratio, which is above 1 if the value is below the bar. NaN
    gives no data."""
    return exact(math.inf if value == 0 else bar / value)


def depth(motions: Sequence[Motion], label: str) -> Verdict:
    """Judges the claim that deep subdivisions (AIM_OF_DEPTH levels or more) occur at less than half
    of the poses, on most pairs."""
    deepest = [motion.runs[label].deepest for motion in motions if label in motion.runs]
    deep = [
        float((levels >= AIM_OF_DEPTH).mean()) if np.isfinite(levels).all() else math.nan
        for levels in deepest
    ]
    verdict = most_of(claims.of("tang2009", "depth"), [below(share, 0.5) for share in deep])
    shares, levels_of_all = [100 * share for share in deep if math.isfinite(share)], np.concatenate(
        deepest
    ) if deepest else np.empty(0)
    spread = (
        f"; ten times or more at {numerals.number(min(shares))} to {numerals.number(max(shares))} % of the poses"
        if shares
        else ""
    )
    most = (
        f"; at most {numerals.at_most(float(np.nanmax(levels_of_all)))} times"
        if np.isfinite(levels_of_all).any()
        else ""
    )
    return replace(verdict, evidence=f"{verdict.evidence}{spread}{most}")


def faster_than(
    motions: Sequence[Motion], label: str, name: str, seconds: float, slowest: bool = False
) -> Verdict:
    """Judges the claim that the mean time of a pose (or the time of the slowest pose) is below
    `seconds` on every pair."""

    def ratio(run: Run) -> Estimate:
        spent = {
            number: float(times.max() if slowest else times.mean())
            for number, times in run.by_round.items()
        }
        return apart(run.origins) or ratio_by_round(dict.fromkeys(spent, seconds), spent)

    return everywhere(
        claims.of("tang2009", name),
        [ratio(motion.runs[label]) for motion in motions if label in motion.runs],
    )


def within_tolerance(motions: Sequence[Motion], label: str) -> Verdict:
    """Judges the claim that poses reach the tolerance. Timeouts and the like do not count.

    Rows that stopped at the precision floor or are unsound refute it.
    """
    rows = [
        (motion.runs[label].results, row)
        for motion in motions
        if label in motion.runs
        for row in motion.runs[label].rows
    ]
    ended = [
        (results, row)
        for results, row in rows
        if results.cases.status[row] in ("ok", "floor", "unsound")
    ]
    wide = sum(
        results.cases.status[row] != "ok"
        or results.gap(row) > float(results.cases.tolerance_absolute[row])
        for results, row in ended
    )
    return all_of(claims.of("tang2009", "within_tolerance"), wide, len(ended), len(rows), "poses")


def subdivided(motions: Sequence[Motion], label: str) -> Verdict:
    """Bounds the share of triangles of both models that are subdivided, on average over the poses
    of each pair.

    Rows count subdivisions of triangles and of their parts; each makes four parts. So at most as
    many triangles are subdivided as there are subdivisions, or triangles that culling on A leaves.
    At least subdivisions / ((4^d - 1) / 3) triangles are, because a triangle has at most (4^d - 1)
    / 3 subdivisions down to depth d.
    """

    def bounds(motion: Motion) -> tuple[float, float]:
        run, cases = motion.runs[label], motion.runs[label].results.cases
        sizes = np.array(
            [int(cases.source_elements[motion.first]), int(cases.target_elements[motion.first])]
        )
        count, left = run.counted(("subdivisions",)), (1 - run.told("culled on A")) @ sizes
        return float(
            (count / np.maximum((4.0**run.deepest - 1) / 3, 1)).mean() / sizes.sum()
        ), float(np.minimum(count, left).mean() / sizes.sum())

    shares = [
        bounds(motion) for motion in motions if label in motion.runs and motion.runs[label].complete
    ]
    finite, claim = [(low, high) for low, high in shares if math.isfinite(low + high)], claims.of(
        "tang2009", "subdivided"
    )
    if not finite:
        return Verdict(claim, UNTESTED, "no pair with counted subdivisions at every pose")
    most = [high for _, high in finite]
    more = sum(low >= AIM_OF_SUBDIVIDING for low, _ in finite)
    less = sum(high < AIM_OF_SUBDIVIDING for high in most)
    pairs = sum(label in motion.runs for motion in motions)
    evidence = (
        f"at most {numerals.at_most(min(most), times=100)} to {numerals.at_most(max(most), times=100)} % on {len(finite)} of {pairs} pairs; "
        f"certainly more than 1 % on {more}"
    )
    return Verdict(
        claim,
        FAILS if more else HOLDS if less == pairs else OPEN,
        evidence,
        ratio=Ratio(
            math.nan, *(AIM_OF_SUBDIVIDING / x if x else math.inf for x in (max(most), min(most)))
        ),
    )


def rising(motions: Sequence[Motion], label: str) -> Verdict:
    """Judges the claim that time and work grow as the models get nearer, with each pair as one
    independent run."""
    runs = [
        motion.runs[label]
        for motion in motions
        if label in motion.runs and motion.runs[label].complete
    ]
    claim = claims.of("tang2009", "nearer")

    def judge(measure: str) -> Verdict:
        if not measure and (
            why := next((why for run in runs if (why := reason_apart(run.origins))), "")
        ):
            return Verdict(claim, UNTESTED, f"times {why}")
        return rising_by_run(
            claim,
            [
                (
                    list(map(float, -run.distance)),
                    list(map(float, run.counted(MEASURES[measure]) if measure else run.per_pose)),
                )
                for run in runs
            ],
        )

    return in_time_and_work(judge)


def warm_pays(motions: Sequence[Motion], cold: str, warm: str) -> Verdict:
    title = style.title(cold)
    ratios = [motion.work_ratio(warm, cold, QUERIES) for motion in motions]
    values = [ratio.value for ratio in ratios if ratio.n]
    claim = claims.of("hausbench", "warm", title=title, label=cold)
    return each(claim, values if len(values) == len(ratios) else [], AIM_OF_WARM, "pairs")
