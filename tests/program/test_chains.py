"""Warm chains start each pose from the previous answer. Every pass begins at the first pose,
however it ends."""

from __future__ import annotations

import random
import time
from pathlib import Path

import numpy as np
import pytest

from program import Program
from test_results import run_in
from test_run import numbers, run, same_answers, start, texts, wait_for

CHAIN = """\
title = "warm chains"
tolerances = [1e-3, 1e-5]
repeats = 3
trace = {trace}
[[scene]]
name = "turning"
source = "sphere3"
target = "cube1"
motion = {{ kind = "rotation", axis = [0, 1, 3], degrees = 40, steps = 12 }}
[[solver]]
name = "guthe"
label = "warm"
warm = true
[[solver]]
name = "guthe"
label = "cold"
tolerances = [1e-5]
"""


@pytest.fixture
def chains(tmp_path: Path) -> Path:
    file = tmp_path / "slow.toml"  # the name that start() and records() of test_run.py expect
    file.write_text(CHAIN.format(trace="false"))
    return file


def labelled(file: Path, label: str) -> list[int]:
    return [i for i, name in enumerate(texts(file, "cases/label")) if name == label]


def test_a_warm_chain_is_right_and_saves_work(
    hausbench: Program, chains: Path, tmp_path: Path
) -> None:
    file = run(hausbench, chains, tmp_path)
    assert set(texts(file, "cases/status")) == {"ok"} and set(texts(file, "cases/lower_check")) == {
        "holds"
    }
    warm, cold = labelled(file, "warm"), labelled(file, "cold")
    fine = [i for i in warm if numbers(file, "cases/tolerance")[i] == 1e-5]
    assert len(warm) == 24 and len(fine) == len(cold) == 12
    lower, upper = numbers(file, "cases/lower"), numbers(file, "cases/upper")
    assert (lower[fine] <= upper[cold]).all() and (lower[cold] <= upper[fine]).all()
    work = numbers(file, "cases/counter_closest_point_queries")
    assert work[fine][0] == work[cold][0] and sum(work[fine]) < sum(work[cold])
    # Each pose of a warm chain has all its repeats, and names its predecessor.
    case, chain, identity = (
        numbers(file, "repeats/case"),
        texts(file, "cases/chain"),
        texts(file, "cases/identity"),
    )
    assert all((case == i).sum() == 3 for i in warm)
    assert chain[fine[0]] == ""
    for before, after in zip(fine, fine[1:]):
        assert chain[after] == identity[before]
    assert len(set(identity)) == len(identity)


def test_each_repeat_and_the_trace_are_whole_passes(
    hausbench: Program, chains: Path, tmp_path: Path
) -> None:
    chains.write_text(CHAIN.format(trace="true"))
    file = run(hausbench, chains, tmp_path)
    assert set(texts(file, "cases/status")) == {"ok"}  # `failed` if a trace ended with other bounds
    begin, end = numbers(file, "cases/trace_begin"), numbers(file, "cases/trace_end")
    lower, upper = numbers(file, "trace/lower"), numbers(file, "trace/upper")
    for i in labelled(file, "warm"):
        assert end[i] > begin[i]
        assert (lower[end[i] - 1], upper[end[i] - 1]) == (
            numbers(file, "cases/lower")[i],
            numbers(file, "cases/upper")[i],
        )


def test_kill_inside_a_chain_starts_it_at_its_head(
    hausbench: Program, chains: Path, tmp_path: Path
) -> None:
    """The state between poses cannot be stored, so the journal has all of a chain or none of it."""
    begin = time.monotonic()
    whole = run(hausbench, chains, tmp_path / "whole")
    seconds = time.monotonic() - begin
    moments = random.Random(4)
    folder = tmp_path / "killed"
    for _ in range(12):
        process = start(hausbench, chains, folder)
        time.sleep(moments.uniform(0.02, max(0.1, 0.7 * seconds)))
        process.kill()
        process.wait()
    finished = run(hausbench, chains, folder)
    same_answers(finished, whole)
    for counter in ("closest_point_queries", "subdivisions", "point_triangle_distances"):
        np.testing.assert_array_equal(
            numbers(finished, f"cases/counter_{counter}"),
            numbers(whole, f"cases/counter_{counter}"),
        )


def test_a_chain_with_a_pose_lost_is_run_again_as_a_whole(
    hausbench: Program, chains: Path, tmp_path: Path
) -> None:
    whole = run(hausbench, chains, tmp_path / "whole")
    folder = tmp_path / "cut"
    run(hausbench, chains, folder)
    journal = folder / "slow.journal"
    lines = journal.read_bytes().splitlines(True)
    identity = texts(whole, "cases/identity")[labelled(whole, "warm")[10]]
    journal.write_bytes(b"".join(line for line in lines if identity.encode() not in line))
    again = run(hausbench, chains, folder)
    same_answers(again, whole)
    assert (
        len(journal.read_bytes().splitlines()) == len(lines) - 1 + 12
    )  # the header, the other rows, and this chain again


def test_a_trace_that_is_asked_for_later_is_made(
    hausbench: Program, chains: Path, tmp_path: Path
) -> None:
    run(hausbench, chains, tmp_path)
    chains.write_text(CHAIN.format(trace="true"))
    file = run(hausbench, chains, tmp_path)
    lengths = numbers(file, "cases/trace_end") - numbers(file, "cases/trace_begin")
    assert all(lengths[i] > 0 for i in labelled(file, "warm"))


def test_a_pose_that_is_refused_is_passed_over(
    hausbench: Program, chains: Path, tmp_path: Path
) -> None:
    """The harness refuses the pose before the solver sees it, so the solver's state is
    unchanged."""
    poses = [
        "1 0 0  0 1 0  0 0 1  0 0 0",
        "1e307 0 0  0 1e307 0  0 0 1e307  1.79e308 1.79e308 0",
        "1 0 0  0 1 0  0 0 1  0.1 0 0",
    ]
    (tmp_path / "poses.txt").write_text("\n".join(poses) + "\n")
    chains.write_text(
        chains.read_text().replace(
            '{ kind = "rotation", axis = [0, 1, 3], degrees = 40, steps = 12 }',
            '{ kind = "poses", file = "poses.txt" }',
        )
    )
    file = run(hausbench, chains, tmp_path)
    status = texts(file, "cases/status")
    for label in ("warm", "cold"):
        rows = labelled(file, label)
        pose = numbers(file, "cases/pose_index")
        by_pose: list[set[str]] = [set(), set(), set()]
        for i in rows:
            by_pose[int(pose[i])].add(status[i])
        assert by_pose[0] == by_pose[2] == {"ok"}, label
        assert by_pose[1] == {"failed"}
        assert all(
            "beyond the largest double" in texts(file, "cases/reason")[i]
            for i in rows
            if status[i] == "failed"
        )


def test_shards_keep_chains_whole(hausbench: Program, chains: Path, tmp_path: Path) -> None:
    whole = run(hausbench, chains, tmp_path / "whole")
    for i in (1, 2):
        assert hausbench("run", chains, "--results", tmp_path, "--shard", f"{i}/2").returncode == 0
    assert (
        hausbench(
            "merge", tmp_path / "merged.h5", *sorted(tmp_path.glob("slow.shard-*.h5"))
        ).returncode
        == 0
    )
    same_answers(tmp_path / "merged.h5", whole)
    run(hausbench, chains, tmp_path / "everything", "--leave-nothing-out")
    (everything,) = (tmp_path / "everything").glob("*.h5")
    same_answers(everything, whole)
