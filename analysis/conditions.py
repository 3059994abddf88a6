"""Says how the numbers on a page of claims were measured (machine, rounds, clock), by searching the
text of the tables."""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path
from typing import Final

from analysis.shared import gate
from analysis.shared.results import ResultError
from analysis.shared.stems import results_of

_MACHINE: Final = re.compile(
    r"(?:^- (?:Measured on )?|\bon |Here: |\. )([^,.:\n]{3,80}, \d+ cores, \d+ GiB, [^,\n]+), [^\n]*?commit",
    re.MULTILINE,
)
_ROUNDS: Final = re.compile(r"n = (\d+)(?: (?:to|or) (\d+))? (?:rounds|seeds)")
CLOCKS: Final = "Solving is CPU time, or wall time if several threads work; preparing is wall time."
BRACKETS: Final = (
    "Brackets: an interval of at least 95 % (for fewer than six rounds, their whole range), over rounds for one ratio, over pairs for a mean "
    "over pairs, unless marked 'over rounds'. 'Ratio a to b': the least and the greatest of several ratios."
)


def kept_texts(folder: Path, stems: Iterable[str]) -> list[str]:
    """Returns the texts about these stems from the kept files of tables: the head of each file,
    which names the machine, and sections."""
    wanted, texts = {_results_of(stem) for stem in stems}, []
    for path in sorted(folder.glob("*.md")):
        head, *sections = path.read_text(encoding="utf-8").split("\n## ")
        matching = [section for section in sections if section.partition("\n")[0].strip() in wanted]
        texts += [head, *matching] if matching else []
    return texts


def _results_of(stem: str) -> str:
    try:
        return results_of(stem)
    except ResultError:  # the script of the stem was removed
        return stem


def present_texts(folder: Path, stems: Iterable[str]) -> list[str]:
    return [
        path.read_text(encoding="utf-8")
        for stem in sorted(set(stems))
        if gate.is_plain(path := folder / f"{stem}.md")
    ]


def measured(texts: Iterable[str]) -> str:
    """Returns 'Measured on CPU, 2 cores, 24 GiB, SYSTEM; n = 2 to 10 rounds or seeds (fresh
    processes).', or an empty string if no text names a machine.
    """
    texts = list(texts)
    machines = list(dict.fromkeys(machine for text in texts for machine in _MACHINE.findall(text)))
    counts = sorted(
        int(count) for text in texts for pair in _ROUNDS.findall(text) for count in pair if count
    )
    n = (
        f"; n = {counts[0]}"
        + (f" to {counts[-1]}" if counts[-1] > counts[0] else "")
        + " rounds or seeds (fresh processes)"
        if counts
        else ""
    )
    return f"Measured on {' and on '.join(machines)}{n}." if machines else ""


def line(texts: Iterable[str]) -> str:
    """Returns where and how the numbers on a page of claims were measured; empty if nothing was
    measured."""
    where = measured(texts)
    return f"{where} {CLOCKS} {BRACKETS}" if where else ""
