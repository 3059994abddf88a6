"""Where the script of a stem is: analysis/<folder>/<stem>.py, as its experiment is experiments/<folder>/<stem>.toml."""

from __future__ import annotations

from pathlib import Path

from analysis.shared.results import ResultError

ANALYSIS = Path(__file__).resolve().parents[1]


def module_of(stem: str) -> str:
    """The name to import it by."""
    for file in ANALYSIS.rglob(f"{stem}.py"):
        return ".".join(("analysis", *file.relative_to(ANALYSIS).with_suffix("").parts))
    raise ResultError(f"there is no analysis/<folder>/{stem}.py")
