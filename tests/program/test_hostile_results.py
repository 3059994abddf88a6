"""Files made to do harm: their seal is right, and what is in them is not. Each is refused before it is read.

tests/program/test_results.py has the damaged ones, whose seal is wrong.
"""

from __future__ import annotations

import hashlib
import os
import random
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest

from conftest import EXPERIMENT, Program
from test_run import run, texts


def seal(file: Path) -> None:
    content = file.read_bytes()
    file.write_bytes(content + b"\nsha256 " + hashlib.sha256(content).hexdigest().encode() + b"\n")


@pytest.fixture(scope="module")
def good(program_file: str, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A result of four cases with repeats, two of them read off the traces of the others."""
    folder = tmp_path_factory.mktemp("good")
    experiment = folder / "tiny.toml"
    experiment.write_text(EXPERIMENT.replace("tolerances = [1e-3]", "tolerances = [1e-3, 1e-1]\ntrace = true") +
                          '[[scene]]\nname = "back"\nsource = "sphere2"\ntarget = "sphere1"\n')
    return run(Program(program_file, folder), experiment, folder)


Change = Callable[[h5py.File], None]


def attribute(name: str, value: object, **how: object) -> Change:
    def change(f: h5py.File) -> None:
        del f["meta"].attrs[name]
        f["meta"].attrs.create(name, value, **how)

    return change


def dataset(name: str, **how: object) -> Change:
    def change(f: h5py.File) -> None:
        del f[name]
        f.create_dataset(name, **how)

    return change


def link(name: str, to: object) -> Change:
    def change(f: h5py.File) -> None:
        del f[name]
        f[name] = to

    return change


def value(name: str, row: int, new: object) -> Change:
    def change(f: h5py.File) -> None:
        f[name][row] = new

    return change


def wide_integers(f: h5py.File) -> None:
    """Integers of 128 bits, which h5py cannot write: only made."""
    del f["cases/pose_index"]
    wide = h5py.h5t.STD_I64LE.copy()
    wide.set_size(16)
    h5py.h5d.create(f["cases"].id, b"pose_index", wide, h5py.h5s.create_simple((2,)))


def view_of_other_datasets(f: h5py.File) -> None:
    layout = h5py.VirtualLayout(shape=(2,), dtype="f8")
    layout[:] = h5py.VirtualSource("elsewhere.h5", "x", shape=(2,))
    del f["cases/lower"]
    f.create_virtual_dataset("cases/lower", layout)


def shared_samples(f: h5py.File) -> None:
    f["cases/trace_begin"][:] = 0
    f["cases/trace_end"][:] = len(f["trace/seconds"])


TEXT = h5py.string_dtype()

# what is done to the file -> what the one line says
HOSTILE: dict[str, tuple[Change, str]] = {
    "an attribute of many integers": (attribute("schema_version", np.ones(8000, "i8")), "schema_version: is not one value"),
    "an attribute of two integers": (attribute("cores", np.ones(2, "i8")), "cores: is not one value"),
    "an attribute of many texts": (attribute("stem", np.array(["x" * 99] * 3000, object), dtype=TEXT), "stem: is not one value"),
    "an attribute of no integer": (attribute("cores", h5py.Empty("i8")), "cores: is not one value"),
    "an attribute of no text": (attribute("stem", h5py.Empty(TEXT)), "stem: is not one value"),
    "an attribute of fixed length": (attribute("stem", np.bytes_(b"x" * 9)), "stem: holds texts of fixed length"),
    "an attribute of pairs": (attribute("cores", np.zeros((), [("a", "i8"), ("b", "i8")])), "cores: does not hold an integer"),
    "an attribute of an array type": (attribute("cores", np.zeros((1, 99), "i8"), dtype=np.dtype(("i8", (99,)))), "does not hold an integer"),
    "an attribute of another type": (attribute("schema_version", 1.0), "schema_version: does not hold an integer"),
    "an attribute out of range": (attribute("memory_bytes", np.uint64(2**64 - 1)), "out of range"),
    "a column that is not stored": (dataset("cases/lower", shape=(2**50,), dtype="f8"), "more than are stored"),
    "a column of empty chunks": (dataset("cases/lower", shape=(2**50,), dtype="f8", chunks=(1024,)), "more than are stored"),
    "texts that are not stored": (dataset("cases/identity", shape=(2**40,), dtype=TEXT), "more than are stored"),
    "a column of one number": (dataset("cases/lower", data=1.0), "neither a column nor a table"),
    "a column of nothing": (dataset("cases/lower", data=h5py.Empty("f8")), "neither a column nor a table"),
    "a cube": (dataset("cases/lower", data=np.zeros((1, 1, 2))), "neither a column nor a table"),
    "pairs": (dataset("cases/lower", data=np.zeros(2, [("a", "f8"), ("b", "f8")])), "does not hold real numbers"),
    "texts for numbers": (dataset("cases/lower", data=["1", "2"], dtype=TEXT), "does not hold real numbers"),
    "numbers for texts": (dataset("cases/solver", data=[1, 2]), "does not hold texts"),
    "lists for texts": (dataset("cases/solver", shape=(2,), dtype=h5py.vlen_dtype("i4")), "does not hold texts"),
    "texts of fixed length": (dataset("cases/solver", data=np.array([b"guthe", b"guthe"])), "texts of fixed length"),
    "long numbers": (dataset("cases/lower", data=np.zeros(2, np.longdouble)), "more than 64 bits"),
    "long integers": (wide_integers, "more than 64 bits"),
    "another file's bytes": (dataset("cases/lower", shape=(2,), dtype="f8", external=[("/etc/passwd", 0, 16)]), "kept in another file"),
    "a view of other datasets": (view_of_other_datasets, "view of other datasets"),
    "a link to another file": (link("cases/lower", h5py.ExternalLink("other.h5", "/cases/lower")), "in another file"),
    "a link to itself": (link("cases/lower", h5py.SoftLink("/cases/lower")), "cases/lower"),
    "a group for a column": (link("cases/lower", h5py.SoftLink("/meta")), "cases/lower"),
    "an answer to case 4": (value("answers/case", 0, 4), "belongs to no case"),
    "an answer in round 2^40": (value("answers/round", 0, 2**40), "answers/round"),
    "a repeat of case -1": (value("repeats/case", 0, -1), "belongs to no case"),
    "a repeat of case 2^62": (value("repeats/case", 0, 2**62), "belongs to no case"),
    "a preparation of case 4": (value("preparation/case", 0, 4), "belongs to no case"),
    "a preparation in round 2^40": (value("preparation/round", 0, 2**40), "preparation/round holds"),
    "a trace from -1": (value("cases/trace_begin", 0, -1), "share samples"),
    "a trace to 2^62": (value("cases/trace_end", 1, 2**62), "past the samples"),
    "traces on top of each other": (shared_samples, "share samples"),
    "a pose of another number": (value("cases/pose_index", 0, 2**32), "cases/pose_index holds 4294967296"),
    "a triangle of another number": (value("cases/witness_source_element", 0, 2**32), "witness_source_element holds 4294967296"),
    "options that are no object": (value("cases/options", 0, "[" * 200_000), "damaged"),
}


@pytest.mark.parametrize("name", HOSTILE)
def test_hostile_results_are_refused(hausbench: Program, good: Path, tmp_path: Path, name: str) -> None:
    change, said = HOSTILE[name]
    shutil.copy(good, tmp_path / "other.h5")
    bad = tmp_path / "bad.h5"
    shutil.copy(good, bad)
    with h5py.File(bad, "r+") as f:
        change(f)
    seal(bad)
    line = hausbench.fails("verify", bad)
    assert "bad.h5: damaged" in line and said in line and "signal" not in line
    assert "bad.h5" in hausbench.fails("compare", bad, good)


def test_flipped_bits_under_a_right_seal_take_nothing_down(hausbench: Program, good: Path, tmp_path: Path) -> None:
    content = good.read_bytes()[:-73]
    moments = random.Random(12)
    bad = tmp_path / "bad.h5"
    refused = 0
    for _ in range(25):
        flipped = bytearray(content)
        for _ in range(moments.randrange(1, 5)):
            flipped[moments.randrange(min(len(content), 1 << 16))] ^= 1 << moments.randrange(8)
        bad.write_bytes(flipped)
        seal(bad)
        done = hausbench("verify", bad)
        assert done.returncode in (0, 1, 2), (done.returncode, done.stderr)
        refused += done.returncode == 2
        assert done.returncode != 2 or len(done.stderr.strip().splitlines()) == 1, done.stderr
    assert 0 < refused


def test_hostile_shapes_in_the_cache_are_refused(hausbench: Program, experiment: Path, tmp_path: Path) -> None:
    cache = tmp_path / "cache"
    environment = {**hausbench.environment(), "HAUSBENCH_CACHE": str(cache)}

    def again() -> tuple[int, str]:
        done = subprocess.run(hausbench.command("run", experiment, "--results", tmp_path, "--fresh", "--quiet"),
                              env=environment, capture_output=True, text=True, timeout=120)
        if done.returncode != 0 or texts(tmp_path / "tiny.h5", "cases/status") == ["ok"]:
            return done.returncode, done.stderr
        return done.returncode, texts(tmp_path / "tiny.h5", "cases/reason")[0]

    assert again() == (0, "")
    for file in cache.rglob("*.h5"):
        if not os.path.islink(file):
            with h5py.File(file, "r+") as f:
                f.attrs["unreferenced"] = np.ones(8000, "i8")
            seal(file)
    code, said = again()
    assert code in (0, 2) and "unreferenced: is not one value" in said and "delete the file" in said, (code, said)
