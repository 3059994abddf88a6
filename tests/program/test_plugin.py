"""Plug-in solvers: a project built against an installed hausbench, and solvers that crash, hang,
exhaust memory or return nonsense."""

from __future__ import annotations

import json
import math
import os
import pty
import re
import select
import shutil
import signal
import subprocess
import sysconfig
from pathlib import Path
from typing import Any

import h5py
import pytest

from program import RECIPE, SOURCES, Program, built, head
from test_run import wait_for


def compiled(results: Path) -> dict[str, str]:
    """Returns how each plug-in of a result was compiled, by file name."""
    with h5py.File(results) as f:
        return {
            plugin["file"]: plugin["compiled"] for plugin in json.loads(f["meta"].attrs["plugins"])
        }


def test_the_documented_recipe_runs_at_full_speed(
    hausbench: Program, outside: Path, plugin: Path, tmp_path: Path
) -> None:
    commands = [
        entry["command"].split()
        for entry in json.loads((outside / "compile_commands.json").read_text())
    ]
    with_hausbench = [words for words in commands if not words[-1].endswith("of_another_time.cpp")]
    assert len(with_hausbench) == 6
    for words in with_hausbench:
        assert "-O3" in words and "-DNDEBUG" in words and "-ffp-contract=off" in words
    experiment = tmp_path / "quick.toml"
    experiment.write_text(head() + '[[solver]]\nname = "vertex_only"\n')
    done = hausbench("run", experiment, "--results", tmp_path, "--plugin", plugin, "--quiet")
    assert done.returncode == 0 and all(
        "were tried little" in line for line in done.stderr.splitlines()
    )  # no warning about a slow build
    how = compiled(tmp_path / "quick.h5")
    assert set(how) == {"libmisbehaving.so"} and how["libmisbehaving.so"].startswith(
        "optimized, no assertions, GCC "
    )


def test_code_for_an_earlier_interface_is_told_what_to_write(outside: Path, tmp_path: Path) -> None:
    commands = [
        entry["command"].split()
        for entry in json.loads((outside / "compile_commands.json").read_text())
    ]
    words = next(words for words in commands if words[-1].endswith("misbehaving.cpp"))
    flags = words[1 : words.index("-o")]
    source = tmp_path / "earlier.cpp"
    for line, text in (
        (" info.traces = true;", "since plug-in interface 11 this is an ability: info.abilities ="),
        ("", ""),
    ):
        source.write_text(
            f"#include <hausbench/plugin.h>\nvoid declare(hausbench::SolverInfo& info) {{ info.paper.clear();{line} }}\n"
        )
        done = subprocess.run(
            [words[0], *flags, "-fsyntax-only", source], capture_output=True, text=True
        )
        assert (done.returncode == 0) == (line == "") and text in done.stderr, done.stderr


def test_a_plugin_that_is_not_optimized_is_said_to_be_so(
    hausbench: Program,
    outside: Path,
    tetrahedron: Path,
    raised: Path,
    experiment: Path,
    tmp_path: Path,
) -> None:
    # The author's compiler flags are kept.
    built(
        [
            *RECIPE,
            f"-DCMAKE_PREFIX_PATH={outside.parent / 'installed'}",
            "-DCMAKE_BUILD_TYPE=Debug",
            "-S",
            str(SOURCES),
            "-B",
            str(tmp_path / "debug"),
        ],
        tmp_path,
    )
    built(["cmake", "--build", "debug", "--target", "with_octree"], tmp_path)
    slow = tmp_path / "debug" / "libwith_octree.so"
    experiment.write_text(experiment.read_text().replace("guthe", "with_octree"))
    every_verb: list[list[str | Path]] = [
        ["list"],
        ["explain", experiment],
        ["measure", tetrahedron, raised, "--solver", "with_octree"],
        ["run", experiment, "--results", tmp_path, "--quiet"],
    ]
    for arguments in every_verb:
        done = hausbench(*arguments, "--plugin", slow)
        assert done.returncode == 0, done.stderr
        (line,) = done.stderr.splitlines()
        assert (
            "libwith_octree.so: is not optimized" in line and "-DCMAKE_BUILD_TYPE=Release" in line
        )
    assert compiled(tmp_path / "tiny.h5")["libwith_octree.so"].startswith(
        "not optimized, assertions, GCC "
    )


def test_an_installed_program_knows_its_commit(
    program_file: str, outside: Path, experiment: Path, tmp_path: Path
) -> None:
    built_from = json.loads((Path(program_file).parent / "commit.json").read_text())
    assert len(built_from["commit"]) == 40 or built_from["commit"] == "unknown"
    installed = Program(str(outside.parent / "installed" / "bin" / "hausbench"), tmp_path)
    assert installed("run", experiment, "--results", tmp_path).returncode == 0
    with h5py.File(tmp_path / "tiny.h5") as f:
        assert (f["meta"].attrs["commit"], f["meta"].attrs["dirty"]) == (
            built_from["commit"],
            built_from["dirty"],
        )


