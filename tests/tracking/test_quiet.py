"""Blocks are kept by what the probe says, never by their own times, and waiting has an end."""

from __future__ import annotations

import itertools
import os
import time
from collections import deque
from collections.abc import Iterable

import pytest

from bench.tracking import quiet
from bench.tracking.quiet import FIRST, TRIES, Quiet, loop, unrest


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """Seconds, which only probes and blocks take."""
    now = [0.0]
    monkeypatch.setattr(time, "monotonic", lambda: now[0])
    monkeypatch.setattr(time, "sleep", lambda seconds: now.append(now.pop() + seconds))
    monkeypatch.setattr(os, "sched_setaffinity", lambda process, cores: None)
    return now


def made(clock: list[float], probes: Iterable[float], seconds: float = 10.0) -> Quiet:
    """After many quiet probes; then these, a hundredth of a second each."""
    coming = iter(probes)

    def probe() -> float:
        clock[0] += 0.01
        return next(coming)

    return Quiet(seconds, probe, deque([1.0] * FIRST), [0, 1])


def test_a_quiet_block_is_measured_once(clock: list[float]) -> None:
    one, times = made(clock, [1.0, 1.01]), iter([7.0])
    assert one.kept(lambda: next(times)) == 7.0
    assert (one.blocks, one.again, one.disturbed) == (1, 0, 0) and one.seconds == pytest.approx(9.99)


def test_a_block_that_was_disturbed_is_measured_again(clock: list[float]) -> None:
    """Before it or after it."""
    one, times = made(clock, [1.0, 1.5, 1.0, 1.0]), iter([7.0, 9.0])
    assert one.kept(lambda: next(times)) == 9.0, "the slower one, which was not disturbed"
    assert (one.again, one.disturbed) == (1, 0)


def test_of_disturbed_tries_the_least_disturbed_is_kept(clock: list[float]) -> None:
    after = [1.5, 1.2, 1.3, 1.4]
    one, times = made(clock, [probe for last in after for probe in (1.0, last)]), iter([1.0, 9.0, 2.0, 3.0])
    assert one.kept(lambda: next(times)) == 9.0 and next(times, None) is None
    assert (one.again, one.disturbed) == (TRIES - 1, 1)


def test_a_core_is_waited_for_and_not_for_ever(clock: list[float]) -> None:
    one = made(clock, [1.5, 1.5, 1.0, 1.0])
    assert one.kept(lambda: 7.0) == 7.0 and one.again == 0
    one = made(clock, [1.5] * 1000)
    begun = clock[0]
    one.wait()
    assert quiet.WAIT <= clock[0] - begun <= quiet.WAIT + 0.02


def test_once_its_seconds_are_used_up_blocks_are_taken_as_they_come(clock: list[float]) -> None:
    def block() -> float:
        clock[0] += 1.0
        return 7.0

    one = made(clock, [1.5] * 1000, seconds=2.2)
    for _ in range(20):
        one.kept(block)
    assert one.again == 2 and one.disturbed == 20 and -1.5 < one.seconds <= 0
    assert one.line() == "20 measurements, 2 of them again since something else ran on their core, 20 kept all the same"


def test_a_clock_that_is_raised_now_and_then_is_not_waited_for() -> None:
    usual = [1.0, 1.01] * 20 + [0.5, 0.5]
    assert unrest(1.0, usual) == pytest.approx(0.0) and unrest(0.5, usual) == pytest.approx(-0.5) and unrest(1.5, usual) == pytest.approx(0.5)


def test_a_machine_that_is_slow_for_long_is_a_slow_machine(clock: list[float]) -> None:
    """But what it says while it is waited for changes nothing."""
    one = Quiet(1e9, lambda: 1.5)
    one.probes.extend([1.0] * FIRST)
    one.probe = made(clock, itertools.repeat(1.5)).probe
    one.kept(lambda: 1.0)
    assert one.again == TRIES - 1 and len(one.probes) == FIRST + 2 * TRIES
    for _ in range(200):
        one.kept(lambda: 1.0)
    again = one.again
    one.kept(lambda: 1.0)
    assert one.again == again and one.disturbed < 100


def test_probe_and_blocks_share_a_core() -> None:
    before = os.sched_getaffinity(0)
    one = Quiet(1.0)
    with one.alone():
        assert len(os.sched_getaffinity(0)) == 1 and len(one.probes) == FIRST
        first = os.sched_getaffinity(0)
        one.move()
        assert len(before) == 1 or os.sched_getaffinity(0) != first
    assert os.sched_getaffinity(0) == before
    with pytest.raises(KeyError), one.alone():
        raise KeyError
    assert os.sched_getaffinity(0) == before


def test_the_probe_says_what_one_of_its_loops_took() -> None:
    begun = time.perf_counter()
    assert 0 < loop() <= time.perf_counter() - begun
