"""Tests the letters of panels, and figures with several parts."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import pytest
import synthetic_stability

from analysis.shared import panels, report
from analysis.shared.load import load
from analysis.stability import stability_panels, stability_picture
from analysis.stability.stability_families import Suite, look


def letters(figure: Any) -> list[str]:
    return [ax.get_title() or ax.get_title(loc="left") for ax in panels.panels(figure)]


def test_panels_have_letters_row_by_row() -> None:
    figure, axes = plt.subplots(2, 2)
    axes[0][1].set_title("right")
    image = axes[1][0].imshow([[0.0, 1.0]])
    figure.colorbar(image, ax=axes[1][0])
    axes[1][1].set_visible(False)
    panels.add_letters(figure)
    assert letters(figure) == ["(a)", "(b) right", "(c)"]
    plt.close(figure)


def test_a_single_panel_has_no_letter_and_a_title_keeps_its_own() -> None:
    single, ax = plt.subplots()
    panels.add_letters(single)
    assert not ax.get_title(loc="left")
    figure, axes = plt.subplots(1, 3)
    axes[1].set_title("(a) pears")
    panels.add_letters(figure)
    assert letters(figure) == ["(b)", "(a) pears", "(c)"]
    plt.close("all")


def test_panels_that_were_placed_by_hand_have_their_letters_inside() -> None:
    figure = plt.figure()
    figure.set_layout_engine("none")
    axes = [figure.add_axes((0.1, bottom, 0.8, 0.35)) for bottom in (0.55, 0.1)]
    panels.add_letters(figure)
    assert [ax.texts[0].get_text() for ax in axes] == ["(a)", "(b)"] and letters(figure) == ["", ""]
    plt.close(figure)


def test_several_figures_have_names(tmp_path: Path) -> None:
    (tmp_path / "figures").mkdir()
    (tmp_path / "figures" / "stem.png").write_bytes(b"old")
    drawn = {name: plt.figure(figsize=(1, 1)) for name in ("points", "meshes")}
    written = report.save_figures(drawn, tmp_path, "stem", "a caption", "", ["png"])
    assert [path.name for path in written] == ["stem-points.png", "stem-meshes.png"] and not (
        tmp_path / "figures" / "stem.png"
    ).exists()


@pytest.fixture()
def suite(tmp_path: Path) -> Suite:
    return Suite(load(synthetic_stability.large().file.write(tmp_path)))


def test_each_part_of_the_stability_matrix_fits_a_page(suite: Suite) -> None:
    drawn = stability_picture.draw(suite)
    assert list(drawn) == ["points", "meshes", "surfaces"]
    assert all(
        figure.get_figwidth() <= 7.17 and figure.get_figheight() < 9.0 for figure in drawn.values()
    )
    plt.close("all")


def test_no_colour_and_no_marker_twice_among_the_lines_in_front(suite: Suite) -> None:
    shown = [look(*pair) for pair in stability_panels.telling(suite, suite.families)]
    assert 3 <= len(shown) <= stability_panels.SHOWN
    colours = {line.colour for line in shown}
    markers = {line.marker for line in shown}
    assert len(colours) == len(markers) == len(shown)
