"""Runs of all solvers on a large collection of meshes: the share of meshes answered over time, and
the reasons for failures."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from typing import Any, Final

import matplotlib.pyplot as plt
import numpy as np

from analysis.shared import claims, numerals, style, tables
from analysis.shared.notes import machine_line
from analysis.shared.report import Report
from analysis.shared.results import Results
from analysis.shared.estimates import median
from analysis.shared.verdicts import Verdict, never

NEVER_RAN: Final = ("skipped", "not_built")
ANSWERS: Final = "ok"
MOST_NAMED: Final = 20  # meshes listed by name for one reason; the CSV has all


def seconds(results: Results, row: int) -> float:
    """Returns the time to prepare and give the first answer in round 0; NaN if the row did not
    reach the tolerance."""
    return (
        results.total_by_round(row).get(0, np.nan)
        if results.cases.status[row] == ANSWERS
        else np.nan
    )


def shown_reason(reason: str) -> str:
    """Removes names, paths and numbers from a reason, so that similar reasons are counted
    together."""

    def differs(word: str, before: str | None) -> bool:
        return before != "signal" and (
            "/" in word or word[0] in "'\"" or any(character.isdigit() for character in word)
        )

    said = reason.split(";")[0].split()
    words = ["…" if differs(word, before) else word for word, before in zip(said, [None, *said])]
    return " ".join(
        word for word, before in zip(words, [None, *words]) if (word, before) != ("…", "…")
    )


def unmeasured(results: Results) -> dict[str, tuple[str, str]]:
    """Returns status and reason of each scene that no solver could run, because its mesh could not
    be read or derived."""
    cases = results.cases
    lost: dict[str, tuple[str, str]] = {}
    for scene in results.scenes:
        rows = results.rows(scene=scene)
        if all(
            np.isnan(cases.solve_seconds[row])
            and cases.source_elements[row] * cases.target_elements[row] == 0
            for row in rows
        ):
            lost[scene] = (cases.status[rows[0]], cases.reason[rows[0]])
    return lost


def sound(results: Results) -> Verdict:
    """Judges the claim that no certified solver is wrong, fails or crashes on a readable mesh.

    Each mesh is one trial, because solvers on the same mesh are not independent.
    """
    cases, lost = results.cases, unmeasured(results)
    rows = [
        row
        for row in range(len(cases))
        if cases.certified[row] == 1
        and cases.scene[row] not in lost
        and cases.status[row] not in NEVER_RAN
    ]
    ill = [row for row in rows if cases.status[row] in ("unsound", "signal", "failed")]
    return never(
        claims.of("hausbench", "corpus"),
        len(ill),
        len(rows),
        "cases",
        len({cases.scene[row] for row in rows}),
    )


def named(scenes: list[str]) -> str:
    return f"{len(scenes)}: {', '.join(scenes)}" if len(scenes) <= MOST_NAMED else str(len(scenes))


def explained(results: Results, lost: dict[str, tuple[str, str]]) -> list[str]:
    """Returns one sentence per reason for missing answers, the most frequent first: of whole
    meshes, then of single solvers."""
    cases = results.cases
    meshes: dict[str, list[str]] = {}
    for scene, (status, reason) in lost.items():
        meshes.setdefault(f"{status}: {shown_reason(reason)}", []).append(scene)
    lines = []
    for why, scenes in sorted(meshes.items(), key=lambda entry: -len(entry[1])):
        lines.append(f"Not measured, {why} ({named(scenes)}).")
    single: dict[tuple[str, str, str], list[str]] = {}
    for row in range(len(cases)):
        if cases.scene[row] not in lost and cases.status[row] != ANSWERS:
            kind = (
                style.title(cases.solver[row], cases.label[row]),
                cases.status[row],
                shown_reason(cases.reason[row]),
            )
            single.setdefault(kind, []).append(cases.scene[row])
    lines += [
        f"{solver}, {style.status_word(status)}: {reason or 'no reason'} ({named(scenes)})."
        for (solver, status, reason), scenes in sorted(
            single.items(), key=lambda entry: -len(entry[1])
        )
    ]
    return lines


def late(results: Results) -> list[str]:
    """Says how many answers came after the time limit, by solver.

    Solvers are asked to stop at the limit and killed some seconds later; answers in between count.
    """
    cases = results.cases
    after = Counter(
        style.title(cases.solver[row], cases.label[row])
        for row in range(len(cases))
        if cases.status[row] == ANSWERS and cases.solve_seconds[row] > cases.case_seconds_limit[row]
    )
    return [
        f"{solver}: {count} of its answers came after the limit, but before it was ended."
        for solver, count in after.most_common()
    ]


def make(results: Results) -> Report:
    cases, lost = results.cases, unmeasured(results)
    measured = [scene for scene in results.scenes if scene not in lost]
    labels = style.order(zip(cases.solver, cases.label))
    times: dict[str, list[float]] = {}
    for _, label in labels:
        times[label] = [
            seconds(results, row)
            for scene in measured
            for row in results.rows(scene=scene, label=label)
        ]
    statuses = sorted(
        {cases.status[row] for row in range(len(cases)) if cases.scene[row] not in lost}
        - {ANSWERS, *NEVER_RAN}
    )
    table = tables.Table(
        f"{results.meta.get('title', '')}: tolerance {numerals.number(float(cases.tolerance[0]))} of the diagonal, on {len(measured)} of {len(results.scenes)} "
        f"meshes, within {numerals.number(float(cases.case_seconds_limit[0]))} s.",
        [
            "solver",
            "within tolerance",
            *[style.status_word(status) for status in statuses],
            "median, ms",
            "90 % within, ms",
            "slowest, ms",
        ],
    )
    records: list[tables.Record] = []
    for solver, label in labels:
        rows = [row for scene in measured for row in results.rows(scene=scene, label=label)]
        counts = Counter(cases.status[row] for row in rows)
        finite_times = np.array([x for x in times[label] if np.isfinite(x)])
        middle, slowest = (
            median(finite_times),
            1e3 * float(finite_times.max()) if len(finite_times) else math.nan,
        )
        table.rows.append(
            [
                style.title(solver, label),
                f"{counts[ANSWERS]} of {len(rows)}",
                *[str(counts[status]) for status in statuses],
                numerals.estimate(middle, 1e3),
                quantile(finite_times, 0.9),
                numerals.number(slowest),
            ]
        )
    for row in range(len(cases)):
        records.append(
            {
                "mesh": cases.source[row],
                "triangles": int(cases.source_elements[row]),
                "solver": cases.solver[row],
                "label": cases.label[row],
                "status": cases.status[row],
                "reason": cases.reason[row],
                "lower": float(cases.lower[row]),
                "upper": float(cases.upper[row]),
                "diagonal": float(cases.source_diagonal[row]),
                "seconds": seconds(results, row),
            }
        )
    table.verdicts = [sound(results)]
    table.notes += [
        "Times cover preparing and the first answer, only for answers within tolerance; the interval of a median is over meshes.",
        *late(results),
        *explained(results, lost),
        f"{machine_line(results)}.",
    ]
    return Report(lambda: draw(labels, times, len(measured)), table, records)


def quantile(values: Sequence[float] | np.ndarray[Any, Any], share: float) -> str:
    return (
        numerals.number(1e3 * float(np.quantile(values, share)))
        if len(values)
        else numerals.NOTHING
    )


def draw(labels: list[tuple[str, str]], times: dict[str, list[float]], meshes: int) -> Any:
    """Draws the share of meshes answered within a time. A higher curve answers more; a curve
    further left answers sooner."""
    figure, ax = plt.subplots(figsize=(style.SINGLE_COLUMN, 2.6))
    for solver, label in labels:
        finite_times = np.sort([x for x in times[label] if np.isfinite(x)])
        looks = style.look(solver, label)
        ax.step(
            1e3 * finite_times,
            100 * np.arange(1, len(finite_times) + 1) / max(1, meshes),
            where="post",
            color=looks.colour,
            linestyle=looks.line,
            label=style.title(solver, label),
        )
    ax.set_xscale("log")
    ax.set_ylim(0, 101)
    ax.set_xlabel("time to prepare and answer, ms")
    ax.set_ylabel("meshes answered, %")
    style.legend_above(figure, style.handles(labels), columns=4)
    return figure
