"""Each verdict has each of its outcomes, and errs no more often than it claims."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from analysis.shared import verdicts
from analysis.shared.estimates import NO_DATA, Estimate, exact, one_draw, paired_ratio
from analysis.shared.verdicts import FAILS, HOLDS, NOT_JUDGED, NOT_REFUTED, OPEN, UNTESTED


def ratio(factor: float, rounds: int = 10, odd: int = 0) -> Estimate:
    """Returns an estimate from `rounds` ratios of `factor`, `odd` of them inverted."""
    return paired_ratio([factor] * (rounds - odd) + [1 / factor] * odd, [1.0] * rounds)


FASTER, SLOWER, LEVEL, FEW = ratio(2.0), ratio(0.5), ratio(1.1, odd=4), ratio(2.0, rounds=2)


@pytest.mark.parametrize(
    ("ratios", "outcome"),
    [
        ([FASTER, FASTER], HOLDS),
        ([FASTER, LEVEL], OPEN),
        ([FASTER, LEVEL, SLOWER], FAILS),
        ([FASTER, NO_DATA], OPEN),
        ([NO_DATA], UNTESTED),
        ([], UNTESTED),
        ([FEW, FEW], NOT_JUDGED),
        ([FEW, LEVEL], OPEN),
        ([FEW, SLOWER], FAILS),
        ([exact(2.0), exact(1.5)], HOLDS),
        ([exact(2.0), exact(1.0)], OPEN),
        ([exact(2.0), exact(0.5)], FAILS),
        # With six rounds, one ratio of six below 1 may be chance: 6 * 1/64 > 5 %. Two are not: 6/2
        # * 1/64 < 5 %.
        ([ratio(2.0, 6)] * 5 + [ratio(0.5, 6)], OPEN),
        ([ratio(2.0, 6)] * 4 + [ratio(0.5, 6)] * 2, FAILS),
    ],
)
def test_everywhere(ratios: list[Estimate], outcome: str) -> None:
    assert verdicts.everywhere("x", ratios).outcome == outcome


@pytest.mark.parametrize(
    ("ratios", "outcome"),
    [
        ([FASTER] * 3 + [SLOWER], HOLDS),
        ([FASTER] * 2 + [SLOWER] * 2, FAILS),
        ([FASTER, SLOWER, SLOWER, SLOWER], FAILS),
        ([FASTER] * 2 + [LEVEL] * 2, OPEN),
        ([FASTER] * 3 + [NO_DATA], HOLDS),
        ([FASTER] * 2 + [NO_DATA] * 2, OPEN),
        ([NO_DATA], UNTESTED),
        ([], UNTESTED),
        ([FEW] * 4, NOT_JUDGED),
        ([FEW] * 3 + [FASTER], NOT_JUDGED),
        ([FEW] + [FASTER, LEVEL] * 2, OPEN),
        ([exact(2.0), exact(2.0), exact(0.5)], HOLDS),
        ([exact(2.0), exact(0.5), exact(0.5)], FAILS),
        # Each clear ratio has p = 1/64. "Most of four" means three, of which two may be chance:
        # 2/64 < 5 %.
        ([ratio(2.0, 6)] * 3 + [SLOWER], HOLDS),
        ([ratio(2.0, 6, odd=1)] * 3 + [SLOWER], OPEN),
    ],
)
def test_most_of(ratios: list[Estimate], outcome: str) -> None:
    assert verdicts.most_of("x", ratios).outcome == outcome


def test_most_of_errs_seldom() -> None:
    """Half of the ratios are 2, the others 1, so "most are above" is wrong. It may occur in 5 % of
    trials, plus 3.5 % by chance in 150 trials."""
    share = rate(
        HOLDS,
        lambda rng: verdicts.most_of(
            "x", [noisy(rng, truth, 8) for truth in (2.0, 2.0, 2.0, 1.0, 1.0, 1.0)]
        ),
    )
    assert share <= 0.085


def test_least_of() -> None:
    least = verdicts.least_of([ratio(3.0), ratio(2.0)])
    assert least.value == pytest.approx(2.0) and least.p_above == ratio(2.0).p_above
    assert verdicts.least_of([ratio(3.0), ratio(0.5)]).p_below == 2 * ratio(0.5).p_below
    assert verdicts.least_of([ratio(3.0), NO_DATA]).n == 0 and verdicts.least_of([]).n == 0


def test_everywhere_says_what_its_rounds_cannot_refute() -> None:
    def evidence(rounds: int, pairs: int, below: int = 0) -> str:
        return verdicts.everywhere(
            "x", [ratio(1.1, rounds, odd=2)] * (pairs - below) + [ratio(0.5, rounds)] * below
        ).evidence

    # 15 / 2^6 = 0.23 > 5 %, but 15 / 2^6 / 5 = 0.047. Four rounds are never enough: 3 / 2^4 / 3 =
    # 0.0625.
    assert evidence(6, 15, 1).endswith(
        "6 rounds refute it only if at least 5 of 15 pairs are below 1"
    )
    assert evidence(4, 3).endswith("4 rounds are too few to refute it for 3 pairs")
    assert "refute" not in evidence(10, 15) and "refute" not in evidence(6, 3)
    assert (
        "refute" not in verdicts.everywhere("x", [FASTER] * 2 + [ratio(2.0, 6)] * 13).evidence
    )  # the claim holds
    assert verdicts.everywhere("x", [one_draw(2.0)] * 5).outcome == NOT_JUDGED
    assert verdicts.everywhere("x", [one_draw(2.0)] * 5).evidence.endswith(
        "1 round is too few to refute it for 5 pairs"
    )


def rate(
    outcome: str, verdict: Callable[[np.random.Generator], verdicts.Verdict], trials: int = 150
) -> float:
    rng = np.random.default_rng(11)
    return sum(verdict(rng).outcome == outcome for _ in range(trials)) / trials


def noisy(rng: np.random.Generator, truth: float, rounds: int) -> Estimate:
    return paired_ratio(truth * np.exp(0.02 * rng.standard_normal(rounds)), [1.0] * rounds)


@pytest.mark.parametrize(("pairs", "rounds"), [(6, 6), (15, 10)])
def test_everywhere_errs_seldom(pairs: int, rounds: int) -> None:
    """If all ratios are 1, "one is below" may occur in 5 % of trials (plus 1.7 % by chance in 150
    trials), and less often than with a test for each. If one is 1 and the others 2, the same holds
    for "all are above".
    """

    def level(rng: np.random.Generator) -> list[Estimate]:
        return [noisy(rng, 1.0, rounds) for _ in range(pairs)]

    assert rate(FAILS, lambda rng: verdicts.everywhere("x", level(rng))) <= 0.067
    each = rate(
        FAILS,
        lambda rng: verdicts.Verdict(
            "x", FAILS if any(x.separated and x.high < 1 for x in level(rng)) else OPEN, ""
        ),
    )
    assert each > 0.08
    assert (
        rate(
            HOLDS,
            lambda rng: verdicts.everywhere(
                "x", [noisy(rng, 1.0, rounds)] + [noisy(rng, 2.0, rounds)] * 5
            ),
        )
        <= 0.067
    )
    # True differences are always detected.
    assert (
        rate(
            FAILS,
            lambda rng: verdicts.everywhere("x", level(rng)[2:] + [noisy(rng, 0.5, rounds)] * 2),
        )
        == 1
    )
    assert (
        rate(
            HOLDS,
            lambda rng: verdicts.everywhere("x", [noisy(rng, 2.0, rounds) for _ in range(pairs)]),
            20,
        )
        == 1
    )


def test_above_one() -> None:
    assert [verdicts.above_one("x", r).outcome for r in (FASTER, LEVEL, SLOWER, NO_DATA, FEW)] == [
        HOLDS,
        OPEN,
        FAILS,
        UNTESTED,
        NOT_JUDGED,
    ]
    assert verdicts.above_one("x", one_draw(2.0)).evidence == "n = 1; ratio 2.00"
    assert verdicts.above_one("x", FEW).evidence == "n = 2; ratio 2.00 [2.00, 2.00]"
    assert verdicts.above_one("x", exact(2.0)).evidence == "ratio 2.00"
    assert (
        verdicts.above_one("x", FEW).line()
        == "Claim: x. Here: not judged (n = 2; ratio 2.00 [2.00, 2.00])."
    )


def test_never_is_never_proven() -> None:
    assert [
        verdicts.never("x", wrong, of, "cases").outcome
        for wrong, of in ((0, 28), (0, 29), (1, 10**6), (0, 0))
    ] == [OPEN, NOT_REFUTED, FAILS, UNTESTED]
    # 1 - 0.05^(1/150) = 2.0 %; for ten independent trials, 26 %.
    assert (
        verdicts.never("x", 0, 150, "answers are wrong").evidence
        == "0 of 150 answers are wrong; the rate is below 2.0 % at 95 %"
    )
    few = verdicts.never("x", 0, 150, "answers are wrong", 10)
    assert few.outcome == OPEN and few.evidence.endswith(
        "below 26 % at 95 %, from 10 independent trials"
    )
    assert (
        verdicts.never("x", 0, 99, "cases")
        .line()
        .startswith("Claim: x. Here: not refuted (0 of 99 cases; the rate is below")
    )


def test_never_against_the_rate_of_a_variant() -> None:
    """Thirty trials without an error allow rates up to 1 - 0.05^(1/30) = 9.5 %."""

    def of(bar: float) -> verdicts.Verdict:
        return verdicts.never("x", 0, 6000, "answers are wrong", 30, bar, "of variants")

    assert (
        of(0.1).outcome == NOT_REFUTED and of(0.09).outcome == OPEN and of(0.0038).outcome == OPEN
    )
    assert of(0.0038).evidence.endswith("from 30 independent trials, against 0.38 % of variants")
    assert verdicts.never("x", 1, 6000, "answers are wrong", 30, 0.5).outcome == FAILS


def test_chosen_cases_give_no_rate() -> None:
    verdict = verdicts.never_chosen("x", 0, 2894, "answers")
    assert (verdict.outcome, verdict.evidence) == (
        NOT_REFUTED,
        "0 of 2,894 answers; the cases were chosen, not drawn, so no rate follows",
    )
    assert (
        verdicts.never_chosen("x", 2, 2894, "answers").outcome == FAILS
        and verdicts.never_chosen("x", 0, 0, "answers").outcome == UNTESTED
    )


def test_all_of_a_known_number() -> None:
    assert [
        verdicts.all_of("x", unlike, seen, 6, "pairs").outcome
        for unlike, seen in ((0, 6), (1, 2), (0, 5), (0, 0))
    ] == [HOLDS, FAILS, OPEN, UNTESTED]


def test_rising() -> None:
    up = [1.0, 2, 3, 4, 5, 6]
    assert (
        verdicts.rising("x", up, up).outcome == HOLDS
        and verdicts.rising("x", up, up[::-1]).outcome == FAILS
    )
    assert (
        verdicts.rising("x", up, [2.0, 1, 4, 3, 6, 5]).outcome == OPEN
    )  # p = 0.056 for 3 inversions
    assert (
        verdicts.rising("x", [1.0], [1.0]).outcome == UNTESTED
        and verdicts.rising("x", up, [1.0] * 6).outcome == OPEN
    )
    # A tie does not count as rising; otherwise p would be 0.0167.
    assert (
        verdicts.rising("x", up[:5], [1.0, 1, 2, 3, 4]).evidence
        == "Kendall's tau 0.95 over 5, p = 0.023"
    )


def test_rising_by_run() -> None:
    x = [1.0, 2, 3, 4]
    assert verdicts.rising_by_run("x", [(x, x)] * 6).outcome == HOLDS
    assert verdicts.rising_by_run("x", [(x, x[::-1])] * 6).outcome == FAILS
    assert verdicts.rising_by_run("x", [(x, x)] * 5 + [(x, x[::-1])]).outcome == OPEN
    assert (
        verdicts.rising_by_run("x", [(x, x)] * 5).outcome == NOT_JUDGED
        and verdicts.rising_by_run("x", []).outcome == UNTESTED
    )
    # A smooth run is one trial, however many neighbouring poses it has.
    long = [float(i) for i in range(100)]
    assert verdicts.rising_by_run("x", [(long, long)]).outcome == NOT_JUDGED


def test_constant() -> None:
    def of(*levels: float, runs: int = 12, spread: float = 0.0) -> str:
        factors = [1 + spread * i for i in range(runs)]
        times = []
        for level in levels:
            times.append([level * factor for factor in factors])
        return verdicts.constant("x", times, 1.25).outcome

    assert of(1.0, 1.1, 1.2) == HOLDS and of(1.0, 1.1, 1.5) == FAILS
    assert of(1.0, 1.1, 1.2, spread=0.02) == OPEN and of(1.0, 1.0, 1.0, runs=4) == OPEN
    assert of(1.0, 1.1) == UNTESTED


def test_constant_errs_seldom() -> None:
    """Twenty places share one constant with 10 % of noise. Their extremes usually differ by more
    than the factor, which must not refute the constant.
    """

    def noise(rng: np.random.Generator) -> verdicts.Verdict:
        return verdicts.constant(
            "x", [list(row) for row in np.exp(0.1 * rng.standard_normal((20, 10)))], 1.05
        )

    assert rate(FAILS, noise) <= 0.067 and rate(HOLDS, noise) == 0


def test_greatest() -> None:
    def of(ratios: list[Estimate], rival: Estimate) -> str:
        return verdicts.greatest("x", ratios, rival, "").outcome

    assert of([FASTER, FASTER], FASTER) == HOLDS and of([FASTER, LEVEL], LEVEL) == OPEN
    assert of([FASTER, SLOWER], SLOWER) == FAILS and of([], NO_DATA) == UNTESTED
    assert of([FASTER, NO_DATA], NO_DATA) == OPEN
    assert verdicts.greatest("x", [one_draw(2.0)], one_draw(2.0), "at 0") == verdicts.Verdict(
        "x", NOT_JUDGED, "n = 1; at 0"
    )
    assert of([FASTER, SLOWER], FASTER) == OPEN  # chosen by the times themselves, so no proof


def test_least_among() -> None:
    def of(*rivals: tuple[Estimate, ...], among: int = 2) -> str:
        return verdicts.least_among(
            "x", [(str(i), r) for i, r in enumerate(rivals)], "5", ["5", "6", "7"][:among]
        ).outcome

    assert of((FASTER, SLOWER), (FASTER, LEVEL)) == HOLDS
    assert of((FASTER, LEVEL), (LEVEL, FASTER)) == OPEN  # neither setting beats both rivals
    assert (
        of((SLOWER, SLOWER), (FASTER, FASTER)) == FAILS
        and of((SLOWER, FASTER)) == HOLDS
        and of() == UNTESTED
    )
    # One-sided 2^-6, times four rivals, exceeds 5 %.
    six = [(ratio(0.5, 6),)] + [(ratio(2.0, 6),)] * 3
    assert of(*six[:3], among=1) == FAILS and of(*six, among=1) == OPEN


def test_least_among_tells_level_from_less() -> None:
    """One of eight rivals may win all of six rounds by chance, 8 / 2^6 > 5 %, but not all of
    ten."""

    def evidence(rounds: int, odd: int = 0) -> str:
        first = (ratio(0.5, rounds, odd),)
        return verdicts.least_among(
            "x",
            [("a", first), *[(c, (ratio(1.1, 10, odd=4),)) for c in "bcdefg"], ("h", (FASTER,))],
            "a",
            ["5"],
        ).evidence

    assert evidence(6) == (
        "least at a; less time, but not less than one of 8 may take by chance: a; "
        "not separated from it: b, c, d, e, f, g"
    )
    assert "faster than 5: a" in evidence(10) and "not separated from it: a, b" in evidence(10, 3)
    few = verdicts.least_among("x", [(c, (ratio(0.5, 6),)) for c in "abcdefgh"], "a", ["5"])
    assert few.outcome == OPEN and few.evidence.endswith(
        "6 rounds are too few to refute it for 8 rivals"
    )
    assert "refute" not in evidence(6)  # seven of the rivals have ten rounds


def test_least_among_errs_seldom() -> None:
    """Nine rivals are truly as fast as the setting; all are compared with the same times of the
    setting."""

    def level(rng: np.random.Generator) -> verdicts.Verdict:
        setting, rivals = np.exp(0.02 * rng.standard_normal(10)), np.exp(
            0.02 * rng.standard_normal((9, 10))
        )
        return verdicts.least_among(
            "x", [(str(i), [paired_ratio(x, setting)]) for i, x in enumerate(rivals)], "", ["5"]
        )

    assert rate(FAILS, level) <= 0.067 and rate(HOLDS, level) <= 0.067


def test_line_with_counts() -> None:
    verdict = verdicts.above_one("a is faster", FASTER).with_counts(
        {
            "distances": verdicts.above_one("a is faster", exact(0.5)),
            "bounds": verdicts.above_one("a is faster", NO_DATA),
        }
    )
    assert verdict.line() == (
        "Claim: a is faster. Here it holds (ratio 2.00 [2.00, 2.00]). Counted in distances it does not hold "
        "(ratio 0.500); in bounds it is not tested (no ratio)."
    )
    assert math.isnan(NO_DATA.value)
