"""The command line of every stem: `python3 -m analysis.<folder>.<stem> [--results DIR] [--out DIR]`."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

from analysis.shared.load import load
from analysis.shared.report import Report
from analysis.shared.results import ResultError, Results
from analysis.shared.stems import module_of

Make = Callable[[Results], Report]


def main(stem: str, make: Make, arguments: Sequence[str] | None = None) -> int:
    """Reads <results>/<stem>.h5 and writes below <out> what `make` makes of it. Returns the exit code: 2 if the file is unusable."""
    parser = argparse.ArgumentParser(prog=module_of(stem), description=f"Figures and tables of {stem}.")
    parser.add_argument("--results", type=Path, default=Path("results"), help="folder of the .h5 files (results)")
    parser.add_argument("--out", type=Path, default=Path("results"), help="figures/ and tables/ go there (results)")
    chosen = parser.parse_args(arguments)
    try:
        results = load(chosen.results / f"{stem}.h5")
        for path in make(results).save(results, chosen.out):
            print(path)
    except ResultError as problem:
        print(problem, file=sys.stderr)
        return 2
    return 0
