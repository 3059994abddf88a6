"""`hausbench measure` on shapes with known distances."""

from __future__ import annotations

import json
import os
import re
import signal
import struct
import subprocess
import sys
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest

from program import Program
from test_run import wait_for


def measured(hausbench: Program, *arguments: str | Path) -> dict[str, object]:
    done = hausbench("measure", *arguments, "--json")
    assert done.returncode == 0, done.stderr
    result = json.loads(done.stdout)
    assert isinstance(result, dict)
    return result


@pytest.mark.parametrize("solver", ["guthe", "cgal"])
def test_one_direction_and_the_other(
    hausbench: Program, tetrahedron: Path, raised: Path, solver: str
) -> None:
    # The farthest point is on the lower base, 0.25 below the other. In the other direction, it is
    # the raised top, 0.25 above the lower top.
    for pair in ((tetrahedron, raised), (raised, tetrahedron)):
        result = measured(
            hausbench, *pair, "--solver", solver, "--tolerance", "1e-9", "--of", "absolute"
        )
        assert result["solver"] == solver and result["status"] == "converged"
        lower, upper = result["lower"], result["upper"]
        assert isinstance(lower, float) and isinstance(upper, float)
        assert lower <= 0.25 <= upper and upper - lower <= 1e-9


def test_json_has_the_promised_keys(hausbench: Program, tetrahedron: Path, raised: Path) -> None:
    result = measured(hausbench, tetrahedron, raised, "--symmetric")
    for (
        key
    ) in "lower upper status source_point target_point solver tolerance prepare_seconds solve_seconds peak_bytes".split():
        assert key in result
    assert result["tolerance"] == 1e-6 and result["tolerance_of"] == "diagonal"


def test_relative_to_the_lower_bound(hausbench: Program, tetrahedron: Path, raised: Path) -> None:
    result = measured(hausbench, tetrahedron, raised, "--of", "lower", "--tolerance", "1e-3")
    lower, upper = result["lower"], result["upper"]
    assert isinstance(lower, float) and isinstance(upper, float)
    assert upper - lower <= 1e-3 * lower


def test_relative_to_the_longest_side_of_a(hausbench: Program, tmp_path: Path) -> None:
    """The tolerance is relative to the longest side of A's bounding box as loaded, in both
    directions."""
    needle, plate, point = tmp_path / "needle.off", tmp_path / "plate.off", tmp_path / "point.off"
    needle.write_text("OFF\n3 1 0\n0 0 0\n8 0 1\n8 2 0\n3 0 1 2\n")
    plate.write_text("OFF\n3 1 0\n0 0 0\n64 0 0\n0 64 0\n3 0 1 2\n")
    point.write_text("OFF\n3 1 0\n1 1 1\n1 1 1\n1 1 1\n3 0 1 2\n")
    options = ("--of", "longest", "--tolerance", "0.001")
    for more in ((), ("--symmetric",)):
        result = measured(hausbench, needle, plate, *options, *more)
        assert result["tolerance_of"] == "longest" and result["tolerance_absolute"] == 0.001 * 8
        assert result["upper"] - result["lower"] <= 0.001 * 8  # type: ignore[operator]
    assert "of A's longest side 8 (= 0.008)" in hausbench("measure", needle, plate, *options).stdout
    for unit, side in (("longest", "longest side"), ("diagonal", "diagonal")):
        said = hausbench.fails("measure", point, plate, "--of", unit)
        assert f"{point}: its box has no {side}" in said and "--of absolute" in said


@pytest.mark.parametrize("more", [(), ("--symmetric",)])
def test_is_it_above(
    hausbench: Program, tetrahedron: Path, raised: Path, more: tuple[str, ...]
) -> None:
    """The distance is 0.25. The tolerance is too coarse to decide the question, and must not end
    the search."""
    for cutoff, code, answer, status in (
        ("0.2", 1, True, "above_cutoff"),
        ("0.25000001", 0, False, "below_floor"),
        ("0.3", 0, False, "below_floor"),
        ("0", 1, True, "above_cutoff"),
    ):
        done = hausbench(
            "measure",
            tetrahedron,
            raised,
            "--cutoff",
            cutoff,
            "--tolerance",
            "1e3",
            "--json",
            *more,
        )
        said = json.loads(done.stdout)
        assert (
            done.returncode == code and said["above_cutoff"] is answer and said["status"] == status
        )
    name = "H(A,B)" if more else "h(A,B)"
    for cutoff, words in (("0.2", "is above 0.2"), ("0.3", "is at most 0.3")):
        text = hausbench("measure", tetrahedron, raised, "--cutoff", cutoff, *more).stdout
        assert (
            f"\nanswer     {name} {words}\n" in text
            and "because the answer is known" in text
            and "below_floor" not in text
        )


