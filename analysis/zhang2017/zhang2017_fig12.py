"""Figure 12 of Zhang et al. 2017: the six pairs of Table 3, and the two points that attain the
distance."""

from __future__ import annotations

import math
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.lines import Line2D

from analysis.shared import claims, numerals, shapes, style, tables
from analysis.shared.columns import Floats
from analysis.shared.load import paper_numbers
from analysis.shared.notes import machine_line, stand_in
from analysis.shared.report import NO_TIMES, Report
from analysis.shared.results import Results
from analysis.shared.verdicts import all_of

SOURCE, TARGET, WITNESS = (
    "#00507F",
    "#F2B134",
    "#000000",
)  # A dark, B light, so that they differ in grey
MOST = 6000  # at most so many points of a set are drawn


def row_of(results: Results, scene: str) -> int:
    """Returns a row of the scene with a witness; if none has one, the first row."""
    rows = results.rows(scene=scene)
    return next(
        (
            row
            for row in rows
            if results.is_bounded(row) and np.isfinite(results.cases.witness_source[row]).all()
        ),
        rows[0],
    )


def make(results: Results) -> Report:
    cases, printed = results.cases, paper_numbers("zhang2017_table3")
    papers = {row["scene"]: row for row in printed["row"]}
    scenes = results.scenes
    table = tables.Table(
        "The six pairs of Table 3 of Zhang et al. 2017 (their Fig. 12), and their witnesses.",
        [
            "pair",
            "stands in",
            "|A| / |B|",
            "paper: |A| / |B|",
            "h(A, B)",
            "h / diagonal of A",
            "α",
            "chosen",
            "witness on A",
            "witness on B",
        ],
        left=2,
    )
    records: list[tables.Record] = []
    unlike = 0
    for scene in scenes:
        row, paper = row_of(results, scene), papers.get(scene, {})
        told, low, high = results.extras(row), float(cases.lower[row]), float(cases.upper[row])
        sizes = (int(cases.source_elements[row]), int(cases.target_elements[row]))
        paper_sizes = (paper.get("source_elements", 0), paper.get("target_elements", 0))
        unlike += sizes != paper_sizes
        bounded = results.is_bounded(row)
        status = cases.status[row]
        table.rows.append(
            [
                style.scene_title(scene),
                cases.scene_note[row],
                f"{sizes[0]:,} / {sizes[1]:,}",
                f"{paper_sizes[0]:,} / {paper_sizes[1]:,}",
                numerals.value(low, high, 9) if bounded else style.status_word(status),
                numerals.value(low, high, over=cases.source_diagonal[row])
                if bounded
                else numerals.NOTHING,
                numerals.number(told.get("alpha", math.nan)),
                results.facts(row).get("chosen", numerals.NOTHING).upper(),
                *[
                    str(column[row]) if bounded else ""
                    for column in (cases.witness_source_element, cases.witness_target_element)
                ],
            ]
        )
        records.append(
            {
                "scene": scene,
                "status": status,
                "source_elements": sizes[0],
                "target_elements": sizes[1],
                "lower": low,
                "upper": high,
                **{
                    f"witness_{side}_{axis}": float(points[row][i])
                    for side, points in (
                        ("source", cases.witness_source),
                        ("target", cases.witness_target),
                    )
                    for i, axis in enumerate("xyz")
                },
                **told,
                **results.facts(row),
            }
        )
    table.verdicts = [
        all_of(claims.of("hausbench", "same_sizes"), unlike, len(scenes), len(papers), "pairs")
    ]
    table.notes = [
        "α: overlap of the boxes as a fraction of the smaller one, by which the framework chose a solver. Witnesses: number of the point. In the "
        "picture: the source A, the target B, and the line between the witnesses, seen from a direction in which it is not shortened; at most "
        f"{MOST:,} points of a set are drawn.",
        f"Here: {machine_line(results)}.",
    ]
    caption = (
        "The six pairs of Table 3 of Zhang et al. 2017 (their Fig. 12): the source A, the target B, and the line from the witness on A to its nearest "
        "point of B, whose length is h. Titles name the shapes that stand in for the paper's, and the numbers of points |A| / |B|."
    )
    return Report(lambda: draw(results, scenes), table, records, clock=NO_TIMES, caption=caption)


