"""Reads result files (HDF5). Only this module depends on their layout, which results/README.md describes."""

from __future__ import annotations

import dataclasses
import hashlib
import tomllib
from pathlib import Path
from typing import Any, TypeVar

import h5py
import numpy as np
import numpy.typing as npt

from analysis.shared import remedy
from analysis.shared.columns import DEFAULTS, Answers, Cases, Fields, Floats, Ledger, Models, Preparation, Repeats, Trace
from analysis.shared.results import ResultError, Results

SCHEMA_VERSION = 2
REFERENCE = Path(__file__).resolve().parents[2] / "results" / "reference"
ANOTHER = "name a result file written by 'hausbench run'"
SEAL_BEGIN, SEAL_LENGTH = b"\nsha256 ", 73  # the last line of a file: this, 64 digits and a newline

Columns = TypeVar("Columns", Models, Cases, Answers, Repeats, Preparation, Trace, Fields, Ledger)


def _column(group: Any, name: str, kind: str) -> npt.NDArray[Any]:
    data = group[name]
    if (h5py.check_string_dtype(data.dtype) is not None) != (kind == "Texts"):
        raise KeyError(f"{data.name} of type {kind}")
    if kind == "Texts":
        return np.asarray(data.asstr()[()], dtype=object)
    return np.asarray(data[()], dtype={"Floats": np.float64, "Ints": np.int64, "Counters": np.uint64}[kind])


NEEDED = ("cases/identity", "cases/solver", "cases/scene", "cases/status", "cases/lower", "cases/upper", "cases/tolerance",
          "models/name", "models/sha256", "ledger/kind", "trace/seconds")


def _columns(kind: type[Columns], file: Any, name: str) -> Columns:
    """Reads one group. Unknown columns are ignored; a column that the file lacks gets its default."""
    group, values = file.get(name, {}), dict[str, Any]()
    for path in NEEDED:
        if path.startswith(f"{name}/") and path not in file:
            raise KeyError(path)
    for field in dataclasses.fields(kind):
        if field.type == "Counters":
            values[field.name] = {key.removeprefix("counter_"): _column(group, key, "Counters")
                                  for key in group if key.startswith("counter_")}
        elif field.name in group:
            values[field.name] = _column(group, field.name, str(field.type))
    lengths = {len(column) for field, column in values.items() if field != "counters"}
    lengths |= {len(column) for column in values.get("counters", {}).values()}
    if len(lengths) > 1:
        raise KeyError(f"/{name} with columns of one length")
    count = max(lengths, default=0)
    for field in dataclasses.fields(kind):
        if field.name not in values:
            values[field.name] = _usual(DEFAULTS[f"{name}/{field.name}"], count, str(field.type))
    return kind(**values)


def _values(file: Any) -> Floats:
    return np.asarray(_column(file["fields"], "values", "Floats")) if "fields" in file else np.empty(0)


def _usual(value: Any, count: int, kind: str) -> npt.NDArray[Any]:
    dtype: Any = {"Texts": object, "Floats": np.float64, "Ints": np.int64}[kind]
    return np.array([value] * count, dtype=dtype).reshape(count, *np.shape(value))


def _end_of_data(head: bytes) -> int | None:
    """Returns the offset at which the data of an HDF5 file end, read from its first bytes; None if unknown.

    See "Superblock" in the HDF5 specification. Files whose addresses do not have 8 bytes are not supported.
    """
    if len(head) < 52 or not head.startswith(b"\x89HDF\r\n\x1a\n") or head[8] > 3 or head[13 if head[8] < 2 else 9] != 8:
        return None
    return int.from_bytes(head[(at := {0: 40, 1: 44}.get(head[8], 28)):at + 8], "little")


def _begins_as_hdf5(path: Path) -> bool:
    with path.open("rb") as file:
        return file.read(8) == b"\x89HDF\r\n\x1a\n"


def _has_broken_seal(path: Path) -> bool:
    """Tells whether the data are followed by anything but the line with their SHA-256, as in a damaged file.

    A file that another program rewrote ends with its data and passes.
    """
    with path.open("rb") as file:
        end, left = _end_of_data(file.read(64)), path.stat().st_size - SEAL_LENGTH
        file.seek(max(0, left))
        seal = file.read(SEAL_LENGTH + 1)
        if end is not None and path.stat().st_size > end and left != end:
            return True
        if left < 0 or not seal.startswith(SEAL_BEGIN):
            return left == end
        digest = hashlib.sha256()
        file.seek(0)
        while left > 0 and (part := file.read(min(left, 2**20))):
            digest.update(part)
            left -= len(part)
    return seal != SEAL_BEGIN + digest.hexdigest().encode() + b"\n"


