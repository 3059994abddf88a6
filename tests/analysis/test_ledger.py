"""Tests the summary of the ledgers, which record the work that runs left out."""

from __future__ import annotations

from pathlib import Path

import pytest
from synthetic import ResultFile

from analysis import ledger


def result(stem: str, solve: float = 2.0, upper: float = 1.0) -> ResultFile:
    file = ResultFile(stem)
    file.case(
        "guthe",
        "x",
        [solve] * 3,
        lower=1.0,
        upper=upper,
        identity="abc",
        prepare=[0.5] * 3,
        first=[solve] * 3,
    )
    return file


def entry(kind: str, left_out: str, reason: str, seconds: float) -> dict[str, object]:
    return {
        "kind": kind,
        "subject": "guthe on x",
        "what": left_out,
        "reason": reason,
        "count": 1,
        "seconds_saved": seconds,
        "profile": "quick",
    }


def test_entries_are_added_up(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = result("a")
    file.ledger += [
        entry("not_run", "coarser tolerances", "the trace has them", 3.0),
        entry("not_prepared", "source BVH", "not needed", float("nan")),
        entry("not_prepared", "target BVH", "not needed", float("nan")),
        entry("reference", "one for each scene", "held against", -0.25),
    ]
    file.write(tmp_path)
    result("b").write(tmp_path)
    stems = ledger.stems_in(tmp_path)
    assert [stem.name for stem in stems] == ["a", "b"]
    assert (
        stems[0].seconds_saved == 3.0
        and stems[1].seconds_saved == 0.0
        and stems[0].run == pytest.approx(stems[1].run + 0.25)
    )
    assert stems[1].run >= 12.0  # three first answers and three repeats of 2 s each
    assert ledger.line(stems).startswith(
        "left out: 3 entries in the ledgers of 2 results, 3 s saved, "
    )
    rows = {row[0]: row[1:] for row in ledger.table(stems).rows}
    assert rows["structures that the scene does not need"] == ["not needed", "2", "not measured"]
    assert rows["tolerances read off the trace of a finer run"] == [
        "the trace has them",
        "1",
        "3.00",
    ]
    assert ledger.main(["--results", str(tmp_path)]) == 0
    assert capsys.readouterr().out.splitlines()[-1].startswith("left out: 3 entries")
    for name in (
        "figures/ledger.pdf",
        "figures/ledger.png",
        "tables/ledger.csv",
        "tables/ledger.md",
        "tables/ledger.tex",
    ):
        assert (tmp_path / name).stat().st_size > 0


@pytest.mark.parametrize("upper,same", [(1.0, 1), (1.5, 0)])
def test_a_run_that_left_nothing_out_is_its_proof(tmp_path: Path, upper: float, same: int) -> None:
    result("a").write(tmp_path)
    whole = result("a", upper=upper)
    whole.write(tmp_path / "there")
    (tmp_path / "there" / "a.h5").rename(tmp_path / "a.everything.h5")
    (stem,) = ledger.stems_in(tmp_path)
    assert stem.proof == f"{same} of 1 answers are the same with nothing left out"
    assert any(stem.proof in note for note in ledger.table([stem]).notes)


def test_a_saving_that_was_not_measured_is_not_a_saving_of_0(tmp_path: Path) -> None:
    file = result("a")
    file.ledger += [
        entry("not_prepared", "source BVH", "not needed", float("nan")),
        entry("not_prepared", "target BVH", "not needed", 2.0),
        entry("not_run", "case", "points only", float("nan")),
    ]
    file.write(tmp_path)
    assert [row[-1] for row in ledger.table(ledger.stems_in(tmp_path)).rows] == [
        "2.00 (1 not measured)",
        "not measured",
    ]
    assert ledger.main(["--results", str(tmp_path)]) == 0
    assert (tmp_path / "tables" / "ledger.csv").read_text(encoding="utf-8").splitlines()[1:] == [
        "a,13.5,not_prepared,2,1,2.0",
        "a,13.5,not_run,1,1,",
    ]


def test_no_results_is_said(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "broken.h5").write_bytes(b"nothing")
    assert ledger.main(["--results", str(tmp_path)]) == 2
    assert "make experiments" in capsys.readouterr().err
