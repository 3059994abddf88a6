"""Generates analysis/shared/columns.py, and the tables in results/README.md and
docs/experiments.md: `python3 -m analysis.schema`.

Their contents come from the program (`hausbench list columns`, `list keys`). A test fails if they
are out of date. Nothing else in analysis/ runs the program.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any, Final


ROOT: Final = Path(__file__).resolve().parents[1]
README: Final = ROOT / "results" / "README.md"
EXPERIMENTS: Final = ROOT / "docs" / "experiments.md"
MODULE: Final = ROOT / "analysis" / "shared" / "columns.py"
TYPES: Final = {"text": "Texts", "real": "Floats", "integer": "Ints"}
HEAD: Final = '''"""The columns of result files, as analysis/shared/load.py reads them. Written by `python3 -m
analysis.schema`: do not edit."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

Texts = npt.NDArray[Any]  # of str
Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Counters = dict[str, npt.NDArray[np.uint64]]
'''

Groups = dict[str, list[dict[str, Any]]]


def program() -> Path:
    """Returns the path of the program: HAUSBENCH_PROGRAM, or else what `make build` builds."""
    return Path(os.environ.get("HAUSBENCH_PROGRAM", ROOT / "build" / "release" / "hausbench"))


def listed(*options: str) -> Any:
    """Returns the parsed JSON output of `hausbench list`."""
    done = subprocess.run(
        [program(), "list", *options], cwd=ROOT, capture_output=True, text=True, check=True
    )
    return json.loads(done.stdout)


def columns() -> Groups:
    groups: Groups = listed("columns")
    return groups


def module(groups: Groups) -> str:
    """Returns the text of columns.py: one dataclass per group, and the default of each column, for
    files that lack it."""
    text = HEAD
    for group, group_columns in groups.items():
        text += f"\n\n@dataclass(frozen=True)\nclass {group.capitalize()}:\n"
        text += "".join(
            f"    {column['name']}: {TYPES[column['type']]}\n"
            for column in group_columns
            if column["type"] != "count"
        )
        if any(column["type"] == "count" for column in group_columns):
            text += "    counters: Counters  # every counter_* column, without the prefix\n"
            text += "\n    def __len__(self) -> int:\n        return len(self.identity)\n"
        elif group == "trace":
            text += "\n    def __len__(self) -> int:\n        return len(self.seconds)\n"
    text += "\n\nDEFAULTS: dict[str, Any] = {\n"
    for group, group_columns in groups.items():
        text += "".join(
            f'    "{group}/{column["name"]}": {default(column)},\n'
            for column in group_columns
            if column["type"] != "count"
        )
    return text + "}\n"


def default(column: dict[str, Any]) -> str:
    def literal(value: Any) -> str:
        if column["type"] == "text":
            return json.dumps(value)
        return f'float("{value}")' if isinstance(value, str) else repr(value)

    value = column["default"]
    if not isinstance(value, list):
        return literal(value)
    if len(value) > 1 and len(set(map(literal, value))) == 1:
        return f"[{literal(value[0])}] * {len(value)}"
    return f"[{', '.join(map(literal, value))}]"


def table(group_columns: list[dict[str, Any]]) -> str:
    lines = ["| column | type | meaning |", "| --- | --- | --- |"]
    for column in group_columns:
        kind = column["type"] if column["width"] == 1 else f"{column['width']} x {column['type']}"
        part = "; part of the identity" if column["identity"] else ""
        lines.append(f"| `{column['name']}` | {kind} | {column['meaning']}{part} |")
    return "\n".join(lines)


def readme(text: str, groups: Groups) -> str:
    """Returns results/README.md with a new table of columns for each group."""
    for group, group_columns in groups.items():
        text = between_marks(text, f"columns of {group}", table(group_columns))
    return text


def between_marks(page: str, name: str, text: str) -> str:
    """Replaces the text between the HTML comments "NAME: begin" and "NAME: end". Raises ValueError
    if they are missing."""
    begin, end = f"<!-- {name}: begin -->", f"<!-- {name}: end -->"
    if page.count(begin) != 1 or page.count(end) != 1:
        raise ValueError(
            f"the marks '{begin}' and '{end}' are missing: put them where the table belongs"
        )
    return re.sub(
        f"{re.escape(begin)}.*?{re.escape(end)}",
        lambda _: f"{begin}\n{text}\n{end}",
        page,
        flags=re.DOTALL,
    )


def key_table(keys: list[dict[str, str]]) -> str:
    lines = ["| key | default | meaning |", "| --- | --- | --- |"]
    for key in keys:
        fallback = key["default"]
        code = f"`{fallback}`" if re.fullmatch(r'[\w.+-]+|"[^"]*"', fallback) else fallback
        lines.append(f"| `{key['name']}` | {code} | {key['meaning']} |")
    return "\n".join(lines)


def recipe_table(recipes: list[dict[str, Any]], heading: str) -> str:
    lines = [f"| `{heading}` | numbers | shape |", "| --- | --- | --- |"]
    for recipe in recipes:
        numbers = ", ".join(f"`{number['name']}`" for number in recipe["numbers"])
        lines.append(f"| `{recipe['name']}` | {numbers} | {recipe['meaning']} |")
    return "\n".join(lines)


def experiments(page: str, keys: dict[str, Any]) -> str:
    """Returns docs/experiments.md with new tables of keys, recipes and operations."""
    for group in keys["tables"]:
        page = between_marks(
            page, f"keys of {group['table'] or 'the top level'}", key_table(group["keys"])
        )
    page = between_marks(page, "recipes", recipe_table(keys["recipes"], "recipe"))
    return between_marks(page, "operations", recipe_table(keys["operations"], "operation"))


def main() -> int:
    groups = columns()
    MODULE.write_text(module(groups), encoding="utf-8")
    README.write_text(readme(README.read_text(encoding="utf-8"), groups), encoding="utf-8")
    EXPERIMENTS.write_text(
        experiments(EXPERIMENTS.read_text(encoding="utf-8"), listed("keys", "--json")),
        encoding="utf-8",
    )
    for path in (MODULE, README, EXPERIMENTS):
        print(path.relative_to(ROOT))
    return 0


if __name__ == "__main__":
    sys.exit(main())
