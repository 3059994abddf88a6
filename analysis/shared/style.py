"""The style of figures: a fixed colour, marker and line for each solver (LOOKS), letters for
failures, legends, widths.

Colours are from Okabe and Ito (2008) and Paul Tol's muted set, which remain distinct with all
common kinds of colour blindness. There are more solvers than such colours, so solvers of point sets
and of meshes share colours, with different markers.
"""

from __future__ import annotations

import json
import zlib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.lines import Line2D  # noqa: E402

from analysis.shared.drawable import legend_label, make_drawable  # noqa: E402
from analysis.shared.estimates import Estimate  # noqa: E402

if TYPE_CHECKING:
    from analysis.shared.results import Results

SINGLE_COLUMN: Final = 3.5  # inches
DOUBLE_COLUMN: Final = 7.16
WIDTHS: Final = {"single": SINGLE_COLUMN, "double": DOUBLE_COLUMN}
GREY: Final = "#666666"

plt.style.use(Path(__file__).with_name("hausbench.mplstyle"))


Line = str | tuple[int, tuple[float, ...]]


@dataclass(frozen=True)
class Look:
    title: str
    colour: str
    marker: str
    line: Line = "-"

    @property
    def entry(self) -> str:
        """The title as a legend label."""
        return legend_label(self.title)

    @property
    def size(self) -> float:
        """Marker size; stars and crosses are larger, so that all markers look equally heavy."""
        return {"*": 6.5, "P": 5.0, "X": 5.0, "p": 5.0, "h": 5.0, "d": 5.0}.get(self.marker, 4.2)


DASHED: Final = (0, (4, 1.5))
DOTTED: Final = (0, (1, 1))
# Solvers with a fixed look, in the order of legends and tables. introduce() gives the others one.
LOOKS: Final[dict[str, Look]] = {
    # point sets
    "naive": Look("NAIVEHDD", "#000000", "s"),
    "earlybreak": Look("EARLYBREAK", "#E69F00", "o"),
    "lss": Look("LSS", "#44AA99", "d"),
    "inc": Look("INC", "#56B4E9", "v"),
    "nohd": Look("NOHD", "#009E73", "^", DASHED),
    "ohd": Look("OHD", "#0072B2", "D", DASHED),
    "adaptive": Look("NOHD/OHD framework", "#CC79A7", "P"),
    "scan": Look("scan (ours)", "#D55E00", "X"),
    "kdtree": Look("k-d tree (nanoflann)", "#882255", "h", DOTTED),
    "cgal_kdtree": Look("k-d tree (CGAL)", "#999933", "p", DOTTED),
    # meshes
    "sampling": Look("sampling", "#CC79A7", "p"),
    "guthe": Look("Guthe 2005", "#999933", "<", DASHED),
    "tang": Look("Tang 2009", "#56B4E9", "o"),
    "kang": Look("Kang 2018", "#009E73", "s"),
    "zheng": Look("Zheng 2022", "#0072B2", "^"),
    "sacht": Look("Sacht 2024", "#E69F00", "D"),
    "cover": Look("cover (ours)", "#D55E00", "*"),
    "cgal": Look("CGAL", "#882255", "X", DOTTED),
    # surfaces, other programs
    "interval_subdivision": Look("interval subdivision", "#000000", "d"),
    "surface_enclosure": Look("surface enclosure (ours)", "#D55E00", "h"),
    "surface_meshes": Look("surface meshes (ours)", "#0072B2", "s"),
    "external": Look("external program", "#777777", ">", (0, (4, 1.5, 1, 1.5))),
}
NEUTRAL: Final = Look("", GREY, "o")  # for legend entries that are not about a solver
PROGRAMS: Final = {
    "scipy_ckdtree": "SciPy cKDTree",
    "scipy_directed_hausdorff": "SciPy directed_hausdorff",
}  # titles of external programs

# Letters in figures for rows whose status is not `ok`.
STATUS_LETTERS: Final = {
    "timeout": "T",
    "out_of_memory": "M",
    "signal": "C",
    "failed": "F",
    "unsound": "U",
    "skipped": "S",
    "not_built": "N",
    "floor": "P",
    "budget": "B",
}
STATUS_WORDS: Final = {
    "timeout": "timeout",
    "out_of_memory": "out of memory",
    "signal": "crashed",
    "failed": "failed",
    "unsound": "unsound",
    "skipped": "skipped",
    "not_built": "not built",
    "floor": "precision floor",
    "budget": "budget spent",
}


def letters_key(statuses: Iterable[str]) -> str:
    """Returns the key to the letters of these statuses: 'T timeout, B budget spent'; empty if none
    has a letter."""
    there = {str(status) for status in statuses}
    return ", ".join(
        f"{letter} {STATUS_WORDS[status]}"
        for status, letter in STATUS_LETTERS.items()
        if status in there
    )


def status_word(status: str) -> str:
    return STATUS_WORDS.get(status, status)


def status_letter(status: str) -> str:
    return STATUS_LETTERS.get(status, "?")


