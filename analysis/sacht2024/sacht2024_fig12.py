"""Fig. 12 of Sacht and Jacobson 2024: pictures of the near-zero pairs; A is coloured by its
distance to B."""

from __future__ import annotations

from typing import Any, Final

import matplotlib.pyplot as plt
from matplotlib.colors import PowerNorm

from analysis.sacht2024.sacht_pairs import named, percent
from analysis.shared import mesh_picture, shapes, style, tables
from analysis.shared.notes import machine_line, scene_notes
from analysis.shared.report import NO_TIMES, Report
from analysis.shared.results import ResultError, Results

EDGES: Final = 20_000  # largest number of triangles drawn with edges, which would hide a finer mesh


def make(results: Results) -> Report:
    cases = results.cases
    shown = [
        row
        for row in range(len(cases))
        if results.is_bounded(row) and "distance" in results.fields_of(row)
    ]
    if not shown:
        raise ResultError(
            f"{results.path}: no row has fields: measure it again with 'make {results.stem}'"
        )
    table = tables.Table(
        "The near-zero pairs of Fig. 12 of Sacht and Jacobson 2024, as drawn.",
        ["pair", "A", "B", "|A|", "|B|", "h(A, B), % of the diagonal", "farthest vertex, %"],
        left=3,
    )
    records: list[tables.Record] = []
    for row in shown:
        corners = len(shapes.mesh(results, cases.source[row]).corners)
        diagonal, farthest = float(cases.source_diagonal[row]), float(
            results.fields_of(row)["distance"][:corners].max()
        )
        low, high = results.reference_of(row)
        table.rows.append(
            [
                cases.scene[row],
                cases.source[row],
                cases.target[row],
                f"{cases.source_elements[row]:,}",
                f"{cases.target_elements[row]:,}",
                percent(0.5 * (low + high) / diagonal),
                percent(farthest / diagonal),
            ]
        )
        records.append(
            {
                "scene": cases.scene[row],
                "lower": low,
                "upper": high,
                "diagonal": diagonal,
                "farthest_vertex": farthest,
            }
        )
    table.notes = [
        "None of the models is the paper's.",
        *scene_notes(results),
        f"Here: {machine_line(results)}.",
    ]
    return Report(lambda: draw(results, shown), table, records, clock=NO_TIMES)


def draw(results: Results, shown: list[int]) -> Any:
    """Draws each A above its B. All share one colour scale, by the square root of the distance."""
    cases = results.cases
    figure, axes = plt.subplots(2, len(shown), figsize=(style.DOUBLE_COLUMN, 4.3), squeeze=False)
    pairs = []
    for row in shown:
        pairs.append(
            (
                row,
                shapes.drawn(results, row),
                shapes.mesh(results, cases.target[row]),
                100 / float(cases.source_diagonal[row]),
            )
        )
    scale = PowerNorm(0.5, 0, max(unit * float(a.distances.max()) for _, a, _, unit in pairs))
    for k, (row, a, b, unit) in enumerate(pairs):
        eye, scene = mesh_picture.view_of(cases.scene[row]), cases.scene[row]
        for ax, shape, colours, side in (
            (axes[0][k], a, plt.get_cmap("viridis")(scale(unit * a.colours)), "A"),
            (axes[1][k], b, None, "B"),
        ):
            mesh_picture.draw(
                ax,
                shape,
                eye,
                colours,
                edges=0.1 if side == "B" and len(shape.triangles) <= EDGES else 0.0,
                both_sides=not (shape.closed and shape.manifold),
            )
            elements = cases.source_elements[row] if side == "A" else cases.target_elements[row]
            ax.set_title(f"{side}: {named(scene)}\n{elements:,} triangles")
    bar = figure.colorbar(
        plt.cm.ScalarMappable(scale, "viridis"), ax=list(axes[0]), shrink=0.8, pad=0.01
    )
    bar.set_label("distance to B, % of the\ndiagonal (square-root scale)")
    return figure
