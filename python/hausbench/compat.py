"""Functions with the signatures and return types of other packages, over certified bounds.

Each returns a float, as the original does. For an interval ask hausbench.directed or
hausbench.symmetric.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from hausbench import arrays
from hausbench.calls import directed, symmetric
from hausbench.errors import InputError
from hausbench.shapes import Shape

if TYPE_CHECKING:
    import numpy.typing as npt

FINE = 1e-13  # of the diagonal; scan then stops at the precision of doubles


def directed_hausdorff(
    u: npt.ArrayLike, v: npt.ArrayLike, seed: int | None = 0
) -> tuple[float, int, int]:
    """Returns (d, i, j), as scipy.spatial.distance.directed_hausdorff: h(u,v) between the points of
    two arrays (n, k).

    u[i] is a point of u farthest from v, v[j] a point of v nearest to it, and d their distance,
    rounded: 5.0 for a distance of exactly 5. Of several such pairs, scipy may return another. `k`
    may be 1, 2 (the missing coordinates are 0) or 3. `seed`, by which scipy shuffles the points, is
    ignored.
    """
    left, right = _columns(u, "u"), _columns(v, "v")
    if left.shape[1] != right.shape[1]:
        raise InputError(
            f"u has {left.shape[1]} columns and v has {right.shape[1]}: give arrays with the same number of columns"
        )
    answer = directed(_points(left, "u"), _points(right, "v"), tolerance=FINE)
    witness = answer.witness
    if witness is None:
        return answer.interval.upper, -1, -1
    return (
        math.dist(witness.source_point, witness.target_point),
        witness.source_row,
        witness.target_row,
    )


def hausdorff(VA: npt.ArrayLike, FA: npt.ArrayLike, VB: npt.ArrayLike, FB: npt.ArrayLike) -> float:
    """Returns H(A,B) of two meshes, as igl.hausdorff: the upper end of an interval that is 1e-6 of
    A's diagonal wide.

    igl measures the vertices alone, so its number may be much smaller; hausbench measures the whole
    surface.
    """
    return symmetric((VA, FA), (VB, FB)).interval.upper


def _columns(values: npt.ArrayLike, name: str) -> npt.NDArray[Any]:
    try:
        array = arrays.numbers(values, "vertices")
    except InputError as error:
        raise error.about(name) from None
    if array.ndim != 2 or not 1 <= array.shape[1] <= 3:
        raise InputError(
            f"{name}: the shape is {array.shape}: give an array (n, k) with k from 1 to 3"
        )
    return array


def _points(array: npt.NDArray[Any], name: str) -> Shape:
    try:
        return Shape(
            np.hstack([array, np.zeros((len(array), 3 - array.shape[1]), dtype=array.dtype)])
        )
    except InputError as error:
        raise error.about(name) from None
