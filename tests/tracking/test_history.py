"""Tests the history file, and measuring commits in turn, with made-up builds and measurements."""

from __future__ import annotations

import dataclasses
import math
import os
import re
import subprocess
import threading
import time
import tomllib
from collections import Counter
from pathlib import Path
from typing import Any

import pytest

from bench.tracking import blocks, builds, counted, history
from bench.tracking.blocks import Block, NotMeasured
from bench.tracking.builds import Build, NotBuilt, fetched_origins
from bench.tracking.cases import KERNELS, ROOT, Case, cases
from bench.tracking.history import COLUMNS, Row, add, in_order, machine, read, write

CPUINFO = """processor\t: 0
model name\t: Intel(R) Xeon(R)   Gold 6248 CPU @ 2.50GHz
flags\t\t: fpu sse2 avx2 avx512f avx512dq

processor\t: 1
model name\t: Intel(R) Xeon(R)   Gold 6248 CPU @ 2.50GHz
flags\t\t: fpu sse2 avx2 avx512f avx512dq
"""
BEGUN, LATER = "2026-05-05T05:05:05Z", "2026-06-06T06:06:06Z"
ROW = Row(
    "a" * 10,
    "2026-01-01T00:00:00Z",
    "a machine, 2 cores",
    BEGUN,
    "guthe on mesh",
    0.01,
    0.009,
    0.011,
    8,
    0.02,
    12345,
    {"z": 1, "bound_tests": 7},
    "f00",
)
EMPTY = Row("b" * 10, "2026-01-02T00:00:00Z", "a machine, 2 cores", BEGUN, "guthe on mesh")


def test_what_is_written_is_read(tmp_path: Path) -> None:
    file = tmp_path / "new folder" / "history.csv"
    assert read(file) == []
    single = dataclasses.replace(EMPTY, cpu_seconds=1.5, blocks=1)
    write(file, [ROW, single])
    rows = read(file)
    assert rows[0] == ROW and repr(rows[1]) == repr(single)  # repr, because NaN != NaN
    lines = file.read_text().splitlines()
    assert lines[1] == (
        'aaaaaaaaaa,2026-01-01T00:00:00Z,"a machine, 2 cores",2026-05-05T05:05:05Z,guthe on mesh,'
        "0.01,0.009,0.011,8,0.02,12345,bound_tests=7 z=1,f00"
    )
    assert (
        lines[2]
        == 'bbbbbbbbbb,2026-01-02T00:00:00Z,"a machine, 2 cores",2026-05-05T05:05:05Z,guthe on mesh,1.5,,,1,,,,'
    )
    assert list(file.parent.iterdir()) == [file]


def test_runs_are_in_order_and_each_keeps_its_own(tmp_path: Path) -> None:
    first, second = dataclasses.replace(ROW, case="z"), dataclasses.replace(ROW, case="a")
    write(
        tmp_path / "h.csv",
        [dataclasses.replace(ROW, measured=LATER, commit="0" * 10), first, second],
    )
    assert [(row.measured, row.case) for row in read(tmp_path / "h.csv")] == [
        (BEGUN, "z"),
        (BEGUN, "a"),
        (LATER, "guthe on mesh"),
    ]


