"""README's table of winners: it is what the kept tables give, and it follows them."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from analysis import winners
from analysis.shared import tables
from analysis.shared.statistics import median

TABLE3 = """## zhang2017_table3

**Times.**

| scene |  | \\|A\\| / \\|B\\| | EARLYBREAK | scan (ours) | k-d tree (nanoflann) | EARLYBREAK / framework |
|---|---|---:|---:|---:|---:|---:|
| (a) pears | here | 1 / 1 | 8.00 [7.00, 9.00] | 2.00 [1.50, 2.50] | 4.00 [3.00, 5.00] | 9.00 |
|  | distances |  | 1 | 2 | 3 | — |
|  | paper | 1 / 1 | 0.1 | — | — | — |
| (b) cow | here | 1 / 1 | 1.00 [0.900, 1.10] | timeout | 3.00 [2.90, 3.10] | 9.00 |
| (c) cups | here | 1 / 1 | 1.00 [0.900, 1.10] | 1.05 [1.00, 1.10] | 3.00 [2.90, 3.10] | 9.00 |

- Medians of n = 10 rounds, with order-statistic intervals in brackets (95 %).
"""


def kept(folder: Path, text: str = TABLE3) -> Path:
    """The kept files of tables."""
    (folder / "zhang2017_paper_profile.md").write_text(text, encoding="utf-8")
    for other in winners.SOURCES[1:]:
        (folder / other).write_text(f"## {other.removesuffix('.md')}\n", encoding="utf-8")
    return folder


def test_readme_is_what_the_kept_tables_give() -> None:
    readme = winners.README.read_text(encoding="utf-8")
    assert winners.rewritten(readme, winners.table()) == readme, "run python3 -m analysis.winners"
    assert "| `scan` |" in winners.table()


def test_a_winner_is_separated_from_all_others(tmp_path: Path) -> None:
    """(a) is scan's, two times over the tree; (b) EARLYBREAK's, for scan timed out; on (c) the two are level."""
    lines = winners.table(kept(tmp_path)).splitlines()
    assert "| `scan` | 1 of the 3 pairs of Table 3, 2.0 times over the next best |" in lines
    assert "| `earlybreak` | 1 of the 3 pairs of Table 3, 3.0 times over the next best |" in lines


def test_a_single_time_neither_wins_nor_loses(tmp_path: Path) -> None:
    """On (a) the tree has a single time, above or below all intervals; the other scenes stay as they are."""
    for time, least in (("4.00", "; the interval of `scan` lies below all intervals and single times in 1 of them"), ("0.100", "")):
        text = winners.table(kept(tmp_path, TABLE3.replace("4.00 [3.00, 5.00]", time)))
        assert "`scan` |" not in text and "`kdtree` |" not in text
        assert "| `earlybreak` | 1 of the 3 pairs of Table 3, 3.0 times over the next best |" in text
        assert ("\n\nNo winner in 1 of the 3 pairs of Table 3: k-d tree (nanoflann) has single times there, without an interval"
                f"{least}.") in text


def test_mesh_solvers_race_on_their_rows_of_times(tmp_path: Path) -> None:
    """The mark is in another column there, and each pair has two more rows."""
    kept(tmp_path)
    (tmp_path / "mesh_peers.md").write_text("""## mesh_peers

| pair | triangles | h / diagonal |  | Guthe 2005 | Sacht 2024 | CGAL |
|---|---|---|---|---:|---:|---:|
| bull | 2 → 1 | 0.1 | ms | 8.00 [7.00, 9.00] | 2.00 [1.50, 2.50] | 4.00 [3.00, 5.00] |
|  |  |  | times | 1 [1, 1] | 9 [9, 9] | — |
| cow | 2 → 1 | 0.1 | ms | 1.00 [0.900, 1.10] | timeout | 3.00 [2.90, 3.10] |
|  |  |  | times | 9 [9, 9] | — | — |

- Medians of n = 6 rounds, with order-statistic intervals in brackets (95 %).
""", encoding="utf-8")
    text = winners.table(tmp_path)
    assert "| `guthe` | 1 of the 2 pairs of real meshes, 3.0 times over the next best |" in text
    assert "| `sacht` | 1 of the 2 pairs of real meshes, 2.0 times over the next best |" in text


@pytest.mark.parametrize("rounds", [2, 5])
def test_nobody_wins_by_intervals_of_less_than_95_percent(rounds: int, tmp_path: Path) -> None:
    """The note is that of tables.coverage_note, for six rounds as for fewer."""
    old = "Medians of n = 10 rounds, with order-statistic intervals in brackets (95 %)."
    few, enough = (tables.coverage_note([median([1.0 + i for i in range(n)])]) for n in (rounds, 6))
    text = winners.table(kept(tmp_path, TABLE3.replace(old, few)))
    assert text.count("over the next best") == 0
    assert "No winner in 3 of the 3 pairs of Table 3: their intervals are of less than 95 %." in text
    assert winners.table(kept(tmp_path, TABLE3.replace(old, enough))).count("over the next best") == 2


def test_small_times_have_exponents(tmp_path: Path) -> None:
    assert winners.interval("1.2e-05 [1.1e-5, 1.3e-05]") == (1.2e-5, 1.1e-5, 1.3e-5)
    assert winners.interval("timeout") is None and winners.interval("1.10 (not separated)") is None
    value = winners.interval(tables.estimate(median([1e-6 * (i + 1) for i in range(6)])))
    assert value is not None and value[1:] == (1e-6, 6e-6)
    text = TABLE3.replace("1.05 [1.00, 1.10]", "1.2e-5 [1.1e-5, 1.3e-5]")
    assert "| `scan` | 2 of the 3 pairs of Table 3" in winners.table(kept(tmp_path, text))


def test_the_stated_sources_are_the_files_that_are_read(tmp_path: Path) -> None:
    """Without any of them there is no table; another kept file is not asked for."""
    stated = re.findall(r"\(results/reference/([^)]*)\)", winners.table(kept(tmp_path)))
    assert stated == list(winners.SOURCES) and set(stated) == {path.name for path in tmp_path.iterdir()}
    for name in stated:
        (tmp_path / name).rename(tmp_path / "away")
        with pytest.raises(FileNotFoundError):
            winners.table(tmp_path)
        (tmp_path / "away").rename(tmp_path / name)


def test_the_table_follows_the_data(tmp_path: Path) -> None:
    text = TABLE3.replace("2.00 [1.50, 2.50]", "2.00 [1.50, 3.50]")
    assert "`scan`" not in winners.table(kept(tmp_path, text))


def test_marks_are_needed(tmp_path: Path) -> None:
    (tmp_path / "README.md").write_text(f"a\n{winners.BEGIN}\noutdated\n{winners.END}\nb\n", encoding="utf-8")
    winners.write(kept(tmp_path), tmp_path / "README.md")
    text = (tmp_path / "README.md").read_text(encoding="utf-8")
    assert text.startswith(f"a\n{winners.BEGIN}\nFrom the kept tables: [pairs of Table 3]") and text.endswith(f"|\n{winners.END}\nb\n") and "outdated" not in text
    with pytest.raises(ValueError, match="marks"):
        winners.rewritten("no marks", "x")
