"""Statistics of the distance against run time: relative width of the interval of `distribution` and
of Monte Carlo.

`sampling` bounds the largest distance of the same pairs. Its gap is the covering radius of its
samples, so its times show how long it takes to reach a radius. A note extrapolates them to a mean
that is proven by such a radius.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, Final

import matplotlib.pyplot as plt
import numpy as np
import scipy.stats

from analysis.shared import claims, numerals, scales, style, tables
from analysis.shared.cells import Cell, compare
from analysis.shared.comparable import Origin, apart
from analysis.shared.notes import clock_note, machine_line
from analysis.shared.report import Report
from analysis.shared.results import Results
from analysis.shared.estimates import NO_DATA, Estimate, ratio_by_round
from analysis.shared.verdicts import FAILS, HOLDS, OPEN, UNTESTED, Verdict, above_one

OURS: Final = "distribution"
RIVAL: Final = "monte_carlo"
SAMPLES: Final = "sampling"
AIM: Final = 5  # the claim: Monte Carlo takes at least so many times as long
FINE: Final = 1e-4  # at this width of the mean, relative to it
SLOPE: Final = (
    -0.9
)  # the other claim: the width falls like this power of the number of pieces, or faster; samples give -0.5
TITLES: Final = {"mean": "mean", "rms": "RMS", "quantile 0.95": "95 % quantile"}

Key = tuple[str, str, float]  # scene with its statistic, label, tolerance


def pair_of(results: Results, case: int) -> str:
    """Returns the name of the scene without the statistic that load() adds."""
    return (
        str(results.cases.scene[case])
        .removesuffix(" by number")
        .removesuffix(f", {results.cases.statistic[case]}")
    )


def width(results: Results, case: int) -> float:
    """Returns the width of the interval, relative to the middle of the narrowest proven one."""
    middle = results.middle(case)
    return results.gap(case) / middle if middle > 0 else float("nan")


def cells_of(results: Results) -> dict[Key, Cell]:
    cases, groups = results.cases, dict[Key, list[int]]()
    for row in range(len(cases)):
        if cases.solver[row] in (OURS, RIVAL):  # programs are drawn by statistics_programs
            groups.setdefault(
                (str(cases.scene[row]), str(cases.label[row]), float(cases.tolerance[row])), []
            ).append(row)
    return {key: Cell(results, rows) for key, rows in groups.items()}


def mean_ratio(pairs: Sequence[tuple[Cell, Cell]], by: float = 1.0) -> Estimate:
    """Returns the geometric mean of time of the first / time of the second / `by`, with an interval
    over the rounds that all have."""
    if lacking := apart(
        frozenset[Origin]().union(*(cell.origins for pair in pairs for cell in pair))
    ):
        return lacking
    rounds = [first.times.keys() & second.times.keys() for first, second in pairs]
    shared = set[int]().union(*rounds).intersection(*rounds)
    if not pairs or not shared:
        return NO_DATA
    above, below = {}, {}
    for number in shared:
        first_mean = scipy.stats.gmean([first.times[number] for first, _ in pairs])
        second_mean = scipy.stats.gmean([second.times[number] for _, second in pairs])
        above[number] = float(first_mean) / by
        below[number] = float(second_mean)
    return ratio_by_round(above, below)


def judge(results: Results, cells: dict[Key, Cell]) -> Verdict:
    """Judges the claim on the mean at FINE.

    On each pair Monte Carlo counts with its narrowest interval that is at least as wide. A wider
    one takes less time, so the ratio is then a lower bound and cannot refute the claim. A pair that
    one of them did not answer is left out and counted.
    """
    claim = claims.of("hausbench", "statistics_monte_carlo", aim=AIM, width=f"{FINE:g}")
    scenes = [
        scene
        for scene, label, tolerance in cells
        if label == OURS and np.isclose(tolerance, FINE) and scene.endswith(", mean")
    ]
    answered, widths = list[tuple[Cell, Cell]](), list[float]()
    for scene in scenes:
        ours = next(
            cell
            for (name, label, tolerance), cell in cells.items()
            if (name, label) == (scene, OURS) and np.isclose(tolerance, FINE)
        )
        rival = {
            tolerance: cell
            for (name, label, tolerance), cell in cells.items()
            if (name, label) == (scene, RIVAL) and tolerance >= 0.99 * FINE and not cell.failures
        }
        if rival and not ours.failures:
            widths.append(min(rival))
            answered.append((rival[min(rival)], ours))
    if not answered:
        return Verdict(claim, UNTESTED, f"no pair answered at {FINE:g}")
    verdict, unended, bound = (
        above_one(claim, mean_ratio(answered, AIM)),
        len(scenes) - len(answered),
        max(widths) > 1.01 * FINE,
    )
    evidence = f"{'at least ' if bound else ''}{numerals.estimate(mean_ratio(answered))} times over {len(answered)} pairs"
    if bound:
        evidence += f"; Monte Carlo was run to a width of {max(widths):g}, which takes less time"
    if unended:
        evidence += f"; no ratio for {unended} that one of them did not answer"
    return replace(
        verdict,
        outcome=OPEN if bound and verdict.outcome == FAILS else verdict.outcome,
        evidence=evidence,
    )


def slope(results: Results, scene: str) -> tuple[float, float, float] | None:
    """Fits log(width) against log(pieces) over the tolerances of a scene. Returns the slope with
    its interval of 95 %; None for fewer than three."""
    points = {
        (int(results.extras(row)["pieces"]), width(results, row))
        for row in results.rows(scene=scene, solver=OURS)
        if results.is_bounded(row)
        and width(results, row) > 0
        and results.extras(row).get("pieces", 0) > 0
    }
    if len({pieces for pieces, _ in points}) < 3:
        return None
    fit = scipy.stats.linregress(*np.log(np.array(sorted(points))).T)
    off = float(scipy.stats.t.ppf(0.975, len(points) - 2) * fit.stderr)
    return float(fit.slope), float(fit.slope) - off, float(fit.slope) + off


def judge_slopes(results: Results) -> Verdict:
    """Judges that the mean's width falls like pieces^SLOPE or faster on every pair: 'holds' if
    every interval is below SLOPE, 'does not hold' if one is above."""
    claim = claims.of("hausbench", "statistics_exponent", most=SLOPE)
    fits = [
        fit
        for scene in results.scenes
        if scene.endswith(", mean") and (fit := slope(results, scene))
    ]
    if not fits:
        return Verdict(claim, UNTESTED, "no pair has three widths")
    below = sum(high < SLOPE for *_, high in fits)
    above = sum(low > SLOPE for _, low, _ in fits)
    outcome = FAILS if above else HOLDS if below == len(fits) else OPEN
    slopes = sorted(value for value, *_ in fits)
    return Verdict(
        claim,
        outcome,
        f"below for {below} of {len(fits)} pairs, above for {above}; slopes {slopes[0]:.2f} to {slopes[-1]:.2f}",
    )


def make(results: Results) -> Report:
    cases, cells = results.cases, cells_of(results)
    scenes = list(dict.fromkeys(scene for scene, *_ in cells))
    table = tables.Table(
        "Time to prepare and solve, ms, until the interval of a statistic has the asked width relative to its value; samples or pieces; and how "
        "many times as long Monte Carlo takes. Its intervals hold with 95 %, the others always.",
        [
            "pair",
            "statistic",
            "value / diagonal",
            "asked",
            style.title(OURS),
            "pieces",
            style.title(RIVAL),
            "samples",
            "times",
        ],
        left=2,
    )
    records: list[tables.Record] = []
    for scene in scenes:
        first = results.rows(scene=scene)[0]
        tolerances = sorted(
            {tolerance for name, _, tolerance in cells if name == scene}, reverse=True
        )
        table.rules.add(len(table.rows))
        for i, tolerance in enumerate(tolerances):
            ours, rival = cells.get((scene, OURS, tolerance)), cells.get((scene, RIVAL, tolerance))
            ratio = compare(rival, ours) if ours and rival else NO_DATA
            head = [
                pair_of(results, first),
                TITLES.get(cases.statistic[first], cases.statistic[first]),
                numerals.number(results.share(first)),
            ]
            table.rows.append(
                [
                    *(head if i == 0 else ["", "", ""]),
                    numerals.number(tolerance, 1),
                    text(ours),
                    counted(results, ours, "pieces"),
                    text(rival),
                    counted(results, rival, "samples"),
                    numerals.estimate(ratio),
                ]
            )
        for row in results.rows(scene=scene):
            if cases.solver[row] not in (OURS, RIVAL):
                continue
            cell = cells[scene, str(cases.label[row]), float(cases.tolerance[row])]
            records.append(
                {
                    "pair": pair_of(results, row),
                    "statistic": cases.statistic[row],
                    "solver": cases.solver[row],
                    "tolerance": float(cases.tolerance[row]),
                    "status": cases.status[row],
                    "lower": float(cases.lower[row]),
                    "upper": float(cases.upper[row]),
                    "relative_width": width(results, row),
                    **tables.seconds(cell.time),
                    **{
                        name: value
                        for name, value in results.extras(row).items()
                        if name in ("pieces", "samples")
                    },
                }
            )
    table.verdicts = [judge(results, cells), judge_slopes(results)]
    table.notes += [
        *crossings(results, cells),
        *extrapolated_rival(results, cells),
        *extrapolated(results, cells),
        f"{tables.coverage_note(cell.time for cell in cells.values())}",
        f"{machine_line(results)}.",
    ]
    caption = (
        "Width of the interval of a statistic, relative to its value, against the time to prepare and solve. Thin: each pair of meshes; bold: geometric mean over "
        "the pairs that reached the width. Intervals of Monte Carlo hold with a probability of 95 %, the others always."
    )
    return Report(
        lambda: draw(results, cells), table, records, caption=caption, clock=clock_note(results)
    )


def text(cell: Cell | None) -> str:
    return cell.text(1e3) if cell else numerals.NOTHING


def counted(results: Results, cell: Cell | None, name: str) -> str:
    """Returns the number of pieces or samples of a cell."""
    value = results.extras(cell.rows[0]).get(name, np.nan) if cell else np.nan
    return numerals.NOTHING if np.isnan(value) else f"{value:,.0f}"


def crossings(results: Results, cells: dict[Key, Cell]) -> list[str]:
    """Returns a note on the widths at which the two solvers take the same time, by the lines of the
    figure."""
    crossed = []
    for statistic in statistics_of(results):
        ours, rival = (line(results, cells, statistic, label) for label in (OURS, RIVAL))
        shared = sorted(ours.keys() & rival.keys(), reverse=True)
        logs = [float(np.log(rival[t] / ours[t])) for t in shared]
        for (t, a), (u, b) in zip(zip(shared, logs), list(zip(shared, logs))[1:]):
            if a < 0 <= b:
                at = np.exp(np.log(t) + (np.log(u) - np.log(t)) * -a / (b - a))
                crossed.append(
                    f"{TITLES.get(statistic, statistic)}: {numerals.number(float(at), 2)}"
                )
    return (
        [
            f"Relative widths at which both take the same time (geometric mean over pairs): {'; '.join(crossed)}. Narrower intervals take Monte Carlo longer."
        ]
        if crossed
        else []
    )


def extrapolated(results: Results, cells: dict[Key, Cell]) -> list[str]:
    """Returns a note that compares the times of OURS with the times in which samples would prove
    the mean by their covering radius.

    Fits a power of the radius to the times of SAMPLES on each pair, and follows it from the finest
    samples to a radius equal to the finest width of OURS. This favours the samples: a radius r
    proves the mean only to a width of 2 r. Skips pairs whose mean is 0.
    """
    factors, powers, finest = (
        list[float](),
        list[float](),
        min((tolerance for _, label, tolerance in cells if label == OURS), default=0.0),
    )
    for (scene, label, tolerance), ours in cells.items():
        if label != OURS or tolerance != finest or not scene.endswith(", mean") or ours.failures:
            continue
        radius = finest * results.middle(ours.rows[0])
        rows = [
            row
            for row in results.rows(scene=scene.removesuffix(", mean"), solver=SAMPLES, status="ok")
            if results.gap(row) > 0
        ]
        points = sorted(
            (results.gap(row), float(np.median(list(results.total_by_round(row).values()))))
            for row in rows
        )
        if len({gap for gap, _ in points}) < 3 or not radius > 0:
            continue
        powers.append(float(scipy.stats.linregress(*np.log(np.array(points)).T).slope))
        gap, time = points[0]
        factors.append(time * (radius / gap) ** powers[-1] / ours.time.value)
    if not factors:
        return []
    return [
        f"Samples prove a mean only to within their covering radius. The gap of {style.title(SAMPLES)} is this radius, and its time grows like radius^{max(powers):.2f} to "
        f"radius^{min(powers):.2f}. Extrapolated to a radius of {finest:g} times the mean, it takes about {scipy.stats.gmean(factors):.0e} times as long as {style.title(OURS)} takes for a width of "
        f"{finest:g} (geometric mean over {len(factors)} pairs; {min(factors):.0e} to {max(factors):.0e})."
    ]


def extrapolated_rival(results: Results, cells: dict[Key, Cell]) -> list[str]:
    """Returns a note on the time that RIVAL would take for the mean at FINE, if it was run to wider
    intervals alone.

    Fits a power of the width to its two narrowest intervals on each pair, and follows it from the
    narrower one.
    """
    factors, powers = list[float](), list[float]()
    for (scene, label, tolerance), ours in cells.items():
        if (
            label != OURS
            or not np.isclose(tolerance, FINE)
            or not scene.endswith(", mean")
            or ours.failures
        ):
            continue
        times = {
            width: cell.time.value
            for (name, of, width), cell in cells.items()
            if (name, of) == (scene, RIVAL) and not cell.failures and cell.time.n
        }
        if len(times) < 2 or min(times) < 1.01 * FINE:
            continue
        narrow, wide = sorted(times)[:2]
        powers.append(float(np.log(times[wide] / times[narrow]) / np.log(wide / narrow)))
        factors.append(times[narrow] * (FINE / narrow) ** powers[-1] / ours.time.value)
    if not factors:
        return []
    return [
        f"The time of {style.title(RIVAL)} grows like width^{max(powers):.2f} to width^{min(powers):.2f}. Extrapolated to a width of {FINE:g}, it takes the mean about "
        f"{numerals.number(float(scipy.stats.gmean(factors)), 2)} times as long as {style.title(OURS)} (geometric mean over {len(factors)} pairs; {numerals.number(min(factors), 2)} to "
        f"{numerals.number(max(factors), 2)})."
    ]


def statistics_of(results: Results) -> list[str]:
    """Returns the names of the statistics; rows of SAMPLES have none."""
    return [
        statistic for statistic in dict.fromkeys(map(str, results.cases.statistic)) if statistic
    ]


def line(
    results: Results, cells: dict[Key, Cell], statistic: str, label: str
) -> dict[float, float]:
    """Returns the geometric mean of the times over all pairs, by tolerance; only tolerances that
    every pair reached."""
    scenes = [scene for scene in results.scenes if scene.endswith(f", {statistic}")]
    times = dict[float, float]()
    for tolerance in {tolerance for scene, name, tolerance in cells if name == label}:
        reached = [
            cells[scene, label, tolerance] for scene in scenes if (scene, label, tolerance) in cells
        ]
        if len(reached) == len(scenes) and not any(cell.failures for cell in reached):
            times[tolerance] = float(scipy.stats.gmean([cell.time.value for cell in reached]))
    return times


def draw(results: Results, cells: dict[Key, Cell]) -> Any:
    cases = results.cases
    statistics = statistics_of(results)
    labels = style.order(
        (solver, label)
        for solver, label in zip(cases.solver, cases.label)
        if solver in (OURS, RIVAL)
    )
    figure, axes = plt.subplots(
        1,
        len(statistics),
        figsize=(style.DOUBLE_COLUMN, 2.4),
        sharex=True,
        sharey=True,
        squeeze=False,
    )
    for ax, statistic in zip(axes[0], statistics):
        for solver, label in labels:
            looks = style.look(solver, label)
            for scene in [scene for scene in results.scenes if scene.endswith(f", {statistic}")]:
                points = sorted(
                    (tolerance, cell.time.value)
                    for (name, of, tolerance), cell in cells.items()
                    if name == scene and of == label and not cell.failures and cell.time.n
                )
                times = [time for _, time in points]
                widths = [tolerance for tolerance, _ in points]
                ax.plot(times, widths, color=looks.colour, linewidth=0.5, alpha=0.4)
            mean = dict(sorted(line(results, cells, statistic, label).items()))
            ax.plot(
                list(mean.values()),
                list(mean.keys()),
                **style.filled_marker(looks) | {"linestyle": "-", "linewidth": 1.4},
            )
        ax.set_xscale("log")
        ax.set_yscale("log")
        ax.set_title(TITLES.get(statistic, statistic))
        ax.set_xlabel("time (s)")
        scales.log_ticks(ax.xaxis)
        scales.log_ticks(ax.yaxis)
    axes[0][0].set_ylabel("width / value")
    style.legend_above(figure, style.handles(labels))
    return figure
