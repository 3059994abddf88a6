"""Figure 9 of Zhang et al. 2017: the time of OHD against lambda, the size of its first sample."""

from __future__ import annotations

import math

import numpy as np

from analysis.shared import claims
from analysis.shared.cells import Cell
from analysis.shared.report import Report
from analysis.shared.results import Results
from analysis.shared.verdicts import Verdict, rising_by_run
from analysis.zhang2017 import zhang_sweep

BEST = 1 / 80  # "the high efficiency is obtained when lambda is set as 1/80"
RECOMMENDED = 0.01


def text_of(value: float) -> str:
    return f"1/{1 / value:.0f}"


def verdicts(sweep: zhang_sweep.Sweep) -> list[Verdict]:
    judged = [
        sweep.least(claims.of("zhang2017", "lambda_best", f"{scene} points"), scene, [BEST])
        for scene in sweep.scenes
    ]
    for claim, value in (
        ("lambda_larger", max(sweep.values, default=math.nan)),
        ("lambda_smaller", min(sweep.values, default=math.nan)),
    ):
        judged.append(
            sweep.everywhere(claims.of("zhang2017", claim, value=text_of(value)), value, BEST)
        )
    judged += [
        sweep.least(
            claims.of("zhang2017", "lambda_recommended", f"{scene} points"), scene, [RECOMMENDED]
        )
        for scene in sweep.scenes
    ]
    return judged + [ahd_culls(sweep, scene) for scene in sweep.scenes]


def ahd_culls(sweep: zhang_sweep.Sweep, scene: str) -> Verdict:
    """Judges the claim on lambda and the number of culled points, by their correlation for each
    seed.

    For one seed the AHD, the distance of the sample, cannot fall as lambda grows: a longer sample
    contains the shorter.
    """
    by_seed: dict[int, tuple[list[float], list[float]]] = {}  # values and numbers of culled points
    for value in sweep.values:
        cell = sweep.cells.get((scene, value))
        for row in cell.rows if cell else ():
            extras = sweep.results.extras(row)
            if sweep.results.cases.status[row] == "ok" and "culled" in extras:
                seed = int(sweep.results.options(row).get("seed", 0))
                values, counts = by_seed.setdefault(seed, ([], []))
                values.append(value)
                counts.append(extras["culled"])
    return rising_by_run(
        claims.of("zhang2017", "ahd_culls", f"{scene} points"), list(by_seed.values())
    )


def culled(results: Results, cell: Cell) -> float:
    shares = [
        100 * results.extras(row)["culled"] / results.cases.source_elements[row]
        for row in cell.rows
        if "culled" in results.extras(row)
    ]
    return float(np.median(shares)) if shares else math.nan


SPEC = zhang_sweep.Spec(
    "OHD against the size of its first sample, on normal clouds that overlap (Fig. 9 of Zhang et al. 2017).",
    "lambda",
    "points of A in the first sample, λ |A|: λ",
    text_of,
    RECOMMENDED,
    verdicts,
    (("culled, %", culled),),
    "n counts the seeds of the sample, each by its median. The line marks the 1/100 that the paper recommends.",
)


def make(results: Results) -> Report:
    return zhang_sweep.make(SPEC, results)
