"""Counters and instructions against a baseline: equal, more, fewer, other shapes, other machines."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import pytest

from bench.tracking import counted
from bench.tracking.blocks import Block, NotMeasured
from bench.tracking.cases import KERNELS, ROOT, Case, Kernel, cases
from bench.tracking.gate import Verdict

PROGRAM = ROOT / "build/release/hausbench"
CASE = Case("guthe on a mesh", {})
BASE = {"guthe on a mesh": {"shapes": "s", "node_visits": 1000, "queue_pushes": 5}}


def work(monkeypatch: pytest.MonkeyPatch, counters: dict[str, int] | None, shapes: str = "s", baseline: dict[str, Any] = BASE) -> counted.Found:
    def measure(program: Path, case: Case, folder: Path) -> Block:
        if counters is None:
            raise NotMeasured("skipped: not fetched")
        return Block(1, 1, 0, shapes, 0, counters)

    monkeypatch.setattr(counted, "measure", measure)
    return counted.count_work([CASE], Path("program"), baseline, Path("."))


def test_equal_counters_pass(monkeypatch: pytest.MonkeyPatch) -> None:
    found = work(monkeypatch, {"node_visits": 1000, "queue_pushes": 5})
    assert found.verdict is Verdict.passed and not found.lines


def test_one_more_node_visit_is_caught(monkeypatch: pytest.MonkeyPatch) -> None:
    found = work(monkeypatch, {"node_visits": 1001, "queue_pushes": 5})
    assert found.verdict is Verdict.slower and found.lines == ["guthe on a mesh: node_visits was 1,000, is 1,001 (+0.1 %)"]


@pytest.mark.parametrize("counters", [{"node_visits": 999, "queue_pushes": 5}, {"node_visits": 1000}, {"node_visits": 1000, "queue_pushes": 5, "subdivisions": 1}])
def test_less_work_and_new_work_are_told_too(monkeypatch: pytest.MonkeyPatch, counters: dict[str, int]) -> None:
    assert work(monkeypatch, counters).verdict is Verdict.slower


def test_other_shapes_are_not_measured(monkeypatch: pytest.MonkeyPatch) -> None:
    found = work(monkeypatch, {"node_visits": 7}, shapes="of another library")
    assert found.verdict is Verdict.nothing_measured and "its shapes are not those" in found.lines[0]


def test_a_case_without_an_answer_is_not_measured(monkeypatch: pytest.MonkeyPatch) -> None:
    found = work(monkeypatch, None)
    assert found.verdict is Verdict.nothing_measured and "not fetched" in found.lines[0]


def test_a_case_without_a_baseline_is_red(monkeypatch: pytest.MonkeyPatch) -> None:
    """Else a case that somebody adds, or a baseline that somebody loses, would pass in silence."""
    found = work(monkeypatch, {"node_visits": 1}, baseline={})
    assert found.verdict is Verdict.slower and "--update" in found.lines[0]


@pytest.mark.parametrize(("now", "word", "good"), [(1004, "as before", True), (1006, "slower", False), (994, "--update", False), (996, "as before", True)])
def test_half_a_percent_of_instructions_is_the_limit(now: int, word: str, good: bool) -> None:
    text, same = counted.said(now, 1000)
    assert word in text and same is good


def instructions(monkeypatch: pytest.MonkeyPatch, count: int | None, baseline: dict[str, Any], wanted: bool = False) -> counted.Found:
    monkeypatch.setattr(counted, "parts_of_key", lambda: "g++ 12, libc6 2.36")
    monkeypatch.setattr(counted, "instructions_of", lambda program, case, folder: count)
    monkeypatch.setattr(counted, "kernel_instructions", lambda program, kernel, folder: 10)
    return counted.count_instructions([CASE], [Kernel("build/bvh", "f")], Path("p"), Path("k"), baseline, Path("."), wanted)


KEY = counted.key_of("g++ 12, libc6 2.36")
needs_valgrind = pytest.mark.skipif(not shutil.which("valgrind"), reason="valgrind is missing")


@needs_valgrind
def test_another_machine_has_nothing_measured(monkeypatch: pytest.MonkeyPatch) -> None:
    found = instructions(monkeypatch, 1000, {"of another machine": {"guthe on a mesh": 1}})
    assert found.verdict is Verdict.nothing_measured and "g++ 12" in found.lines[0] and not found.measured


@needs_valgrind
@pytest.mark.parametrize(("count", "verdict"), [(1000, Verdict.passed), (1004, Verdict.passed), (1006, Verdict.slower), (990, Verdict.slower)])
def test_instructions_against_the_table_of_this_machine(monkeypatch: pytest.MonkeyPatch, count: int, verdict: Verdict) -> None:
    assert instructions(monkeypatch, count, {KEY: {"guthe on a mesh": 1000, "build/bvh": 10}}).verdict is verdict


@needs_valgrind
def test_what_does_not_run_under_valgrind_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    found = instructions(monkeypatch, None, {KEY: {"build/bvh": 10}})
    assert found.verdict is Verdict.passed and "did not run" in found.lines[0] and "guthe on a mesh" not in found.measured


@needs_valgrind
def test_a_new_table_counts_everything(monkeypatch: pytest.MonkeyPatch) -> None:
    assert instructions(monkeypatch, 1000, {}, wanted=True).measured == {"depends_on": "g++ 12, libc6 2.36", "guthe on a mesh": 1000, "build/bvh": 10}


def test_an_update_keeps_other_machines_and_other_cases(tmp_path: Path) -> None:
    before = {"reason": "first", "counters": {"a": {"shapes": "x", "node_visits": 1}}, "instructions": {"other": {"a": 5}, KEY: {"a": 6, "b": 7}}}
    after = counted.updated(before, {"c": {"shapes": "y"}}, {"depends_on": "g++ 12, libc6 2.36", "b": 8}, 'a "better" tree')
    file = tmp_path / "baseline.toml"
    counted.write_baseline(file, after)
    assert counted.read_baseline(file) == {
        "reason": 'a "better" tree', "counters": {"a": {"shapes": "x", "node_visits": 1}, "c": {"shapes": "y"}},
        "instructions": {"other": {"a": 5}, KEY: {"a": 6, "b": 8, "depends_on": "g++ 12, libc6 2.36"}}}


def test_a_damaged_baseline_is_a_clear_error(tmp_path: Path) -> None:
    file = tmp_path / "baseline.toml"
    file.write_text("[counters")
    with pytest.raises(counted.Missing, match="baseline.toml: .*--update"):
        counted.read_baseline(file)
    assert counted.read_baseline(tmp_path / "none.toml") == {}


def test_the_committed_baseline_has_every_case_and_kernel() -> None:
    baseline = counted.read_baseline(counted.BASELINE)
    names = [case.name for case in cases()]
    assert set(baseline["counters"]) == set(names)
    for table in baseline["instructions"].values():
        assert set(table) == {"depends_on", *names, *(kernel.name for kernel in KERNELS)}


@needs_valgrind
@pytest.mark.skipif(not PROGRAM.is_file(), reason="the program is not built")
def test_instructions_are_the_same_from_run_to_run(tmp_path: Path) -> None:
    (case,) = [case for case in cases() if case.name.startswith("interval_subdivision")]
    first = counted.instructions_of(PROGRAM, case, tmp_path)
    assert first is not None and first > 1_000_000 and counted.instructions_of(PROGRAM, case, tmp_path) == first
    assert not list(tmp_path.iterdir())


@needs_valgrind
def test_a_program_that_cannot_be_counted(tmp_path: Path) -> None:
    assert counted.instructions_of(Path("/bin/false"), CASE, tmp_path) is None
    with pytest.raises(NotMeasured, match="counted nothing"):
        counted.callgrind("no_such_function*", ["/bin/true"], tmp_path)
