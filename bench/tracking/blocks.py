"""Measures one block: a fresh process that runs one case a few times, or every kernel.

The time of a block is the least of its repeats, because other load on the machine only adds time.
CPU time of one thread.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Generic, TypeVar

import h5py
import numpy as np
import numpy.typing as npt

from bench.tracking.cases import MESH, Case

T = TypeVar("T")

LIMIT = 120.0  # seconds of one block


class NotMeasured(Exception):
    """The program does not know the case or gave no answer; the message says which. `skipped`: its
    models are missing."""

    def __init__(self, why: str, skipped: bool = False) -> None:
        super().__init__(why)
        self.skipped = skipped


@dataclass(frozen=True)
class Block:
    """The result of one process: the least of its repeats, each summed over the poses of the
    scene."""

    cpu: float
    wall: float
    prepare: float  # wall seconds of everything built
    shapes: str  # a hash of both shapes; times of other shapes cannot be compared
    lower: float = 0.0  # the largest lower bound
    counters: dict[str, int] = field(
        default_factory=dict
    )  # all counters of the program, including zeros


def environment_of(root: Path | None) -> dict[str, str]:
    """Returns the environment with HAUSBENCH_ROOT replaced: a value meant for another program would
    give this one other models."""
    return {name: value for name, value in os.environ.items() if name != "HAUSBENCH_ROOT"} | (
        {"HAUSBENCH_ROOT": str(root)} if root else {}
    )


def checked(code: int, output: str, errors: str, good: tuple[int, ...]) -> str:
    """Returns the output. Raises NotMeasured if the exit code is not in `good`."""
    if code not in good:
        words = (errors.strip() or output.strip()).splitlines()
        raise NotMeasured(f"exit code {code}: {words[-1] if words else 'it said nothing'}")
    return output


def run(
    command: list[str],
    folder: Path,
    good: tuple[int, ...] = (0,),
    limit: float | None = None,
    root: Path | None = None,
) -> str:
    """Returns standard output. Raises NotMeasured if the exit code is not in `good` or the time is
    over.

    `root` is the root of the program's tree, if it is not above the program.
    """
    limit = LIMIT if limit is None else limit
    try:
        done = subprocess.run(
            command,
            cwd=folder,
            capture_output=True,
            text=True,
            errors="replace",
            check=False,
            stdin=subprocess.DEVNULL,
            timeout=limit,
            env=environment_of(root),
        )
    except OSError as problem:
        raise NotMeasured(f"{command[0]} does not run: {problem.strerror}") from None
    except subprocess.TimeoutExpired:
        raise NotMeasured(f"no end within {limit:.0f} s") from None
    return checked(done.returncode, done.stdout, done.stderr, good)


@dataclass(frozen=True)
class Job(Generic[T]):
    """A command to run for one block, and the function that reads the block from its standard
    output or its files."""

    command: list[str]
    folder: Path
    read: Callable[[str], T]
    good: tuple[int, ...] = (0,)
    root: Path | None = None

    def alone(self) -> T:
        return self.read(run(self.command, self.folder, self.good, root=self.root))


def write_case(case: Case, folder: Path) -> Path:
    """Writes the experiment of this case under a new name in the folder, so that earlier results do
    not interfere."""
    handle, name = tempfile.mkstemp(suffix=".toml", prefix="case", dir=folder)
    with open(handle, "w", encoding="utf-8") as out:
        out.write(case.text())
    return Path(name)


@contextmanager
def fresh_copy(program: Path, root: Path | None = None) -> Iterator[Path]:
    """Makes a temporary copy of the program beside it, so that it finds its own tree above it, or
    in the build folder of `root`.

    The place of a program's pages in memory can change a solve's time by a tenth, in every run,
    until the file is written again. With a copy for each block, this becomes noise that the
    intervals include, not a difference between base and candidate.
    """
    again = (root / "build" if root else program.parent) / "again"
    try:
        again.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(
            prefix="program-", dir=again
        )  # a fixed prefix, so that paths of both sides have the same length
        os.close(handle)
        shutil.copy2(program, name)
    except OSError as problem:
        raise NotMeasured(f"{program} cannot be copied: {problem.strerror}") from None
    if (commit := program.parent / "commit.json").is_file():
        shutil.copy2(commit, again)
    try:
        yield Path(name)
    finally:
        os.unlink(name)


def run_words(program: Path, file: Path) -> list[str]:
    """Returns the command that runs a case, without options that some commits lack. Later commits
    also compute reference answers, which would be counted with the case, so these are turned off.
    """
    try:
        helped = subprocess.run(
            [program, "run", "--help"], capture_output=True, text=True, check=False, timeout=LIMIT
        ).stdout
    except (
        OSError,
        subprocess.TimeoutExpired,
    ):  # running the case reports that the program is missing or hangs
        helped = ""
    return [
        str(program),
        "run",
        str(file),
        "--results",
        str(file.parent),
        "--fresh",
        "--quiet",
        *(["--no-reference"] if "--no-reference" in helped else []),
    ]


@contextmanager
def job_of_case(
    program: Path, case: Case, folder: Path, root: Path | None = None
) -> Iterator[Job[Block]]:
    """Yields the job that runs the case in `folder`; then deletes its files. An unsound row (exit
    code 1) still has a time."""
    file = write_case(case, folder)
    try:
        with fresh_copy(program, root) as copy:
            yield Job(
                run_words(copy, file), folder, lambda _: read(file.with_suffix(".h5")), (0, 1), root
            )
    finally:
        for left in folder.glob(f"{file.stem}*"):
            left.unlink()


def measure(program: Path, case: Case, folder: Path) -> Block:
    with job_of_case(program, case, folder) as job:
        return job.alone()


def texts(values: object) -> list[str]:
    return [
        value.decode() if isinstance(value, bytes) else str(value) for value in np.asarray(values)
    ]


def read(file: Path) -> Block:
    """Reads a result file of one solver on one scene, of any commit so far. Raises NotMeasured if
    it has no answer or is unreadable."""
    try:
        with h5py.File(file) as result:
            return block_of(result)
    except (LookupError, OSError, ValueError) as problem:
        raise NotMeasured(f"its result cannot be read: {problem}") from None


def block_of(result: h5py.File) -> Block:
    rows = result["cases"]
    statuses = texts(rows["status"][()])
    if any(status != "ok" for status in statuses):
        bad = next(i for i, status in enumerate(statuses) if status != "ok")
        raise NotMeasured(
            f"{statuses[bad]}: {texts(rows['reason'][()])[bad]}",
            skipped=statuses[bad] in ("skipped", "not_built"),
        )
    repeats = result["repeats"]
    if len(repeats["case"]) == 0:
        raise NotMeasured("no repeat was timed")
    cpu, wall = (
        least_of_passes(repeats["case"][()], repeats[name][()])
        for name in ("cpu_seconds", "wall_seconds")
    )
    counters = {
        name.removeprefix("counter_"): int(values[()].sum())
        for name, values in rows.items()
        if name.startswith("counter_")
    }
    shapes = hashlib.sha256(
        " ".join(sorted(texts(result["models/sha256"][()]))).encode()
    ).hexdigest()[:12]
    prepare, lower = float(rows["prepare_seconds"][0]), float(rows["lower"][()].max())
    return Block(cpu, wall, prepare, shapes, lower, counters)


def least_of_passes(rows: npt.NDArray[np.int64], seconds: npt.NDArray[np.float64]) -> float:
    """Returns the time of the fastest pass. Pass k is repeat k of all poses; the repeats of a pose
    are in order."""
    passes = np.vstack([seconds[rows == row] for row in np.unique(rows)])
    return float(passes.sum(axis=0).min())


@contextmanager
def job_of_kernels(
    program: Path, names: list[str], folder: Path, root: Path | None = None
) -> Iterator[Job[dict[str, float]]]:
    """Yields the job that measures CPU seconds of an iteration of each benchmark, the least of
    eight; unknown ones are absent."""
    pattern = "^(" + "|".join(re.escape(name) for name in names) + f")/{re.escape(MESH)}$"
    with fresh_copy(program, root) as copy:
        yield Job(
            [
                str(copy),
                f"--meshes={MESH}",
                f"--benchmark_filter={pattern}",
                "--benchmark_format=json",
                "--benchmark_repetitions=8",
                "--benchmark_min_time=0.002",
            ],
            folder,
            least_of_kernels,
        )


def measure_kernels(program: Path, names: list[str], folder: Path) -> dict[str, float]:
    with job_of_kernels(program, names, folder) as job:
        return job.alone()


def least_of_kernels(output: str) -> dict[str, float]:
    """Returns the least time of each kernel. Raises NotMeasured if there are no times."""
    units = {"ns": 1e-9, "us": 1e-6, "ms": 1e-3, "s": 1.0}
    least: dict[str, float] = {}
    try:
        benchmarks = json.loads(output)["benchmarks"]
    except ValueError:  # without matching benchmarks, the output is empty
        raise NotMeasured("kernel_bench has none of the benchmarks") from None
    for benchmark in benchmarks:
        if benchmark.get("run_type") != "iteration":
            continue
        name, seconds = (
            benchmark["run_name"].removesuffix(f"/{MESH}"),
            benchmark["cpu_time"] * units[benchmark["time_unit"]],
        )
        least[name] = min(seconds, least.get(name, seconds))
    return least
