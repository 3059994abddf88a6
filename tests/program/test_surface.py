"""Algebraic surfaces, from a text file to an answer or an error."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest

from program import Program

BOX = "[[-2, 2], [-2, 2], [-2, 2]]"


def surface(folder: Path, name: str, polynomial: str, box: str = BOX) -> Path:
    file = folder / f"{name}.surface.toml"
    file.write_text(f'polynomial = "{polynomial}"\nbox = {box}\n', encoding="utf-8")
    return file


def test_the_cones_of_the_paper(hausbench: Program, tmp_path: Path) -> None:
    first = surface(tmp_path, "first", "x^2/4 + y^2/4 - z^2/9")
    second = surface(tmp_path, "second", "x^2/16 + y^2/4 - z^2/9")
    done = hausbench(
        "measure", first, second, "--symmetric", "--tolerance", "1e-6", "--of", "absolute", "--json"
    )
    assert done.returncode == 0, done.stderr
    ours = json.loads(done.stdout)
    assert ours["solver"] == "surface_enclosure" and ours["status"] == "converged"
    assert ours["lower"] <= math.sqrt(43) / 3 - 4 / 3 <= ours["upper"] <= ours["lower"] + 1e-6
    assert [abs(x) for x in ours["target_point"]] == pytest.approx(
        [2, math.sqrt(7) / 3, 2], abs=1e-3
    )
    done = hausbench(
        "measure",
        first,
        second,
        "--symmetric",
        "--tolerance",
        "10",
        "--of",
        "absolute",
        "--json",
        "--solver",
        "interval_subdivision",
        "--set",
        "pairs=pruned",
    )
    published = json.loads(done.stdout)
    assert published["lower"] == pytest.approx(math.sqrt(17) / (4 * math.sqrt(2)), abs=1e-12)
    assert published["upper"] == pytest.approx(math.sqrt(103) / (8 * math.sqrt(2)), abs=1e-12)
    assert published["source_point"] is None
    assert "an algebraic surface" in hausbench("measure", first, second).stdout


@pytest.mark.parametrize(
    ("polynomial", "box", "words"),
    [
        ("x^2 + 4y", BOX, ("column 8", "4*x")),
        ("x^2 +", BOX, ("column 6", "ends")),
        ("7", BOX, ("constant",)),
        ("x", "[[-2, 2], [1, 1], [-2, 2]]", ("in y", "no volume")),
        ("x", "[[-2, 2], [-2, 2]]", ("box", "three pairs")),
        ("x^2 + 1", BOX, ("no point in its box",)),
        ("x - 5", BOX, ("no point in its box",)),
    ],
)
def test_what_is_no_surface(
    hausbench: Program, tmp_path: Path, polynomial: str, box: str, words: tuple[str, ...]
) -> None:
    wrong = surface(tmp_path, "wrong", polynomial, box)
    good = surface(tmp_path, "good", "x^2 + y^2 + z^2 - 1")
    for pair in ((wrong, good), (good, wrong)):
        said = hausbench.fails("measure", *pair)
        for word in words:
            assert word in said, said


def test_keys_and_kinds(hausbench: Program, tmp_path: Path, tetrahedron: Path) -> None:
    good = surface(tmp_path, "good", "x^2 + y^2 + z^2 - 1")
    extra = tmp_path / "extra.surface.toml"
    extra.write_text(good.read_text(encoding="utf-8") + "boxes = 1\n", encoding="utf-8")
    assert "boxes" in hausbench.fails("measure", extra, good) and "'box'" in hausbench.fails(
        "measure", extra, good
    )
    assert "takes no surface" in hausbench.fails("measure", good, tetrahedron)
    assert "triangulate" in hausbench.fails("export", good, tmp_path / "out.off")


def test_a_square_stalls_with_bounds(hausbench: Program, tmp_path: Path) -> None:
    square = surface(tmp_path, "square", "(x^2 + y^2 + z^2 - 1)^2")
    ball = surface(tmp_path, "ball", "x^2 + y^2 + z^2 - 9/4")
    done = hausbench("measure", square, ball, "--json")
    result = json.loads(done.stdout)
    assert result["status"] == "stalled" and result["lower"] <= 0.5 <= result["upper"] < 1


def test_a_sphere_a_million_from_the_origin(hausbench: Program, tmp_path: Path) -> None:
    here = surface(tmp_path, "here", "x^2 + y^2 + z^2 - 1")
    there = surface(
        tmp_path,
        "there",
        "x^2 - 2000000*x + y^2 + z^2 + 999999999999",
        "[[999998, 1000002], [-2, 2], [-2, 2]]",
    )
    done = hausbench("measure", here, there, "--tolerance", "1e-3", "--of", "absolute", "--json")
    assert done.returncode == 0, done.stderr
    answer = json.loads(done.stdout)
    assert answer["status"] == "converged" and answer["lower"] <= 1e6 <= answer["upper"]
