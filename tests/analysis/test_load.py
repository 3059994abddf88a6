"""Reading result files: columns, groupings, the reference interval, and unusable files."""

from __future__ import annotations

import hashlib
from pathlib import Path

import h5py
import numpy as np
import pytest
import synthetic
from synthetic import ResultFile, spread

from analysis import schema
from analysis.shared import load, notes, remedy, style
from analysis.shared.results import ResultError, Results


def test_columns_follow_from_the_program() -> None:
    """analysis/shared/columns.py, the tables of results/README.md and docs/experiments.md, and
    these tests' generator list the program's columns."""
    if not schema.program().is_file():
        pytest.skip("the program is not built")
    groups = schema.columns()
    assert schema.MODULE.read_text(encoding="utf-8") == schema.module(
        groups
    ), "run python3 -m analysis.schema"
    text = schema.README.read_text(encoding="utf-8")
    assert text == schema.readme(text, groups), "run python3 -m analysis.schema"
    page = schema.EXPERIMENTS.read_text(encoding="utf-8")
    assert page == schema.experiments(
        page, schema.listed("keys", "--json")
    ), "run python3 -m analysis.schema"
    written = {
        "models": synthetic.MODEL,
        "cases": synthetic.CASE,
        "answers": synthetic.ANSWER,
        "repeats": synthetic.REPEAT,
        "preparation": synthetic.PREPARATION,
        "trace": synthetic.TRACE,
        "fields": synthetic.FIELD,
        "ledger": synthetic.LEDGER,
    }
    for group, columns in groups.items():
        names = {column["name"] for column in columns}
        assert {
            "counter_*" if name.startswith("counter_") else name for name in written[group]
        } == names, group


def test_titles_follow_from_the_program() -> None:
    """analysis/shared/style.py uses the program's title for each solver."""
    if not schema.program().is_file():
        pytest.skip("the program is not built")
    titles = {solver["name"]: solver["title"] for solver in schema.listed("--json")["solvers"]}
    drawn = {name: look.title for name, look in style.LOOKS.items() if name in titles}
    assert {name: title for name, title in titles.items() if name in style.LOOKS} == drawn


@pytest.fixture()
def small(tmp_path: Path) -> Results:
    file = ResultFile("small", meta={"dirty": 1})
    file.case(
        "naive",
        "x",
        [3.0, 1.0, 2.0],
        lower=1.0,
        upper=1.0,
        prepare_seconds=0.5,
        options={"seed": 3},
        counters={"point_distances": 2**63 + 1},
    )
    file.case(
        "cover",
        "x",
        [0.1],
        [(0.0, 0.0, np.inf), (0.1, 0.9, 1.25)],
        lower=0.9,
        upper=1.25,
        tolerance=0.1,
    )
    file.case("kang", "x", status="timeout", reason="zu spät")
    file.case("zheng", "x", status="unsound", lower=1.1, upper=1.1)
    file.case("tang", "y", [1.0], lower=0.5, upper=0.75)
    file.case(
        "sacht", "y", [1.0], lower=0.625, upper=1.0, status="timeout", reason="the bounds hold"
    )
    file.case(
        "sacht",
        "y",
        [1.0],
        lower=5.0,
        upper=6.0,
        pose_index=1,
        pose=[1.0, 0, 0, 0, 1, 0, 0, 0, 1, 9, 0, 0],
    )
    file.case("adaptive", "z", status="failed")
    file.ledger.append(
        {
            "kind": "not_run",
            "subject": "naive y",
            "what": "case",
            "reason": "points only",
            "count": 2,
        }
    )
    return load.load(file.write(tmp_path))


