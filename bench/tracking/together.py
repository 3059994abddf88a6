"""Runs two programs at the same time on one core, so that a disturbance of the core slows both.

Other guests of a host slow a core by a half, for milliseconds or seconds, so consecutive blocks
meet different disturbances. Two blocks on one core alternate every few milliseconds, by the
system's scheduler, and meet the same ones. Each needs 1 to 2 % more CPU time than alone, because
they share caches, except in the last repeats of the block that ends last. On a busy host, 88 to 97
% of such pairs showed a planted slowdown of 5 % as more than 3 % (nohd, guthe, kang, zheng; 32
pairs each), compared with 66 to 84 % of consecutive pairs. Stopping one while the other runs, for
20 to 100 ms, was no better.
"""

from __future__ import annotations

import os
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


@contextmanager
def one_core() -> Iterator[None]:
    """Restricts this process and its children to its last core; the first core handles most device
    interrupts."""
    before = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {max(before)})
    try:
        yield
    finally:
        os.sched_setaffinity(0, before)


@dataclass(frozen=True)
class Running:
    process: subprocess.Popen[str]
    output: IO[str]
    errors: IO[str]

    def said(self, good: tuple[int, ...]) -> str:
        """Returns the output of the ended process. Raises NotMeasured if its exit code is not in
        `good`."""
        texts = []
        for file in (self.output, self.errors):
            file.seek(0)
            texts.append(file.read())
        return checked(self.process.returncode, texts[0], texts[1], good)


@contextmanager
def started(job: Job[T]) -> Iterator[Running]:
    """Starts a job, and kills it on exit. Its workers die with their parent."""
    with tempfile.TemporaryFile("w+", errors="replace") as output, tempfile.TemporaryFile(
        "w+", errors="replace"
    ) as errors:
        try:
            process = subprocess.Popen(
                job.command,
                cwd=job.folder,
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=errors,
                text=True,
                env=environment_of(job.root),
            )
        except OSError as problem:
            raise NotMeasured(f"{job.command[0]} does not run: {problem.strerror}") from None
        try:
            yield Running(process, output, errors)
        finally:
            process.kill()  # does nothing if it has ended
            process.wait()


def together(jobs: Sequence[Job[T]]) -> list[T]:
    """Returns the results of all jobs; call it within one_core(), so that they share a core.

    Raises NotMeasured if one of them has no answer, or not all end in time.
    """
    with ExitStack() as stack:
        running = [stack.enter_context(started(job)) for job in jobs]
        end = time.monotonic() + blocks.LIMIT
        while left := [child for child in running if child.process.poll() is None]:
            for job, child in zip(jobs, running, strict=True):
                if child not in left:
                    child.said(job.good)  # raises the reason if it failed
            if time.monotonic() > end:
                raise NotMeasured(f"no end within {blocks.LIMIT:.0f} s")
            with suppress(subprocess.TimeoutExpired):
                left[0].process.wait(0.2)
        results = [job.read(child.said(job.good)) for job, child in zip(jobs, running, strict=True)]
    return results
