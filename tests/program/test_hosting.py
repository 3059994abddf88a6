"""The library inside another process: Python keeps its signal handlers and child processes."""

from __future__ import annotations

import ctypes
import os
import signal
import subprocess
import sys
from pathlib import Path

SIGNALS = [signal.SIGINT, signal.SIGTERM, signal.SIGCHLD, signal.SIGPIPE, signal.SIGUSR1]


def host(library: str) -> None:
    """Runs in a process of its own, without pytest."""
    heard: list[int] = []
    for number in SIGNALS:
        signal.signal(number, lambda caught, _: heard.append(caught))
    child = subprocess.Popen(["sleep", "60"])
    numbers = ctypes.c_double * 9
    bounded = ctypes.CDLL(library).bound_by_all_solvers(
        numbers(0, 0, 0, 1, 0, 0, 0, 1, 0), numbers(0, 0, 1, 1, 0, 1, 0, 1, 2), 3
    )
    assert bounded >= 5, f"{bounded} solvers bound a distance"
    assert child.poll() is None, "the child has ended"
    assert not heard
    for number in SIGNALS:
        signal.raise_signal(number)
    assert heard == SIGNALS, "a signal handler is another one now"
    children = Path(f"/proc/self/task/{os.getpid()}/children").read_text().split()
    assert children == [str(child.pid)], "there is another child"
    child.kill()
    assert child.wait() == -signal.SIGKILL


def test_python_keeps_its_signal_handlers_and_its_children(program_file: str) -> None:
    library = Path(program_file).parent / "tests" / "libhausbench_hosted.so"
    assert library.exists(), "it is not built: run `make test`"
    subprocess.run([sys.executable, __file__, library], check=True, timeout=60)


if __name__ == "__main__":
    host(sys.argv[1])