# A fault of the plug-in's declaration -> the error, wherever the plug-in is loaded.
DECLARED = {
    "no name": "without a name",
    "known name": "'guthe' exists already",
    "no title": "title is empty",
    "no target": "no shape as target",
    "unknown paper": "'zhang2071' is not a key of papers.bib (did you mean 'zhang2017'?)",
    "wrong and certified": "never certified",
    "parameter twice": "parameter 'how' twice",
    "default is no choice": "'well' is not one of its choices",
    "default outside": "the default 9 is outside",
    "reads what is not declared": "reads undeclared parameter 'hidden'",
    "reads another type": "reads parameter 'how' as another type",
    "leaves unread": "does not read its parameter 'how'",
    "throws at once": "its constructor throws something that is not a std::exception",
    "returns nothing": "returns no solver",
}


@pytest.mark.parametrize("how", DECLARED)
def test_a_plugin_that_breaks_its_contract_is_found_by_every_verb(
    hausbench: Program,
    outside: Path,
    tetrahedron: Path,
    experiment: Path,
    monkeypatch: pytest.MonkeyPatch,
    how: str,
) -> None:
    plugin = outside / "libbroken.so"
    experiment.write_text(experiment.read_text().replace("guthe", "broken"))
    assert hausbench("explain", experiment, "--plugin", plugin).returncode == 0
    monkeypatch.setenv("BROKEN", how)
    every_verb: list[list[str | Path]] = [
        ["list"],
        ["explain", experiment],
        ["run", experiment],
        ["measure", tetrahedron, tetrahedron],
    ]
    for arguments in every_verb:
        line = hausbench.fails(*arguments, "--plugin", plugin)
        assert "libbroken.so: " in line and DECLARED[how] in line and "internal error" not in line
        assert "solver 'broken'" in line or "name" in how