def test_the_unit_of_the_tolerance_is_that_of_the_cutoff(
    hausbench: Program, tmp_path: Path
) -> None:
    """Only if --of is given; with `lower`, a cutoff is a length. A is 4 long, and h = 3."""
    a, b = tmp_path / "a.xyz", tmp_path / "b.xyz"
    a.write_text("0 0 0\n4 0 0\n")
    b.write_text("0 3 0\n4 3 0\n")
    for options, length, code in (
        ((), 0.8, 1),
        (("--of", "absolute"), 0.8, 1),
        (("--of", "lower"), 0.8, 1),
        (("--of", "diagonal"), 3.2, 0),
        (("--of", "longest"), 3.2, 0),
    ):
        done = hausbench("measure", a, b, "--cutoff", "0.8", "--json", *options)
        assert done.returncode == code and json.loads(done.stdout)["cutoff"] == length, options


def test_a_sentence_about_a_cutoff_is_true_to_the_last_digit(
    hausbench: Program, tmp_path: Path
) -> None:
    """What is said is true of the number as printed: h = 5.00000000005 is not at most 5."""
    a, b = tmp_path / "a.xyz", tmp_path / "b.xyz"
    a.write_text("0 0 0\n")
    for x, cutoff, words in (
        ("5.00000000005", "5.00000000006", "at most"),
        ("5", "4.99999999999", "above"),
        ("5", "5.0000000001", "at most"),
    ):
        b.write_text(f"{x} 0 0\n")
        assert (
            f"answer     h(A,B) is {words} {cutoff}\n"
            in hausbench("measure", a, b, "--cutoff", cutoff).stdout
        )


def test_a_shortened_bound_still_holds(hausbench: Program, tmp_path: Path) -> None:
    """The bounds over A's diagonal have six digits; as exact fractions, they contain the
    interval."""
    a, b = tmp_path / "a.xyz", tmp_path / "b.xyz"
    for i in range(1, 31):
        unit = 1e-310 if i > 20 else 1
        a.write_text(f"0 0 0\n{unit * (1 / i + 1)!r} {unit * (i / 7)!r} 0\n")
        b.write_text(f"0 0 {unit * (i / 3)!r}\n")
        done = hausbench("measure", a, b)
        lower, upper = map(Fraction, re.findall(r"in \[([^,]*), ([^\]]*)\]", done.stdout)[0])
        low, high = map(
            Fraction, re.findall(r"  \[([^,]*), ([^\]]*)\] of A's diagonal", done.stdout)[0]
        )
        said: Any = measured(hausbench, a, b)
        diagonal = Fraction(said["source"]["diagonal"])
        assert low <= lower / diagonal <= upper / diagonal <= high, i
        assert Fraction(said["lower_of_diagonal"]) <= Fraction(said["lower"]) / diagonal, i
        assert Fraction(said["upper_of_diagonal"]) >= Fraction(said["upper"]) / diagonal, i


@pytest.mark.parametrize("extension", ["ply", "vtk", "obj"])
def test_the_witness_in_a_file(
    hausbench: Program, tetrahedron: Path, raised: Path, tmp_path: Path, extension: str
) -> None:
    """Both points and the line between them. Our own readers read it as a segment of that
    length."""
    out = tmp_path / f"line.{extension}"
    said: Any = measured(hausbench, raised, tetrahedron, "--witness", out)
    assert said["warnings"] == [] and out.read_text().endswith(
        {"ply": "0 1\n", "vtk": "2 0 1\n", "obj": "l 1 2\n"}[extension]
    )
    line: Any = measured(hausbench, out, tetrahedron)
    assert line["source"]["segments"] == 1 and line["source"]["diagonal"] == pytest.approx(0.25)
    assert line["upper"] <= said["upper"] and line["source_point"] == said["source_point"]
    assert "leave out --distribution" in hausbench.fails(
        "measure", raised, tetrahedron, "--witness", out, "--distribution"
    )
    assert "the same file" in hausbench.fails(
        "measure",
        raised,
        tetrahedron,
        "--witness",
        raised.with_suffix(".obj"),
        "--certificate",
        raised.with_suffix(".obj"),
    )
    assert "end the name with .ply, .vtk or .obj" in hausbench.fails(
        "measure", raised, tetrahedron, "--witness", tmp_path / "line.stl"
    )


