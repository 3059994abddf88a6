"""Against values worked out by hand from the binomial distribution."""

import math

import pytest

from analysis.statistics import (
    coverage_of_rank,
    median,
    order_statistic_rank,
    paired_ratio,
    ratio_by_round,
    ratio_of_medians,
)


@pytest.mark.parametrize(("n", "rank"), [(1, 0), (5, 0), (6, 1), (8, 1), (9, 2), (11, 2), (12, 3), (15, 4), (20, 6),
                                         (25, 8)])
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
    # 97.5 % for n = 9 is rank 2 too: P(Binomial(9, 1/2) <= 1) = 10/512 = 0.0195 > 0.0125, so rank 1.
    assert order_statistic_rank(9, 0.975) == 1
    x = ratio_of_medians(range(11, 20), range(1, 10))
    assert (x.value, x.low, x.high) == (15 / 5, 11 / 9, 19 / 1)
    assert x.coverage == pytest.approx(1 - 4 / 512)
    assert x.separated


def test_ratio_that_is_not_separated() -> None:
    x = ratio_of_medians([1.0, 1.1, 1.2, 0.9, 1.05, 1.0, 1.0], [1.0, 1.05, 0.95, 1.1, 1.0, 1.2, 0.9])
    assert x.low <= 1 <= x.high and not x.separated


def test_ratio_without_an_interval_is_not_separated() -> None:
    x = ratio_of_medians([10.0], [1.0])
    assert x.value == 10 and not x.has_interval and not x.separated


def test_ratio_without_data() -> None:
    assert ratio_of_medians([], [1.0]).n == 0


def test_pairing_takes_out_what_both_share() -> None:
    slow = [1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0]  # a neighbour that slows down both
    a = [1.1 * x for x in slow]
    assert not ratio_of_medians(a, slow).separated
    paired = paired_ratio(a, slow)
    assert paired.separated
    assert (paired.value, paired.low, paired.high) == pytest.approx((1.1, 1.1, 1.1))


def test_rounds_are_paired_by_their_number() -> None:
    x = ratio_by_round({i: 3.0 * i for i in range(1, 9)}, {i: 1.0 * i for i in range(8, 0, -1)})
    assert x.value == pytest.approx(3) and x.n == 8
    # Six shared rounds are the fewest that reach 95 %.
    assert ratio_by_round(dict.fromkeys(range(6), 2.0), dict.fromkeys(range(1, 9), 1.0)).n == 0
    assert ratio_by_round(dict.fromkeys(range(6), 2.0), dict.fromkeys(range(9), 1.0)).n == 6


def test_pairs_must_match() -> None:
    with pytest.raises(ValueError):
        paired_ratio([1.0, 2.0], [1.0])
    with pytest.raises(ValueError):
        paired_ratio([0.0], [1.0])
