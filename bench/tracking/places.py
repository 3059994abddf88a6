"""Puts both programs of a pair of blocks under paths of the same length, which is random for each
pair.

A program allocates its paths, so their lengths decide where its arrays begin: `cover` was 7 %
slower under a longer path, in every repeat of every process. With equal lengths, a build is as fast
as itself. A change of the code can shift arrays, too; over many lengths, such shifts become noise
that the intervals include, and do not look like slowdowns.
"""

from __future__ import annotations

import random
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

LENGTHS = 64  # the bytes of a cache line
OWN = ("build", ".git")  # not linked into the copy of a tree


@dataclass
class Places:
    """Makes folders for programs in `folder`, with paths of a chosen length."""

    folder: Path
    padding: int = 0

    def move(self) -> None:
        """Chooses a random path length for later blocks."""
        self.padding = random.randrange(LENGTHS)

    @contextmanager
    def root(self, tree: Path, number: int) -> Iterator[Path]:
        """Makes a folder with links to the contents of the tree, and an empty build folder for a
        program.

        Programs that do not know HAUSBENCH_ROOT yet search for their tree in the folders above.
        `number` is a digit that distinguishes folders that exist at the same time.
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
