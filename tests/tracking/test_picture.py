"""Tests the history's picture and its table of steps."""

from __future__ import annotations

import csv
import dataclasses
import math
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import pytest

from bench.tracking import picture
from bench.tracking.cases import KERNELS, cases
from bench.tracking.history import Row
from bench.tracking.picture import Found

BEGUN, LATER = "2026-05-05T05:05:05Z", "2026-06-06T06:06:06Z"
ROW = Row("a" * 10, "2026-01-01T00:00:00Z", "one", BEGUN, "guthe on mesh", 0.01, 0.009, 0.011, 8, 0.02, 12345, {"z": 1}, "f00")
CASE = ROW.case


def run_of(times: list[float], measured: str = BEGUN, machine: str = "one", counts: list[int] | None = None, noise: float = 0.001) -> list[Row]:
    """Returns a row for each time, one per commit."""
    return [dataclasses.replace(ROW, commit=f"{i:010x}", date=f"2026-01-{i + 1:02}T00:00:00Z", measured=measured, machine=machine, cpu_seconds=t,
                                cpu_low=t * (1 - noise), cpu_high=t * (1 + noise), instructions=None if counts is None else counts[i])
            for i, t in enumerate(times)]


def drawn(rows: list[Row]) -> Any:
    figure = picture.draw(rows, [CASE])
    plt.close(figure)
    return figure.axes[0]


def lines(ax: Any, colour: str) -> list[tuple[list[float], list[float]]]:
    """Returns the lines of that colour that join at least two points."""
    return [(list(line.get_xdata()), list(line.get_ydata())) for line in ax.get_lines() if line.get_color() == colour and len(line.get_xdata()) > 1]


def made_up() -> list[Row]:
    """Returns rows of twelve commits on one machine, the last six also on another.

    From the seventh commit on, a case takes half the time; from the fourth, a kernel takes more instructions.
    """
    first = cases()[0].name
    rows = []
    for i in range(12):
        date, commit = f"2026-01-{i + 1:02}T00:00:00Z", f"{i:010x}"
        for where in ["one"] + ["two"] * (i >= 6):
            t = (0.02 if i < 6 else 0.01) * (1.0 if where == "one" else 3.0)
            count = int(t * 1e9) if where == "one" else None
            rows.append(Row(commit, date, where, BEGUN, first, t, 0.99 * t, 1.01 * t, 8, t, count, {}, "s"))
        rows.append(Row(commit, date, "one", BEGUN, KERNELS[0].name, 1e-5, 1e-5, 1e-5, 8, math.nan, 100 if i < 3 else 150))
        rows.append(Row(commit, date, "one", BEGUN, "never measured"))
        rows.append(Row(commit, date, "one", BEGUN, "no longer tracked", 1e-3, math.nan, math.nan, 1))
    return rows


def save(rows: list[Row], out: Path) -> list[Path]:
    return picture.save(rows, out, lambda commit: f"subject {int(commit, 16)}", lambda before, after: str(int(after, 16) - int(before, 16)))


def test_pictures_and_the_table_of_steps(tmp_path: Path) -> None:
    paths = save(made_up(), tmp_path)
    assert [path.relative_to(tmp_path).as_posix() for path in paths] == [
        "figures/history.pdf", "figures/history.png", "figures/history_kernels.pdf", "figures/history_kernels.png", "tables/history_steps.csv",
        "tables/history_steps.md", "tables/history_steps.tex"]
    assert all(path.stat().st_size > 0 for path in paths)
    text = (tmp_path / "tables" / "history_steps.md").read_text()
    assert f"| 0000000 subject 2 | 0000000 subject 3 | 1 | {KERNELS[0].name} | — | 1.50× more |" in text
    assert f"| 0000000 subject 5 | 0000000 subject 6 | 1 | {cases()[0].name} | 2.00× faster | 2.00× fewer |" in text
    with (tmp_path / "tables" / "history_steps.csv").open() as file:
        records = list(csv.DictReader(file))
    assert {record["measured"] for record in records} == {BEGUN}
    assert [(record["before_subject"], record["after_subject"]) for record in records] == [("subject 2", "subject 3"), ("subject 5", "subject 6")]
    assert float(records[1]["time_ratio"]) == pytest.approx(0.5) and records[0]["time_ratio"] == ""


