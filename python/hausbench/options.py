"""Keyword arguments that the questions share, checked and turned into the library's."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

from hausbench._core import Pair, Query
from hausbench.arguments import choice, count, number
from hausbench.errors import InputError
from hausbench.interval import Interval

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    from hausbench.shapes import Shape
    from hausbench.typing import Pose

UNITS = {"diagonal": 0, "length": 1, "lower": 2}
WEIGHTS = {"area": False, "vertex": True}
INFINITY = float("inf")


def matrix_of(pose: Pose | None, name: str) -> npt.NDArray[np.float64] | None:
    if pose is None:
        return None
    from hausbench import arrays

    return arrays.pose(_in_file(pose, name) if isinstance(pose, (str, os.PathLike)) else pose, name)


LONGEST = 1 << 16  # bytes of a file of 16 numbers and comments
DECIMAL = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", re.ASCII)


def _in_file(path: str | os.PathLike[str], name: str) -> list[list[float]]:
    """Reads a matrix (4, 4) from a text file: 16 numbers, row by row, between blanks or commas; a #
    begins a comment."""
    place = f"{name}: {os.fspath(path)}"
    try:
        with open(path, encoding="utf-8", errors="replace") as file:
            text = file.read(LONGEST)
    except (OSError, ValueError) as error:
        raise InputError(
            f"{place}: cannot be read ({getattr(error, 'strerror', None) or error}): give a matrix (4, 4), or a text "
            "file of one"
        ) from None
    words = re.sub(r"#.*", "", text).replace(",", " ").split()
    wrong = next((word for word in words if not DECIMAL.fullmatch(word)), None)
    if wrong is not None:
        raise InputError(
            f"{place}: '{wrong[:40]}' is not a number: give the 16 numbers of a 4 x 4 matrix, row by row"
        )
    if len(words) != 16:
        raise InputError(
            f"{place}: has {len(words)} numbers: give the 16 numbers of a 4 x 4 matrix, row by row"
        )
    numbers = [float(word) for word in words]
    return [numbers[i : i + 4] for i in range(0, 16, 4)]


def query_of(
    tolerance: float,
    relative_to: str,
    threads: int,
    time_limit: float | None,
    pose: Pose | None,
    target_pose: Pose | None,
    share_tolerance: float = 1e-3,
    weigh: str = "area",
) -> Query:
    return Query(
        _width(tolerance, "tolerance"),
        choice(relative_to, "relative_to", UNITS),
        count(threads, "threads"),
        INFINITY if time_limit is None else _seconds(time_limit),
        matrix_of(pose, "pose"),
        matrix_of(target_pose, "target_pose"),
        _width(share_tolerance, "share_tolerance"),
        bool(choice(weigh, "weigh", WEIGHTS)),
    )


def _width(value: object, name: str) -> float:
    width = number(value, name)
    if not 0 < width < INFINITY:
        raise InputError(
            f"{name}: {value!r} is not the width of an interval: give a finite number above 0"
        )
    return width


def _seconds(value: object) -> float:
    seconds = number(value, "time_limit")
    if not seconds >= 0:
        raise InputError(
            f"time_limit: {value!r} is not a time: give seconds of at least 0, or None for no limit"
        )
    return seconds


def progress_of(
    progress: Callable[..., object] | None, names: list[str] | None = None
) -> Callable[[list[tuple[float, float]]], object] | None:
    """Returns a function that passes bounds on to the user's function: as a dict by these names, or
    as one Interval."""
    if progress is None:
        return None
    show = progress
    if not callable(show):
        raise InputError(
            f"progress: {progress!r} cannot be called: give a function of one argument, or None"
        )

    def passed_on(bounds: list[tuple[float, float]]) -> object:
        intervals = [Interval(*ends) for ends in bounds]
        return show(intervals[0] if names is None else dict(zip(names, intervals)))

    return passed_on


def pair_of(
    source: Shape,
    target: Shape,
    solver: str | None,
    options: Mapping[str, object] | None,
    threads: int,
    pose: Pose | None,
    target_pose: Pose | None,
) -> Pair:
    moves = (pose is not None) + 2 * (target_pose is not None)
    if solver is not None and (not isinstance(solver, str) or "\0" in solver):
        raise InputError(f"solver: {solver!r} is not a name: see solvers()")
    if options is not None and not hasattr(options, "items"):
        raise InputError(
            f"options: {options!r} is not a mapping: give the parameters of the solver by name, as a dict"
        )
    texts = [f"{name}={_text(value)}" for name, value in options.items()] if options else []
    try:
        return Pair(source._shape, target._shape, solver or "", texts, threads, moves)
    except InputError as error:
        raise error.without(
            "plan: ", ": name another solver, or NULL", ": name another solver, or None"
        ) from None


def _text(value: object) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)
