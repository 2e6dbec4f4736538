"""The report in Chromium: it loads in silence, plays, scrubs, shows the right force, prints, and suits phones."""

import re
from math import hypot

import numpy as np
import pytest
from ltcgear.runtime import load
from ltcgear.runtime.api import restoring
from ltcgear.runtime.view.report.page import write_report

from reports import simulate_into

STILL = {"reduced_motion": "reduce"}
DESKTOP, PHONE = (1280, 800), (390, 844)


@pytest.fixture(scope="module")
def rig(tmp_path_factory):
    """The rig's result and its page."""
    return write_page(tmp_path_factory.mktemp("rig"), "rig-2mw", 0.4)


def write_page(folder, scene, t_end):
    file = simulate_into(folder, scene, t_end)
    result = load(file)
    page = file.with_suffix(".html")
    write_report(result, page, restoring.find_background(result, True))
    return result, page


def frames(page):
    return int(page.get_attribute("#scrub", "max"))


def scrub(page, frame):
    """Move the slider as a hand would, and return the time and force [N] that the page then tells."""
    page.evaluate(
        "(frame) => { const item = document.getElementById('scrub'); item.value = frame; "
        "item.dispatchEvent(new Event('input')); }",
        frame,
    )
    force, unit = page.inner_text("#force").split()
    return float(page.inner_text("#time").split()[0]), float(force) * {"kN": 1e3, "N": 1.0}[unit]


def force_at(result, mesh, time):
    force = result.mesh[mesh].force
    return float(force.values[int(np.argmin(abs(force["time"].values - time)))])


def pose(page):
    return page.eval_on_selector_all("g.wheel, g.contact", "(all) => all.map((item) => item.getAttribute('transform'))")


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("size", [DESKTOP, PHONE])
def test_it_loads_in_silence_and_fits(visit, rig, size, scheme):
    page = visit(rig[1], size, color_scheme=scheme)
    page.wait_for_timeout(300)
    assert page.title().startswith("2 MW wind turbine gearbox")
    assert page.evaluate("document.documentElement.scrollWidth") <= size[0]
    ink, ground = (page.evaluate(f"getComputedStyle(document.body).{name}") for name in ("color", "backgroundColor"))
    bright = [sum(int(v) for v in re.findall(r"\d+", colour)[:3]) for colour in (ink, ground)]
    assert (bright[0] < bright[1]) == (scheme == "light")
    assert abs(bright[0] - bright[1]) > 450


