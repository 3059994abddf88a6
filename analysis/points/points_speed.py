"""Compares our solver for point sets with the best of the others on each workload: time with
preparation, and memory."""

from __future__ import annotations

import math
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import scipy.stats
from matplotlib.lines import Line2D

from analysis.shared import claims, numerals, style, tables
from analysis.shared.comparable import apart, origin
from analysis.shared.notes import machine_line
from analysis.shared.report import Report
from analysis.shared.results import Results
from analysis.shared.estimates import NO_DATA, Estimate, median, ratio_by_round, ratio_of_medians
from analysis.shared.verdicts import Verdict, most_of

OURS = "scan"


class Cell:
    """The times of one solver on one workload."""

    def __init__(self, results: Results, row: int) -> None:
        cases = results.cases
        self.row, self.status = row, cases.status[row]
        # An external program that measured its time itself.
        self.reported = not math.isnan(cases.reported_seconds[row])
        self.rounds = (
            results.reported_by_round(row) if self.reported else results.total_by_round(row)
        )
        self.wall, self.origin = results.total_by_round(row, "wall"), origin(results, row)
        self.time = median(list(self.rounds.values())) if self.status == "ok" else NO_DATA
        peak = int(cases.peak_bytes[row])
        self.mebibytes = peak / 2**20 if peak >= 0 and self.status == "ok" else math.nan

    def text(self) -> str:
        if self.status != "ok":
            return style.status_word(self.status)
        return numerals.estimate(self.time, 1000)


Labels = list[tuple[str, str]]  # solver and label of each column, in the order of the table
Cells = dict[tuple[str, str], Cell]  # by scene and label


def ratio(rival: Cell, ours: Cell) -> Estimate:
    """Returns time of `rival` / time of `ours`, paired by round if both have rounds.

    A program that measures its time itself reports wall time, so it is compared with our wall time.
    """
    if lacking := apart(
        [
            cell.origin._replace(clock="wall") if rival.reported else cell.origin
            for cell in (rival, ours)
        ]
    ):
        return lacking
    our_rounds = ours.wall if rival.reported else ours.rounds
    paired = ratio_by_round(rival.rounds, our_rounds)
    return (
        paired
        if paired.n
        else ratio_of_medians(list(rival.rounds.values()), list(our_rounds.values()))
    )


def at_least(rival: Cell, ours: Cell, limit: float) -> Estimate:
    """Returns time of `rival` / time of `ours`. If one of them timed out, the limit stands for its
    time, which can only show that it is slower."""
    late = [cell.status == "timeout" for cell in (rival, ours)]
    if not any(late):
        return ratio(rival, ours)
    if lacking := apart([rival.origin, ours.origin]):
        return lacking
    answered = ours if late[0] else rival
    if all(late) or not answered.time.n:
        return NO_DATA
    limits = dict.fromkeys(answered.rounds, limit)
    estimate = (
        ratio_by_round(limits, ours.rounds) if late[0] else ratio_by_round(rival.rounds, limits)
    )
    return estimate if (estimate.low > 1 if late[0] else estimate.high < 1) else NO_DATA


def judge(results: Results, cells: Cells) -> Verdict:
    """Judges the claim that LSS takes less time than EARLYBREAK."""
    pairs = [
        (cells[scene, "earlybreak"], cells[scene, "lss"])
        for scene in results.scenes
        if {(scene, "earlybreak"), (scene, "lss")} <= cells.keys()
    ]
    return most_of(
        claims.of("hausbench", "lss_outperforms"),
        [
            at_least(earlybreak, lss, float(results.cases.case_seconds_limit[earlybreak.row]))
            for earlybreak, lss in pairs
        ],
        "workloads",
    )


def best_over_ours(scene: str, labels: Labels, cells: Cells) -> Estimate:
    """Returns time of the fastest other solver / time of ours on a workload."""
    ours = cells.get((scene, OURS))
    rivals = []
    for _, label in labels:
        cell = cells.get((scene, label))
        if label != OURS and cell and cell.time.n:
            rivals.append(cell)
    if not rivals or not ours or not ours.time.n:
        return NO_DATA
    return ratio(min(rivals, key=lambda cell: cell.time.value), ours)


def add_rows(table: tables.Table, scene: str, labels: Labels, cells: Cells) -> None:
    """Adds the rows of a workload to the table: times, and memory below."""
    times, memory = [], []
    for _, label in labels:
        cell = cells.get((scene, label))
        times.append(cell.text() if cell else numerals.NOTHING)
        memory.append(numerals.number(cell.mebibytes) if cell else numerals.NOTHING)
    speedup = numerals.ratio(best_over_ours(scene, labels, cells))
    table.rules.add(len(table.rows))
    table.rows.append([style.scene_title(scene), "ms", *times, speedup])
    table.rows.append(["", "MiB", *memory, ""])


def record(
    results: Results, scene: str, solver: str, label: str, cell: Cell, speedup: Estimate
) -> tables.Record:
    prepared = math.nan if cell.reported else results.prepare_seconds(cell.row)
    return {
        "scene": scene,
        "solver": solver,
        "label": label,
        "status": cell.status,
        "n": cell.time.n,
        "median_seconds": cell.time.value,
        "low_seconds": cell.time.low,
        "high_seconds": cell.time.high,
        "prepare_seconds": prepared,
        "peak_bytes": int(results.cases.peak_bytes[cell.row]),
        "lower": float(results.cases.lower[cell.row]),
        "upper": float(results.cases.upper[cell.row]),
        "best_other_over_ours": speedup.value,
    }


