"""Tier 3: measures pairs of blocks (fresh processes) of base and candidate, and pairs for the
self-test."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, ExitStack
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TypeVar

from analysis.shared.estimates import NO_DATA
from bench.tracking.blocks import Job, NotMeasured, job_of_case, job_of_kernels
from bench.tracking.builds import Build
from bench.tracking.cases import Case
from bench.tracking.gate import (
    PLANTED,
    SCREENING,
    Judged,
    Sides,
    compare,
    decided,
    judge,
    suspected,
)
from bench.tracking.places import Places
from bench.tracking.progress import Progress
from bench.tracking.together import together

T = TypeVar("T")

# The repeats of a block take this long, so that even a solve of 0.2 ms gets many turns on the
# shared core. The process itself takes 0.13 s.
SECONDS_OF_REPEATS = 0.05
MOST_REPEATS = 250

Say = Callable[[str], None]


@dataclass(frozen=True)
class Subject:
    """The work of a block: a case, or all kernels.

    `blocks` measures a block of each of the given sides at once, for the given names, and returns
    seconds by name for each side. `shapes` collects the shapes by side. `move` makes the next
    blocks, of either side, run under paths of another length.
    """

    name: str
    names: tuple[str, ...]
    blocks: Callable[[Sequence[str], Sequence[str]], list[dict[str, float]]]
    shapes: dict[str, str] = field(default_factory=dict)
    move: Callable[[], None] = lambda: None

    def block(self, side: str) -> dict[str, float]:
        return self.blocks([side], self.names)[0]


@dataclass(frozen=True)
class Program:
    """A program and the tree from which it was built."""

    file: Path
    tree: Path


def programs_of(base: Build, candidate: Build) -> dict[str, Program]:
    old, new = (Program(build.program, build.tree) for build in (base, candidate))
    return {"base": old, "base again": old, "candidate": new}


def kernels_of(base: Build, candidate: Build) -> dict[str, Program]:
    """Returns the kernels of both builds, or nothing if one of them has no kernel_bench."""
    if not (base.kernels and candidate.kernels):
        return {}
    return {
        "base": Program(base.kernels, base.tree),
        "candidate": Program(candidate.kernels, candidate.tree),
    }


def at_once(
    sides: Sequence[str],
    programs: dict[str, Program],
    places: Places,
    job: Callable[[str, Path, Path], AbstractContextManager[Job[T]]],
) -> list[T]:
    """Runs the job of each side, all at the same time; `job` gets the side, its program and its
    folder."""
    with ExitStack() as stack:
        jobs = []
        for number, side in enumerate(sides):
            root = stack.enter_context(places.root(programs[side].tree, number))
            jobs.append(stack.enter_context(job(side, programs[side].file, root)))
        results = together(jobs)
    return results


def of_case(case: Case, programs: dict[str, Program], folder: Path, places: Places) -> Subject:
    """Makes the subject of a case. The time of its first block sets the number of repeats in all
    later blocks."""
    current = [case]
    shapes: dict[str, str] = {}

    def blocks(sides: Sequence[str], _: Sequence[str]) -> list[dict[str, float]]:
        measured = at_once(
            sides,
            programs,
            places,
            lambda _, program, root: job_of_case(program, current[0], folder, root),
        )
        shapes.update({side: block.shapes for side, block in zip(sides, measured)})
        if current[0] is case:
            repeats = max(
                int(case.experiment["repeats"]),
                min(MOST_REPEATS, round(SECONDS_OF_REPEATS / measured[0].cpu)),
            )
            current[0] = Case(case.name, {**case.experiment, "repeats": repeats})
        return [{case.name: block.cpu} for block in measured]

    return Subject(case.name, (case.name,), blocks, shapes, places.move)


def of_kernels(
    names: Sequence[str], programs: dict[str, Program], folder: Path, places: Places
) -> Subject:
    def blocks(sides: Sequence[str], some: Sequence[str]) -> list[dict[str, float]]:
        return at_once(
            sides,
            programs,
            places,
            lambda _, program, root: job_of_kernels(program, list(some), folder, root),
        )

    return Subject("kernels", tuple(names), blocks, move=places.move)


@dataclass
class Known:
    """The subjects that both builds can measure. Lines about others: `broken` if only the candidate
    fails, else `left_out`."""

    subjects: list[Subject] = field(default_factory=list)
    left_out: list[str] = field(default_factory=list)
    broken: list[str] = field(default_factory=list)

    def add(self, subject: Subject) -> None:
        """Measures a subject once on each side, which warms caches, and adds it if both succeed."""
        try:
            base = subject.block("base")
        except NotMeasured as why:
            self.left_out.append(
                f"{subject.name}: left out, because the base does not measure it: {why}"
            )
            return
        try:
            candidate = subject.block("candidate")
        except NotMeasured as why:
            (self.left_out if why.skipped else self.broken).append(
                f"{subject.name}: the base measures it, but this build does not: {why}"
            )
            return
        if len(set(subject.shapes.values())) > 1:
            self.left_out.append(
                f"{subject.name}: left out, because it has other shapes than the base"
            )
            return
        both = tuple(name for name in subject.names if name in base and name in candidate)
        self.left_out += [
            f"{name}: left out, because {'the base' if name not in base else 'this build'} does not have it"
            for name in subject.names
            if name not in both
        ]
        if both:
            self.subjects.append(replace(subject, names=both))

    def for_self_test(self, wanted: str) -> Subject | None:
        """Returns the case of the self-test: the one with that name, or else the first."""
        cases = [subject for subject in self.subjects if subject.shapes]  # kernels have no shapes
        return next(
            (subject for subject in cases if subject.name == wanted), cases[0] if cases else None
        )


@dataclass(frozen=True)
class Question:
    """Is the side `slower` slower than `beside`? `sides` holds their times by name, with `slower`
    as the candidate.

    The times of `slower` are multiplied by `factor`, which plants a slowdown.
    """

    subject: Subject
    names: tuple[str, ...]
    sides: dict[str, Sides]
    beside: str = "base"
    slower: str = "candidate"
    factor: float = 1.0

    def turn(self, number: int, names: Sequence[str]) -> None:
        """Measures two pairs of blocks in opposite orders, each pair under another path length."""
        first, second = (self.slower, self.beside) if number % 2 else (self.beside, self.slower)
        for pair in ((first, second), (second, first)):
            self.subject.move()
            for side, seconds in zip(pair, self.subject.blocks(pair, names)):
                for name in names:
                    if name not in seconds:
                        raise NotMeasured(f"{name}: not measured this time")
                    sides = self.sides[name]
                    if side == self.slower:
                        sides.candidate.append(self.factor * seconds[name])
                    else:
                        sides.base.append(seconds[name])


def question(subject: Subject, names: Sequence[str]) -> Question:
    """Returns the question about the candidate, without any measurements yet."""
    return Question(subject, tuple(names), {name: Sides() for name in names})


def planted(subject: Subject) -> Question:
    """Returns the question of the self-test: the base beside itself, with a planted slowdown."""
    return replace(question(subject, subject.names), slower="base again", factor=1 + PLANTED)


def screen(questions: Sequence[Question], count: int) -> None:
    """Measures `count` blocks of each side; `count` is even."""
    progress = Progress(count // 2, "turns", "time")
    for number in range(count // 2):
        for question in questions:
            question.turn(number, question.names)
        progress.done(number + 1)


def answer(questions: Sequence[Question], count: int, cases: int) -> None:
    """Measures blocks of each question, up to `count` per side, until it is certain whether it
    alarms. `cases` sets the confidence."""
    progress = Progress(count // 2, "turns at most", "time")
    for number in range(count // 2):
        undecided = []
        for question in questions:
            names = [
                name for name in question.names if not decided(question.sides[name], count, cases)
            ]
            if names:
                undecided.append((question, names))
        if not undecided:
            progress.over()
            return
        for question, names in undecided:
            question.turn(number, names)
        progress.done(number + 1)


Run = dict[str, Sides]


def judge_all(common: Known, wanted: str, count: int, say: Say) -> tuple[list[Judged], list[Run]]:
    """Judges all cases. Also returns the times: the first run, the self-test, the second run.

    Measures SCREENING blocks of every case, then up to `count` blocks of suspected cases and of the
    self-test, in the case `wanted` if present. Cases that alarm are measured again. This second run
    is independent of the first, so its intervals need only the confidence for these few cases.
    """
    first = [question(subject, subject.names) for subject in common.subjects]
    screen(first, min(SCREENING, count))
    measured: Run = {name: sides for screened in first for name, sides in screened.sides.items()}
    cases = len(measured)
    suspects = []
    for screened in first:
        names = tuple(name for name in screened.names if suspected(screened.sides[name]))
        if names:
            suspects.append(replace(screened, names=names))
    say(
        f"more blocks of {', '.join([name for suspect in suspects for name in suspect.names] + ['the self-test'])}"
    )
    chosen = common.for_self_test(wanted)
    self_test = planted(chosen) if chosen else None
    answer([*suspects, *filter(None, [self_test])], count, cases)
    judged = [judge(name, sides, cases) for name, sides in measured.items()]
    runs = [measured]
    if self_test:
        runs.append(self_test.sides)
        ratio = {
            name: compare(sides.candidate, sides.base, cases)
            for name, sides in self_test.sides.items()
        }
        judged = [
            replace(case, planted=ratio[case.name]) if case.name in ratio else case
            for case in judged
        ]
    doubted = {case.name for case in judged if case.alarms}
    if not doubted:
        return judged, runs
    say(f"a second run of {', '.join(sorted(doubted))}")
    again = []
    for screened in first:
        names = tuple(name for name in screened.names if name in doubted)
        if names:
            again.append(question(screened.subject, names))
    answer(again, count, len(doubted))
    second: Run = {name: sides for repeated in again for name, sides in repeated.sides.items()}
    again_ratios = {
        name: compare(sides.candidate, sides.base, len(second)) for name, sides in second.items()
    }
    return [replace(case, second=again_ratios.get(case.name, NO_DATA)) for case in judged], [
        *runs,
        second,
    ]
