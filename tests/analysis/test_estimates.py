"""Compares statistics with values computed by hand from the binomial distribution, and with those
of the program."""

import json
import math
import subprocess
from pathlib import Path

import numpy as np
import pytest
import scipy.stats
from synthetic import ResultFile

from analysis import schema
from analysis.shared.load import load
from analysis.shared.estimates import (
    Estimate,
    by_round,
    coverage_of_rank,
    exact,
    median,
    order_statistic_rank,
    paired_ratio,
    ratio_by_round,
    ratio_of_counts,
    ratio_of_medians,
    simes,
)


@pytest.mark.parametrize(
    ("n", "rank"),
    [(1, 0), (5, 0), (6, 1), (8, 1), (9, 2), (11, 2), (12, 3), (15, 4), (20, 6), (25, 8)],
)
def test_ranks_are_those_of_published_tables(n: int, rank: int) -> None:
    assert order_statistic_rank(n, 0.95) == rank


def test_rank_is_the_largest_that_covers() -> None:
    for n in range(6, 200):
        k = order_statistic_rank(n, 0.95)
        assert coverage_of_rank(n, k) >= 0.95 > coverage_of_rank(n, k + 1)


def test_median_of_nine() -> None:
    x = median([9, 1, 8, 2, 7, 3, 6, 4, 5])
    assert (x.value, x.low, x.high, x.n) == (5, 2, 8, 9)
    assert x.coverage == pytest.approx(1 - 2 * (1 + 9) / 512)


def test_median_of_an_even_number() -> None:
    assert median([1, 2, 3, 10]).value == 2.5


