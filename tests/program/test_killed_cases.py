"""A case that is killed at its time limit keeps the last bounds that its solver had proven."""

from pathlib import Path

import h5py
import pytest
from program import Program, head


def test_a_killed_case_keeps_its_last_bounds(
    hausbench: Program, plugin: Path, tmp_path: Path
) -> None:
    """never_returns shows half of the lower and twice the upper bound, without end."""
    experiment = tmp_path / "killed.toml"
    experiment.write_text(head(0.6) + '\n[[solver]]\nname = "never_returns"\n')
    done = hausbench("run", experiment, "--results", tmp_path, "--plugin", plugin)
    assert done.returncode == 0, done.stderr
    with h5py.File(tmp_path / "killed.h5") as file:
        cases = file["cases"]
        last = (cases["solver"].asstr()[:] == "never_returns") & (cases["pose_index"][:] == 3)
        (status,) = cases["status"].asstr()[last]
        (reason,) = cases["reason"].asstr()[last]
        (lower,) = cases["lower"][last]
        (upper,) = cases["upper"][last]
    assert status == "timeout"
    assert reason.startswith("killed: no answer within 0.6 s")
    assert reason.endswith("its last bounds before are kept")
    assert 0 < lower and upper == pytest.approx(4 * lower)
