"""Lists the verdicts in DIR/tables that contradict those in results/reference: `python3 -m
analysis.opposite [--out DIR]`.

Verdicts that this run did not test (analysis/shared/sizes.py) are not compared. `make experiments`
runs it last.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Final

from analysis.shared import claims
from analysis.shared.load import REFERENCE
from analysis.shared.verdicts import FAILS, HOLDS, NOT_REFUTED

OPPOSITE: Final = {HOLDS: FAILS, FAILS: HOLDS, NOT_REFUTED: FAILS}


def _key(record: claims.Record) -> tuple[str, ...]:
    return tuple(str(record[name]) for name in ("paper", "id", "stem", "place", "claim"))


def _verdicts_in(folder: Path) -> list[claims.Record]:
    paths = sorted(folder.glob(f"*{claims.SUFFIX}"))
    return [record for path in paths for record in claims.read(path)]


def opposites(now: Iterable[claims.Record], kept: Iterable[claims.Record]) -> list[str]:
    """Returns a line for each claim whose outcome now is the opposite of the kept one ('holds',
    'does not hold')."""
    before = {_key(record): str(record["outcome"]) for record in kept}
    return [
        f"{record['stem']}: {record['place']}{': ' if record['place'] else ''}{record['claim']}: {record['outcome']} here ({record['evidence']}), "
        f"{before[_key(record)]} in results/reference"
        for record in now
        if OPPOSITE.get(str(record["outcome"])) == before.get(_key(record), "") != ""
    ]


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="analysis.opposite",
        description="Lists the verdicts that are opposite to those in results/reference.",
    )
    parser.add_argument(
        "--out",
        type=Path,
        default=Path("results"),
        help="folder that has tables/ (default: results)",
    )
    tables = parser.parse_args(arguments).out / "tables"
    now, kept = _verdicts_in(tables), _verdicts_in(REFERENCE)
    lines = opposites(now, kept)
    print(
        *lines or [f"no verdict is opposite to a kept one ({len(now)} verdicts, {len(kept)} kept)"],
        sep="\n",
    )
    return 0


if __name__ == "__main__":
    sys.exit(main())
