"""The history: its file, measuring in turn (with builds and blocks that are made up), and the picture with its table of steps."""

from __future__ import annotations

import csv
import dataclasses
import math
import re
import sys
import tomllib
from collections import Counter
from pathlib import Path
from types import ModuleType

import matplotlib.pyplot as plt
import pytest

from bench.tracking import blocks, builds, history, picture
from bench.tracking.blocks import Block, NotMeasured
from bench.tracking.builds import Build, NotBuilt
from bench.tracking.cases import KERNELS, ROOT, Case, cases
from bench.tracking.builds import fetched_origins
from bench.tracking.history import COLUMNS, Row, machine, merged, read, write

CPUINFO = """processor\t: 0
model name\t: Intel(R) Xeon(R)   Gold 6248 CPU @ 2.50GHz
flags\t\t: fpu sse2 avx2 avx512f avx512dq

processor\t: 1
model name\t: Intel(R) Xeon(R)   Gold 6248 CPU @ 2.50GHz
flags\t\t: fpu sse2 avx2 avx512f avx512dq
"""
ROW = Row("a" * 10, "2026-01-01T00:00:00Z", "a machine, 2 cores", "guthe on mesh", 0.01, 0.009, 0.011, 8, 0.02, 12345,
          {"z": 1, "bound_tests": 7}, "f00")
EMPTY = Row("b" * 10, "2026-01-02T00:00:00Z", "a machine, 2 cores", "guthe on mesh")


# --- the file --------------------------------------------------------------------------------------------------------


def test_what_is_written_is_read(tmp_path: Path) -> None:
    file = tmp_path / "new folder" / "history.csv"
    assert read(file) == []
    single = dataclasses.replace(EMPTY, cpu_seconds=1.5, blocks=1)
    write(file, [single, ROW])
    found = read(file)
    assert found[0] == ROW and repr(found[1]) == repr(single)  # NaN is not equal to itself
    lines = file.read_text().splitlines()
    assert lines[1] == 'aaaaaaaaaa,2026-01-01T00:00:00Z,"a machine, 2 cores",guthe on mesh,0.01,0.009,0.011,8,0.02,12345,bound_tests=7 z=1,f00'
    assert lines[2] == 'bbbbbbbbbb,2026-01-02T00:00:00Z,"a machine, 2 cores",guthe on mesh,1.5,,,1,,,,'
    assert list(file.parent.iterdir()) == [file]


def test_rows_are_in_order_of_date_then_case(tmp_path: Path) -> None:
    late, early = dataclasses.replace(ROW, date="2026-03-01T00:00:00Z", commit="0" * 10), dataclasses.replace(ROW, case="b")
    write(tmp_path / "h.csv", [late, early, dataclasses.replace(early, case="a")])
    assert [(row.date[5:7], row.case) for row in read(tmp_path / "h.csv")] == [("01", "a"), ("01", "b"), ("03", "guthe on mesh")]


GOOD = 'aaaaaaaaaa,2026-01-01T00:00:00Z,m,c,0.01,0.009,0.011,8,0.02,12345,a=7,f00'


@pytest.mark.parametrize(("bad", "what"), [
    ("<<<<<<< HEAD", "1 cells"), (GOOD.replace("0.009", "-1"), "-1 is no time"), (GOOD.replace("0.011", "inf"), "inf is no time"),
    (GOOD.replace("0.01,", ",", 1), "no blocks without a time"),
    (GOOD.replace(",8,", ",eight,"), "eight"), (GOOD.replace("a=7", "a"), "invalid literal"), (GOOD.replace("2026-01-01T", "January "), "January"),
    (GOOD.replace("aaaaaaaaaa", "main"), "'main' is no commit"), (GOOD.replace(",m,", ",,"), "is empty"), (GOOD, "there twice")])
def test_a_bad_line_is_named_with_a_remedy(tmp_path: Path, bad: str, what: str) -> None:
    file = tmp_path / "history.csv"
    file.write_text("\n".join([",".join(COLUMNS), GOOD, bad]) + "\n")
    with pytest.raises(ValueError, match=re.escape(f"{file}, line 3: ")) as problem:
        read(file)
    assert what in str(problem.value) and "git checkout" in str(problem.value)


