"""Kind `motion`: bounds and times pose by pose, for scenes with several poses."""

from __future__ import annotations

from typing import Any

import matplotlib
import matplotlib.pyplot as plt
import numpy as np

from analysis.shared import numerals, style, tables
from analysis.shared.notes import clock_title, machine_line
from analysis.shared.report import Report
from analysis.shared.results import Results
from analysis.views.answers import moving


def make(results: Results) -> Report | None:
    """Returns None if no scene has several poses."""
    scenes = [scene for scene in results.scenes if scene in moving(results)]
    if not scenes:
        return None
    table = tables.Table(
        f"{results.meta.get('title') or results.stem}: over the poses of each scene, at the finest tolerance.",
        [
            "scene",
            "solver",
            "poses",
            "least distance",
            "largest distance",
            "time of a pose, ms: median",
            "largest",
        ],
        left=2,
    )
    records: list[tables.Record] = []
    for scene in scenes:
        table.rules.add(len(table.rows))
        for pair in pairs_of(results, scene):
            rows = finest(results, scene, pair[1])
            times = [1e3 * seconds(results, row) for row in rows]
            middle = [
                0.5 * float(results.cases.lower[row] + results.cases.upper[row])
                for row in rows
                if results.is_bounded(row)
            ]
            least, most = (min(middle), max(middle)) if middle else (np.nan, np.nan)
            known = [time for time in times if np.isfinite(time)]
            table.rows.append(
                [
                    style.scene_title(scene),
                    style.title(*pair),
                    f"{len(rows)}",
                    numerals.number(least, 5),
                    numerals.number(most, 5),
                    numerals.number(float(np.median(known)) if known else np.nan),
                    numerals.number(max(known, default=np.nan)),
                ]
            )
            records += [
                {
                    "scene": scene,
                    "solver": pair[0],
                    "name": pair[1],
                    "pose": int(results.cases.pose_index[row]),
                    "lower": float(results.cases.lower[row]),
                    "upper": float(results.cases.upper[row]),
                    "median_seconds": seconds(results, row),
                    "status": results.cases.status[row],
                }
                for row in rows
            ]
    table.notes = [
        "Distances are the middles of intervals.",
        f"Measured on {machine_line(results)}.",
    ]
    return Report(lambda: draw(results, scenes), table, records)


def pairs_of(results: Results, scene: str) -> list[tuple[str, str]]:
    rows = results.rows(scene=scene)
    return style.order((results.cases.solver[row], results.names[row]) for row in rows)


def finest(results: Results, scene: str, name: str) -> list[int]:
    """Returns the row of each pose, in order, at the solver's finest tolerance."""
    rows = [row for row in results.rows(scene=scene) if results.names[row] == name]
    least = min(float(results.cases.tolerance[row]) for row in rows)
    return sorted(
        (row for row in rows if results.cases.tolerance[row] == least),
        key=lambda row: int(results.cases.pose_index[row]),
    )


def seconds(results: Results, row: int) -> float:
    """Returns the median time to solve one pose; preparation is shared by all poses."""
    found = list(results.first_by_round(row).values())
    return float(np.median(found)) if found else float("nan")


def draw(results: Results, scenes: list[str]) -> Any:
    """Draws each scene, with as many side by side as fit the width: bounds of all poses above,
    times below."""
    across = max(1, min(len(scenes), int(style.width() / 1.1)))
    bands = -(-len(scenes) // across)
    figure, axes = plt.subplots(
        2 * bands, across, figsize=(style.width(), 3.7 * bands), squeeze=False
    )
    shown: dict[tuple[str, str], None] = {}
    for i, scene in enumerate(scenes):
        above, below = axes[2 * (i // across)][i % across], axes[2 * (i // across) + 1][i % across]
        above.sharex(below)
        above.tick_params(labelbottom=False)
        if i % across == 0:
            above.set_ylabel("distance: bounds, and their middle")
            below.set_ylabel(f"{clock_title(results)} to solve (ms)")
        for pair in pairs_of(results, scene):
            looks, rows = style.look(*pair), finest(results, scene, pair[1])
            pose = [int(results.cases.pose_index[row]) for row in rows]
            bounded = np.array([results.is_bounded(row) for row in rows])
            lower, upper = (
                np.where(bounded, column[rows], np.nan)
                for column in (results.cases.lower, results.cases.upper)
            )
            above.fill_between(pose, lower, upper, color=looks.colour, alpha=0.25, linewidth=0)
            above.plot(
                pose, 0.5 * (lower + upper), color=looks.colour, linestyle=looks.line, linewidth=1.0
            )
            below.plot(
                pose,
                [1e3 * seconds(results, row) for row in rows],
                color=looks.colour,
                linestyle=looks.line,
                marker=looks.marker,
                markersize=3,
                linewidth=0.8,
            )
            shown[pair] = None
        above.set_title(style.scene_title(scene))
        below.set(xlabel="pose", yscale="log")
        below.xaxis.set_major_locator(matplotlib.ticker.MaxNLocator(6, integer=True))
    for ax in [ax for row in axes[-2:] for ax in row[len(scenes) - across * (bands - 1) :]]:
        ax.remove()
    style.legend_above(figure, style.handles(shown), columns=5, room=True)
    return figure
