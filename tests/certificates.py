"""Writes and checks certificates for pairs of real meshes, then checks them again with false
claims, which must be refused.

    python3 tests/certificates.py [--program build/release/hausbench] [--solver NAME] [--pairs N]

Pairs whose models were not fetched are skipped. Exit code 0: all true proofs are accepted and all
false claims refused; 1: some are not; 2: the program is missing.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
NEAR = (
    "armadillo",
    "bear",
    "bull",
    "bunny",
    "couplingdown",
    "fandisk",
    "flange",
    "hand",
    "pinion",
    "propeller",
    "turbine",
    "wuson",
)
PAIRS = tuple(
    pair for name in NEAR for pair in ((name, f"{name}_half"), (f"{name}_half", name))
) + (
    ("bunny", "bunny_remeshed"),
    ("fandisk", "fandisk_remeshed"),
    ("hand", "hand_near"),
    ("fandisk", "fandisk_near"),
    ("dino", "dino_decimated"),
    ("bear", "bear_decimated"),
    ("pinion", "pinion_decimated"),
    ("hand", "hand_noisy"),
    ("cow", "cow_subdivided_noisy"),
    ("dragon_res4", "dragon_res3"),
    ("dragon_res3", "dragon_res2"),
    ("snowden_hi", "snowden_lo"),
    ("elephant", "refined_elephant"),
    ("asteroid_low", "asteroid_high"),
    ("cow_normalised", "triceratops_normalised"),
    ("housing", "housing_fine"),
    ("bunny", "bunny"),
)


class NotFetched(Exception):
    """Raised for a pair whose models were not fetched; the message names one and says how to fetch
    it."""


class Refused(Exception):
    """Raised when a command fails that should succeed; the message is its output."""


def run(*command: str, allowed: tuple[int, ...] = (0,)) -> subprocess.CompletedProcess[str]:
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    if done.returncode not in allowed:
        raise Refused(
            f"{' '.join(command)}: exit code {done.returncode}: {(done.stderr or done.stdout).strip()}"
        )
    return done


def false_claims(proof: Path, lower: float) -> Iterator[tuple[str, Path]]:
    """Yields two copies of the proof that claim slightly less than the true distance, so must be
    refused. The second is also a byte too short."""
    header, body = proof.read_bytes().rsplit(b"\nsha256 ", 1)[0].split(b"\n", 1)
    for name, content in (("number", body), ("end", body[:-1])):
        claim = json.loads(header)
        for certificate in claim["certificates"]:
            certificate["proven"] = lower * (1 - 1e-9)
        changed = proof.with_suffix(f".{name}")
        whole = json.dumps(claim).encode() + b"\n" + content
        changed.write_bytes(whole + f"\nsha256 {hashlib.sha256(whole).hexdigest()}\n".encode())
        yield name, changed


def check(program: str, solver: str, source: str, target: str, folder: Path) -> str:
    """Checks the proof of a pair and returns a line about it. Raises Refused if the proof is
    refused or a false claim is accepted, and NotFetched if a model is missing.
    """
    files = [folder / f"{number}.off" for number in range(2)]
    for model, file in zip((source, target), files):
        exported = run(program, "export", model, str(file), allowed=(0, 2))
        if exported.returncode:
            raise NotFetched(
                exported.stderr.strip()
            ) if " was not fetched: " in exported.stderr else Refused(exported.stderr.strip())
    proof = folder / "proof"
    answer = json.loads(
        run(
            program,
            "measure",
            *map(str, files),
            "--solver",
            solver,
            "--certificate",
            str(proof),
            "--json",
        ).stdout
    )
    before = time.perf_counter()
    run(program, "verify", "--certificate", str(proof))
    seconds = time.perf_counter() - before
    lower = float(answer["lower"])
    if lower > 0:
        for name, changed in false_claims(proof, lower):
            if (
                run(program, "verify", "--certificate", str(changed), allowed=(0, 1, 2)).returncode
                == 0
            ):
                raise Refused(f"{source} to {target}: accepted with a false claim ({name})")
    return (
        f"{solver}, {source} to {target}: {proof.stat().st_size / 2**20:.1f} MiB, accepted after {seconds:.2f} s"
        + (", false claims refused" if lower > 0 else "")
    )


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument(
        "--program",
        default=os.environ.get("HAUSBENCH_PROGRAM", str(ROOT / "build" / "release" / "hausbench")),
    )
    parser.add_argument("--solver", default="cover")
    parser.add_argument("--pairs", type=int, default=len(PAIRS), help="only the first N")
    chosen = parser.parse_args()
    if not Path(chosen.program).is_file():
        print(f"{chosen.program}: no such program: run 'make build'", file=sys.stderr)
        return 2
    wrong = skipped = 0
    for source, target in PAIRS[: chosen.pairs]:
        with tempfile.TemporaryDirectory() as folder:
            try:
                print(
                    check(chosen.program, chosen.solver, source, target, Path(folder)), flush=True
                )
            except NotFetched as missing:
                skipped += 1
                print(f"skipped: {source} to {target}: {missing}", flush=True)
            except Refused as problem:
                wrong += 1
                print(problem, file=sys.stderr, flush=True)
    tried = len(PAIRS[: chosen.pairs]) - skipped
    print(
        f"{tried - wrong} of {tried} pairs as they should be"
        + (f"; {skipped} skipped, whose models are missing" if skipped else "")
    )
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
