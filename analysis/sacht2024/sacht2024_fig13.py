"""Fig. 13 of Sacht and Jacobson 2024: time to reach each tolerance, averaged over four near-zero
pairs of meshes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import matplotlib.pyplot as plt
import numpy as np

from analysis.shared import claims, numerals, scales, style, tables
from analysis.shared.cells import MEASURES
from analysis.shared.comparable import Origin, apart, origin, origins
from analysis.shared.load import paper_numbers
from analysis.shared.notes import clock_note, clock_title, machine_line
from analysis.shared.report import Report
from analysis.shared.results import Results
from analysis.shared.estimates import NO_DATA, Estimate, exact, median, ratio_by_round
from analysis.shared.verdicts import Verdict, everywhere

TOLERANCES = tuple(10.0**-k for k in range(1, 9))  # fractions of the diagonal of A
RIVALS = ("kang", "zheng")


@dataclass(frozen=True)
class Reach:
    """The time at which a solver, on one pair, first reached the tolerance. NaN: never, within the
    limits."""

    seconds: float
    read_from: str  # "trace", "case", or the reason why it was not reached
    by_round: dict[int, float] = field(default_factory=dict)  # a trace gives a single round
    work: dict[str, int] = field(default_factory=dict)  # by key of MEASURES; empty for a trace
    origins: frozenset[Origin] = frozenset()


def reach(results: Results, scene: str, label: str, tolerance: float) -> Reach:
    """Reads the time from the trace of the finest run, or, for solvers without a trace, from the
    run at this tolerance."""
    cases = results.cases
    rows = [
        int(r)
        for r in results.rows(scene=scene, label=label)
        if cases.status[r] != "unsound" and cases.tolerance_of[r] == "diagonal"
    ]
    traced = [r for r in rows if cases.trace_end[r] > cases.trace_begin[r]]
    if traced:
        finest = min(traced, key=lambda r: float(cases.tolerance[r]))
        trace = results.trace_of(finest)
        hits = np.flatnonzero(
            trace.upper - trace.lower <= tolerance * cases.source_diagonal[finest]
        )
        if len(hits):
            seconds = results.prepare_seconds(finest) + float(trace.seconds[hits[0]])
            return Reach(
                seconds, "trace", {0: seconds}, origins=frozenset([origin(results, finest, "wall")])
            )
        return Reach(np.nan, cases.status[finest] if cases.status[finest] != "ok" else "not asked")
    runs = [r for r in rows if np.isclose(cases.tolerance[r], tolerance, rtol=1e-9, atol=0)]
    if not runs:
        return Reach(
            np.nan,
            "not asked" if rows or not len(results.rows(scene=scene, label=label)) else "unsound",
        )
    if cases.status[runs[0]] != "ok":
        return Reach(np.nan, str(cases.status[runs[0]]))
    times = results.total_by_round(runs[0])
    work = {}
    for measure, names in MEASURES.items():
        work[measure] = sum(
            int(cases.counters[name][runs[0]]) for name in names if name in cases.counters
        )
    return Reach(
        float(np.median(list(times.values()))), "case", times, work, origins(results, runs[:1])
    )


Reaches = dict[tuple[str, str, float], Reach]  # by label, scene, tolerance


def mean_of_rounds(reaches: Reaches, label: str, scenes: list[str], t: float) -> dict[int, float]:
    """Returns the mean time over all pairs, by round; empty if the tolerance was not reached on
    some pair."""
    each = [reaches[label, scene, t].by_round for scene in scenes if (label, scene, t) in reaches]
    if len(each) < len(scenes) or not all(each):
        return {}
    means = {}
    for number in each[0]:
        times = [by_round[number] for by_round in each if number in by_round]
        if len(times) == len(each):
            means[number] = float(np.mean(times))
    return means


def work_of(reaches: Reaches, label: str, scenes: list[str], t: float, measure: str) -> float:
    """Returns the counted work summed over all pairs; NaN if a pair is missing or has no count."""
    counts = [
        reaches[label, scene, t].work.get(measure, 0)
        for scene in scenes
        if (label, scene, t) in reaches
    ]
    return float(sum(counts)) if len(counts) == len(scenes) and all(counts) else np.nan


def verdicts(reaches: Reaches, scenes: list[str]) -> list[Verdict]:
    """Judges claims about ratios of mean times, at every tolerance."""

    def over(claim: str, ratio: Callable[[float], Estimate]) -> Verdict:
        return everywhere(claim, [ratio(t) for t in stages], "tolerances")

    stages = []
    for t in TOLERANCES:
        if any(
            reach.read_from != "not asked"
            for (label, _, tolerance), reach in reaches.items()
            if label in ("sacht", *RIVALS) and tolerance == t
        ):
            stages.append(t)
    lines = []
    for rival in RIVALS:

        def timed(t: float, rival: str = rival) -> Estimate:
            slow, fast = (mean_of_rounds(reaches, label, scenes, t) for label in (rival, "sacht"))
            if not slow or not fast:
                return NO_DATA
            return apart(
                provenance
                for label in (rival, "sacht")
                for scene in scenes
                for provenance in reaches[label, scene, t].origins
            ) or ratio_by_round(slow, fast)

        def counted(measure: str, rival: str = rival) -> Callable[[float], Estimate]:
            return lambda t: exact(
                work_of(reaches, rival, scenes, t, measure)
                / work_of(reaches, "sacht", scenes, t, measure)
            )

        claim = claims.of("sacht2024", "every_stage", rival=style.title(rival))
        lines.append(
            over(claim, timed).with_counts(
                {measure: over(claim, counted(measure)) for measure in MEASURES}
            )
        )
    return lines


def make(results: Results) -> Report:
    cases, printed = results.cases, paper_numbers("sacht2024_table2")
    scenes = results.scenes
    labels = style.order(zip(cases.solver, cases.label))
    reaches = {
        (label, scene, t): reach(results, scene, label, t)
        for _, label in labels
        for scene in scenes
        for t in TOLERANCES
    }

    average = {
        (label, t): median(list(mean_of_rounds(reaches, label, scenes, t).values()))
        for _, label in labels
        for t in TOLERANCES
    }
    reached = {}
    requested = set()
    for _, label in labels:
        for t in TOLERANCES:
            reached[label, t] = sum(
                np.isfinite(reaches[label, scene, t].seconds) for scene in scenes
            )
            if any(reaches[label, scene, t].read_from != "not asked" for scene in scenes):
                requested.add((label, t))
    paper = {}
    for name in ("kang", "zheng", "sacht"):
        paper[name] = float(np.mean([row[name] for row in printed["row"]])) / 1e3

    traced = any(reach.read_from == "trace" for reach in reaches.values())
    table = tables.Table(
        f"{'Wall time' if traced else clock_title(results)} in ms (preparation included) until the gap is within a tolerance, relative to "
        f"the diagonal of A; mean over {len(scenes)} pairs of meshes, as in Fig. 13 of Sacht and Jacobson 2024.",
        ["solver", *[f"1e-{k}" for k in range(1, 9)], "paper, 1e-8"],
    )
    for solver, label in labels:
        row = [
            numerals.NOTHING
            if (label, t) not in requested
            else numerals.estimate(average[label, t], 1e3)
            if average[label, t].n
            else f"{reached[label, t]} of {len(scenes)}"
            for t in TOLERANCES
        ]
        table.rows.append(
            [style.title(solver, label), *row, numerals.number(paper.get(label, np.nan) * 1e3)]
        )
    table.verdicts = verdicts(reaches, scenes)
    scene_notes = [
        f"{style.scene_title(scene)}: {note}"
        for scene in scenes
        if (note := cases.scene_note[results.rows(scene=scene)[0]])
    ]
    table.notes = [
        "'k of n': reached within the limit on k of n pairs only, so no mean is given. "
        + unreached(labels, scenes, reaches),
        (
            "Read from one traced run per pair: the first sample whose gap is within the tolerance, plus the preparation time of that run. Solvers without a "
            "trace: the median of the rounds that asked for the tolerance. " + tracing_cost(results)
        )
        if traced
        else (
            "Each tolerance is requested separately. "
            + tables.coverage_note(average.values())
            + " The mean over the pairs is taken for each round."
        ),
        "The paper's times include the construction of the BVH. A dash: not requested.",
        *scene_notes,
        "Paper: means of its Table 2 at 1e-8; Fig. 13 itself prints no numbers. Its pairs: "
        + ", ".join(row["scene"] for row in printed["row"])
        + f"; {printed['machine']}.",
        f"Here: {machine_line(results)}.",
    ]
    records: list[tables.Record] = [
        {
            "solver": solver,
            "label": label,
            "scene": scene,
            "tolerance": t,
            "seconds": reaches[label, scene, t].seconds,
            "read_from": reaches[label, scene, t].read_from,
            "pairs_reached": reached[label, t],
            "mean_seconds": average[label, t].value,
            "mean_low": average[label, t].low,
            "mean_high": average[label, t].high,
            **reaches[label, scene, t].work,
            "paper_mean_seconds": paper.get(label, np.nan) if t == TOLERANCES[-1] else np.nan,
        }
        for solver, label in labels
        for scene in scenes
        for t in TOLERANCES
    ]
    return Report(
        lambda: draw(labels, len(scenes), average, reached, requested, paper),
        table,
        records,
        clock="Times read off a trace are wall time; for the other solvers: " + clock_note(results)
        if traced
        else "",
    )


def unreached(labels: list[tuple[str, str]], scenes: list[str], reaches: Reaches) -> str:
    """Says on which pairs tolerances were not reached, and why: 'CGAL: crown timeout (1e-7,
    1e-8).'"""
    parts = []
    for solver, label in labels:
        why: dict[str, list[str]] = {}
        for scene in scenes:
            for k, t in enumerate(TOLERANCES, start=1):
                reached = reaches[label, scene, t]
                if np.isnan(reached.seconds) and reached.read_from != "not asked":
                    word = style.status_word(reached.read_from)
                    why.setdefault(f"{scene} {word}", []).append(f"1e-{k}")
        if why:
            each = "; ".join(f"{failure} ({', '.join(where)})" for failure, where in why.items())
            parts.append(f"{style.title(solver, label)}: {each}.")
    return " ".join(parts)


