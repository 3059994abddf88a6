"""Result files are written whole or not at all, never trusted when read, and can be verified,
merged and compared."""

from __future__ import annotations

import hashlib
import json
import random
import resource
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest

from program import ROOT, Program
from test_run import numbers, run, same_answers, slow, texts  # noqa: F401  (slow is a fixture)

SMOKE = ROOT / "experiments" / "smoke.toml"


def with_small_files(hausbench: Program, largest: int, *arguments: str | Path, **more: str) -> str:
    """Runs with a limit on the size of files, as on a full disk. Returns the one line of the
    error."""
    done = subprocess.run(
        hausbench.command(*arguments),
        cwd=hausbench.folder,
        env={**hausbench.environment(), **more},
        capture_output=True,
        text=True,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (largest, largest)),
        timeout=120,
    )
    assert done.returncode == 2, (largest, done.returncode, done.stderr)
    assert len(done.stderr.strip().splitlines()) == 1, done.stderr
    return done.stderr


def test_disk_full_while_the_result_is_written(
    hausbench: Program, experiment: Path, tmp_path: Path
) -> None:
    whole = run(hausbench, experiment, tmp_path / "whole")
    size, journal = whole.stat().st_size, whole.with_suffix(".journal").stat().st_size
    assert 2 * journal < size
    for largest in (2 * journal, size // 2, size - 1):
        folder = tmp_path / f"full-{largest}"
        line = with_small_files(
            hausbench, largest, "run", experiment, "--results", folder, "--quiet"
        )
        assert "cannot write the result" in line and "make room" in line
        assert sorted(file.name for file in folder.iterdir()) == [
            "tiny.journal",
            "tiny.reference.journal",
        ]
        same_answers(run(hausbench, experiment, folder), whole)
    line = with_small_files(hausbench, size // 2, "merge", tmp_path / "merged.h5", whole, whole)
    assert "merged.h5" in line and "make room" in line
    assert not list(tmp_path.glob("merged.h5*"))


def test_disk_full_while_a_shape_is_written(
    hausbench: Program, experiment: Path, tetrahedron: Path, tmp_path: Path
) -> None:
    cache = tmp_path / "cache"
    experiment.write_text(experiment.read_text().replace("sphere2", "sphere5"))
    environment = {**hausbench.environment(), "HAUSBENCH_CACHE": str(cache)}
    for largest, status in (
        (200_000, "failed"),
        (resource.RLIM_INFINITY, "ok"),
    ):  # enough for the result, but not for the shape
        done = subprocess.run(
            hausbench.command("run", experiment, "--results", tmp_path, "--quiet"),
            env=environment,
            capture_output=True,
            text=True,
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (largest, largest)),
            timeout=120,
        )
        assert done.returncode == 0, done.stderr
        assert texts(tmp_path / "tiny.h5", "cases/status") == [status]
        reason = texts(tmp_path / "tiny.h5", "cases/reason")[0]
        assert ("make room" in reason and "HAUSBENCH_CACHE" in reason) == (status == "failed")
    line = with_small_files(hausbench, 500, "measure", tetrahedron, tetrahedron)
    assert "make room" in line and "TMPDIR" in line and "damaged" not in line


@pytest.fixture
def scaled(tmp_path: Path) -> Callable[[str, dict[str, float]], Path]:
    """A project with two models per name: a tetrahedron and one 0.25 higher, both scaled by the
    given number."""

    def make(experiment: str, scales: dict[str, float]) -> Path:
        root = tmp_path / "root"
        (root / "datasets").mkdir(parents=True)
        manifest = ""
        for name, scale in scales.items():
            for model, up in ((name, 0.0), (f"{name}_raised", 0.25)):
                corners = "".join(
                    f"{x * scale!r} {y * scale!r} {(z + up) * scale!r}\n"
                    for x, y, z in ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))
                )
                text = f"OFF\n4 4 0\n{corners}3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n"
                (root / "datasets" / f"{model}.off").write_text(text)
                digest = hashlib.sha256(text.encode()).hexdigest()
                manifest += f'[model.{model}]\nsource = "file"\npath = "{model}.off"\nsha256 = "{digest}"\nlicence = "none"\n'
        (root / "datasets" / "manifest.toml").write_text(manifest)
        scenes = "".join(
            f'[[scene]]\nname = "{name}"\nsource = "{name}_raised"\ntarget = "{name}"\n'
            for name in scales
        )
        (tmp_path / "scaled.toml").write_text(
            f'title = "scales"\ntolerances = [1e-3]\nof = "diagonal"\nrepeats = 1\n{scenes}{experiment}'
        )
        return root

    return make


