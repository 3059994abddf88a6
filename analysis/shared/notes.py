"""Sentences for the notes below tables and figures: machine, build, clock, and bounds that were not
checked."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence

import numpy as np

from analysis.shared import style
from analysis.shared.results import LEAST_SHARE, Results


def unchecked_line(results: Results, rows: Sequence[int] | None = None) -> str:
    """Names the solvers in `rows` (default: all) whose lower bounds the harness could not check;
    empty if there are none."""
    cases, labels_by_check = results.cases, dict[str, list[str]]()
    among = range(len(cases)) if rows is None else rows
    titles = {
        str(cases.label[case]): style.title(cases.solver[case], cases.label[case]) for case in among
    }
    row_counts = Counter(str(cases.label[case]) for case in among)
    for case in among:
        if (
            cases.status[case] != "unsound"
            and np.isfinite(cases.lower[case])
            and results.check_of(case).startswith("not")
        ):
            labels_by_check.setdefault(results.check_of(case), []).append(str(cases.label[case]))

    def counted(labels: list[str]) -> str:
        return ", ".join(
            titles[label]
            + (f" (in {count} of {row_counts[label]} rows)" if count < row_counts[label] else "")
            for label, count in sorted(Counter(labels).items())
        )

    return "; ".join(
        f"Lower bounds {check}: {counted(labels)}"
        for check, labels in sorted(labels_by_check.items())
    )


def side_by_side_line(results: Results) -> str:
    """Says how many rows have incomparable times, because they ran at the same time as others;
    empty if none did."""
    several = int((results.cases.side_by_side != 0).sum())
    return (
        f"{several} of {len(results.cases)} rows were run beside others (--jobs, or a cluster): their times are not comparable."
        if several
        else ""
    )


def machine_line(results: Results, rows: Sequence[int] | None = None) -> str:
    """Returns measured_on(), followed by unchecked_line() of `rows` (default: all) if it is not
    empty."""
    unchecked = unchecked_line(results, rows)
    return f"{measured_on(results)}. {unchecked}" if unchecked else measured_on(results)


def measured_on(results: Results) -> str:
    """Returns the sentence on the machine, the build and the profile."""
    meta = results.meta
    gibibytes = float(meta.get("memory_bytes", np.nan)) / 2**30
    dirty = " with changes" if meta.get("dirty") in (1, True, "true", "yes") else ""
    line = (
        f"{meta.get('cpu', 'unknown CPU')}, {meta.get('cores', '?')} cores, {gibibytes:.0f} GiB, "
        f"{meta.get('system', 'unknown system')}, {meta.get('compiler', 'unknown compiler')}, "
        f"commit {str(meta.get('commit', 'unknown'))[:10]}{dirty}, profile {meta.get('profile', 'unknown')}"
    )
    for kind, column in (("machine", results.cases.machine), ("build", results.programs)):
        if (count := len(set(column))) > 1:
            line += f"; rows of {count} {kind}s are mixed, and the times of two {kind}s are not comparable"
    return line


def stand_in(note: str) -> str:
    """Extracts from the note of a scene the shapes that replace the paper's: 'an orange sampled
    twice'; empty if it names none."""
    match = re.fullmatch(r"(?:.+, and )?(.+?)(?: that)? stands? in(?: for .*)?", note)
    return match[1] if match else ""


def scene_notes(results: Results) -> list[str]:
    """Returns the notes of the experiment file on its scenes, such as which model replaces the
    paper's."""
    return [
        f"{style.scene_title(scene)}: {note}."
        for scene in results.scenes
        if (note := results.cases.scene_note[results.rows(scene=scene)[0]])
    ]


def clocks(results: Results) -> dict[str, list[str]]:
    """Returns the titles of the solvers with answers, by the clock of their rows ('cpu' or
    'wall')."""
    by_clock: dict[str, list[str]] = {}
    for row in range(len(results.cases)):
        if results.cases.status[row] in ("ok", "floor", "budget") and results.solve_by_round(row):
            titles = by_clock.setdefault(results.clock_of(row), [])
            title = style.title(results.cases.solver[row], results.cases.label[row])
            if title not in titles:
                titles.append(title)
    return by_clock


def clock_word(results: Results) -> str:
    """Returns 'CPU time' or 'wall time', or 'time' if the results have both, for captions and
    axes."""
    by_clock = clocks(results)
    return "time" if len(by_clock) > 1 else "wall time" if "wall" in by_clock else "CPU time"


def clock_title(results: Results) -> str:
    """Returns clock_word() capitalised, to begin a sentence."""
    word = clock_word(results)
    return word[0].upper() + word[1:]


def total_word(results: Results) -> str:
    """Names the sum of preparation (always wall time) and solving (CPU or wall time), for captions
    and axes."""
    word = clock_word(results)
    return (
        "time to prepare (wall) and solve (CPU)"
        if word == "CPU time"
        else f"{word} to prepare and solve"
    )


def total_title(results: Results) -> str:
    """Returns total_word() capitalised, to begin a sentence."""
    word = total_word(results)
    return word[0].upper() + word[1:]


def clock_note(results: Results) -> str:
    by_clock = clocks(results)
    cpu = "process CPU time, children included"
    text = (
        f"Times are {cpu}, but wall time for {', '.join(by_clock['wall'])}, where several threads work, a time "
        f"was read off a trace, or an outside program used the CPU for less than {100 * LEAST_SHARE:.0f} % of its wall time"
        if len(by_clock) > 1
        else "Times are wall time"
        if "wall" in by_clock
        else f"Times are {cpu}"
    )
    return f"{text}; preparing is wall time."
