"""The questions about two shapes. A is the source and B the target.

A and B are each one of
    (vertices, faces)   a mesh: a tuple of arrays (n, 3) and (m, 3)
    an array (n, 3)     a point set
    a path              a str or os.PathLike; for options, such as the unit, give the Shape that `read` returns
    a Shape             which is not copied, and keeps the structures that are built over it
    an object           with .vertices and .faces (trimesh), .vertices and .triangles or .points (open3d, also with tensors), or
                        .entities (paths of trimesh); a line set, vtkPolyData or meshio mesh; what
                        skimage.measure.marching_cubes returns
Arrays may have any strides. Coordinates may be integers and floats up to float64, as long as none changes as a float64; faces
must be integers. Everything else raises InputError, and so do two shapes that state different units or axes (see `read`).

Keyword arguments of all questions:
    tolerance     the largest width of the interval that you accept, above 0, in units of `relative_to`:
    relative_to   "diagonal": of A's bounding box (of both, if A is a point); "length": the tolerance is a length; "lower": of the
                  lower bound, which a distance of 0 never reaches (its status is "precision", and it takes long)
    threads       most threads to use; the answer does not depend on them
    time_limit    seconds for solving; the interval is then wider, and still holds
    solver        see `solvers()`; None: `cover` if a mesh is among the shapes, else `scan`
    options       parameters of the solver, by name
    pose          moves A before measuring: a matrix (4, 4), a rotation (3, 3), a tuple (rotation, translation), or the path of a
                  text file with the 16 numbers of a matrix, row by row. Scaling, shearing and mirroring are allowed, so a matrix
                  is not checked to be a rotation
    target_pose   moves B
    progress      a function that gets the Interval so far, which holds, about every tenth of a second; for `distribution` a dict
                  of Intervals by the name of the statistic. What it raises ends the question
Ctrl-C raises KeyboardInterrupt in the main thread, but a file is read and a proof checked to its end first. Other Python threads
run while a question is answered.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING

from hausbench import _core
from hausbench.answers import Answer, Field, Verdict
from hausbench.arguments import flag, number
from hausbench.errors import InputError
from hausbench.interval import Interval, Undecided
from hausbench.options import INFINITY, matrix_of, pair_of, progress_of, query_of
from hausbench.shape_like import shape_of
from hausbench.shapes import path_of

if TYPE_CHECKING:
    from hausbench._core import Chain, Pair, Query
    from hausbench.shapes import Shape
    from hausbench.statistics import Distribution
    from hausbench.typing import Pose, Progress, ShapeLike


def directed(
    A: ShapeLike,
    B: ShapeLike,
    *,
    tolerance: float = 1e-6,
    relative_to: str = "diagonal",
    threads: int = 1,
    time_limit: float | None = None,
    solver: str | None = None,
    options: Mapping[str, object] | None = None,
    pose: Pose | None = None,
    target_pose: Pose | None = None,
    progress: Progress | None = None,
) -> Answer:
    """Bounds h(A,B), the largest distance of a point of A to B, in the unit of the input.

    h(A,B) ignores parts of B that A lacks: see `symmetric`. The module hausbench.calls describes
    the arguments.
    """
    query = query_of(tolerance, relative_to, threads, time_limit, pose, target_pose)
    pair = pair_of(shape_of(A, "A"), shape_of(B, "B"), solver, options, threads, pose, target_pose)
    return Answer("h(A,B)", pair.directed(query, None, progress_of(progress)))


def symmetric(
    A: ShapeLike,
    B: ShapeLike,
    *,
    tolerance: float = 1e-6,
    relative_to: str = "diagonal",
    threads: int = 1,
    time_limit: float | None = None,
    solver: str | None = None,
    options: Mapping[str, object] | None = None,
    pose: Pose | None = None,
    target_pose: Pose | None = None,
    progress: Progress | None = None,
) -> Answer:
    """Bounds H(A,B), the larger of h(A,B) and h(B,A). Arguments as in `directed`."""
    query = query_of(tolerance, relative_to, threads, time_limit, pose, target_pose)
    pair = pair_of(shape_of(A, "A"), shape_of(B, "B"), solver, options, threads, pose, target_pose)
    return Answer("H(A,B)", pair.symmetric(query, None, progress_of(progress)))


def within(
    A: ShapeLike,
    B: ShapeLike,
    d: float,
    *,
    symmetric: bool = False,
    threads: int = 1,
    time_limit: float | None = None,
    solver: str | None = None,
    options: Mapping[str, object] | None = None,
    pose: Pose | None = None,
    target_pose: Pose | None = None,
    progress: Progress | None = None,
) -> bool:
    """Returns whether every point of A is at most d from B: h(A,B) <= d. With `symmetric`, whether
    also every point of B is at most d from A: H(A,B) <= d. Often much faster than `directed`.

    `d` is a length. Raises Undecided if neither is proven: the distance equals d up to rounding, or
    time ran out. Without a time limit that is after 10 seconds. Between points, share_within(d) of
    `distribution` decides whole numbers exactly. d = 0 is hardly ever decided between meshes: ask
    for a small length.
    """
    query = query_of(1e-6, "diagonal", threads, time_limit, pose, target_pose)
    pair = pair_of(shape_of(A, "A"), shape_of(B, "B"), solver, options, threads, pose, target_pose)
    return decide(pair, symmetric, d, query, None, progress)


def decide(
    pair: Pair,
    symmetric: bool,
    d: float,
    query: Query,
    chain: Chain | None,
    progress: Progress | None,
) -> bool:
    length = number(d, "d")
    if not 0 <= length < INFINITY:
        raise InputError(f"d: {d!r} is not a length: give a finite number of at least 0")
    both_ways = flag(symmetric, "symmetric")
    name = "H(A,B)" if both_ways else "h(A,B)"
    answer = Answer(name, pair.within(both_ways, length, query, chain, progress_of(progress)))
    if answer.status == "within":
        return True
    if answer.status == "above":
        return False
    remedy = (
        "allow more time"
        if answer.status == "time_limit"
        else "ask about a length a little larger or smaller"
    )
    raise Undecided(
        f"{name} is in {answer.interval}, so {name} <= {d!r} is undecided ({answer.status}): {remedy}",
        answer.interval,
    )


def distribution(
    A: ShapeLike,
    B: ShapeLike,
    *,
    statistics: str | Iterable[str] | None = None,
    quantiles: float | Iterable[float] = (),
    within: float | Iterable[float] = (),
    over: str = "source",
    weigh: str = "area",
    tolerance: float = 1e-6,
    share_tolerance: float = 1e-3,
    relative_to: str = "diagonal",
    threads: int = 1,
    time_limit: float | None = None,
    pose: Pose | None = None,
    target_pose: Pose | None = None,
    progress: Callable[[dict[str, Interval]], object] | None = None,
) -> Distribution:
    """Bounds statistics of the distance of the points of A to B, each by an Interval.

    Computes at once, in one run, what you list: `statistics` (by name, such as "mean", "median" or
    "quantile 0.95", see docs/conventions.md), `quantiles` (levels above 0, at most 1) and the
    shares of A `within` lengths; mean and RMS if you list nothing. The result computes others when you ask for them,
    each in a run of its own, and keeps them. A mean takes much longer than h(A,B), because it
    depends on all of A: for a first look use tolerance=1e-3 and relative_to="lower".

    over             "source": distances of A to B; "target": of B to A; "larger", "mean_of_both", "harmonic_mean" or
                     "pooled": of both (docs/conventions.md)
    weigh            "area": parts of a mesh count by area, line segments alone by length; "vertex": each vertex counts once
    share_tolerance  the largest width of a share
    """
    from hausbench.statistics import Distribution

    query = query_of(
        tolerance, relative_to, threads, time_limit, pose, target_pose, share_tolerance, weigh
    )
    pair = pair_of(shape_of(A, "A"), shape_of(B, "B"), None, None, threads, pose, target_pose)
    return Distribution(pair, query, over, statistics, quantiles, within, progress)


def field(
    A: ShapeLike,
    B: ShapeLike,
    *,
    threads: int = 1,
    time_limit: float | None = None,
    pose: Pose | None = None,
    target_pose: Pose | None = None,
) -> Field:
    """Bounds the distance to B of each vertex of A, up to rounding, with the row of B nearest to
    it.

    Vertices alone say little about the inside of triangles: for the maximum over a mesh see
    `directed`. If the time limit ends the call early, the other vertices have the bounds 0 and
    infinity, and the row -1.
    """
    query = query_of(1e-6, "diagonal", threads, time_limit, pose, target_pose)
    source = shape_of(A, "A")
    return field_of(
        pair_of(source, shape_of(B, "B"), None, None, threads, pose, target_pose), query, source
    )


def field_of(pair: Pair, query: Query, source: Shape) -> Field:
    bounds, nearest = pair.field(query, source.vertex_count)
    return Field(bounds[:, 0], bounds[:, 1], nearest)


def certify(
    A: ShapeLike,
    B: ShapeLike,
    path: str | os.PathLike[str],
    *,
    symmetric: bool = False,
    tolerance: float = 1e-6,
    relative_to: str = "diagonal",
    threads: int = 1,
    time_limit: float | None = None,
    solver: str | None = None,
    options: Mapping[str, object] | None = None,
    pose: Pose | None = None,
    target_pose: Pose | None = None,
) -> Answer:
    """Bounds h(A,B), or H(A,B) if `symmetric`, and writes a proof of the upper bound to a file, see
    `verify`.

    The solver is `cover` unless you name another one that writes proofs. Raises InputError, and
    writes nothing, if there is no proof, or if a pose does not keep distances. After a time limit
    the proof is of a larger bound.
    """
    query = query_of(tolerance, relative_to, threads, time_limit, pose, target_pose)
    pair = pair_of(
        shape_of(A, "A"), shape_of(B, "B"), solver or "cover", options, threads, pose, target_pose
    )
    try:
        return Answer(
            "H(A,B)" if symmetric else "h(A,B)",
            pair.certify(flag(symmetric, "symmetric"), query, path_of(path)),
        )
    except InputError as error:
        raise error.without(
            "pair: ", ": prepare the pair with `cover`", ": leave solver out"
        ) from None


def verify(
    path: str | os.PathLike[str],
    A: ShapeLike,
    B: ShapeLike,
    *,
    pose: Pose | None = None,
    target_pose: Pose | None = None,
) -> Verdict:
    """Checks a proof written by `certify` for A and B at these poses, by code that shares no bound
    with the solvers.

    The verdict is true in an `if` exactly if the proof holds and is about these poses; its `pose`
    and `target_pose` are the poses of the file. Then its `proven` is at most the upper bound in its
    `interval`. Raises InputError if the file is damaged, or is about other shapes (A and B must
    have the same coordinates and indices, bit for bit).
    """
    accepted, lower, upper, proven, text, *poses = _core.verify(
        path_of(path),
        shape_of(A, "A")._shape,
        shape_of(B, "B")._shape,
        matrix_of(pose, "pose"),
        matrix_of(target_pose, "target_pose"),
    )
    return Verdict(accepted, Interval(lower, upper), proven, text, *poses)
