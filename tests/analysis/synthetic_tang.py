"""Made-up result files for the figures and tables of Tang et al. 2009."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from typing import Any

from synthetic import ResultFile, spread, without_bounds

from analysis.tang2009.tang2009_similarity import FAMILIES

POSES = 21
STAGES = ("cull on A", "cull on B", "subdivide")


def told(culled_a: float, culled_b: float, depth: float, seconds: Sequence[float] = ()) -> str:
    """Returns a row's `extras` column as JSON, with the same values for both directions."""
    extras = {
        "culled on A": culled_a,
        "culled on B": culled_b,
        "depth": depth,
        **{f"seconds: {stage}": value for stage, value in zip(STAGES, seconds)},
    }
    return json.dumps({**extras, **{f"{name} (B to A)": value for name, value in extras.items()}})


def motion(
    stem: str,
    scenes: Sequence[str],
    labels: Sequence[str],
    left: float = 0.01,
    deepest: int = 5,
    slower: float = 1.0,
    queries: float = 0.5,
    rounds: int = 7,
) -> ResultFile:
    """With L the longest side, H falls from 2.1 L at the first pose to 0.1 L at the last; `tang`
    takes (L / H)^slower ms. A fraction `left` of A remains after culling, and twice that of B. One
    pose has depth `deepest`, the others 3. A warm-started pose needs `queries` times the queries of
    a cold one.
    """
    file = ResultFile(stem, wall=1.25, cpu=1.0)
    for k, scene in enumerate(scenes):
        for label in labels:
            solver, warm = label.split(",")[0], "warm" in label
            for i in range(POSES):
                distance = 2.1 - 0.1 * i
                base = 1e-3 * (k + 1) * distance**-slower * (0.5 if solver == "cover" else 1.0)
                count = int((1000 if i == 0 or not warm else 1000 * queries) / distance)
                columns: dict[str, Any] = (
                    {
                        "extras": told(
                            1 - left,
                            1 - 2 * left,
                            deepest if i == 7 else 3,
                            (base / 4, base / 4, base / 2),
                        )
                    }
                    if solver == "tang"
                    else {}
                )
                file.case(
                    solver,
                    scene,
                    spread(base, rounds, 0.02),
                    label=label,
                    scene_note="two stand in",
                    pose_index=i,
                    pose=[1.0, 0, 0, 0, 1, 0, 0, 0, 1, 2.0 - 0.1 * i, 0, 0],
                    lower=0.75 * distance,
                    upper=0.75 * distance,
                    quantity="symmetric",
                    tolerance=1e-4,
                    tolerance_of="longest",
                    warm=int(warm),
                    prepare_seconds=0.0,
                    counters={
                        "closest_point_queries": count,
                        "point_triangle_distances": int(1e4 * distance**-slower),
                        "node_visits": 7,
                    },
                    **columns,
                )
    return file


def table2() -> ResultFile:
    return motion(
        "tang2009_table2",
        ("Bird1/Bird2", "Dog/Lion", "another"),
        ("tang", "tang, warm", "cover", "cover, warm"),
    )


def fig9() -> ResultFile:
    return motion("tang2009_fig9", ("Puma1/Puma2", "Watch1/Watch2"), ("tang", "cover"))


def fig10(
    tang: float = 0.005, far: bool = False, rounds: int = 7, work: int = 50, cuts: int = 5
) -> ResultFile:
    """Guthe takes 100 ms, 1,000 distances and 10 subdivisions; Tang takes `tang` seconds, `work`
    distances and `cuts` subdivisions. H is at most 2 % of the longest side, but 30 % on the last
    pair, where Guthe takes 1 ms. With `far`, Tang times out on one pair.
    """
    file = ResultFile("tang2009_fig10", wall=1.25, cpu=1.0)
    for scene, distance, guthe in (
        ("near", 0.02, 0.1),
        ("nearer", 0.001, 0.1),
        ("apart", 0.3, 0.001),
    ):
        common: dict[str, Any] = {
            "lower": 0.75 * distance,
            "upper": 0.75 * distance,
            "quantity": "symmetric",
            "prepare_seconds": 0.0,
            "peak_bytes": 2**22,
        }
        file.case(
            "guthe",
            scene,
            spread(guthe, rounds, 0.02),
            counters={"point_triangle_distances": 1000, "subdivisions": 10},
            **common,
        )
        if far and scene == "nearer":
            file.case("tang", scene, **without_bounds("timeout", "20 s passed", common))
        else:
            file.case(
                "tang",
                scene,
                spread(tang, rounds, 0.02),
                counters={"point_triangle_distances": work, "subdivisions": cuts},
                **common,
            )
        file.case(
            "cover",
            scene,
            spread(0.001, rounds, 0.02),
            counters={"point_triangle_distances": 2000},
            **common,
        )
    return file


