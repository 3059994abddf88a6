"""Figure 11 of Tang et al. 2009 and its two dynamic scenes: the penetration depth, and its cost per
frame."""

from __future__ import annotations

from typing import Any, Final

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.lines import Line2D

from analysis.shared import claims, numerals, scales, style, tables
from analysis.shared.load import paper_numbers
from analysis.shared.mesh_picture import view
from analysis.shared.notes import machine_line
from analysis.shared.report import Report
from analysis.shared.results import Results
from analysis.shared.verdicts import Verdict, all_of
from analysis.tang2009 import tang_depth, tang_pictures
from analysis.tang2009.tang_depth import CUT, MEASURE, Scene, faster, mean_over_frames

LABELS: Final = ["tang", "cover"]
FIGURE: Final = "Fig. 11"
FEW: Final = 10.0  # milliseconds that count as a few
VIEW: Final = view((0.35, 0.25, 1))


def verdicts(scenes: list[Scene], papers: dict[str, float]) -> list[Verdict]:
    def judge(name: str, scene: Scene, *stages: str) -> Verdict:
        printed = papers[scene.name]
        paper = "tang2009" if scene.label == "tang" else claims.OWN
        return faster(
            claims.of(
                paper,
                name,
                scene=scene.name,
                printed=printed,
                title=style.title(scene.label),
                label=scene.label,
            ),
            scene,
            stages,
            printed,
        )

    told = [scene for scene in scenes if scene.name in papers]
    result = [judge("depth_of_frame", scene, MEASURE) for scene in told]
    result += [judge("depth_of_frame_with_cutting", scene, CUT, MEASURE) for scene in told]
    result += [
        faster(claims.of("tang2009", "few_milliseconds", scene.name), scene, (MEASURE,), FEW)
        for scene in told
        if scene.label == "tang"
    ]
    rows = [row for scene in scenes for row in scene.rows]
    answered = sum(len(scene.answered) for scene in scenes)
    return [
        *result,
        all_of(
            claims.of("hausbench", "every_depth"),
            len(rows) - answered,
            len(rows),
            len(rows),
            "rows",
        ),
        agreement(scenes),
    ]


def agreement(scenes: list[Scene]) -> Verdict:
    """Judges the claim that the intervals of all solvers for a pair overlap.

    They may miss each other by 1e-9 of the longest side, which exceeds the rounding errors of
    cutting the meshes.
    """
    bounds: dict[tuple[str, int, bytes], list[tuple[float, float]]] = {}
    for scene in scenes:
        cases = scene.results.cases
        for row in scene.answered:
            where = np.concatenate([cases.pose[row], cases.target_pose[row]]).tobytes()
            bounds.setdefault((scene.name, int(cases.frame[row]), where), []).append(
                (
                    float(cases.lower[row] / cases.source_longest[row]) - 5e-10,
                    float(cases.upper[row] / cases.source_longest[row]) + 5e-10,
                )
            )
    several = [intervals for intervals in bounds.values() if len(intervals) > 1]
    apart = 0
    for intervals in several:
        lower, upper = zip(*intervals)
        apart += max(lower) > min(upper)
    return all_of(claims.of("hausbench", "depths_agree"), apart, len(several), len(bounds), "pairs")


def make(results: Results) -> Report:
    printed = paper_numbers(results.stem)
    papers = {str(row["scene"]): float(row["average"]) for row in printed["row"]}
    scenes = tang_depth.recorded(results, LABELS)
    table = tables.Table(
        "The penetration depth in dynamic scenes, and its cost per frame: the mean over the frames in which objects overlap (Tang et al. "
        "2009, section 7.3).",
        [
            "scene",
            "",
            "frames",
            "pairs " "per frame",
            "parts",
            "depth, %",
            "largest",
            "triangles",
            "cutting, ms",
            "measuring, ms",
            "both, ms",
        ],
        left=2,
    )
    records: list[tables.Record] = []
    for name in dict.fromkeys(scene.name for scene in scenes):
        table.rules.add(len(table.rows))
        for i, scene in enumerate(scene for scene in scenes if scene.name == name):
            table.rows.append([name if i == 0 else "", style.title(scene.label), *cells(scene)])
            records += [record(scene, row) for row in scene.rows]
        if name in papers:
            table.rows.append(["", "paper", *[numerals.NOTHING] * 8, f"{papers[name]:g}"])
    names = list(dict.fromkeys(scene.name for scene in scenes))
    table.verdicts = verdicts(scenes, papers)
    table.notes = [
        "Depths are in percent of the first object's longest side (median and largest over the pairs); parts of the common volume, and triangles on both sides of "
        "them, are means over the pairs. Tolerance 1e-4 of the longest side.",
        "The paper's scenes are not public: ours were simulated with Bullet. Contacts are rigid, as in the paper's engine; in the soft scenes "
        "they are springs, so objects overlap far more deeply. Cutting is CGAL's corefinement of both whole meshes; the paper finds the "
        "triangles inside by flood fill, and does not say whether its times include that.",
        "Times are from one run of each pair, in the order of the frames; the interval is Student's, over eight groups of consecutive frames. It "
        "also covers how the scene changes.",
        f"Paper: {printed['machine']}.",
        f"Here: {machine_line(results)}.",
    ]
    rows = results.rows(scene=FIGURE, label="each part")
    return Report(
        lambda: draw(results, rows[0] if rows else None, scenes, papers),
        table,
        records,
        clock="Times are wall time, by the solver's own clock.",
        caption=caption(names, papers),
    )


