"""Makes `analysis` and tests/analysis/synthetic.py importable from any working directory, and holds
shared fixtures."""

import sys
from pathlib import Path

import pytest

HERE = Path(__file__).resolve().parent
for folder in (str(HERE.parent.parent), str(HERE)):
    if folder not in sys.path:
        sys.path.insert(0, folder)


@pytest.fixture(autouse=True)
def no_kept_shapes(monkeypatch: pytest.MonkeyPatch) -> None:
    """Synthetic results name models of the kept list, with other hashes."""
    from analysis.shared import unlike

    monkeypatch.setattr(unlike, "LIST", HERE / "no list")


@pytest.fixture()
def tetrahedra(monkeypatch: pytest.MonkeyPatch) -> None:
    """Makes every model a tetrahedron."""
    from stem_runner import TETRAHEDRON

    from analysis.shared import shapes

    monkeypatch.setattr(shapes, "mesh", lambda results, model: TETRAHEDRON)
