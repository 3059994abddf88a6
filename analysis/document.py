"""Writes a LaTeX document with every figure and table of a paper: `python3 -m analysis.document
[PAPER ...] [--results DIR] [--out DIR] [--compile]`.

Writes <out>/tables/PAPER.tex from the files that `python3 -m analysis` wrote to <results>/figures
and <results>/tables. PAPER `hausbench` has the experiments that belong to no paper. --compile makes
<out>/documents/PAPER.pdf with pdflatex.
"""

from __future__ import annotations

import argparse
import os
import re
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Sequence
from pathlib import Path
from typing import Final

from analysis import forest, ledger, which_solver
from analysis.paper_page import TITLES, papers
from analysis.shared import claims, gate, table_files
from analysis.shared.report import CAPTION
from analysis.shared.stems import ANALYSIS, drawn_with, has_script
from analysis.shared.tex import tex_escape

# Defines adjustbox to do nothing, so that LaTeX reports tables that are too wide instead of
# shrinking them.
PREAMBLE: Final = r"""\documentclass[letterpaper]{article}
\usepackage[textwidth=7.16in,textheight=9.2in]{geometry}
\usepackage{textcomp,graphicx,booktabs,array,longtable,rotating,pdflscape,placeins,needspace}
\newenvironment{adjustbox}[1]{}{}
\setcounter{topnumber}{9}\setcounter{totalnumber}{9}\renewcommand{\topfraction}{1}\renewcommand{\textfraction}{0}\renewcommand{\floatpagefraction}{0.6}
\makeatletter\def\fps@table{!htbp}\makeatother
\setlength{\parindent}{0pt}
"""
# Titles of what is drawn from the results of other experiments.
DRAWN: Final = {
    "scaling_billion": "Point sets: the cost of a billion points each, forecast",
    "statistics_programs": "Statistics of the distance: MeshLab and CloudCompare",
    "stability_error": "Stiff and extreme cases: error and gap against severity",
    "stability_time": "Stiff and extreme cases: time and counted work against severity",
    "which_solver": "Which certified solver is fastest",
    "claims": "Ratios of all claims: measured against claimed",
    "ledger": "Work left out, and the time that this saved",
}
OF_ALL: Final = {
    "which_solver": which_solver.CAPTION,
    "claims": forest.CAPTION,
    "ledger": ledger.CAPTION,
}  # figures about all experiments
WITHOUT_LATEX: Final = "pdflatex is not installed (on Debian: texlive-latex-extra)"
_OVERFULL: Final = re.compile(
    r"^Overfull \\hbox \((\d+\.\d+)pt too wide\).*$|^LaTeX Warning: Float too large for page by (\d+\.\d+)pt.*$",
    re.MULTILINE,
)


def _place(stem: str) -> tuple[int, int, str]:
    """Returns a sort key for stems: figures by number, then tables, then sections, then others."""
    match = re.search(r"_(fig|table|section)(\d+)$", stem)
    return (
        (["fig", "table", "section"].index(match[1]), int(match[2]), stem)
        if match
        else (3, 0, stem)
    )


def stems_of(paper: str) -> list[str]:
    """Returns the stems of a paper in order, each followed by the stems that draw its results.

    For `hausbench`, returns the stems that belong to no paper.
    """
    other_papers = {name for name in papers() if name != claims.OWN}
    measured = [
        file.stem
        for file in sorted((ANALYSIS.parent / "experiments").rglob("*.toml"))
        if (
            file.parent.name == paper
            if paper != claims.OWN
            else file.parent.name not in other_papers
        )
    ]
    ordered = measured if paper == claims.OWN else sorted(measured, key=_place)
    return [
        *dict.fromkeys(drawn for stem in ordered if has_script(stem) for drawn in drawn_with(stem)),
        *(OF_ALL if paper == claims.OWN else ()),
    ]


def title_of(stem: str) -> str:
    """Returns the title of an experiment from its file, or of what is drawn from the results of
    others; without one, the stem."""
    for file in (ANALYSIS.parent / "experiments").rglob(f"{stem}.toml"):
        return str(tomllib.loads(file.read_text(encoding="utf-8")).get("title", stem))
    return DRAWN.get(stem, stem)


def caption_of(folder: Path, stem: str) -> str:
    """Returns the caption of a figure: its own or, if it has none, the caption of its table or the
    title of its experiment."""
    if gate.is_plain(caption := folder / "figures" / f"{stem}{CAPTION}"):
        return caption.read_text(encoding="utf-8").strip()
    table = folder / "tables" / f"{stem}.md"
    if gate.is_plain(table):
        return table.read_text(encoding="utf-8").partition("\n")[0].strip("*")
    return OF_ALL.get(stem) or title_of(stem)


def figures_of(folder: Path, stem: str, suffix: str) -> list[tuple[Path, str]]:
    """Returns the files of the figures of a stem, <stem> and then its parts <stem>-<part>, each
    with its caption."""
    there = sorted((folder / "figures").glob(f"{stem}.{suffix}")) + sorted(
        (folder / "figures").glob(f"{stem}-*.{suffix}")
    )
    files = [file for file in there if gate.is_plain(file)]
    parts = [file.stem.removeprefix(stem).lstrip("-") for file in files]
    return [
        (file, caption_of(folder, stem) + (f" Part: {part}." if part else ""))
        for file, part in zip(files, parts)
    ]


