"""Help texts, the man page and bash completion are all made from one description of the
commands."""

from __future__ import annotations

import os
import re
import shlex
import shutil
import subprocess
from pathlib import Path

import pytest

from program import ROOT, Program

VERBS = (
    "measure",
    "run",
    "explain",
    "status",
    "show",
    "compare",
    "verify",
    "draw",
    "merge",
    "list",
    "fetch",
    "export",
    "track",
)
SCRIPTS = {
    "draw": ("-m", "analysis.draw"),
    "fetch": ("datasets/fetch.py",),
    "track": ("-m", "bench.tracking"),
}


def help_of(hausbench: Program, *verb: str, columns: int = 80) -> str:
    done = subprocess.run(
        [hausbench.path, *verb, "--help"],
        env={**hausbench.environment(), "COLUMNS": str(columns)},
        capture_output=True,
        text=True,
        check=True,
    )
    return done.stdout


def options(text: str) -> set[str]:
    return set(re.findall(r"(?<![\w-])--[a-z][a-z-]*", text))


def test_the_first_screen_names_every_verb_in_a_line(hausbench: Program) -> None:
    lines = help_of(hausbench).splitlines()
    assert len(lines) <= 24 and max(map(len, lines)) <= 80
    assert [line.split()[0] for line in lines if re.match(r"  \w", line)] == list(VERBS)


def test_an_unknown_verb_is_named_before_its_options_are_read(hausbench: Program) -> None:
    for option in ("--help", "--version", "--nonsense"):
        assert "unknown verb 'noverb'" in hausbench.fails("noverb", option)


def test_all_known_options_are_listed(hausbench: Program) -> None:
    said = hausbench.fails("measure", "--nonsense-of-no-kind")
    assert " more)" not in said and options(said) - {"--nonsense-of-no-kind"} == options(
        help_of(hausbench, "measure")
    ) | {"--help"}


@pytest.mark.parametrize("verb", VERBS)
def test_help_fits_on_a_screen(hausbench: Program, verb: str) -> None:
    text = help_of(hausbench, verb, columns=100)
    assert text.count("\n") <= 40, "shorten the texts; details belong into docs/"
    for columns in (80, 100):
        assert max(map(len, help_of(hausbench, verb, columns=columns).splitlines())) <= columns


