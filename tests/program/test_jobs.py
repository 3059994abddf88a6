"""`hausbench run --jobs`: cases run side by side have the same answers, and their times are marked
as not comparable."""

from __future__ import annotations

import hashlib
import json
import os
import signal
import subprocess
import time
from pathlib import Path

import h5py
import pytest

from program import ROOT, Program

SMOKE = ROOT / "experiments" / "smoke.toml"
ANSWERS = (
    "identity",
    "status",
    "reason",
    "lower",
    "upper",
    "witness_source",
    "counter_node_visits",
)

needs_two_cores = pytest.mark.skipif(
    len(os.sched_getaffinity(0)) < 2, reason="this machine has one core"
)


def answers(file: Path) -> list[list[object]]:
    with h5py.File(file) as result:
        return [result["cases"][name][()].tolist() for name in ANSWERS]


def column(file: Path, name: str) -> list[int]:
    with h5py.File(file) as result:
        return [int(value) for value in result["cases"][name][()]]


@needs_two_cores
def test_several_at_a_time_give_the_answers_of_one_go(hausbench: Program, tmp_path: Path) -> None:
    for folder, more in (("one", ()), ("two", ("--jobs", "2"))):
        assert hausbench("run", SMOKE, "--results", tmp_path / folder, *more).returncode == 0
    serial, parallel = tmp_path / "one" / "smoke.h5", tmp_path / "two" / "smoke.h5"
    assert repr(answers(serial)) == repr(answers(parallel))
    ran = [status in (b"ok",) for status in answers(parallel)[1]]
    assert sum(ran) > 10 and [bool(said) for said in column(parallel, "side_by_side")] == ran
    assert not any(column(serial, "side_by_side"))


@needs_two_cores
def test_times_that_compare_with_none_are_taken_again_by_a_run_of_one_at_a_time(
    hausbench: Program, tmp_path: Path
) -> None:
    command = ("run", SMOKE, "--results", tmp_path)
    assert hausbench(*command, "--jobs", "2").returncode == 0
    journal = tmp_path / "smoke.journal"
    size = journal.stat().st_size
    for more in (("--jobs", "2"), ("--any-build",)):
        assert (
            hausbench(*command, *more).returncode == 0 and journal.stat().st_size == size
        ), "finished cases are not run again"
    assert any(column(tmp_path / "smoke.h5", "side_by_side"))
    assert hausbench(*command).returncode == 0 and journal.stat().st_size > size
    assert not any(column(tmp_path / "smoke.h5", "side_by_side"))
    size = journal.stat().st_size
    assert (
        hausbench(*command, "--jobs", "2").returncode == 0 and journal.stat().st_size == size
    ), "times that do compare are kept"


def test_more_than_there_are_cores_is_a_mistake(hausbench: Program, tmp_path: Path) -> None:
    assert "ask for no more" in hausbench.fails(
        "run", SMOKE, "--results", tmp_path, "--quiet", "--jobs", "4096"
    )
    assert "--jobs" in hausbench.fails("run", SMOKE, "--results", tmp_path, "--jobs", "0")


SLOW = """\
title = "slow"
tolerances = [1e-3]
of = "diagonal"
repeats = 1
[[scene]]
name = "clouds"
source = "a"
target = "b"
[[solver]]
name = "naive"
[[solver]]
name = "earlybreak"
parameters = { seed = [1, 2, 3, 4, 5, 6] }
[model.a]
source = "generated"
recipe = "gaussian_points"
count = 40000
seed = 1
sigma = 1.0
x = 0.0
y = 0.0
z = 0.0
[model.b]
source = "generated"
recipe = "gaussian_points"
count = 40000
seed = 2
sigma = 1.0
x = 0.0
y = 0.0
z = 0.0
"""


@needs_two_cores
def workers(folder: Path) -> list[int]:
    """Returns the process ids of workers whose command line names the folder."""
    pids = []
    for process in Path("/proc").iterdir():
        try:
            words = (process / "cmdline").read_bytes()
        except OSError:
            continue
        if b"\0worker\0" in words and bytes(folder) in words:
            pids.append(int(process.name))
    return pids


