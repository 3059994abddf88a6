"""Fields are values at A's vertices and elements. They are kept beside the journal and in the
result, checked again, and written as PLY or VTK."""

from __future__ import annotations

import json
import os
import subprocess
from pathlib import Path
from typing import Any

import h5py
import meshio
import numpy as np
import pytest

from program import Program
from test_run import numbers, run, same_answers, texts

Fields = dict[tuple[int, str], Any]
DRAWN = {
    "distance",
    "nearest",
    "x",
    "y",
    "z",
    "a",
    "b",
    "c",
    "element",
}  # fields of every case of meshes

MOVED = """
title = "fields"
tolerances = [1e-2, 1e-3]
of = "diagonal"
repeats = 1
fields = true
[[scene]]
name = "spheres"
source = "sphere1"
target = "sphere2"
motion = { kind = "translation", from = [0, 0, 0], to = [3, 0, 0], steps = 3 }
target_motion = { kind = "translation", from = [0, 0, 0], to = [0, 1, 0], steps = 3 }
[[solver]]
name = "guthe"
"""


def fields_of(file: Path) -> Fields:
    """Returns the fields by case and name."""
    with h5py.File(file, "r") as f:
        group, values = f["fields"], f["fields/values"][:]
        return {
            (int(case), name): values[begin:end]
            for case, name, begin, end in zip(
                group["case"], group["name"].asstr()[:], group["begin"], group["end"]
            )
        }


def same_fields(first: Path, second: Path) -> None:
    a, b = fields_of(first), fields_of(second)
    assert list(a) == list(b)
    for key in a:
        np.testing.assert_array_equal(a[key], b[key])


@pytest.fixture
def moved(tmp_path: Path) -> Path:
    file = tmp_path / "moved.toml"
    file.write_text(MOVED)
    return file


def test_every_answer_has_fields(hausbench: Program, moved: Path, tmp_path: Path) -> None:
    file = run(hausbench, moved, tmp_path)
    fields = fields_of(file)
    assert {name for _, name in fields} == {*DRAWN, "lower", "upper", "level"} and len(
        fields
    ) == 6 * 12
    assert texts(file, "cases/fields_check") == ["holds"] * 6
    with h5py.File(file, "r") as f:
        for case in range(6):
            # The largest distance drawn is near h. Distances at A's own vertices are the same for
            # both tolerances, but differ between poses.
            assert (
                0.95 * f["cases/lower"][case]
                <= fields[case, "distance"].max()
                <= f["cases/upper"][case]
            )
            corners = (
                len(np.unique(fields[case, "element"])) // 2 + 2
            )  # of the sphere's mesh, by Euler's formula
            same = [
                row
                for row in range(6)
                if np.array_equal(
                    fields[case, "distance"][:corners], fields[row, "distance"][:corners]
                )
            ]
            assert {f["cases/pose_index"][row] for row in same} == {
                f["cases/pose_index"][case]
            } and len(same) == 2
    # Without fields, cases have the same identities.
    moved.write_text(MOVED.replace("fields = true", ""))
    without = run(hausbench, moved, tmp_path / "without")
    same_answers(without, file)
    assert fields_of(without) == {} and texts(without, "cases/fields_sha256") == [""] * 6
    assert not list((tmp_path / "without").glob("*.fields"))


