"""Pictures of the report for the docs: ``python -m benchmarks.report`` simulates the rig and photographs its page.

It needs Debian's Chromium and Playwright, as the tests of the page do.
"""

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from ltcgear.runtime import load
from ltcgear.runtime.api.restoring import find_background
from ltcgear.runtime.cli.running import run
from ltcgear.runtime.view.report.page import write_report
from playwright.sync_api import sync_playwright

IMAGES = Path(__file__).parents[1] / "docs" / "images"
CHROMIUM = "/usr/bin/chromium"
FLAGS = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run"]
SHOTS: tuple[tuple[str, tuple[int, int], str, str], ...] = (
    ("report.png", (1280, 1080), "light", "header"),
    ("report-dark.png", (1280, 900), "dark", "#stage"),
    ("report-phone.png", (390, 844), "light", "#stage"),
)
"""File, size of the window, colours, and the part of the page at its top."""
FRAME = 700
"""Frame of the close-up that is shown."""


def main() -> None:
    """Simulate two seconds of the rig, write its report and photograph it."""
    with TemporaryDirectory() as folder:
        file, page = Path(folder, "rig.nc"), Path(folder, "rig.html")
        run("rig-2mw", None, file, 2.0, "auto", 1e-6, verify=True)
        result = load(file)
        write_report(result, page, find_background(result, True))
        print(f"page of {page.stat().st_size / 1e6:.2f} MB")
        with sync_playwright() as playwright:
            browser = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
            for shot in SHOTS:
                take(browser, page, *shot)
            browser.close()


def take(browser: Any, page: Path, name: str, size: tuple[int, int], scheme: str, part: str) -> None:  # noqa: ANN401
    """Photograph what a window shows of a page."""
    context = browser.new_context(
        viewport={"width": size[0], "height": size[1]}, color_scheme=scheme, reduced_motion="reduce"
    )
    opened = context.new_page()
    opened.goto(page.as_uri())
    opened.evaluate(
        "(frame) => { const item = document.getElementById('scrub'); item.value = frame; "
        "item.dispatchEvent(new Event('input')); }",
        FRAME,
    )
    opened.locator(part).first.evaluate("(item) => item.scrollIntoView()")
    opened.wait_for_timeout(200)
    target = IMAGES / name
    opened.screenshot(path=target)
    context.close()
    print(f"wrote {target} ({target.stat().st_size / 1e3:.0f} kB)")


if __name__ == "__main__":
    main()
