"""The stability matrix for the report: the worst outcome of each solver on each family of scenes,
and the answers behind it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

from analysis.report.all_rows import rounded
from analysis.shared.results import Results
from analysis.stability import stability_error
from analysis.stability.stability_families import (
    KINDS,
    Family,
    Suite,
    look,
    range_text,
    severity_text,
)
from analysis.stability.stability_outcomes import Outcome

STEM: Final = "stability_matrix"


@dataclass(frozen=True)
class Cell:
    outcome: Outcome
    letter: str  # of the worst answer
    count: int  # answers with this outcome
    of: int  # answers asked for
    place: int  # of its answers in the data; -1: none


@dataclass(frozen=True)
class Kind:
    """One of the tables: points, meshes or surfaces."""

    name: str
    solvers: Sequence[str]
    rows: Sequence[
        tuple[str, str, Sequence[Cell]]
    ]  # family, range of its severities, and a cell for each solver


def worst(suite: Suite, family: Family, label: str, answers: list[Any]) -> Cell:
    """Returns the cell of a family and a solver, and appends its answers to the data."""
    of_label = family.asked(label)
    if not of_label:
        return Cell(Outcome.NOT_APPLICABLE if family.of(label) else Outcome.NOT_RUN, "", 0, 0, -1)
    least = max(of_label, key=lambda answer: answer.outcome.badness)
    answers.append(
        [
            [
                severity_text(answer.severity),
                rounded(answer.severity),
                answer.tolerance,
                answer.outcome.words,
                rounded(stability_error.error(suite, answer)),
                rounded(stability_error.gap(suite, answer)),
                str(suite.results.cases.reason[answer.row]),
            ]
            for answer in of_label
        ]
    )
    return Cell(
        least.outcome,
        least.letter,
        sum(answer.outcome == least.outcome for answer in of_label),
        len(of_label),
        len(answers) - 1,
    )


def described(results: dict[str, Results]) -> tuple[list[Kind], list[Any]]:
    """Returns the tables, and the answers of each cell: (severity as text, severity, tolerance,
    outcome, error, gap, reason), where error and gap are fractions of the diagonal of A. Empty
    without results of the suite."""
    if STEM not in results:
        return [], []
    suite, answers = Suite(results[STEM]), list[Any]()
    kinds = []
    for name in KINDS:
        labels = suite.labels_of(name)
        rows = []
        for family in suite.of_kind(name):
            cells = [worst(suite, family, label, answers) for _, label in labels]
            rows.append((family.title, range_text(family), cells))
        if rows:
            kinds.append(Kind(name, [look(*pair).title for pair in labels], rows))
    return kinds, answers
