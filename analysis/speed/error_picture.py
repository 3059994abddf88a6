"""The figure of `error_vs_time`: a panel per scene, gap above and true error below over time, in
rows by kind of shape."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Final

import matplotlib.pyplot as plt
import numpy as np

from analysis.shared import numerals, scales, style
from analysis.shared.columns import Floats
from analysis.shared.drawable import make_drawable
from analysis.shared.results import Results
from analysis.speed import error_curves
from analysis.speed.error_curves import Answer, Curve, Panel, Series

DOMAINS: Final = {"mesh": "Meshes", "points": "Point sets", "surface": "Surfaces"}
STAIRS: Final[dict[str, Any]] = {"color": "#A8A8A8", "linewidth": 1.4}
LEGENDS: Final[dict[str, Any]] = {"handlelength": 2.6, "borderpad": 0, "labelspacing": 0.25}
LETTER: Final = 0.24  # space above the curves for the panel's letter, as a fraction of the axis
# In inches.
LEFT, PITCH, WIDE, TALL, BETWEEN, TITLE, BELOW, LEGEND = (
    0.66,
    2.19,
    1.82,
    0.86,
    0.07,
    0.2,
    0.335,
    0.125,
)


@dataclass
class Shown:
    """The contents of a panel."""

    panel: Panel
    rows: list[int]
    answers: list[Answer]
    curves: dict[Series, list[Curve]]
    least: float  # smaller gaps are drawn in the grey area
    floor: float  # smaller errors are drawn in the grey area
    lost: list[tuple[Series, str, str]] = field(
        default_factory=list
    )  # failures, as lost_of() returns them


def shown_of(results: Results, panel: Panel, rows: list[int]) -> Shown:
    """Collects the contents of a panel."""
    answers = error_curves.answers_of(results, rows)
    least = error_curves.least_shown(results)
    floor = max([least, *(error_curves.reference_width(results, row) for row in rows[:1])])
    return Shown(
        panel,
        rows,
        answers,
        error_curves.curves_of(results, rows),
        least,
        floor,
        lost_of(results, rows),
    )


def lost_of(results: Results, rows: list[int]) -> list[tuple[Series, str, str]]:
    """Returns the failures of a panel: series, status, and the number of tolerances (empty for
    all).

    Solvers whose accuracy depends on a resolution do not fail by missing the tolerance; they get an
    open marker.
    """
    cases, failures, tolerances = (
        results.cases,
        dict[tuple[Series, str], set[float]](),
        dict[Series, set[float]](),
    )
    for row in rows:
        series, status = error_curves.series_of(results, row), str(cases.status[row])
        tolerances.setdefault(series, set()).add(float(cases.tolerance[row]))
        if status != "ok" and not (error_curves.joined(series) and results.is_bounded(row)):
            failures.setdefault((series, status), set()).add(float(cases.tolerance[row]))
    return [
        (series, status, f"{len(at)}" if at != tolerances[series] else "")
        for (series, status), at in sorted(failures.items())
    ]


def domain_of(results: Results, panel: Panel) -> str:
    """Returns the kind of the shapes of a panel; empty if A and B differ in kind."""
    kinds = dict(zip(results.models.name, results.models.kind))
    row = results.rows(scene=panel[0], pose_index=panel[1])[0]
    both = {
        str(kinds.get(model, ""))
        for model in (results.cases.source[row], results.cases.target[row])
    }
    return DOMAINS.get(both.pop(), "") if len(both) == 1 else ""


def bands_of(results: Results, panels: Sequence[Panel]) -> list[tuple[str, list[Panel]]]:
    """Returns the rows of the figure, each with as many panels of one kind of shapes as fit its
    width."""
    across = max(1, int((style.width() - LEFT + PITCH - WIDE) / PITCH))
    by_domain: dict[str, list[Panel]] = {}
    for panel in panels:
        by_domain.setdefault(domain_of(results, panel), []).append(panel)
    return [
        (domain, in_domain[i : i + across])
        for domain, in_domain in by_domain.items()
        for i in range(0, len(in_domain), across)
    ]


def draw(
    results: Results,
    panels: Sequence[Panel],
    rows_of: dict[Panel, list[int]],
    titles: dict[Panel, str],
    footnote: str = "",
) -> Any:
    """Draws all panels at computed positions; a layout engine would shrink the frames to fit the
    marks in their margins."""
    bands = []
    for domain, some in bands_of(results, panels):
        bands.append((domain, [shown_of(results, panel, rows_of[panel]) for panel in some]))
    width = style.width()
    figure = plt.figure(figsize=(width, 1.0))
    figure.set_layout_engine("none")
    legends = [style.handles(style.order(series)) for series in _entries(bands)]
    columns = [_columns(figure, handles) for handles in legends]
    notes = textwrap.wrap(" ".join(filter(None, [_key(bands), footnote])), int(24 * width))
    tall = [
        TITLE
        + 2 * TALL
        + BETWEEN
        + BELOW
        + LEGEND * -(-len(handles) // count)
        + 0.03 * bool(handles)
        for handles, count in zip(legends, columns)
    ]
    height = top = sum(tall) + 0.12 * len(notes) + 0.05
    figure.set_figheight(height)
    for (domain, band), handles, count, inches in zip(bands, legends, columns, tall):
        _draw_band(figure, results, band, titles, top)
        middle, below = top - TITLE - TALL - BETWEEN / 2, top - TITLE - 2 * TALL - BETWEEN - BELOW
        figure.text(
            0.085 / width,
            middle / height,
            domain,
            rotation=90,
            va="center",
            ha="center",
            fontsize=9,
            fontweight="bold",
        )
        if handles:
            figure.legend(
                handles=handles,
                loc="upper center",
                ncol=count,
                bbox_to_anchor=(0.5, below / height),
                **LEGENDS,
            )
        top -= inches
    figure.text(
        0.5,
        0.04 / height,
        "\n".join(notes),
        ha="center",
        va="bottom",
        fontsize=6.5,
        color=style.GREY,
        linespacing=1.15,
    )
    return figure


def _columns(figure: Any, handles: list[Any]) -> int:
    """Returns the number of legend columns that fit the figure, at most five."""
    for count in range(min(5, len(handles)), 1, -1):
        legend = figure.legend(handles=handles, ncol=count, **LEGENDS)
        make_drawable(legend)
        wide = legend.get_window_extent(figure.canvas.get_renderer()).width
        legend.remove()
        if wide <= figure.bbox.width:
            return count
    return 1


def _entries(bands: list[tuple[str, list[Shown]]]) -> list[list[Series]]:
    """Returns the legend entries of each row. Only the last row of each kind of shapes has a
    legend, for all of them."""
    of: dict[str, list[Series]] = {}
    for domain, band in bands:
        of[domain] = list(
            dict.fromkeys(
                [*of.get(domain, []), *(series for shown in band for series in _series(shown))]
            )
        )
    last = {domain: i for i, (domain, _) in enumerate(bands)}
    return [of[domain] if i == last[domain] else [] for i, (domain, _) in enumerate(bands)]


def _series(shown: Shown) -> list[Series]:
    answered = [answer.series for answer in shown.answers]
    lost = [series for series, *_ in shown.lost]
    return style.order([*answered, *shown.curves, *lost])


def _draw_band(
    figure: Any, results: Results, band: list[Shown], titles: dict[Panel, str], top: float
) -> None:
    width, height = figure.get_size_inches()
    scale = _scale(results, band)
    for i, shown in enumerate(band):
        left, floor = LEFT + i * PITCH, top - TITLE - 2 * TALL - BETWEEN
        below, above = (
            figure.add_axes((left / width, y / height, WIDE / width, TALL / height))
            for y in (floor, floor + TALL + BETWEEN)
        )
        above.sharex(below)
        below.set_xscale("log")
        for ax, floor, room in ((above, shown.least, 0.04), (below, shown.floor, LETTER)):
            scale.apply(ax, floor, room, labels=i == 0)
        _tolerances(above, results, shown)
        _draw_gap(above, scale, results, shown)
        _draw_error(below, scale, results, shown)
        scales.log_ticks(below.xaxis)
        above.tick_params(labelbottom=False)
        above.set_title(titles[shown.panel], pad=3)
        below.set_xlabel("prepare + solve (s)", labelpad=1)
        style.margin_marks(
            above,
            [
                (style.look(*series), style.status_letter(status) + at)
                for series, status, at in shown.lost
            ],
            height=72 * (2 * TALL + BETWEEN),
        )
        if i == 0:
            for ax, name in ((above, "gap"), (below, "true error")):
                ax.set_ylabel(f"{name} / diagonal")
                ax.yaxis.set_label_coords(-0.21, 0.5)


@dataclass(frozen=True)
class Scale:
    """A logarithmic axis of lengths, the same in all frames of a row.

    Each frame has a *floor*: smaller lengths are all drawn at one height in a grey area below it.
    """

    least: float
    low: int  # decades
    high: int

    @property
    def decades(self) -> int:
        return self.high - self.low

    def apply(self, ax: Any, floor: float, room: float, labels: bool) -> None:
        """Sets limits and ticks. `room` is the free space at the top, as a fraction of the axis."""
        ax.set_yscale("log")
        ax.minorticks_off()
        step = max(1, -(-self.decades // 4))
        ticks = [10.0**decade for decade in range(self.high, self.low, -step)]
        names = [
            f"$10^{{{round(np.log10(tick))}}}$" if tick < 1 else f"{tick:g}" for tick in ticks
        ] + ["less"]
        ax.set_yticks([*ticks, self.inside(self.least)], names if labels else [""] * len(names))
        bottom = self.least * 10.0 ** (-0.1 * self.decades)
        ax.set_ylim(bottom, 10.0 ** (self.high + room * self.decades))
        ax.axhspan(bottom, floor, color="#EBEBEB", linewidth=0, zorder=0)
        if floor > 3 * self.least:
            ax.text(
                0.5,
                np.sqrt(self.least * floor),
                "reference",
                transform=ax.get_yaxis_transform(),
                ha="center",
                va="center",
                fontsize=6,
                color="#7A7A7A",
                zorder=1,
            )

    def inside(self, floor: float) -> float:
        """Returns the height at which lengths below the floor are drawn."""
        return float(floor * 10.0 ** (-0.05 * self.decades))

    def place(self, values: Any, floor: float) -> Floats:
        x = np.asarray(values, dtype=np.float64)
        return np.where(x <= floor, self.inside(floor), x)


def _scale(results: Results, band: list[Shown]) -> Scale:
    values = [np.array([answer.gap for shown in band for answer in shown.answers])]
    for shown in band:
        for answer in shown.answers:
            errors = error_curves.errors_of(results, answer.case)
            values += [errors.middle, errors.lower]
        for curves in shown.curves.values():
            for curve in curves:
                size = results.length_unit(curve.case)
                values.append((curve.upper - curve.lower) / size)
                values.append(
                    error_curves.errors(results, curve.case, curve.lower, curve.upper).middle
                )
    least = band[0].least
    low, x = int(np.floor(np.log10(least))), np.concatenate(values)
    x = x[np.isfinite(x) & (x > least)]
    return Scale(least, low, max(low + 1, int(np.ceil(np.log10(x.max()))) if len(x) else 0))


def _tolerances(ax: Any, results: Results, shown: Shown) -> None:
    """Marks the requested tolerances with ticks and faint lines."""
    cases = results.cases
    tolerances = {
        float(cases.tolerance_absolute[row] / results.length_unit(row))
        for row in shown.rows
        if not error_curves.joined(error_curves.series_of(results, row))
    }
    for tolerance in sorted(tolerances):
        if not tolerance > 0:
            continue
        ax.axhline(tolerance, color="#C9C9C9", linewidth=0.4, linestyle=(0, (2, 2)), zorder=0.6)
        ax.plot(
            [0, 0.022],
            [tolerance] * 2,
            transform=ax.get_yaxis_transform(),
            color="black",
            linewidth=0.6,
            zorder=5,
            clip_on=False,
        )


def _line(ax: Any, series: Series, seconds: Floats, values: Floats, **more: Any) -> None:
    looks = style.look(*series)
    ax.plot(
        seconds,
        values,
        **{
            "color": looks.colour,
            "linestyle": looks.line,
            "linewidth": 0.8,
            "alpha": 0.85,
            "zorder": 2,
            "drawstyle": "steps-post",
            **more,
        },
    )


def _band(
    ax: Any,
    scale: Scale,
    floor: float,
    series: Series,
    lines: list[tuple[Floats, Floats]],
    **more: Any,
) -> None:
    """Draws a single line, or for several seeds their median and a band from minimum to maximum."""
    lines = [(x, y) for x, y in lines if len(x)]
    if not lines:
        return
    seconds, least, middle, most = error_curves.band(lines)
    _line(ax, series, seconds, scale.place(middle, floor), **more)
    if len(lines) > 1:
        ax.fill_between(
            seconds,
            scale.place(least, floor),
            scale.place(most, floor),
            step="post",
            color=style.look(*series).colour,
            alpha=0.22,
            linewidth=0,
            zorder=1.5,
        )


def _joined(
    ax: Any, scale: Scale, floor: float, answers: list[Answer], heights: dict[int, float]
) -> None:
    """Draws the answers of a series at several resolutions as one line."""
    for series in dict.fromkeys(
        answer.series for answer in answers if error_curves.joined(answer.series)
    ):
        points = sorted(
            (answer.time.value, heights[answer.case])
            for answer in answers
            if answer.series == series
        )
        looks = style.look(*series)
        times = [x for x, _ in points]
        values = [y for _, y in points]
        ax.plot(
            times,
            scale.place(values, floor),
            color=looks.colour,
            linestyle=looks.line,
            linewidth=0.8,
            zorder=2,
        )


def _marker(ax: Any, answer: Answer, at: float) -> None:
    looks = style.look(*answer.series)
    style.interval(ax, answer.time, at, color=looks.colour, linewidth=1.0, zorder=3)
    marker = style.filled_marker(looks) if answer.ok else style.open_marker(looks)
    if answer.read_off:
        marker |= {"markersize": 0.55 * looks.size, "markeredgewidth": 0.2 if answer.ok else 0.6}
    ax.plot([answer.time.value], [at], zorder=4 if answer.read_off else 4.5, **marker)


def _draw_gap(ax: Any, scale: Scale, results: Results, shown: Shown) -> None:
    floor, front = shown.least, error_curves.stairs(shown.answers, shown.least)
    ax.plot(
        front[0],
        scale.place(front[1], floor),
        drawstyle="steps-post",
        zorder=1,
        gid="front",
        **STAIRS,
    )
    for series, curves in shown.curves.items():
        bounded = [(curve, np.isfinite(curve.upper)) for curve in curves]
        size = results.length_unit(curves[0].case)
        _band(
            ax,
            scale,
            floor,
            series,
            [
                (curve.seconds[has], (curve.upper - curve.lower)[has] / size)
                for curve, has in bounded
            ],
        )
    _joined(ax, scale, floor, shown.answers, {answer.case: answer.gap for answer in shown.answers})
    for answer in shown.answers:
        _marker(ax, answer, float(scale.place(answer.gap, floor)))


def _draw_error(ax: Any, scale: Scale, results: Results, shown: Shown) -> None:
    """Draws the error of the middle of each interval, with a bar between the errors of its two
    bounds.

    Without an upper bound, draws the error of the lower bound.
    """
    for series, curves in shown.curves.items():
        middles, lowers = [], []
        for curve in curves:
            has, errors = np.isfinite(curve.upper), error_curves.errors(
                results, curve.case, curve.lower, curve.upper
            )
            middles.append((curve.seconds[has], errors.middle[has]))
            until = int(np.argmax(has)) if has.any() else len(has)
            lowers.append(
                (curve.seconds[: until + 1], errors.lower[: until + 1])
                if until
                else (curve.seconds[:0], errors.lower[:0])
            )
        _band(ax, scale, shown.floor, series, middles)
        _band(ax, scale, shown.floor, series, lowers, linestyle=(0, (0.8, 1.1)), linewidth=1.0)
    heights = {}
    for answer in shown.answers:
        errors = error_curves.errors_of(results, answer.case)
        if not np.isfinite(errors.middle[0]):
            continue  # no certified solver has an answer
        heights[answer.case] = float(errors.middle[0])
        ends = scale.place(np.sort([errors.lower[0], errors.upper[0]]), shown.floor)
        ax.plot(
            [answer.time.value] * 2,
            ends,
            color=style.look(*answer.series).colour,
            linewidth=0.6,
            alpha=0.55,
            zorder=2.5,
        )
        _marker(ax, answer, float(scale.place(errors.middle[0], shown.floor)))
    _joined(
        ax,
        scale,
        shown.floor,
        [answer for answer in shown.answers if answer.case in heights],
        heights,
    )


def _key(bands: list[tuple[str, list[Shown]]]) -> str:
    """Returns the text that explains the lines, markers and letters in the figure."""
    all_shown = [shown for _, band in bands for shown in band]
    answers = [answer for shown in all_shown for answer in shown.answers]
    curves = [curve for shown in all_shown for some in shown.curves.values() for curve in some]
    lines = []
    if curves:
        lines.append("one traced run, scaled to end at the median of the timed runs")
    if any(error_curves.joined(answer.series) for answer in answers):
        lines.append("one solver at several resolutions")
    parts = [f"Lines: {', or '.join(lines)}."] if lines else []
    if any(len(some) > 1 for shown in all_shown for some in shown.curves.values()):
        parts.append("Bands: all seeds.")
    parts.append(
        "Grey stairs: the Pareto front of the certified answers. Bars: interval of the median time; errors of the lower and of the upper bound, "
        "next to the error of their middle."
    )
    if any(np.isinf(curve.upper).any() for curve in curves):
        parts.append("Dotted: error of the lower bound, until an upper bound is known.")
    if any(answer.read_off for answer in answers):
        parts.append("Small: read off the traced run.")
    if any(not answer.ok for answer in answers):
        parts.append("Open: the tolerance was not reached.")
    parts.append(
        f"Grey area: less than the width of the reference, or {numerals.number(all_shown[0].least, 1)}."
    )
    if letters := style.letters_key({status for shown in all_shown for _, status, _ in shown.lost}):
        parts.append(f"At the right, not ok (a number: at how many tolerances): {letters}.")
    return " ".join(parts)
