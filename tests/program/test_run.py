"""`hausbench run` gives every case a row, keeps finished cases, and continues when it is run
again."""

from __future__ import annotations

import fcntl
import hashlib
import json
import os
import signal
import subprocess
import time
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

from program import ROOT, Program


def run(hausbench: Program, experiment: Path, folder: Path, *more: str) -> Path:
    done = hausbench("run", experiment, "--results", folder, *more)
    assert done.returncode == 0, done.stderr
    return folder / (experiment.stem + ".h5")


def texts(file: Path, column: str) -> list[str]:
    with h5py.File(file, "r") as f:
        return [str(value) for value in f[column].asstr()[:]]


def numbers(file: Path, column: str) -> np.ndarray[Any, Any]:
    with h5py.File(file, "r") as f:
        return np.asarray(f[column][:])


ANSWERS = ("cases/identity", "cases/status")


def same_answers(first: Path, second: Path) -> None:
    for column in ANSWERS:
        assert texts(first, column) == texts(second, column)
    for column in ("cases/lower", "cases/upper", "cases/counter_queue_pushes"):
        np.testing.assert_array_equal(numbers(first, column), numbers(second, column))


def test_smoke_end_to_end(hausbench: Program, tmp_path: Path) -> None:
    file = run(hausbench, ROOT / "experiments" / "smoke.toml", tmp_path)
    status = texts(file, "cases/status")
    solver = texts(file, "cases/solver")
    scene = texts(file, "cases/scene")
    lower, upper = numbers(file, "cases/lower"), numbers(file, "cases/upper")
    assert set(status) <= {"ok", "skipped", "not_built"}
    answered = np.array([s == "ok" for s in status])
    assert answered.sum() >= 15
    assert np.all(lower[answered] <= upper[answered])
    # A solver that cannot take the shapes has rows with the reason.
    refused = [r for s, r in zip(status, texts(file, "cases/reason")) if s == "skipped"]
    assert refused and all("takes no" in r for r in refused)
    # Different solvers' intervals for the same distance overlap.
    pose = numbers(file, "cases/pose_index")
    for name, index in {(s, int(p)) for s, p in zip(scene, pose)}:
        rows = np.array([a and s == name and p == index for a, s, p in zip(answered, scene, pose)])
        assert lower[rows].max() <= upper[rows].min(), name
    # Every witness was checked again.
    check = texts(file, "cases/lower_check")
    assert {c for c, s, o in zip(check, status, solver) if s == "ok" and o != "cgal"} == {"holds"}
    # Bounds read off a trace are within their tolerance.
    from_trace = numbers(file, "cases/from_trace") == 1
    gap, tolerance = upper - lower, numbers(file, "cases/tolerance_absolute")
    assert from_trace.any() and np.all(
        gap[from_trace & answered] <= tolerance[from_trace & answered]
    )
    with h5py.File(file, "r") as f:
        assert f["meta"].attrs["schema_version"] == 2
        assert (
            f["meta"].attrs["experiment_toml"] == (ROOT / "experiments" / "smoke.toml").read_text()
        )
        assert len(f["repeats/wall_seconds"]) > 0 and np.all(f["repeats/wall_seconds"][:] > 0)
        assert len(f["ledger/reason"]) > 0


def test_same_command_again_runs_nothing(
    hausbench: Program, experiment: Path, tmp_path: Path
) -> None:
    file = run(hausbench, experiment, tmp_path)
    first = numbers(file, "repeats/wall_seconds")
    run(hausbench, experiment, tmp_path)
    np.testing.assert_array_equal(first, numbers(file, "repeats/wall_seconds"))
    run(hausbench, experiment, tmp_path, "--fresh")
    assert not np.array_equal(first, numbers(file, "repeats/wall_seconds"))


def test_another_experiment_of_the_same_name_does_not_replace_a_result(
    hausbench: Program, experiment: Path, tmp_path: Path
) -> None:
    file = run(hausbench, experiment, tmp_path)
    before = file.read_bytes()
    namesake = tmp_path / "other" / experiment.name
    namesake.parent.mkdir()
    namesake.write_text(experiment.read_text())
    assert (
        hausbench("run", namesake, "--results", tmp_path).returncode == 0
    )  # the same text under another name
    run(hausbench, experiment, tmp_path)
    namesake.write_text(experiment.read_text() + "# edited\n")
    said = hausbench.fails("run", namesake, "--results", tmp_path)
    assert (
        f"is the result of another experiment of this name, {experiment}:" in said
        and "--results" in said
        and "--fresh" in said
    )
    assert file.stat().st_size == len(before)
    experiment.write_text(namesake.read_text() + "# edited in place\n")
    run(hausbench, experiment, tmp_path)
    run(hausbench, namesake, tmp_path, "--fresh")
    experiment.unlink()
    namesake.rename(experiment)
    run(hausbench, experiment, tmp_path)


