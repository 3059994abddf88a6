"""The interpreter is free while the library works: threads run side by side, and Ctrl-C ends a long
call."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import hausbench as hb
import pytest
from sample_meshes import sphere

HERE = Path(__file__).resolve().parent

INTERRUPTED = """
import os, signal, threading, time
import hausbench as hb
from sample_meshes import sphere

signal.signal(signal.SIGINT, signal.default_int_handler)
A, B = hb.Shape(*sphere(150, 0.1)), hb.Shape(*sphere(149, 0.1))
prepared = hb.prepare(B)
prepared.directed(A, tolerance=0.1)  # builds the structures
at = []

def interrupt():
    time.sleep(0.3)
    at.append(time.perf_counter())
    os.kill(os.getpid(), signal.SIGINT)

thread = threading.Thread(target=interrupt)
thread.start()
try:
    while True:  # calls that are shorter than the wait
        {call}
except KeyboardInterrupt:
    print(time.perf_counter() - at[0])
thread.join()
print(hb.directed(A, B, tolerance=0.1).status)
"""
CALLS = {
    "one long call": "hb.distribution(A, B, tolerance=1e-13, share_tolerance=1e-12)",
    "a chain": "prepared.directed(A, tolerance=1e-15)",
    "symmetric": "hb.symmetric(A, B, tolerance=1e-15)",
    "points": "hb.directed(A.vertices.repeat(10, axis=0) * 1.01, B.vertices, solver='naive')",
}


@pytest.mark.parametrize("call", list(CALLS))
def test_ctrl_c_raises_keyboard_interrupt(call: str) -> None:
    environment = {
        **os.environ,
        "PYTHONPATH": os.pathsep.join([str(HERE), *filter(None, [os.environ.get("PYTHONPATH")])]),
    }
    done = subprocess.run(
        [sys.executable, "-c", INTERRUPTED.format(call=CALLS[call])],
        env=environment,
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert done.returncode == 0, done.stderr
    wait, status = done.stdout.split()
    assert status == "converged"
    assert float(wait) < 5  # usually below 0.1; a loaded machine may be slower


def test_what_a_signal_handler_raises_ends_the_call() -> None:
    class Enough(Exception):
        pass

    def enough(*_: object) -> None:
        raise Enough

    before = signal.signal(signal.SIGALRM, enough)
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.2)
        with pytest.raises(Enough):
            while True:
                hb.distribution(
                    sphere(60, 0.1), sphere(59, 0.1), tolerance=1e-13, share_tolerance=1e-12
                )
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


@pytest.mark.parametrize("solver", ["cover", "guthe", "tang", "sampling"])
def test_signal_handlers_round_to_nearest(solver: str) -> None:
    """Solvers may round upward while they work."""
    sums: list[float] = []
    before = signal.signal(signal.SIGALRM, lambda *_: sums.append(1.0 + 1e-20))
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.06, 0.06)
        begin = time.perf_counter()
        source, target = hb.Shape(*sphere(60, 0.1)), hb.Shape(*sphere(59, 0.1))
        while len(sums) < 5 and time.perf_counter() - begin < 20:
            answer = hb.directed(source, target, tolerance=1e-12, solver=solver, time_limit=0.5)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
    assert sums and set(sums) == {1.0}
    assert answer.interval.upper > 0


def test_other_threads_run_during_a_call() -> None:
    source, target = hb.Shape(*sphere(150, 0.1)), hb.Shape(*sphere(149, 0.1))
    counted, over = [0], threading.Event()

    def count() -> None:
        while not over.is_set():
            counted[0] += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    before = counted[0]
    hb.distribution(source, target, tolerance=1e-7, share_tolerance=1e-3, time_limit=0.3)
    during = counted[0] - before
    over.set()
    thread.join()
    assert during >= 5  # none, if the call kept the interpreter


@pytest.mark.parametrize("shared", [False, True])
def test_answers_of_threads_are_those_of_one(shared: bool) -> None:
    meshes = [(sphere(20 + k, 0.1), sphere(18, 0.1)) for k in range(4)]
    shapes = [(hb.Shape(*source), hb.Shape(*target)) for source, target in meshes]
    expected = [hb.directed(*pair).interval for pair in meshes]
    prepared = hb.prepare(shapes[0][1])
    wrong: list[object] = []

    def ask(first: int) -> None:
        for k in range(12):
            number = (first + k) % 4
            if shared:
                interval = prepared.directed(
                    shapes[number][0]
                ).interval  # chains that another thread uses are not used
                if not (
                    interval.lower <= expected[number].upper
                    and expected[number].lower <= interval.upper
                ):
                    wrong.append((number, interval))
            elif hb.directed(*shapes[number]).interval != expected[number]:
                wrong.append(number)

    threads = [threading.Thread(target=ask, args=(first,)) for first in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert wrong == []


def test_a_program_may_end_while_a_thread_asks() -> None:
    script = (
        "import threading, time, hausbench as hb\nfrom sample_meshes import sphere\n"
        "A, B = sphere(150, 0.1), sphere(149, 0.1)\n"
        "ask = lambda: hb.distribution(A, B, tolerance=1e-13, share_tolerance=1e-12)\n"
        "threading.Thread(target=ask, daemon=True).start()\ntime.sleep(0.3)\n"
    )
    environment = {
        **os.environ,
        "PYTHONPATH": os.pathsep.join([str(HERE), *filter(None, [os.environ.get("PYTHONPATH")])]),
    }
    done = subprocess.run(
        [sys.executable, "-c", script], env=environment, capture_output=True, text=True, timeout=60
    )
    assert (done.returncode, done.stderr) == (0, "")
