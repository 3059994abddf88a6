"""Tests what readers of the recorded scenes of experiments/tang2009 may rely on."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
MODELS = tomllib.loads((ROOT / "datasets" / "manifest.toml").read_text())["model"]


DOMINOES = [*(f"letter_{name}" for name in "hausdorfbenc"), "bunny_1k"]
BUNNIES = ["bunny_1k"] * 50


@pytest.mark.parametrize(
    ("stem", "objects"),
    [
        ("alphabet_domino", DOMINOES),
        ("alphabet_domino_soft", DOMINOES),
        ("falling_bunnies", BUNNIES),
        ("falling_bunnies_soft", BUNNIES),
    ],
)
def test_recordings(stem: str, objects: list[str]) -> None:
    file = ROOT / "experiments" / "tang2009" / f"{stem}.recording"
    assert file.stat().st_size < 600_000
    lines = [line for line in file.read_text().splitlines() if not line.startswith("#")]
    assert lines[0] == "hausbench recording 1"
    word, frames = lines[1].split()
    assert word == "frames"
    assert lines[2 : 2 + len(objects)] == [f"object {i} {name}" for i, name in enumerate(objects)]
    assert set(objects) <= MODELS.keys()

    keys: list[tuple[int, ...]] = []
    poses: dict[tuple[int, int], list[str]] = {}
    for line in lines[2 + len(objects) :]:
        word, *words = line.split(" ")
        assert word == "pair" and len(words) == 17
        frame, first, second = map(int, words[:3])
        keys.append((frame, first, second))
        assert 0 <= frame < int(frames) and 0 <= first < second < len(objects)
        for body, numbers in ((first, words[3:10]), (second, words[10:])):
            assert (
                poses.setdefault((frame, body), numbers) == numbers
            )  # a body has one pose in each frame
            assert all(f"{float(number):.9g}" == number for number in numbers)
            assert sum(float(number) ** 2 for number in numbers[:4]) == pytest.approx(1, abs=1e-8)
    assert keys == sorted(set(keys)) and 1000 <= len(keys) <= 2000
    # In the last frame, most bodies overlap another; a few bunnies roll away if contacts are rigid.
    assert len(
        {body for frame, *pair in keys if frame == int(frames) - 1 for body in pair}
    ) >= 0.8 * len(objects)
