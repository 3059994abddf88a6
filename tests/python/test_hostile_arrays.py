"""Hostile arrays give InputError that names the row, or a right answer; never a crash."""

from __future__ import annotations

import threading
from typing import Any

import hausbench as hb
import numpy as np
import pytest
from sample_meshes import Mesh, sphere


def fails(A: Any, row: int | None = None, B: Any = None) -> str:
    with pytest.raises(hb.InputError) as error:
        hb.directed(A, np.zeros((1, 3)) if B is None else B)
    text = str(error.value)
    assert text.startswith("A: ") and "\n" not in text
    assert error.value.row == row
    assert row is None or f"row {row}" in text
    return text


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("kind", ["f4", "f8", ">f8", "f2"])
def test_coordinates_that_are_not_finite(tetrahedron: Mesh, value: float, kind: str) -> None:
    vertices = tetrahedron[0].astype(kind)
    vertices[2, 1] = value
    assert "not finite" in fails((vertices, tetrahedron[1]), 2)
    assert "not finite" in fails(vertices[::-1], 1)


@pytest.mark.parametrize("index", [-1, 4, 2**31, 2**63 - 1, -(2**63)])
def test_indices_out_of_range(tetrahedron: Mesh, index: int) -> None:
    faces = tetrahedron[1].copy()
    faces[3, 2] = index
    assert str(index) in fails((tetrahedron[0], faces), 3)


def test_unsigned_indices_out_of_range(tetrahedron: Mesh) -> None:
    for kind, value in ((np.uint64, 2**64 - 1), (np.uint32, 2**32 - 1), (np.uint8, 255)):
        faces = tetrahedron[1].astype(kind)
        faces[1, 0] = value
        fails((tetrahedron[0], faces), 1)


def test_empty_arrays(tetrahedron: Mesh) -> None:
    nothings: list[Any] = [
        np.zeros((0, 3)),
        np.zeros((0, 3), np.float32),
        [],
        np.zeros(0),
        np.zeros((3, 0)),
        (),
    ]
    for empty in nothings:
        fails(empty)
    no_faces: list[Any] = [np.zeros((0, 3), int), np.zeros((0, 3)), [], np.zeros(0, int)]
    for faces in no_faces:
        assert "no rows" in fails((tetrahedron[0], faces)) or "0 rows" in fails(
            (tetrahedron[0], faces)
        )


def test_wrong_shapes(tetrahedron: Mesh) -> None:
    vertices, faces = tetrahedron
    for points in (
        vertices[0],
        vertices[:, :2],
        vertices[None],
        np.float64(3),
        np.zeros((4, 4)),
        vertices.ravel(),
    ):
        assert "(n, 3)" in fails(points)
    assert "column of zeros" in fails(vertices[:, :2])
    for wrong in (faces[0], faces[:, :2], faces[None], faces.ravel(), np.int64(3)):
        assert "(m, 3)" in fails((vertices, wrong))
    assert "quadrangle" in fails((vertices, np.zeros((2, 4), int)))
    assert "reshape" in fails((vertices, np.hstack([np.full((4, 1), 3), faces])))
    assert "triangulate" in fails((vertices, np.array([4, 0, 1, 2, 3])))


@pytest.mark.parametrize(
    "kind", [bool, complex, object, "U5", "S5", "M8[s]", "m8[s]", np.longdouble, "V24"]
)
def test_types_of_vertices_that_are_refused(tetrahedron: Mesh, kind: Any) -> None:
    vertices = np.zeros((4, 3), kind)
    assert "type" in fails(vertices)
    assert "type" in fails((vertices, tetrahedron[1]))


@pytest.mark.parametrize("kind", [bool, complex, object, "U5", float, np.float32, "V24"])
def test_types_of_faces_that_are_refused(tetrahedron: Mesh, kind: Any) -> None:
    assert "type" in fails((tetrahedron[0], np.zeros((4, 3), kind)))


def test_errors_say_what_to_do(tetrahedron: Mesh) -> None:
    vertices, faces = tetrahedron
    column = np.zeros((5, 3))
    for wrong, remedy in (
        (column.T, ".T"),
        (np.zeros((5, 6)), "[:, :3]"),
        ([1, 2, 3], "[[x, y, z]]"),
        ([vertices, faces[:2]], "tuple"),
        ((vertices, faces, vertices[:2]), "tuple"),
        (np.zeros((4, 4, 4), bool), "argwhere"),
        ((vertices, np.zeros((3, 5), int)), ".T"),
        ((faces, vertices), "exchanged"),
    ):
        assert remedy in fails(wrong), remedy
    with pytest.raises(hb.InputError, match="hausbench.read"):
        hb.Shape("a.ply")
    with pytest.raises(hb.InputError, match="as_matrix"):
        hb.directed(tetrahedron, tetrahedron, pose=object())  # type: ignore[arg-type]
    with pytest.raises(hb.InputError, match="last column"):
        hb.directed(
            tetrahedron,
            tetrahedron,
            pose=np.array([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [1, 2, 3, 1]]),
        )


def test_structured_ragged_and_masked_arrays(tetrahedron: Mesh) -> None:
    fails(np.zeros(4, [("x", float), ("y", float), ("z", float)]))
    fails([[0, 0, 0], [1, 2]])
    fails([tetrahedron[0], tetrahedron[1][:2]])
    fails([[2**70, 0, 0]])
    masked: Any = np.ma.masked_array(tetrahedron[0], mask=False)  # type: ignore[no-untyped-call]
    assert hb.directed(masked, tetrahedron[0]).interval.upper < 1e-5
    masked[2, 0] = np.ma.masked
    assert "masked" in fails(masked, 2)


