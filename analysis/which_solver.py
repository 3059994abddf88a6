"""Shows which certified solver is fastest, and by what factor, for each scene and tolerance.

    python3 -m analysis.which_solver    writes results/figures/which_solver.* and results/tables/which_solver.*

Reads those results of STEMS that exist. Compares the certified solvers that reached the tolerance.
"""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.patches import Rectangle

from analysis.shared import numerals, style, table_files, tables
from analysis.shared.comparable import apart, origins
from analysis.shared.load import each, load_all
from analysis.shared.notes import machine_line
from analysis.shared.report import save_figure
from analysis.shared.results import ResultError, Results
from analysis.shared.estimates import Estimate, ratio_by_round

STEMS: Final = (
    "scaling_points",
    "points_speed",
    "scaling_meshes",
    "mesh_peers",
    "sacht2024_fig13",
    "error_vs_time",
)
DOMAINS: Final = {"points": "Point sets", "mesh": "Meshes", "surface": "Surfaces"}
FINEST: Final = 0.0  # means the finest tolerance of each solver; used for point sets, where most solvers ignore the tolerance
OF: Final = "diagonal"
CAPTION: Final = "The fastest solver whose bounds are proven, by scene and tolerance, and how many times as fast it is as the next best."
HIGHEST: Final = 7.8  # inches: a page has room for the figure and its caption


@dataclass(frozen=True)
class Cell:
    domain: str
    stem: str
    scene: str
    sizes: str
    tolerance: float  # as a fraction of the diagonal of A
    solver: str
    label: str
    rivals: int
    ratio: Estimate | None  # time of the next best / time of the fastest; None: no rival, or not the fastest in each comparison
    separated: bool  # its time is separated from the time of every rival

    @property
    def title(self) -> str:
        return style.title(self.solver, self.label).removesuffix(" (ours)")

    @property
    def text(self) -> str:
        return (
            self.title
            if self.ratio is None or not self.ratio.n
            else f"{self.title} {numerals.number(self.ratio.value, 2)}×"
        )


def cells_of(results: Results) -> list[Cell]:
    """Returns one cell for each scene, in its first pose, and each tolerance that some certified
    solver reached.

    Skips tolerances at which some answer was read off the trace of a finer run, because such an
    answer has no time.
    """
    cases, kinds, cells = (
        results.cases,
        dict(zip(results.models.name, results.models.kind)),
        list[Cell](),
    )
    rows_by_key: dict[tuple[str, float], dict[str, int]] = {}
    untimed: set[tuple[str, float]] = set()
    for row in range(len(cases)):
        domain = str(kinds.get(cases.source[row], ""))
        if (
            cases.status[row] != "ok"
            or cases.certified[row] != 1
            or cases.pose_index[row] != 0
            or kinds.get(cases.target[row]) != domain
            or cases.tolerance_of[row] != OF
            or not takes_part(results, row)
        ):
            continue
        key = (str(cases.scene[row]), FINEST if domain == "points" else float(cases.tolerance[row]))
        if not results.total_by_round(row) or cases.from_trace[row]:
            untimed |= {key} - {(key[0], FINEST)}
            continue
        rows = rows_by_key.setdefault(key, {})
        label = str(cases.label[row])
        if label not in rows or float(cases.tolerance[row]) < float(cases.tolerance[rows[label]]):
            rows[label] = row
    for (scene, tolerance), rows in rows_by_key.items():
        if (scene, tolerance) not in untimed:
            cells.append(
                cell(
                    results,
                    scene,
                    tolerance,
                    rows,
                    str(kinds[cases.source[next(iter(rows.values()))]]),
                )
            )
    return cells


def takes_part(results: Results, row: int) -> bool:
    """Tells whether a row is compared. Of several seeds only the first is.

    A solver that the experiment runs with several values of another parameter is not, because no
    value represents it.
    """
    variant = str(results.cases.variant[row])
    return not variant or (
        variant.startswith("seed=")
        and row
        == min(
            results.rows(
                scene=results.cases.scene[row],
                label=results.cases.label[row],
                tolerance=results.cases.tolerance[row],
            )
        )
    )


