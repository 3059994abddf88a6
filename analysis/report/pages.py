"""Writes the report, pages of HTML about all results: `python3 -m analysis.report.pages [--results
DIR] [--out DIR] [--strict]`.

    <out>/report/index.html        the run, which solver to take, and what came out of each paper
    <out>/report/PAPER.html        tables, figures and claims of a paper
    <out>/report/experiments.html  the same of our own experiments
    <out>/report/rows.html         every row, with filters
    <out>/report/scenes.html       pairs of meshes and motions in 3-D
    <out>/report/stability.html    the outcome of each solver on each family of the stability suite
    <out>/report/work.html         work left out, and the history of timings

The folder needs no network and can be moved as a whole. It has whatever results, tables and figures
exist (`make figures` draws them). A claim whose text on why it does not hold no longer fits its
verdict is named, on the page and in the terminal; with --strict the exit code is then 1.
"""

from __future__ import annotations

import argparse
import csv
import json
import shutil
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import jinja2
import markdown_it
import markupsafe

from analysis import document, ledger, paper_page
from analysis.report import all_rows, chooser, matrix, outcomes, scenes
from analysis.report.copies import UNREADABLE, copied
from analysis.shared import claims, gate, stems, table_files
from analysis.shared.load import REFERENCE, left_out, load_all, results_in
from analysis.shared.notes import measured_on
from analysis.shared.printable import printable
from analysis.shared.results import ResultError, Results
from analysis.stability.stability_outcomes import STOPS, Outcome

HERE: Final = Path(__file__).resolve().parent
ROOT: Final = HERE.parents[1]
LIBRARIES: Final = ROOT / "build" / "web"  # tools/bundle writes it
PAGES: Final = {
    "index": "Overview",
    "experiments": "Experiments",
    "rows": "Rows",
    "scenes": "Scenes",
    "stability": "Stability",
    "work": "Work",
}


def file_of(stem: str) -> Path | None:
    for file in (ROOT / "experiments").rglob(f"{stem}.toml"):
        return file
    return None


@dataclass(frozen=True)
class Experiment:
    """The run, table and figures of one stem, as a page shows them."""

    stem: str
    title: str
    run: Results | None  # None: only drawn from the results of others, or not measured
    table: str  # with its verdicts and notes, as HTML; empty if there is none
    figures: Sequence[tuple[str, str]]  # file name and caption
    downloads: Sequence[str]  # file names

    @property
    def file(self) -> str:
        """The experiment's file, from the root of the project; empty if the stem has none."""
        path = file_of(self.stem)
        return str(path.relative_to(ROOT)) if path else ""

    @property
    def seconds(self) -> float:
        """The time in solvers: structures, first answers and repeats; NaN if the experiment was not
        run."""
        return ledger.seconds_run(self.run) if self.run else float("nan")

    @property
    def profiles(self) -> str:
        return ", ".join(dict.fromkeys(map(str, self.run.cases.profile))) if self.run else ""

    @property
    def there(self) -> bool:
        return bool(self.table or self.figures)


def table_html(markdown: str) -> str:
    """Renders the Markdown of a table file. HTML in it, as in a name from a result file, stays
    text."""
    rendered = str(
        markdown_it.MarkdownIt("js-default", {"html": False, "linkify": False}).render(markdown)
    )
    return rendered.replace(
        "<table>", '<div class="wide" tabindex="0" role="region" aria-label="table"><table>'
    ).replace("</table>", "</table></div>")


def experiment(stem: str, results: dict[str, Results], out: Path) -> Experiment:
    """Collects the figures and tables of a stem, and copies them beside the pages."""
    files = out / "report" / "files"
    files.mkdir(parents=True, exist_ok=True)
    table, pictures = out / "tables" / f"{stem}.md", document.figures_of(out, stem, "png")
    downloads = [path.with_suffix(".pdf") for path, _ in pictures]
    downloads += [table.with_suffix(suffix) for suffix in (".csv", ".tex")]
    figures = [(name, caption) for path, caption in pictures if (name := picture(path, files))]
    return Experiment(
        stem,
        document.title_of(stem),
        results.get(_measured_as(stem)),
        table_html(table.read_text(encoding="utf-8", errors="replace"))
        if gate.is_plain(table)
        else "",
        figures,
        [copied(path, files) for path in downloads if gate.is_plain(path)],
    )


