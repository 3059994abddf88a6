"""Meshes for display in 3-D: with at most MOST triangles, and as base64 text of small integers."""

from __future__ import annotations

import base64
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from analysis.shared.columns import Floats
from analysis.shared.shapes import Indices, Mesh

MOST: Final = 20_000
LEVELS: Final = 65_535  # coordinates and values are stored in 16 bits, as fractions of their range
EXTENTS: Final = (1e-30, 1e30)  # of coordinates that the single precision of WebGL can show


@dataclass(frozen=True)
class Display:
    """A mesh to show. Each corner and each triangle is one of the original mesh, so values that
    belong to it stay true."""

    corners: Indices  # of the original mesh
    triangles: npt.NDArray[np.int64]  # n x 3, indices into `corners`
    elements: Indices  # the triangle of the original mesh that each triangle stands for
    simplified: bool


def simplify(mesh: Mesh, weights: Floats | None = None, most: int = MOST) -> Display:
    """Merges the corners in each cell of a grid into one of them, the one with the largest weight.
    The grid is the finest that leaves few enough triangles, found by bisection.

    O(n log n) in the size of the mesh. Triangles whose corners fall together vanish; of several
    that become the same, the first stays.
    """
    if len(mesh.triangles) <= most:
        return Display(
            np.arange(len(mesh.corners)), mesh.triangles, np.arange(len(mesh.triangles)), False
        )
    least, greatest, finest = 1, 4096, _merged(mesh, weights, 1)
    while greatest - least > 1:
        cells = (least + greatest) // 2
        merged = _merged(mesh, weights, cells)
        if len(merged.triangles) <= most:
            least, finest = cells, merged
        else:
            greatest = cells
    return finest


def _merged(mesh: Mesh, weights: Floats | None, cells: int) -> Display:
    low, high = mesh.corners.min(axis=0), mesh.corners.max(axis=0)
    edge = float((high - low).max()) / cells or 1.0
    _, place = np.unique(
        np.floor((mesh.corners - low) / edge).astype(np.int64), axis=0, return_inverse=True
    )
    place = place.reshape(-1)
    order = np.argsort(
        weights if weights is not None else np.zeros(len(place)), kind="stable"
    )  # later ones win below
    chosen = np.zeros(int(place.max()) + 1, dtype=np.int64)
    chosen[place[order]] = order
    triangles = place[mesh.triangles]
    kept = np.flatnonzero(
        (triangles[:, 0] != triangles[:, 1])
        & (triangles[:, 1] != triangles[:, 2])
        & (triangles[:, 2] != triangles[:, 0])
    )
    _, first = np.unique(np.sort(triangles[kept], axis=1), axis=0, return_index=True)
    elements = kept[np.sort(first)]
    return Display(chosen, triangles[elements], elements, True)


def can_be_shown(mesh: Mesh) -> bool:
    """Tells whether the largest |coordinate| is within EXTENTS."""
    return bool(len(mesh.triangles) and EXTENTS[0] < np.abs(mesh.corners).max() < EXTENTS[1])


def text(values: npt.NDArray[Any]) -> str:
    """Returns the bytes of an array as base64."""
    return base64.b64encode(np.ascontiguousarray(values).tobytes()).decode()


def quantised(values: Floats) -> dict[str, Any]:
    """Returns {low, high, data}: each column (or the only one) in 16 bits between its least and
    greatest value, which must be finite."""
    low, high = values.min(axis=0), values.max(axis=0)
    span = np.where(high > low, high - low, 1.0)
    return {
        "low": np.atleast_1d(low).tolist(),
        "high": np.atleast_1d(high).tolist(),
        "data": text(np.rint((values - low) / span * LEVELS).astype("<u2")),
    }


def packed(mesh: Mesh, shown: Display) -> dict[str, Any]:
    """Returns a mesh as JSON for view.js."""
    wide = len(shown.corners) > LEVELS
    return {
        "corners": quantised(mesh.corners[shown.corners]),
        "triangles": text(shown.triangles.astype("<u4" if wide else "<u2")),
        "wide": wide,
        "count": len(shown.triangles),
        "of": len(mesh.triangles),
        "simplified": shown.simplified,
    }
