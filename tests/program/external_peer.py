"""An external solver for tests: slow, and right only if a vertex of A is farthest from B.

    external_peer.py A B TOLERANCE [deed]

Prints `lower`, the largest distance from a vertex of A to B, and `upper`, from the best triangle of
B for each triangle of A. A `deed` is a way to misbehave.
"""

from __future__ import annotations

import os
import sys
import time
from pathlib import Path

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]


def read(path: Path) -> tuple[Floats, npt.NDArray[np.int64]]:
    """Returns vertices and triangles. A point becomes a triangle with three equal corners."""
    lines = path.read_text().splitlines()
    if path.suffix == ".obj":
        points = [line.split()[1:] for line in lines if line.startswith("v ")]
        rows = [line for line in lines if line.startswith("f ")]
        first = 1  # OBJ counts vertices from 1
    else:
        assert lines[0] == "OFF"
        n, m, _ = map(int, lines[1].split())
        points = [line.split() for line in lines[2 : 2 + n]]
        rows = lines[2 + n : 2 + n + m]
        first = 0
    faces = []
    for row in rows:
        faces.append([int(corner) - first for corner in row.split()[1:]])
    vertices = np.array(points, dtype=np.float64)
    return vertices, np.array(faces or [[i, i, i] for i in range(len(vertices))], dtype=np.int64)


def to_segments(p: Floats, a: Floats, b: Floats) -> Floats:
    along = b - a
    square = np.einsum("ij,ij->i", along, along)
    t = np.einsum("ij,ij->i", p - a, along) / np.where(square > 0, square, 1)
    return np.asarray(np.linalg.norm(p - (a + np.clip(t, 0, 1)[:, None] * along), axis=1))


def to_triangles(p: Floats, corners: Floats) -> Floats:
    """Returns the distances from a point to the triangles, an m x 3 x 3 array."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    best = np.minimum(to_segments(p, a, b), np.minimum(to_segments(p, b, c), to_segments(p, c, a)))
    normal = np.cross(b - a, c - a)
    length = np.linalg.norm(normal, axis=1)
    unit = normal / np.where(length > 0, length, 1)[:, None]
    height = np.einsum("ij,ij->i", p - a, unit)
    foot = p - height[:, None] * unit
    inside = length > 0
    for start, end in ((a, b), (b, c), (c, a)):
        inside &= np.einsum("ij,ij->i", np.cross(end - start, foot - start), unit) >= 0
    return np.where(inside, np.abs(height), best)


def main() -> int:
    start = time.perf_counter()
    deed = sys.argv[4] if len(sys.argv) > 4 else ""
    if deed in ("hang", "eat"):
        Path(sys.argv[5]).write_text(str(os.getpid()))
    if deed == "hang":
        time.sleep(600)
    if deed == "fail":
        print("the queue ran empty", file=sys.stderr)
        return 3
    if deed == "eat":
        eaten = np.ones(10**9, dtype=np.uint8)
        time.sleep(600 * float(eaten[0]))
    if deed == "echo":
        print("arguments", *sys.argv[1:4])
    a, faces = read(Path(sys.argv[1]))
    b, target = read(Path(sys.argv[2]))
    distance = np.array([to_triangles(p, b[target]) for p in a])
    lower, upper = distance.min(axis=1).max(), distance[faces].max(axis=1).min(axis=1).max()
    if deed == "lie":
        upper = 0.5 * lower
    print("h = 1e9 (first guess)\nprogress 50 %")
    print(f"h = {lower:.17g}\nat most {upper:.17g}")
    print(f"mean of vertices {distance.min(axis=1).mean():.17g}")
    print(f"took {1e3 * (time.perf_counter() - start):.6f} ms")
    return 0


if __name__ == "__main__":
    sys.exit(main())
