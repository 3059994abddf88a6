"""The pages of the report in a real browser: they load without errors, filters change the rows, and
axe-core finds nothing serious.

`make test-report` installs the browser; without it these tests are skipped.
"""

from __future__ import annotations

import shutil
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
pytestmark = pytest.mark.skipif(
    not (CHROMIUM and DRIVER), reason="chromium and chromium-driver are not installed"
)
ROWS = 26_000


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Writes a report of made-up results: ROWS rows, a scene with fields, a motion of 5 poses, and
    the stability suite. Every mesh is a tetrahedron."""
    from analysis.report import pages as written
    from analysis.shared import shapes
    from stem_runner import TETRAHEDRON
    from synthetic import ResultFile
    from synthetic_stability import small

    folder = tmp_path_factory.mktemp("report")
    file = ResultFile("mesh_peers")
    for k in range(ROWS):
        solver = ("cover", "tang", "sacht", "guthe")[k % 4]
        file.case(
            solver,
            f"pair {k // 8}",
            [0.1 + k * 1e-6],
            lower=0.5 - (k % 4) * 1e-9,
            upper=0.5,
            tolerance=(1e-6, 1e-8)[k // 4 % 2],
            tolerance_of="diagonal",
            status="ok" if k % 13 else "budget",
            reason="" if k % 13 else "its budget is spent",
        )
    file.write(folder)
    scene = ResultFile("overview")
    scene.case(
        "cover",
        "bunny",
        [1.0],
        lower=0.5,
        upper=0.75,
        witness_source=[0.0, 0.0, 0.0],
        witness_target=[2.0, 0.0, 0.0],
    )
    scene.fields = [
        {"case": 0, "name": name, "of": of, "begin": begin, "end": begin + 4}
        for name, of, begin in (("distance", "vertices", 0), ("bound", "elements", 4))
    ]
    scene.field_values = [0.0, 0.1, 0.2, 0.5, 0, 1, 2, 5]
    for k in range(5):
        scene.case(
            "tang",
            "moving",
            [1.0],
            lower=0.1 * k,
            upper=0.1 * k + 0.05,
            pose_index=k,
            pose=[1.0, 0, 0, 0, 1, 0, 0, 0, 1, 3.0 - 0.5 * k, 0, 0],
        )
    scene.write(folder)
    small().file.write(folder)
    with pytest.MonkeyPatch.context() as changed:
        changed.setattr(shapes, "mesh", lambda results, model: TETRAHEDRON)
        written.write(folder, folder)
    yield folder / "report"


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    from selenium.webdriver.chrome.options import Options
    from selenium.webdriver.chrome.service import Service

    options: Any = Options()
    options.binary_location = str(CHROMIUM)
    for flag in (
        "--headless=new",
        "--no-sandbox",
        "--enable-unsafe-swiftshader",
        "--window-size=1400,1000",
        "--disable-dev-shm-usage",
    ):
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    made = selenium.Chrome(service=Service(str(DRIVER)), options=options)
    yield made
    made.quit()


def opened(browser: Any, report: Path, page: str) -> None:
    browser.get("about:blank")
    browser.get((report / page.partition("#")[0]).as_uri() + page[len(page.partition("#")[0]) :])


def pages(report: Path) -> list[str]:
    return sorted(path.name for path in report.glob("*.html"))


def test_pages_load_without_a_message(browser: Any, report: Path) -> None:
    """Messages of the driver of the graphics card do not count: without a card, it says that it is
    slow."""
    assert len(pages(report)) >= 8
    for page in pages(report):
        opened(browser, report, page)
        time.sleep(0.2)
        assert [
            entry for entry in browser.get_log("browser") if entry["source"] != "rendering"
        ] == [], page
        assert browser.execute_script("return document.querySelector('h1').textContent")


def test_filters_change_the_rows_and_the_address(browser: Any, report: Path) -> None:
    opened(browser, report, "rows.html#stem=mesh_peers")
    shown = "return document.getElementById('shown').textContent.split(' of ')[0]"
    assert browser.execute_script(shown) == f"{ROWS:,}"
    browser.execute_script(
        "const s = document.forms[0].elements.status; s.value = 'budget'; s.dispatchEvent(new Event('input', {bubbles: true}))"
    )
    assert browser.execute_script(shown) == f"{ROWS // 13:,}"
    assert browser.current_url.endswith("#stem=mesh_peers&status=budget")
    opened(browser, report, "rows.html#status=budget&scene=pair+7")
    count = int(browser.execute_script(shown).replace(",", ""))
    assert 0 < count < ROWS // 13
    browser.execute_script("document.querySelector('#rows tbody button').click()")
    assert "its budget is spent" in browser.execute_script(
        "return document.getElementById('row').textContent"
    )


def test_a_filter_makes_one_page_of_rows(browser: Any, report: Path) -> None:
    """So its time does not grow with the number of elements on the page."""
    opened(browser, report, "rows.html")
    made = browser.execute_script(
        """const s = document.forms[0].elements.scene, counts = [];
        for (const text of ["1", "12", "123", ""]) {
            s.value = text; s.dispatchEvent(new Event("input", {bubbles: true}));
            counts.push(document.querySelectorAll("#rows tbody tr").length);
        }
        return counts;"""
    )
    assert made == [100] * 4
    shown, every = (
        browser.execute_script("return document.getElementById('shown').textContent")
        .split(" rows")[0]
        .split(" of ")
    )
    assert shown == every and int(every.replace(",", "")) > ROWS


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
            assert (
                browser.execute_script(
                    "return document.documentElement.scrollWidth - document.documentElement.clientWidth"
                )
                <= 0
            ), page
    finally:
        browser.set_window_size(before["width"], before["height"])


def axe(folder: Path) -> str:
    """Returns the script of axe-core, fetched from npm by name; skips the test if npm cannot reach
    it."""
    sys.path.insert(0, str(ROOT / "datasets"))
    from packages import Unavailable, fetch_npm, npm_members

    try:
        script: bytes = dict(
            npm_members(fetch_npm("axe-core", "4.14.1", folder), ("package/axe.min.js",))
        )["package/axe.min.js"]
        return script.decode()
    except Unavailable as problem:
        pytest.skip(f"axe-core: {problem}")


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_axe_finds_nothing_serious(browser: Any, report: Path, tmp_path: Path, scheme: str) -> None:
    script = axe(tmp_path)
    browser.execute_cdp_cmd(
        "Emulation.setEmulatedMedia",
        {"features": [{"name": "prefers-color-scheme", "value": scheme}]},
    )
    for page in pages(report):
        opened(browser, report, page)
        time.sleep(0.1)
        browser.execute_script(script)
        violations = browser.execute_async_script("axe.run().then(arguments[0])")["violations"]
        serious = [
            (violation["id"], violation["nodes"][0]["html"][:200])
            for violation in violations
            if violation["impact"] in ("serious", "critical")
        ]
        assert serious == [], page


def drawn(browser: Any) -> str:
    """Returns the picture in the view, as text. A view keeps its pixels only until the script ends
    that drew them."""
    return str(
        browser.execute_script(
            "window.hausbenchShown.draw(); return window.hausbenchShown.canvas.toDataURL()"
        )
    )


def share_drawn(browser: Any) -> float:
    """Returns the share of pixels of the view that are not background."""
    return float(
        browser.execute_script(
            """window.hausbenchShown.draw();
        const from = window.hausbenchShown.canvas, to = document.createElement("canvas");
        to.width = from.width; to.height = from.height;
        const pen = to.getContext("2d"); pen.drawImage(from, 0, 0);
        const pixels = pen.getImageData(0, 0, to.width, to.height).data;
        let seen = 0;
        for (let i = 3; i < pixels.length; i += 4) seen += pixels[i] > 0;
        return 4 * seen / pixels.length;"""
        )
    )


def waits(browser: Any, script: str) -> Any:
    """Returns the value of a script once it is not null or false, for at most ten seconds."""
    for _ in range(100):
        if value := browser.execute_script(script):
            return value
        time.sleep(0.1)
    pytest.fail(f"never became true: {script}")


def chosen(browser: Any, form: str, name: str, value: str) -> None:
    browser.execute_script(
        "const s = document.getElementById(arguments[0]).elements[arguments[1]]; s.value = arguments[2];"
        "s.dispatchEvent(new Event('input', {bubbles: true}))",
        form,
        name,
        value,
    )


def test_a_view_shows_the_scene_and_the_slider_moves_it(browser: Any, report: Path) -> None:
    opened(browser, report, "scenes.html")
    waits(browser, "return Boolean(window.hausbenchShown)")
    assert 0.01 < share_drawn(browser) < 0.9
    assert "h(A, B) in [0.5, 0.75], by cover" in browser.execute_script(
        "return document.getElementById('state').textContent"
    )
    assert "witness" in browser.execute_script(
        "return document.getElementById('legend').textContent"
    )
    before = drawn(browser)
    chosen(browser, "scene", "colour", "bound")
    assert before != drawn(browser)
    assert "four nearest triangles" in browser.execute_script(
        "return document.getElementById('legend').textContent"
    )
    chosen(browser, "scene", "scene", "1")
    first = drawn(browser)
    chosen(browser, "scene", "pose", "4")
    assert browser.execute_script("return document.getElementById('state').textContent").startswith(
        "pose 5 of 5: h(A, B) in [0.4, 0.45"
    )
    assert first != drawn(browser)


def test_the_view_turns_by_keys(browser: Any, report: Path) -> None:
    opened(browser, report, "scenes.html")
    canvas = waits(browser, "return window.hausbenchShown && window.hausbenchShown.canvas")
    before = browser.execute_script("return window.hausbenchShown.camera.position.toArray()")
    browser.execute_script("arguments[0].focus()", canvas)
    canvas.send_keys("\ue012")  # the left arrow
    assert before != browser.execute_script(
        "return window.hausbenchShown.camera.position.toArray()"
    )


def downloaded(browser: Any, link: str) -> str:
    """Returns the file that a click on a link downloads."""
    return str(
        browser.execute_async_script(
            """const link = document.querySelector(arguments[0]);
        link.addEventListener("click", (event) => event.preventDefault());
        link.click();
        fetch(link.href).then((found) => found.text()).then(arguments[1]);""",
            link,
        )
    )


@pytest.mark.parametrize("kind", ["solved", "scatter", "error"])
def test_plots_of_the_chosen_rows(browser: Any, report: Path, kind: str) -> None:
    opened(browser, report, "rows.html#scene=pair+1")
    browser.execute_script("document.getElementById('plotted').scrollIntoView()")
    chosen(browser, "plot", "kind", kind)
    names = {
        "solved": "cases solved within a time",
        "scatter": "two solvers",
        "error": "error against time",
    }
    waits(
        browser,
        f"const s = document.querySelector('#figure svg[aria-label]'); return s && s.getAttribute('aria-label') === '{names[kind]}' && s.querySelector('circle, path[stroke], g[stroke] path')",
    )
    text = downloaded(browser, "#figure a.svg")
    assert text.startswith("<svg") and "var(--paper" not in text and "var(--ink" not in text
    assert len(downloaded(browser, "#figure a.csv").splitlines()) > 2


def test_a_cell_of_the_stability_matrix_shows_its_answers(browser: Any, report: Path) -> None:
    opened(browser, report, "stability.html")
    browser.execute_script("document.querySelector('.matrix button').focus()")
    assert waits(browser, "return document.querySelectorAll('#cell tbody tr').length") >= 1


def test_the_history_of_a_case(browser: Any, report: Path) -> None:
    opened(browser, report, "work.html")
    assert waits(browser, "return document.querySelectorAll('#times tbody tr').length") >= 1
    assert downloaded(browser, "#times a.csv").startswith(
        "commit,machine,measured,case,seconds,low,high\n"
    ) and "<svg" in downloaded(browser, "#times a.svg")
