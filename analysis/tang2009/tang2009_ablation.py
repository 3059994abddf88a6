"""An ablation study of the algorithm of Tang et al. 2009: Voronoi subdivision, group traversal,
Lemma 4, warm start, tolerance."""

from __future__ import annotations

import math
from typing import Any, Final

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.lines import Line2D

from analysis.shared import claims, numerals, scales, style, tables
from analysis.shared.cells import MEASURES, in_time_and_work
from analysis.shared.comparable import apart
from analysis.shared.notes import clock_title, clock_word, machine_line
from analysis.shared.over_pairs import on_average
from analysis.shared.report import Report
from analysis.shared.results import Results
from analysis.shared.estimates import NO_DATA, Estimate, exact, paired_ratio
from analysis.shared.verdicts import Verdict, everywhere
from analysis.tang2009 import tang_pictures
from analysis.tang2009.tang_motion import Run

FINEST: Final = 1e-4
PLAIN: Final = "tang"
CUTS: Final[dict[str, tuple[str, ...]]] = {"subdivisions": ("subdivisions",)}
MARKERS: Final = "osD^v"  # one per scene
COUNTED: Final = {**CUTS, **MEASURES}
CLAIMS: Final = (
    ("tang, midpoint", "voronoi"),
    ("tang, corners alone", "group_traversal"),
)  # (label to compare with the plain algorithm, claim)
IN_SUBDIVISIONS: Final = (
    ("tang, midpoint", PLAIN, "cuts"),
    (PLAIN, "tang, Lemma 4", "lemma4"),
)  # more subdivisions, fewer, claim


class Variants:
    """The runs of all variants of the algorithm, by scene, label and tolerance."""

    def __init__(self, results: Results) -> None:
        cases = results.cases
        self.results, self.scenes, self.labels = results, results.scenes, results.in_order("label")
        self.tolerances = sorted({float(x) for x in cases.tolerance}, reverse=True)
        self.runs = {
            (scene, label, tolerance): Run(results, rows)
            for scene in self.scenes
            for label in self.labels
            for tolerance in self.tolerances
            if (rows := results.rows(scene=scene, label=label, tolerance=tolerance))
        }

    def run(self, scene: str, label: str, tolerance: float = FINEST) -> Run | None:
        run = self.runs.get((scene, label, tolerance))
        return run if run and run.complete else None

    def ratio(self, scene: str, slow: str, fast: str, measure: str = "") -> Estimate:
        """Returns slow / fast over all poses together: times have an interval over rounds, counts
        are exact."""
        above, below = self.run(scene, slow), self.run(scene, fast)
        if not above or not below:
            return NO_DATA
        if measure:
            total = [float(run.counted(COUNTED[measure]).sum()) for run in (above, below)]
            return exact(total[0] / total[1]) if min(total) > 0 else NO_DATA
        if lacking := apart(above.origins | below.origins):
            return lacking
        shared = sorted(above.by_round.keys() & below.by_round.keys())
        slow_sums = [above.by_round[i].sum() for i in shared]
        fast_sums = [below.by_round[i].sum() for i in shared]
        return paired_ratio(slow_sums, fast_sums)


def verdicts(variants: Variants) -> list[Verdict]:
    def judge(label: str, name: str) -> Verdict:
        claim = claims.of("tang2009", name)
        return in_time_and_work(
            lambda measure: on_average(
                claim, [variants.ratio(scene, label, PLAIN, measure) for scene in variants.scenes]
            ),
            COUNTED,
        )

    counted = []
    for more, fewer, name in IN_SUBDIVISIONS:
        ratios = [variants.ratio(scene, more, fewer, "subdivisions") for scene in variants.scenes]
        counted.append(on_average(claims.of("tang2009", name), ratios))
    return [*[judge(label, name) for label, name in CLAIMS], *counted, sensitive(variants)]


def was_run(variants: Variants, label: str, tolerance: float) -> bool:
    """Returns whether a variant has rows at a tolerance in any scene."""
    return any((scene, label, tolerance) in variants.runs for scene in variants.scenes)


def sensitive(variants: Variants) -> Verdict:
    """Judges the claim that the depth of subdivision depends on the tolerance, by the finest and
    the coarsest one."""

    def levels(scene: str, tolerance: float) -> float:
        run = variants.run(scene, PLAIN, tolerance)
        return (
            1 + float(np.nanmax(run.deepest))
            if run and np.isfinite(run.deepest).any()
            else math.nan
        )

    swept = [t for t in variants.tolerances if was_run(variants, PLAIN, t)]
    ratios = (
        [levels(scene, swept[-1]) / levels(scene, swept[0]) for scene in variants.scenes]
        if len(swept) > 1
        else []
    )
    return everywhere(
        claims.of("tang2009", "sensitive"),
        [exact(ratio) if math.isfinite(ratio) else NO_DATA for ratio in ratios],
    )


