"""Work against precision: for each scene, time beside the gap a solver proved and the error of what it found."""

from __future__ import annotations

import math
import textwrap
from collections import Counter
from typing import Any

import matplotlib.pyplot as plt
import numpy as np

from analysis import pareto
from analysis.shared import scales, style, tables
from analysis.shared.notes import machine_line
from analysis.shared.report import Report
from analysis.shared.results import Results
from analysis.shared.statistics import Estimate, median

OURS = "cover"
Panel = tuple[str, int]  # scene, pose
# Whatever the tolerance, each value of their parameter has one answer: the values are one line with one entry in the legend.
ONE_LINE = {"sampling"}


def make(results: Results) -> Report:
    cases = results.cases
    panels: list[Panel] = list(dict.fromkeys(zip(cases.scene, map(int, cases.pose_index))))
    labels = style.order(zip(cases.solver, results.names))
    times = {case: median(results.total_seconds(case)) for case in range(len(cases)) if results.is_bounded(case)}

    table = tables.Table(
        "Time to prepare and solve, gap and error of the finest answer of each solver, relative to the diagonal of A.",
        ["scene", "solver", "asked", "time, ms", "gap", "error", "distances", "rows not ok"], left=2)
    for panel in panels:
        table.rules.add(len(table.rows))
        for solver, label in labels:
            rows = [r for r in run_rows(results, panel) if results.names[r] == label]
            if rows:
                table.rows.append([panel_title(results, panel, panels), style.title(solver, label),
                                   *finest(results, rows, times)])
    ours = pareto.cells(results, OURS)
    table.verdicts = [pareto.judge(ours, style.title(OURS))] if ours else []
    table.notes = left_out(results, panels, labels) + unknown(results, panels) + [
        tables.coverage_note(times.values()) + "" + " Gap: upper less lower bound. Error: the farthest that the lower "
        "bound, which a witness shows, may be from the true distance, as far as the certified solvers prove it. "
        "Distances: point to point and point to triangle, of one solve; peers do not count them.", f"Measured on {machine_line(results)}."]
    records = [record(results, case, times.get(case)) for case in range(len(cases))]
    return Report(lambda: draw(results, [panel for panel in panels if run_rows(results, panel)] or panels, labels, times), table, records)


def shown_as(solver: str, label: str) -> tuple[str, str]:
    """What a row looks like, and stands as in the legend."""
    return (solver, solver) if solver in ONE_LINE else (solver, label)


def run_rows(results: Results, panel: Panel) -> list[int]:
    """Rows of the solvers that were run on this scene: not those that do not take its shapes, or were not built."""
    cases, rows = results.cases, results.rows(scene=panel[0], pose_index=panel[1])
    run = {results.names[r] for r in rows if cases.status[r] not in ("skipped", "not_built")}
    return [r for r in rows if results.names[r] in run]


def left_out(results: Results, panels: list[Panel], labels: list[tuple[str, str]]) -> list[str]:
    """Who was not run, and on what, in one note."""
    cases = results.cases
    where: dict[str, list[str]] = {}
    for panel in panels:
        run = {results.names[r] for r in run_rows(results, panel)}
        asked = {results.names[r] for r in results.rows(scene=panel[0], pose_index=panel[1])}
        for solver, label in labels:
            if label in asked - run:
                where.setdefault(panel_title(results, panel, panels), []).append(style.title(solver, label))
    parts = [f"{title}: {', '.join(names)}" for title, names in where.items()]
    why = "they do not take the shapes, were not built, or a model is missing"
    return [f"Not run ({why}): {'; '.join(parts)}."] if parts else []


def panel_title(results: Results, panel: Panel, panels: list[Panel]) -> str:
    several = sum(scene == panel[0] for scene, _ in panels) > 1
    return style.scene_title(panel[0]) + (f", pose {panel[1]}" if several else "")


def relative(results: Results, case: int) -> tuple[float, float]:
    """Gap and error, relative to the diagonal of A."""
    size = results.length_unit(case)
    return results.gap(case) / size, results.error(case) / size


def unknown(results: Results, panels: list[Panel]) -> list[str]:
    """Where an error cannot be told, because no certified solver has an answer."""
    names = [panel_title(results, panel, panels) for panel in panels if np.isnan(results.reference(*panel)).any()]
    return [f"Error unknown, for no certified solver has an answer: {', '.join(names)}."] if names else []