def cell(results: Results, scene: str, tolerance: float, rows: dict[str, int], domain: str) -> Cell:
    """Returns the cell for the solver with no ratio (other / solver) below 1.

    As ratios are paired, each solver may be beaten by another; the cell then has the least median
    and no ratio.
    """
    times = {label: results.total_by_round(row) for label, row in rows.items()}
    by_median = sorted(times, key=lambda label: float(np.median(list(times[label].values()))))

    def against(best: str) -> list[Estimate]:
        return [
            apart(origins(results, [rows[best], rows[rival]]))
            or ratio_by_round(times[rival], times[best])
            for rival in times
            if rival != best
        ]

    best = by_median[0]
    for label in by_median:
        if all(not ratio.n or ratio.value >= 1 for ratio in against(label)):
            best = label
            break
    ratios = against(best)
    known_ratios = [ratio for ratio in ratios if ratio.n]
    least = (
        min(known_ratios, key=lambda ratio: ratio.value)
        if known_ratios and len(known_ratios) == len(ratios)
        else None
    )
    return Cell(
        domain,
        results.stem,
        scene,
        results.sizes(rows[best]),
        tolerance,
        str(results.cases.solver[rows[best]]),
        best,
        len(ratios),
        least if least and least.value >= 1 else None,
        bool(known_ratios)
        and all(ratio.n and ratio.separated and ratio.low > 1 for ratio in ratios),
    )


def table(cells: Sequence[Cell], machine: str) -> tables.Table:
    rows = [
        [
            DOMAINS[cell.domain],
            cell.scene,
            cell.sizes,
            "finest" if cell.tolerance == FINEST else f"{cell.tolerance:g}",
            style.title(cell.solver, cell.label),
            numerals.ratio(cell.ratio) if cell.ratio else numerals.NOTHING,
            str(cell.rivals),
            "yes" if cell.separated else "no",
            cell.stem,
        ]
        for cell in cells
    ]
    return tables.Table(
        CAPTION,
        [
            "",
            "scene",
            "|A| / |B|",
            "tolerance",
            "fastest",
            "next best / fastest",
            "rivals",
            "separated from all",
            "stem",
        ],
        rows,
        [
            "Time to prepare and solve once. Rivals: other certified solvers that reached the tolerance within their limits; only the first of "
            "several seeds, and no solver that is swept over another parameter. Tolerances are fractions of the diagonal of A; for point sets, "
            "the finest requested tolerance, which most of their solvers ignore. Tolerances that were read off the trace of a finer run have "
            "no times and no row. For a motion, the first pose.",
            f"Measured on {machine}.",
        ],
        left=5,
    )


@dataclass
class Row:
    """A row of the figure: one scene, or consecutive sizes of a scene with the same winner at the
    same single tolerance."""

    family: str  # name of the scene without its size
    sizes: list[str]  # empty strings for names without a size
    cells: dict[float, list[Cell]]  # by tolerance

    @property
    def title(self) -> str:
        return style.scene_title(self.family) + " ".join(
            ["", *filter(None, [" to ".join(dict.fromkeys([self.sizes[0], self.sizes[-1]]))])]
        )


def rows_of(cells: Sequence[Cell]) -> list[Row]:
    """Merges cells into the rows of the figure, in order."""
    scenes: dict[tuple[str, str], list[Cell]] = {}
    for cell in cells:
        scenes.setdefault((cell.stem, cell.scene), []).append(cell)
    rows: list[Row] = []
    before: object = None
    for (stem, scene), scene_cells in scenes.items():
        match = re.fullmatch(r"(.+)[ _](\d[\dekKM.]*)", scene)
        family, size = (match[1], match[2]) if match else (scene, "")
        key = (
            (stem, family, scene_cells[0].tolerance, scene_cells[0].label)
            if size and len(scene_cells) == 1
            else None
        )
        if key and key == before:
            rows[-1].sizes.append(size)
            rows[-1].cells[scene_cells[0].tolerance] += scene_cells
        else:
            rows.append(Row(family, [size], {cell.tolerance: [cell] for cell in scene_cells}))
        before = key
    return rows


def text_of(cells: Sequence[Cell]) -> str:
    """Returns the fastest solver of these cells and the range of its factors: 'cover 2.2–3.3×'."""
    ratios = sorted(cell.ratio.value for cell in cells if cell.ratio is not None and cell.ratio.n)
    if len(cells) == 1 or len(ratios) < len(cells):
        return cells[0].text if len(cells) == 1 else cells[0].title
    ends = dict.fromkeys([numerals.number(ratios[0], 2), numerals.number(ratios[-1], 2)])
    return f"{cells[0].title} {'–'.join(ends)}×"


