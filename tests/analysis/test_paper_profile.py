"""Tests the file that keeps the tables of a run at the paper's sizes."""

from __future__ import annotations

from pathlib import Path

import pytest
import synthetic
import synthetic_zhang

from analysis import paper_profile


def test_keeps_the_tables_in_order(tmp_path: Path) -> None:
    for file in (
        synthetic_zhang.memory(),
        synthetic_zhang.fig8(),
        synthetic_zhang.fig10(),
        synthetic_zhang.table1(),
    ):
        file.meta["profile"] = "paper"
        file.write(tmp_path)
    assert (
        paper_profile.main(["zhang2017", "--results", str(tmp_path), "--out", str(tmp_path)]) == 0
    )
    text = (tmp_path / "zhang2017_paper_profile.md").read_text(encoding="utf-8")
    sections = [line[3:] for line in text.splitlines() if line.startswith("## ")]
    assert sections == ["zhang2017_table1", "zhang2017_fig8", "zhang2017_fig10", "zhang2017_memory"]
    assert "- Test CPU, 2 cores" in text and "python3 -m analysis.paper_profile zhang2017" in text
    assert (
        "| zhang2017_table1 | 2026-01-01T00:00:00Z | 2026-01-01T00:01:00Z | 14 ok, 1 timeout |"
        in text
    )
    assert str(tmp_path) not in text


def test_a_single_stem_has_a_file_of_its_own_name(tmp_path: Path) -> None:
    file = synthetic.points_speed()
    file.meta["profile"] = "paper"
    file.write(tmp_path)
    assert (
        paper_profile.main(["points_speed", "--results", str(tmp_path), "--out", str(tmp_path)])
        == 0
    )
    assert "geometric mean" in (tmp_path / "points_speed.md").read_text(encoding="utf-8")


def test_keeps_what_was_written_by_hand(tmp_path: Path) -> None:
    file = synthetic.points_speed()
    file.meta["profile"] = "paper"
    file.write(tmp_path)
    arguments, path = [
        "points_speed",
        "--results",
        str(tmp_path),
        "--out",
        str(tmp_path),
    ], tmp_path / "points_speed.md"
    assert paper_profile.main(arguments) == 0
    before = path.read_text(encoding="utf-8")
    assert "Nothing below is edited by hand.\n" in before
    path.write_text(
        before.replace(
            "\n## points_speed", "\n## What it says\n\nScan is first.\n\n## points_speed"
        ),
        encoding="utf-8",
    )
    for _ in range(2):
        assert paper_profile.main(arguments) == 0
        text = path.read_text(encoding="utf-8")
        assert (
            "\n\n## What it says\n\nScan is first.\n\n## points_speed\n" in text
            and 'by hand, but for "What it says".' in text
        )
    assert (
        text.replace("\n## What it says\n\nScan is first.\n", "").replace(
            ', but for "What it says"', ""
        )
        == before
    )


def test_a_group_is_measured_in_parts(tmp_path: Path) -> None:
    """A table whose result is missing here keeps its text and its machine; a table measured again
    is replaced."""
    arguments = ["zhang2017", "--results", str(tmp_path), "--out", str(tmp_path)]
    first, second = synthetic_zhang.table1(), synthetic_zhang.fig8()
    for file, cpu in ((first, "Old CPU"), (second, "Other CPU")):
        file.meta |= {"profile": "paper", "cpu": cpu}
        file.write(tmp_path)
    assert paper_profile.main(arguments) == 0
    path = tmp_path / "zhang2017_paper_profile.md"
    before = paper_profile.kept_of(path)
    assert sorted(before.tables) == ["zhang2017_fig8", "zhang2017_table1"]

    (tmp_path / "zhang2017_table1.h5").unlink()
    second.meta["cpu"] = "New CPU"
    second.write(tmp_path)
    assert paper_profile.main(arguments) == 0
    after = paper_profile.kept_of(path)
    assert after.tables["zhang2017_table1"] == before.tables["zhang2017_table1"]
    assert after.rows == before.rows
    assert len(before.verdicts) == len(after.verdicts) and {
        record["stem"] for record in after.verdicts
    } == {"zhang2017_table1", "zhang2017_fig8"}
    assert "New CPU" in after.tables["zhang2017_fig8"]
    head = path.read_text(encoding="utf-8").partition("| stem |")[0]
    assert "Old CPU" in head and "New CPU" in head and "Other CPU" not in head


def test_refuses_other_profiles_and_nothing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = ["zhang2017", "--results", str(tmp_path), "--out", str(tmp_path)]
    assert paper_profile.main(arguments) == 2
    synthetic_zhang.fig8().write(tmp_path)
    assert paper_profile.main(arguments) == 2
    error = capsys.readouterr().err
    assert "make zhang2017 PROFILE=paper" in error and "profile 'quick'" in error
    assert not (tmp_path / "zhang2017_paper_profile.md").exists()
