"""The claims of each paper as the report prints them: verdicts, and the reasons why some do not
hold."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final

from analysis import paper_page
from analysis.paper_page import Line
from analysis.shared.verdicts import FAILS, HOLDS, NOT_JUDGED, NOT_REFUTED, OPEN, UNTESTED

ORDER: Final = (HOLDS, NOT_REFUTED, FAILS, OPEN, NOT_JUDGED, UNTESTED)
CLASSES: Final = {
    HOLDS: "holds",
    NOT_REFUTED: "holds",
    FAILS: "fails",
    OPEN: "open",
    NOT_JUDGED: "open",
    UNTESTED: "untested",
}
SIGNS: Final = {HOLDS: "✓", NOT_REFUTED: "✓", FAILS: "✗", OPEN: "≈", NOT_JUDGED: "≈", UNTESTED: "–"}
UNFIT: Final = (
    HOLDS,
    NOT_REFUTED,
)  # verdicts that contradict a text on why the claim does not hold


@dataclass(frozen=True)
class Outcome:
    """A verdict as a page shows it."""

    words: str
    evidence: str = ""

    @property
    def css(self) -> str:
        return CLASSES[self.words]

    @property
    def sign(self) -> str:
        return SIGNS[self.words]


@dataclass(frozen=True)
class Shown:
    """A claim of a paper, or its part about one scene."""

    id: str
    section: str
    quote: str
    claim: str
    judged_as: str
    verdict: Outcome
    counted: Sequence[tuple[str, Outcome]]  # the same in counted work, by kind
    stem: str
    kept: bool
    why: str  # why it does not hold, or is not tested; empty if the line before says so

    @property
    def against(self) -> bool:
        return self.verdict.words == FAILS


def shown(line: Line) -> Shown:
    counted: dict[str, Any] = dict(line.verdict["counted"]) if line.verdict else {}  # type: ignore[call-overload]
    evidence = str(line.verdict["evidence"]) if line.verdict else ""
    return Shown(
        line.entry.id,
        line.entry.section,
        line.entry.quote,
        line.name,
        line.entry.judged_as,
        Outcome(line.outcome, evidence),
        [
            (measure, Outcome(str(verdict["outcome"]), str(verdict["evidence"])))
            for measure, verdict in counted.items()
        ],
        str(line.verdict["stem"]) if line.verdict else ", ".join(line.entry.stems),
        line.kept,
        paper_page.why(line),
    )


@dataclass(frozen=True)
class Paper:
    title: str
    lines: Sequence[Shown]

    @property
    def against(self) -> list[Shown]:
        """The verdicts that say a claim does not hold."""
        return [line for line in self.lines if line.against]

    @property
    def holding(self) -> list[Shown]:
        """The verdicts that say a claim holds, or is not refuted."""
        return [line for line in self.lines if line.verdict.words in (HOLDS, NOT_REFUTED)]

    def count(self, css: str) -> int:
        """The number of verdicts of one class: holds, fails, open or untested."""
        return sum(line.verdict.css == css for line in self.lines)

    @property
    def kept(self) -> int:
        """The number of verdicts that are kept from longer runs."""
        return sum(line.kept for line in self.lines)

    @property
    def counts(self) -> list[tuple[Outcome, int]]:
        tally = Counter(line.verdict.words for line in self.lines)
        return [(Outcome(words), tally[words]) for words in ORDER if tally[words]]


def paper(name: str, lines: Sequence[Line]) -> Paper:
    """Returns the claims of a paper: first those that do not hold, then the others, each in the
    order of the paper."""
    all_lines = [shown(line) for line in lines]
    ordered = [line for line in all_lines if line.against]
    ordered += [line for line in all_lines if not line.against]
    without_repeats = [
        replace(line, why="")
        if before is not None and (before.id, before.why) == (line.id, line.why)
        else line
        for before, line in zip([None, *ordered], ordered)
    ]
    return Paper(paper_page.TITLES.get(name, name), without_repeats)


def misfits(lines: Iterable[Line]) -> list[str]:
    """Returns a line for each claim that does not hold and has no `why_not`, or holds and has one.

    A claim has several verdicts if it is judged on several scenes. Its text fits as long as one of
    them is 'does not hold', or none is decided.
    """
    by_claim: dict[tuple[str, str], list[Line]] = {}
    for line in lines:
        by_claim.setdefault((line.entry.paper, line.entry.id), []).append(line)
    problems = []
    for (name, claim), claim_lines in by_claim.items():
        outcomes, text = {line.outcome for line in claim_lines}, claim_lines[0].entry.why_not
        file = f"analysis/claims/{name}.toml"
        if FAILS in outcomes and not text:
            problems.append(
                f"{name}/{claim}: does not hold, and {file} does not say why: add `why_not`"
            )
        elif text and FAILS not in outcomes and outcomes & set(UNFIT):
            verdict = next(line.outcome for line in claim_lines if line.outcome in UNFIT)
            problems.append(
                f"{name}/{claim}: {file} says why it does not hold, and the verdict is '{verdict}': remove `why_not`, or find out what changed"
            )
    return problems
