"""The blocks of docs/python.md run, one after the other, and print what their comments say."""

from __future__ import annotations

import contextlib
import io
import re
from pathlib import Path

import hausbench  # noqa: F401  (the blocks import it)
import pytest

PAGE = Path(__file__).resolve().parents[2] / "docs" / "python.md"
BLOCK = re.compile(r"^```python\n(.*?)^```$", re.MULTILINE | re.DOTALL)
EXPECTED = re.compile(r"^ *print\(.*\) *# (.*)$", re.MULTILINE)


def wrong_lines(text: str) -> list[str]:
    """Runs all blocks of a page. Returns one line for each block that prints something else than
    its comments say."""
    names: dict[str, object] = {}
    wrong = []
    for number, block in enumerate(BLOCK.findall(text), 1):
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(compile(block, f"block {number}", "exec"), names)
        if (output := printed.getvalue().split()) != (
            said := " ".join(EXPECTED.findall(block)).split()
        ):
            wrong.append(f"block {number} prints {' '.join(output)}, not {' '.join(said)}")
    return wrong


def test_the_page_runs() -> None:
    pytest.importorskip("scipy")
    text = PAGE.read_text(encoding="utf-8")
    assert len(BLOCK.findall(text)) >= 8
    assert wrong_lines(text) == []


def test_a_wrong_comment_is_found() -> None:
    assert wrong_lines("```python\nprint(1 + 1)  # 3\n```\n") == ["block 1 prints 2, not 3"]
