"""The exception for wrong arguments. Undecided is in interval.py."""

from __future__ import annotations


class InputError(ValueError):
    """An argument, array or file is wrong. The text is one line: its name, the place, and what to
    do.

    `row` is the wrong row of the array, from 0, or None.
    """

    row: int | None

    def __init__(self, text: str, row: int | None = None) -> None:
        super().__init__(text)
        self.row = row

    def about(self, name: str) -> InputError:
        """Returns the same error, with the name of the argument before it."""
        return InputError(f"{name}: {self}", self.row)

    def without(self, prefix: str, remedy: str, other: str) -> InputError:
        """Returns the same error in words of this package: without a prefix, and with another
        remedy."""
        return InputError(str(self).removeprefix(prefix).replace(remedy, other), self.row)
