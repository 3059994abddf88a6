"""Tests the gate: runs it on builds with a known answer, and keeps its verdicts as a table.

    python3 -m bench.tracking.trials [--runs 10] [--load N] [KIND ...]

KIND is `unchanged` (this commit beside itself), `slower` (`kang` burns 5 % of the time of each solve) or `visit` (each query
counts one more node visit). The change is planted in a copy of this commit, in build/versions, and built. Runs accumulate in
results/reference/tracking_trials.jsonl, and the table is results/reference/tracking.md. Run it while nothing else of your own
runs; --load N keeps N cores busy on purpose. Other guests of a host cannot be controlled: the table shows how much they disturb a
short probe just before each run.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from analysis.shared.tables import Table, markdown
from bench.tracking import builds
from bench.tracking.blocks import measure
from bench.tracking.cases import ROOT, cases
from bench.tracking.gate import Verdict
from bench.tracking.history import this_machine

LOG = ROOT / "results" / "reference" / "tracking_trials.jsonl"
PROBE = "naive on points near"  # pure arithmetic, which load on the same core slows at once
PROBE_BLOCKS = 12
TABLE = ROOT / "results" / "reference" / "tracking.md"


@dataclass(frozen=True)
class Kind:
    """A planted change, its place, and the expected verdict of a tier. Without text, nothing is planted."""

    what: str
    expected: Verdict
    tier: str  # the tier that must give this verdict
    file: str = ""
    text: str = ""
    planted: str = ""
    where: str = ""  # a line of that tier must begin with this


KINDS = {
    "unchanged": Kind("nothing", Verdict.passed, "time"),
    "slower": Kind("`kang` burns 5 % of the time of each solve", Verdict.red, "time", "algorithms/session/session.cpp",
                   "    Result result = solver_->solve(asked, state, shows || trace.on() ? trace : unwatched);\n",
                   """    const auto clock = [] {
        timespec now{};
        ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
        return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
    };
    const double begun = clock();
    Result result = solver_->solve(asked, state, shows || trace.on() ? trace : unwatched);
    for (const double end = clock() + 0.05 * (clock() - begun); maker_->info().name == "kang" && clock() < end;) {}
