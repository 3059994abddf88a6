"""Tells whether a solver is on the Pareto front of gap against time: `python3 -m analysis.pareto
STEM [--solver cover] [--results DIR]`.

A cell is a scene of meshes, a pose and a tolerance. The solver is beaten in a cell if a certified
solver is faster (by separated times) and its gap is at most as large. The cell is open if times of
such a rival are not separated or not comparable.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from analysis.shared import claims, numerals, style
from analysis.shared.comparable import apart, origins
from analysis.shared.load import load
from analysis.shared.results import ResultError, Results
from analysis.shared.estimates import Estimate, ratio_by_round
from analysis.shared.verdicts import FAILS, HOLDS, OPEN, UNTESTED, Verdict

SHARE: Final = 0.9  # the claim: on the front in at least this share of the cells


@dataclass(frozen=True)
class Rival:
    name: str
    ratio: Estimate  # time of the solver / time of the rival: above 1 if the rival is faster
    gap: float


@dataclass(frozen=True)
class Cell:
    scene: str
    pose: int
    tolerance: float
    gap: float
    rivals: tuple[Rival, ...]  # solvers with at most this gap that are faster or not separated

    @property
    def beaten_by(self) -> tuple[Rival, ...]:
        return tuple(
            rival for rival in self.rivals if rival.ratio.separated and rival.ratio.low > 1
        )

    def line(self) -> str:
        worst = max(
            self.beaten_by or self.rivals,
            key=lambda rival: rival.ratio.value if rival.ratio.n else 0.0,
        )
        if not worst.ratio.n:
            return f"{style.scene_title(self.scene)} at {numerals.number(self.tolerance, 1)}: no ratio to {worst.name}: {worst.ratio.reason}"
        relation = "beaten by" if self.beaten_by else "not separated from"
        return (
            f"{style.scene_title(self.scene)} at {numerals.number(self.tolerance, 1)}: {relation} {worst.name}, "
            f"{numerals.estimate(worst.ratio)} times as fast with a gap of {numerals.number(worst.gap, 2)} instead of {numerals.number(self.gap, 2)}"
        )


def cells(results: Results, solver: str) -> list[Cell]:
    """Returns one cell for each row of the solver that is `ok`, in the order of the file."""
    cases, kinds = results.cases, dict(zip(results.models.name, results.models.kind))
    solver_cells = []
    for solver_row in results.rows(solver=solver, status="ok"):
        if {kinds.get(cases.source[solver_row]), kinds.get(cases.target[solver_row])} != {"mesh"}:
            continue
        same = results.rows(
            scene=cases.scene[solver_row],
            pose_index=cases.pose_index[solver_row],
            tolerance=cases.tolerance[solver_row],
            certified=1,
        )
        rivals = [
            Rival(
                style.title(cases.solver[row], results.names[row]),
                apart(origins(results, (int(solver_row), int(row))))
                or ratio_by_round(
                    results.total_by_round(int(solver_row)), results.total_by_round(int(row))
                ),
                results.gap(int(row)),
            )
            for row in same
            if cases.solver[row] != solver
            and results.is_bounded(int(row))
            and results.gap(int(row)) <= results.gap(int(solver_row))
        ]
        near = tuple(
            rival
            for rival in rivals
            if (rival.ratio.n or rival.ratio.reason)
            and not (rival.ratio.separated and rival.ratio.high < 1)
        )
        solver_cells.append(
            Cell(
                cases.scene[solver_row],
                int(cases.pose_index[solver_row]),
                float(cases.tolerance[solver_row]),
                results.gap(int(solver_row)),
                near,
            )
        )
    return solver_cells


def judge(solver_cells: Sequence[Cell], title: str) -> Verdict:
    claim = claims.of("hausbench", "pareto", title=title, share=SHARE)
    if not solver_cells:
        return Verdict(claim, UNTESTED, "no cells")
    beaten = sum(bool(cell.beaten_by) for cell in solver_cells)
    unsure = sum(bool(cell.rivals) and not cell.beaten_by for cell in solver_cells)
    front = len(solver_cells) - beaten - unsure
    outcome = (
        HOLDS
        if front >= SHARE * len(solver_cells)
        else FAILS
        if front + unsure < SHARE * len(solver_cells)
        else OPEN
    )
    return Verdict(
        claim,
        outcome,
        f"{front} of {len(solver_cells)} cells, beaten in {beaten}, not separated in {unsure}",
    )


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="analysis.pareto",
        description="Lists the cells in which a solver is on the Pareto front of gap against time, and "
        "the others.",
    )
    parser.add_argument("stem", help="stem of the result file, such as error_vs_time")
    parser.add_argument("--solver", default="cover", help="name of the solver (default: cover)")
    parser.add_argument(
        "--results",
        type=Path,
        default=Path("results"),
        help="folder of the .h5 files (default: results)",
    )
    chosen = parser.parse_args(arguments)
    try:
        solver_cells = cells(load(chosen.results / f"{chosen.stem}.h5"), chosen.solver)
    except ResultError as problem:
        print(problem, file=sys.stderr)
        return 2
    print(judge(solver_cells, style.title(chosen.solver)).line())
    for cell in solver_cells:
        if cell.rivals:
            print(cell.line())
    return 0


if __name__ == "__main__":
    sys.exit(main())
