"""Python gives the bits of the program. HAUSBENCH_PAIRS says for how many random pairs (default:
100)."""

from __future__ import annotations

import csv
import os
import subprocess
from pathlib import Path

import hausbench as hb
import numpy as np
import numpy.typing as npt
import pytest
from sample_meshes import Mesh

ROOT = Path(__file__).resolve().parents[2]
COUNT = int(os.environ.get("HAUSBENCH_PAIRS", "100"))

Floats = npt.NDArray[np.float64]


@pytest.fixture(scope="module")
def program() -> str:
    path = os.environ.get("HAUSBENCH_PROGRAM", str(ROOT / "build" / "release" / "hausbench"))
    if not Path(path).exists():
        pytest.skip(f"{path} is not built: run `make build`, or set HAUSBENCH_PROGRAM")
    return path


def random_shape(random: np.random.Generator) -> Floats | Mesh:
    """Returns points, or triangles that use all vertices, of any size from 1e-3 to 1e3."""
    vertices = random.normal(size=(int(random.integers(3, 40)), 3)) * 10.0 ** random.integers(-3, 4)
    if random.random() < 0.25:
        return vertices
    order = np.concatenate(
        [
            random.permutation(len(vertices)),
            random.integers(0, len(vertices), -len(vertices) % 3 + 30),
        ]
    )
    return vertices, order.reshape(-1, 3)


def write(shape: Floats | Mesh, path: Path) -> Path:
    vertices, faces = shape if isinstance(shape, tuple) else (shape, np.empty((0, 3), int))
    points = [" ".join(map(repr, map(float, row))) for row in vertices]
    triangles = ["3 " + " ".join(map(str, row)) for row in faces]
    head = ["OFF", f"{len(points)} {len(triangles)} 0"] if triangles else []
    path = path.with_suffix(".off" if triangles else ".xyz")
    path.write_text("\n".join([*head, *points, *triangles]) + "\n")
    return path


@pytest.mark.parametrize("symmetric", [False, True])
def test_the_bits_of_the_program(program: str, symmetric: bool, tmp_path: Path) -> None:
    random = np.random.default_rng(45 + symmetric)
    pairs = [(random_shape(random), random_shape(random)) for _ in range(COUNT)]
    files = [
        (write(a, tmp_path / f"a{k}"), write(b, tmp_path / f"b{k}"))
        for k, (a, b) in enumerate(pairs)
    ]
    listed = tmp_path / "pairs.txt"
    listed.write_text("".join(f"{a}, {b}\n" for a, b in files))
    done = subprocess.run(
        [program, "measure", "--pairs", str(listed), *(["--symmetric"] if symmetric else [])],
        capture_output=True,
        text=True,
        timeout=600,
        env={**os.environ, "HAUSBENCH_ROOT": str(ROOT)},
    )
    rows = list(csv.DictReader(done.stdout.splitlines()))
    assert len(rows) == COUNT, done.stderr
    ask = hb.symmetric if symmetric else hb.directed
    differ = []
    for row, pair, paths in zip(rows, pairs, files):
        said = hb.Interval(float(row["lower"]), float(row["upper"]))
        for a, b in (pair, paths):
            if (answer := ask(a, b).interval) != said:
                differ.append((row["A"], row["B"], said, answer))
    assert differ == []
