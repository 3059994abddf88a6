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


LEAST_SHARE: Final = 0.2  # an outside program is timed by CPU time only if that is at least this share of its wall time


class ResultError(Exception):
    """A result file cannot be used. The message is one line with the name of the file and the remedy."""


class Interval(NamedTuple):
    lower: float
    upper: float


def _hash_of(*texts: str) -> str:
    """Returns the SHA-256 of texts, each preceded by its length, as Sha256 in datasets/hash.h takes it."""
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
    field_values: Floats  # values of all fields; see fields_of()
    ledger: Ledger

    def rows(self, **equal: object) -> list[int]:
        """Returns the rows of /cases whose named columns have these values, in the order of the file."""
        keep = np.ones(len(self.cases), dtype=bool)
        for column, value in equal.items():
            keep &= getattr(self.cases, column) == value
        return [int(row) for row in np.flatnonzero(keep)]

    def in_order(self, column: str, rows: Iterable[int] | None = None) -> list[Any]:
        """Returns the distinct values of a column of /cases, by first appearance."""
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
        """The name under which the solver of each row is shown: its label, with the parameters that the experiment sweeps."""
        return np.array([f"{label}({variant})" if variant else label
                         for label, variant in zip(self.cases.label, self.cases.variant)], dtype=object)

    @cached_property
    def programs(self) -> Texts:
        """The build of the program that ran each row. For a solver of a plug-in, column `build` is a hash of both."""
        program = str(self.meta.get("build", ""))
        with_plugin = {_hash_of(program, str(plugin["sha256"])) for plugin in json.loads(self.meta.get("plugins") or "[]")}
        return np.array([program if build in with_plugin else build for build in self.cases.build], dtype=object)

    def options(self, case: int) -> dict[str, Any]:
        options: dict[str, Any] = json.loads(self.cases.options[case] or "{}")
        return options

    def extras(self, case: int) -> dict[str, float]:
        """Returns the numbers that the solver reports about its run, by name."""
        return {name: float(value) for name, value in json.loads(self.cases.extras[case] or "{}").items()}

    def facts(self, case: int) -> dict[str, str]:
        """Returns the texts that the solver reports about its run, by name."""
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
        """Returns the rows of /repeats of a case."""
        order, begin = self._repeats_by_case
        return order[begin[case]:begin[case + 1]]

    def clock_of(self, case: int) -> str:
        """Returns the clock that counts for this case: "cpu" (of the process and its children) or "wall".

        It is "cpu" if one thread works at a time, else "wall". It is also "wall" if nothing was timed, because the row
        was read off the trace of a finer tolerance, and for an outside program whose CPU time is less than LEAST_SHARE
        of its wall time: such a program waits for another process, a GPU or a disk, whose time is not included.
        """
        order, begin = self._answers_by_case
        cpu, wall = (np.concatenate([answers[order[begin[case]:begin[case + 1]]], repeats[self.repeats_of(case)]])
                     for answers, repeats in ((self.answers.cpu_seconds, self.repeats.cpu_seconds), (self.answers.wall_seconds, self.repeats.wall_seconds)))
        if self.cases.clock[case] != "cpu" or not len(cpu) or np.isnan(cpu).any():
            return "wall"
        return "wall" if self.cases.solver[case] == "external" and cpu.sum() < LEAST_SHARE * wall.sum() else "cpu"

    def first_by_round(self, case: int, clock: str = "") -> dict[int, float]:
        """Returns the time of the first answer of each process, by the clock of the case or by `clock`.

        Files of older programs have repeats in its place. A row that was read off a trace has the time of the sample.
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
        """Returns the time of solving once more, by round, by the clock of the case or by `clock`.

        It is the median over the repeats of a round, which is a fresh process. Without repeats it is the time of the first answer.
        """
        rows = self.repeats_of(case)
        seconds = self.repeats.cpu_seconds if (clock or self.clock_of(case)) == "cpu" else self.repeats.wall_seconds
        known = rows[~np.isnan(seconds[rows])]
        return by_round(self.repeats.round[known], seconds[known]) if len(rows) else self.first_by_round(case, clock)

    def prepare_by_round(self, case: int) -> dict[int, float]:
        """Returns the wall time to build all structures, by round; empty if there are none."""
        found: dict[int, float] = {}
        order, begin = self._preparation_by_case
        for row in order[begin[case]:begin[case + 1]]:
            number = int(self.preparation.round[row])
            found[number] = found.get(number, 0.0) + float(np.nan_to_num(self.preparation.seconds[row]))
        return found

    def total_by_round(self, case: int, clock: str = "") -> dict[int, float]:
        """Returns the time to prepare and give the first answer, by round: the waiting time for a single question.

        A repeat would be too short, because structures that a solver builds on the way, and pages that it touches
        first, are there already. A round without preparation of its own gets the median of the others.
        """
        before, usual = self.prepare_by_round(case), self.prepare_seconds(case)
        return {number: seconds + before.get(number, usual)
                for number, seconds in self.first_by_round(case, clock).items()}

    def wall_seconds(self, case: int) -> Floats:
        """Returns the wall time of solving, one number per round."""
        return np.array(list(self.solve_by_round(case, "wall").values()))

    def total_seconds(self, case: int) -> Floats:
        """Returns the time to prepare and give the first answer, by the clock of the case, one number per round."""
        return np.array(list(self.total_by_round(case).values()))

    def prepare_seconds(self, case: int) -> float:
        """Returns the time to build all structures, the median over the rounds; 0 if there are none."""
        return float(np.nan_to_num(self.cases.prepare_seconds[case]))

    def trace_of(self, case: int) -> Trace:
        part = slice(int(self.cases.trace_begin[case]), int(self.cases.trace_end[case]))
        return Trace(self.trace.seconds[part], self.trace.lower[part], self.trace.upper[part])

    def fields_of(self, case: int) -> dict[str, Floats]:
        """Returns the values of each field of a case by name: a number per vertex, element or piece of A. Empty if it has none."""
        return {str(self.fields.name[row]): self.field_values[int(self.fields.begin[row]):int(self.fields.end[row])]
                for row in np.flatnonzero(self.fields.case == case)}

    def is_bounded(self, case: int) -> bool:
        """Tells whether the row has valid bounds, even if it did not reach the tolerance. An unsound row has none."""
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
        poses: Floats = np.concatenate([self.cases.pose[case], self.cases.target_pose[case]]) + 0.0  # + 0.0 makes -0 and 0 the same pose
        return self.cases.quantity[case], self.cases.source[case], self.cases.target[case], poses.tobytes()

    def reference_of(self, case: int) -> Interval:
        """Returns the interval in which the true distance of this case, h or H, is proven to lie; NaN if nothing is proven.

        It is [greatest lower, least upper] over the reference answer and all rows of certified solvers with bounds, for
        the same shapes in the same poses. Bounds that contradict each other (which `verify` reports) give the interval
        between the two.
        """
        proven = self.proven_of(case)
        return Interval(min(proven), max(proven))

    def proven_of(self, case: int) -> Interval:
        """Returns the same, but bounds that contradict each other cross: [greatest lower, least upper]."""
        return self._proven.get(self._asked(case), Interval(np.nan, np.nan))

    def reference(self, scene: str, pose_index: int = 0) -> Interval:
        rows = self.rows(scene=scene, pose_index=pose_index)
        return self.reference_of(rows[0]) if rows else Interval(np.nan, np.nan)

    def error(self, case: int, lower: float | None = None) -> float:
        """Returns how far the answer may be from the true distance: the largest |lower - h| over all h in the reference.

        NaN if no certified solver has an answer. The answer is the lower bound, because a witness shows it and programs
        report it; the gap says how good the upper bound is. So the gap measures the proof, and the error measures the
        answer. Exact answers have error 0 if the interval of some row has width 0. `lower` replaces the lower bound of
        the row (for samples of its trace).
        """
        low, high = self.reference_of(case)
        value = float(self.cases.lower[case]) if lower is None else lower
        return max(abs(value - low), abs(value - high))

    def middle(self, case: int) -> float:
        """Returns the middle of the interval in which the true distance is proven to lie."""
        low, high = self.reference_of(case)
        return 0.5 * (low + high)

    def length_unit(self, case: int) -> float:
        """Returns the diagonal of A, by which distances are divided; 1 for a single point, so that they stay lengths."""
        return float(self.cases.source_diagonal[case]) or 1.0

    def share(self, case: int) -> float:
        """Returns middle() over the diagonal of A."""
        return self.middle(case) / self.length_unit(case)

    def sizes(self, case: int, between: str = " / ") -> str:
        """Returns the sizes of A and B: '1,000 / 2,000'."""
        return f"{self.cases.source_elements[case]:,}{between}{self.cases.target_elements[case]:,}"

    def check_of(self, case: int) -> str:
        """Returns the result of the harness's check of the lower bound, in words. A bound without a witness is not checked."""
        check = str(self.cases.lower_check[case])
        return "not checked (no witness)" if check == "no witness" else check

    def gap(self, case: int) -> float:
        return float(self.cases.upper[case]) - float(self.cases.lower[case])
