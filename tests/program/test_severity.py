"""Scenes with a series of severities, and shapes described inside a scene."""

from __future__ import annotations

import math
from pathlib import Path

import h5py
import pytest

from program import Program

HEAD = """\
title = "a sweep"
tolerances = [1e-3]
repeats = 0
"""
SOLVER = '\n[[solver]]\nname = "cover"\n'
SQUARES = """
[[scene]]
name = "squares {}"
note = "as far as {}"
severity = [0.25, 1e8]
source = { vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [9, 9, 9]], triangles = [[0, 1, 2]] }
target = [{ recipe = "plane", n = 4, z = "-{}" }, { operation = "move", x = 0, y = 0, z = "{}" }, { operation = "move", x = 0, y = 0, z = "{}" }]
exact = "{}"
"""


def write(hausbench: Program, scenes: str) -> Path:
    file = hausbench.folder / "sweep.toml"
    file.write_text(HEAD + scenes + SOLVER)
    return file


def test_each_value_is_a_scene(hausbench: Program) -> None:
    file = write(
        hausbench,
        SQUARES
        + """
[[scene]]
name = "points"
family = "pairs"
severity = 2
source = { points = [[0, 0, 0]] }
target = { points = [[2, 1, 2], [8, 8, 8]] }
exact = 3
""",
    )
    results = hausbench.folder / "results"
    done = hausbench("run", file, "--results", results)
    assert done.returncode == 0, done.stderr
    with h5py.File(results / "sweep.h5") as content:
        cases = content["cases"]
        names = list(cases["scene"].asstr()[()])
        assert names == ["squares 0.25", "squares 1e8", "points"]
        assert list(cases["family"].asstr()[()]) == ["squares", "squares", "pairs"]
        assert list(cases["severity"][()]) == [0.25, 1e8, 2]
        assert list(cases["scene_note"].asstr()[()]) == ["as far as 0.25", "as far as 1e8", ""]
        assert list(cases["exact"][()]) == [0.25, 1e8, 3]
        assert list(cases["source"].asstr()[()]) == ["squares_0.25.A", "squares_1e8.A", "points.A"]
        lower, upper = cases["lower"][()], cases["upper"][()]
        # The corners (1, 0) and (0, 1) are beyond the square in the plane, which ends at 1/2.
        for row, severity in enumerate((0.25, 1e8)):
            truth = math.hypot(0.5, severity)
            assert lower[row] <= truth * (1 + 1e-15) and upper[row] >= truth * (1 - 1e-15)
        models = dict(
            zip(content["models"]["name"].asstr()[()], content["models"]["unreferenced"][()])
        )
        assert models["squares_1e8.A"] == 1  # the unused vertex
        assert models["points.A"] == 0
    checked = hausbench(
        "verify", results / "sweep.h5"
    )  # finds the shapes in the experiment text inside the result
    assert checked.returncode == 0, checked.stderr


def test_a_sweep_is_chosen_as_a_whole_or_one_by_one(hausbench: Program) -> None:
    file = write(hausbench, SQUARES)
    for choice, rows in (("squares {}", 2), ("squares 1e8", 1)):
        done = hausbench("run", file, "--scene", choice, "--results", hausbench.folder / str(rows))
        assert done.returncode == 0, done.stderr
        with h5py.File(hausbench.folder / str(rows) / "sweep.h5") as content:
            assert len(content["cases"]["scene"]) == rows


