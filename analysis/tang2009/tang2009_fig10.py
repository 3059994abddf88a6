"""Figure 10 of Tang et al. 2009: time and memory of their algorithm and of Guthe's, on overlapping
models."""

from __future__ import annotations

import math
from typing import Any, Final

import matplotlib.pyplot as plt
from matplotlib.lines import Line2D

from analysis.shared import claims, numerals, scales, style, tables
from analysis.shared.cells import MEASURES, Cell, Grid, in_time_and_work
from analysis.shared.comparable import apart
from analysis.shared.notes import machine_line, total_title, total_word
from analysis.shared.over_pairs import on_average
from analysis.shared.report import Report
from analysis.shared.results import Results
from analysis.shared.estimates import NO_DATA, Estimate, exact, paired_ratio
from analysis.shared.verdicts import Verdict, everywhere

OVER: Final = (("guthe", "tang"), ("guthe", "cover"), ("tang", "cover"))
MOST: Final = 0.03  # fraction of the longest side: the paper's models are nearer than this
TIMES: Final = 10  # "by more than an order of magnitude"
TENS: Final = 10.0  # seconds: "tens of seconds or more"


class Pairs(Grid):
    def distance(self, scene: str) -> float:
        """Returns H as a fraction of the longest side of A."""
        row = self.first(scene)
        return self.results.middle(row) / float(self.results.cases.source_longest[row])


def verdicts(pairs: Pairs) -> list[Verdict]:
    """Judges the claims of the figure. Averages are over pairs nearer than 3 %, as in the paper."""
    scenes = [scene for scene in pairs.scenes if pairs.distance(scene) < MOST]

    def judge(name: str, times: float) -> Verdict:
        claim = claims.of("tang2009", name)
        return in_time_and_work(
            lambda measure: on_average(
                claim, [pairs.ratio(scene, "guthe", "tang", measure) for scene in scenes], times
            )
        )

    return [
        judge("tenth", TIMES),
        judge("outperforms", 1),
        subdivisions(pairs),
        memory(pairs),
        tens(pairs),
    ]


def tens(pairs: Pairs) -> Verdict:
    """Judges the claim that Guthe's algorithm takes at least TENS on every pair."""

    def ratio(cell: Cell | None) -> Estimate:
        if cell is None or not cell.times:
            return NO_DATA
        return apart(cell.origins) or paired_ratio(
            list(cell.times.values()), [TENS] * len(cell.times)
        )

    return everywhere(
        claims.of("tang2009", "guthe_tens"),
        [ratio(pairs.cells.get((scene, "guthe"))) for scene in pairs.scenes],
    )


def subdivisions(pairs: Pairs) -> Verdict:
    """Judges the claim that Guthe's algorithm needs more subdivisions on every pair. Counts are the
    same in every run."""

    def count(scene: str, label: str) -> int:
        cell = pairs.cells.get((scene, label))
        return cell.counters.get("subdivisions", 0) if cell is not None else 0

    counts = [(count(scene, "guthe"), count(scene, "tang")) for scene in pairs.scenes]
    return everywhere(
        claims.of("tang2009", "subdivisions"),
        [exact(guthe / tang) if min(guthe, tang) > 0 else NO_DATA for guthe, tang in counts],
    )


def memory(pairs: Pairs) -> Verdict:
    """Judges the claim that Guthe's algorithm needs more memory on every pair, by single peaks
    without intervals."""

    def peak(scene: str, label: str) -> float:
        cell = pairs.cells.get((scene, label))
        return cell.peak if cell is not None else -1

    peaks = [(peak(scene, "guthe"), peak(scene, "tang")) for scene in pairs.scenes]
    return everywhere(
        claims.of("tang2009", "memory"),
        [exact(guthe / tang) if min(guthe, tang) > 0 else NO_DATA for guthe, tang in peaks],
    )


