"""Decides which HDF5 files may be opened, and which tables and figures beside them.

A file can make the HDF5 library read other files, wait at a pipe, take all memory or crash. So the
program, which guards against all of these, looks at a file first (`hausbench vet`); no other code
of analysis/ opens a file that problem_of() refuses. Files in results/reference need no program:
their SHA-256 is in the list SUMS, which `make reference-sums` writes.

Assumes that nobody changes a file while it is being read.
"""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Final

from analysis.shared.printable import printable
from analysis.shared.results import ResultError

ROOT: Final = Path(__file__).resolve().parents[2]
REFERENCE: Final = ROOT / "results" / "reference"
SUMS: Final = "SHA256SUMS"  # as sha256sum writes it

MOST_BYTES: Final = 64_000_000  # of a table or figure

State = tuple[str, int, int, int, int]
_known: dict[State, str] = {}  # the answers of problem_of()


def program() -> str:
    """Returns the path of the program: HAUSBENCH_PROGRAM if it is set, or the one of this checkout
    or installation, or the one on PATH."""
    if named := os.environ.get("HAUSBENCH_PROGRAM"):
        return named
    for path in (ROOT / "build" / "release" / "hausbench", ROOT.parents[1] / "bin" / "hausbench"):
        if path.is_file():
            return str(path)
    if on_path := shutil.which("hausbench"):
        return on_path
    raise ResultError(
        "HDF5 files are opened only after the program 'hausbench' has checked them, and it was not found: build it with 'make build', or "
        "name it with HAUSBENCH_PROGRAM"
    )


def ask(verb: str, paths: Sequence[Path]) -> list[str]:
    """Calls a hidden verb of the program on files, and returns its line about each."""
    command = [program(), verb, "--", *(os.path.abspath(path) for path in paths)]
    try:
        done = subprocess.run(command, capture_output=True, text=True, errors="replace")
    except OSError as problem:
        raise ResultError(
            f"{command[0]}: cannot be run: {problem.strerror}: build it with 'make build'"
        ) from None
    lines = done.stdout.split("\n")[:-1]
    if done.returncode != 0 or len(lines) != len(paths):
        raise ResultError(
            f"{command[0]}: '{verb}' failed: {done.stderr.strip() or 'it is another version'}: build it with 'make build'"
        )
    return lines


def vet(paths: Iterable[Path]) -> None:
    """Checks many files with one call of the program, so that problem_of() answers at once."""
    new = {
        state: path for path in paths if path.is_file() and (state := _state(path)) not in _known
    }
    kept = {state: path for state, path in new.items() if path.resolve().is_relative_to(REFERENCE)}
    for state, path in kept.items():
        _known[state] = _problem_of_kept(path.resolve())
    others = [(state, path) for state, path in new.items() if state not in kept]
    for start in range(0, len(others), 500):
        part = others[start : start + 500]
        problems = ask("vet", [path for _, path in part])
        _known.update(zip((state for state, _ in part), problems))


def problem_of(path: Path) -> str:
    """Returns why a file must not be opened with h5py, on one line; an empty string if it may. A
    changed file is checked again."""
    if not path.is_file():
        return "is not a regular file" if path.exists() else "does not exist"
    vet([path])
    return _known.get(_state(path), "was changed while it was checked")


def is_plain(path: Path) -> bool:
    """Returns whether a table or figure beside results is there and may be read. Names one that is
    a link, no regular file, or larger than MOST_BYTES on standard error.
    """
    if not path.exists() and not path.is_symlink():
        return False
    why = (
        "is a link"
        if path.is_symlink()
        else "is not a regular file"
        if not path.is_file()
        else f"has more than {MOST_BYTES // 1_000_000} MB"
        if path.stat().st_size > MOST_BYTES
        else ""
    )
    if why:
        print(f"{printable(str(path))}: {why}, and is left out", file=sys.stderr)
    return not why


def _state(path: Path) -> State:
    now = path.stat()
    return os.path.abspath(path), now.st_ino, now.st_size, now.st_mtime_ns, now.st_ctime_ns


def _problem_of_kept(path: Path) -> str:
    sums = read_sums()
    name = path.relative_to(REFERENCE).as_posix()
    if name not in sums:
        return f"is not listed in results/reference/{SUMS}, which 'make reference-sums' writes"
    return (
        ""
        if sha256(path) == sums[name]
        else f"has another SHA-256 than results/reference/{SUMS} says"
    )


def read_sums() -> dict[str, str]:
    """Returns the SHA-256 of each file in results/reference, by its path there."""
    lines = (REFERENCE / SUMS).read_text(encoding="utf-8").splitlines()
    pairs = [line.split("  ", 1) for line in lines]
    return {name: digest for digest, name in pairs}


def sha256(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
