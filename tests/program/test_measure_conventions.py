"""`hausbench measure`: units and axes that files state, matrices, invalid points, and what the
output says of them."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from program import Program
from test_measure import measured

CORNERS = [(0, 0, 0), (1, 0, 0), (0, 2, 0), (0, 0, 3)]
FACES = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]


def amf(folder: Path, name: str, unit: str | None, scale: float = 1) -> Path:
    vertices = "".join(
        f"<vertex><coordinates><x>{x * scale!r}</x><y>{y * scale!r}</y><z>{z * scale!r}</z></coordinates></vertex>"
        for x, y, z in CORNERS
    )
    triangles = "".join(
        f"<triangle><v1>{a}</v1><v2>{b}</v2><v3>{c}</v3></triangle>" for a, b, c in FACES
    )
    stated = f' unit="{unit}"' if unit else ""
    file = folder / f"{name}.amf"
    file.write_text(
        f'<?xml version="1.0"?><amf{stated}><object id="1"><mesh><vertices>{vertices}</vertices>'
        f"<volume>{triangles}</volume></mesh></object></amf>"
    )
    return file


def off(folder: Path, name: str, scale: float = 1, turned: bool = False) -> Path:
    """Writes the same tetrahedron, scaled; turned: with Y pointing up instead of Z."""
    file = folder / f"{name}.off"
    corners = [(x, z, -y) if turned else (x, y, z) for x, y, z in CORNERS]
    lines = [f"{x * scale!r} {y * scale!r} {z * scale!r}\n" for x, y, z in corners]
    lines += [f"3 {a} {b} {c}\n" for a, b, c in FACES]
    file.write_text("OFF\n4 4 0\n" + "".join(lines))
    return file


def upper(result: dict[str, object]) -> float:
    value = result["upper"]
    assert isinstance(value, float | int)
    return value


def test_the_numbers_count_and_a_note_names_the_unit(hausbench: Program, tmp_path: Path) -> None:
    a, b = amf(tmp_path, "a", "inch"), off(tmp_path, "b")
    result = measured(hausbench, a, b)
    assert upper(result) < 1e-12
    assert result["source"]["unit"] == "inch" and result["target"]["unit"] is None  # type: ignore[index]
    assert any("inch" in note and note.startswith("A: ") for note in result["notes"])  # type: ignore[attr-defined]
    assert "note       A: " in hausbench("measure", a, b).stdout


def test_a_unit_converts_and_rounds_once(hausbench: Program, tmp_path: Path) -> None:
    a, b = amf(tmp_path, "a", "inch"), off(tmp_path, "b", 25.4)
    assert upper(measured(hausbench, a, b, "--unit", "mm")) < 1e-12
    assert upper(measured(hausbench, a, b, "--unit", "cm", "--symmetric")) > 60  # b counts as cm
    exported = tmp_path / "exported.off"
    assert hausbench("export", a, exported, "--unit", "mm").returncode == 0
    assert float(exported.read_text().split()[7]) == 1 * 25.4
    assert upper(measured(hausbench, exported, b)) < 1e-12
    for unit in ("parsec", ""):
        message = hausbench.fails("measure", a, b, f"--unit={unit}") if unit else ""
        assert not unit or ("--unit" in message and "mm" in message)


def test_different_units_are_refused_with_a_remedy(hausbench: Program, tmp_path: Path) -> None:
    a, b = amf(tmp_path, "a", "inch"), amf(tmp_path, "b", "millimeter", 25.4)
    message = hausbench.fails("measure", a, b)
    assert "inch" in message and "--unit mm" in message and "--unit none" in message
    assert upper(measured(hausbench, a, b, "--unit", "mm")) < 1e-12
    assert upper(measured(hausbench, a, b, "--unit", "m")) < 1e-14
    assert upper(measured(hausbench, a, b, "--unit", "none", "--symmetric")) > 60
    rows = hausbench("measure", tmp_path / "?.amf", b, "--unit", "mm")
    assert rows.returncode == 0 and "multiplied by 25.4" in rows.stdout


def test_units_that_are_not_known_are_refused(hausbench: Program, tmp_path: Path) -> None:
    files = {}
    for name, unit in (
        ("px", "x [px],y [px],z [px]"),
        ("furlong", "x/furlong,y/furlong,z/furlong"),
        ("mm", "x [mm],y [mm],z [mm]"),
        ("none", "x,y,z"),
        ("feet", "x [US ft],y [US ft],z [US ft]"),
    ):
        files[name] = tmp_path / f"{name}.csv"
        files[name].write_text(f"{unit}\n3937,0,0\n")
    for target in ("furlong", "mm"):
        message = hausbench.fails("measure", files["px"], files[target])
        assert (
            "is in px" in message
            and f"in {target}" in message
            and "--unit none" in message
            and "--unit mm" not in message
        )
        assert upper(measured(hausbench, files["px"], files[target], "--unit", "none")) == 0
    message = hausbench.fails("measure", files["px"], files["none"], "--unit", "mm")
    assert (
        "px.csv" in message
        and "states the unit 'px', which is not known" in message
        and "--unit none" in message
    )
    for target in ("none", "px"):
        result = measured(hausbench, files["px"], files[target])
        assert upper(result) == 0 and "A: states the unit 'px', which is not known: its numbers count as they stand" in result["notes"]  # type: ignore[operator]
    result = measured(hausbench, files["feet"], files["none"], "--unit", "m")
    assert abs(upper(result) - (3937 - 1200)) < 1e-9


def test_axes_are_turned_on_demand_alone(hausbench: Program, tmp_path: Path) -> None:
    a, b = vrml(tmp_path), off(tmp_path, "b")
    assert upper(measured(hausbench, a, b)) < 1e-12
    turned = measured(hausbench, a, b, "--up", "Y")
    assert upper(turned) < 1e-12  # b counts as Y up
    assert upper(measured(hausbench, a, off(tmp_path, "c", turned=True), "--up", "X")) > 1
    up_z = tmp_path / "z.off"
    assert hausbench("export", a, up_z, "--up", "z").returncode == 0
    assert [float(word) for word in up_z.read_text().split()[4:16]] == [
        0,
        0,
        0,
        1,
        0,
        0,
        0,
        0,
        2,
        0,
        -3,
        0,
    ]


def vrml(folder: Path) -> Path:
    """A VRML file, in which Y points up."""
    file = folder / "a.wrl"
    points = ", ".join(" ".join(map(str, corner)) for corner in CORNERS)
    faces = ", ".join(" ".join(map(str, face)) + " -1" for face in FACES)
    file.write_text(
        "#VRML V2.0 utf8\nShape { geometry IndexedFaceSet { coord Coordinate { point [ "
        + points
        + " ] } coordIndex [ "
        + faces
        + " ] } }\n"
    )
    return file


def test_a_matrix_moves_a_shape(hausbench: Program, tmp_path: Path) -> None:
    a = off(tmp_path, "a")
    matrix = tmp_path / "align.txt"
    matrix.write_text("# rows\n1, 0, 0, 10\n0 1 0 0\n0 0 1 0\n0 0 0 1\n")
    moved = measured(hausbench, a, a, "--transform-target", matrix)
    assert abs(upper(moved) - 10) < 1e-9
    assert any("align.txt" in note for note in moved["notes"])  # type: ignore[attr-defined]
    assert (
        upper(measured(hausbench, a, a, "--transform-target", matrix, "--transform-source", matrix))
        < 1e-12
    )
    for text, words in [
        ("1 2 3", "4 x 4"),
        ("1 0 0 0\n0 1 0 0\n0 0 1 0\n10 0 0 1\n", "last column"),
        ("1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 nan", "4 x 4"),
        ("1e308 1e308 1e308 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n", "largest double"),
    ]:
        matrix.write_text(text)
        message = hausbench.fails("measure", a, a, "--transform-source", matrix)
        assert "align.txt" in message and words in message
    assert "certificate" in hausbench.fails(
        "measure", a, a, "--unit", "mm", "--certificate", tmp_path / "proof"
    )


@pytest.mark.parametrize(
    "factor, words",
    [
        (25.4, "25.4"),
        (1 / 25.4, "25.4"),
        (1000, "1000"),
        (0.1, "10 times"),
        (304.8, "304.8"),
        (25.6, "25.4"),
        (27, None),
        (3, None),
        (1.005, None),
    ],
)
def test_a_common_factor_of_units_is_a_warning(
    hausbench: Program, tmp_path: Path, factor: float, words: str | None
) -> None:
    warnings = measured(hausbench, off(tmp_path, "a"), off(tmp_path, "b", factor))["warnings"]
    assert isinstance(warnings, list)
    assert any("same unit" in warning and (words or "") in warning for warning in warnings) == (
        words is not None
    ), warnings


def test_equal_sizes_far_apart_are_a_warning(hausbench: Program, tmp_path: Path) -> None:
    a = off(tmp_path, "a")
    matrix = tmp_path / "far.txt"
    matrix.write_text("1 0 0 0\n0 1 0 0\n0 0 1 3.5\n0 0 0 1\n")
    apart = measured(hausbench, a, a, "--transform-source", matrix)["warnings"]
    matrix.write_text("1 0 0 0\n0 1 0 0\n0 0 1 2.5\n0 0 0 1\n")
    over = measured(hausbench, a, a, "--transform-source", matrix)["warnings"]
    assert isinstance(apart, list) and any("do not overlap" in warning for warning in apart)
    assert isinstance(over, list) and not any("do not overlap" in warning for warning in over)


def test_points_that_are_not_finite_are_dropped_on_demand(
    hausbench: Program, tmp_path: Path
) -> None:
    cloud, plane = tmp_path / "cloud.xyz", tmp_path / "plane.xyz"
    cloud.write_text("0 0 1\nnan 0 0\n1 0 1\n")
    plane.write_text("0 0 0\n1 0 0\n")
    message = hausbench.fails("measure", cloud, plane)
    assert "line 2" in message and "--drop-invalid" in message
    result = measured(hausbench, cloud, plane, "--drop-invalid")
    assert abs(upper(result) - 1) < 1e-9
    assert result["source"]["dropped_points"] == 1  # type: ignore[index]
    assert "1 point dropped" in hausbench("measure", cloud, plane, "--drop-invalid").stdout


def test_columns_are_for_the_tables_that_need_them(hausbench: Program, tmp_path: Path) -> None:
    wide, plain, mesh = tmp_path / "wide.csv", tmp_path / "plain.xyz", off(tmp_path, "mesh")
    wide.write_text("7,0,0,1\n8,1,0,1\n")
    plain.write_text("0 0 0\n1 0 0\n")
    result = measured(hausbench, wide, plain, "--columns", "2,3,4")
    assert abs(upper(result) - 1) < 1e-9
    assert "B: is read without --columns, which do not fit it" in result["notes"]  # type: ignore[operator]
    assert upper(measured(hausbench, wide, mesh, "--columns", "2,3,4")) < 1 + 1e-9
    assert "--columns" in hausbench.fails("measure", mesh, mesh, "--columns", "2,3,4")
    assert "column" in hausbench.fails("measure", plain, plain, "--columns", "2,3,4")
    assert "column" in hausbench.fails("measure", plain, mesh, "--columns", "2,3,4")
    assert "column" in hausbench.fails("measure", wide, plain)


def test_statistics_of_segments_are_by_length_and_say_so(
    hausbench: Program, tmp_path: Path
) -> None:
    path, point = tmp_path / "path.obj", tmp_path / "point.xyz"
    path.write_text("v 0 0 0\nv 1 0 0\nv 3 0 0\nl 1 2 3\n")
    point.write_text("0 0 0\n")
    result = measured(hausbench, path, point, "--statistics", "mean, within 1")
    mean = result["distribution"]["mean"]  # type: ignore[index]
    assert mean["lower"] <= 1.5 <= mean["upper"] and mean["upper"] - mean["lower"] < 1e-5
    assert any("by length" in note for note in result["notes"])  # type: ignore[attr-defined]
    assert result["source"]["segments"] == 2  # type: ignore[index]
    assert "2 line segments" in hausbench("measure", path, point).stdout


def test_each_format_is_described(hausbench: Program) -> None:
    formats = json.loads(hausbench("list", "--json").stdout)["formats"]
    endings = [ending for entry in formats for ending in entry["endings"]]
    assert len(endings) == len(set(endings)) and {"ply", "glb", "csv", "fbx"} <= set(endings)
    for entry in formats:
        for key in ("title", "reads", "refuses", "unit", "axes", "error"):
            assert entry[key], f"{entry['title']}: {key} is empty"
    assert all(entry["title"] in hausbench("list", "formats").stdout for entry in formats)
    assert hausbench("list", "gltf").stdout == hausbench("list", "glb").stdout
