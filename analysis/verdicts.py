"""What the data say of a paper's claims: 'holds', 'does not hold', 'not separated'. Worked out, never written by hand.

'Not separated' is what few or noisy times give: the interval holds both answers.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from analysis import tables
from analysis.statistics import Estimate

HOLDS: Final = "holds"
FAILS: Final = "does not hold"
OPEN: Final = "not separated"
UNTESTED: Final = "not tested"  # the experiment, or what became of it, left no data


@dataclass(frozen=True)
class Verdict:
    claim: str
    outcome: str
    evidence: str

    def line(self) -> str:
        here = "Here it" if self.outcome in (HOLDS, FAILS) else "Here:"
        return f"Claim: {self.claim}. {here} {self.outcome} ({self.evidence})."


def everywhere(claim: str, ratios: Sequence[Estimate], what: str = "pairs") -> Verdict:
    """A claim that every one of the ratios is above 1."""
    known = [x for x in ratios if x.n]
    if not known:
        return Verdict(claim, UNTESTED, "no ratios")
    above = sum(x.separated and x.low > 1 for x in known)
    below = sum(x.separated and x.high < 1 for x in known)
    outcome = FAILS if below else HOLDS if above == len(known) else OPEN
    least, most = min(x.value for x in known), max(x.value for x in known)
    rest = len(known) - above - below
    parts = [f"above 1 for {above} of {len(known)} {what}"] + [f"below 1 for {below}"] * bool(below) \
        + [f"not separated for {rest}"] * bool(rest) + [f"ratio {tables.number(least)} to {tables.number(most)}"]
    return Verdict(claim, outcome, ", ".join(parts))


def above_one(claim: str, ratio: Estimate, what: str = "ratio") -> Verdict:
    """A claim that one ratio is above 1."""
    if not ratio.n:
        return Verdict(claim, UNTESTED, "no ratio")
    outcome = OPEN if not ratio.separated else HOLDS if ratio.low > 1 else FAILS
    return Verdict(claim, outcome, f"{what} {tables.estimate(ratio)}")


def never(claim: str, wrong: int, of: int, what: str) -> Verdict:
    """A claim that something never happens; one case refutes it, and no number of cases can prove it."""
    if not of:
        return Verdict(claim, UNTESTED, f"no {what}")
    return Verdict(claim, FAILS if wrong else HOLDS, f"{wrong} of {of:,} {what}")


def kendall(x: Sequence[float], y: Sequence[float]) -> tuple[float, float]:
    """Kendall's tau, and the probability of so large an |tau| if x and y had nothing to do with each other (exact, by
    counting permutations by their inversions; ties in either count as half, which keeps it conservative). O(n^3).
    """
    n = len(x)
    pairs = n * (n - 1) // 2
    if not pairs:
        return 0.0, 1.0
    score = sum(_sign(x[j] - x[i]) * _sign(y[j] - y[i]) for i in range(n) for j in range(i))
    counts = [1.0]  # permutations of k things by their inversions
    for k in range(2, n + 1):
        longer = [0.0] * (len(counts) + k - 1)
        for inversions, count in enumerate(counts):
            for more in range(k):
                longer[inversions + more] += count / k
        counts = longer
    most = (pairs - abs(score)) // 2
    return score / pairs, min(1.0, 2 * math.fsum(counts[:most + 1]))


def _sign(value: float) -> int:
    return (value > 0) - (value < 0)


def rising(claim: str, x: Sequence[float], y: Sequence[float]) -> Verdict:
    """A claim that y grows with x."""
    tau, chance = kendall(x, y)
    if len(x) < 2:
        return Verdict(claim, UNTESTED, "fewer than two sizes")
    outcome = OPEN if chance > 0.05 else HOLDS if tau > 0 else FAILS
    return Verdict(claim, outcome, f"Kendall's tau {tau:.2f} over {len(x)}, p = {tables.number(chance, 2)}")


def least_among(claim: str, ratios: Sequence[tuple[str, Estimate]], best: str, among: Sequence[str]) -> Verdict:
    """A claim that the least time is at one of the settings `among`. `best` is where it is here; each of the ratios is
    of another setting's time to that of the best of `among`, so above 1 where that setting is slower.
    """
    if not ratios:
        return Verdict(claim, UNTESTED, "no times")
    rivals = [(name, x) for name, x in ratios if x.n]
    faster = [name for name, x in rivals if x.separated and x.high < 1]
    level = [name for name, x in rivals if not x.separated]
    outcome = FAILS if faster else OPEN if level else HOLDS
    parts = [f"least at {best}"] + [f"faster than {' or '.join(among)}: {', '.join(faster)}"] * bool(faster) \
        + [f"not separated from it: {', '.join(level)}"] * bool(level)
    return Verdict(claim, outcome, "; ".join(parts))
