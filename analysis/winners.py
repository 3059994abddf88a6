"""README's table of where solvers win, from the tables in results/reference/. `python3 -m analysis.winners`
writes it between two marks in README.md; analysis.paper_profile does so whenever it writes those tables.

A solver wins a scene where its interval lies below the interval of every other. Nobody wins where a solver has a single time,
which has no interval, or where the note of the table promises less than 95 % for its intervals; a line below the table says how
many scenes that are.
"""

from __future__ import annotations

import math
import re
import sys
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from analysis.shared import style, tables
from analysis.shared.load import REFERENCE
from analysis.shared.notes import APART

README: Final = REFERENCE.parent.parent / "README.md"
BEGIN: Final = "<!-- written by analysis/winners.py: begin -->"
END: Final = "<!-- written by analysis/winners.py: end -->"
SURE: Final = re.compile(r"intervals in brackets \((at least )?95 %\)")  # older kept tables say "(95 %)"
# File, stem, how its rows of times are marked and in which column, and what it is called.
RACES: Final = (("zhang2017_paper_profile.md", "zhang2017_table3", "here", 1, "pairs of Table 3"),
                ("points_speed.md", "points_speed", "ms", 1, "workloads of 100K and 1M points"),
                ("mesh_peers.md", "mesh_peers", "ms", 3, "pairs of real meshes"))
SOURCES: Final = tuple(dict.fromkeys(file for file, *_ in RACES))


@dataclass
class Section:
    """A stem in a file of tables."""

    header: list[str] = field(default_factory=list)
    rows: list[list[str]] = field(default_factory=list)
    sure: bool = False  # its intervals are of 95 %, as tables.coverage_note says
    apart: bool = False  # rows were run beside others, so nobody wins


def sections(text: str) -> dict[str, Section]:
    found: dict[str, Section] = {}
    section = Section()
    for line in text.splitlines():
        if line.startswith("## "):
            section = found.setdefault(line[3:].strip(), Section())
        elif line.startswith("| "):
            cells = [cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]]
            if section.header:
                section.rows.append(cells)
            else:
                section.header = cells
        elif SURE.search(line):
            section.sure = True
        section.apart |= APART in line
    return found


def interval(text: str) -> tuple[float, float, float] | None:
    """Of '2.00 [1.93, 2.08]': 2, 1.93, 2.08. Of '80.0', whose ends are unknown: 80, NaN, NaN. None for 'timeout' and the like."""
    digits = r"(\d[\d.]*(?:e[-+]?\d+)?)"  # as tables.number writes them
    match = re.match(rf"{digits}(?: \[{digits}, {digits}\])?$", text)
    if not match:
        return None
    return float(match[1]), float(match[2] or math.nan), float(match[3] or math.nan)


def name_of(title: str) -> str:
    names = {look.title: name for name, look in style.LOOKS.items()}
    return f"`{names[title]}`" if title in names else title


@dataclass
class Race:
    """The scenes of a table."""

    scenes: int = 0
    won: dict[str, list[float]] = field(default_factory=dict)  # by winner: of each scene how many times over the next best
    unjudged: int = 0  # scenes in which nobody can win
    unknown: list[str] = field(default_factory=list)  # what has single times in them
    least: dict[str, int] = field(default_factory=dict)  # in how many of them this interval lies below all else


def race(section: Section, mark: str, column: int) -> Race:
    titles = {i: title for i, title in enumerate(section.header)
              if title in {look.title for look in style.LOOKS.values()} | set(style.PROGRAMS.values())}
    rows = [row for row in section.rows if len(row) > column and row[column] == mark]
    found = Race(len(rows))
    for row in rows:
        known = sorted((x, titles[i]) for i in titles if (x := interval(row[i])))
        if len(known) < 2:
            continue
        single = [title for x, title in known if math.isnan(x[1])]
        best, winner = known[0][0], name_of(known[0][1])
        judged = section.sure and not single and not section.apart
        if not judged:
            found.unknown += [title for title in single if title not in found.unknown]
            found.unjudged += 1
        if not best[2] < min(x[0] if math.isnan(x[1]) else x[1] for x, _ in known[1:]):
            continue
        if judged:
            found.won.setdefault(winner, []).append(known[1][0][0] / best[0])
        elif section.sure and not section.apart:
            found.least[winner] = found.least.get(winner, 0) + 1
    return found


def victories(found: dict[str, Section]) -> dict[str, list[str]]:
    texts: dict[str, list[str]] = {}
    for _, stem, mark, column, what in RACES:
        if stem not in found:
            continue
        seen = race(found[stem], mark, column)
        for solver, factors in seen.won.items():
            low, high = tables.number(min(factors), 2), tables.number(max(factors), 2)
            texts.setdefault(solver, []).append(f"{len(factors)} of the {seen.scenes} {what}, {low if low == high else f'{low} to {high}'}"
                                                " times over the next best")
    return texts


def unjudged(found: dict[str, Section]) -> list[str]:
    """Why scenes have no winner, one line a table."""
    lines = []
    for _, stem, mark, column, what in RACES:
        seen = race(found[stem], mark, column) if stem in found else Race()
        if not seen.unjudged:
            continue
        why = (f"{' and '.join(seen.unknown)} {'have' if len(seen.unknown) > 1 else 'has'} single times there, without an interval"
               if seen.unknown else "their intervals are of less than 95 %")
        least = "".join(f"; the interval of {solver} lies below all intervals and single times in {count} of them"
                        for solver, count in seen.least.items())
        lines.append(f"No winner in {seen.unjudged} of the {seen.scenes} {what}: {why}{least}.")
    return lines


def table(folder: Path = REFERENCE) -> str:
    found: dict[str, Section] = {}
    for name in SOURCES:
        found |= sections((folder / name).read_text(encoding="utf-8"))
    won = victories(found)
    stated = ", ".join(f"[{what}](results/reference/{file})" for file, *_, what in RACES)
    lines = [f"From the kept tables: {stated}.", "", "| solver | fastest on |", "| --- | --- |", *[f"| {solver} | {'; '.join(won[solver])} |" for solver in won]]
    return "\n".join(lines + [line for note in unjudged(found) for line in ("", note)])


def rewritten(readme: str, text: str) -> str:
    before, begin, rest = readme.partition(BEGIN)
    _, end, after = rest.partition(END)
    if not begin or not end:
        raise ValueError(f"README.md: the marks '{BEGIN}' and '{END}' are missing: put them where the table belongs")
    return f"{before}{begin}\n{text}\n{end}{after}"


def write(folder: Path = REFERENCE, readme: Path = README) -> Path:
    tables.write_whole(readme, rewritten(readme.read_text(encoding="utf-8"), table(folder)))
    return readme


def main(arguments: Sequence[str] = ()) -> int:
    try:
        print(write())
    except (OSError, ValueError) as problem:
        print(problem, file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
