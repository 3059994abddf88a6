"""The examples compile and print what the program prints: with the installed library, too."""

from __future__ import annotations

import json
import random
import re
from pathlib import Path

import pytest

from c_library import ROOT, path_of, run

EXAMPLES = ROOT / "library" / "examples"
INTERVAL = re.compile(r"h\(A,B\) in \[(\S+), (\S+)\]")


def mesh(seed: int, triangles: int, file: Path, size: float = 1) -> Path:
    numbers = random.Random(seed)
    lines = ["OFF", f"{3 * triangles} {triangles} 0"]
    for _ in range(3 * triangles):
        lines.append(" ".join(repr(numbers.uniform(-size, size)) for _ in range(3)))
    lines += [f"3 {3 * i} {3 * i + 1} {3 * i + 2}" for i in range(triangles)]
    file.write_text("\n".join(lines) + "\n")
    return file


@pytest.fixture(scope="module", params=["c", "rust"])
def example(
    request: pytest.FixtureRequest, library: Path, tmp_path_factory: pytest.TempPathFactory
) -> Path:
    program = tmp_path_factory.mktemp("example") / "directed"
    if request.param == "c":
        done = run(
            "cc",
            "-std=c99",
            "-pedantic-errors",
            "-Wall",
            "-Wextra",
            "-Werror",
            f"-I{ROOT / 'library'}",
            EXAMPLES / "directed.c",
            "-o",
            program,
            f"-L{library.parent}",
            "-lhausbench",
        )
    else:
        done = run(
            path_of("rustc"),
            "-O",
            "-D",
            "warnings",
            EXAMPLES / "directed.rs",
            "-o",
            program,
            "-L",
            library.parent,
            "-l",
            "hausbench",
        )
    assert done.returncode == 0, done.stderr
    return program


def test_it_prints_the_bits_of_the_program(
    example: Path, library: Path, build: Path, tmp_path: Path
) -> None:
    for seed in range(8):
        a, b = mesh(seed, 9, tmp_path / "a.off"), mesh(
            100 + seed, 20, tmp_path / "b.off", 1 + 50 * (seed % 2)
        )
        done = run(example, a, b, library=library)
        assert done.returncode == 0, done.stderr
        bounds = INTERVAL.search(done.stdout)
        assert bounds
        measured = json.loads(run(build / "hausbench", "measure", "--json", a, b).stdout)
        assert [float(bounds[1]), float(bounds[2])] == [measured["lower"], measured["upper"]]


def test_it_names_what_is_wrong(example: Path, library: Path, tmp_path: Path) -> None:
    (tmp_path / "bad.off").write_text("OFF\n3 1 0\n0 0 0\n1 0 0\n0 nan 0\n3 0 1 2\n")
    done = run(example, tmp_path / "bad.off", tmp_path / "none.off", library=library)
    assert done.returncode == 2
    assert "bad.off" in done.stderr and len(done.stderr.splitlines()) == 1
