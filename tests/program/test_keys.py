"""`hausbench list keys` lists keys of experiment files, recipes and operations, as text and as
JSON."""

from __future__ import annotations

import json

from program import Program


def test_text_and_json_name_the_same_keys(hausbench: Program) -> None:
    text = hausbench("list", "keys").stdout
    listed = json.loads(hausbench("list", "keys", "--json").stdout)
    names = [key["name"] for table in listed["tables"] for key in table["keys"]]
    for group in ("recipes", "operations"):
        assert len(listed[group]) > 10
        for made in listed[group]:
            assert made["meaning"], made["name"]
            names += [made["name"], *(number["name"] for number in made["numbers"])]
    assert {
        "tolerances",
        "case_seconds",
        "target_motion",
        "degrees",
        "warm",
        "faster_than",
        "icosphere",
        "simplify",
        "ratio",
    } <= set(names)
    assert [name for name in names if name not in text] == []


def test_an_unlisted_key_is_refused_with_the_nearest_one(hausbench: Program) -> None:
    (hausbench.folder / "own.toml").write_text('title = "t"\ntolerance = [0.01]\n')
    message = hausbench.fails("explain", "own.toml")
    assert "own.toml:2: unknown key 'tolerance'" in message and "'tolerances'" in message
