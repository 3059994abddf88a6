"""Builds the program of any commit in its own worktree (build/versions/COMMIT), in the same way as
this one."""

from __future__ import annotations

import os
import shlex
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from bench.tracking.cases import ROOT

VERSIONS = ROOT / "build" / "versions"


class NotBuilt(Exception):
    """The commit does not exist or does not build; the message says which, and where the output
    is."""


@dataclass(frozen=True)
class Build:
    commit: str  # ten digits; "+" marks uncommitted changes
    program: Path
    kernels: Path | None  # kernel_bench; the first commits have none
    tree: Path = ROOT


def git(*words: str) -> str:
    try:
        done = subprocess.run(
            ["git", "-C", str(ROOT), *words],
            capture_output=True,
            text=True,
            check=False,
            stdin=subprocess.DEVNULL,
        )
    except OSError as problem:
        raise NotBuilt(f"git does not run: {problem.strerror}") from None
    if done.returncode != 0:
        raise NotBuilt(f"git {' '.join(words)}: {done.stderr.strip()}")
    return done.stdout.strip()


def commit_of(revision: str) -> str:
    return git("rev-parse", "--verify", "--short=10", f"{revision}^{{commit}}")


def here(program: Path) -> Build:
    """Returns the program built from the working tree. Raises NotBuilt if it is missing."""
    if not program.is_file():
        raise NotBuilt(f"{program} is missing: make build")
    kernels = program.parent / "kernel_bench"
    changed = git("status", "--porcelain", "--untracked-files=no")
    return Build(
        commit_of("HEAD") + ("+" if changed else ""),
        program,
        kernels if kernels.is_file() else None,
    )


def worktree(tree: Path, commit: str) -> None:
    """Checks the commit out in `tree`, replacing any other contents."""
    if not (tree / ".git").exists():
        git("worktree", "prune")
        git("worktree", "add", "--detach", "--force", str(tree), commit)
    git("-C", str(tree), "checkout", "--quiet", "--force", "--detach", commit)


def build_of(revision: str, jobs: int = os.cpu_count() or 1) -> Build:
    """Builds a commit once; later calls reuse the build. Raises NotBuilt if it fails."""
    commit = commit_of(revision)
    tree = VERSIONS / commit
    worktree(tree, commit)
    return build_in(tree, commit, jobs)


def build_in(tree: Path, commit: str, jobs: int) -> Build:
    """Builds the checked-out commit of a worktree. Raises NotBuilt if the program does not build;
    kernel_bench may be missing."""
    build = tree / "build" / "release"
    log = tree.parent / f"{tree.name}.log"  # inside the tree it would count as a change
    (tree / "build.log").unlink(missing_ok=True)  # earlier versions wrote it there
    launcher = ["-DCMAKE_CXX_COMPILER_LAUNCHER=ccache"] if shutil.which("ccache") else []
    # Two worktrees share ccache's results only if their own paths are excluded.
    environment = {**os.environ, "CCACHE_BASEDIR": str(tree)}
    options = shlex.split(os.environ.get("CMAKE_ARGS", ""))
    # The commit's own preset, as its `make build` uses it: grouping sources differently changes
    # times by some per cent.
    commands = [
        [
            "cmake",
            "-S",
            str(tree),
            "--preset",
            "release",
            "-DHAUSBENCH_WITH_TESTS=OFF",
            *launcher,
            *options,
        ],
        [
            "cmake",
            "--build",
            str(build),
            "-j",
            str(jobs),
            "--target",
            "hausbench",
            "hausbench_commit",
        ],
    ]
    with log.open("w") as out:
        print(
            f"building {commit} in {tree.relative_to(ROOT)}, which may take some minutes",
            file=sys.stderr,
            flush=True,
        )

        def succeeds(command: list[str]) -> bool:
            code = subprocess.call(
                command,
                stdin=subprocess.DEVNULL,
                stdout=out,
                stderr=subprocess.STDOUT,
                env=environment,
            )
            return code == 0

        if not all(map(succeeds, commands)):
            raise NotBuilt(f"{commit} does not build: its output is in {log}")
        bench = ["cmake", "--build", str(build), "-j", str(jobs), "--target", "kernel_bench"]
        built = succeeds(bench)
    kernels = build / "kernel_bench"
    return Build(
        commit, build / "hausbench", kernels if built and kernels.is_file() else None, tree
    )


def fetched_origins(models: dict[str, Any], names: Iterable[str]) -> list[str]:
    """Follows `from` from each model to its origin, and returns the origins that come from Debian
    or npm packages."""
    origins: set[str] = set()
    for name in names:
        chain = [name]
        while (origin := models.get(chain[-1], {}).get("from")) and origin not in chain:
            chain.append(origin)
        if models.get(chain[-1], {}).get("source") in ("debian", "npm"):
            origins.add(chain[-1])
    return sorted(origins)


def fetch(tree: Path, names: Iterable[str]) -> None:
    """Fetches models with the commit's own datasets/fetch.py. If a download fails, only the cases
    that need it stay empty."""
    manifest = tree / "datasets" / "manifest.toml"
    models = (
        tomllib.loads(manifest.read_text(encoding="utf-8")).get("model", {})
        if manifest.is_file()
        else {}
    )
    if not (origins := fetched_origins(models, names)):
        return
    done = subprocess.run(
        [sys.executable, "datasets/fetch.py", *origins],
        cwd=tree,
        capture_output=True,
        text=True,
        check=False,
        stdin=subprocess.DEVNULL,
    )
    if done.returncode != 0:
        words = (done.stderr.strip() or done.stdout.strip()).splitlines()
        print(
            f"{tree.name}: datasets/fetch.py {' '.join(origins)} ended with {done.returncode}: {words[-1] if words else ''}",
            file=sys.stderr,
            flush=True,
        )
