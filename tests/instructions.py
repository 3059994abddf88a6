"""Counts the instructions of one solve of tracked solvers under valgrind, and compares them with a baseline.

    python3 tests/instructions.py [--program build/release/hausbench] [--update REASON]

Instructions of the solve alone are the same from run to run, so a slowdown of a percent shows without a clock. They depend on the
compiler and the libraries: tests/instructions_baseline.toml has a table for each key, which names them. Without a table for this
machine nothing is measured. Exit code 0: all within LIMIT of the baseline; 3: more (slower) or fewer (keep the gain: --update);
5: nothing measured; 2: something is missing. valgrind knows AVX2 at most, so AVX-512 code is not what is counted.
"""

from __future__ import annotations

import argparse
import hashlib
import re
import subprocess
import sys
import tempfile
import tomllib
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
BASELINE = ROOT / "tests" / "instructions_baseline.toml"
LIMIT = 0.005  # of the baseline
PACKAGES = ("g++", "libc6", "libstdc++6", "libeigen3-dev", "libcgal-dev", "libhwy-dev", "libgmp10", "libmpfr6", "valgrind")
SURFACES = {"sphere": 'polynomial = "x^2 + y^2 + z^2 - 1"', "ellipsoid": 'polynomial = "x^2 + 2*y^2 + 3*z^2 - 2"'}
BOX = "box = [[-2, 2], [-2, 2], [-2, 2]]"


class Missing(Exception):
    """Something that counting needs is not there; the message names the remedy."""


@dataclass(frozen=True)
class Case:
    solver: str
    source: str  # a model, or a name in SURFACES
    target: str
    tolerance: str


CASES = (Case("guthe", "torus_small", "torus", "1e-4"), Case("scan", "hostile_line_a_20k", "hostile_line_b_20k", "1e-9"),
         Case("ohd", "gaussian_1k_a", "gaussian_1k_b", "1e-9"), Case("surface_enclosure", "sphere", "ellipsoid", "1e-2"))


def output_of(command: list[str]) -> str:
    try:
        done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False, stdin=subprocess.DEVNULL)
    except FileNotFoundError:
        raise Missing(f"{command[0]} is missing: install it with 'make deps'") from None
    if done.returncode != 0:
        raise Missing(f"{' '.join(command)} ended with {done.returncode}: {done.stderr.strip()[-500:]}")
    return done.stdout


def parts_of_key() -> str:
    """What the number of instructions depends on, beside the sources."""
    versions = output_of(["dpkg-query", "--show", "--showformat=${Package} ${Version}\n", *PACKAGES])
    vectors = "avx2" if re.search(r"^flags.*\bavx2\b", Path("/proc/cpuinfo").read_text(), re.M) else "no avx2"
    return ", ".join([*sorted(versions.split("\n")[:-1]), vectors])


def key_of(parts: str) -> str:
    return hashlib.sha256(parts.encode()).hexdigest()[:12]


def file_of(name: str, program: Path, folder: Path) -> Path:
    if name in SURFACES:
        path = folder / f"{name}.surface.toml"
        path.write_text(f"{SURFACES[name]}\n{BOX}\n")
        return path
    path = folder / f"{name}.ply"
    output_of([str(program), "export", name, str(path)])
    return path


def count(case: Case, program: Path, folder: Path) -> int:
    """Instructions of Session::solve, without loading and preparing."""
    out = folder / "callgrind.out"
    output_of(["valgrind", "--tool=callgrind", "--toggle-collect=hausbench::Session::solve(*", f"--callgrind-out-file={out}",
               str(program), "measure", "--in-process", str(file_of(case.source, program, folder)), str(file_of(case.target, program, folder)),
               "--solver", case.solver, "--tolerance", case.tolerance])
    found = re.search(r"^totals: (\d+)$", out.read_text(), re.M)
    if not found or int(found[1]) == 0:
        raise Missing(f"callgrind counted nothing in Session::solve of {program}: build it with 'make build'")
    return int(found[1])


def verdict(now: int, before: int) -> tuple[str, bool]:
    change = now / before - 1
    word = "more: slower" if change > LIMIT else "fewer: keep the gain with --update" if change < -LIMIT else "as before"
    return f"{now:,} instructions, {100 * change:+.2f} % ({word})", abs(change) <= LIMIT


def text_of(tables: dict[str, dict[str, object]]) -> str:
    lines = ["# Written by `python3 tests/instructions.py --update REASON`: instructions of one solve, by what they depend on."]
    for key, table in sorted(tables.items()):
        lines += ["", f"[{key}]", *(f"{name} = {value}" if isinstance(value, int) else f'{name} = "{value}"'
                                    for name, value in table.items())]
    return "\n".join(lines) + "\n"


def run(program: Path, reason: str | None, baseline: Path) -> int:
    parts = parts_of_key()
    key = key_of(parts)
    tables = tomllib.loads(baseline.read_text()) if baseline.is_file() else {}
    if key not in tables and reason is None:
        print(f"instructions: nothing measured: {baseline.name} has no table for {parts}")
        return 5
    good, counts = True, {}
    with tempfile.TemporaryDirectory() as folder:
        for case in CASES:
            counts[case.solver] = now = count(case, program, Path(folder))
            before = tables.get(key, {}).get(case.solver)
            said, same = verdict(now, before) if before else (f"{now:,} instructions, no baseline", reason is not None)
            good = good and same
            print(f"instructions: {case.solver}: {said}", flush=True)
    if reason is not None:
        tables[key] = {"depends_on": parts, "reason": reason.replace("\\", " ").replace('"', "'"), **counts}
        baseline.write_text(text_of(tables))
        return 0
    return 0 if good else 3


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=Path, default=ROOT / "build/release/hausbench")
    parser.add_argument("--update", metavar="REASON", help="write the baseline of this machine, and why it changed")
    parser.add_argument("--baseline", type=Path, default=BASELINE)
    options = parser.parse_args(arguments)
    try:
        return run(options.program, options.update, options.baseline)
    except Missing as problem:
        print(f"instructions: {problem}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