def _attribute(value: Any) -> Any:
    if isinstance(value, bytes):
        return value.decode()
    return value.item() if isinstance(value, (np.generic, np.ndarray)) and np.size(value) == 1 else value


def _of_profile(results: Results, profile: str) -> Results:
    """Returns the results with only the rows that the experiment requests in this profile."""
    asked = [not profiles or profile in profiles.split(",") for profiles in results.cases.profile]
    keep = np.flatnonzero(asked)
    if len(keep) == len(results.cases):
        return results
    number = np.full(len(results.cases), -1)
    number[keep] = np.arange(len(keep))

    def rows(group: Any, kept: Any) -> Any:
        columns = {field.name: getattr(group, field.name)[kept] for field in dataclasses.fields(group) if field.name != "counters"}
        if hasattr(group, "counters"):
            columns["counters"] = {name: counts[kept] for name, counts in group.counters.items()}
        return type(group)(**columns)

    def details(group: Any) -> Any:
        left = rows(group, number[group.case] >= 0)
        return dataclasses.replace(left, case=number[left.case])

    ledger = results.ledger
    return dataclasses.replace(results, cases=rows(results.cases, keep), answers=details(results.answers), repeats=details(results.repeats),
                               preparation=details(results.preparation), fields=details(results.fields),
                               ledger=rows(ledger, [not of or of == profile for of in ledger.profile]))


def _by_statistic(cases: Cases) -> Cases:
    """Adds the statistic to the name of its scene, as in "bunny → half, mean", so that each is compared and drawn alone."""
    named = [f"{scene}, {statistic}{' by number' if weigh == 'number' else ''}" if statistic else scene
             for scene, statistic, weigh in zip(cases.scene, cases.statistic, cases.weigh)]
    return dataclasses.replace(cases, scene=np.array(named, dtype=object))


def load(path: Path, profile: str = "") -> Results:
    """Reads a result file and returns its rows of `profile`, by default the profile of the latest run.

    Raises ResultError if the file is missing or damaged, is not a result file, or has a newer schema.
    """
    stem = path.stem.removesuffix(".everything")  # `run --leave-nothing-out` adds the suffix
    if not path.is_file():
        raise ResultError(f"{path}: no such file: measure it with {remedy.measure(stem)}")
    whole = f"take an intact copy, or move it away and measure again with {remedy.measure(stem)}"
    try:
        if _has_broken_seal(path):
            raise ResultError(f"{path}: damaged: its bytes do not match the SHA-256 at its end: {whole}")
        with h5py.File(path, "r") as file:
            meta = {key: _attribute(value) for key, value in file["meta"].attrs.items()}
            if int(meta["schema_version"]) > SCHEMA_VERSION:
                raise ResultError(f"{path}: schema version {meta['schema_version']} is newer than {SCHEMA_VERSION}, "
                                  f"the newest that analysis/shared/load.py reads: use the analysis/ of hausbench "
                                  f"{meta.get('hausbench_version', 'that wrote it')}")
            results = Results(path, meta, _columns(Models, file, "models"), _columns(Cases, file, "cases"),
                              _columns(Answers, file, "answers"), _columns(Repeats, file, "repeats"), _columns(Preparation, file, "preparation"),
                              _columns(Trace, file, "trace"), _columns(Fields, file, "fields"), _values(file),
                              _columns(Ledger, file, "ledger"))
    except PermissionError as problem:
        raise ResultError(f"{path}: {problem.strerror}") from None
    except OSError:
        raise ResultError(f"{path}: damaged: {whole}" if _begins_as_hdf5(path) else f"{path}: not an HDF5 file: {ANOTHER}") from None
    except (KeyError, TypeError, ValueError, AttributeError) as problem:
        text = str(problem.args[0]) if problem.args else ""
        raise ResultError(f"{path}: not a hausbench result file ({text}): {ANOTHER}") from None
    if meta.get("stem") != stem:
        raise ResultError(f"{path}: has the experiment '{meta.get('stem')}', not '{stem}': rename it to {meta.get('stem')}.h5")
    results = _of_profile(results, profile or str(meta.get("profile", "")))
    results = dataclasses.replace(results, cases=_by_statistic(results.cases))
    if len(results.cases) == 0:
        raise ResultError(f"{path}: has no cases of profile '{meta.get('profile')}': measure them with "
                          f"{remedy.measure(stem, str(meta.get('experiment_file', '')))}")
    return results


def paper_numbers(name: str) -> dict[str, Any]:
    """Returns the numbers that a paper prints, from results/reference/<name>.toml."""
    with (REFERENCE / f"{name}.toml").open("rb") as file:
        return tomllib.load(file)
