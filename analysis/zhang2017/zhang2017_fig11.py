"""Figure 11 of Zhang et al. 2017: a gear moved and turned through another."""

from __future__ import annotations

from analysis.shared.report import Report
from analysis.shared.results import Results
from analysis.zhang2017 import zhang_motion


def make(results: Results) -> Report:
    caption = "A gear moved and turned through one of another shape and size (Fig. 11 of Zhang et al. 2017)."
    return zhang_motion.make(caption, results)
