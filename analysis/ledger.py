"""Summarises the ledgers of results/*.h5, which list the work that runs skipped, why, and the time
saved.

    python3 -m analysis.ledger    writes results/figures/ledger.* and results/tables/ledger.*, and prints the totals

A saving that could not be measured, such as the time to build a structure that was never built, is
"not measured" in the table and 0 in sums. If there is a result S.everything.h5 (from `run
--leave-nothing-out`) beside S.h5, the table says how many answers are equal.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter, defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

import matplotlib.pyplot as plt
import numpy as np

from analysis.shared import numerals, style, table_files, tables
from analysis.shared.load import each, load_all, results_in
from analysis.shared.report import save_caption, save_figure
from analysis.shared.results import ResultError, Results

# By `what`, or else `kind`, of the ledger's entries: title in the table, colour and hatch of the
# bar.
KINDS: Final = {
    "coarser tolerances": ("tolerances read off the trace of a finer run", "#56B4E9", ""),
    "structures for each pose": ("structures used for all poses of a motion", "#E69F00", "//"),
    "structures for each pair": ("structures used for all pairs of a matrix", "#009E73", "\\\\"),
    "not_prepared": ("structures that the scene does not need", "#CC79A7", "xx"),
    "not_run": ("cases that a solver does not take, and references not requested", "#999999", ".."),
    "not_built": ("solvers that this build does not have", "#0072B2", "++"),
    "prepared_again": ("nothing: structures were rebuilt because the target moves", "#D55E00", ""),
    "reference": ("nothing: time spent on reference answers", "#000000", ""),
}
CAPTION: Final = (
    "Time in solvers of each experiment, s, and the time saved by not measuring again and not building. In brackets: the number of entries in "
    "its ledger; an entry whose saving was not measured adds nothing."
)
LEAST: Final = 1.0  # seconds: shorter bars are not drawn
COSTS: Final = (
    "reference",
)  # kinds that cost time (their saving is negative), which is added to Stem.run
NOT_LEFT_OUT: Final = (*COSTS, "prepared_again")  # kinds that say why work was done
EVERYTHING: Final = ".everything.h5"


@dataclass
class Stem:
    name: str
    run: float  # seconds in solvers: structures, first answers, repeats
    entries: Counter[str] = field(default_factory=Counter)  # by key of KINDS
    unknown: Counter[str] = field(
        default_factory=Counter
    )  # the number of these whose saving was not measured
    saved: dict[str, float] = field(
        default_factory=lambda: defaultdict(float)
    )  # seconds, by key of KINDS
    reasons: dict[str, Counter[str]] = field(default_factory=dict)
    proof: str = ""

    @property
    def left_out(self) -> int:
        """The number of entries about work that was left out."""
        return sum(count for key, count in self.entries.items() if key not in NOT_LEFT_OUT)

    @property
    def seconds_saved(self) -> float:
        return sum(seconds for key, seconds in self.saved.items() if key not in COSTS)


def seconds_run(results: Results) -> float:
    """Returns the wall time spent on structures, first answers and repeats, in seconds.

    A structure counts once per process, even if many poses use it.
    """
    cases, prepared = results.cases, results.preparation
    built = {
        (cases.label[case], cases.scene[case], number, name, seconds)
        for case, number, name, seconds, shared in zip(
            prepared.case, prepared.round, prepared.name, prepared.seconds, prepared.shared
        )
        if not shared
    }
    return float(
        np.nansum(results.answers.wall_seconds)
        + np.nansum(results.repeats.wall_seconds * results.repeats.iterations)
        + sum(seconds for *_, seconds in built if np.isfinite(seconds))
    )


def same_answers(first: Results, second: Results) -> tuple[int, int]:
    """Returns the number of rows with equal bounds in both results, and the number of rows in
    both."""

    def bounds(results: Results) -> dict[tuple[Any, ...], tuple[float, float]]:
        cases = results.cases
        return {
            (cases.identity[i], cases.scene[i], cases.label[i]): (cases.lower[i], cases.upper[i])
            for i in range(len(cases))
            if results.is_bounded(i)
        }

    first_bounds, second_bounds = bounds(first), bounds(second)
    both = first_bounds.keys() & second_bounds.keys()
    return sum(first_bounds[key] == second_bounds[key] for key in both), len(both)


def read(results: Results) -> Stem:
    path = results.path
    stem = Stem(path.stem, seconds_run(results))
    ledger = results.ledger
    for kind, subject, reason, seconds in zip(
        ledger.kind, ledger.what, ledger.reason, ledger.seconds_saved
    ):
        key = subject if subject in KINDS and kind != "prepared_again" else kind
        stem.entries[key] += 1
        stem.saved[key] += float(seconds) if np.isfinite(seconds) else 0.0
        stem.unknown[key] += not np.isfinite(seconds)
        stem.reasons.setdefault(key, Counter())[reason] += 1
    stem.run -= sum(stem.saved[key] for key in COSTS)
    if (everything := path.with_name(path.stem + EVERYTHING)).exists():
        for equal, both in each(load_all([everything]), lambda whole: same_answers(results, whole)):
            stem.proof = f"{equal} of {both} answers are the same with nothing left out"
    return stem


def stems_in(folder: Path) -> list[Stem]:
    """Reads every result of a folder and sorts them by time, longest first.

    Prints a line for a damaged file and skips it. Raises ResultError if nothing is left.
    """
    stems = each(load_all(results_in(folder)), read)
    if not stems:
        raise ResultError(f"{folder}: no results: make them with 'make experiments'")
    return by_time(stems)


def by_time(stems: Sequence[Stem]) -> list[Stem]:
    """Sorts the summaries by time, longest first."""
    return sorted(stems, key=lambda stem: -(stem.run + stem.seconds_saved))


def table(stems: Sequence[Stem]) -> tables.Table:
    entries, unknown, saved, reasons = (
        Counter[str](),
        Counter[str](),
        defaultdict[str, float](float),
        dict[str, Counter[str]](),
    )
    for stem in stems:
        entries += stem.entries
        unknown += stem.unknown
        for key, seconds in stem.saved.items():
            saved[key] += seconds
        for key, texts in stem.reasons.items():
            reasons.setdefault(key, Counter()).update(texts)
    keys = [key for key in KINDS if entries[key]]
    keys += sorted(key for key in entries if key not in KINDS)
    rows = [
        [
            KINDS[key][0] if key in KINDS else key,
            _most(reasons[key]),
            f"{entries[key]:,}",
            seconds_text(saved[key], unknown[key], entries[key]),
        ]
        for key in keys
    ]
    proofs = [f"{stem.name}: {stem.proof}." for stem in stems if stem.proof]
    return tables.Table(
        "Work that all runs skipped, why skipping it is safe, and the seconds saved (negative: seconds spent).",
        ["left out", "the most common reason", "entries", "s"],
        rows,
        [
            "Not measured: a structure or case that was never built or run has no time; such an "
            "entry counts as zero."
            + (
                ""
                if proofs
                else " `run --leave-nothing-out` writes STEM.everything.h5, and this "
                "table then says how many answers are the same."
            )
        ]
        + proofs,
        left=2,
    )


def seconds_text(saved: float, unknown: int, entries: int) -> str:
    """Returns '1.50 (3 not measured)': the seconds saved, and the number of entries that this sum
    lacks."""
    if unknown == entries:
        return "not measured"
    return numerals.number(saved) + (f" ({unknown:,} not measured)" if unknown else "")


def _most(reasons: Counter[str]) -> str:
    first, *others = [text for text, _ in reasons.most_common()]
    return first + (f" (and {len(others)} more)" if others else "")


def line(stems: Sequence[Stem]) -> str:
    entries = sum(stem.left_out for stem in stems)
    saved = sum(stem.seconds_saved for stem in stems)
    run = sum(stem.run for stem in stems)
    return f"left out: {entries:,} entries in the ledgers of {len(stems)} results, {saved:,.0f} s saved, {run:,.0f} s spent in solvers and on reference answers"


def draw(stems: Sequence[Stem]) -> Any:
    """Draws one bar per experiment: time in solvers, then time saved by kind. Bars below LEAST
    seconds are left out."""
    short = sum(stem.run + stem.seconds_saved < LEAST for stem in stems)
    stems = [stem for stem in stems if stem.run + stem.seconds_saved >= LEAST]
    figure, ax = plt.subplots(figsize=(style.DOUBLE_COLUMN, 0.16 * len(stems) + 0.9))
    places, left = np.arange(len(stems)), np.array([stem.run for stem in stems])
    ax.barh(places, left, color="#333333", height=0.7, label="time in solvers")
    for key, (title, colour, hatch) in KINDS.items():
        saved = np.array([stem.saved[key] for stem in stems])
        if key in COSTS or not (saved > 0).any():
            continue
        ax.barh(
            places,
            saved,
            left=left,
            color=colour,
            hatch=hatch,
            height=0.7,
            edgecolor="white",
            linewidth=0.3,
            label=f"saved: {title}",
        )
        left = left + saved
    ax.set_yticks(places, [f"{stem.name} ({stem.left_out:,})" for stem in stems], fontsize=6)
    left_out = f"; {short} experiments of less than {LEAST:g} s are not shown" if short else ""
    ax.set(
        xlabel=f"s in solvers, and s saved (in brackets: entries in the ledger){left_out}",
        ylim=(len(stems) - 0.4, -0.6),
    )
    ax.tick_params(axis="y", length=0)
    ax.legend(loc="lower right", fontsize=6.5)
    return figure


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="analysis.ledger", description="Lists the work that all runs left out."
    )
    parser.add_argument(
        "--results",
        type=Path,
        default=Path("results"),
        help="folder of the .h5 files (default: results)",
    )
    parser.add_argument(
        "--out", type=Path, help="folder for figures/ and tables/ (default: the results folder)"
    )
    chosen = parser.parse_args(arguments)
    out = chosen.out or chosen.results
    try:
        stems = stems_in(chosen.results)
    except ResultError as problem:
        print(problem, file=sys.stderr)
        return 2
    listing = table(stems)
    records: list[tables.Record] = [
        {
            "stem": stem.name,
            "seconds_in_solvers": stem.run,
            "kind": key,
            "entries": stem.entries[key],
            "entries_not_measured": stem.unknown[key],
            "seconds_saved": stem.saved[key]
            if stem.unknown[key] < stem.entries[key]
            else float("nan"),
        }
        for stem in stems
        for key in stem.entries
    ]
    for path in [
        *table_files.save(listing, records, out, "ledger"),
        *save_figure(draw(stems), out, "ledger", CAPTION),
        *save_caption(CAPTION, out, "ledger"),
    ]:
        print(path)
    print(line(stems))
    return 0


if __name__ == "__main__":
    sys.exit(main())
