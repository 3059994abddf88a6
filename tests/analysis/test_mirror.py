"""analysis/ has the same folders as experiments/, so that each experiment's script is easy to
find."""

from __future__ import annotations

import re
import subprocess

import pytest

from analysis.shared.results import ResultError
from analysis.shared.stems import ANALYSIS, SCRIPTS, has_script, module_of, script_of

EXPERIMENTS = ANALYSIS.parent / "experiments"


def test_scripts_lie_where_their_experiments_do() -> None:
    experiments = {
        file.stem: file.parent.relative_to(EXPERIMENTS) for file in EXPERIMENTS.rglob("*.toml")
    }
    scripts = {
        stem: script_of(stem).parent.relative_to(ANALYSIS)
        for stem in experiments
        if has_script(stem)
    }
    assert scripts == {stem: experiments[stem] for stem in scripts}
    assert set(experiments) - set(scripts) == {
        "smoke",
        "tracking",
    }  # smoke has no figure, and bench/tracking draws tracking


def test_no_two_scripts_have_one_name() -> None:
    names = [*(file.stem for file in ANALYSIS.rglob("*.py")), *SCRIPTS]
    assert len(names) == len(set(names))


def test_walk_knows_the_stems_that_share_a_script() -> None:
    """Runs only this line of tools/walk for each experiment."""
    line = next(
        line
        for line in (ANALYSIS.parent / "tools" / "walk").read_text(encoding="utf-8").splitlines()
        if line.startswith("has_script()")
    )
    stems = sorted(file.stem for file in EXPERIMENTS.rglob("*.toml"))
    commands = "\n".join([line, *[f"has_script {stem} && echo {stem}" for stem in stems], "true"])
    printed = subprocess.run(
        ["bash", "-c", commands],
        cwd=ANALYSIS.parent,
        capture_output=True,
        encoding="utf-8",
        check=True,
    ).stdout
    assert printed.split() == [stem for stem in stems if has_script(stem)]


def test_module_of_a_stem() -> None:
    assert (
        module_of("zhang2017_table3") == "analysis.zhang2017.zhang2017_table3"
        and module_of("overview") == "analysis.overview"
    )
    assert (
        module_of("corpus_remesh") == module_of("corpus_decimation") == "analysis.corpus.every_mesh"
    )
    with pytest.raises(ResultError, match="no analysis/<folder>/nothing.py"):
        module_of("nothing")


def test_shared_code_knows_no_stem() -> None:
    """Shared code imports nothing from the folder of a single experiment."""
    for file in (ANALYSIS / "shared").glob("*.py"):
        imports = [
            line
            for line in file.read_text(encoding="utf-8").splitlines()
            if line.startswith(("from analysis", "import analysis"))
        ]
        assert all(line.startswith("from analysis.shared") for line in imports), file.name


def test_no_stem_starts_a_program() -> None:
    """Figures depend only on result files and the cache of shapes. Only the command that copies the
    program's tables, the picture of `measure`, the gate that vets files and the check of the
    references run the program; documents run pdflatex.
    """
    starts = re.compile(r"\b(subprocess|HAUSBENCH_PROGRAM|os\.(system|exec\w*|spawn\w*|popen))\b")
    assert [
        file.name for file in sorted(ANALYSIS.rglob("*.py")) if starts.search(file.read_text())
    ] == ["check_reference.py", "document.py", "picture.py", "schema.py", "gate.py"]
