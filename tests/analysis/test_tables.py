"""Tests how numbers are printed, and the CSV, Markdown and LaTeX forms of a table."""

import ast
import csv
import math
import random
from fractions import Fraction
from pathlib import Path

import pytest

from analysis.shared import numerals, table_files, tables
from analysis.shared.estimates import NO_DATA, Estimate, exact, median
from analysis.shared.verdicts import above_one


@pytest.mark.parametrize(
    ("x", "text"),
    [
        (0.0, "0"),
        (1.0, "1.00"),
        (0.2254, "0.225"),
        (9.999, "10.0"),
        (99.96, "100"),
        (47.282, "47.3"),
        (92576.0, "92576"),
        (0.000123456, "0.000123"),
        (1.6e-8, "1.60e-8"),
        (-2.5, "-2.50"),
        (math.inf, "inf"),
        (math.nan, "—"),
        (5e12, "5.00e12"),
    ],
)
def test_number(x: float, text: str) -> None:
    assert numerals.number(x) == text


def test_shortened_bounds_hold() -> None:
    """Whatever the digits and the unit, what is printed contains the exact interval, and is at most
    a unit of the last digit wider at each end."""
    rng = random.Random(1)
    for _ in range(2000):
        low = rng.uniform(-1, 1) * 10.0 ** rng.randint(-12, 12)
        high, digits, times, over = (
            low + abs(low) * rng.choice([0, 1e-16, 1e-9, 0.1]),
            rng.randint(1, 12),
            rng.choice([1.0, 100.0, 1e3]),
            rng.uniform(1e-3, 1e3),
        )
        exact = [Fraction(end) * Fraction(times) / Fraction(over) for end in (low, high)]
        shown = [
            Fraction(end)
            for end in numerals.bounds(low, high, digits, times, over)[1:-1].split(", ")
        ]
        assert shown[0] <= exact[0] <= exact[1] <= shown[1]
        assert all(
            abs(a - b) <= abs(b) * Fraction(10) ** (1 - digits) for a, b in zip(shown, exact)
        )
    assert (
        numerals.bounds(9.996, 99.96) == "[9.99, 100]"
        and numerals.bounds(0.25, 0.5) == "[0.250, 0.500]"
        and numerals.bounds(0, math.inf) == "[0, inf]"
    )
    assert (
        numerals.bounds(1.6e-8, 92576.4) == "[1.60e-8, 92577]"
        and numerals.bounds(math.nan, 1) == "—"
    )


def test_an_interval_that_excludes_a_limit_shows_it() -> None:
    assert (
        numerals.bounds(4, 5 - 2**-17, limit=5) == "[4.000000, 4.999993]"
        and numerals.bounds(5 + 2**-30, 6, limit=5) == "[5.0000000009, 6.0000000000]"
    )
    assert (
        numerals.bounds(4.75, 5.25, limit=5) == "[4.75, 5.25]"
        and numerals.bounds(4.5, 5, limit=5) == "[4.50, 5.00]"
    )
    barely = Estimate(1.2, 1.0004, 1.5, 9, 0.96)
    assert (
        numerals.ratio(barely) == "1.20 [1.0004, 1.5000]"
        and "[1.0004," in above_one("it is faster", barely).evidence
    )


def test_a_value_is_rounded_only_if_its_interval_agrees() -> None:
    assert (
        numerals.value(0.12341, 0.12349) == "0.123"
        and numerals.value(0.12341, 0.12351) == "[0.123, 0.124]"
    )
    assert (
        numerals.value(0.5, 0.5, over=3.0) == "0.167" and numerals.value(math.nan, math.nan) == "—"
    )


def names_in(node: ast.AST) -> set[str]:
    """Returns the names in an expression; none for a width or a middle."""
    if isinstance(node, ast.BinOp) and any(
        isinstance(part, (ast.Add, ast.Sub)) for part in ast.walk(node)
    ):
        return set()
    return {
        part.attr if isinstance(part, ast.Attribute) else part.id
        for part in ast.walk(node)
        if isinstance(part, (ast.Attribute, ast.Name))
    }


