"""A result file in memory, as load.py reads it: its rows, and the times, bounds and references
computed from them."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np

from analysis.shared.columns import (
    Answers,
    Cases,
    Fields,
    Floats,
    Ints,
    Ledger,
    Models,
    Preparation,
    Repeats,
    Texts,
    Trace,
)
from analysis.shared.estimates import by_round


LEAST_SHARE: Final = 0.2  # an external program is timed by CPU time only if its CPU time is at least this share of its wall time


class ResultError(Exception):
    """A result file cannot be used. The message is one line: the name of the file, the problem and
    what to do."""


class Interval(NamedTuple):
    lower: float
    upper: float


def _hash_of(*texts: str) -> str:
    """Returns the SHA-256 of texts, each preceded by its length; the same value as Sha256 in
    datasets/hash.h."""
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
    whole: Results | None = (
        None  # the results before missing.without() took rows out; None: nothing was taken out
    )

    def rows(self, **equal: object) -> list[int]:
        """Returns the rows of /cases with these values, such as rows(status="ok"), in the order of
        the file."""
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
        """The displayed name of each row's solver: its label, followed by the swept parameters in
        brackets."""
        return np.array(
            [
                f"{label}({variant})" if variant else label
                for label, variant in zip(self.cases.label, self.cases.variant)
            ],
            dtype=object,
        )

    @cached_property
    def programs(self) -> Texts:
        """The build of the program that ran each row. For solvers from plug-ins, column `build`
        holds a hash of program and plug-in."""
        program = str(self.meta.get("build", ""))
        with_plugin = {
            _hash_of(program, str(plugin["sha256"]))
            for plugin in json.loads(self.meta.get("plugins") or "[]")
        }
        return np.array(
            [program if build in with_plugin else build for build in self.cases.build], dtype=object
        )

    def options(self, case: int) -> dict[str, Any]:
        options: dict[str, Any] = json.loads(self.cases.options[case] or "{}")
        return options

    def extras(self, case: int) -> dict[str, float]:
        """Returns the numbers that the solver reports about its run, by name."""
        return {
            name: float(value)
            for name, value in json.loads(self.cases.extras[case] or "{}").items()
        }

    def facts(self, case: int) -> dict[str, str]:
        """Returns the texts that the solver reports about its run, by name."""
        return {
            name: str(text) for name, text in json.loads(self.cases.facts[case] or "{}").items()
        }

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
        return order[begin[case] : begin[case + 1]]

    def clock_of(self, case: int) -> str:
        """Returns the clock to use for this case: "cpu" (of the process and its children) or
        "wall".

        It is "cpu" if one thread works at a time, with two exceptions. A row that was not timed,
        but read off the trace of a finer tolerance, has "wall". So has an external program whose
        CPU time is less than LEAST_SHARE of its wall time: it waits for another process, a GPU or a
        disk, which its CPU time does not include.
        """
        order, begin = self._answers_by_case
        cpu, wall = (
            np.concatenate(
                [answers[order[begin[case] : begin[case + 1]]], repeats[self.repeats_of(case)]]
            )
            for answers, repeats in (
                (self.answers.cpu_seconds, self.repeats.cpu_seconds),
                (self.answers.wall_seconds, self.repeats.wall_seconds),
            )
        )
        if self.cases.clock[case] != "cpu" or not len(cpu) or np.isnan(cpu).any():
            return "wall"
        return (
            "wall"
            if self.cases.solver[case] == "external" and cpu.sum() < LEAST_SHARE * wall.sum()
            else "cpu"
        )

    def first_by_round(self, case: int, clock: str = "") -> dict[int, float]:
        """Returns the time of the first answer of each process, by the clock of the case or by
        `clock`.

        Uses the repeats if the file is of an older program, and the time of the sample if the row
        was read off a trace.
        """
        order, begin = self._answers_by_case
        rows = order[begin[case] : begin[case + 1]]
        seconds = (
            self.answers.cpu_seconds
            if (clock or self.clock_of(case)) == "cpu"
            else self.answers.wall_seconds
        )
        if len(rows):
            return {
                int(self.answers.round[row]): float(seconds[row])
                for row in rows
                if not np.isnan(seconds[row])
            }
        if len(self.repeats_of(case)):
            return self.solve_by_round(case, clock)
        first = float(self.cases.solve_seconds[case])
        return {} if np.isnan(first) else {0: first}

    def reported_by_round(self, case: int) -> dict[int, float]:
        """Returns the times that an external program measured itself, by round; empty if it reports
        none."""
        order, begin = self._answers_by_case
        rows = order[begin[case] : begin[case + 1]]
        return {
            int(self.answers.round[row]): float(self.answers.reported_seconds[row])
            for row in rows
            if not np.isnan(self.answers.reported_seconds[row])
        }

    def solve_by_round(self, case: int, clock: str = "") -> dict[int, float]:
        """Returns the time to solve again in a warm process, by round: the median of its repeats.

        Without repeats it is the time of the first answer. The clock is `clock`, or else the clock
        of the case.
        """
        rows = self.repeats_of(case)
        seconds = (
            self.repeats.cpu_seconds
            if (clock or self.clock_of(case)) == "cpu"
            else self.repeats.wall_seconds
        )
        timed = rows[~np.isnan(seconds[rows])]
        return (
            by_round(self.repeats.round[timed], seconds[timed])
            if len(rows)
            else self.first_by_round(case, clock)
        )

    def prepare_by_round(self, case: int) -> dict[int, float]:
        """Returns the wall time to build all structures, by round; empty if there are none."""
        seconds: dict[int, float] = {}
        order, begin = self._preparation_by_case
        for row in order[begin[case] : begin[case + 1]]:
            number = int(self.preparation.round[row])
            seconds[number] = seconds.get(number, 0.0) + float(
                np.nan_to_num(self.preparation.seconds[row])
            )
        return seconds

    def total_by_round(self, case: int, clock: str = "") -> dict[int, float]:
        """Returns the time to prepare and give the first answer, by round: how long a user waits
        for one answer.

        Repeats would be too short, because pages are in memory already, and structures that are
        built while solving exist. A round without a preparation time gets the median of the others.
        """
        before, usual = self.prepare_by_round(case), self.prepare_seconds(case)
        return {
            number: seconds + before.get(number, usual)
            for number, seconds in self.first_by_round(case, clock).items()
        }

    def wall_seconds(self, case: int) -> Floats:
        """Returns the wall time of solving, one number per round."""
        return np.array(list(self.solve_by_round(case, "wall").values()))

    def total_seconds(self, case: int) -> Floats:
        """Returns the time to prepare and give the first answer, by the clock of the case, one
        number per round."""
        return np.array(list(self.total_by_round(case).values()))

    def prepare_seconds(self, case: int) -> float:
        """Returns the time to build all structures (median over rounds); 0 if there are none."""
        return float(np.nan_to_num(self.cases.prepare_seconds[case]))

    def trace_of(self, case: int) -> Trace:
        part = slice(int(self.cases.trace_begin[case]), int(self.cases.trace_end[case]))
        return Trace(self.trace.seconds[part], self.trace.lower[part], self.trace.upper[part])

    def fields_of(self, case: int) -> dict[str, Floats]:
        """Returns the fields of a case by name, such as `distance`: one number per vertex, element
        or part of A."""
        return {
            str(self.fields.name[row]): self.field_values[
                int(self.fields.begin[row]) : int(self.fields.end[row])
            ]
            for row in np.flatnonzero(self.fields.case == case)
        }

    def is_bounded(self, case: int) -> bool:
        """Tells whether the row has valid bounds, even if it missed the tolerance. Bounds of an
        unsound row are not valid."""
        return bool(
            self.cases.status[case] != "unsound"
            and np.isfinite(self.cases.lower[case])
            and np.isfinite(self.cases.upper[case])
        )

    @cached_property
    def _proven(self) -> dict[tuple[str, str, str, bytes], Interval]:
        proven: dict[tuple[str, str, str, bytes], Interval] = {}
        for case in range(len(self.cases)):
            intervals = [(self.cases.reference_lower[case], self.cases.reference_upper[case])]
            if self.cases.certified[case] == 1 and self.is_bounded(case):
                intervals.append((self.cases.lower[case], self.cases.upper[case]))
            for lower, upper in intervals:
                if np.isfinite(lower) and np.isfinite(upper):
                    old = proven.get(self._asked(case), Interval(-np.inf, np.inf))
                    proven[self._asked(case)] = Interval(
                        max(old.lower, float(lower)), min(old.upper, float(upper))
                    )
        return proven

    def _asked(self, case: int) -> tuple[str, str, str, bytes]:
        poses: Floats = (
            np.concatenate([self.cases.pose[case], self.cases.target_pose[case]]) + 0.0
        )  # + 0.0 makes -0 and 0 the same pose
        quantity = (
            f"{self.cases.quantity[case]} {self.cases.statistic[case]} {self.cases.weigh[case]}"
        )
        return quantity, self.cases.source[case], self.cases.target[case], poses.tobytes()

    def reference_of(self, case: int) -> Interval:
        """Returns the interval that is proven to contain the true distance, h or H; NaN if nothing
        is proven.

        It is [greatest lower, least upper] over the reference answer and all certified rows of the
        same shapes and poses. If bounds contradict each other (`verify` reports this), the two ends
        are exchanged.
        """
        proven = self.proven_of(case)
        return Interval(min(proven), max(proven))

    def proven_of(self, case: int) -> Interval:
        """Like reference_of(), but keeps the order [greatest lower, least upper]: lower > upper if
        bounds contradict each other."""
        return self._proven.get(self._asked(case), Interval(np.nan, np.nan))

    def reference(self, scene: str, pose_index: int = 0) -> Interval:
        rows = self.rows(scene=scene, pose_index=pose_index)
        return self.reference_of(rows[0]) if rows else Interval(np.nan, np.nan)

    def error(self, case: int, lower: float | None = None) -> float:
        """Returns the error of the lower bound: the largest |lower - h| over all h in
        reference_of(); NaN without a reference.

        The lower bound counts as the answer because a witness attains it and programs report it.
        How good the upper bound is, the gap says. `lower` replaces the row's lower bound, for
        samples of its trace.
        """
        low, high = self.reference_of(case)
        value = float(self.cases.lower[case]) if lower is None else lower
        return max(abs(value - low), abs(value - high))

    def middle(self, case: int) -> float:
        """Returns the middle of reference_of(), the best estimate of the true distance."""
        low, high = self.reference_of(case)
        return 0.5 * (low + high)

    def length_unit(self, case: int) -> float:
        """Returns the length by which plots divide distances: the diagonal of A, or 1 if A is a
        single point."""
        return float(self.cases.source_diagonal[case]) or 1.0

    def share(self, case: int) -> float:
        """Returns the true distance, estimated by middle(), as a fraction of the diagonal of A."""
        return self.middle(case) / self.length_unit(case)

    def sizes(self, case: int, between: str = " / ") -> str:
        """Returns the sizes of A and B: '1,000 / 2,000'."""
        return f"{self.cases.source_elements[case]:,}{between}{self.cases.target_elements[case]:,}"

    def check_of(self, case: int) -> str:
        """Returns in words how the harness's check of the lower bound ended."""
        check = str(self.cases.lower_check[case])
        return "not checked (no witness)" if check == "no witness" else check

    def gap(self, case: int) -> float:
        return float(self.cases.upper[case]) - float(self.cases.lower[case])
