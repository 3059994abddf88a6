"""Letters for the panels of a figure, (a), (b), ..., from the top left to the bottom right."""

from __future__ import annotations

import re
from string import ascii_lowercase
from typing import Any, Final

import matplotlib.layout_engine

STRIP: Final = 0.35  # inches: axes less high than this belong to another panel and get no letter
ROW: Final = 0.3  # inches: panels whose tops differ by less are in one row
LETTERS: Final = [
    *ascii_lowercase,
    *[first + second for first in ascii_lowercase for second in ascii_lowercase],
]
_LETTERED: Final = re.compile(r"^\(([a-z]{1,2})\)")


def panels(figure: Any) -> list[Any]:
    """Returns the axes that count as panels, row by row: no colour bars, twin axes, strips or empty
    axes."""
    by_box: dict[tuple[float, ...], Any] = {}
    for ax in figure.get_axes():
        shows = ax.axison or ax.get_title() or ax.lines or ax.collections or ax.patches or ax.images
        high = ax.get_window_extent().height > STRIP * figure.dpi
        if ax.get_visible() and ax.get_label() != "<colorbar>" and shows and high:
            by_box.setdefault(tuple(round(x) for x in ax.get_window_extent().bounds), ax)

    def place(ax: Any) -> tuple[int, float]:
        box = ax.get_window_extent()
        return -round(box.y1 / (ROW * figure.dpi)), box.x0

    return sorted(by_box.values(), key=place)


def add_letters(figure: Any) -> None:
    """Adds a letter to each panel if there are several; a title that begins with "(a)" keeps its
    letter.

    The letter goes before the title, or above the top left corner of a panel without a title.
    Without a layout engine to make room, it goes inside that corner.
    """
    axes = panels(figure)
    room = figure.get_layout_engine() is not None and not isinstance(
        figure.get_layout_engine(), matplotlib.layout_engine.PlaceHolderLayoutEngine
    )
    taken = {match[1] for ax in axes if (match := _LETTERED.match(ax.get_title()))}
    free = (letter for letter in LETTERS if letter not in taken)
    for ax in axes if len(axes) > 1 else []:
        if _LETTERED.match(ax.get_title()):
            continue
        letter = f"({next(free)})"
        if ax.get_title():
            ax.title.set_text(f"{letter} {ax.get_title()}")
        elif room:
            ax.set_title(letter, loc="left")
        else:
            ax.annotate(
                letter,
                (0, 1),
                (3, -3),
                xycoords="axes fraction",
                textcoords="offset points",
                ha="left",
                va="top",
                fontsize=7,
                zorder=9,
                bbox={
                    "boxstyle": "square,pad=0.1",
                    "facecolor": "white",
                    "edgecolor": "none",
                    "alpha": 0.7,
                },
            )
