"""Compares `scan` with a k-d tree on point sets that are hard for grids and trees: time with
preparation, and counted work."""

from __future__ import annotations

import math
from typing import Any

import matplotlib.pyplot as plt

from analysis.shared import claims, numerals, style, tables
from analysis.shared.cells import Grid
from analysis.shared.notes import machine_line
from analysis.shared.report import Report
from analysis.shared.results import Results
from analysis.shared.estimates import Estimate
from analysis.shared.verdicts import everywhere

OURS, RIVAL = "scan", "kdtree"


def make(results: Results) -> Report:
    cases, grid = results.cases, Grid(results, ((OURS, OURS), (RIVAL, RIVAL)))
    table = tables.Table(
        "Time to prepare and solve, ms, on point sets that are hard for grids and trees.",
        ["workload", style.title(OURS), style.title(RIVAL), "ratio", "our distances per point"],
        left=1,
    )
    records: list[tables.Record] = []
    ratios: list[Estimate] = []
    for scene in grid.scenes:
        first, ours, ratio = (
            grid.first(scene),
            grid.cells.get((scene, OURS)),
            grid.ratio(scene, RIVAL, OURS),
        )
        ratios.append(ratio)
        points = int(cases.source_elements[first])
        distances = (
            ours.counters["point_distances"] / points if ours and not ours.failures else math.nan
        )
        table.rows.append(
            [
                style.scene_title(scene),
                *grid.texts(scene, 1000),
                numerals.ratio(ratio),
                numerals.number(distances),
            ]
        )
        table.notes.append(f"{style.scene_title(scene)}: {cases.scene_note[first]}.")
        row_cells = {label: cell for (_, label), cell in zip(grid.labels, grid.row(scene)) if cell}
        seconds = {f"{label}_seconds": cell.time.value for label, cell in row_cells.items()}
        statuses = {f"{label}_status": cell.status() for label, cell in row_cells.items()}
        records.append(
            {
                "scene": scene,
                "points": points,
                "ratio": ratio.value,
                "ratio_low": ratio.low,
                "ratio_high": ratio.high,
                "n": ratio.n,
                "distances_per_point": distances,
                **seconds,
                **statuses,
            }
        )
    table.verdicts = [everywhere(claims.of("hausbench", "points_hostile"), ratios, "workloads")]
    table.notes += [
        "Ratio: time of the k-d tree over the time of scan.",
        tables.coverage_note(ratios),
        f"{machine_line(results)}.",
    ]
    caption = "Time of the k-d tree over the time of scan, with its interval, on point sets that are hard for grids and trees. Right of 1, scan is faster."
    return Report(lambda: draw(grid.scenes, ratios), table, records, caption=caption)


def draw(scenes: list[str], ratios: list[Estimate]) -> Any:
    """Draws one line per workload: the ratio and its interval."""
    figure, ax = plt.subplots(figsize=(style.SINGLE_COLUMN, 1.0 + 0.16 * len(scenes)))
    for i, ratio in enumerate(ratios):
        style.interval(ax, ratio, i, color=style.look(OURS).colour, linewidth=1)
        if ratio.n:
            ax.plot(ratio.value, i, **style.filled_marker(style.look(OURS)))
    ax.axvline(1.0, color="#333333", linewidth=0.6)
    ax.set_xscale("log")
    ax.set_ylim(len(scenes) - 0.5, -0.5)
    ax.set_yticks(range(len(scenes)), map(style.scene_title, scenes))
    ax.set_xlabel("time of the k-d tree / time of scan")
    return figure
