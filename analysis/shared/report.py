"""The output of an experiment (a figure, a table and its numbers in full), and the code that writes
the files."""

from __future__ import annotations

import io
import os
import textwrap
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Final

import matplotlib.pyplot as plt
from matplotlib.transforms import Bbox

from analysis.shared import claims, missing, sizes, style, table_files, tables, unlike
from analysis.shared.drawable import drawable, make_drawable
from analysis.shared.notes import clock_note, side_by_side_line, unchecked_line
from analysis.shared.panels import add_letters
from analysis.shared.printable import printable
from analysis.shared.results import Results


FORMATS: Final = ("pdf", "png")
NO_TIMES: Final = "no times"  # in place of a clock, for a table without times
CAPTION: Final = ".txt"  # <out>/figures/<stem>.txt holds the caption of a figure


@dataclass(frozen=True)
class Report:
    draw: Callable[
        [], Any
    ] | None  # returns the figure, or several by name; None: no figure. Called after the tables are written
    table: tables.Table | None = None  # without a table the figure has no notes
    records: Sequence[tables.Record] = ()  # rows of the CSV
    key: str = ""  # meaning of the letters in the figure; printed below it
    clock: str = ""  # a sentence on the clock of the table's times if it differs from the clock of the rows; or NO_TIMES
    caption: str = ""  # caption of the figure: what each panel and mark shows; default: the caption of the table
    parts: Mapping[str, Sequence[int]] = field(
        default_factory=dict
    )  # for several figures: the rows that each shows; default: all

    def printed(self, results: Results, stem: str = "") -> tables.Table | None:
        """Returns the table with notes on its clock and on rows that ran at the same time as
        others.

        A verdict becomes 'not tested' if its claim is about larger sizes or missing rows, or if its
        kept verdict is about other shapes.
        """
        if self.table is None:
            return None
        stem = stem or results.stem
        judged = unlike.judged(
            missing.judged(sizes.tested(self.table.verdicts, results, stem), results), results, stem
        )
        notes = [self.clock or clock_note(results)] if self.clock != NO_TIMES else []
        return replace(
            self.table,
            verdicts=judged,
            notes=[
                *self.table.notes,
                *notes,
                *filter(None, [side_by_side_line(results), missing_line(results)]),
            ],
        )

    def save(
        self, results: Results, out: Path, stem: str = "", formats: Sequence[str] = FORMATS
    ) -> list[Path]:
        """Writes tables, verdicts, figures and caption, and returns their paths. `stem` defaults to
        the stem of the results.

        The files are <out>/tables/<stem>.csv, .md and .tex, <stem>.verdicts.json,
        <out>/figures/<stem>.pdf and .png (or the chosen formats), and <stem>.txt if the figure has
        a caption of its own. An old figure is deleted if the report has none.
        """
        stem = stem or results.stem
        table, paths = self.printed(results, stem), list[Path]()
        if table is not None:
            paths = table_files.save(table, self.records, out, stem)
            if table.verdicts:
                verdicts = claims.records(
                    table.verdicts, stem, str(results.meta.get("profile", ""))
                )
                paths.append(
                    table_files.save_json(verdicts, out / "tables" / f"{stem}{claims.SUFFIX}")
                )
        if not self.draw:
            delete_figures(out, stem, formats)
            return [*paths, *save_caption("", out, stem)]
        title = str(results.meta.get("title", "")) if table is None else table.caption
        footnotes = {name: self._footnote(results, rows) for name, rows in self.parts.items()}
        figures = save_figures(
            self.draw(),
            out,
            stem,
            self.caption or title,
            self._footnote(results),
            formats,
            footnotes,
        )
        return [*paths, *figures, *save_caption(self.caption, out, stem)]

    def _footnote(self, results: Results, rows: Sequence[int] | None = None) -> str:
        """Returns the text below a figure: the key of its letters, unchecked bounds, and rows that
        ran at the same time as others."""
        texts = [self.key, unchecked_line(results, rows)] if self.table is not None else []
        return " ".join(
            filter(
                None,
                [
                    *[f"{text}." for text in texts if text],
                    side_by_side_line(results),
                    missing_line(results),
                ],
            )
        )


def missing_line(results: Results) -> str:
    """Says which rows are missing, and how to get them; empty if none is."""
    text = missing.note(results)
    return f"{text}." if text else ""


