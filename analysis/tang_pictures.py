"""Pictures of the models of Tang et al. 2009, and of the points that show the two-sided distance of a pair."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Final

import numpy as np

from analysis import mesh_picture
from analysis.load import Results
from analysis.mesh_picture import Mesh, Values, View

WITNESS: Final = "#00A000"  # green, as in the paper
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
