"""Compares `guthe` now with an older commit on pairs of real meshes, as CSV for bench/report.py.

    python3 -m bench.tracking.versions --base 74fa840 > results/reference/kernels_versions.csv

Blocks run one after the other, in turns. Compares preparing (wall time) and solving (CPU time), each with one thread.
"""

from __future__ import annotations

import argparse
import csv
import os
import sys
import tempfile
from pathlib import Path

from analysis.shared.statistics import median, paired_ratio
from bench.report import COLUMNS
from bench.tracking.blocks import Block, measure
from bench.tracking.builds import build_of, fetch
from bench.tracking.cases import ROOT, Case

PAIRS = (("bunny_half", "bunny"), ("elephant", "refined_elephant"), ("armadillo_half", "armadillo"), ("bunny_cgal_normalised", "bunny_normalised"))


def case_of(source: str, target: str) -> Case:
    scene = {"name": f"{source} to {target}", "source": source, "target": target}
    limits = {"case_seconds": 60, "prepare_seconds": 60}
    return Case(scene["name"], {"title": "guthe, now and then", "tolerances": [1e-6], "of": "diagonal", "repeats": 3, "rounds": 1, "limits": limits,
                                "scene": [scene], "solver": [{"name": "guthe"}]})


def compare(programs: dict[str, Path], case: Case, rounds: int, folder: Path) -> dict[str, list[Block]]:
    """Returns a block per round for each program. The order is reversed in every other round; a first round is dropped."""
    blocks: dict[str, list[Block]] = {name: [] for name in programs}
    for round_ in range(-1, rounds):
        for name in list(programs) if round_ % 2 == 0 else reversed(list(programs)):
            block = measure(programs[name], case, folder)
            if round_ >= 0:
                blocks[name].append(block)
    return blocks


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--base", default="74fa840", help="commit to compare with (default: the one that the aims of the kernels were set against)")
    parser.add_argument("--program", type=Path, default=os.environ.get("HAUSBENCH_PROGRAM", ROOT / "build/release/hausbench"))
    parser.add_argument("--rounds", type=int, default=12)
    given = parser.parse_args()
    base = build_of(given.base)
    fetch(base.tree, {model for pair in PAIRS for model in pair})
    now = "guthe (now)"
    programs = {now: Path(given.program).resolve(), f"guthe (at {given.base})": base.program}
    out = csv.DictWriter(sys.stdout, COLUMNS, lineterminator="\n")
    out.writeheader()
    for pair in PAIRS:
        with tempfile.TemporaryDirectory() as folder:
            blocks = compare(programs, case_of(*pair), given.rounds, Path(folder))
        seconds = {name: [block.prepare + block.cpu for block in found] for name, found in blocks.items()}
        for name, found in blocks.items():
            ratio = paired_ratio(seconds[name], seconds[now])
            out.writerow({"part": "version", "scene": " to ".join(pair), "contender": name, "elements": 1,
                          "nanoseconds": f"{1e9 * median(seconds[name]).value:.6g}", "ratio": f"{ratio.value:.6g}", "low": f"{ratio.low:.6g}",
                          "high": f"{ratio.high:.6g}", "rounds": given.rounds, "bytes": 0,
                          "largest_difference": f"{abs(found[0].lower - blocks[now][0].lower):.3g}"})
        sys.stdout.flush()


if __name__ == "__main__":
    main()
