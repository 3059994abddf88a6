"""Peak memory of exact solvers over the number of points: compares the queues of INC with trees and
scans."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Final

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.lines import Line2D

from analysis.scaling import growth
from analysis.shared import claims, numerals, scales, style, tables
from analysis.shared.cells import DISTANCES, Cell
from analysis.shared.notes import machine_line
from analysis.shared.report import NO_TIMES, Report
from analysis.shared.results import Results
from analysis.shared.verdicts import FAILS, HOLDS, OPEN, UNTESTED, Verdict

POINT: Final = 24  # bytes: three doubles
LEAST: Final = (
    2**20
)  # bytes; smaller peaks are dominated by page sizes and memory left over from loading
LINEAR: Final = 1.2  # largest exponent that counts as almost linear; the paper gives no number
ALIKE: Final = (
    0.05  # peaks of two runs of one solver differ by less than this, due to the allocator
)


@dataclass(frozen=True)
class Spot:
    workload: str
    size: str
    points: int  # |A| + |B|
    cells: dict[str, Cell]  # by label


def collect(results: Results) -> list[Spot]:
    """Collects the cells of each scene, whose name is 'workload, size'."""
    spots = []
    for scene in results.scenes:
        rows = results.rows(scene=scene)
        workload, _, size = scene.partition(", ")
        labels = dict.fromkeys(str(label) for label in results.cases.label[rows])
        first = rows[0]
        spots.append(
            Spot(
                workload,
                size,
                int(results.cases.source_elements[first] + results.cases.target_elements[first]),
                {label: Cell(results, results.rows(scene=scene, label=label)) for label in labels},
            )
        )
    return spots


def slope(points: list[int], peaks: list[float]) -> float:
    """Returns the exponent in memory = constant * n^exponent, by least squares of logarithms.

    NaN if fewer than two peaks are at least LEAST.
    """
    large = [(n, peak) for n, peak in zip(points, peaks) if peak >= LEAST]
    sizes = [n for n, _ in large]
    if len(set(sizes)) < 2:
        return math.nan
    return float(np.polyfit(np.log(sizes), np.log([peak for _, peak in large]), 1)[0])


def of_workload(spots: list[Spot], workload: str) -> list[Spot]:
    return [spot for spot in spots if spot.workload == workload]


def verdict(workload: str, spots: list[Spot]) -> Verdict:
    """Judges the claim that INC needs the most memory, at the largest size at which INC ended.

    A peak is a single number: peaks that differ by less than ALIKE of the larger, or by less than
    LEAST, count as equal. A solver that ran out of memory needs more than INC if its limit is above
    INC's peak. The memory that a solver needs is unknown if it failed in another way, so the claim
    cannot hold then.
    """
    claim = claims.of("hausbench", "inc_memory", workload)
    with_inc = [spot for spot in spots if "inc" in spot.cells and spot.cells["inc"].peak > 0]
    if not with_inc:
        return Verdict(claim, UNTESTED, "the memory of INC is unknown")
    largest = max(with_inc, key=lambda spot: spot.points)
    inc_peak, rivals = largest.cells["inc"].peak, {
        label: cell for label, cell in largest.cells.items() if label != "inc"
    }
    peaks = {label: cell.peak for label, cell in rivals.items() if cell.peak >= 0}
    outcomes, parts = [], [f"INC {numerals.number(inc_peak / 2**20)} MiB"]
    if peaks:
        most = max(peaks, key=lambda label: peaks[label])
        outcomes.append(compared(inc_peak, peaks[most]))
        parts.append(f"next {style.title(most)} {numerals.number(peaks[most] / 2**20)} MiB")
    for label, cell in rivals.items():
        if label not in peaks:
            limit = memory_limit(cell)
            outcomes.append(FAILS if compared(inc_peak, limit) == FAILS else OPEN)
            parts.append(
                f"{style.title(label)} {cell.failure_text() if cell.failures else 'of unknown memory'}"
                + (f" at {numerals.number(limit / 2**20)} MiB" if limit > 0 else "")
            )
    if not outcomes:
        return Verdict(claim, UNTESTED, "no other solver")
    outcome = FAILS if FAILS in outcomes else HOLDS if set(outcomes) == {HOLDS} else OPEN
    return Verdict(claim, outcome, f"{largest.size} points each: {', '.join(parts)}")


def almost_linear(workload: str, spots: list[Spot]) -> Verdict:
    """Judges the claim that EARLYBREAK is almost linear, by the exponent of its distances over |A|
    + |B|.

    Each size has one seed; Student's interval comes from their scatter about a line through
    logarithms. If a size has no answer, the claim cannot hold.
    """
    claim = claims.of("zhang2017", "almost_linear", workload)
    cells = [
        (spot.points, spot.cells["earlybreak"]) for spot in spots if "earlybreak" in spot.cells
    ]
    counted = [
        (points, cell.count(DISTANCES))
        for points, cell in cells
        if not math.isnan(cell.count(DISTANCES))
    ]
    sizes = tuple(points for points, _ in counted)
    grown = growth.Growth(sizes, tuple(count for _, count in counted))
    if not grown.known:
        return Verdict(claim, UNTESTED, "fewer than three sizes with an answer")
    exponent, lost = grown.exponent(), [cell.failure_text() for _, cell in cells if cell.failures]
    outcome = (
        FAILS if exponent.low > LINEAR else HOLDS if exponent.high <= LINEAR and not lost else OPEN
    )
    return Verdict(
        claim,
        outcome,
        f"exponent {growth.text(exponent)} over {len(counted)} sizes"
        + (
            f", {len(lost)} more without an answer ({', '.join(dict.fromkeys(lost))})"
            if lost
            else ""
        ),
    )


def compared(inc_peak: float, rival_peak: float) -> str:
    """Returns the outcome for the claim that INC's peak is greater than another."""
    alike = abs(inc_peak - rival_peak) < max(LEAST, ALIKE * max(inc_peak, rival_peak))
    return OPEN if alike else HOLDS if inc_peak > rival_peak else FAILS


