"""Tells whether solvers have become slower: work counters, instructions, then times beside an older
build.

    hausbench track [--base REV] [--tiers counters,instructions,time] [--blocks N] [--case NAME ...]
    hausbench track --update REASON   a new baseline of counters and instructions, for an intended change

Tier 1, counters: the counters of the tracked cases (experiments/tracking.toml) equal
bench/tracking/baseline.toml. Tier 2, instructions: they are within half a per cent of the baseline,
under valgrind. Tier 3, time: the base (default: HEAD) is built in build/versions/COMMIT, and its
blocks are measured in pairs with blocks of this build, with more blocks for cases that look slower.
It tests itself with the base beside itself, whose times must alarm only if one side is multiplied
by 1.05.

Exit code 0: passed; 3: red: slower, or the baseline no longer holds; 4: inconclusive, because the
self-test of the times failed; 5: nothing was measured, or something broke; 2: a usage error.
CONTRIBUTING.md says what to do then.
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

from analysis.shared.estimates import Estimate
from analysis.shared.numerals import number
from bench.tracking import counted, progress, timed
from bench.tracking.blocks import NotMeasured
from bench.tracking.builds import VERSIONS, Build, NotBuilt, build_of, commit_of, fetch, here
from bench.tracking.cases import KERNELS, ROOT, Case, cases, chosen
from bench.tracking.gate import LEAST, SCREENING, Judged, Verdict, verdict_of_times, whole
from bench.tracking.places import Places
from bench.tracking.together import one_core

TIERS = ("counters", "instructions", "time")
BLOCKS = 48  # per side, for cases that look slower: shows 5 % if nine tenths of the pairs do
SELF_TEST = "kang on mesh to its half"  # the mesh solver whose pairs of blocks scatter least


@dataclass
class Report:
    """The verdict of each tier, and the measurements."""

    verdicts: dict[str, Verdict] = field(default_factory=dict)
    record: dict[str, object] = field(default_factory=dict)

    def add(self, tier: str, verdict: Verdict, lines: Sequence[str]) -> None:
        self.verdicts[tier] = verdict
        print(f"{tier}: {verdict.words}", flush=True)
        for line in lines:
            print(f"  {line}", flush=True)
        self.record[tier] = {"verdict": verdict.words, "lines": list(lines)}


@dataclass(frozen=True)
class Task:
    """The command line, the chosen cases, and a folder for temporary files."""

    given: argparse.Namespace
    cases: list[Case]
    folder: Path

    @property
    def kernel_program(self) -> Path | None:
        program = self.given.program.parent / "kernel_bench"
        return program if program.is_file() else None

    @property
    def kernels(self) -> bool:
        """Returns whether kernels are tracked; they are not if cases were chosen."""
        return not self.given.case


def ratio_text(ratio: Estimate) -> str:
    return f"{ratio.value:.3f} [{ratio.low:.3f}, {ratio.high:.3f}]" if ratio.has_interval else "—"


def table(judged: Sequence[Judged]) -> list[str]:
    """Returns a line for each case."""
    width = max(len(case.name) for case in judged)
    lines = [
        "shows: the smallest slowdown that would be an alarm after that many blocks",
        f"{'case':{width}}  {'base, ms':>9}  {'blocks':>6}  {'candidate / base':>22}  shows",
    ]
    for case in judged:
        word = (
            "red"
            if case.red
            else "an alarm that was not repeated"
            if case.alarms
            else "faster"
            if case.ratio.high < 1 - LEAST
            else ""
        )
        lines.append(
            f"{case.name:{width}}  {number(1e3 * case.base_seconds):>9}  {case.ratio.n:>6}  {ratio_text(case.ratio):>22}  "
            f"{100 * case.sees:.1f} %  {word}".rstrip()
        )
        if case.planted.n:
            lines.append(
                f"{'  the base beside itself':{width}}  {'':>9}  {case.itself.n:>6}  {ratio_text(case.itself):>22}"
            )
            lines.append(
                f"{'  with 5 % planted':{width}}  {'':>9}  {case.planted.n:>6}  {ratio_text(case.planted):>22}"
            )
        if case.second.n:
            lines.append(
                f"{'  in a second run':{width}}  {'':>9}  {case.second.n:>6}  {ratio_text(case.second):>22}"
            )
    return lines


def counters_tier(report: Report, task: Task) -> counted.Found:
    baseline = counted.read_baseline(task.given.baseline)
    outcome = counted.count_work(
        task.cases, task.given.program, baseline.get("counters", {}), task.folder
    )
    report.add("counters", outcome.verdict, outcome.lines)
    return outcome


def instructions_tier(report: Report, task: Task) -> counted.Found:
    baseline = counted.read_baseline(task.given.baseline)
    jobs = counted.jobs_of(
        task.cases,
        KERNELS if task.kernels else (),
        task.given.program,
        task.kernel_program,
        task.folder,
    )
    shapes = {name: table["shapes"] for name, table in baseline.get("counters", {}).items()}
    outcome = counted.count_instructions(
        jobs, baseline.get("instructions", {}), shapes, task.given.update is not None
    )
    missing = [
        "kernels: nothing measured: there is no kernel_bench next to the program: build it with 'make track'"
    ]
    report.add(
        "instructions",
        outcome.verdict,
        outcome.lines + (missing if task.kernels and task.kernel_program is None else []),
    )
    return outcome


def base_of(task: Task) -> Build:
    if task.given.base_program is not None:
        program: Path = task.given.base_program.resolve()
        kernels = program.parent / "kernel_bench"
        return Build(str(task.given.base_program), program, kernels if kernels.is_file() else None)
    base = build_of(task.given.base)
    fetch(base.tree, {model for case in task.cases for model in case.models})
    return base


def known_to_both(task: Task, base: Build, candidate: Build, places: Places) -> timed.Known:
    programs, kernel_programs = timed.programs_of(base, candidate), timed.kernels_of(
        base, candidate
    )
    common = timed.Known()
    for case in task.cases:
        common.add(timed.of_case(case, programs, task.folder, places))
    if task.kernels and kernel_programs:
        common.add(
            timed.of_kernels(
                [kernel.name for kernel in KERNELS], kernel_programs, task.folder, places
            )
        )
    elif task.kernels:
        common.left_out.append("kernels: left out, because one of the builds has no kernel_bench")
    return common


def time_tier(report: Report, task: Task) -> None:
    candidate, base = here(task.given.program), base_of(task)
    report.record |= {"base": base.commit, "candidate": candidate.commit}
    VERSIONS.mkdir(parents=True, exist_ok=True)  # /tmp may forbid running programs
    with tempfile.TemporaryDirectory(prefix="track-", dir=VERSIONS) as folder, one_core():
        common = known_to_both(task, base, candidate, Places(Path(folder)))
        notes = common.left_out + common.broken
        try:
            judged, runs = timed.judge_all(
                common, SELF_TEST, task.given.blocks, lambda line: progress.say("time", line)
            )
        except NotMeasured as why:  # although both sides could measure the case before
            report.add(
                "time",
                Verdict.red if common.broken else Verdict.inconclusive,
                [*notes, f"a block failed: {why}"],
            )
            return
    verdict, reasons = verdict_of_times(judged)
    many = f"{SCREENING} blocks per side, and up to {task.given.blocks} of cases that looked slower and of the self-test"
    lines = [*notes, *reasons, f"base {base.commit}, candidate {candidate.commit}, {many}"]
    report.add(
        "time", Verdict.red if common.broken else verdict, lines + (table(judged) if judged else [])
    )
    recorded = []
    for run in runs:
        recorded.append({name: asdict(sides) for name, sides in run.items()})
    report.record["runs"] = recorded


def update(task: Task, counters: counted.Found, instructions: counted.Found) -> None:
    """Writes the baseline, with new counts of all cases and kernels or of the chosen cases. Raises
    Missing if there are none."""
    small_scenes = {}
    if "counters" in task.given.tiers and not task.given.case:
        small_scenes = counted.count_small_scenes(
            task.given.program.parent / "tests" / "counters_test", task.folder
        )
    if not counters.measured and len(instructions.measured) < 2 and not small_scenes:
        raise counted.Missing("nothing was measured: the baseline is unchanged")
    names: set[str] | None = None
    if not task.given.case:
        names = {case.name for case in task.cases}
        names.update(kernel.name for kernel in KERNELS)
    baseline = counted.read_baseline(task.given.baseline)
    counted.write_baseline(
        task.given.baseline,
        counted.updated(
            baseline,
            counters.measured,
            instructions.measured,
            task.given.update,
            names,
            small_scenes,
        ),
    )
    print(f"{task.given.baseline}: written")


def attempt(report: Report, tier: str, work: Callable[[], counted.Found | None]) -> counted.Found:
    """Runs a tier. Reports an error instead of raising it, so that the other tiers still run."""
    try:
        return work() or counted.Found()
    except (NotBuilt, counted.Missing) as why:
        report.add(tier, Verdict.nothing_measured, [str(why)])
    except (
        Exception
    ) as problem:  # the harness failed: report the kind of error; the verdicts of the other tiers count
        report.add(tier, Verdict.nothing_measured, [f"{type(problem).__name__}: {problem}"])
    return counted.Found()


def run_tiers(task: Task) -> Report:
    report, given = Report(), task.given
    counters, instructions = counted.Found(), counted.Found()
    if "counters" in given.tiers:
        counters = attempt(report, "counters", lambda: counters_tier(report, task))
    if "instructions" in given.tiers:
        instructions = attempt(report, "instructions", lambda: instructions_tier(report, task))
    if given.update is not None:
        update(task, counters, instructions)
    elif "time" in given.tiers:
        attempt(report, "time", lambda: time_tier(report, task))
    return report


def tiers(text: str) -> list[str]:
    names = text.split(",")
    if unknown := [name for name in names if name not in TIERS]:
        raise argparse.ArgumentTypeError(f"there is no tier {unknown[0]!r}: {', '.join(TIERS)}")
    return names


def block_count(text: str) -> int:
    if not text.isdecimal() or int(text) < SCREENING or int(text) % 2:
        raise argparse.ArgumentTypeError(
            f"{text!r}: give an even number of blocks, at least {SCREENING}"
        )
    return int(text)


def arguments(words: Sequence[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="hausbench track",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "--base", default="HEAD", metavar="REV", help="commit to compare with (default: HEAD)"
    )
    parser.add_argument(
        "--base-program", type=Path, metavar="FILE", help="its program, if it is built already"
    )
    parser.add_argument(
        "--tiers",
        type=tiers,
        default=list(TIERS),
        metavar="T,T",
        help="some of counters, instructions, time (default: all)",
    )
    parser.add_argument(
        "--blocks",
        type=block_count,
        default=BLOCKS,
        metavar="N",
        help=f"the most blocks per side, for cases that look slower after {SCREENING} (default: {BLOCKS})",
    )
    parser.add_argument(
        "--case",
        action="append",
        default=[],
        metavar="NAME",
        help="only cases whose names begin with this; may be repeated",
    )
    parser.add_argument(
        "--update",
        metavar="REASON",
        help="write the baseline of counters (small scenes included) and instructions, with the reason; "
        "measure no times",
    )
    parser.add_argument(
        "--record",
        type=Path,
        default=ROOT / "results" / "tracking.json",
        metavar="FILE",
        help="file for all measurements (default: results/tracking.json)",
    )
    program = os.environ.get("HAUSBENCH_PROGRAM", ROOT / "build/release/hausbench")
    parser.add_argument("--program", type=Path, default=Path(program), help=argparse.SUPPRESS)
    parser.add_argument("--baseline", type=Path, default=counted.BASELINE, help=argparse.SUPPRESS)
    given = parser.parse_args(words)
    if given.update is not None and given.tiers == ["time"]:
        parser.error("--update is for counters and instructions: leave out --tiers time")
    return given


def task_of(given: argparse.Namespace, folder: Path) -> Task:
    """Makes the task. Raises ValueError if something requested does not exist."""
    selected = chosen(given.case, cases())
    given.program = given.program.resolve()
    programs: list[Path | None] = [given.program, given.base_program]
    for program in programs:
        if program and not program.is_file():
            raise ValueError(f"{program} is missing: build it with 'make build'")
    if "time" in given.tiers and given.update is None and given.base_program is None:
        try:
            commit_of(given.base)
        except NotBuilt as why:
            raise ValueError(f"--base {given.base}: there is no such commit here ({why})") from None
    return Task(given, selected, folder)


def main(words: Sequence[str]) -> int:
    given = arguments(words)
    begun = time.monotonic()
    try:
        with tempfile.TemporaryDirectory(prefix="hausbench-track-") as folder:
            try:
                task = task_of(given, Path(folder))
            except ValueError as problem:
                print(f"track: {problem}", file=sys.stderr)
                return 2
            report = run_tiers(task)
    except counted.Missing as problem:
        print(f"track: nothing measured: {problem}", file=sys.stderr)
        return Verdict.nothing_measured
    except KeyboardInterrupt:
        print("track: interrupted: no verdict", file=sys.stderr)
        return 130
    if given.update is not None:
        return 0
    verdict, seconds = whole(list(report.verdicts.values())), time.monotonic() - begun
    report.record |= {
        "verdict": verdict.words,
        "when": datetime.now(timezone.utc).isoformat(timespec="seconds"),
        "seconds": round(seconds, 1),
    }
    try:
        given.record.parent.mkdir(parents=True, exist_ok=True)
        given.record.write_text(json.dumps(report.record, indent=1) + "\n")
    except OSError as problem:
        print(f"track: {given.record}: {problem.strerror}: not written", file=sys.stderr)
    print(f"track: {verdict.words} ({seconds:.0f} s)")
    return int(verdict)
