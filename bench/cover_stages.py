"""Writes the table of stages into algorithms/meshes/cover/cover.md: where `cover` spends its time,
beside a floor.

    python3 -m bench.cover_stages [ROUNDS]

Needs the release build and the models. Each round is a new process for each regime, so the memory
is new, too. The floor and the cost of a page come from kernel_bench. Takes about two minutes; run
it when nothing else runs.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from analysis.shared.load import load
from analysis.shared.numerals import number

ROOT = Path(__file__).resolve().parents[1]
BUILD = ROOT / "build" / "release"
EXPERIMENT = ROOT / "bench" / "cover_stages.toml"
PAGE = ROOT / "algorithms" / "meshes" / "cover" / "cover.md"
BEGIN, END = (
    "<!-- The next lines are written by `python3 -m bench.cover_stages`. -->",
    "<!-- End of the written lines. -->",
)

# Column of the table: what it adds up. "prepare:" is a structure, "seconds:" a stage of the solver.
STAGES = {
    "order of A": ["prepare: source triangle order"],
    "blocks of B": ["prepare: target triangle blocks"],
    "boxes of groups": ["prepare: solver"],
    "groups": ["seconds: measure groups"],
    "first clusters": ["seconds: cover the first clusters"],
    "single": ["seconds: cover in single precision"],
    "double": ["seconds: cover in double precision"],
}


@dataclass
class Regime:
    """The measurements of one scene; each list has one number a round."""

    source: str
    target: str
    triangles: int
    seconds: dict[str, list[float]] = field(default_factory=dict)
    memory_ratio: list[float] = field(
        default_factory=list
    )  # peak memory / memory of the structures


def measured(rounds: int) -> dict[str, Regime]:
    regimes: dict[str, Regime] = {}
    for _ in range(rounds):
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run(
                [BUILD / "hausbench", "run", EXPERIMENT, "--results", folder],
                check=True,
                stdout=subprocess.DEVNULL,
            )
            add_round(regimes, Path(folder) / "cover_stages.h5")
    return regimes


def add_round(regimes: dict[str, Regime], file: Path) -> None:
    results = load(file)
    cases, prepared = results.cases, results.preparation
    for i, scene in enumerate(cases.scene):
        triangles = int(cases.source_elements[i] + cases.target_elements[i])
        regime = regimes.setdefault(scene, Regime(cases.source[i], cases.target[i], triangles))
        parts = {
            f"prepare: {name}": float(seconds)
            for name, seconds in zip(
                prepared.name[prepared.case == i], prepared.seconds[prepared.case == i]
            )
        }
        parts |= {
            name: seconds
            for name, seconds in json.loads(cases.extras[i]).items()
            if name.startswith("seconds: ")
        }
        unknown = set(parts) - {part for stage in STAGES.values() for part in stage}
        if unknown:
            raise ValueError(f"no column for {', '.join(sorted(unknown))}")
        for stage, names in STAGES.items():
            regime.seconds.setdefault(stage, []).append(sum(parts.get(name, 0.0) for name in names))
        regime.memory_ratio.append(float(cases.peak_bytes[i]) / float(cases.prepare_bytes[i]))


def benchmarks(pairs: list[str]) -> dict[str, float]:
    """Returns the seconds per triangle of each floor, and per page of each way to get pages, by the
    benchmark's name."""
    command = [
        str(BUILD / "kernel_bench"),
        f"--pairs={','.join(pairs)}",
        "--benchmark_filter=^(page|floor)/",
        "--benchmark_format=json",
        "--benchmark_repetitions=5",
        "--benchmark_report_aggregates_only=true",
    ]
    out = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    return {
        benchmark["run_name"]: benchmark["each"]
        for benchmark in out["benchmarks"]
        if benchmark["aggregate_name"] == "median"
    }


def table(regimes: dict[str, Regime], floor: dict[str, float], cpu: str, rounds: int) -> str:
    head = ["regime", "A → B", "triangles", *STAGES, "sum", "floor", "sum / floor", "memory / kept"]
    lines = ["| " + " | ".join(head) + " |", "| --- | --- |" + " ---: |" * (len(head) - 2)]
    for name, regime in regimes.items():
        by_stage = {
            stage: 1e9 * float(np.median(seconds)) / regime.triangles
            for stage, seconds in regime.seconds.items()
        }
        least = 1e9 * floor[f"floor/{regime.source}:{regime.target}"]
        total = (
            1e9 * float(np.median(np.sum(list(regime.seconds.values()), axis=0))) / regime.triangles
        )
        cells = [
            name,
            f"{regime.source} → {regime.target}",
            f"{regime.triangles:,}",
            *(number(x, 3) for x in by_stage.values()),
            number(total, 3),
            number(least, 3),
            number(total / least, 2),
            number(float(np.median(regime.memory_ratio)), 3),
        ]
        lines.append("| " + " | ".join(cells) + " |")
    page = {
        how: number(1e6 * floor[f"page/{how}"], 2) for how in ("one_by_one", "touch_pages", "huge")
    }
    return f"""Nanoseconds for each triangle of A and B by stage, at 1e-6 of the diagonal, on one core ({cpu}); median of {rounds} processes. A page
of 4 KiB that is touched for the first time costs {page['one_by_one']} µs here, {page['huge']} µs as a part of a huge page, and {page['touch_pages']} µs by
`touch_pages`. The floor is reading and sorting both meshes, and one query from each sixteen triangles of A, in memory that is warm. The last
column is the peak of the resident memory during preparing and solving over the memory of the structures.

""" + "\n".join(
        lines
    )


def cpu_name() -> str:
    return next(
        line.split(":", 1)[1].strip()
        for line in Path("/proc/cpuinfo").read_text().splitlines()
        if line.startswith("model name")
    )


def main() -> None:
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 7
    regimes = measured(rounds)
    floor = benchmarks([f"{regime.source}:{regime.target}" for regime in regimes.values()])
    before, rest = PAGE.read_text().split(BEGIN)
    after = rest.split(END)[1]
    PAGE.write_text(
        before + BEGIN + "\n\n" + table(regimes, floor, cpu_name(), rounds) + "\n\n" + END + after
    )


if __name__ == "__main__":
    main()