def distances(results: Results, case: int) -> int:
    counters = results.cases.counters
    names = ("point_distances", "point_triangle_distances")
    return sum(int(counters[name][case]) for name in names if name in counters)


def finest(results: Results, rows: list[int], times: dict[int, Estimate]) -> list[str]:
    """Cells of the printed table: of the row with the least tolerance that has bounds."""
    failed = Counter(results.cases.status[r] for r in rows if results.cases.status[r] != "ok")
    why = ", ".join(f"{n} {style.status_word(status)}" for status, n in failed.items())
    bounded = [r for r in rows if r in times]
    if not bounded:
        return [tables.NOTHING] * 5 + [why]
    case = min(bounded, key=lambda r: float(results.cases.tolerance[r]))
    gap, error = relative(results, case)
    return [tables.number(float(results.cases.tolerance[case]), 1), tables.estimate(times[case], 1e3),
            tables.number(gap, 2), tables.number(error, 2),
            f"{distances(results, case):,}" if distances(results, case) else tables.NOTHING, why]


def record(results: Results, case: int, time: Estimate | None) -> tables.Record:
    cases = results.cases
    gap, error = relative(results, case) if time else (np.nan, np.nan)
    row: tables.Record = {name: getattr(cases, name)[case] for name in
                          ("scene", "pose_index", "solver", "label", "tolerance", "tolerance_of", "status", "reason")}
    row |= {name: float(getattr(cases, name)[case]) for name in ("source_diagonal", "lower", "upper")}
    row |= {"relative_gap": gap, "relative_error": error, "prepare_seconds": float(cases.prepare_seconds[case]),
            "n": time.n if time else 0, "from_trace": int(cases.from_trace[case]),
            "total_median_seconds": time.value if time else np.nan, "total_low_seconds": time.low if time else np.nan,
            "total_high_seconds": time.high if time else np.nan, "coverage": time.coverage if time else np.nan}
    return row | {name: int(column[case]) for name, column in cases.counters.items()}


