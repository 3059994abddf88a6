"""Tiers 1 and 2: work counters and instructions of the tracked cases, compared with the committed
baseline.toml.

Counters are the same on every machine and must be equal. Instructions of the solves, counted by
valgrind, vary so little that half a per cent shows. malloc and free are left out: how long they
search depends on what lies where in memory, even on the lengths of paths. Instructions depend on
the compiler and the libraries, so the baseline has a table for each combination; without a table
for this machine, none are counted. valgrind supports AVX2 at most, so AVX-512 code is not counted.
If a case has other shapes than in the baseline, or lacks a mesh, it is not measured. A case without
an answer or a baseline is red.

The baseline also holds work counters of small scenes, for tests/algorithms/counters_test.cpp.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import shutil
import subprocess
import tempfile
import tomllib
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

from bench.tracking.blocks import NotMeasured, measure, read, run, run_words, write_case
from bench.tracking.cases import MESH, Case, Kernel
from bench.tracking.gate import Verdict

BASELINE = Path(__file__).resolve().parent / "baseline.toml"
LIMIT = 0.005  # of the baseline's instructions
PACKAGES = (
    "g++",
    "libc6",
    "libstdc++6",
    "libeigen3-dev",
    "libcgal-dev",
    "libhwy-dev",
    "libgmp10",
    "libmpfr6",
    "valgrind",
)
SOLVE = "hausbench::Session::solve(*"
CALLGRIND_LIMIT = 600  # seconds for one count


class Missing(Exception):
    """A prerequisite of counting is missing; the message says what to do."""


@dataclass
class Found:
    """The result of a tier: its verdict, a line for each case, and the numbers for a new
    baseline."""

    verdict: Verdict = Verdict.nothing_measured
    lines: list[str] = field(default_factory=list)
    measured: dict[str, Any] = field(default_factory=dict)

    def red(self, line: str) -> None:
        self.verdict = Verdict.red
        self.lines.append(line)

    def passed(self) -> None:
        """Changes nothing_measured to passed; red stays."""
        if self.verdict is Verdict.nothing_measured:
            self.verdict = Verdict.passed


def read_baseline(file: Path) -> dict[str, Any]:
    """Reads the baseline. Raises Missing if it is unreadable."""
    try:
        return tomllib.loads(file.read_text()) if file.is_file() else {}
    except tomllib.TOMLDecodeError as error:
        raise Missing(
            f"{file}: {error}: take the committed file, or rewrite it with --update REASON"
        ) from None


# --- work counters
# ---------------------------------------------------------------------------------------------------

OTHER_SHAPES = (
    "nothing measured: it has other shapes than the baseline (perhaps another library made them)"
)


def count_work(
    cases: Sequence[Case], program: Path, baseline: Mapping[str, Any], folder: Path
) -> Found:
    """Tier 1: compares the work counters of cases with the baseline."""
    outcome = Found()
    for case in cases:
        try:
            block = measure(program, case, folder)
        except NotMeasured as why:
            if why.skipped:
                outcome.lines.append(f"{case.name}: nothing measured: {why}")
            else:
                outcome.red(f"{case.name}: no answer: {why}")
            continue
        outcome.measured[case.name] = {
            "shapes": block.shapes,
            **{name: count for name, count in block.counters.items() if count},
        }
        before = baseline.get(case.name)
        if before is None:
            outcome.red(f"{case.name}: no baseline: add it with --update REASON")
        elif before["shapes"] != block.shapes:
            outcome.lines.append(f"{case.name}: {OTHER_SHAPES}")
        else:
            outcome.passed()
            for change in differences(
                {name: count for name, count in before.items() if name != "shapes"}, block.counters
            ):
                outcome.red(f"{case.name}: {change}")
    return outcome


def differences(before: Mapping[str, int], now: Mapping[str, int]) -> list[str]:
    """Returns a line for each counter that has changed; a counter missing from the baseline was
    0."""
    return [
        f"{name} was {before.get(name, 0):,}, is {now.get(name, 0):,} ({signed_share(now.get(name, 0), before.get(name, 0))})"
        for name in sorted(before.keys() | now.keys())
        if before.get(name, 0) != now.get(name, 0)
    ]


def signed_share(now: int, before: int) -> str:
    return f"{100 * (now / before - 1):+.3g} %" if before else "new"


def count_small_scenes(program: Path, folder: Path) -> dict[str, Any]:
    """Returns the work counters that counters_test compares, by group and scene. Raises Missing if
    the program is not built or fails."""
    file = folder / "small_scenes.toml"
    try:
        subprocess.run(
            [program],
            env={**os.environ, "HAUSBENCH_COUNTS": str(file)},
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            check=True,
        )
    except OSError:
        raise Missing(f"{program} is missing: build it with 'make track-counts'") from None
    except subprocess.CalledProcessError as error:
        raise Missing(f"{program} failed: {error.stdout}") from None
    return tomllib.loads(file.read_text())


# --- instructions
# ----------------------------------------------------------------------------------------------------


def parts_of_key() -> str:
    """Returns the versions of compiler, libraries and valgrind, and whether there is AVX2: all
    change the instructions.

    A package that is installed for two architectures counts once, because both have the same
    version.
    """
    query = ["dpkg-query", "--show", "--showformat=${Package} ${Version}\n", *PACKAGES]
    try:  # exit code 1: some are not installed, which is a kind of machine, too
        versions = subprocess.run(
            query, capture_output=True, text=True, check=False, stdin=subprocess.DEVNULL
        ).stdout
    except OSError:
        versions = "no Debian\n"
    vectors = (
        "avx2"
        if re.search(r"^flags.*\bavx2\b", Path("/proc/cpuinfo").read_text(), re.M)
        else "no avx2"
    )
    return ", ".join([*sorted({*versions.split("\n")[:-1]}), vectors])


def key_of(parts: str) -> str:
    return hashlib.sha256(parts.encode()).hexdigest()[:12]


def unknown_instruction(logs: Path) -> NotMeasured | None:
    """Returns the reason if valgrind ended a process at an instruction that it does not know or
    that this processor hides.

    For example rdtscp: 0xF 0x1 0xF9. That is a property of the machine, so the case counts as
    skipped.
    """
    for log in sorted(logs.glob("log.*")):
        text = log.read_text(errors="replace")
        if match := re.search(r"unhandled instruction bytes: ((?:0x[0-9A-F]+ ?)+)", text):
            at = re.search(r"^==\d+== +at 0x[0-9A-F]+: (.*)$", text, re.M)
            return NotMeasured(
                f"valgrind does not know instruction {match[1].strip()} on this machine{f', at {at[1]}' if at else ''}",
                skipped=True,
            )
    return None


def instructions_in(out: Iterable[str]) -> int:
    """Adds up the instructions in the lines of a file that callgrind wrote. Leaves out glibc's
    malloc.c.

    The format is in valgrind's manual ("Callgrind Format Specification"): `fl`, `fi` or `fe` name
    the file of the lines of costs that follow, and a name is written only the first time; after
    `calls` comes the cost of what was called, which is counted where it arose.
    """
    names: dict[str, str] = {}
    total, counts, lines = 0, True, iter(out)
    for line in lines:
        if named := re.match(r"(c?f[lie])=(\(\d+\))(?: (.+))?$", line):
            kind, key, name = named.groups()
            if name:
                names[key] = name
            if kind in ("fl", "fi", "fe"):
                counts = not names[key].endswith("/malloc.c")
        elif line.startswith("calls="):
            next(lines)
        elif counts and (cost := re.match(r"[+-]?\d+ (\d+)$|\* (\d+)$", line)):
            total += int(cost[1] or cost[2])
    return total


def callgrind(function: str, command: list[str], folder: Path, good: tuple[int, ...] = (0,)) -> int:
    """Counts instructions in `function` and its callees, for the command and its children. Raises
    NotMeasured if there are none."""
    with tempfile.TemporaryDirectory(dir=folder) as out:
        counting = [
            "valgrind",
            "--tool=callgrind",
            "--trace-children=yes",
            f"--toggle-collect={function}",
            f"--callgrind-out-file={out}/%p",
            f"--log-file={out}/log.%p",
        ]
        try:
            run([*counting, *command], folder, good, CALLGRIND_LIMIT)
        except NotMeasured as why:
            raise unknown_instruction(Path(out)) or why from None
        if unknown := unknown_instruction(
            Path(out)
        ):  # in a worker: the program itself has ended normally
            raise unknown
        total = sum(
            instructions_in(file.read_text().splitlines())
            for file in Path(out).iterdir()
            if not file.name.startswith("log.")
        )
    if total == 0:
        raise NotMeasured(
            f"callgrind counted nothing in {function}: was the program built with `make build`?"
        )
    return total


def count_case(program: Path, case: Case, folder: Path) -> tuple[int, str]:
    """Returns the instructions of all solves of one worker (the answer and one repeat), and the
    hash of the shapes. Raises NotMeasured without an answer.
    """
    limits = {"case_seconds": CALLGRIND_LIMIT, "prepare_seconds": CALLGRIND_LIMIT}
    file = write_case(
        Case(case.name, {**case.experiment, "repeats": 1, "rounds": 1, "limits": limits}), folder
    )
    try:
        total = callgrind(SOLVE, run_words(program, file), folder, (0, 1))
        return total, read(file.with_suffix(".h5")).shapes
    finally:
        for left in folder.glob(f"{file.stem}*"):
            left.unlink()


def instructions_of(program: Path, case: Case, folder: Path) -> int | NotMeasured:
    """Returns the instructions, or the reason why they cannot be counted."""
    try:
        return count_case(program, case, folder)[0]
    except NotMeasured as why:
        return why


def count_kernel(program: Path, kernel: Kernel, folder: Path) -> tuple[int, str]:
    """Returns the instructions of one iteration and of building its structure; no shapes. Raises
    NotMeasured if it is unknown."""
    command = [
        str(program),
        f"--meshes={MESH}",
        f"--benchmark_filter=^{re.escape(kernel.name)}/{re.escape(MESH)}$",
        "--benchmark_min_time=0",
    ]
    return callgrind(kernel.function, command, folder), ""


def said(now: int, before: int) -> tuple[str, bool]:
    change = now / before - 1
    word = (
        "more: slower"
        if change > LIMIT
        else "fewer: keep the gain with --update"
        if change < -LIMIT
        else "as before"
    )
    return f"{now:,} instructions, {100 * change:+.2f} % ({word})", abs(change) <= LIMIT


Counting = dict[str, Callable[[], tuple[int, str]]]

# Solvers that do not end under valgrind, which does not change the rounding mode as CGAL's exact
# constructions need.
NO_INSTRUCTIONS = frozenset({"penetration"})


def in_parallel(jobs: Counting) -> dict[str, tuple[int, str] | NotMeasured]:
    """Runs as many jobs at a time as there are cores, which does not affect the counts. After
    Ctrl-C no other job begins."""
    pool = ThreadPoolExecutor(len(os.sched_getaffinity(0)))
    try:
        running = {name: pool.submit(job) for name, job in jobs.items()}
        counts: dict[str, tuple[int, str] | NotMeasured] = {}
        for name, job in running.items():
            try:
                counts[name] = job.result()
            except NotMeasured as why:
                counts[name] = why
        return counts
    finally:
        pool.shutdown(wait=False, cancel_futures=True)


def jobs_of(
    cases: Sequence[Case],
    kernels: Sequence[Kernel],
    program: Path,
    kernel_program: Path | None,
    folder: Path,
) -> Counting:
    jobs: Counting = {
        case.name: partial(count_case, program, case, folder)
        for case in cases
        if case.solver not in NO_INSTRUCTIONS
    }
    if kernel_program is not None:
        jobs |= {
            kernel.name: partial(count_kernel, kernel_program, kernel, folder) for kernel in kernels
        }
    return jobs


def count_instructions(
    jobs: Counting, baseline: Mapping[str, Any], shapes: Mapping[str, str], wanted: bool = False
) -> Found:
    """Tier 2: compares instructions with the baseline.

    `shapes` are the baseline's shapes of the cases. Without a table for this machine nothing is
    counted, unless it is `wanted` for a new table.
    """
    parts = parts_of_key()
    table = baseline.get(key_of(parts))
    if table is None and not wanted:
        return Found(lines=[f"nothing measured: the baseline has no table for {parts}"])
    if not shutil.which("valgrind"):
        raise Missing("valgrind is missing: install it with 'make deps'")
    outcome = Found(measured={"depends_on": parts})
    for name, count in in_parallel(jobs).items():
        before = (table or {}).get(name)
        if isinstance(count, NotMeasured):
            if count.skipped:
                outcome.lines.append(f"{name}: nothing measured: {count}")
            else:
                outcome.red(f"{name}: no count: {count}")
            continue
        now, of_shapes = count
        outcome.measured[name] = now
        if before is None:
            outcome.red(f"{name}: {now:,} instructions, no baseline: add it with --update REASON")
        elif of_shapes and of_shapes != shapes.get(name, of_shapes):
            outcome.lines.append(f"{name}: {OTHER_SHAPES}")
        else:
            words, same = said(now, before)
            outcome.passed()
            (outcome.lines.append if same else outcome.red)(f"{name}: {words}")
    return outcome


# --- a new baseline
# --------------------------------------------------------------------------------------------------


def updated(
    baseline: Mapping[str, Any],
    counters: Mapping[str, Any],
    instructions: Mapping[str, Any],
    reason: str,
    names: Collection[str] | None = None,
    small_scenes: Mapping[str, Any] | None = None,
) -> dict[str, Any]:
    """Returns the baseline with new measurements in place of old ones for the same cases and the
    same key.

    Drops cases and kernels that are not in `names`, unless it is None. A machine that is new to the
    baseline adds a table, but does not replace counters of other shapes.
    """

    def kept(table: Mapping[str, Any]) -> dict[str, Any]:
        return {
            name: value
            for name, value in table.items()
            if names is None or name in names or name == "depends_on"
        }

    tables = {key: kept(table) for key, table in baseline.get("instructions", {}).items()}
    key = key_of(instructions["depends_on"]) if instructions else ""
    guest = bool(key) and bool(tables) and key not in tables
    before = kept(baseline.get("counters", {}))
    for name, measured in counters.items():
        if not (guest and name in before and before[name]["shapes"] != measured["shapes"]):
            before[name] = measured
    if key:
        tables[key] = {**tables.get(key, {}), **instructions}
    small = {**baseline.get("small_scenes", {}), **(small_scenes or {})}
    return {"reason": reason, "counters": before, "small_scenes": small, "instructions": tables}


def as_toml(value: Any) -> str:
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{key} = {as_toml(part)}" for key, part in value.items()) + " }"
    return json.dumps(value, ensure_ascii=False)


def write_baseline(file: Path, baseline: Mapping[str, Any]) -> None:
    """Writes a line for each case and scene, first to a file beside the baseline, so that an
    interrupt leaves the old one intact."""
    text = "# Written by `hausbench track --update REASON`: work counters and instructions of the tracked cases, work counters of small scenes.\n"
    text += f"reason = {as_toml(baseline['reason'])}\n"
    tables = {"counters": baseline["counters"]}
    for kind in ("small_scenes", "instructions"):
        tables |= {f"{kind}.{name}": table for name, table in baseline[kind].items()}
    for name, table in tables.items():
        text += f"\n[{name}]\n" + "".join(
            f"{as_toml(key)} = {as_toml(value)}\n" for key, value in table.items()
        )
    beside = file.with_suffix(".new")
    beside.write_text(text)
    beside.replace(file)
