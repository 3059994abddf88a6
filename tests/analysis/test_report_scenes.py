"""Meshes for display keep true corners and values, and the view gets complete scenes."""

from __future__ import annotations

import base64
from pathlib import Path

import numpy as np
import pytest

from analysis.report import display, scenes
from analysis.shared.load import load
from analysis.shared.shapes import Mesh
from synthetic import ResultFile


def sheet(n: int) -> Mesh:
    """A square of 2 n^2 triangles."""
    x, y = np.meshgrid(np.arange(n + 1.0), np.arange(n + 1.0))
    at = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
    a, b, c, d = (part.ravel() for part in (at[:-1, :-1], at[:-1, 1:], at[1:, :-1], at[1:, 1:]))
    return Mesh(
        np.column_stack([x.ravel(), y.ravel(), 0 * x.ravel()]),
        np.concatenate([np.column_stack([a, b, c]), np.column_stack([d, c, b])]),
    )


def test_a_small_mesh_stays_as_it_is() -> None:
    mesh = sheet(3)
    shown = display.simplify(mesh, most=18)
    assert (
        not shown.simplified
        and (shown.triangles == mesh.triangles).all()
        and (shown.corners == np.arange(16)).all()
    )


def test_a_large_mesh_becomes_small_and_keeps_the_farthest_corner() -> None:
    mesh, weights = sheet(60), np.zeros(61 * 61)
    weights[1234] = 1.0
    shown = display.simplify(mesh, weights, most=500)
    assert shown.simplified and 100 < len(shown.triangles) <= 500 and 1234 in shown.corners
    assert len(shown.elements) == len(shown.triangles) and shown.triangles.max() < len(
        shown.corners
    )
    across = np.sort(shown.triangles, axis=1)
    assert (
        (across[:, 0] < across[:, 1]).all()
        and (across[:, 1] < across[:, 2]).all()
        and len(np.unique(across, axis=0)) == len(across)
    )


def test_a_mesh_without_extent() -> None:
    mesh = Mesh(np.zeros((30, 3)), np.arange(30).reshape(10, 3))
    assert len(display.simplify(mesh, most=5).triangles) == 0


@pytest.mark.parametrize(
    ("size", "shown"), [(1.0, True), (1e29, True), (1e31, False), (1e-31, False), (0.0, False)]
)
def test_coordinates_beyond_single_precision_cannot_be_shown(size: float, shown: bool) -> None:
    assert display.can_be_shown(Mesh(size * sheet(2).corners, sheet(2).triangles)) == shown


def test_equal_values_keep_their_end() -> None:
    assert display.quantised(np.full(3, 2.0)) | {"data": ""} == {
        "low": [2.0],
        "high": [2.0],
        "data": "",
    }


def test_values_come_back_from_16_bits() -> None:
    values = np.array([[0.0, -5.0], [1.0, 7.0], [0.25, 7.0]])
    packed = display.quantised(values)
    whole = np.frombuffer(base64.b64decode(packed["data"]), "<u2").reshape(-1, 2)
    back = (
        np.array(packed["low"])
        + (np.array(packed["high"]) - np.array(packed["low"])) * whole / display.LEVELS
    )
    assert np.abs(back - values).max() <= 12 / display.LEVELS


@pytest.mark.usefixtures("tetrahedra")
def test_scenes_with_fields_and_motions(tmp_path: Path) -> None:
    file = ResultFile("overview")
    file.case(
        "cover",
        "bunny",
        [1.0],
        lower=0.5,
        upper=0.75,
        witness_source=[0.0, 0, 0],
        witness_target=[1.0, 0, 0],
    )
    file.fields = [{"case": 0, "name": "distance", "begin": 0, "end": 4}]
    file.field_values = [0.0, 0.1, 0.2, 0.5]
    for k in range(3):
        for solver in ("tang", "guthe"):
            file.case(solver, "moving", [1.0], lower=0.1 * k, upper=0.2, pose_index=k)
    file.case("tang", "two poses", [1.0], lower=0.1, upper=0.2)
    for k in range(3):
        file.case(
            "tang",
            "of the stability suite",
            [1.0],
            lower=0.1,
            upper=0.2,
            pose_index=k,
            severity=10.0**k,
        )
    described = scenes.described({"overview": load(file.write(tmp_path))})
    still, moving = described["scenes"]
    assert (
        still["witness"] == [0.0, 0, 0, 1, 0, 0]
        and still["colours"].keys() == {"distance"}
        and len(still["poses"]) == 1
    )
    assert (moving["solver"], len(moving["poses"]), moving["lower"]) == ("tang", 3, [0.0, 0.1, 0.2])
    assert len(described["meshes"]) == 4 and all(
        mesh["count"] == mesh["of"] == 4 for mesh in described["meshes"]
    )


def test_a_scene_whose_shapes_are_not_in_the_cache_is_left_out(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HAUSBENCH_CACHE", str(tmp_path))
    file = ResultFile("overview")
    file.case("cover", "bunny", [1.0], lower=0.5, upper=0.75)
    file.fields = [{"case": 0, "name": "distance", "begin": 0, "end": 4}]
    file.field_values = [0.0] * 4
    assert scenes.described({"overview": load(file.write(tmp_path))})["scenes"] == []
