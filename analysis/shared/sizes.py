"""Decides whether a result tests a paper's claims: it must include the sizes of its experiment's
profile `paper`."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Iterable
from dataclasses import replace
from typing import Any, Final

from analysis.shared import claims
from analysis.shared.load import REFERENCE
from analysis.shared.results import Results
from analysis.shared.verdicts import UNTESTED, Verdict

PAPER: Final = "paper"
# Top-level keys that are not compared: they set only how to measure, or are compared one by one
# (scenes, solvers).
HOW: Final = frozenset(
    {
        "title",
        "paper",
        "profile",
        "model",
        "scene",
        "solver",
        "rounds",
        "repeats",
        "limits",
        "trace",
        "fields",
        "stages",
        "reference",
        "expected_unsound",
        "claim",
        "plugins",
    }
)


def _asked(experiment: dict[str, Any], profile: str) -> set[str]:
    """Returns the scenes, solvers and other keys of a profile, each as text, so that profiles can
    be compared as sets."""
    top = experiment | experiment.get("profile", {}).get(profile, {})
    tables = []
    for kind in ("scene", "solver"):
        for table in top.get(kind, []):
            if profile in table.get("profiles", [profile]):
                kept = {k: v for k, v in table.items() if k not in ("profiles", "note")}
                tables.append((kind, kept))
    keys = [(key, value) for key, value in top.items() if key not in HOW]
    return {json.dumps(part, sort_keys=True, default=str) for part in [*tables, *keys]}


def tests_claims(results: Results) -> bool:
    """Tells whether the profile of the result requests everything that profile `paper` does.

    Also true if the result does not say what was requested.
    """
    experiment = tomllib.loads(str(results.meta.get("experiment_toml", "")))
    profile = str(results.meta.get("profile", ""))
    return (
        profile == PAPER
        or not experiment
        or _asked(experiment, PAPER) <= _asked(experiment, profile)
    )


def kept_outcome(claim: claims.Claim, stem: str) -> str:
    """Returns the outcome at the paper's sizes, from the verdicts in results/reference; empty if
    there is none."""
    for path in sorted(REFERENCE.glob(f"*{claims.SUFFIX}")):
        for record in claims.read(path):
            if (record["paper"], record["id"], record["stem"], record["place"]) == (
                claim.entry.paper,
                claim.entry.id,
                stem,
                claim.place,
            ) and record["claim"] == claim.removeprefix(f"{claim.place}: "):
                return str(record["outcome"])
    return ""


def tested(verdicts: Iterable[Verdict], results: Results, stem: str) -> list[Verdict]:
    """Returns the verdicts; they become `not tested` if the result has smaller sizes than the
    paper.

    Claims of ours keep their verdicts, except those that compare with a printed number.
    """
    if tests_claims(results):
        return list(verdicts)
    return [_untested(verdict, results, stem) for verdict in verdicts]


def _untested(verdict: Verdict, results: Results, stem: str) -> Verdict:
    claim = verdict.claim
    if not isinstance(claim, claims.Claim):
        return verdict
    if claim.entry.paper in (claims.OWN, claims.STATED) and "{printed" not in claim.entry.text:
        return verdict
    kept = kept_outcome(claim, stem)
    there = (
        f"at the paper's sizes: {kept}, see results/reference"
        if kept
        else "it has not been measured at the paper's sizes"
    )
    return replace(
        verdict,
        outcome=UNTESTED,
        evidence=f"at these sizes, profile {results.meta.get('profile')}; {there}",
        counted={},
    )
