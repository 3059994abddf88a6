"""`hausbench measure` on shapes whose distance is known."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from conftest import Program


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
