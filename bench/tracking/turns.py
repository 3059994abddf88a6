"""Two programs in turns on one core, so that what slows the core slows both.

Other guests of a host slow a core for some tens of milliseconds, or for seconds. One block after the other meets different disturbances; in
turns of 50 ms both meet the same ones, but for the shortest, of which the least of many repeats is free. A program that waits is stopped, and
uses no CPU time. On a busy host 86 to 89 % of the pairs showed a planted slowdown of 5 % as one of at least 3 % so, and 66 to 84 %
where one block followed the other.
"""

from __future__ import annotations

import os
import signal
import subprocess
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from typing import IO, TypeVar

from bench.tracking import blocks
from bench.tracking.blocks import Job, NotMeasured, checked, environment_of

T = TypeVar("T")

SLICE = 0.05  # seconds


@dataclass(frozen=True)
class Running:
    process: subprocess.Popen[str]
    output: IO[str]
    errors: IO[str]

    @property
    def over(self) -> bool:
        return self.process.poll() is not None

    def signal(self, number: signal.Signals) -> None:
        """To all its processes. Nothing where it is over."""
        if not self.over:
            with suppress(ProcessLookupError):
                os.killpg(self.process.pid, number)

    def run(self, seconds: float) -> None:
        """Until it is over, for so long at most."""
        self.signal(signal.SIGCONT)
        with suppress(subprocess.TimeoutExpired):
            self.process.wait(seconds)

    def said(self, good: tuple[int, ...]) -> str:
        texts = []
        for file in (self.output, self.errors):
            file.seek(0)
            texts.append(file.read())
        return checked(self.process.returncode, texts[0], texts[1], good)


@contextmanager
def started(job: Job[T]) -> Iterator[Running]:
    """In a group of its own, so that its children stop with it; stopped at once, and gone afterwards."""
    with tempfile.TemporaryFile("w+", errors="replace") as output, tempfile.TemporaryFile("w+", errors="replace") as errors:
        try:
            process = subprocess.Popen(job.command, cwd=job.folder, stdin=subprocess.DEVNULL, stdout=output, stderr=errors, text=True,
                                       env=environment_of(job.root), start_new_session=True)
        except OSError as problem:
            raise NotMeasured(f"{job.command[0]} does not run: {problem.strerror}") from None
        running = Running(process, output, errors)
        try:
            running.signal(signal.SIGSTOP)
            yield running
        finally:
            running.signal(signal.SIGKILL)
            process.wait()


def in_turns(jobs: Sequence[Job[T]]) -> list[T]:
    """What each of them gives. NotMeasured where one of them has no answer, or not all are over in time."""
    with ExitStack() as stack:
        running = [stack.enter_context(started(job)) for job in jobs]
        end = time.monotonic() + blocks.LIMIT
        while left := [one for one in running if not one.over]:
            if time.monotonic() > end:
                raise NotMeasured(f"no end within {blocks.LIMIT:.0f} s")
            for one in left:
                one.run(SLICE)
                one.signal(signal.SIGSTOP)
        found = [job.read(one.said(job.good)) for job, one in zip(jobs, running, strict=True)]
    return found
