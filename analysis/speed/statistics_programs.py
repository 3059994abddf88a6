"""Error and time of programs that estimate the mean distance from samples of A (MeshLab,
CloudCompare), beside `distribution`.

Draws the external programs of `distribution_error_vs_time`. Their labels are "PROGRAM, N samples".
The error is the largest difference between the estimate and a value in the interval that is proven
for the mean.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from typing import Any, Final, NamedTuple

import matplotlib.pyplot as plt
import numpy as np
import scipy.stats
from matplotlib.lines import Line2D

from analysis.shared import claims, numerals, scales, style, tables
from analysis.shared.notes import machine_line
from analysis.shared.report import Report
from analysis.shared.results import Results
from analysis.shared.estimates import NO_DATA, Estimate, median, ratio_by_round
from analysis.shared.verdicts import Verdict, above_one
from analysis.speed.distribution_error_vs_time import OURS, pair_of

RESULTS_OF: Final = "distribution_error_vs_time"
ERRORS: Final = (1e-2, 1e-3)  # relative to the mean
LEAST: Final = 1e-3  # seconds: a program's time is at least this, as MeshLab's is a difference of two runs, which noise can make 0
COLOURS: Final = ("#AA4499", "#117733", "#CC6677", "#332288")
MARKERS: Final = "^vsD"


class Estimated(NamedTuple):
    """A run of a program on a pair of meshes."""

    row: int
    samples: int
    error: float  # relative to the mean


class Runs:
    """All runs of the programs, and ours, on the mean of each pair."""

    def __init__(self, results: Results) -> None:
        cases = results.cases
        self.results = results
        self.scenes = [
            scene
            for scene in results.scenes
            if cases.statistic[results.rows(scene=scene)[0]] == "mean"
        ]
        self.programs: dict[
            str, dict[str, list[Estimated]]
        ] = {}  # by program and scene, fewest samples first
        self.failed: dict[
            str, dict[str, str]
        ] = {}  # by program and scene: the status of the first run without an answer
        for row in range(len(cases)):
            named = re.fullmatch(r"(.+), (\d+) samples", str(cases.label[row]))
            if (
                cases.solver[row] != "external"
                or not named
                or (scene := str(cases.scene[row])) not in self.scenes
            ):
                continue
            runs = self.programs.setdefault(named[1], {}).setdefault(scene, [])
            if cases.status[row] in (
                "ok",
                "unsound",
            ):  # an estimate that is refuted still has an error
                runs.append(Estimated(row, int(named[2]), results.error(row) / results.middle(row)))
                runs.sort(key=lambda run: run.samples)
            else:
                self.failed.setdefault(named[1], {}).setdefault(scene, str(cases.status[row]))

    def enough(self, program: str, scene: str, error: float) -> Estimated | None:
        """Returns the run with the fewest samples such that it and all larger runs have at most
        this error; None if the largest run has a larger one."""
        fewest = None
        for run in reversed(self.programs[program].get(scene, [])):
            if not run.error <= error:
                break
            fewest = run
        return fewest

    def ours(self, scene: str, error: float) -> int | None:
        rows = [
            row
            for row in self.results.rows(scene=scene, label=OURS)
            if np.isclose(self.results.cases.tolerance[row], error)
            and self.results.cases.status[row] == "ok"
        ]
        return rows[0] if rows else None

    def times(self, row: int) -> dict[int, float]:
        """Returns the wall time by round: a program's own, or ours to prepare and solve."""
        reported = {
            number: max(LEAST, seconds)
            for number, seconds in self.results.reported_by_round(row).items()
        }
        return reported or self.results.total_by_round(row, "wall")

    def mean_ratio(self, pairs: Sequence[tuple[int, int]]) -> Estimate:
        """Returns the geometric mean over pairs of (time of the first row / time of the second),
        over the rounds that all have."""
        first_times = [self.times(first) for first, _ in pairs]
        second_times = [self.times(second) for _, second in pairs]
        shared = (
            set[int]().union(*first_times).intersection(*first_times).intersection(*second_times)
        )
        if not shared:
            return NO_DATA
        above, below = {}, {}
        for number in shared:
            above[number] = float(scipy.stats.gmean([times[number] for times in first_times]))
            below[number] = float(scipy.stats.gmean([times[number] for times in second_times]))
        return ratio_by_round(above, below)


def judge(runs: Runs, program: str, error: float) -> Verdict:
    claim = claims.of("hausbench", "statistics_programs", program=program, error=f"{error:g}")
    pairs, never = list[tuple[int, int]](), 0
    for scene in runs.scenes:
        ours, enough = runs.ours(scene, error), runs.enough(program, scene, error)
        if ours is not None and enough is not None:
            pairs.append((enough.row, ours))
        never += enough is None and any(
            run.error > error for run in runs.programs[program].get(scene, [])
        )
    verdict = above_one(claim, runs.mean_ratio(pairs), f"over {len(pairs)} pairs, ratio")
    more = f"; on {never} more, its largest number of samples is not enough" if never else ""
    faster = sum(runs.mean_ratio([pair]).high < 1 for pair in pairs)
    more += f"; {program} is faster on {faster}" if faster else ""
    return replace(verdict, evidence=verdict.evidence + more)


