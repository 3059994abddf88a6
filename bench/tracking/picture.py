"""The picture of the history: a panel for each case, the commits in order, machine by machine; steps are marked, and listed in a table.

figures/history and figures/history_kernels, tables/history_steps. history.py calls it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import matplotlib.pyplot as plt
import matplotlib.patheffects
import matplotlib.ticker
import numpy as np

from analysis.shared import style, tables
from analysis.shared.report import save_figure
from bench.tracking import builds
from bench.tracking.cases import KERNELS, cases
from bench.tracking.history import Row
from bench.tracking.steps import Step, steps

LEAST_TIME: Final = 0.05  # smaller steps of the time are not marked: where code lies in memory moves some loops by about as much
LEAST_COUNT: Final = 0.01  # of instructions, which know no noise
NOISE_TIME: Final = 0.01  # at least; else half the interval of the case's median commit
NOISE_COUNT: Final = 1e-4
LEAST_SPAN: Final = 1.6  # of a panel's vertical axis, top over bottom: noise shall look small
MOST_LABELS: Final = 78  # commits that a figure's width has room to name
TIME, COUNT, SLOWER, FASTER, ALONE = "#0072B2", "#A8A8A8", "#C44100", "#007A58", "#707070"
LETTERS: Final = "ABCDEFGHIJ"  # of machines


@dataclass(frozen=True)
class Found:
    """A step of a case on a machine."""

    case: str
    machine: str
    what: str  # "time" or "instructions"
    before: Row
    after: Row
    ratio: float

    @property
    def words(self) -> str:
        more, factor = self.ratio > 1, max(self.ratio, 1 / self.ratio)
        word = ("slower" if more else "faster") if self.what == "time" else ("more" if more else "fewer")
        return f"{factor:.2f}× {word}" if factor < 9.95 else f"{factor:.0f}× {word}"


def series(rows: Sequence[Row], case: str, machine: str) -> list[Row]:
    """What was measured of a case on a machine, in order of the commits. Rows with other shapes than the newest are of another case."""
    found = sorted((row for row in rows if row.case == case and row.machine == machine and row.blocks), key=lambda row: (row.date, row.commit))
    return [row for row in found if row.shapes == found[-1].shapes]


def noise_of(rows: Sequence[Row]) -> float:
    """The relative half-width of the interval, of the median commit."""
    known = [(row.cpu_high - row.cpu_low) / 2 / row.cpu_seconds for row in rows if not math.isnan(row.cpu_high)]
    return max([NOISE_TIME, float(np.median(known))] if known else [NOISE_TIME])


def steps_of(rows: Sequence[Row]) -> list[Found]:
    """Of one series, first those of the time."""
    def found(what: str, ones: list[Step]) -> list[Found]:
        return [Found(rows[one.before].case, rows[one.before].machine, what, rows[one.before], rows[one.after], one.ratio) for one in ones]

    counts = [math.nan if row.instructions is None else float(row.instructions) for row in rows]
    return found("time", steps([row.cpu_seconds for row in rows], noise_of(rows), LEAST_TIME)) + found(
        "instructions", steps(counts, NOISE_COUNT, LEAST_COUNT))


def machines(rows: Sequence[Row]) -> list[str]:
    """The one with the newest commit comes last."""
    newest: dict[str, str] = {}
    for row in rows:
        newest[row.machine] = max(newest.get(row.machine, ""), row.date)
    return sorted(newest, key=lambda name: (newest[name], name))


def places(rows: Sequence[Row]) -> dict[tuple[str, str], int]:
    """The place of each commit of each machine on the horizontal axis; between two machines, two places are free."""
    found: dict[tuple[str, str], int] = {}
    at = 0
    for machine in machines(rows):
        for _, commit in sorted({(row.date, row.commit) for row in rows if row.machine == machine and row.blocks}):
            found[machine, commit] = at
            at += 1
        at += 2
    return found


# --- the figure ------------------------------------------------------------------------------------------------------


def ticks(low: float, high: float) -> list[float]:
    """Three or four round numbers for a logarithmic axis."""
    if high / low < 3:
        return [x for x in matplotlib.ticker.MaxNLocator(4, steps=[1, 2, 2.5, 5, 10]).tick_values(low, high) if low <= x <= high]
    decades = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
    for subs in ((1, 1.5, 2, 3, 5, 7), (1, 2, 5), (1, 3), (1,)):
        found = [sub * 10.0**decade for decade in decades for sub in subs if low <= sub * 10.0**decade <= high]
        if len(found) <= 5:
            break
    return found


def vertical_axis(ax: Any, values: Sequence[float]) -> None:
    """Logarithmic, from the least to the largest of the values, with room above for what is written there."""
    low, high = min(values), max(values)
    wider = max(1.0, LEAST_SPAN * low / high) ** 0.5
    span = high / low * wider**2
    low, high = low / wider**1.3 / span**0.1, high * wider**0.7 * span**0.12  # more room below: there most factors are written
    ax.set_yscale("log")
    ax.yaxis.set_minor_locator(matplotlib.ticker.NullLocator())
    ax.set_yticks(marks := ticks(low, high), [f"{x:g}" for x in marks])
    ax.set_ylim(low, high)


def draw_series(ax: Any, rows: Sequence[Row], at: dict[tuple[str, str], int]) -> list[float]:
    """Of one machine; every value that was drawn, in milliseconds."""
    x = [at[row.machine, row.commit] for row in rows]
    ms = np.array([1e3 * row.cpu_seconds for row in rows])
    low, high = (1e3 * np.array([getattr(row, end) for row in rows]) for end in ("cpu_low", "cpu_high"))
    low, high = np.where(np.isnan(low), ms, low), np.where(np.isnan(high), ms, high)
    counted = [(x[i], row.instructions, ms[i]) for i, row in enumerate(rows) if row.instructions]
    drawn = [*low, *high]
    if counted:
        scaled = [count * counted[-1][2] / counted[-1][1] for _, count, _ in counted]
        ax.plot([place for place, _, _ in counted], scaled, color=COUNT, linewidth=0.9, marker="s", markersize=2.2, zorder=2)
        drawn += scaled
    ax.errorbar(x, ms, [ms - low, high - ms], color=TIME, linewidth=0.9, elinewidth=0.7, marker="o", markersize=2.4, zorder=3)
    return [float(value) for value in drawn]


def draw_steps(ax: Any, found: Sequence[Found], at: dict[tuple[str, str], int]) -> None:
    """A line halfway between the two commits, and its factor. Instructions get one of their own where the time has none there."""
    shown: dict[float, Found] = {}
    for one in found:  # those of the time come first
        shown.setdefault((at[one.machine, one.before.commit] + at[one.machine, one.after.commit]) / 2, one)
    width = (max(at.values()) + 1.4) / (72 * ax.get_position().width * ax.figure.get_figwidth())  # of a point, in places of commits
    for x, one in shown.items():
        colour = ALONE if one.what == "instructions" else SLOWER if one.ratio > 1 else FASTER
        ax.axvline(x, color=colour, linewidth=0.7, linestyle=style.DASHED, zorder=1)
        bottom, top = np.log(ax.get_ylim())
        high = (math.log(1e3 * one.after.cpu_seconds) - bottom) / (top - bottom) < 0.45  # the line to the right of it is low: there is room above
        crowded = any(x < other < x + 8 * width for other in shown)
        text = ax.annotate(one.words, (x, 0.92 if high else 0.03), xycoords=("data", "axes fraction"), xytext=(-1.5 if crowded else 1.5, 0),
                           textcoords="offset points", rotation=90, ha="right" if crowded else "left", va="top" if high else "bottom", fontsize=5.4,
                           color=colour, zorder=4)
        text.set_path_effects([matplotlib.patheffects.withStroke(linewidth=1.6, foreground="white")])


def panel(ax: Any, name: str, rows: Sequence[Row], at: dict[tuple[str, str], int], order: Sequence[str]) -> None:
    ax.set_title(name, fontsize=7, loc="left", pad=3)
    ax.grid(axis="x", visible=False)
    ones = [one for machine in order if (one := series(rows, name, machine))]
    vertical_axis(ax, [value for one in ones for value in draw_series(ax, one, at)])
    for one in ones:
        draw_steps(ax, steps_of(one), at)
    for letter, machine in zip(LETTERS, order):
        here = [place for (where, _), place in at.items() if where == machine]
        if len(order) > 1 and here:
            ax.text((min(here) + max(here)) / 2, 1.0, letter, transform=ax.get_xaxis_transform(), fontsize=6, color=style.GREY, ha="center", va="top")
            if machine != order[-1]:
                ax.axvspan(max(here) + 1, max(here) + 2, color="#EDEDED", linewidth=0, zorder=0)
    ax.set_xlim(-0.7, max(at.values()) + 0.7)


def labels(at: dict[tuple[str, str], int], most: int) -> dict[int, str]:
    """Short hashes at the places of commits: of all, or of every second, third, ... from the newest back."""
    known = sorted(((place, commit[:7]) for (_, commit), place in at.items()), reverse=True)
    return dict(known[::-(-len(known) // most)])


def legend() -> list[Any]:
    def entry(label: str, **look: Any) -> Any:
        return plt.Line2D([], [], label=label, linewidth=0.9, **look)

    return [entry("CPU time, with interval", color=TIME, marker="o", markersize=2.6),
            entry("instructions, scaled to the time of the newest commit", color=COUNT, marker="s", markersize=2.4),
            entry("faster", color=FASTER, linestyle=style.DASHED), entry("slower", color=SLOWER, linestyle=style.DASHED),
            entry("instructions alone", color=ALONE, linestyle=style.DASHED)]


def draw(rows: Sequence[Row], names: Sequence[str]) -> Any:
    """Of the cases that have rows, in this order. All panels share the horizontal axis."""
    at, order = places(rows), machines(rows)
    shown = [name for name in names if any(series(rows, name, machine) for machine in order)]
    columns = min(len(shown), 4 if len(shown) % 4 == 0 and len(shown) % 3 else 3)
    lines = -(-len(shown) // columns)
    figure, grid = plt.subplots(lines, columns, figsize=(style.DOUBLE_COLUMN, 0.75 + 1.25 * lines), squeeze=False)
    named = labels(at, MOST_LABELS // columns)
    for i, ax in enumerate(grid.flat):
        if i >= len(shown):
            ax.set_axis_off()
            continue
        panel(ax, shown[i], rows, at, order)
        last = i + columns >= len(shown)
        ax.set_xticks(list(named), list(named.values()) if last else [], rotation=90, fontsize=5.2, family="monospace")
    figure.supylabel("CPU time (ms)", fontsize=8)
    style.legend_above(figure, legend(), 5)
    return figure


def footnote(rows: Sequence[Row]) -> str:
    order = machines(rows)
    blocks = sorted({row.blocks for row in rows if row.blocks})
    count = str(blocks[0]) if len(blocks) == 1 else f"{blocks[0]} to {blocks[-1]}"
    where = "; ".join(f"{letter}: {name}" for letter, name in zip(LETTERS, order)) if len(order) > 1 else order[0]
    return (f"Commits from left to right, oldest first. Medians of {count} blocks, measured in turn; each axis is logarithmic, on its own. {where}. "
            "Steps are listed in tables/history_steps.")


# --- the table -------------------------------------------------------------------------------------------------------


def subject(commit: str) -> str:
    try:
        return builds.git("show", "--no-patch", "--format=%s", commit)
    except builds.NotBuilt:
        return "(not in this repository)"


def commits_between(before: str, after: str) -> str:
    try:
        return builds.git("rev-list", "--count", f"{before}..{after}")
    except builds.NotBuilt:
        return tables.NOTHING


def steps_table(found: Sequence[Found], several: bool, subject_of: Callable[[str], str],
                between: Callable[[str, str], str]) -> tuple[tables.Table, list[tables.Record]]:
    """In order of the commits. What changed between the same two commits stands together; time and instructions of a case are one line."""
    table = tables.Table("Steps in the history of timings", ["after", "not later than", "commits", "case", *(["machine"] if several else []), "time",
                                                             "instructions"], left=5 if several else 4)
    together: dict[tuple[str, str, str, str], dict[str, Found]] = {}
    for one in sorted(found, key=lambda one: (one.after.date, one.before.date)):
        together.setdefault((one.before.commit, one.after.commit, one.case, one.machine), {})[one.what] = one
    records: list[tables.Record] = []
    last = ("", "")
    for (before, after, case, machine), ones in together.items():
        texts = [f"{before[:7]} {subject_of(before)}", f"{after[:7]} {subject_of(after)}", between(before, after)]
        if (before, after) != last:
            table.rules.add(len(table.rows))
        change = [ones[what].words if what in ones else tables.NOTHING for what in ("time", "instructions")]
        table.rows.append([*(["", "", ""] if (before, after) == last else texts), case, *([machine] if several else []), *change])
        last = (before, after)
        records.append({"before": before, "before_subject": subject_of(before), "after": after, "after_subject": subject_of(after),
                        "commits": between(before, after), "case": case, "machine": machine,
                        **{f"{what}_ratio": ones[what].ratio if what in ones else math.nan for what in ("time", "instructions")}})
    table.notes = ["A step lies in one of the commits after the first and up to the second; `commits`: how many. `make bisect` finds which.",
                   f"Found by bench/tracking/steps.py: steps of the time by {100 * LEAST_TIME:.0f} % or more, of instructions by "
                   f"{100 * LEAST_COUNT:.0f} %. {tables.NOTHING}: no step, or not measured."]
    return table, records


def save(rows: Sequence[Row], out: Path, subject_of: Callable[[str], str] = subject,
         between: Callable[[str, str], str] = commits_between) -> list[Path]:
    """Writes <out>/figures/history and history_kernels (.pdf, .png) and <out>/tables/history_steps. ValueError where nothing was measured."""
    rows = [row for row in rows if row.blocks]
    if not rows:
        raise ValueError("the history has no times: measure some commits")
    kernels = [kernel.name for kernel in KERNELS]
    order = [case.name for case in cases()]
    known = list(dict.fromkeys([*order, *sorted({row.case for row in rows} - set(kernels))]))  # the last are no longer tracked
    paths: list[Path] = []
    for stem, names in (("history", known), ("history_kernels", kernels)):
        chosen = [row for row in rows if row.case in names]
        if chosen:
            paths += save_figure(draw(chosen, names), out, stem, "History of timings", footnote(chosen))
    every = [(name, machine) for machine in machines(rows) for name in [*known, *kernels]]
    found = [step for name, machine in every for step in steps_of(series(rows, name, machine))]
    return paths + tables.save(*steps_table(found, len(machines(rows)) > 1, subject_of, between), out, "history_steps")
