"""Shows how time and counted work of each solver grow with severity."""

from __future__ import annotations

import math
from typing import Any, Final

from analysis.shared import numerals, tables
from analysis.shared.notes import machine_line
from analysis.shared.report import Report
from analysis.shared.results import Results
from analysis.stability import stability_panels
from analysis.speed.cliffs_curves import COUNTED
from analysis.stability.stability_families import Answer, Family, Suite, look, severity_text
from analysis.stability.stability_outcomes import Outcome
from analysis.stability.stability_panels import Measure, choose, largest, swept

RESULTS_OF: Final = "stability_matrix"


def make(results: Results) -> Report:
    suite = Suite(results)
    families = swept(suite)
    table = tables.Table(
        "Time to solve and counted work of each solver on each family: at the mildest severity, and the most at any severity.",
        [
            "family",
            "solver",
            "time, ms",
            "most, ms",
            "at severity",
            "work",
            "most work",
            "at severity",
            "out of time",
            "without bounds",
        ],
        left=2,
    )
    for family in families:
        table.rules.add(len(table.rows))
        for pair in suite.labels_of(family.kind):
            if answers := [
                answer for answer in family.finest(pair[1]) if answer in family.asked(pair[1])
            ]:
                table.rows.append([family.title, look(*pair).title, *cells(suite, answers)])
    table.notes = [
        "At the finest tolerance. Time: of the first answer, with structures already built. Work: distances, bounds, nodes of trees and "
        "polynomial bounds together; peers count nothing. Out of time: at the limit, with bounds or without.",
        f"{machine_line(results)}.",
    ]
    records = [
        record(suite, family, answer)
        for family in families
        for answers in family.answers.values()
        for answer in answers.values()
        if answer in family.asked(answer.label)
    ]
    return Report(
        lambda: draw(suite, choose(families, lambda family: growth(suite, family))),
        table,
        records,
        clock="Times are wall time.",
        caption="Time to solve (upper frames) and counted work (lower frames) of each solver against severity, on the families in which the work "
        "of one grows the most.",
    )


def ran_out_of_time(suite: Suite, answer: Answer) -> bool:
    return bool(suite.results.cases.status[answer.row] == "timeout")


def seconds(suite: Suite, answer: Answer) -> float:
    """Returns the time of an answer; NaN if there is none, or it ran out of time."""
    return (
        math.nan
        if ran_out_of_time(suite, answer)
        else float(suite.results.cases.solve_seconds[answer.row])
    )


def limit(suite: Suite, answer: Answer) -> float:
    return float(suite.results.cases.case_seconds_limit[answer.row])


def work(suite: Suite, answer: Answer) -> float:
    """Returns the counted work; NaN if nothing is counted, or it ran out of time."""
    counters = suite.results.cases.counters
    count = sum(int(counters[name][answer.row]) for name in COUNTED if name in counters)
    return float(count) if count and not ran_out_of_time(suite, answer) else math.nan


def growth(suite: Suite, family: Family) -> float:
    """Returns the largest growth of work of any solver over a family, in powers of ten; infinity if
    one ran out of time."""
    most = 0.0
    for label in family.answers:
        answers = [answer for answer in family.finest(label) if answer in family.asked(label)]
        counts = [count for answer in answers if (count := work(suite, answer)) > 0]
        if any(ran_out_of_time(suite, answer) for answer in answers):
            return math.inf
        if counts:
            most = max(most, math.log10(max(counts) / min(counts)))
    return most


def cells(suite: Suite, answers: list[Answer]) -> list[str]:
    texts: list[str] = []
    for of, scale in ((seconds, 1e3), (work, 1.0)):
        values = [(of(suite, answer), answer) for answer in answers]
        most = largest(values)
        texts += [
            text(values[0][0] * scale, of is work),
            text(most[0] * scale, of is work) if most else numerals.NOTHING,
            severity_text(most[1].severity) if most else numerals.NOTHING,
        ]
    late = sum(ran_out_of_time(suite, answer) for answer in answers)
    silent = sum(
        answer.outcome in (Outcome.HUNG, Outcome.CRASHED, Outcome.REFUSED) for answer in answers
    )
    return texts + [f"{count} of {len(answers)}" if count else "" for count in (late, silent)]


def text(value: float, is_count: bool) -> str:
    return (
        numerals.NOTHING
        if math.isnan(value)
        else f"{value:,.0f}"
        if is_count
        else numerals.number(value)
    )


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
        "status": cases.status[row],
        "seconds": seconds(suite, answer),
        "limit_seconds": limit(suite, answer),
        "work": work(suite, answer),
    }


def draw(suite: Suite, families: list[Family]) -> Any:
    def no_guide(answer: Answer) -> float:
        return math.nan

    measures = (
        Measure(
            "time (s)",
            lambda answer: seconds(suite, answer),
            lambda answer: limit(suite, answer),
            lambda answer: limit(suite, answer) if ran_out_of_time(suite, answer) else math.nan,
        ),
        Measure("work (operations)", lambda answer: work(suite, answer), no_guide),
    )
    tolerances = sorted({answer.tolerance for answer in suite.answers})
    notes = [
        "Dotted: the time limit; open markers on it: out of time. Open markers below: stopped or loose. Red boxes: wrong."
        + (f" Tolerance: {tolerances[0]:g}, the finest." if len(tolerances) > 1 else ""),
        "Letters: no answer (C crashed, R refused; H hung, in the frame of work). Operations: distances, bounds, nodes and polynomial bounds; peers count none.",
    ]
    return stability_panels.draw(suite, families, measures, notes)