def memory_limit(cell: Cell) -> float:
    """Returns the memory limit of a solver that ran out of memory; 0 for all others."""
    return (
        float(cell.results.cases.memory_limit_bytes[cell.rows[0]])
        if cell.failures["out_of_memory"]
        else 0.0
    )


def make(results: Results) -> Report:
    spots = collect(results)
    labels = [label for _, label in style.order(zip(results.cases.solver, results.cases.label))]
    workloads = list(dict.fromkeys(spot.workload for spot in spots))
    table = tables.Table(
        "Peak memory to prepare and solve, MiB, of exact directed distances between point sets.",
        [
            "workload",
            "|A| + |B|",
            "the points themselves",
            *[style.title(label) for label in labels],
            "INC, bytes per point",
            "INC's queues, MiB",
        ],
        left=1,
    )
    records: list[tables.Record] = []
    for workload in workloads:
        table.rules.add(len(table.rows))
        series = of_workload(spots, workload)
        for spot in series:
            inc = spot.cells.get("inc")
            queues = (
                results.extras(inc.rows[0]).get("queue_bytes", math.nan)
                if inc and not inc.failures
                else math.nan
            )
            table.rows.append(
                [
                    workload,
                    f"{spot.points:,}",
                    numerals.number(POINT * spot.points / 2**20),
                    *[
                        numerals.NOTHING
                        if label not in spot.cells
                        else spot.cells[label].failure_text()
                        if spot.cells[label].failures
                        else numerals.number(spot.cells[label].peak / 2**20)
                        for label in labels
                    ],
                    numerals.number(inc.peak / spot.points) if inc else numerals.NOTHING,
                    numerals.number(queues / 2**20),
                ]
            )
            records += [
                {
                    "workload": workload,
                    "size": spot.size,
                    "points": spot.points,
                    "label": label,
                    "status": cell.status(),
                    "peak_bytes": cell.peak,
                    "median_seconds": cell.time.value,
                    "prepare_bytes": int(results.cases.prepare_bytes[cell.rows[0]]),
                    "queue_bytes": results.extras(cell.rows[0]).get("queue_bytes", math.nan),
                }
                for label, cell in spot.cells.items()
            ]
        exponents = []
        for label in labels:
            measured = [spot for spot in series if label in spot.cells]
            peaks = [spot.cells[label].peak for spot in measured]
            exponents.append(slope([spot.points for spot in measured], peaks))
        table.rows.append(
            [workload, "grows as n^", "1", *[numerals.number(x, 2) for x in exponents], "", ""]
        )
    notes = {
        scene.partition(", ")[0]: str(note)
        for scene, note in zip(results.cases.scene, results.cases.scene_note)
    }
    table.verdicts = [
        judge(workload, of_workload(spots, workload))
        for judge in (verdict, almost_linear)
        for workload in workloads
    ]
    table.notes = [
        "Peak: the resident set less the resident set before preparing, so without the points themselves; in pages of 4 KiB, and 0 if the memory "
        "left free by loading was enough, so it says little below 1 MiB (grey). The exponent is of the least squares line through the logarithms "
        "of the peaks above that. Zhang et al. print no memory: INC's queue for every entry of its heap suggests the claim.",
        *[f"{workload}: {notes[workload]}." for workload in workloads],
        f"Here: {machine_line(results)}.",
    ]
    return Report(lambda: draw(spots, workloads, labels), table, records, clock=NO_TIMES)


