"""Runs an experiment as jobs of a real Slurm. Although a task is killed and a node lost, the result
equals a local run."""

from __future__ import annotations

import os
import signal
import subprocess
from collections.abc import Iterator
from pathlib import Path

import h5py
import numpy as np
import pytest
from one_machine import Slurm, missing, wait_until

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = os.environ.get("HAUSBENCH_PROGRAM", str(ROOT / "build" / "release" / "hausbench"))
SCENES = 10
SHARDS = 5

EXPERIMENT = """\
title = "slow enough to be interrupted"
tolerances = [1e-3]
of = "diagonal"
repeats = 1

[limits]
case_seconds = 60

[[solver]]
name = "naive"

[[solver]]
name = "earlybreak"
parameters = { seed = [1, 2] }
"""


def experiment(folder: Path) -> Path:
    text = EXPERIMENT
    for i in range(SCENES):
        text += f'\n[[scene]]\nname = "clouds {i}"\nsource = "a{i}"\ntarget = "b{i}"\n'
        for name, seed in (("a", i + 1), ("b", i + 101)):
            text += (
                f'[model.{name}{i}]\nsource = "generated"\nrecipe = "gaussian_points"\ncount = 60000\nseed = {seed}\nsigma = 1.0\n'
                "x = 0.0\ny = 0.0\nz = 0.0\n"
            )
    file = folder / "clouds.toml"
    file.write_text(text)
    return file


@pytest.fixture
def slurm(tmp_path: Path) -> Iterator[Slurm]:
    if why := missing():
        pytest.skip(f"there is no Slurm to test with: {why}")
    folder = tmp_path / "slurm"
    folder.mkdir()
    with Slurm(folder) as running:
        yield running


def hausbench(slurm: Slurm, *words: str | Path, good: tuple[int, ...] = (0,)) -> str:
    environment = {**slurm.environment, "HAUSBENCH_ROOT": str(ROOT)}
    done = subprocess.run(
        [PROGRAM, *map(str, words)],
        env=environment,
        cwd=slurm.folder,
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert done.returncode in good, (done.returncode, done.stdout, done.stderr)
    return done.stdout + done.stderr


def rows(file: Path) -> dict[str, tuple[object, ...]]:
    """Returns each row's contents, except times, by identity. Checks that each case has one row."""
    with h5py.File(file) as result:
        cases = result["cases"]
        columns = [
            cases[name][()]
            for name in ("identity", "status", "lower", "upper", "witness_source", "witness_target")
        ]
        side_by_side = cases["side_by_side"][()]
    by_identity = {}
    for identity, *values in zip(*columns):
        by_identity[identity] = tuple(
            value.tobytes() if isinstance(value, np.ndarray) else value for value in values
        )
    assert len(by_identity) == len(columns[0]) == 3 * SCENES
    assert len(set(side_by_side)) == 1
    return by_identity


def runs_shard(number: int) -> list[int]:
    """Returns the processes that run this shard."""
    pids = []
    for process in Path("/proc").iterdir():
        try:
            words = (process / "cmdline").read_bytes().split(b"\0")
        except OSError:
            continue
        if f"{number}/{SHARDS}".encode() in words and b"run" in words:
            pids.append(int(process.name))
    return pids


def finished(slurm: Slurm, file: Path, results: Path) -> int:
    last = hausbench(slurm, "status", file, "--results", results).strip().splitlines()[-1].split()
    return int(last[2])


def test_a_killed_task_and_a_lost_node_cost_only_their_cases(slurm: Slurm, tmp_path: Path) -> None:
    file, results, here = experiment(tmp_path), tmp_path / "results", tmp_path / "here"
    submit = ("run", file, "--engine", "slurm", "--shards", str(SHARDS), "--results", results)
    assert f"{3 * SCENES} cases in {SHARDS} of {SHARDS} shards" in hausbench(slurm, *submit)
    wait_until("two shards run", lambda: bool(runs_shard(1) and runs_shard(2)))
    assert f"{SHARDS} shards are in the queue already" in hausbench(
        slurm, *submit
    ), "what waits or runs is not submitted twice"
    assert f"{SHARDS} shards are in the queue already" in hausbench(
        slurm, *submit[:-1], f"{results}/../results/", "--scene", "clouds 0"
    ), "a part of it, in a folder that is spelled otherwise"
    assert "scancel" in hausbench(
        slurm, *submit[:-3], "2", *submit[-2:], good=(2,)
    ), "nor split otherwise meanwhile"

    wait_until("a case is finished", lambda: finished(slurm, file, results) > 0)
    for pid in runs_shard(1):
        os.kill(pid, signal.SIGKILL)
    wait_until(
        "the second node works again or still",
        lambda: slurm.states()["n2"] in ("allocated", "mixed"),
    )
    slurm.lose_node("n2")
    wait_until("the node is missed", lambda: slurm.states()["n2"].startswith("down"), 120)
    slurm.start_node("n2")
    wait_until("the queue is empty", lambda: not slurm.queue(), 240)

    collected = (results / "clouds.quick.slurm" / "logs" / "collect.log").read_text()
    before = finished(slurm, file, results)
    assert 0 < before < 3 * SCENES and "cases are missing: submit again" in collected
    assert "not in the queue: submit again" in hausbench(
        slurm, "status", file, "--results", results
    )

    said = hausbench(slurm, *submit, "--wait")
    assert f"{3 * SCENES - before} cases in " in said, "only what is missing is run"
    assert f"{3 * SCENES} ok" in said, "and what the collection says is shown"
    assert finished(slurm, file, results) == 3 * SCENES
    (results / "clouds.h5").unlink()
    assert f"{3 * SCENES} ok" in hausbench(
        slurm, *submit
    ), "where all is finished, it is collected at once"

    hausbench(slurm, "run", file, "--results", here, "--jobs", "2", "--quiet")
    assert rows(results / "clouds.h5") == rows(here / "clouds.h5")


def test_without_slurm_it_says_what_to_do(tmp_path: Path) -> None:
    environment = {**os.environ, "HAUSBENCH_ROOT": str(ROOT), "PATH": "/nowhere"}
    done = subprocess.run(
        [
            PROGRAM,
            "run",
            experiment(tmp_path),
            "--engine",
            "slurm",
            "--results",
            tmp_path / "results",
        ],
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert (
        done.returncode == 2 and "squeue: not found" in done.stderr and "--shard i/n" in done.stderr
    )
    done = subprocess.run(
        [PROGRAM, "status", tmp_path / "clouds.toml", "--results", tmp_path / "results"],
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert (
        done.returncode == 0
        and "the queue is not known" in done.stderr
        and done.stdout.split()[-3:] == ["all", str(3 * SCENES), "0"]
    )
