"""The stems of Zhang et al. 2017, from files with known numbers; and their verdicts."""

from __future__ import annotations

import math
import sys
from pathlib import Path

import numpy as np
import pytest
import synthetic_zhang
from stem_runner import Make, stem_runner
from synthetic import ResultFile

from analysis import points, verdicts, zhang2017_fig12, zhang2017_steps
from analysis.statistics import NO_DATA, Estimate


@pytest.fixture()
def make(tmp_path: Path) -> Make:
    return stem_runner(tmp_path)


def ratio(value: float, low: float, high: float) -> Estimate:
    return Estimate(value, low, high, 7, 0.98)


FASTER, SLOWER, LEVEL = ratio(2.0, 1.5, 2.5), ratio(0.5, 0.4, 0.6), ratio(1.1, 0.9, 1.3)


@pytest.mark.parametrize(("ratios", "outcome"), [
    ([FASTER, FASTER], verdicts.HOLDS), ([FASTER, LEVEL], verdicts.OPEN), ([FASTER, LEVEL, SLOWER], verdicts.FAILS),
    ([FASTER, NO_DATA], verdicts.HOLDS), ([NO_DATA], verdicts.UNTESTED),
    ([ratio(2.0, math.nan, math.nan)], verdicts.OPEN)])
def test_verdict_of_many_ratios(ratios: list[Estimate], outcome: str) -> None:
    assert verdicts.everywhere("x", ratios).outcome == outcome


def test_verdicts_of_one_ratio_and_of_counts() -> None:
    assert [verdicts.above_one("x", r).outcome for r in (FASTER, LEVEL, SLOWER, NO_DATA)] == \
        [verdicts.HOLDS, verdicts.OPEN, verdicts.FAILS, verdicts.UNTESTED]
    assert [verdicts.never("x", wrong, of, "cases").outcome for wrong, of in ((0, 9), (1, 9), (0, 0))] == \
        [verdicts.HOLDS, verdicts.FAILS, verdicts.UNTESTED]


def test_kendall_counts_permutations() -> None:
    for x, y, tau, chance in (([1, 2, 3], [1, 2, 3], 1.0, 2 / 6), ([1, 2, 3, 4], [4, 3, 2, 1], -1.0, 2 / 24),
                              ([1, 2, 3, 4], [1, 2, 4, 3], 2 / 3, 8 / 24),  # one inversion: 1 + 3 permutations a side
                              ([1, 2, 3, 4], [1, 1, 1, 1], 0.0, 1.0)):
        found = verdicts.kendall(x, y)
        assert found[0] == pytest.approx(tau) and found[1] == pytest.approx(chance)


def test_verdict_of_growth() -> None:
    up = [1.0, 2, 3, 4, 5, 6]
    assert verdicts.rising("x", up, up).outcome == verdicts.HOLDS
    assert verdicts.rising("x", up, up[::-1]).outcome == verdicts.FAILS
    assert verdicts.rising("x", up, [2.0, 1, 4, 3, 6, 5]).outcome == verdicts.OPEN  # p = 0.056 for 3 inversions


def test_verdict_of_the_least() -> None:
    def of(*ratios: Estimate) -> str:
        return verdicts.least_among("x", [(str(i), r) for i, r in enumerate(ratios)], "5", ["5", "6"]).outcome
    assert of(FASTER, FASTER) == verdicts.HOLDS and of(FASTER, LEVEL) == verdicts.OPEN
    assert of(FASTER, LEVEL, SLOWER) == verdicts.FAILS and of() == verdicts.UNTESTED


def test_table1_gives_both_variants_the_same_preparation(make: Make) -> None:
    records, rows, text = make(synthetic_zhang.table1())
    header = rows["pair"][0]
    first = rows["1"][0]
    assert first[1:4] == ["35.89", "22.47", "1.60"]  # the paper's, in ms
    # Ratios of (solve + 1 ms), not of the 0.5 s that one preparation took by accident.
    assert first[header.index("here: ratio")] == "1.50 [1.50, 1.50]" and first[header.index("work, ratio")] == "2.00"
    assert first[header.index("here: with")] == "3.06 [3.00, 3.12]"
    assert rows["4"][0][header.index("here: ratio")] == "1.10 [0.900, 1.10] (not separated)"
    assert rows["5"][0][header.index("here: without")] == "timeout" and rows["5"][0][header.index("here: ratio")] == "—"
    assert "Claim: early breaking makes NOHD faster. Here: not separated (above 1 for 3 of 4 pairs" in text
    assert "Claim: time increases with the numbers of points. Here it holds" in text and "Test CPU" in text
    record = next(r for r in records if (r["pair"], r["label"]) == ("2", "nohd"))
    assert float(record["paper_seconds"]) == 0.09993 and float(record["ratio"]) == pytest.approx(2.0)


