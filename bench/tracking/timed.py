"""Tier 3: base and candidate in turn, each block a fresh process, and the self-test in the same blocks."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from bench.tracking.blocks import NotMeasured, measure, measure_kernels
from bench.tracking.builds import Build
from bench.tracking.cases import Case
from bench.tracking.gate import PLANTED, Judged, Sides, judge

ORDER = ("base", "candidate", "planted", "planted", "candidate", "base")


# What the repeats of a block take together: the least of many is steadier than that of few, and a process costs as much by itself.
SECONDS_OF_REPEATS = 0.04
MOST_REPEATS = 40


@dataclass(frozen=True)
class Subject:
    """Something that is measured as one: a case, or all kernels. `side` measures one block: seconds by name."""

    name: str
    names: tuple[str, ...]
    side: Callable[[str], dict[str, float]]
    planted: bool = False


def of_case(case: Case, programs: dict[str, Path], folder: Path, planted: bool) -> Subject:
    """Its first block decides how many repeats the later ones have, on all sides alike."""
    asked = [case]

    def side(which: str) -> dict[str, float]:
        block = measure(programs[which], asked[0], folder, PLANTED if which == "planted" else 0)
        if asked[0] is case:
            repeats = min(MOST_REPEATS, max(int(case.experiment["repeats"]), round(SECONDS_OF_REPEATS / block.cpu)))
            asked[0] = Case(case.name, {**case.experiment, "repeats": repeats})
        return {case.name: block.cpu}

    return Subject(case.name, (case.name,), side, planted)


def of_kernels(names: Sequence[str], programs: dict[str, Path], folder: Path) -> Subject:
    def side(which: str) -> dict[str, float]:
        return measure_kernels(programs[which], list(names), folder)

    return Subject("kernels", tuple(names), side)


def programs_of(base: Build, candidate: Build) -> tuple[dict[str, Path], dict[str, Path]]:
    """By side: of the cases, and of the kernels (none where one of the two builds has no kernel_bench)."""
    cases = {"base": base.program, "candidate": candidate.program, "planted": candidate.program}
    if base.kernels is None or candidate.kernels is None:
        return cases, {}
    return cases, {"base": base.kernels, "candidate": candidate.kernels}


def known(subject: Subject, say: Callable[[str], None]) -> Subject | None:
    """What both builds can measure of it; each side measures once, which warms caches, and is not kept."""
    try:
        found = [subject.side(which) for which in ("base", "candidate")]
    except NotMeasured as why:
        say(f"{subject.name}: left out: {why}")
        return None
    both = tuple(name for name in subject.names if all(name in one for one in found))
    for name in subject.names:
        if name not in both:
            say(f"{name}: left out: only one of the builds has it")
    return Subject(subject.name, both, subject.side, subject.planted) if both else None


class Progress:
    """One line every fifth turn where nobody watches, one line that changes where somebody does."""

    def __init__(self, turns: int) -> None:
        self.turns, self.begun = turns, time.monotonic()

    def done(self, turns: int) -> None:
        spent = time.monotonic() - self.begun
        left = spent / turns * (self.turns - turns)
        text = f"time: {turns} of {self.turns} turns, {left:.0f} s left"
        if sys.stderr.isatty():
            print(f"\r{text}  ", end="\n" if turns == self.turns else "", file=sys.stderr, flush=True)
        elif turns % 5 == 0 or turns == self.turns:
            print(text, file=sys.stderr, flush=True)


def blocks(subjects: Sequence[Subject], count: int) -> dict[str, Sides]:
    """`count` blocks of each side, an even number: two a turn, right after each other, in turn from the base and from the candidate."""
    sides = {name: Sides() for subject in subjects for name in subject.names}
    progress = Progress(count // 2)
    for turn in range(count // 2):
        for subject in subjects:
            order = [which for which in ORDER if which != "planted" or subject.planted]
            if turn % 2:  # the candidate first: candidate, base, base, candidate
                order = [{"base": "candidate", "candidate": "base"}.get(which, which) for which in ORDER if which != "planted"]
                order = ["planted", *order, "planted"] if subject.planted else order
            for which in order:
                for name, seconds in subject.side(which).items():
                    if name in subject.names:
                        getattr(sides[name], which).append(seconds)
        progress.done(turn + 1)
    return sides


def judge_all(subjects: Sequence[Subject], count: int, say: Callable[[str], None]) -> tuple[list[Judged], dict[str, Sides]]:
    """Every case, and a second run of those that alarm; and all that was measured."""
    sides = blocks(subjects, count)
    judged = [judge(name, found, len(sides)) for name, found in sides.items()]
    doubted = {one.name for one in judged if one.alarms}
    if not doubted:
        return judged, sides
    say(f"a second run of {', '.join(sorted(doubted))}")
    again = [Subject(subject.name, names, subject.side) for subject in subjects if (names := tuple(n for n in subject.names if n in doubted))]
    second = blocks(again, count)
    return [with_second(one, second.get(one.name), len(sides)) for one in judged], sides


def with_second(one: Judged, second: Sides | None, cases: int) -> Judged:
    if second is None:
        return one
    return Judged(one.name, one.base_seconds, one.ratio, one.null, one.planted, judge(one.name, second, cases).ratio)
