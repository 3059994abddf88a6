"""Each function of the package: right answers, options, and that no bound is a bare number."""

from __future__ import annotations

import copy
import hashlib
import math
import pickle
import re
import signal
import time
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any, Callable

import hausbench as hb
import numpy as np
import pytest
from sample_meshes import Mesh, sphere

if TYPE_CHECKING:
    from hausbench.typing import ShapeLike

UP = np.array([0, 0, 0.25])
QUARTER_TURN = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])


def raised(mesh: Mesh) -> Mesh:
    return mesh[0] + UP, mesh[1]


def distance(points: Any, targets: Any) -> float:
    """Returns h between two small point sets, by all pairs."""
    return float(np.sqrt(((points[:, None] - targets[None]) ** 2).sum(-1)).min(1).max())


def test_directed_and_symmetric_of_meshes(tetrahedron: Mesh) -> None:
    answer = hb.directed(tetrahedron, raised(tetrahedron))
    assert answer.interval.contains(0.25) and answer.interval.width <= 1e-6 * math.sqrt(3)
    assert answer.status == "converged" and answer.quantity == "h(A,B)"
    # Without its lower part the other way is shorter or equal; the apex is 0.25 above, over a
    # slope.
    both = hb.symmetric(tetrahedron, raised(tetrahedron))
    assert both.interval.contains(0.25) and both.quantity == "H(A,B)"


def test_directions_differ() -> None:
    near, far = np.zeros((1, 3)), np.array([[0, 0, 0], [0, 0, 5.0]])
    assert hb.directed(near, far).interval.upper < 1e-5
    assert hb.directed(far, near).interval.contains(5)
    answer = hb.symmetric(near, far)
    assert answer.interval.contains(5)
    assert answer.witness is not None and answer.witness.direction == "target_to_source"
    assert answer.witness.target_row == 1


@pytest.mark.parametrize("seed", range(8))
def test_points_against_all_pairs(seed: int) -> None:
    random = np.random.default_rng(seed)
    points, targets = random.normal(size=(200, 3)), random.normal(size=(150, 3))
    answer = hb.directed(points, targets)
    assert (
        answer.interval.lower - 1e-12 <= distance(points, targets) <= answer.interval.upper + 1e-12
    )
    witness = answer.witness
    assert witness is not None
    assert tuple(points[witness.source_row]) == pytest.approx(witness.source_point)
    assert tuple(targets[witness.target_row]) == pytest.approx(witness.target_point)


def test_the_same_bits_for_every_layout(small_sphere: Mesh) -> None:
    vertices, faces = small_sphere
    target = sphere(9, 0.1)
    expected = hb.directed(small_sphere, target).interval
    wide = np.zeros((len(vertices), 7))
    wide[:, 1:6:2] = vertices
    layouts: list[Any] = [
        np.asfortranarray(vertices),
        wide[:, 1:6:2],
        vertices[::-1].copy()[::-1],
        np.repeat(vertices, 2, axis=0)[::2],
        vertices[:, ::-1].copy()[:, ::-1],
        vertices.astype(">f8"),
        vertices.tolist(),
    ]
    for layout in layouts:
        assert hb.directed((layout, faces), target).interval == expected
    kinds: list[Any] = [np.int32, np.int64, np.int16, np.uint16, np.uint32, np.uint64, ">i4", ">i8"]
    for kind in kinds:
        assert hb.directed((vertices, faces.astype(kind)), target).interval == expected
    assert (
        hb.directed((vertices, np.asfortranarray(faces)[::-1][::-1]), target).interval == expected
    )


def test_float32_means_its_own_values(small_sphere: Mesh) -> None:
    single = small_sphere[0].astype(np.float32)
    target = sphere(9, 0.1)
    assert (
        hb.directed((single, small_sphere[1]), target).interval
        == hb.directed((single.astype(float), small_sphere[1]), target).interval
    )


def test_units_of_tolerances(small_sphere: Mesh) -> None:
    target = sphere(9, 0.1)
    diagonal = hb.Shape(*small_sphere).diagonal
    assert hb.directed(small_sphere, target, tolerance=1e-2).interval.width <= 1e-2 * diagonal
    assert (
        hb.directed(small_sphere, target, tolerance=1e-4, relative_to="length").interval.width
        <= 1e-4
    )
    relative = hb.directed(small_sphere, target, tolerance=1e-3, relative_to="lower").interval
    assert relative.width <= 1e-3 * relative.lower * (1 + 1e-12)


