"""A report over 60 hostile results and files in the cache of shapes names each, leaves it out, and
reads no other file."""

from __future__ import annotations

import json
import os
import re
import resource
import shutil
import struct
import subprocess
import sys
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

from analysis.shared import claims
from program import EXPERIMENT, ROOT, Program
from test_hostile_results import TEXT, Change, attribute, dataset, link, several, value
from test_run import run

WORDS, NUMBER = "words of another file", 8675309.25  # what no output may have
SECONDS = 60


@pytest.fixture(scope="module")
def good(program_file: str, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A result with fields, traces and a motion of three poses, and the cache of its shapes."""
    folder = tmp_path_factory.mktemp("good")
    (folder / "good.toml").write_text(
        EXPERIMENT.replace("repeats = 1", "repeats = 1\nfields = true\ntrace = true").replace(
            'target = "sphere2"',
            'target = "sphere2"\nmotion = { kind = "translation", from = [0, 0, 0], to = [1, 0, 0], steps = 3, of = "absolute" }',
        )
    )
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("HAUSBENCH_CACHE", str(folder / "cache"))
        run(Program(program_file, folder), folder / "good.toml", folder)
    return folder


def secrets(folder: Path) -> None:
    """Writes the files that the hostile ones lead to."""
    (folder / "words").write_bytes(WORDS.ljust(32).encode() * 8)
    (folder / "numbers").write_bytes(np.full(64, NUMBER).tobytes())
    with h5py.File(folder / "other.h5.secret", "w") as f:
        f["words"], f["numbers"] = np.array([WORDS] * 3, TEXT), np.full(3, NUMBER)
        f["group/seconds"] = f["group/lower"] = f["group/upper"] = np.full(3, NUMBER)


def without(name: str) -> Change:
    def change(f: h5py.File) -> None:
        del f[name]

    return change


def stored_in(file: str, name: str, **how: object) -> Change:
    """Makes a column whose values are the bytes of another file."""

    def change(f: h5py.File) -> None:
        place = Path(f.filename).parent / file
        if name in f:
            del f[name]
        f.create_dataset(name, external=[(str(place), 0, h5py.h5f.UNLIMITED)], **how)

    return change


def elsewhere(name: str, there: str, secret: str = "other.h5.secret") -> Change:
    def change(f: h5py.File) -> None:
        del f[name]
        f[name] = h5py.ExternalLink(str(Path(f.filename).parent / secret), there)

    return change


def view(name: str, there: str, kind: object, rows: int = 3, inside: bool = False) -> Change:
    def change(f: h5py.File) -> None:
        del f[name]
        layout = h5py.VirtualLayout(shape=(rows,), dtype=kind)
        layout[:] = h5py.VirtualSource(
            "." if inside else str(Path(f.filename).parent / "other.h5.secret"),
            there,
            shape=(rows,),
            dtype=kind,
        )
        f.create_virtual_dataset(name, layout)

    return change


def bomb(name: str) -> Change:
    """Makes a column of 8 GB of zeros, which take 8 MB: 128 chunks of 64 MB."""

    def change(f: h5py.File) -> None:
        packed, each = zlib.compress(bytes(2**26), 9), 2**23
        made = f.create_dataset(
            name, shape=(128 * each,), dtype="f8", chunks=(each,), compression="gzip"
        )
        for k in range(128):
            made.id.write_direct_chunk((k * each,), packed)

    return change


def shared_text(f: h5py.File) -> None:
    """Makes a column of 30,000 texts of 200 KB that are one: 6 GB in 700 KB."""
    del f["cases/label"]
    made = f.create_dataset("cases/label", data=["x" * 200_000] + [""] * 29_999, dtype=TEXT)
    at, file = made.id.get_offset(), Path(f.filename)
    f.close()
    content = bytearray(file.read_bytes())
    content[at : at + 16 * 30_000] = content[at : at + 16] * 30_000
    file.write_bytes(content)


def an_empty_group(f: h5py.File) -> None:
    f.create_group("cases/lower")


def references(f: h5py.File) -> None:
    f.create_dataset("cases/counter_odd", data=[f["meta"].ref] * 3, dtype=h5py.ref_dtype)


def named_type(f: h5py.File) -> None:
    f["cases/counter_odd"] = np.dtype("f8")


def cycle(f: h5py.File) -> None:
    f["cases/self"] = f["cases"]


def root_attribute(name: str, new: object) -> Change:
    def change(f: h5py.File) -> None:
        f.attrs[name] = new

    return change


Make = Callable[[Path, Path], None]  # writes a hostile file, given a good one


def edited(*changes: Change) -> Make:
    def make(bad: Path, good: Path) -> None:
        shutil.copy(good, bad)
        with h5py.File(bad, "r+") as f:
            if "meta" in f:
                del f["meta"].attrs["stem"]
                f["meta"].attrs["stem"] = bad.stem
            for change in changes:
                change(f)

    return make


def bytes_of(change: Callable[[bytes], bytes]) -> Make:
    def make(bad: Path, good: Path) -> None:
        bad.write_bytes(change(good.read_bytes()))

    return make


def pipe(bad: Path, _: Path) -> None:
    os.mkfifo(bad)


def folder(bad: Path, _: Path) -> None:
    (bad / "inside").mkdir(parents=True)


def leads_to(place: str) -> Make:
    def make(bad: Path, _: Path) -> None:
        bad.symlink_to(place)

    return make


FILES: dict[str, Make] = {
    "pipe": pipe,
    "folder": folder,
    "dangling": leads_to("nothing_there"),
    "endless": leads_to("/dev/zero"),
    "empty": bytes_of(lambda _: b""),
    "half": bytes_of(lambda b: b[: len(b) // 2]),
    "text": bytes_of(lambda _: b"case,solver\n" * 99),
    "head": bytes_of(lambda b: b[:100]),
    "flipped": bytes_of(lambda b: b[:9999] + bytes([b[9999] ^ 8]) + b[10000:]),
    "longer": bytes_of(lambda b: b + b"more"),
}

CHANGES: dict[str, Change] = {
    "outside_numbers": stored_in("numbers", "cases/lower", shape=(3,), dtype="f8"),
    "outside_words": stored_in("words", "cases/label", shape=(3,), dtype="S32"),
    "outside_counter": stored_in("numbers", "cases/counter_odd", shape=(3,), dtype="u8"),
    "link_outside": elsewhere("cases/label", "words"),
    "group_outside": elsewhere("trace", "group"),
    "link_to_nothing": elsewhere("cases/label", "words", "nothing_there"),
    "soft_link": link("cases/variant", h5py.SoftLink("/cases/label")),
    "dangling_inside": link("cases/reason", h5py.SoftLink("/cases/nothing")),
    "link_to_itself": link("cases/reason", h5py.SoftLink("/cases/reason")),
    "view_of_words": view("cases/label", "words", TEXT),
    "view_of_numbers": view("cases/lower", "numbers", "f8"),
    "view_inside": view("cases/upper", "cases/lower", "f8", inside=True),
    "unstored": dataset("cases/lower", shape=(2**31,), dtype="f8"),
    "empty_chunks": dataset("cases/lower", shape=(2**31,), dtype="f8", chunks=(2**20,)),
    "unstored_texts": dataset("cases/label", shape=(2**31,), dtype=TEXT),
    "bomb": bomb("cases/counter_odd"),
    "shared_text": shared_text,
    "references": references,
    "named_type": named_type,
    "cycle": cycle,
    "pairs": dataset("cases/lower", data=np.zeros(3, [("a", "f8"), ("b", "f8")])),
    "lists": dataset("cases/label", shape=(3,), dtype=h5py.vlen_dtype("i4")),
    "long_numbers": dataset("cases/lower", data=np.zeros(3, np.longdouble)),
    "fixed_texts": dataset("cases/label", data=np.array([b"a"] * 3)),
    "cube": dataset("cases/lower", data=np.zeros((3, 1, 1))),
    "one_number": dataset("cases/lower", data=1.0),
    "text_for_numbers": dataset("cases/lower", data=["1", "2", "3"], dtype=TEXT),
    "numbers_for_text": dataset("cases/label", data=[1, 2, 3]),
    "reals_for_integers": dataset("cases/pose_index", data=[0.5] * 3),
    "another_length": dataset("cases/upper", data=np.zeros(7)),
    "narrow_poses": dataset("cases/pose", data=np.zeros((3, 5))),
    "no_models": without("models"),
    "group_for_column": several(without("cases/lower"), an_empty_group),
    "case_below_0": value("answers/case", 0, -1),
    "case_too_large": value("repeats/case", 0, 2**62),
    "trace_too_long": value("cases/trace_end", 2, 2**62),
    "fields_too_long": value("fields/end", 0, 2**62),
    "options_deep": value("cases/options", 0, "[" * 200_000),
    "extras_of_texts": value("cases/extras", 0, '{"seconds: a": "b"}'),
    "facts_a_list": value("cases/facts", 0, "[1]"),
    "many_schemas": attribute("schema_version", np.ones(8000, "i8")),
    "newer": attribute("schema_version", 99),
    "text_schema": attribute("schema_version", "two"),
    "libraries_a_list": attribute("libraries", "[1]"),
    "plugins_an_object": attribute("plugins", '{"a": 1}'),
}

# Odd values that a report can show: they must not take it down.
SHOWN: dict[str, Change] = {
    "nan": several(
        value("cases/lower", slice(None), np.nan),
        value("cases/upper", slice(None), np.nan),
        value("answers/cpu_seconds", slice(None), np.nan),
    ),
    "steering": several(
        value("cases/label", slice(None), "\x1b[2J\u202eevil<script>"),
        value("cases/scene", slice(None), "a\x07\nb"),
    ),
    "endless_times": several(
        value("answers/wall_seconds", slice(None), np.inf),
        value("repeats/cpu_seconds", slice(None), -1.0),
    ),
}


def coordinates(f: h5py.File, **how: Any) -> None:
    rows = f["coordinates"].shape[0]
    del f["coordinates"]
    f.create_dataset("coordinates", **{"shape": (rows, 3), "dtype": "f8", **how})


SHAPES: dict[str, Make] = {
    **{name: FILES[name] for name in ("pipe", "folder", "dangling", "endless", "half")},
    "outside": edited(
        lambda f: coordinates(
            f, external=[(str(Path(f.filename).parents[2] / "numbers"), 0, h5py.h5f.UNLIMITED)]
        )
    ),
    "link_outside": edited(elsewhere("coordinates", "numbers", "../../other.h5.secret")),
    "unstored": edited(lambda f: coordinates(f, shape=(2**31, 3))),
    "two_numbers": edited(lambda f: coordinates(f, shape=(9, 2), data=np.zeros((9, 2)))),
    "corner_too_large": edited(value("triangles", 0, 2**30)),
    "soft_link": edited(link("coordinates", h5py.SoftLink("/triangles"))),
    "many_hashes": edited(root_attribute("content_hash", ["0", "1"])),
}


def hostile(folder: Path, good: Path) -> tuple[Path, set[str]]:
    """Writes the files to results/ and cache/. Returns the folder of the cache and the names that
    must be told."""
    results, shapes = folder / "results", folder / "cache" / "shapes"
    results.mkdir()
    shutil.copytree(good / "cache", folder / "cache")
    for place in (folder, results):
        secrets(place)
    shutil.copy(good / "good.h5", results)
    edits = {name: edited(change) for name, change in (CHANGES | SHOWN).items()}
    for name, make in (FILES | edits).items():
        make(results / f"{name}.h5", good / "good.h5")
    for k, (name, make) in enumerate(SHAPES.items()):  # before the good ones in the order of names
        originals = sorted((good / "cache" / "shapes").glob("*.h5"))
        make(shapes / f"!{name}.h5", originals[k % len(originals)])
    named = {f"results/{name}.h5" for name in (*FILES, *CHANGES)}
    named |= {f"shapes/!{name}.h5" for name in SHAPES}
    return folder / "cache", named


def report(program_file: str, folder: Path) -> subprocess.CompletedProcess[str]:
    command = [
        sys.executable,
        "-m",
        "analysis.report.pages",
        "--results",
        str(folder / "results"),
        "--out",
        str(folder / "out"),
    ]
    return subprocess.run(
        command,
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=10 * SECONDS,
        env={
            **os.environ,
            "HAUSBENCH_PROGRAM": program_file,
            "HAUSBENCH_CACHE": str(folder / "cache"),
        },
    )


def tells_nothing(folder: Path, said: str) -> None:
    """Checks that neither the terminal nor a file has the contents of another file."""
    shown = [said.encode(), *(path.read_bytes() for path in folder.rglob("*") if path.is_file())]
    for text in shown:
        assert (
            WORDS.encode() not in text
            and b"8675309" not in text
            and np.float64(NUMBER).tobytes() not in text
        )


def test_a_report_over_hostile_files(program_file: str, good: Path, tmp_path: Path) -> None:
    _, named = hostile(tmp_path, good)
    assert len(named) + len(SHOWN) >= 60
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = report(program_file, tmp_path)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    seconds = (
        after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    )  # CPU time, as other programs may be running
    assert done.returncode == 0, done.stderr
    assert {
        name
        for name in named
        if f"{tmp_path / name}: " not in done.stderr
        and f"{tmp_path / 'cache' / name}: " not in done.stderr
    } == set(), done.stderr
    assert not re.search(r"good\.h5|Traceback", done.stderr), done.stderr
    assert all(c == "\n" or c.isprintable() for c in done.stderr)
    pages = tmp_path / "out" / "report"
    rows = (pages / "rows_data.js").read_text()
    assert '"good"' in rows
    for name in (*FILES, *CHANGES):
        assert f'"{name}"' not in rows, name
    assert len((pages / "scenes_data.js").read_text()) > 1000  # drawn from the good shapes
    tells_nothing(pages, done.stdout + done.stderr)
    assert seconds < SECONDS, seconds
    print(f"{len(named) + len(SHOWN)} files, {seconds:.0f} s of CPU time")


def large_picture(path: Path) -> None:
    """A PNG of 400 million pixels in a few bytes."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        return (
            struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        )

    path.write_bytes(
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", struct.pack(">IIBBBBB", 20000, 20000, 1, 0, 0, 0, 0))
        + chunk(b"IDAT", zlib.compress(bytes(20000 * 2501), 9))
        + chunk(b"IEND", b"")
    )


