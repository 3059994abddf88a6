"""Plots of error against run time: one clock, true errors, and the cost of tracing."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import pytest
import synthetic
from stem_runner import Make, stem_runner
from synthetic import ResultFile

from analysis.shared import load, style
from analysis.shared.results import Results
from analysis.speed import error_curves, error_picture, error_vs_time

ROOT = Path(__file__).resolve().parents[2]
EXPERIMENT = ROOT / "experiments" / "speed" / "error_vs_time.toml"


@pytest.fixture()
def make(tmp_path: Path) -> Make:
    return stem_runner(tmp_path)


def read(file: ResultFile, folder: Path) -> Results:
    results = load.load(file.write(folder))
    style.introduce(results)
    return results


def traced(file: ResultFile, solver: str, prepare: float, runs: list[float], **columns: Any) -> int:
    """Adds a run to tolerance 1e-6, whose trace has gap 1 after 1 s and 0.01 after 2 of 4 s, and
    the row at 1e-2 that is read off it."""
    samples = [(1.0, 0.0, 1.0), (2.0, 0.495, 0.505), (4.0, 0.5, 0.5)]
    fine = file.case(
        solver,
        "x",
        runs,
        samples,
        tolerance=1e-6,
        lower=0.5,
        upper=0.5,
        prepare=[prepare] * len(runs),
        **columns,
    )
    file.case(
        solver,
        "x",
        (),
        tolerance=1e-2,
        lower=0.495,
        upper=0.505,
        from_trace=1,
        prepare_seconds=prepare,
        **columns,
    )
    file.cases[-1]["solve_seconds"] = 2.0
    file.answers = [row for row in file.answers if row["case"] != fine + 1]
    file.preparation = [row for row in file.preparation if row["case"] != fine + 1]
    return fine


def test_read_off_answers_are_on_the_clock_of_the_timed_runs(tmp_path: Path) -> None:
    file = ResultFile("error_vs_time", cpu=0.5)
    fine = traced(file, "kang", 0.25, [10.0, 12.0])
    results = read(file, tmp_path)
    # Tolerance 1e-2 is reached halfway: half of 5 and 6 s of CPU time, plus preparation.
    assert error_curves.total_by_round(results, fine + 1) == {0: 2.75, 1: 3.25}
    assert error_curves.total_by_round(results, fine) == {0: 5.25, 1: 6.25}
    curve = error_curves.curve_of(results, fine)
    assert curve.seconds.tolist() == [0.25 + 5.5 / 4, 0.25 + 5.5 / 2, 0.25 + 5.5]
    small = [
        answer for answer in error_curves.answers_of(results, [fine, fine + 1]) if answer.read_off
    ]
    assert [(answer.case, answer.time.value) for answer in small] == [(fine + 1, 3.0)] and small[
        0
    ].gap == pytest.approx(0.01)
    assert error_vs_time.clock(results) == (
        "Times are process CPU time, children included; preparing is wall time. "
        "Those read off a traced run are scaled to the timed runs."
    )


def test_a_row_that_repeats_a_finer_answer_is_not_read_off(tmp_path: Path) -> None:
    file = ResultFile("error_vs_time")
    for tolerance, read_off in ((1e-6, 0), (1e-2, 1)):
        file.case(
            "naive",
            "x",
            [2.0, 2.0],
            [(1.0, 0.5, 0.5)],
            lower=0.5,
            upper=0.5,
            tolerance=tolerance,
            from_trace=read_off,
        )
    results = read(file, tmp_path)
    assert error_curves.total_by_round(results, 1) == results.total_by_round(1)
    answers = error_curves.answers_of(results, [0, 1])
    assert [(answer.case, answer.read_off) for answer in answers] == [(0, False)]


def test_seeds_are_one_series_and_resolutions_one_line(tmp_path: Path) -> None:
    file = ResultFile("error_vs_time")
    for seed, seconds in ((1, 1.0), (2, 3.0), (3, 2.0)):
        file.case(
            "earlybreak",
            "x",
            [seconds] * 2,
            [(seconds, 0.25 * seed, np.inf), (2 * seconds, 0.5, 0.5)],
            variant=f"seed={seed}",
            lower=0.5,
            upper=0.5,
        )
    for step in (0.5, 0.25):
        file.case(
            "sampling", "x", [1.0 / step], variant=f"step={step}", lower=0.5, upper=0.5 + step
        )
    file.case("nohd", "x", [1.0], variant="depth=4", lower=0.5, upper=0.5)
    results = read(file, tmp_path)
    answers = error_curves.answers_of(results, range(len(results.cases)))
    assert [(answer.series, answer.resolution) for answer in answers] == [
        (("earlybreak", "earlybreak"), ""),
        (("sampling", "sampling"), "step=0.5"),
        (("sampling", "sampling"), "step=0.25"),
        (("nohd", "nohd(depth=4)"), ""),
    ]
    assert answers[0].time.value == pytest.approx(0.9 * 2.0)  # the median seed, in CPU time
    curves = error_curves.curves_of(results, range(len(results.cases)))
    assert {series: len(runs) for series, runs in curves.items()} == {
        ("earlybreak", "earlybreak"): 3
    }
    lines = [
        error_vs_time.line_title(results, rows)
        for rows in error_vs_time.lines(results, list(range(len(results.cases))))
    ]
    assert "EARLYBREAK, median of 3 seeds" in lines and "sampling(step=0.5)" in lines


def test_a_band_begins_where_all_seeds_have_a_value() -> None:
    first, second = (np.array([1.0, 3.0]), np.array([0.5, 0.25])), (
        np.array([2.0, 4.0]),
        np.array([1.0, 0.0]),
    )
    seconds, least, middle, most = error_curves.band([first, second])
    assert seconds.tolist() == [2.0, 3.0, 4.0]
    assert (
        least.tolist() == [0.5, 0.25, 0.0]
        and most.tolist() == [1.0, 1.0, 0.25]
        and middle.tolist() == [0.75, 0.625, 0.125]
    )


def test_errors_are_against_the_middle_of_the_reference(tmp_path: Path) -> None:
    file = ResultFile("error_vs_time")
    file.case(
        "cgal",
        "x",
        [1.0],
        lower=0.25,
        upper=1.25,
        certified=0,
        reference_lower=0.5,
        reference_upper=0.75,
        source_diagonal=2.0,
    )
    results = read(file, tmp_path)
    errors = error_curves.errors_of(results, 0)
    assert (errors.lower[0], errors.middle[0], errors.upper[0]) == (0.1875, 0.0625, 0.3125)
    assert error_curves.reference_width(results, 0) == 0.0625
    assert error_vs_time.error_cells(results, 0) == ["≤ 0.07", "0.19"]


def test_what_is_shown_reaches_a_hundredth_of_the_finest_tolerance(tmp_path: Path) -> None:
    for tolerance, least in ((1e-12, 1e-14), (1e-2, 1e-10), (0.0, error_curves.ROUNDING)):
        file = ResultFile("error_vs_time")
        file.case("cover", "x", [1.0], lower=0.5, upper=0.5, tolerance=tolerance)
        assert error_curves.least_shown(read(file, tmp_path)) == pytest.approx(least)


def test_stairs_are_of_certified_answers_alone(tmp_path: Path) -> None:
    file = ResultFile("error_vs_time", cpu=1.0)
    for solver, seconds, gap, certified in (
        ("cover", 1.0, 0.25, 1),
        ("kang", 2.0, 0.5, 1),
        ("cgal", 2.5, 0.01, 0),
        ("tang", 3.0, 0.0, 1),
        ("guthe", 4.0, 1e-12, 1),
    ):
        file.case(solver, "x", [seconds], lower=0.5, upper=0.5 + gap, certified=certified)
    results = read(file, tmp_path)
    times, gaps = error_curves.stairs(error_curves.answers_of(results, range(5)), 1e-10)
    assert times.tolist() == [1.0, 3.0, 4.0] and gaps.tolist() == [0.25, 1e-10, 1e-10]


def test_cost_of_tracing(tmp_path: Path, make: Make) -> None:
    file = ResultFile("error_vs_time", wall=1.0)
    file.case(
        "kang", "x", [1.0, 2.0], [(0.5, 0.0, 1.0), (1.25, 0.5, 0.5)], rounds=2, lower=0.5, upper=0.5
    )  # round 0 was traced
    file.case(
        "scan", "x", [0.001], [(0.002, 0.5, 0.5)], lower=0.5, upper=0.5
    )  # too short to measure
    file.case("naive", "x", [1.0], lower=0.5, upper=0.5)
    results = read(file, tmp_path)
    assert [error_curves.tracing_cost(results, case) for case in (0, 1)] == [
        0.25,
        1.0,
    ] and np.isnan(error_curves.tracing_cost(results, 2))
    _, rows, text = make(file)
    at = error_vs_time.HEADER.index("tracing, %") - 1
    assert {row[0]: row[at] for row in rows["x"]} == {
        "Kang 2018": "25",
        "scan (ours)": "—",
        "NAIVEHDD": "—",
    }
    assert (
        "Tracing a run of 10 ms and more takes 25 % longer (median of 1); the largest median of one solver is 25 % (Kang 2018)."
        in text
    )


def test_table(make: Make) -> None:
    records, rows, text = make(synthetic.error_vs_time())
    cells = {row[0]: row[1:] for row in rows["gauss overlap"]}
    assert cells["NAIVEHDD"][2:5] == ["0", "0", "0"] and cells["NAIVEHDD"][6] == "4,000,000"
    # The reference is 0.5. INC's bounds are 0.5 -+ 4 * 2e-16, so its gap is twice 8e-16.
    assert cells["INC"][2:5] == ["1.6e-15", "0", "7.8e-16"]
    assert cells["k-d tree (nanoflann)"][6:] == ["20,000", ""]
    failed = {row[0]: row[8] for row in rows["armadillo scan"]}
    assert (
        failed["Guthe 2005"] == "2 timeout"
        and failed["Kang 2018"] == "1 unsound"
        and failed["Zheng 2022"] == "1 precision floor"
    )
    assert "k-d tree (nanoflann)" not in failed and "armadillo scan: k-d tree (nanoflann)" in text
    unsound = next(r for r in records if r["status"] == "unsound")
    assert unsound["relative_gap"] == "" and unsound["n"] == "0"
    identical = [
        r
        for r in records
        if (r["scene"], r["solver"], r["tolerance"]) == ("same_mesh", "cover", "1e-08")
    ]
    assert [
        (r["relative_gap"], r["relative_lower_error"], r["relative_middle_error"])
        for r in identical
    ] == [("0.0", "0.0", "0.0")]
    assert (
        "First at the finest tolerance, by median time: cover (ours) on 3 of 6 scenes of meshes"
        in text
    )


def test_where_everything_failed(make: Make) -> None:
    file = ResultFile("error_vs_time")
    file.case("cover", "x", status="out_of_memory", reason="4 GiB")
    file.case("tang", "x", [5.0], status="timeout", lower=0.0, upper=0.125, tolerance=1e-3)
    file.case("cgal", "x", status="not_built", reason="no CGAL")
    _, rows, text = make(file)
    assert [row[1:] for row in rows["x"]] == [
        ["0.001", "4500", "0.12", "≤ 0.07", "≤ 0.07", "—", "—", "1 timeout"],
        ["—"] * 7 + ["1 out of memory"],
    ]
    assert "x: CGAL." in text


def test_where_nothing_was_run(make: Make) -> None:
    file = ResultFile("error_vs_time")
    file.case("cover", "x", status="skipped", reason="model 'x' is missing")
    _, rows, text = make(file)
    assert "x" not in rows and "x: cover (ours)." in text


def nine_scenes() -> ResultFile:
    """Three scenes per kind of shape. On the hard ones, tang fails at its finer tolerance, and
    naive at its only one."""
    file = ResultFile("error_vs_time")
    of = {
        "mesh": ("guthe", "tang", "kang", "zheng", "sacht", "cover", "cgal"),
        "points": (
            "naive",
            "earlybreak",
            "inc",
            "nohd",
            "ohd",
            "adaptive",
            "scan",
            "kdtree",
            "cgal_kdtree",
        ),
        "surface": ("interval_subdivision", "surface_enclosure", "surface_meshes"),
    }
    for kind, names in of.items():
        for place in ("easy", "typical", "hard"):
            scene = f"{place}: {kind}"
            for k, solver in enumerate(names):
                slow = 0.01 * (k + 1)
                samples = [
                    (
                        slow * (j + 1) / 6,
                        0.5 - 0.25 * 10.0**-j,
                        np.inf if solver == "earlybreak" and j < 5 else 0.5 + 0.5 * 10.0**-j,
                    )
                    for j in range(6)
                ]
                lost = place == "hard" and solver in ("tang", "naive")
                file.case(
                    solver,
                    scene,
                    [] if lost else [slow, slow * 1.25],
                    () if lost else samples,
                    tolerance=1e-5,
                    lower=np.nan if lost else samples[-1][1],
                    upper=np.nan if lost else samples[-1][2],
                    status="timeout" if lost else "ok",
                    reference_lower=0.5,
                    reference_upper=0.5,
                )
                if solver == "tang":
                    file.case(solver, scene, [slow / 2], tolerance=1e-2, lower=0.4975, upper=0.505)
            for model in file.models[-2:]:
                model["kind"] = kind
    return file


def drawn(results: Results) -> Any:
    report = error_vs_time.make(results)
    assert report.draw is not None
    return report.draw()


def test_figure_has_a_row_for_each_kind_of_shapes(tmp_path: Path) -> None:
    figure = drawn(read(nine_scenes(), tmp_path))
    assert (
        figure.get_figwidth() == style.DOUBLE_COLUMN and figure.get_figheight() <= 8.75
    )  # leaves room for a line about unchecked bounds
    assert len(figure.axes) == 18
    places = {ax.get_title(): ax.get_position() for ax in figure.axes if ax.get_title()}
    for kind in ("mesh", "points", "surface"):
        row = [places[f"{place}: {kind}"] for place in ("easy", "typical", "hard")]
        assert (
            len({round(at.y0, 6) for at in row}) == 1
            and row[0].x1 < row[1].x0 < row[1].x1 < row[2].x0
        )
    for legend, count in zip(figure.legends, (7, 9, 3), strict=True):
        looks = [(line.get_color(), line.get_marker()) for line in legend.get_lines()]
        assert len(set(looks)) == len(looks) == count
    assert [text.get_text() for text in figure.texts[:3]] == ["Meshes", "Point sets", "Surfaces"]
    lost = {}
    for ax in figure.axes:
        if ax.get_title() and ax.texts:
            lost[ax.get_title()] = sorted(text.get_text() for text in ax.texts)
    assert lost == {"hard: mesh": ["T1"], "hard: points": ["T"]}
    assert {ax.get_xlabel() for ax in figure.axes} == {"", "prepare + solve (s)"}
    plt.close(figure)


def test_many_scenes_of_one_kind_share_a_legend(tmp_path: Path) -> None:
    file = ResultFile("error_vs_time")
    for k in range(4):
        file.case("cover" if k else "kang", f"scene {k}", [1.0], lower=0.5, upper=0.5)
    figure = drawn(read(file, tmp_path))
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == ["Kang 2018", "cover (ours)"]
    plt.close(figure)


def test_figure_draws_the_error_of_the_lower_bound_while_there_is_no_upper_one(
    tmp_path: Path,
) -> None:
    results = read(nine_scenes(), tmp_path)
    figure = drawn(results)
    above = next(ax for ax in figure.axes if ax.get_title() == "easy: points")
    below = figure.axes[figure.axes.index(above) - 1]
    colour = style.look("earlybreak").colour
    steps = {}
    for ax in (above, below):
        lines = [line for line in ax.lines if line.get_color() == colour]
        steps[ax] = [line for line in lines if len(line.get_xdata()) > 2]
    assert not steps[above] and len(steps[below]) == 1  # without an upper bound there is no gap
    assert steps[below][0].get_ydata()[:5] == pytest.approx([0.25 * 10.0**-j for j in range(5)])
    plt.close(figure)


def test_figure_shows_the_front_the_tolerances_and_what_the_reference_cannot_tell(
    tmp_path: Path,
) -> None:
    file = ResultFile("error_vs_time", cpu=1.0)
    for tolerance in (1e-2, 1e-4):
        file.case(
            "cover",
            "x",
            [-np.log10(tolerance)],
            lower=0.5,
            upper=0.5 + tolerance,
            tolerance=tolerance,
            certified=1,
        )
    file.case("cgal", "x", [9.0], lower=0.5, upper=0.5, tolerance=1e-4, certified=0)
    figure = drawn(read(file, tmp_path))
    above, below = next(ax for ax in figure.axes if ax.get_title() == "x"), figure.axes[0]
    front = next(line for line in above.lines if line.get_gid() == "front")
    assert front.get_xdata().tolist() == [2.0, 4.0, 4.0] and front.get_ydata() == pytest.approx(
        [1e-2, 1e-4, 1e-4]
    )
    across = {
        float(line.get_ydata()[0]) for line in above.lines if list(line.get_xdata()) == [0, 0.022]
    }
    assert across == {1e-2, 1e-4}
    assert [text.get_text() for text in below.texts] == [
        "reference"
    ]  # half-width 5e-5; smaller errors mean nothing
    plt.close(figure)


def test_figure_draws_zeros_failures_and_no_unsound_point(tmp_path: Path) -> None:
    figure = drawn(read(synthetic.error_vs_time(), tmp_path))
    gap_of = {ax.get_title(): ax for ax in figure.axes if ax.get_title()}
    assert len(figure.axes) == 12 and set(gap_of) >= {"same mesh", "grid noise"}
    assert "less" in [label.get_text() for label in gap_of["bunny half"].get_yticklabels()]
    assert sorted(text.get_text() for text in gap_of["armadillo scan"].texts) == [
        "F",
        "M1",
        "P1",
        "T2",
        "U1",
    ]
    assert sorted(text.get_text() for text in gap_of["grid noise"].texts) == ["T", "U"]
    points = [
        line
        for line in gap_of["grid noise"].lines
        if line.get_marker() not in ("None", "", None) and line.get_clip_on()
    ]
    assert len(points) == 7  # nine series minus a timeout and an unsound row
    plt.close(figure)


def test_a_sweep_has_a_name_for_each_of_its_solvers(make: Make) -> None:
    file = ResultFile("error_vs_time")
    for samples in (4, 8):
        file.case(
            "sampling",
            "x",
            [1.0, 1.1],
            lower=0.5,
            upper=0.75,
            variant=f"samples={samples}",
            options={"samples": samples},
        )
    file.case("guthe", "x", [1.0], lower=0.6, upper=0.7)
    _, rows, _ = make(file)
    titles = {cell for cells in rows["x"] for cell in cells}
    assert {"sampling(samples=4)", "sampling(samples=8)"} <= titles


def test_notes_are_short(make: Make) -> None:
    _, _, text = make(nine_scenes())
    notes = [line for line in text.splitlines() if line.startswith("- ") and "Claim:" not in line]
    assert sum(len(re.findall(r"\S+", line)) for line in notes) < 120


@pytest.mark.parametrize("profile", ["quick", "paper"])
def test_experiment_has_nine_scenes_and_every_solver(profile: str) -> None:
    experiment = tomllib.loads(EXPERIMENT.read_text(encoding="utf-8"))

    def of_profile(kind: str) -> list[dict[str, Any]]:
        return [table for table in experiment[kind] if profile in table.get("profiles", [profile])]

    scenes, solvers = of_profile("scene"), of_profile("solver")
    names = [scene["name"] for scene in scenes]
    assert [name.partition(":")[0] for name in names] == ["easy", "typical", "hard"] * 3 and len(
        set(names)
    ) == 9
    assert all(
        set(solver["scenes"]) in (set(names[:3]), set(names[3:6]), set(names[6:]))
        for solver in solvers
    )
    assert {solver["name"] for solver in solvers} == set(style.LOOKS) - {"external"}
    assert (experiment | experiment["profile"].get(profile, {}))["rounds"] >= (
        6 if profile == "paper" else 2
    ) and experiment["trace"]
    # Solvers with a resolution are drawn as one line, at a tolerance that all resolutions reach, so
    # that all rounds are timed.
    assert {solver["name"] for solver in solvers if "tolerances" in solver} == set(
        error_curves.RESOLUTION
    )


def test_domains(tmp_path: Path) -> None:
    results = read(nine_scenes(), tmp_path)
    panels = [(scene, 0) for scene in results.scenes]
    assert [(domain, len(band)) for domain, band in error_picture.bands_of(results, panels)] == [
        ("Meshes", 3),
        ("Point sets", 3),
        ("Surfaces", 3),
    ]
    # A fourth scene starts a new row.
    assert [
        len(band)
        for _, band in error_picture.bands_of(results, [*panels[:3], panels[0], panels[3]])
    ] == [3, 1, 1]


def test_only_certified_solvers_are_first(make: Make) -> None:
    file = nine_scenes()
    for case in file.cases:
        if case["solver"] in ("guthe", "naive"):
            case["certified"] = 0
    _, _, text = make(file)
    assert (
        "by median time: Tang 2009 on 2 of 3 scenes of meshes; Kang 2018 on 1 of 3 scenes of meshes; EARLYBREAK on 3 of 3 scenes of point sets"
        in text
    )


def test_a_resolution_that_is_too_low_is_no_failure(tmp_path: Path) -> None:
    file = ResultFile("error_vs_time")
    file.case(
        "sampling",
        "x",
        [1.0],
        variant="step=0.5",
        lower=0.5,
        upper=0.75,
        status="budget",
        tolerance=1e-3,
    )
    file.case("guthe", "x", [1.0], lower=0.5, upper=0.75, status="budget", tolerance=1e-3)
    file.case("surface_meshes", "x", variant="cells=8", status="timeout", tolerance=1e-3)
    lost = error_picture.lost_of(read(file, tmp_path), [0, 1, 2])
    assert lost == [
        (("guthe", "guthe"), "budget", ""),
        (("surface_meshes", "surface_meshes"), "timeout", ""),
    ]