def test_the_program_gives_the_same_intervals(tmp_path: Path) -> None:
    """`hausbench show` computes its intervals in harness/record/estimates.cpp."""
    if not schema.program().is_file():
        pytest.skip("the program is not built")
    rng, file = np.random.default_rng(20), ResultFile("intervals")
    for n in range(2, 61):
        file.case("naive", f"{n} times", list(rng.exponential(size=n)), lower=0.5, upper=0.5)
    path = file.write(tmp_path)
    done = subprocess.run(
        [schema.program(), "show", "--json", path],
        cwd=schema.ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    rows, results = json.loads(done.stdout)["rows"], load(path)
    assert len(rows) == 59
    for case, row in enumerate(rows):
        ours = median(list(results.solve_by_round(case).values()))
        assert [
            row[name]
            for name in ("solve_seconds", "solve_seconds_low", "solve_seconds_high", "times")
        ] == [ours.value, ours.low, ours.high, ours.n]
        assert row["confidence"] == pytest.approx(ours.coverage, abs=1e-12)


def test_few_repeats_take_the_range_and_say_so() -> None:
    x = median([3, 1, 2])
    assert (x.value, x.low, x.high) == (2, 1, 3)
    assert x.coverage == pytest.approx(0.75)


def test_one_repeat_has_no_interval() -> None:
    x = median([2.5])
    assert x.value == 2.5 and x.n == 1 and not x.has_interval and not x.separated


def test_no_repeats() -> None:
    assert median([]).n == 0 and math.isnan(median([]).value)


def test_nan_is_refused() -> None:
    with pytest.raises(ValueError):
        median([1.0, math.nan])


def test_infinite_outliers_do_not_move_the_median() -> None:
    assert median([1, 2, 3, 4, math.inf]).value == 3


def test_ratio_of_separate_times() -> None:
    # Each side gets 97.5 %, so 1.25 % per tail. For n = 9, rank 2 has a tail of P(Binomial(9, 1/2)
    # <= 1) = 10/512 >
    # 1.25 %; hence rank 1.
    assert order_statistic_rank(9, 0.975) == 1
    x = ratio_of_medians(range(11, 20), range(1, 10))
    assert (x.value, x.low, x.high) == (15 / 5, 11 / 9, 19 / 1)
    assert x.coverage == pytest.approx(1 - 4 / 512)
    assert x.separated


def test_ratio_that_is_not_separated() -> None:
    x = ratio_of_medians(
        [1.0, 1.1, 1.2, 0.9, 1.05, 1.0, 1.0], [1.0, 1.05, 0.95, 1.1, 1.0, 1.2, 0.9]
    )
    assert x.low <= 1 <= x.high and not x.separated


def test_ratio_without_an_interval_is_not_separated() -> None:
    x = ratio_of_medians([10.0], [1.0])
    assert x.value == 10 and not x.has_interval and not x.separated


def test_ratio_without_data() -> None:
    assert ratio_of_medians([], [1.0]).n == 0


def test_pairing_takes_out_what_both_share() -> None:
    slow = [1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0]  # a disturbance that slows down both sides
    a = [1.1 * x for x in slow]
    assert not ratio_of_medians(a, slow).separated
    paired = paired_ratio(a, slow)
    assert paired.separated
    assert (paired.value, paired.low, paired.high) == pytest.approx((1.1, 1.1, 1.1))


def test_rounds_are_paired_by_their_number() -> None:
    a = {i: 3.0 * i for i in range(1, 9)}
    b = {i: 1.0 * i for i in range(8, 0, -1)}
    x = ratio_by_round(a, b)
    assert x.value == pytest.approx(3) and x.n == 8 and x.separated
    assert ratio_by_round({0: 1.0}, {1: 1.0}).n == 0


def test_separated_takes_six_rounds() -> None:
    for n in range(1, 10):
        x = ratio_by_round(dict.fromkeys(range(n), 2.0), dict.fromkeys(range(n), 1.0))
        assert x.value == 2 and x.separated == (n >= 6), n
        # Separate times need seven rounds, because each side gets half of the allowed error.
        assert ratio_of_medians([2.0] * n, [1.0] * n).separated == (n >= 7), n
    assert (
        not Estimate(2.0, 1.5, 2.5, 5, 0.94).separated
        and Estimate(2.0, 1.5, 2.5, 5, 0.95).separated
    )


@pytest.mark.parametrize("n", range(2, 13))
def test_equal_distributions_are_seldom_separated(n: int) -> None:
    """At most 5 % of 400 trials, plus chance. Without the check of coverage, it would be a half at
    n = 2 and a quarter at n = 3."""
    rng = np.random.default_rng(n)
    separations = [
        (paired_ratio(a, b).separated, ratio_of_medians(a, b).separated)
        for a, b in np.exp(0.01 * rng.standard_normal((400, 2, n)))
    ]
    of_pairs, of_medians = np.sum(separations, axis=0)
    assert of_pairs <= 30 and of_medians <= 30
    if n in (6, 9):  # the test would also pass if nothing were ever separated
        assert (
            sum(
                paired_ratio(a, b).separated
                for a, b in np.exp(0.01 * rng.standard_normal((400, 2, n)))
            )
            > 2
        )


@pytest.mark.parametrize("rounds", [6, 8, 10, 12])
def test_intervals_cover_where_processes_differ(rounds: int) -> None:
    """Processes differ by 1 %, repeats in one by 0.3 %. With a value per process (round), the
    interval covers the median; with one per repeat, it misses far too often.
    """
    rng, repeats, trials = np.random.default_rng(rounds), 5, 600
    covered = {"rounds": 0, "repeats": 0}
    for _ in range(trials):
        times = np.exp(
            0.01 * rng.standard_normal((rounds, 1)) + 0.003 * rng.standard_normal((rounds, repeats))
        )
        numbers = np.repeat(np.arange(rounds), repeats)
        for unit, values in (
            ("rounds", list(by_round(numbers, times.ravel()).values())),
            ("repeats", times.ravel()),
        ):
            x = median(np.asarray(values))
            covered[unit] += x.low <= 1 <= x.high
    assert covered["rounds"] >= 0.93 * trials and covered["repeats"] < 0.8 * trials


def test_one_number_a_round() -> None:
    assert by_round([0, 0, 0, 2, 2], [1.0, 9.0, 2.0, 4.0, 6.0]) == {0: 2.0, 2: 5.0}


def test_chances_are_those_of_sign_tests() -> None:
    x = paired_ratio([2.0] * 7 + [0.5, 1.0], [1.0] * 9)
    assert x.p_above == pytest.approx(scipy.stats.binomtest(7, 9, alternative="greater").pvalue)
    assert x.p_below == pytest.approx(scipy.stats.binomtest(1, 9, alternative="greater").pvalue)
    # For separate times, p is the level at which the intervals part: 1/2^7 on either side.
    slower = [2.0 + i for i in range(7)]
    y = ratio_of_medians(slower, [0.1 * i for i in range(1, 8)])
    assert y.p_above == pytest.approx(2 * 2.0**-7) and y.p_below == 1


def test_counts_are_exact_but_for_seeds() -> None:
    x = ratio_of_counts({0: 30.0}, {0: 20.0})
    assert (x.value, x.low, x.high, x.separated) == (1.5, 1.5, 1.5, True)
    assert not exact(1.0).separated and exact(math.nan).n == 0
    seeds = {seed: 10.0 + seed for seed in range(6)}
    y = ratio_of_counts({0: 60.0}, seeds, (False, True))
    assert y.n == 6 and (y.low, y.high) == pytest.approx((4.0, 6.0)) and y.separated
    assert ratio_of_counts(seeds, {0: 60.0}, (True, False)).value == pytest.approx(
        1 / y.value, rel=1e-2
    )
    assert ratio_of_counts(
        {s: 2 * x for s, x in seeds.items()}, seeds, (True, True)
    ).low == pytest.approx(2)
    assert ratio_of_counts({0: 1.0}, {0: 0.0}).n == 0 and ratio_of_counts({}, seeds).n == 0


@pytest.mark.parametrize("seeded", [(True, False), (False, True), (True, True)])
def test_one_seed_is_one_draw(seeded: tuple[bool, bool]) -> None:
    x = ratio_of_counts({1: 30.0}, {1: 20.0}, seeded)
    assert x.value == pytest.approx(1.5) and x.n == 1 and not x.has_interval and not x.separated
    # One seed stays a single draw, even beside several seeds of the other solver.
    several = {seed: 10.0 + seed for seed in range(6)}
    y = ratio_of_counts({1: 60.0}, several, (True, True))
    assert y.n == 1 and not y.separated and y.value == pytest.approx(60 / 11)
    assert ratio_of_counts({7: 60.0}, several, (True, True)).n == 0


@pytest.mark.parametrize("n", [1, 6, 7, 10])
def test_the_least_chance_is_that_of_rounds_that_all_agree(n: int) -> None:
    for x in (paired_ratio([2.0] * n, [1.0] * n), ratio_of_medians([2.0] * n, [1.0] * n)):
        assert x.p_above == pytest.approx(x.p_least) and (n == 1 or x.p_least < 0.05)


def test_simes() -> None:
    assert simes([0.04]) == 0.04 and simes([]) == 1
    assert simes([0.5, 0.02, 0.03]) == pytest.approx(min(3 * 0.02, 3 * 0.03 / 2, 0.5))
    rng = np.random.default_rng(1)
    assert sum(simes(p) <= 0.05 for p in rng.random((2000, 15))) == pytest.approx(100, abs=30)


def test_pairs_must_match() -> None:
    with pytest.raises(ValueError):
        paired_ratio([1.0, 2.0], [1.0])
    with pytest.raises(ValueError):
        paired_ratio([0.0], [1.0])
