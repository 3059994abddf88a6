"""Copies of figures and tables for the report."""

from __future__ import annotations

import gzip
from pathlib import Path

import numpy as np
from PIL import Image

from analysis.report.copies import LARGE_PICTURE, LARGE_TABLE, copied


def test_a_chart_keeps_its_pixels(tmp_path: Path) -> None:
    pixels = np.full((60, 80, 4), 255, np.uint8)
    pixels[20:30, 10:70, :3] = (13, 120, 200)
    pixels[40:, :, 3] = 0  # transparent, so white on the page
    Image.fromarray(pixels).save(tmp_path / "a.png")
    (tmp_path / "out").mkdir()
    assert copied(tmp_path / "a.png", tmp_path / "out") == "a.webp"
    assert (np.asarray(Image.open(tmp_path / "out" / "a.webp")) == pixels[..., :3]).all()


def test_a_picture_of_a_mesh_is_much_smaller_and_looks_the_same(tmp_path: Path) -> None:
    random = np.random.default_rng(1)
    x, y = np.meshgrid(np.linspace(0, 3, 800), np.linspace(0, 2, 600))
    smooth = np.stack([128 + 80 * np.sin(x + k) * np.cos(y) for k in range(3)], axis=-1)
    pixels = np.clip(smooth + random.normal(0, 2, smooth.shape), 0, 255).astype(np.uint8)
    Image.fromarray(pixels).save(tmp_path / "a.png")
    assert (tmp_path / "a.png").stat().st_size > LARGE_PICTURE
    (tmp_path / "out").mkdir()
    copied(tmp_path / "a.png", tmp_path / "out")
    assert (tmp_path / "out" / "a.webp").stat().st_size < (tmp_path / "a.png").stat().st_size / 3
    assert (
        np.abs(np.asarray(Image.open(tmp_path / "out" / "a.webp")).astype(int) - pixels).mean() < 3
    )


def test_a_large_table_is_compressed_and_a_small_one_is_not(tmp_path: Path) -> None:
    (tmp_path / "out").mkdir()
    for name, rows in (("small", 10), ("large", LARGE_TABLE)):
        (tmp_path / f"{name}.csv").write_text("a,b\n" + "1,2\n" * rows)
    assert copied(tmp_path / "small.csv", tmp_path / "out") == "small.csv"
    assert copied(tmp_path / "large.csv", tmp_path / "out") == "large.csv.gz"
    assert (
        gzip.decompress((tmp_path / "out" / "large.csv.gz").read_bytes())
        == (tmp_path / "large.csv").read_bytes()
    )
    first = (tmp_path / "out" / "large.csv.gz").read_bytes()
    copied(tmp_path / "large.csv", tmp_path / "out")
    assert (
        tmp_path / "out" / "large.csv.gz"
    ).read_bytes() == first, "the same table gives the same bytes"
