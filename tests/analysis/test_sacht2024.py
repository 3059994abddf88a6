"""Figures and tables of Sacht and Jacobson 2024, on files with known numbers; verdicts in each of
their outcomes."""

from __future__ import annotations

import importlib
import math
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pytest
import synthetic_sacht
from matplotlib.colors import to_rgb
from stem_runner import TETRAHEDRON, Make, stem_runner
from synthetic import ResultFile
from synthetic_sacht import TIE, Ratio, Tie, size_of

from analysis.__main__ import main
from analysis.sacht2024 import sacht2024_fig1, sacht2024_fig11, sacht_limits
from analysis.sacht2024.sacht_pairs import named
from analysis.shared import mesh_picture
from analysis.shared.shapes import Mesh
from analysis.shared.estimates import exact
from analysis.shared.stems import module_of


@pytest.fixture()
def make(tmp_path: Path) -> Make:
    return stem_runner(tmp_path)


def claim(text: str, part: str) -> str:
    """Returns the outcome of the only claim whose text contains `part`."""
    lines = [
        line
        for line in text.splitlines()
        if line.startswith("- Claim: ") and part in line.split(". Here")[0]
    ]
    assert len(lines) == 1, (part, lines)
    return lines[0].split(". Here", 1)[1]


WAYS: list[tuple[Ratio, str, str]] = [
    (2.0, " it holds (", "distances it holds (above"),
    (0.5, " it does not hold (", "distances it does not hold ("),
    (TIE, ": not separated (", "distances it is not separated ("),
]


@pytest.mark.parametrize("kang,outcome,counted", WAYS)
def test_table2_compares_the_pairs_near_zero(
    make: Make, kang: Ratio, outcome: str, counted: str
) -> None:
    """Zheng over Kang equals Kang over Sacht, because zheng takes kang's factor squared."""
    zheng: Ratio = TIE if isinstance(kang, Tie) else kang * kang
    _, _, text = make(synthetic_sacht.table2(kang=kang, zheng=zheng))
    line = claim(text, "near zero, Sacht takes less time than Kang")
    assert line.startswith(outcome) and counted in line
    assert claim(text, "near zero, Sacht takes less time than Zheng").startswith(outcome)
    if not isinstance(kang, Tie):
        assert claim(text, "near zero, Kang takes less time than Zheng").startswith(outcome)


def test_table2_cells(make: Make) -> None:
    records, rows, text = make(synthetic_sacht.table2())
    header, crown = rows["pair"][0], rows["elephant (for Crown)"][0]
    assert crown[:3] == ["here", "5,000 / 9,000", "0.400"]
    assert crown[header.index("Sacht 2024")] == "12.5 [10.0, 15.0]"  # six rounds of 10 to 15 ms
    assert crown[header.index("Zheng 2022 / Sacht 2024")] == "3.00 [3.00, 3.00]" and crown[
        header.index("CGAL / Sacht 2024")
    ].startswith("8.00")
    distances, work, paper = rows[""][:3]
    assert (
        distances[header.index("Kang 2018")] == "2,000"
        and work[header.index("Zheng 2022")] == "18,000"
    )
    assert (
        work[header.index("Zheng 2022 / Kang 2018")] == "1.50" and work[header.index("CGAL")] == "—"
    )
    assert paper[:2] == ["paper", "19,826 / 178,802"] and paper[header.index("Sacht 2024")] == "410"
    assert paper[header.index("Zheng 2022 / Sacht 2024")] == "2.24"
    assert "hand, noisy" in rows and "paper" not in [cells[0] for cells in rows["hand, noisy"]]
    # The derived pairs are judged separately, and not by the paper's table.
    assert claim(text, "nearer than 0.1 %, Kang takes less time than Zheng on average").startswith(
        " it holds (geometric mean 1.50"
    )
    assert "nearer than 0.1 %, Sacht" not in text
    assert "crown: stands in for crown." in text and "Test CPU" in text and "MacBook Air M2" in text
    record = next(r for r in records if (r["scene"], r["label"]) == ("crown", "kang"))
    assert (
        float(record["paper_seconds"]) == 0.554 and float(record["distance_of_diagonal"]) == 0.004
    )


