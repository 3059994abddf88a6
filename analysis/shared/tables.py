"""A table: captions, cells, notes and verdicts; and its Markdown."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from analysis.shared.estimates import Estimate
from analysis.shared.verdicts import Verdict

Record = dict[str, object]


@dataclass
class Table:
    """A table to print, with notes and verdicts below it. The rows in `rules` begin a new group,
    set off by some space."""

    caption: str
    header: Sequence[str]
    rows: list[list[str]] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    verdicts: Sequence[Verdict] = ()
    left: int = 1  # the first columns, aligned left; the others hold numbers
    rules: set[int] = field(default_factory=set)
    parts: Sequence[
        int
    ] = ()  # columns at which LaTeX may split a table that is too wide; see table_width.layout()

    def lines_below(self) -> list[str]:
        """Returns the lines below the table: verdicts, then notes."""
        return [*[verdict.line() for verdict in self.verdicts], *self.notes]


def coverage_note(estimates: Iterable[Estimate]) -> str:
    """Returns the note that explains the intervals in brackets, with the number of rounds."""
    measured = [x for x in estimates if x.n]
    if not measured:
        return "No times."
    counts = sorted({x.n for x in measured})
    least = min((x.coverage for x in measured if x.has_interval), default=0.0)
    n = f"n = {counts[0]}" if len(counts) == 1 else f"n = {counts[0]} to {counts[-1]}"
    if counts[-1] == 1:
        return f"Single times ({n}): no interval."
    percent = (
        "at least 95 %"
        if least >= 0.95
        else f"at least 95 % if n allows, otherwise at least {math.floor(least * 100)} %"
    )
    return (
        f"Medians of {n} rounds (fresh processes; repeats within one count once), "
        f"with order-statistic intervals in brackets ({percent})."
    )


def seconds(x: Estimate) -> Record:
    """Returns the CSV fields of a time in seconds."""
    return {"n": x.n, "median_seconds": x.value, "low_seconds": x.low, "high_seconds": x.high}


def markdown(table: Table) -> str:
    """Returns the table in Markdown: caption, cells, then claims and notes, each under a
    heading."""

    def line(cells: Sequence[str]) -> str:
        return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"

    marks = ["---" if i < table.left else "---:" for i in range(len(table.header))]
    parts = [
        f"**{table.caption}**",
        "",
        line(table.header),
        "|" + "|".join(marks) + "|",
        *map(line, table.rows),
        "",
    ]
    for heading, lines in (
        ("Claims", [verdict.line() for verdict in table.verdicts]),
        ("Notes", table.notes),
    ):
        parts += [f"### {heading}", "", *[f"- {line}" for line in lines], ""] if lines else []
    return "\n".join(parts)
