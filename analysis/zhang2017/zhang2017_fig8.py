"""Figure 8 of Zhang et al. 2017: the time of NOHD against the depth of its octree."""

from __future__ import annotations

from analysis.shared import claims
from analysis.shared.comparable import reason_apart
from analysis.shared.report import Report
from analysis.shared.results import Results
from analysis.shared.verdicts import UNTESTED, Verdict, constant
from analysis.zhang2017 import zhang_sweep

BEST = [5.0, 6.0]  # "the high efficiency is obtained when depth is increased to five or six"
CONSTANT = 1.25  # factor within which times count as constant: the paper gives no number


def verdicts(sweep: zhang_sweep.Sweep) -> list[Verdict]:
    deepest = max(sweep.values, default=0.0)
    judged = [
        sweep.least(claims.of("zhang2017", "depth_best", f"{scene} points"), scene, BEST)
        for scene in sweep.scenes
    ]
    judged.append(sweep.everywhere(claims.of("zhang2017", "depth_greater"), deepest, 6.0))
    judged.append(sweep.everywhere(claims.of("zhang2017", "depth_smaller"), 1.0, 5.0))
    return judged + [build_by_depth(sweep, scene) for scene in sweep.scenes]


def build_by_depth(sweep: zhang_sweep.Sweep, scene: str) -> Verdict:
    """Judges the claim on the time to build the octree by its depth: time / depth, by round, should
    be constant."""
    claim = claims.of("zhang2017", "build_by_depth", f"{scene} points")
    cells = [
        (depth, cell)
        for depth in sweep.values
        if (cell := sweep.cells.get((scene, depth))) and not cell.failures
    ]
    if why := reason_apart(origin for _, cell in cells for origin in cell.origins):
        return Verdict(claim, UNTESTED, f"times {why}")
    by_depth: list[list[float]] = []
    for depth, cell in cells:
        times = [
            time
            for row in cell.rows
            for time in sweep.results.prepare_by_round(row).values()
            if time > 0
        ]
        if times:
            by_depth.append([time / depth for time in times])
    return constant(claim, by_depth, CONSTANT)


SPEC = zhang_sweep.Spec(
    "NOHD against the depth of its octree, on normal clouds that lie apart (Fig. 8 of Zhang et al. 2017).",
    "depth",
    "depth of the octree",
    lambda value: f"{value:g}",
    6.0,
    verdicts,
    (),
    "Ratios are paired by rounds in which the depths took turns. Greater than 6 is judged at the greatest depth, smaller than 5 at depth 1. The octree is "
    "built to the requested depth, as in the paper.",
)


def make(results: Results) -> Report:
    return zhang_sweep.make(SPEC, results)
