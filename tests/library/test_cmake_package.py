"""The CMake package: what each component of find_package(hausbench) gives and looks for; and
hausbench as a part of another project."""

from __future__ import annotations

import json
import re
import subprocess
from pathlib import Path

import pytest

from c_document import PAGE, blocks, write
from c_library import ROOT, run


def configured(
    folder: Path, prefix: Path, language: str, components: str, target: str, *options: str
) -> subprocess.CompletedProcess[str]:
    """Configures a project that finds these components and links the target, with all calls of
    CMake in folder/trace."""
    source = "user.c" if language == "C" else "user.cpp"
    write(
        {
            source: "#include <hausbench.h>\n",
            "CMakeLists.txt": f"""cmake_minimum_required(VERSION 3.20)
project(user LANGUAGES {language})
set(CMAKE_POLICY_WARNING_CMP0156 OFF)  # an optional warning, which a trace turns on
find_package(hausbench 0.1 REQUIRED {components})
add_library(user MODULE {source})
target_link_libraries(user PRIVATE {target})
""",
        },
        folder,
    )
    return run(
        "cmake",
        "-G",
        "Ninja",
        "-S",
        folder,
        "-B",
        folder / "build",
        "--trace-expand",
        f"--trace-redirect={folder / 'trace'}",
        f"-DCMAKE_PREFIX_PATH={prefix}",
        *options,
    )


@pytest.mark.parametrize(
    ("language", "components"), [("C", ""), ("C", "COMPONENTS c"), ("CXX", "COMPONENTS c")]
)
def test_the_c_library_needs_no_other_package(
    language: str, components: str, prefix: Path, tmp_path: Path
) -> None:
    done = configured(tmp_path, prefix, language, components, "hausbench::c")
    assert done.returncode == 0, done.stderr
    looked_for = re.findall(
        r"(?:find_package|find_dependency)\((\S+)", (tmp_path / "trace").read_text()
    )
    assert looked_for == ["hausbench"]
    named = {
        name
        for file in (prefix / "lib" / "cmake" / "hausbench").glob("hausbench_c*.cmake")
        for name in re.findall(r"\b(?!_)\w+::\w+", file.read_text())
    }
    assert named == {"hausbench::c"}
    done = run("cmake", "--build", tmp_path / "build")
    assert done.returncode == 0, done.stdout


@pytest.mark.parametrize("components", ["", "COMPONENTS c plugin"])
def test_plugins_link_the_algorithms(components: str, prefix: Path, tmp_path: Path) -> None:
    """Without COMPONENTS, too, as plug-ins were written before there were any."""
    done = configured(tmp_path, prefix, "CXX", components, "hausbench::algorithms")
    assert done.returncode == 0 and done.stderr == "", done.stderr
    assert "BUILD_TESTING" not in (tmp_path / "build" / "CMakeCache.txt").read_text()
    assert "Eigen3" in re.findall(r"find_package\((\S+)", (tmp_path / "trace").read_text())


@pytest.mark.parametrize(
    ("language", "components", "said"),
    [
        (
            "C",
            "COMPONENTS plugin",
            "The component 'plugin' of hausbench needs a project with the language CXX.",
        ),
        (
            "C",
            "COMPONENTS c python",
            "The component 'python' of hausbench is not installed (there are plugin, c, program).",
        ),
        (
            "CXX",
            "COMPONENTS plugin",
            "The component 'plugin' of hausbench needs fmt 9, which CMake does not find.",
        ),
        ("CXX", "", "The component 'plugin' of hausbench needs fmt 9, which CMake does not find."),
    ],
)
def test_a_component_that_is_missing_is_named(
    language: str, components: str, said: str, prefix: Path, tmp_path: Path
) -> None:
    done = configured(
        tmp_path,
        prefix,
        language,
        components,
        "hausbench::c",
        "-DCMAKE_DISABLE_FIND_PACKAGE_fmt=ON",
    )
    assert (done.returncode == 0) == (components == "")
    assert said in " ".join((done.stdout + done.stderr).split())


def test_the_program_is_a_target(prefix: Path, tmp_path: Path) -> None:
    write(
        {
            "CMakeLists.txt": """cmake_minimum_required(VERSION 3.20)
project(user LANGUAGES NONE)
find_package(hausbench REQUIRED COMPONENTS program)
get_target_property(program hausbench::program LOCATION)
message(STATUS "is [${program}]")
"""
        },
        tmp_path,
    )
    done = run("cmake", "-S", tmp_path, "-B", tmp_path / "build", f"-DCMAKE_PREFIX_PATH={prefix}")
    assert f"is [{prefix}/bin/hausbench]" in done.stdout, done.stderr


def options_of(build: Path) -> dict[str, str]:
    """Returns the entries of a cache that belong to the whole project."""
    entries = re.findall(
        r"^(\w+):(\w+)=(.*)$", (build / "CMakeCache.txt").read_text(), re.MULTILINE
    )
    return {
        name: value
        for name, kind, value in entries
        if name.startswith(("CMAKE_", "BUILD_")) and kind not in ("INTERNAL", "STATIC")
    }


def test_hausbench_as_a_part_of_a_project(tmp_path: Path) -> None:
    """The document's project, configured only: building takes minutes."""
    files = next(
        block.files
        for block in blocks(PAGE.read_text(encoding="utf-8"))
        if block.section == "The CMake package"
    )
    additions = "include(CTest)\nadd_test(NAME own COMMAND distance)\ninstall(TARGETS distance)\n"
    text = files["CMakeLists.txt"].replace(
        "LANGUAGES C)", "LANGUAGES C CXX)"
    )  # so that both caches have the entries of C++
    without = re.sub(".*etch.*|.*link_libraries.*", "", text)
    for folder, project in ((tmp_path / "alone", without), (tmp_path / "with", text)):
        folder.mkdir()
        write(
            {"CMakeLists.txt": project + additions, "distance.c": "int main(void) { return 0; }\n"},
            folder,
        )
        (folder / "hausbench").symlink_to(ROOT)
        done = run(
            "cmake",
            "-G",
            "Ninja",
            "-DCMAKE_EXPORT_COMPILE_COMMANDS=ON",
            "-S",
            folder,
            "-B",
            folder / "build",
        )
        assert done.returncode == 0 and done.stderr == "", done.stderr
    build = tmp_path / "with" / "build"
    assert options_of(build) == options_of(tmp_path / "alone" / "build")
    assert "Total Tests: 1" in run("ctest", "-N", folder=build).stdout
    assert [
        file for file in build.rglob("cmake_install.cmake") if "file(INSTALL" in file.read_text()
    ] == [build / "cmake_install.cmake"]
    assert not (build / "generated").exists()

    targets = run("ninja", "-C", build, "-t", "targets", "all").stdout
    assert (
        "libhausbench.so" in targets
        and "hausbench_python" not in targets
        and "library_test" not in targets
    )
    commands = {
        Path(entry["file"]).name: entry["command"]
        for entry in json.loads((build / "compile_commands.json").read_text())
    }
    assert "-O3" in commands["shape.cpp"], "the project has no build type"
    assert "-O3" not in commands["distance.c"]
    (included,) = re.findall(r"-(?:I|isystem) ?(\S+)", commands["distance.c"])
    assert sorted(file.name for file in Path(included).iterdir()) == [
        "hausbench.h",
        "hausbench.hpp",
    ]
