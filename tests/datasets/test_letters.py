"""datasets/letters.py makes closed solids that face outwards, do not intersect themselves and have
no degenerate triangle."""

from __future__ import annotations

import hashlib
import sys
import tomllib
from collections import Counter
from fractions import Fraction
from math import lcm
from pathlib import Path

import pytest

DATASETS = Path(__file__).resolve().parents[2] / "datasets"
sys.path.insert(0, str(DATASETS))

import letters  # noqa: E402

FONT = Path("/usr/share/fonts/truetype/dejavu/DejaVuSans-Bold.ttf")
MODELS = {
    name: table
    for name, table in tomllib.loads((DATASETS / "manifest.toml").read_text())["model"].items()
    if name.startswith("letter_")
}
Vector = tuple[int, int, int]


def minus(a: Vector, b: Vector) -> Vector:
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def product(a: Vector, b: Vector) -> Vector:
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def dot(a: Vector, b: Vector) -> int:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def side(a: Vector, b: Vector, c: Vector) -> int:
    """Returns 1, -1 or 0 if c is left of, right of or on the line from a to b, seen from above."""
    value = product(minus(b, a), minus(c, a))[2]
    return (value > 0) - (value < 0)


def check(mesh: letters.Solid, depth: Fraction, area: Fraction | None = None) -> int:
    """Checks a solid in exact arithmetic, and returns its number of holes."""
    vertices, faces = mesh
    unit = lcm(*(c.denominator for vertex in vertices for c in vertex))
    at: list[Vector] = [(int(x * unit), int(y * unit), int(z * unit)) for x, y, z in vertices]
    assert len(set(at)) == len(at) and {corner for face in faces for corner in face} == set(
        range(len(at))
    )

    directed = Counter((face[i - 1], face[i]) for face in faces for i in range(3))
    assert set(directed.values()) == {1} and all((b, a) in directed for a, b in directed)

    normals = [product(minus(at[b], at[a]), minus(at[c], at[a])) for a, b, c in faces]
    assert all(normal != (0, 0, 0) for normal in normals)

    def flat_at(face: tuple[int, int, int], height: Fraction | int) -> bool:
        return all(vertices[i][2] == height for i in face)

    upper = [normal for normal, face in zip(normals, faces) if flat_at(face, depth)]
    lower = [normal for normal, face in zip(normals, faces) if flat_at(face, 0)]
    assert all(normal[2] > 0 for normal in upper)
    assert all(normal[2] < 0 for normal in lower)
    cap = Fraction(sum(normal[2] for normal in upper), 2 * unit**2)
    assert cap == -Fraction(sum(normal[2] for normal in lower), 2 * unit**2) and (
        area is None or cap == area
    )
    volume = Fraction(sum(dot(at[a], product(at[b], at[c])) for a, b, c in faces), 6 * unit**3)
    assert volume == cap * depth > 0

    for a, b in directed:
        along = minus(at[b], at[a])
        for i in range(len(at)):
            if a < b and i not in (a, b) and product(along, minus(at[i], at[a])) == (0, 0, 0):
                assert (
                    not 0 <= dot(along, minus(at[i], at[a])) <= dot(along, along)
                ), "a vertex lies on an edge that is not its own"

    # No two edges of a cap cross. As its triangles have one orientation, the cap covers the region
    # once, and walls do not meet.
    flat = [(at[a], at[b]) for a, b in directed if a < b and vertices[a][2] == vertices[b][2] == 0]
    for i, (p, q) in enumerate(flat):
        assert not any(
            side(p, q, r) * side(p, q, s) < 0 and side(r, s, p) * side(r, s, q) < 0
            for r, s in flat[:i]
        )

    n = len(at) // 2
    holes = (len(faces) + 4 - 4 * n) // 4
    assert len(faces) == 4 * n - 4 + 4 * holes
    assert len(at) - len(directed) // 2 + len(faces) == 2 - 2 * holes  # Euler's formula
    return holes


def ring(*points: tuple[int, int]) -> letters.Ring:
    return [(Fraction(x), Fraction(y)) for x, y in points]


def contour(*points: tuple[int, int, bool]) -> list[tuple[Fraction, Fraction, bool]]:
    return [(Fraction(x), Fraction(y), on) for x, y, on in points]


SQUARE = ring((0, 0), (0, 8), (8, 8), (8, 0))  # clockwise, like the outer contours of TrueType
HOLE = ring((2, 2), (4, 2), (4, 4), (2, 4))
NOTCH = ring((5, 3), (7, 3), (6, 4), (7, 6), (5, 5))
# The notch's tip is inside the ear (a corner to cut off) with the shortest cut, or on the cut.
NEEDLES = [
    ring((0, 0), (10, 0), (20, 0), (20, 18), (tip, tip), (18, 20), (0, 20), (0, 10))
    for tip in (2, 5)
]
# A point of the outer ring is nearest to two holes, but only one may be joined to it.
SPIKE = [
    ring((0, 0), (0, 8), (8, 8), (8, 0), (5, 0), (4, 4), (3, 0)),
    ring((3, 4), (2, 5), (2, 3)),
    ring((5, 4), (6, 5), (6, 3)),
]
# The small hole and the nearest point of the outer ring are on opposite sides of the long hole.
BAR = [
    ring((0, 0), (0, 16), (6, 16), (8, 14), (10, 16), (16, 16), (16, 0)),
    ring((2, 12), (14, 12), (14, 13), (2, 13)),
    ring((8, 11), (9, 10), (7, 10)),
]


