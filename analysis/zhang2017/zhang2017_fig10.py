"""Figure 10 of Zhang et al. 2017: a torus moved through its like."""

from __future__ import annotations

from analysis.shared.report import Report
from analysis.shared.results import Results
from analysis.zhang2017 import zhang_motion


def make(results: Results) -> Report:
    caption = "A torus moved through one of the same shape and size (Fig. 10 of Zhang et al. 2017)."
    return zhang_motion.make(caption, results)