@pytest.mark.parametrize(
    "bad",
    [
        {"tolerance": 0},
        {"tolerance": -1},
        {"tolerance": math.nan},
        {"tolerance": "fine"},
        {"threads": 0},
        {"threads": 1.5},
        {"threads": 2**40},
        {"relative_to": "box"},
        {"time_limit": math.nan},
        {"solver": "gues"},
        {"options": {"no_such": 1}},
        {"relative_to": []},
    ],
)
def test_wrong_options_are_named(tetrahedron: Mesh, bad: dict[str, Any]) -> None:
    with pytest.raises(hb.InputError) as error:
        hb.directed(tetrahedron, tetrahedron, **bad)
    text = str(error.value)
    assert "\n" not in text and (
        next(iter(bad)) in text or "no_such" in text or "gues" in text
    ), text


def test_options_are_keywords_only(tetrahedron: Mesh) -> None:
    functions: tuple[Callable[..., object], ...] = (
        hb.directed,
        hb.symmetric,
        hb.distribution,
        hb.field,
    )
    for ask in functions:
        with pytest.raises(TypeError):
            ask(tetrahedron, tetrahedron, 1e-3)


def test_solvers_and_options(small_sphere: Mesh) -> None:
    assert {"cover", "scan"} <= set(hb.solvers())
    target = sphere(9, 0.1)
    by_guthe, by_default = (
        hb.directed(small_sphere, target, solver="guthe").interval,
        hb.directed(small_sphere, target).interval,
    )
    assert by_guthe.lower <= by_default.upper and by_default.lower <= by_guthe.upper


def test_threads_change_no_answer(small_sphere: Mesh) -> None:
    target = sphere(9, 0.1)
    assert (
        hb.directed(small_sphere, target, threads=2).interval
        == hb.directed(small_sphere, target).interval
    )


def test_within(tetrahedron: Mesh) -> None:
    target = raised(tetrahedron)
    assert hb.within(tetrahedron, target, 0.26) is True
    assert hb.within(tetrahedron, target, 0.24) is False
    with pytest.raises(hb.Undecided) as undecided:
        hb.within(sphere(60, 0.1), sphere(50, 0.1), 1e-2, time_limit=0)
    assert undecided.value.interval is not None and undecided.value.interval.contains(1e-2)
    for wrong in ("far", math.nan, math.inf, -1):
        with pytest.raises(hb.InputError, match="^d: "):
            hb.within(tetrahedron, target, wrong)  # type: ignore[arg-type]


def test_within_both_ways(tetrahedron: Mesh) -> None:
    vertices, faces = tetrahedron
    more = np.vstack([vertices, [[9, 0, 0], [9, 1, 0], [9, 0, 1]]]), np.vstack([faces, [[4, 5, 6]]])
    prepared = hb.prepare(more)
    for d, expected in ((7.9, False), (8.1, True)):
        assert hb.within(tetrahedron, more, d) is True
        assert hb.within(tetrahedron, more, d, symmetric=True) is expected
        assert hb.within(more, tetrahedron, d, symmetric=True) is expected
        assert prepared.within(tetrahedron, d, symmetric=True) is expected
    with pytest.raises(hb.Undecided, match=r"H\(A,B\)"):
        hb.within([[0, 0, 0]], [[3, 4, 0]], 5, symmetric=True)


def test_a_time_limit_leaves_a_true_interval() -> None:
    mesh, target = sphere(60, 0.1), sphere(50, 0.1)
    early, late = hb.directed(mesh, target, time_limit=0), hb.directed(mesh, target)
    assert early.status == "time_limit"
    assert (
        early.interval.lower <= late.interval.upper and late.interval.lower <= early.interval.upper
    )


