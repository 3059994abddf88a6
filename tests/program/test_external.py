"""Solver `external` runs any program, here a Python script; `export` writes the models that it
reads."""

from __future__ import annotations

import fcntl
import json
import os
import shlex
import shutil
import signal
import struct
import subprocess
import sys
from pathlib import Path
from typing import Any

import h5py
import pytest

from program import ROOT, Program
from test_run import wait_for

PEER = ROOT / "tests" / "program" / "external_peer.py"

EXPERIMENT = """\
title = "an outside program"
tolerances = [1.0]
of = "absolute"
repeats = 1
limits = {{ case_seconds = {limit}, memory_mb = 500 }}

[[scene]]
name = "moved"
source = "{source}"
target = "{target}"
motion = {{ kind = "translation", from = [0, 0, 0], to = [1, 0, 0], steps = 2, of = "absolute" }}

[[solver]]
name = "{other}"

[[solver]]
name = "external"
label = "peer"
[solver.parameters]
command = '''{python} {peer} {{A}} {{B}} {{tolerance}} {deed}'''
format = "{format}"
lower = '''{lower}'''
upper = '''{upper}'''
seconds = 'took (\\S+) ms'
seconds_unit = 1e-3
"""

DEFAULTS: dict[str, Any] = {
    "limit": 20,
    "source": "sphere1",
    "target": "sphere1",
    "other": "guthe",
    "python": shlex.quote(sys.executable),
    "peer": shlex.quote(str(PEER)),
    "deed": "",
    "format": "off",
    "lower": r"^h = ([-+0-9.eE]+)",
    "upper": r"at most (\S+)",
}


class Sweep:
    def __init__(self, hausbench: Program, folder: Path) -> None:
        self.hausbench, self.folder = hausbench, folder
        self.file = folder / "outside.toml"

    def write(self, **changes: Any) -> Path:
        self.file.write_text(EXPERIMENT.format(**{**DEFAULTS, **changes}))
        return self.file

    def __call__(self, code: int = 0, **changes: Any) -> dict[str, list[Any]]:
        """Runs the experiment. Returns the external program's columns by name, and the built-in
        solver's as "good ...". `code` is the expected exit code.
        """
        done = self.hausbench("run", self.write(**changes), "--results", self.folder, "--fresh")
        assert done.returncode == code, done.stderr
        with h5py.File(self.folder / "outside.h5") as f:
            ours = f["cases/label"].asstr()[:] == "peer"
            rows: dict[str, list[Any]] = {}
            for name, column in f["cases"].items():
                values = column.asstr()[:] if h5py.check_string_dtype(column.dtype) else column[:]
                rows[name] = list(values[ours])
                rows["good " + name] = list(values[~ours])
        return rows


