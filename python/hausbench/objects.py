"""Shapes of the objects of other packages, which are recognised by their attributes. Imports none
of these packages.

A line set becomes a mesh of degenerate triangles (a, b, b): its points alone would be another
shape.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from hausbench import arrays
from hausbench.errors import InputError
from hausbench.shapes import Shape

Indices = npt.NDArray[Any]


def shape_of_object(thing: Any) -> Shape:
    """Returns the Shape of an object with geometry. Raises InputError for objects that are not
    known, or only in part."""
    if hasattr(thing, "GetClassName"):
        return _of_vtk(thing)
    for owner, elements in (("vertex", "triangle"), ("point", "line")):
        if (positions := _entry(getattr(thing, owner, None), "positions")) is not None:
            return _of_tensors(thing, _tensor(positions), owner, elements)
    if hasattr(thing, "entities") and hasattr(thing, "vertices"):
        return _of_path(thing)
    if hasattr(thing, "lines") and hasattr(thing, "points"):
        return _of_lines(thing)
    if hasattr(thing, "cells") and hasattr(thing, "points"):
        return _of_cells(thing)
    if hasattr(thing, "cpu") and hasattr(thing, "numpy"):  # a tensor of open3d
        return Shape(_tensor(thing))
    _refuse_other_kinds(thing)
    return _of_attributes(thing)


def _of_attributes(thing: Any) -> Shape:
    vertices, points, faces = (
        getattr(thing, name, None) for name in ("vertices", "points", "faces")
    )
    if faces is None:
        faces = getattr(thing, "triangles", None)  # open3d
    coordinates = points if vertices is None else vertices
    if coordinates is None:
        raise InputError(
            f"an object of type {type(thing).__name__} has no geometry that is known here: give (vertices, faces), points "
            "(n, 3), a path, or an object with .vertices and .faces, or .points"
        )
    return Shape(coordinates, faces)


def _refuse_other_kinds(thing: Any) -> None:
    """Raises InputError for objects whose points alone would be another shape."""
    name = type(thing).__name__
    if hasattr(thing, "tetras"):  # open3d
        raise InputError(f"this {name} is a volume: give its surface as (vertices, faces)")
    if hasattr(thing, "simplices"):  # scipy.spatial
        raise InputError(
            f"this {name} has triangles or a volume of simplices: give the surface, such as (hull.points, hull.simplices) "
            "of a ConvexHull"
        )
    if hasattr(thing, "encoding"):  # trimesh
        raise InputError(
            f"this {name} is a volume of voxels: give its surface, such as grid.marching_cubes, or the centres of its "
            "voxels, grid.points"
        )
    if hasattr(thing, "geometry") and hasattr(thing, "graph"):  # trimesh
        raise InputError(
            f"this {name} has parts in places of their own: give scene.to_mesh(), or, with an older trimesh, "
            "scene.dump(concatenate=True)"
        )


def _none(corners: int) -> Indices:
    return np.zeros((0, corners), np.int64)


def _joined(points: Any, triangles: Indices, lines: Indices, singles: Indices) -> Shape:
    """Returns the mesh of triangles, line segments (k, 2) and single points (k, 1); without
    triangles and segments, the point set of the single points, or of all points if `singles` is
    empty, too."""
    if not len(triangles) and not len(lines):
        if not len(singles):
            return Shape(points)
        vertices = arrays.vertices(points)
        wrong = np.flatnonzero((singles < 0) | (singles >= len(vertices)))
        if wrong.size:
            raise InputError(
                f"point {wrong[0]} names vertex {singles.ravel()[wrong[0]]}, but the vertices are numbered from 0 to "
                f"{len(vertices) - 1}",
                int(wrong[0]),
            )
        return Shape(vertices[singles.ravel()])
    faces = np.concatenate([triangles, lines[:, [0, 1, 1]], singles[:, [0, 0, 0]]])
    return Shape._made(points, faces, (len(lines), len(singles), 0, 0, 0.0, ""))


def _of_segments(points: Any, lines: Indices) -> Shape:
    return _joined(points, _none(3), lines, _none(1))


def _table(values: Any, name: str, columns: int) -> npt.NDArray[np.int64]:
    """Returns indices as an array with this many columns."""
    array = np.asarray(values)
    if not array.size:
        return _none(columns)
    if array.dtype.kind not in "iu" or array.ndim != 2 or array.shape[1] != columns:
        raise InputError(
            f"{name}: an array {array.shape} of {array.dtype}, not integers of shape (n, {columns})"
        )
    return array.astype(np.int64)


# --- VTK and pyvista
# ----------------------------------------------------------------------------------------------------


def _of_vtk(data: Any) -> Shape:
    """Returns the Shape of a vtkPolyData: its polygons, strips, lines and vertices."""
    kind = data.GetClassName()
    if not hasattr(data, "GetPolys"):
        raise InputError(
            f"this {kind} is not a vtkPolyData: give its surface, such as the output of vtkGeometryFilter and "
            "vtkTriangleFilter (pyvista: extract_surface().triangulate())"
        )
    for ghosts in (data.GetCellGhostArray(), data.GetPointGhostArray()):
        if ghosts is not None and _vtk_array(ghosts).any():
            raise InputError(
                f"this {kind} with hidden or ghost cells: remove them, with RemoveGhostCells()"
            )
    if data.GetPoints() is None:
        raise InputError(f"this {kind} without points: run its filter first, with Update()")
    elements: dict[int, list[Indices]] = {3: [], 2: [], 1: []}
    for cells, corners in (
        (data.GetPolys(), 3),
        (data.GetStrips(), 3),
        (data.GetLines(), 2),
        (data.GetVerts(), 1),
    ):
        for count in elements:
            elements[count].append(_windows(cells, count, corners))
    if _longest(data.GetPolys()) > 3:
        raise InputError(
            f"this {kind} with polygons of more than three corners: split them, with vtkTriangleFilter (pyvista: "
            "triangulate())"
        )
    triangles, lines, singles = (np.concatenate(tables) for tables in elements.values())
    return _joined(_vtk_array(data.GetPoints().GetData()), triangles, lines, singles)


def _windows(cells: Any, count: int, corners: int) -> Indices:
    """Returns the corners of the elements with `count` corners of a vtkCellArray whose cells are
    made of elements with `corners` corners: each run of so many within a cell. A cell with fewer
    corners is one smaller element.
    """
    if cells is None or not cells.GetNumberOfCells() or count > corners:
        return _none(count)
    offsets, table = _vtk_array(cells.GetOffsetsArray()), _vtk_array(cells.GetConnectivityArray())
    sizes = np.diff(offsets)
    runs = np.where(sizes >= count if count == corners else sizes == count, sizes - count + 1, 0)
    first = np.repeat(offsets[:-1] - (np.cumsum(runs) - runs), runs) + np.arange(runs.sum())
    rows: Indices = table[first[:, None] + np.arange(count)].astype(np.int64)
    return rows


def _longest(cells: Any) -> int:
    return (
        int(np.diff(_vtk_array(cells.GetOffsetsArray())).max())
        if cells is not None and cells.GetNumberOfCells()
        else 0
    )


def _vtk_array(array: Any) -> npt.NDArray[Any]:
    """Returns the numbers of a vtkDataArray. Most have a buffer; others give their numbers as
    doubles."""
    values = np.asarray(array)
    if values.dtype.kind in "fiu":
        return values
    kind = float if array.GetDataType() in (10, 11) else np.int64  # VTK_FLOAT, VTK_DOUBLE
    rows = [array.GetTuple(i) for i in range(array.GetNumberOfTuples())]
    table = np.array(rows, float).reshape(-1, array.GetNumberOfComponents()).astype(kind)
    return table.ravel() if array.GetNumberOfComponents() == 1 else table


# --- open3d
# -------------------------------------------------------------------------------------------------------------


def _of_lines(thing: Any) -> Shape:
    for attribute in ("faces", "triangles", "cells"):
        if hasattr(thing, attribute):
            raise InputError(
                f"this {type(thing).__name__} may hold lines beside its .{attribute}: give (vertices, faces), with a line "
                "segment as a face (a, b, b)"
            )
    if not len(thing.lines):
        raise InputError(
            f"this {type(thing).__name__} without lines: for its points alone, give an array of them"
        )
    return _of_segments(thing.points, _table(thing.lines, "lines", 2))


def _of_tensors(thing: Any, points: npt.NDArray[Any], owner: str, elements: str) -> Shape:
    table = getattr(thing, elements, None)
    if table is None:
        return Shape(points)
    indices = _entry(table, "indices")
    if indices is None:
        raise InputError(
            f"this {type(thing).__name__} without {elements}s: for its points alone, give {owner}.positions.numpy()"
        )
    if elements == "line":
        return _of_segments(points, _table(_tensor(indices), "lines", 2))
    return Shape(points, _tensor(indices))


def _entry(table: Any, name: str) -> Any:
    """Returns an attribute, or None. Tables of open3d raise KeyError for one that they lack."""
    try:
        return getattr(table, name, None)
    except KeyError:
        return None


def _tensor(tensor: Any) -> npt.NDArray[Any]:
    return np.asarray(tensor.cpu().numpy() if hasattr(tensor, "cpu") else tensor)


# --- trimesh and meshio
# -------------------------------------------------------------------------------------------------


def _of_path(path: Any) -> Shape:
    """Returns the Shape of a trimesh.path.Path3D whose entities are polylines."""
    lines = [_none(2)]
    for entity in path.entities:
        if type(entity).__name__ != "Line":
            raise InputError(
                f"an entity of its path is a curve ({type(entity).__name__}), which is not read: replace it by line "
                "segments, such as path.discrete has, and give them as (points, rows (a, b, b))"
            )
        corners = np.asarray(entity.points)
        lines.append(np.stack([corners[:-1], corners[1:]], axis=-1).astype(np.int64))
    vertices = np.asarray(path.vertices)
    if vertices.ndim == 2 and vertices.shape[1] == 2:
        raise InputError(f"this {type(path).__name__} lies in a plane: give path.to_3D()")
    joined = np.concatenate(lines)
    if not len(joined):
        raise InputError(
            f"this {type(path).__name__} without entities: for its points alone, give path.vertices"
        )
    return _of_segments(vertices, joined)


CORNERS = {"triangle": 3, "line": 2, "vertex": 1}


def _of_cells(mesh: Any) -> Shape:
    """Returns the Shape of a meshio.Mesh of triangles, lines and vertices."""
    cells = mesh.cells.items() if hasattr(mesh.cells, "items") else mesh.cells
    blocks = [
        (block.type, block.data) if hasattr(block, "type") else tuple(block) for block in cells
    ]
    others = sorted({str(kind) for kind, _ in blocks} - set(CORNERS))
    if others:
        raise InputError(
            f"has cells of other kinds than triangles, lines and vertices ({', '.join(others)}): split polygons into "
            "triangles, and take the surface of volumes; for its triangles alone give "
            "(mesh.points, mesh.cells_dict['triangle'])"
        )
    tables = {}
    for kind, corners in CORNERS.items():
        tables_of_kind = [_table(data, kind, corners) for name, data in blocks if name == kind]
        tables[kind] = np.concatenate([_none(corners), *tables_of_kind])
    return _joined(mesh.points, tables["triangle"], tables["line"], tables["vertex"])
