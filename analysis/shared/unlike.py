"""Rows of other shapes than the kept numbers: they are not compared with these, and their claims
are not judged beside kept verdicts.

results/reference/derived.sha256 lists derived models of the kept results with the hash of the
shape, as /models has it, and names the version of CGAL. Another version may simplify and remesh a
model to another mesh, whose distances are other ones; so a derived model that is not in the list
counts as another shape if the version differs.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final

from analysis.shared import claims, missing, sizes, table_files
from analysis.shared.load import REFERENCE
from analysis.shared.results import ResultError, Results
from analysis.shared.verdicts import UNTESTED, Verdict

LIST: Final = (
    REFERENCE / "derived.sha256"
)  # a line "# CGAL VERSION", then lines "HASH  MODEL", sorted by model
FEW: Final = 3  # at most so many models are named


def kept(path: Path) -> dict[str, str]:
    """Returns the kept hashes by model, and the first line under the name ""; empty if the list
    does not exist."""
    lines = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
    parts = [line.partition("  ") for line in lines]
    return {model: sha256 for sha256, _, model in parts}


def _cgal(results: Results) -> str:
    return f"# CGAL {json.loads(results.meta.get('libraries') or '{}').get('CGAL', 'unknown')}"


def same_cgal(results: Results) -> bool:
    """Tells whether the program has the version of CGAL that derived the kept shapes, if any are
    kept. Then it should derive the same."""
    return kept(LIST).get("", _cgal(results)) == _cgal(results)


def models(results: Results) -> list[str]:
    """Returns the models that are not known to be the kept shapes of their names."""
    hashes, same, columns = (
        kept(LIST),
        same_cgal(results),
        (results.models.name, results.models.sha256, results.models.source),
    )
    return sorted(
        str(name)
        for name, sha256, source in zip(*columns)
        if hashes.get(name, sha256 if same or source != "derived" else "") != sha256
    )


def rows(results: Results) -> list[int]:
    """Returns the rows whose A or B is not known to be the kept shape. Rows taken out by
    missing.without() count."""
    whole, other = results.whole or results, set(models(results))
    return (
        [
            row
            for row in range(len(whole.cases))
            if {whole.cases.source[row], whole.cases.target[row]} & other
        ]
        if other
        else []
    )


def sentence(results: Results, found: Sequence[int]) -> str:
    """Says how many rows these are, and of which models: '24 of 30 rows are not of the kept shapes:
    bunny_half'; empty for no rows."""
    if not found:
        return ""
    cases, names = (results.whole or results).cases, models(results)
    used = {model for row in found for model in (cases.source[row], cases.target[row])}
    named = [name for name in names if name in used]
    shown = ", ".join(named[:FEW]) + (f" and {len(named) - FEW} more" if len(named) > FEW else "")
    return f"{len(found):,} of {len(cases):,} rows are not of the kept shapes: {shown}"


def judged(verdicts: Iterable[Verdict], results: Results, stem: str) -> list[Verdict]:
    """Returns the verdicts; one that has a kept verdict becomes 'not tested' if rows of other
    shapes belong to its claim."""
    other = rows(results)
    return (
        [_judged(verdict, results, other, stem) for verdict in verdicts]
        if other
        else list(verdicts)
    )


def _judged(verdict: Verdict, results: Results, other: Sequence[int], stem: str) -> Verdict:
    claim_rows = missing.own(verdict, results, other)
    claim = verdict.claim
    before = (
        sizes.kept_outcome(claim, stem) if claim_rows and isinstance(claim, claims.Claim) else ""
    )
    if verdict.outcome == UNTESTED or not before:
        return verdict
    return replace(
        verdict,
        outcome=UNTESTED,
        evidence=f"{sentence(results, claim_rows)}; of those: {before}, see results/reference",
        counted={},
        ratio=None,
    )


def expect_none(results: Results) -> None:
    """Raises ResultError if there are such rows, because kept numbers must all be of the kept
    shapes."""
    if unlike_rows := rows(results):
        raise ResultError(
            f"{results.path}: cannot be kept: {sentence(results, unlike_rows)}: measure it with the CGAL of the kept numbers, or remove the line "
            f"of a model that was changed on purpose from {LIST}"
        )


def keep(results: Results) -> None:
    """Adds the derived models of these results to the list."""
    before, columns = kept(LIST), (
        results.models.name,
        results.models.sha256,
        results.models.source,
    )
    new = {
        str(name): str(sha256)
        for name, sha256, source in zip(*columns)
        if source == "derived" and name not in before
    }
    if new:
        lines = [
            f"{sha256}  {model}" if model else sha256
            for model, sha256 in sorted(({"": _cgal(results)} | before | new).items())
        ]
        table_files.write_whole(LIST, "\n".join(lines) + "\n")
