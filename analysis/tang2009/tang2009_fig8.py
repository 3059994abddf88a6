"""Figure 8 of Tang et al. 2009: pairs side by side, and the points that attain the two-sided
distance."""

from __future__ import annotations

from typing import Any

import matplotlib.pyplot as plt

from analysis.shared import numerals, style, tables
from analysis.shared.notes import machine_line
from analysis.shared.report import NO_TIMES, Report
from analysis.shared.results import Results
from analysis.tang2009 import tang_pictures


def make(results: Results) -> Report:
    cases, shown = results.cases, list[int]()
    table = tables.Table(
        "The two-sided distance of pairs side by side (Fig. 8 of Tang et al. 2009), in percent of A's longest side.",
        ["pair", "", "H, lower", "H, upper", "shown from"],
        left=2,
    )
    records: list[tables.Record] = []
    for scene in results.scenes:
        table.rules.add(len(table.rows))
        rows = results.rows(scene=scene)
        shown.append(next((row for row in rows if results.is_bounded(row)), rows[0]))
        for i, row in enumerate(rows):
            longest = float(cases.source_longest[row])
            forward = cases.witness_direction[row] == "source to target"
            table.rows.append(
                [
                    scene if i == 0 else "",
                    style.title(cases.solver[row], cases.label[row]),
                    numerals.at_least(cases.lower[row], 7, times=100, over=longest),
                    numerals.at_most(cases.upper[row], 7, times=100, over=longest),
                    numerals.NOTHING
                    if not results.is_bounded(row)
                    else "A to B"
                    if forward
                    else "B to A",
                ]
            )
            records.append(
                {
                    "scene": scene,
                    "label": cases.label[row],
                    "status": cases.status[row],
                    "lower": float(cases.lower[row]),
                    "upper": float(cases.upper[row]),
                    "longest": longest,
                    "direction": str(cases.witness_direction[row]),
                }
            )
    table.notes = [
        "A is moved along x by 1.1 times its longest side. Shown from: the direction whose farthest point is the witness. Tolerance 1e-4 of A's "
        "longest side.",
        "; ".join(f"{cases.scene[row]}: {cases.scene_note[row]}" for row in shown) + ".",
        f"Here: {machine_line(results)}.",
    ]
    caption = (
        "The two-sided distance of pairs side by side (Fig. 8 of Tang et al. 2009): A is blue, B is beige, and the green line joins the two points that attain the distance. "
        "Other models stand in for the paper's, as the titles say."
    )
    return Report(lambda: draw(results, shown), table, records, clock=NO_TIMES, caption=caption)


def draw(results: Results, shown: list[int]) -> Any:
    columns = min(3, len(shown))
    figure, axes = plt.subplots(
        -(-len(shown) // columns),
        columns,
        figsize=(style.DOUBLE_COLUMN, 2.0 * -(-len(shown) // columns)),
        squeeze=False,
    )
    for ax in axes.flat[len(shown) :]:
        ax.set_visible(False)
    for ax, row in zip(axes.flat, shown):
        tang_pictures.draw_pair(ax, results, row)
        ax.set_title(tang_pictures.title(results, row))
    return figure
