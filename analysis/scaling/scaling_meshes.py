"""Time and memory of mesh solvers against the number of triangles: one dragon from 1,500 triangles up."""

from __future__ import annotations

from typing import Final

from analysis.scaling.growth import make_growth
from analysis.shared.report import Report
from analysis.shared.results import Results

# The scans have edges of more than two faces, or faces that are turned around; simplifying makes a manifold of them first.
REMARK: Final = ("CGAL gets a mesh with shared vertices where the triangles make a manifold, as after simplifying and in the finest "
                 "scan, and else a soup, which is built faster: so the exponent of its preparation mixes two kinds.")


def make(results: Results) -> Report:
    return make_growth(results, "triangle", "cgal", REMARK)
