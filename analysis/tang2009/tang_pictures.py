"""Pictures of the models of Tang et al. 2009, and of the points that show the two-sided distance of a pair."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from analysis.shared import mesh_picture, shapes
from analysis.shared.columns import Floats
from analysis.shared.mesh_picture import View
from analysis.shared.results import Results
from analysis.shared.shapes import Mesh

WITNESS: Final = "#00A000"  # green, as in the paper
BLUE: Final = (0.15, 0.30, 0.85, 1.0)  # what of A lies in B, as in the paper
RED: Final = (0.85, 0.15, 0.15, 1.0)  # and what of B lies in A
PAINT: Final = ((0.72, 0.80, 0.92, 1.0), (0.95, 0.84, 0.68, 1.0))
SIDE: Final = mesh_picture.view((0.15, 0.3, 1))  # the motions are along x, so from left to right

# Chosen by hand: which way is up differs.
VIEWS: Final = {"tang_puma1": mesh_picture.view((1, -0.6, 0.3), (0, 0, 1)),
                "tang_fish2": mesh_picture.view((-0.3, -1, 0.1), (0, 0, 1)), "tang_dog": mesh_picture.view((1, 0.3, -0.5)),
                "tang_bird1": mesh_picture.view((0.5, -1, 0.4), (0, 0, 1)), "tang_watch2": mesh_picture.view((0.3, -1, 0.3), (0, 0, 1))}


def stand_ins(results: Results, row: int) -> list[str]:
    """What stands in for A and for B: 'stand-in: hand', or nothing if the note of the scene names no two of them."""
    found = re.fullmatch(r"(?:an? )?(.+?) and (?:an? )?(.+?) stand in", str(results.cases.scene_note[row]).partition(";")[0])
    return [f"stand-in: {name.partition(' of ')[0]}" for name in found.groups()] if found else ["", ""]


def title(results: Results, row: int) -> str:
    """The paper's names, and what stands in for them."""
    note = str(results.cases.scene_note[row])
    return f"{results.cases.scene[row]}\n({note})" if note else str(results.cases.scene[row])


def placed(results: Results, name: str, pose: Floats) -> Mesh:
    """A model where its pose puts it."""
    shown = shapes.mesh(results, name)
    return replace(shown, corners=shapes.posed(shown.corners, pose))


def joined(meshes: Sequence[Mesh]) -> Mesh:
    """All of them as one mesh."""
    before = np.cumsum([0, *[len(one.corners) for one in meshes]])
    return Mesh(np.concatenate([one.corners for one in meshes]), np.concatenate([one.triangles + count for one, count in zip(meshes, before)]))


def pair_of(results: Results, row: int) -> list[Mesh]:
    """A and B where they stand."""
    cases = results.cases
    return [placed(results, cases.source[row], cases.pose[row]), placed(results, cases.target[row], cases.target_pose[row])]


def draw_witness(ax: Any, results: Results, row: int, of: View, width: float, size: float) -> None:
    """As a line that nothing hides; nothing where nobody knows it."""
    pair = np.stack([results.cases.witness_source[row], results.cases.witness_target[row]])
    if np.isfinite(pair).all():
        ax.plot(*of.seen(pair)[:, :2].T, color=WITNESS, linewidth=width, marker="o", markersize=size, zorder=5)


def draw_pair(ax: Any, results: Results, case: int, of: View = SIDE) -> None:
    """Both models in their colours, and the witness."""
    meshes = pair_of(results, case)
    colours = np.concatenate([np.tile(paint, (len(one.triangles), 1)) for one, paint in zip(meshes, PAINT)])
    mesh_picture.draw(ax, joined(meshes), of, colours, both_sides=not all(one.closed for one in meshes))
    draw_witness(ax, results, case, of, 1.4, 3)


def draw_model(ax: Any, results: Results, name: str, colour: int = 0) -> None:
    shown = shapes.mesh(results, name)
    mesh_picture.draw(ax, shown, VIEWS.get(name, SIDE), np.tile(PAINT[colour], (len(shown.triangles), 1)), both_sides=not shown.closed)


def draw_frame(ax: Any, results: Results, rows: list[int], of: View) -> None:
    """All objects of these pairs where they stand in their frame, and the deepest points of each pair."""
    cases = results.cases
    objects = {(str(name), pose.tobytes()): pose for row in rows
               for name, pose in ((cases.source[row], cases.pose[row]), (cases.target[row], cases.target_pose[row]))}
    if not objects:
        ax.set_visible(False)
        return
    meshes = [placed(results, name, pose) for (name, _), pose in objects.items()]
    mesh_picture.draw(ax, joined(meshes), of, np.concatenate([np.tile(PAINT[i % 2], (len(one.triangles), 1)) for i, one in enumerate(meshes)]))
    for row in rows:
        draw_witness(ax, results, row, of, 1.2, 2.2)


