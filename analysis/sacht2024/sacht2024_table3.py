"""Table 3 of Sacht and Jacobson 2024: time of the solvers on pairs of dissimilar meshes."""

from __future__ import annotations

from analysis.sacht2024 import sacht_pairs
from analysis.sacht2024.sacht_pairs import Pairs
from analysis.shared import claims
from analysis.shared.cells import in_time_and_work
from analysis.shared.report import Report
from analysis.shared.results import Results
from analysis.shared.verdicts import Verdict, least_of, most_of

LOST = "ramesses_bust"  # the pair on which the paper's own method is slower than Zheng's


def verdicts(pairs: Pairs) -> list[Verdict]:
    return [
        pairs.less(claims.of("sacht2024", "zheng_far"), "kang", "zheng"),
        fastest(pairs),
        pairs.less_on(claims.of("sacht2024", "ramesses_bust"), "sacht", "zheng", LOST),
    ]


def fastest(pairs: Pairs) -> Verdict:
    """Judges the claim that the paper's method beats both rivals on most pairs."""
    claim = claims.of("sacht2024", "fastest_far")

    def judge(measure: str) -> Verdict:
        least = []
        for scene in pairs.scenes:
            ratios = [pairs.ratio(scene, rival, "sacht", measure) for rival in ("kang", "zheng")]
            least.append(least_of(ratios))
        return most_of(claim, least)

    return in_time_and_work(judge)


SPEC = sacht_pairs.Spec(
    "pairs of meshes that are not alike",
    verdicts,
    [
        "A is from one pair of Table 2 and B from another, both centred and scaled to diagonal 1, so that they overlap. The paper does not say how its models "
        "are placed."
    ],
)


def make(results: Results) -> Report:
    return sacht_pairs.make(SPEC, results)