def test_a_scene_may_have_tolerances_of_its_own_and_motions_are_filled(hausbench: Program) -> None:
    file = write(
        hausbench,
        """
[[scene]]
name = "turned {}"
severity = [90, 180]
tolerances = [1e-9, 1e-5]
source = "cube1"
target = "sphere1"
motion = { kind = "rotation", axis = [0, 0, 1], degrees = "{}", steps = 2 }
""",
    )
    done = hausbench("run", file, "--results", hausbench.folder / "results")
    assert done.returncode == 0, done.stderr
    with h5py.File(hausbench.folder / "results" / "sweep.h5") as content:
        cases = content["cases"]
        assert sorted(set(cases["tolerance"][()])) == [1e-9, 1e-5]
        last = {
            scene: pose
            for scene, index, pose in zip(
                cases["scene"].asstr()[()], cases["pose_index"][()], cases["pose"][()]
            )
            if index == 1
        }
        assert abs(last["turned 90"][0]) < 1e-9 and abs(last["turned 180"][0] + 1) < 1e-9


def test_a_scene_of_another_profile_may_describe_a_shape_under_the_same_name(
    hausbench: Program,
) -> None:
    scene = '\n[[scene]]\nname = "a"\nprofiles = ["{}"]\nsource = {{ recipe = "cube", subdivisions = 1 }}\ntarget = "sphere1"\n'
    done = hausbench(
        "run",
        write(hausbench, scene.format("quick") + scene.format("paper")),
        "--results",
        hausbench.folder / "results",
    )
    assert done.returncode == 0, done.stderr


def test_scenes_without_severity_have_neither(hausbench: Program) -> None:
    file = write(
        hausbench,
        '[[scene]]\nname = "one"\nsource = { recipe = "cube", subdivisions = 1 }\ntarget = "sphere1"\n',
    )
    done = hausbench("run", file, "--results", hausbench.folder / "results")
    assert done.returncode == 0, done.stderr
    with h5py.File(hausbench.folder / "results" / "sweep.h5") as content:
        assert list(content["cases"]["family"].asstr()[()]) == [""]
        assert math.isnan(content["cases"]["severity"][0])


@pytest.mark.parametrize(
    "before, after, said",
    [
        ("severity = [0.25, 1e8]", "severity = []", ("'severity' has no value",)),
        ("severity = [0.25, 1e8]", "severity = [1, 2, 1]", ("'severity' has a value twice",)),
        ("severity = [0.25, 1e8]", 'severity = ["low"]', ("'severity' must be a number",)),
        (
            'name = "squares {}"',
            'name = "squares"',
            ("'name' has no {}, the place of each severity",),
        ),
        (
            'exact = "{}"',
            "exact = [1, 2, 3]",
            ("'exact' must be a number, or a list of as many as 'severity' has",),
        ),
        ("n = 4", "n = 4, nn = 5", ("model 'squares_0.25.B.0'", "'nn'")),
        (
            'operation = "move"',
            'operation = "moved"',
            ("unknown operation 'moved'", "did you mean 'move'"),
        ),
        ("[[0, 1, 2]]", "[[0, 1, 4]]", ("'triangles' names vertex 4, but there are 4",)),
        ("[[0, 1, 2]]", "[[0, 1]]", ("'triangles' must be a list of three numbers of vertices",)),
        (
            "[[0, 1, 2]]",
            "[[0, 1, 0.5]]",
            ("'triangles' must be a list of three numbers of vertices",),
        ),
        ("[9, 9, 9]", '[9, 9, "x"]', ("'vertices' must be a number",)),
        (
            "severity = [0.25, 1e8]",
            'severity = 1\nfamily = "f"',
            ("'z' must be a number: {} stands for one in a scene with a list of severities",),
        ),
        ("n = 4", 'n = 4, tolerances = "x"', ("unknown key 'tolerances'",)),
        (
            'exact = "{}"',
            'exact = "{}"\neach = ["cow"]',
            ("'each' cannot be combined with a list of severities",),
        ),
    ],
)
def test_mistakes_name_the_place(
    hausbench: Program, before: str, after: str, said: tuple[str, ...]
) -> None:
    assert before in SQUARES
    message = hausbench.fails(
        "run",
        write(hausbench, SQUARES.replace(before, after, 1)),
        "--results",
        hausbench.folder / "results",
    )
    assert "sweep.toml:" in message
    for text in said:
        assert text in message
