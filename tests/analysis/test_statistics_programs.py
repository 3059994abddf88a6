"""The table and verdicts of `statistics_programs`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from synthetic import ResultFile, spread

from analysis.__main__ import main


def programs(
    error: dict[int, float], seconds: float, status: str = "ok", proven: bool = True
) -> ResultFile:
    """Two pairs of meshes with a mean of 0.01. `distribution` takes 10 ms at 1e-2 and 20 ms at
    1e-3. MeshLab's mean has these errors, by its number of samples, and it takes `seconds` for each
    million samples, twice as much on the second pair."""
    file = ResultFile("distribution_error_vs_time", meta={"profile": "paper"})
    for pair, slower in (("hand", 1.0), ("bull", 2.0)):
        common: dict[str, Any] = {
            "quantity": "distribution",
            "statistic": "mean",
            "tolerance_of": "lower",
            "source": f"{pair}/A",
            "target": f"{pair}/B",
        }
        for tolerance, middle in ((1e-2, 0.01), (1e-3, 0.02)) if proven else ():
            file.case(
                "distribution",
                pair,
                spread(middle, 7),
                lower=0.01 * (1 - tolerance / 200),
                upper=0.01 * (1 + tolerance / 200),
                prepare_seconds=0.0,
                tolerance=tolerance,
                extras='{"pieces": 1000}',
                **common,
            )
        for samples, off in error.items():
            value = 0.01 * (1 + off)
            file.case(
                "external",
                pair,
                [1.0] * 7,
                label=f"MeshLab, {samples} samples",
                tolerance=1e-2,
                certified=0,
                status=status,
                lower=value,
                upper=value,
                reported_seconds=seconds * samples / 1e6 * slower,
                **common,
            )
    return file


def made(folder: Path, file: ResultFile) -> str:
    file.write(folder)
    assert main([file.stem, "--results", str(folder), "--out", str(folder)]) == 0
    return (folder / "tables" / "statistics_programs.md").read_text(encoding="utf-8")


def row_of(text: str, start: str) -> list[str]:
    row = next(line for line in text.splitlines() if line.startswith(start))
    return [cell.strip() for cell in row.split("|")[1:-1]]


@pytest.mark.parametrize(
    ("seconds", "said"), [(10.0, "Here it holds"), (1e-3, "Here it does not hold")]
)
def test_the_fewest_samples_that_are_enough(tmp_path: Path, seconds: float, said: str) -> None:
    """10^4 samples are enough by chance, and 10^5 are not, so it takes 10^6 for 1e-2; nothing is
    enough for 1e-3."""
    text = made(tmp_path, programs({10**4: 0.0001, 10**5: -0.02, 10**6: 0.005}, seconds))
    cells = row_of(text, "| hand")
    assert (
        cells[1] == "0.01"
        and cells[2].startswith("10.0 [")
        and cells[3:5] == ["1,000,000", "0.0050"]
    )
    assert cells[5].startswith({10.0: "10000 [", 1e-3: "1.00 ["}[seconds])
    assert said in text and "over 2 pairs" in text
    finer = row_of(text, "|  | 0.001")
    assert finer[3:5] == ["more", "0.0050"]
    assert (
        "on 2 more, its largest number of samples is not enough" in text
        and "Here: not tested" in text
    )
    assert ("MeshLab is faster on 2" in text) == (seconds < 0.1)


def test_not_separated(tmp_path: Path) -> None:
    assert "Here: not separated" in made(
        tmp_path, programs({10**6: 0.005}, 0.007)
    )  # 7 and 14 ms beside 10 ms, +- 5 %


def test_a_difference_that_noise_made_zero_counts_as_a_millisecond(tmp_path: Path) -> None:
    assert row_of(made(tmp_path, programs({10**6: 0.005}, 0.0)), "| hand")[5:7] == [
        "1.00 [1.00, 1.00]",
        "0.100 [0.0952, 0.105]",
    ]


def test_a_program_that_is_not_installed(tmp_path: Path) -> None:
    text = made(tmp_path, programs({10**6: 0.005}, 1.0, status="skipped"))
    assert row_of(text, "| hand")[3] == "skipped" and "Here: not tested" in text
    assert "No program was run." in made(tmp_path, programs({}, 1.0))
    assert not list((tmp_path / "figures").glob("statistics_programs*"))


def test_without_a_proven_interval_no_error_is_known(tmp_path: Path) -> None:
    text = made(tmp_path, programs({10**5: 0.1, 10**6: 0.005}, 1.0, proven=False))
    assert (
        row_of(text, "| hand")[2:] == ["—"] * 5
        and "Here: not tested" in text
        and "not enough" not in text.split("### Notes")[0]
    )
    assert not list((tmp_path / "figures").glob("statistics_programs*"))
