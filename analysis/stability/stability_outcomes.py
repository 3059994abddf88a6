"""Classifies the rows of the stability suite by outcome, and gives each outcome its words, letter
and colour."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from enum import Enum
from typing import Final

import numpy as np

from analysis.shared import shapes
from analysis.shared.results import Interval, ResultError, Results

U: Final = 2.0**-53
SLACK: Final = (
    84 * U
)  # as a fraction of the largest |coordinate|, for solvers that are not certified; derived in harness/check/verify.cpp
# The least tolerance that double arithmetic can meet, as a fraction of M, the largest |coordinate|.
# The widest certified bounds at a precision floor that we saw, of meshes far from the origin, were
# 34 * U * M apart.
MEETABLE: Final = 40 * U
LEAST: Final = 40 * 2.0**-1074  # the same if U * M is below the smallest double


class Outcome(Enum):
    """The outcomes of a row: first two for rows that were not run, then from best to worst.

    Each has words, a short word, a letter in figures, a colour, and the colour of the letter. Worse
    outcomes are darker (but a crash is black), so that colours differ in grey and with all kinds of
    colour blindness.
    """

    NOT_APPLICABLE = ("not applicable", "n/a", "", "#FFFFFF", "#777777")
    NOT_RUN = ("not run", "not run", "", "#FFFFFF", "#777777")
    TIGHT = ("right and tight", "tight", "", "#D6EEE6", "#222222")
    RIGHTLY_REFUSED = ("rightly refused", "refused it", "r", "#D6EEE6", "#222222")
    LOOSE = ("right but loose", "loose", "~", "#A8D3C4", "#222222")
    STOPPED = (
        "stopped, bounds hold",
        "stopped",
        "",
        "#D3A02A",
        "#222222",
    )  # its letter is in STOPS
    REFUSED = ("refused", "refused", "R", "#A97FC4", "#222222")
    HUNG = ("hung", "hung", "H", "#4F6DB8", "#FFFFFF")
    CRASHED = ("crashed", "crashed", "C", "#2A1E14", "#FFFFFF")
    WRONG = ("wrong", "wrong", "X", "#A3200B", "#FFFFFF")

    def __init__(self, words: str, short: str, letter: str, colour: str, ink: str) -> None:
        self.words, self.short, self.letter, self.colour, self.ink = (
            words,
            short,
            letter,
            colour,
            ink,
        )
        self.badness = len(type(self).__members__)


STOPS: Final = {
    "timeout": ("T", "stopped at its time limit"),
    "budget": ("B", "stopped at its budget"),
    "floor": ("P", "stopped at the precision of doubles"),
}
ILL: Final = (Outcome.REFUSED, Outcome.HUNG, Outcome.CRASHED, Outcome.WRONG)


@dataclass(frozen=True)
class Ending:
    """The properties of a row that decide its outcome."""

    status: str = "ok"
    reason: str = ""
    solver_status: str = ""  # empty: the solver gave no answer
    lower: float = math.nan
    upper: float = math.nan
    truth: Interval = Interval(math.nan, math.nan)  # an interval that contains the true distance
    slack: float = 0.0  # how far the bounds may be off; NaN: unknown
    tolerance: float = 0.0
    certified: bool = True
    unsound: bool = False  # found by the harness
    legal: bool = True  # the input is valid, so a solver should answer

    @property
    def takes_it(self) -> bool:
        """False if the solver does not accept such shapes, or does not compute this quantity."""
        return not re.match(r"solver '[^']*' (takes no|computes) ", self.reason)

    @property
    def leaves_out_the_truth(self) -> bool:
        """True if lower > upper, or the true distance is outside the bounds, by more than the
        slack. False for an unknown slack."""
        low, high = self.lower - self.slack, self.upper + self.slack
        return (
            self.lower > high
            or low > self.truth.upper
            or high < self.truth.lower
            or math.isinf(self.lower)
        )

    @property
    def is_tight(self) -> bool:
        return self.upper - self.lower <= self.tolerance + float(np.nan_to_num(self.slack))


def judge(ending: Ending) -> Outcome:
    if ending.status in ("skipped", "not_built"):
        return Outcome.NOT_RUN if ending.takes_it else Outcome.NOT_APPLICABLE
    outcome = _judge_legal(ending)
    if ending.legal:
        return outcome
    return {
        Outcome.REFUSED: Outcome.RIGHTLY_REFUSED,
        Outcome.CRASHED: Outcome.CRASHED,
        Outcome.HUNG: Outcome.HUNG,
    }.get(outcome, Outcome.WRONG)


def _judge_legal(ending: Ending) -> Outcome:
    if ending.status in ("signal", "out_of_memory"):
        return Outcome.CRASHED
    if ending.status == "unsound" or ending.unsound:
        return Outcome.WRONG
    if math.isnan(ending.lower) or math.isnan(ending.upper):
        return _without_bounds(ending)
    if ending.leaves_out_the_truth:
        return Outcome.WRONG
    if (
        ending.status == "failed" and ending.solver_status != "stalled"
    ):  # its runs gave different answers
        return Outcome.WRONG
    if ending.is_tight:
        return Outcome.TIGHT
    if ending.status in ("timeout", "budget", "floor"):
        return Outcome.STOPPED
    if (
        ending.status == "failed" and ending.lower <= 0 and math.isinf(ending.upper)
    ):  # trivial bounds and a reason
        return Outcome.REFUSED
    if ending.status == "ok" and ending.certified:
        return Outcome.WRONG
    return Outcome.LOOSE


def _without_bounds(ending: Ending) -> Outcome:
    if ending.solver_status:  # it answered NaN
        return Outcome.WRONG
    if ending.status == "timeout":
        return Outcome.HUNG
    return Outcome.REFUSED if ending.status == "failed" and ending.reason else Outcome.CRASHED


class Judge:
    """Finds the outcomes of the rows of a result file. Caches the size of each model."""

    def __init__(self, results: Results) -> None:
        self.results = results
        self._largest: dict[str, tuple[float, float, float] | None] = {}

    def ending(self, row: int) -> Ending:
        cases = self.results.cases
        certified = bool(cases.certified[row] == 1)
        return Ending(
            str(cases.status[row]),
            str(cases.reason[row]),
            str(cases.solver_status[row]),
            float(cases.lower[row]),
            float(cases.upper[row]),
            self.truth(row),
            0.0 if certified else SLACK * self.magnitude(row),
            float(cases.tolerance_absolute[row]),
            certified,
            "unsound" in (cases.lower_check[row], cases.upper_check[row]),
            not str(cases.scene_note[row]).startswith("not legal"),
        )

    def truth(self, row: int) -> Interval:
        """Returns `exact`, give or take one ulp, or if it is unknown the interval that all
        certified rows prove together.

        If certified rows contradict each other, this interval has lower > upper, as it is not known
        which one is wrong. Then only a row whose bounds include both ends contains it.
        """
        exact = float(self.results.cases.exact[row])
        if math.isnan(exact):
            return self.results.proven_of(row)
        return Interval(float(np.nextafter(exact, -np.inf)), float(np.nextafter(exact, np.inf)))

    def can_be_met(self, row: int) -> bool | None:
        """Tells whether the tolerance is within the precision of doubles; None if a shape is not in
        the cache."""
        floor = self.floor(row)
        return (
            None if math.isnan(floor) else bool(self.results.cases.tolerance_absolute[row] >= floor)
        )

    def floor(self, row: int) -> float:
        """Returns the least tolerance that doubles can meet; NaN if a shape is not in the cache."""
        largest = self.magnitude(row)
        return math.nan if math.isnan(largest) else max(MEETABLE * largest, LEAST)

    def magnitude(self, row: int) -> float:
        """Returns a bound on |coordinate| of both shapes in their poses, as in
        harness/check/verify.cpp; NaN if one is not cached."""
        cases, magnitudes = self.results.cases, list[float]()
        for model, pose in (
            (cases.source[row], cases.pose[row]),
            (cases.target[row], cases.target_pose[row]),
        ):
            largest = self._largest_of(str(model))
            if largest is None:
                return math.nan
            magnitudes.append(
                float((np.abs(pose[:9].reshape(3, 3)) @ largest + np.abs(pose[9:])).max())
            )
        return max(magnitudes)

    def _largest_of(self, model: str) -> tuple[float, float, float] | None:
        """Returns the largest |coordinate| of a model along each axis."""
        if model not in self._largest:
            self._largest[model] = self._read(model)
        return self._largest[model]

    def _read(self, model: str) -> tuple[float, float, float] | None:
        models = self.results.models
        rows = np.flatnonzero(models.name == model)
        if len(rows) and np.isfinite(models.box[rows[0]]).all():  # a surface
            corners = models.box[rows[0]].reshape(3, 2).T
        else:
            try:
                corners = shapes.mesh(self.results, model).corners
            except ResultError:
                return None
        x, y, z = np.abs(corners).max(axis=0)
        return float(x), float(y), float(z)