@needs_two_cores
def test_ctrl_c_ends_all_of_them_and_the_same_command_goes_on(
    hausbench: Program, tmp_path: Path
) -> None:
    file = tmp_path / "slow.toml"
    file.write_text(SLOW)
    command = hausbench.command("run", file, "--results", tmp_path / "two", "--jobs", "2")
    journal = tmp_path / "two" / "slow.journal"
    with subprocess.Popen(
        command,
        cwd=tmp_path,
        env=hausbench.environment(),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    ) as running:
        end = time.monotonic() + 60
        while time.monotonic() < end and (
            not journal.exists() or len(journal.read_bytes().splitlines()) < 3
        ):
            time.sleep(0.01)
        running.send_signal(signal.SIGINT)
        running.communicate(timeout=60)
    assert running.returncode == 130
    assert not workers(tmp_path)
    assert hausbench("run", file, "--results", tmp_path / "two", "--jobs", "2").returncode == 0
    assert hausbench("run", file, "--results", tmp_path / "one", "--jobs", "1").returncode == 0
    assert repr(answers(tmp_path / "two" / "slow.h5")) == repr(
        answers(tmp_path / "one" / "slow.h5")
    )


def test_what_needs_more_memory_than_is_allowed_is_not_started(
    hausbench: Program, tmp_path: Path
) -> None:
    """The refused case has a row, which counts as finished when the command is run again."""
    file = tmp_path / "slow.toml"
    file.write_text(
        SLOW.replace("repeats = 1", "repeats = 0").replace(
            "[model.a]", "[limits]\nmemory_mb = 1.5\n[model.a]"
        )
    )
    for _ in range(2):
        assert hausbench("run", file, "--results", tmp_path).returncode == 0
        with h5py.File(tmp_path / "slow.h5") as result:
            assert set(result["cases/status"][()]) == {b"out_of_memory"}
            assert all(
                why
                == b"not started: its shapes alone take 1 MB, and 1 MB are allowed: raise memory_mb in [limits]"
                for why in result["cases/reason"][()]
            )
    assert hausbench("status", file, "--results", tmp_path).stdout.split()[-4:] == [
        "all",
        "7",
        "7",
        "finished",
    ]
    assert (
        "not started: its shapes alone" in hausbench("explain", file, "--results", tmp_path).stdout
    )


def test_what_a_small_machine_refused_runs_on_a_larger_one(
    hausbench: Program, experiment: Path, tmp_path: Path
) -> None:
    assert hausbench("run", experiment, "--results", tmp_path).returncode == 0
    journal = tmp_path / "tiny.journal"
    head, record = journal.read_text().splitlines()
    outcome = json.loads(record[17:])
    outcome["outcome"]["status"] = "out_of_memory"
    outcome["outcome"][
        "reason"
    ] = "not started: its shapes alone take 9 MB, and this machine has 8 MB: take a larger one"
    line = json.dumps(outcome)
    journal.write_text(f"{head}\n{hashlib.sha256(line.encode()).hexdigest()[:16]} {line}\n")
    assert hausbench("run", experiment, "--results", tmp_path).returncode == 0
    with h5py.File(tmp_path / "tiny.h5") as result:
        assert result["cases/status"][()].tolist() == [b"ok"]


def test_status_counts_what_is_finished(hausbench: Program, tmp_path: Path) -> None:
    def last() -> list[str]:
        return (
            hausbench("status", SMOKE, "--results", tmp_path)
            .stdout.strip()
            .splitlines()[-1]
            .split()
        )

    assert last()[:3] == ["all", "17", "0"]
    assert hausbench("run", SMOKE, "--results", tmp_path, "--solver", "guthe").returncode == 0
    assert last()[0] == "all" and 0 < int(last()[2]) < 17
    assert hausbench("run", SMOKE, "--results", tmp_path).returncode == 0
    assert last() == ["all", "17", "17", "finished"]


@needs_two_cores
def test_status_counts_what_was_run_side_by_side(hausbench: Program, tmp_path: Path) -> None:
    assert hausbench("run", SMOKE, "--results", tmp_path, "--jobs", "2").returncode == 0
    assert hausbench("status", SMOKE, "--results", tmp_path).stdout.split()[-4:] == [
        "all",
        "17",
        "17",
        "finished",
    ]


@needs_two_cores
def test_times_of_rows_beside_others_are_not_compared(hausbench: Program, tmp_path: Path) -> None:
    for folder, more in (("one", ()), ("two", ("--jobs", "2"))):
        assert hausbench("run", SMOKE, "--results", tmp_path / folder, *more).returncode == 0
    said = hausbench("compare", tmp_path / "one" / "smoke.h5", tmp_path / "two" / "smoke.h5").stdout
    assert (
        "answers: all the same" in said
        and "26 cases without a ratio: their times are run beside others" in said
        and "geometric mean" not in said
    )
    said = hausbench("compare", "--solver", "guthe", "cgal", tmp_path / "two" / "smoke.h5").stdout
    assert "geometric mean" not in said


