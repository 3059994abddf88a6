"""`make experiments` continues after a failure, and in the end fails and names it."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

from program import ROOT

# A fake program; its exit code is the content of the experiment file.
PROGRAM = """#!/bin/bash
echo "ran $2"
exit "$(cat "$2")"
"""
# A fake Python that records the requested figures.
PYTHON = """#!/bin/bash
printf '%s\\n' "${@:3}" >> drawn
"""


def test_unsound_rows_are_drawn_named_and_a_failure(tmp_path: Path) -> None:
    shutil.copy(ROOT / "Makefile", tmp_path)
    shutil.copytree(ROOT / "tools", tmp_path / "tools")
    (tmp_path / "packages.txt").write_text("")
    for name, text in (("program", PROGRAM), ("python", PYTHON)):
        (tmp_path / name).write_text(text)
        (tmp_path / name).chmod(0o755)

    def make(codes: dict[str, int]) -> tuple[int, str, list[str]]:
        for folder in ("experiments", "analysis"):
            shutil.rmtree(tmp_path / folder, ignore_errors=True)
            (tmp_path / folder).mkdir()
        for stem, code in codes.items():
            (tmp_path / "experiments" / f"{stem}.toml").write_text(str(code))
            (tmp_path / "analysis" / f"{stem}.py").write_text("")
        (tmp_path / "drawn").write_text("")
        done = subprocess.run(
            [
                "make",
                "-o",
                "build",
                "SKIP_DEPS=1",
                "FETCH=true",
                f"HAUSBENCH_PROGRAM={tmp_path / 'program'}",
                f"PYTHON={tmp_path / 'python'}",
                "experiments",
            ],
            cwd=tmp_path,
            capture_output=True,
            text=True,
            timeout=60,
        )
        assert done.stdout.count("ran ") == len(codes), done.stdout + done.stderr
        return done.returncode, done.stderr, (tmp_path / "drawn").read_text().split()

    # The first that ends is drawn at once, and again with the others.
    code, said, drawn = make({"one": 0, "two": 0})
    assert code == 0 and drawn == ["one", "one", "two"], said
    code, said, drawn = make({"bad": 2, "good": 0, "internal": 3, "wrong": 1})
    assert code == 2 and drawn == ["good", "good", "wrong"]
    assert "failed: bad (run) internal (run) wrong (unsound rows)" in said


def test_models_are_fetched_for_the_stems_and_the_profile(tmp_path: Path) -> None:
    shutil.copy(ROOT / "Makefile", tmp_path)
    shutil.copytree(ROOT / "tools", tmp_path / "tools")
    (tmp_path / "packages.txt").write_text("")
    (tmp_path / "program").write_text("#!/bin/bash\n")
    (tmp_path / "program").chmod(0o755)
    (tmp_path / "experiments" / "paper").mkdir(parents=True)
    for stem in ("paper_fig1", "other", "paper_fig2", "corpus_every"):
        (
            tmp_path
            / "experiments"
            / ("paper" if stem.startswith("paper") else "")
            / f"{stem}.toml"
        ).write_text("")
    files = {stem: f"experiments/paper/{stem}.toml" for stem in ("paper_fig1", "paper_fig2")} | {
        "other": "experiments/other.toml"
    }

    def fetched(*arguments: str) -> list[str]:
        done = subprocess.run(
            [
                "make",
                "-o",
                "build",
                "SKIP_DEPS=1",
                "FETCH=echo fetched",
                f"HAUSBENCH_PROGRAM={tmp_path / 'program'}",
                *arguments,
            ],
            cwd=tmp_path,
            capture_output=True,
            text=True,
            timeout=60,
        )
        assert done.returncode == 0, done.stderr
        return next(
            line for line in done.stdout.splitlines() if line.startswith("fetched")
        ).split()[1:]

    assert fetched("paper_fig1") == ["--profile", "quick", "--experiment", files["paper_fig1"]]
    assert fetched("paper", "PROFILE=paper") == [
        "--profile",
        "paper",
        "--experiment",
        files["paper_fig1"],
        files["paper_fig2"],
    ]
    assert fetched("experiments") == [
        "--profile",
        "quick",
        "--experiment",
        files["other"],
        files["paper_fig1"],
        files["paper_fig2"],
    ]
    assert fetched("corpus") == [
        "--profile",
        "quick",
        "--experiment",
        "experiments/corpus_every.toml",
    ], "which `make experiments` leaves out"
    assert fetched("fetch-corpus") == ["--corpus", "--check"]


def test_a_stem_of_another_experiment_runs_that_one(tmp_path: Path) -> None:
    shutil.copy(ROOT / "Makefile", tmp_path)
    shutil.copytree(ROOT / "tools", tmp_path / "tools")
    (tmp_path / "packages.txt").write_text("")
    for name, text in (("program", PROGRAM), ("python", PYTHON)):
        (tmp_path / name).write_text(text)
        (tmp_path / name).chmod(0o755)
    for folder, suffix, text in (("experiments", "toml", "0"), ("analysis", "py", "")):
        (tmp_path / folder / "stability").mkdir(parents=True)
        (tmp_path / folder / "stability" / f"stability_matrix.{suffix}").write_text(text)
    for target in ("stability_error", "stability_time", "stability"):
        (tmp_path / "drawn").write_text("")
        done = subprocess.run(
            [
                "make",
                "-o",
                "build",
                "SKIP_DEPS=1",
                "FETCH=true",
                f"HAUSBENCH_PROGRAM={tmp_path / 'program'}",
                f"PYTHON={tmp_path / 'python'}",
                target,
            ],
            cwd=tmp_path,
            capture_output=True,
            text=True,
            timeout=60,
        )
        assert (
            done.returncode == 0
            and "ran experiments/stability/stability_matrix.toml" in done.stdout
        ), (done.stdout + done.stderr)
        assert (tmp_path / "drawn").read_text().split() == ["stability_matrix"]