def picture(path: Path, files: Path) -> str:
    """Copies a picture and returns the name of the copy. Names one that cannot be read on standard
    error, and returns an empty string."""
    try:
        return copied(path, files)
    except UNREADABLE as problem:
        print(printable(f"{path}: cannot be read, and is left out: {problem}"), file=sys.stderr)
        return ""


def _measured_as(stem: str) -> str:
    return stems.results_of(stem) if stems.has_script(stem) else stem


def loaded(folder: Path) -> dict[str, Results]:
    """Loads all results of a folder, by stem. Names damaged files and leaves them out."""
    return {result.stem: result for result in load_all(results_in(folder))}


def environment() -> jinja2.Environment:
    made = jinja2.Environment(
        loader=jinja2.FileSystemLoader(HERE / "templates"),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        finalize=without_marks,
    )
    filters: dict[str, Any] = {
        "seconds": seconds_text,
        "thousands": lambda x: f"{int(x):,}",
        "with_code": with_code,
    }
    made.filters |= filters
    return made


def without_marks(value: Any) -> Any:
    """Returns a text from a result without the marks that would turn what stands beside it; HTML of
    our own as it is."""
    return printable(value, lines=True) if type(value) is str else value


def with_code(text: str) -> markupsafe.Markup:
    """Returns the text with `names` in code, and all else as it is."""
    return markupsafe.Markup("").join(
        markupsafe.Markup("<code>{}</code>").format(part) if k % 2 else part
        for k, part in enumerate(text.split("`"))
    )


def seconds_text(seconds: float) -> str:
    """Returns '12 s', '3 min' or '2.5 h'; an empty string for NaN."""
    if seconds != seconds:
        return ""
    if seconds < 0.5:
        return "less than 1 s"
    return (
        f"{seconds:.0f} s"
        if seconds < 100
        else f"{seconds / 60:.0f} min"
        if seconds < 6000
        else f"{seconds / 3600:.1f} h"
    )


def libraries(results: Results) -> str:
    """Returns 'CGAL 5.5.1, Eigen 3.4.0': the libraries of the program that wrote the results."""
    return ", ".join(
        f"{name} {version}"
        for name, version in json.loads(str(results.meta.get("libraries") or "{}")).items()
    )


def shared(results: dict[str, Results]) -> dict[str, Any]:
    """Returns what every page says: the navigation, and versions and hardware for its foot."""
    machines = list(dict.fromkeys(measured_on(result) for result in results.values()))
    papers = {name: title for name, title in paper_page.TITLES.items() if name != claims.OWN}
    return {
        "pages": PAGES,
        "papers": papers,
        "own": claims.OWN,
        "machines": machines,
        "libraries": list(dict.fromkeys(libraries(result) for result in results.values())),
    }


def write(results_folder: Path, out: Path) -> tuple[list[Path], list[str]]:
    """Writes all pages. Returns their paths, and a line for each claim whose text does not fit its
    verdict.

    Names a result that no run can have written on standard error, and leaves it out.
    """
    results = loaded(results_folder)
    try:
        return write_pages(results, out)
    except Exception:
        write_pages({}, out)  # raises again if the error is in none of the results
        usable = {stem: result for stem, result in results.items() if writes_alone(result, out)}
        if len(usable) == len(results):
            raise
        return write_pages(usable, out)


def writes_alone(results: Results, out: Path) -> bool:
    """Writes the pages of one result, over any others. Returns False if that fails, and names the
    result on standard error."""
    try:
        write_pages({results.stem: results}, out)
    except Exception as problem:
        print(left_out(results, problem), file=sys.stderr)
        return False
    return True


