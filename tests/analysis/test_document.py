"""Tables fit on a page, their notes are short, and the papers' documents compile."""

from __future__ import annotations

import importlib
import re
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
import synthetic_stability
from synthetic import ResultFile
from test_comparable import FILES
from test_corpus import corpus

from analysis import document
from analysis.paper_page import papers
from analysis.shared import latex, table_width, tables, tex
from analysis.shared.load import load
from analysis.shared.stems import drawn_with, module_of
from analysis.shared.verdicts import HOLDS, Verdict

ALL: dict[str, Callable[[], ResultFile]] = {
    **FILES,
    "stability_matrix": lambda: synthetic_stability.large().file,
    "corpus": corpus,
}
LATEX = pytest.mark.skipif(shutil.which("pdflatex") is None, reason=document.WITHOUT_LATEX)


def table_of(
    columns: int, rows: int, cell: str = "12.3 [11.2, 13.4]", notes: int = 0
) -> tables.Table:
    header = ["solver", *[f"column {i}" for i in range(1, columns)]]
    body = [["cover (ours)", *[cell] * (columns - 1)] for _ in range(rows)]
    lines = [f"Note {i} has eight words in it, always." for i in range(notes)]
    verdicts = [Verdict("a is faster", HOLDS, "ratio 2")]
    return tables.Table("A caption.", header, body, lines, verdicts)


def words_below(text: str) -> int:
    """Counts the words of the notes in floats, and of those directly below tables that span
    pages."""
    match = re.search(
        r"\\parbox\{\\linewidth\}\{\\footnotesize (.*)\}$|^\\noindent\{\\footnotesize (.*)\\par\}$",
        text,
        re.MULTILINE,
    )
    return len((match[1] or match[2]).split()) if match else 0


def test_notes_and_claims_leave_the_float() -> None:
    text = latex.latex(table_of(4, 3, notes=40), "stem")
    inside, after = text.split(r"\end{table*}")
    assert words_below(text) == 120 and "Note 14" in inside and "Note 15" not in inside
    assert (
        "Note 39" in after
        and r"\item a is faster. Here it holds" in after
        and "a is faster" not in inside
    )


def test_markdown_has_claims_and_notes_under_headings() -> None:
    text = tables.markdown(table_of(2, 1, notes=1))
    assert (
        text.index("| cover (ours) |")
        < text.index("### Claims")
        < text.index("- Claim: a is faster")
        < text.index("### Notes")
        < text.index("- Note 0")
    )


@pytest.mark.parametrize(
    ("columns", "rows", "environment"),
    [
        (4, 5, r"\begin{table*}"),
        (4, 90, r"\begin{longtable}"),
        (9, 5, r"\begin{table*}"),
        (12, 5, r"\begin{sidewaystable*}"),
        (12, 80, r"\begin{landscape}"),
        (40, 3, r"\begin{table*}"),
    ],
)
def test_layout(columns: int, rows: int, environment: str) -> None:
    text = latex.latex(table_of(columns, rows), "stem")
    assert environment in text
    assert text.count(r"\bottomrule") == (
        1 if columns < 40 else len(table_width.layout(["x"] * 40, table_of(40, 3).rows, 1).blocks)
    ) and (columns < 40 or text.count(r"\bottomrule") > 1)


def test_the_blocks_of_a_long_table_count_as_one() -> None:
    text = latex.latex(table_of(40, 90), "stem")
    assert text.count(r"\begin{longtable}") == text.count(r"\addtocounter{table}{-1}") + 1 > 1


@pytest.mark.parametrize(
    ("text", "escaped"),
    [
        ("1/p\u0304", r"1/\={p}"),
        ("i\u0304x\u0304", r"\={\i}\={x}"),
        ("e\u0301", r"\'{e}"),
        ("\u0304", r"\texttt{U+0304}"),
        ("8\u0304 中", r"8\texttt{U+0304} \texttt{U+4E2D}"),
    ],
)
def test_an_accent_stands_over_its_letter(text: str, escaped: str) -> None:
    assert tex.tex_escape(text) == escaped


