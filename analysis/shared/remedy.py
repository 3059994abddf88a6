"""The command that measures a result, for error messages about a missing one."""

from __future__ import annotations

from pathlib import Path
from typing import Final

ROOT: Final = Path(__file__).resolve().parents[2]


def measure(stem: str, file: str = "", root: Path = ROOT) -> str:
    """Returns the command that runs an experiment, by its name (`stem`).

    In a clone it is 'make STEM', beside an installed program 'hausbench run STEM'. For an
    experiment of the user it is 'hausbench run FILE', with its file if known.
    """
    ours = any(path.stem == stem for path in (root / "experiments").rglob("*.toml"))
    if ours and (root / "Makefile").is_file():
        return f"'make {stem}'"
    return f"'hausbench run {stem if ours else file or f'{stem}.toml'}'"
