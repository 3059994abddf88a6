"""Draws tables and figures of any result: `hausbench draw RESULT.h5`, which runs this file.

Writes <out>/tables/STEM_KIND.csv, .md and .tex, and <out>/figures/STEM_KIND.pdf and .png (or the
chosen formats), for each KIND for which the result has data: `table` (all answers and the
experiment's own claims), `error-against-time`, `performance-profile` and `motion`.
"""

from __future__ import annotations

import argparse
import importlib
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Final

from analysis.shared import style
from analysis.shared.load import load
from analysis.shared.printable import printable
from analysis.shared.report import FORMATS, Report
from analysis.shared.results import ResultError, Results

KINDS: Final = {
    "table": "answers",
    "error-against-time": "error_against_time",
    "performance-profile": "performance_profile",
    "motion": "motion",
}

SUFFIXES: Final = ("pdf", "png", "svg")


def reports(results: Results, kinds: Sequence[str]) -> dict[str, Report]:
    """Returns the report of each kind (default: all) for which the result has data. Raises
    ResultError if there is none."""
    made: dict[str, Report | None] = {
        kind: importlib.import_module(f"analysis.views.{KINDS[kind]}").make(results)
        for kind in kinds or KINDS
    }
    drawable = {kind: report for kind, report in made.items() if report is not None}
    if not drawable:
        why = {
            "motion": "no scene has several poses",
            "performance-profile": "it needs two solvers and two cases with comparable times",
        }
        raise ResultError(
            f"{results.path}: cannot be drawn as {', '.join(made)}: {why.get(next(iter(made)), 'no row has bounds and a time')}"
        )
    return drawable


def inches(text: str) -> float:
    """Parses the width of a figure: a name in style.WIDTHS, or inches."""
    if text in style.WIDTHS:
        return style.WIDTHS[text]
    try:
        width = float(text)
    except ValueError:
        width = 0.0
    if not 2 <= width <= 40:
        raise argparse.ArgumentTypeError(
            f"'{text}' is neither single, double nor a number of inches from 2 to 40"
        )
    return width


def formats(text: str) -> list[str]:
    """Parses a comma-separated list into distinct names of SUFFIXES."""
    names = list(dict.fromkeys(text.split(",")))
    if unknown := [name for name in names if name not in SUFFIXES]:
        raise argparse.ArgumentTypeError(f"'{unknown[0]}' is not one of {', '.join(SUFFIXES)}")
    return names


def main(arguments: Sequence[str] | None = None) -> int:
    """Returns the exit code: 2 if the result cannot be used or drawn."""
    parser = argparse.ArgumentParser(
        prog="hausbench draw", description="Tables and figures of any result, for papers."
    )
    parser.add_argument("result", type=Path, metavar="RESULT.h5")
    parser.add_argument(
        "--as",
        dest="kinds",
        action="append",
        default=[],
        choices=list(KINDS),
        help="what to draw; may be repeated (default: everything that the result has data for)",
    )
    parser.add_argument(
        "--highlight",
        metavar="LABEL",
        default="",
        help="draw this solver in front of the others, which become grey",
    )
    parser.add_argument(
        "--width",
        type=inches,
        default=style.DOUBLE_COLUMN,
        help="width of the figures: single (3.5 inches), double (7.16, the default) or " "inches",
    )
    parser.add_argument(
        "--format",
        dest="formats",
        type=formats,
        default=list(FORMATS),
        help="formats of the figures: a list of pdf, png and svg (default: " "pdf,png)",
    )
    parser.add_argument(
        "--out", type=Path, help="tables/ and figures/ go there (default: the folder of the result)"
    )
    chosen = parser.parse_args(arguments)
    try:
        results = load(chosen.result)
        names = {*map(str, results.names), *map(str, results.cases.label)}
        if chosen.highlight and chosen.highlight not in names:
            raise ResultError(
                f"{results.path}: no solver is labelled '{chosen.highlight}': choose one of {', '.join(sorted(names))}"
            )
        style.introduce(results)
        style.highlight(chosen.highlight)
        style.set_width(chosen.width)
        for kind, report in reports(results, chosen.kinds).items():
            stem = f"{results.stem}_{kind.replace('-', '_')}"
            print(
                *report.save(results, chosen.out or chosen.result.parent, stem, chosen.formats),
                sep="\n",
            )
            for verdict in table.verdicts if (table := report.printed(results, stem)) else ():
                print(printable(verdict.line()))
    except ResultError as problem:
        print(printable(str(problem)), file=sys.stderr)
        return 2
    except OSError as problem:
        print(
            printable(
                f"{chosen.result}: cannot be drawn: {problem}: make room, or choose another folder with --out"
            ),
            file=sys.stderr,
        )
        return 2
    except Exception as problem:  # the file was edited: no run writes such texts or times
        print(
            printable(f"{chosen.result}: cannot be drawn: {problem}: run its experiment again"),
            file=sys.stderr,
        )
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
