"""Compares bounds and counters with those kept in results/reference/counts: `python3 -m
analysis.check_reference STEM...`

They are the same on every machine, so each row must match to the last digit. The kept file of a
stem has one line for each row with status `ok`: the identity of the case (a hash of the shapes, the
solver and its parameters), a description in words, the bounds and the counters. Rows of other
shapes than the kept ones (unlike.py), as another version of CGAL derives them, are not compared,
but counted.

    check_reference STEM...                  compares results/STEM.h5
    check_reference --again STEM...          measures the stems again, at the paper's sizes and once each, as counts need no repeats
    check_reference --sample                 measures a part of some stems again, which takes about a minute; part of .ci/run
    check_reference --again --keep STEM...   replaces the kept rows by the new ones
"""

from __future__ import annotations

import argparse
import csv
import os
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final

import tomli_w

from analysis.shared import missing, table_files, tables, unlike
from analysis.shared.cells import WORK
from analysis.shared.load import REFERENCE, load
from analysis.shared.remedy import ROOT
from analysis.shared.results import ResultError, Results

FOLDER: Final = REFERENCE / "counts"
COUNTED: Final = (*WORK, "subdivisions")
NAMES: Final = ("identity", "solver", "scene", "pose", "tolerance", "lower", "upper", *COUNTED)
Rows = dict[str, dict[str, str]]  # by identity
# The options of `run` for each stem of --sample. Together they run every solver that has kept rows,
# except CGAL.
SAMPLE: Final[dict[str, list[str]]] = {
    "tang2009_fig10": [
        "--scene",
        "hand, half",
        "--scene",
        "dinosaur, half",
        "--scene",
        "two crowns",
    ],
    "tang2009_ablation": ["--scene", "Puma1/Puma2", "--solver", "cover", "--solver", "tang, warm"],
    "sacht2024_fig11": [],
    "shou2014_example": ["--solver", "pruned pairs", "--solver", "surface_enclosure"],
    "zhang2017_table1": ["--scene", "pair 1", "--solver", "nohd", "--solver", "scan"],
    "zhang2017_table2": ["--scene", "pair 1", "--solver", "ohd"],
    "zhang2017_table3": [
        "--scene",
        "f_singular",
        "--solver",
        "inc",
        "--solver",
        "kdtree",
        "--solver",
        "adaptive",
    ],
}


def rows_of(results: Results, of_other_shapes: bool = False) -> Rows:
    """Returns the rows to compare: status `ok`, one thread, no external program, not read off a
    trace. Others may depend on the machine. They are the rows of the kept shapes, or of other
    shapes.
    """
    cases, compared, unlike_rows = results.cases, Rows(), set(unlike.rows(results))
    for row in results.rows(status="ok", threads=1):
        if (
            (row in unlike_rows) != of_other_shapes
            or cases.solver[row] == "external"
            or cases.from_trace[row]
        ):
            continue
        counters = {
            name: str(int(cases.counters[name][row])) for name in COUNTED if name in cases.counters
        }
        compared[str(cases.identity[row])[:16]] = {
            "identity": str(cases.identity[row])[:16],
            "solver": str(results.names[row]),
            "scene": str(cases.scene[row]),
            "pose": str(int(cases.pose_index[row])),
            "tolerance": repr(float(cases.tolerance[row])),
            "lower": repr(float(cases.lower[row])),
            "upper": repr(float(cases.upper[row])),
            **counters,
        }
    return compared


def kept(stem: str) -> Rows:
    path = FOLDER / f"{stem}.csv"
    if not path.exists():
        return {}
    with path.open(encoding="utf-8") as file:
        return {row["identity"]: row for row in csv.DictReader(file)}


def words(row: Mapping[str, str]) -> tuple[str, ...]:
    return tuple(row[name] for name in NAMES[1:5])


def same_words(here: Rows, there: Rows) -> Rows:
    """Matches rows to kept rows by solver, scene, pose and tolerance, and returns them by the
    identity of the kept row.

    For rows whose identities differ, as they do under other limits, or if a solver has a new
    parameter. A scene in which no row equals its
    kept row is left out, because its shapes must be others.
    """
    identity_of = {words(row): identity for identity, row in there.items()}
    matched = {identity_of[words(row)]: row for row in here.values() if words(row) in identity_of}
    alike = {
        row["scene"] for identity, row in matched.items() if not differences(row, there[identity])
    }
    return {identity: row for identity, row in matched.items() if row["scene"] in alike}


def differences(here: Mapping[str, str], there: Mapping[str, str]) -> list[str]:
    return [
        f"{name} {there.get(name, '')} -> {here.get(name, '')}"
        for name in NAMES[5:]
        if there.get(name, "") != here.get(name, "")
    ]


