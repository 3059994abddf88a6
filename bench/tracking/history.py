"""The history of timings, results/history.csv: what each case took at each commit, machine by machine.

    python3 -m bench.tracking.history [--measure REV ...] [--blocks 8] [--no-instructions]

measures the commits that --measure names, if any, and draws the whole history (picture.py). Every commit runs its cases by its own program, on its
own models, in rounds: in each round each commit measures each case once. Rounds go forth and back, so that a drift of the machine falls on all alike.
What a commit does not know stays empty. The file is written after every round: Ctrl-C loses at most the round that it interrupts.
"""

from __future__ import annotations

import argparse
import csv
import dataclasses
import math
import os
import platform
import re
import subprocess
import sys
import time
import tomllib
from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from datetime import datetime, timezone
from pathlib import Path
from typing import Any

import numpy as np

from analysis.shared.statistics import median
from bench.tracking import blocks as one_block
from bench.tracking import builds
from bench.tracking.blocks import Block, NotMeasured
from bench.tracking.builds import Build, NotBuilt
from bench.tracking.cases import KERNELS, ROOT, Case, Kernel, cases

FILE = ROOT / "results" / "history.csv"
NAN = math.nan
BLOCKS = 8  # the fewest whose range is an interval of 99 %


@dataclass(frozen=True)
class Row:
    """A case at a commit on a machine: the median of the blocks, each the least of its repeats, with its interval."""

    commit: str  # ten digits
    date: str  # of the commit, UTC
    machine: str
    case: str
    cpu_seconds: float = NAN  # NaN: not measured
    cpu_low: float = NAN  # NaN too where there is one block only
    cpu_high: float = NAN
    blocks: int = 0
    wall_seconds: float = NAN
    instructions: int | None = None
    counters: dict[str, int] = field(default_factory=dict)
    shapes: str = ""  # a hash: times of other shapes are no times of this case

    @property
    def key(self) -> tuple[str, str, str]:
        return self.commit, self.machine, self.case


COLUMNS = [one.name for one in dataclasses.fields(Row)]


def cell(value: Any) -> str:
    if isinstance(value, dict):
        return " ".join(f"{name}={count}" for name, count in sorted(value.items()))
    if isinstance(value, float):
        return "" if math.isnan(value) else f"{value:.6g}"
    return "" if value is None else str(value)


def seconds_in(text: str) -> float:
    value = float(text) if text else NAN
    if text and not 0 < value < math.inf:
        raise ValueError(f"{text} is no time")
    return value


def row_of(cells: list[str]) -> Row:
    """ValueError says what is wrong."""
    if len(cells) != len(COLUMNS):
        raise ValueError(f"it has {len(cells)} cells, not {len(COLUMNS)}")
    known = dict(zip(COLUMNS, cells))
    if not re.fullmatch(r"[0-9a-f]{7,40}\+?", known["commit"]):
        raise ValueError(f"{known['commit']!r} is no commit")
    datetime.strptime(known["date"], "%Y-%m-%dT%H:%M:%SZ")
    if not known["machine"] or not known["case"]:
        raise ValueError("the machine or the case is empty")
    if (known["blocks"] == "0") != (known["cpu_seconds"] == ""):
        raise ValueError("there are no blocks without a time, and no time without blocks")
    pairs = [part.partition("=") for part in known["counters"].split()]
    return Row(known["commit"], known["date"], known["machine"], known["case"], seconds_in(known["cpu_seconds"]), seconds_in(known["cpu_low"]),
               seconds_in(known["cpu_high"]), int(known["blocks"]), seconds_in(known["wall_seconds"]),
               int(known["instructions"]) if known["instructions"] else None, {name: int(count) for name, _, count in pairs}, known["shapes"])


def read(file: Path) -> list[Row]:
    """All rows; none where there is no file. ValueError for what is no history."""
    if not file.exists():
        return []
    rows: dict[tuple[str, str, str], Row] = {}
    lines = csv.reader(file.read_text(encoding="utf-8").splitlines())
    for cells in lines:
        try:
            if lines.line_num == 1:
                if cells != COLUMNS:
                    raise ValueError(f"the columns are not {','.join(COLUMNS)}")
                continue
            if (row := row_of(cells)).key in rows:
                raise ValueError(f"{row.case} at {row.commit} on this machine is there twice")
        except ValueError as problem:
            raise ValueError(f"{file}, line {lines.line_num}: {problem}: mend or delete the line, or take the file that is committed "
                             f"(git checkout {file})") from None
        rows[row.key] = row
    return list(rows.values())


def write(file: Path, rows: Iterable[Row]) -> None:
    """In order of the dates of the commits, then of cases. The file is whole at any time."""
    file.parent.mkdir(parents=True, exist_ok=True)
    new = file.with_name(file.name + ".part")
    with new.open("w", encoding="utf-8") as out:
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow(COLUMNS)
        for row in sorted(rows, key=lambda row: (row.date, row.commit, row.case, row.machine)):
            writer.writerow([cell(getattr(row, column)) for column in COLUMNS])
    new.replace(file)


