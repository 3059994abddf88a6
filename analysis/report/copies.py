"""Copies figures and tables beside the pages, small enough that the whole report can be sent by
mail."""

from __future__ import annotations

import gzip
import io
import shutil
from pathlib import Path
from typing import Any, Final

from PIL import Image

LARGE_TABLE: Final = (
    100_000  # bytes; a larger CSV file is compressed, which pandas and R read as it is
)
UNREADABLE: Final = (
    OSError,
    ValueError,
    SyntaxError,
    Image.DecompressionBombError,
)  # what Pillow raises for a damaged picture
LARGE_PICTURE: Final = 300_000  # bytes of a PNG


def copied(path: Path, folder: Path) -> str:
    """Copies a file into a folder and returns the name of the copy.

    A PNG becomes a WebP with the same pixels, which is half as large. A large picture becomes a
    WebP with slightly other pixels if that halves the size again, as it does for pictures of
    meshes. A large CSV file is compressed (.csv.gz). Other files stay as they are.
    """
    if path.suffix == ".png":
        return _written(folder / f"{path.stem}.webp", _webp(path))
    if path.suffix == ".csv" and path.stat().st_size > LARGE_TABLE:
        return _written(folder / f"{path.name}.gz", gzip.compress(path.read_bytes(), mtime=0))
    shutil.copyfile(path, folder / path.name)
    return path.name


def _written(path: Path, content: bytes) -> str:
    path.write_bytes(content)
    return path.name


def _webp(path: Path) -> bytes:
    with Image.open(path) as picture:
        image: Any = picture.convert("RGBA")
    opaque = Image.new("RGB", image.size, "white")
    opaque.paste(image, mask=image.getchannel("A"))
    exact = _saved(opaque, lossless=True, quality=50)
    if path.stat().st_size <= LARGE_PICTURE:
        return exact
    near = _saved(opaque, quality=90)
    return near if 2 * len(near) < len(exact) else exact


def _saved(image: Any, **how: Any) -> bytes:
    out = io.BytesIO()
    image.save(out, "WEBP", **how)
    return out.getvalue()
