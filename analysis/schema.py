"""What follows in Python and in prose from the program's columns: analysis/shared/columns.py and the tables of results/README.md.

    python3 -m analysis.schema

asks the program (`hausbench list columns`) and writes both; a test fails where they differ from it.
Nothing else in analysis/ starts the program: stems read result files, and shapes from the cache.
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
MODULE: Final = ROOT / "analysis" / "shared" / "columns.py"
TYPES: Final = {"text": "Texts", "real": "Floats", "integer": "Ints"}
HEAD: Final = '''"""The columns of result files, as analysis/shared/load.py reads them. Written by `python3 -m analysis.schema`: do not edit."""

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
    """HAUSBENCH_PROGRAM, else the program that `make build` builds."""
    return Path(os.environ.get("HAUSBENCH_PROGRAM", ROOT / "build" / "release" / "hausbench"))


def listed(what: str) -> Any:
    """What `hausbench list` says, as JSON."""
    done = subprocess.run([program(), "list", what], cwd=ROOT, capture_output=True, text=True, check=True)
    return json.loads(done.stdout)


def columns() -> Groups:
    groups: Groups = listed("columns")
    return groups


def module(groups: Groups) -> str:
    """A dataclass a group, and what a file that lacks a column has in its place."""
    text = HEAD
    for group, known in groups.items():
        text += f"\n\n@dataclass(frozen=True)\nclass {group.capitalize()}:\n"
        text += "".join(f"    {column['name']}: {TYPES[column['type']]}\n" for column in known if column["type"] != "count")
        if any(column["type"] == "count" for column in known):
            text += "    counters: Counters  # every counter_* column, without the prefix\n"
            text += "\n    def __len__(self) -> int:\n        return len(self.identity)\n"
        elif group == "trace":
            text += "\n    def __len__(self) -> int:\n        return len(self.seconds)\n"
    text += "\n\nDEFAULTS: dict[str, Any] = {\n"
    for group, known in groups.items():
        text += "".join(f'    "{group}/{column["name"]}": {default(column)},\n' for column in known if column["type"] != "count")
    return text + "}\n"


def default(column: dict[str, Any]) -> str:
    def one(value: Any) -> str:
        if column["type"] == "text":
            return json.dumps(value)
        return f'float("{value}")' if isinstance(value, str) else repr(value)

    value = column["default"]
    return f"[{', '.join(map(one, value))}]" if isinstance(value, list) else one(value)


def table(known: list[dict[str, Any]]) -> str:
    lines = ["| column | type | meaning |", "| --- | --- | --- |"]
    for column in known:
        kind = column["type"] if column["width"] == 1 else f"{column['width']} x {column['type']}"
        part = "; part of the identity" if column["identity"] else ""
        lines.append(f"| `{column['name']}` | {kind} | {column['meaning']}{part} |")
    return "\n".join(lines)


def readme(text: str, groups: Groups) -> str:
    """With the table of each group between its marks."""
    for group, known in groups.items():
        begin, end = f"<!-- columns of {group}: begin -->", f"<!-- columns of {group}: end -->"
        if text.count(begin) != 1 or text.count(end) != 1:
            raise ValueError(f"results/README.md: the marks '{begin}' and '{end}' are missing: put them where the table belongs")
        text = re.sub(f"{begin}.*?{end}", lambda _: f"{begin}\n{table(known)}\n{end}", text, flags=re.DOTALL)
    return text


def main() -> int:
    groups = columns()
    MODULE.write_text(module(groups), encoding="utf-8")
    README.write_text(readme(README.read_text(encoding="utf-8"), groups), encoding="utf-8")
    for path in (MODULE, README):
        print(path.relative_to(ROOT))
    return 0


if __name__ == "__main__":
    sys.exit(main())
