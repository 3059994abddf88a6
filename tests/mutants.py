"""Switches off each term that tests/mutants.toml lists, and expects its test to fail.

    python3 tests/mutants.py [--list] [PATTERN ...]

A switch (algorithms/kernel/watched.h) leaves out one term of a bound, or one check. If its test
still passes, no test covers that term: write a test, or remove the term. PATTERN selects the
entries whose name or file contains it (* and ? work as in file names). Builds the tests once, in
build/mutants. Exit code 1: the test of some switch did not fail.
"""

from __future__ import annotations

import argparse
import fnmatch
import os
import re
import shutil
import subprocess
import sys
import time
import tomllib
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
LIST = "tests/mutants.toml"
SWITCH = re.compile(r'\bWATCHED(?:_ELSE)?\(\s*"((?:\\.|[^"\\])*)"')
TEST_SECONDS = 600  # without a switch
# A test with a switch may take so many times as long as without, and SPARE_SECONDS more.
SLOWER = 10
SPARE_SECONDS = 20


@dataclass(frozen=True)
class Mutant:
    name: str
    test: str  # a C++ test program, or "pytest FILE::TEST"
    filter: str = ""  # for --gtest_filter
    files: tuple[str, ...] = ()  # where its switches are

    @property
    def is_pytest(self) -> bool:
        return self.test.startswith("pytest ")

    @property
    def targets(self) -> list[str]:
        return ["hausbench", "hausbench_commit"] if self.is_pytest else [self.test]


class BadEntry(Exception):
    """An entry that has no switch or test, or whose test fails anyway; the message names it."""


def switches(root: Path) -> dict[str, tuple[str, ...]]:
    """Returns the files of each switch in the sources, by name."""
    files_of: dict[str, set[str]] = {}
    listed = subprocess.run(
        [
            "git",
            "-C",
            root,
            "ls-files",
            "--cached",
            "--others",
            "--exclude-standard",
            "*.cpp",
            "*.h",
        ],
        check=True,
        capture_output=True,
        text=True,
    ).stdout
    for file in listed.split("\n"):
        if file and not file.endswith("kernel/watched.h") and (root / file).is_file():
            for name in SWITCH.findall((root / file).read_text()):
                files_of.setdefault(name.replace('\\"', '"'), set()).add(file)
    return {name: tuple(sorted(files)) for name, files in files_of.items()}


def read(root: Path) -> list[Mutant]:
    """Returns the entries. Raises BadEntry if one is wrong, or if a switch has no entry."""
    files_of = switches(root)
    tests = re.findall(
        r"^hausbench_test\((?:\w+/)*(\w+)", (root / "tests/CMakeLists.txt").read_text(), re.M
    )
    mutants: list[Mutant] = []
    wrong = []
    for entry in tomllib.loads((root / LIST).read_text()).get("mutant", []):
        name = entry.get("name", "without a name")
        if unknown := set(entry) - {"name", "test", "filter"}:
            wrong.append(f"{name}: unknown key {sorted(unknown)[0]}")
        elif missing := {"name", "test"} - set(entry):
            wrong.append(f"{name}: {sorted(missing)[0]} is missing")
        elif any(name == earlier.name for earlier in mutants):
            wrong.append(f"{name}: two entries have this name")
        elif name not in files_of:
            wrong.append(f"{name}: no source has a switch of this name")
        else:
            mutant = Mutant(**entry, files=files_of[name])
            mutants.append(mutant)
            if not (
                (root / mutant.test.split()[1].split("::")[0]).is_file()
                if mutant.is_pytest
                else mutant.test in tests
            ):
                wrong.append(f"{name}: there is no test {mutant.test}")
    listed = {mutant.name for mutant in mutants}
    wrong += [
        f"{name}: has a switch in {files_of[name][0]}, but no entry"
        for name in sorted(set(files_of) - listed)
    ]
    if wrong:
        raise BadEntry("\n".join(f"{LIST}: {line}" for line in wrong))
    return mutants


@dataclass(frozen=True)
class Tests:
    """The tests, in the build folder of the preset `mutants`."""

    root: Path
    jobs: int

    @property
    def folder(self) -> Path:
        return self.root / "build" / "mutants"

    def build(self, targets: list[str]) -> None:
        """Builds the targets. Raises BadEntry with the end of the compiler's output if they do not
        build."""
        launcher = ["-DCMAKE_CXX_COMPILER_LAUNCHER=ccache"] if shutil.which("ccache") else []
        commands = (
            []
            if (self.folder / "build.ninja").is_file()
            else [["cmake", "--preset", "mutants", *launcher]]
        )
        for command in [
            *commands,
            ["cmake", "--build", "--preset", "mutants", "-j", str(self.jobs), "--target", *targets],
        ]:
            done = subprocess.run(
                command,
                cwd=self.root,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                text=True,
                check=False,
            )
            if done.returncode != 0:
                raise BadEntry(f"the tests do not build\n{last_lines(done.stdout)}")

    def run(self, mutant: Mutant, off: bool, seconds: float) -> tuple[str, str]:
        """Runs the test of an entry, with its switch off or on; returns `green`, `red` or `none`
        (no test ran), and the output."""
        environment = dict(
            os.environ, HAUSBENCH_PROGRAM=str(self.folder / "hausbench"), HAUSBENCH_SEARCHES="all"
        )
        environment |= {"HAUSBENCH_MUTANT": mutant.name} if off else {}
        command = [
            str(self.folder / "tests" / mutant.test),
            f"--gtest_filter={mutant.filter or '*'}",
        ]
        if mutant.is_pytest:
            command = [
                sys.executable,
                "-B",
                "-m",
                "pytest",
                "-q",
                "-x",
                "-p",
                "no:cacheprovider",
                *mutant.test.split()[1:],
            ]
        try:
            done = subprocess.run(
                command,
                cwd=self.root,
                env=environment,
                timeout=seconds,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                text=True,
                errors="replace",
                check=False,
            )
        except subprocess.TimeoutExpired:
            return "red", f"the test ran longer than {seconds:.0f} s"
        if mutant.is_pytest:
            return {0: "green", 1: "red"}.get(done.returncode, "none"), done.stdout
        if done.returncode != 0:
            return "red", done.stdout
        return ("none" if "[  PASSED  ] 0 tests" in done.stdout else "green"), done.stdout


