"""The three scripts of the stability suite, which read one result file: every outcome of a row, the
cells and the claims."""

from __future__ import annotations

import math
import warnings
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import pytest
from stem_runner import Make, stem_runner
from synthetic import NAN, ResultFile
from synthetic_stability import (
    BUDGET,
    FLOOR,
    GOOD,
    HUNG,
    MESHES,
    TIMEOUT,
    U,
    WRONG,
    Sweeps,
    killed,
    small,
    write_shapes,
)

from analysis.__main__ import main
from analysis.shared import style
from analysis.shared.load import load
from analysis.shared.results import Interval
from analysis.shared.stems import drawn_with, results_of
from analysis.stability import stability_error, stability_picture, stability_time
from analysis.stability.stability_families import Suite, range_text, severity_text
from analysis.stability.stability_outcomes import STOPS, Ending, Judge, Outcome, judge
from analysis.stability.stability_panels import choose

KNOWN = Interval(np.nextafter(0.5, 0), np.nextafter(0.5, 1))
BOUNDS = {
    "lower": 0.5,
    "upper": 0.5,
    "truth": KNOWN,
    "tolerance": 0.1,
    "solver_status": "converged",
}
WIDE = BOUNDS | {"lower": 0.25, "upper": 0.75}
STALLED = {"status": "failed", "reason": "could not go on", "solver_status": "stalled"}


