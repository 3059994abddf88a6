"""Rows of other shapes than the kept ones are counted, and neither compared with kept numbers nor
kept."""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from synthetic import ResultFile

from analysis import check_reference, opposite, paper_profile
from analysis.shared import claims, missing, sizes, table_files, tables, unlike
from analysis.shared.load import REFERENCE, load
from analysis.shared.report import NO_TIMES, Report
from analysis.shared.results import ResultError, Results
from analysis.shared.verdicts import FAILS, HOLDS, UNTESTED, Verdict

DATASETS = Path(__file__).resolve().parents[2] / "datasets"
Make = Callable[..., Results]


@pytest.fixture
def make(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Make:
    """Returns a function that writes a result of the scenes x and y, whose targets are derived.
    `changed` names targets that another CGAL derived."""
    monkeypatch.setattr(unlike, "LIST", tmp_path / "derived.sha256")
    monkeypatch.setattr(check_reference, "FOLDER", tmp_path / "counts")
    monkeypatch.setattr(sizes, "REFERENCE", tmp_path)

    def result(*changed: str, cgal: str = "5.5.1", **columns: Any) -> Results:
        file = ResultFile(
            "scaling_meshes", meta={"libraries": json.dumps({"CGAL": cgal}), "profile": "paper"}
        )
        for solver in ("guthe", "cover"):
            for scene in "xy":
                given: dict[str, Any] = {"lower": 0.5, "upper": 1.0, "counters": {"node_visits": 7}}
                file.case(
                    solver, scene, [1.0], **given | (columns if f"{scene}/B" in changed else {})
                )
        for case in file.cases:
            if case["target"] in changed:
                case["identity"] = "0" * 8 + case["identity"][8:]
        for model in file.models:
            model["source"] = "derived" if model["name"].endswith("B") else "debian"
            if model["name"] in changed:
                model["sha256"] = "f" * 64
        return load(file.write(tmp_path))

    return result


def test_the_list_has_the_derived_models_of_what_was_kept(make: Make) -> None:
    assert not unlike.rows(make()) and unlike.same_cgal(make())  # nothing is kept
    unlike.keep(make())
    first, *lines = unlike.LIST.read_text().splitlines()
    assert first == "# CGAL 5.5.1" and [line[66:] for line in lines] == ["x/B", "y/B"]
    assert all(re.match("[0-9a-f]{64}  ", line) for line in lines)
    assert unlike.same_cgal(make()) and not unlike.same_cgal(make(cgal="6.0.1"))
    unlike.keep(make("x/B"))
    assert unlike.LIST.read_text().splitlines() == [first, *lines]  # only new models are added


def test_rows_of_other_shapes_are_counted(make: Make) -> None:
    unlike.keep(make())
    assert not unlike.rows(make()) and unlike.sentence(make(), []) == ""
    results = make("x/B", lower=0.25)
    assert unlike.rows(results) == [0, 2]
    assert unlike.sentence(results, [0, 2]) == "2 of 4 rows are not of the kept shapes: x/B"
    assert unlike.rows(missing.without(results)) == [0, 2]
    results = make(cgal="6.0.1")
    assert not unlike.rows(results)  # another CGAL derived the same
    unlike.LIST.write_text("".join(line for line in unlike.LIST.open() if "y/B" not in line))
    assert unlike.models(results) == ["y/B"] and not unlike.rows(
        make()
    )  # of a model that is not listed, nothing is known


def verdicts_of(results: Results) -> list[Verdict]:
    claim = [claims.of("hausbench", "bounds_hold", place) for place in ("", "x", "y")]
    table = tables.Table(
        "caption",
        ["a"],
        [["1"]],
        verdicts=[Verdict(sentence, FAILS, "so for 1 of 2") for sentence in claim],
    )
    printed = Report(None, table, clock=NO_TIMES).printed(results, STEM)
    assert printed
    return list(printed.verdicts)


STEM = claims.entries("hausbench")["bounds_hold"].stems[0]


def test_claims_about_them_are_not_judged_beside_kept_verdicts(make: Make, tmp_path: Path) -> None:
    unlike.keep(make())
    before = [replace(verdict, outcome=HOLDS) for verdict in verdicts_of(make())]
    assert [verdict.outcome for verdict in verdicts_of(make("x/B"))] == [
        FAILS
    ] * 3  # no verdict is kept: these claims are of this run alone
    kept = table_files.save_json(
        claims.records(before, STEM, "paper"), tmp_path / f"kept{claims.SUFFIX}"
    )
    assert [verdict.outcome for verdict in verdicts_of(make())] == [FAILS] * 3
    now = verdicts_of(make("x/B"))
    assert [verdict.outcome for verdict in now] == [UNTESTED, UNTESTED, FAILS]
    assert (
        now[0].evidence
        == "2 of 4 rows are not of the kept shapes: x/B; of those: holds, see results/reference"
    )
    assert len(opposite.opposites(claims.records(now, STEM, "paper"), claims.read(kept))) == 1


def test_kept_rows_are_not_compared_with_them(make: Make) -> None:
    check_reference.keep("s", make())
    assert check_reference.check("s", make()) == (
        "s: bounds and counted work equal the reference: 4 of 4 rows",
        True,
    )
    said = "2 rows not compared: 2 of 4 rows are not of the kept shapes: x/B"
    of_x: list[dict[str, Any]] = [{"lower": 0.25}, {}]
    for columns in of_x:
        assert check_reference.check("s", make("x/B", cgal="6.0.1", **columns)) == (
            f"s: bounds and counted work equal the reference: 2 of 2 rows; {said}",
            True,
        )
    whole = check_reference.check("s", make("x/B", "y/B", cgal="6.0.1", lower=0.25))
    assert whole == (
        "s: 4 rows not compared: 4 of 4 rows are not of the kept shapes: x/B, y/B",
        True,
    )
    # The same CGAL should derive the same shapes.
    assert check_reference.check("s", make("x/B")) == (
        f"s: bounds and counted work equal the reference: 2 of 2 rows; {said}",
        False,
    )
    assert not check_reference.check("s", make("x/B", "y/B"))[1]


def test_a_row_that_failed_on_another_shape_does_not_differ(make: Make) -> None:
    check_reference.keep("s", make())
    text, equal = check_reference.check("s", make("x/B", cgal="6.0.1", status="failed"))
    assert equal and "2 of 2 rows" in text


def test_they_are_not_kept(make: Make, capsys: pytest.CaptureFixture[str]) -> None:
    check_reference.keep("s", make())
    results = make("x/B")
    for work in (check_reference.check, check_reference.keep):
        work("s", make())
    with pytest.raises(ResultError, match="cannot be kept: 2 of 4 rows are not of the kept shapes"):
        check_reference.keep("s", results)
    with pytest.raises(ResultError, match="cannot be kept: 2 of 4 rows are not of the kept shapes"):
        paper_profile.check(results)
    make("x/B")
    assert (
        check_reference.main(["scaling_meshes", "--keep", "--results", str(results.path.parent)])
        == 2
    )
    assert "cannot be kept" in capsys.readouterr().err


def test_the_list_of_the_project() -> None:
    first, *lines = (REFERENCE / "derived.sha256").read_text().splitlines()
    models = [line[66:] for line in lines]
    assert (
        first == "# CGAL 5.5.1"
        and models == sorted(set(models))
        and all(re.fullmatch(r"[0-9a-f]{64}  \S+", line) for line in lines)
    )
    manifest, corpus = (
        tomllib.loads((DATASETS / f"{name}.toml").read_text()) for name in ("manifest", "corpus")
    )
    by_cgal = {
        name
        for name, table in manifest["model"].items()
        if table.get("operation") in ("simplify", "remesh")
    }
    assert by_cgal <= set(models)
    of_corpus = [*corpus["model"], *corpus["whole"], *corpus["manifest"], *corpus["whole_manifest"]]
    for ending in ("half", "remeshed"):
        assert sum(f"{name}_{ending}" in models for name in of_corpus) > 600


def test_experiments_name_their_models_apart() -> None:
    """The list has one shape of each name."""
    shapes: dict[str, dict[str, Any]] = {}
    for file in sorted((DATASETS.parent / "experiments").rglob("*.toml")):
        for name, table in tomllib.loads(file.read_text()).get("model", {}).items():
            assert shapes.setdefault(name, table | {"note": ""}) == table | {
                "note": ""
            }, f"{name} in {file}"
    assert len(shapes) > 50
