"""A paper's page has a line for every claim, and its picture shows measured values over claimed
ones."""

from __future__ import annotations

import math
from pathlib import Path

import matplotlib.pyplot as plt
import pytest

from analysis import conditions, forest, paper_page
from analysis.shared import claims
from analysis.shared.load import REFERENCE
from analysis.shared.estimates import Estimate, exact
from analysis.shared.verdicts import (
    FAILS,
    HOLDS,
    NOT_JUDGED,
    UNTESTED,
    Ratio,
    Verdict,
    above_one,
    everywhere,
    most_of,
)

STEM = "zhang2017_table3"


def verdict(outcome: str, evidence: str, **more: object) -> Verdict:
    return Verdict(claims.of("zhang2017", "framework_inc"), outcome, evidence, **more)  # type: ignore[arg-type]


def record(outcome: str, evidence: str, profile: str = "paper", **more: object) -> claims.Record:
    return claims.record(verdict(outcome, evidence, **more), STEM, profile)


def line(now: list[claims.Record], kept: list[claims.Record]) -> list[str]:
    page = paper_page.markdown("zhang2017", paper_page.lines_of("zhang2017", now, kept))
    return [text for text in page.splitlines() if "the framework takes less time than INC" in text]


def test_the_kept_pages_are_what_the_kept_verdicts_give(tmp_path: Path) -> None:
    for path in [*REFERENCE.glob(f"*{claims.SUFFIX}"), *REFERENCE.glob("*.md")]:
        (tmp_path / path.name).write_bytes(path.read_bytes())
    for path in paper_page.write_kept(tmp_path, tmp_path / "claims.png")[:-1]:
        assert path.read_text(encoding="utf-8") == (REFERENCE / path.name).read_text(
            encoding="utf-8"
        ), "run python3 -m analysis.paper_page --kept"
    assert (tmp_path / "claims.png").read_bytes()[:4] == b"\x89PNG"


@pytest.mark.parametrize("paper", paper_page.papers())
def test_every_claim_has_a_line_and_every_quote_stands_once(paper: str) -> None:
    page = paper_page.markdown(paper, paper_page.lines_of(paper, [], []))
    for entry in claims.entries(paper).values():
        judged_as = f" ({entry.judged_as})" if entry.judged_as else ""
        assert (
            f"{entry.in_general or entry.text}{judged_as} | **{UNTESTED}** | {entry.untested or 'Not measured at the sizes of the claim yet.'} |"
            in page.replace("\\|", "|")
        )
        assert not entry.quote or f"“{entry.quote}”" in page
    assert page.count(f"**{UNTESTED}**") == len(claims.entries(paper)) and "{" not in page


def test_a_verdict_of_this_run_stands_before_the_kept_one() -> None:
    now, kept, small = (
        record(FAILS, "now", "quick"),
        record(HOLDS, "before"),
        record(UNTESTED, "at these sizes", "quick"),
    )
    assert "**does not hold** | now" in line([now], [kept])[0]
    assert "**holds (kept)** | before" in line([small], [kept])[0]
    assert len(line([now], [kept])) == 1
    few = record(NOT_JUDGED, "n = 2", "quick")
    assert (
        "**holds (kept)** | before" in line([few], [kept])[0]
        and "**not judged** | n = 2" in line([few], [])[0]
    )
    peak = claims.record(
        Verdict(claims.of("zhang2017", "peak", "torus", solver="INC"), HOLDS, "x"),
        "zhang2017_fig10",
        "paper",
    )
    assert "torus: the time of INC peaks" in paper_page.markdown(
        "zhang2017", paper_page.lines_of("zhang2017", [peak], [kept])
    )


def test_counted_work_says_whether_it_is_the_machine() -> None:
    same = record(FAILS, "ratio 0.5", counted={"distances": verdict(FAILS, "ratio 0.4")})
    unlike = record(FAILS, "ratio 0.5", counted={"distances": verdict(HOLDS, "ratio 2.4")})
    assert (
        "the machine is not the reason" in line([same], [])[0]
        and "the machine is not the reason" not in line([unlike], [])[0]
    )
    assert "counted work agrees with the paper" in line([unlike], [])[0]
    assert (
        "counted work"
        not in line(
            [record(HOLDS, "ratio 2", counted={"distances": verdict(HOLDS, "ratio 2.4")})], []
        )[0]
    )


def test_a_reason_for_a_difference_stands_alone() -> None:
    """If counted work fails like time, the machine is not the reason; and the claims file already
    gives one."""
    claim = claims.of("tang2009", "outperforms")
    assert claim.entry.differs
    judged = claims.record(
        Verdict(
            claim, FAILS, "ratio 0.5", counted={"distances": Verdict(claim, FAILS, "ratio 0.4")}
        ),
        "tang2009_fig10",
        "paper",
    )
    (entry,) = [line for line in paper_page.lines_of("tang2009", [judged], []) if line.verdict]
    assert paper_page.why(entry) == f"{claim.entry.differs} {claim.entry.why_not}"


