"""Section 5.2 of Sacht and Jacobson 2024: how each solver handles rebuilt inputs on which the
paper's program fails."""

from __future__ import annotations

from typing import Any, Final

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.lines import Line2D

from analysis.shared import claims, numerals, scales, style, tables
from analysis.shared.notes import machine_line, scene_notes
from analysis.shared.report import NO_TIMES, Report
from analysis.shared.results import Results
from analysis.shared.verdicts import FAILS, HOLDS, UNTESTED, Verdict, all_of

PIECES: Final = "too many pieces"
STRAY: Final = "unreferenced vertex"
TOLERANCE: Final = 1e-8  # unless a row has another one
# How the published program behaves, as the paper describes it, or as we observed if the text says
# so.
THEIRS: Final = {
    STRAY: "the vertex counts towards l, which rises above every u; the queue runs empty (mesh 82541)",
    "round-off": "the u of the triangle with the maximum is rounded below l; the queue runs empty (mesh 441717)",
    "far from the origin": "not in the paper; the program was seen to give an interval of width 0 that misses h",
    "nearly the same": "more than three minutes at 1e-8 (mesh 104606, Fig. 15)",
    "the same": "not in the paper; the program's memory was seen to grow without end",
    PIECES: "m = 1e7 is exceeded at 1e-8 for seven pairs, all of which end at 1e-5",
}


def problem(results: Results, row: int) -> str:
    """Returns how the row fails; empty if its bounds hold and, for status `ok`, its gap meets the
    tolerance."""
    cases, status = results.cases, results.cases.status[row]
    low, high = float(cases.lower[row]), float(cases.upper[row])
    if not (np.isfinite(low) and np.isfinite(high)):
        return f"no bounds ({style.status_word(status)})"
    if status == "unsound" or "unsound" in (cases.lower_check[row], cases.upper_check[row]):
        return "unsound"
    if low > high:
        return "lower above upper"
    exact = float(cases.exact[row])
    if np.isfinite(exact) and not low <= exact <= high:
        return "misses h"
    if (
        status == "ok"
        and cases.certified[row] == 1
        and high - low > float(cases.tolerance_absolute[row])
    ):
        return "gap above the tolerance"
    return ""


def text(results: Results, row: int) -> str:
    if failure := problem(results, row):
        return failure
    cases, status = results.cases, results.cases.status[row]
    gap = results.gap(row) / float(cases.source_diagonal[row])
    return (
        f"{'ends' if status == 'ok' else style.status_word(status)}, gap {numerals.number(gap, 2)}"
    )


def certified(results: Results, scene: str) -> list[int]:
    return [int(row) for row in results.rows(scene=scene) if results.cases.certified[row] == 1]


def verdicts(results: Results) -> list[Verdict]:
    """Judges a claim for each scene by counting failures, without statistics, because rows are
    deterministic."""
    judged = []
    for scene in results.scenes:
        rows = certified(results, scene)
        bad = [row for row in rows if problem(results, row)]
        judged.append(
            all_of(
                claims.of("hausbench", "bounds_hold", scene), len(bad), len(rows), len(rows), "rows"
            )
        )
    return [
        *judged,
        reached(results),
        *[
            without_problem(results, name, rows)
            for name, rows in (
                ("enclose", results.rows(solver="sacht")),
                ("stray_vertex", results.rows(solver="sacht", scene=STRAY)),
            )
        ],
    ]


def without_problem(results: Results, name: str, rows: list[int]) -> Verdict:
    return all_of(
        claims.of("sacht2024", name),
        sum(bool(problem(results, row)) for row in rows),
        len(rows),
        len(rows),
        "rows",
    )


def reached(results: Results) -> Verdict:
    """Judges the claim that solver sacht reaches only the coarser tolerance under the paper's limit
    of pieces (max_factor)."""
    cases, claim = results.cases, claims.of("sacht2024", "too_few_pieces")
    status = {
        float(cases.tolerance[row]): cases.status[row]
        for row in results.rows(scene=PIECES, solver="sacht")
        if cases.label[row] != "sacht"
    }
    if not {1e-5, 1e-8} <= status.keys():
        return Verdict(claim, UNTESTED, "no such rows")
    said = ", ".join(f"{t:g}: {style.status_word(status[t])}" for t in (1e-5, 1e-8))
    return Verdict(
        claim, HOLDS if (status[1e-5], status[1e-8]) == ("ok", "budget") else FAILS, said
    )


