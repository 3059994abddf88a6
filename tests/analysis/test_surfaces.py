"""Tests the tables of algebraic surfaces on files with known numbers."""

from __future__ import annotations

import csv
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from synthetic import ResultFile, spread

from analysis.__main__ import main
from analysis.shared.load import load, paper_numbers
from analysis.shared.verdicts import FAILS, HOLDS, OPEN, UNTESTED
from analysis.shou2014 import shou2014_convergence, shou2014_example, surfaces_gallery
from analysis.shou2014.shou2014_example import Joined

BOX = 3 * [-2.0, 2.0]
DIRECTIONS = (("first to second", 0.64, 0.85), ("second to first", 0.73, 0.90))


def records(path: Path, stem: str) -> list[dict[str, str]]:
    with (path / "tables" / f"{stem}.csv").open(encoding="utf-8") as opened:
        return list(csv.DictReader(opened))


def subdivision(
    file: ResultFile, label: str, depth: int, form: str, distances: int, **more: Any
) -> None:
    for scene, low, high in DIRECTIONS:
        file.case(
            "interval_subdivision",
            scene,
            spread(2.0, 3),
            label=label,
            lower=low,
            upper=high,
            certified=0,
            prepare_seconds=0.5,
            options={"depth": depth, "form": form, "pairs": label.split()[0]},
            counters={"box_distances": distances, "polynomial_evaluations": 7},
            lower_check="no witness",
            tolerance=10.0,
            tolerance_of="absolute",
            **more,
        )


def test_example_joins_both_directions(tmp_path: Path) -> None:
    file = ResultFile("shou2014_example")
    subdivision(file, "all pairs", 6, "modified_affine", 5000)
    subdivision(file, "pruned pairs", 6, "modified_affine", 5)
    file.write(tmp_path)
    assert main([file.stem, "--results", str(tmp_path), "--out", str(tmp_path)]) == 0
    first, second = records(tmp_path, file.stem)
    assert (float(first["lower"]), float(first["upper"])) == (0.73, 0.90)
    assert (
        first["paper_seconds"] == ""
    )  # a digit of the paper's number is doubtful, so no ratio is given
    assert first["box_distances"] == "10000" and float(first["subdivision_seconds"]) == 1.0
    assert (
        float(first["distance_seconds"]) == pytest.approx(3.6) and second["box_distances"] == "10"
    )
    text = (tmp_path / "tables" / f"{file.stem}.md").read_text(encoding="utf-8")
    assert (
        "| 1000 |" in text
        and "789694? (all)" in text
        and "no ratio of times is given" in text
        and "times less" not in text
        and "0.81295637135" in text
    )


def test_convergence_leaves_out_what_failed(tmp_path: Path) -> None:
    file = ResultFile("shou2014_convergence")
    for depth in (5, 6):
        for form in shou2014_convergence.FORMS:
            subdivision(file, "pruned pairs", depth, form, 50)
    subdivision(file, "all pairs", 6, "modified_affine", 5000, status="timeout")
    for tolerance in (1e-2, 1e-4):
        for scene, low, high in DIRECTIONS:
            file.case(
                "surface_enclosure",
                scene,
                spread(0.1, 3),
                lower=low,
                upper=high,
                tolerance=tolerance,
                tolerance_of="absolute",
                prepare_seconds=0.01,
            )
    file.write(tmp_path)
    assert main([file.stem, "--results", str(tmp_path), "--out", str(tmp_path)]) == 0
    published, ours = shou2014_convergence.collect(load(tmp_path / f"{file.stem}.h5"))
    assert (
        {key[0] for key in published} == {"pruned pairs"}
        and len(published) == 8
        and sorted(ours) == [1e-4, 1e-2]
    )
    assert len(records(tmp_path, file.stem)) == 10
    assert "All four forms give the same interval" in (
        tmp_path / "tables" / f"{file.stem}.md"
    ).read_text(encoding="utf-8")


def test_convergence_is_judged_by_exact_widths() -> None:
    def outcomes(widths: list[float], exact: float = 0.5, work: int = 16) -> list[str]:
        published = {
            ("pruned pairs", "modified_affine", 4 + k): Joined(
                0.5 - width / 2, 0.5 + width / 2, 1.0, 1.0, 1, 1, "ok"
            )
            for k, width in enumerate(widths)
        }
        published |= {
            ("all pairs", form, depth): replace(joined, distances=work**depth)
            for (_, form, depth), joined in published.items()
        }
        return [verdict.outcome for verdict in shou2014_convergence.verdicts(published, exact)]

    assert outcomes([0.4, 0.2, 0.1]) == [HOLDS, HOLDS, HOLDS]
    assert outcomes([0.4, 0.3, 0.1]) == [FAILS, HOLDS, HOLDS]
    assert outcomes([0.4, 0.2, 0.1], 0.61) == [HOLDS, HOLDS, FAILS] and outcomes([]) == [
        UNTESTED,
        UNTESTED,
        UNTESTED,
    ]
    assert [outcomes([0.4, 0.2, 0.1], work=work)[1] for work in (4, 8, 9)] == [FAILS, OPEN, HOLDS]


