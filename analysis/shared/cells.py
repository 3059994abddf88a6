"""Cells of tables: all rows of one solver (by its label) on one scene; a randomized solver has one
row per seed.

Solving is measured in CPU time (with child processes) if one thread works at a time, else in wall
time; `clock` in the result file says which. Preparation is wall time. It is added to the first
answer of the same process, so a solver gains nothing by building structures while it solves.

Intervals are over rounds (fresh processes). With several seeds they are over seeds, each by the
median of its rounds, because rounds alone would not show how much seeds vary.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from typing import Any, Final

import numpy as np

from analysis.shared import numerals, style
from analysis.shared.comparable import apart, origins
from analysis.shared.results import ResultError, Results
from analysis.shared.estimates import (
    NO_DATA,
    Estimate,
    median,
    ratio_by_round,
    ratio_of_counts,
    ratio_of_medians,
)
from analysis.shared.verdicts import Verdict, everywhere

DISTANCES: Final = ("point_distances", "point_triangle_distances")
WORK: Final = (*DISTANCES, "bound_tests", "node_visits")
MEASURES: Final = {"distances": DISTANCES, "distances, bounds and nodes": WORK}


def takes_seed(results: Results, row: int) -> bool:
    """Tells whether the solver is randomized, so that its counted work depends on the seed."""
    return "seed" in results.options(row)


class Cell:
    """The times and counted work of one solver on one scene, over all its seeds."""

    def __init__(self, results: Results, rows: Sequence[int]) -> None:
        rows = list(rows)  # numpy takes a tuple for an index of several dimensions
        cases, first = results.cases, rows[0]
        questions = set[tuple[Any, ...]]()
        for r in rows:
            options = {k: v for k, v in results.options(r).items() if k != "seed"}
            questions.add(
                (
                    json.dumps(options, sort_keys=True),
                    cases.pose_index[r],
                    cases.tolerance[r],
                    cases.source[r],
                    cases.target[r],
                )
            )
        if len(questions) > 1:
            raise ResultError(
                f"{results.path}: rows '{cases.label[first]}' of scene '{cases.scene[first]}' differ in "
                "more than their seed: give each variant a label of its own in the experiment"
            )
        self.results, self.rows = results, rows
        self.seeded = takes_seed(results, first)
        self.origins = origins(results, rows)
        self.failures = Counter(cases.status[r] for r in rows if cases.status[r] != "ok")
        # No median if a seed failed: the seeds that fail, for example by a timeout, would have been
        # the slow ones.
        ok = not self.failures
        self.times = self._by_unit([results.total_by_round(r) for r in rows]) if ok else {}
        self.time: Estimate = median(list(self.times.values()))
        self.wall = (
            median(list(self._by_unit([results.total_by_round(r, "wall") for r in rows]).values()))
            if ok
            else NO_DATA
        )
        self.prepare = (
            float(np.median([results.prepare_seconds(r) for r in rows])) if ok else np.nan
        )
        self.interval = results.reference_of(first)
        self.counters = (
            {name: int(np.median(column[rows])) for name, column in cases.counters.items()}
            if ok
            else {}
        )
        self.peak = (
            float(np.median(cases.peak_bytes[rows]))
            if ok and (cases.peak_bytes[rows] >= 0).all()
            else np.nan
        )

    def _by_unit(self, runs: list[dict[int, float]]) -> dict[int, float]:
        """Returns the times by round if there is a single row, else the median of each row by
        seed."""
        if len(runs) == 1:
            return runs[0]
        return {
            seed: float(np.median(list(run.values())))
            for seed, run in zip(self._seeds(), runs)
            if run
        }

    def _seeds(self) -> list[int]:
        return [int(self.results.options(row).get("seed", i)) for i, row in enumerate(self.rows)]

    def share_preparation(self, other: Cell) -> None:
        """Sets both preparation times to the shorter one, round by round: both solvers build the
        same structure."""
        before = [self.results.prepare_by_round(cell.rows[0]) for cell in (self, other)]
        for cell in (self, other):
            solve = self.results.first_by_round(cell.rows[0])
            usual = min(self.prepare, other.prepare)
            cell.times = {}
            for number, seconds in solve.items():
                cell.times[number] = seconds + min(
                    (prepared[number] for prepared in before if number in prepared), default=usual
                )
            cell.time = median(list(cell.times.values()))
        self.prepare = other.prepare = min(self.prepare, other.prepare)

    def counted(self, names: Sequence[str]) -> dict[int, float]:
        """Returns the sum of these counters by seed; a solver without seeds has one entry. Empty if
        a row failed or none exists."""
        counters = self.results.cases.counters
        if self.failures or not any(name in counters for name in names):
            return {}
        columns = [counters[name] for name in names if name in counters]
        sums = {}
        for seed, row in zip(self._seeds(), self.rows):
            sums[seed] = float(sum(int(column[row]) for column in columns))
        return sums

    def count(self, names: Sequence[str]) -> float:
        """Returns the sum of these counters, as the median over seeds; NaN if nothing is
        counted."""
        counts = list(self.counted(names).values())
        return float(np.median(counts)) if counts and min(counts) > 0 else np.nan

    def cost(self, what: str = "") -> float:
        """Returns the median time in seconds, or the count MEASURES[what] if `what` is given; NaN
        if there is none."""
        return self.count(MEASURES[what]) if what else self.time.value

    def text(self, scale: float) -> str:
        return self.failure_text() if self.failures else numerals.estimate(self.time, scale)

    def failure_text(self) -> str:
        status, count = self.failures.most_common(1)[0]
        word = style.status_word(status)
        return word if count == len(self.rows) else f"{word} ({count} of {len(self.rows)})"

    def status(self) -> str:
        return (
            ", ".join(
                f"{name} {count} of {len(self.rows)}" for name, count in self.failures.items()
            )
            or "ok"
        )


def compare(slow: Cell, fast: Cell, by: float = 1.0) -> Estimate:
    """Returns (time of `slow` / time of `fast`) / by; no data if the times are not comparable.

    Times are paired by round, or by seed if both cells have several seeds. If neither is possible,
    medians are divided.
    """
    if slow.failures or fast.failures:
        return NO_DATA
    if lacking := apart(slow.origins | fast.origins):
        return lacking
    times = {number: seconds / by for number, seconds in slow.times.items()}
    if (len(slow.rows) > 1) == (len(fast.rows) > 1) and times.keys() & fast.times.keys():
        return ratio_by_round(times, fast.times)
    return ratio_of_medians(list(times.values()), list(fast.times.values()))


def compare_work(slow: Cell, fast: Cell, names: Sequence[str]) -> Estimate:
    """Returns the ratio of counted work. It is exact if neither solver is randomized; a single seed
    gives no interval."""
    return ratio_of_counts(slow.counted(names), fast.counted(names), (slow.seeded, fast.seeded))


def in_time_and_work(judge: Callable[[str], Verdict], counted: Iterable[str] = MEASURES) -> Verdict:
    """Returns the verdict on times, `judge("")`, together with the verdicts on each kind of counted
    work."""
    return judge("").with_counts({measure: judge(measure) for measure in counted})


def count_text(cell: Cell | None, names: Sequence[str]) -> str:
    count = cell.count(names) if cell else np.nan
    return numerals.NOTHING if np.isnan(count) else f"{count:,.0f}"


class Grid:
    """A table of cells: scenes as rows, solvers (by label) as columns."""

    def __init__(
        self, results: Results, labels: Sequence[tuple[str, str]] = (), **equal: object
    ) -> None:
        """`labels` are the columns, as (solver, label) pairs; default: all pairs, in the order of
        style.LOOKS.

        `equal`: columns and their value in the rows that count (default: all rows).
        """
        self.results, self.scenes = results, results.scenes
        self.labels = list(labels) or style.order(
            (results.cases.solver[row], results.cases.label[row]) for row in results.rows(**equal)
        )
        self.cells = {
            (scene, label): Cell(results, rows)
            for scene in self.scenes
            for _, label in self.labels
            if (rows := results.rows(scene=scene, label=label, **equal))
        }

    def first(self, scene: str) -> int:
        return self.results.rows(scene=scene)[0]

    def row(self, scene: str) -> list[Cell | None]:
        """Returns the cells of a scene, one per column; None for a solver that was not run on
        it."""
        return [self.cells.get((scene, label)) for _, label in self.labels]

    def texts(self, scene: str, scale: float) -> list[str]:
        return [cell.text(scale) if cell else numerals.NOTHING for cell in self.row(scene)]

    def titles(self) -> list[str]:
        return [style.title(*pair) for pair in self.labels]

    def ratio(self, scene: str, slow: str, fast: str, what: str = "") -> Estimate:
        """Returns slow / fast as a ratio of times, or of counts MEASURES[what]; NO_DATA if one of
        the two was not run."""
        above, below = self.cells.get((scene, slow)), self.cells.get((scene, fast))
        if above is None or below is None:
            return NO_DATA
        return compare_work(above, below, MEASURES[what]) if what else compare(above, below)

    def less(
        self, claim: str, slow: str, fast: str, scenes: Sequence[str] | None = None
    ) -> Verdict:
        """Judges the claim that `fast` takes less than `slow` on all of these scenes, in time and
        in counted work."""
        among = self.scenes if scenes is None else scenes
        return in_time_and_work(
            lambda measure: everywhere(
                claim, [self.ratio(scene, slow, fast, measure) for scene in among]
            )
        )
