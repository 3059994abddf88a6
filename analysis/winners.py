"""Writes the table in README.md of how often each solver wins, from the times in results/reference:
`python3 -m analysis.winners`.

A solver wins a scene if its interval lies below the intervals of all others. A scene has no winner
if some solver has a single time or an interval of less than 95 %, or if times are not comparable; a
line below the table counts these scenes. analysis.paper_profile calls this whenever it stores new
times.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from analysis.shared import numerals, style, table_files, tables
from analysis.shared.comparable import origins, reason_apart
from analysis.shared.load import REFERENCE
from analysis.shared.results import Results
from analysis.shared.estimates import CONFIDENCE, order_statistic_rank

README: Final = REFERENCE.parent.parent / "README.md"
BEGIN: Final = "<!-- written by analysis/winners.py: begin -->"
END: Final = "<!-- written by analysis/winners.py: end -->"
SUFFIX: Final = ".times.json"  # of the files of times beside the tables
# By experiment: the file with its table in results/reference, and what its scenes are called.
RACES: Final = {
    "zhang2017_table3": ("zhang2017_paper_profile.md", "pairs of Table 3"),
    "points_speed": ("points_speed.md", "workloads of 100K and 1M points"),
    "mesh_peers": ("mesh_peers.md", "pairs of real meshes"),
}
SOURCES: Final = tuple(file for file, _ in RACES.values())


@dataclass(frozen=True)
class Time:
    """The time of one solver on one scene: a line of a file of times."""

    stem: str
    scene: str
    solver: str
    label: str
    title: str
    n: int  # rounds, or seeds; 0: no answer
    seconds: Sequence[float]  # the median, then the ends of its interval; a single time has no ends
    apart: str  # why the times of the scene are not comparable; empty if they are

    @property
    def name(self) -> str:
        return self.title if self.solver == "external" else f"`{self.label}`"


def times(records: Iterable[tables.Record], results: Results) -> list[tables.Record]:
    """Converts the records of a table to the JSON records that read() reads.

    Keeps only the records of the largest tolerance of each scene.
    """
    rows = list(records)
    largest: dict[object, float] = {}
    for row in rows:
        if "tolerance" in row:
            largest[row["scene"]] = max(
                float(str(row["tolerance"])), largest.get(row["scene"], 0.0)
            )
    rows = [
        row for row in rows if "tolerance" not in row or row["tolerance"] == largest[row["scene"]]
    ]
    apart: dict[str, str] = {}
    for scene in results.scenes:
        scene_origins = origins(results, results.rows(scene=scene))
        apart[scene] = reason_apart(origin._replace(clock="") for origin in scene_origins)
    converted: list[tables.Record] = []
    for row in rows:
        seconds = [row[f"{end}_seconds"] for end in ("median", "low", "high")]
        converted.append(
            {
                "stem": results.stem,
                "scene": row["scene"],
                "solver": row["solver"],
                "label": row["label"],
                "title": style.title(str(row["solver"]), str(row["label"])),
                "n": row["n"],
                "seconds": [x for x in seconds if isinstance(x, float) and math.isfinite(x)],
                "apart": apart[str(row["scene"])],
            }
        )
    return converted


def read(file: str, folder: Path = REFERENCE) -> list[Time]:
    """Reads the times that belong to a file of tables in `folder`. Raises OSError if there are
    none."""
    records = table_files.read_json((folder / file).with_suffix(SUFFIX))
    return [Time(**record) for record in records]  # type: ignore[arg-type]


@dataclass
class Race:
    """How often each solver won among the scenes of a table."""

    scenes: int
    won: dict[str, list[float]] = field(
        default_factory=dict
    )  # by winner: for each scene won, time of the next best / its time
    unjudged: int = 0  # scenes that cannot be judged, for one of the next two reasons
    single: dict[str, None] = field(
        default_factory=dict
    )  # an ordered set: solvers with single times in unjudged scenes
    doubts: dict[str, None] = field(
        default_factory=dict
    )  # an ordered set: other reasons why scenes are unjudged
    least: dict[str, int] = field(
        default_factory=dict
    )  # by solver: unjudged scenes that it would win but for single times of others


def race(among: Sequence[Time]) -> Race:
    scenes = dict.fromkeys(time.scene for time in among)
    result = Race(len(scenes))
    for scene in scenes:
        ranked = sorted(
            (time for time in among if time.scene == scene and time.n),
            key=lambda time: (time.seconds[0], time.title),
        )
        if len(ranked) < 2:
            continue
        best, *others = ranked
        single = [time.title for time in ranked if time.n == 1]
        doubts = [f"times {best.apart}"] if best.apart else []
        if any(time.n > 1 and not order_statistic_rank(time.n, CONFIDENCE) for time in ranked):
            doubts.append("their intervals cover less than 95 %")
        first = best.n > 1 and max(best.seconds) < min(x for time in others for x in time.seconds)
        if single or doubts:
            result.unjudged += 1
            result.single |= dict.fromkeys(single)
            result.doubts |= dict.fromkeys(doubts)
            if first and not doubts:
                result.least[best.name] = result.least.get(best.name, 0) + 1
        elif first:
            result.won.setdefault(best.name, []).append(others[0].seconds[0] / best.seconds[0])
    return result


def victories(races: dict[str, Race]) -> dict[str, list[str]]:
    texts: dict[str, list[str]] = {}
    for stem, outcome in races.items():
        for solver, factors in outcome.won.items():
            low, high = numerals.number(min(factors), 2), numerals.number(max(factors), 2)
            texts.setdefault(solver, []).append(
                f"{len(factors)} of the {outcome.scenes} {RACES[stem][1]}, {low if low == high else f'{low} to {high}'} times "
                "as fast as the next best"
            )
    return texts


def unjudged(races: dict[str, Race]) -> list[str]:
    """Returns the reasons why scenes have no winner, one line per table."""
    lines = []
    for stem, outcome in races.items():
        if not outcome.unjudged:
            continue
        why = []
        if outcome.single:
            why.append(
                f"{' and '.join(outcome.single)} {'have' if len(outcome.single) > 1 else 'has'} single times there, without an interval"
            )
        why += outcome.doubts
        why += [
            f"the interval of {solver} lies below all intervals and single times in {count} of them"
            for solver, count in outcome.least.items()
        ]
        lines.append(
            f"No winner in {outcome.unjudged} of the {outcome.scenes} {RACES[stem][1]}: "
            f"{'; '.join(why)}."
        )
    return lines


def table(folder: Path = REFERENCE) -> str:
    races: dict[str, Race] = {}
    for stem, (file, _) in RACES.items():
        races[stem] = race([time for time in read(file, folder) if time.stem == stem])
    won = victories(races)
    stated = ", ".join(f"[{title}](results/reference/{file})" for file, title in RACES.values())
    lines = [
        f"From the kept tables: {stated}.",
        "",
        "| solver | fastest on |",
        "| --- | --- |",
        *[f"| {solver} | {'; '.join(won[solver])} |" for solver in won],
    ]
    return "\n".join(lines + [line for note in unjudged(races) for line in ("", note)])


def rewritten(readme: str, text: str) -> str:
    before, begin, rest = readme.partition(BEGIN)
    _, end, after = rest.partition(END)
    if not begin or not end:
        raise ValueError(
            f"README.md: the marks '{BEGIN}' and '{END}' are missing: put them where the table belongs"
        )
    return f"{before}{begin}\n{text}\n{end}{after}"


def write(folder: Path = REFERENCE, readme: Path = README) -> Path:
    table_files.write_whole(readme, rewritten(readme.read_text(encoding="utf-8"), table(folder)))
    return readme


def main(arguments: Sequence[str] = ()) -> int:
    try:
        print(write())
    except (OSError, ValueError) as problem:
        print(problem, file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
