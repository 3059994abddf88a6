"""A reference answer for each scene, pose and quantity gives the true errors of every row."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest

from program import EXPERIMENT, Program
from test_run import numbers, run, texts

# A program that prints given bounds, without a witness.
LIAR = """
[[solver]]
name = "external"
label = "liar"
[solver.parameters]
command = '''{python} -c "print('h = {lower}, at most {upper}')" {{A}} {{B}}'''
format = "off"
lower = '''^h = ([-+0-9.eE]+)'''
upper = '''at most (\\S+)'''
"""


def claims(lower: float, upper: float) -> str:
    return LIAR.format(python=sys.executable, lower=lower, upper=upper)


def status_of(file: Path, label: str) -> list[str]:
    return [
        status
        for status, name in zip(texts(file, "cases/status"), texts(file, "cases/label"))
        if name == label
    ]


def test_every_scene_pose_and_quantity_has_one(
    hausbench: Program, experiment: Path, tmp_path: Path
) -> None:
    experiment.write_text(
        EXPERIMENT.replace("1e-3]", "1e-3, 1e-1]")
        + """
[[solver]]
name = "guthe"
label = "H"
quantity = "symmetric"
[[scene]]
name = "moved"
source = "sphere1"
target = "sphere2"
motion = { kind = "translation", from = [0, 0, 0], to = [1, 0, 0], steps = 3, of = "absolute" }
"""
    )
    file = run(hausbench, experiment, tmp_path)
    with h5py.File(file) as f:
        references, cases = f["references"], f["cases"]
        questions = list(
            zip(
                *(references[name].asstr()[:] for name in ("scene", "quantity", "solver")),
                references["pose_index"][:],
            )
        )
        assert sorted(questions) == sorted(
            (scene, quantity, "cover", pose)
            for scene, count in (("spheres", 1), ("moved", 3))
            for quantity in ("directed", "symmetric")
            for pose in range(count)
        )
        assert set(references["tolerance"][:]) == {1e-5} and set(
            references["status"].asstr()[:]
        ) == {"ok"}
        assert (
            np.all(references["proven_upper"][:] >= references["upper"][:])
            and '"accepted"' in references["facts"].asstr()[0]
        )
        assert (
            set(references["lower_check"].asstr()[:]) == {"holds"}
            and len(f["repeats/case"]) == len(cases["lower"]) * 1
        )
        low, high = cases["reference_lower"][:], cases["reference_upper"][:]
        assert (
            np.all(low <= high)
            and np.all(cases["lower"][:] <= high)
            and np.all(cases["upper"][:] >= low)
        )
        middle = low + (high - low) / 2
        assert np.array_equal(
            cases["lower_error"][:], middle - cases["lower"][:]
        ) and np.array_equal(cases["upper_error"][:], cases["upper"][:] - middle)
        kinds = dict(zip(f["ledger/kind"].asstr()[:], f["ledger/seconds_saved"][:]))
        assert kinds["reference"] < 0


@pytest.mark.parametrize(
    ("lower", "upper", "said"),
    [
        (0, 1e-6, "is below the verified lower bound"),
        (5, 5.0001, "is above the certified upper bound"),
    ],
)
def test_a_wrong_bound_without_a_witness_is_unsound(
    hausbench: Program, experiment: Path, tmp_path: Path, lower: float, upper: float, said: str
) -> None:
    """No other solver of the experiment refutes the bound, so the reference must."""
    experiment.write_text(
        EXPERIMENT.replace('[[solver]]\nname = "guthe"\n', "") + claims(lower, upper)
    )
    done = hausbench("run", experiment, "--results", tmp_path, "--quiet")
    assert done.returncode == 1 and said in done.stderr, done.stderr
    assert status_of(tmp_path / "tiny.h5", "liar") == ["unsound"]
    assert hausbench("verify", tmp_path / "tiny.h5").returncode == 1
    experiment.write_text("reference = false\n" + experiment.read_text())
    done = hausbench("run", experiment, "--results", tmp_path, "--quiet", "--fresh")
    assert done.returncode == 0 and status_of(tmp_path / "tiny.h5", "liar") == ["ok"]
    assert status_of(
        run(
            hausbench,
            write(experiment, claims(lower, upper), solver=False),
            tmp_path,
            "--no-reference",
            "--fresh",
        ),
        "liar",
    ) == ["ok"]
    assert "left out by reference = false in the experiment, or by --no-reference" in texts(
        tmp_path / "tiny.h5", "ledger/reason"
    )


@pytest.mark.parametrize("seconds", [10, 1e-6])
@pytest.mark.parametrize("quantity", ["directed", "symmetric"])
def test_a_lower_bound_between_points_is_refuted_by_a_proven_upper_bound_alone(
    hausbench: Program, experiment: Path, tmp_path: Path, seconds: float, quantity: str
) -> None:
    """`scan` writes no certificate, so its upper bound is checked point by point, for which a limit
    of 1e-6 s is too short."""
    experiment.write_text(
        f'quantity = "{quantity}"\n'
        + EXPERIMENT.replace("sphere1", "gaussian_1k_a")
        .replace("sphere2", "gaussian_1k_b")
        .replace('[[solver]]\nname = "guthe"\n', "")
        + f"[limits]\nreference_seconds = {seconds}\n"
        + claims(50, 50.0001)
    )
    done = hausbench("run", experiment, "--results", tmp_path, "--quiet")
    assert "skipped" not in texts(tmp_path / "tiny.h5", "cases/status")
    status, proven, upper = (
        status_of(tmp_path / "tiny.h5", "liar"),
        numbers(tmp_path / "tiny.h5", "references/proven_upper"),
        numbers(tmp_path / "tiny.h5", "references/upper"),
    )
    if seconds == 10:
        assert (
            status == ["unsound"]
            and np.array_equal(proven, upper)
            and "is above the certified upper bound" in done.stderr
        )
        assert (
            "accepted: each point has one within the upper bound"
            in texts(tmp_path / "tiny.h5", "references/facts")[0]
        )
        assert "1 upper bound proven" in done.stdout
    else:
        assert (
            status == ["ok"]
            and texts(tmp_path / "tiny.h5", "cases/lower_check") == ["no witness"]
            and np.isnan(proven)
        )


def test_references_are_resumed_kept_and_merged(
    hausbench: Program, experiment: Path, tmp_path: Path
) -> None:
    experiment.write_text(
        EXPERIMENT
        + '[[solver]]\nname = "kang"\n[[scene]]\nname = "back"\nsource = "sphere2"\ntarget = "sphere1"\n'
    )
    file = run(hausbench, experiment, tmp_path)
    seconds = numbers(file, "references/solve_seconds")
    assert len(seconds) == 2
    run(hausbench, experiment, tmp_path)  # references are kept in the journal
    assert np.array_equal(numbers(file, "references/solve_seconds"), seconds)
    run(hausbench, experiment, tmp_path, "--scene", "back", "--solver", "kang", "--fresh")
    assert (
        sorted(texts(file, "references/scene")) == ["back", "spheres"]
        and len(numbers(file, "cases/reference_lower")) == 4
    )
    assert not np.isnan(numbers(file, "cases/reference_lower")).any()
    parts = []
    for shard in (1, 2):
        assert (
            hausbench(
                "run", experiment, "--results", tmp_path, "--shard", f"{shard}/2", "--quiet"
            ).returncode
            == 0
        )
        parts.append(tmp_path / f"tiny.shard-{shard}-of-2.h5")
    done = hausbench("merge", tmp_path / "all.h5", *parts)
    assert done.returncode == 0 and sorted(texts(tmp_path / "all.h5", "references/scene")) == [
        "back",
        "spheres",
    ], done.stderr
    said = hausbench("verify", tmp_path / "all.h5")
    assert (
        said.returncode == 0
        and "reference answers: 2, 2 within their tolerance, 2 upper bounds proven" in said.stdout
    ), said.stdout


def test_a_reference_that_is_not_closed_says_how_wide_it_is(
    hausbench: Program, experiment: Path, tmp_path: Path
) -> None:
    """With almost no time, the reference's bounds are wide but valid, and do not refute the row."""
    experiment.write_text(
        EXPERIMENT.replace("sphere1", "ball").replace("sphere2", "cube")
        + "[limits]\nreference_seconds = 1e-6\n"
        + '[model.ball]\nsource = "generated"\nrecipe = "icosphere"\nlevel = 5\nradius = 1\n'
        '[model.cube]\nsource = "generated"\nrecipe = "cube"\nsubdivisions = 40\n'
    )
    done = hausbench("run", experiment, "--results", tmp_path, "--quiet")
    assert done.returncode == 0, done.stderr
    assert texts(tmp_path / "tiny.h5", "references/status") == ["timeout"] and texts(
        tmp_path / "tiny.h5", "cases/status"
    ) == ["ok"]
    assert (
        "0 within their tolerance" in done.stdout
        and "only to within the width of their reference" in done.stdout
    ), done.stdout


def test_explain_counts_references(hausbench: Program, experiment: Path) -> None:
    done: subprocess.CompletedProcess[str] = hausbench("explain", experiment)
    assert "REFERENCE\n  1 answer, certified and not timed, at most 10 s each" in done.stdout
    assert "'reference_seconds'" in hausbench.fails(
        "explain", write(experiment, "[limits]\nreference_seconds = 0\n")
    )


def write(experiment: Path, more: str, solver: bool = True) -> Path:
    experiment.write_text(
        (EXPERIMENT if solver else EXPERIMENT.replace('[[solver]]\nname = "guthe"\n', "")) + more
    )
    return experiment
