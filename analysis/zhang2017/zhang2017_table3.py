"""Table 3 of Zhang et al. 2017: time to compute the exact distance of six pairs of point sets, beside the paper's."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from typing import Any

import matplotlib.pyplot as plt
import numpy as np

from analysis.shared import command, style, tables
from analysis.shared.cells import DISTANCES, MEASURES, WORK, Cell, compare, compare_work
from analysis.shared.load import paper_numbers
from analysis.shared.notes import clock_note, clock_title, clock_word, machine_line
from analysis.shared.report import Report
from analysis.shared.results import Results
from analysis.shared.statistics import NO_DATA, Estimate
from analysis.shared.verdicts import Verdict, everywhere

STEM = "zhang2017_table3"
COLUMNS = ("naive", "inc", "earlybreak", "adaptive")  # the paper's four
RATIOS = (("naive", "earlybreak"), ("naive", "adaptive"), ("inc", "adaptive"), ("earlybreak", "adaptive"))


def ratio_title(slow: str, fast: str) -> str:
    return f"{style.look(slow).title} / {style.look(fast).title}".replace("NOHD/OHD ", "")


def ratio_of(cells: Mapping[tuple[str, str], Cell], scene: str, pair: tuple[str, str], what: str = "") -> Estimate:
    """Of times, or of what is named in MEASURES."""
    if any((scene, label) not in cells for label in pair):
        return NO_DATA
    slow, fast = (cells[scene, label] for label in pair)
    return compare_work(slow, fast, MEASURES[what]) if what else compare(slow, fast)


def claim(cells: Mapping[tuple[str, str], Cell], scenes: list[str], slow: str) -> Verdict:
    """The paper's: the framework takes less time; with the same in counted work."""
    text = f"the framework takes less time than {style.look(slow).title}"
    found = {what: everywhere(text, [ratio_of(cells, scene, (slow, "adaptive"), what) for scene in scenes])
             for what in ("", *MEASURES)}
    return found.pop("").with_counts(found)


def nanoseconds(cell: Cell | None) -> float:
    """Of time, preparation included, for one distance that was computed."""
    return 1e9 * cell.time.value / cell.count(DISTANCES) if cell and cell.time.n else np.nan


def span(values: list[float], digits: int = 2) -> str:
    known = [x for x in values if np.isfinite(x)]
    if not known:
        return "an unknown number of"
    low, high = tables.number(min(known), digits), tables.number(max(known), digits)
    return low if low == high else f"{low} to {high}"


def what_it_saves(cells: Mapping[tuple[str, str], Cell], scenes: list[str], papers: dict[str, dict[str, Any]]) -> str:
    """Why ratios of time here are not the paper's: what a pair of points costs, and what is saved of it."""
    theirs = [1e9 * paper["naive"] / (paper["source_elements"] * paper["target_elements"]) for paper in papers.values()
              if "naive" in paper]
    ours = [nanoseconds(cells.get((scene, "naive"))) for scene in scenes]
    own = [1e9 * cell.time.value / cell.count(WORK) if (cell := cells.get((scene, "adaptive"))) and cell.time.n else np.nan
           for scene in scenes]
    parts = [f"In the paper a pair of points costs NAIVEHDD {span(theirs, 3)} ns, here {span(ours)} ns. A distance, bound or "
             f"node costs the framework {span(own)} ns here, preparation included: to gain time, each must save NAIVEHDD "
             f"{span([a / b for a, b in zip(own, ours)])} pairs."]
    for slow in [slow for slow, fast in RATIOS if fast == "adaptive"]:
        saved = [[ratio_of(cells, scene, (slow, "adaptive"), what).value for scene in scenes]
                 for what in ("distances", "distances, bounds and nodes", "")]
        if np.isfinite(saved).any():
            parts.append(f"{style.look(slow).title} computes {span(saved[0])} times the distances of the framework, does "
                         f"{span(saved[1])} times its distances, bounds and nodes, and takes {span(saved[2])} times its time.")
    return " ".join(parts)


def paper_ratio(paper: dict[str, Any], slow: str, fast: str) -> str:
    return tables.number(paper[slow] / paper[fast]) if slow in paper and fast in paper else tables.NOTHING


