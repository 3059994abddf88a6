"""HDF5 files are opened only if the program, or the list of SHA-256 in results/reference, says
so."""

from __future__ import annotations

import os
from pathlib import Path

import h5py
import pytest

from analysis.shared import gate, load
from analysis.shared.results import ResultError
from synthetic import ResultFile


def test_the_list_has_every_kept_file() -> None:
    sums = gate.read_sums()
    there = {
        path.relative_to(gate.REFERENCE).as_posix(): gate.sha256(path)
        for path in gate.REFERENCE.rglob("*")
        if path.is_file() and path.name != gate.SUMS
    }
    assert len(sums) > 50
    assert there == sums, "if the change is right, run `make reference-sums`"


def result(folder: Path) -> Path:
    file = ResultFile("kept")
    file.case("naive", "x", [1.0], lower=0.5, upper=0.5)
    return file.write(folder)


def test_a_kept_result_needs_no_program(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = result(tmp_path)
    monkeypatch.setattr(gate, "REFERENCE", tmp_path)
    monkeypatch.setenv("HAUSBENCH_PROGRAM", str(tmp_path / "none"))
    (tmp_path / gate.SUMS).write_text(f"{gate.sha256(path)}  kept.h5\n")
    assert load.load(path).cases.lower[0] == 0.5
    with h5py.File(path, "r+") as file:
        file["cases/lower"][0] = 0.25
    with pytest.raises(
        ResultError, match=r"kept\.h5: damaged: has another SHA-256 than .*SHA256SUMS"
    ):
        load.load(path)
    (tmp_path / gate.SUMS).write_text("")
    os.utime(path)
    with pytest.raises(ResultError, match="make reference-sums"):
        load.load(path)


def test_without_the_program_nothing_is_opened(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = result(tmp_path)
    monkeypatch.setenv("HAUSBENCH_PROGRAM", str(tmp_path / "none"))
    with pytest.raises(ResultError, match="none: cannot be run"):
        load.load(path)
    monkeypatch.setenv("HAUSBENCH_PROGRAM", "/usr/bin/false")
    with pytest.raises(ResultError, match="'vet' failed"):
        load.load(path)
    monkeypatch.delenv("HAUSBENCH_PROGRAM")
    monkeypatch.setattr(gate, "ROOT", tmp_path / "a" / "b")
    monkeypatch.setenv("PATH", "")
    with pytest.raises(ResultError, match="make build"):
        load.load(path)


def test_one_call_checks_many_files_and_a_changed_one_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    paths = [result(tmp_path / str(k)) for k in range(5)]
    counts, ask = list[int](), gate.ask

    def counted(verb: str, files: list[Path]) -> list[str]:
        counts.append(len(files))
        return ask(verb, files)

    monkeypatch.setattr(gate, "ask", counted)
    assert len(load.load_all(paths)) == 5 and len(load.load_all(paths)) == 5 and counts == [5]
    with h5py.File(paths[2], "r+") as file:
        del file["cases/lower"]
        file["cases/lower"] = h5py.SoftLink("/cases/upper")
    assert len(load.load_all(paths)) == 4 and counts == [5, 1]
