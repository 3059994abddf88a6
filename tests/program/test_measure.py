"""`hausbench measure` on shapes whose distance is known."""

from __future__ import annotations

import json
import os
import signal
import subprocess
from pathlib import Path

import pytest

from conftest import Program
from test_run import wait_for


def measured(hausbench: Program, *arguments: str | Path) -> dict[str, object]:
    done = hausbench("measure", *arguments, "--json")
    assert done.returncode == 0, done.stderr
    result = json.loads(done.stdout)
    assert isinstance(result, dict)
    return result


@pytest.mark.parametrize("solver", ["guthe", "cgal"])
def test_one_direction_and_the_other(hausbench: Program, tetrahedron: Path, raised: Path, solver: str) -> None:
    # The farthest point of the tetrahedron is on its base, 0.25 below the raised base; back, the top is that far above
    # the lower top, and the nearest point to it is there.
    for pair in ((tetrahedron, raised), (raised, tetrahedron)):
        result = measured(hausbench, *pair, "--solver", solver, "--tolerance", "1e-9", "--of", "absolute")
        assert result["solver"] == solver and result["status"] == "converged"
        lower, upper = result["lower"], result["upper"]
        assert isinstance(lower, float) and isinstance(upper, float)
        assert lower <= 0.25 <= upper and upper - lower <= 1e-9


def test_json_has_the_promised_keys(hausbench: Program, tetrahedron: Path, raised: Path) -> None:
    result = measured(hausbench, tetrahedron, raised, "--symmetric")
    for key in (
        "lower upper status source_point target_point solver tolerance prepare_seconds solve_seconds peak_bytes".split()
    ):
        assert key in result
    assert result["tolerance"] == 1e-6 and result["tolerance_of"] == "diagonal"


def test_relative_to_the_lower_bound(hausbench: Program, tetrahedron: Path, raised: Path) -> None:
    result = measured(hausbench, tetrahedron, raised, "--of", "lower", "--tolerance", "1e-3")
    lower, upper = result["lower"], result["upper"]
    assert isinstance(lower, float) and isinstance(upper, float)
    assert upper - lower <= 1e-3 * lower


def test_relative_to_the_longest_side_of_a(hausbench: Program, tmp_path: Path) -> None:
    """Of A's box as loaded, in both directions."""
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
def test_is_it_above(hausbench: Program, tetrahedron: Path, raised: Path, more: tuple[str, ...]) -> None:
    """The distance is 0.25. The tolerance ends nothing: it is far too coarse to tell."""
    for cutoff, code, answer, status in (("0.2", 1, True, "above_cutoff"), ("0.25000001", 0, False, "below_floor"),
                                         ("0.3", 0, False, "below_floor"), ("0", 1, True, "above_cutoff")):
        done = hausbench("measure", tetrahedron, raised, "--cutoff", cutoff, "--tolerance", "1e3", "--json", *more)
        said = json.loads(done.stdout)
        assert done.returncode == code and said["above_cutoff"] is answer and said["status"] == status
    assert "above 0.2? yes" in hausbench("measure", tetrahedron, raised, "--cutoff", "0.2", *more).stdout
    assert "no, it is at most that" in hausbench("measure", tetrahedron, raised, "--cutoff", "0.3", *more).stdout


def test_a_question_that_stays_open(hausbench: Program, tetrahedron: Path, raised: Path) -> None:
    done = hausbench("measure", tetrahedron, raised, "--cutoff", "0.2", "--time-limit", "0")
    assert done.returncode == 3 and "above 0.2? open" in done.stdout
    assert "--cutoff" in hausbench.fails("measure", tetrahedron, raised, "--cutoff", "-1")


def test_point_sets_get_a_point_solver(hausbench: Program, tmp_path: Path) -> None:
    a, b = tmp_path / "a.obj", tmp_path / "b.obj"
    a.write_text("v 0 0 0\nv 3 0 0\n")
    b.write_text("v 0 0 4\n")
    result = measured(hausbench, a, b)
    assert result["solver"] == "earlybreak"
    assert result["lower"] <= 5 <= result["upper"]  # type: ignore[operator]
    assert result["source_point"] == [3, 0, 0] and result["target_point"] == [0, 0, 4]


def test_a_person_is_told_solver_and_tolerance(hausbench: Program, tetrahedron: Path, raised: Path) -> None:
    done = hausbench("measure", tetrahedron, raised)
    assert done.returncode == 0
    assert "guthe" in done.stdout and "1e-06" in done.stdout and "diagonal" in done.stdout and "h(A,B)" in done.stdout


def test_a_name_that_begins_with_a_dash(hausbench: Program, tetrahedron: Path) -> None:
    tetrahedron.rename(tetrahedron.parent / "-dash.off")
    done = hausbench("measure", "--json", "--", "-dash.off", "-dash.off")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["lower"] == 0


def test_no_answer_is_no_success(hausbench: Program, tetrahedron: Path) -> None:
    given = ("--solver", "external", "--set", "lower=(.*)", "--set")
    for command, why in (("false {A} {B}", "exit code 1"), ("echo inf # {A} {B}", "no interval of distances"), ("echo '\xff' # {A} {B}", "no number")):
        done = hausbench("measure", tetrahedron, tetrahedron, *given, "command=" + command, "--json")
        assert done.returncode == 1 and "no answer" in done.stderr
        answer = json.loads(done.stdout)
        assert answer["status"] == "stalled" and why in answer["note"] and answer["upper"] == "inf"
        assert why in hausbench("measure", tetrahedron, tetrahedron, *given, "command=" + command).stdout


def test_list_shows_what_solvers_take(hausbench: Program) -> None:
    solvers = {solver["name"]: solver for solver in json.loads(hausbench("list", "--json").stdout)["solvers"]}
    assert solvers["surface_enclosure"]["source"] == ["surface"] and solvers["naive"]["target"] == ["points"]
    assert "measures surface against surface" in hausbench("list", "surface_enclosure").stdout


def scratch_folders(folder: Path) -> list[str]:
    return [entry.name for entry in folder.iterdir() if entry.name.startswith("hausbench-")]


@pytest.mark.parametrize("end", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
def test_an_interrupted_reader_leaves_nothing(hausbench: Program, tetrahedron: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
                                              end: signal.Signals) -> None:
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    fifo = tmp_path / "fifo.off"
    os.mkfifo(fifo)
    process = subprocess.Popen(hausbench.command("measure", fifo, tetrahedron), env=hausbench.environment(), stderr=subprocess.DEVNULL)
    children = Path(f"/proc/{process.pid}/task/{process.pid}/children")
    wait_for(lambda: bool(scratch_folders(tmp_path)) and bool(children.read_text()))
    reader = Path(f"/proc/{children.read_text().split()[0]}")
    process.send_signal(end)
    assert process.wait(10) == -end
    wait_for(lambda: not reader.exists() or "State:\tZ" in (reader / "status").read_text())
    if end == signal.SIGKILL:  # the next clears up
        assert hausbench("measure", tetrahedron, tetrahedron).returncode == 0
    assert scratch_folders(tmp_path) == []