def draw(results: Results, panels: list[Panel], labels: list[tuple[str, str]], times: dict[int, Estimate]) -> Any:
    """For each panel the gap above and the error below, on one time axis; failures in the margin at the right.

    Placed by hand, in inches: a layout engine would squeeze the frames to make room for the marks in their margins.
    """
    width, across = style.width(), max(1, int((style.width() + 0.1) / 2.25))  # panels side by side
    bands, wide, tall, columns = -(-len(panels) // across), 1.66, 1.2, max(1, int(5 * width / style.DOUBLE_COLUMN))
    band = 0.22 + 2 * tall + 0.08 + 0.2  # title, frames, tick labels
    entries = list(dict.fromkeys(shown_as(*pair) for pair in labels))
    legend = 0.145 * -(-len(entries) // columns)
    foot = 0.09 + 0.24 * math.ceil(style.DOUBLE_COLUMN / width)  # two notes
    height = bands * band + 0.22 + legend + foot  # axis label, legend, notes
    figure = plt.figure(figsize=(width, height))
    figure.set_layout_engine("none")
    shown: set[tuple[str, str]] = set()
    statuses: set[str] = set()
    for i, panel in enumerate(panels):
        left, floor = 0.5 + (i % across) * 2.25, height - (i // across) * band - 0.22 - 2 * tall - 0.08
        lower, upper = (figure.add_axes([left / width, y / height, wide / width, tall / height])
                        for y in (floor, floor + tall + 0.08))
        upper.sharex(lower)
        rows = run_rows(results, panel)
        for ax, what in ((upper, 0), (lower, 1)):
            shown |= draw_panel(ax, results, rows, times, what)
        upper.tick_params(labelbottom=False)
        upper.set_title(panel_title(results, panel, panels), pad=3)
        failed = Counter((*shown_as(results.cases.solver[r], results.names[r]), results.cases.status[r])
                         for r in rows if results.cases.status[r] != "ok")
        marks = [(style.look(*pair), style.status_letter(status) + (f"{n}" if n > 1 else ""))
                 for pair in entries for (*who, status), n in sorted(failed.items()) if tuple(who) == pair]
        style.margin_marks(upper, marks, height=72 * (2 * tall + 0.08))
        shown |= {(solver, label) for solver, label, _ in failed}
        statuses |= {status for *_, status in failed}
        if i % across == 0:
            for ax, name in ((upper, "gap"), (lower, "error")):
                ax.set_ylabel(f"{name} / diagonal of A")
                ax.yaxis.set_label_coords(-0.22, 0.5)
        if i + across >= len(panels):
            lower.set_xlabel("prepare + solve (s)", labelpad=1)
    figure.legend(handles=style.handles(pair for pair in entries if pair in shown), loc="lower center", ncol=columns,
                  bbox_to_anchor=(0.5, (foot - 0.06) / height), handlelength=2.4)
    key = style.letters_key(statuses)
    thin = ["one traced run, wall time"] * bool((results.cases.trace_end > results.cases.trace_begin).any())
    thin += ["one solver at several steps"] * bool(ONE_LINE & {solver for solver, _ in shown})
    notes = [(f"Thin lines: {', or '.join(thin)}. " if thin else "") + "Bars: interval of the median. Open markers: bounds that hold, but the tolerance was not reached."]
    if key:
        notes.append(f"Right of a frame, rows that are not ok (and how many, if several): {key}.")
    figure.text(0.5, 0.03 / height, "\n".join(line for note in notes for line in textwrap.wrap(note, int(24 * width))), ha="center", va="bottom", fontsize=7, color=style.GREY)
    return figure


def draw_panel(ax: Any, results: Results, rows: list[int], times: dict[int, Estimate],
               what: int) -> set[tuple[str, str]]:
    """what = 0: gap, 1: error. Returns what was drawn, for the legend."""
    cases = results.cases
    points = {case: relative(results, case)[what] for case in rows if case in times and times[case].n}
    points = {case: y for case, y in points.items() if np.isfinite(y)}
    lines = {}
    for pair in dict.fromkeys((cases.solver[r], results.names[r]) for r in rows):
        if pair[0] in ONE_LINE:
            continue  # its answers are joined instead
        traced = [r for r in rows if (cases.solver[r], results.names[r]) == pair and cases.status[r] != "unsound"
                  and cases.trace_end[r] > cases.trace_begin[r]]
        if traced:
            case = min(traced, key=lambda r: float(cases.tolerance[r]))
            lines[case] = trace_line(results, case, what)
    axis = scales.LogAxis(ax, np.concatenate([np.array(list(points.values())), *[y for _, y in lines.values()]]), 5)
    ax.set_xscale("log")
    for solver in sorted(ONE_LINE & {cases.solver[case] for case in points}):
        at_times = sorted((times[case].value, y) for case, y in points.items() if cases.solver[case] == solver)
        looks = style.look(solver)
        ax.plot([x for x, _ in at_times], axis.place([y for _, y in at_times]), color=looks.colour, linewidth=0.7, zorder=2)
    for case, (x, y) in lines.items():
        looks = style.look(cases.solver[case], results.names[case])
        ax.plot(x, axis.place(y), color=looks.colour, linestyle=looks.line, linewidth=0.7, alpha=0.75, zorder=2,
                drawstyle="steps-post")
    for case, y in points.items():
        looks, time = style.look(*shown_as(cases.solver[case], results.names[case])), times[case]
        at = float(axis.place(y))
        style.interval(ax, time, at, color=looks.colour, linewidth=1.0, zorder=3)
        marker = style.filled_marker(looks) if cases.status[case] == "ok" else style.open_marker(looks)
        ax.plot([time.value], [at], zorder=4, **marker)
    scales.log_ticks(ax.xaxis)
    return {shown_as(cases.solver[case], results.names[case]) for case in [*points, *lines]}


def trace_line(results: Results, case: int, what: int) -> tuple[Any, Any]:
    """Times and values of the samples that have finite ones."""
    trace, size = results.trace_of(case), results.length_unit(case)
    values = trace.upper - trace.lower if what == 0 else np.array([results.error(case, float(x)) for x in trace.lower])
    seconds = trace.seconds + results.prepare_seconds(case)
    keep = np.isfinite(values) & (seconds > 0)
    return seconds[keep], values[keep] / size
