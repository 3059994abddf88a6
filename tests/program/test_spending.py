"""Memory and CPU time of a case, measured with solvers and programs that use known amounts, in
threads and child processes, too."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import h5py
import pytest

from program import Program

MEGABYTE = 1 << 20
# Differences between two equal processes: pages touched for the first time, memory that the
# allocator keeps, and counting in batches.
SLACK = 16 * MEGABYTE

EXPERIMENT = """\
title = "solvers that spend known amounts"
tolerances = [2.0]
of = "absolute"
repeats = 2
rounds = {rounds}

[[scene]]
name = "moved"
source = "sphere1"
target = "sphere1"
motion = {{ kind = "translation", from = [0, 0, 0], to = [2, 0, 0], steps = 3, of = "absolute" }}

[[solver]]
name = "{solver}"
parameters = {{ {parameters} }}
"""


def rows(
    hausbench: Program, plugin: Path, solver: str, parameters: str, rounds: int = 1
) -> dict[str, Any]:
    experiment = hausbench.folder / "spending.toml"
    experiment.write_text(EXPERIMENT.format(solver=solver, parameters=parameters, rounds=rounds))
    done = hausbench(
        "run", experiment, "--results", hausbench.folder, "--fresh", "--plugin", plugin
    )
    assert done.returncode == 0, done.stderr
    with h5py.File(hausbench.folder / "spending.h5") as f:
        columns: dict[str, Any] = {
            f"{group}/{name}": column.asstr()[:]
            if h5py.check_string_dtype(column.dtype)
            else column[:]
            for group in ("cases", "repeats", "preparation")
            for name, column in f[group].items()
        }
    assert list(columns["cases/status"]) == ["ok"] * 3, columns["cases/reason"]
    return columns


def test_memory_of_preparing_counts_in_every_case(hausbench: Program, plugin: Path) -> None:
    for peak in rows(hausbench, plugin, "spending", "prepare_megabytes = 200")["cases/peak_bytes"]:
        assert (
            199 * MEGABYTE <= peak <= 200 * MEGABYTE + SLACK
        )  # the kernel counts pages in batches


def test_memory_of_solving_counts_in_its_case_alone(hausbench: Program, plugin: Path) -> None:
    peaks = rows(
        hausbench, plugin, "spending", "prepare_megabytes = 50, solve_megabytes = 200, at = 1.0"
    )["cases/peak_bytes"]
    for peak, megabytes in zip(peaks, (50, 200, 50)):
        assert (megabytes - 1) * MEGABYTE <= peak <= megabytes * MEGABYTE + SLACK


@pytest.mark.parametrize(
    "solver, settings",
    [
        ("spending", {"prepare_megabytes": 150, "solve_megabytes": 50}),
        ("spending", {"prepare_megabytes": 50, "solve_megabytes": 150}),
        ("guthe", {}),
    ],
)
def test_run_and_measure_mean_the_same_memory(
    hausbench: Program, plugin: Path, tmp_path: Path, solver: str, settings: dict[str, int]
) -> None:
    experiment = tmp_path / "same.toml"
    given = ", ".join(f"{name} = {value}" for name, value in settings.items())
    experiment.write_text(
        f"""\
title = "one pose"
tolerances = [2.0]
of = "absolute"
repeats = 1
[[scene]]
name = "spheres"
source = "{'sphere1' if settings else 'sphere5'}"
target = "{'sphere1' if settings else 'sphere5'}"
[[solver]]
name = "{solver}"
parameters = {{ {given} }}
"""
    )
    done = hausbench("run", experiment, "--results", tmp_path, "--plugin", plugin)
    assert done.returncode == 0, done.stderr
    with h5py.File(tmp_path / "same.h5") as f:
        ran = int(f["cases/peak_bytes"][0])
    model = tmp_path / "model.off"
    assert hausbench("export", "sphere1" if settings else "sphere5", model).returncode == 0
    done = hausbench(
        "measure",
        model,
        model,
        "--solver",
        solver,
        "--tolerance=2",
        "--of=absolute",
        "--json",
        "--plugin",
        plugin,
        *[f"--set={name}={value}" for name, value in settings.items()],
    )
    assert done.returncode == 0, done.stderr
    measured = json.loads(done.stdout)["peak_bytes"]
    assert ran > 2 * MEGABYTE and abs(ran - measured) <= (
        SLACK if settings else min(SLACK, 0.75 * ran)
    ), (ran, measured)


def test_several_threads_are_timed_by_the_wall_clock(hausbench: Program, plugin: Path) -> None:
    for threads in (1, 2):  # even one, because the waiting thread's clock stands still
        columns = rows(hausbench, plugin, "spending", f"threads = {threads}, seconds = 0.06")
        assert list(columns["cases/clock"]) == ["wall"] * 3
        assert (columns["repeats/cpu_seconds"] >= threads * 0.06).all() and (
            columns["repeats/wall_seconds"] >= 0.06
        ).all()
    columns = rows(hausbench, plugin, "spending", "threads = 0")
    assert list(columns["cases/clock"]) == ["cpu"] * 3
    # For solves of microseconds, reading the clocks must not count as CPU time.
    assert (columns["repeats/cpu_seconds"] <= columns["repeats/wall_seconds"]).all()
    assert json.loads(columns["cases/facts"][0]) == {"threads": "0 of its own"}


def test_a_child_is_timed_by_its_cpu_time(hausbench: Program, plugin: Path) -> None:
    burn = (
        "import time; [None for _ in iter(lambda: time.process_time() < 0.3, False)]; "
        "print(0, 2)"
    )
    command = f"""command = '{sys.executable} -S -c "{burn}" {{A}} {{B}}', lower = '^(0)', upper = ' (2)$' """
    columns = rows(hausbench, plugin, "external", command)
    assert list(columns["cases/clock"]) == ["cpu"] * 3
    assert (columns["repeats/cpu_seconds"] >= 0.3).all()


def test_every_round_keeps_its_preparation(hausbench: Program, plugin: Path) -> None:
    columns = rows(hausbench, plugin, "spending", "prepare_megabytes = 20", rounds=3)
    seconds = columns["preparation/seconds"]
    for case in range(3):
        of_case = columns["preparation/case"] == case
        assert list(columns["preparation/round"][of_case]) == [0, 1, 2]
        assert len(set(seconds[of_case])) > 1
        assert columns["cases/prepare_seconds"][case] == sorted(seconds[of_case])[1]