def test_what_shards_have_finished_is_collected(hausbench: Program, tmp_path: Path) -> None:
    """Runs shards as on a cluster, but locally: a missing shard is reported, and the result has the
    others."""
    whole, parts = tmp_path / "whole", tmp_path / "parts"
    assert hausbench("run", SMOKE, "--results", whole).returncode == 0
    collect = ("run", SMOKE, "--results", parts, "--collect")
    assert "has no journal of a shard" in hausbench.fails(*collect, "--quiet")
    for number in (1, 3):
        assert (
            hausbench(
                "run", SMOKE, "--results", parts, "--shard", f"{number}/3", "--cluster"
            ).returncode
            == 0
        )
    done = hausbench(*collect)
    assert done.returncode == 1 and "cases are missing: submit again" in done.stderr
    assert (
        hausbench("run", SMOKE, "--results", parts, "--shard", "2/3", "--cluster").returncode == 0
    )
    assert hausbench(*collect).returncode == 0
    assert repr(answers(whole / "smoke.h5")) == repr(answers(parts / "smoke.h5"))
    size = (parts / "smoke.journal").stat().st_size
    assert (
        hausbench(*collect).returncode == 0 and (parts / "smoke.journal").stat().st_size == size
    ), "nothing is taken over twice"


def test_collecting_replaces_no_times_that_compare(hausbench: Program, tmp_path: Path) -> None:
    assert hausbench("run", SMOKE, "--results", tmp_path).returncode == 0
    assert (
        hausbench("run", SMOKE, "--results", tmp_path, "--shard", "1/3", "--cluster").returncode
        == 0
    )
    assert hausbench("run", SMOKE, "--results", tmp_path, "--collect").returncode == 0
    assert not any(column(tmp_path / "smoke.h5", "side_by_side"))


def test_a_round_that_is_missing_is_a_case_that_is_missing(
    hausbench: Program, experiment: Path, tmp_path: Path
) -> None:
    experiment.write_text(experiment.read_text().replace("repeats = 1", "repeats = 1\nrounds = 3"))
    assert (
        hausbench(
            "run", experiment, "--results", tmp_path, "--shard", "1/2", "--cluster"
        ).returncode
        == 0
    )
    assert (
        hausbench(
            "run", experiment, "--results", tmp_path, "--shard", "2/2", "--cluster"
        ).returncode
        == 0
    )
    assert hausbench("run", experiment, "--results", tmp_path, "--collect").returncode == 0
    (tmp_path / "tiny.journal").unlink()
    for journal in tmp_path.glob("tiny.shard-*.journal"):
        journal.write_bytes(b"".join(journal.read_bytes().splitlines(keepends=True)[:2]))
    done = hausbench("run", experiment, "--results", tmp_path, "--collect")
    assert done.returncode == 1 and "1 of 1 cases are missing" in done.stderr


def test_a_timeout_beside_others_is_tried_again_alone(hausbench: Program, tmp_path: Path) -> None:
    file = tmp_path / "slow.toml"
    file.write_text(
        SLOW.replace("repeats = 1", "repeats = 0").replace(
            "[model.a]", "[limits]\ncase_seconds = 0.02\n[model.a]"
        )
    )
    assert (
        hausbench("run", file, "--results", tmp_path, "--cluster", "--solver", "naive").returncode
        == 0
    )
    journal = (tmp_path / "slow.journal").read_bytes()
    assert b'"status":"timeout"' in journal
    assert hausbench("run", file, "--results", tmp_path, "--solver", "naive").returncode == 0
    assert len((tmp_path / "slow.journal").read_bytes()) > len(journal) and not any(
        column(tmp_path / "slow.h5", "side_by_side")
    )


@pytest.mark.parametrize(
    "more",
    [("--fresh",), ("--collect",), ("--jobs", "2"), ("--shard", "1/2"), ("--leave-nothing-out",)],
)
def test_what_a_cluster_cannot_be_told_is_refused(
    hausbench: Program, tmp_path: Path, more: tuple[str, ...]
) -> None:
    assert f"cannot be combined with {more[0]}" in hausbench.fails(
        "run", SMOKE, "--engine", "slurm", "--results", tmp_path, *more
    )