def test_a_sentence_that_no_script_judges_has_its_reason_and_no_verdict() -> None:
    lines = paper_page.lines_of("zhang2017", [], [])
    (table_row,) = [
        text
        for text in paper_page.markdown("zhang2017", lines).splitlines()
        if "in proportion to the number of points |" in text
    ]
    assert table_row.endswith(
        " | **not tested** | No experiment builds the best case, in which the first distance ends the loop of every point. |  |  |"
    )
    judged: claims.Record = {**record(HOLDS, "x"), "id": "best_case"}
    with pytest.raises(
        ValueError, match="zhang2017/best_case is marked untested and has a verdict"
    ):
        paper_page.lines_of("zhang2017", [], [judged])


def test_latex_is_escaped_and_has_a_row_for_each_line() -> None:
    lines = paper_page.lines_of("tang2009", [], [])
    text = paper_page.latex("tang2009", lines)
    assert (
        text.count(r"\addlinespace") == len(lines)
        and r"99 \%" in text
        and "_table2" not in text.replace(r"\_table2", "")
    )


def test_a_ratio_is_on_the_side_of_one_that_the_verdict_says() -> None:
    two = Estimate(2.0, 1.5, 2.5, 6, 0.97, 0.01, 1.0, 0.01)
    assert above_one("c", two).ratio == Ratio(2.0, 1.5, 2.5)
    ranged = everywhere("c", [two, exact(8.0)]).ratio
    assert ranged and math.isnan(ranged.value) and (ranged.low, ranged.high) == (2.0, 8.0)
    assert most_of("c", [two, exact(8.0)]).ratio is not None
    assert Ratio.of(two, 4.0) == Ratio(0.5, 0.375, 0.625)


def test_the_picture_tells_time_from_counted_work() -> None:
    inc = record(
        HOLDS,
        "x",
        ratio=Ratio(2.0, 1.5, math.inf),
        counted={"distances": verdict(HOLDS, "x", ratio=Ratio(math.nan, 3.0, math.inf))},
    )
    time, work = forest.bars(inc)
    assert (
        time[0]
        and time[1][:2] == (2.0, 1.5)
        and not work[0]
        and math.isnan(work[1][0])
        and work[1][1:] == (3.0, math.inf)
    )
    culled = claims.record(
        Verdict(
            claims.of("tang2009", "culling", side="A"), HOLDS, "x", ratio=Ratio(math.nan, 1.1, 9.0)
        ),
        "tang2009_table2",
        "paper",
    )
    assert [kind for kind, _ in forest.bars(culled)] == [False]
    assert forest.bars(record(HOLDS, "x")) == []
    figure = forest.draw([inc, culled, record(HOLDS, "x")])
    shown = [text.get_text() for text in figure.axes[0].texts]
    assert shown == [
        "the framework takes less time than INC on average",
        "Culling leaves out more than 99 % of A on most pairs",
        "Zhang et al. 2017",
        "Tang et al. 2009",
    ]


def test_names_in_the_picture_are_whole_and_its_directions_are_said() -> None:
    long = claims.record(
        Verdict(
            claims.of(
                "hausbench",
                "times_cgal",
                title="cover (ours)",
                aim=40,
                among=" over pairs of 30,000 triangles and more",
            ),
            HOLDS,
            "x",
            ratio=Ratio(2.0, 1.5, 3.0),
        ),
        "mesh_peers",
        "paper",
    )
    figure = forest.draw([long], "Measured on Test CPU, 2 cores; n = 6 rounds.")
    assert figure.axes[0].texts[0].get_text().replace("\n", " ") == long["claim"]
    assert (
        "more than claimed →" in figure.axes[0].get_xlabel()
        and "← less than claimed" in figure.axes[0].get_xlabel()
    )
    assert "Measured on Test CPU, 2 cores; n = 6 rounds." in figure.texts[0].get_text().replace(
        "\n", " "
    )
    figure.draw_without_rendering()
    assert (
        all(text.get_window_extent().x0 >= 0 for text in figure.axes[0].texts)
        and figure.texts[0].get_window_extent().x0 >= 0
    )
    plt.close(figure)


def test_a_page_says_where_and_how_its_numbers_were_measured(tmp_path: Path) -> None:
    kept = REFERENCE / "zhang2017_claims.md"
    said = next(
        line
        for line in kept.read_text(encoding="utf-8").splitlines()
        if line.startswith("Measured on ")
    )
    assert (
        "2 cores, 24 GiB" in said
        and "n = 2 to 10 rounds" in said
        and "preparing is wall time" in said
        and "Brackets: an interval of at least 95 %" in said
    )
    (tmp_path / "tables").mkdir()
    (tmp_path / "tables" / f"{STEM}.md").write_text(
        "- Medians of n = 7 rounds.\n- Here: My CPU @ 3 GHz, 4 cores, 8 GiB, Linux, GNU 12, commit 1, profile paper. Paper: x.\n",
        encoding="utf-8",
    )
    now = paper_page.lines_of("zhang2017", [record(HOLDS, "now")], [])
    assert (
        conditions.measured(paper_page.texts_of(now, tmp_path))
        == "Measured on My CPU @ 3 GHz, 4 cores, 8 GiB, Linux; n = 7 rounds or seeds (fresh processes)."
    )
    assert "My CPU" in paper_page.latex("zhang2017", now, "Measured on My CPU.")
