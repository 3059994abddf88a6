"""Draws one pair: `hausbench measure A B --picture FILE`, which runs this file.

Left: A, coloured by its distance to B, with the farthest point and a bar of known length. Right: a
histogram of the distance over A. Of each bar the full part is certain, and the hatched part is
possible: the true share ends in it. Everything ends after a counted amount of work, so that a busy
machine draws the same picture. --time-limit only ends the histogram earlier, which is left out if
little is certain then; the colours and the ends of the bars do not depend on it. The answer is
printed as without --picture.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import math
import os
import subprocess
import sys
import tempfile
import warnings
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import Normalize, PowerNorm

from analysis.shared import mesh_picture, style
from analysis.shared.columns import Floats
from analysis.shared.printable import printable
from analysis.shared.shapes import Coloured

BARS: Final = 30
END: Final = 1.017  # right end of the last bar, over the largest distance; a round number would put ends where many distances are equal
PIECES: Final = 1_000_000  # of A, for the histogram
CUTS: Final = 10_000_000  # of A, for the farthest point
KNOWN: Final = 0.5  # least certain share of A over all bars for which a histogram is drawn
LINE: Final = 0.01  # a mean or quantile is drawn as a line if it is known to this part of the largest distance, otherwise as a band
READING: Final[tuple[str, ...]] = (
    "--unit=",
    "--up=",
    "--columns=",
    "--drop-invalid",
    "--transform-source=",
    "--transform-target=",
    "--threads=",
)
DRAWABLE: Final = 1e250  # matplotlib draws neither greater lengths nor lengths below the inverse
FROM: Final = (
    0.5,
    0.4,
    1.0,
)  # direction to the eye, used if the farthest point is visible from there
FAR: Final = "#D55E00"


@dataclass(frozen=True)
class Histogram:
    """Bounds on the share of A whose distance is in each bar, and on two statistics."""

    edges: Floats
    low: Floats
    high: Floats
    mean: tuple[float, float]
    most_of_a: tuple[float, float]  # the 95 % quantile


def read(file: Path) -> Coloured:
    """Reads a PLY as `measure --fields` writes it: binary, double precision, triangles."""
    head, _, body = file.read_bytes().partition(b"end_header\n")
    kinds = {"double": "<f8", "float": "<f4", "int": "<i4", "uchar": "u1"}
    elements: list[tuple[int, list[Any]]] = []
    for line in head.decode().splitlines():
        words = line.split()
        if words[0] == "element":
            elements.append((int(words[2]), []))
        elif words[:2] == ["property", "list"]:
            elements[-1][1].extend([("count", "u1"), ("corners", "<i4", 3)])
        elif words[0] == "property":
            elements[-1][1].append((words[2], kinds[words[1]]))
    arrays, offset = list[Any](), 0
    for count, kind in elements:
        layout = np.dtype(kind)
        arrays.append(np.frombuffer(body, layout, count, offset))
        offset += count * layout.itemsize
    vertices, *faces = arrays
    corners = np.stack([vertices[axis] for axis in "xyz"], axis=1)
    return Coloured(
        corners,
        faces[0]["corners"] if faces else np.empty((0, 3), dtype=np.int32),
        vertices["distance"].astype(float),
    )


def solved(program: str, *words: str) -> Any:
    """Returns the answer of `measure --json`. Raises CalledProcessError if there is none; the
    program has then printed the reason."""
    return json.loads(
        subprocess.run(
            [program, "measure", *words, "--json"], stdout=subprocess.PIPE, text=True, check=True
        ).stdout
    )


def histogram(
    program: str, a: str, b: str, largest: float, options: Sequence[str] = ()
) -> Histogram:
    """Bounds the distribution. No distance is above `largest`, so the last share is known.
    `options`: how to read A and B, and the time limit."""
    edges = END * largest * np.arange(1, BARS + 1) / BARS
    statistics = ", ".join(
        ["mean", "quantile 0.95", *(f"within {float(edge)!r}" for edge in edges[:-1])]
    )
    distribution = solved(
        program,
        a,
        b,
        f"--statistics={statistics}",
        "--of=absolute",
        f"--tolerance={largest / 1000!r}",
        "--share-tolerance=0.01",
        f"--budget={PIECES}",
        *options,
    )["distribution"]
    shares = sorted(
        (float(length), bounds) for length, bounds in distribution["share_within"].items()
    )
    lower = np.array([*(float(bounds["lower"]) for _, bounds in shares), 1.0])
    upper = np.array([*(float(bounds["upper"]) for _, bounds in shares), 1.0])
    below_low, below_high = np.append(0.0, lower[:-1]), np.append(0.0, upper[:-1])
    return Histogram(
        edges,
        np.maximum(lower - below_high, 0.0),
        np.minimum(upper - below_low, 1.0),
        *(
            (float(statistic["lower"]), min(float(statistic["upper"]), largest))
            for statistic in (distribution["mean"], distribution["quantiles"]["0.95"])
        ),
    )


def round_length(most: float) -> float:
    """Returns the largest of 1, 2 and 5 times a power of ten that is at most `most`."""
    power = 10.0 ** math.floor(math.log10(most))
    return max(step * power for step in (1, 2, 5) if step * power <= most)


def outward(shape: Coloured) -> Coloured:
    """Returns a closed mesh with its triangles turned over if most of them face inward."""
    a, b, c = (shape.corners[shape.triangles[:, k]] - shape.corners.mean(axis=0) for k in range(3))
    return (
        shape
        if (a * np.cross(b, c)).sum() >= 0
        else replace(shape, triangles=shape.triangles[:, ::-1])
    )


def draw_shape(ax: Any, shape: Coloured, farthest: Floats, colour_of: Any) -> None:
    eye = mesh_picture.view(FROM)
    if len(shape.triangles):
        closed = shape.closed
        shape = outward(shape) if closed else shape
        eye = mesh_picture.showing(shape, eye, farthest)
        mesh_picture.draw(
            ax, shape, eye, colour_of(shape.colours), both_sides=not closed, shade=0.25
        )
    else:
        seen = eye.seen(shape.corners)
        order = np.argsort(seen[:, 2])
        ax.scatter(
            seen[order, 0],
            seen[order, 1],
            c=colour_of(shape.distances[order]),
            s=min(20.0, 20_000 / len(order)),
            linewidths=0,
            rasterized=True,
        )
    mesh_picture.frame(ax, eye.seen(shape.corners), margin=0.06)  # room for the ring
    mesh_picture.ring(ax, eye.seen(farthest), FAR)
    (left, right), (bottom, top) = ax.get_xlim(), ax.get_ylim()
    if right > left:
        length, under = round_length(0.4 * (right - left)), bottom - 0.03 * (top - bottom)
        ax.plot([left, left + length], [under, under], color="black", linewidth=1.5, clip_on=False)
        ax.text(left, under - 0.02 * (top - bottom), f"{length:g}", ha="left", va="top")


def draw_histogram(ax: Any, shown: Histogram, colour_of: Any) -> None:
    width = shown.edges[0]
    left = shown.edges - width
    ax.bar(left, 100 * shown.low, width, align="edge", color=colour_of(shown.edges - width / 2))
    ax.bar(
        left,
        100 * (shown.high - shown.low),
        width,
        bottom=100 * shown.low,
        align="edge",
        facecolor="none",
        edgecolor="black",
        hatch="/////",
        linewidth=0.4,
        label="the share ends here",
    )
    for (low, high), dashes, hatch, name in (
        (shown.mean, "-", "\\\\\\", "mean"),
        (shown.most_of_a, "--", "|||", "95 % quantile"),
    ):
        if high - low <= LINE * shown.edges[-1]:
            ax.axvline(
                0.5 * (low + high), color="black", linestyle=dashes, linewidth=0.9, label=name
            )
        else:
            ax.axvspan(
                low,
                high,
                facecolor="none",
                edgecolor="0.5",
                hatch=hatch,
                linestyle=dashes,
                linewidth=0.9,
                label=f"the {name} is in here",
            )
    ax.set(
        xlabel="distance to B, in the unit of the files",
        ylabel="share of A, %",
        xlim=(0, shown.edges[-1]),
        ylim=(0, min(105.0, 105.0 * shown.high.max())),
    )
    ax.legend(frameon=True, framealpha=0.85, edgecolor="none")


def draw(
    shape: Coloured,
    farthest: Floats,
    largest: float,
    shown: Histogram | None,
    names: tuple[str, str],
) -> Any:
    skewed = (
        largest > 0 and float(np.quantile(shape.distances, 0.95)) < 0.25 * largest
    )  # most of A would have one colour
    scale = PowerNorm(0.5, 0, largest or 1.0) if skewed else Normalize(0, largest or 1.0)

    def colour_of(distances: Floats) -> Floats:
        return np.asarray(plt.get_cmap("viridis")(scale(distances)))

    figure, axes = plt.subplots(
        1,
        2 if shown else 1,
        figsize=(style.DOUBLE_COLUMN, 3.2),
        squeeze=False,
        width_ratios=(1.1, 1) if shown else None,
    )
    draw_shape(axes[0][0], shape, farthest, colour_of)
    a, b = (printable(name) for name in names)
    axes[0][0].set_title(f"{a}: distance to {b}; ring: farthest point", parse_math=False)
    bar = figure.colorbar(
        plt.cm.ScalarMappable(scale, "viridis"), ax=axes[0][0], shrink=0.8, pad=0.02
    )
    bar.set_label("distance" + (" (square-root scale)" if skewed else ""))
    if shown:
        draw_histogram(axes[0][1], shown, colour_of)
    return figure


def complain(why: str) -> int:
    print(printable(f"hausbench: --picture: {why}"), file=sys.stderr)
    return 2


def main(arguments: Sequence[str] | None = None) -> int:
    """Returns the exit code of `measure`; 1 if it gave nothing to draw, 2 if it cannot be drawn."""
    parser = argparse.ArgumentParser(prog="hausbench measure", allow_abbrev=False)
    parser.add_argument("a")
    parser.add_argument("b")
    parser.add_argument("--picture", type=Path, required=True)
    given, rest = parser.parse_known_args(arguments)
    options = [word for word in rest if word.startswith(READING)]
    fineness = [word for word in rest if word.startswith("--resolution=")]
    limit = [word for word in rest if word.startswith("--time-limit=")]
    if any(float(word.partition("=")[2]) > 0.5 for word in fineness):
        return complain(
            "A is drawn from values that are close to its distance: leave out --resolution, or take at most 0.5"
        )
    program = os.environ["HAUSBENCH_PROGRAM"]
    if code := subprocess.run(
        [program, "measure", given.a, given.b, *rest], check=False
    ).returncode:
        return code
    with tempfile.TemporaryDirectory() as folder:
        fields = Path(folder) / "a.ply"
        try:
            answer = solved(
                program,
                given.a,
                given.b,
                f"--fields={fields}",
                f"--budget={CUTS}",
                *options,
                *fineness,
            )
        except subprocess.CalledProcessError as error:
            return error.returncode
        shape = read(fields)
    extent = max(float(np.abs(shape.corners).max()), float(shape.distances.max()))
    if not (extent == 0 or 1 / DRAWABLE < extent < DRAWABLE):
        return complain(f"lengths of {extent:g} cannot be drawn: use another unit")
    shown, differ = None, float(answer["lower"]) > 0 or float(shape.distances.max()) > 0
    if differ and math.isfinite(float(answer["upper"])):
        with contextlib.suppress(
            subprocess.CalledProcessError
        ):  # the reason, such as the time limit, is printed
            shown = histogram(program, given.a, given.b, float(answer["upper"]), [*options, *limit])
    if differ and (not shown or shown.low.sum() < KNOWN):
        print(
            "hausbench: --picture: without a histogram, because too little of it is known: allow more time",
            file=sys.stderr,
        )
        shown = None
    warnings.filterwarnings(
        "ignore", message="Glyph"
    )  # a name may have characters that the font lacks
    farthest = (
        np.array(answer["source_point"], dtype=float)
        if answer["source_point"]
        else shape.corners[int(np.argmax(shape.distances))]
    )
    figure = draw(
        shape,
        farthest,
        float(shape.distances.max()),
        shown,
        (Path(given.a).name, Path(given.b).name),
    )
    try:
        figure.savefig(given.picture)
    except OSError as problem:
        return complain(f"{given.picture}: {problem}: make room, or choose another place")
    return 0


if __name__ == "__main__":
    sys.exit(main())
