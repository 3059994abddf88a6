#!/usr/bin/python3
"""Writes datasets/kicad.toml again: python3 datasets/list_tier.py > datasets/kicad.toml

Reads every VRML file of the package, which it downloads (379 MB) and does not unpack, and lists the distinct ones, by SHA-256, of at least
100 triangles. It counts triangles apart from the program's reader: of each face of an IndexedFaceSet, its corners less two. Of files with the
same contents the first by name is listed. Only needed for another version of the package.
"""

from __future__ import annotations

import hashlib
import re
import sys
import tempfile
from collections import Counter
from collections.abc import Iterable
from pathlib import Path

from fetch import model_of_tier
from packages import Apt, deb_members

TIER, PACKAGE, VERSION, FOLDER, ENDING, LEAST = "kicad", "kicad-packages3d", "6.0.10-1", "usr/share/kicad/3dmodels/", ".wrl", 100
HEAD = """\
# The tier kicad: parts of electronic circuits, every distinct VRML file of at least {least} triangles that the package holds. It stands in for
# Thingi10K, which is in no package: say so wherever its numbers are shown. `make fetch-kicad` fetches the {count} meshes; nothing else does, but
# an experiment that asks for them (each = "kicad"). Written by datasets/list_tier.py; many of the files were made by one script from few designs.
#
# A line: SHA-256, triangles, and the file in `folder`. The model's name is kicad_ and the file's name without .wrl, where '_' stands for what
# no name of a model has. Each NAME has NAME_half and NAME_remeshed too, by the rules of the corpus (datasets/corpus.h).
package = "{package}"
version = "{version}"
folder = "{folder}"
licence = "CC-BY-SA-4.0 with the exception of the KiCad libraries; some files GPL-2+ or GPL-3+"
meshes = '''
"""
PART = re.compile(rb"Indexed(Face|Line)Set|\bcoordIndex\s*\[([^\]]*)\]")


class Files:
    """The names of an archive that are listed, as a set."""

    def __contains__(self, name: object) -> bool:
        return isinstance(name, str) and name.startswith(FOLDER) and name.endswith(ENDING)


def triangles(vrml: bytes) -> int:
    count, kind = 0, b""
    for part in PART.finditer(vrml):
        kind = part[1] or kind
        if part[2] is None or kind != b"Face":
            continue
        corners = 0
        for word in [*part[2].replace(b",", b" ").split(), b"-1"]:
            count += max(corners - 2, 0) if word == b"-1" else 0
            corners = 0 if word == b"-1" else corners + 1
    return count


def listed(files: Iterable[tuple[str, bytes]]) -> list[str]:
    """The lines of the list, by name."""
    found: dict[str, tuple[str, int]] = {}
    for path, data in files:
        digest, name, count = hashlib.sha256(data).hexdigest(), path.removeprefix(FOLDER), triangles(data)
        if count >= LEAST and (digest not in found or name < found[digest][0]):
            found[digest] = (name, count)
    lines = sorted((name, f"{digest} {count} {name}") for digest, (name, count) in found.items())
    names = Counter(model_of_tier(TIER, name) for name, _ in lines)
    if twice := sorted(name for name, count in names.items() if count > 1):
        raise SystemExit(f"two files would have the same name of a model: {', '.join(twice)}")
    return [line for _, line in lines]


def main() -> None:
    with tempfile.TemporaryDirectory(prefix="hausbench-tier-") as folder:
        lines = listed(deb_members(Apt().fetch(PACKAGE, VERSION, Path(folder)), Files()))
    sys.stdout.write(HEAD.format(least=LEAST, count=f"{len(lines):,}", package=PACKAGE, version=VERSION, folder=FOLDER))
    sys.stdout.write("\n".join(lines) + "\n'''\n")


if __name__ == "__main__":
    main()
