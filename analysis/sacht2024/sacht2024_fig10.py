"""Fig. 10 of Sacht and Jacobson 2024: which order of their four upper bounds is fastest, on meshes
and their remeshings."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any, Final

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.artist import Artist
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle

from analysis.shared import claims, numerals, style, tables
from analysis.shared.cells import MEASURES, Cell, in_time_and_work
from analysis.shared.comparable import reason_apart
from analysis.shared.notes import clock_word, machine_line
from analysis.shared.over_pairs import Wins, share_near, shared_wins, wins_more
from analysis.shared.report import Report
from analysis.shared.results import Results
from analysis.shared.verdicts import UNTESTED, Verdict

# The orders in the paper's figure: the seven worst, two in between, the ten best. "213" computes
# u2, then u1, then u3.
DRAWN: Final = (
    "1",
    "2",
    "21",
    "12",
    "41",
    "4",
    "412",
    "3",
    "3241",
    "23",
    "1243",
    "231",
    "213",
    "123",
    "2341",
    "2314",
    "234",
    "2134",
    "1234",
)
SINGLE: Final = ("1", "2", "3", "4")
TEN_BEST: Final = DRAWN[-10:]
BEST, SOLVED = "1234", 0.753
WITHOUT_U3: Final = "#4D4D4D"  # darker than the other bars, also in grey
WITHIN = 0.1  # allowed difference to the paper in the share of solved pairs
NEVER_RAN = ("skipped", "failed", "not_built")


class Orders:
    """The cost of each order on each pair. As in the paper, pairs that no order solved are left out
    of the wins."""

    def __init__(self, results: Results) -> None:
        self.results, cases = results, results.cases
        rows: dict[str, dict[str, int]] = {}
        self.lost: dict[str, str] = {}  # pairs whose model is missing, and why
        for row in range(len(cases)):
            scene = cases.scene[row]
            if cases.status[row] in NEVER_RAN:
                self.lost[scene] = cases.reason[row] or cases.status[row]
            else:
                rows.setdefault(str(results.options(row).get("order", BEST)), {})[scene] = row
        self.scenes = [s for s in map(str, results.scenes) if s not in self.lost]
        printed = [order for order in DRAWN if order in rows]
        self.orders = [
            *sorted(rows.keys() - set(printed), key=lambda order: (len(order), order)),
            *printed,
        ]
        self.cells = {
            (order, scene): Cell(results, [row])
            for order, of in rows.items()
            for scene, row in of.items()
        }
        self.solved = []
        for scene in self.scenes:
            if any(self.ends(order, scene) for order in self.orders):
                self.solved.append(scene)
        self.apart = next((why for scene in self.solved if (why := self.reason_apart(scene))), "")
        self.wins = {measure: self.shared(self.orders, measure) for measure in ("", *MEASURES)}

    def ends(self, order: str, scene: str) -> bool:
        cell = self.cells.get((order, scene))
        return cell is not None and not cell.failures

    def reason_apart(self, scene: str) -> str:
        """Returns why the times of this pair are not comparable; empty if they are."""
        return reason_apart(
            origin for (_, of), cell in self.cells.items() if of == scene for origin in cell.origins
        )

    def cost(self, order: str, scene: str, measure: str) -> float:
        """Returns the time, or the count MEASURES[measure]; NaN if the tolerance was not reached or
        times are not comparable."""
        cell = self.cells.get((order, scene))
        return np.nan if cell is None or (not measure and self.apart) else cell.cost(measure)

    def shared(self, orders: Iterable[str], measure: str) -> dict[str, Wins]:
        """Returns the wins of these orders among the pairs that some order solved."""
        costs = {}
        for order in orders:
            if order in self.orders:
                costs[order] = [self.cost(order, scene, measure) for scene in self.solved]
        return shared_wins(costs)

    def stopped(self, order: str, status: str) -> int:
        return sum(cell.failures[status] for (o, _), cell in self.cells.items() if o == order)

    def count(self, order: str, measure: str = "") -> int:
        return int(self.wins[measure][order].sum())

    def percent(self, order: str, measure: str = "") -> float:
        return 100 * self.count(order, measure) / len(self.solved) if self.solved else np.nan

    def of(self, orders: Iterable[str], measure: str) -> dict[str, Wins]:
        return (
            {order: self.wins[measure][order] for order in orders if order in self.wins[measure]}
            if self.solved
            else {}
        )


def verdicts(orders: Orders) -> list[Verdict]:
    """Judges all claims in time and in counted work, except the share of solved pairs."""

    def more(claim: str, ahead: Iterable[str], behind: Iterable[str]) -> Verdict:
        ahead, behind = list(ahead), list(behind)
        return judged(
            claim,
            lambda measure: wins_more(claim, orders.of(ahead, measure), orders.of(behind, measure)),
        )

    def alone(claim: str, ahead: list[str], behind: list[str]) -> Verdict:
        def judge(measure: str) -> Verdict:
            wins = orders.shared(SINGLE, measure)
            better = {order: wins[order] for order in ahead if order in wins}
            worse = {order: wins[order] for order in behind if order in wins}
            return wins_more(claim, better, worse)

        return judged(claim, judge)

    def judged(claim: str, judge: Callable[[str], Verdict]) -> Verdict:
        return in_time_and_work(
            lambda measure: Verdict(claim, UNTESTED, f"times {orders.apart}")
            if orders.apart and not measure
            else judge(measure)
        )

    with_u3 = [order for order in orders.orders if "3" in order]
    not_best = [order for order in orders.orders if order != BEST]
    not_ten_best = [order for order in orders.orders if order not in TEN_BEST]
    return [
        more(claims.of("sacht2024", "best_order"), [BEST], not_best),
        more(claims.of("sacht2024", "worst_orders"), with_u3, ["1", "2", "4"]),
        alone(claims.of("sacht2024", "best_single"), ["3"], ["1", "2", "4"]),
        share_near(
            claims.of("sacht2024", "solved"), len(orders.solved), len(orders.scenes), SOLVED, WITHIN
        ),
        more(claims.of("sacht2024", "ten_best"), TEN_BEST, not_ten_best),
        more(claims.of("sacht2024", "cascade"), [BEST], SINGLE),
    ]


def make(results: Results) -> Report:
    orders = Orders(results)
    word = clock_word(results)
    table = tables.Table(
        "Shared wins of the orders of u1 to u4: pairs on which an order takes at most 105 % of the minimum, among those that some order solves "
        f"({len(orders.solved)} of {len(orders.scenes)}); A is a mesh and B the same mesh remeshed, as in Fig. 10 of Sacht and Jacobson 2024.",
        [
            "order",
            "solves, %",
            "m spent",
            "at the limit",
            f"wins in {word}, %",
            *[f"in {measure}, %" for measure in MEASURES],
            "in the paper",
        ],
    )
    ranked = sorted(
        orders.orders,
        key=lambda order: (-orders.count(order), -orders.count(order, list(MEASURES)[-1])),
    )
    for order in ranked:
        ended = sum(orders.ends(order, scene) for scene in orders.solved)
        table.rows.append(
            [
                order,
                numerals.number(100 * ended / len(orders.solved))
                if orders.solved
                else numerals.NOTHING,
                str(orders.stopped(order, "budget")),
                str(orders.stopped(order, "timeout")),
                *[numerals.number(orders.percent(order, measure)) for measure in ("", *MEASURES)],
                place(order),
            ]
        )
    limits = sorted({float(x) for x in results.cases.case_seconds_limit})
    table.verdicts = verdicts(orders)
    table.notes = [
        f"{len(orders.orders)} of 64 orders were run; the paper draws 19. An order may make 1000 pieces per triangle of A and has "
        f"{' or '.join(f'{x:g}' for x in limits)} s; the gap is 1e-8 of the diagonal of A.",
        "Meshes of Debian and npm packages (datasets/corpus.toml) stand in for Thingi10K, and CGAL's isotropic remeshing, with edges of "
        "1 % of the diagonal, for TetWild.",
        "Time covers preparing and the first answer, with one round (n = 1) per case. If times differ by less than the noise, a win is shared or "
        "lost by chance; counted work has no noise.",
        *lost_note(orders),
        f"Here: {machine_line(results)}.",
    ]
    records: list[tables.Record] = []
    for (order, scene), cell in orders.cells.items():
        wins = {
            f"wins: {measure or 'time'}": int(
                orders.wins[measure][order][orders.solved.index(scene)]
            )
            if scene in orders.solved
            else 0
            for measure in ("", *MEASURES)
        }
        records.append(
            {
                "scene": scene,
                "order": order,
                "status": cell.status(),
                "n": cell.time.n,
                "seconds": cell.time.value,
                **wins,
                **cell.counters,
            }
        )
    records += [{"scene": scene, "status": why} for scene, why in orders.lost.items()]
    return Report(lambda: draw(orders), table, records)


def place(order: str) -> str:
    """Returns the place of an order in the paper's figure, or a dash if it is not shown there."""
    if order not in DRAWN:
        return numerals.NOTHING
    at = DRAWN.index(order)
    return (
        "among the 7 worst"
        if at < 7
        else "in between"
        if at < 9
        else "best"
        if order == BEST
        else "among the 10 best"
    )


