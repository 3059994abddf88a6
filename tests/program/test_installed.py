"""An installed hausbench, without its source tree, has experiments and documents, and its hints
name existing files."""

from __future__ import annotations

import os
import re
from pathlib import Path

import pytest

from program import Program

LINK = re.compile(r"\]\(([^)#\s]+)")


class Installed(Program):
    def __init__(self, path: str, folder: Path) -> None:
        super().__init__(path, folder)
        self.cache = folder / "cache"

    def environment(self) -> dict[str, str]:
        return {
            name: value for name, value in os.environ.items() if not name.startswith("HAUSBENCH")
        } | {"XDG_CACHE_HOME": str(self.cache)}


@pytest.fixture
def installed(outside: Path, tmp_path: Path) -> Installed:
    return Installed(str(outside.parent / "installed" / "bin" / "hausbench"), tmp_path)


def test_its_experiments_run_in_any_folder(installed: Installed, tmp_path: Path) -> None:
    assert "zhang2017_table3" in installed("list", "experiments").stdout
    done = installed("run", "smoke", "--solver", "guthe", "--scene", "spheres", "--quiet")
    assert done.returncode == 0, done.stderr
    result = tmp_path / "results" / "smoke.h5"
    readers: list[list[str | Path]] = [["verify", result], ["draw", result, "--as", "table"]]
    for verb in readers:
        done = installed(*verb)
        assert done.returncode == 0, done.stderr
    # If started inside the installed files, the program still uses the user's cache.
    installed.folder = Path(installed.path).parents[1] / "share" / "hausbench" / "experiments"
    assert (
        installed("list", "smoke").returncode
        == installed("measure", "sphere1", "sphere2").returncode
        == 0
    )
    assert not (installed.folder.parent / "datasets" / "cache").exists()


def test_its_documents_are_whole(installed: Installed) -> None:
    folder = Path(installed.path).parents[1] / "share" / "doc" / "hausbench"
    assert (folder / "LICENSE").is_file() and (folder / "CITATION.cff").is_file()
    pages = list(folder.rglob("*.md"))
    assert folder / "docs" / "tour.md" in pages
    for page in pages:
        for link in LINK.findall(page.read_text()):
            assert "://" in link or (page.parent / link).exists(), (page, link)


def test_its_hints_name_what_is_there(installed: Installed) -> None:
    assert "run `hausbench fetch`" in installed.fails("measure", "bunny", "sphere1")
    assert installed("fetch", "--help").returncode == 0
    assert "'hausbench run smoke'" in installed("draw", "smoke.h5").stderr
    assert "run it in a checkout" in installed.fails("track")


def test_its_manual_and_completion_are_where_they_are_looked_for(installed: Installed) -> None:
    share = Path(installed.path).parents[1] / "share"
    assert (share / "man" / "man1" / "hausbench.1").read_text() == installed(
        "describe", "man"
    ).stdout
    assert (share / "bash-completion" / "completions" / "hausbench").read_text() == installed(
        "describe", "bash"
    ).stdout
