"""Reads result files of `hausbench run` (HDF5). Needs h5py, and pandas for to_pandas()."""

from __future__ import annotations

import os
import shutil
import subprocess
from typing import TYPE_CHECKING, Any

import numpy as np

from hausbench.errors import InputError

if TYPE_CHECKING:
    import numpy.typing as npt
    import pandas


class Results:
    """A result file, such as Results("results/zhang2017_table3.h5"). results/README.md describes
    its tables and columns.

    The program hausbench checks the file first, because an HDF5 file can make its reader open other
    files. The program is looked for in HAUSBENCH_PROGRAM, then on PATH. Nobody may change the file
    while the object is in use.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self._path = os.fspath(path)
        if not os.path.isfile(self._path):
            raise InputError(
                f"{self._path}: no such file: give the path of a file that 'hausbench run' wrote"
            )
        _vet(self._path)
        self.tables()

    def _open(self) -> Any:
        try:
            import h5py
        except ImportError:
            raise ImportError("Results needs h5py: sudo apt-get install python3-h5py") from None
        try:
            return h5py.File(self._path, "r")
        except OSError as error:
            raise InputError(
                f"{self._path}: not a result file ({error}): name a file written by 'hausbench run'"
            ) from None

    def tables(self) -> list[str]:
        """Returns the names of the tables: "cases", with one row per requested case, and others."""
        with self._open() as file:
            names = [name for name, group in file.items() if hasattr(group, "items")]
        if "cases" not in names:
            raise InputError(
                f"{self._path}: has no table 'cases': name a file written by 'hausbench run'"
            )
        return names

    def columns(self, table: str = "cases") -> dict[str, npt.NDArray[Any]]:
        """Returns the columns of a table by name, in the order of the file; texts are objects."""
        with self._open() as file:
            if table not in file or not hasattr(file[table], "items"):
                raise InputError(
                    f"{self._path}: has no table {table!r}, but {', '.join(self.tables())}"
                )
            return {
                name: _values(data) for name, data in file[table].items() if hasattr(data, "dtype")
            }

    def to_pandas(self, table: str = "cases") -> pandas.DataFrame:
        """Returns a table as a DataFrame. A column with several numbers a row, such as a point,
        becomes name_0, name_1, ...

        Each bound is a column of its own, `lower` or `upper`.
        """
        try:
            import pandas
        except ImportError:
            raise ImportError(
                "to_pandas() needs pandas: sudo apt-get install python3-pandas; columns() does not"
            ) from None
        columns = self.columns(table)
        lengths = [
            len(values) for name, values in columns.items() if table != "fields" or name != "values"
        ]
        rows = max(lengths, default=0)
        flat: dict[str, npt.NDArray[Any]] = {}
        for name, values in columns.items():
            if len(values) != rows:
                continue  # values of all fields, one after the other
            if values.ndim == 1:
                flat[name] = values
                continue
            wide = values.reshape(rows, -1)
            flat.update((f"{name}_{k}", wide[:, k]) for k in range(wide.shape[1]))
        return pandas.DataFrame(flat)


def _vet(path: str) -> None:
    """Raises InputError unless the program says that the file may be opened."""
    program = os.environ.get("HAUSBENCH_PROGRAM") or shutil.which("hausbench")
    if program is None:
        raise InputError(
            f"{path}: is read only after the program hausbench has checked it: put it on PATH, or name it with HAUSBENCH_PROGRAM"
        )
    try:
        done = subprocess.run(
            [program, "vet", "--", os.path.abspath(path)],
            capture_output=True,
            text=True,
            errors="replace",
        )
    except OSError as error:
        raise InputError(
            f"{program}: cannot be run: {error.strerror}: name the program hausbench with HAUSBENCH_PROGRAM"
        ) from None
    if done.returncode != 0:
        raise InputError(
            f"{program}: cannot check {path} ({done.stderr.strip()}): use the hausbench that this package is from"
        )
    if problem := done.stdout.strip():
        raise InputError(
            f"{path}: not a result file ({problem}): name a file written by 'hausbench run'"
        )


def _values(data: Any) -> npt.NDArray[Any]:
    import h5py

    return (
        np.asarray(data.asstr()[()], dtype=object)
        if h5py.check_string_dtype(data.dtype)
        else np.asarray(data[()])
    )