def shapes_text(results: Results, row: int) -> str:
    """Returns the second line of a title: '(stand-in: an orange sampled twice)'; empty for shapes
    of the paper."""
    shapes_here = stand_in(str(results.cases.scene_note[row]))
    return f"(stand-in: {shapes_here})" if shapes_here else ""


def view(points: Floats, along: Floats) -> Floats:
    """Returns the plane of projection (3 x 2): it contains `along` and the direction perpendicular
    to it in which points spread most.

    It is rotated so that the points are widest from left to right.
    """
    centred = points - points.mean(axis=0)
    length = float(np.linalg.norm(along))
    if length > 0:
        first = along / length
        across = centred - np.outer(centred @ first, first)
        basis = np.stack([first, np.linalg.svd(across, full_matrices=False)[2][0]], axis=1)
    else:
        basis = np.linalg.svd(centred, full_matrices=False)[2][:2].T
    turn = np.linalg.svd(centred @ basis, full_matrices=False)[2].T
    return np.asarray(basis @ turn)


def thinned(points: Floats) -> Floats:
    return points[:: max(1, -(-len(points) // MOST))]


def draw(results: Results, scenes: list[str]) -> Any:
    cases, columns = results.cases, 3
    rows = -(-len(scenes) // columns)
    figure, axes = plt.subplots(
        rows, columns, figsize=(style.DOUBLE_COLUMN, 1.87 * rows + 0.2), squeeze=False
    )
    for ax in axes.ravel():
        ax.set_axis_off()
    for ax, scene in zip(axes.ravel(), scenes):
        row = row_of(results, scene)
        p, q = cases.witness_source[row], cases.witness_target[row]
        shown = np.isfinite(p).all() and np.isfinite(q).all()
        a = shapes.points(results, cases.source[row])
        b = shapes.points(results, cases.target[row])
        drawn: list[tuple[Floats, str]] = []
        if b is not None:
            drawn.append((thinned(b), TARGET))
        if a is not None:
            drawn.append((thinned(shapes.posed(a, cases.pose[row])), SOURCE))
        everything = np.vstack(
            [points for points, _ in drawn] or [np.stack([p, q]) if shown else np.zeros((2, 3))]
        )
        plane = view(everything, q - p if shown else np.zeros(3))
        for points, colour in drawn:
            ax.scatter(
                *(points @ plane).T, s=0.5, c=colour, alpha=0.65, linewidths=0, rasterized=True
            )
        if shown:
            ends = np.stack([p, q]) @ plane
            ax.plot(*ends.T, color="white", linewidth=3.2, solid_capstyle="round", zorder=3)
            ax.plot(*ends.T, color=WITNESS, linewidth=1.3, zorder=4)
            for end, colour in zip(ends, (SOURCE, TARGET)):
                ax.plot(
                    *end,
                    marker="o",
                    markersize=3.4,
                    markerfacecolor=colour,
                    markeredgecolor=WITNESS,
                    markeredgewidth=0.7,
                    zorder=5,
                )
        status = cases.status[row]
        value = (
            f"h = {numerals.value(cases.lower[row], cases.upper[row], 4)}"
            if results.is_bounded(row)
            else style.status_word(status)
        )
        if not drawn:
            value += " (points not available)"
        ax.set_title(
            "\n".join(
                filter(
                    None,
                    [
                        style.scene_title(scene),
                        shapes_text(results, row),
                        f"{cases.source_elements[row]:,} / {cases.target_elements[row]:,} points, {value}",
                    ],
                )
            ),
            fontsize=7,
            pad=2,
        )
        ax.set_aspect("equal", adjustable="datalim")
    entries = [
        Line2D([], [], label=label, marker="o", markersize=4, linestyle="none", color=colour)
        for label, colour in (("source A", SOURCE), ("target B", TARGET))
    ]
    entries.append(
        Line2D(
            [],
            [],
            label="from the witness on A to its nearest point of B",
            color=WITNESS,
            linewidth=1.3,
        )
    )
    style.legend_above(figure, entries, columns=3)
    return figure
