"""Many questions about one target."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, NoReturn
from weakref import WeakKeyDictionary

from hausbench._core import Chain, Pair
from hausbench.answers import Answer, Field
from hausbench.calls import decide, field_of
from hausbench.options import pair_of, progress_of, query_of
from hausbench.shape_like import shape_of
from hausbench.shapes import Shape

if TYPE_CHECKING:
    from hausbench.interval import Interval
    from hausbench.statistics import Distribution
    from hausbench.typing import Pose, Progress, ShapeLike


class Prepared:
    """A target B, made by `hausbench.prepare`, with the structures that questions about it have
    built so far.

    If A is a Shape, its pair with B is kept too, as long as A lives, and each answer starts from
    what the one before found. That makes answers for nearby poses faster and changes no bound's
    truth. Other A, such as arrays, may change between calls, so they are copied each time: write `A
    = hausbench.Shape(vertices, faces)` before a loop. One Prepared may be used by several threads;
    only one of them at a time starts from earlier answers.
    """

    def __init__(
        self, target: Shape, solver: str | None, options: Mapping[str, object] | None
    ) -> None:
        self._target, self._solver, self._options = target, solver, dict(options or {})
        self._kept: WeakKeyDictionary[Shape, tuple[Pair, Chain]] = WeakKeyDictionary()

    def __reduce__(self) -> NoReturn:
        raise TypeError("a Prepared cannot be pickled: pickle its target, a Shape")

    def __repr__(self) -> str:
        return f"<hausbench.Prepared: {self._target!r}>"

    @property
    def target(self) -> Shape:
        return self._target

    def _pair(
        self, A: ShapeLike, threads: int, pose: Pose | None, target_pose: Pose | None
    ) -> tuple[Pair, Chain | None]:
        if not isinstance(A, Shape):
            return self._new(shape_of(A, "A"), threads, pose, target_pose), None
        kept = self._kept.get(A)
        if kept is None:
            pair = self._new(A, threads, pose, target_pose)
            kept = self._kept.setdefault(A, (pair, Chain(pair)))
        return kept

    def _new(
        self, source: Shape, threads: int, pose: Pose | None, target_pose: Pose | None
    ) -> Pair:
        return pair_of(
            source, self._target, self._solver, self._options, threads, pose, target_pose
        )

    def directed(
        self,
        A: ShapeLike,
        *,
        tolerance: float = 1e-6,
        relative_to: str = "diagonal",
        threads: int = 1,
        time_limit: float | None = None,
        pose: Pose | None = None,
        target_pose: Pose | None = None,
        progress: Progress | None = None,
    ) -> Answer:
        """Bounds h(A,B), as hausbench.directed."""
        query = query_of(tolerance, relative_to, threads, time_limit, pose, target_pose)
        pair, chain = self._pair(A, threads, pose, target_pose)
        return Answer("h(A,B)", pair.directed(query, chain, progress_of(progress)))

    def symmetric(
        self,
        A: ShapeLike,
        *,
        tolerance: float = 1e-6,
        relative_to: str = "diagonal",
        threads: int = 1,
        time_limit: float | None = None,
        pose: Pose | None = None,
        target_pose: Pose | None = None,
        progress: Progress | None = None,
    ) -> Answer:
        """Bounds H(A,B), as hausbench.symmetric."""
        query = query_of(tolerance, relative_to, threads, time_limit, pose, target_pose)
        pair, chain = self._pair(A, threads, pose, target_pose)
        return Answer("H(A,B)", pair.symmetric(query, chain, progress_of(progress)))

    def within(
        self,
        A: ShapeLike,
        d: float,
        *,
        symmetric: bool = False,
        threads: int = 1,
        time_limit: float | None = None,
        pose: Pose | None = None,
        target_pose: Pose | None = None,
        progress: Progress | None = None,
    ) -> bool:
        """Returns whether h(A,B) <= d, or H(A,B) <= d, or raises Undecided, as hausbench.within."""
        query = query_of(1e-6, "diagonal", threads, time_limit, pose, target_pose)
        pair, chain = self._pair(A, threads, pose, target_pose)
        return decide(pair, symmetric, d, query, chain, progress)

    def distribution(
        self,
        A: ShapeLike,
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
        """Bounds statistics of the distance of the points of A to B, as hausbench.distribution."""
        from hausbench.statistics import Distribution

        query = query_of(
            tolerance, relative_to, threads, time_limit, pose, target_pose, share_tolerance, weigh
        )
        return Distribution(
            self._pair(A, threads, pose, target_pose)[0],
            query,
            over,
            statistics,
            quantiles,
            within,
            progress,
        )

    def field(
        self,
        A: ShapeLike,
        *,
        threads: int = 1,
        time_limit: float | None = None,
        pose: Pose | None = None,
        target_pose: Pose | None = None,
    ) -> Field:
        """Bounds the distance to B of each vertex of A, as hausbench.field."""
        query = query_of(1e-6, "diagonal", threads, time_limit, pose, target_pose)
        source = shape_of(A, "A")
        return field_of(self._pair(source, threads, pose, target_pose)[0], query, source)


def prepare(
    B: ShapeLike, *, solver: str | None = None, options: Mapping[str, object] | None = None
) -> Prepared:
    """Reads or copies a target for many questions. Its structures are built by the first question
    that needs them.

    prepare(B).directed(A, pose=T) bounds h(A,B) after A moved by T; see Prepared for what is kept
    between calls.
    """
    return Prepared(shape_of(B, "B"), solver, options)