def test_poses(small_sphere: Mesh) -> None:
    target = sphere(9, 0.1)
    vertices, faces = small_sphere
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = QUARTER_TURN, [1, 2, 3]
    expected = hb.directed((vertices @ QUARTER_TURN.T + [1, 2, 3], faces), target).interval
    for pose in (matrix, matrix.tolist(), (QUARTER_TURN, [1, 2, 3]), np.asfortranarray(matrix)):
        interval = hb.directed(small_sphere, target, pose=pose).interval
        assert interval.lower <= expected.upper and expected.lower <= interval.upper
    turned = hb.directed(small_sphere, target, pose=QUARTER_TURN).interval
    assert (
        turned.contains(hb.directed((vertices @ QUARTER_TURN.T, faces), target).interval.lower)
        or turned.width > 0
    )
    back = hb.directed(target, small_sphere, target_pose=(QUARTER_TURN, [1, 2, 3])).interval
    moved = hb.directed(target, (vertices @ QUARTER_TURN.T + [1, 2, 3], faces)).interval
    assert back.lower <= moved.upper and moved.lower <= back.upper


@pytest.mark.parametrize(
    "pose",
    [
        np.eye(2),
        np.full((4, 4), np.nan),
        np.ones((4, 4)),
        (np.eye(3), [1, 2]),
        np.eye(4)[:3],
        "turn",
        (np.eye(4), [0, 0, 0]),
        np.eye(4, dtype=complex),
        None and 0,
    ],
)
def test_wrong_poses_are_named(tetrahedron: Mesh, pose: Any) -> None:
    if pose is None:
        return
    with pytest.raises(hb.InputError, match="pose"):
        hb.directed(tetrahedron, tetrahedron, pose=pose)


def test_distribution_against_all_points() -> None:
    random = np.random.default_rng(3)
    points, targets = random.normal(size=(300, 3)), random.normal(size=(200, 3))
    exact = np.sort(np.sqrt(((points[:, None] - targets[None]) ** 2).sum(-1)).min(1))
    statistics = hb.distribution(points, targets, quantiles=[0.95], within=[0.5])
    for bounds, value in (
        (statistics.mean, exact.mean()),
        (statistics.rms, math.sqrt((exact**2).mean())),
        (statistics.deviation, exact.std()),
        (statistics.maximum, exact[-1]),
        (statistics.quantile(0.95), exact[math.ceil(0.95 * 300) - 1]),
        (statistics.share_within(0.5), (exact <= 0.5).mean()),
        (statistics.quantile(0.3), exact[89]),
    ):
        assert isinstance(bounds, hb.Interval)
        assert bounds.lower - 1e-12 <= value <= bounds.upper + 1e-12


def test_distribution_asks_for_what_is_listed(small_sphere: Mesh) -> None:
    statistics = hb.distribution(small_sphere, sphere(9, 0.1), statistics=["rms"], quantiles=[0.5])
    assert repr(statistics).count("[") == 2 and "mean" not in repr(statistics)
    mean = statistics.mean
    assert "mean" in repr(statistics) and statistics.mean is mean
    assert statistics.median.lower <= statistics.quantile(0.5).upper
    assert (
        repr(hb.distribution(small_sphere, small_sphere, statistics=()))
        == "<Distribution: nothing asked yet>"
    )


def test_distribution_asks_for_mean_and_rms_if_nothing_is_listed(small_sphere: Mesh) -> None:
    target = sphere(9, 0.1)
    assert "mean [" in repr(hb.distribution(small_sphere, target)) and "rms [" in repr(
        hb.distribution(small_sphere, target)
    )
    listed = hb.distribution(small_sphere, target, quantiles=0.95, within=0.1)
    assert (
        "mean" not in repr(listed)
        and "quantile 0.95" in repr(listed)
        and "within 0.1" in repr(listed)
    )


@pytest.mark.parametrize(
    "wrong", [{"solver": 3}, {"solver": "covr"}, {"options": 3}, {"options": {"no": 1}}]
)
def test_wrong_solvers_are_named(tetrahedron: Mesh, wrong: dict[str, Any]) -> None:
    with pytest.raises(hb.InputError) as error:
        hb.directed(tetrahedron, tetrahedron, **wrong)
    assert "plan:" not in str(error.value) and "NULL" not in str(error.value)


def test_paths_are_checked(tetrahedron: Mesh) -> None:
    mesh: Any = tetrahedron
    calls: list[tuple[Callable[..., object], list[Any]]] = [
        (hb.read, [mesh]),
        (hb.verify, [mesh, mesh, "p"]),
        (hb.certify, [mesh, mesh, 3]),
    ]
    for call, arguments in calls:
        with pytest.raises(hb.InputError, match="path"):
            call(*arguments)