def check(stem: str, results: Results) -> tuple[str, bool]:
    """Returns the lines to print, and whether all rows are equal.

    A kept row that timed out here is skipped; one with any other status than `ok` counts as
    different. So do rows of other shapes than the kept ones if the version of CGAL is the same.
    """
    here, there, cases = rows_of(results), kept(stem), results.cases
    other_rows = rows_of(results, of_other_shapes=True)
    other_words = {words(row) for row in other_rows.values()}
    other_words &= {words(row) for row in there.values()}
    skipped = (
        f"{len(other_words)} rows not compared: {unlike.sentence(results, unlike.rows(results))}"
        if other_words
        else ""
    )
    never_run = {*missing.missing_rows(results), *unlike.rows(results)}
    lost = {
        str(cases.identity[row])[:16]: str(cases.status[row])
        for row in range(len(cases))
        if cases.status[row] not in ("ok", "timeout") and row not in never_run
    }
    new = {identity: row for identity, row in here.items() if identity not in there}
    rest = {
        identity: row
        for identity, row in there.items()
        if identity not in here and identity not in lost
    }
    here |= same_words(new, rest)
    both = [identity for identity in there if identity in here or identity in lost]
    if not both and (lacking := missing.note(results)):
        return f"{stem}: nothing compared: {lacking}", True
    if not both and skipped:
        return f"{stem}: {skipped}", not unlike.same_cgal(results)
    if not both:
        return (
            f"{stem}: none of the {len(there)} rows in results/reference/counts is in this result, whose sizes may differ: try PROFILE=paper",
            not there,
        )
    differing = {
        identity: [f"status ok -> {lost[identity]}"] for identity in both if identity not in here
    }
    differing |= {
        identity: changes
        for identity in both
        if identity in here and (changes := differences(here[identity], there[identity]))
    }
    lines = [
        f"{stem}: bounds and counted work equal the reference: {len(both) - len(differing)} of {len(both)} rows"
        + (f"; {skipped}" if skipped else "")
    ]
    for identity, changes in list(differing.items())[:10]:
        row = there[identity]
        lines.append(
            f"  {row['solver']} on {row['scene']}, pose {row['pose']}, tolerance {row['tolerance']}: {'; '.join(changes)}"
        )
    return "\n".join(lines), not differing and not (skipped and unlike.same_cgal(results))


def keep(stem: str, results: Results) -> Path:
    """Adds the rows of the results to the kept ones. A kept row of the same words, of other shapes
    or limits, is replaced.

    Raises ResultError if a row is of another shape than the kept one.
    """
    unlike.expect_none(results)
    unlike.keep(results)
    FOLDER.mkdir(parents=True, exist_ok=True)
    new = rows_of(results)
    replaced = {words(row) for row in new.values()}
    rows = {
        identity: row for identity, row in kept(stem).items() if words(row) not in replaced
    } | new
    records: list[tables.Record] = []
    for row in rows.values():
        records.append({name: row.get(name, "") for name in NAMES})
    path = FOLDER / f"{stem}.csv"
    table_files.write_whole(path, table_files.comma_separated(records))
    return path


def measure(stem: str, options: Sequence[str], folder: Path) -> Path:
    """Runs an experiment at the paper's sizes, once, into the folder, and returns the folder.
    Raises ResultError if that fails."""
    file = next((ROOT / "experiments").rglob(f"{stem}.toml"), None)
    if file is None:
        raise ResultError(f"{stem}: no such experiment")
    experiment, once = tomllib.loads(file.read_text(encoding="utf-8")), {"rounds": 1, "repeats": 0}
    profiles = experiment.get("profile", {})
    text = tomli_w.dumps(
        experiment | once | {"profile": profiles | {"paper": profiles.get("paper", {}) | once}}
    )
    (folder / file.name).write_text(text, encoding="utf-8")
    program = os.environ.get("HAUSBENCH_PROGRAM", str(ROOT / "build" / "release" / "hausbench"))
    command = [
        program,
        "run",
        str(folder / file.name),
        "--profile",
        "paper",
        "--results",
        str(folder),
        "--no-reference",
        "--quiet",
        *options,
    ]
    try:
        done = subprocess.run(
            command, cwd=ROOT, capture_output=True, text=True, check=False, stdin=subprocess.DEVNULL
        )
    except OSError as problem:
        raise ResultError(f"{program}: {problem.strerror}: build it with 'make build'") from None
    if done.returncode:
        raise ResultError(
            f"{stem}: exit code {done.returncode}: {(done.stderr or done.stdout).strip()}"
        )
    return folder


def main(arguments: Sequence[str] | None = None) -> int:
    """Returns the exit code: 1 if a row differs, 2 if a result cannot be read."""
    parser = argparse.ArgumentParser(
        prog="analysis.check_reference",
        description="Compares bounds and counted work with the kept ones.",
    )
    parser.add_argument("stems", nargs="*", metavar="STEM")
    parser.add_argument(
        "--again",
        action="store_true",
        help="measure the stems again instead of reading their results",
    )
    parser.add_argument(
        "--sample", action="store_true", help="measure a part of the kept rows again"
    )
    parser.add_argument(
        "--results",
        type=Path,
        default=Path("results"),
        help="folder of the .h5 files (default: results)",
    )
    parser.add_argument(
        "--keep",
        action="store_true",
        help="add the rows of these results to results/reference/counts",
    )
    chosen, code = parser.parse_args(arguments), 0
    if bool(chosen.stems) == chosen.sample:
        parser.error("name stems, or use --sample")
    for stem in chosen.stems or SAMPLE:
        try:
            with tempfile.TemporaryDirectory(prefix="hausbench-reference-") as folder:
                again = chosen.again or chosen.sample
                results = load(
                    (
                        measure(stem, SAMPLE[stem] if chosen.sample else [], Path(folder))
                        if again
                        else chosen.results
                    )
                    / f"{stem}.h5"
                )
            if chosen.keep:
                print(keep(stem, results))
                continue
            message, equal = check(stem, results)
        except ResultError as problem:
            print(problem, file=sys.stderr)
            code = 2
            continue
        print(message)
        code = code or (0 if equal else 1)
    return code


if __name__ == "__main__":
    sys.exit(main())
