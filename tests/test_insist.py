"""Tests `--insist`, which turns a skip into a failure."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

SKIPS = """import pytest

@pytest.fixture
def tool():
    pytest.skip("there is no such tool")

def test_with_it(tool):
    pass

@pytest.mark.skipif(True, reason="there is no such processor")
def test_on_it():
    pass

def test_of_nothing():
    pass
"""


@pytest.mark.parametrize(
    ("options", "code", "counts"),
    [([], 0, "1 passed, 2 skipped"), (["--insist"], 1, "1 passed, 2 errors")],
)
def test_a_skip_fails_if_the_target_insists(
    tmp_path: Path, options: list[str], code: int, counts: str
) -> None:
    (tmp_path / "conftest.py").write_text(Path(__file__).with_name("conftest.py").read_text())
    (tmp_path / "test_skips.py").write_text(SKIPS)
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-rs", "-p", "no:cacheprovider", *options, str(tmp_path)],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "PYTEST_ADDOPTS": ""},
    )
    assert done.returncode == code and counts in done.stdout, done.stdout
    assert "there is no such tool" in done.stdout and "there is no such processor" in done.stdout


def test_slurm_without_its_programs_is_skipped_and_make_test_slurm_insists() -> None:
    words = [
        sys.executable,
        "-m",
        "pytest",
        "-q",
        "-rs",
        "-p",
        "no:cacheprovider",
        "-k",
        "lost_node",
        str(Path(__file__).parent / "slurm"),
    ]
    environment = {**os.environ, "PATH": "/nowhere", "PYTEST_ADDOPTS": ""}
    done = subprocess.run(words, env=environment, capture_output=True, text=True, check=False)
    assert (
        done.returncode == 0
        and "1 skipped" in done.stdout
        and "there is no Slurm to test with" in done.stdout
    ), done.stdout
    done = subprocess.run(
        [*words, "--insist"], env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 1, done.stdout
    makefile = (Path(__file__).resolve().parents[1] / "Makefile").read_text()
    assert "--insist tests/slurm" in makefile
