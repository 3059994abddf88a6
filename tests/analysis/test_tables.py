"""Tests how numbers are printed, and the CSV, Markdown and LaTeX forms of a table."""

import csv
import math
from pathlib import Path

import pytest

from analysis.shared import tables
from analysis.shared.statistics import NO_DATA, Estimate, exact, median


@pytest.mark.parametrize(("x", "text"), [
    (0.0, "0"), (1.0, "1.00"), (0.2254, "0.225"), (9.999, "10.0"), (99.96, "100"), (47.282, "47.3"), (92576.0, "92576"),
    (0.000123456, "0.000123"), (1.6e-8, "1.60e-8"), (-2.5, "-2.50"), (math.inf, "inf"), (math.nan, "—"),
    (5e12, "5.00e12")])
def test_number(x: float, text: str) -> None:
    assert tables.number(x) == text


def test_estimate_and_ratio() -> None:
    clear, open_ = Estimate(2.0, 1.5, 2.5, 9, 0.96), Estimate(1.1, 0.9, 1.3, 9, 0.96)
    assert tables.estimate(clear) == "2.00 [1.50, 2.50]" == tables.ratio(clear)
    assert tables.ratio(open_) == "1.10 [0.900, 1.30] (not separated)"
    assert tables.ratio(Estimate(2.0, 1.5, 2.5, 2, 0.5)) == "2.00 [1.50, 2.50] (not judged, n = 2)"
    assert tables.ratio(exact(2.0)) == "2.00" and tables.ratio(exact(1.0)) == "1.00 (not separated)"
    assert tables.estimate(median([0.5]), 1e3) == "500"
    assert tables.estimate(NO_DATA) == tables.ratio(NO_DATA) == "—"


def test_unit() -> None:
    assert tables.time_unit([0.01, 0.02, 5.0]) == ("ms", 1000.0)
    assert tables.time_unit([0.01, 0.2, math.nan, 5.0]) == ("s", 1.0)


def test_coverage_note() -> None:
    nine = tables.coverage_note([median(range(9))])
    assert "n = 9 rounds" in nine and "(at least 95 %)" in nine and "brackets (at least 95 %)" in tables.coverage_note([median([float(i) for i in range(8)])])
    assert "at least 75 %" in tables.coverage_note([median(range(9)), median(range(3))])
    assert "no interval" in tables.coverage_note([median([1.0])])


def test_forms(tmp_path: Path) -> None:
    table = tables.Table("Caption_1 & more", ["a|b", "x"], [["p_1", "50 %"], ["[q]", "—"]], ["A note: 3 × 4."],
                         rules={1})
    records: list[tables.Record] = [{"name": "p,1", "value": 0.1 + 0.2}, {"name": "q", "value": math.nan}]
    paths = tables.save(table, records, tmp_path, "stem")
    assert [path.name for path in paths] == ["stem.csv", "stem.md", "stem.tex"]
    rows = list(csv.DictReader(paths[0].open()))
    assert float(rows[0]["value"]) == 0.1 + 0.2 and rows[0]["name"] == "p,1" and rows[1]["value"] == ""
    assert "| a\\|b | x |" in paths[1].read_text() and "- A note: 3 × 4." in paths[1].read_text()
    tex = paths[2].read_text()
    for expected in (r"\caption{Caption\_1 \& more}", r"p\_1 & 50 \% \\", r"{[q]} & --- \\", r"\addlinespace",
                     r"$\times$",                     r"\toprule", r"\label{tab:stem}"):
        assert expected in tex
    assert "—" not in tex and "×" not in tex


def test_a_table_is_whole_or_the_old_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "t.md"
    tables.write_whole(path, "old")

    def half(self: Path, content: bytes) -> None:
        with self.open("wb") as out:
            out.write(content[:1])
        raise OSError("the disk is full")

    monkeypatch.setattr(Path, "write_bytes", half)
    with pytest.raises(OSError, match="full"):
        tables.write_whole(path, "new")
    assert path.read_text() == "old" and [file.name for file in tmp_path.iterdir()] == ["t.md"]
