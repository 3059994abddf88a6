"""Compares the inner steps of EARLYBREAK that Eqs. 4 to 7 of Zhang et al. 2017 predict with counted
ones."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Final

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.lines import Line2D

from analysis.shared import claims, numerals, scales, shapes, style, tables
from analysis.shared.columns import Floats
from analysis.shared.notes import machine_line
from analysis.shared.report import NO_TIMES, Report
from analysis.shared.results import Results
from analysis.shared.estimates import Estimate, median
from analysis.shared.verdicts import Verdict, constant, rising_by_run

MOST: Final = 4000  # points of A whose distances to all of B are computed
CONSTANT: Final = 1.25  # c counts as constant within this factor; the paper gives no number
STAND_INS: Final = {
    "pears, a tenth": "an orange, sampled twice"
}  # as in Table 3; the scene has no note
EXPECTED = style.Look("1/mean p (Eq. 7, c = 1)", style.GREY, "s", style.DASHED)
BY_POINT = style.Look("mean of 1/p over the points of A", "#000000", "d", style.DOTTED)


@dataclass(frozen=True)
class Step:
    scene: str
    shift: float
    distance: float
    counted: Estimate  # inner steps per point of A; over seeds
    by_seed: dict[int, float]
    expected: float  # 1/p, where p is the share of all pairs that end the inner loop
    by_point: float  # expected steps, averaged over the points of A

    @property
    def c(self) -> float:
        """The factor c in: counted steps = 1 / (c * p). The paper calls it constant."""
        return (
            self.expected / self.counted.value
            if self.counted.n and self.counted.value > 0
            else math.nan
        )


def expectations(a: Floats, b: Floats, distance: float) -> tuple[float, float]:
    """Returns 1/p, and the expected number of steps averaged over the points of A, if cmax were
    `distance` from the start.

    B is shuffled, so steps are draws without replacement. If k of the m points of B are near
    enough, the first of these is expected after (m + 1) / (k + 1) draws; if k = 0, all m are drawn.
    O(|A| |B|).
    """
    m = len(b)
    near = np.zeros(len(a))
    squared = (b * b).sum(axis=1)
    for begin in range(0, len(a), 100):
        part = a[begin : begin + 100]
        between = (part * part).sum(axis=1)[:, None] + squared - 2 * part @ b.T
        near[begin : begin + 100] = (between < distance * distance * (1 - 1e-12)).sum(axis=1)
    share = float(near.mean()) / m
    draws = np.where(near > 0, (m + 1) / (near + 1), m)
    return (1 / share if share > 0 else math.inf), float(draws.mean())


def collect(results: Results) -> list[Step]:
    cases, steps = results.cases, []
    for scene in results.scenes:
        for pose in sorted({int(p) for p in cases.pose_index[results.rows(scene=scene)]}):
            rows = results.rows(scene=scene, pose_index=pose, status="ok", solver="earlybreak")
            if not rows:
                continue
            first = rows[0]
            n = int(cases.source_elements[first])
            by_seed = {
                int(results.options(row).get("seed", 0)): float(
                    cases.counters["point_distances"][row]
                )
                / n
                for row in rows
            }
            counted = median(list(by_seed.values()))
            distance = results.middle(first)
            a, b = shapes.points(results, cases.source[first]), shapes.points(
                results, cases.target[first]
            )
            expected = by_point = math.nan
            if a is not None and b is not None:
                some = a[:: -(-n // MOST)]
                expected, by_point = expectations(
                    shapes.posed(some, cases.pose[first]), b, distance
                )
            steps.append(
                Step(
                    scene,
                    float(cases.pose[first][9]),
                    distance,
                    counted,
                    by_seed,
                    expected,
                    by_point,
                )
            )
    return steps


def make(results: Results) -> Report:
    steps = collect(results)
    scenes = list(dict.fromkeys(step.scene for step in steps))
    table = tables.Table(
        "Inner steps of EARLYBREAK per point of A: expected by Eqs. 4 to 7 of Zhang et "
        "al. 2017, and counted.",
        [
            "pair",
            "shift",
            "h(A, B)",
            "counted",
            "1/mean p (Eq. 7, c = 1)",
            "counted / (1/mean p)",
            "mean of 1/p",
            "counted / mean of 1/p",
        ],
        left=1,
    )
    records: list[tables.Record] = []
    for scene in scenes:
        table.rules.add(len(table.rows))
        for step in [step for step in steps if step.scene == scene]:
            table.rows.append(
                [
                    scene,
                    numerals.number(step.shift),
                    numerals.number(step.distance, 4),
                    numerals.estimate(step.counted),
                    numerals.number(step.expected),
                    numerals.number(step.counted.value / step.expected),
                    numerals.number(step.by_point),
                    numerals.number(step.counted.value / step.by_point),
                ]
            )
            records.append(
                {
                    "scene": scene,
                    "shift": step.shift,
                    "distance": step.distance,
                    "n": step.counted.n,
                    "counted": step.counted.value,
                    "counted_low": step.counted.low,
                    "counted_high": step.counted.high,
                    "expected": step.expected,
                    "by_point": step.by_point,
                    "c": step.c,
                }
            )
    table.verdicts = []
    for scene in scenes:
        table.verdicts += verdicts([step for step in steps if step.scene == scene])
    table.notes = [
        f"Counted: distances computed / |A|; medians of {max((s.counted.n for s in steps), default=0)} seeds with order-statistic intervals. "
        "1/mean p: the mean is the share of all pairs that are nearer than h, as if cmax were h from the start. Mean of 1/p: the same for each "
        "point of A separately, drawn without replacement, then averaged: 1/p of an average is less than the average of 1/p, which Eq. 6 "
        f"ignores. At most {MOST:,} points of A are looked at. A dash: the points are not in datasets/cache.",
        f"Here: {machine_line(results)}.",
    ]
    return Report(lambda: draw(steps, scenes), table, records, clock=NO_TIMES)


def verdicts(steps: list[Step]) -> list[Verdict]:
    """Judges the claims on one scene. Only seeds count as independent, because neighbouring poses
    are alike."""
    scene = steps[0].scene
    predicted = [step for step in steps if math.isfinite(step.expected)]
    seeds = sorted(set.intersection(*[set(step.by_seed) for step in steps]))

    def runs(of: list[Step], x: list[float]) -> list[tuple[list[float], list[float]]]:
        by_run = []
        for seed in seeds:
            by_run.append((x, [step.by_seed[seed] for step in of]))
        return by_run

    distances = [-step.distance for step in steps]
    expected = [step.expected for step in predicted]
    factors = []
    for step in predicted:
        factors.append([step.expected / step.by_seed[seed] for seed in seeds])
    return [
        rising_by_run(claims.of("zhang2017", "steps_by_distance", scene), runs(steps, distances)),
        rising_by_run(
            claims.of("zhang2017", "steps_by_expectation", scene), runs(predicted, expected)
        ),
        constant(claims.of("zhang2017", "steps_constant", scene), factors, CONSTANT),
    ]


def draw(steps: list[Step], scenes: list[str]) -> Any:
    figure, axes = plt.subplots(
        1, max(1, len(scenes)), figsize=(style.DOUBLE_COLUMN, 2.5), squeeze=False
    )
    counted = style.look("earlybreak")
    for ax, scene in zip(axes[0], scenes):
        in_order = sorted(
            (step for step in steps if step.scene == scene), key=lambda step: step.shift
        )
        x = [step.shift for step in in_order]
        expected = [step.expected for step in in_order]
        by_point = [step.by_point for step in in_order]
        for looks, values in ((EXPECTED, expected), (BY_POINT, by_point)):
            if any(math.isfinite(v) for v in values):
                ax.plot(x, values, color=looks.colour, linestyle=looks.line, linewidth=0.9)
        ax.plot(x, [s.counted.value for s in in_order], color=counted.colour, linewidth=0.7)
        for step in in_order:
            style.interval(
                ax, step.counted, step.shift, upright=True, color=counted.colour, linewidth=1.2
            )
            ax.plot(step.shift, step.counted.value, **style.filled_marker(counted))
        ax.set(
            yscale="log",
            xlabel="shift along x (units of the model)",
            title=scene + (f"\n(stand-in: {STAND_INS[scene]})" if scene in STAND_INS else ""),
        )
        scales.log_ticks(ax.yaxis)
    axes[0][0].set_ylabel("inner steps per point of A")
    entries = [
        Line2D(
            [],
            [],
            label="counted (EARLYBREAK)",
            linewidth=0.7,
            **{**style.filled_marker(counted), "linestyle": "-"},
        )
    ]
    if any(math.isfinite(step.expected) for step in steps):
        entries += [
            Line2D(
                [], [], label=looks.entry, color=looks.colour, linestyle=looks.line, linewidth=0.9
            )
            for looks in (EXPECTED, BY_POINT)
        ]
    style.legend_above(figure, entries)
    return figure
