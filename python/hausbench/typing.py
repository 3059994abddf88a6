"""Types for annotations. No other module of the package loads this one."""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import Any, Protocol, Union

import numpy.typing as npt

from hausbench.interval import Interval
from hausbench.shapes import Shape


class HasFaces(Protocol):
    """A mesh of another package, such as trimesh."""

    @property
    def vertices(self) -> npt.ArrayLike:
        ...

    @property
    def faces(self) -> npt.ArrayLike:
        ...


class HasTriangles(Protocol):
    """A mesh of open3d."""

    @property
    def vertices(self) -> npt.ArrayLike:
        ...

    @property
    def triangles(self) -> npt.ArrayLike:
        ...


class HasPoints(Protocol):
    """A point set of another package, such as open3d."""

    @property
    def points(self) -> npt.ArrayLike:
        ...


class HasPolygons(Protocol):
    """A vtkPolyData."""

    def GetPoints(self) -> Any:
        ...

    def GetPolys(self) -> Any:
        ...


class HasTensors(Protocol):
    """A mesh of open3d.t."""

    @property
    def vertex(self) -> Any:
        ...

    @property
    def triangle(self) -> Any:
        ...


class HasPointTensors(Protocol):
    """A point cloud or line set of open3d.t."""

    @property
    def point(self) -> Any:
        ...


class HasEntities(Protocol):
    """A path of trimesh."""

    @property
    def vertices(self) -> npt.ArrayLike:
        ...

    @property
    def entities(self) -> Any:
        ...


ShapeLike = Union[
    Shape,
    HasFaces,
    HasTriangles,
    HasPoints,
    HasPolygons,
    HasTensors,
    HasPointTensors,
    HasEntities,
    npt.ArrayLike,
    tuple[npt.ArrayLike, npt.ArrayLike],
    tuple[npt.ArrayLike, npt.ArrayLike, npt.ArrayLike, npt.ArrayLike],
    str,
    "os.PathLike[str]",
]
Pose = Union[npt.ArrayLike, tuple[npt.ArrayLike, npt.ArrayLike], str, "os.PathLike[str]"]
Progress = Callable[[Interval], object]