@pytest.mark.parametrize(
    "tang,outcome,quoted",
    [
        (None, ": not tested (", ": not tested ("),
        (6.0, " it holds (", " it does not hold ("),
        (30.0, " it holds (", " it holds ("),
        (1.5, " it does not hold (", " it does not hold ("),
        (TIE, " it does not hold (", " it does not hold ("),
    ],
)
def test_table2_waits_for_tang(make: Make, tang: Ratio | None, outcome: str, quoted: str) -> None:
    """zheng takes 3 times the base time, so Tang over Zheng is a third of `tang`."""
    _, rows, text = make(synthetic_sacht.table2(tang=tang))
    assert claim(text, "Zheng takes less time than Tang on average").startswith(outcome)
    assert claim(text, "Zheng is 4.38 times as fast as Tang on average").startswith(quoted)
    assert ("Tang 2009" in rows["pair"][0]) == (tang is not None)


@pytest.mark.parametrize(
    "tang,outcome",
    [
        (None, ": not tested ("),
        (6.0, " it holds ("),
        (0.5, " it does not hold ("),
        (TIE, ": not separated ("),
    ],
)
def test_table2_compares_sacht_with_tang(make: Make, tang: Ratio | None, outcome: str) -> None:
    """Tang over Sacht is `tang`, also on the derived pairs, because kang takes as long as sacht."""
    assert claim(
        make(synthetic_sacht.table2(kang=1.0, tang=tang))[2],
        "Sacht takes less time than Tang on average",
    ).startswith(outcome)


@pytest.mark.parametrize(
    "sacht,kang,outcome",
    [(1.0, 3.0, " it holds ("), (8.0, 1.0, " it does not hold ("), (2.0, 2.0, ": not separated (")],
)
def test_table3_compares_the_pairs_far_apart(
    make: Make, sacht: float, kang: float, outcome: str
) -> None:
    _, _, text = make(synthetic_sacht.table3(sacht=sacht, kang=kang))
    assert claim(text, "far apart, Zheng takes less time than Kang").startswith(outcome)
    line = claim(text, "Sacht is faster than Kang and Zheng in most cases")
    assert line.startswith(outcome) and "of 4 pairs" in line


@pytest.mark.parametrize(
    "lost,outcome",
    [
        (4.0, " it holds (ratio 2.00 [2.00, 2.00])"),
        (1.0, " it does not hold (ratio 0.500"),
        (2.0, ": not separated (ratio 1.00"),
    ],
)
def test_table3_looks_at_the_pair_that_the_paper_lost(
    make: Make, lost: float, outcome: str
) -> None:
    _, rows, text = make(synthetic_sacht.table3(lost=lost))
    line = claim(text, "on (Ramesses, Bust), Zheng takes less time than Sacht")
    assert (
        line.startswith(outcome)
        and f"Counted in distances it {'is ' if lost == 2.0 else ''}{outcome.strip(' :it').split(' (')[0]}"
        in line
    )
    assert rows[""][2][rows["pair"][0].index("Kang 2018")] == "227"


@pytest.mark.parametrize("kang,outcome,counted", WAYS)
def test_fig13_compares_at_each_tolerance(
    make: Make, kang: Ratio, outcome: str, counted: str
) -> None:
    _, rows, text = make(synthetic_sacht.fig13(kang=kang))
    line = claim(text, "than Kang 2018")
    assert line.startswith(outcome) and counted in line and "of 3 tolerances" in line
    assert (
        rows["Sacht 2024"][0][0] == "12.5 [10.0, 15.0]"
        and rows["Sacht 2024"][0][1] == "—"
        and rows["Sacht 2024"][0][7] == "100 [80.0, 120]"
    )
    assert rows["CGAL"][0] == [*7 * ["—"], "3 of 4", "—"] and "CGAL: bust timeout (1e-8)." in text
    assert "CPU time in ms" in text and "Each tolerance is requested separately." in text


