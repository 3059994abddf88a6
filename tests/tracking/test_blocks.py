"""Tests how an experiment file is split into cases, and how a block of measurements is read from a
result."""

from __future__ import annotations

import json
import stat
import subprocess
import tomllib
from pathlib import Path

import h5py
import numpy as np
import pytest

from bench.tracking import blocks
from bench.tracking.blocks import (
    NotMeasured,
    fresh_copy,
    least_of_passes,
    measure,
    measure_kernels,
    read,
)
from bench.tracking.cases import EXPERIMENT, KERNELS, MESH, MOST_CASES, ROOT, Case, cases, chosen
from bench.tracking.counted import BASELINE

PROGRAM = ROOT / "build/release/hausbench"
BENCH = ROOT / "build/release/kernel_bench"
needs_program = pytest.mark.skipif(not PROGRAM.is_file(), reason="the program is not built")
# Only generated models, so nothing has to be fetched.
SMALL = Case(
    "guthe on spheres",
    {
        "title": "t",
        "tolerances": [1e-4],
        "of": "diagonal",
        "repeats": 2,
        "rounds": 1,
        "scene": [{"name": "spheres", "source": "sphere2", "target": "sphere3"}],
        "solver": [{"name": "guthe"}],
    },
)
MOVING = Case(
    "guthe on a turning sphere",
    {
        **SMALL.experiment,
        "scene": [
            {
                "name": "turning",
                "source": "sphere2",
                "target": "sphere2",
                "motion": {"kind": "rotation", "axis": [0, 0, 1], "degrees": 30, "steps": 3},
            }
        ],
    },
)


def test_tracked_cases_are_few_and_cover_every_kind() -> None:
    names = [case.name for case in cases()]
    assert len(names) == len(set(names)) <= MOST_CASES
    assert any(name.startswith("cover, warm on ") for name in names)


WITHOUT_CASE = {"external"}  # its work is that of another program


@needs_program
def test_each_solver_has_a_case() -> None:
    listed = subprocess.run(
        [PROGRAM, "list", "solvers", "--json"], capture_output=True, text=True, check=True, cwd=ROOT
    ).stdout
    solvers = {solver["name"] for solver in json.loads(listed)["solvers"]}
    tracked = {case.experiment["solver"][0]["name"] for case in cases()}
    assert (
        len(solvers) > 20 and not solvers - tracked - WITHOUT_CASE
    ), "add a case to experiments/tracking.toml, then run hausbench track --update REASON"
    counters = tomllib.loads(BASELINE.read_text())["counters"]
    assert counters.keys() == {case.name for case in cases()}


def test_a_case_is_an_experiment_of_its_own() -> None:
    for case in cases():
        assert (
            len(case.experiment["scene"]) == len(case.experiment["solver"]) == 1
            and "scenes" not in case.experiment["solver"][0]
        )
        assert case.experiment["tolerances"] and len(case.models) == 2


def test_too_many_cases_are_refused(tmp_path: Path) -> None:
    file = tmp_path / "tracking.toml"
    file.write_text(
        EXPERIMENT.read_text() + '\n[[solver]]\nname = "kdtree"\nscenes = ["points near"]\n'
    )
    with pytest.raises(ValueError, match=f"{MOST_CASES + 1} cases"):
        cases(file)


def test_a_scene_that_is_not_there_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "tracking.toml"
    file.write_text(
        EXPERIMENT.read_text().replace('scenes = ["points near"]', 'scenes = ["points far"]')
    )
    with pytest.raises(ValueError, match="'points far'"):
        cases(file)


def test_cases_are_chosen_by_how_their_names_begin() -> None:
    names = [case.name for case in chosen(["scan", "guthe on mesh"], cases())]
    assert names == [
        "scan on points nearly equal",
        "scan on points apart",
        "guthe on mesh to its half",
    ]
    assert chosen([], cases()) == cases()
    with pytest.raises(ValueError, match="there is no case 'gute'"):
        chosen(["gute"], cases())


def test_a_pass_over_the_poses_counts_as_a_whole() -> None:
    """Disturbances hit different repeats (passes) of two poses, so each pass takes longer than the
    sum of the poses' minima."""
    rows = np.array([0, 0, 1, 1, 2, 2])
    assert least_of_passes(rows, np.array([1.0, 3, 10, 10, 100, 105])) == 111
    assert least_of_passes(rows, np.array([5.0, 1, 10, 10, 100, 105])) == 115


def result(file: Path, statuses: list[str], repeats: int = 2) -> Path:
    n = len(statuses)
    with h5py.File(file, "w") as out:
        out["cases/status"] = np.array(statuses, dtype=object)
        out["cases/reason"] = np.array(["why"] * n, dtype=object)
        out["cases/prepare_seconds"] = np.full(n, 0.25)
        out["cases/lower"] = np.arange(n, dtype=float)
        out["cases/counter_node_visits"] = np.full(n, 7)
        out["cases/counter_subdivisions"] = np.zeros(n, dtype=int)
        out["repeats/case"] = np.repeat(np.arange(n), repeats)
        out["repeats/cpu_seconds"] = np.tile(np.linspace(2.0, 1.0, repeats) if repeats else [], n)
        out["repeats/wall_seconds"] = np.tile(np.linspace(4.0, 3.0, repeats) if repeats else [], n)
        out["models/sha256"] = np.array(["b", "a"], dtype=object)
    return file


