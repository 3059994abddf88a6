"""Shows how often the algorithms of Zhang et al. 2017 are wrong if they are implemented exactly as
printed."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, Final

import matplotlib.pyplot as plt
import matplotlib.ticker
import numpy as np
import scipy.stats
from matplotlib.lines import Line2D

from analysis.shared import claims, numerals, style, tables
from analysis.shared.columns import Floats
from analysis.shared.notes import machine_line
from analysis.shared.report import NO_TIMES, Report
from analysis.shared.results import Results
from analysis.shared.verdicts import RARE, Verdict, never

BLOCK: Final = 5  # neighbouring poses in a block
LOOKS: Final = {
    "ohd_as_printed": style.Look("OHD as printed", "#0072B2", "D"),
    "nohd_as_printed": style.Look("NOHD as printed", "#009E73", "^"),
    "ohd": style.Look("OHD", "#56B4E9", "o"),
    "nohd": style.Look("NOHD", "#999933", "s"),
}
CLAIMS: Final = {
    "ohd_as_printed": ("zhang2017", "ohd_as_printed"),
    "nohd_as_printed": ("zhang2017", "nohd_as_printed"),
    "ohd": ("hausbench", "ohd_exact"),
    "nohd": ("hausbench", "nohd_exact"),
}
PRINTED: Final = {
    "ohd": "ohd_as_printed",
    "nohd": "nohd_as_printed",
}  # the as-printed variant of each corrected solver


def blocks(results: Results, rows: Sequence[int]) -> list[list[int]]:
    """Groups answered rows by scene and by block of BLOCK neighbouring poses.

    Answers at neighbouring poses, or with several seeds at one pose, are alike; blocks count as
    independent.
    """
    by_block: dict[tuple[str, int], list[int]] = {}
    for row in answered(results, rows):
        key = results.cases.scene[row], int(results.cases.pose_index[row]) // BLOCK
        by_block.setdefault(key, []).append(row)
    return list(by_block.values())


def share_interval(results: Results, rows: Sequence[int]) -> tuple[float, float]:
    """Returns the 95 % interval for the share of wrong answers, by a bootstrap over blocks; NaN for
    fewer than two blocks.

    If none or all are wrong, returns the exact interval (Clopper and Pearson 1934) with each block
    as one answer.
    """
    parts = blocks(results, rows)
    counts = np.array([[len(wrong(results, part)), len(part)] for part in parts]).reshape(-1, 2)
    if len(parts) < 2:
        return math.nan, math.nan
    if counts[:, 0].sum() in (0, counts[:, 1].sum()):
        whole = scipy.stats.binomtest(len(parts) if counts[0, 0] else 0, len(parts)).proportion_ci(
            0.95, method="exact"
        )
        return float(whole.low), float(whole.high)

    def share(bad: Floats, of: Floats, axis: int = -1) -> Floats:
        return np.asarray(bad.sum(axis=axis) / of.sum(axis=axis))

    interval = scipy.stats.bootstrap(
        tuple(counts.T.astype(float)),
        share,
        paired=True,
        vectorized=True,
        method="percentile",
        random_state=np.random.default_rng(2017),
    ).confidence_interval
    return float(interval.low), float(interval.high)


def answered(results: Results, rows: Sequence[int]) -> list[int]:
    """Returns the rows with an answer, right or wrong: no timeouts or other failures."""
    return [row for row in rows if results.cases.status[row] in ("ok", "unsound")]


def wrong(results: Results, rows: Sequence[int]) -> list[int]:
    return [row for row in rows if results.cases.status[row] == "unsound"]


def printed_rate(results: Results, label: str) -> float:
    """Returns the share of blocks in which the as-printed variant of a corrected solver is wrong;
    NaN if it never is.

    Uses only scenes, poses and seeds that the corrected solver answered, so that both have the same
    chances to err.
    """

    def question(row: int) -> tuple[str, int, object]:
        return (
            results.cases.scene[row],
            int(results.cases.pose_index[row]),
            results.options(row).get("seed"),
        )

    questions = {question(row) for row in answered(results, results.rows(label=label))}
    rows = [row for row in results.rows(label=PRINTED.get(label, "")) if question(row) in questions]
    parts = blocks(results, rows)
    bad = sum(bool(wrong(results, part)) for part in parts)
    return bad / len(parts) if bad else math.nan


def exactness(results: Results, label: str) -> Verdict:
    """Judges the claim that a solver is never wrong.

    There must be enough trials to exclude the error rate of its as-printed variant, or RARE if that
    is never wrong.
    """
    rows = results.rows(label=label)
    rate = printed_rate(results, label)
    bar, against = (
        (RARE, "")
        if math.isnan(rate)
        else (rate, f"of such trials in which {LOOKS[PRINTED[label]].title} is wrong")
    )
    return never(
        claims.of(*CLAIMS[label]),
        len(wrong(results, rows)),
        len(answered(results, rows)),
        "answers are wrong",
        len(blocks(results, rows)),
        bar,
        against,
    )


def off(results: Results, row: int) -> float:
    """Returns the answer / the true distance; NaN if no certified solver has an answer."""
    low, high = results.reference_of(row)
    if math.isnan(low):
        return math.nan
    return float(results.cases.lower[row]) / (0.5 * (low + high)) if low + high > 0 else math.inf


def direction(results: Results, label: str) -> str:
    """Says how many wrong answers of a solver are too small and how many too large: '3 too small, 1
    too large'."""
    ratios = [off(results, row) for row in wrong(results, results.rows(label=label))]
    too_small = sum(x < 1 for x in ratios)
    too_large = sum(x > 1 for x in ratios)
    parts = [
        f"{count} too {way}" for count, way in ((too_small, "small"), (too_large, "large")) if count
    ]
    return f" (its wrong answers here: {', '.join(parts)})" if parts else " (no wrong answer here)"


