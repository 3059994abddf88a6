"""Draws figures and tables: `python3 -m analysis STEM ... [--results DIR] [--out DIR]`.

A STEM is the name of an experiment. Reads <results>/STEM.h5 with the script that stems.module_of() finds. Also draws
all other stems whose scripts use these results; such a stem can be named alone, too.
"""

from __future__ import annotations

import argparse
import importlib
import sys
from collections.abc import Sequence
from pathlib import Path

from analysis.shared import style
from analysis.shared.load import load
from analysis.shared.printable import printable
from analysis.shared.report import Report
from analysis.shared.results import ResultError
from analysis.shared.stems import drawn_with, module_of, results_of


def main(arguments: Sequence[str] | None = None) -> int:
    """Draws the stems and returns the exit code: 2 if a result file is unusable, which does not stop the other stems."""
    parser = argparse.ArgumentParser(prog="analysis", description="Draws figures and tables of experiments from their result files.")
    parser.add_argument("stems", nargs="+", metavar="STEM", help="an experiment, such as zhang2017_table3")
    parser.add_argument("--results", type=Path, default=Path("results"), help="folder of the .h5 files (default: results)")
    parser.add_argument("--out", type=Path, default=Path("results"), help="figures/ and tables/ go there (default: results)")
    chosen, code = parser.parse_args(arguments), 0
    for stem in chosen.stems:
        try:
            results = load(chosen.results / f"{results_of(stem)}.h5")
            style.introduce(results)
            for each in drawn_with(stem):
                report: Report = importlib.import_module(module_of(each)).make(results)
                print(*report.save(results, chosen.out, each), sep="\n")
                for verdict in table.verdicts if (table := report.printed(results, each)) else ():
                    print(printable(verdict.line()))
        except ResultError as problem:
            print(printable(str(problem)), file=sys.stderr)
            code = 2
        except OSError as problem:
            print(printable(f"{stem}: cannot be drawn: {problem}: make room, or choose another folder with --out"), file=sys.stderr)
            code = 2
    return code


if __name__ == "__main__":
    sys.exit(main())
