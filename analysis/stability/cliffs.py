"""Work and time of each solver against the ratio of two lengths of a scene, relative to those at ratio 1."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Final

import matplotlib.pyplot as plt
import numpy as np

from analysis.shared import scales, style, tables, verdicts
from analysis.shared.cells import takes_seed
from analysis.shared.notes import machine_line
from analysis.shared.report import Report
from analysis.shared.results import ResultError, Results
from analysis.shared.statistics import median
from analysis.shared.verdicts import Verdict

MOST: Final = 4.0  # times the work of ratio 1: more is a cliff
FLAT: Final = 1.02  # work that differs by no more has stopped growing
COUNTED: Final = ("point_distances", "point_triangle_distances", "box_distances", "node_visits", "bound_tests",
                  "polynomial_evaluations")
ANSWERED: Final = ("ok", "floor")
NOT_RUN: Final = ("skipped", "not_built")


@dataclass(frozen=True)
class Family:
    title: str
    axis: str = "ratio"
    claim: str = ""  # subject of a verdict; families with the same text share one verdict for each solver


QUERIES: Final = "closest point work"
FAMILIES: Final[dict[str, Family]] = {
    "mesh_stray_in_B": Family("mesh, stray triangle in B", claim=QUERIES),
    "mesh_stray_in_A": Family("mesh, stray triangle in A", claim=QUERIES),
    "mesh_away": Family("mesh, A moved away", claim=QUERIES),
    "mesh_two_clusters": Family("meshes, two clusters", claim=QUERIES),
    "points_stray_in_B": Family("points, outlier in B", claim=QUERIES),
    "points_stray_in_A": Family("points, outlier in A", claim=QUERIES),
    "points_away": Family("points, A moved away", claim=QUERIES),
    "points_two_clusters": Family("points, two clusters", claim=QUERIES),
    "needle": Family("A: one needle triangle", claim="work on a needle triangle"),
    "surface_degree": Family("surfaces, by degree", "degree of A"),
    "surface_concentric": Family("concentric spheres", "1 / tolerance"),
}


@dataclass(frozen=True)
class Row:
    """One case. Work and seconds are NaN if it has no answer; work also if the solver counts none."""

    case: int
    ratio: float
    work: float
    seconds: float
    status: str


Curves = dict[tuple[str, str], list[Row]]  # family, label: by ratio


def place(results: Results, case: int) -> tuple[str, float]:
    """The family of a case and its ratio, from its scene's name. ResultError for any other name."""
    cases, scene = results.cases, results.cases.scene[case]
    if scene.endswith("_away") and scene in FAMILIES:
        return scene, float(f"{np.linalg.norm(cases.pose[case][9:]):.3g}")  # 10^k without its rounding error
    if scene == "surface_concentric":
        return scene, 1 / float(cases.tolerance[case])
    found = re.fullmatch(r"(.+)_(1e)?(\d\d)", scene)
    if not found or found[1] not in FAMILIES:
        raise ResultError(f"{results.path}: scene '{scene}' belongs to no family of analysis/cliffs.py: name it "
                          "FAMILY_1eNN, with a family of the list FAMILIES there")
    return found[1], 10.0 ** int(found[3]) if found[2] else float(found[3])


def collect(results: Results) -> Curves:
    cases = results.cases
    curves: Curves = {}
    for case in range(len(cases)):
        status = cases.status[case]
        if status in NOT_RUN:
            continue
        family, ratio = place(results, case)
        answered = status in ANSWERED
        work = sum(int(cases.counters[name][case]) for name in COUNTED if name in cases.counters) if answered else 0
        curves.setdefault((family, cases.label[case]), []).append(Row(
            case, ratio, float(work) if work else math.nan,
            median(results.total_seconds(case)).value if answered else math.nan, status))
    return {key: sorted(rows, key=lambda row: row.ratio) for key, rows in curves.items()}


def relative(rows: Sequence[Row], what: str) -> list[float]:
    """Work or seconds of each row, divided by those of the first."""
    values = [float(getattr(row, what)) for row in rows]
    return [value / values[0] for value in values]


def largest(rows: Sequence[Row], what: str) -> tuple[float, Row | None]:
    known = [(value, row) for value, row in zip(relative(rows, what), rows) if math.isfinite(value)]
    return max(known, key=lambda pair: pair[0]) if known else (math.nan, None)