@pytest.mark.parametrize("triangles", [0, 60, 200])
@pytest.mark.parametrize(
    ("rings", "area", "holes"),
    [
        ([SQUARE], 64, 0),
        ([SQUARE[::-1]], 64, 0),
        ([HOLE, SQUARE], 60, 1),
        ([SQUARE, HOLE[::-1], NOTCH], 60 - Fraction(7, 2), 2),
        ([NEEDLES[0]], 364, 0),
        ([NEEDLES[1]], 370, 0),
        (SPIKE, 64 - 4 - 1 - 1, 2),
        (BAR, 256 - 4 - 12 - 1, 2),
        ([ring((0, 0), (9, 0), (9, 1), (1, 1), (1, 8), (9, 8), (9, 9), (0, 9))], 25, 0),
    ],
)
def test_solids_of_rings_with_holes(
    rings: list[letters.Ring], area: Fraction, holes: int, triangles: int
) -> None:
    mesh = letters.solid(rings, Fraction(1, 4), triangles)
    assert check(mesh, Fraction(1, 4), Fraction(area)) == holes
    assert len(mesh[1]) >= triangles and (triangles < 200 or len(mesh[1]) < 204)


def test_a_curved_outline_with_a_hole() -> None:
    """A disc of four curves given by control points alone, as in TrueType, and a hole with one
    curved side."""
    disc = letters.flatten(contour((0, 0, False), (0, 8, False), (8, 8, False), (8, 0, False)), 2)
    assert (
        len(disc) == 8 and (Fraction(1), Fraction(1)) in disc and (Fraction(0), Fraction(4)) in disc
    )
    hole = letters.flatten(contour((3, 3, True), (5, 3, True), (5, 5, False), (3, 5, True)), 4)
    assert hole[1:3] == [(Fraction(5), Fraction(3)), (Fraction(39, 8), Fraction(31, 8))]
    area = abs(letters.area(disc)) - abs(letters.area(hole))
    mesh = letters.solid([hole, disc], Fraction(2))
    assert check(mesh, Fraction(2), area) == 1 and len(mesh[1]) == 200
    text = letters.obj_text(mesh).decode().splitlines()
    assert (
        len(text) == len(mesh[0]) + len(mesh[1])
        and text[0].startswith("v ")
        and text[-1].startswith("f ")
    )
    assert text[1].split()[1:] == [repr(float(c)) for c in mesh[0][1]]


@pytest.mark.parametrize(
    "rings",
    [
        [SQUARE, ring((7, 2), (9, 2), (9, 4))],  # the contours cross
        [SQUARE, ring((8, 2), (10, 2), (9, 4))],  # a point of one is on the other
        [SQUARE, ring((20, 2), (22, 2), (21, 4))],  # two separate pieces
        [SQUARE, ring((1, 1), (1, 7), (7, 7), (7, 1)), HOLE],  # a piece inside a hole
        [ring((0, 0), (4, 4), (4, 0), (0, 4))],
    ],
)
def test_outlines_that_are_no_ring_with_holes_are_refused(rings: list[letters.Ring]) -> None:
    with pytest.raises(ValueError, match="contours overlap|not one ring with holes"):
        letters.solid(rings, Fraction(1))


def test_coordinates_that_are_no_doubles_are_refused() -> None:
    third = [(x / 3, y / 3) for x, y in SQUARE]
    with pytest.raises(ValueError, match="not a double"):
        letters.obj_text(letters.solid([third], Fraction(1), 0))


def test_the_manifest_has_twelve_letters() -> None:
    names = [table["path"].rpartition("/")[2][0] for table in MODELS.values()]
    assert len(set(names)) == 12 and [f"letter_{name.lower()}" for name in names] == list(MODELS)


@pytest.mark.skipif(not FONT.is_file(), reason="fonts-dejavu-core is not installed")
@pytest.mark.parametrize("name", MODELS)
def test_letters_of_the_font(name: str) -> None:
    pytest.importorskip("fontTools")
    letter = MODELS[name]["path"].rpartition("/")[2][0]
    mesh = letters.letter_solid(FONT.read_bytes(), letter)
    height = Fraction(1493, 2048)  # the height of the letter H
    assert check(mesh, height / 4) == {"A": 1, "B": 2, "D": 1, "O": 1, "R": 1}.get(letter, 0)
    assert len(mesh[1]) == MODELS[name]["triangles"] and 200 <= len(mesh[1]) <= 204
    assert hashlib.sha256(letters.obj_text(mesh)).hexdigest() == MODELS[name]["sha256"]
