"""Penetration depths and recorded simulations: rows, refusals, checks and the command line."""

from __future__ import annotations

import json
from pathlib import Path

import h5py
import pytest

from program import Program
from test_hostile_results import seal
from test_run import numbers, run, texts

RECORDING = """# two boxes and a bar
hausbench recording 1
frames 4
object 0 box
object 7 bar
object 3 box
pair 0 0 7 1 0 0 0 0 0 0 1 0 0 0 0 0 0
pair 2 0 7 1 0 0 0 0 0 0 0.5 0.5 0.5 0.5 0.125 0 0
pair 2 0 3 1 0 0 0 0 0 0 1 0 0 0 0.75 0 0
pair 3 0 7 1 0 0 0 0 0 0 1 0 0 0 0.25 0 0
"""
EXPERIMENT = """
title = "depths"
tolerances = [1e-6]
of = "absolute"
quantity = "penetration"
repeats = 0
stages = true
[model.box]
source = "file"
path = "box.off"
[model.bar]
source = "file"
path = "bar.off"
[[scene]]
name = "boxes"
recording = "boxes.recording"
{more}
[[solver]]
name = "penetration"
"""


def box(
    file: Path, low: tuple[float, float, float], high: tuple[float, float, float], faces: int = 12
) -> Path:
    corners = []
    for i in range(8):
        corners.append([(high if i >> k & 1 else low)[k] for k in range(3)])
    triangles = [
        "0 2 1",
        "1 2 3",
        "4 5 6",
        "5 7 6",
        "0 1 4",
        "1 5 4",
        "2 6 3",
        "3 6 7",
        "0 4 2",
        "2 4 6",
        "1 3 5",
        "3 7 5",
    ][:faces]
    lines = [f"{x} {y} {z}\n" for x, y, z in corners]
    lines += [f"3 {t}\n" for t in triangles]
    file.write_text(f"OFF\n8 {faces} 0\n" + "".join(lines))
    return file


def experiment(folder: Path, more: str = "", recording: str = RECORDING) -> Path:
    box(folder / "box.off", (0, 0, 0), (1, 1, 1))
    box(folder / "bar.off", (0.5, 0.2, 0.2), (2, 0.8, 0.8))
    (folder / "boxes.recording").write_text(recording)
    file = folder / "depths.toml"
    file.write_text(EXPERIMENT.format(more=more))
    return file


def test_each_pair_of_a_frame_is_a_case(hausbench: Program, tmp_path: Path) -> None:
    file = run(hausbench, experiment(tmp_path), tmp_path)
    scenes, frames, upper = (
        texts(file, "cases/scene"),
        numbers(file, "cases/frame"),
        numbers(file, "cases/upper"),
    )
    assert list(zip(scenes, frames)) == [
        ("boxes: box and bar", 0),
        ("boxes: box and bar", 2),
        ("boxes: box and bar", 3),
        ("boxes: box and box", 2),
    ]
    # At frame 2 the bar is rotated to lie along y, and moved by 0.125 along x.
    assert list(upper) == pytest.approx([0.5, 0.5, 0.25, 0.25], abs=2e-6)
    assert set(texts(file, "cases/quantity")) == {"penetration"} and set(
        texts(file, "cases/status")
    ) == {"ok"}
    assert (
        set(texts(file, "cases/lower_check")) == set(texts(file, "cases/upper_check")) == {"holds"}
    )
    for extras in map(json.loads, texts(file, "cases/extras")):
        assert (
            extras["parts"] == 1 and extras["seconds: cut"] > 0 and extras["seconds: measure"] > 0
        )
    assert hausbench("verify", file).returncode == 0
    assert ", depth" in hausbench("show", file).stdout


@pytest.mark.parametrize(
    ("more", "frames"),
    [("every = 2", [0, 2, 2]), ("frames = [3, 0]", [0, 3]), ("every = 3", [0, 3])],
)
def test_some_frames(hausbench: Program, tmp_path: Path, more: str, frames: list[int]) -> None:
    assert (
        list(numbers(run(hausbench, experiment(tmp_path, more), tmp_path), "cases/frame")) == frames
    )


