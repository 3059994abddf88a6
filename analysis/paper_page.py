"""Writes one page per paper with every checked sentence and its verdict, and a figure of all
claims.

    python3 -m analysis.paper_page           writes results/tables/PAPER_claims.* and results/figures/claims.*
    python3 -m analysis.paper_page --kept    writes results/reference/PAPER_claims.md and docs/claims.png

Shows the verdict of the current results if they test the claim, else the verdict from
results/reference, marked "(kept)". With --kept, all verdicts come from there. Page `hausbench` has
our own claims.
"""

from __future__ import annotations

import argparse
import sys
import tomllib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

from analysis import conditions, forest
from analysis.shared import claims, gate, report, table_files
from analysis.shared.load import REFERENCE
from analysis.shared.printable import printable
from analysis.shared.tex import tex_escape
from analysis.shared.verdicts import FAILS, HOLDS, NOT_JUDGED, NOT_REFUTED, OPEN, UNTESTED

ROOT: Final = REFERENCE.parent.parent
TITLES: Final = {**forest.PAPERS, claims.OWN: "Claims of our own"}
HEADER: Final = (
    "section",
    "the sentence, and how it is judged",
    "verdict",
    "measured",
    "counted work",
    "stem",
)


@dataclass(frozen=True)
class Line:
    """A line of the page: a claim, or its part about one scene, with its verdict if there is
    one."""

    entry: claims.Entry
    verdict: claims.Record | None = None
    kept: bool = False

    @property
    def outcome(self) -> str:
        return str(self.verdict["outcome"]) if self.verdict else UNTESTED

    @property
    def name(self) -> str:
        if self.verdict is None:
            return self.entry.in_general or self.entry.text
        place = str(self.verdict["place"])
        return f"{place}: {self.verdict['claim']}" if place else str(self.verdict["claim"])


def _key(record: claims.Record) -> tuple[str, ...]:
    return tuple(str(record[name]) for name in ("paper", "id", "stem", "place", "claim"))


def lines_of(paper: str, now: Iterable[claims.Record], kept: Iterable[claims.Record]) -> list[Line]:
    """Returns the lines of all claims, with or without a verdict, in the order of the paper's
    claims file.

    A verdict in `now` replaces the one in `kept`, unless it says that there were too few rounds to
    judge. Raises ValueError for a verdict on a claim that is marked untested.
    """
    tested = {
        _key(record): Line(claims.entries(paper)[str(record["id"])], record)
        for record in now
        if record["paper"] == paper
        and record["outcome"] != UNTESTED
        and record["id"] in claims.entries(paper)
    }
    before = {
        _key(record): Line(claims.entries(paper)[str(record["id"])], record, True)
        for record in kept
        if record["paper"] == paper and record["id"] in claims.entries(paper)
    }
    lines = list(
        (
            before
            | {
                key: line
                for key, line in tested.items()
                if line.outcome != NOT_JUDGED or key not in before
            }
        ).values()
    )
    if wrong := next((line.entry.id for line in lines if line.entry.untested), ""):
        raise ValueError(
            f"{paper}/{wrong} is marked untested and has a verdict: remove `untested` from analysis/claims/{paper}.toml, or the verdict"
        )
    ordered: list[Line] = []
    for entry in claims.entries(paper).values():
        ordered += [line for line in lines if line.entry.id == entry.id] or [Line(entry)]
    return ordered


def why(line: Line) -> str:
    """Explains why a claim does not hold, or has no verdict.

    Gives the reasons from the claims file, and says whether counted work confirms the claim. If it
    does not and the file gives no reason, says that the machine is not the cause.
    """
    if line.verdict is None:
        return line.entry.untested or "Not measured at the sizes of the claim yet."
    verdicts = dict(line.verdict["counted"]).values()  # type: ignore[call-overload]
    counted = {str(verdict["outcome"]) for verdict in verdicts}
    reasons = [line.entry.differs] if line.entry.differs and line.outcome in (FAILS, OPEN) else []
    reasons += [line.entry.why_not] if line.entry.why_not and line.outcome == FAILS else []
    if line.outcome in (FAILS, OPEN) and HOLDS in counted and not counted & {FAILS, OPEN}:
        reasons.append(
            "The counted work agrees with the paper: a unit of work takes a different time here."
        )
    elif not reasons and line.outcome == FAILS and FAILS in counted and not counted & {HOLDS}:
        reasons.append("The counted work says the same, so the machine is not the reason.")
    return " ".join(reasons)


