"""Which solver to take: the fastest certified one by kind of shape, distance, size and tolerance, from the times of this run."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import scipy.stats

from analysis import which_solver
from analysis.shared import tables
from analysis.shared.results import Results
from analysis.which_solver import DOMAINS, FINEST, Cell

NEAR, APART, SAME = "nearer than 1 % of A's diagonal", "1 % of A's diagonal or more", "the same shape"
REGIMES: Final = (SAME, NEAR, APART)
SIZES: Final = ((10_000, "under 10K"), (100_000, "10K to 100K"), (float("inf"), "100K or more"))
NEAR_SHARE: Final = 0.01


@dataclass(frozen=True)
class Best:
    """The solver that wins most scenes of a group."""

    solver: str
    wins: int
    scenes: int
    ratio: float  # time of the next best / its time: geometric mean over its wins; NaN: it ran alone, or is not ahead of all others
    separated: int  # the number of its wins that are separated from all others
    names: Sequence[str]

    @property
    def text(self) -> str:
        return f"{self.solver} {tables.number(self.ratio, 2)}×" if self.ratio == self.ratio else self.solver


@dataclass(frozen=True)
class Matrix:
    tolerances: Sequence[str]
    rows: Sequence[tuple[str, str, str, Sequence[Best | None]]]  # kind, distance, size, and a cell for each tolerance


def regime(results: Results, scene: str) -> str:
    """Returns how far apart the shapes of a scene are."""
    share = results.share(results.rows(scene=scene)[0])
    return SAME if share == 0 else NEAR if share < NEAR_SHARE else APART


def size(results: Results, scene: str) -> str:
    """Returns the class of the larger of both shapes."""
    row = results.rows(scene=scene)[0]
    larger = max(int(results.cases.source_elements[row]), int(results.cases.target_elements[row]))
    return next(name for least_above, name in SIZES if larger < least_above)


def best(cells: Sequence[Cell]) -> Best:
    title, wins = Counter(one.title for one in cells).most_common(1)[0]
    own = [one for one in cells if one.title == title]
    ratios = [one.ratio.value for one in own if one.ratio is not None and one.ratio.n]
    mean = float(scipy.stats.gmean(ratios)) if ratios else float("nan")
    return Best(title, wins, len(cells), mean, sum(one.separated for one in own), [f"{one.stem}: {one.scene}" for one in cells])


def matrix(results: dict[str, Results]) -> Matrix:
    """Groups the cells of analysis.which_solver; a group that no experiment measured is missing."""
    groups: dict[tuple[str, str, str, float], list[Cell]] = {}
    for stem in which_solver.STEMS:
        if stem in results:
            for one in which_solver.cells_of(results[stem]):
                key = (one.domain, regime(results[stem], one.scene), size(results[stem], one.scene), one.tolerance)
                groups.setdefault(key, []).append(one)
    tolerances = sorted({key[3] for key in groups}, reverse=True)
    wanted = [(domain, near, name) for domain in DOMAINS for near in REGIMES for _, name in SIZES]
    rows = [(DOMAINS[domain], near, name, [best(groups[domain, near, name, x]) if (domain, near, name, x) in groups else None for x in tolerances])
            for domain, near, name in wanted if any((domain, near, name, x) in groups for x in tolerances)]
    return Matrix(["finest" if x == FINEST else f"{x:g}" for x in tolerances], rows)
