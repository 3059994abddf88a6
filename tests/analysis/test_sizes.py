"""A paper's claim gets a verdict only at the paper's sizes. At smaller sizes, the outcome at the
paper's sizes is quoted."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import matplotlib.pyplot as plt
import pytest
from synthetic import ResultFile

from analysis import opposite
from analysis.shared import beside_paper, claims, sizes, table_files
from analysis.shared.cells import Grid
from analysis.shared.load import load
from analysis.shared.results import Results
from analysis.shared.verdicts import FAILS, HOLDS, UNTESTED, Verdict

TOML = """
tolerances = [1e-6]
[profile.paper]
rounds = 10
limits = { case_seconds = 300 }
[[scene]]
name = "s"
source = "a"
target = "b"
[[scene]]
name = "t"
source = "{}"
target = "b"
profiles = ["quick"]
[[scene]]
name = "t"
source = "large"
target = "b"
note = "as in the paper"
profiles = ["paper"]
[[solver]]
name = "nohd"
"""


def results_of(tmp_path: Path, toml: str, profile: str = "quick") -> Results:
    file = ResultFile("zhang2017_fig8", meta={"experiment_toml": toml, "profile": profile})
    file.case("nohd", "s", [1.0])
    return load(file.write(tmp_path))


@pytest.mark.parametrize(
    ("source", "profile", "expected"),
    [("small", "quick", False), ("large", "quick", True), ("small", "paper", True)],
)
def test_sizes_are_the_scenes_and_not_the_rounds(
    tmp_path: Path, source: str, profile: str, expected: bool
) -> None:
    assert sizes.tests_claims(results_of(tmp_path, TOML.replace("{}", source), profile)) is expected


@pytest.mark.parametrize(
    ("source", "expected"), [("large", "here, the paper's sizes"), ("small", "here, smaller sizes")]
)
def test_the_legend_says_which_sizes(tmp_path: Path, source: str, expected: str) -> None:
    figure = beside_paper.draw(Grid(results_of(tmp_path, TOML.replace("{}", source))), {})
    assert expected in [text.get_text() for text in figure.legends[0].get_texts()]
    plt.close(figure)


def test_another_tolerance_is_another_size(tmp_path: Path) -> None:
    toml = TOML.replace("{}", "large").replace("rounds = 10", "tolerances = [1e-6, 1e-8]")
    assert not sizes.tests_claims(results_of(tmp_path, toml))


def test_a_verdict_of_smaller_sizes_names_the_kept_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sizes, "REFERENCE", tmp_path / "reference")
    (tmp_path / "reference").mkdir()
    greater, traps = Verdict(claims.of("zhang2017", "depth_greater"), FAILS, "x"), Verdict(
        claims.of("hausbench", "traps"), FAILS, "x"
    )
    small = results_of(tmp_path, TOML.replace("{}", "small"))
    never, ours = sizes.tested([greater, traps], small, "zhang2017_fig8")
    assert ours == traps  # our own claim, not a paper's
    printed = Verdict(
        claims.of("hausbench", "depth_of_frame", scene="x", printed=1.0, title="cover"), FAILS, "x"
    )
    assert (
        sizes.tested([printed], small, "tang2009_pd")[0].outcome == UNTESTED
    )  # ours, but it compares with a printed number
    assert never.outcome == UNTESTED and "not been measured at the paper's sizes" in never.evidence
    record = claims.record(replace(greater, outcome=HOLDS), "zhang2017_fig8", "paper")
    table_files.save_json([record], tmp_path / "reference" / f"kept{claims.SUFFIX}")
    line = sizes.tested([greater], small, "zhang2017_fig8")[0].line()
    assert (
        "Here: not tested (at these sizes, profile quick; at the paper's sizes: holds, see results/reference)."
        in line
    )
    assert sizes.tested(
        [greater], results_of(tmp_path, TOML.replace("{}", "large")), "zhang2017_fig8"
    ) == [greater]


def test_opposite_verdicts_are_named() -> None:
    kept = [
        claims.record(Verdict(claims.of("zhang2017", name), HOLDS, "x"), "zhang2017_fig8", "paper")
        for name in ("depth_greater", "depth_smaller")
    ]
    now: list[claims.Record] = [
        {**kept[0], "outcome": FAILS, "evidence": "ratio 0.5"},
        {**kept[1], "outcome": UNTESTED},
    ]
    lines = opposite.opposites(now, kept)
    assert (
        len(lines) == 1 and "does not hold here (ratio 0.5), holds in results/reference" in lines[0]
    )
