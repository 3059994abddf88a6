"""`guthe` as it is now against an older commit: fresh processes in turn, as CSV that bench/report.py takes.

    python3 -m bench.versions --old 74fa840 > results/reference/kernels_versions.csv

builds the old commit in build/versions/<commit> if it is not there, which takes some minutes. What is compared is the
time that `hausbench measure` itself reports for preparing and solving: wall time, on one thread. (Its CPU time says
nothing: which of its processes solves has changed between versions.) Reading files is not in it.
"""

from __future__ import annotations

import argparse
import csv
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from analysis.shared.statistics import median, paired_ratio
from bench.report import COLUMNS

ROOT = Path(__file__).resolve().parent.parent
PAIRS = [("bunny_half", "bunny"), ("elephant", "refined_elephant"), ("armadillo_half", "armadillo"),
         ("bunny_cgal_normalised", "bunny_normalised")]


def build_of(commit: str) -> Path:
    """The program at that commit, built as this one is."""
    folder = ROOT / "build" / "versions" / commit
    if not folder.exists():
        subprocess.run(["git", "clone", "--quiet", "--no-checkout", str(ROOT), str(folder)], check=True)
    subprocess.run(["git", "-C", str(folder), "checkout", "--quiet", "--detach", commit], check=True)
    build = folder / "build" / "release"
    for command in (["cmake", "-S", str(folder), "-B", str(build), "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
                     "-DHAUSBENCH_WITH_TESTS=OFF"], ["cmake", "--build", str(build), "--target", "hausbench"]):
        subprocess.run(command, check=True, stdout=sys.stderr)
    return build / "hausbench"


def seconds_of(program: Path, files: list[Path]) -> tuple[float, float]:
    """Of one measurement, preparing and solving; and the lower bound it found."""
    done = subprocess.run([program, "measure", *files, "--solver", "guthe", "--json"], stdout=subprocess.PIPE, text=True, check=False)
    if done.returncode != 0:
        raise SystemExit(f"{program} failed on {files[0].name} and {files[1].name}")
    found = json.loads(done.stdout)
    return float(found["prepare_seconds"]) + float(found["solve_seconds"]), float(found["lower"])


def compare(programs: dict[str, Path], files: list[Path], rounds: int) -> dict[str, list[float]]:
    """Seconds of each program by round; rounds go forth and back, and one before them is not kept."""
    seconds: dict[str, list[float]] = {name: [] for name in programs}
    for round_ in range(-1, rounds):
        for name in list(programs) if round_ % 2 == 0 else reversed(list(programs)):
            time, _ = seconds_of(programs[name], files)
            if round_ >= 0:
                seconds[name].append(time)
    return seconds


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--old", default="74fa840", help="commit to compare with (default: the one that the aims of the kernels were set against)")
    parser.add_argument("--old-program", type=Path, help="its program, if it is built already")
    parser.add_argument("--program", type=Path,
                        default=os.environ.get("HAUSBENCH_PROGRAM", ROOT / "build/release/hausbench"))
    parser.add_argument("--rounds", type=int, default=12)
    arguments = parser.parse_args()
    old = arguments.old_program or build_of(arguments.old)
    programs = {"guthe (now)": Path(arguments.program), f"guthe (at {arguments.old})": Path(old)}

    out = csv.DictWriter(sys.stdout, COLUMNS, lineterminator="\n")
    out.writeheader()
    with tempfile.TemporaryDirectory() as folder:
        for pair in PAIRS:
            files = [Path(folder) / f"{name}.off" for name in pair]
            for name, file in zip(pair, files):
                if not file.exists():
                    subprocess.run([arguments.program, "export", name, file], check=True, stdout=subprocess.DEVNULL)
            seconds = compare(programs, files, arguments.rounds)
            lower = [seconds_of(program, files)[1] for program in programs.values()]
            for i, (name, times) in enumerate(seconds.items()):
                ratio = paired_ratio(times, seconds["guthe (now)"])
                out.writerow({"part": "version", "scene": " to ".join(pair), "contender": name, "elements": 1,
                              "nanoseconds": f"{1e9 * median(times).value:.6g}", "ratio": f"{ratio.value:.6g}",
                              "low": f"{ratio.low:.6g}", "high": f"{ratio.high:.6g}", "rounds": len(times), "bytes": 0,
                              "largest_difference": f"{abs(lower[i] - lower[0]):.3g}"})
            sys.stdout.flush()


if __name__ == "__main__":
    main()