def test_proofs_of_point_sets_need_no_solver(tmp_path: Path) -> None:
    points, targets = np.zeros((3, 3)), np.ones((2, 3))
    hb.certify(points, targets, tmp_path / "proof")
    assert hb.verify(tmp_path / "proof", points, targets)
    with pytest.raises(hb.InputError, match="leave solver out"):
        hb.certify(points, targets, tmp_path / "proof", solver="scan")


def test_distribution_over_both_shapes() -> None:
    near, far = np.zeros((1, 3)), np.array([[0, 0, 0], [0, 0, 4.0]])
    assert hb.distribution(near, far).mean.contains(0)
    assert hb.distribution(near, far, over="target").mean.contains(2)
    assert hb.distribution(near, far, over="pooled").mean.contains(4 / 3)
    assert hb.distribution(near, far, over="mean_of_both").mean.contains(1)
    assert hb.distribution(near, far, over="larger").maximum.contains(4)


@pytest.mark.parametrize(
    "bad",
    [
        {"statistics": ["average"]},
        {"quantiles": [95]},
        {"within": [-1]},
        {"over": "both"},
        {"weigh": "length"},
        {"share_tolerance": 0},
        {"quantiles": [math.nan]},
        {"quantiles": 0},
        {"within": "far"},
        {"statistics": 3},
        {"tolerance": 0},
        {"tolerance": math.inf},
        {"time_limit": -1},
    ],
)
def test_wrong_statistics_are_named(tetrahedron: Mesh, bad: dict[str, Any]) -> None:
    with pytest.raises(hb.InputError, match=next(iter(bad))):
        hb.distribution(tetrahedron, tetrahedron, **bad)


def test_field(tetrahedron: Mesh) -> None:
    vertices, faces = tetrahedron
    extra = np.vstack([vertices, [[0, 0, 5.0]]])  # a vertex that no face uses
    field = hb.field((extra, faces), raised(tetrahedron))
    assert field.lower.shape == field.upper.shape == field.nearest.shape == (5,)
    assert (field.lower <= field.upper).all()
    for row, value in enumerate([0.25, 0.25, 0.25, 0, 3.75]):
        assert field.lower[row] <= value <= field.upper[row]
    assert field.nearest.dtype == np.int64 and ((0 <= field.nearest) & (field.nearest < 4)).all()


def test_prepared_gives_the_answers_of_single_calls(small_sphere: Mesh) -> None:
    target = sphere(9, 0.1)
    prepared, source = hb.prepare(target), hb.Shape(*small_sphere)
    for step in range(6):
        pose = (QUARTER_TURN, [0.05 * step, 0, 0.1])
        single = hb.directed(small_sphere, target, pose=pose).interval
        shapes: list[ShapeLike] = [source, small_sphere]
        for shape in shapes:
            interval = prepared.directed(shape, pose=pose).interval
            assert interval.lower <= single.upper and single.lower <= interval.upper
    assert prepared.within(source, 10) is True
    assert (
        prepared.symmetric(source).interval.lower
        <= hb.symmetric(small_sphere, target).interval.upper
    )
    assert prepared.field(source).lower.shape == (len(small_sphere[0]),)
    assert prepared.distribution(source).mean.upper >= 0


def test_prepared_reads_changed_arrays_again() -> None:
    prepared, points = hb.prepare(np.zeros((1, 3))), np.array([[0.0, 0, 1]])
    assert prepared.directed(points).interval.contains(1)
    points[0, 2] = 7
    assert prepared.directed(points).interval.contains(7)


def test_prepared_keeps_a_pair_as_long_as_its_shape(small_sphere: Mesh) -> None:
    prepared, source = hb.prepare(small_sphere), hb.Shape(*sphere(9))
    prepared.directed(source)
    assert len(prepared._kept) == 1
    assert prepared.directed(source).prepare_seconds <= 1e-3
    del source
    assert len(prepared._kept) == 0


