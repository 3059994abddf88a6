"""Draws meshes in parallel projection, the farthest triangles first."""

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
    """The direction of view, as three unit vectors: right, up, and towards the eye."""

    axes: Floats

    def seen(self, points: Floats) -> Floats:
        return np.asarray(points @ self.axes.T)


def view(eye: tuple[float, float, float], up: tuple[float, float, float] = (0.0, 1.0, 0.0)) -> View:
    towards = np.array(eye) / np.linalg.norm(eye)
    right = np.cross(up, towards)
    right /= np.linalg.norm(right)
    return View(np.stack([right, np.cross(towards, right), towards]))


def draw(
    ax: Any,
    shown: Mesh,
    of: View,
    colours: Floats | None = None,
    edges: float = 0.0,
    both_sides: bool = False,
    shade: float = 0.4,
) -> None:
    """Draws triangles in `colours` (RGBA rows; default: grey), darkened by up to `shade` as they
    turn away from the eye.

    `edges` is the width of outlines; 0: none. Triangles that face away are left out unless
    `both_sides` is set, as is needed for a surface with holes.
    """
    corners = of.seen(shown.corners)
    sides = corners[shown.triangles]
    normal = np.cross(sides[:, 1] - sides[:, 0], sides[:, 2] - sides[:, 0])
    facing = np.ones(len(sides), dtype=bool) if both_sides else normal[:, 2] > 0
    order = np.flatnonzero(facing)[np.argsort(sides[facing, :, 2].mean(axis=1))]
    light = (
        1
        - shade
        + shade
        * np.abs(normal[order, 2])
        / np.maximum(np.linalg.norm(normal[order], axis=1), 1e-300)
    )
    painted = np.array((np.tile(GREY, (len(sides), 1)) if colours is None else colours)[order])
    painted[:, :3] *= light[:, None]
    polygons: Any = sides[order][
        :, :, :2
    ]  # matplotlib takes an array, too, although its types ask for a sequence
    ax.add_collection(
        PolyCollection(
            polygons,
            facecolors=painted,
            rasterized=True,
            linewidths=edges or (0.3 if (painted[:, 3] == 1).all() else 0.1),
            edgecolors="#333333" if edges else painted,
        )
    )
    frame(ax, corners)


def frame(ax: Any, corners: Floats, margin: float = 0.02) -> None:
    """Fits the axes to these projected points, and hides ticks and border. A single point has room
    around it."""
    low, high = corners.min(axis=0), corners.max(axis=0)
    room = margin * float((high - low)[:2].max()) or 1.0
    ax.set(
        xlim=(low[0] - room, high[0] + room),
        ylim=(low[1] - room, high[1] + room),
        aspect="equal",
        xticks=[],
        yticks=[],
    )
    ax.spines[:].set_visible(False)


def ring(ax: Any, at: Floats, colour: str = "black", size: float = 9.0) -> None:
    """Marks a point with a ring. Its white edge keeps it visible on dark surfaces."""
    for edge, width in (("white", 3.2), (colour, 1.4)):
        ax.plot(
            [at[0]],
            [at[1]],
            "o",
            markersize=size,
            markerfacecolor="none",
            markeredgecolor=edge,
            markeredgewidth=width,
            zorder=6,
        )


def thumbnails(
    ax: Any, placed: Sequence[tuple[Mesh, View, float, float]], most: int = 2000
) -> None:
    """Draws meshes side by side, each scaled to size 1 and centred at its (x, y).

    Meshes of more than `most` triangles are drawn without edges.
    """
    middles = np.array([[x, y] for _, _, x, y in placed])
    for shown, of, x, y in placed:
        seen = of.seen(shown.corners)
        low, high = seen.min(axis=0), seen.max(axis=0)
        moved = (seen - 0.5 * (low + high)) / max(float((high - low)[:2].max()), 1e-300) + np.array(
            [x, y, 0.0]
        )
        draw(
            ax,
            Mesh(moved @ of.axes, shown.triangles),
            of,
            edges=0.12 if len(shown.triangles) <= most else 0.0,
            both_sides=not shown.closed,
        )
    frame(ax, np.concatenate([middles - 0.5, middles + 0.5]))