def merged(old: Iterable[Row], new: Iterable[Row], finished: bool = True) -> list[Row]:
    """What was measured again on the same machine replaces the old row, but an empty row replaces nothing, and before all rounds are finished nothing
    replaces a row with more blocks. Instructions that were not counted again stay where the shapes are the same: a commit's count does not change.
    """
    rows = {row.key: row for row in old}
    for row in new:
        before = rows.get(row.key)
        if before and row.blocks < (1 if finished else before.blocks):
            continue
        if before and row.instructions is None and row.shapes == before.shapes:
            row = dataclasses.replace(row, instructions=before.instructions)
        rows[row.key] = row
    return list(rows.values())


def compiler() -> str:
    try:
        return "g++ " + subprocess.run(["g++", "-dumpfullversion"], capture_output=True, text=True, check=True).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        return "no g++"


def machine(cpuinfo: str, compiled_by: str) -> str:
    """One short text: times of two machines whose texts differ are never compared."""
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
    empty: dict[str, str] = field(default_factory=dict)  # cases that stay empty, and why
    told: set[str] = field(default_factory=set)  # those of them that were told
    instructions: dict[str, int] = field(default_factory=dict)

    @property
    def tree(self) -> Path:
        return self.build.program.parents[2]

    @property
    def folder(self) -> Path:
        """Where its cases run: inside its worktree, so that the program takes the models of that commit."""
        folder = self.tree / "build" / "history"
        folder.mkdir(parents=True, exist_ok=True)
        return folder

    def tell(self) -> None:
        """What is left out since it was told last: a line for each reason."""
        new = [name for name in self.empty if name not in self.told]
        for why in dict.fromkeys(self.empty[name] for name in new):
            names = ", ".join(name for name in new if self.empty[name] == why)
            say(f"{self.build.commit}: no blocks from here on: {names}: {why}")
        self.told.update(new)


def say(text: str) -> None:
    print(f"history: {text}", file=sys.stderr, flush=True)


def short(problem: Exception) -> str:
    """Without the file, whose name is new each time, and without names: so that a mistake reads the same for every case."""
    return re.sub(r" \(known: .*|(?<=unknown solver) .*", "", re.sub(r"^exit code \d+: hausbench: \S+?(:\d+)?: ", "", str(problem)))[:150]


class Progress:
    """Says at most every ten seconds how long the rest will take, by how long the part that is done took."""

    def __init__(self) -> None:
        self._begun = time.monotonic()
        self._said = -math.inf

    def at(self, what: str, done: float) -> None:
        now = time.monotonic()
        if now - self._said < 10:
            return
        self._said = now
        left = f", about {(now - self._begun) * (1 - done) / done / 60:.1f} min left" if done > 0 else ""
        say(f"{what}{left}")


