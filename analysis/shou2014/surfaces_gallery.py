"""Pairs of algebraic surfaces with known distances: which solvers' intervals contain it, and
pictures of voxels and witnesses."""

from __future__ import annotations

import ast
from typing import Any

import matplotlib.pyplot as plt
from matplotlib.legend_handler import HandlerTuple
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle
import numpy as np
import numpy.typing as npt

from analysis.shared import claims, numerals, style, tables
from analysis.shared.columns import Floats
from analysis.shared.drawable import as_formula
from analysis.shared.notes import machine_line
from analysis.shared.report import Report
from analysis.shared.results import Results
from analysis.shared.estimates import median
from analysis.shared.verdicts import Verdict, all_of

VOXELS = 32  # along an axis, in pictures


class Surface:
    """The surface where a polynomial in x, y and z vanishes, clipped by a box. For pictures
    only."""

    def __init__(self, polynomial: str, box: Floats) -> None:
        self.tree = ast.parse(polynomial.replace("^", "**"), mode="eval").body
        self.low, self.high = box[0::2], box[1::2]

    def bounds(self, low: dict[str, Floats], high: dict[str, Floats]) -> tuple[Floats, Floats]:
        """Returns bounds of the polynomial over many boxes at once (natural interval extension, not
        rounded outward)."""
        return _bounds(self.tree, low, high)

    def kept(self, voxels: int) -> npt.NDArray[np.bool_]:
        """Returns which voxels of a grid may meet the surface."""
        lines = [np.linspace(a, b, voxels + 1) for a, b in zip(self.low, self.high)]
        low = dict(zip("xyz", np.meshgrid(*[line[:-1] for line in lines], indexing="ij")))
        high = dict(zip("xyz", np.meshgrid(*[line[1:] for line in lines], indexing="ij")))
        least, most = self.bounds(low, high)
        return np.asarray((least <= 0) & (most >= 0))


def _power(low: Floats, high: Floats, n: int) -> tuple[Floats, Floats]:
    a, b = low**n, high**n
    if n % 2:
        return a, b
    return np.where((low <= 0) & (high >= 0), 0.0 if n else 1.0, np.minimum(a, b)), np.maximum(a, b)


def _bounds(
    node: ast.expr, low: dict[str, Floats], high: dict[str, Floats]
) -> tuple[Floats, Floats]:
    if isinstance(node, ast.Name):
        return low[node.id], high[node.id]
    if isinstance(node, ast.Constant) and isinstance(node.value, (int, float)):
        value = np.asarray(float(node.value))
        return value, value
    if isinstance(node, ast.UnaryOp):
        a, b = _bounds(node.operand, low, high)
        return (-b, -a) if isinstance(node.op, ast.USub) else (a, b)
    if isinstance(node, ast.BinOp):
        a, b = _bounds(node.left, low, high)
        if isinstance(node.op, ast.Pow):
            assert isinstance(node.right, ast.Constant) and isinstance(node.right.value, int)
            return _power(a, b, node.right.value)
        c, d = _bounds(node.right, low, high)
        if isinstance(node.op, ast.Add):
            return a + c, b + d
        if isinstance(node.op, ast.Sub):
            return a - d, b - c
        if isinstance(node.op, ast.Div):
            c, d = 1 / d, 1 / c
        products = np.stack(np.broadcast_arrays(a * c, a * d, b * c, b * d))
        return products.min(axis=0), products.max(axis=0)
    raise ValueError(f"not part of a polynomial: {ast.dump(node)}")


def holds(results: Results, row: int, exact: float) -> bool:
    """Tells whether the interval contains h, which the experiment states rounded to the nearest
    double."""
    return not (
        results.cases.lower[row] > exact * (1 + 1e-15)
        or results.cases.upper[row] < exact * (1 - 1e-15)
    )


def cells_of(results: Results, row: int, exact: float) -> list[str]:
    """Returns the table cells of a row: interval and time."""
    cases, status = results.cases, results.cases.status[row]
    low, high = float(cases.lower[row]), float(cases.upper[row])
    word = "stalled" if cases.solver_status[row] == "stalled" else style.status_word(status)
    if not (np.isfinite(low) and np.isfinite(high)):
        return [word, numerals.NOTHING]
    said = ("" if status == "ok" else f" ({word})") + (
        "" if holds(results, row, exact) else ", misses h"
    )
    return [
        f"{numerals.bounds(low, high, 6)}{said}",
        numerals.number(median(results.total_seconds(row)).value),
    ]