@pytest.mark.parametrize("window", ["close", "whole"])
def test_the_force_told_is_that_of_the_file_at_the_time_told(visit, rig, window):
    """At any frame, for any mesh, in both windows; the number has six digits."""
    result, path = rig
    page = visit(path, **STILL)
    page.select_option("#span", window)
    last = frames(page)
    for mesh in ("lsp.sun_planet.1", "hsp.ring_planet.2", "psh.mesh"):
        page.click(f'button[data-mesh="{mesh}"]')
        assert page.inner_text("#chosen") == mesh
        for frame in (0, 1, last // 3, last):
            time, force = scrub(page, frame)
            assert force == pytest.approx(force_at(result, mesh, time), rel=1e-5)
    first, final = scrub(page, 0)[0], scrub(page, last)[0]
    times = result.dataset["time"].values
    assert final > times[-1] - 1e-3
    assert first == (0.0 if window == "whole" else pytest.approx(times[-1 - last], abs=1e-6))


def test_all_forces_of_the_lists_are_those_of_the_file(visit, rig):
    result, path = rig
    page = visit(path, **STILL)
    time, _ = scrub(page, 777)
    told = page.eval_on_selector_all(
        "button[data-mesh]", "(all) => all.map((b) => [b.dataset.mesh, b.querySelector('output').value])"
    )
    assert len(told) == 15
    for mesh, text in told:
        assert float(text.split()[0]) * 1e3 == pytest.approx(force_at(result, mesh, time), rel=1e-3)


def test_the_script_draws_what_the_page_drew(visit, rig):
    """The first frame is posed twice, by the page's maker and by its script: both agree."""
    quiet, live = visit(rig[1], java_script_enabled=False), visit(rig[1], **STILL)
    drawn = []
    for page in (quiet, live):
        source = page.content()
        wheels = re.findall(r'<g class="(?:wheel|contact)[^>]*transform="([^"]*)"', source)
        drawn.append([[float(v) for v in re.findall(r"-?[\d.]+", text)] for text in wheels])
    assert len(drawn[0]) == len(drawn[1]) > 30
    for (x, y, turn), (x2, y2, turn2) in zip(*drawn, strict=True):
        assert hypot(x - x2, y - y2) < 0.05
        assert abs((turn - turn2 + 180) % 360 - 180) < 0.05


def test_arrows_are_as_long_as_forces(visit, rig):
    """Within a stage the arrows' lengths are in the ratio of the forces told beside them."""
    page = visit(rig[1], **STILL)
    scrub(page, 400)
    found = page.eval_on_selector_all(
        "g.contact", "(all) => all.map((g) => [g.dataset.mesh, g.querySelector('.push').getAttribute('d')])"
    )
    told = dict(
        page.eval_on_selector_all(
            "button[data-mesh]",
            "(all) => all.map((b) => [b.dataset.mesh, parseFloat(b.querySelector('output').value)])",
        )
    )
    for stage in ("lsp", "hsp"):
        scale = {
            round(float(re.search(r"M(-?[\d.]+) 0l", path)[1]) / told[mesh], 3)
            for mesh, path in found
            if mesh.startswith(stage)
        }
        assert max(scale) - min(scale) < 0.004


def test_it_plays_and_pauses(visit, rig):
    page = visit(rig[1])
    assert page.inner_text("#play") == "Pause"  # it plays by itself
    before = pose(page)
    page.wait_for_function("Number(document.getElementById('scrub').value) > 3")
    assert pose(page) != before
    page.click("#play")
    stopped = page.input_value("#scrub")
    page.wait_for_timeout(200)
    assert page.input_value("#scrub") == stopped


def test_who_wants_less_motion_gets_none(visit, rig):
    page = visit(rig[1], **STILL)
    page.wait_for_timeout(200)
    assert page.inner_text("#play") == "Play"
    assert page.input_value("#scrub") == "0"
    assert page.inner_text("#move") == "Move"


def test_the_keyboard_does_it_all(visit, rig):
    page = visit(rig[1], **STILL)
    page.focus("#stage")
    value = lambda: int(page.input_value("#scrub"))  # noqa: E731
    for key, expected in (
        ("ArrowRight", 1),
        ("Shift+ArrowRight", 11),
        ("ArrowLeft", 10),
        ("End", frames(page)),
        ("Home", 0),
    ):
        page.keyboard.press(key)
        assert value() == expected, key
    page.keyboard.press("Space")
    assert page.inner_text("#play") == "Pause"
    page.keyboard.press("Space")
    assert page.inner_text("#play") == "Play"
    page.keyboard.press("Home")
    for _ in range(3):
        page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.matches('button[data-mesh], #scrub, #play')")


def test_a_click_on_an_arrow_chooses_its_mesh(visit, rig):
    page = visit(rig[1], **STILL)
    page.evaluate(
        "document.documentElement.style.scrollBehavior = 'auto'; document.getElementById('stage').scrollIntoView()"
    )
    page.locator('g.contact[data-mesh="psh.mesh"] .touch').click(force=True)
    assert page.inner_text("#chosen") == "psh.mesh"
    assert page.get_attribute('button[data-mesh="psh.mesh"]', "aria-pressed") == "true"
    assert page.locator("g.contact.on").count() == 1


def test_deflections_follow_their_slider(visit, rig):
    """Without exaggeration planets stand on their pins' circle; with it they leave it in proportion."""
    page = visit(rig[1], **STILL)
    place = 'g.wheel[data-body="lsp.planet.1"]'

    def radius(share):
        page.evaluate(
            "(share) => { const item = document.getElementById('grow'); item.value = share; "
            "item.dispatchEvent(new Event('input')); }",
            share,
        )
        x, y = (float(v) for v in re.findall(r"-?[\d.]+", page.get_attribute(place, "transform"))[:2])
        return x, y

    none, one, two = (np.array(radius(share)) for share in (0, 1, 2))
    assert hypot(*none) == pytest.approx(100 * (22 + 48) / 118, abs=0.02)  # teeth of Table 2
    assert np.allclose(two - none, 2 * (one - none), atol=0.03)
    assert hypot(*(one - none)) > 1


def test_cursors_of_the_pictures_follow(visit, rig):
    result, path = rig
    page = visit(path, **STILL)
    page.select_option("#span", "whole")
    times = result.dataset["time"].values
    for frame in (0, frames(page) // 2, frames(page)):
        time, _ = scrub(page, frame)
        at = page.evaluate(
            "(() => { const figure = document.querySelector('#forces figure');"
            "const axes = JSON.parse(figure.dataset.clocks)[0];"
            "const x = Number(figure.querySelector('.cursor').getAttribute('x1'));"
            "return axes.begin + (axes.end - axes.begin) * (x - axes.left) / (axes.right - axes.left); })()"
        )
        assert at == pytest.approx(time, abs=2e-3 * times[-1])


def test_parted_teeth_are_drawn_open(visit, tmp_path):
    """In the start-up teeth part: where the file says so the arrow is gone and the circle is open."""
    result, path = write_page(tmp_path, "start-up", 1.25)
    page = visit(path, **STILL)
    page.select_option("#span", "whole")
    mesh = result.mesh["pair.mesh"]
    seen = set()
    for frame in range(frames(page), 0, -25):
        time, _ = scrub(page, frame)
        k = int(np.argmin(abs(mesh.force["time"].values - time)))
        apart, force = bool(mesh.contact.values[k] == 0), float(mesh.force.values[k])
        assert page.locator('g.contact[data-mesh="pair.mesh"] .push').is_visible() == (not apart and force != 0)
        assert page.locator('g.contact[data-mesh="pair.mesh"] .gap').is_visible() == (apart or force == 0)
        seen.add(apart)
    assert seen == {True, False}


def test_without_javascript_it_is_read_as_still_pictures(visit, rig):
    page = visit(rig[1], java_script_enabled=False)
    assert page.locator(".panel svg").first.is_visible()
    assert not page.locator("#play").is_visible()
    assert "Without JavaScript" in page.inner_text("#stage")
    assert page.locator("figure.picture svg").count() > 15
    assert page.locator("figure.mode").first.is_visible()


def test_modes_move(visit, rig):
    page = visit(rig[1])
    page.locator("#modes figure").first.scroll_into_view_if_needed()
    before = page.get_attribute("g.part", "transform")
    page.wait_for_function(
        "(before) => document.querySelector('g.part').getAttribute('transform') !== before", arg=before
    )
    page.click("#move")
    assert page.inner_text("#move") == "Move"


def test_it_prints_on_a4(visit, rig, tmp_path):
    """Pages of A4 upright (595 by 842 points), controls left out, and no more of them than sections call for."""
    page = visit(rig[1], **STILL)
    printed = page.pdf(prefer_css_page_size=True)
    boxes = re.findall(rb"/MediaBox\s*\[\s*0 0 ([\d.]+) ([\d.]+)\s*\]", printed)
    assert 5 < len(boxes) < 30
    assert all((round(float(w)), round(float(h))) in {(595, 842), (596, 842)} for w, h in boxes)
    page.emulate_media(media="print")
    assert not page.locator(".controls, .transport").first.is_visible()
    assert not page.locator("nav").is_visible()


def test_names_with_html_stay_text(visit, rig, tmp_path):
    result, _ = rig
    result.dataset.attrs["title"], kept = "<img src=x onerror=alert(1)>", result.dataset.attrs["title"]
    try:
        write_report(result, tmp_path / "evil.html")
    finally:
        result.dataset.attrs["title"] = kept
    page = visit(tmp_path / "evil.html", **STILL)
    assert page.inner_text("h1") == "<img src=x onerror=alert(1)>"
    assert page.locator("img").count() == 0
