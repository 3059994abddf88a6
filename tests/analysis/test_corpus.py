"""The table over all meshes of the corpus counts answers, and explains every row without one."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from stem_runner import Make, stem_runner
from synthetic import ResultFile

from analysis import paper_profile
from analysis.corpus.every_mesh import named, shown_reason

UNREADABLE = "model '{0}': /cache/raw/0/{0}.gts: cannot be read: No suitable reader found for the file format of file \"{0}.gts\"; convert it"


@pytest.fixture
def make(tmp_path: Path) -> Make:
    return stem_runner(tmp_path)


def corpus(meshes: int = 8, **columns: Any) -> ResultFile:
    """Each mesh has an answer of cover and of cgal, but the last two cannot be read, and cgal times
    out on the one before."""
    file = ResultFile("corpus_decimation", meta={"title": "Every mesh", "profile": "corpus"})
    for i in range(meshes):
        scene, last = f"mesh{i}", i == meshes - 3
        common: dict[str, Any] = {"tolerance": 1e-3, "case_seconds_limit": 10.0}
        if i >= meshes - 2:
            for solver in ("cover", "cgal"):
                file.case(
                    solver,
                    scene,
                    status="failed",
                    reason=UNREADABLE.format(scene),
                    source_elements=0,
                    target_elements=0,
                    **common,
                )
            continue
        file.case(
            "cover",
            scene,
            [0.001 * (i + 1)],
            lower=1.0,
            upper=1.0,
            prepare_seconds=0.0,
            **common | (columns if last else {}),
        )
        if last:
            file.case(
                "cgal",
                scene,
                status="timeout",
                reason="killed: no answer within 10 s",
                certified=0,
                **common,
            )
        else:
            file.case(
                "cgal",
                scene,
                [0.1],
                lower=1.0,
                upper=1.0,
                prepare_seconds=0.0,
                certified=0,
                **common,
            )
    return file


def test_counts_times_and_reasons(make: Make) -> None:
    records, rows, text = make(corpus())
    assert rows["cover (ours)"][0][:2] == ["6 of 6", "0"] and rows["CGAL"][0][:2] == ["5 of 6", "1"]
    assert (
        rows["cover (ours)"][0][-1] == "5.40"
    )  # the last mesh takes 6 ms of wall time, 5.4 ms of CPU time
    assert "on 6 of 8 meshes, within 10.0 s" in text
    assert (
        "Not measured, failed: model … cannot be read: No suitable reader found for the file format of file … (2: mesh6, mesh7)."
        in text
    )
    assert "CGAL, timeout: killed: no answer within … s (1: mesh5)." in text
    assert named([f"mesh{i}" for i in range(21)]) == "21"
    assert len(records) == 16 and sum(record["status"] == "failed" for record in records) == 4


@pytest.mark.parametrize(
    ("columns", "meshes", "said"),
    [
        ({}, 60, "not refuted (0 of 58 cases"),
        ({"status": "unsound", "reason": "wrong"}, 60, "does not hold"),
        ({}, 8, "not separated"),
    ],
)
def test_a_certified_solver_that_fails_is_seen(
    make: Make, columns: dict[str, Any], meshes: int, said: str
) -> None:
    _, _, text = make(corpus(meshes, **columns))
    verdict = next(line for line in text.splitlines() if "Claim: no certified solver" in line)
    assert said in verdict


def test_answers_after_the_limit_are_counted(make: Make) -> None:
    file = corpus()
    assert "after the limit" not in make(file)[2]
    file.case(
        "cgal",
        "mesh8",
        [10.1],
        lower=1.0,
        upper=1.0,
        prepare_seconds=0.0,
        certified=0,
        tolerance=1e-3,
        case_seconds_limit=10.0,
    )
    assert "CGAL: 1 of its answers came after the limit" in make(file)[2]


def test_like_reasons_stand_together() -> None:
    assert shown_reason(UNREADABLE.format("a")) == shown_reason(UNREADABLE.format("b2"))
    assert shown_reason("killed: no answer within 10 s") != shown_reason("killed by signal 11")


def test_the_whole_corpus_is_kept(tmp_path: Path) -> None:
    corpus().write(tmp_path)
    arguments = ["corpus", "--results", str(tmp_path), "--out", str(tmp_path)]
    assert paper_profile.main(arguments) == 0
    text = (tmp_path / "corpus.md").read_text(encoding="utf-8")
    assert (
        "make corpus PROFILE=corpus" in text
        and "## corpus_decimation" in text
        and "on 6 of 8 meshes" in text
    )
    part = corpus()
    part.meta["profile"] = "quick"
    part.write(tmp_path)
    assert paper_profile.main(arguments) == 2
