"""Control characters in result files never reach a terminal or a viewer. A full disk gives an error
of one line."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path

import markupsafe
import pytest
from synthetic import ResultFile

from analysis.__main__ import main
from analysis.report import all_rows, pages
from analysis.shared import table_files, tables
from analysis.shared.printable import printable

HOSTILE = "\x1b]0;owned\x07\u202ename\u200b"


def test_controls_become_spaces_and_hidden_characters_question_marks() -> None:
    assert printable("a\x1b[2J\nb\u202ec\ufeff\u009b") == "a [2J b?c? "
    assert printable("a\nb\tc", lines=True) == "a\nb c"
    assert printable("h ≤ τ, α → β") == "h ≤ τ, α → β"


def test_pages_hold_no_hidden_characters() -> None:
    shown = (
        pages.environment()
        .from_string("{{ name }}{{ own }}")
        .render(name=HOSTILE + "<", own=markupsafe.Markup("<b>"))
    )
    assert shown == printable(HOSTILE) + "&lt;<b>"
    script = all_rows.as_script({"name": HOSTILE + "<\u2028"})
    assert (
        json.loads(script.replace("\\u003c", "<")) == {"name": "\x1b]0;owned\x07?name?< "}
        and script.isascii()
        and "<" not in script
    )


def test_no_cell_of_a_csv_is_a_formula() -> None:
    texts = ["=1+1", "+cmd|' /C calc'!A0", "@SUM(1)", "-2+3", "-2.5e3", "+inf", "a=b", ""]
    table = table_files.comma_separated([{"x": text} for text in texts])
    cells = [row["x"] for row in csv.DictReader(io.StringIO(table))]
    assert cells == [
        "'=1+1",
        "'+cmd|' /C calc'!A0",
        "'@SUM(1)",
        "'-2+3",
        "-2.5e3",
        "+inf",
        "a=b",
        "",
    ]


def test_errors_and_tables_hold_no_escapes(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = ResultFile("zhang2017_fig8", meta={"stem": HOSTILE})
    file.case("nohd", "s", [1.0])
    file.write(tmp_path)
    assert main(["zhang2017_fig8", "--results", str(tmp_path), "--out", str(tmp_path)]) == 2
    said = capsys.readouterr().err
    assert "name" in said and all(c == "\n" or c.isprintable() for c in said)
    for path in table_files.save(
        tables.Table(HOSTILE, ["a"], [[HOSTILE]]), [{"a": HOSTILE}], tmp_path, "t"
    ):
        assert all(c == "\n" or c.isprintable() for c in path.read_text(encoding="utf-8"))


def test_a_full_disk_is_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    file = ResultFile("zhang2017_fig8")
    for size in (1000, 2000):
        for depth in (4, 5, 6):
            file.case(
                "nohd",
                f"{size}",
                [1.0] * 6,
                options={"depth": depth},
                variant=f"depth={depth}",
                source_elements=size,
                target_elements=size,
            )
    file.write(tmp_path)

    def full(path: Path, content: bytes) -> int:
        raise OSError(28, "No space left on device", str(path))

    monkeypatch.setattr(Path, "write_bytes", full)
    assert main(["zhang2017_fig8", "--results", str(tmp_path), "--out", str(tmp_path)]) == 2
    lines = capsys.readouterr().err.strip().splitlines()
    assert (
        len(lines) == 1
        and "zhang2017_fig8: cannot be drawn" in lines[0]
        and "make room" in lines[0]
    )
