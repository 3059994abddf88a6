"""The pages of the report on made-up results. They do not depend on the network or on the place of
the folder."""

from __future__ import annotations

import json
import re
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import pytest
from PIL import Image

from analysis import paper_page
from analysis.report import all_rows, chooser, outcomes, pages
from analysis.shared import claims, style
from analysis.shared.load import REFERENCE, load
from analysis.shared.estimates import ratio_by_round
from analysis.shared.verdicts import FAILS, HOLDS, OPEN, Verdict
from analysis.which_solver import Cell
from synthetic import ResultFile, zhang2017_table3

HOSTILE = "</script><script>alert(1)</script>&<b>"


class Links(HTMLParser):
    """Collects the addresses that a page refers to, and its ids."""

    def __init__(self) -> None:
        super().__init__()
        self.to: list[str] = []
        self.ids: list[str] = []

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        self.to += [value or "" for name, value in attributes if name in ("href", "src")]
        self.ids += [value or "" for name, value in attributes if name == "id"]


def written(folder: Path, *files: ResultFile) -> tuple[dict[str, Links], list[str]]:
    for file in files:
        file.write(folder)
    paths, problems = pages.write(folder, folder)
    links = {}
    for path in paths:
        links[path.name] = Links()
        links[path.name].feed(path.read_text(encoding="utf-8"))
    return links, problems


def peers() -> ResultFile:
    file = ResultFile("mesh_peers")
    for solver, seconds in (("cover", 1.0), ("tang", 2.0)):
        file.case(
            solver,
            HOSTILE,
            [seconds * (1 + 0.01 * k) for k in range(7)],
            lower=0.5,
            upper=0.5,
            tolerance=1e-6,
            tolerance_of="diagonal",
            prepare_seconds=0.0,
            reason=HOSTILE,
            source_elements=20_000,
        )
    return file


def test_every_link_resolves_and_none_leaves_the_folder(tmp_path: Path) -> None:
    (tmp_path / "tables").mkdir()
    (tmp_path / "tables" / "zhang2017_table3.md").write_text(
        "**A table.**\n\n| a | b |\n|---|---:|\n| <b>x</b> | 1 |\n", encoding="utf-8"
    )
    (tmp_path / "figures").mkdir()
    Image.new("RGB", (8, 8)).save(tmp_path / "figures" / "zhang2017_table3.png")
    (tmp_path / "figures" / "zhang2017_table3.pdf").write_bytes(b"x")
    links, _ = written(tmp_path, zhang2017_table3(), peers())
    assert set(links) == {
        "index.html",
        "zhang2017.html",
        "tang2009.html",
        "shou2014.html",
        "sacht2024.html",
        "experiments.html",
        "rows.html",
        "scenes.html",
        "stability.html",
        "work.html",
    }
    for name, page in links.items():
        assert len(page.ids) == len(set(page.ids)), name
        for link in page.to:
            file, _, place = link.partition("#")
            if link in ("data:,", "#"):
                continue
            assert (tmp_path / "report" / (file or name)).is_file(), (name, link)
            assert not place or place in links[file or name].ids or file == "rows.html", (
                name,
                link,
            )
    shown = (tmp_path / "report" / "zhang2017.html").read_text(encoding="utf-8")
    assert (
        "&lt;b&gt;x&lt;/b&gt;" in shown
        and 'src="files/zhang2017_table3.webp"' in shown
        and "make zhang2017_table3" in shown
    )


