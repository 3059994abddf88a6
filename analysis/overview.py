"""Draws the picture of the README: a coarse mesh coloured by its distance to a fine one, and the
bounds of solvers over time."""

from __future__ import annotations

from typing import Any

import matplotlib.pyplot as plt
from matplotlib.colors import Normalize

from analysis.shared import mesh_picture, shapes, style
from analysis.shared.columns import Floats
from analysis.shared.mesh_picture import View
from analysis.shared.report import Report
from analysis.shared.results import ResultError, Results
from analysis.shared.shapes import Drawn

FROM = (-0.5, 0.3, -1.0)  # direction to the eye, used if the witness is visible from there


def make(results: Results) -> Report:
    answered = [case for case in range(len(results.cases)) if results.is_bounded(case)]
    with_fields = [case for case in answered if "distance" in results.fields_of(case)]
    if not with_fields:
        raise ResultError(
            f"{results.path}: no row has fields: measure it again with 'make {results.stem}'"
        )
    caption = (
        "Left: a coarse mesh, coloured by its distance to a fine one. Right: the intervals of h(A, B) at several tolerances, "
        "against the time to solve."
    )
    return Report(lambda: draw(results, with_fields[0], answered), caption=caption)


def draw(results: Results, shown: int, answered: list[int]) -> Any:
    figure, (left, right) = plt.subplots(
        1, 2, figsize=(style.DOUBLE_COLUMN, 3.0), width_ratios=(1, 1.15)
    )
    draw_distances(results, shown, left, figure)
    corners = len(shapes.mesh(results, results.cases.source[shown]).corners)
    draw_bounds(
        results, answered, float(results.fields_of(shown)["distance"][:corners].max()), right
    )
    return figure


def draw_distances(results: Results, case: int, ax: Any, figure: Any) -> None:
    shown = shapes.drawn(results, case)
    eye = mesh_picture.showing(shown, mesh_picture.view(FROM), results.cases.witness_source[case])
    diagonal = float(results.cases.source_diagonal[case])
    scale = Normalize(0, float(shown.distances.max()) / diagonal)
    colours = plt.get_cmap("viridis")(scale(shown.colours / diagonal))
    mesh_picture.draw(ax, shown, eye, colours)
    magnify(ax, shown, eye, colours, eye.seen(results.cases.witness_source[case])[:2])
    ax.set_title(
        f"A, {results.cases.source_elements[case]:,} triangles: distance to B,\n{results.cases.target_elements[case]:,} triangles (not shown)"
    )
    bar = figure.colorbar(plt.cm.ScalarMappable(scale, "viridis"), ax=ax, shrink=0.75, pad=0.02)
    bar.set_label("distance to B / diagonal of A")


def magnify(ax: Any, shown: Drawn, eye: View, colours: Floats, witness: Floats) -> None:
    """Adds an inset with the surroundings of the witness, ten times as large; the spot of the
    largest distance is tiny."""
    inset = ax.inset_axes((0.66, 0.0, 0.42, 0.42))
    mesh_picture.draw(inset, shown, eye, colours)
    inset.set_aspect("equal", adjustable="datalim")
    reach = 0.042 * (ax.get_ylim()[1] - ax.get_ylim()[0]) / 2
    inset.set(
        xlim=(witness[0] - reach, witness[0] + reach), ylim=(witness[1] - reach, witness[1] + reach)
    )
    inset.plot(*witness, "+", color="#D55E00", markersize=7, markeredgewidth=1.2)
    inset.text(
        0.04,
        0.04,
        "witness, × 10",
        color="#D55E00",
        fontsize=7,
        transform=inset.transAxes,
        va="bottom",
        bbox={"boxstyle": "square,pad=0.15", "facecolor": "white", "linewidth": 0},
    )
    for spine in inset.spines.values():
        spine.set(visible=True, color="#D55E00", linewidth=0.8)
    ax.indicate_inset_zoom(inset, edgecolor="#D55E00", alpha=1.0)


def draw_bounds(results: Results, cases: list[int], at_vertices: float, ax: Any) -> None:
    diagonal, titled, top = (
        float(results.cases.source_diagonal[cases[0]]),
        set[str](),
        2.5 * at_vertices,
    )
    tolerances = len(set(results.cases.tolerance))
    for case in cases:
        looks, first = style.look(
            results.cases.solver[case], str(results.names[case])
        ), results.first_by_round(case)
        if not first:
            continue
        middle = 0.5 * (results.cases.lower[case] + results.cases.upper[case]) / diagonal
        top = max(top, 1.1 * middle * diagonal)
        ax.errorbar(
            [1000 * min(first.values())],
            [middle],
            yerr=[0.5 * results.gap(case) / diagonal],
            color=looks.colour,
            marker=looks.marker,
            capsize=3,
            linestyle="none",
            label=f"{looks.title}, {tolerances} tolerances" if looks.title not in titled else None,
        )
        titled.add(looks.title)
    short = 1 - at_vertices / max(float(results.cases.lower[case]) for case in cases)
    ax.axhline(
        at_vertices / diagonal,
        color=style.GREY,
        linestyle=":",
        label=f"farthest vertex of A, {short:.0%} too small",
    )
    ax.set_xscale("log")
    ax.set(xlabel="time to solve (ms)", ylabel="h(A,B) / diagonal of A", ylim=(0, top / diagonal))
    ax.set_title("intervals of h(A,B)")
    ax.legend(loc="lower center")
