"""Compares counters and instructions with a baseline: equal, more, fewer, other shapes, other
machines."""

from __future__ import annotations

import shutil
import subprocess
import time
import tomllib
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from bench.tracking import counted
from bench.tracking.blocks import Block, NotMeasured
from bench.tracking.cases import KERNELS, ROOT, Case, cases
from bench.tracking.gate import Verdict

PROGRAM = ROOT / "build/release/hausbench"
CASE = Case("guthe on a mesh", {})
BASE = {"guthe on a mesh": {"shapes": "s", "node_visits": 1000, "queue_pushes": 5}}


def work(
    monkeypatch: pytest.MonkeyPatch,
    counters: dict[str, int] | NotMeasured,
    shapes: str = "s",
    baseline: dict[str, Any] = BASE,
) -> counted.Found:
    def measure(program: Path, case: Case, folder: Path) -> Block:
        if isinstance(counters, NotMeasured):
            raise counters
        return Block(1, 1, 0, shapes, 0, counters)

    monkeypatch.setattr(counted, "measure", measure)
    return counted.count_work([CASE], Path("program"), baseline, Path("."))


def test_equal_counters_pass(monkeypatch: pytest.MonkeyPatch) -> None:
    outcome = work(monkeypatch, {"node_visits": 1000, "queue_pushes": 5})
    assert outcome.verdict is Verdict.passed and not outcome.lines


def test_one_more_node_visit_is_caught(monkeypatch: pytest.MonkeyPatch) -> None:
    outcome = work(monkeypatch, {"node_visits": 1001, "queue_pushes": 5})
    assert outcome.verdict is Verdict.red and outcome.lines == [
        "guthe on a mesh: node_visits was 1,000, is 1,001 (+0.1 %)"
    ]


@pytest.mark.parametrize(
    "counters",
    [
        {"node_visits": 999, "queue_pushes": 5},
        {"node_visits": 1000},
        {"node_visits": 1000, "queue_pushes": 5, "subdivisions": 1},
    ],
)
def test_less_work_and_new_work_are_told_too(
    monkeypatch: pytest.MonkeyPatch, counters: dict[str, int]
) -> None:
    assert work(monkeypatch, counters).verdict is Verdict.red


def test_other_shapes_are_not_measured(monkeypatch: pytest.MonkeyPatch) -> None:
    outcome = work(monkeypatch, {"node_visits": 7}, shapes="of another library")
    assert (
        outcome.verdict is Verdict.nothing_measured
        and "it has other shapes than" in outcome.lines[0]
    )