def test_runs_and_machines_are_apart() -> None:
    rows = [*run_of([0.01] * 5, LATER), *run_of([0.02] * 3, "2026-06-01T00:00:00Z", "two"), *run_of([0.01] * 4)]
    at = picture.places(rows)
    assert list(at.values()) == [0, 1, 2, 4, 5, 6, 7, 9, 10, 11, 12, 13]
    assert list(dict.fromkeys(session for session, _ in at)) == [("2026-06-01T00:00:00Z", "two"), (BEGUN, "one"), (LATER, "one")]
    ax = drawn(rows)
    spans = sorted((x[0], x[-1]) for x, _ in lines(ax, picture.TIME) + lines(ax, picture.PALE_TIME))
    assert spans == [(0, 2), (4, 7), (9, 13)]  # no line joins two runs or machines
    assert {"A", "B", "C"} < {text.get_text() for text in ax.texts} | {""}


def test_there_is_no_step_between_two_runs(tmp_path: Path) -> None:
    rows = [*run_of([0.01] * 4), *run_of([0.02] * 4, LATER)]
    assert not [step for session in picture.sessions(rows) for step in picture.steps_of(picture.series(rows, CASE, session))]
    save(rows, tmp_path)
    assert "subject" not in (tmp_path / "tables" / "history_steps.md").read_text()


def test_the_newest_run_and_the_longest_are_in_colour() -> None:
    rows = [*run_of([0.01] * 5, "2026-05-02T00:00:00Z"), *run_of([0.01] * 3), *run_of([0.01] * 2, LATER)]
    assert picture.main_sessions(rows) == {("2026-05-02T00:00:00Z", "one"), (LATER, "one")}
    ax = drawn(rows)
    assert ([len(x) for x, _ in lines(ax, picture.TIME)], [len(x) for x, _ in lines(ax, picture.PALE_TIME)]) == ([5, 2], [3])
    alone = run_of([0.01] * 3)
    assert picture.main_sessions(alone) == {(BEGUN, "one")} and not lines(drawn(alone), picture.PALE_TIME)


def test_of_many_runs_the_longest_and_the_newest_have_room() -> None:
    times = [f"2026-05-{day:02}T00:00:00Z" for day in range(1, 21)]
    rows = [row for i, begun in enumerate(times) for row in run_of([0.01] * (3 if i == 1 else 2), begun)]
    shown = picture.sessions(picture.with_room(rows))
    assert [begun for begun, _ in shown] == [times[1], *times[-picture.MOST_RUNS + 1:]]
    assert "8 older runs are not shown" in picture.footnote(picture.with_room(rows), 8)
    assert len(picture.LETTERS) == picture.MOST_RUNS


def test_the_footnote_says_which_run_is_which() -> None:
    one = run_of([0.01] * 2)
    assert "One run, of 2026-05-05 05:05 UTC, on one." in picture.footnote(one)
    text = picture.footnote([*one, *run_of([0.01], LATER), *run_of([0.01], LATER, "two")])
    assert "A (2026-05-05 05:05), B (2026-06-06 06:06) on one; C (2026-06-06 06:06) on two." in text and "are not comparable" in text


def test_a_table_of_several_runs_says_which(tmp_path: Path) -> None:
    rows = [*run_of([0.01, 0.02]), *run_of([0.01, 0.03], LATER, "two")]
    save(rows, tmp_path)
    text = (tmp_path / "tables" / "history_steps.md").read_text()
    assert "| machine | measured |" in text and "| two | 2026-06-06 06:06 | 3.00× slower |" in text
    assert f"| 0000000 subject 0 | 0000000 subject 1 | 1 | {CASE} | one | 2026-05-05 05:05 | 2.00× slower |" in text