def write_pages(results: dict[str, Results], out: Path) -> tuple[list[Path], list[str]]:
    folder = out / "report"
    shutil.rmtree(folder / "files", ignore_errors=True)  # of an earlier report
    folder.mkdir(parents=True, exist_ok=True)
    now = paper_page.records(out / "tables")
    kept = paper_page.records(REFERENCE)
    lines = {paper: paper_page.lines_of(paper, now, kept) for paper in paper_page.papers()}
    problems = [problem for several in lines.values() for problem in outcomes.misfits(several)]
    plots = (LIBRARIES / "plots.js").exists()
    made, common, paths = environment(), shared(results), list[Path]()

    def page(here: str, template: str, **more: Any) -> None:
        paths.append(folder / f"{here}.html")
        table_files.write_whole(
            paths[-1], made.get_template(template).render(here=here, **common, **more)
        )

    pages_of: dict[str, list[Experiment]] = {}
    for name in lines:
        pages_of[name] = [experiment(stem, results, out) for stem in document.stems_of(name)]
    verdicts = {name: outcomes.paper(name, several) for name, several in lines.items()}
    rows = sum(len(result.cases) for result in results.values())
    paper_lines = [line for name in common["papers"] for line in verdicts[name].lines]
    page(
        "index",
        "index.html.j2",
        results=results,
        rows=rows,
        problems=problems,
        choice=chooser.matrix(results),
        claims=verdicts,
        paper_claims=outcomes.Paper(title="", lines=paper_lines),
        runs=[
            Experiment(stem, document.title_of(stem), result, table="", figures=(), downloads=())
            for stem, result in results.items()
        ],
    )
    for name in common["papers"]:
        page(
            name,
            "paper.html.j2",
            name=name,
            experiments=pages_of[name],
            claims=verdicts[name],
            sketches=paper_page.SKETCHES.get(name, ()),
        )
    page(
        "experiments",
        "experiments.html.j2",
        experiments=[drawn for drawn in pages_of[claims.OWN] if drawn.there],
        claims=verdicts[claims.OWN],
    )
    page("rows", "rows.html.j2", rows=rows, plots=plots, statuses=all_rows.STATUSES)
    shown = scenes.described(results)
    page(
        "scenes",
        "scenes.html.j2",
        count=len(shown["scenes"]),
        view=(LIBRARIES / "view.js").exists(),
    )
    kinds, answers = matrix.described(results)
    page(
        "stability",
        "stability.html.j2",
        kinds=kinds,
        plots=plots,
        outcomes=list(Outcome),
        stops=[(words, letter) for letter, words in STOPS.values()],
    )
    timings = history()
    left_out = ledger.by_time([ledger.read(result) for result in results.values()])
    page(
        "work",
        "work.html.j2",
        table=ledger.table(left_out) if left_out else None,
        totals=ledger.line(left_out) if left_out else "",
        history=bool(timings),
        plots=plots,
    )
    table_files.write_whole(
        folder / "rows_data.js", "window.hausbenchRows = " + all_rows.script(results) + ";\n"
    )
    table_files.write_whole(
        folder / "history_data.js",
        "window.hausbenchHistory = " + all_rows.as_script(timings) + ";\n",
    )
    table_files.write_whole(
        folder / "stability_data.js",
        "window.hausbenchStability = " + all_rows.as_script(answers) + ";\n",
    )
    table_files.write_whole(
        folder / "scenes_data.js", "window.hausbenchScenes = " + all_rows.as_script(shown) + ";\n"
    )
    for path in [
        *sorted((HERE / "web").iterdir()),
        *(
            path
            for name in ("view.js", "plots.js", "licences.txt")
            if (path := LIBRARIES / name).exists()
        ),
    ]:
        shutil.copyfile(path, folder / path.name)
    return paths, problems


def history(file: Path = ROOT / "results" / "history.csv") -> list[dict[str, Any]]:
    """Returns the timings of results/history.csv, which bench/tracking/history.py describes,
    without the rows that have only counts."""

    def number(text: str) -> float | None:
        return all_rows.rounded(float(text)) if text else None

    if not file.exists():
        return []
    with file.open(encoding="utf-8", newline="") as lines:
        return [
            {
                "commit": row["commit"],
                "machine": row["machine"],
                "measured": row["measured"],
                "case": row["case"],
                "seconds": seconds,
                "low": number(row["cpu_low"]),
                "high": number(row["cpu_high"]),
            }
            for row in csv.DictReader(lines)
            if (seconds := number(row["cpu_seconds"])) is not None
        ]


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="analysis.report.pages",
        description="Writes the report of all results as pages of HTML.",
    )
    parser.add_argument(
        "--results",
        type=Path,
        default=Path("results"),
        help="folder of the .h5 files (default: results)",
    )
    parser.add_argument(
        "--out",
        type=Path,
        help="folder with tables/ and figures/; the pages go to report/ there (default: the results folder)",
    )
    parser.add_argument(
        "--strict",
        action="store_true",
        help="exit code 1 if the text on why a claim does not hold no longer fits its verdict",
    )
    chosen = parser.parse_args(arguments)
    try:
        paths, problems = write(chosen.results, chosen.out or chosen.results)
    except (OSError, ResultError, ValueError) as error:
        print(printable(str(error)), file=sys.stderr)
        return 2
    for problem in problems:
        print(printable(problem), file=sys.stderr)
    print(f"{len(paths)} pages; open {paths[0]}")
    return 1 if problems and chosen.strict else 0


if __name__ == "__main__":
    sys.exit(main())
