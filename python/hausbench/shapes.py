"""Makes a Shape of anything that has the geometry of one."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from hausbench import _core
from hausbench._core import Shape
from hausbench.errors import InputError

if TYPE_CHECKING:
    from hausbench.typing import ShapeLike


def read(path: str | os.PathLike[str]) -> Shape:
    """Reads OBJ, PLY, STL, OFF, VRML, XYZ, PTS, CSV or PCD, gzipped or not. A file without faces becomes a point set.

    Polygons are split into triangles. Raises InputError, with the line of the file if it has lines.
    """
    return _core.read(os.fsencode(path))


def shape_of(thing: ShapeLike, name: str) -> Shape:
    """Returns the Shape of a mesh or point set, see `directed`. Errors begin with `name`."""
    if isinstance(thing, Shape):
        return thing
    try:
        if isinstance(thing, tuple) and len(thing) == 2:
            return Shape(thing[0], thing[1])
        if isinstance(thing, (str, os.PathLike)):
            return read(thing)
        if hasattr(thing, "__array__") or isinstance(thing, (list, tuple)):
            return Shape(thing)
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