def holds_distance(results: Results) -> Verdict:
    """Judges the claim that every interval of the published method contains the distance. Rows
    without one do not count."""
    cases, rows = results.cases, results.rows(solver="interval_subdivision")
    bounded = [
        row
        for row in rows
        if np.isfinite([cases.lower[row], cases.upper[row], cases.exact[row]]).all()
    ]
    unlike = sum(not holds(results, row, float(cases.exact[row])) for row in bounded)
    return all_of(
        claims.of("shou2014", "holds_distance"), unlike, len(bounded), len(rows), "intervals"
    )


def make(results: Results) -> Report:
    cases = results.cases
    scenes, labels = results.scenes, style.order(zip(cases.solver, cases.label))
    table = tables.Table(
        "Pairs of algebraic surfaces with a known directed distance h(A,B).",
        [
            "pair",
            "h",
            *[
                f"{style.title(*pair)}{column}"
                for pair in labels
                for column in (": interval", ", s")
            ],
            "checked",
            "meshes off by, A",
            "B",
        ],
    )
    table.left = 1
    records: list[tables.Record] = []
    for scene in scenes:
        exact = float(cases.exact[results.rows(scene=scene)[0]])
        cells, checks, off = [scene, numerals.number(exact, 6)], set[str](), 2 * [numerals.NOTHING]
        for solver, label in labels:
            rows = results.rows(scene=scene, label=label)
            if not rows:
                cells += 2 * [numerals.NOTHING]
                continue
            row, extras = rows[0], results.extras(rows[0])
            cells += cells_of(results, row, exact)
            if (
                cases.certified[row] == 1
                and np.isfinite([cases.lower[row], cases.upper[row]]).all()
            ):
                checks.add(results.check_of(row))
            if "mesh_a_to_surface" in extras:
                off = [
                    numerals.at_most(
                        max(
                            float(extras[f"mesh_{m}_to_surface"]),
                            float(extras[f"surface_to_mesh_{m}"]),
                        ),
                        2,
                    )
                    for m in "ab"
                ]
            records.append(
                {
                    "scene": scene,
                    "solver": solver,
                    "label": label,
                    "status": cases.status[row],
                    "solver_status": cases.solver_status[row],
                    "h": exact,
                    "lower": float(cases.lower[row]),
                    "upper": float(cases.upper[row]),
                    "holds": int(holds(results, row, exact)),
                    "lower_check": results.check_of(row),
                    "box_distances": int(cases.counters["box_distances"][row]),
                    **{key: float(value) for key, value in extras.items()},
                }
            )
        table.rows.append([*cells, ", ".join(sorted(checks)) or numerals.NOTHING, *off])
    table.verdicts = [holds_distance(results)]
    table.notes = [
        "'unsound': an end of the published interval is refuted by a certified bound; such a row is never a data point. 'stalled': the bounds hold but "
        "cannot close. 'checked': the witnesses of the certified lower bounds, by code that shares no bound with the solvers. 'meshes off by': a proven "
        "upper bound, in the worse of both directions; the intervals of 'surface meshes' are wider by that. It refuses a surface that no corner of its grid "
        "sees.",
        *[
            f"{scene}: {note}."
            for scene in scenes
            if (note := cases.scene_note[results.rows(scene=scene)[0]])
        ],
        f"Pictures: a slice, one voxel thick, of the voxels kept at {VOXELS} per axis by natural interval arithmetic (A black, B blue; the frame is the "
        "box), and the witness of the certified lower bound from its dot on A to B, seen along the axis in which it is shortest; without a witness, or with "
        "one shorter than a voxel, the middle of the box. They use the polynomial as written; the false piece of 'ghost' appears when its product is "
        "multiplied out.",
        "If the distance is constant over A (concentric spheres), a tolerance e needs O(1/e) boxes.",
        f"Here: {machine_line(results)}.",
    ]
    return Report(lambda: draw(results, scenes), table, records)


