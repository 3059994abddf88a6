"""Objects of other packages: each measures as the surface, lines or points that it holds, or is
refused by name. Small classes have the attributes of these packages; the packages themselves are
tried if they are installed."""

from __future__ import annotations

from typing import Any

import hausbench as hb
import numpy as np
import pytest
from hausbench.shape_like import shape_of

CORNERS = np.array([[0, 0, 0], [2, 0, 0], [2, 2, 0], [9, 9, 9]], float)


def shape(geometry: Any) -> hb.Shape:
    return shape_of(geometry, "A")


def faces_of(geometry: Any) -> list[list[int]]:
    faces = shape(geometry).faces
    assert faces is not None
    return [list(map(int, face)) for face in faces]


def refusal(geometry: Any) -> str:
    with pytest.raises(hb.InputError) as error:
        hb.directed(geometry, np.zeros((1, 3)))
    text = str(error.value)
    assert text.startswith("A: ") and "\n" not in text
    return text


class Thing:
    """An object of another package."""


def thing(**attributes: Any) -> Any:
    """Returns an object with these attributes."""
    made = Thing()
    made.__dict__.update(attributes)
    return made


# --- line sets
# ----------------------------------------------------------------------------------------------------------


def test_a_line_set_is_its_segments() -> None:
    lines = thing(points=CORNERS, lines=np.array([[0, 1], [1, 2]], np.int32))
    assert faces_of(lines) == [[0, 1, 1], [1, 2, 2]]
    assert shape(lines).segment_count == 2
    assert hb.directed([[1, 1, 0]], lines).interval.contains(1)  # its points are 1.41 away


def test_line_sets_that_are_refused() -> None:
    assert "without lines" in refusal(thing(points=CORNERS, lines=[]))
    assert ".faces" in refusal(thing(points=CORNERS, lines=[[0, 1]], faces=[[0, 1, 2]]))
    assert "lines: " in refusal(thing(points=CORNERS, lines=[[0, 1, 2]]))
    assert "lines: " in refusal(thing(points=CORNERS, lines=[[0.0, 1.0]]))
    assert "vertex 4" in refusal(thing(points=CORNERS, lines=[[0, 4]]))


def entity(kind: str, *points: int) -> Any:
    return type(kind, (), {"points": np.array(points)})()


def test_a_path_is_its_polylines() -> None:
    path = thing(vertices=CORNERS, entities=[entity("Line", 0, 1, 2, 0), entity("Line", 2, 3)])
    assert faces_of(path) == [[0, 1, 1], [1, 2, 2], [2, 0, 0], [2, 3, 3]]
    assert hb.directed([[1, 0, 0]], path).interval.contains(0)


def test_paths_that_are_refused() -> None:
    assert "(Arc)" in refusal(
        thing(vertices=CORNERS, entities=[entity("Line", 0, 1), entity("Arc", 0, 1, 2)])
    )
    assert "to_3D" in refusal(thing(vertices=CORNERS[:, :2], entities=[entity("Line", 0, 1)]))
    assert "without entities" in refusal(thing(vertices=CORNERS, entities=[]))


# --- VTK
# ----------------------------------------------------------------------------------------------------------------


class Cells:
    """A vtkCellArray."""

    def __init__(self, *cells: list[int]) -> None:
        self.cells = cells

    def GetNumberOfCells(self) -> int:
        return len(self.cells)

    def GetOffsetsArray(self) -> Any:
        return np.cumsum([0, *map(len, self.cells)])

    def GetConnectivityArray(self) -> Any:
        return np.array([corner for cell in self.cells for corner in cell])


class Numbers:
    """A vtkDataArray without a buffer."""

    def __init__(self, values: Any) -> None:
        self.values = values

    def GetDataType(self) -> int:
        return 11

    def GetNumberOfTuples(self) -> int:
        return len(self.values)

    def GetNumberOfComponents(self) -> int:
        return len(self.values[0])

    def GetTuple(self, row: int) -> tuple[float, ...]:
        return tuple(self.values[row])


class PolyData:
    def __init__(self, points: Any = CORNERS, ghosts: Any = None, **cells: Cells) -> None:
        self.all_points, self.ghosts, self.cells_of = points, ghosts, cells

    def GetClassName(self) -> str:
        return "vtkPolyData"

    def GetPoints(self) -> Any:
        return None if self.all_points is None else thing(GetData=lambda: self.all_points)

    def GetCellGhostArray(self) -> Any:
        return self.ghosts

    def GetPointGhostArray(self) -> Any:
        return None

    def GetPolys(self) -> Any:
        return self.cells_of.get("polys", Cells())

    def GetStrips(self) -> Any:
        return self.cells_of.get("strips", Cells())

    def GetLines(self) -> Any:
        return self.cells_of.get("lines", Cells())

    def GetVerts(self) -> Any:
        return self.cells_of.get("verts", None)


