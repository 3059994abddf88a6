"""How far a long measurement is: one line that changes where somebody watches, every fifth count in a line of its own where nobody does."""

from __future__ import annotations

import sys
import time

CLEAR = "\r\x1b[K"  # a terminal's way to begin a line anew


class Progress:
    def __init__(self, total: int, unit: str, who: str) -> None:
        self.total, self.unit, self.who = total, unit, who
        self._begun = time.monotonic()

    def done(self, count: int) -> None:
        """So many are done, one at least; those that are left take as long each."""
        left = (time.monotonic() - self._begun) / count * (self.total - count)
        text = f"{self.who}: {count} of {self.total} {self.unit}, {left:.0f} s left"
        if sys.stderr.isatty():
            print(f"{CLEAR}{text}", end="\n" if count == self.total else "", file=sys.stderr, flush=True)
        elif count % 5 == 0 or count == self.total:
            print(text, file=sys.stderr, flush=True)

    def over(self) -> None:
        """Sooner than expected: what comes next begins a line."""
        if sys.stderr.isatty():
            print(CLEAR, end="", file=sys.stderr, flush=True)


def say(who: str, text: str) -> None:
    """A line on standard error, in place of a changing one."""
    print(f"{CLEAR if sys.stderr.isatty() else ''}{who}: {text}", file=sys.stderr, flush=True)
