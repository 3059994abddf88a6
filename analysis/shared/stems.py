"""Where the script of a stem is, analysis/<folder>/<stem>.py, as its experiment is experiments/<folder>/<stem>.toml; and whose results it
draws: its own, or those of the experiment that it names as RESULTS_OF.
"""

from __future__ import annotations

import re
from pathlib import Path

from analysis.shared.results import ResultError

ANALYSIS = Path(__file__).resolve().parents[1]
_RESULTS_OF = re.compile(r'^RESULTS_OF\b[^=\n]*= "(\w+)"', re.MULTILINE)


def _script(stem: str) -> Path:
    for file in ANALYSIS.rglob(f"{stem}.py"):
        return file
    raise ResultError(f"there is no analysis/<folder>/{stem}.py")


def _named_in(script: Path) -> str:
    """The stem whose results the script draws, or nothing. Read, not imported: imports take seconds."""
    found = _RESULTS_OF.search(script.read_text(encoding="utf-8"))
    return found[1] if found else ""


def module_of(stem: str) -> str:
    """The name to import it by."""
    return ".".join(("analysis", *_script(stem).relative_to(ANALYSIS).with_suffix("").parts))


def results_of(stem: str) -> str:
    """The stem of the result file that this one draws."""
    return _named_in(_script(stem)) or stem


def drawn_with(stem: str) -> list[str]:
    """The stem itself, and all that draw its results."""
    return [stem, *sorted(file.stem for file in ANALYSIS.rglob("*.py") if _named_in(file) == stem)]