def test_table2_says_what_was_culled_and_what_was_wrong(make: Make) -> None:
    _, rows, text = make(synthetic_zhang.table2())
    header, first = rows["pair"][0], rows["1"][0]
    assert first[header.index("culled, %")] == "25.0" and first[header.index("culled as printed, %")] == "50.0"
    assert first[header.index("ohd as printed")] == "unsound" and rows["2"][0][header.index("ohd as printed")] == "—"
    assert first[1] == "1577" and "half a standard deviation" in text


def test_fig8_finds_the_best_depth(make: Make) -> None:
    records, rows, text = make(synthetic_zhang.fig8())
    assert "3K points: NOHD is fastest at depth 5 or 6. Here it holds (least at depth 5)" in text
    assert "9K points: NOHD is fastest at depth 5 or 6. Here it does not hold (least at depth 2; faster than 5" in text
    assert "a smaller depth than 5 makes NOHD slower. Here it holds (above 1 for 2 of 2 pairs, ratio 2.00" in text
    cells = {row[0]: row[1:] for row in rows["9K"]}
    assert cells["9"][1] == "timeout" and cells["2"][2] == "1.00 (least)" and cells["5"][2:] == ["2.00", "507"]
    assert next(r for r in records if (r["scene"], r["depth"]) == ("9K", "9.0"))["status"] == "timeout 1 of 1"


def test_fig9_pools_seeds(make: Make) -> None:
    _, rows, text = make(synthetic_zhang.fig9())
    assert [row[0] for row in rows["4K"]] == ["1/400", "1/100", "1/80", "1/2"]
    assert rows["4K"][3][4] == "40.0"  # culled, %
    assert "lambda = 1/80. Here: not separated (least at 1/100; not separated from it: 1/400, 1/100)" in text
    assert "a much larger lambda makes OHD slower (1/2 against 1/80). Here it holds" in text and "n = 7" in text


@pytest.mark.parametrize("file", [synthetic_zhang.fig10(), synthetic_zhang.fig11()], ids=["fig10", "fig11"])
def test_motion_is_read_by_overlap(file: ResultFile, make: Make) -> None:
    records, rows, text = make(file)
    header = rows["models"][0]
    apart, touching, over = rows["ring, boxes apart"][0], rows["ring, α ≤ 0.33"][0], rows["ring, α > 0.33"][0]
    assert [row[1] for row in (apart, touching, over)] == ["6", "8", "7"]
    assert apart[header.index("EARLYBREAK / NOHD")] == "2.00 [2.00, 2.00]"
    assert over[header.index("NOHD")].endswith("(1 failed)")
    for claim, verdict in (("the time of EARLYBREAK peaks where the models overlap most", "holds (greatest at x = 0"),
                           ("where the boxes are apart, NOHD takes less time than EARLYBREAK",
                            "holds (at 6 of 6 poses"),
                           ("where 0 ≤ α ≤ 0.33, EARLYBREAK takes less time than OHD", "holds (at 8 of 8 poses"),
                           ("where α > 0.33, OHD takes less time than EARLYBREAK", "holds (at 7 of 7 poses")):
        assert f"Claim: ring: {claim}. Here it {verdict}" in text
    assert "NOHD: built once and used for all 21 poses, 2500 ms saved" in text
    assert sum(r["status"] == "timeout" for r in records) == 1


def test_motion_contradicts(make: Make) -> None:
    file = synthetic_zhang.fig10()
    for row in file.repeats:
        if file.cases[row["case"]]["solver"] == "nohd":
            row["cpu_seconds"] *= 10
    _, _, text = make(file)
    assert "NOHD takes less time than EARLYBREAK. Here it does not hold (at 0 of 6 poses" in text


POINTS = {"A": [[0.0, 0.0, 0.0]] * 4, "B": [[0.5, 0.0, 0.0]] + [[2.0, 0.0, 0.0]] * 4}


