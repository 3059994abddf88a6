"""Figures 10 and 11 of Zhang et al. 2017: one model moves through another, and each pose is timed.

Neighbouring poses are alike, and one process answers all poses of a round, so poses are not
independent. Each round gives one number, the median over the poses of a *regime* (models apart,
touching, overlapping), and intervals are over rounds. Times of randomized solvers are of the first
seed; counted work has one number per seed.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.patches import Rectangle

from analysis.shared import claims, numerals, scales, style, tables
from analysis.shared.cells import MEASURES, in_time_and_work, takes_seed
from analysis.shared.comparable import apart, origins, reason_apart
from analysis.shared.notes import clock_title, clock_word, machine_line
from analysis.shared.report import Report
from analysis.shared.results import Results
from analysis.shared.estimates import (
    NO_DATA,
    Estimate,
    exact,
    median,
    one_draw,
    paired_ratio,
    ratio_by_round,
)
from analysis.shared.verdicts import (
    ERROR,
    FAILS,
    HOLDS,
    OPEN,
    UNTESTED,
    Verdict,
    above_one,
    all_of,
    greatest,
    rising_by_run,
    weighed,
)
from analysis.zhang2017 import motion_picture

CAPTIONS: Final = {
    "zhang2017_fig10": "A torus moved through one of the same shape and size (Fig. 10 of Zhang et al. 2017).",
    "zhang2017_fig11": "A gear moved and turned through one of another shape and size (Fig. 11 of Zhang et al. 2017).",
}
WORK: Final = "distances, bounds and nodes"
THETA: Final = 0.33
REGIMES: Final = (("apart", "boxes apart"), ("touching", "α ≤ 0.33"), ("overlapping", "α > 0.33"))
SHADES: Final = {"apart": "#FFFFFF", "touching": "#F4F4F4", "overlapping": "#E6E6E6"}
COMPARED: Final = (  # claim, regime, slower solver, faster solver
    ("apart", "apart", "earlybreak", "nohd"),
    ("touching", "touching", "ohd", "earlybreak"),
    ("overlapping", "overlapping", "earlybreak", "ohd"),
    ("nohd_overlapping", "overlapping", "nohd", "ohd"),
)
CULLED: Final = (
    ("few_culled", "touching", False),
    ("many_culled", "overlapping", True),
)  # claim, regime, whether more than HALF are culled
HALF: Final = 0.5  # share of A that counts as many points


@dataclass(frozen=True)
class Pose:
    index: int
    shift: float  # along x
    rows: dict[str, int]  # by label; the first of several seeds
    seeds: dict[str, list[int]]  # by label: the rows of all seeds, in order
    regime: str
    distance: float


class Motion:
    """One scene, with its poses in order and the time to solve each, by round."""

    def __init__(self, results: Results, scene: str) -> None:
        cases = results.cases
        self.results, self.scene = results, scene
        by_pose: dict[int, dict[str, list[int]]] = {}
        for row in sorted(
            results.rows(scene=scene), key=lambda row: int(results.options(row).get("seed", 0))
        ):
            by_pose.setdefault(int(cases.pose_index[row]), {}).setdefault(
                cases.label[row], []
            ).append(row)
        self.poses = []
        for index, seeds in sorted(by_pose.items()):
            rows = {label: seed_rows[0] for label, seed_rows in seeds.items()}
            first = next(iter(rows.values()))
            self.poses.append(
                Pose(
                    index,
                    float(cases.pose[first][9]),
                    rows,
                    seeds,
                    _regime(results, rows),
                    results.middle(first),
                )
            )
        first = results.rows(scene=scene)[0]
        self.sizes = results.sizes(first)
        self.labels = style.order(
            (cases.solver[row], cases.label[row]) for row in results.rows(scene=scene)
        )

    def rounds(self, pose: Pose, label: str) -> dict[int, float]:
        row = pose.rows.get(label)
        return (
            {}
            if row is None or self.results.cases.status[row] != "ok"
            else self.results.solve_by_round(row)
        )

    def time(self, pose: Pose, label: str) -> Estimate:
        return median(list(self.rounds(pose, label).values()))

    def work(self, pose: Pose, label: str, measure: str) -> float:
        """Returns the counted work of the first seed; NaN without an answer or a count."""
        return next(iter(self.work_by_seed(pose, label, measure)), math.nan) or math.nan

    def work_by_seed(self, pose: Pose, label: str, measure: str) -> list[float]:
        """Returns the counted work of each seed. Empty if a seed has no answer, because only slow
        ones would be missing."""
        rows, counters = pose.seeds.get(label, []), self.results.cases.counters
        if any(self.results.cases.status[row] != "ok" for row in rows):
            return []
        columns = [counters[name] for name in MEASURES[measure] if name in counters]
        counts = []
        for row in rows:
            counts.append(float(sum(int(column[row]) for column in columns)))
        return counts

    def work_ratio(
        self,
        poses: Sequence[tuple[Pose, Pose]],
        slow: str,
        fast: str,
        measure: str,
        chosen: bool = False,
    ) -> Estimate:
        """Returns the median over pairs of poses of the ratio of counted work, exact for
        deterministic solvers, else over seeds.

        `chosen` leaves out the first seed, by whose counts the caller chose the poses.
        """
        counted = [
            (a, b)
            for p, q in poses
            if (a := self.work_by_seed(p, slow, measure))
            and (b := self.work_by_seed(q, fast, measure))
            and min(a + b) > 0
        ]
        if not counted:
            return NO_DATA
        seeds = min((len(x) for pair in counted for x in pair if len(x) > 1), default=1)
        ratios = []
        for i in range(seeds):
            ratios.append(float(np.median([a[i % len(a)] / b[i % len(b)] for a, b in counted])))
        alone = [
            p.rows[label]
            for pair in poses
            for p, label in zip(pair, (slow, fast))
            if len(p.seeds.get(label, [])) == 1
        ]
        if any(takes_seed(self.results, row) for row in alone):
            return one_draw(ratios[0])
        used = ratios[1 if chosen else 0 :]
        return paired_ratio(used, [1.0] * len(used)) if seeds > 1 else exact(ratios[0])

    def times(self, regime: str, *labels: str) -> list[tuple[float, ...]]:
        """Returns the times of these solvers at each pose of the regime at which all were timed."""
        timed = []
        for pose in self.poses:
            if pose.regime == regime:
                times = [self.time(pose, label) for label in labels]
                if all(time.n for time in times):
                    timed.append(tuple(time.value for time in times))
        return timed

    def ratio(self, regime: str, slow: str, fast: str, measure: str = "") -> Estimate:
        """Returns the median ratio of times over the poses of a regime, with an interval over
        rounds.

        With `measure`, returns the ratio of counted work, which differs between seeds, not rounds.
        """
        poses = [pose for pose in self.poses if pose.regime == regime]
        if measure:
            return self.work_ratio([(p, p) for p in poses], slow, fast, measure)
        both = [p for p in poses if self.rounds(p, slow) and self.rounds(p, fast)]
        lacking = [apart(origins(self.results, (p.rows[slow], p.rows[fast]))) for p in both]
        pairs = [
            (self.rounds(p, slow), self.rounds(p, fast))
            for p, lacks in zip(both, lacking)
            if not lacks
        ]
        if both and not pairs:
            return next(lacks for lacks in lacking if lacks)
        shared = set.intersection(*[a.keys() & b.keys() for a, b in pairs]) if pairs else set[int]()
        medians = []
        for i in sorted(shared):
            logarithms = [math.log(a[i] / b[i]) for a, b in pairs]
            medians.append(math.exp(float(np.median(logarithms))))
        return paired_ratio(medians, [1.0] * len(medians))

    def verdicts(self) -> list[Verdict]:
        present = {label for pose in self.poses for label in pose.rows}
        labels = [label for label in ("earlybreak", "adaptive") if label in present]
        judged = [judge(label) for judge in (self.peak, self.nearer) for label in labels]
        for name, regime, slow, fast in COMPARED:
            claim = claims.of("zhang2017", name, self.scene)
            times = self.times(regime, slow, fast)
            slower = sum(a > b for a, b in times)
            longest_slow = max((a for a, _ in times), default=math.nan)
            longest_fast = max((b for _, b in times), default=math.nan)
            evidence = (
                f"at {slower} of {len(times)} poses; longest "
                f"{numerals.number(1000 * longest_fast)} against "
                f"{numerals.number(1000 * longest_slow)} ms; median of "
                f"{style.title(slow)} / {style.title(fast)}"
            )
            titles = f"median of {style.title(slow)} / {style.title(fast)}"
            counted = {
                measure: above_one(claim, self.ratio(regime, slow, fast, measure), titles)
                for measure in MEASURES
            }
            judged.append(
                above_one(claim, self.ratio(regime, slow, fast), evidence).with_counts(counted)
            )
        judged += [self.culled(name, regime, more) for name, regime, more in CULLED]
        return judged + self.worst_case()

    def nearer(self, label: str) -> Verdict:
        """Judges the claim that nearer poses take longer, by a correlation per round; for counted
        work, per seed."""
        claim = claims.of("zhang2017", "nearer", self.scene, solver=style.title(label))
        timed = [p for p in self.poses if self.time(p, label).n and math.isfinite(p.distance)]
        x = [-p.distance for p in timed]

        def judge(measure: str) -> Verdict:
            if measure:
                counts = [self.work_by_seed(p, label, measure) for p in timed]
                return rising_by_run(claim, [(x, list(by_pose)) for by_pose in zip(*counts)])
            if why := reason_apart(origins(self.results, [p.rows[label] for p in timed])):
                return Verdict(claim, UNTESTED, f"times {why}")
            times = [self.rounds(p, label) for p in timed]
            shared = (
                sorted(set.intersection(*(set(by_round) for by_round in times))) if times else []
            )
            runs = []
            for number in shared:
                runs.append((x, [by_round[number] for by_round in times]))
            return rising_by_run(claim, runs)

        return in_time_and_work(judge)

    def culled(self, name: str, regime: str, more: bool) -> Verdict:
        """Judges the claim that OHD culls more (or less) than HALF of A: median over the poses of a
        regime, per seed."""
        claim = claims.of("zhang2017", name, self.scene)
        cases = self.results.cases
        complete = []  # by pose, then by seed
        for pose in self.poses:
            if pose.regime == regime:
                shares = [
                    self.results.extras(row).get("culled", math.nan)
                    / int(cases.source_elements[row])
                    if cases.status[row] == "ok"
                    else math.nan
                    for row in pose.seeds.get("ohd", [])
                ]
                if shares and all(map(math.isfinite, shares)):
                    complete.append(shares)
        share = median([float(np.median(by_pose)) for by_pose in zip(*complete)])
        if not share.n:
            return Verdict(claim, UNTESTED, "no pose says how many points were culled")
        sure = share.has_interval and share.coverage >= 1 - ERROR
        above, below = sure and share.low > HALF, sure and share.high < HALF
        outcome = (
            HOLDS if (above if more else below) else FAILS if (below if more else above) else OPEN
        )
        return weighed(
            Verdict(
                claim,
                outcome,
                f"{numerals.estimate(share, 100, limit=100 * HALF)} % of A, at {len(complete)} poses, over n = {share.n} seeds",
            ),
            [share],
        )

    def worst_case(self) -> list[Verdict]:
        """Judges the claim that EARLYBREAK computes |A| * |B| distances if the distance is 0, for
        every seed and such pose.

        Empty if there are no such poses.
        """
        poses, cases = [p for p in self.poses if p.distance == 0], self.results.cases
        counts = [count for p in poses for count in self.work_by_seed(p, "earlybreak", "distances")]
        pairs = [
            int(cases.source_elements[row]) * int(cases.target_elements[row])
            for p in poses
            for row in p.rows.values()
        ]
        claim = claims.of("zhang2017", "worst_case", self.scene)
        return (
            [
                all_of(
                    claim,
                    sum(count != pairs[0] for count in counts),
                    len(counts),
                    len(counts),
                    "runs, each with a seed of its own",
                )
            ]
            if poses
            else []
        )

    def peak(self, label: str) -> Verdict:
        """Judges the claim that the time is greatest where the models overlap most, which is at the
        least distance.

        The pose there, and the pose elsewhere that may refute the claim, are chosen by counted
        work, because choosing by the times that are then compared would err too often. For the same
        reason, if counts are compared, the first seed chooses and only the other seeds are
        compared.
        """
        claim = claims.of("zhang2017", "peak", self.scene, solver=style.title(label))
        timed = [p for p in self.poses if self.time(p, label).n]
        if len(timed) < 3 or not all(math.isfinite(p.distance) for p in timed):
            return Verdict(claim, UNTESTED, "fewer than three poses")
        nearest = min(timed, key=lambda p: p.distance)
        least = [i for i, p in enumerate(timed) if p.distance <= nearest.distance]
        # The motion is sampled, so poses next to the nearest ones count as the same place.
        near = []
        for i, p in enumerate(timed):
            if min(abs(i - k) for k in least) <= 1:
                near.append(p)
        far = [p for p in timed if p not in near]

        def verdict(measure: str) -> Verdict:
            top = max(
                timed,
                key=lambda p: self.work(p, label, measure)
                if measure
                else self.time(p, label).value,
            )
            text = f"greatest at x = {top.shift:.3g}, least distance at x = {nearest.shift:.3g}"
            here, rival = (
                max(poses, key=lambda p: self.work(p, label, measure or WORK))
                for poses in (near, far)
            )
            return greatest(
                claim, [ratio(here, p, measure) for p in far], ratio(here, rival, measure), text
            )

        def ratio(a: Pose, b: Pose, measure: str) -> Estimate:
            if measure:
                return self.work_ratio([(a, b)], label, label, measure, chosen=True)
            return apart(origins(self.results, (a.rows[label], b.rows[label]))) or ratio_by_round(
                self.rounds(a, label), self.rounds(b, label)
            )

        if not far or not all(
            math.isfinite(self.work(p, label, measure)) for p in timed for measure in MEASURES
        ):
            return Verdict(claim, UNTESTED, "no pose far from there, or nothing counted")
        return in_time_and_work(verdict)

    def reuse(self) -> list[str]:
        """Returns notes on structures that were not built again, by reason: 'built once ...: saved
        NOHD 12.3 ms, OHD 13.1 ms'."""
        ledger, by_reason = self.results.ledger, dict[str, dict[str, str]]()
        for subject, part, reason, seconds in zip(
            ledger.subject, ledger.what, ledger.reason, ledger.seconds_saved
        ):
            solver = next(
                (
                    pair
                    for pair in self.labels
                    if subject.endswith(f" on {self.scene}")
                    and subject.removesuffix(f" on {self.scene}").split("(")[0] == pair[1]
                ),
                None,
            )
            if solver and part == "structures for each pose":
                by_reason.setdefault(str(reason), {}).setdefault(
                    style.title(*solver), f"{numerals.number(1000 * seconds)} ms"
                )
        notes = []
        for reason, savings in by_reason.items():
            listed = ", ".join(f"{title} {saved}" for title, saved in savings.items())
            notes.append(f"{reason}: saved {listed}")
        return notes


