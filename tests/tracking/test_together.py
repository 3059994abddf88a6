"""Tests two programs run at the same time: each gives its own answer, and neither leaves a process
or file behind."""

from __future__ import annotations

import os
import sys
import time
from pathlib import Path

import pytest

from bench.tracking import blocks
from bench.tracking.blocks import Job, NotMeasured
from bench.tracking.together import one_core, together


def job(folder: Path, *words: str, good: tuple[int, ...] = (0,)) -> Job[str]:
    return Job(list(words), folder, str.strip, good)


def python(folder: Path, *words: str) -> Job[str]:
    return job(folder, sys.executable, "-c", *words)


def test_both_run_at_the_same_time(tmp_path: Path) -> None:
    """Each program waits for the other."""
    meet = "import os, sys, time\nopen(sys.argv[1], 'w')\nwhile not os.path.exists(sys.argv[2]): time.sleep(0.01)\nprint(sys.argv[1])"
    assert together([python(tmp_path, meet, "a", "b"), python(tmp_path, meet, "b", "a")]) == [
        "a",
        "b",
    ]


def test_both_share_one_core(tmp_path: Path) -> None:
    before = os.sched_getaffinity(0)
    with pytest.raises(KeyError), one_core():
        answers = together([python(tmp_path, "import os; print(*os.sched_getaffinity(0))")] * 2)
        raise KeyError
    assert answers == [str(max(before))] * 2 and os.sched_getaffinity(0) == before


def test_what_one_alone_gives(tmp_path: Path) -> None:
    assert together([job(tmp_path, "echo", "alone")]) == ["alone"]
    assert together([job(tmp_path, "sh", "-c", "pwd; exit 1", good=(0, 1))]) == [
        str(tmp_path.resolve())
    ]


def test_a_long_answer_stops_nobody(tmp_path: Path) -> None:
    """The answer is longer than a pipe's buffer."""
    answers = together([python(tmp_path, f"print('{letter}' * 300000)") for letter in "ab"])
    assert answers == ["a" * 300000, "b" * 300000]


def test_one_that_fails_is_not_measured_and_the_other_is_ended(tmp_path: Path) -> None:
    begun = time.monotonic()
    sleeping, failing = ["sh", "-c", "echo $$ > pid; exec sleep 60"], [
        "sh",
        "-c",
        "while ! [ -s pid ]; do sleep 0.01; done; echo unknown solver >&2; exit 2",
    ]
    for jobs in ([sleeping, failing], [failing, sleeping]):
        with pytest.raises(NotMeasured, match="exit code 2: unknown solver"):
            together([job(tmp_path, *words) for words in jobs])
        assert not Path(f"/proc/{(tmp_path / 'pid').read_text().strip()}").exists()
        (tmp_path / "pid").unlink()
    with pytest.raises(NotMeasured, match="none does not run: No such file"):
        together([job(tmp_path, "sleep", "60"), job(tmp_path, str(tmp_path / "none"))])
    assert time.monotonic() - begun < 30


def test_each_has_the_root_of_its_own_tree(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each program gets its own HAUSBENCH_ROOT or none, never the environment's."""
    monkeypatch.setenv("HAUSBENCH_ROOT", "another")
    say = ["sh", "-c", "echo root $HAUSBENCH_ROOT"]
    jobs = [
        Job(say, tmp_path, str.strip, root=root) for root in (tmp_path / "1", tmp_path / "2", None)
    ]
    assert together(jobs) == [f"root {tmp_path / '1'}", f"root {tmp_path / '2'}", "root"]


def test_programs_that_hang_are_ended(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(blocks, "LIMIT", 2.0)
    with pytest.raises(NotMeasured, match="no end within 2 s"):
        together(
            [
                python(
                    tmp_path,
                    f"import os, time; open('{name}' + str(os.getpid()), 'w'); time.sleep(60)",
                )
                for name in "ab"
            ]
        )
    left = [int(file.name[1:]) for file in tmp_path.iterdir()]
    assert len(left) == 2 and not any(Path(f"/proc/{pid}").exists() for pid in left)