def large(path: Path) -> None:
    with path.open("wb") as file:
        file.truncate(2**40)


VERDICT: dict[str, object] = {name: "" for name in claims.TEXTS} | {
    "paper": "hausbench",
    "outcome": "holds",
    "evidence": "",
    "ratio": None,
    "counted": {},
}
# Tables and figures that came with results, by their path.
BESIDE: dict[str, Callable[[Path], object]] = {
    "tables/overview.md": os.mkfifo,
    "tables/cliffs.md": lambda path: path.symlink_to("../../words"),
    "tables/points_speed.md": large,
    "tables/cliffs.csv": lambda path: path.symlink_to("/dev/zero"),
    "tables/mesh_peers.tex": os.mkfifo,
    "figures/cliffs.png": large_picture,
    "figures/overview.png": os.mkfifo,
    "figures/points_speed.png": lambda path: path.write_bytes(b"\x89PNG\r\n\x1a\n"),
    "figures/mesh_peers.png": lambda path: path.symlink_to("../../words"),
    "figures/points_speed.txt": large,
    "tables/a.verdicts.json": os.mkfifo,
    "tables/b.verdicts.json": lambda path: path.symlink_to("../../words"),
    "tables/c.verdicts.json": lambda path: path.write_text("[" * 100_000),
    "tables/d.verdicts.json": lambda path: path.write_text('[{"paper": 3}]'),
    "tables/e.verdicts.json": lambda path: path.write_bytes(b"\xff"),
    "tables/f.verdicts.json": lambda path: path.write_text("{}"),
    "tables/g.verdicts.json": lambda path: path.write_text(
        json.dumps([VERDICT | {"outcome": "surely"}])
    ),
    "tables/h.verdicts.json": lambda path: path.write_text(
        json.dumps([VERDICT | {"counted": {"work": 1}}])
    ),
    "tables/i.verdicts.json": lambda path: path.write_text(
        json.dumps([VERDICT | {"ratio": ["1", 2, 3]}])
    ),
}


