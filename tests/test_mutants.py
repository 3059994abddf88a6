"""Every switch has an entry and a test. The script that runs them is tested on a toy tree of one
function and two tests."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

import mutants

ROOT = Path(__file__).resolve().parent.parent

CMAKE = """
cmake_minimum_required(VERSION 3.25)
project(toy LANGUAGES CXX)
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
add_executable(bound_test bound_test.cpp)
target_include_directories(bound_test PRIVATE .)
add_custom_target(hausbench)
add_custom_target(hausbench_commit)
"""
PRESETS = """{"version": 6, "configurePresets": [{"name": "mutants", "generator": "Ninja", "binaryDir": "${sourceDir}/build/mutants",
"cacheVariables": {"CMAKE_CXX_FLAGS": "-DHAUSBENCH_MUTANTS"}}], "buildPresets": [{"name": "mutants", "configurePreset": "mutants"}]}"""
BOUND = """
#include "algorithms/kernel/watched.h"
inline double bound(double x) { return x + WATCHED("the slack", 1.5) + WATCHED("less slack", 0.25); }
inline double greatest(double x) { return WATCHED_ELSE("the greater", x > 3 ? x : 3, x); }
"""
TEST = """
#include "bound.h"
#include <cstdio>
#include <cstring>
int main(int, char** arguments) {
    const bool none = std::strstr(arguments[1], "Nobody") != nullptr;
    std::puts(none ? "[  PASSED  ] 0 tests." : "[  PASSED  ] 1 test.");
    return none || (bound(1) > 2 && greatest(1) > 2) ? 0 : 1;
}
"""
ENTRY = """
[[mutant]]
name = "{name}"
test = "{test}"
filter = "{filter}"
"""
SLACK = {"name": "the slack", "test": "bound_test", "filter": ""}
LESS = SLACK | {"name": "less slack"}
GREATER = SLACK | {"name": "the greater"}


@pytest.fixture
def toy(tmp_path: Path) -> Path:
    (tmp_path / "tests").mkdir()
    (tmp_path / "algorithms" / "kernel").mkdir(parents=True)
    shutil.copy(ROOT / "algorithms/kernel/watched.h", tmp_path / "algorithms/kernel/watched.h")
    (tmp_path / "CMakeLists.txt").write_text(CMAKE)
    (tmp_path / "CMakePresets.json").write_text(PRESETS)
    (tmp_path / ".gitignore").write_text("/build/\n")
    (tmp_path / "bound.h").write_text(BOUND)
    (tmp_path / "bound_test.cpp").write_text(TEST)
    (tmp_path / "tests" / "CMakeLists.txt").write_text("hausbench_test(bound_test)\n")
    (tmp_path / "tests" / "test_toy.py").write_text(
        "import os\n\n\ndef test_switch():\n    assert 'HAUSBENCH_MUTANT' not in os.environ\n\n\ndef test_nothing():\n    pass\n"
    )
    subprocess.run(["git", "init", "--quiet", tmp_path], check=True)
    return tmp_path


def run(toy: Path, *entries: dict[str, str], arguments: tuple[str, ...] = ()) -> int:
    (toy / "tests" / "mutants.toml").write_text("".join(ENTRY.format(**entry) for entry in entries))
    return mutants.main(["--tree", str(toy), "--jobs", "1", *arguments])


def test_each_switch_has_an_entry_and_each_test_exists() -> None:
    assert mutants.read(ROOT)


def test_caught_and_survived_are_told_apart(toy: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(toy, SLACK, LESS, GREATER) == 1
    out = capsys.readouterr().out
    assert "survived bound.h: less slack: bound_test  passes without it" in out
    assert "2 caught, 1 survived;" in out
    assert run(toy, SLACK, LESS, GREATER, arguments=("the",)) == 0
    assert "2 caught, 0 survived;" in capsys.readouterr().out


def test_python_tests_and_patterns(toy: Path, capsys: pytest.CaptureFixture[str]) -> None:
    entries = (
        SLACK,
        LESS | {"test": "pytest tests/test_toy.py::test_switch"},
        GREATER | {"test": "pytest tests/test_toy.py::test_nothing"},
    )
    assert run(toy, *entries, arguments=("less",)) == 0
    assert "1 caught, 0 survived;" in capsys.readouterr().out
    assert run(toy, *entries, arguments=("greater",)) == 1
    assert "0 caught, 1 survived;" in capsys.readouterr().out
    assert run(toy, *entries, arguments=("--list", "slack")) == 0
    assert (
        capsys.readouterr().out
        == "bound.h: the slack  (bound_test)\nbound.h: less slack  (pytest tests/test_toy.py::test_switch)\n"
    )


@pytest.mark.parametrize(
    "entry, message",
    [
        ({"name": "the play"}, "the play: no source has a switch of this name"),
        ({"name": "the play"}, "the slack: has a switch in bound.h, but no entry"),
        ({"name": "less slack"}, "less slack: two entries have this name"),
        ({"test": "other_test"}, "the slack: there is no test other_test"),
        (
            {"test": "pytest tests/test_other.py::test_x"},
            "there is no test pytest tests/test_other.py::test_x",
        ),
        (
            {"filter": "Nobody.*"},
            "the slack: bound_test Nobody.* runs no test; is its filter right?",
        ),
        ({"test": "pytest tests/test_toy.py::test_gone"}, "runs no test"),
        ({"filter": '"\nnote = "'}, "the slack: unknown key note"),
    ],
)
def test_a_wrong_entry_is_named(
    toy: Path, capsys: pytest.CaptureFixture[str], entry: dict[str, str], message: str
) -> None:
    assert run(toy, LESS, GREATER, SLACK | entry) == 1
    assert message in capsys.readouterr().err


def test_a_test_that_is_red_anyway_proves_nothing(
    toy: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (toy / "bound.h").write_text(BOUND.replace("1.5", "0.5"))
    assert run(toy, SLACK, LESS, GREATER) == 1
    assert "bound_test  fails without a switch" in capsys.readouterr().err