# Colours of Paul Tol's muted and light sets that no solver above uses.
_OWN_COLOURS: Final = (
    "#332288",
    "#AA4499",
    "#117733",
    "#CC6677",
    "#44AA99",
    "#DDCC77",
    "#6699CC",
    "#661100",
)
_OWN_MARKERS: Final = "o^sDvP*Xp8Hd<>"
_VARIANT_MARKERS: Final = "phd<>8*PHXv"
_own: dict[
    str, Look
] = {}  # looks given by introduce(), by solver or by label of an external program
_LINES: Final[tuple[Line, ...]] = (
    "-",
    DASHED,
    DOTTED,
    (0, (4, 1.5, 1, 1.5)),
    (0, (8, 2)),
    (0, (3, 1, 1, 1, 1, 1)),
)
_variants: dict[
    str, tuple[int, str]
] = {}  # for each label of a solver with several labels: its number and its marker
_in_front = ""
_width = DOUBLE_COLUMN
_behind: dict[str, int] = {}  # labels drawn in grey, each with the number of its shade and line


def introduce(results: Results) -> None:
    """Gives a title, colour and marker to solvers that are not in LOOKS (of plug-ins, or external
    programs).

    Variants of a solver get a shade of its colour, a marker and a line of their own.
    """
    used = {
        LOOKS[solver].marker
        for solver, name in zip(results.cases.solver, results.names)
        if solver in LOOKS and name == solver
    }
    titles: dict[str, str] = json.loads(str(results.meta.get("titles") or "{}"))
    for solver, label in dict.fromkeys(zip(results.cases.solver, results.cases.label)):
        name = label if solver == "external" else solver
        if (solver == "external" or solver not in LOOKS) and name not in _own:
            k = len(_own)
            marker = _unused(_OWN_MARKERS, used, k)
            _own[name] = Look(
                (PROGRAMS if solver == "external" else titles).get(name, name),
                _OWN_COLOURS[k % len(_OWN_COLOURS)],
                marker,
                (DASHED, "-")[k % 2],
            )
    named: dict[str, list[str]] = {}
    for solver, label in dict.fromkeys(zip(results.cases.solver, results.names)):
        if label != solver and label not in _own:
            named.setdefault(solver, []).append(label)
    for labels in named.values():
        _variants.update(
            {label: (k, _unused(_VARIANT_MARKERS, used, k)) for k, label in enumerate(labels)}
        )


def _unused(markers: str, used: set[str], k: int) -> str:
    """Returns the first of `markers` that is not in `used`, and adds it to `used`. If all are used,
    returns the k-th."""
    chosen = next((marker for marker in markers if marker not in used), markers[k % len(markers)])
    used.add(chosen)
    return chosen


def set_width(inches: float) -> None:
    """Sets the width of figures drawn from now on."""
    global _width
    _width = inches


def width() -> float:
    return _width


def highlight(label: str) -> None:
    """Draws all solvers but this one in grey from now on, each with a line style of its own; ''
    undoes this."""
    global _in_front
    _in_front = label
    _behind.clear()


def look(solver: str, label: str = "") -> Look:
    """Returns the look of a solver, or of the variant with this label, which has another marker and
    line.

    A solver that is neither in LOOKS nor passed to introduce() is grey, with a marker that depends
    only on its name.
    """
    plain = _look(solver, label)
    if not _in_front or _in_front in (label, label.partition("(")[0], solver if not label else ""):
        return plain
    k = _behind.setdefault(label or solver, len(_behind))
    return replace(
        plain, colour=("#A0A0A0", "#C4C4C4", "#808080")[k % 3], line=_LINES[k % len(_LINES)]
    )


def _look(solver: str, label: str) -> Look:
    if solver == "external" and label.partition("(")[0] in _own:
        solver = label.partition("(")[0]
    base = (
        _own[solver]
        if solver in _own
        else LOOKS.get(
            solver, Look(solver, "#777777", "<>1234+x"[zlib.crc32(solver.encode()) % 8], "--")
        )
    )
    if label in ("", solver):
        return base
    if label in _variants:
        k, marker = _variants[label]
        return Look(
            label, shade(base.colour, (0.0, 0.45, -0.35)[k % 3]), marker, _LINES[k % len(_LINES)]
        )
    variant = zlib.crc32(label.encode())
    return Look(
        label,
        base.colour,
        "phd<>8"[variant % 6],
        (DOTTED, (0, (6, 2)), (0, (3, 1, 1, 1)))[variant % 3],
    )


def shade(colour: str, by: float) -> str:
    """Returns the colour made lighter (by > 0) or darker (by < 0)."""
    red, green, blue = (
        (1 - abs(by)) * part + (by if by > 0 else 0) for part in matplotlib.colors.to_rgb(colour)
    )
    return str(matplotlib.colors.to_hex((red, green, blue)))


def title(solver: str, label: str = "") -> str:
    return look(solver, label).title