@pytest.fixture
def sweep(hausbench: Program, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Sweep:
    temporary = tmp_path / "temporary"
    temporary.mkdir()
    monkeypatch.setenv("TMPDIR", str(temporary))
    return Sweep(hausbench, tmp_path)


def nothing_left(tmp_path: Path) -> bool:
    return list((tmp_path / "temporary").iterdir()) == []


@pytest.mark.parametrize("format", ["off", "obj"])
def test_meshes(sweep: Sweep, tmp_path: Path, format: str) -> None:
    rows = sweep(format=format, source="sphere1", target="sphere0")
    assert rows["status"] == ["ok", "ok"], rows["reason"]
    for lower, upper, low, high in zip(
        rows["lower"], rows["upper"], rows["good lower"], rows["good upper"]
    ):
        assert 0 < lower <= high and low <= upper
    # The program's own seconds are part of the time to a complete answer.
    for reported, whole in zip(rows["reported_seconds"], rows["solve_seconds"]):
        assert 0 < reported < whole
    assert rows["certified"] == [0, 0] and rows["lower_check"] == ["no witness"] * 2
    assert all(value != value for value in rows["good reported_seconds"])
    assert all(
        peak > 10e6 for peak in rows["peak_bytes"]
    )  # the Python interpreter's peak, not the worker's
    assert nothing_left(tmp_path)


def test_a_program_that_leaves_its_work_to_others_is_timed_by_wall(sweep: Sweep) -> None:
    """Like a client of a daemon or a GPU, the script sleeps much longer than it computes. Starting
    the interpreter takes 0.3 s, and more than 0.6 s beside other programs; a fifth of the wall time
    would count as work."""
    rows = sweep(deed="; sleep 6", limit=60)
    assert rows["status"] == ["ok", "ok"] and rows["clock"] == ["wall", "wall"], rows["reason"]
    assert rows["good clock"] == ["cpu", "cpu"]


def test_a_statistic(sweep: Sweep) -> None:
    """The expressions find the one statistic of the solver, here the mean over vertices, and the
    check agrees with it."""
    text = sweep.write(
        lower=r"mean of vertices (\S+)",
        upper=r"mean of vertices (\S+)",
        other="distribution",
        source="sphere1",
        target="sphere0",
    )
    statistic = 'quantity = "distribution"\nstatistics = ["mean"]\nweigh = "number"\n'
    text.write_text(
        text.read_text()
        .replace("repeats = 1\n", "repeats = 1\n" + statistic)
        .replace("tolerances = [1.0]", "tolerances = [1e-6]")
    )
    assert sweep.hausbench("run", text, "--results", sweep.folder, "--fresh").returncode == 0
    with h5py.File(sweep.folder / "outside.h5") as f:
        rows = {
            name: list(f[f"cases/{name}"].asstr()[:])
            for name in ("label", "status", "lower_check", "upper_check", "reason")
        }
        lower, upper = f["cases/lower"][:], f["cases/upper"][:]
    assert (
        rows["status"] == ["ok"] * 4 and rows["lower_check"] == rows["upper_check"] == ["holds"] * 4
    ), rows["reason"]
    for row, label in enumerate(rows["label"]):
        rivals = [i for i, name in enumerate(rows["label"]) if name != label]
        assert 0 < lower[row] and any(abs(lower[row] - lower[i]) <= 1e-6 for i in rivals), (
            label,
            lower,
            upper,
        )


def test_points(sweep: Sweep) -> None:
    rows = sweep(source="gaussian_1k_a", target="gaussian_1k_b", other="naive")
    assert rows["status"] == ["ok", "ok"], rows["reason"]
    assert rows["lower"] == pytest.approx(
        rows["good lower"], rel=1e-12
    )  # the input files have 17 digits
    assert rows["upper"] == pytest.approx(rows["good upper"], rel=1e-12)


def test_what_is_not_told_stays_open(sweep: Sweep) -> None:
    rows = sweep(upper="")
    assert rows["status"] == ["floor", "floor"] and "no upper bound" in rows["reason"][0]
    assert rows["upper"] == [float("inf")] * 2 and rows["lower"][1] > 0
    rows = sweep(lower="")
    assert rows["status"] == ["ok", "ok"] and rows["lower"] == [
        0.0,
        0.0,
    ]  # without a lower bound, [0, upper] is within the tolerance


def test_a_program_that_fails(sweep: Sweep) -> None:
    rows = sweep(deed="fail")
    assert rows["status"] == ["failed", "failed"]
    assert "exit code 3" in rows["reason"][0] and "the queue ran empty" in rows["reason"][0]
    rows = sweep(lower="the distance is (.*)")
    assert rows["status"] == ["failed", "failed"] and "'lower'" in rows["reason"][0]
    assert rows["good status"] == ["ok", "ok"]


def test_a_program_that_is_missing_is_found_before_anything_runs(
    sweep: Sweep, hausbench: Program
) -> None:
    for python, said in (
        ("no_such_program", "'no_such_program' is not in PATH"),
        ("./absent", "'./absent' does not exist"),
    ):
        rows = sweep(python=python)
        assert rows["status"] == ["skipped", "skipped"] and said in rows["reason"][0], rows[
            "reason"
        ]
        assert rows["good status"] == ["ok", "ok"]  # the other solver runs
        assert said in hausbench("explain", sweep.file).stdout


def test_a_program_that_changed_is_measured_again(
    sweep: Sweep, hausbench: Program, tmp_path: Path
) -> None:
    """The script's path is relative to the experiment, so the same bytes elsewhere are the same
    program."""
    home, elsewhere = tmp_path / "home", tmp_path / "elsewhere"
    (home / "tools").mkdir(parents=True)
    script = home / "tools" / "peer.py"
    script.write_text(PEER.read_text())
    sweep.file = home / "outside.toml"
    changes = {"python": f"env {sys.executable}", "peer": "./tools/peer.py"}

    def again() -> dict[str, list[Any]]:
        assert hausbench("run", sweep.write(**changes), "--results", tmp_path).returncode == 0
        with h5py.File(tmp_path / "outside.h5") as f:
            assert set(f["cases/status"].asstr()[:]) == {"ok"}, f["cases/reason"].asstr()[:]
            return {
                name: list(
                    f[f"cases/{name}"].asstr()[:]
                    if name != "solve_seconds"
                    else f["cases/solve_seconds"][:]
                )
                for name in ("label", "identity", "program_sha256", "solve_seconds")
            }

    first, second = again(), again()
    assert first == second
    peers = [label == "peer" for label in first["label"]]
    digits = [64 if peer else 0 for peer in peers]
    assert [len(hash) for hash in first["program_sha256"]] == digits
    shutil.copytree(home, elsewhere)
    sweep.file = elsewhere / "outside.toml"
    assert again()["identity"] == first["identity"]  # the identity contains no path
    sweep.file = home / "outside.toml"
    script.write_text(script.read_text() + "# changed\n")
    third = again()
    assert [a != b for a, b in zip(first["identity"], third["identity"])] == peers
    assert [a != b for a, b in zip(first["solve_seconds"], third["solve_seconds"])] == peers


def test_the_peers_of_this_project_run_wherever_it_is_called_from(
    hausbench: Program, tmp_path: Path
) -> None:
    experiment = ROOT / "experiments" / "points" / "points_speed.toml"
    done = hausbench(
        "run",
        experiment,
        "--scene",
        "overlapping_100K",
        "--solver",
        "scipy_ckdtree",
        "--results",
        tmp_path,
    )
    assert done.returncode == 0, done.stderr
    with h5py.File(tmp_path / "points_speed.h5") as f:
        assert list(f["cases/status"].asstr()[:]) == ["ok"], f["cases/reason"].asstr()[:]
        assert len(f["cases/program_sha256"].asstr()[0]) == 64


def test_measure_counts_from_the_current_folder(
    hausbench: Program, tetrahedron: Path, raised: Path, tmp_path: Path
) -> None:
    (tmp_path / "peer.py").write_text(PEER.read_text())
    done = hausbench(
        "measure",
        tetrahedron.name,
        raised.name,
        "--solver",
        "external",
        "--set",
        "lower=^h = ([-+0-9.eE]+)",
        "--set",
        f"command={sys.executable} ./peer.py {{A}} {{B}} 1",
        "--json",
    )
    assert done.returncode == 0 and json.loads(done.stdout)["lower"] == pytest.approx(
        0.25
    ), done.stdout


def test_bounds_of_no_distance_are_no_answer(sweep: Sweep) -> None:
    for deed in ("; echo h = inf; echo at most inf", "; echo at most -1"):
        rows = sweep(deed=deed, lower=r"^h = (\S+)")
        assert (
            rows["status"] == ["failed", "failed"]
            and "not an interval of distances" in rows["reason"][0]
        )


def test_a_program_that_lies(sweep: Sweep) -> None:
    rows = sweep(code=1, deed="lie")
    assert rows["status"][1] == "unsound" and rows["good status"] == ["ok", "ok"]


def gone(pid: int) -> bool:
    """Returns whether the process has ended, even if its parent has not waited for it yet. It may
    end at any moment."""
    try:
        os.kill(pid, 0)
        return Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] == "Z"
    except (ProcessLookupError, FileNotFoundError):
        return True


