"""Table 1 of Zhang et al. 2017: NOHD with and without early breaking, on pairs of normal clouds
that lie apart."""

from __future__ import annotations

from analysis.shared.report import Report
from analysis.shared.results import Results
from analysis.zhang2017 import zhang_pairs


SPEC = zhang_pairs.Spec(
    "NOHD with and without early breaking, on normal clouds that lie apart (Table 1 of Zhang et al. 2017).",
    "nohd_without_early_break",
    "nohd",
    "early breaking",
    "early_breaking",
    ("scan",),
    ["The paper does not say how far apart its clouds are; here ten standard deviations."],
)


def make(results: Results) -> Report:
    return zhang_pairs.make(SPEC, results)
