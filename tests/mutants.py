"""Plants each mutant of tests/mutants.toml in a copy of the tree, and expects its test to fail.

    python3 tests/mutants.py [--list] [PATTERN ...]

A mutant lacks one term of a bound, or one check. If its test still passes, no test covers that term: write a test, or
remove the term. PATTERN selects the entries whose name or file contains it (* and ? work as in file names). The copy is
build/mutants in the tree; its build folder is reused. Exit code 1: some mutant was not caught.
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
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
LIST = "tests/mutants.toml"
TEST_SECONDS = 600


@dataclass(frozen=True)
class Mutant:
    name: str
    file: str
    text: str
    plant: str
    test: str
    filter: str = ""

    @property
    def is_pytest(self) -> bool:
        return self.test.startswith("pytest ")

    @property
    def targets(self) -> list[str]:
        """The targets to build. Empty if the test needs only Python."""
        if not self.is_pytest:
            return [self.test]
        program = self.file.endswith((".cpp", ".h")) or self.test.startswith("pytest tests/program")
        return ["hausbench", "hausbench_commit"] if program else []


class BadEntry(Exception):
    """An entry that cannot be planted or run; the message names it."""


def read(root: Path) -> list[Mutant]:
    fields = set(Mutant.__dataclass_fields__)
    mutants: list[Mutant] = []
    for entry in tomllib.loads((root / LIST).read_text()).get("mutant", []):
        name = entry.get("name", "without a name")
        if unknown := set(entry) - fields:
            raise BadEntry(f"{LIST}: {name}: unknown key {sorted(unknown)[0]}")
        if missing := fields - set(entry) - {"filter"}:
            raise BadEntry(f"{LIST}: {name}: {sorted(missing)[0]} is missing")
        if any(name == other.name for other in mutants):
            raise BadEntry(f"{LIST}: {name}: two entries have this name")
        mutants.append(Mutant(**entry))
    return mutants


def place(mutant: Mutant, source: str) -> tuple[int, int]:
    """Returns the span of the mutant's text in the source. Any white space matches any other, so reformatting does no harm."""
    found = [m.span() for m in re.finditer(r"\s+".join(map(re.escape, mutant.text.split())), source)]
    if len(found) != 1:
        times = f"found {len(found)} times, and must be unique" if found else "not found"
        raise BadEntry(f"{LIST}: {mutant.name}: its text is {times} in {mutant.file}")
    return found[0]


def planted(mutant: Mutant, root: Path) -> str:
    """Returns the source file's text with the mutant in place."""
    path = root / mutant.file
    if not path.is_file():
        raise BadEntry(f"{LIST}: {mutant.name}: there is no file {mutant.file}")
    source = path.read_text()
    begin, end = place(mutant, source)
    changed = source[:begin] + mutant.plant + source[end:]
    if changed == source:
        raise BadEntry(f"{LIST}: {mutant.name}: the plant is the text itself")
    return changed


def not_plantable(root: Path, mutants: list[Mutant]) -> list[str]:
    """Returns an error for each mutant whose text does not occur exactly once or whose test does not exist."""
    tests = re.findall(r"^hausbench_test\((?:\w+/)*(\w+)", (root / "tests/CMakeLists.txt").read_text(), re.M)
    wrong = []
    for mutant in mutants:
        try:
            planted(mutant, root)
            if not ((root / mutant.test.split()[1].split("::")[0]).is_file() if mutant.is_pytest else mutant.test in tests):
                raise BadEntry(f"{LIST}: {mutant.name}: there is no test {mutant.test}")
        except BadEntry as error:
            wrong.append(str(error))
    return wrong


