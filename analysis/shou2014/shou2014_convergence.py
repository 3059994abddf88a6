"""Compares intervals for the example of Shou et al. 2014, by voxel size, with our enclosure: width,
work and time."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import matplotlib.pyplot as plt

from analysis.shared import claims, numerals, style, tables
from analysis.shared.drawable import as_formula
from analysis.shared.load import paper_numbers
from analysis.shared.notes import machine_line
from analysis.shared.report import Report
from analysis.shared.results import Results
from analysis.shared.estimates import exact as exactly
from analysis.shared.verdicts import Verdict, all_of, everywhere
from analysis.shou2014.shou2014_example import Joined, join

FORMS = ("natural", "centred", "affine", "modified_affine")
SHRINKS = 0.6  # halving voxels must shrink the width to at most this share: 1/2, with slack for where voxels lie
WORK = 8  # factor in the number of distances if voxels are halved
MARKERS = {"natural": "o", "centred": "s", "affine": "^", "modified_affine": "d"}


def collect(results: Results) -> tuple[dict[tuple[str, str, int], Joined], dict[float, Joined]]:
    """Returns answers with both directions: of the published method by label, form and depth, and
    of ours by tolerance."""
    cases = results.cases
    groups: dict[tuple[Any, ...], list[int]] = {}
    for row in range(len(cases)):
        if cases.status[row] != "ok":
            continue
        key: tuple[Any, ...] = (float(cases.tolerance[row]),)
        if cases.solver[row] == "interval_subdivision":
            options = results.options(row)
            key = (cases.label[row], str(options["form"]), int(options["depth"]))
        groups.setdefault(key, []).append(row)
    both = {key: join(results, rows) for key, rows in groups.items() if len(rows) == 2}
    published = {(str(k[0]), str(k[1]), int(k[2])): v for k, v in both.items() if len(k) == 3}
    ours = {float(k[0]): v for k, v in both.items() if len(k) == 1}
    return published, ours


def make(results: Results) -> Report:
    published, ours = collect(results)
    exact = float(paper_numbers("shou2014_example")["exact"])
    depths = sorted({depth for _, _, depth in published})
    table = tables.Table(
        "Interval of H for the cones of Shou et al. 2014 against voxels per axis; subdivision and distances are separate, both directions together.",
        [
            "voxels / tolerance",
            "lower",
            "upper",
            "width",
            "holds H",
            *[f"polynomial bounds, {f.replace('_', ' ')}" for f in FORMS],
            "subdivision, s",
            "pruned pairs, s",
            "box distances",
            "all pairs, s",
            "box distances, all",
        ],
    )
    records: list[tables.Record] = []
    for (label, form, depth), answer in sorted(published.items()):
        records.append({"method": label, "form": form, "voxels": 2**depth, **answer.record()})
    for depth in depths:
        if ("pruned pairs", "modified_affine", depth) not in published:
            continue
        answer = published["pruned pairs", "modified_affine", depth]
        every = published.get(("all pairs", "modified_affine", depth))
        forms = [published.get(("pruned pairs", form, depth)) for form in FORMS]
        table.rows.append(
            [
                f"{2**depth}³",
                numerals.at_least(answer.lower, 8),
                numerals.at_most(answer.upper, 8),
                numerals.number(answer.upper - answer.lower),
                "yes" if answer.lower <= exact <= answer.upper else "no",
                *[f"{f.evaluations:,}" if f else numerals.NOTHING for f in forms],
                numerals.number(answer.prepare),
                numerals.number(answer.solve),
                f"{answer.distances:,}",
                numerals.number(every.solve) if every else numerals.NOTHING,
                f"{every.distances:,}" if every else numerals.NOTHING,
            ]
        )
    rule = len(table.rows)
    for tolerance in sorted(ours, reverse=True):
        answer = ours[tolerance]
        table.rows.append(
            [
                f"ours, {tolerance:g}",
                numerals.at_least(answer.lower, 10),
                numerals.at_most(answer.upper, 10),
                numerals.number(answer.upper - answer.lower),
                "yes" if answer.lower <= exact <= answer.upper else "no",
                *3 * [numerals.NOTHING],
                f"{answer.evaluations:,}",
                numerals.number(answer.prepare),
                numerals.number(answer.solve),
                f"{answer.distances:,}",
                numerals.NOTHING,
                numerals.NOTHING,
            ]
        )
        records.append({"method": "surface_enclosure", "tolerance": tolerance, **answer.record()})
    table.rules = {rule}
    table.verdicts = verdicts(published, exact)
    different = []
    for depth in depths:
        intervals = {
            (answer.lower, answer.upper)
            for (label, _, d), answer in published.items()
            if d == depth and label == "pruned pairs"
        }
        if len(intervals) > 1:
            different.append(depth)
    table.notes = [
        f"Exact H = {exact:.10f} (sqrt 43/3 - 4/3). {holding(published.values(), exact)} of the published method's intervals contain it, which the method "
        f"itself does not prove. {holding(ours.values(), exact)} of the proven ones ('ours') contain it.",
        "All four forms give the same interval at every size."
        if not different
        else "The forms give different intervals at "
        + ", ".join(f"{2**d}³" for d in different)
        + "; shown: modified affine.",
        f"Here: {machine_line(results)}.",
    ]
    caption = (
        "The cones of Shou et al. 2014, both directions together: (a) the interval of H and the exact H, (b) the number of polynomial bounds "
        "relative to natural interval arithmetic, and (c) the times to subdivide, by kind of arithmetic, and to measure distances, in seconds, by "
        "voxels per axis; (d) the width of the interval against the whole time, in seconds, with this project's enclosure ('ours') at several "
        "tolerances. (a) and (d) use modified affine arithmetic."
    )
    return Report(lambda: draw(published, ours, exact, depths), table, records, caption=caption)


def verdicts(published: dict[tuple[str, str, int], Joined], exact: float) -> list[Verdict]:
    """Judges claims on the published method: width with pruning, distances for all pairs, both in
    modified affine arithmetic, and whether all intervals hold. These numbers are exact, so no
    statistical test is needed.
    """

    def of(label: str) -> dict[int, Joined]:
        return {
            depth: answer
            for (name, form, depth), answer in sorted(published.items())
            if (name, form) == (label, "modified_affine")
        }

    pruned, every = of("pruned pairs"), of("all pairs")
    widths = {depth: answer.upper - answer.lower for depth, answer in pruned.items()}
    steps = [
        exactly(SHRINKS * widths[depth] / widths[depth + 1])
        for depth in widths
        if depth + 1 in widths
    ]
    work = [
        exactly(every[depth + 1].distances / answer.distances / WORK)
        for depth, answer in every.items()
        if depth + 1 in every and answer.distances
    ]
    outside = sum(not answer.lower <= exact <= answer.upper for answer in published.values())
    return [
        everywhere(claims.of("shou2014", "any_precision"), steps, "steps"),
        everywhere(claims.of("shou2014", "overwhelming"), work, "steps"),
        all_of(
            claims.of("shou2014", "holds_distance"),
            outside,
            len(published),
            len(published),
            "intervals",
        ),
    ]


def holding(intervals: Iterable[Joined], exact: float) -> str:
    """Returns how many intervals contain the exact distance: '3 of 4'."""
    held = [answer.lower <= exact <= answer.upper for answer in intervals]
    return f"{sum(held)} of {len(held)}"


Points = list[tuple[float, Joined]]  # by voxels along an axis


def draw(
    published: dict[tuple[str, str, int], Joined],
    ours: dict[float, Joined],
    exact: float,
    depths: list[int],
) -> Any:
    figure, ((interval, bounds), (seconds, widths)) = plt.subplots(
        2, 2, figsize=(style.DOUBLE_COLUMN, 4.3)
    )
    at = [2.0**d for d in depths]

    def of(label: str, form: str = "modified_affine") -> Points:
        return [
            (2.0**d, published[label, form, d]) for d in depths if (label, form, d) in published
        ]

    pruned, every, forms = (
        of("pruned pairs"),
        of("all pairs"),
        {form: of("pruned pairs", form) for form in FORMS},
    )
    draw_interval(interval, pruned, exact, at[0] if at else 1)
    draw_bounds(bounds, forms)
    draw_seconds(seconds, forms, pruned, every)
    for ax in (interval, bounds, seconds):
        ax.set_xscale("log", base=2)
        ax.set_xticks(at, [f"{int(a)}" for a in at])
        ax.minorticks_off()
        ax.set_xlabel("voxels per axis")
    draw_widths(widths, pruned, every, list(ours.values()))
    seconds.set_ylim(top=seconds.get_ylim()[1] * 30)  # room for the legend
    seconds.legend(fontsize=6, frameon=False, ncols=2, loc="upper left")
    for ax in (bounds, widths):
        ax.legend(fontsize=6, frameon=False)
    return figure


def draw_interval(ax: Any, pruned: Points, exact: float, left: float) -> None:
    plain = style.look("interval_subdivision")
    x = [voxels for voxels, _ in pruned]
    lower = [answer.lower for _, answer in pruned]
    upper = [answer.upper for _, answer in pruned]
    ax.fill_between(x, lower, upper, color=plain.colour, alpha=0.15, linewidth=0)
    for ends in (lower, upper):
        ax.plot(x, ends, color=plain.colour, marker=plain.marker, markersize=3.5)
    ax.axhline(
        exact, color=style.look("surface_enclosure").colour, linewidth=0.9, linestyle=(0, (3, 2))
    )
    as_formula(
        ax.annotate(
            r"$H = \sqrt{43}/3 - 4/3$",
            (left, exact),
            xytext=(4, -3),
            textcoords="offset points",
            ha="left",
            va="top",
            fontsize=7,
        )
    )
    ax.set_ylabel("interval of H (units of the model)")


def look_of(form: str) -> dict[str, Any]:
    return {
        "marker": MARKERS[form],
        "markersize": 3.5,
        "linewidth": 0.8,
        "color": str(0.65 - 0.2 * FORMS.index(form)),
    }


def draw_bounds(ax: Any, forms: dict[str, Points]) -> None:
    natural = dict(forms["natural"])
    for form, points in forms.items():
        shared = [(x, answer) for x, answer in points if x in natural]
        voxels = [x for x, _ in shared]
        relative = [answer.evaluations / natural[x].evaluations for x, answer in shared]
        ax.plot(voxels, relative, label=form.replace("_", " "), **look_of(form))
    ax.set_ylabel("polynomial bounds, natural = 1")


def draw_seconds(ax: Any, forms: dict[str, Points], pruned: Points, every: Points) -> None:
    for form, points in forms.items():
        voxels = [x for x, _ in points]
        ax.plot(
            voxels,
            [answer.prepare for _, answer in points],
            label=f"subdivision, {form.replace('_', ' ')}",
            **look_of(form),
        )
    colour = style.look("interval_subdivision").colour
    for points, name, face in ((pruned, "pruned pairs", colour), (every, "all pairs", "white")):
        voxels = [x for x, _ in points]
        ax.plot(
            voxels,
            [answer.solve for _, answer in points],
            color=colour,
            marker="o",
            markersize=3.5,
            linestyle=(0, (3, 1.5)),
            markerfacecolor=face,
            markeredgecolor=colour,
            label=f"distances, {name}",
        )
    ax.set_yscale("log")
    ax.set_ylabel("time (s)")


def draw_widths(ax: Any, pruned: Points, every: Points, ours: list[Joined]) -> None:
    def line(members: list[Joined], looks: style.Look, name: str, **more: Any) -> None:
        points = sorted(
            ((answer.upper - answer.lower, answer.prepare + answer.solve) for answer in members),
            reverse=True,
        )
        times = [time for _, time in points]
        widths = [width for width, _ in points]
        ax.plot(
            times, widths, **(style.filled_marker(looks) | {"linestyle": "-"} | more), label=name
        )

    plain = style.look("interval_subdivision")
    line(
        [answer for _, answer in every],
        plain,
        "all pairs",
        markerfacecolor="white",
        markeredgecolor=plain.colour,
    )
    line([answer for _, answer in pruned], plain, "pruned pairs")
    line(ours, style.look("surface_enclosure"), "ours")
    ax.set_xscale("log")
    ax.set_yscale("log")
    ax.minorticks_off()
    ax.set_xlabel("time, subdivision included (s)")
    ax.set_ylabel("width of the interval\n(units of the model)")
