"""The command that measures a result, for the messages that ask for it."""

from __future__ import annotations

from pathlib import Path
from typing import Final

ROOT: Final = Path(__file__).resolve().parents[2]


def measure(stem: str, file: str = "", root: Path = ROOT) -> str:
    """Returns the command that measures a stem.

    It is 'make STEM' for an experiment of the project in a clone, and 'hausbench run STEM' for one beside an installed
    program. For any other experiment it is 'hausbench run FILE', with the file of the experiment if that is known.
    """
    ours = any(path.stem == stem for path in (root / "experiments").rglob("*.toml"))
    if ours and (root / "Makefile").is_file():
        return f"'make {stem}'"
    return f"'hausbench run {stem if ours else file or f'{stem}.toml'}'"
