"""Blocks in turn: which side runs when, and what is kept of it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pytest

from bench.tracking import timed
from bench.tracking.blocks import Block, NotMeasured
from bench.tracking.builds import Build
from bench.tracking.cases import Case
from bench.tracking.timed import Known, Placed, Subject, blocks, judge_all, kernels_of, of_case, programs_of

SECONDS = {"base": 1.0, "candidate": 1.0, "planted": 1.05}
Calls = list[tuple[str, str]]


def subject(name: str, calls: Calls, seconds: dict[str, float] = SECONDS, planted: bool = False) -> Subject:
    def side(which: str, _: Sequence[str]) -> dict[str, float]:
        calls.append((name, which))
        return {name: seconds[which] + 1e-6 * len(calls)}

    return Subject(name, (name,), side, planted, {"base": "shapes"})


def test_each_block_of_the_candidate_is_beside_one_of_the_base() -> None:
    calls: Calls = []
    found = blocks([subject("a", calls), subject("b", calls, planted=True)], 4)
    plain, turned = ["base", "candidate", "candidate", "base"], ["candidate", "base", "base", "candidate"]
    assert [call[1] for call in calls if call[0] == "a"] == plain + turned
    assert [call[1] for call in calls if call[0] == "b"] == [*plain[:2], "planted", "planted", *plain[2:], "planted", *turned, "planted"]
    assert [call[0] for call in calls[:4]] == ["a"] * 4, "one subject at a time"
    assert len(found["a"].base) == len(found["a"].candidate) == 4 and not found["a"].planted
    assert len(found["b"].planted) == 4
    assert found["a"].base == sorted(found["a"].base), "in the order of time, so that block i stands beside block i"


def test_only_what_alarms_runs_again() -> None:
    calls: Calls = []
    slow = {"base": 1.0, "candidate": 1.2, "planted": 1.26}
    judged, runs = judge_all([subject("fine", calls, planted=True), subject("slow", calls, slow)], 24, lambda line: None)
    assert [call[0] for call in calls].count("fine") == 72 and [call[0] for call in calls].count("slow") == 96
    by_name = {one.name: one for one in judged}
    assert by_name["slow"].red and not by_name["fine"].alarms and by_name["fine"].planted.n == 24
    assert [sorted(run) for run in runs] == [["fine", "slow"], ["slow"]], "both runs are kept"


def test_what_looks_slower_and_what_has_the_plant_get_more_blocks() -> None:
    """`doubtful` is slower by 2.5 %, which is no alarm; `slow` alarms, and runs again with as many blocks."""
    calls: Calls = []
    doubtful, slow = ({"base": 1.0, "candidate": 1 + much, "planted": 1.0} for much in (0.025, 0.05))
    subjects = [subject("fine", calls), subject("planted", calls, planted=True), subject("doubtful", calls, doubtful), subject("slow", calls, slow)]
    said: list[str] = []
    judged, runs = judge_all(subjects, 72, said.append)
    assert [one.ratio.n for one in judged] == [24, 72, 72, 72] and [one.second.n for one in judged] == [0, 0, 0, 72]
    assert [len(side.planted) for side in runs[0].values()] == [0, 72, 0, 0] and not runs[1]["slow"].planted
    assert [one.name for one in judged if one.red] == ["slow"] and all(one.ratio.coverage >= 1 - 0.05 / 4 for one in judged)
    assert said == ["more blocks of doubtful, slow", "a second run of slow"]
    assert {name for name, _ in calls[-144:]} == {"slow"}


def test_of_many_kernels_only_the_suspected_ones_are_measured_again() -> None:
    asked: list[Sequence[str]] = []

    def side(which: str, some: Sequence[str]) -> dict[str, float]:
        asked.append(some)
        return {name: 1.1 if which == "candidate" and name == "b" else 1.0 for name in some}

    judged, _ = judge_all([Subject("kernels", ("a", "b", "c"), side)], 26, lambda line: None)
    assert asked == [("a", "b", "c")] * 48 + [("b",)] * 4 + [("b",)] * 52 and [one.red for one in judged] == [False, True, False]


def test_intervals_are_as_wide_as_so_many_cases_need() -> None:
    """The second run is independent of the first, and has one case."""
    names = tuple(f"case {i}" for i in range(60))

    def side(which: str, _: Sequence[str]) -> dict[str, float]:
        return {name: 1.2 if which == "candidate" and name == "case 0" else 1.0 for name in names}

    judged, _ = judge_all([Subject("all", names, side)], 24, lambda line: None)
    assert min(one.ratio.coverage for one in judged) >= 1 - 0.05 / 60 > judged[0].second.coverage >= 0.95


def known_of(base: dict[str, float] | NotMeasured, candidate: dict[str, float] | NotMeasured, shapes: dict[str, str] | None = None) -> Known:
    def side(which: str, _: Sequence[str]) -> dict[str, float]:
        found = base if which == "base" else candidate
        if isinstance(found, NotMeasured):
            raise found
        return found

    known = Known()
    known.add(Subject("case", ("old", "new"), side, shapes=shapes or {}))
    return known


def test_what_only_one_build_has_is_left_out() -> None:
    known = known_of({"old": 1.0}, {"old": 1.0, "new": 1.0})
    assert [one.names for one in known.subjects] == [("old",)] and known.left_out == ["new: left out, since the base does not have it"]
    assert known_of({"old": 1.0, "new": 1.0}, {"old": 1.0}).left_out == ["new: left out, since this build does not have it"]
    assert not known_of({"old": 1.0}, {"new": 1.0}).subjects


def test_a_case_that_the_base_does_not_know_is_left_out() -> None:
    known = known_of(NotMeasured("unknown solver 'cover'"), {"old": 1.0})
    assert not known.subjects and not known.broken and "unknown solver" in known.left_out[0]


def test_a_case_that_this_build_alone_fails_at_is_broken() -> None:
    known = known_of({"old": 1.0, "new": 1.0}, NotMeasured("time_limit: not within 20 s"))
    assert not known.subjects and "time_limit" in known.broken[0] and not known.left_out
    known = known_of({"old": 1.0, "new": 1.0}, NotMeasured("skipped: not fetched", skipped=True))
    assert not known.broken and "not fetched" in known.left_out[0]


def test_other_shapes_are_left_out() -> None:
    known = known_of({"old": 1.0, "new": 1.0}, {"old": 2.0, "new": 2.0}, {"base": "a", "candidate": "b"})
    assert not known.subjects and "its shapes are not those of the base" in known.left_out[0]


def test_the_plant_is_in_the_case_that_is_wanted_or_in_the_first_one() -> None:
    calls: Calls = []
    kernels = Subject("kernels", ("build",), lambda which, names: {})
    for wanted, chosen in (("b", "b"), ("not fetched", "a")):
        known = Known([kernels, subject("a", calls), subject("b", calls)])
        known.plant(wanted)
        assert [one.name for one in known.subjects if one.planted] == [chosen]
    known = Known([kernels])
    known.plant("b")
    assert not known.subjects[0].planted


def test_a_kernel_that_is_gone_in_one_block_is_no_lists_out_of_step() -> None:
    calls = []

    def side(which: str, _: Sequence[str]) -> dict[str, float]:
        calls.append(which)
        return {"old": 1.0} if len(calls) == 3 else {"old": 1.0, "new": 1.0}

    with pytest.raises(NotMeasured, match="new: it was not measured this time"):
        blocks([Subject("kernels", ("old", "new"), side)], 24)


@pytest.mark.parametrize(("seconds", "repeats"), [(0.002, 20), (1.0, 3), (0.0001, 40)])
def test_the_first_block_decides_how_many_repeats_all_have(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, seconds: float, repeats: int) -> None:
    """Three, which the experiment asks for, at least."""
    asked: list[tuple[str, int, float]] = []

    def measure(program: Path, case: Case, folder: Path, slowdown: float, root: Path) -> Block:
        assert root == tmp_path / program.name[:3]
        asked.append((program.name, case.experiment["repeats"], slowdown))
        return Block(seconds * len(asked), 0.002, 0.0, "shapes")

    monkeypatch.setattr(timed, "measure", measure)
    old, new = (Placed(tmp_path / f"{name}-program", tmp_path / name) for name in ("old", "new"))
    programs = {"base": old, "candidate": new, "planted": new}
    one = of_case(Case("case", {"repeats": 3}), programs, tmp_path)
    for which in ("base", "candidate", "planted"):
        one.block(which)
    assert asked == [("old-program", 3, 0), ("new-program", repeats, 0), ("new-program", repeats, 0.05)]
    assert one.shapes == {"base": "shapes", "candidate": "shapes", "planted": "shapes"}


def test_paths_of_both_trees_are_of_one_length(tmp_path: Path) -> None:
    for name in ("a", "a/long/way/down"):
        (tmp_path / name).mkdir(parents=True, exist_ok=True)
    old, new = Build("a", Path("old"), None, tmp_path / "a/long/way/down"), Build("b", Path("new"), Path("bench"), tmp_path / "a")
    programs = programs_of(old, new, tmp_path)
    assert len(str(programs["base"].root)) == len(str(programs["candidate"].root)) and programs["planted"] == programs["candidate"]
    assert programs["base"].root.resolve() == old.tree and programs["candidate"].root.resolve() == new.tree
    assert (programs["base"].program, programs["candidate"].program) == (Path("old"), Path("new"))


def test_kernels_need_both_builds() -> None:
    old, new = Build("a", Path("old"), None), Build("b", Path("new"), Path("bench"))
    assert kernels_of(old, new) == {} and kernels_of(new, new) == {"base": Path("bench"), "candidate": Path("bench")}
