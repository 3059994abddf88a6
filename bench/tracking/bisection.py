"""Finds the commit that changed the counted work of a case, unattended: git bisect does the search.

    python3 -m bench.tracking.bisection --case NAME --good REV --bad REV [--by auto|counters|instructions]

GOOD is the older commit; BAD may do more or less work. Both are measured first. By default, work
counters decide if they differ, else the instructions of the solve. Each commit in between is built
in build/versions/bisect and assigned to the side whose counts are nearer. A commit that does not
build, or does not know the case or its shapes, is skipped. No clock is involved, so other load does
not matter. Only cases of experiments/tracking.toml can be searched: kernels (build/bvh, ...) count
no work.

Exit code 0: the commit is found; 1: one of several commits, because those between them could only
be skipped; 2: a usage error, or nothing differs; 130: Ctrl-C.
"""

from __future__ import annotations

import argparse
import fcntl
import json
import math
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path

from bench.tracking import blocks, builds, counted, progress
from bench.tracking.blocks import NotMeasured
from bench.tracking.builds import NotBuilt
from bench.tracking.cases import EXPERIMENT, KERNELS, ROOT, Case, cases, chosen

WAYS = ("auto", "counters", "instructions")
SAME = 1e-4  # smaller differences count as equal: instruction counts depend slightly on the length of paths
GOOD, BAD, SKIP, ABORT = 0, 1, 125, 255  # the meaning of exit codes to `git bisect run`
Counts = dict[str, int]


class Unclear(Exception):
    """The search is impossible; the message says why."""


@dataclass(frozen=True)
class Measured:
    counters: Counts
    shapes: str
    instructions: int | None = None
    uncounted: str = ""  # the reason why there are no instructions

    def counts(self, by: str) -> Counts:
        return (
            self.counters
            if by == "counters"
            else {}
            if self.instructions is None
            else {"instructions": self.instructions}
        )


@dataclass(frozen=True)
class Question:
    """The question of each step: is this commit nearer to `good` or to `bad`?"""

    case: str
    experiment: str  # the file with the cases, always from this tree
    by: str
    good: Counts
    bad: Counts
    shapes: str
    log: str  # a line of JSON for each measured commit


def git_in(tree: Path, *words: str) -> str:
    return builds.git("-C", str(tree), *words)


def restored(tree: Path) -> None:
    """Undoes changes to the commit's files, which would stay in the next commit or block its
    checkout."""
    git_in(tree, "checkout", "--quiet", "--force", "--detach", "HEAD")


def case_named(name: str, experiment: Path) -> Case:
    """Returns the case. Raises ValueError unless exactly one case has the name."""
    all_cases = cases(experiment)
    names_a_kernel = any(kernel.name.startswith(name) for kernel in KERNELS)
    names_a_case = any(case.name.startswith(name) for case in all_cases)
    if names_a_kernel and not names_a_case:
        raise ValueError(
            f"{name!r} is a kernel: kernels count no work, so they cannot be searched; `make history` measures "
            "their times and instructions at several commits"
        )
    matching = chosen([name], all_cases)
    exact = [case for case in matching if case.name == name]
    if len(exact or matching) != 1:
        raise ValueError(
            f"{name!r} names more than one case: {', '.join(case.name for case in matching)}"
        )
    return (exact or matching)[0]


def measure(tree: Path, case: Case, by: str) -> Measured:
    """Builds and counts the checked-out commit. Raises NotBuilt or NotMeasured. Leaves the commit's
    files unchanged."""
    restored(tree)
    try:
        return built_and_counted(tree, case, by)
    finally:
        restored(tree)


def built_and_counted(tree: Path, case: Case, by: str) -> Measured:
    commit = git_in(tree, "rev-parse", "--short=10", "HEAD")
    build = builds.build_in(tree, commit, os.cpu_count() or 1)
    builds.fetch(tree, case.models)
    with tempfile.TemporaryDirectory(dir=tree / "build", prefix="bisect-") as folder:
        block = blocks.measure(build.program, case, Path(folder))
        if by == "counters":
            return Measured(block.counters, block.shapes)
        count = counted.instructions_of(build.program, case, Path(folder))
        if isinstance(count, NotMeasured):
            return Measured(block.counters, block.shapes, uncounted=str(count))
        return Measured(block.counters, block.shapes, count)


def differing(good: Mapping[str, int], bad: Mapping[str, int], least: float = 0) -> list[str]:
    """Returns the counters that both have and that are more than `least` apart(). A missing counter
    was not counted; it is not 0."""
    return [
        name for name in sorted(good.keys() & bad.keys()) if apart(good[name], bad[name]) > least
    ]


def apart(first: int, second: int) -> float:
    """Returns |log((1 + first) / (1 + second))|, which is finite even for counts of 0."""
    return abs(math.log1p(first) - math.log1p(second))


