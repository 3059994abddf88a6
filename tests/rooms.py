"""The folders ("rooms") of the C++ code, their includes, and a picture of both: `python3
tests/rooms.py` writes docs/rooms.svg."""

import re
from collections import defaultdict
from collections.abc import Iterable
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
INCLUDE = re.compile(r'^#include "([^"]+)"', re.MULTILINE)

# From top to bottom. A room may include rooms on lower steps, but not others on its own step.
STAIRCASE = [
    ["main"],
    ["commands"],
    ["run", "python"],
    ["library"],
    ["check", "plan"],
    ["result"],
    ["record"],
    ["ask"],
    ["datasets"],
    ["composed", "process"],
    ["session"],
    ["solvers"],
    ["search"],
    ["structures", "certificate"],
    ["interface"],
    ["kernel"],
    ["text"],
]
WHAT = {
    "main": "harness/main.cpp: the program",
    "commands": "harness/commands/: what each verb takes and prints",
    "run": "harness/run/: workers, timing, the journal",
    "python": "python/core/: the C interface for Python",
    "library": "library/: the C interface",
    "check": "harness/check/: is it true? rows, proofs",
    "plan": "harness/plan/: what to run",
    "result": "harness/result/: result files, written and read",
    "record": "harness/record/: case, outcome, the table of columns",
    "ask": "harness/ask/: questions and answers, also in a child process",
    "datasets": "datasets/: models by name, foreign files",
    "composed": "algorithms/composed/: solvers of solvers",
    "process": "process/: children, scratch folders",
    "session": "algorithms/session/: one solver on one scene, all questions",
    "solvers": "algorithms/points/, meshes/, surfaces/, peers/: a folder each",
    "search": "algorithms/search/: branch and bound that solvers share",
    "structures": "algorithms/structures/: trees",
    "certificate": "algorithms/certificate/: proofs",
    "interface": "algorithms/solver.h and beside it: what a solver sees",
    "kernel": "algorithms/kernel/: arithmetic",
    "text": "algorithms/error.h, printable.h: errors and text",
}
TEXT = ("error", "printable")
SOLVERS = ("points", "meshes", "surfaces", "peers")


def room_of(path: Path) -> str:
    """Returns a source file's room: its folder in harness/ or algorithms/, else its top-level
    folder."""
    parts = path.relative_to(ROOT).parts
    if parts[0] == "algorithms":
        if len(parts) == 2:
            return "text" if path.stem in TEXT else "interface"
        return "solvers" if parts[1] in SOLVERS else parts[1]
    if parts[0] != "harness":
        return parts[0]
    return parts[1] if len(parts) > 2 else "main"


def sources() -> list[Path]:
    """Returns the C++ files of all rooms."""
    folders = ("algorithms", "process", "datasets", "harness", "library", "python")
    return sorted(
        p
        for f in folders
        for p in (ROOT / f).rglob("*")
        if p.suffix in (".h", ".hpp", ".cpp") and "recorder" not in p.parts
    )


def includes(files: list[Path]) -> dict[Path, set[Path]]:
    """Returns the project files that each file includes, resolved from the root."""
    project = set(files)
    graph = {}
    for file in files:
        graph[file] = {ROOT / name for name in INCLUDE.findall(file.read_text())} & project
    return graph


def between_rooms(graph: dict[Path, set[Path]]) -> dict[tuple[str, str], list[str]]:
    """Returns the includes between rooms, by (including room, included room)."""
    arrows: dict[tuple[str, str], list[str]] = defaultdict(list)
    for file, included in graph.items():
        for header in included:
            if room_of(file) != room_of(header):
                arrows[room_of(file), room_of(header)].append(
                    f"{file.relative_to(ROOT)} includes {header.relative_to(ROOT)}"
                )
    return arrows


def steps_up(arrows: dict[tuple[str, str], list[str]]) -> list[str]:
    """Returns the includes that do not lead to a lower step."""
    step = {room: number for number, rooms in enumerate(STAIRCASE) for room in rooms}
    return [
        line
        for (above, below), lines in arrows.items()
        if step[above] >= step[below]
        for line in lines
    ]