@pytest.mark.parametrize(
    "ratio,stopped,outcome",
    [
        (2000.0, 0.0, " it holds (ratio 2000"),
        (200.0, 0.0, " it does not hold (ratio 200"),
        (Tie(1000.0), 0.0, ": not separated (ratio 1000"),
        # The ratio's bound uses the upper end of sacht's interval, 15 ms.
        (2000.0, 30.0, " it holds (ratio above 2000, because the slower was stopped"),
        (20.0, 3.0, ": not separated (ratio above 200, because the slower was stopped"),
    ],
)
def test_fig14_knows_of_stopped_solvers(
    make: Make, ratio: Ratio, stopped: float, outcome: str
) -> None:
    records, rows, text = make(synthetic_sacht.fig14(thousands=ratio, stopped=stopped))
    line = claim(text, "thousands of times")
    assert line.startswith(outcome) and "against 1,000" in line
    cells = rows["square, cut the other way"][0]
    assert cells[3] == (f"> {stopped * 1000:.0f}" if stopped else cells[3]) and cells[5].startswith(
        "> " if stopped else f"{size_of(ratio):.0f}"
    )
    record = next(r for r in records if r["scene"] == "square, cut the other way")
    assert float(record["ratio_at_least"]) == pytest.approx(stopped / 0.015)


@pytest.mark.parametrize(
    "ratio,fast,outcome,short",
    [
        (1 / 30, 0.01, " it holds (ratio 30.0", " it does not hold ("),
        (1 / 10, 0.0001, " it does not hold (ratio 10.0", " it holds ("),
        (Tie(1 / 20), 0.01, ": not separated (ratio 20.0", " it does not hold ("),
        (2.0, 0.01, " it does not hold (", ": not tested (no pairs on which it is slower"),
    ],
)
def test_fig14_where_sacht_is_slower(
    make: Make, ratio: Ratio, fast: float, outcome: str, short: str
) -> None:
    _, _, text = make(synthetic_sacht.fig14(twentieth=ratio, fast=fast))
    assert claim(text, "Zheng is 20 times as fast").startswith(outcome)
    assert claim(text, "less than a millisecond").startswith(short)


@pytest.mark.parametrize(
    "seconds,outcome",
    [(500.0, " it holds ("), (0.1, " it does not hold ("), (144.0, ": not separated (")],
)
def test_fig15_against_three_minutes(make: Make, seconds: float, outcome: str) -> None:
    _, rows, text = make(synthetic_sacht.fig15(seconds=seconds))
    assert claim(text, "Sacht takes more than three minutes").startswith(outcome)
    paper = rows["paper"]
    assert paper[0][1:4] == ["1e-06", "8.7054e-08", "1.08705e-06"] and paper[1][4] == "> 180000"


@pytest.mark.parametrize("fine,outcome,counted", WAYS)
def test_fig15_at_two_tolerances(make: Make, fine: Ratio, outcome: str, counted: str) -> None:
    _, rows, text = make(synthetic_sacht.fig15(fine=fine))
    line = claim(text, "more time at 1e-8 than at 1e-6")
    assert (
        line.startswith(outcome) and counted.removesuffix("above") in line and "against" not in line
    )
    titles = [cells[0] for cells in rows["fandisk"]]
    assert titles == ["Kang 2018"] * 2 + ["Zheng 2022"] * 2 + ["Sacht 2024"] * 2 + ["CGAL"]
    assert (
        rows["fandisk"][2][4] == "> 1500"
        and rows["fandisk"][6][4] == "timeout"
        and rows["fandisk"][4][6] == "77"
    )


@pytest.mark.parametrize(
    "stopped,outcome",
    [
        (1.5, ": not separated (ratio above 0.00833, because the slower was stopped"),
        (540.0, " it holds (ratio above 3.00, because the slower was stopped"),
    ],
)
def test_fig15_of_a_solver_that_was_stopped(make: Make, stopped: float, outcome: str) -> None:
    _, _, text = make(synthetic_sacht.fig15(stopped=stopped))
    assert claim(text, "Zheng takes more than three minutes").startswith(outcome)


