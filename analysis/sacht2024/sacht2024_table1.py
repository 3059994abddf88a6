"""Table 1 of Sacht and Jacobson 2024: the near-zero pairs of meshes of the paper, and the pairs
that replace them here."""

from __future__ import annotations

from typing import Any

import matplotlib.pyplot as plt
from matplotlib.lines import Line2D

from analysis.sacht2024.sacht_pairs import named, percent
from analysis.shared import numerals, shapes, style, tables
from analysis.shared.load import paper_numbers
from analysis.shared.notes import machine_line, scene_notes
from analysis.shared.report import NO_TIMES, Report
from analysis.shared.results import ResultError, Results


def topology(results: Results, model: str) -> str:
    """Returns 'closed' or 'open', and whether the mesh is a manifold; a dash if the model is
    missing."""
    try:
        mesh = shapes.mesh(results, model)
    except ResultError:
        return numerals.NOTHING
    return ("closed" if mesh.closed else "open") + ("" if mesh.manifold else ", not a manifold")


def share(results: Results, scene: str, quantity: str) -> float:
    """Returns the distance over the diagonal of A: the middle of its certified interval."""
    rows = results.rows(scene=scene, quantity=quantity)
    return results.share(rows[0]) if rows else float("nan")


def make(results: Results) -> Report:
    cases, printed = results.cases, paper_numbers("sacht2024_table2")
    papers = {row["scene"]: row for row in printed["row"]}
    table = tables.Table(
        "Near-zero pairs of meshes: numbers of triangles here and as printed in Table 1 of Sacht and Jacobson 2024, and their distances "
        "here, in percent of the diagonal of A.",
        [
            "pair",
            "A",
            "B",
            "A is",
            "B is",
            "|A|",
            "|B|",
            "paper: |A|",
            "paper: |B|",
            "diagonal of A",
            "h(A, B), %",
            "H(A, B), %",
        ],
        left=5,
    )
    records: list[tables.Record] = []
    for scene in results.scenes:
        row, paper = results.rows(scene=scene)[0], papers.get(scene, {})
        models = [str(column[row]) for column in (cases.source, cases.target)]
        shapes = [topology(results, model) for model in models]
        sizes = [int(column[row]) for column in (cases.source_elements, cases.target_elements)]
        paper_sizes = [
            int(paper[key]) if key in paper else -1
            for key in ("source_elements", "target_elements")
        ]
        distances = [share(results, scene, quantity) for quantity in ("directed", "symmetric")]
        size_texts = [f"{n:,}" for n in sizes]
        paper_size_texts = [f"{n:,}" if n >= 0 else numerals.NOTHING for n in paper_sizes]
        table.rows.append(
            [
                named(scene),
                *models,
                *shapes,
                *size_texts,
                *paper_size_texts,
                numerals.number(float(cases.source_diagonal[row])),
                *map(percent, distances),
            ]
        )
        records.append(
            {
                "scene": scene,
                "source": models[0],
                "target": models[1],
                "source_is": shapes[0],
                "target_is": shapes[1],
                "source_elements": sizes[0],
                "target_elements": sizes[1],
                "paper_source_elements": paper_sizes[0],
                "paper_target_elements": paper_sizes[1],
                "source_diagonal": float(cases.source_diagonal[row]),
                "directed_share": distances[0],
                "symmetric_share": distances[1],
            }
        )
    table.notes = [
        "None of the models is the paper's: all are stand-ins or derived, as the notes on the pairs say. The paper prints neither diagonals nor "
        "distances.",
        "Closed: no edge belongs to only one triangle. A manifold: no edge belongs to more than two. Corners at the same place count as one.",
        *scene_notes(results),
        f"Here: {machine_line(results)}.",
        "A dash: not in the paper, or not measured.",
    ]
    caption = (
        "Distances of the near-zero pairs (Table 1 of Sacht and Jacobson 2024), stand-ins for the models of the paper and derived pairs: in percent "
        "of the diagonal of A, against the number of triangles. The paper prints no distances."
    )
    return Report(lambda: draw(results, papers), table, records, clock=NO_TIMES, caption=caption)


def draw(results: Results, papers: dict[str, dict[str, Any]]) -> Any:
    """Draws the distance of each pair against its triangles, with a line at 0.1 %."""
    figure, ax = plt.subplots(figsize=(style.SINGLE_COLUMN, 2.6))
    cases = results.cases
    for scene in results.scenes:
        row = results.rows(scene=scene)[0]
        x = float(cases.source_elements[row] + cases.target_elements[row])
        looks = style.look("sacht" if scene in papers else "zheng")
        for quantity, fill in (("symmetric", style.open_marker), ("directed", style.filled_marker)):
            value = share(results, scene, quantity)
            if value > 0:
                ax.plot(
                    x,
                    100 * value,
                    **(fill(looks) | ({"markersize": 7.5} if quantity == "symmetric" else {})),
                )
        if (least := share(results, scene, "directed")) > 0:
            ax.annotate(
                named(scene),
                (x, 100 * least),
                xytext=(4, -6),
                textcoords="offset points",
                fontsize=6,
            )
    ax.axhline(0.1, color=style.GREY, linewidth=0.6, linestyle=(0, (2, 2)))
    ax.set(
        xscale="log",
        yscale="log",
        xlabel="triangles, |A| + |B|",
        ylabel="distance, % of the diagonal of A",
    )
    ax.margins(x=0.25, y=0.15)
    entries = [
        style.filled_entry("stands in", style.look("sacht")),
        style.filled_entry("derived", style.look("zheng")),
        style.filled_entry("filled: h(A, B)"),
        style.open_entry("open: H(A, B)"),
        Line2D([], [], color=style.GREY, linewidth=0.6, linestyle=(0, (2, 2)), label="0.1 %"),
    ]
    style.legend_above(figure, entries, columns=2)
    return figure