def add_means(table: tables.Table, results: Results, labels: Labels, cells: Cells) -> None:
    """Adds the row of the geometric mean over all workloads, and the notes about it."""
    scenes = results.scenes
    speedups = [best_over_ours(scene, labels, cells) for scene in scenes]
    ratios = [speedup.value for speedup in speedups if speedup.n]
    mean = numerals.number(float(scipy.stats.gmean(ratios)) if ratios else math.nan)
    least = numerals.number(min(ratios, default=math.nan))
    limit = numerals.number(float(results.cases.case_seconds_limit[0]))
    table.rules.add(len(table.rows))
    table.rows.append(["geometric mean", "", *[""] * len(labels), mean])
    table.notes += [
        f"Best other / ours: geometric mean {mean}, least {least}, over {len(ratios)} of "
        f"{len(scenes)} workloads. Solvers that did not end in {limit} s are left out: they took "
        "longer.",
        tables.coverage_note(cell.time for cell in cells.values())
        + " SciPy's programs measure their own time, without starting Python and reading files, and "
        "are compared with our wall time. Their memory includes Python.",
        f"{machine_line(results)}.",
    ]


def make(results: Results) -> Report:
    cases = results.cases
    scenes = results.scenes
    labels = style.order(zip(cases.solver, cases.label))
    cells = {}
    for scene in scenes:
        for _, label in labels:
            if rows := results.rows(scene=scene, label=label):
                cells[scene, label] = Cell(results, rows[0])
    table = tables.Table(
        "Time to prepare and solve, ms, of exact directed distances between point sets, with the "
        "peak memory, MiB, below.",
        ["workload", "", *[style.title(*pair) for pair in labels], "best other / ours"],
        left=2,
    )
    records = []
    for scene in scenes:
        add_rows(table, scene, labels, cells)
        first = results.rows(scene=scene)[0]
        table.notes.append(
            f"{style.scene_title(scene)}: {cases.scene_note[first]}; "
            f"{cases.source_elements[first]:,} to {cases.target_elements[first]:,} points."
        )
        speedup = best_over_ours(scene, labels, cells)
        for solver, label in labels:
            if cell := cells.get((scene, label)):
                records.append(record(results, scene, solver, label, cell, speedup))
    table.verdicts = [judge(results, cells)]
    add_means(table, results, labels, cells)
    caption = (
        "Time to prepare and solve, s, of exact directed distances between point sets: the median, "
        "and its interval. Right of the frame: no answer, and why."
    )
    return Report(
        lambda: draw(scenes, labels, cells),
        table,
        records,
        style.letters_key(cell.status for cell in cells.values()),
        caption=caption,
    )


def draw(scenes: list[str], labels: Labels, cells: Cells) -> Any:
    """Draws a band for each workload, with the time and interval of each solver.

    Solvers that failed are listed at the right, with a letter for the reason.
    """
    figure, ax = plt.subplots(figsize=(style.SINGLE_COLUMN, min(7.8, 1.1 + 0.27 * len(scenes))))
    looks = {label: style.look(solver, label) for solver, label in labels}
    for i, scene in enumerate(scenes):
        if i % 2:
            ax.axhspan(i - 0.5, i + 0.5, color="#F5F5F5", linewidth=0, zorder=0)
        failed = 0
        for k, (_, label) in enumerate(labels):
            cell = cells.get((scene, label))
            if cell and cell.time.n:
                y = i + 0.8 * ((k + 0.5) / len(labels) - 0.5)
                style.interval(ax, cell.time, y, color=looks[label].colour, linewidth=1.0)
                ax.plot(cell.time.value, y, **style.filled_marker(looks[label]))
            elif cell:
                at = 1.03 + 0.09 * failed
                failed += 1
                ax.plot(
                    at,
                    i,
                    transform=ax.get_yaxis_transform(),
                    clip_on=False,
                    **style.open_marker(looks[label]),
                )
                ax.text(
                    at + 0.025,
                    i,
                    style.status_letter(cell.status),
                    transform=ax.get_yaxis_transform(),
                    va="center",
                    fontsize=6,
                    color="#333333",
                )
    seconds = [
        cell.time.value for cell in cells.values() if cell.time.n and np.isfinite(cell.time.value)
    ] or [1.0]
    ax.set_xscale("log")
    ax.set_xlim(min(seconds) / 2, max(seconds) * 4)
    ax.set_ylim(len(scenes) - 0.5, -0.5)
    ax.set_yticks(range(len(scenes)), map(style.scene_title, scenes))
    ax.grid(False, axis="y")
    ax.tick_params(axis="y", length=0)
    ax.set_xlabel("time to prepare and solve (s)")
    style.legend_above(
        figure,
        [
            Line2D([], [], label=looks[label].title, **style.filled_marker(looks[label]))
            for _, label in labels
        ],
        columns=2,
    )
    return figure
