"""Where the program is, for what only it knows."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Final

ROOT: Final = Path(__file__).resolve().parents[2]


def program() -> Path:
    """HAUSBENCH_PROGRAM, else the program that `make build` builds."""
    return Path(os.environ.get("HAUSBENCH_PROGRAM", ROOT / "build" / "release" / "hausbench"))
