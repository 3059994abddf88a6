"""README's table of winners follows from the times kept in results/reference, which agree with the
tables kept there."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
import synthetic

from analysis import paper_profile, winners
from analysis.shared import numerals, style, table_files, tables
from analysis.shared.load import REFERENCE
from analysis.shared.estimates import Estimate

# Milliseconds on three scenes: the median and its interval. An empty list is a timeout.
TIMES: dict[str, dict[str, list[float]]] = {
    "a_pears": {"earlybreak": [8.0, 7.0, 9.0], "scan": [2.0, 1.5, 2.5], "kdtree": [4.0, 3.0, 5.0]},
    "b_cow": {"earlybreak": [1.0, 0.9, 1.1], "scan": [], "kdtree": [3.0, 2.9, 3.1]},
    "c_cups": {"earlybreak": [1.0, 0.9, 1.1], "scan": [1.05, 1.0, 1.1], "kdtree": [3.0, 2.9, 3.1]},
}


def kept(
    folder: Path,
    stem: str = "zhang2017_table3",
    times: dict[str, dict[str, list[float]]] = TIMES,
    rounds: int = 10,
    apart: str = "",
    **changed: list[float],
) -> Path:
    """Writes one file of times per stem, empty except for `stem`. `changed` replaces times on the
    first scene."""
    first = next(iter(times))
    records: list[tables.Record] = [
        {
            "stem": stem,
            "scene": scene,
            "solver": solver,
            "label": solver,
            "title": style.title(solver),
            "seconds": seconds,
            "n": {0: 0, 1: 1, 3: rounds}[len(seconds)],
            "apart": apart,
        }
        for scene, by_solver in times.items()
        for solver, seconds in (by_solver | (changed if scene == first else {})).items()
    ]
    for name, (file, _) in winners.RACES.items():
        table_files.save_json(
            records if name == stem else [], (folder / file).with_suffix(winners.SUFFIX)
        )
    return folder


def test_readme_is_what_the_kept_times_give() -> None:
    readme = winners.README.read_text(encoding="utf-8")
    assert winners.rewritten(readme, winners.table()) == readme, "run python3 -m analysis.winners"
    assert "| `scan` |" in winners.table()


def rows_of(stem: str, text: str) -> list[list[str]]:
    """Returns the cells of a stem's table, with the header first."""
    section = text.partition(f"\n## {stem}\n")[2].partition("\n## ")[0]
    rows = []
    for line in section.splitlines():
        if line.startswith("| "):
            rows.append([cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]])
    return rows


@pytest.mark.parametrize("stem", winners.RACES)
def test_the_kept_times_are_those_of_the_kept_table(stem: str) -> None:
    """Each kept time equals the printed cell of its scene and solver, and no printed time is
    missing."""
    file = winners.RACES[stem][0]
    header, *rows = rows_of(stem, (REFERENCE / file).read_text(encoding="utf-8"))
    times = [time for time in winners.read(file) if time.stem == stem]
    titles = {time.title for time in times}
    by_cell = {(time.scene, time.title): time for time in times}
    assert len(by_cell) == len(times) and {time.title for time in times} <= set(header)
    for scene in dict.fromkeys(time.scene for time in times):
        row = next(row for row in rows if row[0] in (scene, style.scene_title(scene)))
        for title, cell in zip(header, row):
            if title in titles:
                time = by_cell[scene, title]
                value, low, high = [*time.seconds, *[float("nan")] * 3][:3]
                printed = numerals.estimate(Estimate(value, low, high, time.n, 1.0), 1000)
                assert cell == printed if time.n else not cell[0].isdigit()


def test_a_winner_is_separated_from_all_others(tmp_path: Path) -> None:
    """scan wins the first scene by a factor of 2, and earlybreak the second, where scan timed out.
    On the third, the two are level."""
    lines = winners.table(kept(tmp_path)).splitlines()
    assert "| `scan` | 1 of the 3 pairs of Table 3, 2.0 times as fast as the next best |" in lines
    assert (
        "| `earlybreak` | 1 of the 3 pairs of Table 3, 3.0 times as fast as the next best |"
        in lines
    )
    assert "`scan`" not in winners.table(kept(tmp_path, scan=[2.0, 1.5, 3.5]))


def test_a_single_time_neither_wins_nor_loses(tmp_path: Path) -> None:
    """A single time has no interval, so nothing is decided on the first scene, whether it is above
    or below all intervals."""
    for time, least in (
        (4.0, "; the interval of `scan` lies below all intervals and single times in 1 of them"),
        (0.1, ""),
    ):
        text = winners.table(kept(tmp_path, kdtree=[time]))
        assert "`scan` |" not in text and "`kdtree` |" not in text
        assert (
            "| `earlybreak` | 1 of the 3 pairs of Table 3, 3.0 times as fast as the next best |"
            in text
        )
        assert (
            "\n\nNo winner in 1 of the 3 pairs of Table 3: k-d tree (nanoflann) has single times there, without an interval"
            f"{least}."
        ) in text


