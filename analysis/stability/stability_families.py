"""Groups the rows of the stability suite by family (a scene at several severities) and solver."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final

from analysis.shared import numerals, style
from analysis.shared.results import Results
from analysis.stability.stability_outcomes import STOPS, Judge, Outcome, judge
from analysis.zhang2017.zhang2017_as_printed import LOOKS as BESIDE_PRINTED

KINDS: Final = ("points", "meshes", "surfaces")
_KIND_OF: Final = {
    "points": "points",
    "mesh": "meshes",
    "surface": "surfaces",
}  # by the kind of a model
AS_PRINTED: Final = {
    solver: looks for solver, looks in BESIDE_PRINTED.items() if solver.endswith("_as_printed")
}
Label = tuple[str, str]  # a solver, and its name in the rows


@dataclass(frozen=True)
class Answer:
    """A row and its outcome."""

    row: int
    label: str
    severity: float  # NaN: not part of a sweep
    tolerance: float
    certified: bool
    outcome: Outcome
    can_be_met: bool | None  # the tolerance is within the precision of doubles; None: unknown
    legal: bool  # the input is valid, so a solver should answer
    status: str

    @property
    def letter(self) -> str:
        """The letter in figures; for STOPPED it says what stopped the solver."""
        return STOPS[self.status][0] if self.outcome == Outcome.STOPPED else self.outcome.letter


Step = tuple[str, int]  # a scene and a pose: one severity


@dataclass(frozen=True)
class Family:
    name: str
    kind: str  # one of KINDS
    steps: list[Step]  # in the order of the experiment, the mildest first
    severities: list[float]  # of each step
    answers: dict[str, dict[tuple[Step, float], Answer]]  # by label, then by step and tolerance

    @cached_property
    def tolerances(self) -> list[float]:
        """All tolerances, the coarsest first."""
        return sorted(
            {tolerance for by_step in self.answers.values() for _, tolerance in by_step},
            reverse=True,
        )

    @property
    def title(self) -> str:
        return self.name.replace("_", " ")

    @property
    def has_severities(self) -> bool:
        return any(math.isfinite(x) for x in self.severities)

    def of(self, label: str) -> list[Answer]:
        return list(self.answers.get(label, {}).values())

    def asked(self, label: str) -> list[Answer]:
        """Returns the answers of a solver, without those that are not applicable or were not
        run."""
        return [
            answer
            for answer in self.of(label)
            if answer.outcome not in (Outcome.NOT_APPLICABLE, Outcome.NOT_RUN)
        ]

    def outcome(self, label: str, step: Step, tolerance: float) -> Outcome:
        """Returns the outcome; NOT_RUN if the experiment has no such row."""
        answer = self.answers.get(label, {}).get((step, tolerance))
        return answer.outcome if answer else Outcome.NOT_RUN

    def mark(self, label: str, step: Step, tolerance: float) -> tuple[Outcome, str]:
        """Returns the outcome and its letter in figures; NOT_RUN if the experiment has no such
        row."""
        answer = self.answers.get(label, {}).get((step, tolerance))
        return (answer.outcome, answer.letter) if answer else (Outcome.NOT_RUN, "")

    def finest(self, label: str) -> list[Answer]:
        """Returns the answer of each step at the finest tolerance, the mildest severity first."""
        by_step = self.answers.get(label, {})
        least: dict[Step, Answer] = {}
        for (step, tolerance), answer in by_step.items():
            if step not in least or tolerance < least[step].tolerance:
                least[step] = answer
        return [least[step] for step in self.steps if step in least]


class Suite:
    def __init__(self, results: Results) -> None:
        self.results, self.judge = results, Judge(results)
        rows: dict[tuple[str, str], list[int]] = {}
        for row, kind in enumerate(self._kinds()):
            rows.setdefault((str(results.cases.family[row]) or self._scene(row), kind), []).append(
                row
            )
        self._takes = {
            (str(results.names[row]), kind)
            for row, kind in enumerate(self._kinds())
            if self.judge.ending(row).legal
            and judge(self.judge.ending(row)) != Outcome.NOT_APPLICABLE
        }
        self.families = [
            self._family(name, kind, family_rows) for (name, kind), family_rows in rows.items()
        ]

    def _kinds(self) -> list[str]:
        """Returns the kind of shapes of each row.

        If a model could not be read, for example invalid input, this is the kind of its family, or
        else of the row before.
        """
        cases, models = self.results.cases, dict(
            zip(self.results.models.name, self.results.models.kind)
        )
        kinds = [_KIND_OF.get(models.get(source, ""), "") for source in cases.source]
        of_family = {
            str(family): kind for family, kind in zip(cases.family, kinds) if family and kind
        }
        filled: list[str] = []
        for row, kind in enumerate(kinds):
            filled.append(
                kind
                or of_family.get(str(cases.family[row]))
                or (filled[-1] if filled else KINDS[0])
            )
        return filled

    def _scene(self, row: int) -> str:
        """Returns the name of the scene without the statistic that load() adds: all statistics of a
        scene are one step."""
        cases = self.results.cases
        return (
            str(cases.scene[row]).removesuffix(f", {cases.statistic[row]}")
            if cases.statistic[row]
            else str(cases.scene[row])
        )

    def _family(self, name: str, kind: str, rows: Sequence[int]) -> Family:
        cases = self.results.cases
        steps = list(dict.fromkeys((self._scene(row), int(cases.pose_index[row])) for row in rows))
        first = {(self._scene(row), int(cases.pose_index[row])): row for row in reversed(rows)}
        answers: dict[str, dict[tuple[Step, float], Answer]] = {}
        for row in rows:
            step = (self._scene(row), int(cases.pose_index[row]))
            answers.setdefault(str(self.results.names[row]), {})[
                step, float(cases.tolerance[row])
            ] = self._answer(row, kind)
        return Family(
            name, kind, steps, [float(cases.severity[first[step]]) for step in steps], answers
        )

    def _answer(self, row: int, kind: str) -> Answer:
        cases, ending = self.results.cases, self.judge.ending(row)
        # Invalid input is refused for all solvers, so those that do not accept such shapes are
        # sorted out here.
        applicable = ending.legal or (str(self.results.names[row]), kind) in self._takes
        return Answer(
            row,
            str(self.results.names[row]),
            float(cases.severity[row]),
            float(cases.tolerance[row]),
            ending.certified,
            judge(ending) if applicable else Outcome.NOT_APPLICABLE,
            self.judge.can_be_met(row),
            ending.legal,
            ending.status,
        )

    @cached_property
    def labels(self) -> list[Label]:
        """All labels, in the order of tables."""
        return ordered(zip(self.results.cases.solver, self.results.names))

    @cached_property
    def answers(self) -> list[Answer]:
        return sorted(
            (
                answer
                for family in self.families
                for by_step in family.answers.values()
                for answer in by_step.values()
            ),
            key=lambda answer: answer.row,
        )

    @cached_property
    def family_of(self) -> dict[int, Family]:
        """The family of each row."""
        return {
            answer.row: family
            for family in self.families
            for by_step in family.answers.values()
            for answer in by_step.values()
        }

    def of_kind(self, kind: str) -> list[Family]:
        return [family for family in self.families if family.kind == kind]

    def labels_of(self, kind: str) -> list[Label]:
        """Returns the solvers that accept shapes of this kind: some row is not NOT_APPLICABLE."""
        accepting = {
            answer.label
            for family in self.of_kind(kind)
            for by_step in family.answers.values()
            for answer in by_step.values()
            if answer.outcome != Outcome.NOT_APPLICABLE
        }
        return [pair for pair in self.labels if pair[1] in accepting]

    def is_certified(self, label: str) -> bool:
        """Tells whether a solver is certified; false if it was never run."""
        return any(answer.certified for family in self.families for answer in family.of(label))


def ordered(pairs: Iterable[Label]) -> list[Label]:
    """Sorts like style.order(), but puts each algorithm as printed (with its errors) after the
    corrected one."""
    in_order = style.order(pairs)
    placed: list[Label] = [pair for pair in in_order if pair[0] not in AS_PRINTED]
    for pair in (pair for pair in in_order if pair[0] in AS_PRINTED):
        after = [
            i
            for i, (solver, _) in enumerate(placed)
            if solver == pair[0].removesuffix("_as_printed")
        ]
        placed.insert(after[-1] + 1 if after else len(placed), pair)
    return placed


def look(solver: str, label: str) -> style.Look:
    return (
        AS_PRINTED[solver]
        if solver == label and solver in AS_PRINTED
        else style.look(solver, label)
    )


def severity_text(severity: float) -> str:
    """Formats a severity: '1e6', '12', '0.25'; empty for NaN."""
    if math.isnan(severity):
        return ""
    if severity == 0 or 1e-3 <= abs(severity) < 1e4:
        return f"{severity:g}"
    mantissa, exponent = f"{severity:.2e}".split("e")
    return f"{float(mantissa):g}e{int(exponent)}"


def range_text(family: Family) -> str:
    """Returns the range of severities of a family: '10 to 1e12'."""
    if not family.has_severities:
        return f"{len(family.steps)} scenes" if len(family.steps) > 1 else ""
    ends = list(
        dict.fromkeys((severity_text(family.severities[0]), severity_text(family.severities[-1])))
    )
    return " to ".join(ends)


def percent(part: int, whole: int) -> str:
    """Formats part / whole: '97.2 %'. At most 99.9 % if part < whole."""
    share = 100 * part / whole
    return f"{numerals.number(min(share, 99.9) if part < whole else share)} %"
