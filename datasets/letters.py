"""Letters as closed meshes: the outline of a glyph of a TrueType font, extruded by a quarter of the
height of its H.

datasets/fetch.py takes a font as an archive whose members are letters, "FONT.ttf!letter/H.obj". The
outlines of TrueType are straight edges and quadratic curves between points of an integer grid. Each
curve becomes `PIECES` edges; then the longest edge is halved until the solid has `TRIANGLES`
triangles. A bridge joins each hole to the outer ring, and ear clipping cuts the caps into
triangles. All arithmetic is exact (Fractions), and all coordinates are dyadic if the grid is, so
the text of the OBJ file and its SHA-256 are the same on every machine.

The mesh has two caps, z = 0 and z = depth, and two triangles for each edge of the outline: 4n - 4 +
4h triangles for n points and h holes. It is closed, and its triangles face outwards.
"""

from __future__ import annotations

import io
import struct
from fractions import Fraction

Point = tuple[Fraction, Fraction]
Ring = list[Point]  # the last point is joined to the first

PIECES = 2  # edges per curve, at t = k / PIECES; a power of two
TRIANGLES = 200


def cross(a: Point, b: Point, c: Point) -> Fraction:
    """Returns twice the signed area of a triangle: positive if it turns left."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def squared_length(a: Point, b: Point) -> Fraction:
    return (a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2


def area(ring: Ring) -> Fraction:
    """Returns the signed area: positive if the ring runs counter-clockwise."""
    origin = ring[0]
    return sum((cross(origin, a, b) for a, b in edges(ring)), Fraction(0)) / 2


def edges(ring: Ring) -> list[tuple[Point, Point]]:
    return list(zip(ring, ring[1:] + ring[:1]))


def on_segment(p: Point, a: Point, b: Point) -> bool:
    """Returns whether p lies on ab, ends included."""
    return cross(a, b, p) == 0 and all(min(a[i], b[i]) <= p[i] <= max(a[i], b[i]) for i in (0, 1))


def meet(a: Point, b: Point, c: Point, d: Point) -> bool:
    """Returns whether ab and cd have a common point that is not an end of both."""
    if any(max(a[i], b[i]) < min(c[i], d[i]) or max(c[i], d[i]) < min(a[i], b[i]) for i in (0, 1)):
        return False
    shared = {a, b} & {c, d}
    if any(on_segment(p, c, d) for p in (a, b) if p not in shared):
        return True
    if any(on_segment(p, a, b) for p in (c, d) if p not in shared):
        return True
    if shared:
        return len(shared) == 2
    return cross(a, b, c) * cross(a, b, d) < 0 and cross(c, d, a) * cross(c, d, b) < 0


def inside(p: Point, ring: Ring) -> bool:
    """Returns whether p lies in the ring. p must not be on an edge."""
    crossed = [(a, b) for a, b in edges(ring) if (a[1] > p[1]) != (b[1] > p[1])]
    return sum((cross(a, b, p) > 0) == (b[1] > a[1]) for a, b in crossed) % 2 == 1


# ---- the outline


def flatten(contour: list[tuple[Fraction, Fraction, bool]], pieces: int) -> Ring:
    """Returns the ring of a TrueType contour, given by points on the curve (True) and control
    points of quadratic curves (False)."""
    full: list[tuple[Point, bool]] = []
    for (x, y, on), (next_x, next_y, next_on) in zip(contour, contour[1:] + contour[:1]):
        full.append(((x, y), on))
        if not on and not next_on:  # the middle of two control points is on the curve
            full.append((((x + next_x) / 2, (y + next_y) / 2), True))
    first = next(i for i, (_, on) in enumerate(full) if on)
    full = full[first:] + full[:first]
    ring: Ring = []
    for i, (point, on) in enumerate(full):
        if on:
            ring.append(point)
            continue
        before, after = full[i - 1][0], full[(i + 1) % len(full)][0]
        for t in (Fraction(k, pieces) for k in range(1, pieces)):
            x, y = (
                (1 - t) ** 2 * before[j] + 2 * t * (1 - t) * point[j] + t**2 * after[j]
                for j in (0, 1)
            )
            ring.append((x, y))
    return [p for p, following in edges(ring) if p != following]


def refine(rings: list[Ring], triangles: int) -> list[Ring]:
    """Halves the longest edge (the first, if several are) until the solid has at least `triangles`
    triangles."""
    rings = [list(ring) for ring in rings]
    while 4 * sum(len(ring) for ring in rings) - 4 + 4 * (len(rings) - 1) < triangles:
        _, ring, i = min(
            (-squared_length(a, b), r, i)
            for r, ring in enumerate(rings)
            for i, (a, b) in enumerate(edges(ring))
        )
        a, b = edges(rings[ring])[i]
        rings[ring].insert(i + 1, ((a[0] + b[0]) / 2, (a[1] + b[1]) / 2))
    return rings


def sorted_rings(rings: list[Ring]) -> list[Ring]:
    """Returns the outer ring, counter-clockwise, then the holes, clockwise. Raises ValueError for
    other rings, or if they overlap."""
    everything = [edge for ring in rings for edge in edges(ring)]
    if any(
        meet(*first, *second) for i, first in enumerate(everything) for second in everything[:i]
    ):
        raise ValueError("its contours overlap")
    outer, *holes = sorted(rings, key=lambda ring: -abs(area(ring)))
    within = all(inside(hole[0], outer) for hole in holes)
    if not within or any(inside(a[0], b) for a in holes for b in holes if a is not b):
        raise ValueError("it is not one ring with holes")
    return [
        outer if area(outer) > 0 else outer[::-1],
        *(hole if area(hole) < 0 else hole[::-1] for hole in holes),
    ]


# ---- the caps; corners are indices of points, because the ends of a bridge occur twice


def bridged(rings: list[list[int]], at: Ring) -> list[int]:
    """Joins an outer ring and its holes into one ring, by the shortest bridges first and with no
    two bridges at one point."""
    ring, holes = list(rings[0]), rings[1:]
    walls = [(at[a], at[b]) for r in rings for a, b in zip(r, r[1:] + r[:1])]
    while holes:
        free = [i for i in ring if ring.count(i) == 1]
        pairs = sorted(
            (squared_length(at[i], at[j]), i, j) for i in free for hole in holes for j in hole
        )
        for _, i, j in pairs:
            if not any(meet(at[i], at[j], *wall) for wall in walls):
                break
        else:
            raise ValueError("a hole cannot be joined to its ring")
        hole = next(hole for hole in holes if j in hole)
        holes.remove(hole)
        walls.append((at[i], at[j]))
        place, turn = ring.index(i), hole.index(j)
        ring = [*ring[: place + 1], *hole[turn:], *hole[: turn + 1], *ring[place:]]
    return ring


def is_ear(ring: list[int], k: int, at: Ring) -> bool:
    """Returns whether corner k of the ring is convex, and no other point lies in its triangle or on
    the cut."""
    u, v, w = ring[k - 1], ring[k], ring[(k + 1) % len(ring)]
    sides = ((at[u], at[v]), (at[v], at[w]), (at[w], at[u]))
    if not cross(at[u], at[v], at[w]) > 0:
        return False
    for p in ring:
        if p not in (u, v, w) and all(cross(a, b, at[p]) >= 0 for a, b in sides):
            return False
    return True


def triangulate(rings: list[list[int]], at: Ring) -> list[tuple[int, int, int]]:
    """Returns counter-clockwise triangles of the region between the rings, with only the rings'
    points as corners.

    Cuts off the ear with the shortest cut; ties go to the smallest index. No triangle is
    degenerate.
    """
    ring = bridged(rings, at)
    triangles: list[tuple[int, int, int]] = []
    while len(ring) > 2:
        ears = [
            (squared_length(at[ring[k - 1]], at[ring[(k + 1) % len(ring)]]), ring[k], k)
            for k in range(len(ring))
            if is_ear(ring, k, at)
        ]
        if not ears:
            raise ValueError("ear clipping found no ear")
        k = min(ears)[2]
        triangles.append((ring[k - 1], ring[k], ring[(k + 1) % len(ring)]))
        del ring[k]
    return triangles


# ---- the solid


Solid = tuple[list[tuple[Fraction, Fraction, Fraction]], list[tuple[int, int, int]]]


def extruded(rings: list[Ring], depth: Fraction) -> Solid:
    """Returns vertices and triangles of the solid between z = 0 and z = depth, for rings from
    sorted_rings()."""
    at = [point for ring in rings for point in ring]
    n, begin = len(at), 0
    numbered: list[list[int]] = []
    for ring in rings:
        numbered.append(list(range(begin, begin + len(ring))))
        begin += len(ring)
    cap = triangulate(numbered, at)
    faces = [(c, b, a) for a, b, c in cap]
    faces += [(a + n, b + n, c + n) for a, b, c in cap]
    for indices in numbered:
        for a, b in zip(indices, indices[1:] + indices[:1]):
            faces += [(a, b, b + n), (a, b + n, a + n)]
    return [(x, y, z) for z in (Fraction(0), depth) for x, y in at], faces


def solid(rings: list[Ring], depth: Fraction, triangles: int = TRIANGLES) -> Solid:
    return extruded(refine(sorted_rings(rings), triangles), depth)


def obj_text(mesh: Solid) -> bytes:
    """Returns an OBJ file with all digits. Raises ValueError if a coordinate is not a double."""
    vertices, faces = mesh
    if any(Fraction(float(c)) != c for vertex in vertices for c in vertex):
        raise ValueError("a coordinate is not a double: the units of the em are not a power of two")
    lines = []
    for vertex in vertices:
        lines.append("v " + " ".join(repr(float(c)) for c in vertex) + "\n")
    for face in faces:
        lines.append("f " + " ".join(str(corner + 1) for corner in face) + "\n")
    return "".join(lines).encode()


def letter_solid(font: bytes, letter: str) -> Solid:
    """Returns a letter of a TrueType font, in units of the em.

    Raises ValueError if the font lacks the letter, or if the letter is not one ring with holes.
    """
    from fontTools.ttLib import TTFont, TTLibError

    try:
        opened = TTFont(io.BytesIO(font))
        names, table, em = opened.getBestCmap(), opened["glyf"], opened["head"].unitsPerEm
        if ord(letter) not in names:
            raise ValueError(f"the font has no letter {letter}")
        points, ends, flags = table[names[ord(letter)]].getCoordinates(table)
        height = table[names[ord("H")]].yMax
    except (TTLibError, KeyError, IndexError, AssertionError, struct.error) as error:
        raise ValueError(f"the font cannot be read: {error}") from error
    numbers = [
        (Fraction(x, em), Fraction(y, em), bool(flag & 1)) for (x, y), flag in zip(points, flags)
    ]
    contours = []
    begin = 0
    for last in ends:
        contours.append(numbers[begin : last + 1])
        begin = last + 1
    try:
        return solid([flatten(contour, PIECES) for contour in contours], Fraction(height, 4 * em))
    except ValueError as error:
        raise ValueError(f"letter {letter}: {error}") from error


def letter_obj(font: bytes, letter: str) -> bytes:
    return obj_text(letter_solid(font, letter))
