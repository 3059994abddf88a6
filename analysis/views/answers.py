"""Kind `table`: every answer of a result, with its time."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from analysis.shared import numerals, style, tables
from analysis.shared.cells import Cell
from analysis.shared.notes import machine_line
from analysis.shared.report import Report
from analysis.shared.results import Results
from analysis.views import stated


class Asked(NamedTuple):
    """A distance that an experiment asks for, at one tolerance."""

    scene: str
    pose: int
    tolerance: float

    def title(self, several_poses: bool) -> str:
        return style.scene_title(self.scene) + (f", pose {self.pose}" if several_poses else "")


def questions(results: Results) -> dict[Asked, dict[str, Cell]]:
    """Returns the answers to each question, by solver, in the order of the file."""
    rows: dict[Asked, dict[str, list[int]]] = {}
    cases = results.cases
    for row in range(len(cases)):
        asked = Asked(
            str(cases.scene[row]), int(cases.pose_index[row]), float(cases.tolerance[row])
        )
        rows.setdefault(asked, {}).setdefault(str(results.names[row]), []).append(row)
    return {
        asked: {name: Cell(results, found) for name, found in by_name.items()}
        for asked, by_name in rows.items()
    }


def measured(results: Results) -> dict[Asked, dict[str, Cell]]:
    """Returns questions() without those whose answers were all read off finer runs, so that no
    measurement counts twice."""
    return {
        question: by_name
        for question, by_name in questions(results).items()
        if not all(results.cases.from_trace[row] for cell in by_name.values() for row in cell.rows)
    }


def moving(results: Results) -> set[str]:
    """Returns the scenes with more than one pose."""
    return {
        scene
        for scene in results.scenes
        if len({int(results.cases.pose_index[row]) for row in results.rows(scene=scene)}) > 1
    }


def make(results: Results) -> Report:
    cases, asked, moves = results.cases, questions(results), moving(results)
    known = [cell.time for by_name in asked.values() for cell in by_name.values()]
    unit, scale = numerals.time_unit(time.value for time in known if time.n)
    reported = bool(np.isfinite(cases.reported_seconds).any())
    table = tables.Table(
        str(results.meta.get("title") or results.stem),
        [
            "scene",
            "tolerance",
            "solver",
            "lower bound",
            "upper bound",
            f"time, {unit}",
            *[f"reported, {unit}"] * reported,
            "status",
        ],
        left=3,
    )
    records: list[tables.Record] = []
    for question, by_name in asked.items():
        table.rules.add(len(table.rows))
        for name, cell in by_name.items():
            row = cell.rows[0]
            answered = [case for case in cell.rows if cases.status[case] != "failed"]
            lower, upper = (
                (float(cases.lower[answered].min()), float(cases.upper[answered].max()))
                if answered
                else (math.nan, math.nan)
            )  # over all seeds
            said = float(np.median(cases.reported_seconds[cell.rows])) if reported else math.nan
            table.rows.append(
                [
                    question.title(question.scene in moves),
                    numerals.number(question.tolerance, 2),
                    style.title(cases.solver[row], name),
                    numerals.at_least(lower, 7),
                    numerals.at_most(upper, 7),
                    numerals.estimate(cell.time, scale),
                    *[numerals.number(said * scale)] * reported,
                    cell.status(),
                ]
            )
            records.append(
                {
                    **question._asdict(),
                    "solver": cases.solver[row],
                    "name": name,
                    "lower": lower,
                    "upper": upper,
                    **tables.seconds(cell.time),
                    "reported_seconds": said,
                    "status": cell.status(),
                    "reason": cases.reason[row],
                }
            )
    table.verdicts = stated.verdicts(results, asked)
    table.notes = [
        f"Tolerances are {units(results)}. {tables.coverage_note(known)}",
        f"Measured on {machine_line(results)}.",
    ]
    return Report(None, table, records)


def units(results: Results) -> str:
    """Returns the unit of the tolerances in words, for a sentence."""
    words = {
        "diagonal": "fractions of the diagonal of A",
        "longest": "fractions of the longest side of A's box",
        "absolute": "lengths",
        "lower": "fractions of the lower bound",
    }
    return " or ".join(words.get(str(of), str(of)) for of in results.in_order("tolerance_of"))
