"""The tracked cases, each a solver on a scene of experiments/tracking.toml, and kernels, each a
benchmark of kernel_bench."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import tomli_w

ROOT = Path(__file__).resolve().parents[2]
EXPERIMENT = ROOT / "experiments" / "tracking.toml"
MESH = "torus:60"  # the mesh for kernels: 7,200 triangles, generated
MOST_CASES = 28


@dataclass(frozen=True)
class Case:
    """A solver on a scene, as an experiment of its own, which a commit can run if it knows the keys
    and models."""

    name: str  # "guthe on mesh to its half"
    experiment: dict[str, Any]

    def text(self) -> str:
        return tomli_w.dumps(self.experiment)

    @property
    def solver(self) -> str:
        name: str = self.experiment["solver"][0]["name"]
        return name

    @property
    def models(self) -> list[str]:
        scene = self.experiment["scene"][0]
        return [scene["source"], scene["target"]]


@dataclass(frozen=True)
class Kernel:
    """A benchmark of kernel_bench: builds a structure, or queries it from each vertex of a mesh."""

    name: str  # "build/bvh"
    function: str  # the function whose instructions are counted, as callgrind's --toggle-collect takes it


BUILD_KERNELS = tuple(
    Kernel(f"build/{name}", f"*make_structure<hausbench::{structure},*")
    for name, structure in (
        ("bvh", "TriangleBvh"),
        ("octree", "TriangleOctree"),
        ("swept_bvh", "tang::SweptSphereBvh"),
        ("triangle_blocks", "TriangleBlocks"),
        ("triangle_grid", "TriangleGrid"),
        ("adjacency", "tang::Adjacency"),
        ("point_octree", "zhang2017::PointOctree"),
        ("point_blocks", "scan::PointBlocks"),
        ("rtree", "inc::RTree"),
    )
)
CLOSEST_KERNELS = tuple(
    Kernel(name, f"hausbench::{function}(*")
    for name, function in (
        ("closest/bvh/cold", "TriangleTree::closest"),
        ("closest/octree/cold", "TriangleTree::closest"),
        ("closest/triangle_blocks/cold", "TriangleBlocks::closest"),
        ("closest/triangle_grid/cold", "TriangleGrid::closest"),
    )
)
KERNELS = BUILD_KERNELS + CLOSEST_KERNELS


def cases(file: Path = EXPERIMENT) -> list[Case]:
    """Returns the cases in the order of the file's solvers. Raises ValueError for more than
    MOST_CASES, or an unknown scene."""
    table = tomllib.loads(file.read_text())
    common = {
        key: value for key, value in table.items() if key not in ("scene", "solver", "profile")
    }
    scenes = {scene["name"]: scene for scene in table["scene"]}
    listed = []
    for solver in table["solver"]:
        for name in solver.get("scenes", scenes):
            if name not in scenes:
                raise ValueError(f"{file}: solver {solver['name']}: there is no scene {name!r}")
            alone = {key: value for key, value in solver.items() if key != "scenes"}
            listed.append(
                Case(
                    f"{solver.get('label', solver['name'])} on {name}",
                    {**common, "scene": [scenes[name]], "solver": [alone]},
                )
            )
    if len(listed) > MOST_CASES:
        raise ValueError(f"{file}: {len(listed)} cases; a run of track has time for {MOST_CASES}")
    return listed


def chosen(names: list[str], listed: list[Case]) -> list[Case]:
    """Returns the cases whose names begin with one of `names`, or all if it is empty. Raises
    ValueError for a name without cases."""
    for name in names:
        if not any(case.name.startswith(name) for case in listed):
            raise ValueError(
                f"there is no case {name!r}: {', '.join(case.name for case in listed)}"
            )
    return [case for case in listed if not names or case.name.startswith(tuple(names))]