def test_rows_without_their_file_are_run_again(
    hausbench: Program, moved: Path, tmp_path: Path
) -> None:
    moved.write_text(MOVED.replace("fields = true", ""))
    file = run(hausbench, moved, tmp_path)
    times = [numbers(file, "repeats/wall_seconds")]

    def again() -> list[bool]:
        """Returns which rows were measured again."""
        run(hausbench, moved, tmp_path)
        times.append(numbers(file, "repeats/wall_seconds"))
        return list(times[-1] != times[-2])

    assert not any(again())
    moved.write_text(MOVED)
    assert all(again()) and not any(again())
    good = fields_of(file)
    kept = {
        identity: tmp_path / "moved.fields" / f"{identity}.bin"
        for identity in texts(file, "cases/identity")
    }
    assert sorted(kept.values()) == sorted((tmp_path / "moved.fields").iterdir())
    first, second, *_ = kept.values()
    first.unlink()
    with second.open("r+b") as f:
        f.seek(-1, os.SEEK_END)
        f.write(b"?")
    assert again() == [True, True, False, False, False, False]
    now = fields_of(file)
    assert all(np.array_equal(now[key], good[key]) for key in good)
    # If fields cannot be written, the answers still count, and the next run writes the fields.
    for kept_file in kept.values():
        kept_file.unlink()
        kept_file.mkdir()
    again()
    assert fields_of(file) == {} and texts(file, "cases/status") == ["ok"] * 6
    for kept_file in kept.values():
        kept_file.rmdir()
    again()
    same = fields_of(file)
    assert all(np.array_equal(same[key], good[key]) for key in good)
    run(hausbench, moved, tmp_path, "--fresh")
    assert len(list((tmp_path / "moved.fields").iterdir())) == 6


def test_shards_put_together_have_all_fields(
    hausbench: Program, moved: Path, tmp_path: Path
) -> None:
    moved.write_text(MOVED + '[[solver]]\nname = "cgal"\n')
    whole = run(hausbench, moved, tmp_path / "whole")
    for i in (1, 2):
        assert hausbench("run", moved, "--results", tmp_path, "--shard", f"{i}/2").returncode == 0
    parts = sorted(tmp_path.glob("moved.shard-*.h5"))
    assert len(parts) == 2 and 0 < len(fields_of(parts[0])) < len(fields_of(whole))
    merged = tmp_path / "merged.h5"
    assert hausbench("merge", merged, *parts).returncode == 0
    same_fields(merged, whole)
    assert texts(merged, "cases/fields_check") == texts(whole, "cases/fields_check")


@pytest.mark.parametrize(
    "column,place,value", [("distance", 0, 1e-3), ("distance", -1, 1e-3), ("nearest", 0, 1.0)]
)
def test_verify_finds_a_changed_value(
    hausbench: Program, moved: Path, tmp_path: Path, column: str, place: int, value: float
) -> None:
    file = run(hausbench, moved, tmp_path)
    done = hausbench("verify", file)
    assert (
        done.returncode == 0 and "fields of cases: 6 hold, 0 unsound, 0 not checked" in done.stdout
    )
    with h5py.File(file, "r+") as f:
        names = list(f["fields/name"].asstr()[:])
        at = f["fields/begin" if place >= 0 else "fields/end"][names.index(column)] + place
        f["fields/values"][at] += value
    done = hausbench("verify", file)
    assert (
        done.returncode == 1
        and "fields of cases: 5 hold, 1 unsound" in done.stdout
        and "vertex" in done.stdout
    )


@pytest.mark.parametrize("column,change", [("end", 1000), ("begin", -1), ("case", 100)])
def test_fields_out_of_place_are_refused(
    hausbench: Program, moved: Path, tmp_path: Path, column: str, change: int
) -> None:
    file = run(hausbench, moved, tmp_path)
    with h5py.File(file, "r+") as f:
        f[f"fields/{column}"][-1] += change
    assert "moved.h5" in hausbench.fails("verify", file)


def test_warm_chains_and_rows_read_off(hausbench: Program, moved: Path, tmp_path: Path) -> None:
    cold = 'warm = true\n[[solver]]\nname = "guthe"\nlabel = "cold"\n'
    moved.write_text(MOVED + cold)
    assert len(fields_of(run(hausbench, moved, tmp_path))) == 12 * 12
    # With a trace, the cold solver's coarser tolerance is read off the finer run, so its fields are
    # no longer used.
    moved.write_text(MOVED.replace("repeats = 1", "repeats = 1\ntrace = true") + cold)
    file = run(hausbench, moved, tmp_path)
    from_trace, fields = numbers(file, "cases/from_trace"), fields_of(file)
    assert from_trace.sum() == 3
    assert texts(file, "cases/fields_check") == [
        "not checked" if read else "holds" for read in from_trace
    ]
    assert {case for case, _ in fields} == set(np.flatnonzero(from_trace == 0))


