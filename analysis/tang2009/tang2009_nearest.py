"""Compares the search for the nearest shape (`search = "nearest"`) with the full matrix of
tang2009_similarity: the answer should be the same, with less work.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

import matplotlib.pyplot as plt

from analysis.shared import claims, numerals, scales, style, tables
from analysis.shared.cells import MEASURES
from analysis.shared.load import load
from analysis.shared.notes import machine_line
from analysis.shared.report import NO_TIMES, Report
from analysis.shared.results import ResultError, Results
from analysis.shared.estimates import NO_DATA, Estimate, exact
from analysis.shared.verdicts import Verdict, all_of, everywhere
from analysis.tang2009 import tang2009_similarity
from analysis.tang2009.tang2009_similarity import SUFFIX

RESULTS_OF: Final = "tang2009_nearest", "tang2009_similarity"
WORK: Final = "distances, bounds and nodes"


@dataclass(frozen=True)
class Answers:
    """The rows from one shape to all others, by the other's name."""

    results: Results
    rows: dict[str, int]

    def failed(self) -> list[str]:
        return [
            f"{target} {self.results.cases.status[row]}"
            for target, row in self.rows.items()
            if self.results.cases.status[row] != "ok"
        ]

    def cut_off(self) -> int:
        return sum(self.results.cases.answer[row] == "h > cutoff" for row in self.rows.values())

    def nearest(self) -> str:
        """Returns the shape with the least upper bound, by which the search decides; empty if no
        row has bounds."""
        upper = {
            target: float(self.results.cases.upper[row])
            for target, row in self.rows.items()
            if self.results.is_bounded(row)
        }
        return min(upper, key=lambda target: upper[target], default="")

    def percent(self, target: str) -> float:
        """Returns H (the middle of its interval) in percent of the diagonal."""
        cases, row = self.results.cases, self.rows[target]
        return 50 * float(cases.lower[row] + cases.upper[row]) / float(cases.source_diagonal[row])

    def counted(self, names: Sequence[str]) -> int:
        counters = self.results.cases.counters
        return sum(
            int(counters[name][row])
            for name in names
            if name in counters
            for row in self.rows.values()
        )


@dataclass(frozen=True)
class Search:
    """One shape and one solver: the rows of the search, and of the matrix for the same pairs."""

    name: str
    answers: Answers
    matrix: Answers

    @property
    def comparable(self) -> bool:
        return (
            self.answers.rows.keys() == self.matrix.rows.keys()
            and not self.answers.failed()
            and not self.matrix.failed()
        )

    def saving(self, measure: str) -> Estimate:
        searched = self.answers.counted(MEASURES[measure])
        return (
            exact(self.matrix.counted(MEASURES[measure]) / searched)
            if self.comparable and searched
            else NO_DATA
        )

    @property
    def same(self) -> bool | None:
        """True if the matrix has the same nearest shape; None if answers are missing, or its
        intervals do not decide."""
        if not self.comparable:
            return None
        nearest, best, cases = (
            self.answers.nearest(),
            self.matrix.nearest(),
            self.matrix.results.cases,
        )
        if nearest == best:
            return True
        return (
            False
            if cases.lower[self.matrix.rows[nearest]] > cases.upper[self.matrix.rows[best]]
            else None
        )


def matrix_beside(results: Results) -> tuple[Results | None, str]:
    """Loads the result of the matrix in the same folder and profile. If there is none, returns None
    and the reason."""
    try:
        return (
            load(results.path.parent / f"{RESULTS_OF[1]}.h5", str(results.meta.get("profile", ""))),
            "",
        )
    except ResultError as problem:
        return None, str(problem)


def question(results: Results, row: int) -> tuple[object, ...]:
    """Returns a key that is equal for two rows if they asked for the same distance with the same
    solver and options."""
    cases, models = results.cases, results.models
    hashes = dict(zip(models.name, models.sha256))
    return (
        cases.solver[row],
        cases.options[row],
        cases.source[row],
        cases.target[row],
        hashes.get(cases.source[row]),
        hashes.get(cases.target[row]),
        cases.quantity[row],
        cases.tolerance[row],
        cases.tolerance_of[row],
        cases.floor[row],
        cases.budget[row],
        cases.threads[row],
        cases.build[row],
    )


def searches(results: Results, matrix: Results | None, label: str) -> list[Search]:
    cases = results.cases
    matrix_rows = {question(matrix, row): row for row in range(len(matrix.cases))} if matrix else {}
    by_name: dict[str, Search] = {}
    for row in (int(row) for row in results.rows(label=label)):
        name, target = (
            str(model).removesuffix(SUFFIX) for model in (cases.source[row], cases.target[row])
        )
        search = by_name.setdefault(
            name, Search(name, Answers(results, {}), Answers(matrix or results, {}))
        )
        search.answers.rows[target] = row
        if (matrix_row := matrix_rows.get(question(results, row))) is not None:
            search.matrix.rows[target] = matrix_row
    return list(by_name.values())


def verdicts(title: str, label: str, group: Sequence[Search]) -> list[Verdict]:
    told = [search.same for search in group if search.same is not None]
    same, claim = (
        claims.of("hausbench", name, title, label=label)
        for name in ("nearest_found", "nearest_work")
    )
    work = everywhere(claim, [search.saving(WORK) for search in group], "shapes")
    by_measure = {}
    for measure in MEASURES:
        if measure != WORK:
            savings = [search.saving(measure) for search in group]
            by_measure[measure] = everywhere(claim, savings, "shapes")
    differing = told.count(False)
    return [all_of(same, differing, len(told), len(group), "shapes"), work.with_counts(by_measure)]