def test_a_question_that_stays_open(hausbench: Program, tetrahedron: Path, raised: Path) -> None:
    done = hausbench(
        "measure", tetrahedron, raised, "--cutoff", "0.2", "--time-limit", "0", "--solver", "guthe"
    )
    assert done.returncode == 3 and "answer     h(A,B) may be above or below 0.2" in done.stdout
    assert "--cutoff" in hausbench.fails("measure", tetrahedron, raised, "--cutoff", "-1")


def test_point_sets_get_a_point_solver(hausbench: Program, tmp_path: Path) -> None:
    a, b = tmp_path / "a.obj", tmp_path / "b.obj"
    a.write_text("v 0 0 0\nv 3 0 0\n")
    b.write_text("v 0 0 4\n")
    result = measured(hausbench, a, b)
    assert result["solver"] == "scan" and result["certified"] is True
    assert result["lower"] <= 5 <= result["upper"]  # type: ignore[operator]
    assert result["source_point"] == [3, 0, 0] and result["target_point"] == [0, 0, 4]


@pytest.mark.parametrize("of", ["diagonal", "absolute", "lower"])
def test_both_directions(hausbench: Program, tmp_path: Path, of: str) -> None:
    """h(A,B) = 0, because A is part of B, and h(B,A) = 3. Each direction has its own bounds, status
    and witness, to the full tolerance."""
    a, b = tmp_path / "a.xyz", tmp_path / "b.xyz"
    a.write_text("0 0 0\n4 0 0\n")
    b.write_text("0 0 0\n4 0 0\n4 3 0\n")
    result: Any = measured(hausbench, a, b, "--symmetric", "--of", of)
    forward, backward = result["directions"]
    assert forward["direction"] == "source to target" and forward["status"] == "converged"
    assert forward["lower"] == forward["upper"] == 0 and forward["upper_of_diagonal"] == 0
    assert backward["direction"] == "target to source" and backward["status"] == "converged"
    assert backward["lower"] <= 3 <= backward["upper"] <= backward["lower"] + 4e-6
    assert backward["source_point"] == [4, 0, 0] and backward["target_point"] == [4, 3, 0]
    assert backward["witness_direction"] == "target to source"
    assert (
        result["direction"] == "symmetric"
        and result["lower"] <= 3 <= result["upper"] <= result["lower"] + 4e-6
    )
    assert (
        result["target_point"] == [4, 3, 0] and result["lower_of_diagonal"] == result["lower"] / 4
    )
    lines = hausbench("measure", a, b, "--symmetric", "--of", of).stdout.splitlines()
    for name in ("h(A,B)", "h(B,A)", "H(A,B)"):
        assert sum(f"distance   {name} in [" in line for line in lines) == 1
    assert any("of A's diagonal" in line for line in lines)
    assert any("scan (certified)" in line for line in lines)


def test_the_second_direction_is_not_stopped_by_the_first(
    hausbench: Program, tetrahedron: Path, tmp_path: Path
) -> None:
    """h(B,A) = 0.25 is far below h(A,B) = 5, but must be just as accurate."""
    b = tmp_path / "b.xyz"
    b.write_text("0 0 -0.25\n0 0 1\n")
    result: Any = measured(hausbench, tetrahedron, b, "--symmetric")
    forward, backward = result["directions"]
    assert (
        forward["lower"] > 0.5
        and backward["lower"] <= 0.25 <= backward["upper"] <= backward["lower"] + 2e-6
    )


def test_what_was_measured_is_in_the_answer(
    hausbench: Program, tetrahedron: Path, raised: Path
) -> None:
    result: Any = measured(hausbench, tetrahedron, raised, "--tolerance", "1e-4")
    assert result["certified"] is True and result["warnings"] == []
    source, target = result["source"], result["target"]
    assert source["file"] == str(tetrahedron) and target["file"] == str(raised)
    assert source["elements"] == source["vertices"] == 4 and source["kind"] == "mesh"
    assert source["diagonal"] == pytest.approx(3**0.5) and source["float32"] is False
    assert 0 <= result["upper_of_diagonal"] - result["upper"] / source["diagonal"] < 1e-16
    assert [direction["direction"] for direction in result["directions"]] == ["source to target"]
    assert measured(hausbench, tetrahedron, raised, "--solver", "cgal")["certified"] is False


