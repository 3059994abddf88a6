"""Made-up result files for the figures and tables of Sacht and Jacobson 2024."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from synthetic import ResultFile, without_bounds

ROUNDS = 6
NEAR = ("crown", "monster", "bust", "ramesses")
DERIVED = ("hand, noisy", "dino, decimated")
FAR = ("crown_monster", "monster_crown", "bust_ramesses", "ramesses_bust")


@dataclass(frozen=True)
class Tie:
    """A ratio alternately above and below a number, so that a test cannot tell on which side it
    is."""

    to: float = 1.0


TIE = Tie()
Ratio = float | Tie


def size_of(factor: Ratio) -> float:
    return factor.to if isinstance(factor, Tie) else factor


def rounds_of(base: float, factor: Ratio) -> list[float]:
    """Returns six rounds, each slower than the one before, so that only pairing times by round can
    separate solvers."""
    return [
        base
        * (1 + 0.1 * i)
        * size_of(factor)
        * ((1.25 if i % 2 else 0.8) if isinstance(factor, Tie) else 1)
        for i in range(ROUNDS)
    ]


def add_pairs(
    file: ResultFile, scenes: Sequence[str], factors: Mapping[str, Ratio], **columns: Any
) -> None:
    """Adds a case of each solver on each scene: `factor` times 10 ms, 1000 distances, 2000 bounds
    and 3000 nodes."""
    for scene in scenes:
        common: dict[str, Any] = {
            "tolerance": 1e-8,
            "lower": 0.004,
            "upper": 0.004,
            "scene_note": f"stands in for {scene}",
            **columns,
        }
        for label, factor in factors.items():
            times = size_of(factor)
            work = {
                name: round(count * times)
                for name, count in (
                    ("point_triangle_distances", 1000),
                    ("bound_tests", 2000),
                    ("node_visits", 3000),
                )
            }
            file.case(
                label,
                scene,
                rounds_of(0.01, factor),
                rounds=ROUNDS,
                prepare_seconds=0.0,
                counters={} if label == "cgal" else work,
                **common,
            )


def table2(
    kang: Ratio = 2.0, zheng: Ratio = 3.0, sacht: Ratio = 1.0, tang: Ratio | None = None
) -> ResultFile:
    """The arguments multiply times of 10 ms to 15 ms, depending on the round. On the derived pairs,
    sacht is as slow as kang."""
    file = ResultFile("sacht2024_table2", cpu=1.0)
    labels: dict[str, Ratio] = {"kang": kang, "zheng": zheng, "sacht": sacht, "cgal": 8.0}
    if tang is not None:
        labels["tang"] = tang
    add_pairs(file, NEAR, labels, source_elements=5000, target_elements=9000)
    add_pairs(file, DERIVED, {**labels, "sacht": kang})
    return file


def table3(
    kang: Ratio = 3.0, zheng: Ratio = 2.0, sacht: Ratio = 1.0, lost: Ratio = 4.0
) -> ResultFile:
    """The arguments multiply times of 10 ms to 15 ms; on the last pair, (Ramesses, Bust), `lost` is
    the factor of sacht."""
    file = ResultFile("sacht2024_table3", cpu=1.0)
    add_pairs(file, FAR[:3], {"kang": kang, "zheng": zheng, "sacht": sacht})
    add_pairs(file, FAR[3:], {"kang": kang, "zheng": zheng, "sacht": lost})
    return file


def fig13(kang: Ratio = 2.0, zheng: Ratio = 3.0) -> ResultFile:
    """At tolerance 10^-k, each solver takes k times its factor times 10 ms to 15 ms, depending on
    the round. cgal was measured only at 1e-8, and timed out on one pair.
    """
    file = ResultFile("sacht2024_fig13", cpu=1.0)
    for k in (1, 4, 8):
        for scene in NEAR:
            for label, factor in (("kang", kang), ("zheng", zheng), ("sacht", 1.0)):
                times = [k * x for x in rounds_of(0.01, factor)]
                size = size_of(factor)
                file.case(
                    label,
                    scene,
                    times,
                    rounds=ROUNDS,
                    tolerance=10.0**-k,
                    lower=0.5,
                    upper=0.5,
                    prepare_seconds=0.0,
                    counters={"point_triangle_distances": round(1000 * k * size)},
                )
    for scene in NEAR:
        common: dict[str, Any] = {"tolerance": 1e-8, "lower": 0.5, "upper": 0.5}
        if scene == "bust":
            file.case("cgal", scene, **without_bounds("timeout", "5 s passed", common))
        else:
            file.case("cgal", scene, rounds_of(0.3, 1.0), rounds=ROUNDS, **common)
    return file


def fig14(
    thousands: Ratio = 2000.0, stopped: float = 0.0, twentieth: Ratio = 1 / 30, fast: float = 0.01
) -> ResultFile:
    """On the square, zheng takes `thousands` times sacht's time, or is stopped after `stopped`
    seconds; on the cube, `twentieth` times."""
    file = ResultFile("sacht2024_fig14", cpu=1.0)
    common: dict[str, Any] = {"tolerance": 1e-8, "lower": 0.1, "upper": 0.1, "prepare_seconds": 0.0}
    for scene, ratio, base in (
        ("square, cut the other way", thousands, 0.01),
        ("cube, finer", twentieth, fast),
    ):
        size = size_of(ratio)
        file.case(
            "sacht",
            scene,
            rounds_of(base, 1.0),
            rounds=ROUNDS,
            counters={"point_triangle_distances": 30_000},
            **common,
        )
        work = {"point_triangle_distances": round(30_000 * size)}
        if stopped and scene.startswith("square"):
            file.case(
                "zheng",
                scene,
                [stopped],
                counters=work,
                status="budget",
                reason="the budget was spent",
                **common,
            )
        else:
            file.case(
                "zheng", scene, rounds_of(base, ratio), rounds=ROUNDS, counters=work, **common
            )
    return file


def fig15(
    fine: Ratio = 2.0, seconds: float = 0.1, kang: Ratio = 0.5, stopped: float = 1.5
) -> ResultFile:
    """sacht takes `fine` times as long at 1e-8 as at 1e-6. zheng is stopped by its time limit, and
    cgal is killed."""
    file = ResultFile("sacht2024_fig15", cpu=1.0)
    for scene in ("fandisk", "hand"):
        common: dict[str, Any] = {"lower": 8.7e-8, "prepare_seconds": 0.0}
        base = seconds / size_of(fine)
        for t, factor in ((1e-6, 1.0), (1e-8, fine)):
            size = size_of(factor)
            file.case(
                "sacht",
                scene,
                rounds_of(base, factor),
                rounds=ROUNDS,
                tolerance=t,
                upper=8.7e-8 + t,
                counters={"point_triangle_distances": round(10_000 * size), "subdivisions": 77},
                **common,
            )
            kangs = rounds_of(base * size, kang)
            file.case(
                "kang",
                scene,
                kangs,
                rounds=ROUNDS,
                tolerance=t,
                upper=8.7e-8 + t,
                counters={"point_triangle_distances": 5000},
                **common,
            )
            file.case(
                "zheng",
                scene,
                [stopped],
                tolerance=t,
                upper=1e-3,
                status="timeout",
                reason="1.5 s passed",
                counters={"point_triangle_distances": 90_000},
                **common,
            )
        file.case("cgal", scene, **without_bounds("timeout", "killed", {"tolerance": 1e-6}))
    return file


def section52(**wrong: Any) -> ResultFile:
    """On a scene with distance 0.25, sacht converges, zheng stops at its precision floor, and cgal
    is killed without bounds. On another, sacht limited to few pieces reaches only 1e-5. `wrong`
    replaces columns of the first row.
    """
    file = ResultFile("sacht2024_section52")
    columns: dict[str, Any] = {
        "tolerance": 1e-8,
        "lower": 0.25,
        "upper": 0.25 + 1e-9,
        "exact": 0.25,
        **wrong,
    }
    file.case("sacht", "unreferenced vertex", [0.1], **columns)
    file.case(
        "zheng",
        "unreferenced vertex",
        [0.1],
        tolerance=1e-8,
        lower=0.25,
        upper=0.25 + 1e-7,
        exact=0.25,
        status="floor",
    )
    file.case(
        "cgal",
        "unreferenced vertex",
        certified=0,
        **without_bounds("timeout", "killed", {"tolerance": 1e-8, "exact": 0.25}),
    )
    for t, status in ((1e-5, "ok"), (1e-8, "budget")):
        file.case(
            "sacht",
            "too many pieces",
            [0.1],
            label="Sacht 2024, m = 150",
            tolerance=t,
            lower=1e-7,
            upper=1e-7 + 9e-6,
            status=status,
        )
    return file


def table1() -> ResultFile:
    """h is 0.4 % and H 0.5 % of the diagonal, which is 10 long."""
    file = ResultFile("sacht2024_table1")
    for scene in (*NEAR, *DERIVED):
        for label, quantity, distance in (
            ("sacht", "directed", 0.04),
            ("symmetric", "symmetric", 0.05),
        ):
            file.case(
                "sacht",
                scene,
                [0.1],
                label=label,
                quantity=quantity,
                lower=distance,
                upper=distance,
                source_diagonal=10.0,
                source_elements=4,
                target_elements=4,
                tolerance=1e-6,
                scene_note="stands in",
            )
    return file


STEMS: dict[str, Callable[[], ResultFile]] = {
    "sacht2024_table1": table1,
    "sacht2024_table2": table2,
    "sacht2024_table3": table3,
    "sacht2024_fig14": fig14,
    "sacht2024_fig15": fig15,
    "sacht2024_section52": section52,
}


def with_fields(
    stem: str, scenes: Sequence[str], last: Sequence[int] = (0, 1, 2, 3), **columns: Any
) -> ResultFile:
    """A is a tetrahedron whose vertices are 0, 0.1, 0.2 and 0.3 away from B. `last` holds the
    bounds of its four triangles."""
    file = ResultFile(stem)
    for scene in scenes:
        row = file.case(
            "sacht",
            scene,
            [0.1],
            source=f"{scene} A",
            target=f"{scene} B",
            lower=0.35,
            upper=0.35,
            source_diagonal=2.0,
            source_elements=4,
            target_elements=4,
            tolerance=1e-8,
            scene_note="a tetrahedron",
            witness_source=[0.25, 0.25, 0.0],
            witness_target=[0.25, 0.25, -0.35],
            counters={"subdivisions": 5},
            **columns,
        )
        for name, of, values in (
            ("distance", "vertices", [0.0, 0.1, 0.2, 0.3]),
            ("bound", "elements", [float(x) for x in last]),
        ):
            begin = len(file.field_values)
            file.field_values += values
            file.fields.append(
                {
                    "case": row,
                    "name": name,
                    "of": of,
                    "meaning": "number",
                    "begin": begin,
                    "end": begin + len(values),
                }
            )
    return file