def plane_of(results: Results, scene: str, surface: Surface) -> tuple[int, float, Floats]:
    """Returns the axis and the coordinate of the slice to draw, and the witness.

    The slice is perpendicular to the axis along which the witness is shortest, and goes through its
    source point. Without a witness, or if it is shorter than a voxel, the slice is the middle of
    the box.
    """
    cases = results.cases
    for row in results.rows(scene=scene, solver="surface_enclosure"):
        pair = np.stack([cases.witness_source[row], cases.witness_target[row]])
        if np.linalg.norm(pair[1] - pair[0]) > (surface.high - surface.low).max() / VOXELS:
            axis = int(np.argmin(np.abs(pair[1] - pair[0])))
            return axis, float(pair[0, axis]), pair
    return 1, float(surface.low[1] + surface.high[1]) / 2, np.full((2, 3), np.nan)


SOURCE_COLOUR, TARGET_COLOUR, OPACITY = "#333333", "#8FC1E3", 0.75


def draw(results: Results, scenes: list[str]) -> Any:
    cases = results.cases
    models = results.models
    surface_of = {
        name: Surface(text, models.box[row])
        for row, (name, text) in enumerate(zip(models.name, models.polynomial))
        if text
    }
    columns = 4
    rows = -(-len(scenes) // columns)
    figure, axes = plt.subplots(
        rows, columns, figsize=(style.DOUBLE_COLUMN, 2.05 * rows), squeeze=False
    )
    witness_colour = style.look("surface_enclosure").colour
    for ax in axes.flat[len(scenes) :]:
        ax.set_axis_off()
    for ax, scene in zip(axes.flat, scenes):
        first = results.rows(scene=scene)[0]
        surfaces = [surface_of[model] for model in (cases.target[first], cases.source[first])]
        axis, at, witness = plane_of(results, scene, surfaces[1])
        across = [k for k in range(3) if k != axis]
        for surface, colour in zip(surfaces, (TARGET_COLOUR, SOURCE_COLOUR)):
            size = (surface.high - surface.low) / VOXELS
            slab = min(int((at - surface.low[axis]) / size[axis]), VOXELS - 1)
            kept = np.take(surface.kept(VOXELS), slab, axis=axis)
            for i, j in np.argwhere(kept):
                corner = surface.low[across] + np.array([i, j]) * size[across]
                ax.add_patch(
                    Rectangle(
                        (corner[0], corner[1]),
                        *size[across],
                        facecolor=colour,
                        alpha=OPACITY,
                        linewidth=0,
                    )
                )
        ax.plot(
            witness[:, across[0]],
            witness[:, across[1]],
            color=witness_colour,
            linewidth=1.4,
            zorder=10,
            clip_on=False,
        )
        ax.plot(
            *witness[0, across],
            marker="o",
            markersize=3.5,
            color=witness_colour,
            zorder=11,
            clip_on=False,
        )
        ax.set(
            xlim=(surfaces[1].low[across[0]], surfaces[1].high[across[0]]),
            ylim=(surfaces[1].low[across[1]], surfaces[1].high[across[1]]),
            aspect="equal",
            xticks=[],
            yticks=[],
        )
        ax.spines[["top", "right"]].set_visible(True)
        ax.spines[:].set_linewidth(0.4)
        ax.set_title(scene, fontsize=7, pad=3)
        x, y = "xyz"[across[0]], "xyz"[across[1]]
        as_formula(
            ax.set_xlabel(
                f"${x}, {y}$ at ${'xyz'[axis]} = {round(at, 2) + 0.0:.2f}$", fontsize=6, labelpad=2
            )
        )
    marks: list[Any] = [
        Rectangle((0, 0), 1, 1, facecolor=colour, alpha=OPACITY, linewidth=0)
        for colour in (SOURCE_COLOUR, TARGET_COLOUR)
    ]
    marks.append(
        (Rectangle((0, 0), 1, 1, facecolor=TARGET_COLOUR, alpha=OPACITY, linewidth=0), marks[0])
    )  # legend entry for A and B overlapping
    marks.append(
        Line2D(
            [], [], color=witness_colour, linewidth=1.4, marker="o", markersize=3.5, markevery=[0]
        )
    )
    strip = 0.2 / figure.get_figheight()
    figure.set_layout_engine("tight", w_pad=0.6, h_pad=1.2, rect=(0, 0, 1, 1 - strip))
    figure.legend(
        marks,
        ["voxels kept of A", "of B", "of both", "from the witness on A to its nearest point of B"],
        loc="upper center",
        ncols=4,
        fontsize=6.5,
        borderaxespad=0.2,
        handler_map={tuple: HandlerTuple(ndivide=1)},
    )
    return figure