def date_of(commit: str) -> str:
    seconds = int(builds.git("show", "--no-patch", "--format=%ct", commit))
    return datetime.fromtimestamp(seconds, timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")


def versions_of(revisions: Sequence[str]) -> list[Version]:
    """In order of their dates, each once; those that do not build are left out. NotBuilt where none is left."""
    found: dict[str, Version] = {}
    for revision in revisions:
        try:
            build = builds.build_of(revision)
        except NotBuilt as problem:
            say(f"{revision} is left out: {problem}")
            continue
        found[build.commit] = Version(build, date_of(build.commit))
    if not found:
        raise NotBuilt("no commit is there to be measured")
    return sorted(found.values(), key=lambda version: version.date)


def measure_kernels(version: Version, names: list[str]) -> None:
    """One block of every kernel that the commit has."""
    least, why = {}, "there is no kernel_bench"
    if version.build.kernels is not None:
        try:
            least, why = one_block.measure_kernels(version.build.kernels, names, version.folder), "kernel_bench does not have it"
        except NotMeasured as problem:
            why = short(problem)
    for name, seconds in least.items():
        version.measured.setdefault(name, []).append(Block(seconds, NAN, NAN, ""))
    version.empty.update({name: why for name in names if name not in least})


def one_round(versions: Sequence[Version], chosen: Sequence[Case], kernels: list[str], number: int, rounds: int, progress: Progress) -> None:
    """One block of each case and each kernel at each commit. The commits of a case follow each other at once: so they share what else runs."""
    turn = list(versions) if number % 2 == 0 else list(versions)[::-1]
    for i, case in enumerate(chosen):
        progress.at(f"round {number + 1} of {rounds}: {case.name}", (number + i / (len(chosen) + 1)) / rounds)
        for version in turn:
            if case.name in version.empty:
                continue
            try:
                version.measured[case.name] = [*version.measured.get(case.name, []), one_block.measure(version.build.program, case, version.folder)]
            except NotMeasured as problem:
                version.empty[case.name] = short(problem)
    progress.at(f"round {number + 1} of {rounds}: kernels", (number + 1 - 1 / (len(chosen) + 1)) / rounds)
    for version in turn:
        asked = [name for name in kernels if name not in version.empty]
        if asked:
            measure_kernels(version, asked)


def drop_other_shapes(versions: Sequence[Version], chosen: Sequence[Case]) -> None:
    """A case has the shapes of the newest commit that measured it; where an older one has others, its times are of another case."""
    for case in chosen:
        known = [version for version in versions if version.measured.get(case.name)]
        for version in known:
            if version.measured[case.name][0].shapes != known[-1].measured[case.name][0].shapes:
                del version.measured[case.name]
                version.empty[case.name] = f"its shapes are not those of {known[-1].build.commit}"


def rows_of(version: Version, names: Iterable[str], where: str) -> list[Row]:
    rows = []
    for name in names:
        row = Row(version.build.commit, version.date, where, name)
        kept = version.measured.get(name, [])
        if kept:
            cpu = median([block.cpu for block in kept])
            row = dataclasses.replace(row, cpu_seconds=cpu.value, cpu_low=cpu.low, cpu_high=cpu.high, blocks=cpu.n, counters=kept[-1].counters,
                                      wall_seconds=float(np.median([block.wall for block in kept])), shapes=kept[-1].shapes,
                                      instructions=version.instructions.get(name))
        rows.append(row)
    return rows


def count_instructions(version: Version, chosen: Sequence[Case], kernels: Sequence[Kernel]) -> None:
    """Of what has a time. Counts are the same each time, whatever else runs: once is enough, and several at once."""
    from bench.tracking.counted import instructions_of, kernel_instructions

    build, folder, there = version.build, version.folder, version.measured
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        counts = {case.name: pool.submit(instructions_of, build.program, case, folder) for case in chosen if case.name in there}
        if build.kernels is not None:
            counts |= {kernel.name: pool.submit(kernel_instructions, build.kernels, kernel, folder) for kernel in kernels if kernel.name in there}
        version.instructions = {name: count for name, future in counts.items() if (count := future.result()) is not None}


def measure(revisions: Sequence[str], file: Path = FILE, blocks: int = BLOCKS, instructions: bool = True, only: Sequence[Case] | None = None,
            kernels: Sequence[Kernel] = KERNELS) -> list[Row]:
    """Builds and measures these commits, writes the file after every round, and returns all rows in it. NotBuilt where no commit builds."""
    chosen = cases() if only is None else only
    names, old, where = [kernel.name for kernel in kernels], read(file), this_machine()
    versions = versions_of(revisions)
    for version in versions:
        builds.fetch(version.tree, {model for case in chosen for model in case.models})


    def save(finished: bool) -> list[Row]:
        rows = merged(old, [row for version in versions for row in rows_of(version, [case.name for case in chosen] + names, where)], finished)
        write(file, rows)
        return rows

    say(f"{len(versions)} commits, {len(chosen)} cases and {len(names)} kernels, {blocks} blocks each, on {where}")
    progress = Progress()
    for number in range(blocks):
        one_round(versions, chosen, names, number, blocks, progress)
        drop_other_shapes(versions, chosen)
        for version in versions:
            version.tell()
        save(number + 1 == blocks)
    progress = Progress()
    for i, version in enumerate(versions if instructions else []):
        progress.at(f"instructions of {version.build.commit}", i / len(versions))
        count_instructions(version, chosen, kernels)
        save(True)
    return save(True)


def main(arguments: list[str]) -> int:
    from bench.tracking import picture

    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--measure", nargs="+", default=[], metavar="REV", help="commits to measure; default: only draw")
    parser.add_argument("--blocks", type=int, default=BLOCKS, help=f"fresh processes of each case at each commit (default: {BLOCKS})")
    parser.add_argument("--no-instructions", action="store_true", help="count none, which takes some seconds for each case of each commit")
    parser.add_argument("--csv", type=Path, default=FILE)
    parser.add_argument("--out", type=Path, default=ROOT / "results", help="figures/ and tables/ go there (default: results)")
    options = parser.parse_args(arguments)
    if options.blocks < 1:
        parser.error("--blocks is at least 1")
    try:
        rows = measure(options.measure, options.csv, options.blocks, not options.no_instructions) if options.measure else read(options.csv)
        if not rows:
            raise ValueError(f"{options.csv} has no rows: measure some commits first, python3 -m bench.tracking.history --measure HEAD")
        for path in picture.save(rows, options.out):
            print(path)
    except (ValueError, NotBuilt) as problem:
        say(str(problem))
        return 2
    except KeyboardInterrupt:
        say(f"interrupted; {options.csv} has the rounds that were finished")
        return 130
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
