"""`measure --picture`: A coloured by its distance to B, and a histogram with its band."""

from __future__ import annotations

import json
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pytest
from program import Program

from analysis import picture
from analysis.shared.shapes import Coloured


@pytest.mark.parametrize("extension", ["png", "pdf", "svg"])
def test_measure_draws_a_picture(
    hausbench: Program, tetrahedron: Path, raised: Path, tmp_path: Path, extension: str
) -> None:
    out = tmp_path / f"out.{extension}"
    plain = hausbench("measure", tetrahedron, raised)
    done = hausbench("measure", tetrahedron, raised, "--picture", out)
    assert done.returncode == 0 and done.stderr == ""
    assert (
        plain.stdout.split("time ")[0] == done.stdout.split("time ")[0]
    )  # the same answer is printed
    if extension == "png":
        drawn = plt.imread(out)
        assert (
            drawn.shape[0] > 300 and len(np.unique(drawn.reshape(-1, drawn.shape[2]), axis=0)) > 50
        )
    else:
        assert out.stat().st_size > 5000


def test_json_and_fields_go_together_with_a_picture(
    hausbench: Program, tetrahedron: Path, raised: Path, tmp_path: Path
) -> None:
    out, fields = tmp_path / "out.svg", tmp_path / "a.ply"
    done = hausbench(
        "measure",
        tetrahedron,
        raised,
        "--json",
        "--symmetric",
        "--fields",
        fields,
        "--picture",
        out,
    )
    assert done.returncode == 0 and json.loads(done.stdout)["directions"]
    assert (
        json.loads(done.stdout)["fields"][0]["file"] == str(fields)
        and fields.exists()
        and out.exists()
    )
    alone = json.loads(hausbench("measure", tetrahedron, raised, "--json", "--picture", out).stdout)
    assert (
        alone["fields"] == []
        and alone["upper"]
        == json.loads(hausbench("measure", tetrahedron, raised, "--json").stdout)["upper"]
    )


SQUARE = "OFF\n4 2 0\n0 0 {0}\n1 0 {0}\n1 1 {0}\n0 1 {0}\n3 0 1 2\n3 0 2 3\n"


def test_names_units_and_shapes_that_are_hard_to_draw(hausbench: Program, tmp_path: Path) -> None:
    flat, above = tmp_path / "a$_$.off", tmp_path / "cost_$5_vs_$6{.off"
    flat.write_text(SQUARE.format(0))
    above.write_text(SQUARE.format(0.1))
    assert hausbench("measure", flat, above, "--picture", tmp_path / "names.png").returncode == 0
    point, origin = tmp_path / "one.xyz", tmp_path / "origin.xyz"
    point.write_text("1 2 3\n")
    origin.write_text("0 0 0\n")
    done = hausbench("measure", point, origin, "--picture", tmp_path / "one.png")
    assert done.returncode == 0 and done.stderr == ""
    for length in ("1e-322", "1e308"):
        point.write_text(f"{length} 0 0\n0 {length} 0\n")
        done = hausbench("measure", point, origin, "--picture", tmp_path / "far.png")
        assert (
            done.returncode == 2
            and "another unit" in done.stderr
            and not (tmp_path / "far.png").exists()
        )
        assert "h(A,B)" in done.stdout  # the answer is there


def test_names_may_begin_with_a_dash(
    hausbench: Program, tetrahedron: Path, raised: Path, tmp_path: Path
) -> None:
    (tmp_path / "-a.off").write_bytes(tetrahedron.read_bytes())
    assert (
        hausbench("measure", "--picture", "-p.png", "--", "-a.off", raised).returncode == 0
        and (tmp_path / "-p.png").exists()
    )


def test_equal_distances_fill_one_bar(hausbench: Program, tmp_path: Path) -> None:
    """If all points of A, or a third of them, are equally far from B, the histogram has exactly
    this share in one bar."""
    a, b = tmp_path / "a.off", tmp_path / "b.off"
    a.write_text(SQUARE.format(0.1))
    b.write_text(SQUARE.format(0))
    shown = picture.histogram(hausbench.path, str(a), str(b), 0.1)
    assert shown.low[-1] == pytest.approx(1, abs=1e-9) and shown.high[:-1].max() < 1e-9
    a, b = tmp_path / "a.xyz", tmp_path / "b.xyz"
    a.write_text("".join(f"{x} 0 {z}\n" for x in range(20) for z in (1, 2, 3)))
    b.write_text("".join(f"{x} 0 0\n" for x in range(20)))
    shown = picture.histogram(hausbench.path, str(a), str(b), 3.0)
    assert (shown.high - shown.low).max() < 1e-9 and np.sort(shown.low)[-4:] == pytest.approx(
        [0, 1 / 3, 1 / 3, 1 / 3]
    )


def test_triangles_that_face_inward_are_turned_over() -> None:
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    triangles = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    assert (picture.outward(Coloured(corners, triangles, np.zeros(4))).triangles == triangles).all()
    assert (
        picture.outward(Coloured(corners, triangles[:, ::-1], np.zeros(4))).triangles == triangles
    ).all()


def test_identical_shapes_and_points_are_drawn(
    hausbench: Program, tetrahedron: Path, tmp_path: Path
) -> None:
    out, points = tmp_path / "out.png", tmp_path / "points.xyz"
    assert (
        hausbench("measure", tetrahedron, tetrahedron, "--picture", out).returncode == 0
        and out.exists()
    )
    points.write_text("0 0 0\n1 2 3\n4 4 4\n")
    cloud = tmp_path / "other.xyz"
    cloud.write_text("0 0 1\n1 2 2\n4 4 9\n")
    assert hausbench("measure", points, cloud, "--picture", tmp_path / "points.png").returncode == 0