def verdicts_of(curves: Curves, titles: dict[str, str]) -> list[Verdict]:
    """Of each claim and each solver that counts its work."""
    found = []
    for claim in dict.fromkeys(family.claim for family in FAMILIES.values() if family.claim):
        for label, title in titles.items():
            own = {key: rows for key, rows in curves.items() if key[1] == label and FAMILIES[key[0]].claim == claim}
            if any(not math.isnan(row.work) for rows in own.values() for row in rows):
                found.append(verdict(claim, title, own))
    return found


def verdict(claim: str, title: str, curves: Curves) -> Verdict:
    """Of one solver over the families of a claim. Counts are exact, so one ratio above MOST refutes the claim. So does a
    case without an answer, if the case of ratio 1 has one.
    """
    text = f"{claim} of {title} at every ratio up to 1e12 is at most {MOST:g} times that of ratio 1"
    known = {family: rows for (family, _), rows in curves.items() if rows[0].ratio == 1 and not math.isnan(rows[0].work)}
    unknown = [f"{FAMILIES[family].title} has no work at ratio 1" for family, _ in curves if family not in known]
    unknown += [f"{FAMILIES[family].title} ends at ratio {power(rows[-1].ratio)}" for family, rows in known.items()
                if rows[-1].ratio < 1e12]
    lost = Counter(row.status for rows in known.values() for row in rows if row.status not in ANSWERED)
    evidence, factor = lost_text(lost) + unknown, math.nan
    if known:
        factor, worst, family = max(((*largest(rows, "work"), family) for family, rows in known.items()),
                                    key=lambda found: found[0])
        assert worst is not None
        evidence.insert(0, f"in {len(known)} kind{'s' if len(known) > 1 else ''} of scene, largest {tables.number(factor)} times, "
                        f"{FAMILIES[family].title} at ratio {power(worst.ratio)}")
    outcome = verdicts.FAILS if lost or factor > MOST else verdicts.UNTESTED if unknown else verdicts.HOLDS
    return Verdict(text, outcome, "; ".join(evidence))


def flat_from(rows: Sequence[Row]) -> Row | None:
    """The first of at least three ratios, up to the last, whose work differs by at most FLAT; None where it goes on changing."""
    for i in range(len(rows) - 2):
        work = [row.work for row in rows[i:]]
        if all(map(math.isfinite, work)) and max(work) <= FLAT * min(work):
            return rows[i]
    return None


def away_notes(results: Results, curves: Curves, titles: dict[str, str]) -> list[str]:
    """Where moving A away makes a cliff after which work is flat: by how much, from where on, and why if the counters tell."""
    found, nodes = [], results.cases.counters.get("node_visits")
    for (key, label), rows in curves.items():
        factor, start = largest(rows, "work")[0], flat_from(rows)
        if not key.endswith("_away") or not factor > MOST or start is None or start is rows[0]:
            continue
        text = (f"{FAMILIES[key].title}: the work of {titles[label]} grows {tables.number(factor)} times and is flat from ratio "
                f"{power(start.ratio)} on")
        far = rows[rows.index(start):]
        if results.cases.solver[start.case] == "ohd" and nodes is not None and nodes[rows[0].case] > 0 \
                and not any(nodes[row.case] for row in far):
            text += (". There it visits no node of its octree, whose cells are split only until they are as small as the first "
                     "lower bound: that is larger than B, so each search goes through the points of B one by one")
        found.append(text + ".")
    return found


def power(ratio: float) -> str:
    """'1e6' of a ratio, '32' of a degree."""
    exponent = math.log10(ratio)
    return f"1e{round(exponent)}" if ratio >= 1000 and abs(exponent - round(exponent)) < 1e-6 else f"{ratio:g}"


def lost_text(lost: Counter[str]) -> list[str]:
    return [", ".join(f"{n} {style.status_word(status)}" for status, n in lost.items())] if lost else []


