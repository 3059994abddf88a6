"""The package as such: what it loads, its types, its memory and the cost of a call, its
docstrings."""

from __future__ import annotations

import doctest
import importlib.util
import os
import resource
import subprocess
import sys
import time
from pathlib import Path

import hausbench as hb
import numpy as np
import pytest
from sample_meshes import Mesh

FOLDER = Path(hb.__file__).resolve().parent
ROOT = Path(__file__).resolve().parents[2]


def run(*arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, *arguments],
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        timeout=300,
    )


def test_import_loads_little() -> None:
    script = (
        "import sys, numpy, hausbench; print(*sorted(name for name in sys.modules if name.split('.')[0] in "
        "('h5py', 'pandas', 'matplotlib', 'scipy', 'dataclasses', 'hausbench')))\n"
        "print([line.split()[-1] for line in open('/proc/self/maps') if 'assimp' in line or 'hdf5' in line])"
    )
    done = run("-c", script)
    names, libraries = done.stdout.splitlines()
    assert {name.split(".")[0] for name in names.split()} == {"hausbench"}, done
    assert "hausbench.compat" not in names.split() and "hausbench.results" not in names.split()
    assert libraries == "[]"


def test_names_that_are_loaded_on_first_use() -> None:
    assert (
        callable(hb.compat.hausdorff)
        and callable(hb.distribution)
        and isinstance(hb.Results, type)
        and isinstance(hb.Distribution, type)
    )
    assert all(hasattr(hb, name) for name in hb.__all__)
    with pytest.raises(AttributeError, match="no_such"):
        getattr(hb, "no_such")


def test_docstrings() -> None:
    assert doctest.testmod(hb).failed == 0
    for name in hb.__all__:
        assert getattr(hb, name).__doc__, name


def test_types(tmp_path: Path) -> None:
    if importlib.util.find_spec("mypy") is None:
        pytest.skip("needs mypy: sudo apt-get install mypy")
    search = (
        "" if "site-packages" in FOLDER.parts else str(FOLDER.parent)
    )  # mypy finds installed packages by py.typed
    settings = (
        tmp_path / "mypy.ini"
    )  # not pyproject.toml, because stubtest compares with the Python that runs it, not with the oldest
    settings.write_text("[mypy]\nimplicit_reexport = False\nignore_missing_imports = True\n")
    stubs = run(
        "-m", "mypy.stubtest", "hausbench", "--mypy-config-file", str(settings), MYPYPATH=search
    )
    assert stubs.returncode == 0, stubs.stdout + stubs.stderr
    example = tmp_path / "example.py"
    example.write_text(
        "import hausbench as hb\nimport numpy as np\nanswer = hb.directed(np.zeros((1, 3)), ([[0, 0, 0]], [[0, 0, 0]]))\n"
        "reveal_type(answer.interval.upper)\nreveal_type(hb.within('a.ply', 'b.ply', 0.1))\n"
    )
    done = run(
        "-m",
        "mypy",
        "--strict",
        str(example),
        "--cache-dir",
        str(tmp_path / "cache"),
        MYPYPATH=search,
    )
    assert (
        '"builtins.float"' in done.stdout
        and '"builtins.bool"' in done.stdout
        and "error" not in done.stdout
    ), done.stdout


