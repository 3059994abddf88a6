"""Converts arrays that the library does not read in place. Called for them alone; other arrays are
not copied in Python."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from hausbench.errors import InputError

if TYPE_CHECKING:
    import numpy.typing as npt

EXACT = 2**53  # integers up to this are doubles
# What surface distances of masks compare. All voxels, argwhere(mask), would be another shape: the
# inside of one mask lies in the other.
MASK = (
    "for a mask give its boundary voxels as points: "
    "numpy.argwhere(mask & ~scipy.ndimage.binary_erosion(mask)) * spacing"
)


def numbers(values: object, name: str) -> npt.NDArray[Any]:
    if isinstance(values, np.ma.MaskedArray) and np.any(values.mask):
        row = (
            int(np.argwhere(np.broadcast_to(values.mask, values.shape))[0][0]) if values.ndim else 0
        )
        raise InputError(f"{name}: row {row} is masked: remove the row", row)
    try:
        array = np.asarray(values)
    except (TypeError, ValueError) as error:
        if (
            name == "vertices"
            and isinstance(values, (list, tuple))
            and (len(values) in (2, 3) or all(hasattr(v, "ndim") for v in values))
        ):
            raise InputError(
                "vertices: not one array of numbers: give a mesh as Shape(vertices, faces), or as a tuple "
                "(vertices, faces)"
            ) from None
        raise InputError(f"{name}: not an array of numbers: {error}".splitlines()[0]) from None
    if (
        isinstance(values, (list, tuple))
        and array.dtype.kind == "f"
        and (np.abs(array) >= EXACT).any()
    ):
        _expect_exact(values, array, name)
    if array.dtype.kind not in "fiu":
        raise InputError(
            f"{name}: the type {array.dtype} is not a type of {'integers' if name == 'faces' else 'real numbers'}: "
            f"{_remedy(array, name)}"
        )
    return array


def _expect_exact(values: object, array: npt.NDArray[Any], name: str) -> None:
    """Raises InputError if a list has an integer that became another number as a float."""
    for place, value in np.ndenumerate(np.array(values, dtype=object)):
        if isinstance(value, (int, np.integer)) and int(value) != int(array[place]):
            raise InputError(
                f"{name}: row {place[0]} has an integer beyond 2**53, which no double holds: {value}",
                place[0],
            )


def _remedy(array: npt.NDArray[Any], name: str) -> str:
    if array.dtype.kind in "US":
        return "for a file give its path to hausbench.read"
    if array.dtype.kind == "b" and name == "vertices":
        return MASK
    if array.dtype.kind == "O":
        return "give an array of numbers, such as mesh.vertices, or rotation.as_matrix() for a pose"
    return f"convert with astype({'numpy.int64' if name == 'faces' else 'float'})"


def _columns_hint(array: npt.NDArray[Any]) -> str:
    """Returns what to do about an array that has not three columns."""
    if array.ndim == 1 and array.size == 3:
        return ": for one row, write [[x, y, z]]"
    if array.ndim == 2 and array.shape[0] == 3:
        return ": transpose it, with .T"
    if array.ndim == 2 and array.shape[1] > 3:
        return ": keep three columns, such as array[:, :3]"
    return ""


def _aligned(array: npt.NDArray[Any]) -> npt.NDArray[Any]:
    return np.require(np.asarray(array), requirements="A")


def vertices(values: object) -> npt.NDArray[Any]:
    """Returns the same coordinates as float32 or float64 of shape (n, 3). Raises InputError if a
    number would change."""
    array = numbers(values, "vertices")
    if array.ndim != 2 or array.shape[1] != 3:
        plane = (
            ": for points of a plane, append a column of zeros"
            if array.ndim == 2 and array.shape[1] == 2
            else ""
        )
        raise InputError(
            f"vertices: the shape is {array.shape}, not (n, 3){plane or _columns_hint(array) or _tuple_hint(array)}"
        )
    if array.dtype.kind == "f":
        if array.dtype.itemsize > 8:
            raise InputError(
                f"vertices: the type {array.dtype} is wider than float64: convert with astype(float)"
            )
        return _aligned(
            array.astype(np.float32 if array.dtype.itemsize == 4 else np.float64, copy=False)
        )
    if array.dtype.itemsize == 8:
        wrong = np.flatnonzero((array > EXACT).any(axis=1) | (array < -EXACT).any(axis=1))
        if wrong.size:
            row = int(wrong[0])
            raise InputError(
                f"vertices: row {row} has an integer beyond 2**53, which no double holds: {array[row].tolist()}",
                row,
            )
    return _aligned(array.astype(np.float64))


def _tuple_hint(array: npt.NDArray[Any]) -> str:
    if (
        array.ndim == 3
        and array.dtype.kind in "iu"
        and not (array.shape[0] == 2 and array.shape[2] == 3)
    ):
        return f": {MASK}, where mask = labels == 1 for label 1"
    return ": give a mesh as a tuple (vertices, faces)" if array.ndim == 3 else ""


def faces(values: object) -> npt.NDArray[Any]:
    """Returns the same indices as int32 or int64 of shape (m, 3)."""
    array = (
        np.asarray(values)
        if isinstance(values, (list, tuple)) and not values
        else numbers(values, "faces")
    )
    if not array.size:
        raise InputError("faces: has no rows: to compare points, give the vertices alone")
    if array.dtype.kind == "f":
        raise InputError(
            f"faces: the type {array.dtype} is not a type of integers: are vertices and faces exchanged? If not, convert "
            "with astype(numpy.int64)"
        )
    if array.ndim == 1 or (array.ndim == 2 and array.shape[1] == 4):
        _refuse_polygons(array)
    if array.ndim != 2 or array.shape[1] != 3:
        raise InputError(f"faces: the shape is {array.shape}, not (m, 3){_columns_hint(array)}")
    if array.dtype.kind == "i" and array.dtype.itemsize >= 4:
        return _aligned(
            array.astype(np.int32 if array.dtype.itemsize == 4 else np.int64, copy=False)
        )
    if array.dtype.itemsize == 8:
        wrong = np.flatnonzero((array > np.iinfo(np.int64).max).any(axis=1))
        if wrong.size:
            row = int(wrong[0])
            raise InputError(
                f"faces: row {row} has an index that is out of range: {array[row].tolist()}", row
            )
    return _aligned(array.astype(np.int64))


def _refuse_polygons(array: npt.NDArray[Any]) -> None:
    flat = array.ravel()
    if flat.size % 4 == 0 and (flat[::4] == 3).all():
        raise InputError(
            "faces: this is VTK's list [3, i, j, k, 3, ...], as in pyvista: "
            "give (mesh.points, mesh.faces.reshape(-1, 4)[:, 1:])"
        )
    if array.ndim == 1:
        raise InputError(
            f"faces: the shape is {array.shape}, not (m, 3): split polygons into triangles, "
            "in pyvista with mesh.triangulate(), and give (mesh.points, mesh.faces.reshape(-1, 4)[:, 1:])"
        )
    raise InputError(
        "faces: rows have 4 corners: split each quadrangle into two triangles, "
        "such as numpy.vstack([F[:, [0, 1, 2]], F[:, [0, 2, 3]]])"
    )


def pose(values: object, name: str) -> npt.NDArray[np.float64]:
    """Returns a pose as a matrix (4, 4): from one, a rotation (3, 3), or a tuple of a rotation and
    a translation."""
    if isinstance(values, (tuple, list)) and len(values) == 2:
        rotation, shift = _floats(values[0], name), _floats(values[1], name).reshape(-1)
        if shift.size != 3:
            raise InputError(f"{name}: the translation has {shift.size} numbers, not 3")
    else:
        rotation, shift = _floats(values, name), np.zeros(3)
        if rotation.shape == (4, 4):
            if not np.array_equal(rotation[3], [0, 0, 0, 1]):
                raise InputError(
                    f"{name}: the last row is {rotation[3].tolist()}, not [0, 0, 0, 1]: the translation belongs "
                    "in the last column"
                )
            return _finite(rotation, name)
    if rotation.shape != (3, 3):
        raise InputError(
            f"{name}: the shape is {rotation.shape}: give a matrix (4, 4), a rotation (3, 3), "
            "or a tuple (rotation, translation)"
        )
    matrix = np.eye(4)
    matrix[:3, :3] = rotation
    matrix[:3, 3] = shift
    return _finite(matrix, name)


def _finite(matrix: npt.NDArray[np.float64], name: str) -> npt.NDArray[np.float64]:
    if not np.isfinite(matrix).all():
        raise InputError(f"{name}: an entry is not finite")
    return matrix


def _floats(values: object, name: str) -> npt.NDArray[np.float64]:
    array = numbers(values, name)
    if array.dtype.itemsize > 8 or (
        array.dtype.kind != "f" and (np.abs(array.astype(object)) > EXACT).any()
    ):
        raise InputError(f"{name}: has a number that no double holds: round it")
    return np.ascontiguousarray(array, dtype=np.float64)
