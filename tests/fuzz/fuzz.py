"""Runs the fuzz targets that `make fuzz` has built.

    python3 tests/fuzz/fuzz.py [--seconds S] [--seed N] [TARGET ...]   continue where earlier runs stopped; readers:dxf: one format
    python3 tests/fuzz/fuzz.py --short                                 as in CI: the kept files, then a few seconds each
    python3 tests/fuzz/fuzz.py --keep [TARGET ...]                     keep the smallest files with the same coverage, in tests/fuzz/corpus

Inputs accumulate in build/fuzz/corpus/TARGET, and each run adds a line to build/fuzz/totals.jsonl
(tests/fuzz/report.py prints their sums). Exit code 1: a target failed; its input is in
build/fuzz/failures, and belongs in tests/fuzz/crashes/TARGET once the fault is fixed.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from datetime import datetime, timezone
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
KEPT = ROOT / "tests" / "fuzz"
BUILD = ROOT / "build" / "fuzz"
TARGETS = [
    "arrays",
    "certificates",
    "differential",
    "experiments",
    "journals",
    "kernels",
    "polynomials",
    "readers",
    "results",
]
# The longest input that a target can use, in bytes.
LENGTHS = {
    "arrays": 800,
    "differential": 600,
    "kernels": 256,
    "polynomials": 220,
    "certificates": 2000,
    "results": 600,
}
# Executions of a short run, which take less than ten seconds on an idle machine.
SHORT = {
    "arrays": 3000,
    "certificates": 3000,
    "differential": 300,
    "experiments": 2000,
    "journals": 2000,
    "kernels": 5000,
    "polynomials": 2000,
    "readers": 20000,
    "results": 300,
}
SHORT_SECONDS = 10
KEPT_BYTES = 22_000  # limit for each target's corpus


def program(target: str) -> Path:
    return BUILD / "tests" / "fuzz" / f"fuzz_{target.partition(':')[0]}"


def options(target: str) -> list[str]:
    """Returns libFuzzer's options for a target. Its timeout of 100 s allows for all solves of
    `differential`, up to 5 s each, and for 60 s of a results reader.
    """
    failures = BUILD / "failures"
    failures.mkdir(parents=True, exist_ok=True)
    words = [
        f"-max_len={LENGTHS.get(target, 4096)}",
        "-timeout=100",
        "-rss_limit_mb=2048",
        f"-artifact_prefix={failures}/{target}-",
    ]
    dictionary = KEPT / f"{target.partition(':')[0]}.dict"
    return words + ([f"-dict={dictionary}"] if dictionary.is_file() else [])


def kept(target: str) -> list[Path]:
    return [folder for kind in ("corpus", "crashes") if (folder := KEPT / kind / target).is_dir()]


def call(target: str, words: list[str]) -> tuple[int, str, float]:
    """Runs the target with these arguments; returns exit code, output and CPU seconds."""
    before = os.times()
    done = subprocess.run(
        [program(target), *options(target), *words],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
        cwd=BUILD,
    )
    after = os.times()
    seconds = (
        after.children_user + after.children_system - before.children_user - before.children_system
    )
    return done.returncode, done.stdout, seconds


def replay(target: str) -> bool:
    files = sorted(file for folder in kept(target) for file in folder.iterdir())
    if not files:
        print(f"{target:14} has no kept file", flush=True)
        return False
    code, output, seconds = call(target, [str(file) for file in files])
    print(
        f"{target:14} {len(files):4} kept files replayed in {seconds:.1f} s{'' if code == 0 else ': FAILED'}",
        flush=True,
    )
    if code != 0:
        print("\n".join(output.splitlines()[-40:]))
    return code == 0


def number(pattern: str, text: str) -> int:
    """Returns the number in the last match of the pattern, or 0."""
    matches = re.findall(pattern, text)
    return int(matches[-1]) if matches else 0


def fuzz(target: str, folder: Path, seed: int, limits: list[str]) -> dict[str, str | int | float]:
    folder.mkdir(parents=True, exist_ok=True)
    begun = datetime.now(timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")
    seeds = list(map(str, kept(target)))
    target_alone, _, ending = target.partition(":")
    if (
        ending
    ):  # the mutator of `readers` keeps the first line, so that seeds of one format give files of this format
        for source in kept(target_alone):
            for file in source.iterdir():
                if file.read_bytes().split(b"\n", 1)[0].split(b" ", 1)[0] == ending.encode():
                    shutil.copy(file, folder)
        if not any(folder.iterdir()):
            raise SystemExit(
                f"fuzz: tests/fuzz/corpus/{target_alone} has no file of the format {ending}"
            )
    code, output, seconds = call(
        target, [str(folder), *seeds, f"-seed={seed}", "-print_final_stats=1", *limits]
    )
    record: dict[str, str | int | float] = {
        "target": target,
        "begun": begun,
        "seed": seed,
        "cpu_seconds": round(seconds, 1),
        "executions": number(r"stat::number_of_executed_units:\s+(\d+)", output),
        "corpus": number(r"corp: (\d+)", output),
        "coverage": number(r"cov: (\d+)", output),
        "features": number(r"ft: (\d+)", output),
        "failed": int(code != 0),
    }
    print(
        f"{target:14} {record['executions']:9} executions in {seconds:.0f} s of CPU time, {record['features']} features"
        f"{'' if code == 0 else ': FAILED'}",
        flush=True,
    )
    if code != 0:
        print("\n".join(output.splitlines()[-40:]), flush=True)
    return record


def short() -> bool:
    good = True
    begun = time.monotonic()
    for target in TARGETS:
        good = replay(target) and good
        with tempfile.TemporaryDirectory() as folder:
            record = fuzz(
                target,
                Path(folder),
                1,
                [f"-runs={SHORT[target]}", f"-max_total_time={SHORT_SECONDS}"],
            )
        good = good and not record["failed"]
    print(f"{len(TARGETS)} targets in {time.monotonic() - begun:.0f} s")
    return good


def long(targets: list[str], seconds: int, seed: int) -> bool:
    good = True
    for target in targets:
        record = fuzz(target, BUILD / "corpus" / target, seed, [f"-max_total_time={seconds}"])
        with (BUILD / "totals.jsonl").open("a") as totals:
            totals.write(json.dumps(record) + "\n")
        good = good and not record["failed"]
    return good


def keep(targets: list[str]) -> bool:
    """Adds new inputs that reach more code to the kept corpus, smallest first, while there is room.
    Kept inputs stay."""
    for target in targets:
        folder = KEPT / "corpus" / target
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory() as merged:
            for file in folder.iterdir():
                shutil.copy(file, merged)
            call(target, ["-merge=1", merged, str(BUILD / "corpus" / target)])
            room = KEPT_BYTES - sum(file.stat().st_size for file in folder.iterdir())
            for file in sorted(Path(merged).iterdir(), key=lambda path: path.stat().st_size):
                size = file.stat().st_size
                if not (folder / file.name).exists() and 0 < size <= room:
                    shutil.copy(file, folder / file.name[:12])
                    room -= size
        print(f"{target:14} {len(list(folder.iterdir()))} files, {KEPT_BYTES - room} bytes")
    return True


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("targets", nargs="*", metavar="TARGET", help=", ".join(TARGETS))
    parser.add_argument("--seconds", type=int, default=60, help="of wall time, each target")
    parser.add_argument(
        "--seed", type=int, default=0, help="default: how many runs there have been, and one"
    )
    parser.add_argument("--short", action="store_true")
    parser.add_argument("--keep", action="store_true")
    given = parser.parse_args(arguments)
    if unknown := [target for target in given.targets if target.partition(":")[0] not in TARGETS]:
        parser.error(f"there is no target {unknown[0]}: {', '.join(TARGETS)}")
    targets = given.targets or TARGETS
    totals = BUILD / "totals.jsonl"
    seed = given.seed or 1 + (len(totals.read_text().splitlines()) if totals.is_file() else 0)
    good = (
        short()
        if given.short
        else keep(targets)
        if given.keep
        else long(targets, given.seconds, seed)
    )
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