def test_a_case_whose_models_are_not_at_hand_is_not_measured(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    outcome = work(monkeypatch, NotMeasured("skipped: not fetched", skipped=True))
    assert outcome.verdict is Verdict.nothing_measured and "not fetched" in outcome.lines[0]


def test_a_case_without_an_answer_is_red(monkeypatch: pytest.MonkeyPatch) -> None:
    outcome = work(monkeypatch, NotMeasured("time_limit: not within 20 s"))
    assert outcome.verdict is Verdict.red and "no answer: time_limit" in outcome.lines[0]


def test_a_case_without_a_baseline_is_red(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without a failure, a new case or a lost baseline would go unnoticed."""
    outcome = work(monkeypatch, {"node_visits": 1}, baseline={})
    assert outcome.verdict is Verdict.red and "--update" in outcome.lines[0]


@pytest.mark.parametrize(
    ("now", "word", "good"),
    [
        (100_500, "as before", True),
        (100_501, "slower", False),
        (99_499, "--update", False),
        (99_501, "as before", True),
    ],
)
def test_half_a_percent_of_instructions_is_the_limit(now: int, word: str, good: bool) -> None:
    text, same = counted.said(now, 100_000)
    assert word in text and same is good


def test_how_much_more_work_is_said_in_per_cent() -> None:
    assert [counted.signed_share(now, 1000) for now in (1001, 2000, 990)] == [
        "+0.1 %",
        "+100 %",
        "-1 %",
    ] and counted.signed_share(5, 0) == "new"


PARTS = "g++ 12, libc6 2.36"
KEY = counted.key_of(PARTS)
needs_valgrind = pytest.mark.skipif(not shutil.which("valgrind"), reason="valgrind is missing")


def instructions(
    monkeypatch: pytest.MonkeyPatch,
    count: int | NotMeasured,
    baseline: dict[str, Any],
    wanted: bool = False,
    shapes: str = "s",
) -> counted.Found:
    def job() -> tuple[int, str]:
        if isinstance(count, NotMeasured):
            raise count
        return count, shapes

    monkeypatch.setattr(counted, "parts_of_key", lambda: PARTS)
    return counted.count_instructions(
        {"guthe on a mesh": job, "build/bvh": lambda: (10, "")},
        baseline,
        {"guthe on a mesh": "s"},
        wanted,
    )


@needs_valgrind
def test_another_machine_has_nothing_measured(monkeypatch: pytest.MonkeyPatch) -> None:
    outcome = instructions(monkeypatch, 1000, {"of another machine": {"guthe on a mesh": 1}})
    assert (
        outcome.verdict is Verdict.nothing_measured
        and "g++ 12" in outcome.lines[0]
        and not outcome.measured
    )


@needs_valgrind
@pytest.mark.parametrize(
    ("count", "verdict"),
    [(1000, Verdict.passed), (1004, Verdict.passed), (1006, Verdict.red), (990, Verdict.red)],
)
def test_instructions_against_the_table_of_this_machine(
    monkeypatch: pytest.MonkeyPatch, count: int, verdict: Verdict
) -> None:
    assert (
        instructions(monkeypatch, count, {KEY: {"guthe on a mesh": 1000, "build/bvh": 10}}).verdict
        is verdict
    )


@needs_valgrind
def test_what_could_not_be_counted_is_red_with_its_reason(monkeypatch: pytest.MonkeyPatch) -> None:
    outcome = instructions(
        monkeypatch,
        NotMeasured("no end within 600 s"),
        {KEY: {"guthe on a mesh": 1000, "build/bvh": 10}},
    )
    assert (
        outcome.verdict is Verdict.red
        and "no end within 600 s" in outcome.lines[0]
        and "guthe on a mesh" not in outcome.measured
    )
    outcome = instructions(
        monkeypatch,
        NotMeasured("not fetched", skipped=True),
        {KEY: {"guthe on a mesh": 1000, "build/bvh": 10}},
    )
    assert outcome.verdict is Verdict.passed and "not fetched" in outcome.lines[0]


@needs_valgrind
def test_what_the_table_does_not_have_is_red(monkeypatch: pytest.MonkeyPatch) -> None:
    outcome = instructions(monkeypatch, 1000, {KEY: {"build/bvh": 10}})
    assert outcome.verdict is Verdict.red and "no baseline" in outcome.lines[0]


@needs_valgrind
def test_instructions_of_other_shapes_are_not_compared(monkeypatch: pytest.MonkeyPatch) -> None:
    outcome = instructions(
        monkeypatch,
        5000,
        {KEY: {"guthe on a mesh": 1000, "build/bvh": 10}},
        shapes="of another library",
    )
    assert outcome.verdict is Verdict.passed and "it has other shapes than" in outcome.lines[0]


@needs_valgrind
def test_a_new_table_counts_everything(monkeypatch: pytest.MonkeyPatch) -> None:
    assert instructions(monkeypatch, 1000, {}, wanted=True).measured == {
        "depends_on": PARTS,
        "guthe on a mesh": 1000,
        "build/bvh": 10,
    }


def test_without_valgrind_the_remedy_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("bench.tracking.counted.shutil.which", lambda name: None)
    with pytest.raises(counted.Missing, match="make deps"):
        instructions(monkeypatch, 1000, {KEY: {}})
    assert (
        instructions(monkeypatch, 1000, {}).verdict is Verdict.nothing_measured
    ), "nothing would be counted with it either"


def test_the_key_has_the_compiler_and_survives_packages_that_are_missing(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(counted, "PACKAGES", ("g++", "no-such-package"))
    parts = counted.parts_of_key()
    assert ("g++ " in parts or parts.startswith("no Debian")) and "avx2" in parts
    assert "g++" in counted.PACKAGES and {"libc6", "libstdc++6", "valgrind"} <= set(REAL_PACKAGES)


def test_a_package_of_two_architectures_counts_once(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    query = tmp_path / "dpkg-query"
    query.write_text("#!/bin/sh\nprintf 'libc6 1\\nlibc6 1\\nlibgmp10 2\\n'\n")
    query.chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path))
    assert counted.parts_of_key().startswith("libc6 1, libgmp10 2, ")


REAL_PACKAGES = counted.PACKAGES


def test_an_interrupt_begins_no_other_count() -> None:
    begun = []

    def first() -> tuple[int, str]:
        raise KeyboardInterrupt

    def later(number: int) -> tuple[int, str]:
        begun.append(number)
        time.sleep(0.2)
        return number, ""

    jobs: counted.Counting = {"first": first, **{str(i): partial(later, i) for i in range(50)}}
    with pytest.raises(KeyboardInterrupt):
        counted.in_parallel(jobs)
    time.sleep(0.5)
    assert len(begun) < 40


BEFORE = {
    "reason": "first",
    "counters": {"a": {"shapes": "x", "node_visits": 1}, "gone": {"shapes": "x"}},
    "instructions": {"other": {"depends_on": "clang", "a": 5, "gone": 1}, KEY: {"a": 6, "b": 7}},
}


def test_an_update_of_some_cases_keeps_the_others(tmp_path: Path) -> None:
    after = counted.updated(
        BEFORE, {"c": {"shapes": "y"}}, {"depends_on": PARTS, "b": 8}, 'a "better" tree'
    )
    file = tmp_path / "baseline.toml"
    counted.write_baseline(file, after)
    assert counted.read_baseline(file) == {
        "reason": 'a "better" tree',
        "counters": {
            "a": {"shapes": "x", "node_visits": 1},
            "gone": {"shapes": "x"},
            "c": {"shapes": "y"},
        },
        "instructions": {
            "other": {"depends_on": "clang", "a": 5, "gone": 1},
            KEY: {"a": 6, "b": 8, "depends_on": PARTS},
        },
    }
    assert [file.name for file in tmp_path.iterdir()] == ["baseline.toml"]


def test_an_update_of_all_drops_what_is_tracked_no_more() -> None:
    after = counted.updated(
        BEFORE, {"a": {"shapes": "z"}}, {"depends_on": PARTS, "b": 8}, "why", {"a", "b"}
    )
    assert after["counters"] == {"a": {"shapes": "z"}}
    assert after["instructions"] == {
        "other": {"depends_on": "clang", "a": 5},
        KEY: {"a": 6, "b": 8, "depends_on": PARTS},
    }


def test_another_machine_adds_its_table_and_leaves_the_counters_of_other_shapes() -> None:
    after = counted.updated(
        BEFORE,
        {"a": {"shapes": "mine"}, "new": {"shapes": "mine"}},
        {"depends_on": "musl", "a": 9},
        "a table for musl",
    )
    assert after["counters"]["a"] == {"shapes": "x", "node_visits": 1} and after["counters"][
        "new"
    ] == {"shapes": "mine"}
    assert after["instructions"][counted.key_of("musl")] == {"depends_on": "musl", "a": 9}


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
    counted_names = [case.name for case in cases() if case.solver not in counted.NO_INSTRUCTIONS]
    for table in baseline["instructions"].values():
        assert set(table) == {"depends_on", *counted_names, *(kernel.name for kernel in KERNELS)}


@needs_valgrind
@pytest.mark.skipif(not PROGRAM.is_file(), reason="the program is not built")
def test_instructions_are_the_same_from_run_to_run(tmp_path: Path) -> None:
    (case,) = [case for case in cases() if case.name.startswith("interval_subdivision")]
    first = counted.instructions_of(PROGRAM, case, tmp_path)
    assert not list(tmp_path.iterdir())
    if isinstance(first, NotMeasured) and first.skipped:
        pytest.skip(str(first))
    assert isinstance(first, int), first
    again = counted.instructions_of(PROGRAM, case, tmp_path)
    # Equal in nearly every run; once 4 instructions of 4.8 million more, for a reason that is not known; far below counted.LIMIT.
    assert first > 1_000_000 and again == pytest.approx(first, rel=1e-5)


OUT = """\
positions: line
events: Ir
summary: 1111111

ob=(1) /usr/bin/program
fl=(1) solve.cpp
fn=(1) solve
10 1
+2 20
* 300
cob=(2) /lib/libc.so.6
cfi=(2) ./malloc/./malloc/malloc.c
cfn=(2) malloc
calls=7 5
-1 70000
fi=(3) vector.h
8 4000
fe=(1)
9 50000

ob=(2)
fl=(2)
fn=(2)
5 600000
cfn=(3) _int_malloc
calls=7 6
5 8000000

totals: 1111111
"""


def test_instructions_of_a_file_without_those_of_malloc_and_without_what_was_called() -> None:
    assert counted.instructions_in(OUT.splitlines()) == 54321
    assert counted.instructions_in(OUT.replace("malloc.c", "mine.c").splitlines()) == 654321
    assert counted.instructions_in(["totals: 0"]) == 0


@needs_valgrind
@pytest.mark.skipif(not shutil.which("c++"), reason="there is no compiler")
def test_what_lies_in_memory_before_does_not_change_the_count(tmp_path: Path) -> None:
    """Free pieces of memory make malloc search longer; only the calls of it are counted."""
    (tmp_path / "new.cpp").write_text(
        """
        #include <cstdlib>
        #include <vector>
        std::vector<void*> kept;
        void solve() { for (std::size_t i = 0; i < 1000; ++i) kept.push_back(std::malloc(2000 + 16 * (i % 50))); }
        int main(int arguments, char**) {
            kept.reserve(10000);
            kept.push_back(std::malloc(1));  // the loader finds malloc at its first call
            std::vector<void*> freed;
            for (std::size_t i = 0; arguments > 1 && i < 4000; ++i) (i % 2 ? kept : freed).push_back(std::malloc(1500 + 16 * (i % 77)));
            for (void* each : freed) std::free(each);
            solve();
        }"""
    )
    subprocess.run(["c++", "-g", "-O1", "-o", "new", "new.cpp"], cwd=tmp_path, check=True)
    program = str(tmp_path / "new")
    counts = [
        counted.callgrind("solve()", command, tmp_path)
        for command in ([program], [program, "full"])
    ]
    assert (
        5_000 < counts[0] < 200_000 and abs(counts[1] - counts[0]) < 1_000
    ), counts  # some calls of sbrk


@needs_valgrind
def test_a_program_that_cannot_be_counted(tmp_path: Path) -> None:
    why = counted.instructions_of(Path("/bin/false"), CASE, tmp_path)
    assert isinstance(why, NotMeasured) and "counted nothing in hausbench::Session::solve" in str(
        why
    )
    with pytest.raises(NotMeasured, match="counted nothing in hausbench::Session::solve"):
        counted.count_case(Path("/bin/false"), CASE, tmp_path)
    with pytest.raises(NotMeasured, match="counted nothing"):
        counted.callgrind("no_such_function*", ["/bin/true"], tmp_path)


@needs_valgrind
@pytest.mark.skipif(not shutil.which("c++"), reason="there is no compiler")
@pytest.mark.parametrize("exit_code", [0, 1])
def test_an_instruction_that_valgrind_does_not_know_is_the_reason(
    tmp_path: Path, exit_code: int
) -> None:
    """The instruction is in the program, or in a worker whose death the program survives. Nothing
    is measured then, which is not a failure."""
    (tmp_path / "wide.cpp").write_text(
        'void wide() { asm(".byte 0x62, 0xf1, 0x7c, 0x48, 0x57, 0xc0"); }\n'  # vxorps zmm0, zmm0, zmm0
        "int main() { wide(); }\n"
    )
    subprocess.run(["c++", "-g", "-o", "wide", "wide.cpp"], cwd=tmp_path, check=True)
    for command in (
        [str(tmp_path / "wide")],
        ["/bin/sh", "-c", f"{tmp_path}/wide; exit {exit_code}"],
    ):
        with pytest.raises(
            NotMeasured,
            match=r"valgrind does not know instruction 0x62 0xF1 0x7C 0x48 0x57 0xC0 .*wide\(\)",
        ) as why:
            counted.callgrind("wide*", command, tmp_path, (0, 1))
        assert why.value.skipped


def test_counts_of_all_processes_are_added_up_over_one_repeat(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Fakes valgrind and the program: the processes' counts, 0, 700 and 20, are added. The
    experiment asks for 3 repeats, but one is run."""
    requests = []

    def run(command: list[str], folder: Path, good: tuple[int, ...], limit: float) -> str:
        out = Path(
            next(word for word in command if word.startswith("--callgrind-out-file=")).split("=")[1]
        ).parent
        (out / "1").write_text("totals: 0\n")
        (out / "2").write_text("events: Ir\n\nfl=(1) solve.cpp\nfn=(1) solve\n3 700\n")
        (out / "3").write_text("fl=(1) solve.cpp\nfn=(1) solve\n3 20\n")
        (out / "log.3").write_text("3 1000\n")
        requests.append(
            (tomllib.loads(Path(command[command.index("run") + 1]).read_text())["repeats"], limit)
        )
        return ""

    monkeypatch.setattr(counted, "run", run)
    monkeypatch.setattr(counted, "read", lambda file: Block(1, 1, 0, "shapes"))
    assert counted.count_case(Path("program"), Case("a", {"repeats": 3}), tmp_path) == (
        720,
        "shapes",
    )
    assert requests == [(1, counted.CALLGRIND_LIMIT)]