def test_a_default_tolerance_takes_every_input(hausbench: Program, tmp_path: Path) -> None:
    point, pair, huge, tiny = (
        tmp_path / f"{name}.xyz" for name in ("point", "other", "huge", "tiny")
    )
    point.write_text("1 2 3\n")
    pair.write_text("1 2 3\n1 2 7\n")
    huge.write_text("1.7e308 0 0\n-1.7e308 0 0\n")
    tiny.write_text("0 0 0\n5e-324 0 0\n")
    answer: Any = measured(hausbench, point, pair)
    assert (
        answer["tolerance_of"] == "diagonal of both"
        and answer["tolerance_absolute"] == 4e-6
        and answer["upper_of_diagonal"] is None
    )
    assert (
        "of the diagonal of both shapes 4 (= 4e-06), since A has no extent"
        in hausbench("measure", point, pair).stdout
    )
    none: Any = measured(hausbench, point, point)
    assert (
        none["tolerance_of"] == "absolute"
        and none["tolerance_absolute"] == 1e-6
        and none["upper"] == 0
    )
    assert (
        "(a length, since neither shape has an extent)" in hausbench("measure", point, point).stdout
    )
    assert measured(hausbench, pair, point)["tolerance_of"] == "diagonal"
    for extreme in (huge, tiny):
        assert measured(hausbench, extreme, extreme)["lower"] == 0
    # A point has no extent to which a tolerance could be relative.
    for given in (("--tolerance", "1e-6"), ("--of", "diagonal"), ("--of", "longest")):
        assert "its box has no" in hausbench.fails("measure", point, pair, *given)
    # If the product leaves the range of doubles, the tolerance is the nearest finite positive
    # number.
    for extreme, length in ((huge, sys.float_info.max), (tiny, 5e-324)):
        for of in ("diagonal", "longest"):
            assert (
                measured(
                    hausbench,
                    extreme,
                    extreme,
                    "--tolerance",
                    "0.4" if extreme == tiny else "2",
                    "--of",
                    of,
                )["tolerance_absolute"]
                == length
            )


def stl(x: float) -> bytes:
    corners = struct.pack("<12f", 0, 0, 1, x, 0, 0, x + 1, 0, 0, x, 1, 0)
    return b" " * 80 + struct.pack("<I", 1) + corners + b"\0\0"


def test_coordinates_coarser_than_the_tolerance(hausbench: Program, tmp_path: Path) -> None:
    """Near 5.1e6, consecutive float32 values differ by 0.5."""
    far, near = tmp_path / "far.stl", tmp_path / "near.stl"
    far.write_bytes(stl(5.1e6))
    near.write_bytes(stl(0))
    result: Any = measured(hausbench, far, far)
    assert (
        len(result["warnings"]) == 2
        and "coordinates of A are float32, in steps of up to 0.5" in result["warnings"][0]
    )
    assert result["source"]["float32"] is True and result["source"]["float32_spacing"] == 0.5
    assert (
        "warning    the coordinates of B are float32, in steps of up to 0.5"
        in hausbench("measure", far, far).stdout
    )
    fine: Any = measured(hausbench, far, far, "--tolerance", "1", "--of", "absolute")
    assert fine["warnings"] == [] and measured(hausbench, near, near)["warnings"] == []
    for tolerance, count in (("1e-9", 1), ("1e-6", 0)):
        relative: Any = measured(hausbench, far, near, "--tolerance", tolerance, "--of", "lower")
        assert sum("float32" in warning for warning in relative["warnings"]) == count
    for head, tail in (
        (
            "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n",
            "5100000 0 0\n",
        ),
        ("FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 1\nDATA ascii\n", "5100000 0 0\n"),
    ):
        file = tmp_path / ("a.ply" if head.startswith("ply") else "a.pcd")
        file.write_text(head + tail)
        assert measured(hausbench, file, file, "--tolerance", "0.1", "--of", "absolute")["warnings"]
        file.write_text(head.replace("float", "double").replace("SIZE 4 4 4", "SIZE 8 8 8") + tail)
        assert not measured(hausbench, file, file, "--tolerance", "0.1", "--of", "absolute")[
            "warnings"
        ]


