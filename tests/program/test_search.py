"""`search = "nearest"` finds the same nearest target as the complete matrix, and ends early for
farther ones."""

from __future__ import annotations

import random
import sys
import time
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

from program import Program
from test_matrix import bumpy
from test_results import run_in
from test_run import numbers, run, start, texts

MODELS = [f"m{i}" for i in range(8)]

EXPERIMENT = """\
title = "a search"
tolerances = {tolerances}
of = "diagonal"
repeats = 1
{top}
[[scene]]
name = "all"
sources = {sources}
{search}
{solvers}
"""
SOLVERS = '[[solver]]\nname = "guthe"\n[[solver]]\nname = "guthe"\nlabel = "H"\nquantity = "symmetric"\n[[solver]]\nname = "cgal"\n'
COUNTERS = ("point_triangle_distances", "node_visits")


@pytest.fixture
def shapes(tmp_path: Path) -> list[str]:
    """Grids of random heights, some rougher than others, so that the order of targets matters."""
    paths = []
    for i, name in enumerate(MODELS):
        flat, rough = bumpy(0, 0).splitlines(), bumpy(i + 1, 0).splitlines()
        for k in range(2, 2 + 81):
            (x, y, z), height = flat[k].split(), float(rough[k].split()[2])
            flat[k] = f"{x} {y} {float(z) + 0.3 * ((5 * i) % 8 + 1) * height!r}"
        (tmp_path / f"{name}.off").write_text("\n".join(flat) + "\n")
        paths.append(f"{name}.off")
    return paths


def write(
    file: Path,
    sources: list[str],
    search: str = 'search = "nearest"',
    solvers: str = SOLVERS,
    top: str = "",
    tolerances: str = "[1e-3]",
) -> Path:
    file.write_text(
        EXPERIMENT.format(
            sources=sources, search=search, solvers=solvers, top=top, tolerances=tolerances
        )
    )
    return file


Rows = dict[tuple[str, str, float, str], dict[str, Any]]


def rows_of(file: Path) -> Rows:
    """Returns the rows by label, source, tolerance and target, in the file's order."""
    with h5py.File(file, "r") as f:
        columns = {
            name: column.asstr()[:] if h5py.check_string_dtype(column.dtype) else column[:]
            for name, column in f["cases"].items()
        }
    rows = [dict(zip(columns, values)) for values in zip(*columns.values(), strict=True)]
    return {
        (row["label"], row["source"], float(row["tolerance"]), row["target"]): row for row in rows
    }


def chains(rows: Rows) -> dict[tuple[str, str, float], list[dict[str, Any]]]:
    rows_of_chain: dict[tuple[str, str, float], list[dict[str, Any]]] = {}
    for (label, source, tolerance, _), row in rows.items():
        rows_of_chain.setdefault((label, source, tolerance), []).append(row)
    return rows_of_chain


def fits(chain: list[dict[str, Any]], cutoff: float = np.inf) -> None:
    """Checks that each row names its predecessor, and that its cutoff is the smallest upper bound
    so far."""
    least, before = cutoff, ""
    for row in chain:
        assert row["chain"] == before and row["cutoff_used"] == least
        before = row["identity"]
        if not np.isnan(row["upper"]):
            least = min(least, row["upper"])


def same_rows(first: Rows, second: Rows) -> None:
    assert first.keys() == second.keys()
    for key, row in first.items():
        for column in (
            "identity",
            "chain",
            "status",
            "solver_status",
            "cutoff_used",
            "lower",
            "upper",
            *(f"counter_{name}" for name in COUNTERS),
        ):
            assert row[column] == second[key][column] or (
                row[column] != row[column] and second[key][column] != second[key][column]
            ), (key, column)