def test_steps_are_in_the_order_of_commits_not_of_dates(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(picture, "in_order", lambda commits: sorted(commits, reverse=True))
    save(run_of([0.02, 0.02, 0.01, 0.01]), tmp_path)
    with (tmp_path / "tables" / "history_steps.csv").open() as file:
        assert [(record["before_subject"], record["after_subject"]) for record in csv.DictReader(file)] == [("subject 2", "subject 1")]


def test_times_of_other_shapes_and_empty_rows_are_not_in_a_series() -> None:
    old, new = ([dataclasses.replace(row, shapes=shapes) for row in run_of([0.01] * 4, begun)] for shapes, begun in (("old", BEGUN), ("new", LATER)))
    new[1] = Row(new[1].commit, new[1].date, "one", LATER, CASE)
    rows = [*new, *old]
    assert [int(row.commit, 16) for row in picture.series(rows, CASE, (LATER, "one"))] == [0, 2, 3]
    assert picture.series(rows, CASE, (BEGUN, "one")) == [] and picture.series(rows, CASE, (BEGUN, "another")) == []
    assert len(picture.series(old, CASE, (BEGUN, "one"))) == 4


def test_bars_go_from_the_low_end_to_the_high_end() -> None:
    rows = [dataclasses.replace(row, cpu_low=0.009, cpu_high=0.014) for row in run_of([0.010, 0.011])]
    bars = [path.vertices[:, 1] for one in drawn(rows).collections for path in one.get_paths() if len(path.vertices) == 2]
    assert [sorted(bar) for bar in bars] == [pytest.approx([9, 14])] * 2


def test_instructions_meet_the_time_of_the_newest_commit() -> None:
    ax = drawn(run_of([0.010, 0.012, 0.008], counts=[1000, 1000, 500]))
    [(x, y)] = lines(ax, picture.COUNT)
    assert x == [0, 1, 2] and y == pytest.approx([16, 16, 8])


def test_colours_of_steps() -> None:
    ax = drawn(run_of([0.01] * 3 + [0.02] * 3 + [0.015] * 3 + [0.015] * 3, counts=[100] * 9 + [200] * 3))
    vertical = {line.get_color(): line.get_xdata()[0] for line in ax.get_lines() if len(set(line.get_xdata())) == 1 and len(line.get_xdata()) == 2}
    assert vertical == {picture.SLOWER: 2.5, picture.FASTER: 5.5, picture.ALONE: 8.5}
    assert {text.get_text(): text.get_color() for text in ax.texts} == {"2.00× slower": picture.SLOWER, "1.33× faster": picture.FASTER,
                                                                        "2.00× more": picture.ALONE}


def test_factors_stand_beside_what_is_drawn() -> None:
    rows = run_of([0.02] * 5 + [0.01] * 6 + [0.03] * 5)
    figure = picture.draw(rows, [CASE])
    figure.draw_without_rendering()
    ax = figure.axes[0]
    boxes = [text.get_window_extent() for text in ax.texts]
    points = ax.transData.transform([(x, y) for xs, ys in lines(ax, picture.TIME) for x, y in zip(xs, ys)])
    plt.close(figure)
    assert len(boxes) == 2 and not boxes[0].overlaps(boxes[1])
    assert not any(box.contains(*point) for box in boxes for point in points)
    assert all(ax.get_window_extent().x0 < box.x0 and box.x1 < ax.get_window_extent().x1 for box in boxes)


def found_in(times: list[float], noise: float = 0.0, counts: list[int] | None = None) -> list[Found]:
    return picture.steps_of(run_of(times, counts=counts, noise=noise))


def test_a_noisy_case_needs_a_larger_step() -> None:
    assert [len(found_in([1.0] * 5 + [1.08] * 2, noise)) for noise in (0.001, 0.03, 0.1)] == [1, 1, 0]


def test_small_steps_of_the_time_are_left_out_and_those_of_instructions_less_so() -> None:
    assert [step.what for step in found_in([1.0] * 6 + [1.045] * 6, counts=[1000] * 6 + [1045] * 6)] == ["instructions"]
    assert [step.what for step in found_in([1.0] * 6 + [1.055] * 6, counts=[1000] * 6 + [1012] * 6)] == ["time", "instructions"]
    assert found_in([1.0] * 12, counts=[1000] * 6 + [1008] * 6) == []


def test_values_without_intervals_have_noise_all_the_same() -> None:
    assert found_in([1.0, 1.03, 1.07, 1.03, 1.0, 1.0]) == []  # without noise, these would be two steps of 5 %


def test_words_of_a_step() -> None:
    def words(what: str, ratio: float) -> str:
        return picture.Found("c", what, ROW, ROW, ratio).words
    assert (words("time", 1.05), words("time", 0.5), words("time", 12.3)) == ("1.05× slower", "2.00× faster", "12× slower")
    assert (words("instructions", 1.5), words("instructions", 0.5)) == ("1.50× more", "2.00× fewer")


@pytest.mark.parametrize(("low", "high"), [(0.9, 1.1), (1.3, 4.2), (2.0, 17.0), (0.01, 900.0), (99.0, 160.0)])
def test_an_axis_has_two_to_six_ticks(low: float, high: float) -> None:
    found = picture.ticks(low, high)
    assert 2 <= len(found) <= 6 and all(low <= x <= high for x in found)


@pytest.mark.parametrize("n", [1, 26, 27, 100])
def test_labels_have_room_and_the_newest_has_one(n: int) -> None:
    named = picture.labels({((BEGUN, "m"), f"{i:010x}"): i for i in range(n)}, 26)
    assert len(named) <= 26 and n - 1 in named and (n > 26 or len(named) == n)


def test_nothing_to_draw(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="no times"):
        save([Row("b" * 10, ROW.date, "one", BEGUN, CASE)], tmp_path)
