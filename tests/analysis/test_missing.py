"""Rows whose models are missing: claims about them are not tested, and scripts draw the other
rows."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from stem_runner import STEMS, closed
from synthetic import NAN, ResultFile

from analysis import paper_profile
from analysis.__main__ import main
from analysis.shared import claims, missing, report
from analysis.shared.load import load
from analysis.shared.results import ResultError
from analysis.shared.verdicts import FAILS, HOLDS, UNTESTED, Verdict

REASON = "its origin 'bunny_small' is missing: package bunny was not fetched: run `hausbench fetch`"
LACKING = ": package bunny was not fetched: run `hausbench fetch`, then run 'make"


def take_away(file: ResultFile, *scenes: str) -> int:
    """Removes the target models of these scenes (default: all), as if they had not been fetched.
    Returns the number of rows affected."""
    lost = {case["target"] for case in file.cases if not scenes or case["scene"] in scenes}
    gone = {row for row, case in enumerate(file.cases) if {case["source"], case["target"]} & lost}
    for row in gone:
        case = file.cases[row]
        file.cases[row] = case | {
            "status": "skipped",
            "reason": REASON,
            "lower": NAN,
            "upper": NAN,
            "trace_begin": 0,
            "trace_end": 0,
            "witness_source": [NAN] * 3,
            "witness_target": [NAN] * 3,
            "source_elements": 0,
            "target_elements": 0,
            "source_diagonal": 0.0,
            "source_longest": 0.0,
            "solver_status": "",
            "extras": "{}",
            "facts": "{}",
            "certified": case["certified"],
            "prepare_seconds": NAN,
            "solve_seconds": NAN,
        }
    for name in ("answers", "repeats", "preparation", "fields"):
        setattr(file, name, [row for row in getattr(file, name) if row["case"] not in gone])
    file.models = [model for model in file.models if model["name"] not in lost]
    return len(gone)


@pytest.fixture
def draw(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> Callable[[ResultFile], str]:
    """Returns a function that analyses a result, expects exit code 0, and returns what is printed,
    tables included. No figure is rendered."""
    monkeypatch.setattr(report, "save_figure", closed)

    def run(file: ResultFile) -> str:
        file.write(tmp_path)
        assert (
            main([file.stem, "--results", str(tmp_path), "--out", str(tmp_path)]) == 0
        ), capsys.readouterr()
        said = capsys.readouterr()
        assert not said.err
        return said.out + "".join(path.read_text() for path in (tmp_path / "tables").glob("*.md"))

    return run


@pytest.mark.usefixtures("tetrahedra")
@pytest.mark.parametrize("stem", sorted(STEMS))
def test_every_script_draws_what_is_there(stem: str, draw: Callable[[ResultFile], str]) -> None:
    scenes = list(dict.fromkeys(case["scene"] for case in STEMS[stem]().cases))
    for gone in dict.fromkeys([scenes[0], scenes[-1]]):
        file = STEMS[stem]()
        count = take_away(file, gone)
        said = draw(file)
        assert f"{count:,} of {len(file.cases):,} rows are missing{LACKING}" in said


@pytest.mark.parametrize("stem", sorted(STEMS))
def test_a_result_without_any_row_is_no_failure(
    stem: str, draw: Callable[[ResultFile], str]
) -> None:
    file = STEMS[stem]()
    count = take_away(file)
    said = draw(file)
    assert (
        f"not drawn: {count:,} of {count:,} rows are missing{LACKING}" in said
        and "Claim" not in said
    )


def claim_of(place: str = "") -> claims.Claim:
    return claims.of("hausbench", "bounds_hold", place)


def test_a_claim_is_judged_on_the_whole_set_or_not_at_all(tmp_path: Path) -> None:
    file = ResultFile("sweep")
    for scene in ("x", "y", "y: one and another"):
        file.case("cover", scene, [1.0], lower=0.5, upper=0.5)
    verdicts = [
        Verdict(claim_of(place), outcome, "so for 2 of 3")
        for place in ("", "x", "y", "elsewhere")
        for outcome in (HOLDS, FAILS)
    ]
    assert missing.judged(verdicts, load(file.write(tmp_path))) == verdicts
    take_away(file, "y: one and another")
    results = load(file.write(tmp_path))
    for now in (results, missing.without(results)):
        judged = missing.judged(verdicts, now)
        assert [verdict.outcome for verdict in judged] == [
            UNTESTED,
            UNTESTED,
            HOLDS,
            FAILS,
            UNTESTED,
            UNTESTED,
            UNTESTED,
            UNTESTED,
        ]
        assert (
            judged[0].evidence
            == "1 of 3 rows are missing: package bunny was not fetched: run `hausbench fetch`, then run 'hausbench run sweep.toml'"
        )
    assert missing.without(results).scenes == ["x", "y"] and not missing.without(results).rows(
        status="skipped"
    )


def test_shapes_that_a_solver_does_not_take_are_no_missing_data(tmp_path: Path) -> None:
    file = ResultFile("sweep")
    file.case("cover", "x", [1.0], lower=0.5, upper=0.5)
    file.case("scan", "x", status="skipped", reason="solver 'scan' takes no meshes")
    file.case("external", "x", status="skipped", reason="program metro is missing")
    file.case("cgal", "x", status="not_built", reason="built without CGAL")
    results = load(file.write(tmp_path))
    assert (
        not missing.missing_rows(results)
        and missing.without(results) is results
        and not missing.note(results)
    )
    file.cases[-1] |= {"status": "skipped", "reason": "in another shard"}
    assert (
        missing.note(load(file.write(tmp_path)))
        == "1 of 4 rows are missing: in another shard: run 'hausbench run sweep.toml'"
    )


def test_times_and_traces_stay_with_their_rows(tmp_path: Path) -> None:
    file = ResultFile("sweep")
    for number, scene in enumerate("xyz"):
        file.case(
            "cover",
            scene,
            [1.0 + number] * 2,
            prepare=[0.25, 0.25],
            trace=[(0.1, float(number), 9.0)],
            lower=0.5,
            upper=0.5,
        )
    take_away(file, "y")
    results = missing.without(load(file.write(tmp_path)))
    assert [results.solve_by_round(row, "wall")[0] for row in range(2)] == [1.0, 3.0]
    assert [results.prepare_by_round(row)[0] for row in range(2)] == [0.25, 0.25]
    assert [results.trace_of(row).lower.tolist() for row in range(2)] == [[0.0], [2.0]]


def test_verdicts_on_a_part_are_not_kept(tmp_path: Path) -> None:
    file = STEMS["zhang2017_table3"]()
    file.meta["profile"] = "paper"
    paper_profile.check(load(file.write(tmp_path)))
    take_away(file, "c_rabbits")
    with pytest.raises(ResultError, match="cannot be kept: .* rows are missing"):
        paper_profile.check(load(file.write(tmp_path)))
