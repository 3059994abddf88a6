"""For each made-up result file, checks its table's cells and its figures' files."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
import synthetic
from stem_runner import MAGIC, STEMS, Make, stem_runner
from synthetic import ResultFile, spread

from analysis.__main__ import main
from analysis.zhang2017 import zhang2017_fig8, zhang2017_fig9, zhang2017_table3

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture()
def make(tmp_path: Path) -> Make:
    return stem_runner(tmp_path)


def test_table3_cells(make: Make) -> None:
    records, rows, text = make(synthetic.zhang2017_table3())
    header, pears = rows["scene"][0], rows["(a) pears"][0]
    # The times are 1.9 to 2.1 in nine steps of 0.025; the interval is from the second to the
    # eighth.
    assert pears[header.index("NAIVEHDD")] == "2.00 [1.93, 2.08]"
    # Each of the ten seeds has the median 0.5.
    assert pears[header.index("EARLYBREAK")] == "0.500 [0.500, 0.500]"
    assert pears[header.index("NAIVEHDD / EARLYBREAK")] == "4.00 [3.80, 4.20]"
    assert pears[header.index("INC")] == "0.130 [0.126, 0.134]"  # 0.11 s plus 0.02 s of preparation
    assert pears[1] == "1,075 / 1,076"
    distances, work, each, paper = rows[""][:4]
    assert (
        distances[0] == "distances"
        and work[0] == "distances, bounds and nodes"
        and each[0] == "ns per distance"
    )
    # naive counts 1M distances, earlybreak 0.2M distances and 0.05M bounds, the framework 0.1M
    # distances and 0.1M bounds and nodes.
    assert (
        distances[2] == "1,000,000"
        and distances[header.index("NAIVEHDD / EARLYBREAK")] == "5.00 [5.00, 5.00]"
    )
    assert work[header.index("EARLYBREAK / framework")] == "1.25 [1.25, 1.25]"
    assert each[2] == "2000"  # 2 s for 1M distances
    assert paper[:6] == ["paper", "10,754 / 10,754", "47.282", "3.107", "0.226", "0.225"]
    assert paper[header.index("NAIVEHDD / EARLYBREAK") - 1 :] == ["—", "209", "210", "13.8", "1.00"]
    assert (
        "Claim: the framework takes less time than INC on average. Here: not separated (geometric mean"
        in text
        and "over 4 pairs, no ratio for 2)" in text
    )
    claim = next(line for line in text.splitlines() if "less time than NAIVEHDD" in line)
    assert (
        "Counted in distances it is not separated (geometric mean 10.0" in claim
        and "over 5 pairs, no ratio for 1" in claim
        and "bounds and nodes it is not separated" in claim
    )
    claim = next(line for line in text.splitlines() if "less time than INC" in line)
    assert (
        "Counted in distances it is not separated (geometric mean 0.500" in claim
    )  # two of six pairs have no ratio
    assert (
        "In the paper a pair of points costs NAIVEHDD 409 to 538 ns, here 600 to 5000 ns." in text
    )
    assert (
        "NAIVEHDD computes 10 times as many distances as the framework, 5.0 times as many distances, bounds"
        in text
    )
    assert "INC computes 0.50 times as many distances as the framework, 5.2 times as many" in text
    assert (
        "(a) pears: neverball orange_sculpted.obj" in text
        and "Test CPU" in text
        and "profile quick" in text
    )
    record = next(r for r in records if r["scene"] == "a_pears" and r["solver"] == "naive")
    assert (
        float(record["median_seconds"]) == pytest.approx(2.0)
        and float(record["paper_seconds"]) == 47.282
    )
    assert record["point_distances"] == "1000000" and float(
        record["wall_median_seconds"]
    ) == pytest.approx(2.5)


def test_table3_failures_and_absences(make: Make) -> None:
    _, rows, _ = make(synthetic.zhang2017_table3())
    header = rows["scene"][0]
    assert rows["(b) cow, hippo"][0][header.index("EARLYBREAK")] == "timeout (1 of 10)"
    assert rows["(b) cow, hippo"][0][header.index("NAIVEHDD / EARLYBREAK")] == "—"
    assert rows["(c) rabbits"][0][header.index("INC")] == "crashed"
    assert rows["(f) singular"][0][header.index("NOHD/OHD framework")] == "—"


def test_table3_takes_milliseconds_where_times_are_short(make: Make) -> None:
    file = ResultFile("zhang2017_table3", wall=1.25, cpu=1.0)
    file.case("naive", "a_pears", spread(0.05, 9), lower=1.0, upper=1.0)
    file.case("earlybreak", "a_pears", spread(0.05, 9), lower=1.0, upper=1.0)
    _, rows, text = make(file)
    header, cells = rows["scene"][0], rows["(a) pears"][0]
    assert cells[header.index("NAIVEHDD")] == "50.0 [48.1, 51.9]" and "solve (CPU), ms" in text
    assert cells[header.index("NAIVEHDD / EARLYBREAK")].endswith("(not separated)")
    assert rows[""][3][2] == "47282"


def test_table3_pairs_rounds_where_there_are_enough(make: Make) -> None:
    file = ResultFile("zhang2017_table3", wall=1.25, cpu=1.0)
    slow = [
        2.0 * (i + 1) for i in range(8)
    ]  # rounds become slower: only pairing them separates the solvers
    file.case("naive", "a_pears", slow, rounds=8, lower=1.0, upper=1.0)
    file.case("earlybreak", "a_pears", [x / 1.25 for x in slow], rounds=8, lower=1.0, upper=1.0)
    _, rows, _ = make(file)
    assert (
        rows["(a) pears"][0][rows["scene"][0].index("NAIVEHDD / EARLYBREAK")] == "1.25 [1.25, 1.25]"
    )


def test_table3_refuses_to_pool_variants(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = ResultFile("zhang2017_table3", wall=1.25, cpu=1.0)
    for depth in (5, 6):
        file.case("nohd", "a_pears", [1.0], options={"depth": depth}, lower=1.0, upper=1.0)
    file.write(tmp_path)
    arguments = ["--results", str(tmp_path), "--out", str(tmp_path)]
    assert main(["zhang2017_table3", *arguments]) == 2
    assert "'nohd'" in capsys.readouterr().err


def test_points_speed_takes_the_best_of_the_others(make: Make) -> None:
    records, rows, text = make(synthetic.points_speed())
    header, outlier, near = rows["workload"][0], rows["overlapping 100K"][0], rows["noisy 100K"][0]
    assert (
        "Times are process CPU time, children included, but wall time for SciPy cKDTree" not in text
    )
    assert outlier[header.index("scan (ours)")] == "2.00 [1.93, 2.08]"
    assert (
        outlier[-1] == "5.00 [4.82, 5.19]"
    )  # EARLYBREAK's 10 ms, not the tree's 60 ms, over our 2 ms; paired by round
    assert near[header.index("EARLYBREAK")] == "timeout" and near[-1].startswith("4.00")
    # 80 ms by its own clock; the 700 ms of wall time include Python's start.
    assert near[header.index("SciPy cKDTree")] == "80.0"
    assert rows["geometric mean"][0][-1] == "4.47" and "least 4.00, over 2 of 2" in text
    assert rows[""][0][header.index("scan (ours)")] == "8.00"
    record = next(r for r in records if r["label"] == "scan" and r["scene"] == "noisy_100K")
    assert float(record["prepare_seconds"]) == 0.001 and float(
        record["best_other_over_ours"]
    ) == pytest.approx(4.0)


@pytest.mark.parametrize(
    "seconds,outcome",
    [
        ((0.005, 0.005), "it holds (above 1 for 2 of 2 workloads"),
        ((0.020, 0.005), "it does not hold (above 1 for 1 of 2"),
        ((0.010, 0.005), ": not separated (above 1 for 1 of 2"),
    ],
)
def test_points_speed_judges_lss_against_earlybreak(
    make: Make, seconds: tuple[float, float], outcome: str
) -> None:
    """EARLYBREAK takes 10 ms on the first workload and times out on the second."""
    file = synthetic.points_speed()
    for scene, duration in zip(("overlapping_100K", "noisy_100K"), seconds):
        file.case(
            "lss",
            scene,
            [duration] * 9,
            prepare_seconds=0.0,
            lower=0.25,
            upper=0.25,
            scene_note="clouds",
        )
    text = make(file)[2]
    assert (
        f"LSS takes less time than EARLYBREAK on most workloads (from the abstract of Chen et al. 2017). Here{'' if outcome[0] == ':' else ' '}{outcome}"
        in text
    )
    assert "2017). Here: not tested" in make(synthetic.points_speed())[2]


def test_points_speed_counts_a_timeout_of_either_as_slower(make: Make) -> None:
    """Six rounds, which paper profile has, are enough to compare with the limit."""
    file = synthetic.points_speed()
    file.case("lss", "overlapping_100K", [], status="timeout", scene_note="clouds")
    file.case(
        "lss",
        "noisy_100K",
        [0.005] * 6,
        prepare_seconds=0.0,
        lower=0.25,
        upper=0.25,
        scene_note="clouds",
    )
    assert "(above 1 for 1 of 2 workloads, below 1 for 1" in make(file)[2]


def test_points_hostile_finds_where_scan_is_slower(make: Make) -> None:
    records, rows, text = make(synthetic.points_hostile())
    assert rows["line 20K"][0][2].startswith("4.00 [") and rows["line 20K"][0][-1] == "32.0"
    assert rows["sheet 20K"][0][1] == "timeout" and rows["sheet 20K"][0][2] == "—"
    assert (
        "Here it does not hold (above 1 for 1 of 2 workloads, below 1 for 1, no ratio for 1, ratio 0.499 to 4.01)"
        in text
    )
    record = next(r for r in records if r["scene"] == "shell_20K")
    assert (
        float(record["ratio"]) == pytest.approx(0.5)
        and float(record["distances_per_point"]) == 32.0
    )


def test_fig13_means_over_all_pairs_only(make: Make) -> None:
    records, rows, text = make(synthetic.sacht2024_fig13())
    # On pair k, preparing takes 20 k ms and each decade 10 k ms: on average 2.5 (20 + 10 j) at
    # 10^-j.
    assert rows["Sacht 2024"][0] == ["75.0", "100", "125", "150", "175", "200", "225", "250", "242"]
    # Each tolerance is a case of its own, whose seven rounds are up to 5 % off the middle.
    assert rows["CGAL"][0][:2] == ["113 [107, 118]", "158 [150, 165]"] and rows["CGAL"][0][7:] == [
        "428 [406, 449]",
        "—",
    ]
    assert rows["Zheng 2022"][0][5:] == ["532", "3 of 4", "3 of 4", "1288"]
    assert rows["Kang 2018"][0][-1] == "762"
    assert "Zheng 2022: ramesses timeout (1e-7, 1e-8)." in text and "1.05 times as long" in text
    stuck = next(
        r
        for r in records
        if (r["solver"], r["scene"], r["tolerance"]) == ("zheng", "ramesses", "1e-07")
    )
    assert (
        stuck["seconds"] == "" and stuck["read_from"] == "timeout" and stuck["mean_seconds"] == ""
    )


def test_fig13_where_all_or_nothing_was_reached(make: Make) -> None:
    for status in ("ok", "timeout"):
        file = ResultFile("sacht2024_fig13")
        trace = [(0.1, 0.0, 1.0), (0.2, 0.0, 0.0)] if status == "ok" else ()
        file.case(
            "cover",
            "crown",
            [0.2] if trace else (),
            trace,
            tolerance=1e-8,
            status=status,
            prepare_seconds=0.05,
        )
        _, rows, _ = make(file)
        assert rows["cover (ours)"][0][:8] == (["250"] * 8 if trace else [*7 * ["—"], "0 of 1"])


def test_fig13_never_reads_an_unsound_row(make: Make) -> None:
    file = ResultFile("sacht2024_fig13")
    file.case("kang", "crown", [0.2], [(0.1, 0.0, 0.0)], tolerance=1e-8, status="unsound")
    _, rows, text = make(file)
    assert rows["Kang 2018"][0][:8] == ["0 of 1"] * 8 and "crown unsound (1e-1," in text


def test_command_line(tmp_path: Path) -> None:
    """Calls the script as make does."""
    stem = "zhang2017_table3"
    arguments = [
        sys.executable,
        "-m",
        "analysis",
        stem,
        "--results",
        str(tmp_path),
        "--out",
        str(tmp_path / "out"),
    ]
    done = subprocess.run(arguments, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 2 and done.stdout == ""
    assert done.stderr == f"{tmp_path / stem}.h5: no such file: measure it with 'make {stem}'\n"
    STEMS[stem]().write(tmp_path)
    done = subprocess.run(arguments, cwd=ROOT, capture_output=True, text=True)
    assert (
        done.returncode == 0
        and done.stderr == ""
        and str(tmp_path / "out" / "tables" / f"{stem}.csv") in done.stdout.splitlines()
    )


@pytest.mark.parametrize("stem", STEMS)
def test_files_and_words_of_each_stem(
    stem: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Result files stay unchanged. Other tests of these scripts render no figures, because that
    takes most of the time."""
    path = STEMS[stem]().write(tmp_path)
    before = path.read_bytes()
    path.chmod(0o444)
    assert main([stem, "--results", str(tmp_path), "--out", str(tmp_path / "out")]) == 0
    done = capsys.readouterr()
    assert done.err == ""
    lines = done.out.splitlines()
    said = [line for line in lines if line.startswith("Claim: ")]  # printed after the file names
    written = [Path(line) for line in lines if line not in said]
    suffixes = [output.suffix for output in written]
    assert [suffix for suffix in suffixes if suffix not in (".json", ".txt")] == [
        ".csv",
        ".md",
        ".tex",
        ".pdf",
        ".png",
    ]
    assert suffixes.count(".txt") == (suffixes[-1] == ".txt")  # a figure with a caption of its own
    text = written[1].read_text(encoding="utf-8")
    assert (
        suffixes.count(".json") == bool(said) == ("- Claim: " in text)
    )  # verdicts are written as JSON, too
    assert all(f"- {line}" in text for line in said)
    assert all(output.stat().st_size for output in written)
    for output in written:
        if magic := MAGIC.get(output.suffix):
            assert output.read_bytes().startswith(magic) and output.stat().st_size > 5000
    assert path.read_bytes() == before