def wait_until_gone(pid_file: Path) -> None:
    """Waits for up to a minute; a process that was not killed would live for ten."""
    wait_for(lambda: gone(int(pid_file.read_text())))


def test_a_program_that_hangs_is_killed_in_time(sweep: Sweep, tmp_path: Path) -> None:
    rows = sweep(
        limit=1, deed=f"hang {tmp_path / 'pid'} | cat"
    )  # in a pipeline, the shell is not the only process to be killed
    assert rows["status"] == ["timeout", "timeout"]
    for reason in rows[
        "reason"
    ]:  # where the machine is busy, the worker of the case may be killed before it can say so itself
        assert (
            "the program did not end in time" in reason or "killed: no answer within 1 s" in reason
        )
    assert nothing_left(tmp_path)
    wait_until_gone(tmp_path / "pid")


def test_a_stray_signal_costs_one_case(sweep: Sweep, tmp_path: Path) -> None:
    """The script kills its worker, the shell's parent. Only that case is lost."""
    once = tmp_path / "once"
    rows = sweep(deed=f"; if mkdir {once} 2> /dev/null; then kill -TERM $PPID; sleep 600; fi")
    assert rows["status"] == ["signal", "ok"], rows["reason"]
    assert "signal 15" in rows["reason"][0] and rows["upper"][1] > 0
    assert nothing_left(tmp_path)


