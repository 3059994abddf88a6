"""Fits a LaTeX table to a page: chooses font size, columns with line breaks, orientation, and the
number of blocks and pages.

Widths are estimated from the letter widths of Computer Modern, so writing a table does not need
LaTeX. A wide table is split into blocks: groups of columns that are printed below each other.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from analysis.shared.tex import tex_escape

POINTS: Final = 72.27  # LaTeX points per inch
PAGE_WIDTH: Final = 7.16 * POINTS
PAGE_HEIGHT: Final = 9.2 * POINTS
GAP: Final = 4.0  # \tabcolsep
SPARE: Final = 1.03  # estimated widths are multiplied by this, to be safe
CROWDED: Final = 1.7  # cells are wrapped only if the table is at most this many times too wide
AROUND: Final = 130.0  # points reserved for a caption and 120 words of notes
# For each font size, in points: the height of a line and the width of 1 em.
SIZES: Final = {
    "small": (11.0, 9 * 1.027),
    "footnotesize": (9.5, 8 * 1.0625),
    "scriptsize": (8.0, 7 * 1.138),
}
_BY_WIDTH: Final = {
    278: "il.,:;[]!|'",
    306: "fj",
    333: "- ",
    394: 'rst()`I"',
    444: "cez",
    500: "ago0123456789/_?*#$",
    528: "kvxy",
    556: "bdhnpquJS",
    653: "LF",
    681: "EP",
    750: "wABCRTUVXYZ&",
    785: "DGHKNOQ+=<>~^@",
    917: "mM%",
    1028: "W",
}
_WIDTHS: Final = {letter: width for width, letters in _BY_WIDTH.items() for letter in letters}

Block = dict[
    int, float | None
]  # columns of a block: width in points of a column that wraps, None for others


def text_width(text: str, size: str) -> float:
    """Estimates the width of a text in points."""

    def of(letter: str) -> float:
        return _WIDTHS.get(letter) or (
            3200 if "texttt" in tex_escape(letter) else 1000 if letter == "—" else 778
        )

    return sum(map(of, text)) * SIZES[size][1] / 1000


def unbroken(text: str) -> str:
    """Returns the text with non-breaking spaces inside brackets, so that no interval is split
    between two lines.

    Text of 40 or more letters is returned unchanged.
    """
    inside, letters = 0, []
    for letter in text:
        inside += (letter == "[") - (letter == "]" and inside > 0)
        letters.append("\u00a0" if letter == " " and inside else letter)
    joined = "".join(letters)
    return joined if len(joined) < 40 else text


@dataclass(frozen=True)
class Layout:
    """How a table is printed."""

    size: str
    sideways: bool
    long: bool
    blocks: list[Block]

    @property
    def wraps(self) -> bool:
        return any(width is not None for block in self.blocks for width in block.values())


def _shared(natural: Sequence[float], least: Sequence[float], room: float) -> list[float] | None:
    """Returns column widths that fit into `room`. If necessary, cuts the widest columns to a common
    width, but not below `least`.

    Returns None if even the least widths do not fit.
    """
    if sum(natural) <= room:
        return list(natural)
    if sum(least) > room:
        return None
    low, high = 0.0, max(natural)
    for _ in range(40):
        middle = (low + high) / 2
        total = sum(min(x, max(y, middle)) for x, y in zip(natural, least))
        low, high = (middle, high) if total <= room else (low, middle)
    return [min(x, max(y, low)) for x, y in zip(natural, least)]


def _lines(text: str, width: float, size: str) -> int:
    """Returns the number of lines that a text takes if wrapped at `width` points."""
    count, at, space = 1, 0.0, text_width(" ", size)
    for word in unbroken(text).split(" "):
        wide = text_width(word, size)
        if at and at + space + wide > width:
            count, at = count + 1, wide
        else:
            at += (space if at else 0) + wide
    return count


@dataclass(frozen=True)
class Cells:
    """The rows of a table (the header is the first), with the widths that its columns need at one
    font size."""

    size: str
    rows: Sequence[Sequence[str]]
    natural: list[float]
    least: list[float]

    @staticmethod
    def of(rows: Sequence[Sequence[str]], size: str) -> Cells:
        columns = list(zip(*rows))
        natural, least = [], []
        for cells in columns:
            words = [word for cell in cells for word in unbroken(cell).split(" ")]
            natural.append(max(text_width(cell, size) for cell in cells) * SPARE)
            least.append(max(text_width(word, size) for word in words) * SPARE)
        return Cells(size, rows, natural, least)

    def height(self, columns: Sequence[int], widths: Sequence[float]) -> float:
        lines = 0
        for row in self.rows:
            lines += max(
                _lines(row[i], width, self.size) if width < self.natural[i] else 1
                for i, width in zip(columns, widths)
            )
        return lines * SIZES[self.size][0] * 1.05 + 12


def _block(cells: Cells, columns: list[int], room: float) -> list[float] | None:
    natural = [cells.natural[i] for i in columns]
    least = [cells.least[i] for i in columns]
    return _shared(natural, least, room - 2 * GAP * (len(columns) - 1))


def _set(cells: Cells, blocks: list[list[int]], sideways: bool) -> Layout | None:
    """Returns the layout of these blocks of columns; None if a block is too wide for the page."""
    room, page = (PAGE_HEIGHT, PAGE_WIDTH) if sideways else (PAGE_WIDTH, PAGE_HEIGHT)
    fitted: list[Block] = []
    height = 0.0
    for columns in blocks:
        widths = _block(cells, columns, room)
        if widths is None:
            return None
        height += cells.height(columns, widths) + 10
        fitted.append(
            {
                i: width if width < cells.natural[i] - 0.01 else None
                for i, width in zip(columns, widths)
            }
        )
    return Layout(cells.size, sideways, height > page - AROUND, fitted)


def _split(cells: Cells, kept: int, parts: Sequence[int]) -> list[list[int]]:
    """Splits the columns into blocks that fit an upright page. Each block repeats the first `kept`
    columns.

    Splits before the columns in `parts` if that fits, else into as few blocks of similar size as
    possible.
    """
    first, others = list(range(kept)), len(cells.natural) - kept
    tried = [[*parts, kept + others]] if parts else []
    for count in range(2, others + 1):
        tried.append([kept + round(others * i / count) for i in range(count + 1)])
    for ends in tried:
        blocks = [first + list(range(low, high)) for low, high in zip(ends, ends[1:])]
        if all(_block(cells, block, PAGE_WIDTH) for block in blocks):
            return blocks
    return [list(range(len(cells.natural)))]


def layout(
    header: Sequence[str], rows: Sequence[Sequence[str]], left: int, parts: Sequence[int] = ()
) -> Layout:
    """Returns the first layout that fits: upright, upright with wrapped cells, sideways, or upright
    in several blocks.

    `parts` are the columns at which blocks begin; columns before the first of them are repeated in
    each block. Without `parts`, the `left` columns of text are repeated.
    """
    texts = [header, *rows]
    measured = {size: Cells.of(texts, size) for size in SIZES}
    everything = [list(range(len(header)))]
    upright = [_set(measured[size], everything, False) for size in ("small", "footnotesize")]
    if plain := next(
        (candidate for candidate in upright if candidate and not candidate.wraps), None
    ):
        return plain
    for size, sideways in (
        ("footnotesize", False),
        ("scriptsize", False),
        ("footnotesize", True),
        ("scriptsize", True),
    ):
        fitting = _set(measured[size], everything, sideways)
        if fitting and sum(measured[size].natural) < CROWDED * (
            PAGE_HEIGHT if sideways else PAGE_WIDTH
        ):
            return fitting
    kept = parts[0] if parts else left if left < len(header) else 1
    several = [
        _set(measured[size], _split(measured[size], kept, parts), False)
        for size in ("footnotesize", "scriptsize")
    ]
    few = min(
        (candidate for candidate in several if candidate),
        key=lambda candidate: len(candidate.blocks),
        default=None,
    )
    return few or Layout("scriptsize", False, True, [dict.fromkeys(everything[0])])
