"""No room includes one above it, no file includes itself indirectly, and files and functions are
short."""

import json
import re
import subprocess
from pathlib import Path

import pytest
import rooms

LONGEST_FUNCTION = 80
SHARED = ("search", "structures", "certificate")
GRAPH = rooms.includes(rooms.sources())


def test_no_room_includes_one_above_it() -> None:
    assert rooms.steps_up(rooms.between_rooms(GRAPH)) == []


def test_no_file_includes_itself() -> None:
    assert rooms.circle(GRAPH) == []


def test_a_step_up_and_a_circle_are_found() -> None:
    record, run = rooms.ROOT / "harness/record/case.h", rooms.ROOT / "harness/run/runner.h"
    assert rooms.circle({record: {run}, run: {record}}) == [record, run]
    lines = rooms.steps_up(rooms.between_rooms({record: {run}, run: set()}))
    assert lines == ["harness/record/case.h includes harness/run/runner.h"]


def test_every_room_is_on_the_staircase() -> None:
    on_staircase = {room for step in rooms.STAIRCASE for room in step}
    assert {rooms.room_of(file) for file in GRAPH} == set(rooms.WHAT) == on_staircase


def test_the_picture_shows_the_rooms_of_today() -> None:
    written = (rooms.ROOT / "docs" / "rooms.svg").read_text()
    assert written == rooms.picture(rooms.between_rooms(GRAPH)), "run: python3 tests/rooms.py"


def declared_in(file: Path) -> Path:
    """Returns a source file's header: the one with the same name, or the first include from its
    folder. A header is its own."""
    beside = [
        Path(rooms.ROOT, name)
        for name in rooms.INCLUDE.findall(file.read_text())
        if Path(rooms.ROOT, name).parent == file.parent
    ]
    named = file.with_suffix(".h")
    return file if file.suffix == ".h" else named if named in GRAPH or not beside else beside[0]


def users(shared: Path) -> set[str]:
    """Returns the direct and indirect users of a shared file: solvers, each a folder or a file, and
    the rooms above them."""
    asked_by: dict[Path, set[Path]] = {}
    for file, included in GRAPH.items():
        for header in included:
            asked_by.setdefault(header, set()).add(file)
    names, look = set(), [shared]
    while look:
        for file in asked_by.pop(look.pop(), set()):
            look.append(declared_in(file))
            room = rooms.room_of(file)
            if room in ("solvers", "composed"):
                names.add(
                    "/".join(file.relative_to(rooms.ROOT / "algorithms").with_suffix("").parts[:2])
                )
            elif room not in SHARED:
                names.add(room)
    return names


@pytest.mark.parametrize(
    "file",
    [file for file in GRAPH if rooms.room_of(file) in SHARED and file.suffix == ".h"],
    ids=str,
)
def test_a_shared_file_has_two_users(file: Path) -> None:
    assert len(users(file)) >= 2, "move it to the folder of its only user"


def test_a_file_with_one_user_is_found() -> None:
    assert users(rooms.ROOT / "algorithms/meshes/tang/swept_sphere.h") == {"meshes/tang"}


def test_every_test_file_is_built() -> None:
    listed = (rooms.ROOT / "tests" / "CMakeLists.txt").read_text()
    for file in (rooms.ROOT / "tests").rglob("*_test.cpp"):
        name = str(file.relative_to(rooms.ROOT / "tests").with_suffix(""))
        assert f"hausbench_test({name} " in listed, f"add {name} to tests/CMakeLists.txt"


FIXED_WIDTH = re.compile(
    r"^[^/\n]*\bstd::u?int(?:_fast|_least)?(?:8|16|32|64|ptr|max)_t\b", re.MULTILINE
)


def without_cstdint(graph: dict[Path, set[Path]]) -> list[str]:
    """Returns the files with std::int64_t and its like to which neither they nor headers of ours
    include <cstdint>: GCC 12 lets more of them pass than 14."""
    has, lacking = {file for file in graph if "#include <cstdint>" in file.read_text()}, []
    for file in graph:
        seen, look = set[Path](), [file]
        while look and not seen & has:
            seen.add(now := look.pop())
            look += graph.get(now, set()) - seen
        if not seen & has and FIXED_WIDTH.search(file.read_text()):
            lacking.append(str(file.relative_to(rooms.ROOT)))
    return lacking


