"""Progress of a long measurement: one changing line on a terminal, otherwise a separate line for
every fifth count."""

from __future__ import annotations

import sys
import time

CLEAR = "\r\x1b[K"  # clears the line of a terminal


class Progress:
    def __init__(self, total: int, unit: str, who: str) -> None:
        self.total, self.unit, self.who = total, unit, who
        self._begun = time.monotonic()

    def done(self, count: int) -> None:
        """Shows that `count` units (at least 1) are done, and the time left if the others take as
        long."""
        left = (time.monotonic() - self._begun) / count * (self.total - count)
        text = f"{self.who}: {count} of {self.total} {self.unit}, {left:.0f} s left"
        if sys.stderr.isatty():
            print(
                f"{CLEAR}{text}",
                end="\n" if count == self.total else "",
                file=sys.stderr,
                flush=True,
            )
        elif count % 5 == 0 or count == self.total:
            print(text, file=sys.stderr, flush=True)

    def over(self) -> None:
        """Clears the line, for work that ends before `total` units."""
        if sys.stderr.isatty():
            print(CLEAR, end="", file=sys.stderr, flush=True)


def say(who: str, text: str) -> None:
    """Prints a line on standard error; on a terminal it replaces the progress line."""
    print(f"{CLEAR if sys.stderr.isatty() else ''}{who}: {text}", file=sys.stderr, flush=True)
