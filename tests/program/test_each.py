"""Scenes with `each`: one scene per model of a list or of the corpus. Halved and remeshed copies
need no entry in the manifest."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from program import TETRAHEDRON, Program
from test_results import run_in
from test_run import numbers, texts

SCENE = '[[scene]]\nname = "{}"\nsource = "{}"\ntarget = "{}_half"\n'
NAMES = ["ball", "cube", "torus"]


@pytest.fixture
def root(tmp_path: Path) -> Path:
    """The corpus has three models, one of which is in the manifest."""
    folder = tmp_path / "root"
    (folder / "datasets").mkdir(parents=True)
    (folder / "datasets" / "manifest.toml").write_text(
        '[model.ball]\nsource = "generated"\nrecipe = "icosphere"\nlevel = 2\nradius = 1.0\n'
        '[model.other]\nsource = "generated"\nrecipe = "icosphere"\nlevel = 1\nradius = 1.0\n'
    )
    (folder / "datasets" / "corpus.toml").write_text(
        'manifest = ["ball"]\n[model.torus]\nsource = "generated"\nrecipe = "torus"\nrings = 12\nsides = 8\nmajor = 1.0\nminor = 0.4\n'
        '[model.cube]\nsource = "generated"\nrecipe = "cube"\nsubdivisions = 4\n'
    )
    return folder


def write(file: Path, scenes: str) -> Path:
    file.write_text(
        f'title = "pairs"\ntolerances = [1e-3]\nof = "diagonal"\nrepeats = 1\n{scenes}[[solver]]\nname = "sacht"\n'
    )
    return file


def measured(hausbench: Program, root: Path, file: Path, *more: str) -> Path:
    done = run_in(hausbench, root, "run", file, "--results", file.parent, "--quiet", *more)
    assert done.returncode == 0, done.stderr
    return file.with_suffix(".h5")


def fails(hausbench: Program, root: Path, file: Path) -> str:
    done = run_in(hausbench, root, "run", file, "--results", file.parent, "--quiet")
    assert done.returncode == 2 and len(done.stderr.strip().splitlines()) == 1, done.stderr
    return done.stderr.strip()


def test_each_is_the_same_as_scenes_written_out(
    hausbench: Program, root: Path, tmp_path: Path
) -> None:
    corpus = measured(
        hausbench,
        root,
        write(tmp_path / "corpus.toml", SCENE + 'each = "corpus"\nnote = "{} and its half"\n'),
    )
    assert texts(corpus, "cases/scene") == NAMES and texts(corpus, "cases/status") == ["ok"] * 3
    assert texts(corpus, "cases/target") == [f"{name}_half" for name in NAMES]
    assert texts(corpus, "cases/scene_note")[1] == "cube and its half"
    assert list(numbers(corpus, "cases/target_elements")) == [
        n // 2 for n in numbers(corpus, "cases/source_elements")
    ]
    listed = measured(
        hausbench, root, write(tmp_path / "listed.toml", SCENE + f"each = {NAMES[::-1]}\n")
    )
    assert texts(listed, "cases/scene") == NAMES[::-1]
    by_hand = measured(
        hausbench,
        root,
        write(tmp_path / "hand.toml", "".join(SCENE.replace("{}", name) for name in NAMES)),
    )
    for file in (corpus, listed):
        assert sorted(texts(file, "cases/identity")) == sorted(texts(by_hand, "cases/identity"))


def test_the_whole_corpus_has_more(hausbench: Program, root: Path, tmp_path: Path) -> None:
    """`whole_corpus` adds models that `corpus` leaves out: one of the manifest, and one with a
    table of its own."""
    file = root / "datasets" / "corpus.toml"
    text = file.read_text()
    file.write_text(
        'whole_manifest = ["other"]\n'
        + text
        + '[whole.plain]\nsource = "generated"\nrecipe = "cube"\nsubdivisions = 3\n'
    )
    whole = measured(
        hausbench, root, write(tmp_path / "whole.toml", SCENE + 'each = "whole_corpus"\n')
    )
    assert texts(whole, "cases/scene") == sorted([*NAMES, "other", "plain"]) and set(
        texts(whole, "cases/status")
    ) == {"ok"}
    corpus = measured(hausbench, root, write(tmp_path / "corpus.toml", SCENE + 'each = "corpus"\n'))
    assert texts(corpus, "cases/scene") == NAMES
    file.write_text('whole_manifest = ["nobody"]\n' + text)
    assert "'whole_manifest' names 'nobody'" in fails(
        hausbench, root, write(tmp_path / "s.toml", SCENE + 'each = "whole_corpus"\n')
    )
    file.write_text('whole_manifest = ["ball"]\n' + text)
    assert "'ball' is listed twice" in fails(
        hausbench, root, write(tmp_path / "s.toml", SCENE + 'each = "corpus"\n')
    )


def test_a_damaged_mesh_costs_its_own_rows_alone(
    hausbench: Program, root: Path, tmp_path: Path
) -> None:
    datasets = root / "datasets"
    (datasets / "bad.off").write_text(TETRAHEDRON.replace("1 0 0", "1 nan 0"))
    (datasets / "soup.off").write_text(TETRAHEDRON)  # edge collapse cannot halve four triangles
    with (datasets / "corpus.toml").open("a") as out:
        out.write(
            "".join(
                f'[model.{name}]\nsource = "file"\npath = "{name}.off"\n'
                for name in ("bad", "soup")
            )
        )
        out.write(
            f'[model.gone]\nsource = "debian"\npackage = "p"\nversion = "1"\npath = "gone.off"\nsha256 = "{"a" * 64}"\n'
        )
    result = measured(hausbench, root, write(tmp_path / "all.toml", SCENE + 'each = "corpus"\n'))
    assert texts(result, "cases/scene") == ["bad", "ball", "cube", "gone", "soup", "torus"]
    assert texts(result, "cases/status") == ["failed", "ok", "ok", "skipped", "failed", "ok"]
    reasons = texts(result, "cases/reason")
    assert (
        "bad.off" in reasons[0]
        and "package p was not fetched: run `hausbench fetch --corpus`" in reasons[3]
        and "simplify" in reasons[4]
    )


def test_scenes_are_chosen_one_by_one_or_together(
    hausbench: Program, root: Path, tmp_path: Path
) -> None:
    file = write(tmp_path / "s.toml", SCENE + 'each = "corpus"\n')
    assert texts(measured(hausbench, root, file, "--fresh", "--scene", "cube"), "cases/scene") == [
        "cube"
    ]
    assert (
        sorted(texts(measured(hausbench, root, file, "--fresh", "--scene", "{}"), "cases/scene"))
        == NAMES
    )


BAD = {
    'each = "corpse"': '"corpus", "whole_corpus" or a list',
    "each = 3": '"corpus", "whole_corpus" or a list',
    "each = []": "names no model: list some",
    "each = ['ball', 'ball']": "names a model twice",
    "each = ['bal']": "no model 'bal', did you mean 'ball'",
    "each = ['other']": "'other' is not of the corpus: list it under 'manifest' in datasets/corpus.toml",
    "": "'name' has {}, but the scene no 'each'",
    "each = ['ball']\nexact = 0.5": "'exact' cannot be combined with 'each'",
    "each = ['ball']\ntargets = ['ball']": "'targets'",
}


@pytest.mark.parametrize("text", BAD)
def test_mistakes_are_named_with_their_line(
    hausbench: Program, root: Path, tmp_path: Path, text: str
) -> None:
    said = fails(hausbench, root, write(tmp_path / "s.toml", SCENE + text + "\n"))
    assert BAD[text].split(", did")[0] in said and "s.toml:" in said
    line = int(said.split("s.toml:")[1].split(":")[0])
    assert line == {
        "": 6,
        "each = ['ball']\nexact = 0.5": 10,
        "each = ['ball']\ntargets = ['ball']": 10,
    }.get(text, 9)


@pytest.mark.parametrize(
    ("scene", "words"),
    [
        ('name = "pairs"\nsource = "{}"\ntarget = "ball"\n', "'name' has no {}"),
        ('name = "{}"\nsource = "ball"\ntarget = "cube"\n', "neither 'source' nor 'target' has {}"),
    ],
)
def test_the_place_of_the_name_is_asked_for(
    hausbench: Program, root: Path, tmp_path: Path, scene: str, words: str
) -> None:
    assert words in fails(
        hausbench, root, write(tmp_path / "s.toml", "[[scene]]\n" + scene + "each = ['ball']\n")
    )


def test_without_a_corpus_the_error_says_so(hausbench: Program, root: Path, tmp_path: Path) -> None:
    (root / "datasets" / "corpus.toml").unlink()
    said = fails(hausbench, root, write(tmp_path / "s.toml", SCENE + 'each = "corpus"\n'))
    assert "s.toml:9" in said and "no datasets/corpus.toml" in said


def test_lists_are_not_drowned(hausbench: Program, root: Path) -> None:
    (root / "experiments").mkdir()
    write(root / "experiments" / "s.toml", SCENE + 'each = "corpus"\n')
    models = run_in(hausbench, root, "list", "models").stdout
    assert "torus" not in models and "and 2 more meshes of the corpus" in models
    corpus = run_in(hausbench, root, "list", "corpus").stdout
    assert "torus" in corpus and "torus_half" not in corpus and "NAME_half" in corpus
    assert "simplify of torus" in run_in(hausbench, root, "list", "torus_half").stdout
    shown = run_in(hausbench, root, "list", "s").stdout
    assert (
        "3 scenes, such as 'ball': ball to ball_half" in " ".join(shown.split())
        and "cube" not in shown
    )
    assert (
        len(
            json.loads(run_in(hausbench, root, "list", "--json").stdout)["experiments"][0]["scenes"]
        )
        == 3
    )
