"""Tables 2 and 3 of Sacht and Jacobson 2024 have one form: pairs of meshes, the time of each solver, ratios of them."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Final

from analysis.shared import style, tables
from analysis.shared.cells import MEASURES, Cell, compare, compare_work
from analysis.shared.load import paper_numbers
from analysis.shared.notes import clock_note, clock_title, clock_word, machine_line, scene_notes
from analysis.shared.report import Report
from analysis.shared.results import Results
from analysis.shared.statistics import NO_DATA, Estimate
from analysis.shared.verdicts import Verdict, above_one, everywhere
from analysis.zhang2017.zhang2017_table3 import count_text, draw

PRINTED: Final = ("kang", "zheng", "sacht")  # whose times the paper prints
RATIOS: Final = (("zheng", "kang"), ("kang", "sacht"), ("zheng", "sacht"), ("cgal", "sacht"))
SECOND: Final = {"ms": 1e-3}
Ratio = tuple[str, str]  # of the first label's time, or work, to the second's


class Pairs:
    """All pairs of a result file, and what they give for each label."""

    def __init__(self, results: Results, stem: str) -> None:
        self.results, self.printed = results, paper_numbers(stem)
        unit = SECOND[self.printed["unit"]]
        self.papers: dict[str, dict[str, Any]] = {
            row["scene"]: {**row, **{label: row[label] * unit for label in PRINTED}} for row in self.printed["row"]}
        cases = results.cases
        self.scenes: list[str] = results.in_order("scene")
        self.labels = style.order(zip(cases.solver, cases.label))
        self.cells = {(scene, label): Cell(results, [int(row) for row in rows]) for scene in self.scenes
                      for _, label in self.labels if len(rows := results.rows(scene=scene, label=label))}

    def first(self, scene: str) -> int:
        return int(self.results.rows(scene=scene)[0])

    def ratio(self, scene: str, pair: Ratio, what: str = "") -> Estimate:
        """Of times, or of what is named in MEASURES."""
        slow, fast = (self.cells.get((scene, label)) for label in pair)
        if not slow or not fast:
            return NO_DATA
        return compare_work(slow, fast, MEASURES[what]) if what else compare(slow, fast)

    def less(self, claim: str, pair: Ratio, scenes: Sequence[str]) -> Verdict:
        """A claim that pair[1] takes less than pair[0] on all of these pairs, in time and in counted work."""
        found = {what: everywhere(claim, [self.ratio(scene, pair, what) for scene in scenes]) for what in ("", *MEASURES)}
        return found.pop("").with_counts(found)

    def less_on(self, claim: str, pair: Ratio, scene: str) -> Verdict:
        """The same on one pair of meshes."""
        found = {what: above_one(claim, self.ratio(scene, pair, what)) for what in ("", *MEASURES)}
        return found.pop("").with_counts(found)

    def distance(self, scene: str) -> float:
        """h(A, B) as a share of the diagonal of A: the middle of what is proven."""
        low, high = self.results.reference(scene)
        return 0.5 * (low + high) / float(self.results.cases.source_diagonal[self.first(scene)])


def percent(share: float) -> str:
    """A share in percent; tiny ones, such as what rounding leaves of zero, with their power of ten."""
    return tables.number(100 * share)


@dataclass(frozen=True)
class Spec:
    stem: str
    what: str  # for the caption
    verdicts: Callable[[Pairs], list[Verdict]]
    notes: Sequence[str] = ()
    ratios: Sequence[Ratio] = RATIOS


def title(pair: Ratio) -> str:
    return " / ".join(style.look(label).title for label in pair)


def make(spec: Spec, results: Results) -> Report:
    pairs = Pairs(results, spec.stem)
    unit, scale = tables.time_unit(cell.time.value for cell in pairs.cells.values())
    table = tables.Table(f"{clock_title(results)} to prepare and solve, {unit}: {spec.what}, measured here and as printed in "
                         f"{pairs.printed['table'].split(';')[0]} of Sacht and Jacobson 2024; and the work counted.",
                         ["pair", "", "|A| / |B|", "h / diagonal, %", *[style.look(*label).title for label in pairs.labels],
                          *map(title, spec.ratios)], left=2)
    for scene in pairs.scenes:
        table.rules.add(len(table.rows))
        table.rows += rows_of(pairs, spec.ratios, scene, scale)
    table.notes = [*[verdict.line() for verdict in spec.verdicts(pairs)], *spec.notes, *scene_notes(results),
                   tables.coverage_note(cell.time for cell in pairs.cells.values()) + " Preparation is included, loading is not. "
                   + clock_note(results),
                   "Ratios are paired by round. Distances, bounds and nodes are counted by the solvers, and the same on every machine; CGAL "
                   "counts nothing.",
                   f"Tolerance {', '.join(f'{t:g}' for t in results.in_order('tolerance'))} of the diagonal of A.",
                   f"Paper: {pairs.printed['what']}; {pairs.printed['machine']}: of another machine, and of its authors' programs.",
                   f"Here: {machine_line(results)}.", "A dash: not part of the experiment, or not in the paper."]
    return Report(lambda: draw(pairs.scenes, pairs.labels, pairs.cells, pairs.papers, f"here, {results.meta.get('profile', '')} sizes", clock_word(results)), table, records(pairs))


def rows_of(pairs: Pairs, ratios: Sequence[Ratio], scene: str, scale: float) -> list[list[str]]:
    """Times, counted work, and what the paper prints."""
    cases, first, paper = pairs.results.cases, pairs.first(scene), pairs.papers.get(scene, {})
    own = [pairs.cells.get((scene, label)) for _, label in pairs.labels]
    rows = [[style.scene_title(scene), "here", f"{cases.source_elements[first]:,} / {cases.target_elements[first]:,}",
             percent(pairs.distance(scene)), *[cell.text(scale) if cell else tables.NOTHING for cell in own],
             *[tables.ratio(pairs.ratio(scene, ratio)) for ratio in ratios]]]
    for what, names in MEASURES.items():
        rows.append(["", what, "", "", *[count_text(cell, names) for cell in own],
                     *[tables.ratio(pairs.ratio(scene, ratio, what)) for ratio in ratios]])
    if paper:
        sizes = (f"{paper['source_elements']:,} / {paper['target_elements']:,}" if "source_elements" in paper else tables.NOTHING)
        rows.append(["", "paper", sizes, tables.NOTHING,
                     *[f"{paper[label] * scale:.6g}" if label in paper else tables.NOTHING for _, label in pairs.labels],
                     *[tables.number(paper[a] / paper[b]) if a in paper and b in paper else tables.NOTHING for a, b in ratios]])
    return rows


def records(pairs: Pairs) -> list[tables.Record]:
    cases, found = pairs.results.cases, list[tables.Record]()
    for (scene, label), cell in pairs.cells.items():
        first = pairs.first(scene)
        found.append({"scene": scene, "label": label, "source_elements": int(cases.source_elements[first]),
                      "target_elements": int(cases.target_elements[first]), "distance_of_diagonal": pairs.distance(scene),
                      "status": cell.status(), "n": cell.time.n, "median_seconds": cell.time.value, "low_seconds": cell.time.low,
                      "high_seconds": cell.time.high, "prepare_seconds": cell.prepare, "peak_bytes": cell.peak,
                      "paper_seconds": float(pairs.papers.get(scene, {}).get(label, math.nan)), **cell.counters})
    return found
