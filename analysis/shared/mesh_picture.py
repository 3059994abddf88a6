"""Meshes as pictures: seen from far away without perspective, the farthest triangles drawn first."""

from __future__ import annotations

import subprocess
import tempfile
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt
from matplotlib.collections import PolyCollection

from analysis.shared.load import ResultError
from analysis.shared.program import ROOT, program

Values = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64]
GREY: Final = (0.80, 0.80, 0.82, 1.0)


@dataclass(frozen=True)
class Mesh:
    corners: Values
    triangles: Indices  # in the order in which the fields of a result are

    @cached_property
    def _edge_uses(self) -> Indices:
        """Of each edge that joins two places, how many triangles use it. Corners at one place are one corner."""
        _, place = np.unique(self.corners + 0.0, axis=0, return_inverse=True)
        sides = np.sort(place.reshape(-1)[self.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)], axis=1)
        return np.asarray(np.unique(sides[sides[:, 0] != sides[:, 1]], axis=0, return_counts=True)[1], dtype=np.int64)

    @property
    def closed(self) -> bool:
        """No edge is used once."""
        return bool((self._edge_uses > 1).all())

    @property
    def manifold(self) -> bool:
        """No edge is used more than twice. Vertices at which two fans of triangles meet are not looked for."""
        return bool((self._edge_uses < 3).all())


def mesh(name: str) -> Mesh:
    """A model, from the program: result files hold no coordinates."""
    if not program().is_file():
        raise ResultError(f"model '{name}' cannot be drawn: there is no program {program()}: build it with 'make build'")
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "mesh.off"
        done = subprocess.run([program(), "export", name, file], cwd=ROOT, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise ResultError(f"model '{name}' cannot be drawn: {done.stderr.strip()}")
        with file.open(encoding="ascii") as text:
            text.readline()
            count, faces = map(int, text.readline().split()[:2])
            corners = np.loadtxt(text, max_rows=count, ndmin=2)
            triangles = np.loadtxt(text, max_rows=faces, dtype=np.int64, ndmin=2)[:, 1:4]
    return Mesh(corners, triangles)


@dataclass(frozen=True)
class View:
    """Three unit vectors: to the right, up, and towards the eye."""

    axes: Values

    def seen(self, points: Values) -> Values:
        return np.asarray(points @ self.axes.T)


def view(eye: tuple[float, float, float], up: tuple[float, float, float] = (0.0, 1.0, 0.0)) -> View:
    towards = np.array(eye) / np.linalg.norm(eye)
    right = np.cross(up, towards)
    right /= np.linalg.norm(right)
    return View(np.stack([right, np.cross(towards, right), towards]))


def draw(ax: Any, shown: Mesh, of: View, colours: Values | None = None, edges: float = 0.0, both_sides: bool = False) -> None:
    """Triangles in their colours (n x 4; grey, if not given), darker where they are turned away from the eye. `edges` is the width of
    their outlines; 0: none. What faces away is left out, unless both sides are asked for: a surface with holes shows its inside.
    """
    corners = of.seen(shown.corners)
    sides = corners[shown.triangles]
    normal = np.cross(sides[:, 1] - sides[:, 0], sides[:, 2] - sides[:, 0])
    facing = np.ones(len(sides), dtype=bool) if both_sides else normal[:, 2] > 0
    order = np.flatnonzero(facing)[np.argsort(sides[facing, :, 2].mean(axis=1))]
    light = 0.6 + 0.4 * np.abs(normal[order, 2]) / np.maximum(np.linalg.norm(normal[order], axis=1), 1e-300)
    painted = np.array((np.tile(GREY, (len(sides), 1)) if colours is None else colours)[order])
    painted[:, :3] *= light[:, None]
    ax.add_collection(PolyCollection(sides[order][:, :, :2], facecolors=painted, rasterized=True, linewidths=edges or 0.1,
                                     edgecolors="#333333" if edges else painted))
    frame(ax, corners)


def frame(ax: Any, corners: Values, margin: float = 0.02) -> None:
    """Shows all of these points, as seen, and nothing of the axes."""
    low, high = corners.min(axis=0), corners.max(axis=0)
    room = margin * float((high - low)[:2].max())
    ax.set(xlim=(low[0] - room, high[0] + room), ylim=(low[1] - room, high[1] + room), aspect="equal", xticks=[], yticks=[])
    ax.spines[:].set_visible(False)


VIEWS: Final = {"fandisk": view((-1, 0.6, 1)), "wuson": view((1, 0.5, -1)), "couplingdown": view((1, 0.5, -1)), "pinion": view((1, 0.5, -1)),
                "elephant": view((0.2, 0.3, 1)), "refined_elephant": view((0.2, 0.3, 1)), "crown": view((0.2, 0.3, 1)),
                "monster": view((0.3, 0.3, 1)), "bust": view((-0.4, 0.2, 1)), "ramesses": view((0.2, 0.3, 1))}


def view_of(name: str) -> View:
    """Of a model or a scene, chosen by hand where there is an entry in VIEWS."""
    return VIEWS.get(name, view((0.5, 0.4, 1)))


def across(of: View, direction: Values) -> View:
    """The view that is turned until this direction lies in the plane of the picture, from left to right."""
    length = float(np.linalg.norm(direction))
    if not length > 0:
        return of
    right = direction / length
    towards = of.axes[2] - (of.axes[2] @ right) * right
    if np.linalg.norm(towards) < 1e-3:  # seen along the line: any other side will do
        towards = of.axes[1] - (of.axes[1] @ right) * right
    towards /= np.linalg.norm(towards)
    return View(np.stack([right, np.cross(towards, right), towards]))
