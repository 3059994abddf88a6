"""Takes blocks while nothing else runs on their core, as far as a short probe can tell.

Other guests of a host share its cores, and slow them by a half for seconds on end. A loop of arithmetic sees this at once. A block is kept
if the probe is near its best right before and right after it; else it is measured again, and of TRIES the one with the best probes is
kept. The probe chooses, never the time of the block, so this favours neither side. On a quiet machine it costs two probes a block.
"""

from __future__ import annotations

import os
import statistics
import time
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import TypeVar

T = TypeVar("T")

QUIET = 0.04  # a probe that is slower by more than that was disturbed
TRIES = 4
WAIT = 0.5  # seconds before one block
PAUSE = 0.01  # seconds
FIRST = 40  # probes before anything is judged
REMEMBERED = 400  # probes: a machine may become another one for good
LOOPS = 4  # a probe is the least of so many: a timer's interrupt disturbs one


def loop() -> float:
    """Wall seconds: the system takes what it holds to be stolen from CPU time, and sometimes too much."""
    least = float("inf")
    for _ in range(LOOPS):
        begun, total = time.perf_counter(), 0
        for i in range(5000):
            total += i
        least = min(least, time.perf_counter() - begun)
    return least


def unrest(probe: float, earlier: Sequence[float]) -> float:
    """By how much it is slower than the best tenth of the earlier ones: than a clock that is raised now and then blocks cannot wait for."""
    return probe / statistics.quantiles(earlier, n=10)[0] - 1


@dataclass
class Quiet:
    """Blocks are measured within alone(), which takes the first probes. `seconds` in all for waiting and for blocks that are measured again; once
    they are used up, blocks are taken as they come.
    """

    seconds: float
    probe: Callable[[], float] = loop
    probes: deque[float] = field(default_factory=lambda: deque(maxlen=REMEMBERED))  # beside blocks; those while it waits would drown them
    cores: list[int] = field(default_factory=lambda: sorted(os.sched_getaffinity(0)))
    blocks: int = 0
    again: int = 0
    disturbed: int = 0  # kept all the same

    @contextmanager
    def alone(self) -> Iterator[None]:
        """This process, and what it starts, runs on one core meanwhile: probe and block share it."""
        before = os.sched_getaffinity(0)
        try:
            self.move()
            self.probes.extend(self.probe() for _ in range(FIRST))
            yield
        finally:
            os.sched_setaffinity(0, before)

    def move(self) -> None:
        """To the next core."""
        self.cores.append(self.cores.pop(0))
        os.sched_setaffinity(0, {self.cores[-1]})

    def judged(self, probe: float) -> float:
        self.probes.append(probe)
        return unrest(probe, self.probes)

    def wait(self) -> float:
        """On whichever core is quiet first. The unrest at the end."""
        begun = time.monotonic()
        while unrest(probe := self.probe(), self.probes) > QUIET and time.monotonic() - begun < min(WAIT, self.seconds):
            time.sleep(PAUSE)
            self.move()
        self.seconds -= time.monotonic() - begun
        return self.judged(probe)

    def kept(self, block: Callable[[], T]) -> T:
        """What the least disturbed of its tries gave."""
        self.blocks += 1
        tries: list[tuple[float, T]] = []
        while not tries or (tries[-1][0] > QUIET and len(tries) < TRIES and self.seconds > 0):
            before, begun = self.wait(), time.monotonic()
            found = block()
            tries.append((max(before, self.judged(self.probe())), found))
            if len(tries) > 1:
                self.again += 1
                self.seconds -= time.monotonic() - begun
        least = min(tries, key=lambda one: one[0])
        self.disturbed += least[0] > QUIET
        return least[1]

    def line(self) -> str:
        return f"{self.blocks} measurements, {self.again} of them again since something else ran on their core, {self.disturbed} kept all the same"