def test_a_solvers_own_fields(
    hausbench: Program, plugin: Path, moved: Path, tmp_path: Path
) -> None:
    """A plug-in returns bounds for each triangle, in the unit of the input, although shapes are
    scaled and B is moved."""
    text = (
        MOVED.replace("tolerances = [1e-2, 1e-3]", "tolerances = [2.0]")
        .replace('"diagonal"', '"absolute"')
        .replace("guthe", "vertex_only")
    )
    for quantity in ("symmetric", "directed"):
        moved.write_text(f'quantity = "{quantity}"\n{text}')
        file = run(hausbench, moved, tmp_path, "--plugin", str(plugin))
        fields = fields_of(file)
        assert {name for _, name in fields} == {*DRAWN, "lower", "upper"}
        assert texts(file, "cases/fields_check") == ["holds"] * 3
        for case in range(3):
            assert len(fields[case, "upper"]) == numbers(file, "cases/source_elements")[case]
            if quantity == "directed":
                assert fields[case, "lower"].max() == numbers(file, "cases/lower")[case]
                assert fields[case, "upper"].max() == numbers(file, "cases/upper")[case]
    with h5py.File(file, "r+") as f:
        row = len(f["fields/name"]) - 1  # the last pose, which is farthest away
        assert f["fields/name"].asstr()[row] == "upper"
        assert (
            f["fields/of"].asstr()[row] == "elements"
            and f["fields/meaning"].asstr()[row] == "upper"
        )
        f["fields/values"][f["fields/begin"][row]] *= 0.5
    done = hausbench("verify", file)
    assert done.returncode == 1 and "upper" in done.stdout


def read_ply(file: Path) -> tuple[Any, Any]:
    """Returns vertices and faces, as structured arrays."""
    head, _, body = file.read_bytes().partition(b"end_header\n")
    kinds = {"double": "<f8", "float": "<f4", "int": "<i4", "uchar": "u1"}
    types: list[list[tuple[str, ...] | tuple[str, str, int]]] = []
    counts = []
    for line in head.decode().splitlines():
        words = line.split()
        if words[0] == "element":
            counts.append(int(words[2]))
            types.append([])
        elif words[:2] == ["property", "list"]:
            types[-1] += [("corners", "u1"), ("vertex_indices", "<i4", 3)]
        elif words[0] == "property":
            types[-1].append((words[2], kinds[words[1]]))
    arrays = []
    for count, kind in zip(counts, types):
        arrays.append(np.frombuffer(body, np.dtype(kind), count))
        body = body[arrays[-1].nbytes :]
    assert body == b""
    return arrays[0], arrays[1] if len(arrays) > 1 else None


def test_measure_writes_a_ply(
    hausbench: Program, plugin: Path, tetrahedron: Path, raised: Path, tmp_path: Path
) -> None:
    plain = hausbench("measure", tetrahedron, raised, "--json")
    out = tmp_path / "out.ply"
    done = hausbench(
        "measure", tetrahedron, raised, "--json", "--resolution", "inf", "--fields", out
    )
    assert (
        done.returncode == 0
        and done.stdout.split('"peak')[0].split('"note')[0]
        == plain.stdout.split('"peak')[0].split('"note')[0]
    )
    vertices, faces = read_ply(out)
    assert vertices["distance"].tolist() == [0.25, 0.25, 0.25, 0] and vertices["nearest"][0] == 0
    assert (
        vertices["quality"].tolist()
        == vertices["scalar_distance"].tolist()
        == vertices["distance"].tolist()
    )
    colours = np.stack([vertices[name] for name in ("red", "green", "blue")], axis=1)
    assert [list(row) for row in colours] == [[253, 231, 37]] * 3 + [[68, 1, 84]]
    assert faces["vertex_indices"].tolist() == [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]
    assert faces.dtype.names == ("corners", "vertex_indices")
    assert json.loads(done.stdout)["fields"] == [
        {"file": str(out), "largest": 0.25, "vertices": 4, "pieces": 4, "resolved": True}
    ]
    vtk = tmp_path / "out.vtk"
    assert (
        hausbench(
            "measure",
            tetrahedron,
            raised,
            "--solver",
            "vertex_only",
            "--plugin",
            plugin,
            "--fields",
            vtk,
        ).returncode
        == 0
    )
    *_, of_cells = read_by_meshio(vtk)
    assert (of_cells["lower"] <= of_cells["upper"]).all() and of_cells[
        "lower"
    ].max() == pytest.approx(0.25)
    points = tmp_path / "points.obj"
    points.write_text("v 0 0 4\nv 0 0 0\n")
    assert hausbench("measure", points, points, "--fields", out).returncode == 0
    vertices, none = read_ply(out)
    assert (
        vertices["distance"].tolist() == [0, 0]
        and vertices["nearest"].tolist() == [0, 1]
        and none is None
    )


