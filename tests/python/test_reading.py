"""hausbench.read: options, units, axes and notes; and poses from text files."""

from __future__ import annotations

import copy
import pickle
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any, Callable

import hausbench as hb
import numpy as np
import pytest
from sample_meshes import Mesh

if TYPE_CHECKING:
    from hausbench.typing import Pose

TRIANGLE = "OFF\n3 1 0\n0 0 0\n1 2 0\n0 1 3\n3 0 1 2\n"


@pytest.fixture
def triangle(tmp_path: Path) -> Path:
    path = tmp_path / "a.off"
    path.write_text(TRIANGLE)
    return path


def test_a_file_without_unit_and_axes(triangle: Path) -> None:
    shape = hb.read(triangle)
    assert shape.unit is None and shape.up is None and shape.notes == ()
    assert (
        shape.segment_count
        == shape.single_point_count
        == shape.dropped_point_count
        == shape.dropped_face_count
        == 0
    )


def test_options(triangle: Path) -> None:
    renamed = triangle.with_suffix(".obj")
    triangle.rename(renamed)
    shape = hb.read(renamed, format="off", unit="Inch", up="y")
    assert shape.unit == 0.0254 and shape.up == "Y" and len(shape.notes) == 2
    assert "inch" in shape.notes[0] and "Y" in shape.notes[1]
    assert shape.vertices.tolist() == [[0, 0, 0], [1, 2, 0], [0, 1, 3]]
    bare = hb.read(renamed, format="OFF", unit="none", up="none")
    assert bare.unit is None and bare.up is None and bare.notes == ()


@pytest.mark.parametrize(
    "wrong",
    [
        {"unit": "parsec"},
        {"unit": ""},
        {"up": "W"},
        {"unit": 3},
        {"up": b"Z"},
        {"format": "a\0b"},
        {"columns": (2, 3, 4)},
        {"drop_invalid": 1},
        {"up": "\udcff"},
    ],
)
def test_wrong_options_are_named(wrong: dict[str, Any], triangle: Path) -> None:
    with pytest.raises(hb.InputError, match=f"^{next(iter(wrong))}: "):
        hb.read(triangle, **wrong)
    with pytest.raises(TypeError):
        hb.read(triangle, "off")  # type: ignore[misc]


def test_dropped_points_are_counted(tmp_path: Path) -> None:
    path = tmp_path / "a.off"
    path.write_text("OFF\n4 2 0\n0 0 0\n1 0 0\n0 1 0\nnan 0 0\n3 0 1 2\n3 0 1 3\n")
    with pytest.raises(hb.InputError, match="drop_invalid=True"):
        hb.read(path)
    shape = hb.read(path, drop_invalid=True)
    assert (shape.face_count, shape.dropped_point_count, shape.dropped_face_count) == (1, 1, 1)


def test_different_units_are_refused(triangle: Path) -> None:
    inches, metres, plain = (
        hb.read(triangle, unit="inch"),
        hb.read(triangle, unit="m"),
        hb.read(triangle),
    )
    asks: list[Callable[[hb.Shape, hb.Shape], object]] = [
        hb.directed,
        hb.symmetric,
        hb.distribution,
        hb.field,
        lambda A, B: hb.prepare(B).directed(A),
    ]
    for ask in asks:
        with pytest.raises(
            hb.InputError,
            match=r'A \(.*a.off\) is in inch and B \(.*a.off\) in m: .*unit="mm".*"none"',
        ):
            ask(inches, metres)
        ask(inches, inches)
        ask(inches, plain)
        ask(plain, metres)


def test_different_axes_are_refused(triangle: Path) -> None:
    z, x = hb.read(triangle, up="Z"), hb.read(triangle, up="X")
    with pytest.raises(
        hb.InputError, match=r'Z points up in A \(.*a.off\) and X in B .*up="Z".*"none"'
    ):
        hb.directed(z, x)
    assert hb.directed(z, triangle).interval.contains(0)