def test_shapes_and_files(small_sphere: Mesh, sphere_file: Path) -> None:
    shape = hb.read(sphere_file)
    assert shape.is_mesh and shape.faces is not None
    assert (shape.vertices == small_sphere[0]).all() and (shape.faces == small_sphere[1]).all()
    assert (shape.box == [small_sphere[0].min(0), small_sphere[0].max(0)]).all()
    expected = hb.directed(small_sphere, sphere(9)).interval
    paths: list[ShapeLike] = [sphere_file, str(sphere_file)]
    for path in paths:
        assert hb.directed(path, sphere(9)).interval == expected
    again = pickle.loads(pickle.dumps(shape))
    assert hb.directed(again, sphere(9)).interval == expected
    points = hb.Shape(small_sphere[0])
    assert (
        not points.is_mesh
        and points.faces is None
        and "points" in repr(points)
        and points.vertex_count == len(small_sphere[0])
    )


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    paths: list[ShapeLike] = [tmp_path / "gone.ply", tmp_path, "a\0b.ply", tmp_path / "ü\udcff.ply"]
    for path in paths:
        with pytest.raises(hb.InputError, match="^A: "):
            hb.directed(path, np.zeros((1, 3)))


@pytest.mark.parametrize("upper", ['"nan"', "-1.0", '"inf"'])
def test_what_a_proof_states_is_an_interval(upper: str, small_sphere: Mesh, tmp_path: Path) -> None:
    proof, target = tmp_path / "proof", sphere(9, 0.1)
    interval = hb.certify(small_sphere, target, proof).interval
    content = proof.read_bytes()[: -len("\nsha256 \n") - 64]
    changed = re.sub(rb'"upper":[^,}]*', b'"upper":' + upper.encode(), content, count=1)
    proof.write_bytes(changed + b"\nsha256 " + hashlib.sha256(changed).hexdigest().encode() + b"\n")
    verdict = hb.verify(proof, small_sphere, target)
    assert bool(verdict) is (upper == '"inf"')
    assert verdict.interval == hb.Interval(interval.lower if verdict else 0, math.inf)


def test_a_proof_at_a_pose_is_of_that_pose(small_sphere: Mesh, tmp_path: Path) -> None:
    target, proof, moved = sphere(9, 0.1), tmp_path / "proof", np.eye(4)
    moved[:3, 3] = 0.5
    hb.certify(small_sphere, target, proof, pose=moved, tolerance=1e-3)
    at_rest = hb.verify(proof, small_sphere, target)
    assert not at_rest and "pose" in at_rest.text and at_rest.proven == math.inf
    assert (at_rest.pose == moved).all() and (at_rest.target_pose == np.eye(4)).all()
    assert hb.verify(proof, small_sphere, target, pose=moved)
    assert not hb.verify(proof, small_sphere, target, pose=moved, target_pose=moved)