def ablation(midpoint: float = 2.0, rounds: int = 7, coarse: int = 1) -> ResultFile:
    """Each of five poses takes 1 ms. Cutting at midpoints multiplies time and subdivisions by
    `midpoint`. Corners alone take twice as long on the first scene and half as long on the second.
    One warm pose times out. The depth is 2, but `coarse` at tolerance 1e-3.
    """
    file = ResultFile("tang2009_ablation", wall=1.25, cpu=1.0)
    for scene in ("Puma1/Puma2", "bear, half"):
        for label, tolerance, factor in (
            ("tang", 1e-3, 0.5),
            ("tang", 1e-4, 1.0),
            ("tang, midpoint", 1e-4, midpoint),
            ("tang, corners alone", 1e-4, 2.0 if scene.startswith("Puma") else 0.5),
            ("tang, warm", 1e-4, 1.0),
            ("cover", 1e-4, 0.25),
        ):
            for i in range(5):
                common: dict[str, Any] = {
                    "label": label,
                    "tolerance": tolerance,
                    "tolerance_of": "longest",
                    "pose_index": i,
                    "lower": 0.1,
                    "upper": 0.1,
                    "quantity": "symmetric",
                    "pose": [1.0, 0, 0, 0, 1, 0, 0, 0, 1, float(i), 0, 0],
                }
                if label == "tang, warm" and i == 3:
                    file.case("tang", scene, **without_bounds("timeout", "20 s", common))
                    continue
                work = {
                    "subdivisions": int(100 * factor),
                    "point_triangle_distances": int(1000 * factor),
                }
                file.case(
                    label.split(",")[0],
                    scene,
                    spread(1e-3 * factor, rounds, 0.02),
                    counters=work,
                    prepare_seconds=0.0,
                    extras=told(0.9, 0.9, coarse if tolerance == 1e-3 else 2)
                    if label != "cover"
                    else "{}",
                    **common,
                )
    return file


STEMS: dict[str, Callable[[], ResultFile]] = {
    "tang2009_table2": table2,
    "tang2009_fig9": fig9,
    "tang2009_fig10": fig10,
    "tang2009_ablation": ablation,
}


def pictures(stem: str, labels: Sequence[str] = ("tang", "cover")) -> ResultFile:
    """The first pair's witness goes from (0.25, 0.25, 0) on A to (3, 0.25, 0) on B; the second
    pair's is unknown. A is moved by 2 along x."""
    file = ResultFile(stem)
    for i, scene in enumerate(("Bird1/Bird2", "Dog/Lion")):
        for label in labels:
            witness: dict[str, Any] = (
                {"witness_source": [0.25, 0.25, 0.0], "witness_target": [3.0, 0.25, 0.0]}
                if i == 0
                else {}
            )
            file.case(
                label,
                scene,
                [0.1],
                lower=1.5,
                upper=1.5,
                quantity="symmetric",
                scene_note="two stand in",
                source_elements=4,
                target_elements=4,
                pose=[1.0, 0, 0, 0, 1, 0, 0, 0, 1, 2.0, 0, 0],
                witness_direction="target to source",
                tolerance=1e-4,
                tolerance_of="longest",
                **witness,
            )
    return file


def similarity(
    groups: Sequence[int] = (2, 2, 2, 2, 2, 2), alike: int = 6, skew: float = 0.0, far: float = 0.0
) -> ResultFile:
    """Family k has `groups[k]` shapes. Distances are 0.01 within the first `alike` families, 0.2
    within the others, and 0.1 to 0.16 between families. `skew` is added to one order of one pair,
    `far` to the pair of first and last shape.
    """
    file = ResultFile("tang2009_similarity")
    titles = list(FAMILIES.values())
    kinds = [k for k, count in enumerate(groups) for _ in range(count)]
    names = [titles[k][i] for k, count in enumerate(groups) for i in range(count)]
    for i, a in enumerate(names):
        for j, b in enumerate(names):
            middle = (
                0.0
                if i == j
                else (0.01 if kinds[i] < alike else 0.2)
                if kinds[i] == kinds[j]
                else 0.1 + 0.01 * ((kinds[i] + kinds[j]) % 7)
            )
            middle += skew * (i == 0 and j == 2) + far * ({i, j} == {0, len(names) - 1})
            file.case(
                "cover",
                f"similarity: {a} to {b}",
                [0.01],
                source=f"{a}_centred",
                target=f"{b}_centred",
                lower=middle,
                upper=middle + 1e-3,
                quantity="symmetric",
                counters={"point_triangle_distances": 1000, "node_visits": 500},
            )
    return file


STEMS["tang2009_similarity"] = similarity


