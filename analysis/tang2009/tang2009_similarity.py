"""Shape similarity, an application in Tang et al. 2009: distance matrix of shapes, nearest shapes
and dendrogram."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

import matplotlib.pyplot as plt
import numpy as np
import scipy.cluster.hierarchy as hierarchy
import scipy.spatial.distance
import scipy.stats

from analysis.shared import claims, numerals, style, tables
from analysis.shared.columns import Floats
from analysis.shared.notes import machine_line
from analysis.shared.report import NO_TIMES, Report
from analysis.shared.results import ResultError, Results
from analysis.shared.verdicts import ERROR, FAILS, HOLDS, OPEN, UNTESTED, Verdict, all_of

SUFFIX: Final = "_centred"
SOLVER: Final = "cover"
# Shapes of similar objects, in our judgement.
FAMILIES: Final = {
    "bunnies": ("bunny_cgal", "bunny_open", "bunny_small", "tang_bunny1"),
    "dragons": ("dragon_res4", "dragon_res3", "chinese_dragon"),
    "chess pieces": ("king", "queen"),
    "fruit": ("orange", "apple"),
    "asteroids": ("asteroid_low", "asteroid_high"),
    "dinosaurs": ("dino", "diplodocus", "triceratops"),
    "bears": ("bear", "bear_bis"),
    "elephants": ("elephant", "refined_elephant"),
    "anchors": ("anchor", "anchor_dense"),
    "cattle": ("cow", "bull"),
    "busts": ("snowden_lo", "snowden_hi"),
    "gears": ("pinion", "gearwheel"),
}


@dataclass(frozen=True)
class Matrix:
    """Row i, column j: the interval of H(shape i, shape j) / diagonal of shape i. NaN: no answer.

    The shapes are scaled to diagonal 1.
    """

    names: list[str]
    lower: Floats
    upper: Floats

    @property
    def middle(self) -> Floats:
        """The distances, averaged over (i, j) and (j, i): the middles of the intervals."""
        whole = 0.25 * (self.lower + self.upper + self.lower.T + self.upper.T)
        np.fill_diagonal(whole, 0.0)
        return np.asarray(whole)

    @property
    def complete(self) -> bool:
        return bool(np.isfinite(self.lower).all() and np.isfinite(self.upper).all())


def matrix_of(results: Results, solver: str) -> Matrix:
    """Returns the distances that `solver` computed; NaN for pairs without bounds."""
    cases = results.cases
    rows = results.rows(solver=solver)
    sources = dict.fromkeys(cases.source[row] for row in rows)
    models = list(sources | dict.fromkeys(cases.target[row] for row in rows))
    index = {model: i for i, model in enumerate(models)}
    lower = np.full((len(models), len(models)), np.nan)
    upper = lower.copy()
    for row in rows:
        if results.is_bounded(row):
            i, j = index[cases.source[row]], index[cases.target[row]]
            lower[i, j], upper[i, j] = float(cases.lower[row]), float(cases.upper[row])
    return Matrix([model.removesuffix(SUFFIX) for model in models], lower, upper)


def family(name: str) -> str:
    return next((title for title, members in FAMILIES.items() if name in members), name)


def nearest(matrix: Matrix) -> list[list[int]]:
    """Returns for each shape the indices of all others, nearest first."""
    orders = []
    for i, row in enumerate(matrix.middle):
        orders.append([int(j) for j in np.argsort(row, kind="stable") if j != i])
    return orders


def verdicts(matrix: Matrix) -> list[Verdict]:
    n = len(matrix.names)
    pairs = [(i, j) for i in range(n) for j in range(i)]
    finite = [
        (i, j) for i, j in pairs if np.isfinite([matrix.upper[i, j], matrix.upper[j, i]]).all()
    ]
    apart = sum(
        matrix.lower[i, j] > matrix.upper[j, i] or matrix.lower[j, i] > matrix.upper[i, j]
        for i, j in finite
    )
    judged = [
        all_of(claims.of("hausbench", "orders_agree"), apart, len(finite), len(pairs), "pairs")
    ]
    low, high = np.fmin(matrix.lower, matrix.lower.T), np.fmax(matrix.upper, matrix.upper.T)
    triples = [(i, j, k) for i, j in pairs for k in range(n) if k not in (i, j)]
    seen = [
        (i, j, k) for i, j, k in triples if np.isfinite([low[i, j], high[i, k], high[k, j]]).all()
    ]
    judged.append(
        all_of(
            claims.of("hausbench", "triangle_inequality"),
            sum(bool(low[i, j] > high[i, k] + high[k, j]) for i, j, k in seen),
            len(seen),
            len(triples),
            "triples",
        )
    )
    return [*judged, retrieval(matrix)]


def retrieval(matrix: Matrix) -> Verdict:
    """Judges the claim that the nearest other shape is usually of the same family, by a sign test.

    Families are the trials, because shapes of a family depend on each other. A family is a success
    if for more than half of its members the nearest shape is another member.
    """
    claim = claims.of("hausbench", "same_family")
    if not matrix.complete or len(matrix.names) < 3:
        return Verdict(claim, UNTESTED, "distances are missing")
    kinds = [family(name) for name in matrix.names]
    hits = [kinds[i] == kinds[others[0]] for i, others in enumerate(nearest(matrix))]
    by_kind: dict[str, list[int]] = {}
    for i, kind in enumerate(kinds):
        by_kind.setdefault(kind, []).append(i)
    groups = [group for group in by_kind.values() if len(group) > 1]
    if not groups:
        return Verdict(claim, UNTESTED, "no families")
    successes = 0
    for group in groups:
        successes += 2 * sum(hits[i] for i in group) > len(group)
    more, fewer = (
        scipy.stats.binomtest(successes, len(groups), alternative=side).pvalue
        for side in ("greater", "less")
    )
    guess = max(len(group) - 1 for group in groups) / (len(kinds) - 1)
    return Verdict(
        claim,
        HOLDS if more <= ERROR else FAILS if fewer <= ERROR else OPEN,
        f"{successes} of {len(groups)} families, {sum(hits)} of {len(hits)} shapes; a guess finds at most {numerals.at_most(guess, 2, times=100)} % of the shapes",
    )


def make(results: Results) -> Report:
    matrix = matrix_of(results, SOLVER)
    if len(matrix.names) < 2:
        raise ResultError(
            f"{results.path}: no rows of '{SOLVER}': measure them with 'make {results.stem}'"
        )
    table = tables.Table(
        "Shapes by their two-sided distance, in percent of the diagonal; all are centred and of one size, none is rotated.",
        ["shape", "family", "nearest", "H", "second", "H", "third", "H", "same family"],
        left=3,
    )
    middle, records = matrix.middle, list[tables.Record]()
    for i, (name, others) in enumerate(zip(matrix.names, nearest(matrix))):
        cells = [
            cell
            for j in others[:3]
            for cell in (matrix.names[j], numerals.number(100 * middle[i, j]))
        ]
        table.rows.append(
            [
                name,
                family(name),
                *cells,
                *[numerals.NOTHING] * (6 - len(cells)),
                "yes" if family(matrix.names[others[0]]) == family(name) else "no",
            ]
        )
        records += [
            {
                "source": name,
                "target": matrix.names[j],
                "lower": float(matrix.lower[i, j]),
                "upper": float(matrix.upper[i, j]),
            }
            for j in range(len(matrix.names))
        ]
    table.verdicts = verdicts(matrix)
    table.notes = [
        f"{len(matrix.names)} shapes, {len(matrix.names)**2} distances, each shape prepared once. Tolerance 1e-3 of the diagonal. Families are "
        "our judgement; shapes are not rotated to fit each other, so two of one family in different orientations are far apart.",
        f"Here: {machine_line(results)}.",
    ]
    return Report(lambda: draw(matrix), table, records, clock=NO_TIMES)


def draw(matrix: Matrix) -> Any:
    """Draws the dendrogram (average linkage) on the left, and the matrix in the same order on the
    right."""
    distances = np.nan_to_num(matrix.middle, nan=float(np.nanmax(matrix.middle)))
    tree = hierarchy.linkage(
        scipy.spatial.distance.squareform(100 * distances, checks=False), "average"
    )
    figure, (left, right) = plt.subplots(
        1, 2, figsize=(style.DOUBLE_COLUMN, 0.17 * len(matrix.names) + 1.6), width_ratios=(1, 1.9)
    )
    drawn = hierarchy.dendrogram(
        tree,
        ax=left,
        orientation="left",
        labels=matrix.names,
        color_threshold=0,
        above_threshold_color="black",
    )
    order: Sequence[int] = drawn["leaves"]
    left.set(xlabel="mean H of the merged groups, %")
    left.tick_params(axis="y", labelsize=6.5)
    left.spines[["left", "right", "top"]].set_visible(False)
    left.grid(False)
    image = right.imshow(
        100 * distances[np.ix_(order, order)],
        origin="lower",
        aspect="auto",
        cmap="viridis_r",
        interpolation="nearest",
    )
    right.set_yticks([])
    right.set_xticks(range(len(order)), [matrix.names[i] for i in order], rotation=90, fontsize=6.5)
    right.grid(False)
    figure.colorbar(image, ax=right, pad=0.02).set_label("H(A, B), % of the diagonal")
    return figure
