"""Tests the table that compares kernels."""

import pytest

from bench.report import COLUMNS, read, report, verdict

CSV = f"""# machine: a computer
{",".join(COLUMNS)}
build,bunny,BVH,1000,170,1,1,1,12,95000,0
build,bunny,Embree,1000,290,1.7,1.6,1.8,12,60000,0
build,bunny,CGAL,1000,380,1.01,0.9,1.1,12,0,0
query,hare to bunny,BVH,50,400,1,1,1,12,0,0
query,hare to bunny,Embree,50,800,2,1.9,2.1,12,0,3.1e-08
"""


def test_each_part_has_its_table_and_no_row_is_lost() -> None:
    remarks, rows = read(CSV.splitlines(keepends=True))
    assert remarks == ["machine: a computer"]
    assert len(rows) == 5
    text = report(remarks, rows)
    assert "- machine: a computer" in text
    assert "| bunny | 1000 | BVH | 170 | 1 | 95.0 |" in text
    assert "|  |  | Embree | 290 | 1.70 [1.60, 1.80] | 60.0 |" in text
    assert "1.01 [0.90, 1.10] (not separated) | — |" in text
    assert "|  |  | Embree | 800 | 2.00 [1.90, 2.10] | 3.1e-8 |" in text
    assert "What certification costs" not in text  # no rows, no table


def test_a_claim_is_judged_by_the_worse_end_on_every_scene() -> None:
    _, rows = read(CSV.splitlines(keepends=True))
    assert verdict(rows, "x", "build", "Embree", 1.5, True) == "- x: holds (ratios 1.70 to 1.70)"
    assert (
        verdict(rows, "x", "build", "Embree", 1.65, True)
        == "- x: holds on 0 of 1 scenes (ratios 1.70 to 1.70)"
    )
    assert verdict(rows, "x", "build", "Embree", 1.85, False) == "- x: holds (ratios 1.70 to 1.70)"
    assert (
        verdict(rows, "x", "build", "Embree", 1.75, False)
        == "- x: holds on 0 of 1 scenes (ratios 1.70 to 1.70)"
    )
    assert verdict(rows, "x", "certification", "guthe", 1.2, False) == "- x: not measured"


def test_what_is_no_such_file_is_refused() -> None:
    with pytest.raises((KeyError, ValueError)):
        read(["a,b\n", "1,2\n"])
