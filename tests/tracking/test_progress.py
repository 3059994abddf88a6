"""Tests the progress messages, on a terminal and in a file."""

from __future__ import annotations

import sys
import time

import pytest

from bench.tracking.progress import CLEAR, Progress, say


def run(monkeypatch: pytest.MonkeyPatch, total: int, watched: bool) -> None:
    """Counts to `total`; each step takes two seconds."""
    clock = [100.0]
    monkeypatch.setattr(time, "monotonic", lambda: clock[0])
    monkeypatch.setattr(sys.stderr, "isatty", lambda: watched, raising=False)
    progress = Progress(total, "turns", "time")
    for count in range(1, total + 1):
        clock[0] += 2
        progress.done(count)


def test_nobody_watches(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    run(monkeypatch, 12, False)
    assert (
        capsys.readouterr().err
        == "time: 5 of 12 turns, 14 s left\ntime: 10 of 12 turns, 4 s left\ntime: 12 of 12 turns, 0 s left\n"
    )


def test_somebody_watches(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    run(monkeypatch, 3, True)
    output = capsys.readouterr().err
    assert output.split(CLEAR) == [
        "",
        "time: 1 of 3 turns, 4 s left",
        "time: 2 of 3 turns, 2 s left",
        "time: 3 of 3 turns, 0 s left\n",
    ]


@pytest.mark.parametrize(("watched", "before"), [(False, ""), (True, CLEAR)])
def test_a_line_between(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], watched: bool, before: str
) -> None:
    monkeypatch.setattr(sys.stderr, "isatty", lambda: watched, raising=False)
    say("history", "a word")
    assert capsys.readouterr().err == f"{before}history: a word\n"
