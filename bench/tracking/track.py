"""Tells whether solvers have become slower: work counters, instructions, then times beside an older build.

    hausbench track [--base REV] [--tiers counters,instructions,time] [--blocks N] [--case NAME ...]
    hausbench track --update REASON      a new baseline of counters and instructions, where a change is meant

Tier 1, counters: those of the tracked cases (experiments/tracking.toml) are what bench/tracking/baseline.toml says. Tier 2, instructions:
within half a per cent of it, under valgrind. Tier 3, time: the base (default: HEAD) is built in build/versions/COMMIT, and its
blocks are measured in turn with those of this build; it tests itself by each build beside itself and by a planted slowdown of 5 %.

Exit code 0: passed; 3: slower (or a baseline that no longer holds); 4: inconclusive, since the self-test of the times failed; 5: nothing
was measured, or the base does not build; 2: a mistake in the command. CONTRIBUTING.md says what to do then.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field
from datetime import datetime, timezone
from pathlib import Path

from analysis.shared.statistics import Estimate
from analysis.shared.tables import number
from bench.tracking import counted, timed
from bench.tracking.blocks import NotMeasured
from bench.tracking.builds import Build, NotBuilt, build_of, fetch, here
from bench.tracking.cases import KERNELS, ROOT, Case, cases, chosen
from bench.tracking.gate import LEAST, LEAST_BLOCKS, Judged, Verdict, verdict_of_times, whole

TIERS = ("counters", "instructions", "time")
PLANTED_IN = "guthe on mesh to its half"


@dataclass
class Report:
    """What each tier says, and what it is said of."""

    verdicts: dict[str, Verdict] = field(default_factory=dict)
    record: dict[str, object] = field(default_factory=dict)

    def add(self, tier: str, verdict: Verdict, lines: Sequence[str]) -> None:
        self.verdicts[tier] = verdict
        print(f"{tier}: {verdict.words}", flush=True)
        for line in lines:
            print(f"  {line}", flush=True)
        self.record[tier] = {"verdict": verdict.words, "lines": list(lines)}


def ratio_text(ratio: Estimate) -> str:
    return f"{ratio.value:.3f} [{ratio.low:.3f}, {ratio.high:.3f}]" if ratio.has_interval else "—"


def table(judged: Sequence[Judged]) -> list[str]:
    """Each case: its time, the ratio and what the blocks could have seen."""
    width = max(len(one.name) for one in judged)
    lines = [f"{'case':{width}}  {'base, ms':>9}  {'candidate / base':>22}  {'beside itself':>22}  sees"]
    for one in judged:
        word = "slower" if one.slower else "alarmed once" if one.alarms else "faster" if one.ratio.high < 1 - LEAST else ""
        lines.append(f"{one.name:{width}}  {number(1e3 * one.base_seconds):>9}  {ratio_text(one.ratio):>22}  {ratio_text(one.null):>22}  "
                     f"{100 * one.sees:.1f} %  {word}".rstrip())
        if one.planted.n:
            lines.append(f"{'  with 5 % planted':{width}}  {'':>9}  {ratio_text(one.planted):>22}")
    return lines


def time_tier(report: Report, given: argparse.Namespace, found: list[Case], folder: Path) -> None:
    candidate = here(given.program)
    if given.base_program is None:
        base = build_of(given.base)
        fetch(base.tree, {model for case in found for model in case.models})
    else:
        kernels = given.base_program.resolve().parent / "kernel_bench"
        base = Build(str(given.base_program), given.base_program.resolve(), kernels if kernels.is_file() else None)
    programs, kernel_programs = timed.programs_of(base, candidate)
    planted = PLANTED_IN if any(case.name == PLANTED_IN for case in found) else found[0].name
    subjects = [timed.of_case(case, programs, folder, case.name == planted) for case in found]
    if kernel_programs and not given.case:
        subjects.append(timed.of_kernels([kernel.name for kernel in KERNELS], kernel_programs, folder))
    lines: list[str] = []
    subjects = [subject for one in subjects if (subject := timed.known(one, lines.append))]
    report.record["base"], report.record["candidate"] = base.commit, candidate.commit
    if not subjects:
        report.add("time", Verdict.nothing_measured, lines)
        return
    try:
        judged, sides = timed.judge_all(subjects, given.blocks, lambda line: print(f"time: {line}", file=sys.stderr, flush=True))
    except NotMeasured as why:  # after each side has measured it once
        report.add("time", Verdict.inconclusive, [*lines, f"a block failed: {why}"])
        return
    verdict, reasons = verdict_of_times(judged)
    report.add("time", verdict, [*lines, *reasons, f"base {base.commit}, candidate {candidate.commit}, {given.blocks} blocks a side", *table(judged)])
    report.record["blocks"] = {name: asdict(found) for name, found in sides.items()}


def run_tiers(given: argparse.Namespace, found: list[Case], folder: Path) -> Report:
    report = Report()
    baseline = counted.read_baseline(given.baseline)
    update = given.update is not None
    counters, instructions = counted.Found(), counted.Found()
    if "counters" in given.tiers:
        counters = counted.count_work(found, given.program, baseline.get("counters", {}), folder)
        report.add("counters", counters.verdict, counters.lines)
    if "instructions" in given.tiers:
        kernels = given.program.parent / "kernel_bench"
        instructions = counted.count_instructions(found, () if given.case else KERNELS, given.program, kernels if kernels.is_file() else None,
                                                  baseline.get("instructions", {}), folder, update)
        report.add("instructions", instructions.verdict, instructions.lines)
    if update:
        counted.write_baseline(given.baseline, counted.updated(baseline, counters.measured, instructions.measured, given.update))
        print(f"{given.baseline}: written")
    elif "time" in given.tiers:
        time_tier(report, given, found, folder)
    return report


def tiers(text: str) -> list[str]:
    names = text.split(",")
    if unknown := [name for name in names if name not in TIERS]:
        raise argparse.ArgumentTypeError(f"there is no tier {unknown[0]!r}: {', '.join(TIERS)}")
    return names


def block_count(text: str) -> int:
    if not text.isdecimal() or int(text) < LEAST_BLOCKS or int(text) % 2:
        raise argparse.ArgumentTypeError(f"{text!r}: give an even number of blocks, at least {LEAST_BLOCKS}")
    return int(text)


def arguments(words: Sequence[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="hausbench track", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--base", default="HEAD", metavar="REV", help="commit to compare with (default: HEAD)")
    parser.add_argument("--base-program", type=Path, metavar="FILE", help="its program, if it is built already")
    parser.add_argument("--tiers", type=tiers, default=list(TIERS), metavar="T,T", help="of counters, instructions, time (default: all)")
    parser.add_argument("--blocks", type=block_count, default=36, metavar="N", help="of each side (default: 36)")
    parser.add_argument("--case", action="append", default=[], metavar="NAME", help="only cases whose names begin so; may be repeated")
    parser.add_argument("--update", metavar="REASON", help="write the baseline of counters and instructions, and why it changed; no times")
    parser.add_argument("--record", type=Path, default=ROOT / "results" / "tracking.json", metavar="FILE",
                        help="all that was measured (default: results/tracking.json)")
    program = os.environ.get("HAUSBENCH_PROGRAM", ROOT / "build/release/hausbench")
    parser.add_argument("--program", type=Path, default=Path(program), help=argparse.SUPPRESS)
    parser.add_argument("--baseline", type=Path, default=counted.BASELINE, help=argparse.SUPPRESS)
    return parser.parse_args(words)


def main(words: Sequence[str]) -> int:
    given = arguments(words)
    begun = time.monotonic()
    try:
        found = chosen(given.case, cases())
        given.program = given.program.resolve()
        if not given.program.is_file():
            raise NotBuilt(f"{given.program} is missing: make build")
        with tempfile.TemporaryDirectory(prefix="hausbench-track-") as folder:
            report = run_tiers(given, found, Path(folder))
    except ValueError as problem:
        print(f"track: {problem}", file=sys.stderr)
        return 2
    except (NotBuilt, counted.Missing) as problem:
        print(f"track: nothing measured: {problem}", file=sys.stderr)
        return Verdict.nothing_measured
    except KeyboardInterrupt:
        print("track: interrupted: no verdict", file=sys.stderr)
        return 130
    if given.update is not None:
        return 0
    verdict = whole(list(report.verdicts.values()))
    seconds = time.monotonic() - begun
    report.record |= {"verdict": verdict.words, "when": datetime.now(timezone.utc).isoformat(timespec="seconds"), "seconds": round(seconds, 1)}
    given.record.parent.mkdir(parents=True, exist_ok=True)
    given.record.write_text(json.dumps(report.record, indent=1) + "\n")
    print(f"track: {verdict.words} ({seconds:.0f} s)")
    return int(verdict)
