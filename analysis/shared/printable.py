"""Makes text from result files safe to print: control characters could steer a terminal or reverse
the text. See algorithms/printable.h.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Callable, Iterable
from typing import Final

_BREAKS: Final = re.compile("[\x00-\x1f\x7f-\x9f\u2028\u2029]")
_CONTROLS: Final = re.compile("[\x00-\x09\x0b-\x1f\x7f-\x9f\u2028\u2029]")
# Marks of writing direction and zero-width characters: names that differ only in these look the
# same.
_HIDDEN: Final = re.compile(
    "[\u061c\u200b-\u200f\u202a-\u202e\u2060-\u2069\ufeff\U000e0000-\U000e007f]"
)


def printable(text: str, lines: bool = False) -> str:
    """Returns the text with spaces for control characters and question marks for hidden ones.
    `lines` keeps line breaks."""
    return _HIDDEN.sub("?", (_CONTROLS if lines else _BREAKS).sub(" ", text))


def spelled(text: str, known: Callable[[str], bool], form: str = "<{}>") -> str:
    """Replaces each run of letters that `known` rejects with their Unicode numbers: '<U+4E2D
    U+6587>'."""

    def numbered(letters: Iterable[str]) -> str:
        return form.format(" ".join(f"U+{ord(letter):04X}" for letter in letters))

    return "".join(
        "".join(letters) if is_known else numbered(letters)
        for is_known, letters in itertools.groupby(text, known)
    )
