"""Figure 9 of Tang et al. 2009: the time of each stage and the two-sided distance by frame."""

from __future__ import annotations

from typing import Any, Final

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.lines import Line2D

from analysis.shared import numerals, scales, style, tables
from analysis.shared.notes import clock_word, machine_line
from analysis.shared.report import Report
from analysis.shared.results import Results
from analysis.tang2009 import tang_motion, tang_pictures
from analysis.tang2009.tang_motion import Motion, Run

STAGES: Final[dict[str, tuple[str, style.Line]]] = {
    "cull on A": ("#56B4E9", "-"),
    "cull on B": ("#0072B2", style.DASHED),
    "subdivide": ("#000000", style.DOTTED),
}


def make(results: Results) -> Report:
    motions = tang_motion.motions(results)
    table = tables.Table(
        "The time of each stage of Tang's algorithm, two-sided, as a share of the total, for all poses and for the nearest tenth of them "
        "(Fig. 9 of Tang et al. 2009).",
        [
            "pair",
            "|A| / |B|",
            "poses",
            "H / longest side, %",
            *[f"{stage}, %" for stage in STAGES],
            "mean, ms",
            f"{style.title('cover')}, mean, ms",
        ],
        left=1,
    )
    records: list[tables.Record] = []
    for motion in motions:
        table.rules.add(len(table.rows))
        tang, cover = motion.runs["tang"], motion.runs.get("cover")
        order = np.argsort(tang.distance)
        for poses, chosen in (
            ("all poses", order),
            ("nearest tenth", order[: max(1, len(order) // 10)]),
        ):
            spent = {stage: float(tang.stage(stage)[chosen].sum()) for stage in STAGES}
            total = sum(spent.values())
            shares = [
                numerals.number(100 * seconds / total) if total > 0 else numerals.NOTHING
                for seconds in spent.values()
            ]
            means = [
                numerals.number(1e3 * float(run.per_pose[chosen].mean()))
                if run and len(run.per_pose)
                else numerals.NOTHING
                for run in (tang, cover)
            ]
            table.rows.append(
                [
                    f"{motion.scene}, {poses}",
                    motion.sizes,
                    str(len(chosen)),
                    f"{numerals.number(100 * float(tang.distance[chosen].min()))} to {numerals.number(100 * float(tang.distance[chosen].max()))}",
                    *shares,
                    *means,
                ]
            )
        for i, row in enumerate(tang.rows):
            records.append(
                {
                    "scene": motion.scene,
                    "frame": int(results.cases.pose_index[row]),
                    "status": results.cases.status[row],
                    "distance_of_longest": float(tang.distance[i]),
                    **{stage.replace(" ", "_"): float(tang.stage(stage)[i]) for stage in STAGES},
                    "seconds": float(tang.per_pose[i]) if len(tang.per_pose) else float("nan"),
                    "rounds": len(tang.by_round),
                    **(
                        {"cover_seconds": float(cover.per_pose[i])}
                        if cover and len(cover.per_pose)
                        else {}
                    ),
                }
            )
    table.verdicts = [tang_motion.rising(motions, "tang")]
    rounds = max(len(motion.runs["tang"].by_round) for motion in motions)
    table.notes = [
        "Stages come from a separate run, which reads the clock at each change; means come from timed runs without that, "
        f"{f'medians over {rounds} rounds' if rounds > 1 else 'of one round'}. Finding the lists of Lemma 3 counts as culling on B.",
        "The paper's models are not public. "
        + "; ".join(f"{motion.scene}: {motion.note}" for motion in motions)
        + ".",
        f"Here: {machine_line(results)}.",
    ]
    caption = (
        f"Top: {clock_word(results)}, in ms, of each stage of Tang's algorithm, two-sided, by frame, and of cover in total; a stage below the axis "
        "takes next to no time. Bottom: the two-sided distance (Fig. 9 of Tang et al. 2009). Stages come from a separate run, and cover's line is "
        "the median over rounds. Titles name the pair, the triangles of A / B, and the models that stand in for the paper's."
    )
    return Report(lambda: draw(motions, clock_word(results)), table, records, caption=caption)


def bottom_of(tang: Run) -> float | None:
    """Returns the lower end of the axis of times, in ms, such that both culling stages are visible.

    The subdivision stage may lie below: if nothing is subdivided, it takes only the time to read
    the clock.
    """
    positive = [x for stage in ("cull on A", "cull on B") for x in 1e3 * tang.stage(stage) if x > 0]
    return 0.5 * min(positive) if positive else None


def draw(motions: list[Motion], clock: str) -> Any:
    """Draws a column for each pair: time of the stages above (logarithmic, as the last frames take
    up to a thousand times longer), H below.
    """
    figure, axes = plt.subplots(
        2,
        len(motions),
        figsize=(style.DOUBLE_COLUMN, 3.9),
        sharex="col",
        squeeze=False,
        height_ratios=(2.2, 1),
    )
    for (upper, lower), motion in zip(axes.T, motions):
        tang = motion.runs["tang"]
        frames = [int(tang.results.cases.pose_index[row]) for row in tang.rows]
        for stage, (colour, line) in STAGES.items():
            seconds = tang.stage(stage)
            upper.plot(frames, 1e3 * seconds, color=colour, linestyle=line, linewidth=0.9)
        if (cover := motion.runs.get("cover")) and len(cover.per_pose):
            upper.plot(
                frames, 1e3 * cover.per_pose, color=style.look("cover").colour, linewidth=1.2
            )
        upper.set(
            title=tang_pictures.short_title(tang.results, motion.first),
            yscale="log",
            xlim=(frames[0], frames[-1]),
        )
        upper.set_ylim(bottom=bottom_of(tang))
        scales.log_ticks(upper.yaxis)
        lower.plot(frames, 100 * tang.distance, color="black", linewidth=0.9)
        lower.set(xlabel="frame", ylim=(0, None))
    axes[0][0].set_ylabel(f"{clock} (ms)")
    axes[1][0].set_ylabel("H(A, B), % of\nA's longest side")
    entries = [
        Line2D(
            [],
            [],
            color=colour,
            linestyle=line,
            linewidth=0.9,
            label=f"{style.title('tang')}: {stage}",
        )
        for stage, (colour, line) in STAGES.items()
    ]
    entries += [
        Line2D(
            [],
            [],
            color=style.look("cover").colour,
            linewidth=1.2,
            label=f"{style.title('cover')}, in all",
        )
    ]
    style.legend_above(figure, entries, columns=4)
    return figure
