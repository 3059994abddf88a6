"""hausbench.compat gives the numbers and types of scipy, and bounds those of igl."""

from __future__ import annotations

import hausbench as hb
import numpy as np
import pytest
from hausbench import compat
from sample_meshes import Mesh, sphere
from scipy.spatial.distance import directed_hausdorff


@pytest.mark.parametrize("columns", [1, 2, 3])
@pytest.mark.parametrize("seed", range(10))
def test_directed_hausdorff_is_scipy_s(columns: int, seed: int) -> None:
    random = np.random.default_rng(seed)
    u, v = random.normal(size=(60, columns)), random.normal(size=(40, columns))
    expected, answer = directed_hausdorff(u, v), compat.directed_hausdorff(u, v)
    assert [type(value) for value in answer] == [float, int, int]
    assert answer[0] == pytest.approx(expected[0], rel=4e-16)
    assert answer[1:] == expected[1:]  # no ties here


def test_directed_hausdorff_of_equal_points() -> None:
    points = np.random.default_rng(0).normal(size=(50, 3))
    assert (
        compat.directed_hausdorff(points, points[::-1])[0]
        == directed_hausdorff(points, points[::-1])[0]
        == 0
    )


def test_integers_are_points() -> None:
    u, v = np.array([[0, 0], [3, 4]], dtype=np.int32), np.array([[0, 0]], dtype=np.int32)
    distance, i, j = compat.directed_hausdorff(u, v)
    assert distance == 5 and (i, j) == (1, 0)


@pytest.mark.parametrize(
    "u, v",
    [
        (np.zeros((2, 4)), np.zeros((2, 4))),
        (np.zeros((2, 2)), np.zeros((2, 3))),
        (np.zeros(3), np.zeros(3)),
        (np.zeros((0, 3)), np.zeros((2, 3))),
        (np.zeros((0, 2)), np.zeros((2, 2))),
        (np.full((2, 2), np.nan), np.zeros((2, 2))),
        (np.zeros((2, 2), bool), np.zeros((2, 2))),
    ],
)
def test_other_arrays_are_refused(u: object, v: object) -> None:
    with pytest.raises(hb.InputError, match="^u"):
        compat.directed_hausdorff(u, v)  # type: ignore[arg-type]


def test_igl_s_hausdorff_is_a_number_above_the_vertices(small_sphere: Mesh) -> None:
    target = sphere(9, 0.1)
    distance = compat.hausdorff(*small_sphere, *target)
    assert type(distance) is float
    of_vertices = max(
        hb.field(small_sphere, target).lower.max(), hb.field(target, small_sphere).lower.max()
    )
    assert of_vertices <= distance
    assert hb.symmetric(small_sphere, target).interval.contains(distance)
