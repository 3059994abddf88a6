"""The steps of Containerfile, run in bare Debian roots made by tools/on; and by podman where it is.
`make test-container`."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
BASE = ROOT / "build/on/bookworm"  # the root of tools/on
LARGEST_MB = 60  # of the layers above the base
on_request = pytest.mark.skipif(
    "HAUSBENCH_CONTAINER" not in os.environ,
    reason="it takes a quarter of an hour: make test-container",
)


def stages(text: str) -> list[list[tuple[str, str]]]:
    """Returns the instructions of each stage after its FROM: [("RUN", "make build"), ...]."""
    instructions: list[list[tuple[str, str]]] = []
    for line in text.splitlines():
        word, _, rest = line.partition(" ")
        if word == "FROM":
            instructions.append([])
        elif word.isupper():
            instructions[-1].append((word, rest))
    return instructions


def on(*commands: str, again: bool = True) -> str:
    done = subprocess.run(
        [ROOT / "tools/on", *(["--again"] if again else []), "bookworm", *commands],
        cwd=ROOT,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
    return done.stdout


def megabytes(folder: Path) -> float:
    command = [
        "du",
        "-smx",
        "--exclude=./src",
        "--exclude=./var/lib/apt/lists",
        "--exclude=./var/cache",
        ".",
    ]
    return float(
        subprocess.run(
            command, cwd=folder, capture_output=True, text=True, check=True
        ).stdout.split()[0]
    )


def test_the_file_is_read() -> None:
    build, final = stages((ROOT / "Containerfile").read_text())
    assert [word for word, _ in final] == ["COPY", "RUN", "WORKDIR", "ENTRYPOINT"]
    assert any("make build" in rest for word, rest in build if word == "RUN")


@on_request
def test_the_steps_in_bare_roots(tmp_path: Path) -> None:
    build, final = stages((ROOT / "Containerfile").read_text())
    (source, target) = (
        next(rest for word, rest in final if word == "COPY").removeprefix("--from=build ").split()
    )
    on("true", again=False)
    on(*[rest.replace("/src/hausbench", "$PWD") for word, rest in build if word == "RUN"])
    shutil.copytree(BASE / source.lstrip("/"), tmp_path / "made", symlinks=True)
    on("true", again=False)
    before = megabytes(BASE)
    shutil.copytree(tmp_path / "made", BASE / target.lstrip("/"), symlinks=True, dirs_exist_ok=True)
    on(*[rest for word, rest in final if word == "RUN"])
    assert megabytes(BASE) - before < LARGEST_MB
    output = on(
        "printf 'OFF\\n3 1 0\\n0 0 0\\n1 0 0\\n0 1 0\\n3 0 1 2\\n' > /tmp/a.off; hausbench measure /tmp/a.off /tmp/a.off"
    )
    assert re.search(r"h\(A,B\) in \[0, ", output)
    assert "cgal 5." in (BASE / "usr/local/share/hausbench/container.txt").read_text()


@on_request
def test_by_podman() -> None:
    if not shutil.which("podman"):
        pytest.skip("podman is not installed")
    subprocess.run(["podman", "build", "-t", "hausbench-test", "."], cwd=ROOT, check=True)
    output = subprocess.run(
        ["podman", "run", "--rm", "hausbench-test", "list"],
        capture_output=True,
        text=True,
        check=True,
    ).stdout
    assert "cover" in output