def test_structures_are_built_once_for_all_poses(hausbench: Program, tmp_path: Path) -> None:
    experiment = tmp_path / "moved.toml"
    experiment.write_text(
        """\
title = "moved"
tolerances = [1e-12]
of = "diagonal"
repeats = 1
[[scene]]
name = "clouds"
source = "gaussian_1k_a"
target = "gaussian_1k_b"
motion = { kind = "translation", from = [0, 0, 0], to = [3, 0, 0], steps = 5 }
[[solver]]
name = "ohd"
"""
    )
    file = run(hausbench, experiment, tmp_path)
    with h5py.File(file, "r") as f:
        built = np.unique(f["cases/prepare_seconds"][:])
        entry = list(f["ledger/what"].asstr()[:]).index("structures for each pose")
        assert (
            len(built) == 1
            and len(f["cases/lower"]) == 5
            and len(np.unique(f["cases/lower"][:])) == 5
        )
        assert f["ledger/count"][entry] == 4 and f["ledger/kind"].asstr()[entry] == "not_prepared"
        assert f["ledger/seconds_saved"][entry] == pytest.approx(4 * built[0])
        assert f["ledger/reason"].asstr()[entry] == "built once and used for all 5 poses"


def test_rounds_add_repeats_from_fresh_processes(
    hausbench: Program, experiment: Path, tmp_path: Path
) -> None:
    experiment.write_text(experiment.read_text().replace("repeats = 1", "repeats = 2\nrounds = 3"))
    file = run(hausbench, experiment, tmp_path)
    assert sorted(numbers(file, "repeats/round")) == [0, 0, 1, 1, 2, 2]
    with h5py.File(file, "r") as f:
        assert list(f["answers/case"]) == [0, 0, 0] and list(f["answers/round"]) == [0, 1, 2]
        assert f["answers/wall_seconds"][0] == f["cases/solve_seconds"][0]
        assert (f["answers/cpu_seconds"][:] > 0).all() and len(
            set(f["answers/wall_seconds"][:])
        ) == 3
    assert texts(file, "cases/status") == ["ok"]


def test_more_repeats_are_measured_when_asked_for(
    hausbench: Program, experiment: Path, tmp_path: Path
) -> None:
    text = experiment.read_text()
    for repeats, there in ((2, 2), (5, 5), (3, 5)):
        experiment.write_text(text.replace("repeats = 1", f"repeats = {repeats}"))
        file = run(hausbench, experiment, tmp_path)
        assert len(numbers(file, "repeats/wall_seconds")) == there


def test_certified_is_said_of_the_options(
    hausbench: Program, experiment: Path, tmp_path: Path
) -> None:
    # Uncertified rows may be wrong in the last digits.
    experiment.write_text(
        'expected_unsound = ["guthe"]\n'
        + experiment.read_text()
        + 'parameters = { kernel = ["robust", "textbook"], certify = [true, false] }\n'
    )
    file = run(hausbench, experiment, tmp_path)
    for options, certified in zip(texts(file, "cases/options"), numbers(file, "cases/certified")):
        given = json.loads(options)
        assert certified == (given["kernel"] == "robust" and given["certify"])


