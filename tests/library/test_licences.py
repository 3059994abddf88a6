"""Everything that is compiled or linked into libhausbench.so has a licence in licences.toml, and no
header of CGAL is under the GPL. The linker's map names the object files, and ninja the headers of
each."""

from __future__ import annotations

import re
import subprocess
import tomllib
from fnmatch import fnmatchcase
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from c_library import ROOT, run

TABLE = tomllib.loads(Path(__file__).with_name("licences.toml").read_text())
HEAVY = ("hdf5", "assimp", "matplotlib", "toml", "curl", "mpfr", "python")  # never loaded
SPDX = re.compile(r"SPDX-License-Identifier: (.*)")


@cache
def files_of(package: str) -> frozenset[str]:
    """Returns the files of a Debian package for every architecture that it is installed for."""
    query = ["dpkg-query", "--show", "--showformat=${db-fsys:Files}", package]
    return frozenset(
        map(
            str.strip,
            subprocess.run(query, capture_output=True, text=True, check=True).stdout.splitlines(),
        )
    )


def entry_of(header: str) -> dict[str, Any] | None:
    """Returns the first entry that fits a header."""
    for entry in TABLE["header"]:
        if (
            fnmatchcase(header, entry["path"] + "*")
            if "path" in entry
            else header in files_of(entry["package"])
        ):
            return dict(entry)
    return None


def linked_objects(build: Path) -> set[str]:
    """Returns the object files of the library by name; those in an archive as "archive(name)"."""
    text = (build / "library" / "linked.txt").read_text()
    names = re.findall(r"^LOAD (\S+\.o)$", text, re.MULTILINE)
    return {*names, *re.findall(r"^(\S+\.a\(\S+\.o\))", text, re.MULTILINE)}


def headers(build: Path) -> dict[str, set[str]]:
    """Returns the files outside the tree that each linked object file includes."""
    objects = linked_objects(build)
    members = {name.split("(")[1].rstrip(")") for name in objects if "(" in name}
    files_of: dict[str, set[str]] = {}
    output = subprocess.run(
        ["ninja", "-C", build, "-t", "deps"], capture_output=True, text=True, check=True
    ).stdout
    for block in output.split("\n\n"):
        first, *files = block.splitlines() or [""]
        name = first.split(":")[0]
        if name in objects or (name.startswith("algorithms/") and Path(name).name in members):
            outside = (
                file.strip()
                for file in files
                if file.strip().startswith("/") and not file.strip().startswith(str(ROOT))
            )
            files_of[name] = {str(Path(file).resolve()) for file in outside}
    return files_of


@pytest.fixture(scope="module")
def included(build: Path, library: Path) -> dict[str, set[str]]:
    if not (build / "build.ninja").exists():
        pytest.skip("the library was not built by ninja here")
    includes = headers(build)
    assert len(includes) > 30
    return includes


def test_every_header_has_a_licence(included: dict[str, set[str]]) -> None:
    unknown = {header for some in included.values() for header in some if not entry_of(header)}
    assert unknown == set(), "list them in licences.toml"


def test_no_header_is_under_the_gpl(included: dict[str, set[str]]) -> None:
    """Each header of CGAL names its own licence."""
    seen = {header for some in included.values() for header in some if "/CGAL/" in header}
    assert len(seen) > 100
    named = {
        header: match[1]
        for header in seen
        if (match := SPDX.search(Path(header).read_text(errors="replace")))
    }
    assert {
        header: text
        for header, text in named.items()
        if not text.startswith(("LGPL", "MIT", "BSL"))
    } == {}


def test_only_the_checker_needs_cgal(included: dict[str, set[str]]) -> None:
    """So HAUSBENCH_WITH_CHECKER=OFF leaves it out."""
    checker = ("hausbench_checker.dir", "datasets/hash.cpp.o")
    of_others = set()
    for name, some in included.items():
        if not any(part in name for part in checker):
            of_others |= {
                f"{name}: {header}" for header in some if (entry_of(header) or {}).get("checker")
            }
    assert of_others == set()


def test_every_library_has_a_licence(library: Path, build: Path) -> None:
    needed = set(re.findall(r"NEEDED.*\[(.*)\]", run("readelf", "-d", library).stdout))
    # Objects and archives of the compiler and of other packages are linked by their full paths.
    needed |= {
        Path(name.split("(")[0]).name for name in linked_objects(build) if name.startswith("/")
    }
    unlisted = set(needed)
    for entry in TABLE["library"]:
        unlisted -= {name for name in needed if fnmatchcase(name, entry["name"])}
    assert unlisted == set(), "list them in licences.toml"
    loaded = run("ldd", library).stdout.splitlines()
    for heavy in HEAVY:
        assert not [line for line in loaded if heavy in line]


def test_a_gpl_solver_is_not_linked(build: Path) -> None:
    linked = " ".join(linked_objects(build))
    assert "cover" in linked
    assert [
        name for name in ("penetration", "cgal", "surfaces", "plugin.cpp") if name in linked
    ] == []


def test_an_unlisted_header_is_found() -> None:
    assert entry_of("/usr/include/hdf5/serial/hdf5.h") is None
    assert entry_of("/usr/include/gsl_math.h") is None
    assert entry_of("/usr/include/stdio.h") is not None