""", "kang on mesh to its half: slower"),
    "visit": Kind("each query of a tree counts one node visit more", Verdict.red, "counters", "algorithms/structures/triangle_tree.cpp",
                  "    Walk walk(tree, leaves.leaf, point, counters.node_visits);\n",
                  "    ++counters.node_visits;\n    Walk walk(tree, leaves.leaf, point, counters.node_visits);\n"),
}


def planted(name: str, jobs: int) -> Path:
    """Builds the program with the plant, from this commit. Raises NotBuilt unless the text to replace occurs exactly once."""
    kind = KINDS[name]
    tree = builds.VERSIONS / f"planted_{name}"
    commit = builds.commit_of("HEAD")
    builds.worktree(tree, commit)
    file = tree / kind.file
    source = file.read_text()
    if source.count(kind.text) != 1:
        raise builds.NotBuilt(f"{kind.file} has {source.count(kind.text)} places for the plant {name!r}, and must have one")
    file.write_text(source.replace(kind.text, kind.planted))
    program = builds.build_in(tree, commit, jobs).program
    builds.fetch(tree, {model for case in cases() for model in case.models})
    return program


@contextmanager
def busy(cores: int) -> Iterator[None]:
    """Keeps this many cores busy inside the `with` block."""
    spinning = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(cores)]
    try:
        yield
    finally:
        for process in spinning:
            process.kill()
            process.wait()


def unrest(program: Path) -> float:
    """Returns how far the third quartile of short equal blocks is above the fastest, as a fraction: 0.01 on an idle machine."""
    probe = next(case for case in cases() if case.name == PROBE)
    with tempfile.TemporaryDirectory() as folder:
        seconds = [measure(program, probe, Path(folder)).cpu for _ in range(PROBE_BLOCKS)]
    return statistics.quantiles(seconds, n=4)[2] / min(seconds) - 1


def trial(name: str, program: Path, load: int) -> dict[str, Any]:
    """Runs the gate once, with HEAD as the base, and returns its verdicts."""
    found = unrest(program)
    with tempfile.TemporaryDirectory() as folder, busy(load):
        record = Path(folder) / "record.json"
        begun = time.monotonic()
        done = subprocess.run([sys.executable, "-m", "bench.tracking", "--program", str(program), "--base", "HEAD", "--record", str(record)],
                              cwd=ROOT, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, text=True, check=False)
        said = json.loads(record.read_text()) if record.is_file() else {}
    tiers = {tier: said[tier]["verdict"] for tier in ("counters", "instructions", "time") if tier in said}
    return {"kind": name, "load": load, "unrest": round(found, 3), "commit": builds.commit_of("HEAD"), "machine": this_machine(),
            "exit": done.returncode, "tiers": tiers, "seconds": round(time.monotonic() - begun), "lines": said.get("time", {}).get("lines", [])}


def right(one: dict[str, Any]) -> bool:
    """Returns whether the verdict is right. A quiet machine must give the expected verdict for the expected reason; a busy one
    may be inconclusive, too, but never give the opposite.
    """
    kind = KINDS[one["kind"]]
    said: str | None = one["tiers"].get(kind.tier)
    named = not kind.where or any(line.startswith(kind.where) for line in one["lines"])
    return (said == kind.expected.words and named) or bool(one["load"] and said == Verdict.inconclusive.words)


def table_of(trials: Sequence[dict[str, Any]]) -> str:
    """Returns a line for each run, and the number of right ones."""
    table = Table("Runs of `hausbench track` beside the same commit",
                  ["run", "planted", "cores kept busy", "unrest before", "commit", "counters", "instructions", "time", "exit code", "seconds",
                   "right"], left=3)
    for number, one in enumerate(trials, 1):
        tiers = [one["tiers"].get(tier, "—") for tier in ("counters", "instructions", "time")]
        table.rows.append([str(number), KINDS[one["kind"]].what, str(one["load"]), f"{100 * one['unrest']:.0f} %", one["commit"], *tiers,
                           str(one["exit"]), str(one["seconds"]), "yes" if right(one) else "no"])
    head = ["# Can the gate of timings be believed?", "",
            "Written by `python3 -m bench.tracking.trials`; not edited. Each run is a whole `hausbench track`; the tier that has to see what was",
            "planted is time for `kang`, and counters for the node visit. On a machine that is kept busy, `inconclusive` is also right.",
            f"Unrest: a quarter of {PROBE_BLOCKS} short blocks of one case, just before, were slower than the fastest by at least this.", "",
            f"- {'; '.join(sorted({one['machine'] for one in trials}))}"]
    for name in KINDS:
        for load in sorted({one["load"] for one in trials if one["kind"] == name}):
            some = [one for one in trials if one["kind"] == name and one["load"] == load]
            where = f", with {load} cores kept busy" if load else ""
            head.append(f"- planted: {KINDS[name].what}{where}: {sum(map(right, some))} of {len(some)} right")
    return "\n".join([*head, "", markdown(table), ""])


def main(words: Sequence[str]) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("kinds", nargs="*", metavar="KIND", help=", ".join(KINDS))
    parser.add_argument("--runs", type=int, default=10, help="of each kind (default: 10)")
    parser.add_argument("--load", type=int, default=0, help="cores to keep busy meanwhile (default: 0)")
    given = parser.parse_args(words)
    if unknown := [kind for kind in given.kinds if kind not in KINDS]:
        parser.error(f"there is no kind {unknown[0]}: {', '.join(KINDS)}")
    chosen = given.kinds or list(KINDS)
    here = Path(os.environ.get("HAUSBENCH_PROGRAM", ROOT / "build/release/hausbench"))
    programs = {name: planted(name, os.cpu_count() or 1) if KINDS[name].text else here for name in chosen}
    LOG.parent.mkdir(exist_ok=True)
    for number in range(given.runs):
        for name in chosen:
            one = trial(name, programs[name], given.load)
            print(f"{name} {number + 1}: exit {one['exit']}, {one['tiers']}, {one['seconds']} s{'' if right(one) else ': WRONG'}", flush=True)
            with LOG.open("a") as log:
                log.write(json.dumps(one) + "\n")
            TABLE.write_text(table_of([json.loads(line) for line in LOG.read_text().splitlines()]))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