def test_what_a_plugin_must_not_do_with_a_scene_is_its_own_error(
    hausbench: Program,
    outside: Path,
    tetrahedron: Path,
    experiment: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    plugin = outside / "libbroken.so"
    experiment.write_text(experiment.read_text().replace("guthe", "broken"))
    for how, said in (
        ("needs more", "needs a target octree that is not in may_need"),
        ("uses more", "prepare() throws: "),
        ("throws", "threw: too hard"),
    ):
        monkeypatch.setenv("BROKEN", how)
        done = hausbench(
            "measure", tetrahedron, tetrahedron, "--solver", "broken", "--plugin", plugin
        )
        of_plugin = (
            "solver 'broken' gave no answer: the solver "
            if how == "throws"
            else "libbroken.so: solver 'broken' "
        )
        assert (
            done.returncode == (1 if how == "throws" else 2) and of_plugin + said in done.stderr
        ), done.stderr
        assert "internal error" not in done.stderr
        if how == "needs more":
            line = hausbench.fails("explain", experiment, "--plugin", plugin)
            assert "libbroken.so: solver 'broken' " + said in line
        assert (
            hausbench(
                "run", experiment, "--results", tmp_path, "--fresh", "--plugin", plugin
            ).returncode
            == 0
        )
        (row,) = rows_of(tmp_path / "tiny.h5")["broken"]
        assert row["status"] == "failed" and "internal error" not in row["reason"]
        assert said in row["reason"]


def test_bounds_that_no_distance_can_have_are_no_answer(
    hausbench: Program, outside: Path, tetrahedron: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    arguments = (
        "measure",
        tetrahedron,
        tetrahedron,
        "--solver",
        "broken",
        "--plugin",
        outside / "libbroken.so",
    )
    for how in ("no number", "infinite", "negative"):
        monkeypatch.setenv("BROKEN", how)
        for more, code in (((), 1), (("--symmetric",), 1), (("--cutoff", "0.5"), 3)):
            done = hausbench(*arguments, *more)
            assert done.returncode == code, (how, more, done.stdout)
            assert "are not an interval of distances" in done.stderr + done.stdout
            assert ", converged" not in done.stdout.replace(
                "reports converged", ""
            ) and "below_floor" not in done.stdout.replace("reports below_floor", "")
            if code == 3:
                assert "may be above or below 0.5" in done.stdout


def test_rows_that_end_at_the_budget_are_timed(
    hausbench: Program, plugin: Path, tmp_path: Path
) -> None:
    experiment = tmp_path / "wide.toml"
    text = (
        head()
        .replace("[2.0]", "[1e-9]")
        .replace("guthe", "vertex_only")
        .replace('source = "sphere1"', 'source = "sphere0"')
        .replace("to = [3, 0, 0], steps = 4", "to = [1, 0, 0], steps = 2")
    )
    for repeats in (2, 3):  # more repeats than were kept, so they are measured
        experiment.write_text(text.replace("repeats = 1", f"repeats = {repeats}\nrounds = 2"))
        assert (
            hausbench("run", experiment, "--results", tmp_path, "--plugin", plugin).returncode == 0
        )
        with h5py.File(tmp_path / "wide.h5") as f:
            assert set(f["cases/status"].asstr()[:]) == {"budget"}
            assert sorted(f["repeats/case"][:]) == sorted(2 * repeats * [0, 1])


def test_list_shows_the_plugins_solvers(hausbench: Program, plugin: Path) -> None:
    done = hausbench("list", "--json", "--plugin", plugin)
    assert done.returncode == 0, done.stderr
    solvers = {solver["name"]: solver for solver in json.loads(done.stdout)["solvers"]}
    assert solvers["vertex_only"]["certified"] and not solvers["lies"]["certified"]
    assert solvers["throws"]["parameters"][1]["choices"] == ["an exception", "a number"]
    assert "vertex_only" not in {
        solver["name"] for solver in json.loads(hausbench("list", "--json").stdout)["solvers"]
    }


def test_measure_with_a_plugin(
    hausbench: Program, plugin: Path, tetrahedron: Path, raised: Path
) -> None:
    done = hausbench(
        "measure", tetrahedron, raised, "--solver", "vertex_only", "--json", "--plugin", plugin
    )
    assert done.returncode == 0, done.stderr
    answer = json.loads(done.stdout)
    # The lower face is 0.25 below the raised tetrahedron; both solvers' intervals contain that
    # distance.
    assert answer["lower"] == pytest.approx(0.25) and answer["upper"] >= answer["lower"]
    guthe = json.loads(
        hausbench("measure", tetrahedron, raised, "--solver", "guthe", "--json").stdout
    )
    assert answer["lower"] <= guthe["upper"] and guthe["lower"] <= answer["upper"]
    line = hausbench.fails("measure", tetrahedron, raised, "--solver", "vertex_only")
    assert "'vertex_only'" in line and "--plugin" in line


@pytest.mark.parametrize(
    ("solver", "status", "said"),
    [
        (
            "hangs",
            "timeout",
            "killed: it did not answer within the time limit of 0.3 s and 1 s of grace",
        ),
        ("never_ready", "timeout", "killed: it was not prepared within the time limit of 0.3 s"),
        ("leaves", "failed", "its process ended with exit code 0 before it answered"),
        ("crashes", "signal", "its process ended with signal 11"),
    ],
)
def test_measure_survives_its_solver(
    hausbench: Program,
    plugin: Path,
    tetrahedron: Path,
    raised: Path,
    solver: str,
    status: str,
    said: str,
) -> None:
    at = () if solver == "never_ready" else ("--set", "at=0")
    ask: tuple[str | Path, ...] = (
        "measure",
        tetrahedron,
        raised,
        "--solver",
        solver,
        *at,
        "--time-limit",
        "0.3",
        "--plugin",
        plugin,
    )
    done = hausbench(*ask, "--json")
    assert (
        done.returncode == 1 and f"solver '{solver}' gave no answer: {said}" in done.stderr
    ), done.stderr
    answer = json.loads(done.stdout)
    assert answer["status"] == status and said in answer["note"] and answer["solver"] == solver
    assert (
        answer["lower"] == 0
        and answer["upper"] == "inf"
        and answer["source_point"] is None
        and answer["directions"] == []
    )
    person = hausbench(*ask, "--cutoff", "0.1")
    assert (
        person.returncode == 3 and f"no answer: {said}" in person.stdout
    )  # exit code 3: the question has no answer


def test_the_last_bounds_of_a_solver_outlive_it(
    hausbench: Program, plugin: Path, tetrahedron: Path, raised: Path
) -> None:
    """The raised tetrahedron is 0.25 away; the solver shows half of the lower and twice the upper
    bound, and never returns."""
    ask: tuple[str | Path, ...] = (
        "measure",
        tetrahedron,
        raised,
        "--solver",
        "never_returns",
        "--time-limit",
        "0.5",
        "--plugin",
        plugin,
    )
    for more, lower, upper in (((), 0.125, 0.5), (("--symmetric",), 0.125, math.inf)):
        done = hausbench(*ask, *more, "--json")
        answer = json.loads(done.stdout)
        assert done.returncode == 0 and answer["status"] == "time_limit", done.stderr
        assert (
            "killed: it did not answer within the time limit of 0.5 s" in answer["note"]
            and "these are its bounds after" in answer["note"]
        )
        assert answer["lower"] == pytest.approx(lower) and float(answer["upper"]) == pytest.approx(
            upper
        )
    decided = hausbench(*ask, "--cutoff", "0.1")
    assert decided.returncode == 1 and "is above 0.1" in decided.stdout, decided.stdout
    certificate = hausbench(*ask, "--fields", plugin.parent / "never.vtk", "--json")
    assert certificate.returncode == 1 and json.loads(certificate.stdout)["lower"] == pytest.approx(
        0.125
    )


def test_the_direction_that_was_answered_counts_if_the_other_is_not(
    hausbench: Program, plugin: Path, tetrahedron: Path, raised: Path
) -> None:
    done = hausbench(
        "measure",
        tetrahedron,
        raised,
        "--solver",
        "answers_once",
        "--symmetric",
        "--time-limit",
        "0.2",
        "--plugin",
        plugin,
        "--json",
    )
    answer = json.loads(done.stdout)
    assert done.returncode == 0 and answer["status"] == "time_limit", done.stderr
    assert answer["lower"] == pytest.approx(0.25) and float(answer["upper"]) == math.inf


def test_a_solver_that_never_stops_showing_bounds_is_killed(
    hausbench: Program, plugin: Path, tetrahedron: Path, raised: Path
) -> None:
    """Five seconds after the limit and its grace. Bounds that are no interval are left out."""
    done = hausbench(
        "measure",
        tetrahedron,
        raised,
        "--solver",
        "floods",
        "--time-limit",
        "0.2",
        "--plugin",
        plugin,
        "--json",
        timeout=60,
    )
    answer = json.loads(done.stdout)
    assert done.returncode == 0 and answer["status"] == "time_limit", done.stderr
    assert answer["lower"] == pytest.approx(0.125) and answer["upper"] == pytest.approx(0.5)


def test_progress_on_a_terminal(
    hausbench: Program, plugin: Path, tetrahedron: Path, raised: Path
) -> None:
    """After two seconds, a line on standard error tells what goes on, with the bounds so far; it is
    erased at the end."""
    mine, its = pty.openpty()
    environment = {name: value for name, value in hausbench.environment().items() if name != "CI"}
    command = hausbench.command(
        "measure",
        tetrahedron,
        raised,
        "--solver",
        "never_returns",
        "--time-limit",
        "3",
        "--plugin",
        plugin,
    )
    process = subprocess.Popen(command, env=environment, stdout=subprocess.DEVNULL, stderr=its)
    os.close(its)
    said = b""
    while process.poll() is None or select.select([mine], [], [], 0)[0]:
        if select.select([mine], [], [], 0.1)[0]:
            try:
                said += os.read(mine, 4096)
            except OSError:  # the terminal is closed
                break
    os.close(mine)
    assert re.search(
        rb"[2-9] s \| solving, h\(A,B\) in \[0\.12[0-9]*, 0\.50[0-9]*\] so far", said
    ), said
    assert said.rstrip().endswith(b"\x1b[K"), said
    quiet = subprocess.run(command, env=environment, capture_output=True, text=True)
    assert "solving" not in quiet.stderr


# Where the code of the plug-in ends or hangs -> what is said. Nothing of it may end or hang the
# program that the user started.
AT_ONCE = {
    "exits when loaded": "libbroken.so: ended the program with exit code 0 in loading",
    "crashes when loaded": "libbroken.so: ended the program with signal 6 (Aborted) in loading",
    "exits when made": "libbroken.so: ended the program with exit code 0 in loading",
    "exits when destroyed": "libbroken.so: ended the program with exit code 0 in loading",
}


@pytest.mark.parametrize("how", AT_ONCE)
def test_no_code_of_a_plugin_ends_the_program(
    hausbench: Program,
    outside: Path,
    tetrahedron: Path,
    experiment: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    how: str,
) -> None:
    plugin = outside / "libbroken.so"
    experiment.write_text(
        f'plugins = ["{plugin}"]\n' + experiment.read_text().replace("guthe", "broken")
    )
    monkeypatch.setenv("BROKEN", how)
    every_verb: list[list[str | Path]] = [
        ["list", "--plugin", plugin],
        ["explain", experiment],
        ["status", experiment],
        ["run", experiment, "--results", tmp_path],
        ["measure", tetrahedron, tetrahedron, "--plugin", plugin],
    ]
    for arguments in every_verb:
        assert AT_ONCE[how] in hausbench.fails(*arguments)


def test_a_constructor_that_ends_or_hangs_fails_its_rows(
    hausbench: Program,
    outside: Path,
    experiment: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """With these parameters alone; so the plug-in can be loaded, and each case has its row."""
    plugin = outside / "libbroken.so"
    text = experiment.read_text().replace(
        'name = "guthe"', 'name = "broken"\nparameters = { how = "badly" }'
    )
    experiment.write_text(f'plugins = ["{plugin}"]\n' + text)
    monkeypatch.setenv("BROKEN", "exits when made badly")
    assert "libbroken.so: ended the program with exit code 0" in hausbench.fails(
        "explain", experiment
    )  # it asks the solver what it needs
    assert hausbench("run", experiment, "--results", tmp_path, "--quiet").returncode == 0
    (row,) = rows_of(tmp_path / "tiny.h5")["broken"]
    assert (
        row["status"] == "failed" and row["certified"] == 0 and "ended early" in row["reason"]
    ), row


def test_the_end_of_a_plugin_cannot_change_the_exit_code(
    hausbench: Program,
    outside: Path,
    tetrahedron: Path,
    raised: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    ask: tuple[str | Path, ...] = (
        "measure",
        tetrahedron,
        raised,
        "--cutoff",
        "0.1",
        "--plugin",
        outside / "libbroken.so",
    )
    for how in ("exits at the end", "sleeps at the end"):
        monkeypatch.setenv("BROKEN", how)
        done = hausbench(*ask)
        assert done.returncode == 1 and "is above 0.1" in done.stdout, done.stderr  # 1: above


def test_ctrl_c_ends_the_solver_too(
    hausbench: Program,
    plugin: Path,
    tetrahedron: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    process = subprocess.Popen(
        hausbench.command(
            "measure",
            tetrahedron,
            tetrahedron,
            "--solver",
            "hangs",
            "--set",
            "at=0",
            "--plugin",
            plugin,
        ),
        env=hausbench.environment(),
        stdout=subprocess.DEVNULL,
    )
    wait_for(lambda: bool(list(tmp_path.glob("hausbench-worker-*"))))
    children = Path(f"/proc/{process.pid}/task/{process.pid}/children")
    wait_for(lambda: bool(children.read_text()))
    solver = Path(f"/proc/{children.read_text().split()[0]}")
    process.send_signal(signal.SIGINT)
    assert process.wait(10) == -signal.SIGINT
    assert not solver.exists() and not list(tmp_path.glob("hausbench-*"))


def test_what_a_solver_prints_is_not_the_answer(
    hausbench: Program, plugin: Path, tetrahedron: Path, raised: Path
) -> None:
    done = hausbench(
        "measure",
        tetrahedron,
        raised,
        "--solver",
        "chatters",
        "--set",
        "at=0",
        "--json",
        "--plugin",
        plugin,
    )
    assert done.returncode == 0 and json.loads(done.stdout)["status"] == "converged"
    assert done.stderr.count("....") > 1000


def test_a_status_that_does_not_follow_says_both_lengths(
    hausbench: Program, plugin: Path, tetrahedron: Path, raised: Path
) -> None:
    wrong = hausbench(
        "measure",
        tetrahedron,
        raised,
        "--solver",
        "lies",
        "--set",
        "at=0",
        "--set",
        "how=no such element",
        "--plugin",
        plugin,
    )
    assert (
        "do not trust solver 'lies': its witness names element 1000000 of the source, which has 4"
        in wrong.stderr + wrong.stdout
    )
    done = hausbench(
        "measure",
        tetrahedron,
        raised,
        "--solver",
        "lies",
        "--set",
        "at=0",
        "--set",
        "how=wide",
        "--of",
        "absolute",
        "--tolerance",
        "0.5",
        "--json",
        "--plugin",
        plugin,
    )
    answer = json.loads(done.stdout)
    assert (
        answer["status"] == "stalled"
        and answer["note"]
        == "the solver reports converged, but its gap 4e+09 is above the tolerance 0.5"
    )


def test_files_that_are_no_plugins(
    hausbench: Program, outside: Path, plugin: Path, tmp_path: Path
) -> None:
    assert "interface 999" in hausbench.fails("list", "--plugin", outside / "libof_another_time.so")
    assert "does not exist" in hausbench.fails("list", "--plugin", tmp_path / "absent.so")
    text = tmp_path / "text.so"
    text.write_text("not a library\n")
    line = hausbench.fails("list", "--plugin", text)
    assert "text.so" in line and "MODULE" in line
    cut = tmp_path / "cut.so"
    cut.write_bytes(plugin.read_bytes()[:5000])
    assert "cut.so" in hausbench.fails("list", "--plugin", cut)
    assert "folder" in hausbench.fails("list", "--plugin", tmp_path)
    library = Path("/usr/lib", sysconfig.get_config_var("MULTIARCH"), "libz.so.1")
    assert library.exists()
    assert "not a plug-in" in hausbench.fails("list", "--plugin", library)
    # A name may be used once.
    assert "'vertex_only'" in hausbench.fails("list", "--plugin", plugin, "--plugin", plugin)


def test_the_layout_of_a_structure_counts_where_its_header_is_included(
    hausbench: Program, outside: Path, tetrahedron: Path, raised: Path, tmp_path: Path
) -> None:
    ask = ("measure", tetrahedron, raised, "--json", "--plugin")
    done = hausbench(*ask, outside / "libwith_octree.so", "--solver", "with_octree")
    assert done.returncode == 0 and json.loads(done.stdout)["lower"] == pytest.approx(
        0.25
    ), done.stderr
    # A hausbench whose octree has another layout: only the plug-in that uses it must be rebuilt.
    installed = tmp_path / "installed"
    shutil.copytree(outside.parent / "installed", installed)
    header = installed / "include" / "hausbench" / "structures" / "octree.h"
    text = header.read_text()
    later = text.replace("structure_layout = 1;", "structure_layout = 2;").replace(
        "\n};\n", "\n    double more[7] = {};\n};\n"
    )
    assert later.count("structure_layout = 2;") == later.count("double more[7]") == 1
    header.write_text(later)
    built(
        [
            "cmake",
            "-S",
            outside.parent / "sources",
            "-B",
            "later",
            f"-DCMAKE_PREFIX_PATH={installed}",
            "-DCMAKE_BUILD_TYPE=Release",
        ],
        tmp_path,
    )
    built(
        ["cmake", "--build", "later", "--parallel", "2", "--target", "misbehaving", "with_octree"],
        tmp_path,
    )
    done = hausbench(*ask, tmp_path / "later" / "libmisbehaving.so", "--solver", "vertex_only")
    assert done.returncode == 0 and json.loads(done.stdout)["lower"] == pytest.approx(
        0.25
    ), done.stderr
    line = hausbench.fails("list", "--plugin", tmp_path / "later" / "libwith_octree.so")
    assert "libwith_octree.so" in line and "'octree'" in line and "build it again" in line


# solver, how -> status at the second pose, text of the reason
DEEDS = {
    ("crashes", ""): ("signal", "signal 11"),
    ("hangs", ""): ("timeout", "no answer within 0.6 s"),
    ("leaves", ""): ("failed", "the worker ended early"),
    ("eats_memory", "bit by bit"): ("out_of_memory", "400 MB"),
    ("eats_memory", "at once"): ("out_of_memory", "refused memory"),
    ("lies", "upper below"): ("unsound", "below the verified lower bound"),
    ("lies", "lower above"): ("unsound", "above the distance of its witness"),
    ("lies", "far witness"): ("unsound", "above the distance of its witness"),
    ("lies", "crossed"): ("unsound", "below"),
    ("lies", "not a number"): ("unsound", "not a number"),
    ("lies", "wide"): ("failed", "reports converged, but its gap 4e+09 is above the tolerance 2"),
    ("lies", "wide, no cutoff"): ("failed", "its lower bound 0 is not above the cutoff inf"),
    ("babbles", "noise"): ("failed", "not an event"),
    ("babbles", "json"): ("failed", "not an event"),
    ("babbles", "another row"): ("failed", "not an event"),
    ("babbles", "an answer"): ("failed", "not an event"),
    ("babbles", "closed"): ("timeout", "no answer within 0.6 s"),
    ("throws", "an exception"): ("failed", "it was too hard"),
    ("throws", "a number"): ("failed", "not a std::exception"),
    ("chatters", ""): ("ok", ""),
    ("vertex_only", ""): ("ok", ""),  # the experiment continued to the end
}


def label(solver: str, how: str) -> str:
    return f"{solver} {how}".strip()


WRONG = [label(*deed) for deed, (status, _) in DEEDS.items() if status == "unsound"]


def sweep(hanging: bool) -> str:
    """Returns an experiment with the solvers that hang, under a short time limit, or with all
    others."""
    text = head(0.6) if hanging else f"expected_unsound = {json.dumps(WRONG)}\n{head()}"
    for solver, how in DEEDS:
        if (DEEDS[solver, how][0] == "timeout") != hanging:
            continue
        text += f'\n[[solver]]\nname = "{solver}"\nlabel = "{label(solver, how)}"\n'
        if how:
            text += f'parameters = {{ how = "{how}" }}\n'
    return text


Rows = dict[str, list[dict[str, Any]]]


def rows_of(file: Path) -> Rows:
    """Returns the rows by label, in the order of poses."""
    rows: Rows = {}
    with h5py.File(file) as f:
        texts = {
            name: f[f"cases/{name}"].asstr()[:]
            for name in ("label", "status", "reason", "identity", "build")
        }
        numbers = {
            name: f[f"cases/{name}"][:]
            for name in (
                "pose_index",
                "lower",
                "upper",
                "certified",
                "solve_seconds",
                "reported_seconds",
            )
        }
        for i in range(len(texts["label"])):
            row = {name: column[i] for name, column in {**texts, **numbers}.items()}
            rows.setdefault(row["label"], []).append(row)
    for of_label in rows.values():
        assert [row["pose_index"] for row in of_label] == list(range(len(of_label)))
    return rows


@pytest.fixture(scope="module")
def swept(program_file: str, plugin: Path, tmp_path_factory: pytest.TempPathFactory) -> Rows:
    folder = tmp_path_factory.mktemp("sweep")
    rows: Rows = {}
    for stem, hanging in (("hanging", True), ("misbehaving", False)):
        experiment = folder / f"{stem}.toml"
        experiment.write_text(sweep(hanging))
        done = Program(program_file, folder)(
            "run", experiment, "--results", folder, "--plugin", plugin, timeout=600
        )
        assert done.returncode == 0, done.stderr
        rows |= rows_of(folder / f"{stem}.h5")
    return rows


def test_every_case_has_one_row(swept: Rows) -> None:
    assert set(swept) == {label(*deed) for deed in DEEDS} | {"guthe"}
    identities = [row["identity"] for rows in swept.values() for row in rows]
    assert len(identities) == 4 * (len(DEEDS) + 1) == len(set(identities))


@pytest.mark.parametrize("deed", DEEDS, ids=lambda deed: label(*deed))
def test_what_becomes_of_it(swept: Rows, deed: tuple[str, str]) -> None:
    status, said = DEEDS[deed]
    rows = swept[label(*deed)]
    reasons = [row["reason"] for row in rows]
    assert [row["status"] for row in rows] == ["ok", status, "ok", "ok"], reasons
    assert said in rows[1]["reason"] and "\n" not in rows[1]["reason"]
    for row, good in zip(rows, swept["guthe"]):
        if row["status"] == "ok":
            assert row["lower"] <= good["upper"] and good["lower"] <= row["upper"]


def test_last_words_are_kept(swept: Rows) -> None:
    assert "about to touch what is not ours" in swept["crashes"][1]["reason"]


def test_certified_is_a_column(swept: Rows) -> None:
    assert {row["certified"] for row in swept["guthe"] + swept["vertex_only"]} == {1}
    assert {row["certified"] for row in swept["throws a number"]} == {0}


BREAKING = """

[[solver]]
name = "crashes"
warm = true
parameters = { at = 2.0 }

[[solver]]
name = "throws"
warm = true
parameters = { at = 2.0 }

[[solver]]
name = "throws"
label = "at the head"
warm = true
parameters = { at = 0.0 }
"""


def test_a_chain_that_breaks_keeps_what_came_before(
    hausbench: Program, plugin: Path, tmp_path: Path
) -> None:
    experiment = tmp_path / "breaking.toml"
    experiment.write_text(head() + BREAKING)
    done = hausbench("run", experiment, "--results", tmp_path, "--plugin", plugin)
    assert done.returncode == 0, done.stderr
    rows = rows_of(tmp_path / "breaking.h5")
    for solver, status, said in (
        ("crashes", "signal", "signal 11"),
        ("throws", "failed", "it was too hard"),
    ):
        reasons = [row["reason"] for row in rows[solver]]
        assert [row["status"] for row in rows[solver]] == ["ok", "ok", status, "failed"], reasons
        assert said in reasons[2] and "broke at an earlier pose" in reasons[3]
    assert [row["status"] for row in rows["at the head"]] == ["failed"] * 4
    with h5py.File(tmp_path / "breaking.h5") as f:
        timed = {int(case) for case in f["repeats/case"][:]}
        answered = {i for i, status in enumerate(f["cases/status"].asstr()[:]) if status == "ok"}
    assert timed == answered  # the answers before the failure are timed from the first pose on
    journal = tmp_path / "breaking.journal"
    before = journal.read_bytes()
    assert hausbench("run", experiment, "--results", tmp_path, "--plugin", plugin).returncode == 0
    assert journal.read_bytes() == before  # nothing is left to run


def test_a_crash_in_a_matrix_costs_its_case_alone(
    hausbench: Program, plugin: Path, tmp_path: Path
) -> None:
    experiment = tmp_path / "crossed.toml"
    experiment.write_text(
        head()
        .replace('source = "sphere1"', 'sources = ["sphere0", "sphere1"]')
        .replace('target = "sphere1"', "")
        + '[[solver]]\nname = "crashes"\nparameters = { at = 1.0 }\n'
    )
    done = hausbench("run", experiment, "--results", tmp_path, "--plugin", plugin)
    assert done.returncode == 0, done.stderr
    with h5py.File(tmp_path / "crossed.h5") as f:
        rows = list(
            zip(f["cases/label"].asstr()[:], f["cases/status"].asstr()[:], f["cases/pose_index"][:])
        )
    assert len(rows) == 32
    for label_, status, pose in rows:
        assert status == ("signal" if label_ == "crashes" and pose == 1 else "ok")


def test_a_chain_is_waited_for_as_long_as_a_pass_takes(
    hausbench: Program, plugin: Path, tmp_path: Path
) -> None:
    """A warm chain solves every pose in every pass, even those not timed, and the worker sends no
    message meanwhile. It must not be killed as hanging.
    """
    experiment = tmp_path / "patient.toml"
    experiment.write_text(
        head(1.0)
        .replace(
            "from = [0, 0, 0], to = [3, 0, 0], steps = 4",
            "from = [0, 0, 0], to = [7, 0, 0], steps = 8",
        )
        .replace('name = "guthe"', 'name = "dawdles"\nwarm = true\nparameters = { at = 6.0 }')
    )
    done = hausbench("run", experiment, "--results", tmp_path, "--plugin", plugin)
    assert done.returncode == 0, done.stderr
    rows = rows_of(tmp_path / "patient.h5")["dawdles"]
    reasons = [row["reason"] for row in rows]
    assert [row["status"] for row in rows] == 7 * ["timeout"] + ["ok"], reasons
    assert all("the bounds hold" in row["reason"] for row in rows[:7])


def test_a_matrix_that_runs_out_of_memory_goes_on_in_a_fresh_worker(
    hausbench: Program, plugin: Path, tmp_path: Path
) -> None:
    experiment = tmp_path / "full.toml"
    names = '["sphere0", "sphere1", "sphere2"]'
    experiment.write_text(
        LEAKING.replace("repeats = 300", "repeats = 10")
        .replace("memory_mb = 300", "memory_mb = 200")
        .replace('source = "sphere0"\ntarget = "sphere0"', f"sources = {names}")
        .replace("HOW", "from repeat to repeat")
    )
    done = hausbench("run", experiment, "--results", tmp_path, "--plugin", plugin)
    assert done.returncode == 0, done.stderr
    with h5py.File(tmp_path / "full.h5") as f:  # the worker keeps 44 MB per pair
        assert set(f["cases/status"].asstr()[:]) == {"ok"}, set(f["cases/reason"].asstr()[:])
        assert len(f["cases/status"]) == 9


def test_a_row_keeps_a_thousand_values_that_its_solver_reports(
    hausbench: Program, plugin: Path, tmp_path: Path
) -> None:
    experiment = tmp_path / "telling.toml"
    experiment.write_text(head() + '\n[[solver]]\nname = "tells"\n')
    done = hausbench("run", experiment, "--results", tmp_path, "--plugin", plugin)
    assert done.returncode == 0, done.stderr
    assert [row["status"] for row in rows_of(tmp_path / "telling.h5")["tells"]] == 4 * ["ok"]
    with h5py.File(tmp_path / "telling.h5") as f:
        facts = [
            json.loads(text)
            for text, label_ in zip(f["cases/facts"].asstr()[:], f["cases/label"].asstr()[:])
            if label_ == "tells"
        ]
    assert len(facts[1]) == 1001 and facts[1]["left out"].startswith(
        "299000 of 300000 reported values"
    ), len(facts[1])


LEAKING = """\
title = "a solver that grows and is never silent"
tolerances = [2.0]
of = "absolute"
repeats = 300
limits = { case_seconds = 60, memory_mb = 300 }

[[scene]]
name = "still"
source = "sphere0"
target = "sphere0"

[[solver]]
name = "leaks"
parameters = { at = 0.0, how = "HOW" }
"""


@pytest.mark.parametrize("how", ["from repeat to repeat", "while it talks"])
def test_the_memory_limit_holds_while_a_solver_talks(
    hausbench: Program, plugin: Path, tmp_path: Path, how: str
) -> None:
    experiment = tmp_path / "leaking.toml"
    experiment.write_text(LEAKING.replace("HOW", how))
    done = hausbench("run", experiment, "--results", tmp_path, "--plugin", plugin)
    assert done.returncode == 0, done.stderr
    (row,) = rows_of(tmp_path / "leaking.h5")["leaks"]
    assert row["status"] == "out_of_memory" and "300 MB" in row["reason"], row


def off(points: list[tuple[float, float, float]], faces: int) -> str:
    corners = "".join(f"{x} {y} {z}\n" for x, y, z in points)
    triangles = ["0 2 1", "0 1 3", "0 3 2", "1 2 3"] + ["0 2 1"] * (faces - 4)
    return f"OFF\n{len(points)} {faces} 0\n{corners}" + "".join(f"3 {t}\n" for t in triangles)


def test_the_status_of_both_directions_is_that_of_the_larger(
    hausbench: Program, plugin: Path, tmp_path: Path
) -> None:
    # This solver stops early if A has four triangles and B five, and converges if A has five and B
    # four.
    flat = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 0)]
    tall = [*flat[:3], (0, 0, 4)]
    for name, points, faces in (
        ("flat4", flat, 4),
        ("flat5", flat, 5),
        ("tall4", tall, 4),
        ("tall5", tall, 5),
    ):
        (tmp_path / f"{name}.off").write_text(
            off([(float(x), float(y), float(z)) for x, y, z in points], faces)
        )

    def measured(a: str, b: str) -> dict[str, Any]:
        done = hausbench(
            "measure",
            f"{a}.off",
            f"{b}.off",
            "--symmetric",
            "--solver",
            "stops_early",
            "--plugin",
            plugin,
            "--of",
            "absolute",
            "--tolerance",
            "0.01",
            "--json",
        )
        assert done.returncode == 0, done.stderr
        result: dict[str, Any] = json.loads(done.stdout)
        assert result["lower"] <= 4 <= result["upper"]
        return result

    for pair in (
        ("tall5", "flat4"),
        ("flat4", "tall5"),
    ):  # the direction that stops early is in [0, 0.125], below the other
        closed = measured(*pair)
        assert closed["upper"] - closed["lower"] <= 0.01
        assert (closed["status"], closed["note"]) == ("converged", "")
    for pair in (("tall4", "flat5"), ("flat5", "tall4")):
        left_open = measured(*pair)
        assert left_open["upper"] - left_open["lower"] > 0.1
        assert (left_open["status"], left_open["note"]) == ("time_limit", "stopped early")


def test_wrong_answers_end_the_run_with_exit_code_1(
    hausbench: Program, plugin: Path, tmp_path: Path
) -> None:
    experiment = tmp_path / "wrong.toml"
    body = head() + '\n[[solver]]\nname = "lies"\nlabel = "liar"\n'
    experiment.write_text(body)
    for _ in range(2):  # even if nothing is left to run
        done = hausbench("run", experiment, "--results", tmp_path, "--plugin", plugin)
        assert done.returncode == 1, done.stderr
        named = [line for line in done.stderr.splitlines() if "unsound" in line]
        assert (
            len(named) == 1
            and "liar on moved, pose 1" in named[0]
            and "below the verified lower bound" in named[0]
        )
        assert [row["status"] for row in rows_of(tmp_path / "wrong.h5")["liar"]] == [
            "ok",
            "unsound",
            "ok",
            "ok",
        ]
    experiment.write_text('expected_unsound = ["liar"]\n' + body)
    done = hausbench("run", experiment, "--results", tmp_path, "--plugin", plugin)
    assert (
        done.returncode == 0
        and "1 unsound" in done.stdout
        and "as expected" in done.stdout
        and "unsound" not in done.stderr
    )
    # An expected error that does not occur is accepted; an unknown label is an error.
    experiment.write_text('expected_unsound = ["guthe"]\n' + head())
    assert hausbench("run", experiment, "--results", tmp_path, "--plugin", plugin).returncode == 0
    experiment.write_text('expected_unsound = ["lair"]\n' + body)
    line = hausbench.fails("run", experiment, "--results", tmp_path, "--plugin", plugin)
    assert "wrong.toml:1" in line and "'lair'" in line and "did you mean 'liar'" in line


RESUMED = head() + '\n[[solver]]\nname = "vertex_only"\n'


def test_resume_notices_another_build_of_the_plugin(
    hausbench: Program, plugin: Path, tmp_path: Path
) -> None:
    library = tmp_path / "libown.so"
    shutil.copy(plugin, library)
    experiment = tmp_path / "resumed.toml"
    experiment.write_text(RESUMED)

    def again() -> Rows:
        done = hausbench("run", experiment, "--results", tmp_path, "--plugin", library)
        assert done.returncode == 0, done.stderr
        return rows_of(tmp_path / "resumed.h5")

    def times(rows: Rows, name: str) -> list[float]:
        return [row["solve_seconds"] for row in rows[name]]

    first, second = again(), again()
    assert times(first, "vertex_only") == times(second, "vertex_only")
    with library.open("ab") as file:
        file.write(b"\0")  # another file, though the same code
    third = again()
    assert times(third, "vertex_only") != times(second, "vertex_only")
    assert times(third, "guthe") == times(
        second, "guthe"
    )  # the program's own solvers are unchanged
    builds = {}
    for name, rows in third.items():
        builds[name] = {row["build"] for row in rows}
    assert (
        len(builds["guthe"]) == len(builds["vertex_only"]) == 1
        and builds["guthe"] != builds["vertex_only"]
    )
    assert builds["vertex_only"] != {row["build"] for row in first["vertex_only"]}


def test_an_experiment_that_needs_the_plugin_says_so(hausbench: Program, tmp_path: Path) -> None:
    experiment = tmp_path / "resumed.toml"
    experiment.write_text(RESUMED)
    line = hausbench.fails("run", experiment, "--results", tmp_path)
    assert "resumed.toml" in line and "vertex_only" in line and "--plugin" in line
