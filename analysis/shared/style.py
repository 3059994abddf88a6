"""How figures look: one fixed colour, marker and line for each solver, column widths, zeros and failures kept visible.

Colours are those of Okabe and Ito (2008) with a few from Paul Tol's muted set; both can be told apart with every common
kind of colour blindness. There are more solvers than such colours, so a colour returns once, in the other family (point
sets or meshes) and with another marker.
"""

from __future__ import annotations

import os
import textwrap
import zlib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
import numpy.typing as npt  # noqa: E402

SINGLE_COLUMN: Final = 3.5  # inches
DOUBLE_COLUMN: Final = 7.16
GREY: Final = "#666666"

plt.style.use(Path(__file__).with_name("hausbench.mplstyle"))


@dataclass(frozen=True)
class Look:
    title: str
    colour: str
    marker: str
    line: str | tuple[int, tuple[float, ...]] = "-"

    @property
    def size(self) -> float:
        """Marker size; stars and crosses are larger, so that all markers look equally heavy."""
        return {"*": 6.5, "P": 5.0, "X": 5.0, "p": 5.0, "h": 5.0, "d": 5.0}.get(self.marker, 4.2)


# In the order of legends and tables.
LOOKS: Final[dict[str, Look]] = {
    # point sets
    "naive": Look("NAIVEHDD", "#000000", "s"),
    "earlybreak": Look("EARLYBREAK", "#E69F00", "o"),
    "inc": Look("INC", "#56B4E9", "v"),
    "nohd": Look("NOHD", "#009E73", "^", (0, (4, 1.5))),
    "ohd": Look("OHD", "#0072B2", "D", (0, (4, 1.5))),
    "adaptive": Look("NOHD/OHD framework", "#CC79A7", "P"),
    "scan": Look("scan (ours)", "#D55E00", "X"),
    "kdtree": Look("k-d tree (nanoflann)", "#882255", "h", (0, (1, 1))),
    # meshes
    "sampling": Look("sampling", "#CC79A7", "p"),
    "guthe": Look("Guthe 2005", "#999933", "<", (0, (4, 1.5))),
    "tang": Look("Tang 2009", "#56B4E9", "o"),
    "kang": Look("Kang 2018", "#009E73", "s"),
    "zheng": Look("Zheng 2022", "#0072B2", "^"),
    "sacht": Look("Sacht 2024", "#E69F00", "D"),
    "cover": Look("cover (ours)", "#D55E00", "*"),
    "cgal": Look("CGAL", "#882255", "X", (0, (1, 1))),
    # surfaces, other programs
    "interval_subdivision": Look("interval subdivision", "#000000", "d"),
    "surface_enclosure": Look("surface enclosure (ours)", "#D55E00", "h"),
    "surface_meshes": Look("surface meshes (ours)", "#0072B2", "s"),
    "external": Look("external program", "#777777", ">", (0, (4, 1.5, 1, 1.5))),
}

# Letters in figures for rows without bounds.
STATUS_LETTERS: Final = {"timeout": "T", "out_of_memory": "M", "signal": "C", "failed": "F", "unsound": "U",
                         "skipped": "S", "not_built": "N", "floor": "P", "budget": "B"}
STATUS_WORDS: Final = {"timeout": "timeout", "out_of_memory": "out of memory", "signal": "crashed", "failed": "failed",
                       "unsound": "unsound", "skipped": "skipped", "not_built": "not built",
                       "floor": "precision floor", "budget": "budget spent"}


def letters_key(statuses: Iterable[str]) -> str:
    """What the letters of these statuses mean: 'T timeout, B budget spent', or nothing."""
    there = {str(status) for status in statuses}
    return ", ".join(f"{letter} {STATUS_WORDS[status]}" for status, letter in STATUS_LETTERS.items() if status in there)


def look(solver: str, label: str = "") -> Look:
    """Of a solver; a label of its own (a variant) keeps the colour and gets another marker and line. A solver that is
    not listed above is grey, with a marker that depends on its name alone.
    """
    known = LOOKS.get(solver, Look(solver, "#777777", "<>1234+x"[zlib.crc32(solver.encode()) % 8], "--"))
    if label in ("", solver):
        return known
    variant = zlib.crc32(label.encode())
    return Look(label, known.colour, "phd<>8"[variant % 6], ((0, (1, 1)), (0, (6, 2)), (0, (3, 1, 1, 1)))[variant % 3])


