"""Claims, from analysis/claims/<paper>.toml, and their verdicts as data.

A table in such a file is one claim: `claim` (the words that tables print, perhaps with {blanks}), `stem` (or a list of them) that judges it,
`judged_as` (average, every pair, most, never, ...), and the sentence of the paper, `quote`, with its `section`. Claims of our own are in
hausbench.toml and have neither. `counts = true` says that its ratio is one of counted work; `differs` says why it does not hold here, if that is known. A claim
with blanks has `in_general`: the same words without blanks, for a page on which it has no verdict. `untested` gives the reason why no script judges the sentence;
such a claim needs neither `stem` nor `judged_as`, and must not get a verdict.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Final

from analysis.shared import tables
from analysis.shared.verdicts import Ratio, Verdict

FOLDER: Final = Path(__file__).resolve().parents[1] / "claims"
OWN: Final = "hausbench"
STATED: Final = "experiment"  # in place of a paper, for claims that an experiment states itself
KEYS: Final = frozenset({"claim", "stem", "judged_as", "quote", "section", "counts", "differs", "in_general", "untested"})
SUFFIX: Final = ".verdicts.json"  # after the stem, or the name of a kept file of tables
Record = tables.Record


@dataclass(frozen=True)
class Entry:
    """A table of a claims file."""

    paper: str
    id: str
    stems: tuple[str, ...]
    text: str
    section: str
    quote: str
    judged_as: str
    counts: bool  # its ratio is of counted work, not of time
    differs: str  # why it does not hold here, if that is known
    in_general: str = ""  # its words without blanks, if it has blanks
    untested: str = ""  # why no script judges it


class Claim(str):
    """The words of a claim, with their entry. `place` is the only place for which it is claimed here, such as a scene."""

    entry: Entry
    place: str


@cache
def entries(paper: str) -> dict[str, Entry]:
    """The claims of a paper, by id. Raises ValueError for a missing or unknown key, with the file and the claim."""
    path = FOLDER / f"{paper}.toml"
    with path.open("rb") as file:
        return {name: _entry(path, name, table) for name, table in tomllib.load(file).items()}


def _entry(path: Path, name: str, table: dict[str, object]) -> Entry:
    needed = {"claim"} | (set() if table.get("untested") else {"stem", "judged_as"}) | (set() if path.stem == OWN else {"quote", "section"})
    if missing := sorted(needed - table.keys()):
        raise ValueError(f"{path}: claim '{name}' has no '{missing[0]}': add it")
    if unknown := sorted(table.keys() - KEYS):
        raise ValueError(f"{path}: claim '{name}' has the unknown key '{unknown[0]}': remove it")
    if "{" in str(table["claim"]) and "in_general" not in table:
        raise ValueError(f"{path}: claim '{name}' has blanks and no 'in_general': add the claim in words without blanks")
    stem = table.get("stem", [])
    stems = stem if isinstance(stem, list) else [stem]
    return Entry(path.stem, name, tuple(map(str, stems)), str(table["claim"]), str(table.get("section", "")), str(table.get("quote", "")),
                 str(table.get("judged_as", "")), bool(table.get("counts", False)), str(table.get("differs", "")), str(table.get("in_general", "")),
                 str(table.get("untested", "")))


def of(paper: str, name: str, place: str = "", **blanks: object) -> Claim:
    """The claim, its blanks filled in. Raises KeyError if the paper's file has no such claim, or a blank is left."""
    entry = entries(paper)[name]
    text = entry.text.format(**blanks)
    claim = Claim(f"{place}: {text}" if place else text)
    claim.entry, claim.place = entry, place
    return claim


def record(verdict: Verdict, stem: str, profile: str) -> Record:
    """One verdict as it stands in a file. Raises TypeError if its claim was typed and not taken from a claims file, and ValueError if the file does not
    name the stem, or says that no script judges the claim.
    """
    claim = verdict.claim
    if not isinstance(claim, Claim):
        raise TypeError(f"'{claim}' is not a claim of analysis/claims: take it from there with claims.of()")
    if claim.entry.untested:
        raise ValueError(f"{stem} judges the claim {claim.entry.paper}/{claim.entry.id}, which is marked untested: remove `untested`")
    if stem not in claim.entry.stems:
        raise ValueError(f"{stem} judges the claim {claim.entry.paper}/{claim.entry.id}: add it to its `stem`")
    return {"paper": claim.entry.paper, "id": claim.entry.id, "stem": stem, "claim": claim.removeprefix(f"{claim.place}: "), "place": claim.place,
            "section": claim.entry.section, "quote": claim.entry.quote, "judged_as": claim.entry.judged_as,
            "outcome": verdict.outcome, "evidence": verdict.evidence,
            "ratio": _ratio(verdict.ratio), "counted": {what: {"outcome": one.outcome, "evidence": one.evidence, "ratio": _ratio(one.ratio)}
                                                        for what, one in verdict.counted.items()}, "profile": profile}


def _ratio(ratio: Ratio | None) -> list[float | None] | None:
    """Returns [value, low, high] for JSON, with None for NaN and infinity; None if there is no ratio."""
    return [x if math.isfinite(x) else None for x in (ratio.value, ratio.low, ratio.high)] if ratio else None


def records(verdicts: Iterable[Verdict], stem: str, profile: str) -> list[Record]:
    return [record(verdict, stem, profile) for verdict in verdicts]


def read(path: Path) -> list[Record]:
    """Returns the verdicts of a file; none if there is no file. Raises ValueError if it is damaged."""
    return tables.read_json(path) if path.exists() else []
