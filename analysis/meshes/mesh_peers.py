"""Compares mesh solvers with CGAL on each pair of meshes: time with preparation, speedup, and
memory."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any, Final

import matplotlib.pyplot as plt
import scipy.stats

from analysis.shared import claims, numerals, style, tables
from analysis.shared.cells import Cell, Grid, compare
from analysis.shared.claims import Claim
from analysis.shared.comparable import apart, reason_apart
from analysis.shared.notes import machine_line
from analysis.shared.report import Report
from analysis.shared.results import Results
from analysis.shared.estimates import NO_DATA, Estimate, ratio_by_round, ratio_of_medians
from analysis.shared.verdicts import FAILS, NOT_JUDGED, OPEN, Verdict, above_one, everywhere

PEER: Final = "cgal"
AIMS: Final = {
    "cover": 40,
    "sacht": 3,
    "zheng": 2,
    "tang": 1,
}  # claimed speedup over CGAL, geometric mean
LARGE: Final = {
    "cover": 30_000
}  # this mean includes only pairs with at least so many triangles (default: all pairs)
EVERYWHERE: Final = {"cover": 5}  # claimed speedup over CGAL on every pair
FINER: Final = {"cover": 25}  # claimed speedup over CGAL at each finer tolerance, geometric mean
INTERVAL: Final = ", interval over rounds, for these pairs"

Pair = tuple[Cell, Cell]  # the cells of CGAL and of the solver


def ratio(pair: Pair) -> Estimate:
    """Returns time of CGAL / time of the solver. If CGAL timed out, its limit is used, which gives
    a lower bound."""
    peer, solver = pair
    if peer.failures and comparable(pair):
        return ratio_of_medians([limit_of(peer)] * len(solver.times), list(solver.times.values()))
    return compare(peer, solver)


def identical(results: Results, scene: str) -> bool:
    """Tells whether A and B are the same mesh. The means leave such scenes out, because CGAL
    recognises identical faces."""
    row = results.rows(scene=scene)[0]
    return bool(results.cases.source[row] == results.cases.target[row])


def limit_of(cell: Cell) -> float:
    return float(cell.results.cases.case_seconds_limit[cell.rows[0]])


def comparable(pair: Pair) -> bool:
    """Tells whether the times are comparable: the solver answered, and CGAL answered or timed out.

    Other failures of CGAL say nothing about its time.
    """
    peer, solver = pair
    return not solver.failures and peer.failures.keys() <= {"timeout"} and not apart_of(pair)


def apart_of(pair: Pair) -> str:
    return reason_apart(pair[0].origins | pair[1].origins)


def times_by_round(pair: Pair) -> dict[int, tuple[float, float]]:
    """Returns the times of CGAL and of the solver in each round that has both. If CGAL timed out,
    its time is the limit."""
    peer, solver = pair
    stopped = bool(peer.failures)
    return {
        number: (limit_of(peer) if stopped else peer.times[number], seconds)
        for number, seconds in solver.times.items()
        if stopped or number in peer.times
    }


def mean_ratio(pairs: Sequence[Pair]) -> Estimate:
    """Returns the geometric mean over pairs of CGAL's time / the solver's, with an interval over
    rounds.

    Uses the rounds that all pairs have.
    """
    times = [times_by_round(pair) for pair in pairs]
    rounds = set[int]().union(*times).intersection(*times)
    peer_means, solver_means = dict[int, float](), dict[int, float]()
    for number in rounds:
        peer_mean, solver_mean = scipy.stats.gmean([of[number] for of in times], axis=0)
        peer_means[number], solver_means[number] = float(peer_mean), float(solver_mean)
    return ratio_by_round(peer_means, solver_means)


def judge(label: str, pairs: Sequence[Pair]) -> Verdict:
    """Judges the speedup of a solver over CGAL at the first tolerance."""
    title, aim = style.title(label), AIMS[label]
    among = f" over pairs of {LARGE[label]:,} triangles and more" if label in LARGE else ""
    claim = claims.of(
        "hausbench",
        "times_cgal" if aim > 1 else "as_fast_as_cgal",
        title=title,
        aim=aim,
        among=among,
        label=label,
    )
    return judge_mean(
        claim, aim, [pair for pair in pairs if size_of(pair[0]) >= LARGE.get(label, 0)]
    )


def judge_finer(label: str, tolerance: float, pairs: Sequence[Pair]) -> Verdict:
    """Judges the speedup of a solver over CGAL at a finer tolerance."""
    aim = FINER[label]
    claim = claims.of(
        "hausbench",
        "times_cgal",
        title=style.title(label),
        aim=aim,
        among=f" over all pairs, at a tolerance of {numerals.number(tolerance)} of the diagonal",
        label=label,
    )
    return judge_mean(claim, aim, pairs)


def judge_mean(claim: Claim, aim: float, pairs: Sequence[Pair]) -> Verdict:
    answered = [pair for pair in pairs if comparable(pair)]
    mean = mean_ratio(answered)
    scaled = replace(mean, value=mean.value / aim, low=mean.low / aim, high=mean.high / aim)
    verdict = above_one(claim, scaled)
    lost = sum(not peer.failures for peer, solver in pairs if solver.failures)
    if mean.n:
        too_few = f"n = {mean.n}; " if verdict.outcome == NOT_JUDGED else ""
        verdict = replace(
            verdict,
            evidence=f"{too_few}{numerals.estimate(mean)} times over {len(answered)} pairs{INTERVAL if mean.has_interval else ''}",
        )
    if stopped := sum(
        bool(peer.failures) for peer, _ in answered
    ):  # CGAL was given its limit as time, so the true mean may be larger
        verdict = replace(
            verdict,
            outcome=OPEN if verdict.outcome == FAILS else verdict.outcome,
            evidence=f"{verdict.evidence}, at least: CGAL did not end on {stopped}",
        )
    if lost:
        verdict = replace(
            verdict,
            outcome=verdict.outcome if verdict.outcome == NOT_JUDGED else OPEN,
            evidence=f"{verdict.evidence}; no answer on {lost} that CGAL answered",
        )
    if reasons := [why for pair in pairs if (why := apart_of(pair))]:
        verdict = replace(
            verdict,
            outcome=OPEN if mean.n else verdict.outcome,
            evidence=f"{verdict.evidence}; times {reasons[0]} on {len(reasons)} pairs",
        )
    return verdict


def size_of(cell: Cell) -> float:
    cases, row = cell.results.cases, cell.rows[0]
    return float(cases.source_elements[row] + cases.target_elements[row])


def judge_each(label: str, pairs: Sequence[Pair]) -> Verdict:
    """Judges the speedup on every pair. If CGAL timed out, its limit is used as its time, so the
    pair can only confirm the claim."""
    aim = EVERYWHERE[label]

    def over_aim(pair: Pair) -> Estimate:
        if not comparable(pair):
            return apart(pair[0].origins | pair[1].origins) or NO_DATA
        times = times_by_round(pair)
        peer_over_aim = {number: peer / aim for number, (peer, _) in times.items()}
        solver_seconds = {number: seconds for number, (_, seconds) in times.items()}
        estimate = ratio_by_round(peer_over_aim, solver_seconds)
        return NO_DATA if pair[0].failures and not estimate.low > 1 else estimate

    ratios = [over_aim(pair) for pair in pairs]
    verdict = everywhere(
        claims.of(
            "hausbench", "times_cgal_everywhere", title=style.title(label), aim=aim, label=label
        ),
        ratios,
    )
    speedups = [aim * x.value for x in ratios if x.n]
    spread = (
        f"{numerals.number(min(speedups))} to {numerals.number(max(speedups))} times; over {aim}: "
        if speedups
        else ""
    )
    few, _, rest = (
        verdict.evidence.partition("; ")
        if verdict.outcome == NOT_JUDGED
        else ("", "", verdict.evidence)
    )
    return replace(verdict, evidence=(f"{few}; " if few else "") + spread + rest)


def against(
    label: str, rival: str, cells: dict[tuple[str, str], Cell], scenes: Sequence[str]
) -> list[str]:
    """Returns a note on the geometric mean of time of `rival` / time of `label`; empty if no pair
    has both."""
    both = [
        (cells[scene, rival], cells[scene, label])
        for scene in scenes
        if {(scene, rival), (scene, label)} <= cells.keys()
    ]
    answered = [
        pair
        for pair in both
        if not pair[0].failures and not pair[1].failures and not apart_of(pair)
    ]
    if not answered:
        return []
    return [
        f"{style.title(rival)} takes {numerals.estimate(mean_ratio(answered))} times as long as {style.title(label)} in geometric mean over the "
        f"{len(answered)} pairs that both answered (interval over rounds, for these pairs)."
    ]


def pairs_with_cgal(results: Results, grid: Grid) -> dict[str, dict[str, Pair]]:
    """Returns the cells of CGAL and of each solver, by label and scene. Leaves out scenes in which
    A and B are the same mesh."""
    pairs = {}
    for _, label in grid.labels:
        if label != PEER:
            pairs[label] = {
                scene: (grid.cells[scene, PEER], grid.cells[scene, label])
                for scene in grid.scenes
                if not identical(results, scene)
                and {(scene, PEER), (scene, label)} <= grid.cells.keys()
            }
    return pairs


def means(
    pairs: dict[str, dict[str, Pair]],
    labels: Sequence[tuple[str, str]],
    among: Sequence[str] | None = None,
) -> list[str]:
    """Returns the geometric mean of each label over the pairs that it answered, or over the scenes
    `among`; empty for one without pairs."""
    texts = []
    for _, label in labels:
        by_scene = pairs.get(label, {})
        answered = {scene: pair for scene, pair in by_scene.items() if comparable(pair)}
        chosen = [pair for scene, pair in answered.items() if among is None or scene in among]
        texts.append(numerals.estimate(mean_ratio(chosen)) if answered else "")
    return texts


def records_of(results: Results, grid: Grid, tolerance: float) -> list[tables.Record]:
    """Returns one record for each pair and solver of the grid, for the CSV file."""
    records: list[tables.Record] = []
    for scene in grid.scenes:
        peer, diagonal = grid.cells.get((scene, PEER)), float(
            results.cases.source_diagonal[grid.first(scene)]
        )
        for (solver, label), cell in zip(grid.labels, grid.row(scene)):
            if cell:
                x = ratio((peer, cell)) if peer and cell is not peer else NO_DATA
                records.append(
                    {
                        "scene": scene,
                        "tolerance": tolerance,
                        "solver": solver,
                        "label": label,
                        "status": cell.status(),
                        **tables.seconds(cell.time),
                        "prepare_seconds": cell.prepare,
                        "peak_bytes": cell.peak,
                        "cgal_over_it": x.value,
                        "cgal_over_it_low": x.low,
                        "cgal_over_it_high": x.high,
                        "h_of_diagonal": proven([cell for cell in grid.row(scene) if cell])[0]
                        / diagonal,
                    }
                )
    return records


def make(results: Results) -> Report:
    cases = results.cases
    tolerance, *finer = sorted({float(x) for x in cases.tolerance}, reverse=True)
    grid = Grid(results, tolerance=tolerance)
    scenes, labels, cells = grid.scenes, grid.labels, grid.cells
    table = tables.Table(
        "Time to prepare and solve, ms; how many times as long CGAL takes; and peak memory without the shapes, MiB. Directed distance, "
        f"tolerance {numerals.number(tolerance)} of the diagonal of A.",
        ["pair", "triangles", "h / diagonal", "", *grid.titles()],
        left=4,
    )
    for scene in scenes:
        row, row_cells, peer = grid.first(scene), grid.row(scene), cells.get((scene, PEER))
        ratios = [
            ratio((peer, cell)) if peer and cell and cell is not peer else NO_DATA
            for cell in row_cells
        ]
        h = numerals.value(
            *proven([cell for cell in row_cells if cell]), over=float(cases.source_diagonal[row])
        )
        table.rules.add(len(table.rows))
        table.rows.append([scene, results.sizes(row, " → "), h, "ms", *grid.texts(scene, 1000)])
        at_least = "≥ " if peer and peer.failures else ""
        table.rows.append(
            [
                "",
                "",
                "",
                "times",
                *[(at_least if x.n else "") + numerals.estimate(x) for x in ratios],
            ]
        )
        table.rows.append(
            [
                "",
                "",
                "",
                "MiB",
                *[
                    numerals.number(cell.peak / 2**20) if cell else numerals.NOTHING
                    for cell in row_cells
                ],
            ]
        )
        if cases.scene_note[row]:
            table.notes.append(f"{scene}: {cases.scene_note[row]}.")
    records = records_of(results, grid, tolerance)
    pairs = pairs_with_cgal(results, grid)
    answered = {}
    for label, by_scene in pairs.items():
        answered[label] = [scene for scene, pair in by_scene.items() if comparable(pair)]
    common = set(scenes).intersection(*answered.values())
    shared = [scene for scene in scenes if scene in common]
    table.rules.add(len(table.rows))
    table.rows.append(["geometric mean", "", "", "times", *means(pairs, labels)])
    if shared and any(len(its_scenes) > len(shared) for its_scenes in answered.values()):
        table.rows.append(
            [
                f"over the {len(shared)} pairs that all answered",
                "",
                "",
                "times",
                *means(pairs, labels, shared),
            ]
        )
    table.verdicts = [judge(label, list(pairs[label].values())) for label in AIMS if label in pairs]
    table.verdicts += [
        judge_each(label, list(pairs[label].values())) for label in EVERYWHERE if label in pairs
    ]
    for small in finer:
        finer_grid = Grid(results, tolerance=small)
        records += records_of(results, finer_grid, small)
        tighter = pairs_with_cgal(results, finer_grid)
        table.rows.append(
            [
                f"geometric mean at {numerals.number(small)}",
                "",
                "",
                "times",
                *means(tighter, labels),
            ]
        )
        table.verdicts += [
            judge_finer(label, small, list(tighter[label].values()))
            for label in FINER
            if label in tighter
        ]
    counted = ", ".join(
        f"{style.title(label)} {len(its_scenes)}" for label, its_scenes in answered.items()
    )
    distinct = [scene for scene in scenes if not identical(results, scene)]
    table.notes += [
        f"Geometric mean: over the pairs that a solver answered ({counted}), of {len(scenes)}, without identical shapes. If CGAL did not end, its limit of "
        f"{numerals.number(limit_of(next(iter(cells.values()))))} s stands for its time (≥). Its interval is over rounds, for these pairs: it shows how "
        "certain the mean of these pairs is, not what other pairs would give.",
        *against("cover", "sacht", cells, distinct),
        tables.coverage_note(cell.time for cell in cells.values()),
        f"{machine_line(results, results.rows(tolerance=tolerance))}.",
    ]
    caption = (
        f"Time to prepare and solve, s: the median, and its interval. Directed distance, tolerance {numerals.number(tolerance)} of the diagonal of A. "
        "Right of the frame: no answer, and why."
    )
    return Report(
        lambda: draw(grid),
        table,
        records,
        style.letters_key(status for cell in cells.values() for status in cell.failures),
        caption=caption,
    )


def proven(cells: Sequence[Cell]) -> tuple[float, float]:
    """Returns the largest lower and the least upper bound that is proven of the pair; NaN if there
    is none."""
    intervals = [cell.interval for cell in cells if not math.isnan(cell.interval[0])]
    lower = max((low for low, _ in intervals), default=math.nan)
    upper = min((high for _, high in intervals), default=math.nan)
    return lower, upper


def draw(grid: Grid) -> Any:
    """Draws a band for each pair, with the time and interval of each solver.

    Solvers that failed are listed at the right, with a letter for the reason.
    """
    scenes, labels, cells = grid.scenes, grid.labels, grid.cells
    figure, ax = plt.subplots(figsize=(style.SINGLE_COLUMN, min(7.8, 1.1 + 0.3 * len(scenes))))
    for i, scene in enumerate(scenes):
        if i % 2:
            ax.axhspan(i - 0.5, i + 0.5, color="#F5F5F5", linewidth=0, zorder=0)
        failed = 0
        for k, (solver, label) in enumerate(labels):
            cell, looks = cells.get((scene, label)), style.look(solver, label)
            if cell and cell.time.n:
                y = i + 0.8 * ((k + 0.5) / len(labels) - 0.5)
                style.interval(ax, cell.time, y, color=looks.colour, linewidth=1.0)
                ax.plot(cell.time.value, y, **style.filled_marker(looks))
            elif cell:
                at = 1.03 + 0.09 * failed
                failed += 1
                status = cell.failures.most_common(1)[0][0]
                ax.plot(
                    at,
                    i,
                    transform=ax.get_yaxis_transform(),
                    clip_on=False,
                    **style.open_marker(looks),
                )
                ax.text(
                    at + 0.025,
                    i,
                    style.status_letter(status),
                    transform=ax.get_yaxis_transform(),
                    va="center",
                    fontsize=6,
                    color="#333333",
                )
    seconds = [cell.time.value for cell in cells.values() if cell.time.n] or [1.0]
    ax.set_xscale("log")
    ax.set_xlim(min(seconds) / 2, max(seconds) * 2)
    ax.set_ylim(len(scenes) - 0.5, -0.5)
    ax.set_yticks(range(len(scenes)), scenes)
    ax.grid(False, axis="y")
    ax.tick_params(axis="y", length=0)
    ax.set_xlabel("time to prepare and solve (s)")
    style.legend_above(figure, style.handles(labels, lines=False))
    return figure
