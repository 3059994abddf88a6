"""The columns of result files, as analysis/shared/load.py reads them. Written by `python3 -m
analysis.schema`: do not edit."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

Texts = npt.NDArray[Any]  # of str
Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Counters = dict[str, npt.NDArray[np.uint64]]


@dataclass(frozen=True)
class Answers:
    case: Ints
    round: Ints
    wall_seconds: Floats
    cpu_seconds: Floats
    reported_seconds: Floats


@dataclass(frozen=True)
class Cases:
    solver: Texts
    options: Texts
    source: Texts
    target: Texts
    pose: Floats
    tolerance_of: Texts
    tolerance: Floats
    case_seconds_limit: Floats
    prepare_seconds_limit: Floats
    memory_limit_bytes: Ints
    floor: Floats
    cutoff: Floats
    budget: Ints
    target_pose: Floats
    quantity: Texts
    warm: Ints
    chain: Texts
    threads: Ints
    program_sha256: Texts
    frame: Ints
    statistic: Texts
    weigh: Texts
    identity: Texts
    label: Texts
    variant: Texts
    profile: Texts
    certified: Ints
    scene: Texts
    scene_note: Texts
    exact: Floats
    family: Texts
    severity: Floats
    source_elements: Ints
    target_elements: Ints
    source_diagonal: Floats
    source_longest: Floats
    pose_index: Ints
    tolerance_absolute: Floats
    status: Texts
    reason: Texts
    solver_status: Texts
    answer: Texts
    cutoff_used: Floats
    lower: Floats
    upper: Floats
    witness_source: Floats
    witness_target: Floats
    witness_direction: Texts
    witness_source_element: Ints
    witness_target_element: Ints
    prepare_seconds: Floats
    prepare_bytes: Ints
    solve_seconds: Floats
    reported_seconds: Floats
    peak_bytes: Ints
    clock: Texts
    from_trace: Ints
    side_by_side: Ints
    extras: Texts
    facts: Texts
    proven_upper: Floats
    fields_sha256: Texts
    build: Texts
    machine: Texts
    trace_begin: Ints
    trace_end: Ints
    lower_check: Texts
    upper_check: Texts
    fields_check: Texts
    reference_lower: Floats
    reference_upper: Floats
    lower_error: Floats
    upper_error: Floats
    middle_error: Floats
    counters: Counters  # every counter_* column, without the prefix

    def __len__(self) -> int:
        return len(self.identity)


@dataclass(frozen=True)
class Fields:
    case: Ints
    name: Texts
    of: Texts
    meaning: Texts
    begin: Ints
    end: Ints


@dataclass(frozen=True)
class Ledger:
    kind: Texts
    subject: Texts
    what: Texts
    reason: Texts
    count: Ints
    seconds_saved: Floats
    profile: Texts


@dataclass(frozen=True)
class Models:
    name: Texts
    sha256: Texts
    kind: Texts
    polynomial: Texts
    box: Floats
    elements: Ints
    vertices: Ints
    diagonal: Floats
    longest_side: Floats
    precision: Texts
    unreferenced: Ints
    source: Texts
    path: Texts
    file_sha256: Texts
    licence: Texts
    note: Texts


@dataclass(frozen=True)
class Preparation:
    case: Ints
    round: Ints
    name: Texts
    seconds: Floats
    bytes: Ints
    shared: Ints


@dataclass(frozen=True)
class Repeats:
    case: Ints
    round: Ints
    wall_seconds: Floats
    cpu_seconds: Floats
    iterations: Ints


@dataclass(frozen=True)
class Trace:
    seconds: Floats
    lower: Floats
    upper: Floats

    def __len__(self) -> int:
        return len(self.seconds)


DEFAULTS: dict[str, Any] = {
    "answers/case": 0,
    "answers/round": 0,
    "answers/wall_seconds": 0.0,
    "answers/cpu_seconds": 0.0,
    "answers/reported_seconds": float("nan"),
    "cases/solver": "",
    "cases/options": "{}",
    "cases/source": "",
    "cases/target": "",
    "cases/pose": [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0],
    "cases/tolerance_of": "",
    "cases/tolerance": 0.0,
    "cases/case_seconds_limit": 60.0,
    "cases/prepare_seconds_limit": 120.0,
    "cases/memory_limit_bytes": 8589934592,
    "cases/floor": 0.0,
    "cases/cutoff": float("inf"),
    "cases/budget": -1,
    "cases/target_pose": [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0],
    "cases/quantity": "directed",
    "cases/warm": 0,
    "cases/chain": "",
    "cases/threads": 1,
    "cases/program_sha256": "",
    "cases/frame": -1,
    "cases/statistic": "",
    "cases/weigh": "area",
    "cases/identity": "",
    "cases/label": "",
    "cases/variant": "",
    "cases/profile": "",
    "cases/certified": -1,
    "cases/scene": "",
    "cases/scene_note": "",
    "cases/exact": float("nan"),
    "cases/family": "",
    "cases/severity": float("nan"),
    "cases/source_elements": 0,
    "cases/target_elements": 0,
    "cases/source_diagonal": 0.0,
    "cases/source_longest": 0.0,
    "cases/pose_index": 0,
    "cases/tolerance_absolute": 5e-324,
    "cases/status": "skipped",
    "cases/reason": "",
    "cases/solver_status": "",
    "cases/answer": "",
    "cases/cutoff_used": float("inf"),
    "cases/lower": float("nan"),
    "cases/upper": float("nan"),
    "cases/witness_source": [float("nan")] * 3,
    "cases/witness_target": [float("nan")] * 3,
    "cases/witness_direction": "source to target",
    "cases/witness_source_element": -1,
    "cases/witness_target_element": -1,
    "cases/prepare_seconds": float("nan"),
    "cases/prepare_bytes": -1,
    "cases/solve_seconds": float("nan"),
    "cases/reported_seconds": float("nan"),
    "cases/peak_bytes": -1,
    "cases/clock": "",
    "cases/from_trace": 0,
    "cases/side_by_side": 0,
    "cases/extras": "{}",
    "cases/facts": "{}",
    "cases/proven_upper": float("nan"),
    "cases/fields_sha256": "",
    "cases/build": "",
    "cases/machine": "",
    "cases/trace_begin": 0,
    "cases/trace_end": 0,
    "cases/lower_check": "not checked",
    "cases/upper_check": "not checked",
    "cases/fields_check": "not checked",
    "cases/reference_lower": float("nan"),
    "cases/reference_upper": float("nan"),
    "cases/lower_error": float("nan"),
    "cases/upper_error": float("nan"),
    "cases/middle_error": float("nan"),
    "fields/case": 0,
    "fields/name": "",
    "fields/of": "vertices",
    "fields/meaning": "number",
    "fields/begin": 0,
    "fields/end": 0,
    "ledger/kind": "",
    "ledger/subject": "",
    "ledger/what": "",
    "ledger/reason": "",
    "ledger/count": 1,
    "ledger/seconds_saved": float("nan"),
    "ledger/profile": "",
    "models/name": "",
    "models/sha256": "",
    "models/kind": "",
    "models/polynomial": "",
    "models/box": [float("nan")] * 6,
    "models/elements": 0,
    "models/vertices": 0,
    "models/diagonal": 0.0,
    "models/longest_side": 0.0,
    "models/precision": "",
    "models/unreferenced": -1,
    "models/source": "",
    "models/path": "",
    "models/file_sha256": "",
    "models/licence": "",
    "models/note": "",
    "preparation/case": 0,
    "preparation/round": 0,
    "preparation/name": "",
    "preparation/seconds": 0.0,
    "preparation/bytes": 0,
    "preparation/shared": 0,
    "repeats/case": 0,
    "repeats/round": 0,
    "repeats/wall_seconds": 0.0,
    "repeats/cpu_seconds": 0.0,
    "repeats/iterations": 1,
    "trace/seconds": 0.0,
    "trace/lower": 0.0,
    "trace/upper": 0.0,
}
