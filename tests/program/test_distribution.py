"""Statistics of the distance: `measure --distribution`, and experiments with the quantity
`distribution`."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path
from typing import Any

import h5py
import pytest

from program import Program
from test_hostile_results import seal
from test_run import numbers, run, texts

EXPERIMENT = """
title = "statistics"
tolerances = [1e-3]
of = "absolute"
quantity = "distribution"
statistics = ["mean", "quantile 0.95", "within 0.5", "mean pooled"]
repeats = 0
[model.tilted]
source = "file"
path = "tilted.off"
[model.plane]
source = "file"
path = "plane.off"
[[scene]]
name = "plates"
source = "tilted"
target = "plane"
motion = { kind = "translation", from = [0, 0, 0], to = [0, 0, 1], steps = 2, of = "absolute" }
[[solver]]
name = "distribution"
[[solver]]
name = "monte_carlo"
statistics = ["mean"]
tolerances = [1e-2]
[[solver]]
name = "cover"
quantity = "directed"
"""


@pytest.fixture
def plates(tmp_path: Path) -> tuple[Path, Path]:
    """A unit square whose distance to a plane grows evenly from 0 to 1, and the plane, of area
    16."""
    tilted, plane = tmp_path / "tilted.off", tmp_path / "plane.off"
    tilted.write_text("OFF\n4 2 0\n0 0 0\n1 0 1\n1 1 1\n0 1 0\n3 0 1 2\n3 0 2 3\n")
    plane.write_text(
        "OFF\n4 2 0\n-1.5 -1.5 0\n2.5 -1.5 0\n2.5 2.5 0\n-1.5 2.5 0\n3 0 1 2\n3 0 2 3\n"
    )
    return tilted, plane


def around(bounds: dict[str, float], value: float, gap: float = 1e-3) -> bool:
    return (
        bounds["lower"] <= value * (1 + 1e-15)
        and value * (1 - 1e-15) <= bounds["upper"]
        and bounds["upper"] - bounds["lower"] <= gap
    )


def answered(hausbench: Program, *arguments: str | Path) -> dict[str, Any]:
    done = hausbench("measure", *arguments, "--of", "absolute", "--tolerance", "1e-4", "--json")
    assert done.returncode == 0, done.stderr
    answer: dict[str, Any] = json.loads(done.stdout)
    assert (
        answer["solver"] == "distribution"
        and answer["certified"]
        and answer["status"] == "converged"
    )
    return answer


def test_all_statistics_of_one_side(hausbench: Program, plates: tuple[Path, Path]) -> None:
    answer = answered(hausbench, *plates, "--distribution")
    statistics = answer["distribution"]
    assert (
        around(statistics["mean"], 0.5)
        and around(statistics["rms"], 3**-0.5)
        and around(statistics["deviation"], 12**-0.5)
    )
    assert (
        around(statistics["maximum"], 1)
        and around(statistics["quantiles"]["0.5"], 0.5)
        and around(statistics["quantiles"]["0.95"], 0.95)
    )
    assert (answer["lower"], answer["upper"]) == (
        statistics["mean"]["lower"],
        statistics["mean"]["upper"],
    ) and answer["direction"] == "distribution"
    text = hausbench("measure", *plates, "--distribution").stdout
    for word in ("statistics mean", "median", "quantile 0.95", "all within the tolerance"):
        assert word in text
    assert "distance   h(A,B)" not in text
    assert json.loads(hausbench("measure", *plates, "--json").stdout)["distribution"] is None


def test_both_sides(hausbench: Program, plates: tuple[Path, Path]) -> None:
    statistics = answered(hausbench, *plates, "--symmetric", "--statistics", "within 0.25, mean")[
        "distribution"
    ]
    assert around(statistics["share_within"]["0.25"], 0.25) and around(statistics["mean"], 0.5)
    target, pooled = statistics["target"]["mean"], statistics["pooled"]["mean"]
    both = (0.5 + target["lower"]) / 2, (0.5 + target["upper"]) / 2
    assert (
        statistics["mean_of_both"]["mean"]["lower"] <= both[1]
        and statistics["mean_of_both"]["mean"]["upper"] >= both[0]
    )
    area = 2**0.5  # of the tilted square
    assert pooled["lower"] <= (0.5 * area + 16 * target["upper"]) / (16 + area) and pooled[
        "upper"
    ] >= (0.5 * area + 16 * target["lower"]) / (16 + area)
    assert set(statistics) == {
        "mean",
        "share_within",
        "target",
        "larger",
        "mean_of_both",
        "harmonic_mean",
        "pooled",
    }
    text = hausbench("measure", *plates, "--symmetric", "--distribution").stdout
    assert "statistics points of A" in text and "points of A and B together" in text


def test_vertices_count_once_each(hausbench: Program, plates: tuple[Path, Path]) -> None:
    assert around(
        answered(hausbench, *plates, "--statistics", "within 0.25", "--by-vertex")["distribution"][
            "share_within"
        ]["0.25"],
        0.5,
    )


def test_shares_have_no_unit(hausbench: Program, plates: tuple[Path, Path]) -> None:
    answer = answered(hausbench, *plates, "--statistics", "within 0.99999999999")
    assert (
        answer["lower_of_diagonal"] is None
        and answer["upper_of_diagonal"] is None
        and 0.99 < answer["lower"] <= answer["upper"] <= 1
    )
    assert ", 1]" in hausbench("measure", *plates, "--statistics", "within 0.99999999999").stdout


def test_what_samples_cannot_bound_is_refused(
    hausbench: Program, plates: tuple[Path, Path]
) -> None:
    """Otherwise monte_carlo would draw samples for ever, because they give no upper bound on the
    maximum."""
    for arguments, said in (
        (["--distribution"], "leave out 'maximum'"),
        (["--statistics", "quantile 1"], "leave out 'quantile 1'"),
        (["--statistics", "mean", "--symmetric"], "leave out 'mean target'"),
        (["--statistics", "mean", "--by-vertex"], "leave out the weighing by vertex"),
    ):
        line = hausbench.fails("measure", *plates, *arguments, "--solver", "monte_carlo")
        assert "solver 'monte_carlo'" in line and said in line and "'distribution'" in line


def test_monte_carlo_that_is_stopped_keeps_only_whole_batches(
    hausbench: Program, plates: tuple[Path, Path]
) -> None:
    """Half a batch would have only the first triangles of A, so its mean would be too small."""
    done = hausbench(
        "measure",
        *plates,
        "--statistics",
        "mean",
        "--solver",
        "monte_carlo",
        "--tolerance",
        "1e-9",
        "--time-limit",
        "1",
        "--json",
    )
    answer = json.loads(done.stdout)
    assert done.returncode == 0 and answer["status"] == "time_limit", done.stdout
    assert answer["lower"] - 0.02 <= 0.5 <= answer["upper"] + 0.02


def test_many_pairs(hausbench: Program, plates: tuple[Path, Path], tmp_path: Path) -> None:
    (tmp_path / "pairs.csv").write_text("tilted.off, plane.off\nplane.off, missing.off\n")
    done = hausbench(
        "measure",
        "--pairs",
        tmp_path / "pairs.csv",
        "--statistics",
        "mean, quantile 0.95",
        "--symmetric",
    )
    rows = list(csv.DictReader(io.StringIO(done.stdout)))
    assert done.returncode == 1 and [row["status"] for row in rows] == ["converged", "error"]
    assert (
        float(rows[0]["mean_lower"]) <= 0.5 <= float(rows[0]["mean_upper"])
        and float(rows[0]["quantile_0.95_pooled_upper"]) > 0
    )
    assert rows[1]["mean_lower"] == "" and None not in rows[1]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--statistics", "average"], "must be one such as mean, rms"),
        (["--statistics", "mean, quantile 95"], "the level must be above 0 and at most 1"),
        (["--statistics", "within 1mm"], "must be followed by a number, not '1mm'"),
        (["--statistics", "mean pooled"], "leave out 'pooled'; --symmetric"),
        (["--statistics", ""], "name at least one"),
        (["--distribution", "--cutoff", "0.1"], "ask for --statistics 'within 0.1'"),
        (["--distribution", "--fields", "x.ply"], "leave out --distribution"),
        (["--distribution", "--certificate", "x.json"], "leave out --distribution"),
        (["--distribution", "--penetration"], "different quantities"),
        (["--distribution", "--share-tolerance", "0"], "must be a number above 0"),
        (["--distribution", "--solver", "cover"], "computes no statistics"),
        (["--by-vertex"], "add --distribution or --statistics"),
        (["--share-tolerance", "0.1"], "add --distribution or --statistics"),
        (["--solver", "distribution"], "computes statistics of the distance only"),
    ],
)
def test_wrong_options(
    hausbench: Program, plates: tuple[Path, Path], arguments: list[str], said: str
) -> None:
    assert said in hausbench.fails("measure", *plates, *arguments)


def test_an_experiment_has_a_row_for_each_statistic(
    hausbench: Program, plates: tuple[Path, Path], tmp_path: Path
) -> None:
    (tmp_path / "statistics.toml").write_text(EXPERIMENT)
    file = run(hausbench, tmp_path / "statistics.toml", tmp_path / "out")
    solver, statistic, status, quantity = (
        texts(file, f"cases/{name}") for name in ("solver", "statistic", "status", "quantity")
    )
    assert status == ["ok"] * 12, list(zip(solver, statistic, status, texts(file, "cases/reason")))
    assert sorted(set(statistic)) == ["", "mean", "mean pooled", "quantile 0.95", "within 0.5"]
    for q, s in zip(quantity, statistic, strict=True):
        assert (q == "distribution") == (s != "")
    assert (
        set(texts(file, "cases/lower_check")) == {"holds"} == set(texts(file, "cases/upper_check"))
    )
    lower, upper, pose = (
        numbers(file, "cases/lower"),
        numbers(file, "cases/upper"),
        numbers(file, "cases/pose_index"),
    )
    expected = {
        ("mean", 0): 0.5,
        ("mean", 1): 1.5,
        ("quantile 0.95", 0): 0.95,
        ("quantile 0.95", 1): 1.95,
        ("within 0.5", 0): 0.5,
        ("within 0.5", 1): 0,
    }
    for i, name in enumerate(statistic):
        if (name, pose[i]) in expected:
            slack = 0.05 if solver[i] == "monte_carlo" else 1e-12
            assert lower[i] - slack <= expected[name, pose[i]] <= upper[i] + slack
    shown = hausbench("show", file).stdout
    assert "plates, quantile 0.95" in shown and "plates, mean pooled" in shown


def test_a_wrong_row_is_found(
    hausbench: Program, plates: tuple[Path, Path], tmp_path: Path
) -> None:
    (tmp_path / "statistics.toml").write_text(EXPERIMENT)
    file = run(hausbench, tmp_path / "statistics.toml", tmp_path / "out")
    row = texts(file, "cases/statistic").index("quantile 0.95")
    with h5py.File(file, "r+") as h5:
        for name in ("lower", "upper"):
            h5["cases"][name][row] = 0.9
    seal(file)
    done = hausbench("verify", file)
    assert done.returncode == 1 and "which samples do not explain" in done.stdout + done.stderr


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ('statistics = ["average"]', "must be one such as mean, rms"),
        ("statistics = []", "'statistics' is empty"),
        ('weigh = "volume"', "'weigh' must be area or number"),
    ],
)
def test_wrong_experiments(
    hausbench: Program, plates: tuple[Path, Path], tmp_path: Path, line: str, said: str
) -> None:
    (tmp_path / "wrong.toml").write_text(
        EXPERIMENT.replace('name = "distribution"', f'name = "distribution"\n{line}')
    )
    assert said in hausbench.fails("explain", tmp_path / "wrong.toml")
    (tmp_path / "none.toml").write_text(
        EXPERIMENT.replace(
            'statistics = ["mean", "quantile 0.95", "within 0.5", "mean pooled"]', ""
        )
    )
    assert "needs 'statistics'" in hausbench.fails("explain", tmp_path / "none.toml")