def test_the_nearest_is_that_of_the_matrix(
    hausbench: Program, shapes: list[str], tmp_path: Path
) -> None:
    searched = rows_of(
        run(
            hausbench,
            write(tmp_path / "searched.toml", shapes, tolerances="[1e-3, 1e-2]"),
            tmp_path,
        )
    )
    matrix = rows_of(
        run(
            hausbench,
            write(tmp_path / "matrix.toml", shapes, "", tolerances="[1e-3, 1e-2]"),
            tmp_path,
        )
    )
    assert len(searched) == 3 * 2 * 8 * 7 and len(matrix) == 3 * 2 * 8 * 8
    heads, cut_off, less = 0, 0, dict[str, int]()
    for (label, source, tolerance), chain in chains(searched).items():
        fits(chain)
        targets = [target for target in shapes if target != source]
        assert [row["target"] for row in chain] == targets
        whole = {target: matrix[label, source, tolerance, target] for target in targets}
        nearest = min(whole, key=lambda target: float(whole[target]["upper"]))
        best = min(chain, key=lambda row: float(row["upper"]))
        assert (best["target"], best["upper"]) == (nearest, whole[nearest]["upper"])
        for row in chain:
            assert (
                row["status"] == "ok"
                and row["from_trace"] == 0
                and row["lower_check"] in ("holds", "no witness")
            )
            assert row["answer"] == ("h > cutoff" if row["lower"] > row["cutoff_used"] else "gap")
            cut_off += row["answer"] == "h > cutoff"
            # The first row is also a case of the matrix; the others have a cutoff.
            case = whole[row["target"]]
            assert (row["identity"] == case["identity"]) == (row is chain[0])
            assert case["cutoff_used"] == np.inf == row["cutoff"]
            heads += row is chain[0]
        for name in COUNTERS:
            work = sum(int(row[f"counter_{name}"]) for row in chain)
            of_matrix = sum(int(row[f"counter_{name}"]) for row in whole.values())
            assert work <= of_matrix
            less[label] = less.get(label, 0) + of_matrix - work
    assert heads == 3 * 2 * 8 and cut_off > 100
    assert less["guthe"] > 10_000 and less["H"] > 10_000 and less["cgal"] == 0


def test_another_order_is_another_search(
    hausbench: Program, shapes: list[str], tmp_path: Path
) -> None:
    forward = rows_of(run(hausbench, write(tmp_path / "forward.toml", shapes), tmp_path))
    backward = rows_of(run(hausbench, write(tmp_path / "backward.toml", shapes[::-1]), tmp_path))
    identities = {row["identity"] for row in forward.values()}
    assert identities.isdisjoint(row["identity"] for row in backward.values())
    for key, chain in chains(backward).items():
        fits(chain)
        least = min(float(row["upper"]) for row in chain)
        assert least == min(float(row["upper"]) for row in chains(forward)[key])


def test_the_experiments_own_cutoff_and_floor_count(
    hausbench: Program, shapes: list[str], tmp_path: Path
) -> None:
    file = write(tmp_path / "own.toml", shapes, top="cutoff = 0.3\nfloor = 0.25")
    rows = rows_of(run(hausbench, file, tmp_path))
    seen = set()
    for chain in chains(rows).values():
        cutoff, floor, least = (
            float(chain[0]["cutoff"]),
            float(chain[0]["floor"]),
            float(chain[0]["cutoff"]),
        )
        for row in chain:
            assert (
                row["cutoff_used"] == max(least, np.nextafter(floor, np.inf))
                and row["cutoff"] == cutoff
            )
            least = min(least, float(row["upper"]))
            seen.add(
                (
                    "own" if row["cutoff_used"] == cutoff else "less",
                    "of interest"
                    if row["cutoff_used"] > np.nextafter(floor, np.inf)
                    else "at the floor",
                )
            )
    assert seen == {("own", "of interest"), ("less", "of interest"), ("less", "at the floor")}


def test_a_copy_at_distance_0_does_not_hang_the_rest(
    hausbench: Program, shapes: list[str], tmp_path: Path
) -> None:
    """After a copy of the source, the cutoff stays slightly above 0: whether a second copy is above
    0 cannot be decided."""
    for name in ("copy", "again"):
        (tmp_path / f"{name}.off").write_text((tmp_path / shapes[0]).read_text())
    file = write(
        tmp_path / "copies.toml",
        [shapes[0]],
        'targets = ["copy.off", "again.off", "m1.off"]\nsearch = "nearest"',
    )
    for (label, _, _), (first, again, third) in chains(
        rows_of(run(hausbench, file, tmp_path))
    ).items():
        assert (
            first["status"] == again["status"] == "ok"
            and again["answer"] == "gap"
            and 0 < again["cutoff_used"] < 1e-6
        )
        assert label == "cgal" or third["answer"] == "h > cutoff"


PEER = """\
import os, signal, sys, time
height = float(open(sys.argv[2]).read().split()[6])
if height in {bad}:
    how = "{how}"
    if how == "throw":
        sys.exit(3)
    if how == "hang":
        time.sleep(60)
    worker = os.getppid()
    while b"worker" not in open(f"/proc/{{worker}}/cmdline", "rb").read().split(b"\\0"):
        worker = int(open(f"/proc/{{worker}}/stat").read().rsplit(")", 1)[1].split()[1])
    os.kill(worker, signal.SIGKILL)
    time.sleep(60)
print(f"h = {{height}}")
print(f"at most {{height + 0.125}}")
"""
EXTERNAL = """\
[[solver]]
name = "external"
label = "peer"
parameters = {{ command = '{python} {peer} {{A}} {{B}}', lower = 'h = (\\S+)', upper = 'at most (\\S+)' }}
"""


