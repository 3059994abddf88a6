"""Result files: written whole on a full disk, read without trust, verified, merged and compared."""

from __future__ import annotations

import os
import resource
import shutil
import subprocess
from pathlib import Path

import h5py
import numpy as np
import pytest

from conftest import ROOT, Program
from test_run import numbers, run, same_answers, slow, texts  # noqa: F401  (slow is a fixture)

SMOKE = ROOT / "experiments" / "smoke.toml"


def with_small_files(hausbench: Program, largest: int, *arguments: str | Path, **more: str) -> str:
    """The one line that a run gets whose files may not grow beyond so many bytes: as on a full disk."""
    done = subprocess.run(
        hausbench.command(*arguments), cwd=hausbench.folder, env={**hausbench.environment(), **more}, capture_output=True, text=True,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (largest, largest)), timeout=120,
    )
    assert done.returncode == 2, (largest, done.returncode, done.stderr)
    assert len(done.stderr.strip().splitlines()) == 1, done.stderr
    return done.stderr


def test_disk_full_while_the_result_is_written(hausbench: Program, experiment: Path, tmp_path: Path) -> None:
    whole = run(hausbench, experiment, tmp_path / "whole")
    size, journal = whole.stat().st_size, whole.with_suffix(".journal").stat().st_size
    assert 2 * journal < size
    for largest in (2 * journal, size // 2, size - 1):
        folder = tmp_path / f"full-{largest}"
        line = with_small_files(hausbench, largest, "run", experiment, "--results", folder, "--quiet")
        assert "cannot write the result" in line and "make room" in line
        assert [file.name for file in folder.iterdir()] == ["tiny.journal"]
        same_answers(run(hausbench, experiment, folder), whole)
    line = with_small_files(hausbench, size // 2, "merge", tmp_path / "merged.h5", whole, whole)
    assert "merged.h5" in line and "make room" in line
    assert not list(tmp_path.glob("merged.h5*"))


def test_disk_full_while_a_shape_is_written(hausbench: Program, experiment: Path, tetrahedron: Path, tmp_path: Path) -> None:
    cache = tmp_path / "cache"
    experiment.write_text(experiment.read_text().replace("sphere2", "sphere5"))
    environment = {**hausbench.environment(), "HAUSBENCH_CACHE": str(cache)}
    for largest, status in ((200_000, "failed"), (resource.RLIM_INFINITY, "ok")):  # room for the result, but not for the shape
        done = subprocess.run(
            hausbench.command("run", experiment, "--results", tmp_path, "--quiet"), env=environment, capture_output=True, text=True,
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (largest, largest)), timeout=120,
        )
        assert done.returncode == 0, done.stderr
        assert texts(tmp_path / "tiny.h5", "cases/status") == [status]
        reason = texts(tmp_path / "tiny.h5", "cases/reason")[0]
        assert ("make room" in reason and "HAUSBENCH_CACHE" in reason) == (status == "failed")
    line = with_small_files(hausbench, 500, "measure", tetrahedron, tetrahedron)
    assert "make room" in line and "TMPDIR" in line and "damaged" not in line
