"""Fig. 11 of Sacht and Jacobson 2024: A, coloured by the last upper bound that was computed for
each triangle."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import PowerNorm, to_rgba
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from analysis.shared import claims, mesh_picture, numerals, shapes, style, tables
from analysis.shared.columns import Floats
from analysis.shared.notes import machine_line
from analysis.shared.report import NO_TIMES, Report
from analysis.shared.results import ResultError, Results
from analysis.shared.shapes import Drawn, Mesh
from analysis.shared.verdicts import FAILS, HOLDS, OPEN, UNTESTED, Verdict, all_of

NAMES: Final = ("exact", "u1", "u2", "u3", "u4")
THIN: Final = 0.1
COLOURS: Final = (
    "#FFFFFF",
    "#332288",
    "#0072B2",
    "#56B4E9",
    "#D55E00",
)  # differ in lightness even if darkened by SHADE
SHADE: Final = 0.15


@dataclass(frozen=True)
class Shown:
    """One pair to draw, with the values per triangle and vertex."""

    scene: str
    case: int
    last: Any  # for each triangle of A, an index into NAMES
    distance: Floats  # of points of A to B; the vertices of A come first

    @property
    def counts(self) -> list[int]:
        return [int((self.last == k).sum()) for k in range(len(NAMES))]

    @property
    def shares(self) -> list[float]:
        return [count / max(1, len(self.last)) for count in self.counts]


def collect(results: Results) -> list[Shown]:
    cases, pairs = results.cases, list[Shown]()
    for case in range(len(cases)):
        fields = results.fields_of(case)
        if cases.solver[case] == "sacht" and results.is_bounded(case) and "bound" in fields:
            pairs.append(
                Shown(
                    cases.scene[case],
                    case,
                    fields["bound"].astype(np.int64),
                    fields.get("distance", np.empty(0)),
                )
            )
    if not pairs:
        raise ResultError(
            f"{results.path}: no row of sacht has the field 'bound': measure it again with 'make {results.stem}'"
        )
    return pairs


def verdicts(pairs: list[Shown]) -> list[Verdict]:
    """Judges how often each bound was the last one. Counts are exact, so no statistical test is
    needed."""
    judged = []
    for pair in pairs:
        counts, n = pair.counts, len(pair.last)
        said = ", ".join(
            f"{name} {numerals.number(100 * share, 2)} %" for name, share in zip(NAMES, pair.shares)
        )
        unused = [name for name, count in zip(NAMES, counts) if not count]
        used = all_of(
            claims.of("sacht2024", "all_bounds", pair.scene),
            len(unused),
            len(NAMES),
            len(NAMES),
            f"bounds, of {n:,} triangles",
        )
        # The exact case and u1 are the two least used if both counts are below all others.
        more = [name for name, count in zip(NAMES[2:], counts[2:]) if count <= max(counts[:2])]
        least = all_of(
            claims.of("sacht2024", "least_used", pair.scene),
            len(more),
            3,
            3,
            f"comparisons with another bound: {said}",
        )
        # u2 and u3 are the two most used if both counts are above all others.
        less = [
            name
            for name, count in zip(NAMES[2:4], counts[2:4])
            if count <= max(*counts[:2], counts[4])
        ]
        judged += [
            used,
            least,
            all_of(claims.of("sacht2024", "u2_u3", pair.scene), len(less), 2, 2, f"bounds: {said}"),
        ]
    return judged


def thin(pair: Shown, a: Mesh) -> Verdict:
    """Judges a claim about the last bound of most thin triangles that B lacks.

    A triangle is thin if its height is below THIN times its longest edge. B lacks it if all its
    corners are farther from B than this height.
    """
    sides = a.corners[a.triangles]
    edges = np.linalg.norm(sides - np.roll(sides, 1, axis=1), axis=2).max(axis=1)
    area = np.linalg.norm(np.cross(sides[:, 1] - sides[:, 0], sides[:, 2] - sides[:, 0]), axis=1)
    claim = claims.of("sacht2024", "thin", pair.scene)
    if len(pair.distance) < len(a.corners):
        return Verdict(claim, UNTESTED, "no distances at the vertices of A")
    thinnest = area < THIN * edges * edges  # twice the area is height times edge
    gone = thinnest & (pair.distance[a.triangles].min(axis=1) * edges > area)
    if not gone.any():
        return Verdict(claim, UNTESTED, f"none of {int(thinnest.sum())} thin triangles disappears")
    counts = [int((pair.last[gone] == k).sum()) for k in range(len(NAMES))]
    said, rest = ", ".join(f"{name} {count}" for name, count in zip(NAMES, counts)), max(counts[:4])
    return Verdict(
        claim,
        HOLDS if counts[4] > rest else FAILS if counts[4] < rest else OPEN,
        f"of {int(gone.sum())} triangles whose height is below {THIN:g} of their longest edge and below the distances of their corners: {said}",
    )


def make(results: Results) -> Report:
    pairs, cases = collect(results), results.cases
    table = tables.Table(
        "The upper bound computed last for each triangle of A, or for a piece of it, in percent of the triangles: Fig. 11 of Sacht and "
        "Jacobson 2024.",
        ["A to B", "|A| / |B|", "h / diagonal, %", "subdivisions", *NAMES],
        left=1,
    )
    for pair in pairs:
        table.rows.append(
            [
                pair.scene,
                results.sizes(pair.case),
                numerals.number(100 * results.share(pair.case)),
                f"{cases.counters['subdivisions'][pair.case]:,}",
                *[numerals.number(100 * share) for share in pair.shares],
            ]
        )
    records: list[tables.Record] = [
        {"scene": pair.scene, "bound": name, "triangles": count, "share": share}
        for pair in pairs
        for name, count, share in zip(NAMES, pair.counts, pair.shares)
    ]
    table.verdicts = [
        *verdicts(pairs),
        *[thin(pair, shapes.mesh(results, cases.source[pair.case])) for pair in pairs],
    ]
    table.notes = [
        "Each triangle has the colour of the last of its pieces; in the paper each piece has its own. A bound is computed if the bounds before "
        "it do not settle the piece. 'exact': the three closest points are on one triangle of B. The paper prints no shares. It says that the "
        "exact case and u1 are used least, and u4 most on very thin triangles that disappear in B: here, triangles whose corners are all farther "
        "from B than their height.",
        *[f"{pair.scene}: {cases.scene_note[pair.case]}." for pair in pairs],
        f"Tolerance {cases.tolerance[pairs[0].case]:g} of the diagonal of A. Here: {machine_line(results)}.",
    ]
    return Report(lambda: draw(results, pairs), table, records, clock=NO_TIMES)


def square_root_scale(shown: Drawn, unit: float) -> PowerNorm:
    """Returns a colour scale of distances times `unit`, up to the distance that 99 % of the surface
    does not exceed.

    Otherwise a few distant places would leave the rest in one colour.
    """
    sides, order = shown.corners[shown.triangles], np.argsort(shown.colours)
    area = np.linalg.norm(np.cross(sides[:, 1] - sides[:, 0], sides[:, 2] - sides[:, 0]), axis=1)[
        order
    ].cumsum()
    end = unit * float(shown.colours[order][np.searchsorted(area, 0.99 * area[-1])])
    return PowerNorm(0.5, 0, end if end > 0 else 1.0)


def draw(results: Results, pairs: list[Shown]) -> Any:
    """Draws one row per pair: A coloured by last bounds, A coloured by distance to B, and B."""
    figure, axes = plt.subplots(
        len(pairs), 3, figsize=(style.DOUBLE_COLUMN, 0.5 + 2.2 * len(pairs)), squeeze=False
    )
    palette = np.array([to_rgba(colour) for colour in COLOURS])
    for (left, middle, right), pair in zip(axes, pairs):
        source, target = (
            str(column[pair.case]) for column in (results.cases.source, results.cases.target)
        )
        a, farthest = shapes.mesh(results, source), results.cases.witness_source[pair.case]
        eye = mesh_picture.showing(a, mesh_picture.view_of(source), farthest)
        mesh_picture.draw(
            left, a, eye, palette[pair.last], edges=0.12, both_sides=not a.closed, shade=SHADE
        )
        far, diagonal = shapes.drawn(results, pair.case), float(
            results.cases.source_diagonal[pair.case]
        )
        scale = square_root_scale(far, 100 / diagonal)
        mesh_picture.draw(
            middle,
            far,
            eye,
            plt.get_cmap("viridis")(scale(100 * far.colours / diagonal)),
            both_sides=not a.closed,
        )
        middle.set_title("A: distance to B")
        figure.colorbar(
            plt.cm.ScalarMappable(scale, "viridis"), ax=middle, shrink=0.7, pad=0.01, extend="max"
        ).set_label(
            f"% of the diagonal, square-root scale;\nthe largest: {numerals.number(100 * float(far.distances.max()) / diagonal)}"
        )
        b = shapes.mesh(results, target)
        mesh_picture.draw(right, b, eye, edges=0.12, both_sides=not b.closed)
        witness = eye.seen(farthest)
        for ax in (left, middle):
            mesh_picture.ring(ax, witness)
        left.set_title(f"A: {pair.scene}, {results.cases.source_elements[pair.case]:,} triangles")
        right.set_title(f"B: {results.cases.target_elements[pair.case]:,} triangles")
    entries = [
        *[
            Patch(facecolor=colour, edgecolor=style.GREY, linewidth=0.4, label=name)
            for name, colour in zip(NAMES, COLOURS)
        ],
        Line2D(
            [],
            [],
            linestyle="none",
            marker="o",
            markersize=6,
            markerfacecolor="none",
            markeredgecolor="black",
            label="the farthest point found",
        ),
    ]
    style.legend_above(figure, entries, columns=6)
    return figure
