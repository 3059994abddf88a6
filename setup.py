"""Builds the Python package: CMake makes python/hausbench/_core and libhausbench.so, and setuptools packs them.

HAUSBENCH_LIBRARY=build/release/library/libhausbench.so takes a library that is built, instead of building one in build/package.
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
    found = re.search(r"project\(hausbench VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text(encoding="utf-8"))
    assert found
    return found[1]


class CMakeBuild(build_ext):  # type: ignore[misc]
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
            options += ["-DHAUSBENCH_WITH_PROGRAM=OFF", "-DHAUSBENCH_WITH_PYTHON=ON", "-DCMAKE_UNITY_BUILD=ON"]
        environment = {**os.environ, "CCACHE_BASEDIR": str(ROOT), "CCACHE_DEPEND": "1", "CCACHE_SLOPPINESS": "pch_defines,time_macros"}
        subprocess.run(["cmake", "-S", ROOT / "python" if library else ROOT, "-B", folder, *options], env=environment, check=True)
        jobs = os.environ.get("JOBS") or str(os.cpu_count() or 1)
        subprocess.run(["cmake", "--build", folder, "-j", jobs, "--target", "hausbench_python"], env=environment, check=True)
        target = ROOT / "python" / "hausbench" if self.inplace else Path(self.build_lib) / "hausbench"
        target.mkdir(parents=True, exist_ok=True)
        for file in [*(folder / "python/hausbench").glob("_core*.so"), *(folder / "python/hausbench").glob("libhausbench.so*")]:
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
