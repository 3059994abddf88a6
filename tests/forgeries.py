"""Forges proofs of upper bounds, and expects that none is accepted: not by the C call, by Python,
or by the exit code of `hausbench verify`.

    python3 tests/forgeries.py [--count 1000] [--seed 1] [--each 10] [--kind NAME ...]

A forgery is a file that states something false about its shapes, or that is checked at another pose
than its own. Its checksums are right. Every `--each`-th is given to the program, too. Exit code 1:
one was accepted.
"""

from __future__ import annotations

import argparse
import copy
import ctypes
import hashlib
import json
import math
import os
import random
import struct
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from fractions import Fraction
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
if __name__ == "__main__":
    sys.path.insert(
        0, os.environ.get("HAUSBENCH_PYTHON", str(ROOT / "build" / "release" / "python"))
    )

import numpy as np  # noqa: E402

import hausbench as hb  # noqa: E402

Points = list[tuple[float, ...]]
Mesh = tuple[Points, list[tuple[int, ...]]]
Header = dict[str, Any]


def as_arrays(mesh: Mesh) -> tuple[Any, Any]:
    return np.array(mesh[0], dtype=float), np.array(mesh[1], dtype=np.int64)


def sha256_of(mesh: Mesh) -> str:
    """Computes the hash as docs/certificate.md describes it. The mesh must use all vertices."""
    vertices, triangles = mesh
    content = struct.pack("<Q", 4) + b"mesh" + struct.pack("<Q", len(vertices))
    content += b"".join(struct.pack("<3d", *v) for v in vertices) + struct.pack(
        "<Q", len(triangles)
    )
    return hashlib.sha256(content + b"".join(struct.pack("<3i", *t) for t in triangles)).hexdigest()


def off_text(mesh: Mesh) -> str:
    vertices, triangles = mesh
    rows = [" ".join(map(repr, v)) for v in vertices]
    rows += ["3 " + " ".join(map(str, t)) for t in triangles]
    return "\n".join([f"OFF\n{len(vertices)} {len(triangles)} 0", *rows, ""])


def sealed(header: Header, rest: bytes) -> bytes:
    content = json.dumps(header).encode() + b"\n" + rest
    return content + f"\nsha256 {hashlib.sha256(content).hexdigest()}\n".encode()


def unsealed(file: bytes) -> tuple[Header, bytes]:
    line, rest = file.rsplit(b"\nsha256 ", 1)[0].split(b"\n", 1)
    return json.loads(line), rest


def pose_numbers(matrix: Any) -> list[float]:
    """The twelve numbers of a pose in a file: the rotation row by row, then the translation."""
    return [float(x) for x in (*matrix[:3, :3].ravel(), *matrix[:3, 3])]


@dataclass
class Forgery:
    """A file, the shapes it is checked with, and the poses at which: none if None. `at_its_poses`:
    what the program checks, too."""

    header: Header
    rest: bytes
    source: Mesh
    target: Mesh
    pose: Any = None
    target_pose: Any = None
    at_its_poses: bool = True


@dataclass
class Pair:
    """Two soups, their true proof at some poses, and a lower bound of their distance there that is
    true."""

    source: Mesh
    target: Mesh
    header: Header
    rest: bytes
    lower: float
    pose: Any = None
    target_pose: Any = None

    def forged(self, header: Header, rest: bytes | None = None, **changes: Any) -> Forgery:
        return Forgery(
            header,
            self.rest if rest is None else rest,
            **{
                "source": self.source,
                "target": self.target,
                "pose": self.pose,
                "target_pose": self.target_pose,
                **changes,
            },
        )


