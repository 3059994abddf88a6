"""Tables 1 and 2 of Zhang et al. 2017: a solver with and without one of its parts, on pairs of
random clouds."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.lines import Line2D

from analysis.shared import claims, numerals, scales, style, tables
from analysis.shared.cells import MEASURES, WORK, Cell, compare, compare_work, in_time_and_work
from analysis.shared.comparable import reason_apart
from analysis.shared.load import paper_numbers
from analysis.shared.notes import machine_line, total_title, total_word
from analysis.shared.over_pairs import on_average
from analysis.shared.report import Report
from analysis.shared.results import Results
from analysis.shared.estimates import NO_DATA, Estimate
from analysis.shared.verdicts import UNTESTED, Verdict, rising


@dataclass(frozen=True)
class Spec:
    caption: str
    without: str  # labels of the two variants
    with_it: str
    part: str  # name of the part that only `with_it` has
    gains: str  # id of the paper's claim
    more_labels: tuple[str, ...]  # one column each
    notes: list[str]
    extra: Callable[
        [Results, str, dict[str, Cell]], list[tuple[str, str, float]]
    ] = lambda *_: []  # more columns: header, text, number


class Pair:
    """One scene. Both variants build the same structure, so both get the shorter of their two
    preparation times.

    With several seeds each keeps its own times, because medians even out differences in
    preparation.
    """

    def __init__(self, results: Results, spec: Spec, scene: str) -> None:
        cases = results.cases
        self.scene, self.number = scene, int(scene.split()[-1])
        labels = (spec.without, spec.with_it, *spec.more_labels)
        self.cells = {
            label: Cell(results, rows)
            for label in labels
            if (rows := results.rows(scene=scene, label=label))
        }
        first = results.rows(scene=scene)[0]
        self.n, self.m = int(cases.source_elements[first]), int(cases.target_elements[first])
        slow, fast = self.cells.get(spec.without), self.cells.get(spec.with_it)
        both = [cell for cell in (slow, fast) if cell and not cell.failures]
        self.ratio = NO_DATA
        self.counted = dict.fromkeys(MEASURES, NO_DATA)
        if slow and fast and len(both) == 2:
            if len(slow.rows) == len(fast.rows) == 1:
                slow.share_preparation(fast)
            self.ratio = compare(slow, fast)
            self.counted = {
                measure: compare_work(slow, fast, names) for measure, names in MEASURES.items()
            }

    def time(self, label: str) -> Estimate:
        return self.cells[label].time if label in self.cells else NO_DATA

    def text(self, label: str, scale: float) -> str:
        return self.cells[label].text(scale) if label in self.cells else numerals.NOTHING


def make(spec: Spec, results: Results) -> Report:
    printed = paper_numbers(results.stem)
    papers = {row["pair"]: row for row in printed["row"]}
    pairs = [Pair(results, spec, scene) for scene in results.scenes]
    present = {label for pair in pairs for label in pair.cells}
    shown = [label for label in spec.more_labels if label in present]
    unit, scale = numerals.time_unit(
        pair.time(label).value for pair in pairs for label in (spec.without, spec.with_it)
    )
    titles = [
        style.title(label) if label in style.LOOKS else label.replace("_", " ") for label in shown
    ]
    extras = [spec.extra(results, pair.scene, pair.cells) for pair in pairs]
    extra_titles = [title for title, _, _ in (extras[0] if extras else [])]
    table = tables.Table(
        spec.caption + f" {total_title(results)}, {unit}, here and as printed.",
        [
            "pair",
            "|A| / |B|",
            "paper: without",
            "paper: with",
            "paper: ratio",
            "here: without",
            "here: with",
            "here: ratio",
            *[f"{measure}: ratio" for measure in MEASURES],
            *titles,
            *extra_titles,
        ],
        left=2,
    )
    records: list[tables.Record] = []
    for pair, extra in zip(pairs, extras):
        paper = papers.get(pair.number, {})
        slow, fast = float(paper.get(spec.without, math.nan)), float(
            paper.get(spec.with_it, math.nan)
        )
        paper_times = [
            numerals.NOTHING if math.isnan(x) else f"{x * scale:.6g}" for x in (slow, fast)
        ]
        extra_texts = [text for _, text, _ in extra]
        table.rows.append(
            [
                str(pair.number),
                f"{pair.n:,} / {pair.m:,}",
                *paper_times,
                numerals.number(slow / fast),
                pair.text(spec.without, scale),
                pair.text(spec.with_it, scale),
                numerals.ratio(pair.ratio),
                *map(numerals.ratio, pair.counted.values()),
                *[pair.text(label, scale) for label in shown],
                *extra_texts,
            ]
        )
        ratios = {f"{measure}, ratio": x.value for measure, x in pair.counted.items()}
        extra_values = {header: value for header, _, value in extra}
        for label, cell in pair.cells.items():
            records.append(
                {
                    "pair": pair.number,
                    "label": label,
                    "source_elements": pair.n,
                    "target_elements": pair.m,
                    "status": cell.status(),
                    **tables.seconds(cell.time),
                    "prepare_seconds": cell.prepare,
                    "peak_bytes": cell.peak,
                    "paper_seconds": float(paper.get(label, math.nan)),
                    "ratio": pair.ratio.value,
                    "ratio_low": pair.ratio.low,
                    "ratio_high": pair.ratio.high,
                    **ratios,
                    **extra_values,
                    **cell.counters,
                }
            )
    table.verdicts = verdicts_of(spec, pairs)
    table.notes = [
        f"Ratio: without / with {spec.part}; paired by {unit_of(pairs)}. The solver counts distances, bounds and nodes, which are the same on "
        "every machine; for a solver with a seed they depend on it, and one seed is one draw.",
        what_it_saves(spec, pairs),
        tables.coverage_note(cell.time for pair in pairs for cell in pair.cells.values())
        + (" If a solver was run with several seeds, n counts them." if has_seeds(pairs) else ""),
        *spec.notes,
        f"Here: {machine_line(results)}. Paper: {printed['machine']}; {printed['what']}.",
    ]
    caption = (
        f"{spec.caption} (a) {total_title(results)}, in seconds, by the number of points. (b) Time without / with {spec.part} on each pair of the paper's table. "
        "Filled: measured here, with the interval of the median as a bar; open: printed in the paper."
    )
    return Report(
        lambda: draw(spec, pairs, papers, shown, total_word(results)),
        table,
        records,
        caption=caption,
    )


def has_seeds(pairs: list[Pair]) -> bool:
    return any(len(cell.rows) > 1 for pair in pairs for cell in pair.cells.values())


def unit_of(pairs: list[Pair]) -> str:
    if has_seeds(pairs):
        return "seeds, each by the median of its rounds, in which the solvers took turns"
    return "rounds in which the solvers took turns. Both are prepared with the same structure, so both get the shorter of its two times in each round"


def verdicts_of(spec: Spec, pairs: list[Pair]) -> list[Verdict]:
    gained = claims.of("zhang2017", spec.gains)
    gains = in_time_and_work(
        lambda measure: on_average(
            gained, [pair.counted[measure] if measure else pair.ratio for pair in pairs]
        )
    )
    claim = claims.of("zhang2017", "time_by_size")
    timed = [pair for pair in pairs if pair.time(spec.with_it).n]
    sizes = [float(pair.n + pair.m) for pair in timed]
    cells = [pair.cells[spec.with_it] for pair in timed]
    why = reason_apart(origin for cell in cells for origin in cell.origins)

    def grows(measure: str) -> Verdict:
        if why and not measure:
            return Verdict(claim, UNTESTED, f"times {why}")
        return rising(claim, sizes, [cell.cost(measure) for cell in cells])

    return [gains, in_time_and_work(grows)]


def what_it_saves(spec: Spec, pairs: list[Pair]) -> str:
    """Returns a note on how much work and time the part saves (medians over the pairs)."""
    complete = []
    for pair in pairs:
        if pair.ratio.n and all(x.n for x in pair.counted.values()):
            complete.append(pair)
    if not complete:
        return f"These rows do not say how much work {spec.part} saves."
    work = [1 - 1 / pair.counted["distances, bounds and nodes"].value for pair in complete]
    time = [1 - 1 / pair.ratio.value for pair in complete]
    cost = [
        1e9 * pair.time(spec.with_it).value / pair.cells[spec.with_it].count(WORK)
        for pair in complete
    ]
    return (
        f"Over these pairs, {spec.part} saves {numerals.number(100 * float(np.median(work)), 2)} % of the distances, bounds and nodes, and takes "
        f"{numerals.number(100 * float(np.median(time)), 2)} % less time on this machine (medians); one of them costs "
        f"{numerals.number(float(np.median(cost)), 2)} ns, preparation included."
    )


def draw(
    spec: Spec, pairs: list[Pair], papers: dict[int, dict[str, Any]], shown: list[str], clock: str
) -> Any:
    """Draws times by size, and the ratio without / with the part. Filled marks are our times, open
    marks the paper's."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(style.DOUBLE_COLUMN, 2.7))
    solver = spec.with_it
    solver_look = style.look(solver)
    looks = {
        spec.without: style.Look(f"without {spec.part}", style.GREY, "s", style.DOTTED),
        solver: style.Look(
            f"with {spec.part}", solver_look.colour, solver_look.marker, solver_look.line
        ),
    }
    looks |= {label: style.look(label) for label in shown if label in style.LOOKS}
    for label, looks_like in looks.items():
        # No line: |A| and |B| differ from pair to pair, so the pairs are not a series.
        for n, t in sorted(
            (pair.n + pair.m, pair.time(label)) for pair in pairs if pair.time(label).n
        ):
            style.interval(left, t, n, upright=True, color=looks_like.colour, linewidth=1.2)
            left.plot(n, t.value, **style.filled_marker(looks_like))
        sizes = [
            (pair.n + pair.m, papers[pair.number][label])
            for pair in pairs
            if label in papers.get(pair.number, {})
        ]
        if sizes:
            left.plot(*np.array(sorted(sizes)).T, **style.open_marker(looks_like))
    left.set(xscale="log", yscale="log", xlabel="points, |A| + |B|", ylabel=f"{clock} (s)")
    scales.log_ticks(left.xaxis)
    for pair in pairs:
        if pair.ratio.n:
            style.interval(
                right,
                pair.ratio,
                pair.number,
                upright=True,
                color=solver_look.colour,
                linewidth=1.2,
            )
            right.plot(pair.number, pair.ratio.value, **style.filled_marker(solver_look))
        elif pair.cells:
            right.text(
                pair.number, 1.02, "failed", rotation=90, fontsize=6, ha="center", va="bottom"
            )
        paper = papers.get(pair.number, {})
        if spec.without in paper and solver in paper:
            right.plot(
                pair.number, paper[spec.without] / paper[solver], **style.open_marker(solver_look)
            )
    right.axhline(1, color="#333333", linewidth=0.6)
    right.set_ylim(bottom=min(0.8, right.get_ylim()[0]))
    right.set(xlabel="pair of the paper's table", ylabel=f"time without / with {spec.part}")
    right.set_xticks([pair.number for pair in pairs])
    entries = [Line2D([], [], label=x.title, **style.filled_marker(x)) for x in looks.values()]
    style.legend_above(
        figure,
        [*entries, style.filled_entry("filled: here"), style.open_entry("open: the paper")],
        columns=5,
    )
    return figure