def test_columns(small: Results) -> None:
    assert small.cases.solver[0] == "naive" and small.cases.reason[2] == "zu spät"
    assert small.cases.pose.shape == (8, 12) and small.cases.witness_source.shape == (8, 3)
    assert int(small.cases.counters["point_distances"][0]) == 2**63 + 1
    assert small.options(0) == {"seed": 3}
    assert small.ledger.count.tolist() == [2] and small.meta["cpu"] == "Test CPU"
    assert set(small.models.name) == {"x/A", "x/B", "y/A", "y/B", "z/A", "z/B"}
    assert "with changes" in notes.machine_line(small)


def test_fields(tmp_path: Path) -> None:
    file = ResultFile("fields")
    for scene in "xyz":
        file.case("guthe", scene, [1.0], lower=1.0, upper=1.0)
    file.field_values = [0.5, 0.25, 3.0, 1.0, np.inf]
    for case, name, begin, end in (
        (0, "distance", 0, 2),
        (2, "distance", 2, 3),
        (2, "upper", 3, 5),
    ):
        file.fields.append({"case": case, "name": name, "begin": begin, "end": end})
    path = file.write(tmp_path)
    results = load.load(path)
    assert {name: values.tolist() for name, values in results.fields_of(0).items()} == {
        "distance": [0.5, 0.25]
    }
    assert results.fields_of(1) == {}
    assert {name: values.tolist() for name, values in results.fields_of(2).items()} == {
        "distance": [3.0],
        "upper": [1.0, np.inf],
    }
    with h5py.File(path, "r+") as older:
        del older["fields"]
    assert load.load(path).fields_of(0) == {}


def test_rows_and_order(small: Results) -> None:
    assert small.rows(scene="y", pose_index=0) == [4, 5]
    assert small.in_order("scene") == ["x", "y", "z"]


def test_each_round_gives_one_number(tmp_path: Path) -> None:
    file = ResultFile("rounds")  # CPU time is 0.9 of wall time
    file.case(
        "naive",
        "x",
        [1.0, 3.0, 2.0, 7.0, 9.0, 8.0],
        rounds=2,
        prepare=[0.5, 0.25],
        lower=1.0,
        upper=1.0,
    )
    file.case("naive", "y", [10.0, 30.0], rounds=1, clock="wall", lower=1.0, upper=1.0)
    results = load.load(file.write(tmp_path))
    assert results.solve_by_round(0) == pytest.approx({0: 1.8, 1: 7.2})
    assert results.solve_by_round(0, "wall") == {0: 2.0, 1: 8.0} and results.wall_seconds(
        0
    ).tolist() == [2.0, 8.0]
    assert results.prepare_by_round(0) == {0: 0.5, 1: 0.25} and results.prepare_by_round(1) == {}
    assert results.total_by_round(0) == pytest.approx({0: 2.3, 1: 7.45})
    assert results.total_seconds(1).tolist() == [20.0]  # this row names the wall clock


def test_an_outside_program_that_waits_is_timed_by_the_wall(tmp_path: Path) -> None:
    file = ResultFile("waits", wall=1.0, cpu=0.15)
    for solver in ("external", "naive"):
        file.case(solver, "x", [1.0, 2.0], lower=1.0, upper=1.0)
    file.answers[1]["cpu_seconds"] = 0.5  # one deviating round must not change the clock
    results = load.load(file.write(tmp_path))
    assert [results.clock_of(case) for case in range(2)] == ["wall", "cpu"]
    assert results.first_by_round(0) == {0: 1.0, 1: 2.0} and results.first_by_round(
        1
    ) == pytest.approx({0: 0.15, 1: 0.3})
    assert "wall time for external, where" in notes.clock_note(results).replace(
        style.title("external"), "external"
    )
    assert "used the CPU for less than 20 % of its wall time" in notes.clock_note(results)


