"""Claims are read only from their files, and every program that shows claims reads their verdicts
as data."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
import synthetic_zhang

from analysis.__main__ import main
from analysis.shared import claims, stems
from analysis.shared.verdicts import HOLDS, Verdict

PAPERS = sorted(path.stem for path in claims.FOLDER.glob("*.toml"))
EVERY = [entry for paper in PAPERS for entry in claims.entries(paper).values()]


def test_every_paper_has_a_file() -> None:
    assert PAPERS == ["hausbench", "sacht2024", "shou2014", "tang2009", "zhang2017"]


@pytest.mark.parametrize("entry", EVERY, ids=lambda entry: f"{entry.paper}-{entry.id}")
def test_a_claim_is_asked_for_and_quotes_its_sentence(entry: claims.Entry) -> None:
    """A script in analysis/ names the claim's id, unless it is untested. A paper's claim quotes one
    or two sentences and names the section."""
    prefix = entry.id.rpartition("_")[0]  # ids such as framework_inc are composed from parts
    scripts = [path.read_text(encoding="utf-8") for path in stems.ANALYSIS.rglob("*.py")]
    assert all(stems.module_of(stem) for stem in entry.stems)
    if entry.untested:
        assert entry.untested.endswith(".")
    else:
        assert entry.stems and entry.judged_as
        assert any(
            f'"{entry.id}"' in text or prefix and f'f"{prefix}_{{' in text for text in scripts
        )
    if entry.paper == claims.OWN:
        assert not entry.quote and not entry.section
    else:
        assert entry.section and 10 < len(entry.quote) < 320


def test_blanks_are_filled_in_and_the_place_stands_first() -> None:
    claim = claims.of("zhang2017", "peak", "torus", solver="EARLYBREAK")
    assert (
        claim == "torus: the time of EARLYBREAK peaks where the models overlap most"
        and claim.place == "torus"
    )
    with pytest.raises(KeyError):
        claims.of("zhang2017", "peak", "torus")
    with pytest.raises(KeyError):
        claims.of("zhang2017", "no such claim")


def test_a_claims_file_is_checked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(claims, "FOLDER", tmp_path)
    whole = 'claim = "a"\nstem = "s"\njudged_as = "never"\n'
    for name, text, problem in (
        ("p1", whole, "no 'quote'"),
        ("p2", whole + 'quote = "q"\nsection = "1"\nquot = 2\n', "unknown key 'quot'"),
        (
            "p3",
            whole.replace('"a"', '"{a}"') + 'quote = "q"\nsection = "1"\n',
            "has blanks and no 'in_general'",
        ),
    ):
        (tmp_path / f"{name}.toml").write_text(f"[c]\n{text}", encoding="utf-8")
        with pytest.raises(ValueError, match=problem):
            claims.entries(name)


def test_a_sentence_that_no_script_judges_says_why(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(claims, "FOLDER", tmp_path)
    (tmp_path / "u1.toml").write_text(
        '[c]\nclaim = "a"\nquote = "q"\nsection = "1"\nuntested = "No row has it."\n',
        encoding="utf-8",
    )
    entry = claims.entries("u1")["c"]
    assert (entry.untested, entry.stems, entry.judged_as) == ("No row has it.", (), "")
    with pytest.raises(ValueError, match="the claim u1/c, which is marked untested"):
        claims.record(Verdict(claims.of("u1", "c"), HOLDS, "x"), "zhang2017_fig8", "quick")
    (tmp_path / "u2.toml").write_text(
        '[c]\nclaim = "a"\nquote = "q"\nsection = "1"\nuntested = ""\n', encoding="utf-8"
    )
    with pytest.raises(ValueError, match="no 'judged_as'"):
        claims.entries("u2")


def test_a_typed_claim_has_no_record() -> None:
    with pytest.raises(TypeError, match="claims.of"):
        claims.record(Verdict("typed", HOLDS, "x"), "zhang2017_fig8", "quick")
    with pytest.raises(ValueError, match="add it to its `stem`"):
        claims.record(
            Verdict(claims.of("zhang2017", "depth_greater"), HOLDS, "x"), "zhang2017_fig9", "quick"
        )


def test_verdicts_stand_beside_the_table(tmp_path: Path) -> None:
    file = synthetic_zhang.fig10()
    file.write(tmp_path)
    assert main([file.stem, "--results", str(tmp_path), "--out", str(tmp_path)]) == 0
    records = claims.read(tmp_path / "tables" / f"{file.stem}.verdicts.json")
    text = (tmp_path / "tables" / f"{file.stem}.md").read_text(encoding="utf-8")
    assert len(records) == text.count("- Claim: ") > 3
    for record in records:
        assert (
            f"- Claim: {record['place']}: {record['claim']}. Here" in text
            and f"{record['outcome']} ({record['evidence']})" in text
        )
        assert (
            record["paper"] == "zhang2017"
            and record["stem"] == file.stem
            and record["profile"] == "quick"
        )
        assert (
            record["quote"]
            and record["section"] in ("1", "3.3", "5", "6.4")
            and record["judged_as"]
        )
    assert any(record["counted"] for record in records)


def test_a_damaged_file_of_verdicts_is_refused(tmp_path: Path) -> None:
    assert claims.read(tmp_path / "none.json") == []
    (tmp_path / "x.json").write_text(json.dumps({"not": "a list"}), encoding="utf-8")
    with pytest.raises(ValueError, match="not a list of records"):
        claims.read(tmp_path / "x.json")
