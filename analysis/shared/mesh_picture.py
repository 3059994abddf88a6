"""Pictures of meshes, seen from far away without perspective; the farthest triangles are drawn first."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from matplotlib.collections import PolyCollection

from analysis.shared.columns import Floats
from analysis.shared.shapes import Mesh

GREY: Final = (0.80, 0.80, 0.82, 1.0)


@dataclass(frozen=True)
class View:
    """Three unit vectors: to the right, up, and towards the eye."""

    axes: Floats

    def seen(self, points: Floats) -> Floats:
        return np.asarray(points @ self.axes.T)


def view(eye: tuple[float, float, float], up: tuple[float, float, float] = (0.0, 1.0, 0.0)) -> View:
    towards = np.array(eye) / np.linalg.norm(eye)
    right = np.cross(up, towards)
    right /= np.linalg.norm(right)
    return View(np.stack([right, np.cross(towards, right), towards]))


def draw(ax: Any, shown: Mesh, of: View, colours: Floats | None = None, edges: float = 0.0, both_sides: bool = False, shade: float = 0.4) -> None:
    """Draws triangles in their colours (n x 4; default: grey), darker by up to `shade` the more they turn away from the eye.

    `edges` is the width of their outlines; 0: none. Triangles that face away are left out, unless `both_sides` is set:
    a surface with holes shows its inside.
    """
    corners = of.seen(shown.corners)
    sides = corners[shown.triangles]
    normal = np.cross(sides[:, 1] - sides[:, 0], sides[:, 2] - sides[:, 0])
    facing = np.ones(len(sides), dtype=bool) if both_sides else normal[:, 2] > 0
    order = np.flatnonzero(facing)[np.argsort(sides[facing, :, 2].mean(axis=1))]
    light = 1 - shade + shade * np.abs(normal[order, 2]) / np.maximum(np.linalg.norm(normal[order], axis=1), 1e-300)
    painted = np.array((np.tile(GREY, (len(sides), 1)) if colours is None else colours)[order])
    painted[:, :3] *= light[:, None]
    ax.add_collection(PolyCollection(sides[order][:, :, :2], facecolors=painted, rasterized=True, linewidths=edges or (0.3 if (painted[:, 3] == 1).all() else 0.1),
                                     edgecolors="#333333" if edges else painted))
    frame(ax, corners)


def frame(ax: Any, corners: Floats, margin: float = 0.02) -> None:
    """Fits the axes to all of these projected points, and hides everything else of the axes."""
    low, high = corners.min(axis=0), corners.max(axis=0)
    room = margin * float((high - low)[:2].max())
    ax.set(xlim=(low[0] - room, high[0] + room), ylim=(low[1] - room, high[1] + room), aspect="equal", xticks=[], yticks=[])
    ax.spines[:].set_visible(False)


def ring(ax: Any, at: Floats, colour: str = "black", size: float = 9.0) -> None:
    """Draws a ring with a white edge, which stands out on dark and on light surfaces."""
    for edge, width in (("white", 3.2), (colour, 1.4)):
        ax.plot([at[0]], [at[1]], "o", markersize=size, markerfacecolor="none", markeredgecolor=edge, markeredgewidth=width, zorder=6)


def thumbnails(ax: Any, placed: Sequence[tuple[Mesh, View, float, float]], most: int = 2000) -> None:
    """Draws meshes in one frame, each scaled to a box of size 1 that is centred at its place (x, y).

    A mesh of more than `most` triangles has no edges.
    """
    middles = np.array([[x, y] for _, _, x, y in placed])
    for shown, of, x, y in placed:
        seen = of.seen(shown.corners)
        low, high = seen.min(axis=0), seen.max(axis=0)
        moved = (seen - 0.5 * (low + high)) / max(float((high - low)[:2].max()), 1e-300) + np.array([x, y, 0.0])
        draw(ax, Mesh(moved @ of.axes, shown.triangles), of, edges=0.12 if len(shown.triangles) <= most else 0.0, both_sides=not shown.closed)
    frame(ax, np.concatenate([middles - 0.5, middles + 0.5]))


VIEWS: Final = {"fandisk": view((-1, 0.6, 1)), "wuson": view((1, 0.5, -1)), "couplingdown": view((1, 0.5, -1)), "pinion": view((1, 0.5, -1)),
                "elephant": view((0.2, 0.3, 1)), "refined_elephant": view((0.2, 0.3, 1)), "crown": view((0.2, 0.3, 1)),
                "monster": view((0.3, 0.3, 1)), "bust": view((-0.4, 0.2, 1)), "ramesses": view((0.2, 0.3, 1))}


def view_of(name: str) -> View:
    """Returns the view of a model or a scene: the one in VIEWS, chosen by hand, or else a usual one."""
    return VIEWS.get(name, view((0.5, 0.4, 1)))


def _hidden_by(shown: Mesh, of: View, point: Floats) -> int:
    """Returns the number of triangles in front of a point of the mesh."""
    x, y, depth = of.seen(point)
    sides = of.seen(shown.corners)[shown.triangles]
    a, b, c = (sides[:, k, :2] - (x, y) for k in range(3))
    weights = np.stack([b[:, 0] * c[:, 1] - b[:, 1] * c[:, 0], c[:, 0] * a[:, 1] - c[:, 1] * a[:, 0], a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]])
    area = weights.sum(axis=0)
    inside = ((weights >= 0).all(axis=0) | (weights <= 0).all(axis=0)) & (area != 0)
    at = (weights[:, inside] * sides[inside, :, 2].T).sum(axis=0) / area[inside]
    return int((at > depth + 1e-6 * float(np.ptp(shown.corners))).sum())


def _facing(shown: Mesh, of: View, point: Floats) -> float:
    """Returns how directly the triangles at the vertex nearest to the point face the eye: 1 if straight, 0 or less if turned away."""
    nearest = int(np.argmin(np.linalg.norm(shown.corners - point, axis=1)))
    sides = of.seen(shown.corners[shown.triangles[(shown.triangles == nearest).any(axis=1)].reshape(-1)]).reshape(-1, 3, 3)
    normal = np.cross(sides[:, 1] - sides[:, 0], sides[:, 2] - sides[:, 0]).sum(axis=0)
    return float(normal[2] / max(float(np.linalg.norm(normal)), 1e-300))


def showing(shown: Mesh, of: View, point: Floats) -> View:
    """Returns the view turned about the vertical, and raised or lowered, by the least angles that show the point and not edge-on.

    Returns the view itself if no angles do.
    """
    x, y, z = of.axes[2]
    round_by, height = np.arctan2(x, z), np.arcsin(np.clip(y, -1, 1))
    turns = [(turn, tilt) for turn in range(-180, 180, 15) for tilt in range(-75, 76, 15)]
    for turn, tilt in np.deg2rad(sorted(turns, key=lambda one: one[0]**2 + one[1]**2)):
        up = height + tilt
        if abs(up) > np.deg2rad(80):
            continue
        turned = of if turn == tilt == 0 else view((np.cos(up) * np.sin(round_by + turn), np.sin(up), np.cos(up) * np.cos(round_by + turn)))
        if not _hidden_by(shown, turned, point) and _facing(shown, turned, point) > 0.3:
            return turned
    return of


def across(of: View, direction: Floats) -> View:
    """Returns the view turned until this direction lies in the plane of the picture, from left to right."""
    length = float(np.linalg.norm(direction))
    if not length > 0:
        return of
    right = direction / length
    towards = of.axes[2] - (of.axes[2] @ right) * right
    if np.linalg.norm(towards) < 1e-3:  # seen along the line: any other side will do
        towards = of.axes[1] - (of.axes[1] @ right) * right
    towards /= np.linalg.norm(towards)
    return View(np.stack([right, np.cross(towards, right), towards]))