def read_by_meshio(file: Path) -> tuple[Any, Any, dict[str, Any], dict[str, Any]]:
    """Returns points, cells, and the fields of both."""
    mesh = meshio.read(file)
    assert len(mesh.cells) <= 1 and mesh.points.dtype.itemsize == 8
    cells = mesh.cells[0].data if mesh.cells else None
    of_points = {name: v.reshape(-1) for name, v in mesh.point_data.items()}
    of_cells = {name: v.reshape(-1) for name, [v] in mesh.cell_data.items()}
    return mesh.points, cells, of_points, of_cells


def test_vtk_is_read_by_another_library(
    hausbench: Program, experiment: Path, tmp_path: Path
) -> None:
    """The file has the same fields as the case in a result."""
    experiment.write_text(f"fields = true\n{experiment.read_text()}")
    stored = {
        name: values
        for (_, name), values in fields_of(run(hausbench, experiment, tmp_path)).items()
    }
    a, b, out = tmp_path / "a.off", tmp_path / "b.off", tmp_path / "out.vtk"
    assert (
        hausbench("export", "sphere1", a).returncode
        == hausbench("export", "sphere2", b).returncode
        == 0
    )
    done = hausbench(
        "measure", a, b, "--solver", "guthe", "--tolerance", "1e-3", "--json", "--fields", out
    )
    points, cells, of_points, of_cells = read_by_meshio(out)
    model = meshio.read(a)
    np.testing.assert_array_equal(points[: len(model.points)], model.points)
    assert meshio.read(out).cells[0].type == "triangle" and len(cells) > len(model.cells[0].data)
    assert set(of_points) == {"distance", "nearest"} and set(of_cells) == {
        "element",
        "lower",
        "upper",
        "level",
    }
    for k, name in enumerate("xyz"):
        np.testing.assert_array_equal(points[:, k], stored[name])
    for k, name in enumerate("abc"):
        np.testing.assert_array_equal(cells[:, k], stored[name])
    for name in ("distance", "nearest", "element"):
        np.testing.assert_array_equal({**of_points, **of_cells}[name], stored[name])
    for name in ("lower", "upper", "level"):
        np.testing.assert_array_equal(of_cells[name], stored[name][of_cells["element"]])
    assert of_points["nearest"].dtype.kind == "i" and len(set(of_points["nearest"])) > 2
    assert (
        of_cells["upper"].max() == json.loads(done.stdout)["upper"]
        and len(set(of_cells["lower"])) > 2
    )


def test_vtk_without_a_solvers_fields_and_of_points(
    hausbench: Program, tetrahedron: Path, raised: Path, tmp_path: Path
) -> None:
    out = tmp_path / "out.VTK"
    assert (
        hausbench(
            "measure",
            tetrahedron,
            raised,
            "--solver",
            "cgal",
            "--resolution",
            "inf",
            "--fields",
            out,
        ).returncode
        == 0
    )
    out = out.rename(tmp_path / "out.vtk")  # meshio does not know .VTK
    _, cells, of_points, of_cells = read_by_meshio(out)
    assert of_points["distance"].tolist() == [0.25, 0.25, 0.25, 0] and set(of_cells) == {"element"}
    assert cells.tolist() == [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]
    a, b = tmp_path / "a.obj", tmp_path / "b.obj"
    a.write_text("v 0 0 4\nv 0 0 0.1\nv 1 0 0\n")
    b.write_text("v 1 0 0\nv 0 0 0.1\n")
    assert hausbench("measure", a, b, "--solver", "guthe", "--fields", out).returncode == 0
    points, cells, of_points, of_cells = read_by_meshio(out)
    assert points.tolist() == [[0, 0, 4], [0, 0, 0.1], [1, 0, 0]]
    assert meshio.read(out).cells[0].type == "vertex" and cells.tolist() == [[0], [1], [2]]
    assert of_points["distance"].tolist() == [3.9, 0, 0] and of_points["nearest"].tolist() == [
        1,
        1,
        0,
    ]
    assert of_cells["lower"][0] == pytest.approx(3.9) and len(of_cells["lower"]) == 3