def test_another_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "h.csv").write_text("part,scene\nbuild,bunny\n")
    with pytest.raises(ValueError, match="line 1: the columns are not commit,date"):
        read(tmp_path / "h.csv")


def test_measured_again_replaces_on_the_same_machine_only() -> None:
    again = dataclasses.replace(ROW, cpu_seconds=0.5, instructions=None)
    assert merged([ROW], [again]) == [dataclasses.replace(again, instructions=12345)]  # the count of a commit stays
    others = dataclasses.replace(again, shapes="other")
    assert merged([ROW], [others]) == [others]  # but not of another case
    elsewhere = dataclasses.replace(again, machine="another")
    assert merged([ROW], [elsewhere]) == [ROW, elsewhere]
    nothing = Row(ROW.commit, ROW.date, ROW.machine, ROW.case)
    assert merged([ROW], [nothing]) == [ROW] and repr(merged([], [nothing])) == repr([nothing])
    fewer = dataclasses.replace(ROW, blocks=7, cpu_seconds=0.5)
    assert merged([ROW], [fewer]) == [fewer] and merged([ROW], [fewer], finished=False) == [ROW]  # an interrupted run destroys nothing


def test_the_machine() -> None:
    assert machine(CPUINFO, "g++ 12.2.0") == "Intel Xeon Gold 6248 CPU @ 2.50GHz, 2 cores, g++ 12.2.0, AVX-512"
    older = CPUINFO.replace("avx512", "xyz").split("\n\n")[0]
    assert machine(older, "no g++") == "Intel Xeon Gold 6248 CPU @ 2.50GHz, 1 core, no g++, no AVX-512"
    assert "processor, 0 cores" in machine("", "g++ 1")


# --- measuring -------------------------------------------------------------------------------------------------------


def test_origins_are_followed_to_what_is_fetched() -> None:
    models = {"bunny": {"source": "debian"}, "npm": {"source": "npm"}, "half": {"source": "derived", "from": "bunny"},
              "noisy": {"source": "derived", "from": "half"}, "torus": {"source": "generated"}, "a": {"source": "derived", "from": "b"},
              "b": {"source": "derived", "from": "a"}, "lost": {"source": "derived", "from": "nothing"}}
    assert fetched_origins(models, ["noisy", "half", "torus", "a", "lost", "unknown", "npm"]) == ["bunny", "npm"]


def test_todays_cases_need_four_models() -> None:
    models = tomllib.loads((ROOT / "datasets" / "manifest.toml").read_text())["model"]
    assert fetched_origins(models, {model for case in cases() for model in case.models}) == ["bear", "bunny", "bunny_small", "elephant"]


def test_a_commit_fetches_by_its_own_program(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "datasets").mkdir()
    builds.fetch(tmp_path, ["half"])  # the first commits had no manifest
    (tmp_path / "datasets" / "manifest.toml").write_text('[model.cow]\nsource = "npm"\n[model.half]\nsource = "derived"\nfrom = "cow"\n')
    (tmp_path / "datasets" / "fetch.py").write_text("import sys\nopen('asked', 'a').write(' '.join(sys.argv[1:]))\nsys.exit('no network')\n")
    builds.fetch(tmp_path, ["half", "torus"])
    assert (tmp_path / "asked").read_text() == "cow"
    assert "ended with 1: no network" in capsys.readouterr().err
    builds.fetch(tmp_path, ["torus"])
    assert (tmp_path / "asked").read_text() == "cow"


def case(name: str) -> Case:
    return Case(name, {"scene": [{"source": "a", "target": "b"}]})