def tracing_cost(results: Results) -> str:
    """Returns a note on the cost of tracing: time of the trace's last sample / median time of
    untraced runs."""
    cases, ratios = results.cases, []
    for case in np.flatnonzero((cases.trace_end > cases.trace_begin) & (cases.status == "ok")):
        time = median(results.wall_seconds(int(case)))
        if len(results.repeats_of(int(case))) and time.value > 0:
            ratios.append(float(results.trace_of(int(case)).seconds[-1]) / time.value)
    if not ratios:
        return "This file does not say what tracing costs."
    return (
        f"Traced runs took {numerals.number(float(np.median(ratios)))} times as long as timed ones "
        f"(median of {len(ratios)}; {numerals.number(min(ratios))} to {numerals.number(max(ratios))})."
    )


def draw(
    labels: list[tuple[str, str]],
    pairs: int,
    average: dict[tuple[str, float], Estimate],
    reached: dict[tuple[str, float], int],
    requested: set[tuple[str, float]],
    paper: dict[str, float],
) -> Any:
    """Draws the mean time at tolerances reached on all pairs. A strip on top shows the number of
    pairs at the others."""
    missing = []
    for solver, label in labels:
        if any(reached[label, t] < pairs for t in TOLERANCES if (label, t) in requested):
            missing.append((solver, label))
    strip = 0.14 * len(missing)
    figure, (top, ax) = plt.subplots(
        2,
        1,
        sharex=True,
        figsize=(style.SINGLE_COLUMN, 2.75 + strip + 0.05),
        gridspec_kw={"height_ratios": [max(strip, 0.01), 2.3], "hspace": 0.0},
    )
    for solver, label in labels:
        looks = style.look(solver, label)
        drawn = [t for t in TOLERANCES if average[label, t].n]
        for t in drawn:
            style.interval(
                ax, average[label, t], t, 1e3, upright=True, color=looks.colour, linewidth=1.2
            )
        ax.plot(
            drawn,
            [average[label, t].value * 1e3 for t in drawn],
            zorder=3,
            **(style.filled_marker(looks) | {"linestyle": looks.line}),
        )
        if label in paper:
            ax.plot([TOLERANCES[-1] / 10], [paper[label] * 1e3], **style.open_marker(looks))
    for row, (solver, label) in enumerate(missing):
        looks = style.look(solver, label)
        for t in (t for t in TOLERANCES if reached[label, t] < pairs and (label, t) in requested):
            top.plot([t * 1.25], [row], **style.open_marker(looks))
            top.text(
                t / 1.35,
                row,
                f"{reached[label, t]}/{pairs}",
                fontsize=6,
                color="#333333",
                va="center",
            )
    top.set_ylim(max(len(missing), 1) - 0.5, -0.5)
    top.set_yticks(
        [(len(missing) - 1) / 2] if missing else [], ["pairs\nreached"] if missing else []
    )
    top.tick_params(axis="both", which="both", length=0, labelbottom=False)
    top.grid(False)
    top.spines["left"].set_visible(False)
    top.spines["bottom"].set_visible(False)
    top.set_facecolor("#F5F5F5" if missing else "none")
    top.minorticks_off()
    ax.set_xscale("log")
    ax.set_yscale("log")
    ax.minorticks_off()
    if not any(len(line.get_xdata()) for line in ax.lines):  # nothing to draw: any limits will do
        ax.set_ylim(1, 1e4)
    ax.set_xlim(TOLERANCES[0] * 2, TOLERANCES[-1] / 30)
    scales.log_ticks(ax.yaxis)
    powers = [f"$10^{{-{k}}}$" for k in range(1, 9)]
    if any(label in paper for _, label in labels):
        ax.set_xticks([*TOLERANCES, TOLERANCES[-1] / 10], [*powers, "paper,\n1e-8"])
        ax.axvline(TOLERANCES[-1] / 3.2, color=style.GREY, linewidth=0.5, linestyle=(0, (2, 2)))
    else:
        ax.set_xticks(TOLERANCES, powers)
        ax.set_xlim(TOLERANCES[0] * 2, TOLERANCES[-1] / 3.5)
    ax.set_xlabel("tolerance of the gap / diagonal of A")
    ax.set_ylabel(f"prepare + solve, mean of {pairs} pairs (ms)")
    figure.set_layout_engine("constrained", h_pad=0.02, hspace=0.0)
    style.legend_above(figure, style.handles(labels))
    return figure