def test_a_ratio_to_a_stopped_solver_is_known_from_one_side() -> None:
    ended = sacht_limits.Row("ok", {0: 1.0}, 0.0, {"work": 10.0})
    stopped = sacht_limits.Row("timeout", {}, 3.0, {"work": 50.0})
    killed = sacht_limits.Row("timeout", {}, 0.0, {"work": 0.0})
    assert sacht_limits.time_ratio(stopped, ended).at_least == 3.0 and sacht_limits.time_ratio(
        ended, stopped
    ).at_most == pytest.approx(1 / 3)
    assert (
        sacht_limits.work_ratio(stopped, ended, "work").at_least == 5.0
        and sacht_limits.work_ratio(ended, stopped, "work").at_most == 0.2
    )
    assert sacht_limits.work_ratio(ended, ended, "work").estimate == exact(1.0)
    for pair in ((stopped, stopped), (killed, ended), (None, ended)):
        assert (
            sacht_limits.time_ratio(*pair).text() == "—"
            and sacht_limits.above("x", sacht_limits.time_ratio(*pair), 2).outcome == "not tested"
        )
    below = sacht_limits.time_ratio(ended, stopped)
    assert below.text() == "< 0.334" and [
        sacht_limits.above("x", below, times).outcome for times in (0.2, 0.5)
    ] == ["not separated", "does not hold"]


@pytest.mark.parametrize(
    "wrong,cell",
    [
        ({}, "ends, gap 1.0e-9"),
        ({"upper": 0.25 + 2e-8}, "gap above the tolerance"),
        ({"status": "unsound"}, "unsound"),
        ({"lower_check": "unsound"}, "unsound"),
        ({"upper": 0.24}, "lower above upper"),
        ({"exact": 0.3}, "misses h"),
        ({"upper": math.nan, "status": "signal"}, "no bounds (crashed)"),
    ],
)
def test_section52_finds_each_failure(make: Make, wrong: dict[str, object], cell: str) -> None:
    _, rows, text = make(synthetic_sacht.section52(**wrong))
    header, cells = rows["scene"][0], rows["unreferenced vertex"][0]
    assert (
        cells[header.index("Sacht 2024")] == cell
        and cells[header.index("Zheng 2022")] == "precision floor, gap 1.0e-7"
    )
    assert cells[header.index("CGAL")] == "no bounds (timeout)" and cells[0].startswith(
        "the vertex counts towards l"
    )
    # cgal is not certified, so its row does not count.
    outcome = (
        " it holds (so for 2 of 2 rows)" if not wrong else " it does not hold (so for 1 of 2 rows)"
    )
    assert claim(text, "unreferenced vertex: the bounds").startswith(outcome)
    assert (
        claim(text, "Sacht ends at 1e-5 and not at 1e-8")
        == " it holds (1e-05: ok, 1e-08: budget spent)."
    )
    for part, rows_of_sacht in (("Sacht's bounds hold", 3), ("that no triangle uses, Sacht", 1)):
        assert claim(text, part).startswith(
            f" it holds (so for {rows_of_sacht} of {rows_of_sacht} rows)"
            if not wrong
            else f" it does not hold (so for {rows_of_sacht - 1} of {rows_of_sacht} rows)"
        )


def test_section52_without_rows_of_sacht(make: Make) -> None:
    file = ResultFile("sacht2024_section52")
    file.case(
        "kang", "unreferenced vertex", [0.1], tolerance=1e-8, lower=0.25, upper=0.25, exact=0.25
    )
    _, _, text = make(file)
    assert claim(text, "Sacht's bounds hold").startswith(": not tested") and claim(
        text, "that no triangle uses, Sacht"
    ).startswith(": not tested")


@pytest.mark.parametrize(
    "kept,outcome",
    [
        ((), ": not tested (no such rows)"),
        (("ok", "ok"), " it does not hold (1e-05: ok, 1e-08: ok)"),
    ],
)
def test_section52_looks_at_the_budget(make: Make, kept: tuple[str, ...], outcome: str) -> None:
    file = ResultFile("sacht2024_section52")
    file.case("kang", "too many pieces", [0.1], tolerance=1e-8, lower=0.0, upper=0.0)
    for t, status in zip((1e-5, 1e-8), kept):
        file.case(
            "sacht",
            "too many pieces",
            [0.1],
            label="few",
            tolerance=t,
            lower=0.0,
            upper=0.0,
            status=status,
        )
    _, _, text = make(file)
    assert claim(text, "Sacht ends at 1e-5 and not at 1e-8").startswith(outcome)


