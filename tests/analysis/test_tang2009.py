"""Figures and tables of Tang et al. 2009, on files with known numbers; verdicts in each of their
outcomes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import pytest
import synthetic_tang
from stem_runner import TETRAHEDRON, Make, stem_runner
from synthetic import ResultFile
from synthetic_tang import motion

from analysis.shared import load
from analysis.shared.stems import ANALYSIS, drawn_with, named_in, results_of
from analysis.tang2009 import tang_pictures

PAIRS = tuple(f"pair {i}" for i in range(6))
COLD = ("tang", "cover")
ALL = ("tang", "tang, warm", "cover", "cover, warm")


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


def test_table2_cells(make: Make) -> None:
    records, rows, text = make(synthetic_tang.table2())
    mean = 1e3 * sum(1e-3 / (2.1 - 0.1 * i) for i in range(21)) / 21
    tang = rows["Bird1/Bird2"][0]
    assert tang[:3] == ["Tang 2009", "1,000 / 2,000", "21"]
    assert tang[3].startswith(f"{mean:.2f} [") and tang[4:6] == ["0.476", "10.0"]
    assert tang[6:] == [
        "99.00",
        "98.00",
        "5",
        "954.5",
    ]  # culled on A and on B, depth, and the median number of queries over all poses but the first
    by_label = {row[0]: row for row in rows[""]}
    assert by_label["paper"][3:] == [
        "84.31",
        "0.04",
        "670.6",
        "98.03",
        "99.99",
        "—",
        "—",
    ]  # the paper's values for Dog/Lion
    assert by_label["cover, warm"][6:9] == ["—"] * 3
    assert len(records) == 3 * 4 * 21 and "two stand in" in text


def test_table2_where_a_pose_failed(make: Make) -> None:
    file = motion("tang2009_table2", PAIRS, ALL)
    file.cases[5].update(status="timeout", lower=float("nan"), upper=float("nan"))
    _, rows, text = make(file)
    assert rows["pair 0"][0][3] == "1 of 21 poses failed"
    assert "over 5 independent runs" in claim(text, "The nearer the models")
    assert claim(text, "Tang 2009, warm").startswith(": not tested") or claim(
        text, "Tang 2009, warm"
    ).startswith(": not separated")


@pytest.mark.parametrize(
    ("left", "a", "b"),
    [
        (0.004, "holds", "holds"),
        (0.007, "holds", "does not hold"),
        (0.02, "does not hold", "does not hold"),
    ],
)
def test_culling(make: Make, left: float, a: str, b: str) -> None:
    _, _, text = make(motion("tang2009_table2", PAIRS, ALL, left=left))
    assert claim(text, "99 % of A").startswith(f" it {a}")
    assert claim(text, "99 % of B").startswith(f" it {b}")


def test_culling_that_nobody_tells(make: Make) -> None:
    file = motion("tang2009_table2", PAIRS, ALL)
    for case in file.cases:
        case["extras"] = "{}"
    _, _, text = make(file)
    assert claim(text, "99 % of A").startswith(": not tested")


@pytest.mark.parametrize(
    ("poses", "outcome"), [(range(10), " it holds"), (range(12), " it does not hold")]
)
def test_depth_is_typical(make: Make, poses: range, outcome: str) -> None:
    """The depth is 10 at `poses` and smaller at the rest of the 21 poses; the claim is about the
    median."""
    file = motion("tang2009_table2", PAIRS, ALL)
    for case in file.cases:
        if case["label"] == "tang" and case["pose_index"] in poses:
            case["extras"] = synthetic_tang.told(0.99, 0.99, 10)
    _, _, text = make(file)
    assert claim(text, "fewer than ten times").startswith(outcome)


@pytest.mark.parametrize(("wall", "outcome"), [(1.0, " it holds"), (1e6, " it does not hold")])
def test_a_fraction_of_a_second(make: Make, wall: float, outcome: str) -> None:
    file = motion("tang2009_table2", PAIRS, ALL)
    for row in [*file.repeats, *file.answers]:
        for column in ("wall_seconds", "cpu_seconds"):
            row[column] *= wall
    text = make(file)[2]
    assert claim(text, "less than a second, on average").startswith(outcome) and claim(
        text, "less than a second at the slowest pose"
    ).startswith(outcome)
    assert claim(text, "less than 1/30 s").startswith(outcome)


@pytest.mark.parametrize(
    ("seconds", "average", "slowest"),
    [
        (0.5, " it does not hold", " it holds"),
        (2.0, " it does not hold", " it does not hold"),
        (0.02, " it holds", " it holds"),
    ],
)
def test_a_slow_pose_is_looked_at_on_its_own(
    make: Make, seconds: float, average: str, slowest: str
) -> None:
    """The first pose of every pair takes `seconds`. The others take 0.05 s, or 0.01 s if the first
    is fast."""
    file = motion("tang2009_table2", PAIRS, ALL)
    for row in [*file.repeats, *file.answers]:
        first = file.cases[row["case"]]["pose_index"] == 0
        for column in ("wall_seconds", "cpu_seconds"):
            row[column] = (seconds if first else 0.01 if seconds < 0.1 else 0.05) * (
                1 + 1e-3 * row["round"]
            )
    text = make(file)[2]
    assert claim(text, "less than a second at the slowest pose").startswith(slowest) and claim(
        text, "less than 1/30 s"
    ).startswith(average)
    assert claim(text, "less than a second, on average").startswith(" it holds")


@pytest.mark.parametrize(
    ("changed", "outcome"),
    [
        ({}, " it holds (so for 126 of 126 poses)"),
        ({"upper": 9.0}, " it does not hold (so for 125 of 126 poses)"),
        ({"status": "floor"}, " it does not hold (so for 12"),
        ({"status": "timeout"}, ": not separated (so for 125 of 125 poses out of 126)"),
    ],
)
def test_bounds_are_within_the_tolerance(make: Make, changed: dict[str, Any], outcome: str) -> None:
    file = motion("tang2009_table2", PAIRS, ALL)
    next(case for case in file.cases if case["label"] == "tang" and case["pose_index"] == 3).update(
        changed
    )
    assert claim(make(file)[2], "differ by at most the tolerance").startswith(outcome)


@pytest.mark.parametrize(
    ("left", "count", "deepest", "outcome"),
    [
        (0.005, 1000, 5, " it holds"),  # only 0.5 % of the triangles are left to subdivide
        (0.5, 20, 5, " it holds"),
        (0.5, 300, 1, " it does not hold"),
        (0.5, 300, 5, ": not separated"),
        (None, 20, 5, ": not tested"),
    ],
)
def test_few_triangles_are_subdivided(
    make: Make, left: float | None, count: int, deepest: int, outcome: str
) -> None:
    """A has 1,000 triangles. At depth 1, 300 subdivisions cut 300 triangles; at depth 5, perhaps a
    single one."""
    file = motion("tang2009_table2", PAIRS, ALL)
    for case in file.cases:
        if case["label"] == "tang":
            case |= {
                "counter_subdivisions": count,
                "extras": synthetic_tang.told(1 - left, 0.9, deepest) if left is not None else "{}",
            }
    assert claim(make(file)[2], "Fewer than 1 % of the triangles").startswith(outcome)


@pytest.mark.parametrize(
    ("slower", "outcome"),
    [(1.0, " it holds"), (-1.0, " it does not hold"), (0.0, ": not separated")],
)
def test_time_rises(make: Make, slower: float, outcome: str) -> None:
    for stem in ("tang2009_table2", "tang2009_fig9"):
        _, _, text = make(motion(stem, PAIRS, ALL if stem.endswith("2") else COLD, slower=slower))
        assert claim(text, "The nearer the models").startswith(outcome)
        assert f"in distances it {outcome.strip(': ').removeprefix('it ')}" in claim(
            text, "The nearer the models"
        ).replace("it is not", "it not")


@pytest.mark.parametrize(
    ("queries", "outcome"), [(0.5, " it holds"), (0.66, " it holds"), (0.7, " it does not hold")]
)
def test_a_warm_start_pays(make: Make, queries: float, outcome: str) -> None:
    _, _, text = make(motion("tang2009_table2", PAIRS, ALL, queries=queries))
    for solver in ("Tang 2009", "cover (ours)"):
        assert claim(text, f"{solver}, warm").startswith(outcome)


def test_a_warm_start_that_was_not_run(make: Make) -> None:
    _, _, text = make(motion("tang2009_table2", PAIRS, COLD))
    assert claim(text, "Tang 2009, warm").startswith(": not tested")


def test_fig9_stages(make: Make) -> None:
    records, rows, _ = make(synthetic_tang.fig9())
    assert rows["Puma1/Puma2, all poses"][0][3:6] == ["25.0", "25.0", "50.0"]
    assert rows["Watch1/Watch2, nearest tenth"][0][1:3] == ["2", "10.0 to 20.0"]
    assert rows["Watch1/Watch2, nearest tenth"][0][6:] == [
        "15.0",
        "7.50",
    ]  # 2 ms / 0.1 and 2 ms / 0.2, halved
    assert len(records) == 42
    assert float(records[20]["subdivide"]) == pytest.approx(
        0.01
    )  # the sum over both directions: each takes half of 10 ms


@pytest.mark.parametrize(
    ("tang", "rounds", "tenth", "less"),
    [
        (0.005, 7, " it holds", " it holds"),
        (0.02, 7, " it does not hold", " it holds"),
        (0.2, 7, " it does not hold", " it does not hold"),
        (0.005, 3, " it holds", " it holds"),
    ],
)
def test_fig10_an_order_of_magnitude(
    make: Make, tang: float, rounds: int, tenth: str, less: str
) -> None:
    _, rows, text = make(synthetic_tang.fig10(tang, rounds=rounds))
    assert claim(text, "less than a tenth").startswith(tenth)
    assert claim(text, "takes less time than Guthe's on average there").startswith(less)
    assert "over 2 pairs" in claim(text, "less than a tenth")  # the distant pair is not counted
    assert rows["near"][0][1] == "2.00"


def test_fig10_counts_work(make: Make) -> None:
    assert "in distances it holds" in claim(
        make(synthetic_tang.fig10(work=50))[2], "less than a tenth"
    ).replace("Counted in", "in")
    assert "in distances it does not hold" in claim(
        make(synthetic_tang.fig10(work=200))[2], "less than a tenth"
    ).replace("Counted in", "in")


@pytest.mark.parametrize(
    ("peak", "outcome"), [(2**21, " it holds"), (2**23, " it does not hold")]
)
def test_fig10_compares_memory(make: Make, peak: int, outcome: str) -> None:
    file = synthetic_tang.fig10()
    for case in file.cases:
        if case["label"] == "tang":
            case["peak_bytes"] = peak
    assert claim(make(file)[2], "less memory").startswith(outcome)


@pytest.mark.parametrize(
    ("cuts", "outcome"),
    [(5, " it holds"), (10, ": not separated"), (20, " it does not hold"), (0, ": not tested")],
)
def test_fig10_counts_subdivisions(make: Make, cuts: int, outcome: str) -> None:
    assert claim(make(synthetic_tang.fig10(cuts=cuts))[2], "subdivides fewer triangles").startswith(
        outcome
    )


@pytest.mark.parametrize(
    ("guthe", "outcome"),
    [
        (150.0, " it holds"),
        (0.5, " it does not hold"),
        (100.0, ": not separated"),
        (None, ": not tested"),
    ],
)
def test_fig10_looks_at_guthes_own_time(make: Make, guthe: float | None, outcome: str) -> None:
    """On every pair, Guthe takes `guthe` * 0.1 s."""
    file = synthetic_tang.fig10()
    for row in file.answers:
        case = file.cases[row["case"]]
        if case["label"] == "guthe" and guthe:
            row["cpu_seconds"] = 0.1 * guthe * (1 + 0.01 * (row["round"] - 3))
    for case in file.cases:
        if case["label"] == "guthe" and guthe is None:
            case.update(status="timeout", lower=float("nan"), upper=float("nan"))
    assert claim(make(file)[2], "takes ten seconds or more").startswith(outcome)


@pytest.mark.parametrize(
    ("midpoint", "lemma4", "cuts", "saved"),
    [
        (2.0, 50, " it holds", " it holds"),
        (0.5, 200, " it does not hold", " it does not hold"),
        (1.0, 100, ": not separated", ": not separated"),
        (2.0, None, " it holds", ": not tested"),
    ],
)
def test_ablation_counts_subdivisions(
    make: Make, midpoint: float, lemma4: int | None, cuts: str, saved: str
) -> None:
    """At each pose, the plain algorithm makes 100 subdivisions, and with Lemma 4 `lemma4`."""
    file = synthetic_tang.ablation(midpoint)
    for scene in ("Puma1/Puma2", "bear, half"):
        for i in range(5 if lemma4 else 0):
            file.case(
                "tang",
                scene,
                [1e-3],
                label="tang, Lemma 4",
                tolerance=1e-4,
                tolerance_of="longest",
                pose_index=i,
                lower=0.1,
                upper=0.1,
                quantity="symmetric",
                pose=[1.0, 0, 0, 0, 1, 0, 0, 0, 1, float(i), 0, 0],
                counters={"subdivisions": lemma4 or 0},
                prepare_seconds=0.0,
            )
    text = make(file)[2]
    assert claim(text, "makes fewer subdivisions").startswith(cuts) and claim(
        text, "Lemma 4 saves"
    ).startswith(saved)


@pytest.mark.parametrize(
    ("coarse", "outcome"), [(1, " it holds"), (2, ": not separated"), (3, " it does not hold")]
)
def test_depth_is_sensitive_to_the_tolerance(make: Make, coarse: int, outcome: str) -> None:
    assert claim(
        make(synthetic_tang.ablation(coarse=coarse))[2], "the deeper a triangle is subdivided"
    ).startswith(outcome)


def test_fig10_where_one_timed_out(make: Make) -> None:
    _, rows, text = make(synthetic_tang.fig10(far=True))
    assert "timeout" in rows["nearer"][0]
    assert claim(text, "less than a tenth").startswith(": not judged (n = 1; ")


@pytest.mark.parametrize(
    ("midpoint", "outcome"),
    [(2.0, " it holds"), (0.5, " it does not hold"), (1.0, ": not separated")],
)
def test_ablation_claims(make: Make, midpoint: float, outcome: str) -> None:
    _, rows, text = make(synthetic_tang.ablation(midpoint))
    assert claim(text, "Voronoi subdivision takes").startswith(outcome)
    word = {
        " it holds": "it holds",
        " it does not hold": "it does not hold",
        ": not separated": "it is not separated",
    }[outcome]
    assert f"Counted in subdivisions {word}" in claim(text, "Voronoi subdivision takes")
    assert claim(text, "three corners").startswith(
        ": not separated"
    )  # twice as fast on one pair, half as fast on the other
    assert rows["Puma1/Puma2"][0][:6] == ["Tang 2009", "0.001", "2.50", "250", "2,500", "1"]
    warm = [row for row in rows[""] if row[0] == "tang, warm"]
    assert all(row[2:] == ["—"] * 8 for row in warm) and len(warm) == 2


def test_every_stem_has_a_file() -> None:
    for stem, file in synthetic_tang.STEMS.items():
        assert isinstance(made := file(), ResultFile) and made.stem == stem


@pytest.mark.usefixtures("tetrahedra")
def test_pictures(make: Make) -> None:
    records, rows, _ = make(synthetic_tang.pictures("tang2009_fig7", ("cover",)))
    assert rows["Bird1"][0] == [
        "Bird1/Bird2/A",
        "4",
        "2.2K",
        "[200.00, 200.00]",
    ]  # 1.5 is 200 % of the longest side, 0.75
    assert rows["Lion"][0][2:] == ["1.3M", ""] and len(records) == 4
    records, rows, _ = make(synthetic_tang.pictures("tang2009_fig8"))
    assert (
        rows["Bird1/Bird2"][0] == ["Tang 2009", "200.0000", "200.0000", "B to A"]
        and len(records) == 4
    )


@pytest.mark.usefixtures("tetrahedra")
def test_the_witness_is_drawn_where_it_is(tmp_path: Path) -> None:
    results = load.load(synthetic_tang.pictures("tang2009_fig8").write(tmp_path))
    figure, axes = plt.subplots(1, 2)
    for ax, row in zip(axes, (0, 2)):
        tang_pictures.draw_pair(ax, results, row)
    ends = tang_pictures.SIDE.seen(np.array([[0.25, 0.25, 0.0], [3.0, 0.25, 0.0]]))
    (line,) = axes[0].lines
    assert np.allclose(np.stack(line.get_data()).T, ends[:, :2])
    assert not axes[1].lines  # this pair's witness is unknown
    moved = tang_pictures.placed(results, "any", results.cases.pose[0]).corners
    assert np.allclose(moved, [[2, 0, 0], [3, 0, 0], [2, 1, 0], [2, 0, 1]])
    plt.close(figure)


def test_similarity_table(make: Make) -> None:
    records, rows, text = make(synthetic_tang.similarity())
    assert (
        rows["bunny_open"][0][:3] == ["bunnies", "bunny_cgal", "1.05"]
        and rows["bunny_open"][0][-1] == "yes"
    )
    assert len(records) == 144 and "6 of 6 families, 12 of 12 shapes" in text


@pytest.mark.parametrize(
    ("alike", "outcome"), [(6, " it holds"), (3, ": not separated"), (0, " it does not hold")]
)
def test_similarity_finds_families(make: Make, alike: int, outcome: str) -> None:
    assert claim(make(synthetic_tang.similarity(alike=alike))[2], "for most families").startswith(
        outcome
    )


@pytest.mark.parametrize(
    ("skew", "outcome"), [(0.0, " it holds"), (0.0005, " it holds"), (0.01, " it does not hold")]
)
def test_similarity_is_symmetric(make: Make, skew: float, outcome: str) -> None:
    assert claim(
        make(synthetic_tang.similarity(skew=skew))[2], "intervals of H(A, B) and of H(B, A)"
    ).startswith(outcome)


@pytest.mark.parametrize(("far", "outcome"), [(0.0, " it holds"), (0.2, " it does not hold")])
def test_similarity_is_a_distance(make: Make, far: float, outcome: str) -> None:
    assert claim(make(synthetic_tang.similarity(far=far))[2], "triangle inequality").startswith(
        outcome
    )


def test_similarity_with_a_missing_answer(make: Make) -> None:
    file = synthetic_tang.similarity()
    file.cases[1].update(status="timeout", lower=float("nan"), upper=float("nan"))
    text = make(file)[2]
    assert claim(text, "intervals of H(A, B)").startswith(": not separated")
    assert claim(text, "for most families").startswith(": not tested")


LESS = "takes less counted work than the full matrix"
SAME = "finds the shape that the full matrix has nearest"


def test_nearest_table(make: Make, tmp_path: Path) -> None:
    synthetic_tang.similarity().write(tmp_path)
    records, rows, text = make(synthetic_tang.nearest())
    shape, *cells = next(row for row in rows[""] if row[0] == "queen")
    assert cells[:4] == ["king", "1.05", "yes", "8 of 11"] and shape == "queen"
    assert cells[4:] == ["11,000", "3,800", "2.89", "16,500", "5,300", "3.11"]
    whole = next(row for row in rows[""] if row[0] == "all shapes")
    cut_off = sum(int(record["cut_off"]) for record in records)
    assert (
        whole[3:5] == ["12 of 12", f"{cut_off} of 132"]
        and whole[5] == "132,000"
        and whole[6] == f"{132_000 - 900 * cut_off:,}"
    )
    assert whole[8:10] == ["198,000", f"{198_000 - 1400 * cut_off:,}"] and len(records) == 12
    assert claim(text, LESS).startswith(
        " it holds (above 1 for 12 of 12 shapes"
    ) and "Counted in distances it holds" in claim(text, LESS)
    assert claim(text, SAME).startswith(" it holds (so for 12 of 12 shapes)")


@pytest.mark.parametrize(
    ("changed", "outcome"),
    [({}, " it holds"), ({"slow": (3,)}, " it does not hold"), ({"work": 1500}, ": not separated")],
)
def test_nearest_takes_less_work(
    make: Make, tmp_path: Path, changed: dict[str, Any], outcome: str
) -> None:
    synthetic_tang.similarity().write(tmp_path)
    assert claim(make(synthetic_tang.nearest(**changed))[2], LESS).startswith(outcome)


@pytest.mark.parametrize(("wrong", "outcome"), [((), " it holds"), ((2,), " it does not hold")])
def test_nearest_finds_the_same(
    make: Make, tmp_path: Path, wrong: tuple[int, ...], outcome: str
) -> None:
    synthetic_tang.similarity().write(tmp_path)
    assert claim(make(synthetic_tang.nearest(wrong=wrong))[2], SAME).startswith(outcome)


def test_nearest_with_two_that_are_too_close_to_tell(make: Make, tmp_path: Path) -> None:
    matrix = synthetic_tang.similarity()
    near = next(
        row
        for row in matrix.cases
        if row["source"] == "king_centred" and row["target"] == "bunny_cgal_centred"
    )
    near.update(lower=0.0095, upper=0.0105)  # overlaps the queen's interval, 0.01 to 0.011
    matrix.write(tmp_path)
    _, rows, text = make(synthetic_tang.nearest())
    assert claim(text, SAME).startswith(": not separated (so for 11 of 11 shapes out of 12)")
    assert next(row for row in rows[""] if row[0] == "king")[1:4] == ["queen", "1.05", "—"]


def test_the_makefile_measures_first_whatever_a_script_reads_beside_its_own_results() -> None:
    makefile = (ANALYSIS.parent / "Makefile").read_text(encoding="utf-8")
    reading = {file.stem: stems for file in ANALYSIS.rglob("*.py") if (stems := named_in(file)[1:])}
    assert reading == {"tang2009_nearest": ["tang2009_similarity"]}
    for stem, stems in reading.items():
        assert (
            f"\n{stem}: {' '.join(stems)}\n" in makefile
            and results_of(stem) == stem
            and drawn_with(stem) == [stem]
        )


def test_nearest_without_the_matrix_or_an_answer(make: Make, tmp_path: Path) -> None:
    _, rows, text = make(synthetic_tang.nearest())
    assert claim(text, LESS).startswith(": not tested") and claim(text, SAME).startswith(
        ": not tested"
    )
    assert "No matrix to compare with" in text and "make tang2009_similarity" in text
    synthetic_tang.similarity().write(tmp_path)
    file = synthetic_tang.nearest()
    file.cases[1].update(
        status="timeout", reason="20 s", answer="", lower=float("nan"), upper=float("nan")
    )
    _, rows, text = make(file)
    assert claim(text, LESS).startswith(
        ": not separated (above 1 for 11 of 11 shapes, no ratio for 1"
    )
    assert claim(text, SAME).startswith(": not separated (so for 11 of 11 shapes out of 12)")
    assert rows["cover (ours)"][0][4].endswith(", 1 failed")
    # A matrix of other shapes with the same names must not be used.
    matrix = synthetic_tang.similarity()
    for model in matrix.models:
        model["sha256"] = "another"
    matrix.write(tmp_path)
    assert claim(make(synthetic_tang.nearest())[2], LESS).startswith(": not tested")


@pytest.mark.usefixtures("tetrahedra")
def test_depths_cells(make: Make) -> None:
    records, rows, text = make(synthetic_tang.depths())
    assert rows["Alphabet Domino"][0][:7] == [
        "Tang 2009",
        "30",
        "2.00",
        "1.00",
        "1.00",
        "1.00",
        "20.0",
    ]
    cover = next(row for row in rows[""] if row[0] == "cover (ours)")
    # two pairs per frame; odd frames take a tenth more
    assert (
        cover[7].startswith("10.0 [")
        and cover[8].startswith("0.210 [")
        and cover[9].startswith("10.2 [")
    )
    assert [row[-1] for row in rows[""] if row[0] == "paper"] == ["0.97", "3.88"]
    frames = {record["frame"] for record in records}
    assert len(records) == 2 * 2 * 60 and frames == {str(frame) for frame in range(30)}
    assert claim(text, "Every pair that overlaps").startswith(" it holds") and claim(
        text, "have a number in common"
    ).startswith(" it holds")


@pytest.mark.usefixtures("tetrahedra")
@pytest.mark.parametrize(
    ("cover", "frames", "domino", "bunnies"),
    [
        (1e-4, 30, " it holds", " it holds"),
        (4.62e-4, 30, ": not separated", " it holds"),
        (1e-3, 30, " it does not hold", " it holds"),
        (4e-3, 30, " it does not hold", " it does not hold"),
        (1e-4, 15, ": not judged (n = 15 frames; ", ": not judged (n = 15 frames; "),
    ],
)
def test_time_of_measuring_depths(
    make: Make, cover: float, frames: int, domino: str, bunnies: str
) -> None:
    _, _, text = make(synthetic_tang.depths(cover=cover, frames=frames))
    for scene, outcome in (("Alphabet Domino", domino), ("Falling Bunnies", bunnies)):
        assert claim(
            text,
            f"Measuring the depths of a frame of {scene} takes less than Tang et al.'s {'0.97' if 'Domino' in scene else '3.88'} ms on average, by cover",
        ).startswith(outcome)
    for by, paper in (("Tang 2009", "the paper's"), ("cover", "Tang et al.'s")):
        assert claim(
            text,
            f"With CGAL's cutting a frame of Alphabet Domino takes less than {paper} 0.97 ms on average, by {by}",
        ).startswith(" it does not hold" if frames == 30 else ": not")


@pytest.mark.usefixtures("tetrahedra")
@pytest.mark.parametrize(
    ("cover", "frames", "outcome"),
    [
        (2e-3, 30, " it holds"),
        (2.381e-3, 30, ": not separated"),
        (3e-3, 30, " it does not hold"),
        (2e-3, 15, ": not judged"),
    ],
)
def test_measuring_takes_a_few_milliseconds(
    make: Make, cover: float, frames: int, outcome: str
) -> None:
    """Tang takes twice `cover` per pair. A frame has two pairs, and odd frames take a tenth
    more."""
    text = make(synthetic_tang.depths(cover=cover, frames=frames))[2]
    for scene in ("Alphabet Domino", "Falling Bunnies"):
        assert claim(
            text, f"{scene}: Measuring the depths of a frame takes less than 10 ms"
        ).startswith(outcome)


@pytest.mark.usefixtures("tetrahedra")
def test_depths_that_failed_or_disagree(make: Make) -> None:
    _, rows, text = make(synthetic_tang.depths(failed=3))
    assert next(row for row in rows[""] if row[0] == "cover (ours)")[2] == "3 of 60 pairs failed"
    assert claim(text, "Every pair that overlaps").startswith(
        " it does not hold (so for 237 of 240"
    )
    assert claim(
        text,
        "Measuring the depths of a frame of Alphabet Domino takes less than Tang et al.'s 0.97 ms on average, by cover",
    ).startswith(": not tested")
    assert claim(text, "have a number in common").startswith(": not separated")
    assert claim(
        make(synthetic_tang.depths(tang_lower=0.011))[2], "have a number in common"
    ).startswith(" it does not hold (so for 0 of 120")


@pytest.mark.usefixtures("tetrahedra")
def test_fig1_takes_the_deepest_pair_of_the_frame(make: Make) -> None:
    records, rows, text = make(synthetic_tang.fig1())
    assert rows["Falling Bunnies"] == [
        ["cover, depth", "depth, frame 24", "2 of 3", "10.00000", "10.00001"]
    ]
    assert rows["Bird1/Bird2"][0] == ["Tang 2009", "H", "1 of 1", "75.00000", "75.00000"]
    assert len(records) == 5 and "two stand in" in text


@pytest.mark.parametrize(
    ("scene", "note", "shapes", "second"),
    [
        (
            "Puma1/Puma2",
            "a dinosaur and a horse stand in",
            ["stand-in: dinosaur", "stand-in: horse"],
            "(stand-ins: dinosaur, horse)",
        ),
        (
            "Dog/Lion",
            "a bison and a dragon of 47,794 triangles stand in",
            ["stand-in: bison", "stand-in: dragon"],
            "(stand-ins: bison, dragon)",
        ),
        (
            "Bunny1/Bunny2",
            "Bunny2 by its count; Bunny1 is Bunny2 simplified",
            ["Bunny2 simplified", ""],
            "(Bunny1: Bunny2 simplified)",
        ),
        ("bear, half", "not in the paper: a bear and the same", ["", ""], "(not in the paper)"),
        ("bear, half", "", ["", ""], ""),
    ],
)
def test_titles_name_what_stands_in(
    tmp_path: Path, scene: str, note: str, shapes: list[str], second: str
) -> None:
    file = ResultFile("tang2009_fig9")
    file.case(
        "tang",
        scene,
        [0.1],
        lower=1.0,
        upper=1.0,
        scene_note=note,
        source_elements=4,
        target_elements=5,
    )
    results = load.load(file.write(tmp_path))
    assert tang_pictures.stand_ins(results, 0) == shapes
    assert tang_pictures.short_title(results, 0) == f"{scene}, 4 / 5" + (
        f"\n{second}" if second else ""
    )


def test_near_points_are_one_part() -> None:
    points = np.array([[0.0, 0, 0], [0.9, 0, 0], [1.8, 0, 0], [3.0, 0, 0], [3.5, 0, 0]])
    assert list(tang_pictures.connected(points, 1.0)) == [0, 0, 0, 1, 1] and list(
        tang_pictures.connected(points, 0.1)
    ) == [0, 1, 2, 3, 4]


def test_points_inside() -> None:
    points = np.array(
        [[0.1, 0.1, 0.1], [0.4, 0.4, 0.4], [-0.1, 0.1, 0.1], [0.3, 0.3, 0.3], [5, 5, 5]]
    )
    assert list(tang_pictures.inside(TETRAHEDRON, points)) == [True, False, False, True, False]


def test_pieces_make_up_the_triangles() -> None:
    whole, cut = TETRAHEDRON, tang_pictures.pieces(TETRAHEDRON, 0.3)
    area = [
        np.linalg.norm(
            np.cross(
                m.corners[m.triangles[:, 1]] - m.corners[m.triangles[:, 0]],
                m.corners[m.triangles[:, 2]] - m.corners[m.triangles[:, 0]],
            ),
            axis=1,
        ).sum()
        for m in (whole, cut)
    ]
    sides = cut.corners[cut.triangles]
    assert (
        area[0] == pytest.approx(area[1])
        and np.linalg.norm(sides - np.roll(sides, 1, axis=1), axis=2).max() <= 0.3
    )
