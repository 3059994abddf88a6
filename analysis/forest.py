"""Forest plot of the claims about ratios: measured / claimed, on a logarithmic axis."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Mapping, Sequence
from typing import Any, Final

import matplotlib.pyplot as plt
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter

from analysis.shared import claims, style

CAPTION: Final = (
    "Measured / claimed, for each claim about a ratio. Values above 1 support the claim. Filled: time; hollow: counted work, or memory. A "
    "marker with a line is a value and its interval; a line with end caps and no marker spans several ratios, from the least to the greatest. "
    "A triangle: a value beyond the axis."
)
LEAST, MOST = 1e-2, 1e2  # ends of the axis; values beyond them are drawn as arrows
ROW: Final = 0.116  # inches
HIGHEST: Final = 8.3  # inches; leaves space on a page for a caption. If there are many rows, they and their names become smaller
SECOND: Final = 0.08  # inches added for a second line of a name
WORK: Final = "distances, bounds and nodes"
WIDTH: Final = 96  # letters per line; a longer claim takes two lines
FOOT: Final = 0.7  # inches for the axis label, the directions and the note
PAPERS: Final = {
    "zhang2017": "Zhang et al. 2017",
    "tang2009": "Tang et al. 2009",
    "shou2014": "Shou et al. 2014",
    "sacht2024": "Sacht and Jacobson 2024",
    claims.OWN: "ours",
}

Bar = tuple[
    float, float, float
]  # value (NaN: only the range of several ratios is known), lower end, upper end (NaN: unknown)


def bars(record: claims.Record) -> list[tuple[bool, Bar]]:
    """Returns up to two bars of a claim: (True, ratio of times) and (False, ratio of counted
    work)."""

    def bar(ratio: object) -> Bar | None:
        if not isinstance(ratio, list):
            return None
        value, least, most = (math.nan if x is None else float(x) for x in ratio)
        if math.isnan(value):  # a range, on which an unknown end is unlimited
            return (
                value,
                0.0 if math.isnan(least) else least,
                math.inf if math.isnan(most) else most,
            )
        return value, least, most

    counted = record["counted"] if isinstance(record["counted"], Mapping) else {}
    work = counted.get(WORK) or next(iter(counted.values()), None) or {}
    entry = claims.entries(str(record["paper"])).get(str(record["id"]))
    in_time = entry is None or not entry.counts
    candidates = [
        (in_time, bar(record.get("ratio"))),
        (False, bar(work.get("ratio")) if in_time else None),
    ]
    return [(kind, ratio_bar) for kind, ratio_bar in candidates if ratio_bar is not None]


def draw(records: Sequence[claims.Record], measured: str = "") -> Any:
    """Draws one row per claim that has a ratio, in the given order, with a heading above the claims
    of each paper.

    `measured` names the machine and the number of rounds, for the note below.
    """
    shown = [record for record in records if bars(record)]
    heights, at, heads, before = [], 0.0, [], ""
    for record in shown:
        if record["paper"] != before:
            before = str(record["paper"])
            heads.append((at, before))
            at += 1
        more = 0.5 * SECOND / ROW if "\n" in name_of(record) else 0.0
        heights.append(at + more)
        at += 1 + 2 * more
    shrink = min(1.0, (HIGHEST - FOOT) / (ROW * (at + 1)))
    figure = plt.figure(figsize=(style.DOUBLE_COLUMN, shrink * ROW * (at + 1) + FOOT))
    ax = figure.add_subplot()
    ax.set(xscale="log", xlim=(LEAST, MOST), ylim=(at, -1), yticks=[])
    ax.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
    ax.axvline(1, color="black", linewidth=0.8)
    left: dict[str, Any] = {
        "transform": ax.get_yaxis_transform(),
        "ha": "right",
        "va": "center",
        "clip_on": False,
    }
    for record, y in zip(shown, heights):
        ax.axhline(y, color="#EEEEEE", linewidth=0.5, zorder=0)
        ax.text(-0.02, y, name_of(record), fontsize=5.6 * shrink, linespacing=1.05, **left)
        both = len(bars(record)) > 1
        for k, (in_time, bar) in enumerate(bars(record)):
            _draw_bar(ax, y + (0.4 * k - 0.2 if both else 0.0), bar, in_time)
    for y, paper in heads:
        ax.text(
            -0.02, y, PAPERS.get(paper, paper), fontsize=6.5 * shrink, fontweight="bold", **left
        )
    ax.set_xlabel("← less than claimed        measured / claimed        more than claimed →")
    entries = [
        Line2D([], [], label="in time", **_marker(True)),
        Line2D([], [], label="in counted work, or memory", **_marker(False)),
        Line2D(
            [],
            [],
            label="least to greatest of several",
            color="black",
            marker="|",
            markersize=4,
            linewidth=0.8,
        ),
    ]
    ax.legend(handles=entries, loc="lower right", bbox_to_anchor=(1, 1), ncol=3, frameon=False)
    figure.text(
        0.5,
        0.06 / figure.get_figheight(),
        "\n".join(textwrap.wrap(measured, 185)),
        ha="center",
        va="bottom",
        fontsize=6,
        color=style.GREY,
    )
    figure.set_layout_engine(
        "constrained",
        rect=(
            0,
            (FOOT - 0.4) / figure.get_figheight(),
            1,
            1 - (FOOT - 0.4) / figure.get_figheight(),
        ),
    )
    return figure


def name_of(record: claims.Record) -> str:
    """Returns the text of a claim, broken into two lines if it is long."""
    text = f"{record['place']}: {record['claim']}" if record["place"] else str(record["claim"])
    if len(text) <= WIDTH:
        return text
    return "\n".join(textwrap.wrap(text, len(text) // 2 + 8))


def _marker(in_time: bool) -> dict[str, Any]:
    return {
        "marker": "o",
        "markersize": 3.2,
        "linestyle": "none",
        "color": "black",
        "markerfacecolor": "black" if in_time else "white",
        "markeredgewidth": 0.7,
    }


def _draw_bar(ax: Any, y: float, bar: Bar, in_time: bool) -> None:
    value, least, most = bar
    line = {"color": "black" if in_time else "#777777", "linewidth": 0.8, "zorder": 2}
    if not math.isnan(least):
        ends = [min(max(x, LEAST), MOST) for x in (least, most)]
        ax.plot(ends, [y, y], **line)
        for x, inside, mark in ((least, least > LEAST, "<"), (most, most < MOST, ">")):
            if math.isnan(value) or not inside:
                ax.plot(
                    [min(max(x, LEAST), MOST)],
                    [y],
                    marker="|" if inside else mark,
                    markersize=3.5,
                    clip_on=False,
                    **line,
                )
    if not math.isnan(value):
        shape = (
            {} if LEAST < value < MOST else {"marker": "<" if value < 1 else ">", "clip_on": False}
        )
        ax.plot(
            [min(max(value, LEAST), MOST)],
            [y],
            **(_marker(in_time) | shape | {"color": line["color"], "zorder": 3}),
        )
