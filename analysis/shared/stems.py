"""Where the script of a stem is, analysis/<folder>/<stem>.py, as its experiment is experiments/<folder>/<stem>.toml; and whose results it
draws: its own, or those of the experiments that it names as RESULTS_OF. Of several the first is the one that is loaded for it, and the Makefile
measures the others before it draws.
"""

from __future__ import annotations

import re
from pathlib import Path

from analysis.shared.results import ResultError

ANALYSIS = Path(__file__).resolve().parents[1]
_RESULTS_OF = re.compile(r'^RESULTS_OF\b[^=\n]*= (.*)$', re.MULTILINE)


def _script(stem: str) -> Path:
    for file in ANALYSIS.rglob(f"{stem}.py"):
        return file
    raise ResultError(f"there is no analysis/<folder>/{stem}.py")


def _named_in(script: Path) -> list[str]:
    """The stems whose results the script draws; its own if it names none. Read, not imported: imports take seconds."""
    found = _RESULTS_OF.search(script.read_text(encoding="utf-8"))
    return re.findall(r'"(\w+)"', found[1]) if found else [script.stem]


def module_of(stem: str) -> str:
    """The name to import it by."""
    return ".".join(("analysis", *_script(stem).relative_to(ANALYSIS).with_suffix("").parts))


def results_of(stem: str) -> str:
    """The stem of the result file that this one draws."""
    return _named_in(_script(stem))[0]


def also_reads(stem: str) -> list[str]:
    """The stems whose results it needs beside that file."""
    return _named_in(_script(stem))[1:]


def drawn_with(stem: str) -> list[str]:
    """The stem itself, and all that draw its results."""
    return [stem, *sorted(file.stem for file in ANALYSIS.rglob("*.py") if file.stem != stem and _named_in(file)[0] == stem)]
