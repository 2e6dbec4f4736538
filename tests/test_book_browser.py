"""The equation book in a browser: it loads alone, reads without a script, and fits a desk and a hand."""

import re
import shutil

import pytest
from ltcgear.symbolic.book import volume

playwright = pytest.importorskip("playwright.sync_api")
CHROMIUM = shutil.which("chromium")
pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="no chromium on this machine")


@pytest.fixture(scope="module")
def address(tmp_path_factory):
    """Where the book of the rig lies."""
    from ltcgear.runtime.cli.opening import open_scene

    opened = open_scene("rig-2mw")
    path = tmp_path_factory.mktemp("book") / "rig.html"
    made = volume.make_book(opened.scene, opened.model, opened.artifact.manifest, opened.key, [])
    volume.write_book(made, path)
    return path.as_uri()


@pytest.fixture(scope="module")
def browser():
    """A headless Chromium."""
    with playwright.sync_playwright() as driver:
        opened = driver.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield opened
        opened.close()


@pytest.mark.parametrize(("width", "height"), [(1280, 800), (390, 844)])
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_the_page_loads_alone_and_fits(browser, address, width, height, scheme):
    context = browser.new_context(viewport={"width": width, "height": height}, color_scheme=scheme)
    page = context.new_page()
    told, asked = [], []
    page.on("console", lambda message: told.append(message.text))
    page.on("pageerror", lambda error: told.append(str(error)))
    page.on("request", lambda request: asked.append(request.url))
    page.goto(address)
    assert told == []
    assert asked == [address]
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    paper, ink = page.evaluate("(s => [s.backgroundColor, s.color])(getComputedStyle(document.body))")
    shade = [sum(map(int, colour[4:-1].split(", "))) for colour in (paper, ink)]
    assert (shade[0] > shade[1]) == (scheme == "light")
    context.close()


def test_mathematics_is_laid_out(browser, address):
    page = browser.new_page(viewport={"width": 1280, "height": 800})
    page.goto(address)
    flat = (
        """all => all.filter(e => e.getBoundingClientRect().width < 1 || e.getBoundingClientRect().height < 1).length"""
    )
    assert page.locator("math").evaluate_all(flat) == 0
    below = """all => all.filter(e => { const [a, b] = [...e.children].map(c => c.getBoundingClientRect());
        return a.bottom > b.top + 2; }).length"""
    assert page.locator("mfrac").evaluate_all(below) == 0
    above = """all => all.filter(e => { const [a, b] = [...e.children].map(c => c.getBoundingClientRect());
        return b.top > a.top; }).length"""
    assert page.locator("mover").count() > 50
    assert page.locator("mover").evaluate_all(above) == 0
    page.close()


def test_links_lead_to_equations(browser, address):
    page = browser.new_page(viewport={"width": 1280, "height": 800})
    page.goto(address)
    page.locator("nav a", has_text="Equations of motion").click()
    page.wait_for_function("Math.abs(document.getElementById('balances').getBoundingClientRect().top) < 100")
    page.locator("#eq-6-1 a.no").click()
    assert page.url.endswith("#eq-6-1")
    page.close()


def test_the_page_prints_on_a4(browser, address):
    page = browser.new_page()
    page.goto(address)
    paper = page.pdf(prefer_css_page_size=True)
    assert paper.startswith(b"%PDF")
    boxes = {tuple(map(float, box.split())) for box in re.findall(rb"/MediaBox \[([\d. ]+)\]", paper)}
    assert [tuple(map(round, box)) for box in boxes] == [(0, 0, 595, 842)]
    page.close()
