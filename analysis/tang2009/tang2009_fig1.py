"""Figure 1 of Tang et al. 2009: pairs and frames of dynamic scenes, with the points that attain
distance or depth."""

from __future__ import annotations

from typing import Any, Final

import matplotlib.pyplot as plt

from analysis.shared import numerals, style, tables
from analysis.shared.mesh_picture import View, view
from analysis.shared.notes import machine_line
from analysis.shared.report import NO_TIMES, Report
from analysis.shared.results import Results
from analysis.tang2009 import tang_pictures

VIEWS: Final[dict[str, View]] = {
    "Alphabet Domino": view((1, -1.2, 1.6), (0, 0, 1)),
    "Falling Bunnies": view((0.4, -1, 0.7), (0, 0, 1)),
}


def group(results: Results, row: int) -> str:
    """Returns the scene of a row; for a frame of a recording, the name of the recording."""
    name: str = results.cases.scene[row]
    return name.partition(": ")[0] if int(results.cases.frame[row]) >= 0 else name


def make(results: Results) -> Report:
    cases = results.cases
    groups: dict[str, list[int]] = {}
    for row in range(len(cases)):
        groups.setdefault(group(results, row), []).append(row)
    table = tables.Table(
        "The two-sided distance of three pairs, and the deepest pair of points in one frame of each dynamic scene (Fig. 1 of Tang et al. "
        "2009), in percent of A's longest side.",
        ["scene", "", "what", "pairs", "lower", "upper"],
        left=3,
    )
    records: list[tables.Record] = []
    for name, rows in groups.items():
        table.rules.add(len(table.rows))
        for i, label in enumerate(results.in_order("label", rows)):
            labelled = [row for row in rows if cases.label[row] == label]
            bounded = [row for row in labelled if results.is_bounded(row)]
            deepest = max(
                bounded or labelled,
                key=lambda row: float(cases.lower[row] / cases.source_longest[row])
                if row in bounded
                else 0.0,
            )
            longest = float(cases.source_longest[deepest])
            quantity = (
                "H"
                if int(cases.frame[deepest]) < 0
                else f"depth, frame {int(cases.frame[deepest])}"
            )
            table.rows.append(
                [
                    name if i == 0 else "",
                    style.title(cases.solver[deepest], str(label)),
                    quantity,
                    f"{len(bounded)} of {len(labelled)}",
                    numerals.at_least(cases.lower[deepest], 7, times=100, over=longest),
                    numerals.at_most(cases.upper[deepest], 7, times=100, over=longest),
                ]
            )
        records += [
            {
                "scene": name,
                "label": cases.label[row],
                "frame": int(cases.frame[row]),
                "source": cases.source[row],
                "target": cases.target[row],
                "status": cases.status[row],
                "lower": float(cases.lower[row]),
                "upper": float(cases.upper[row]),
                "longest": float(cases.source_longest[row]),
            }
            for row in rows
        ]
    notes = dict.fromkeys(
        f"{cases.scene[rows[0]]}: {cases.scene_note[rows[0]]}"
        for rows in groups.values()
        if cases.scene_note[rows[0]]
    )
    table.notes = [
        "For a frame: the pair of objects that penetrate each other most deeply. Tolerance 1e-4 of A's longest side.",
        "The paper's models and motions are not public. "
        + "; ".join(notes)
        + ". The dynamic scenes were simulated with Bullet.",
        f"Here: {machine_line(results)}.",
    ]
    caption = (
        "The two-sided distance of three pairs, with the two points that attain it and the line between them in green; and a frame of each dynamic "
        "scene, with the deepest pair of points of every two objects that overlap, so close together that they look like one green dot (Fig. 1 of "
        "Tang et al. 2009). A is blue and B is beige; in a frame, the colours alternate between objects, and objects that overlap no other are not "
        "drawn. Other models stand in for the paper's, as the titles say; the dynamic scenes were simulated with Bullet."
    )
    return Report(lambda: draw(results, groups), table, records, clock=NO_TIMES, caption=caption)


def draw(results: Results, groups: dict[str, list[int]]) -> Any:
    """Draws the pairs above and the frames below."""
    frames = {name: rows for name, rows in groups.items() if int(results.cases.frame[rows[0]]) >= 0}
    pairs = []
    for name, rows in groups.items():
        if name not in frames:
            pairs.append(next((row for row in rows if results.is_bounded(row)), rows[0]))
    figure = plt.figure(figsize=(style.DOUBLE_COLUMN, 4.6))
    upper, lower = figure.subfigures(2, 1, height_ratios=(1, 1.1))
    for ax, row in zip(upper.subplots(1, max(1, len(pairs)), squeeze=False).flat, pairs):
        tang_pictures.draw_pair(ax, results, row)
        ax.set_title(tang_pictures.title(results, row))
    for ax, (name, rows) in zip(
        lower.subplots(1, max(1, len(frames)), squeeze=False).flat, frames.items()
    ):
        tang_pictures.draw_frame(
            ax,
            results,
            [row for row in rows if results.is_bounded(row)],
            VIEWS.get(name, tang_pictures.SIDE),
        )
        ax.set_title(f"{name}, frame {int(results.cases.frame[rows[0]])}")
    return figure
