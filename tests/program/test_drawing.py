"""`hausbench draw` makes a figure and a verdict from a plug-in and an experiment with claims,
without a script."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from program import ROOT, Program, head


@pytest.fixture
def own(plugin: Path, tmp_path: Path) -> Path:
    """An experiment that names its plug-in by a path relative to the experiment's folder."""
    (tmp_path / "libmine.so").symlink_to(plugin)
    file = tmp_path / "own.toml"
    text = head().replace("repeats = 1", "repeats = 1\nrounds = 6")
    file.write_text(
        'plugins = ["libmine.so"]\n' + text + '\n[[solver]]\nname = "vertex_only"\n'
        '[[claim]]\nsolver = "vertex_only"\nfaster_than = "guthe"\non = "every"\n'
    )
    return file


def test_an_own_experiment_is_drawn(hausbench: Program, own: Path, tmp_path: Path) -> None:
    done = hausbench("run", own, "--results", tmp_path, "--quiet", "--no-reference")
    assert done.returncode == 0, done.stderr
    done = hausbench(
        "draw", tmp_path / "own.h5", "--out", tmp_path / "paper", "--highlight", "vertex_only"
    )
    assert done.returncode == 0, done.stderr
    assert (
        "takes less time than Guthe 2005 on every case" in done.stdout and "Claim: " in done.stdout
    )
    for name, begin in (
        ("figures/own_motion.pdf", b"%PDF"),
        ("figures/own_motion.png", b"\x89PNG"),
        ("tables/own_table.tex", b"% needs"),
    ):
        assert (tmp_path / "paper" / name).read_bytes().startswith(begin)
    assert "hausbench draw" in hausbench("draw", "--help").stdout
    assert hausbench("draw", tmp_path / "none.h5").returncode == 2


def test_what_claims_and_plugins_name_is_checked(
    hausbench: Program, own: Path, tmp_path: Path
) -> None:
    good = own.read_text()
    for wrong, said in (
        ('faster_than = "guhte"', "did you mean 'guthe'"),
        ("by = -1", "'by'"),
        ('on = "most"', "average or every"),
        ("because = 1", "unknown key"),
    ):
        key = wrong.partition(" ")[0]
        text = good.replace(
            'faster_than = "guthe"\n' if key == "faster_than" else 'on = "every"\n', f"{wrong}\n"
        )
        own.write_text(text)
        line = hausbench.fails("explain", own)
        assert said in line and "own.toml:" in line, line
    own.write_text(good.replace("libmine.so", "libyours.so"))
    line = hausbench.fails("explain", own)
    assert "own.toml:1" in line and "libyours.so" in line
    own.write_text(good)
    assert hausbench("explain", own, "--plugin", tmp_path / "libmine.so").returncode == 0


def test_width_and_format_of_figures(hausbench: Program, experiment: Path, tmp_path: Path) -> None:
    assert (
        hausbench("run", experiment, "--results", tmp_path, "--quiet", "--no-reference").returncode
        == 0
    )
    done = hausbench("draw", tmp_path / "tiny.h5", "--width", "single", "--format", "svg")
    assert done.returncode == 0, done.stderr
    (figure,) = (tmp_path / "figures").iterdir()
    assert figure.name == "tiny_error_against_time.svg" and 'width="252pt"' in figure.read_text(
        encoding="utf-8"
    )
    assert (
        "'gif' is not one of pdf, png, svg"
        in hausbench("draw", tmp_path / "tiny.h5", "--format", "gif").stderr
    )


def test_models_are_fetched_to_where_the_program_looks(hausbench: Program, tmp_path: Path) -> None:
    python = tmp_path / "python3"
    python.write_text('#!/bin/sh\necho "$HAUSBENCH_CACHE"\n')
    python.chmod(0o755)
    done = subprocess.run(
        [hausbench.path, "fetch"],
        env={**hausbench.environment(), "PYTHON": str(python)},
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.strip() == str(ROOT / "datasets" / "cache")
    done = hausbench("fetch", "no_such_model")
    assert done.returncode == 2 and "no_such_model" in done.stderr