def save_caption(caption: str, out: Path, stem: str) -> list[Path]:
    """Writes the caption of a figure for analysis.document. Deletes the file if the caption is
    empty."""
    path = out / "figures" / f"{stem}{CAPTION}"
    if not caption:
        path.unlink(missing_ok=True)
        return []
    path.parent.mkdir(parents=True, exist_ok=True)
    table_files.write_whole(path, printable(caption) + "\n")
    return [path]


def delete_figures(out: Path, stem: str, formats: Sequence[str]) -> None:
    for suffix in formats:
        (out / "figures" / f"{stem}.{suffix}").unlink(missing_ok=True)


def save_png(figure: Any, path: Path) -> Path:
    """Writes a figure as a PNG without metadata, so that the same numbers give the same bytes."""
    make_drawable(figure)
    drawn = io.BytesIO()
    figure.savefig(drawn, format="png", metadata={"Software": None})
    table_files.write_whole(path, drawn.getvalue())
    plt.close(figure)
    return path


def save_figures(
    drawn: Any,
    out: Path,
    stem: str,
    caption: str,
    footnote: str,
    formats: Sequence[str],
    footnotes: Mapping[str, str] | None = None,
) -> list[Path]:
    """Writes a single figure as <stem>, or a dict of figures as <stem>-<name>.

    For a dict, an old <stem> is deleted, and `footnotes[name]` replaces `footnote`.
    """
    if not isinstance(drawn, dict):
        return save_figure(drawn, out, stem, caption, footnote, formats)
    delete_figures(out, stem, formats)
    return [
        path
        for name, figure in drawn.items()
        for path in save_figure(
            figure, out, f"{stem}-{name}", caption, (footnotes or {}).get(name, footnote), formats
        )
    ]


def _whole(figure: Any) -> Any:
    """Returns the bounding box of the figure and of text that sticks out, for savefig()."""
    box, pad, width = (
        figure.get_tightbbox(figure.canvas.get_renderer()),
        0.05,
        figure.get_figwidth(),
    )
    right = box.x1 + pad if box.x1 > width else width
    return Bbox(
        [[min(0, box.x0), min(0, box.y0) - pad], [right, max(figure.get_figheight(), box.y1)]]
    )


def save_figure(
    figure: Any,
    out: Path,
    stem: str,
    caption: str = "",
    footnote: str = "",
    formats: Sequence[str] = FORMATS,
) -> list[Path]:
    """Writes <out>/figures/<stem>.pdf and .png, or the chosen formats. A footnote goes below
    everything and makes the figure higher.

    The files contain no dates, so that the same numbers give the same bytes.
    """
    add_letters(figure)
    make_drawable(figure)
    if footnote:
        figure.draw_without_rendering()  # fixes the layout before the footnote is added, so that the panels are not made smaller for it
        figure.set_layout_engine("none")
        figure.text(
            0.5,
            -0.01,
            "\n".join(textwrap.wrap(drawable(footnote), int(20 * figure.get_figwidth()))),
            ha="center",
            va="top",
            fontsize=6.5,
            color=style.GREY,
        )
    folder = out / "figures"
    folder.mkdir(parents=True, exist_ok=True)
    paths = [folder / f"{stem}.{suffix}" for suffix in formats]
    before = os.environ.get("SOURCE_DATE_EPOCH")
    os.environ["SOURCE_DATE_EPOCH"] = "0"  # subset fonts inside a PDF carry a date too
    try:
        metadata: dict[str, dict[str, Any]] = {
            "pdf": {"Title": stem, "Subject": caption, "CreationDate": None},
            "svg": {"Title": stem, "Description": caption, "Date": None},
            "png": {"Title": stem, "Description": caption, "Software": None},
        }
        for path in paths:
            drawn = (
                io.BytesIO()
            )  # in memory first, because matplotlib's PDF writer fails to close on a full disk
            with plt.rc_context(
                {"figure.constrained_layout.use": False} if footnote else {}
            ):  # savefig() would turn it on again
                figure.savefig(
                    drawn,
                    format=path.suffix[1:],
                    metadata=metadata[path.suffix[1:]],
                    bbox_inches=_whole(figure) if footnote else None,
                )
            table_files.write_whole(path, drawn.getvalue())
    finally:
        if before is None:
            del os.environ["SOURCE_DATE_EPOCH"]
        else:
            os.environ["SOURCE_DATE_EPOCH"] = before
    plt.close(figure)
    return paths
