"""A user's models: in the experiment, by path, or in a folder of their own; and how results record
them."""

from __future__ import annotations

import hashlib
import os
import subprocess
from pathlib import Path

import h5py
import pytest

from program import Program

EXPERIMENT = """\
title = "own models"
tolerances = [1e-3]
repeats = 1

[model.mine]
path = "clouds/scan.xyz"
note = "my own"
licence = "CC0-1.0"

[model.twice]
from = "mine"
operation = "scale"
factor = 2.0

[[scene]]
name = "one"
source = "mine"
target = "clouds/other.csv"

[[scene]]
name = "many"
sources = ["twice", "./clouds/scan.xyz"]
targets = ["clouds/other.csv", "sphere1"]

[[solver]]
name = "guthe"
"""


@pytest.fixture
def own(tmp_path: Path) -> Path:
    folder = tmp_path / "own"
    (folder / "clouds").mkdir(parents=True)
    (folder / "clouds" / "scan.xyz").write_text("0 0 0\n1 0 0\n")
    (folder / "clouds" / "other.csv").write_text("z,y,x\n3,0,0\n3,0,1\n")
    file = folder / "mine.toml"
    file.write_text(EXPERIMENT)
    return file


def run(hausbench: Program, experiment: Path, *more: str | Path) -> Path:
    done = hausbench("run", experiment, "--results", experiment.parent / "results", *more)
    assert done.returncode == 0, done.stderr
    return experiment.parent / "results" / "mine.h5"


def test_models_of_the_experiment_and_by_path(hausbench: Program, own: Path) -> None:
    """Paths are relative to the experiment, not to the current folder."""
    with h5py.File(run(hausbench, own)) as f:
        assert set(f["cases/status"].asstr()[:]) == {"ok"} and set(
            f["cases/lower_check"].asstr()[:]
        ) == {"holds"}
        rows = dict(
            zip(
                zip(f["cases/source"].asstr()[:], f["cases/target"].asstr()[:]), f["cases/upper"][:]
            )
        )
        names = list(f["models/name"].asstr()[:])
        models: dict[str, dict[str, str]] = {name: {} for name in names}
        for key in ("path", "file_sha256", "source", "note", "licence"):
            for name, value in zip(names, f[f"models/{key}"].asstr()[:]):
                models[name][key] = value
        assert f["meta"].attrs["experiment_file"] == str(own)
    assert len(rows) == 5 and rows["mine", "clouds/other.csv"] == pytest.approx(3)
    assert rows["twice", "clouds/other.csv"] == pytest.approx(
        10**0.5
    )  # the farthest point is (2, 0, 0)
    assert names.count("mine") == 1 and set(names) == {
        "mine",
        "twice",
        "clouds/other.csv",
        "./clouds/scan.xyz",
        "sphere1",
    }
    sha256 = hashlib.sha256((own.parent / "clouds" / "scan.xyz").read_bytes()).hexdigest()
    assert models["mine"] == {
        "path": "clouds/scan.xyz",
        "file_sha256": sha256,
        "source": "file",
        "note": "my own",
        "licence": "CC0-1.0",
    }
    assert (
        models["./clouds/scan.xyz"]["path"] == "./clouds/scan.xyz"
        and models["./clouds/scan.xyz"]["file_sha256"] == sha256
    )
    assert models["twice"] == {
        "path": "",
        "file_sha256": "",
        "source": "derived",
        "note": "",
        "licence": "",
    }


def test_identities_hold_no_place(hausbench: Program, own: Path, tmp_path: Path) -> None:
    """Files with the same bytes in another folder, with another name, give the same identities."""

    def identities(file: Path) -> list[str]:
        with h5py.File(file) as f:
            return sorted(f["cases/identity"].asstr()[:])

    before = identities(run(hausbench, own))
    moved = tmp_path / "elsewhere" / "mine.toml"
    own.parent.rename(moved.parent)
    (moved.parent / "clouds").rename(moved.parent / "data")
    moved.write_text(EXPERIMENT.replace("clouds/", "data/"))
    (moved.parent / "results" / "mine.journal").unlink()
    assert identities(run(hausbench, moved)) == before


def test_verify_finds_them_again(hausbench: Program, own: Path, tmp_path: Path) -> None:
    result = run(hausbench, own)
    own.unlink()  # the result contains the experiment's text
    assert hausbench("verify", result).returncode == 0
    scan = own.parent / "clouds" / "scan.xyz"
    text = scan.read_text()
    scan.write_text(text + "# other bytes, the same points\n")
    assert hausbench("verify", result).returncode == 0
    scan.write_text("0 0 0\n1 0 9\n")
    line = hausbench.fails("verify", result)
    assert (
        "model 'mine'" in line
        and str(scan) in line
        and "holds another shape" in line
        and "put that file back" in line
    )
    scan.unlink()
    done = hausbench("verify", result)
    assert (
        done.returncode == 1
        and f"model 'mine' is not here, so its rows are not checked: file {scan} does not exist"
        in done.stderr
    )
    assert (
        "model 'twice' is not here" in done.stderr
        and "model './clouds/scan.xyz' is not here" in done.stderr
    )