def make(results: Results) -> Report:
    variants = Variants(results)
    rows = [
        (label, tolerance)
        for label in variants.labels
        for tolerance in variants.tolerances
        if was_run(variants, label, tolerance)
    ]
    table = tables.Table(
        f"{clock_title(results)} and counted work over all poses of a motion, two-sided: the algorithm of Tang et al. 2009 with one part "
        "changed.",
        [
            "pair",
            "",
            "tolerance",
            "time, ms",
            "subdivisions",
            "distances",
            "deepest",
            "time / plain",
            *[f"{measure} / plain" for measure in COUNTED],
        ],
        left=2,
    )
    records: list[tables.Record] = []
    for scene in variants.scenes:
        table.rules.add(len(table.rows))
        for i, (label, tolerance) in enumerate(rows):
            run, solver = variants.run(scene, label, tolerance), str(
                results.cases.solver[results.rows(label=label)[0]]
            )
            compared = tolerance == FINEST and label != PLAIN
            cells = [numerals.NOTHING] * 4
            if run:
                cells = [
                    numerals.number(1e3 * float(run.per_pose.sum())),
                    *[
                        f"{run.counted(COUNTED[measure]).sum():,.0f}"
                        for measure in ("subdivisions", "distances")
                    ],
                    f"{np.nanmax(run.deepest):g}"
                    if np.isfinite(run.deepest).any()
                    else numerals.NOTHING,
                ]
                records.append(
                    {
                        "scene": scene,
                        "label": label,
                        "tolerance": tolerance,
                        "poses": len(run.rows),
                        "seconds": float(run.per_pose.sum()),
                        "rounds": len(run.by_round),
                        **{
                            name: int(counts[run.rows].sum())
                            for name, counts in results.cases.counters.items()
                        },
                    }
                )
            table.rows.append(
                [
                    style.scene_title(scene) if i == 0 else "",
                    style.title(solver, label),
                    f"{tolerance:g}",
                    *cells,
                    *[
                        numerals.ratio(variants.ratio(scene, label, PLAIN, measure))
                        if compared
                        else numerals.NOTHING
                        for measure in ("", *COUNTED)
                    ],
                ]
            )
    table.verdicts = verdicts(variants)
    table.notes = [
        "Plain: as in the paper, tolerance 1e-4 of A's longest side; Lemma 4, which the paper offers for closed models, is off. Time is the "
        "median over rounds, summed over the poses; ratios are paired by round. Distances are from points to triangles. Deepest: nested "
        "subdivisions.",
        "Warm: each pose starts from what the previous pose left. Corners alone: each of the three corners of a triangle of A is a closest point "
        "query of its own.",
        f"Here: {machine_line(results)}.",
    ]
    caption = (
        f"(a) {clock_title(results)} of all poses of a motion with one part of the algorithm of Tang et al. 2009 changed, relative to the plain "
        "algorithm, with the interval of the ratio as a line; cover is another algorithm. (b) The same time of the plain algorithm, in ms, against "
        "the tolerance. The legend names the models that stand in for the paper's."
    )
    return Report(
        lambda: draw(variants, rows, clock_word(results)), table, records, caption=caption
    )


def named(results: Results, scene: str) -> str:
    """Returns the title of a scene, with our replacements for its models: 'Puma1/Puma2 (stand-ins:
    dinosaur, horse)'."""
    shapes = [
        shape.removeprefix("stand-in: ")
        for shape in tang_pictures.stand_ins(results, results.rows(scene=scene)[0])
        if shape
    ]
    return style.scene_title(scene) + (f" (stand-ins: {', '.join(shapes)})" if shapes else "")


def draw(variants: Variants, rows: list[tuple[str, float]], clock: str) -> Any:
    """Draws each variant's time relative to the plain algorithm (left), and the time of the latter
    over the tolerance (right)."""
    changed = [label for label, tolerance in rows if tolerance == FINEST and label != PLAIN]
    figure, (left, right) = plt.subplots(
        1, 2, figsize=(style.DOUBLE_COLUMN, 2.9), width_ratios=(1.3, 1)
    )
    colours = plt.get_cmap("viridis")(np.linspace(0.05, 0.75, len(variants.scenes)))
    markers = [MARKERS[k % len(MARKERS)] for k in range(len(variants.scenes))]
    step = 0.7 / len(variants.scenes)
    for k, (scene, colour, marker) in enumerate(zip(variants.scenes, colours, markers)):
        for i, label in enumerate(changed):
            y = i + (k - (len(variants.scenes) - 1) / 2) * step
            ratio = variants.ratio(scene, label, PLAIN)
            if not ratio.n:
                continue
            style.interval(left, ratio, y, color=colour, linewidth=1.4)
            left.plot(
                ratio.value,
                y,
                marker=marker,
                markersize=4.5,
                color=colour,
                markeredgecolor="white",
                markeredgewidth=0.4,
            )
        swept = [
            (tolerance, run)
            for tolerance in variants.tolerances
            if (run := variants.run(scene, PLAIN, tolerance))
        ]
        tolerances = [tolerance for tolerance, _ in swept]
        milliseconds = [1e3 * float(run.per_pose.sum()) for _, run in swept]
        right.plot(
            tolerances,
            milliseconds,
            marker=marker,
            markersize=4.5,
            markeredgecolor="white",
            markeredgewidth=0.4,
            linewidth=0.9,
            color=colour,
        )
    left.axvline(1, color="black", linewidth=0.7)
    left.set_yticks(
        range(len(changed)),
        [style.title("cover" if label == "cover" else "tang", label) for label in changed],
    )
    left.invert_yaxis()
    left.set(xscale="log", xlabel=f"{clock}, against the plain algorithm")
    right.set(
        xscale="log",
        yscale="log",
        xlabel="tolerance, of A's longest side",
        ylabel=f"{clock} of all poses (ms)",
    )
    right.invert_xaxis()
    for axis in (left.xaxis, right.xaxis, right.yaxis):
        scales.log_ticks(axis)
    entries = [
        Line2D(
            [],
            [],
            color=colour,
            marker=marker,
            markersize=4.5,
            linewidth=0.9,
            markeredgecolor="white",
            markeredgewidth=0.4,
            label=named(variants.results, scene),
        )
        for scene, colour, marker in zip(variants.scenes, colours, markers)
    ]
    style.legend_above(figure, entries, columns=3)
    return figure
