"""Draws figures and tables: `python3 -m analysis STEM ... [--results DIR] [--out DIR]`.

A STEM is the name of an experiment. Reads <results>/STEM.h5 with the script that stems.module_of()
finds. Also draws all other stems whose scripts use these results; such a stem can be named alone,
too.
"""

from __future__ import annotations

import argparse
import contextlib
import importlib
import io
import multiprocessing
import os
import signal
import sys
import traceback
from collections.abc import Sequence
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from pathlib import Path

from analysis.shared import missing, style
from analysis.shared.load import load
from analysis.shared.printable import printable
from analysis.shared.report import Report
from analysis.shared.results import ResultError
from analysis.shared.stems import drawn_with, module_of, results_of


def draw(stem: str, folder: Path, out: Path) -> int:
    """Draws a stem, prints what was written, and returns the exit code: 2 if the result file is
    unusable.

    Rows whose models are missing are left out. If the others are not enough for a table or a
    figure, says what is missing.
    """
    lacking = ""
    try:
        whole = load(folder / f"{results_of(stem)}.h5")
        lacking = missing.note(whole)
        style.introduce(whole)
        results = missing.without(whole)
        if not len(results.cases) and lacking:
            raise ResultError("all are missing")
        for drawn in drawn_with(stem):
            report: Report = importlib.import_module(module_of(drawn)).make(results)
            print(*report.save(results, out, drawn), sep="\n")
            for verdict in table.verdicts if (table := report.printed(results, drawn)) else ():
                print(printable(verdict.line()))
    except ResultError as problem:
        if lacking:
            print(printable(f"{stem}: not drawn: {lacking}"))
            return 0
        print(printable(str(problem)), file=sys.stderr)
        return 2
    except OSError as problem:
        print(
            printable(
                f"{stem}: cannot be drawn: {problem}: make room, or choose another folder with --out"
            ),
            file=sys.stderr,
        )
        return 2
    return 0


def draw_apart(stem: str, folder: Path, out: Path, to: Connection) -> None:
    """Draws a stem and sends the exit code and what was printed; an error in its script becomes
    part of that."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # Ctrl-C ends it without a traceback
    output, complained = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(output), contextlib.redirect_stderr(complained):
        try:
            code = draw(stem, folder, out)
        except Exception:
            print(f"{stem}: its script failed:\n{traceback.format_exc()}", file=sys.stderr)
            code = 1
    to.send((code, output.getvalue(), complained.getvalue()))


def outcome(stem: str, ready: Connection, process: BaseProcess) -> tuple[int, str, str]:
    """Returns what draw_apart() sent, or the reason why its process sent nothing; waits for the end
    of the process."""
    with ready:
        try:
            sent: tuple[int, str, str] | None = ready.recv()
        except EOFError:
            sent = None
    process.join()
    return sent or (1, "", f"{stem}: its script was killed (exit code {process.exitcode})\n")


def draw_side_by_side(stems: Sequence[str], folder: Path, out: Path) -> int:
    """Draws each stem in a process of its own, so that none sees the looks that another gave to
    solvers (style.introduce).

    Prints what they say in the order of `stems`, and returns the largest exit code; 1 for a process
    that was killed.
    """
    context, most = multiprocessing.get_context("fork"), min(8, len(os.sched_getaffinity(0)))
    waiting, running = list(enumerate(stems)), dict[Connection, tuple[int, BaseProcess]]()
    outcomes, worst = dict[int, tuple[int, str, str]](), 0
    for number in range(len(stems)):
        while number not in outcomes:
            while waiting and len(running) < most:
                at, stem = waiting.pop(0)
                receiver, sender = context.Pipe(duplex=False)
                process = context.Process(target=draw_apart, args=(stem, folder, out, sender))
                process.start()
                sender.close()
                running[receiver] = at, process
            for ready in wait(list(running)):
                assert isinstance(ready, Connection)
                at, ended = running.pop(ready)
                outcomes[at] = outcome(stems[at], ready, ended)
        code, printed, complained = outcomes.pop(number)
        print(printed, end="", flush=True)
        print(complained, end="", file=sys.stderr, flush=True)
        worst = max(worst, code)
    return worst


def main(arguments: Sequence[str] | None = None) -> int:
    """Draws the stems and returns the exit code, which is not 0 if one could not be drawn; that
    does not stop the others."""
    parser = argparse.ArgumentParser(
        prog="analysis",
        description="Draws figures and tables of experiments from their result files.",
    )
    parser.add_argument(
        "stems", nargs="+", metavar="STEM", help="an experiment, such as zhang2017_table3"
    )
    parser.add_argument(
        "--results",
        type=Path,
        default=Path("results"),
        help="folder of the .h5 files (default: results)",
    )
    parser.add_argument(
        "--out",
        type=Path,
        default=Path("results"),
        help="figures/ and tables/ go there (default: results)",
    )
    chosen = parser.parse_args(arguments)
    if len(chosen.stems) == 1:
        return draw(chosen.stems[0], chosen.results, chosen.out)
    return draw_side_by_side(chosen.stems, chosen.results, chosen.out)


if __name__ == "__main__":
    sys.exit(main())