def test_bands_contain_the_true_shares(hausbench: Program, tmp_path: Path) -> None:
    """A slanting square above a large one: the distance is uniform between 0 and 1, so each bar's
    share is its width."""
    a, b = tmp_path / "a.off", tmp_path / "b.off"
    a.write_text("OFF\n4 2 0\n0 0 0\n1 0 1\n1 1 1\n0 1 0\n3 0 1 2\n3 0 2 3\n")
    b.write_text("OFF\n4 2 0\n-5 -5 0\n5 -5 0\n5 5 0\n-5 5 0\n3 0 1 2\n3 0 2 3\n")
    shown = picture.histogram(hausbench.path, str(a), str(b), 1.0)
    shares = np.diff(np.minimum(shown.edges, 1.0), prepend=0.0)
    assert (
        (shown.low <= shares).all()
        and (shown.high >= shares).all()
        and (shown.high - shown.low < 0.02).all()
    )
    assert (
        shown.mean[0] <= 0.5 <= shown.mean[1] and shown.most_of_a[0] <= 0.95 <= shown.most_of_a[1]
    )


def test_a_limit_shows_nothing_that_is_not_known(hausbench: Program, tmp_path: Path) -> None:
    """Whatever the limit, all that is drawn is in [0, maximum], bars do not sum to more than 1 of
    what is certain, and lines are where they are known."""
    a, b, n = tmp_path / "a.off", tmp_path / "b.off", 40
    for file, wave in ((a, 5.0), (b, 7.0)):
        x, y = np.meshgrid(*2 * [np.linspace(0, 1, n)])
        corner = np.arange(n * n).reshape(n, n)[:-1, :-1].ravel()
        faces = np.concatenate(
            [
                np.stack([corner, corner + 1, corner + n], 1),
                np.stack([corner + 1, corner + n + 1, corner + n], 1),
            ]
        )
        lines = [
            f"{p} {q} {0.2 * np.sin(wave * p) * np.cos(wave * q)}"
            for p, q in zip(x.ravel(), y.ravel())
        ]
        lines += [f"3 {i} {j} {k}" for i, j, k in faces]
        file.write_text("\n".join([f"OFF\n{n * n} {len(faces)} 0", *lines, ""]))
    upper = json.loads(hausbench("measure", a, b, "--json").stdout)["upper"]
    for limit in ("0", "0.1", "1", "1000"):
        shown = picture.histogram(hausbench.path, str(a), str(b), upper, [f"--time-limit={limit}"])
        assert (
            (0 <= shown.low).all()
            and (shown.low <= shown.high).all()
            and (shown.high <= 1).all()
            and shown.low.sum() <= 1
        )
        for low, high in (shown.mean, shown.most_of_a):
            assert 0 <= low <= high <= upper
    left_out = hausbench(
        "measure", a, b, "--picture", tmp_path / "out.png", "--time-limit", "0.001"
    )
    assert "without a histogram" in left_out.stderr or left_out.returncode == 1


def test_the_picture_reads_the_files_as_the_answer_does(hausbench: Program, tmp_path: Path) -> None:
    """With --unit, the histogram is about the converted shapes."""
    a, b, fields = tmp_path / "a.csv", tmp_path / "b.csv", tmp_path / "a.ply"
    a.write_text("x [cm],y [cm],z [cm]\n0,0,1\n0,5,3\n")
    b.write_text("x [mm],y [mm],z [mm]\n0,0,0\n0,50,0\n")
    done = hausbench(
        "measure", a, b, "--unit", "mm", "--picture", tmp_path / "out.png", "--fields", fields
    )
    assert (
        done.returncode == 0
        and done.stderr == ""
        and picture.read(fields).distances.tolist() == [10, 30]
    )
    shown = picture.histogram(hausbench.path, str(a), str(b), 30.0, ["--unit=mm"])
    assert shown.mean == pytest.approx((20, 20), abs=0.1)


@pytest.mark.parametrize(
    ("more", "said"),
    [
        (["--picture", "out.gif"], ".png, .pdf or .svg"),
        (["--picture", "nowhere/out.png"], "nowhere"),
        (["--picture", ""], "name a file"),
        (["--picture", "out.png", "--distribution"], "leave out --distribution"),
        (["--picture", "out.png", "--cutoff", "1"], "leave out --cutoff"),
        (["--picture", "out.png", "--fields", "a.vtk"], ".ply"),
        (["--picture", "out.png", "--solver", "none"], "none"),
        (["--picture", "out.png", "--resolution", "inf"], "leave out --resolution"),
        (["--picture", "out.svg", "--certificate", "out.svg"], "the same file"),
    ],
)
def test_what_cannot_be_drawn_is_refused(
    hausbench: Program, tetrahedron: Path, raised: Path, tmp_path: Path, more: list[str], said: str
) -> None:
    done = hausbench("measure", tetrahedron, raised, *more)
    assert done.returncode == 2 and said in done.stderr and not list(tmp_path.glob("out.*"))


def test_round_lengths() -> None:
    assert [picture.round_length(x) for x in (1.0, 0.99, 2.7, 7e-9, 4e300)] == [
        1.0,
        0.5,
        2.0,
        pytest.approx(5e-9),
        pytest.approx(2e300),
    ]
