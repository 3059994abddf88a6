"""Finds the script of a stem (the name of an experiment), and the results that the script draws.

The script of experiments/<folder>/<stem>.toml is analysis/<folder>/<stem>.py, or the one that
SCRIPTS names. It draws the results of its own stem unless it lists others as RESULTS_OF: then it
gets the results of the first of these, and the Makefile measures the others before the script runs.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Final

from analysis.shared.results import ResultError

# The scripts of stems that have none of their own. tools/walk reads these lines.
SCRIPTS: Final = {
    "corpus_decimation": "every_mesh",
    "corpus_remesh": "every_mesh",
    "scaling_meshes": "growth",
    "scaling_points": "growth",
    "zhang2017_fig10": "zhang_motion",
    "zhang2017_fig11": "zhang_motion",
}
ANALYSIS = Path(__file__).resolve().parents[1]
_RESULTS_OF = re.compile(r"^RESULTS_OF\b[^=\n]*= (.*)$", re.MULTILINE)


def has_script(stem: str) -> bool:
    return stem in SCRIPTS or any(ANALYSIS.rglob(f"{stem}.py"))


def script_of(stem: str) -> Path:
    for file in ANALYSIS.rglob(f"{SCRIPTS.get(stem, stem)}.py"):
        return file
    raise ResultError(f"there is no analysis/<folder>/{stem}.py")


def named_in(script: Path) -> list[str]:
    """Returns the stems that a script lists as RESULTS_OF. Searches its text, because importing it
    would take seconds."""
    match = _RESULTS_OF.search(script.read_text(encoding="utf-8"))
    return re.findall(r'"(\w+)"', match[1]) if match else []


def module_of(stem: str) -> str:
    """Returns the module name of the script of a stem, such as analysis.speed.cliffs."""
    return ".".join(("analysis", *script_of(stem).relative_to(ANALYSIS).with_suffix("").parts))


def results_of(stem: str) -> str:
    """Returns the stem whose result file the script of this stem draws."""
    return (named_in(script_of(stem)) or [stem])[0]


def drawn_with(stem: str) -> list[str]:
    """Returns the stem and all other stems whose scripts draw its results."""
    return [
        stem,
        *sorted(
            file.stem
            for file in ANALYSIS.rglob("*.py")
            if file.stem != stem and named_in(file)[:1] == [stem]
        ),
    ]
