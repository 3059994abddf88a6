"""The counting of instructions: what it says of more, of fewer, and of a machine that it has no baseline for."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

import instructions

PROGRAM = instructions.ROOT / "build/release/hausbench"


@pytest.mark.parametrize("now, said, good", [(1004, "as before", True), (1006, "slower", False), (994, "--update", False), (996, "as before", True)])
def test_half_a_percent_is_the_limit(now: int, said: str, good: bool) -> None:
    text, same = instructions.verdict(now, 1000)
    assert said in text and same is good


def test_without_a_baseline_nothing_is_measured(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert instructions.main(["--program", "/bin/false", "--baseline", str(tmp_path / "none.toml")]) == 5
    assert "nothing measured" in capsys.readouterr().out


def test_a_program_that_cannot_be_counted(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert instructions.main(["--program", "/bin/false", "--baseline", str(tmp_path / "none.toml"), "--update", "why"]) == 2
    assert "/bin/false" in capsys.readouterr().err


@pytest.mark.skipif(not PROGRAM.is_file() or not shutil.which("valgrind"), reason="the program is not built, or valgrind is missing")
def test_counts_are_the_same_from_run_to_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(instructions, "CASES", [case for case in instructions.CASES if case.solver == "ohd"])
    baseline = tmp_path / "baseline.toml"
    assert instructions.run(PROGRAM, 'a "first" count', baseline) == 0
    assert instructions.run(PROGRAM, None, baseline) == 0
    number = next(line for line in baseline.read_text().splitlines() if line.startswith("ohd = "))
    baseline.write_text(baseline.read_text().replace(number, f"ohd = {int(int(number[6:]) / 1.01)}"))
    assert instructions.run(PROGRAM, None, baseline) == 3
