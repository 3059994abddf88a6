"""Pictures of the models of Tang et al. 2009, and of the points that show the two-sided distance of a pair."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from analysis.shared import mesh_picture
from analysis.shared.load import Results
from analysis.shared.mesh_picture import Mesh, Values, View

WITNESS: Final = "#00A000"  # green, as in the paper
BLUE: Final = (0.15, 0.30, 0.85, 1.0)  # what of A lies in B, as in the paper
RED: Final = (0.85, 0.15, 0.15, 1.0)  # and what of B lies in A
PAINT: Final = ((0.72, 0.80, 0.92, 1.0), (0.95, 0.84, 0.68, 1.0))
SIDE: Final = mesh_picture.view((0.15, 0.3, 1))  # the motions are along x, so from left to right

# Chosen by hand: which way is up differs.
VIEWS: Final = {"tang_puma1": mesh_picture.view((1, -0.6, 0.3), (0, 0, 1)),
                "tang_fish2": mesh_picture.view((-0.3, -1, 0.1), (0, 0, 1)), "tang_dog": mesh_picture.view((1, 0.3, -0.5)),
                "tang_bird1": mesh_picture.view((0.5, -1, 0.4), (0, 0, 1)), "tang_watch2": mesh_picture.view((0.3, -1, 0.3), (0, 0, 1))}


def placed(name: str, pose: Values) -> Mesh:
    """A model where its pose puts it; a pose is twelve numbers, the rotation row by row, then the translation."""
    shown = mesh_picture.mesh(name)
    return replace(shown, corners=shown.corners @ pose[:9].reshape(3, 3).T + pose[9:])


def draw_pair(ax: Any, results: Results, case: int, of: View = SIDE) -> None:
    """Both models in their colours and the witness as a line: nothing hides it."""
    cases = results.cases
    meshes = [placed(str(cases.source[case]), cases.pose[case]), placed(str(cases.target[case]), cases.target_pose[case])]
    both = Mesh(np.concatenate([one.corners for one in meshes]), np.concatenate([meshes[0].triangles, meshes[1].triangles + len(meshes[0].corners)]))
    colours = np.concatenate([np.tile(paint, (len(one.triangles), 1)) for one, paint in zip(meshes, PAINT)])
    mesh_picture.draw(ax, both, of, colours, both_sides=not all(one.closed for one in meshes))
    pair = np.stack([cases.witness_source[case], cases.witness_target[case]])
    if np.isfinite(pair).all():
        ends = of.seen(pair)
        ax.plot(*ends[:, :2].T, color=WITNESS, linewidth=1.4, marker="o", markersize=3, zorder=5)


def draw_model(ax: Any, name: str, colour: int = 0) -> None:
    shown = mesh_picture.mesh(name)
    mesh_picture.draw(ax, shown, VIEWS.get(name, SIDE), np.tile(PAINT[colour], (len(shown.triangles), 1)), both_sides=not shown.closed)


def draw_frame(ax: Any, results: Results, rows: list[int], of: View) -> None:
    """All objects of these pairs where they stand in their frame, and the deepest points of each pair."""
    cases = results.cases
    objects: dict[tuple[str, bytes], tuple[str, Values]] = {}
    for row in rows:
        for name, pose in ((str(cases.source[row]), cases.pose[row]), (str(cases.target[row]), cases.target_pose[row])):
            objects.setdefault((name, pose.tobytes()), (name, pose))
    shapes = {name: mesh_picture.mesh(name) for name in dict.fromkeys(name for name, _ in objects.values())}
    corners, triangles, colours, count = list[Values](), list[mesh_picture.Indices](), list[Values](), 0
    for i, (name, pose) in enumerate(objects.values()):
        shape = shapes[name]
        corners.append(shape.corners @ pose[:9].reshape(3, 3).T + pose[9:])
        triangles.append(shape.triangles + count)
        colours.append(np.tile(PAINT[i % 2], (len(shape.triangles), 1)))
        count += len(shape.corners)
    if not corners:
        ax.set_visible(False)
        return
    mesh_picture.draw(ax, Mesh(np.concatenate(corners), np.concatenate(triangles)), of, np.concatenate(colours))
    for row in rows:
        pair = np.stack([cases.witness_source[row], cases.witness_target[row]])
        if np.isfinite(pair).all():
            ax.plot(*of.seen(pair)[:, :2].T, color=WITNESS, linewidth=1.2, marker="o", markersize=2.2, zorder=5)


def inside(mesh: Mesh, points: Values) -> npt.NDArray[np.bool_]:
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


def draw_common_volume(ax: Any, results: Results, row: int, of: View, close: bool) -> None:
    """Both solids, see-through, and what of each lies in the other; or, close, that alone with the deepest pair of each part, of which the solver reports."""
    cases = results.cases
    meshes = [placed(str(cases.source[row]), cases.pose[row]), placed(str(cases.target[row]), cases.target_pose[row])]
    longest = float(cases.source_longest[row])
    parts = list[tuple[Mesh, Values]]()
    for own, other, colour in ((meshes[0], meshes[1], BLUE), (meshes[1], meshes[0], RED)):
        low, high = other.corners.min(axis=0), other.corners.max(axis=0)
        sides = own.corners[own.triangles]
        near = ((sides.min(axis=1) <= high) & (sides.max(axis=1) >= low)).all(axis=1)
        cut = pieces(Mesh(own.corners, own.triangles[near]), longest / 100)
        middle = cut.corners[cut.triangles].mean(axis=1)
        kept = np.flatnonzero(((middle > low) & (middle < high)).all(axis=1))
        kept = kept[inside(other, middle[kept])]
        parts.append((Mesh(cut.corners, cut.triangles[kept]), np.tile(colour, (len(kept), 1))))
        if not close:
            mesh_picture.draw(ax, own, of, np.tile((*colour[:3], 0.10), (len(own.triangles), 1)), both_sides=True)
    common = Mesh(np.concatenate([part.corners for part, _ in parts]), np.concatenate([parts[0][0].triangles, parts[1][0].triangles + len(parts[0][0].corners)]))
    mesh_picture.draw(ax, common, of, np.concatenate([colours for _, colours in parts]) * ((1, 1, 1, 0.35) if close else (1, 1, 1, 1)), both_sides=True)
    if not close or not len(common.triangles):
        mesh_picture.frame(ax, of.seen(np.concatenate([mesh.corners for mesh in meshes])))
        return
    extras = results.extras(row)
    for part in range(1, int(extras.get("parts", 0)) + 1):
        ends = np.array([[extras[f"length: part {part}, {side} {axis}"] for axis in "xyz"] for side in "AB"])
        seen = of.seen(ends)
        ax.plot(*seen[:, :2].T, color=WITNESS, linewidth=1.6, zorder=5)
        for end, colour in zip(seen, (BLUE, RED)):
            ax.plot(*end[:2], marker="o", markersize=4.5, color=colour[:3], markeredgecolor="white", markeredgewidth=0.5, zorder=6)
    used = common.corners[np.unique(common.triangles)]
    mesh_picture.frame(ax, of.seen(used), margin=0.08)
