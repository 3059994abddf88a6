"""Times that are not comparable give no ratio and no verdict, whatever they are; and every table
names its clock."""

from __future__ import annotations

import hashlib
import importlib
import json
import math
import re
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import synthetic
import synthetic_tang
from stem_runner import STEMS
from synthetic import ResultFile, spread
from test_meshes import peers
from test_over_pairs import fig2
from test_over_pairs import fig10 as orders
from test_scaling import file_of

from analysis import pareto, winners
from analysis.points import points_speed
from analysis.shared import notes, tables
from analysis.shared.comparable import origins, reason_apart
from analysis.shared.load import load
from analysis.shared.report import NO_TIMES, Report
from analysis.shared.stems import module_of

FILES: dict[str, Callable[[], ResultFile]] = {
    **STEMS,
    "mesh_peers": lambda: peers(cover=0.001, elements=30_000),
    "sacht2024_fig2": lambda: fig2([18.0, 20.0, 22.0, 19.0], [2.0] * 4),
    "sacht2024_fig10": lambda: orders({"1": [2.0] * 8, "1234": [1.0] * 8, "3": [1.5] * 8}),
    "tang2009_pd": synthetic_tang.depths,
    "scaling_points": lambda: file_of(
        "scaling_points", {"scan": (1e-8, 1.0), "kdtree": (1e-7, 1.0)}
    ),
}
JUDGED_BY_TIME = {
    "zhang2017_table3",
    "points_hostile",
    "zhang2017_table1",
    "zhang2017_fig9",
    "zhang2017_fig10",
    "sacht2024_table2",
    "sacht2024_fig14",
    "sacht2024_fig15",
    "sacht2024_fig2",
    "sacht2024_fig10",
    "tang2009_table2",
    "tang2009_fig10",
    "tang2009_ablation",
    "tang2009_pd",
    "mesh_peers",
}


def slower(file: ResultFile) -> ResultFile:
    """Multiplies each row's times by a factor from 1 to e^8 that depends on the case, so that the
    order by time is arbitrary."""

    def factor(row: int) -> float:
        case = file.cases[row]
        return float(
            math.exp(
                zlib.crc32(
                    f"{case['label']} {case['options']} {case['scene']} {case['pose']} {case['tolerance']}".encode()
                )
                % 9
            )
        )

    for group, names in (
        (file.answers, ("wall_seconds", "cpu_seconds", "reported_seconds")),
        (file.repeats, ("wall_seconds", "cpu_seconds")),
        (file.preparation, ("seconds",)),
    ):
        for entry in group:
            entry |= {name: entry[name] * factor(entry["case"]) for name in names}
    for row, case in enumerate(file.cases):
        case |= {
            name: case[name] * factor(row)
            for name in ("prepare_seconds", "solve_seconds", "reported_seconds")
        }
        told = json.loads(case["extras"])
        case["extras"] = json.dumps(
            {
                name: value * factor(row) if name.startswith("seconds") else value
                for name, value in told.items()
            }
        )
        for at in range(case["trace_begin"], case["trace_end"]):
            file.trace[at] = file.trace[at] | {"seconds": file.trace[at]["seconds"] * factor(row)}
    return file


def report_of(file: ResultFile, folder: Path) -> tuple[Report, str]:
    results = load(file.write(folder))
    report: Report = importlib.import_module(module_of(file.stem)).make(results)
    table = report.printed(results)
    assert table is not None
    return report, tables.markdown(table)


def outcomes(text: str) -> list[str]:
    return re.findall(r"^- Claim: .*?\. Here(?::| it) (.*?) \(", text, re.MULTILINE)


def with_columns(file: ResultFile, **columns: Any) -> ResultFile:
    for case in file.cases:
        case |= columns
    return file


def test_verdicts_change_with_times_where_times_compare(tmp_path: Path) -> None:
    changed = {
        stem
        for stem in JUDGED_BY_TIME
        if outcomes(report_of(FILES[stem](), tmp_path)[1])
        != outcomes(report_of(slower(FILES[stem]()), tmp_path)[1])
    }
    assert len(changed) >= 10, changed


@pytest.mark.parametrize("stem", FILES)
def test_no_verdict_on_times_of_rows_run_beside_others(
    stem: str, tmp_path: Path, tetrahedra: None
) -> None:
    texts = [
        report_of(with_columns(file, side_by_side=1), tmp_path)[1]
        for file in (FILES[stem](), slower(FILES[stem]()))
    ]
    assert outcomes(texts[0]) == outcomes(texts[1])
    assert "their times are not comparable" in texts[0]
    if stem in JUDGED_BY_TIME:
        assert "run beside others" in "\n".join(
            line for line in texts[0].splitlines() if line.startswith("- Claim")
        )


