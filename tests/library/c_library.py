"""Compiles and runs programs that use the C library."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
HEADER = ROOT / "library" / "hausbench.h"


def run(
    *command: str | Path, folder: Path | None = None, library: Path | None = None
) -> subprocess.CompletedProcess[str]:
    """Runs a command that finds the library, and returns what it printed."""
    environment = {**os.environ, "LD_LIBRARY_PATH": str(library.parent)} if library else None
    return subprocess.run(
        [*map(str, command)],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        timeout=120,
    )


def compiled(folder: Path, source: str, *options: str, compiler: str = "cc") -> Path:
    """Compiles a source text, without a warning, and returns the program."""
    file, program = (
        folder / ("program.c" if compiler == "cc" else "program.cpp"),
        folder / "program",
    )
    file.write_text(source)
    done = run(
        compiler,
        *options,
        "-Wall",
        "-Wextra",
        "-Werror",
        f"-I{ROOT / 'library'}",
        file,
        "-o",
        program,
    )
    assert done.returncode == 0, done.stderr
    return program


def path_of(program: str) -> str:
    path = shutil.which(program)
    if not path:
        pytest.skip(f"{program} is not installed")
    return path
