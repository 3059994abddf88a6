"""Figure 7 of Tang et al. 2009: the models that we use in place of the paper's."""

from __future__ import annotations

from typing import Any, Final

import matplotlib.pyplot as plt
import numpy as np

from analysis.shared import numerals, style, tables
from analysis.shared.notes import machine_line
from analysis.shared.report import NO_TIMES, Report
from analysis.shared.results import Results
from analysis.tang2009 import tang_pictures

PAPER: Final = {
    "Bird1": "2.2K",
    "Bird2": "6.2K",
    "Watch1": "3.8K",
    "Watch2": "38.1K",
    "Puma1": "8.2K",
    "Puma2": "7.1K",
    "Bunny1": "16.7K",
    "Bunny2": "69.7K",
    "Fish1": "11K",
    "Fish2": "36.5K",
    "Dog": "3.2K",
    "Lion": "1.3M",
}


def make(results: Results) -> Report:
    cases = results.cases
    scenes = [results.rows(scene=scene)[0] for scene in results.scenes]
    note = dict(zip(results.models.name, results.models.note))
    table = tables.Table(
        "The models of Fig. 7 of Tang et al. 2009 and their stand-ins, all centred and of one size.",
        ["model", "stands in", "triangles", "paper", "H of the pair, % of A's longest side"],
        left=2,
    )
    records: list[tables.Record] = []
    for row in scenes:
        table.rules.add(len(table.rows))
        distance = numerals.bounds(
            *results.reference_of(row), 5, times=100, over=float(cases.source_longest[row])
        )
        for i, (name, model, count) in enumerate(
            zip(
                cases.scene[row].split("/"),
                (cases.source[row], cases.target[row]),
                (cases.source_elements[row], cases.target_elements[row]),
            )
        ):
            table.rows.append(
                [
                    name,
                    str(model),
                    f"{count:,}",
                    PAPER.get(name, numerals.NOTHING),
                    distance if i == 0 else "",
                ]
            )
            records.append(
                {
                    "model": name,
                    "stand_in": str(model),
                    "triangles": int(count),
                    "note": str(note.get(model, "")),
                    "lower": float(cases.lower[row]),
                    "upper": float(cases.upper[row]),
                }
            )
    table.notes = [
        "The paper's models are not public, except for Bunny2, which has the triangles of a public bunny. The distance is measured with both "
        "models of the pair centred.",
        f"Here: {machine_line(results)}.",
    ]
    return Report(lambda: draw(results, scenes), table, records, clock=NO_TIMES)


def draw(results: Results, scenes: list[int]) -> Any:
    """Draws one column per pair, A above B."""
    cases = results.cases
    figure, axes = plt.subplots(
        2, max(1, len(scenes)), figsize=(style.DOUBLE_COLUMN, 3.3), squeeze=False
    )
    for column, row in zip(axes.T, scenes):
        stand_ins = tang_pictures.stand_ins(results, row)
        for i, (ax, model, name, count) in enumerate(
            zip(
                column,
                (cases.source[row], cases.target[row]),
                cases.scene[row].split("/"),
                np.array([cases.source_elements[row], cases.target_elements[row]]),
            )
        ):
            tang_pictures.draw_model(ax, results, str(model), i)
            ax.set_title(
                "\n".join(
                    filter(
                        None, [name, stand_ins[i] and f"({stand_ins[i]})", f"{count:,} triangles"]
                    )
                ),
                fontsize=6.5,
            )
    return figure