def test_the_file_is_whole_at_any_time(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "history.csv"
    write(file, [ROW])
    stream, seen = file.open(), []

    def replace(new: Path, target: Path) -> Path:
        seen.append((read(file), read(new), target))
        os.replace(new, target)
        return target

    monkeypatch.setattr(Path, "replace", replace)
    write(file, [ROW, EMPTY])
    assert [(len(old), len(new), target) for old, new, target in seen] == [(1, 2, file)]
    with stream:
        assert len(stream.readlines()) == 2  # a reader that has the old file open can finish


def test_a_run_only_adds(tmp_path: Path) -> None:
    file = tmp_path / "history.csv"
    again = dataclasses.replace(ROW, measured=LATER, cpu_seconds=0.0105, instructions=None)
    elsewhere = dataclasses.replace(ROW, machine="another")
    assert add(file, [ROW]) == [ROW] and add(file, [again]) == [ROW, again]
    assert add(file, [elsewhere]) == [ROW, again, elsewhere]
    more = dataclasses.replace(again, blocks=9)
    assert add(file, [more]) == [ROW, elsewhere, more]  # the same run, one round later
    assert {row.key: row.blocks for row in read(file)} == {
        ROW.key: 8,
        elsewhere.key: 8,
        more.key: 9,
    }


def test_runs_at_once_lose_nothing(tmp_path: Path) -> None:
    def add_rows(number: int) -> None:
        for blocks_ in range(1, 6):
            add(
                tmp_path / "h.csv",
                [
                    dataclasses.replace(
                        ROW, measured=f"2026-05-05T05:05:{number:02}Z", blocks=blocks_
                    )
                ],
            )

    threads = [threading.Thread(target=add_rows, args=(number,)) for number in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    expected = [(f"{number:02}", 5) for number in range(8)]
    assert [(row.measured[-3:-1], row.blocks) for row in read(tmp_path / "h.csv")] == expected


GOOD = (
    "aaaaaaaaaa,2026-01-01T00:00:00Z,m,2026-05-05T05:05:05Z,c,0.01,0.009,0.011,8,0.02,12345,a=7,f00"
)


@pytest.mark.parametrize(
    ("bad", "reason"),
    [
        ("<<<<<<< HEAD", "1 cells"),
        (GOOD.replace("0.009", "-1"), "-1 is not a time"),
        (GOOD.replace("0.011", "inf"), "inf is not a time"),
        (GOOD.replace("0.01,", ",", 1), "has both blocks and a time"),
        (GOOD.replace(",8,", ",eight,"), "eight"),
        (GOOD.replace("a=7", "a"), "invalid literal"),
        (GOOD.replace("2026-01-01T", "January "), "January"),
        (GOOD.replace("aaaaaaaaaa", "main"), "'main' is not a commit"),
        (GOOD.replace(",m,", ",,"), "is empty"),
        (GOOD.replace("0.009", "0.0101"), "is not between cpu_low and cpu_high"),
        (GOOD.replace("0.011", "0.0099"), "is not between"),
        (GOOD.replace("0.011", ""), "is not between"),
        (GOOD.replace("2026-05-05T", "today "), "today"),
        (GOOD, "there twice"),
    ],
)
def test_a_bad_line_is_named_with_a_remedy(tmp_path: Path, bad: str, reason: str) -> None:
    file = tmp_path / "history.csv"
    file.write_text("\n".join([",".join(COLUMNS), GOOD, bad]) + "\n")
    with pytest.raises(ValueError, match=re.escape(f"{file}, line 3: ")) as problem:
        read(file)
    assert reason in str(problem.value) and "git checkout" in str(problem.value)


def test_another_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "h.csv").write_text("part,scene\nbuild,bunny\n")
    with pytest.raises(ValueError, match="line 1: the columns are not commit,date"):
        read(tmp_path / "h.csv")


def commit_in(folder: Path, *words: str) -> str:
    """Makes a commit with a fixed date, and returns ten digits of its hash."""
    identity = {"NAME": "a", "EMAIL": "a@b", "DATE": "1767225600 +0000"}
    who = {
        f"GIT_{role}_{field}": value
        for role in ("AUTHOR", "COMMITTER")
        for field, value in identity.items()
    }
    git = ["git", "-C", str(folder)]
    subprocess.run(
        [*git, "commit", "--quiet", "--allow-empty", *words],
        env={**os.environ, **who, "GIT_CONFIG_GLOBAL": os.devnull},
        check=True,
    )
    return subprocess.run(
        [*git, "rev-parse", "--short=10", "HEAD"], check=True, capture_output=True, text=True
    ).stdout.strip()


def test_parents_come_before_children_and_strangers_by_their_dates(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    subprocess.run(["git", "init", "--quiet", str(tmp_path)], check=True)
    monkeypatch.setattr(builds, "ROOT", tmp_path)
    made = [commit_in(tmp_path, "-m", f"{i}") for i in range(9)]
    assert made != sorted(made)
    second = "2026-01-01T00:00:00Z"
    assert in_order(dict.fromkeys(sorted(made), second)) == made
    assert in_order({**dict.fromkeys(sorted(made), second), "1" * 10: "2027-01-01T00:00:00Z"}) == [
        *made,
        "1" * 10,
    ]
    assert in_order({made[8] + "+": second, made[8]: second, made[3]: second}) == [
        made[3],
        made[8],
        made[8] + "+",
    ]
    early, late, between = "e" * 10, "1" * 10, "c" * 10
    dates = {
        late: "2026-02-01T00:00:00Z",
        made[4]: "2026-01-20T00:00:00Z",
        between: "2026-01-10T00:00:00Z",
        made[2]: second,
        early: "2025-01-01T00:00:00Z",
    }
    assert in_order(dates) == [early, made[2], between, made[4], late]
    monkeypatch.setattr(builds, "ROOT", tmp_path / "no repository")
    assert in_order(dates) == [early, made[2], between, made[4], late] and in_order({}) == []


def test_dates_are_of_utc(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(builds, "git", lambda *words: "1767225600")
    monkeypatch.setenv("TZ", "Asia/Tokyo")
    time.tzset()
    try:
        assert time.localtime(0).tm_hour == 9
        assert history.date_of("any") == "2026-01-01T00:00:00Z"
    finally:
        monkeypatch.delenv("TZ")
        time.tzset()


def test_the_machine() -> None:
    assert (
        machine(CPUINFO, "g++ 12.2.0")
        == "Intel Xeon Gold 6248 CPU @ 2.50GHz, 2 cores, g++ 12.2.0, AVX-512"
    )
    older = CPUINFO.replace("avx512", "xyz").split("\n\n")[0]
    assert (
        machine(older, "no g++") == "Intel Xeon Gold 6248 CPU @ 2.50GHz, 1 core, no g++, no AVX-512"
    )
    assert "processor, 0 cores" in machine("", "g++ 1")


def test_origins_are_followed_to_what_is_fetched() -> None:
    models = {
        "bunny": {"source": "debian"},
        "npm": {"source": "npm"},
        "half": {"source": "derived", "from": "bunny"},
        "noisy": {"source": "derived", "from": "half"},
        "torus": {"source": "generated"},
        "a": {"source": "derived", "from": "b"},
        "b": {"source": "derived", "from": "a"},
        "lost": {"source": "derived", "from": "nothing"},
    }
    assert fetched_origins(models, ["noisy", "half", "torus", "a", "lost", "unknown", "npm"]) == [
        "bunny",
        "npm",
    ]


def test_todays_cases_need_four_models() -> None:
    models = tomllib.loads((ROOT / "datasets" / "manifest.toml").read_text())["model"]
    assert fetched_origins(models, {model for case in cases() for model in case.models}) == [
        "bear",
        "bunny",
        "bunny_small",
        "elephant",
    ]


def test_a_commit_fetches_by_its_own_program(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "datasets").mkdir()
    builds.fetch(tmp_path, ["half"])  # the first commits had no manifest
    (tmp_path / "datasets" / "manifest.toml").write_text(
        '[model.cow]\nsource = "npm"\n[model.half]\nsource = "derived"\nfrom = "cow"\n'
    )
    (tmp_path / "datasets" / "fetch.py").write_text(
        "import sys\nopen('asked', 'a').write(' '.join(sys.argv[1:]))\nsys.exit('no network')\n"
    )
    builds.fetch(tmp_path, ["half", "torus"])
    assert (tmp_path / "asked").read_text() == "cow"
    assert "ended with 1: no network" in capsys.readouterr().err
    builds.fetch(tmp_path, ["torus"])
    assert (tmp_path / "asked").read_text() == "cow"


def case(name: str) -> Case:
    return Case(name, {"scene": [{"source": "a", "target": "b"}], "solver": [{"name": "cover"}]})


class World:
    """Three commits, newest last. The first lacks solver "new"; in the first two, case "moved" has
    other shapes. Times follow from the commits' numbers.
    """

    DATES = {
        "1" * 10: "2026-01-01T00:00:00Z",
        "2" * 10: "2026-01-02T00:00:00Z",
        "3" * 10: "2026-01-03T00:00:00Z",
    }

    def __init__(self, folder: Path, patch: pytest.MonkeyPatch) -> None:
        self.folder = folder
        self.order: list[tuple[str, str]] = []
        self.stop_after = 10**9
        patch.setattr(builds, "build_of", self.build_of)
        patch.setattr(history, "date_of", self.DATES.__getitem__)
        patch.setattr(history, "this_machine", lambda: "here")
        patch.setattr(time, "time", lambda: 1767225600.5)
        patch.setattr(blocks, "measure", self.measure)
        patch.setattr(blocks, "measure_kernels", self.measure_kernels)
        patch.setattr(counted, "count_case", self.count_case)
        patch.setattr(counted, "count_kernel", lambda program, kernel, folder: (77, ""))

    def count_case(self, program: Path, case: Case, folder: Path) -> tuple[int, str]:
        if case.name != "old":
            raise NotMeasured("it does not run under valgrind")
        return 1000, "shapes"

    def build_of(self, revision: str) -> Build:
        if revision == "broken":
            raise NotBuilt("broken does not build")
        program = self.folder / revision / "build" / "release" / "hausbench"
        return Build(
            revision,
            program,
            program.parent / "kernel_bench" if revision[0] != "1" else None,
            self.folder / revision,
        )

    def measure(self, program: Path, case: Case, folder: Path) -> Block:
        commit = program.parents[2].name
        assert folder.is_dir() and folder.is_relative_to(program.parents[2])
        self.order.append((case.name, commit))
        if len(self.order) > self.stop_after:
            raise KeyboardInterrupt
        if case.name == "new" and commit[0] == "1":
            raise NotMeasured("unknown solver")
        count = self.order.count((case.name, commit))
        if case.name == "odd" and commit[0] == "1":
            raise NotMeasured("its result cannot be read")
        if case.name == "late" and count == 3:
            raise NotMeasured("no end")
        return Block(
            int(commit[0]) + count / 100,
            9.0,
            0.1,
            "before" if case.name == "moved" and commit[0] in "12" else "same",
            counters={"a": 10 * int(commit[0]) + count, "none": 0},
        )

    def measure_kernels(self, program: Path, names: list[str], folder: Path) -> dict[str, float]:
        self.order.append(("kernels", program.parents[2].name))
        return {name: 1e-5 for name in names if name == "build/bvh"}


@pytest.fixture
def world(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> World:
    return World(tmp_path, monkeypatch)


REVISIONS = ["3" * 10, "broken", "1" * 10, "2" * 10, "1" * 10]


def measure(
    world: World, names: list[str], blocks_: int, instructions: bool = False
) -> dict[tuple[str, str], Row]:
    rows = history.measure(
        REVISIONS,
        world.folder / "history.csv",
        blocks_,
        instructions,
        [case(name) for name in names],
        KERNELS[:2],
    )
    written = read(world.folder / "history.csv")
    blocks_written = {(row.key, row.blocks) for row in written}
    assert {(row.key, row.blocks) for row in rows} == blocks_written
    return {(row.commit[0], row.case): row for row in written}


def test_rounds_go_forth_and_back_and_every_commit_has_as_many_blocks(world: World) -> None:
    measure(world, ["old", "other"], 4)
    turns = [commit[0] for name, commit in world.order if name == "old"]
    assert "".join(turns) == "123321123321"
    assert [name for name, _ in world.order[:6]] == ["old"] * 3 + ["other"] * 3
    assert set(Counter(world.order).values()) == {4}


def test_the_date_orders_commits(world: World, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(
        history, "date_of", {**world.DATES, "1" * 10: "2026-02-01T00:00:00Z"}.__getitem__
    )
    measure(world, ["old"], 1)
    assert [commit[0] for name, commit in world.order if name == "old"] == ["2", "3", "1"]


def test_medians_intervals_counters_and_kernels(world: World) -> None:
    rows = measure(world, ["old"], 8, True)
    row = rows["2", "old"]
    assert (row.cpu_seconds, row.cpu_low, row.cpu_high, row.blocks) == pytest.approx(
        (2.045, 2.01, 2.08, 8)
    )
    assert (
        row.wall_seconds == 9.0
        and row.counters == {"a": 28}
        and row.shapes == "same"
        and row.instructions == 1000
        and row.machine == "here"
    )
    assert row.measured == "2026-01-01T00:00:00Z" and all(
        entry.measured == row.measured for entry in rows.values()
    )
    assert rows["2", "build/bvh"].cpu_seconds == 1e-5 and rows["2", "build/bvh"].instructions == 77
    assert rows["1", "build/bvh"].blocks == 0  # this commit has no kernel_bench
    assert rows["3", KERNELS[1].name].blocks == 0  # this kernel is not in kernel_bench


def test_what_a_commit_lacks_stays_empty_and_is_not_asked_again(
    world: World, capsys: pytest.CaptureFixture[str]
) -> None:
    rows = measure(world, ["new", "moved", "late", "odd"], 4)
    assert rows["1", "odd"].blocks == 0 and rows["2", "odd"].blocks == 4
    empty = rows["1", "new"]
    assert empty.blocks == 0 and math.isnan(empty.cpu_seconds) and empty.counters == {}
    assert world.order.count(("new", "1" * 10)) == 1
    assert (
        rows["1", "moved"].blocks == rows["2", "moved"].blocks == 0
        and rows["3", "moved"].blocks == 4
    )  # the newest commit's shapes count
    assert world.order.count(("moved", "2" * 10)) == 1
    assert rows["3", "late"].blocks == 2  # blocks before the failure are kept
    output = capsys.readouterr().err
    for line in (
        "1111111111: no blocks from here on: new: unknown solver",
        "1111111111, 2222222222, 3333333333: no blocks from here on: late: no end",
        "1111111111, 2222222222: no blocks from here on: moved: it has other shapes than 3333333333",
        f"1111111111: no blocks from here on: build/bvh, {KERNELS[1].name}: there is no kernel_bench",
    ):
        assert output.count(line) == 1
    assert "broken is left out: broken does not build" in output


def test_an_interruption_loses_one_round(world: World) -> None:
    world.stop_after = (
        12  # in the second round: a round measures 8, including the kernels of two commits
    )
    with pytest.raises(KeyboardInterrupt):
        measure(world, ["old", "other"], 8)
    rows = read(world.folder / "history.csv")
    assert {row.blocks for row in rows if row.case in ("old", "other")} == {1} and len(rows) == 12


def test_what_another_run_writes_meanwhile_stays(
    world: World, monkeypatch: pytest.MonkeyPatch
) -> None:
    file, inner = world.folder / "history.csv", world.measure

    def with_another(program: Path, case: Case, folder: Path) -> Block:
        if len(world.order) == 7:
            add(file, [ROW])
        return inner(program, case, folder)

    monkeypatch.setattr(blocks, "measure", with_another)
    add(file, [EMPTY])
    rows = history.measure(["1" * 10, "2" * 10], file, 3, False, [case("old"), case("other")], [])
    assert len(rows) == len(read(file)) == 6 and {ROW.key, EMPTY.key} < {row.key for row in rows}


def test_a_second_run_has_rows_of_its_own(world: World, monkeypatch: pytest.MonkeyPatch) -> None:
    file = world.folder / "history.csv"
    history.measure(["1" * 10, "2" * 10], file, 2, False, [case("old")], [])
    first = file.read_text()
    monkeypatch.setattr(time, "time", lambda: 1767225601.0)
    history.measure(["2" * 10], file, 2, False, [case("old")], [])
    assert file.read_text().startswith(first) and [row.measured[-3:] for row in read(file)] == [
        "00Z",
        "00Z",
        "01Z",
    ]


def test_instructions_are_saved_commit_by_commit_and_an_interruption_cancels_the_rest(
    world: World, monkeypatch: pytest.MonkeyPatch
) -> None:
    begun: list[str] = []

    def count(program: Path, case: Case, folder: Path) -> tuple[int, str]:
        commit = program.parents[2].name
        begun.append(commit)
        if commit[0] == "2":
            if case.name == "case 0":
                raise KeyboardInterrupt
            time.sleep(0.02)
        return 500, "shapes"

    monkeypatch.setattr(counted, "count_case", count)
    many: list[Any] = [case(f"case {i}") for i in range(60)]
    with pytest.raises(KeyboardInterrupt):
        history.measure(["1" * 10, "2" * 10], world.folder / "history.csv", 1, True, many, [])
    rows = read(world.folder / "history.csv")
    assert {(row.commit[0], row.instructions) for row in rows} == {("1", 500), ("2", None)}
    time.sleep(0.1)
    assert begun.count("2" * 10) < 30


def test_reasons_are_short_and_the_same_for_the_same_mistake() -> None:
    problem = NotMeasured(
        "exit code 2: hausbench: /tmp/casehp5.toml:9: unknown solver 'nohd' (known: naive, guthe)"
    )
    assert history.short(problem) == "unknown solver"
    assert (
        history.short(NotMeasured("skipped: its origin 'bunny' is missing"))
        == "skipped: its origin 'bunny' is missing"
    )


def test_no_commit_builds(world: World) -> None:
    with pytest.raises(NotBuilt, match="no commit"):
        history.measure(["broken"], world.folder / "history.csv", 2, False, [case("old")], [])


def test_the_command(
    world: World, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    file = world.folder / "history.csv"
    where = ["--csv", str(file)]
    with pytest.raises(SystemExit):
        history.main(where)
    assert "REV" in capsys.readouterr().err
    world.stop_after = 0
    assert history.main([*where, "1" * 10]) == 130
    file.write_text("nonsense\n")
    assert history.main([*where, "1" * 10]) == 2
    assert f"{file}, line 1" in capsys.readouterr().err
    requests: list[tuple[object, ...]] = []

    def fake_measure(*words: object) -> list[Row]:
        requests.append(words)
        return [ROW]

    monkeypatch.setattr(history, "measure", fake_measure)
    assert history.main([*where, "A", "B", "--blocks", "3", "--no-instructions"]) == 0
    assert (
        requests == [(["A", "B"], file, 3, False)]
        and "1 rows; make report" in capsys.readouterr().out
    )
