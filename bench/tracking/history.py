"""The history of timings, results/history.csv: the time of each case at each commit, by machine.

    python3 -m bench.tracking.history REV ... [--blocks 8] [--no-instructions]

Measures the given commits and adds them. Every commit runs its cases with its own program on its
own models, in rounds: in each round, each commit measures each case once. Rounds go forth and back,
so that a drift of the machine affects all commits alike. A case that a commit does not know stays
empty. The file is written after every round, so Ctrl-C loses at most one round.

A run only adds rows. Times of two runs are never compared, because a machine is not equally fast
every day. To see the effect of a change, measure the last commit before it and the commit after it
in one run.
"""

from __future__ import annotations

import argparse
import csv
import dataclasses
import fcntl
import math
import os
import platform
import re
import subprocess
import sys
import time
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from datetime import datetime, timezone
from pathlib import Path
from typing import Any

import numpy as np

from analysis.shared.estimates import median
from bench.tracking import blocks as one_block
from bench.tracking import builds, counted, progress
from bench.tracking.blocks import Block, NotMeasured
from bench.tracking.builds import Build, NotBuilt
from bench.tracking.cases import KERNELS, ROOT, Case, Kernel, cases
from bench.tracking.progress import Progress

FILE = ROOT / "results" / "history.csv"
NAN = math.nan
TIME = "%Y-%m-%dT%H:%M:%SZ"
BLOCKS = 8  # the fewest whose range contains the median with 99 % confidence


@dataclass(frozen=True)
class Row:
    """A case at a commit on a machine: the median over blocks with its interval; each block is the
    least of its repeats."""

    commit: str  # ten digits
    date: str  # date of the commit, UTC
    machine: str
    measured: str  # start of the run that measured it, UTC
    case: str
    cpu_seconds: float = NAN  # NaN: not measured
    cpu_low: float = NAN  # also NaN with a single block
    cpu_high: float = NAN
    blocks: int = 0
    wall_seconds: float = NAN
    instructions: int | None = None
    counters: dict[str, int] = field(default_factory=dict)  # without zeros
    shapes: str = ""  # a hash; times of other shapes do not count for this case

    @property
    def key(self) -> tuple[str, ...]:
        return self.commit, self.machine, self.measured, self.case

    @property
    def session(self) -> tuple[str, str]:
        """Identifies the rows that were measured in turn with this one, so that their times can be
        compared."""
        return self.measured, self.machine


COLUMNS = [field.name for field in dataclasses.fields(Row)]


def cell(value: Any) -> str:
    if isinstance(value, dict):
        return " ".join(f"{name}={count}" for name, count in sorted(value.items()))
    if isinstance(value, float):
        return "" if math.isnan(value) else f"{value:.6g}"
    return "" if value is None else str(value)


def seconds_in(text: str) -> float:
    value = float(text) if text else NAN
    if text and not 0 < value < math.inf:
        raise ValueError(f"{text} is not a time")
    return value


def row_of(cells: list[str]) -> Row:
    """Reads a row. Raises ValueError with the reason."""
    if len(cells) != len(COLUMNS):
        raise ValueError(f"it has {len(cells)} cells, not {len(COLUMNS)}")
    values = dict(zip(COLUMNS, cells))
    if not re.fullmatch(r"[0-9a-f]{7,40}\+?", values["commit"]):
        raise ValueError(f"{values['commit']!r} is not a commit")
    datetime.strptime(values["date"], TIME)
    datetime.strptime(values["measured"], TIME)
    if not values["machine"] or not values["case"]:
        raise ValueError("the machine or the case is empty")
    if (values["blocks"] == "0") != (values["cpu_seconds"] == ""):
        raise ValueError("a row has both blocks and a time, or neither")
    pairs = [part.partition("=") for part in values["counters"].split()]
    cpu, low, high, wall = (
        seconds_in(values[name]) for name in ("cpu_seconds", "cpu_low", "cpu_high", "wall_seconds")
    )
    if math.isnan(low) != math.isnan(high) or low > cpu or cpu > high:
        raise ValueError("cpu_seconds is not between cpu_low and cpu_high")
    return Row(
        values["commit"],
        values["date"],
        values["machine"],
        values["measured"],
        values["case"],
        cpu,
        low,
        high,
        int(values["blocks"]),
        wall,
        int(values["instructions"]) if values["instructions"] else None,
        {name: int(count) for name, _, count in pairs},
        values["shapes"],
    )


