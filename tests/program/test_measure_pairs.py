"""`measure` of many pairs writes CSV and has one exit code; models are given by name."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path

import pytest

from program import ROOT, Program


@pytest.fixture
def folders(hausbench: Program, tmp_path: Path) -> Path:
    for folder in ("a", "b"):
        (tmp_path / folder).mkdir()
    for name, here, there in (("one", "sphere1", "sphere2"), ("two", "sphere2", "sphere3")):
        assert hausbench("export", here, tmp_path / "a" / f"{name}.off").returncode == 0
        assert hausbench("export", there, tmp_path / "b" / f"{name}.obj").returncode == 0
    return tmp_path


def rows(text: str) -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO(text)))


def test_files_of_one_name_are_a_pair(hausbench: Program, folders: Path) -> None:
    done = hausbench("measure", folders / "a" / "*.off", folders / "b" / "*.obj")
    assert done.returncode == 0, done.stderr
    table = rows(done.stdout)
    assert [(Path(row["A"]).stem, Path(row["B"]).stem) for row in table] == [
        ("one", "one"),
        ("two", "two"),
    ]
    for row in table:
        alone = json.loads(hausbench("measure", row["A"], row["B"], "--json").stdout)
        assert (
            (float(row["lower"]), float(row["upper"])) == (alone["lower"], alone["upper"])
            and row["solver"] == "cover"
            and row["error"] == ""
        )
        assert (
            float(row["tolerance_absolute"])
            == alone["tolerance_absolute"]
            >= float(row["gap"])
            == alone["upper"] - alone["lower"]
            and row["certified"] == "yes"
        )
    assert [
        row["B"]
        for row in rows(
            hausbench("measure", folders / "a" / "*.off", folders / "b" / "one.obj").stdout
        )
    ] == [str(folders / "b" / "one.obj")] * 2
    assert (
        len(rows(hausbench("measure", folders / "a" / "one.off", folders / "b" / "*.obj").stdout))
        == 2
    )


def test_no_cell_is_a_formula(hausbench: Program, folders: Path) -> None:
    """A spreadsheet would run it. The names in the list are those of missing models."""
    listed = folders / "list.csv"
    listed.write_text("=1+1,sphere1\n-2+3,sphere1\n")
    cells = [
        cell
        for row in rows(hausbench("measure", "--pairs", listed).stdout)
        for cell in row.values()
    ]
    assert not any(cell.startswith(("=", "-2+3")) for cell in cells)


def test_one_bad_file_costs_one_line(hausbench: Program, folders: Path) -> None:
    (folders / "a" / "two.off").write_text("OFF\n1 1 0\n0 0 0\n3 0 1 2\n")
    done = hausbench("measure", folders / "a" / "*.off", folders / "b" / "*.obj")
    good, bad = rows(done.stdout)
    assert (
        done.returncode == 1
        and good["status"] == "converged"
        and bad["status"] == "error"
        and "two.off:" in bad["error"]
        and bad["lower"] == ""
    )


def test_a_file_without_a_partner_costs_one_line(hausbench: Program, folders: Path) -> None:
    (folders / "a" / "two.off").rename(folders / "a" / "other.off")
    done = hausbench("measure", folders / "a" / "*.off", folders / "b" / "*.obj")
    table = rows(done.stdout)
    assert done.returncode == 1 and [row["status"] for row in table] == [
        "converged",
        "error",
        "error",
    ]
    assert (Path(table[1]["A"]).name, table[1]["B"], table[2]["A"], Path(table[2]["B"]).name) == (
        "other.off",
        "",
        "",
        "two.obj",
    )
    assert all("--pairs" in row["error"] and None not in row for row in table[1:])


def test_the_worst_place_and_both_directions_are_columns(hausbench: Program, folders: Path) -> None:
    a, b = folders / "a" / "one.off", folders / "b" / "one.obj"
    row = rows(hausbench("measure", folders / "a" / "one*.off", b, "--symmetric").stdout)[0]
    alone = json.loads(hausbench("measure", a, b, "--symmetric", "--json").stdout)
    assert [float(row[f"{side}_{x}"]) for side in ("source", "target") for x in "xyz"] == alone[
        "source_point"
    ] + alone["target_point"]
    assert row["witness_direction"] == alone["witness_direction"]
    there, back = alone["directions"]
    assert [
        float(row[f"{end}_{way}"]) for way in ("a_to_b", "b_to_a") for end in ("lower", "upper")
    ] == [there["lower"], there["upper"], back["lower"], back["upper"]]
    assert rows(hausbench("measure", folders / "a" / "one*.off", b).stdout)[0]["lower_b_to_a"] == ""


def test_names_in_quotes(hausbench: Program, folders: Path) -> None:
    (folders / "a" / "one.off").rename(folders / "a" / 'a, "b" #1.off')
    pairs = folders / "pairs.csv"
    pairs.write_bytes(
        b'\xef\xbb\xbf"a/a, ""b"" #1.off", b/one.obj\r\n"a/two.off" "b/two.obj"  # two\r\n'
    )
    done = hausbench("measure", "--pairs", pairs)
    assert done.returncode == 0, done.stdout
    assert [Path(row["A"]).name for row in rows(done.stdout)] == ['a, "b" #1.off', "two.off"]


def test_every_column_and_key_is_explained(hausbench: Program, folders: Path) -> None:
    text = (ROOT / "docs" / "measure.md").read_text(encoding="utf-8")
    a, b = folders / "a" / "one.off", folders / "b" / "one.obj"
    table = rows(hausbench("measure", folders / "a" / "one*.off", b).stdout)[0]
    keys: set[str] = set(table)

    def collect(value: object) -> None:
        for item in (
            value if isinstance(value, list) else value.values() if isinstance(value, dict) else ()
        ):
            collect(item)
        keys.update(value if isinstance(value, dict) else ())

    collect(
        json.loads(
            hausbench(
                "measure",
                a,
                b,
                "--json",
                "--symmetric",
                "--fields",
                folders / "far.ply",
                "--certificate",
                folders / "proof",
            ).stdout
        )
    )
    collect(json.loads(hausbench("measure", a, folders / "none.off", "--json").stdout))
    assert not [key for key in keys if f"`{key}`" not in text]


def test_a_list_of_pairs_and_a_question(hausbench: Program, folders: Path) -> None:
    pairs = folders / "pairs.csv"
    pairs.write_text(
        "# A, B\na/one.off, b/one.obj\n\nsphere1 sphere2  # models\na/two.off\tb/two.obj\n"
    )
    table = rows(hausbench("measure", "--pairs", pairs).stdout)
    assert len(table) == 3 and table[0]["lower"] == table[1]["lower"] and table[1]["A"] == "sphere1"
    assert {row["quantity"] for row in table} == {"directed"}
    assert (
        rows(hausbench("measure", "--pairs", pairs, "--symmetric").stdout)[0]["quantity"]
        == "symmetric"
    )
    done = hausbench("measure", "--pairs", pairs, "--cutoff", "0.03")
    assert [row["above_cutoff"] for row in rows(done.stdout)] == [
        "yes",
        "yes",
        "no",
    ] and done.returncode == 1
    assert hausbench("measure", "--pairs", pairs, "--cutoff", "0.5").returncode == 0
    pairs.write_text("a/one.off b/one.obj\nalone\n")
    assert "pairs.csv:2: write A" in hausbench.fails("measure", "--pairs", pairs)
    pairs.write_text("\n")
    assert "has no pairs" in hausbench.fails("measure", "--pairs", pairs)


def test_what_does_not_go_together(hausbench: Program, folders: Path) -> None:
    a, b = folders / "a" / "*.off", folders / "b" / "*.obj"
    for option, file in (("--fields", folders / "out.ply"), ("--certificate", folders / "proof")):
        assert "not with several pairs" in hausbench.fails("measure", a, b, option, file)
    assert "no file matches" in hausbench.fails("measure", folders / "a" / "*.stl", b)
    for name in ("one", "two"):
        (folders / "b" / f"{name}.obj").rename(folders / "b" / f"{name}_b.obj")
    assert "no file of" in hausbench.fails("measure", a, b)
    assert "name two shapes" in hausbench.fails("measure", folders / "a" / "one.off")
    assert "name B, too" in hausbench.fails("measure", a)


def test_models_have_names(hausbench: Program, tmp_path: Path) -> None:
    for name in ("sphere1", "sphere2"):
        assert hausbench("export", name, tmp_path / f"{name}.off").returncode == 0
    named = json.loads(hausbench("measure", "sphere1", "sphere2", "--json").stdout)
    files = json.loads(
        hausbench("measure", tmp_path / "sphere1.off", tmp_path / "sphere2.off", "--json").stdout
    )
    assert (named["lower"], named["upper"]) == (files["lower"], files["upper"]) and named["source"][
        "file"
    ] == "sphere1"
    assert named["source_element"] == files["source_element"] >= 0
    assert "did you mean 'sphere1'" in hausbench.fails("measure", "spere1", "sphere2")
    proof = tmp_path / "proof"
    assert hausbench("measure", "sphere1", "sphere2", "--certificate", proof).returncode == 0
    assert hausbench("verify", "--certificate", proof).returncode == 0
    assert "is a certificate: add --certificate" in hausbench.fails("verify", proof)


def test_the_part_of_the_witness(hausbench: Program, tmp_path: Path) -> None:
    a, b = tmp_path / "a.obj", tmp_path / "b.obj"
    triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
    a.write_text(triangle + "v 0 0 5\nv 1 0 5\nv 0 1 5\nf 4 5 6\n")
    b.write_text(triangle)
    said = json.loads(hausbench("measure", a, b, "--json").stdout)
    assert (said["source_element"], said["source_part"], said["target_part"]) == (1, 1, 0)
    assert (said["source"]["parts"], said["target"]["parts"]) == (2, 1)
    text = hausbench("measure", a, b).stdout
    assert (
        "2 connected parts" in text
        and "[element 1 of part 1] on A" in text
        and "[element 0] on B" in text
    )


def test_warnings_stand_in_the_table(hausbench: Program, tmp_path: Path) -> None:
    """One pair has a file that is cut off after its first triangle; the other pair's files differ
    in unit."""
    (tmp_path / "a").mkdir()
    (tmp_path / "b").mkdir()
    whole = "".join(f"v {x} {x * x} 0\n" for x in range(9)) + "f 1 2 3\nf 4 5 6\nf 7 8 9\n"
    (tmp_path / "a" / "one.obj").write_text(whole[: whole.index("f 4") + 1])
    (tmp_path / "b" / "one.obj").write_text(whole)
    (tmp_path / "a" / "two.obj").write_text("v 0 0 0\nv 0.001 0 0\nv 0 0.001 0\nf 1 2 3\n")
    (tmp_path / "b" / "two.obj").write_text(whole)
    done = hausbench("measure", tmp_path / "a" / "*.obj", tmp_path / "b" / "*.obj")
    first, second = rows(done.stdout)
    assert (
        "6 of the 9 vertices of A belong to no triangle" in first["warnings"]
        and "same unit" in second["warnings"]
    )
    assert first["error"] == second["error"] == "" and first["status"] == "converged"
    assert (
        len(
            json.loads(
                hausbench(
                    "measure", tmp_path / "a" / "one.obj", tmp_path / "b" / "one.obj", "--json"
                ).stdout
            )["warnings"]
        )
        == 1
    )
    assert (
        rows(hausbench("measure", tmp_path / "b" / "*.obj", tmp_path / "b" / "*.obj").stdout)[0][
            "warnings"
        ]
        == ""
    )
    (tmp_path / "a" / "two.off").write_text("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
    assert "have the same name" in hausbench.fails(
        "measure", tmp_path / "a" / "*", tmp_path / "b" / "*"
    )


def test_another_unit_is_asked_about(hausbench: Program, tetrahedron: Path, tmp_path: Path) -> None:
    small = tmp_path / "small.off"
    small.write_text("OFF\n3 1 0\n0 0 0\n0.001 0 0\n0 0.001 0\n3 0 1 2\n")
    done = hausbench("measure", tetrahedron, small)
    assert (
        done.returncode == 0
        and "times as large as the other: are both in the same unit?" in done.stdout
    )
    assert "same unit" not in hausbench("measure", tetrahedron, tetrahedron).stdout


def test_errors_are_json_for_programs(
    hausbench: Program, tetrahedron: Path, tmp_path: Path
) -> None:
    done = hausbench("measure", tetrahedron, tmp_path / "none.off", "--json")
    assert done.returncode == 2 and len(done.stderr.splitlines()) == 1
    said = json.loads(done.stdout)
    assert said["exit_code"] == 2 and "none.off" in said["error"]


def test_lists_as_other_programs_write_them(hausbench: Program, folders: Path) -> None:
    """A list with a header, as this program writes it; and two mistakes, each reported with its
    line."""
    file = folders / "pairs.csv"
    file.write_text("A,B\na/one.off,b/one.obj\n")
    table = rows(hausbench("measure", "--pairs", file).stdout)
    assert [row["status"] for row in table] == ["converged"]
    file.write_text("a/one.off,b/one.obj\na/one.off,b/one.obj,0.5\n")
    assert "pairs.csv:2: write A, then a comma, then B, and no more" in hausbench.fails(
        "measure", "--pairs", file
    )
    file.write_bytes("a/one.off,b/one.obj\n".encode("utf-16-le"))
    assert "pairs.csv:1: has a NUL byte" in hausbench.fails("measure", "--pairs", file)