def make(results: Results) -> Report:
    pairs = Pairs(results)
    unit, scale = numerals.time_unit(cell.time.value for cell in pairs.cells.values())
    memory_heads = [f"{style.title(label)}, MB" for _, label in pairs.labels]
    time_ratio_heads = [" / ".join(map(style.title, pair)) for pair in OVER]
    work_ratio_heads = [f"Guthe / Tang, {measure}" for measure in MEASURES]
    table = tables.Table(
        f"{total_title(results)}, {unit}, and peak memory, MB: the two-sided distance of overlapping models (Fig. 10 of Tang et al. 2009).",
        [
            "pair",
            "|A| / |B|",
            "H / longest side, %",
            *pairs.titles(),
            *memory_heads,
            *time_ratio_heads,
            *work_ratio_heads,
        ],
        left=1,
    )
    records = list[tables.Record]()
    for scene in pairs.scenes:
        cells = pairs.row(scene)
        peaks = [numerals.number(cell.peak / 1e6) if cell else numerals.NOTHING for cell in cells]
        time_ratios = [numerals.ratio(pairs.ratio(scene, *pair)) for pair in OVER]
        work_ratios = [
            numerals.ratio(pairs.ratio(scene, "guthe", "tang", measure)) for measure in MEASURES
        ]
        table.rows.append(
            [
                style.scene_title(scene),
                results.sizes(pairs.first(scene)),
                numerals.number(100 * pairs.distance(scene)),
                *pairs.texts(scene, scale),
                *peaks,
                *time_ratios,
                *work_ratios,
            ]
        )
        records += [
            {
                "scene": scene,
                "label": label,
                "distance_of_longest": pairs.distance(scene),
                "status": cell.status(),
                **tables.seconds(cell.time),
                "peak_bytes": cell.peak,
                **cell.counters,
            }
            for (_, label), cell in zip(pairs.labels, cells)
            if cell
        ]
    table.verdicts = verdicts(pairs)
    table.notes = [
        "The paper does not name its pairs. Tolerance 1e-4 of A's longest side. Guthe searches octrees, as his program did, and Tang BVHs of swept spheres, with the same kernels.",
        tables.coverage_note(cell.time for cell in pairs.cells.values())
        + " Preparation is included, loading is not. Ratios are paired by round.",
        "Memory: the largest resident set after loading, less the resident set before preparing.",
        f"Here: {machine_line(results)}.",
    ]
    caption = (
        f"(a) {total_title(results)}, in ms, with the interval of the median as a line, and (b) peak memory, in MB: the two-sided distance of "
        "overlapping models (Fig. 10 of Tang et al. 2009, which does not name its pairs). Dotted: a tenth of Guthe's time; the paper claims that "
        "Tang's algorithm stays below it."
    )
    return Report(lambda: draw(pairs, total_word(results)), table, records, caption=caption)


def draw(pairs: Pairs, clock: str) -> Any:
    """Draws a mark per pair and solver: time on the left, memory on the right."""
    figure, axes = plt.subplots(
        1, 2, figsize=(style.DOUBLE_COLUMN, 0.45 * len(pairs.scenes) + 1.1), sharey=True
    )
    step = 0.7 / len(pairs.labels)
    for ax, measure in zip(axes, ("time", "peak")):
        for i in range(0, len(pairs.scenes), 2):
            ax.axhspan(i - 0.5, i + 0.5, color="#F5F5F5", linewidth=0, zorder=0)
        for k, (solver, label) in enumerate(pairs.labels):
            for i, scene in enumerate(pairs.scenes):
                cell, looks = pairs.cells.get((scene, label)), style.look(solver, label)
                if not cell:
                    continue
                y = i + (k - (len(pairs.labels) - 1) / 2) * step
                if cell.failures or not math.isfinite(cell.time.value):
                    ax.text(
                        0.01,
                        y,
                        cell.failure_text(),
                        va="center",
                        fontsize=6,
                        color=looks.colour,
                        transform=ax.get_yaxis_transform(),
                    )
                    continue
                value = 1e3 * cell.time.value if measure == "time" else cell.peak / 1e6
                if measure == "time":
                    style.interval(ax, cell.time, y, 1e3, color=looks.colour, linewidth=1.4)
                ax.plot(value, y, **style.filled_marker(looks))
                if measure == "time" and solver == "guthe":
                    ax.plot(
                        [value / TIMES] * 2,
                        [i - 0.42, i + 0.42],
                        color="black",
                        linewidth=1.0,
                        linestyle=style.DOTTED,
                        zorder=4,
                    )
        ax.set_xscale("log")
        ax.set_xlabel(f"{clock} (ms)" if measure == "time" else "peak memory (MB)")
        scales.log_ticks(ax.xaxis)
    axes[0].set_yticks(
        range(len(pairs.scenes)),
        [
            f"{style.scene_title(scene)}\nH = {numerals.number(100 * pairs.distance(scene))} % of\nthe longest side"
            for scene in pairs.scenes
        ],
    )
    axes[0].invert_yaxis()
    entries = style.handles(pairs.labels, lines=False)
    paper = Line2D(
        [],
        [],
        color="black",
        linewidth=1.0,
        linestyle=style.DOTTED,
        label=f"a {TIMES}th of Guthe's time: the paper's claim",
    )
    style.legend_above(figure, [*entries, paper], columns=4)
    return figure
