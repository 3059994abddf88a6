"""The pages of the report in a real browser: they load without errors, filters change the rows, and axe-core finds nothing serious.

`make test-report` installs the browser; without it these tests are skipped.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[2]
for folder in (str(ROOT), str(ROOT / "tests" / "analysis")):
    if folder not in sys.path:
        sys.path.insert(0, folder)
CHROMIUM, DRIVER = shutil.which("chromium"), shutil.which("chromedriver")
selenium = pytest.importorskip("selenium.webdriver", reason="python3-selenium is not installed")
pytestmark = pytest.mark.skipif(not (CHROMIUM and DRIVER), reason="chromium and chromium-driver are not installed")
ROWS = 26_000


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Writes a report of made-up results with ROWS rows."""
    from synthetic import ResultFile

    folder = tmp_path_factory.mktemp("report")
    file = ResultFile("mesh_peers")
    for k in range(ROWS):
        solver = ("cover", "tang", "sacht", "guthe")[k % 4]
        file.case(solver, f"pair {k // 8}", [0.1 + k * 1e-6], lower=0.5, upper=0.5 + (k % 4) * 1e-9, tolerance=(1e-6, 1e-8)[k // 4 % 2],
                  tolerance_of="diagonal", status="ok" if k % 13 else "budget", reason="" if k % 13 else "its budget is spent")
    file.write(folder)
    subprocess.run([sys.executable, "-m", "analysis.report.pages", "--results", str(folder)], cwd=ROOT, check=True)
    return folder / "report"


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    from selenium.webdriver.chrome.options import Options
    from selenium.webdriver.chrome.service import Service

    options: Any = Options()
    options.binary_location = str(CHROMIUM)
    for flag in ("--headless=new", "--no-sandbox", "--enable-unsafe-swiftshader", "--window-size=1400,1000", "--disable-dev-shm-usage"):
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    made = selenium.Chrome(service=Service(str(DRIVER)), options=options)
    yield made
    made.quit()


def opened(browser: Any, report: Path, page: str) -> None:
    browser.get("about:blank")
    browser.get((report / page.partition("#")[0]).as_uri() + page[len(page.partition("#")[0]):])


def pages(report: Path) -> list[str]:
    return sorted(path.name for path in report.glob("*.html"))


def test_pages_load_without_a_message(browser: Any, report: Path) -> None:
    assert len(pages(report)) >= 8
    for page in pages(report):
        opened(browser, report, page)
        assert browser.get_log("browser") == [], page
        assert browser.execute_script("return document.querySelector('h1').textContent")


def test_filters_change_the_rows_and_the_address(browser: Any, report: Path) -> None:
    opened(browser, report, "rows.html")
    shown = "return document.getElementById('shown').textContent"
    assert browser.execute_script(shown) == f"{ROWS:,} of {ROWS:,} rows"
    browser.execute_script("const s = document.forms[0].elements.status; s.value = 'budget'; s.dispatchEvent(new Event('input', {bubbles: true}))")
    assert browser.execute_script(shown) == f"{ROWS // 13:,} of {ROWS:,} rows"
    assert browser.current_url.endswith("#status=budget")
    opened(browser, report, "rows.html#status=budget&scene=pair+7")
    count = int(browser.execute_script(shown).split()[0].replace(",", ""))
    assert 0 < count < ROWS // 13
    browser.execute_script("document.querySelector('#rows tbody button').click()")
    assert "its budget is spent" in browser.execute_script("return document.getElementById('row').textContent")


def test_a_filter_is_fast(browser: Any, report: Path) -> None:
    """A wide limit, ten times what it takes on a slow machine: this is no timing, but a filter that walks through all elements would be caught."""
    opened(browser, report, "rows.html")
    took = browser.execute_script("""const s = document.forms[0].elements.scene, times = [];
        for (const text of ["1", "12", "123", ""]) {
            const begin = performance.now();
            s.value = text; s.dispatchEvent(new Event("input", {bubbles: true})); document.body.offsetHeight;
            times.push(performance.now() - begin);
        }
        return Math.min(...times);""")
    assert browser.execute_script("return document.getElementById('shown').textContent").startswith(f"{ROWS:,} of") and took < 1000


def test_pages_turn(browser: Any, report: Path) -> None:
    opened(browser, report, "rows.html")
    place = "return document.getElementById('page').textContent"
    assert browser.execute_script(place) == "1 to 100"
    browser.execute_script("document.getElementById('after').click()")
    assert browser.execute_script(place) == "101 to 200"


def test_a_page_is_not_wider_than_a_narrow_window(browser: Any, report: Path) -> None:
    before = browser.get_window_size()
    browser.set_window_size(500, 900)
    try:
        for page in pages(report):
            opened(browser, report, page)
            assert browser.execute_script("return document.documentElement.scrollWidth - document.documentElement.clientWidth") <= 0, page
    finally:
        browser.set_window_size(before["width"], before["height"])


def axe(folder: Path) -> str:
    """Returns the script of axe-core, fetched from npm by name; skips the test if npm cannot reach it."""
    sys.path.insert(0, str(ROOT / "datasets"))
    from packages import Unavailable, fetch_npm, npm_members

    try:
        script: bytes = dict(npm_members(fetch_npm("axe-core", "4.14.1", folder), ("package/axe.min.js",)))["package/axe.min.js"]
        return script.decode()
    except Unavailable as problem:
        pytest.skip(f"axe-core: {problem}")


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_axe_finds_nothing_serious(browser: Any, report: Path, tmp_path: Path, scheme: str) -> None:
    script = axe(tmp_path)
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [{"name": "prefers-color-scheme", "value": scheme}]})
    for page in pages(report):
        opened(browser, report, page)
        time.sleep(0.1)
        browser.execute_script(script)
        found = browser.execute_async_script("axe.run().then(arguments[0])")["violations"]
        serious = [(one["id"], one["nodes"][0]["html"][:200]) for one in found if one["impact"] in ("serious", "critical")]
        assert serious == [], page
