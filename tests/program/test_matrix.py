"""A matrix of models: each shape is prepared once, and every pair has the same answer as on its
own."""

from __future__ import annotations

import random
from pathlib import Path

import h5py
import numpy as np
import pytest

from program import Program
from test_results import run_in
from test_run import numbers, texts

# Powers of two by which the models are scaled. A worker handles similar scales: a, b and small
# share one; tiny gets its own. Scaling `far` for a worker with b would lose bits that survive in
# one with a.
EXPONENTS = {"a": 0, "b": 30, "small": -40, "tiny": -300, "far": -1015}

SOLVERS = '[[solver]]\nname = "guthe"\n[[solver]]\nname = "earlybreak"\n[[solver]]\nname = "guthe"\nlabel = "H"\nquantity = "symmetric"\n'


def bumpy(seed: int, exponent: int, n: int = 9) -> str:
    """Returns an n x n grid of random heights, scaled by 2^exponent."""
    numbers_of = random.Random(seed)
    scale = 2.0**exponent
    vertices = [
        (scale * x / n, scale * y / n, scale * numbers_of.random())
        for y in range(n)
        for x in range(n)
    ]
    faces = [
        f
        for y in range(n - 1)
        for x in range(n - 1)
        for v in [n * y + x]
        for f in ((v, v + 1, v + n), (v + 1, v + n + 1, v + n))
    ]
    lines = [f"{x!r} {y!r} {z!r}" for x, y, z in vertices]
    lines += [f"3 {a} {b} {c}" for a, b, c in faces]
    return f"OFF\n{len(vertices)} {len(faces)} 0\n" + "\n".join(lines) + "\n"


@pytest.fixture
def root(tmp_path: Path) -> Path:
    folder = tmp_path / "root"
    (folder / "datasets").mkdir(parents=True)
    manifest = ""
    for i, (name, exponent) in enumerate(EXPONENTS.items()):
        (folder / "datasets" / f"{name}.off").write_text(bumpy(i, exponent))
        manifest += f'[model.{name}]\nsource = "file"\npath = "{name}.off"\nlicence = "none"\n'
    (folder / "datasets" / "manifest.toml").write_text(manifest)
    return folder


def write(file: Path, scenes: str, solvers: str = SOLVERS) -> Path:
    file.write_text(
        f'title = "a matrix"\ntolerances = [1e-3, 1e-2]\nof = "diagonal"\nrepeats = 1\n{scenes}{solvers}'
    )
    return file


def test_pairs_have_the_same_bits_alone_and_in_the_matrix(
    hausbench: Program, root: Path, tmp_path: Path
) -> None:
    names = list(EXPONENTS)
    matrix = write(
        tmp_path / "matrix.toml", f'[[scene]]\nname = "all"\nsources = {names}\ntargets = {names}\n'
    )
    alone = write(
        tmp_path / "alone.toml",
        "".join(
            f'[[scene]]\nname = "all: {a} to {b}"\nsource = "{a}"\ntarget = "{b}"\n'
            for a in names
            for b in names
        ),
    )
    for file in (matrix, alone):
        done = run_in(hausbench, root, "run", file, "--results", tmp_path, "--quiet")
        assert done.returncode == 0, done.stderr
    together, apart = tmp_path / "matrix.h5", tmp_path / "alone.h5"
    assert len(texts(together, "cases/scene")) == 3 * 25 * 2
    for column in ("scene", "solver", "identity", "status", "lower_check", "upper_check"):
        assert texts(together, f"cases/{column}") == texts(apart, f"cases/{column}"), column
    # earlybreak takes no meshes: "skipped". The tolerance of a tiny A near a large B is below
    # double precision: "floor".
    statuses = [
        texts(together, "cases/status").count(status) for status in ("ok", "floor", "skipped")
    ]
    assert sum(statuses) == 150 and statuses[2] == 50 and min(statuses) > 0
    with h5py.File(together) as f:
        counters = [name for name in f["cases"] if name.startswith("counter_")]
    for column in (
        "lower",
        "upper",
        "witness_source",
        "witness_target",
        "witness_source_element",
        *counters,
    ):
        np.testing.assert_array_equal(
            numbers(together, f"cases/{column}"), numbers(apart, f"cases/{column}"), err_msg=column
        )
    ok = np.array([status in ("ok", "floor") for status in texts(together, "cases/status")])
    assert (numbers(together, "cases/peak_bytes") == -1).all() and (
        numbers(apart, "cases/peak_bytes")[ok] >= 0
    ).all()
    assert np.isfinite(numbers(together, "cases/prepare_seconds")[ok]).all()


def ledger(file: Path, left_out: str) -> list[tuple[str, str, int]]:
    subjects, reasons = texts(file, "ledger/subject"), texts(file, "ledger/reason")
    entries = zip(subjects, texts(file, "ledger/what"), reasons, numbers(file, "ledger/count"))
    return [
        (subject, reason, int(count))
        for subject, entry, reason, count in entries
        if entry == left_out
    ]


