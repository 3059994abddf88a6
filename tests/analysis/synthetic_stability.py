"""Made-up result files of the stability suite with known outcomes, and the shapes behind them.

`python3 tests/analysis/synthetic_stability.py DIR` writes a file of the suite's size. To look at
its figures, run `HAUSBENCH_CACHE=DIR python3 -m analysis stability_matrix --results DIR --out DIR`.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from synthetic import NAN, ResultFile, without_bounds

U = 2.0**-53
POINTS = ("naive", "nohd", "nohd_as_printed", "scan", "kdtree")
MESHES = ("guthe", "guthe, textbook kernel", "sacht", "cover", "sampling", "cgal")
SURFACES = ("surface_enclosure",)
KINDS = {"points": POINTS, "mesh": MESHES, "surface": SURFACES}
NOT_CERTIFIED = ("nohd_as_printed", "ohd_as_printed", "kdtree", "cgal", "guthe, textbook kernel")
TAKES_NO = {
    "points": "takes no points as source",
    "mesh": "takes no mesh as source",
    "surface": "takes no surface as source",
}


def write_shapes(file: ResultFile, cache: Path, largest: dict[str, float]) -> None:
    """Writes a shape for each model. Its largest coordinate is the value in `largest`, or else
    1."""
    (cache / "shapes").mkdir(parents=True, exist_ok=True)
    for model in file.models:
        if model.get("kind") == "surface":
            continue
        with h5py.File(cache / "shapes" / f"{model['sha256']}.h5", "w") as shape:
            shape.attrs["shape_schema"], shape.attrs["content_hash"] = 1, model["sha256"]
            shape["coordinates"] = np.array(
                [[0.0, 0, 0], [0.5, 0, -largest.get(model["name"], 1.0)], [0, 0.25, 0]]
            )


class Sweeps:
    """Adds families of scenes. Every solver gets a row; it is "not applicable" if the solver takes
    another kind of shape."""

    def __init__(self) -> None:
        self.file = ResultFile("stability_matrix", cpu=1.0)
        self.largest: dict[str, float] = {}

    def family(
        self,
        name: str,
        kind: str,
        severities: list[float],
        ends: dict[str, list[dict[str, Any]]] | None = None,
        largest: list[float] | None = None,
        tolerances: tuple[float, ...] = (1e-6,),
        **columns: Any,
    ) -> None:
        """Without an entry in `ends`, a solver answers within the tolerance; an entry lists, by
        severity, the columns that differ."""
        for k, severity in enumerate(severities):
            scene = f"{kind} {name} {severity:g}" if severity == severity else name
            common: dict[str, Any] = {
                "scene": scene,
                "family": name if severity == severity else "",
                "severity": severity,
                "exact": 0.5,
                "case_seconds_limit": 2.0,
                "scene_note": f"note of {name}",
                "lower": 0.5,
                **columns,
            }
            for tolerance in tolerances:
                for of, labels in KINDS.items():
                    for label in labels:
                        case = common | {
                            "label": label,
                            "tolerance": tolerance,
                            "upper": 0.5 + tolerance / 2,
                            "certified": int(label not in NOT_CERTIFIED),
                        }
                        if of != kind:
                            refused = without_bounds(
                                "skipped", f"solver '{label}' {TAKES_NO[kind]}", case
                            )
                            case |= refused | {"solver_status": "", "certified": -1}
                        else:
                            changes = (ends or {}).get(label, [])
                            case |= changes[min(k, len(changes) - 1)] if changes else {}
                        self._add(label, case)
            for side in "AB":
                model = next((m for m in self.file.models if m["name"] == f"{scene}/{side}"), None)
                if model is None:
                    continue
                model["kind"] = kind
                if largest:
                    self.largest[f"{scene}/{side}"] = largest[k]
                if kind == "surface":
                    model["box"] = [-1.0, 1.0, -1.0, 1.0, -1.0, 1.0]

    def _add(self, label: str, columns: dict[str, Any]) -> None:
        answered = columns["status"] if "status" in columns else "ok"
        seconds = [columns.pop("seconds", 0.01)] if answered in ("ok", "floor", "budget") else []
        self.file.case(
            label.split(",")[0],
            seconds=seconds,
            counters={"node_visits": 100 + len(self.file.cases) % 900} if seconds else {},
            **columns,
        )


def killed(status: str, reason: str, **columns: Any) -> dict[str, Any]:
    return {"solver_status": "", **without_bounds(status, reason, columns)}


GOOD: dict[str, Any] = {}
WRONG: dict[str, Any] = {"lower": 0.6, "upper": 0.6}
UNSOUND: dict[str, Any] = {
    "lower": 0.6,
    "upper": 0.6,
    "status": "unsound",
    "lower_check": "unsound",
}
LOOSE: dict[str, Any] = {
    "lower": 0.25,
    "upper": 0.75,
    "status": "failed",
    "solver_status": "stalled",
    "reason": "the solver could not go on: the bounds hold",
}
FLOOR: dict[str, Any] = {
    "lower": 0.25,
    "upper": 0.75,
    "status": "floor",
    "solver_status": "precision_floor",
}
BUDGET: dict[str, Any] = {
    "lower": 0.25,
    "upper": 0.75,
    "status": "budget",
    "solver_status": "budget",
}
TIMEOUT: dict[str, Any] = {
    "lower": 0.25,
    "upper": 0.75,
    "status": "timeout",
    "solver_status": "time_limit",
}
HUNG = killed("timeout", "not within 2 s: killed")
CRASHED = killed("signal", "SIGSEGV")
REFUSED = killed("failed", "coordinates must be finite")
MISSING = killed("skipped", "its origin 'hand' is missing: run datasets/fetch.py")


def small() -> Sweeps:
    """Every outcome occurs. 4 of 22 answers of certified solvers are bad; 8 of the 13 with a
    reachable tolerance are tight, sampling left out."""
    made = Sweeps()
    made.family(
        "offset",
        "points",
        [1e4, 1e8, 1e12],
        {"nohd_as_printed": [GOOD, WRONG, WRONG], "naive": [GOOD, GOOD, HUNG]},
        largest=[1.0, 1.0, 1e12],
    )
    made.family(
        "needle",
        "mesh",
        [10.0, 1e6],
        {
            "guthe": [GOOD, LOOSE],
            "guthe, textbook kernel": [GOOD, UNSOUND],
            "cgal": [GOOD, CRASHED],
            "sacht": [FLOOR, TIMEOUT],
            "sampling": [BUDGET, BUDGET],
            "cover": [GOOD, REFUSED],
        },
    )
    made.family(
        "not numbers",
        "mesh",
        [NAN],
        {label: [REFUSED] for label in MESHES if label != "sacht"} | {"sacht": [GOOD]},
        scene_note="not legal: a coordinate is not a number",
    )
    made.family("missing", "mesh", [1.0], {label: [MISSING] for label in MESHES})
    made.family("concentric", "surface", [0.1], {"surface_enclosure": [CRASHED]}, exact=NAN)
    return made


def large() -> Sweeps:
    """Makes as many families and solvers as the real suite has, with random outcomes."""
    global KINDS
    before = KINDS
    KINDS = {
        "points": (
            "naive",
            "earlybreak",
            "inc",
            "nohd",
            "nohd_as_printed",
            "ohd",
            "ohd_as_printed",
            "adaptive",
            "scan",
            "kdtree",
        ),
        "mesh": (
            "sampling",
            "guthe",
            "guthe, textbook kernel",
            "tang",
            "kang",
            "zheng",
            "sacht",
            "cover",
            "cgal",
        ),
        "surface": ("interval_subdivision", "surface_enclosure", "surface_meshes"),
    }
    rng, made = np.random.default_rng(7), Sweeps()
    words = (
        "offset",
        "scale",
        "needle",
        "cap",
        "sliver sheet",
        "coincident vertices",
        "spread of sizes",
        "near ties",
        "parallel planes",
        "thin gap",
        "far apart",
        "duplicates",
        "subnormal",
        "cluster and outlier",
        "grid noise",
        "flat box",
        "nested shells",
        "fan",
        "shear",
    )
    for kind, count in (("points", 13), ("mesh", 19), ("surface", 8)):
        for i in range(count):
            steps = int(rng.integers(1, 11))
            if i % 3:
                severities = [10.0 ** (k + 1) for k in range(steps)]
            else:
                severities = [10.0 ** -(2 * k + 1) for k in range(steps)]
            ends = {}
            for label in KINDS[kind]:
                at = int(rng.integers(0, 2 * steps + 1))
                error = 1e-16 * 10.0 ** (1 + np.arange(steps))
                good = [
                    {"lower": 0.5 - x, "upper": 0.5 + x / 2} if x < 2e-7 else FLOOR for x in error
                ]
                if label in ("sampling",):
                    good = [BUDGET] * steps
                bad = {
                    "cgal": [CRASHED, WRONG, HUNG],
                    "naive": [HUNG],
                    "guthe, textbook kernel": [WRONG],
                    "nohd_as_printed": [WRONG],
                    "ohd_as_printed": [WRONG],
                    "inc": [TIMEOUT],
                    "kang": [LOOSE],
                    "tang": [TIMEOUT],
                    "zheng": [FLOOR],
                    "kdtree": [GOOD],
                    "interval_subdivision": [TIMEOUT, HUNG],
                }.get(label, [FLOOR])
                ends[label] = [
                    good[k] if k < at else bad[int(rng.integers(0, len(bad)))] for k in range(steps)
                ]
            made.family(
                words[i],
                kind,
                severities,
                ends,
                largest=[max(1.0, x) for x in severities],
                exact=NAN if i % 7 == 6 else 0.5,
            )
    made.family(
        "not a number",
        "mesh",
        [NAN],
        {label: [REFUSED] for label in KINDS["mesh"]},
        scene_note="not legal: a coordinate is not a number",
    )
    made.family("missing", "mesh", [1.0, 2.0], {label: [MISSING] for label in KINDS["mesh"]})
    KINDS = before
    return made


if __name__ == "__main__":
    folder = Path(sys.argv[1])
    shown = large()
    shown.file.write(folder)
    write_shapes(shown.file, folder, shown.largest)
