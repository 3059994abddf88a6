"""`make experiments`: what fails does not stop the rest, and make fails in the end and names it."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

from conftest import ROOT

# Ends with the exit code that stands in the experiment file.
PROGRAM = """#!/bin/bash
echo "ran $2"
exit "$(cat "$2")"
"""
# Stands in for Python: notes which figures were asked for.
PYTHON = """#!/bin/bash
echo "$2" >> drawn
"""


def test_unsound_rows_are_drawn_named_and_a_failure(tmp_path: Path) -> None:
    shutil.copy(ROOT / "Makefile", tmp_path)
    (tmp_path / "packages.txt").write_text("")
    for name, text in (("program", PROGRAM), ("python", PYTHON)):
        (tmp_path / name).write_text(text)
        (tmp_path / name).chmod(0o755)

    def make(codes: dict[str, int]) -> tuple[int, str, list[str]]:
        for folder in ("experiments", "analysis"):
            shutil.rmtree(tmp_path / folder, ignore_errors=True)
            (tmp_path / folder).mkdir()
        for stem, code in codes.items():
            (tmp_path / "experiments" / f"{stem}.toml").write_text(str(code))
            (tmp_path / "analysis" / f"{stem}.py").write_text("")
        (tmp_path / "drawn").write_text("")
        done = subprocess.run(["make", "-o", "build", "SKIP_DEPS=1", "FETCH=true", f"HAUSBENCH_PROGRAM={tmp_path / 'program'}",
                               f"PYTHON={tmp_path / 'python'}", "experiments"], cwd=tmp_path, capture_output=True, text=True, timeout=60)
        assert done.stdout.count("ran ") == len(codes), done.stdout + done.stderr
        return done.returncode, done.stderr, (tmp_path / "drawn").read_text().split()

    code, said, drawn = make({"one": 0, "two": 0})
    assert code == 0 and drawn == ["analysis.one", "analysis.two"], said
    code, said, drawn = make({"bad": 2, "good": 0, "internal": 3, "wrong": 1})
    assert code == 2 and drawn == ["analysis.good", "analysis.wrong"]
    assert "failed: bad (run) internal (run) wrong (unsound rows)" in said