def read(file: Path) -> list[Row]:
    """Returns all rows, or none if there is no file. Raises ValueError if the file is not a
    history."""
    if not file.exists():
        return []
    rows: dict[tuple[str, ...], Row] = {}
    lines = csv.reader(file.read_text(encoding="utf-8").splitlines())
    for cells in lines:
        try:
            if lines.line_num == 1:
                if cells != COLUMNS:
                    raise ValueError(f"the columns are not {','.join(COLUMNS)}")
                continue
            if (row := row_of(cells)).key in rows:
                raise ValueError(
                    f"{row.case} at {row.commit} on this machine is there twice in one run"
                )
        except ValueError as problem:
            raise ValueError(
                f"{file}, line {lines.line_num}: {problem}: correct or delete the line, or take the committed file "
                f"(git checkout {file})"
            ) from None
        rows[row.key] = row
    return list(rows.values())


def write(file: Path, rows: Iterable[Row]) -> None:
    """Sorts runs by time, and keeps the order of rows within a run. The file is complete at any
    time."""
    file.parent.mkdir(parents=True, exist_ok=True)
    new = file.with_name(file.name + ".part")
    with new.open("w", encoding="utf-8") as out:
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow(COLUMNS)
        for row in sorted(rows, key=lambda row: row.session):
            writer.writerow([cell(getattr(row, column)) for column in COLUMNS])
    new.replace(file)


@contextmanager
def alone(folder: Path) -> Iterator[None]:
    """Holds a lock on the folder, so that two processes do not write at once."""
    folder.mkdir(parents=True, exist_ok=True)
    handle = os.open(folder, os.O_RDONLY)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX)
        yield
    finally:
        os.close(handle)


def add(file: Path, rows: Sequence[Row]) -> list[Row]:
    """Writes the rows of a run so far, in place of its earlier ones, and returns all rows of the
    file. Keeps the rows of other runs."""
    with alone(file.parent):
        keys = {row.key for row in rows}
        every = [row for row in read(file) if row.key not in keys] + list(rows)
        write(file, every)
    return every


def in_order(commits: dict[str, str]) -> list[str]:
    """Sorts commits, oldest first: by ancestry if git knows them, because many have the same
    second; others by the given dates."""
    bare = {commit: commit.rstrip("+") for commit in commits}
    try:
        hashes = builds.git(
            "rev-list", "--topo-order", "--reverse", "--ignore-missing", *bare.values()
        ).split()
    except builds.NotBuilt:
        hashes = []
    there = {
        commit: i
        for i, whole in enumerate(hashes)
        for commit in commits
        if whole.startswith(bare[commit])
    }

    def key(commit: str) -> tuple[int, bool, str, str]:
        later_than = [
            place for earlier, place in there.items() if commits[earlier] <= commits[commit]
        ]
        return (
            there.get(commit, max(later_than, default=-1)),
            commit not in there,
            commits[commit],
            commit,
        )

    return sorted(commits, key=key)


def compiler() -> str:
    try:
        return (
            "g++ "
            + subprocess.run(
                ["g++", "-dumpfullversion"], capture_output=True, text=True, check=True
            ).stdout.strip()
        )
    except (OSError, subprocess.CalledProcessError):
        return "no g++"


def machine(cpuinfo: str, compiled_by: str) -> str:
    """Returns a short text for the machine; times of machines with different texts are never
    compared."""
    model = re.search(r"^model name\s*: *(.+)$", cpuinfo, re.M)
    name = re.sub(r"\((R|TM|tm)\)", "", model[1]) if model else f"{platform.machine()} processor"
    cores = len(re.findall(r"^processor\s*:", cpuinfo, re.M))
    flags = re.search(r"^flags\s*:(.*)$", cpuinfo, re.M)
    vectors = "AVX-512" if flags and re.search(r"\bavx512f\b", flags[1]) else "no AVX-512"
    return f"{' '.join(name.split())}, {cores} core{'s' if cores != 1 else ''}, {compiled_by}, {vectors}"


def this_machine() -> str:
    return machine(Path("/proc/cpuinfo").read_text(encoding="utf-8"), compiler())


