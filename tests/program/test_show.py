"""Output for people: `show`, `compare --solver`, `list` and the end of `run`; and a run that adds
to a result."""

from __future__ import annotations

import csv
import fcntl
import io
import json
import os
import pty
import re
import shutil
import signal
import struct
import subprocess
import termios
import threading
from pathlib import Path

import h5py
import pytest

from program import ROOT, Program
from test_run import numbers, run, same_answers, texts

EXPERIMENT = """\
title = "a test"
tolerances = [1e-2, 1e-3]
of = "diagonal"
repeats = 2
rounds = 6

[[scene]]
name = "spheres"
source = "sphere1"
target = "sphere2"

[[scene]]
name = "clouds of points"
source = "gaussian_1k_a"
target = "gaussian_1k_b"
profiles = ["paper"]

[[solver]]
name = "guthe"
parameters = { split = ["midpoint", "longest_edge"] }

[[solver]]
name = "surface_enclosure"

[[solver]]
name = "scan"
scenes = ["clouds of points"]
profiles = ["paper"]

[profile.paper]
"""


@pytest.fixture
def seen(tmp_path: Path) -> Path:
    file = tmp_path / "seen.toml"
    file.write_text(EXPERIMENT)
    return file


@pytest.fixture
def result(hausbench: Program, seen: Path, tmp_path: Path) -> Path:
    return run(hausbench, seen, tmp_path)