class World:
    """Three commits, newest last: the first does not know "new", and has other shapes in "moved", as has the second. Times are those of the commit."""

    DATES = {"1" * 10: "2026-01-01T00:00:00Z", "2" * 10: "2026-01-02T00:00:00Z", "3" * 10: "2026-01-03T00:00:00Z"}

    def __init__(self, folder: Path, patch: pytest.MonkeyPatch) -> None:
        self.folder = folder
        self.order: list[tuple[str, str]] = []
        self.stop_after = 10**9
        patch.setattr(builds, "build_of", self.build_of)
        patch.setattr(history, "date_of", self.DATES.__getitem__)
        patch.setattr(history, "this_machine", lambda: "here")
        patch.setattr(blocks, "measure", self.measure)
        patch.setattr(blocks, "measure_kernels", self.measure_kernels)
        counted = ModuleType("bench.tracking.counted")
        vars(counted).update(instructions_of=lambda program, case, folder: 1000 if case.name == "old" else None,
                             kernel_instructions=lambda program, kernel, folder: 77)
        patch.setitem(sys.modules, "bench.tracking.counted", counted)

    def build_of(self, revision: str) -> Build:
        if revision == "broken":
            raise NotBuilt("broken does not build")
        program = self.folder / revision / "build" / "release" / "hausbench"
        return Build(revision, program, program.parent / "kernel_bench" if revision[0] != "1" else None)

    def measure(self, program: Path, one: Case, folder: Path) -> Block:
        commit = program.parents[2].name
        assert folder.is_dir() and folder.is_relative_to(program.parents[2])
        self.order.append((one.name, commit))
        if len(self.order) > self.stop_after:
            raise KeyboardInterrupt
        if one.name == "new" and commit[0] == "1":
            raise NotMeasured("unknown solver")
        count = self.order.count((one.name, commit))
        if one.name == "odd" and commit[0] == "1":
            raise NotMeasured("its result cannot be read")
        if one.name == "late" and count == 3:
            raise NotMeasured("no end")
        return Block(int(commit[0]) + count / 100, 9.0, 0.1, "before" if one.name == "moved" and commit[0] in "12" else "same",
                     counters={"a": int(commit[0])})

    def measure_kernels(self, program: Path, names: list[str], folder: Path) -> dict[str, float]:
        self.order.append(("kernels", program.parents[2].name))
        return {name: 1e-5 for name in names if name == "build/bvh"}


