"""Malicious result files with valid hashes are refused before their content is used.

Damaged files, whose hashes are wrong, are in tests/program/test_results.py.
"""

from __future__ import annotations

import hashlib
import json
import os
import random
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest

from program import EXPERIMENT, Program
from test_run import run, texts


def seal(file: Path) -> None:
    content = file.read_bytes()
    file.write_bytes(content + b"\nsha256 " + hashlib.sha256(content).hexdigest().encode() + b"\n")


@pytest.fixture(scope="module")
def good(program_file: str, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A result of four cases with repeats; two of them are read off the traces of the other two."""
    folder = tmp_path_factory.mktemp("good")
    experiment = folder / "tiny.toml"
    experiment.write_text(
        EXPERIMENT.replace("tolerances = [1e-3]", "tolerances = [1e-3, 1e-1]\ntrace = true")
        + '[[scene]]\nname = "back"\nsource = "sphere2"\ntarget = "sphere1"\n'
    )
    return run(Program(program_file, folder), experiment, folder)


Change = Callable[[h5py.File], None]


def attribute(name: str, value: object, **how: object) -> Change:
    def change(f: h5py.File) -> None:
        del f["meta"].attrs[name]
        f["meta"].attrs.create(name, value, **how)

    return change


def dataset(name: str, **how: object) -> Change:
    def change(f: h5py.File) -> None:
        del f[name]
        f.create_dataset(name, **how)

    return change


def link(name: str, to: object) -> Change:
    def change(f: h5py.File) -> None:
        del f[name]
        f[name] = to

    return change


def several(*changes: Change) -> Change:
    def change(f: h5py.File) -> None:
        for apply in changes:
            apply(f)

    return change


def value(name: str, row: int | slice, new: object) -> Change:
    def change(f: h5py.File) -> None:
        f[name][row] = new

    return change


def wide_integers(f: h5py.File) -> None:
    """Creates a dataset of 128-bit integers without data, because h5py cannot write them."""
    del f["cases/pose_index"]
    wide = h5py.h5t.STD_I64LE.copy()
    wide.set_size(16)
    h5py.h5d.create(f["cases"].id, b"pose_index", wide, h5py.h5s.create_simple((2,)))


def view_of_other_datasets(f: h5py.File) -> None:
    layout = h5py.VirtualLayout(shape=(2,), dtype="f8")
    layout[:] = h5py.VirtualSource("elsewhere.h5", "x", shape=(2,))
    del f["cases/lower"]
    f.create_virtual_dataset("cases/lower", layout)


def shared_samples(f: h5py.File) -> None:
    f["cases/trace_begin"][:] = 0
    f["cases/trace_end"][:] = len(f["trace/seconds"])


TEXT = h5py.string_dtype()

# change of the file -> text of the error
HOSTILE: dict[str, tuple[Change, str]] = {
    "an attribute of many integers": (
        attribute("schema_version", np.ones(8000, "i8")),
        "schema_version: is not one value",
    ),
    "an attribute of two integers": (
        attribute("cores", np.ones(2, "i8")),
        "cores: is not one value",
    ),
    "an attribute of many texts": (
        attribute("stem", np.array(["x" * 99] * 3000, object), dtype=TEXT),
        "stem: is not one value",
    ),
    "an attribute of no integer": (attribute("cores", h5py.Empty("i8")), "cores: is not one value"),
    "an attribute of no text": (attribute("stem", h5py.Empty(TEXT)), "stem: is not one value"),
    "an attribute of fixed length": (
        attribute("stem", np.bytes_(b"x" * 9)),
        "stem: holds texts of fixed length",
    ),
    "an attribute of pairs": (
        attribute("cores", np.zeros((), [("a", "i8"), ("b", "i8")])),
        "cores: does not hold an integer",
    ),
    "an attribute of an array type": (
        attribute("cores", np.zeros((1, 99), "i8"), dtype=np.dtype(("i8", (99,)))),
        "does not hold an integer",
    ),
    "an attribute of another type": (
        attribute("schema_version", 1.0),
        "schema_version: does not hold an integer",
    ),
    "an attribute out of range": (
        attribute("memory_bytes", np.uint64(2**64 - 1)),
        "out of range",
    ),
    "a column that is not stored": (
        dataset("cases/lower", shape=(2**50,), dtype="f8"),
        "more than are stored",
    ),
    "a column of empty chunks": (
        dataset("cases/lower", shape=(2**50,), dtype="f8", chunks=(1024,)),
        "more than are stored",
    ),
    "texts that are not stored": (
        dataset("cases/identity", shape=(2**40,), dtype=TEXT),
        "more than are stored",
    ),
    "a column of one number": (dataset("cases/lower", data=1.0), "neither a column nor a table"),
    "a column of nothing": (
        dataset("cases/lower", data=h5py.Empty("f8")),
        "neither a column nor a table",
    ),
    "a cube": (dataset("cases/lower", data=np.zeros((1, 1, 2))), "neither a column nor a table"),
    "pairs": (
        dataset("cases/lower", data=np.zeros(2, [("a", "f8"), ("b", "f8")])),
        "does not hold real numbers",
    ),
    "texts for numbers": (
        dataset("cases/lower", data=["1", "2"], dtype=TEXT),
        "does not hold real numbers",
    ),
    "numbers for texts": (dataset("cases/solver", data=[1, 2]), "does not hold texts"),
    "lists for texts": (
        dataset("cases/solver", shape=(2,), dtype=h5py.vlen_dtype("i4")),
        "does not hold texts",
    ),
    "texts of fixed length": (
        dataset("cases/solver", data=np.array([b"guthe", b"guthe"])),
        "texts of fixed length",
    ),
    "long numbers": (dataset("cases/lower", data=np.zeros(2, np.longdouble)), "more than 64 bits"),
    "long integers": (wide_integers, "more than 64 bits"),
    "another file's bytes": (
        dataset("cases/lower", shape=(2,), dtype="f8", external=[("/etc/passwd", 0, 16)]),
        "kept in another file",
    ),
    "a view of other datasets": (view_of_other_datasets, "view of other datasets"),
    "a link to another file": (
        link("cases/lower", h5py.ExternalLink("other.h5", "/cases/lower")),
        "in another file",
    ),
    "a link to itself": (link("cases/lower", h5py.SoftLink("/cases/lower")), "cases/lower"),
    "a group for a column": (link("cases/lower", h5py.SoftLink("/meta")), "cases/lower"),
    "an answer to case 4": (value("answers/case", 0, 4), "belongs to no case"),
    "an answer in round 2^40": (value("answers/round", 0, 2**40), "answers/round"),
    "a repeat of case -1": (value("repeats/case", 0, -1), "belongs to no case"),
    "a repeat of case 2^62": (value("repeats/case", 0, 2**62), "belongs to no case"),
    "a preparation of case 4": (value("preparation/case", 0, 4), "belongs to no case"),
    "a preparation in round 2^40": (
        value("preparation/round", 0, 2**40),
        "preparation/round holds",
    ),
    "a trace from -1": (value("cases/trace_begin", 0, -1), "share samples"),
    "a trace to 2^62": (value("cases/trace_end", 1, 2**62), "past the samples"),
    "traces on top of each other": (shared_samples, "share samples"),
    "a pose of another number": (
        value("cases/pose_index", 0, 2**32),
        "cases/pose_index holds 4294967296",
    ),
    "a triangle number that is too large": (
        value("cases/witness_source_element", 0, 2**32),
        "witness_source_element holds 4294967296",
    ),
    "options that are not an object": (value("cases/options", 0, "[" * 200_000), "damaged"),
}


# The files that `compare` accepts, because it does not read the damaged part.
NOT_COMPARED = {
    "a trace from -1",
    "a trace to 2^62",
    "traces on top of each other",
    "a triangle number that is too large",
    "options that are not an object",
}


@pytest.mark.parametrize("name", HOSTILE)
def test_hostile_results_are_refused(
    hausbench: Program, good: Path, tmp_path: Path, name: str
) -> None:
    change, said = HOSTILE[name]
    shutil.copy(good, tmp_path / "other.h5")
    bad = tmp_path / "bad.h5"
    shutil.copy(good, bad)
    with h5py.File(bad, "r+") as f:
        change(f)
    seal(bad)
    line = hausbench.fails("verify", bad)
    assert "bad.h5: damaged" in line and said in line and "signal" not in line
    if name in NOT_COMPARED:
        assert "answers: all the same" in hausbench("compare", bad, good).stdout
    else:
        assert "bad.h5" in hausbench.fails("compare", bad, good)


CONTRADICTIONS = {
    "an ok whose gap is above its tolerance": (
        value("cases/upper", 0, 1e9),
        "not within the tolerance",
    ),
    "an ok whose bound is not a number": (value("cases/upper", 0, np.nan), "not a number"),
    "an identity of another case": (value("cases/identity", 0, "0" * 64), "its identity"),
    "a tolerance that was not asked for": (value("cases/tolerance", 0, 0.5), "its identity"),
    "a tolerance made large by the size of A": (
        several(value("cases/upper", 0, 1e9), value("cases/source_diagonal", 0, 1e15)),
        "a diagonal of 1000000000000000",
    ),
    "a cutoff of a search that there is not": (
        several(value("cases/upper", 0, np.inf), value("cases/cutoff_used", 0, 0.05)),
        "in no search",
    ),
    "a status that its solver did not end with": (
        value("cases/status", 0, "budget"),
        "its solver ended with converged",
    ),
    "an upper bound that its own witness refutes": (
        several(value("cases/lower", slice(None), 0), value("cases/upper", slice(None), 1e-6)),
        "unsound",
    ),
    "the same with no lower bound": (
        several(value("cases/lower", slice(None), -1), value("cases/upper", slice(None), 0)),
        "unsound",
    ),
    "a witness of no element": (
        value("cases/witness_source_element", 0, 10**6),
        "names element 1000000 of the source",
    ),
}


@pytest.mark.parametrize("name", CONTRADICTIONS)
def test_verify_notices_a_row_that_contradicts_itself(
    hausbench: Program, good: Path, tmp_path: Path, name: str
) -> None:
    change, said = CONTRADICTIONS[name]
    bad = tmp_path / "bad.h5"
    shutil.copy(good, bad)
    assert hausbench("verify", bad).returncode == 0
    with h5py.File(bad, "r+") as f:
        change(f)
    done = hausbench("verify", bad)
    assert done.returncode == 1 and said in done.stdout + done.stderr, done.stdout + done.stderr


def test_flipped_bits_under_a_right_seal_take_nothing_down(
    hausbench: Program, good: Path, tmp_path: Path
) -> None:
    content = good.read_bytes()[:-73]
    moments = random.Random(12)
    bad = tmp_path / "bad.h5"
    refused = 0
    for _ in range(25):
        flipped = bytearray(content)
        for _ in range(moments.randrange(1, 5)):
            flipped[moments.randrange(min(len(content), 1 << 16))] ^= 1 << moments.randrange(8)
        bad.write_bytes(flipped)
        seal(bad)
        done = hausbench("verify", bad)
        assert done.returncode in (0, 1, 2), (done.returncode, done.stderr)
        refused += done.returncode == 2
        assert done.returncode != 2 or len(done.stderr.strip().splitlines()) == 1, done.stderr
    assert 0 < refused


def a_pipe(file: Path) -> None:
    file.unlink()
    os.mkfifo(file)


def a_folder(file: Path) -> None:
    file.unlink()
    (file / "inside").mkdir(parents=True)


def a_link_to_nothing(file: Path) -> None:
    file.unlink()
    file.symlink_to("nothing")


def half(file: Path) -> None:
    file.write_bytes(file.read_bytes()[: file.stat().st_size // 2])


def flipped(file: Path) -> None:
    content = bytearray(file.read_bytes())
    content[len(content) // 2] ^= 1
    file.write_bytes(content)


def many_values(file: Path) -> None:
    with h5py.File(file, "r+") as f:
        f.attrs["unreferenced"] = np.ones(8000, "i8")
    seal(file)


def of_another_model(file: Path) -> None:
    """The shape is complete and its content hash is right, but the cache's file name stands for
    another model."""
    (source,) = (path for path in file.parent.glob("*.h5") if path != file)
    shutil.copy(source, file)


@pytest.mark.parametrize(
    "spoil", [a_pipe, a_folder, a_link_to_nothing, half, flipped, many_values, of_another_model]
)
def test_a_shape_in_the_cache_that_cannot_be_used_is_made_again(
    hausbench: Program,
    experiment: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    spoil: Callable[[Path], None],
) -> None:
    monkeypatch.setenv("HAUSBENCH_CACHE", str(tmp_path / "cache"))
    run(hausbench, experiment, tmp_path)
    file, _ = sorted((tmp_path / "cache" / "shapes").glob("*.h5"))
    before = file.read_bytes()
    spoil(file)
    done = hausbench("run", experiment, "--results", tmp_path, "--fresh", "--quiet", timeout=60)
    assert done.returncode == 0 and texts(tmp_path / "tiny.h5", "cases/status") == [
        "ok"
    ], done.stderr
    assert file.read_bytes() == before


@pytest.mark.parametrize(
    "change", ["the mark of the seal", "a byte more", "a byte less", "text for a seal"]
)
def test_what_follows_the_data_is_their_seal_or_nothing(
    hausbench: Program, good: Path, tmp_path: Path, change: str
) -> None:
    """A file without a hash is accepted, so a damaged hash must not count as none: a changed byte
    in the data would go unnoticed."""
    content = bytearray(good.read_bytes())
    if change == "the mark of the seal":
        content[-72] ^= 1
    elif change == "a byte more":
        content += b"\n"
    elif change == "a byte less":
        del content[-1]
    else:
        content[-73:] = b"x" * 73
    bad = tmp_path / "bad.h5"
    bad.write_bytes(content)
    assert "bad.h5: damaged" in hausbench.fails("show", bad)
    bad.write_bytes(good.read_bytes()[:-73])
    assert hausbench("show", bad).returncode == 0


def test_a_journal_that_is_a_pipe_is_refused(
    hausbench: Program, experiment: Path, tmp_path: Path
) -> None:
    os.mkfifo(tmp_path / "tiny.journal")
    assert "tiny.journal: is not a regular file" in hausbench.fails(
        "run", experiment, "--results", tmp_path, "--quiet"
    )


def test_nothing_is_written_through_a_link(
    hausbench: Program, experiment: Path, tmp_path: Path
) -> None:
    """A link to another file, or a pipe, may have the name of the temporary file."""
    precious = tmp_path / "precious"
    precious.write_text("mine")
    (tmp_path / "tiny.h5.unfinished").symlink_to(precious)
    run(hausbench, experiment, tmp_path)
    os.mkfifo(tmp_path / "tiny.h5.unfinished")
    run(hausbench, experiment, tmp_path, "--fresh")
    assert precious.read_text() == "mine"


ESCAPES = "\x1b]0;owned\x07\x1b[2J\u009b31m\u202e\nunsound: forged"


def rewritten(good: Path, bad: Path, change: Change) -> Path:
    shutil.copy(good, bad)
    with h5py.File(bad, "r+") as f:
        change(f)
    seal(bad)
    return bad


def steers_nothing(done: subprocess.CompletedProcess[str]) -> None:
    text = done.stdout + done.stderr
    assert all(c == "\n" or c.isprintable() for c in text), ascii(text)
    assert not any(line.startswith("unsound: forged") for line in text.splitlines()), text


def test_texts_of_a_file_do_not_steer_the_terminal(
    hausbench: Program, good: Path, tmp_path: Path
) -> None:
    def escapes(f: h5py.File) -> None:
        for name in ("label", "scene", "variant", "reason"):
            f["cases"][name][:] = [f"{name}{ESCAPES}" for _ in f["cases"][name]]
        f["cases/status"][0] = "failed"

    def other_answer(f: h5py.File) -> None:
        escapes(f)
        f["cases/upper"][:] = f["cases/upper"][:] * 2
        f["meta"].attrs["build"] = "\x1b[31m"

    bad, second = rewritten(good, tmp_path / "bad.h5", escapes), rewritten(
        good, tmp_path / "other.h5", other_answer
    )
    verbs: list[tuple[str | Path, ...]] = [
        ("verify", bad),
        ("compare", bad, second),
        ("merge", tmp_path / "out.h5", bad, second),
        ("show", bad),
        ("show", "--json", bad),
        ("show", "--summary", bad),
        ("show", bad, "--solver", "x"),
        ("compare", "--solver", "a", "b", bad),
        ("merge", "--any-build", tmp_path / "any.h5", bad, second),
    ]
    for verb in verbs:
        steers_nothing(hausbench(*verb))
    assert all(
        c == "\n" or c.isprintable() for c in hausbench("show", "--csv", bad).stdout
    )  # a quoted cell may contain line breaks


def test_texts_of_an_experiment_do_not_steer_the_terminal(
    hausbench: Program, experiment: Path, tmp_path: Path
) -> None:
    text = experiment.read_text()
    hostile = r"\u001b]0;owned\u0007\u009b31m\u202e\nunsound: forged"
    experiment.write_text(
        text.replace('"a test"', f'"{hostile}"').replace('"spheres"', f'"s{hostile}"')
        + f'label = "g{hostile}"\n'
    )
    for verb in ("explain", "run"):
        done = hausbench(verb, experiment, "--results", tmp_path)
        assert done.returncode == 0, done.stderr
        steers_nothing(done)
    steers_nothing(hausbench("explain", experiment, "--solver", "x"))
    steers_nothing(hausbench("explain", experiment, "--scene", "x\x1b[2J"))


def defines(model: str) -> Change:
    """Makes the experiment stored in the file define the file's first model."""

    def change(f: h5py.File) -> None:
        f["models/name"][0] = "trap"
        toml = f["meta"].attrs["experiment_toml"] + model
        del f["meta"].attrs["experiment_toml"]
        f["meta"].attrs["experiment_toml"] = toml

    return change


GENERATED = '\n[model.{}]\nsource = "generated"\nrecipe = '
TRAPS = {
    "a device": ('\n[model.trap]\npath = "/dev/zero"\nformat = "off"\n', "is not a regular file"),
    "a pipe": ('\n[model.trap]\npath = "PIPE"\nformat = "off"\n', "is not a regular file"),
    "a file of the kernel": (
        '\n[model.trap]\npath = "/proc/self/maps"\nformat = "xyz"\n',
        "is empty",
    ),
    "a long chain": (
        GENERATED.format("m0")
        + '"icosphere"\nlevel = 1\nradius = 1\n'
        + "".join(f'[model.m{i}]\nfrom = "m{i - 1}"\noperation = "weld"\n' for i in range(1, 500))
        + '[model.trap]\nfrom = "m499"\noperation = "weld"\n',
        "more than 100 models",
    ),
    "many points": (
        GENERATED.format("trap") + '"uniform_points"\ncount = 100000000\nseed = 1\n',
        "would take about",
    ),
    "subdivisions": (
        GENERATED.format("ball")
        + '"icosphere"\nlevel = 1\nradius = 1\n[model.finer]\nfrom = "ball"\noperation = "subdivide"\n'
        'levels = 4\n[model.trap]\nfrom = "finer"\noperation = "subdivide"\nlevels = 8\n',
        "would take about",
    ),
    "copies": (
        GENERATED.format("ball")
        + '"icosphere"\nlevel = 1\nradius = 1\n[model.trap]\nfrom = "ball"\noperation = "repeat"\n'
        "count = 10000000\nvertices = 1\nx = 1\ny = 0\nz = 0\ngrow = 0\n",
        "would take about",
    ),
}


@pytest.mark.parametrize("name", TRAPS)
def test_models_of_a_hostile_result_fill_nothing(
    hausbench: Program, good: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    os.mkfifo(tmp_path / "pipe")
    monkeypatch.setenv("HAUSBENCH_CACHE", str(tmp_path / "cache"))
    model, said = TRAPS[name]
    bad = rewritten(
        good, tmp_path / "bad.h5", defines(model.replace("PIPE", str(tmp_path / "pipe")))
    )
    assert said in hausbench.fails("verify", bad)
    assert said in hausbench.fails("merge", tmp_path / "out.h5", bad, bad)
    assert not list((tmp_path / "cache").rglob("*")) and not (tmp_path / "out.h5").exists()


def test_models_of_a_result_stay_out_of_the_cache(
    hausbench: Program, experiment: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The rows are still checked, but a result must not put its models into the user's cache."""
    experiment.write_text(
        experiment.read_text().replace('"sphere1"', '"mine"')
        + GENERATED.format("mine")
        + '"icosphere"\nlevel = 2\nradius = 3\n'
    )
    file = run(hausbench, experiment, tmp_path)
    monkeypatch.setenv("HAUSBENCH_CACHE", str(tmp_path / "cache"))
    done = hausbench("verify", file)
    assert done.returncode == 0 and "guthe" in done.stdout, done.stderr
    assert not list((tmp_path / "cache").rglob("*.h5"))


def test_pipes_among_the_results_are_passed_over(
    hausbench: Program, experiment: Path, tmp_path: Path
) -> None:
    pipe = tmp_path / "pipe.h5"
    os.mkfifo(pipe)
    os.mkfifo(tmp_path / "pipe.journal")
    assert hausbench("explain", experiment, "--results", tmp_path, timeout=60).returncode == 0
    assert hausbench("run", experiment, "--results", tmp_path, timeout=60).returncode == 0
    verbs: list[tuple[str | Path, ...]] = [
        ("verify", pipe),
        ("compare", pipe, pipe),
        ("show", pipe),
    ]
    for verb in verbs:
        assert "is not a regular file" in hausbench.fails(*verb)
    assert "cannot be read" in hausbench.fails("verify", "--certificate", pipe)


@pytest.mark.parametrize("device", ["pipe", "/dev/zero"])
def test_an_experiment_and_what_it_names_are_regular_files(
    hausbench: Program, experiment: Path, tmp_path: Path, device: str
) -> None:
    odd = tmp_path / device
    if device == "pipe":
        os.mkfifo(odd)
    good = experiment.read_text()
    for verb in ("run", "explain", "status"):
        assert f"{odd}: is not a regular file" in hausbench.fails(verb, odd)
        assert f"{odd}: is not a regular file" in hausbench.fails(verb, experiment, "--plugin", odd)
    experiment.write_text(f"plugins = [{json.dumps(str(odd))}]\n{good}")
    assert "is not a regular file" in hausbench.fails("run", experiment)
    experiment.write_text(
        good.replace(
            'target = "sphere2"',
            f'target = "sphere2"\nmotion = {{ kind = "poses", file = {json.dumps(str(odd))} }}',
        )
    )
    done = hausbench("run", experiment, "--results", tmp_path, timeout=60)
    assert "is not a regular file" in done.stderr + (
        texts(tmp_path / "tiny.h5", "cases/reason")[0] if done.returncode == 0 else ""
    )


def test_an_empty_folder_name_is_refused(hausbench: Program, experiment: Path) -> None:
    for verb in ("run", "explain", "status"):
        assert "--results: the name of the folder is empty" in hausbench.fails(
            verb, experiment, "--results", ""
        )


def test_models_are_not_taken_from_a_folder_that_others_can_write(
    program_file: str, tmp_path: Path
) -> None:
    below = tmp_path / "planted" / "below"
    below.mkdir(parents=True)
    manifest = tmp_path / "planted" / "datasets" / "manifest.toml"
    manifest.parent.mkdir()
    manifest.write_text('[model.planted]\nsource = "generated"\nrecipe = "needle"\nratio = 2.0\n')
    environment = {
        name: value
        for name, value in os.environ.items()
        if name not in ("HAUSBENCH_ROOT", "HAUSBENCH_CACHE")
    }

    def models() -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [program_file, "list", "models"],
            cwd=below,
            env=environment,
            capture_output=True,
            text=True,
            timeout=60,
        )

    assert models().returncode == 0 and "planted" in models().stdout
    for place in (tmp_path / "planted", manifest.parent, manifest):
        mode = place.stat().st_mode
        place.chmod(mode | 0o002)
        done = models()
        assert (
            done.returncode == 2
            and f"{place}: another user can write to it" in done.stderr
            and "HAUSBENCH_ROOT" in done.stderr
        )
        place.chmod(mode)
    assert models().returncode == 0
