"""Tiers 1 and 2: work counters and instructions of the tracked cases, against baseline.toml, which is committed.

Counters are the same on every machine and must be equal. Instructions of the solves alone, under valgrind, are the same from run to run,
so that half a per cent shows without a clock; they depend on the compiler and the libraries, so the baseline has a table for each key,
which names them. Without a table for this machine nothing is measured. valgrind knows AVX2 at most: AVX-512 code is not what is counted.
Both belong to the shapes of a case: where another library simplifies a mesh otherwise, the case is not measured.
"""

from __future__ import annotations

import hashlib
import os
import re
import subprocess
import tempfile
import tomllib
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

import tomli_w

from bench.tracking.blocks import NotMeasured, measure, read, run, run_words, write_case
from bench.tracking.cases import MESH, Case, Kernel
from bench.tracking.gate import Verdict

BASELINE = Path(__file__).resolve().parent / "baseline.toml"
LIMIT = 0.005  # of the instructions of the baseline
PACKAGES = ("g++", "libc6", "libstdc++6", "libeigen3-dev", "libcgal-dev", "libhwy-dev", "libgmp10", "libmpfr6", "valgrind")
SOLVE = "hausbench::Session::solve(*"


class Missing(Exception):
    """Something that counting needs is not there; the message names the remedy."""


@dataclass
class Found:
    """What a tier says: its verdict, a line for each case, and what the baseline would be."""

    verdict: Verdict = Verdict.nothing_measured
    lines: list[str] = field(default_factory=list)
    measured: dict[str, Any] = field(default_factory=dict)


def read_baseline(file: Path) -> dict[str, Any]:
    """Missing where it cannot be read."""
    try:
        return tomllib.loads(file.read_text()) if file.is_file() else {}
    except tomllib.TOMLDecodeError as error:
        raise Missing(f"{file}: {error}: take the committed file, or write it anew with --update REASON") from None


# --- work counters ---------------------------------------------------------------------------------------------------


def count_work(cases: Sequence[Case], program: Path, baseline: Mapping[str, Any], folder: Path) -> Found:
    """Tier 1."""
    found = Found()
    differ = False
    for case in cases:
        try:
            block = measure(program, case, folder)
        except NotMeasured as why:
            found.lines.append(f"{case.name}: nothing measured: {why}")
            continue
        found.measured[case.name] = {"shapes": block.shapes, **block.counters}
        before = baseline.get(case.name)
        if before is None:
            found.lines.append(f"{case.name}: no baseline: add it with --update REASON")
            differ = True
        elif before["shapes"] != block.shapes:
            found.lines.append(f"{case.name}: nothing measured: its shapes are not those of the baseline (does another library make them?)")
        else:
            changes = differences({name: count for name, count in before.items() if name != "shapes"}, block.counters)
            differ = differ or bool(changes)
            found.verdict = Verdict.passed
            found.lines += [f"{case.name}: {change}" for change in changes]
    if differ:
        found.verdict = Verdict.slower
    return found


def differences(before: Mapping[str, int], now: Mapping[str, int]) -> list[str]:
    """A line for each counter that is not what it was."""
    return [f"{name} was {before.get(name, 0):,}, is {now.get(name, 0):,} ({signed_share(now.get(name, 0), before.get(name, 0))})"
            for name in sorted(before.keys() | now.keys()) if before.get(name, 0) != now.get(name, 0)]


def signed_share(now: int, before: int) -> str:
    return f"{100 * (now / before - 1):+.2g} %" if before else "new"


# --- instructions ----------------------------------------------------------------------------------------------------


def output_of(command: list[str]) -> str:
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False, stdin=subprocess.DEVNULL)
    except FileNotFoundError:
        raise Missing(f"{command[0]} is missing: install it with 'make deps'") from None
    if done.returncode != 0:
        raise Missing(f"{' '.join(command)} ended with {done.returncode}: {done.stderr.strip()[-500:]}")
    return done.stdout


def parts_of_key() -> str:
    """What the number of instructions depends on, beside the sources."""
    versions = output_of(["dpkg-query", "--show", "--showformat=${Package} ${Version}\n", *PACKAGES])
    vectors = "avx2" if re.search(r"^flags.*\bavx2\b", Path("/proc/cpuinfo").read_text(), re.M) else "no avx2"
    return ", ".join([*sorted(versions.split("\n")[:-1]), vectors])


def key_of(parts: str) -> str:
    return hashlib.sha256(parts.encode()).hexdigest()[:12]


