"""Puts the programs of both sides of a pair of blocks under paths of the same length, and another pair under paths of another
length.

A program allocates its paths, so their lengths decide where its arrays begin: `cover` was 7 % slower if the path of the program
was longer, in every repeat of every process. Under paths of the same length, a build is as fast as itself. Accidental shifts by a
change of the code become noise over many lengths, which the intervals include, and do not look like slowdowns.
"""

from __future__ import annotations

import random
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

LENGTHS = 64  # a cache line of lengths; allocations lie at multiples of 16 bytes
OWN = ("build", ".git")  # belongs to a tree, but not to the folder that stands for it


@dataclass
class Places:
    """Folders for programs, in `folder`."""

    folder: Path
    padding: int = 0

    def move(self) -> None:
        """Puts later blocks elsewhere."""
        self.padding = random.randrange(LENGTHS)

    @contextmanager
    def root(self, tree: Path, number: int) -> Iterator[Path]:
        """Makes a folder with the contents of the tree and an empty build folder.

        A program in it finds its tree above itself, as commits before HAUSBENCH_ROOT need. `number` is a digit that distinguishes
        folders that exist at the same time.
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
            shutil.rmtree(root)  # it does not follow links
