"""Meshes that the tests of the package share."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

Mesh = tuple[npt.NDArray[np.float64], npt.NDArray[np.int64]]


def sphere(n: int, bumps: float = 0.0) -> Mesh:
    """Returns a sphere of n rings with 2 n corners each, whose radius waves by `bumps`."""
    theta, phi = np.meshgrid(
        np.linspace(0.1, np.pi - 0.1, n),
        np.linspace(0, 2 * np.pi, 2 * n, endpoint=False),
        indexing="ij",
    )
    radius = 1 + bumps * np.sin(9 * theta) * np.cos(7 * phi)
    vertices = np.stack(
        [
            radius * np.sin(theta) * np.cos(phi),
            radius * np.sin(theta) * np.sin(phi),
            radius * np.cos(theta),
        ],
        -1,
    )
    i, j = np.meshgrid(np.arange(n - 1), np.arange(2 * n), indexing="ij")
    a, b = i * 2 * n + j, i * 2 * n + (j + 1) % (2 * n)
    faces = np.concatenate(
        [
            np.stack([a, b, a + 2 * n], -1).reshape(-1, 3),
            np.stack([b, b + 2 * n, a + 2 * n], -1).reshape(-1, 3),
        ]
    )
    return vertices.reshape(-1, 3), faces
