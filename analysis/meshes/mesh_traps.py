"""Shows the outcome of each solver on mesh pairs for which published programs give a wrong answer
or none."""

from __future__ import annotations

import math
from typing import Any, Final

import matplotlib.pyplot as plt
from matplotlib.patches import Rectangle

from analysis.shared import claims, numerals, style, tables
from analysis.shared.notes import machine_line
from analysis.shared.report import NO_TIMES, Report
from analysis.shared.results import Results
from analysis.shared.verdicts import Verdict, never_chosen
from analysis.stability.stability_outcomes import STOPS, Outcome

# The outcomes, from best to worst.
CONVERGED, STOPPED, NO_BOUNDS, WRONG = ("converged", "stopped", "no bounds", "wrong")
SLACK: Final = 1e-12  # fraction of the diagonal of A: allows for rounded coordinates of models, as `exact` is for unrounded ones


def outcome(results: Results, row: int) -> str:
    """Returns the outcome of a row.

    `stopped`: valid bounds, but ended by its time limit, budget or precision floor. `wrong`: false
    bounds, or a certified solver that reports convergence but missed the tolerance.
    """
    cases = results.cases
    status, lower, upper, exact = (
        cases.status[row],
        cases.lower[row],
        cases.upper[row],
        cases.exact[row],
    )
    if status == "unsound":
        return WRONG
    if math.isnan(lower) or math.isnan(upper):
        return NO_BOUNDS
    slack = SLACK * float(cases.source_diagonal[row])
    if not lower <= upper or exact < lower - slack or exact > upper + slack:
        return WRONG
    tolerance = cases.tolerance_absolute[row]
    if status != "ok":
        return STOPPED
    return CONVERGED if upper - lower <= tolerance or not cases.certified[row] else WRONG


def ends(results: Results, row: int) -> str:
    """Returns the text of a cell: the outcome, or for a row that stopped or has no bounds, its
    status in words."""
    ending, status = outcome(results, row), results.cases.status[row]
    word = style.status_word(status)
    return (
        ending
        if ending in (CONVERGED, WRONG)
        else f"{word}, bounds hold"
        if ending == STOPPED
        else word
    )


def claim(results: Results) -> Verdict:
    """Judges the claim that each row of a certified solver has bounds, and none is wrong."""
    rows = [row for row in range(len(results.cases)) if results.cases.certified[row]]
    ill = [row for row in rows if outcome(results, row) in (WRONG, NO_BOUNDS)]
    return never_chosen(claims.of("hausbench", "traps"), len(ill), len(rows), "answers")


def make(results: Results) -> Report:
    cases = results.cases
    scenes = results.scenes
    labels = style.order(zip(cases.solver, cases.label))
    rows = {
        (scene, label): int(scene_rows[0])
        for scene in scenes
        for _, label in labels
        if (scene_rows := results.rows(scene=scene, label=label))
    }
    table = tables.Table(
        "How each solver ends on pairs of meshes that are traps: converged to "
        f"{numerals.number(float(cases.tolerance[0]))} of the diagonal of A, or stopped with bounds that hold.",
        ["pair", "triangles", "h(A,B) / diagonal", *[style.title(*pair) for pair in labels]],
        left=3 + len(labels),
    )
    records: list[tables.Record] = []
    for scene in scenes:
        first = results.rows(scene=scene)[0]
        table.rows.append(
            [
                scene,
                results.sizes(first, " → "),
                distance(results, first),
                *[
                    ends(results, rows[scene, label])
                    if (scene, label) in rows
                    else numerals.NOTHING
                    for _, label in labels
                ],
            ]
        )
        table.notes.append(f"{scene}: {cases.scene_note[first]}.")
        records += [
            {
                "scene": scene,
                "solver": solver,
                "label": label,
                "outcome": outcome(results, row),
                "status": cases.status[row],
                "lower": float(cases.lower[row]),
                "upper": float(cases.upper[row]),
                "exact": float(cases.exact[row]),
                "certified": bool(cases.certified[row]),
                "solve_seconds": float(cases.solve_seconds[row]),
                "reason": cases.reason[row],
            }
            for solver, label in labels
            if (row := rows.get((scene, label))) is not None
        ]
    wrong = [
        f"{label} on {scene} ({numerals.bounds(float(cases.lower[row]), float(cases.upper[row]))})"
        for scene in scenes
        for _, label in labels
        if (row := rows.get((scene, label))) is not None and outcome(results, row) == WRONG
    ]
    table.verdicts = [claim(results)]
    table.notes += [
        f"Wrong: {'; '.join(wrong) or 'none'}. Bounds are wrong if they leave out the true distance (by more than {SLACK:g} of the diagonal), "
        "contradict what is proven about it, or cross; and if a certified solver says that it has converged but has not. CGAL returns no "
        "interval: one is made from its answer and the tolerance.",
        f"Each had {numerals.number(float(cases.case_seconds_limit[0]))} s.",
        f"{machine_line(results)}.",
    ]
    return Report(lambda: draw(results, scenes, labels, rows), table, records, clock=NO_TIMES)