def last_lines(text: str, lines: int = 12) -> str:
    return "".join(f"    {line}\n" for line in text.strip().splitlines()[-lines:])


Test = tuple[str, str]  # the test and the filter of an entry


def seconds_without(tests: Tests, mutants: list[Mutant]) -> dict[Test, float]:
    """Runs each test once without a switch, because a test that fails anyway proves nothing;
    returns how long each took."""

    def run(mutant: Mutant) -> float:
        begin = time.monotonic()
        verdict, output = tests.run(mutant, False, TEST_SECONDS)
        if verdict != "green":
            fault = (
                "fails without a switch"
                if verdict == "red"
                else "runs no test; is its filter right?"
            )
            raise BadEntry(
                f"{LIST}: {mutant.name}: {mutant.test} {mutant.filter} {fault}\n"
                + last_lines(output)
            )
        return time.monotonic() - begin

    different = {(mutant.test, mutant.filter): mutant for mutant in mutants}
    with ThreadPoolExecutor(tests.jobs) as pool:
        return dict(zip(different, pool.map(run, different.values())))


def verdicts(
    tests: Tests, mutants: list[Mutant], without: dict[Test, float]
) -> Iterator[tuple[Mutant, str, str]]:
    """Yields each entry with its verdict (`caught`, `survived` or `broken`) and a remark, as they
    end."""
    with ThreadPoolExecutor(tests.jobs) as pool:
        running = {}
        for mutant in mutants:
            seconds = SLOWER * without[mutant.test, mutant.filter] + SPARE_SECONDS
            running[pool.submit(tests.run, mutant, True, seconds)] = mutant
        for ended in as_completed(running):
            mutant, (verdict, output) = running[ended], ended.result()
            if verdict == "none":
                yield mutant, "broken", f"no test ran\n{last_lines(output)}"
            elif verdict == "red":
                yield mutant, "caught", ""
            else:
                yield mutant, "survived", f"{mutant.test} {mutant.filter} passes without it"


def chosen(mutants: list[Mutant], patterns: list[str]) -> list[Mutant]:
    def fits(mutant: Mutant) -> bool:
        texts = (mutant.name, *mutant.files)
        return any(
            fnmatch.fnmatch(text.lower(), f"*{pattern.lower()}*")
            for pattern in patterns
            for text in texts
        )

    return [mutant for mutant in mutants if not patterns or fits(mutant)]


def run(root: Path, mutants: list[Mutant], jobs: int) -> int:
    begin = time.monotonic()
    tests = Tests(root, jobs)
    tests.build(sorted({target for mutant in mutants for target in mutant.targets}))
    built = time.monotonic()
    without = seconds_without(tests, mutants)
    counts = {"caught": 0, "survived": 0, "broken": 0}
    for i, (mutant, verdict, remark) in enumerate(verdicts(tests, mutants, without)):
        counts[verdict] += 1
        if verdict != "caught" or (i + 1) % 50 == 0:
            print(
                f"[{i + 1}/{len(mutants)}] {verdict:8} {mutant.files[0]}: {mutant.name}{': ' + remark if remark else ''}",
                flush=True,
            )
    print(
        f"{counts['caught']} caught, {counts['survived']} survived"
        + (f", {counts['broken']} broken" if counts["broken"] else "")
        + f"; built in {built - begin:.0f} s, ran in {time.monotonic() - built:.0f} s"
    )
    return 0 if counts["caught"] == len(mutants) else 1


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("patterns", nargs="*", metavar="PATTERN")
    parser.add_argument("--list", action="store_true", help="print the entries; run nothing")
    parser.add_argument(
        "--jobs", type=int, default=os.cpu_count() or 1, help="compilers and tests at a time"
    )
    parser.add_argument(
        "--tree", type=Path, default=ROOT, help="default: the one that this file is in"
    )
    options = parser.parse_args(arguments)
    try:
        mutants = chosen(read(options.tree), options.patterns)
        if not mutants:
            raise BadEntry(
                f"{LIST} has no entry whose name or file contains {' or '.join(options.patterns)}"
            )
        if options.list:
            for mutant in mutants:
                print(
                    f"{mutant.files[0]}: {mutant.name}  ({mutant.test}{' ' + mutant.filter if mutant.filter else ''})"
                )
            return 0
        return run(options.tree.resolve(), mutants, options.jobs)
    except BadEntry as error:
        print(f"mutants: {error}", file=sys.stderr)
        return 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
