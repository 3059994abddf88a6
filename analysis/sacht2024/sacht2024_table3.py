"""Table 3 of Sacht and Jacobson 2024: time of the solvers on pairs of meshes that are not alike."""

from __future__ import annotations

from analysis.sacht2024 import sacht_pairs
from analysis.sacht2024.sacht_pairs import Pairs
from analysis.shared.report import Report
from analysis.shared.results import Results
from analysis.shared.verdicts import Verdict

LOST = "ramesses_bust"  # the pair on which the paper's own method is slower than Zheng's


def verdicts(pairs: Pairs) -> list[Verdict]:
    won = [scene for scene in pairs.scenes if scene != LOST]
    return [pairs.less("far apart, Zheng takes less time than Kang", "kang", "zheng"),
            pairs.less("far apart, Sacht takes less time than Kang", "kang", "sacht"),
            pairs.less("far apart, Sacht takes less time than Zheng, but for (Ramesses, Bust)", "zheng", "sacht", won),
            pairs.less_on("on (Ramesses, Bust), Zheng takes less time than Sacht", "sacht", "zheng", LOST)]


SPEC = sacht_pairs.Spec(
    "pairs of meshes that are not alike", verdicts,
    ["A is from one pair of Table 2 and B from another, both centred and scaled to diagonal 1, so that they overlap. The paper does not "
     "say how its models lie."])


def make(results: Results) -> Report:
    return sacht_pairs.make(SPEC, results)
