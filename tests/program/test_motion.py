"""Moving targets: structures that are rebuilt for each pose, and how plan and ledger report them;
and the times of stages."""

from __future__ import annotations

import json
from pathlib import Path

import h5py
import pytest

from program import Program
from test_run import numbers, run, texts

MOVED = """
title = "motion"
tolerances = [{tolerances}]
of = "diagonal"
quantity = "{quantity}"
repeats = 1
trace = true
[[scene]]
name = "spheres"
source = "sphere2"
target = "sphere3"
{motion} = {{ kind = "translation", of = "longest", from = [0, 0, 0], to = [3, 0, 0], steps = 3 }}
[[solver]]
name = "tang"
"""


def experiment(
    folder: Path,
    tolerances: str = "1e-6",
    quantity: str = "symmetric",
    more: str = "",
    motion: str = "motion",
) -> Path:
    file = folder / "motion.toml"
    file.write_text(
        MOVED.format(tolerances=tolerances, quantity=quantity, motion=motion).replace(
            "repeats = 1", f"repeats = 1\n{more}"
        )
    )
    return file


def of_target(folder: Path, tolerances: str, more: str = "") -> Path:
    """Makes an experiment in which B moves. Coarse tolerances of h may be read off the trace of the
    finest."""
    return experiment(folder, tolerances, "directed", more, "target_motion")


def told(file: Path) -> set[str]:
    """Returns the kinds of ledger entries about structures that are built for each pose."""
    with h5py.File(file, "r") as f:
        return {
            kind
            for kind, left_out in zip(f["ledger/kind"].asstr()[:], f["ledger/what"].asstr()[:])
            if left_out == "structures for each pose"
        }


@pytest.mark.parametrize(
    ("tolerances", "quantity", "copied"),
    [("1e-6", "symmetric", False), ("1e-13", "symmetric", True), ("1e-13", "directed", False)],
)
def test_the_ledger_says_what_was_built_again(
    hausbench: Program, tmp_path: Path, tolerances: str, quantity: str, copied: bool
) -> None:
    file = experiment(tmp_path, tolerances, quantity)
    assert ("built again for each pose" in hausbench("explain", file).stdout) == copied
    assert told(run(hausbench, file, tmp_path)) == (
        {"prepared_again"} if copied else {"not_prepared"}
    )


@pytest.mark.parametrize(
    ("tolerances", "read_off"), [("1e-6, 1e-3", 3), ("1e-13, 1e-12", 3), ("1e-13, 1e-3", 0)]
)
def test_a_coarse_row_is_not_read_off_a_run_that_built_more(
    hausbench: Program, tmp_path: Path, tolerances: str, read_off: int
) -> None:
    assert (
        numbers(run(hausbench, of_target(tmp_path, tolerances), tmp_path), "cases/from_trace").sum()
        == read_off
    )


def test_stages_are_of_the_run_that_took_them(hausbench: Program, tmp_path: Path) -> None:
    """Rows of an earlier run without stages are run again. A row read off a trace has no stages."""
    names = {"seconds: cull on A", "seconds: cull on B", "seconds: subdivide"}
    assert not any(
        "seconds" in extras
        for extras in texts(
            run(hausbench, of_target(tmp_path, "1e-6, 1e-2"), tmp_path), "cases/extras"
        )
    )
    file = run(hausbench, of_target(tmp_path, "1e-6, 1e-2", "stages = true"), tmp_path)
    for extras, read_off in zip(texts(file, "cases/extras"), numbers(file, "cases/from_trace")):
        stages = {
            name: seconds
            for name, seconds in json.loads(extras).items()
            if name.startswith("seconds")
        }
        assert set(stages) == (set() if read_off else names)
        assert all(0 <= seconds < 10 for seconds in stages.values())
    assert numbers(file, "cases/from_trace").sum() == 3
    assert (
        hausbench(
            "run", of_target(tmp_path, "1e-6, 1e-2", "stages = true"), "--results", tmp_path
        ).returncode
        == 0
    )