def resident() -> int:
    """Returns the resident memory of this process, in bytes."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * resource.getpagesize()


@pytest.mark.parametrize("call", ["directed", "prepared", "error", "distribution"])
def test_memory_does_not_grow(cube: Mesh, call: str) -> None:
    vertices, faces = cube
    moved = vertices + [0.1, 0.2, 0.3]
    wrong = np.where(np.arange(24).reshape(8, 3) == 7, np.nan, vertices)
    prepared, source = hb.prepare((moved, faces)), hb.Shape(vertices, faces)

    def ask() -> None:
        if call == "directed":
            hb.directed((vertices, faces), (moved, faces))
        elif call == "prepared":
            prepared.directed(source, pose=np.eye(4))
        elif call == "distribution":
            hb.distribution(vertices, moved)
        else:
            with pytest.raises(hb.InputError):
                hb.directed((wrong, faces), cube)

    count = int(os.environ.get("HAUSBENCH_CALLS", "3000"))
    for _ in range(count):
        ask()
    before = resident()
    for _ in range(count):
        ask()
    assert resident() - before < count * 20 + 2**20  # a leaked handle has more than 100 bytes


def test_a_call_costs_little_above_its_solve(cube: Mesh) -> None:
    """Compares with making numpy arrays, so that the machine's speed does not matter."""
    target = cube[0] + [0.1, 0.2, 0.3], cube[1]
    above, beside = [], []
    for _ in range(20):
        begin, solved = time.perf_counter(), 0.0
        for _ in range(50):
            answer = hb.directed(cube, target)
            solved += answer.prepare_seconds + answer.solve_seconds
        above.append(time.perf_counter() - begin - solved)
        begin = time.perf_counter()
        for _ in range(50):
            np.linalg.inv(np.eye(4))
        beside.append(time.perf_counter() - begin)
    assert min(above) < 10 * min(beside)  # measured: about 1


def test_results(tmp_path: Path) -> None:
    h5py = pytest.importorskip("h5py")
    path = tmp_path / "x.h5"
    with h5py.File(path, "w") as file:
        cases = file.create_group("cases")
        cases["solver"] = np.array(["cover", "scan"], dtype=h5py.string_dtype())
        cases["lower"], cases["upper"] = [0.1, 0.2], [0.3, 0.4]
        cases["witness"] = np.arange(6.0).reshape(2, 3)
        file.create_group("fields")["values"] = np.zeros(7)
    results = hb.Results(path)
    assert results.tables() == ["cases", "fields"] and results.columns()["solver"].tolist() == [
        "cover",
        "scan",
    ]
    pandas = pytest.importorskip("pandas")
    frame = results.to_pandas()
    assert (
        isinstance(frame, pandas.DataFrame)
        and list(frame.upper) == [0.3, 0.4]
        and list(frame.witness_2) == [2, 5]
    )
    with pytest.raises(hb.InputError, match="no table 'rows', but cases, fields"):
        results.columns("rows")


def test_results_of_other_files(tmp_path: Path) -> None:
    h5py = pytest.importorskip("h5py")
    foreign = tmp_path / "other.h5"
    with h5py.File(foreign, "w") as file:
        file["x"] = [1]
    text = tmp_path / "text.h5"
    text.write_text("no result")
    for path in (foreign, text, tmp_path / "gone.h5", tmp_path):
        with pytest.raises(hb.InputError, match="hausbench run"):
            hb.Results(path)


def test_results_that_lead_to_other_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    h5py = pytest.importorskip("h5py")
    (tmp_path / "secret").write_bytes(b"words of another")
    path = tmp_path / "x.h5"
    with h5py.File(path, "w") as file:
        file.create_dataset(
            "cases/solver", shape=(1,), dtype="S16", external=[(str(tmp_path / "secret"), 0, 16)]
        )
    with pytest.raises(hb.InputError, match="/cases/solver: "):
        hb.Results(path)
    with h5py.File(path, "w") as file:
        file["cases/solver"] = h5py.ExternalLink("other.h5", "/x")
    with pytest.raises(hb.InputError, match="a link to another file"):
        hb.Results(path)
    monkeypatch.delenv("HAUSBENCH_PROGRAM", raising=False)
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(hb.InputError, match="HAUSBENCH_PROGRAM"):
        hb.Results(path)


def test_building_without_its_packages_names_them(tmp_path: Path) -> None:
    done = run(
        str(ROOT / "setup.py"), "build_ext", "--build-lib", str(tmp_path), PATH=str(tmp_path)
    )
    assert done.returncode == 1
    last = done.stderr.splitlines()[-1]
    assert {"cmake", "g++", "libeigen3-dev", "pybind11-dev"} <= set(
        last.split()
    ) and "libhdf5-dev" not in last
    assert "These packages are missing" in done.stderr
