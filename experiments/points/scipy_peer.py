"""SciPy as a peer (solver `external`): the directed distance of the points of two OFF files, and
the time it took.

    scipy_peer.py cKDTree|directed_hausdorff A.off B.off

The time is that of building and asking once, as everybody else is timed, without starting Python
and reading files.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import numpy.typing as npt
from scipy.spatial import cKDTree
from scipy.spatial.distance import directed_hausdorff

Points = npt.NDArray[np.float64]


def read(file: Path) -> Points:
    head, counts, rows = file.read_text(encoding="ascii").split("\n", 2)
    if head != "OFF":
        raise SystemExit(f"{file}: not an OFF file as hausbench writes it")
    count = int(counts.split()[0])
    return np.fromstring(rows, sep=" ", count=3 * count).reshape(count, 3)


def by_tree(a: Points, b: Points) -> float:
    distances, _ = cKDTree(b).query(a)
    return float(distances.max())


def by_early_break(a: Points, b: Points) -> float:
    return float(directed_hausdorff(a, b)[0])


METHODS: dict[str, Callable[[Points, Points], float]] = {
    "cKDTree": by_tree,
    "directed_hausdorff": by_early_break,
}


def main() -> None:
    method, a, b = METHODS[sys.argv[1]], read(Path(sys.argv[2])), read(Path(sys.argv[3]))
    begin = time.perf_counter()
    distance = method(a, b)
    seconds = time.perf_counter() - begin
    print(f"distance {distance:.17g}\nseconds {seconds:.9g}")


if __name__ == "__main__":
    main()
