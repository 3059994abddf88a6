"""The models of Figures 10 and 11 of Zhang et al. 2017 where they stand: B, and A at some of its poses."""

from __future__ import annotations

from typing import Any, Final

import numpy as np

from analysis.shared import shapes, style
from analysis.shared.columns import Floats
from analysis.shared.results import Results

POSES: Final = 5
COLOURS: Final = ("#332288", "#0072B2", "#009E73", "#E69F00", "#CC6677")  # of A, from the first pose to the last
MOST: Final = 3000  # points drawn of each


def thinned(points: Floats) -> Floats:
    return points[::max(1, len(points) // MOST)]


def draw(ax: Any, results: Results, rows: list[int]) -> None:
    """Draws along the axis in which both models are thinnest. `rows`: one for each pose, in order. Draws nothing if a shape is not in the cache."""
    ax.axis("off")
    cases = results.cases
    a, b = (shapes.points(results, getattr(cases, side)[rows[0]]) for side in ("source", "target"))
    if a is None or b is None:
        return
    chosen = [rows[i] for i in np.linspace(0, len(rows) - 1, POSES).round().astype(int)]
    placed = [shapes.posed(thinned(a), np.asarray(cases.pose[row], dtype=np.float64)) for row in chosen]
    still = shapes.posed(thinned(b), np.asarray(cases.target_pose[rows[0]], dtype=np.float64))
    spread = np.ptp(np.vstack([still, *placed]), axis=0)
    across = 1 if spread[1] >= spread[2] else 2  # the motion is along x
    for points, colour in [*zip(placed, COLOURS), (still, "#222222")]:
        ax.scatter(points[:, 0], points[:, across], s=0.4, color=colour, linewidths=0, rasterized=True)
    ax.set_aspect("equal")
    ax.annotate("", (0.75, -0.04), (0.25, -0.04), xycoords="axes fraction", annotation_clip=False,
                arrowprops={"arrowstyle": "->", "color": style.GREY, "linewidth": 0.7})