def test_clock(tmp_path: Path) -> None:
    """CPU time is used only if the row names the CPU clock and has CPU times."""
    file = ResultFile("clocks")
    for clock in ("cpu", "wall", "", "cpu", "cpu"):
        file.case("naive", "x", [1.0], clock=clock, lower=1.0, upper=1.0)
    file.repeats[3]["cpu_seconds"] = np.nan
    file.repeats = [row for row in file.repeats if row["case"] != 4]
    file.answers = [
        row for row in file.answers if row["case"] != 4
    ]  # like a row that was read off a trace
    results = load.load(file.write(tmp_path))
    assert [results.clock_of(case) for case in range(5)] == ["cpu", "wall", "wall", "wall", "wall"]
    assert [results.solve_by_round(case)[0] for case in range(5)] == [0.9, 1.0, 1.0, 1.0, 1.0]


def test_structures_of_a_round_are_added(tmp_path: Path) -> None:
    file = ResultFile("parts")
    file.case("naive", "x", [1.0, 1.0], prepare_seconds=0.5, lower=1.0, upper=1.0)
    file.preparation = [
        {"case": 0, "round": 1, "name": name, "seconds": 0.25} for name in ("tree", "grid", "order")
    ]
    results = load.load(file.write(tmp_path))
    # Round 0 has no preparation rows, so the median over the rounds, 0.5 s, is used.
    assert results.total_by_round(0, "wall") == {0: 1.5, 1: 1.75}


def test_preparing_counts_with_the_first_answer_of_a_process(tmp_path: Path) -> None:
    """A solver that builds structures during its first answer is faster afterwards, but a single
    query has to wait for them."""
    file = ResultFile("first", cpu=1.0)
    file.case(
        "scan",
        "x",
        [1.0, 2.0],
        rounds=2,
        prepare=[0.5, 0.25],
        first=[4.0, 8.0],
        lower=1.0,
        upper=1.0,
    )
    results = load.load(file.write(tmp_path))
    assert results.total_by_round(0) == {0: 4.5, 1: 8.25} and results.solve_by_round(0) == {
        0: 1.0,
        1: 2.0,
    }


def test_without_repeats_the_first_answers_count(tmp_path: Path) -> None:
    file = ResultFile("first", cpu=0.5)
    file.case("naive", "x", first=[4.0, 8.0], rounds=2, lower=1.0, upper=1.0)
    file.case("naive", "x", lower=1.0, upper=1.0, solve_seconds=7.0, from_trace=1)
    results = load.load(file.write(tmp_path))
    assert results.solve_by_round(0) == {0: 2.0, 1: 4.0} and results.clock_of(0) == "cpu"
    assert results.total_seconds(1).tolist() == [7.0] and results.clock_of(1) == "wall"


def test_trace(small: Results) -> None:
    assert small.trace_of(1).upper.tolist() == [np.inf, 1.25] and len(small.trace_of(0)) == 0


def test_reference_is_the_tightest_of_all_rows_with_bounds(small: Results) -> None:
    assert small.reference("x") == (
        1.0,
        1.0,
    )  # the timeout has no bounds, and the unsound row does not count
    assert small.reference("y") == (0.625, 0.75)
    assert small.reference("y", 1) == (5.0, 6.0)
    assert np.isnan(small.reference("z")).all() and np.isnan(small.reference("nowhere")).all()


def test_only_certified_rows_make_a_reference(tmp_path: Path) -> None:
    file = ResultFile("certified")
    file.case("guthe", "x", [1.0], lower=1.0, upper=2.0)
    file.case("cgal", "x", [1.0], lower=1.5, upper=1.5, certified=0)
    file.case("external", "y", [1.0], lower=1.5, upper=1.5, certified=0)
    results = load.load(file.write(tmp_path))
    assert results.reference("x") == (1.0, 2.0) and results.error(1) == 0.5
    assert np.isnan(results.reference("y")).all() and np.isnan(results.error(2))


