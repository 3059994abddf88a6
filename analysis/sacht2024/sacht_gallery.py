"""Small pictures of pairs of meshes, for a panel above a chart."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Sequence
from typing import Any, Final

from analysis.shared import mesh_picture, shapes, style
from analysis.shared.results import ResultError, Results
from analysis.shared.shapes import Mesh

PITCH: Final = 1.15  # distance between mesh centres, in sizes of a mesh


def meshes_of(results: Results, scenes: Sequence[str]) -> dict[str, tuple[Mesh, Mesh]]:
    """Returns A and B of each scene, without scenes whose shapes are not in the cache."""
    meshes = {}
    for scene in scenes:
        row = results.rows(scene=scene)[0]
        try:
            meshes[scene] = shapes.mesh(results, results.cases.source[row]), shapes.mesh(
                results, results.cases.target[row]
            )
        except ResultError:
            continue
    return meshes


def draw(
    ax: Any,
    results: Results,
    pairs: dict[str, tuple[Mesh, Mesh]],
    upright: bool = True,
    name: Callable[[str], str] = style.scene_title,
) -> None:
    """Draws the pairs from left to right, all meshes at the same size. With `upright` A is above B,
    else to the left of B."""
    placed = []
    for k, (scene, (a, b)) in enumerate(pairs.items()):
        eye = mesh_picture.view_of(str(results.cases.source[results.rows(scene=scene)[0]]))
        x = PITCH * k * (1 if upright else 2)
        placed += [
            (a, eye, x, PITCH if upright else 0.0),
            (b, eye, x if upright else x + PITCH, 0.0),
        ]
        lines = [
            line
            for part in name(scene).splitlines()
            for line in textwrap.wrap(part, 16 if upright else 60)
        ]
        ax.text(
            x if upright else x + PITCH / 2,
            -0.6,
            "\n".join(lines),
            fontsize=5.5,
            ha="center",
            va="top",
        )
    mesh_picture.thumbnails(ax, placed)
