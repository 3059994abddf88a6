"""Error against run time: for each scene, the gap that each solver has reached by a time, and the
true error of its answer."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import Any, Final

import numpy as np

from analysis import pareto
from analysis.shared import numerals, style, tables
from analysis.shared.notes import clock_note, measured_on
from analysis.shared.report import Report
from analysis.shared.results import Results
from analysis.shared.estimates import Estimate
from analysis.speed import error_curves, error_picture
from analysis.speed.error_curves import Panel

OURS = "cover"
LEAST_TRACED: Final = 0.01  # seconds: the cost of tracing is not computed from shorter runs
HEADER = [
    "scene",
    "solver",
    "asked",
    "time, ms",
    "gap",
    "error of the middle",
    "of the lower bound",
    "tracing, %",
    "distances",
    "rows not ok",
]


def make(results: Results) -> Report:
    """Makes the figure, the table and the CSV."""
    cases = results.cases
    panels: list[Panel] = list(dict.fromkeys(zip(cases.scene, map(int, cases.pose_index))))
    times = error_curves.times_of(results)
    table = tables.Table(
        f"{message(results, panels, times)}Time to prepare and solve, gap and true error of the finest answer, relative to the diagonal of A.",
        HEADER,
        left=2,
    )
    for panel in panels:
        table.rules.add(len(table.rows))
        for rows in lines(results, run_rows(results, panel)):
            table.rows.append(
                [
                    panel_title(panel, panels),
                    line_title(results, rows),
                    *finest(results, rows, times),
                ]
            )
    ours = pareto.cells(results, OURS)
    table.verdicts = [pareto.judge(ours, style.title(OURS))] if ours else []
    table.notes = [
        *left_out(results, panels),
        *unknown(results, panels),
        f"{tables.coverage_note(times.values())} {tracing_note(results)}".strip(),
        "Errors are measured from the middle of the interval that certified solvers prove. Distances: point to point and point to triangle.",
        f"Measured on {measured_on(results)}.",
    ]
    drawn = [panel for panel in panels if run_rows(results, panel)] or panels

    def draw() -> Any:
        rows_of = {panel: run_rows(results, panel) for panel in drawn}
        titles = {panel: panel_title(panel, panels) for panel in drawn}
        return error_picture.draw(results, drawn, rows_of, titles, footnote(results, times))

    records = [record(results, case, times.get(case)) for case in range(len(cases))]
    return Report(draw, table, records, clock=clock(results))


def clock(results: Results) -> str:
    """Returns the sentence on the clock, by the rows that were run; rows read off a trace have no
    clock."""
    timed = {
        results.clock_of(case)
        for case in range(len(results.cases))
        if error_curves.read_off_from(results, case) is None and results.first_by_round(case)
    }
    if len(timed) > 1:
        return clock_note(results)
    word = "wall time" if timed == {"wall"} else "process CPU time, children included"
    read_off = any(
        error_curves.read_off_from(results, case) is not None for case in range(len(results.cases))
    )
    return f"Times are {word}; preparing is wall time{'. Those read off a traced run are scaled to the timed runs' if read_off else ''}."


def footnote(results: Results, times: dict[int, Estimate]) -> str:
    """Returns the footnote of the figure: number of rounds, clock and machine."""
    counts = sorted({time.n for time in times.values() if time.n})
    rounds = (
        f"n = {counts[0] if len(counts) == 1 else f'{counts[0]} to {counts[-1]}'} rounds, "
        if counts
        else ""
    )
    word = clock(results).removeprefix("Times are ").partition(",")[0].partition(";")[0]
    return f"{rounds}{word}; {results.meta.get('cpu', 'unknown CPU')}."


def message(results: Results, panels: Sequence[Panel], times: dict[int, Estimate]) -> str:
    """Says which certified solvers reach the finest tolerance first, and on how many scenes of each
    kind of shape."""
    first: dict[str, Counter[str]] = {}
    for panel in panels:
        rows = [
            row
            for row in run_rows(results, panel)
            if row in times and results.cases.certified[row] == 1
        ]
        least = min((float(results.cases.tolerance[row]) for row in rows), default=np.nan)
        ended = [
            row
            for row in rows
            if results.cases.tolerance[row] == least
            and results.cases.status[row] == "ok"
            and times[row].n
        ]
        winner = min(ended, key=lambda row: times[row].value, default=None)
        first.setdefault(error_picture.domain_of(results, panel), Counter())[
            "" if winner is None else style.title(results.cases.solver[winner])
        ] += 1
    parts = [
        f"{name} on {count} of {sum(counted.values())} scenes"
        + (f" of {domain.lower()}" if domain else "")
        for domain, counted in first.items()
        for name, count in counted.most_common()
        if name
    ]
    return f"First at the finest tolerance, by median time: {'; '.join(parts)}. " if parts else ""


def lines(results: Results, rows: Sequence[int]) -> list[list[int]]:
    """Groups rows by line of the table: one solver with one choice of parameters, with all its
    seeds and tolerances."""
    groups: dict[tuple[str, str, str], list[int]] = {}
    for row in rows:
        groups.setdefault(
            (*error_curves.series_of(results, row), error_curves.resolution_of(results, row)), []
        ).append(row)
    every_series = style.order((solver, label) for solver, label, _ in groups)
    order = {series: i for i, series in enumerate(every_series)}
    return [groups[key] for key in sorted(groups, key=lambda key: order[key[:2]])]


def line_title(results: Results, rows: Sequence[int]) -> str:
    """Returns the solver and its resolution, and 'median of n seeds' if there are several."""
    solver, label = error_curves.series_of(results, rows[0])
    resolution, seeds = error_curves.resolution_of(results, rows[0]), len(
        {results.names[row] for row in rows}
    )
    name = (
        style.title(solver, str(results.names[rows[0]]))
        if resolution
        else style.title(solver, label)
    )
    return f"{name}, median of {seeds} seeds" if seeds > 1 else name


def cost_of_tracing(results: Results, case: int) -> float:
    """Returns error_curves.tracing_cost(), or NaN if the traced run is shorter than
    LEAST_TRACED."""
    trace = results.trace_of(case)
    return (
        error_curves.tracing_cost(results, case)
        if len(trace.seconds) and trace.seconds[-1] >= LEAST_TRACED
        else float("nan")
    )


def tracing_note(results: Results) -> str:
    """Returns a note on the cost of tracing: the median over all traced runs, and over the runs of
    the solver that it slows most."""
    cases, by_solver = results.cases, dict[str, list[float]]()
    for case in map(int, np.flatnonzero(cases.from_trace == 0)):
        if np.isfinite(cost := cost_of_tracing(results, case)):
            by_solver.setdefault(str(cases.solver[case]), []).append(cost)
    if not by_solver:
        return ""
    medians = {solver: float(np.median(costs)) for solver, costs in by_solver.items()}
    worst, all_costs = max(medians, key=lambda solver: medians[solver]), np.concatenate(
        list(by_solver.values())
    )
    return (
        f"Tracing a run of {1e3 * LEAST_TRACED:.0f} ms and more takes {percent(float(np.median(all_costs)))} % longer (median of {len(all_costs)}); the "
        f"largest median of one solver is {percent(medians[worst])} % ({style.title(worst)})."
    )


def percent(share: float) -> str:
    """Formats a fraction in percent, with one decimal below 10 %."""
    return (
        f"{round(100 * share) or 0}" if abs(share) >= 0.1 else f"{round(100 * share, 1) or 0.0:.1f}"
    )


def run_rows(results: Results, panel: Panel) -> list[int]:
    """Returns the rows of a panel, without solvers that do not accept its shapes or were not
    built."""
    cases, rows = results.cases, results.rows(scene=panel[0], pose_index=panel[1])
    run = {results.names[r] for r in rows if cases.status[r] not in ("skipped", "not_built")}
    return [r for r in rows if results.names[r] in run]


def left_out(results: Results, panels: Sequence[Panel]) -> list[str]:
    """Returns a note on the solvers that were not run, and on which scenes."""
    where: dict[str, list[str]] = {}
    labels = style.order(zip(results.cases.solver, results.names))
    for panel in panels:
        run = {results.names[r] for r in run_rows(results, panel)}
        requested = {results.names[r] for r in results.rows(scene=panel[0], pose_index=panel[1])}
        for solver, label in labels:
            if label in requested - run:
                where.setdefault(panel_title(panel, panels), []).append(style.title(solver, label))
    parts = [f"{title}: {', '.join(names)}" for title, names in where.items()]
    why = "they do not take the shapes, were not built, or a model is missing"
    return [f"Not run ({why}): {'; '.join(parts)}."] if parts else []


def panel_title(panel: Panel, panels: Sequence[Panel]) -> str:
    """Returns the scene, with the number of the pose if it has several."""
    several = sum(scene == panel[0] for scene, _ in panels) > 1
    return style.scene_title(panel[0]) + (f", pose {panel[1]}" if several else "")


def unknown(results: Results, panels: Sequence[Panel]) -> list[str]:
    """Returns a note on the scenes whose true errors are unknown, because no certified solver has
    an answer."""
    names = [
        panel_title(panel, panels) for panel in panels if np.isnan(results.reference(*panel)).any()
    ]
    return (
        [f"Error unknown, because no certified solver has an answer: {', '.join(names)}."]
        if names
        else []
    )


def distances(results: Results, case: int) -> int:
    """Returns the number of distances (point to point, point to triangle) that were computed for a
    row."""
    counters = results.cases.counters
    names = ("point_distances", "point_triangle_distances")
    return sum(int(counters[name][case]) for name in names if name in counters)


def error_cells(results: Results, case: int) -> list[str]:
    """Formats the errors of the middle and of the lower bound; '≤ x' if the reference is only known
    to within x."""
    errors, width = error_curves.errors_of(results, case), error_curves.reference_width(
        results, case
    )
    return [
        f"≤ {numerals.at_most(width, 1)}"
        if 0 < width and value <= width
        else numerals.number(value, 2)
        for value in (float(errors.middle[0]), float(errors.lower[0]))
    ]


def finest(results: Results, rows: Sequence[int], times: dict[int, Estimate]) -> list[str]:
    """Returns the cells of a line of the table, from its rows with bounds at the finest
    tolerance."""
    missed = {
        results.cases.status[r]: set[float]() for r in rows if results.cases.status[r] != "ok"
    }
    for r in rows:
        if results.cases.status[r] != "ok":
            missed[results.cases.status[r]].add(float(results.cases.tolerance[r]))
    why = ", ".join(f"{len(at)} {style.status_word(status)}" for status, at in missed.items())
    bounded = [r for r in rows if r in times]
    if not bounded:
        return [numerals.NOTHING] * 7 + [why]
    case = min(bounded, key=lambda r: float(results.cases.tolerance[r]))
    time = error_curves.over_seeds(
        results, [r for r in bounded if results.cases.tolerance[r] == results.cases.tolerance[case]]
    )
    cost, counted = cost_of_tracing(results, case), distances(results, case)
    return [
        numerals.number(float(results.cases.tolerance[case]), 1),
        numerals.estimate(time, 1e3),
        numerals.number(results.gap(case) / results.length_unit(case), 2),
        *error_cells(results, case),
        numerals.NOTHING if np.isnan(cost) else percent(cost),
        f"{counted:,}" if counted else numerals.NOTHING,
        why,
    ]


def record(results: Results, case: int, time: Estimate | None) -> tables.Record:
    """Returns the CSV record of a row."""
    cases, size = results.cases, results.length_unit(case)
    row: tables.Record = {
        name: getattr(cases, name)[case]
        for name in (
            "scene",
            "pose_index",
            "solver",
            "label",
            "variant",
            "tolerance",
            "tolerance_of",
            "status",
            "reason",
        )
    }
    row |= {
        name: float(getattr(cases, name)[case]) for name in ("source_diagonal", "lower", "upper")
    }
    errors = error_curves.errors_of(results, case)
    row |= {"relative_gap": results.gap(case) / size if time else np.nan}
    row |= {
        f"relative_{name}_error": float(values[0]) if time else np.nan
        for name, values in (
            ("lower", errors.lower),
            ("middle", errors.middle),
            ("upper", errors.upper),
        )
    }
    row |= {
        "relative_reference_width": error_curves.reference_width(results, case),
        "tracing_cost": error_curves.tracing_cost(results, case),
        "prepare_seconds": float(cases.prepare_seconds[case]),
        "n": time.n if time else 0,
        "from_trace": int(cases.from_trace[case]),
        "total_median_seconds": time.value if time else np.nan,
        "total_low_seconds": time.low if time else np.nan,
        "total_high_seconds": time.high if time else np.nan,
        "coverage": time.coverage if time else np.nan,
    }
    return row | {name: int(column[case]) for name, column in cases.counters.items()}
