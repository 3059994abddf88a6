"""Tests how pairs of blocks are timed: the order of the sides, and what is recorded."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import pytest

from analysis.shared.estimates import order_statistic_rank
from bench.tracking import timed
from bench.tracking.blocks import Block, NotMeasured
from bench.tracking.builds import Build
from bench.tracking.cases import ROOT, Case
from bench.tracking.gate import Verdict, verdict_of_times
from bench.tracking.places import Places
from bench.tracking.timed import (
    Known,
    Program,
    Subject,
    answer,
    judge_all,
    kernels_of,
    of_case,
    of_kernels,
    planted,
    programs_of,
    question,
    screen,
)

PROGRAM = ROOT / "build/release/hausbench"

SECONDS = {"base": 1.0, "base again": 1.0, "candidate": 1.0}
Calls = list[tuple[str, str]]


def each(
    side: Callable[[str, Sequence[str]], dict[str, float]]
) -> Callable[[Sequence[str], Sequence[str]], list[dict[str, float]]]:
    """Measures the block of each side separately."""
    return lambda sides, names: [side(build, names) for build in sides]


def subject(name: str, calls: Calls, seconds: dict[str, float] = SECONDS) -> Subject:
    def side(build: str, _: Sequence[str]) -> dict[str, float]:
        calls.append((name, build))
        return {name: seconds[build] + 1e-6 * len(calls)}

    return Subject(name, (name,), each(side), {"base": "shapes"})


def slower(much: float) -> dict[str, float]:
    return SECONDS | {"candidate": 1 + much}


def test_each_block_of_the_candidate_is_beside_one_of_the_base() -> None:
    calls: Calls = []
    questions = [question(subject(name, calls), (name,)) for name in ("a", "b")]
    screen(questions, 4)
    plain, turned = ["base", "candidate", "candidate", "base"], [
        "candidate",
        "base",
        "base",
        "candidate",
    ]
    for name in ("a", "b"):
        assert [call[1] for call in calls if call[0] == name] == plain + turned
    assert [call[0] for call in calls[:4]] == ["a"] * 4, "one subject at a time"
    sides = questions[0].sides["a"]
    assert len(sides.base) == len(sides.candidate) == 4 and sides.base == sorted(
        sides.base
    ), "in the order of time: block i stands beside block i"


def test_each_pair_of_blocks_has_a_place_of_its_own() -> None:
    """Each pair moves to a new place, where both sides have equally long paths, so differences
    between places cancel."""
    calls: Calls = []
    plain = subject("a", calls)
    screen(
        [
            question(
                Subject("a", ("a",), plain.blocks, move=lambda: calls.append(("a", "move"))), ("a",)
            )
        ],
        4,
    )
    pairs = [
        ["base", "candidate"],
        ["candidate", "base"],
        ["candidate", "base"],
        ["base", "candidate"],
    ]
    expected = [entry for pair in pairs for entry in ["move", *pair]]
    assert [call[1] for call in calls] == expected


def test_the_self_test_multiplies_the_times_of_the_base_beside_itself() -> None:
    calls: Calls = []
    self_test = planted(subject("a", calls, slower(0.5)))
    answer([self_test], 6, 1)
    assert {call[1] for call in calls} == {"base", "base again"}
    assert self_test.sides["a"].candidate[0] / self_test.sides["a"].base[0] == pytest.approx(
        1.05, abs=1e-4
    )


def test_only_what_alarms_runs_again() -> None:
    calls: Calls = []
    judged, runs = judge_all(
        Known([subject("fine", calls), subject("slow", calls, slower(0.2))]),
        "fine",
        24,
        lambda line: None,
    )
    measured = [call[0] for call in calls]
    by_name = {case.name: case for case in judged}
    assert by_name["slow"].red and not by_name["fine"].alarms
    assert [sorted(run) for run in runs] == [
        ["fine", "slow"],
        ["fine"],
        ["slow"],
    ], "the first run, the self-test, the second run"
    assert [len(sides.base) for sides in runs[0].values()] == [24, 24]
    planted_pairs, second_pairs = len(runs[1]["fine"].base), len(runs[2]["slow"].base)
    assert measured.count("fine") == 48 + 2 * planted_pairs
    assert measured.count("slow") == 48 + 2 * second_pairs
    assert by_name["fine"].planted.n == planted_pairs and by_name["slow"].second.n == second_pairs
    assert by_name["fine"].itself.n == planted_pairs and not by_name["slow"].itself.n
    assert calls.count(("fine", "base again")) == planted_pairs, "beside as many of the base"


def test_what_looks_slower_gets_more_blocks_until_they_could_change_nothing() -> None:
    """`doubtful` is 2.5 % slower, which raises no alarm. `slow` raises one and is run again."""
    calls: Calls = []
    subjects = [
        subject("fine", calls),
        subject("steady", calls),
        subject("doubtful", calls, slower(0.025)),
        subject("slow", calls, slower(0.05)),
    ]
    lines: list[str] = []
    judged, runs = judge_all(Known(subjects), "steady", 72, lines.append)
    rank = order_statistic_rank(72, 1 - 0.05 / 4)
    assert [case.ratio.n for case in judged] == [
        24,
        24,
        max(24, 2 * math.ceil(rank / 2)),
        2 * math.ceil((73 - rank) / 2),
    ]
    assert [case.planted.n for case in judged] == [0, judged[3].ratio.n, 0, 0]
    assert [case.name for case in judged if case.red] == ["slow"]
    assert all(case.ratio.coverage >= 1 - 0.05 / 4 for case in judged)
    assert judged[3].second.n == 2 * math.ceil(
        (73 - order_statistic_rank(72, 0.95)) / 2
    ), "of one case alone, fewer blocks decide it"
    assert (
        lines == ["more blocks of doubtful, slow, the self-test", "a second run of slow"]
        and len(runs) == 3
    )


def test_a_way_of_measuring_that_favours_a_side_spoils_the_verdict() -> None:
    """Of two sides that are measured together, the second is always 6 % slower."""

    def blocks(sides: Sequence[str], names: Sequence[str]) -> list[dict[str, float]]:
        return [
            {"case": SECONDS[side] * (1.06 if side in ("candidate", "base again") else 1)}
            for side in sides
        ]

    judged, _ = judge_all(
        Known([Subject("case", ("case",), blocks, {"base": "shapes"})]),
        "case",
        24,
        lambda line: None,
    )
    verdict, reasons = verdict_of_times(judged)
    assert (
        judged[0].red
        and verdict is Verdict.inconclusive
        and "1.060 times as slow as itself" in reasons[0]
    )


def test_of_many_kernels_only_the_suspected_ones_are_measured_again() -> None:
    requests: list[Sequence[str]] = []

    def side(build: str, some: Sequence[str]) -> dict[str, float]:
        requests.append(some)
        return {name: 1.1 if build == "candidate" and name == "b" else 1.0 for name in some}

    judged, _ = judge_all(
        Known([Subject("kernels", ("a", "b", "c"), each(side))]), "", 60, lambda line: None
    )
    assert [tuple(names) for names in requests[:48]] == [("a", "b", "c")] * 48
    assert {tuple(names) for names in requests[48:]} == {("b",)}
    assert [case.red for case in judged] == [False, True, False]


def test_intervals_are_as_wide_as_so_many_cases_need() -> None:
    """Each of 60 cases needs a confidence of 1 - 0.05/60; the second run has one case, which needs
    95 %."""
    names = tuple(f"case {i}" for i in range(60))

    def side(build: str, _: Sequence[str]) -> dict[str, float]:
        return {name: 1.2 if build == "candidate" and name == "case 0" else 1.0 for name in names}

    judged, _ = judge_all(Known([Subject("all", names, each(side))]), "", 24, lambda line: None)
    assert (
        min(case.ratio.coverage for case in judged)
        >= 1 - 0.05 / 60
        > judged[0].second.coverage
        >= 0.95
    )


def known_of(
    base: dict[str, float] | NotMeasured,
    candidate: dict[str, float] | NotMeasured,
    shapes: dict[str, str] | None = None,
) -> Known:
    def side(build: str, _: Sequence[str]) -> dict[str, float]:
        seconds = base if build == "base" else candidate
        if isinstance(seconds, NotMeasured):
            raise seconds
        return seconds

    common = Known()
    common.add(Subject("case", ("old", "new"), each(side), shapes=shapes or {}))
    return common


def test_what_only_one_build_has_is_left_out() -> None:
    common = known_of({"old": 1.0}, {"old": 1.0, "new": 1.0})
    assert [subject.names for subject in common.subjects] == [("old",)] and common.left_out == [
        "new: left out, because the base does not have it"
    ]
    assert known_of({"old": 1.0, "new": 1.0}, {"old": 1.0}).left_out == [
        "new: left out, because this build does not have it"
    ]
    assert not known_of({"old": 1.0}, {"new": 1.0}).subjects


def test_a_case_that_the_base_does_not_know_is_left_out() -> None:
    common = known_of(NotMeasured("unknown solver 'cover'"), {"old": 1.0})
    assert not common.subjects and not common.broken and "unknown solver" in common.left_out[0]


def test_a_case_that_this_build_alone_fails_at_is_broken() -> None:
    common = known_of({"old": 1.0, "new": 1.0}, NotMeasured("time_limit: not within 20 s"))
    assert not common.subjects and "time_limit" in common.broken[0] and not common.left_out
    common = known_of({"old": 1.0, "new": 1.0}, NotMeasured("skipped: not fetched", skipped=True))
    assert not common.broken and "not fetched" in common.left_out[0]


def test_other_shapes_are_left_out() -> None:
    common = known_of(
        {"old": 1.0, "new": 1.0}, {"old": 2.0, "new": 2.0}, {"base": "a", "candidate": "b"}
    )
    assert not common.subjects and "it has other shapes than the base" in common.left_out[0]


def test_the_self_test_is_in_the_wanted_case_or_in_the_first_one() -> None:
    calls: Calls = []
    kernels = Subject("kernels", ("build",), lambda sides, names: [])
    common = Known([kernels, subject("a", calls), subject("b", calls)])
    assert [
        getattr(common.for_self_test(wanted), "name", None)
        for wanted in ("b", "not fetched", "kernels")
    ] == ["b", "a", "a"]
    assert Known([kernels]).for_self_test("b") is None


def test_a_kernel_that_is_gone_in_one_block_is_no_lists_out_of_step() -> None:
    calls = []

    def side(build: str, _: Sequence[str]) -> dict[str, float]:
        calls.append(build)
        return {"old": 1.0} if len(calls) == 3 else {"old": 1.0, "new": 1.0}

    with pytest.raises(NotMeasured, match="new: not measured this time"):
        screen([question(Subject("kernels", ("old", "new"), each(side)), ("old", "new"))], 24)


@pytest.mark.parametrize(("seconds", "repeats"), [(0.002, 25), (1.0, 3), (0.0001, 250)])
def test_the_first_block_decides_how_many_repeats_all_have(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, seconds: float, repeats: int
) -> None:
    """At least three repeats, as the experiment asks. Two sides measured together have paths of
    equal length."""
    requests: list[tuple[str, int]] = []

    @contextmanager
    def job_of_case(
        program: Path, case: Case, folder: Path, root: Path
    ) -> Iterator[tuple[Block, Path]]:
        assert folder == tmp_path and (root / program.name[:3]).is_file()
        requests.append((program.name, case.experiment["repeats"]))
        yield Block(seconds * len(requests), 0.002, 0.0, "shapes"), root

    def together(jobs: list[tuple[Block, Path]]) -> list[Block]:
        roots = [root for _, root in jobs]
        assert len({len(str(root)) for root in roots}) == 1 and len(set(roots)) == len(roots)
        assert all(root.is_dir() for root in roots)
        return [block for block, _ in jobs]

    monkeypatch.setattr(timed, "job_of_case", job_of_case)
    monkeypatch.setattr(timed, "together", together)
    for name in ("old", "new"):
        (tmp_path / f"{name} tree").mkdir()
        (tmp_path / f"{name} tree" / name).touch()
    old, new = (
        Program(tmp_path / f"{name}-program", tmp_path / f"{name} tree") for name in ("old", "new")
    )
    places = Places(tmp_path)
    measured = of_case(
        Case("case", {"repeats": 3}),
        {"base": old, "base again": old, "candidate": new},
        tmp_path,
        places,
    )
    assert measured.block("base") == {"case": seconds}
    measured.move()
    assert measured.blocks(["candidate", "base again"], ()) == [
        {"case": 2 * seconds},
        {"case": 3 * seconds},
    ]
    assert requests == [("old-program", 3), ("new-program", repeats), ("old-program", repeats)]
    assert (
        measured.shapes == dict.fromkeys(("base", "candidate", "base again"), "shapes")
        and measured.move == places.move
    )


def test_programs_and_kernels_know_their_trees() -> None:
    old, new = Build("a", Path("old"), None, Path("1")), Build(
        "b", Path("new"), Path("bench"), Path("2")
    )
    programs = programs_of(old, new)
    assert programs["base"] == Program(Path("old"), Path("1")) and programs["candidate"] == Program(
        Path("new"), Path("2")
    )
    assert programs["base again"] == programs["base"]
    assert kernels_of(old, new) == kernels_of(new, old) == {}, "kernels need both builds"
    assert kernels_of(new, new) == {
        "base": Program(Path("bench"), Path("2")),
        "candidate": Program(Path("bench"), Path("2")),
    }


def test_kernels_of_both_sides_are_measured_at_once(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    places, trees = Places(tmp_path), [tmp_path / name for name in ("old tree", "new tree")]
    for tree in trees:
        tree.mkdir()
        (tree / tree.name[:3]).touch()

    @contextmanager
    def job_of_kernels(
        program: Path, names: list[str], folder: Path, root: Path
    ) -> Iterator[tuple[str, Path]]:
        assert (root / program.name).is_file() and folder == tmp_path
        yield names[0] + program.name, root

    def together(jobs: list[tuple[str, Path]]) -> list[dict[str, float]]:
        assert len({len(str(root)) for _, root in jobs}) == 1
        assert all(root.is_dir() for _, root in jobs)
        return [{name: 1.0} for name, _ in jobs]

    monkeypatch.setattr(timed, "job_of_kernels", job_of_kernels)
    monkeypatch.setattr(timed, "together", together)
    programs = {
        "base": Program(tmp_path / "old", trees[0]),
        "candidate": Program(tmp_path / "new", trees[1]),
    }
    kernels = of_kernels(["a", "b"], programs, tmp_path, places)
    assert kernels.names == ("a", "b") and kernels.move == places.move
    assert kernels.blocks(["candidate", "base"], ["b"]) == [{"bnew": 1.0}, {"bold": 1.0}]


@pytest.mark.skipif(not PROGRAM.is_file(), reason="the program is not built")
def test_two_programs_measure_a_pair(tmp_path: Path) -> None:
    """Runs two programs side by side on generated models, each in a folder that is removed
    afterwards."""
    scene = {"name": "spheres", "source": "sphere2", "target": "sphere3"}
    case = Case(
        "guthe on spheres",
        {
            "title": "t",
            "tolerances": [1e-4],
            "of": "diagonal",
            "repeats": 2,
            "rounds": 1,
            "scene": [scene],
            "solver": [{"name": "guthe"}],
        },
    )
    programs = dict.fromkeys(("base", "candidate"), Program(PROGRAM, ROOT))
    for name in ("cases", "places"):
        (tmp_path / name).mkdir()
    measured = of_case(case, programs, tmp_path / "cases", Places(tmp_path / "places"))
    blocks = measured.blocks(["base", "candidate"], ())
    assert (
        all(0 < seconds["guthe on spheres"] < 5 for seconds in blocks)
        and measured.shapes["base"] == measured.shapes["candidate"]
    )
    assert not [file for name in ("cases", "places") for file in (tmp_path / name).iterdir()]
