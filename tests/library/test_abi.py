"""The interface of libhausbench.so is the recorded one: symbols, all that hausbench.h declares or
defines, and the layout of each struct. `python3 tests/library/test_abi.py` prints what is recorded;
write it to abi.txt only if old callers can bear the change (HAUSBENCH_INTERFACE in hausbench.h)."""

from __future__ import annotations

import re
import sys
import tempfile
from pathlib import Path

import pytest

from c_library import HEADER, ROOT, compiled, run

RECORDED = Path(__file__).with_name("abi.txt")
COMMENT = re.compile(r"/\*.*?\*/", re.DOTALL)
STRUCT = re.compile(r"typedef struct (\w+) \{(.*?)\} \w+;", re.DOTALL)
POINTER_TO_FUNCTION = re.compile(r"\(\*(\w+)\)\(.*\)")


def members(body: str) -> list[str]:
    """Returns the names of the members of a struct."""
    names = []
    for declaration in filter(str.strip, body.split(";")):
        function = POINTER_TO_FUNCTION.search(declaration)
        names += [function[1]] if function else [re.search(r"(\w+)(\[\d+\])?$", declarator.strip())[1] for declarator in declaration.split(",")]  # type: ignore[index]
    return names


def layout(header: str, folder: Path) -> list[str]:
    """Returns the sizes and offsets that a C compiler finds in a header."""
    text = COMMENT.sub("", header)
    lines = ["#include <stdio.h>", '#include "changed.h"', "int main(void) {"]
    for name, body in STRUCT.findall(text):
        lines.append(f'printf("struct {name} %zu\\n", sizeof({name}));')
        lines += [
            f'printf("  {member} at %zu, %zu bytes\\n", offsetof({name}, {member}), sizeof((({name}*)0)->{member}));'
            for member in members(body)
        ]
    lines.append("return 0; }")
    (folder / "changed.h").write_text(header)
    program = compiled(folder, "\n".join(lines) + "\n", f"-I{folder}")
    return run(program).stdout.splitlines()


def declarations(header: str) -> list[str]:
    """Returns all that a header declares or defines, in its order, one to a line, without comments
    and with single spaces."""
    declared, open_text = [], ""
    for line in COMMENT.sub("", header).replace("\\\n", " ").splitlines():
        if (
            line.startswith("#")
            or line == 'extern "C" {'
            or (line == "}" and not open_text.strip())
        ):
            declared.append(" ".join(line.split()))
            continue
        open_text = f"{open_text} {line}"
        if line.rstrip().endswith(";") and open_text.count("{") == open_text.count("}"):
            declared.append(" ".join(open_text.split()))
            open_text = ""
    return declared


def symbols(library: Path) -> list[str]:
    lines = run("nm", "-D", "--defined-only", library).stdout.splitlines()
    return sorted(line.split(" ", 1)[1] for line in lines)


def interface(header: str, library: Path, folder: Path) -> list[str]:
    name = next(
        line.split("[")[1].rstrip("]")
        for line in run("readelf", "-d", library).stdout.splitlines()
        if "SONAME" in line
    )
    return [f"name {name}", *symbols(library), *declarations(header), *layout(header, folder)]


def test_the_interface_is_the_recorded_one(library: Path, tmp_path: Path) -> None:
    assert interface(HEADER.read_text(), library, tmp_path) == RECORDED.read_text().splitlines()


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("double lower, upper;", "double upper, lower;"),
        ("int32_t relative_to;", "int64_t relative_to;"),
        ("int64_t target_row;", "int64_t target_row; int64_t middle_row;"),
        ("int32_t accepted;", "float accepted;  int32_t other;"),
        ("double diagonal;", "int64_t diagonal;"),
        ("HAUSBENCH_WITHIN = 1,", "HAUSBENCH_WITHIN = 7,"),
        ("sizeof(hausbench_error), 0, 0, -1, { 0 }", "sizeof(hausbench_error), 0, 0, 0, { 0 }"),
        ("#define HAUSBENCH_INTERFACE 1", "#define HAUSBENCH_INTERFACE 2"),
        (
            "typedef struct hausbench_chain hausbench_chain;",
            "typedef struct hausbench_pair hausbench_chain;",
        ),
        (
            "hausbench_within(hausbench_pair* pair, int32_t symmetric, double length,",
            "hausbench_within(hausbench_pair* pair, int32_t symmetric, float length,",
        ),
    ],
)
def test_a_planted_change_is_found(before: str, after: str, library: Path, tmp_path: Path) -> None:
    header = HEADER.read_text()
    assert header.count(before) == 1
    assert (
        interface(header.replace(before, after), library, tmp_path)
        != RECORDED.read_text().splitlines()
    )


def test_every_declared_function_is_exported_and_no_other(library: Path) -> None:
    declared = {
        re.search(r"(\w+)\(", declaration)[1]  # type: ignore[index]
        for declaration in declarations(HEADER.read_text())
        if declaration.startswith("HAUSBENCH_API ")
    }
    exported = {
        line.split()[-1].split("@")[0] for line in symbols(library) if not line.startswith("A ")
    }  # A: a version
    assert declared == exported


@pytest.mark.parametrize(
    ("compiler", "standard"), [("cc", "c99"), ("cc", "c11"), ("g++", "c++98"), ("g++", "c++20")]
)
def test_the_header_is_pedantic(compiler: str, standard: str, tmp_path: Path) -> None:
    source = "#include <hausbench.h>\nint main(void) { hausbench_query q = HAUSBENCH_QUERY_INIT; return q.threads - 1; }\n"
    extra = ["-Wno-long-long", "-Wno-missing-field-initializers"] if compiler == "g++" else []
    compiled(tmp_path, source, f"-std={standard}", "-pedantic-errors", *extra, compiler=compiler)


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as scratch:
        built = (
            Path(sys.argv[1])
            if len(sys.argv) > 1
            else ROOT / "build" / "release" / "library" / "libhausbench.so"
        )
        print("\n".join(interface(HEADER.read_text(), built, Path(scratch))))