def run_in(
    hausbench: Program, root: Path, *arguments: str | Path, timeout: float = 60
) -> subprocess.CompletedProcess[str]:
    environment = {
        **hausbench.environment(),
        "HAUSBENCH_ROOT": str(root),
        "HAUSBENCH_CACHE": str(root / "cache"),
    }
    return subprocess.run(
        hausbench.command(*arguments),
        cwd=hausbench.folder,
        env=environment,
        capture_output=True,
        text=True,
        timeout=timeout,
    )


SCALES = {
    "least": 1e-320,
    "subnormal": 1e-310,
    "small": 1e-160,
    "one": 1.0,
    "large": 1e156,
    "most": 1e308,
}


def test_checks_end_and_hold_at_every_scale(
    hausbench: Program, scaled: Callable[[str, dict[str, float]], Path], tmp_path: Path
) -> None:
    root = scaled('[[solver]]\nname = "guthe"\n[[solver]]\nname = "naive"\n', SCALES)
    done = run_in(hausbench, root, "run", "scaled.toml", "--results", tmp_path, "--quiet")
    assert done.returncode == 0, done.stderr
    file = tmp_path / "scaled.h5"
    rows = list(
        zip(
            texts(file, "cases/scene"),
            texts(file, "cases/solver"),
            texts(file, "cases/status"),
            texts(file, "cases/lower_check"),
            numbers(file, "cases/lower"),
        )
    )
    for scene, solver, status, check, lower in rows:
        if solver != "guthe":
            continue
        assert status in ("ok", "floor"), (scene, status)
        assert check == "holds" and lower > 0, (scene, check, lower)
        assert lower == pytest.approx(0.25 * SCALES[scene], rel=0.01), scene


def test_poses_beyond_the_range_are_refused_and_far_ones_answered(
    hausbench: Program, scaled: Callable[[str, dict[str, float]], Path], tmp_path: Path
) -> None:
    root = scaled('[[solver]]\nname = "guthe"\n', {"most": 1e308, "one": 1.0})
    experiment = tmp_path / "scaled.toml"
    for scene, to in (("most", 1.7e308), ("one", 1e300)):
        motion = f'motion = {{ kind = "translation", from = [0, 0, 0], to = [{to}, 0, 0], steps = 2, of = "absolute" }}'
        experiment.write_text(
            experiment.read_text().replace(
                f'target = "{scene}"\n', f'target = "{scene}"\n{motion}\n'
            )
        )
    experiment.write_text(
        experiment.read_text().replace('[1e-3]\nof = "diagonal"', '[1e-3]\nof = "lower"')
    )
    done = run_in(hausbench, root, "run", "scaled.toml", "--results", tmp_path, "--quiet")
    assert done.returncode == 0, done.stderr
    file = tmp_path / "scaled.h5"
    cases = list(zip(texts(file, "cases/scene"), numbers(file, "cases/pose_index")))
    status, reason = dict(zip(cases, texts(file, "cases/status"))), dict(
        zip(cases, texts(file, "cases/reason"))
    )
    assert status == {
        ("most", 0): "ok",
        ("most", 1): "failed",
        ("one", 0): "ok",
        ("one", 1): "ok",
    }, reason
    assert "beyond the largest double" in reason["most", 1] and "larger unit" in reason["most", 1]


def damaged(good: Path, changes: dict[str, object], row: int) -> Path:
    bad = good.with_name("bad.h5")
    shutil.copy(good, bad)
    with h5py.File(bad, "r+") as f:
        for column, value in changes.items():
            f[f"cases/{column}"][row] = value
    return bad


HUGE = np.full(12, 1e308)