def decided_by(good: Measured, bad: Measured, by: str) -> str:
    """Returns the kind of count to search by: "counters" or "instructions". Raises Unclear if none
    that `by` allows differs."""
    if good.shapes != bad.shapes:
        raise Unclear(
            "good and bad have different shapes in this case, so their work says nothing about the code"
        )
    ways = [
        way
        for way in WAYS[1:]
        if by in ("auto", way)
        and differing(good.counts(way), bad.counts(way), SAME if way == "instructions" else 0)
    ]
    if not ways:
        reason = {
            "auto": "neither work counters nor instructions differ",
            "counters": "work counters do not differ",
            "instructions": "instructions do not differ",
        }[by]
        uncounted = "".join(
            f" (instructions of {name} are not counted: {side.uncounted})"
            for name, side in (("good", good), ("bad", bad))
            if side.uncounted
        )
        raise Unclear(
            f"{reason} between good and bad, as far as both could be counted{uncounted}: there is no commit to search for; if the time still "
            "differs, look at libraries, the compiler and the layout of the program"
        )
    return ways[0]


def is_bad(counts: Mapping[str, int], good: Mapping[str, int], bad: Mapping[str, int]) -> bool:
    """Returns whether the counts are nearer to bad than to good: sums apart() over the counters in
    which these two differ. Raises NotMeasured if none of them was counted.
    """
    names = [name for name in differing(good, bad) if name in counts]
    if not names:
        raise NotMeasured("none of the differing counts is known at this commit")
    to_good = sum(apart(counts[name], good[name]) for name in names)
    to_bad = sum(apart(counts[name], bad[name]) for name in names)
    return to_bad < to_good


def step(tree: Path, question: Question) -> int:
    """Measures one commit for `git bisect run`, and returns the exit code."""
    commit = git_in(tree, "rev-parse", "HEAD")
    try:
        measured = measure(tree, case_named(question.case, Path(question.experiment)), question.by)
        if measured.shapes != question.shapes:
            raise NotMeasured("its shapes are different")
        counts = measured.counts(question.by)
        bad = is_bad(counts, question.good, question.bad)
    except (NotBuilt, NotMeasured) as why:
        say(f"{commit[:10]} is skipped: {why}")
        return SKIP
    with open(question.log, "a", encoding="utf-8") as log:
        log.write(json.dumps({"commit": commit, "counts": counts}) + "\n")
    say(
        f"{commit[:10]} is {'bad' if bad else 'good'}: {text_of(counts, differing(question.good, question.bad))}"
    )
    return BAD if bad else GOOD


def say(text: str) -> None:
    progress.say("bisect", text)


def text_of(counts: Mapping[str, int], names: list[str]) -> str:
    return ", ".join(f"{name} {counts[name]:,}" for name in names if name in counts)


@contextmanager
def locked(file: Path) -> Iterator[int]:
    """Holds a lock; raises Unclear if another process has it. Children inherit the descriptor, so a
    step that outlives its search keeps the lock.
    """
    file.parent.mkdir(parents=True, exist_ok=True)
    with file.open("w") as stream:
        try:
            fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise Unclear(
                f"another search is running in {file.with_suffix('')}: wait until it ends, or stop it"
            ) from None
        yield stream.fileno()


def checked_out(tree: Path, commit: str) -> None:
    """Checks out a commit in its own worktree, and undoes the remains of an interrupted search."""
    builds.worktree(tree, commit)  # first: `bisect reset` stops at a merge that did not end
    git_in(tree, "bisect", "reset", "HEAD")


def in_order(good: str, bad: str) -> None:
    """Raises ValueError unless good comes before bad."""
    if good == bad:
        raise ValueError(f"good and bad are the same commit, {good}")
    cut = (
        "; this clone is shallow: git fetch --unshallow"
        if builds.git("rev-parse", "--is-shallow-repository") == "true"
        else ""
    )
    try:
        base = builds.git("merge-base", good, bad)
    except NotBuilt:  # git finds no merge base and prints nothing
        raise ValueError(
            f"good ({good}) and bad ({bad}) have no commit in common here{cut}"
        ) from None
    if base.startswith(bad):
        raise ValueError(
            f"good ({good}) is newer than bad ({bad}): swap them; good is the older one, even if it does more work"
        )
    if not base.startswith(good):
        raise ValueError(
            f"good ({good}) is not an ancestor of bad ({bad}): use {base[:10]}, where they diverge, as good{cut}"
        )


def search(tree: Path, ends: list[str], question: Path, command: list[str], lock: int) -> list[str]:
    """Returns the first bad commit, or several if skipped commits hide which one it is.

    `command` runs step(), given the question's file. After a failure or Ctrl-C, the next search
    cleans up.
    """
    git_in(tree, "bisect", "start", ends[1], ends[0])
    done = subprocess.run(
        ["git", "-C", str(tree), "bisect", "run", *command, str(question)],
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        check=False,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        text=True,
        pass_fds=[lock],
    )
    last = git_in(tree, "rev-parse", "refs/bisect/bad")
    goods = git_in(tree, "for-each-ref", "--format=%(objectname)", "refs/bisect/good-*").split()
    left = git_in(tree, "rev-list", last, "--not", *goods).split()
    skipped = git_in(tree, "for-each-ref", "--format=%(objectname)", "refs/bisect/skip-*").split()
    if done.returncode != 0 and not all(commit == last or commit in skipped for commit in left):
        raise NotBuilt(f"git bisect run ended with {done.returncode}: {done.stdout.strip()[-300:]}")
    git_in(tree, "bisect", "reset", "HEAD")
    return [last] if done.returncode == 0 else left