@pytest.mark.parametrize(
    ("lower", "upper", "status", "outcome"),
    [
        (0.7288689868557, 0.8970437559005, "ok", HOLDS),
        (0.7288689868557, 0.8970437561, "ok", FAILS),
        (0.7288689868557, 0.8970437559005, "timeout", UNTESTED),
        (None, None, "", UNTESTED),
    ],
)
def test_the_example_gives_the_printed_interval(
    lower: float | None, upper: float | None, status: str, outcome: str
) -> None:
    """The paper's interval is truncated, not rounded, after the tenth digit."""
    here = (
        Joined(lower, upper, 1.0, 1.0, 1, 1, status)
        if lower is not None and upper is not None
        else None
    )
    assert (
        shou2014_example.printed_interval(paper_numbers("shou2014_example")["row"][0], here).outcome
        == outcome
    )


def test_gallery_names_what_does_not_hold(tmp_path: Path) -> None:
    file = ResultFile("surfaces_gallery")
    for solver, low, high, status in (
        ("interval_subdivision", 0.6, 0.7, "unsound"),
        ("surface_enclosure", 0.49, 0.51, "ok"),
    ):
        file.case(
            solver,
            "spheres",
            spread(0.1, 1),
            lower=low,
            upper=high,
            status=status,
            exact=0.5,
            scene_note="constant",
            prepare_seconds=0.0,
            certified=int(solver == "surface_enclosure"),
            witness_source=[1.0, 0, 0],
            witness_target=[1.5, 0, 0],
        )
    file.models[0] |= {"polynomial": "x^2 + y^2 + z^2 - 1", "box": BOX}
    file.models[1] |= {"polynomial": "x^2 + y^2 + z^2 - 9/4", "box": BOX}
    file.write(tmp_path)
    assert main([file.stem, "--results", str(tmp_path), "--out", str(tmp_path)]) == 0
    held = {r["solver"]: r["holds"] for r in records(tmp_path, file.stem)}
    assert held == {"interval_subdivision": "0", "surface_enclosure": "1"}
    text = (tmp_path / "tables" / f"{file.stem}.md").read_text(encoding="utf-8")
    assert (
        "(unsound)" in text
        and "The interval holds the distance. Here it does not hold (so for 0 of 1 intervals)"
        in text
    )


@pytest.mark.parametrize(
    ("changed", "outcome"),
    [
        ({}, HOLDS),
        ({"upper": 0.45}, FAILS),
        ({"status": "timeout", "lower": float("nan"), "upper": float("nan")}, UNTESTED),
    ],
)
def test_gallery_judges_the_published_intervals(
    tmp_path: Path, changed: dict[str, Any], outcome: str
) -> None:
    file = ResultFile("surfaces_gallery")
    published: dict[str, Any] = {"lower": 0.4, "upper": 0.6, **changed}
    file.case("interval_subdivision", "spheres", [0.1], exact=0.5, **published)
    file.case("surface_enclosure", "spheres", [0.1], exact=0.5, lower=0.9, upper=1.0)
    assert surfaces_gallery.holds_distance(load(file.write(tmp_path))).outcome == outcome


def test_kept_voxels_cover_the_surface() -> None:
    surface = surfaces_gallery.Surface("(x - 1/2)^2*2 + y^2 - -z^2 - 1", np.array(BOX))
    kept = surface.kept(16)
    angles = np.random.default_rng(5).uniform(0, 2 * np.pi, (500, 2))
    points = np.stack(
        [
            0.5 + np.sqrt(0.5) * np.cos(angles[:, 0]),
            np.sin(angles[:, 0]) * np.cos(angles[:, 1]),
            np.sin(angles[:, 0]) * np.sin(angles[:, 1]),
        ]
    )
    assert kept[tuple(np.floor((points + 2) * 4).astype(int))].all()
    assert (
        not kept[0, 0, 0] and not kept[10, 8, 8]
    )  # a corner of the grid, and the inside of the body