def test_a_witness_that_nobody_computed_is_null(
    hausbench: Program, tetrahedron: Path, raised: Path, tmp_path: Path
) -> None:
    a = tmp_path / "a.xyz"
    a.write_text("1 0 0\n3 0 0\n")
    for pair in ((tetrahedron, raised), (a, a)):
        result = measured(hausbench, *pair, "--time-limit", "0", "--solver", "guthe")
        assert (
            result["status"] == "time_limit"
            and result["source_point"] is None
            and result["target_point"] is None
        )
        assert (
            "\nwitness "
            not in hausbench("measure", *pair, "--time-limit", "0", "--solver", "guthe").stdout
        )


def test_in_this_process_or_another(hausbench: Program, tetrahedron: Path, raised: Path) -> None:
    separate, in_process = (
        measured(hausbench, tetrahedron, raised, "--symmetric", *more)
        for more in ((), ("--in-process",))
    )
    for timed in ("prepare_seconds", "solve_seconds", "peak_bytes"):
        del separate[timed], in_process[timed]
    for result in (separate, in_process):
        for direction in result["directions"]:  # type: ignore[attr-defined]
            del direction["solve_seconds"]
    assert separate == in_process


def test_a_person_is_told_solver_and_tolerance(
    hausbench: Program, tetrahedron: Path, raised: Path
) -> None:
    done = hausbench("measure", tetrahedron, raised)
    assert done.returncode == 0
    assert (
        "cover" in done.stdout
        and "1e-06" in done.stdout
        and "diagonal" in done.stdout
        and "h(A,B)" in done.stdout
    )


def test_a_name_that_begins_with_a_dash(hausbench: Program, tetrahedron: Path) -> None:
    tetrahedron.rename(tetrahedron.parent / "-dash.off")
    done = hausbench("measure", "--json", "--", "-dash.off", "-dash.off")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["lower"] == 0


def test_no_answer_is_no_success(hausbench: Program, tetrahedron: Path) -> None:
    given = ("--solver", "external", "--set", "lower=(.*)", "--set")
    for command, why in (
        ("false {A} {B}", "exit code 1"),
        ("echo inf # {A} {B}", "not an interval of distances"),
        ("echo '\xff' # {A} {B}", "no number"),
    ):
        done = hausbench(
            "measure", tetrahedron, tetrahedron, *given, "command=" + command, "--json"
        )
        assert done.returncode == 1 and "no answer" in done.stderr
        answer = json.loads(done.stdout)
        assert answer["status"] == "stalled" and why in answer["note"] and answer["upper"] == "inf"
        assert (
            why
            in hausbench("measure", tetrahedron, tetrahedron, *given, "command=" + command).stdout
        )


def test_list_shows_what_solvers_take(hausbench: Program) -> None:
    solvers = {
        solver["name"]: solver
        for solver in json.loads(hausbench("list", "--json").stdout)["solvers"]
    }
    assert solvers["surface_enclosure"]["source"] == ["surface"] and solvers["naive"]["target"] == [
        "points"
    ]
    assert "measures surface against surface" in hausbench("list", "surface_enclosure").stdout


def scratch_folders(folder: Path) -> list[str]:
    return [entry.name for entry in folder.iterdir() if entry.name.startswith("hausbench-")]


