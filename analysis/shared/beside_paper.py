"""Draws our times and the times that a paper prints in one figure: one band per scene, one line per
solver.

Filled marks are our medians, bars their intervals; open marks are the paper's times.
"""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Mapping
from typing import Any

import matplotlib.pyplot as plt
import numpy as np

from analysis.shared import style
from analysis.shared.cells import Cell, Grid
from analysis.shared.notes import stand_in, total_word
from analysis.shared.sizes import tests_claims


def row_title(grid: Grid, scene: str) -> str:
    """Returns the label of a scene: its title and, if we lack the paper's shapes, the shapes used
    instead, in short lines."""
    shapes = stand_in(str(grid.results.cases.scene_note[grid.first(scene)]))
    return "\n".join(
        [style.scene_title(scene), *textwrap.wrap(f"(stand-in: {shapes})" if shapes else "", 22)]
    )


def drawn_seconds(grid: Grid, papers: Mapping[str, Mapping[str, Any]]) -> list[float]:
    """Returns every time that the figure shows, for its limits."""
    seconds: list[float] = []
    for cell in grid.cells.values():
        if cell.time.n:
            seconds += [cell.time.value, cell.time.low, cell.time.high]
    for scene in grid.scenes:
        for _, label in grid.labels:
            if label in papers.get(scene, {}):
                seconds.append(papers[scene][label])
    return [x for x in seconds if np.isfinite(x) and x > 0] or [1.0]


def draw_line(ax: Any, y: float, looks: style.Look, cell: Cell | None, printed: Any) -> None:
    """Draws the times of a solver on a scene at the height y: ours, the one that the paper prints,
    and a thin line from one to the other."""
    ours = cell.time if cell and cell.time.n else None
    if printed and ours:
        thin = {"color": looks.colour, "linewidth": 0.5, "alpha": 0.6, "zorder": 1}
        ax.plot([printed, ours.value], [y, y], **thin)
    if printed:
        ax.plot(printed, y, **style.open_marker(looks))
    if ours:
        style.interval(ax, ours, y, color=looks.colour, linewidth=1.6, zorder=2)
        ax.plot(ours.value, y, **style.filled_marker(looks))
    elif cell:
        # Written on the side away from the paper's mark.
        low, high = ax.get_xlim()
        right = bool(printed and printed**2 < low * high)
        ax.text(
            0.985 if right else 0.015,
            y,
            f"{looks.title}: {cell.text(1)}",
            fontsize=6,
            color="#333333",
            transform=ax.get_yaxis_transform(),
            ha="right" if right else "left",
            va="center",
        )


def draw(
    grid: Grid,
    papers: Mapping[str, Mapping[str, Any]],
    title: Callable[[Grid, str], str] = row_title,
) -> Any:
    """Draws the figure. `title` returns the label of a scene.

    `papers` holds the seconds that the paper prints, by scene and label. They are drawn only if
    this run has the sizes of the paper.
    """
    here = "here, the paper's sizes" if tests_claims(grid.results) else "here, smaller sizes"
    if not tests_claims(grid.results):
        papers = {}
    scenes, cells = grid.scenes, grid.cells
    present = []
    for pair in grid.labels:
        if any((scene, pair[1]) in cells for scene in scenes):
            present.append(pair)
    pitch = len(present) + 1.0
    figure, ax = plt.subplots(figsize=(style.SINGLE_COLUMN, 0.75 + 0.098 * pitch * len(scenes)))
    seconds = drawn_seconds(grid, papers)
    ax.set_xscale("log")
    ax.set_xlim(min(seconds) / 2, max(seconds) * 2)
    for i, scene in enumerate(scenes):
        if i % 2:
            ax.axhspan(i * pitch - 1, (i + 1) * pitch - 1, color="#F5F5F5", linewidth=0, zorder=0)
        for j, (solver, label) in enumerate(present):
            printed = papers.get(scene, {}).get(label)
            looks = style.look(solver, label)
            draw_line(ax, i * pitch + j, looks, cells.get((scene, label)), printed)
    ax.set_ylim(len(scenes) * pitch - 1, -1)
    middles = [i * pitch + (len(present) - 1) / 2 for i in range(len(scenes))]
    ax.set_yticks(middles, [title(grid, scene) for scene in scenes])
    ax.tick_params(axis="y", length=0)
    ax.grid(False, axis="y")
    ax.set_xlabel(f"{total_word(grid.results)} (s)")
    entries = [*style.handles(present, lines=False), style.filled_entry(here)]
    style.legend_above(figure, [*entries, style.open_entry("the paper")] if papers else entries)
    return figure
