"""Fig. 1 of Sacht and Jacobson 2024: a mesh, its remeshing, and the place where they are farthest
apart."""

from __future__ import annotations

from typing import Any, Final

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import PowerNorm

from analysis.shared import mesh_picture, numerals, shapes, style, tables
from analysis.shared.columns import Floats
from analysis.shared.notes import machine_line
from analysis.shared.report import NO_TIMES, Report
from analysis.shared.results import ResultError, Results
from analysis.shared.shapes import Drawn, Mesh

MARK: Final = "#D55E00"
PAPER: Final = 0.09  # percent of the diagonal; the paper's pair has a smaller distance
REMESHED: Final = "remeshed by CGAL (for TetWild)"


def make(results: Results) -> Report:
    cases = results.cases
    shown = [
        row
        for row in range(len(cases))
        if results.is_bounded(row)
        and "distance" in results.fields_of(row)
        and np.isfinite(cases.witness_source[row]).all()
    ]
    if not shown:
        raise ResultError(
            f"{results.path}: no row has fields and a witness: measure it again with 'make {results.stem}'"
        )
    case = shown[0]
    diagonal = float(cases.source_diagonal[case])
    distance = results.fields_of(case)["distance"][
        : len(shapes.mesh(results, cases.source[case]).corners)
    ]
    low, high = results.reference_of(case)
    table = tables.Table(
        "A mesh and the same surface meshed again (Fig. 1 of Sacht and Jacobson 2024): h(A, B) in percent of the diagonal.",
        ["pair", "|A| / |B|", "h, lower", "h, upper", "at the vertices of A alone", "paper"],
        left=1,
    )
    table.rows.append(
        [
            cases.scene[case],
            results.sizes(case),
            numerals.at_least(low, 6, times=100, over=diagonal),
            numerals.at_most(high, 6, times=100, over=diagonal),
            numerals.number(100 * float(distance.max()) / diagonal),
            f"< {PAPER:g}",
        ]
    )
    table.notes = [
        f"{cases.scene_note[case]}.",
        "The paper's number is for its own pair, relative to the diagonal of the box of A and B.",
        f"Here: {machine_line(results)}.",
    ]
    records: list[tables.Record] = [
        {
            "scene": cases.scene[case],
            "lower": cases.lower[case],
            "upper": cases.upper[case],
            "diagonal": diagonal,
            "at_vertices": float(distance.max()),
        }
    ]
    return Report(lambda: draw(results, case), table, records, clock=NO_TIMES)


def draw(results: Results, case: int) -> Any:
    """Draws A, B, A coloured by its distance to B, and a close-up of the witness."""
    cases = results.cases
    source, target = cases.source[case], cases.target[case]
    a, b, eye = (
        shapes.mesh(results, source),
        shapes.mesh(results, target),
        mesh_picture.view_of(source),
    )
    pair = np.stack([cases.witness_source[case], cases.witness_target[case]])
    figure, axes = plt.subplots(2, 2, figsize=(style.DOUBLE_COLUMN, 5.6))
    for ax, shown, title in (
        (axes[0][0], a, f"A: {source}, {len(a.triangles):,} triangles"),
        (axes[0][1], b, f"B: {REMESHED}, {len(b.triangles):,} triangles"),
    ):
        mesh_picture.draw(ax, shown, eye, edges=0.15, both_sides=not shown.closed)
        ax.set_title(title)
    draw_distances(
        axes[1][0],
        figure,
        shapes.drawn(results, case),
        float(cases.source_diagonal[case]),
        eye,
        pair,
    )
    draw_near(
        axes[1][1],
        a,
        b,
        mesh_picture.across(eye, pair[1] - pair[0]),
        pair,
        float(cases.source_diagonal[case]),
    )
    return figure