def test_ply_is_read_by_another_library(
    hausbench: Program, tetrahedron: Path, raised: Path, tmp_path: Path
) -> None:
    out = tmp_path / "out.ply"
    assert (
        hausbench("measure", tetrahedron, raised, "--resolution", "inf", "--fields", out).returncode
        == 0
    )
    points, cells, of_points, _ = read_by_meshio(out)
    np.testing.assert_array_equal(points, meshio.read(tetrahedron).points)
    assert cells.tolist() == [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]
    assert set(of_points) == {
        "quality",
        "scalar_distance",
        "red",
        "green",
        "blue",
        "distance",
        "nearest",
    }
    assert of_points["distance"].tolist() == of_points["quality"].tolist() == [0.25, 0.25, 0.25, 0]


def test_fields_are_those_of_h_and_of_the_question(
    hausbench: Program, tetrahedron: Path, tmp_path: Path
) -> None:
    """With --symmetric, the fields of A are still written if B has more vertices and triangles and
    gives the larger distance. With --cutoff, the fields are the bounds known when the search ended.
    """
    b, out = tmp_path / "b.off", tmp_path / "out.vtk"
    b.write_text(
        "OFF\n5 5 0\n0 0 0.25\n1 0 0.25\n0 1 0.25\n0 0 1.25\n5 0 0\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n3 1 2 4\n"
    )

    def read(*more: str) -> tuple[int, Any, Any, Any]:
        done = hausbench("measure", tetrahedron, b, "--resolution", "inf", "--fields", out, *more)
        assert done.stderr == ""
        _, _, of_points, of_cells = read_by_meshio(out)
        out.unlink()
        return done.returncode, of_points["distance"].tolist(), of_cells["lower"], of_cells["upper"]

    _, distance, lower, upper = read()
    assert len(distance) == 4 and len(lower) == len(upper) == 4
    code, distance_of_both, lower_of_both, upper_of_both = read("--symmetric")
    assert code == 0 and distance_of_both == distance
    assert lower_of_both.max() <= upper.max() < 0.5 and lower.max() <= upper_of_both.max() < 0.5
    _, _, of_points, of_cells = read_by_meshio(tmp_path / "out.back.vtk")
    assert len(of_points["distance"]) == 5 and of_points["distance"].max() == 4
    assert len(of_cells["upper"]) == 5 and of_cells["upper"].argmax() == 4
    for cutoff, expected in (("0.1", 1), ("0.5", 0)):
        code, distance_of_both, low, high = read("--cutoff", cutoff)
        assert code == expected and distance_of_both == distance and (low <= high).all()
        assert (low <= upper).all() and (lower <= high).all()


