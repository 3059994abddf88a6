"""Converts text to ASCII for LaTeX: escapes special characters, and writes accents and symbols as
commands. A letter that LaTeX cannot print without packages becomes its Unicode number.
"""

from __future__ import annotations

import re
import unicodedata
from typing import Final

from analysis.shared.printable import printable, spelled

_SYMBOLS: Final = {
    "\\": r"\textbackslash{}",
    "&": r"\&",
    "%": r"\%",
    "$": r"\$",
    "#": r"\#",
    "_": r"\_",
    "{": r"\{",
    "}": r"\}",
    "~": r"\textasciitilde{}",
    "^": r"\textasciicircum{}",
    "|": r"\textbar{}",
    "<": r"\textless{}",
    ">": r"\textgreater{}",
    "—": "---",
    "–": "--",
    "…": r"\dots{}",
    "“": "``",
    "”": "''",
    "‘": "`",
    "’": "'",
    "\u00a0": "~",
    "×": r"$\times$",
    "·": r"$\cdot$",
    "±": r"$\pm$",
    "−": "$-$",
    "≤": r"$\le$",
    "≥": r"$\ge$",
    "≠": r"$\ne$",
    "≈": r"$\approx$",
    "≃": r"$\simeq$",
    "→": r"$\to$",
    "∞": r"$\infty$",
    "√": r"$\surd$",
    "°": r"$^\circ$",
    "²": "$^2$",
    "³": "$^3$",
    "′": r"$'$",
    "µ": r"\textmu{}",
    "†": r"$\dagger$",
    "ß": r"\ss{}",
    "ø": r"\o{}",
    "Ø": r"\O{}",
    "æ": r"\ae{}",
    "Æ": r"\AE{}",
    "œ": r"\oe{}",
    "Œ": r"\OE{}",
    "ł": r"\l{}",
    "Ł": r"\L{}",
    "ı": r"\i{}",
}
_GREEK: Final = dict(
    zip(
        "αβγδεζηθικλμνξπρστυφχψωΓΔΘΛΞΠΣΥΦΨΩ",
        (
            "alpha beta gamma delta varepsilon zeta eta theta iota kappa lambda mu nu xi pi rho sigma tau upsilon varphi chi psi omega "
            "Gamma Delta Theta Lambda Xi Pi Sigma Upsilon Phi Psi Omega"
        ).split(),
    )
)
_KNOWN: Final = _SYMBOLS | {letter: rf"$\{name}$" for letter, name in _GREEK.items()}
# The LaTeX command of each combining accent.
_ACCENTS: Final = {
    "\u0300": "`",
    "\u0301": "'",
    "\u0302": "^",
    "\u0303": "~",
    "\u0304": "=",
    "\u0306": "u",
    "\u0307": ".",
    "\u0308": '"',
    "\u030a": "r",
    "\u030b": "H",
    "\u030c": "v",
    "\u0327": "c",
}
_ACCENTED: Final = re.compile(
    f"([A-Za-z])([{''.join(_ACCENTS)}])"
)  # a letter and a combining accent that Unicode has no single character for
SPELLED: Final = r"\texttt{U+"
SPELLED_NOTE: Final = (
    "U+ and digits are the Unicode number of a letter that LaTeX does not set by itself."
)


def _under_accent(base: str) -> str:
    """Returns the letter to put an accent on: 'i' becomes '\\i', without a dot."""
    return base.replace("i", r"\i")


def _tex(letter: str) -> str:
    """Returns the LaTeX of one letter; empty if LaTeX cannot print it without packages."""
    if letter in _KNOWN or letter.isascii():
        return _KNOWN.get(letter, letter)
    parts = unicodedata.normalize("NFD", letter)
    base, accent = parts[0], parts[1:]
    if accent not in _ACCENTS or not base.isascii():
        return ""
    return f"\\{_ACCENTS[accent]}{{{_under_accent(base)}}}"


def tex_escape(text: str) -> str:
    """Returns the text in LaTeX. Letters that LaTeX cannot print become '\\texttt{U+4E2D}'."""
    parts = _ACCENTED.split(unicodedata.normalize("NFC", printable(text)))
    accented = [
        f"\\{_ACCENTS[accent]}{{{_under_accent(base)}}}"
        for base, accent in zip(parts[1::3], parts[2::3])
    ]
    return "".join(
        part for pair in zip([*map(_escaped, parts[::3])], [*accented, ""]) for part in pair
    )


def _escaped(text: str) -> str:
    """Escapes text without combining accents."""
    spelt = spelled(text, lambda letter: bool(_tex(letter)), "\x02{}\x03")
    return (
        "".join(_tex(letter) for letter in spelt).replace("\x02", r"\texttt{").replace("\x03", "}")
    )


def noted(text: str) -> str:
    """Returns SPELLED_NOTE if the escaped text contains Unicode numbers; else empty."""
    return SPELLED_NOTE if SPELLED in text else ""