def order(pairs: Iterable[tuple[str, str]]) -> list[tuple[str, str]]:
    """Distinct (solver, label) pairs in the order of LOOKS, unknown ones last, by first appearance."""
    place = {name: i for i, name in enumerate(LOOKS)}
    return sorted(dict.fromkeys(pairs), key=lambda pair: place.get(pair[0], len(place)))


def scene_title(scene: str) -> str:
    """'b_cow_hippo' -> '(b) cow, hippo'; other names keep their words."""
    head, _, rest = scene.partition("_")
    if len(head) == 1 and head.isalpha() and rest:
        return f"({head}) {rest.replace('_', ', ')}"
    return scene.replace("_", " ")


class LogAxis:
    """A logarithmic vertical axis on which exact zeros stay visible, in a band of their own below a break.

    Give it every value that will be drawn, then map what is drawn through `place`. Values below 1e-250 are drawn there.
    """

    LEAST: Final = 1e-250

    def __init__(self, ax: Any, values: npt.ArrayLike, most_ticks: int = 6) -> None:
        x = np.asarray(values, dtype=np.float64).ravel()
        x = x[np.isfinite(x)]
        positive = np.maximum(x[x > 0], self.LEAST)
        low = int(np.floor(np.log10(positive.min()))) if len(positive) else -1
        high = int(np.ceil(np.log10(positive.max()))) if len(positive) else 0
        high = max(high, low + 1)
        self.has_zeros = bool((x <= 0).any())
        room = 0.075 * (high - low + 1)  # in decades: half of the band, and free space
        self._zero = 10.0 ** (low - 2.6 * room)
        ax.set_yscale("log")
        ax.minorticks_off()
        if self.has_zeros and not len(positive):  # only zeros: there is no scale
            ax.set_facecolor("#F1F1F1")
            ax.set_yticks([self._zero], ["0"])
            ax.set_ylim(self._zero / 10, self._zero * 10)
            return
        step = max(1, -(-(high - low) // (most_ticks - 1)))
        decades = list(range(high, low - 1, -step))[::-1]
        ticks, labels = [10.0**d for d in decades], [f"$10^{{{d}}}$" for d in decades]
        bottom = 10.0 ** (low - 0.7 * room)
        if self.has_zeros:
            ticks, labels, bottom = [self._zero] + ticks, ["0"] + labels, 10.0 ** (low - 3.9 * room)
            edge = 10.0 ** (low - 1.3 * room)
            ax.axhspan(bottom, edge, color="#F1F1F1", linewidth=0, zorder=0)
            ax.axhline(edge, color="white", linewidth=2.5, zorder=0.5)
            for y in (10.0 ** (low - 1.15 * room), 10.0 ** (low - 1.45 * room)):  # the break, on the axis itself
                ax.plot([-0.02, 0.02], [y, y], transform=ax.get_yaxis_transform(), color="black", linewidth=0.6,
                        clip_on=False, zorder=5)
        ax.set_yticks(ticks, labels)
        ax.set_ylim(bottom, 10.0 ** (high + 0.7 * room))

    def place(self, values: npt.ArrayLike) -> npt.NDArray[np.float64]:
        x = np.asarray(values, dtype=np.float64)
        return np.where(x <= 0, self._zero, np.maximum(x, self.LEAST))


def log_ticks(axis: Any) -> None:
    """Powers of ten, without minor ticks; if fewer than two are in view, also 2 and 5 times them, as plain numbers."""
    low, high = np.log10(sorted(axis.get_view_interval()))
    few = np.floor(high) - np.ceil(low) < 1
    axis.set_minor_locator(matplotlib.ticker.NullLocator())
    axis.set_major_locator(matplotlib.ticker.LogLocator(subs=(1, 2, 5) if few else (1,), numticks=6))
    if few:
        axis.set_major_formatter(matplotlib.ticker.FuncFormatter(lambda x, _: f"{x:g}"))


def margin_marks(ax: Any, marks: Sequence[tuple[Look, str]], height: float, pitch: float = 8.5) -> None:
    """Draws failures in a column to the right of the axes, from the top down: for each an open marker and its letter.

    `height` of the column and `pitch` are in points; what does not fit is said as '+n'.
    """
    room = max(1, int(height // pitch))
    shown = list(marks) if len(marks) <= room else list(marks)[:room - 1]
    at = {"xy": (1.0, 1.0), "xycoords": "axes fraction", "textcoords": "offset points", "annotation_clip": False,
          "va": "center", "ha": "left", "fontsize": 6.5}
    for i, (style, letter) in enumerate(shown):
        place = matplotlib.transforms.offset_copy(ax.transAxes, fig=ax.figure, x=5, y=-4 - i * pitch, units="points")
        ax.plot([1.0], [1.0], transform=place, clip_on=False, zorder=6, **open_marker(style))
        ax.annotate(letter, xytext=(8.5, -4.3 - i * pitch), color="#333333", **at)
    if len(shown) < len(marks):
        ax.annotate(f"+{len(marks) - len(shown)}", xytext=(2.5, -4 - len(shown) * pitch), color=GREY, **at)


def filled_marker(style: Look) -> dict[str, Any]:
    stroke = style.colour if style.marker in "1234+x" else "white"
    return {"marker": style.marker, "color": style.colour, "markersize": style.size, "markeredgecolor": stroke,
            "markeredgewidth": 0.4, "linestyle": "none"}


def open_marker(style: Look) -> dict[str, Any]:
    return {"marker": style.marker, "color": style.colour, "markersize": style.size, "markerfacecolor": "white",
            "markeredgecolor": style.colour, "markeredgewidth": 0.8, "linestyle": "none"}


def handles(pairs: Iterable[tuple[str, str]], lines: bool = True) -> list[Any]:
    """Legend entries of (solver, label) pairs."""
    def line(looks: Look) -> dict[str, Any]:
        return {"linestyle": looks.line, "linewidth": 0.9} if lines else {}

    return [plt.Line2D([], [], label=looks.title, **(filled_marker(looks) | line(looks)))
            for looks in (look(*pair) for pair in pairs)]


def legend_above(figure: Any, entries: Sequence[Any], columns: int = 3) -> None:
    """A legend above all frames; constrained layout keeps them clear of it."""
    figure.legend(handles=entries, loc="upper center", ncol=columns)
    rows = -(-len(entries) // columns)
    figure.get_layout_engine().set(rect=(0, 0, 1, 1 - 0.155 * rows / figure.get_size_inches()[1]))


def save(figure: Any, out: Path, stem: str, caption: str = "", footnote: str = "") -> list[Path]:
    """Writes <out>/figures/<stem>.pdf and .png without dates, so that the same numbers give the same bytes. A footnote stands
    below all else, and makes the figure higher.
    """
    if footnote:
        figure.draw_without_rendering()  # so that the layout is settled before the text, which it must not make room for
        figure.set_layout_engine("none")
        figure.text(0.5, -0.01, "\n".join(textwrap.wrap(footnote, int(20 * figure.get_figwidth()))), ha="center", va="top",
                    fontsize=6.5, color=GREY)
    folder = out / "figures"
    folder.mkdir(parents=True, exist_ok=True)
    paths = [folder / f"{stem}.pdf", folder / f"{stem}.png"]
    before = os.environ.get("SOURCE_DATE_EPOCH")
    os.environ["SOURCE_DATE_EPOCH"] = "0"  # the subset fonts inside a PDF carry a date too
    try:
        metadata: dict[str, dict[str, Any]] = {
            "pdf": {"Title": stem, "Subject": caption, "CreationDate": None},
            "png": {"Title": stem, "Description": caption, "Software": None}}
        for path in paths:
            temporary = path.with_name(path.name + ".part")
            with plt.rc_context({"figure.constrained_layout.use": False} if footnote else {}):  # savefig() would turn it on again
                figure.savefig(temporary, format=path.suffix[1:], metadata=metadata[path.suffix[1:]],
                               bbox_inches="tight" if footnote else None)
            temporary.replace(path)
    finally:
        if before is None:
            del os.environ["SOURCE_DATE_EPOCH"]
        else:
            os.environ["SOURCE_DATE_EPOCH"] = before
    plt.close(figure)
    return paths