@pytest.mark.parametrize(
    ("more", "error"),
    [
        ("every = 2\nframes = [1]", "'every' and 'frames' both choose frames"),
        ("frames = [4]", "a frame is an integer from 0 to 3"),
        ("frames = [1]", "no objects overlap in the frames"),
        ("frames = 2", "must be a list"),
        ("every = 0", "'every' must be an integer"),
        ('source = "box"', "'source' cannot be combined with 'recording'"),
        ('motion = { kind = "static" }', "'motion' cannot be combined with 'recording'"),
    ],
)
def test_keys_that_do_not_fit(hausbench: Program, tmp_path: Path, more: str, error: str) -> None:
    done = hausbench("run", experiment(tmp_path, more), "--results", tmp_path)
    assert done.returncode == 2 and error in done.stderr and "depths.toml:" in done.stderr


@pytest.mark.parametrize(
    ("old", "new", "line", "error"),
    [
        (
            "hausbench recording 1",
            "hausbench recording 2",
            2,
            "begins with 'hausbench recording 1'",
        ),
        ("frames 4", "frames four", 3, "how many there are"),
        ("object 7 bar", "object 0 bar", 5, "object 0 is there twice"),
        ("object 7 bar", "object 7", 5, "write 'object NUMBER MODEL'"),
        ("pair 3 0 7", "pair 4 0 7", 10, "frame 4 is not one of 4"),
        ("pair 3 0 7", "pair 1 0 7", 10, "frames go backwards"),
        ("pair 3 0 7", "pair 3 0 8", 10, "there is no object 8"),
        ("pair 3 0 7", "pair 3 7 7", 10, "two different objects"),
        ("0.25 0 0", "0.25 0", 10, "write 'pair FRAME"),
        ("0.25 0 0", "0.25 0 nan", 10, "write 'pair FRAME"),
        ("0.25 0 0", "0.25 0 0 -", 10, "write 'pair FRAME"),
        ("object 0 box", "frames 2", 4, "'frames' is there twice"),
        ("0.5 0.5 0.5 0.5", "0.5 0.5 0.5 0.6", 8, "the length of a quaternion is not 1"),
        ("# two", "pear", 1, "begins with"),
        ("pair 0", "pear 0", 7, "unknown word 'pear'"),
    ],
)
def test_recordings_that_are_wrong(
    hausbench: Program, tmp_path: Path, old: str, new: str, line: int, error: str
) -> None:
    done = hausbench(
        "run", experiment(tmp_path, recording=RECORDING.replace(old, new, 1)), "--results", tmp_path
    )
    assert (
        done.returncode == 2 and error in done.stderr and f"boxes.recording:{line}:" in done.stderr
    )


def test_comments_and_blanks(hausbench: Program, tmp_path: Path) -> None:
    recording = RECORDING.replace("recording 1", "recording 1  # a comment").replace(
        "frames 4", "\n  frames 4 \r"
    )
    assert (
        len(
            numbers(
                run(hausbench, experiment(tmp_path, recording=recording), tmp_path), "cases/frame"
            )
        )
        == 4
    )


def test_a_recording_that_is_missing_or_empty(hausbench: Program, tmp_path: Path) -> None:
    file = experiment(tmp_path, recording="hausbench recording 1\nframes 2\n")
    assert "no line 'pair'" in hausbench("run", file).stderr
    (tmp_path / "boxes.recording").unlink()
    done = hausbench("run", file)
    assert done.returncode == 2 and "cannot open the recording" in done.stderr


def test_open_meshes_are_refused_with_the_reason(hausbench: Program, tmp_path: Path) -> None:
    file = experiment(tmp_path)
    box(tmp_path / "bar.off", (0.5, 0.2, 0.2), (2, 0.8, 0.8), faces=11)
    done = hausbench("run", file, "--results", tmp_path)
    with h5py.File(tmp_path / "depths.h5") as f:
        statuses, reasons = f["cases/status"].asstr()[:], f["cases/reason"].asstr()[:]
    assert list(statuses) == ["failed"] * 3 + ["ok"], done.stderr
    assert all(
        "B bounds no volume" in reason and "not closed: 3 edges" in reason for reason in reasons[:3]
    )


