"""Finds the package: in the folder HAUSBENCH_PYTHON, else where `pip install` or PYTHONPATH has it,
else in the build folder."""

from __future__ import annotations

import importlib.util
import os
import sys
from pathlib import Path

import numpy as np
import pytest
from sample_meshes import Mesh, sphere

ROOT = Path(__file__).resolve().parents[2]


def find_package() -> None:
    named = os.environ.get("HAUSBENCH_PYTHON")
    built = Path(named) if named else ROOT / "build" / "release" / "python"
    if named is None and importlib.util.find_spec("hausbench") is not None:
        return
    if not list((built / "hausbench").glob("_core*.so")):
        pytest.exit(
            f"{built} has no package hausbench: run `make python`, or set HAUSBENCH_PYTHON to its parent folder",
            2,
        )
    sys.path.insert(0, str(built))
    # For children of the tests.
    os.environ["PYTHONPATH"] = os.pathsep.join(
        filter(None, [str(built), os.environ.get("PYTHONPATH", "")])
    )


find_package()
os.environ.setdefault(
    "HAUSBENCH_PROGRAM", str(ROOT / "build" / "release" / "hausbench")
)  # which checks results before they are opened


@pytest.fixture
def tetrahedron() -> Mesh:
    return (
        np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float),
        np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]),
    )


@pytest.fixture
def cube() -> Mesh:
    vertices = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
    return vertices, np.array(
        [
            [0, 1, 3],
            [0, 3, 2],
            [4, 6, 7],
            [4, 7, 5],
            [0, 4, 5],
            [0, 5, 1],
            [2, 3, 7],
            [2, 7, 6],
            [0, 2, 6],
            [0, 6, 4],
            [1, 5, 7],
            [1, 7, 3],
        ]
    )


@pytest.fixture
def small_sphere() -> Mesh:
    return sphere(12, 0.1)


@pytest.fixture
def sphere_file(tmp_path: Path, small_sphere: Mesh) -> Path:
    vertices, faces = small_sphere
    path = tmp_path / "sphere.off"
    lines = ["OFF", f"{len(vertices)} {len(faces)} 0"]
    lines += [" ".join(map(repr, map(float, row))) for row in vertices]
    lines += ["3 " + " ".join(map(str, row)) for row in faces]
    path.write_text("\n".join(lines) + "\n")
    return path
