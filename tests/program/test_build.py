"""How the program is compiled: directed rounding where bounds depend on it, and every flag in the result."""

from __future__ import annotations

import json
import re
import shlex
import subprocess
from pathlib import Path

import h5py
import pytest

from conftest import ROOT, Program
from test_run import run

FOLDERS = ("algorithms", "datasets", "harness")


def test_interval_arithmetic_refuses_a_compiler_that_moves_it(tmp_path: Path) -> None:
    source = tmp_path / "uses_intervals.cpp"
    source.write_text('#include "kernel/interval.h"\n')
    compile_it = ["c++", "-std=c++20", "-fsyntax-only", "-I", str(ROOT / "algorithms"), str(source)]
    without = subprocess.run(compile_it, capture_output=True, text=True)
    assert without.returncode != 0 and "compile with -frounding-math" in without.stderr
    with_it = subprocess.run([*compile_it, "-frounding-math"], capture_output=True, text=True)
    assert with_it.returncode == 0, with_it.stderr


def test_sources_with_directed_rounding_are_named() -> None:
    listed = re.search(r"set_source_files_properties\(([^)]*)PROPERTIES COMPILE_OPTIONS \"\$\{HAUSBENCH_DIRECTED_ROUNDING\}\"",
                       (ROOT / "CMakeLists.txt").read_text())
    assert listed
    named = set(listed[1].split())
    rounding = re.compile(r"\b(UpwardRounding|Protect_FPU_rounding|fesetround|FE_UPWARD|Interval)\b")
    for folder in FOLDERS:
        for file in (ROOT / folder).rglob("*.cpp"):
            code = re.sub(r"//.*", "", file.read_text())
            if rounding.search(code):
                assert str(file.relative_to(ROOT)) in named, file


def test_meta_has_every_flag_of_every_source(hausbench: Program, program_file: str, experiment: Path, tmp_path: Path) -> None:
    commands = Path(program_file).parent / "compile_commands.json"
    if not commands.exists():
        pytest.skip("the program was not built here")
    with h5py.File(run(hausbench, experiment, tmp_path)) as f:
        flags = dict(part.split(": ", 1) for part in f["meta"].attrs["flags"].split("; "))
    seen = set()
    for command in json.loads(commands.read_text()):
        file = str(Path(command["file"]).relative_to(ROOT))
        if not file.startswith(FOLDERS):
            continue
        given = {a for a in shlex.split(command["command"])[1:] if re.match(r"-(?!I|isystem$|o$|c$|M)", a)}
        assert given == set(flags.get(file, flags[file.split("/")[0]]).split()), file
        seen.add(file)
    assert len(seen) > 50 and "-ffp-contract=off" in flags["algorithms"] and "-frounding-math" in flags["harness"]
