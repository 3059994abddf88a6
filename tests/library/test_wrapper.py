"""hausbench.hpp is plain C++17 and reaches every function of hausbench.h; wrapper_test.cpp tests
what it does."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from c_library import HEADER, compiled, path_of, run

WRAPPER = HEADER.with_suffix(".hpp").read_text()
# Functions that it has no need of, and why.
NOT_CALLED = {
    "hausbench_read": "hausbench_read_with",
    "hausbench_shape_of": "hausbench_shape_stating",
    "hausbench_verify": "hausbench_verify_posed",
    "hausbench_version": "needs no C++",
    "hausbench_interface": "needs no C++",
}


def test_every_function_is_reached() -> None:
    declared = set(re.findall(r"^HAUSBENCH_API [^(]*?(\w+)\(", HEADER.read_text(), re.MULTILINE))
    assert len(declared) > 20
    called = {name for name in declared if re.search(rf"\b{name}\b", re.sub(r"//.*", "", WRAPPER))}
    assert declared - called == set(NOT_CALLED)


@pytest.mark.parametrize("compiler", ["g++", "clang++"])
@pytest.mark.parametrize("standard", ["c++17", "c++20"])
def test_it_compiles_without_a_warning(
    compiler: str, standard: str, library: Path, tmp_path: Path
) -> None:
    """As in a user's project, where -I makes its warnings the user's."""
    source = """#include <hausbench.hpp>
hausbench::Answer distance(const std::vector<std::array<float, 3>>& a, const double* b, std::size_t rows) {
    return hausbench::Pair(hausbench::Shape(a), hausbench::Shape(hausbench::Rows(b, rows))).directed();
}
int main() {
    const double origin[] = {0, 0, 0};
    return distance({{3, 4, 0}}, origin, 1).bounds.upper >= 5 ? 0 : 1;
}
"""
    strict = [
        "-pedantic-errors",
        "-Wshadow",
        "-Wconversion",
        "-Wold-style-cast",
        "-Wnon-virtual-dtor",
        "-Woverloaded-virtual",
    ]
    program = compiled(
        tmp_path,
        source,
        f"-std={standard}",
        *strict,
        f"-L{library.parent}",
        "-Wl,--no-as-needed",
        "-lhausbench",
        compiler=path_of(compiler),
    )
    assert run(program, library=library).returncode == 0
