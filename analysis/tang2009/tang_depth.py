"""Penetration depth in recorded scenes, frame by frame, of all pairs of objects that overlap."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np

from analysis.shared import numerals
from analysis.shared.columns import Floats
from analysis.shared.comparable import origins, reason_apart
from analysis.shared.results import Results
from analysis.shared.estimates import CONFIDENCE, NO_DATA, Estimate, student_half_width
from analysis.shared.verdicts import FAILS, HOLDS, NOT_JUDGED, OPEN, UNTESTED, Ratio, Verdict

BATCHES: Final = 8
CUT: Final = "seconds: cut"
MEASURE: Final = "seconds: measure"


def mean_over_frames(values: Floats) -> Estimate:
    """Returns the mean over frames, in order, with Student's interval.

    Consecutive frames are alike, so the interval is computed from the means of eight blocks of
    frames.
    """
    if not len(values) or not np.isfinite(values).all():
        return NO_DATA
    middle = float(values.mean())
    if len(values) < 2 * BATCHES:
        return Estimate(middle, np.nan, np.nan, len(values), 0.0)
    means = np.array([part.mean() for part in np.array_split(values, BATCHES)])
    half = student_half_width(means)
    return Estimate(middle, middle - half, middle + half, BATCHES, CONFIDENCE)


@dataclass(frozen=True)
class Scene:
    """The rows of one solver on a recorded scene."""

    results: Results
    name: str
    label: str
    rows: list[int]

    @property
    def frames(self) -> list[int]:
        """The frames in which objects overlap."""
        return sorted({int(self.results.cases.frame[row]) for row in self.rows})

    @property
    def answered(self) -> list[int]:
        return [row for row in self.rows if self.results.cases.status[row] == "ok"]

    def told(self, name: str) -> Floats:
        """Returns an extra number that the solver reports, by its name, for each answered row."""
        return np.array([self.results.extras(row).get(name, np.nan) for row in self.answered])

    @cached_property
    def depths(self) -> Floats:
        """The depths (middles of intervals) / longest side of the first object."""
        cases, rows = self.results.cases, self.answered
        return np.array(
            [
                0.5 * (cases.lower[row] + cases.upper[row]) / cases.source_longest[row]
                for row in rows
            ]
        )

    def per_frame(self, *stages: str) -> Floats:
        """Returns the time of these stages by frame, summed over its pairs, in seconds; NaN if a
        pair has no answer."""
        place = {frame: i for i, frame in enumerate(self.frames)}
        sums = np.zeros(len(place))
        for row in self.rows:
            extras = self.results.extras(row)
            sums[place[int(self.results.cases.frame[row])]] += sum(
                extras.get(stage, np.nan) for stage in stages
            )
        return sums


def recorded(results: Results, labels: list[str]) -> list[Scene]:
    """Returns a Scene for each recording (a [[scene]] of the experiment) and each of these solvers
    that was run on it."""
    cases = results.cases
    names: dict[str, dict[str, list[int]]] = {}
    for row in range(len(cases)):
        if int(cases.frame[row]) >= 0 and cases.label[row] in labels:
            name = cases.scene[row].partition(": ")[0]
            names.setdefault(name, {}).setdefault(cases.label[row], []).append(row)
    return [
        Scene(results, name, label, rows)
        for name, solvers in names.items()
        for label, rows in solvers.items()
    ]


def faster(claim: str, scene: Scene, stages: tuple[str, ...], printed: float) -> Verdict:
    """Judges the claim that the mean time per frame is below `printed` milliseconds."""
    spent = mean_over_frames(scene.per_frame(*stages))
    if why := reason_apart(origins(scene.results, scene.rows)):
        return Verdict(claim, UNTESTED, f"times {why}")
    if not spent.n:
        return Verdict(claim, UNTESTED, "times are missing")
    value = f"{1e3 * spent.value:.3g} ms"
    if not spent.has_interval:
        return Verdict(claim, NOT_JUDGED, f"n = {spent.n} frames; {value} against {printed:g} ms")
    low, high = 1e3 * spent.low, 1e3 * spent.high
    return Verdict(
        claim,
        HOLDS if high < printed else FAILS if low > printed else OPEN,
        f"{value} {numerals.bounds(low, high, limit=printed)} against {printed:g} ms",
        ratio=Ratio(printed / (1e3 * spent.value), printed / high, printed / low),
    )
