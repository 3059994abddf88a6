"""Lets the tests import `analysis` and the generator of result files wherever pytest is started, and holds shared fixtures."""

import sys
from pathlib import Path

import pytest

HERE = Path(__file__).resolve().parent
for folder in (str(HERE.parent.parent), str(HERE)):
    if folder not in sys.path:
        sys.path.insert(0, folder)


@pytest.fixture()
def tetrahedra(monkeypatch: pytest.MonkeyPatch) -> None:
    """Makes every model a tetrahedron."""
    from stem_runner import TETRAHEDRON

    from analysis.shared import shapes

    monkeypatch.setattr(shapes, "mesh", lambda results, model: TETRAHEDRON)
