"""The scenes that the report shows in 3-D: rows with the distance at each corner of A, and motions of A.

Everything comes from result files and the cache of shapes; a scene whose shapes are not in the cache is left out.
"""

from __future__ import annotations

from typing import Any, Final

import numpy as np

from analysis.report import display
from analysis.shared import shapes, style
from analysis.shared.results import ResultError, Results

MOST_SCENES: Final = 24
MOST_POSES: Final = 200
DISTANCE, BOUND = "distance", "bound"


class Meshes:
    """The meshes of all scenes, each once."""

    def __init__(self) -> None:
        self.packed: list[dict[str, Any]] = []
        self._place: dict[tuple[str, str], int] = {}

    def add(self, key: tuple[str, str], mesh: shapes.Mesh, shown: display.Display) -> int:
        if key not in self._place:
            self._place[key] = len(self.packed)
            self.packed.append(display.packed(mesh, shown))
        return self._place[key]


def is_pair_of_meshes(results: Results, row: int) -> bool:
    kinds = dict(zip(results.models.name, results.models.kind))
    return kinds.get(results.cases.source[row]) == kinds.get(results.cases.target[row]) == "mesh"


def with_fields(results: Results) -> list[int]:
    """Returns one row with the field `distance` for each scene, with the field `bound` if there is one."""
    chosen: dict[str, int] = {}
    for row in dict.fromkeys(int(row) for row in results.fields.case):
        names = results.fields_of(row)
        scene = str(results.cases.scene[row])
        if DISTANCE in names and is_pair_of_meshes(results, row) and (scene not in chosen or BOUND in names):
            chosen.setdefault(scene, row)
            if BOUND in names and BOUND not in results.fields_of(chosen[scene]):
                chosen[scene] = row
    return list(chosen.values())


def motions(results: Results) -> list[list[int]]:
    """Returns the rows of each motion of a mesh towards a mesh, of the first certified solver, in the order of the poses."""
    found = []
    for scene in results.scenes:
        rows = [row for row in results.rows(scene=scene, certified=1) if results.is_bounded(row) and is_pair_of_meshes(results, row)]
        label = results.cases.label[rows[0]] if rows else ""
        by_pose = {int(results.cases.pose_index[row]): row for row in reversed(rows) if results.cases.label[row] == label}
        if len(by_pose) > 2:
            found.append([by_pose[pose] for pose in sorted(by_pose)])
    return found


def _common(results: Results, row: int) -> dict[str, Any]:
    cases = results.cases
    witness = np.concatenate([cases.witness_source[row], cases.witness_target[row]])
    return {"title": style.scene_title(str(cases.scene[row])), "stem": results.stem, "solver": str(results.names[row]), "quantity": str(cases.quantity[row]),
            "witness": witness.tolist() if np.isfinite(witness).all() else None}


def still(results: Results, row: int, meshes: Meshes) -> dict[str, Any]:
    """Describes a row with fields."""
    cases, fields = results.cases, results.fields_of(row)
    a, b = (shapes.mesh(results, str(name)) for name in (cases.source[row], cases.target[row]))
    distance = fields[DISTANCE][:len(a.corners)]  # A's own corners come first
    shown = display.simplify(a, distance)
    colours: dict[str, Any] = {DISTANCE: display.quantised(distance[shown.corners])}
    if BOUND in fields and len(fields[BOUND]) == len(a.triangles):
        colours[BOUND] = display.text(fields[BOUND][shown.elements].astype("u1"))
    return _common(results, row) | {"a": meshes.add((f"{results.stem} {row}", "A"), a, shown), "colours": colours,
                                    "b": meshes.add((_hash(results, str(cases.target[row])), "B"), b, display.simplify(b)),
                                    "poses": [[*cases.pose[row].tolist(), *cases.target_pose[row].tolist()]], "lower": [float(cases.lower[row])],
                                    "upper": [float(cases.upper[row])]}


def moving(results: Results, rows: list[int], meshes: Meshes) -> dict[str, Any]:
    """Describes a motion."""
    cases = results.cases
    rows = rows[::1 + (len(rows) - 1) // MOST_POSES]
    a, b = (shapes.mesh(results, str(name)) for name in (cases.source[rows[0]], cases.target[rows[0]]))
    return _common(results, rows[0]) | {"a": meshes.add((_hash(results, str(cases.source[rows[0]])), "B"), a, display.simplify(a)), "colours": {},
                                        "b": meshes.add((_hash(results, str(cases.target[rows[0]])), "B"), b, display.simplify(b)), "witness": None,
                                        "poses": [[*cases.pose[row].tolist(), *cases.target_pose[row].tolist()] for row in rows],
                                        "lower": [float(cases.lower[row]) for row in rows], "upper": [float(cases.upper[row]) for row in rows]}


def _hash(results: Results, model: str) -> str:
    return str(dict(zip(results.models.name, results.models.sha256))[model])


def described(results: dict[str, Results]) -> dict[str, Any]:
    """Returns {meshes, scenes} for view.js: at most MOST_SCENES, stills before motions."""
    meshes, scenes = Meshes(), list[dict[str, Any]]()
    wanted = [(one, row) for one in results.values() for row in with_fields(one)]
    moved = [(one, rows) for one in results.values() for rows in motions(one)]
    for one, row in wanted[:MOST_SCENES - min(len(moved), MOST_SCENES // 3)]:
        try:
            scenes.append(still(one, row, meshes))
        except ResultError:
            continue
    for one, rows in moved[:MOST_SCENES - len(scenes)]:
        try:
            scenes.append(moving(one, rows, meshes))
        except ResultError:
            continue
    return {"meshes": meshes.packed, "scenes": scenes}