def test_a_reference_is_of_one_quantity_in_one_pose_of_both_shapes(tmp_path: Path) -> None:
    file = ResultFile("asked")
    file.case("guthe", "x", [1.0], lower=1.0, upper=2.0)
    file.case("guthe", "x", [1.0], lower=3.0, upper=4.0, quantity="symmetric")
    file.case(
        "guthe",
        "x",
        [1.0],
        lower=5.0,
        upper=6.0,
        target_pose=[1.0, 0, 0, 0, 1, 0, 0, 0, 1, 9, 0, 0],
    )
    file.case(
        "guthe",
        "x",
        [1.0],
        lower=1.5,
        upper=2.0,
        target_pose=[1.0, 0, 0, 0, 1, 0, 0, 0, 1, -0.0, 0, 0],
    )
    results = load.load(file.write(tmp_path))
    assert [results.reference_of(case) for case in range(4)] == [
        (1.5, 2.0),
        (3.0, 4.0),
        (5.0, 6.0),
        (1.5, 2.0),
    ]


def test_error_and_gap(small: Results) -> None:
    assert small.error(0) == 0 and small.gap(0) == 0
    assert small.error(1) == pytest.approx(0.1) and small.gap(1) == pytest.approx(0.35)
    assert small.error(4) == 0.25  # the answer is 0.5, the reference [0.625, 0.75]
    assert small.error(1, lower=0.25) == 0.75


def test_reference_of_bounds_that_contradict_each_other(tmp_path: Path) -> None:
    file = ResultFile("rounding")
    file.case("naive", "x", [1.0], lower=1.0, upper=1.0)
    file.case("inc", "x", [1.0], lower=1.25, upper=1.25)
    results = load.load(file.write(tmp_path))
    assert results.reference("x") == (1.0, 1.25) and results.error(0) == 0.25 == results.error(1)


def test_bounds_that_were_not_checked_are_named(tmp_path: Path) -> None:
    file = ResultFile("unchecked")
    file.case("guthe", "x", [1.0], lower=0.5, upper=0.6)
    file.case("cgal", "x", [1.0], lower=0.5, upper=0.6, lower_check="no witness")
    file.case(
        "external", "x", [1.0], label="peer", lower=0.5, upper=np.inf, lower_check="no witness"
    )
    file.case("external", "x", label="gone", status="failed", lower_check="not checked")
    results = load.load(file.write(tmp_path))
    assert notes.unchecked_line(results) == "Lower bounds not checked (no witness): CGAL, peer"
    assert notes.machine_line(results).endswith(
        ". Lower bounds not checked (no witness): CGAL, peer"
    )
    assert (
        notes.unchecked_line(results, [0, 2]) == "Lower bounds not checked (no witness): peer"
        and notes.unchecked_line(results, [0]) == ""
    )
    assert notes.machine_line(results).startswith(notes.measured_on(results) + ". ")
    assert [results.check_of(case) for case in range(2)] == ["holds", "not checked (no witness)"]


def test_missing_file(tmp_path: Path) -> None:
    with pytest.raises(
        ResultError, match=r"none\.h5: no such file: measure it with 'hausbench run none\.toml'"
    ):
        load.load(tmp_path / "none.h5")


def test_newer_schema(tmp_path: Path) -> None:
    file = ResultFile("newer", meta={"schema_version": 3})
    file.case("naive", "x")
    with pytest.raises(ResultError, match=r"newer\.h5: schema version 3 is newer than 2"):
        load.load(file.write(tmp_path))


