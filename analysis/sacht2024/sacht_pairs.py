"""Tables 2 and 3 of Sacht and Jacobson 2024: pairs of meshes, the time of each solver, and the
ratios of times."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Final

from analysis.shared import beside_paper, numerals, style, tables
from analysis.shared.cells import MEASURES, Grid, count_text, in_time_and_work
from analysis.shared.load import paper_numbers
from analysis.shared.notes import machine_line, scene_notes, total_title
from analysis.shared.over_pairs import on_average
from analysis.shared.report import Report
from analysis.shared.results import Results
from analysis.shared.sizes import tests_claims
from analysis.shared.verdicts import Verdict, above_one

PRINTED: Final = ("kang", "zheng", "sacht")  # solvers whose times the paper prints
RATIOS: Final = (("zheng", "kang"), ("kang", "sacht"), ("zheng", "sacht"), ("cgal", "sacht"))
SECOND: Final = {"ms": 1e-3}
Ratio = tuple[str, str]  # two labels: time or work of the first / of the second
STANDS_IN: Final = {
    "crown": "elephant",
    "monster": "bunny",
    "bust": "Snowden",
    "ramesses": "dragon",
}  # our model for each model of the paper


def named(scene: str, between: str = " ") -> str:
    """Returns the title of a scene with the paper's models that ours replace: 'elephant (for
    Crown)'."""
    models = scene.split("_")
    if not set(models) <= STANDS_IN.keys():
        return style.scene_title(scene)
    return f"{', '.join(STANDS_IN[model] for model in models)}{between}(for {', '.join(map(str.capitalize, models))})"


class Pairs(Grid):
    """All pairs of a result file, and the paper's numbers on them."""

    def __init__(self, results: Results) -> None:
        super().__init__(results)
        self.printed = paper_numbers(results.stem)
        unit = SECOND[self.printed["unit"]]
        self.papers: dict[str, dict[str, Any]] = {}
        for row in self.printed["row"]:
            seconds = {label: row[label] * unit for label in PRINTED}
            self.papers[row["scene"]] = {**row, **seconds}

    def less_on(self, claim: str, slow: str, fast: str, scene: str) -> Verdict:
        """Judges the claim that `fast` takes less than `slow` on one pair, in time and in counted
        work."""
        return in_time_and_work(
            lambda measure: above_one(claim, self.ratio(scene, slow, fast, measure))
        )

    def average(
        self,
        claim: str,
        slow: str,
        fast: str,
        bar: float = 1.0,
        scenes: Sequence[str] | None = None,
    ) -> Verdict:
        """Judges the claim that `fast` is `bar` times as fast on average over these pairs, in time
        and in counted work."""
        among = self.scenes if scenes is None else scenes
        return in_time_and_work(
            lambda measure: on_average(
                claim, [self.ratio(scene, slow, fast, measure) for scene in among], bar
            )
        )

    def distance(self, scene: str) -> float:
        return self.results.share(self.first(scene))


def percent(share: float) -> str:
    """Formats a fraction in percent; tiny values, such as a zero with rounding errors, have an
    exponent."""
    return numerals.number(100 * share)


@dataclass(frozen=True)
class Spec:
    subject: str  # for the caption
    verdicts: Callable[[Pairs], list[Verdict]]
    notes: Sequence[str] = ()
    ratios: Sequence[Ratio] = RATIOS


def title(pair: Ratio) -> str:
    return " / ".join(style.title(label) for label in pair)


def make(spec: Spec, results: Results) -> Report:
    pairs = Pairs(results)
    unit, scale = numerals.time_unit(cell.time.value for cell in pairs.cells.values())
    table = tables.Table(
        f"{total_title(results)}, {unit}: {spec.subject}, measured here and as printed in {pairs.printed['table'].split(';')[0]} of Sacht and "
        "Jacobson 2024, with the counted work.",
        ["pair", "", "|A| / |B|", "h / diagonal, %", *pairs.titles(), *map(title, spec.ratios)],
        left=2,
        parts=(2, 4 + len(pairs.titles())),
    )
    for scene in pairs.scenes:
        table.rules.add(len(table.rows))
        table.rows += rows_of(pairs, spec.ratios, scene, scale)
    table.verdicts = spec.verdicts(pairs)
    tolerances = ", ".join(f"{t:g}" for t in results.in_order("tolerance"))
    table.notes = [
        *spec.notes,
        *scene_notes(results),
        tables.coverage_note(cell.time for cell in pairs.cells.values())
        + " Preparation is included, loading is not.",
        "Ratios are paired by round. The solvers count distances, bounds and nodes, which are the same on every machine; CGAL counts nothing.",
        f"Tolerance {tolerances} of the diagonal of A.",
        f"Paper: {pairs.printed['what']}; {pairs.printed['machine']}: measured on another machine, with its authors' programs.",
        f"Here: {machine_line(results)}.",
        "A dash: not part of the experiment, or not in the paper.",
    ]
    beside = " Open: as printed in the paper, on another machine." if tests_claims(results) else ""
    caption = (
        f"{total_title(results)}, s, on {spec.subject}, as in {pairs.printed['table'].split(';')[0]} of Sacht and Jacobson 2024. Filled: the median here, with its "
        f"interval.{beside}"
    )
    return Report(
        lambda: beside_paper.draw(pairs, pairs.papers, lambda _, scene: named(scene, "\n")),
        table,
        records(pairs),
        caption=caption,
    )


def rows_of(pairs: Pairs, ratios: Sequence[Ratio], scene: str, scale: float) -> list[list[str]]:
    """Returns the table rows of a scene: times, counted work, and the paper's times."""
    paper = pairs.papers.get(scene, {})
    rows = [
        [
            named(scene),
            "here",
            pairs.results.sizes(pairs.first(scene)),
            percent(pairs.distance(scene)),
            *pairs.texts(scene, scale),
            *[numerals.ratio(pairs.ratio(scene, *ratio)) for ratio in ratios],
        ]
    ]
    for measure, names in MEASURES.items():
        counts = [count_text(cell, names) for cell in pairs.row(scene)]
        ratio_texts = [numerals.ratio(pairs.ratio(scene, *ratio, measure)) for ratio in ratios]
        rows.append(["", measure, "", "", *counts, *ratio_texts])
    if paper:
        sizes = (
            f"{paper['source_elements']:,} / {paper['target_elements']:,}"
            if "source_elements" in paper
            else numerals.NOTHING
        )
        times = [
            f"{paper[label] * scale:.6g}" if label in paper else numerals.NOTHING
            for _, label in pairs.labels
        ]
        ratio_texts = [
            numerals.number(paper[a] / paper[b]) if a in paper and b in paper else numerals.NOTHING
            for a, b in ratios
        ]
        rows.append(["", "paper", sizes, numerals.NOTHING, *times, *ratio_texts])
    return rows


def records(pairs: Pairs) -> list[tables.Record]:
    cases, rows = pairs.results.cases, list[tables.Record]()
    for (scene, label), cell in pairs.cells.items():
        first = pairs.first(scene)
        rows.append(
            {
                "scene": scene,
                "label": label,
                "source_elements": int(cases.source_elements[first]),
                "target_elements": int(cases.target_elements[first]),
                "distance_of_diagonal": pairs.distance(scene),
                "status": cell.status(),
                **tables.seconds(cell.time),
                "prepare_seconds": cell.prepare,
                "peak_bytes": cell.peak,
                "paper_seconds": float(pairs.papers.get(scene, {}).get(label, math.nan)),
                **cell.counters,
            }
        )
    return rows
