"""Shows at which ratio of two lengths of a scene (a size, a distance) the work or time of a solver
rises steeply: a cliff.

Work and time are relative to those at ratio 1.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence


from analysis.shared import claims, numerals, style, tables, verdicts
from analysis.shared.cells import takes_seed
from analysis.shared.notes import machine_line
from analysis.shared.report import Report
from analysis.shared.results import Results
from analysis.shared.verdicts import Verdict
from analysis.speed import cliffs_picture
from analysis.speed.cliffs_curves import (
    ANSWERED,
    FAMILIES,
    MOST,
    Curves,
    Row,
    collect,
    flat_from,
    largest,
    power,
    relative,
)


def verdicts_of(curves: Curves, titles: dict[str, str]) -> list[Verdict]:
    """Judges each claim for each solver that counts its work."""
    judged = []
    for claim in dict.fromkeys(family.claim for family in FAMILIES.values() if family.claim):
        for label, title in titles.items():
            chosen = {
                key: rows
                for key, rows in curves.items()
                if key[1] == label and FAMILIES[key[0]].claim == claim
            }
            if any(not math.isnan(row.work) for rows in chosen.values() for row in rows):
                judged.append(verdict(claim, title, chosen))
    return judged


def verdict(claim: str, title: str, curves: Curves) -> Verdict:
    """Judges the claim that a solver has no cliff, over the families of the claim.

    Work that exceeds MOST times the work at ratio 1 refutes the claim, as counts are exact. So does
    a missing answer, if there is one at ratio 1.
    """
    text = claims.of("hausbench", "no_cliff", work=claim, title=title, most=MOST)
    measured = {
        family: rows
        for (family, _), rows in curves.items()
        if rows[0].ratio == 1 and not math.isnan(rows[0].work)
    }
    unknown = [
        f"{FAMILIES[family].title} has no work at ratio 1"
        for family, _ in curves
        if family not in measured
    ]
    unknown += [
        f"{FAMILIES[family].title} ends at ratio {power(rows[-1].ratio)}"
        for family, rows in measured.items()
        if rows[-1].ratio < 1e12
    ]
    lost = Counter(
        row.status for rows in measured.values() for row in rows if row.status not in ANSWERED
    )
    evidence, factor = lost_text(lost) + unknown, math.nan
    if measured:
        factor, worst, family = max(
            ((*largest(rows, "work"), family) for family, rows in measured.items()),
            key=lambda entry: entry[0],
        )
        assert worst is not None
        evidence.insert(
            0,
            f"in {len(measured)} kind{'s' if len(measured) > 1 else ''} of scene, largest {numerals.number(factor)} times, "
            f"{FAMILIES[family].title} at ratio {power(worst.ratio)}",
        )
    outcome = (
        verdicts.FAILS
        if lost or factor > MOST
        else verdicts.UNTESTED
        if unknown
        else verdicts.HOLDS
    )
    return Verdict(text, outcome, "; ".join(evidence))


def away_notes(results: Results, curves: Curves, titles: dict[str, str]) -> list[str]:
    """Describes cliffs that end as A moves away: how much work grows, where it becomes constant,
    and why, if counters show it."""
    notes, nodes = [], results.cases.counters.get("node_visits")
    for (key, label), rows in curves.items():
        factor, start = largest(rows, "work")[0], flat_from(rows)
        if not key.endswith("_away") or not factor > MOST or start is None or start is rows[0]:
            continue
        text = (
            f"{FAMILIES[key].title}: the work of {titles[label]} grows {numerals.number(factor)} times and is flat from ratio "
            f"{power(start.ratio)} on"
        )
        far = rows[rows.index(start) :]
        if (
            results.cases.solver[start.case] == "ohd"
            and nodes is not None
            and nodes[rows[0].case] > 0
            and not any(nodes[row.case] for row in far)
        ):
            text += (
                ". There it visits no node of its octree, whose cells are split only down to the size of the first lower bound; that is larger than B, "
                "so each search scans the points of B one by one"
            )
        notes.append(text + ".")
    return notes


def lost_text(lost: Counter[str]) -> list[str]:
    return (
        [", ".join(f"{n} {style.status_word(status)}" for status, n in lost.items())]
        if lost
        else []
    )


def make(results: Results) -> Report:
    curves = collect(results)
    drawn = {label for _, label in curves}
    order = style.order(zip(results.cases.solver, results.cases.label))
    labels = [(solver, label) for solver, label in order if label in drawn]
    titles = {label: style.title(solver, label) for solver, label in labels}
    table = tables.Table(
        "Work and time of each solver as two lengths of a scene grow apart, relative to ratio 1.",
        [
            "scene",
            "solver",
            "work at ratio 1",
            "largest work / that",
            "at ratio",
            "largest time / time at ratio 1",
            "at ratio",
            "rows not ok",
        ],
        left=2,
    )
    records: list[tables.Record] = []
    for key, family in FAMILIES.items():
        table.rules.add(len(table.rows))
        for _, label in labels:
            if rows := curves.get((key, label)):
                table.rows.append([family.title, titles[label], *table_cells(rows)])
                records += [record(results, key, row, rows) for row in rows]
    table.verdicts = verdicts_of(curves, titles)
    answers: dict[str, list[float]] = {label: [] for _, label in labels}
    for (_, label), rows in curves.items():
        if label in answers:
            answers[label] += [row.work for row in rows if row.status in ANSWERED]
    silent = [
        titles[label] for label, work in answers.items() if work and all(map(math.isnan, work))
    ]
    work_note = (
        "Work: distances, bounds, nodes of trees and polynomial bounds of one solve, together."
    )
    if silent:
        work_note += f" No counts, only time: {', '.join(silent)}."
    if not all(map(math.isnan, answers.get("kdtree", []))):
        work_note += f" {titles.get('kdtree')}, a peer, counts only distances, not the nodes and bounds of its tree."
    table.notes += [
        work_note + one_seed(results, curves, titles),
        *away_notes(results, curves, titles),
        "Time: preparing and solving. Ratio: a distance in the scene over the diagonal of the rest of it; base over height "
        "of a needle; degree of a surface, from 4 on; 1 / tolerance, from 10 on. A case may take "
        f"{numerals.number(float(results.cases.case_seconds_limit[0]))} s.",
        f"Measured on {machine_line(results)}.",
    ]
    return Report(lambda: cliffs_picture.draw(curves, labels), table, records)


def one_seed(results: Results, curves: Curves, titles: dict[str, str]) -> str:
    drawn = {
        titles[label]: None
        for (_, label), rows in curves.items()
        if takes_seed(results, rows[0].case)
    }
    return f" With one seed, so one draw: {', '.join(drawn)}." if drawn else ""


def table_cells(rows: Sequence[Row]) -> list[str]:
    cells = [f"{rows[0].work:,.0f}" if not math.isnan(rows[0].work) else numerals.NOTHING]
    for measure in ("work", "seconds"):
        factor, worst = largest(rows, measure)
        cells += [numerals.number(factor), power(worst.ratio) if worst else numerals.NOTHING]
    return cells + (lost_text(Counter(row.status for row in rows if row.status != "ok")) or [""])


def record(results: Results, family: str, row: Row, rows: Sequence[Row]) -> tables.Record:
    cases, at = results.cases, rows.index(row)
    new: tables.Record = {"family": family, "ratio": row.ratio}
    new |= {
        name: getattr(cases, name)[row.case]
        for name in ("scene", "solver", "label", "status", "reason")
    }
    new |= {
        "work": row.work,
        "work_relative": relative(rows, "work")[at],
        "seconds": row.seconds,
        "seconds_relative": relative(rows, "seconds")[at],
        "lower": float(cases.lower[row.case]),
        "upper": float(cases.upper[row.case]),
        "tolerance_absolute": float(cases.tolerance_absolute[row.case]),
    }
    return new | {name: int(column[row.case]) for name, column in cases.counters.items()}
