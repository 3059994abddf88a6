"""Options that choose rows: `show --where`, `--meta` and `--ledger`, `compare --scene`, `run
--again` and `--strict`; and experiments by name."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path

import pytest

from program import ROOT, Program, head
from test_run import numbers, run, texts
from test_show import result, seen  # noqa: F401  (fixtures)


def chosen(hausbench: Program, file: Path, *where: str) -> list[dict[str, str]]:
    arguments = [word for condition in where for word in ("--where", condition)]
    return list(csv.DictReader(io.StringIO(hausbench("show", file, "--csv", *arguments).stdout)))


def test_numbers_are_compared(hausbench: Program, result: Path) -> None:
    upper = sorted(float(row["upper"]) for row in chosen(hausbench, result, "status=ok"))
    middle = upper[len(upper) // 2]
    assert len(upper) == 4 and len(chosen(hausbench, result, f"upper>{middle!r}")) == sum(
        x > middle for x in upper
    )
    assert len(chosen(hausbench, result, f"upper>={middle!r}")) == sum(x >= middle for x in upper)
    assert len(chosen(hausbench, result, f"upper<{middle!r}")) == sum(x < middle for x in upper)
    assert len(chosen(hausbench, result, f"upper<={middle!r}", "lower_error<1")) == sum(
        x <= middle for x in upper
    )
    assert chosen(hausbench, result, "upper>nan") == [] and len(
        chosen(hausbench, result, "tolerance==0.01")
    ) == len(chosen(hausbench, result, "tolerance=0.01"))
    for wrong, said in (
        ("upper", "column>number"),
        (">1", "column>number"),
        ("upper>", "is a number"),
        ("status>ok", "is a text"),
        ("uper>1", "did you mean 'upper'"),
        ("upper!1", "column>number"),
    ):
        assert said in hausbench.fails("show", result, "--where", wrong)


def test_what_a_file_says_of_the_whole(hausbench: Program, result: Path) -> None:
    text = hausbench("show", result, "--meta").stdout
    assert "title              a test\n" in text and 'name = "guthe"' in text and "machine" in text
    assert json.loads(hausbench("show", result, "--meta", "--json").stdout)["stem"] == "seen"
    ledger = hausbench("show", result, "--ledger").stdout
    assert "surface_enclosure" in ledger and "not_run" in ledger
    assert {
        entry["kind"]
        for entry in json.loads(hausbench("show", result, "--ledger", "--json").stdout)
    } >= {"not_run"}


def test_rows_with_a_question_show_their_answer(
    hausbench: Program, seen: Path, tmp_path: Path
) -> None:
    seen.write_text(
        seen.read_text().replace('of = "diagonal"', 'of = "diagonal"\nfloor = 0.3\ncutoff = 0.3')
    )
    file = run(hausbench, seen, tmp_path)
    assert "h <= floor" in hausbench("show", file).stdout
    assert {row["answer"] for row in chosen(hausbench, file, "status=ok")} == {"h <= floor"}


def test_scenes_and_profiles_are_compared_apart(
    hausbench: Program, seen: Path, result: Path, tmp_path: Path
) -> None:
    assert hausbench("run", seen, "--results", tmp_path, "--profile", "paper").returncode == 0
    whole = hausbench("compare", result, result).stdout
    part = hausbench("compare", result, result, "--scene", "clouds of points").stdout
    assert (
        "clouds of points" in whole
        and "spheres" in whole
        and "spheres" not in part
        and "clouds of points" in part
    )
    assert "spheres" in hausbench("compare", result, result, "--profile", "quick").stdout
    assert "no row of this profile" in hausbench.fails(
        "compare", result, result, "--profile", "huge"
    )
    assert "no such scene" in hausbench.fails("compare", result, result, "--scene", "cones")


def test_chosen_cases_are_run_again(
    hausbench: Program, seen: Path, result: Path, tmp_path: Path
) -> None:
    before = numbers(result, "repeats/wall_seconds")
    assert (
        hausbench("run", seen, "--results", tmp_path, "--again", "tolerance=0.01").returncode == 0
    )
    changed = numbers(result, "repeats/wall_seconds") != before
    again = numbers(result, "cases/tolerance")[numbers(result, "repeats/case").astype(int)] == 0.01
    assert (changed == again).all() and again.any() and not again.all()
    assert "did you mean 'status'" in hausbench.fails(
        "run", seen, "--results", tmp_path, "--again", "staus=ok"
    )
    assert "not a status (did you mean 'unsound'?)" in hausbench.fails(
        "show", result, "--where", "status=unsoud"
    )
    assert "such as label=NAME" in hausbench.fails(
        "run", seen, "--results", tmp_path, "--again", "status=unsound"
    )


def test_how_many_cases_are_run_again_is_said(
    hausbench: Program, seen: Path, result: Path, tmp_path: Path
) -> None:
    """Cases that are read off a finer run are not counted."""
    assert (
        "2 finished cases are run again"
        in hausbench("run", seen, "--results", tmp_path, "--again", "tolerance=0.01").stderr
    )
    assert (
        "0 finished cases are run again"
        in hausbench("run", seen, "--results", tmp_path, "--again", "tolerance=7").stderr
    )


def test_a_strict_run_fails_where_a_case_did(
    hausbench: Program, plugin: Path, tmp_path: Path
) -> None:
    file = tmp_path / "crash.toml"
    file.write_text(head() + '\n[[solver]]\nname = "crashes"\n')
    ask = ("run", file, "--results", tmp_path, "--plugin", plugin, "--no-reference", "--quiet")
    assert hausbench(*ask).returncode == 0 and "signal" in texts(
        tmp_path / "crash.h5", "cases/status"
    )
    assert hausbench(*ask, "--strict").returncode == 1
    before = numbers(tmp_path / "crash.h5", "repeats/wall_seconds")
    assert hausbench(*ask, "--again", "status=signal").returncode == 0
    assert (
        numbers(tmp_path / "crash.h5", "repeats/wall_seconds") == before
    ).all()  # guthe's rows stay
    assert hausbench(*ask, "--strict", "--solver", "guthe").returncode == 0


def test_experiments_have_names(hausbench: Program, tmp_path: Path) -> None:
    assert "smoke" in hausbench("explain", "smoke", "--results", tmp_path).stdout
    assert "did you mean 'smoke'" in hausbench.fails("explain", "smok")
    assert (ROOT / "experiments" / "smoke.toml").exists()
