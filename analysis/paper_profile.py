"""Stores the tables of a paper, measured at the paper's sizes, in one file in results/reference.

    make zhang2017 PROFILE=paper && python3 -m analysis.paper_profile zhang2017

writes results/reference/zhang2017_paper_profile.md. A single experiment, such as points_speed, is
stored in points_speed.md, and the group `corpus`, which has no paper, in corpus.md (from its
profile `corpus`).

Verdicts go to NAME.verdicts.json, and times for README's table of winners to NAME.times.json.
Experiments without a result here keep what was stored, so that a paper can be measured in parts.
The section `What it says` is written by hand and stays. Afterwards, README's table of winners, the
pages of claims and their picture are made again.
"""

from __future__ import annotations

import argparse
import importlib
import re
import sys
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from analysis import paper_page, winners
from analysis.shared import claims, missing, style, table_files, tables, unlike
from analysis.shared.load import REFERENCE, load
from analysis.shared.notes import measured_on
from analysis.shared.report import Report
from analysis.shared.results import ResultError, Results
from analysis.shared.stems import drawn_with, module_of, results_of


SAYS: Final = "What it says"  # the section that is written by hand


@dataclass
class Kept:
    """The contents of a file in results/reference, parsed."""

    machines: list[str] = field(default_factory=list)
    rows: dict[str, str] = field(
        default_factory=dict
    )  # by stem; a line of the table at the head of the file
    tables: dict[str, str] = field(default_factory=dict)  # by stem
    verdicts: list[claims.Record] = field(default_factory=list)
    times: list[claims.Record] = field(default_factory=list)
    says: str = ""


def kept_of(path: Path) -> Kept:
    kept = Kept()
    if not path.exists():
        return kept
    head, *sections = path.read_text(encoding="utf-8").split("\n## ")
    rows = {
        match[1]: line for line in head.splitlines() if (match := re.match(r"\| (\w+) \| \d", line))
    }
    for section in sections:
        stem, _, body = section.partition("\n")
        if stem == SAYS:
            kept.says = body.strip("\n")
        if stem in rows:
            kept.rows[stem], kept.tables[stem] = rows[stem], body.strip("\n")
    kept.verdicts = claims.read(path.with_suffix(claims.SUFFIX))
    if (file := path.with_suffix(winners.SUFFIX)).exists():
        kept.times = table_files.read_json(file)
    kept.machines = [line[2:] for line in head.splitlines() if line.startswith("- ")]
    return kept


def in_order(group: str, stems: set[str]) -> list[str]:
    """Sorts stems: tables before figures, each by number."""

    def order(stem: str) -> tuple[str, int]:
        match = re.search(r"([a-z_]+)(\d*)$", stem.removeprefix(group))
        word, number = (match[1], match[2]) if match else ("", "")
        return ({"_table": "1", "_fig": "2"}.get(word, "3" + word), int(number or 0))

    return sorted(stems, key=order)


def stems_of(group: str, folder: Path) -> list[str]:
    """Returns the stems of the group that have results: those named after it, and those in its
    folder of experiments."""
    beside = {file.stem for file in (paper_page.ROOT / "experiments" / group).glob("*.toml")}
    return in_order(
        group,
        {
            path.stem
            for path in folder.glob("*.h5")
            if path.stem in beside or f"{path.stem}_".startswith(f"{group}_")
        },
    )


def whole_profile(group: str) -> str:
    return "corpus" if group.partition("_")[0] == "corpus" else "paper"


def check(results: Results) -> Results:
    """Returns the results if they can be kept: of the whole profile, with no row missing, of the
    kept shapes. Otherwise raises ResultError."""
    whole = whole_profile(results.stem)
    if results.meta.get("profile") != whole:
        raise ResultError(
            f"{results.path}: has profile '{results.meta.get('profile')}': measure it with 'make {results.stem} PROFILE={whole}'"
        )
    if lacking := missing.note(results):
        raise ResultError(f"{results.path}: cannot be kept: {lacking}")
    unlike.expect_none(results)
    return results