def test_each_shape_is_prepared_once_and_the_ledger_says_so(
    hausbench: Program, root: Path, tmp_path: Path
) -> None:
    manifest = root / "datasets" / "manifest.toml"
    names = [f"m{i}" for i in range(10)]
    for i, name in enumerate(names):
        (root / "datasets" / f"{name}.off").write_text(bumpy(100 + i, 0, 6))
        manifest.write_text(
            manifest.read_text()
            + f'[model.{name}]\nsource = "file"\npath = "{name}.off"\nlicence = "none"\n'
        )
    file = write(
        tmp_path / "ten.toml",
        f'[[scene]]\nname = "ten"\nsources = {names}\n',
        '[[solver]]\nname = "guthe"\n',
    )
    done = run_in(hausbench, root, "run", file, "--results", tmp_path, "--quiet")
    assert done.returncode == 0, done.stderr
    result = tmp_path / "ten.h5"
    assert texts(result, "cases/status") == ["ok"] * 200
    # Each pair uses two octrees: as source and as target.
    assert ledger(result, "structures for each pair") == [
        ("guthe on ten", "octree: built over 10 shapes and used 200 times by 100 pairs", 190)
    ]
    shown = run_in(hausbench, root, "explain", file)
    assert "each of 10 shapes is loaded and prepared once for all 100 pairs" in shown.stdout
    # A pair can be run alone.
    pair = run_in(
        hausbench,
        root,
        "run",
        file,
        "--results",
        tmp_path / "pair",
        "--quiet",
        "--scene",
        "ten: m3 to m4",
    )
    assert pair.returncode == 0 and len(texts(tmp_path / "pair" / "ten.h5", "cases/scene")) == 2


def test_far_scales_get_a_worker_of_their_own(
    hausbench: Program, root: Path, tmp_path: Path
) -> None:
    names = list(EXPONENTS)
    file = write(
        tmp_path / "matrix.toml",
        f'[[scene]]\nname = "all"\nsources = {names}\n',
        '[[solver]]\nname = "guthe"\n',
    )
    shown = run_in(hausbench, root, "explain", file).stdout
    pairs = sorted(int(words.split()[0]) for words in shown.split("for all ")[1:])
    assert (
        pairs == [2, 3, 5, 14] and shown.count("  guthe on all ") == 5
    )  # far shares a worker only with itself


def test_directions_and_pairs_are_counted_apart(
    hausbench: Program, root: Path, tmp_path: Path
) -> None:
    solvers = '[[solver]]\nname = "guthe"\n[[solver]]\nname = "guthe"\nquantity = "symmetric"\nscenes = ["all: a to b", "all: b to a"]\n'
    file = write(
        tmp_path / "matrix.toml", '[[scene]]\nname = "all"\nsources = ["a", "b"]\n', solvers
    )
    assert run_in(hausbench, root, "run", file, "--results", tmp_path, "--quiet").returncode == 0
    result = tmp_path / "matrix.h5"
    assert len(texts(result, "cases/scene")) == 4 * 2 + 2 * 2
    # h and H count separately: each pair needs two octrees, and each octree is built once.
    assert ledger(result, "structures for each pair") == [
        ("guthe on all", "octree: built over 2 shapes and used 8 times by 4 pairs", 6),
        ("guthe on all", "octree: built over 2 shapes and used 4 times by 2 pairs", 2),
    ]


def test_a_crash_costs_its_case_alone(hausbench: Program, root: Path, tmp_path: Path) -> None:
    (root / "datasets" / "b.off").write_text(
        "OFF\n3 1 0\n0 0 nan\n1 0 0\n0 1 0\n3 0 1 2\n"
    )  # damaged, so its pairs fail with a reason
    file = write(
        tmp_path / "matrix.toml",
        '[[scene]]\nname = "all"\nsources = ["a", "b"]\n',
        '[[solver]]\nname = "guthe"\n',
    )
    done = run_in(hausbench, root, "run", file, "--results", tmp_path, "--quiet")
    assert done.returncode == 0, done.stderr
    result = tmp_path / "matrix.h5"
    by_scene = dict(zip(texts(result, "cases/scene"), texts(result, "cases/status")))
    assert by_scene == {
        "all: a to a": "ok",
        "all: a to b": "failed",
        "all: b to a": "failed",
        "all: b to b": "failed",
    }


@pytest.mark.parametrize(
    ("scene", "says"),
    [
        ('sources = ["a"]\nsource = "a"', "'source' is of one pair"),
        ("sources = []", "'sources' names no model"),
        ('sources = ["a", "a"]', "'sources' names a model twice"),
        ('targets = ["a"]', "'targets' makes a matrix together with 'sources'"),
        ('sources = ["a"]\ntargets = ["nobody"]', "nobody"),
    ],
)
def test_what_is_no_matrix(
    hausbench: Program, root: Path, tmp_path: Path, scene: str, says: str
) -> None:
    file = write(
        tmp_path / "bad.toml", f'[[scene]]\nname = "bad"\n{scene}\n', '[[solver]]\nname = "guthe"\n'
    )
    done = run_in(hausbench, root, "run", file, "--results", tmp_path)
    assert done.returncode == 2 and says in done.stderr, done.stderr