def lost_note(orders: Orders) -> list[str]:
    if not orders.lost:
        return []
    scene, why = next(iter(orders.lost.items()))
    return [f"{len(orders.lost)} pairs have no rows with an answer ({scene}: {why})."]


def draw(orders: Orders) -> Any:
    """Draws the shared wins, in time and in counted work, of the orders that the paper shows and of
    the best order here."""
    work = list(MEASURES)[-1]
    drawn = [order for order in DRAWN if order in orders.orders]
    for measure in ("", work):
        most = max((orders.count(order, measure) for order in drawn), default=-1)
        best = max(orders.orders, key=lambda order: orders.count(order, measure), default="")
        if best and best not in drawn and orders.count(best, measure) > most:
            drawn.append(best)
    figure, axes = plt.subplots(2, 1, sharex=True, sharey=True, figsize=(style.DOUBLE_COLUMN, 3.4))
    x = np.arange(len(drawn))
    colours = ["#E69F00" if "3" in order else WITHOUT_U3 for order in drawn]
    ended = []
    for order in drawn:
        count = sum(orders.ends(order, scene) for scene in orders.solved)
        ended.append(100 * count / max(1, len(orders.solved)))
    for ax, measure, name in zip(axes, ("", work), (clock_word(orders.results), work)):
        ax.bar(x, ended, width=0.78, facecolor="none", edgecolor=style.GREY, linewidth=0.6)
        ax.bar(
            x,
            [orders.percent(order, measure) if orders.solved else 0.0 for order in drawn],
            width=0.78,
            color=colours,
            zorder=2,
        )
        for i, order in enumerate(drawn):
            ax.text(
                i,
                (orders.percent(order, measure) if orders.solved else 0.0) + 1.5,
                numerals.number(orders.percent(order, measure), 2),
                ha="center",
                fontsize=6,
                color="#333333",
                zorder=3,
            )
        ax.set_ylim(0, 108)
        ax.set_ylabel(f"pairs (%), n = {len(orders.solved)}")
        ax.set_title(f"shared wins in {name}", fontsize=8)
        ax.grid(False, axis="x")
        for edge in (7, 9, len(DRAWN)):  # the paper's worst, the two in between, its best, ours
            if edge < len(drawn) and drawn[: len(DRAWN)] == list(DRAWN):
                ax.axvline(edge - 0.5, color=style.GREY, linewidth=0.6, linestyle=(0, (2, 2)))
    axes[1].set_xticks(x, drawn)
    axes[1].tick_params(axis="x", length=0)
    axes[1].set_xlim(-0.6, len(drawn) - 0.4)
    more = len(drawn) - sum(order in DRAWN for order in drawn)
    axes[1].set_xlabel(
        "order of the bounds, from the paper's worst (left) to its best"
        + ("; then the best here" if more > 0 else "")
    )
    entries: list[Artist] = [
        Rectangle((0, 0), 1, 1, color="#E69F00", label="wins, an order with u3"),
        Rectangle((0, 0), 1, 1, color=WITHOUT_U3, label="wins, one without u3"),
        Rectangle(
            (0, 0), 1, 1, facecolor="none", edgecolor=style.GREY, linewidth=0.6, label="solved"
        ),
    ]
    if drawn[: len(DRAWN)] == list(DRAWN):
        entries.append(
            Line2D(
                [],
                [],
                color=style.GREY,
                linewidth=0.6,
                linestyle=(0, (2, 2)),
                label="between the paper's worst, middle and best",
            )
        )
    style.legend_above(figure, entries, columns=4)
    return figure