@pytest.mark.parametrize(
    "changes",
    [
        {"pose": np.full(12, np.nan)},
        {"pose": HUGE},
        {"pose": np.where(np.arange(12) == 0, np.inf, 0)},
        {"lower": 1.797e308, "upper": 1.797e308},
        {"lower": np.inf, "upper": np.inf},
        {"witness_source": np.array([1e200, 0, 0])},
        {"witness_source": np.array([1e200, 0, 0]), "witness_source_element": -1},
        {"witness_source": np.full(3, 1.79e308), "witness_source_element": -1},
        {"witness_source": np.full(3, -1.79e308), "lower": 1.797e308, "upper": 1.797e308},
    ],
    ids=str,
)
def test_verify_takes_any_number(
    hausbench: Program, experiment: Path, tmp_path: Path, changes: dict[str, object]
) -> None:
    good = run(hausbench, experiment, tmp_path)
    done = hausbench("verify", damaged(good, changes, 0), timeout=20)
    assert done.returncode in ((0, 1) if "pose" in changes else (1,)), (
        done.returncode,
        done.stdout,
        done.stderr,
    )
    row = done.stdout.splitlines()[1].split()
    assert row[0] == "guthe" and row[1] == "0", row  # never counted as `holds`


def test_a_reason_is_that_of_every_row_it_is_said_of(hausbench: Program, tmp_path: Path) -> None:
    good = run(hausbench, SMOKE, tmp_path)
    solver, witness = texts(good, "cases/solver"), numbers(good, "cases/witness_source")
    first = next(
        i for i, s in enumerate(solver) if s == "guthe" and numbers(good, "cases/lower")[i] > 0
    )
    rows = [
        i
        for i, s in enumerate(solver)
        if s == "guthe" and np.array_equal(witness[i], witness[first])
    ]
    assert len(rows) > 1
    bad = tmp_path / "bad.h5"
    shutil.copy(good, bad)
    with h5py.File(bad, "r+") as f:
        for i in rows:
            f["cases/lower"][i], f["cases/upper"][i] = 99.0, 100.0
    done = hausbench("verify", bad)
    shown = [
        line.rsplit("(", 1)[1]
        for line in done.stdout.splitlines()
        if "above the distance of its witness" in line
    ]
    assert (
        done.returncode == 1
        and len(shown) >= len(rows)
        and not any(text.startswith("0)") for text in shown)
    )


def without_the_models(root: Path) -> None:
    """Replaces the models with files of a package that was never fetched."""
    manifest = root / "datasets" / "manifest.toml"
    manifest.write_text(
        manifest.read_text().replace(
            'source = "file"', 'source = "debian"\npackage = "absent"\nversion = "1"'
        )
    )
    shutil.rmtree(root / "cache")


def test_verify_without_the_models_says_so(
    hausbench: Program, scaled: Callable[[str, dict[str, float]], Path], tmp_path: Path
) -> None:
    root = scaled('[[solver]]\nname = "guthe"\n', {"one": 1.0})
    assert run_in(hausbench, root, "run", "scaled.toml", "--results", tmp_path).returncode == 0
    bad = damaged(tmp_path / "scaled.h5", {"lower": 99.0, "upper": 100.0}, 0)
    assert texts(bad, "cases/lower_check") == ["holds"]
    without_the_models(root)
    done = run_in(hausbench, root, "verify", bad)
    assert done.returncode == 1
    assert done.stdout.splitlines()[1].split()[1:5] == [
        "0",
        "0",
        "1",
        "(0)",
    ]  # counted as not checked, whatever the file claims
    assert "'one_raised' is not here" in done.stderr and "absent" in done.stderr


