"""Time and memory of mesh solvers against the number of triangles: one dragon from 1,500 triangles up."""

from __future__ import annotations

from analysis.scaling.growth import make_growth
from analysis.shared.report import Report
from analysis.shared.results import Results


def make(results: Results) -> Report:
    return make_growth(results, "triangle", "cgal")
