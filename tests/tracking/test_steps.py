"""Tests the detection of steps in a series: planted steps are found in place; noise, drifts and gaps behave as steps.py promises."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from bench.tracking.steps import PENALTY, Step, best_starts, costs_before, levels_of, steps

NAN = math.nan
NOISE, LEAST = 0.02, 0.03  # NOISE is twice the standard deviation of `noisy`


def noisy(n: int, seed: int) -> list[float]:
    return [float(x) for x in np.exp(np.random.default_rng(seed).normal(0, 0.01, n))]


def places(found: list[Step]) -> list[tuple[int, int]]:
    return [(step.before, step.after) for step in found]


@pytest.mark.parametrize("values", [[], [3.0], [2.0, 2.0], [5.0] * 30, [NAN] * 4, [NAN, 1.0, NAN]])
@pytest.mark.parametrize("noise", [0.0, 1e-6, 0.02])
def test_nothing_changes(values: list[float], noise: float) -> None:
    assert steps(values, noise, 0.0) == []


def test_two_values_are_a_step_where_the_noise_does_not_explain_it() -> None:
    assert places(steps([1.0, 1.2], NOISE, LEAST)) == [(0, 1)]
    assert steps([1.0, 1.2], NOISE, LEAST)[0].ratio == pytest.approx(1.2)
    assert steps([1.0, 1.035], NOISE, LEAST) == []  # log 1.035 < 2 * 0.02


def test_steps_have_their_ratio_in_both_directions() -> None:
    found = steps([1.0] * 5 + [2.0] * 4 + [0.5] * 6, NOISE, LEAST)
    assert places(found) == [(4, 5), (8, 9)]
    assert [step.ratio for step in found] == pytest.approx([2.0, 0.25])


def test_least_is_the_same_up_and_down() -> None:
    for ratio, count in ((1.031, 1), (1 / 1.031, 1), (1.029, 0), (1 / 1.029, 0)):
        assert len(steps([1.0] * 6 + [ratio] * 6, 1e-6, LEAST)) == count


def test_a_step_across_a_gap_names_the_measured_values_on_either_side() -> None:
    found = steps([NAN, 1.0, 1.0, NAN, NAN, 3.0, NAN, 3.0, NAN], NOISE, LEAST)
    assert places(found) == [(2, 5)] and found[0].ratio == pytest.approx(3.0)


def test_one_value_far_off_is_two_steps_and_one_a_little_off_is_none() -> None:
    limit = math.exp(2 * PENALTY * NOISE)
    assert places(steps([1.0] * 6 + [1.01 * limit] + [1.0] * 6, NOISE, LEAST)) == [(5, 6), (6, 7)]
    assert steps([1.0] * 6 + [0.99 * limit] + [1.0] * 6, NOISE, LEAST) == []


def test_a_step_at_the_very_last_or_first_value_needs_one_penalty() -> None:
    limit = math.exp(PENALTY * NOISE)
    for factor, count in ((1.01, 1), (0.99, 0)):
        assert places(steps([1.0] * 9 + [factor * limit], NOISE, LEAST)) == [(8, 9)] * count
        assert places(steps([factor * limit] + [1.0] * 9, NOISE, LEAST)) == [(0, 1)] * count


def test_a_value_off_does_not_move_the_ratio_of_a_step() -> None:
    values = [1.0] * 10 + [1.5] * 10
    values[4] = 1.05
    found = steps(values, NOISE, LEAST)
    assert places(found) == [(9, 10)]
    assert found[0].ratio == pytest.approx(1.5)


def test_a_slow_drift_is_told_in_total_and_every_stair_is_large_enough() -> None:
    values = [1.01**i for i in range(30)]
    found = steps(values, NOISE, LEAST)
    assert found and all(step.ratio >= 1 + LEAST - 1e-9 for step in found)
    assert 1.15 < math.prod(step.ratio for step in found) < 1.01**29
    assert steps([1.0005**i for i in range(30)], NOISE, LEAST) == []


def test_counts_have_a_step_wherever_they_change_by_the_least() -> None:
    counts = [1000.0, 1000.0, 1006.0, 1006.0, 1006.0, 900.0, 901.0, 901.0]
    assert places(steps(counts, 1e-4, 0.005)) == [(1, 2), (4, 5)]
    assert places(steps(counts, 1e-4, 0.0005)) == [(1, 2), (4, 5), (5, 6)]
    assert places(steps([1.0, 2.0, 1.0, 2.0], 0.0, 0.005)) == [(0, 1), (1, 2), (2, 3)]


@pytest.mark.parametrize("value", [0.0, -1.0, math.inf])
def test_what_has_no_logarithm_is_refused(value: float) -> None:
    with pytest.raises(ValueError, match="not positive"):
        steps([1.0, value, 1.0], NOISE, LEAST)


def test_planted_steps_of_five_percent_are_found_in_noise_of_one() -> None:
    exact = near = 0
    for seed in range(200):
        values = noisy(20, seed)
        found = steps(values[:10] + [1.05 * x for x in values[10:]], NOISE, LEAST)
        exact += places(found) == [(9, 10)]
        near += len(found) == 1 and abs(found[0].after - 10) <= 1 and abs(found[0].ratio - 1.05) < 0.02
    assert exact >= 190
    assert near >= 195


def test_at_the_last_value_most_are_found() -> None:
    found = [steps([*noisy(19, seed), 1.05 * noisy(20, seed)[-1]], NOISE, LEAST) for seed in range(200)]
    assert sum(places(one) == [(18, 19)] for one in found) >= 150


@pytest.mark.parametrize(("n", "most"), [(8, 2), (13, 4), (40, 2)])
def test_noise_alone_rarely_has_a_step(n: int, most: int) -> None:
    assert sum(bool(steps(noisy(n, seed), NOISE, LEAST)) for seed in range(200)) <= most


def test_without_a_penalty_and_a_least_noise_is_all_steps() -> None:
    assert len(steps(noisy(13, 1), 0.0, 0.0)) == 12


def test_the_fit_is_the_best_of_all() -> None:
    def cost(logs: list[float], starts: list[int]) -> float:
        ends = [*starts[1:], len(logs)]
        return sum(sum(abs(x - level) for x in logs[a:b]) for a, b, level in zip(starts, ends, levels_of(logs, starts))) + 0.04 * len(starts)

    for seed in range(20):
        logs = list(map(float, np.random.default_rng(seed).normal(0, 0.03, 8)))
        every = [[0, *cuts] for k in range(8) for cuts in itertools.combinations(range(1, 8), k)]
        assert cost(logs, best_starts(logs, 0.04)) == pytest.approx(min(cost(logs, starts) for starts in every), abs=1e-12)


def test_of_equally_good_fits_one_with_fewer_levels_is_taken() -> None:
    assert best_starts([1, 3, 1, 0, 0], 1.0) == [0, 3]  # as good as [0, 1, 2], with fewer levels
    assert best_starts([0, 0, 1, 2, 2], 1.1) == [0, 2]  # as good as [0, 3], but the last level is longer
    off = math.log(1.3)
    assert best_starts([0.0] * 3 + [off] + [0.0] * 3, off / 2 * (1 - 1e-13)) == [0]  # a rounding error must not cause a step


def test_the_cost_of_a_level_is_the_distance_to_its_median() -> None:
    logs = list(np.random.default_rng(3).normal(0, 1, 9))
    for end in range(1, 10):
        assert costs_before(logs, end) == pytest.approx([float(np.abs(np.array(logs[i:end]) - np.median(logs[i:end])).sum()) for i in range(end)])