def test_merge_takes_the_row_of_the_machine_that_had_the_model(
    hausbench: Program, scaled: Callable[[str, dict[str, float]], Path], tmp_path: Path
) -> None:
    root = scaled('[[solver]]\nname = "guthe"\n', {"one": 1.0, "two": 2.0})
    assert (
        run_in(hausbench, root, "run", "scaled.toml", "--results", tmp_path / "with").returncode
        == 0
    )
    manifest = (root / "datasets" / "manifest.toml").read_text()
    without_the_models(root)
    assert (
        run_in(hausbench, root, "run", "scaled.toml", "--results", tmp_path / "without").returncode
        == 0
    )
    (root / "datasets" / "manifest.toml").write_text(manifest)
    parts = [tmp_path / "with" / "scaled.h5", tmp_path / "without" / "scaled.h5"]
    assert texts(parts[1], "cases/status") == ["skipped", "skipped"]
    for name, order in (("one.h5", parts), ("other.h5", parts[::-1])):
        done = run_in(hausbench, root, "merge", name, *order)
        assert done.returncode == 0 and "2 cases" in done.stdout, done.stderr
        assert texts(tmp_path / name, "cases/status") == ["ok", "ok"]
        same_answers(tmp_path / name, parts[0])
        assert texts(tmp_path / name, "cases/lower_check") == ["holds", "holds"]


DERIVED = """
[[solver]]
name = "guthe"
[[scene]]
name = "derived"
source = "one_raised"
target = "welded"
[model.welded]
from = "one"
operation = "weld"
"""


def of_another_cgal(result: Path) -> Path:
    """Returns a copy of the result in which another version of CGAL derived another shape."""
    copy = result.with_name(f"other-{result.name}")
    shutil.copy(result, copy)
    with h5py.File(copy, "r+") as f:
        f["meta"].attrs["libraries"] = '{"CGAL": "0.1"}'
        f["models/sha256"][texts(result, "models/name").index("welded")] = "f" * 64
        f["cases/identity"][texts(result, "cases/scene").index("derived")] = "f" * 64
    return copy


def test_rows_of_other_shapes_are_neither_merged_nor_compared(
    hausbench: Program, scaled: Callable[[str, dict[str, float]], Path], tmp_path: Path
) -> None:
    root = scaled(DERIVED, {"one": 1.0})
    for shard in ((), ("--shard", "1/2"), ("--shard", "2/2")):
        done = run_in(hausbench, root, "run", "scaled.toml", "--results", tmp_path, *shard)
        assert done.returncode == 0, done.stderr
    here = tmp_path / "scaled.h5"
    there = of_another_cgal(here)
    for first, second in ((here, there), (there, here)):
        merged = tmp_path / f"{first.name}-first.h5"
        done = run_in(hausbench, root, "merge", merged, first, second)
        assert done.returncode == 0 and "2 cases of 2 results" in done.stdout, done.stderr
        assert (
            f"{second}: 1 of its cases are left out, because their models are other shapes in {first}: welded"
            in done.stderr
        )
        assert texts(merged, "cases/identity") == texts(first, "cases/identity")
        assert ("derives another shape than CGAL 0.1 did" in done.stderr) == (
            first == there
        )  # its rows are not checked
        assert texts(merged, "cases/lower_check") == (
            ["holds", "holds"] if first == here else ["holds", "not checked"]
        )
    done = run_in(hausbench, root, "compare", here, there)
    assert "1 cases in both, 1 only in the first, 1 only in the second\n" in done.stdout
    assert (
        "other shapes under these names: 1 and 1 cases of welded\nanswers: all the same\n"
        in done.stdout
    )
    only = run_in(hausbench, root, "compare", here, there, "--scene", "derived")
    assert (
        only.returncode != 0
        and "no case in common: not compared" in only.stderr
        and "1 and 1 cases of welded" in only.stderr
    )
    first, derived = sorted(
        tmp_path.glob("scaled.shard-*.h5"),
        key=lambda shard: texts(shard, "cases/status")[1] == "ok",
    )
    done = run_in(hausbench, root, "merge", tmp_path / "shards.h5", first, of_another_cgal(derived))
    assert (
        done.returncode == 1
        and "1 of its cases are left out" in done.stderr
        and "1 of 2 cases are in shards that are missing" in done.stderr
    )
    assert texts(tmp_path / "shards.h5", "cases/status") == ["ok", "skipped"]


