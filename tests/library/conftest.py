"""The built C library."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="session")
def build() -> Path:
    return Path(
        os.environ.get("HAUSBENCH_PROGRAM", ROOT / "build" / "release" / "hausbench")
    ).parent


@pytest.fixture(scope="session")
def library(build: Path) -> Path:
    file = build / "library" / "libhausbench.so"
    if not file.exists():
        pytest.fail(f"{file} is not built: run `make build`")
    return file
