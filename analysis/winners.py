"""README's table of where the point solvers win, from the tables in results/reference/. `python3 -m analysis.winners`
writes it between two marks in README.md; analysis.paper_profile does so whenever it writes those tables.

A solver wins a scene where its interval lies below the interval of every other. Claims are the verdicts of the tables.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from analysis import style, tables
from analysis.load import REFERENCE
from analysis.points_speed import TITLES

README: Final = REFERENCE.parent.parent / "README.md"
BEGIN: Final = "<!-- written by analysis/winners.py: begin -->"
END: Final = "<!-- written by analysis/winners.py: end -->"
SOURCES: Final = ("zhang2017_paper_profile.md", "points_speed.md")
# Stem, how its rows of times are marked in the second column, and what it is called.
RACES: Final = (("zhang2017_table3", "here", "pairs of Table 3"), ("points_speed", "ms", "workloads of 100K and 1M points"))
# Whose a claim is, by a part of its text; the first that matches.
CLAIMS: Final = (("as printed", "`ohd_as_printed`, `nohd_as_printed`"), ("framework", "`adaptive`"), ("INC", "`inc`"),
                 ("EARLYBREAK takes less", "`earlybreak`"), ("(?<!N)OHD (with cells|takes less)|culling", "`ohd`"),
                 ("NOHD", "`nohd`"))
ORDER: Final = ("`scan`", "`earlybreak`", "`ohd`", "`nohd`", "`adaptive`", "`inc`")  # then the others
SKIPPED: Final = ("peaks where", "fastest at", "increases with", "a much ", "inner steps", "Eq. 7", "as many points")


@dataclass
class Section:
    """A stem in a file of tables."""

    header: list[str] = field(default_factory=list)
    rows: list[list[str]] = field(default_factory=list)
    claims: list[tuple[str, str]] = field(default_factory=list)  # claim, outcome


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
        elif match := re.match(r"- Claim: (.*?)\. Here(?::| it) (.*?) \(", line):
            section.claims.append((match[1], match[2]))
    return found


def interval(text: str) -> tuple[float, float, float] | None:
    """Of '2.00 [1.93, 2.08]' or '80.0', whose ends are then unknown: 2, 1.93, 2.08. None for 'timeout' and the like."""
    match = re.match(r"([\d.]+)(?: \[([\d.]+), ([\d.]+)\])?$", text)
    if not match:
        return None
    value = float(match[1])
    return (value, float(match[2]), float(match[3])) if match[2] else (value, value, value)


def name_of(title: str) -> str:
    names = {look.title: name for name, look in style.LOOKS.items()}
    return f"`{names[title]}`" if title in names else title


def race(section: Section, mark: str) -> tuple[dict[str, list[float]], int]:
    """By winner, how many times over the next best, of each scene it wins; and how many scenes there are."""
    titles = {i: title for i, title in enumerate(section.header)
              if title in {look.title for look in style.LOOKS.values()} | set(TITLES.values())}
    rows = [row for row in section.rows if len(row) > 1 and row[1] == mark]
    won: dict[str, list[float]] = {}
    for row in rows:
        known = sorted((x, titles[i]) for i in titles if (x := interval(row[i])))
        if len(known) > 1 and known[0][0][2] < min(x[1] for x, _ in known[1:]):
            won.setdefault(name_of(known[0][1]), []).append(known[1][0][0] / known[0][0][0])
    return won, len(rows)


def victories(found: dict[str, Section]) -> dict[str, list[str]]:
    texts: dict[str, list[str]] = {}
    for stem, mark, what in RACES:
        if stem not in found:
            continue
        won, of = race(found[stem], mark)
        for solver, factors in won.items():
            low, high = tables.number(min(factors), 2), tables.number(max(factors), 2)
            texts.setdefault(solver, []).append(f"{len(factors)} of the {of} {what}, {low if low == high else f'{low} to {high}'}"
                                                " times over the next best")
    return texts


def verdicts(found: dict[str, Section]) -> dict[str, list[str]]:
    """By solver, its claims in the order of the tables; one claim of several scenes is one text."""
    grouped: dict[str, dict[str, dict[str, list[str]]]] = {}
    for section in found.values():
        for claim, outcome in section.claims:
            owner = next((solver for part, solver in CLAIMS if re.search(part, claim)), None)
            if owner is None or any(part in claim for part in SKIPPED):
                continue
            scene, _, text = claim.rpartition(": ")
            grouped.setdefault(owner, {}).setdefault(text, {}).setdefault(outcome, []).append(scene)
    return {owner: [f"{text}: " + ", ".join(outcome + (f" ({'; '.join(scenes)})" if len(outcomes) > 1 else "")
                                            for outcome, scenes in outcomes.items())
                    for text, outcomes in claims.items()] for owner, claims in grouped.items()}


def table(folder: Path = REFERENCE) -> str:
    found: dict[str, Section] = {}
    for name in SOURCES:
        found |= sections((folder / name).read_text(encoding="utf-8"))
    won, claims = victories(found), verdicts(found)
    solvers = list(dict.fromkeys([*ORDER, *won, *(owner for _, owner in CLAIMS)]))
    lines = ["| solver | fastest | what is claimed for or of it, and what came out here |", "| --- | --- | --- |"]
    for solver in solvers:
        lines.append(f"| {solver} | {'; '.join(won.get(solver, ['nowhere']))} | {'; '.join(claims.get(solver, [])) or tables.NOTHING} |")
    return "\n".join(lines)


def rewritten(readme: str, text: str) -> str:
    before, begin, rest = readme.partition(BEGIN)
    _, end, after = rest.partition(END)
    if not begin or not end:
        raise ValueError(f"README.md: the marks '{BEGIN}' and '{END}' are missing: put them where the table belongs")
    return f"{before}{begin}\n{text}\n{end}{after}"


def write(folder: Path = REFERENCE, readme: Path = README) -> Path:
    readme.write_text(rewritten(readme.read_text(encoding="utf-8"), table(folder)), encoding="utf-8")
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