def make(results: Results) -> Report:
    curves = collect(results)
    labels = [pair for pair in style.order(zip(results.cases.solver, results.cases.label))
              if any(label == pair[1] for _, label in curves)]
    titles = {label: style.title(solver, label) for solver, label in labels}
    table = tables.Table(
        "Work and time of each solver where two lengths of a scene grow apart, relative to ratio 1.",
        ["scene", "solver", "work at ratio 1", "largest work / that", "at ratio", "largest time / that of ratio 1", "at ratio",
         "rows not ok"],
        left=2)
    records: list[tables.Record] = []
    for key, family in FAMILIES.items():
        table.rules.add(len(table.rows))
        for _, label in labels:
            if rows := curves.get((key, label)):
                table.rows.append([family.title, titles[label], *table_cells(rows)])
                records += [record(results, key, row, rows) for row in rows]
    table.notes += [one.line() for one in verdicts_of(curves, titles)]
    answers = {label: [row.work for (_, name), rows in curves.items() if name == label for row in rows
                       if row.status in ANSWERED] for _, label in labels}
    silent = [titles[label] for label, work in answers.items() if work and all(map(math.isnan, work))]
    table.notes += [
        "Work: distances, bounds, nodes of trees and polynomial bounds together, of one solve."
        + f" No counts, time alone: {', '.join(silent)}." * bool(silent)
        + f" {titles.get('kdtree')}, a peer, counts distances alone, and neither the nodes nor the bounds of its tree."
        * any(not math.isnan(work) for work in answers.get("kdtree", [])) + one_seed(results, curves, titles),
        *away_notes(results, curves, titles),
        "Time: preparing and solving. Ratio: a distance in the scene over the diagonal of the rest of it; base over height "
        "of a needle; degree of a surface, from 4 on; 1 / tolerance, from 10 on. A case may take "
        f"{tables.number(float(results.cases.case_seconds_limit[0]))} s.",
        f"Measured on {machine_line(results)}."]
    return Report(lambda: draw(curves, labels), table, records)


def one_seed(results: Results, curves: Curves, titles: dict[str, str]) -> str:
    drawn = {titles[label]: None for (_, label), rows in curves.items() if takes_seed(results, rows[0].case)}
    return f" Of one seed, so one draw: {', '.join(drawn)}." * bool(drawn)


def table_cells(rows: Sequence[Row]) -> list[str]:
    cells = [f"{rows[0].work:,.0f}" if not math.isnan(rows[0].work) else tables.NOTHING]
    for what in ("work", "seconds"):
        factor, worst = largest(rows, what)
        cells += [tables.number(factor), power(worst.ratio) if worst else tables.NOTHING]
    return cells + (lost_text(Counter(row.status for row in rows if row.status != "ok")) or [""])


def record(results: Results, family: str, row: Row, rows: Sequence[Row]) -> tables.Record:
    cases, at = results.cases, rows.index(row)
    new: tables.Record = {"family": family, "ratio": row.ratio}
    new |= {name: getattr(cases, name)[row.case] for name in ("scene", "solver", "label", "status", "reason")}
    new |= {"work": row.work, "work_relative": relative(rows, "work")[at], "seconds": row.seconds,
            "seconds_relative": relative(rows, "seconds")[at], "lower": float(cases.lower[row.case]),
            "upper": float(cases.upper[row.case]), "tolerance_absolute": float(cases.tolerance_absolute[row.case])}
    return new | {name: int(column[row.case]) for name, column in cases.counters.items()}


ACROSS: Final = 4
WIDE: Final = 1.46  # inches, of a frame
TALL: Final = 0.92