def test_shards_are_merged(hausbench: Program, own: Path, tmp_path: Path) -> None:
    for part in ("1/2", "2/2"):
        run(hausbench, own, "--shard", part)
    parts = sorted((own.parent / "results").glob("mine.shard-*.h5"))
    done = hausbench("merge", tmp_path / "all.h5", *parts)
    assert done.returncode == 0 and done.stderr == "", done.stderr
    with h5py.File(tmp_path / "all.h5") as f:
        assert set(f["cases/lower_check"].asstr()[:]) == {"holds"}
    assert hausbench("verify", tmp_path / "all.h5").returncode == 0


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (
            ('source = "mine"', 'source = "mines"'),
            (
                ":17:",
                "no model 'mines' (did you mean 'mine'?)",
                "define [model.mines] with a path",
                '"mines.ply"',
            ),
        ),
        (
            ('sources = ["twice",', 'sources = [\n  "sphere1",\n  "sphree1",'),
            (":24:", "no model 'sphree1' (did you mean 'sphere1'?)"),
        ),
        (
            ('target = "clouds/other.csv"', 'target = "clouds/othre.csv"'),
            (":18:", "there is no file", "clouds/othre.csv", "experiment's folder"),
        ),
        (
            ('path = "clouds/scan.xyz"', 'path = "scan.xyz"'),
            ("model 'mine'", "there is no file", "own/scan.xyz"),
        ),
        (
            ("[model.mine]", "[model.sphere1]"),
            ("model 'sphere1'", "also in datasets/manifest.toml", "another name"),
        ),
        (
            ('note = "my own"', 'nore = "my own"'),
            ("line 7", "model 'mine'", "unknown key 'nore'", "did you mean 'note'"),
        ),
        (
            ('from = "mine"', 'from = "yours"'),
            ("model 'twice' is derived from 'yours', which does not exist",),
        ),
        (
            ('path = "clouds/scan.xyz"', 'path = "clouds/scan.xyz"\nsource = "npm"'),
            ("line 7", "packages are fetched for datasets/manifest.toml alone"),
        ),
        (
            ("[model.mine]", "[model]\nmine = 3\n[model.other]"),
            (":6:", "'mine' is not [model.NAME]"),
        ),
        (('note = "my own"', f'sha256 = "{64 * "a"}"'), None),
    ],
)
def test_what_is_wrong_with_them(
    hausbench: Program, own: Path, change: tuple[str, str], says: tuple[str, ...] | None
) -> None:
    text = own.read_text()
    assert change[0] in text
    own.write_text(text.replace(*change, 1))
    if says is None:  # a file with a wrong hash affects only the rows of its model
        with h5py.File(run(hausbench, own)) as f:
            reasons = {
                source: reason
                for source, reason in zip(
                    f["cases/source"].asstr()[:], f["cases/reason"].asstr()[:]
                )
            }
        assert (
            "has SHA-256" in reasons["mine"]
            and "or correct sha256" in reasons["mine"]
            and reasons["./clouds/scan.xyz"] == ""
        )
        return
    line = hausbench.fails("run", own, "--results", own.parent / "results")
    assert "mine.toml" in line
    for part in says:
        assert part in line, line
    assert not (own.parent / "results").exists()


def test_a_profile_may_have_another_file(hausbench: Program, own: Path) -> None:
    (own.parent / "large.xyz").write_text("0 0 0\n1 0 0\n0 4 3\n")
    own.write_text(own.read_text() + '\n[profile.paper.model.mine]\npath = "large.xyz"\n')
    with h5py.File(run(hausbench, own, "--profile", "paper")) as f:
        elements = dict(zip(f["cases/source"].asstr()[:], f["cases/source_elements"][:]))
    assert elements["mine"] == 3 and elements["./clouds/scan.xyz"] == 2
    assert hausbench("verify", own.parent / "results" / "mine.h5").returncode == 0


def test_models_of_a_profile_whose_rows_stay(hausbench: Program, own: Path) -> None:
    own.write_text(
        own.read_text()
        + """
[[scene]]
name = "large"
source = "large"
target = "sphere1"
profiles = ["paper"]

[profile.paper.model.mine]
path = "clouds/scan.xyz"

[profile.paper.model.twice]
from = "mine"
operation = "scale"
factor = 2.0

[profile.paper.model.large]
path = "clouds/other.csv"
"""
    )
    run(hausbench, own, "--profile", "paper")
    result = run(hausbench, own)
    with h5py.File(result) as f:
        assert f["meta"].attrs["profile"] == "quick" and "large" in f["cases/scene"].asstr()[:]
    done = hausbench("verify", result)
    assert done.returncode == 0 and done.stderr == "", done.stderr