def callgrind(function: str, command: list[str], folder: Path, good: tuple[int, ...] = (0,)) -> int:
    """Instructions in `function` and what it calls, of the command and its children. NotMeasured where there are none."""
    with tempfile.TemporaryDirectory(dir=folder) as out:
        counting = ["valgrind", "--tool=callgrind", "--trace-children=yes", f"--toggle-collect={function}", f"--callgrind-out-file={out}/%p"]
        run([*counting, *command], folder, good)
        total = sum(int(found[1]) for file in Path(out).iterdir() if (found := re.search(r"^totals: (\d+)$", file.read_text(), re.M)))
    if total == 0:
        raise NotMeasured(f"callgrind counted nothing in {function}: is the program built as `make build` does?")
    return total


def instructions_of(program: Path, case: Case, folder: Path) -> int | None:
    """Of all solves of one worker: the answer, and each repeat. None where the program does not know the case."""
    slow = Case(case.name, {**case.experiment, "repeats": 1, "rounds": 1, "limits": {"case_seconds": 600, "prepare_seconds": 600}})
    file = write_case(slow, folder)
    try:
        total = callgrind(SOLVE, run_words(program, file), folder, (0, 1))
        read(file.with_suffix(".h5"))  # an answer came of it
        return total
    except NotMeasured:
        return None
    finally:
        for left in folder.glob(f"{file.stem}*"):
            left.unlink()


def kernel_instructions(program: Path, kernel: Kernel, folder: Path) -> int | None:
    """Of one iteration, and of building what it asks. None where the program lacks it."""
    command = [str(program), f"--meshes={MESH}", f"--benchmark_filter=^{re.escape(kernel.name)}/{re.escape(MESH)}$", "--benchmark_min_time=0"]
    try:
        return callgrind(kernel.function, command, folder)
    except NotMeasured:
        return None


def said(now: int, before: int) -> tuple[str, bool]:
    change = now / before - 1
    word = "more: slower" if change > LIMIT else "fewer: keep the gain with --update" if change < -LIMIT else "as before"
    return f"{now:,} instructions, {100 * change:+.2f} % ({word})", abs(change) <= LIMIT


def count_instructions(cases: Sequence[Case], kernels: Sequence[Kernel], program: Path, kernel_program: Path | None,
                       baseline: Mapping[str, Any], folder: Path, wanted: bool = False) -> Found:
    """Tier 2. Without a table for this machine nothing is counted, unless it is `wanted` for a new table."""
    if subprocess.run(["valgrind", "--version"], capture_output=True, check=False).returncode != 0:
        raise Missing("valgrind does not run: install it with 'make deps'")
    parts = parts_of_key()
    table = baseline.get(key_of(parts))
    if table is None and not wanted:
        return Found(lines=[f"nothing measured: the baseline has no table for {parts}"])
    jobs: dict[str, Callable[[], int | None]] = {case.name: partial(instructions_of, program, case, folder) for case in cases}
    if kernel_program is not None:
        jobs |= {kernel.name: partial(kernel_instructions, kernel_program, kernel, folder) for kernel in kernels}
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        running = {name: pool.submit(job) for name, job in jobs.items()}
    counts = {name: job.result() for name, job in running.items()}
    found = Found(Verdict.passed, measured={"depends_on": parts, **{name: count for name, count in counts.items() if count is not None}})
    for name, now in counts.items():
        before = (table or {}).get(name)
        if now is None:
            found.lines.append(f"{name}: nothing measured: it did not run under valgrind")
        elif before is None:
            found.lines.append(f"{name}: {now:,} instructions, no baseline")
        else:
            words, same = said(now, before)
            found.lines.append(f"{name}: {words}")
            if not same:
                found.verdict = Verdict.slower
    return found


def updated(baseline: Mapping[str, Any], counters: Mapping[str, Any], instructions: Mapping[str, Any], reason: str) -> dict[str, Any]:
    """The baseline with what was measured now in place of what it had of the same cases and the same key."""
    tables = {name: dict(table) for name, table in baseline.get("instructions", {}).items()}
    if instructions:
        key = key_of(instructions["depends_on"])
        tables[key] = {**tables.get(key, {}), **instructions}
    return {"reason": reason, "counters": {**baseline.get("counters", {}), **counters}, "instructions": tables}


def write_baseline(file: Path, baseline: Mapping[str, Any]) -> None:
    head = "# Written by `hausbench track --update REASON`: work counters and instructions of the tracked cases.\n"
    file.write_text(head + tomli_w.dumps(dict(baseline)))