def test_files_that_name_fixed_width_integers_include_them() -> None:
    assert without_cstdint(GRAPH) == []


def test_a_file_without_the_include_is_found() -> None:
    assert without_cstdint(
        {rooms.ROOT / "library/errors.h": set(), (file := rooms.ROOT / "library/shape.cpp"): set()}
    ) == [str(file.relative_to(rooms.ROOT))]


# The program needs a Unix. The library and the Python package need Linux in few files, which a port
# would replace (docs/platforms.md).
PROGRAM = ("main", "commands", "run", "plan", "result", "process", "datasets")
OF_LINUX = {"algorithms/kernel/pages.cpp", "algorithms/plugin.cpp", "python/core/working.cpp"}
SYSTEM = re.compile(
    r"^#include <(?:cxxabi|dlfcn|elf|fcntl|link|malloc|poll|pthread|sched|signal|spawn|unistd|sys/\w+)\.h>",
    re.MULTILINE,
)


def test_the_library_needs_linux_in_few_files() -> None:
    library = [
        file
        for file in GRAPH
        if rooms.room_of(file) not in PROGRAM or file.parent.name == "formats"
    ]
    assert {
        str(file.relative_to(rooms.ROOT)) for file in library if SYSTEM.search(file.read_text())
    } == OF_LINUX
    page = (rooms.ROOT / "docs/platforms.md").read_text()
    assert [file for file in OF_LINUX if f"`{file}`" not in page] == []


def functions() -> list[tuple[int, str]]:
    """Returns each function's number of lines and its place, as found by universal-ctags."""
    command = [
        "ctags",
        "--output-format=json",
        "--languages=C++",
        "--kinds-C++=f",
        "--fields=+ne",
        "-f",
        "-",
        *map(str, rooms.sources()),
    ]
    tags = [
        json.loads(line)
        for line in subprocess.run(
            command, capture_output=True, text=True, check=True
        ).stdout.splitlines()
    ]
    return [
        (
            t["end"] - t["line"] + 1,
            f"{Path(t['path']).relative_to(rooms.ROOT)}:{t['line']} {t['name']}",
        )
        for t in tags
        if "end" in t
    ]


def test_functions_are_short() -> None:
    all_functions = functions()
    assert len(all_functions) > 2000
    assert [place for length, place in all_functions if length > LONGEST_FUNCTION] == []


def classes_in(text: str) -> list[str]:
    """Returns the classes that a source file defines, with their namespaces. Skips unnamed
    namespaces, because they are private to the file."""
    classes, spaces = list[str](), list[str]()
    for line in text.splitlines():
        if opened := re.match(r"(?:inline )?namespace ?([\w:]*) ?\{", line):
            spaces.append(opened[1])
        elif line.startswith("}  // namespace"):
            spaces.pop()
        elif (
            defined := re.match(
                r"(?:template <[^>]*> )?(?:class|struct|enum class|union) (\w+)(?: final)?(?: :[^;{]*)? \{",
                line,
            )
        ) and "" not in spaces:
            classes.append("::".join([*spaces, defined[1]]))
    return classes


def test_no_two_files_define_one_class() -> None:
    """Two such classes break the one-definition rule: the linker keeps one copy of each function
    and reports nothing."""
    defined: dict[str, set[str]] = {}
    separate = (
        "tests/outside_plugin/",
        "datasets/recorder/",
        "tests/fuzz/",
    )  # linked to programs of their own
    for name in subprocess.run(
        ["git", "ls-files", "*.h", "*.hpp", "*.cpp"],
        cwd=rooms.ROOT,
        capture_output=True,
        text=True,
        check=True,
    ).stdout.split():
        if name.startswith(separate) or (name.startswith("tests/") and name.endswith(".cpp")):
            continue
        for class_name in classes_in((rooms.ROOT / name).read_text()):
            defined.setdefault(class_name, set()).add(name)
    assert len(defined) > 300
    assert {
        class_name: sorted(files) for class_name, files in defined.items() if len(files) > 1
    } == {}


def test_classes_are_found_with_their_namespaces() -> None:
    text = "namespace a {\nstruct X {\n};\nclass Y;\nnamespace {\nclass Hidden final : B {\n};\n}  // namespace\nnamespace b {\nenum class Z { one };\n}  // namespace b\n}  // namespace a\n"
    assert classes_in(text) == ["a::X", "a::b::Z"]
