"""The curves of `cliffs`: work and time of each solver on a family of scenes, by the ratio of two
lengths of the scene."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from analysis.shared.comparable import Origin, origin, reason_apart
from analysis.shared.results import ResultError, Results
from analysis.shared.estimates import median

MOST: Final = 4.0  # a cliff is more than this many times the work at ratio 1
FLAT: Final = 1.02  # work within this factor counts as constant
COUNTED: Final = (
    "point_distances",
    "point_triangle_distances",
    "box_distances",
    "node_visits",
    "bound_tests",
    "polynomial_evaluations",
)
ANSWERED: Final = ("ok", "floor")
NOT_RUN: Final = ("skipped", "not_built")


@dataclass(frozen=True)
class Family:
    title: str
    axis: str = "ratio"
    claim: str = ""  # subject of a verdict; families with the same text are judged together


QUERIES: Final = "closest point work"
TOLERANCE: Final = "1 / tolerance"
FAMILIES: Final[dict[str, Family]] = {
    "mesh_stray_in_B": Family("mesh, stray triangle in B", claim=QUERIES),
    "mesh_stray_in_A": Family("mesh, stray triangle in A", claim=QUERIES),
    "mesh_away": Family("mesh, A moved away", claim=QUERIES),
    "mesh_two_clusters": Family("meshes, two clusters", claim=QUERIES),
    "mesh_refined": Family("mesh, B a refinement of A", TOLERANCE),
    "points_stray_in_B": Family("points, outlier in B", claim=QUERIES),
    "points_stray_in_A": Family("points, outlier in A", claim=QUERIES),
    "points_away": Family("points, A moved away", claim=QUERIES),
    "points_two_clusters": Family("points, two clusters", claim=QUERIES),
    "needle": Family("A: one needle triangle", claim="work on a needle triangle"),
    "surface_degree": Family("surfaces, by degree", "degree of A"),
    "surface_concentric": Family("concentric spheres", TOLERANCE),
}


@dataclass(frozen=True)
class Row:
    """A point of a curve. Work and seconds are NaN without an answer; work also if the solver
    counts none."""

    case: int
    ratio: float
    work: float
    seconds: float
    status: str
    origin: Origin = Origin(beside=False, machine="", build="", clock="")  # origin of its time


Curves = dict[tuple[str, str], list[Row]]  # by (family, label), ascending in ratio


def place(results: Results, case: int) -> tuple[str, float]:
    """Returns the family and the ratio of a case, from the name of its scene. Raises ResultError if
    it is in no family."""
    cases, scene = results.cases, results.cases.scene[case]
    if scene.endswith("_away") and scene in FAMILIES:
        return scene, float(
            f"{np.linalg.norm(cases.pose[case][9:]):.3g}"
        )  # 10^k without its rounding error
    if scene in FAMILIES and FAMILIES[scene].axis == TOLERANCE:
        return scene, 1 / float(cases.tolerance[case])
    match = re.fullmatch(r"(.+)_(1e)?(\d\d)", scene)
    if not match or match[1] not in FAMILIES:
        raise ResultError(
            f"{results.path}: scene '{scene}' belongs to no family of analysis/speed/cliffs_curves.py: name it "
            "FAMILY_1eNN, with a family of the list FAMILIES there"
        )
    return match[1], 10.0 ** int(match[3]) if match[2] else float(match[3])


def collect(results: Results) -> Curves:
    cases = results.cases
    curves: Curves = {}
    for case in range(len(cases)):
        status = cases.status[case]
        if status in NOT_RUN:
            continue
        family, ratio = place(results, case)
        answered = status in ANSWERED
        work = (
            sum(int(cases.counters[name][case]) for name in COUNTED if name in cases.counters)
            if answered
            else 0
        )
        curves.setdefault((family, cases.label[case]), []).append(
            Row(
                case,
                ratio,
                float(work) if work else math.nan,
                median(results.total_seconds(case)).value if answered else math.nan,
                status,
                origin(results, case),
            )
        )
    return {key: sorted(rows, key=lambda row: row.ratio) for key, rows in curves.items()}


def relative(rows: Sequence[Row], measure: str) -> list[float]:
    """Returns `work` or `seconds` of each row / of the first row; NaN if times are not
    comparable."""
    values = [float(getattr(row, measure)) for row in rows]
    return [
        math.nan
        if measure == "seconds" and reason_apart([row.origin, rows[0].origin])
        else value / values[0]
        for row, value in zip(rows, values)
    ]


def largest(rows: Sequence[Row], measure: str) -> tuple[float, Row | None]:
    finite = [
        (value, row) for value, row in zip(relative(rows, measure), rows) if math.isfinite(value)
    ]
    return max(finite, key=lambda pair: pair[0]) if finite else (math.nan, None)


def flat_from(rows: Sequence[Row]) -> Row | None:
    """Returns the row from which work stays within the factor FLAT, for at least three rows; None
    if there is none."""
    for i in range(len(rows) - 2):
        work = [row.work for row in rows[i:]]
        if all(map(math.isfinite, work)) and max(work) <= FLAT * min(work):
            return rows[i]
    return None


def power(ratio: float) -> str:
    """Formats a power of ten as '1e6', and other or smaller ratios as they are: '32'."""
    exponent = math.log10(ratio)
    return (
        f"1e{round(exponent)}"
        if ratio >= 1000 and abs(exponent - round(exponent)) < 1e-6
        else f"{ratio:g}"
    )
