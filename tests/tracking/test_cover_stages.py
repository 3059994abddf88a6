"""The table of stages that bench/cover_stages.py writes into cover.md."""

from __future__ import annotations

from bench.cover_stages import BEGIN, END, PAGE, STAGES, Regime, table


def test_the_table_divides_by_the_triangles_and_by_the_floor() -> None:
    seconds = {stage: [1e-6 * k, 2e-6 * k, 3e-6 * k] for k, stage in enumerate(STAGES)}
    floor = {
        "floor/a:b": 2e-9,
        "page/one_by_one": 2e-6,
        "page/huge": 3e-7,
        "page/touch_pages": 4e-7,
    }
    made = table(
        {"near": Regime("a", "b", 1000, seconds, [1.5, 1.25, 2.0])}, floor, "a processor", 3
    )
    cells = [cell.strip() for cell in made.splitlines()[-1].split("|")[1:-1]]
    assert (
        cells[:4] == ["near", "a → b", "1,000", "0"] and cells[4] == "2.00"
    )  # ns: the median of the second stage, 2 µs, over 1,000 triangles
    assert cells[-4:] == ["42.0", "2.00", "21", "1.50"]
    assert "costs 2.0 µs here, 0.30 µs as a part of a huge page, and 0.40 µs by" in made


def test_the_page_has_a_place_for_the_table() -> None:
    assert PAGE.read_text(encoding="utf-8").split(BEGIN)[1].count(END) == 1
