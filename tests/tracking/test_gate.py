"""Tests the gate's statistics on simulated machines: unchanged cases pass, slower ones are
caught."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest

from analysis.shared.estimates import NO_DATA, Estimate
from bench.tracking import gate
from bench.tracking.gate import (
    LEAST,
    PLANTED,
    Judged,
    Sides,
    Verdict,
    alarms,
    compare,
    judge,
    self_test,
    times,
    verdict_of_times,
    whole,
)

CASES = 31
BLOCKS = 36


def machine(
    rng: np.random.Generator, noise: float = 0.006, spikes: float = 0.08
) -> npt.NDArray[np.float64]:
    """Returns factors for the blocks of a build: a little noise, and larger disturbances in a few
    blocks."""
    factors = np.exp(noise * rng.standard_normal(BLOCKS))
    return np.where(rng.random(BLOCKS) < spikes, factors * (1 + 0.3 * rng.random(BLOCKS)), factors)


def sides(rng: np.random.Generator, slower: float = 0.0, noise: float = 0.006) -> Sides:
    def block(factor: float) -> list[float]:
        return list(0.01 * factor * machine(rng, noise))

    return Sides(block(1), block(1 + slower))


def judged(
    name: str = "case",
    low: float = 0.99,
    value: float = 1.0,
    high: float = 1.01,
    planted_low: float | None = None,
    second_low: float | None = None,
) -> Judged:
    def ratio(least: float, middle: float, most: float) -> Estimate:
        return Estimate(middle, least, most, BLOCKS, 0.999)

    return Judged(
        name,
        0.01,
        ratio(low, value, high),
        NO_DATA
        if planted_low is None
        else ratio(planted_low, planted_low + 0.01, planted_low + 0.02),
        NO_DATA if second_low is None else ratio(second_low, second_low + 0.01, second_low + 0.02),
    )


def with_a_plant(rng: np.random.Generator, cases: int, noise: float = 0.006) -> list[Judged]:
    """Returns unchanged cases, the first of which also has measurements with a planted slowdown."""
    unchanged = [judge(str(i), sides(rng, noise=noise), CASES) for i in range(cases)]
    plant, more = (sides(rng, slower=PLANTED, noise=noise) for _ in range(2))
    return [
        replace(
            unchanged[0],
            planted=compare(plant.candidate + more.candidate, plant.base + more.base, CASES),
        ),
        *unchanged[1:],
    ]


GOOD = judged("with a plant", planted_low=1.04)


def test_an_unchanged_build_never_alarms_and_a_planted_slowdown_is_seen() -> None:
    rng = np.random.default_rng(1)
    for _ in range(60):
        assert verdict_of_times(with_a_plant(rng, 5))[0] is Verdict.passed


def test_five_per_cent_is_caught() -> None:
    rng = np.random.default_rng(2)
    for _ in range(60):
        case = judge("slow", sides(rng, slower=0.05), CASES)
        assert case.alarms
        confirmed = replace(case, second=judge("slow", sides(rng, slower=0.05), CASES).ratio)
        assert verdict_of_times([GOOD, confirmed])[0] is Verdict.red


def test_two_per_cent_is_no_alarm() -> None:
    rng = np.random.default_rng(3)
    assert not any(judge("a little slow", sides(rng, slower=0.02), CASES).alarms for _ in range(60))


def test_a_noisy_machine_is_inconclusive_and_not_red() -> None:
    """If blocks vary by a third, noise hides a slowdown of 5 %, so the gate must say that it cannot
    tell."""
    rng = np.random.default_rng(4)
    for _ in range(30):
        assert verdict_of_times(with_a_plant(rng, 5, noise=0.3))[0] is Verdict.inconclusive


def test_a_clock_that_toggles_hides_little_of_five_per_cent_from_72_blocks() -> None:
    """Each block is randomly 2.5 % slower or not, as on a host whose clock toggles. In some runs 36
    blocks are too few."""
    rng = np.random.default_rng(7)

    def clock(count: int, factor: float) -> list[float]:
        return list(
            factor
            * np.where(rng.random(count) < 0.5, 1.025, 1.0)
            * np.exp(0.003 * rng.standard_normal(count))
        )

    def alarms_of_300(count: int) -> int:
        pairs = [Sides(clock(count, 1), clock(count, 1.05)) for _ in range(300)]
        return sum(judge("slow", pair, CASES).alarms for pair in pairs)

    assert alarms_of_300(36) < 220 and alarms_of_300(72) >= 280
    assert not any(
        judge("unchanged", Sides(clock(72, 1), clock(72, 1)), CASES).alarms for _ in range(300)
    )


def test_every_alarm_is_of_a_suspect() -> None:
    """A case that is not suspected after the first blocks gets no more blocks, so the first ones
    must not raise an alarm."""
    rng = np.random.default_rng(8)
    drawn = [sides(rng, slower=much) for much in np.linspace(0, 0.06, 200)]
    assert all(gate.suspected(case) for case in drawn if judge("case", case, CASES).alarms)
    assert gate.suspected(Sides([1.0] * 24, [1.03] * 24)) and not gate.suspected(
        Sides([1.0] * 24, [1.01] * 24)
    )


def test_the_threshold_is_that_of_the_lower_end() -> None:
    assert not alarms(Estimate(1.2, 1 + LEAST, 1.3, 36, 0.999)) and alarms(
        Estimate(1.04, 1 + LEAST + 1e-9, 1.05, 36, 0.999)
    )
    assert not alarms(NO_DATA)


def test_many_cases_need_wider_intervals() -> None:
    rng = np.random.default_rng(5)
    base, candidate = list(machine(rng)), list(machine(rng))
    alone, many = compare(candidate, base, 1), compare(candidate, base, 200)
    assert many.low < alone.low and alone.high < many.high
    assert alone.coverage >= 0.95 and many.coverage >= 1 - 0.05 / 200


def test_too_few_blocks_for_so_many_cases_is_an_error() -> None:
    with pytest.raises(ValueError, match="6 pairs of blocks .* ask for more"):
        compare([1.0] * 6, [1.0] * 6, CASES)
    assert compare([1.0] * 6, [1.0] * 6, 1).n == 6
    judge("the least blocks", Sides([1.0] * gate.SCREENING, [1.0] * gate.SCREENING), CASES)


def test_blocks_are_paired_so_that_what_disturbs_both_sides_cancels() -> None:
    """The machine slows down gradually by a factor of 1.5, and the candidate is always 5 %
    slower."""
    drift = np.linspace(1, 1.5, BLOCKS)
    judged = judge("drift", Sides(list(drift), list(1.05 * drift)), CASES)
    assert judged.ratio.value == pytest.approx(1.05) and judged.alarms


@pytest.mark.parametrize(
    "itself", [Estimate(1.05, 1.04, 1.06, 24, 0.999), Estimate(0.95, 0.94, 0.96, 24, 0.999)]
)
def test_a_base_that_differs_from_itself_spoils_the_verdict(itself: Estimate) -> None:
    """If the base differs from itself, in either direction, the measurement is at fault. This
    overrules an alarm."""
    slow = Judged(
        "slow", 0.01, Estimate(1.2, 1.1, 1.3, 36, 0.999), second=Estimate(1.2, 1.1, 1.3, 36, 0.999)
    )
    verdict, reasons = verdict_of_times([replace(GOOD, planted=times(itself, 1 + PLANTED)), slow])
    assert (
        verdict is Verdict.inconclusive
        and f"the base is {itself.value:.3f} times as slow as itself" in reasons[0]
    )
    assert (
        verdict_of_times(
            [replace(GOOD, planted=times(Estimate(1.0, 0.985, 1.02, 24, 0.999), 1 + PLANTED)), slow]
        )[0]
        is Verdict.red
    )


def test_blocks_of_two_kinds_are_noise_and_no_slowdown() -> None:
    """In both builds, a block randomly takes a tenth longer, depending on where its copy of the
    program lies in memory."""
    rng = np.random.default_rng(6)
    for _ in range(60):
        base, candidate = (list(np.where(rng.random(BLOCKS) < 0.5, 1.1, 1.0)) for _ in range(2))
        assert not judge("copies", Sides(base, candidate), CASES).alarms


def test_the_other_way_round() -> None:
    inverse = gate.inverse(Estimate(2.0, 1.6, 4.0, 10, 0.99))
    assert (inverse.value, inverse.low, inverse.high) == (0.5, 0.25, 0.625)


def test_times_are_of_the_base() -> None:
    judged = judge("case", Sides([1.0] * 36, [2.0] * 36), CASES)
    assert (
        judged.ratio.value == pytest.approx(2.0)
        and judged.base_seconds == 1.0
        and not judged.planted.n
    )


@pytest.mark.parametrize("count", [24, 36, 72])
@pytest.mark.parametrize("cases", [1, 4, 31])
def test_what_is_decided_early_is_what_all_blocks_would_say(count: int, cases: int) -> None:
    """Once a case is decided, the remaining blocks cannot change the result, be they the best or
    the worst, in any order."""
    slow, fine = 1 + LEAST + 0.01, 1 + LEAST - 0.01
    undecided = 0
    for above in range(count + 1):
        for below in range(count + 1 - above):
            measured = Sides([1.0] * (above + below), [slow] * above + [fine] * below)
            if not gate.decided(measured, count, cases):
                undecided += 1
                continue
            left = count - above - below
            ends = {
                alarms(compare(measured.candidate + [rest] * left, [1.0] * count, cases))
                for rest in (slow, fine)
            }
            assert ends == {
                alarms(compare(measured.candidate, measured.base, cases))
            }, "and the interval of what there is says the same"
    assert undecided > count and not gate.decided(Sides([1.0] * 23, [fine] * 23), count, cases)


def test_without_a_plant_nothing_is_believed() -> None:
    assert verdict_of_times([judged()]) == (Verdict.inconclusive, ["no slowdown was planted"])


def test_a_plant_that_is_not_seen_overrules_an_alarm() -> None:
    verdict, reasons = verdict_of_times(
        [judged("blind", planted_low=1.02), judged("slow", 1.1, 1.12, 1.14, second_low=1.1)]
    )
    assert verdict is Verdict.inconclusive and "blind" in reasons[0] and "not seen" in reasons[0]


def test_an_alarm_that_a_second_run_does_not_repeat_is_told_and_passes() -> None:
    verdict, reasons = verdict_of_times([GOOD, judged("once", 1.05, 1.06, 1.07, second_low=1.0)])
    assert verdict is Verdict.passed and "which a second run did not repeat" in reasons[0]


def test_an_alarm_that_a_second_run_repeats_is_a_regression() -> None:
    verdict, reasons = verdict_of_times([GOOD, judged("slow", 1.05, 1.06, 1.07, second_low=1.04)])
    assert verdict is Verdict.red and "slower by 6.0 %" in reasons[0]


def test_it_takes_both_runs() -> None:
    assert not judged("slow", 1.05, 1.06, 1.07).red
    assert not judged("slow", 0.99, 1.0, 1.01, second_low=1.2).red
    assert judged("slow", 1.05, 1.06, 1.07, second_low=1.2).red


def test_nothing_measured() -> None:
    assert verdict_of_times([])[0] is Verdict.nothing_measured


def test_the_smallest_slowdown_that_would_show() -> None:
    assert judged(low=0.98, value=1.0).sees == pytest.approx(1.03 / 0.98 - 1)
    assert judged(low=1.078, value=1.1).sees == pytest.approx(
        1.03 * 1.1 / 1.078 - 1
    ), "whatever the change is"
    assert math.isnan(replace(judged(), ratio=NO_DATA).sees)


def test_cases_that_are_too_noisy_are_named() -> None:
    verdict, reasons = verdict_of_times([GOOD, judged("blurred", low=0.9), judged("sharp")])
    assert verdict is Verdict.passed and reasons == ["too noisy to see a slowdown of 8 %: blurred"]


@pytest.mark.parametrize(
    ("verdicts", "expected"),
    [
        ([Verdict.passed, Verdict.passed], Verdict.passed),
        ([Verdict.passed, Verdict.nothing_measured], Verdict.passed),
        ([Verdict.red, Verdict.inconclusive], Verdict.red),
        ([Verdict.passed, Verdict.inconclusive], Verdict.inconclusive),
        ([Verdict.nothing_measured, Verdict.inconclusive], Verdict.inconclusive),
        ([Verdict.nothing_measured], Verdict.nothing_measured),
        ([], Verdict.nothing_measured),
    ],
)
def test_the_verdict_of_all_tiers(verdicts: list[Verdict], expected: Verdict) -> None:
    assert whole(verdicts) is expected


def test_exit_codes_are_those_that_are_promised() -> None:
    assert [int(verdict) for verdict in Verdict] == [0, 3, 4, 5]
    assert Verdict.nothing_measured.words == "nothing measured"
    assert (
        gate.LEAST == 0.03
        and gate.PLANTED == 0.05
        and gate.SCREENING >= 20
        and gate.SUSPECT < gate.LEAST
    )
