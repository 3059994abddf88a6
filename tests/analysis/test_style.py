"""Colours and markers, zeros on logarithmic axes, and figures whose bytes are reproducible."""

import time
import tomllib
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pytest

from analysis.shared import report, scales, style


def test_no_two_solvers_look_alike() -> None:
    looks = [(look.colour, look.marker) for look in style.LOOKS.values()]
    assert len(set(looks)) == len(looks)


def test_every_status_has_a_letter_of_its_own() -> None:
    assert len(set(style.STATUS_LETTERS.values())) == len(style.STATUS_LETTERS)
    assert set(style.STATUS_LETTERS) == set(style.STATUS_WORDS)


def test_variants_keep_the_colour() -> None:
    assert style.look("ohd", "ohd") is style.LOOKS["ohd"]
    variant = style.look("ohd", "as printed")
    assert (
        variant.colour == style.LOOKS["ohd"].colour and variant.marker != style.LOOKS["ohd"].marker
    )
    assert variant == style.look("ohd", "as printed") and variant.title == "as printed"
    assert style.look("somebody", "somebody").title == "somebody"


def test_a_footnote_stands_below_the_figure(tmp_path: Path) -> None:
    heights = []
    for stem, footnote in (
        ("without", ""),
        ("with", "Lower bounds not checked (no witness): cgal"),
    ):
        figure, _ = plt.subplots(figsize=(style.SINGLE_COLUMN, 2))
        _, png = report.save_figure(figure, tmp_path, stem, "a figure", footnote)
        heights.append(plt.imread(png).shape[0])
        assert (footnote in [text.get_text() for text in figure.texts]) == bool(footnote)
    assert heights[1] > heights[0]


def test_order_and_titles() -> None:
    assert style.order(
        [("new", "new"), ("cover", "cover"), ("naive", "naive"), ("cover", "cover")]
    ) == [("naive", "naive"), ("cover", "cover"), ("new", "new")]
    assert (
        style.scene_title("b_cow_hippo") == "(b) cow, hippo"
        and style.scene_title("bunny_half") == "bunny half"
    )
    assert style.scene_title("s_one_two") == "s one two"


def test_panels_are_the_scenes_of_the_experiments_that_begin_with_a_letter() -> None:
    names = {
        scene["name"]
        for file in (Path(__file__).parents[2] / "experiments").rglob("*.toml")
        if "[[scene]]" in (text := file.read_text(encoding="utf-8"))
        for scene in tomllib.loads(text).get("scene", [])
    }
    assert style.PANELS == {name for name in names if name[1:2] == "_"}


@pytest.mark.parametrize("values", [[0.0, 1e-8, 1e-3], [1e-16, 0.0], [0.0, 0.0], [5e-324, 0.0]])
def test_zeros_are_inside_the_frame_and_below_everything_else(values: list[float]) -> None:
    figure, ax = plt.subplots()
    axis = scales.LogAxis(ax, values)
    placed, (low, high) = axis.place(values), ax.get_ylim()
    assert (placed > low).all() and (placed < high).all()
    positive = placed[np.array(values) > 0]
    assert all(axis.place(0.0) < y for y in positive)
    assert "0" in [label.get_text() for label in ax.get_yticklabels()]
    plt.close(figure)


def test_without_zeros_there_is_no_band() -> None:
    figure, ax = plt.subplots()
    scales.LogAxis(ax, [1e-4, 1e-2])
    assert "0" not in [label.get_text() for label in ax.get_yticklabels()]
    plt.close(figure)


def test_figures_are_reproducible(tmp_path: Path) -> None:
    def draw(folder: str) -> list[Path]:
        figure, ax = plt.subplots(figsize=(style.SINGLE_COLUMN, 2))
        ax.plot([1, 2], [3, 4], **style.filled_marker(style.look("cover")))
        ax.set_xlabel("a length, $10^{-3}$")
        return report.save_figure(figure, tmp_path / folder, "figure", "a caption")

    first = [path.read_bytes() for path in draw("1")]
    time.sleep(1.1)
    assert first == [path.read_bytes() for path in draw("2")]
    assert b"/FontType 42" in first[0] or b"/Type42" in first[0] or b"/CIDFontType2" in first[0]
    assert not list(tmp_path.glob("*/figures/*.part"))


def test_margin_marks_say_what_does_not_fit() -> None:
    figure, ax = plt.subplots()
    style.margin_marks(ax, [(style.look("inc"), "T")] * 10, height=40, pitch=10)
    assert [text.get_text() for text in ax.texts] == ["T", "T", "T", "+7"]
    plt.close(figure)
