"""Claims that an experiment states itself: `[[claim]] solver = "mine" faster_than = "sacht" by =
1.5`."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from typing import Any

from analysis.shared import claims, style
from analysis.shared.cells import Cell, compare
from analysis.shared.over_pairs import on_average
from analysis.shared.results import Results
from analysis.shared.verdicts import UNTESTED, Verdict, everywhere


def verdicts(results: Results, asked: Mapping[Any, Mapping[str, Cell]]) -> list[Verdict]:
    """Returns one verdict for each claim in the experiment file, of which the result has a copy.
    Uses the questions that both solvers were asked.
    """
    stated = tomllib.loads(str(results.meta.get("experiment_toml") or "")).get("claim", [])
    return [_judged(results, claim, number, asked) for number, claim in enumerate(stated)]


def _judged(
    results: Results,
    stated: Mapping[str, Any],
    number: int,
    asked: Mapping[Any, Mapping[str, Cell]],
) -> Verdict:
    fast, slow, by = str(stated["solver"]), str(stated["faster_than"]), float(stated.get("by", 1.0))
    both = [
        cells
        for cells in asked.values()
        if slow in cells
        and fast in cells
        and not all(
            results.cases.from_trace[row] for name in (slow, fast) for row in cells[name].rows
        )
    ]  # so that no measurement counts twice
    every = stated.get("on") == "every" or len(both) == 1  # one case has no average
    claim = claims.Claim(
        f"{_title(results, fast)} takes less time than {_title(results, slow)} {'on every case' if every else 'on average'}"
        + (f", by a factor of {by:g}" if by != 1 else "")
    )
    claim.entry = claims.Entry(
        claims.STATED,
        f"claim_{number + 1}",
        (f"{results.stem}_table",),
        str(claim),
        "",
        "",
        "every pair" if every else "average",
        False,
        "",
    )
    claim.place = ""
    if fast == slow:
        return Verdict(
            claim, UNTESTED, "it compares a solver with itself: name another one in the claim"
        )
    for name in (fast, slow):
        labels = list(dict.fromkeys(label for cells in asked.values() for label in cells))
        if name not in labels and (
            swept := [label for label in labels if label.startswith(f"{name}(")]
        ):
            return Verdict(
                claim,
                UNTESTED,
                f"'{name}' is not one solver here: it was run as {', '.join(swept)}; name one of these in the claim",
            )
    if every:
        return everywhere(claim, [compare(cells[slow], cells[fast], by) for cells in both], "cases")
    return on_average(claim, [compare(cells[slow], cells[fast]) for cells in both], by)


def _title(results: Results, name: str) -> str:
    rows = [
        row
        for row in range(len(results.cases))
        if name in (results.cases.label[row], results.names[row])
    ]
    return style.title(results.cases.solver[rows[0]], name) if rows else name
