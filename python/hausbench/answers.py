"""Answers, fields and verdicts, which the functions return."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from hausbench.interval import Interval

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    from hausbench._core import _RawAnswer

# By number of the C interface.
STATUSES = ("converged", "within", "above", "time_limit", "cancelled", "precision", "stalled")


class Witness(NamedTuple):
    """The pair of points that attains the lower bound, up to rounding: source_point on A and
    target_point on B, moved by their poses.

    `direction` is "source_to_target" if source_point is the point of A farthest from B, and
    target_point is nearest to it; "target_to_source", which only the symmetric distance has, if
    target_point is the point of B farthest from A, and source_point is nearest to it. The rows are
    the triangle or point that each lies on.
    """

    source_point: tuple[float, float, float]
    target_point: tuple[float, float, float]
    source_row: int
    target_row: int
    direction: str


class Answer:
    """Bounds of a distance. `interval` contains it whatever the status.

    status           "converged": the interval is as narrow as asked for; otherwise "time_limit", "precision" (doubles
                     are too coarse for the tolerance) or "stalled" (too hard for the solver) says why it is wider
    prepare_seconds  wall time of this call for building structures,
    solve_seconds    and for solving
    """

    __slots__ = ("_quantity", "_raw", "_interval")

    def __init__(self, quantity: str, raw: _RawAnswer) -> None:
        self._quantity = quantity
        self._raw = raw
        self._interval = Interval(raw[1], raw[2])

    @property
    def interval(self) -> Interval:
        """Contains the distance; in the unit of the input."""
        return self._interval

    @property
    def quantity(self) -> str:
        """ "h(A,B)" or "H(A,B)"."""
        return self._quantity

    @property
    def status(self) -> str:
        return STATUSES[self._raw[0]]

    @property
    def witness(self) -> Witness | None:
        """The points that attain the lower bound; None if unknown."""
        raw = self._raw
        if raw[4][0] != raw[4][0]:
            return None
        return Witness(
            raw[4], raw[5], raw[6], raw[7], "target_to_source" if raw[3] else "source_to_target"
        )

    @property
    def prepare_seconds(self) -> float:
        return self._raw[8]

    @property
    def solve_seconds(self) -> float:
        return self._raw[9]

    def __repr__(self) -> str:
        return f"<Answer: {self._quantity} in {self._interval}, {self.status}>"


class Field(NamedTuple):
    """Bounds of the distance to B of each row of A.vertices: arrays of n numbers."""

    lower: npt.NDArray[np.float64]
    upper: npt.NDArray[np.float64]
    nearest: npt.NDArray[np.int64]  # the row (triangle or point) of B nearest to each vertex


class Verdict(NamedTuple):
    """The result of checking a proof. It is true in an `if` exactly if the proof holds."""

    accepted: bool
    interval: Interval  # the answer that the file states
    proven: float  # the upper bound that the proof proves
    text: str  # what was checked, or why the proof is refused
    pose: npt.NDArray[np.float64]  # of A, a matrix (4, 4), as the file states it
    target_pose: npt.NDArray[np.float64]  # of B

    def __bool__(self) -> bool:
        return self.accepted