def test_solvers_that_offer_none(hausbench: Program, tmp_path: Path) -> None:
    file = experiment(tmp_path)
    file.write_text(file.read_text().replace('name = "penetration"\n', 'name = "cover"\n'))
    hausbench("run", file, "--results", tmp_path)
    with h5py.File(tmp_path / "depths.h5") as f:
        assert set(f["cases/status"].asstr()[:]) == {"skipped"}
        assert all(
            "computes no penetration depth: solver 'penetration' does" in reason
            for reason in f["cases/reason"].asstr()[:]
        )


@pytest.mark.parametrize(
    ("lower", "upper", "reason"),
    [
        (0.6, 0.7, "the same part of the volume is bounded 0.5"),
        (0.0, 0.1, "lies deeper in the other solid"),
        (0.4, 0.3, "it is below lower"),
    ],
)
def test_a_wrong_depth_in_a_file_is_found(
    hausbench: Program, tmp_path: Path, lower: float, upper: float, reason: str
) -> None:
    file = run(hausbench, experiment(tmp_path, "frames = [0]"), tmp_path)
    file.write_bytes(file.read_bytes()[:-73])
    with h5py.File(file, "r+") as f:
        f["cases/lower"][:], f["cases/upper"][:] = lower, upper
    seal(file)
    done = hausbench("verify", file)
    assert done.returncode == 1 and reason in done.stdout + done.stderr, done.stdout


def test_rows_of_a_pair_are_held_against_each_other(hausbench: Program, tmp_path: Path) -> None:
    file = experiment(tmp_path, "frames = [0]")
    file.write_text(file.read_text() + 'parameters = { solver = ["cover", "tang"] }\n')
    run(hausbench, file, tmp_path)
    result = tmp_path / "depths.h5"
    result.write_bytes(result.read_bytes()[:-73])
    with h5py.File(result, "r+") as f:
        f["cases/lower"][1], f["cases/upper"][1] = 0.0, 0.4  # false: no vertex is deeper than 0.2
    seal(result)
    done = hausbench("verify", result)
    assert (
        done.returncode == 1
        and "below the verified lower bound 0.49999" in done.stdout + done.stderr
    ), done.stdout


def test_bodies_at_rest_are_cases_of_their_own(hausbench: Program, tmp_path: Path) -> None:
    again = RECORDING + "pair 3 0 3 1 0 0 0 0 0 0 1 0 0 0 0.75 0 0\n"
    file = run(hausbench, experiment(tmp_path, recording=again), tmp_path)
    assert list(numbers(file, "cases/frame")) == [0, 2, 3, 2, 3]
    assert len(set(texts(file, "cases/identity"))) == 5


def test_measure(hausbench: Program, tmp_path: Path) -> None:
    a, b = box(tmp_path / "a.off", (0, 0, 0), (1, 1, 1)), box(
        tmp_path / "b.off", (0.5, 0.2, 0.2), (2, 0.8, 0.8)
    )
    done = hausbench("measure", a, b, "--penetration")
    assert (
        done.returncode == 0
        and "depth in [" in done.stdout
        and "penetration (not certified)" in done.stdout
    )
    told = json.loads(
        hausbench("measure", a, b, "--penetration", "--json", "--set", "solver=tang").stdout
    )
    assert told["direction"] == "penetration" and told["upper"] == pytest.approx(0.5, abs=1e-5)
    assert hausbench("measure", a, b, "--penetration", "--cutoff", "0.4").returncode == 1
    assert hausbench("measure", a, b, "--penetration", "--cutoff", "0.6").returncode == 0
    for options, error in (
        (["--penetration", "--symmetric"], "are different quantities"),
        (["--solver", "penetration"], "computes the penetration depth only, not h(A,B)"),
        (["--penetration", "--solver", "cover"], "choose one that does with --solver: penetration"),
        (["--penetration", "--fields", str(tmp_path / "f.ply")], "has no fields"),
    ):
        done = hausbench("measure", a, b, *options)
        assert done.returncode == 2 and error in done.stderr, done.stderr
    opened = box(tmp_path / "open.off", (0, 0, 0), (1, 1, 1), faces=11)
    done = hausbench("measure", opened, b, "--penetration")
    assert done.returncode == 1 and "not closed" in done.stderr
