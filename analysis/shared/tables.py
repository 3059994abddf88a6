"""Writes tables: CSV with all digits; rounded numbers in Markdown and LaTeX."""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from decimal import ROUND_CEILING, ROUND_FLOOR, ROUND_HALF_EVEN, Context, Decimal
from pathlib import Path
from typing import TYPE_CHECKING

from analysis.shared.latex import latex
from analysis.shared.printable import printable
from analysis.shared.statistics import CONFIDENCE, Estimate

if TYPE_CHECKING:
    from analysis.shared.verdicts import Verdict

NOTHING = "—"  # not measured, or unknown
Record = dict[str, object]


@dataclass
class Table:
    """A table to print, with notes and verdicts below it. The rows in `rules` begin a new group, set off by some space."""

    caption: str
    header: Sequence[str]
    rows: list[list[str]] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    verdicts: Sequence[Verdict] = ()
    left: int = 1  # the first columns, aligned left; the others hold numbers
    rules: set[int] = field(default_factory=set)
    parts: Sequence[int] = ()  # columns at which LaTeX may split a table that is too wide; see table_width.layout()

    def lines_below(self) -> list[str]:
        """Returns the lines below the table: verdicts, then notes."""
        return [*[verdict.line() for verdict in self.verdicts], *self.notes]


def _rounded(x: float | Decimal, digits: int, rounding: str, times: float = 1.0, over: float = 1.0) -> str:
    """Formats x * times / over, rounded once; `times` and `over` are positive."""
    if math.isnan(x) or math.isnan(over):
        return NOTHING
    if math.isinf(x):
        return "inf" if x > 0 else "-inf"
    if x == 0:
        return "0"
    context = Context(prec=800, rounding=rounding)
    value = context.divide(context.multiply(x if isinstance(x, Decimal) else Decimal(float(x)), Decimal(float(times))), Decimal(float(over)))
    exponent = value.adjusted()
    if exponent < -4 or exponent > 9:
        mantissa, power = f"{Context(prec=digits, rounding=rounding).plus(value):.{digits - 1}e}".split("e")
        return f"{mantissa}e{int(power)}"
    decimals = max(0, digits - 1 - exponent)
    rounded = value.quantize(Decimal(1).scaleb(-decimals), context=context)
    return f"{rounded:.{max(0, decimals - 1) if rounded.adjusted() > exponent else decimals}f}"


def number(x: float, digits: int = 3) -> str:
    """Formats x with `digits` significant digits; below 1e10, digits before the point are not rounded. NaN becomes '—'."""
    return _rounded(x, digits, ROUND_HALF_EVEN)


def at_least(low: float | Decimal, digits: int = 3, times: float = 1.0, over: float = 1.0) -> str:
    """Formats the lower bound low * times / over like number(), rounded down, so that it is still a bound."""
    return _rounded(low, digits, ROUND_FLOOR, times, over)


def at_most(high: float | Decimal, digits: int = 3, times: float = 1.0, over: float = 1.0) -> str:
    """Formats the upper bound high * times / over like number(), rounded up, so that it is still a bound."""
    return _rounded(high, digits, ROUND_CEILING, times, over)


def bounds(low: float | Decimal, high: float | Decimal, digits: int = 3, times: float = 1.0, over: float = 1.0, limit: float = math.nan,
           form: str = "[{}, {}]") -> str:
    """Formats an interval, rounded outward: '[1.50, 2.51]'. If it excludes `limit`, it gets as many digits as show this."""
    def excludes(least: float, most: float) -> bool:
        return least > limit or most < limit

    if math.isnan(low) or math.isnan(high):
        return NOTHING
    ends = at_least(low, digits, times, over), at_most(high, digits, times, over)
    if digits < 20 and excludes(float(low) * times / over, float(high) * times / over) and not excludes(*map(float, ends)):
        return bounds(low, high, digits + 1, times, over, limit, form)
    return form.format(*ends)


def value(low: float, high: float, digits: int = 3, over: float = 1.0) -> str:
    """Formats a value that lies in [low, high], over `over`: rounded, if both ends round to the same text; otherwise as the interval."""
    ends = {_rounded(end, digits, ROUND_HALF_EVEN, over=over) for end in (low, high)}
    return ends.pop() if len(ends) == 1 else bounds(low, high, digits, over=over)


