"""Tests the command `track`: its verdict, exit codes and refused arguments."""

from __future__ import annotations

import argparse
import json
import os
import subprocess
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import pytest

from bench.tracking import counted, timed, track
from bench.tracking.blocks import NotMeasured
from bench.tracking.builds import Build, NotBuilt
from bench.tracking.cases import KERNELS, ROOT, Case, Kernel, cases
from bench.tracking.gate import Verdict
from bench.tracking.places import Places
from bench.tracking.timed import Subject

PROGRAM = ROOT / "build/release/hausbench"


@pytest.fixture
def words(tmp_path: Path) -> list[str]:
    program = tmp_path / "hausbench"
    program.touch()
    return [
        "--program",
        str(program),
        "--record",
        str(tmp_path / "record.json"),
        "--baseline",
        str(tmp_path / "baseline.toml"),
    ]


def each(
    side: Callable[[str, Sequence[str]], dict[str, float]]
) -> Callable[[Sequence[str], Sequence[str]], list[dict[str, float]]]:
    """Measures the block of each side separately."""
    return lambda sides, names: [side(build, names) for build in sides]


SECONDS = {"base": 1.0, "base again": 1.0, "candidate": 1.0}


def tiers(
    monkeypatch: pytest.MonkeyPatch,
    counters: Verdict = Verdict.passed,
    instructions: Verdict = Verdict.passed,
    seconds: dict[str, float] = SECONDS,
) -> dict[str, list[Any]]:
    """Replaces every measurement with the given verdicts; returns a record of the requests."""
    requests: dict[str, list[Any]] = {"jobs": [], "timed": [], "self-test": [], "fetched": []}

    def of_case(
        case: Case, programs: dict[str, timed.Program], folder: Path, places: Places
    ) -> Subject:
        def side(build: str, _: Sequence[str]) -> dict[str, float]:
            requests["self-test"] += [case.name] if build == "base again" else []
            return {case.name: seconds[build]}

        requests["timed"].append(case.name)
        return Subject(case.name, (case.name,), each(side), shapes={"base": "s"})

    def of_kernels(
        names: list[str], programs: dict[str, timed.Program], folder: Path, places: Places
    ) -> Subject:
        requests["timed"] += names
        return Subject(
            "kernels", tuple(names), lambda sides, some: [dict.fromkeys(some, 1.0) for _ in sides]
        )

    def jobs_of(
        selected: list[Case],
        kernels: list[Kernel],
        program: Path,
        kernel_program: Path | None,
        folder: Path,
    ) -> counted.Counting:
        requests["jobs"] += [case.name for case in selected]
        requests["jobs"] += [kernel.name for kernel in kernels]
        return {}

    monkeypatch.setattr(
        counted,
        "count_work",
        lambda *given: counted.Found(counters, ["a line"], {"a": {"shapes": "s"}}),
    )
    monkeypatch.setattr(counted, "jobs_of", jobs_of)
    monkeypatch.setattr(
        counted,
        "count_instructions",
        lambda *given: counted.Found(instructions, ["a line"], {"depends_on": "this", "a": 5}),
    )
    monkeypatch.setattr(track, "here", lambda program: Build("candidate", program, Path("kernels")))
    monkeypatch.setattr(track, "commit_of", lambda revision: revision)
    monkeypatch.setattr(
        track,
        "build_of",
        lambda revision: Build("base", Path("old"), Path("kernels"), Path("tree of the base")),
    )
    monkeypatch.setattr(
        track, "fetch", lambda tree, names: requests["fetched"].append((tree, set(names)))
    )
    monkeypatch.setattr(timed, "programs_of", lambda base, candidate: {})
    monkeypatch.setattr(timed, "kernels_of", lambda base, candidate: {"base": Path("kernels")})
    monkeypatch.setattr(timed, "of_case", of_case)
    monkeypatch.setattr(timed, "of_kernels", of_kernels)
    return requests


def slower(candidate: float, again: float = 1.0) -> dict[str, float]:
    return SECONDS | {"candidate": candidate, "base again": again}


@pytest.mark.parametrize(
    ("counters", "instructions", "seconds", "code", "word"),
    [
        (Verdict.passed, Verdict.passed, slower(1.0), 0, "passed"),
        (Verdict.red, Verdict.passed, slower(1.0), 3, "red"),
        (Verdict.passed, Verdict.red, slower(1.0), 3, "red"),
        (Verdict.passed, Verdict.passed, slower(1.05), 3, "red"),
        (Verdict.passed, Verdict.passed, slower(1.0, 0.97), 4, "inconclusive"),
        (Verdict.passed, Verdict.passed, slower(1.05, 0.97), 4, "inconclusive"),
        (Verdict.passed, Verdict.nothing_measured, slower(1.0), 0, "passed"),
    ],
)
def test_exit_codes(
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    words: list[str],
    counters: Verdict,
    instructions: Verdict,
    seconds: dict[str, float],
    code: int,
    word: str,
) -> None:
    tiers(monkeypatch, counters, instructions, seconds)
    assert track.main([*words, "--blocks", "24"]) == code
    assert capsys.readouterr().out.splitlines()[-1].startswith(f"track: {word} (")
    record = json.loads((tmp_path / "record.json").read_text())
    assert (
        record["verdict"] == word
        and record["base"] == "base"
        and len(record["runs"][0]) == len(cases()) + len(KERNELS)
    )


