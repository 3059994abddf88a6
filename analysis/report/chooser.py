"""Which solver to take: the fastest certified one by kind of shape, distance, size and tolerance,
from the times of this run."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import scipy.stats

from analysis import which_solver
from analysis.shared import numerals
from analysis.shared.results import Results
from analysis.shared.estimates import CONFIDENCE
from analysis.which_solver import DOMAINS, FINEST, Cell

STEMS: Final = (*which_solver.STEMS, "sacht2024_table2", "zhang2017_table3")
NEAR, APART, SAME = (
    "nearer than 1 % of A's diagonal",
    "1 % of A's diagonal or more",
    "the same shape",
)
REGIMES: Final = (SAME, NEAR, APART)
SIZES: Final = ((10_000, "under 10K"), (100_000, "10K to 100K"), (float("inf"), "100K or more"))
NEAR_SHARE: Final = 0.01


@dataclass(frozen=True)
class Win:
    """A solver that is fastest on some scenes of a group."""

    solver: str
    wins: int
    ratio: float  # time of the next best / its time: geometric mean over its wins; NaN: it ran alone, or is not ahead of all others
    least: float  # of these ratios
    most: float
    separated: int  # the number of its wins that are separated from all others
    rounds_suffice: bool  # some win has enough rounds to be separated

    @property
    def factor(self) -> str:
        return f"{numerals.number(self.ratio, 2)}×" if self.ratio == self.ratio else ""

    @property
    def range(self) -> str:
        """The least and the greatest ratio, '1.2× to 4.0×'; empty if they are one."""
        least, most = numerals.number(self.least, 2), numerals.number(self.most, 2)
        return "" if least == most else f"{least}× to {most}×"

    @property
    def doubt(self) -> str:
        """Returns how many wins are separated or, if none is, whether more rounds could help. Empty
        if all are, or without a ratio."""
        if self.separated == self.wins or self.ratio != self.ratio:
            return ""
        return (
            f"{self.separated} of them separated"
            if self.separated
            else "not separated"
            if self.rounds_suffice
            else "too few rounds to tell"
        )


@dataclass(frozen=True)
class Group:
    """The scenes of one kind, distance, size and tolerance."""

    winners: Sequence[Win]  # the one with most wins first
    scenes: Sequence[str]

    @property
    def leader(self) -> Win | None:
        """The solver that wins more than half of the scenes; None: no solver does."""
        return self.winners[0] if 2 * self.winners[0].wins > len(self.scenes) else None


@dataclass(frozen=True)
class Kind:
    """The table of one kind of shape."""

    title: str
    sized: bool  # has a column of sizes
    tolerances: Sequence[str]
    rows: Sequence[
        tuple[str, str, Sequence[Group | None]]
    ]  # distance, size, and a cell for each tolerance


@dataclass(frozen=True)
class Matrix:
    kinds: Sequence[Kind]
    stems: Sequence[str]  # the experiments that were used
    rounds: tuple[int, int]  # the fewest and the most rounds of a comparison


def regime(results: Results, scene: str) -> str:
    """Returns how far apart the shapes of a scene are."""
    share = results.share(results.rows(scene=scene)[0])
    return SAME if share == 0 else NEAR if share < NEAR_SHARE else APART


def size(results: Results, scene: str) -> str:
    """Returns the class of the larger of both shapes."""
    row = results.rows(scene=scene)[0]
    larger = max(int(results.cases.source_elements[row]), int(results.cases.target_elements[row]))
    return next(name for least_above, name in SIZES if larger < least_above)


def group(cells: Sequence[Cell]) -> Group:
    by_wins = Counter(cell.title for cell in cells).most_common()
    winners = []
    for title, _ in by_wins:
        winners.append(win([cell for cell in cells if cell.title == title]))
    return Group(winners, [f"{cell.stem}: {cell.scene}" for cell in cells])


def win(cells: Sequence[Cell]) -> Win:
    ratios = [cell.ratio for cell in cells if cell.ratio is not None and cell.ratio.n]
    values = [ratio.value for ratio in ratios] or [float("nan")]
    separated = sum(cell.separated for cell in cells)
    return Win(
        cells[0].title,
        len(cells),
        float(scipy.stats.gmean(values)),
        min(values),
        max(values),
        separated,
        any(ratio.coverage >= CONFIDENCE for ratio in ratios),
    )


def matrix(results: dict[str, Results]) -> Matrix:
    """Groups the cells of analysis.which_solver; a group that no experiment measured is missing."""
    groups: dict[tuple[str, str, str, float], list[Cell]] = {}
    for stem in STEMS:
        if stem in results:
            for cell in which_solver.cells_of(results[stem]):
                large = size(results[stem], cell.scene) if cell.domain != "surface" else ""
                groups.setdefault(
                    (cell.domain, regime(results[stem], cell.scene), large, cell.tolerance), []
                ).append(cell)
    all_cells = [cell for cells in groups.values() for cell in cells]
    rounds = [cell.ratio.n for cell in all_cells if cell.ratio is not None and cell.ratio.n] or [0]
    kinds = []
    for domain, title in DOMAINS.items():
        of_domain = {key[1:]: cells for key, cells in groups.items() if key[0] == domain}
        table = kind(of_domain, title)
        if table.rows:
            kinds.append(table)
    stems = list(dict.fromkeys(cell.stem for cell in all_cells))
    return Matrix(kinds, stems, (min(rounds), max(rounds)))


def kind(groups: dict[tuple[str, str, float], list[Cell]], title: str) -> Kind:
    tolerances = sorted({tolerance for _, _, tolerance in groups}, reverse=True)
    sizes = [name for _, name in SIZES] + [""]
    rows = []
    for near in REGIMES:
        for large in sizes:
            row = [
                group(groups[near, large, x]) if (near, large, x) in groups else None
                for x in tolerances
            ]
            if any(cell is not None for cell in row):
                rows.append((near, large, row))
    sized = any(large for _, large, _ in rows)
    return Kind(title, sized, ["" if x == FINEST else f"{x:g}" for x in tolerances], rows)
