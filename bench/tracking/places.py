"""Where the programs of both sides lie: those of one pair of blocks under paths of one length, and another pair under paths of another.

Paths are among what a program allocates, so their lengths decide where its arrays begin: `cover` was slower by 7 % where the path of the program
was longer, in every repeat of every process. Under paths of one length a build is as fast as itself. And what a change of the code moves
by accident is noise over many lengths, which intervals know, and no slowdown.
"""

from __future__ import annotations

import random
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

LENGTHS = 64  # a cache line of them: what is allocated lies at multiples of 16 bytes
OWN = ("build", ".git")  # of a tree, and not of the folder that stands for it


@dataclass
class Places:
    """In `folder`."""

    folder: Path
    padding: int = 0

    def move(self) -> None:
        """Later blocks are measured elsewhere."""
        self.padding = random.randrange(LENGTHS)

    @contextmanager
    def root(self, tree: Path, number: int) -> Iterator[Path]:
        """A folder that has what the tree has, and a build folder that is empty. A program in it finds its tree above itself, as commits
        before HAUSBENCH_ROOT need. `number`: a digit that tells folders apart that are there at the same time.
        """
        root = self.folder / f"tree-{number}{'-' * self.padding}"
        root.mkdir()
        try:
            for entry in tree.iterdir():
                if entry.name not in OWN:
                    (root / entry.name).symlink_to(entry.absolute())
            (root / "build").mkdir()
            yield root
        finally:
            shutil.rmtree(root)  # it follows no link
