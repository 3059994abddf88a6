"""Fixtures that run the built executable as users do, and check its output and files."""

from __future__ import annotations

import fcntl
import os
import shutil
import signal
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]

# A background shell ignores SIGINT, and its children would inherit that.
signal.signal(signal.SIGINT, signal.default_int_handler)


class Program:
    """Runs hausbench in a separate folder."""

    def __init__(self, path: str, folder: Path) -> None:
        self.path = path
        self.folder = folder

    def __call__(
        self, *arguments: str | Path, timeout: float = 120
    ) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            self.command(*arguments),
            cwd=self.folder,
            env=self.environment(),
            capture_output=True,
            text=True,
            timeout=timeout,
        )

    def command(self, *arguments: str | Path) -> list[str]:
        return [self.path, *map(str, arguments)]

    def environment(self) -> dict[str, str]:
        return {**os.environ, "HAUSBENCH_ROOT": str(ROOT)}

    def fails(self, *arguments: str | Path) -> str:
        """Runs the program on bad input, and returns its one line of error. Expects exit code 2 and
        an empty standard output."""
        done = self(*arguments)
        assert done.returncode == 2, (done.returncode, done.stdout, done.stderr)
        assert done.stdout == ""
        lines = done.stderr.strip().splitlines()
        assert len(lines) == 1, done.stderr
        return lines[0]


@pytest.fixture(scope="session")
def program_file() -> str:
    path = os.environ.get("HAUSBENCH_PROGRAM", str(ROOT / "build" / "release" / "hausbench"))
    if not Path(path).exists():
        pytest.fail(f"{path} is not built: run `make build`, or set HAUSBENCH_PROGRAM")
    return path


@pytest.fixture
def hausbench(program_file: str, tmp_path: Path) -> Program:
    return Program(program_file, tmp_path)


TETRAHEDRON = "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n"


@pytest.fixture
def tetrahedron(tmp_path: Path) -> Path:
    file = tmp_path / "tetrahedron.off"
    file.write_text(TETRAHEDRON)
    return file


@pytest.fixture
def raised(tmp_path: Path) -> Path:
    """The tetrahedron, raised by 0.25."""
    file = tmp_path / "raised.off"
    file.write_text(
        "OFF\n4 4 0\n0 0 0.25\n1 0 0.25\n0 1 0.25\n0 0 1.25\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n"
    )
    return file


EXPERIMENT = """\
title = "a test"
tolerances = [1e-3]
of = "diagonal"
repeats = 1

[[scene]]
name = "spheres"
source = "sphere1"
target = "sphere2"

[[solver]]
name = "guthe"
"""


@pytest.fixture
def experiment(tmp_path: Path) -> Path:
    file = tmp_path / "tiny.toml"
    file.write_text(EXPERIMENT)
    return file


SOURCES = ROOT / "tests" / "outside_plugin"
RECIPE = ["cmake", "-S", "sources", "-B", "build", "-DCMAKE_EXPORT_COMPILE_COMMANDS=ON"]


def built(command: list[str | Path], folder: Path) -> str:
    done = subprocess.run(
        list(map(str, command)), cwd=folder, capture_output=True, text=True, timeout=600
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="session")
def outside(prefix: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Returns the folder of the plug-ins, built once per test run against the files that `cmake
    --install` installs."""
    shared = tmp_path_factory.getbasetemp()
    if "PYTEST_XDIST_WORKER" in os.environ:  # workers of a parallel run share one folder
        shared = shared.parent
    folder = shared / "outside"
    with open(shared / "outside.lock", "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not (folder / "done").exists():
            shutil.rmtree(folder, ignore_errors=True)  # left by a worker that failed
            shutil.copytree(SOURCES, folder / "sources")
            (folder / "installed").symlink_to(prefix)
            built([*RECIPE, f"-DCMAKE_PREFIX_PATH={folder / 'installed'}"], folder)
            built(["cmake", "--build", "build", "--parallel", "2"], folder)
            (folder / "done").touch()
    return folder / "build"


@pytest.fixture(scope="session")
def plugin(outside: Path) -> Path:
    return outside / "libmisbehaving.so"


HEAD = """\
title = "solvers that misbehave at the second of four poses"
tolerances = [2.0]
of = "absolute"
repeats = 1
limits = { case_seconds = CASE_SECONDS, memory_mb = 400 }

[[scene]]
name = "moved"
source = "sphere1"
target = "sphere1"
motion = { kind = "translation", from = [0, 0, 0], to = [3, 0, 0], steps = 4, of = "absolute" }

[[solver]]
name = "guthe"
"""


def head(case_seconds: float = 60) -> str:
    """Returns the start of an experiment whose limits are so long that only a hanging solver
    reaches them, even on a busy machine."""
    return HEAD.replace("CASE_SECONDS", str(case_seconds))