@pytest.fixture
def levels(tmp_path: Path) -> list[str]:
    """Triangles at several heights, which are their distances from the triangle at height 0."""
    for height in (0, 8, 5, 6, 3, 7, 2):
        (tmp_path / f"at{height}.off").write_text(
            f"OFF\n3 1 0\n0 0 {height}\n1 0 {height}\n0 1 {height}\n3 0 1 2\n"
        )
    return [f"at{height}.off" for height in (8, 5, 6, 3, 7, 2)]


def leveled(
    tmp_path: Path,
    levels: list[str],
    how: str,
    bad: str = "{5.0, 6.0}",
    top: str = "limits = { case_seconds = 1 }",
) -> Path:
    (tmp_path / "peer.py").write_text(PEER.format(how=how, bad=bad))
    peer = EXTERNAL.format(python=sys.executable, peer=tmp_path / "peer.py")
    return write(
        tmp_path / "levels.toml",
        ["at0.off"],
        f'targets = {levels}\nsearch = "nearest"',
        peer,
        top,
        "[1.0]",
    )


@pytest.mark.parametrize(
    ("how", "status"),
    [("throw", "failed"), ("hang", "timeout"), ("kill", "signal"), ("nothing", "ok")],
)
def test_what_ends_by_error_counts_nothing(
    hausbench: Program, levels: list[str], tmp_path: Path, how: str, status: str
) -> None:
    file = leveled(tmp_path, levels, how, "{5.0, 6.0}" if how != "nothing" else "{-1.0}")
    rows = list(rows_of(run(hausbench, file, tmp_path)).values())
    assert [row["status"] for row in rows] == ["ok", status, status, "ok", "ok", "ok"]
    lost = how != "nothing"
    used = [np.inf, 8.125, 8.125 if lost else 5.125, 8.125 if lost else 5.125, 3.125, 3.125]
    for row, cutoff in zip(rows, used):
        assert row["status"] != "ok" or row["cutoff_used"] == cutoff
    assert [row["answer"] for row in rows] == [
        "gap",
        *(["", ""] if lost else ["gap", "h > cutoff"]),
        "gap",
        "h > cutoff",
        "gap",
    ]


def test_rounds_ask_with_the_cutoffs_of_the_first(
    hausbench: Program, levels: list[str], tmp_path: Path
) -> None:
    file = leveled(tmp_path, levels, "nothing", "{-1.0}", "rounds = 3")
    rows = list(rows_of(run(hausbench, file, tmp_path)).values())
    assert [row["cutoff_used"] for row in rows] == [np.inf, 8.125, 5.125, 5.125, 3.125, 3.125]
    assert sorted(
        zip(
            numbers(tmp_path / "levels.h5", "repeats/case"),
            numbers(tmp_path / "levels.h5", "repeats/round"),
        )
    ) == [(i, k) for i in range(6) for k in range(3)]


def test_a_model_that_is_missing_is_no_part_of_the_search(
    hausbench: Program, levels: list[str], tmp_path: Path
) -> None:
    file = leveled(tmp_path, levels, "nothing", "{-1.0}")
    (tmp_path / "at5.off").write_text("OFF\n3 1 0\n0 0 nan\n1 0 0\n0 1 0\n3 0 1 2\n")  # damaged
    (tmp_path / "at8.off").write_text("OFF\n")
    rows = list(rows_of(run(hausbench, file, tmp_path)).values())
    assert [row["status"] for row in rows] == ["failed", "failed", "ok", "ok", "ok", "ok"]
    fits(rows[2:])
    assert [row["chain"] for row in rows[:3]] == ["", "", ""]
    assert [row["cutoff_used"] for row in rows[:2]] == [np.inf, np.inf]


def test_kill_resume_shards_and_nothing_left_out(
    hausbench: Program, shapes: list[str], tmp_path: Path
) -> None:
    file = write(tmp_path / "slow.toml", shapes, top="trace = true", tolerances="[1e-6, 1e-3]")
    begin = time.monotonic()
    whole = rows_of(run(hausbench, file, tmp_path / "whole"))
    seconds = time.monotonic() - begin
    moments = random.Random(5)
    for _ in range(8):
        process = start(hausbench, file, tmp_path / "killed")
        time.sleep(moments.uniform(0.02, max(0.1, 0.7 * seconds)))
        process.kill()
        process.wait()
    same_rows(rows_of(run(hausbench, file, tmp_path / "killed")), whole)
    assert (
        hausbench(
            "run", file, "--results", tmp_path / "everything", "--leave-nothing-out"
        ).returncode
        == 0
    )
    (everything,) = (tmp_path / "everything").glob("*.h5")
    same_rows(rows_of(everything), whole)
    for i in (1, 2, 3):
        assert (
            hausbench("run", file, "--results", tmp_path / "parts", "--shard", f"{i}/3").returncode
            == 0
        )
    merged = tmp_path / "merged.h5"
    assert hausbench("merge", merged, *sorted((tmp_path / "parts").glob("*.h5"))).returncode == 0
    same_rows(rows_of(merged), whole)
    # If a row is lost, its source's whole search is run again.
    journal = tmp_path / "whole" / "slow.journal"
    lines = journal.read_bytes().splitlines(True)
    identity = next(
        row["identity"]
        for row in whole.values()
        if row["label"] == "H" and row["target"] == shapes[5]
    )
    journal.write_bytes(b"".join(line for line in lines if identity.encode() not in line))
    same_rows(rows_of(run(hausbench, file, tmp_path / "whole")), whole)
    assert len(journal.read_bytes().splitlines()) == len(lines) - 1 + 7
    for verb in ("verify", "show"):
        assert hausbench(verb, tmp_path / "whole" / "slow.h5").returncode == 0
    compared = hausbench("compare", tmp_path / "whole" / "slow.h5", merged)
    assert compared.returncode == 0, compared.stderr
    assert "each target is the least upper bound" in hausbench("explain", file).stdout