def test_merge_takes_the_row_of_the_machine_that_had_the_solver(
    hausbench: Program, experiment: Path, tmp_path: Path
) -> None:
    complete, lacking = run(hausbench, experiment, tmp_path), tmp_path / "two.h5"
    shutil.copy(complete, lacking)
    with h5py.File(lacking, "r+") as f:  # what a build without the solver writes
        for column, value in (
            ("status", "not_built"),
            ("solver_status", ""),
            ("options", "{}"),
            ("identity", "0" * 64),
            ("lower", np.nan),
            ("upper", np.nan),
        ):
            f[f"cases/{column}"][0] = value
    for order in ((complete, lacking), (lacking, complete)):
        merged = tmp_path / f"{order[0].stem}-first.h5"
        assert hausbench("merge", merged, *order).returncode == 0
        same_answers(merged, complete)


def test_a_status_that_there_is_not(hausbench: Program, experiment: Path, tmp_path: Path) -> None:
    good = run(hausbench, experiment, tmp_path)
    assert "bogus" in hausbench.fails("verify", damaged(good, {"status": "bogus"}, 0))


def test_damaged_results_take_nothing_down(hausbench: Program, tmp_path: Path) -> None:
    good = run(hausbench, SMOKE, tmp_path)
    whole = good.read_bytes()
    content, seal = whole[:-73], whole[-73:]
    assert seal == b"\nsha256 " + hashlib.sha256(content).hexdigest().encode() + b"\n"
    moments = random.Random(6)
    stray = tmp_path / "stray.h5"
    for trial in range(20):
        damaged_bytes = bytearray(content)
        damaged_bytes[moments.randrange(len(content))] ^= 1 << moments.randrange(8)
        stray.write_bytes(damaged_bytes + seal)
        assert "damaged" in hausbench.fails("verify", stray)
        if trial % 5 == 0:
            assert hausbench("explain", SMOKE, "--results", tmp_path).returncode == 0
    stray.write_bytes(content)  # another program drops the hash
    assert hausbench("verify", stray).returncode == 0


def test_merge_overwrites_nothing_by_mistake(
    hausbench: Program, experiment: Path, tmp_path: Path
) -> None:
    first, second, third = (
        run(hausbench, experiment, tmp_path),
        tmp_path / "two.h5",
        tmp_path / "three.h5",
    )
    shutil.copy(first, second)
    shutil.copy(first, third)
    with h5py.File(third, "r+") as f:
        f["meta"].attrs["title"] = "another"
    before = first.read_bytes()
    assert "at least two results" in hausbench.fails("merge", first, second)
    assert "exists" in hausbench.fails("merge", first, second, third)
    assert first.read_bytes() == before
    done = hausbench("merge", first, first, second)
    assert (
        done.returncode == 0 and str(first) in done.stdout and "1 cases of 2 results" in done.stdout
    )


def test_merge_names_the_shards_that_are_missing(
    hausbench: Program, experiment: Path, tmp_path: Path
) -> None:
    scene = '[[scene]]\nname = "{0} to {1}"\nsource = "sphere{0}"\ntarget = "sphere{1}"\n'
    experiment.write_text(
        experiment.read_text() + "".join(scene.format(*pair) for pair in ((2, 1), (1, 1), (2, 2)))
    )
    parts = []
    for i in (2, 1, 3):  # shard 2 has two of the four cases
        assert (
            hausbench("run", experiment, "--results", tmp_path, "--shard", f"{i}/3").returncode == 0
        )
        parts.append(tmp_path / f"tiny.shard-{i}-of-3.h5")
    twice = hausbench("merge", tmp_path / "twice.h5", parts[0], parts[0])
    assert (
        twice.returncode == 1
        and "2 of 4 cases" in twice.stderr
        and "missing, 1/3, 3/3: run them with --shard" in twice.stderr
    )
    assert (
        texts(tmp_path / "twice.h5", "cases/status").count("skipped") == 2
    )  # the result is written nevertheless
    two = hausbench("merge", tmp_path / "two.h5", parts[2], parts[0])
    assert two.returncode == 1 and "missing, 1/3: run" in two.stderr
    again = hausbench(
        "merge", tmp_path / "two.h5", parts[2], parts[0]
    )  # replaces what a merge of these shards wrote
    assert again.returncode == 1 and "missing, 1/3: run" in again.stderr
    assert "exists" in hausbench.fails(
        "merge", tmp_path / "two.h5", parts[1], parts[0]
    )  # would lose shard 3
    assert "exists" in hausbench.fails("merge", *parts)
    done = hausbench("merge", tmp_path / "three.h5", tmp_path / "two.h5", parts[1])
    assert (
        done.returncode == 0
        and done.stderr == ""
        and set(texts(tmp_path / "three.h5", "cases/status")) == {"ok"}
    )
    with h5py.File(parts[1]) as f, h5py.File(tmp_path / "three.h5") as whole:
        assert (f["meta"].attrs["shard"], whole["meta"].attrs["shard"]) == ("1/3", "")
    # The shard's name is nonsense, or the list of shards would be too long.
    for text in ("0/3", "1/2000000000", "a, b", ",", "1/2, 1/3"):
        with h5py.File(parts[0], "r+") as f:
            f["meta"].attrs["shard"] = text
        done = hausbench("merge", tmp_path / "odd.h5", parts[0], parts[0])
        assert (
            done.returncode == 1
            and "2 of 4 cases" in done.stderr
            and "run the others" in done.stderr
        )
        (tmp_path / "odd.h5").unlink()
    # Older results do not name their shard.
    for part in parts:
        with h5py.File(part, "r+") as f:
            del f["meta"].attrs["shard"]
    done = hausbench("merge", tmp_path / "older.h5", parts[0], parts[1])
    assert (
        done.returncode == 1 and "1 of 4 cases" in done.stderr and "run the others" in done.stderr
    )


