"""The scenes that the report shows in 3-D: rows with the distance at each corner of A, and motions
of A.

Everything comes from result files and the cache of shapes; a scene whose shapes are not in the
cache, or cannot be shown, is left out.
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


def pairs_of_meshes(results: Results) -> list[int]:
    """Returns the rows with bounds between two meshes, without the stability suite, whose scenes
    are made to be hard, not to be seen."""
    cases, kinds = results.cases, dict(zip(results.models.name, results.models.kind))
    return [
        row
        for row in range(len(cases))
        if kinds.get(cases.source[row]) == kinds.get(cases.target[row]) == "mesh"
        and results.is_bounded(row)
        and np.isnan(cases.severity[row])
    ]


def with_fields(results: Results, rows: list[int]) -> list[int]:
    """Returns one row with the field `distance` for each scene, with the field `bound` if there is
    one."""
    chosen: dict[str, int] = {}
    for row in set(rows) & set(map(int, results.fields.case)):
        names, scene = results.fields_of(row).keys(), str(results.cases.scene[row])
        if DISTANCE in names and (
            scene not in chosen
            or (BOUND in names, -row) > (BOUND in results.fields_of(chosen[scene]), -chosen[scene])
        ):
            chosen[scene] = row
    return sorted(chosen.values())


def motions(results: Results, rows: list[int]) -> list[list[int]]:
    """Returns the rows of each motion with at least three poses, of the first certified solver, in
    the order of the poses."""
    by_scene: dict[str, dict[int, int]] = {}
    label: dict[str, str] = {}
    for row in rows:
        scene, pose = str(results.cases.scene[row]), int(results.cases.pose_index[row])
        if (
            results.cases.certified[row] == 1
            and label.setdefault(scene, str(results.cases.label[row])) == results.cases.label[row]
        ):
            by_scene.setdefault(scene, {}).setdefault(pose, row)
    in_order = []
    for by_pose in by_scene.values():
        if len(by_pose) > 2:
            in_order.append([by_pose[pose] for pose in sorted(by_pose)])
    return in_order


def shape(results: Results, model: str) -> shapes.Mesh:
    """Loads a mesh. Raises ResultError if it is not in the cache or cannot be shown."""
    mesh = shapes.mesh(results, model)
    if not display.can_be_shown(mesh):
        raise ResultError(f"{results.path}: model '{model}' is too large or too small to be shown")
    return mesh


def _common(results: Results, row: int) -> dict[str, Any]:
    cases = results.cases
    witness = np.concatenate([cases.witness_source[row], cases.witness_target[row]])
    return {
        "title": style.scene_title(str(cases.scene[row])),
        "stem": results.stem,
        "solver": str(results.names[row]),
        "quantity": str(cases.quantity[row]),
        "witness": witness.tolist() if np.isfinite(witness).all() else None,
    }


def still(results: Results, row: int, meshes: Meshes) -> dict[str, Any]:
    """Describes a row with fields."""
    cases, fields = results.cases, results.fields_of(row)
    a, b = (shape(results, str(name)) for name in (cases.source[row], cases.target[row]))
    distance = fields[DISTANCE][: len(a.corners)]  # A's own corners come first
    shown = display.simplify(a, distance)
    colours: dict[str, Any] = {DISTANCE: display.quantised(distance[shown.corners])}
    if BOUND in fields and len(fields[BOUND]) == len(a.triangles):
        colours[BOUND] = display.text(fields[BOUND][shown.elements].astype("u1"))
    return _common(results, row) | {
        "a": meshes.add((f"{results.stem} {row}", "coloured"), a, shown),
        "colours": colours,
        "b": meshes.add((_hash(results, str(cases.target[row])), "plain"), b, display.simplify(b)),
        "poses": [[*cases.pose[row].tolist(), *cases.target_pose[row].tolist()]],
        "lower": [float(cases.lower[row])],
        "upper": [float(cases.upper[row])],
    }


def moving(results: Results, rows: list[int], meshes: Meshes) -> dict[str, Any]:
    """Describes a motion."""
    cases = results.cases
    rows = rows[:: 1 + (len(rows) - 1) // MOST_POSES]
    a, b = (shape(results, str(name)) for name in (cases.source[rows[0]], cases.target[rows[0]]))
    poses = [[*cases.pose[row].tolist(), *cases.target_pose[row].tolist()] for row in rows]
    lower = [float(cases.lower[row]) for row in rows]
    upper = [float(cases.upper[row]) for row in rows]
    return _common(results, rows[0]) | {
        "a": meshes.add(
            (_hash(results, str(cases.source[rows[0]])), "plain"), a, display.simplify(a)
        ),
        "colours": {},
        "b": meshes.add(
            (_hash(results, str(cases.target[rows[0]])), "plain"), b, display.simplify(b)
        ),
        "witness": None,
        "poses": poses,
        "lower": lower,
        "upper": upper,
    }


def _hash(results: Results, model: str) -> str:
    return str(dict(zip(results.models.name, results.models.sha256))[model])


def described(results: dict[str, Results]) -> dict[str, Any]:
    """Returns {meshes, scenes} for view.js: at most MOST_SCENES, stills before motions."""
    meshes, scenes = Meshes(), list[dict[str, Any]]()
    pairs = [(result, pairs_of_meshes(result)) for result in results.values()]
    stills = [(result, row) for result, rows in pairs for row in with_fields(result, rows)]
    moved = [(result, motion) for result, rows in pairs for motion in motions(result, rows)]
    for result, row in stills[: MOST_SCENES - min(len(moved), MOST_SCENES // 3)]:
        try:
            scenes.append(still(result, row, meshes))
        except ResultError:
            continue
    for result, motion in moved[: MOST_SCENES - len(scenes)]:
        try:
            scenes.append(moving(result, motion, meshes))
        except ResultError:
            continue
    return {"meshes": meshes.packed, "scenes": scenes}
