"""Every mutant can be planted in the tree. The script that plants them is tested on a toy tree of one function and two tests."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

import mutants

ROOT = Path(__file__).resolve().parent.parent

CMAKE = """
cmake_minimum_required(VERSION 3.25)
project(toy LANGUAGES CXX)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
add_executable(bound_test bound_test.cpp)
add_custom_target(hausbench)
add_custom_target(hausbench_commit)
"""
PRESETS = """{"version": 6, "configurePresets": [{"name": "release", "generator": "Ninja", "binaryDir": "${sourceDir}/build/release"}],
"buildPresets": [{"name": "release", "configurePreset": "release"}]}"""
TEST = """
#include "bound.h"
#include <cstdio>
#include <cstring>
int main(int, char** arguments) {
    const bool none = std::strstr(arguments[1], "Nobody") != nullptr;
    std::puts(none ? "[  PASSED  ] 0 tests." : "[  PASSED  ] 1 test.");
    return none || bound(1) > 2 ? 0 : 1;
}
"""
ENTRY = """
[[mutant]]
name = "{name}"
file = "bound.h"
text = '''{text}'''
plant = "{plant}"
test = "{test}"
filter = "{filter}"
"""
SLACK = {"name": "the slack", "text": "+ slack", "plant": "", "test": "bound_test", "filter": ""}
PYTHON = {"name": "what Python sees", "text": "double slack", "plant": "float slack", "test": "pytest tests/test_toy.py", "filter": ""}


@pytest.fixture
def toy(tmp_path: Path) -> Path:
    (tmp_path / "tests").mkdir()
    (tmp_path / "CMakeLists.txt").write_text(CMAKE)
    (tmp_path / "CMakePresets.json").write_text(PRESETS)
    (tmp_path / ".gitignore").write_text("/build/\n")
    (tmp_path / "bound.h").write_text("inline double bound(double x) {\n    const double slack = 1.5;\n    return x +\n        slack;\n}\n")
    (tmp_path / "bound_test.cpp").write_text(TEST)
    (tmp_path / "tests" / "CMakeLists.txt").write_text("hausbench_test(bound_test)\n")
    (tmp_path / "tests" / "test_toy.py").write_text(
        "def test_double():\n    assert 'const double' in open('bound.h').read()\n\n\ndef test_nothing():\n    pass\n")
    subprocess.run(["git", "init", "--quiet", tmp_path], check=True)
    return tmp_path


def run(toy: Path, *entries: dict[str, str], arguments: tuple[str, ...] = ()) -> int:
    (toy / "tests" / "mutants.toml").write_text("".join(ENTRY.format(**(SLACK | entry)) for entry in entries))
    return mutants.main(["--tree", str(toy), "--jobs", "1", *arguments])


def test_each_text_is_found_once_and_each_test_exists() -> None:
    assert mutants.not_plantable(ROOT, mutants.read(ROOT)) == []


def test_caught_survived_and_broken_are_told_apart(toy: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(toy, SLACK) == 0
    assert "1 caught, 0 survived\n" in capsys.readouterr().out
    before = (toy / "bound.h").read_text()

    green = {"name": "less slack", "text": "1.5", "plant": "1.25"}
    python_green = PYTHON | {"name": "what no test sees", "test": "pytest tests/test_toy.py::test_nothing"}
    assert run(toy, green, {"name": "no C++", "text": "1.5", "plant": "one"}, SLACK, python_green) == 1
    out = capsys.readouterr().out
    assert "survived bound.h: less slack: bound_test  stays green" in out
    assert "broken   bound.h: no C++: it does not build" in out
    assert "caught   bound.h: the slack " in out
    assert "1 caught, 2 survived, 1 broken\n" in out
    assert (toy / "bound.h").read_text() == (toy / "build/mutants/bound.h").read_text() == before


def test_python_tests_and_patterns(toy: Path, capsys: pytest.CaptureFixture[str]) -> None:
    missing = {"name": "gone", "text": "+ play"}
    assert run(toy, missing, PYTHON, arguments=("Python",)) == 0
    assert "1 caught, 0 survived\n" in capsys.readouterr().out
    assert run(toy, missing, PYTHON, arguments=("--list",)) == 0
    assert capsys.readouterr().out == "bound.h: gone  (bound_test)\nbound.h: what Python sees  (pytest tests/test_toy.py)\n"


@pytest.mark.parametrize("entry, message", [
    ({"text": "+ play"}, "the slack: its text is not found in bound.h"),
    ({"text": "double"}, "the slack: its text is found 3 times, and must be unique in bound.h"),
    ({"plant": "+\\n        slack"}, "the slack: the plant is the text itself"),
    ({"test": "other_test"}, "the slack: there is no test other_test"),
    ({"test": "pytest tests/test_other.py::test_x"}, "there is no test pytest tests/test_other.py::test_x"),
    ({"filter": "Nobody.*"}, "the slack: bound_test Nobody.* runs no test; is its filter right?"),
    ({"test": "pytest tests/test_toy.py::test_gone"}, "runs no test"),
    ({"filter": '"\nnote = "'}, "the slack: unknown key note"),
])
def test_a_wrong_entry_is_named(toy: Path, capsys: pytest.CaptureFixture[str], entry: dict[str, str], message: str) -> None:
    assert run(toy, entry) == 1
    assert message in capsys.readouterr().err


def test_a_test_that_is_red_anyway_proves_nothing(toy: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (toy / "bound.h").write_text((toy / "bound.h").read_text().replace("1.5", "0.5"))
    assert run(toy, SLACK) == 1
    assert "the slack: bound_test  fails without a mutant" in capsys.readouterr().err
