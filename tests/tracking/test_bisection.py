"""Tests the search for the commit that changed a program's work, in a scratch git repository. The
"programs" are files with counts."""

from __future__ import annotations

import json
import math
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from bench.tracking import bisection, blocks, builds, counted
from bench.tracking.bisection import Measured, Unclear, decided_by, differing, is_bad
from bench.tracking.blocks import Block, NotMeasured
from bench.tracking.builds import Build, NotBuilt
from bench.tracking.cases import Case

EXPERIMENT = """tolerances = [1e-6]
[[scene]]
name = "two points"
source = "a"
target = "b"
[[solver]]
name = "guthe"
[[solver]]
name = "guthe_other"
"""
CASE = "guthe on two points"


def fake_build(tree: Path, commit: str, jobs: int) -> Build:
    """Stands in for building a commit. A commit whose work.json has "broken" does not build; with
    "untidy", building changes the file."""
    (tree / "build").mkdir(exist_ok=True)
    work = json.loads((tree / "work.json").read_text())
    if "broken" in work:
        raise NotBuilt(f"{commit} does not build")
    if "untidy" in work:
        (tree / "work.json").write_text(json.dumps({**work, "untidy": 2}))
    return Build(commit, tree / "work.json", None)


def fake_measure(program: Path, case: Case, folder: Path) -> Block:
    work = json.loads(program.read_text())
    if "unknown" in work:
        raise NotMeasured("there is no such solver")
    assert case.name == CASE and not sys.stdin.read()  # nothing can wait for input
    return Block(1.0, 1.0, 0.1, work.get("shapes", "same"), counters=work["counters"])


def fake_instructions(program: Path, case: Case, folder: Path) -> int | NotMeasured:
    count: int | None = json.loads(program.read_text()).get("instructions")
    return NotMeasured("there is no valgrind") if count is None else count


def install_fakes(scratch: Path, where: pytest.MonkeyPatch | None = None) -> None:
    """Replaces building and measuring with fakes, in this process through `where`, or for good in
    the process of a bisection step."""
    place = pytest.MonkeyPatch() if where is None else where
    for module, name, value in (
        (builds, "ROOT", scratch),
        (builds, "VERSIONS", scratch / "build" / "versions"),
        (builds, "build_in", fake_build),
        (blocks, "measure", fake_measure),
        (counted, "instructions_of", fake_instructions),
    ):
        place.setattr(module, name, value)


STEP = f"""import sys
from pathlib import Path
sys.path[:0] = [{str(Path(__file__).parent)!r}, {str(Path(__file__).resolve().parents[2])!r}]
import test_bisection
test_bisection.install_fakes(Path({{scratch!r}}))
from bench.tracking import bisection
sys.exit(bisection.main(sys.argv[1:]))
"""


def git(scratch: Path, *words: str) -> str:
    who = {
        f"GIT_{role}_{field}": "a@b"
        for role in ("AUTHOR", "COMMITTER")
        for field in ("NAME", "EMAIL")
    } | {"GIT_CONFIG_GLOBAL": os.devnull}
    return subprocess.run(
        ["git", "-C", str(scratch), *words],
        env={**os.environ, **who},
        check=True,
        capture_output=True,
        text=True,
    ).stdout.strip()


def repository(scratch: Path, works: list[dict[str, Any]]) -> list[str]:
    """Makes a commit for each content of work.json, and returns the hashes."""
    git(scratch, "init", "--quiet")
    (scratch / ".gitignore").write_text("/build/\n")
    (scratch / "tracked.toml").write_text(EXPERIMENT)
    commits = []
    for i, work in enumerate(works):
        (scratch / "work.json").write_text(json.dumps({**work, "number": i}))
        git(scratch, "add", ".gitignore", "work.json")
        git(scratch, "commit", "--quiet", "-m", f"change {i}")
        commits.append(git(scratch, "rev-parse", "HEAD"))
    return commits