def test_missing_package_is_skipped_with_the_reason(
    hausbench: Program, experiment: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HAUSBENCH_CACHE", str(tmp_path / "cache"))
    experiment.write_text(experiment.read_text().replace("sphere1", "bunny"))
    file = run(hausbench, experiment, tmp_path)
    assert texts(file, "cases/status") == ["skipped"]
    assert "run `hausbench fetch`" in texts(file, "cases/reason")[0]


def test_two_runs_on_one_result_refuse(
    hausbench: Program, experiment: Path, tmp_path: Path
) -> None:
    journal = tmp_path / "tiny.journal"
    with open(journal, "w") as held:
        fcntl.flock(held, fcntl.LOCK_EX)
        assert "another run" in hausbench.fails("run", experiment, "--results", tmp_path)


def test_a_torn_last_record_is_run_again(
    hausbench: Program, experiment: Path, tmp_path: Path
) -> None:
    file = run(hausbench, experiment, tmp_path)
    journal = tmp_path / "tiny.journal"
    whole = journal.read_bytes()
    journal.write_bytes(whole[:-20])
    once = texts(file, "cases/identity")
    run(hausbench, experiment, tmp_path)
    assert texts(file, "cases/identity") == once and texts(file, "cases/status") == ["ok"]
    lines = whole.splitlines(True)
    journal.write_bytes(lines[0] + b"0" * 40 + b"\n" + lines[1])
    assert "damaged" in hausbench.fails("run", experiment, "--results", tmp_path)


def signed(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()[:16] + " " + text + "\n"


def test_journals_that_are_none(hausbench: Program, experiment: Path, tmp_path: Path) -> None:
    file = run(hausbench, experiment, tmp_path)
    journal = tmp_path / "tiny.journal"
    header = journal.read_text().splitlines(True)[0]
    for text, said in (
        ("something else entirely, of another program\n", "not a journal"),
        ("hello\n", "not a journal"),
        ("hello", "not a journal"),
        (signed("[1, 2]"), "--fresh"),
        (signed('{"hausbench_journal": 1}'), "--fresh"),
        (header + signed('{"identity": "x"}'), "tiny.journal:2"),
        (header + signed("[]"), "tiny.journal:2"),
    ):
        journal.write_text(text)
        assert said in hausbench.fails("run", experiment, "--results", tmp_path)
        assert journal.read_text() == text  # foreign files are not overwritten
    for length in (
        0,
        5,
        16,
        17,
        30,
        len(header) - 1,
    ):  # the header was cut off while it was written
        journal.write_text(header[:length])
        run(hausbench, experiment, tmp_path)
    assert texts(file, "cases/status") == ["ok"]


SLOW = """\
title = "slow enough to be interrupted"
tolerances = [1e-2, 1e-3]
of = "diagonal"
repeats = 1

[[scene]]
name = "turned"
source = "sphere2"
target = "sphere3"
motion = { kind = "rotation", axis = [1, 2, 3], degrees = 40, steps = 6 }

[[solver]]
name = "guthe"

[[solver]]
name = "cgal"
"""


@pytest.fixture
def slow(tmp_path: Path) -> Path:
    file = tmp_path / "slow.toml"
    file.write_text(SLOW)
    return file


def start(
    hausbench: Program, experiment: Path, folder: Path, *more: str
) -> subprocess.Popen[bytes]:
    return subprocess.Popen(
        hausbench.command("run", experiment, "--results", folder, *more),
        env=hausbench.environment(),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )


def records(folder: Path) -> int:
    journal = folder / "slow.journal"
    return len(journal.read_bytes().splitlines()) if journal.exists() else 0


def wait_for(condition: object, seconds: float = 60) -> None:
    end = time.monotonic() + seconds
    while not condition():  # type: ignore[operator]
        assert time.monotonic() < end
        time.sleep(0.005)


def test_ctrl_c_leaves_a_resumable_state(hausbench: Program, slow: Path, tmp_path: Path) -> None:
    undisturbed = run(hausbench, slow, tmp_path / "whole")
    folder = tmp_path / "cut"
    process = start(hausbench, slow, folder)
    wait_for(lambda: records(folder) >= 4)
    process.send_signal(signal.SIGINT)
    assert process.wait(30) in (130, 0)
    cut = folder / "slow.h5"
    assert texts(cut, "cases/identity") == texts(
        undisturbed, "cases/identity"
    )  # every case already has a row
    same_answers(run(hausbench, slow, folder), undisturbed)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_ctrl_c_keeps_the_rows_of_earlier_runs(
    hausbench: Program, slow: Path, tmp_path: Path, number: signal.Signals
) -> None:
    """The file is read again while the signal is pending, and the interruption must not look like
    an unreadable file."""
    whole = run(hausbench, slow, tmp_path)
    before = texts(whole, "cases/identity")
    os.remove(tmp_path / "slow.journal")
    process = start(hausbench, slow, tmp_path, "--scene", texts(whole, "cases/scene")[0])
    wait_for(
        lambda: records(tmp_path) >= 3
    )  # the first record is the header, written before signals are deferred
    process.send_signal(number)
    assert process.wait(30) in (130, 0)
    assert texts(whole, "cases/identity") == before and not list(tmp_path.glob("*.unreadable"))
    same_answers(run(hausbench, slow, tmp_path), whole)


def test_floor_cutoff_and_budget_are_asked_for(
    hausbench: Program, experiment: Path, tmp_path: Path
) -> None:
    """All three are columns, and part of the identity only if given. Floor and cutoff are
    lengths."""
    plain = run(hausbench, experiment, tmp_path / "plain")
    h, diagonal = numbers(plain, "cases/lower")[0], numbers(plain, "cases/source_diagonal")[0]
    text = experiment.read_text()
    answers = {}
    for key, value in (("floor", 2 * h), ("cutoff", h / 2), ("budget", 0)):
        experiment.write_text(f"{key} = {value / diagonal if key != 'budget' else 0}\n{text}")
        file = run(hausbench, experiment, tmp_path / key)
        answers[key] = texts(file, "cases/answer")[0]
        assert numbers(file, f"cases/{key}")[0] == pytest.approx(value)
        assert texts(file, "cases/identity") != texts(plain, "cases/identity")
        assert texts(file, "cases/status") == ["budget" if key == "budget" else "ok"]
    assert answers == {"floor": "h <= floor", "cutoff": "h > cutoff", "budget": ""}
    assert texts(plain, "cases/answer") == ["gap"]
    side = numbers(plain, "cases/source_longest")[0]
    experiment.write_text(
        text.replace('"diagonal"', '"longest"') + "[profile.quick]\nfloor = 0.01\ncutoff = 0.5\n"
    )
    file = run(hausbench, experiment, tmp_path / "longest")
    assert side != diagonal and numbers(file, "models/longest_side")[0] == side
    assert numbers(file, "cases/tolerance_absolute")[0] == 1e-3 * side
    assert (numbers(file, "cases/floor")[0], numbers(file, "cases/cutoff")[0]) == (
        0.01 * side,
        0.5 * side,
    )
    for key in ("floor", "cutoff"):
        experiment.write_text(f"{key} = -1\n{text}")
        assert key in hausbench.fails("run", experiment, "--results", tmp_path)


BOTH = """\
title = "both shapes, both directions"
tolerances = [1e-3]
repeats = 1
[[scene]]
name = "still"
source = "sphere1"
target = "cube1"
[[scene]]
name = "together"
source = "sphere1"
target = "cube1"
motion = { kind = "translation", of = "absolute", from = [0, 0, 0], to = [4, 2, 1], steps = 3 }
target_motion = { kind = "translation", of = "absolute", from = [0, 0, 0], to = [4, 2, 1], steps = 3 }
[[scene]]
name = "back"
source = "cube1"
target = "sphere1"
[[solver]]
name = "guthe"
[[solver]]
name = "guthe"
quantity = "symmetric"
"""


def test_both_poses_and_both_directions_are_measured(hausbench: Program, tmp_path: Path) -> None:
    experiment = tmp_path / "both.toml"
    experiment.write_text(BOTH)
    file = run(hausbench, experiment, tmp_path)
    assert set(texts(file, "cases/status")) == {"ok"}
    assert (
        set(texts(file, "cases/lower_check")) == set(texts(file, "cases/upper_check")) == {"holds"}
    )
    names = zip(
        texts(file, "cases/scene"), texts(file, "cases/quantity"), numbers(file, "cases/pose_index")
    )
    intervals = dict(zip(names, zip(numbers(file, "cases/lower"), numbers(file, "cases/upper"))))
    tolerance = 1.001 * max(numbers(file, "cases/tolerance_absolute"))
    forth, back = intervals["still", "directed", 0], intervals["back", "directed", 0]
    assert abs(forth[0] - back[0]) > 5 * tolerance
    for scene in ("still", "back"):
        assert intervals[scene, "symmetric", 0][0] == pytest.approx(
            max(forth[0], back[0]), abs=tolerance
        )
    # If both shapes move together, their distances stay.
    for quantity in ("directed", "symmetric"):
        for pose in range(3):
            assert intervals["together", quantity, pose][0] == pytest.approx(
                intervals["still", quantity, 0][0], abs=tolerance
            )
    moved = [i for i, pose in enumerate(numbers(file, "cases/target_pose")) if pose[9] == 4]
    assert len(moved) == 2 and {texts(file, "cases/scene")[i] for i in moved} == {"together"}
    assert hausbench("verify", file).returncode == 0
    assert (
        hausbench("merge", tmp_path / "merged.h5", file, file).returncode == 0
    )  # h and H of a case are different rows
