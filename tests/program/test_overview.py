"""Draws the README's picture from a similar experiment."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from program import ROOT, Program
from test_run import run


@pytest.fixture
def overview(tmp_path: Path) -> Path:
    text = (ROOT / "experiments" / "overview.toml").read_text()
    for real, made in (("bunny_small_normalised", "sphere2"), ("bunny_normalised", "sphere4")):
        assert f'"{real}"' in text
        text = text.replace(f'"{real}"', f'"{made}"')
    file = tmp_path / "overview.toml"
    file.write_text(text)
    return file


def drawn(hausbench: Program, folder: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [
            sys.executable,
            "-m",
            "analysis",
            "overview",
            "--results",
            str(folder),
            "--out",
            str(folder),
        ],
        cwd=ROOT,
        env={**hausbench.environment(), "HAUSBENCH_PROGRAM": hausbench.path},
        capture_output=True,
        text=True,
        timeout=120,
    )


def test_the_picture_follows_from_its_experiment(
    hausbench: Program, overview: Path, tmp_path: Path
) -> None:
    run(hausbench, overview, tmp_path)
    done = drawn(hausbench, tmp_path)
    assert done.returncode == 0, done.stderr
    for name, begin in (("overview.pdf", b"%PDF"), ("overview.png", b"\x89PNG")):
        assert (tmp_path / "figures" / name).read_bytes().startswith(begin)


def test_without_fields_there_is_no_picture(
    hausbench: Program, overview: Path, tmp_path: Path
) -> None:
    overview.write_text(overview.read_text().replace("fields = true", "fields = false"))
    run(hausbench, overview, tmp_path)
    done = drawn(hausbench, tmp_path)
    assert (
        done.returncode == 2
        and "make overview" in done.stderr
        and len(done.stderr.splitlines()) == 1
    )


def test_the_readme_shows_it() -> None:
    assert "(docs/overview.png)" in (ROOT / "README.md").read_text()
    assert (ROOT / "docs" / "overview.png").read_bytes().startswith(b"\x89PNG")
