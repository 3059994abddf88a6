"""Tests datasets/fetch.py without a network, and the manifest itself."""

from __future__ import annotations

import base64
import bz2
import gzip
import hashlib
import io
import lzma
import re
import struct
import subprocess
import sys
import tarfile
import tomllib
from pathlib import Path
from typing import Any, Literal

import pytest

DATASETS = Path(__file__).resolve().parents[2] / "datasets"
sys.path.insert(0, str(DATASETS))

import fetch  # noqa: E402
import packages  # noqa: E402


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (1e8, "1e8"),
        (1000, "1000"),
        (0.25, "0.25"),
        (0.0001, "1e-4"),
        (1.5e-7, "1.5e-7"),
        (-2, "-2"),
        (0, "0"),
        ("x", ""),
        (True, ""),
        (float("nan"), ""),
    ],
)
def test_severities_are_written_as_the_program_writes_them(value: object, text: str) -> None:
    assert fetch.severity_text(value) == text


def test_shapes_described_in_place_bring_the_model_that_they_are_derived_from(
    tmp_path: Path,
) -> None:
    file = tmp_path / "e.toml"
    file.write_text(
        """
[[scene]]
name = "a {}"
severity = [1, 2]
source = "man{}"
target = [{ from = "bunny", operation = "weld" }, { operation = "vertices" }]
[[scene]]
name = "b"
source = []
target = { points = [[0, 0, 0]] }
"""
    )
    catalogue = fetch.Catalogue(
        {name: {"source": "generated"} for name in ("man1", "man2", "bunny", "other")}, [], [], []
    )
    assert fetch.asked_by(file, "quick", catalogue) == ["man1", "bunny", "man2"]


def test_the_reason_of_npm_is_its_sentence_and_not_its_code() -> None:
    said = (
        "npm error code SELF_SIGNED_CERT_IN_CHAIN\nnpm error errno SELF_SIGNED_CERT_IN_CHAIN\nnpm error syscall connect\n"
        "npm error request to https://example.org/bunny failed, reason: self-signed certificate in certificate chain\n"
    )
    assert (
        packages.reason(said)
        == "npm error request to https://example.org/bunny failed, reason: self-signed certificate in certificate chain"
    )
    assert packages.reason("npm error code E404\n") == "npm error code E404"


# Fake programs: packages are tar archives in the folder `shelf`, and every call is recorded.
APT = """#!/bin/sh
echo "apt-get $*" >> "$CALLS"
[ "$1" = update ] && { touch "$LISTS/x_Packages"; exit 0; }
for last; do :; done
[ -n "$NEEDS_LISTS" ] && [ ! -e "$LISTS/x_Packages" ] && { echo "E: Unable to locate package" >&2; exit 100; }
[ -e "$SHELF/$last.deb" ] || { echo "W: noise" >&2; echo "E: Version or package '$last' was not found" >&2; exit 100; }
case "$last" in *=*) got="${last%=*}_${last#*=}_all.deb" ;; *) got="${last}_2.0_all.deb" ;; esac
cp "$SHELF/$last.deb" "./$got"
"""
NPM = """#!/bin/sh
echo "npm $*" >> "$CALLS"
for last; do :; done
[ -e "$SHELF/$last.tgz" ] || { echo "npm ERR! code E404" >&2; echo "npm ERR! 404 Not Found" >&2; exit 1; }
cp "$SHELF/$last.tgz" ./got.tgz
"""
DPKG = '#!/bin/sh\nexec cat "$2"\n'


