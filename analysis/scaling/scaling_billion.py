"""Forecasts from measured sizes the cost of 10^9 points in each set, computed at once or in shards.

Shards: split A into k cells with equally many points (the cells of a k-d tree). The task of cell i
gets its points A_i, and B_i: all points of B within a margin r of the box of A_i. Its answer u_i =
h(A_i, B_i) is at least h(A_i, B), because B_i is a part of B. If u_i <= r it is exact: each point
of A_i has its nearest point of B within u_i, so in B_i. Otherwise, if u_i is above the largest
exact answer so far (0 if there is none), the task runs again with margin u_i, and is exact by the
same argument; while B_i is empty, the margin is doubled. h(A, B) is the largest exact answer. If a
solver gives an interval, u_i is its upper end, and the box of A_i is rounded outward. The forecast
does not include tasks that run again.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.lines import Line2D

from analysis.scaling.growth import (
    LEAST_BYTES,
    Curve,
    Growth,
    Interval,
    curves,
    growth,
    has_marks,
    notes,
    short,
    tick,
)
from analysis.shared import numerals, style, tables
from analysis.shared.notes import machine_line
from analysis.shared.report import Report
from analysis.shared.results import Results

RESULTS_OF: Final = "scaling_points"
SOLVERS: Final = ("scan", "kdtree", "inc")
DRAWN: Final = "scan"
EACH: Final = 1e9  # points of A, and as many of B
POINT: Final = 24  # bytes: three doubles
COPIES: Final = 2  # copies of a shape in memory while it is loaded
LEAST_SECONDS: Final = 1e-3  # a fixed cost dominates shorter times, so they are not extrapolated
PASSES: Final = 3  # passes over the data: read and write to split, then read the shards
MOST_TASKS: Final = 100_000
MOST_MARGIN: Final = (
    4.0  # if B_i has more than this many times the points of A_i, shards gain little
)
TOO_WIDE: Final = "margin too wide"


@dataclass(frozen=True)
class Shards:
    tasks: int
    points: float  # |A_i| + |B_i|
    margin: float  # |B_i| / |A_i|


def widened(tasks: float, margin: float) -> float:
    """Estimates the points of B in a cell and its margin, as a multiple of the cell's points of A.

    `margin` is a fraction of the diagonal of a cube, in which points are spread evenly over a
    surface: its cells have side / sqrt(tasks), less than for points that fill the cube. Uneven
    points may need half as much again.
    """
    side = 1 / math.sqrt(3) / math.sqrt(tasks)
    return (1 + 2 * margin / side) ** 3


def shards(
    each: float, margin: float, memory: float, bytes_of: Callable[[float], float]
) -> Shards | None:
    """Returns the smallest number of tasks, to within 5 %, at which a task's points and the
    solver's memory fit into `memory`.

    None if there is none up to MOST_TASKS, or if the margin is larger than MOST_MARGIN.
    """
    tasks = 1
    while tasks <= MOST_TASKS:
        wide = min(widened(tasks, margin), float(tasks))  # never more than all of B
        points = each / tasks * (1 + wide)
        if points * POINT * COPIES + bytes_of(points) <= memory:
            return Shards(tasks, points, wide) if wide <= MOST_MARGIN else None
        tasks += max(1, tasks // 20)
    return None


@dataclass(frozen=True)
class Forecast:
    regime: str
    title: str
    distance: Interval  # as a fraction of the diagonal of A
    peak: Interval  # bytes, besides the points
    seconds: Interval  # to prepare and solve
    enough_sizes: bool  # enough sizes were measured for a plan
    plan: Shards | None
    plan_seconds: Interval


def times(x: Interval, factor: float) -> Interval:
    return Interval(factor * x.value, factor * x.low, factor * x.high)


def distances(results: Results, curve: Curve) -> Growth:
    """Fits how h, as a fraction of the diagonal of A, depends on size."""
    cases = results.cases
    return growth(
        curve.sizes,
        [float(cases.upper[row] / cases.source_diagonal[row]) for row in curve.rows],
        0,
        0,
    )


def cost(curve: Curve) -> Growth:
    return curve.growth_of([a + b for a, b in zip(curve.prepare, curve.solve)], LEAST_SECONDS)


def memory_of(curve: Curve) -> Growth:
    return growth(curve.sizes, curve.peak, LEAST_BYTES)


def forecast(results: Results, curve: Curve, memory: float) -> Forecast:
    """Returns the forecast for one solver. The upper ends of the forecast memory and distance set
    shard size and margin."""
    total, seconds, peak, distance = (
        2 * EACH,
        cost(curve),
        memory_of(curve),
        distances(results, curve),
    )
    margin = distance.at(total).high
    enough_sizes = seconds.known and peak.known and math.isfinite(margin)
    plan = shards(EACH, margin, memory, lambda n: peak.at(n).high) if enough_sizes else None
    return Forecast(
        curve.regime,
        curve.title,
        distance.at(total),
        peak.at(total),
        seconds.at(total),
        enough_sizes,
        plan,
        times(seconds.at(plan.points), plan.tasks) if plan else times(seconds.at(total), math.nan),
    )


def text(x: Interval, scale: float) -> str:
    """Formats an interval, scaled: '70 [61, 82]'."""
    if math.isnan(x.value):
        return numerals.NOTHING
    return f"{numerals.number(scale * x.value, 2)} {numerals.bounds(x.low, x.high, 2, times=scale)}"


def make(results: Results) -> Report:
    everyone = curves(results)
    chosen = [curve for curve in everyone if curve.label in SOLVERS]
    left_out = dict.fromkeys(curve.title for curve in everyone if curve.label not in SOLVERS)
    cores, memory = max(1, int(results.meta.get("cores", 1))), float(
        results.meta.get("memory_bytes", math.nan)
    )
    predictions = [forecast(results, curve, memory / cores) for curve in chosen]
    largest = max((curve.sizes[-1] for curve in chosen if curve.sizes), default=math.nan)
    table = tables.Table(
        f"{short(EACH)} points in A and as many in B: a forecast from sizes of up to {short(largest)} points in all; never run.",
        [
            "regime",
            "solver",
            "h, of the diagonal",
            "points, GB",
            "solver, GB besides",
            "prepare and solve, s",
            "tasks",
            "points of a task",
            "|B| / |A| of a task",
            "all tasks, s",
        ],
        left=2,
    )
    records: list[tables.Record] = []
    for prediction in predictions:
        plan = prediction.plan
        table.rows.append(
            [
                prediction.regime,
                prediction.title,
                text(prediction.distance, 1),
                numerals.number(2 * EACH * POINT / 1e9),
                text(prediction.peak, 1e-9),
                text(prediction.seconds, 1),
                *(
                    [
                        str(plan.tasks),
                        short(plan.points),
                        numerals.number(plan.margin),
                        text(prediction.plan_seconds, 1),
                    ]
                    if plan
                    else [
                        TOO_WIDE if prediction.enough_sizes else numerals.NOTHING,
                        *3 * [numerals.NOTHING],
                    ]
                ),
            ]
        )
        records.append(
            {
                "regime": prediction.regime,
                "solver": prediction.title,
                "each": EACH,
                **{
                    f"{name}_{end}": getattr(x, end)
                    for name, x in (
                        ("distance", prediction.distance),
                        ("peak_bytes", prediction.peak),
                        ("seconds", prediction.seconds),
                        ("tasks_seconds", prediction.plan_seconds),
                    )
                    for end in ("value", "low", "high")
                },
                "tasks": plan.tasks if plan else 0,
                "points_of_a_task": plan.points if plan else math.nan,
            }
        )
    table.notes = [
        "Brackets: Student's interval of 95 % for one more measurement at that size, if costs keep growing as they did; nothing was measured there.",
        f"Tasks: the fewest (to one in twenty) that fit in the memory per core of the machine below ({numerals.number(memory / cores / 1e9, 2)} GB), at the "
        f"upper ends of the forecasts, with points counted {COPIES} times for loading. A task takes a cell of A (of a k-d tree, with equally many points "
        "each) and all points of B within a margin of its box: the upper end of h. Its answer is exact if it is at most the margin. Otherwise, if it is "
        "above the largest exact answer, the task runs again with its answer as margin, and is then exact. The largest exact answer is h(A,B). |B| / |A| is "
        "an estimate for evenly spread points. No program here splits point sets: this is a plan.",
        "All tasks: their number times the forecast for one task, as if they all erred alike; without loading, splitting and tasks that run again.",
        f"{TOO_WIDE}: it takes in more than {MOST_MARGIN:g} times as many points as a cell has, so cells gain little. "
        f"{numerals.NOTHING}: too few sizes are "
        "known for a forecast.",
        f"Left out: {', '.join(left_out)}." if left_out else "",
        f"The files take {numerals.number(2 * EACH * POINT / 1e9)} GB and are passed over {PASSES} times (read and written to split them, read by the tasks): "
        f"{numerals.number(PASSES * 2 * EACH * POINT / 1e9)} GB, {numerals.number(PASSES * 2 * EACH * POINT / 5e8 / 60, 2)} min at 500 MB/s.",
        "A process numbers points with 32 bits: at most 2.1G in each set.",
        *[f"{regime}: {note}." for regime, note in notes(results).items()],
        f"{machine_line(results)}.",
    ]
    table.notes = [note for note in table.notes if note]
    drawn = [curve for curve in chosen if curve.label == DRAWN]
    has_line = any(
        cost(curve).known or memory_of(curve).known for curve in drawn
    )  # otherwise there is no line to draw
    return Report((lambda: draw(drawn, memory)) if has_line else None, table, records)


def draw(drawn: list[Curve], memory: float) -> Any:
    """Draws the measured costs, the line through them, and the band of the forecast."""
    figure, axes = plt.subplots(1, 2, figsize=(style.DOUBLE_COLUMN, 2.6))
    colours = [style.look(name).colour for name in ("scan", "ohd", "nohd", "adaptive")]
    entries = []
    for i, (curve, colour) in enumerate(zip(drawn, colours)):
        for ax, grown, besides in (
            (axes[0], cost(curve), 0.0),
            (axes[1], memory_of(curve), float(POINT)),
        ):
            if not grown.sizes:
                continue
            measured = np.array(grown.costs) + besides * np.array(grown.sizes)
            ax.plot(
                grown.sizes,
                measured,
                marker="ov^s"[i],
                color=colour,
                linestyle="none",
                markersize=3.5,
            )
            if not grown.known:
                continue
            sizes = np.geomspace(min(grown.sizes), 2 * EACH, 60)
            foretold = [grown.at(float(n)) for n in sizes]
            ax.plot(
                sizes,
                [x.value + besides * n for x, n in zip(foretold, sizes)],
                color=colour,
                linewidth=0.8,
            )
            low = [x.low + besides * n for x, n in zip(foretold, sizes)]
            high = [x.high + besides * n for x, n in zip(foretold, sizes)]
            ax.fill_between(sizes, low, high, color=colour, alpha=0.15, linewidth=0)
        entries.append(
            Line2D(
                [],
                [],
                label=curve.regime,
                marker="ov^s"[i],
                color=colour,
                linewidth=0.8,
                markersize=3.5,
            )
        )
    for ax in axes:
        if has_marks(ax):
            ax.axvline(2 * EACH, color=style.GREY, linewidth=0.8, linestyle=style.DOTTED)
            ax.annotate(
                f"{short(EACH)} points in each",
                (2 * EACH, 0.02),
                xycoords=("data", "axes fraction"),
                xytext=(-2, 0),
                textcoords="offset points",
                fontsize=6.5,
                color=style.GREY,
                rotation=90,
                ha="right",
                va="bottom",
            )
        ax.set(xlabel="points, |A| + |B|")
    if math.isfinite(memory) and has_marks(axes[1]):
        axes[1].axhline(memory, color=style.GREY, linewidth=0.8, linestyle=style.DASHED)
        entries.append(
            Line2D(
                [],
                [],
                label="memory of this machine",
                color=style.GREY,
                linewidth=0.8,
                linestyle=style.DASHED,
            )
        )
    axes[0].set_ylabel("prepare and solve (s)")
    axes[1].set_ylabel("points and peak (bytes)")
    tick(axes)
    style.legend_above(figure, entries, columns=4)
    return figure
