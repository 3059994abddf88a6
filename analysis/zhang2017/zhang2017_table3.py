"""Table 3 of Zhang et al. 2017: time to compute the exact distances of six pairs of point sets,
beside the paper's times."""

from __future__ import annotations

from typing import Any

import numpy as np

from analysis.shared import beside_paper, claims, numerals, style, tables
from analysis.shared.cells import (
    DISTANCES,
    MEASURES,
    WORK,
    Cell,
    Grid,
    count_text,
    in_time_and_work,
)
from analysis.shared.load import paper_numbers
from analysis.shared.notes import machine_line, total_title
from analysis.shared.over_pairs import on_average
from analysis.shared.report import Report
from analysis.shared.results import Results
from analysis.shared.sizes import tests_claims
from analysis.shared.verdicts import Verdict, all_of

COLUMNS = ("naive", "inc", "earlybreak", "adaptive")  # the four of the paper
RATIOS = (
    ("naive", "earlybreak"),
    ("naive", "adaptive"),
    ("inc", "adaptive"),
    ("earlybreak", "adaptive"),
)


def ratio_title(slow: str, fast: str) -> str:
    return f"{style.title(slow)} / {style.title(fast)}".replace("NOHD/OHD ", "")


def nanoseconds(cell: Cell | None) -> float:
    """Returns the time per computed distance, preparation included."""
    return 1e9 * cell.time.value / cell.count(DISTANCES) if cell and cell.time.n else np.nan


def span(values: list[float], digits: int = 2) -> str:
    finite = [x for x in values if np.isfinite(x)]
    if not finite:
        return "an unknown number of"
    low, high = numerals.number(min(finite), digits), numerals.number(max(finite), digits)
    return low if low == high else f"{low} to {high}"


def what_it_saves(grid: Grid, papers: dict[str, dict[str, Any]]) -> str:
    """Returns a note on why ratios of times differ from the paper's: the cost per distance, and how
    many distances are saved."""
    paper_costs = [
        1e9 * paper["naive"] / (paper["source_elements"] * paper["target_elements"])
        for paper in papers.values()
        if "naive" in paper
    ]
    naive_costs = [nanoseconds(grid.cells.get((scene, "naive"))) for scene in grid.scenes]
    framework_costs = [
        1e9 * cell.time.value / cell.count(WORK)
        if (cell := grid.cells.get((scene, "adaptive"))) and cell.time.n
        else np.nan
        for scene in grid.scenes
    ]
    parts = [
        f"In the paper a pair of points costs NAIVEHDD {span(paper_costs, 3)} ns, here {span(naive_costs)} ns. A distance, bound or "
        f"node costs the framework {span(framework_costs)} ns here, preparation included: to gain time, each must save NAIVEHDD "
        f"{span([a / b for a, b in zip(framework_costs, naive_costs)])} pairs."
    ]
    for slow in [slow for slow, fast in RATIOS if fast == "adaptive"]:
        saved = []
        for measure in ("distances", "distances, bounds and nodes", ""):
            ratios = [grid.ratio(scene, slow, "adaptive", measure) for scene in grid.scenes]
            saved.append([ratio.value for ratio in ratios])
        if np.isfinite(saved).any():
            parts.append(
                f"{style.title(slow)} computes {span(saved[0])} times as many distances as the framework, {span(saved[1])} times as many distances, "
                f"bounds and nodes, and takes {span(saved[2])} times as long."
            )
    return " ".join(parts)


def paper_ratio(paper: dict[str, Any], slow: str, fast: str) -> str:
    return (
        numerals.number(paper[slow] / paper[fast])
        if slow in paper and fast in paper
        else numerals.NOTHING
    )


def faster(grid: Grid, slow: str) -> Verdict:
    """Judges the claim that the framework is faster, on average only: in row (e) of the paper's
    table EARLYBREAK is faster."""
    claim = claims.of("zhang2017", f"framework_{slow}")
    return in_time_and_work(
        lambda measure: on_average(
            claim, [grid.ratio(scene, slow, "adaptive", measure) for scene in grid.scenes]
        )
    )


def all_pairs(grid: Grid) -> Verdict:
    """Judges the claim that NAIVEHDD computes |A| * |B| distances. It is deterministic, so one row
    per pair is enough."""
    counted = [
        cell
        for scene in grid.scenes
        if (cell := grid.cells.get((scene, "naive"))) and not np.isnan(cell.count(DISTANCES))
    ]
    cases = grid.results.cases
    unlike = sum(
        cell.count(DISTANCES)
        != int(cases.source_elements[cell.rows[0]]) * int(cases.target_elements[cell.rows[0]])
        for cell in counted
    )
    return all_of(
        claims.of("zhang2017", "all_pairs"), unlike, len(counted), len(grid.scenes), "pairs"
    )