def test_polydata() -> None:
    assert faces_of(PolyData(polys=Cells([0, 1, 2], [1, 2, 3]))) == [[0, 1, 2], [1, 2, 3]]
    assert faces_of(PolyData(strips=Cells([0, 1, 2, 3]))) == [[0, 1, 2], [1, 2, 3]]
    assert faces_of(PolyData(lines=Cells([0, 1, 2], [2, 3]))) == [[0, 1, 1], [1, 2, 2], [2, 3, 3]]
    every = PolyData(
        polys=Cells([0, 1, 2]),
        strips=Cells([1, 2, 3]),
        lines=Cells([0, 3]),
        verts=Cells([3], [1, 2]),
    )
    assert faces_of(every) == [[0, 1, 2], [1, 2, 3], [0, 3, 3], [3, 3, 3], [1, 1, 1], [2, 2, 2]]
    both = shape(every)
    assert (both.segment_count, both.single_point_count) == (1, 3)
    assert faces_of(PolyData(polys=Cells([0, 1], [2], [1, 2, 3]), lines=Cells([0]))) == [
        [1, 2, 3],
        [0, 1, 1],
        [2, 2, 2],
        [0, 0, 0],
    ]


def test_polydata_of_points() -> None:
    assert (
        shape(PolyData(verts=Cells([0], [2, 1]))).vertices.tolist() == CORNERS[[0, 2, 1]].tolist()
    )
    assert shape(PolyData()).vertex_count == 4
    assert shape(PolyData(points=CORNERS.astype(np.float32))).vertices.tolist() == CORNERS.tolist()
    assert shape(PolyData(points=Numbers(CORNERS))).vertices.tolist() == CORNERS.tolist()


def test_vtk_objects_that_are_refused() -> None:
    assert "vtkTriangleFilter" in refusal(PolyData(polys=Cells([0, 1, 2, 3])))
    assert "Update()" in refusal(PolyData(points=None))
    assert "RemoveGhostCells" in refusal(
        PolyData(polys=Cells([0, 1, 2]), ghosts=np.array([1], np.uint8))
    )
    assert faces_of(PolyData(polys=Cells([0, 1, 2]), ghosts=np.array([0], np.uint8))) == [[0, 1, 2]]
    assert "vertex 7" in refusal(PolyData(polys=Cells([0, 1, 7])))
    assert "vertex 7" in refusal(PolyData(verts=Cells([7]))) and "vertex -1" in refusal(
        PolyData(verts=Cells([-1]))
    )
    grid = thing(GetClassName=lambda: "vtkUnstructuredGrid", points=CORNERS, cells=[])
    assert "this vtkUnstructuredGrid" in refusal(grid) and "vtkGeometryFilter" in refusal(grid)


def test_vtk_itself() -> None:
    model = pytest.importorskip("vtkmodules.vtkCommonDataModel")
    core = pytest.importorskip("vtkmodules.vtkCommonCore")
    for kind in (core.vtkFloatArray, core.vtkDoubleArray):
        array = kind()
        array.SetNumberOfComponents(3)
        for corner in CORNERS:
            array.InsertNextTuple3(*corner)
        points, data = core.vtkPoints(), model.vtkPolyData()
        points.SetData(array)
        data.SetPoints(points)
        assert shape(data).vertices.tolist() == CORNERS.tolist()
        for put, cells in (
            (data.SetPolys, [[0, 1, 2]]),
            (data.SetLines, [[0, 1, 2]]),
            (data.SetStrips, [[0, 1, 2, 3]]),
            (data.SetVerts, [[3]]),
        ):
            table = model.vtkCellArray()
            for cell in cells:
                table.InsertNextCell(len(cell))
                for corner in cell:
                    table.InsertCellPoint(corner)
            put(table)
        assert faces_of(data) == [[0, 1, 2], [0, 1, 2], [1, 2, 3], [0, 1, 1], [1, 2, 2], [3, 3, 3]]
    assert "vtkImageData" in refusal(model.vtkImageData())


# --- open3d
# -------------------------------------------------------------------------------------------------------------


class Tensor:
    """A tensor of open3d, which has no __array__."""

    def __init__(self, values: Any) -> None:
        self.values = values

    def cpu(self) -> Tensor:
        return self

    def numpy(self) -> Any:
        return np.asarray(self.values)


class TensorMap:
    def __init__(self, **entries: Any) -> None:
        self.entries = entries

    def __getattr__(self, name: str) -> Any:
        return self.__dict__["entries"][name]  # raises KeyError, as open3d does