def test_a_result_that_breaks_a_page_is_left_out(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    script = all_rows.script

    def breaks(results: dict[str, Any]) -> str:
        if "mesh_peers" in results:
            raise KeyError("odd")
        return script(results)

    monkeypatch.setattr(all_rows, "script", breaks)
    written(tmp_path, zhang2017_table3(), peers())
    assert (
        "mesh_peers.h5: left out: it has values that no run writes (KeyError: 'odd')"
        in capsys.readouterr().err
    )
    rows = (tmp_path / "report" / "rows_data.js").read_text(encoding="utf-8")
    assert '"zhang2017_table3"' in rows and '"mesh_peers"' not in rows


def test_names_from_results_stay_text(tmp_path: Path) -> None:
    written(tmp_path, peers())
    for path in (tmp_path / "report").iterdir():
        if path.is_file():
            assert HOSTILE not in path.read_text(encoding="utf-8"), path.name


def test_without_results_the_kept_verdicts_are_shown(tmp_path: Path) -> None:
    links, problems = written(tmp_path)
    text = (tmp_path / "report" / "index.html").read_text(encoding="utf-8")
    assert problems == [] and "No results yet" in text and "kept from a longer run" in text


def test_which_solver_to_take(tmp_path: Path) -> None:
    matrix = chooser.matrix({"mesh_peers": load(peers().write(tmp_path))})
    (kind,) = matrix.kinds
    assert (kind.title, kind.sized, kind.tolerances) == ("Meshes", True, ["1e-06"])
    ((distance, size, (group,)),) = kind.rows
    assert (
        (distance, size) == (chooser.APART, "10K to 100K")
        and group is not None
        and len(group.scenes) == 1
    )
    best = group.leader
    assert (
        best is not None
        and (best.solver, best.wins, best.separated) == ("cover", 1, 1)
        and best.ratio == pytest.approx(2.0, rel=0.05)
    )
    assert chooser.matrix({}).kinds == []


def test_every_status_is_explained() -> None:
    assert set(all_rows.STATUSES) == {"ok", *style.STATUS_WORDS}


def won(solver: str, rounds: int, *ratios: float) -> list[Cell]:
    """Returns cells that a solver wins by these ratios, with so many rounds each."""
    times = [
        ratio_by_round(dict.fromkeys(range(rounds), ratio), dict.fromkeys(range(rounds), 1.0))
        for ratio in ratios
    ]
    return [
        Cell(
            "mesh",
            "mesh_peers",
            f"{solver} {k}",
            "",
            1e-6,
            solver,
            solver,
            1,
            ratio,
            ratio.separated,
        )
        for k, ratio in enumerate(times)
    ]


@pytest.mark.parametrize("rounds,doubt", [(7, ""), (2, "too few rounds to tell")])
def test_a_win_without_enough_rounds_says_so(rounds: int, doubt: str) -> None:
    best = chooser.group(won("cover", rounds, 2.0, 8.0)).leader
    assert best is not None and (best.factor, best.range, best.doubt) == (
        "4.0×",
        "2.0× to 8.0×",
        doubt,
    )


def test_one_separated_win_does_not_speak_for_the_others() -> None:
    best = chooser.group(won("cover", 7, 2.0) + won("cover", 2, 3.0, 4.0)).leader
    assert best is not None and (best.wins, best.doubt) == (3, "1 of them separated")


def test_half_of_the_scenes_make_no_winner() -> None:
    tie = chooser.group(won("cover", 7, 2.0, 3.0) + won("sacht", 7, 1.5, 1.2))
    assert tie.leader is None and [(winner.solver, winner.wins) for winner in tie.winners] == [
        ("cover", 2),
        ("Sacht 2024", 2),
    ]


def test_rows_keep_the_digits_of_bounds(tmp_path: Path) -> None:
    file = ResultFile("error_vs_time")
    lower = 0.1 + 0.2
    file.case("cover", "a", [1.23456], lower=lower, upper=float("inf"), status="budget")
    file.case("tang", "a", status="timeout", reason=HOSTILE)
    text = all_rows.script({"error_vs_time": load(file.write(tmp_path))})
    assert "<" not in text
    read = json.loads(text)
    assert (
        read["lower"] == [lower, None]
        and read["upper"] == ["inf", None]
        and read["seconds"][1] is None
    )
    assert read["seconds"][0] == pytest.approx(1.111, rel=1e-3)  # the CPU time, with four digits
    assert [read["reason"]["values"][i] for i in read["reason"]["rows"]] == ["", HOSTILE]


def test_which_rows_can_be_proven_by_a_command(tmp_path: Path) -> None:
    file = ResultFile("error_vs_time")
    good: dict[str, Any] = {
        "source": "hand",
        "target": "hand_half",
        "tolerance_of": "diagonal",
        "lower": 0.5,
        "upper": 0.5,
    }
    cases: list[tuple[str, dict[str, Any]]] = [
        ("cover", {}),
        ("tang", {}),
        ("cover", {"source": "known to the experiment"}),
        ("cover", {"quantity": "symmetric"}),
        ("cover", {"status": "budget"}),
        ("cover", {"pose": [1.0, 0, 0, 0, 1, 0, 0, 0, 1, 2, 0, 0]}),
    ]
    for solver, changes in cases:
        file.case(solver, "a", [1.0], **good | changes)
    results = load(file.write(tmp_path))
    assert [all_rows.prover(results, row) for row in range(6)] == ["cover", "", "", "", "", ""]


def verdict(paper: str, name: str, outcome: str) -> claims.Record:
    entry = claims.entries(paper)[name]
    return claims.record(Verdict(claims.of(paper, name), outcome, "x"), entry.stems[0], "paper")


@pytest.mark.parametrize("paper", paper_page.papers())
def test_every_kept_claim_that_does_not_hold_says_why(paper: str) -> None:
    assert outcomes.misfits(paper_page.lines_of(paper, [], paper_page.records(REFERENCE))) == []


def test_a_text_that_no_longer_fits_is_named() -> None:
    explained, plain = "framework_earlybreak", "framework_inc"
    for name, outcome, named in (
        (explained, HOLDS, True),
        (explained, FAILS, False),
        (explained, OPEN, False),
        (plain, FAILS, True),
        (plain, HOLDS, False),
    ):
        problems = outcomes.misfits(
            paper_page.lines_of("zhang2017", [verdict("zhang2017", name, outcome)], [])
        )
        assert [problem.partition(":")[0] for problem in problems] == (
            [f"zhang2017/{name}"] if named else []
        )


def test_strict_fails_with_the_name(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "tables").mkdir()
    (tmp_path / "tables" / f"zhang2017_table3{claims.SUFFIX}").write_text(
        json.dumps([verdict("zhang2017", "framework_earlybreak", HOLDS)]), encoding="utf-8"
    )
    assert pages.main(["--results", str(tmp_path)]) == 0
    assert pages.main(["--results", str(tmp_path), "--strict"]) == 1
    assert "zhang2017/framework_earlybreak: " in capsys.readouterr().err
    assert "Explanations that no longer fit" in (tmp_path / "report" / "index.html").read_text(
        encoding="utf-8"
    )


def test_claims_that_do_not_hold_come_first() -> None:
    lines = paper_page.lines_of("zhang2017", [], paper_page.records(REFERENCE))
    paper = outcomes.paper("zhang2017", lines)
    against = [line.against for line in paper.lines]
    assert (
        against == sorted(against, reverse=True) and any(against) and len(paper.lines) == len(lines)
    )
    unlike = [line for line in paper.lines if line.against]
    explained = {line.id for line in unlike if line.why}
    assert {line.id for line in unlike} == explained
    said = [(line.id, line.why) for line in paper.lines if line.why]
    assert len(said) == len(set(said)), "the reason stands once"
    assert sum(count for _, count in paper.counts) == len(lines)


def test_no_page_asks_the_network() -> None:
    for path in [*(pages.HERE / "web").iterdir(), *(pages.HERE / "templates").iterdir()]:
        assert not re.search(
            r"https?://|\bfetch\(|XMLHttpRequest|@import", path.read_text(encoding="utf-8")
        ), path.name
