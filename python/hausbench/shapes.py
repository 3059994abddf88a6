"""Shapes, and how they are read from files."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from hausbench import _core
from hausbench.arguments import flag
from hausbench.errors import InputError

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt


class Shape:
    """A triangle mesh or a point set. It never changes; structures built over it are kept with it.

    Shape(vertices, faces=None) copies the arrays: vertices (n, 3), in any unit of length, and faces
    (m, 3), rows of `vertices` from 0. Without faces it is a point set. A line segment is a face (a,
    b, b). Raises InputError.

    `read` returns a Shape that also has the unit and axes that its file states, and notes; a copy,
    also by pickle, keeps them.
    """

    __slots__ = ("_shape", "_notes", "__weakref__")
    _shape: _core.Shape
    _notes: tuple[str, ...]

    def __init__(self, vertices: npt.ArrayLike, faces: npt.ArrayLike | None = None) -> None:
        self._fill(vertices, faces, None)

    def _fill(
        self,
        vertices: object,
        faces: object,
        stated: _core._Stated | None,
        notes: tuple[str, ...] = (),
    ) -> None:
        points = _converted(vertices, "vertices")
        self._shape = _core.Shape(
            points, None if faces is None else _converted(faces, "faces"), stated
        )
        self._notes = notes

    @classmethod
    def _made(
        cls, vertices: object, faces: object, stated: _core._Stated, notes: tuple[str, ...] = ()
    ) -> Shape:
        """Returns a Shape that states what is known about its arrays."""
        shape = cls.__new__(cls)
        shape._fill(vertices, faces, stated, notes)
        return shape

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
    def unit(self) -> float | None:
        """The unit of length that the file states or its format defines, in metres; None if there
        is none."""
        return self._stated[4] or None

    @property
    def up(self) -> str | None:
        """The axis that points up as the file states or its format defines: "X", "Y" or "Z"; None
        if it is not stated."""
        return self._stated[5] or None

    @property
    def notes(self) -> tuple[str, ...]:
        """What else you should know about the file that was read, such as parts that were left out:
        one line each."""
        return self._notes

    @property
    def segment_count(self) -> int:
        """The number of line segments that were read. They are among the triangles, as (a, b,
        b)."""
        return self._stated[0]

    @property
    def single_point_count(self) -> int:
        """The number of single points of a mesh that were read. They are among the triangles, as
        (a, a, a)."""
        return self._stated[1]

    @property
    def dropped_point_count(self) -> int:
        """The number of points that `drop_invalid` left out."""
        return self._stated[2]

    @property
    def dropped_face_count(self) -> int:
        """The number of faces that `drop_invalid` left out, because they used such points."""
        return self._stated[3]

    @property
    def _stated(self) -> _core._Stated:
        return self._shape.describe()[5]

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
        return (
            f"<hausbench.Shape: {faces} triangles, {vertices} vertices>"
            if is_mesh
            else f"<hausbench.Shape: {vertices} points>"
        )

    def __reduce__(self) -> tuple[object, tuple[object, ...]]:
        return Shape._made, (self.vertices, self.faces, self._stated, self._notes)


def _converted(values: object, name: str) -> object:
    if _core.is_read(values, name == "faces"):
        return values
    from hausbench import arrays

    return arrays.faces(values) if name == "faces" else arrays.vertices(values)


def read(
    path: str | os.PathLike[str],
    *,
    format: str | None = None,
    columns: str | None = None,
    drop_invalid: bool = False,
    unit: str | None = None,
    up: str | None = None,
) -> Shape:
    """Reads a mesh or points from a file, gzipped or not. docs/formats.md lists the formats; those
    of the program alone raise InputError, as a part of a format does that is not supported. A file
    without faces becomes a point set.

    The coordinates are the numbers that the file defines. Polygons are split into triangles, line
    segments of a mesh become triangles (a, b, b), vertices that no face uses are dropped, and equal
    corners of formats that repeat them are merged. So a field or a witness counts the rows of the
    Shape, not of the file. `notes` of the Shape says what was left out. Raises InputError, with the
    line of the file if it has lines.

    format        "obj", ...: the format; None: the ending of the file counts
    columns       the columns of x, y and z in a text file of points: "2,3,4", or their names; None: by the header
    drop_invalid  drops points with a coordinate that is not finite, and faces that use them
    unit          "mm", "inch", ...: multiplies the coordinates by the file's unit / this unit; a file that states none counts as
                  being in this one. "none": forgets the file's unit. None: the numbers count
    up            "X", "Y", "Z": turns the shape so that this axis points up; a file that states no axes counts as having these.
                  "none": forgets the file's axes. None: the numbers count

    Two shapes that state different units or axes are not compared: read both with the same `unit`
    and `up`.
    """
    texts = [
        _text(value, name)
        for name, value in (("format", format), ("columns", columns), ("unit", unit), ("up", up))
    ]
    shape = Shape.__new__(Shape)
    shape._shape = _core.read(
        path_of(path), texts[0], texts[1], flag(drop_invalid, "drop_invalid"), texts[2], texts[3]
    )
    shape._notes = shape._shape.notes()
    return shape


def _text(value: object, name: str) -> bytes | None:
    if value is None:
        return None
    if not isinstance(value, str) or "\0" in value:
        raise InputError(f"{name}: {value!r} is not a text: give a str or None")
    return value.encode(errors="surrogateescape")


def path_of(path: str | os.PathLike[str]) -> bytes:
    try:
        return os.fsencode(path)
    except TypeError:
        raise InputError(
            f"path: a {type(path).__name__} is not a path: give a str or os.PathLike"
        ) from None