@pytest.fixture()
def make(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Make:
    monkeypatch.setenv("HAUSBENCH_CACHE", str(tmp_path))
    return stem_runner(tmp_path)


def written(
    sweeps: Sweeps, folder: Path, monkeypatch: pytest.MonkeyPatch, shapes: bool = True
) -> Suite:
    monkeypatch.setenv("HAUSBENCH_CACHE", str(folder))
    path = sweeps.file.write(folder)
    if shapes:
        write_shapes(sweeps.file, folder, sweeps.largest)
    return Suite(load(path))


@pytest.mark.parametrize(
    ("columns", "outcome"),
    [
        (BOUNDS, Outcome.TIGHT),
        (BOUNDS | {"upper": 0.6}, Outcome.TIGHT),
        (
            BOUNDS | {"status": "floor"},
            Outcome.TIGHT,
        ),  # the bounds are within the tolerance, whatever the solver reports
        (
            BOUNDS | {"status": "timeout"},
            Outcome.TIGHT,
        ),  # it answered, and was stopped during the timed repeats
        (
            BOUNDS | {"lower": KNOWN.upper, "upper": KNOWN.upper},
            Outcome.TIGHT,
        ),  # one ulp is allowed
        (BOUNDS | {"lower": np.nextafter(KNOWN.upper, 1), "upper": 0.6}, Outcome.WRONG),
        (BOUNDS | {"lower": 0.45, "upper": np.nextafter(KNOWN.lower, 0)}, Outcome.WRONG),
        (
            BOUNDS | {"lower": 0.5 + 1e-9, "upper": 0.6, "certified": False, "slack": 1e-8},
            Outcome.TIGHT,
        ),
        (
            BOUNDS | {"lower": 0.5 + 1e-7, "upper": 0.6, "certified": False, "slack": 1e-8},
            Outcome.WRONG,
        ),
        (
            BOUNDS | {"lower": 0.7, "upper": 0.75, "certified": False, "slack": math.nan},
            Outcome.TIGHT,
        ),  # without a known slack, nothing is refuted
        (
            BOUNDS | {"lower": 0.7, "upper": 0.7, "truth": Interval(math.nan, math.nan)},
            Outcome.TIGHT,
        ),  # the true distance is unknown
        (
            BOUNDS | {"lower": 0.5, "upper": 0.5 - 1e-9, "truth": Interval(0.4, 0.6)},
            Outcome.WRONG,
        ),  # the bounds cross
        (
            BOUNDS | {"lower": math.inf, "upper": math.inf, "truth": Interval(math.nan, math.nan)},
            Outcome.WRONG,
        ),
        (BOUNDS | {"status": "unsound"}, Outcome.WRONG),
        (BOUNDS | {"unsound": True}, Outcome.WRONG),
        (
            BOUNDS | {"upper": math.nan},
            Outcome.WRONG,
        ),  # reported as converged, without an upper bound
        (WIDE, Outcome.WRONG),  # certified and converged, but too wide
        (WIDE | {"certified": False}, Outcome.LOOSE),
        (WIDE | {"upper": math.inf, "certified": False}, Outcome.LOOSE),
        (WIDE | STALLED, Outcome.LOOSE),
        (WIDE | STALLED | {"lower": 0.0, "upper": math.inf}, Outcome.REFUSED),
        (WIDE | {"status": "failed", "reason": "two runs differ"}, Outcome.WRONG),
        (BOUNDS | {"status": "failed", "reason": "two runs differ"}, Outcome.WRONG),
        (WIDE | {"status": "timeout"}, Outcome.STOPPED),
        (WIDE | {"status": "budget"}, Outcome.STOPPED),
        (WIDE | {"status": "floor", "upper": math.inf}, Outcome.STOPPED),
        ({"status": "timeout", "reason": "killed"}, Outcome.HUNG),
        ({"status": "failed", "reason": "no finite coordinates"}, Outcome.REFUSED),
        ({"status": "failed"}, Outcome.CRASHED),  # gives no reason
        ({"status": "signal", "reason": "SIGSEGV"}, Outcome.CRASHED),
        (BOUNDS | {"status": "out_of_memory"}, Outcome.CRASHED),
        (
            {"status": "skipped", "reason": "solver 'guthe' takes no points as source"},
            Outcome.NOT_APPLICABLE,
        ),
        (
            {
                "status": "skipped",
                "reason": "solver 'penetration' computes the penetration depth only, not h(A,B)",
            },
            Outcome.NOT_APPLICABLE,
        ),
        ({"status": "skipped", "reason": "its origin 'hand' is missing"}, Outcome.NOT_RUN),
        ({"status": "not_built", "reason": "no CGAL"}, Outcome.NOT_RUN),
    ],
)
def test_every_outcome(columns: dict[str, Any], outcome: Outcome) -> None:
    assert judge(Ending(**columns)) == outcome


@pytest.mark.parametrize(
    ("columns", "outcome"),
    [
        ({"status": "failed", "reason": "a coordinate is not a number"}, Outcome.RIGHTLY_REFUSED),
        (BOUNDS, Outcome.WRONG),
        (WIDE | {"status": "timeout"}, Outcome.WRONG),
        (WIDE | STALLED, Outcome.WRONG),
        ({"status": "signal"}, Outcome.CRASHED),
        ({"status": "timeout"}, Outcome.HUNG),
        (
            {"status": "skipped", "reason": "solver 'scan' takes no mesh as source"},
            Outcome.NOT_APPLICABLE,
        ),
    ],
)
def test_what_is_not_legal_is_to_be_refused(columns: dict[str, Any], outcome: Outcome) -> None:
    assert judge(Ending(**columns, legal=False)) == outcome


def test_outcomes_are_told_apart_in_grey() -> None:
    """Any two colours differ by more than 7 of 100 in CIE lightness. Bad outcomes are dark and have
    letters."""

    def light(outcome: Outcome) -> float:
        parts = [int(outcome.colour[i : i + 2], 16) / 255 for i in (1, 3, 5)]
        red, green, blue = (
            x / 12.92 if x <= 0.04045 else ((x + 0.055) / 1.055) ** 2.4 for x in parts
        )
        return 116 * float(np.cbrt(0.2126 * red + 0.7152 * green + 0.0722 * blue)) - 16

    letters = [outcome.letter for outcome in Outcome if outcome.letter]
    letters += [letter for letter, _ in STOPS.values()]
    assert (
        len({letter.lower() for letter in letters}) == len(letters) - 1
    )  # only R (refused) and r (rightly refused) share a letter
    for status, (letter, _) in STOPS.items():
        assert letter == style.STATUS_LETTERS[status]
    by_colour = {outcome.colour: outcome for outcome in Outcome}
    shades = sorted(light(outcome) for outcome in by_colour.values())
    assert all(above - below > 7 for below, above in zip(shades, shades[1:]))
    assert all(
        light(outcome) < 50 and outcome.letter
        for outcome in (Outcome.WRONG, Outcome.CRASHED, Outcome.HUNG)
    )
    badness = [outcome.badness for outcome in Outcome]
    assert badness == sorted(badness)


def test_the_letter_of_a_stop_says_at_what(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    sweeps = Sweeps()
    stops = {"timeout": TIMEOUT, "budget": BUDGET, "floor": FLOOR}
    sweeps.family("offset", "mesh", [1.0, 2.0, 3.0], {"guthe": list(stops.values())})
    suite = written(sweeps, tmp_path, monkeypatch)
    family = suite.families[0]
    marks = [family.mark("guthe", step, family.tolerances[0]) for step in family.steps]
    assert marks == [(Outcome.STOPPED, letter) for letter in "TBP"]
    figure = stability_picture.draw(suite)["meshes"]
    entries = [text.get_text() for text in figure.legends[0].get_texts()]
    stopped = [text for text in entries if "stopped" in text]
    assert [f"{letter}  {words}" for letter, words in STOPS.values()] == stopped
    plt.close(figure)


def test_largest_coordinates_decide_what_can_be_met(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    sweeps = small()
    turned = sweeps.file.cases[0]  # A is moved by 7, so the largest coordinate is at most 8
    turned["pose"] = [0.0, 1, 0, -1, 0, 0, 0, 0, 1, 0, 0, 7]
    suite = written(sweeps, tmp_path, monkeypatch)
    suite_judge = Judge(suite.results)
    assert suite_judge.magnitude(0) == 8.0
    last = next(
        answer for answer in suite.answers if answer.severity == 1e12 and answer.label == "naive"
    )
    assert suite_judge.magnitude(last.row) == 1e12 and last.can_be_met is False
    at_the_bound = 40 * U * 8
    for tolerance, met in ((at_the_bound, True), (np.nextafter(at_the_bound, 0), False)):
        suite.results.cases.tolerance_absolute[0] = tolerance
        assert suite_judge.can_be_met(0) is met
    surface = next(
        answer
        for answer in suite.answers
        if answer.label == "surface_enclosure" and answer.outcome == Outcome.CRASHED
    )
    assert suite_judge.magnitude(surface.row) == 1.0


@pytest.mark.parametrize(
    ("off", "certified", "peer"),
    [
        (1e-16, Outcome.TIGHT, Outcome.TIGHT),
        (4e-15, Outcome.WRONG, Outcome.TIGHT),
        (2e-14, Outcome.WRONG, Outcome.WRONG),
    ],
)
def test_certified_rows_get_no_slack(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, off: float, certified: Outcome, peer: Outcome
) -> None:
    """Uncertified rows get a slack of 84 u M = 9.3e-15, where u = 2^-53 and M = 1 is the largest
    coordinate."""
    sweeps = Sweeps()
    sweeps.family(
        "offset",
        "mesh",
        [10.0],
        {label: [{"lower": 0.5 + off, "upper": 0.5 + off}] for label in ("guthe", "cgal")},
    )
    suite = written(sweeps, tmp_path, monkeypatch)
    outcomes = {answer.label: answer.outcome for answer in suite.answers}
    assert (outcomes["guthe"], outcomes["cgal"]) == (certified, peer)


def test_certified_rows_that_contradict_each_other_are_wrong(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Without a stated distance, either of two contradicting rows may be wrong: both count as
    wrong, but an interval that contains both does not."""
    sweeps = Sweeps()
    answers = {"guthe": (0.5, 0.5), "cover": (0.75, 0.75), "sampling": (0.25, 1.0)}
    sweeps.family(
        "offset",
        "mesh",
        [10.0],
        {
            label: [
                {
                    "lower": low,
                    "upper": high,
                    "exact": np.nan,
                    "status": "ok" if low == high else "budget",
                }
            ]
            for label, (low, high) in answers.items()
        },
    )
    suite = written(sweeps, tmp_path, monkeypatch)
    outcomes = {answer.label: answer.outcome for answer in suite.answers}
    assert [outcomes[label] for label in answers] == [Outcome.WRONG, Outcome.WRONG, Outcome.STOPPED]


def test_what_is_not_legal_is_no_answer_of_solvers_that_take_no_such_shapes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    sweeps = small()
    suite = written(sweeps, tmp_path, monkeypatch)
    illegal = [answer for answer in suite.answers if not answer.legal]
    assert illegal
    for answer in illegal:
        takes = any(
            candidate.legal
            and candidate.label == answer.label
            and candidate.outcome != Outcome.NOT_APPLICABLE
            and suite.family_of[candidate.row].kind == suite.family_of[answer.row].kind
            for candidate in suite.answers
        )
        assert takes or answer.outcome == Outcome.NOT_APPLICABLE


def test_matrix_cells(make: Make, tmp_path: Path) -> None:
    sweeps = small()
    sweeps.file.write(tmp_path)
    write_shapes(sweeps.file, tmp_path, sweeps.largest)
    records, rows, text = make(sweeps.file)
    header = rows["family"][0]

    def cell(family: str, title: str) -> str:
        return rows[family][0][header.index(title)]

    assert header[:2] == ["severity", "scenes"] and rows["offset"][0][:2] == ["1e4 to 1e12", "3"]
    assert (
        cell("offset", "NAIVEHDD") == "hung 1 of 3"
        and cell("offset", "NOHD as printed") == "wrong 2 of 3"
    )
    assert cell("offset", "scan (ours)") == "tight 3 of 3" and cell("offset", "Guthe 2005") == "n/a"
    assert (
        cell("needle", "Sacht 2024") == "stopped 2 of 2"
        and cell("needle", "Guthe 2005") == "loose 1 of 2"
    )
    assert (
        cell("needle", "cover (ours)") == "refused 1 of 2"
        and cell("needle", "CGAL") == "crashed 1 of 2"
    )
    assert (
        cell("not numbers", "CGAL") == "refused it 1 of 1"
        and cell("not numbers", "Sacht 2024") == "wrong 1 of 1"
    )
    assert cell("missing", "Guthe 2005") == "not run" and cell("missing", "scan (ours)") == "n/a"
    assert cell("concentric", "surface enclosure (ours)") == "crashed 1 of 1"
    assert all(all(row) for row in rows.values())  # no cell is empty
    record = next(
        r for r in records if r["label"] == "naive" and r["severity"] == "1000000000000.0"
    )
    assert (record["family"], record["kind"], record["verdict"], record["can_be_met"]) == (
        "offset",
        "points",
        "hung",
        "no",
    )
    assert (
        record["lower"] == ""
        and record["status"] == "timeout"
        and record["reason"].endswith("killed")
        and record["certified"] == "1"
    )
    assert len(records) == len(sweeps.file.cases) and "note of needle" in text


def test_matrix_claims(make: Make, tmp_path: Path) -> None:
    sweeps = small()
    sweeps.file.write(tmp_path)
    write_shapes(sweeps.file, tmp_path, sweeps.largest)
    text = make(sweeps.file)[2]
    assert (
        "crashes or hangs. Here it does not hold (4 of 19 answers: naive on offset at 1e12: hung; cover on needle at 1e6: refused; "
        "sacht on not numbers: wrong; surface_enclosure on concentric at 0.1: crashed)."
    ) in text
    assert (
        "Here it does not hold (8 of 13, 61.5 %; families below: concentric 0 of 1, needle 2 of 6; solvers below: sacht 0 of 2"
        in text
    )
    assert (
        "the suite can fail: nohd_as_printed is wrong somewhere. Here it holds (2 of 3 answers: offset at 1e8; offset at 1e12)."
        in text
    )
    assert (
        "guthe, textbook kernel is wrong somewhere. Here it holds (1 of 3 answers: needle at 1e6)."
        in text
    )
    assert "cgal is wrong somewhere. Here it does not hold (0 of 3 answers)." in text


def test_matrix_where_nothing_is_ill(make: Make, tmp_path: Path) -> None:
    sweeps = Sweeps()
    sweeps.family("offset", "mesh", [10.0**k for k in range(20)])
    sweeps.file.write(tmp_path)
    write_shapes(sweeps.file, tmp_path, {})
    text = make(sweeps.file)[2]
    assert "crashes or hangs. Here: not refuted (0 of 80 answers" in text
    assert (
        "(sampling and surface_meshes, whose bounds have a width of their own, aside). Here it holds (60 of 60, 100 %; families below: none; solvers below: none)."
        in text
    )


@pytest.mark.parametrize(
    ("tight", "outcome"),
    [(19, "it holds (57 of 60, 95.0 %"), (18, "it does not hold (54 of 60, 90.0 %")],
)
def test_the_share_of_tight_cells_decides(
    make: Make, tmp_path: Path, tight: int, outcome: str
) -> None:
    sweeps = Sweeps()
    ends: list[dict[str, Any]] = [GOOD] * tight + [
        {"lower": 0.25, "upper": 0.75, "status": "budget"}
    ] * (20 - tight)
    severities = [10.0**k for k in range(20)]
    sweeps.family("offset", "mesh", severities, {label: ends for label in MESHES})
    sweeps.file.write(tmp_path)
    write_shapes(sweeps.file, tmp_path, {})
    assert f"aside). Here {outcome}" in make(sweeps.file)[2]


def test_without_the_shapes_nobody_knows_what_can_be_met(make: Make) -> None:
    records, _, text = make(small().file)
    assert {record["can_be_met"] for record in records if record["kind"] == "points"} == {"unknown"}
    assert "answers are not in the cache" in text


def test_worst_of_two_tolerances_counts(make: Make, tmp_path: Path) -> None:
    sweeps = Sweeps()
    sweeps.family("offset", "mesh", [10.0, 100.0], tolerances=(1e-8, 1e-3))
    for case in sweeps.file.cases:
        if case["label"] == "cover" and case["severity"] == 100.0 and case["tolerance"] == 1e-8:
            case.update({"status": "floor", "lower": 0.25, "upper": 0.75})
    _, rows, _ = make(sweeps.file)
    assert rows["offset"][0][rows["family"][0].index("cover (ours)")] == "stopped 1 of 2"


def test_matrix_draws_every_strip(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    suite = written(small(), tmp_path, monkeypatch)
    points, meshes, surfaces = (figure.axes[0] for figure in stability_picture.draw(suite).values())
    assert [label.get_text() for label in meshes.get_yticklabels()] == [
        "needle",
        "not numbers",
        "missing",
    ]
    assert [label.get_text() for label in surfaces.get_xticklabels()] == [
        "below floor",
        "surface enclosure (ours)",
    ]
    # Each severity is a strip in each column: 3 of 5 solvers take points; the first column shows
    # the severity.
    assert len(points.patches) == 3 * (5 + 1) and len(meshes.patches) == (2 + 1 + 1) * (6 + 1)
    dark = [
        patch for patch in points.patches if patch.get_x() < 0 and patch.get_facecolor()[0] < 0.5
    ]
    assert len(dark) == 1  # the last severity, where coordinates reach 1e12
    assert {text.get_text() for text in meshes.texts} == {
        "",
        "~",
        "T",
        "B",
        "P",
        "X",
        "C",
        "R",
        "r",
    } | {"10 to 1e6", "1"}
    styles = {label.get_text(): label.get_style() for label in meshes.get_xticklabels()}
    assert styles["CGAL"] == "italic" and styles["Guthe 2005"] == "normal"
    plt.close("all")


def test_runs_of_like_strips() -> None:
    a, b = Outcome.TIGHT, Outcome.WRONG
    assert stability_picture.runs([a, a, b, a]) == [
        (0, 2),
        (2, 3),
        (3, 4),
    ] and stability_picture.runs([a]) == [(0, 1)]


def test_families_of_one_name_but_other_shapes_are_two(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    sweeps = Sweeps()
    sweeps.family("offset", "points", [10.0])
    sweeps.family("offset", "mesh", [10.0])
    suite = written(sweeps, tmp_path, monkeypatch)
    assert [(family.name, family.kind) for family in suite.families] == [
        ("offset", "points"),
        ("offset", "meshes"),
    ]


def test_scenes_of_no_sweep_are_families_of_their_own(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    suite = written(small(), tmp_path, monkeypatch)
    assert [family.name for family in suite.families] == [
        "offset",
        "needle",
        "not numbers",
        "missing",
        "concentric",
    ]
    assert range_text(suite.families[2]) == "" and range_text(suite.families[0]) == "1e4 to 1e12"


def test_severities_as_text() -> None:
    assert [severity_text(x) for x in (NAN, 0.0, 12.0, 0.25, 1e4, 1e-15, 2.5e6, 1000.0)] == [
        "",
        "0",
        "12",
        "0.25",
        "1e4",
        "1e-15",
        "2.5e6",
        "1000",
    ]


def test_three_stems_come_from_one_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("HAUSBENCH_CACHE", str(tmp_path))
    small().file.write(tmp_path)
    assert drawn_with("stability_matrix") == [
        "stability_matrix",
        "stability_error",
        "stability_time",
    ]
    assert (
        results_of("stability_time") == "stability_matrix"
        and results_of("cliffs") == "cliffs"
        and drawn_with("cliffs") == ["cliffs"]
    )
    arguments = ["--results", str(tmp_path), "--out", str(tmp_path / "out")]
    assert main(["stability_matrix", *arguments]) == 0
    three = {
        f"{stem}.{suffix}"
        for stem in ("stability_matrix", "stability_error", "stability_time")
        for suffix in ("csv", "md", "tex", "pdf", "png")
    } | {"stability_matrix.verdicts.json", "stability_time.txt"}
    parts = {
        f"stability_matrix-{kind}.{suffix}"
        for kind in ("points", "meshes", "surfaces")
        for suffix in ("pdf", "png")
    }
    three = three - {"stability_matrix.pdf", "stability_matrix.png"} | parts
    assert {
        Path(line).name
        for line in capsys.readouterr().out.splitlines()
        if not line.startswith("Claim: ")
    } == three
    assert main(["stability_error", *arguments]) == 0
    assert {Path(line).stem for line in capsys.readouterr().out.splitlines()} == {"stability_error"}
    (tmp_path / "stability_matrix.h5").unlink()
    assert main(["stability_time", *arguments]) == 2
    assert "measure it with 'make stability_matrix'" in capsys.readouterr().err


def sweep_of_errors() -> Sweeps:
    """guthe's bounds are 1e-9 too low and 2e-9 too high. CGAL answers its lower bound. guthe's
    textbook kernel is off by 0.1 at severity 1e4."""
    sweeps = Sweeps()
    near: dict[str, Any] = {"lower": 0.5 - 1e-9, "upper": 0.5 + 2e-9}
    sweeps.family(
        "offset",
        "mesh",
        [10.0, 1e4],
        {
            "guthe": [near],
            "cgal": [{"lower": 0.5, "upper": 0.5 + 1e-6}],
            "guthe, textbook kernel": [GOOD, WRONG],
            "cover": [{"upper": 0.5}],
            "sacht": [GOOD, HUNG],
            "sampling": [GOOD, {"upper": math.inf, "status": "budget"}],
        },
        source_diagonal=2.0,
        tolerance_absolute=1e-6,
    )
    sweeps.family("unknown", "mesh", [10.0, 1e4], exact=NAN)
    sweeps.family("once", "mesh", [10.0])
    sweeps.family(
        "bad",
        "mesh",
        [10.0, 100.0],
        {label: [killed("failed", "no")] for label in MESHES},
        scene_note="not legal: no face",
    )
    return sweeps


def test_error_table(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    suite = written(sweep_of_errors(), tmp_path, monkeypatch)
    report = stability_error.make(suite.results)
    assert report.table is not None
    cells = {row[1]: row[2:] for row in report.table.rows}
    assert {row[0] for row in report.table.rows} == {
        "offset"
    }  # the other families have no severities or no exact distance
    assert cells["Guthe 2005"] == ["1.0e-9", "10", "1.5e-9", "2.2e-15", "", ""]
    assert cells["CGAL"][:3] == ["0", "10", "5.0e-7"] and cells["cover (ours)"][:3] == [
        "0",
        "10",
        "0",
    ]
    assert (
        cells["guthe, textbook kernel"][:2] == ["0.050", "1e4"]
        and cells["guthe, textbook kernel"][4] == "1 of 2"
    )
    assert cells["Sacht 2024"][4:] == ["", "1 of 2"] and cells["sampling"][0] == "inf"
    assert len(report.records) == 2 * len(MESHES)


def test_error_figure_draws_zeros_wrong_points_and_letters(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    suite = written(sweep_of_errors(), tmp_path, monkeypatch)
    figure = stability_error.draw(suite, suite.families[:1])
    gaps, wrong = figure.axes
    assert "0" in [label.get_text() for label in wrong.get_yticklabels()]
    crosses = [
        line
        for line in wrong.lines
        if line.get_marker() == "s" and line.get_markerfacecolor() == "none"
    ]
    assert (
        len(crosses) == 1
        and crosses[0].get_xdata()[0] == 1e4
        and crosses[0].get_ydata()[0] == pytest.approx(0.05)
    )
    assert sorted(text.get_text() for text in wrong.texts) == ["H", "∞"]
    guide = next(
        line for line in gaps.lines if len(line.get_xdata()) == 2 and line.get_color() == "black"
    )
    assert list(guide.get_ydata()) == pytest.approx([40 * U / 2] * 2)
    plt.close(figure)


def test_severities_near_the_largest_doubles_are_drawn_without_a_warning(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    sweeps = Sweeps()
    sweeps.family("scale, large", "mesh", [10.0, 1e120, 1e300])
    sweeps.family("scale, small", "mesh", [0.1, 1e-120, 1e-300])
    suite = written(sweeps, tmp_path, monkeypatch)
    with warnings.catch_warnings():
        warnings.simplefilter("error", RuntimeWarning)
        figure = stability_error.draw(suite, suite.families)
        figure.savefig(tmp_path / "figure.png")
    assert all(math.isfinite(x) and x > 0 for ax in figure.axes for x in ax.get_xlim())
    plt.close(figure)


def test_time_table_and_timeouts_at_the_limit(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    sweeps = Sweeps()
    late: dict[str, Any] = {
        "lower": 0.25,
        "upper": 0.75,
        "status": "timeout",
        "solve_seconds": 2.01,
    }
    sweeps.family(
        "offset",
        "mesh",
        [1e-2, 1e-5],
        {
            "guthe": [{"seconds": 0.02}, {"seconds": 0.5}],
            "sacht": [GOOD, HUNG],
            "cover": [GOOD, late],
            "cgal": [GOOD, killed("signal", "SIGSEGV")],
        },
    )
    suite = written(sweeps, tmp_path, monkeypatch)
    report = stability_time.make(suite.results)
    assert report.table is not None
    cells = {row[1]: row[2:] for row in report.table.rows}
    assert cells["Guthe 2005"][:3] == ["20.0", "500", "1e-5"]
    assert cells["Sacht 2024"][-2:] == ["1 of 2", "1 of 2"] and cells["cover (ours)"][-2:] == [
        "1 of 2",
        "",
    ]
    assert cells["CGAL"][-2:] == ["", "1 of 2"]
    figure = stability_time.draw(suite, suite.families)
    times, work = figure.axes
    at_limit = [
        line for line in times.lines if len(line.get_xdata()) == 1 and line.get_ydata()[0] == 2.0
    ]
    assert len(at_limit) == 2 and all(line.get_markerfacecolor() == "white" for line in at_limit)
    assert [text.get_text() for text in times.texts] == ["C"]
    assert sorted(text.get_text() for text in work.texts) == ["C", "H"]
    assert (
        times.get_xlim()[0] > times.get_xlim()[1]
    )  # the most severe value, here the smallest, is on the right
    plt.close(figure)


def test_at_most_twelve_panels_of_the_longest_sweeps(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    sweeps = Sweeps()
    for i in range(15):
        sweeps.family(f"family {i}", "points", [10.0**k for k in range(2 + i % 5)])
    suite = written(sweeps, tmp_path, monkeypatch, shapes=False)
    chosen = [int(family.name.split()[1]) for family in choose(suite.families)]
    assert (
        len(chosen) == 12
        and chosen == sorted(chosen)
        and set(range(15)) - set(chosen) == {0, 5, 10}
    )


def test_works_with_a_single_row(make: Make) -> None:
    file = ResultFile("stability_matrix")
    file.case("cover", "alone", **killed("timeout", "killed", tolerance=1e-6))
    _, rows, _ = make(file)
    assert rows["alone"][0][-1] == "hung 1 of 1"