def sha(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()


def tar(files: dict[str, bytes], mode: Literal["w", "w:gz", "w:xz"] = "w") -> bytes:
    stream = io.BytesIO()
    with tarfile.open(fileobj=stream, mode=mode) as archive:
        for name, data in files.items():
            info = tarfile.TarInfo(name)
            info.size = len(data)
            archive.addfile(info, io.BytesIO(data))
    return stream.getvalue()


class World:
    """A folder with fake programs, packages, a manifest and a cache."""

    def __init__(self, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        self.folder, self.manifest, self.cache = folder, folder / "manifest.toml", folder / "cache"
        self.shelf, self.lists, self.programs = folder / "shelf", folder / "lists", folder / "bin"
        self.calls_file = folder / "calls"
        for place in (self.shelf, self.lists, self.programs):
            place.mkdir()
        for name, script in {"apt-get": APT, "npm": NPM, "dpkg-deb": DPKG}.items():
            (self.programs / name).write_text(script)
            (self.programs / name).chmod(0o755)
        for name in ("sh", "cat", "cp", "touch"):
            (self.programs / name).symlink_to(
                subprocess.check_output(["which", name], text=True).strip()
            )
        monkeypatch.setenv("PATH", str(self.programs))
        monkeypatch.setenv("NEEDS_LISTS", "")
        for key, value in {
            "SHELF": self.shelf,
            "CALLS": self.calls_file,
            "LISTS": self.lists,
        }.items():
            monkeypatch.setenv(key, str(value))
        self.manifest.write_text("")

    def model(
        self,
        name: str,
        source: str,
        path: str,
        digest: str,
        package: str = "pack",
        version: str = "1.0",
    ) -> None:
        self.add(
            name,
            source=source,
            package=package,
            version=version,
            path=path,
            sha256=digest,
            licence="MIT",
        )

    def add(self, name: str, **keys: str) -> None:
        with self.manifest.open("a") as out:
            out.write(
                f"[model.{name}]\n" + "".join(f'{key} = "{value}"\n' for key, value in keys.items())
            )

    def fetch(self, *names: str, root: bool = False) -> int:
        return fetch.fetch(self.manifest, self.cache, list(names), packages.Apt(self.lists, root))

    def calls(self) -> list[str]:
        return self.calls_file.read_text().splitlines() if self.calls_file.exists() else []

    def kept(self) -> dict[str, bytes]:
        return {
            str(f.relative_to(self.cache)): f.read_bytes()
            for f in sorted(self.cache.rglob("*"))
            if f.is_file()
        }


@pytest.fixture(name="world")
def make_world(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> World:
    return World(tmp_path, monkeypatch)


def test_a_package_is_downloaded_once_and_what_is_there_needs_no_program(world: World) -> None:
    (world.shelf / "pack=1.0.deb").write_bytes(
        tar({"./usr/a.obj": b"A", "./usr/b.obj": b"B", "./usr/other": b"C"})
    )
    world.model("a", "debian", "usr/a.obj", sha(b"A"))
    world.model("b", "debian", "usr/b.obj", sha(b"B"))
    assert world.fetch() == 0
    assert world.kept() == {f"raw/{sha(b'A')}/a.obj": b"A", f"raw/{sha(b'B')}/b.obj": b"B"}
    assert len(world.calls()) == 1 and world.calls()[0].endswith("pack=1.0")
    world.calls_file.unlink()
    assert world.fetch() == 0 and world.calls() == []


def test_only_the_models_asked_for_are_fetched(world: World) -> None:
    (world.shelf / "pack=1.0.deb").write_bytes(tar({"usr/a.obj": b"A", "usr/b.obj": b"B"}))
    world.model("a", "debian", "usr/a.obj", sha(b"A"))
    world.model("b", "debian", "usr/b.obj", sha(b"B"))
    assert world.fetch("b") == 0
    assert list(world.kept().values()) == [b"B"]


def layouts(content: bytes) -> dict[str, dict[str, bytes]]:
    """Returns a package with a.obj, packed and placed in several ways; its model has the path
    "usr/share/a.obj" or, in an archive, "data/a.obj"."""
    packed = {
        ".gz": gzip.compress(content, mtime=7),
        ".xz": lzma.compress(content),
        ".bz2": bz2.compress(content),
    }
    members = {
        "plain": {"./usr/share/a.obj": content},
        "moved": {"opt/a.obj": content},
        "beside others": {"a.obj": b"another", "b/a.obj": content},
    }
    members |= {ending: {f"usr/share/a.obj{ending}": data} for ending, data in packed.items()}
    return members | {
        "in an archive": {"doc/data.tar.gz": tar({"data/a.obj": content}, "w:gz")},
        "packed in a moved archive": {
            "data.tar.gz": tar(
                {"meshes/a.obj": b"another", "meshes/a.obj.xz": packed[".xz"]}, "w:xz"
            )
        },
    }


@pytest.mark.parametrize("layout", layouts(b""))
@pytest.mark.parametrize("version", ["1.0", "2.0"])
def test_a_mesh_is_found_by_its_name_and_content(
    world: World, capsys: pytest.CaptureFixture[str], layout: str, version: str
) -> None:
    shelf = world.shelf / ("pack=1.0.deb" if version == "1.0" else "pack.deb")
    shelf.write_bytes(tar(layouts(b"A")[layout]))
    world.model(
        "a",
        "debian",
        "doc/data.tar.gz!data/a.obj" if "archive" in layout else "usr/share/a.obj",
        sha(b"A"),
    )
    assert world.fetch() == 0
    assert world.kept() == {f"raw/{sha(b'A')}/a.obj": b"A"}
    assert capsys.readouterr().out == f"debian pack {version}: 1 of 1 files\n"


@pytest.mark.parametrize("layout", layouts(b""))
def test_another_content_is_refused(
    world: World, capsys: pytest.CaptureFixture[str], layout: str
) -> None:
    for file in ("pack=1.0.deb", "other.deb"):
        (world.shelf / file).write_bytes(tar(layouts(b"tampered")[layout]))
    path = "doc/data.tar.gz!data/a.obj" if "archive" in layout else "usr/share/a.obj"
    world.model("a", "debian", path, sha(b"A"))
    world.model("later", "debian", path, sha(b"B"), "other")
    assert world.fetch("later") == 0 and world.fetch("a") == 1
    skipped, error = capsys.readouterr().err.splitlines()
    assert skipped.startswith(
        f"skipped: model later: package other 2.0 (the manifest has version 1.0) has no file {path} with SHA-256 {sha(b'B')}: "
    )
    assert error.startswith(
        f"error: model a: package pack 1.0 has no file {path} with SHA-256 {sha(b'A')}: "
    )
    assert (
        all(f" has SHA-256 {sha(b'tampered')}" in line for line in (skipped, error))
        and world.kept() == {}
    )


def test_a_damaged_file_is_refused(world: World, capsys: pytest.CaptureFixture[str]) -> None:
    (world.shelf / "pack=1.0.deb").write_bytes(
        tar({"a.obj.gz": gzip.compress(b"A")[:-4], "a.obj.xz": b"x", "a.obj.bz2": b"b"})
    )
    world.model("a", "debian", "a.obj", sha(b"A"))
    assert world.fetch() == 1 and world.kept() == {}
    assert capsys.readouterr().err.count("a.obj has SHA-256") == 3


def test_a_mismatch_names_the_model_and_both_hashes_and_spares_the_others(
    world: World, capsys: pytest.CaptureFixture[str]
) -> None:
    (world.shelf / "pack=1.0.deb").write_bytes(tar({"a.obj": b"tampered", "b.obj": b"B"}))
    world.model("a", "debian", "a.obj", sha(b"A"))
    world.model("b", "debian", "b.obj", sha(b"B"))
    assert world.fetch() == 1
    assert list(world.kept().values()) == [b"B"]
    errors = [line for line in capsys.readouterr().err.splitlines() if line.startswith("error:")]
    assert len(errors) == 1 and all(
        text in errors[0] for text in ("model a:", sha(b"A"), sha(b"tampered"))
    )


def test_a_file_that_the_package_does_not_hold_is_an_error(
    world: World, capsys: pytest.CaptureFixture[str]
) -> None:
    (world.shelf / "pack=1.0.deb").write_bytes(tar({"a.obj": b"A"}))
    world.model("x", "debian", "gone.obj", sha(b"A"))
    assert world.fetch() == 1
    assert (
        capsys.readouterr().err
        == f"error: model x: package pack 1.0 has no file gone.obj with SHA-256 {sha(b'A')}\n"
    )


def test_a_file_that_a_later_package_does_not_hold_is_skipped(
    world: World, capsys: pytest.CaptureFixture[str]
) -> None:
    (world.shelf / "pack.deb").write_bytes(tar({"a.obj": b"A", "b/gone.obj.zst": b"B"}))
    world.model("a", "debian", "a.obj", sha(b"A"))
    world.model("x", "debian", "usr/gone.obj", sha(b"B"))
    arguments = ["--manifest", str(world.manifest), "--cache", str(world.cache)]
    assert fetch.main(arguments) == 0
    said = capsys.readouterr()
    assert said.out == "debian pack 2.0: 1 of 2 files\n" and list(world.kept().values()) == [b"A"]
    assert (
        said.err
        == f"skipped: model x: package pack 2.0 (the manifest has version 1.0) has no file usr/gone.obj with SHA-256 {sha(b'B')}\n"
    )


def test_versions_come_from_the_names_of_files() -> None:
    assert packages.deb_version(Path("/tmp/gem-doc_1%3a0.94-8_all.deb")) == "1:0.94-8"
    assert packages.deb_version(Path("x.deb")) == ""


def test_packages_that_cannot_be_had_are_skipped_with_the_reason(
    world: World, capsys: pytest.CaptureFixture[str]
) -> None:
    (world.shelf / "good@2.0.tgz").write_bytes(tar({"package/g.stl": b"G"}, "w:gz"))
    world.model("a", "debian", "a.obj", sha(b"A"))
    world.model("n", "npm", "package/n.stl", sha(b"N"), "bad")
    world.model("g", "npm", "package/g.stl", sha(b"G"), "good", "2.0")
    assert world.fetch() == 0
    assert list(world.kept().values()) == [b"G"]
    assert capsys.readouterr().err.splitlines() == [
        "skipped: model a: a.obj of package pack 1.0: E: Version or package 'pack' was not found",
        "skipped: model n: package/n.stl of package bad 1.0: npm ERR! 404 Not Found",
    ]


@pytest.mark.parametrize(("program", "source"), [("npm", "npm"), ("apt-get", "debian")])
def test_a_missing_program_skips(
    world: World, capsys: pytest.CaptureFixture[str], program: str, source: str
) -> None:
    (world.programs / program).unlink()
    world.model("a", source, "package/a", sha(b"A"))
    assert world.fetch() == 0
    assert (
        f"skipped: model a: package/a of package pack 1.0: {program} is not installed"
        in capsys.readouterr().err
    )


def test_another_version_will_do_if_the_mesh_is_the_same(world: World) -> None:
    (world.shelf / "pack.deb").write_bytes(tar({"a.obj": b"A"}))
    world.model("a", "debian", "a.obj", sha(b"A"))
    assert world.fetch() == 0
    assert [call.split()[-1] for call in world.calls()] == ["pack=1.0", "pack"]


def test_a_nested_archive(world: World) -> None:
    nested = tar({"data/meshes/x.off": b"X", "data/y.off": b"Y"}, "w:gz")
    (world.shelf / "pack=1.0.deb").write_bytes(tar({"./doc/data.tar.gz": nested}))
    world.model("x", "debian", "doc/data.tar.gz!data/meshes/x.off", sha(b"X"))
    world.model("y", "debian", "doc/data.tar.gz!data/y.off", sha(b"Y"))
    world.model("whole", "debian", "doc/data.tar.gz", sha(nested))
    assert world.fetch() == 0
    assert world.kept() == {
        f"raw/{sha(b'X')}/x.off": b"X",
        f"raw/{sha(b'Y')}/y.off": b"Y",
        f"raw/{sha(nested)}/data.tar.gz": nested,
    }


def test_an_archive_that_cannot_be_read_is_an_error(
    world: World, capsys: pytest.CaptureFixture[str]
) -> None:
    (world.shelf / "pack=1.0.deb").write_bytes(
        tar({"data.tar.gz": b"no archive at all", "b.obj": b"B"})
    )
    world.model("x", "debian", "data.tar.gz!x.off", sha(b"X"))
    world.model("b", "debian", "b.obj", sha(b"B"))
    assert world.fetch() == 1
    assert re.search(
        "error: model x: .*: data.tar.gz: the archive cannot be read", capsys.readouterr().err
    )
    assert list(world.kept().values()) == [b"B"]


def test_scripts_become_obj_files(world: World) -> None:
    packed = [
        base64.b64encode(data).decode()
        for data in (
            struct.pack("<9f", 0, 0.5, -1, 0.1, 1e-20, 3, 4, 5, 6),
            struct.pack("<3I", 0, 1, 2),
        )
    ]
    binary = (
        f';exports.positions = require("./load")(Float32Array, "{packed[0]}")\n'
        f';exports.cells = require("./load")(Uint32Array, "{packed[1]}")'
    )
    obj = packages.javascript_mesh(binary).decode().splitlines()
    assert obj[0] == "v 0.0 0.5 -1.0" and obj[-1] == "f 1 2 3" and len(obj) == 4
    assert [float(word) for word in obj[1].split()[1:]] == list(
        struct.unpack("<3f", struct.pack("<3f", 0.1, 1e-20, 3))
    )

    text = "exports.positions=[[1.3018950,0,2],[0,1,0],[0,0,1e-3]];exports.cells=[[2,1,0]]"
    expected = b"v 1.3018950 0 2\nv 0 1 0\nv 0 0 1e-3\nf 3 2 1\n"
    (world.shelf / "pack@1.0.tgz").write_bytes(tar({"package/m.js": text.encode()}, "w:gz"))
    world.model("m", "npm", "package/m.js!mesh/m.obj", sha(expected))
    assert world.fetch() == 0
    assert world.kept() == {f"raw/{sha(expected)}/m.obj": expected}
    with pytest.raises(ValueError, match="exports no positions"):
        packages.javascript_mesh("alert(1)")


def small_font() -> bytes:
    """Returns a font of 64 units per em with a square H and an O that is a square with a square
    hole."""
    pytest.importorskip("fontTools")
    from fontTools.fontBuilder import FontBuilder
    from fontTools.pens.ttGlyphPen import TTGlyphPen

    def glyph(*squares: tuple[int, int]) -> Any:
        pen = TTGlyphPen(None)
        for low, high in squares:
            pen.moveTo((low, low))
            for corner in ((low, high), (high, high), (high, low)):
                pen.lineTo(corner)
            pen.closePath()
        return pen.glyph()

    builder, stream = FontBuilder(64), io.BytesIO()
    builder.setupGlyphOrder([".notdef", "H", "O"])
    builder.setupCharacterMap({ord("H"): "H", ord("O"): "O"})
    builder.setupGlyf({".notdef": glyph(), "H": glyph((0, 32)), "O": glyph((0, 32), (8, 24))})
    builder.setupHorizontalMetrics({name: (64, 0) for name in (".notdef", "H", "O")})
    builder.setupHorizontalHeader()
    builder.setupPost()
    builder.save(stream)
    return stream.getvalue()


def test_letters_of_a_font_become_obj_files(
    world: World, capsys: pytest.CaptureFixture[str]
) -> None:
    from letters import letter_obj

    font = small_font()
    (world.shelf / "pack=1.0.deb").write_bytes(tar({"f.ttf": font, "b.obj": b"B"}))
    letter = letter_obj(font, "O")
    assert (
        letter.startswith(b"v 0.5 0.0 0.0\n")
        and b" 0.125\n" in letter
        and letter.count(b"f ") == 200
    )
    world.model("o", "debian", "f.ttf!letter/O.obj", sha(letter))
    world.model("whole", "debian", "f.ttf", sha(font))
    assert world.fetch() == 0
    assert world.kept() == {f"raw/{sha(letter)}/O.obj": letter, f"raw/{sha(font)}/f.ttf": font}

    world.model("x", "debian", "f.ttf!letter/X.obj", sha(b"X"))
    world.model("p", "debian", "f.ttf!letter/OO.obj", sha(b"P"), "other")
    (world.shelf / "other=1.0.deb").write_bytes(tar({"f.ttf": font}))
    world.model("n", "debian", "n.ttf!letter/O.obj", sha(b"N"), "third")
    (world.shelf / "third=1.0.deb").write_bytes(tar({"n.ttf": b"no font"}))
    assert world.fetch() == 1
    errors = capsys.readouterr().err
    assert re.search(
        r"error: model x: package pack 1.0 .*: f.ttf: the font has no letter X\n", errors
    )
    assert (
        f"error: model p: package other 1.0 has no file f.ttf!letter/OO.obj with SHA-256 {sha(b'P')}\n"
        in errors
    )
    assert re.search("error: model n: package third 1.0 .*: n.ttf: the font cannot be read", errors)


def test_without_fonttools_letters_are_skipped(
    world: World, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (world.shelf / "pack=1.0.deb").write_bytes(tar({"f.ttf": b"font"}))
    world.model("o", "debian", "f.ttf!letter/O.obj", sha(b"O"))
    modules: dict[str, Any] = sys.modules
    monkeypatch.setitem(modules, "fontTools.ttLib", None)
    assert world.fetch() == 0
    error = capsys.readouterr().err
    assert (
        "skipped: model o: f.ttf!letter/O.obj of package pack 1.0: fontTools" in error
        and "python3-fonttools" in error
    )


def test_derived_models_bring_their_origin(world: World) -> None:
    (world.shelf / "pack=1.0.deb").write_bytes(tar({"a.obj": b"A", "b.obj": b"B"}))
    world.model("a", "debian", "a.obj", sha(b"A"))
    world.model("b", "debian", "b.obj", sha(b"B"))
    world.add("half", source="derived", **{"from": "a"})
    world.add("points", source="derived", **{"from": "half"})
    world.add("ball", source="generated", recipe="icosphere")
    assert world.fetch("ball") == 0 and world.calls() == []
    assert world.fetch("points") == 0
    assert list(world.kept().values()) == [b"A"]


@pytest.mark.parametrize(
    ("origin", "message"),
    [("two", "derived from itself"), ("nine", "no model nine .*one is derived")],
)
def test_bad_chains_and_unknown_names_are_named(world: World, origin: str, message: str) -> None:
    world.add("one", source="derived", **{"from": origin})
    world.add("two", source="derived", **{"from": "one"})
    with pytest.raises(fetch.ManifestError, match=message):
        world.fetch()
    with pytest.raises(fetch.ManifestError, match="no model twoo .*did you mean two"):
        world.fetch("twoo")


@pytest.mark.parametrize("root", [True, False])
def test_empty_package_lists_are_refreshed_once_and_only_as_root(
    world: World, monkeypatch: pytest.MonkeyPatch, root: bool
) -> None:
    monkeypatch.setenv("NEEDS_LISTS", "yes")
    for name in "ab":
        (world.shelf / f"{name}=1.0.deb").write_bytes(tar({"m.obj": name.encode()}))
        world.model(name, "debian", "m.obj", sha(name.encode()), name)
    assert world.fetch(root=root) == 0
    assert sum(call.startswith("apt-get update") for call in world.calls()) == int(root)
    assert (
        list(world.kept().values())
        == ([b"b", b"a"] if sha(b"b") < sha(b"a") else [b"a", b"b"]) * root
    )


def test_the_command_line(
    world: World, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (world.shelf / "pack=1.0.deb").write_bytes(tar({"a.obj": b"A"}))
    world.model("a", "debian", "a.obj", sha(b"A"))
    monkeypatch.setenv("HAUSBENCH_CACHE", str(world.cache))
    assert fetch.main(["--manifest", str(world.manifest), "a"]) == 0
    assert list(world.kept().values()) == [b"A"]
    assert fetch.main(["--manifest", str(world.manifest), "b"]) == 2
    assert fetch.main(["--manifest", str(world.folder / "none.toml")]) == 2
    assert "none.toml" in capsys.readouterr().err
    (world.folder / "file").write_text("in the way")
    assert (
        fetch.main(["--manifest", str(world.manifest), "--cache", str(world.folder / "file")]) == 2
    )


def with_corpus(world: World) -> None:
    """Lists model a in the manifest, and a, b and c in the corpus."""
    (world.shelf / "pack=1.0.deb").write_bytes(
        tar({f"{name}.obj": name.encode() for name in "abc"})
    )
    world.model("a", "debian", "a.obj", sha(b"a"))
    manifest, world.manifest = world.manifest, world.folder / "corpus.toml"
    world.manifest.write_text('manifest = ["a"]\n')
    for name in "bc":
        world.model(name, "debian", f"{name}.obj", sha(name.encode()))
    world.manifest = manifest


def kept_of(world: World) -> str:
    return "".join(sorted(data.decode() for data in world.kept().values()))


def test_the_corpus_is_fetched_only_where_it_is_asked_for(world: World) -> None:
    with_corpus(world)
    assert world.fetch() == 0 and kept_of(world) == "a"
    assert (
        world.fetch("b_half") == 0 and kept_of(world) == "ab"
    )  # b comes from the corpus, because b_half is made from it
    assert (
        fetch.fetch(
            world.manifest,
            world.cache,
            [],
            packages.Apt(world.lists, False),
            fetch.Asked(corpus=True),
        )
        == 0
    )
    assert kept_of(world) == "abc"
    with pytest.raises(fetch.ManifestError, match="no model d"):
        world.fetch("d")


@pytest.mark.parametrize(
    ("scene", "quick", "paper"),
    [
        ('source = "{}"\ntarget = "{}_half"\neach = ["b"]', "ab", "ab"),
        ('source = "{}"\ntarget = "{}_half"\neach = "corpus"\nprofiles = ["paper"]', "a", "abc"),
        ('source = "a"\ntarget = "c_remeshed"\nprofiles = ["quick"]', "ac", "a"),
        ('sources = ["b"]\ntargets = ["mine.off", "c"]', "abc", "abc"),
        ('source = "mine"\ntarget = "a"\n[model.mine]\nfrom = "c"\noperation = "weld"', "ac", "ac"),
    ],
)
def test_an_experiment_brings_what_it_names(
    world: World, scene: str, quick: str, paper: str
) -> None:
    import shutil

    with_corpus(world)
    file = world.folder / "s.toml"
    file.write_text(f"[[scene]]\n{scene}\n")
    for profile, kept in (("quick", quick), ("paper", paper)):
        shutil.rmtree(world.cache, ignore_errors=True)
        request = fetch.Asked(experiments=(file,), profile=profile)
        assert (
            fetch.fetch(world.manifest, world.cache, [], packages.Apt(world.lists, False), request)
            == 0
        )
        assert kept_of(world) == kept, profile


def test_an_experiment_that_cannot_be_parsed_keeps_nobody_from_fetching(world: World) -> None:
    with_corpus(world)
    bad = world.folder / "bad.toml"
    bad.write_text("[[scene")
    assert (
        fetch.main(
            [
                "--manifest",
                str(world.manifest),
                "--cache",
                str(world.cache),
                "--experiment",
                str(bad),
            ]
        )
        == 0
    )
    assert kept_of(world) == "a"
    assert (
        fetch.main(
            ["--manifest", str(world.manifest), "--experiment", str(world.folder / "gone.toml")]
        )
        == 2
    )


def test_damaged_files_are_found_and_fetched_again(
    world: World, capsys: pytest.CaptureFixture[str]
) -> None:
    with_corpus(world)
    request = fetch.Asked(corpus=True, check=True)
    assert (
        fetch.fetch(world.manifest, world.cache, [], packages.Apt(world.lists, False), request) == 0
    )
    (world.cache / "raw" / sha(b"b") / "b.obj").write_bytes(b"damaged")
    assert world.fetch() == 0 and kept_of(world) == "acdamaged"
    assert (
        fetch.fetch(world.manifest, world.cache, [], packages.Apt(world.lists, False), request) == 0
    )
    assert kept_of(world) == "abc" and "model b:" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("corpus", "words"),
    [
        ('manifest = ["d"]', "d: 'manifest' names it"),
        ("[model.a]\nsource = 'file'", "a: the manifest also has it"),
        ("[", "corpus.toml"),
    ],
)
def test_a_corpus_at_odds_with_the_manifest_is_an_error(
    world: World, corpus: str, words: str
) -> None:
    world.model("a", "debian", "a.obj", sha(b"a"))
    (world.folder / "corpus.toml").write_text(corpus)
    with pytest.raises(fetch.ManifestError, match=re.escape(words)):
        world.fetch()


def is_a_path_of_unpacked_content(path: str) -> bool:
    return (
        not path.startswith("/")
        and ".." not in path.split("/")
        and not path.endswith(packages.PACKED)
    )


def as_shipped(catalogue: fetch.Catalogue, name: str) -> dict[str, Any]:
    """Returns the table of a model's file. Models from 3DS files are turned, so that Y points
    up."""
    table = catalogue.models[name]
    return catalogue.models[table["from"]] if table.get("operation") == "rotate" else table


def test_the_corpus_of_the_project() -> None:
    catalogue = fetch.read_catalogue(DATASETS / "manifest.toml")
    models = {
        name: table
        for name, table in tomllib.loads((DATASETS / "corpus.toml").read_text())["model"].items()
    }
    assert len(catalogue.corpus) == len(set(catalogue.corpus)) >= 330
    for name, table in models.items():
        assert re.fullmatch(r"corpus_[a-z0-9_]+", name)
        assert table.keys() == REAL_KEYS - {"note"} | {"triangles"}, name
        assert table["source"] in ("debian", "npm") and re.fullmatch(
            r"[0-9a-f]{64}", table["sha256"]
        ), name
        assert all(
            isinstance(table[key], str) and table[key].strip() for key in REAL_KEYS - {"note"}
        ), name
        assert is_a_path_of_unpacked_content(table["path"]), name
        assert 200 <= table["triangles"] <= 120_000, name
    # Each file is listed once, either in the manifest or in the corpus.
    hashes = [table["sha256"] for table in [*REAL.values(), *models.values()]]
    assert len(set(hashes)) == len(hashes)
    assert all(
        as_shipped(catalogue, name)["source"] in ("debian", "npm") for name in catalogue.corpus
    )
    for name in catalogue.corpus:
        for ending, operation in (("_half", "simplify"), ("_remeshed", "remesh")):
            table = catalogue.models[name + ending]
            assert table["from"] == name and table.get("operation", operation) == operation


@pytest.mark.parametrize("stem", ["corpus_decimation", "corpus_remesh"])
def test_the_sweeps_over_all_meshes_of_the_packages(stem: str) -> None:
    catalogue = fetch.read_catalogue(DATASETS / "manifest.toml")
    file = DATASETS.parent / "experiments" / "corpus" / f"{stem}.toml"

    def whole_of(profile: str) -> list[str]:
        names = fetch.asked_by(file, profile, catalogue)
        return [name for name in names if name in catalogue.whole]

    quick, every = whole_of("quick"), whole_of("corpus")
    assert (
        len(quick) == 40 and set(quick) < set(every) == set(catalogue.whole) and len(every) == 806
    )
    assert set(catalogue.corpus) < set(catalogue.whole) and len(catalogue.corpus) == 366


@pytest.mark.parametrize(
    ("stem", "quick", "paper"), [("sacht2024_fig2", 20, 366), ("sacht2024_fig10", 6, 100)]
)
def test_the_sweeps_over_the_corpus(stem: str, quick: int, paper: int) -> None:
    catalogue = fetch.read_catalogue(DATASETS / "manifest.toml")
    file = DATASETS.parent / "experiments" / "sacht2024" / f"{stem}.toml"
    for profile, count in (("quick", quick), ("paper", paper)):
        names = [
            name for name in fetch.asked_by(file, profile, catalogue) if name in catalogue.corpus
        ]
        assert len(names) == count, profile
        most = max(as_shipped(catalogue, name)["triangles"] for name in names)
        assert profile == "paper" or most <= (5000 if quick == 20 else 500)


MODELS: dict[str, dict[str, Any]] = tomllib.loads((DATASETS / "manifest.toml").read_text())["model"]
REAL = {name: table for name, table in MODELS.items() if table["source"] in ("debian", "npm")}
DERIVED = {name: table for name, table in MODELS.items() if table["source"] == "derived"}
REAL_KEYS = {"source", "package", "version", "path", "sha256", "licence", "note"}
PARAMETERS: dict[str, list[set[str]]] = {
    "vertices": [set()],
    "weld": [set()],
    "normalise": [set()],
    "sample": [{"count", "seed"}],
    "remesh": [{"edge"}],
    "simplify": [{"ratio"}, {"triangles"}],
    "noise": [{"amplitude", "seed"}],
    "subdivide": [{"levels"}],
    "scale": [{"factor"}],
    "translate": [{"x", "y", "z"}],
    "quantise": [{"cells"}],
    "triangulate": [{"cells"}],
    "icosphere": [{"level", "radius"}],
    "cube": [{"subdivisions"}],
    "torus": [{"rings", "sides", "major", "minor"}],
    "stray": [{"distance"}],
    "two_clusters": [{"distance"}],
    "needle": [{"ratio"}],
    "plane": [{"n", "z"}],
    "gaussian_points": [{"count", "seed", "sigma", "x", "y", "z"}],
    "uniform_points": [{"count", "seed"}],
    "box_points": [{"count", "seed", "x", "y", "z"}],
    "curve_points": [{"count", "seed"}],
    "shell_points": [{"count", "seed", "radius", "x", "y", "z"}],
    "cluster_points": [{"count", "seed", "clusters", "layout", "spread", "sigma", "shrink"}],
    "outlier": [{"x", "y", "z"}],
    "rotate": [{"x", "y", "z", "t"}],
    "surface": [{"polynomial", "box"}],
    "gear": [{"teeth", "steps", "rings", "layers", "outer", "root", "bore", "height"}],
}


def test_every_real_model_can_be_found_and_checked() -> None:
    for name, table in REAL.items():
        assert REAL_KEYS <= table.keys() <= REAL_KEYS | {"triangles", "format"}, name
        assert re.fullmatch(r"[0-9a-f]{64}", table["sha256"]), name
        assert all(isinstance(table[key], str) and table[key].strip() for key in REAL_KEYS), name
        assert is_a_path_of_unpacked_content(table["path"]), name
        assert table.get("triangles", 1) > 0, name
    assert len({table["sha256"] for table in REAL.values()}) == len(REAL)


def test_names_and_notes() -> None:
    for name, table in MODELS.items():
        assert re.fullmatch(r"[A-Za-z0-9_.-]+", name)
        assert table["source"] in ("generated", "debian", "npm", "file", "derived"), name
        assert table["note"].strip() and len(table["note"]) < 200, name


def test_operations_and_recipes_have_just_their_parameters() -> None:
    kinds: list[tuple[str, set[str]]] = [
        ("operation", {"source", "from", "operation", "note"}),
        ("recipe", {"source", "recipe", "note"}),
    ]
    for key, common in kinds:
        for name, table in MODELS.items():
            if key in table:
                assert table.keys() - common in PARAMETERS[table[key]], name
    assert all("operation" in table for table in DERIVED.values())


def test_derivations_end_at_a_model_that_is_not_derived() -> None:
    for name in DERIVED:
        chain = fetch.origins(MODELS, [name])  # raises for a missing origin and for a cycle
        assert MODELS[chain[-1]]["source"] != "derived"


def test_there_are_enough_real_meshes() -> None:
    sizes = [table["triangles"] for table in REAL.values() if "triangles" in table]
    assert sum(200 <= size <= 200_000 for size in sizes) >= 24
    assert 871_414 in sizes


def ends_in_points(name: str) -> bool:
    return DERIVED[name]["operation"] in ("sample", "vertices")


@pytest.mark.parametrize(
    ("pair", "sizes"),
    [
        (("pears_a", "pears_b"), (10754, 10754)),
        (("cow", "hippo"), (2903, 23105)),
        (("rabbit_fine", "rabbit_coarse"), (34834, 3594)),
        (("cups_a", "cups_b"), (10007, 9449)),
        (("wrenches_a", "wrenches_b"), (5191, 5290)),
        (("singular_a", "singular_b"), (13564, 12680)),
    ],
)
def test_the_point_sets_of_zhang_2017_have_the_papers_sizes(
    pair: tuple[str, str], sizes: tuple[int, int]
) -> None:
    for name, size in zip(pair, sizes):
        assert ends_in_points(f"zhang_{name}") and ends_in_points(f"zhang_{name}_tenth")
        if name != "cow":  # cow has no count: it takes all vertices of the mesh
            assert DERIVED[f"zhang_{name}"]["count"] == size
        assert DERIVED[f"zhang_{name}_tenth"]["count"] == round(size / 10)
    a, b = (DERIVED[f"zhang_{name}"] for name in pair)
    assert (a["from"], a.get("seed")) != (b["from"], b.get("seed"))
