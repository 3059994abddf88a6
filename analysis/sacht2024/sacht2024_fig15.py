"""Fig. 15 of Sacht and Jacobson 2024: two nearly equal meshes, on which branch and bound takes
long."""

from __future__ import annotations

from typing import Any, Final

import matplotlib.pyplot as plt
from matplotlib.lines import Line2D

from analysis.sacht2024 import sacht_gallery
from analysis.sacht2024.sacht_limits import Row, above, ratio_of, row_of, time_ratio
from analysis.shared import claims, numerals, scales, style, tables
from analysis.shared.cells import in_time_and_work
from analysis.shared.notes import machine_line, scene_notes, total_title, total_word
from analysis.shared.report import Report
from analysis.shared.results import Results
from analysis.shared.verdicts import Verdict

NEAR: Final = (
    "fandisk"  # the scene whose meshes have nearly the same surface but different triangles
)
COARSE, FINE = 1e-6, 1e-8
PAPER_SECONDS: Final = 180.0  # the paper's program takes longer than this at FINE
PAPER_LOWER: Final = 8.7054e-8  # lower bound / diagonal of A of the paper's pair
PAPER_UPPER: Final = 1.087053e-6  # upper bound / diagonal of A at COARSE
GALLERY: Final = 1.5  # inches
STANDS_IN: Final = "for model 104606 of Thingi10K and its half"
Rows = dict[tuple[str, str, float], int]


def rows_of(results: Results) -> Rows:
    cases = results.cases
    return {
        (cases.scene[row], cases.label[row], float(cases.tolerance[row])): row
        for row in range(len(cases))
    }


def find(results: Results, rows: Rows, scene: str, label: str, tolerance: float) -> Row | None:
    return (
        row_of(results, rows[scene, label, tolerance])
        if (scene, label, tolerance) in rows
        else None
    )


def verdicts(results: Results, rows: Rows) -> list[Verdict]:
    fine, coarse = (find(results, rows, NEAR, "sacht", t) for t in (FINE, COARSE))

    def long(name: str, label: str) -> Verdict:
        """Judges the claim that a solver takes more than three minutes. The verdict is open if it
        was stopped earlier."""
        row = find(results, rows, NEAR, label, FINE)
        bar = (
            Row("ok", dict.fromkeys(row.times or {0: 0.0}, PAPER_SECONDS), 0.0, {}) if row else None
        )
        return above(
            claims.of("sacht2024", "three_minutes", solver=name, label=label),
            time_ratio(row, bar),
            1,
        )

    finer = claims.of("sacht2024", "finer_takes_longer", "nearly the same")
    return [
        long("Sacht", "sacht"),
        long("Zheng", "zheng"),
        in_time_and_work(lambda measure: above(finer, ratio_of(fine, coarse, measure), 1)),
    ]


def make(results: Results) -> Report:
    cases, rows = results.cases, rows_of(results)
    scenes, labels = results.scenes, style.order(zip(cases.solver, cases.label))
    tolerances = sorted(results.in_order("tolerance"), reverse=True)
    table = tables.Table(
        f"{total_title(results)}, ms, on pairs that are nearly the same, and the bounds reached (Fig. 15 of Sacht and Jacobson 2024).",
        [
            "pair",
            "solver",
            "tolerance",
            "l / dA",
            "u / dA",
            "time",
            "distances, bounds and nodes",
            "subdivisions",
            "time: 1e-8 / 1e-6",
        ],
        left=2,
    )
    records: list[tables.Record] = []
    for scene in scenes:
        table.rules.add(len(table.rows))
        for solver, label in labels:
            ratio = time_ratio(*[find(results, rows, scene, label, t) for t in (FINE, COARSE)])
            for t in (t for t in tolerances if (scene, label, t) in rows):
                row = rows[scene, label, t]
                answer, diagonal = row_of(results, row), float(cases.source_diagonal[row])
                low, high = float(cases.lower[row]) / diagonal, float(cases.upper[row]) / diagonal
                work = answer.work["distances, bounds and nodes"]
                table.rows.append(
                    [
                        scene,
                        style.title(solver, label),
                        f"{t:g}",
                        numerals.at_least(cases.lower[row], 5, over=diagonal),
                        numerals.at_most(cases.upper[row], 5, over=diagonal),
                        answer.text(1e3),
                        f"{work:,.0f}" if work else numerals.NOTHING,
                        f"{cases.counters['subdivisions'][row]:,}" if work else numerals.NOTHING,
                        ratio.text() if t == FINE else "",
                    ]
                )
                records.append(
                    {
                        "scene": scene,
                        "label": label,
                        "tolerance": t,
                        "status": answer.status,
                        "lower": low,
                        "upper": high,
                        "seconds": answer.time.value,
                        "low_seconds": answer.time.low,
                        "high_seconds": answer.time.high,
                        "stopped_seconds": answer.limit,
                        "work": work,
                    }
                )
    table.rows.append(
        [
            "paper",
            style.title("sacht"),
            f"{COARSE:g}",
            f"{PAPER_LOWER:g}",
            f"{PAPER_UPPER:g}",
            "about 120000",
            *3 * [numerals.NOTHING],
        ]
    )
    table.rows.append(
        [
            "paper",
            style.title("sacht"),
            f"{FINE:g}",
            numerals.NOTHING,
            numerals.NOTHING,
            "> 180000",
            *3 * [numerals.NOTHING],
        ]
    )
    table.verdicts = verdicts(results, rows)
    table.notes = [
        *scene_notes(results),
        "Neither pair is the paper's (model 104606 of Thingi10K and its half), but the meshes of each are as near to each other, by design.",
        "'> n': stopped at its limit of time or of subdivisions; its bounds hold. "
        + tables.coverage_note(row_of(results, row).time for row in rows.values()),
        f"Here: {machine_line(results)}. Paper: MacBook Air M2, 8 GB.",
    ]
    return Report(
        lambda: draw(results, rows, labels, tolerances, total_word(results)), table, records
    )


