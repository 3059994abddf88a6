"""Tests the table of the gate's trials: which verdicts count as right, and that its planted slowdowns fit the tree."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from bench.tracking import trials
from bench.tracking.blocks import Block
from bench.tracking.cases import ROOT, cases
from bench.tracking.trials import KINDS, busy, right, table_of


SLOWER = "kang on mesh to its half: slower by 5.0 %, and in a second run by 5.1 %"


def trial(kind: str, tiers: dict[str, str], load: int = 0, line: str = SLOWER) -> dict[str, Any]:
    return {"kind": kind, "load": load, "unrest": 0.012, "commit": "abc", "machine": "here", "exit": 0, "tiers": tiers, "seconds": 200,
            "lines": [line]}


@pytest.mark.parametrize("name", [name for name, kind in KINDS.items() if kind.text])
def test_each_plant_has_one_place(name: str) -> None:
    kind = KINDS[name]
    assert (ROOT / kind.file).read_text().count(kind.text) == 1 and kind.planted != kind.text


@pytest.mark.parametrize(("kind", "tiers", "load", "good"), [
    ("unchanged", {"counters": "passed", "time": "passed"}, 0, True), ("unchanged", {"time": "inconclusive"}, 0, False),
    ("unchanged", {"time": "inconclusive"}, 2, True), ("unchanged", {"time": "red"}, 2, False),
    ("slower", {"time": "red"}, 0, True), ("slower", {"counters": "red", "time": "passed"}, 0, False), ("slower", {"time": "passed"}, 2, False),
    ("visit", {"counters": "red", "time": "passed"}, 0, True), ("visit", {"counters": "passed", "time": "red"}, 0, False), ("visit", {}, 0, False)])
def test_what_is_right(kind: str, tiers: dict[str, str], load: int, good: bool) -> None:
    assert right(trial(kind, tiers, load)) is good


def test_a_slowdown_is_seen_where_it_was_planted() -> None:
    assert not right(trial("slower", {"time": "red"}, line=SLOWER.replace("kang", "guthe")))


def test_the_table_counts_each_kind_and_load_apart() -> None:
    text = table_of([trial("unchanged", {"time": "passed"}), trial("unchanged", {"time": "red"}), trial("unchanged", {"time": "inconclusive"}, 2)])
    assert "planted: nothing: 1 of 2 right" in text and "planted: nothing, with 2 cores kept busy: 1 of 1 right" in text
    assert "kang" not in text.split("\n\n")[2]


def test_what_is_uneven_is_not_quiet(monkeypatch: pytest.MonkeyPatch) -> None:
    seconds = iter([1.0, 1.02] * 6 + [1.0, 1.5] * 6)
    monkeypatch.setattr(trials, "measure", lambda program, case, folder: Block(next(seconds), 0, 0, ""))
    assert trials.unrest(Path("program")) == pytest.approx(0.02) and trials.unrest(Path("program")) == pytest.approx(0.5)


def test_the_probe_is_a_tracked_case() -> None:
    assert trials.PROBE in [case.name for case in cases()]


def test_load_ends_with_the_block() -> None:
    with busy(1) as _:
        pass
