"""All rows of all results as one JavaScript value, for the page with filters.

A column of texts is a list of its distinct values and, for each row, the index of its value. Bounds
keep all their digits, so that they hold; times and errors have four.
"""

from __future__ import annotations

import json
import math
import tomllib
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any, Final

import numpy as np

from analysis.shared import style
from analysis.shared.printable import printable
from analysis.shared.results import Results

MANIFEST: Final = Path(__file__).resolve().parents[2] / "datasets" / "manifest.toml"
TEXTS: Final = (
    "stem",
    "solver",
    "scene",
    "status",
    "reason",
    "clock",
    "check",
    "source",
    "target",
    "prover",
)
NUMBERS: Final = (
    "tolerance",
    "lower",
    "upper",
    "error",
    "seconds",
    "certified",
    "pose",
    "sizeA",
    "sizeB",
)
PROVERS: Final = (
    "cover",
    "guthe",
    "sacht",
    "kang",
    "zheng",
)  # solvers that write certificates, see docs/certificate.md
STATUSES: Final = {
    "ok": "an answer within the tolerance",
    "budget": "the solver's own limit of work was reached; the bounds hold",
    "floor": "the tolerance is below the precision of doubles; the bounds hold",
    "timeout": "no answer in time",
    "out_of_memory": "no answer: too little memory",
    "signal": "no answer: the solver crashed",
    "failed": "the solver gave up, or refused the input; the reason says why",
    "unsound": "the check refutes the answer",
    "skipped": "not run: something that the case needs is missing",
    "not_built": "not run: this build lacks the solver",
}
UNMOVED: Final = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)


def rounded(x: float) -> float | None:
    """Returns x with four digits; None, which is null in JSON, for NaN and infinity."""
    return float(f"{x:.4g}") if math.isfinite(x) else None


def exact(x: float) -> float | str | None:
    """Returns x itself; None for NaN, and 'inf' or '-inf' for an infinity, which JSON lacks."""
    return x if math.isfinite(x) else None if math.isnan(x) else "inf" if x > 0 else "-inf"


@cache
def models() -> frozenset[str]:
    """Returns the names of the project's own models, which `measure` knows; experiments define
    others."""
    with MANIFEST.open("rb") as file:
        return frozenset(tomllib.load(file)["model"])


def prover(results: Results, row: int) -> str:
    """Returns the solver with which `measure` can prove the upper bound of a row; empty if it
    cannot: the solver writes no proofs, the question is another one, or a model is moved or known
    to the experiment alone.
    """
    cases = results.cases
    askable = (
        {str(cases.source[row]), str(cases.target[row])} <= models()
        and cases.quantity[row] == "directed"
        and cases.tolerance_of[row] == "diagonal"
    )
    unmoved = tuple(cases.pose[row]) == tuple(cases.target_pose[row]) == UNMOVED
    return (
        str(cases.solver[row])
        if askable and unmoved and cases.status[row] == "ok" and cases.solver[row] in PROVERS
        else ""
    )


def row_of(results: Results, row: int) -> dict[str, Any]:
    """Returns the values of one row by column. Errors are fractions of the diagonal of A."""
    cases, times = results.cases, results.total_seconds(row)
    return {
        "stem": results.stem,
        "solver": style.title(str(cases.solver[row]), str(results.names[row])),
        "scene": str(cases.scene[row]),
        "status": str(cases.status[row]),
        "reason": str(cases.reason[row]),
        "clock": results.clock_of(row),
        "check": results.check_of(row),
        "source": str(cases.source[row]),
        "target": str(cases.target[row]),
        "prover": prover(results, row),
        "tolerance": rounded(float(cases.tolerance[row])),
        "lower": exact(float(cases.lower[row])),
        "upper": exact(float(cases.upper[row])),
        "error": rounded(results.error(row) / results.length_unit(row)),
        "seconds": rounded(float(np.median(times))) if len(times) else None,
        "certified": int(cases.certified[row]),
        "pose": int(cases.pose_index[row]),
        "sizeA": int(cases.source_elements[row]),
        "sizeB": int(cases.target_elements[row]),
    }


def as_script(value: Any) -> str:
    """Returns a value as JSON that may stand in a script. Its texts have no hidden characters
    (printable.py)."""
    return printable(
        json.dumps(value, separators=(",", ":"), allow_nan=False, ensure_ascii=False), lines=True
    ).replace("<", "\\u003c")


def coded(values: Sequence[str]) -> dict[str, Any]:
    distinct = list(dict.fromkeys(values))
    place = {value: i for i, value in enumerate(distinct)}
    return {"values": distinct, "rows": [place[value] for value in values]}


def script(results: dict[str, Results]) -> str:
    """Returns JSON, safe inside a script: {column: {values, rows}} for texts, {column: [number,
    ...]} for numbers."""
    rows = [row_of(result, row) for result in results.values() for row in range(len(result.cases))]
    columns: dict[str, Any] = {}
    for name in TEXTS:
        columns[name] = coded([row[name] for row in rows])
    for name in NUMBERS:
        columns[name] = [row[name] for row in rows]
    return as_script(columns)