def test_merge_keeps_the_time_saved(hausbench: Program, experiment: Path, tmp_path: Path) -> None:
    experiment.write_text(
        experiment.read_text().replace(
            "tolerances = [1e-3]", "tolerances = [1e-3, 1e-2]\ntrace = true"
        )
        + '[[scene]]\nname = "back"\nsource = "sphere2"\ntarget = "sphere1"\n'
    )
    for i in (1, 2):
        assert (
            hausbench("run", experiment, "--results", tmp_path, "--shard", f"{i}/2").returncode == 0
        )
    parts = sorted(tmp_path.glob("tiny.shard-*.h5"))
    saved = np.array([numbers(part, "ledger/seconds_saved") for part in parts])
    assert np.isnan(saved).any(axis=1).all() and np.isfinite(saved).any(axis=0).all()
    assert hausbench("merge", tmp_path / "merged.h5", *parts).returncode == 0
    kinds = np.array(texts(tmp_path / "merged.h5", "ledger/kind"))
    np.testing.assert_array_equal(
        numbers(tmp_path / "merged.h5", "ledger/seconds_saved"),
        np.where(kinds == "reference", np.sum(saved, axis=0), np.nanmax(saved, axis=0)),
    )


def clocked_by_cpu(*results: Path) -> None:
    """Marks times as CPU times. On a busy machine a solve of 1 ms may look multi-threaded, and
    compare would use wall times."""
    for result in results:
        with h5py.File(result, "r+") as f:
            f["cases/clock"][:] = "cpu"


def test_compare_says_what_it_cannot(hausbench: Program, experiment: Path, tmp_path: Path) -> None:
    experiment.write_text(experiment.read_text().replace("repeats = 1", "repeats = 2"))
    first, second = run(hausbench, experiment, tmp_path / "one"), run(
        hausbench, experiment, tmp_path / "two"
    )
    clocked_by_cpu(first, second)
    with h5py.File(second, "r+") as f:
        f["meta"].attrs["machine"] = "0" * 64
        f["repeats/cpu_seconds"][:] *= 10
    done = hausbench("compare", first, second)
    assert (
        done.returncode == 0
        and "machines differ" in done.stdout
        and "builds differ" not in done.stdout
    )
    assert "answers: all the same" in done.stdout
    assert (
        "too few rounds" in done.stdout and "slower" not in done.stdout
    )  # two pairs give a confidence of 50 %
    ratio = next(line for line in done.stdout.splitlines() if "too few rounds" in line)
    assert (
        " CPU " in ratio and float(ratio.split("diagonal")[1].split()[0]) > 2
    )  # one thread, so CPU time is compared
    with h5py.File(second, "r+") as f:
        f["cases/clock"][0] = "wall"
    assert (
        "1 cases without a ratio: their times are by different clocks"
        in hausbench("compare", first, second).stdout
    )
    experiment.write_text(experiment.read_text().replace("1e-3", "1e-2"))
    assert "no case in common" in hausbench.fails(
        "compare", first, run(hausbench, experiment, tmp_path / "other")
    )