def test_certify_and_verify(small_sphere: Mesh, tmp_path: Path) -> None:
    target, proof = sphere(9, 0.1), tmp_path / "proof.hbc"
    for symmetric in (False, True):
        answer = hb.certify(small_sphere, target, proof, symmetric=symmetric, tolerance=1e-3)
        verdict = hb.verify(proof, small_sphere, target)
        assert verdict and verdict.accepted, verdict.text
        assert (
            verdict.interval.lower == answer.interval.lower
            and verdict.proven <= answer.interval.upper * (1 + 1e-9)
        )
        # The file states what it proves, which may be a little more than the bound of the answer.
        assert verdict.interval.upper == max(answer.interval.upper, verdict.proven)
    with pytest.raises(hb.InputError):
        hb.verify(proof, target, small_sphere)
    damaged = bytearray(proof.read_bytes())
    damaged[len(damaged) // 2] ^= 1
    proof.write_bytes(damaged)
    try:
        assert not hb.verify(proof, small_sphere, target)
    except hb.InputError:
        pass  # cannot be read at all


class TrimeshLike:
    def __init__(self, mesh: Mesh) -> None:
        self.vertices, self.faces = (array.view(Tracked) for array in mesh)


class Tracked(np.ndarray):  # type: ignore[type-arg]
    """A subclass of arrays, as trimesh has."""


class Open3dMesh:
    def __init__(self, mesh: Mesh) -> None:
        self.vertices, self.triangles = mesh[0].tolist(), mesh[1].astype(np.int32)


class Cloud:
    def __init__(self, points: Any) -> None:
        self.points = points


class PyvistaLike:
    def __init__(self, mesh: Mesh) -> None:
        self.points = mesh[0].astype(np.float32)
        self.faces = np.hstack([np.full((len(mesh[1]), 1), 3), mesh[1]]).ravel()


def test_objects_of_other_packages(small_sphere: Mesh) -> None:
    target = sphere(9, 0.1)
    expected = hb.directed(small_sphere, target).interval
    assert hb.directed(TrimeshLike(small_sphere), target).interval == expected
    assert hb.directed(Open3dMesh(small_sphere), target).interval == expected
    assert (
        hb.directed(Cloud(small_sphere[0]), target).interval
        == hb.directed(small_sphere[0], target).interval
    )
    with pytest.raises(hb.InputError, match=r"^A: faces: .*VTK.*reshape\(-1, 4\)\[:, 1:\]"):
        hb.directed(PyvistaLike(small_sphere), target)
    for nothing in (None, 3, object(), {"vertices": 1}, b"bytes"):
        with pytest.raises(hb.InputError, match="^A: "):
            hb.directed(nothing, target)  # type: ignore[arg-type]


def test_intervals_never_guess() -> None:
    interval = hb.Interval(1, 2)
    assert interval < 3 and interval <= 2 and interval > 0.5 and interval >= 1
    assert not interval < 1 and not interval > 2 and not interval <= 0.5 and not interval >= 2.5
    assert interval < hb.Interval(2.5, 3) and not interval >= hb.Interval(2.5, 3)
    asks: list[Callable[[], object]] = [
        lambda: interval < 1.5,
        lambda: interval >= 1.5,
        lambda: interval < 2,
        lambda: interval > hb.Interval(0, 1.5),
        lambda: np.float64(1.5) < interval,
        lambda: 1.5 >= interval,
    ]
    for ask in asks:
        with pytest.raises(hb.Undecided) as undecided:
            ask()
        assert undecided.value.interval == interval
    assert np.float64(0.5) < interval
    assert hb.Interval(0, 2**53) < 2**53 + 1 and hb.Interval(1, 1) > np.float32(0.5)
    ninth: Any = Fraction(1, 9)
    assert hb.Interval(0.1, 0.1) < ninth
    of_numpy: Any = np.float64(1)
    assert type(hb.Interval(of_numpy, 2).lower) is float  # else numpy 2 prints 'np.float64(1.0)'
    assert hb.Interval(0, 2**60 + 1).upper == 2**60 + 1
    anything: Any = interval
    wrongs: list[Callable[[], object]] = [
        lambda: float(anything),
        lambda: bool(anything),
        lambda: anything == 1.5,
        lambda: anything + 1,
        lambda: anything == np.float32(1.5),
        lambda: anything < "3",
        lambda: anything != 1,
    ]
    for wrong in wrongs:
        with pytest.raises(TypeError):
            wrong()
    with pytest.raises(ValueError):
        interval < math.nan
    with pytest.raises(ValueError):
        hb.Interval(2, 1)


def test_intervals_are_values() -> None:
    interval = hb.Interval(0.1, 0.3)
    assert (
        interval == hb.Interval(0.1, 0.3)
        and interval != hb.Interval(0.1, 0.4)
        and len({interval, hb.Interval(0.1, 0.3)}) == 1
    )
    for change in ("lower", "upper", "width", "other"):
        with pytest.raises(AttributeError):
            setattr(interval, change, 1)
    assert (
        tuple(interval) == (0.1, 0.3)
        and interval.contains(0.2)
        and not interval.contains(0.31)
        and not interval.contains(math.nan)
    )
    assert pickle.loads(pickle.dumps(interval)) == copy.deepcopy(interval) == interval
    assert eval(repr(interval), {"Interval": hb.Interval}) == interval


def test_printed_intervals_hold() -> None:
    random = np.random.default_rng(1)
    for digits in (1, 3, 9, 17):
        for value in [
            *(random.normal(size=50) * 10.0 ** random.integers(-30, 30, 50)),
            0.0,
            9.9999999999,
            1e300,
            5e-324,
            123456.0,
        ]:
            text = format(hb.Interval(value, value), f".{digits}g")
            lower, upper = map(float, text.strip("[]").split(", "))
            assert lower <= value <= upper and abs(upper - lower) <= max(
                abs(value) * 20.0 * 10.0**-digits, 1e-320
            ), text
    assert (
        str(hb.Interval(0, math.inf)) == "[0, inf]"
        and f"{hb.Interval(1 / 3, 2 / 3):.2g}" == "[0.33, 0.67]"
    )
    with pytest.raises(ValueError):
        format(hb.Interval(0, 1), "f")


@pytest.mark.parametrize("protocol", range(pickle.HIGHEST_PROTOCOL + 1))
def test_what_keeps_a_pair_cannot_be_pickled(protocol: int, tetrahedron: Mesh) -> None:
    prepared = hb.prepare(tetrahedron)
    for value in (prepared, hb.distribution(tetrahedron, tetrahedron), prepared.target._shape):
        with pytest.raises(TypeError, match="cannot be pickled"):
            pickle.dumps(value, protocol)


def test_numbers_are_not_rounded(tetrahedron: Mesh) -> None:
    point, target = [[0, 0, 1]], [[0, 0, 0]]
    rounded: list[Any] = [
        Fraction(10**30 - 1, 10**30),
        Decimal("0.1"),
        np.int64(2**53 + 1),
        2**53 + 1,
    ]
    exact: list[Any] = [Fraction(3, 2), np.float32(1.5)]
    large: Any = np.int64(2**53 + 1)
    true: Any = np.bool_(True)
    for wrong in rounded:
        with pytest.raises(hb.InputError, match="no double is"):
            hb.distribution(point, target, within=wrong)
        with pytest.raises(hb.InputError, match="no double is"):
            hb.within(point, target, wrong)
    assert all(hb.within(point, target, length) for length in exact)
    with pytest.raises(hb.InputError, match=r"row 0 has an integer beyond 2\*\*53"):
        hb.Shape([[large, 0.5, 0]])
    for symmetric in ("no", 1, None):
        with pytest.raises(hb.InputError, match="^symmetric: "):
            hb.within(tetrahedron, tetrahedron, 1, symmetric=symmetric)  # type: ignore[arg-type]
    assert hb.within(tetrahedron, tetrahedron, 1, symmetric=true)


def test_a_signal_handler_may_ask_about_the_same_shapes() -> None:
    A, B = hb.Shape(*sphere(300, 0.1)), hb.Shape(*sphere(290, 0.1))
    answers = list[hb.Answer]()
    before = signal.signal(
        signal.SIGALRM, lambda *_: answers.append(hb.directed(A, B, time_limit=0.01))
    )
    signal.setitimer(signal.ITIMER_REAL, 0.01)
    try:
        answer = hb.directed(A, B)
        while not answers:  # the call ended before the signal came
            time.sleep(0.001)
    finally:
        signal.signal(signal.SIGALRM, before)
    assert answer.status == "converged"
    assert (
        answers[0].interval.lower <= answer.interval.upper
        and answer.interval.lower <= answers[0].interval.upper
    )


def test_only_solvers_whose_bounds_hold_are_offered() -> None:
    assert "cover" in hb.solvers() and "scan" in hb.solvers()
    assert not [name for name in hb.solvers() if name.endswith("_as_printed")]


def test_exceptions_can_be_pickled() -> None:
    error = hb.InputError("vertices: row 3 is wrong", 3)
    assert pickle.loads(pickle.dumps(error)).row == 3
    undecided = hb.Undecided("undecided", hb.Interval(0, 1))
    assert pickle.loads(pickle.dumps(undecided)).interval == hb.Interval(0, 1)


def test_progress_shows_bounds_that_hold() -> None:
    rough, fine = sphere(40), sphere(60)
    functions: tuple[Callable[..., hb.Answer], ...] = (
        hb.directed,
        hb.symmetric,
        hb.prepare(fine).directed,
    )
    for ask in functions:
        seen: list[hb.Interval] = []
        arguments = (rough,) if ask not in (hb.directed, hb.symmetric) else (rough, fine)
        answer = ask(*arguments, progress=seen.append)
        assert seen and all(
            bounds.lower <= answer.interval.upper and answer.interval.lower <= bounds.upper
            for bounds in seen
        )
    shown: list[dict[str, hb.Interval]] = []
    statistics = hb.distribution(
        rough, fine, statistics=["mean", "maximum"], tolerance=1e-4, progress=shown.append
    )
    assert len(shown) >= 2 and all(set(bounds) == {"mean", "maximum"} for bounds in shown)
    assert all(
        bounds["mean"].lower <= statistics.mean.upper
        and statistics.mean.lower <= bounds["mean"].upper
        for bounds in shown
    )


def test_what_a_progress_function_raises_ends_the_question() -> None:
    def enough(_: hb.Interval) -> None:
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        hb.directed(sphere(40), sphere(60), progress=enough)
    with pytest.raises(hb.InputError, match="progress: 3 cannot be called"):
        hb.directed(sphere(4), sphere(6), progress=3)  # type: ignore[arg-type]
