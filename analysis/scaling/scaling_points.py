"""Time and memory of exact solvers of point sets against the number of points, in three regimes."""

from __future__ import annotations

from analysis.scaling.growth import make_growth
from analysis.shared.report import Report
from analysis.shared.results import Results


def make(results: Results) -> Report:
    return make_growth(results, "point", "cgal_kdtree")
