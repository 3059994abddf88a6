"""The picture of the fastest certified solvers: which take part, which wins, and whether its lead
is separated."""

from __future__ import annotations

from pathlib import Path

import pytest

from analysis import which_solver
from analysis.shared.load import load
from synthetic import ResultFile


def peers(rounds: int = 7, rival: float = 2.0) -> ResultFile:
    """cover takes 1 s and tang `rival` s; sacht takes 0.5 s but misses the tolerance, and cgal
    takes 0.1 s but is not certified."""
    file = ResultFile("mesh_peers")
    for solver, seconds, status, certified in (
        ("cover", 1.0, "ok", 1),
        ("tang", rival, "ok", 1),
        ("sacht", 0.5, "budget", 1),
        ("cgal", 0.1, "ok", 0),
    ):
        file.case(
            solver,
            "near",
            [seconds * (1 + 0.01 * k) for k in range(rounds)],
            lower=0.5,
            upper=0.5,
            status=status,
            certified=certified,
            tolerance=1e-6,
            tolerance_of="diagonal",
            prepare_seconds=0.0,
        )
    return file


def only_cell(file: ResultFile, folder: Path) -> which_solver.Cell:
    (cell,) = which_solver.cells_of(load(file.write(folder)))
    return cell


def test_the_fastest_that_is_certified_and_reached_the_tolerance(tmp_path: Path) -> None:
    cell = only_cell(peers(), tmp_path)
    assert (cell.label, cell.rivals, cell.separated, cell.text) == ("cover", 1, True, "cover 2.0×")
    assert cell.ratio is not None and cell.ratio.value == pytest.approx(2.0, rel=0.05)


@pytest.mark.parametrize(("rounds", "rival"), [(1, 2.0), (7, 1.0)])
def test_what_is_not_separated(tmp_path: Path, rounds: int, rival: float) -> None:
    assert not only_cell(peers(rounds, rival), tmp_path).separated


def test_a_tolerance_that_was_read_off_a_trace_has_no_cell(tmp_path: Path) -> None:
    """tang was not timed at that tolerance, so the fastest solver is unknown."""
    file = peers()
    for case in file.cases:
        if case["label"] == "tang":
            case["from_trace"] = 1
    assert which_solver.cells_of(load(file.write(tmp_path))) == []


def test_a_solver_alone(tmp_path: Path) -> None:
    file = peers()
    file.cases[1]["status"] = "timeout"
    alone = only_cell(file, tmp_path)
    assert (alone.rivals, alone.ratio, alone.text) == (0, None, "cover")


def test_the_fastest_is_ahead_by_the_ratio_that_is_shown(tmp_path: Path) -> None:
    """tang has the lower median, but cover is faster in most rounds and by the ratio that is
    printed."""
    file = ResultFile("mesh_peers")
    for solver, seconds in (
        ("cover", [1.0, 1, 1, 9, 9, 9, 9]),
        ("tang", [8.0, 8, 8, 8, 9.5, 9.5, 9.5]),
    ):
        file.case(
            solver,
            "near",
            seconds,
            lower=0.5,
            upper=0.5,
            certified=1,
            tolerance=1e-6,
            tolerance_of="diagonal",
            prepare_seconds=0.0,
        )
    cell = only_cell(file, tmp_path)
    assert cell.label == "cover" and cell.ratio is not None and cell.ratio.value >= 1


def test_sweeps(tmp_path: Path) -> None:
    """The first seed represents a solver; variants with other parameters take no part."""
    file = peers()
    for seed, seconds in ((1, 0.7), (2, 0.2)):
        file.case(
            "kang",
            "near",
            [seconds] * 7,
            lower=0.5,
            upper=0.5,
            certified=1,
            tolerance=1e-6,
            tolerance_of="diagonal",
            prepare_seconds=0.0,
            variant=f"seed={seed}",
            options={"seed": seed},
        )
    file.case(
        "sampling",
        "near",
        [0.1] * 7,
        lower=0.5,
        upper=0.5,
        certified=1,
        tolerance=1e-6,
        tolerance_of="diagonal",
        prepare_seconds=0.0,
        variant="step=0.1",
        options={"step": 0.1},
    )
    cell = only_cell(file, tmp_path)
    assert (
        (cell.label, cell.rivals) == ("kang", 2)
        and cell.ratio is not None
        and cell.ratio.value == pytest.approx(1 / 0.7, rel=0.05)
    )


def test_written(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert which_solver.main(["--results", str(tmp_path)]) == 0
    assert "nothing to draw" in capsys.readouterr().out and not list(tmp_path.iterdir())
    peers().write(tmp_path)
    assert which_solver.main(["--results", str(tmp_path)]) == 0
    assert "| Meshes | near |" in (tmp_path / "tables" / "which_solver.md").read_text()
    assert (tmp_path / "figures" / "which_solver.png").stat().st_size > 10_000


def test_sizes_of_one_scene_share_a_row_if_one_solver_is_the_fastest(tmp_path: Path) -> None:
    file = ResultFile("scaling_meshes")
    for size, cover, tang in (("1500", 1.0, 2.0), ("2800", 1.0, 4.0), ("5600", 3.0, 2.0)):
        for solver, seconds in (("cover", cover), ("tang", tang)):
            file.case(
                solver,
                f"moved_{size}",
                [seconds] * 7,
                lower=0.5,
                upper=0.5,
                certified=1,
                tolerance=1e-6,
                tolerance_of="diagonal",
                prepare_seconds=0.0,
            )
    first, last = which_solver.rows_of(which_solver.cells_of(load(file.write(tmp_path))))
    assert (first.title, last.title) == ("moved 1500 to 2800", "moved 5600")
    assert (
        which_solver.text_of(first.cells[1e-6]) == "cover 2.0–4.0×"
        and which_solver.text_of(last.cells[1e-6]) == "Tang 2009 1.5×"
    )