def test_nothing_outlives_a_case(sweep: Sweep, tmp_path: Path) -> None:
    left = tmp_path / "left"
    rows = sweep(
        deed=f"; rm -f {left}; setsid sh -c 'echo $$ > {left}; exec sleep 600' > /dev/null 2>&1 & while [ ! -s {left} ]; do sleep 0.01; done; echo"
    )
    assert rows["status"] == ["ok", "ok"], rows["reason"]
    wait_until_gone(left)


@pytest.mark.parametrize("verb", ["run", "measure"])
@pytest.mark.parametrize("end", [signal.SIGINT, signal.SIGKILL])
def test_nothing_outlives_the_program(
    sweep: Sweep,
    hausbench: Program,
    tetrahedron: Path,
    tmp_path: Path,
    verb: str,
    end: signal.Signals,
) -> None:
    pid = tmp_path / "pid"
    hang = f"sh -c 'echo $$ > {pid}; exec sleep 600'; echo {{A}} {{B}}"
    if verb == "run":
        arguments: list[str | Path] = [
            "run",
            sweep.write(python=hang + " #", limit=600),
            "--results",
            tmp_path,
            "--solver",
            "peer",
        ]
    else:
        arguments = [
            "measure",
            tetrahedron,
            tetrahedron,
            "--solver",
            "external",
            "--set",
            "lower=(.*)",
            "--set",
            "command=" + hang,
        ]
    process = subprocess.Popen(
        hausbench.command(*arguments),
        env=hausbench.environment(),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    wait_for(lambda: pid.exists() and pid.read_text().endswith("\n"))
    process.send_signal(end)
    assert process.wait(60) == (130 if (verb, end) == ("run", signal.SIGINT) else -end)
    wait_until_gone(pid)
    if end == signal.SIGKILL:  # the next run removes what is left
        assert hausbench("measure", tetrahedron, tetrahedron).returncode == 0
    assert nothing_left(tmp_path)


def test_daemons_end_with_a_run_that_is_killed(
    sweep: Sweep, hausbench: Program, tmp_path: Path
) -> None:
    """The daemon has left its session and lost its parent, so it cannot be found once the worker
    has ended."""
    pid = tmp_path / "pid"
    daemon = f"sh -c '(setsid sh -c \"echo \\$\\$ > {pid}; exec sleep 600\" &) ; exec sleep 600'; echo {{A}} {{B}}"
    arguments: list[str | Path] = [
        "run",
        sweep.write(python=daemon + " #", limit=600),
        "--results",
        tmp_path,
        "--solver",
        "peer",
    ]
    process = subprocess.Popen(
        hausbench.command(*arguments),
        env=hausbench.environment(),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    wait_for(lambda: pid.exists() and pid.read_text().endswith("\n"))
    process.kill()
    process.wait(60)
    wait_until_gone(pid)


def test_memory_of_the_program_counts(sweep: Sweep, tmp_path: Path) -> None:
    rows = sweep(deed=f"eat {tmp_path / 'pid'}; true")
    assert rows["status"] == ["out_of_memory", "out_of_memory"], rows["reason"]
    assert nothing_left(tmp_path)  # although the worker was killed
    wait_until_gone(tmp_path / "pid")


def test_what_a_killed_run_left_behind_goes_with_the_next(sweep: Sweep, tmp_path: Path) -> None:
    left = tmp_path / "temporary" / "hausbench-worker-abcdef"
    left.mkdir()
    (left / "B.off").write_text("OFF\n")
    held = tmp_path / "temporary" / "hausbench-worker-ghijkl"
    held.mkdir()
    other_run = os.open(held, os.O_RDONLY)
    fcntl.flock(other_run, fcntl.LOCK_EX)
    sweep()
    assert not left.exists() and held.exists()
    os.close(other_run)


def test_placeholders(sweep: Sweep, tmp_path: Path) -> None:
    seen = tmp_path / "seen"
    rows = sweep(deed=f"echo | tee -a {seen}")
    assert rows["status"] == ["ok", "ok"]
    words = [line.split() for line in seen.read_text().splitlines() if line.startswith("arguments")]
    for _, a, b, tolerance in words:
        assert a.endswith("A.off") and b.endswith("B.off") and float(tolerance) == 1.0
    assert not Path(words[0][1]).exists()


def test_parameters_are_checked_before_anything_runs(
    sweep: Sweep, hausbench: Program, tmp_path: Path, tetrahedron: Path
) -> None:
    for changes, said in (
        ({"lower": "h = ("}, "'lower'"),
        ({"upper": "no group"}, "one group"),
        ({"format": "stl"}, "off, obj"),
    ):
        line = hausbench.fails("run", sweep.write(**changes), "--results", tmp_path)
        assert "outside.toml" in line and said in line
    assert "'command'" in hausbench.fails(
        "measure", tetrahedron, tetrahedron, "--solver", "external"
    )
    assert "{B}" in hausbench.fails(
        "measure", tetrahedron, tetrahedron, "--solver", "external", "--set", "command=x {A}"
    )


# Numbers that are hard to print and read back: a denormal, values near both ends of the range, -0,
# and one that needs 17 digits.
NUMBERS = [
    1 / 3,
    5e-324,
    1.7e308,
    -2.5e-308,
    -0.0,
    0.1 + 0.2,
    1e23,
    -123456789.123456789,
    2.0**-1022,
]


def bits(values: list[float]) -> list[bytes]:
    return [struct.pack("<d", value) for value in values]


def numbers_of(file: Path) -> list[float]:
    """Returns the coordinates of a file that `export` wrote."""
    lines = file.read_text().splitlines()
    if file.suffix == ".obj":
        lines = [line[2:] for line in lines if line.startswith("v ")]
    elif file.suffix == ".ply":
        count = next(int(line.split()[2]) for line in lines if line.startswith("element vertex"))
        begin = lines.index("end_header") + 1
        lines = lines[begin : begin + count]
    else:
        lines = lines[2 : 2 + int(lines[1].split()[0])]
    return [float(word) for line in lines for word in line.split()]


@pytest.mark.parametrize("faces", ["3 0 1 2\n", ""])
def test_export_keeps_every_bit(hausbench: Program, tmp_path: Path, faces: str) -> None:
    file = tmp_path / "start.off"
    rows = ""
    for i in (0, 3, 6):
        rows += " ".join(f"{x:.17g}" for x in NUMBERS[i : i + 3]) + "\n"
    file.write_text(f"OFF\n3 {1 if faces else 0} 0\n{rows}{faces}")
    for name in (
        "one.obj",
        "two.ply",
        "three.off",
        "four.PLY",
        "five.off",
    ):  # each is converted from the previous one
        to = tmp_path / name
        done = hausbench("export", file, to)
        assert done.returncode == 0, done.stderr
        assert ("1 triangles" if faces else "3 points") in done.stdout
        file = to
    assert bits(numbers_of(file)) == bits(NUMBERS)
    assert ("3 0 1 2" in file.read_text()) == bool(faces)


def test_export_prints_the_notes_of_the_reader(hausbench: Program, tmp_path: Path) -> None:
    file = tmp_path / "a.obj"
    file.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nl 1 2\nodd 1\n")
    done = hausbench("export", file, tmp_path / "a.off")
    assert done.returncode == 0 and "2 triangles, 3 vertices, 1 line segment\n" in done.stdout
    assert (
        f"note       {file}: a line with an unknown keyword, 'odd' in line 6, was left out\n"
        in done.stdout
    )
    scene = tmp_path / "a.wrl"
    scene.write_text(
        "#VRML V2.0 utf8\nShape { geometry PointSet { coord Coordinate { point [ 0 0 1 ] } } }"
    )
    done = hausbench("export", scene, tmp_path / "a.ply")
    assert f"note       {scene}: is in m, which the written file does not state\n" in done.stdout
    assert f"note       {scene}: Y points up" in done.stdout
    assert "is in m" not in hausbench("export", scene, tmp_path / "b.ply", "--unit", "none").stdout
    assert "note  " not in hausbench("export", tmp_path / "a.off", tmp_path / "a.ply").stdout


def test_export_of_a_model_is_the_model(hausbench: Program, tmp_path: Path) -> None:
    written = tmp_path / "sphere.ply"
    assert hausbench("export", "sphere2", written).returncode == 0
    again = tmp_path / "sphere.off"
    assert hausbench("export", written, again).returncode == 0
    once_more = tmp_path / "direct.off"
    assert hausbench("export", "sphere2", once_more).returncode == 0
    assert again.read_bytes() == once_more.read_bytes()
    assert "sphere2" in hausbench.fails("export", "sphree2", tmp_path / "x.off")
    assert ".off, .obj and .ply" in hausbench.fails("export", "sphere2", tmp_path / "x.stl")
    assert "cannot be written" in hausbench.fails(
        "export", "sphere2", tmp_path / "absent" / "x.off"
    )
