"""Reads result files. The only place in analysis/ that knows their layout, which results/README.md describes."""

from __future__ import annotations

import dataclasses
import json
import tomllib
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

import h5py
import numpy as np
import numpy.typing as npt

from analysis.shared.columns import (
    DEFAULTS,
    Answers,
    Cases,
    Counters,
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
from analysis.shared.statistics import by_round

SCHEMA_VERSION = 2
REFERENCE = Path(__file__).resolve().parents[2] / "results" / "reference"

class ResultError(Exception):
    """A result file that cannot be used: one line with its name and the remedy."""


class Interval(NamedTuple):
    lower: float
    upper: float


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

    def rows(self, **equal: object) -> Ints:
        """Rows of /cases whose named columns have these values, in the order of the file."""
        keep = np.ones(len(self.cases), dtype=bool)
        for column, value in equal.items():
            keep &= getattr(self.cases, column) == value
        return np.flatnonzero(keep)

    def in_order(self, column: str, rows: Iterable[int] | None = None) -> list[Any]:
        """The distinct values of a column of /cases, by first appearance."""
        values = getattr(self.cases, column)
        return list(dict.fromkeys(values if rows is None else (values[row] for row in rows)))

    @cached_property
    def names(self) -> Texts:
        """Of each row the solver as it is shown: its label, with the parameters that the experiment sweeps."""
        return np.array([f"{label}({variant})" if variant else label
                         for label, variant in zip(self.cases.label, self.cases.variant)], dtype=object)

    def options(self, case: int) -> dict[str, Any]:
        options: dict[str, Any] = json.loads(self.cases.options[case] or "{}")
        return options

    def extras(self, case: int) -> dict[str, float]:
        """Numbers that the solver reports of itself, by name."""
        return {name: float(value) for name, value in json.loads(self.cases.extras[case] or "{}").items()}

    def facts(self, case: int) -> dict[str, str]:
        """What the solver reports of itself in words, by name."""
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
        else "wall". "wall" also where nothing was timed: the row was read off the trace of a finer tolerance.
        """
        order, begin = self._answers_by_case
        seconds = np.concatenate([self.answers.cpu_seconds[order[begin[case]:begin[case + 1]]],
                                  self.repeats.cpu_seconds[self.repeats_of(case)]])
        return "cpu" if self.cases.clock[case] == "cpu" and len(seconds) and not np.isnan(seconds).any() else "wall"

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
        """What an outside program says of its time, by round; empty where it says nothing."""
        order, begin = self._answers_by_case
        rows = order[begin[case]:begin[case + 1]]
        return {int(self.answers.round[row]): float(self.answers.reported_seconds[row]) for row in rows
                if not np.isnan(self.answers.reported_seconds[row])}

    def solve_by_round(self, case: int, clock: str = "") -> dict[int, float]:
        """Time of solving once more, by the clock of the case or the one named: the median over the repeats of each
        round, which is a fresh process. Where none was timed, of the first answers.
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
        """Preparing and the first answer, by round: what somebody waits for who asks once. A repeat would be too short:
        what a solver builds on the way, and pages that it touches first, are there already. A round without preparation of
        its own has the median of the others.
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
        """Of all structures together, the median over the rounds; 0 where there were none."""
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
    def _references(self) -> dict[tuple[str, str, str, bytes], Interval]:
        found: dict[tuple[str, str, str, bytes], Interval] = {}
        for case in range(len(self.cases)):
            if self.cases.certified[case] != 1 or not self.is_bounded(case):
                continue
            key, old = self._asked(case), Interval(-np.inf, np.inf)
            old = found.get(key, old)
            found[key] = Interval(max(old.lower, float(self.cases.lower[case])),
                                  min(old.upper, float(self.cases.upper[case])))
        return {key: Interval(min(interval), max(interval)) for key, interval in found.items()}

    def _asked(self, case: int) -> tuple[str, str, str, bytes]:
        poses: Floats = np.concatenate([self.cases.pose[case], self.cases.target_pose[case]]) + 0.0  # -0 and 0 are the same pose
        return self.cases.quantity[case], self.cases.source[case], self.cases.target[case], poses.tobytes()

    def reference_of(self, case: int) -> Interval:
        """What is proven of the true distance of this case, h or H, of the same shapes in the same poses: [greatest lower,
        least upper] of all rows with bounds of certified solvers. NaN where there is no such row. Bounds that contradict each other
        (which `verify` reports) give the interval between the two.
        """
        return self._references.get(self._asked(case), Interval(np.nan, np.nan))

    def reference(self, scene: str, pose_index: int = 0) -> Interval:
        rows = self.rows(scene=scene, pose_index=pose_index)
        return self.reference_of(int(rows[0])) if len(rows) else Interval(np.nan, np.nan)

    def error(self, case: int, lower: float | None = None) -> float:
        """How far the answer may be from the true distance: the largest |lower - h| over all h in the reference, and
        NaN where no certified solver has an answer.

        The answer is the lower bound, because that is what a witness shows and what programs report; how good the upper
        bound is, the gap says. So the gap is what a solver has proved, and the error what it has found. Exact answers
        have error 0 if some row's interval has width 0. `lower` replaces the row's own (for samples of its trace).
        """
        low, high = self.reference_of(case)
        value = float(self.cases.lower[case]) if lower is None else lower
        return max(abs(value - low), abs(value - high))

    def check_of(self, case: int) -> str:
        """What the harness found of the lower bound, in words: a bound without a witness is not checked."""
        check = str(self.cases.lower_check[case])
        return "not checked (no witness)" if check == "no witness" else check

    def gap(self, case: int) -> float:
        return float(self.cases.upper[case] - self.cases.lower[case])


Columns = TypeVar("Columns", Models, Cases, Answers, Repeats, Preparation, Trace, Fields, Ledger)


def _column(group: Any, name: str, kind: str) -> npt.NDArray[Any]:
    data = group[name]
    if (h5py.check_string_dtype(data.dtype) is not None) != (kind == "Texts"):
        raise KeyError(f"{data.name} of type {kind}")
    if kind == "Texts":
        return np.asarray(data.asstr()[()], dtype=object)
    return np.asarray(data[()], dtype={"Floats": np.float64, "Ints": np.int64, "Counters": np.uint64}[kind])


NEEDED = ("cases/identity", "cases/solver", "cases/scene", "cases/status", "cases/lower", "cases/upper", "cases/tolerance",
          "models/name", "models/sha256", "ledger/kind", "trace/seconds")


def _columns(kind: type[Columns], file: Any, name: str) -> Columns:
    """The columns of a group that are known here. A file may have others, and what an older one lacks takes its default."""
    group, values = file.get(name, {}), dict[str, Any]()
    for path in NEEDED:
        if path.startswith(f"{name}/") and path not in file:
            raise KeyError(path)
    for field in dataclasses.fields(kind):
        if field.type == "Counters":
            values[field.name] = {key.removeprefix("counter_"): _column(group, key, "Counters")
                                  for key in group if key.startswith("counter_")}
        elif field.name in group:
            values[field.name] = _column(group, field.name, str(field.type))
    lengths = {len(column) for field, column in values.items() if field != "counters"}
    lengths |= {len(column) for column in values.get("counters", {}).values()}
    if len(lengths) > 1:
        raise KeyError(f"/{name} with columns of one length")
    count = max(lengths, default=0)
    for field in dataclasses.fields(kind):
        if field.name not in values:
            values[field.name] = _usual(DEFAULTS[f"{name}/{field.name}"], count, str(field.type))
    return kind(**values)


def _values(file: Any) -> Floats:
    return np.asarray(_column(file["fields"], "values", "Floats")) if "fields" in file else np.empty(0)


def _usual(value: Any, count: int, kind: str) -> npt.NDArray[Any]:
    dtype: Any = {"Texts": object, "Floats": np.float64, "Ints": np.int64}[kind]
    return np.array([value] * count, dtype=dtype).reshape(count, *np.shape(value))


def _attribute(value: Any) -> Any:
    if isinstance(value, bytes):
        return value.decode()
    return value.item() if isinstance(value, (np.generic, np.ndarray)) and np.size(value) == 1 else value


def _of_profile(results: Results, profile: str) -> Results:
    """The rows that the experiment asks for in this profile."""
    asked = [not profiles or profile in profiles.split(",") for profiles in results.cases.profile]
    keep = np.flatnonzero(asked)
    if len(keep) == len(results.cases):
        return results
    number = np.full(len(results.cases), -1)
    number[keep] = np.arange(len(keep))

    def rows(group: Any, kept: Any) -> Any:
        columns = {field.name: getattr(group, field.name)[kept] for field in dataclasses.fields(group) if field.name != "counters"}
        if hasattr(group, "counters"):
            columns["counters"] = {name: counts[kept] for name, counts in group.counters.items()}
        return type(group)(**columns)

    def details(group: Any) -> Any:
        left = rows(group, number[group.case] >= 0)
        return dataclasses.replace(left, case=number[left.case])

    ledger = results.ledger
    return dataclasses.replace(results, cases=rows(results.cases, keep), answers=details(results.answers), repeats=details(results.repeats),
                               preparation=details(results.preparation), fields=details(results.fields),
                               ledger=rows(ledger, [not of or of == profile for of in ledger.profile]))


def load(path: Path, profile: str = "") -> Results:
    """Opens a result file read-only and reads it whole; of its rows it keeps those of one profile: that of the latest run, unless
    one is named. Throws ResultError for a missing or foreign file, or one of a newer schema.
    """
    stem = path.stem
    if not path.is_file():
        raise ResultError(f"{path}: no such file: measure it with 'make {stem}'")
    again = f"delete it and measure again with 'make {stem}'"
    try:
        with h5py.File(path, "r") as file:
            meta = {key: _attribute(value) for key, value in file["meta"].attrs.items()}
            if int(meta["schema_version"]) > SCHEMA_VERSION:
                raise ResultError(f"{path}: schema version {meta['schema_version']} is newer than {SCHEMA_VERSION}, "
                                  f"the newest that analysis/shared/load.py reads: use the analysis/ of hausbench "
                                  f"{meta.get('hausbench_version', 'that wrote it')}")
            results = Results(path, meta, _columns(Models, file, "models"), _columns(Cases, file, "cases"),
                              _columns(Answers, file, "answers"), _columns(Repeats, file, "repeats"), _columns(Preparation, file, "preparation"),
                              _columns(Trace, file, "trace"), _columns(Fields, file, "fields"), _values(file),
                              _columns(Ledger, file, "ledger"))
    except OSError:
        raise ResultError(f"{path}: not an HDF5 file, or a damaged one: {again}") from None
    except (KeyError, TypeError, ValueError, AttributeError) as problem:
        text = str(problem.args[0]) if problem.args else ""
        raise ResultError(f"{path}: not a hausbench result file ({text}): {again}") from None
    if meta.get("stem") != stem:
        raise ResultError(f"{path}: holds the experiment '{meta.get('stem')}', not '{stem}': rename it or {again}")
    results = _of_profile(results, profile or str(meta.get("profile", "")))
    if len(results.cases) == 0:
        raise ResultError(f"{path}: holds no cases: {again}")
    return results


def paper_numbers(name: str) -> dict[str, Any]:
    """The numbers that a paper prints, from results/reference/<name>.toml."""
    with (REFERENCE / f"{name}.toml").open("rb") as file:
        return tomllib.load(file)


def unchecked_line(results: Results) -> str:
    """For a table or figure: whose lower bounds the harness could not check; empty where it checked all that there are."""
    cases, found = results.cases, dict[str, set[str]]()
    for case in range(len(cases)):
        if cases.status[case] != "unsound" and np.isfinite(cases.lower[case]) and results.check_of(case).startswith("not"):
            found.setdefault(results.check_of(case), set()).add(cases.label[case])
    return "; ".join(f"Lower bounds {check}: {', '.join(sorted(labels))}" for check, labels in sorted(found.items()))


def machine_line(results: Results) -> str:
    """Where and with what the rows were measured, and which bounds were not checked, for the end of a note."""
    unchecked = unchecked_line(results)
    return f"{measured_on(results)}. {unchecked}" if unchecked else measured_on(results)


def measured_on(results: Results) -> str:
    """The machine, the build and the profile."""
    meta = results.meta
    gibibytes = float(meta.get("memory_bytes", np.nan)) / 2**30
    dirty = " with changes" if meta.get("dirty") in (1, True, "true", "yes") else ""
    line = (f"{meta.get('cpu', 'unknown CPU')}, {meta.get('cores', '?')} cores, {gibibytes:.0f} GiB, "
            f"{meta.get('system', 'unknown system')}, {meta.get('compiler', 'unknown compiler')}, "
            f"commit {str(meta.get('commit', 'unknown'))[:10]}{dirty}, profile {meta.get('profile', 'unknown')}")
    for column in ("machine", "build"):
        count = len(set(getattr(results.cases, column)))
        if count > 1:
            line += f"; rows of {count} {column}s are mixed"
    return line
