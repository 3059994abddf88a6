"""Compiler flags: code with proven bounds is compiled for directed rounding, and results record
every flag."""

from __future__ import annotations

import json
import re
import shlex
import subprocess
from pathlib import Path

import h5py
import pytest

from program import ROOT, Program
from test_run import run

LIBRARIES = ("kernel", "algorithms", "readers", "datasets", "ask", "checker", "verify", "harness")


def library_of(command: dict[str, str]) -> str:
    """Returns the library that a compile command belongs to, or an empty string."""
    target = re.search(r" -o \S*CMakeFiles/hausbench_([a-z]+)\.dir/", command["command"])
    return target[1] if target and target[1] in LIBRARIES else ""


def test_interval_arithmetic_refuses_a_compiler_that_moves_it(tmp_path: Path) -> None:
    source = tmp_path / "uses_intervals.cpp"
    source.write_text('#include "algorithms/kernel/interval.h"\n')
    compile_it = ["c++", "-std=c++20", "-fsyntax-only", "-I", str(ROOT), str(source)]
    without = subprocess.run(compile_it, capture_output=True, text=True)
    assert without.returncode != 0 and "compile with -frounding-math" in without.stderr
    with_it = subprocess.run([*compile_it, "-frounding-math"], capture_output=True, text=True)
    assert with_it.returncode == 0, with_it.stderr


def test_libraries_with_directed_rounding_are_compiled_for_it(program_file: str) -> None:
    commands = Path(program_file).parent / "compile_commands.json"
    if not commands.exists():
        pytest.skip("the program was not built here")
    for command in json.loads(commands.read_text()):
        if library_of(command):
            assert "-frounding-math" in shlex.split(command["command"]), command["file"]


def test_the_program_does_not_load_libhwy(program_file: str) -> None:
    """libhwy's initialiser measures a timer that some virtual machines hide; under valgrind the
    program then ends before main()."""
    done = subprocess.run(
        ["readelf", "--dynamic", program_file], capture_output=True, text=True, check=True
    )
    assert "(NEEDED)" in done.stdout and "libhwy" not in done.stdout


def test_meta_has_every_flag_of_every_source(
    hausbench: Program, program_file: str, experiment: Path, tmp_path: Path
) -> None:
    commands = Path(program_file).parent / "compile_commands.json"
    if not commands.exists():
        pytest.skip("the program was not built here")
    with h5py.File(run(hausbench, experiment, tmp_path)) as f:
        flags = dict(part.split(": ", 1) for part in f["meta"].attrs["flags"].split("; "))
    seen = set()
    for command in json.loads(commands.read_text()):
        library = library_of(command)
        if not library:
            continue
        file = str(Path(command["file"]).relative_to(ROOT))
        given = {
            a
            for a in shlex.split(command["command"])[1:]
            if re.match(r"-(?!I|isystem$|o$|c$|M)", a)
        }
        assert given == set(flags.get(file, flags[library]).split()), file
        seen.add(library)
    assert (
        seen == set(LIBRARIES)
        and "-ffp-contract=off" in flags["algorithms"]
        and "-frounding-math" in flags["harness"]
    )