def _counted(line: Line) -> str:
    counted = dict(line.verdict["counted"]) if line.verdict else {}  # type: ignore[call-overload]
    return "; ".join(
        f"{measure}: {verdict['outcome']} ({verdict['evidence']})"
        for measure, verdict in counted.items()
    )


def cells(lines: Sequence[Line]) -> list[list[str]]:
    """Returns the table rows of a page. Consecutive claims with the same quote print it once."""
    rows, quoted = [], ""
    for line in lines:
        entry, same = line.entry, bool(line.entry.quote) and line.entry.quote == quoted
        quoted = entry.quote
        sentence = "" if same or not entry.quote else f"“{entry.quote}” "
        measured = str(line.verdict["evidence"]) if line.verdict else ""
        judged_as = f" ({entry.judged_as})" if entry.judged_as else ""
        rows.append(
            [
                entry.section,
                f"{sentence}{line.name}{judged_as}",
                line.outcome + (" (kept)" if line.kept else ""),
                ". ".join(filter(None, [measured.rstrip("."), why(line)])),
                _counted(line),
                str(line.verdict["stem"]) if line.verdict else ", ".join(entry.stems),
            ]
        )
    return rows


# Figures and tables of the papers that show no measurements, so no experiment reproduces them.
SKETCHES: Final = {
    "tang2009": (
        ("Figs. 2 to 6, Table 1", "the steps of the algorithm, sketches of them, and notation"),
    ),
    "sacht2024": (("Figs. 3 to 9", "sketches of branch and bound and of the four upper bounds"),),
    "zhang2017": (("Figs. 1 to 7", "sketches of culling, of bounds and of the algorithms"),),
}


def items(paper: str, folder: Path = ROOT / "experiments") -> list[list[str]]:
    """Returns a row for each of the paper's tables and figures: stem and title."""
    rows = []
    for file in sorted(
        (folder / paper).glob("*.toml"),
        key=lambda file: (file.stem.rstrip("0123456789"), len(file.stem), file.stem),
    ):
        with file.open("rb") as text:
            rows.append([file.stem, str(tomllib.load(text).get("title", ""))])
    return rows


def count(lines: Sequence[Line]) -> str:
    outcomes = [line.outcome for line in lines]
    return ", ".join(
        f"{outcomes.count(each)} {each}"
        for each in (HOLDS, NOT_REFUTED, FAILS, OPEN, NOT_JUDGED, UNTESTED)
        if each in outcomes
    )


def markdown(paper: str, lines: Sequence[Line], measured: str = "") -> str:
    """Returns the page in Markdown. `measured` says where and how the numbers were measured."""

    def row(cells: Sequence[str]) -> str:
        return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"

    stems = items(paper)
    parts = [
        f"# {TITLES.get(paper, paper)}",
        "",
        f"{len(lines)} verdicts: {count(lines)}."
        + (
            " Those marked (kept) are from results/reference."
            if any(line.kept for line in lines)
            else ""
        ),
        "",
    ]
    parts += [measured, ""] if measured else []
    if stems:
        parts += ["| stem | what it measures |", "| --- | --- |"]
        parts += [row([f"`{stem}`", title]) for stem, title in stems]
        parts += [
            row([figures, f"nothing is measured: {subject}"])
            for figures, subject in SKETCHES.get(paper, ())
        ]
        parts.append("")
    marked = [
        [*cells[:2], f"**{cells[2]}**", *cells[3:5], f"`{cells[5]}`" if cells[5] else ""]
        for cells in cells(lines)
    ]
    return "\n".join([*parts, row(HEADER), "| --- " * len(HEADER) + "|", *map(row, marked)]) + "\n"