@dataclass
class Version:
    """A commit that is being measured."""

    build: Build
    date: str
    measured: dict[str, list[Block]] = field(default_factory=dict)
    empty: dict[str, str] = field(default_factory=dict)  # the reason, for cases that stay empty
    told: set[str] = field(default_factory=set)  # cases of `empty` that were already reported
    instructions: dict[str, int] = field(default_factory=dict)

    @property
    def folder(self) -> Path:
        """Returns the folder for its cases, inside its worktree, so that the program uses the
        models of that commit."""
        folder = self.build.tree / "build" / "history"
        folder.mkdir(parents=True, exist_ok=True)
        return folder


def say(text: str) -> None:
    progress.say("history", text)


def tell(versions: Sequence[Version]) -> None:
    """Reports cases left out since the last report: a line for each reason, with its cases and
    commits."""
    left_out: dict[tuple[str, tuple[str, ...]], list[str]] = {}
    for version in versions:
        new = [name for name in version.empty if name not in version.told]
        for why in dict.fromkeys(version.empty[name] for name in new):
            left_out.setdefault(
                (why, tuple(name for name in new if version.empty[name] == why)), []
            ).append(version.build.commit)
        version.told.update(new)
    for (why, names), commits in left_out.items():
        say(f"{', '.join(commits)}: no blocks from here on: {', '.join(names)}: {why}")


def short(problem: Exception) -> str:
    """Removes the temporary file name and the list of known names, so that an error reads the same
    for every case."""
    return re.sub(
        r" \(known: .*|(?<=unknown solver) .*",
        "",
        re.sub(r"^exit code \d+: hausbench: \S+?(:\d+)?: ", "", str(problem)),
    )[:150]


def as_text(seconds: float) -> str:
    return datetime.fromtimestamp(seconds, timezone.utc).strftime(TIME)


def date_of(commit: str) -> str:
    return as_text(int(builds.git("show", "--no-patch", "--format=%ct", commit)))


def versions_of(revisions: Sequence[str]) -> list[Version]:
    """Builds the commits, and returns the ones that build, oldest first and each once. Raises
    NotBuilt if there is none."""
    by_commit: dict[str, Version] = {}
    for revision in revisions:
        try:
            build = builds.build_of(revision)
        except NotBuilt as problem:
            say(f"{revision} is left out: {problem}")
            continue
        by_commit[build.commit] = Version(build, date_of(build.commit))
    if not by_commit:
        raise NotBuilt("there is no commit to measure")
    dates = {commit: version.date for commit, version in by_commit.items()}
    return [by_commit[commit] for commit in in_order(dates)]


def measure_kernels(version: Version, names: list[str]) -> None:
    """Measures one block of every kernel that the commit has."""
    least, why = {}, "there is no kernel_bench"
    if version.build.kernels is not None:
        try:
            least, why = (
                one_block.measure_kernels(version.build.kernels, names, version.folder),
                "kernel_bench does not have it",
            )
        except NotMeasured as problem:
            why = short(problem)
    for name, seconds in least.items():
        version.measured.setdefault(name, []).append(Block(seconds, NAN, NAN, ""))
    version.empty.update({name: why for name in names if name not in least})


def one_round(
    versions: Sequence[Version],
    chosen: Sequence[Case],
    kernels: list[str],
    number: int,
    bar: Progress,
) -> None:
    """Measures one block of each case and kernel at each commit. Measures a case at all commits
    before the next case, so that they meet the same load of the machine.
    """
    turn = list(versions) if number % 2 == 0 else list(versions)[::-1]
    for i, case in enumerate(chosen):
        for version in turn:
            if case.name in version.empty:
                continue
            try:
                version.measured[case.name] = [
                    *version.measured.get(case.name, []),
                    one_block.measure(version.build.program, case, version.folder),
                ]
            except NotMeasured as problem:
                version.empty[case.name] = short(problem)
        bar.done(number * (len(chosen) + 1) + i + 1)
    for version in turn:
        measurable = [name for name in kernels if name not in version.empty]
        if measurable:
            measure_kernels(version, measurable)
    bar.done((number + 1) * (len(chosen) + 1))


