"""Fits cost = constant * n^exponent to time and memory, with intervals, and forecasts the cost of
larger sizes."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Final

import matplotlib.pyplot as plt
import numpy as np
import scipy.stats
from matplotlib.lines import Line2D

from analysis.shared import numerals, scales, style, tables
from analysis.shared.comparable import origins, reason_apart
from analysis.shared.notes import machine_line
from analysis.shared.report import Report
from analysis.shared.results import ResultError, Results
from analysis.shared.estimates import CONFIDENCE

LEAST_SECONDS: Final = 2e-4  # shorter times are dominated by startup and cold caches
LEAST_BYTES: Final = (
    2**20
)  # smaller peaks depend on page sizes and on memory left over from loading
FIXED: Final = 10.0  # costs below this many times the least are not used: their fixed part would flatten the line
LEAST_SIZES: Final = 3  # any two sizes lie on a line, so they cannot test it
ANSWERS: Final = "ok"
# By experiment: its elements, the label to whose memory the others are compared, and a note.
# The scans have edges with more than two faces, or flipped faces; simplification first makes them
# manifolds.
STEMS: Final = {
    "scaling_points": ("point", "cgal_kdtree", ""),
    "scaling_meshes": (
        "triangle",
        "cgal",
        "CGAL gets a mesh with shared vertices if the triangles form a manifold, as after simplifying and in the finest scan, and otherwise "
        "a soup, which is built faster, so the exponent of its preparation mixes two kinds.",
    ),
}
PREPARE: Final[dict[str, Any]] = {"linestyle": (0, (2.5, 2)), "linewidth": 0.5}


@dataclass(frozen=True)
class Interval:
    value: float
    low: float
    high: float


UNKNOWN: Final = Interval(math.nan, math.nan, math.nan)


@dataclass(frozen=True)
class Growth:
    """The fit cost = constant * n^exponent: a least squares line through logarithms, with Student's
    intervals.

    The intervals hold if the logarithms scatter about the line with constant variance. If the true
    curve bends (caches, a fixed cost), they become wide.
    """

    sizes: tuple[float, ...]
    costs: tuple[float, ...]

    @property
    def known(self) -> bool:
        return len(set(self.sizes)) >= LEAST_SIZES

    def exponent(self) -> Interval:
        if not self.known:
            return UNKNOWN
        fit = scipy.stats.linregress(np.log(self.sizes), np.log(self.costs))
        half = self._quantile() * float(fit.stderr)
        return Interval(float(fit.slope), float(fit.slope) - half, float(fit.slope) + half)

    def at(self, n: float) -> Interval:
        """Returns the forecast for size n, with the interval for a new measurement there."""
        if not self.known:
            return UNKNOWN
        x, y = np.log(self.sizes), np.log(self.costs)
        fit = scipy.stats.linregress(x, y)
        middle = float(fit.intercept + fit.slope * math.log(n))
        scatter = math.sqrt(float(((y - fit.intercept - fit.slope * x) ** 2).sum()) / (len(x) - 2))
        spread = math.sqrt(
            1
            + 1 / len(x)
            + (math.log(n) - float(x.mean())) ** 2 / float(((x - x.mean()) ** 2).sum())
        )
        half = self._quantile() * scatter * spread
        return Interval(math.exp(middle), math.exp(middle - half), math.exp(middle + half))

    def _quantile(self) -> float:
        return float(scipy.stats.t.ppf((1 + CONFIDENCE) / 2, len(self.sizes) - 2))


def growth(
    sizes: Sequence[float], costs: Sequence[float], least: float, fixed: float = FIXED
) -> Growth:
    """Fits the growth over the largest sizes, from the first one after which all costs are large
    enough.

    A cost is large enough if it is at least `least`, and `fixed` times the cost of the smallest
    size.
    """
    measured = sorted(
        (n, cost) for n, cost in zip(sizes, costs, strict=True) if not math.isnan(cost)
    )
    bar = max([least, *[fixed * cost for _, cost in measured[:1]]])
    low = max((i + 1 for i, (_, cost) in enumerate(measured) if cost < bar), default=0)
    kept_sizes = tuple(n for n, _ in measured[low:])
    kept_costs = tuple(cost for _, cost in measured[low:])
    return Growth(kept_sizes, kept_costs)


@dataclass(frozen=True)
class Curve:
    """The costs of one solver in one regime, in ascending order of size."""

    regime: str
    solver: str
    label: str
    rows: tuple[int, ...]  # rows of /cases with an answer
    sizes: tuple[float, ...]  # |A| + |B| of these rows
    prepare: tuple[float, ...]  # seconds
    solve: tuple[float, ...]  # seconds, of the first answer
    peak: tuple[float, ...]  # bytes; NaN: unknown
    structures: tuple[float, ...]  # bytes that the structures hold
    lost: tuple[tuple[float, str], ...]  # size and status of the rows without an answer

    times_compare: bool = True  # if false, no exponent is fitted to times

    @property
    def title(self) -> str:
        return style.title(self.solver, self.label)

    def growth_of(self, seconds: Sequence[float], least: float = LEAST_SECONDS) -> Growth:
        """Fits the growth of times; `seconds` has one for each size."""
        return growth(self.sizes, seconds, least) if self.times_compare else Growth((), ())

    def last(self, values: Sequence[float]) -> float:
        """Returns the last value per element: at the largest size that was answered."""
        return values[-1] / self.sizes[-1] if self.sizes else math.nan


def curve(results: Results, regime: str, solver: str, label: str) -> Curve:
    cases = results.cases
    rows = sorted(
        results.rows(family=regime, solver=solver, label=label),
        key=lambda row: elements(results, row),
    )
    if len({elements(results, row) for row in rows}) < len(rows):
        raise ResultError(
            f"{results.path}: '{label}' in regime '{regime}' has two rows of one size: give each size one tolerance, pose and variant"
        )
    there = [row for row in rows if cases.status[row] == ANSWERS]
    first = [np.array(list(results.first_by_round(row).values())) for row in there]
    sizes = tuple(elements(results, row) for row in there)
    prepare = tuple(results.prepare_seconds(row) for row in there)
    solve = tuple(float(np.median(seconds)) if len(seconds) else math.nan for seconds in first)
    peak = tuple(
        float(cases.peak_bytes[row]) if cases.peak_bytes[row] > 0 else math.nan for row in there
    )
    structures = tuple(
        float(cases.prepare_bytes[row]) if cases.prepare_bytes[row] > 0 else math.nan
        for row in there
    )
    lost = tuple(
        (elements(results, row), str(cases.status[row]))
        for row in rows
        if cases.status[row] != ANSWERS
    )
    return Curve(
        regime,
        solver,
        label,
        tuple(there),
        sizes,
        prepare,
        solve,
        peak,
        structures,
        lost,
        not reason_apart(origins(results, there)),
    )


def elements(results: Results, row: int) -> float:
    return float(results.cases.source_elements[row] + results.cases.target_elements[row])


def curves(results: Results) -> list[Curve]:
    labels = style.order(zip(results.cases.solver, results.cases.label))
    return [
        curve(results, str(regime), solver, label)
        for regime in results.in_order("family")
        for solver, label in labels
        if results.rows(family=regime, solver=solver, label=label)
    ]


def text(x: Interval) -> str:
    """Formats an exponent with its interval: '1.02 [0.98, 1.06]'."""
    return (
        numerals.NOTHING if math.isnan(x.value) else f"{x.value:.2f} {numerals.ends(x.low, x.high)}"
    )


def short(n: float) -> str:
    """Formats a size: '300K', '20M'."""
    for unit, name in ((1e9, "G"), (1e6, "M"), (1e3, "K")):
        if n >= unit:
            return f"{n / unit:.3g}{name}"
    return f"{n:.0f}"


def make(results: Results) -> Report:
    element, rival, remark = STEMS[results.stem]
    drawn = curves(results)
    by_regime: dict[str, list[Curve]] = {}
    for curve in drawn:
        by_regime.setdefault(curve.regime, []).append(curve)
    table = tables.Table(
        f"Time and memory to prepare and solve against the number of {element}s, |A| + |B|: at the largest size with an answer, and how they grow.",
        [
            "regime",
            "solver",
            "answered",
            f"prepare, ns per {element}",
            "grows as n^",
            f"solve, ns per {element}",
            "grows as n^",
            f"peak, bytes per {element}",
            "grows as n^",
            f"structures, bytes per {element}",
            f"peak, {style.title(rival)} / this",
        ],
        left=3,
    )
    records: list[tables.Record] = []
    for group in by_regime.values():
        table.rules.add(len(table.rows))
        beside = next((curve for curve in group if curve.label == rival), None)
        for curve in group:
            grown = [
                curve.growth_of(curve.prepare),
                curve.growth_of(curve.solve),
                growth(curve.sizes, curve.peak, LEAST_BYTES),
            ]
            table.rows.append(
                [
                    curve.regime,
                    curve.title,
                    answered(curve),
                    numerals.number(1e9 * curve.last(curve.prepare)),
                    text(grown[0].exponent()),
                    numerals.number(1e9 * curve.last(curve.solve)),
                    text(grown[1].exponent()),
                    numerals.number(curve.last(curve.peak)),
                    text(grown[2].exponent()),
                    numerals.number(curve.last(curve.structures)),
                    numerals.number(peak_ratio(beside, curve)),
                ]
            )
            records += [record(curve, i, grown) for i in range(len(curve.sizes))]
            records += [
                {
                    "regime": curve.regime,
                    "solver": curve.solver,
                    "label": curve.label,
                    "elements": int(n),
                    "status": status,
                }
                for n, status in curve.lost
            ]
    table.notes = [
        "Peak: the resident set less the resident set before preparing, so without the shapes themselves; structures: the sizes that they report. "
        f"Exponents: the line through the logarithms, from the size on at which a cost is {FIXED:g} times that of the smallest one (below, its fixed part "
        f"dominates) and at least {LEAST_SECONDS * 1e3:g} ms or {LEAST_BYTES // 2**20} MiB; {LEAST_SIZES} sizes or more, with Student's interval of 95 %, "
        "which is valid if they scatter about a line.",
        f"{style.title(rival)} / this: at the largest size that both answered.",
        *[f"{regime}: {note}." for regime, note in notes(results).items()],
        *filter(None, [remark]),
        f"{machine_line(results)}.",
    ]
    return Report(
        lambda: draw(by_regime, element),
        table,
        records,
        style.letters_key(status for curve in drawn for _, status in curve.lost),
    )


def record(curve: Curve, i: int, grown: Sequence[Growth]) -> tables.Record:
    fits = {
        f"{name}_{end}": getattr(fit.exponent(), end)
        for name, fit in zip(("prepare_exponent", "solve_exponent", "peak_exponent"), grown)
        for end in ("value", "low", "high")
    }
    return {
        "regime": curve.regime,
        "solver": curve.solver,
        "label": curve.label,
        "elements": int(curve.sizes[i]),
        "status": ANSWERS,
        "prepare_seconds": curve.prepare[i],
        "solve_seconds": curve.solve[i],
        "peak_bytes": curve.peak[i],
        "structure_bytes": curve.structures[i],
        **fits,
    }


def answered(curve: Curve) -> str:
    """Returns the sizes that were answered, and the failures: '2K to 600K; timeout at 2M'."""
    there = f"{short(curve.sizes[0])} to {short(curve.sizes[-1])}" if curve.sizes else "none"
    return "; ".join(
        [there, *[f"{style.status_word(status)} at {short(n)}" for n, status in curve.lost]]
    )


def peak_ratio(rival: Curve | None, curve: Curve) -> float:
    """Returns the rival's peak memory / the solver's, at the largest size at which both are at
    least LEAST_BYTES."""
    if rival is None or rival is curve:
        return math.nan
    rival_peak = dict(zip(rival.sizes, rival.peak))
    both = [
        rival_peak[n] / peak
        for n, peak in zip(curve.sizes, curve.peak)
        if peak >= LEAST_BYTES and rival_peak.get(n, math.nan) >= LEAST_BYTES
    ]
    return both[-1] if both else math.nan


def notes(results: Results) -> dict[str, str]:
    """Returns the notes of the experiment file, by regime."""
    return {
        str(family): str(note).partition(";")[0]
        for family, note in zip(results.cases.family, results.cases.scene_note)
        if note
    }


def has_marks(ax: Any) -> bool:
    """Tells whether the axes show data. Failure marks at the edge do not count, as they have no
    data coordinates."""
    return any(len(line.get_xdata()) and line.get_transform() == ax.transData for line in ax.lines)


def tick(axes: Iterable[Any]) -> None:
    for ax in axes:
        if has_marks(ax):  # an empty logarithmic axis has no ticks
            ax.set(xscale="log", yscale="log")
            scales.log_ticks(ax.xaxis)
            scales.log_ticks(ax.yaxis)


def draw(by_regime: dict[str, list[Curve]], element: str) -> Any:
    """Draws times to solve (filled marks) and to prepare (small open marks) above, and peak memory
    per element below."""
    figure, axes = plt.subplots(
        2,
        max(1, len(by_regime)),
        figsize=(style.DOUBLE_COLUMN, 4.4),
        sharex=True,
        sharey="row",
        squeeze=False,
    )
    for (regime, group), above, below in zip(by_regime.items(), axes[0], axes[1]):
        lost = []
        for curve in group:
            looks = style.look(curve.solver, curve.label)
            statuses = dict.fromkeys(status for _, status in curve.lost)
            lost += [(looks, style.status_letter(status)) for status in statuses]
            if not curve.sizes:
                continue
            above.plot(
                curve.sizes, curve.solve, color=looks.colour, linestyle=looks.line, linewidth=0.7
            )
            above.plot(curve.sizes, curve.solve, **style.filled_marker(looks))
            # CGAL prepares triangle soups and manifolds in different ways, so no line joins its
            # preparation times.
            prepare = (
                style.open_marker(looks)
                | {"markersize": 0.6 * looks.size, "markeredgewidth": 0.5}
                | ({} if curve.solver == "cgal" else PREPARE)
            )
            above.plot(curve.sizes, curve.prepare, **prepare)
            told = [
                (n, peak / n) for n, peak in zip(curve.sizes, curve.peak) if peak >= LEAST_BYTES
            ]
            if told:
                below.plot(
                    *np.array(told).T, color=looks.colour, linestyle=looks.line, linewidth=0.7
                )
                below.plot(*np.array(told).T, **style.filled_marker(looks))
        style.margin_marks(above, lost, 120)
        above.set(title=regime)
        below.set(xlabel=f"{element}s, |A| + |B|")
    axes[0][0].set_ylabel("time (s)")
    axes[1][0].set_ylabel(f"peak memory, bytes per {element}")
    tick(axes.flat)
    labels = style.order(
        (curve.solver, curve.label) for group in by_regime.values() for curve in group
    )
    grey = style.filled_marker(style.NEUTRAL) | {"linestyle": "-", "linewidth": 0.7}
    of_time = [
        Line2D([], [], label="filled: solve", **grey),
        Line2D(
            [],
            [],
            label="small and open: prepare",
            **(
                style.open_marker(style.NEUTRAL)
                | {"markersize": 0.6 * style.NEUTRAL.size}
                | PREPARE
            ),
        ),
    ]
    style.legend_above(figure, [*style.handles(labels), *of_time], columns=4)
    return figure
