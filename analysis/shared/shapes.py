"""The shapes behind the rows, for pictures and counts. Result files hold no coordinates; the harness keeps each shape that it has loaded
or made in its cache, as an HDF5 file with the SHA-256 that /models of the result has too.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path

import h5py
import numpy as np
import numpy.typing as npt

from analysis.shared import remedy
from analysis.shared.columns import Floats
from analysis.shared.results import ResultError, Results

ROOT = Path(__file__).resolve().parents[2]
Indices = npt.NDArray[np.int64]


@dataclass(frozen=True)
class Mesh:
    corners: Floats
    triangles: Indices  # in the order in which the fields of a result are

    @cached_property
    def _edge_uses(self) -> Indices:
        """For each edge that joins two places, the number of triangles that use it. Corners at one place are one corner."""
        _, place = np.unique(self.corners + 0.0, axis=0, return_inverse=True)
        sides = np.sort(place.reshape(-1)[self.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)], axis=1)
        return np.asarray(np.unique(sides[sides[:, 0] != sides[:, 1]], axis=0, return_counts=True)[1], dtype=np.int64)

    @property
    def closed(self) -> bool:
        """No edge is used once."""
        return bool((self._edge_uses > 1).all())

    @property
    def manifold(self) -> bool:
        """No edge is used more than twice. Vertices at which two fans of triangles meet are not looked for."""
        return bool((self._edge_uses < 3).all())


def cache_folder() -> Path:
    """As datasets/paths.cpp finds it from within a checkout."""
    return Path(os.environ.get("HAUSBENCH_CACHE") or Path(os.environ.get("HAUSBENCH_ROOT", ROOT)) / "datasets" / "cache")


@cache
def _files(folder: Path) -> dict[str, Path]:
    """Returns shape files by the SHA-256 of their shape; their names tell how they were made. Files of other versions are skipped."""
    found = {}
    for path in folder.glob("*.h5"):
        with h5py.File(path, "r") as file:
            if file.attrs.get("shape_schema") == 1:
                found[str(file.attrs["content_hash"])] = path
    return found


def _arrays(results: Results, model: str) -> tuple[Floats, Indices]:
    """Returns coordinates and triangles, the latter empty if the model is a point set. Raises ResultError if the cache does not have them."""
    hashes = dict(zip(results.models.name, results.models.sha256))
    path = _files(cache_folder() / "shapes").get(hashes.get(model, ""))
    if path is None or not path.exists():
        raise ResultError(f"model '{model}' cannot be drawn: its shape is not in {cache_folder()}: run its experiment again "
                          f"with {remedy.measure(results.stem, str(results.meta.get('experiment_file', '')))}")
    with h5py.File(path, "r") as file:
        triangles = file["triangles"][()] if "triangles" in file else np.empty((0, 3))
        return np.asarray(file["coordinates"][()], dtype=np.float64), np.asarray(triangles, dtype=np.int64)


def mesh(results: Results, model: str) -> Mesh:
    """A model of the result file, in the unit of the model."""
    return Mesh(*_arrays(results, model))


@dataclass(frozen=True)
class Drawn(Mesh):
    """A posed, cut finely enough to show how far each place of it is from B."""

    elements: Indices  # for each triangle here, the triangle of A that it is part of
    distances: Floats  # from each corner to B, A's own vertices first

    @property
    def colours(self) -> Floats:
        """One distance for each triangle, the mean of its corners."""
        return np.asarray(self.distances[self.triangles].mean(axis=1))


def drawn(results: Results, case: int) -> Drawn:
    """The fields of a case, which must have `distance`. In files of older programs A is not cut."""
    fields = results.fields_of(case)
    if {"x", "y", "z", "a", "b", "c", "element"} <= fields.keys():
        corners, triangles = (np.column_stack([fields[name] for name in names]) for names in ("xyz", "abc"))
        return Drawn(corners, triangles.astype(np.int64), fields["element"].astype(np.int64), fields["distance"])
    whole = mesh(results, results.cases.source[case])
    return Drawn(posed(whole.corners, results.cases.pose[case]), whole.triangles, np.arange(len(whole.triangles)), fields["distance"])


def points(results: Results, model: str) -> Floats | None:
    """n x 3, likewise; None where the cache does not have them."""
    try:
        return _arrays(results, model)[0]
    except ResultError:
        return None


def posed(points: Floats, pose: Floats) -> Floats:
    """Moves points by a pose as stored in result files: the rotation row by row, then the translation."""
    moved: Floats = points @ pose[:9].reshape(3, 3).T + pose[9:]
    return moved
