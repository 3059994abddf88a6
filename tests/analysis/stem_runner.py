"""Runs the analysis script of a result file and reads back the table it writes."""

from __future__ import annotations

import csv
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import pytest
import synthetic
import synthetic_sacht
import synthetic_tang
import synthetic_zhang
from synthetic import ResultFile

from analysis.__main__ import main
from analysis.shared import report
from analysis.shared.shapes import Mesh

Made = tuple[list[dict[str, str]], dict[str, list[list[str]]], str]
Make = Callable[[ResultFile], Made]

STEMS = {
    "zhang2017_table3": synthetic.zhang2017_table3,
    "sacht2024_fig13": synthetic.sacht2024_fig13,
    "error_vs_time": synthetic.error_vs_time,
    "points_speed": synthetic.points_speed,
    "cliffs": synthetic.cliffs,
    "points_hostile": synthetic.points_hostile,
    **synthetic_zhang.STEMS,
    **synthetic_sacht.STEMS,
    **synthetic_tang.STEMS,
}

MAGIC = {".pdf": b"%PDF", ".png": b"\x89PNG"}
_rendered = set(STEMS)  # stems whose figure this process has already rendered
TETRAHEDRON = Mesh(
    np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]),
    np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]),
)


def closed(figure: Any, *_: object) -> list[Path]:
    """Closes a figure in place of report.save_figure(), and returns its files: none."""
    plt.close(figure)
    return []


def stem_runner(folder: Path) -> Make:
    """Returns a function that analyses a result file and returns the CSV records, the Markdown rows
    by first cell, and the whole Markdown text.

    The figure of each stem is rendered only once, because rendering takes most of the time.
    """

    def run(file: ResultFile) -> Made:
        file.write(folder)
        with pytest.MonkeyPatch.context() as patch:
            if file.stem in _rendered:
                patch.setattr(report, "save_figure", closed)
            assert main([file.stem, "--results", str(folder), "--out", str(folder)]) == 0
        for suffix, magic in MAGIC.items() if file.stem not in _rendered else ():
            paths = [
                *(folder / "figures").glob(f"{file.stem}{suffix}"),
                *(folder / "figures").glob(f"{file.stem}-*{suffix}"),
            ]
            assert paths and all(
                path.read_bytes().startswith(magic) and path.stat().st_size > 5000 for path in paths
            )
        _rendered.add(file.stem)
        text = (folder / "tables" / f"{file.stem}.md").read_text(encoding="utf-8")
        tex = (folder / "tables" / f"{file.stem}.tex").read_text(encoding="utf-8")
        assert tex.isascii() and tex.count("{") == tex.count("}")
        rows: dict[str, list[list[str]]] = {}
        for line in text.splitlines():
            if line.startswith("| "):
                cells = re.split(r"(?<!\\)\|", line)[1:-1]
                rows.setdefault(cells[0].strip(), []).append([cell.strip() for cell in cells[1:]])
        with (folder / "tables" / f"{file.stem}.csv").open(encoding="utf-8") as opened:
            return list(csv.DictReader(opened)), rows, text

    return run
