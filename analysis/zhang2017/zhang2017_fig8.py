"""Figure 8 of Zhang et al. 2017: the time of NOHD against the depth of its octree."""

from __future__ import annotations

from analysis.shared import claims
from analysis.shared.report import Report
from analysis.shared.results import Results
from analysis.shared.verdicts import Verdict
from analysis.zhang2017 import zhang_sweep

BEST = [5.0, 6.0]  # "the high efficiency is obtained when depth is increased to five or six"


def verdicts(sweep: zhang_sweep.Sweep) -> list[Verdict]:
    deepest = max(sweep.values, default=0.0)
    return [*[sweep.least(claims.of("zhang2017", "depth_best", f"{scene} points"), scene, BEST) for scene in sweep.scenes],
            sweep.everywhere(claims.of("zhang2017", "depth_greater"), deepest, 6.0),
            sweep.everywhere(claims.of("zhang2017", "depth_smaller"), 1.0, 5.0)]


SPEC = zhang_sweep.Spec(
    "NOHD against the depth of its octree, on normal clouds that lie apart (Fig. 8 of Zhang et al. 2017).",
    "depth", "depth of the octree", lambda value: f"{value:g}", 6.0, verdicts, (),
    "Ratios are paired by rounds in which the depths took turns. Greater than 6 is read at the greatest depth, "
    "smaller than 5 at depth 1. The octree is built to the depth asked, as in the paper.")


def make(results: Results) -> Report:
    return zhang_sweep.make(SPEC, results)
