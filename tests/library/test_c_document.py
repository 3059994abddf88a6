"""The blocks of docs/c.md run as written, with an installed hausbench, and print what their
comments say."""

from __future__ import annotations

import os
import re
import subprocess
from pathlib import Path

import pytest

from c_document import PAGE, Block, blocks, write
from c_library import path_of

BLOCKS = blocks(PAGE.read_text(encoding="utf-8"))
INSTALL, BUILD = (
    "cmake --install build/release",
    "cmake -S . -B build/library",
)  # the second takes minutes, and is not run
RUN = [
    block for block in BLOCKS if block.commands and not block.commands.startswith((INSTALL, BUILD))
]
OPTIONAL = ("cargo", "pkg-config", "rustc")


def wrong(files: dict[str, str], commands: str, prefix: Path, folder: Path) -> str:
    """Runs commands in a folder with these files, in a home where hausbench is installed. Returns
    their errors, or what they print if it is not what the comment after the last command says."""
    write(files, folder)
    (folder / "hausbench").symlink_to(prefix)
    # Rust and its packages stay where they are.
    rust = {
        name: os.environ.get(name, str(Path.home() / place))
        for name, place in (("RUSTUP_HOME", ".rustup"), ("CARGO_HOME", ".cargo"))
    }
    done = subprocess.run(
        ["bash", "-euc", commands],
        cwd=folder,
        env={**os.environ, **rust, "HOME": str(folder)},
        capture_output=True,
        text=True,
        check=False,
    )
    expected = commands.rsplit(" # ", 1)[1].split()
    if done.returncode != 0:
        return done.stdout + done.stderr
    return "" if done.stdout.split()[-len(expected) :] == expected else done.stdout


@pytest.mark.parametrize(
    "block", RUN, ids=lambda block: f"{block.section}: {block.commands.split(' ')[0]}"
)
def test_the_block_runs(block: Block, prefix: Path, tmp_path: Path) -> None:
    for program in OPTIONAL:
        if re.search(rf"\b{program} ", block.commands):
            path_of(program)
    assert wrong(block.files, block.commands, prefix, tmp_path) == ""


def test_the_first_block_installs(build: Path, tmp_path: Path) -> None:
    commands = next(block.commands for block in BLOCKS if block.commands.startswith(INSTALL))
    (tmp_path / "build").mkdir()
    (tmp_path / "build" / "release").symlink_to(build)
    done = subprocess.run(
        ["bash", "-euc", commands],
        cwd=tmp_path,
        env={**os.environ, "HOME": str(tmp_path)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "hausbench" / "include" / "hausbench.hpp").exists()


def test_all_other_blocks_are_known() -> None:
    """A new block runs above, or is the project that test_cmake_package.py configures."""
    others = [block for block in BLOCKS if block not in RUN]
    assert len(RUN) >= 5 and len(others) == 3
    assert (
        others[0].commands.startswith(INSTALL)
        and others[1].section == "The CMake package"
        and others[2].commands.startswith(BUILD)
    )


def test_a_wrong_comment_and_a_wrong_command_are_found(prefix: Path, tmp_path: Path) -> None:
    assert wrong({"a.txt": "one\n"}, "cat a.txt   # two\n", prefix, tmp_path) == "one\n"
    (tmp_path / "hausbench").unlink()
    assert "b.txt" in wrong({}, "cat b.txt   # one\n", prefix, tmp_path)
