"""Blocks of both sides run at paths of equal length, which differs from pair to pair."""

from __future__ import annotations

from pathlib import Path

import pytest

from bench.tracking.places import LENGTHS, Places


def tree(folder: Path) -> Path:
    for name in ("datasets", "build/release", ".git"):
        (folder / name).mkdir(parents=True)
    (folder / "datasets" / "manifest.toml").write_text(folder.name)
    return folder


def test_both_sides_lie_under_paths_of_one_length(tmp_path: Path) -> None:
    places, names = Places(tmp_path), ("base", "the candidate, under a longer path")
    with places.root(tree(tmp_path / names[0]), 0) as first, places.root(
        tree(tmp_path / names[1]), 1
    ) as second:
        assert first != second and len(str(first)) == len(str(second))
        for name, root in zip(names, (first, second)):
            assert (root / "datasets" / "manifest.toml").read_text() == name
            assert root.resolve() == root, "what the system says of the program is its path, too"
    assert not first.exists() and not second.exists()


def test_nothing_that_was_built_comes_along_and_nothing_of_the_tree_is_lost(tmp_path: Path) -> None:
    original = tree(tmp_path / "own")
    with pytest.raises(KeyError), Places(tmp_path).root(original, 0) as root:
        assert not list((root / "build").iterdir()) and not (root / ".git").exists()
        (root / "build" / "left").touch()
        raise KeyError
    assert (
        (original / "datasets" / "manifest.toml").is_file()
        and (original / "build" / "release").is_dir()
        and list(tmp_path.iterdir()) == [original]
    )


def test_lengths_differ(tmp_path: Path) -> None:
    """2,000 draws miss one of the 64 lengths with a probability of 1e-12."""
    places, original, lengths = Places(tmp_path), tree(tmp_path / "own"), set()
    for _ in range(2000):
        places.move()
        with places.root(original, 0) as root:
            lengths.add(len(str(root)))
    assert len(lengths) == LENGTHS