def total(group: Sequence[Search], measure: str) -> tuple[int, int]:
    """Returns the total work of the matrix and of the search, over the shapes with both."""
    compared = [search for search in group if search.saving(measure).n]
    whole = sum(search.matrix.counted(MEASURES[measure]) for search in compared)
    part = sum(search.answers.counted(MEASURES[measure]) for search in compared)
    return whole, part


def cells_of(search: Search) -> list[str]:
    nearest = search.answers.nearest()
    failed = search.answers.failed()
    cells = (
        [nearest, numerals.number(search.answers.percent(nearest))]
        if nearest
        else [numerals.NOTHING] * 2
    )
    cells += [
        {True: "yes", False: "no", None: numerals.NOTHING}[search.same],
        f"{search.answers.cut_off()} of {len(search.answers.rows)}"
        + (f", {len(failed)} failed" if failed else ""),
    ]
    for measure in MEASURES:
        comparable = bool(search.saving(measure).n)
        cells += [
            f"{search.matrix.counted(MEASURES[measure]):,}" if comparable else numerals.NOTHING,
            f"{search.answers.counted(MEASURES[measure]):,}",
            numerals.estimate(search.saving(measure)),
        ]
    return cells


def make(results: Results) -> Report:
    matrix, missing = matrix_beside(results)
    table = tables.Table(
        "The nearest of all shapes, found by a search: each target's cutoff is the least upper bound so far. Counted work against the full "
        "matrix.",
        [
            "",
            "shape",
            "nearest",
            "H, %",
            "as in the matrix",
            "cut off",
            *[cell for measure in MEASURES for cell in (f"{measure}, matrix", "search", "ratio")],
        ],
        left=3,
    )
    records, every, judged = list[tables.Record](), dict[str, list[Search]](), list[Verdict]()
    for solver, label in style.order(zip(results.cases.solver, results.cases.label)):
        group = every[style.title(solver, label)] = searches(results, matrix, label)
        judged += verdicts(style.title(solver, label), label, group)
        table.rules.add(len(table.rows))
        for i, search in enumerate(group):
            table.rows.append(
                [style.title(solver, label) if i == 0 else "", search.name, *cells_of(search)]
            )
            nearest = search.answers.nearest()
            records.append(
                {
                    "label": label,
                    "source": search.name,
                    "nearest": nearest,
                    "percent": search.answers.percent(nearest) if nearest else float("nan"),
                    "same": search.same,
                    "cut_off": search.answers.cut_off(),
                    "targets": len(search.answers.rows),
                    "failed": "; ".join(search.answers.failed()),
                    **{
                        f"{name}_{side}": answers.counted([name])
                        for name in results.cases.counters
                        for side, answers in (("search", search.answers), ("matrix", search.matrix))
                        if side == "search" or search.comparable
                    },
                }
            )
        same = sum(search.same is True for search in group)
        cut_off = sum(search.answers.cut_off() for search in group)
        targets = sum(len(search.answers.rows) for search in group)
        sums = []
        for measure in MEASURES:
            whole, part = total(group, measure)
            ratio = numerals.number(whole / part if part else float("nan"))
            sums += [f"{whole:,}", f"{part:,}", ratio]
        table.rows.append(
            [
                "",
                "all shapes",
                *[numerals.NOTHING] * 2,
                f"{same} of {len(group)}",
                f"{cut_off} of {targets}",
                *sums,
            ]
        )
    table.verdicts = judged
    table.notes = [
        "Cut off: the lower bound is above the least upper bound so far. The diagonal is not counted, in the matrix or in the search. Shapes "
        "with an answer missing in either have no ratio and are left out of the sums. The first target of each shape has no cutoff.",
        *([f"No matrix to compare with: {missing}."] if missing else []),
        f"Here: {machine_line(results)}.",
    ]
    return Report(lambda: draw(every), table, records, clock=NO_TIMES)


def draw(every: dict[str, list[Search]]) -> Any:
    """Draws a line per shape, from the work of the search to the work of the matrix."""
    names = list(dict.fromkeys(search.name for group in every.values() for search in group))
    figure, axes = plt.subplots(
        1,
        len(every),
        figsize=(style.DOUBLE_COLUMN, 0.17 * len(names) + 1.2),
        sharey=True,
        squeeze=False,
    )
    place = {name: i for i, name in enumerate(names)}
    for ax, (title, group) in zip(axes[0], every.items()):
        counted = [
            (
                place[search.name],
                search.answers.counted(MEASURES[WORK]),
                search.matrix.counted(MEASURES[WORK]),
            )
            for search in group
            if search.saving(WORK).n
        ]
        places = [row[0] for row in counted]
        parts = [row[1] for row in counted]
        wholes = [row[2] for row in counted]
        ax.hlines(places, parts, wholes, color="0.7", linewidth=1)
        for name, counts, fill in (("search", parts, "full"), ("full matrix", wholes, "none")):
            ax.plot(counts, places, "o", markersize=3.5, color="black", fillstyle=fill, label=name)
        ax.set(title=title, xscale="log", xlabel=f"number of {WORK}")
        scales.log_ticks(ax.xaxis)
    axes[0][0].set_yticks(range(len(names)), names, fontsize=6.5)
    axes[0][0].invert_yaxis()
    axes[0][-1].legend()
    return figure