def copy_tree(root: Path, copy: Path) -> None:
    """Copies all files that git tracks or would add, except unchanged ones, so that little is rebuilt."""
    listed = subprocess.run(["git", "-C", root, "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
                            check=True, capture_output=True, text=True).stdout
    files = {name for name in listed.split("\0") if name and (root / name).is_file()}
    for name in files:
        new, old = (root / name).read_bytes(), copy / name
        if not old.is_file() or old.read_bytes() != new:
            old.parent.mkdir(parents=True, exist_ok=True)
            old.write_bytes(new)
            shutil.copymode(root / name, old)
    for folder, folders, names in os.walk(copy):
        if Path(folder) == copy and "build" in folders:
            folders.remove("build")
        for old in (Path(folder) / name for name in names):
            if str(old.relative_to(copy)) not in files:
                old.unlink()


class Tree:
    """The copy of the tree, with its build folder."""

    def __init__(self, root: Path, jobs: int):
        self.folder = root / "build" / "mutants"
        self.build_folder = self.folder / "build" / "release"
        self.jobs = jobs
        copy_tree(root, self.folder)

    def run(self, command: list[str]) -> subprocess.CompletedProcess[str]:
        environment = dict(os.environ, HAUSBENCH_PROGRAM=str(self.build_folder / "hausbench"), HAUSBENCH_SEARCHES="all", CCACHE_BASEDIR=str(self.folder))
        return subprocess.run(command, cwd=self.folder, env=environment, timeout=TEST_SECONDS if command[0] != "cmake" else None,
                              stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace")

    def build(self, targets: list[str]) -> str:
        """Builds the targets. Returns the output of a failed build, else an empty string."""
        if not targets:
            return ""
        if not (self.build_folder / "build.ninja").is_file():
            launcher = ["-DCMAKE_CXX_COMPILER_LAUNCHER=ccache"] if shutil.which("ccache") else []
            # without unity builds, a mutant recompiles a single file
            configured = self.run(["cmake", "--preset", "release", "-DCMAKE_UNITY_BUILD=OFF", *launcher])
            if configured.returncode != 0:
                return configured.stdout
        built = self.run(["cmake", "--build", "--preset", "release", "-j", str(self.jobs), "--target", *targets])
        return built.stdout if built.returncode != 0 else ""

    def test(self, mutant: Mutant) -> tuple[str, str]:
        """Runs the mutant's test; returns `green`, `red` or `none` (no test ran), and the output."""
        try:
            if mutant.is_pytest:
                done = self.run([sys.executable, "-B", "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider", *mutant.test.split()[1:]])
                return {0: "green", 1: "red"}.get(done.returncode, "none"), done.stdout
            done = self.run([str(self.build_folder / "tests" / mutant.test), f"--gtest_filter={mutant.filter or '*'}"])
        except subprocess.TimeoutExpired:
            return "red", f"the test ran longer than {TEST_SECONDS} s"
        if done.returncode != 0:
            return "red", done.stdout
        return ("none" if "[  PASSED  ] 0 tests" in done.stdout else "green"), done.stdout


def last_lines(text: str, lines: int = 12) -> str:
    return "".join(f"    {line}\n" for line in text.strip().splitlines()[-lines:])


def check_unmutated(tree: Tree, mutants: list[Mutant]) -> None:
    """Runs each test once without a mutant, because a test that fails anyway proves nothing."""
    targets = sorted({target for mutant in mutants for target in mutant.targets})
    print(f"without a mutant: building {' '.join(targets) or 'nothing'}", flush=True)
    if wrong := tree.build(targets):
        raise BadEntry(f"the tree does not build without a mutant\n{last_lines(wrong)}")
    for test, chosen, mutant in sorted({(m.test, m.filter): (m.test, m.filter, m) for m in mutants}.values(), key=lambda t: t[:2]):
        verdict, output = tree.test(mutant)
        if verdict != "green":
            what = "fails without a mutant" if verdict == "red" else "runs no test; is its filter right?"
            raise BadEntry(f"{LIST}: {mutant.name}: {test} {chosen} {what}\n{last_lines(output)}")


def try_one(tree: Tree, mutant: Mutant) -> tuple[str, str]:
    """Returns the verdict on a mutant (`caught`, `survived` or `broken`) and a remark. Restores the copy afterwards."""
    path = tree.folder / mutant.file
    original = path.read_text()
    path.write_text(planted(mutant, tree.folder))
    try:
        if wrong := tree.build(mutant.targets):
            return "broken", f"it does not build, which is no catch\n{last_lines(wrong)}"
        verdict, output = tree.test(mutant)
    finally:
        path.write_text(original)  # the new time stamp makes the next build restore it
    if verdict == "none":
        return "broken", f"no test ran, which is no catch\n{last_lines(output)}"
    return ("caught", "") if verdict == "red" else ("survived", f"{mutant.test} {mutant.filter} stays green")


def chosen(mutants: list[Mutant], patterns: list[str]) -> list[Mutant]:
    def fits(mutant: Mutant) -> bool:
        return any(fnmatch.fnmatch(text.lower(), f"*{pattern.lower()}*") for pattern in patterns for text in (mutant.name, mutant.file))

    return [mutant for mutant in mutants if not patterns or fits(mutant)]


def run(root: Path, mutants: list[Mutant], jobs: int) -> int:
    if wrong := not_plantable(root, mutants):
        raise BadEntry("\nmutants: ".join(wrong))
    tree = Tree(root, jobs)
    check_unmutated(tree, mutants)
    counts = {"caught": 0, "survived": 0, "broken": 0}
    begin = time.monotonic()
    # Mutants of a file follow each other, so that the file is compiled once per mutant, not twice.
    for i, mutant in enumerate(sorted(mutants, key=lambda m: (m.file, m.test))):
        verdict, remark = try_one(tree, mutant)
        counts[verdict] += 1
        left = (time.monotonic() - begin) / (i + 1) * (len(mutants) - i - 1) / 60
        print(f"[{i + 1}/{len(mutants)}] {verdict:8} {mutant.file}: {mutant.name}{': ' + remark if remark else ''}"
              f"  (about {left:.0f} min left)", flush=True)
    print(f"{counts['caught']} caught, {counts['survived']} survived" + (f", {counts['broken']} broken" if counts["broken"] else ""))
    return 0 if counts["caught"] == len(mutants) else 1


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("patterns", nargs="*", metavar="PATTERN")
    parser.add_argument("--list", action="store_true", help="print the entries; run nothing")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="compilers at a time")
    parser.add_argument("--tree", type=Path, default=ROOT, help="default: the one that this file is in")
    options = parser.parse_args(arguments)
    try:
        mutants = chosen(read(options.tree), options.patterns)
        if not mutants:
            raise BadEntry(f"{LIST} has no entry whose name or file contains {' or '.join(options.patterns)}")
        if options.list:
            for mutant in mutants:
                print(f"{mutant.file}: {mutant.name}  ({mutant.test}{' ' + mutant.filter if mutant.filter else ''})")
            return 0
        return run(options.tree.resolve(), mutants, options.jobs)
    except BadEntry as error:
        print(f"mutants: {error}", file=sys.stderr)
        return 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