def inside(mesh: Mesh, points: Floats) -> npt.NDArray[np.bool_]:
    """Which points lie in a closed mesh: where the solid angles of its triangles make up the whole sphere. O(points triangles)."""
    found = np.zeros(len(points), dtype=bool)
    for begin in range(0, len(points), 512):
        a, b, c = (mesh.corners[mesh.triangles[:, k]][None] - points[begin:begin + 512, None] for k in range(3))
        la, lb, lc = (np.linalg.norm(x, axis=2) for x in (a, b, c))
        top = np.einsum("ijk,ijk->ij", a, np.cross(b, c))
        bottom = la * lb * lc + np.einsum("ijk,ijk->ij", a, b) * lc + np.einsum("ijk,ijk->ij", b, c) * la + np.einsum("ijk,ijk->ij", c, a) * lb
        found[begin:begin + 512] = np.abs(2 * np.arctan2(top, bottom).sum(axis=1)) > 2 * np.pi
    return found


def pieces(shown: Mesh, size: float) -> Mesh:
    """The triangles, cut at the middle of their longest side until none is longer."""
    sides = shown.corners[shown.triangles]
    while True:
        lengths = np.linalg.norm(sides - np.roll(sides, -1, axis=1), axis=2)
        long = lengths.max(axis=1) > size
        if not long.any():
            return Mesh(sides.reshape(-1, 3), np.arange(3 * len(sides), dtype=np.int64).reshape(-1, 3))
        first = lengths[long].argmax(axis=1)
        a, b, c = (sides[long][np.arange(len(first)), (first + k) % 3] for k in range(3))
        middle = 0.5 * (a + b)
        sides = np.concatenate([sides[~long], np.stack([a, middle, c], axis=1), np.stack([middle, b, c], axis=1)])


def within(own: Mesh, other: Mesh, size: float) -> Mesh:
    """What of `own`, in pieces no longer than `size`, has its middle in the solid `other`."""
    low, high = other.corners.min(axis=0), other.corners.max(axis=0)
    sides = own.corners[own.triangles]
    near = ((sides.min(axis=1) <= high) & (sides.max(axis=1) >= low)).all(axis=1)
    cut = pieces(Mesh(own.corners, own.triangles[near]), size)
    middle = cut.corners[cut.triangles].mean(axis=1)
    kept = np.flatnonzero(((middle > low) & (middle < high)).all(axis=1))
    return Mesh(cut.corners, cut.triangles[kept[inside(other, middle[kept])]])


def draw_common_volume(ax: Any, results: Results, row: int, of: View, close: bool) -> None:
    """Both solids, see-through, and what of each lies in the other; or, close, that alone with the deepest pair of each part, of which the solver reports."""
    a, b = pair_of(results, row)
    size = float(results.cases.source_longest[row]) / 100
    parts = [within(a, b, size), within(b, a, size)]
    for own, colour in ((a, BLUE), (b, RED)) if not close else ():
        mesh_picture.draw(ax, own, of, np.tile((*colour[:3], 0.10), (len(own.triangles), 1)), both_sides=True)
    common = joined(parts)
    colours = np.concatenate([np.tile(colour, (len(part.triangles), 1)) for part, colour in zip(parts, (BLUE, RED))])
    mesh_picture.draw(ax, common, of, colours * ((1, 1, 1, 0.35) if close else (1, 1, 1, 1)), both_sides=True)
    if not close or not len(common.triangles):
        mesh_picture.frame(ax, of.seen(joined([a, b]).corners))
        return
    draw_deepest(ax, results.extras(row), of)
    mesh_picture.frame(ax, of.seen(common.corners[np.unique(common.triangles)]), margin=0.08)


def draw_deepest(ax: Any, extras: dict[str, float], of: View) -> None:
    """The deepest pair of points of each part."""
    for part in range(1, int(extras.get("parts", 0)) + 1):
        ends = np.array([[extras[f"length: part {part}, {side} {axis}"] for axis in "xyz"] for side in "AB"])
        seen = of.seen(ends)
        ax.plot(*seen[:, :2].T, color=WITNESS, linewidth=1.6, zorder=5)
        for end, colour in zip(seen, (BLUE, RED)):
            ax.plot(*end[:2], marker="o", markersize=4.5, color=colour[:3], markeredgecolor="white", markeredgewidth=0.5, zorder=6)
