"""Figures 8 and 9 of Zhang et al. 2017: the time of a solver against one of its parameters."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import matplotlib.pyplot as plt
from matplotlib.lines import Line2D

from analysis.shared import numerals, scales, style, tables
from analysis.shared.cells import MEASURES, Cell, compare, compare_work, in_time_and_work
from analysis.shared.comparable import apart
from analysis.shared.notes import machine_line, total_title, total_word
from analysis.shared.report import Report
from analysis.shared.results import Results
from analysis.shared.estimates import NO_DATA, Estimate
from analysis.shared.verdicts import Verdict, everywhere, least_among

# Colours (from light to dark; no solver has them) and markers of the pairs.
PAIR_LOOKS = [
    ("#DDCC77", "o"),
    ("#44AA99", "^"),
    ("#CC6677", "s"),
    ("#AA4499", "D"),
    ("#332288", "v"),
]


@dataclass(frozen=True)
class Spec:
    caption: str
    parameter: str
    axis: str  # label of the horizontal axis
    text_of: Callable[[float], str]
    recommended: float  # the value that the paper recommends; marked in the figure
    verdicts: Callable[[Sweep], list[Verdict]]
    columns: tuple[tuple[str, Callable[[Results, Cell], float]], ...]  # more columns: header, value
    note: str


class Sweep:
    """The cells of a solver, by scene and value of one parameter."""

    def __init__(self, spec: Spec, results: Results) -> None:
        self.spec, self.results = spec, results
        self.scenes = results.scenes
        rows: dict[tuple[str, float], list[int]] = {}
        for row in range(len(results.cases)):
            value = results.options(row).get(spec.parameter)
            if value is not None:
                rows.setdefault((results.cases.scene[row], float(value)), []).append(row)
        self.cells = {key: Cell(results, of) for key, of in rows.items()}
        self.values = sorted({value for _, value in rows})

    def time(self, scene: str, value: float) -> Estimate:
        cell = self.cells.get((scene, value))
        return cell.time if cell else NO_DATA

    def timed(self, scene: str, among: list[float] | None = None) -> list[float]:
        return [v for v in (self.values if among is None else among) if self.time(scene, v).n]

    def best(self, scene: str, among: list[float] | None = None) -> float:
        """Returns the value (of `among`) with the least median time; NaN without times."""
        return min(
            self.timed(scene, among), key=lambda v: self.time(scene, v).value, default=math.nan
        )

    def ratio(self, scene: str, slow: float, fast: float, measure: str = "") -> Estimate:
        """Returns the ratio of times, or of counts MEASURES[measure], of value `slow` / value
        `fast`."""
        if (scene, slow) not in self.cells or (scene, fast) not in self.cells:
            return NO_DATA
        pair = self.cells[scene, slow], self.cells[scene, fast]
        return compare_work(*pair, MEASURES[measure]) if measure else compare(*pair)

    def times_the_least(self, scene: str, value: float) -> float:
        """Returns the time / the least time of the scene; NaN if the two are not comparable."""
        best = self.best(scene)
        if math.isnan(best) or apart(
            self.cells[scene, value].origins | self.cells[scene, best].origins
        ):
            return math.nan
        return self.time(scene, value).value / self.time(scene, best).value

    def everywhere(self, claim: str, slow: float, fast: float) -> Verdict:
        """Judges a claim that one value is slower than another on every pair, in time and in
        counted work."""
        return in_time_and_work(
            lambda measure: everywhere(
                claim, [self.ratio(scene, slow, fast, measure) for scene in self.scenes]
            )
        )

    def least(self, claim: str, scene: str, among: list[float]) -> Verdict:
        """Judges a claim that the least time is at one of these values, in time and in counted
        work."""
        timed = self.timed(scene)
        among = [value for value in among if value in timed]
        texts = [self.spec.text_of(value) for value in among]

        def judge(measure: str) -> Verdict:
            rivals = []
            for value in timed:
                ratios = [self.ratio(scene, value, claimed, measure) for claimed in among]
                if value not in among and ratios and all(ratio.n for ratio in ratios):
                    rivals.append((self.spec.text_of(value), ratios))
            best = min(timed, key=lambda v: self.cells[scene, v].cost(measure), default=math.nan)
            return least_among(claim, rivals, self.spec.text_of(best) if timed else "", texts)

        return in_time_and_work(judge)


def make(spec: Spec, results: Results) -> Report:
    sweep = Sweep(spec, results)
    table = tables.Table(
        spec.caption,
        [
            "pair",
            spec.axis,
            "prepare, ms",
            f"{total_word(results)}, ms",
            "times the least",
            *MEASURES,
            *[header for header, _ in spec.columns],
        ],
        left=1,
    )
    records: list[tables.Record] = []
    for scene in sweep.scenes:
        table.rules.add(len(table.rows))
        best = sweep.best(scene)
        for value in sweep.values:
            cell = sweep.cells.get((scene, value))
            if not cell:
                continue
            more = [cell.count(names) for names in MEASURES.values()]
            more += [
                column(results, cell) if not cell.failures else math.nan
                for _, column in spec.columns
            ]
            table.rows.append(
                [
                    scene,
                    spec.text_of(value),
                    numerals.number(cell.prepare * 1000),
                    cell.text(1000),
                    numerals.number(sweep.times_the_least(scene, value))
                    + (" (least)" if value == best else ""),
                    *map(numerals.number, more),
                ]
            )
            records.append(
                {
                    "scene": scene,
                    spec.parameter: value,
                    "status": cell.status(),
                    **tables.seconds(cell.time),
                    "prepare_seconds": cell.prepare,
                    "peak_bytes": cell.peak,
                    **cell.counters,
                }
            )
    table.verdicts = spec.verdicts(sweep)
    table.notes = [
        tables.coverage_note(cell.time for cell in sweep.cells.values()) + " " + spec.note,
        f"Here: {machine_line(results)}.",
    ]
    caption = (
        f"{spec.caption} (a) {total_title(results)}, in seconds, with the interval of the median as a bar. (b) The same relative to the least time of "
        f"each pair{'' if from_zero(sweep) else '; the axis does not begin at 0'}."
    )
    return Report(lambda: draw(sweep), table, records, caption=caption)


def from_zero(sweep: Sweep) -> bool:
    """Tells whether the axis of multiples should begin at 0; if all are below 2, this would leave
    them too close together."""
    return any(
        sweep.times_the_least(scene, value) > 2
        for scene in sweep.scenes
        for value in sweep.timed(scene)
    )


def draw(sweep: Sweep) -> Any:
    """Draws the times on the left, and as multiples of the least time of each pair on the right."""
    spec = sweep.spec
    figure, axes = plt.subplots(1, 2, figsize=(style.DOUBLE_COLUMN, 2.6))
    place = {value: i for i, value in enumerate(sweep.values)}
    lost = []
    for i, scene in enumerate(sweep.scenes):
        colour, marker = PAIR_LOOKS[i % len(PAIR_LOOKS)]
        looks = style.Look(scene, colour, marker)
        for ax in axes:
            timed = sweep.timed(scene)
            height = {
                v: sweep.time(scene, v).value if ax is axes[0] else sweep.times_the_least(scene, v)
                for v in timed
            }
            ax.plot([place[v] for v in timed], list(height.values()), color=colour, linewidth=0.8)
            for value in timed:
                t = sweep.time(scene, value)
                if ax is axes[0]:
                    style.interval(ax, t, place[value], upright=True, color=colour, linewidth=1.2)
                ax.plot(place[value], height[value], **style.filled_marker(looks))
        lost += [
            f"{scene} at {spec.text_of(v)}: {cell.failure_text()}"
            for (of, v), cell in sweep.cells.items()
            if of == scene and cell.failures
        ]
    for ax, label in zip(
        axes, (f"{total_word(sweep.results)} (s)", "time / least time of the pair")
    ):
        ax.set(xlabel=spec.axis, ylabel=label)
        ax.set_xticks(list(place.values()), [spec.text_of(v) for v in sweep.values])
        if spec.recommended in place:
            ax.axvline(
                place[spec.recommended],
                color=style.GREY,
                linewidth=0.8,
                linestyle=style.DOTTED,
                zorder=0.5,
            )
    axes[0].set_yscale("log")
    scales.log_ticks(axes[0].yaxis)
    if from_zero(sweep):
        axes[1].set_ylim(bottom=0)
    if lost:
        axes[0].text(0.02, 0.98, "\n".join(lost), transform=axes[0].transAxes, fontsize=6, va="top")
    entries = [
        Line2D(
            [],
            [],
            label=scene,
            linewidth=0.8,
            color=PAIR_LOOKS[i % len(PAIR_LOOKS)][0],
            marker=PAIR_LOOKS[i % len(PAIR_LOOKS)][1],
            markeredgecolor="white",
            markeredgewidth=0.4,
        )
        for i, scene in enumerate(sweep.scenes)
    ]
    entries.append(
        Line2D(
            [],
            [],
            label="recommended by the paper",
            color=style.GREY,
            linewidth=0.8,
            linestyle=style.DOTTED,
        )
    )
    style.legend_above(figure, entries, columns=6)
    return figure
