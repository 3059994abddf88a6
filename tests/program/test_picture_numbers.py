"""The numbers in `measure --picture`: the same on a busy machine, and under a limit nothing that is
not known.

HAUSBENCH_PICTURES=20 tries 20 pairs of up to 200,000 triangles or points; the default is two small
ones.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.collections import PathCollection, PolyCollection

from analysis import picture
from analysis.shared.columns import Floats

PICTURES: Final = int(os.environ.get("HAUSBENCH_PICTURES", "2"))
BUSY: Final = 4  # processes beside
LIMITS: Final = (0.001, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0)  # seconds


@dataclass(frozen=True)
class Drawn:
    """The numbers of a picture."""

    colours: Floats  # of the triangles or points of A
    scale: tuple[float, float]  # of the bar of colours
    ring: Floats  # where the farthest point is drawn
    low: Floats  # percent of A certainly in each bar
    high: Floats  # percent of A possibly in each bar
    edges: Floats
    statistics: dict[
        str, tuple[float, float]
    ]  # the mean and the quantile by the first word: a line (both ends equal), or a band
    frame: tuple[float, ...]  # ends of the axes of the histogram

    @property
    def has_histogram(self) -> bool:
        return len(self.edges) > 0


def numbers_of(figure: Any) -> Drawn:
    shape, *axes = figure.axes
    drawn = next(
        artist
        for artist in shape.collections
        if isinstance(artist, (PathCollection, PolyCollection))
    )
    ring = np.concatenate(
        [np.ravel(line.get_data()) for line in shape.lines if line.get_marker() == "o"][:1]
    )
    bar = next(ax for ax in axes if ax.get_label() == "<colorbar>")
    panel = next((ax for ax in axes if ax is not bar), None)
    empty = np.empty(0)
    if panel is None:
        return Drawn(
            np.array(drawn.get_facecolor()), bar.get_ylim(), ring, empty, empty, empty, {}, ()
        )
    sure, rest = panel.containers
    statistics = {
        str(line.get_label()).split()[0]: (float(line.get_xdata()[0]),) * 2 for line in panel.lines
    }
    for patch in panel.patches:
        if str(patch.get_label()).endswith("is in here"):
            x = patch.get_extents().transformed(panel.transData.inverted())
            statistics[str(patch.get_label()).removeprefix("the ").split()[0]] = (x.x0, x.x1)
    low = np.array([rectangle.get_height() for rectangle in sure])
    high = low + [rectangle.get_height() for rectangle in rest]
    edges = np.array([rectangle.get_x() + rectangle.get_width() for rectangle in sure])
    return Drawn(
        np.array(drawn.get_facecolor()),
        bar.get_ylim(),
        ring,
        low,
        high,
        edges,
        statistics,
        (*panel.get_xlim(), *panel.get_ylim()),
    )


def draw(program: str, a: Path, b: Path, out: Path, *more: str) -> Drawn | None:
    """Draws a picture in this process; returns None if there is no answer to draw."""
    plt.close("all")
    os.environ["HAUSBENCH_PROGRAM"] = program
    with warnings.catch_warnings():
        code = picture.main([str(a), str(b), f"--picture={out}", *more])
    assert code in (0, 1) and (code == 0) == bool(plt.get_fignums())
    return None if code else numbers_of(plt.gcf())


@contextmanager
def busy_machine() -> Iterator[None]:
    beside = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(BUSY)]
    try:
        yield
    finally:
        for process in beside:
            process.kill()
            process.wait()


def write(file: Path, corners: Floats, triangles: Any) -> Path:
    head = (
        f"ply\nformat binary_little_endian 1.0\nelement vertex {len(corners)}\nproperty double x\nproperty double y\nproperty double z\n"
        f"element face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    faces = np.zeros(len(triangles), dtype=[("count", "u1"), ("corners", "<i4", 3)])
    faces["count"], faces["corners"] = 3, triangles
    file.write_bytes(head.encode() + corners.astype("<f8").tobytes() + faces.tobytes())
    return file


def grid(n: int, wave: float) -> tuple[Floats, Any]:
    x, y = (axis.ravel() for axis in np.meshgrid(*2 * [np.linspace(0, 1, n)]))
    corner = np.arange(n * n).reshape(n, n)[:-1, :-1].ravel()
    return (
        np.stack([x, y, 0.2 * np.sin(wave * x) * np.cos(wave * y)], 1),
        np.concatenate(
            [
                np.stack([corner, corner + 1, corner + n], 1),
                np.stack([corner + 1, corner + n + 1, corner + n], 1),
            ]
        ),
    )


def ball(n: int, bumps: float) -> tuple[Floats, Any]:
    turn, down = np.meshgrid(
        np.linspace(0, 2 * np.pi, 2 * n, endpoint=False), np.linspace(0.1, np.pi - 0.1, n)
    )
    radius = 1 + 0.1 * np.cos(bumps * down) * np.sin(3 * turn)
    corners = np.stack(
        [
            radius * np.cos(turn) * np.sin(down),
            radius * np.sin(turn) * np.sin(down),
            radius * np.cos(down),
        ],
        -1,
    ).reshape(-1, 3)
    i, j = (axis.ravel() for axis in np.meshgrid(np.arange(2 * n), np.arange(n - 1)))
    a, b = 2 * n * j + i, 2 * n * j + (i + 1) % (2 * n)
    return corners, np.concatenate(
        [np.stack([a, a + 2 * n, b], 1), np.stack([b, a + 2 * n, b + 2 * n], 1)]
    )


def pair(k: int, folder: Path) -> tuple[Path, Path]:
    """Returns the k-th pair: two waves, two bumpy balls, a ball and a copy that almost touches it,
    or two clouds, ever larger."""
    n, random = (8, 20, 50, 110, 220)[k // 4 % 5], np.random.default_rng(k)
    if k % 4 == 3:
        clouds = [
            scale * points / np.linalg.norm(points, axis=1)[:, None]
            for scale in (1.0, 1.05)
            for points in [random.standard_normal((4 * n * n, 3))]
        ]
        files = folder / f"{k}a.xyz", folder / f"{k}b.xyz"
        for file, cloud in zip(files, clouds):
            np.savetxt(file, cloud, fmt="%.17g")
        return files
    if k % 4 == 2:
        corners, triangles = ball(n, 4)
        copy = corners + 1e-4 * random.standard_normal(corners.shape)
        return write(folder / f"{k}a.ply", corners, triangles), write(
            folder / f"{k}b.ply", copy, triangles
        )
    a, b = (grid(n, 5), grid(n + 1, 7)) if k % 4 == 0 else (ball(n, 4), ball(n // 2, 5))
    return write(folder / f"{k}a.ply", *a), write(folder / f"{k}b.ply", *b)


@pytest.mark.parametrize("k", range(PICTURES))
def test_load_changes_no_number(program_file: str, tmp_path: Path, k: int) -> None:
    a, b = pair(k, tmp_path)
    idle = draw(program_file, a, b, tmp_path / "idle.png")
    with busy_machine():
        busy = draw(program_file, a, b, tmp_path / "busy.png")
    assert (
        idle
        and busy
        and idle.has_histogram
        and idle.statistics == busy.statistics
        and idle.frame == busy.frame
        and idle.scale == busy.scale
    )
    for name in ("colours", "ring", "low", "high", "edges"):
        assert np.array_equal(getattr(idle, name), getattr(busy, name)), name


def certain(program: str, a: Path, b: Path, edges: Floats) -> dict[str, Any]:
    """Returns certified bounds of what a picture shows, from runs without a limit: the shares up to
    these edges, and the statistics."""
    wanted = ", ".join(["mean", "quantile 0.95", *(f"within {float(edge)!r}" for edge in edges)])
    words = [program, "measure", str(a), str(b), "--json"]
    words += [
        f"--statistics={wanted}",
        "--of=absolute",
        "--tolerance=1e-4",
        "--share-tolerance=0.005",
        "--budget=2000000",
    ]
    answer: dict[str, Any] = json.loads(
        subprocess.run(words, capture_output=True, text=True, check=True).stdout
    )["distribution"]
    return answer


@pytest.mark.parametrize("k", range(PICTURES))
def test_a_limit_draws_nothing_that_is_not_certain(
    program_file: str, tmp_path: Path, k: int, capfd: pytest.CaptureFixture[str]
) -> None:
    a, b = pair(k, tmp_path)
    free = draw(program_file, a, b, tmp_path / "free.png")
    assert free
    for limit in LIMITS[k % 3 :: 3]:
        limited = draw(program_file, a, b, tmp_path / "limited.png", f"--time-limit={limit}")
        said = capfd.readouterr().err
        if limited is None:
            continue
        assert limited.scale == free.scale
        if not limited.has_histogram:
            assert "without a histogram" in said
            continue
        truth, most = certain(program_file, a, b, limited.edges), 1 + 1e-9
        assert (
            (limited.low >= 0).all()
            and (limited.low <= limited.high).all()
            and (limited.high <= 100 * most).all()
            and limited.low.sum() <= 100 * most
        )
        assert limited.frame[0] == 0 and limited.frame[2] == 0 and limited.frame[3] <= 105
        shares = [
            truth["share_within"][length] for length in sorted(truth["share_within"], key=float)
        ]
        least = np.array([share["lower"] for share in shares])
        greatest = np.array([share["upper"] for share in shares])
        assert (limited.low <= 100 * (greatest - np.append(0, least[:-1])) + 1e-9).all()
        assert (limited.high >= 100 * (least - np.append(0, greatest[:-1])) - 1e-9).all()
        for name, bounds in (("mean", truth["mean"]), ("95", truth["quantiles"]["0.95"])):
            left, right = limited.statistics[name]
            assert 0 <= left <= right <= limited.edges[-1] / picture.END * most
            width = 0.5 * picture.LINE * limited.edges[-1] if left == right else 1e-9 * right
            assert left - width <= bounds["upper"] and right + width >= bounds["lower"]
