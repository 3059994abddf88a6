"""Rows of a result file that make one cell of a table: one label on one scene, its seeds pooled.

Times are CPU times of the solving thread, which other work on the machine disturbs least, and the time to prepare. These
solvers have one thread.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Sequence

import numpy as np

from analysis import style, tables
from analysis.load import Floats, ResultError, Results
from analysis.statistics import NO_DATA, Estimate, median, paired_ratio, ratio_by_round, ratio_of_medians


def pooled(runs: list[Floats]) -> Floats:
    """The repeats of one row; of several seeds, the median of each: repeats of one seed are no independent times, and
    an interval over all of them would be too narrow.
    """
    return runs[0] if len(runs) == 1 else np.array([np.median(run) for run in runs if len(run)])


def solve_seconds(results: Results, case: int) -> Floats:
    """By repeat: CPU time where the row has it, else wall time."""
    cpu = results.cpu_seconds(case)
    return cpu if len(cpu) else results.wall_seconds(case)


def by_round(results: Results, cases: Sequence[int], prepare: float | None = None) -> dict[int, float]:
    """Median of preparing and solving over the repeats of each round; `prepare` replaces what the rows say of it."""
    times: dict[int, list[float]] = {}
    for case in cases:
        before = results.prepare_seconds(case) if prepare is None else prepare
        rows = results.repeats_of(case)
        for row, seconds in zip(rows, solve_seconds(results, case)):
            times.setdefault(int(results.repeats.round[row]), []).append(float(seconds) + before)
    return {number: float(np.median(values)) for number, values in times.items()}


class Cell:
    """All rows of one label on one scene, pooled over seeds."""

    def __init__(self, results: Results, rows: Sequence[int]) -> None:
        cases, first = results.cases, rows[0]
        asked = {(json.dumps({k: v for k, v in results.options(r).items() if k != "seed"}, sort_keys=True),
                  cases.pose_index[r], cases.tolerance[r], cases.source[r], cases.target[r]) for r in rows}
        if len(asked) > 1:
            raise ResultError(f"{results.path}: rows '{cases.label[first]}' of scene '{cases.scene[first]}' differ in "
                              "more than their seed: give each variant a label of its own in the experiment")
        self.failures = Counter(str(cases.status[r]) for r in rows if cases.status[r] != "ok")
        self.cases, self.rows = rows, len(rows)
        # Leaving out the seeds that failed would leave out the slow ones: then there is no median.
        ok = not self.failures
        self.seconds = (pooled([solve_seconds(results, r) + results.prepare_seconds(r) for r in rows]) if ok
                        else np.empty(0))
        self.wall = pooled([results.total_seconds(r) for r in rows]) if ok else np.empty(0)
        self.prepare = float(np.median([results.prepare_seconds(r) for r in rows])) if ok else np.nan
        self.time: Estimate = median(self.seconds)
        self.interval = results.reference_of(first)
        self.counters = {name: int(np.median(column[rows])) for name, column in cases.counters.items()} if ok else {}
        self.peak = float(np.median(cases.peak_bytes[rows])) if ok and (cases.peak_bytes[rows] >= 0).all() else np.nan

    def text(self, scale: float) -> str:
        return self.failure_text() if self.failures else tables.estimate(self.time, scale)

    def failure_text(self) -> str:
        status, count = self.failures.most_common(1)[0]
        word = style.STATUS_WORDS.get(status, status)
        return word if count == self.rows else f"{word} ({count} of {self.rows})"

    def status(self) -> str:
        return ", ".join(f"{name} {count} of {self.rows}" for name, count in self.failures.items()) or "ok"


def compare(results: Results, slow: Cell, fast: Cell) -> Estimate:
    """Of several seeds each, paired by seed; of one row each, paired by round, where there are enough of them. Else of
    times measured apart. (Rounds alone would show how times vary, but not how seeds do.)
    """
    if slow.failures or fast.failures:
        return NO_DATA
    if slow.rows > 1 or fast.rows > 1:
        if slow.rows == fast.rows >= 6:
            return paired_ratio(slow.seconds, fast.seconds)
        return ratio_of_medians(slow.seconds, fast.seconds)
    paired = ratio_by_round(by_round(results, slow.cases), by_round(results, fast.cases))
    return paired if paired.n else ratio_of_medians(slow.seconds, fast.seconds)