def distance(results: Results, row: int) -> str:
    """Returns the true distance over the diagonal of A: '0', three digits if that many are proven,
    or else the proven interval."""
    if results.cases.exact[row] == 0:
        return "0"
    return numerals.value(
        *results.reference_of(row), over=float(results.cases.source_diagonal[row])
    )


def mark(results: Results, row: int) -> tuple[Outcome, str]:
    """Returns the colour of a cell, as an Outcome of the stability suite, and the letter to draw in
    it."""
    ending, status = outcome(results, row), str(results.cases.status[row])
    if ending == CONVERGED:
        return Outcome.TIGHT, ""
    if ending == STOPPED:
        return (
            (Outcome.STOPPED, STOPS[status][0])
            if status in STOPS
            else (Outcome.LOOSE, Outcome.LOOSE.letter)
        )
    if ending == WRONG:
        return Outcome.WRONG, Outcome.WRONG.letter
    kind = {
        "timeout": Outcome.HUNG,
        "signal": Outcome.CRASHED,
        "out_of_memory": Outcome.CRASHED,
        "skipped": Outcome.NOT_RUN,
        "not_built": Outcome.NOT_RUN,
    }.get(status, Outcome.REFUSED)
    return kind, kind.letter


def draw(
    results: Results,
    scenes: list[str],
    labels: list[tuple[str, str]],
    rows: dict[tuple[str, str], int],
) -> Any:
    """Draws a cell for each solver and pair, coloured by its outcome, with a letter if it did not
    converge."""
    marks = {
        (i, j): mark(results, rows[scene, label])
        for i, scene in enumerate(scenes)
        for j, (_, label) in enumerate(labels)
        if (scene, label) in rows
    }
    figure, ax = plt.subplots(
        figsize=(
            style.SINGLE_COLUMN if len(labels) <= 6 else style.DOUBLE_COLUMN,
            1.5 + 0.17 * len(scenes),
        )
    )
    for (i, j), (kind, letter) in marks.items():
        ax.add_patch(Rectangle((j - 0.5, i - 0.5), 1, 1, facecolor=kind.colour, linewidth=0))
        ax.text(
            j, i, letter, ha="center", va="center", fontsize=6, fontweight="bold", color=kind.ink
        )
    ax.set(xlim=(-0.5, len(labels) - 0.5), ylim=(len(scenes) - 0.5, -0.5))
    ax.set_xticks(
        range(len(labels)),
        [style.title(*pair) for pair in labels],
        rotation=40,
        ha="right",
        rotation_mode="anchor",
    )
    ax.set_yticks(range(len(scenes)), scenes)
    ax.set_xticks([k + 0.5 for k in range(len(labels) - 1)], minor=True)
    ax.set_yticks([k + 0.5 for k in range(len(scenes) - 1)], minor=True)
    ax.grid(False)
    ax.grid(which="minor", color="white", linewidth=1)
    ax.set_axisbelow(False)
    ax.tick_params(which="both", length=0)
    for spine in ax.spines.values():
        spine.set_visible(False)
    words = {
        Outcome.TIGHT: CONVERGED,
        Outcome.LOOSE: "ended early, bounds hold",
        Outcome.HUNG: "stopped at its time limit, no bounds",
        Outcome.CRASHED: "crashed, no bounds",
        Outcome.REFUSED: "refused, no bounds",
    }
    stops = dict(STOPS.values())
    shown = sorted(set(marks.values()), key=lambda pair: (pair[0].badness, pair[1]))
    entries = [
        Rectangle(
            (0, 0),
            1,
            1,
            facecolor=kind.colour,
            edgecolor="#BBBBBB",
            linewidth=0.4,
            label=f"{letter}  {f'{stops[letter]}, bounds hold' if kind == Outcome.STOPPED else words.get(kind, kind.words)}".strip(),
        )
        for kind, letter in shown
    ]
    style.legend_above(figure, entries, columns=3)
    return figure