def draw(spots: list[Spot], workloads: list[str], labels: list[str]) -> Any:
    figure, axes = plt.subplots(
        1, max(1, len(workloads)), figsize=(style.DOUBLE_COLUMN, 2.5), sharey=True, squeeze=False
    )
    for ax, workload in zip(axes[0], workloads):
        series = of_workload(spots, workload)
        sizes = [spot.points for spot in series]
        ends = [min(sizes), max(sizes)]
        ax.plot(
            ends,
            [POINT * n / 2**20 for n in ends],
            color=style.GREY,
            linewidth=0.8,
            linestyle=style.DOTTED,
        )
        ax.axhspan(1e-9, LEAST / 2**20, color="#EFEFEF", linewidth=0, zorder=0)
        marks = []
        for label in labels:
            looks = style.look(label)
            points = [
                (spot.points, spot.cells[label].peak / 2**20)
                for spot in series
                if label in spot.cells and spot.cells[label].peak > 0
            ]
            if points:
                ax.plot(
                    *np.array(points).T, color=looks.colour, linestyle=looks.line, linewidth=0.7
                )
                ax.plot(*np.array(points).T, **style.filled_marker(looks))
            failed = {
                status
                for spot in series
                if label in spot.cells
                for status in spot.cells[label].failures
            }
            marks += [(looks, style.status_letter(status)) for status in sorted(failed)]
        style.margin_marks(ax, marks, 90)
        ax.set(xscale="log", yscale="log", xlabel="points, |A| + |B|", title=workload)
        scales.log_ticks(ax.xaxis)
        scales.log_ticks(ax.yaxis)
    peaks = [
        cell.peak / 2**20 for spot in spots for cell in spot.cells.values() if cell.peak > 0
    ] or [1.0]
    axes[0][0].set_ylim(min(peaks) / 2, max(peaks) * 2)
    axes[0][0].set_ylabel("peak memory (MiB)")
    entries = [
        Line2D(
            [],
            [],
            label=style.title(label),
            linewidth=0.7,
            **{**style.filled_marker(style.look(label)), "linestyle": style.look(label).line},
        )
        for label in labels
    ]
    entries.append(
        Line2D(
            [],
            [],
            label="the points themselves",
            color=style.GREY,
            linewidth=0.8,
            linestyle=style.DOTTED,
        )
    )
    style.legend_above(figure, entries)
    return figure
