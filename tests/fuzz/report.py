"""Prints the totals of all fuzzing runs as a table in Markdown: `python3 tests/fuzz/report.py
[TOTALS ...]`.

Corpus, edges and features are the values after each target's last run. The default TOTALS are
results/reference/fuzzing.jsonl, the kept runs, and build/fuzz/totals.jsonl, the runs since; append
the latter to the former after a campaign. A line may sum up several `runs`.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def table(records: list[dict[str, str | int | float]]) -> list[str]:
    lines = [
        "| target | runs | seeds | CPU time, s | executions | corpus, files | edges | features | runs that ended with a failure |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    for target in sorted({str(record["target"]) for record in records}):
        of = [record for record in records if record["target"] == target]
        seeds = ", ".join(str(record["seed"]) for record in of)

        def total(key: str) -> float:
            return sum(float(record[key]) for record in of)

        def last(key: str) -> int:
            """Returns the latest value, because earlier builds of the target had other edges."""
            return int(of[-1][key])

        runs = sum(int(record.get("runs", 1)) for record in of)
        lines.append(
            f"| {target} | {runs} | {seeds} | {total('cpu_seconds'):.0f} | {int(total('executions')):,} | "
            f"{last('corpus'):,} | {last('coverage'):,} | {last('features'):,} | {int(total('failed'))} |"
        )
    return lines


def main(files: list[str]) -> int:
    usual = [
        ROOT / "results" / "reference" / "fuzzing.jsonl",
        ROOT / "build" / "fuzz" / "totals.jsonl",
    ]
    paths = list(map(Path, files)) or [path for path in usual if path.is_file()]
    if missing := [path for path in paths if not path.is_file()]:
        print(f"report: {missing[0]} is missing: run `make fuzz`", file=sys.stderr)
        return 2
    print(
        "\n".join(
            table([json.loads(line) for path in paths for line in path.read_text().splitlines()])
        )
    )
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
