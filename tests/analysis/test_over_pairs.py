"""Means and wins over pairs, and the two figures of Sacht 2024 that use them, on rows with known
numbers."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from stem_runner import Make, stem_runner
from synthetic import ResultFile, without_bounds

from analysis.sacht2024 import sacht2024_fig10, sacht2024_fig2
from analysis.shared import over_pairs
from analysis.shared.load import load
from analysis.shared.over_pairs import (
    arithmetic_mean,
    geometric_mean,
    mean_at_least,
    on_average,
    share_near,
    shared_wins,
    wins_more,
)
from analysis.shared.estimates import NO_DATA, exact
from analysis.shared.verdicts import FAILS, HOLDS, NOT_JUDGED, OPEN, UNTESTED, Verdict


@pytest.fixture()
def make(tmp_path: Path) -> Make:
    return stem_runner(tmp_path)


def wins(text: str) -> over_pairs.Wins:
    return np.array([c == "w" for c in text], dtype=bool)


def test_means() -> None:
    assert (
        geometric_mean([2.0, 8.0]).value == pytest.approx(4)
        and arithmetic_mean([2.0, 8.0]).value == 5
    )
    mean = arithmetic_mean([1.0, 2.0, 3.0, 4.0])
    # t(0.975, 3) = 3.18245 times the standard error sqrt(5/3) / 2.
    assert mean.low == pytest.approx(2.5 - 3.18245 * math.sqrt(5 / 3) / 2, rel=1e-5)
    turned = geometric_mean([1 / 3, 1 / 5, 2.0])
    straight = geometric_mean([3.0, 5.0, 0.5])
    assert turned.low == pytest.approx(1 / straight.high) and turned.value == pytest.approx(
        1 / straight.value
    )
    assert arithmetic_mean([7.0]).coverage == 0 and not geometric_mean([]).n


@pytest.mark.parametrize(
    ("ratios", "outcome"),
    [
        ([15.0, 20.0, 18.0, 22.0] * 3, HOLDS),
        ([1.0, 1.2, 3.0] * 4, FAILS),
        ([3.0, 90.0, 16.0, 20.0], OPEN),
        ([20.0], NOT_JUDGED),
        ([], UNTESTED),
    ],
)
def test_mean_at_least(ratios: Sequence[float], outcome: str) -> None:
    for mean in (geometric_mean, arithmetic_mean):
        assert mean_at_least("x", mean(ratios), 16, "mean").outcome == outcome


def errors(mean: Any, pairs: int, deviation: float, trials: int = 250) -> int:
    """Counts wrong verdicts: the lognormal ratios' true mean equals the claimed one, so only OPEN
    is right."""
    rng = np.random.default_rng(pairs)
    bar = math.exp(deviation**2 / 2) if mean is arithmetic_mean else 1.0
    return sum(
        mean_at_least(
            "x", mean(np.exp(deviation * rng.standard_normal(pairs))), bar, "mean"
        ).outcome
        != OPEN
        for _ in range(trials)
    )


@pytest.mark.parametrize("mean", [arithmetic_mean, geometric_mean])
def test_mean_at_least_errs_as_seldom_as_it_promises(mean: Any) -> None:
    """5 % of 1,500 verdicts may be errors; more than 101 are then improbable (0.1 %)."""
    counts = {
        (pairs, deviation): errors(mean, pairs, deviation)
        for pairs in (5, 10, 30)
        for deviation in (0.8, 1.5)
    }
    assert sum(counts.values()) <= 101, counts
    assert max(counts.values()) <= 25, counts  # of 250 trials


@pytest.mark.parametrize(
    ("count", "of", "outcome"),
    [
        (750, 1000, HOLDS),
        (500, 1000, FAILS),
        (990, 1000, FAILS),
        (7, 10, OPEN),
        (670, 1000, OPEN),
        (0, 0, UNTESTED),
    ],
)
def test_share_near(count: int, of: int, outcome: str) -> None:
    assert share_near("x", count, of, 0.753, 0.1).outcome == outcome


@pytest.mark.parametrize(
    ("ahead", "behind", "outcome"),
    [
        (["wwwwwwww"], ["........"], HOLDS),
        (["........"], ["wwwwwwww"], FAILS),
        (["wwww...."], ["....wwww"], OPEN),
        (["wwwwwwww"], ["wwwwwwww"], OPEN),
        # Each letter is a pair, w if won. By chance, five wins have p = 1/32; in one of two
        # comparisons, 2/32.
        (["wwwww"], ["....."], HOLDS),
        (["....."], ["wwwww"], FAILS),
        ([".....", "....."], ["wwwww"], FAILS),
        (["....."], ["wwwww", "wwwww", "....."], OPEN),
        (["wwww"], ["...."], OPEN),
        (
            ["wwwwwwww", "wwww...."],
            ["........", "....wwww"],
            OPEN,
        ),  # one of four comparisons is not separated
        ([], ["w"], UNTESTED),
        (["w"], [], UNTESTED),
        ([""], [""], UNTESTED),
    ],
)
def test_wins_more(ahead: list[str], behind: list[str], outcome: str) -> None:
    wins_ahead = {f"a{i}": wins(x) for i, x in enumerate(ahead)}
    wins_behind = {f"b{i}": wins(x) for i, x in enumerate(behind)}
    verdict = wins_more("x", wins_ahead, wins_behind)
    if ahead == [".....", "....."]:  # 2/32 is above 5 %
        outcome = OPEN
    assert verdict.outcome == outcome, verdict


def test_wins_are_shared_within_five_percent_of_the_least() -> None:
    winners = shared_wins(
        {
            "a": [1.0, 1.0, math.nan, math.nan],
            "b": [1.05, 1.06, 3.0, math.nan],
            "c": [2.0, 0.9, 3.1, math.nan],
        }
    )
    assert {name: list(x) for name, x in winners.items()} == {
        "a": [True, False, False, False],
        "b": [True, False, True, False],
        "c": [False, True, True, False],
    }


def fig2(ratios: Sequence[float], work: Sequence[float], late: str = "") -> ResultFile:
    """`ratios` and `work` are Zheng's time and work on each pair, relative to Sacht's. `late` has a
    letter per pair: z if Zheng timed out, s if Sacht did, 2 if both.
    """
    file = ResultFile("sacht2024_fig2", cpu=1.0)
    for i, (ratio, counted) in enumerate(zip(ratios, work)):
        common: dict[str, Any] = {
            "source_elements": 700 * (i + 1),
            "lower": 0.25,
            "upper": 0.25,
            "case_seconds_limit": 180.0,
        }
        for solver, factor, units in (("sacht", 1.0, 1.0), ("zheng", ratio, counted)):
            if i < len(late) and late[i] in (solver[0], "2"):
                file.case(
                    solver, f"mesh {i}", **without_bounds("timeout", "not within 180 s", common)
                )
            else:
                file.case(
                    solver,
                    f"mesh {i}",
                    [0.01 * factor] * 3,
                    rounds=3,
                    prepare_seconds=0.0,
                    counters={
                        "point_triangle_distances": round(1000 * units),
                        "node_visits": round(1000 * units),
                    },
                    **common,
                )
    return file


def verdicts_of(file: ResultFile, folder: Path) -> list[Verdict]:
    results = load(file.write(folder))
    if file.stem == "sacht2024_fig2":
        return sacht2024_fig2.verdicts(sacht2024_fig2.Pairs(results))
    return sacht2024_fig10.verdicts(sacht2024_fig10.Orders(results))


def test_fig2_cells(make: Make) -> None:
    file = fig2([2.0, 8.0, 1.0, 4.0, 99.0], [4.0] * 5, "....z")
    file.case("sacht", "no mesh", status="failed", reason="model 'x': simplify: no manifold")
    file.case("zheng", "no mesh", status="failed", reason="model 'x': simplify: no manifold")
    records, rows, text = make(file)
    header, small, whole = rows["triangles of A"][0], rows["0 to 1,000"][0], rows["all"][0]
    assert small[:3] == ["1", "0", "0"] and small[header.index("geometric mean")] == "2.00"
    assert whole[:3] == ["5", "1", "0"] and whole[header.index("geometric mean")].startswith(
        "2.83 ["
    )
    assert (
        whole[header.index("arithmetic mean")].startswith("3.75 [")
        and whole[header.index("Sacht faster, %")] == "75.0"
    )
    assert (
        whole[header.index("distances: geometric mean")] == "4.00 [4.00, 4.00]"
        and whole[header.index("greatest")] == "8.00"
    )
    assert (
        "Left out: mesh 4 (zheng timeout)." in text
        and "1 pairs have no rows with an answer (no mesh: model 'x'" in text
    )
    assert "stand in for Thingi10K" in text and "CGAL's edge collapse for Blender's" in text
    assert "n = 3 rounds (fresh processes); ratios are paired by round." in text
    assert "The three greatest ratios and the least: mesh 1 8.00 (80.0 against 10.0 ms)" in text
    assert sum(r["scene"] == "no mesh" for r in records) == 1
    assert float(next(r for r in records if r["scene"] == "mesh 3")["ratio"]) == pytest.approx(4)


@pytest.mark.parametrize(
    ("ratios", "work", "late", "expected"),
    [
        (
            [18.0, 20.0, 22.0, 19.0],
            [18.0, 19.0, 20.0, 21.0],
            "",
            (HOLDS, HOLDS, HOLDS, HOLDS, OPEN),
        ),
        ([0.5, 0.6, 0.4, 0.5], [0.5, 0.6, 0.4, 0.5], "", (FAILS, FAILS, FAILS, FAILS, OPEN)),
        ([0.1, 300.0, 0.2, 40.0], [0.1, 300.0, 0.2, 40.0], "", (OPEN, OPEN, OPEN, OPEN, OPEN)),
        ([20.0] * 8, [20.0] * 8, "zzzzzz22", (UNTESTED, UNTESTED, UNTESTED, UNTESTED, HOLDS)),
        ([20.0] * 8, [20.0] * 8, "ssssss22", (UNTESTED, UNTESTED, UNTESTED, UNTESTED, FAILS)),
    ],
)
def test_fig2_verdicts(
    tmp_path: Path, ratios: list[float], work: list[float], late: str, expected: tuple[str, ...]
) -> None:
    verdicts = verdicts_of(fig2(ratios, work, late), tmp_path)
    assert tuple(verdict.outcome for verdict in verdicts[:5]) == expected
    for verdict in verdicts[:4]:
        assert [counted.outcome for counted in verdict.counted.values()] == [verdict.outcome] * 2


@pytest.mark.parametrize(
    ("subdivisions", "outcome"),
    [
        ((80, 70, 60, 50, 40, 30), HOLDS),
        ((30, 40, 50, 60, 70, 80), FAILS),
        ((50, 40, 60, 30, 70, 50), OPEN),
        ((), UNTESTED),
    ],
)
def test_fig2_counts_what_near_pairs_take(
    tmp_path: Path, subdivisions: Sequence[int], outcome: str
) -> None:
    """The distance of pair i is i % of the diagonal; `subdivisions` are counts per triangle of
    A."""
    file = fig2([2.0] * max(1, len(subdivisions)), [2.0] * max(1, len(subdivisions)))
    for i, count in enumerate(subdivisions):
        for case in file.cases[2 * i : 2 * i + 2]:
            case |= {
                "lower": 0.01 * (i + 1),
                "upper": 0.01 * (i + 1),
                "counter_subdivisions": count * case["source_elements"],
            }
    assert verdicts_of(file, tmp_path)[5].outcome == outcome


def test_fig2_time_and_work_are_judged_apart(tmp_path: Path) -> None:
    verdict = verdicts_of(fig2([20.0, 21.0, 22.0, 23.0], [0.5, 0.6, 0.4, 0.5]), tmp_path)[0]
    assert verdict.outcome == HOLDS and {x.outcome for x in verdict.counted.values()} == {FAILS}


@pytest.mark.parametrize("late", ["22", "z2", "s2"])
def test_fig2_is_drawn_with_hardly_a_ratio(make: Make, late: str) -> None:
    make(fig2([2.0, 2.0], [2.0, 2.0], late))


def fig10(costs: Mapping[str, Sequence[float]], unsolved: int = 0) -> ResultFile:
    """`costs` has each order's time and work on each pair; NaN: the budget was spent. On `unsolved`
    more pairs, all orders spend it."""
    file = ResultFile("sacht2024_fig10", cpu=1.0)
    for i in range(len(next(iter(costs.values()))) + unsolved):
        for order, of in costs.items():
            cost = of[i] if i < len(of) else math.nan
            common: dict[str, Any] = {
                "label": "sacht",
                "variant": f"order={order}",
                "options": {"order": order, "max_factor": 1000.0},
                "lower": 0.25,
                "upper": 0.5,
                "case_seconds_limit": 60.0,
            }
            if math.isnan(cost):
                file.case(
                    "sacht",
                    f"mesh {i}",
                    [0.5],
                    status="budget",
                    reason="max_factor was spent",
                    **common,
                )
            else:
                file.case(
                    "sacht",
                    f"mesh {i}",
                    [0.01 * cost],
                    prepare_seconds=0.0,
                    counters={"point_triangle_distances": round(1000 * cost)},
                    **common,
                )
    return file


def test_fig10_cells(make: Make) -> None:
    file = fig10(
        {
            "1": [9.0, math.nan, math.nan, 9.0],
            "3": [1.04, 3.0, 3.0, 3.0],
            "1234": [1.0, 1.0, 1.0, 1.2],
            "4321": [2.0, 2.0, 2.0, 1.0],
        },
        1,
    )
    file.case(
        "sacht",
        "no mesh",
        status="skipped",
        reason="package p was not fetched",
        options={"order": "1"},
        label="sacht",
    )
    records, rows, text = make(file)
    assert rows["1234"][0] == ["100", "1", "0", "75.0", "75.0", "75.0", "best"]
    assert rows["3"][0][:4] == ["100", "1", "0", "25.0"] and rows["3"][0][-1] == "in between"
    assert rows["1"][0][:4] == ["50.0", "3", "0", "0"] and rows["4321"][0][-1] == "—"
    assert "(4 of 5)" in text and "1 pairs have no rows with an answer (no mesh: package p" in text
    assert (
        "stand in for Thingi10K" in text
        and "for TetWild" in text
        and "n = 1" in text
        and "4 of 64 orders were run" in text
    )
    assert [r["wins: time"] for r in records if r["order"] == "3"] == ["1", "0", "0", "0", "0"]


GOOD, SLOW = [1.0] * 8, [2.0] * 8
NEVER = [math.nan] * 8


@pytest.mark.parametrize(
    ("costs", "unsolved", "expected"),
    [
        (
            {"1": NEVER, "2": SLOW, "4": SLOW, "3": [1.5] * 8, "1234": GOOD},
            0,
            (HOLDS, OPEN, HOLDS, OPEN),
        ),
        (
            {"1": SLOW, "2": SLOW, "4": NEVER, "3": GOOD, "1234": GOOD},
            0,
            (OPEN, HOLDS, HOLDS, OPEN),
        ),
        (
            {"1": GOOD, "2": SLOW, "4": SLOW, "3": SLOW, "1234": SLOW},
            0,
            (FAILS, FAILS, FAILS, OPEN),
        ),
        ({"1": GOOD, "1234": [1.0, 2.0] * 4, "3": [2.0, 1.0] * 4}, 0, (OPEN, OPEN, OPEN, OPEN)),
        ({"1": GOOD}, 40, (UNTESTED, UNTESTED, UNTESTED, FAILS)),
        ({"1234": [1.0] * 226, "3": [2.0] * 226}, 74, (HOLDS, UNTESTED, UNTESTED, HOLDS)),
        ({"1": NEVER, "1234": NEVER, "3": NEVER}, 0, (UNTESTED, UNTESTED, UNTESTED, FAILS)),
    ],
)
def test_fig10_verdicts(
    tmp_path: Path, costs: dict[str, list[float]], unsolved: int, expected: tuple[str, ...]
) -> None:
    verdicts = verdicts_of(fig10(costs, unsolved), tmp_path)
    evidence = [verdict.evidence for verdict in verdicts]
    assert tuple(verdict.outcome for verdict in verdicts[:4]) == expected, evidence
    for verdict in verdicts[:3]:
        assert [counted.outcome for counted in verdict.counted.values()] == [verdict.outcome] * 2


@pytest.mark.parametrize(
    ("best", "others", "single", "expected"),
    [
        (GOOD, SLOW, SLOW, (HOLDS, HOLDS)),
        (SLOW, GOOD, SLOW, (FAILS, OPEN)),
        (SLOW, SLOW, GOOD, (FAILS, FAILS)),
        (NEVER, NEVER, NEVER, (UNTESTED, UNTESTED)),
    ],
)
def test_fig10_looks_at_the_ten_best_and_at_cascades(
    tmp_path: Path,
    best: list[float],
    others: list[float],
    single: list[float],
    expected: tuple[str, ...],
) -> None:
    """`single` are the costs of single bounds, `best` of the paper's ten best orders, `others` of
    two more orders."""
    costs = {
        **dict.fromkeys(sacht2024_fig10.SINGLE, 2 * single),
        **dict.fromkeys(sacht2024_fig10.TEN_BEST, 2 * best),
        "21": 2 * others,
        "4321": 2 * others,
    }
    verdicts = verdicts_of(fig10(costs), tmp_path)[4:]
    evidence = [verdict.evidence for verdict in verdicts]
    assert tuple(verdict.outcome for verdict in verdicts) == expected, evidence


def test_fig10_is_drawn_without_a_winner(make: Make) -> None:
    _, rows, _ = make(fig10({"1": NEVER, "1234": NEVER}))
    assert rows["1234"][0][0] == "—"


def test_fig2_draws_no_bound_for_a_pair_that_was_not_stopped_by_the_clock(tmp_path: Path) -> None:
    file = fig2([2.0, 2.0, 2.0], [2.0, 2.0, 2.0], "z")
    common: dict[str, Any] = {"source_elements": 9000, "case_seconds_limit": 180.0}
    file.case("sacht", "large", [0.01], lower=0.25, upper=0.25, **common)
    file.case("zheng", "large", **without_bounds("out_of_memory", "more than 8192 MB", common))
    pairs = sacht2024_fig2.Pairs(load(file.write(tmp_path)))
    assert pairs.count_unfinished("zheng") == 2
    hollow = [line for line in sacht2024_fig2.draw(pairs).axes[0].lines if line.get_marker() == "^"]
    assert [list(line.get_xdata()) for line in hollow] == [[700]] and list(
        hollow[0].get_ydata()
    ) == [pytest.approx(180 / 0.01)]


@pytest.mark.parametrize(
    ("ratios", "bar", "outcome"),
    [
        (
            [2.0, 3.0, 0.9, 4.0, 5.0, 2.0],
            1.0,
            HOLDS,
        ),  # one ratio below 1 does not refute an average
        ([0.5, 0.3, 1.1, 0.2, 0.4, 0.5], 1.0, FAILS),
        ([0.5, 2.0, 0.5, 2.0], 1.0, OPEN),
        ([1.0, 1.0, 1.0], 1.0, OPEN),
        ([20.0, 30.0, 25.0, 15.0], 10.0, HOLDS),
        ([2.0, 3.0, 2.5, 2.0], 4.38, FAILS),
        ([2.0], 1.0, NOT_JUDGED),
        ([], 1.0, UNTESTED),
    ],
)
def test_on_average(ratios: list[float], bar: float, outcome: str) -> None:
    assert on_average("x", [exact(x) for x in ratios], bar).outcome == outcome


def test_on_average_is_open_where_a_pair_has_no_ratio() -> None:
    verdict = on_average("x", [exact(2.0), exact(3.0), exact(2.5), NO_DATA])
    assert verdict.outcome == OPEN and verdict.evidence.endswith("over 3 pairs, no ratio for 1")