def make(results: Results) -> Report:
    cases, printed = results.cases, paper_numbers(results.stem)
    papers = {row["scene"]: row for row in printed["row"]}
    columns = [(name, name) for name in COLUMNS]
    grid = Grid(
        results,
        [
            *columns,
            *[pair for pair in style.order(zip(cases.solver, cases.label)) if pair not in columns],
        ],
    )
    grid.scenes.sort(key=lambda s: list(papers).index(s) if s in papers else len(papers))
    unit, scale = numerals.time_unit(cell.time.value for cell in grid.cells.values())
    table = tables.Table(
        f"{total_title(results)}, {unit}, of exact directed Hausdorff distances between point sets, measured here and as printed in Table 3 of Zhang et al. "
        "2017, with the counted work.",
        ["scene", "", "|A| / |B|", *grid.titles(), *[ratio_title(*pair) for pair in RATIOS]],
        left=2,
        parts=(2, 3 + len(grid.titles())),
    )
    records: list[tables.Record] = []
    for scene in grid.scenes:
        paper, first, cells = papers.get(scene, {}), grid.first(scene), grid.row(scene)
        table.rules.add(len(table.rows))
        table.rows.append(
            [
                style.scene_title(scene),
                "here",
                results.sizes(first),
                *grid.texts(scene, scale),
                *[numerals.ratio(grid.ratio(scene, *pair)) for pair in RATIOS],
            ]
        )
        for measure, names in MEASURES.items():
            counts = [count_text(cell, names) for cell in cells]
            ratios = [numerals.ratio(grid.ratio(scene, *pair, measure)) for pair in RATIOS]
            table.rows.append(["", measure, "", *counts, *ratios])
        table.rows.append(
            [
                "",
                "ns per distance",
                "",
                *[numerals.number(nanoseconds(cell)) for cell in cells],
                *[numerals.NOTHING] * len(RATIOS),
            ]
        )
        if paper:
            sizes = f"{paper['source_elements']:,} / {paper['target_elements']:,}"
            times = [
                f"{paper[label] * scale:.6g}" if label in paper else numerals.NOTHING
                for _, label in grid.labels
            ]
            ratios = [paper_ratio(paper, *pair) for pair in RATIOS]
            table.rows.append(["", "paper", sizes, *times, *ratios])
        if cases.scene_note[first]:
            table.notes.append(f"{style.scene_title(scene)}: {cases.scene_note[first]}")
        for (solver, label), cell in zip(grid.labels, cells):
            if cell:
                records.append(
                    {
                        "scene": scene,
                        "solver": solver,
                        "label": label,
                        "source_elements": int(cases.source_elements[first]),
                        "target_elements": int(cases.target_elements[first]),
                        "status": cell.status(),
                        **tables.seconds(cell.time),
                        "coverage": cell.time.coverage,
                        "prepare_seconds": cell.prepare,
                        "peak_bytes": cell.peak,
                        "wall_median_seconds": cell.wall.value,
                        "paper_seconds": float(paper.get(label, np.nan)),
                        "lower": cell.interval.lower,
                        "upper": cell.interval.upper,
                        **cell.counters,
                    }
                )
    table.verdicts = [
        *[faster(grid, slow) for slow, fast in RATIOS if fast == "adaptive"],
        all_pairs(grid),
    ]
    table.notes = [what_it_saves(grid, papers), *table.notes]
    table.notes += [
        tables.coverage_note(cell.time for cell in grid.cells.values())
        + " If a solver was run with several seeds, n counts them, each by its median. Preparation (trees) is included, loading is not.",
        "The solvers count distances, bounds and nodes (the k-d tree counts only distances); the counts of solvers with seeds are medians.",
        f"Here: {machine_line(results)}. Paper: {printed['machine']}.",
        "A dash: not part of the experiment, or not in the paper.",
    ]
    beside = (
        "open, printed in the paper"
        if tests_claims(results)
        else "the paper's times are not shown, because these pairs are smaller"
    )
    caption = (
        f"{total_title(results)}, in seconds, to compute the directed distances of Table 3 of Zhang et al. 2017. Filled: measured here, with the interval of the "
        f"median as a bar; {beside}. Below a pair's name: the shapes that stand in for the paper's."
    )
    return Report(lambda: beside_paper.draw(grid, papers), table, records, caption=caption)
