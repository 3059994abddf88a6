"""Kind `performance-profile` (Dolan and Moré 2002): the share of cases that each solver answers
within a factor of the fastest."""

from __future__ import annotations

import math
from typing import Any

import matplotlib.pyplot as plt
import numpy as np

from analysis.shared import numerals, scales, style, tables
from analysis.shared.cells import Cell
from analysis.shared.columns import Floats
from analysis.shared.comparable import reason_apart
from analysis.shared.notes import machine_line, total_word
from analysis.shared.report import Report
from analysis.shared.results import Results
from analysis.views.answers import measured

SHOWN = (1.0, 2.0, 10.0)  # factors in the printed table


def factors(results: Results) -> dict[tuple[str, str], Floats]:
    """Returns for each (solver, name) its time / the least time of all solvers, one value per
    question.

    It is infinite if the solver failed, and NaN if it was not run or does not accept the shapes.
    Questions are left out if times are not comparable or a time is 0.
    """
    pairs = style.order(zip(results.cases.solver, results.names))
    columns = []
    for by_name in measured(results).values():
        if reason_apart(
            frozenset[Any]().union(*[cell.origins for cell in by_name.values() if cell.time.n])
        ):
            continue
        costs = np.array([cost(results, by_name.get(name)) for _, name in pairs])
        if np.isfinite(costs).any() and np.nanmin(costs) > 0:
            columns.append(costs / np.nanmin(costs))
    return dict(zip(pairs, np.array(columns).T)) if columns else {}


def too_short(results: Results) -> list[str]:
    """Returns a note on the questions that are left out because a time is 0."""
    count = sum(
        any(cell.time.value == 0 for cell in by_name.values())
        for by_name in measured(results).values()
    )
    return (
        [
            f"{count} {'cases are' if count > 1 else 'case is'} left out: a time is 0, too short for the clock."
        ]
        if count
        else []
    )


def cost(results: Results, cell: Cell | None) -> float:
    if cell is None or all(
        results.cases.status[row] in ("skipped", "not_built") for row in cell.rows
    ):
        return math.nan
    return cell.time.value if cell.time.n else math.inf


def shares(values: Floats, factor: float) -> float:
    """Returns the share of its questions that a solver answers within `factor` of the fastest; NaN
    if it has none."""
    asked = values[~np.isnan(values)]
    return float((asked <= factor).mean()) if len(asked) else math.nan


def make(results: Results) -> Report | None:
    """Returns None for fewer than two solvers or cases."""
    found = factors(results)
    if len(found) < 2 or len(next(iter(found.values()))) < 2:
        return None
    cases = len(next(iter(found.values())))
    table = tables.Table(
        f"{results.meta.get('title') or results.stem}: the share of the {cases} cases that each solver answers within a factor of the "
        "fastest, among those whose shapes it takes.",
        ["solver", "cases", *[f"within {factor:g}" for factor in SHOWN], "answered"],
        left=1,
    )
    records: list[tables.Record] = []
    for pair, values in found.items():
        table.rows.append(
            [
                style.title(*pair),
                f"{np.count_nonzero(~np.isnan(values))}",
                *[
                    numerals.NOTHING if math.isnan(share) else f"{100 * share:.0f} %"
                    for share in (shares(values, factor) for factor in (*SHOWN, 1e300))
                ],
            ]
        )
        records += [
            {
                "solver": pair[0],
                "name": pair[1],
                "factor": float(value),
                "share": shares(values, float(value)),
            }
            for value in np.unique(values[np.isfinite(values)])
        ]
    table.notes = [
        f"A case is a scene, a pose and a tolerance; medians of {total_word(results)}. A profile of few cases says little, and it "
        "depends on which solvers take part.",
        *too_short(results),
        f"Measured on {machine_line(results)}.",
    ]
    return Report(lambda: draw(found), table, records)


def draw(found: dict[tuple[str, str], Floats]) -> Any:
    figure, ax = plt.subplots(figsize=(style.width(), 3.0))
    most = max(float(values[np.isfinite(values)].max(initial=1.0)) for values in found.values())
    entries = []
    for pair, values in found.items():
        looks, known = style.look(*pair), np.sort(values[np.isfinite(values)])
        x = np.concatenate([[1.0], known, [1.2 * max(most, 2.0)]])
        asked = np.count_nonzero(~np.isnan(values))
        if not asked:
            continue
        y = np.concatenate(
            [[shares(values, 1)], np.arange(1, len(known) + 1) / asked, [len(known) / asked]]
        )
        entries += ax.step(
            x,
            y,
            where="post",
            color=looks.colour,
            linestyle=looks.line,
            linewidth=1.2,
            label=looks.entry,
        )
    ax.set_xscale("log")
    ax.set(
        xlim=(1.0, 1.2 * max(most, 2.0)),
        ylim=(-0.02, 1.02),
        xlabel="time / least time of all solvers",
        ylabel="share of its cases",
    )
    scales.log_ticks(ax.xaxis)
    style.legend_above(figure, entries, columns=5, room=True)
    return figure
