"""Reads claims from analysis/claims/<paper>.toml, and converts their verdicts to and from JSON.

Each table of such a file is one claim, with these keys (a stem is the name of an experiment and of
its figure or table):

    claim        the words that tables print, perhaps with {blanks}
    in_general   the same words without blanks, printed for a claim without a verdict; required if `claim` has blanks
    stem         the stem that judges it, or a list of stems
    judged_as    average, every pair, most, never, ...
    quote        the sentence of the paper; our own claims, in hausbench.toml, have no quote and no section
    section      the section of that sentence
    counts       true: the claim is about counted work, not time
    differs      the difference between our setup and the claim's
    why_not      a paragraph on why the claim does not hold. A claim with the verdict 'does not hold' needs one; analysis.report names a claim
                 whose verdict no longer fits
    untested     why no script judges it; such a claim needs neither `stem` nor `judged_as`, and must not get a verdict
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Final

from analysis.shared import table_files, tables
from analysis.shared.verdicts import OUTCOMES, Ratio, Verdict

FOLDER: Final = Path(__file__).resolve().parents[1] / "claims"
OWN: Final = "hausbench"
STATED: Final = "experiment"  # used as the paper of claims that an experiment file states itself
KEYS: Final = frozenset(
    {
        "claim",
        "stem",
        "judged_as",
        "quote",
        "section",
        "counts",
        "differs",
        "why_not",
        "in_general",
        "untested",
    }
)
SUFFIX: Final = ".verdicts.json"  # of the files with verdicts
TEXTS: Final = (
    "paper",
    "id",
    "stem",
    "claim",
    "place",
    "section",
    "quote",
    "judged_as",
    "profile",
)  # keys of a record
Record = tables.Record


@dataclass(frozen=True)
class Entry:
    """A claim of a claims file."""

    paper: str
    id: str
    stems: tuple[str, ...]
    text: str
    section: str
    quote: str
    judged_as: str
    counts: bool  # the ratio is of counted work, not of time
    differs: str  # the difference between our setup and the claim's
    in_general: str = ""  # the text without blanks; empty if `text` has none
    untested: str = ""  # why no script judges the claim
    why_not: str = ""  # why the claim does not hold


class Claim(str):
    """The text of a claim with its blanks filled in, and its entry. `place` limits the claim, for
    example to one scene."""

    entry: Entry
    place: str


@cache
def entries(paper: str) -> dict[str, Entry]:
    """Reads the claims of a paper, by id. Raises ValueError for a missing or unknown key."""
    path = FOLDER / f"{paper}.toml"
    with path.open("rb") as file:
        return {name: _entry(path, name, table) for name, table in tomllib.load(file).items()}


def _entry(path: Path, name: str, table: dict[str, object]) -> Entry:
    needed = (
        {"claim"}
        | (set() if table.get("untested") else {"stem", "judged_as"})
        | (set() if path.stem == OWN else {"quote", "section"})
    )
    if missing := sorted(needed - table.keys()):
        raise ValueError(f"{path}: claim '{name}' has no '{missing[0]}': add it")
    if unknown := sorted(table.keys() - KEYS):
        raise ValueError(f"{path}: claim '{name}' has the unknown key '{unknown[0]}': remove it")
    if "{" in str(table["claim"]) and "in_general" not in table:
        raise ValueError(
            f"{path}: claim '{name}' has blanks and no 'in_general': add the claim in words without blanks"
        )
    stem = table.get("stem", [])
    stems = stem if isinstance(stem, list) else [stem]
    return Entry(
        path.stem,
        name,
        tuple(map(str, stems)),
        str(table["claim"]),
        str(table.get("section", "")),
        str(table.get("quote", "")),
        str(table.get("judged_as", "")),
        bool(table.get("counts", False)),
        str(table.get("differs", "")),
        str(table.get("in_general", "")),
        str(table.get("untested", "")),
        str(table.get("why_not", "")),
    )


def of(paper: str, name: str, place: str = "", **blanks: object) -> Claim:
    """Returns the claim with its blanks filled in. Raises KeyError if the paper's file has no such
    claim, or a blank is left."""
    entry = entries(paper)[name]
    text = entry.text.format(**blanks)
    claim = Claim(f"{place}: {text}" if place else text)
    claim.entry, claim.place = entry, place
    return claim


def record(verdict: Verdict, stem: str, profile: str) -> Record:
    """Returns a verdict as a record for a JSON file.

    Raises TypeError if its claim is not from a claims file, and ValueError if that file does not
    list the stem for the claim or marks the claim as untested.
    """
    claim = verdict.claim
    if not isinstance(claim, Claim):
        raise TypeError(
            f"'{claim}' is not a claim of analysis/claims: take it from there with claims.of()"
        )
    if claim.entry.untested:
        raise ValueError(
            f"{stem} judges the claim {claim.entry.paper}/{claim.entry.id}, which is marked untested: remove `untested`"
        )
    if stem not in claim.entry.stems:
        raise ValueError(
            f"{stem} judges the claim {claim.entry.paper}/{claim.entry.id}: add it to its `stem`"
        )
    return {
        "paper": claim.entry.paper,
        "id": claim.entry.id,
        "stem": stem,
        "claim": claim.removeprefix(f"{claim.place}: "),
        "place": claim.place,
        "section": claim.entry.section,
        "quote": claim.entry.quote,
        "judged_as": claim.entry.judged_as,
        "outcome": verdict.outcome,
        "evidence": verdict.evidence,
        "ratio": _ratio(verdict.ratio),
        "counted": {
            measure: {
                "outcome": part.outcome,
                "evidence": part.evidence,
                "ratio": _ratio(part.ratio),
            }
            for measure, part in verdict.counted.items()
        },
        "profile": profile,
    }


def _ratio(ratio: Ratio | None) -> list[float | None] | None:
    """Returns [value, low, high] for JSON, with None for NaN and infinity; None if there is no
    ratio."""
    return (
        [x if math.isfinite(x) else None for x in (ratio.value, ratio.low, ratio.high)]
        if ratio
        else None
    )


def records(verdicts: Iterable[Verdict], stem: str, profile: str) -> list[Record]:
    return [record(verdict, stem, profile) for verdict in verdicts]


def read(path: Path) -> list[Record]:
    """Reads the verdicts of a file; none if there is no file. Raises ValueError if it is
    damaged."""
    verdicts = table_files.read_json(path) if path.exists() else []
    for verdict in verdicts:
        if not _is_record(verdict):
            raise ValueError(
                f"{path}: '{str(verdict)[:60]}' is not a verdict: "
                "write it again with 'hausbench draw'"
            )
    return verdicts


def _is_record(candidate: Mapping[str, object]) -> bool:
    """Returns whether this is what record() returns."""

    def judged(part: object) -> bool:
        return (
            isinstance(part, Mapping)
            and part.get("outcome") in OUTCOMES
            and isinstance(part.get("evidence"), str)
            and _is_ratio(part.get("ratio"))
        )

    counted = candidate.get("counted")
    has_texts = all(isinstance(candidate.get(name), str) for name in TEXTS)
    return (
        has_texts
        and judged(candidate)
        and isinstance(counted, Mapping)
        and all(judged(part) for part in counted.values())
    )


def _is_ratio(ratio: object) -> bool:
    return (
        ratio is None
        or isinstance(ratio, list)
        and len(ratio) == 3
        and all(x is None or type(x) in (int, float) for x in ratio)
    )
