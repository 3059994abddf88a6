"""Runs every command in docs/tour.md, and compares the output with the page. `python3
tests/program/test_tour.py PROGRAM` rewrites the outputs on the page.
"""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
TOUR = ROOT / "docs" / "tour.md"
STEP = re.compile(r"```sh\n(.*?)```\n(?:\n```text\n(.*?)```\n)?", re.DOTALL)
MARK = "@@ step"


def walk(steps: list[str], build: Path, home: Path) -> list[str]:
    """Runs all steps in one shell, and returns the standard output of each."""
    script = (
        "".join(
            f"echo '{MARK} {number}'; date +%s.%N >> ~/times\n{step}"
            for number, step in enumerate(steps)
        )
        + f"echo '{MARK} end'\n"
    )
    script = script.replace("build/release", shlex.quote(str(build)))
    environment = {
        key: value for key, value in os.environ.items() if not key.startswith("HAUSBENCH")
    }
    environment |= {"HOME": str(home), "XDG_CACHE_HOME": str(home / "cache"), "COLUMNS": "120"}
    done = subprocess.run(
        ["bash", "-c", script],
        cwd=home,
        env=environment,
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0 and f"{MARK} end" in done.stdout, done.stderr
    return [piece.split("\n", 1)[1] for piece in done.stdout.split(MARK)[1:-1]]


def pattern(text: str) -> str:
    """Removes the parts of the output that depend on the machine: numbers, units of time and
    verdicts. Lines with distances stay as they are."""
    lines = []
    for line in text.splitlines():
        if line.startswith("not all of these times are comparable"):
            continue  # an external program that waits on a busy machine is timed by wall clock
        if not line.startswith(("distance", "witness")):
            line = re.sub(r"commit [0-9a-f]+( with changes)?", "commit", line)
            line = re.sub(r"[-+]?\d[\d.,]*(e[-+]?\d+)?", "#", line)
            line = re.sub(
                r"# (µs|ms|s|min)\b",
                "# s",
                re.sub(r"\b(slower|faster|not separated)\b", "VERDICT", line),
            )
        lines.append(" ".join(line.split()))
    return "\n".join(lines)


def test_every_command_and_what_it_prints(program_file: str, tmp_path: Path) -> None:
    steps = STEP.findall(TOUR.read_text())
    assert len(steps) > 8
    for (commands, shown), printed in zip(
        steps, walk([commands for commands, _ in steps], Path(program_file).parent, tmp_path)
    ):
        assert pattern(printed) == pattern(shown), commands


def test_a_change_of_what_is_shown_is_seen() -> None:
    assert pattern("rows 12  in 3.4 ms") == pattern("rows  7 in 81 µs")
    assert pattern("distance in [1.5, 2]") != pattern("distance in [1.5, 3]")
    assert pattern("guthe  ok") != pattern("guthe  failed")


def write(build: Path) -> None:
    text = TOUR.read_text()
    steps = [commands for commands, _ in STEP.findall(text)]
    with tempfile.TemporaryDirectory() as folder:
        outputs = iter(walk(steps, build, Path(folder)))
        home, times = str(folder), [
            float(line) for line in (Path(folder) / "times").read_text().split()
        ]

    def block(match: re.Match[str]) -> str:
        printed = next(outputs).replace(home, "~")
        return f"```sh\n{match[1]}```\n" + (f"\n```text\n{printed}```\n" if printed else "")

    TOUR.write_text(STEP.sub(block, text))
    print(
        "seconds of each step but the last:",
        *(f"{later - earlier:.1f}" for earlier, later in zip(times, times[1:])),
    )


if __name__ == "__main__":
    write(Path(sys.argv[1]).resolve().parent)