def test_a_result_is_read(tmp_path: Path) -> None:
    block = read(result(tmp_path / "r.h5", ["ok", "ok", "ok"]))
    assert (block.cpu, block.wall, block.prepare, block.lower, block.counters) == (
        3.0,
        9.0,
        0.25,
        2.0,
        {"node_visits": 21, "subdivisions": 0},
    )


def test_the_order_of_the_shapes_does_not_matter(tmp_path: Path) -> None:
    first, second = result(tmp_path / "1.h5", ["ok"]), result(tmp_path / "2.h5", ["ok"])
    with h5py.File(second, "a") as file:
        file["models/sha256"][...] = np.array(["a", "b"], dtype=object)
    assert read(first).shapes == read(second).shapes
    with h5py.File(second, "a") as file:
        file["models/sha256"][...] = np.array(["a", "c"], dtype=object)
    assert read(first).shapes != read(second).shapes


def test_rows_without_an_answer_are_not_measured(tmp_path: Path) -> None:
    with pytest.raises(NotMeasured, match="timeout: why"):
        read(result(tmp_path / "r.h5", ["ok", "timeout"]))
    with pytest.raises(NotMeasured, match="no repeat"):
        read(result(tmp_path / "s.h5", ["ok"], repeats=0))


def test_a_result_that_cannot_be_read_is_not_measured(tmp_path: Path) -> None:
    with pytest.raises(NotMeasured, match="cannot be read"):
        read(tmp_path / "none.h5")
    with h5py.File(tmp_path / "other.h5", "w") as out:
        out["something"] = 1
    with pytest.raises(NotMeasured, match="cannot be read"):
        read(tmp_path / "other.h5")


def script(folder: Path, text: str) -> Path:
    file = folder / "program"
    file.write_text(f"#!/bin/sh\n{text}\n")
    file.chmod(file.stat().st_mode | stat.S_IXUSR)
    return file


def test_a_program_that_does_not_know_the_case(tmp_path: Path) -> None:
    with pytest.raises(NotMeasured, match="exit code 2: unknown solver 'cover'"):
        measure(script(tmp_path, "echo \"unknown solver 'cover'\" >&2; exit 2"), SMALL, tmp_path)
    with pytest.raises(NotMeasured, match="cannot be copied: No such file"):
        measure(tmp_path / "none", SMALL, tmp_path)


def test_each_block_has_a_copy_of_its_program_that_is_gone_afterwards(tmp_path: Path) -> None:
    program = tmp_path / "hausbench"
    program.write_text("#!/bin/sh\necho $0\n")
    program.chmod(0o755)
    (tmp_path / "commit.json").write_text("{}")
    with fresh_copy(program) as first, fresh_copy(program) as second:
        assert (
            first != second
            and first.parent == tmp_path / "again"
            and blocks.run([str(first)], tmp_path) == f"{first}\n"
        )
        assert (first.parent / "commit.json").is_file()
    with fresh_copy(program, tmp_path / "tree") as copy:
        assert (
            copy.parent == tmp_path / "tree" / "build" / "again"
            and (copy.parent / "commit.json").is_file()
        )
    with pytest.raises(NotMeasured), fresh_copy(program):
        raise NotMeasured("why")
    assert [file.name for file in (tmp_path / "again").iterdir()] == ["commit.json"]


def test_a_program_that_hangs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(blocks, "LIMIT", 0.2)
    with pytest.raises(NotMeasured, match="no end within"):
        measure(script(tmp_path, "exec sleep 20"), SMALL, tmp_path)


def test_benchmarks_that_a_build_lacks_are_not_there(tmp_path: Path) -> None:
    runs = [
        {"run_type": "iteration", "run_name": f"build/bvh/{MESH}", "cpu_time": t, "time_unit": "ms"}
        for t in (3.0, 2.0, 4.0)
    ]
    runs.append(
        {
            "run_type": "aggregate",
            "run_name": f"build/bvh/{MESH}",
            "cpu_time": 0.1,
            "time_unit": "ms",
        }
    )
    (tmp_path / "out.json").write_text(json.dumps({"benchmarks": runs}))
    assert measure_kernels(
        script(tmp_path, f"cat {tmp_path}/out.json"), ["build/bvh", "build/rtree"], tmp_path
    ) == {"build/bvh": 0.002}


@needs_program
@pytest.mark.parametrize("case", [SMALL, MOVING], ids=lambda case: str(case.name))
def test_the_program_measures_a_block(case: Case, tmp_path: Path) -> None:
    block = measure(PROGRAM, case, tmp_path)
    assert 0 < block.cpu < 5 and block.counters["node_visits"] > 0 and len(block.shapes) == 12
    assert measure(PROGRAM, case, tmp_path).counters == block.counters
    assert not list(tmp_path.iterdir()), "nothing is left behind"


@pytest.mark.skipif(not BENCH.is_file(), reason="kernel_bench is not built")
def test_kernel_bench_has_every_tracked_kernel(tmp_path: Path) -> None:
    times = measure_kernels(BENCH, [kernel.name for kernel in KERNELS], tmp_path)
    assert set(times) == {kernel.name for kernel in KERNELS}
    assert all(0 < seconds < 1 for seconds in times.values())
