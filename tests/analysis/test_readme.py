"""README explains the words that a newcomer meets in tables, messages and options."""

from __future__ import annotations

from analysis.winners import README


def test_words_are_explained() -> None:
    section = README.read_text(encoding="utf-8").partition("\n## Words\n")[2].partition("\n## ")[0]
    explained = {word.strip() for line in section.splitlines() if line.startswith("| ") for word in line.split("|")[1].split(",")}
    assert {"stem", "profile", "round", "row", "case", "witness", "incumbent", "floor", "ledger"} <= explained
    assert len(section.strip().splitlines()) <= 15