def draw(curves: Curves, labels: Sequence[tuple[str, str]]) -> Any:
    """A family: work above, time below it, on one axis of ratios. Frames side by side share their scale. Placed by hand,
    in inches; the legend is in the place of the last panel.
    """
    deep = 0.2 + 2 * TALL + 0.06 + 0.36
    height = deep * -(-(len(FAMILIES) + 1) // ACROSS) + 0.22
    figure = plt.figure(figsize=(style.DOUBLE_COLUMN, height))
    figure.set_layout_engine("none")
    keys = list(FAMILIES)
    bands = [keys[i:i + ACROSS] for i in range(0, len(keys), ACROSS)]
    limits = [{what: scale_of([rows for (key, _), rows in curves.items() if key in band], what)
               for what in ("work", "seconds")} for band in bands]
    statuses: set[str] = set()
    for i, (key, family) in enumerate(FAMILIES.items()):
        left, floor = 0.52 + (i % ACROSS) * (WIDE + 0.2), height - (i // ACROSS) * deep - 0.26 - 2 * TALL
        own = {label: curves[key, label] for _, label in labels if (key, label) in curves}
        for what, bottom in (("work", floor + TALL + 0.06), ("seconds", floor)):
            ax = figure.add_axes((left / style.DOUBLE_COLUMN, bottom / height, WIDE / style.DOUBLE_COLUMN, TALL / height))
            statuses |= draw_frame(ax, own, labels, what, limits[i // ACROSS][what])
            if i % ACROSS == 0:
                ax.set_ylabel({"work": "relative work", "seconds": "relative time"}[what])
                ax.yaxis.set_label_coords(-0.26, 0.5)
            else:
                ax.tick_params(labelleft=False)
            if what == "work":
                ax.set_title(family.title, pad=3)
                ax.tick_params(labelbottom=False)
            else:
                ax.set_xlabel(family.axis, labelpad=1)
    add_legend(figure, labels, statuses, len(FAMILIES), deep, height)
    return figure


def scale_of(curves: Sequence[Sequence[Row]], what: str) -> tuple[float, float]:
    """Of a band of frames, with room for letters at the top."""
    values = [x for rows in curves for x in relative(rows, what) if math.isfinite(x) and x > 0]
    low, high = min([0.5, *values]) / 1.3, max([MOST * 2, *values])
    return low, high * (high / low) ** 0.2


def draw_frame(ax: Any, own: dict[str, list[Row]], labels: Iterable[tuple[str, str]], what: str,
               limits: tuple[float, float]) -> set[str]:
    """Lines through what has an answer; a letter at the top, in the colour of the solver, for what has none."""
    ax.set_xscale("log")
    ax.set_yscale("log")
    ax.set_ylim(*limits)
    ax.axhline(MOST, color=style.GREY, linewidth=0.6, linestyle=(0, (4, 2)), zorder=1)
    ratios = sorted({row.ratio for rows in own.values() for row in rows})
    lost: Counter[float] = Counter()
    statuses: set[str] = set()
    for solver, label in labels:
        if label not in own:
            continue
        rows, looks = own[label], style.look(solver, label)
        known = [(row.ratio, y, row.status) for row, y in zip(rows, relative(rows, what)) if math.isfinite(y)]
        ax.plot([x for x, _, _ in known], [y for _, y, _ in known], color=looks.colour, linestyle=looks.line,
                linewidth=0.9, zorder=3)
        for x, y, status in known:
            ax.plot([x], [y], zorder=4, clip_on=False,
                    **(style.filled_marker(looks) if status == "ok" else style.open_marker(looks))
                    | {"markersize": 0.75 * looks.size})
        for row in rows:
            if row.status not in ANSWERED:
                statuses.add(row.status)
                ax.annotate(style.status_letter(row.status), (row.ratio, 1), (0, -4.5 - 6 * lost[row.ratio]),
                            xycoords=("data", "axes fraction"), textcoords="offset points", ha="center", va="center",
                            fontsize=6, fontweight="bold", color=looks.colour, annotation_clip=False)
                lost[row.ratio] += 1
    if ratios:
        ax.set_xlim(ratios[0] / 1.3 ** math.log10(10 * ratios[-1] / ratios[0]),
                    ratios[-1] * 1.3 ** math.log10(10 * ratios[-1] / ratios[0]))
    scales.log_ticks(ax.xaxis)
    scales.log_ticks(ax.yaxis)
    if ratios and ratios[-1] / ratios[0] < 100:  # degrees: each has its tick
        ax.set_xticks(ratios, [f"{x:g}" for x in ratios])
    elif ratios and ratios[0] == 1:
        ax.set_xticks([1, 1e4, 1e8, 1e12])
    return statuses


def add_legend(figure: Any, labels: Sequence[tuple[str, str]], statuses: set[str], slot: int, band: float,
               height: float) -> None:
    left = (0.52 + (slot % ACROSS) * (WIDE + 0.2) - 0.05) / style.DOUBLE_COLUMN
    top = 1 - ((slot // ACROSS) * band + 0.18) / height
    legend = figure.legend(handles=style.handles(labels), loc="upper left", bbox_to_anchor=(left, top), handlelength=2.2,
                           borderaxespad=0, fontsize=6.5)
    legend.set_in_layout(False)
    key = style.letters_key(statuses)
    notes = [f"Each line is relative to its first point. Dashed: {MOST:g} times that.", "Open markers: precision floor.",
             *([f"Letters: no answer ({key})."] if key else [])]
    figure.text(0.5, 0.04 / height, "  ".join(notes), ha="center", va="bottom", fontsize=7, color=style.GREY)