@pytest.mark.parametrize("stem", STEMS)
def test_a_stem_without_results(
    stem: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([stem, "--results", str(tmp_path)]) == 2
    assert capsys.readouterr() == (
        "",
        f"{tmp_path / stem}.h5: no such file: measure it with 'make {stem}'\n",
    )


def test_several_stems_side_by_side(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """One cannot be read, the script of another fails, a third is killed; the others are drawn, and
    told in the order of the stems."""

    def fails(_: object) -> None:
        raise ZeroDivisionError("on purpose")

    monkeypatch.setattr(zhang2017_fig8, "make", fails)
    monkeypatch.setattr(zhang2017_fig9, "make", lambda _: os.kill(os.getpid(), signal.SIGKILL))
    for file in (
        STEMS[stem]()
        for stem in ("zhang2017_table3", "zhang2017_fig8", "zhang2017_fig9", "points_speed")
    ):
        file.write(tmp_path)
    stems = ["zhang2017_table3", "cliffs", "zhang2017_fig8", "zhang2017_fig9", "points_speed"]
    assert main([*stems, "--results", str(tmp_path), "--out", str(tmp_path)]) == 2
    said = capsys.readouterr()
    assert (
        0 < said.out.index("tables/zhang2017_table3.md") < said.out.index("tables/points_speed.md")
    )
    assert (
        "cliffs.h5" in said.err.splitlines()[0]
        and "zhang2017_fig8: its script failed" in said.err
        and "on purpose" in said.err
    )
    assert "zhang2017_fig9: its script was killed (exit code -9)" in said.err
    assert (
        main(["zhang2017_fig8", "points_speed", "--results", str(tmp_path), "--out", str(tmp_path)])
        == 1
    )
