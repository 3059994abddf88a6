"""Compares the printed interval for the example of Shou et al. 2014 with ours, for the symmetric
distance."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import matplotlib.pyplot as plt
import numpy as np

from analysis.shared import claims, numerals, style, tables
from analysis.shared.drawable import as_formula
from analysis.shared.load import paper_numbers
from analysis.shared.notes import machine_line
from analysis.shared.report import Report
from analysis.shared.results import Results
from analysis.shared.verdicts import Verdict, all_of


PRINTED_TO = (
    1e-10  # allowed difference to ten printed digits, which the paper truncates instead of rounding
)


@dataclass(frozen=True)
class Joined:
    """The symmetric distance by one solver: bounds are the maximum of both directions; times and
    counts are their sum."""

    lower: float
    upper: float
    prepare: float
    solve: float
    distances: int
    evaluations: int
    status: str

    def record(self) -> tables.Record:
        return {
            "lower": self.lower,
            "upper": self.upper,
            "subdivision_seconds": self.prepare,
            "distance_seconds": self.solve,
            "box_distances": self.distances,
            "polynomial_evaluations": self.evaluations,
        }


def join(results: Results, rows: list[int]) -> Joined:
    """Combines the rows of both directions of one solver and its options into a symmetric
    answer."""
    cases = results.cases
    bad = [cases.status[row] for row in rows if cases.status[row] != "ok"]
    lower = max(float(cases.lower[row]) for row in rows)
    upper = max(float(cases.upper[row]) for row in rows)
    prepare = sum(results.prepare_seconds(row) for row in rows)
    solve = sum(
        float(np.median(list(results.solve_by_round(row).values())))
        if results.solve_by_round(row)
        else float("nan")
        for row in rows
    )
    distances = sum(int(cases.counters["box_distances"][row]) for row in rows)
    evaluations = sum(int(cases.counters["polynomial_evaluations"][row]) for row in rows)
    status = bad[0] if bad else "ok"
    return Joined(lower, upper, prepare, solve, distances, evaluations, status)


def make(results: Results) -> Report:
    cases, reference = results.cases, paper_numbers(results.stem)
    paper: dict[str, Any] = reference["row"][0]
    exact = float(reference["exact"])
    methods = [
        (solver, label, tolerance)
        for solver, label in style.order(zip(cases.solver, cases.label))
        for tolerance in sorted(
            set(map(float, cases.tolerance[results.rows(label=label)])), reverse=True
        )
    ]
    answers = {}
    for _, label, tolerance in methods:
        rows = [int(row) for row in results.rows(label=label) if cases.tolerance[row] == tolerance]
        answers[label, tolerance] = join(results, rows)
    doubtful = "seconds" in paper.get("doubtful", [])
    all_pairs = next(
        (answer for (label, _), answer in answers.items() if label == "all pairs"), None
    )
    table = tables.Table(
        "Hausdorff distance H of two elliptic cones in [-2, 2]³, the example of Shou et al. 2014: 64 voxels per axis, and this project's enclosure.",
        [
            "method",
            "lower",
            "upper",
            "midpoint",
            "half-width",
            "subdivision, s",
            "distances, s",
            "box distances",
            "fewer than all pairs",
            "polynomial bounds",
        ],
    )
    table.rows.append(
        [
            "paper",
            f"{paper['lower']:.10f}",
            f"{paper['upper']:.10f}",
            f"{paper['midpoint']:.11f}",
            f"{paper['error']:.11f}",
            numerals.NOTHING,
            f"{paper['seconds']}{'?' if doubtful else ''} (all)",
            *3 * [numerals.NOTHING],
        ]
    )
    records: list[tables.Record] = []
    for solver, label, tolerance in methods:
        answer = answers[label, tolerance]
        ratio = (
            all_pairs.distances / answer.distances
            if all_pairs and answer.distances
            else float("nan")
        )
        title = title_of(solver, label, tolerance)
        table.rows.append(
            [
                title if answer.status == "ok" else f"{title} ({style.status_word(answer.status)})",
                numerals.at_least(answer.lower, 10),
                numerals.at_most(answer.upper, 10),
                f"{(answer.lower + answer.upper) / 2:.11f}",
                f"{(answer.upper - answer.lower) / 2:.3e}"
                if answer.upper - answer.lower < 1e-3
                else f"{(answer.upper - answer.lower) / 2:.11f}",
                numerals.number(answer.prepare),
                numerals.number(answer.solve),
                f"{answer.distances:,}",
                numerals.number(ratio),
                f"{answer.evaluations:,}",
            ]
        )
        records.append(
            {
                "solver": solver,
                "label": label,
                "tolerance": tolerance,
                "status": answer.status,
                **answer.record(),
                "paper_lower": paper["lower"],
                "paper_upper": paper["upper"],
                "paper_seconds": float("nan") if doubtful else paper["seconds"],
            }
        )
    table.verdicts = [printed_interval(paper, all_pairs)]
    table.notes = [
        f"Both directions together. The exact H of these surfaces is sqrt 43/3 - 4/3 = {exact:.10f}, attained "
        "where the box clips the second surface.",
        f"Paper: {reference['machine']}; {paper['seconds']} s{compared_with(paper, all_pairs, doubtful)} The column 'fewer than all pairs' shows the gain of "
        "the algorithm. The enclosure is comparable where its interval is as wide as the one of all pairs.",
        "The published method assumes that every voxel that may meet the surface does meet it, so its ends are not bounds where that fails (stem "
        "surfaces_gallery shows such a pair); 'surface enclosure' proves both ends.",
        "The surfaces' denominators are inferred from the printed interval; the text itself is not legible there.",
        f"Here: {machine_line(results)}.",
    ]
    return Report(lambda: draw(methods, answers, paper, exact), table, records)


def printed_interval(paper: dict[str, Any], here: Joined | None) -> Verdict:
    """Judges whether our interval for all pairs, its midpoint and its half-width equal the printed
    numbers."""
    answer = here if here and here.status == "ok" else None
    numbers = (
        {
            "lower": answer.lower,
            "upper": answer.upper,
            "midpoint": (answer.lower + answer.upper) / 2,
            "error": (answer.upper - answer.lower) / 2,
        }
        if answer
        else {}
    )
    unlike = sum(abs(value - float(paper[name])) >= PRINTED_TO for name, value in numbers.items())
    return all_of(
        claims.of("shou2014", "printed_interval"), unlike, len(numbers), len(numbers), "numbers"
    )


def compared_with(paper: dict[str, Any], here: Joined | None, doubtful: bool) -> str:
    """Ends a sentence on the paper's time: with its ratio to ours, unless the printed time may have
    been misread."""
    if doubtful:
        return " as it was recognised, possibly with a lost decimal point, so no ratio of times is given."
    if here is None:
        return "."
    return (
        f". All pairs took {numerals.number(paper['seconds'] / (here.prepare + here.solve))} times less here. The numbers of distances put that in "
        "perspective: the same work, in compiled code on another machine."
    )


def title_of(solver: str, label: str, tolerance: float) -> str:
    """Returns the title of a method, with its tolerance unless it is above 1, which means none."""
    title = style.title(solver, label).replace(" (ours)", ", ours")
    return title if tolerance > 1 else f"{title}, to {tolerance:g}".replace("e-0", "e-")


def draw(
    methods: list[tuple[str, str, float]],
    answers: dict[tuple[str, float], Joined],
    paper: dict[str, Any],
    exact: float,
) -> Any:
    figure, ax = plt.subplots(figsize=(style.SINGLE_COLUMN, 0.9 + 0.28 * (len(methods) + 1)))
    names = ["paper"]
    ax.use_sticky_edges = False
    ax.barh(
        0,
        paper["upper"] - paper["lower"],
        0.17,
        left=paper["lower"],
        facecolor="white",
        edgecolor="black",
        linewidth=0.8,
        zorder=2,
    )  # open: printed
    for row, (solver, label, tolerance) in enumerate(methods, start=1):
        looks, answer = style.look(solver, label), answers[label, tolerance]
        ax.plot(
            [answer.lower, answer.upper],
            [row, row],
            color=looks.colour,
            linewidth=3,
            solid_capstyle="butt",
        )
        ax.plot([(answer.lower + answer.upper) / 2], [row], **style.filled_marker(looks))
        names.append(title_of(solver, label, tolerance))
    ax.axvline(exact, color="black", linewidth=0.7, linestyle=(0, (3, 2)), zorder=0)
    as_formula(
        ax.annotate(
            r"$H = \sqrt{43}/3 - 4/3$",
            (exact, -0.5),
            xytext=(-3, 0),
            textcoords="offset points",
            ha="right",
            va="center",
            fontsize=7,
        )
    )
    ax.set_yticks(range(len(names)), names)
    ax.set_ylim(len(names) - 0.4, -0.9)
    ax.set_xlabel("Hausdorff distance H (units of the model)")
    return figure
