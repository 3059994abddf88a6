"""Forged proofs of each kind of tests/forgeries.py are refused; `python3 tests/forgeries.py` tries
1,000 of each."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests"))

import forgeries  # noqa: E402

PROGRAM = Path(os.environ.get("HAUSBENCH_PROGRAM", ROOT / "build" / "release" / "hausbench"))


@pytest.mark.parametrize("kind", forgeries.KINDS)
def test_no_forgery_is_accepted(kind: str, tmp_path: Path) -> None:
    library = PROGRAM.parent / "library" / "libhausbench.so"
    c = forgeries.CLibrary(library) if library.exists() else None
    program = PROGRAM if PROGRAM.exists() else None
    for i, forgery in enumerate(forgeries.forgeries(kind, 40, 7, tmp_path)):
        assert (
            forgeries.accepted_by(forgery, tmp_path, c, program if i % 10 == 0 else None) == []
        ), (i, forgery.header)


def test_true_proofs_are_accepted(tmp_path: Path) -> None:
    library = PROGRAM.parent / "library" / "libhausbench.so"
    c = forgeries.CLibrary(library) if library.exists() else None
    forger = forgeries.Forger(8, tmp_path)
    for _ in range(20):
        pair = forger.pair()
        assert (
            {"Python"}
            <= set(forgeries.accepted_by(pair.forged(pair.header), tmp_path, c, None))
            <= {"Python", "C"}
        )
