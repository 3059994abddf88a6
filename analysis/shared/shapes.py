"""Loads the shapes that a result was measured on, for pictures and counts.

Result files hold no coordinates, but the SHA-256 of each shape (/models), by which it is found in
the harness's cache.
"""

from __future__ import annotations

import os
import sys
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path

import h5py
import numpy as np
import numpy.typing as npt

from analysis.shared import gate, remedy
from analysis.shared.columns import Floats
from analysis.shared.printable import printable
from analysis.shared.results import ResultError, Results

ROOT = Path(__file__).resolve().parents[2]
Indices = npt.NDArray[np.int64]


@dataclass(frozen=True)
class Mesh:
    corners: Floats
    triangles: Indices  # in the order of the fields of a result

    @cached_property
    def _edge_uses(self) -> Indices:
        """The number of triangles at each edge. Corners with equal coordinates count as one; edges
        of length 0 are left out."""
        _, place = np.unique(self.corners + 0.0, axis=0, return_inverse=True)
        sides = np.sort(
            place.reshape(-1)[self.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)], axis=1
        )
        return np.asarray(
            np.unique(sides[sides[:, 0] != sides[:, 1]], axis=0, return_counts=True)[1],
            dtype=np.int64,
        )

    @property
    def closed(self) -> bool:
        """True if every edge belongs to at least two triangles."""
        return bool((self._edge_uses > 1).all())

    @property
    def manifold(self) -> bool:
        """True if no edge belongs to more than two triangles. Does not detect vertices at which two
        fans of triangles meet."""
        return bool((self._edge_uses < 3).all())


def cache_folder() -> Path:
    """Returns the cache folder of this checkout, by the same rules as datasets/paths.cpp."""
    return Path(
        os.environ.get("HAUSBENCH_CACHE")
        or Path(os.environ.get("HAUSBENCH_ROOT", ROOT)) / "datasets" / "cache"
    )


@cache
def _files(folder: Path) -> dict[str, list[Path]]:
    """Returns the files of cached shapes by the SHA-256 of the shape, which the file names do not
    contain.

    The program reads them. Skips files of other kinds, and files that it cannot read, which it
    names on standard error.
    """
    paths, files = sorted(folder.glob("*.h5")), dict[str, list[Path]]()
    for path, content in zip(paths, gate.ask("shapes", paths) if paths else ()):
        if " " in content:
            print(
                printable(f"{path}: left out: {content}: delete it, and it is made again"),
                file=sys.stderr,
            )
        elif content:
            files.setdefault(content, []).append(path)
    return files


def _read(path: Path) -> tuple[Floats, Indices]:
    """Returns the coordinates and triangles of a shape file. Raises ResultError if it cannot be
    used."""
    if problem := gate.problem_of(path):
        raise ResultError(f"{path}: left out: {problem}: delete it, and it is made again")
    try:
        with h5py.File(path, "r") as file:
            triangles = (
                file["triangles"][()] if "triangles" in file else np.empty((0, 3), dtype=np.int64)
            )
            corners, triangles = np.asarray(file["coordinates"][()], dtype=np.float64), np.asarray(
                triangles, dtype=np.int64
            )
        if (
            corners.shape[1:] != (3,)
            or triangles.shape[1:] != (3,)
            or not ((triangles >= 0) & (triangles < len(corners))).all()
        ):
            raise ValueError("its triangles name corners that it does not have")
    except (LookupError, OSError, TypeError, ValueError) as error:
        raise ResultError(f"{path}: left out: {error}: delete it, and it is made again") from None
    return corners, triangles


def _arrays(results: Results, model: str) -> tuple[Floats, Indices]:
    """Returns coordinates and triangles (none if the model is not a mesh). Raises ResultError if
    they are not in the cache.

    Names a file that cannot be used on standard error.
    """
    hashes = dict(zip(results.models.name, results.models.sha256))
    for path in _files(cache_folder() / "shapes").get(hashes.get(model, ""), ()):
        try:
            return _read(path)
        except ResultError as problem:
            print(printable(str(problem)), file=sys.stderr)
    raise ResultError(
        f"model '{model}' cannot be drawn: its shape is not in {cache_folder()}: run its experiment again "
        f"with {remedy.measure(results.stem, str(results.meta.get('experiment_file', '')))}"
    )


def mesh(results: Results, model: str) -> Mesh:
    """Loads a mesh by its name in the result file, before any pose is applied."""
    return Mesh(*_arrays(results, model))


@dataclass(frozen=True)
class Coloured(Mesh):
    """A subdivided finely enough to colour it by the distance to B; a point set has no
    triangles."""

    distances: Floats  # distance of each corner to B; A's own vertices come first

    @property
    def colours(self) -> Floats:
        """One distance per triangle, the mean over its corners."""
        return np.asarray(self.distances[self.triangles].mean(axis=1))


@dataclass(frozen=True)
class Drawn(Coloured):
    """A in its pose."""

    elements: Indices  # for each triangle here, the triangle of A that contains it


def drawn(results: Results, case: int) -> Drawn:
    """Returns A coloured by the field `distance`, which the case must have. Files of older programs
    lack the subdivision."""
    fields = results.fields_of(case)
    if {"x", "y", "z", "a", "b", "c", "element"} <= fields.keys():
        corners = np.column_stack([fields[name] for name in "xyz"])
        triangles = np.column_stack([fields[name] for name in "abc"])
        return Drawn(
            corners,
            triangles.astype(np.int64),
            fields["distance"],
            fields["element"].astype(np.int64),
        )
    whole = mesh(results, results.cases.source[case])
    return Drawn(
        posed(whole.corners, results.cases.pose[case]),
        whole.triangles,
        fields["distance"],
        np.arange(len(whole.triangles)),
    )


def points(results: Results, model: str) -> Floats | None:
    """Returns the coordinates of a model (n x 3), before any pose is applied; None if they are not
    in the cache."""
    try:
        return _arrays(results, model)[0]
    except ResultError:
        return None


def posed(points: Floats, pose: Floats) -> Floats:
    """Applies a pose as stored in result files: 9 numbers of the rotation, row by row, then the
    translation."""
    moved: Floats = points @ pose[:9].reshape(3, 3).T + pose[9:]
    return moved