def estimate(x: Estimate, scale: float = 1.0, limit: float = math.nan) -> str:
    """Formats an estimate and its interval: '2.10 [2.05, 2.31]'; '2.10' without an interval, '—' without data. The ends are statistics
    and no bounds, so they are rounded to nearest; if the interval excludes `limit`, they get as many digits as show this.
    """
    if x.n == 0:
        return NOTHING
    if not x.has_interval or x.n == 1:  # a single time, or a count, which is exact
        return number(x.value * scale)
    for digits in range(3, 17):
        low, high = number(x.low * scale, digits), number(x.high * scale, digits)
        if not (x.low * scale > limit >= float(low) or x.high * scale < limit <= float(high)):
            break
    return f"{number(x.value * scale)} [{low}, {high}]"


def ends(low: float, high: float) -> str:
    """Formats the interval of a statistic, such as an exponent, with two decimals, rounded to nearest."""
    return f"[{low:.2f}, {high:.2f}]"


def ratio(x: Estimate) -> str:
    """Formats a ratio like estimate(), and adds '(not separated)' if its interval contains 1, or '(not judged, n = 3)' if n is too
    small for 95 %.
    """
    if x.n == 0:
        return NOTHING
    return estimate(x, limit=1.0) if x.separated else f"{estimate(x)} ({f'not judged, n = {x.n}' if x.coverage < CONFIDENCE else 'not separated'})"


def time_unit(seconds: Iterable[float]) -> tuple[str, float]:
    """Chooses the unit for a table of times: ('ms', 1000) if their median is below 0.1 s, else ('s', 1)."""
    known = sorted(x for x in seconds if math.isfinite(x))
    return ("ms", 1000.0) if known and known[len(known) // 2] < 0.1 else ("s", 1.0)


def coverage_note(estimates: Iterable[Estimate]) -> str:
    """Returns the note that explains the intervals in brackets, with the number of rounds."""
    known = [x for x in estimates if x.n]
    if not known:
        return "No times."
    counts, least = sorted({x.n for x in known}), min((x.coverage for x in known if x.has_interval), default=0.0)
    n = f"n = {counts[0]}" if len(counts) == 1 else f"n = {counts[0]} to {counts[-1]}"
    if counts[-1] == 1:
        return f"Single times ({n}): no interval."
    percent = "at least 95 %" if least >= 0.95 else f"at least 95 % if n allows, otherwise at least {math.floor(least * 100)} %"
    return (f"Medians of {n} rounds (fresh processes; repeats within one count once), "
            f"with order-statistic intervals in brackets ({percent}).")


def seconds(x: Estimate) -> Record:
    """Returns the CSV fields of a time in seconds."""
    return {"n": x.n, "median_seconds": x.value, "low_seconds": x.low, "high_seconds": x.high}


def markdown(table: Table) -> str:
    """Returns the table in Markdown: caption, cells, then claims and notes, each under a heading."""
    def line(cells: Sequence[str]) -> str:
        return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"

    marks = ["---" if i < table.left else "---:" for i in range(len(table.header))]
    parts = [f"**{table.caption}**", "", line(table.header), "|" + "|".join(marks) + "|", *map(line, table.rows), ""]
    for heading, lines in (("Claims", [verdict.line() for verdict in table.verdicts]), ("Notes", table.notes)):
        parts += [f"### {heading}", "", *[f"- {line}" for line in lines], ""] if lines else []
    return "\n".join(parts)


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def comma_separated(records: Sequence[Record]) -> str:
    """Returns the records as CSV. Floating-point numbers have all digits; NaN becomes an empty field. A text that a spreadsheet would take for
    a formula gets an apostrophe.
    """
    def cell(value: object) -> object:
        if isinstance(value, str) and value.startswith(("=", "+", "-", "@")) and not _is_number(value):
            return "'" + value
        return "" if isinstance(value, float) and math.isnan(value) else value

    fields = list(dict.fromkeys(key for record in records for key in record))
    text = io.StringIO()
    writer = csv.DictWriter(text, fields, restval="", lineterminator="\n")
    writer.writeheader()
    writer.writerows({key: cell(value) for key, value in record.items()} for record in records)
    return text.getvalue()


def save_json(records: Sequence[Record], path: Path) -> Path:
    """Writes records as a JSON list, one record per line."""
    lines = ",\n".join(json.dumps(one, ensure_ascii=False) for one in records)
    write_whole(path, f"[\n{lines}\n]\n" if records else "[]\n")
    return path


def read_json(path: Path) -> list[Record]:
    """Reads what save_json() wrote. Raises ValueError if the file is damaged."""
    found = json.loads(path.read_text(encoding="utf-8"))
    if not isinstance(found, list) or not all(isinstance(one, dict) for one in found):
        raise ValueError(f"{path}: not a list of records: write it again with 'python3 -m analysis'")
    return found


def write_whole(path: Path, content: str | bytes) -> None:
    """Writes the file under another name first, so that a reader sees either the old content or the new."""
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
