"""The command: its verdict, its exit codes, and what it refuses."""

from __future__ import annotations

import argparse
import json
import subprocess
from pathlib import Path

import pytest

from bench.tracking import counted, timed, track
from bench.tracking.blocks import NotMeasured
from bench.tracking.builds import Build, NotBuilt
from bench.tracking.cases import ROOT, cases
from bench.tracking.gate import Verdict
from bench.tracking.timed import Subject

PROGRAM = ROOT / "build/release/hausbench"


@pytest.fixture
def words(tmp_path: Path) -> list[str]:
    program = tmp_path / "hausbench"
    program.touch()
    return ["--program", str(program), "--record", str(tmp_path / "record.json"), "--baseline", str(tmp_path / "baseline.toml")]


def tiers(monkeypatch: pytest.MonkeyPatch, counters: Verdict = Verdict.passed, instructions: Verdict = Verdict.passed, slower: float = 1.0, planted: float = 1.05) -> None:
    """Every tier as it is, but for what measures."""
    monkeypatch.setattr(counted, "count_work", lambda *given: counted.Found(counters, ["a line"], {"a": {"shapes": "s"}}))
    monkeypatch.setattr(counted, "count_instructions", lambda *given: counted.Found(instructions, ["a line"], {"depends_on": "this", "a": 5}))
    monkeypatch.setattr(track, "here", lambda program: Build("candidate", program, None))
    monkeypatch.setattr(track, "build_of", lambda revision: Build("base", Path("old"), None))
    monkeypatch.setattr(track, "fetch", lambda tree, names: None)
    seconds = {"base": 1.0, "candidate": slower, "planted": slower * planted}
    monkeypatch.setattr(timed, "of_case", lambda case, programs, folder, plant: Subject(case.name, (case.name,), lambda side: {case.name: seconds[side]}, plant))


@pytest.mark.parametrize(("counters", "instructions", "slower", "planted", "code", "word"), [
    (Verdict.passed, Verdict.passed, 1.0, 1.05, 0, "passed"), (Verdict.slower, Verdict.passed, 1.0, 1.05, 3, "slower"),
    (Verdict.passed, Verdict.slower, 1.0, 1.05, 3, "slower"), (Verdict.passed, Verdict.passed, 1.05, 1.05, 3, "slower"),
    (Verdict.passed, Verdict.passed, 1.0, 1.01, 4, "inconclusive"), (Verdict.passed, Verdict.passed, 1.05, 1.01, 4, "inconclusive"),
    (Verdict.passed, Verdict.nothing_measured, 1.0, 1.05, 0, "passed")])
def test_exit_codes(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path, words: list[str], counters: Verdict,
                    instructions: Verdict, slower: float, planted: float, code: int, word: str) -> None:
    tiers(monkeypatch, counters, instructions, slower, planted)
    assert track.main([*words, "--blocks", "20"]) == code
    assert capsys.readouterr().out.splitlines()[-1].startswith(f"track: {word} (")
    record = json.loads((tmp_path / "record.json").read_text())
    assert record["verdict"] == word and record["base"] == "base" and len(record["blocks"]) == len(cases())


def test_nothing_measured_is_an_exit_code_of_its_own(monkeypatch: pytest.MonkeyPatch, words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    tiers(monkeypatch, instructions=Verdict.nothing_measured)
    assert track.main([*words, "--tiers", "instructions"]) == 5
    assert "instructions: nothing measured" in capsys.readouterr().out


def test_a_base_that_does_not_build(monkeypatch: pytest.MonkeyPatch, words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    def fails(revision: str) -> Build:
        raise NotBuilt(f"{revision} does not build")

    tiers(monkeypatch)
    monkeypatch.setattr(track, "build_of", fails)
    assert track.main([*words, "--base", "broken"]) == 5
    assert "broken does not build" in capsys.readouterr().err


def test_a_block_that_fails_is_inconclusive(monkeypatch: pytest.MonkeyPatch, words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    calls = []

    def side(which: str) -> dict[str, float]:
        calls.append(which)
        if len(calls) > 10:
            raise NotMeasured("no end within 120 s")
        return {"guthe on mesh to its half": 1.0}

    tiers(monkeypatch)
    monkeypatch.setattr(timed, "of_case", lambda case, programs, folder, plant: Subject(case.name, (case.name,), side, plant))
    assert track.main([*words, "--tiers", "time", "--case", "guthe"]) == 4
    assert "a block failed" in capsys.readouterr().out


def test_one_case_alone_is_the_one_with_the_plant(monkeypatch: pytest.MonkeyPatch, words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    tiers(monkeypatch)
    assert track.main([*words, "--tiers", "time", "--case", "naive", "--blocks", "20"]) == 0
    out = capsys.readouterr().out
    assert "naive on points near" in out and "with 5 % planted" in out and "guthe" not in out


def test_an_update_writes_the_baseline_and_no_times(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, words: list[str]) -> None:
    tiers(monkeypatch, counters=Verdict.slower)
    assert track.main([*words, "--update", "a new cut"]) == 0
    baseline = counted.read_baseline(tmp_path / "baseline.toml")
    assert baseline["reason"] == "a new cut" and baseline["counters"] == {"a": {"shapes": "s"}} and not (tmp_path / "record.json").exists()


@pytest.mark.parametrize(("given", "message"), [
    (["--tiers", "clock"], "there is no tier 'clock'"), (["--blocks", "21"], "even number"), (["--blocks", "6"], "at least 20"), (["--blocks", "many"], "even number")])
def test_mistakes_in_the_command(given: list[str], message: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as end:
        track.main(given)
    assert end.value.code == 2 and message in capsys.readouterr().err


def test_a_case_that_is_not_there(words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert track.main([*words, "--case", "gute"]) == 2
    assert "there is no case 'gute'" in capsys.readouterr().err


def test_a_revision_that_is_not_there(monkeypatch: pytest.MonkeyPatch, words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert track.main([*words, "--tiers", "time", "--base", "no-such-revision"]) == 5
    assert "no-such-revision" in capsys.readouterr().err


def test_tiers_are_read_as_a_list() -> None:
    assert track.tiers("counters,time") == ["counters", "time"]
    with pytest.raises(argparse.ArgumentTypeError):
        track.tiers("")


@pytest.mark.skipif(not PROGRAM.is_file(), reason="the program is not built")
def test_the_verb_hands_over_its_words_and_its_exit_code(tmp_path: Path) -> None:
    done = subprocess.run([PROGRAM, "track", "--blocks", "3"], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 2 and "hausbench track: error: argument --blocks" in done.stderr
    done = subprocess.run([PROGRAM, "track", "--help"], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0 and "--tiers" in done.stdout
    done = subprocess.run([PROGRAM, "track"], cwd=tmp_path, capture_output=True, text=True, check=False, env={"PYTHON": "/no/python"})
    assert done.returncode == 2 and "cannot run /no/python" in done.stderr and "set PYTHON" in done.stderr
