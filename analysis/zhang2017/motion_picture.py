"""Draws the motions of Figures 10 and 11 of Zhang et al. 2017: the outline of B, and A at some of
its poses."""

from __future__ import annotations

from typing import Any, Final

import numpy as np
import scipy.ndimage
import scipy.spatial

from analysis.shared import shapes, style
from analysis.shared.columns import Floats
from analysis.shared.results import Results

COLOURS: Final = (
    "#BCB0E0",
    "#9A88CC",
    "#7862B5",
    "#573F9A",
    "#332288",
)  # of A, from the first pose to the last; no solver there has this hue
POSES: Final = len(COLOURS)
MOST: Final = 3000  # approximate number of points drawn of each model
CELLS: Final = 300  # cells along the longer side of the grid that computes the outline
GAP: Final = 0.04  # fraction of the longer side; see draw_outline()


def thinned(points: Floats) -> Floats:
    return points[:: max(1, len(points) // MOST)]


def draw_outline(ax: Any, points: Floats) -> None:
    """Draws the outline of points in the plane, joining points nearer than twice GAP (a
    morphological closing)."""
    low, high = points.min(axis=0), points.max(axis=0)
    gap = GAP * float((high - low).max())
    cell = float((high - low).max()) / CELLS
    x, y = (np.arange(a - 2 * gap, b + 2 * gap, cell) for a, b in zip(low, high))
    grid = np.stack(np.meshgrid(x, y), axis=2)
    near = scipy.spatial.cKDTree(points).query(grid)[0] < gap
    inside = cell * scipy.ndimage.distance_transform_edt(near)
    ax.contour(x, y, inside, levels=[gap], colors="black", linewidths=0.9, zorder=3)


def draw(ax: Any, results: Results, rows: list[int]) -> None:
    """Draws the models as seen along y or z, whichever they extend less in. `rows` has one row per
    pose, in order.

    Draws nothing if a shape is not in the cache.
    """
    ax.axis("off")
    cases = results.cases
    a, b = (shapes.points(results, getattr(cases, side)[rows[0]]) for side in ("source", "target"))
    if a is None or b is None:
        return
    chosen = [rows[i] for i in np.linspace(0, len(rows) - 1, POSES).round().astype(int)]
    placed = [
        shapes.posed(thinned(a), np.asarray(cases.pose[row], dtype=np.float64)) for row in chosen
    ]
    still = shapes.posed(b, np.asarray(cases.target_pose[rows[0]], dtype=np.float64))
    spread = np.ptp(np.vstack([still, *placed]), axis=0)
    across = 1 if spread[1] >= spread[2] else 2  # the motion is along x
    for points, colour in zip(placed, COLOURS):
        ax.scatter(
            points[:, 0], points[:, across], s=0.4, color=colour, linewidths=0, rasterized=True
        )
    draw_outline(ax, still[:, [0, across]])
    ax.set_aspect("equal")
    ax.annotate(
        "",
        (0.75, -0.04),
        (0.25, -0.04),
        xycoords="axes fraction",
        annotation_clip=False,
        arrowprops={"arrowstyle": "->", "color": style.GREY, "linewidth": 0.7},
    )
