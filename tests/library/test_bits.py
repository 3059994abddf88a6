"""The C library gives the bits of `hausbench measure`, for each question and unit of tolerance."""

from __future__ import annotations

import ctypes
import json
import random
from ctypes import (
    Structure,
    byref,
    c_char,
    c_char_p,
    c_double,
    c_int32,
    c_int64,
    c_size_t,
    c_void_p,
)
from pathlib import Path

import pytest

from c_library import run


class Error(Structure):
    _fields_ = [
        ("size", c_size_t),
        ("code", c_int32),
        ("argument", c_int32),
        ("row", c_int64),
        ("text", c_char * 1024),
    ]


class Query(Structure):
    _fields_ = [
        ("size", c_size_t),
        ("tolerance", c_double),
        ("relative_to", c_int32),
        ("threads", c_int32),
        ("time_limit", c_double),
        ("pointers", c_void_p * 5),
        ("share_tolerance", c_double),
        ("weigh_by_number", c_int32),
        ("reserved", c_int32),
        ("progress", c_void_p),
        ("progress_data", c_void_p),
    ]


class Interval(Structure):
    _fields_ = [("lower", c_double), ("upper", c_double)]


class Answer(Structure):
    _fields_ = [
        ("size", c_size_t),
        ("status", c_int32),
        ("to_source", c_int32),
        ("bounds", Interval),
        ("points", c_double * 6),
        ("source_row", c_int64),
        ("target_row", c_int64),
        ("seconds", c_double * 2),
    ]


class Library:
    def __init__(self, file: Path) -> None:
        self.functions = ctypes.CDLL(str(file))

    def call(self, name: str, *arguments: object) -> None:
        error = Error(size=ctypes.sizeof(Error))
        assert (
            getattr(self.functions, f"hausbench_{name}")(*arguments, byref(error)) == 0
        ), error.text

    def pair(self, a: Path, b: Path) -> c_void_p:
        shapes, pair = [c_void_p(), c_void_p()], c_void_p()
        for file, shape in zip((a, b), shapes):
            self.call("read", str(file).encode(), byref(shape))
        self.call("prepare", *shapes, None, byref(pair))
        return pair


def query(relative_to: int = 0, tolerance: float = 1e-6) -> Query:
    return Query(
        size=ctypes.sizeof(Query),
        tolerance=tolerance,
        relative_to=relative_to,
        threads=1,
        time_limit=float("inf"),
        share_tolerance=1e-3,
    )


def random_point(numbers: random.Random, size: float) -> str:
    """Returns the coordinates of a point in the cube from -size to size."""
    return " ".join(repr(numbers.uniform(-size, size)) for _ in range(3))


def shape(seed: int, file: Path) -> Path:
    """Writes a mesh of random triangles, every third time a point set, of one of several sizes; the
    first is a single point."""
    numbers = random.Random(seed)
    size, triangles = numbers.choice([1e-3, 1.0, 1.0, 1e6]), numbers.randrange(1, 25)
    points = (
        ["0.25 0.5 0.125"]
        if seed == 0
        else [random_point(numbers, size) for _ in range(3 * triangles)]
    )
    faces = (
        [] if seed % 3 == 0 else [f"3 {3 * i} {3 * i + 1} {3 * i + 2}" for i in range(triangles)]
    )
    file.write_text("\n".join(["OFF", f"{len(points)} {len(faces)} 0", *points, *faces]) + "\n")
    return file


@pytest.mark.parametrize("seed", range(12))
def test_bits(seed: int, library: Path, build: Path, tmp_path: Path) -> None:
    a, b, ours = (
        shape(seed, tmp_path / "a.off"),
        shape(7 * seed + 1, tmp_path / "b.off"),
        Library(library),
    )
    pair, answer = ours.pair(a, b), Answer(size=ctypes.sizeof(Answer))

    def measured(*options: str) -> dict[str, object]:
        return dict(
            json.loads(run(build / "hausbench", "measure", "--json", *options, a, b).stdout)
        )

    for relative_to, unit in enumerate(["diagonal", "absolute", "lower"]):
        unit_options = (
            [] if relative_to == 0 else ["--of", unit]
        )  # a diagonal of 0 is an error if it is asked for
        for name in ("directed", "symmetric"):
            ours.call(name, pair, byref(query(relative_to)), byref(answer))
            by_program = measured(*unit_options, *(["--symmetric"] if name == "symmetric" else []))
            assert [answer.bounds.lower, answer.bounds.upper] == [
                by_program["lower"],
                by_program["upper"],
            ], (name, unit)
            assert [answer.source_row, answer.target_row] == [
                by_program["source_element"],
                by_program["target_element"],
            ]
    length = 0.9 * answer.bounds.lower
    ours.call("within", pair, 0, c_double(length), None, byref(answer))
    by_program = measured("--cutoff", repr(length))
    assert [answer.bounds.lower, answer.bounds.upper] == [by_program["lower"], by_program["upper"]]
    names = [b"mean", b"rms", b"quantile 0.95", b"within 0.5"]
    values = (Interval * 4)()
    unit_options = [] if seed else ["--of", "absolute"]  # the box of a single point has no diagonal
    question = query(1 if unit_options else 0, 1e-3)
    ours.call(
        "distribution",
        pair,
        (c_char_p * 4)(*names),
        c_size_t(4),
        byref(question),
        values,
        byref(answer),
    )
    by_program = measured(
        "--tolerance",
        "1e-3",
        *unit_options,
        "--statistics",
        ",".join(name.decode() for name in names),
    )
    distribution = by_program["distribution"]
    assert isinstance(distribution, dict)
    expected = [
        distribution["mean"],
        distribution["rms"],
        distribution["quantiles"]["0.95"],
        distribution["share_within"]["0.5"],
    ]
    expected_bounds = [[bounds["lower"], bounds["upper"]] for bounds in expected]
    assert [[value.lower, value.upper] for value in values] == expected_bounds
    ours.functions.hausbench_pair_release(pair)


def test_the_structs_have_the_sizes_of_the_header() -> None:
    recorded = Path(__file__).with_name("abi.txt").read_text().splitlines()
    for name, struct in (
        ("error", Error),
        ("query", Query),
        ("interval", Interval),
        ("answer", Answer),
    ):
        assert f"struct hausbench_{name} {ctypes.sizeof(struct)}" in recorded
