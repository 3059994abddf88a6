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
        known = [order for order in DRAWN if order in rows]
        self.orders = [
            *sorted(rows.keys() - set(known), key=lambda order: (len(order), order)),
            *known,
        ]
        self.cells = {
            (order, scene): Cell(results, [row])
            for order, of in rows.items()
            for scene, row in of.items()
        }
        self.solved = [
            scene for scene in self.scenes if any(self.ends(order, scene) for order in self.orders)
        ]
        self.apart = next((why for scene in self.solved if (why := self.reason_apart(scene))), "")
        self.wins = {what: self.shared(self.orders, what) for what in ("", *MEASURES)}

    def ends(self, order: str, scene: str) -> bool:
        cell = self.cells.get((order, scene))
        return cell is not None and not cell.failures

    def reason_apart(self, scene: str) -> str:
        """Returns why the times of this pair are not comparable; empty if they are."""
        return reason_apart(
            one for (_, of), cell in self.cells.items() if of == scene for one in cell.origins
        )

    def cost(self, order: str, scene: str, what: str) -> float:
        """Returns the time, or the count MEASURES[what]; NaN if the tolerance was not reached or
        times are not comparable."""
        cell = self.cells.get((order, scene))
        return np.nan if cell is None or (not what and self.apart) else cell.cost(what)

    def shared(self, orders: Iterable[str], what: str) -> dict[str, Wins]:
        """Returns the wins of these orders among the pairs that some order solved."""
        return shared_wins(
            {
                order: [self.cost(order, scene, what) for scene in self.solved]
                for order in orders
                if order in self.orders
            }
        )

    def stopped(self, order: str, status: str) -> int:
        return sum(cell.failures[status] for (o, _), cell in self.cells.items() if o == order)

    def count(self, order: str, what: str = "") -> int:
        return int(self.wins[what][order].sum())

    def percent(self, order: str, what: str = "") -> float:
        return 100 * self.count(order, what) / len(self.solved) if self.solved else np.nan

    def of(self, orders: Iterable[str], what: str) -> dict[str, Wins]:
        return (
            {order: self.wins[what][order] for order in orders if order in self.wins[what]}
            if self.solved
            else {}
        )


def verdicts(found: Orders) -> list[Verdict]:
    """Judges all claims in time and in counted work, except the share of solved pairs."""

    def more(claim: str, ahead: Iterable[str], behind: Iterable[str]) -> Verdict:
        ahead, behind = list(ahead), list(behind)
        return judged(
            claim, lambda what: wins_more(claim, found.of(ahead, what), found.of(behind, what))
        )

    def alone(claim: str, ahead: list[str], behind: list[str]) -> Verdict:
        def judge(what: str) -> Verdict:
            wins = found.shared(SINGLE, what)
            better, worse = (
                {order: wins[order] for order in orders if order in wins}
                for orders in (ahead, behind)
            )
            return wins_more(claim, better, worse)

        return judged(claim, judge)

    def judged(claim: str, judge: Callable[[str], Verdict]) -> Verdict:
        return in_time_and_work(
            lambda what: Verdict(claim, UNTESTED, f"times {found.apart}")
            if found.apart and not what
            else judge(what)
        )

    with_u3 = [order for order in found.orders if "3" in order]
    return [
        more(
            claims.of("sacht2024", "best_order"),
            [BEST],
            [order for order in found.orders if order != BEST],
        ),
        more(claims.of("sacht2024", "worst_orders"), with_u3, ["1", "2", "4"]),
        alone(claims.of("sacht2024", "best_single"), ["3"], ["1", "2", "4"]),
        share_near(
            claims.of("sacht2024", "solved"), len(found.solved), len(found.scenes), SOLVED, WITHIN
        ),
        more(
            claims.of("sacht2024", "ten_best"),
            TEN_BEST,
            [order for order in found.orders if order not in TEN_BEST],
        ),
        more(claims.of("sacht2024", "cascade"), [BEST], SINGLE),
    ]