def _regime(results: Results, rows: dict[str, int]) -> str:
    """Returns the regime of a pose, by the overlap `alpha` that solver `adaptive` reports."""
    told = results.extras(rows["adaptive"]) if "adaptive" in rows else {}
    if "alpha" not in told:
        return "unknown"
    return "apart" if told["alpha"] < 0 else "touching" if told["alpha"] <= THETA else "overlapping"


def make(results: Results) -> Report:
    caption = CAPTIONS[results.stem]
    motions = [Motion(results, scene) for scene in results.scenes]
    labels = style.order(pair for motion in motions for pair in motion.labels)
    clock = clock_word(results)
    ratio_titles = [
        f"EARLYBREAK / {title}{measure and ', '}{measure}"
        for title in ("NOHD", "OHD")
        for measure in ("", *MEASURES)
    ]
    table = tables.Table(
        f"{caption} {clock_title(results)} to solve a pose, µs: median over the poses of each kind.",
        ["models", "|A| / |B|", "poses", *[style.title(*pair) for pair in labels], *ratio_titles],
        left=2,
    )
    records: list[tables.Record] = []
    for motion in motions:
        table.rules.add(len(table.rows))
        for regime, title in REGIMES:
            poses = [pose for pose in motion.poses if pose.regime == regime]
            if not poses:
                continue
            cells = []
            for _, label in labels:
                times = [motion.time(p, label) for p in poses if label in p.rows]
                failed = sum(not t.n for t in times)
                values = [t.value for t in times if t.n]
                text = (
                    numerals.number(1e6 * float(np.median(values))) if values else numerals.NOTHING
                )
                cells.append(text + (f" ({failed} failed)" if failed else ""))
            table.rows.append(
                [
                    f"{motion.scene}, {title}",
                    motion.sizes,
                    str(len(poses)),
                    *cells,
                    *[
                        numerals.ratio(motion.ratio(regime, "earlybreak", label, measure))
                        for label in ("nohd", "ohd")
                        for measure in ("", *MEASURES)
                    ],
                ]
            )
        for pose in motion.poses:
            for _, label in labels:
                if label in pose.rows:
                    row, t = pose.rows[label], motion.time(pose, label)
                    records.append(
                        {
                            "scene": motion.scene,
                            "pose": pose.index,
                            "x": pose.shift,
                            "regime": pose.regime,
                            "label": label,
                            "status": results.cases.status[row],
                            **tables.seconds(t),
                            "prepare_seconds": results.prepare_seconds(row),
                            "distance": pose.distance,
                            **results.extras(row),
                            **results.facts(row),
                        }
                    )
    reused = [
        f"{motion.scene}: {'; '.join(motion.reuse())}." for motion in motions if motion.reuse()
    ]
    counts = sorted(
        {motion.time(p, label).n for motion in motions for p in motion.poses for label in p.rows}
        - {0}
    )
    table.verdicts = [verdict for motion in motions for verdict in motion.verdicts()]
    table.notes = [
        "A ratio is the median over the poses of a kind, one number per round (a fresh process that answers all poses); brackets: over n = "
        f"{' or '.join(map(str, counts))} rounds (at least 95 % from six on). Counted work is exact, or one number per seed: one seed (n = 1) "
        "separates nothing. Times, and the poses of the peak (by counted work), are those of the first seed. α: overlap of the boxes, as a "
        "fraction of the smaller one.",
        "Structures are built once in A's frame and serve every pose; building them is "
        "not in these times. " + (" ".join(reused) or "The time that this saved was not recorded."),
        f"Here: {machine_line(results)}.",
    ]
    return Report(
        lambda: draw(motions, labels, reused, clock),
        table,
        records,
        caption=figure_caption(caption, motions, clock),
    )


