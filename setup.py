"""Builds the Python package: CMake makes python/hausbench/_core and libhausbench.so, and setuptools
packs them. Says which packages are missing.

HAUSBENCH_LIBRARY=build/release/library/libhausbench.so takes a library that is built, instead of
building one in build/package.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = Path(__file__).resolve().parent


def version() -> str:
    match = re.search(
        r"project\(hausbench VERSION ([\d.]+)",
        (ROOT / "CMakeLists.txt").read_text(encoding="utf-8"),
    )
    assert match
    return match[1]


GROUPS = (
    "building",
    "libraries of the C library and of the Python package",
    "the Python package",
)  # of packages.txt


def missing_packages() -> list[str]:
    """Returns the Debian packages for building that are not installed; all of them on another
    system."""
    groups = re.split(
        r"^# ", (ROOT / "packages.txt").read_text(encoding="utf-8"), flags=re.MULTILINE
    )
    lines = [
        line
        for group in groups
        for title, _, rest in [group.partition("\n")]
        if title in GROUPS
        for line in rest.splitlines()
    ]
    wanted = [name for line in lines if (name := line.partition("#")[0].strip())]
    if not shutil.which("dpkg-query"):
        return wanted
    listed = subprocess.run(
        ["dpkg-query", "-W", "-f=${db:Status-Status} ${Package}\n", *wanted],
        capture_output=True,
        text=True,
    ).stdout
    return [name for name in wanted if f"installed {name}" not in listed.splitlines()]


def cmake(*arguments: object, environment: dict[str, str]) -> None:
    """Runs CMake. If it fails, or is not there, ends with the packages that are missing."""
    try:
        subprocess.run(["cmake", *map(str, arguments)], env=environment, check=True)
    except (OSError, subprocess.CalledProcessError) as error:
        if not (missing := missing_packages()):
            raise
        how = (
            "sudo apt-get install --no-install-recommends"
            if shutil.which("dpkg-query")
            else "on Debian: apt-get install --no-install-recommends"
        )
        sys.exit(
            f"hausbench could not be built ({error}). These packages are missing:\n  {how} {' '.join(missing)}"
        )


class CMakeBuild(build_ext):
    """Builds with CMake, and copies the module and the library beside it."""

    def run(self) -> None:
        library = os.environ.get("HAUSBENCH_LIBRARY")
        folder = ROOT / "build" / ("package_over_library" if library else "package")
        options = [f"-DHAUSBENCH_PYTHON_EXECUTABLE={sys.executable}", "-DCMAKE_BUILD_TYPE=Release"]
        if shutil.which("ninja"):
            options.append("-GNinja")
        if shutil.which("ccache"):
            options.append("-DCMAKE_CXX_COMPILER_LAUNCHER=ccache")
        if library:
            options.append(f"-DHAUSBENCH_LIBRARY={(ROOT / library).resolve()}")
        else:
            options += [
                "-DHAUSBENCH_WITH_PROGRAM=OFF",
                "-DHAUSBENCH_WITH_PYTHON=ON",
                "-DCMAKE_UNITY_BUILD=ON",
            ]
        environment = {
            **os.environ,
            "CCACHE_BASEDIR": str(ROOT),
            "CCACHE_DEPEND": "1",
            "CCACHE_SLOPPINESS": "pch_defines,time_macros",
        }
        cmake(
            "-S",
            ROOT / "python" if library else ROOT,
            "-B",
            folder,
            *options,
            environment=environment,
        )
        jobs = os.environ.get("JOBS") or str(os.cpu_count() or 1)
        cmake(
            "--build", folder, "-j", jobs, "--target", "hausbench_python", environment=environment
        )
        target = (
            ROOT / "python" / "hausbench" if self.inplace else Path(self.build_lib) / "hausbench"
        )
        target.mkdir(parents=True, exist_ok=True)
        for file in [
            *(folder / "python/hausbench").glob("_core*.so"),
            *(folder / "python/hausbench").glob("libhausbench.so*"),
        ]:
            shutil.copy2(file, target)


(ROOT / "build").mkdir(exist_ok=True)
setup(
    version=version(),
    package_dir={"": "python"},
    packages=["hausbench"],
    package_data={"hausbench": ["py.typed", "*.pyi"]},
    ext_modules=[Extension("hausbench._core", [])],
    cmdclass={"build_ext": CMakeBuild},
    options={"egg_info": {"egg_base": "build"}},
    zip_safe=False,
)
