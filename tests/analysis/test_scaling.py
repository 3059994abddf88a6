"""Cost against size: exponents, forecasts and shards, on results with known answers."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial import cKDTree
from stem_runner import Make, stem_runner
from synthetic import NAN, ResultFile

from analysis.scaling.growth import Curve, Growth, growth, peak_ratio, short
from analysis.scaling.scaling_billion import shards, widened
from analysis.shared.columns import Floats

SIZES = (1000, 3000, 10_000, 30_000, 100_000, 300_000)


@pytest.fixture
def make(tmp_path: Path) -> Make:
    return stem_runner(tmp_path)


def test_exponent_of_a_power_law_is_its_power() -> None:
    sizes = tuple(map(float, SIZES))
    exact = Growth(sizes, tuple(3e-9 * n**1.5 for n in sizes))
    assert (
        exact.exponent().value == pytest.approx(1.5)
        and exact.exponent().high - exact.exponent().low < 1e-6
    )
    assert exact.at(1e9).value == pytest.approx(3e-9 * 1e9**1.5) and exact.at(
        1e9
    ).high == pytest.approx(exact.at(1e9).low)


def test_intervals_cover_as_often_as_they_say() -> None:
    draws, exponents, forecasts = 400, 0, 0
    random = np.random.default_rng(1)
    sizes = np.array(SIZES, dtype=float)
    for _ in range(draws):
        costs = 1e-8 * sizes**1.2 * np.exp(0.1 * random.standard_normal(len(sizes)))
        grown = Growth(tuple(sizes), tuple(costs))
        exponents += grown.exponent().low <= 1.2 <= grown.exponent().high
        once_more = 1e-8 * 1e7**1.2 * math.exp(0.1 * random.standard_normal())
        forecasts += grown.at(1e7).low <= once_more <= grown.at(1e7).high
    for count in (exponents, forecasts):
        assert 0.92 <= count / draws <= 0.98


def test_few_or_small_costs_tell_nothing() -> None:
    assert not growth([1e3, 1e4], [1.0, 2.0], 0).known
    assert math.isnan(growth([1e3, 1e4], [1.0, 2.0], 0).exponent().value) and math.isnan(
        growth([1e3, 1e4], [1.0, 2.0], 0).at(1e9).high
    )
    told = growth([1e3, 1e4, 1e5, 1e6, 1e7], [1e-6, math.nan, 1e-3, 1e-2, 1e-1], 1e-4)
    assert told.sizes == (1e5, 1e6, 1e7) and told.exponent().value == pytest.approx(1)
    assert growth([1e3, 1e4, 1e5, 1e6, 1e7], [1.0, 20.0, 5.0, 30.0, 300.0], 0).sizes == (
        1e6,
        1e7,
    )  # the longest range without a gap
    assert growth(
        [1e3, 1e4, 1e5], [3.0, 2.0, 1.0], 0, 0
    ).known  # a falling series is used as a whole


def test_a_fixed_part_does_not_flatten_the_line() -> None:
    sizes = [float(n) for n in (*SIZES, 1_000_000, 3_000_000, 10_000_000)]
    grown = growth(sizes, [1.6e-4 + 3.6e-9 * n for n in sizes], 2e-4)
    assert 0.97 < grown.exponent().value <= 1.0
    memory = growth(sizes, [3e5 + 10 * n for n in sizes], 2**20)
    assert memory.at(2e9).low < 2e10 < memory.at(2e9).high


@pytest.mark.parametrize(
    ("n", "said"), [(999, "999"), (2000, "2K"), (405040, "405K"), (2e7, "20M"), (1e9, "1G")]
)
def test_sizes_are_short(n: float, said: str) -> None:
    assert short(n) == said


def of(sizes: tuple[float, ...], peak: tuple[float, ...]) -> Curve:
    none = tuple(math.nan for _ in sizes)
    return Curve("r", "s", "s", (), sizes, none, none, peak, none, ())


def test_memory_is_compared_at_the_largest_size_of_both() -> None:
    ours, rival = of((1e5, 1e6, 1e7), (1e7, 1e8, 1e9)), of((1e5, 1e6), (3e7, 5e8))
    assert peak_ratio(rival, ours) == 5
    assert math.isnan(peak_ratio(None, ours)) and math.isnan(peak_ratio(ours, ours))
    assert math.isnan(peak_ratio(of((1e5,), (1e5,)), ours))  # too little data


def test_shards_fit_and_are_the_fewest() -> None:
    def bytes_of(n: float) -> float:
        return 10 * n

    memory = 12e9
    plan = shards(1e9, 1e-4, memory, bytes_of)
    assert plan is not None and plan.points * (48 + 10) <= memory
    assert plan.points >= 2e9 / plan.tasks and plan.margin == pytest.approx(
        widened(plan.tasks, 1e-4)
    )
    fewer = plan.tasks - max(1, plan.tasks // 20)
    assert 1e9 / fewer * (1 + widened(fewer, 1e-4)) * 58 > memory
    assert shards(1e9, 0.3, memory, bytes_of) is None  # the margin covers nearly all of B
    whole = shards(1e6, 0.3, memory, bytes_of)
    assert whole is not None and whole.tasks == 1 and whole.margin == 1


def widths(points: Floats, cells: int) -> list[Floats]:
    """Splits the points into the cells of a k-d tree, with nearly equal numbers of points."""
    if cells == 1:
        return [points]
    axis = int(np.ptp(points, axis=0).argmax())
    order = points[points[:, axis].argsort()]
    half = len(order) * (cells // 2) // cells
    return widths(order[:half], cells // 2) + widths(order[half:], cells - cells // 2)


@pytest.mark.parametrize("surface", [False, True])
def test_a_margin_takes_in_no_more_points_than_the_plan_says(surface: bool) -> None:
    random = np.random.default_rng(2)
    points = random.random((200_000, 3))
    if surface:
        points = random.standard_normal(points.shape)
        points /= np.linalg.norm(points, axis=1)[:, None]
    diagonal = float(np.linalg.norm(np.ptp(points, axis=0)))
    for cells, margin in ((16, 0.002), (64, 0.01)):
        taken = [
            np.all(
                (points >= cell.min(axis=0) - margin * diagonal)
                & (points <= cell.max(axis=0) + margin * diagonal),
                axis=1,
            ).sum()
            / len(cell)
            for cell in widths(points, cells)
        ]
        assert np.mean(taken) <= widened(cells, margin) * 1.02


@pytest.mark.parametrize("seed", range(6))
def test_the_plan_of_shards_is_exact(seed: int) -> None:
    """Shards give the exact distance even if the margin was estimated too narrow or too wide."""
    random = np.random.default_rng(seed)
    a, b = random.standard_normal((3000, 3)), random.standard_normal((2500, 3)) + [0.3 * seed, 0, 0]
    exact = float(cKDTree(b).query(a)[0].max())

    def answer(cell: Floats, margin: float) -> float:
        low, high = cell.min(axis=0) - margin, cell.max(axis=0) + margin
        near = b[np.all((b >= low) & (b <= high), axis=1)]
        return float(cKDTree(near).query(cell)[0].max()) if len(near) else math.inf

    for margin in (0.01 * exact, 0.5 * exact, exact, 2 * exact):
        done, open_ = [0.0], []
        for cell in widths(a, 7):
            u = answer(cell, margin)
            (done.append(u) if u <= margin else open_.append((u, cell)))
        for u, cell in open_:
            if u > max(done):
                done.append(answer(cell, u))
        assert max(done) == exact


def file_of(stem: str, solvers: dict[str, tuple[float, float]], **columns: Any) -> ResultFile:
    """With n points in A and B together, solving takes c n^p (the middle of three rounds),
    preparing 1e-8 n^1.1. Peaks are 100 n bytes, three times that for the rival. h falls as n^-1/2;
    the diagonal is 2.
    """
    file = ResultFile(stem, meta={"memory_bytes": 24 * 2**30})
    for n in SIZES:
        for i, (solver, (c, p)) in enumerate(solvers.items()):
            middle, ahead = c * (2 * n) ** p, 1e-8 * (2 * n) ** 1.1
            file.case(
                solver,
                f"near {n}",
                [0.9 * middle, middle, 1.5 * middle],
                rounds=3,
                prepare=[ahead] * 3,
                family="near",
                severity=float(n),
                scene_note="two samples; severity: points of each",
                source_elements=n // 2,
                target_elements=2 * n - n // 2,
                prepare_bytes=20 * n,
                peak_bytes=(3 if i else 1) * 200 * n,
                lower=n**-0.5,
                upper=n**-0.5,
                source_diagonal=2.0,
                **columns,
            )
    return file


def test_points(make: Make) -> None:
    file = file_of("scaling_points", {"scan": (1e-8, 1.0), "cgal_kdtree": (1e-7, 1.25)})
    file.case(
        "earlybreak",
        "near 1000",
        [1e-3],
        family="near",
        severity=1000.0,
        source_elements=1000,
        target_elements=1000,
        prepare_seconds=1e-6,
        peak_bytes=10,
        lower=1.0,
        upper=1.0,
    )
    file.case(
        "earlybreak",
        "near 300000",
        family="near",
        severity=3e5,
        source_elements=300_000,
        target_elements=300_000,
        status="timeout",
        reason="not within 2 s",
        lower=0.0,
        upper=1.0,
    )
    records, rows, text = make(file)

    def row_of(name: str) -> list[str]:
        return next(row for row in rows["near"] if row[0].startswith(name))

    scan, rival, early = map(row_of, ("scan", "k-d tree (CGAL)", "EARLYBREAK"))
    assert (
        scan[1] == "2K to 600K"
        and scan[3] == "1.10 [1.10, 1.10]"
        and scan[4:6] == ["9.00", "1.00 [1.00, 1.00]"]
    )
    assert scan[6:8] == ["100", "1.00 [1.00, 1.00]"] and scan[9] == "3.00"
    assert rival[5] == "1.25 [1.25, 1.25]" and rival[9] == "—"
    assert early[1] == "2K to 2K; timeout at 600K" and early[5] == "—"
    assert "near: two samples." in text
    assert {record["status"] for record in records if record["label"] == "earlybreak"} == {
        "ok",
        "timeout",
    }


def test_a_thousand_million_points(make: Make, tmp_path: Path) -> None:
    make(file_of("scaling_points", {"scan": (1e-8, 1.0), "kdtree": (1e-7, 1.0)}))
    text = (tmp_path / "tables" / "scaling_billion.md").read_text(encoding="utf-8")
    scan = next(line for line in text.splitlines() if line.startswith("| near | scan"))
    cells = [cell.strip() for cell in scan.split("|")[1:-1]]
    assert (
        cells[3] == "48.0"
        and cells[4].startswith("200 [")
        and cells[5].startswith("178 [")
        and cells[2].startswith("1.6e-5 [")
    )
    tasks = int(cells[6])
    assert (
        2e9 / tasks * (48 + 100) <= 12 * 2**30 and 2e9 / (tasks - 1) * 148 * 1.01 > 12 * 2**30
    )
    assert "never run" in text
    assert (
        "144 GB, 4.8 min" in text
    )  # 48 GB are read and written to split them, then read by the tasks


def test_shards_are_sized_by_the_upper_ends(make: Make, tmp_path: Path) -> None:
    """Memory and distance scatter about their fitted lines, so shards must be sized by the upper
    ends of both intervals."""
    file = file_of("scaling_points", {"scan": (1e-8, 1.0)})
    for i, case in enumerate(file.cases):
        case["peak_bytes"] = round(case["peak_bytes"] * (1.3, 1 / 1.3)[i % 2])
        case["lower"] = case["upper"] = case["upper"] * (1.3, 1 / 1.3)[i // 2 % 2]
    make(file)
    text = (tmp_path / "tables" / "scaling_billion.md").read_text(encoding="utf-8")
    line = next(line for line in text.splitlines() if line.startswith("| near | scan"))
    cells = [cell.strip() for cell in line.split("|")[1:-1]]
    tasks, memory = int(cells[6]), 12 * 2**30
    sizes = [2.0 * n for n in SIZES]
    peak = growth(sizes, [float(case["peak_bytes"]) for case in file.cases], 2**20)
    margin = growth(sizes, [float(case["upper"]) / 2 for case in file.cases], 0, 0).at(2e9)
    assert margin.high > 1.5 * margin.value and float(cells[8]) == pytest.approx(
        widened(tasks, margin.high), rel=0.01
    )

    def needed(count: int, upper: bool) -> float:
        points = 1e9 / count * (1 + widened(count, margin.high if upper else margin.value))
        at = peak.at(points)
        return points * 48 + (at.high if upper else at.value)

    assert needed(tasks, upper=True) <= memory < needed(tasks - max(1, tasks // 20), upper=True)
    assert (
        needed(round(0.8 * tasks), upper=False) <= memory
    )  # the fitted values alone would allow fewer tasks


def test_a_forecast_without_a_line_has_no_picture(make: Make, tmp_path: Path) -> None:
    picture = tmp_path / "figures" / "scaling_billion.pdf"
    picture.parent.mkdir()
    picture.write_text("an old one", encoding="utf-8")
    file = file_of("scaling_points", {"scan": (1e-8, 1.0)})
    for case in file.cases[2:]:
        case["status"] = "timeout"
    make(file)
    assert not picture.exists()


def test_a_margin_that_takes_in_too_much_is_said(make: Make, tmp_path: Path) -> None:
    file = file_of("scaling_points", {"scan": (1e-8, 1.0)})
    for case in file.cases:
        case["lower"] = case[
            "upper"
        ] = 0.06  # a cell would fit, but its margin takes in thirteen times as many points
    make(file)
    text = (tmp_path / "tables" / "scaling_billion.md").read_text(encoding="utf-8")
    line = next(line for line in text.splitlines() if line.startswith("| near | scan"))
    cells = [cell.strip() for cell in line.split("|")[1:-1]]
    assert cells[2].startswith("0.030 [") and cells[6:] == ["margin too wide", "—", "—", "—"]


def test_no_answers_at_all(make: Make) -> None:
    file = ResultFile("scaling_points")
    file.case(
        "scan",
        "near 1000",
        family="near",
        severity=1000.0,
        status="failed",
        reason="no",
        source_elements=1000,
        target_elements=1000,
    )
    _, rows, _ = make(file)
    assert rows["near"][0][1] == "none; failed at 2K" and rows["near"][0][3] == "—"


def test_meshes(make: Make) -> None:
    file = file_of("scaling_meshes", {"cover": (1e-7, 1.0), "cgal": (1e-6, 1.1)})
    file.case(
        "cgal",
        "near 10",
        [NAN],
        family="near",
        severity=10.0,
        status="signal",
        reason="crashed",
        source_elements=10,
        target_elements=10,
    )
    _, rows, text = make(file)
    assert next(row for row in rows["near"] if row[0].startswith("cover"))[9] == "3.00"
    assert "triangle" in text