def test_table1_puts_the_numbers_beside_the_papers(make: Make, tetrahedra: None) -> None:
    records, rows, text = make(synthetic_sacht.table1())
    header = rows["pair"][0]
    crown = dict(zip(header, rows["elephant (for Crown)"][0]))
    assert (
        crown["A is"] == "closed"
        and crown["paper: \\|A\\|"] == "19,826"
        and crown["h(A, B), %"] == "0.400"
        and crown["H(A, B), %"] == "0.500"
    )
    assert (
        rows["hand, noisy"][0][header.index("paper: \\|B\\|")] == "—"
        and "crown: stands in." in text
    )
    assert next(r for r in records if r["scene"] == "bust")["paper_source_elements"] == "510712"


def test_table1_without_the_models(
    make: Make, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("HAUSBENCH_CACHE", str(tmp_path / "not there"))
    _, rows, _ = make(synthetic_sacht.table1())
    assert rows["elephant (for Crown)"][0][2:4] == ["—", "—"]


def test_a_mesh_is_closed_or_open_and_a_manifold_or_not() -> None:
    assert TETRAHEDRON.closed and TETRAHEDRON.manifold
    opened = Mesh(TETRAHEDRON.corners, TETRAHEDRON.triangles[:3])
    assert not opened.closed and opened.manifold
    fin = Mesh(
        np.vstack([TETRAHEDRON.corners, [[1, 1, 1]]]),
        np.vstack([TETRAHEDRON.triangles, [[0, 1, 4]]]),
    )
    assert not fin.closed and not fin.manifold
    # As in STL, each triangle has its own corners; by position it is the same mesh.
    soup = Mesh(
        TETRAHEDRON.corners[TETRAHEDRON.triangles].reshape(-1, 3), np.arange(12).reshape(4, 3)
    )
    assert soup.closed and soup.manifold


@pytest.mark.parametrize(
    "last,used,least",
    [
        ((0, 1, 2, 2, 3, 3, 4, 4), "it holds (so for 5 of 5", "it holds (so for 3 of 3"),
        ((0, 2, 2, 3, 3, 4, 4), "it does not hold (so for 4 of 5", "it holds (so for 3 of 3"),
        ((0, 0, 1, 2, 3, 3, 3, 4), "it holds (so for 5 of 5", "it does not hold (so for 1 of 3"),
    ],
)
def test_fig11_counts_the_last_bounds(last: tuple[int, ...], used: str, least: str) -> None:
    shown = sacht2024_fig11.Shown("wuson", 0, np.array(last), np.empty(0))
    lines = [verdict.line() for verdict in sacht2024_fig11.verdicts([shown])]
    assert used in lines[0] and least in lines[1]


@pytest.mark.parametrize(
    "last,outcome",
    [
        ((0, 1, 2, 2, 3, 3, 4), "it holds (so for 2 of 2"),
        ((0, 1, 2, 3, 3, 4), "it does not hold (so for 1 of 2"),
        ((4, 4, 2, 3), "it does not hold (so for 0 of 2"),
    ],
)
def test_fig11_looks_at_u2_and_u3(last: tuple[int, ...], outcome: str) -> None:
    assert (
        outcome
        in sacht2024_fig11.verdicts(
            [sacht2024_fig11.Shown("wuson", 0, np.array(last), np.empty(0))]
        )[2].line()
    )


@pytest.mark.parametrize(
    "height,away,last,outcome",
    [
        (0.05, 0.2, (4,), "holds"),
        (0.05, 0.2, (3,), "does not hold"),
        (0.05, 0.2, (3, 4), "not separated"),
        (0.2, 0.9, (4,), "not tested"),
        (0.05, 0.05, (3,), "not tested"),  # nearer to B than its height, so it does not disappear
        (0.05, math.nan, (4,), "not tested"),
    ],
)
def test_fig11_looks_at_thin_triangles_that_disappear(
    height: float, away: float, last: tuple[int, ...], outcome: str
) -> None:
    shape = Mesh(
        np.array([[0.0, 0, 0], [2, 0, 0], [1, 2 * height, 0]]), np.array([[0, 1, 2]] * len(last))
    )
    far = np.array([1.0, 1.0, away]) if math.isfinite(away) else np.empty(0)
    assert (
        sacht2024_fig11.thin(sacht2024_fig11.Shown("x", 0, np.array(last), far), shape).outcome
        == outcome
    )


def test_fig11_colours_differ_in_grey_also_where_they_are_shaded() -> None:
    grey = sorted(
        float(np.dot(to_rgb(colour), (0.299, 0.587, 0.114))) for colour in sacht2024_fig11.COLOURS
    )
    assert all(
        (1 - sacht2024_fig11.SHADE) * lighter > darker + 0.03
        for darker, lighter in zip(grey, grey[1:])
    )


def test_stand_ins_are_named() -> None:
    assert (
        named("crown") == "elephant (for Crown)"
        and named("ramesses_bust", "\n") == "dragon, Snowden\n(for Ramesses, Bust)"
    )
    assert named("hand, noisy") == "hand, noisy"


def test_fig11_prints_shares(make: Make, tetrahedra: None) -> None:
    records, rows, text = make(
        synthetic_sacht.with_fields("sacht2024_fig11", ["wuson"], last=(0, 3, 3, 4))
    )
    assert (
        rows["wuson"][0] == ["4 / 4", "17.5", "5", "25.0", "0", "0", "50.0", "25.0"]
        and "a tetrahedron" in text
    )
    assert [r["triangles"] for r in records] == ["1", "0", "0", "2", "1"]


def test_fig1_and_fig12_print_the_distances(make: Make, tetrahedra: None) -> None:
    _, rows, _ = make(synthetic_sacht.with_fields("sacht2024_fig1", ["fandisk, remeshed"]))
    assert rows["fandisk, remeshed"][0] == ["4 / 4", "17.4999", "17.5000", "15.0", "< 0.09"]
    _, rows, _ = make(synthetic_sacht.with_fields("sacht2024_fig12", ["crown", "bust"]))
    assert rows["bust"][0] == ["bust A", "bust B", "4", "4", "17.5", "15.0"]


@pytest.mark.parametrize("stem", ["sacht2024_fig1", "sacht2024_fig11", "sacht2024_fig12"])
def test_pictures_need_fields(
    stem: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = ResultFile(stem)
    file.case("sacht", "x", [0.1], lower=0.5, upper=0.5)
    file.write(tmp_path)
    module = {"sacht2024_fig1": sacht2024_fig1, "sacht2024_fig11": sacht2024_fig11}.get(
        stem
    ) or importlib.import_module(module_of(stem))
    assert main([stem, "--results", str(tmp_path), "--out", str(tmp_path)]) == 2
    error = capsys.readouterr().err
    assert f"make {stem}" in error and len(error.splitlines()) == 1


def test_a_section_is_where_triangles_meet_the_plane() -> None:
    (first, second, third) = sacht2024_fig1.section(TETRAHEDRON.corners, TETRAHEDRON, 0.25)
    ends = {tuple(np.round(end, 12)) for piece in (first, second, third) for end in piece}
    assert ends == {(0.0, 0.0), (0.75, 0.0), (0.0, 0.75)}
    assert sacht2024_fig1.section(TETRAHEDRON.corners, TETRAHEDRON, 2.0) == []


def test_a_view_can_be_turned_to_show_a_line_in_full() -> None:
    eye = mesh_picture.view((1, 0.5, 1))
    for direction in (np.array([0.3, -2.0, 0.1]), eye.axes[2]):
        turned = mesh_picture.across(eye, direction)
        assert turned.axes @ turned.axes.T == pytest.approx(np.eye(3), abs=1e-12)
        assert turned.seen(direction) == pytest.approx([np.linalg.norm(direction), 0, 0], abs=1e-12)
    assert mesh_picture.across(eye, np.zeros(3)) is eye


def test_only_what_faces_the_eye_is_drawn() -> None:
    for both, count in ((False, 1), (True, 4)):
        figure, ax = plt.subplots()
        mesh_picture.draw(ax, TETRAHEDRON, mesh_picture.view((1, 1, 1)), both_sides=both)
        assert len(ax.collections[0].get_paths()) == count
        plt.close(figure)
