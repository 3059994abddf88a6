"""Builds of other commits get their own worktree and models, and the same settings. Uses a scratch
repository."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from bench.tracking import builds
from bench.tracking.builds import NotBuilt, build_of, commit_of, here


@pytest.fixture
def repository(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    root = tmp_path / "a tree"  # a path with a blank
    root.mkdir()
    (root / "CMakeLists.txt").write_text("first\n")
    (root / ".gitignore").write_text("/build/\n")
    for words in (
        ["init", "-q"],
        ["add", "-A"],
        ["-c", "user.name=a", "-c", "user.email=a@b", "commit", "-qm", "first"],
    ):
        subprocess.run(["git", "-C", root, *words], check=True, capture_output=True)
    monkeypatch.setattr(builds, "ROOT", root)
    monkeypatch.setattr(builds, "VERSIONS", root / "build" / "versions")
    return root


@pytest.fixture
def commands(monkeypatch: pytest.MonkeyPatch) -> list[list[str]]:
    """Records the build commands instead of running them; creates only the file kernel_bench."""
    ran: list[list[str]] = []

    def call(command: list[str], **rest: object) -> int:
        ran.append(command)
        if "kernel_bench" in command:
            (Path(command[2]) / "kernel_bench").parent.mkdir(parents=True, exist_ok=True)
            (Path(command[2]) / "kernel_bench").touch()
        return 0

    monkeypatch.setattr("bench.tracking.builds.subprocess.call", call)
    return ran


def test_a_commit_is_built_as_this_one_is_in_a_worktree(
    repository: Path, commands: list[list[str]], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("CMAKE_ARGS", "-DHAUSBENCH_WITH_CGAL_PEER=OFF")
    commit = commit_of("HEAD")
    (repository / "CMakeLists.txt").write_text("second\n")
    build = build_of("HEAD", 3)
    assert (
        build.commit == commit
        and build.tree == repository / "build" / "versions" / commit
        and build.kernels is not None
    )
    assert (
        build.tree / "CMakeLists.txt"
    ).read_text() == "first\n", "the commit, not what is being worked on"
    configure, program, kernels = commands
    assert (
        configure[configure.index("--preset") + 1] == "release"
        and "-DHAUSBENCH_WITH_CGAL_PEER=OFF" in configure
    )
    assert (
        program[-2:] == ["hausbench", "hausbench_commit"]
        and kernels[-1] == "kernel_bench"
        and program[program.index("-j") + 1] == "3"
    )


def test_a_worktree_is_used_again_and_put_right(
    repository: Path, commands: list[list[str]]
) -> None:
    tree = build_of("HEAD").tree
    (tree / "CMakeLists.txt").write_text("somebody's change\n")
    (tree / "kept").touch()
    assert (
        build_of("HEAD").tree == tree
        and (tree / "CMakeLists.txt").read_text() == "first\n"
        and (tree / "kept").exists()
    )


def test_a_build_that_fails_names_its_log(
    repository: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("bench.tracking.builds.subprocess.call", lambda command, **rest: 1)
    with pytest.raises(NotBuilt, match="does not build: its output is in ") as problem:
        build_of("HEAD")
    tree = repository / "build" / "versions" / commit_of("HEAD")
    assert str(problem.value).endswith(f" {tree}.log") and Path(f"{tree}.log").is_file()
    assert not subprocess.check_output(
        ["git", "-C", tree, "status", "--porcelain"]
    ), "a build of a clean tree says that it is clean"


def test_the_first_commits_have_no_kernel_bench(
    repository: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(
        "bench.tracking.builds.subprocess.call",
        lambda command, **rest: int("kernel_bench" in command),
    )
    assert build_of("HEAD").kernels is None


def test_a_commit_that_is_not_there(repository: Path) -> None:
    with pytest.raises(NotBuilt, match="no-such-commit"):
        commit_of("no-such-commit")


def test_what_is_not_committed_shows_in_the_name(repository: Path) -> None:
    program = repository / "build" / "hausbench"
    program.parent.mkdir()
    with pytest.raises(NotBuilt, match="make build"):
        here(program)
    program.touch()
    assert here(program).commit == commit_of("HEAD") and here(program).kernels is None
    (repository / "CMakeLists.txt").write_text("second\n")
    (program.parent / "kernel_bench").touch()
    assert (
        here(program).commit == commit_of("HEAD") + "+"
        and here(program).kernels == program.parent / "kernel_bench"
    )


def test_git_that_is_missing(repository: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", "/nowhere")
    with pytest.raises(NotBuilt, match="git does not run"):
        commit_of("HEAD")
