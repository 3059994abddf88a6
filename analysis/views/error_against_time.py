"""Kind `error-against-time`: for each scene, the gap and the true error beside the time."""

from __future__ import annotations

from dataclasses import replace

from analysis.shared.report import Report
from analysis.shared.results import Results
from analysis.speed import error_vs_time


def make(results: Results) -> Report | None:
    if not any(results.is_bounded(case) and results.first_by_round(case) for case in range(len(results.cases))):
        return None
    report = error_vs_time.make(results)
    if report.table is None:
        return report
    title = str(results.meta.get("title") or results.stem)
    return replace(report, table=replace(report.table, caption=f"{title}: {report.table.caption}", verdicts=[]))
