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
        known = {
            target: float(self.results.cases.upper[row])
            for target, row in self.rows.items()
            if self.results.is_bounded(row)
        }
        return min(known, key=lambda target: known[target], default="")

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
    found: Answers
    matrix: Answers

    @property
    def comparable(self) -> bool:
        return (
            self.found.rows.keys() == self.matrix.rows.keys()
            and not self.found.failed()
            and not self.matrix.failed()
        )

    def saving(self, what: str) -> Estimate:
        searched = self.found.counted(MEASURES[what])
        return (
            exact(self.matrix.counted(MEASURES[what]) / searched)
            if self.comparable and searched
            else NO_DATA
        )

    @property
    def same(self) -> bool | None:
        """True if the matrix has the same nearest shape; None if answers are missing, or its
        intervals do not decide."""
        if not self.comparable:
            return None
        found, best, cases = self.found.nearest(), self.matrix.nearest(), self.matrix.results.cases
        if found == best:
            return True
        return (
            False
            if cases.lower[self.matrix.rows[found]] > cases.upper[self.matrix.rows[best]]
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


def asked(results: Results, row: int) -> tuple[object, ...]:
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
    known = {asked(matrix, row): row for row in range(len(matrix.cases))} if matrix else {}
    found: dict[str, Search] = {}
    for row in (int(row) for row in results.rows(label=label)):
        name, target = (
            str(model).removesuffix(SUFFIX) for model in (cases.source[row], cases.target[row])
        )
        one = found.setdefault(
            name, Search(name, Answers(results, {}), Answers(matrix or results, {}))
        )
        one.found.rows[target] = row
        if (other := known.get(asked(results, row))) is not None:
            one.matrix.rows[target] = other
    return list(found.values())


def verdicts(title: str, label: str, found: Sequence[Search]) -> list[Verdict]:
    told = [one.same for one in found if one.same is not None]
    same, claim = (
        claims.of("hausbench", name, title, label=label)
        for name in ("nearest_found", "nearest_work")
    )
    work = everywhere(claim, [one.saving(WORK) for one in found], "shapes")
    return [
        all_of(same, sum(not same for same in told), len(told), len(found), "shapes"),
        work.with_counts(
            {
                what: everywhere(claim, [one.saving(what) for one in found], "shapes")
                for what in MEASURES
                if what != WORK
            }
        ),
    ]


def total(found: Sequence[Search], what: str) -> tuple[int, int]:
    """Returns the total work of the matrix and of the search, over the shapes with both."""
    known = [one for one in found if one.saving(what).n]
    return sum(one.matrix.counted(MEASURES[what]) for one in known), sum(
        one.found.counted(MEASURES[what]) for one in known
    )


def cells_of(one: Search) -> list[str]:
    nearest = one.found.nearest()
    failed = one.found.failed()
    cells = (
        [nearest, numerals.number(one.found.percent(nearest))]
        if nearest
        else [numerals.NOTHING] * 2
    )
    cells += [
        {True: "yes", False: "no", None: numerals.NOTHING}[one.same],
        f"{one.found.cut_off()} of {len(one.found.rows)}"
        + (f", {len(failed)} failed" if failed else ""),
    ]
    for what in MEASURES:
        known = bool(one.saving(what).n)
        cells += [
            f"{one.matrix.counted(MEASURES[what]):,}" if known else numerals.NOTHING,
            f"{one.found.counted(MEASURES[what]):,}",
            numerals.estimate(one.saving(what)),
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
            *[cell for what in MEASURES for cell in (f"{what}, matrix", "search", "ratio")],
        ],
        left=3,
    )
    records, every, judged = list[tables.Record](), dict[str, list[Search]](), list[Verdict]()
    for solver, label in style.order(zip(results.cases.solver, results.cases.label)):
        found = every[style.title(solver, label)] = searches(results, matrix, label)
        judged += verdicts(style.title(solver, label), label, found)
        table.rules.add(len(table.rows))
        for i, one in enumerate(found):
            table.rows.append(
                [style.title(solver, label) if i == 0 else "", one.name, *cells_of(one)]
            )
            nearest = one.found.nearest()
            records.append(
                {
                    "label": label,
                    "source": one.name,
                    "nearest": nearest,
                    "percent": one.found.percent(nearest) if nearest else float("nan"),
                    "same": one.same,
                    "cut_off": one.found.cut_off(),
                    "targets": len(one.found.rows),
                    "failed": "; ".join(one.found.failed()),
                    **{
                        f"{name}_{side}": answers.counted([name])
                        for name in results.cases.counters
                        for side, answers in (("search", one.found), ("matrix", one.matrix))
                        if side == "search" or one.comparable
                    },
                }
            )
        sums = [total(found, what) for what in MEASURES]
        table.rows.append(
            [
                "",
                "all shapes",
                *[numerals.NOTHING] * 2,
                f"{sum(one.same is True for one in found)} of {len(found)}",
                f"{sum(one.found.cut_off() for one in found)} of {sum(len(one.found.rows) for one in found)}",
                *[
                    cell
                    for whole, part in sums
                    for cell in (
                        f"{whole:,}",
                        f"{part:,}",
                        numerals.number(whole / part if part else float("nan")),
                    )
                ],
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
    names = list(dict.fromkeys(one.name for found in every.values() for one in found))
    figure, axes = plt.subplots(
        1,
        len(every),
        figsize=(style.DOUBLE_COLUMN, 0.17 * len(names) + 1.2),
        sharey=True,
        squeeze=False,
    )
    place = {name: i for i, name in enumerate(names)}
    for ax, (title, found) in zip(axes[0], every.items()):
        counted = [
            (place[one.name], one.found.counted(MEASURES[WORK]), one.matrix.counted(MEASURES[WORK]))
            for one in found
            if one.saving(WORK).n
        ]
        ax.hlines(
            [at for at, _, _ in counted],
            [part for _, part, _ in counted],
            [whole for _, _, whole in counted],
            color="0.7",
            linewidth=1,
        )
        for name, side, fill in (("search", 1, "full"), ("full matrix", 2, "none")):
            ax.plot(
                [one[side] for one in counted],
                [one[0] for one in counted],
                "o",
                markersize=3.5,
                color="black",
                fillstyle=fill,
                label=name,
            )
        ax.set(title=title, xscale="log", xlabel=f"number of {WORK}")
        scales.log_ticks(ax.xaxis)
    axes[0][0].set_yticks(range(len(names)), names, fontsize=6.5)
    axes[0][0].invert_yaxis()
    axes[0][-1].legend()
    return figure
