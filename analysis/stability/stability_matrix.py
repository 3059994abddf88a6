"""The outcome of every solver on families of scenes that get worse step by step: a matrix, and
verdicts on three claims.

stability_error and stability_time draw the same results.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from analysis.shared import claims, numerals, tables
from analysis.shared.notes import machine_line
from analysis.shared.report import NO_TIMES, Report
from analysis.shared.results import Results
from analysis.shared.verdicts import FAILS, HOLDS, UNTESTED, Verdict, never_chosen
from analysis.stability import stability_picture
from analysis.stability.stability_families import (
    KINDS,
    Answer,
    Family,
    Suite,
    look,
    percent,
    severity_text,
)
from analysis.stability.stability_outcomes import ILL, MEETABLE, SLACK, U, Outcome

SHARE: Final = (
    0.95  # claimed share of tight answers, among those for which a tight answer is possible
)
# Solvers that ignore the tolerance: the spacing of their samples or grid sets the width of their
# bounds.
WITHOUT_TOLERANCE: Final = ("sampling", "surface_meshes")
NAMED: Final = 12  # the evidence against a claim names at most this many places


def make(results: Results) -> Report:
    suite = Suite(results)
    parts = {}
    for kind in KINDS:
        parts[kind] = [
            answer.row
            for family in suite.of_kind(kind)
            for by_step in family.answers.values()
            for answer in by_step.values()
        ]
    return Report(
        lambda: stability_picture.draw(suite),
        table_of(suite),
        [record(suite, answer) for answer in suite.answers],
        clock=NO_TIMES,
        parts=parts,
    )


# --- claims
# -------------------------------------------------------------------------------------------------------------------------


def place(suite: Suite, answer: Answer) -> str:
    """Names an answer by solver, family and severity: 'guthe on offset at 1e4'."""
    family, severity = suite.family_of[answer.row], severity_text(answer.severity)
    return f"{answer.label} on {family.title}{f' at {severity}' if severity else ''}"


def named(places: Sequence[str]) -> str:
    """Joins the distinct places, at most NAMED, and counts the others."""
    distinct = list(dict.fromkeys(places))
    rest = len(distinct) - NAMED
    return "; ".join(distinct[:NAMED]) + (f"; and {rest} more" if rest > 0 else "")


def was_run(answer: Answer) -> bool:
    return answer.outcome not in (Outcome.NOT_RUN, Outcome.NOT_APPLICABLE)


def claim_certified(suite: Suite) -> Verdict:
    answers = [
        answer
        for answer in suite.answers
        if answer.certified and was_run(answer) and answer.outcome != Outcome.RIGHTLY_REFUSED
    ]
    ill = [answer for answer in answers if answer.outcome in ILL]
    verdict = never_chosen(claims.of("hausbench", "stability"), len(ill), len(answers), "answers")
    if not ill:
        return verdict
    places = named([f"{place(suite, answer)}: {answer.outcome.words}" for answer in ill])
    return Verdict(verdict.claim, verdict.outcome, f"{verdict.evidence}: {places}")


def claim_tight(suite: Suite) -> Verdict:
    """Judges the claim on the share of tight answers, by counting, without statistics."""
    claim = claims.of(
        "hausbench", "tight", percent=100 * SHARE, aside=" and ".join(WITHOUT_TOLERANCE)
    )
    among = [
        answer
        for answer in suite.answers
        if answer.certified
        and answer.legal
        and answer.can_be_met
        and was_run(answer)
        and suite.results.cases.solver[answer.row] not in WITHOUT_TOLERANCE
    ]
    if not among:
        return Verdict(claim, UNTESTED, "no answers")
    tight = [answer for answer in among if answer.outcome == Outcome.TIGHT]

    def below(name_of: dict[int, str]) -> str:
        """Lists the families (or solvers) whose own share is below SHARE, the worst first."""
        shares = []
        for name in dict.fromkeys(name_of[answer.row] for answer in among):
            members = [answer for answer in among if name_of[answer.row] == name]
            good = sum(answer.outcome == Outcome.TIGHT for answer in members)
            if good < SHARE * len(members):
                shares.append((good / len(members), f"{name} {good} of {len(members)}"))
        return ", ".join(text for _, text in sorted(shares)) or "none"

    families = {answer.row: suite.family_of[answer.row].title for answer in among}
    labels = {answer.row: answer.label for answer in among}
    return Verdict(
        claim,
        HOLDS if len(tight) >= SHARE * len(among) else FAILS,
        f"{len(tight):,} of {len(among):,}, {percent(len(tight), len(among))}; families below: {below(families)}; "
        f"solvers below: {below(labels)}",
    )


def expected_wrong(suite: Suite) -> list[str]:
    """Returns the labels of solvers known to be wrong: textbook arithmetic, algorithms as printed,
    and CGAL, which does not bound its rounding errors.
    """
    return [
        label
        for solver, label in suite.labels
        if solver == "cgal" or solver.endswith("_as_printed") or "textbook kernel" in label
    ]


def claims_can_fail(suite: Suite) -> list[Verdict]:
    """Judges the claim that the suite detects each solver in expected_wrong(): at least one of its
    answers is wrong."""
    verdicts = []
    for label in expected_wrong(suite):
        answers = [answer for answer in suite.answers if answer.label == label and was_run(answer)]
        wrong = [answer for answer in answers if answer.outcome == Outcome.WRONG]
        where = named([place(suite, answer).removeprefix(f"{label} on ") for answer in wrong])
        evidence = (
            f"{len(wrong)} of {len(answers)} answers{': ' if wrong else ''}{where}"
            if answers
            else "no answers"
        )
        verdicts.append(
            Verdict(
                claims.of("hausbench", "suite_can_fail", label=label),
                HOLDS if wrong else FAILS if answers else UNTESTED,
                evidence,
            )
        )
    return verdicts


# --- table and numbers
# --------------------------------------------------------------------------------------------------------------


def cell(family: Family, label: str) -> str:
    """Returns the worst outcome of a solver on a family, and the number of severities that have it
    (at any tolerance)."""
    worst = {}
    for step in family.steps:
        outcomes = [family.outcome(label, step, tolerance) for tolerance in family.tolerances]
        worst[step] = max(outcomes, key=lambda outcome: outcome.badness)
    if set(worst.values()) == {Outcome.NOT_APPLICABLE}:
        return Outcome.NOT_APPLICABLE.short
    run = [
        outcome
        for outcome in worst.values()
        if outcome not in (Outcome.NOT_APPLICABLE, Outcome.NOT_RUN)
    ]
    if not run:
        return Outcome.NOT_RUN.short
    least = max(run, key=lambda outcome: outcome.badness)
    missing = len(worst) - len(run)
    return f"{least.short} {run.count(least)} of {len(worst)}" + (
        f", {missing} not run" if missing else ""
    )


def table_of(suite: Suite) -> tables.Table:
    results, labels = suite.results, suite.labels
    table = tables.Table(
        "The worst outcome of each solver on each family of scenes, and at how many of its severities.",
        ["family", "severity", "scenes", *[look(*pair).title for pair in labels]],
        left=3 + len(labels),
        parts=_kinds_begin(suite),
    )
    for kind in KINDS:
        table.rules.add(len(table.rows))
        for family in suite.of_kind(kind):
            ends = (
                [severity_text(x) for x in (family.severities[0], family.severities[-1])]
                if family.has_severities
                else [numerals.NOTHING]
            )
            table.rows.append(
                [
                    family.title,
                    " to ".join(dict.fromkeys(ends)),
                    str(len(family.steps)),
                    *[cell(family, label) for _, label in labels],
                ]
            )
    table.verdicts = [claim_certified(suite), claim_tight(suite), *claims_can_fail(suite)]
    unknown = sum(answer.can_be_met is None and was_run(answer) for answer in suite.answers)
    table.notes = [
        "Tight: an answer within its tolerance whose bounds hold. Loose: the bounds hold and the solver ended by itself, but the gap is above the "
        "tolerance, or the upper bound is infinite. Stopped: at its budget, its time limit or the precision of doubles, with bounds that hold. Refused: an "
        "error and no bounds; 'refused it' if that is right, because the input is not legal. Wrong: bounds that leave out the true distance, cross or are "
        "not numbers; 'converged' from a certified solver whose gap is above the tolerance; an answer to input that is not legal; or two runs that differ. "
        "Hung: killed at the limit, without bounds. n/a: the solver does not take such shapes.",
        "Bounds are compared with the distance in closed form, to one ulp, or else with what all certified solvers prove together. Solvers that are not "
        f"certified may be off by {SLACK / U:.0f} u M. A gap can be met if the tolerance is at least {MEETABLE / U:.0f} u M (u = 2^-53, M the largest "
        "coordinate).",
        f"Each had {seconds_text(results)}; tolerances: {', '.join(f'{x:g}' for x in sorted(set(map(float, results.cases.tolerance)), reverse=True))}.",
    ]
    if unknown:
        table.notes.append(
            f"The shapes of {unknown:,} answers are not in the cache: whether their gap can be met is unknown, and only the harness judges the "
            "bounds of solvers that are not certified."
        )
    table.notes += [
        f"{family.title}: {note}." for family in suite.families if (note := note_of(suite, family))
    ]
    table.notes.append(f"{machine_line(results)}.")
    return table


def _kinds_begin(suite: Suite) -> list[int]:
    """Returns the first column of each group of solvers: for points only, meshes, and surfaces."""
    takes = []
    for pair in suite.labels:
        takes.append(next((kind for kind in reversed(KINDS) if pair in suite.labels_of(kind)), ""))
    return [3 + i for i, kind in enumerate(takes) if i == 0 or kind != takes[i - 1]]


def seconds_text(results: Results) -> str:
    return ", ".join(
        f"{numerals.number(x)} s" for x in sorted(set(map(float, results.cases.case_seconds_limit)))
    )


def note_of(suite: Suite, family: Family) -> str:
    """Returns the note on a family from the experiment file. If its scenes have different notes,
    returns all of them."""
    cases, notes = suite.results.cases, dict[str, str]()
    for by_step in family.answers.values():
        for answer in by_step.values():
            notes.setdefault(
                str(cases.scene_note[answer.row]).removeprefix("not legal: "),
                str(cases.scene[answer.row]),
            )
    if len(notes) == 1 or family.has_severities:
        return next(iter(notes), "")
    return "; ".join(f"{scene}: {note}" for note, scene in notes.items() if note)


def record(suite: Suite, answer: Answer) -> tables.Record:
    cases, family, row = suite.results.cases, suite.family_of[answer.row], answer.row
    met = {True: "yes", False: "no", None: "unknown"}[answer.can_be_met]
    return {
        "family": family.name,
        "kind": family.kind,
        "scene": cases.scene[row],
        "severity": answer.severity,
        "tolerance": answer.tolerance,
        "solver": cases.solver[row],
        "label": answer.label,
        "certified": int(cases.certified[row]),
        "verdict": answer.outcome.words,
        "can_be_met": met,
        "lower": float(cases.lower[row]),
        "upper": float(cases.upper[row]),
        "exact": float(cases.exact[row]),
        "status": cases.status[row],
        "reason": cases.reason[row],
        "seconds": float(cases.solve_seconds[row]),
    }