def draw(cells: Sequence[Cell]) -> Any:
    """Draws point sets on the left, meshes and surfaces on the right: one row per scene, one column
    per tolerance."""
    domains = {cell.domain for cell in cells}
    present = [domain for domain in DOMAINS if domain in domains]
    blocks: dict[str, list[Row]] = {}
    for domain in present:
        blocks[domain] = rows_of([cell for cell in cells if cell.domain == domain])
    right = [domain for domain in present if domain != "points"]
    tall = max(len(blocks.get("points", ())), sum(len(blocks[domain]) + 2 for domain in right))
    figure = plt.figure(figsize=(style.DOUBLE_COLUMN, min(HIGHEST, 0.175 * tall + 0.9)))
    grid = (
        figure.add_gridspec(1, 2, width_ratios=(0.7, 2.2))
        if right and "points" in present
        else figure.add_gridspec(1, 1)
    )
    if "points" in present:
        draw_block(figure.add_subplot(grid[0]), "points", blocks["points"])
    if right:
        below = grid[-1].subgridspec(
            len(right), 1, height_ratios=[len(blocks[domain]) + 1 for domain in right]
        )
        for row, domain in enumerate(right):
            draw_block(figure.add_subplot(below[row]), domain, blocks[domain])
    return figure


def draw_block(ax: Any, domain: str, rows: Sequence[Row]) -> None:
    tolerances = sorted({tolerance for row in rows for tolerance in row.cells}, reverse=True)
    for y, row in enumerate(rows):
        for tolerance, cells in row.cells.items():
            x, colour, separated = (
                tolerances.index(tolerance),
                style.look(cells[0].solver, cells[0].label).colour,
                all(cell.separated for cell in cells),
            )
            ax.add_patch(Rectangle((x, y), 1, 1, facecolor=colour, alpha=0.3, linewidth=0))
            ax.add_patch(
                Rectangle(
                    (x, y),
                    1,
                    1,
                    facecolor="none",
                    edgecolor="white" if separated else colour,
                    linewidth=0.5,
                    hatch="" if separated else "////",
                )
            )
            ax.text(
                x + 0.5,
                y + 0.52,
                text_of(cells),
                ha="center",
                va="center",
                fontsize=5.5,
                bbox={
                    "boxstyle": "square,pad=0.1",
                    "facecolor": "white",
                    "alpha": 0.6,
                    "linewidth": 0,
                },
            )
    ax.set(xlim=(0, len(tolerances)), ylim=(len(rows), 0), title=DOMAINS[domain])
    ax.set_xticks(
        np.arange(len(tolerances)) + 0.5,
        ["finest" if t == FINEST else f"{t:g}" for t in tolerances],
        fontsize=6,
    )
    ax.set_yticks(np.arange(len(rows)) + 0.5, [row.title for row in rows], fontsize=5.5)
    ax.tick_params(length=0)
    ax.grid(False)
    ax.set_xlabel("tolerance / diagonal of A")


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="analysis.which_solver",
        description="The fastest solver whose bounds are proven, by scene and tolerance.",
    )
    parser.add_argument(
        "--results",
        type=Path,
        default=Path("results"),
        help="folder of the .h5 files (default: results)",
    )
    parser.add_argument(
        "--out", type=Path, help="folder for figures/ and tables/ (default: the results folder)"
    )
    chosen = parser.parse_args(arguments)
    out = chosen.out or chosen.results
    try:
        all_results = load_all(
            path for stem in STEMS if (path := chosen.results / f"{stem}.h5").exists()
        )
    except ResultError as problem:
        print(problem, file=sys.stderr)
        return 2
    cells = [cell for of_stem in each(all_results, cells_of) for cell in of_stem]
    if not cells:
        print(f"which_solver: nothing to draw: {chosen.results} has no times of {', '.join(STEMS)}")
        return 0
    made = table(cells, "; ".join(dict.fromkeys(machine_line(results) for results in all_results)))
    records: list[tables.Record] = [
        {
            "domain": cell.domain,
            "stem": cell.stem,
            "scene": cell.scene,
            "sizes": cell.sizes,
            "tolerance": cell.tolerance,
            "solver": cell.solver,
            "label": cell.label,
            "rivals": cell.rivals,
            "next_best": cell.ratio.value if cell.ratio else float("nan"),
            "low": cell.ratio.low if cell.ratio else float("nan"),
            "high": cell.ratio.high if cell.ratio else float("nan"),
            "separated": int(cell.separated),
        }
        for cell in cells
    ]
    footnote = (
        "n×: the next best takes n times as long to prepare and solve. Hatched: not separated from every other (fewer than six rounds separate "
        "nothing). No number: no other reached the tolerance, or none is ahead. A row of several sizes has the least and the greatest n, and is "
        "hatched if one of them is."
    )
    for path in [
        *table_files.save(made, records, out, "which_solver"),
        *save_figure(draw(cells), out, "which_solver", made.caption, footnote),
    ]:
        print(path)
    return 0


if __name__ == "__main__":
    sys.exit(main())