@pytest.mark.parametrize(
    "stem", ["zhang2017_table3", "mesh_peers", "sacht2024_table2", "points_hostile"]
)
@pytest.mark.parametrize(
    "column,why",
    [
        ("build", "of different builds"),
        ("machine", "of different machines"),
        ("clock", "by different clocks"),
    ],
)
def test_no_verdict_across_builds_machines_and_clocks(
    stem: str, column: str, why: str, tmp_path: Path
) -> None:
    """All but four solvers get another build, machine or clock."""

    def mixed(file: ResultFile) -> ResultFile:
        labels = sorted(
            {case["label"] for case in file.cases} - {"cgal", "adaptive", "sacht", "scan"}
        )
        for case in file.cases:
            if case["label"] in labels:
                case[column] = "wall" if column == "clock" else "another"
        return file

    first, second = (
        report_of(mixed(file), tmp_path)[1] for file in (FILES[stem](), slower(FILES[stem]()))
    )
    assert outcomes(first)[0] == outcomes(second)[0] == "not tested" or f"times {why}" in first
    assert f"times {why}" in first
    if column != "clock":
        assert (
            f"rows of 2 {column}s are mixed, and the times of two {column}s are not comparable"
            in first
        )


def test_a_plugin_of_one_run_is_of_its_build(tmp_path: Path) -> None:
    """The build of a plug-in's row is the SHA-256 of the program's build and the plug-in's hash,
    each preceded by its length."""
    program, plugin = "ab" * 32, "cd" * 32
    told = b"".join(len(text).to_bytes(8, "little") + text.encode() for text in (program, plugin))
    file = ResultFile(
        "points_hostile",
        meta={
            "build": program,
            "plugins": json.dumps([{"file": "libmine.so", "sha256": plugin, "solvers": ["mine"]}]),
        },
    )
    for solver, build in (
        ("scan", program),
        ("kdtree", hashlib.sha256(told).hexdigest()),
        ("naive", "of an older run"),
    ):
        file.case(solver, "x", [1.0, 2.0], lower=0.25, upper=0.25, build=build)
    results = load(file.write(tmp_path))
    assert (
        reason_apart(origins(results, [0, 1])) == ""
        and reason_apart(origins(results, [0, 2])) == "of different builds"
    )
    assert "rows of 2 builds" in notes.measured_on(results)


def test_pareto_is_open_where_times_do_not_compare(tmp_path: Path) -> None:
    file = ResultFile("error_vs_time")
    for solver, beside in (("cover", 0), ("guthe", 1)):
        file.case(
            solver, "x", [1.0] * 6, lower=1.0, upper=1.25, tolerance=1e-3, side_by_side=beside
        )
    cells = pareto.cells(load(file.write(tmp_path)), "cover")
    assert (
        "not separated (0 of 1 cells" in pareto.judge(cells, "cover").line()
        and "times run beside others" in cells[0].line()
    )


@pytest.mark.parametrize(
    ("column", "value", "why"),
    [
        ("side_by_side", 1, "run beside others"),
        ("machine", "m2", "of different machines"),
        ("build", "b2", "of different builds"),
    ],
)
def test_no_winner_among_times_that_do_not_compare(
    column: str, value: object, why: str, tmp_path: Path
) -> None:
    """Different clocks do not prevent a winner, because external programs have their own clock."""

    def raced(changed: bool) -> winners.Race:
        file = ResultFile("points_speed")
        for solver, middle, clock in (("scan", 1.0, "cpu"), ("kdtree", 2.0, "wall")):
            file.case(solver, "x", spread(middle, 6), lower=1.0, upper=1.0, clock=clock)
        if changed:
            file.cases[-1][column] = value
        results = load(file.write(tmp_path))
        records = winners.times(points_speed.make(results).records, results)
        times = [winners.Time(**record) for record in records]  # type: ignore[arg-type]
        return winners.race(times)

    assert raced(False).won and not raced(True).won and list(raced(True).doubts) == [f"times {why}"]


@pytest.mark.parametrize("stem", FILES)
def test_every_table_says_its_clock(stem: str, tmp_path: Path, tetrahedra: None) -> None:
    report, text = report_of(FILES[stem](), tmp_path)
    assert report.table is not None
    shown = " ".join([*report.table.header, report.table.caption])
    if report.clock == NO_TIMES:
        assert not re.search(
            r"(?<!')\b(ms|µs|s|times?|seconds)\b", re.sub(r"of times|full matrix", "", shown)
        ), shown
    else:
        assert re.search(
            r"^- (Times|.*[tT]imes (are|is|read)).*(CPU|wall) time", text, re.MULTILINE
        ), text
    assert synthetic.META["cpu"] in text or report.clock == NO_TIMES