def _stem(folder: Path, stem: str, out: Path) -> list[str]:
    """Returns LaTeX lines with those figures and tables of a stem that exist."""
    lines = []
    for figure, caption in figures_of(folder, stem, "pdf"):
        lines += [
            r"\begin{figure}[!htbp]\centering",
            rf"\includegraphics{{{os.path.relpath(figure, out)}}}",
            rf"\caption{{{tex_escape(caption)}}}",
            r"\end{figure}",
        ]
    if (table := folder / "tables" / f"{stem}.tex").exists():
        lines += [rf"\input{{{os.path.relpath(table, out)}}}"]
    return (
        [r"\FloatBarrier\Needspace{0.4\textheight}", rf"\subsection*{{{tex_escape(stem)}}}", *lines]
        if lines
        else []
    )


def document(paper: str, folder: Path, out: Path) -> str:
    """Returns the LaTeX document of a paper; empty if none of its figures and tables exist."""
    parts = [line for stem in stems_of(paper) for line in _stem(folder, stem, out)][
        1:
    ]  # the first stem needs no barrier below the title
    if parts and (page := folder / "tables" / f"{paper}_claims.tex").exists():
        parts += [r"\clearpage", rf"\input{{{os.path.relpath(page, out)}}}"]
    title = rf"\section*{{{tex_escape(TITLES.get(paper, paper))}}}"
    return (
        "\n".join([PREAMBLE + r"\begin{document}", title, *parts, r"\end{document}", ""])
        if parts
        else ""
    )


def too_wide(log: str, allowed: float = 5.0) -> list[str]:
    """Returns the lines of a LaTeX log about boxes and floats that exceed the page by more than
    `allowed` points."""
    return [match[0] for match in _OVERFULL.finditer(log) if float(match[1] or match[2]) > allowed]


def compiled(source: Path, out: Path) -> tuple[Path, list[str]]:
    """Runs pdflatex three times, until references and column widths are final. Raises OSError if
    LaTeX fails.

    Returns the PDF and the lines of too_wide().
    """
    out.mkdir(parents=True, exist_ok=True)
    command = [
        "pdflatex",
        "-halt-on-error",
        "-interaction=nonstopmode",
        f"-output-directory={out.resolve()}",
        source.name,
    ]
    for _ in range(3):
        done = subprocess.run(
            command,
            cwd=source.parent,
            capture_output=True,
            encoding="utf-8",
            errors="replace",
            check=False,
            env={**os.environ, "max_print_line": "1000"},
        )
        if done.returncode:
            at = done.stdout.find("\n!")
            raise OSError(f"{source}: pdflatex failed: {done.stdout[at:at + 400].strip()}")
    return out / f"{source.stem}.pdf", too_wide(
        (out / f"{source.stem}.log").read_text(encoding="utf-8", errors="replace")
    )


def write(paper: str, folder: Path, out: Path) -> Path | None:
    """Writes <out>/tables/PAPER.tex. Returns None if the paper has no figures or tables yet."""
    path = out / "tables" / f"{paper}.tex"
    path.parent.mkdir(parents=True, exist_ok=True)
    text = document(paper, folder, path.parent)
    if text:
        table_files.write_whole(path, text)
    return path if text else None


def main(arguments: Sequence[str] | None = None) -> int:
    """Returns the exit code: 2 if a document cannot be written or compiled."""
    parser = argparse.ArgumentParser(
        prog="analysis.document",
        description="Makes a document with all figures and tables of a paper.",
    )
    parser.add_argument(
        "papers", nargs="*", metavar="PAPER", help=f"default: all of {', '.join(papers())}"
    )
    parser.add_argument(
        "--results",
        type=Path,
        default=Path("results"),
        help="folder that has figures/ and tables/ (default: results)",
    )
    parser.add_argument(
        "--out", type=Path, help="documents go to its tables/ (default: the folder of --results)"
    )
    parser.add_argument(
        "--compile",
        action="store_true",
        help="make OUT/documents/PAPER.pdf with pdflatex, if it is installed",
    )
    chosen, code = parser.parse_args(arguments), 0
    if unknown := sorted(set(chosen.papers) - set(papers())):
        parser.error(f"unknown paper '{unknown[0]}': one of {', '.join(papers())}")
    out = chosen.out or chosen.results
    latex = shutil.which("pdflatex") is not None
    if chosen.compile and not latex:
        print(f"documents: not compiled: {WITHOUT_LATEX}")
    for paper in chosen.papers or papers():
        try:
            if not (path := write(paper, chosen.results, out)):
                continue
            pdf, wide = (
                compiled(path, out / "documents") if chosen.compile and latex else (None, [])
            )
            print(*filter(None, [path, pdf, *wide]), sep="\n")
        except OSError as problem:
            print(problem, file=sys.stderr)
            code = 2
    return code


if __name__ == "__main__":
    sys.exit(main())
