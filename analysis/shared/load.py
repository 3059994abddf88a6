"""Reads result files (HDF5). Only this module depends on their layout, which results/README.md
describes."""

from __future__ import annotations

import dataclasses
import json
import sys
import tomllib
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, TypeVar

import h5py
import numpy as np
import numpy.typing as npt

from analysis.shared import gate, remedy
from analysis.shared.columns import (
    DEFAULTS,
    Answers,
    Cases,
    Fields,
    Floats,
    Ledger,
    Models,
    Preparation,
    Repeats,
    Trace,
)
from analysis.shared.printable import printable
from analysis.shared.results import ResultError, Results

SCHEMA_VERSION = 2
REFERENCE = gate.REFERENCE
ANOTHER = "name a result file written by 'hausbench run'"

Made = TypeVar("Made")
Columns = TypeVar("Columns", Models, Cases, Answers, Repeats, Preparation, Trace, Fields, Ledger)


def _column(group: Any, name: str, kind: str) -> npt.NDArray[Any]:
    data = group[name]
    text = h5py.check_string_dtype(data.dtype) is not None
    if text != (kind == "Texts") or not (
        text or data.dtype.kind in ("f" if kind == "Floats" else "iu")
    ):
        raise KeyError(f"{data.name} of type {kind}")
    if kind == "Texts":
        return np.asarray(data.asstr(errors="replace")[()], dtype=object)
    return np.asarray(
        data[()], dtype={"Floats": np.float64, "Ints": np.int64, "Counters": np.uint64}[kind]
    )


NEEDED = (
    "cases/identity",
    "cases/solver",
    "cases/scene",
    "cases/status",
    "cases/lower",
    "cases/upper",
    "cases/tolerance",
    "models/name",
    "models/sha256",
    "ledger/kind",
    "trace/seconds",
)


def _columns(kind: type[Columns], file: Any, name: str) -> Columns:
    """Reads one group. Unknown columns are ignored; a column that the file lacks gets its
    default."""
    group, values = file.get(name, {}), dict[str, Any]()
    for path in NEEDED:
        if path.startswith(f"{name}/") and path not in file:
            raise KeyError(path)
    for field in dataclasses.fields(kind):
        if field.type == "Counters":
            values[field.name] = {
                key.removeprefix("counter_"): _column(group, key, "Counters")
                for key in group
                if key.startswith("counter_")
            }
        elif field.name in group:
            values[field.name] = _column(group, field.name, str(field.type))
            if values[field.name].shape[1:] != np.shape(DEFAULTS[f"{name}/{field.name}"]):
                raise KeyError(f"/{name}/{field.name} with as many numbers a row")
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
    return (
        np.asarray(_column(file["fields"], "values", "Floats")) if "fields" in file else np.empty(0)
    )


def _usual(value: Any, count: int, kind: str) -> npt.NDArray[Any]:
    dtype: Any = {"Texts": object, "Floats": np.float64, "Ints": np.int64}[kind]
    return np.array([value] * count, dtype=dtype).reshape(count, *np.shape(value))


def _begins_as_hdf5(path: Path) -> bool:
    with path.open("rb") as file:
        return file.read(8) == b"\x89HDF\r\n\x1a\n"


def _attribute(value: Any) -> Any:
    if isinstance(value, bytes):
        return value.decode()
    return (
        value.item()
        if isinstance(value, (np.generic, np.ndarray)) and np.size(value) == 1
        else value
    )


def _of_profile(results: Results, profile: str) -> Results:
    """Returns the results with only the rows that the experiment requests in this profile."""
    requested = [
        not profiles or profile in profiles.split(",") for profiles in results.cases.profile
    ]
    keep = np.flatnonzero(requested)
    if len(keep) == len(results.cases):
        return results
    number = np.full(len(results.cases), -1)
    number[keep] = np.arange(len(keep))

    def rows(group: Any, kept: Any) -> Any:
        columns = {
            field.name: getattr(group, field.name)[kept]
            for field in dataclasses.fields(group)
            if field.name != "counters"
        }
        if hasattr(group, "counters"):
            columns["counters"] = {name: counts[kept] for name, counts in group.counters.items()}
        return type(group)(**columns)

    def details(group: Any) -> Any:
        left = rows(group, number[group.case] >= 0)
        return dataclasses.replace(left, case=number[left.case])

    ledger = results.ledger
    return dataclasses.replace(
        results,
        cases=rows(results.cases, keep),
        answers=details(results.answers),
        repeats=details(results.repeats),
        preparation=details(results.preparation),
        fields=details(results.fields),
        ledger=rows(ledger, [not of or of == profile for of in ledger.profile]),
    )


def _by_statistic(cases: Cases) -> Cases:
    """Adds the statistic to the name of its scene, as in "bunny → half, mean", so that each is
    compared and drawn alone."""
    named = [
        f"{scene}, {statistic}{' by number' if weigh == 'number' else ''}" if statistic else scene
        for scene, statistic, weigh in zip(cases.scene, cases.statistic, cases.weigh)
    ]
    return dataclasses.replace(cases, scene=np.array(named, dtype=object))


def _expect_places(results: Results) -> None:
    """Raises ValueError if a row refers to a case, a sample or a value that the file does not
    have."""

    def expect(good: Any, part: str) -> None:
        if not np.all(good):
            raise ValueError(f"{part} that the file does not have")

    count, cases, fields = len(results.cases), results.cases, results.fields
    for name in ("answers", "repeats", "preparation", "fields"):
        case = getattr(results, name).case
        expect((case >= 0) & (case < count), f"/{name} has a case")
    expect(
        (cases.trace_begin >= cases.trace_end)
        | ((cases.trace_begin >= 0) & (cases.trace_end <= len(results.trace.seconds))),
        "/cases has a trace",
    )
    expect(
        (fields.begin >= 0)
        & (fields.begin <= fields.end)
        & (fields.end <= len(results.field_values)),
        "/fields has values",
    )


