"""The remaining time that `hausbench run` prints."""

from __future__ import annotations

import re
from pathlib import Path

from program import Program

EXPERIMENT = """title = "The longest last"
tolerances = [1e-3]
of = "diagonal"
repeats = 0

[[scene]]
name = "clouds {}"
severity = [1000, 1100, 1200, 60000]
source = { recipe = "gaussian_points", count = "{}", seed = 1, sigma = 1, x = 0, y = 0, z = 0 }
target = { recipe = "gaussian_points", count = "{}", seed = 2, sigma = 1, x = 0, y = 0, z = 0 }

[[solver]]
name = "naive"
"""


def seconds_left(said: str) -> dict[int, int]:
    """Returns the printed seconds left, by number of finished cases."""
    matches = re.findall(r"^\[(\d)/4\] \d+:\d\d, about (\d+):(\d\d) left", said, re.MULTILINE)
    return {int(done): 60 * int(minutes) + int(seconds) for done, minutes, seconds in matches}


def test_short_cases_promise_no_short_run(hausbench: Program, tmp_path: Path) -> None:
    """The last case takes a thousand times the work of all others. Cases kept from an earlier run
    must not lower its estimate."""
    experiment = tmp_path / "longest_last.toml"
    experiment.write_text(EXPERIMENT)
    assert seconds_left(hausbench("run", experiment, "--results", tmp_path).stderr)[3] >= 1
    assert (
        seconds_left(hausbench("run", experiment, "--results", tmp_path, "--fresh").stderr)[3] >= 1
    )
    experiment.write_text(EXPERIMENT.replace("1000, 1100", "1001, 1101"))
    assert (
        seconds_left(hausbench("run", experiment, "--results", tmp_path).stderr)[1] == 0
    ), "the long one is finished"