def test_a_name_of_a_model_is_no_path(hausbench: Program, own: Path) -> None:
    """If a model is called like a file, the name means the model."""
    own.write_text(
        EXPERIMENT.replace("[model.mine]", '[model."scan.xyz"]')
        .replace('source = "mine"', 'source = "scan.xyz"')
        .replace('from = "mine"', 'from = "scan.xyz"')
    )
    (own.parent / "scan.xyz").write_text("not a cloud\n")
    with h5py.File(run(hausbench, own)) as f:
        assert set(f["cases/status"].asstr()[:]) == {"ok"}


def test_a_folder_of_its_own_is_a_root(program_file: str, own: Path) -> None:
    """A folder with datasets/manifest.toml is a root: it provides the models, and receives results
    and cache."""
    (own.parent / "datasets").mkdir()
    (own.parent / "datasets" / "manifest.toml").write_text(
        '[model.sphere1]\nsource = "file"\npath = "../clouds/scan.xyz"\n'
    )
    environment = {
        name: value
        for name, value in os.environ.items()
        if name not in ("HAUSBENCH_ROOT", "HAUSBENCH_CACHE")
    }
    done = subprocess.run(
        [program_file, "run", "../mine.toml"],
        cwd=own.parent / "clouds",
        env=environment,
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
    )
    assert done.returncode == 0, done.stderr
    with h5py.File(own.parent / "results" / "mine.h5") as f:
        assert "sphere1" in f["models/name"].asstr()[:] and set(f["cases/status"].asstr()[:]) == {
            "ok"
        }
    assert (own.parent / "datasets" / "cache").is_dir()


MOVING = """\
title = "motions"
tolerances = [0.1]
of = "absolute"
repeats = 0

[[scene]]
name = "turn"
source = "a.xyz"
target = "a.xyz"
motion = MOTION

[[solver]]
name = "naive"
"""


def angles(hausbench: Program, folder: Path, motion: str) -> list[float]:
    import math

    (folder / "a.xyz").write_text("1 0 0\n-1 0 0\n")
    (folder / "turn.toml").write_text(MOVING.replace("MOTION", motion))
    done = hausbench("run", folder / "turn.toml", "--results", folder, "--fresh")
    assert done.returncode == 0, done.stderr
    with h5py.File(folder / "turn.h5") as f:
        poses = f["cases/pose"][:]
    return [math.degrees(math.atan2(pose[3], pose[0])) % 360 for pose in poses]


@pytest.mark.parametrize("degrees", [360, -360, 720])
def test_a_full_turn_ends_before_it_begins_again(
    hausbench: Program, tmp_path: Path, degrees: int
) -> None:
    motion = f'{{ kind = "rotation", axis = [0, 0, 1], degrees = {degrees}, steps = 5 }}'
    assert angles(hausbench, tmp_path, motion) == pytest.approx(
        [degrees * i / 5 % 360 for i in range(5)]
    )


def test_any_other_turn_has_both_ends(hausbench: Program, tmp_path: Path) -> None:
    assert angles(
        hausbench, tmp_path, '{ kind = "rotation", axis = [0, 0, 2], degrees = 90, steps = 4 }'
    ) == pytest.approx([0, 30, 60, 90])
    assert (
        len(angles(hausbench, tmp_path, '{ kind = "rotation", axis = [0, 0, 1], degrees = 90 }'))
        == 10
    )  # the default number of steps
    assert angles(
        hausbench, tmp_path, '{ kind = "rotation", axis = [0, 0, 1], degrees = 360, steps = 1 }'
    ) == [0]


@pytest.mark.parametrize("key", ["motion", "target_motion"])
def test_poses_that_cannot_be_read_are_an_error_of_the_experiment(
    hausbench: Program, tmp_path: Path, key: str
) -> None:
    (tmp_path / "a.xyz").write_text("0 0 0\n")
    experiment = tmp_path / "poses.toml"
    experiment.write_text(
        MOVING.replace("motion = MOTION", f'{key} = {{ kind = "poses", file = "poses.txt" }}')
    )
    for written, why in (
        (None, "cannot open the pose file"),
        ("1 2 3\n", "poses.txt:1: a pose is twelve finite numbers"),
        ("", "contains no poses"),
    ):
        if written is not None:
            (tmp_path / "poses.txt").write_text(written)
        for verb in ("run", "explain"):
            line = hausbench.fails(verb, experiment, "--results", tmp_path / "results")
            assert f"poses.toml:10: '{key}'" in line and why in line, line
    assert not (tmp_path / "results").exists()