def test_a_report_with_hostile_tables_and_figures(
    program_file: str, good: Path, tmp_path: Path
) -> None:
    for folder in ("results", "out/tables", "out/figures"):
        (tmp_path / folder).mkdir(parents=True)
    secrets(tmp_path)
    shutil.copy(good / "good.h5", tmp_path / "results")
    for name, make in BESIDE.items():
        make(tmp_path / "out" / name)
    (tmp_path / "out" / "tables" / "fine.verdicts.json").write_text(json.dumps([VERDICT]))
    done = report(program_file, tmp_path)
    assert done.returncode == 0, done.stderr
    assert [name for name in BESIDE if f"{name}: " not in done.stderr] == [], done.stderr
    assert "fine" not in done.stderr and "Traceback" not in done.stderr
    tells_nothing(tmp_path / "out" / "report", done.stdout + done.stderr)
    assert '"good"' in (tmp_path / "out" / "report" / "rows_data.js").read_text()


@pytest.mark.parametrize(
    "name",
    [
        "pipe",
        "endless",
        "outside_words",
        "outside_numbers",
        "link_outside",
        "view_of_words",
        "unstored",
        "extras_of_texts",
    ],
)
def test_a_hostile_result_is_not_drawn(
    program_file: str, hausbench: Program, good: Path, tmp_path: Path, name: str
) -> None:
    secrets(tmp_path)
    bad = tmp_path / f"{name}.h5"
    (FILES | {name: edited(change) for name, change in CHANGES.items()})[name](
        bad, good / "good.h5"
    )
    done = hausbench("draw", bad, "--as", "table", "--out", tmp_path / "out", timeout=SECONDS)
    assert name == "extras_of_texts" or (
        done.returncode == 2 and f"{name}.h5: " in done.stderr
    ), done.stderr
    assert "Traceback" not in done.stderr
    tells_nothing(tmp_path / "out", done.stdout + done.stderr)
