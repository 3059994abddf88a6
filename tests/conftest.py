"""Skips tests whose optional tool is missing: with `--insist`, used by targets that promise the
tool, such a skip is a failure. And the installed files."""

from __future__ import annotations

import fcntl
import os
import subprocess
from collections.abc import Generator
from pathlib import Path
from typing import Any

import pytest

os.environ.pop("COLUMNS", None)  # pytest-xdist sets it; programs would fold their texts


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--insist", action="store_true", help="a test that is skipped has failed")


def fail_skipped(item: pytest.Item) -> Generator[None, Any, None]:
    report = (yield).get_result()
    if item.config.getoption("insist") and report.skipped:
        report.outcome = "failed"
        report.longrepr = f"{item.nodeid}: {report.longrepr[2] if isinstance(report.longrepr, tuple) else report.longrepr}"


# Not a decorator, because decorators of pytest 7 have no types.
pytest_runtest_makereport = pytest.hookimpl(hookwrapper=True)(fail_skipped)


@pytest.fixture(scope="session")
def prefix(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Returns the folder that `cmake --install` fills, once for all workers of a parallel run."""
    build = Path(
        os.environ.get(
            "HAUSBENCH_PROGRAM",
            Path(__file__).resolve().parents[1] / "build" / "release" / "hausbench",
        )
    ).parent
    shared = tmp_path_factory.getbasetemp()
    if "PYTEST_XDIST_WORKER" in os.environ:
        shared = shared.parent
    with open(shared / "installed.lock", "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not (shared / "installed.done").exists():
            done = subprocess.run(
                ["cmake", "--install", build, "--prefix", shared / "installed"],
                capture_output=True,
                text=True,
                check=False,
            )
            assert done.returncode == 0, done.stdout + done.stderr
            (shared / "installed.done").touch()
    return shared / "installed"