@pytest.mark.parametrize(
    "duplicate",
    [
        copy.copy,
        copy.deepcopy,
        lambda shape: pickle.loads(pickle.dumps(shape)),
        lambda shape: pickle.loads(pickle.dumps(shape, 0)),
    ],
)
def test_copies_keep_unit_axes_and_notes(triangle: Path, duplicate: Any) -> None:
    shape = hb.read(triangle, unit="ft", up="Z")
    twin = duplicate(shape)
    assert (twin.unit, twin.up, twin.notes) == (
        shape.unit,
        "Z",
        shape.notes,
    ) and shape.unit == 0.3048
    assert hb.directed(shape, twin).interval.contains(0)
    with pytest.raises(hb.InputError, match="is in ft and B .* in mm"):
        hb.directed(twin, hb.read(triangle, unit="mm"))


def test_a_copy_keeps_the_counts(tetrahedron: Mesh) -> None:
    class Lines:
        points, lines = tetrahedron[0], [[0, 1], [1, 2]]

    shape = hb.prepare(Lines()).target
    assert shape.segment_count == 2 and pickle.loads(pickle.dumps(shape)).segment_count == 2


def test_a_pose_may_be_a_text_file(tetrahedron: Mesh, tmp_path: Path) -> None:
    file = tmp_path / "align.txt"
    file.write_text(
        "# moved by (3, 4, 0)\n1 0 0 3\n0 1, 0 4.0e0\n0\t0 1. 0\n0 0 0 1  # the last row\n"
    )
    poses: list[Pose] = [file, str(file)]
    for pose in poses:
        moved = hb.directed([[0, 0, 0]], [[0, 0, 0]], pose=pose, tolerance=1e-9)
        assert moved.interval.contains(5) and moved.interval.width < 1e-6
    assert hb.directed([[0, 0, 0]], [[0, 0, 0]], target_pose=file).interval.contains(5)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("1 0 0 0 1 0 0 0 1", "has 9 numbers: give the 16"),
        ("", "has 0 numbers"),
        ("1 2 x", "'x' is not a number"),
        ("1 0 0 0 0 1 0 0 0 0 1 0 3 4 0 1", "last column"),
        ("nan " * 16, "'nan' is not a number"),
        ("1e999 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1", "not finite"),
        ("1_0 " * 16, "not a number"),
        ("1 " * 40000, "numbers"),
    ],
)
def test_other_text_files_are_no_poses(text: str, said: str, tmp_path: Path) -> None:
    file = tmp_path / "align.txt"
    file.write_text(text)
    with pytest.raises(hb.InputError, match=f"^target_pose: .*{re.escape(said)}"):
        hb.directed([[0, 0, 0]], [[0, 0, 0]], target_pose=file)


def test_poses_that_are_no_files(tmp_path: Path) -> None:
    paths: list[Pose] = [tmp_path / "gone.txt", tmp_path, "a\0b"]
    for path in paths:
        with pytest.raises(hb.InputError, match="^pose: .*cannot be read"):
            hb.directed([[0, 0, 0]], [[0, 0, 0]], pose=path)


def test_the_message_about_a_mask_has_the_recipe_of_its_boundary() -> None:
    """Two balls of 15 voxels, 4 apart. All voxels as points have an HD95 of 2.449 and an ASSD of
    0.367."""
    ndimage = pytest.importorskip("scipy.ndimage")
    scipy = pytest.importorskip("scipy")
    grid = np.indices((40, 40, 40)) - 19.5
    masks = [
        ((grid - np.reshape([shift, 0, 0], (3, 1, 1, 1))) ** 2).sum(0) < 15**2 for shift in (0, 4)
    ]
    for wrong in (masks[0], masks[0].astype(np.uint8)):
        with pytest.raises(hb.InputError) as error:
            hb.distribution(wrong, wrong)
        text = str(error.value)
    recipe = text[text.index("numpy.argwhere") : text.index(" * spacing")] + " * spacing"
    boundaries = [
        eval(recipe, {"numpy": np, "scipy": scipy, "mask": mask, "spacing": (1, 1, 1)})
        for mask in masks
    ]
    assert ndimage is scipy.ndimage
    both = hb.distribution(*boundaries, over="pooled", quantiles=[0.95], statistics="mean")
    assert f"{both.quantile(0.95).upper:.3f} {both.mean.upper:.3f}" == "3.742 1.923"