def nearest(work: int = 100, slow: Sequence[int] = (), wrong: Sequence[int] = ()) -> ResultFile:
    """Searches the shapes of `similarity` in its order. A pair above the cutoff takes `work`
    distances and no nodes, any other 1,000 and 500. For sources in `slow` every other pair takes
    3,000; the search for sources in `wrong` misses the nearest shape.
    """
    matrix, file = similarity(), ResultFile("tang2009_nearest")
    least: dict[str, float] = {}
    sources = list(dict.fromkeys(row["source"] for row in matrix.cases))
    for row in matrix.cases:
        if row["source"] == row["target"]:
            continue
        number, cutoff = sources.index(row["source"]), least.get(row["source"], float("inf"))
        cut_off = row["lower"] > cutoff or (number in wrong and row["upper"] < 0.05)
        counts = {
            "point_triangle_distances": 3000 if number in slow else work if cut_off else 1000,
            "node_visits": 500 * (not cut_off),
        }
        upper = float("inf") if cut_off else row["upper"]
        file.case(
            "cover",
            row["scene"].replace("similarity", "nearest"),
            [0.01],
            source=row["source"],
            target=row["target"],
            lower=row["lower"],
            upper=upper,
            quantity="symmetric",
            answer="h > cutoff" if cut_off else "gap",
            cutoff_used=cutoff,
            counters=counts,
            solver_status="above_cutoff" if cut_off else "converged",
        )
        least[row["source"]] = min(cutoff, upper)
    return file


STEMS["tang2009_nearest"] = nearest


def depths(
    cover: float = 1e-4, frames: int = 30, tang_lower: float = 0.01, failed: int = 0
) -> ResultFile:
    """In each frame of two scenes, two pairs overlap by 1 % of the longest side (Tang's lower
    bound: `tang_lower`). Cutting a pair takes 5 ms and measuring it `cover` seconds, twice that for
    Tang, a tenth more in odd frames. The first `failed` pairs have no answer.
    """
    file = ResultFile("tang2009_pd")
    for scene in ("Alphabet Domino", "Falling Bunnies"):
        for label, factor in (("tang", 2.0), ("cover", 1.0)):
            for frame in range(frames):
                for k in range(2):
                    lower = tang_lower if label == "tang" else 0.01
                    common: dict[str, Any] = {
                        "label": label,
                        "lower": lower,
                        "upper": lower + 1e-4,
                        "quantity": "penetration",
                        "frame": frame,
                        "pose_index": 2 * frame + k,
                        "pose": [1.0, 0, 0, 0, 1, 0, 0, 0, 1, float(frame), 0, 0],
                        "target_pose": [1.0, 0, 0, 0, 1, 0, 0, 0, 1, float(k), 0, 0],
                        "source_longest": 1.0,
                        "source": "one",
                        "target": "other",
                    }
                    if label == "cover" and failed:
                        failed -= 1
                        file.case(
                            "penetration",
                            f"{scene}: one and other",
                            **without_bounds("failed", "CGAL failed", common),
                        )
                        continue
                    told_of_it = {
                        "parts": 1.0,
                        "triangles measured": 20.0,
                        "seconds: cut": 5e-3,
                        "seconds: measure": cover * factor * (1.1 if frame % 2 else 1.0),
                    }
                    file.case(
                        "penetration",
                        f"{scene}: one and other",
                        [0.01],
                        extras=json.dumps(told_of_it),
                        **common,
                    )
    part = {
        f"length: part {i}, {side} {axis}": 0.1 * i
        for i in (1, 2)
        for side in "AB"
        for axis in "xyz"
    }
    file.case(
        "penetration",
        "Fig. 11",
        [0.01],
        label="each part",
        lower=0.1,
        upper=0.1,
        quantity="penetration",
        source_longest=1.0,
        source="one",
        target="other",
        target_pose=[1.0, 0, 0, 0, 1, 0, 0, 0, 1, 0.25, 0.125, 0.125],
        extras=json.dumps({"parts": 2.0, **part}),
    )
    return file


def fig1() -> ResultFile:
    """One pair has H = 1.5. One frame has pairs that overlap by 0.1 and 0.2, and a pair without an
    answer."""
    file = ResultFile("tang2009_fig1")
    where: dict[str, Any] = {"source": "one", "target": "other", "source_longest": 2.0}
    for label in ("tang", "cover"):
        file.case(
            label,
            "Bird1/Bird2",
            [0.1],
            lower=1.5,
            upper=1.5,
            quantity="symmetric",
            scene_note="two stand in",
            witness_source=[0.25, 0.25, 0.0],
            witness_target=[3.0, 0.25, 0.0],
            **where,
        )
    for k, depth in enumerate((0.1, 0.2)):
        file.case(
            "penetration",
            "Falling Bunnies: one and other",
            [0.1],
            label="cover, depth",
            lower=depth,
            upper=depth,
            quantity="penetration",
            frame=24,
            pose_index=k,
            witness_source=[0.0, 0.0, 0.0],
            witness_target=[depth, 0.0, 0.0],
            target_pose=[1.0, 0, 0, 0, 1, 0, 0, 0, 1, float(k), 0, 0],
            **where,
        )
    file.case(
        "penetration",
        "Falling Bunnies: one and other",
        **without_bounds(
            "failed",
            "CGAL failed",
            {
                "label": "cover, depth",
                "quantity": "penetration",
                "frame": 24,
                "pose_index": 2,
                **where,
            },
        ),
    )
    return file
