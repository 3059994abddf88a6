"""Which times compare: times of rows that ran one at a time, with one build on one machine, timed by one clock."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

from analysis.shared.results import Results
from analysis.shared.statistics import Estimate, no_data


class Origin(NamedTuple):
    """Everything about a row that decides whether its times compare with another row's times."""

    beside: bool  # --jobs or a cluster may have run other cases at the same time
    machine: str
    build: str  # build of the program; see Results.programs
    clock: str  # "cpu" or "wall"; empty: the row has no times


def origin(results: Results, row: int, clock: str = "") -> Origin:
    """Returns the origin of a row. `clock` replaces the clock of the row, for times that were taken by another one."""
    cases = results.cases
    return Origin(bool(cases.side_by_side[row]), str(cases.machine[row]), str(results.programs[row]),
                  clock or (results.clock_of(row) if results.first_by_round(row) else ""))


def origins(results: Results, rows: Iterable[int]) -> frozenset[Origin]:
    return frozenset(origin(results, row) for row in rows)


def reason_apart(found: Iterable[Origin]) -> str:
    """Returns why the times of these rows do not compare; empty if they do."""
    known = set(found)
    clocks = {one.clock for one in known} - {""}
    return ("run beside others" if any(one.beside for one in known) else
            "of different machines" if len({one.machine for one in known}) > 1 else
            "of different builds" if len({one.build for one in known}) > 1 else
            "by different clocks" if len(clocks) > 1 else "")


def apart(found: Iterable[Origin]) -> Estimate | None:
    """Returns an estimate without data that gives the reason, to use in place of a ratio; None if the times compare."""
    why = reason_apart(found)
    return no_data(f"times {why}") if why else None