def make(results: Results) -> Report:
    scenes = results.scenes
    labels = [label for label in LOOKS if len(results.rows(label=label))]
    table = tables.Table(
        "Wrong answers of the algorithms of Zhang et al. 2017, as printed and as mended.",
        [
            "clouds",
            "solver",
            "poses",
            "seeds",
            "answers",
            "wrong",
            "share wrong, %",
            "95 %",
            "answer / h, worst",
        ],
        left=2,
    )
    records: list[tables.Record] = []
    for scene in scenes:
        table.rules.add(len(table.rows))
        for label in labels:
            rows = results.rows(scene=scene, label=label)
            answers, bad = answered(results, rows), wrong(results, rows)
            seeds = len({results.options(row).get("seed") for row in rows})
            low, high = share_interval(results, rows)
            ratios = [off(results, row) for row in bad]
            worst = max(
                (x for x in ratios if not math.isnan(x)),
                key=lambda x: abs(math.log(x)) if x > 0 else math.inf,
                default=math.nan,
            )
            poses = len({int(results.cases.pose_index[row]) for row in rows})
            table.rows.append(
                [
                    scene,
                    LOOKS[label].title,
                    str(poses),
                    str(seeds),
                    f"{len(answers):,}",
                    str(len(bad)),
                    numerals.number(100 * len(bad) / len(answers)) if answers else numerals.NOTHING,
                    numerals.bounds(low, high, 2, times=100, form="{} to {}"),
                    numerals.number(worst, 4),
                ]
            )
            records += [
                {
                    "scene": scene,
                    "label": label,
                    "pose": int(results.cases.pose_index[row]),
                    "x": float(results.cases.pose[row][9]),
                    "seed": results.options(row).get("seed", ""),
                    "status": results.cases.status[row],
                    "lower": float(results.cases.lower[row]),
                    "true_lower": results.reference_of(row).lower,
                    "true_upper": results.reference_of(row).upper,
                    "why": results.cases.reason[row],
                }
                for row in rows
            ]
    notes = {
        results.cases.scene[row]: results.cases.scene_note[row] for row in range(len(results.cases))
    }
    table.verdicts = [exactness(results, label) for label in labels]
    table.notes = [
        "Wrong: the harness shows that the lower bound is above the distance at its witness, or the upper bound below a certified lower bound of "
        f"NAIVEHDD ('unsound'). Answers at neighbouring poses are alike, so 95 % is from the bootstrap over blocks of {BLOCK} poses, and if no "
        "answer is wrong, from Clopper and Pearson with a block as one trial. A mended solver is not refuted if the blocks rule out a rate as "
        "high as the printed variant's on the same poses and seeds.",
        "As printed: OHD culls points in a cell whose side is the first lower bound (its points may be "
        f"sqrt 3 times that apart){direction(results, 'ohd_as_printed')}; NOHD leaves the loop of Algorithm 5 "
        f"without cmin = 0{direction(results, 'nohd_as_printed')}.",
        "Seeds: of OHD's first sample. NOHD uses no random numbers; its trials are the poses.",
        *[f"{scene}: {notes[scene]}." for scene in scenes],
        f"Here: {machine_line(results)}.",
    ]
    shown = []
    for scene in scenes:
        if any(
            wrong(results, results.rows(scene=scene, label=label)) for label in PRINTED.values()
        ):
            shown.append(scene)
    without = ", ".join(scene for scene in scenes if scene not in shown)
    caption = (
        "Wrong answers of the algorithms of Zhang et al. 2017 as printed, by the shift between the clouds: above, the share of the seeds, in "
        "percent; below, each wrong answer as a multiple of the distance "
        f"h.{f' Not drawn, because no answer is wrong there: {without}.' if without and shown else ''}"
    )
    return Report(
        lambda: draw(results, shown or scenes), table, records, clock=NO_TIMES, caption=caption
    )


