"""The blocks of docs/c.md."""

from __future__ import annotations

import re
from pathlib import Path
from typing import NamedTuple

from c_library import ROOT

PAGE = ROOT / "docs" / "c.md"
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
NAME = re.compile(r"(?:/\*|//|#) (\S+\.\w+)(?: \*/)?\n")


class Block(NamedTuple):
    """A block of shell commands, or the last files of a section, without commands."""

    section: str
    files: dict[str, str]  # that the blocks before it in its section give, by name
    commands: str


def blocks(text: str) -> list[Block]:
    parsed = []
    for section in re.split(r"^## ", text, flags=re.MULTILINE):
        title, files, used = section.split("\n", 1)[0], dict[str, str](), True
        for language, block in BLOCK.findall(section):
            if used := language == "sh":
                parsed.append(Block(title, dict(files), block))
            else:
                name = NAME.match(block)
                assert name, f"the first line of this block does not name its file: {block}"
                files[name[1]] = block
        if not used:
            parsed.append(Block(title, files, ""))
    return parsed


def write(files: dict[str, str], folder: Path) -> None:
    for name, text in files.items():
        (folder / name).write_text(text)