def _expect_json(results: Results) -> None:
    """Raises ValueError unless each JSON text is an object; plug-ins must be a list, and extras an
    object of numbers."""
    cases = results.cases
    kinds: dict[str, tuple[type[Any], Iterable[str]]] = {
        "/cases/options": (dict, cases.options),
        "/cases/extras": (dict, cases.extras),
        "/cases/facts": (dict, cases.facts),
    }
    kinds |= {
        f"/meta@{name}": (dict, [str(results.meta.get(name, ""))])
        for name in ("libraries", "titles")
    }
    kinds["/meta@plugins"] = list, [str(results.meta.get("plugins", ""))]
    for name, (kind, texts) in kinds.items():
        for text in dict.fromkeys(texts):
            try:
                read = json.loads(text or ("[]" if kind is list else "{}"))
                good = isinstance(read, kind) and (
                    name != "/cases/extras"
                    or bool(np.array(list(read.values()), dtype=np.float64).ndim)
                )
            except (RecursionError, TypeError, ValueError):
                good = False
            if not good:
                raise ValueError(f"{name} holds text that is not the JSON of a run")


def results_in(folder: Path) -> list[Path]:
    """Returns the result files of a folder, one for each stem. Skips those that belong to another,
    such as S.everything.h5."""
    return [path for path in sorted(folder.glob("*.h5")) if "." not in path.stem]


def load_all(paths: Iterable[Path]) -> list[Results]:
    """Loads results, which the program checks with one call. Names those that cannot be loaded on
    standard error, and leaves them out."""
    loaded, paths = list[Results](), list(paths)
    gate.vet(paths)
    for path in paths:
        try:
            loaded.append(load(path))
        except ResultError as problem:
            print(printable(str(problem)), file=sys.stderr)
    return loaded


def each(results: Iterable[Results], work: Callable[[Results], Made]) -> list[Made]:
    """Returns what `work` makes of each result. Names a result that it cannot use on standard
    error, and leaves it out."""
    made = list[Made]()
    for result in results:
        try:
            made.append(work(result))
        except Exception as problem:  # no run writes such a file
            print(left_out(result, problem), file=sys.stderr)
    return made


def left_out(results: Results, problem: Exception) -> str:
    return printable(
        f"{results.path}: left out: it has values that no run writes ({type(problem).__name__}: {problem}): run its experiment again"
    )


def load(path: Path, profile: str = "") -> Results:
    """Reads a result file and returns its rows of `profile`, by default the profile of the latest
    run.

    Raises ResultError if the file is missing or damaged, is not a result file, has a newer schema,
    or must not be opened (gate.py).
    """
    stem = path.stem.removesuffix(".everything")  # `run --leave-nothing-out` adds the suffix
    if not path.is_file():
        raise ResultError(
            f"{path}: is not a regular file: {ANOTHER}"
            if path.exists()
            else f"{path}: no such file: measure it with {remedy.measure(stem)}"
        )
    whole = f"take an intact copy, or move it away and measure again with {remedy.measure(stem)}"
    try:
        if not _begins_as_hdf5(path):
            raise ResultError(f"{path}: not an HDF5 file: {ANOTHER}")
        if problem := gate.problem_of(path):
            raise ResultError(f"{path}: damaged: {problem}: {whole}")
        with h5py.File(path, "r") as file:
            meta = {key: _attribute(value) for key, value in file["meta"].attrs.items()}
            if int(meta["schema_version"]) > SCHEMA_VERSION:
                raise ResultError(
                    f"{path}: schema version {meta['schema_version']} is newer than {SCHEMA_VERSION}, "
                    f"the newest that analysis/shared/load.py reads: use the analysis/ of hausbench "
                    f"{meta.get('hausbench_version', 'that wrote it')}"
                )
            results = Results(
                path,
                meta,
                _columns(Models, file, "models"),
                _columns(Cases, file, "cases"),
                _columns(Answers, file, "answers"),
                _columns(Repeats, file, "repeats"),
                _columns(Preparation, file, "preparation"),
                _columns(Trace, file, "trace"),
                _columns(Fields, file, "fields"),
                _values(file),
                _columns(Ledger, file, "ledger"),
            )
        _expect_places(results)
        _expect_json(results)
    except PermissionError as problem:
        raise ResultError(f"{path}: {problem.strerror}") from None
    except OSError:
        raise ResultError(f"{path}: damaged: {whole}") from None
    except (
        LookupError,
        TypeError,
        ValueError,
        ArithmeticError,
        AttributeError,
        RuntimeError,
    ) as error:
        text = str(error.args[0]) if error.args else ""
        raise ResultError(f"{path}: not a hausbench result file ({text}): {ANOTHER}") from None
    if meta.get("stem") != stem:
        raise ResultError(
            f"{path}: has the experiment '{meta.get('stem')}', not '{stem}': rename it to {meta.get('stem')}.h5"
        )
    results = _of_profile(results, profile or str(meta.get("profile", "")))
    results = dataclasses.replace(results, cases=_by_statistic(results.cases))
    if len(results.cases) == 0:
        raise ResultError(
            f"{path}: has no cases of profile '{meta.get('profile')}': measure them with "
            f"{remedy.measure(stem, str(meta.get('experiment_file', '')))}"
        )
    return results


def paper_numbers(name: str) -> dict[str, Any]:
    """Returns the numbers that a paper prints, from results/reference/<name>.toml."""
    with (REFERENCE / f"{name}.toml").open("rb") as file:
        return tomllib.load(file)