def test_an_older_file_lacks_columns(tmp_path: Path) -> None:
    """The file of an older program lacks first answers, clocks and preparation by round, so only
    wall times are available."""
    file = ResultFile("older", meta={"schema_version": 1})
    file.case("naive", "x", [3.0], prepare_seconds=0.5, lower=1.0, upper=1.0, solve_seconds=4.0)
    path = file.write(tmp_path)
    with h5py.File(path, "a") as opened:
        for name in (
            "answers",
            "cases/clock",
            "cases/facts",
            "cases/exact",
            "cases/quantity",
            "cases/target_pose",
            "cases/warm",
            "cases/chain",
            "cases/witness_direction",
            "cases/source_longest",
            "models/longest_side",
            "preparation/round",
            "models/box",
            "models/polynomial",
        ):
            del opened[name]
    results = load.load(path)
    assert (
        results.clock_of(0) == "wall"
        and results.solve_by_round(0) == {0: 3.0}
        and results.total_by_round(0) == {0: 3.5}
    )
    assert (
        results.facts(0) == {}
        and np.isnan(results.cases.exact[0])
        and np.isnan(results.models.box).all()
    )
    assert results.models.box.shape == (2, 6) and results.models.polynomial[0] == ""
    assert (
        results.cases.quantity[0] == "directed"
        and results.cases.witness_direction[0] == "source to target"
    )
    assert results.cases.target_pose[0].tolist() == [
        1.0,
        0,
        0,
        0,
        1,
        0,
        0,
        0,
        1,
        0,
        0,
        0,
    ] and results.reference_of(0) == (1.0, 1.0)
    assert (
        results.cases.warm[0] == 0
        and results.cases.chain[0] == ""
        and results.cases.source_longest[0] == 0
    )


def test_a_newer_file_has_more_columns(tmp_path: Path) -> None:
    file = ResultFile("more")
    file.case("naive", "x", [1.0], lower=1.0, upper=1.0)
    path = file.write(tmp_path)
    with h5py.File(path, "a") as opened:
        opened["cases/colour"] = [3.0]
        opened["cases/counter_roots"] = np.array([7], dtype=np.uint64)
    results = load.load(path)
    assert int(results.cases.counters["roots"][0]) == 7 and results.total_by_round(0) == {0: 0.9}


def test_no_hdf5(tmp_path: Path) -> None:
    (tmp_path / "text.h5").write_text("case,solver\n")
    with pytest.raises(ResultError, match=r"text\.h5: not an HDF5 file: name a result"):
        load.load(tmp_path / "text.h5")


def test_foreign_hdf5(tmp_path: Path) -> None:
    with h5py.File(tmp_path / "foreign.h5", "w") as file:
        file["cases"] = [1, 2, 3]
    with pytest.raises(ResultError, match=r"foreign\.h5: not a hausbench result file"):
        load.load(tmp_path / "foreign.h5")


@pytest.mark.parametrize(
    "column", ["cases/upper", "repeats/wall_seconds", "trace/lower", "cases/counter_queue_pushes"]
)
def test_ragged_column(tmp_path: Path, column: str) -> None:
    file = ResultFile("ragged")
    file.case("naive", "x", [1.0], [(0.0, 0.0, 1.0)])
    path = file.write(tmp_path)
    with h5py.File(path, "a") as opened:
        kind = opened[column].dtype
        del opened[column]
        opened[column] = np.zeros(3, dtype=kind)
    with pytest.raises(ResultError, match="columns of one length"):
        load.load(path)


@pytest.mark.parametrize("column", ["cases/upper", "trace/seconds", "models/sha256"])
def test_missing_column(tmp_path: Path, column: str) -> None:
    file = ResultFile("short")
    file.case("naive", "x", spread(1.0, 3))
    path = file.write(tmp_path)
    with h5py.File(path, "a") as opened:
        del opened[column]
    with pytest.raises(ResultError, match=column.split("/")[1]):
        load.load(path)


def test_text_where_a_number_belongs(tmp_path: Path) -> None:
    file = ResultFile("typed")
    file.case("naive", "x")
    path = file.write(tmp_path)
    with h5py.File(path, "a") as opened:
        del opened["cases/upper"]
        opened["cases/upper"] = np.array(["1"], dtype=synthetic.TEXT)
    with pytest.raises(ResultError, match="cases/upper"):
        load.load(path)