@pytest.fixture(scope="module")
def drawn(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Writes every table but no figures, because rendering takes most of the time."""
    folder = tmp_path_factory.mktemp("drawn")
    for make in ALL.values():
        results = load(make().write(folder))
        for stem in drawn_with(results.stem):
            replace(importlib.import_module(module_of(stem)).make(results), draw=None).save(
                results, folder, stem
            )
    return folder


def test_no_table_has_more_than_120_words_of_notes_in_its_float(drawn: Path) -> None:
    counts = {
        path.stem: words_below(path.read_text(encoding="utf-8"))
        for path in (drawn / "tables").glob("*.tex")
        if path.stem not in papers()
    }
    assert len(counts) > 25 and max(counts.values()) > 40
    assert [stem for stem, count in counts.items() if count > latex.NOTE_WORDS] == []


@LATEX
@pytest.mark.parametrize("paper", papers())
def test_documents_compile_and_nothing_is_wider_than_the_page(
    paper: str, drawn: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert document.main([paper, "--results", str(drawn), "--compile"]) == 0
    printed = capsys.readouterr().out.splitlines()
    assert printed == [
        str(drawn / "tables" / f"{paper}.tex"),
        str(drawn / "documents" / f"{paper}.pdf"),
    ] or not any((drawn / "tables" / f"{stem}.tex").exists() for stem in document.stems_of(paper))


@LATEX
@pytest.mark.parametrize(
    ("columns", "rows"), [(4, 5), (9, 90), (12, 5), (14, 30), (14, 80), (25, 20), (40, 60)]
)
def test_the_estimate_of_widths_is_on_the_safe_side(
    columns: int, rows: int, tmp_path: Path
) -> None:
    (tmp_path / "t.tex").write_text(
        document.PREAMBLE
        + r"\begin{document}"
        + latex.latex(table_of(columns, rows, "WMW mmm 12.3 [11.2, 13.4]", 20), "t")
        + r"\end{document}"
    )
    assert document.compiled(tmp_path / "t.tex", tmp_path)[1] == []


@LATEX
def test_what_is_too_wide_is_reported(tmp_path: Path) -> None:
    wide = r"\begin{table}\begin{tabular}{l}" + "m" * 90 + r"\end{tabular}\end{table}"
    (tmp_path / "t.tex").write_text(
        document.PREAMBLE + r"\begin{document}" + wide + r"\end{document}"
    )
    assert len(document.compiled(tmp_path / "t.tex", tmp_path)[1]) == 1
    (tmp_path / "t.tex").write_text(r"\nonsense")
    with pytest.raises(OSError, match="Undefined control sequence"):
        document.compiled(tmp_path / "t.tex", tmp_path)


def test_stems_in_the_order_of_the_paper() -> None:
    sacht = document.stems_of("sacht2024")
    assert (
        sacht.index("sacht2024_fig2")
        < sacht.index("sacht2024_fig10")
        < sacht.index("sacht2024_table1")
        < sacht.index("sacht2024_section52")
    )
    assert {"stability_matrix", "stability_error", "cliffs"} <= set(
        document.stems_of("hausbench")
    ) and "surfaces_gallery" in document.stems_of("shou2014")
    every = [stem for paper in papers() for stem in document.stems_of(paper)]
    assert len(every) == len(set(every))


def test_a_figure_has_a_caption_with_or_without_a_table(tmp_path: Path) -> None:
    for stem in ("overview", "claims", "zhang2017_fig8"):
        (tmp_path / "figures").mkdir(exist_ok=True)
        (tmp_path / "figures" / f"{stem}.pdf").write_bytes(b"")
    (tmp_path / "tables").mkdir()
    (tmp_path / "tables" / "zhang2017_fig8.md").write_text("**OHD by depth.**\n\n| x |\n")
    text = document.document("hausbench", tmp_path, tmp_path / "tables")
    assert (
        r"\includegraphics{../figures/overview.pdf}" in text
        and r"\caption{overview}" not in text
        and r"\caption{Measured / claimed" in text
    )
    assert r"\caption{OHD by depth.}" in document.document(
        "zhang2017", tmp_path, tmp_path / "tables"
    )
    (tmp_path / "figures" / "zhang2017_fig8.txt").write_text("(a) Seconds of OHD.\n")
    assert r"\caption{(a) Seconds of OHD.}" in document.document(
        "zhang2017", tmp_path, tmp_path / "tables"
    )
    assert document.document("tang2009", tmp_path, tmp_path / "tables") == ""


def test_without_latex_only_the_source_is_written(
    drawn: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(shutil, "which", lambda _: None)
    assert (
        document.main(["zhang2017", "--results", str(drawn), "--out", str(tmp_path), "--compile"])
        == 0
    )
    assert capsys.readouterr().out.splitlines() == [
        f"documents: not compiled: {document.WITHOUT_LATEX}",
        str(tmp_path / "tables" / "zhang2017.tex"),
    ]