def draw(
    results: Results, rows: Rows, labels: list[tuple[str, str]], tolerances: list[float], clock: str
) -> Any:
    """Draws each pair, and below it the time of each solver: filled marks at the finest tolerance,
    open ones at coarser ones.

    An arrow to the right means that the solver was stopped at this time.
    """
    scenes, high = results.scenes, 0.9 + 0.28 * len(labels)
    pairs = sacht_gallery.meshes_of(results, scenes)
    figure = plt.figure(figsize=(style.DOUBLE_COLUMN, high + (GALLERY if pairs else 0.0)))
    grid = figure.add_gridspec(
        2 if pairs else 1, len(scenes), height_ratios=[GALLERY, high] if pairs else [1]
    )
    for k, scene in enumerate(scenes):
        if scene in pairs:
            above = figure.add_subplot(grid[0, k])
            above.set_title(f"{scene}: A, B")
            sacht_gallery.draw(above, results, {scene: pairs[scene]}, False, lambda _: STANDS_IN)
    axes = list[Any]()
    for k in range(len(scenes)):
        axes.append(figure.add_subplot(grid[-1, k], sharey=axes[0] if axes else None))
        axes[-1].tick_params(labelleft=k == 0)
    for ax, scene in zip(axes, scenes):
        for y, (solver, label) in enumerate(labels):
            looks = style.look(solver, label)
            for k, t in enumerate(tolerances):
                answer = find(results, rows, scene, label, t)
                if answer is None:
                    continue
                at = y + 0.24 * (k - 0.5 * (len(tolerances) - 1))
                marker = (
                    style.filled_marker(looks) if t == min(tolerances) else style.open_marker(looks)
                )
                if answer.time.n:
                    style.interval(ax, answer.time, at, 1e3, color=looks.colour, linewidth=1.4)
                    ax.plot(1e3 * answer.time.value, at, **marker)
                elif answer.limit:
                    ax.plot(1e3 * answer.limit, at, **(marker | {"marker": ">"}))
                    ax.annotate(
                        "",
                        (0.99, at),
                        (1e3 * answer.limit, at),
                        xycoords=("axes fraction", "data"),
                        textcoords="data",
                        arrowprops={
                            "arrowstyle": "->",
                            "color": looks.colour,
                            "linewidth": 0.7,
                            "linestyle": (0, (1, 2)),
                            "shrinkA": 4,
                        },
                    )
                    ax.annotate(
                        "stopped",
                        (1e3 * answer.limit, at),
                        xytext=(-5, -2),
                        textcoords="offset points",
                        fontsize=6,
                        ha="right",
                        color="#333333",
                    )
                else:
                    ax.text(
                        0.98,
                        at,
                        f"{style.status_word(answer.status)}, {t:g}",
                        fontsize=6,
                        ha="right",
                        va="center",
                        transform=ax.get_yaxis_transform(),
                        color="#333333",
                    )
        share = results.share(results.rows(scene=scene)[0])
        ax.set_title(f"{scene}: h / dA = {numerals.number(share, 2)}")
        ax.set_xscale("log")
        scales.log_ticks(ax.xaxis)
        ax.set_xlabel(f"{clock} (ms)")
        ax.tick_params(axis="y", length=0)
    axes[0].set_yticks(range(len(labels)), [style.title(*label) for label in labels])
    axes[0].set_ylim(len(labels) - 0.5, -0.5)
    grey = style.Look("", style.GREY, "o")
    style.legend_above(
        figure,
        [
            Line2D(
                [],
                [],
                label=f"tolerance {t:g}",
                **(style.filled_marker(grey) if t == min(tolerances) else style.open_marker(grey)),
            )
            for t in tolerances
        ],
    )
    return figure