def report(suspects: list[str], question: Question) -> None:
    """Prints the commit, and the counts on both sides of it."""
    names = differing(question.good, question.bad)
    log = [json.loads(line) for line in Path(question.log).read_text(encoding="utf-8").splitlines()]
    counts_of = {line["commit"]: line["counts"] for line in log}
    print(
        "first bad commit:"
        if len(suspects) == 1
        else "the first bad commit is one of these; the others could not be measured:"
    )
    for commit in suspects:
        print(f"  {builds.git('show', '--no-patch', '--format=%h %cs %s', commit)}")
    parents = builds.git("rev-list", "--parents", "-n", "1", suspects[-1]).split()[1:]
    for word, commits in (("before", parents), ("after", suspects[:1])):
        for commit in commits:
            counts = text_of(counts_of[commit], names) if commit in counts_of else "not measured"
            print(f"  {word}: {commit[:10]}: {counts}")


def find(
    case: Case, revisions: tuple[str, str], by: str, experiment: Path, command: list[str]
) -> int:
    ends = [builds.commit_of(revision) for revision in revisions]
    in_order(ends[0], ends[1])
    with locked(builds.VERSIONS / "bisect.lock") as lock, tempfile.TemporaryDirectory() as folder:
        tree, log, file = (
            builds.VERSIONS / "bisect",
            Path(folder) / "log",
            Path(folder) / "question.json",
        )
        way, sides = both_ends(tree, case, ends, by)
        counts = [side.counts(way) for side in sides]
        whole = [builds.git("rev-parse", commit) for commit in ends]
        log.write_text(
            "".join(
                json.dumps({"commit": commit, "counts": side_counts}) + "\n"
                for commit, side_counts in zip(whole, counts)
            ),
            encoding="utf-8",
        )
        question = Question(
            case.name, str(experiment), way, counts[0], counts[1], sides[0].shapes, str(log)
        )
        file.write_text(json.dumps(asdict(question)), encoding="utf-8")
        suspects = search(tree, ends, file, command, lock)
        report(suspects, question)
    return 0 if len(suspects) == 1 else 1


def both_ends(tree: Path, case: Case, ends: list[str], by: str) -> tuple[str, list[Measured]]:
    """Returns "counters" or "instructions", whichever decides, and the measurements of good and
    bad. Raises Unclear if one has none."""
    sides = []
    for commit in ends:
        checked_out(tree, commit)
        try:
            sides.append(measure(tree, case, by))
        except NotMeasured as why:
            raise Unclear(f"{commit} does not measure {case.name}: {why}") from None
    way = decided_by(sides[0], sides[1], by)
    counts = [side.counts(way) for side in sides]
    for word, commit, side_counts in zip(("good", "bad"), ends, counts):
        say(f"{word}: {commit}: {text_of(side_counts, differing(counts[0], counts[1]))}")
    return way, sides


# -P: git runs the step in a worktree that has another version of this package.
STEP = [sys.executable, "-P", "-m", "bench.tracking.bisection", "--step"]


def main(arguments: list[str], command: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--case",
        help="a case of experiments/tracking.toml, not a kernel; the beginning of its name is enough",
    )
    parser.add_argument("--good", metavar="REV", help="the older commit")
    parser.add_argument("--bad", metavar="REV", help="the newer commit")
    parser.add_argument("--by", choices=WAYS, default="auto")
    parser.add_argument("--experiment", type=Path, default=EXPERIMENT)
    parser.add_argument(
        "--step",
        type=Path,
        metavar="QUESTION",
        help="for git bisect run: measure one commit, in the current folder",
    )
    options = parser.parse_args(arguments)
    if options.step:
        try:
            return step(
                Path.cwd(), Question(**json.loads(options.step.read_text(encoding="utf-8")))
            )
        except KeyboardInterrupt:  # the search reports it
            return ABORT
        except (
            BaseException
        ) as problem:  # Python's own exit code for an uncaught exception is 1, which would call the commit bad
            say(f"stopped: {type(problem).__name__}: {problem}")
            return ABORT
    if not (options.case and options.good and options.bad):
        parser.error("give --case, --good and --bad")
    try:
        experiment = options.experiment.resolve()
        return find(
            case_named(options.case, experiment),
            (options.good, options.bad),
            options.by,
            experiment,
            command or STEP,
        )
    except (NotBuilt, Unclear, ValueError) as problem:
        say(str(problem))
        return 2
    except KeyboardInterrupt:
        say("interrupted; the next search starts over")
        return 130


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