def figure_caption(caption: str, motions: list[Motion], clock: str) -> str:
    """Returns the caption with an explanation of each row of panels."""
    notes = {
        motion.scene: str(
            motion.results.cases.scene_note[motion.results.rows(scene=motion.scene)[0]]
        )
        for motion in motions
    }
    shapes = "; ".join(f"{scene}: {note}" for scene, note in notes.items() if note)
    return (
        f"{caption} Top: the outline of B, and A at {motion_picture.POSES} of its poses, the first the lightest. Middle: {clock} to solve a pose, in seconds; a line is the "
        "median over the rounds, and its band the interval of the median (markers: every fourth pose). Bottom: the distance. The background shows how much the "
        f"boxes of A and B overlap: α is the overlap as a fraction of the smaller box.{f' Models: {shapes}.' if shapes else ''}"
    )


def draw(
    motions: list[Motion], labels: list[tuple[str, str]], reused: list[str], clock: str
) -> Any:
    """Draws a column per scene: models, times, distance. The background is grey where the boxes of
    A and B overlap."""
    figure, axes = plt.subplots(
        3,
        len(motions),
        figsize=(style.DOUBLE_COLUMN, 4.7),
        squeeze=False,
        height_ratios=(1, 2.4, 1),
    )
    for (top, upper, lower), motion in zip(axes.T, motions):
        motion_picture.draw(
            top, motion.results, [next(iter(pose.rows.values())) for pose in motion.poses]
        )
        upper.sharex(lower)
        upper.tick_params(labelbottom=False)
        shifts = [pose.shift for pose in motion.poses]
        edges = [shifts[0], *[(a + b) / 2 for a, b in zip(shifts, shifts[1:])], shifts[-1]]
        for pose, left, right in zip(motion.poses, edges, edges[1:]):
            for ax in (upper, lower):
                ax.axvspan(
                    left, right, color=SHADES.get(pose.regime, "#FFFFFF"), linewidth=0, zorder=0
                )
        marks = []
        for solver, label in labels:
            looks = style.look(solver, label)
            timed = [
                (pose.shift, motion.time(pose, label))
                for pose in motion.poses
                if motion.time(pose, label).n
            ]
            if timed:
                x = [shift for shift, _ in timed]
                upper.plot(
                    x,
                    [t.value for _, t in timed],
                    color=looks.colour,
                    linestyle=looks.line,
                    linewidth=0.7,
                )
                low = [t.low for _, t in timed]
                high = [t.high for _, t in timed]
                upper.fill_between(x, low, high, color=looks.colour, alpha=0.25, linewidth=0)
                upper.plot(x[::4], [t.value for _, t in timed][::4], **style.filled_marker(looks))
            failed = {
                str(motion.results.cases.status[pose.rows[label]])
                for pose in motion.poses
                if label in pose.rows and not motion.time(pose, label).n
            }
            marks += [(looks, style.status_letter(status)) for status in sorted(failed)]
        style.margin_marks(upper, marks, 120)
        top.set_title(f"{motion.scene}, {motion.sizes} points")
        upper.set(yscale="log")
        scales.log_ticks(upper.yaxis)
        lower.plot(shifts, [pose.distance for pose in motion.poses], color="black", linewidth=0.8)
        lower.set(xlabel="shift along x (units of the model)", ylim=(0, None))
    axes[1][0].set_ylabel(f"{clock} to solve a pose (s)")
    axes[2][0].set_ylabel("h(A, B)\n(units of the model)")
    entries = style.handles(labels) + [
        Rectangle(
            (0, 0), 1, 1, facecolor=SHADES[regime], edgecolor="#999999", linewidth=0.4, label=title
        )
        for regime, title in REGIMES
    ]
    style.legend_above(figure, entries, columns=4)
    if reused:
        figure.supxlabel(
            "Structures are built once and used for all poses; the times do not include that.",
            fontsize=7,
        )
    return figure