def test_no_remedy_is_to_remove_a_file_that_is_no_result(tmp_path: Path) -> None:
    h5py.File(tmp_path / "cut.h5", "w", libver="latest").create_dataset(
        "x", data=np.zeros(1000)
    ).file.close()
    (tmp_path / "cut.h5").write_bytes((tmp_path / "cut.h5").read_bytes()[:600])
    (tmp_path / "text.h5").write_text("a letter")
    h5py.File(tmp_path / "foreign.h5", "w").close()
    ResultFile("empty", meta={"experiment_file": "/mine/empty.toml"}).write(tmp_path)
    said = {}
    for name in ("cut", "text", "foreign", "empty"):
        with pytest.raises(ResultError) as error:
            load.load(tmp_path / f"{name}.h5")
        said[name] = str(error.value)
    assert (
        "delete" not in " ".join(said.values())
        and "move it away" not in said["text"] + said["foreign"]
    )
    assert (
        "damaged: " in said["cut"]
        and ": take an intact copy" in said["cut"]
        and "with 'hausbench run /mine/empty.toml'" in said["empty"]
    )


def test_the_remedy_is_make_only_in_a_clone(tmp_path: Path) -> None:
    assert (
        remedy.measure("zhang2017_table3") == "'make zhang2017_table3'"
        and remedy.measure("mine", "/a/mine.toml") == "'hausbench run /a/mine.toml'"
    )
    assert (
        remedy.measure("zhang2017_table3", root=tmp_path) == "'hausbench run zhang2017_table3.toml'"
    )
    (tmp_path / "experiments").mkdir()  # an installed program has this folder
    (tmp_path / "experiments" / "zhang2017_table3.toml").touch()
    assert (
        remedy.measure("zhang2017_table3", "/a/zhang2017_table3.toml", tmp_path)
        == "'hausbench run zhang2017_table3'"
    )


def test_file_of_another_experiment(tmp_path: Path) -> None:
    file = ResultFile("one")
    file.case("naive", "x")
    file.write(tmp_path).rename(tmp_path / "two.h5")
    with pytest.raises(ResultError, match=r"two\.h5: has the experiment 'one', not 'two'"):
        load.load(tmp_path / "two.h5")


def test_no_cases(tmp_path: Path) -> None:
    with pytest.raises(ResultError, match="has no cases"):
        load.load(ResultFile("empty").write(tmp_path))


def test_paper_numbers_are_all_there() -> None:
    names = sorted(path.stem for path in load.REFERENCE.glob("*.toml"))
    assert {"zhang2017_table3", "sacht2024_table2"} <= set(names)
    for name in names:
        numbers = load.paper_numbers(name)
        assert {"paper", "table", "section", "unit", "machine", "row"} <= set(numbers), name
        values = [
            value
            for row in numbers["row"]
            for value in row.values()
            if isinstance(value, (int, float))
        ]
        assert values and min(values) > 0, name


def test_rows_are_those_of_one_profile(tmp_path: Path) -> None:
    file = ResultFile("two", meta={"profile": "paper"})
    file.case("naive", "x", [1.0, 2.0], lower=1.0, upper=1.0, profile="quick")
    file.case("scan", "x", [3.0, 4.0, 5.0], lower=1.0, upper=1.0, profile="paper,quick")
    file.case(
        "ohd",
        "x",
        [6.0],
        [(0.0, 0.0, np.inf), (6.0, 1.0, 1.0)],
        lower=1.0,
        upper=1.0,
        profile="paper",
        variant="seed=1",
    )
    file.ledger += [
        {"kind": "not_run", "subject": "a", "profile": "quick"},
        {"kind": "not_run", "subject": "b", "profile": "paper"},
    ]
    path = file.write(tmp_path)
    latest = load.load(path)  # the latest run had another profile
    assert list(latest.cases.label) == ["scan", "ohd"] and list(latest.names) == [
        "scan",
        "ohd(seed=1)",
    ]
    assert (
        list(latest.wall_seconds(0)) == list(load.load(path, "quick").wall_seconds(1))
        and len(latest.repeats_of(0)) == 3
    )
    assert latest.trace_of(1).seconds.tolist() == [0.0, 6.0]
    assert list(latest.ledger.subject) == ["b"]
    assert all(len(counts) == 2 for counts in latest.cases.counters.values())
    assert list(load.load(path, "quick").cases.label) == ["naive", "scan"]
    with pytest.raises(ResultError, match="no cases"):
        load.load(path, "none")


