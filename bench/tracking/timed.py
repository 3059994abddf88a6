"""Tier 3: base and candidate in turn, each block a fresh process, and the self-test in the same blocks."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from bench.tracking.blocks import NotMeasured, measure, measure_kernels
from bench.tracking.builds import Build
from bench.tracking.cases import Case
from bench.tracking.gate import PLANTED, SCREENING, Judged, Sides, judge, suspected
from bench.tracking.progress import Progress

BASE_FIRST = ("base", "candidate", "planted", "planted", "candidate", "base")
CANDIDATE_FIRST = ("planted", "candidate", "base", "base", "candidate", "planted")
# What the repeats of a block take together: the least of many is steadier than that of few, and a process costs as much by itself.
SECONDS_OF_REPEATS = 0.04
MOST_REPEATS = 40

Say = Callable[[str], None]


@dataclass(frozen=True)
class Subject:
    """Something that is measured as one: a case, or all kernels. `side` measures a block of that side, of these names: seconds by name.
    What it found of the shapes is in `shapes`, by side.
    """

    name: str
    names: tuple[str, ...]
    side: Callable[[str, Sequence[str]], dict[str, float]]
    planted: bool = False
    shapes: dict[str, str] = field(default_factory=dict)

    def block(self, which: str) -> dict[str, float]:
        return self.side(which, self.names)


@dataclass(frozen=True)
class Placed:
    """A program, and a link to its tree."""

    program: Path
    root: Path


def programs_of(base: Build, candidate: Build, folder: Path) -> dict[str, Placed]:
    """Both trees are reached by links of one length. Names of files lie among the data of a solve, so longer ones may move what it works
    on to other addresses: `scan` was slower by 4.5 % where only the path of the tree was another.
    """
    placed = {}
    for name, build in (("tree-1", base), ("tree-2", candidate)):
        (folder / name).symlink_to(build.tree.resolve(), target_is_directory=True)
        placed[name] = Placed(build.program, folder / name)
    return {"base": placed["tree-1"], "candidate": placed["tree-2"], "planted": placed["tree-2"]}


def kernels_of(base: Build, candidate: Build) -> dict[str, Path]:
    """None where one of the two builds has no kernel_bench."""
    return {"base": base.kernels, "candidate": candidate.kernels} if base.kernels and candidate.kernels else {}


def of_case(case: Case, programs: dict[str, Placed], folder: Path) -> Subject:
    """Its first block decides how many repeats the later ones have, on all sides alike."""
    asked = [case]
    shapes: dict[str, str] = {}

    def side(which: str, _: Sequence[str]) -> dict[str, float]:
        placed = programs[which]
        block = measure(placed.program, asked[0], folder, PLANTED if which == "planted" else 0, placed.root)
        shapes[which] = block.shapes
        if asked[0] is case:
            repeats = min(MOST_REPEATS, max(int(case.experiment["repeats"]), round(SECONDS_OF_REPEATS / block.cpu)))
            asked[0] = Case(case.name, {**case.experiment, "repeats": repeats})
        return {case.name: block.cpu}

    return Subject(case.name, (case.name,), side, shapes=shapes)


def of_kernels(names: Sequence[str], programs: dict[str, Path], folder: Path) -> Subject:
    def side(which: str, some: Sequence[str]) -> dict[str, float]:
        return measure_kernels(programs[which], list(some), folder)

    return Subject("kernels", tuple(names), side)


@dataclass
class Known:
    """What both builds can measure; what was left out, and what the candidate alone fails at, each with its reason."""

    subjects: list[Subject] = field(default_factory=list)
    left_out: list[str] = field(default_factory=list)
    broken: list[str] = field(default_factory=list)

    def add(self, subject: Subject) -> None:
        """Each side measures once, which warms caches and is not kept."""
        try:
            base = subject.block("base")
        except NotMeasured as why:
            self.left_out.append(f"{subject.name}: left out, since the base does not measure it: {why}")
            return
        try:
            candidate = subject.block("candidate")
        except NotMeasured as why:
            (self.left_out if why.skipped else self.broken).append(f"{subject.name}: the base measures it, this build does not: {why}")
            return
        if len(set(subject.shapes.values())) > 1:
            self.left_out.append(f"{subject.name}: left out, since its shapes are not those of the base")
            return
        both = tuple(name for name in subject.names if name in base and name in candidate)
        self.left_out += [f"{name}: left out, since {'the base' if name not in base else 'this build'} does not have it"
                          for name in subject.names if name not in both]
        if both:
            self.subjects.append(replace(subject, names=both))

    def plant(self, wanted: str) -> None:
        """In the case of that name, or else in the first one."""
        cases = [subject for subject in self.subjects if subject.shapes]  # kernels have none
        chosen = next((subject for subject in cases if subject.name == wanted), cases[0] if cases else None)
        self.subjects = [replace(subject, planted=subject is chosen) for subject in self.subjects]


def blocks(subjects: Sequence[Subject], count: int, sides: dict[str, Sides] | None = None) -> dict[str, Sides]:
    """`count` blocks of each side, an even number: two a turn. Turns begin with the base and with the candidate, alternately. They are
    added to `sides`, where there are some already.
    """
    sides = {} if sides is None else sides
    for name in (name for subject in subjects for name in subject.names):
        sides.setdefault(name, Sides())
    progress = Progress(count // 2, "turns", "time")
    for turn in range(count // 2):
        for subject in subjects:
            for which in CANDIDATE_FIRST if turn % 2 else BASE_FIRST:
                if which == "planted" and not subject.planted:
                    continue
                found = subject.block(which)
                for name in subject.names:
                    if name not in found:
                        raise NotMeasured(f"{name}: it was not measured this time")
                    getattr(sides[name], which).append(found[name])
        progress.done(turn + 1)
    return sides


def of_names(subjects: Sequence[Subject], names: Collection[str], planted: bool) -> list[Subject]:
    """Those names alone; with the plant, if wanted."""
    return [replace(subject, names=some, planted=subject.planted and planted) for subject in subjects
            if (some := tuple(name for name in subject.names if name in names or (subject.planted and planted)))]


def judge_all(subjects: Sequence[Subject], count: int, say: Say) -> tuple[list[Judged], list[dict[str, Sides]]]:
    """SCREENING blocks of every case, and `count` of those that are suspected and of the one with the plant; then a second run of those
    that alarm. And what each run measured. The second run is independent of the first, which chose its cases, so its intervals need
    the confidence of so few.
    """
    first = blocks(subjects, min(SCREENING, count))
    if count > SCREENING:
        suspects = {name for name, found in first.items() if suspected(found)}
        say(f"more blocks of {', '.join(sorted(suspects)) or 'nothing but the planted slowdown'}")
        blocks(of_names(subjects, suspects, planted=True), count - SCREENING, first)
    judged = [judge(name, found, len(first)) for name, found in first.items()]
    doubted = {one.name for one in judged if one.alarms}
    if not doubted:
        return judged, [first]
    say(f"a second run of {', '.join(sorted(doubted))}")
    second = blocks(of_names(subjects, doubted, planted=False), count)
    seconds = {name: judge(name, found, len(second)).ratio for name, found in second.items()}
    return [replace(one, second=seconds[one.name]) if one.name in seconds else one for one in judged], [first, second]
