"""Table 2 of Zhang et al. 2017: OHD with and without culling, on pairs of normal clouds that
overlap."""

from __future__ import annotations

import math

import numpy as np

from analysis.shared import numerals
from analysis.shared.cells import Cell
from analysis.shared.report import Report
from analysis.shared.results import Results
from analysis.zhang2017 import zhang_pairs


def extra(results: Results, scene: str, cells: dict[str, Cell]) -> list[tuple[str, str, float]]:
    """Returns extra columns: the percentage of A that OHD culls, corrected and as printed."""
    columns = []
    for label, header in (("ohd", "culled, %"), ("ohd_as_printed", "culled as printed, %")):
        rows = results.rows(scene=scene, label=label)
        culled = [
            100 * results.extras(r)["culled"] / results.cases.source_elements[r]
            for r in rows
            if "culled" in results.extras(r)
        ]
        value = float(np.median(culled)) if culled else math.nan
        columns.append((header, numerals.number(value), value))
    return columns


SPEC = zhang_pairs.Spec(
    "OHD with and without culling, on normal clouds that overlap (Table 2 of Zhang et al. 2017).",
    "ohd_without_culling",
    "ohd",
    "culling",
    "culling",
    ("ohd_as_printed", "scan"),
    [
        'The paper says "the same data sets" as in its Table 1, which lie apart, so that nothing can be culled; here the centres are half a standard '
        "deviation apart.",
        "The paper's times are for its unsafe rule (cells of side AHD, column 'ohd as printed'), ours for the exact one (cells of diagonal AHD). 'unsound': "
        "the answer was shown to be wrong.",
    ],
    extra,
)


def make(results: Results) -> Report:
    return zhang_pairs.make(SPEC, results)