def test_meshes_of_tensors() -> None:
    mesh = thing(
        vertex=TensorMap(positions=Tensor(CORNERS)), triangle=TensorMap(indices=Tensor([[0, 1, 2]]))
    )
    assert faces_of(mesh) == [[0, 1, 2]]
    assert "without triangles" in refusal(
        thing(vertex=TensorMap(positions=Tensor(CORNERS)), triangle=TensorMap())
    )
    assert "no geometry" in refusal(thing(vertex=TensorMap(), triangle=TensorMap()))


def test_point_clouds_and_line_sets_of_tensors() -> None:
    assert (
        shape(thing(point=TensorMap(positions=Tensor(CORNERS)))).vertices.tolist()
        == CORNERS.tolist()
    )
    assert shape(Tensor(CORNERS)).vertices.tolist() == CORNERS.tolist()
    assert faces_of(
        thing(point=TensorMap(positions=Tensor(CORNERS)), line=TensorMap(indices=Tensor([[0, 1]])))
    ) == [[0, 1, 1]]
    assert "without lines" in refusal(
        thing(point=TensorMap(positions=Tensor(CORNERS)), line=TensorMap())
    )


def test_open3d_itself() -> None:
    open3d = pytest.importorskip("open3d")
    box = open3d.geometry.TriangleMesh.create_box()
    lines = open3d.geometry.LineSet.create_from_triangle_mesh(box)
    expected = faces_of(box)
    assert len(expected) == 12
    tensors = open3d.t.geometry
    assert faces_of(tensors.TriangleMesh.from_legacy(box)) == expected
    edges = faces_of(lines)
    assert (
        len(edges) == 18
        and all(b == c for _, b, c in edges)
        and faces_of(tensors.LineSet.from_legacy(lines)) == edges
    )
    for cloud in (
        open3d.geometry.PointCloud(box.vertices),
        tensors.PointCloud.from_legacy(open3d.geometry.PointCloud(box.vertices)),
    ):
        assert shape(cloud).vertices.tolist() == np.asarray(box.vertices).tolist()
    assert "volume" in refusal(open3d.geometry.TetraMesh())
    assert "no geometry" in refusal(tensors.TriangleMesh())


# --- others
# -------------------------------------------------------------------------------------------------------------


def test_meshio() -> None:
    blocks = [
        thing(type="triangle", data=np.array([[0, 1, 2]])),
        thing(type="line", data=np.array([[0, 3]])),
        thing(type="triangle", data=np.array([[1, 2, 3]])),
        thing(type="vertex", data=np.array([[3]])),
    ]
    expected = [[0, 1, 2], [1, 2, 3], [0, 3, 3], [3, 3, 3]]
    assert faces_of(thing(points=CORNERS, cells=blocks)) == expected
    assert (
        faces_of(thing(points=CORNERS, cells=[(block.type, block.data) for block in blocks]))
        == expected
    )
    assert shape(thing(points=CORNERS, cells=[])).vertex_count == 4
    for kind in ("quad", "tetra", "triangle6", "polygon"):
        text = refusal(
            thing(points=CORNERS, cells=[*blocks, thing(type=kind, data=np.array([[0, 1, 2, 3]]))])
        )
        assert f"({kind})" in text and "cells_dict['triangle']" in text
    meshio = pytest.importorskip("meshio")
    assert faces_of(meshio.Mesh(CORNERS, [("triangle", [[0, 1, 2]]), ("line", [[0, 1]])])) == [
        [0, 1, 2],
        [0, 1, 1],
    ]


def test_marching_cubes() -> None:
    made = (
        CORNERS.astype(np.float32),
        np.array([[0, 1, 2]], np.int32),
        CORNERS.astype(np.float32),
        np.zeros(4, np.float32),
    )
    assert faces_of(made) == [[0, 1, 2]]
    four_rows: Any = ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))
    assert not shape(four_rows).is_mesh
    assert "(vertices, faces)" in refusal(list(made)) and "(vertices, faces)" in refusal(made[:3])


def test_marching_cubes_of_scikit_image() -> None:
    measure = pytest.importorskip("skimage.measure")
    grid = np.indices((12, 12, 12)) - 5.5
    made = measure.marching_cubes((grid**2).sum(0) - 16.0, 0)
    assert hb.directed(made, made[:2]).interval.contains(0)
    assert shape(made).face_count == len(made[1])


def test_objects_whose_points_would_be_another_shape() -> None:
    assert "volume" in refusal(thing(vertices=CORNERS, tetras=[[0, 1, 2, 3]]))
    assert "marching_cubes" in refusal(thing(points=CORNERS, encoding=None))
    assert "(hull.points, hull.simplices)" in refusal(thing(points=CORNERS, simplices=[[0, 1, 2]]))
    assert "to_mesh" in refusal(thing(geometry={}, graph=None))
    assert "of type Thing" in refusal(thing())
