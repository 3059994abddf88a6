"""The rooms of the C++ code, who includes whom, and the picture of it: `python3 tests/rooms.py` writes docs/rooms.svg."""

import re
from collections import defaultdict
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
INCLUDE = re.compile(r'^#include "([^"]+)"', re.MULTILINE)

# From the top step to the bottom. Rooms of one step do not include each other; a room may include any room below.
STAIRCASE = [
    ["main"],
    ["commands"],
    ["run"],
    ["check", "plan"],
    ["result"],
    ["record"],
    ["datasets"],
    ["process"],
    ["algorithms"],
]
WHAT = {
    "main": "harness/main.cpp: the program",
    "commands": "harness/commands/: what each verb takes and prints",
    "run": "harness/run/: workers, their limits, timing, the journal",
    "check": "harness/check/: rows and certificates, checked again",
    "plan": "harness/plan/: from an experiment to its cases",
    "result": "harness/result/: result files, written and read",
    "record": "harness/record/: case, outcome, the table of columns",
    "datasets": "datasets/: models by name, foreign files",
    "process": "process/: child processes, scratch folders, interrupts",
    "algorithms": "algorithms/: the interface, the solvers, what they share",
}


def room_of(path: Path) -> str:
    """The room of a source file: of harness/ its folder, else the top folder."""
    parts = path.relative_to(ROOT).parts
    if parts[0] != "harness":
        return parts[0]
    return parts[1] if len(parts) > 2 else "main"


def sources() -> list[Path]:
    """All C++ files of the rooms."""
    folders = ("algorithms", "process", "datasets", "harness")
    return sorted(p for f in folders for p in (ROOT / f).rglob("*") if p.suffix in (".h", ".cpp") and "recorder" not in p.parts)


def includes(files: list[Path]) -> dict[Path, set[Path]]:
    """Of each file, the files of ours that it includes: from its folder, or from the folders that CMake names."""
    bases = [ROOT / "algorithms", ROOT / "datasets", ROOT / "harness", ROOT]
    known = set(files)
    graph: dict[Path, set[Path]] = {}
    for file in files:
        found = set()
        for name in INCLUDE.findall(file.read_text()):
            places = [base / name for base in [file.parent, *bases] if base / name in known]
            if places:
                found.add(places[0])
        graph[file] = found
    return graph


def between_rooms(graph: dict[Path, set[Path]]) -> dict[tuple[str, str], list[str]]:
    """Of two rooms, the includes that go from the one to the other."""
    arrows: dict[tuple[str, str], list[str]] = defaultdict(list)
    for file, others in graph.items():
        for other in others:
            if room_of(file) != room_of(other):
                arrows[room_of(file), room_of(other)].append(f"{file.relative_to(ROOT)} includes {other.relative_to(ROOT)}")
    return arrows


def steps_up(arrows: dict[tuple[str, str], list[str]]) -> list[str]:
    """The includes that do not go down the staircase."""
    step = {room: number for number, rooms in enumerate(STAIRCASE) for room in rooms}
    return [line for (above, below), lines in arrows.items() if step[above] >= step[below] for line in lines]


def circle(graph: dict[Path, set[Path]]) -> list[Path]:
    """Some files that include each other in a circle; none where there is no circle."""
    done: set[Path] = set()

    def look(file: Path, way: list[Path]) -> list[Path]:
        if file in way:
            return way[way.index(file) :]
        if file in done:
            return []
        for other in sorted(graph[file]):
            if found := look(other, [*way, file]):
                return found
        done.add(file)
        return []

    return next((found for file in sorted(graph) if (found := look(file, []))), [])
