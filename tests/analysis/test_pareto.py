"""In which cells (scene and tolerance) a solver is on the Pareto front of gap against time."""

from __future__ import annotations

from pathlib import Path

import pytest
from synthetic import ResultFile

from analysis import pareto
from analysis.shared import load


def cell(
    file: ResultFile,
    scene: str,
    ours: tuple[float, float],
    rival: tuple[float, float],
    spread: float = 0.01,
    certified: int = 1,
) -> None:
    """Adds six rounds of both solvers; `ours` and `rival` are (seconds, gap)."""
    for solver, (seconds, gap), is_certified in (("cover", ours, 1), ("guthe", rival, certified)):
        file.case(
            solver,
            scene,
            [seconds * (1 + spread * (i - 2)) for i in range(6)],
            rounds=6,
            lower=1.0,
            upper=1.0 + gap,
            tolerance=1e-3,
            certified=is_certified,
        )


def cells_of(file: ResultFile, tmp_path: Path) -> list[pareto.Cell]:
    return pareto.cells(load.load(file.write(tmp_path)), "cover")


def test_front(tmp_path: Path) -> None:
    file = ResultFile("error_vs_time")
    cell(file, "faster", (1.0, 2e-4), (2.0, 1e-4))
    cell(file, "closer", (2.0, 1e-4), (1.0, 2e-4))
    cell(file, "beaten", (2.0, 2e-4), (1.0, 1e-4))
    cell(file, "beaten by one of equal gap", (2.0, 1e-4), (1.0, 1e-4))
    cell(file, "uncertified", (2.0, 2e-4), (1.0, 1e-4), certified=0)
    file.case("cover", "failed", status="timeout", tolerance=1e-3)
    cells = cells_of(file, tmp_path)
    assert [bool(x.beaten_by) for x in cells] == [False, False, True, True, False]
    assert [bool(x.rivals) for x in cells] == [False, False, True, True, False]
    line = pareto.judge(cells, "cover (ours)").line()
    assert "does not hold (3 of 5 cells, beaten in 2, not separated in 0)" in line
    assert (
        "beaten by Guthe 2005, 2.00 [2.00, 2.00] times as fast with a gap of 1.0e-4 instead of 0.00020"
        in cells[2].line()
    )


def test_open_where_times_are_not_separated(tmp_path: Path) -> None:
    file = ResultFile("error_vs_time")
    file.case("cover", "x", [1.0, 3.0] * 3, rounds=6, lower=1.0, upper=1.5, tolerance=1e-3)
    file.case("guthe", "x", [2.0, 1.0] * 3, rounds=6, lower=1.0, upper=1.25, tolerance=1e-3)
    cells = cells_of(file, tmp_path)
    assert [len(x.rivals) for x in cells] == [1] and not cells[0].beaten_by
    assert "not separated from Guthe 2005" in cells[0].line()
    assert "Here: not separated (0 of 1 cells" in pareto.judge(cells, "cover (ours)").line()


def test_holds_and_without_data(tmp_path: Path) -> None:
    file = ResultFile("error_vs_time")
    cell(file, "faster", (1.0, 2e-4), (2.0, 1e-4))
    assert (
        "Here it holds (1 of 1 cells"
        in pareto.judge(cells_of(file, tmp_path), "cover (ours)").line()
    )
    assert "not tested" in pareto.judge([], "cover (ours)").line()


def test_points_are_no_cells(tmp_path: Path) -> None:
    file = ResultFile("error_vs_time")
    cell(file, "faster", (1.0, 2e-4), (2.0, 1e-4))
    for model in file.models:
        model["kind"] = "points"
    assert cells_of(file, tmp_path) == []


def test_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = ResultFile("error_vs_time")
    cell(file, "beaten", (2.0, 2e-4), (1.0, 1e-4))
    file.write(tmp_path)
    assert pareto.main(["error_vs_time", "--results", str(tmp_path)]) == 0
    assert "does not hold" in capsys.readouterr().out
    assert pareto.main(["other", "--results", str(tmp_path)]) == 2
    assert "hausbench run other.toml" in capsys.readouterr().err
