"""The models of experiment `cliffs` can be made, and its plan lists the solvers of each scene."""

from __future__ import annotations

from pathlib import Path

from program import Program

EXPERIMENT = Path(__file__).resolve().parents[2] / "experiments" / "speed" / "cliffs.toml"


def test_explain_makes_the_models_and_plans_every_pose(hausbench: Program, tmp_path: Path) -> None:
    scenes = ("mesh_stray_in_A_1e12", "points_two_clusters_1e06", "needle_1e12", "points_away")
    chosen = [word for scene in scenes for word in ("--scene", scene)]
    done = hausbench("explain", EXPERIMENT, "--results", tmp_path, *chosen)
    assert done.returncode == 0, done.stderr
    models = {
        line.split()[0]: " ".join(line.split()[1:])
        for line in done.stdout.splitlines()
        if line.startswith("  cliffs_")
    }
    assert models["cliffs_mesh_stray_1e12"] == "4097 triangles, diagonal 1e+12"
    assert models["cliffs_points_two_1e06"] == "8000 points, diagonal 1e+06"
    assert models["cliffs_needle_1e12"] == "1 triangles, diagonal 1"
    # Eleven solvers on four scenes, one of which has seven poses, plus a variant on one scene. The
    # two solvers of surfaces run on other scenes.
    assert "111 cases asked for" in done.stdout
