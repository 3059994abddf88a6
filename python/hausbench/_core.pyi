import numpy as np
import numpy.typing as npt
from typing import Callable, Optional, Sequence

_Point = tuple[float, float, float]

# status, lower, upper, to_source, source point, target point, source row, target row, seconds to prepare and to solve
_RawAnswer = tuple[int, float, float, bool, _Point, _Point, int, int, float, float]

# gets the bounds so far, of the distance or of each statistic
_Progress = Callable[[list[tuple[float, float]]], object]

# segments, single points, dropped points and faces, the unit in metres or 0, the axis that points up or ""
_Stated = tuple[int, int, int, int, float, str]

class _Type(type): ...  # of pybind11

class Shape(metaclass=_Type):
    def __init__(
        self, vertices: object, faces: object, stated: Optional[_Stated] = ...
    ) -> None: ...
    # Whether it is a mesh, the numbers of vertices and faces, the box and its diagonal, and how it came to be.
    def describe(self) -> tuple[bool, int, int, npt.NDArray[np.float64], float, _Stated]: ...
    def vertices(self) -> npt.NDArray[np.float64]: ...
    def faces(self) -> Optional[npt.NDArray[np.int64]]: ...
    def notes(self) -> tuple[str, ...]: ...

class Query(metaclass=_Type):
    def __init__(
        self,
        tolerance: float,
        relative_to: int,
        threads: int,
        time_limit: float,
        source_pose: Optional[npt.NDArray[np.float64]],
        target_pose: Optional[npt.NDArray[np.float64]],
        share_tolerance: float,
        weigh_by_number: bool,
    ) -> None: ...

class Pair(metaclass=_Type):
    def __init__(
        self,
        source: Shape,
        target: Shape,
        solver: str,
        parameters: Sequence[str],
        threads: int,
        moves: int,
    ) -> None: ...
    def directed(
        self, query: Query, chain: Optional[Chain] = ..., progress: Optional[_Progress] = ...
    ) -> _RawAnswer: ...
    def symmetric(
        self, query: Query, chain: Optional[Chain] = ..., progress: Optional[_Progress] = ...
    ) -> _RawAnswer: ...
    def within(
        self,
        symmetric: bool,
        length: float,
        query: Query,
        chain: Optional[Chain] = ...,
        progress: Optional[_Progress] = ...,
    ) -> _RawAnswer: ...
    def certify(self, symmetric: bool, query: Query, path: bytes) -> _RawAnswer: ...
    def distribution(
        self, statistics: Sequence[str], query: Query, progress: Optional[_Progress] = ...
    ) -> tuple[list[tuple[float, float]], _RawAnswer]: ...
    def field(
        self, query: Query, count: int
    ) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.int64]]: ...

class Chain(metaclass=_Type):
    def __init__(self, pair: Pair) -> None: ...

def read(
    path: bytes,
    format: Optional[bytes],
    columns: Optional[bytes],
    drop_invalid: bool,
    unit: Optional[bytes],
    up: Optional[bytes],
) -> Shape: ...
def is_read(values: object, integers: bool) -> bool: ...
def verify(
    path: bytes,
    source: Shape,
    target: Shape,
    source_pose: npt.NDArray[np.float64] | None,
    target_pose: npt.NDArray[np.float64] | None,
) -> tuple[bool, float, float, float, str, npt.NDArray[np.float64], npt.NDArray[np.float64]]: ...
def solvers() -> list[str]: ...
def version() -> str: ...
