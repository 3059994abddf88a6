"""Decides which times are comparable: rows that ran one at a time, on one machine, with one build
and one clock."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

from analysis.shared.results import Results
from analysis.shared.estimates import Estimate, no_data


class Origin(NamedTuple):
    """The properties of a row that decide whether its times are comparable with another row's
    times."""

    beside: bool  # --jobs or a cluster may have run other cases at the same time
    machine: str
    build: str  # hash of compiler, flags and libraries
    clock: str  # "cpu" or "wall"; empty: the row has no times


def origin(results: Results, row: int, clock: str = "") -> Origin:
    """Returns the origin of a row. `clock` replaces the row's clock if the caller uses times of
    another clock."""
    cases = results.cases
    return Origin(
        bool(cases.side_by_side[row]),
        str(cases.machine[row]),
        str(results.programs[row]),
        clock or (results.clock_of(row) if results.first_by_round(row) else ""),
    )


def origins(results: Results, rows: Iterable[int]) -> frozenset[Origin]:
    return frozenset(origin(results, row) for row in rows)


def reason_apart(found: Iterable[Origin]) -> str:
    """Returns why the times of these rows are not comparable; empty if they are."""
    distinct = set(found)
    clocks = {run.clock for run in distinct} - {""}
    if any(run.beside for run in distinct):
        return "run beside others"
    if len({run.machine for run in distinct}) > 1:
        return "of different machines"
    if len({run.build for run in distinct}) > 1:
        return "of different builds"
    return "by different clocks" if len(clocks) > 1 else ""


def apart(found: Iterable[Origin]) -> Estimate | None:
    """Returns None if the times are comparable, else an estimate without data but with the reason,
    to use as their ratio."""
    why = reason_apart(found)
    return no_data(f"times {why}") if why else None