def test_every_case_and_kernel_is_counted_and_timed_and_one_has_the_self_test(
    monkeypatch: pytest.MonkeyPatch, words: list[str]
) -> None:
    requests = tiers(monkeypatch)
    assert track.main([*words, "--blocks", "24"]) == 0
    names = [case.name for case in cases()]
    names += [kernel.name for kernel in KERNELS]
    assert requests["jobs"] == requests["timed"] == names and set(requests["self-test"]) == {
        track.SELF_TEST
    }
    assert requests["fetched"] == [
        (Path("tree of the base"), {model for case in cases() for model in case.models})
    ]


def test_nothing_measured_is_an_exit_code_of_its_own(
    monkeypatch: pytest.MonkeyPatch, words: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    tiers(monkeypatch, instructions=Verdict.nothing_measured)
    assert track.main([*words, "--tiers", "instructions"]) == 5
    assert "instructions: nothing measured" in capsys.readouterr().out


@pytest.mark.parametrize(("counters", "code"), [(Verdict.passed, 0), (Verdict.red, 3)])
def test_a_base_that_does_not_build_spoils_no_other_tier(
    monkeypatch: pytest.MonkeyPatch,
    words: list[str],
    capsys: pytest.CaptureFixture[str],
    counters: Verdict,
    code: int,
) -> None:
    def fails(revision: str) -> Build:
        raise NotBuilt(f"{revision} does not build")

    tiers(monkeypatch, counters)
    monkeypatch.setattr(track, "build_of", fails)
    assert track.main([*words, "--base", "broken"]) == code
    assert "broken does not build" in capsys.readouterr().out
    assert track.main([*words, "--base", "broken", "--tiers", "time"]) == 5


@pytest.mark.parametrize(
    "problem",
    [counted.Missing("no valgrind: make deps"), RuntimeError("a surprise"), KeyError("cases")],
)
def test_a_tier_that_breaks_says_so_and_the_others_run(
    monkeypatch: pytest.MonkeyPatch,
    words: list[str],
    capsys: pytest.CaptureFixture[str],
    problem: Exception,
) -> None:
    def fails(*given: object) -> counted.Found:
        raise problem

    tiers(monkeypatch)
    monkeypatch.setattr(counted, "count_instructions", fails)
    assert track.main([*words, "--blocks", "24"]) == 0
    out = capsys.readouterr().out
    assert "instructions: nothing measured" in out and str(problem) in out and "time: passed" in out


def test_a_case_that_this_build_alone_fails_at_is_red(
    monkeypatch: pytest.MonkeyPatch, words: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    tiers(monkeypatch)

    def side(build: str, _: Sequence[str]) -> dict[str, float]:
        if build == "candidate":
            raise NotMeasured("time_limit: not within 20 s")
        return {"guthe on mesh to its half": 1.0}

    monkeypatch.setattr(
        timed,
        "of_case",
        lambda case, programs, folder, places: Subject(case.name, (case.name,), each(side)),
    )
    assert track.main([*words, "--tiers", "time", "--case", "guthe"]) == 3
    assert "this build does not: time_limit" in capsys.readouterr().out


def test_a_block_that_fails_is_inconclusive(
    monkeypatch: pytest.MonkeyPatch, words: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    calls = []

    def side(build: str, _: Sequence[str]) -> dict[str, float]:
        calls.append(build)
        if len(calls) > 10:
            raise NotMeasured("no end within 120 s")
        return {"guthe on mesh to its half": 1.0}

    tiers(monkeypatch)
    monkeypatch.setattr(
        timed,
        "of_case",
        lambda case, programs, folder, places: Subject(
            case.name, (case.name,), each(side), shapes={"base": "s"}
        ),
    )
    assert track.main([*words, "--tiers", "time", "--case", "guthe"]) == 4
    assert "a block failed" in capsys.readouterr().out


def test_one_case_alone_is_the_one_with_the_self_test(
    monkeypatch: pytest.MonkeyPatch, words: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    requests = tiers(monkeypatch)
    assert track.main([*words, "--case", "naive", "--blocks", "24"]) == 0
    out = capsys.readouterr().out
    assert "with 5 % planted" in out and requests["jobs"] == requests["timed"] == [
        "naive on points near"
    ] == list(dict.fromkeys(requests["self-test"]))


def test_a_second_run_is_in_the_table_and_in_the_record(
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    words: list[str],
    capsys: pytest.CaptureFixture[str],
) -> None:
    tiers(monkeypatch, seconds=slower(1.1))
    assert track.main([*words, "--tiers", "time", "--case", "naive", "--blocks", "24"]) == 3
    out = capsys.readouterr().out
    assert (
        "in a second run" in out
        and "the base beside itself" in out
        and len(json.loads((tmp_path / "record.json").read_text())["runs"]) == 3
    )


def test_an_update_writes_the_baseline_and_no_times(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, words: list[str]
) -> None:
    requests = tiers(monkeypatch, counters=Verdict.red)
    assert track.main([*words, "--update", "a new cut", "--case", "naive"]) == 0
    baseline = counted.read_baseline(tmp_path / "baseline.toml")
    assert (
        baseline["reason"] == "a new cut"
        and baseline["counters"] == {"a": {"shapes": "s"}}
        and not requests["timed"]
    )
    assert not (tmp_path / "record.json").exists()


def test_an_update_of_nothing_is_refused(
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    words: list[str],
    capsys: pytest.CaptureFixture[str],
) -> None:
    tiers(monkeypatch)
    monkeypatch.setattr(counted, "count_work", lambda *given: counted.Found())
    monkeypatch.setattr(counted, "count_small_scenes", lambda *given: {})
    monkeypatch.setattr(
        counted, "count_instructions", lambda *given: counted.Found(measured={"depends_on": "this"})
    )
    assert track.main([*words, "--update", "why"]) == 5
    assert (
        "baseline is unchanged" in capsys.readouterr().err
        and not (tmp_path / "baseline.toml").exists()
    )


def test_a_record_that_cannot_be_written_loses_no_verdict(
    monkeypatch: pytest.MonkeyPatch, words: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    tiers(monkeypatch, counters=Verdict.red)
    assert track.main([*words, "--tiers", "counters", "--record", "/dev/null/record.json"]) == 3
    output = capsys.readouterr()
    assert "not written" in output.err and "track: red" in output.out


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (["--tiers", "clock"], "there is no tier 'clock'"),
        (["--blocks", "25"], "even number"),
        (["--blocks", "6"], "at least 24"),
        (["--blocks", "many"], "even number"),
        (["--update", "why", "--tiers", "time"], "leave out --tiers time"),
    ],
)
def test_mistakes_in_the_command(
    given: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as end:
        track.main(given)
    assert end.value.code == 2 and message in capsys.readouterr().err


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (["--case", "gute"], "there is no case 'gute'"),
        (["--base", "no-such-revision"], "no-such-revision: there is no such commit"),
        (["--base-program", "/no/program"], "/no/program is missing"),
        (["--program", "/no/hausbench"], "/no/hausbench is missing"),
    ],
)
def test_what_is_not_there_is_told_before_anything_runs(
    monkeypatch: pytest.MonkeyPatch,
    words: list[str],
    capsys: pytest.CaptureFixture[str],
    given: list[str],
    message: str,
) -> None:
    monkeypatch.setattr(counted, "count_work", lambda *given: pytest.fail("something ran"))
    assert track.main([*words, *given]) == 2
    assert message in capsys.readouterr().err


def test_tiers_are_read_as_a_list() -> None:
    assert track.tiers("counters,time") == ["counters", "time"]
    with pytest.raises(argparse.ArgumentTypeError):
        track.tiers("")


@pytest.mark.skipif(not PROGRAM.is_file(), reason="the program is not built")
def test_the_verb_hands_over_its_words_and_its_exit_code(tmp_path: Path) -> None:
    done = subprocess.run(
        [PROGRAM, "track", "--blocks", "3"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 2 and "hausbench track: error: argument --blocks" in done.stderr
    done = subprocess.run(
        [PROGRAM, "track", "--help"], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0 and "--tiers" in done.stdout
    (tmp_path / "numpy.py").write_text(
        "raise SystemExit(9)\n"
    )  # a file in the current folder must not be imported
    alone = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    assert (
        subprocess.run(
            [PROGRAM, "track", "--help"], cwd=tmp_path, capture_output=True, check=False, env=alone
        ).returncode
        == 0
    )
    done = subprocess.run(
        [PROGRAM, "track"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
        env={"PYTHON": "/no/python"},
    )
    assert (
        done.returncode == 2
        and "cannot run /no/python" in done.stderr
        and "set PYTHON" in done.stderr
    )