def files_of(
    group: str, folder: Path, kept: Kept
) -> tuple[str, list[claims.Record], list[tables.Record]]:
    """Returns the file's text, verdicts and times: new ones for stems with results, kept ones for
    the others."""
    stems, whole = stems_of(group, folder), whole_profile(group)
    if not stems:
        raise ResultError(
            f"{folder}: no results of '{group}': measure them with 'make {group} PROFILE={whole}'"
        )
    all_results = [check(load(folder / f"{stem}.h5")) for stem in stems]
    rows, texts, judged = dict(kept.rows), dict(kept.tables), list[claims.Record]()
    timed = [record for record in kept.times if record["stem"] not in stems]
    for stem, results in zip(stems, all_results):
        counts = {
            status: int((results.cases.status == status).sum())
            for status in sorted(set(results.cases.status))
        }
        rows[stem] = (
            f"| {stem} | {results.meta.get('started')} | {results.meta.get('finished')} | "
            f"{', '.join(f'{count:,} {status}' for status, count in counts.items())} |"
        )
        style.introduce(results)
        reports: dict[str, Report] = {
            name: importlib.import_module(module_of(name)).make(results)
            for name in drawn_with(stem)
        }
        made = {
            name: table
            for name, report in reports.items()
            if (table := report.printed(results, name))
        }
        texts[stem] = "\n\n".join(tables.markdown(table).strip("\n") for table in made.values())
        judged += [
            record
            for name, table in made.items()
            for record in claims.records(table.verdicts, name, whole)
        ]
        if stem in winners.RACES:
            timed += winners.times(reports[stem].records, results)
    still = [text for stem, text in texts.items() if stem not in stems]
    machines = {measured_on(results) for results in all_results}
    for machine in kept.machines:
        if any(machine in text for text in still):
            machines.add(machine)
    by_hand = f', but for "{SAYS}"' if kept.says else ""
    parts = [
        f"# {group}, profile `{whole}`",
        "",
        f"Measured here, and written by `make {group} PROFILE={whole} && python3 -m analysis.paper_profile {group}`. "
        f"Nothing below is edited by hand{by_hand}.",
        "",
        *[f"- {line}" for line in sorted(machines)],
        "",
        "| stem | begun (UTC) | ended (UTC) | rows |",
        "|---|---|---|---|",
    ]
    ordered = in_order(group, set(rows))
    parts += [rows[stem] for stem in ordered]
    if kept.says:
        parts += ["", f"## {SAYS}", "", kept.says]
    for stem in ordered:
        parts += ["", f"## {stem}", "", texts[stem]]
    judged += [record for record in kept.verdicts if results_of(str(record["stem"])) not in stems]
    place = {stem: i for i, stem in enumerate(ordered)}
    return (
        "\n".join(parts) + "\n",
        sorted(judged, key=lambda record: place.get(results_of(str(record["stem"])), len(place))),
        timed,
    )


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="analysis.paper_profile", description="Keeps the tables of a paper's profile."
    )
    parser.add_argument("group", help="a group such as zhang2017, or a stem")
    parser.add_argument(
        "--results",
        type=Path,
        default=Path("results"),
        help="folder of the .h5 files (default: results)",
    )
    parser.add_argument(
        "--out",
        type=Path,
        default=REFERENCE,
        help="folder to write to (default: results/reference)",
    )
    chosen = parser.parse_args(arguments)
    single = stems_of(chosen.group, chosen.results) == [
        chosen.group
    ] or chosen.group == whole_profile(chosen.group)
    path = chosen.out / (f"{chosen.group}.md" if single else f"{chosen.group}_paper_profile.md")
    try:
        text, judged, timed = files_of(chosen.group, chosen.results, kept_of(path))
    except ResultError as problem:
        print(problem, file=sys.stderr)
        return 2
    table_files.write_whole(path, text)
    table_files.save_json(judged, path.with_suffix(claims.SUFFIX))
    if timed:
        table_files.save_json(timed, path.with_suffix(winners.SUFFIX))
    print(path)
    if chosen.out != REFERENCE:
        return 0
    for stem in stems_of(chosen.group, chosen.results):
        unlike.keep(load(chosen.results / f"{stem}.h5"))
    return paper_page.main(["--kept"]) or (winners.main() if path.name in winners.SOURCES else 0)


if __name__ == "__main__":
    sys.exit(main())
