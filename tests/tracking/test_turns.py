"""Two programs in turns: only one of them runs at a time, their answers are their own, and nothing of them is left."""

from __future__ import annotations

import ast
import sys
import time
from pathlib import Path

import pytest

from bench.tracking import blocks
from bench.tracking.blocks import Job, NotMeasured
from bench.tracking.turns import SLICE, in_turns

# Writes when it ran, a line for each stretch of wall time without a gap.
CLOCK = """
import os, sys, time
child = os.fork() if "fork" in sys.argv else 0
begun, spans = time.monotonic(), [[time.monotonic(), time.monotonic()]]
while time.process_time() < 0.35:
    now = time.monotonic()
    if now - spans[-1][1] > 0.02:
        spans.append([now, now])
    spans[-1][1] = now
if not child:
    open(sys.argv[1], "w").write(repr(spans))
if child:
    os.wait()
if child or "fork" not in sys.argv:
    print(sys.argv[1])
"""


def job(folder: Path, *words: str, good: tuple[int, ...] = (0,)) -> Job[str]:
    return Job(list(words), folder, str.strip, good)


def python(folder: Path, *words: str) -> Job[str]:
    return job(folder, sys.executable, "-c", *words)


def overlap(one: list[list[float]], other: list[list[float]]) -> float:
    return sum(max(0.0, min(a[1], b[1]) - max(a[0], b[0])) for a in one for b in other)


@pytest.mark.parametrize("fork", [[], ["fork"]], ids=["alone", "with a child that works for it"])
def test_one_waits_while_the_other_runs(tmp_path: Path, fork: list[str]) -> None:
    """As it is with hausbench, whose children solve."""
    files = [tmp_path / name for name in ("a", "b")]
    assert in_turns([python(tmp_path, CLOCK, str(file), *fork) for file in files]) == [str(file) for file in files]
    spans = [ast.literal_eval(file.read_text()) for file in files]
    assert all(len(of) >= 3 for of in spans), f"at least three stretches in {0.35 / SLICE:.0f} turns"
    shared, time_of = overlap(*spans), min(sum(end - begin for begin, end in of) for of in spans)
    assert shared < 0.2 * time_of, f"{shared:.3f} s of {time_of:.3f} s"


def test_what_one_alone_gives(tmp_path: Path) -> None:
    assert in_turns([job(tmp_path, "echo", "alone")]) == ["alone"]
    assert in_turns([job(tmp_path, "sh", "-c", "pwd; exit 1", good=(0, 1))]) == [str(tmp_path.resolve())]


def test_a_long_answer_stops_nobody(tmp_path: Path) -> None:
    """More than a pipe holds."""
    found = in_turns([python(tmp_path, f"print('{letter}' * 300000)") for letter in "ab"])
    assert found == ["a" * 300000, "b" * 300000]


def test_one_that_fails_is_not_measured_and_the_other_is_ended(tmp_path: Path) -> None:
    with pytest.raises(NotMeasured, match="exit code 2: unknown solver"):
        in_turns([job(tmp_path, "sh", "-c", "echo unknown solver >&2; exit 2"), job(tmp_path, "echo", "fine")])
    with pytest.raises(NotMeasured, match="none does not run: No such file"):
        in_turns([python(tmp_path, "import os, time; open('pid', 'w').write(str(os.getpid())); time.sleep(60)"), job(tmp_path, str(tmp_path / "none"))])
    assert not list(tmp_path.iterdir()), "it was stopped before it did anything"


def test_programs_that_hang_are_ended_with_their_children(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(blocks, "LIMIT", 0.5)
    begun = time.monotonic()
    with pytest.raises(NotMeasured, match="no end within"):
        in_turns([python(tmp_path, f"import os, time; os.fork(); open('{name}' + str(os.getpid()), 'w'); time.sleep(60)") for name in "ab"])
    assert time.monotonic() - begun < 10
    left = [int(file.name[1:]) for file in tmp_path.iterdir()]
    assert len(left) == 4
    end = time.monotonic() + 5  # a killed child is there until init has taken note
    while any(running(pid) for pid in left) and time.monotonic() < end:
        time.sleep(0.05)
    assert not any(running(pid) for pid in left)


def running(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except FileNotFoundError:
        return False
