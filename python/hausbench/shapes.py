"""Shapes, and how one is made of anything that has the geometry of one."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from hausbench import _core
from hausbench.errors import InputError

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    from hausbench.typing import ShapeLike


class Shape:
    """A triangle mesh or a point set. It never changes; structures built over it are kept with it.

    Shape(vertices, faces=None) copies the arrays: vertices (n, 3), in any unit of length, and faces (m, 3), rows of `vertices`
    from 0. Without faces it is a point set. Raises InputError.
    """

    __slots__ = ("_shape", "__weakref__")
    _shape: _core.Shape

    def __init__(self, vertices: npt.ArrayLike, faces: npt.ArrayLike | None = None) -> None:
        points = _converted(vertices, "vertices")
        self._shape = _core.Shape(points, None if faces is None else _converted(faces, "faces"))

    @property
    def is_mesh(self) -> bool:
        """Whether this is a mesh, not a point set."""
        return self._shape.describe()[0]

    @property
    def vertex_count(self) -> int:
        """The number of vertices, with those that no face uses, or of points."""
        return self._shape.describe()[1]

    @property
    def face_count(self) -> int:
        """The number of triangles; 0 for a point set."""
        return self._shape.describe()[2]

    @property
    def box(self) -> npt.NDArray[np.float64]:
        """The bounding box: (2, 3), the smallest coordinates, then the largest."""
        return self._shape.describe()[3]

    @property
    def diagonal(self) -> float:
        """The diagonal of the bounding box, rounded."""
        return self._shape.describe()[4]

    @property
    def vertices(self) -> npt.NDArray[np.float64]:
        """A copy of the vertices or points: (n, 3)."""
        return self._shape.vertices()

    @property
    def faces(self) -> npt.NDArray[np.int64] | None:
        """A copy of the triangles: (m, 3); None for a point set."""
        return self._shape.faces()

    def __repr__(self) -> str:
        is_mesh, vertices, faces = self._shape.describe()[:3]
        return f"<hausbench.Shape: {faces} triangles, {vertices} vertices>" if is_mesh else f"<hausbench.Shape: {vertices} points>"

    def __reduce__(self) -> tuple[type[Shape], tuple[object, object]]:
        return Shape, (self.vertices, self.faces)


def _converted(values: object, name: str) -> object:
    if _core.is_read(values, name == "faces"):
        return values
    from hausbench import arrays

    return arrays.faces(values) if name == "faces" else arrays.vertices(values)


def read(path: str | os.PathLike[str]) -> Shape:
    """Reads OBJ, PLY, STL, OFF, VRML, XYZ, PTS, CSV or PCD, gzipped or not. A file without faces becomes a point set.

    Polygons are split into triangles, vertices that no face uses are dropped, and equal corners of an STL file are merged. So
    a field or a witness counts the rows of the Shape, not of the file. Raises InputError, with the line of the file if it has
    lines.
    """
    shape = Shape.__new__(Shape)
    shape._shape = _core.read(path_of(path))
    return shape


def path_of(path: str | os.PathLike[str]) -> bytes:
    try:
        return os.fsencode(path)
    except TypeError:
        raise InputError(f"path: a {type(path).__name__} is not a path: give a str or os.PathLike") from None


def shape_of(thing: ShapeLike, name: str) -> Shape:
    """Returns the Shape of a mesh or point set, see `directed`. Errors begin with `name`."""
    if isinstance(thing, Shape):
        return thing
    try:
        if isinstance(thing, tuple) and len(thing) == 2:
            return Shape(thing[0], thing[1])
        if isinstance(thing, (str, os.PathLike)):
            return read(thing)
        if hasattr(thing, "__array__") or isinstance(thing, (list, tuple, memoryview)):
            return Shape(thing)  # type: ignore[arg-type]  # hasattr() tells mypy nothing
        return _shape_of_attributes(thing)
    except InputError as error:
        raise error.about(name) from None


def _shape_of_attributes(thing: object) -> Shape:
    vertices = getattr(thing, "vertices", None)
    points = getattr(thing, "points", None)
    faces = getattr(thing, "faces", None)
    if faces is None:
        faces = getattr(thing, "triangles", None)  # open3d
    coordinates = points if vertices is None else vertices
    if coordinates is None:
        raise InputError(f"a {type(thing).__name__} has no geometry that is known here: give (vertices, faces), points (n, 3), "
                         "a path, or an object with .vertices and .faces, or .points")
    if faces is not None:
        return Shape(coordinates, faces)
    if hasattr(thing, "cells"):  # meshio: its points alone would be another shape
        raise InputError("its triangles are among other cells: give (mesh.points, mesh.cells_dict['triangle'])")
    return Shape(coordinates)
