"""Table 3 of Zhang et al. 2017: time to compute the exact distance of six pairs of point sets, beside the paper's."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np

from analysis import command, style, tables
from analysis.cells import Cell, compare
from analysis.load import Results, machine_line, paper_numbers
from analysis.statistics import NO_DATA, Estimate, median
from analysis.verdicts import everywhere

STEM = "zhang2017_table3"
COLUMNS = ("naive", "inc", "earlybreak", "adaptive")  # the paper's four
RATIOS = (("naive", "earlybreak"), ("naive", "adaptive"), ("inc", "adaptive"), ("earlybreak", "adaptive"))


def ratio_title(slow: str, fast: str) -> str:
    return f"{style.look(slow).title} / {style.look(fast).title}".replace("NOHD/OHD ", "")


def paper_ratio(paper: dict[str, Any], slow: str, fast: str) -> str:
    return tables.number(paper[slow] / paper[fast]) if slow in paper and fast in paper else tables.NOTHING


def make(results: Results, out: Path) -> list[Path]:
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
        f"CPU time to prepare and solve, {unit}, of exact directed Hausdorff distances between point sets, measured here "
        "and as printed in Table 3 of Zhang et al. 2017.",
        ["scene", "", "|A| / |B|", *[style.look(*pair).title for pair in labels],
         *[ratio_title(*pair) for pair in RATIOS]], left=2)
    records: list[tables.Record] = []
    speedups: dict[tuple[str, str], list[Estimate]] = {pair: [] for pair in RATIOS}
    for scene in scenes:
        paper, first = papers.get(scene, {}), int(results.rows(scene=scene)[0])
        own = [cells.get((scene, label)) for _, label in labels]
        ratios = [compare(results, cells[scene, slow], cells[scene, fast])
                  if (scene, slow) in cells and (scene, fast) in cells else NO_DATA for slow, fast in RATIOS]
        for pair, value in zip(RATIOS, ratios):
            speedups[pair].append(value)
        table.rules.add(len(table.rows))
        table.rows.append([style.scene_title(scene), "here",
                           f"{cases.source_elements[first]:,} / {cases.target_elements[first]:,}",
                           *[cell.text(scale) if cell else tables.NOTHING for cell in own], *map(tables.ratio, ratios)])
        if paper:
            table.rows.append(["", "paper", f"{paper['source_elements']:,} / {paper['target_elements']:,}",
                               *[f"{paper[label] * scale:.6g}" if label in paper else tables.NOTHING
                                 for _, label in labels],
                               *[paper_ratio(paper, *pair) for pair in RATIOS]])
        if cases.scene_note[first]:
            table.notes.append(f"{style.scene_title(scene)}: {cases.scene_note[first]}")
        for (solver, label), cell in zip(labels, own):
            if cell:
                wall = median(cell.wall)
                records.append({"scene": scene, "solver": solver, "label": label,
                                "source_elements": int(cases.source_elements[first]),
                                "target_elements": int(cases.target_elements[first]),
                                "status": cell.status(),
                                "n": cell.time.n, "median_seconds": cell.time.value, "low_seconds": cell.time.low,
                                "high_seconds": cell.time.high, "coverage": cell.time.coverage,
                                "prepare_seconds": cell.prepare, "peak_bytes": cell.peak,
                                "wall_median_seconds": wall.value,
                                "paper_seconds": float(paper.get(label, np.nan)), "lower": cell.interval.lower,
                                "upper": cell.interval.upper, **cell.counters})
    claims = [everywhere(f"the framework takes less time than {style.look(slow).title}", speedups[slow, fast])
              for slow, fast in RATIOS if fast == "adaptive"]
    table.notes = [claim.line() for claim in claims] + table.notes
    table.notes += [tables.coverage_note(cell.time for cell in cells.values())
                    + " Where a solver was run with several seeds, n counts them, each by its median. Preparation "
                    "(trees) is included, loading is not.",
                    f"Here: {machine_line(results)}. Paper: {printed['machine']}.",
                    "A dash: not part of the experiment, or not in the paper."]
    figure = draw(scenes, labels, cells, papers, f"here, {results.meta.get('profile', '')} sizes")
    return tables.save(table, records, out, STEM) + style.save(figure, out, STEM, table.caption)


def draw(scenes: list[str], labels: list[tuple[str, str]], cells: dict[tuple[str, str], Cell],
         papers: dict[str, dict[str, Any]], here: str) -> Any:
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
    ax.set_xlabel("CPU time to prepare and solve (s)")
    grey = style.Look("", style.GREY, "o")
    style.legend_above(figure, [*style.handles(present, lines=False),
                                plt.Line2D([], [], label=here, **style.filled_marker(grey)),
                                plt.Line2D([], [], label="the paper", **style.open_marker(grey))])
    return figure


if __name__ == "__main__":
    sys.exit(command.main(STEM, make))