def latex(paper: str, lines: Sequence[Line], measured: str = "") -> str:
    """Returns the page as a longtable that is as wide as the page."""
    widths = (0.09, 0.29, 0.1, 0.24, 0.28)
    columns = "".join(
        rf">{{\raggedright\arraybackslash}}p{{\dimexpr {width}\linewidth-2\tabcolsep\relax}}"
        for width in widths
    )
    head = " & ".join(HEADER[:5]) + r" \\"
    rows = [
        " & ".join(
            map(
                tex_escape,
                [*row[:4], " ".join(filter(None, [row[4], f"[{row[5]}]" if row[5] else ""]))],
            )
        )
        + r" \\ \addlinespace"
        for row in cells(lines)
    ]
    return "\n".join(
        [
            r"% needs \usepackage{booktabs,longtable,array}",
            rf"{{\footnotesize {tex_escape(measured)}",
            rf"\begin{{longtable}}{{@{{}}{columns}@{{}}}}",
            rf"\caption{{{tex_escape(TITLES.get(paper, paper))}: {count(lines)}.}}\label{{tab:{paper}_claims}}\\",
            r"\toprule",
            head,
            r"\midrule\endfirsthead",
            r"\toprule",
            head,
            r"\midrule\endhead",
            r"\bottomrule\endfoot",
            *rows,
            r"\end{longtable}}",
            "",
        ]
    )


def papers() -> list[str]:
    """Returns the papers that have claims; our own claims come last."""
    return sorted(
        (path.stem for path in claims.FOLDER.glob("*.toml")),
        key=lambda name: (name == claims.OWN, name),
    )


def records(folder: Path) -> list[claims.Record]:
    """Reads all verdicts of a folder. Names a file that cannot be read on standard error, and
    leaves it out."""
    verdicts = []
    for path in sorted(folder.glob(f"*{claims.SUFFIX}")):
        if not gate.is_plain(path):
            continue
        try:
            verdicts += claims.read(path)
        except (ValueError, RecursionError) as problem:
            print(
                printable(
                    f"{problem}, and is left out"
                    if str(path) in str(problem)
                    else f"{path}: is left out: {problem}"
                ),
                file=sys.stderr,
            )
    return verdicts


def judging(lines: Iterable[Line], kept: bool) -> set[str]:
    """Returns the stems that have a kept verdict if `kept`, else the stems with a verdict of this
    run."""
    return {str(line.verdict["stem"]) for line in lines if line.verdict and line.kept == kept}


def texts_of(lines: Sequence[Line], out: Path) -> list[str]:
    """Returns the tables from which the verdicts were made: in `out` for verdicts of this run, else
    in results/reference."""
    return conditions.present_texts(out / "tables", judging(lines, False)) + conditions.kept_texts(
        REFERENCE, judging(lines, True)
    )


def write_kept(
    folder: Path = REFERENCE, picture: Path = ROOT / "docs" / "claims.png"
) -> list[Path]:
    kept, paths, all_lines = records(folder), [], []
    for paper in papers():
        lines = [replace(line, kept=False) for line in lines_of(paper, [], kept)]
        all_lines += lines
        paths.append(folder / f"{paper}_claims.md")
        measured = conditions.line(conditions.kept_texts(folder, judging(lines, False)))
        table_files.write_whole(paths[-1], printable(markdown(paper, lines, measured), lines=True))
    measured = conditions.measured(conditions.kept_texts(folder, judging(all_lines, False)))
    return [
        *paths,
        report.save_png(
            forest.draw([line.verdict for line in all_lines if line.verdict], measured), picture
        ),
    ]


def write(out: Path) -> list[Path]:
    now, kept, paths, all_lines = records(out / "tables"), records(REFERENCE), [], []
    for paper in papers():
        lines = lines_of(paper, now, kept)
        all_lines += lines
        measured = conditions.line(texts_of(lines, out))
        for suffix, text in (
            ("md", markdown(paper, lines, measured)),
            ("tex", latex(paper, lines, measured)),
        ):
            paths.append(out / "tables" / f"{paper}_claims.{suffix}")
            paths[-1].parent.mkdir(parents=True, exist_ok=True)
            table_files.write_whole(paths[-1], printable(text, lines=True))
    figure = forest.draw(
        [line.verdict for line in all_lines if line.verdict],
        conditions.measured(texts_of(all_lines, out)),
    )
    return [*paths, *report.save_figure(figure, out, "claims", forest.CAPTION)]


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="analysis.paper_page",
        description="Writes one page per paper: its claims and their verdicts.",
    )
    parser.add_argument(
        "--out",
        type=Path,
        default=Path("results"),
        help="folder that has tables/ (default: results)",
    )
    parser.add_argument(
        "--kept",
        action="store_true",
        help="use only the kept verdicts, and write into results/reference and docs",
    )
    chosen = parser.parse_args(arguments)
    try:
        print(*(write_kept() if chosen.kept else write(chosen.out)), sep="\n")
    except (OSError, ValueError) as problem:
        print(problem, file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
