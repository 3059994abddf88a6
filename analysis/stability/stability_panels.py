"""Draws small panels for a few families of the stability suite: two measures against severity, one
above the other."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.lines import Line2D
from matplotlib.ticker import FixedFormatter, FixedLocator, NullLocator

from analysis.shared import scales, style
from analysis.stability.stability_families import Answer, Family, Label, Suite, look
from analysis.stability.stability_outcomes import Outcome

MOST: Final = 12  # panels at most
ACROSS: Final = 4
# In inches.
WIDE: Final = 1.34
TALL: Final = 0.86
PITCH: Final = 1.68
DEEP: Final = 0.2 + 2 * TALL + 0.08 + 0.36
LEFT: Final = 0.6
MARK: Final = "#D00000"
BEHIND: Final = "#C4C4C4"  # grey, for solvers that telling() does not choose
SHOWN: Final = 6  # solvers drawn in colour, at most
OURS: Final = {
    "cover": 3e6,
    "scan": 2e6,
    "surface_enclosure": 1e6,
}  # added to their score, so that they are chosen first


@dataclass(frozen=True)
class Measure:
    """The number that a frame shows for each answer. NaN is not drawn; infinity becomes a letter at
    the top."""

    name: str
    of: Callable[[Answer], float]
    guide: Callable[[Answer], float]  # a line for orientation; NaN: none
    stopped_at: Callable[
        [Answer], float
    ] = lambda answer: math.nan  # height of an open marker for a timeout; NaN: none


def choose(
    families: Sequence[Family], interest: Callable[[Family], float] = lambda family: 0.0
) -> list[Family]:
    """Returns the MOST families with the highest interest, then the most severities, in the order
    of the experiment."""
    among = sorted(families, key=lambda family: (-interest(family), -len(family.steps)))[:MOST]
    return [family for family in families if family in among]


def swept(suite: Suite) -> list[Family]:
    """Returns the families of valid input with at least two severities."""
    families = []
    for family in suite.families:
        answers = [answer for by_step in family.answers.values() for answer in by_step.values()]
        if (
            family.has_severities
            and len(set(family.severities)) > 1
            and all(answer.legal for answer in answers)
        ):
            families.append(family)
    return families


def telling(suite: Suite, families: Sequence[Family]) -> list[Label]:
    """Chooses at most SHOWN solvers, of different colours and markers: ours, then those that miss
    tight answers most often."""

    def score(pair: Label) -> float:
        answers = [
            answer
            for family in families
            for answer in family.finest(pair[1])
            if answer in family.asked(pair[1])
        ]
        return sum(
            1.0 + 9.0 * (answer.outcome == Outcome.WRONG)
            for answer in answers
            if answer.outcome != Outcome.TIGHT
        ) + (OURS.get(pair[0], 0.0) if answers else 0.0)

    chosen: list[Label] = []
    for pair in sorted(suite.labels, key=lambda pair: -score(pair)):
        looks, taken = look(*pair), [look(*label) for label in chosen]
        alike = any(
            looks.colour == earlier.colour or looks.marker == earlier.marker for earlier in taken
        )
        if len(chosen) < SHOWN and not alike and any(family.asked(pair[1]) for family in families):
            chosen.append(pair)
    return [pair for pair in suite.labels if pair in chosen]


def draw(
    suite: Suite,
    families: Sequence[Family],
    measures: tuple[Measure, Measure],
    notes: Sequence[str],
) -> Any:
    shown = telling(suite, families)
    entries = [handle(pair) for pair in shown]
    if any(
        family.asked(label)
        for family in families
        for _, label in suite.labels
        if (_, label) not in shown
    ):
        entries.append(
            Line2D([], [], color=BEHIND, linewidth=0.8, label="the others, in the table")
        )
    legend_rows = -(-max(1, len(entries)) // 4)
    height = (
        0.1
        + DEEP * max(1, -(-len(families) // ACROSS))
        + 0.145 * legend_rows
        + 0.14 * len(notes)
        + 0.12
    )
    figure = plt.figure(figsize=(style.DOUBLE_COLUMN, height))
    figure.set_layout_engine("none")
    for i, family in enumerate(families):
        left, floor = LEFT + (i % ACROSS) * PITCH, height - (i // ACROSS) * DEEP - 0.26 - 2 * TALL
        for measure, bottom in zip(measures, (floor + TALL + 0.08, floor)):
            ax = figure.add_axes(
                (
                    left / style.DOUBLE_COLUMN,
                    bottom / height,
                    WIDE / style.DOUBLE_COLUMN,
                    TALL / height,
                )
            )
            draw_frame(ax, suite, family, measure, shown)
            if i % ACROSS == 0:
                ax.set_ylabel(measure.name)
                ax.yaxis.set_label_coords(-0.3, 0.5)
            if bottom > floor:
                ax.set_title(
                    family.title
                    if family.title.startswith(family.kind)
                    else f"{family.title} ({family.kind})",
                    pad=3,
                )
                ax.tick_params(labelbottom=False)
            else:
                ax.set_xlabel("severity (no unit)", labelpad=1)
    figure.legend(
        handles=entries,
        loc="lower center",
        ncol=4,
        handlelength=2.2,
        fontsize=6.5,
        bbox_to_anchor=(0.5, (0.14 * len(notes) + 0.06) / height),
    )
    figure.text(
        0.5, 0.04 / height, "\n".join(notes), ha="center", va="bottom", fontsize=7, color=style.GREY
    )
    return figure


def handle(pair: Label) -> Any:
    looks = look(*pair)
    return Line2D(
        [],
        [],
        label=looks.entry,
        **(style.filled_marker(looks) | {"linestyle": looks.line, "linewidth": 0.9}),
    )


def draw_frame(
    ax: Any, suite: Suite, family: Family, measure: Measure, shown: Sequence[Label]
) -> None:
    answers = {}
    for pair in suite.labels:
        if family.asked(pair[1]):
            answers[pair] = [
                answer for answer in family.finest(pair[1]) if math.isfinite(answer.severity)
            ]
    everyone = [answer for solver_answers in answers.values() for answer in solver_answers]
    guide = {
        answer.severity: measure.guide(answer)
        for answer in everyone
        if math.isfinite(measure.guide(answer))
    }
    values = [measure.of(answer) for answer in everyone]
    values += [measure.stopped_at(answer) for answer in everyone]
    axis = scales.LogAxis(ax, [*filter(math.isfinite, values), *guide.values()], 5)
    if guide:
        along = sorted(guide)
        ax.plot(
            along,
            axis.place([guide[x] for x in along]),
            color="black",
            linewidth=0.8,
            linestyle=(0, (1, 1)),
            zorder=2,
        )
    lost: Counter[float] = Counter()
    for pair, solver_answers in answers.items():
        draw_line(ax, axis, pair, solver_answers, measure, lost, pair in shown)
    if lost:  # room for the letters
        low, high = ax.get_ylim()
        ax.set_ylim(low, high * (high / low) ** (0.09 * max(lost.values())))
    set_severities(ax, sorted({answer.severity for answer in everyone}), family)


def draw_line(
    ax: Any,
    axis: scales.LogAxis,
    pair: Label,
    answers: Sequence[Answer],
    measure: Measure,
    lost: Counter[float],
    front: bool,
) -> None:
    """Draws the line of a solver, and a letter at the top for each answer whose measure is
    infinite.

    A solver that is not in front is grey.
    """
    looks = look(*pair) if front else replace(look(*pair), colour=BEHIND, line="-")
    drawn = [
        (answer.severity, measure.of(answer), answer)
        for answer in answers
        if math.isfinite(measure.of(answer))
    ]
    if drawn:
        severities = [x for x, _, _ in drawn]
        ax.plot(
            severities,
            axis.place([y for _, y, _ in drawn]),
            color=looks.colour,
            linestyle=looks.line,
            linewidth=0.8,
            zorder=3 if front else 2.5,
        )
    for x, y, answer in drawn:
        kind = (
            style.open_marker
            if answer.outcome in (Outcome.STOPPED, Outcome.LOOSE)
            else style.filled_marker
        )
        if front:
            ax.plot(
                [x],
                axis.place([y]),
                zorder=4,
                clip_on=False,
                **kind(looks) | {"markersize": 0.7 * looks.size},
            )
        if answer.outcome == Outcome.WRONG:
            ax.plot(
                [x],
                axis.place([y]),
                zorder=5,
                clip_on=False,
                marker="s",
                markersize=7,
                markerfacecolor="none",
                markeredgewidth=1.1,
                markeredgecolor=MARK,
            )
    for answer in answers:
        letter = answer.letter or "?"
        if math.isfinite(measure.of(answer)) or answer.outcome in (
            Outcome.NOT_RUN,
            Outcome.NOT_APPLICABLE,
        ):
            continue
        at = measure.stopped_at(answer)
        if math.isfinite(at):
            ax.plot(
                [answer.severity],
                axis.place([at]),
                zorder=4,
                clip_on=False,
                **style.open_marker(looks) | {"markersize": 0.7 * looks.size},
            )
        elif not math.isnan(measure.of(answer)) or answer.outcome.badness > Outcome.STOPPED.badness:
            ax.annotate(
                "∞" if math.isinf(measure.of(answer)) else letter,
                (answer.severity, 1),
                (0, -3 - 5.5 * lost[answer.severity]),
                xycoords=("data", "axes fraction"),
                textcoords="offset points",
                ha="center",
                va="center",
                fontsize=5.5,
                fontweight="bold",
                color=style.shade(looks.colour, -0.4),
                annotation_clip=False,
                zorder=6,
                family="DejaVu Sans",
            )
            lost[answer.severity] += 1


def spread(severities: Sequence[float], apart: float) -> list[float]:
    """Thins out severities, so that any two differ by at least `apart` powers of ten. Earlier ones
    have priority."""
    kept: list[float] = []
    for severity in severities:
        if all(abs(math.log10(severity / earlier)) >= apart for earlier in kept):
            kept.append(severity)
    return sorted(kept)


def set_severities(ax: Any, severities: Sequence[float], family: Family) -> None:
    """Sets the axis of severities, with the severest at the right: logarithmic if all are
    positive."""
    if not severities:
        return
    first, last = severities[0], severities[-1]
    if first > 0:
        room = (last / first) ** 0.06
        ax.set_xlim(
            max(first / room, 1e-305), min(last * room, 1e305)
        )  # ticks beyond are not doubles
        ax.set_xscale(
            "log"
        )  # after the limits, because automatic limits could exceed the range of doubles
        if last / first >= 1e30:  # LogLocator would compute ticks beyond the range of doubles
            shown = spread(
                [severities[0], severities[-1], *severities[1:-1]], math.log10(last / first) / 4
            )
            ax.xaxis.set_major_locator(FixedLocator(shown))
            ax.xaxis.set_minor_locator(NullLocator())
            ax.xaxis.set_major_formatter(
                FixedFormatter([f"$10^{{{math.log10(x):.0f}}}$" for x in shown])
            )
        else:
            scales.log_ticks(ax.xaxis)
            if last / first >= 1e4:  # labels such as 10 to the minus 12 are wide
                ax.xaxis.get_major_locator().set_params(numticks=5)
        if last / first < 100:
            ax.set_xticks(severities, [f"{x:g}" for x in severities])
    else:
        ax.set_xlim(first - 0.06 * (last - first), last + 0.06 * (last - first))
    finite = [x for x in family.severities if math.isfinite(x)]
    if finite[-1] < finite[0]:
        ax.invert_xaxis()


def relative(value: float, diagonal: float) -> float:
    """Returns a length over the diagonal of A; the length itself if A is a single point."""
    return value / diagonal if diagonal > 0 else value


def largest(values: Sequence[tuple[float, Answer]]) -> tuple[float, Answer] | None:
    numbers = [pair for pair in values if not np.isnan(pair[0])]
    return max(numbers, key=lambda pair: pair[0]) if numbers else None