def make(results: Results) -> Report:
    cases, printed = results.cases, paper_numbers(STEM)
    papers = {row["scene"]: row for row in printed["row"]}
    scenes = sorted(results.in_order("scene"), key=lambda s: list(papers).index(s) if s in papers else len(papers))
    labels = style.order(zip(cases.solver, cases.label))
    labels = ([(name, name) for name in COLUMNS]
              + [pair for pair in labels if not (pair[0] == pair[1] and pair[0] in COLUMNS)])
    cells = {(scene, label): Cell(results, [int(r) for r in rows]) for scene in scenes for _, label in labels
             if len(rows := results.rows(scene=scene, label=label))}

    unit, scale = tables.time_unit(cell.time.value for cell in cells.values())
    table = tables.Table(
        f"{clock_title(results)} to prepare and solve, {unit}, of exact directed Hausdorff "
        "distances between point sets, measured here and as printed in Table 3 of Zhang et al. 2017; and the work counted.",
        ["scene", "", "|A| / |B|", *[style.look(*pair).title for pair in labels],
         *[ratio_title(*pair) for pair in RATIOS]], left=2)
    records: list[tables.Record] = []
    for scene in scenes:
        paper, first = papers.get(scene, {}), int(results.rows(scene=scene)[0])
        own = [cells.get((scene, label)) for _, label in labels]
        ratios = [ratio_of(cells, scene, pair) for pair in RATIOS]
        table.rules.add(len(table.rows))
        table.rows.append([style.scene_title(scene), "here",
                           f"{cases.source_elements[first]:,} / {cases.target_elements[first]:,}",
                           *[cell.text(scale) if cell else tables.NOTHING for cell in own], *map(tables.ratio, ratios)])
        for what, names in MEASURES.items():
            table.rows.append(["", what, "", *[count_text(cell, names) for cell in own],
                               *[tables.ratio(ratio_of(cells, scene, pair, what)) for pair in RATIOS]])
        table.rows.append(["", "ns a distance", "", *[tables.number(nanoseconds(cell)) for cell in own],
                           *[tables.NOTHING] * len(RATIOS)])
        if paper:
            table.rows.append(["", "paper", f"{paper['source_elements']:,} / {paper['target_elements']:,}",
                               *[f"{paper[label] * scale:.6g}" if label in paper else tables.NOTHING
                                 for _, label in labels],
                               *[paper_ratio(paper, *pair) for pair in RATIOS]])
        if cases.scene_note[first]:
            table.notes.append(f"{style.scene_title(scene)}: {cases.scene_note[first]}")
        for (solver, label), cell in zip(labels, own):
            if cell:
                records.append({"scene": scene, "solver": solver, "label": label,
                                "source_elements": int(cases.source_elements[first]),
                                "target_elements": int(cases.target_elements[first]),
                                "status": cell.status(),
                                "n": cell.time.n, "median_seconds": cell.time.value, "low_seconds": cell.time.low,
                                "high_seconds": cell.time.high, "coverage": cell.time.coverage,
                                "prepare_seconds": cell.prepare, "peak_bytes": cell.peak,
                                "wall_median_seconds": cell.wall.value,
                                "paper_seconds": float(paper.get(label, np.nan)), "lower": cell.interval.lower,
                                "upper": cell.interval.upper, **cell.counters})
    table.notes = [*[claim(cells, scenes, slow).line() for slow, fast in RATIOS if fast == "adaptive"],
                   what_it_saves(cells, scenes, papers), *table.notes]
    table.notes += [tables.coverage_note(cell.time for cell in cells.values())
                    + " Where a solver was run with several seeds, n counts them, each by its median. Preparation "
                    "(trees) is included, loading is not. " + clock_note(results),
                    "Distances, bounds and nodes are counted by the solvers (the k-d tree counts distances alone); the "
                    "counts of solvers with seeds are medians.",
                    f"Here: {machine_line(results)}. Paper: {printed['machine']}.",
                    "A dash: not part of the experiment, or not in the paper."]
    return Report(lambda: draw(scenes, labels, cells, papers, f"here, {results.meta.get('profile', '')} sizes", clock_word(results)), table, records)


def count_text(cell: Cell | None, names: tuple[str, ...]) -> str:
    count = cell.count(names) if cell else np.nan
    return tables.NOTHING if np.isnan(count) else f"{count:,.0f}"


def draw(scenes: list[str], labels: list[tuple[str, str]], cells: dict[tuple[str, str], Cell],
         papers: dict[str, dict[str, Any]], here: str, clock: str) -> Any:
    """One band a scene, one line a solver in it: filled = here, open = the paper, bar = interval of the median."""
    present = [pair for pair in labels if any((scene, pair[1]) in cells for scene in scenes)]
    pitch = len(present) + 1.0
    figure, ax = plt.subplots(figsize=(style.SINGLE_COLUMN, 0.75 + 0.098 * pitch * len(scenes)))
    known = [x for cell in cells.values() if cell.time.n for x in (cell.time.value, cell.time.low, cell.time.high)]
    known += [papers[s][label] for s in scenes if s in papers for _, label in present if label in papers[s]]
    known = [x for x in known if np.isfinite(x) and x > 0] or [1.0]
    ax.set_xscale("log")
    ax.set_xlim(min(known) / 2, max(known) * 2)
    for i, scene in enumerate(scenes):
        if i % 2:
            ax.axhspan(i * pitch - 1, (i + 1) * pitch - 1, color="#F5F5F5", linewidth=0, zorder=0)
        for j, (solver, label) in enumerate(present):
            y, looks, cell = i * pitch + j, style.look(solver, label), cells.get((scene, label))
            printed = papers.get(scene, {}).get(label)
            if printed and cell and cell.time.n:
                ax.plot([printed, cell.time.value], [y, y], color=looks.colour, linewidth=0.5, alpha=0.6, zorder=1)
            if printed:
                ax.plot(printed, y, **style.open_marker(looks))
            if cell and cell.time.n:
                if cell.time.has_interval:
                    ax.plot([cell.time.low, cell.time.high], [y, y], color=looks.colour, linewidth=1.6, zorder=2)
                ax.plot(cell.time.value, y, **style.filled_marker(looks))
            elif cell:
                # On the side where the paper's mark is not.
                right = bool(printed) and printed**2 < min(known) * max(known)
                ax.text(0.985 if right else 0.015, y, f"{looks.title}: {cell.text(1)}", fontsize=6, color="#333333",
                        transform=ax.get_yaxis_transform(), ha="right" if right else "left", va="center")
    ax.set_ylim(len(scenes) * pitch - 1, -1)
    ax.set_yticks([i * pitch + (len(present) - 1) / 2 for i in range(len(scenes))], map(style.scene_title, scenes))
    ax.tick_params(axis="y", length=0)
    ax.grid(False, axis="y")
    ax.set_xlabel(f"{clock} to prepare and solve (s)")
    grey = style.Look("", style.GREY, "o")
    style.legend_above(figure, [*style.handles(present, lines=False),
                                plt.Line2D([], [], label=here, **style.filled_marker(grey)),
                                plt.Line2D([], [], label="the paper", **style.open_marker(grey))])
    return figure


if __name__ == "__main__":
    sys.exit(command.main(STEM, make))
