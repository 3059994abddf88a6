"""Shows how error and gap of each solver grow with severity, on families of scenes whose true
distance is known."""

from __future__ import annotations

import math
from typing import Any, Final

from analysis.shared import numerals, tables
from analysis.shared.notes import machine_line
from analysis.shared.report import NO_TIMES, Report
from analysis.shared.results import Results
from analysis.stability import stability_panels
from analysis.stability.stability_families import Answer, Family, Suite, look, severity_text
from analysis.stability.stability_outcomes import Outcome
from analysis.stability.stability_panels import Measure, choose, largest, relative, swept

RESULTS_OF: Final = "stability_matrix"


def make(results: Results) -> Report:
    suite = Suite(results)
    families = [family for family in swept(suite) if has_exact(suite, family)]
    table = tables.Table(
        "The largest true error of each solver on families whose distance is known in closed form, relative to the diagonal of A, "
        "and the gap that it claims there.",
        ["family", "solver", "error", "at severity", "gap", "40 u M", "wrong", "without bounds"],
        left=2,
    )
    for family in families:
        table.rules.add(len(table.rows))
        for pair in suite.labels_of(family.kind):
            if answers := family.asked(pair[1]):
                table.rows.append([family.title, look(*pair).title, *cells(suite, answers)])
    table.notes = [
        "Error: the larger of |lower - h| and |upper - h|; for CGAL, which gives one number, |answer - h|. u = 2^-53, M: the largest coordinate; "
        "a tolerance below 40 u M is below the precision of doubles. Over all severities and tolerances.",
        f"{machine_line(results)}.",
    ]
    records = [
        record(suite, family, answer)
        for family in families
        for answers in family.answers.values()
        for answer in answers.values()
        if answer in family.asked(answer.label)
    ]
    return Report(lambda: draw(suite, choose(families, ill)), table, records, clock=NO_TIMES)


def has_exact(suite: Suite, family: Family) -> bool:
    return all(
        math.isfinite(suite.results.cases.exact[answer.row])
        for answers in family.answers.values()
        for answer in answers.values()
    )


def ill(family: Family) -> float:
    """Returns 1 if some solver is wrong on the family, else 0."""
    return float(
        any(
            answer.outcome == Outcome.WRONG
            for answers in family.answers.values()
            for answer in answers.values()
        )
    )


def error(suite: Suite, answer: Answer) -> float:
    """Returns the error of the worse bound (of CGAL's lower bound) over the diagonal of A; NaN for
    a row without bounds."""
    cases, row = suite.results.cases, answer.row
    lower, upper, exact = float(cases.lower[row]), float(cases.upper[row]), float(cases.exact[row])
    apart = (
        abs(lower - exact)
        if cases.solver[row] == "cgal"
        else max(abs(lower - exact), abs(upper - exact))
    )
    return relative(apart, float(cases.source_diagonal[row]))


def gap(suite: Suite, answer: Answer) -> float:
    """Returns the gap over the diagonal of A; NaN if lower > upper."""
    between = suite.results.gap(answer.row)
    return (
        relative(between, float(suite.results.cases.source_diagonal[answer.row]))
        if between >= 0
        else math.nan
    )


def floor(suite: Suite, answer: Answer) -> float:
    return relative(
        suite.judge.floor(answer.row), float(suite.results.cases.source_diagonal[answer.row])
    )


def cells(suite: Suite, answers: list[Answer]) -> list[str]:
    worst = largest([(error(suite, answer), answer) for answer in answers])
    wrong = sum(answer.outcome == Outcome.WRONG for answer in answers)
    silent = sum(math.isnan(error(suite, answer)) for answer in answers)
    counts = [f"{count} of {len(answers)}" if count else "" for count in (wrong, silent)]
    if worst is None:
        return [numerals.NOTHING] * 4 + counts
    value, answer = worst
    return [
        numerals.number(value, 2),
        severity_text(answer.severity),
        numerals.number(gap(suite, answer), 2),
        numerals.number(floor(suite, answer), 2),
        *counts,
    ]


def record(suite: Suite, family: Family, answer: Answer) -> tables.Record:
    cases, row = suite.results.cases, answer.row
    return {
        "family": family.name,
        "kind": family.kind,
        "severity": answer.severity,
        "tolerance": answer.tolerance,
        "solver": cases.solver[row],
        "label": answer.label,
        "certified": int(answer.certified),
        "verdict": answer.outcome.words,
        "relative_error": error(suite, answer),
        "relative_gap": gap(suite, answer),
        "relative_40uM": floor(suite, answer),
        "exact": float(cases.exact[row]),
    }


def draw(suite: Suite, families: list[Family]) -> Any:
    measures = (
        Measure(
            "gap / diagonal", lambda answer: gap(suite, answer), lambda answer: floor(suite, answer)
        ),
        Measure(
            "error / diagonal",
            lambda answer: error(suite, answer),
            lambda answer: floor(suite, answer),
        ),
    )
    tolerances = sorted({answer.tolerance for answer in suite.answers})
    notes = [
        "Red boxes: wrong. Open markers: stopped or loose. Dotted: 40 u M, the precision of doubles. Zeros are in the grey band."
        + (f" Tolerance: {tolerances[0]:g}, the finest." if len(tolerances) > 1 else ""),
        "Letters: no bounds (H hung, C crashed, R refused, X no numbers; ∞ no upper bound).",
    ]
    return stability_panels.draw(suite, families, measures, notes)