def make(results: Results) -> Report:
    runs = Runs(results)
    table = tables.Table(
        "The mean distance by programs that sample A. For each error: the fewest samples such that their mean, and the mean of every larger run, is "
        "within this error; the error of their mean; the program's time; and this time divided by the time in which distribution proves an interval of this width.",
        [
            "pair",
            "error",
            f"{style.title(OURS)}, ms",
            *[
                f"{program}{ending}"
                for program in runs.programs
                for ending in (", samples", ", error", ", ms", " / ours")
            ],
        ],
        left=2,
    )
    for scene in runs.scenes:
        table.rules.add(len(table.rows))
        for error in ERRORS:
            ours = runs.ours(scene, error)
            first = pair_of(results, results.rows(scene=scene)[0])
            row = [
                first if error == ERRORS[0] else "",
                numerals.number(error, 1),
                numerals.estimate(median(list(runs.times(ours).values())), 1e3)
                if ours is not None
                else numerals.NOTHING,
            ]
            for program, by_scene in runs.programs.items():
                enough = runs.enough(program, scene, error)
                if enough is None:
                    largest = (
                        by_scene[scene][-1].error if by_scene.get(scene) else np.nan
                    )  # without a proven interval, the error is not a number
                    word = (
                        numerals.NOTHING
                        if by_scene.get(scene)
                        else style.status_word(runs.failed.get(program, {}).get(scene, ""))
                    )
                    row += (
                        [word, numerals.NOTHING, numerals.NOTHING, numerals.NOTHING]
                        if np.isnan(largest)
                        else [
                            "more",
                            numerals.number(largest, 2),
                            numerals.NOTHING,
                            numerals.NOTHING,
                        ]
                    )
                    continue
                ratio = runs.mean_ratio([(enough.row, ours)]) if ours is not None else NO_DATA
                row += [
                    f"{enough.samples:,}",
                    numerals.number(enough.error, 2),
                    numerals.estimate(median(list(runs.times(enough.row).values())), 1e3),
                    numerals.estimate(ratio),
                ]
            table.rows.append(row)
    records = [
        {
            "pair": pair_of(results, run.row),
            "program": program,
            "samples": run.samples,
            "relative_error": run.error,
            "status": str(results.cases.status[run.row]),
            **tables.seconds(median(list(runs.times(run.row).values()))),
        }
        for program, by_scene in runs.programs.items()
        for estimates in by_scene.values()
        for run in estimates
    ]
    table.verdicts = [judge(runs, program, error) for program in runs.programs for error in ERRORS]
    table.notes += [
        "The error is the largest difference between the estimate and a value in the proven interval of the mean, divided by the mean. 'more': even the largest number of samples is not "
        "enough; its error is shown. Times of programs exclude starting them and reading files and, for CloudCompare, sampling. Our times include preparation. "
        f"MeshLab's time is a run with the filter less a run without it, and counts as at least {numerals.number(1e3 * LEAST)} ms. All run on one core.",
        f"{machine_line(results)}."
        if runs.programs
        else "No program was run. They run in profile paper, if they are installed (Debian packages meshlab, xvfb and cloudcompare).",
    ]
    caption = (
        "Error of the mean, as a fraction of the mean, against time. A point of a program is one pair of meshes and one number of samples. "
        "A point of distribution (ours) is one pair and one tolerance; its error is the width of the proven interval."
    )
    drawn = any(
        run.error > 0
        for by_scene in runs.programs.values()
        for estimates in by_scene.values()
        for run in estimates
    )
    return Report(
        (lambda: draw(runs)) if drawn else None,
        table,
        records,
        caption=caption,
        clock="Times are wall time.",
    )


def draw(runs: Runs) -> Any:
    results = runs.results
    figure, ax = plt.subplots(figsize=(style.SINGLE_COLUMN, 2.6))
    handles = []
    for k, (program, by_scene) in enumerate(runs.programs.items()):
        drawn = [run for estimates in by_scene.values() for run in estimates if run.error > 0]
        times = [float(np.median(list(runs.times(run.row).values()))) for run in drawn]
        errors = [run.error for run in drawn]
        looks: dict[str, Any] = {
            "color": COLOURS[k % len(COLOURS)],
            "marker": MARKERS[k % len(MARKERS)],
            "markersize": 3,
            "linestyle": "none",
        }
        ax.plot(times, errors, **looks)
        handles.append(Line2D([], [], label=program, **looks))
    mine = [
        row
        for scene in runs.scenes
        for row in results.rows(scene=scene, label=OURS)
        if results.is_bounded(row) and results.gap(row) > 0
    ]
    our_times = [float(np.median(list(runs.times(row).values()))) for row in mine]
    our_widths = [results.gap(row) / results.middle(row) for row in mine]
    look = style.filled_marker(style.look(OURS, OURS)) | {"linestyle": "none"}
    ax.plot(our_times, our_widths, **look)
    handles.append(Line2D([], [], label=style.title(OURS), **look))
    ax.set_xscale("log")
    ax.set_yscale("log")
    ax.set_xlabel("time (s)")
    ax.set_ylabel("error of the mean / mean")
    scales.log_ticks(ax.xaxis)
    scales.log_ticks(ax.yaxis)
    style.legend_above(figure, handles)
    return figure
