"""docs/notebook.ipynb runs from top to bottom. It is kept without outputs."""

from __future__ import annotations

import os
from pathlib import Path

import hausbench
import pytest

NOTEBOOK = Path(__file__).resolve().parents[2] / "docs" / "notebook.ipynb"


def test_the_notebook_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    nbformat, nbclient = pytest.importorskip("nbformat"), pytest.importorskip("nbclient")
    pytest.importorskip("ipykernel"), pytest.importorskip("matplotlib")
    package = str(
        Path(hausbench.__file__).resolve().parents[1]
    )  # the kernel is another interpreter, of the system
    monkeypatch.setenv(
        "PYTHONPATH",
        os.pathsep.join([package, os.environ.get("PYTHONPATH", "")]).rstrip(os.pathsep),
    )
    monkeypatch.delenv(
        "MPLBACKEND", raising=False
    )  # the kernel chooses its own, which gives pictures
    for variable in ("IPYTHONDIR", "JUPYTER_RUNTIME_DIR", "MPLCONFIGDIR"):
        monkeypatch.setenv(variable, str(tmp_path / variable))
    notebook = nbformat.read(NOTEBOOK, as_version=4)
    nbclient.NotebookClient(
        notebook,
        timeout=300,
        kernel_name="python3",
        resources={"metadata": {"path": str(tmp_path)}},
    ).execute()
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    assert not [output for output in outputs if output.output_type == "error"]
    assert sum("image/png" in output.get("data", {}) for output in outputs) == 3
    if folder := os.environ.get("HAUSBENCH_NOTEBOOK_OUT"):  # to look at it
        nbformat.write(notebook, Path(folder) / "notebook.ipynb")


def test_the_notebook_has_no_outputs() -> None:
    nbformat = pytest.importorskip("nbformat")
    assert [
        cell
        for cell in nbformat.read(NOTEBOOK, as_version=4).cells
        if cell.get("outputs") or cell.get("execution_count")
    ] == []
