"""Pairs on which published mesh programs end wrong or not at all: how each solver ends on them."""

from __future__ import annotations

import math
from typing import Any, Final

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import ListedColormap

from analysis.shared import claims, style, tables
from analysis.shared.notes import machine_line
from analysis.shared.report import NO_TIMES, Report
from analysis.shared.results import Results
from analysis.shared.verdicts import Verdict, never_chosen

# From best to worst: what the cell says, and its colour.
OUTCOMES: Final = (("converged", "#7FBF7B"), ("stopped", "#D9F0D3"), ("no bounds", "#DDDDDD"), ("wrong", "#D6604D"))
CONVERGED, STOPPED, NO_BOUNDS, WRONG = (name for name, _ in OUTCOMES)
SLACK: Final = 1e-12  # of the diagonal of A: models' coordinates are rounded, `exact` is not


def outcome(results: Results, row: int) -> str:
    """`stopped`: at its time limit, budget or precision floor, with bounds that hold. `wrong`: bounds that cannot be true."""
    cases = results.cases
    status, lower, upper, exact = cases.status[row], cases.lower[row], cases.upper[row], cases.exact[row]
    if status == "unsound":
        return WRONG
    if math.isnan(lower) or math.isnan(upper):
        return NO_BOUNDS
    slack = SLACK * float(cases.source_diagonal[row])
    if not lower <= upper or exact < lower - slack or exact > upper + slack:
        return WRONG
    asked = cases.tolerance_absolute[row]
    if status != "ok":
        return STOPPED
    return CONVERGED if upper - lower <= asked or not cases.certified[row] else WRONG


def ends(results: Results, row: int) -> str:
    """The text of a cell: the outcome, and why it is not `converged`."""
    found, status = outcome(results, row), results.cases.status[row]
    word = style.status_word(status)
    return found if found in (CONVERGED, WRONG) else f"{word}, bounds hold" if found == STOPPED else word


def claim(results: Results) -> Verdict:
    """Of certified solvers: every row has an interval, and none is wrong."""
    rows = [row for row in range(len(results.cases)) if results.cases.certified[row]]
    ill = [row for row in rows if outcome(results, row) in (WRONG, NO_BOUNDS)]
    return never_chosen(claims.of("hausbench", "traps"), len(ill), len(rows), "answers")


def make(results: Results) -> Report:
    cases = results.cases
    scenes = results.scenes
    labels = style.order(zip(cases.solver, cases.label))
    rows = {(scene, label): int(found[0]) for scene in scenes for _, label in labels
            if (found := results.rows(scene=scene, label=label))}
    table = tables.Table("How each solver ends on pairs of meshes that are traps: converged to "
                         f"{tables.number(float(cases.tolerance[0]))} of the diagonal of A, or stopped with bounds that hold.",
                         ["pair", "triangles", "h(A,B) / diagonal", *[style.title(*pair) for pair in labels]],
                         left=3 + len(labels))
    records: list[tables.Record] = []
    for scene in scenes:
        first = results.rows(scene=scene)[0]
        table.rows.append([scene, results.sizes(first, " → "), distance(results, first),
                           *[ends(results, rows[scene, label]) if (scene, label) in rows else tables.NOTHING for _, label in labels]])
        table.notes.append(f"{scene}: {cases.scene_note[first]}.")
        records += [{"scene": scene, "solver": solver, "label": label, "outcome": outcome(results, row),
                     "status": cases.status[row], "lower": float(cases.lower[row]), "upper": float(cases.upper[row]),
                     "exact": float(cases.exact[row]), "certified": bool(cases.certified[row]),
                     "solve_seconds": float(cases.solve_seconds[row]), "reason": cases.reason[row]}
                    for solver, label in labels if (row := rows.get((scene, label))) is not None]
    wrong = [f"{record['label']} on {record['scene']} ([{record['lower']:.3g}, {record['upper']:.3g}])"
             for record in records if record["outcome"] == WRONG]
    table.verdicts = [claim(results)]
    table.notes += [f"Wrong: {'; '.join(wrong) or 'none'}. Bounds are wrong where they leave out the true distance (by more than "
                    f"{SLACK:g} of the diagonal), contradict what is proven of it, or cross; and where a certified solver says that it "
                    "has converged and has not. CGAL returns no interval: its answer and the tolerance make one.",
                    f"Each had {tables.number(float(cases.case_seconds_limit[0]))} s.",
                    f"{machine_line(results)}."]
    return Report(lambda: draw(results, scenes, labels, rows), table, records, style.letters_key(results.cases.status), clock=NO_TIMES)


def distance(results: Results, row: int) -> str:
    """'0', or what is proven of it: its first three digits where they are known, the interval otherwise."""
    if results.cases.exact[row] == 0:
        return "0"
    known, diagonal = results.reference_of(row), float(results.cases.source_diagonal[row])
    texts = [tables.number(x / diagonal) for x in (known[0], known[1])]
    return texts[0] if texts[0] == texts[1] else f"{texts[0]} to {texts[1]}"


def draw(results: Results, scenes: list[str], labels: list[tuple[str, str]], rows: dict[tuple[str, str], int]) -> Any:
    """A square a solver and pair, coloured by how it ended, with the time where it converged."""
    names = [name for name, _ in OUTCOMES]
    codes = np.full((len(scenes), len(labels)), np.nan)
    figure, ax = plt.subplots(figsize=(style.SINGLE_COLUMN if len(labels) <= 6 else style.DOUBLE_COLUMN, 1.5 + 0.17 * len(scenes)))
    for i, scene in enumerate(scenes):
        for j, (_, label) in enumerate(labels):
            row = rows.get((scene, label))
            if row is None:
                continue
            codes[i, j] = names.index(outcome(results, row))
            status = results.cases.status[row]
            letter = style.status_letter(status) if status != "ok" else "" if codes[i, j] == 0 else "!"
            ax.text(j, i, letter, ha="center", va="center", fontsize=6, color="#222222")
    ax.imshow(codes, cmap=ListedColormap([colour for _, colour in OUTCOMES]), vmin=-0.5, vmax=len(OUTCOMES) - 0.5, aspect="auto")
    ax.set_xticks(range(len(labels)), [style.title(*pair) for pair in labels], rotation=40, ha="right", rotation_mode="anchor")
    ax.set_yticks(range(len(scenes)), scenes)
    ax.set_xticks(np.arange(0.5, len(labels)), minor=True)
    ax.set_yticks(np.arange(0.5, len(scenes)), minor=True)
    ax.grid(False)
    ax.grid(which="minor", color="white", linewidth=1)
    ax.tick_params(which="both", length=0)
    for spine in ax.spines.values():
        spine.set_visible(False)
    words = {CONVERGED: "converged", STOPPED: "stopped, bounds hold", NO_BOUNDS: "no bounds", WRONG: "wrong"}
    style.legend_above(figure, [plt.Rectangle((0, 0), 1, 1, color=colour, label=words[name]) for name, colour in OUTCOMES], columns=2)
    return figure