@pytest.mark.parametrize("verb", VERBS)
def test_the_example_is_a_legal_command(hausbench: Program, verb: str, tmp_path: Path) -> None:
    """The example's files do not exist, so it must fail because of them and not because of its
    syntax."""
    examples = re.findall(
        r"^Example:  (.*)$", help_of(hausbench, verb, columns=100), flags=re.MULTILINE
    )
    assert len(examples) == 1
    words = shlex.split(examples[0])
    assert words[:2] == ["hausbench", verb]
    done = subprocess.run(
        [hausbench.path, *words[1:]],
        cwd=tmp_path,
        env={**os.environ, "HAUSBENCH_ROOT": str(tmp_path), "PYTHON": "/nowhere/python3"},
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert done.returncode == 2, done.stderr
    assert "--help" not in done.stderr, done.stderr


@pytest.mark.parametrize("verb", SCRIPTS)
def test_script_and_program_know_the_same_options(hausbench: Program, verb: str) -> None:
    done = subprocess.run(
        ["/usr/bin/python3", *SCRIPTS[verb], "--help"],
        cwd=ROOT,
        env=hausbench.environment(),
        capture_output=True,
        text=True,
        check=True,
    )
    listed = options(done.stdout.split("options:")[1])
    assert listed - {"--help"} == set(
        re.findall(r"^  (--[a-z-]+)", help_of(hausbench, verb), flags=re.MULTILINE)
    )


def test_a_script_gets_its_words(hausbench: Program, tmp_path: Path) -> None:
    """Repeated options, flags, values that begin with a dash, and several positional arguments are
    passed on unchanged."""
    python = tmp_path / "python3"
    python.write_text('#!/bin/sh\nprintf "%s\\n" "$@"\n')
    python.chmod(0o755)

    def given(*words: str) -> list[str]:
        done = subprocess.run(
            [hausbench.path, *words],
            env={**hausbench.environment(), "PYTHON": str(python)},
            capture_output=True,
            text=True,
            check=True,
        )
        return done.stdout.splitlines()

    assert given("draw", "--as", "table", "a.h5", "--as=motion", "--highlight", "guthe(samples=8)")[
        3:
    ] == ["a.h5", "--as=table", "--as=motion", "--highlight=guthe(samples=8)"]
    assert given("fetch", "bunny", "cow", "--check")[1:] == ["bunny", "cow", "--check"]
    assert given("fetch", "bunny", "--experiment", "a.toml", "b.toml")[1:] == [
        "bunny",
        "--experiment",
        "a.toml",
        "b.toml",
    ]
    assert given("track", "--case", "a", "--case", "b", "--update=-x")[3:] == [
        "--case=a",
        "--case=b",
        "--update=-x",
    ]


def test_the_man_page_has_every_verb_and_option(hausbench: Program, tmp_path: Path) -> None:
    page = hausbench("describe", "man").stdout
    plain = page.replace("\\-", "-")
    for verb in VERBS:
        section = plain.split(f"\n.SS {verb}\n")[1].split("\n.S")[0]
        listed = {match for match in re.findall(r"^\\fB(--[a-z-]+)", section, flags=re.MULTILINE)}
        assert listed == {
            name
            for name in re.findall(r"^  (--[a-z-]+)", help_of(hausbench, verb), flags=re.MULTILINE)
        }
    if shutil.which("groff"):
        done = subprocess.run(
            ["groff", "-man", "-Tutf8", "-ww", "-z"],
            input=page,
            capture_output=True,
            text=True,
            check=True,
        )
        assert done.stderr == ""


def completed(hausbench: Program, folder: Path, *words: str, **more: str) -> set[str]:
    """Returns what bash offers as completions of the last word."""
    script = hausbench("describe", "bash").stdout
    line = " ".join(map(shlex.quote, (hausbench.path, *words)))
    done = subprocess.run(
        [
            "bash",
            "-c",
            f'{script}\nCOMP_WORDS=({line}); COMP_CWORD={len(words)}; _hausbench; printf "%s\\n" "${{COMPREPLY[@]}}"',
        ],
        cwd=folder,
        env={**hausbench.environment(), **more},
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stderr == ""
    return set(done.stdout.split())


def test_bash_completes(hausbench: Program, tmp_path: Path) -> None:
    (tmp_path / "scan.ply").touch()
    assert completed(hausbench, tmp_path, "m") == {"measure", "merge"}
    assert completed(hausbench, tmp_path, "run", "--sh") == {"--shard", "--shards"}
    assert completed(hausbench, tmp_path, "run", "--engine", "") >= {"here", "slurm"}
    assert completed(hausbench, tmp_path, "measure", "a.ply", "b.ply", "--of", "d") == {"diagonal"}
    assert completed(hausbench, tmp_path, "measure", "--solver", "cov") == {"cover"}
    assert completed(hausbench, tmp_path, "measure", "sc") >= {
        "scan.ply",
        "screw",
    }  # files and models
    assert "zhang2017_table3" in completed(hausbench, tmp_path, "run", "zhang2017_")
    assert "bunny" in completed(hausbench, tmp_path, "export", "bun")
    assert completed(hausbench, tmp_path, "list", "key") == {"keys"}
    assert completed(hausbench, tmp_path, "show", "sca") == {"scan.ply"}


def test_completing_runs_no_command_of_a_name(hausbench: Program, tmp_path: Path) -> None:
    """A downloaded checkout may contain an experiment whose name is a shell command."""
    for folder in ("datasets", "experiments"):
        (tmp_path / folder).mkdir()
    (tmp_path / "datasets" / "manifest.toml").touch()
    (tmp_path / "experiments" / "$(touch taken).toml").touch()
    (tmp_path / "experiments" / "mine.toml").touch()
    assert completed(hausbench, tmp_path, "run", "mi", HAUSBENCH_ROOT=str(tmp_path)) == {"mine"}
    assert not (tmp_path / "taken").exists()
