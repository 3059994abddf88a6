"""Blocks in turn: which side runs when, and what is kept of it."""

from __future__ import annotations

from pathlib import Path

import pytest

from bench.tracking import timed
from bench.tracking.blocks import Block, NotMeasured
from bench.tracking.builds import Build
from bench.tracking.cases import Case
from bench.tracking.timed import Subject, blocks, judge_all, known, of_case, programs_of

SECONDS = {"base": 1.0, "candidate": 1.0, "planted": 1.05}


def subject(name: str, calls: list[tuple[str, str]], seconds: dict[str, float] = SECONDS, planted: bool = False) -> Subject:
    def side(which: str) -> dict[str, float]:
        calls.append((name, which))
        return {name: seconds[which] + 1e-6 * len(calls)}

    return Subject(name, (name,), side, planted)


def test_each_block_of_the_candidate_is_beside_one_of_the_base() -> None:
    calls: list[tuple[str, str]] = []
    found = blocks([subject("a", calls), subject("b", calls, planted=True)], 4)
    plain = ["base", "candidate", "candidate", "base"]
    turned = ["candidate", "base", "base", "candidate"]
    assert [which for name, which in calls if name == "a"] == plain + turned
    assert [which for name, which in calls if name == "b"] == ["base", "candidate", "planted", "planted", "candidate", "base", "planted", *turned, "planted"]
    assert [name for name, _ in calls[:4]] == ["a"] * 4, "one subject at a time"
    assert len(found["a"].base) == len(found["a"].candidate) == 4 and not found["a"].planted
    assert len(found["b"].planted) == 4
    assert found["a"].base == sorted(found["a"].base), "in the order of time, so that block i stands beside block i"


def test_only_what_alarms_runs_again() -> None:
    calls: list[tuple[str, str]] = []
    slow = {"base": 1.0, "candidate": 1.2, "planted": 1.26}
    judged, sides = judge_all([subject("fine", calls, planted=True), subject("slow", calls, slow)], 20, lambda line: None)
    assert [name for name, _ in calls].count("fine") == 60 and [name for name, _ in calls].count("slow") == 80
    by_name = {one.name: one for one in judged}
    assert by_name["slow"].slower and not by_name["fine"].alarms and by_name["fine"].planted.n == 20
    assert len(sides["slow"].base) == 20, "the second run is on its own"


def test_what_only_one_build_knows_is_left_out() -> None:
    said: list[str] = []

    def side(which: str) -> dict[str, float]:
        return {"old": 1.0, "new": 1.0} if which == "candidate" else {"old": 1.0}

    kept = known(Subject("kernels", ("old", "new"), side), said.append)
    assert kept is not None and kept.names == ("old",) and "new: left out" in said[0]


def test_a_case_that_fails_is_left_out_with_its_reason() -> None:
    def side(which: str) -> dict[str, float]:
        raise NotMeasured("unknown solver 'cover'")

    said: list[str] = []
    assert known(Subject("cover", ("cover",), side), said.append) is None
    assert said == ["cover: left out: unknown solver 'cover'"]


def test_the_first_block_decides_how_many_repeats_all_have(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    asked: list[tuple[str, int, float]] = []

    def measure(program: Path, case: Case, folder: Path, slowdown: float) -> Block:
        asked.append((program.name, case.experiment["repeats"], slowdown))
        return Block(0.002 * len(asked), 0.002, 0.0, "shapes")

    monkeypatch.setattr(timed, "measure", measure)
    programs = {"base": Path("old"), "candidate": Path("new"), "planted": Path("new")}
    one = of_case(Case("case", {"repeats": 3}), programs, tmp_path, True)
    for which in ("base", "candidate", "planted"):
        one.side(which)
    assert asked == [("old", 3, 0), ("new", 20, 0), ("new", 20, 0.05)]


def test_a_slow_case_keeps_the_repeats_of_the_experiment(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    repeats: list[int] = []

    def measure(program: Path, case: Case, folder: Path, slowdown: float) -> Block:
        repeats.append(case.experiment["repeats"])
        return Block(1.0, 1.0, 0.0, "shapes")

    monkeypatch.setattr(timed, "measure", measure)
    one = of_case(Case("case", {"repeats": 3}), {"base": Path("p"), "candidate": Path("p")}, tmp_path, False)
    assert one.side("base") == one.side("candidate") == {"case": 1.0} and repeats == [3, 3]


def test_kernels_need_both_builds() -> None:
    old, new = Build("a", Path("old"), None), Build("b", Path("new"), Path("bench"))
    assert programs_of(old, new)[1] == {}
    assert programs_of(new, new)[1] == {"base": Path("bench"), "candidate": Path("bench")}
    assert programs_of(old, new)[0] == {"base": Path("old"), "candidate": Path("new"), "planted": Path("new")}