def circle(graph: dict[Path, set[Path]]) -> list[Path]:
    """Returns files that form an include cycle, or an empty list."""
    done: set[Path] = set()

    def look(file: Path, way: list[Path]) -> list[Path]:
        if file in way:
            return way[way.index(file) :]
        if file in done:
            return []
        for header in sorted(graph[file]):
            if cycle := look(header, [*way, file]):
                return cycle
        done.add(file)
        return []

    return next((cycle for file in sorted(graph) if (cycle := look(file, []))), [])


WIDTH, HEIGHT, GAP, LEFT, TOP = 640, 34, 22, 190, 14


def place_of(room: str) -> tuple[int, int, int]:
    """Returns left edge, top edge and width of a room's box. Rooms on the same step are side by
    side."""
    step = next(number for number, rooms in enumerate(STAIRCASE) if room in rooms)
    beside = STAIRCASE[step]
    width = (WIDTH - GAP * (len(beside) - 1)) // len(beside)
    return LEFT + beside.index(room) * (width + GAP), TOP + step * (HEIGHT + GAP), width


def direct(arrows: Iterable[tuple[str, str]]) -> set[tuple[str, str]]:
    """Returns the arrows between rooms that no longer way by other arrows implies."""
    below: dict[str, set[str]] = defaultdict(set)
    for room, included in arrows:
        below[room].add(included)

    def reaches(room: str) -> set[str]:
        return below[room].union(*map(reaches, below[room]))

    return {
        (room, included)
        for room in list(below)
        for included in below[room]
        if not any(included in reaches(other) for other in below[room])
    }


def picture(arrows: dict[tuple[str, str], list[str]]) -> str:
    """Returns the staircase as SVG, without arrows that others imply. Arrows to the next step are
    straight; longer ones bend around the boxes."""
    height = TOP * 2 + len(STAIRCASE) * (HEIGHT + GAP) - GAP
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {2 * LEFT + WIDTH} {height}" font-family="sans-serif" font-size="13">',
        "<title>Which room includes which: every arrow goes down, and a room may include all that it leads to</title>",
        '<defs><marker id="head" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" markerHeight="7" orient="auto">'
        '<path d="M0 0 L8 4 L0 8 z" fill="#555"/></marker></defs>',
    ]
    step = {room: number for number, rooms in enumerate(STAIRCASE) for room in rooms}
    for above, below in sorted(
        direct(arrows), key=lambda pair: (step[pair[0]], step[pair[1]], pair)
    ):
        (x, y, width), (to_x, to_y, to_width) = place_of(above), place_of(below)
        down = step[below] - step[above]
        if down == 1:
            middle = x + width // 2 if to_width >= width else to_x + to_width // 2
            path = f"M{middle} {y + HEIGHT} L{middle} {to_y}"
        else:
            beside = [
                STAIRCASE[step[room]].index(room)
                for room in (above, below)
                if len(STAIRCASE[step[room]]) > 1
            ]
            right = beside[0] == 1 if beside else step[above] % 2 == 0
            start, end = (x + width, to_x + to_width) if right else (x, to_x)
            out = (1 if right else -1) * (12 + 19 * down)
            start_y, end_y = y + HEIGHT // 2 + 2 * down - 8, to_y + HEIGHT // 2 - 2 * down + 8
            path = f"M{start} {start_y} C{start + out} {start_y + 14}, {end + out} {end_y - 14}, {end} {end_y}"
        lines.append(
            f'<path d="{path}" fill="none" stroke="#555" stroke-opacity="0.75" marker-end="url(#head)"/>'
        )
    for rooms in STAIRCASE:
        for room in rooms:
            x, y, width = place_of(room)
            name, purpose = WHAT[room].split(": ")
            text = (
                f'<tspan font-weight="bold">{name}</tspan>'
                + f' <tspan fill="#444">{purpose}</tspan>'
            )
            lines.append(
                f'<rect x="{x}" y="{y}" width="{width}" height="{HEIGHT}" rx="4" fill="#eef3f8" stroke="#5b7a99"/>'
            )
            lines.append(f'<text x="{x + 10}" y="{y + 22}">{text}</text>')
    return "\n".join([*lines, "</svg>"]) + "\n"


if __name__ == "__main__":
    (ROOT / "docs" / "rooms.svg").write_text(picture(between_rooms(includes(sources()))))
