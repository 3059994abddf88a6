"""Keyword arguments that the questions share, checked and turned into the library's."""

from __future__ import annotations

import operator
from collections.abc import Mapping
from typing import TYPE_CHECKING

from hausbench._core import Pair, Query, Shape
from hausbench.errors import InputError

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    from hausbench.typing import Pose

UNITS = {"diagonal": 0, "length": 1, "lower": 2}
WEIGHTS = {"area": False, "vertex": True}
INFINITY = float("inf")


def number(value: object, name: str) -> float:
    if isinstance(value, float):
        return value
    if isinstance(value, (str, bytes, bool)):
        raise InputError(f"{name}: {value!r} is not a number")
    try:
        return float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"{name}: {value!r} is not a number") from None


def count(value: object, name: str) -> int:
    try:
        chosen = operator.index(value)  # type: ignore[arg-type]
    except TypeError:
        chosen = 0
    if not 1 <= chosen < 2**31 or isinstance(value, bool):
        raise InputError(f"{name}: {value!r} is not a number of threads: give an integer from 1")
    return chosen


def _choice(value: str, name: str, choices: Mapping[str, int]) -> int:
    try:
        return choices[value]
    except (KeyError, TypeError):
        raise InputError(f"{name}: {value!r} is not one of {', '.join(choices)}") from None


def _matrix(pose: Pose | None, name: str) -> npt.NDArray[np.float64] | None:
    if pose is None:
        return None
    from hausbench import arrays

    return arrays.pose(pose, name)


def query_of(tolerance: float, relative_to: str, threads: int, time_limit: float | None, pose: Pose | None,
             target_pose: Pose | None, share_tolerance: float = 1e-3, weigh: str = "area") -> Query:
    return Query(number(tolerance, "tolerance"), _choice(relative_to, "relative_to", UNITS), count(threads, "threads"),
                 INFINITY if time_limit is None else number(time_limit, "time_limit"), _matrix(pose, "pose"),
                 _matrix(target_pose, "target_pose"), number(share_tolerance, "share_tolerance"),
                 bool(_choice(weigh, "weigh", WEIGHTS)))


def pair_of(source: Shape, target: Shape, solver: str | None, options: Mapping[str, object] | None, threads: int,
            pose: Pose | None, target_pose: Pose | None) -> Pair:
    moves = (pose is not None) + 2 * (target_pose is not None)
    return Pair(source, target, solver or "", [f"{name}={_text(value)}" for name, value in (options or {}).items()], threads, moves)


def _text(value: object) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)