def drop_other_shapes(versions: Sequence[Version], chosen: Sequence[Case]) -> None:
    """Drops the times of a case at commits where its shapes differ from the newest commit that
    measured it."""
    for case in chosen:
        measured = [version for version in versions if version.measured.get(case.name)]
        for version in measured:
            if version.measured[case.name][0].shapes != measured[-1].measured[case.name][0].shapes:
                del version.measured[case.name]
                version.empty[case.name] = f"it has other shapes than {measured[-1].build.commit}"


def rows_of(version: Version, names: Iterable[str], where: str, begun: str) -> list[Row]:
    rows = []
    for name in names:
        row = Row(version.build.commit, version.date, where, begun, name)
        kept = version.measured.get(name, [])
        if kept:
            last = kept[-1]
            cpu = median([block.cpu for block in kept])
            wall = [block.wall for block in kept]
            row = dataclasses.replace(
                row,
                cpu_seconds=cpu.value,
                cpu_low=cpu.low,
                cpu_high=cpu.high,
                blocks=cpu.n,
                counters={counter: count for counter, count in last.counters.items() if count},
                wall_seconds=float(np.median(wall)),
                shapes=last.shapes,
                instructions=version.instructions.get(name),
            )
        rows.append(row)
    return rows


def count_instructions(version: Version, chosen: Sequence[Case], kernels: Sequence[Kernel]) -> None:
    """Counts instructions of everything that has a time. Counts do not vary with load, so once is
    enough, and several run at once."""
    timed_cases = [case for case in chosen if case.name in version.measured]
    timed_kernels = [kernel for kernel in kernels if kernel.name in version.measured]
    jobs = counted.jobs_of(
        timed_cases, timed_kernels, version.build.program, version.build.kernels, version.folder
    )
    version.instructions = {
        name: count[0]
        for name, count in counted.in_parallel(jobs).items()
        if not isinstance(count, NotMeasured)
    }


def measure(
    revisions: Sequence[str],
    file: Path = FILE,
    blocks: int = BLOCKS,
    instructions: bool = True,
    only: Sequence[Case] | None = None,
    kernels: Sequence[Kernel] = KERNELS,
) -> list[Row]:
    """Builds and measures these commits, writes the file after every round, and returns all its
    rows. Raises NotBuilt if no commit builds."""
    chosen, names = cases() if only is None else only, [kernel.name for kernel in kernels]
    where, begun = this_machine(), as_text(time.time())
    read(file)  # report an error in the file before building anything
    versions = versions_of(revisions)
    for version in versions:
        builds.fetch(version.build.tree, {model for case in chosen for model in case.models})

    def save() -> list[Row]:
        every_name = [*(case.name for case in chosen), *names]
        return add(
            file,
            [row for version in versions for row in rows_of(version, every_name, where, begun)],
        )

    say(
        f"{len(versions)} commits, {len(chosen)} cases and {len(names)} kernels, {blocks} blocks each, on {where}"
    )
    bar = Progress(blocks * (len(chosen) + 1), "turns", "history")
    for number in range(blocks):
        one_round(versions, chosen, names, number, bar)
        drop_other_shapes(versions, chosen)
        tell(versions)
        rows = save()
    bar = Progress(len(versions), "commits with instructions", "history")
    for i, version in enumerate(versions if instructions else []):
        count_instructions(version, chosen, kernels)
        bar.done(i + 1)
        rows = save()
    return rows


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("revisions", nargs="+", metavar="REV", help="commits to measure")
    parser.add_argument(
        "--blocks",
        type=int,
        default=BLOCKS,
        help=f"fresh processes of each case at each commit (default: {BLOCKS})",
    )
    parser.add_argument(
        "--no-instructions",
        action="store_true",
        help="do not count instructions, which takes some seconds for each case of each commit",
    )
    parser.add_argument("--csv", type=Path, default=FILE)
    options = parser.parse_args(arguments)
    if options.blocks < 1:
        parser.error("--blocks must be at least 1")
    try:
        rows = measure(options.revisions, options.csv, options.blocks, not options.no_instructions)
    except (ValueError, NotBuilt) as problem:
        say(str(problem))
        return 2
    except KeyboardInterrupt:
        say(f"interrupted; {options.csv} has the finished rounds")
        return 130
    print(f"{options.csv}: {len(rows)} rows; make report draws them")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