def on_terminal(
    hausbench: Program, columns: int, *arguments: str | Path, **environment: str
) -> str:
    """Returns the program's output on a terminal that is `columns` wide."""
    ours, terminal = pty.openpty()
    fcntl.ioctl(terminal, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
    surroundings = {
        key: value
        for key, value in hausbench.environment().items()
        if key not in ("NO_COLOR", "COLUMNS")
    }
    process = subprocess.Popen(
        hausbench.command(*arguments),
        stdout=terminal,
        stderr=subprocess.PIPE,
        cwd=hausbench.folder,
        env={**surroundings, "TERM": "xterm", **environment},
    )

    def end() -> None:
        """Marks the end of the output. The terminal stays open until then: some systems drop unread
        text when it closes."""
        try:
            process.wait(60)
        finally:
            os.write(terminal, b"\0")

    waiting = threading.Thread(target=end)
    waiting.start()
    written = b""
    while not written.endswith(b"\0"):
        written += os.read(ours, 1 << 16)
    waiting.join()
    os.close(ours)
    os.close(terminal)
    assert process.returncode == 0
    return written[:-1].decode().replace("\r\n", "\n")


def test_a_line_for_each_case_with_its_reason(hausbench: Program, result: Path) -> None:
    lines = hausbench("show", result).stdout.splitlines()
    assert lines[0].split() == [
        "solver",
        "scene",
        "tolerance",
        "lower",
        "upper",
        "gap",
        "prepare",
        "solve",
        "[interval]",
        "memory",
        "check",
        "status",
    ]
    rows = [line for line in lines[1:] if not line.startswith(" ")]
    assert len(rows) == 7 and rows[-1] == "6 of 6 rows: 4 ok, 2 skipped"
    assert sum("guthe(split=longest_edge)" in row for row in rows) == 2
    assert [line.strip() for line in lines if line.startswith(" ")] == [
        "solver 'surface_enclosure' takes no mesh as source"
    ] * 2


def test_forms_for_programs_say_the_same(hausbench: Program, result: Path) -> None:
    objects = json.loads(hausbench("show", result, "--json").stdout)["rows"]
    table = list(csv.DictReader(io.StringIO(hausbench("show", result, "--csv").stdout)))
    assert len(objects) == len(table) == 6
    for row, line in zip(objects, table):
        assert list(row) == list(line) and row["reason"] == line["reason"]
    assert [row["lower"] for row in objects[:4]] == list(numbers(result, "cases/lower")[:4])
    assert {row["times"] for row in objects[:4]} == {6}
    timed = [row for row in objects if row["times"] == 6]
    assert all(
        row["solve_seconds_low"] <= row["solve_seconds"] <= row["solve_seconds_high"]
        and row["confidence"] >= 0.95
        for row in timed
    )
    markdown = hausbench("show", result, "--md").stdout.splitlines()
    assert len(markdown) == 8 and all(
        line.startswith("|") and line.endswith("|") for line in markdown
    )
    assert len({line.count("|") for line in markdown}) == 1


def test_a_reader_that_stops_early_ends_it_without_a_word(hausbench: Program, result: Path) -> None:
    """Like `show | head`. The program first reads the file in a child process, which must not
    change how SIGPIPE ends it."""
    process = subprocess.Popen(
        hausbench.command("show", result, "--json"),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        env=hausbench.environment(),
    )
    assert process.stdout and process.stderr
    process.stdout.close()
    assert process.stderr.read() == b"" and process.wait(30) == -signal.SIGPIPE


@pytest.mark.parametrize("arguments", [("show", "RESULT", "--csv"), ("--help",), ("run", "--help")])
def test_a_full_disk_is_no_success(
    hausbench: Program, result: Path, arguments: tuple[str, ...]
) -> None:
    named: list[str | Path] = [
        result if argument == "RESULT" else argument for argument in arguments
    ]
    with open("/dev/full", "w", encoding="ascii") as full:
        done = subprocess.run(
            hausbench.command(*named),
            env=hausbench.environment(),
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            timeout=60,
        )
    assert (
        done.returncode == 2 and "cannot write the output: No space left on device" in done.stderr
    )


def test_choosing_rows(hausbench: Program, result: Path) -> None:
    def count(*choice: str) -> int:
        return len(json.loads(hausbench("show", result, "--json", *choice).stdout)["rows"])

    assert count("--where", "status=skipped") == 2
    assert count("--where", "status!=skipped", "--where", "tolerance=0.01") == 2
    assert count("--solver", "guthe") == 4 and count("--solver", "guthe(split=midpoint)") == 2
    assert count("--scene", "spheres") == 6
    # The table computes these columns; the result does not have them.
    assert (
        count("--where", "gap>0") == count("--where", "lower>0") == 4
        and count("--where", "gap>1") == 0
    )
    assert count("--where", "check=holds") == 4 and count("--where", "answer=gap") == 4
    assert "did you mean 'status'" in hausbench.fails("show", result, "--where", "statu=ok")
    assert "did you mean 'guthe'" in hausbench.fails("show", result, "--solver", "gute")
    assert "spheres" in hausbench.fails("show", result, "--scene", "sphere")
    done = hausbench("show", result, "--csv", "--json")
    assert (
        done.returncode == 2
        and "exclude" in json.loads(done.stdout)["error"]
        and "exclude" in done.stderr
    )
    hausbench.fails("show", result.with_name("absent.h5"))


@pytest.mark.parametrize("columns", [30, 50, 80, 200])
def test_nothing_wraps_on_a_terminal(hausbench: Program, result: Path, columns: int) -> None:
    verbs: list[list[str | Path]] = [
        ["show", result],
        ["show", result, "--summary"],
        ["list"],
        ["list", "solvers"],
        ["list", "guthe"],
        ["compare", "--solver", "guthe(split=midpoint)", "guthe(split=longest_edge)", result],
    ]
    for arguments in verbs:
        text = re.sub("\033\\[[0-9;]*m", "", on_terminal(hausbench, columns, *arguments))
        assert text and max(map(len, text.splitlines())) <= max(
            columns, 34
        ), arguments  # words are never cut
        assert "guthe" in text


def test_colour_is_for_terminals_that_want_it(hausbench: Program, result: Path) -> None:
    assert "\033[" in on_terminal(hausbench, 120, "show", result)
    assert "\033[" not in on_terminal(hausbench, 120, "show", result, NO_COLOR="1")
    assert "\033[" not in on_terminal(hausbench, 120, "show", result, TERM="dumb")
    assert "\033[" not in hausbench("show", result).stdout


def test_a_run_ends_with_every_reason(hausbench: Program, seen: Path, tmp_path: Path) -> None:
    done = hausbench("run", seen, "--results", tmp_path)
    assert (
        "surface_enclosure: skipped: solver 'surface_enclosure' takes no mesh as source (2 rows like this"
        in done.stdout
    )
    assert done.stdout.splitlines()[-1] == f"{tmp_path / 'seen.h5'}: 4 ok, 2 skipped"
    assert hausbench("show", tmp_path / "seen.h5", "--summary").stdout in done.stdout


def test_sweeps_have_names_everywhere(hausbench: Program, seen: Path, result: Path) -> None:
    for text in (
        hausbench("explain", seen).stdout,
        hausbench("run", seen, "--fresh", "--results", result.parent).stderr,
        hausbench("verify", result).stdout,
        hausbench("compare", result, result).stdout,
    ):
        assert "guthe(split=midpoint)" in text and "guthe(split=longest_edge)" in text
    assert (
        texts(result, "cases/variant")
        == ["split=midpoint"] * 2 + ["split=longest_edge"] * 2 + [""] * 2
    )


def test_two_solvers_of_one_result(hausbench: Program, result: Path) -> None:
    done = hausbench(
        "compare", "--solver", "guthe(split=midpoint)", "guthe(split=longest_edge)", result
    )
    assert done.returncode == 0 and done.stdout.startswith(
        "2 pairs of guthe(split=midpoint) and guthe(split=longest_edge); rows without a partner: 0"
    )
    assert "intervals: all 2 overlap" in done.stdout and "geometric mean" in done.stdout
    assert "did you mean 'guthe" in hausbench.fails("compare", "--solver", "guthe", "gute", result)
    assert "two" in hausbench.fails("compare", result)
    assert "one" in hausbench.fails("compare", result, result, "--solver", "guthe", "guthe")


def test_a_run_adds_to_the_result_and_replaces_nothing(
    hausbench: Program, seen: Path, result: Path, tmp_path: Path
) -> None:
    whole = tmp_path / "whole.h5"
    whole.write_bytes(result.read_bytes())
    done = hausbench("run", seen, "--results", tmp_path, "--solver", "surface_enclosure")
    assert done.returncode == 0 and "2 skipped; 4 rows of earlier runs are kept" in done.stdout
    same_answers(result, whole)
    # Another profile adds its rows, and a case in both profiles has one row.
    assert hausbench("run", seen, "--results", tmp_path, "--profile", "paper").returncode == 0
    profile = dict(
        zip(
            zip(
                texts(result, "cases/label"),
                texts(result, "cases/scene"),
                numbers(result, "cases/tolerance"),
            ),
            texts(result, "cases/profile"),
        )
    )
    assert (
        profile["guthe", "spheres", 0.01] == "paper,quick"
        and profile["scan", "clouds of points", 0.01] == "paper"
    )
    count = len(texts(result, "cases/label"))
    assert hausbench("run", seen, "--results", tmp_path).returncode == 0
    assert len(texts(result, "cases/label")) == count
    assert set(texts(result, "ledger/profile")) == {"quick", "paper"}
    before = json.loads(hausbench("show", result, "--json", "--scene", "clouds of points").stdout)
    assert (
        hausbench("run", seen, "--results", tmp_path, "--scene", "spheres", "--fresh").returncode
        == 0
    )
    assert (
        json.loads(hausbench("show", result, "--json", "--scene", "clouds of points").stdout)[
            "rows"
        ]
        == before["rows"]
    )
    assert (
        "[1/" not in hausbench("run", seen, "--results", tmp_path, "--profile", "paper").stderr
    )  # nothing was left to run
    # Profiles with other limits have other cases, which merge keeps apart.
    seen.write_text(EXPERIMENT + "limits = { case_seconds = 30 }\n")
    assert hausbench("run", seen, "--results", tmp_path, "--profile", "paper").returncode == 0
    assert hausbench("run", seen, "--results", tmp_path).returncode == 0
    merged = tmp_path / "merged.h5"
    assert hausbench("merge", merged, result, result).returncode == 0
    same_answers(merged, result)
    assert texts(merged, "cases/profile") == texts(result, "cases/profile") and {
        "quick",
        "paper",
    } == set(texts(result, "cases/profile"))


def test_a_result_that_cannot_be_read_is_put_aside(
    hausbench: Program, experiment: Path, tmp_path: Path
) -> None:
    (tmp_path / "tiny.h5").write_text("notes of mine")
    done = hausbench("run", experiment, "--results", tmp_path)
    assert done.returncode == 0 and "tiny.h5.unreadable" in done.stderr
    assert (tmp_path / "tiny.h5.unreadable").read_text() == "notes of mine"
    (tmp_path / "tiny.h5").write_text("more notes")
    done = hausbench("run", experiment, "--results", tmp_path)
    assert done.returncode == 0 and "tiny.h5.unreadable.2" in done.stderr
    assert (tmp_path / "tiny.h5.unreadable").read_text() == "notes of mine"
    assert (tmp_path / "tiny.h5.unreadable.2").read_text() == "more notes"


def test_a_sound_result_of_a_newer_program_stays_where_it_is(
    hausbench: Program, experiment: Path, tmp_path: Path
) -> None:
    file = tmp_path / "tiny.h5"
    assert hausbench("run", experiment, "--results", tmp_path).returncode == 0
    with h5py.File(file, "r+") as f:
        f["meta"].attrs["schema_version"] = 99
    content = file.read_bytes()
    line = hausbench.fails("run", experiment, "--results", tmp_path, "--fresh")
    assert "tiny.h5: has schema version 99" in line and "use a newer hausbench" in line
    assert file.read_bytes() == content and not list(tmp_path.glob("*.unreadable*"))
    assert texts(tmp_path / "tiny.h5", "cases/status") == ["ok"]


def test_list_is_one_screen_and_knows_each_name(hausbench: Program) -> None:
    lines = hausbench("list").stdout.splitlines()
    solvers = json.loads(hausbench("list", "--json").stdout)["solvers"]
    assert len(lines) < len(solvers) + 6 < 40
    for solver in solvers:
        assert sum(line.split()[0] == solver["name"] for line in lines) == 1
        description = hausbench("list", solver["name"]).stdout
        assert description.startswith(solver["name"] + ": ") and all(
            parameter["name"] in description for parameter in solver["parameters"]
        )
    assert (
        "smoke" in hausbench("list", "experiments").stdout
        and "spheres" in hausbench("list", "smoke").stdout
    )
    assert (
        "sphere3" in hausbench("list", "models").stdout
        and "GPL" in hausbench("list", "bunny").stdout
    )
    assert json.loads(hausbench("list", "columns").stdout)["cases"]
    assert "did you mean 'guthe'" in hausbench.fails("list", "gute")


def test_outside_a_project(hausbench: Program, tmp_path: Path) -> None:
    program = tmp_path / "bin" / "hausbench"
    program.parent.mkdir()
    shutil.copy(hausbench.path, program)
    environment = {
        key: value for key, value in os.environ.items() if not key.startswith("HAUSBENCH")
    } | {"XDG_CACHE_HOME": str(tmp_path / "cache")}

    def outside(*arguments: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [program, *arguments],
            cwd=tmp_path,
            env=environment,
            capture_output=True,
            text=True,
            timeout=60,
        )

    assert "guthe" in outside("list").stdout and outside("list").returncode == 0
    assert "no project here" in outside("list", "models").stdout
    assert re.match(r"hausbench \d+\.\d+\.\d+, commit ", outside("--version").stdout)
    shared = tmp_path / "share" / "hausbench" / "datasets"
    shared.mkdir(parents=True)
    shutil.copy(ROOT / "datasets" / "manifest.toml", shared)
    assert outside("export", "sphere1", "one.off").stdout.startswith("one.off: 80 triangles")
    assert not (tmp_path / "datasets").exists() and (tmp_path / "cache" / "hausbench").is_dir()


def test_the_version_names_the_commit(hausbench: Program) -> None:
    commit = json.loads(Path(hausbench.path).with_name("commit.json").read_text())["commit"]
    assert f"commit {commit[:10]}" in hausbench("--version").stdout
