"""Fig. 14 of Sacht and Jacobson 2024: pairs of meshes on which the methods of Sacht and of Zheng
differ the most."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.lines import Line2D

from analysis.sacht2024 import sacht_gallery
from analysis.sacht2024.sacht_limits import (
    Bounded,
    Row,
    above,
    ratio_of,
    row_of,
    time_ratio,
    work_ratio,
)
from analysis.sacht2024.sacht_pairs import percent
from analysis.shared import claims, numerals, scales, style, tables
from analysis.shared.cells import MEASURES, in_time_and_work
from analysis.shared.notes import clock_word, machine_line, scene_notes, total_title
from analysis.shared.report import Report
from analysis.shared.results import Results
from analysis.shared.estimates import paired_ratio
from analysis.shared.verdicts import Verdict, most_of

SLOW, FAST = "zheng", "sacht"  # the ratio is of these two
THOUSANDS: Final = (
    "square, cut the other way",
    1000.0,
)  # a scene made for this claim, chosen before any timing
TWENTIETH: Final = ("cube, finer", 20.0)
PAPER: Final = ((7224.0, "paper's (a)"), (6024.0, "paper's (b)"), (1 / 20, "paper's (c)"))
STANDS_IN: Final = {THOUSANDS[0]: "for paper's a, b", TWENTIETH[0]: "for paper's c"}
GALLERY: Final = 1.75  # inches
MILLISECOND: Final = 1e-3


@dataclass(frozen=True)
class Outlier:
    """The ratio of the two solvers on one pair of meshes, at one tolerance."""

    scene: str
    tolerance: float
    slow: Row | None
    fast: Row | None

    @property
    def ratio(self) -> Bounded:
        return time_ratio(self.slow, self.fast)

    def counted(self, measure: str) -> Bounded:
        return work_ratio(self.slow, self.fast, measure)


def collect(results: Results) -> list[Outlier]:
    def find(scene: str, label: str, tolerance: float) -> Row | None:
        rows = results.rows(scene=scene, label=label, tolerance=tolerance)
        return row_of(results, rows[0]) if len(rows) else None

    return [
        Outlier(scene, t, find(scene, SLOW, t), find(scene, FAST, t))
        for scene in results.scenes
        for t in sorted(results.in_order("tolerance"), reverse=True)
    ]


def verdicts(outliers: list[Outlier]) -> list[Verdict]:
    """Judges the claims at the finest tolerance, which the paper uses."""
    tolerance = min((x.tolerance for x in outliers), default=0.0)
    finest = [x for x in outliers if x.tolerance == tolerance]
    by_scene = {x.scene: x for x in finest}

    def judge(name: str, scene: str, times: float, turned: bool) -> Verdict:
        claim = claims.of("sacht2024", name, scene)
        x = by_scene.get(scene, Outlier(scene, 0.0, None, None))
        pair = (x.fast, x.slow) if turned else (x.slow, x.fast)
        return in_time_and_work(lambda measure: above(claim, ratio_of(*pair, measure), times))

    slower = [
        x
        for x in finest
        if x.slow
        and x.fast
        and x.fast.time.n
        and x.ratio.estimate.separated
        and x.ratio.estimate.high < 1
    ]
    short = [
        paired_ratio([MILLISECOND] * len(x.fast.times), list(x.fast.times.values()))
        for x in slower
        if x.fast
    ]
    return [
        judge("thousands", *THOUSANDS, False),
        judge("twentieth", *TWENTIETH, True),
        most_of(claims.of("sacht2024", "slower_is_fast"), short, "pairs on which it is slower"),
    ]


def make(results: Results) -> Report:
    outliers = collect(results)
    unit, scale = "ms", 1e3
    names = [style.title(label) for label in (SLOW, FAST)]
    table = tables.Table(
        f"{total_title(results)}, {unit}, and counted work, on pairs built so that the two solvers differ widely (Fig. 14 of Sacht and "
        "Jacobson 2024).",
        [
            "pair",
            "|A| / |B|",
            "h / diagonal, %",
            "tolerance",
            *names,
            " / ".join(names),
            *[f"{measure}: ratio" for measure in MEASURES],
        ],
        left=1,
    )
    records: list[tables.Record] = []
    for x in outliers:
        row = results.rows(scene=x.scene)[0]
        share = results.share(row)
        times = [each.text(scale) if each else numerals.NOTHING for each in (x.slow, x.fast)]
        work_ratios = [x.counted(measure).text() for measure in MEASURES]
        table.rows.append(
            [
                x.scene,
                results.sizes(row),
                percent(share),
                f"{x.tolerance:g}",
                *times,
                x.ratio.text(),
                *work_ratios,
            ]
        )
        records.append(
            {
                "scene": x.scene,
                "tolerance": x.tolerance,
                "share": share,
                "ratio": x.ratio.estimate.value,
                "ratio_low": x.ratio.estimate.low,
                "ratio_high": x.ratio.estimate.high,
                "ratio_at_least": x.ratio.at_least,
                **{
                    f"{label}_seconds": each.time.value if each else np.nan
                    for label, each in ((SLOW, x.slow), (FAST, x.fast))
                },
            }
        )
    table.verdicts = verdicts(outliers)
    table.notes = [
        *scene_notes(results),
        "If B is flat but its edges differ from those of A, a piece of A that crosses an edge of B lies in no single triangle of B. Zheng's "
        "bound uses one triangle at a time, so it is as large as the part that sticks out, and the pieces along all edges are cut until they are "
        "as small as the tolerance; Sacht's u3 cuts a piece in two where the two triangles meet, and is exact there. If B is finer than A, or "
        "nearly the same, the barycentre that Zheng measures settles pieces that u1 to u4 subdivide.",
        "'> n': stopped at its limit of time or of subdivisions. The ratio of its time until then to the upper end of the other's interval is a "
        "lower bound, and its work is what it had counted so far.",
        tables.coverage_note(each.time for x in outliers for each in (x.slow, x.fast) if each),
        "Paper: Sacht is 7,224 times (9 ms) and 6,024 times (4 ms) as fast as Zheng on two pairs with intricate parts, and a twentieth as fast "
        "on a third, on which both take less than a millisecond, as in most of the cases in which it is slower; MacBook Air M2, 8 GB.",
        f"Here: {machine_line(results)}.",
    ]
    caption = (
        "Pairs built so that the two solvers differ widely, and how many times as long Zheng takes as Sacht on them, with intervals (Fig. 14 of "
        "Sacht and Jacobson 2024). Dotted: the paper's values for its pairs (a) to (c)."
    )
    return Report(
        lambda: draw(results, outliers, clock_word(results)), table, records, caption=caption
    )


def draw(results: Results, outliers: list[Outlier], clock: str) -> Any:
    """Draws the pairs, and below them the ratio of times for each pair, with a marker for each
    tolerance.

    Arrows mark lower bounds on a ratio; lines are the ratios of the paper.
    """
    scenes = list(dict.fromkeys(x.scene for x in outliers))
    tolerances = sorted({x.tolerance for x in outliers}, reverse=True)
    pairs, high = sacht_gallery.meshes_of(results, scenes), 0.9 + 0.33 * len(scenes)
    figure = plt.figure(figsize=(style.DOUBLE_COLUMN, high + (GALLERY if pairs else 0.0)))
    grid = figure.add_gridspec(
        2 if pairs else 1, 1, height_ratios=[GALLERY, high] if pairs else [1]
    )
    if pairs:
        above = figure.add_subplot(grid[0])
        above.set_title("the pairs: A above B")
        sacht_gallery.draw(
            above,
            results,
            pairs,
            name=lambda scene: "\n".join(filter(None, [scene, STANDS_IN.get(scene)])),
        )
    ax = figure.add_subplot(grid[-1])
    colours = plt.get_cmap("viridis")(np.linspace(0.75, 0.1, len(tolerances)))
    for x in outliers:
        k = tolerances.index(x.tolerance)
        y, colour, ratio = (
            scenes.index(x.scene) + 0.14 * (k - 0.5 * (len(tolerances) - 1)),
            colours[k],
            x.ratio,
        )
        if ratio.estimate.n:
            style.interval(ax, ratio.estimate, y, color=colour, linewidth=1.4)
            ax.plot(
                ratio.estimate.value,
                y,
                "o",
                color=colour,
                markersize=4.5,
                markeredgecolor="white",
                markeredgewidth=0.4,
            )
        elif ratio.at_least:
            ax.plot(ratio.at_least, y, ">", color=colour, markersize=5)
            ax.annotate(
                "at least",
                (ratio.at_least, y),
                xytext=(6, -2),
                textcoords="offset points",
                fontsize=6,
                color="#333333",
                bbox={"boxstyle": "square,pad=0.1", "facecolor": "white", "linewidth": 0},
            )
    ax.axvline(1, color="#333333", linewidth=0.7)
    for value, name in PAPER:
        ax.axvline(value, color=style.GREY, linewidth=0.6, linestyle=(0, (2, 2)))
        ax.text(
            value,
            -0.75,
            name,
            fontsize=6,
            color=style.GREY,
            rotation=0,
            ha="right" if name.endswith("(b)") else "left" if name.endswith("(a)") else "center",
            va="bottom",
        )
    ax.set_xscale("log")
    ax.set_xlim(0.015, 4e4)
    ax.set_ylim(len(scenes) - 0.5, -0.6)
    ax.set_yticks(range(len(scenes)), scenes)
    ax.tick_params(axis="y", length=0)
    scales.log_ticks(ax.xaxis)
    ax.set_xlabel(
        f"{clock} of {style.title(SLOW)} / {style.title(FAST)}; right of 1, {style.title(FAST)} is faster"
    )
    style.legend_above(
        figure,
        [
            Line2D([], [], linestyle="none", marker="o", color=colour, label=f"tolerance {t:g}")
            for t, colour in zip(tolerances, colours)
        ],
        columns=4,
    )
    return figure