def caption(names: list[str], papers: dict[str, float]) -> str:
    """Returns the caption of the figure. `papers` are the means that the paper prints."""
    mean = f" Dotted: the mean that the paper prints ({', '.join(name for name in names if name in papers)}); the paper does not say whether that includes cutting."
    return (
        "(a) The volume that two solids A and B have in common, in separate parts. (b) Each part, enlarged and moved next to the others, with the "
        "points of its penetration depth joined by a green line. The other panels: wall time, in ms, to measure the depths of all pairs of a frame, "
        "without cutting, in each dynamic scene, simulated with Bullet because the paper's scenes are not public (Tang et al. 2009, section "
        f"7.3).{mean if papers else ''}"
    )


def cells(scene: Scene) -> list[str]:
    if len(scene.answered) < len(scene.rows):
        return [
            str(len(scene.frames)),
            f"{len(scene.rows) - len(scene.answered)} of {len(scene.rows)} pairs failed",
            *[numerals.NOTHING] * 7,
        ]
    return [
        str(len(scene.frames)),
        numerals.number(len(scene.rows) / len(scene.frames)),
        numerals.number(float(scene.told("parts").mean())),
        numerals.number(100 * float(np.median(scene.depths))),
        numerals.number(100 * float(scene.depths.max())),
        numerals.number(float(scene.told("triangles measured").mean())),
        *[
            numerals.estimate(mean_over_frames(scene.per_frame(*stages)), 1e3)
            for stages in ((CUT,), (MEASURE,), (CUT, MEASURE))
        ],
    ]


def record(scene: Scene, row: int) -> tables.Record:
    cases, extras = scene.results.cases, scene.results.extras(row)
    return {
        "scene": scene.name,
        "label": scene.label,
        "frame": int(cases.frame[row]),
        "source": cases.source[row],
        "target": cases.target[row],
        "status": cases.status[row],
        "lower": float(cases.lower[row]),
        "upper": float(cases.upper[row]),
        "longest": float(cases.source_longest[row]),
        "cut_seconds": extras.get(CUT, float("nan")),
        "measure_seconds": extras.get(MEASURE, float("nan")),
        "parts": extras.get("parts", float("nan")),
    }


def draw(results: Results, shown: int | None, scenes: list[Scene], papers: dict[str, float]) -> Any:
    """Draws Fig. 11 above (the common volume of two solids, and the deepest pair of points of each
    part), and the time by frame below.
    """
    names = list(dict.fromkeys(scene.name for scene in scenes))
    figure = plt.figure(figsize=(style.DOUBLE_COLUMN, 5.4))
    upper, between, lower = figure.subfigures(3, 1, height_ratios=(1.5, 0.09, 1))
    for ax, close in zip(upper.subplots(1, 2, width_ratios=(1.35, 1)), (False, True)):
        if shown is None:
            ax.set_visible(False)
            continue
        tang_pictures.draw_common_volume(ax, results, shown, VIEW, close)
        ax.set_title(
            "(b) each part enlarged, and its deepest pair"
            if close
            else "(a) A inside B (dark blue) and B inside A (light red)",
            y=-0.08,
        )
    for ax, name in zip(np.atleast_1d(lower.subplots(1, max(1, len(names)))), names):
        for scene in (scene for scene in scenes if scene.name == name):
            looks = style.look(scene.label)
            ax.plot(
                scene.frames,
                1e3 * scene.per_frame(MEASURE),
                color=looks.colour,
                linestyle=looks.line,
                linewidth=0.9,
            )
        if name in papers:
            ax.axhline(papers[name], color=style.GREY, linewidth=0.8, linestyle=style.DOTTED)
        ax.set(title=name, xlabel="frame", yscale="log")
        scales.log_ticks(ax.yaxis)
    if names:
        lower.axes[0].set_ylabel("measuring (ms per frame)")
    entries = [
        Line2D(
            [],
            [],
            color=style.look(label).colour,
            linestyle=style.look(label).line,
            linewidth=0.9,
            label=style.title(label),
        )
        for label in LABELS
    ]
    paper = Line2D(
        [],
        [],
        color=style.GREY,
        linewidth=0.8,
        linestyle=style.DOTTED,
        label="the paper's mean time of a frame",
    )
    between.legend(handles=[*entries, paper], loc="center", ncol=3)
    return figure