@pytest.fixture
def world(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> World:
    return World(tmp_path, monkeypatch)


REVISIONS = ["3" * 10, "broken", "1" * 10, "2" * 10, "1" * 10]


def measure(world: World, names: list[str], blocks_: int, instructions: bool = False) -> dict[tuple[str, str], Row]:
    rows = history.measure(REVISIONS, world.folder / "history.csv", blocks_, instructions, [case(name) for name in names], KERNELS[:2])
    written = read(world.folder / "history.csv")
    assert {(row.key, row.blocks) for row in rows} == {(row.key, row.blocks) for row in written}
    return {(row.commit[0], row.case): row for row in written}


def test_rounds_go_forth_and_back_and_every_commit_has_as_many_blocks(world: World) -> None:
    measure(world, ["old", "other"], 4)
    turns = [commit[0] for name, commit in world.order if name == "old"]
    assert "".join(turns) == "123321123321"
    assert [name for name, _ in world.order[:6]] == ["old"] * 3 + ["other"] * 3
    assert set(Counter(world.order).values()) == {4}


def test_the_date_orders_commits(world: World, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(history, "date_of", {**world.DATES, "1" * 10: "2026-02-01T00:00:00Z"}.__getitem__)
    measure(world, ["old"], 1)
    assert [commit[0] for name, commit in world.order if name == "old"] == ["2", "3", "1"]


def test_medians_intervals_counters_and_kernels(world: World) -> None:
    rows = measure(world, ["old"], 8, True)
    row = rows["2", "old"]
    assert (row.cpu_seconds, row.cpu_low, row.cpu_high, row.blocks) == pytest.approx((2.045, 2.01, 2.08, 8))
    assert row.wall_seconds == 9.0 and row.counters == {"a": 2} and row.shapes == "same" and row.instructions == 1000 and row.machine == "here"
    assert rows["2", "build/bvh"].cpu_seconds == 1e-5 and rows["2", "build/bvh"].instructions == 77
    assert rows["1", "build/bvh"].blocks == 0  # no kernel_bench
    assert rows["3", KERNELS[1].name].blocks == 0  # not in it


def test_what_a_commit_lacks_stays_empty_and_is_not_asked_again(world: World, capsys: pytest.CaptureFixture[str]) -> None:
    rows = measure(world, ["new", "moved", "late", "odd"], 4)
    assert rows["1", "odd"].blocks == 0 and rows["2", "odd"].blocks == 4
    empty = rows["1", "new"]
    assert empty.blocks == 0 and math.isnan(empty.cpu_seconds) and empty.counters == {}
    assert world.order.count(("new", "1" * 10)) == 1
    assert rows["1", "moved"].blocks == rows["2", "moved"].blocks == 0 and rows["3", "moved"].blocks == 4  # the newest one decides
    assert world.order.count(("moved", "2" * 10)) == 1
    assert rows["3", "late"].blocks == 2  # what there was is kept
    said = capsys.readouterr().err
    for line in ("1111111111: no blocks from here on: new: unknown solver", "3333333333: no blocks from here on: late: no end",
                 "2222222222: no blocks from here on: moved: its shapes are not those of 3333333333",
                 f"1111111111: no blocks from here on: build/bvh, {KERNELS[1].name}: there is no kernel_bench"):
        assert said.count(line) == 1
    assert "broken is left out: broken does not build" in said


def test_an_interruption_loses_one_round(world: World) -> None:
    world.stop_after = 12  # of 8 in a round, with the kernels of two commits: in the second
    with pytest.raises(KeyboardInterrupt):
        measure(world, ["old", "other"], 8)
    rows = read(world.folder / "history.csv")
    assert {row.blocks for row in rows if row.case in ("old", "other")} == {1} and len(rows) == 12


def test_reasons_are_short_and_the_same_for_the_same_mistake() -> None:
    problem = NotMeasured("exit code 2: hausbench: /tmp/casehp5.toml:9: unknown solver 'nohd' (known: naive, guthe)")
    assert history.short(problem) == "unknown solver"
    assert history.short(NotMeasured("skipped: its origin 'bunny' is missing")) == "skipped: its origin 'bunny' is missing"


def test_no_commit_builds(world: World) -> None:
    with pytest.raises(NotBuilt, match="no commit"):
        history.measure(["broken"], world.folder / "history.csv", 2, False, [case("old")], [])


def test_the_command(world: World, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    file = world.folder / "history.csv"
    where = ["--csv", str(file), "--out", str(world.folder / "out")]
    assert history.main(where) == 2
    assert "--measure HEAD" in capsys.readouterr().err
    world.stop_after = 0
    assert history.main([*where, "--measure", "1" * 10]) == 130
    file.write_text("nonsense\n")
    assert history.main(where) == 2
    assert f"{file}, line 1" in capsys.readouterr().err
    asked: list[tuple[object, ...]] = []

    def fake_measure(*words: object) -> list[Row]:
        asked.append(words)
        return [ROW]

    monkeypatch.setattr(history, "measure", fake_measure)
    monkeypatch.setattr(picture, "save", lambda rows, out: [out / "it"])
    assert history.main([*where, "--measure", "A", "B", "--blocks", "3", "--no-instructions"]) == 0
    assert asked == [(["A", "B"], file, 3, False)]


# --- the picture -----------------------------------------------------------------------------------------------------


def made_up() -> list[Row]:
    """Twelve commits on one machine, the last six on another too; "guthe ..." halves at the seventh, a kernel's instructions grow at the fourth."""
    first = cases()[0].name
    rows = []
    for i in range(12):
        date, commit = f"2026-01-{i + 1:02}T00:00:00Z", f"{i:010x}"
        for where in ["one"] + ["two"] * (i >= 6):
            t = (0.02 if i < 6 else 0.01) * (1.0 if where == "one" else 3.0)
            count = int(t * 1e9) if where == "one" else None
            rows.append(Row(commit, date, where, first, t, 0.99 * t, 1.01 * t, 8, t, count, {}, "s"))
        rows.append(Row(commit, date, "one", KERNELS[0].name, 1e-5, 1e-5, 1e-5, 8, math.nan, 100 if i < 3 else 150))
        rows.append(Row(commit, date, "one", "never measured"))
        rows.append(Row(commit, date, "one", "no longer tracked", 1e-3, math.nan, math.nan, 1))
    return rows


def save(rows: list[Row], out: Path) -> list[Path]:
    return picture.save(rows, out, lambda commit: f"subject {int(commit, 16)}", lambda before, after: str(int(after, 16) - int(before, 16)))


def test_pictures_and_the_table_of_steps(tmp_path: Path) -> None:
    paths = save(made_up(), tmp_path)
    assert [path.relative_to(tmp_path).as_posix() for path in paths] == [
        "figures/history.pdf", "figures/history.png", "figures/history_kernels.pdf", "figures/history_kernels.png", "tables/history_steps.csv",
        "tables/history_steps.md", "tables/history_steps.tex"]
    assert all(path.stat().st_size > 0 for path in paths)
    text = (tmp_path / "tables" / "history_steps.md").read_text()
    assert f"| 0000000 subject 2 | 0000000 subject 3 | 1 | {KERNELS[0].name} | one | — | 1.50× more |" in text
    assert f"| 0000000 subject 5 | 0000000 subject 6 | 1 | {cases()[0].name} | one | 2.00× faster | 2.00× fewer |" in text
    with (tmp_path / "tables" / "history_steps.csv").open() as file:
        records = list(csv.DictReader(file))
    assert [(record["before_subject"], record["after_subject"]) for record in records] == [("subject 2", "subject 3"), ("subject 5", "subject 6")]
    assert float(records[1]["time_ratio"]) == pytest.approx(0.5) and records[0]["time_ratio"] == ""


def test_machines_are_apart() -> None:
    at = picture.places([row for row in made_up() if row.blocks])
    one, two = ([place for (machine, _), place in at.items() if machine == name] for name in ("one", "two"))
    assert one == list(range(12)) and two == list(range(14, 20))
    figure = picture.draw([row for row in made_up() if row.case == cases()[0].name], [cases()[0].name])
    spans = [sorted(line.get_xdata()) for line in figure.axes[0].get_lines() if line.get_color() == picture.TIME and len(line.get_xdata()) > 1]
    assert [(span[0], span[-1]) for span in spans] == [(0, 11), (14, 19)]  # no line goes from one to the other
    plt.close(figure)


def test_times_of_other_shapes_and_empty_rows_are_not_in_a_series() -> None:
    rows = [dataclasses.replace(ROW, commit=f"{i:010x}", date=f"2026-01-{i + 1:02}T00:00:00Z", shapes="old" if i < 3 else "new") for i in range(6)]
    rows[4] = Row(rows[4].commit, rows[4].date, ROW.machine, ROW.case)
    assert [int(row.commit, 16) for row in picture.series(rows, ROW.case, ROW.machine)] == [3, 5]
    assert picture.series(rows, ROW.case, "another") == []


def test_a_noisy_case_needs_a_larger_step() -> None:
    def found(half_width: float) -> int:
        values = [1.0] * 5 + [1.08] * 2
        return len(picture.steps_of([dataclasses.replace(ROW, commit=f"{i:010x}", cpu_seconds=t, cpu_low=t * (1 - half_width),
                                                         cpu_high=t * (1 + half_width), instructions=None) for i, t in enumerate(values)]))
    assert (found(0.001), found(0.03), found(0.1)) == (1, 1, 0)


def test_words_of_a_step() -> None:
    def words(what: str, ratio: float) -> str:
        return picture.Found("c", "m", what, ROW, ROW, ratio).words
    assert (words("time", 1.05), words("time", 0.5), words("time", 12.3)) == ("1.05× slower", "2.00× faster", "12× slower")
    assert (words("instructions", 1.5), words("instructions", 0.5)) == ("1.50× more", "2.00× fewer")


@pytest.mark.parametrize(("low", "high"), [(0.9, 1.1), (1.3, 4.2), (2.0, 17.0), (0.01, 900.0), (99.0, 160.0)])
def test_an_axis_has_two_to_six_ticks(low: float, high: float) -> None:
    found = picture.ticks(low, high)
    assert 2 <= len(found) <= 6 and all(low <= x <= high for x in found)


@pytest.mark.parametrize("n", [1, 26, 27, 100])
def test_labels_have_room_and_the_newest_has_one(n: int) -> None:
    named = picture.labels({("m", f"{i:010x}"): i for i in range(n)}, 26)
    assert len(named) <= 26 and n - 1 in named and (n > 26 or len(named) == n)


def test_nothing_to_draw(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="no times"):
        save([EMPTY], tmp_path)