def run(
    scratch: Path,
    monkeypatch: pytest.MonkeyPatch,
    good: str,
    bad: str,
    *more: str,
    before: str = "",
) -> int:
    """Runs the whole search. Each bisection step first executes the code `before`."""
    install_fakes(scratch, monkeypatch)
    monkeypatch.setattr(sys, "stdin", open(os.devnull, encoding="utf-8"))
    step = scratch / "step.py"
    step.write_text(before + STEP.format(scratch=str(scratch)))
    return bisection.main(
        [
            "--case",
            CASE,
            "--good",
            good,
            "--bad",
            bad,
            "--experiment",
            str(scratch / "tracked.toml"),
            *more,
        ],
        [sys.executable, str(step), "--step"],
    )


def work(tests: int, instructions: int | None = None, **more: Any) -> dict[str, Any]:
    return {
        "counters": {"bound_tests": tests, "node_visits": 70},
        "instructions": instructions,
        **more,
    }


def test_the_whole_search_finds_the_commit_past_one_that_is_skipped(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    # The middle commit, which git tries first, does not build. Counts vary slightly before and
    # after the change.
    works = [
        work(100),
        work(101),
        work(100),
        work(99),
        {"broken": True},
        work(100),
        work(160),
        work(161),
        work(158),
    ]
    commits = repository(tmp_path, works)
    assert run(tmp_path, monkeypatch, commits[0], commits[8]) == 0
    output = capfd.readouterr()
    assert "first bad commit:" in output.out and output.out.splitlines()[1].endswith("change 6")
    assert f"before: {commits[5][:10]}: bound_tests 100" in output.out
    assert f"after: {commits[6][:10]}: bound_tests 160" in output.out
    assert f"{commits[4][:10]} is skipped" in output.err
    tree = tmp_path / "build" / "versions" / "bisect"
    assert (
        subprocess.run(
            ["git", "-C", str(tree), "bisect", "log"], capture_output=True, check=False
        ).returncode
        != 0
    )  # no bisection is left running
    assert git(tmp_path, "rev-parse", "HEAD") == commits[8] and not git(
        tmp_path, "status", "--porcelain", "work.json"
    )


def test_what_cannot_be_told_apart_is_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    # The counters are equal, so instructions decide, and fewer are a change, too. The two middle
    # commits cannot be measured.
    commits = repository(
        tmp_path,
        [work(100, 9000), {"unknown": True}, work(100, 9000, shapes="others"), work(100, 5000)],
    )
    assert run(tmp_path, monkeypatch, commits[0], commits[3]) == 1
    output = capfd.readouterr()
    assert "one of these" in output.out
    assert all(f"change {i}" in output.out for i in (1, 2, 3)) and "change 0" not in output.out
    assert f"good: {commits[0][:10]}: instructions 9,000" in output.err


def test_what_lies_in_the_way_is_undone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    # An earlier search was interrupted and left a changed file. Also, building any commit changes a
    # file.
    commits = repository(
        tmp_path,
        [
            work(9, untidy=1),
            *(work(9 if i < 5 else 700, untidy=1) for i in range(8)),
            work(700, untidy=1),
        ],
    )
    tree = tmp_path / "build" / "versions" / "bisect"
    git(tmp_path, "worktree", "add", "--quiet", "--detach", str(tree), commits[2])
    git(tree, "bisect", "start", commits[7], commits[6])
    (tree / "work.json").write_text(json.dumps(work(12345)))
    assert run(tmp_path, monkeypatch, commits[0], commits[9]) == 0
    output = capfd.readouterr()
    assert (
        output.out.splitlines()[1].endswith("change 6")
        and f"good: {commits[0][:10]}: bound_tests 9\n" in output.err
    )
    assert not git(tree, "status", "--porcelain", "work.json")


@pytest.mark.parametrize(
    "state", ["a branch that is gone", "a merge that stopped", "a file that the commit has not"]
)
def test_a_worktree_in_any_state_is_used(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, state: str
) -> None:
    commits = repository(tmp_path, [work(9), work(9), work(700), work(700)])
    tree = tmp_path / "build" / "versions" / "bisect"
    git(tmp_path, "worktree", "add", "--quiet", "-b", "gone", str(tree), commits[3])
    if state == "a branch that is gone":
        git(tree, "bisect", "start", commits[3], commits[0])
        git(tmp_path, "update-ref", "-d", "refs/heads/gone")
    elif state == "a merge that stopped":
        git(tree, "read-tree", "-m", commits[0], commits[3], commits[1])
        assert git(tree, "ls-files", "--unmerged")
    else:
        git(tree, "rm", "--quiet", "work.json")
        git(tree, "commit", "--quiet", "-m", "without")
        (tree / "work.json").write_text("{}")
    assert run(tmp_path, monkeypatch, commits[0], commits[3]) == 0


def test_a_measurement_starts_from_what_the_commit_has(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    repository(tmp_path, [work(100)])
    install_fakes(tmp_path, monkeypatch)
    monkeypatch.setattr(sys, "stdin", open(os.devnull, encoding="utf-8"))
    (tmp_path / "work.json").write_text(json.dumps(work(5)))
    measured = bisection.measure(
        tmp_path, bisection.case_named(CASE, tmp_path / "tracked.toml"), "counters"
    )
    assert measured.counters["bound_tests"] == 100


def test_a_search_whose_step_fails_names_no_commit(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    commits = repository(tmp_path, [work(100), work(100), work(200), work(200)])
    assert (
        run(tmp_path, monkeypatch, commits[0], commits[3], before="import sys; sys.exit(200)\n")
        == 2
    )
    output = capfd.readouterr()
    assert "git bisect run ended with" in output.err and "first bad commit" not in output.out
    assert (
        run(tmp_path, monkeypatch, commits[0], commits[3]) == 0
    )  # its leftovers do not disturb the next search


def test_one_search_at_a_time(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    commits = repository(tmp_path, [work(100), work(200)])
    with bisection.locked(tmp_path / "build" / "versions" / "bisect.lock"):
        assert run(tmp_path, monkeypatch, commits[0], commits[1]) == 2
        assert (
            f"another search is running in {tmp_path}/build/versions/bisect: wait"
            in capsys.readouterr().err
        )
    assert run(tmp_path, monkeypatch, commits[0], commits[1]) == 0


def test_a_step_that_goes_on_keeps_the_lock(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    commits = repository(tmp_path, [work(100), work(100), work(200)])
    check = f"""import fcntl
try:
    fcntl.flock(open({str(tmp_path / 'build' / 'versions' / 'bisect.lock')!r}), fcntl.LOCK_EX | fcntl.LOCK_NB)
except BlockingIOError:
    import os
    if any(os.path.realpath(f'/proc/self/fd/{{one}}').endswith('bisect.lock') for one in os.listdir('/proc/self/fd')):
        open({str(tmp_path / 'kept')!r}, 'w')
"""
    assert run(tmp_path, monkeypatch, commits[0], commits[2], before=check) == 0
    assert (tmp_path / "kept").exists()


def test_an_interruption_is_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    commits = repository(tmp_path, [work(100), work(200)])

    def interrupted(*words: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(bisection, "search", interrupted)
    assert run(tmp_path, monkeypatch, commits[0], commits[1]) == 130
    assert (
        capsys.readouterr().err.splitlines()[-1]
        == "bisect: interrupted; the next search starts over"
    )
    monkeypatch.setattr(bisection, "step", interrupted)
    (tmp_path / "question.json").write_text(
        '{"case": "", "experiment": "", "by": "", "good": {}, "bad": {}, "shapes": "", "log": ""}'
    )
    assert bisection.main(["--step", str(tmp_path / "question.json")]) == bisection.ABORT
    assert capsys.readouterr().err == ""  # the search reports the error itself


def test_histories_that_do_not_meet(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    commits = repository(tmp_path, [work(100), work(100), work(200)])
    git(tmp_path, "checkout", "--quiet", "--orphan", "other")
    git(tmp_path, "commit", "--quiet", "-m", "other")
    assert run(tmp_path, monkeypatch, "other", commits[2]) == 2
    output = capsys.readouterr().err
    assert "have no commit in common here" in output and "shallow" not in output
    # A clone without the commits in between.
    shallow = tmp_path / "shallow"
    git(tmp_path, "tag", "first", commits[0])
    git(tmp_path, "tag", "last", commits[2])
    git(
        tmp_path,
        "clone",
        "--quiet",
        "--depth",
        "1",
        "--branch",
        "last",
        f"file://{tmp_path}",
        str(shallow),
    )
    git(shallow, "fetch", "--quiet", "--depth", "1", "origin", "tag", "first")
    (shallow / "tracked.toml").write_text(EXPERIMENT)
    assert run(shallow, monkeypatch, "first", "last") == 2
    assert (
        "have no commit in common here; this clone is shallow: git fetch --unshallow"
        in capsys.readouterr().err
    )


def test_good_and_bad_exchanged_unrelated_or_the_same_are_mistakes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    commits = repository(tmp_path, [work(100), work(200)])
    git(tmp_path, "checkout", "--quiet", "-b", "beside", commits[0])
    git(tmp_path, "commit", "--quiet", "--allow-empty", "-m", "beside")
    for good, bad, word in (
        (commits[1], commits[0], "swap them"),
        ("beside", commits[1], f"use {commits[0][:10]}"),
        (commits[0], commits[0], "same commit"),
        (commits[0], "nowhere", "nowhere"),
    ):
        assert run(tmp_path, monkeypatch, good, bad) == 2
        assert word in capsys.readouterr().err
    assert not (tmp_path / "build").exists()


def test_nothing_differs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    commits = repository(tmp_path, [work(100, 1000000), work(100, 1000010)])
    assert run(tmp_path, monkeypatch, commits[0], commits[1]) == 2
    assert "neither work counters nor instructions differ" in capsys.readouterr().err
    for by in ("counters", "instructions"):
        assert run(tmp_path, monkeypatch, commits[0], commits[1], "--by", by) == 2
        assert f"{by} do not differ between good and bad" in capsys.readouterr().err


def test_an_end_that_cannot_be_measured_is_a_mistake(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    commits = repository(tmp_path, [{"unknown": True}, work(100), {"broken": True}])
    assert run(tmp_path, monkeypatch, commits[0], commits[1]) == 2
    assert "no such solver" in capsys.readouterr().err
    assert run(tmp_path, monkeypatch, commits[1], commits[2]) == 2
    assert "does not build" in capsys.readouterr().err


def test_a_step_that_fails_otherwise_stops_the_search(tmp_path: Path) -> None:
    (tmp_path / "question.json").write_text("{}")
    assert (
        bisection.main(["--step", str(tmp_path / "question.json")]) >= 128
    )  # git takes 1 as a bad commit


def test_the_step_of_the_command_line_is_that_of_this_tree(tmp_path: Path) -> None:
    """Git runs each step in a worktree, which contains an older version of this package."""
    (tmp_path / "bench" / "tracking").mkdir(parents=True)
    for folder in ("bench", "bench/tracking"):
        (tmp_path / folder / "__init__.py").write_text("raise SystemExit('the wrong package')")
    (tmp_path / "question.json").write_text("{}")
    root = str(Path(__file__).resolve().parents[2])
    done = subprocess.run(
        [*bisection.STEP, str(tmp_path / "question.json")],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": root},
        capture_output=True,
        text=True,
        check=False,
        stdin=subprocess.DEVNULL,
    )
    assert done.returncode == bisection.ABORT and "bisect: stopped: TypeError" in done.stderr


def test_what_decides() -> None:
    good, more = Measured({"a": 5, "old": 7}, "x", 1000), Measured({"a": 6, "new": 3}, "x", 1000)
    assert decided_by(good, more, "auto") == "counters"
    assert differing(good.counters, more.counters) == ["a"]
    same = Measured({"a": 5, "new": 3}, "x", 1100)  # a new counter is not more work
    assert decided_by(good, same, "auto") == "instructions"
    assert decided_by(more, Measured({"a": 7}, "x", 1100), "instructions") == "instructions"
    with pytest.raises(Unclear, match="instructions do not differ"):
        decided_by(good, more, "instructions")
    with pytest.raises(Unclear, match="neither"):
        decided_by(good, Measured({"a": 5}, "x", None), "auto")
    with pytest.raises(Unclear, match="instructions of bad are not counted: no valgrind"):
        decided_by(good, Measured({"a": 5}, "x", uncounted="no valgrind"), "auto")
    with pytest.raises(Unclear, match="shapes"):
        decided_by(good, Measured({"a": 9}, "y", 1), "auto")


def test_instructions_that_differ_a_little_are_the_same() -> None:
    def measured(count: int) -> Measured:
        return Measured({}, "x", count)

    with pytest.raises(Unclear, match="neither"):
        decided_by(measured(10**6), measured(10**6 + 90), "auto")
    assert decided_by(measured(10**6), measured(10**6 + 110), "auto") == "instructions"


def test_a_count_of_nothing_is_a_count() -> None:
    good, bad = Measured({"a": 5, "b": 0}, "x", 1000), Measured({"a": 5, "b": 900}, "x", 1000)
    assert decided_by(good, bad, "auto") == decided_by(bad, good, "counters") == "counters"
    assert differing(good.counters, bad.counters) == ["b"]
    # compares log(1 + b) with log 1 and log 901
    assert is_bad({"b": 40}, good.counters, bad.counters) and not is_bad(
        {"b": 20}, good.counters, bad.counters
    )
    assert not is_bad({"b": 0}, good.counters, bad.counters)


def test_as_near_to_good_as_to_bad_is_good() -> None:
    good, bad, middle = {"a": 0}, {"a": 3}, {"a": 1}
    assert math.log1p(1) - math.log1p(0) == math.log1p(3) - math.log1p(1)
    assert not is_bad(middle, good, bad) and not is_bad(middle, bad, good)


def test_nearer_is_by_the_logarithm() -> None:
    good, bad = {"a": 100, "b": 5}, {"a": 400, "b": 5}
    assert not is_bad(
        {"a": 190, "b": 999}, good, bad
    )  # the boundary is 200, the geometric mean; b is equal in good and bad, so not compared
    assert is_bad({"a": 210, "b": 5}, good, bad)
    assert is_bad({"a": 190}, bad, good)
    with pytest.raises(NotMeasured):
        is_bad({"b": 5}, good, bad)


def test_a_name_chooses_one_case(tmp_path: Path) -> None:
    file = tmp_path / "tracked.toml"
    file.write_text(EXPERIMENT)
    assert bisection.case_named("guthe on", file).name == CASE
    assert bisection.case_named("guthe_o", file).name == "guthe_other on two points"
    for name in ("guthe", "nothing"):
        with pytest.raises(ValueError, match="guthe_other on two points"):
            bisection.case_named(name, file)
    for name in ("build/bvh", "closest"):
        with pytest.raises(ValueError, match="kernels count no work"):
            bisection.case_named(name, file)
    file.write_text(EXPERIMENT.replace("guthe", "cover"))
    assert bisection.case_named("cover on", file).name.startswith(
        "cover"
    )  # "c" also begins the name of a kernel, closest/bvh/cold
    with pytest.raises(ValueError, match="more than one case"):
        bisection.case_named("c", file)
