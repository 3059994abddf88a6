"""Times, gaps and true errors of answers and traced bounds, for `error_vs_time`. Lengths are in
diagonals of A."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np

from analysis.shared.columns import Floats
from analysis.shared.results import Results
from analysis.shared.estimates import Estimate, median

ROUNDING: Final = 2.0**-53  # smaller lengths are below the rounding of coordinates
FINER: Final = 0.01  # gaps below this fraction of the finest tolerance are not distinguished
LEAST_SHOWN: Final = 1e-10  # but gaps above this always are
# Parameters that set the accuracy of a solver in place of the tolerance; answers at their values
# form one line.
RESOLUTION: Final[Mapping[str, frozenset[str]]] = {
    "sampling": frozenset({"step", "samples"}),
    "interval_subdivision": frozenset({"depth"}),
    "surface_meshes": frozenset({"cells"}),
}
Panel = tuple[str, int]  # scene, pose
Series = tuple[str, str]  # solver, and its label with swept parameters, except seeds and RESOLUTION


@dataclass(frozen=True)
class Errors:
    """Distances of both bounds, and of their middle, from the middle of the reference interval."""

    lower: Floats
    middle: Floats
    upper: Floats


@dataclass(frozen=True)
class Answer:
    """One marker: the answer of a series at one tolerance and resolution, over all seeds."""

    series: Series
    case: int  # of the first seed
    resolution: str
    time: Estimate
    gap: float
    ok: bool
    read_off: bool  # read off the trace of a run at a finer tolerance
    certified: bool


@dataclass(frozen=True)
class Curve:
    """The bounds of one traced run over time. `upper` is infinite while no upper bound is known."""

    case: int
    seconds: Floats
    lower: Floats
    upper: Floats


def _parts(results: Results, case: int, keep: bool) -> str:
    """Returns the swept parameters that are a resolution if `keep`, else those that are neither a
    resolution nor a seed."""
    resolution = RESOLUTION.get(results.cases.solver[case], frozenset())
    parts = [part for part in str(results.cases.variant[case]).split(", ") if part]
    return ", ".join(
        part
        for part in parts
        if (name := part.partition("=")[0]) != "seed" and (name in resolution) == keep
    )


def series_of(results: Results, case: int) -> Series:
    """Returns the series to which a row belongs."""
    rest, label = _parts(results, case, False), str(results.cases.label[case])
    return str(results.cases.solver[case]), f"{label}({rest})" if rest else label


def resolution_of(results: Results, case: int) -> str:
    """Returns the resolution of a row, such as 'step=0.01'; empty for most solvers."""
    return _parts(results, case, True)


def joined(series: Series) -> bool:
    """Tells whether the answers of a series at several resolutions are drawn as one line."""
    return series[0] in RESOLUTION


def traced_row(results: Results, case: int) -> int | None:
    """Finds the row with a trace of the same solver, parameters and shapes, at the finest
    tolerance."""
    cases = results.cases
    same = results.rows(
        scene=cases.scene[case],
        pose_index=cases.pose_index[case],
        solver=cases.solver[case],
        label=cases.label[case],
        variant=cases.variant[case],
        quantity=cases.quantity[case],
    )
    traced = [row for row in same if cases.trace_end[row] > cases.trace_begin[row]]
    return min(traced, key=lambda row: float(cases.tolerance[row])) if traced else None


def read_off_from(results: Results, case: int) -> int | None:
    """Finds the traced run from which this row was read off; None for a row that was run itself."""
    if (
        not results.cases.from_trace[case]
        or (results.answers.case == case).any()
        or len(results.repeats_of(case))
    ):
        return None
    fine = traced_row(results, case)
    return fine if fine is not None and results.first_by_round(fine) else None


def total_by_round(results: Results, case: int) -> dict[int, float]:
    """Returns the seconds to prepare and answer, by round.

    Tracing costs time. An answer that was read off a trace therefore gets the time of each untraced
    run, multiplied by the share of the traced run after which it was reached.
    """
    fine = read_off_from(results, case)
    if fine is None:
        return results.total_by_round(case)
    share = min(1.0, float(results.cases.solve_seconds[case] / results.trace_of(fine).seconds[-1]))
    before, usual = results.prepare_by_round(fine), results.prepare_seconds(fine)
    return {
        number: before.get(number, usual) + share * seconds
        for number, seconds in results.first_by_round(fine).items()
    }


def times_of(results: Results) -> dict[int, Estimate]:
    """Returns the time to prepare and answer, for all rows with bounds."""
    return {
        case: median(list(total_by_round(results, case).values()))
        for case in range(len(results.cases))
        if results.is_bounded(case)
    }


def over_seeds(results: Results, cases: Iterable[int]) -> Estimate:
    """Returns the median over rounds, each of which is the median over seeds."""
    by_round: dict[int, list[float]] = {}
    for case in cases:
        for number, seconds in total_by_round(results, case).items():
            by_round.setdefault(number, []).append(seconds)
    return median([float(np.median(values)) for values in by_round.values()])


def curve_of(results: Results, case: int) -> Curve:
    """Returns the trace of a row, its times scaled to end at the median of untraced runs, so that
    tracing costs nothing."""
    trace, first = results.trace_of(case), list(results.first_by_round(case).values())
    end = float(trace.seconds[-1])
    scale = float(np.median(first)) / end if first and end > 0 else 1.0
    seconds = results.prepare_seconds(case) + scale * trace.seconds
    keep = (seconds > 0) & np.isfinite(trace.lower)
    return Curve(case, seconds[keep], trace.lower[keep], trace.upper[keep])


def curves_of(results: Results, rows: Iterable[int]) -> dict[Series, list[Curve]]:
    """Returns the traces of each series at its finest tolerance, one per seed. Series with a
    resolution have none."""
    finest: dict[tuple[Series, str], int] = {}
    for row in rows:
        series = series_of(results, row)
        if (
            joined(series)
            or results.cases.status[row] == "unsound"
            or results.cases.trace_end[row] <= results.cases.trace_begin[row]
        ):
            continue
        old = finest.setdefault((series, results.names[row]), row)
        if results.cases.tolerance[row] < results.cases.tolerance[old]:
            finest[series, results.names[row]] = row
    curves: dict[Series, list[Curve]] = {}
    for (series, _), row in finest.items():
        curve = curve_of(results, row)
        if len(curve.seconds):
            curves.setdefault(series, []).append(curve)
    return curves


def answers_of(results: Results, rows: Iterable[int]) -> list[Answer]:
    """Returns the markers of a panel. If answers at several tolerances are equal, only the finest
    is returned."""
    cases = results.cases
    groups: dict[tuple[Series, str, float], list[int]] = {}
    for row in rows:
        if results.is_bounded(row) and total_by_round(results, row):
            groups.setdefault(
                (series_of(results, row), resolution_of(results, row), float(cases.tolerance[row])),
                [],
            ).append(row)
    answers: dict[tuple[Series, str, float, float], Answer] = {}
    for (series, resolution, _), same in sorted(groups.items(), key=lambda group: group[0][2]):
        case = same[0]
        gap, time = results.gap(case) / results.length_unit(case), over_seeds(results, same)
        read_off = read_off_from(results, case) is not None
        ok = all(cases.status[row] == "ok" for row in same)
        answers.setdefault(
            (series, resolution, gap, time.value),
            Answer(series, case, resolution, time, gap, ok, read_off, cases.certified[case] == 1),
        )
    return list(answers.values())


def errors(results: Results, case: int, lower: Floats, upper: Floats) -> Errors:
    """Returns the errors of these bounds and of their middle.

    NaN if no certified solver has an answer. Without an upper bound, its error and the middle's are
    infinite.
    """
    size, true = results.length_unit(case), results.middle(case)
    return Errors(
        np.abs(true - lower) / size,
        np.abs(0.5 * (lower + upper) - true) / size,
        np.abs(upper - true) / size,
    )


def errors_of(results: Results, case: int) -> Errors:
    """Returns the errors of the bounds of a row."""
    return errors(
        results, case, np.array([results.cases.lower[case]]), np.array([results.cases.upper[case]])
    )


def least_shown(results: Results) -> float:
    """Returns the gap below which all gaps are drawn at the same height."""
    tolerances = [
        results.cases.tolerance_absolute[case] / results.length_unit(case)
        for case in range(len(results.cases))
    ]
    return float(max(ROUNDING, min(FINER * np.min(tolerances, initial=np.inf), LEAST_SHOWN)))


def reference_width(results: Results, case: int) -> float:
    """Returns half the width of the reference, below which errors cannot be told from 0. Returns 0
    without a reference."""
    low, high = results.reference_of(case)
    return float(np.nan_to_num(0.5 * (high - low) / results.length_unit(case)))


def steps_at(times: Floats, seconds: Floats, values: Floats) -> Floats:
    """Evaluates a step function at these times; NaN before its first sample."""
    place = np.searchsorted(seconds, times, side="right") - 1
    return np.where(place < 0, np.nan, values[np.maximum(place, 0)])


def band(lines: list[tuple[Floats, Floats]]) -> tuple[Floats, Floats, Floats, Floats]:
    """Returns times, and minimum, median and maximum of several step functions there, beginning
    when all have a value."""
    times = np.unique(np.concatenate([seconds for seconds, _ in lines]))
    values = np.array([steps_at(times, *line) for line in lines])
    times, values = times[complete := ~np.isnan(values).any(axis=0)], values[:, complete]
    if not len(times):
        return times, times, times, times
    return times, values.min(axis=0), np.median(values, axis=0), values.max(axis=0)


def stairs(answers: Iterable[Answer], least: float) -> tuple[Floats, Floats]:
    """Returns the Pareto front of the certified answers, up to their last time: ascending times,
    falling gaps.

    Gaps below `least` count as `least`.
    """
    points = sorted(
        (answer.time.value, max(answer.gap, least))
        for answer in answers
        if answer.certified and np.isfinite(answer.gap)
    )
    front: list[tuple[float, float]] = []
    for seconds, gap in points:
        if not front or gap < front[-1][1]:
            front.append((seconds, gap))
    if front:
        front.append((points[-1][0], front[-1][1]))
    times = np.array([x for x, _ in front])
    gaps = np.array([y for _, y in front])
    return times, gaps


def tracing_cost(results: Results, case: int) -> float:
    """Returns the relative cost of tracing: traced run / untraced repeats of its process - 1; NaN
    if one is missing."""
    trace = results.trace_of(case)
    rows = [row for row in results.repeats_of(case) if results.repeats.round[row] == 0]
    if not rows or not len(trace.seconds):
        return float("nan")
    return float(trace.seconds[-1] / np.median(results.repeats.wall_seconds[rows]) - 1)
