"""Draws the history: a panel for each case, with the commits of each run in order; steps are marked, and listed in a table.

Writes figures/history and figures/history_kernels, tables/history_steps. history.py calls it.
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
from matplotlib.lines import Line2D

from analysis.shared import style, tables
from analysis.shared.report import save_figure
from bench.tracking import builds
from bench.tracking.cases import KERNELS, cases
from bench.tracking.history import Row, in_order
from bench.tracking.steps import Step, steps

LEAST_TIME: Final = 0.05  # smaller steps of the time are not marked: the place of code in memory moves some loops by about as much
LEAST_COUNT: Final = 0.01  # of instructions, which have no noise
NOISE_TIME: Final = 0.01  # noise_of() returns at least this
NOISE_COUNT: Final = 1e-4
LEAST_SPAN: Final = 1.6  # top over bottom of a panel's vertical axis: noise should look small
MOST_LABELS: Final = 78  # the most commits whose names fit a figure's width
MOST_RUNS: Final = 12  # the most runs that fit a figure
TIME, COUNT, SLOWER, FASTER, ALONE = "#0072B2", "#A8A8A8", "#C44100", "#007A58", "#707070"
PALE_TIME, PALE_COUNT, BETWEEN = "#8FBCD9", "#D4D4D4", "#EDEDED"
LETTERS: Final = "ABCDEFGHIJKL"  # names of runs
Session = tuple[str, str]  # a run: its start, and the machine


@dataclass(frozen=True)
class Found:
    """A step of a case in a run, between rows of the same session."""

    case: str
    what: str  # "time" or "instructions"
    before: Row
    after: Row
    ratio: float

    @property
    def words(self) -> str:
        more, factor = self.ratio > 1, max(self.ratio, 1 / self.ratio)
        word = ("slower" if more else "faster") if self.what == "time" else ("more" if more else "fewer")
        return f"{factor:.2f}× {word}" if factor < 9.95 else f"{factor:.0f}× {word}"


def series(rows: Sequence[Row], case: str, session: Session) -> list[Row]:
    """Returns the rows of a case in a run, in order, without rows whose shapes differ from the newest row of this machine."""
    here = [row for row in rows if row.case == case and row.machine == session[1] and row.blocks]
    newest = max(here, key=lambda row: row.measured, default=None)
    return [row for row in here if row.session == session and newest and row.shapes == newest.shapes]


def noise_of(rows: Sequence[Row]) -> float:
    """Returns the median over the rows of the relative half-width of the interval; at least NOISE_TIME."""
    known = [(row.cpu_high - row.cpu_low) / 2 / row.cpu_seconds for row in rows if not math.isnan(row.cpu_high)]
    return max([NOISE_TIME, float(np.median(known))] if known else [NOISE_TIME])


def steps_of(rows: Sequence[Row]) -> list[Found]:
    """Returns the steps of one series, steps of the time first."""
    def found(what: str, ones: list[Step]) -> list[Found]:
        return [Found(rows[one.before].case, what, rows[one.before], rows[one.after], one.ratio) for one in ones]

    counts = [math.nan if row.instructions is None else float(row.instructions) for row in rows]
    return found("time", steps([row.cpu_seconds for row in rows], noise_of(rows), LEAST_TIME)) + found(
        "instructions", steps(counts, NOISE_COUNT, LEAST_COUNT))


def sessions(rows: Sequence[Row]) -> list[Session]:
    """Returns the runs by machine, from the oldest; the machine with the newest run comes last."""
    newest = {row.machine: max(other.measured for other in rows if other.machine == row.machine) for row in rows}
    return sorted({row.session for row in rows}, key=lambda session: (newest[session[1]], session[1], session[0]))


def main_sessions(rows: Sequence[Row]) -> set[Session]:
    """Returns the newest run and the run with the most commits."""
    commits = {session: len({row.commit for row in rows if row.session == session}) for session in sessions(rows)}
    return {max(commits), max(commits, key=lambda session: (commits[session], session))} if commits else set()


def with_room(rows: Sequence[Row]) -> list[Row]:
    """Keeps the rows of at most MOST_RUNS runs: the main ones, then the newest."""
    main = main_sessions(rows)
    shown = sorted(sessions(rows), key=lambda session: (session in main, session))[-MOST_RUNS:]
    return [row for row in rows if row.session in shown]


def places(rows: Sequence[Row]) -> dict[tuple[Session, str], int]:
    """Returns the x coordinate of each commit of each run: 0, 1, 2, ..., with a gap of one between runs."""
    found: dict[tuple[Session, str], int] = {}
    for free, session in enumerate(sessions(rows)):
        for commit in dict.fromkeys(row.commit for row in rows if row.session == session and row.blocks):
            found[session, commit] = len(found) + free
    return found


# --- the figure ------------------------------------------------------------------------------------------------------


def ticks(low: float, high: float) -> list[float]:
    """Returns three or four round numbers for a logarithmic axis."""
    if high / low < 3:
        return [x for x in matplotlib.ticker.MaxNLocator(4, steps=[1, 2, 2.5, 5, 10]).tick_values(low, high) if low <= x <= high]
    decades = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
    for subs in ((1, 1.5, 2, 3, 5, 7), (1, 2, 5), (1, 3), (1,)):
        found = [sub * 10.0**decade for decade in decades for sub in subs if low <= sub * 10.0**decade <= high]
        if len(found) <= 5:
            break
    return found


def vertical_axis(ax: Any, values: Sequence[float]) -> None:
    """Makes the axis logarithmic, from the least to the largest value, with room above for labels."""
    low, high = min(values), max(values)
    wider = max(1.0, LEAST_SPAN * low / high) ** 0.5
    span = high / low * wider**2
    low, high = low / wider**1.3 / span**0.1, high * wider**0.7 * span**0.12  # more room below, where most factors are written
    ax.set_yscale("log")
    ax.yaxis.set_minor_locator(matplotlib.ticker.NullLocator())
    ax.set_yticks(marks := ticks(low, high), [f"{x:g}" for x in marks])
    ax.set_ylim(low, high)


EDGE: Final = [matplotlib.patheffects.withStroke(linewidth=1.6, foreground="white")]
Points = list[tuple[float, float]]  # x, and milliseconds or a fraction of the height
SIZE: Final = (7.0, 31.0)  # width and height of the text at a step, in points


def draw_series(ax: Any, rows: Sequence[Row], at: dict[tuple[Session, str], int], pale: bool = False) -> Points:
    """Draws one run, and returns points along the drawn curves, in milliseconds."""
    time_colour, count_colour = (PALE_TIME, PALE_COUNT) if pale else (TIME, COUNT)
    x = [at[row.session, row.commit] for row in rows]
    ms = np.array([1e3 * row.cpu_seconds for row in rows])
    low, high = (1e3 * np.array([getattr(row, end) for row in rows]) for end in ("cpu_low", "cpu_high"))
    low, high = np.where(np.isnan(low), ms, low), np.where(np.isnan(high), ms, high)
    counted = [(x[i], row.instructions, ms[i]) for i, row in enumerate(rows) if row.instructions]
    points = along(x, ms)
    if counted:
        places, scaled = [place for place, _, _ in counted], [count * counted[-1][2] / counted[-1][1] for _, count, _ in counted]
        ax.plot(places, scaled, color=count_colour, linewidth=0.9, marker="s", markersize=2.2, zorder=2)
        points += along(places, scaled)
    ax.errorbar(x, ms, [ms - low, high - ms], color=time_colour, linewidth=0.9, elinewidth=0.7, marker="o", markersize=2.4, zorder=3)
    return points + [(place, float(y)) for place, *ends in zip(x, low, high) for y in np.geomspace(ends[0], ends[1], 9)]


def along(x: Sequence[float], y: Any) -> Points:
    fine = np.linspace(x[0], x[-1], 8 * round(x[-1] - x[0]) + 1)
    return [(float(place), float(value)) for place, value in zip(fine, np.exp(np.interp(fine, x, np.log(y))))]


def draw_steps(ax: Any, found: Sequence[Found], at: dict[tuple[Session, str], int], points: Points) -> None:
    """Draws a line halfway between the two commits of each step, and its factor where that covers the fewest points.

    Instructions get their own line only if the time has none there.
    """
    shown: dict[float, Found] = {}
    for one in found:  # steps of the time come first
        shown.setdefault((at[one.before.session, one.before.commit] + at[one.after.session, one.after.commit]) / 2, one)
    box = ax.get_position()
    limits: tuple[float, float] = ax.get_xlim()
    wide, high = ((limits[1] - limits[0]) * SIZE[0] / (72 * box.width * ax.figure.get_figwidth()),
                  SIZE[1] / (72 * box.height * ax.figure.get_figheight()))
    ceiling = 0.97 if len({session for session, _ in at}) == 1 else 0.9  # the letters of the runs are above it
    bottom, top = np.log(ax.get_ylim())
    taken = [(place, (math.log(y) - bottom) / (top - bottom)) for place, y in points]
    taken += [(x, y) for x in shown for y in np.linspace(0, 1, 9)]

    def cost(left: float, low: float) -> int:
        inside: int = sum(left < place < left + wide and low < y < low + high for place, y in taken)
        return inside + (0 if limits[0] <= left and left + wide <= limits[1] else 100)

    for x, one in shown.items():
        colour = ALONE if one.what == "instructions" else SLOWER if one.ratio > 1 else FASTER
        ax.axvline(x, color=colour, linewidth=0.7, linestyle=style.DASHED, zorder=1)
        spots = [(left, low) for low in (0.03, ceiling - high, *np.linspace(0.1, ceiling - 0.07 - high, 6)) for left in (x, x - wide)]
        left, low = min(spots, key=lambda spot: cost(*spot))
        taken += [(left + wide * i / 8, low + high * j / 16) for i in range(1, 8) for j in range(17)]
        text = ax.annotate(one.words, (left + wide / 2, low), xycoords=("data", "axes fraction"), rotation=90, ha="center", va="bottom",
                           fontsize=5.4, color=colour, zorder=4)
        text.set_path_effects(EDGE)


def panel(ax: Any, name: str, rows: Sequence[Row], at: dict[tuple[Session, str], int]) -> tuple[list[Found], Points]:
    """Draws all but the steps. Returns the steps and points for draw_steps(), which needs the final layout of the figure."""
    ax.set_title(name, fontsize=7, loc="left", pad=3)
    ax.grid(axis="x", visible=False)
    order, main = sessions(rows), main_sessions(rows)
    ones = [one for session in order if (one := series(rows, name, session))]
    points = [point for one in ones for point in draw_series(ax, one, at, one[0].session not in main)]
    vertical_axis(ax, [value for _, value in points])
    for letter, session in zip(LETTERS, order if len(order) > 1 else []):
        here = [place for (whose, _), place in at.items() if whose == session]
        text = ax.text((min(here) + max(here)) / 2, 1.0, letter, transform=ax.get_xaxis_transform(), fontsize=6, color=style.GREY, ha="center",
                       va="top", zorder=5)
        text.set_path_effects(EDGE)
        if session != order[-1]:
            ax.axvspan(max(here) + 0.7, max(here) + 1.3, color=BETWEEN, linewidth=0, zorder=0)
    ax.set_xlim(-0.7, max(at.values()) + 0.7)
    return [step for one in ones for step in steps_of(one)], points


def labels(at: dict[tuple[Session, str], int], most: int) -> dict[int, str]:
    """Returns short hashes by x coordinate: of all commits, or of every second, third, ... from the newest back."""
    known = sorted(((place, commit[:7]) for (_, commit), place in at.items()), reverse=True)
    return dict(known[::-(-len(known) // most)])


def legend(pale: bool) -> list[Any]:
    def entry(label: str, **look: Any) -> Any:
        return Line2D([], [], label=label, linewidth=0.9, **look)

    return [entry("CPU time, with interval", color=TIME, marker="o", markersize=2.6),
            entry("instructions, scaled to the time of the newest commit", color=COUNT, marker="s", markersize=2.4),
            *([entry("CPU time in other runs", color=PALE_TIME, marker="o", markersize=2.6)] if pale else []),
            entry("faster", color=FASTER, linestyle=style.DASHED), entry("slower", color=SLOWER, linestyle=style.DASHED),
            entry("instructions alone", color=ALONE, linestyle=style.DASHED)]


def draw(rows: Sequence[Row], names: Sequence[str]) -> Any:
    """Draws the cases that have rows, in this order. All panels share the horizontal axis."""
    at, order = places(rows), sessions(rows)
    shown = [name for name in names if any(series(rows, name, session) for session in order)]
    columns = min(len(shown), 4 if len(shown) % 4 == 0 and len(shown) % 3 else 3)
    lines = -(-len(shown) // columns)
    figure, grid = plt.subplots(lines, columns, figsize=(style.DOUBLE_COLUMN, 0.75 + 1.25 * lines), squeeze=False)
    named = labels(at, MOST_LABELS // columns)
    panels: dict[Any, tuple[list[Found], Points]] = {}
    for i, ax in enumerate(grid.flat):
        if i >= len(shown):
            ax.set_axis_off()
            continue
        panels[ax] = panel(ax, shown[i], rows, at)
        last = i + columns >= len(shown)
        ax.set_xticks(list(named), list(named.values()) if last else [], rotation=90, fontsize=5.2, family="monospace")
    figure.supylabel("CPU time (ms)", fontsize=8)
    entries = legend(len(order) > len(main_sessions(rows)))
    style.legend_above(figure, entries, len(entries) if len(entries) < 6 else 3)
    figure.draw_without_rendering()
    for ax, (found, points) in panels.items():
        draw_steps(ax, found, at, points)
    return figure


def minute(time: str) -> str:
    return time[:16].replace("T", " ")


def footnote(rows: Sequence[Row], left_out: int = 0) -> str:
    order = sessions(rows)
    blocks = sorted({row.blocks for row in rows if row.blocks})
    count = str(blocks[0]) if len(blocks) == 1 else f"{blocks[0]} to {blocks[-1]}"
    if len(order) == 1:
        where = f"One run, of {minute(order[0][0])} UTC, on {order[0][1]}."
    else:
        runs = {machine: [f"{letter} ({minute(begun)})" for letter, (begun, one) in zip(LETTERS, order) if one == machine] for _, machine in order}
        where = f"Runs (UTC): {'; '.join(', '.join(ones) + ' on ' + machine for machine, ones in runs.items())}. Times of different runs are not comparable."
        where += f" {left_out} older runs are not shown." if left_out else ""
    return (f"Commits from left to right, oldest first. Medians of {count} blocks, measured in turn; each axis has a logarithmic scale of its own. {where} "
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


def steps_table(found: Sequence[Found], subject_of: Callable[[str], str],
                between: Callable[[str, str], str]) -> tuple[tables.Table, list[tables.Record]]:
    """Lists steps in the order of `found`. Changes between the same two commits are grouped; time and instructions of a case share a line."""
    where = [title for title, i in (("machine", 1), ("measured", 0)) if len({one.after.session[i] for one in found}) > 1]
    table = tables.Table("Steps in the history of timings", ["after", "not later than", "commits", "case", *where, "time", "instructions"],
                         left=4 + len(where))
    together: dict[tuple[str, str, str, Session], dict[str, Found]] = {}
    for one in found:
        together.setdefault((one.before.commit, one.after.commit, one.case, one.after.session), {})[one.what] = one
    records: list[tables.Record] = []
    last = ("", "")
    for (before, after, case, (begun, machine)), ones in together.items():
        texts = [f"{before[:7]} {subject_of(before)}", f"{after[:7]} {subject_of(after)}", between(before, after)]
        if (before, after) != last:
            table.rules.add(len(table.rows))
        run = [{"machine": machine, "measured": minute(begun)}[title] for title in where]
        change = [ones[what].words if what in ones else tables.NOTHING for what in ("time", "instructions")]
        table.rows.append([*(["", "", ""] if (before, after) == last else texts), case, *run, *change])
        last = (before, after)
        records.append({"before": before, "before_subject": subject_of(before), "after": after, "after_subject": subject_of(after),
                        "commits": between(before, after), "case": case, "machine": machine, "measured": begun,
                        **{f"{what}_ratio": ones[what].ratio if what in ones else math.nan for what in ("time", "instructions")}})
    table.notes = ["A step lies in one of the commits after the first and up to the second; `commits`: how many there are. `make bisect` finds the right "
                   "one.",
                   "If the time has a step and the instructions have none, the same work took more or less time, because of memory or the placement of code "
                   "and data.",
                   f"Found by bench/tracking/steps.py: steps of the time by {100 * LEAST_TIME:.0f} % or more, of instructions by "
                   f"{100 * LEAST_COUNT:.0f} %. {tables.NOTHING}: no step, or not measured."]
    return table, records


def save(rows: Sequence[Row], out: Path, subject_of: Callable[[str], str] = subject,
         between: Callable[[str, str], str] = commits_between) -> list[Path]:
    """Writes <out>/figures/history and history_kernels (.pdf, .png) and <out>/tables/history_steps. Raises ValueError if nothing
    was measured.
    """
    rows = [row for row in rows if row.blocks]
    if not rows:
        raise ValueError("the history has no times: measure some commits")
    place = {commit: i for i, commit in enumerate(in_order({row.commit: row.date for row in rows}))}
    rows = sorted(rows, key=lambda row: place[row.commit])
    kernels = [kernel.name for kernel in KERNELS]
    order = [case.name for case in cases()]
    known = list(dict.fromkeys([*order, *sorted({row.case for row in rows} - set(kernels))]))  # the last ones are no longer tracked
    paths: list[Path] = []
    for stem, names in (("history", known), ("history_kernels", kernels)):
        every = [row for row in rows if row.case in names]
        if chosen := with_room(every):
            left_out = len(sessions(every)) - len(sessions(chosen))
            paths += save_figure(draw(chosen, names), out, stem, "History of timings", footnote(chosen, left_out))
    found = [step for session in sessions(rows) for name in [*known, *kernels] for step in steps_of(series(rows, name, session))]
    found.sort(key=lambda one: (place[one.after.commit], place[one.before.commit]))
    return paths + tables.save(*steps_table(found, subject_of, between), out, "history_steps")
