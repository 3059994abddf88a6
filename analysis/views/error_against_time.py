"""Kind `error-against-time`: for each scene, the gap and the true error against time."""

from __future__ import annotations

from dataclasses import replace

from analysis.shared import style
from analysis.shared.report import Report
from analysis.shared.results import Results
from analysis.speed import error_vs_time


def make(results: Results) -> Report | None:
    if not any(
        results.is_bounded(case) and results.first_by_round(case)
        for case in range(len(results.cases))
    ):
        return None
    report = error_vs_time.make(results)
    if report.table is None:
        return report
    title, lengths = str(results.meta.get("title") or results.stem), lengths_line(results)
    table = replace(
        report.table,
        caption=f"{title}: {report.table.caption}",
        verdicts=[],
        notes=[*report.table.notes, *[f"{lengths}."] * bool(lengths)],
    )
    return replace(report, table=table, key=". ".join(filter(None, [report.key, lengths])))


def lengths_line(results: Results) -> str:
    """Returns a note on scenes whose gaps and errors are lengths, because A is a single point;
    empty if there are none."""
    scenes = results.in_order(
        "scene",
        [
            case
            for case in range(len(results.cases))
            if results.cases.source_diagonal[case] == 0 and results.is_bounded(case)
        ],
    )
    return (
        f"Lengths, not fractions, because A is a single point: {', '.join(map(style.scene_title, scenes))}"
        if scenes
        else ""
    )
