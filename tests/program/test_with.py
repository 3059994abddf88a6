"""`--with` runs an experiment's scenes with another solver. `run` warns if a plug-in's upper bounds
were hardly tested."""

from __future__ import annotations

from pathlib import Path

import h5py
import pytest

from program import EXPERIMENT, Program
from test_run import texts

# The file's claims, labels and expectations name its own solvers, and so does a profile.
OTHERS = """
[[scene]]
name = "raised"
source = "raised.off"
target = "tetrahedron.off"

[[solver]]
name = "guthe"
label = "other"
[[claim]]
solver = "guthe"
faster_than = "other"

[profile.paper]
expected_unsound = ["other"]
repeats = 2
"""


@pytest.fixture
def asked(experiment: Path, tetrahedron: Path, raised: Path) -> Path:
    experiment.write_text('expected_unsound = ["other"]\n' + EXPERIMENT + OTHERS)
    return experiment


def test_another_solver_on_the_scenes_of_an_experiment(
    hausbench: Program, asked: Path, tmp_path: Path
) -> None:
    done = hausbench("run", asked, "--with", "tang", "--results", tmp_path)
    assert done.returncode == 0, done.stderr
    file = tmp_path / "tiny_tang.h5"
    assert set(texts(file, "cases/label")) == {"tang"} and set(texts(file, "cases/scene")) == {
        "spheres",
        "raised",
    }
    with h5py.File(file) as f:
        assert (f["meta"].attrs["stem"], f["meta"].attrs["title"]) == ("tiny_tang", "a test: tang")
    assert not (tmp_path / "tiny.h5").exists()
    assert hausbench("verify", file).returncode == 0
    before = file.read_bytes()
    assert (
        hausbench(
            "run", asked, "--with", "tang", "--results", tmp_path, "--profile", "paper"
        ).returncode
        == 0
    )
    assert set(texts(file, "cases/profile")) == {"paper,quick"} and file.read_bytes() != before
    assert (
        "tiny_tang (a test: tang"
        in hausbench("explain", asked, "--with", "tang", "--results", tmp_path).stdout
    )


def test_mistakes(hausbench: Program, asked: Path, tmp_path: Path) -> None:
    assert "did you mean 'tang'" in hausbench.fails(
        "run", asked, "--with", "tank", "--results", tmp_path
    )
    assert "name a solver" in hausbench.fails("run", asked, "--with", "", "--results", tmp_path)
    assert not (tmp_path / "tiny.h5").exists()
    assert (
        "--solver excludes --with"
        in hausbench(
            "run", asked, "--with", "tang", "--solver", "guthe", "--results", tmp_path
        ).stderr
    )
    assert "--with" in hausbench.fails(
        "run", asked, "--with", "tang", "--engine", "slurm", "--results", tmp_path
    )
    asked.write_text("title = ")
    assert "tiny.toml:1:" in hausbench.fails("run", asked, "--with", "tang", "--results", tmp_path)


def test_upper_bounds_that_were_tried_little(
    hausbench: Program, asked: Path, plugin: Path, tmp_path: Path
) -> None:
    """`steps` claims upper bounds that are right only if a vertex is farthest. On such scenes only
    the warning reveals it; on others it is unsound.
    """
    ask = ("run", asked, "--with", "steps", "--plugin", plugin, "--results", tmp_path)
    easy = hausbench(*ask, "--scene", "raised")
    assert easy.returncode == 0 and set(texts(tmp_path / "tiny_steps.h5", "cases/status")) <= {
        "ok",
        "budget",
    }
    assert (
        "the upper bounds of steps were tried little: in 1 answer the distance lies nowhere above"
        in easy.stderr
    )
    assert "`hausbench run stability_matrix --with steps --plugin" in easy.stderr
    assert f"--plugin '{plugin}'`" in easy.stderr
    none = hausbench(*ask, "--scene", "raised", "--no-reference", "--fresh")
    assert (
        "the upper bounds of steps were not tried at all: no reference answer is known for its 1 answer"
        in none.stderr
    )
    hard = hausbench(
        "run",
        "stability_matrix",
        "--scene",
        "farthest point inside a face {}",
        "--with",
        "steps",
        "--plugin",
        plugin,
        "--results",
        tmp_path,
    )
    assert hard.returncode == 1 and "unsound" in set(
        texts(tmp_path / "stability_matrix_steps.h5", "cases/status")
    )
    assert "tried little" not in hard.stderr


def test_the_reference_and_not_the_experiment_says_where_the_distance_is(
    hausbench: Program, asked: Path, plugin: Path, tmp_path: Path
) -> None:
    """The experiment's `exact` may be wrong. If so, that is reported, and the value is not used."""
    asked.write_text(
        EXPERIMENT
        + OTHERS.replace('target = "tetrahedron.off"', 'target = "tetrahedron.off"\nexact = 0.501')
    )
    done = hausbench(
        "run",
        asked,
        "--with",
        "steps",
        "--plugin",
        plugin,
        "--scene",
        "raised",
        "--results",
        tmp_path,
    )
    assert (
        "scene 'raised': the experiment says that the distance is exactly 0.501, the reference answer is ["
        in done.stderr
    )
    assert "tried little" in done.stderr


def test_the_plugins_of_the_experiment_are_known(
    hausbench: Program, asked: Path, plugin: Path, tmp_path: Path
) -> None:
    asked.write_text(f'plugins = ["{plugin}"]\n' + EXPERIMENT + OTHERS)
    done = hausbench("run", asked, "--with", "steps", "--scene", "raised", "--results", tmp_path)
    assert done.returncode == 0 and (tmp_path / "tiny_steps.h5").exists(), done.stderr


def test_mistakes_of_the_file_are_named_by_its_own_lines(
    hausbench: Program, asked: Path, tmp_path: Path
) -> None:
    asked.write_text(
        EXPERIMENT + OTHERS.replace('source = "raised.off"', 'source = "raised.off"\nexact = "one"')
    )
    assert "tiny.toml:17:" in hausbench.fails("run", asked, "--with", "tang", "--results", tmp_path)
    asked.write_text(EXPERIMENT + OTHERS)
    assert "--with external: needs parameters: write a [[solver]]" in hausbench.fails(
        "run", asked, "--with", "external", "--results", tmp_path
    )


def test_a_solver_of_the_program_is_tried_by_its_own_tests(
    hausbench: Program, asked: Path, tmp_path: Path
) -> None:
    assert (
        "tried little"
        not in hausbench(
            "run", asked, "--with", "guthe", "--scene", "raised", "--results", tmp_path
        ).stderr
    )
