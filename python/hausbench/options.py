"""Keyword arguments that the questions share, checked and turned into the library's."""

from __future__ import annotations

import operator
from collections.abc import Mapping
from typing import TYPE_CHECKING

from hausbench._core import Pair, Query
from hausbench.errors import InputError
from hausbench.interval import exact

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    from hausbench.shapes import Shape
    from hausbench.typing import Pose

UNITS = {"diagonal": 0, "length": 1, "lower": 2}
WEIGHTS = {"area": False, "vertex": True}
INFINITY = float("inf")


def number(value: object, name: str) -> float:
    if type(value) is float:
        return value
    if isinstance(value, (str, bytes, bool)):
        raise InputError(f"{name}: {value!r} is not a number")
    try:
        rounded = float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"{name}: {value!r} is not a number") from None
    if exact(value) != rounded and rounded == rounded:
        raise InputError(f"{name}: no double is {value!r}: round it with float(), if you mean that")
    return rounded


def flag(value: object, name: str) -> bool:
    chosen = exact(value)
    if not isinstance(chosen, bool):
        raise InputError(f"{name}: {value!r} is neither True nor False")
    return chosen


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
    return Query(_width(tolerance, "tolerance"), _choice(relative_to, "relative_to", UNITS), count(threads, "threads"),
                 INFINITY if time_limit is None else _seconds(time_limit), _matrix(pose, "pose"),
                 _matrix(target_pose, "target_pose"), _width(share_tolerance, "share_tolerance"),
                 bool(_choice(weigh, "weigh", WEIGHTS)))


def _width(value: object, name: str) -> float:
    width = number(value, name)
    if not 0 < width < INFINITY:
        raise InputError(f"{name}: {value!r} is not the width of an interval: give a finite number above 0")
    return width


def _seconds(value: object) -> float:
    seconds = number(value, "time_limit")
    if not seconds >= 0:
        raise InputError(f"time_limit: {value!r} is not a time: give seconds of at least 0, or None for no limit")
    return seconds


def pair_of(source: Shape, target: Shape, solver: str | None, options: Mapping[str, object] | None, threads: int,
            pose: Pose | None, target_pose: Pose | None) -> Pair:
    moves = (pose is not None) + 2 * (target_pose is not None)
    if solver is not None and (not isinstance(solver, str) or "\0" in solver):
        raise InputError(f"solver: {solver!r} is not a name: see solvers()")
    if options is not None and not hasattr(options, "items"):
        raise InputError(f"options: {options!r} is not a mapping: give the parameters of the solver by name, as a dict")
    texts = [f"{name}={_text(value)}" for name, value in options.items()] if options else []
    try:
        return Pair(source._shape, target._shape, solver or "", texts, threads, moves)
    except InputError as error:
        raise error.without("plan: ", ": name another solver, or NULL", ": name another solver, or None") from None


def _text(value: object) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)
