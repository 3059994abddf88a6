"""Writes a table in LaTeX: a float with caption, cells and at most NOTE_WORDS words of notes; the
other notes and the claims follow as text, because a long float would not fit a page.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from typing import Final

from analysis.shared import tex
from analysis.shared.table_width import GAP, Block, Layout, layout, unbroken
from analysis.shared.tables import Table

NOTE_WORDS: Final = 120
NEEDS: Final = r"% needs \usepackage{booktabs,array,longtable,rotating,pdflscape,adjustbox}"


def split_notes(notes: Sequence[str], words: int = NOTE_WORDS) -> tuple[list[str], list[str]]:
    """Splits the notes into those that together have at most `words` words, and the others. Keeps
    the order."""
    inside: list[str] = []
    after: list[str] = []
    for note in notes:
        count = len(note.split())
        (inside if count <= words else after).append(note)
        words -= count if count <= words else 0
    return inside, after


def _sentences(notes: Iterable[str]) -> str:
    """Joins the notes into one paragraph, with a full stop after a note that has no final
    punctuation."""
    return " ".join(
        tex.tex_escape(
            note.strip() if note.rstrip().endswith((".", "!", "?")) else f"{note.strip()}."
        )
        for note in notes
    )


def _row(cells: Sequence[str]) -> str:
    # LaTeX would read a '[' or '*' at the start of a row as an argument of the \\ before it.
    escaped = [tex.tex_escape(unbroken(cell)) for cell in cells]
    return (
        " & ".join("{" + cell + "}" if cell.startswith(("[", "*")) else cell for cell in escaped)
        + r" \\"
    )


def _columns(block: Block, left: int) -> str:
    def column(i: int, width: float | None) -> str:
        if width is None:
            return "l" if i < left else "r"
        return (
            rf">{{\{'raggedright' if i < left else 'raggedleft'}\arraybackslash}}p{{{width:.1f}pt}}"
        )

    return "@{}" + "".join(column(i, width) for i, width in block.items()) + "@{}"


def _body(table: Table, block: Block) -> list[str]:
    """Returns the rows of one block of columns, without rows that have only 'n/a' in the columns
    that no other block has."""
    columns = [k for k in block if k >= (table.parts[0] if table.parts else table.left)]
    lines: list[str] = []
    for i, row in enumerate(table.rows):
        if i in table.rules and lines:
            lines.append(r"\addlinespace")
        if not columns or any(row[k] != "n/a" for k in columns):
            lines.append(_row([row[k] for k in block]))
    return lines


def _tabular(table: Table, block: Block) -> list[str]:
    head = _row([table.header[k] for k in block])
    return [
        r"\begin{adjustbox}{max width=\linewidth}",
        rf"\begin{{tabular}}{{{_columns(block, table.left)}}}",
        r"\toprule",
        head,
        r"\midrule",
        *_body(table, block),
        r"\bottomrule",
        r"\end{tabular}",
        r"\end{adjustbox}",
    ]


def _longtable(table: Table, block: Block, caption: str) -> list[str]:
    head = _row([table.header[k] for k in block])
    return [
        rf"\begin{{longtable}}{{{_columns(block, table.left)}}}",
        *([caption + r"\\"] if caption else []),
        r"\toprule",
        head,
        r"\midrule\endfirsthead",
        r"\toprule",
        head,
        r"\midrule\endhead",
        r"\bottomrule\endfoot",
        *_body(table, block),
        r"\end{longtable}",
    ]


def _float(table: Table, chosen: Layout, caption: str, notes: Sequence[str]) -> list[str]:
    kind = "sidewaystable*" if chosen.sideways else "table*"
    lines = [
        rf"\begin{{{kind}}}",
        r"\centering",
        caption,
        rf"\{chosen.size}\setlength{{\tabcolsep}}{{{GAP:g}pt}}%",
    ]
    for number, block in enumerate(chosen.blocks):
        if number:
            lines.append(r"\par\medskip")
        lines += _tabular(table, block)
    if notes:
        lines += [r"\par\smallskip", rf"\parbox{{\linewidth}}{{\footnotesize {_sentences(notes)}}}"]
    return [*lines, rf"\end{{{kind}}}"]


def _pages(table: Table, chosen: Layout, caption: str, notes: Sequence[str]) -> list[str]:
    """Returns a table longer than a page as a longtable, which unlike a float may break between
    pages."""
    lines = [r"\begin{landscape}"] if chosen.sideways else []
    lines.append(
        rf"{{\{chosen.size}\setlength{{\tabcolsep}}{{{GAP:g}pt}}\setlength{{\LTcapwidth}}{{\linewidth}}%"
    )
    for number, block in enumerate(chosen.blocks):
        if number:  # every longtable increments the number of tables
            lines.append(r"\addtocounter{table}{-1}")
        lines += _longtable(table, block, "" if number else caption)
    # The notes come after the landscape pages, where they share a page with the text that follows.
    # The parbox keeps them on one page.
    return [
        *lines,
        "}",
        *([r"\end{landscape}"] if chosen.sideways else []),
        *(
            [rf"\noindent\parbox{{\linewidth}}{{\footnotesize {_sentences(notes)}}}"]
            if notes
            else []
        ),
    ]


def _list(heading: str, items: Iterable[str]) -> list[str]:
    """Returns a heading and a list. LaTeX will not break a page after the heading or within an
    item."""
    return [
        r"\begingroup\footnotesize\interlinepenalty=10000\csname @beginparpenalty\endcsname=10000\relax",
        rf"\par\medskip\noindent\textbf{{{heading}}}",
        r"\begin{itemize}\setlength{\itemsep}{0pt}\setlength{\parskip}{0pt}\setlength{\parsep}{0pt}",
        *[rf"\item {item}" for item in items],
        r"\end{itemize}\endgroup",
    ]


def _after(table: Table, label: str, notes: Sequence[str]) -> list[str]:
    """Returns the text after the table: claims, and the notes that do not fit into the float."""
    where, lines = rf"Table~\ref{{{label}}}", list[str]()
    if table.verdicts:
        lines += _list(
            f"Claims tested in {where}.",
            [tex.tex_escape(verdict.line().removeprefix("Claim: ")) for verdict in table.verdicts],
        )
    if notes:
        lines += _list(f"Notes to {where}.", [_sentences([note]) for note in notes])
    return lines


def latex(table: Table, stem: str) -> str:
    """Returns the LaTeX of a table and of the text that follows it, for pages of 7.16 x 9.2 inches.

    A table too wide for an upright page is printed sideways or in several blocks.
    """
    label = "tab:" + re.sub("[^A-Za-z0-9_.-]", "-", stem)
    whole = " ".join(
        [
            table.caption,
            *table.header,
            *table.lines_below(),
            *(cell for row in table.rows for cell in row),
        ]
    )
    spelt = list(filter(None, [tex.noted(tex.tex_escape(whole))]))
    inside, after = split_notes(table.notes, NOTE_WORDS - sum(len(note.split()) for note in spelt))
    chosen = layout(table.header, table.rows, table.left, table.parts)
    caption = rf"\caption{{{tex.tex_escape(table.caption)}}}\label{{{label}}}"
    set_ = _pages if chosen.long else _float
    return "\n".join(
        [NEEDS, *set_(table, chosen, caption, [*inside, *spelt]), *_after(table, label, after), ""]
    )