def test_compare_takes_first_answers_where_nothing_was_repeated(
    hausbench: Program, experiment: Path, tmp_path: Path
) -> None:
    experiment.write_text(experiment.read_text().replace("repeats = 1", "repeats = 0\nrounds = 2"))
    first, second = run(hausbench, experiment, tmp_path / "one"), run(
        hausbench, experiment, tmp_path / "two"
    )
    clocked_by_cpu(first, second)
    with h5py.File(second, "r+") as f:
        f["answers/cpu_seconds"][:] *= 100
    said = hausbench("compare", first, second).stdout
    ratios = [line for line in said.splitlines() if "too few rounds" in line]
    assert len(ratios) == 1 and "(0 cases without times)" in said, said
    assert float(ratios[0].split("diagonal")[1].split()[0]) > 10


FACTS = """\
title = "what an experiment, a model and a solver tell"
tolerances = [10.0]
of = "absolute"
repeats = 1

[[scene]]
name = "balls"
source = "surface_ball"
target = "surface_ball_large"
exact = 0.5
[[scene]]
name = "clouds"
source = "gaussian_1k_a"
target = "gaussian_1k_b"
[[scene]]
name = "turned"
source = "gaussian_1k_a"
target = "gaussian_1k_b"
motion = { kind = "rotation", axis = [0, 0, 1], degrees = 90, steps = 2 }

[[solver]]
name = "adaptive"
[[solver]]
name = "surface_enclosure"
"""


def test_facts_are_columns_and_survive_resume_and_merge(hausbench: Program, tmp_path: Path) -> None:
    experiment = tmp_path / "facts.toml"
    experiment.write_text(FACTS)
    for i in (1, 2, 3):
        assert (
            hausbench(
                "run", experiment, "--results", tmp_path / "parts", "--shard", f"{i}/3"
            ).returncode
            == 0
        )
    whole, merged = run(hausbench, experiment, tmp_path), tmp_path / "merged.h5"
    resumed = run(hausbench, experiment, tmp_path)
    assert hausbench("merge", merged, *sorted((tmp_path / "parts").glob("*.h5"))).returncode == 0
    for file in (whole, resumed, merged):
        models = {
            name: (text, list(box))
            for name, text, box in zip(
                texts(file, "models/name"),
                texts(file, "models/polynomial"),
                numbers(file, "models/box"),
            )
        }
        assert models["surface_ball"] == ("x^2 + y^2 + z^2 - 1", 3 * [-2.0, 2.0])
        assert models["gaussian_1k_a"][0] == "" and np.isnan(models["gaussian_1k_a"][1]).all()
        assert not any("=" in note for note in texts(file, "models/note"))
        for scene, solver, status, exact, facts in zip(
            *(texts(file, f"cases/{name}") for name in ("scene", "solver", "status")),
            numbers(file, "cases/exact"),
            texts(file, "cases/facts"),
        ):
            assert exact == 0.5 if scene == "balls" else np.isnan(exact)
            assert json.loads(facts) == (
                {"chosen": "ohd"} if (solver, status) == ("adaptive", "ok") else {}
            ), (scene, solver)
        assert sum(status == "ok" for status in texts(file, "cases/status")) == 4


def test_a_result_has_the_titles_of_its_solvers(
    hausbench: Program, experiment: Path, tmp_path: Path
) -> None:
    """Tables and figures take the titles from the result."""
    listed = {
        solver["name"]: solver["title"]
        for solver in json.loads(hausbench("list", "--json").stdout)["solvers"]
    }
    with h5py.File(run(hausbench, experiment, tmp_path)) as result:
        titles = json.loads(result["meta"].attrs["titles"])
        used = {name.decode() for name in result["cases/solver"][:]}
    assert used and titles.keys() >= used
    for name in used:
        assert titles[name] == listed[name]
