"""Bad input ends with exit code 2 and one line that names the file, the place and the remedy; nothing is written or lost."""

from __future__ import annotations

import struct
from pathlib import Path

import pytest

from conftest import EXPERIMENT, Program

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
    assert "--tolerance" in hausbench.fails("measure", tetrahedron, tetrahedron, f"--tolerance={tolerance}")


def test_unknown_solver_and_parameter_name_the_nearest(hausbench: Program, tetrahedron: Path) -> None:
    assert "guthe" in hausbench.fails("measure", tetrahedron, tetrahedron, "--solver", "guhte")
    line = hausbench.fails("measure", tetrahedron, tetrahedron, "--solver", "guthe", "--set", "nonsense=3")
    assert "nonsense" in line
    assert "takes no mesh" in hausbench.fails("measure", tetrahedron, tetrahedron, "--solver", "naive")


BAD_EXPERIMENTS = {
    "repeat = 1": ("unknown key 'repeat'", "repeats"),
    "repeats = -1": ("'repeats'", "whole number"),
    "of = 'diagnoal'": ("'of'", "diagonal"),
    "tolerances = []": ("'tolerances'", "above 0"),
    "tolerances = [0]": ("'tolerances'", "above 0"),
    "tolerances = [nan]": ("'tolerances'", "finite"),
    "[limits]\ncase_second = 1": ("unknown key 'case_second'", "case_seconds"),
    "[profile.quick]\nrepaets = 1": ("unknown key 'repaets'", "repeats"),
    "[[solver]]\nname = 'guhte'": ("guhte", "guthe"),
    "[[solver]]\nname = 'earlybreak'\nparameters = { sede = 1 }": ("sede", "seed"),
    "[[solver]]\nname = 'earlybreak'\nparameters = { seed = 'one' }": ("seed", "whole number"),
    "[[solver]]\nname = 'cgal'\nscenes = ['sphere']": ("unknown scene 'sphere'", "spheres"),
    "[[scene]]\nname = 'x'\nsource = 'sphree1'\ntarget = 'sphere1'": ("sphree1", "sphere1"),
    "[[scene]]\nname = 'spheres'\nsource = 'sphere1'\ntarget = 'sphere1'": ("two scenes named 'spheres'", "rename"),
    "[[scene]]\nname = 'x'\nsource = 'sphere1'\ntarget = 'sphere1'\nmotion = { kind = 'spin' }": ("unknown motion", "static"),
    "tolerances = [": ("tiny.toml:", ""),
}


@pytest.mark.parametrize("text", BAD_EXPERIMENTS)
def test_bad_experiment(hausbench: Program, experiment: Path, tmp_path: Path, text: str) -> None:
    head, scene, rest = EXPERIMENT.partition("[[scene]]")
    key = text.split(" ")[0]
    if text.startswith("["):
        whole = EXPERIMENT + "\n" + text + "\n"
    else:
        whole = "".join(line for line in head.splitlines(True) if not line.startswith(key + " ")) + text + "\n" + scene + rest
    experiment.write_text(whole)
    line = hausbench.fails("run", experiment, "--results", tmp_path / "results")
    for part in BAD_EXPERIMENTS[text]:
        assert part in line
    assert "tiny.toml" in line or "sphree1" in line
    assert not list(tmp_path.glob("results/*.h5"))


def test_unknown_profile_scene_solver(hausbench: Program, experiment: Path, tmp_path: Path) -> None:
    assert "quick" in hausbench.fails("run", experiment, "--profile", "quikc", "--results", tmp_path)
    assert "spheres" in hausbench.fails("run", experiment, "--scene", "sphere", "--results", tmp_path)
    assert "guthe" in hausbench.fails("run", experiment, "--solver", "cgall", "--results", tmp_path)
    # An option takes one value: the experiment after it is still the experiment.
    for verb in ("run", "explain"):
        assert "no solver 'cgall'" in hausbench.fails(verb, "--solver", "cgall", experiment)
    assert "absent.toml" in hausbench.fails("run", tmp_path / "absent.toml")


def test_no_arguments_and_unknown_verb(hausbench: Program) -> None:
    assert hausbench().returncode == 2
    assert hausbench("mesure").returncode == 2
