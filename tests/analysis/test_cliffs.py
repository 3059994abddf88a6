"""Tests the table `cliffs` on a file with known work, and its experiment file."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import pytest
import synthetic
from stem_runner import Make, stem_runner

from analysis.__main__ import main
from analysis.shared import load, style
from analysis.speed import cliffs, cliffs_picture
from analysis.speed.cliffs_curves import FAMILIES, TOLERANCE, Row, collect

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "experiments" / "speed"


@pytest.fixture()
def make(tmp_path: Path) -> Make:
    return stem_runner(tmp_path)


def test_work_is_relative_to_ratio_1(make: Make) -> None:
    records, rows, _ = make(synthetic.cliffs())
    guthe = {row[0]: row[1:] for row in rows["mesh, stray triangle in B"]}
    # Counts 2000, 20,000 and 200,000 distances: queue pushes are not work.
    assert guthe["Guthe 2005"] == ["2,000", "100", "1e12", "100", "1e12", ""]
    assert guthe["CGAL"][:2] == ["—", "—"] and guthe["CGAL"][3] == "1.00"
    assert rows["points, two clusters"][0][1:4] == ["1,000", "3.00", "1e6"]
    assert (
        rows["mesh, A moved away"][0][-1] == "1 timeout"
        and rows["meshes, two clusters"][0][-1] == "1 precision floor"
    )
    away = [r for r in records if r["family"] == "points_away"]
    assert [float(r["ratio"]) for r in away] == [1.0, 1e6, 1e12]
    stray = [r for r in records if (r["family"], r["label"]) == ("mesh_stray_in_B", "guthe")]
    assert [float(r["work_relative"]) for r in stray] == [1.0, 10.0, 100.0]
    assert [
        float(r["ratio"]) for r in records if r["family"] == "surface_concentric"
    ] == pytest.approx([10.0, 1e8])


def test_verdicts_come_from_the_data(make: Make) -> None:
    _, _, text = make(synthetic.cliffs())
    claim = "at every ratio up to 1e12 is at most 4 times that of ratio 1."
    assert (
        f"closest point work of scan (ours) {claim} Here it holds (in 4 kinds of scene, largest 3.00 times, points, two clusters"
        in text
    )
    assert (
        f"closest point work of Guthe 2005 {claim} Here it does not hold (in 4 kinds of scene, largest 100 times, "
        "mesh, stray triangle in B at ratio 1e12; 1 timeout)"
    ) in text
    assert f"work on a needle triangle of Guthe 2005 {claim} Here it holds" in text
    assert "work of CGAL" not in text and "No counts, only time: CGAL." in text


def away(work: list[int], nodes: list[int], solver: str = "ohd") -> synthetic.ResultFile:
    """A is moved away step by step; `work` and `nodes` are each step's total work and node
    visits."""
    file = synthetic.cliffs()
    for k, (all_work, visited) in enumerate(zip(work, nodes)):
        file.case(
            solver,
            "points_away",
            [0.01],
            lower=0.5,
            upper=0.5,
            pose_index=k,
            options={"seed": 1},
            pose=[1.0, 0, 0, 0, 1, 0, 0, 0, 1, 100.0**k, 0, 0],
            counters={"point_distances": all_work - visited, "node_visits": visited},
        )
    return file


def test_growth_that_ends_is_told_with_its_reason(make: Make) -> None:
    _, _, text = make(away([1000, 9000, 11_010, 11_000, 11_005], [100, 50, 0, 0, 0]))
    assert (
        "points, A moved away: the work of OHD grows 11.0 times and is flat from ratio 1e4 on. There it visits no node"
        in text
    )
    assert "With one seed, so one draw: OHD." in text


@pytest.mark.parametrize(
    ("work", "nodes", "solver", "flat", "why"),
    [
        (
            [1000, 11_000, 11_000, 11_000],
            [100, 0, 0, 10],
            "ohd",
            True,
            False,
        ),  # visits nodes at the last step
        ([1000, 11_000, 11_000, 11_000], [0, 0, 0, 0], "ohd", True, False),  # never visited nodes
        ([1000, 11_000, 11_000, 11_000], [100, 0, 0, 0], "nohd", True, False),
        ([1000, 11_000, 12_000, 13_000], [100, 0, 0, 0], "ohd", False, False),
        ([1000, 3900, 3900, 3900], [100, 0, 0, 0], "ohd", False, False),
    ],
)  # grows too little for a cliff
def test_growth_is_worked_out(
    work: list[int], nodes: list[int], solver: str, flat: bool, why: bool, make: Make
) -> None:
    _, _, text = make(away(work, nodes, solver))
    assert ("and is flat from ratio 100 on." in text) == flat and ("visits no node" in text) == why


def test_the_tree_of_a_peer_counts_distances_alone(make: Make) -> None:
    file = synthetic.cliffs()
    assert "counts only distances" not in make(file)[2]
    file.case(
        "kdtree",
        "points_stray_in_B_1e00",
        [0.01],
        lower=0.5,
        upper=0.5,
        counters={"point_distances": 7},
    )
    assert "k-d tree (nanoflann), a peer, counts only distances, not the nodes and" in make(file)[2]


@pytest.mark.parametrize(("work", "outcome"), [(4000, "holds"), (4001, "does not hold")])
def test_verdict_at_the_limit(work: int, outcome: str) -> None:
    rows = [Row(0, 1.0, 1000.0, 1.0, "ok"), Row(1, 1e12, float(work), 1.0, "ok")]
    assert cliffs.verdict("work", "x", {("needle", "x"): rows}).outcome == outcome


def test_verdict_needs_every_ratio() -> None:
    base = Row(0, 1.0, 1000.0, 1.0, "ok")
    far = Row(1, 1e12, 1000.0, 1.0, "ok")
    lost = Row(1, 1e12, float("nan"), float("nan"), "timeout")
    assert cliffs.verdict("work", "x", {("needle", "x"): [base]}).outcome == "not tested"
    assert cliffs.verdict("work", "x", {("needle", "x"): [base, lost]}).outcome == "does not hold"
    assert cliffs.verdict("work", "x", {("needle", "x"): [far]}).outcome == "not tested"
    slow = Row(0, 1.0, float("nan"), float("nan"), "timeout")
    both = {("mesh_away", "x"): [base, far], ("mesh_stray_in_A", "x"): [slow, far]}
    assert cliffs.verdict("work", "x", both).outcome == "not tested"
    both["mesh_away", "x"].append(Row(2, 1e13, 5000.0, 1.0, "ok"))
    assert cliffs.verdict("work", "x", both).outcome == "does not hold"


def test_figure_draws_a_letter_where_there_is_no_answer(tmp_path: Path) -> None:
    results = load.load(synthetic.cliffs().write(tmp_path))
    curves = collect(results)
    figure = cliffs_picture.draw(
        curves, style.order(zip(results.cases.solver, results.cases.label))
    )
    frames = {ax.get_title(): ax for ax in figure.axes if ax.get_title()}
    assert list(frames) == [family.title for family in FAMILIES.values()]
    away = frames["mesh, A moved away"]
    assert [(text.get_text(), text.xy[0]) for text in away.texts] == [("T", 1e12)]
    assert [1.0, 1e6] in [list(line.get_xdata()) for line in away.lines]
    lines = [
        line for line in frames["mesh, stray triangle in B"].lines if len(line.get_xdata()) == 3
    ]
    assert any(np.allclose(line.get_ydata(), [1, 10, 100]) for line in lines)
    plt.close(figure)


def test_a_scene_of_no_family_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = synthetic.ResultFile("cliffs")
    file.case("scan", "bunny", [1.0], lower=0.5, upper=0.5)
    file.write(tmp_path)
    assert main(["cliffs", "--results", str(tmp_path), "--out", str(tmp_path)]) == 2
    assert "scene 'bunny' belongs to no family" in capsys.readouterr().err


def test_experiment_has_every_family_at_every_ratio() -> None:
    experiment: dict[str, Any] = tomllib.loads((FOLDER / "cliffs.toml").read_text(encoding="utf-8"))
    models = tomllib.loads((ROOT / "datasets" / "manifest.toml").read_text(encoding="utf-8"))[
        "model"
    ]
    scenes = {scene["name"]: scene for scene in experiment["scene"]}
    ratios = [f"1e{k:02}" for k in range(0, 13, 2)]
    for key in FAMILIES:
        if key.endswith("_away"):
            assert scenes[key]["motion"]["file"] == "cliffs_away.txt"
        elif FAMILIES[key].axis == TOLERANCE:
            tolerances = {
                tolerance
                for solver in experiment["solver"]
                if key in solver.get("scenes", [])
                for tolerance in solver.get("tolerances", [])
            }
            assert key in scenes and max(tolerances) > 1e6 * min(tolerances)
        elif not key.startswith("surface"):
            expected = {f"{key}_{ratio}" for ratio in ratios}
            assert {name for name in scenes if name.startswith(key + "_")} == expected
            for ratio in ratios:
                names = [scenes[f"{key}_{ratio}"][side] for side in ("source", "target")]
                moved = [models[name] for name in names if name.endswith(ratio)]
                assert moved and all(
                    float(model.get("distance", model.get("ratio"))) == float(ratio)
                    for model in moved
                )
    poses = np.loadtxt(FOLDER / "cliffs_away.txt")
    assert np.allclose(
        np.linalg.norm(poses[:, 9:], axis=1), [float(ratio) for ratio in ratios], rtol=1e-15
    )