def order(pairs: Iterable[tuple[str, str]]) -> list[tuple[str, str]]:
    """Sorts the distinct (solver, label) pairs in the order of LOOKS. Other solvers come last, by
    first appearance."""
    place = {name: i for i, name in enumerate(LOOKS)}
    return sorted(dict.fromkeys(pairs), key=lambda pair: place.get(pair[0], len(place)))


# Scenes named after a panel of a paper's figure: scene_title() turns their first letter into "(a)".
PANELS: Final = frozenset(
    {"a_pears", "b_cow_hippo", "c_rabbits", "d_cups", "e_wrenches", "f_singular"}
)


def scene_title(scene: str) -> str:
    """Returns '(b) cow, hippo' for 'b_cow_hippo', a panel; in other names, replaces underscores
    with spaces."""
    if scene in PANELS:
        letter, *words = scene.split("_")
        return f"({letter}) {', '.join(words)}"
    return scene.replace("_", " ")


def margin_marks(
    ax: Any, marks: Sequence[tuple[Look, str]], height: float, pitch: float = 8.5
) -> None:
    """Lists failures in a column to the right of the axes, from the top down: an open marker and a
    letter for each.

    The column is `height` points high, with `pitch` points per failure. A last line '+n' counts
    those that do not fit.
    """
    room = max(1, int(height // pitch))
    shown = list(marks) if len(marks) <= room else list(marks)[: room - 1]
    at = {
        "xy": (1.0, 1.0),
        "xycoords": "axes fraction",
        "textcoords": "offset points",
        "annotation_clip": False,
        "va": "center",
        "ha": "left",
        "fontsize": 6.5,
    }
    for i, (style, letter) in enumerate(shown):
        place = matplotlib.transforms.offset_copy(
            ax.transAxes, fig=ax.figure, x=5, y=-4 - i * pitch, units="points"
        )
        ax.plot([1.0], [1.0], transform=place, clip_on=False, zorder=6, **open_marker(style))
        ax.annotate(letter, xytext=(8.5, -4.3 - i * pitch), color="#333333", **at)
    if len(shown) < len(marks):
        ax.annotate(
            f"+{len(marks) - len(shown)}", xytext=(2.5, -4 - len(shown) * pitch), color=GREY, **at
        )


def filled_marker(style: Look) -> dict[str, Any]:
    stroke = style.colour if style.marker in "1234+x" else "white"
    return {
        "marker": style.marker,
        "color": style.colour,
        "markersize": style.size,
        "markeredgecolor": stroke,
        "markeredgewidth": 0.4,
        "linestyle": "none",
    }


def open_marker(style: Look) -> dict[str, Any]:
    return {
        "marker": style.marker,
        "color": style.colour,
        "markersize": style.size,
        "markerfacecolor": "white",
        "markeredgecolor": style.colour,
        "markeredgewidth": 0.8,
        "linestyle": "none",
    }


def interval(
    ax: Any, x: Estimate, at: float, scale: float = 1.0, upright: bool = False, **line: Any
) -> None:
    """Draws the interval of an estimate, if any: horizontal at y = `at`, or with `upright` vertical
    at x = `at`."""
    if x.has_interval:
        ends, place = [scale * x.low, scale * x.high], [at, at]
        ax.plot(*((place, ends) if upright else (ends, place)), **line)


def filled_entry(label: str, looks: Look = NEUTRAL) -> Any:
    """Returns a legend entry with a filled marker."""
    return Line2D([], [], label=legend_label(label), **filled_marker(looks))


def open_entry(label: str, looks: Look = NEUTRAL) -> Any:
    return Line2D([], [], label=legend_label(label), **open_marker(looks))


def handles(pairs: Iterable[tuple[str, str]], lines: bool = True) -> list[Any]:
    """Returns the legend entries of (solver, label) pairs."""

    def line(looks: Look) -> dict[str, Any]:
        return {"linestyle": looks.line, "linewidth": 0.9} if lines else {}

    shown = [look(*pair) for pair in pairs]
    return [
        Line2D([], [], label=looks.entry, **(filled_marker(looks) | line(looks))) for looks in shown
    ]


def legend_above(figure: Any, entries: Sequence[Any], columns: int = 3, room: bool = False) -> None:
    """Draws a legend above all panels; constrained layout makes space for it.

    With `room` the figure becomes higher by this space, and long labels reduce the number of
    columns.
    """
    legend = figure.legend(handles=entries, loc="upper center", ncol=columns)
    make_drawable(legend)
    while (
        room
        and columns > 1
        and legend.get_window_extent(figure.canvas.get_renderer()).width > figure.bbox.width
    ):
        legend.remove()
        columns -= 1
        legend = figure.legend(handles=entries, loc="upper center", ncol=columns)
        make_drawable(legend)
    rows = -(-len(entries) // columns)
    if room:
        figure.set_figheight(figure.get_figheight() + 0.155 * rows)
    figure.get_layout_engine().set(rect=(0, 0, 1, 1 - 0.155 * rows / figure.get_size_inches()[1]))
