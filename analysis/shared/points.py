"""Coordinates of point models, for pictures and counts: result files have none, so the program exports them."""

from __future__ import annotations

import subprocess
import tempfile
from pathlib import Path

import numpy as np

from analysis.shared.columns import Floats
from analysis.shared.program import ROOT, program



def points_of(model: str, count: int) -> Floats | None:
    """n x 3, in the unit of the model. None if the program is missing, or its model is missing or of another size."""
    if not program().is_file():
        return None
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "model.off"
        done = subprocess.run([program(), "export", model, file], cwd=ROOT, capture_output=True, check=False)
        if done.returncode != 0:
            return None
        with file.open(encoding="ascii") as text:
            if text.readline().strip() != "OFF":
                return None
            n = int(text.readline().split()[0])
            found = np.loadtxt(text, max_rows=n, ndmin=2)
    return found if found.shape == (count, 3) else None


def posed(points: Floats, pose: Floats) -> Floats:
    """Moves points by a pose as stored in result files: the rotation row by row, then the translation."""
    moved: Floats = points @ pose[:9].reshape(3, 3).T + pose[9:]
    return moved
