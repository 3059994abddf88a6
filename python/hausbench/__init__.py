"""Certified Hausdorff distances between triangle meshes and point sets.

    >>> import hausbench
    >>> hausbench.directed([[0, 0, 3]], [[0, 0, 0], [1, 0, 0]]).interval.contains(3)
    True

h(A,B) is the largest distance of a point of A to B, and H(A,B) the larger of h(A,B) and h(B,A).
Every answer is an Interval that contains the exact value, rounding errors included.

directed, symmetric    bound h(A,B) and H(A,B)
within                 is h(A,B) at most a length?
distribution, field    mean, RMS, quantiles, shares; the distance of each vertex
prepare                many questions about one target, moving sources
certify, verify        write and check a proof
read, Shape            shapes from files and arrays

hausbench.calls describes the arguments, hausbench.Distribution what `distribution` returns.
hausbench.compat has the calls of other packages, and hausbench.Results reads result files.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from hausbench._core import solvers, version
from hausbench.answers import Answer, Field, Verdict, Witness
from hausbench.calls import certify, directed, distribution, field, symmetric, verify, within
from hausbench.errors import InputError
from hausbench.interval import Interval, Undecided
from hausbench.prepared import Prepared, prepare
from hausbench.shapes import Shape, read

if TYPE_CHECKING:
    from hausbench import compat
    from hausbench.statistics import Distribution
    from hausbench.results import Results

__version__ = version()
__all__ = [
    "Answer",
    "Distribution",
    "Field",
    "InputError",
    "Interval",
    "Prepared",
    "Results",
    "Shape",
    "Undecided",
    "Verdict",
    "Witness",
    "certify",
    "compat",
    "directed",
    "distribution",
    "field",
    "prepare",
    "read",
    "solvers",
    "symmetric",
    "verify",
    "version",
    "within",
]


def __getattr__(name: str) -> object:
    """Loads what few programs use on first use."""
    import importlib

    if name == "compat":
        return importlib.import_module("hausbench.compat")
    if name == "Results":
        return importlib.import_module("hausbench.results").Results
    if name == "Distribution":
        return importlib.import_module("hausbench.statistics").Distribution
    raise AttributeError(f"module 'hausbench' has no attribute {name!r}")