@pytest.mark.parametrize("rounds", [2, 5])
def test_nobody_wins_by_intervals_of_less_than_95_percent(rounds: int, tmp_path: Path) -> None:
    text = winners.table(kept(tmp_path, rounds=rounds))
    assert text.count("as fast as the next best") == 0
    assert "No winner in 3 of the 3 pairs of Table 3: their intervals cover less than 95 %." in text
    assert winners.table(kept(tmp_path, rounds=6)).count("as fast as the next best") == 2


def test_the_stated_sources_are_those_that_are_read(tmp_path: Path) -> None:
    """Each file named as a source is needed, and no other file is."""
    stated = re.findall(r"\(results/reference/([^)]*)\)", winners.table(kept(tmp_path)))
    files = [Path(name).with_suffix(winners.SUFFIX).name for name in stated]
    assert stated == list(winners.SOURCES) and set(files) == {
        path.name for path in tmp_path.iterdir()
    }
    for name in files:
        (tmp_path / name).rename(tmp_path / "away")
        with pytest.raises(FileNotFoundError):
            winners.table(tmp_path)
        (tmp_path / "away").rename(tmp_path / name)


def test_times_are_kept_with_their_table(tmp_path: Path) -> None:
    """Kept times stay if this run has no result for them. Outside programs appear under their
    titles."""
    for file in (synthetic.points_speed(), synthetic.zhang2017_table3()):
        file.meta["profile"] = "paper"
        file.write(tmp_path)
        assert (
            paper_profile.main(
                [
                    file.stem.partition("_table")[0],
                    "--results",
                    str(tmp_path),
                    "--out",
                    str(tmp_path),
                ]
            )
            == 0
        )
    points = {(time.scene, time.label): time for time in winners.read("points_speed.md", tmp_path)}
    scan, kdtree = points["overlapping_100K", "scan"], points["noisy_100K", "scipy_ckdtree"]
    assert (
        [numerals.number(1000 * x) for x in scan.seconds] == ["2.00", "1.93", "2.08"]
        and scan.name == "`scan`"
        and scan.apart == ""
    )
    assert (
        kdtree.seconds == pytest.approx([0.08]) and kdtree.n == 1 and kdtree.name == "SciPy cKDTree"
    )
    assert (
        points["noisy_100K", "earlybreak"].n == 0 and not points["noisy_100K", "earlybreak"].seconds
    )
    assert "| SciPy cKDTree |" in (tmp_path / "points_speed.md").read_text(encoding="utf-8")

    before = (tmp_path / "zhang2017_paper_profile.times.json").read_bytes()
    assert before.startswith(b'[\n{"stem": "zhang2017_table3", "scene": "a_pears", ')
    (tmp_path / "zhang2017_table3.h5").rename(tmp_path / "away")
    fig8 = synthetic.ResultFile("zhang2017_fig8")
    fig8.case("nohd", "50K", [1.0], lower=1.0, upper=1.0, options={"depth": 5}, variant="depth=5")
    fig8.meta["profile"] = "paper"
    fig8.write(tmp_path)
    assert (
        paper_profile.main(["zhang2017", "--results", str(tmp_path), "--out", str(tmp_path)]) == 0
    )
    assert (tmp_path / "zhang2017_paper_profile.times.json").read_bytes() == before


def test_a_scene_is_one_race_at_its_largest_tolerance(tmp_path: Path) -> None:
    file = synthetic.ResultFile("mesh_peers")
    for tolerance, ours in ((1e-6, 0.001), (1e-8, 0.5)):
        for solver, seconds in (("cover", ours), ("sacht", 0.01)):
            file.case(
                solver,
                "near",
                [seconds * (1 + k / 1000) for k in range(6)],
                prepare_seconds=0.0,
                lower=0.25,
                upper=0.25,
                tolerance=tolerance,
            )
    file.meta["profile"] = "paper"
    file.write(tmp_path)
    assert (
        paper_profile.main(["mesh_peers", "--results", str(tmp_path), "--out", str(tmp_path)]) == 0
    )
    race = winners.race(winners.read("mesh_peers.md", tmp_path))
    assert (
        race.scenes == 1
        and list(race.won) == ["`cover`"]
        and race.won["`cover`"] == pytest.approx([10.0])
    )


def test_marks_are_needed(tmp_path: Path) -> None:
    (tmp_path / "README.md").write_text(
        f"a\n{winners.BEGIN}\noutdated\n{winners.END}\nb\n", encoding="utf-8"
    )
    winners.write(kept(tmp_path), tmp_path / "README.md")
    text = (tmp_path / "README.md").read_text(encoding="utf-8")
    assert (
        text.startswith(f"a\n{winners.BEGIN}\nFrom the kept tables: [pairs of Table 3]")
        and text.endswith(f"|\n{winners.END}\nb\n")
        and "outdated" not in text
    )
    with pytest.raises(ValueError, match="marks"):
        winners.rewritten("no marks", "x")
