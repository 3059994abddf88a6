"""Table 2 of Tang et al. 2009: the two-sided distance while one model is translated towards
another."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Final

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.lines import Line2D

from analysis.shared import numerals, scales, style, tables
from analysis.shared.load import paper_numbers
from analysis.shared.notes import clock_title, clock_word, machine_line
from analysis.shared.report import Report
from analysis.shared.results import Results
from analysis.shared.verdicts import Verdict
from analysis.tang2009 import tang_motion, tang_pictures
from analysis.tang2009.tang_motion import QUERIES, Motion, Run

REAL_TIME: Final = 1 / 30  # seconds that count as real-time
WARM: Final = (("tang", "tang, warm"), ("cover", "cover, warm"))
HEADER: Final = (
    "pair",
    "",
    "|A| / |B|",
    "poses",
    "mean, ms",
    "least",
    "most",
    "culled on A, %",
    "culled on B, %",
    "deepest",
    "queries, median",
)


def verdicts(motions: list[Motion]) -> list[Verdict]:
    return [
        *tang_motion.culling(motions, "tang"),
        tang_motion.faster_than(motions, "tang", "fraction", 1.0),
        tang_motion.faster_than(motions, "tang", "greatest", 1.0, slowest=True),
        tang_motion.faster_than(motions, "tang", "real_time", REAL_TIME),
        tang_motion.within_tolerance(motions, "tang"),
        tang_motion.subdivided(motions, "tang"),
        tang_motion.depth(motions, "tang"),
        tang_motion.rising(motions, "tang"),
        *[tang_motion.warm_pays(motions, cold, warm) for cold, warm in WARM],
    ]


def cells(run: Run) -> list[str]:
    if not run.complete:
        failed = sum(run.results.cases.status[row] != "ok" for row in run.rows)
        return [f"{failed} of {len(run.rows)} poses failed", *[numerals.NOTHING] * 6]
    return [
        numerals.estimate(run.mean, 1e3),
        numerals.number(1e3 * float(run.per_pose.min())),
        numerals.number(1e3 * float(run.per_pose.max())),
        *[numerals.number(100 * run.mean_told(f"culled on {side}"), 4) for side in ("A", "B")],
        f"{np.nanmax(run.deepest):g}" if np.isfinite(run.deepest).any() else numerals.NOTHING,
        f"{np.median(run.counted(QUERIES)[1:]):g}",
    ]


def make(results: Results) -> Report:
    motions, printed = tang_motion.motions(results), paper_numbers(results.stem)
    papers = {"/".join(row["models"]): row for row in printed["row"]}
    table = tables.Table(
        f"{clock_title(results)} of the two-sided distance at a pose, while A is translated towards B; measured here, and as printed in "
        "Table 2 of Tang et al. 2009.",
        list(HEADER),
        left=2,
    )
    records: list[tables.Record] = []
    for motion in motions:
        table.rules.add(len(table.rows))
        for i, (solver, label) in enumerate(motion.labels):
            run = motion.runs[label]
            table.rows.append(
                [
                    motion.scene if i == 0 else "",
                    style.title(solver, label),
                    motion.sizes if i == 0 else "",
                    str(len(run.rows)),
                    *cells(run),
                ]
            )
            records += record(motion, label)
        if paper := papers.get(motion.scene):
            table.rows.append(
                [
                    "",
                    "paper",
                    numerals.NOTHING,
                    numerals.NOTHING,
                    *[
                        f"{paper[key]:.6g}"
                        for key in ("average", "least", "most", "cull_on_source", "cull_on_target")
                    ],
                    numerals.NOTHING,
                    numerals.NOTHING,
                ]
            )
    table.verdicts = verdicts(motions)
    table.notes = [
        "The paper's models are not public. "
        + "; ".join(f"{motion.scene}: {motion.note}" for motion in motions)
        + ".",
        "A starts three times its longest side away. Tolerance 1e-4 of A's longest side: the paper gives 1e-4 without a unit, so that choice is "
        "ours. Structures are built once, before the motion; in the second direction B moves, which is replaced by the inverse motion of A.",
        "Culled on A: the share of A's triangles settled before culling on B; culled on B: the share of B's triangles that a remaining triangle "
        "of A is not measured against. Both are means over poses and directions. Deepest: nested subdivisions. Queries: closest point queries at "
        "a pose.",
        "The mean over the poses is one number per round (a fresh process that answers all poses), with its interval over rounds from six on; "
        "least and most are among the poses' medians. Warm: from what the previous pose left.",
        f"Paper: {printed['machine']}.",
        f"Here: {machine_line(results)}.",
    ]
    caption = (
        f"{clock_title(results)}, in ms, of the two-sided distance at a pose against the distance, while A is translated towards B: the motion goes "
        "from left to right (Table 2 of Tang et al. 2009). Dashed: warm, from what the previous pose left. Markers: every tenth pose. Titles name "
        "the pair, the triangles of A / B, and the models that stand in for the paper's."
    )
    return Report(lambda: draw(motions, clock_word(results)), table, records, caption=caption)


def record(motion: Motion, label: str) -> list[tables.Record]:
    run = motion.runs[label]
    times = run.per_pose if len(run.per_pose) else np.full(len(run.rows), np.nan)
    records: list[tables.Record] = []
    for i, row in enumerate(run.rows):
        counters = {name: int(counts[row]) for name, counts in run.results.cases.counters.items()}
        records.append(
            {
                "scene": motion.scene,
                "label": label,
                "pose": int(run.results.cases.pose_index[row]),
                "status": run.results.cases.status[row],
                "distance_of_longest": float(run.distance[i]),
                "seconds": float(times[i]),
                "rounds": len(run.by_round),
                "lower": float(run.results.cases.lower[row]),
                "upper": float(run.results.cases.upper[row]),
                **counters,
                **run.results.extras(row),
            }
        )
    return records


def look(solver: str, label: str) -> style.Look:
    """Returns the look of a solver; variants with a warm start have dashed lines."""
    warm = (solver, label) in WARM
    return (
        replace(style.look(solver, label), line=style.DASHED, title=f"{style.title(solver)}, warm")
        if warm
        else style.look(solver, label)
    )


def draw(motions: list[Motion], clock: str) -> Any:
    """Draws time against distance, one panel per pair."""
    columns = min(3, len(motions))
    figure, axes = plt.subplots(
        -(-len(motions) // columns),
        columns,
        figsize=(style.DOUBLE_COLUMN, 2.2 * -(-len(motions) // columns) + 0.5),
        squeeze=False,
    )
    for ax in axes.flat[len(motions) :]:
        ax.set_visible(False)
    for ax, motion in zip(axes.flat, motions):
        for solver, label in motion.labels:
            run, looks = motion.runs[label], look(solver, label)
            if len(run.per_pose):
                ax.plot(
                    100 * run.distance,
                    1e3 * run.per_pose,
                    color=looks.colour,
                    linestyle=looks.line,
                    linewidth=0.8,
                )
                ax.plot(
                    100 * run.distance[::10], 1e3 * run.per_pose[::10], **style.filled_marker(looks)
                )
        ax.set(
            xscale="log", yscale="log", title=tang_pictures.short_title(run.results, motion.first)
        )
        ax.invert_xaxis()
        scales.log_ticks(ax.xaxis)
        scales.log_ticks(ax.yaxis)
    for ax in axes[:, 0]:
        ax.set_ylabel(f"{clock} (ms)")
    for ax in axes[-1]:
        ax.set_xlabel("H(A, B), % of A's longest side")
    entries = []
    for solver, label in tang_motion.labels_of(motions):
        looks = look(solver, label)
        marker = style.filled_marker(looks) | {"linestyle": looks.line, "linewidth": 0.9}
        entries.append(Line2D([], [], label=looks.entry, **marker))
    style.legend_above(figure, entries, columns=4)
    return figure