def test_far_scales_stay_one_search(hausbench: Program, tmp_path: Path) -> None:
    """In a search, shapes of very different scale share a worker; each pair has the same bits as
    with the same cutoff alone."""
    root = tmp_path / "root"
    (root / "datasets").mkdir(parents=True)
    manifest = ""
    for i, (name, exponent) in enumerate(
        {"a": 0, "far": 300, "b": 0, "tiny": -300, "c": 1}.items()
    ):
        (root / "datasets" / f"{name}.off").write_text(bumpy(i, exponent))
        manifest += f'[model.{name}]\nsource = "file"\npath = "{name}.off"\nlicence = "none"\n'
    (root / "datasets" / "manifest.toml").write_text(manifest)
    file = write(
        tmp_path / "scales.toml",
        ["a", "far", "b", "tiny", "c"],
        solvers='[[solver]]\nname = "guthe"\n',
    )
    assert run_in(hausbench, root, "run", file, "--results", tmp_path, "--quiet").returncode == 0
    for chain in chains(rows_of(tmp_path / "scales.h5")).values():
        fits(chain)
    shown = run_in(hausbench, root, "explain", file).stdout
    assert shown.count("  guthe on all ") == 1 and "each of" not in shown


@pytest.mark.parametrize(
    ("changed", "says"),
    [
        (
            {"search": 'search = "nearst"'},
            (":9: 'search' must be \"nearest\", not 'nearst'", "did you mean 'nearest'"),
        ),
        ({"search": "search = true"}, (":9: 'search' must be a text",)),
        (
            {
                "search": 'search = "nearest"\nmotion = { kind = "rotation", axis = [0, 0, 1], degrees = 90 }'
            },
            (":9: 'search' is among shapes that stand still", "remove it"),
        ),
        (
            {"search": 'search = "nearest"\ntargets = ["a"]', "sources": ["a"]},
            (":9: 'search' has no two models", "name other 'targets'"),
        ),
        (
            {"solvers": '[[solver]]\nname = "cover"\nwarm = true\n'},
            (":12: 'warm' cannot be combined with 'all', a search", "remove it"),
        ),
        (
            {"solvers": '[[solver]]\nname = "cover"\nscenes = ["all: a to b"]\n'},
            (":12: 'all: a to b' is a pair of a search", "name the whole of it, 'all'"),
        ),
    ],
)
def test_what_is_no_search(
    hausbench: Program, tmp_path: Path, changed: dict[str, Any], says: tuple[str, ...]
) -> None:
    line = hausbench.fails(
        "explain",
        write(tmp_path / "bad.toml", **dict[str, Any]({"sources": ["a", "b"], **changed})),
    )
    assert all(words in line for words in says), line


def test_only_a_matrix_is_searched(hausbench: Program, tmp_path: Path) -> None:
    file = write(tmp_path / "bad.toml", ["a", "b"])
    file.write_text(file.read_text().replace("sources = ['a', 'b']", 'source = "a"\ntarget = "b"'))
    line = hausbench.fails("explain", file)
    assert (
        ":10: 'search' is of a matrix" in line
        and "give 'sources' and 'targets', or remove it" in line
    )


def test_a_pair_of_a_search_is_not_chosen_alone(
    hausbench: Program, levels: list[str], tmp_path: Path
) -> None:
    file = leveled(tmp_path, levels, "nothing", "{-1.0}")
    line = hausbench.fails("explain", file, "--scene", "all: at0.off to at5.off")
    assert "is a pair of a search: choose the whole of it, 'all'" in line
    assert hausbench("run", file, "--results", tmp_path, "--scene", "all").returncode == 0
    assert texts(tmp_path / "levels.h5", "cases/status") == ["ok"] * 6
