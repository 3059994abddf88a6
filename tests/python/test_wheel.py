"""tools/wheel makes a wheel that needs nothing but the system's C and C++ libraries and numpy."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SYSTEM = re.compile(r"(linux-vdso|libc|libm|libstdc\+\+|libgcc_s|.*ld-linux-[\w-]+)\.so")
ASK = """
import ctypes, re, sys
if sys.argv[1:]:
    ctypes.CDLL("libtbb.so.12", mode=ctypes.RTLD_GLOBAL)
import hausbench as hb, numpy as np
rng = np.random.default_rng(7)
answer = hb.directed(rng.random((5000, 3)), rng.random((5000, 3)), threads=2)
print(answer.interval, sum(bool(re.search(r"r-x.*/libtbb[-.]", line)) for line in open("/proc/self/maps")), hb.__file__)
"""


@pytest.fixture(scope="module")
def wheel() -> Path:
    if not (ROOT / "build/release/library/libhausbench.so").exists():
        pytest.skip("the library is not built in build/release")
    done = subprocess.run([sys.executable, ROOT / "tools/wheel"], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    return ROOT / done.stdout.splitlines()[-1].split(":")[0]


@pytest.fixture(scope="module")
def python(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A virtual environment with the wheel and the system's numpy."""
    folder = tmp_path_factory.mktemp("venv")
    subprocess.run([sys.executable, "-m", "venv", "--system-site-packages", folder], check=True)
    subprocess.run(
        [folder / "bin/python", "-m", "pip", "install", "-q", "--no-index", "--no-deps", wheel],
        check=True,
    )
    return folder / "bin/python"


def ask(python: Path, *arguments: str) -> list[str]:
    environment = {
        name: value
        for name, value in os.environ.items()
        if name not in ("PYTHONPATH", "HAUSBENCH_PYTHON")
    }
    done = subprocess.run(
        [python, "-c", ASK, *arguments], env=environment, cwd="/", capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.rsplit(maxsplit=2)


def test_nothing_outside_the_wheel_but_the_system(python: Path) -> None:
    folder = Path(ask(python)[2]).parents[1]
    assert folder.is_relative_to(python.parents[1])
    files = [*folder.glob("hausbench/*.so*"), *folder.glob("hausbench.libs/*")]
    assert len(files) > 6
    for file in files:
        listed = subprocess.run(["ldd", file], capture_output=True, text=True, check=True).stdout
        outside = [
            line
            for line in listed.splitlines()
            if str(folder) not in line and not SYSTEM.match(line.strip())
        ]
        assert outside == [], file


def test_every_library_has_its_licence_and_its_source(wheel: Path) -> None:
    names = zipfile.ZipFile(wheel).namelist()
    listed = next(name for name in names if name.endswith("/licenses/LIBRARIES.txt"))
    text = zipfile.ZipFile(wheel).read(listed).decode()
    libraries = {
        library["name"].split(".so")[0]
        for library in tomllib.loads((ROOT / "tests/library/licences.toml").read_text())["library"]
    }
    for name in (name for name in names if name.startswith("hausbench.libs/")):
        line = next(line for line in text.splitlines() if line.startswith(name))
        assert f"{listed.rsplit('/', 1)[0]}/{line.split('licence in ')[1].split(';')[0]}" in names
        assert re.search(r"Debian source package \S+ \S+$", line)
        assert Path(name).name.rsplit("-", 1)[0] in libraries


def test_the_tag_says_which_systems_it_runs_on(wheel: Path) -> None:
    assert re.fullmatch(
        r"hausbench-[\d.]+-cp(\d+)-cp\1-manylinux_2_(3[4-9]|4\d)_\w+\.whl", wheel.name
    )


def test_a_second_tbb_in_the_process(python: Path) -> None:
    alone, beside = ask(python), ask(python, "with another")
    assert alone[0] == beside[0]
    assert (alone[1], beside[1]) == ("1", "2")