def draw(results: Results, scenes: list[str]) -> Any:
    """Draws a column per scene over the shift between the clouds: the share of wrong seeds above,
    the size of errors below."""
    figure, axes = plt.subplots(
        2,
        len(scenes),
        figsize=(style.DOUBLE_COLUMN, 3.0),
        sharex="col",
        sharey="row",
        squeeze=False,
    )
    labels = [label for label in LOOKS if label.endswith("as_printed")]
    for (upper, lower), scene in zip(axes.T, scenes):
        for label in labels:
            rows = results.rows(scene=scene, label=label)
            shifts = sorted({float(results.cases.pose[row][9]) for row in rows})
            shares = []
            for x in shifts:
                here = [row for row in rows if results.cases.pose[row][9] == x]
                answers = answered(results, here)
                shares.append(
                    100 * len(wrong(results, here)) / len(answers) if answers else math.nan
                )
            looks = LOOKS[label]
            upper.plot(shifts, shares, color=looks.colour, linewidth=0.7, drawstyle="steps-mid")
            seen = [(x, share) for x, share in zip(shifts, shares) if share > 0]
            seen_shifts = [x for x, _ in seen]
            seen_shares = [share for _, share in seen]
            upper.plot(
                seen_shifts, seen_shares, **{**style.filled_marker(looks), "markersize": 2.8}
            )
            bad = wrong(results, rows)
            bad_shifts = [results.cases.pose[row][9] for row in bad]
            ratios = [off(results, row) for row in bad]
            lower.plot(bad_shifts, ratios, **{**style.open_marker(looks), "markersize": 3.2})
            lower.margins(y=0.1)
            if len(shifts) > 1:
                room = 0.03 * (shifts[-1] - shifts[0])  # room for whole markers at both ends
                lower.set_xlim(shifts[0] - room, shifts[-1] + room)
        lower.axhline(1, color="#333333", linewidth=0.6)
        upper.set_title(scene)
        upper.set_ylim(-4, 104)
        lower.set_xlabel("shift along x (units of the model)")
        if not any(wrong(results, results.rows(scene=scene, label=label)) for label in labels):
            lower.text(
                0.5,
                0.3,
                "no wrong answers",
                transform=lower.transAxes,
                ha="center",
                fontsize=7,
                color=style.GREY,
            )
        lower.xaxis.set_major_locator(matplotlib.ticker.MaxNLocator(5, prune="both"))
    axes[0][0].set_ylabel("wrong answers (%)")
    axes[1][0].set_ylabel("wrong answer / h")
    style.legend_above(
        figure,
        [
            Line2D([], [], label=LOOKS[label].title, **style.filled_marker(LOOKS[label]))
            for label in labels
        ],
    )
    return figure
