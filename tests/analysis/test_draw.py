"""Tests `hausbench draw` on made-up result files."""

from __future__ import annotations

import csv
import json
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import pytest
from synthetic import ResultFile, spread

from analysis import draw
from analysis.shared import report, style, tables
from analysis.shared.drawable import as_formula, make_drawable
from analysis.shared.load import load

CLAIMS = """
[[claim]]
solver = "mine"
faster_than = "guthe"
by = 1.5
[[claim]]
solver = "guthe"
faster_than = "mine"
on = "every"
"""


@pytest.fixture(autouse=True)
def looks_as_before() -> Iterator[None]:
    yield
    style.highlight("")
    style.set_width(style.DOUBLE_COLUMN)
    style._own.clear()
    style._variants.clear()


def sweep(
    speed: float = 2.0, poses: int = 1, scenes: tuple[str, ...] = ("x", "y"), **columns: Any
) -> ResultFile:
    """`mine`, a plug-in's solver, is `speed` times as fast as guthe."""
    file = ResultFile(
        "own",
        meta={
            "title": "Mine against Guthe",
            "experiment_toml": CLAIMS,
            "plugins": json.dumps([{"file": "libmine.so", "sha256": "0", "solvers": ["mine"]}]),
            "titles": json.dumps({"mine": "My solver", "tang_again": "Tang again"}),
        },
    )
    for k, scene in enumerate(scenes):
        for pose in range(poses):
            for tolerance in (1e-2, 1e-3, 1e-4):
                for solver, seconds in (("guthe", 0.1 * (k + 1)), ("mine", 0.1 * (k + 1) / speed)):
                    file.case(
                        solver,
                        scene,
                        spread(seconds, 6),
                        tolerance=tolerance,
                        pose_index=pose,
                        lower=1.0,
                        upper=1.0 + tolerance,
                        certified=1,
                        **columns,
                    )
    return file


def run(file: ResultFile, folder: Path, *arguments: str) -> int:
    return draw.main([str(file.write(folder)), *arguments])


