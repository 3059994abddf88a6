"""Links in documents resolve, README is short, and docs/index.md lists every page and explains the
words of tables and options."""

import re
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
PAGES = sorted(
    ROOT / name
    for name in subprocess.run(
        ["git", "ls-files", "*.md"], cwd=ROOT, capture_output=True, text=True, check=True
    ).stdout.split()
)
LINK = re.compile(r"\]\(([^)\s]+)\)")


def headings(page: Path) -> set[str]:
    """Returns the anchors of a page's headings, as GitHub makes them."""
    titles = re.findall(r"^#+ (.*)$", page.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-") for title in titles}


def broken(page: Path) -> list[str]:
    wrong = []
    for link in LINK.findall(page.read_text(encoding="utf-8")):
        if "://" in link:
            continue
        name, _, anchor = link.partition("#")
        target = (page.parent / name).resolve() if name else page
        if not target.exists() or (anchor and anchor not in headings(target)):
            wrong.append(link)
    return wrong


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_links_lead_somewhere(page: Path) -> None:
    assert broken(page) == []


def test_a_broken_link_is_found(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text(
        "# A title\n[here](#a-title) [gone](gone.md) [there](page.md#another) [out](https://example.org)\n"
    )
    assert broken(page) == ["gone.md", "page.md#another"]


def test_the_index_links_every_page_of_docs() -> None:
    linked = {
        (ROOT / "docs" / link).resolve()
        for link in LINK.findall((ROOT / "docs/index.md").read_text(encoding="utf-8"))
    }
    assert {
        page for page in PAGES if page.parent == ROOT / "docs" and page.name != "index.md"
    } <= linked


def test_words_are_explained() -> None:
    section = (ROOT / "docs/index.md").read_text(encoding="utf-8").partition("\n## Words\n")[2]
    explained = {
        line.split("|")[1].strip() for line in section.splitlines() if line.startswith("| ")
    }
    assert {
        "stem",
        "profile",
        "round",
        "row",
        "case",
        "witness",
        "incumbent",
        "floor",
        "ledger",
    } <= explained
