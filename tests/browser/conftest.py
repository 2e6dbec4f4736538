"""A real browser for pages: Debian's Chromium, driven by Playwright; skipped where there is none."""

import os
from pathlib import Path

import pytest

CHROMIUM = "/usr/bin/chromium"
FLAGS = [
    "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync",
]  # fmt: skip
DESKTOP = (1280, 800)


@pytest.fixture(scope="module")
def chromium():
    """Chromium without a window; it ends with the module. LTCGEAR_BROWSER=1 makes a missing one an error."""
    if not Path(CHROMIUM).exists() and os.environ.get("LTCGEAR_BROWSER") != "1":
        pytest.skip(f"{CHROMIUM} is not installed; set LTCGEAR_BROWSER=1 to make this an error")
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        yield browser
        browser.close()


@pytest.fixture
def visit(chromium):
    """Open a page of a file; in the end nothing may have been asked for, nor anything been complained of."""
    seen, contexts = [], []

    def opener(path, size=DESKTOP, **options):
        context = chromium.new_context(viewport={"width": size[0], "height": size[1]}, **options)
        contexts.append(context)
        page = context.new_page()
        address = Path(path).resolve().as_uri()
        page.on("console", lambda message: seen.append(message.text))
        page.on("pageerror", lambda error: seen.append(str(error)))
        page.on("request", lambda asked: asked.url in (address, "data:,") or seen.append(asked.url))
        page.goto(address)
        return page

    yield opener
    for context in contexts:
        context.close()
    assert seen == []
