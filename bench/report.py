"""Writes the table of kernel comparisons from the CSV of kernel_compare.

    python3 -m bench.report FILE.csv ... > results/reference/kernels.md
"""

from __future__ import annotations

import csv
import sys
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from analysis.shared.estimates import Estimate
from analysis.shared.numerals import NOTHING, number
from analysis.shared.tables import Table, markdown

COLUMNS = [
    "part",
    "scene",
    "contender",
    "elements",
    "nanoseconds",
    "ratio",
    "low",
    "high",
    "rounds",
    "bytes",
    "largest_difference",
]

# Part: title, unit of its times, nanoseconds in that unit, name of an element.
PARTS = {
    "build": ("Building", "ns a triangle", 1.0, "triangles"),
    "query": (
        "Closest point queries from each vertex of a near mesh, but for the warm start each from nothing",
        "ns a query",
        1.0,
        "queries",
    ),
    "certification": (
        "What certification costs: `guthe`, solving, tolerance 1e-6 of the diagonal of A",
        "ms",
        1e6,
        "",
    ),
}

HEAD = """# Kernels, measured

Made by `tools/bench --reference` and not edited. Contenders take turns, forth and back (ABBA), in one run on one core; each
time is CPU time, the median of the rounds. A ratio is that contender's time over the first one's, the median over rounds
with a 95 % order-statistic interval: above 1, the first is faster. Only ratios within one table mean anything.

BVH, octree and triangle blocks are this project's, in double precision with the bits of a plain scan. Embree (3.13) answers in single
precision: vertices are rounded to float beforehand, off the clock, queries as they come; one thread, default build
quality (medium), default (not robust) scene, `rtcPointQuery` with a scalar callback. CGAL is `AABB_tree` over
`Simple_cartesian<double>` with its default search structure, which counts as building. The last column is the largest
difference to the first contender's distances, in diagonals of the target.
"""


# Claims about the kernels: text, part, contender (prefix of its name), limit, and whether each
# ratio must be at least or below the limit.
CLAIMS = [
    ("building the BVH takes no longer than Embree's", "build", "Embree", 1.0, True),
    ("a query takes no longer than Embree's", "query", "Embree", 1.0, True),
    ("a query takes at most a third of CGAL's time", "query", "CGAL", 3.0, True),
    ("certification costs less than 20 %", "certification", "guthe (certified)", 1.2, False),
]


@dataclass(frozen=True)
class Row:
    """A line of the CSV: times in nanoseconds per element; the ratio is to the first contender of
    the part and scene."""

    part: str
    scene: str
    contender: str
    elements: int
    nanoseconds: float
    ratio: Estimate
    bytes: int
    largest_difference: float


def read(lines: Iterable[str]) -> tuple[list[str], list[Row]]:
    """Returns the remarks (lines with #, without the #) and the rows. Raises KeyError if a column is
    missing or a part is unknown, ValueError if a row has too few or too many fields or a wrong
    number."""
    lines = list(lines)
    remarks = [line[1:].strip() for line in lines if line.startswith("#")]
    rows = []
    for record in csv.DictReader(line for line in lines if not line.startswith("#")):
        if None in record or None in record.values():
            raise ValueError(f"a row has not as many fields as the header: {record}")
        if record["part"] not in PARTS:
            raise KeyError(f"no part is called {record['part']!r}")
        n = int(record["rounds"])
        ratio = Estimate(
            float(record["ratio"]),
            float(record["low"]),
            float(record["high"]),
            n,
            0.95 if n > 5 else 0.0,
        )
        rows.append(
            Row(
                record["part"],
                record["scene"],
                record["contender"],
                int(record["elements"]),
                float(record["nanoseconds"]),
                ratio,
                int(record["bytes"]),
                float(record["largest_difference"]),
            )
        )
    return remarks, rows


def ratio_text(ratio: Estimate) -> str:
    text = f"{ratio.value:.2f} [{ratio.low:.2f}, {ratio.high:.2f}]"
    return text if ratio.separated else f"{text} (not separated)"


def table(part: str, rows: list[Row]) -> Table:
    title, unit, scale, of = PARTS[part]
    first = next(row.contender for row in rows)
    header = [
        "mesh" if part == "build" else "scene",
        *([of] if of else []),
        "",
        unit,
        f"times {first}",
    ]
    header += ["bytes an element"] if part == "build" else ["difference"]
    result = Table(f"{title} ({min(row.ratio.n for row in rows)} rounds)", header, left=1)
    scene = ""
    for row in rows:
        again, scene = row.scene == scene, row.scene
        cells = [
            "" if again else scene,
            *([("" if again else str(row.elements))] if of else []),
            row.contender,
            number(row.nanoseconds / scale),
            "1" if row.contender == first else ratio_text(row.ratio),
        ]
        if part == "build":
            cells.append(number(row.bytes / row.elements) if row.bytes else NOTHING)
        else:
            cells.append("" if row.contender == first else number(row.largest_difference, 2))
        result.rows.append(cells)
    return result


def verdict(
    rows: list[Row], claim: str, part: str, contender: str, limit: float, at_least: bool
) -> str:
    """Returns whether a claim holds on every scene, judged by the less favourable end of each
    interval."""
    ratios = [row.ratio for row in rows if row.part == part and row.contender.startswith(contender)]
    if not ratios:
        return f"- {claim}: not measured"
    holds = [x.low >= limit if at_least else x.high < limit for x in ratios]
    answer = "holds" if all(holds) else f"holds on {sum(holds)} of {len(holds)} scenes"
    values = [x.value for x in ratios]
    return f"- {claim}: {answer} (ratios {min(values):.2f} to {max(values):.2f})"


def report(remarks: list[str], rows: list[Row]) -> str:
    remark_lines = [f"- {remark}" for remark in remarks]
    verdicts = [verdict(rows, *claim) for claim in CLAIMS]
    parts = [
        HEAD,
        *remark_lines,
        "",
        "What is asked of them, judged by the worse ends of the intervals:",
        "",
        *verdicts,
        "",
    ]
    for part in PARTS:
        chosen = [row for row in rows if row.part == part]
        if chosen:
            parts.append(markdown(table(part, chosen)))
    return "\n".join(parts)


def main() -> None:
    remarks: list[str] = []
    rows: list[Row] = []
    for name in sys.argv[1:]:
        more_remarks, more_rows = read(
            Path(name).read_text(encoding="utf-8").splitlines(keepends=True)
        )
        remarks += more_remarks
        rows += more_rows
    sys.stdout.write(report(remarks, rows))


if __name__ == "__main__":
    main()
