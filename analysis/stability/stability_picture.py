"""Draws the matrix of outcomes: one figure per kind of shape, one cell per family and solver, one
strip in it per severity."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

import matplotlib.pyplot as plt
from matplotlib.patches import Rectangle

from analysis.shared import style
from analysis.stability.stability_families import KINDS, Family, Label, Suite, look, range_text
from analysis.stability.stability_outcomes import STOPS, Outcome

# In inches; without a layout engine, so that cells have the same size in all bands.
WIDE: Final = style.DOUBLE_COLUMN
LEFT: Final = 1.42  # for the names of families
RIGHT: Final = 0.62  # for their severities
ROW: Final = 0.138
HEAD: Final = 0.86  # for the names of solvers
GAP: Final = 0.06  # between cells, as a fraction of a cell
BELOW: Final = 0.6  # width of the first column (see draw_floor), in cells
DARK: Final = "#555555"


def draw(suite: Suite) -> dict[str, Any]:
    """Draws one figure per kind of shape; a single figure would be higher than a page."""
    return {kind: draw_kind(suite, kind) for kind in KINDS if suite.of_kind(kind)}


def draw_kind(suite: Suite, kind: str) -> Any:
    families, labels = suite.of_kind(kind), suite.labels_of(kind)
    pitch = min(0.46, (WIDE - LEFT - RIGHT) / (len(labels) + BELOW))
    entries = legend(suite, families)
    height = HEAD + ROW * len(families) + 0.12 + 0.16 * -(-len(entries) // 5) + 0.3
    figure = plt.figure(figsize=(WIDE, height))
    figure.set_layout_engine("none")
    wide = pitch * (len(labels) + BELOW)
    ax = figure.add_axes(
        (
            LEFT / WIDE,
            (height - HEAD - ROW * len(families)) / height,
            wide / WIDE,
            ROW * len(families) / height,
        )
    )
    draw_band(ax, suite, families, labels, 72 * pitch)
    figure.text(
        0.05 / WIDE,
        (height - HEAD + 0.09) / height,
        kind[0].upper() + kind[1:],
        fontsize=9,
        fontweight="bold",
        va="bottom",
    )
    figure.text(
        (LEFT + wide + 0.04) / WIDE,
        (height - HEAD + 0.02) / height,
        "severity\n(no unit)",
        fontsize=6,
        color=style.GREY,
        va="bottom",
    )
    figure.legend(
        handles=entries,
        loc="lower center",
        bbox_to_anchor=(0.5, 0.24 / height),
        ncol=5,
        handlelength=1.4,
        handleheight=1.0,
    )
    figure.text(
        0.5,
        0.04 / height,
        "\n".join(footnote(suite)),
        ha="center",
        va="bottom",
        fontsize=7,
        color=style.GREY,
    )
    return figure


def footnote(suite: Suite) -> list[str]:
    two = any(len(family.tolerances) > 1 for family in suite.families)
    return [
        "Strips: severities, the mildest at the left"
        + ("; in each cell the coarser tolerance above the finer one" if two else "")
        + ". Names in italics: not certified, so bounds may be wrong."
    ]


def legend(suite: Suite, families: Sequence[Family]) -> list[Any]:
    """Returns the legend of the outcomes that these families show."""
    shown = {
        family.mark(label, step, tolerance)
        for family in families
        for _, label in suite.labels_of(family.kind)
        for step in family.steps
        for tolerance in family.tolerances
    }
    words = dict(STOPS.values())
    entries: list[Any] = [
        Rectangle(
            (0, 0),
            1,
            1,
            facecolor=outcome.colour,
            edgecolor="#BBBBBB",
            linewidth=0.4,
            hatch="//////" if outcome == Outcome.NOT_RUN else None,
            label=f"{letter}  {words.get(letter, outcome.words)}" if letter else outcome.words,
        )
        for outcome in reversed(Outcome)
        for letter in dict.fromkeys(("", *words, outcome.letter))
        if (outcome, letter) in shown
    ]
    if any(
        answer.can_be_met is False
        for family in families
        for by_step in family.answers.values()
        for answer in by_step.values()
    ):
        entries.append(
            Rectangle(
                (0, 0), 1, 1, facecolor=DARK, label="first column: tolerance too fine for doubles"
            )
        )
    return entries


def draw_band(
    ax: Any, suite: Suite, families: Sequence[Family], labels: Sequence[Label], pitch: float
) -> None:
    """Draws the cells of these families and solvers. `pitch` is the width of a cell, in points."""
    ax.set_xlim(-BELOW, len(labels))
    ax.set_ylim(len(families), 0)
    for i, family in enumerate(families):
        draw_floor(ax, family, i)
        for j, (_, label) in enumerate(labels):
            draw_cell(ax, family, label, (j, i), pitch)
        ax.text(
            len(labels) + 0.08,
            i + 0.5,
            range_text(family),
            fontsize=6,
            color=style.GREY,
            va="center",
            ha="left",
        )
    row_titles = [family.title for family in families]
    ax.set_yticks([i + 0.5 for i in range(len(families))], row_titles)
    column_titles = [look(*pair).title for pair in labels]
    ax.set_xticks(
        [-BELOW / 2, *[j + 0.5 for j in range(len(labels))]],
        ["below floor", *column_titles],
        rotation=42,
        ha="left",
        rotation_mode="anchor",
    )
    ax.xaxis.tick_top()
    ax.tick_params(length=0, pad=2)
    for text, pair in zip(ax.get_xticklabels(), [None, *labels]):
        text.set_fontsize(6.5)
        if pair is None:
            text.set_color(DARK)
        elif not suite.is_certified(pair[1]):
            text.set_style("italic")
    ax.grid(False)
    for spine in ax.spines.values():
        spine.set_visible(False)


def parts(family: Family, left: float, wide: float) -> list[tuple[Any, float, float, float, float]]:
    """Returns the strips of a cell: ((step, tolerance), left, top, width, height) of each."""
    n, m = len(family.steps), len(family.tolerances)
    across, down = (wide - GAP) / n, (1 - 2 * GAP) / m
    return [
        ((step, tolerance), left + GAP / 2 + k * across, GAP + l * down, across, down)
        for k, step in enumerate(family.steps)
        for l, tolerance in enumerate(family.tolerances)
    ]


def draw_floor(ax: Any, family: Family, i: int) -> None:
    """Draws the first column, which is dark where the tolerance is below the precision of
    doubles."""
    met = {
        key: answer.can_be_met
        for by_step in family.answers.values()
        for key, answer in by_step.items()
        if answer.can_be_met is not None
    }
    for key, x, y, wide, high in parts(family, -BELOW, BELOW):
        colour = {True: "#EEEEEE", False: DARK, None: "#FFFFFF"}[met.get(key)]
        ax.add_patch(
            Rectangle((x, i + y), wide, high, facecolor=colour, edgecolor=colour, linewidth=0.1)
        )


def draw_cell(ax: Any, family: Family, label: str, at: tuple[int, int], pitch: float) -> None:
    """Draws the strips of a cell, with a letter in the middle of each run of equal ones; in narrow
    runs it is smaller."""
    marks = {key: family.mark(label, *key) for key, *_ in parts(family, 0, 1)}
    for key, x, y, wide, high in parts(family, at[0], 1):
        outcome, _ = marks[key]
        ax.add_patch(
            Rectangle(
                (x, at[1] + y),
                wide,
                high,
                facecolor=outcome.colour,
                linewidth=0.1,
                edgecolor="#BBBBBB" if outcome == Outcome.NOT_RUN else outcome.colour,
                hatch="//////" if outcome == Outcome.NOT_RUN else None,
            )
        )
    across = (1 - GAP) / len(family.steps)
    for l, tolerance in enumerate(family.tolerances):
        line = [marks[step, tolerance] for step in family.steps]
        y = at[1] + GAP + (l + 0.5) * (1 - 2 * GAP) / len(family.tolerances)
        for begin, end in runs(line):
            (outcome, letter), points = line[begin], (end - begin) * across * pitch
            x = at[0] + GAP / 2 + (begin + end) / 2 * across
            if letter:
                size = min(6.0 if len(family.tolerances) == 1 else 4.6, max(3.6, 1.25 * points))
                ax.text(
                    x,
                    y,
                    letter,
                    ha="center",
                    va="center_baseline",
                    fontsize=size,
                    color=outcome.ink,
                    fontweight="bold",
                    family="DejaVu Sans",
                )
        for k in range(1, len(line)):  # separates strips of the same colour
            x = at[0] + GAP / 2 + k * across
            ax.plot(
                [x, x],
                [y - 0.5 / len(family.tolerances) + GAP, y + 0.5 / len(family.tolerances) - GAP],
                color="white",
                linewidth=0.25,
                solid_capstyle="butt",
            )


def runs(line: Sequence[object]) -> list[tuple[int, int]]:
    """Returns (begin, end) of each run of equal values."""
    ends = [k for k in range(1, len(line)) if line[k] != line[k - 1]]
    return list(zip([0, *ends], [*ends, len(line)]))