@pytest.fixture()
def program(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A program that exports A and B."""
    file = tmp_path / "program"
    file.write_text(f"""#!{sys.executable}
import sys
points = {POINTS}[sys.argv[2]]
open(sys.argv[3], "w").write("\\n".join(["OFF", str(len(points)) + " 0 0", *[" ".join(map(str, p)) for p in points]]))
""")
    file.chmod(0o755)
    monkeypatch.setenv("HAUSBENCH_PROGRAM", str(file))


def test_steps_expected_and_counted(make: Make, program: None) -> None:
    _, rows, text = make(synthetic_zhang.steps())
    assert rows["4"][0][2:] == ["6.00 [6.00, 6.00]", "5.00", "1.20", "3.00", "2.00"]
    assert rows["4"][4][2] == "3.00 [3.00, 3.00]"
    assert "4: c of Eq. 7 is a constant. Here: not separated (c from 0.833 to 1.67" in text


def test_expectations_where_no_point_is_near() -> None:
    a, b = np.array([[0.0, 0, 0], [9.0, 0, 0]]), np.array([[1.0, 0, 0], [1.0, 0, 0], [3.0, 0, 0]])
    # The first has two of three in reach, the second none: 1/p = 3, and (4/3 + 3) / 2.
    expected, by_point = zhang2017_steps.expectations(a, b, 2.0)
    assert expected == pytest.approx(3.0) and by_point == pytest.approx((4 / 3 + 3) / 2)


def test_steps_without_a_program(make: Make, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HAUSBENCH_PROGRAM", "/nowhere")
    _, rows, text = make(synthetic_zhang.steps())
    assert rows["4"][0][2:] == ["6.00 [6.00, 6.00]", *4 * ["—"]] and "not tested (fewer than three poses)" in text


def test_points_are_those_asked_for(program: None) -> None:
    a = points.points_of("A", 4)
    assert a is not None and a.shape == (4, 3) and points.points_of("A", 5) is None and points.points_of("C", 4) is None
    turned = points.posed(np.array([[1.0, 0, 0]]), np.array([0.0, -1, 0, 1, 0, 0, 0, 0, 1, 5, 0, 0]))
    assert turned.tolist() == [[5.0, 1.0, 0.0]]


def test_fig12_names_the_pairs(make: Make, program: None) -> None:
    _, rows, text = make(synthetic_zhang.fig12())
    assert rows["(a) pears"][0] == ["oranges", "10,754 / 10,754", "10,754 / 10,754", "0.25", "0.125", "0.750", "OHD",
                                    "7", "9"]
    assert rows["(b) cow, hippo"][0][3] == "timeout" and "does not hold (1 of 2 pairs differ)" in text


def test_fig12_view_keeps_the_witness_at_its_length() -> None:
    cloud = np.random.default_rng(1).normal(size=(50, 3)) * [5.0, 1.0, 2.0]
    along = np.array([0.3, -0.4, 1.2])
    plane = zhang2017_fig12.view(cloud, along)
    assert np.allclose(plane.T @ plane, np.eye(2)) and np.linalg.norm(along @ plane) == pytest.approx(1.3)


def test_as_printed_counts_wrong_answers(make: Make) -> None:
    records, rows, text = make(synthetic_zhang.as_printed())
    cells = {row[0]: row[1:] for row in rows["clouds"]}
    assert cells["OHD as printed"] == ["3", "3", "8", "1", "12.5", "2.2 to 47", "0.9000"]
    assert cells["NOHD as printed"][2:5] == ["3", "3", "100"] and cells["NOHD as printed"][-1] == "1.500"
    assert cells["OHD"][3] == "0" and cells["OHD"][-1] == "—"
    assert "OHD as printed computes the exact distance. Here it does not hold (1 of 8 answers are wrong)" in text
    assert "cells of diagonal AHD computes the exact distance. Here it holds (0 of 3 answers are wrong)" in text
    assert sum(r["status"] == "unsound" for r in records) == 4


def test_memory_grows(make: Make) -> None:
    _, rows, text = make(synthetic_zhang.memory())
    header, grown = rows["workload"][0], rows["similar"][-1]
    assert grown[0] == "grows as n^" and grown[header.index("INC")] == "1.5"
    assert grown[header.index("k-d tree (nanoflann)")] == "—"
    assert rows["similar"][0][header.index("INC")] == "2.00" and rows["similar"][0][-2:] == ["105", "1.00"]
    assert rows["similar"][0][header.index("scan (ours)")] == "crashed"
    assert "Here it holds (1M points each: INC 2000 MiB, next k-d tree (nanoflann) 8.00 MiB)" in text
