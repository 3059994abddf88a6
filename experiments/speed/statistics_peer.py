"""MeshLab and CloudCompare as peers (solver `external`): the mean distance of A to B from samples
of A, and the time it took.

    statistics_peer.py MeshLab|CloudCompare A.off B.off SAMPLES

Runs the program on one core. The time excludes starting the program and reading files. For MeshLab,
it is the time of a run minus the median of three runs that only start and read. For CloudCompare,
it is the time that the program prints, which also excludes sampling. Both programs compute with
floats. Coordinates are scaled, because MeshLab prints only six digits after the point.

MeshLab takes the same samples in every run. CloudCompare does not, so this script makes its
samples. CloudCompare prints the mean of the signed distances, so the unsigned mean is computed from
the distances that it saves.
"""

from __future__ import annotations

import os
import re
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

SIZE = 5e3  # the diagonal of A after scaling; CloudCompare calls coordinates above 10^4 very big
SCRIPT = """<!DOCTYPE FilterScript>
<FilterScript>
 <filter name="Hausdorff Distance">
  <Param name="SampledMesh" type="RichMesh" value="0"/>
  <Param name="TargetMesh" type="RichMesh" value="1"/>
  <Param name="SaveSample" type="RichBool" value="false"/>
  <Param name="SampleVert" type="RichBool" value="false"/>
  <Param name="SampleEdge" type="RichBool" value="false"/>
  <Param name="SampleFauxEdge" type="RichBool" value="false"/>
  <Param name="SampleFace" type="RichBool" value="true"/>
  <Param name="SampleNum" type="RichInt" value="{samples}"/>
  <Param name="MaxDist" type="RichAbsPerc" value="{most}" min="0" max="{most}"/>
 </filter>
</FilterScript>
"""
NOTHING = "<!DOCTYPE FilterScript>\n<FilterScript>\n</FilterScript>\n"

Points = npt.NDArray[np.float64]
Triangles = npt.NDArray[np.int64]


class Answer(NamedTuple):
    mean: float  # of the scaled shapes
    seconds: float


class Mesh(NamedTuple):
    points: Points
    triangles: Triangles

    def moved(self, middle: Points, scale: float) -> Mesh:
        return Mesh((self.points - middle) * scale, self.triangles)

    def sampled(self, count: int) -> Points:
        """Returns random points, as many on every unit of area on average; the same each time."""
        random = np.random.default_rng(0)
        a, b, c = (self.points[self.triangles[:, k]] for k in range(3))
        areas = np.linalg.norm(np.cross(b - a, c - a), axis=1)
        chosen = random.choice(len(areas), count, p=areas / areas.sum())
        u, v = random.random((2, count, 1))
        u, v = np.where(u + v > 1, 1 - u, u), np.where(u + v > 1, 1 - v, v)
        points: Points = a[chosen] + u * (b - a)[chosen] + v * (c - a)[chosen]
        return points


def read(file: Path) -> Mesh:
    head, counts, rows = file.read_text(encoding="ascii").split("\n", 2)
    if head != "OFF":
        raise SystemExit(f"{file}: not an OFF file as hausbench writes it")
    vertices, faces = map(int, counts.split()[:2])
    lines = rows.split("\n")
    triangles = np.loadtxt(lines[vertices : vertices + faces], dtype=np.int64, ndmin=2)
    return Mesh(np.loadtxt(lines[:vertices], ndmin=2), triangles[:, 1:])


def write(file: Path, mesh: Mesh) -> None:
    with file.open("w", encoding="ascii") as out:
        print(f"OFF\n{len(mesh.points)} {len(mesh.triangles)} 0", file=out)
        np.savetxt(out, mesh.points, fmt="%.9g")
        np.savetxt(out, mesh.triangles, fmt="3 %d %d %d")


def run(folder: Path, *command: str) -> tuple[str, float]:
    """Returns what the program printed, and the wall time."""
    begin = time.perf_counter()
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    seconds = time.perf_counter() - begin
    if done.returncode != 0:
        raise SystemExit(
            f"{command[0]} ended with {done.returncode}: {(done.stdout + done.stderr)[-300:]}"
        )
    return done.stdout + done.stderr, seconds


def number(text: str, pattern: str) -> float:
    matches = re.findall(pattern, text)
    if not matches:
        raise SystemExit(f"no number like '{pattern}' in: {text[-300:]}")
    return float(matches[-1])


def meshlab(folder: Path, _: Mesh, samples: int) -> Answer:
    (folder / "measure.mlx").write_text(
        SCRIPT.format(samples=samples, most=10 * SIZE), encoding="ascii"
    )
    (folder / "nothing.mlx").write_text(NOTHING, encoding="ascii")
    start = ["xvfb-run", "-a", "meshlabserver", "-i", "A.off", "B.off", "-s"]  # it needs a display
    idle = statistics.median(run(folder, *start, "nothing.mlx")[1] for _ in range(3))
    text, seconds = run(folder, *start, "measure.mlx")
    return Answer(number(text, r"mean : (\S+)\s+RMS.*\nValues w.r.t."), max(0.0, seconds - idle))


def cloudcompare(folder: Path, a: Mesh, samples: int) -> Answer:
    os.environ["QT_QPA_PLATFORM"] = "offscreen"
    np.savetxt(folder / "samples.asc", a.sampled(samples), fmt="%.9g")
    text, _ = run(
        folder,
        "CloudCompare",
        "-SILENT",
        "-AUTO_SAVE",
        "OFF",
        "-NO_TIMESTAMP",
        "-C_EXPORT_FMT",
        "ASC",
        "-PREC",
        "9",
        "-O",
        "samples.asc",
        "-O",
        "B.off",
        "-C2M_DIST",
        "-SAVE_CLOUDS",
        "FILE",
        "distances.asc",
    )
    seconds = number(text, r"\[computeApproxDistances\] Time: (\S+) s") + number(
        text, r"\[ComputeDistances\] Time: (\S+) s"
    )
    return Answer(float(np.abs(np.loadtxt(folder / "distances.asc", usecols=-1)).mean()), seconds)


PROGRAMS: dict[str, Callable[[Path, Mesh, int], Answer]] = {
    "MeshLab": meshlab,
    "CloudCompare": cloudcompare,
}


def main() -> None:
    if len(sys.argv) != 5 or sys.argv[1] not in PROGRAMS:
        raise SystemExit(__doc__)
    os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
    a, b = read(Path(sys.argv[2])), read(Path(sys.argv[3]))
    scale, middle = SIZE / float(np.linalg.norm(np.ptp(a.points, axis=0))), a.points.mean(axis=0)
    a, b = a.moved(middle, scale), b.moved(middle, scale)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        write(folder / "A.off", a)
        write(folder / "B.off", b)
        answer = PROGRAMS[sys.argv[1]](folder, a, int(sys.argv[4]))
    print(f"mean {answer.mean / scale:.12g}\nseconds {answer.seconds:.6g}")


if __name__ == "__main__":
    main()
