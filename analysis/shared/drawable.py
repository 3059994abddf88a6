"""Makes text from results safe to draw with matplotlib, which would read '$' as a formula, leave
out legend labels that begin with '_', and draw a box for each letter that the font lacks.
"""

from __future__ import annotations

import re
import weakref
from functools import cache
from typing import Any, Final

import matplotlib
import matplotlib.axes
import matplotlib.font_manager
import matplotlib.text
import matplotlib.ticker

from analysis.shared.printable import printable, spelled

_done: Final = weakref.WeakSet[
    Any
]()  # make_drawable() skips these: formulas, texts and formatters changed before
_POWER: Final = re.compile(r"\$10\^\{-?\d+\}\$")  # a tick label of a logarithmic axis


@cache
def _glyphs() -> frozenset[int]:
    font = matplotlib.font_manager.findfont(
        matplotlib.font_manager.FontProperties(family=matplotlib.rcParams["font.family"])
    )
    return frozenset(matplotlib.font_manager.get_font(font).get_charmap())


def drawable(text: str) -> str:
    """Returns the text with its dollar signs escaped, and '<U+4E2D>' for a letter that the font of
    figures lacks."""
    if _POWER.fullmatch(text):
        return text
    return spelled(
        printable(text, lines=True), lambda letter: letter == "\n" or ord(letter) in _glyphs()
    ).replace("$", r"\$")


def legend_label(text: str) -> str:
    """Returns the text as the label of a line; matplotlib leaves labels that begin with '_' out of
    legends."""
    return f" {text}" if text.startswith("_") else text


def _drawable_labels(inner: Any) -> Any:
    """Returns a formatter that passes the tick labels of another one through drawable()."""
    return matplotlib.ticker.FuncFormatter(lambda x, pos: drawable(inner(x, pos)))


def as_formula(text: Any) -> None:
    """Excludes a text from make_drawable(), so that matplotlib still reads '$...$' in it as a
    formula."""
    _done.add(text)


def make_drawable(artist: Any) -> None:
    """Applies drawable() to all texts of a figure or a part of it, except those passed to
    as_formula()."""
    for text in set(artist.findobj(matplotlib.text.Text)) - set(_done):
        text.set_text(drawable(text.get_text()))
        _done.add(text)
    for ax in artist.findobj(matplotlib.axes.Axes):
        for axis in (ax.xaxis, ax.yaxis):
            named = axis.get_major_formatter()
            if (
                isinstance(
                    named, (matplotlib.ticker.FixedFormatter, matplotlib.ticker.FuncFormatter)
                )
                and named not in _done
            ):
                axis.set_major_formatter(_drawable_labels(named))
                _done.add(axis.get_major_formatter())
