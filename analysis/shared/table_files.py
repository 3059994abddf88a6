"""Writes tables to files: CSV with all digits; rounded numbers in Markdown and LaTeX. Writes
records as JSON."""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Sequence
from pathlib import Path

from analysis.shared.latex import latex
from analysis.shared.printable import printable
from analysis.shared.tables import Record, Table, markdown


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def comma_separated(records: Sequence[Record]) -> str:
    """Returns the records as CSV. Floating-point numbers have all digits; NaN becomes an empty
    field. A text that a spreadsheet would take for a formula gets an apostrophe.
    """

    def cell(value: object) -> object:
        if (
            isinstance(value, str)
            and value.startswith(("=", "+", "-", "@"))
            and not _is_number(value)
        ):
            return "'" + value
        return "" if isinstance(value, float) and math.isnan(value) else value

    fields = list(dict.fromkeys(key for record in records for key in record))
    text = io.StringIO()
    writer = csv.DictWriter(text, fields, restval="", lineterminator="\n")
    writer.writeheader()
    for record in records:
        writer.writerow({key: cell(value) for key, value in record.items()})
    return text.getvalue()


def save_json(records: Sequence[Record], path: Path) -> Path:
    """Writes records as a JSON list, one record per line."""
    lines = ",\n".join(json.dumps(record, ensure_ascii=False) for record in records)
    write_whole(path, f"[\n{lines}\n]\n" if records else "[]\n")
    return path


def read_json(path: Path) -> list[Record]:
    """Reads what save_json() wrote. Raises ValueError if the file is damaged."""
    records = json.loads(path.read_text(encoding="utf-8"))
    if not isinstance(records, list) or not all(isinstance(record, dict) for record in records):
        raise ValueError(
            f"{path}: not a list of records: write it again with 'python3 -m analysis'"
        )
    return records


def write_whole(path: Path, content: str | bytes) -> None:
    """Writes the file under another name first, so that a reader sees either the old content or the
    new."""
    unfinished = path.with_name(path.name + ".unfinished")
    try:
        unfinished.write_bytes(content.encode("utf-8") if isinstance(content, str) else content)
        unfinished.replace(path)
    except OSError:
        unfinished.unlink(missing_ok=True)
        raise


def save(table: Table, records: Sequence[Record], out: Path, stem: str) -> list[Path]:
    """Writes <out>/tables/<stem>.csv, .md and .tex."""
    folder = out / "tables"
    folder.mkdir(parents=True, exist_ok=True)
    texts = {"csv": comma_separated(records), "md": markdown(table), "tex": latex(table, stem)}
    paths = []
    for suffix, text in texts.items():
        path = folder / f"{stem}.{suffix}"
        write_whole(path, printable(text, lines=True))
        paths.append(path)
    return paths
