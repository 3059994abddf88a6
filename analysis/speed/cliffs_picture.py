"""The figure of `cliffs`: a panel for each family of scenes."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Any, Final

import matplotlib.pyplot as plt
from matplotlib.lines import Line2D

from analysis.shared import scales, style
from analysis.speed.cliffs_curves import ANSWERED, FAMILIES, MOST, Curves, Row, relative

ACROSS: Final = 4
WIDE: Final = 1.46  # inches: width of a frame (TALL: height)
TALL: Final = 0.92

# Some frames show solvers of point sets and of meshes, which may share colours elsewhere. Here they
# get other ones.
_OTHER: Final = {"scan": ("#332288", (0, (4, 1.5, 1, 1.5)))}
_SPLIT: Final = "#117733"  # Guthe's algorithm with another way to split


def look(solver: str, label: str) -> style.Look:
    """Returns the look of a solver in this figure."""
    usual = style.look(solver, label)
    if solver in _OTHER and label == solver:
        colour, line = _OTHER[solver]
        return replace(usual, colour=colour, line=line)
    return replace(usual, colour=_SPLIT) if solver == "guthe" and label != solver else usual


def draw(curves: Curves, labels: Sequence[tuple[str, str]]) -> Any:
    """Draws a panel per family: work above, time below, over the ratio. Frames in a row share their
    scale.

    Frames are placed in inches, without a layout engine, and the legend below them.
    """
    deep = 0.2 + 2 * TALL + 0.06 + 0.36
    height = deep * -(-len(FAMILIES) // ACROSS) + 0.14 * -(-len(labels) // ACROSS) + 0.4
    figure = plt.figure(figsize=(style.DOUBLE_COLUMN, height))
    figure.set_layout_engine("none")
    keys = list(FAMILIES)
    bands = [keys[i : i + ACROSS] for i in range(0, len(keys), ACROSS)]
    limits = []
    for band in bands:
        in_band = [rows for (key, _), rows in curves.items() if key in band]
        limits.append({measure: scale_of(in_band, measure) for measure in ("work", "seconds")})
    statuses: set[str] = set()
    for i, (key, family) in enumerate(FAMILIES.items()):
        left, floor = (
            0.52 + (i % ACROSS) * (WIDE + 0.2),
            height - (i // ACROSS) * deep - 0.26 - 2 * TALL,
        )
        by_label = {label: curves[key, label] for _, label in labels if (key, label) in curves}
        for measure, bottom in (("work", floor + TALL + 0.06), ("seconds", floor)):
            ax = figure.add_axes(
                (
                    left / style.DOUBLE_COLUMN,
                    bottom / height,
                    WIDE / style.DOUBLE_COLUMN,
                    TALL / height,
                )
            )
            statuses |= draw_frame(ax, by_label, labels, measure, limits[i // ACROSS][measure])
            if i % ACROSS == 0:
                ax.set_ylabel({"work": "relative work", "seconds": "relative time"}[measure])
                ax.yaxis.set_label_coords(-0.26, 0.5)
            else:
                ax.tick_params(labelleft=False)
            if measure == "work":
                ax.set_title(family.title, pad=3)
                ax.tick_params(labelbottom=False)
            else:
                ax.set_xlabel(family.axis, labelpad=1)
    add_legend(figure, labels, statuses, height)
    return figure


def scale_of(curves: Sequence[Sequence[Row]], measure: str) -> tuple[float, float]:
    """Returns the limits of the vertical axis for a row of frames, with space at the top for
    letters."""
    values = [x for rows in curves for x in relative(rows, measure) if math.isfinite(x) and x > 0]
    low, high = min([0.5, *values]) / 1.3, max([MOST * 2, *values])
    return low, high * (high / low) ** 0.2


def draw_frame(
    ax: Any,
    by_label: dict[str, list[Row]],
    labels: Iterable[tuple[str, str]],
    measure: str,
    limits: tuple[float, float],
) -> set[str]:
    """Draws a line per solver, and at the top a letter for each case without an answer.

    Returns the statuses that these letters stand for.
    """
    ax.set_xscale("log")
    ax.set_yscale("log")
    ax.set_ylim(*limits)
    ax.axhline(MOST, color=style.GREY, linewidth=0.6, linestyle=(0, (4, 2)), zorder=1)
    ratios = sorted({row.ratio for rows in by_label.values() for row in rows})
    lost: Counter[float] = Counter()
    statuses: set[str] = set()
    for solver, label in labels:
        if label not in by_label:
            continue
        rows, looks = by_label[label], look(solver, label)
        points = [
            (row.ratio, y, row.status)
            for row, y in zip(rows, relative(rows, measure))
            if math.isfinite(y)
        ]
        ratios_drawn = [x for x, _, _ in points]
        values = [y for _, y, _ in points]
        ax.plot(
            ratios_drawn, values, color=looks.colour, linestyle=looks.line, linewidth=0.9, zorder=3
        )
        for x, y, status in points:
            ax.plot(
                [x],
                [y],
                zorder=4,
                clip_on=False,
                **(style.filled_marker(looks) if status == "ok" else style.open_marker(looks))
                | {"markersize": 0.75 * looks.size},
            )
        for row in rows:
            if row.status not in ANSWERED:
                letter_of_panel = (
                    9 if measure == "seconds" and row.ratio == ratios[0] else 0
                )  # in points, below the panel's letter
                statuses.add(row.status)
                ax.annotate(
                    style.status_letter(row.status),
                    (row.ratio, 1),
                    (0, -4.5 - letter_of_panel - 6 * lost[row.ratio]),
                    xycoords=("data", "axes fraction"),
                    textcoords="offset points",
                    ha="center",
                    va="center",
                    fontsize=6,
                    fontweight="bold",
                    color=looks.colour,
                    annotation_clip=False,
                )
                lost[row.ratio] += 1
    if ratios:
        ax.set_xlim(
            ratios[0] / 1.3 ** math.log10(10 * ratios[-1] / ratios[0]),
            ratios[-1] * 1.3 ** math.log10(10 * ratios[-1] / ratios[0]),
        )
    scales.log_ticks(ax.xaxis)
    scales.log_ticks(ax.yaxis)
    if ratios and ratios[-1] / ratios[0] < 100:  # few values, such as degrees: a tick for each
        ax.set_xticks(ratios, [f"{x:g}" for x in ratios])
    elif ratios and ratios[0] == 1:
        ax.set_xticks([1, 1e4, 1e8, 1e12])
    return statuses


def add_legend(
    figure: Any, labels: Sequence[tuple[str, str]], statuses: set[str], height: float
) -> None:
    handles = []
    for solver, label in labels:
        looks = look(solver, label)
        marker = style.filled_marker(looks) | {"linestyle": looks.line, "linewidth": 0.9}
        handles.append(Line2D([], [], label=looks.entry, **marker))
    legend = figure.legend(
        handles=handles,
        loc="lower center",
        bbox_to_anchor=(0.5, 0.24 / height),
        ncols=ACROSS,
        handlelength=2.2,
        borderaxespad=0,
        fontsize=6.5,
    )
    legend.set_in_layout(False)
    key = style.letters_key(statuses)
    notes = [
        f"Each line is relative to its first point. Dashed: {MOST:g} times that.",
        "Open markers: precision floor.",
        *([f"Letters: no answer ({key})."] if key else []),
    ]
    figure.text(
        0.5, 0.04 / height, "  ".join(notes), ha="center", va="bottom", fontsize=7, color=style.GREY
    )
