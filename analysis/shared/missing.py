"""Rows that were never run, because a model is missing or the run is not complete, and what follows
for claims.

A claim about a set of rows is judged on all of them or not at all, so each claim that such a row
belongs to is 'not tested'.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Any, Final

import numpy as np

from analysis.shared import claims, remedy
from analysis.shared.columns import Ints
from analysis.shared.results import Results
from analysis.shared.verdicts import UNTESTED, Verdict

UNFINISHED: Final = (
    "not run: ",
    "in another shard",
)  # how the reasons of rows begin that this run leaves to later ones: plan.h, shard.h
FEW: Final = 3  # at most so many causes are printed


def missing_rows(results: Results) -> list[int]:
    """Returns the rows that were never run for lack of a model or the rest of the run. Rows taken
    out by without() count.

    Shapes that a solver does not take, and solvers or programs that are not installed, are not
    missing data: no claim about the other solvers depends on them.
    """
    whole = results.whole or results
    cases, models = whole.cases, set(whole.models.name)
    return [
        row
        for row in whole.rows(status="skipped")
        if cases.source[row] not in models
        or cases.target[row] not in models
        or str(cases.reason[row]).startswith(UNFINISHED)
    ]


def sentence(results: Results, rows: Sequence[int]) -> str:
    """Says how many rows are missing, why, and what to run: '8 of 674 rows are missing: package
    bunny was not fetched: ...'; empty for no rows."""
    if not rows:
        return ""
    cases = (results.whole or results).cases
    reasons = [
        str(cases.reason[row]).rsplit("' is missing: ", 1)[-1].partition(": run ") for row in rows
    ]
    causes = list(dict.fromkeys(cause for cause, _, _ in reasons))
    shown = ", ".join(causes[:FEW]) + (
        f" and {len(causes) - FEW} more" if len(causes) > FEW else ""
    )
    commands = dict.fromkeys(command for _, _, command in reasons if command)
    remedies = [f"run {command}" for command in commands]
    again = remedy.measure(
        str(results.meta.get("stem") or results.stem), str(results.meta.get("experiment_file", ""))
    )
    return f"{len(rows):,} of {len(cases):,} rows are missing: {shown}: {', '.join([*remedies, f'then run {again}' if remedies else f'run {again}'])}"


def note(results: Results) -> str:
    """Returns the note for tables and figures; empty if no row is missing."""
    return sentence(results, missing_rows(results))


def judged(verdicts: Iterable[Verdict], results: Results) -> list[Verdict]:
    """Returns the verdicts; those on claims that missing rows belong to become 'not tested', with
    what is missing."""
    missing = missing_rows(results)
    return (
        [_judged(verdict, results, missing) for verdict in verdicts] if missing else list(verdicts)
    )


def own(verdict: Verdict, results: Results, rows: Sequence[int]) -> list[int]:
    """Returns the rows that belong to the claim: if its `place` names a scene, only the rows of
    this scene."""
    scenes, place = (results.whole or results).cases.scene, verdict.claim.place if isinstance(
        verdict.claim, claims.Claim
    ) else ""
    there = [
        row for row, scene in enumerate(scenes) if place and str(scene).partition(": ")[0] == place
    ]
    return [row for row in rows if row in there] if there else list(rows)


def _judged(verdict: Verdict, results: Results, missing: Sequence[int]) -> Verdict:
    rows = own(verdict, results, missing)
    if verdict.outcome == UNTESTED or not rows:
        return verdict
    return replace(
        verdict, outcome=UNTESTED, evidence=sentence(results, rows), counted={}, ratio=None
    )


def without(results: Results) -> Results:
    """Returns the results without their missing rows, for scripts that draw what there is; `whole`
    keeps the original."""
    missing = missing_rows(results)
    if not missing:
        return results
    keep = np.ones(len(results.cases), dtype=bool)
    keep[missing] = False
    number: Ints = np.cumsum(keep) - 1

    def columns(group: object, chosen: object) -> dict[str, Any]:
        parts: dict[str, Any] = {}
        for name, column in vars(group).items():
            if isinstance(column, dict):
                parts[name] = {key: values[chosen] for key, values in column.items()}
            else:
                parts[name] = column[chosen]
        return parts

    def renumbered(group: object) -> dict[str, Any]:
        case: Ints = vars(group)["case"]
        kept = keep[case]
        return columns(group, kept) | {"case": number[case[kept]]}

    return replace(
        results,
        whole=results,
        cases=replace(results.cases, **columns(results.cases, keep)),
        **{
            name: replace(group, **renumbered(group))
            for name in ("answers", "repeats", "preparation", "fields")
            for group in [getattr(results, name)]
        },
    )