def make(results: Results) -> Report:
    found = Orders(results)
    word = clock_word(results)
    table = tables.Table(
        "Shared wins of the orders of u1 to u4: pairs on which an order takes at most 105 % of the minimum, among those that some order solves "
        f"({len(found.solved)} of {len(found.scenes)}); A is a mesh and B the same mesh remeshed, as in Fig. 10 of Sacht and Jacobson 2024.",
        [
            "order",
            "solves, %",
            "m spent",
            "at the limit",
            f"wins in {word}, %",
            *[f"in {what}, %" for what in MEASURES],
            "in the paper",
        ],
    )
    ranked = sorted(
        found.orders,
        key=lambda order: (-found.count(order), -found.count(order, list(MEASURES)[-1])),
    )
    for order in ranked:
        ended = sum(found.ends(order, scene) for scene in found.solved)
        table.rows.append(
            [
                order,
                numerals.number(100 * ended / len(found.solved))
                if found.solved
                else numerals.NOTHING,
                str(found.stopped(order, "budget")),
                str(found.stopped(order, "timeout")),
                *[numerals.number(found.percent(order, what)) for what in ("", *MEASURES)],
                place(order),
            ]
        )
    limits = sorted({float(x) for x in results.cases.case_seconds_limit})
    table.verdicts = verdicts(found)
    table.notes = [
        f"{len(found.orders)} of 64 orders were run; the paper draws 19. An order may make 1000 pieces per triangle of A and has "
        f"{' or '.join(f'{x:g}' for x in limits)} s; the gap is 1e-8 of the diagonal of A.",
        "Meshes of Debian and npm packages (datasets/corpus.toml) stand in for Thingi10K, and CGAL's isotropic remeshing, with edges of "
        "1 % of the diagonal, for TetWild.",
        "Time covers preparing and the first answer, with one round (n = 1) per case. If times differ by less than the noise, a win is shared or "
        "lost by chance; counted work has no noise.",
        *lost_note(found),
        f"Here: {machine_line(results)}.",
    ]
    records: list[tables.Record] = [
        {
            "scene": scene,
            "order": order,
            "status": cell.status(),
            "n": cell.time.n,
            "seconds": cell.time.value,
            **{
                f"wins: {what or 'time'}": int(found.wins[what][order][found.solved.index(scene)])
                if scene in found.solved
                else 0
                for what in ("", *MEASURES)
            },
            **cell.counters,
        }
        for (order, scene), cell in found.cells.items()
    ]
    records += [{"scene": scene, "status": why} for scene, why in found.lost.items()]
    return Report(lambda: draw(found), table, records)


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


def lost_note(found: Orders) -> list[str]:
    if not found.lost:
        return []
    scene, why = next(iter(found.lost.items()))
    return [f"{len(found.lost)} pairs have no rows with an answer ({scene}: {why})."]


def draw(found: Orders) -> Any:
    """Draws the shared wins, in time and in counted work, of the orders that the paper shows and of
    the best order here."""
    work = list(MEASURES)[-1]
    drawn = [order for order in DRAWN if order in found.orders]
    for what in ("", work):
        most = max((found.count(order, what) for order in drawn), default=-1)
        best = max(found.orders, key=lambda order: found.count(order, what), default="")
        if best and best not in drawn and found.count(best, what) > most:
            drawn.append(best)
    figure, axes = plt.subplots(2, 1, sharex=True, sharey=True, figsize=(style.DOUBLE_COLUMN, 3.4))
    x = np.arange(len(drawn))
    colours = ["#E69F00" if "3" in order else WITHOUT_U3 for order in drawn]
    ended = [
        100 * sum(found.ends(order, scene) for scene in found.solved) / max(1, len(found.solved))
        for order in drawn
    ]
    for ax, what, name in zip(axes, ("", work), (clock_word(found.results), work)):
        ax.bar(x, ended, width=0.78, facecolor="none", edgecolor=style.GREY, linewidth=0.6)
        ax.bar(
            x,
            [found.percent(order, what) if found.solved else 0.0 for order in drawn],
            width=0.78,
            color=colours,
            zorder=2,
        )
        for i, order in enumerate(drawn):
            ax.text(
                i,
                (found.percent(order, what) if found.solved else 0.0) + 1.5,
                numerals.number(found.percent(order, what), 2),
                ha="center",
                fontsize=6,
                color="#333333",
                zorder=3,
            )
        ax.set_ylim(0, 108)
        ax.set_ylabel(f"pairs (%), n = {len(found.solved)}")
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
        + "; then the best here" * (more > 0)
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
