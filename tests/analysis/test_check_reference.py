"""Compares a run's bounds and counted work with results/reference."""

from __future__ import annotations

from pathlib import Path

import pytest
from synthetic import ResultFile

from analysis import check_reference


def sweep(lower: float = 0.5, visits: int = 7, timeout: bool = False) -> ResultFile:
    file = ResultFile("sweep")
    for k, scene in enumerate("xy"):
        file.case(
            "guthe",
            scene,
            [1.0],
            lower=lower if scene == "x" else 0.25,
            upper=1.0,
            counters={"node_visits": visits + k, "point_distances": 2**60 + k},
        )
    file.case("guthe", "z", [1.0], status="timeout" if timeout else "ok", lower=0.1, upper=0.2)
    return file


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(check_reference, "FOLDER", tmp_path / "counts")
    return tmp_path


def run(folder: Path, file: ResultFile, *more: str) -> int:
    file.write(folder)
    return check_reference.main(["sweep", "--results", str(folder), *more])


def test_equal_rows_are_counted(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(folder, sweep()) == 0 and "none of the 0 rows" in capsys.readouterr().out
    assert run(folder, sweep(), "--keep") == 0
    assert (
        run(folder, sweep()) == 0 and "equal the reference: 3 of 3 rows" in capsys.readouterr().out
    )
    assert run(folder, sweep(timeout=True)) == 0 and "2 of 2 rows" in capsys.readouterr().out
    text = (folder / "counts" / "sweep.csv").read_text()
    (folder / "counts" / "sweep.csv").write_text(
        text.replace("\n", "\n0")
    )  # other identities, as if limits had changed
    assert (
        run(folder, sweep()) == 0 and "equal the reference: 3 of 3 rows" in capsys.readouterr().out
    )
    # The shape of x may have changed, so other bounds do not fail.
    assert run(folder, sweep(lower=0.75)) == 0 and "2 of 2 rows" in capsys.readouterr().out
    (folder / "counts" / "sweep.csv").write_text(
        text.replace("\n", "\n0").replace("guthe", "tang")
    )  # none of these cases was run
    assert run(folder, sweep()) == 1 and "none of the" in capsys.readouterr().out


def test_rows_with_another_identity_are_compared_beside_others(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A new parameter changes the identities of one solver alone."""
    run(folder, sweep(), "--keep")
    kept = folder / "counts" / "sweep.csv"
    header, first, *rest = kept.read_text().splitlines()
    kept.write_text("\n".join([header, "0" + first, *rest, ""]))
    assert run(folder, sweep()) == 0
    assert "equal the reference: 3 of 3 rows" in capsys.readouterr().out


def test_a_row_that_was_ok_and_fails_differs(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    run(folder, sweep(), "--keep")
    file = sweep()
    file.cases[-1]["status"] = "signal"
    assert run(folder, file) == 1 and "status ok -> signal" in capsys.readouterr().out


def test_a_different_bound_or_count_is_named(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    run(folder, sweep(), "--keep")
    assert run(folder, sweep(lower=0.5000000000000001)) == 1
    said = capsys.readouterr().out
    assert (
        "2 of 3 rows" in said
        and "guthe on x, pose 0" in said
        and "lower 0.5 -> 0.5000000000000001" in said
    )
    assert run(folder, sweep(visits=8)) == 1
    assert "node_visits 7 -> 8" in capsys.readouterr().out
    assert run(folder, sweep(visits=8), "--keep") == 0 and run(folder, sweep(visits=8)) == 0
    assert check_reference.main(["none", "--results", str(folder)]) == 2


def test_kept_rows_of_other_shapes_are_replaced(folder: Path) -> None:
    run(folder, sweep(), "--keep")
    file = sweep()
    for case in file.cases:
        case["identity"] = (
            "0" + case["identity"][1:] if case["identity"][0] != "0" else "1" + case["identity"][1:]
        )
    assert run(folder, file, "--keep") == 0 and len(check_reference.kept("sweep")) == 3


def test_missing_models_are_no_difference(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run(folder, sweep(), "--keep")
    file = ResultFile("sweep")
    file.case(
        "guthe", "x", status="skipped", reason="package p was not fetched: run `hausbench fetch`"
    )
    file.models = []
    assert (
        run(folder, file) == 0
        and "sweep: nothing compared: 1 of 1 rows are missing: package p was not fetched"
        in capsys.readouterr().out
    )


def test_the_sample_is_measured_again(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    run(folder, sweep(), "--keep")
    monkeypatch.setattr(check_reference, "SAMPLE", {"sweep": ["--scene", "x"]})
    monkeypatch.setattr(
        check_reference,
        "measure",
        lambda stem, options, into: (sweep(visits=8).write(into), into)[1],
    )
    assert (
        check_reference.main(["--sample"]) == 1 and "node_visits 7 -> 8" in capsys.readouterr().out
    )
    assert (
        check_reference.main(["--sample", "--keep"]) == 0
        and check_reference.main(["--again", "sweep"]) == 0
    )
    with pytest.raises(SystemExit):
        check_reference.main([])


def test_stems_of_the_sample_are_experiments_with_kept_rows() -> None:
    for stem in check_reference.SAMPLE:
        assert check_reference.kept(stem), stem
