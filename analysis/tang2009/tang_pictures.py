"""Draws the models of Tang et al. 2009, and the pairs of points that attain a distance or depth."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from typing import Any, Final

import matplotlib.patheffects
import numpy as np
import numpy.typing as npt
import scipy.sparse.csgraph
import scipy.spatial

from analysis.shared import mesh_picture, shapes
from analysis.shared.columns import Floats
from analysis.shared.mesh_picture import View
from analysis.shared.results import Results
from analysis.shared.shapes import Mesh

WITNESS: Final = "#00A000"  # green, as in the paper
BLUE: Final = (
    0.10,
    0.18,
    0.60,
    1.0,
)  # the part of A in B; blue as in the paper, and darker than RED so that they differ in grey
RED: Final = (0.93, 0.42, 0.36, 1.0)  # the part of B in A
PAINT: Final = (
    (0.36, 0.51, 0.76, 1.0),
    (0.97, 0.87, 0.70, 1.0),
)  # A dark, B light, so that they differ in grey
HALO: Final = [matplotlib.patheffects.withStroke(linewidth=2.6, foreground="white")]
SIDE: Final = mesh_picture.view(
    (0.15, 0.3, 1)
)  # shows motions, which are along x, from left to right

# Chosen by hand, because the up direction of the models differs.
VIEWS: Final = {
    "tang_puma1": mesh_picture.view((1, -0.6, 0.3), (0, 0, 1)),
    "tang_fish2": mesh_picture.view((-0.3, -1, 0.1), (0, 0, 1)),
    "tang_dog": mesh_picture.view((1, 0.3, -0.5)),
    "tang_bird1": mesh_picture.view((0.5, -1, 0.4), (0, 0, 1)),
    "tang_watch2": mesh_picture.view((0.3, -1, 0.3), (0, 0, 1)),
}


def stand_ins(results: Results, row: int) -> list[str]:
    """Returns which models replace A and B, from the note of the scene: 'stand-in: hand', 'Bunny2
    simplified'.

    Empty strings mean that the note does not say.
    """
    note = str(results.cases.scene_note[row])
    if match := re.fullmatch(r"(?:an? )?(.+?) and (?:an? )?(.+?) stand in", note.partition(";")[0]):
        return [f"stand-in: {name.partition(' of ')[0]}" for name in match.groups()]
    told = dict(re.findall(r"(\w+) is (\w+ \w+)", note))
    return (
        [told.get(name, "") for name in str(results.cases.scene[row]).split("/")]
        if told
        else ["", ""]
    )


def short_title(results: Results, row: int) -> str:
    """Returns a title for a narrow panel: names in the paper, numbers of triangles, and on a second
    line the stand-ins."""
    scene, note = str(results.cases.scene[row]), str(results.cases.scene_note[row])
    told = {
        name: shape.removeprefix("stand-in: ")
        for name, shape in zip(scene.split("/"), stand_ins(results, row))
        if shape
    }
    second = (
        f"stand-ins: {', '.join(told.values())}"
        if len(told) == 2
        else next((f"{name}: {shape}" for name, shape in told.items()), note.partition(":")[0])
    )
    return f"{scene}, {results.sizes(row)}" + (f"\n({second})" if second else "")


def title(results: Results, row: int) -> str:
    """Returns a title: names in the paper, and the note on what replaces them."""
    note = str(results.cases.scene_note[row])
    return f"{results.cases.scene[row]}\n({note})" if note else str(results.cases.scene[row])


def placed(results: Results, name: str, pose: Floats) -> Mesh:
    """Returns a model in its pose."""
    shown = shapes.mesh(results, name)
    return replace(shown, corners=shapes.posed(shown.corners, pose))


def joined(meshes: Sequence[Mesh]) -> Mesh:
    """Concatenates meshes into one."""
    before = np.cumsum([0, *[len(mesh.corners) for mesh in meshes]])
    corners = np.concatenate([mesh.corners for mesh in meshes])
    triangles = np.concatenate([mesh.triangles + count for mesh, count in zip(meshes, before)])
    return Mesh(corners, triangles)


def pair_of(results: Results, row: int) -> list[Mesh]:
    """Returns A and B in their poses."""
    cases = results.cases
    return [
        placed(results, cases.source[row], cases.pose[row]),
        placed(results, cases.target[row], cases.target_pose[row]),
    ]


def draw_witness(ax: Any, results: Results, row: int, of: View, width: float, size: float) -> None:
    """Draws the witness, if known, as a line in front of everything else."""
    pair = np.stack([results.cases.witness_source[row], results.cases.witness_target[row]])
    if np.isfinite(pair).all():
        ax.plot(
            *of.seen(pair)[:, :2].T,
            color=WITNESS,
            linewidth=width,
            marker="o",
            markersize=size,
            zorder=5,
            path_effects=HALO,
        )


def draw_pair(ax: Any, results: Results, case: int, of: View = SIDE) -> None:
    """Draws both models of a pair, and the witness."""
    meshes = pair_of(results, case)
    colours = np.concatenate(
        [np.tile(paint, (len(mesh.triangles), 1)) for mesh, paint in zip(meshes, PAINT)]
    )
    mesh_picture.draw(
        ax, joined(meshes), of, colours, both_sides=not all(mesh.closed for mesh in meshes)
    )
    draw_witness(ax, results, case, of, 1.4, 3)


def draw_model(ax: Any, results: Results, name: str, colour: int = 0) -> None:
    shown = shapes.mesh(results, name)
    mesh_picture.draw(
        ax,
        shown,
        VIEWS.get(name, SIDE),
        np.tile(PAINT[colour], (len(shown.triangles), 1)),
        both_sides=not shown.closed,
    )


def draw_frame(ax: Any, results: Results, rows: list[int], of: View) -> None:
    """Draws all objects of a frame, and the deepest points of each pair. `rows` are the pairs of
    the frame."""
    cases = results.cases
    objects = {
        (str(name), pose.tobytes()): pose
        for row in rows
        for name, pose in (
            (cases.source[row], cases.pose[row]),
            (cases.target[row], cases.target_pose[row]),
        )
    }
    if not objects:
        ax.set_visible(False)
        return
    meshes = [placed(results, name, pose) for (name, _), pose in objects.items()]
    mesh_picture.draw(
        ax,
        joined(meshes),
        of,
        np.concatenate(
            [np.tile(PAINT[i % 2], (len(mesh.triangles), 1)) for i, mesh in enumerate(meshes)]
        ),
    )
    for row in rows:
        draw_witness(ax, results, row, of, 1.2, 2.2)


def inside(mesh: Mesh, points: Floats) -> npt.NDArray[np.bool_]:
    """Tells which points lie inside a closed mesh: there, the solid angles of its triangles add up
    to 4 pi. O(points * triangles)."""
    is_inside = np.zeros(len(points), dtype=bool)
    for begin in range(0, len(points), 512):
        a, b, c = (
            mesh.corners[mesh.triangles[:, k]][None] - points[begin : begin + 512, None]
            for k in range(3)
        )
        la, lb, lc = (np.linalg.norm(x, axis=2) for x in (a, b, c))
        top = np.einsum("ijk,ijk->ij", a, np.cross(b, c))
        bottom = (
            la * lb * lc
            + np.einsum("ijk,ijk->ij", a, b) * lc
            + np.einsum("ijk,ijk->ij", b, c) * la
            + np.einsum("ijk,ijk->ij", c, a) * lb
        )
        is_inside[begin : begin + 512] = np.abs(2 * np.arctan2(top, bottom).sum(axis=1)) > 2 * np.pi
    return is_inside


def pieces(shown: Mesh, size: float) -> Mesh:
    """Bisects triangles at their longest side until no side is longer than `size`."""
    sides = shown.corners[shown.triangles]
    while True:
        lengths = np.linalg.norm(sides - np.roll(sides, -1, axis=1), axis=2)
        long = lengths.max(axis=1) > size
        if not long.any():
            return Mesh(
                sides.reshape(-1, 3), np.arange(3 * len(sides), dtype=np.int64).reshape(-1, 3)
            )
        first = lengths[long].argmax(axis=1)
        a, b, c = (sides[long][np.arange(len(first)), (first + k) % 3] for k in range(3))
        middle = 0.5 * (a + b)
        sides = np.concatenate(
            [sides[~long], np.stack([a, middle, c], axis=1), np.stack([middle, b, c], axis=1)]
        )


def within(mesh: Mesh, solid: Mesh, size: float) -> Mesh:
    """Returns the part of `mesh` inside the closed `solid`, as triangles of sides up to `size`,
    selected by their centroids."""
    low, high = solid.corners.min(axis=0), solid.corners.max(axis=0)
    sides = mesh.corners[mesh.triangles]
    near = ((sides.min(axis=1) <= high) & (sides.max(axis=1) >= low)).all(axis=1)
    cut = pieces(Mesh(mesh.corners, mesh.triangles[near]), size)
    middle = cut.corners[cut.triangles].mean(axis=1)
    kept = np.flatnonzero(((middle > low) & (middle < high)).all(axis=1))
    return Mesh(cut.corners, cut.triangles[kept[inside(solid, middle[kept])]])


def draw_common_volume(ax: Any, results: Results, row: int, of: View, close: bool) -> None:
    """Draws both solids, transparent, and their common volume.

    With `close`, draws instead the connected parts of this volume side by side, with the deepest
    pair of points of each.
    """
    a, b = pair_of(results, row)
    size = float(results.cases.source_longest[row]) / 100
    inner = [within(a, b, size), within(b, a, size)]
    common = joined(inner)
    colours = np.concatenate(
        [np.tile(colour, (len(mesh.triangles), 1)) for mesh, colour in zip(inner, (BLUE, RED))]
    )
    if close and len(common.triangles):
        draw_parts(
            ax, common, colours * (1, 1, 1, 0.35), deepest_pairs(results.extras(row)), of, size
        )
        return
    for mesh, colour, alpha, name in ((a, BLUE, 0.22, "A"), (b, RED, 0.10, "B")):
        mesh_picture.draw(
            ax, mesh, of, np.tile((*colour[:3], alpha), (len(mesh.triangles), 1)), both_sides=True
        )
        ax.annotate(
            name,
            of.seen(mesh.corners)[:, :2].mean(axis=0),
            ha="center",
            va="center",
            fontsize=9,
            color=colour[:3],
            zorder=6,
            path_effects=HALO,
        )
    mesh_picture.draw(ax, common, of, colours, both_sides=True)
    mesh_picture.frame(ax, of.seen(joined([a, b]).corners))


def connected(points: Floats, gap: float) -> npt.NDArray[np.int_]:
    """Returns the cluster number of each point. Points nearer than `gap` to each other are in one
    cluster."""
    pairs = scipy.spatial.cKDTree(points).query_pairs(gap, output_type="ndarray")
    graph = scipy.sparse.coo_array(
        (np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(len(points), len(points))
    )
    return np.asarray(scipy.sparse.csgraph.connected_components(graph, directed=False)[1])


def deepest_pairs(extras: dict[str, float]) -> list[Floats]:
    """Returns the deepest pair of points (on A, on B) of each part, from the numbers that the
    solver reports."""
    pairs = []
    for part in range(1, int(extras.get("parts", 0)) + 1):
        numbers = [extras[f"length: part {part}, {side} {axis}"] for side in "AB" for axis in "xyz"]
        pairs.append(np.array(numbers).reshape(2, 3))
    return pairs


def draw_parts(
    ax: Any, common: Mesh, colours: Floats, pairs: Sequence[Floats], of: View, size: float
) -> None:
    """Draws the connected parts of a mesh side by side at one scale; the highest part is at the
    left.

    Each pair of points is drawn with the part that is nearest to it.
    """
    middles = common.corners[common.triangles].mean(axis=1)
    part_of = connected(middles, 2 * size)
    parts = sorted(
        range(part_of.max() + 1),
        key=lambda part: -float(of.seen(middles[part_of == part])[:, 1].mean()),
    )
    owner = [
        part_of[np.linalg.norm(middles - pair.mean(axis=0), axis=1).argmin()] for pair in pairs
    ]
    moved, right = list[Mesh](), 0.0
    for part in parts:
        triangles = common.triangles[part_of == part]
        seen = of.seen(common.corners[np.unique(triangles)])
        shift = np.array([right - seen[:, 0].min(), -seen[:, 1].max(), 0.0])
        moved.append(Mesh(common.corners + shift @ of.axes, triangles))
        right += float(np.ptp(seen[:, 0])) + 4 * size
        for pair in (pair for pair, whose in zip(pairs, owner) if whose == part):
            draw_deepest(ax, of.seen(pair) + shift)
    mesh_picture.draw(
        ax,
        joined(moved),
        of,
        np.concatenate([colours[part_of == part] for part in parts]),
        both_sides=True,
    )
    mesh_picture.frame(
        ax,
        of.seen(np.concatenate([mesh.corners[np.unique(mesh.triangles)] for mesh in moved])),
        margin=0.08,
    )


def draw_deepest(ax: Any, seen: Floats) -> None:
    """Draws a pair of points, given in view coordinates, and the line between them."""
    ax.plot(*seen[:, :2].T, color=WITNESS, linewidth=1.6, zorder=5)
    for end, colour in enumerate((BLUE, RED)):
        ax.plot(
            *seen[end, :2],
            marker="o",
            markersize=3.2,
            color=colour[:3],
            markeredgecolor="white",
            markeredgewidth=0.4,
            zorder=6,
        )