@dataclass
class Forger:
    seed: int
    folder: Path
    random: random.Random = field(init=False)
    pairs: dict[tuple[bool, bool], list[Pair]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.random = random.Random(self.seed)

    def soup(self, size: float = 1, count: int | None = None) -> Mesh:
        count = count or self.random.randint(1, 5)
        points: Points = []
        for _ in range(3 * count):
            points.append(tuple(self.random.uniform(-size, size) for _ in range(3)))
        return points, [(3 * i, 3 * i + 1, 3 * i + 2) for i in range(count)]

    def motion(self, reach: float = 3) -> Any:
        """A rotation about a random axis, and a translation, as a matrix of 4 x 4 numbers."""
        w, x, y, z = (q := np.array([self.random.gauss(0, 1) for _ in range(4)])) / np.linalg.norm(
            q
        )
        matrix = np.eye(4)
        matrix[:3, :3] = [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
        matrix[:3, 3] = [self.random.uniform(-reach, reach) for _ in range(3)]
        return matrix

    def pair(self, moved: bool | None = None, symmetric: bool | None = None) -> Pair:
        moved = self.random.random() < 0.5 if moved is None else moved
        symmetric = self.random.random() < 0.3 if symmetric is None else symmetric
        made = self.pairs.setdefault((moved, symmetric), [])
        if len(made) < 2 or self.random.random() < 0.1:
            made.append(self.new_pair(moved, symmetric))
        return self.random.choice(made[-20:])

    def new_pair(self, moved: bool, symmetric: bool) -> Pair:
        source, target = self.soup(), self.soup()
        pose = self.motion() if moved else None
        target_pose = self.motion() if moved and self.random.random() < 0.5 else None
        file = self.folder / "true"
        solver = (
            self.random.choice(["cover", "guthe", "sacht", "kang", "zheng"])
            if target_pose is None
            else "cover"
        )
        answer = hb.certify(
            as_arrays(source),
            as_arrays(target),
            file,
            symmetric=symmetric,
            tolerance=10 ** self.random.uniform(-8, -1),
            solver=solver,
            pose=pose,
            target_pose=target_pose,
        )
        exact = hb.symmetric if symmetric else hb.directed
        narrow = exact(
            as_arrays(source),
            as_arrays(target),
            tolerance=1e-12,
            pose=pose,
            target_pose=target_pose,
        )
        assert answer.interval.lower <= narrow.interval.upper
        header, rest = unsealed(file.read_bytes())
        return Pair(source, target, header, rest, narrow.interval.lower, pose, target_pose)


def stating(header: Header, upper: float, *, lower: float | None = None) -> Header:
    """A header that states this upper bound, and claims that each certificate proves no more."""
    changed = copy.deepcopy(header)
    changed["upper"] = upper
    for certificate in changed["certificates"]:
        certificate["proven"] = min(certificate["proven"], upper)
    changed["lower"] = min(header["lower"], upper) if lower is None else lower
    return changed


# --- the kinds
# ------------------------------------------------------------------------------------------------------------


def used_at_rest(forger: Forger) -> Forgery:
    """A true proof at a pose, checked at rest, or at another pose."""
    pair = forger.pair(moved=True)
    pose = None if forger.random.random() < 0.7 else forger.motion()
    return pair.forged(pair.header, pose=pose, target_pose=None, at_its_poses=False)


def pose_changed(forger: Forger) -> Forgery | None:
    """The file states another pose: one at which the distance is larger, or one that is not a
    motion."""
    pair = forger.pair()
    header = copy.deepcopy(pair.header)
    side, name = forger.random.choice([("source", "pose"), ("target", "target_pose")])
    how = forger.random.choice(["motion", "slightly", "scaled", "flat", "not finite"])
    old = getattr(pair, name)
    matrix = (np.eye(4) if old is None else old).copy()
    if how == "motion":
        matrix = forger.motion()
    elif how == "slightly":
        matrix[:3, 3] += [
            forger.random.uniform(-1, 1) * 10 ** forger.random.uniform(-9, 0) for _ in range(3)
        ]
    elif how == "scaled":
        matrix[:3, :3] *= 1 - 10 ** forger.random.uniform(-8, 0)
    elif how == "flat":
        matrix[forger.random.randint(0, 2), :3] = 0
    poses = {"pose": pair.pose, "target_pose": pair.target_pose, name: matrix}
    header[side]["pose"] = pose_numbers(matrix)
    if how == "not finite":
        header[side]["pose"][forger.random.randint(0, 11)] = forger.random.choice(
            ["nan", "inf", "-inf", None, 1e308]
        )
        return pair.forged(header)
    if how in ("motion", "slightly"):
        exact = hb.symmetric if header["quantity"] == "symmetric" else hb.directed
        there = exact(
            as_arrays(pair.source), as_arrays(pair.target), tolerance=1e-12, **poses
        ).interval.lower
        if there <= header["upper"] * (1 + 1e-12):
            return None
    return pair.forged(header, **poses)


def square(p: list[Fraction], q: list[Fraction]) -> Fraction:
    return sum(((x - y) ** 2 for x, y in zip(p, q)), Fraction(0))


def flattened(forger: Forger) -> Forgery | None:
    """A translation so large that rounding flattens A onto a point of B. The proof is true for the
    rounded points."""
    size = 10 ** forger.random.uniform(-3, 3)
    source = forger.soup(size, 1)
    far = 10 ** forger.random.uniform(
        math.log10(size) + 8, forger.random.choice([20, 20, 100, 300])
    )
    shift = [forger.random.uniform(-1, 1) * far for _ in range(3)]

    def shifted(point: tuple[float, ...]) -> tuple[float, ...]:
        return tuple(x + s for x, s in zip(point, shift))

    def exactly_shifted(point: tuple[float, ...]) -> list[Fraction]:
        return [Fraction(x) + Fraction(s) for x, s in zip(point, shift)]

    place = [shifted(v) for v in source[0]]
    both = forger.random.random() < 0.3
    points: Points = [place[0], place[0], place[0]] if not both else [source[0][0]] * 3
    target: Mesh = (points, [(0, 1, 2)])
    if forger.random.random() < 0.5:  # so that B is as large as the translation
        target = (
            points + [(0.0, 0.0, 0.0), (size, 0.0, 0.0), (0.0, size, 0.0)],
            [(0, 1, 2), (3, 4, 5)],
        )
    matrix = np.eye(4)
    matrix[:3, 3] = shift
    moved = [shifted(v) for v in target[0]] if both else target[0]
    claimed = max(math.dist(p, moved[0]) for p in place) * (1 + 1e-12)
    there = [exactly_shifted(v) for v in source[0]]
    to = [Fraction(x) + (Fraction(s) if both else 0) for x, s in zip(target[0][0], shift)]
    true = max(square(p, to) for p in there)
    if true <= (Fraction(claimed) * Fraction(11, 10)) ** 2:
        return None
    header = {
        "hausbench_certificate": 2,
        "source": {"file": "a.off", "sha256": sha256_of(source), "pose": pose_numbers(matrix)},
        "target": {
            "file": "b.off",
            "sha256": sha256_of(target),
            "pose": pose_numbers(matrix if both else np.eye(4)),
        },
        "quantity": "directed",
        "solver": "cover",
        "tolerance": 1e-6,
        "tolerance_of": "diagonal",
        "lower": 0,
        "upper": claimed,
        "witness": {
            "direction": "source to target",
            "source_point": ["nan"] * 3,
            "target_point": ["nan"] * 3,
            "source_element": -1,
            "target_element": -1,
        },
        "certificates": [
            {
                "format": "hausbench cover 1",
                "direction": "source to target",
                "proven": claimed,
                "bytes": 1,
            }
        ],
    }
    return Forgery(header, b"\x01", source, target, matrix, matrix if both else None)


def not_a_point(forger: Forger) -> Forgery | None:
    """A lower bound whose witness is NaN or infinite in some coordinates, or is left out."""
    pair = forger.pair()
    header = copy.deepcopy(pair.header)
    if not header["lower"] > 0:
        return None
    header["lower"] *= forger.random.choice([1, 0.5, forger.random.uniform(0, 1)])
    point = (
        "source_point" if header["witness"]["direction"] == "source to target" else "target_point"
    )
    bad = forger.random.choice(["nan", "inf", "-inf"])
    for k in forger.random.sample(range(3), forger.random.randint(1, 3)):
        header["witness"][point][k] = bad
    if forger.random.random() < 0.3:
        header["witness"]["source_element"] = header["witness"]["target_element"] = -1
    return pair.forged(header)


def without_witness(forger: Forger) -> Forgery | None:
    """A positive lower bound without a witness."""
    pair = forger.pair()
    header = copy.deepcopy(pair.header)
    if not header["upper"] > 0:
        return None
    header["lower"] = header["upper"] * forger.random.uniform(0.001, 1)
    header["witness"] |= {
        "source_point": ["nan"] * 3,
        "target_point": ["nan"] * 3,
        "source_element": -1,
        "target_element": -1,
    }
    if forger.random.random() < 0.3:
        del header["witness"][forger.random.choice(["source_point", "direction", "source_element"])]
    elif forger.random.random() < 0.2:
        del header["witness"]
    return pair.forged(header)


def crossed(forger: Forger) -> Forgery:
    """A lower bound above the upper one, or above the true distance."""
    pair = forger.pair()
    header = copy.deepcopy(pair.header)
    header["lower"] = forger.random.choice(
        [
            max(header["upper"], pair.lower) * (1 + 10 ** forger.random.uniform(-9, 3)) + 1e-300,
            math.nextafter(header["upper"], math.inf),
            1e308,
        ]
    )
    if forger.random.random() < 0.5:
        header["upper"] = header["lower"] * 2
    return pair.forged(header)


def off_the_shape(forger: Forger) -> Forgery:
    """A witness off the shape, which is farther from the other one than any point of the shape."""
    pair = forger.pair()
    header = copy.deepcopy(pair.header)
    forward = header["witness"]["direction"] == "source to target"
    point = np.array(header["witness"]["source_point" if forward else "target_point"], dtype=float)
    to = np.array(header["witness"]["target_point" if forward else "source_point"], dtype=float)
    way = point - to
    length = float(np.linalg.norm(way)) or 1.0
    moved = point + way / length * 10 ** forger.random.uniform(-6, 3)
    header["witness"]["source_point" if forward else "target_point"] = [float(x) for x in moved]
    if forger.random.random() < 0.5:
        header["witness"]["source_element"] = header["witness"]["target_element"] = -1
    header["lower"] = max(header["upper"], float(np.linalg.norm(moved - to))) * (1 + 1e-9)
    header["upper"] = header["lower"] * 2
    return pair.forged(header)


def upper_lowered(forger: Forger) -> Forgery | None:
    """An upper bound below the distance, claimed by the proof or stated in the answer alone."""
    pair = forger.pair()
    if not pair.lower > 0:
        return None
    false = pair.lower * (1 - 10 ** forger.random.uniform(-15, 0))
    if not false < pair.lower:
        return None
    header = stating(pair.header, false, lower=forger.random.choice([0, None]))
    if forger.random.random() < 0.5:
        header["certificates"] = copy.deepcopy(pair.header["certificates"])
    return pair.forged(header)


def swapped(forger: Forger) -> Forgery | None:
    """The shapes exchanged, in the call or in the file as well."""
    pair = forger.pair(moved=False, symmetric=False)
    header = copy.deepcopy(pair.header)
    if forger.random.random() < 0.3:
        return pair.forged(header, source=pair.target, target=pair.source)
    header["source"], header["target"] = header["target"], header["source"]
    header["witness"] |= {
        "source_point": ["nan"] * 3,
        "target_point": ["nan"] * 3,
        "source_element": -1,
        "target_element": -1,
    }
    header["lower"] = 0
    if (
        hb.directed(as_arrays(pair.target), as_arrays(pair.source), tolerance=1e-12).interval.lower
        <= header["upper"]
    ):
        return None
    return pair.forged(header, source=pair.target, target=pair.source)


def scaled(forger: Forger) -> Forgery | None:
    """Shapes of any size, up to the ends of the range of doubles, with a lowered upper bound or a
    raised lower one."""
    pair = forger.pair(moved=False)
    if not pair.lower > 1e-3:
        return None
    exponent = forger.random.choice([forger.random.randint(-1000, 1000), 1023, 1022, -1020, -1074])

    def times(mesh: Mesh) -> Mesh:
        points: Points = []
        for v in mesh[0]:
            points.append(tuple(math.ldexp(x, exponent) for x in v))
        return points, mesh[1]

    source, target = times(pair.source), times(pair.target)
    part = 1 - 10 ** forger.random.uniform(-9, 0)
    header = stating(pair.header, math.ldexp(pair.lower * part, exponent), lower=0)
    header["witness"] |= {
        "source_point": ["nan"] * 3,
        "target_point": ["nan"] * 3,
        "source_element": -1,
        "target_element": -1,
    }
    for certificate in header["certificates"]:
        certificate["proven"] = header["upper"]
    how = forger.random.choice(["claimed", "stated", "negative", "lower"])
    if how != "claimed":
        for certificate, old in zip(header["certificates"], pair.header["certificates"]):
            certificate["proven"] = (
                math.ldexp(old["proven"], exponent) if exponent < 1020 else 1.7e308
            )
    if how == "negative":
        header["upper"] = -abs(header["upper"]) - 5e-324
    elif how == "lower":
        header["upper"] = "inf"
        header["lower"] = math.ldexp(pair.lower, exponent - 1) or 5e-324
    elif not header["upper"] < math.ldexp(pair.lower, exponent) or exponent == -1074:
        return None
    header["source"]["sha256"], header["target"]["sha256"] = sha256_of(source), sha256_of(target)
    return pair.forged(header, source=source, target=target)


KINDS: dict[str, Callable[[Forger], Forgery | None]] = {
    forge.__name__: forge
    for forge in (
        used_at_rest,
        pose_changed,
        flattened,
        not_a_point,
        without_witness,
        crossed,
        off_the_shape,
        upper_lowered,
        swapped,
        scaled,
    )
}


# --- the checks
# -----------------------------------------------------------------------------------------------------------


class CLibrary:
    """hausbench_verify and hausbench_verify_posed, called through ctypes."""

    class Array(ctypes.Structure):
        _fields_ = [
            ("data", ctypes.c_void_p),
            ("rows", ctypes.c_int64),
            ("row_stride", ctypes.c_int64),
            ("column_stride", ctypes.c_int64),
            ("type", ctypes.c_int32),
            ("reserved", ctypes.c_int32),
        ]

    class Error(ctypes.Structure):
        _fields_ = [
            ("size", ctypes.c_size_t),
            ("code", ctypes.c_int32),
            ("argument", ctypes.c_int32),
            ("row", ctypes.c_int64),
            ("text", ctypes.c_char * 1024),
        ]

    class Verdict(ctypes.Structure):
        _fields_ = [
            ("size", ctypes.c_size_t),
            ("accepted", ctypes.c_int32),
            ("reserved", ctypes.c_int32),
            ("lower", ctypes.c_double),
            ("upper", ctypes.c_double),
            ("proven", ctypes.c_double),
            ("text", ctypes.c_char * 1024),
            ("source_pose", ctypes.c_double * 16),
            ("target_pose", ctypes.c_double * 16),
        ]

    def __init__(self, file: Path):
        self.library = ctypes.CDLL(str(file))

    def shape(self, mesh: Mesh) -> ctypes.c_void_p:
        tables = []
        for array, kind in zip(as_arrays(mesh), (0, 2)):
            tables.append((array, self.Array(array.ctypes.data, len(array), 24, 8, kind, 0)))
        shape, error = ctypes.c_void_p(), self.Error(ctypes.sizeof(self.Error))
        code = self.library.hausbench_shape_of(
            ctypes.byref(tables[0][1]),
            ctypes.byref(tables[1][1]),
            ctypes.byref(shape),
            ctypes.byref(error),
        )
        assert code == 0, error.text
        return shape

    def accepts(self, file: Path, forgery: Forgery) -> bool:
        a, b = self.shape(forgery.source), self.shape(forgery.target)
        verdict, error = self.Verdict(ctypes.sizeof(self.Verdict)), self.Error(
            ctypes.sizeof(self.Error)
        )
        tail = (ctypes.byref(verdict), ctypes.byref(error))
        poses = [
            None if pose is None else (ctypes.c_double * 16)(*pose.ravel())
            for pose in (forgery.pose, forgery.target_pose)
        ]
        if poses == [None, None]:
            code = self.library.hausbench_verify(str(file).encode(), a, b, *tail)
        else:
            code = self.library.hausbench_verify_posed(str(file).encode(), a, b, *poses, *tail)
        for shape in (a, b):
            self.library.hausbench_shape_release(shape)
        return bool(code == 0 and verdict.accepted)


def accepted_by(
    forgery: Forgery, folder: Path, c: CLibrary | None, program: Path | None
) -> list[str]:
    """Returns who accepts the forgery."""
    file = folder / "forged"
    file.write_bytes(sealed(forgery.header, forgery.rest))
    who = []
    try:
        if hb.verify(
            file,
            as_arrays(forgery.source),
            as_arrays(forgery.target),
            pose=forgery.pose,
            target_pose=forgery.target_pose,
        ):
            who.append("Python")
    except hb.InputError:
        pass
    if c and c.accepts(file, forgery):
        who.append("C")
    if program and forgery.at_its_poses:
        for name, mesh in (("a.off", forgery.source), ("b.off", forgery.target)):
            (folder / name).write_text(off_text(mesh))
        done = subprocess.run(
            [program, "verify", "--certificate", file, folder / "a.off", folder / "b.off"],
            capture_output=True,
            text=True,
            check=False,
        )
        if done.returncode not in (1, 2):
            who.append(f"the program (exit code {done.returncode})")
    return who


def forgeries(kind: str, count: int, seed: int, folder: Path) -> Iterator[Forgery]:
    made = tried = 0
    forger = Forger(seed, folder)
    while made < count:
        tried += 1
        assert tried < 20 * count + 100, f"{kind}: hardly ever makes a forgery"
        if (forgery := KINDS[kind](forger)) is not None:
            made += 1
            yield forgery


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument(
        "--program",
        type=Path,
        default=Path(os.environ.get("HAUSBENCH_PROGRAM", ROOT / "build" / "release" / "hausbench")),
    )
    parser.add_argument("--count", type=int, default=1000, help="of each kind")
    parser.add_argument("--each", type=int, default=10, help="the program checks each such one")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--kind", action="append", choices=sorted(KINDS))
    options = parser.parse_args()
    wrong = 0
    c = CLibrary(options.program.parent / "library" / "libhausbench.so")
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        for kind in options.kind or KINDS:
            accepted = 0
            for i, forgery in enumerate(forgeries(kind, options.count, options.seed, folder)):
                if who := accepted_by(
                    forgery, folder, c, options.program if i % options.each == 0 else None
                ):
                    accepted += 1
                    if accepted <= 3:
                        print(
                            f"{kind} {i}: accepted by {' and '.join(who)}: {json.dumps(forgery.header)[:600]}",
                            file=sys.stderr,
                        )
            print(f"{kind}: {options.count} forged, {accepted} accepted", flush=True)
            wrong += accepted
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