def make(results: Results) -> Report:
    cases = results.cases
    scenes, labels = results.scenes, style.order(zip(cases.solver, cases.label))
    table = tables.Table(
        "The failures of section 5.2 of Sacht and Jacobson 2024, rebuilt: how each solver ends here, and the gap between its bounds "
        "relative to the diagonal of A.",
        [
            "scene",
            "the paper's program",
            "tolerance",
            "h / dA",
            *[style.title(*label) for label in labels],
        ],
        left=2,
    )
    for scene in scenes:
        first = results.rows(scene=scene)[0]
        distance = numerals.bounds(
            *results.reference(scene), 4, over=float(cases.source_diagonal[first])
        )
        for t in sorted({float(cases.tolerance[row]) for row in results.rows(scene=scene)}):
            cells = [
                text(results, rows[0])
                if (rows := results.rows(scene=scene, label=label, tolerance=t))
                else numerals.NOTHING
                for _, label in labels
            ]
            table.rows.append(
                [scene, THEIRS.get(scene, numerals.NOTHING), f"{t:g}", distance, *cells]
            )
    table.verdicts = verdicts(results)
    table.notes = [
        *scene_notes(results),
        "'ends': within the tolerance. 'precision floor': the tolerance is below what double precision can certify. 'timeout', 'budget spent': "
        "stopped, with the bounds reached by then. h / dA: proven by all certified solvers together. The lower bounds were checked by code "
        "that shares no distance, no tree and no rounding rule with the solvers.",
        f"Here: {machine_line(results)}.",
    ]
    records: list[tables.Record] = [
        {
            "scene": cases.scene[row],
            "label": cases.label[row],
            "tolerance": cases.tolerance[row],
            "status": cases.status[row],
            "lower": cases.lower[row],
            "upper": cases.upper[row],
            "diagonal": cases.source_diagonal[row],
            "exact": cases.exact[row],
            "problem": problem(results, row),
            "lower_check": results.check_of(row),
            "subdivisions": int(cases.counters["subdivisions"][row]),
        }
        for row in range(len(cases))
    ]
    key = (
        "CGAL returns no interval: its mark is its tolerance, or 0 where each face of A is a face of B"
        if "cgal" in cases.solver
        else ""
    )
    return Report(lambda: draw(results, scenes, labels), table, records, key, clock=NO_TIMES)


def draw(results: Results, scenes: list[str], labels: list[tuple[str, str]]) -> Any:
    """Draws the gap of each solver: a filled mark if it reached the tolerance, open if it was
    stopped, a cross if it failed."""
    cases = results.cases
    figure, ax = plt.subplots(figsize=(style.DOUBLE_COLUMN, 2.9))
    gaps = [
        results.gap(row) / float(cases.source_diagonal[row])
        for row in range(len(cases))
        if results.is_bounded(row)
    ]
    axis = scales.LogAxis(ax, [*gaps, TOLERANCE])
    for k, (solver, label) in enumerate(labels):
        looks = style.look(solver, label)
        for row in results.rows(label=label):
            x = scenes.index(cases.scene[row]) + 0.11 * (k - 0.5 * (len(labels) - 1))
            if not results.is_bounded(int(row)):
                ax.annotate(
                    style.STATUS_LETTERS.get(cases.status[row], "F"),
                    (x, 0.97),
                    xycoords=("data", "axes fraction"),
                    fontsize=6.5,
                    color=looks.colour,
                    ha="center",
                    va="top",
                )
                continue
            y = float(axis.place(results.gap(int(row)) / float(cases.source_diagonal[row])))
            ax.plot(
                x,
                y,
                **(
                    style.filled_marker(looks)
                    if cases.status[row] == "ok"
                    else style.open_marker(looks)
                ),
            )
            if float(cases.tolerance[row]) != TOLERANCE:
                ax.annotate(
                    f"at {cases.tolerance[row]:g}",
                    (x, y),
                    xytext=(5, 0),
                    textcoords="offset points",
                    fontsize=6,
                    color="#333333",
                    va="center",
                )
            if problem(results, int(row)):
                ax.plot(x, y, "x", color="black", markersize=8)
    ax.axhline(TOLERANCE, color=style.GREY, linewidth=0.6, linestyle=(0, (2, 2)))
    ax.text(
        1.005,
        TOLERANCE,
        f"tolerance\n{TOLERANCE:g}",
        transform=ax.get_yaxis_transform(),
        fontsize=6.5,
        color=style.GREY,
        va="center",
    )
    ax.set_xlim(-0.5, len(scenes) - 0.5)
    ax.set_xticks(range(len(scenes)), [scene.replace(" ", "\n", 1) for scene in scenes])
    ax.tick_params(axis="x", length=0)
    ax.grid(False, axis="x")
    ax.set_ylabel("gap / diagonal of A")
    style.legend_above(
        figure,
        [
            *style.handles(labels, lines=False),
            style.filled_entry("ends"),
            style.open_entry("stopped, the bounds hold"),
            Line2D([], [], linestyle="none", label="T: stopped, no bounds"),
        ],
        columns=5,
    )
    return figure
