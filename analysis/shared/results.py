"""A result file in memory: its rows, and the times, bounds and references that follow from them. analysis/shared/load.py reads it."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np

from analysis.shared.columns import Answers, Cases, Fields, Floats, Ints, Ledger, Models, Preparation, Repeats, Texts, Trace
from analysis.shared.statistics import by_round


LEAST_SHARE: Final = 0.2  # of its wall time, that an outside program must spend as CPU time to be timed by it


class ResultError(Exception):
    """A result file that cannot be used: one line with its name and the remedy."""


class Interval(NamedTuple):
    lower: float
    upper: float


def _hash_of(*texts: str) -> str:
    """SHA-256 of texts, each after its length, as Sha256 in datasets/hash.h takes it."""
    digest = hashlib.sha256()
    for text in texts:
        digest.update(len(text.encode()).to_bytes(8, "little") + text.encode())
    return digest.hexdigest()


@dataclass(frozen=True)
class Results:
    path: Path
    meta: dict[str, Any]
    models: Models
    cases: Cases
    answers: Answers
    repeats: Repeats
    preparation: Preparation
    trace: Trace
    fields: Fields
    field_values: Floats  # of all fields, see fields_of
    ledger: Ledger

    def rows(self, **equal: object) -> list[int]:
        """Rows of /cases whose named columns have these values, in the order of the file."""
        keep = np.ones(len(self.cases), dtype=bool)
        for column, value in equal.items():
            keep &= getattr(self.cases, column) == value
        return [int(row) for row in np.flatnonzero(keep)]

    def in_order(self, column: str, rows: Iterable[int] | None = None) -> list[Any]:
        """The distinct values of a column of /cases, by first appearance."""
        values = getattr(self.cases, column)
        return list(dict.fromkeys(values if rows is None else (values[row] for row in rows)))

    @property
    def stem(self) -> str:
        return self.path.stem

    @property
    def scenes(self) -> list[str]:
        return self.in_order("scene")

    @cached_property
    def names(self) -> Texts:
        """Name of the solver of each row as shown: its label, with the parameters that the experiment varies."""
        return np.array([f"{label}({variant})" if variant else label
                         for label, variant in zip(self.cases.label, self.cases.variant)], dtype=object)

    @cached_property
    def programs(self) -> Texts:
        """The build of the program that ran each row. Column `build` of a plug-in's solver is a hash of that and of the plug-in."""
        program = str(self.meta.get("build", ""))
        with_plugin = {_hash_of(program, str(plugin["sha256"])) for plugin in json.loads(self.meta.get("plugins") or "[]")}
        return np.array([program if build in with_plugin else build for build in self.cases.build], dtype=object)

    def options(self, case: int) -> dict[str, Any]:
        options: dict[str, Any] = json.loads(self.cases.options[case] or "{}")
        return options

    def extras(self, case: int) -> dict[str, float]:
        """Numbers that the solver reports of itself, by name."""
        return {name: float(value) for name, value in json.loads(self.cases.extras[case] or "{}").items()}

    def facts(self, case: int) -> dict[str, str]:
        """Returns the texts that the solver reports, by name."""
        return {name: str(text) for name, text in json.loads(self.cases.facts[case] or "{}").items()}

    def _by_case(self, column: Ints) -> tuple[Ints, Ints]:
        order = np.argsort(column, kind="stable")
        return order, np.searchsorted(column[order], np.arange(len(self.cases) + 1))

    @cached_property
    def _answers_by_case(self) -> tuple[Ints, Ints]:
        return self._by_case(self.answers.case)

    @cached_property
    def _repeats_by_case(self) -> tuple[Ints, Ints]:
        return self._by_case(self.repeats.case)

    @cached_property
    def _preparation_by_case(self) -> tuple[Ints, Ints]:
        return self._by_case(self.preparation.case)

    def repeats_of(self, case: int) -> Ints:
        """Rows of /repeats."""
        order, begin = self._repeats_by_case
        return order[begin[case]:begin[case + 1]]

    def clock_of(self, case: int) -> str:
        """Which time stands for this case: "cpu" of the process, children included, where one thread works at a time,
        else "wall". "wall" also where nothing was timed: the row was read off the trace of a finer tolerance. And for an outside program whose CPU
        time is less than LEAST_SHARE of its wall time: it waits for another process, a GPU or a disk, whose time is not in it.
        """
        order, begin = self._answers_by_case
        cpu, wall = (np.concatenate([answers[order[begin[case]:begin[case + 1]]], repeats[self.repeats_of(case)]])
                     for answers, repeats in ((self.answers.cpu_seconds, self.repeats.cpu_seconds), (self.answers.wall_seconds, self.repeats.wall_seconds)))
        if self.cases.clock[case] != "cpu" or not len(cpu) or np.isnan(cpu).any():
            return "wall"
        return "wall" if self.cases.solver[case] == "external" and cpu.sum() < LEAST_SHARE * wall.sum() else "cpu"

    def first_by_round(self, case: int, clock: str = "") -> dict[int, float]:
        """Time of the first answer of each process, by the clock of the case or the one named. Files of older programs have
        repeats in its place, and a row that was read off a trace has the time of the sample.
        """
        order, begin = self._answers_by_case
        rows = order[begin[case]:begin[case + 1]]
        seconds = self.answers.cpu_seconds if (clock or self.clock_of(case)) == "cpu" else self.answers.wall_seconds
        if len(rows):
            return {int(self.answers.round[row]): float(seconds[row]) for row in rows if not np.isnan(seconds[row])}
        if len(self.repeats_of(case)):
            return self.solve_by_round(case, clock)
        first = float(self.cases.solve_seconds[case])
        return {} if np.isnan(first) else {0: first}

    def reported_by_round(self, case: int) -> dict[int, float]:
        """Returns the time that an outside program reports, by round; empty if it reports none."""
        order, begin = self._answers_by_case
        rows = order[begin[case]:begin[case + 1]]
        return {int(self.answers.round[row]): float(self.answers.reported_seconds[row]) for row in rows
                if not np.isnan(self.answers.reported_seconds[row])}

    def solve_by_round(self, case: int, clock: str = "") -> dict[int, float]:
        """Time of solving once more, by the clock of the case or the one named: the median over the repeats of each round, which is a fresh
        process. If no repeat was timed, the first answers.
        """
        rows = self.repeats_of(case)
        seconds = self.repeats.cpu_seconds if (clock or self.clock_of(case)) == "cpu" else self.repeats.wall_seconds
        known = rows[~np.isnan(seconds[rows])]
        return by_round(self.repeats.round[known], seconds[known]) if len(rows) else self.first_by_round(case, clock)

    def prepare_by_round(self, case: int) -> dict[int, float]:
        """Wall time to build all structures, by round; empty where there are none."""
        found: dict[int, float] = {}
        order, begin = self._preparation_by_case
        for row in order[begin[case]:begin[case + 1]]:
            number = int(self.preparation.round[row])
            found[number] = found.get(number, 0.0) + float(np.nan_to_num(self.preparation.seconds[row]))
        return found

    def total_by_round(self, case: int, clock: str = "") -> dict[int, float]:
        """Time of preparing and the first answer, by round, which is the waiting time for a single question. A repeat would be too short,
        because what a solver builds on the way and the pages that it touches first are already there. A round without preparation of its
        own has the median of the others.
        """
        before, usual = self.prepare_by_round(case), self.prepare_seconds(case)
        return {number: seconds + before.get(number, usual)
                for number, seconds in self.first_by_round(case, clock).items()}

    def wall_seconds(self, case: int) -> Floats:
        """Wall time of solving, one number a round."""
        return np.array(list(self.solve_by_round(case, "wall").values()))

    def total_seconds(self, case: int) -> Floats:
        """Preparing and the first answer by the clock of the case, one number a round."""
        return np.array(list(self.total_by_round(case).values()))

    def prepare_seconds(self, case: int) -> float:
        """Time of all structures together, the median over the rounds; 0 if there were none."""
        return float(np.nan_to_num(self.cases.prepare_seconds[case]))

    def trace_of(self, case: int) -> Trace:
        part = slice(int(self.cases.trace_begin[case]), int(self.cases.trace_end[case]))
        return Trace(self.trace.seconds[part], self.trace.lower[part], self.trace.upper[part])

    def fields_of(self, case: int) -> dict[str, Floats]:
        """The values of each field of a case by name: a number for each vertex or element of A. Empty where it has none."""
        return {str(self.fields.name[row]): self.field_values[int(self.fields.begin[row]):int(self.fields.end[row])]
                for row in np.flatnonzero(self.fields.case == case)}

    def is_bounded(self, case: int) -> bool:
        """The row has bounds that hold, whether or not it got as far as it was asked to. An unsound row never does."""
        return bool(self.cases.status[case] != "unsound" and np.isfinite(self.cases.lower[case])
                    and np.isfinite(self.cases.upper[case]))

    @cached_property
    def _proven(self) -> dict[tuple[str, str, str, bytes], Interval]:
        found: dict[tuple[str, str, str, bytes], Interval] = {}
        for case in range(len(self.cases)):
            intervals = [(self.cases.reference_lower[case], self.cases.reference_upper[case])]
            if self.cases.certified[case] == 1 and self.is_bounded(case):
                intervals.append((self.cases.lower[case], self.cases.upper[case]))
            for lower, upper in intervals:
                if np.isfinite(lower) and np.isfinite(upper):
                    old = found.get(self._asked(case), Interval(-np.inf, np.inf))
                    found[self._asked(case)] = Interval(max(old.lower, float(lower)), min(old.upper, float(upper)))
        return found

    def _asked(self, case: int) -> tuple[str, str, str, bytes]:
        poses: Floats = np.concatenate([self.cases.pose[case], self.cases.target_pose[case]]) + 0.0  # -0 and 0 are the same pose
        return self.cases.quantity[case], self.cases.source[case], self.cases.target[case], poses.tobytes()

    def reference_of(self, case: int) -> Interval:
        """Returns the proven interval of the true distance of this case, h or H, for the same shapes in the same poses: [greatest lower,
        least upper] of the reference answer and of all rows with bounds of certified solvers. NaN if there is neither. If bounds
        contradict each other (which `verify` reports), the interval lies between the two.
        """
        proven = self.proven_of(case)
        return Interval(min(proven), max(proven))

    def proven_of(self, case: int) -> Interval:
        """The same, but bounds that contradict each other cross: [greatest lower, least upper]."""
        return self._proven.get(self._asked(case), Interval(np.nan, np.nan))

    def reference(self, scene: str, pose_index: int = 0) -> Interval:
        rows = self.rows(scene=scene, pose_index=pose_index)
        return self.reference_of(rows[0]) if rows else Interval(np.nan, np.nan)

    def error(self, case: int, lower: float | None = None) -> float:
        """How far the answer may be from the true distance: the largest |lower - h| over all h in the reference, and
        NaN where no certified solver has an answer.

        The answer is the lower bound, because a witness shows it and programs report it; the gap shows how good the upper bound is. So the
        gap measures what a solver has proved, and the error what it has found. Exact answers have error 0 if some row's interval has width
        0. `lower` replaces the row's own (for samples of its trace).
        """
        low, high = self.reference_of(case)
        value = float(self.cases.lower[case]) if lower is None else lower
        return max(abs(value - low), abs(value - high))

    def middle(self, case: int) -> float:
        """Middle of the proven interval."""
        low, high = self.reference_of(case)
        return 0.5 * (low + high)

    def length_unit(self, case: int) -> float:
        """The diagonal of A, which distances are divided by; 1 for a single point, so that they stay lengths."""
        return float(self.cases.source_diagonal[case]) or 1.0

    def share(self, case: int) -> float:
        """The same over the diagonal of A."""
        return self.middle(case) / self.length_unit(case)

    def sizes(self, case: int, between: str = " / ") -> str:
        """'1,000 / 2,000'."""
        return f"{self.cases.source_elements[case]:,}{between}{self.cases.target_elements[case]:,}"

    def check_of(self, case: int) -> str:
        """Returns the harness's verdict on the lower bound, in words; a bound without a witness is not checked."""
        check = str(self.cases.lower_check[case])
        return "not checked (no witness)" if check == "no witness" else check

    def gap(self, case: int) -> float:
        return float(self.cases.upper[case]) - float(self.cases.lower[case])
