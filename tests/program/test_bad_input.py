"""Bad input ends with exit code 2 and one line that names the file, the place and the remedy. No
file is written or lost."""

from __future__ import annotations

import json
import os
import struct
import subprocess
from pathlib import Path

import pytest

from program import EXPERIMENT, Program

BAD_MESHES = {
    "empty.off": (b"", "empty"),
    "noise.obj": (bytes(range(256)) * 4, "noise.obj"),
    "unparsable.off": (b"OFF\n3 1 0\n0 0 0\n1 0 zero\n0 1 0\n3 0 1 2\n", "unparsable.off"),
    "no_vertices.off": (b"OFF\n0 0 0\n", "no vertices"),
    "nan.off": (b"OFF\n3 1 0\n0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n", "vertex"),
    "infinite.obj": (b"v 0 0 0\nv 1 0 0\nv 0 inf 0\nf 1 2 3\n", "vertex"),
    "index.off": (b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", "index.off"),
    "index.obj": (b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", "index.obj"),
    "truncated.stl": (b"\0" * 80 + struct.pack("<I", 2) + b"\0" * 60, "truncated.stl"),
    "truncated.ply": (
        b"ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\n"
        b"element face 1\nproperty list uchar int vertex_indices\nend_header\n" + b"\0" * 40,
        "truncated.ply",
    ),
}


@pytest.mark.parametrize("name", BAD_MESHES)
def test_bad_mesh(hausbench: Program, tetrahedron: Path, tmp_path: Path, name: str) -> None:
    content, said = BAD_MESHES[name]
    bad = tmp_path / name
    bad.write_bytes(content)
    for pair in ((bad, tetrahedron), (tetrahedron, bad)):
        line = hausbench.fails("measure", *pair)
        assert name in line and said in line


def test_missing_file_and_folder(hausbench: Program, tetrahedron: Path, tmp_path: Path) -> None:
    assert "absent.off" in hausbench.fails("measure", tmp_path / "absent.off", tetrahedron)
    assert "folder" in hausbench.fails("measure", tmp_path, tetrahedron)


@pytest.mark.parametrize("tolerance", ["0", "-1e-3", "nan", "inf"])
def test_nonsense_tolerance(hausbench: Program, tetrahedron: Path, tolerance: str) -> None:
    assert "--tolerance" in hausbench.fails(
        "measure", tetrahedron, tetrahedron, f"--tolerance={tolerance}"
    )


def test_unknown_solver_and_parameter_name_the_nearest(
    hausbench: Program, tetrahedron: Path
) -> None:
    assert "guthe" in hausbench.fails("measure", tetrahedron, tetrahedron, "--solver", "guhte")
    line = hausbench.fails(
        "measure", tetrahedron, tetrahedron, "--solver", "guthe", "--set", "nonsense=3"
    )
    assert "nonsense" in line
    assert "takes no mesh" in hausbench.fails(
        "measure", tetrahedron, tetrahedron, "--solver", "naive"
    )


BAD_EXPERIMENTS = {
    'title = "a\\u0000b"\n': ("NUL", "title"),
    "cutoff = 9007199254740993": (
        "'cutoff' is 9007199254740993, which is not a double",
        "write 9007199254740992",
    ),
    "repeat = 1": ("unknown key 'repeat'", "repeats"),
    "repeats = -1": ("'repeats'", "an integer"),
    "of = 'diagnoal'": ("'of'", "diagonal"),
    "tolerances = []": ("'tolerances'", "above 0"),
    "tolerances = [0]": ("'tolerances'", "above 0"),
    "tolerances = [nan]": ("'tolerances'", "finite"),
    "[limits]\ncase_second = 1": ("unknown key 'case_second'", "case_seconds"),
    "[profile.quick]\nrepaets = 1": ("unknown key 'repaets'", "repeats"),
    "profile = { quick = 5 }": ("'profile.quick' must be a table", "[profile.quick]"),
    "profile = 5": ("'profile' must be a table", "[profile.NAME]"),
    "[profile.quick]\nscene = 5": ("tiny.toml:15", "[[scene]]"),
    "[profile.quick.scene]\nname = 'x'": ("tiny.toml:14", "[[scene]]"),
    "[profile.paper]\nrepaets = 1": ("unknown key 'repaets'", "repeats"),
    "[profile.quick]\ntolerances = [nan]": (
        "tiny.toml:15",
        "'tolerances'",
    ),  # names the line in the profile, not the overridden one
    "[[claim]]\nsolver = 'guthe'\nfaster_than = 'guthe'": (
        "names the solver itself",
        "tiny.toml:16",
    ),
    "[[solver]]\nname = 'external'\nparameters = { command = 5 }": (
        "'command'",
        "5 is not a text; give a text",
    ),
    "[[solver]]\nname = 'external'": ("'command'", "tiny.toml:14"),
    "[[solver]]\nname = 'external'\nparameters = { command = 'x {A} {B}' }": (
        "neither 'lower' nor 'upper'",
        "tiny.toml:16",
    ),
    "[[solver]]\nname = 'guhte'": ("guhte", "guthe"),
    "[[solver]]\nname = 'earlybreak'\nparameters = { sede = 1 }": ("sede", "seed"),
    "[[solver]]\nname = 'earlybreak'\nparameters = { seed = 'one' }": ("seed", "an integer"),
    "[[solver]]\nname = 'cgal'\nscenes = ['sphere']": ("unknown scene 'sphere'", "spheres"),
    "[[scene]]\nname = 'x'\nsource = 'sphree1'\ntarget = 'sphere1'": ("sphree1", "sphere1"),
    "[[scene]]\nname = 'spheres'\nsource = 'sphere1'\ntarget = 'sphere1'": (
        "two scenes named 'spheres'",
        "rename",
    ),
    "[[scene]]\nname = 'x'\nsource = 'sphere1'\ntarget = 'sphere1'\nmotion = { kind = 'spin' }": (
        "unknown motion",
        "static",
    ),
    "tolerances = [": ("tiny.toml:", ""),
    "[[scene]]\nname = 'x'\nsource = 'sphere1'\ntarget = 'sphere1'\nexact = -1": (
        "'exact'",
        "below 0",
    ),
    "[[scene]]\nname = 'x'\nsource = 'sphere1'\ntarget = 'sphere1'\nexact = 'one'": (
        "'exact'",
        "number",
    ),
    "[[scene]]\nname = 'x'\nsource = 'sphere1'\ntarget = 'sphere1'\nexact = 1\nmotion = { kind = 'rotation', axis = [0, 0, 1], degrees = 9, steps = 2 }": (
        "'exact'",
        "one pose",
    ),
    "[[scene]]\nname = 'x'\nsource = 'sphere1'\ntarget = 'sphere1'\nmotion = { kind = 'rotation', axis = [0, 0, 1], degrees = 9, steps = 2 }\n"
    "target_motion = { kind = 'rotation', axis = [0, 0, 1], degrees = 9, steps = 3 }": (
        "'target_motion' 3",
        "make one static",
    ),
    "[[solver]]\nname = 'naive'\nwarm = true": ("'warm'", "carries nothing"),
    "limits = { memory_mb = 1e15 }": ("'memory_mb'", "at most"),
    "limits = { case_seconds = 1e15 }": ("'case_seconds'", "at most"),
    "[[scene]]\nname = 'x'\nsource = 'sphere1'\ntarget = 'sphere1'\nprofiles = ['papr']": (
        "unknown profile 'papr'",
        "paper",
    ),
    "[[solver]]\nname = 'guthe'\nparameters = { kernel = 'robsut' }": (
        "robsut",
        "did you mean 'robust'",
    ),
}


@pytest.mark.parametrize("text", BAD_EXPERIMENTS)
def test_bad_experiment(hausbench: Program, experiment: Path, tmp_path: Path, text: str) -> None:
    head, scene, rest = EXPERIMENT.partition("[[scene]]")
    key = text.split(" ")[0]
    if text.startswith("["):
        whole = EXPERIMENT + "\n" + text + "\n"
    else:
        whole = (
            "".join(line for line in head.splitlines(True) if not line.startswith(key + " "))
            + text
            + "\n"
            + scene
            + rest
        )
    experiment.write_text(whole)
    line = hausbench.fails("run", experiment, "--results", tmp_path / "results")
    for part in BAD_EXPERIMENTS[text]:
        assert part in line
    assert "tiny.toml" in line or "sphree1" in line
    assert not list(tmp_path.glob("results/*.h5"))


def test_unknown_profile_scene_solver(hausbench: Program, experiment: Path, tmp_path: Path) -> None:
    assert "quick" in hausbench.fails(
        "run", experiment, "--profile", "quikc", "--results", tmp_path
    )
    assert "spheres" in hausbench.fails(
        "run", experiment, "--scene", "sphere", "--results", tmp_path
    )
    assert "guthe" in hausbench.fails("run", experiment, "--solver", "cgall", "--results", tmp_path)
    # --solver takes one value; the next word is the experiment.
    for verb in ("run", "explain"):
        assert "no solver 'cgall'" in hausbench.fails(verb, "--solver", "cgall", experiment)
    assert "absent.toml" in hausbench.fails("run", tmp_path / "absent.toml")


def test_a_profile_with_nothing_in_it(hausbench: Program, experiment: Path, tmp_path: Path) -> None:
    experiment.write_text(
        EXPERIMENT.replace('name = "spheres"', 'name = "spheres"\nprofiles = ["paper"]')
    )
    assert "no [[scene]] is left in profile 'quick'" in hausbench.fails(
        "run", experiment, "--results", tmp_path
    )
    experiment.write_text(EXPERIMENT + 'profiles = ["paper"]\n')
    assert "no [[solver]] is left" in hausbench.fails("run", experiment, "--results", tmp_path)
    # A solver whose only scene is not in this profile is left out: it does not run on the other
    # scenes.
    experiment.write_text(
        EXPERIMENT.replace(
            "[[solver]]",
            """[[scene]]
name = "large"
source = "sphere3"
target = "sphere3"
profiles = ["paper"]

[[solver]]
name = "cgal"
scenes = ["large"]

[[solver]]""",
        )
    )
    done = hausbench("run", experiment, "--results", tmp_path)
    assert done.returncode == 0, done.stderr
    assert "1 ok" in done.stdout


def test_command_lines(hausbench: Program, tetrahedron: Path) -> None:
    assert "'measure'" in hausbench.fails("mesure")
    assert "no verb" in hausbench.fails()
    assert "diagonal" in hausbench.fails("measure", tetrahedron, tetrahedron, "--of", "diagnoal")
    assert "--tolerance" in hausbench.fails(
        "measure", tetrahedron, tetrahedron, "--tolerance", "abc"
    )
    assert "did you mean '--tolerance'" in hausbench.fails(
        "measure", tetrahedron, tetrahedron, "--tolerence", "1"
    )
    assert "name two shapes" in hausbench.fails("measure", tetrahedron)
    assert hausbench("--help").returncode == 0 and hausbench("measure", "--help").returncode == 0


def test_a_remedy_that_exists(hausbench: Program, tetrahedron: Path, tmp_path: Path) -> None:
    plain = tmp_path / "plain"
    plain.write_bytes(tetrahedron.read_bytes())
    assert "rename" in hausbench.fails("measure", plain, tetrahedron)
    points = tmp_path / "points.obj"
    points.write_text("v 0 0 0\nv 0 0 1\n")
    refused = hausbench.fails("measure", tetrahedron, points, "--solver", "cgal")
    assert "takes no points as target" in refused and "--solver: guthe" in refused
    # Points and meshes can be combined, because a point is a degenerate triangle.
    for source, target, answer in ((tetrahedron, points, 1.0), (points, tetrahedron, 0.0)):
        done = hausbench("measure", source, target, "--json")
        assert done.returncode == 0 and json.loads(done.stdout)["lower"] == pytest.approx(
            answer
        ), done.stderr
    surface = tmp_path / "ball.surface.toml"
    surface.write_text('polynomial = "x^2 + y^2 + z^2 - 1"\nbox = [[-2, 2], [-2, 2], [-2, 2]]\n')
    assert "two files of one kind" in hausbench.fails("measure", tetrahedron, surface)


def test_folders_that_cannot_be(
    hausbench: Program,
    experiment: Path,
    tetrahedron: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    file = tmp_path / "file"
    file.write_text("")
    for folder in (file, file / "below", Path("/proc/folder")):
        assert "--results" in hausbench.fails("run", experiment, "--results", folder)
    for cache in (file, Path("/proc/folder")):
        monkeypatch.setenv("HAUSBENCH_CACHE", str(cache))
        assert "HAUSBENCH_CACHE" in hausbench.fails("run", experiment, "--results", tmp_path)
    monkeypatch.delenv("HAUSBENCH_CACHE")
    for temporary in ("/nonexistent", "/proc"):
        monkeypatch.setenv("TMPDIR", temporary)
        assert "TMPDIR" in hausbench.fails("measure", tetrahedron, tetrahedron)
        assert "TMPDIR" in hausbench.fails("run", experiment, "--results", tmp_path)
    environment = {**hausbench.environment(), "HAUSBENCH_ROOT": str(tmp_path)}
    done = subprocess.run(
        hausbench.command("list"), env=environment, capture_output=True, text=True, timeout=60
    )
    assert done.returncode == 2 and "HAUSBENCH_ROOT" in done.stderr


@pytest.mark.skipif(os.geteuid() != 0, reason="only root can hide /proc")
def test_without_proc(program_file: str, tetrahedron: Path) -> None:
    hidden = 'mount -t tmpfs none /proc && exec "$0" measure "$1" "$1"'
    done = subprocess.run(
        ["unshare", "--mount", "sh", "-c", hidden, program_file, tetrahedron],
        capture_output=True,
        text=True,
    )
    if done.returncode != 0 and "hausbench: " not in done.stderr:
        pytest.skip(f"this root may not mount: {done.stderr}")
    assert (
        done.returncode == 2
        and done.stderr.startswith("hausbench: /proc/self/exe: ")
        and "mount -t proc" in done.stderr
    )