VIEWS: Final = {
    "fandisk": view((-1, 0.6, 1)),
    "wuson": view((1, 0.5, -1)),
    "couplingdown": view((1, 0.5, -1)),
    "pinion": view((1, 0.5, -1)),
    "elephant": view((0.2, 0.3, 1)),
    "refined_elephant": view((0.2, 0.3, 1)),
    "crown": view((0.2, 0.3, 1)),
    "monster": view((0.3, 0.3, 1)),
    "bust": view((-0.4, 0.2, 1)),
    "ramesses": view((0.2, 0.3, 1)),
}


def view_of(name: str) -> View:
    """Returns the view of a model or scene: the one chosen by hand in VIEWS, or a default."""
    return VIEWS.get(name, view((0.5, 0.4, 1)))


def _hidden_by(shown: Mesh, of: View, point: Floats) -> int:
    """Returns the number of triangles that hide a point of the mesh in this view."""
    x, y, depth = of.seen(point)
    sides = of.seen(shown.corners)[shown.triangles]
    a, b, c = (sides[:, k, :2] - (x, y) for k in range(3))
    weights = np.stack(
        [
            b[:, 0] * c[:, 1] - b[:, 1] * c[:, 0],
            c[:, 0] * a[:, 1] - c[:, 1] * a[:, 0],
            a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0],
        ]
    )
    area = weights.sum(axis=0)
    inside = ((weights >= 0).all(axis=0) | (weights <= 0).all(axis=0)) & (area != 0)
    at = (weights[:, inside] * sides[inside, :, 2].T).sum(axis=0) / area[inside]
    return int((at > depth + 1e-6 * float(np.ptp(shown.corners))).sum())


def _facing(shown: Mesh, of: View, point: Floats) -> float:
    """Returns how directly the surface at the vertex nearest to the point faces the eye: 1 if
    straight, at most 0 if it faces away."""
    nearest = int(np.argmin(np.linalg.norm(shown.corners - point, axis=1)))
    sides = of.seen(
        shown.corners[shown.triangles[(shown.triangles == nearest).any(axis=1)].reshape(-1)]
    ).reshape(-1, 3, 3)
    normal = np.cross(sides[:, 1] - sides[:, 0], sides[:, 2] - sides[:, 0]).sum(axis=0)
    return float(normal[2] / max(float(np.linalg.norm(normal)), 1e-300))


def showing(shown: Mesh, of: View, point: Floats) -> View:
    """Rotates the view, by as little as possible, until the point is not hidden and the surface
    there is not seen edge-on.

    Returns the view unchanged if no rotation achieves this.
    """
    x, y, z = of.axes[2]
    round_by, height = np.arctan2(x, z), np.arcsin(np.clip(y, -1, 1))
    turns = [(turn, tilt) for turn in range(-180, 180, 15) for tilt in range(-75, 76, 15)]
    for turn, tilt in np.deg2rad(sorted(turns, key=lambda angles: angles[0] ** 2 + angles[1] ** 2)):
        up = height + tilt
        if abs(up) > np.deg2rad(80):
            continue
        turned = (
            of
            if turn == tilt == 0
            else view(
                (
                    np.cos(up) * np.sin(round_by + turn),
                    np.sin(up),
                    np.cos(up) * np.cos(round_by + turn),
                )
            )
        )
        if not _hidden_by(shown, turned, point) and _facing(shown, turned, point) > 0.3:
            return turned
    return of


def across(of: View, direction: Floats) -> View:
    """Rotates the view until this direction points to the right in the picture."""
    length = float(np.linalg.norm(direction))
    if not length > 0:
        return of
    right = direction / length
    towards = of.axes[2] - (of.axes[2] @ right) * right
    if (
        np.linalg.norm(towards) < 1e-3
    ):  # the view is along the direction: rotate towards its up vector
        towards = of.axes[1] - (of.axes[1] @ right) * right
    towards /= np.linalg.norm(towards)
    return View(np.stack([right, np.cross(towards, right), towards]))
