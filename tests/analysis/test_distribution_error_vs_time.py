"""The table, verdict and figure of `distribution_error_vs_time`."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest
from stem_runner import Make, stem_runner
from synthetic import ResultFile, spread


@pytest.fixture()
def make(tmp_path: Path) -> Make:
    return stem_runner(tmp_path)


def statistics(
    finest: float = 1e-4, times: float = 100.0, rounds: int = 7, ends: int = 4
) -> ResultFile:
    """Two pairs of meshes. `distribution` takes 1, 2, ... ms, one more at each finer tolerance.
    Monte Carlo takes 0.1 ms at 0.1, then ten times as much at each, and at its last, number `ends`,
    `times` as long as `distribution` at the finest.
    """
    file = ResultFile("distribution_error_vs_time", meta={"profile": "paper"})
    for pair, slower in (("hand", 1.0), ("bull", 2.0)):
        for statistic, value in (("mean", 0.01), ("quantile 0.95", 0.03)):
            for k, tolerance in enumerate((1e-1, 1e-2, 1e-3, finest)):
                common: dict[str, Any] = {
                    "quantity": "distribution",
                    "statistic": statistic,
                    "tolerance": tolerance,
                    "tolerance_of": "lower",
                    "source": f"{pair}/A",
                    "target": f"{pair}/B",
                    "prepare_seconds": 0.0,
                }
                file.case(
                    "distribution",
                    pair,
                    spread(0.001 * (k + 1) * slower, rounds),
                    lower=value * (1 - tolerance / 2),
                    upper=value * (1 + tolerance / 2),
                    extras=f'{{"pieces": {1000 * (k + 1)}}}',
                    **common,
                )
                if k >= ends:
                    continue
                rival = 0.0001 * 10**k if k < ends - 1 else times * 0.004
                file.case(
                    "monte_carlo",
                    pair,
                    spread(rival * slower, rounds),
                    lower=value * (1 - tolerance / 2),
                    upper=value * (1 + tolerance / 2),
                    certified=0,
                    extras=f'{{"samples": {10**(k + 3)}}}',
                    **common,
                )
    return file


def test_cells(make: Make) -> None:
    records, rows, text = make(statistics())
    first = rows["hand"][0]
    assert first[:3] == ["mean", "0.0100", "0.1"] and first[4] == "1,000" and first[6] == "1,000"
    assert first[3].startswith("0.900 [") and first[5].startswith(
        "0.0900 ["
    )  # CPU time is 0.9 of the wall time
    assert [row[0] for row in rows["hand"]] == ["mean", "95 % quantile"]
    assert first[7].startswith("0.100") and len(records) == 2 * 2 * 4 * 2
    record = next(
        r
        for r in records
        if r["pair"] == "bull" and r["solver"] == "monte_carlo" and r["tolerance"] == "0.01"
    )
    assert (
        float(record["relative_width"]) == pytest.approx(0.01) and float(record["samples"]) == 10000
    )
    # Times by tolerance: 1, 2, 3, 4 ms and 0.1, 1, 10, 400 ms. They cross between 0.01 (ratio 0.5)
    # and 0.001 (ratio 3.3).
    assert (
        "Relative widths at which both take the same time (geometric mean over pairs): mean: 0.0043; 95 % quantile: 0.0043."
        in text
    )


@pytest.mark.parametrize(
    ("times", "said"),
    [(100.0, "Here it holds"), (2.0, "Here it does not hold"), (5.0, "Here: not separated")],
)
def test_verdict(make: Make, times: float, said: str) -> None:
    text = make(statistics(times=times))[2]
    assert said in text and "over 2 pairs" in text


def test_no_verdict_without_the_width(make: Make) -> None:
    assert "Here: not tested (no pair answered at 0.0001)" in make(statistics(finest=3e-4))[2]


@pytest.mark.parametrize(
    ("times", "said"), [(30.0, "Here it holds (at least"), (4.0, "Here: not separated (at least")]
)
def test_a_wider_interval_is_a_lower_bound(make: Make, times: float, said: str) -> None:
    text = make(statistics(times=times, ends=3))[2]
    assert said in text and "Monte Carlo was run to a width of 0.001" in text
    # From 1 ms at 0.01 to 4 times `times` ms at 0.001; at 0.0001 that factor again. `distribution`
    # takes 4 ms there.
    power, factor = -math.log10(4 * times), 4 * times * times
    assert (
        f"grows like width^{power:.2f} to width^{power:.2f}. Extrapolated to a width of 0.0001, it takes the mean about {factor:.0f} times as long"
        in text
    )
    assert "Extrapolated to a width" not in make(statistics())[2]


@pytest.mark.parametrize(
    ("power", "noise", "said"),
    [
        (-2.0, 0.0, "holds (below for 2 of 2"),
        (-0.5, 0.0, "does not hold (below for 0 of 2 pairs, above for 2"),
        (-1.0, 0.5, "not separated (below for 0 of 2 pairs, above for 0"),
    ],
)
def test_slopes(make: Make, power: float, noise: float, said: str) -> None:
    file = statistics()
    for case in file.cases:
        if case["solver"] == "distribution":
            k = round(-math.log10(case["tolerance"]))
            case[
                "extras"
            ] = f'{{"pieces": {round(1000 * (case["tolerance"] * (1 + noise * (k % 2)))**(1 / power))}}}'
    text = make(file)[2]
    assert said in text and f"slopes {power:.2f} to {power:.2f}" in text or noise


@pytest.mark.parametrize(("power", "fine"), [(-2.0, 1e-4), (-4.0, 1e-4), (-2.0, 1e-5)])
def test_the_time_of_samples_is_extrapolated(make: Make, power: float, fine: float) -> None:
    """With a gap of 0.003, or 0.3 times the mean, they take 2.4 s. A time limit makes a row
    useless, and so does a mean of 0."""
    file = statistics(fine)
    nothing: dict[str, Any] = {"lower": 0.0, "upper": 0.0, "tolerance_of": "lower"}
    file.case(
        "distribution",
        "same",
        spread(0.001, 7),
        quantity="distribution",
        statistic="mean",
        tolerance=fine,
        prepare_seconds=0.0,
        **nothing,
    )
    for gap in (0.03, 0.01, 0.003):
        file.case(
            "sampling",
            "same",
            spread(1.0, 7),
            options={"step": gap},
            lower=0.0,
            upper=gap,
            tolerance=1.0,
            tolerance_of="lower",
        )
    file.case(
        "sampling",
        "hand",
        spread(9.0, 7),
        options={"step": 1e-3},
        lower=0.1,
        upper=0.101,
        tolerance=1.0,
        tolerance_of="lower",
        status="timeout",
    )
    for pair, slower in (("hand", 1.0), ("bull", 2.0)):
        for gap in (0.03, 0.01, 0.003):
            file.case(
                "sampling",
                pair,
                spread(2.4 * slower * (gap / 0.003) ** power, 7),
                options={"step": gap},
                lower=0.1,
                upper=0.1 + gap,
                tolerance=1.0,
                tolerance_of="lower",
            )
    records, rows, text = make(file)
    factor = 2.4 * (fine / 0.3) ** power / 0.004
    assert (
        f"its time grows like radius^{power:.2f} to radius^{power:.2f}. Extrapolated to a radius of {fine:g} times the mean"
        in text
    )
    assert (
        f"about {factor:.0e} times as long as distribution takes for a width of {fine:g} (geometric mean over 2 pairs; {factor:.0e} to {factor:.0e})"
        in text
    )
    assert {row[2] for row in rows["hand"]} <= {
        "0.1",
        "0.01",
        "0.001",
        "0.0001",
        "1e-5",
    }  # they have no row in the table
    assert {record["solver"] for record in records} == {"distribution", "monte_carlo"}
    assert "covering radius" not in make(statistics())[2]


def test_pairs_without_an_answer_are_counted(make: Make) -> None:
    file = statistics()
    row = next(
        case
        for case in file.cases
        if case["solver"] == "distribution"
        and case["scene"] == "bull"
        and case["tolerance"] == 1e-4
        and case["statistic"] == "mean"
    )
    row["status"] = "timeout"
    text = make(file)[2]
    assert "over 1 pairs; no ratio for 1 that one of them did not answer" in text
