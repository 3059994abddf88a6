"""Fig. 2 of Sacht and Jacobson 2024: the speedup of their method over Zheng's, on meshes and their
halves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.artist import Artist
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from analysis.shared import claims, numerals, scales, style, tables
from analysis.shared.cells import MEASURES, Cell, compare, compare_work, in_time_and_work
from analysis.shared.comparable import reason_apart
from analysis.shared.notes import clock_word, machine_line, total_word
from analysis.shared.over_pairs import arithmetic_mean, geometric_mean, mean_at_least, wins_more
from analysis.shared.report import Report
from analysis.shared.results import Results
from analysis.shared.estimates import Estimate
from analysis.shared.verdicts import UNTESTED, Verdict, rising

FAST, SLOW = "sacht", "zheng"
PAPER = 16.0  # the paper's mean speedup
TENS = 10.0  # "tens of times"
SIZES = ((0, 1_000), (1_000, 5_000), (5_000, 20_000), (20_000, 10**12))  # triangles of A
NEVER_RAN = ("skipped", "failed", "not_built")


@dataclass(frozen=True)
class Pair:
    scene: str
    triangles: int
    cells: dict[str, Cell]  # by solver
    limit: float
    distance: float  # h over the diagonal of A

    def seconds(self, solver: str) -> float:
        return self.cells[solver].time.value

    def unfinished(self, solver: str) -> bool:
        """Returns whether the solver was stopped or failed before it reached the tolerance."""
        return bool(self.cells[solver].failures)

    def timed_out(self, solver: str) -> bool:
        """Returns whether the solver reached the time limit on some row."""
        return bool(self.cells[solver].failures["timeout"])

    @property
    def both(self) -> bool:
        return not self.unfinished(FAST) and not self.unfinished(SLOW)

    def ratio(self, measure: str = "") -> float:
        """Returns Zheng / Sacht, as a ratio of times or of counts MEASURES[measure]; NaN if one of the
        two has none."""
        if not self.both:
            return np.nan
        pair = self.cells[SLOW], self.cells[FAST]
        return (compare_work(*pair, MEASURES[measure]) if measure else compare(*pair)).value


class Pairs:
    def __init__(self, results: Results) -> None:
        self.results = results
        self.pairs: list[Pair] = []
        self.lost: dict[str, str] = {}  # pairs whose model is missing, and why
        cases = results.cases
        for scene in results.scenes:
            rows = {solver: results.rows(scene=scene, label=solver) for solver in (FAST, SLOW)}
            absent = [
                cases.reason[r] or cases.status[r]
                for of in rows.values()
                for r in of
                if cases.status[r] in NEVER_RAN
            ]
            if absent or not all(rows.values()):
                self.lost[scene] = absent[0] if absent else "one solver was not run"
                continue
            first = rows[FAST][0]
            self.pairs.append(
                Pair(
                    scene,
                    int(cases.source_elements[first]),
                    {solver: Cell(results, of) for solver, of in rows.items()},
                    float(cases.case_seconds_limit[first]),
                    results.share(first),
                )
            )

    def ratios(self, measure: str = "", pairs: Sequence[Pair] | None = None) -> list[float]:
        ratios = (pair.ratio(measure) for pair in (self.pairs if pairs is None else pairs))
        return [ratio for ratio in ratios if np.isfinite(ratio) and ratio > 0]

    def why_apart(self) -> str:
        """Returns why the times of some pair are not comparable; empty if all are."""
        reasons = (
            reason_apart(pair.cells[SLOW].origins | pair.cells[FAST].origins)
            for pair in self.pairs
            if pair.both
        )
        return next(filter(None, reasons), "")

    def count_unfinished(self, solver: str, pairs: Sequence[Pair] | None = None) -> int:
        return sum(pair.unfinished(solver) for pair in (self.pairs if pairs is None else pairs))


def verdicts(measured: Pairs) -> list[Verdict]:
    """Judges the claims of the figure. Claims about means are judged in time and in counted
    work."""

    why = measured.why_apart()

    def means(name: str, mean: Any, bar: float, kind: str) -> Verdict:
        claim = claims.of("sacht2024", name)

        def judge(measure: str) -> Verdict:
            if why and not measure:
                return Verdict(claim, UNTESTED, f"times {why}")
            return mean_at_least(claim, mean(measured.ratios(measure)), bar, kind)

        return in_time_and_work(judge)

    done = {
        solver: np.array([not pair.unfinished(solver) for pair in measured.pairs], dtype=bool)
        for solver in (FAST, SLOW)
    }
    return [
        means("faster", geometric_mean, 1.0, "geometric mean"),
        means("sixteen_geometric", geometric_mean, PAPER, "geometric mean"),
        means("sixteen_arithmetic", arithmetic_mean, PAPER, "arithmetic mean"),
        means("tens", geometric_mean, TENS, "geometric mean"),
        wins_more(
            claims.of("sacht2024", "ends_on_more"),
            {"Sacht": done[FAST]},
            {"Zheng": done[SLOW]},
            "ends on",
        ),
        nearer_more(measured),
    ]


def nearer_more(measured: Pairs) -> Verdict:
    """Judges the claim that Sacht's method subdivides more (per triangle of A) on nearer pairs,
    among the pairs it finished."""
    ended = [
        pair for pair in measured.pairs if not pair.unfinished(FAST) and np.isfinite(pair.distance)
    ]
    nearness = [-pair.distance for pair in ended]
    subdivisions = [
        pair.cells[FAST].counters.get("subdivisions", 0) / pair.triangles for pair in ended
    ]
    return rising(claims.of("sacht2024", "nearer_more"), nearness, subdivisions)


def make(results: Results) -> Report:
    measured = Pairs(results)
    word = clock_word(results)
    table = tables.Table(
        f"{word[0].upper()}{word[1:]} of Zheng divided by Sacht's, to a gap of 1e-8 of the diagonal of A, by the number of triangles of A; A is a mesh and B "
        "the same mesh with half of its triangles, as in Fig. 2 of Sacht and Jacobson 2024.",
        [
            "triangles of A",
            "pairs",
            "not ended: Zheng",
            "Sacht",
            "geometric mean",
            "arithmetic mean",
            "least",
            "greatest",
            "Sacht faster, %",
            *[f"{measure}: geometric mean" for measure in MEASURES],
        ],
    )
    for low, high in (*SIZES, (0, 10**12)):
        part = [pair for pair in measured.pairs if low <= pair.triangles < high]
        if not part:
            continue
        table.rules |= {len(table.rows)} if (low, high) == (0, 10**12) else set()
        table.rows.append(
            [
                size_text(low, high),
                str(len(part)),
                str(measured.count_unfinished(SLOW, part)),
                str(measured.count_unfinished(FAST, part)),
                *numbers_of(measured.ratios("", part)),
                *[
                    numerals.estimate(geometric_mean(measured.ratios(measure, part)))
                    for measure in MEASURES
                ],
            ]
        )
    table.rows.append(
        [
            "paper",
            "9,971",
            "38",
            "1",
            numerals.NOTHING,
            "16 (kind of mean not stated)",
            *[numerals.NOTHING] * (3 + len(MEASURES)),
        ]
    )
    table.verdicts = verdicts(measured)
    table.notes = [
        *notes(measured),
        "Meshes of Debian and npm packages (datasets/corpus.toml) stand in for Thingi10K, and CGAL's edge collapse for Blender's decimation. "
        "Both solvers are ours, written after the papers, with the same kernels and trees; the paper compares two programs.",
        "Time covers preparing and the first answer: the median of "
        + rounds_text(measured)
        + "; ratios are paired by round.",
        f"Here: {machine_line(results)}.",
    ]
    records: list[tables.Record] = []
    for pair in measured.pairs:
        work_ratios = {f"ratio: {measure}": pair.ratio(measure) for measure in MEASURES}
        for solver, cell in pair.cells.items():
            records.append(
                {
                    "scene": pair.scene,
                    "triangles": pair.triangles,
                    "solver": solver,
                    "status": cell.status(),
                    "n": cell.time.n,
                    "seconds": cell.time.value,
                    "ratio": pair.ratio(),
                    **work_ratios,
                    **cell.counters,
                }
            )
    records += [{"scene": scene, "status": why} for scene, why in measured.lost.items()]
    return Report(lambda: draw(measured), table, records)


def rounds_text(measured: Pairs) -> str:
    counts = sorted(
        {cell.time.n for pair in measured.pairs for cell in pair.cells.values() if cell.time.n}
    )
    return (
        "no rounds"
        if not counts
        else f"n = {' or '.join(map(str, counts))} rounds (fresh processes)"
    )


def size_text(low: int, high: int) -> str:
    return (
        "all"
        if (low, high) == (0, 10**12)
        else f"from {low:,}"
        if high == 10**12
        else f"{low:,} to {high:,}"
    )


def numbers_of(ratios: Sequence[float]) -> list[str]:
    if not ratios:
        return [numerals.NOTHING] * 5
    return [
        numerals.estimate(geometric_mean(ratios)),
        numerals.estimate(arithmetic_mean(ratios)),
        numerals.number(min(ratios)),
        numerals.number(max(ratios)),
        numerals.number(100 * sum(x > 1 for x in ratios) / len(ratios)),
    ]


def notes(measured: Pairs) -> list[str]:
    """Returns notes on how the means were computed, and on the pairs that they leave out."""
    limits = sorted({pair.limit for pair in measured.pairs})
    left = [pair for pair in measured.pairs if not pair.both]
    text = (
        f"Means are over the pairs that both solvers finished within {' or '.join(f'{x:g}' for x in limits)} s; in the paper, 180 s. Brackets: Student's "
        "interval over pairs (of logarithms for the geometric mean). "
    )
    if left:
        shown = []
        for pair in left[:8]:
            failures = ", ".join(
                f"{solver} {pair.cells[solver].failure_text()}"
                for solver in (SLOW, FAST)
                if pair.unfinished(solver)
            )
            shown.append(f"{pair.scene} ({failures})")
        text += (
            f"Left out: {', '.join(shown)}"
            + (f" and {len(left) - 8} more" if len(left) > 8 else "")
            + "."
        )
    ranked = sorted(
        (pair for pair in measured.pairs if pair.both and pair.ratio() > 0), key=Pair.ratio
    )
    ends = [
        f"{pair.scene} {numerals.number(pair.ratio())} ({numerals.number(1e3 * pair.seconds(SLOW))} against "
        f"{numerals.number(1e3 * pair.seconds(FAST))} ms)"
        for pair in [*ranked[-3:][::-1], *ranked[:1]]
    ]
    lines = [
        text.strip(),
        *(
            [f"The three greatest ratios and the least: {'; '.join(ends)}."]
            if len(ranked) > 3
            else []
        ),
    ]
    if measured.lost:
        some = "; ".join(f"{scene}: {why}" for scene, why in list(measured.lost.items())[:3])
        lines.append(f"{len(measured.lost)} pairs have no rows with an answer ({some}).")
    return lines


def draw(measured: Pairs) -> Any:
    """Draws one point per pair; times on the left, counted work on the right."""
    figure, axes = plt.subplots(1, 2, sharey=True, figsize=(style.DOUBLE_COLUMN, 2.7))
    looks, work = style.look(FAST), list(MEASURES)[-1]
    many = len(measured.pairs) > 60
    for ax, measure in zip(axes, ("", work)):
        points = [
            (pair.triangles, pair.ratio(measure))
            for pair in measured.pairs
            if pair.both and pair.ratio(measure) > 0
        ]
        triangles = [x for x, _ in points]
        ratios = [y for _, y in points]
        ax.plot(
            triangles,
            ratios,
            "o",
            color=looks.colour,
            markersize=2.6 if many else 4.0,
            markeredgecolor="white",
            markeredgewidth=0.25,
            zorder=3,
        )
        mean: Estimate = geometric_mean(ratios)
        ax.axhline(1, color="black", linewidth=0.6, zorder=1)
        ax.axhline(PAPER, color="#0072B2", linewidth=0.9, linestyle=style.DOTTED, zorder=1)
        if mean.n:
            ax.axhline(mean.value, color="#D55E00", linewidth=0.9, linestyle=style.DASHED, zorder=2)
            if mean.has_interval:
                ax.axhspan(
                    mean.low, mean.high, color="#D55E00", alpha=0.15, linewidth=0, zorder=0.5
                )
        ax.set(
            xscale="log",
            yscale="log",
            xlabel="triangles of A",
            title=f"counted {work}" if measure else total_word(measured.results),
        )
    for pair in measured.pairs:  # one was stopped: an arrow, as the true ratio is farther out
        unfinished = [solver for solver in (SLOW, FAST) if pair.unfinished(solver)]
        if len(unfinished) == 1 and pair.timed_out(unfinished[0]):
            seconds = [
                pair.limit if pair.unfinished(solver) else pair.seconds(solver)
                for solver in (SLOW, FAST)
            ]
            axes[0].plot(
                pair.triangles,
                seconds[0] / seconds[1],
                "^" if unfinished == [SLOW] else "v",
                color=looks.colour,
                markerfacecolor="white",
                markersize=4.2,
                markeredgewidth=0.8,
                zorder=3,
            )
    axes[0].set_ylabel("Zheng / Sacht")
    low, high = axes[0].get_ylim()
    axes[0].set_ylim(min(low, 0.5), max(high, 30))
    narrow = axes[0].get_ylim()[1] / axes[0].get_ylim()[0] < 300
    sizes = [pair.triangles for pair in measured.pairs] or [1000]
    for ax in axes:
        ax.set_xlim(0.8 * min(sizes), 1.25 * max(sizes))
        scales.log_ticks(ax.xaxis)
        ax.yaxis.set_minor_locator(NullLocator())
        ax.yaxis.set_major_locator(
            FixedLocator([10.0**k for k in range(-4, 7)] + ([0.5, 2, 5, 20] if narrow else []))
        )
        ax.yaxis.set_major_formatter(FuncFormatter(lambda y, _: f"{y:,g}"))
    entries: list[Artist] = [
        Line2D(
            [], [], marker="o", linestyle="none", color=looks.colour, markersize=4, label="a pair"
        )
    ]
    for slow, fast, marker, bound in ((SLOW, FAST, "^", "more"), (FAST, SLOW, "v", "less")):
        if any(pair.timed_out(slow) and not pair.unfinished(fast) for pair in measured.pairs):
            entries.append(
                Line2D(
                    [],
                    [],
                    marker=marker,
                    linestyle="none",
                    color=looks.colour,
                    markerfacecolor="white",
                    markersize=4.2,
                    label=f"{slow.title()} at the limit: {bound} than this",
                )
            )
    entries += [
        Line2D(
            [], [], color="#D55E00", linewidth=0.9, linestyle=style.DASHED, label="geometric mean"
        ),
        Patch(facecolor="#D55E00", alpha=0.15, linewidth=0, label="its interval of 95 %"),
        Line2D(
            [],
            [],
            color="#0072B2",
            linewidth=0.9,
            linestyle=style.DOTTED,
            label="16, the paper's average",
        ),
    ]
    style.legend_above(figure, entries, columns=3)
    return figure