def test_integers_that_no_double_holds() -> None:
    points = np.array([[0, 0, 0], [2**53 + 1, 0, 0]])
    fails(points, 1)
    fails(points.astype(np.uint64), 1)
    assert hb.directed(np.array([[2**53, 0, 0]]), np.zeros((1, 3))).interval.contains(2.0**53)


@pytest.mark.parametrize(
    "kind", ["i1", "u1", "i2", ">i2", "u4", "i8", ">i8", "u8", "f2", ">f4", "f4", ">f8"]
)
def test_types_that_are_converted(kind: str) -> None:
    assert hb.directed(np.array([[0, 3, 4]], kind), np.zeros((1, 3))).interval.contains(5)


def test_read_only_and_broadcast_arrays(tetrahedron: Mesh) -> None:
    vertices, faces = (array.copy() for array in tetrahedron)
    expected = hb.directed(tetrahedron, np.zeros((1, 3))).interval
    vertices.flags.writeable = faces.flags.writeable = False
    assert hb.directed((vertices, faces), np.zeros((1, 3))).interval == expected
    assert hb.directed(np.broadcast_to(3.0, (5, 3)), np.zeros((1, 3))).interval.contains(27**0.5)
    assert hb.directed(np.broadcast_to([0.0, 3, 4], (1000, 3)), np.zeros((1, 3))).interval.contains(
        5
    )


def test_arrays_that_are_not_aligned() -> None:
    record = np.zeros(4, np.dtype([("tag", "i1"), ("xyz", "f8", 3)]))
    record["xyz"] = [[0, 3, 4]] * 4
    assert not record["xyz"].flags.aligned
    assert hb.directed(record["xyz"], np.zeros((1, 3))).interval.contains(5)


def test_aliasing_and_overlapping_arrays() -> None:
    row = np.arange(12.0)
    overlapping = np.lib.stride_tricks.as_strided(row, (10, 3), (8, 8))
    assert hb.directed(overlapping, overlapping.copy()).interval.upper < 1e-5
    memory = np.zeros((4, 3), np.int64)
    memory[1:, :] = np.eye(3, dtype=np.int64)
    mesh = memory.astype(float), memory % 2
    assert hb.directed(mesh, mesh).interval.upper < 1e-5


def test_degenerate_and_duplicate_faces(tetrahedron: Mesh) -> None:
    vertices, faces = tetrahedron
    expected = hb.directed(tetrahedron, np.zeros((1, 3))).interval
    doubled = np.vstack([faces, faces, [[0, 0, 0]], [[1, 1, 2]]])
    interval = hb.directed((vertices, doubled), np.zeros((1, 3))).interval
    assert interval.lower <= expected.upper and expected.lower <= interval.upper


def test_huge_and_tiny_coordinates() -> None:
    for scale in (1e-300, 1e-150, 1e150, 1e300):
        points = np.array([[0, 0, 0], [0, 3 * scale, 4 * scale]])
        assert hb.directed(points, points[:1]).interval.contains(5 * scale)


class Lying:
    """An object whose geometry raises or changes between looks."""

    @property
    def vertices(self) -> Any:
        raise RuntimeError("lost")


class Odd:
    def __array__(self, dtype: Any = None) -> Any:
        raise ValueError("no array\ntoday")


class Shrinking:
    """Faces that change the array of vertices while they are read."""

    def __init__(self, vertices: Any, faces: Any, shape: tuple[int, ...]) -> None:
        self.vertices, self.faces, self.shape = vertices, faces, shape

    def __array__(self, dtype: Any = None) -> Any:
        self.vertices.resize(self.shape, refcheck=False)
        return self.faces


def test_arrays_that_change_while_others_are_read(tetrahedron: Mesh) -> None:
    for shape in ((1, 3), (2, 3)):
        vertices = np.vstack([tetrahedron[0]] * 20000)
        assert "row 0" in fails((vertices, Shrinking(vertices, tetrahedron[1], shape)), 0)
    vertices = np.vstack([tetrahedron[0]] * 20000)
    assert "changed" in fails((vertices, Shrinking(vertices, tetrahedron[1], (12,))))


def test_objects_that_raise() -> None:
    with pytest.raises(RuntimeError, match="lost"):
        hb.directed(Lying(), np.zeros((1, 3)))  # type: ignore[arg-type]
    assert "no array" in fails(Odd())


def test_a_tuple_whose_parts_are_exchanged(tetrahedron: Mesh) -> None:
    assert "faces" in fails((tetrahedron[1], tetrahedron[0]))


def test_arrays_that_are_resized_during_calls() -> None:
    """The arrays are copied before the library works, so that another thread may do with them what
    it likes."""
    points, target = np.ones((3000, 3)), hb.Shape(*sphere(20, 0.1))
    over = threading.Event()

    def resize() -> None:
        while not over.is_set():
            points.resize((10, 3), refcheck=False)
            points.resize((60000, 3), refcheck=False)
            points[:] = 1

    thread = threading.Thread(target=resize)
    thread.start()
    try:
        for _ in range(200):
            assert hb.directed(points, target, tolerance=1e-2).interval.lower <= 2
    finally:
        over.set()
        thread.join()