def every_dataset(path: Path) -> dict[str, int]:
    """Returns the file offset of each dataset that is stored contiguously, by name."""
    offsets: dict[str, int] = {}
    with h5py.File(path, "r") as file:
        file.visititems(
            lambda name, item: offsets.update({name: item.id.get_offset()})
            if isinstance(item, h5py.Dataset) and item.id.get_offset() is not None
            else None
        )
    return offsets


def test_a_flipped_bit_in_any_dataset_is_found(tmp_path: Path) -> None:
    file = ResultFile(
        "flipped",
        ledger=[{"kind": "not_run"}],
        fields=[{"name": "distance", "end": 1}],
        field_values=[0.5],
    )
    file.case(
        "naive", "x", [1.0, 2.0], [(0.0, 0.0, 1.0)], lower=0.25, upper=0.25, prepare_seconds=0.5
    )
    path = file.write(tmp_path)
    places, whole = every_dataset(path), path.read_bytes()
    assert len(places) > 100 and load.load(path).cases.upper[0] == 0.25
    for name, at in places.items():
        path.write_bytes(whole[:at] + bytes([whole[at] ^ 4]) + whole[at + 1 :])
        with pytest.raises(
            ResultError,
            match=r"flipped\.h5: damaged: some of its bytes .* move it away and measure again with 'hausbench run flipped\.toml'",
        ):
            load.load(path)
            pytest.fail(f"{name} was read")
    path.write_bytes(
        whole[:-2] + bytes([whole[-2] ^ 1]) + whole[-1:]
    )  # changes the last digit of the hash
    with pytest.raises(ResultError, match="damaged"):
        load.load(path)


def test_a_file_without_a_seal_is_read(tmp_path: Path) -> None:
    """If another program changes a sealed file, HDF5 drops the seal, which follows the data."""
    file = ResultFile("changed")
    file.case("naive", "x", [1.0], lower=0.25, upper=0.25)
    path = file.write(tmp_path)
    with h5py.File(path, "a") as opened:
        opened["cases/upper"][0] = 0.5
    assert load.load(path).cases.upper[0] == 0.5


def test_what_follows_the_data_is_their_seal_or_nothing(tmp_path: Path) -> None:
    file = ResultFile("s")
    file.case("guthe", "scene", [1.0])
    path = file.write(tmp_path)
    content = path.read_bytes()[:-73]
    path.write_bytes(content)
    seal = b"\nsha256 " + hashlib.sha256(content).hexdigest().encode() + b"\n"
    load.load(path)  # another program's change removes the seal
    for tail in (seal + b"\n", seal[:-1], seal.replace(b"sha", b"shb"), b"x" * 73):
        path.write_bytes(content + tail)
        with pytest.raises(ResultError, match="damaged"):
            load.load(path)
    path.write_bytes(content + seal)
    load.load(path)


@pytest.mark.parametrize(
    ("note", "shapes"),
    [
        ("an orange sampled twice stands in for the pears", "an orange sampled twice"),
        ("chess king and queen stand in for the cups", "chess king and queen"),
        ("cow, and a triceratops that stands in for the hippo", "a triceratops"),
        ("a dinosaur and a horse stand in", "a dinosaur and a horse"),
        ("two bunnies", ""),
        ("", ""),
    ],
)
def test_shapes_that_stand_in_are_read_from_notes(note: str, shapes: str) -> None:
    assert notes.stand_in(note) == shapes
