"""Pairs of algebraic surfaces with known distances: who holds them, and pictures of voxels and witnesses."""

from __future__ import annotations

import ast
import re
import sys
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import numpy.typing as npt

from analysis import command, style, tables
from analysis.load import Results, machine_line
from analysis.statistics import median

STEM = "surfaces_gallery"
VOXELS = 24  # an axis, in pictures
Values = npt.NDArray[np.float64]


class SurfaceText:
    """A surface as /models/note tells it: 'x^2 - 1 = 0 in [a, b] x [c, d] x [e, f]'."""

    def __init__(self, note: str) -> None:
        number = r"([^,\[\]]+)"
        pair = rf"\[{number}, {number}\]"
        match = re.match(rf"(.*) = 0 in {pair} x {pair} x {pair}", note)
        if match is None:
            raise ValueError(f"not the note of a surface: {note!r}")
        self.tree = ast.parse(match[1].replace("^", "**"), mode="eval").body
        ends = [float(match[i]) for i in range(2, 8)]
        self.low, self.high = np.array(ends[0::2]), np.array(ends[1::2])

    def bounds(self, low: dict[str, Values], high: dict[str, Values]) -> tuple[Values, Values]:
        """Natural interval extension over many boxes at once, not rounded outward: for pictures alone."""
        return _bounds(self.tree, low, high)

    def kept(self, voxels: int) -> npt.NDArray[np.bool_]:
        """Which voxels of a grid may meet the surface."""
        lines = [np.linspace(a, b, voxels + 1) for a, b in zip(self.low, self.high)]
        low = dict(zip("xyz", np.meshgrid(*[line[:-1] for line in lines], indexing="ij")))
        high = dict(zip("xyz", np.meshgrid(*[line[1:] for line in lines], indexing="ij")))
        least, most = self.bounds(low, high)
        return np.asarray((least <= 0) & (most >= 0))


def _power(low: Values, high: Values, n: int) -> tuple[Values, Values]:
    a, b = low**n, high**n
    if n % 2:
        return a, b
    return np.where((low <= 0) & (high >= 0), 0.0 if n else 1.0, np.minimum(a, b)), np.maximum(a, b)


def _bounds(node: ast.expr, low: dict[str, Values], high: dict[str, Values]) -> tuple[Values, Values]:
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


def exact_of(note: str) -> float:
    match = re.match(r"h = ([0-9.]+)", note)
    return float(match[1]) if match else float("nan")


def make(results: Results, out: Path) -> list[Path]:
    cases = results.cases
    scenes, labels = results.in_order("scene"), style.order(zip(cases.solver, cases.label))
    table = tables.Table("Pairs of algebraic surfaces with a known directed distance h(A,B).",
                         ["pair", "h", *[f"{style.look(*pair).title}{what}" for pair in labels
                                         for what in (": interval", ", holds h", ", s")], "checked"])
    table.left = 1
    records: list[tables.Record] = []
    for scene in scenes:
        exact = exact_of(cases.scene_note[results.rows(scene=scene)[0]])
        cells, checked = [scene, tables.number(exact, 6)], tables.NOTHING
        for solver, label in labels:
            rows = results.rows(scene=scene, label=label)
            if not len(rows):
                cells += 3 * [tables.NOTHING]
                continue
            row = int(rows[0])
            low, high, status = float(cases.lower[row]), float(cases.upper[row]), str(cases.status[row])
            # The exact value is printed to twelve digits.
            holds = low <= exact + 1e-11 and high >= exact - 1e-11
            solved = str(cases.solver_status[row])
            word = "" if status == "ok" else f" ({'stalled' if solved == 'stalled' else style.STATUS_WORDS.get(status, status)})"
            cells += [f"[{low:.6f}, {high:.6f}]{word}", "yes" if holds else "no",
                      tables.number(results.prepare_seconds(row) + median(results.wall_seconds(row)).value)]
            if cases.certified[row] == 1:
                checked = str(cases.lower_check[row])
            records.append({"scene": scene, "solver": solver, "label": label, "status": status, "solver_status": solved,
                            "h": exact, "lower": low, "upper": high, "holds": int(holds),
                            "lower_check": str(cases.lower_check[row]),
                            "box_distances": int(cases.counters["box_distances"][row])})
        table.rows.append([*cells, checked])
    table.notes = [
        "'unsound': an end of the published interval is refuted by a certified bound; such a row is never a data point. "
        "'stalled': the bounds hold, but cannot close. 'checked': the witness of the certified lower bound, by code "
        "that shares no bound with the solver.",
        *[f"{scene}: {cases.scene_note[results.rows(scene=scene)[0]]}." for scene in scenes],
        f"Pictures: voxels kept at {VOXELS} an axis by natural interval arithmetic (A dark, B light), cut open at the "
        "front, and the witness of the certified lower bound.",
        f"Here: {machine_line(results)}."]
    return tables.save(table, records, out, STEM) + style.save(draw(results, scenes), out, STEM, table.caption)


def draw(results: Results, scenes: list[str]) -> Any:
    cases = results.cases
    notes = dict(zip(results.models.name, results.models.note))
    columns = 5
    rows = -(-len(scenes) // columns)
    figure = plt.figure(figsize=(style.DOUBLE_COLUMN, 1.65 * rows))
    source_colour, target_colour = style.look("surface_enclosure").colour, "#9DB7CC"
    for i, scene in enumerate(scenes):
        ax = figure.add_subplot(rows, columns, i + 1, projection="3d")
        first = int(results.rows(scene=scene)[0])
        for model, colour, alpha in ((cases.target[first], target_colour, 0.35), (cases.source[first], "#555555", 0.6)):
            surface = SurfaceText(str(notes[model]))
            kept = surface.kept(VOXELS)
            kept[VOXELS // 2:, :VOXELS // 2, :] = False  # the octant column towards the viewer
            middle = surface.low + (np.argwhere(kept) + 0.5) * (surface.high - surface.low) / VOXELS
            ax.scatter(*middle.T, s=0.7, c=colour, alpha=alpha, linewidths=0, marker="s", rasterized=True)
            ax.set(xlim=(surface.low[0], surface.high[0]), ylim=(surface.low[1], surface.high[1]),
                   zlim=(surface.low[2], surface.high[2]))
        for row in results.rows(scene=scene, solver="surface_enclosure"):
            p, q = cases.witness_source[row], cases.witness_target[row]
            if np.isfinite(p).all() and np.isfinite(q).all():
                ax.plot(*np.stack([p, q]).T, color=source_colour, linewidth=1.4, zorder=10)
                ax.scatter(*p, s=9, c=source_colour, zorder=11, depthshade=False)
        ax.set_title(scene, fontsize=6.5, pad=-2)
        ax.set_axis_off()
        ax.view_init(elev=22, azim=-55)
        ax.set_box_aspect((1, 1, 1), zoom=1.45)
    return figure


if __name__ == "__main__":
    sys.exit(command.main(STEM, make))