def test_no_bound_is_rounded_to_nearest() -> None:
    """Bounds are printed with at_least(), at_most() and bounds(), never with number() or a format;
    estimate() is about statistics."""
    wrong = []
    for file in (Path(__file__).resolve().parents[2] / "analysis").rglob("*.py"):
        if file.name == "numerals.py":
            continue
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            shown = (
                node.value
                if isinstance(node, ast.FormattedValue)
                and node.format_spec
                and "." in ast.unparse(node.format_spec)
                else node.args[0]
                if isinstance(node, ast.Call)
                and node.args
                and getattr(node.func, "attr", getattr(node.func, "id", "")) == "number"
                else None
            )
            if shown and names_in(shown) & {"lower", "upper", "low", "high", "at_least", "at_most"}:
                wrong.append(f"{file.name}:{shown.lineno}: {ast.unparse(shown)}")
    assert not wrong


def test_estimate_and_ratio() -> None:
    clear, open_ = Estimate(2.0, 1.5, 2.5, 9, 0.96), Estimate(1.1, 0.9, 1.3, 9, 0.96)
    assert numerals.estimate(clear) == "2.00 [1.50, 2.50]" == numerals.ratio(clear)
    assert numerals.ratio(open_) == "1.10 [0.900, 1.30] (not separated)"
    assert (
        numerals.ratio(Estimate(2.0, 1.5, 2.5, 2, 0.5)) == "2.00 [1.50, 2.50] (not judged, n = 2)"
    )
    assert (
        numerals.ratio(exact(2.0)) == "2.00"
        and numerals.ratio(exact(1.0)) == "1.00 (not separated)"
    )
    assert numerals.estimate(median([0.5]), 1e3) == "500"
    assert numerals.estimate(NO_DATA) == numerals.ratio(NO_DATA) == "—"


def test_unit() -> None:
    assert numerals.time_unit([0.01, 0.02, 5.0]) == ("ms", 1000.0)
    assert numerals.time_unit([0.01, 0.2, math.nan, 5.0]) == ("s", 1.0)


def test_coverage_note() -> None:
    nine = tables.coverage_note([median(range(9))])
    assert (
        "n = 9 rounds" in nine
        and "(at least 95 %)" in nine
        and "brackets (at least 95 %)"
        in tables.coverage_note([median([float(i) for i in range(8)])])
    )
    assert "at least 75 %" in tables.coverage_note([median(range(9)), median(range(3))])
    assert "no interval" in tables.coverage_note([median([1.0])])


def test_forms(tmp_path: Path) -> None:
    table = tables.Table(
        "Caption_1 & more",
        ["a|b", "x"],
        [["p_1", "50 %"], ["[q]", "—"]],
        ["A note: 3 × 4."],
        rules={1},
    )
    records: list[tables.Record] = [
        {"name": "p,1", "value": 0.1 + 0.2},
        {"name": "q", "value": math.nan},
    ]
    paths = table_files.save(table, records, tmp_path, "stem")
    assert [path.name for path in paths] == ["stem.csv", "stem.md", "stem.tex"]
    rows = list(csv.DictReader(paths[0].open()))
    assert (
        float(rows[0]["value"]) == 0.1 + 0.2 and rows[0]["name"] == "p,1" and rows[1]["value"] == ""
    )
    assert "| a\\|b | x |" in paths[1].read_text() and "- A note: 3 × 4." in paths[1].read_text()
    tex = paths[2].read_text()
    for expected in (
        r"\caption{Caption\_1 \& more}",
        r"p\_1 & 50 \% \\",
        r"{[q]} & --- \\",
        r"\addlinespace",
        r"$\times$",
        r"\toprule",
        r"\label{tab:stem}",
    ):
        assert expected in tex
    assert "—" not in tex and "×" not in tex


def test_a_table_is_whole_or_the_old_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "t.md"
    table_files.write_whole(path, "old")

    def half(self: Path, content: bytes) -> None:
        with self.open("wb") as out:
            out.write(content[:1])
        raise OSError("the disk is full")

    monkeypatch.setattr(Path, "write_bytes", half)
    with pytest.raises(OSError, match="full"):
        table_files.write_whole(path, "new")
    assert path.read_text() == "old" and [file.name for file in tmp_path.iterdir()] == ["t.md"]
