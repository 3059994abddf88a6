"""The shape of anything that has the geometry of one."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from hausbench.errors import InputError
from hausbench.shapes import Shape, read

if TYPE_CHECKING:
    from hausbench.typing import ShapeLike


def shape_of(thing: ShapeLike, name: str) -> Shape:
    """Returns the Shape of a mesh or point set, see `directed`. Errors begin with `name`."""
    if isinstance(thing, Shape):
        return thing
    try:
        if isinstance(thing, tuple) and (len(thing) == 2 or _is_marching_cubes(thing)):
            return Shape(thing[0], thing[1])
        if isinstance(thing, (str, os.PathLike)):
            return read(thing)
        if hasattr(thing, "__array__") or isinstance(thing, (list, tuple, memoryview)):
            return Shape(thing)  # type: ignore[arg-type]  # hasattr() tells mypy nothing
        from hausbench.objects import shape_of_object

        return shape_of_object(thing)
    except InputError as error:
        raise error.about(name) from None


def _is_marching_cubes(thing: tuple[object, ...]) -> bool:
    """Returns whether this is (vertices, faces, normals, values), as of
    skimage.measure.marching_cubes."""
    return [getattr(array, "ndim", None) for array in thing] == [2, 2, 2, 1]