def draw_distances(
    ax: Any, figure: Any, a: Drawn, diagonal: float, eye: mesh_picture.View, pair: Floats
) -> None:
    scale = PowerNorm(0.5, 0, 100 * float(a.distances.max()) / diagonal)
    mesh_picture.draw(
        ax,
        a,
        eye,
        plt.get_cmap("viridis")(scale(100 * a.colours / diagonal)),
        both_sides=not a.closed,
    )
    at = eye.seen(pair[0])
    mesh_picture.ring(ax, at, MARK)
    ax.annotate(
        "h(A, B)",
        at[:2],
        xytext=(-30, 26),
        textcoords="offset points",
        color=MARK,
        arrowprops={"arrowstyle": "-", "color": MARK, "linewidth": 0.8, "shrinkB": 5},
        zorder=7,
        bbox={"boxstyle": "square,pad=0.15", "facecolor": "white", "linewidth": 0},
    )
    ax.set_title("A: distance to B")
    figure.colorbar(
        plt.cm.ScalarMappable(scale, "viridis"), ax=ax, shrink=0.75, pad=0.02
    ).set_label("% of the diagonal\n(square-root scale)")


def draw_near(
    ax: Any, a: Mesh, b: Mesh, eye: mesh_picture.View, pair: Floats, diagonal: float
) -> None:
    """Draws the cross-section of both meshes around the witness, with a scale bar in percent of the
    diagonal.

    The cutting plane is parallel to the picture and contains the witness.
    """
    ends = eye.seen(pair)
    room = 2.5 * float(np.linalg.norm(pair[1] - pair[0]))
    for shown, colour, line, name in ((a, "black", "-", "A"), (b, "#0072B2", style.DASHED, "B")):
        cut = section(eye.seen(shown.corners), shown, float(ends[0, 2]))
        for piece in cut:
            ax.plot(*piece.T, color=colour, linestyle=line, linewidth=1.0)
        ax.plot([], [], color=colour, linestyle=line, linewidth=1.0, label=name)
    ax.plot(
        *ends[:, :2].T,
        color=MARK,
        linewidth=1.6,
        marker="o",
        markersize=4,
        label="h(A, B): the witness",
        zorder=5,
    )
    middle = ends[:, :2].mean(axis=0)
    ax.set(
        xlim=(middle[0] - room, middle[0] + room),
        ylim=(middle[1] - room, middle[1] + room),
        aspect="equal",
        xticks=[],
        yticks=[],
    )
    draw_scale(ax, middle, room, diagonal)
    ax.legend(loc="upper left", fontsize=7)
    ax.set_title("cut through A and B at the witness")


def draw_scale(ax: Any, middle: Floats, room: float, diagonal: float) -> None:
    """Draws a scale bar at the lower left: 1, 2 or 5 times a power of ten, in percent of the
    diagonal.

    The frame extends by `room` in all directions from `middle`.
    """
    percent = 100 * 0.5 * room / diagonal
    power = 10.0 ** np.floor(np.log10(percent))
    percent = max(times * power for times in (1, 2, 5) if times * power <= percent)
    left, below = middle - 0.9 * room
    ax.plot(
        [left, left + percent / 100 * diagonal],
        [below, below],
        color="black",
        linewidth=2,
        solid_capstyle="butt",
    )
    ax.annotate(
        f"{percent:g} % of the diagonal",
        (left, below),
        xytext=(0, 4),
        textcoords="offset points",
        fontsize=7,
    )


def section(corners: Floats, shown: Mesh, depth: float) -> list[Floats]:
    """Returns the cross-section at this depth: one segment for each triangle that crosses the
    plane."""
    sides, segments = corners[shown.triangles], list[Floats]()
    above = sides[:, :, 2] > depth
    for triangle, flags in zip(
        sides[above.any(axis=1) & ~above.all(axis=1)], above[above.any(axis=1) & ~above.all(axis=1)]
    ):
        ends = []
        for i in range(3):
            p, q = triangle[i], triangle[(i + 1) % 3]
            if flags[i] != flags[(i + 1) % 3]:
                ends.append((p + (depth - p[2]) / (q[2] - p[2]) * (q - p))[:2])
        segments.append(np.stack(ends))
    return segments