@pytest.mark.parametrize("end", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
def test_an_interrupted_reader_leaves_nothing(
    hausbench: Program,
    tetrahedron: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    end: signal.Signals,
) -> None:
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    fifo = tmp_path / "fifo.off"
    os.mkfifo(fifo)
    process = subprocess.Popen(
        hausbench.command("measure", fifo, tetrahedron),
        env=hausbench.environment(),
        stderr=subprocess.DEVNULL,
    )
    children = Path(f"/proc/{process.pid}/task/{process.pid}/children")
    wait_for(lambda: bool(scratch_folders(tmp_path)) and bool(children.read_text()))
    reader = Path(f"/proc/{children.read_text().split()[0]}")
    process.send_signal(end)
    assert process.wait(10) == -end
    wait_for(lambda: not reader.exists() or "State:\tZ" in (reader / "status").read_text())
    if end == signal.SIGKILL:  # the next run removes what is left
        assert hausbench("measure", tetrahedron, tetrahedron).returncode == 0
    assert scratch_folders(tmp_path) == []


@pytest.mark.parametrize("solver", ["cover", "scan"])
def test_no_more_workers_than_can_be_used(
    hausbench: Program, tetrahedron: Path, raised: Path, tmp_path: Path, solver: str
) -> None:
    files = [tetrahedron, raised]
    if solver == "scan":
        files = [tmp_path / "a.xyz", tmp_path / "b.xyz"]
        for shift, file in enumerate(files):
            file.write_text("".join(f"{i} {i * 7 % 64} {shift}\n" for i in range(64)))
    peak = {
        threads: int(
            json.loads(
                hausbench(
                    "measure", *files, "--solver", solver, "--threads", str(threads), "--json"
                ).stdout
            )["peak_bytes"]
        )
        for threads in (1, 1024)
    }
    assert peak[1024] <= peak[1] + 16e6, peak


@pytest.mark.parametrize(
    "more",
    [
        ("--fields", "a.off.ply"),
        ("--fields", "b.ply"),
        ("--fields", "link.ply"),
        ("--certificate", "./b.ply"),
        ("--fields", "x.ply", "--certificate", "../{folder}/x.ply"),
        ("--symmetric", "--fields", "a.off.ply"),
    ],
)
def test_no_shape_is_written_over(
    hausbench: Program, tmp_path: Path, more: tuple[str, ...]
) -> None:
    """Outputs must not overwrite A or B, whatever their names, nor each other."""
    for name, model in (
        ("a.off.ply", "sphere1"),
        ("b.ply", "sphere2"),
        ("a.off.back.ply", "sphere2"),
    ):
        assert hausbench("export", model, tmp_path / name).returncode == 0
    (tmp_path / "link.ply").symlink_to("a.off.ply")
    before = {file.name: file.read_bytes() for file in tmp_path.iterdir()}
    b = "a.off.back.ply" if "--symmetric" in more else "b.ply"
    a = "sphere1" if "--symmetric" in more else "a.off.ply"
    assert "is the same file: choose another name" in hausbench.fails(
        "measure", a, b, *(text.format(folder=tmp_path.name) for text in more)
    )
    assert "is the input file" in hausbench.fails("export", "a.off.ply", "link.ply")
    assert {file.name: file.read_bytes() for file in tmp_path.iterdir()} == before


def test_nor_the_file_of_a_model(
    hausbench: Program, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The model is in the manifest, or made from a model whose file it is."""
    root = tmp_path / "root"
    (root / "datasets").mkdir(parents=True)
    scan = root / "datasets" / "scan.ply"
    assert hausbench("export", "sphere1", scan).returncode == 0
    (root / "datasets" / "manifest.toml").write_text(
        '[model.mine]\nsource = "file"\npath = "scan.ply"\n'
        '[model.half]\nsource = "derived"\nfrom = "mine"\noperation = "scale"\nfactor = 0.5\n'
    )
    monkeypatch.setattr(
        Program,
        "environment",
        lambda self: {
            **os.environ,
            "HAUSBENCH_ROOT": str(root),
            "HAUSBENCH_CACHE": str(tmp_path / "cache"),
        },
    )
    before = scan.read_bytes()
    for more in (("--certificate", scan), ("--fields", scan)):
        assert "is the same file" in hausbench.fails("measure", "mine", "half", *more)
        assert "is the same file" in hausbench.fails("measure", "half", "half", *more)
    assert "is the input file" in hausbench.fails("export", "half", scan)
    assert (
        scan.read_bytes() == before
        and hausbench("measure", "mine", "half", "--certificate", tmp_path / "proof").returncode
        == 0
    )


def test_only_regular_files_are_replaced(
    hausbench: Program, tetrahedron: Path, raised: Path, tmp_path: Path
) -> None:
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "one").symlink_to("other")
    (tmp_path / "other").symlink_to("one")
    assert "pipe: is not a regular file" in hausbench.fails(
        "measure", tetrahedron, raised, "--certificate", tmp_path / "pipe"
    )
    assert "one: cannot be written" in hausbench.fails(
        "measure", tetrahedron, raised, "--certificate", tmp_path / "one"
    )
    for option in ("--certificate", "--fields"):
        assert f"{option}: name a file" in hausbench.fails(
            "measure", tetrahedron, raised, option, ""
        )
    (tmp_path / "proof.unfinished").write_text("mine")
    assert (
        hausbench("measure", tetrahedron, raised, "--certificate", tmp_path / "proof").returncode
        == 0
    )
    assert (tmp_path / "proof.unfinished").read_text() == "mine" and (tmp_path / "pipe").is_fifo()