def test_a_picture_shows_the_distance_where_every_vertex_is_on_b(
    hausbench: Program, tmp_path: Path
) -> None:
    """A is a square that shares its corners with a pyramid B, so the distance at each vertex of A
    is 0."""
    a, b, out = tmp_path / "a.off", tmp_path / "b.off", tmp_path / "out.ply"
    a.write_text("OFF\n4 2 0\n0 0 0\n2 0 0\n2 2 0\n0 2 0\n3 0 1 2\n3 0 2 3\n")
    b.write_text(
        "OFF\n5 4 0\n0 0 0\n2 0 0\n2 2 0\n0 2 0\n1 1 1\n3 0 1 4\n3 1 2 4\n3 2 3 4\n3 3 0 4\n"
    )
    done = hausbench("measure", a, b, "--fields", out, "--symmetric", "--json")
    said = json.loads(done.stdout)
    for file, answer, shown in zip(
        (out, tmp_path / "out.back.ply"), said["directions"], said["fields"], strict=True
    ):
        points, cells, of_points, _ = read_by_meshio(file)
        assert (
            shown["file"] == str(file)
            and shown["largest"] == of_points["distance"].max()
            and shown["resolved"]
        )
        assert (
            0.95 * answer["lower"] <= shown["largest"] <= answer["upper"] and answer["lower"] > 0.7
        )
        assert len(points) == shown["vertices"] and len(cells) == shown["pieces"]
        worst = answer["source_point"] if file == out else answer["target_point"]
        assert np.linalg.norm(points - worst, axis=1).min() == 0
    text = hausbench("measure", a, b, "--fields", out, "--resolution", "0.01").stdout
    line = next(line for line in text.splitlines() if line.startswith("fields"))
    assert (
        f"{out}: " in line
        and "largest drawn value 0.70710678" in line
        and "h(A,B) is in [0.707" in line
    )
    for bad in ("0", "-1", "nan"):
        assert "--resolution: must be a number above 0" in hausbench.fails(
            "measure", a, b, "--fields", out, "--resolution", bad
        )


def test_what_cannot_be_written_is_one_line_before_anything_is_read(
    hausbench: Program, tmp_path: Path
) -> None:
    def refused(name: str) -> str:
        line = hausbench.fails(
            "measure",
            tmp_path / "missing.off",
            tmp_path / "missing.off",
            "--fields",
            tmp_path / name,
        )
        assert name in line and "missing.off" not in line
        return line

    for name in ("out", "out.vtu", "out.ply.gz", "ply"):
        assert ".ply or .vtk" in refused(name)
    for extension in (".ply", ".vtk"):
        assert "make it" in refused(f"none/out{extension}")
        (tmp_path / f"folder{extension}").mkdir()
        assert "another place" in refused(f"folder{extension}")
        if os.getuid() != 0:
            (tmp_path / "locked").mkdir(mode=0o500, exist_ok=True)
            assert "another place" in refused(f"locked/out{extension}")


def test_a_surface_has_no_fields_to_write(hausbench: Program, tmp_path: Path) -> None:
    surface = tmp_path / "ball.surface.toml"
    surface.write_text('polynomial = "x^2 + y^2 + z^2 - 1"\nbox = [[-2, 2], [-2, 2], [-2, 2]]\n')
    for name in ("out.ply", "out.vtk"):
        assert "triangulate" in hausbench.fails(
            "measure", surface, surface, "--fields", tmp_path / name
        )


def test_surfaces_have_no_fields(hausbench: Program, experiment: Path, tmp_path: Path) -> None:
    text = (
        experiment.read_text()
        .replace("sphere1", "surface_ball")
        .replace("sphere2", "surface_ball")
        .replace("guthe", "surface_enclosure")
    )
    experiment.write_text(f"fields = true\n{text}")
    file = run(hausbench, experiment, tmp_path)
    assert (
        texts(file, "cases/status") == ["ok"]
        and fields_of(file) == {}
        and texts(file, "cases/fields_check") == ["not checked"]
    )


def test_an_answer_outlives_its_fields(hausbench: Program, tmp_path: Path) -> None:
    """If the fields can no longer be written, the bounds are printed, with a warning and exit code
    1."""
    for name in ("sphere1", "sphere2"):
        assert hausbench("export", name, tmp_path / f"{name}.off").returncode == 0
    out = tmp_path / "out.ply"
    command = [
        "/bin/sh",
        "-c",
        'ulimit -f 100; exec "$0" "$@"',
        hausbench.path,
        "measure",
        str(tmp_path / "sphere1.off"),
        str(tmp_path / "sphere2.off"),
        "--json",
        "--fields",
        str(out),
    ]
    done = subprocess.run(
        command,
        cwd=tmp_path,
        env=hausbench.environment(),
        capture_output=True,
        text=True,
        timeout=60,
    )
    said = json.loads(done.stdout)
    assert (
        done.returncode == 1 and said["status"] == "converged" and said["upper"] > said["lower"] > 0
    ), done
    assert (
        any("not all fields are written" in warning for warning in said["warnings"])
        and not out.exists()
    )