def test_everything_that_a_result_holds_is_drawn(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(sweep(poses=3), tmp_path) == 0
    for kind in ("error_against_time", "performance_profile", "motion"):
        for folder, suffixes in (("figures", ("pdf", "png")), ("tables", ("csv", "md", "tex"))):
            for suffix in suffixes:
                assert (tmp_path / folder / f"own_{kind}.{suffix}").stat().st_size > 0
    assert (tmp_path / "tables" / "own_table.tex").read_text(encoding="utf-8").isascii()
    printed = capsys.readouterr().out
    assert "own_motion.pdf" in printed
    assert (
        "Claim: My solver takes less time than Guthe 2005 on average, by a factor of 1.5. Here it holds"
        in printed
    )
    assert (
        "Claim: Guthe 2005 takes less time than My solver on every case. Here it does not hold"
        in printed
    )


@pytest.mark.parametrize("speed,outcome", [(2.0, "holds"), (1.2, "does not hold")])
def test_claims_of_an_experiment_are_judged_like_ours(
    tmp_path: Path, speed: float, outcome: str
) -> None:
    assert run(sweep(speed), tmp_path, "--as", "table") == 0
    first, _ = json.loads(
        (tmp_path / "tables" / "own_table.verdicts.json").read_text(encoding="utf-8")
    )
    assert first["outcome"] == outcome and first["stem"] == "own_table"


def test_a_claim_about_one_case_is_about_that_case(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = ResultFile("own", meta={"experiment_toml": CLAIMS})
    for solver, seconds in (("guthe", 0.4), ("mine", 0.2)):
        file.case(solver, "x", spread(seconds, 6), lower=1.0, upper=1.0)
    assert run(file, tmp_path, "--as", "table") == 0
    assert (
        "mine takes less time than Guthe 2005 on every case, by a factor of 1.5. Here it holds"
        in capsys.readouterr().out
    )
    file.case("guthe", "y", spread(0.4, 6), lower=1.0, upper=1.0)
    file.case("mine", "y", [], status="failed", reason="it crashed")
    assert run(file, tmp_path, "--as", "table") == 0
    assert "Here: not judged (n = 1; " in capsys.readouterr().out  # one of two cases has no ratio


def test_a_claim_about_a_solver_that_was_run_with_several_parameters_says_so(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = ResultFile("own", meta={"experiment_toml": CLAIMS})
    for label, seconds in (("guthe", 0.4), ("mine(step=1)", 0.2), ("mine(step=2)", 0.1)):
        file.case(
            label.partition("(")[0], "x", spread(seconds, 6), label=label, lower=1.0, upper=1.0
        )
    assert run(file, tmp_path, "--as", "table") == 0
    assert (
        "not tested ('mine' is not one solver here: it was run as mine(step=1), mine(step=2); name one of these in the claim)"
        in capsys.readouterr().out
    )


def test_terminal_and_table_have_one_verdict(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The verdicts agree even if profile `paper` of the experiment has more cases than were
    measured."""
    file = sweep()
    file.meta[
        "experiment_toml"
    ] += '[[solver]]\nname = "guthe"\n[[solver]]\nname = "mine"\n[[solver]]\nname = "cgal"\nprofiles = ["paper"]\n'
    assert run(file, tmp_path, "--as", "table") == 0
    printed = [line for line in capsys.readouterr().out.splitlines() if line.startswith("Claim:")]
    table = (tmp_path / "tables" / "own_table.md").read_text(encoding="utf-8").splitlines()
    assert printed == [line.removeprefix("- ") for line in table if line.startswith("- Claim:")]
    assert "Here it holds" in printed[0] and len(printed) == 2


def test_a_solver_is_not_compared_with_itself(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = sweep()
    file.meta["experiment_toml"] = '[[claim]]\nsolver = "guthe"\nfaster_than = "guthe"\n'
    assert run(file, tmp_path, "--as", "table") == 0
    assert "Here: not tested (it compares a solver with itself" in capsys.readouterr().out


def test_the_table_has_every_answer(tmp_path: Path) -> None:
    file = sweep(scenes=("x",), reported_seconds=0.05)
    file.case("mine", "z", [], status="timeout", reason="60 s")
    assert run(file, tmp_path, "--as", "table") == 0
    with (tmp_path / "tables" / "own_table.csv").open(encoding="utf-8") as opened:
        rows = list(csv.DictReader(opened))
    assert (
        len(rows) == 7 and rows[-1]["status"] == "timeout 1 of 1" and rows[-1]["reason"] == "60 s"
    )
    assert (
        float(rows[0]["lower"]) == 1.0
        and rows[0]["reported_seconds"] == "0.05"
        and rows[1]["name"] == "mine"
    )
    assert "reported, ms" in (tmp_path / "tables" / "own_table.md").read_text(encoding="utf-8")


def test_a_profile_counts_cases_within_a_factor(tmp_path: Path) -> None:
    file = sweep(speed=2.0)
    file.case("guthe", "z", spread(0.1, 6), lower=1.0, upper=1.0)
    file.case("mine", "z", [], status="timeout")
    assert run(file, tmp_path, "--as", "performance-profile") == 0
    text = (tmp_path / "tables" / "own_performance_profile.md").read_text(encoding="utf-8")
    cells = {
        line.split(" | ")[0].strip("| "): line.strip("| ").split(" | ")[1:]
        for line in text.splitlines()
        if line.startswith("| ")
    }
    assert cells["My solver"] == [
        "7",
        "86 %",
        "86 %",
        "86 %",
        "86 %",
    ]  # fastest in 6 of 7 cases, and no answer in the other
    assert cells["Guthe 2005"] == ["7", "14 %", "100 %", "100 %", "100 %"]


def test_a_profile_counts_no_case_whose_shapes_a_solver_does_not_take(tmp_path: Path) -> None:
    file = sweep(speed=2.0)
    file.case("guthe", "points", [], status="skipped")
    file.case("mine", "points", spread(0.1, 6))
    assert run(file, tmp_path, "--as", "performance-profile") == 0
    text = (tmp_path / "tables" / "own_performance_profile.md").read_text(encoding="utf-8")
    assert "| Guthe 2005 | 6 | 0 % | 100 % |" in text and "| My solver | 7 | 100 % |" in text


HOSTILE = ("_a$x_1$", "中文 $\\frac", "ä^2 & 100 % of \\alpha", "$", "*[ε")


def test_names_are_drawn_as_they_are(tmp_path: Path) -> None:
    """Solver names with special characters are neither interpreted by mathtext or LaTeX nor
    lost."""
    file = ResultFile("own", meta={"title": HOSTILE[1]})
    for scene in HOSTILE:
        for pose in range(2):
            for label in HOSTILE:
                file.case(
                    "guthe",
                    scene,
                    spread(0.1, 6),
                    label=label,
                    pose_index=pose,
                    lower=1.0,
                    upper=1.0,
                    lower_check="not checked (no witness)",
                )
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert run(file, tmp_path) == 0
    for path in (tmp_path / "tables").glob("*.tex"):
        text = path.read_text(encoding="utf-8")
        assert (
            text.isascii()
            and r"\texttt{U+4E2D U+6587} \$\textbackslash{}frac" in text
            and "U+ and digits" in text
        )
        assert r"\"{a}\textasciicircum{}2 \& 100 \% of" in text


def test_legends_have_names_with_an_underscore_in_front() -> None:
    figure, ax = plt.subplots()
    ax.plot([1, 2], [1, 2], label=style.Look("_a$x_1$", "#000000", "o").entry)
    figure.legend(handles=[style.filled_entry("_b"), style.open_entry("$_c^$ 中")])
    ax.set_yticks([1, 2], ["$y_1$", "$10^{2}$"])
    ax.legend()
    formula, name = ax.text(1, 1, "$x^2$"), ax.text(1, 2, "$x^2$")
    as_formula(formula)
    make_drawable(figure)
    make_drawable(figure)  # must not escape the text again
    assert formula.get_text() == "$x^2$" and name.get_text() == r"\$x^2\$"
    figure.draw_without_rendering()
    texts = {
        text.get_text().strip()
        for legend in (ax.get_legend(), figure.legends[0])
        for text in legend.get_texts()
    }
    assert texts == {r"_a\$x_1\$", "_b", r"\$_c^\$ <U+4E2D>"}
    assert [tick.get_text() for tick in ax.get_yticklabels()] == [r"\$y_1\$", "$10^{2}$"]
    plt.close(figure)


@pytest.mark.parametrize(
    "words", ["", ", with many words that say what is so special about this variant of it"]
)
def test_a_legend_of_many_labels_is_inside_the_figure(words: str) -> None:
    figure, _ = plt.subplots(figsize=(style.DOUBLE_COLUMN, 3.0))
    style.legend_above(
        figure,
        [style.filled_entry(f"mine(step={step}{words})") for step in range(40)],
        columns=5,
        room=True,
    )
    figure.draw_without_rendering()
    inside, whole = figure.legends[0].get_window_extent(), figure.bbox
    assert (
        whole.x0 <= inside.x0
        and inside.x1 <= whole.x1
        and whole.y0 <= inside.y0
        and inside.y1 <= whole.y1
    )
    assert (
        figure.axes[0].get_window_extent().height > 2.2 * figure.dpi
        and figure.axes[0].get_window_extent().y1 < inside.y0
    )
    plt.close(figure)


def test_a_profile_has_every_label_in_its_figure(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = sweep()
    for step in range(30):
        file.case(
            "mine",
            "x",
            spread(0.1, 6),
            tolerance=1e-2,
            label="mine",
            variant=f"step={step},method=robust",
            lower=1.0,
            upper=1.0,
        )
    shown: list[Any] = []
    monkeypatch.setattr(report, "save_figure", lambda figure, *_: [shown.append(figure)])  # type: ignore[func-returns-value]
    assert run(file, tmp_path, "--as", "performance-profile") == 0
    shown[0].draw_without_rendering()
    box, whole = shown[0].legends[0].get_window_extent(), shown[0].bbox
    assert (
        box.x0 >= 0
        and box.y0 >= 0
        and box.x1 <= whole.x1
        and box.y1 <= whole.y1
        and len(shown[0].legends[0].get_texts()) == 32
    )
    plt.close(shown[0])


def test_gaps_are_lengths_where_a_is_a_single_point(tmp_path: Path) -> None:
    file = sweep(scenes=("x",), source_diagonal=0.0)
    file.case(
        "guthe",
        "y",
        spread(0.1, 6),
        [(0.0, 0.0, 2.0), (0.1, 1.0, 1.5)],
        tolerance=0.5,
        lower=1.0,
        upper=1.5,
        source_diagonal=0.0,
    )
    file.case("guthe", "z", spread(0.1, 6), tolerance=0.5, lower=1.0, upper=1.5)
    assert run(file, tmp_path) == 0
    text = (tmp_path / "tables" / "own_error_against_time.md").read_text(encoding="utf-8")
    assert (
        "| y | Guthe 2005 | 0.5 |" in text
        and "Lengths, not fractions, because A is a single point: x, y." in text
    )
    with (tmp_path / "tables" / "own_error_against_time.csv").open(encoding="utf-8") as opened:
        assert [row["relative_gap"] for row in csv.DictReader(opened) if row["scene"] != "x"] == [
            "0.5",
            "0.5",
        ]


def test_a_time_of_0_is_no_factor(tmp_path: Path) -> None:
    file = ResultFile("own")
    for scene, seconds in (("x", 0.1), ("y", 0.0), ("z", 0.2)):
        file.case("guthe", scene, [seconds], lower=1.0, upper=1.0)
        file.case("mine", scene, [0.5 * seconds], lower=1.0, upper=1.0)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert run(file, tmp_path, "--as", "performance-profile") == 0
    text = (tmp_path / "tables" / "own_performance_profile.md").read_text(encoding="utf-8")
    assert (
        "the share of the 2 cases" in text
        and "1 case is left out: a time is 0, too short for the clock." in text
    )


# "not checked" adds a footnote, which must not widen the figure.
@pytest.mark.parametrize(
    ("width", "inches", "check"),
    [
        ("single", 3.5, "holds"),
        ("double", 7.16, "not checked (no witness)"),
        ("5.5", 5.5, "not checked (no witness)"),
    ],
)
def test_figures_are_as_wide_as_asked(
    tmp_path: Path, width: str, inches: float, check: str
) -> None:
    file = sweep(poses=3, scenes=("x", "y", "z", "u", "v"), lower_check=check)
    assert run(file, tmp_path, "--width", width, "--format", "svg,png") == 0
    names = sorted(path.name for path in (tmp_path / "figures").iterdir())
    assert names == [
        f"own_{kind}.{suffix}"
        for kind in ("error_against_time", "motion", "performance_profile")
        for suffix in ("png", "svg")
    ]
    for path in (tmp_path / "figures").glob("*.svg"):
        assert f'width="{72 * inches:g}pt"' in path.read_text(encoding="utf-8"), path
    assert all(
        abs(plt.imread(path).shape[1] - 200 * inches) < 2
        for path in (tmp_path / "figures").glob("*.png")
    )


@pytest.mark.parametrize(
    "wrong",
    [
        ("--width", "tiny"),
        ("--width", "0"),
        ("--width", "nan"),
        ("--format", "pdf,gif"),
        ("--format", ""),
    ],
)
def test_widths_and_formats_that_there_are_not(
    tmp_path: Path, wrong: tuple[str, str], capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as ended:
        run(sweep(), tmp_path, *wrong)
    assert (
        ended.value.code == 2
        and f"argument {wrong[0]}: '" in capsys.readouterr().err
        and not (tmp_path / "figures").exists()
    )


def test_a_failed_row_shows_no_bounds(tmp_path: Path) -> None:
    file = sweep(scenes=("x",))
    file.case("mine", "z", [], status="failed", reason="it ended with 1", lower=3.0, upper=4.0)
    assert run(file, tmp_path, "--as", "table") == 0
    with (tmp_path / "tables" / "own_table.csv").open(encoding="utf-8") as opened:
        last = list(csv.DictReader(opened))[-1]
    assert (
        last["status"].startswith("failed")
        and last["lower"] in ("", "nan")
        and last["upper"] in ("", "nan")
    )


def test_variants_and_solvers_in_grey_can_be_told_apart(tmp_path: Path) -> None:
    file = sweep(scenes=("x",))
    variants = [f"mine(step={step})" for step in range(6)]
    for label in variants:
        file.case(
            "mine",
            "x",
            spread(0.1, 6),
            options={"step": label},
            label="mine",
            variant=label.partition("(")[2].rstrip(")"),
        )
    assert run(file, tmp_path, "--as", "table") == 0
    looks = [style.look("mine", label) for label in variants]
    markers = {(look.line, look.marker) for look in looks}
    colours = {(look.line, look.colour) for look in looks}
    assert len(markers) == len(colours) == len(variants)
    style.highlight("guthe")
    greys = [style.look("mine", label) for label in variants]
    assert len({(look.line, look.colour) for look in greys}) == len(variants)
    assert (
        all(look.colour in ("#A0A0A0", "#C4C4C4", "#808080") for look in greys)
        and style.look("guthe").colour == style.LOOKS["guthe"].colour
    )


def test_what_a_result_does_not_hold_is_said(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(sweep(), tmp_path, "--as", "motion") == 2
    assert "no scene has several poses" in capsys.readouterr().err
    assert run(sweep(), tmp_path, "--highlight", "ours") == 2
    assert "no solver is labelled 'ours': choose one of guthe, mine" in capsys.readouterr().err
    assert draw.main([str(tmp_path / "none.h5")]) == 2
    assert "none.h5" in capsys.readouterr().err


def test_solvers_without_a_chosen_look_have_titles_and_colours_of_their_own(tmp_path: Path) -> None:
    file = sweep()
    file.case("tang_again", "x", spread(0.1, 6))  # a built-in solver without a look in style.py
    file.case("external", "x", spread(0.1, 6), label="metro")
    file.case("external", "x", spread(0.1, 6), label="cloudcompare")
    assert run(file, tmp_path, "--as", "table", "--highlight", "mine") == 0
    mine, again = style.look("mine", "mine"), style.look("tang_again", "tang_again")
    metro, cloudcompare = style.look("external", "metro"), style.look("external", "cloudcompare")
    assert (mine.title, again.title, metro.title, cloudcompare.title) == (
        "My solver",
        "Tang again",
        "metro",
        "cloudcompare",
    )
    assert mine.colour not in {look.colour for look in style.LOOKS.values()}
    greys = {"#A0A0A0", "#C4C4C4", "#808080"}
    assert {
        metro.colour,
        cloudcompare.colour,
        style.look("guthe", "guthe").colour,
    } <= greys and mine.colour not in greys
    style.highlight("")
    colours = [
        style.look(*pair).colour
        for pair in (
            ("mine", ""),
            ("tang_again", ""),
            ("external", "metro"),
            ("external", "cloudcompare"),
        )
    ]
    assert len({*colours}) == 4 and not {*colours} & {look.colour for look in style.LOOKS.values()}
    assert style.look("guthe", "guthe").colour == style.LOOKS["guthe"].colour


def test_each_of_several_figures_has_the_footnote_of_its_rows(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = ResultFile("parts")
    for solver, check in (("guthe", "holds"), ("cgal", "no witness")):
        file.case(solver, "x", [1.0], lower=0.5, upper=0.6, lower_check=check)
    results, footnotes = load(file.write(tmp_path)), dict[str, str]()

    def remember(
        figure: Any, out: Path, stem: str, caption: str, footnote: str, formats: Any
    ) -> list[Path]:
        footnotes[stem] = footnote
        return []

    monkeypatch.setattr(report, "save_figure", remember)
    made = report.Report(
        lambda: {"a": None, "b": None, "all": None},
        tables.Table("A caption.", ["x"], [["1"]]),
        parts={"a": [0], "b": [1]},
    )
    made.save(results, tmp_path)
    line = "Lower bounds not checked (no witness): CGAL."
    assert footnotes == {"parts-a": "", "parts-b": line, "parts-all": line}


def test_an_old_figure_is_deleted_if_there_is_none_now(tmp_path: Path) -> None:
    file = ResultFile("gone")
    file.case("guthe", "x", [1.0], lower=0.5, upper=0.6)
    results, table = load(file.write(tmp_path)), tables.Table("A caption.", ["x"], [["1"]])
    paths = report.Report(lambda: plt.figure(), table, caption="A picture.").save(results, tmp_path)
    figures = [path for path in paths if path.parent.name == "figures"]
    assert {path.suffix for path in figures} == {".pdf", ".png", ".txt"}
    assert all(path.exists() for path in figures)
    report.Report(None, table).save(results, tmp_path)
    assert not any(path.exists() for path in figures)
