"""`ltcgear report`: one page that holds all it needs, says what the file says, and refuses what is no result."""

import json
import re
import shutil
import sys
from itertools import pairwise

import netCDF4
import pytest
from ltcgear.runtime import build, load, simulate
from ltcgear.runtime.api import restoring
from ltcgear.runtime.results.checksums import SUMS
from ltcgear.runtime.view.report.page import write_report
from ltcgear.symbolic import build_model, load_scene
from ltcgear.symbolic.emit.pipeline import obtain

from reports import Page, simulate_into

SECTIONS = ["stage", "forces", "share", "spectra", "waterfall", "orbits", "modes", "march", "tables", "scene"]
MOST = 3_000_000


@pytest.fixture(scope="module")
def rig(tmp_path_factory):
    """The rig's result file and its page."""
    folder = tmp_path_factory.mktemp("rig")
    file = simulate_into(folder, "rig-2mw", 0.4, verify=True)
    return file, make_page(file)


@pytest.fixture(scope="module")
def psh(tmp_path_factory):
    """A small result file, and its page."""
    file = simulate_into(tmp_path_factory.mktemp("psh"), "psh", 0.05)
    return file, make_page(file)


def make_page(file, modes=True, **options):
    """Write a result's page beside it, as the command does; return its text."""
    loaded = load(file)
    page = file.with_suffix(".html")
    write_report(loaded, page, restoring.find_background(loaded, modes), **options)
    return page.read_text("utf-8")


def test_the_command_writes_the_page_beside_the_result(data, run, psh, tmp_path):
    file = shutil.copy(psh[0], tmp_path / "mine.nc")
    shown = data("report", file)
    page = tmp_path / "mine.html"
    assert shown == {"result": str(file), "file": str(page), "bytes": page.stat().st_size}
    assert page.read_text("utf-8").replace("mine.", "psh.") == psh[1]
    other = tmp_path / "other.html"
    assert run("report", file, "-o", other, "--at", "0.01", "--no-modes")[0] == 0
    assert "left out by --no-modes" in other.read_text("utf-8")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["mine.html", "mine.nc", "other.html"]


def test_the_page_is_whole_and_needs_nothing_else(rig):
    text = rig[1]
    page = Page(text)
    assert page.faults == []
    assert page.open == []
    assert len(text.encode()) < MOST
    asked = [value for _, attrs, _ in page.elements for key, value in attrs.items() if key in ("src", "href", "data")]
    assert {value[:5] for value in asked if not value.startswith("#")} == {"data:"}
    assert "@import" not in text
    assert "url(http" not in text
    assert not re.search(r"https?://(?!www\.w3\.org/)", text)
    ids = [attrs["id"] for _, attrs, _ in page.elements if "id" in attrs]
    assert len(ids) == len(set(ids))
    assert {value[1:] for value in asked if value.startswith("#")} <= set(ids)
    assert set(re.findall(r"url\(#([^)]*)\)", text)) <= set(ids)


def test_sections_and_headings_are_in_order(rig):
    page = Page(rig[1])
    assert [attrs["id"] for attrs in page.find("section")] == SECTIONS
    levels = [int(tag[1]) for tag, _, _ in page.elements if re.fullmatch(r"h\d", tag)]
    assert levels[0] == 1
    assert levels.count(1) == 1
    assert all(after - before <= 1 for before, after in pairwise(levels))


def test_pictures_say_what_they_show(rig):
    """Every drawing has a name for those who cannot see it; there are as many figures as the rig has to show."""
    page = Page(rig[1])
    drawings = [attrs for attrs in page.find("svg") if attrs.get("aria-hidden") != "true"]
    assert all(attrs.get("role") == "img" and attrs.get("aria-label", "").strip(". ") for attrs in drawings)
    pictures = [attrs for attrs in page.find("figure") if "picture" in attrs.get("class", "")]
    # Forces and spectra of five groups, two accelerations, four shares, two waterfalls, eight orbits or fewer, march.
    assert 5 + 5 + 2 + 4 + 2 + 1 + 2 <= len(pictures) <= 28
    assert len(page.find("figure", class_="mode")) == 8
    assert "lsp.sun" in page.text
    assert "Not drawn" not in page.text


def test_figures_take_colours_and_fonts_from_the_page(rig):
    """No colour of a figure is fixed but those of raster pictures' own curves, so that light and dark both suit."""
    page = Page(rig[1])
    styles = [attrs.get("style", "") for _, attrs, above in page.elements if "svg" in above and "style" in attrs]
    fixed = {colour for style in styles for colour in re.findall(r"#[0-9a-f]{6}", style)}
    assert fixed <= {"#ffffff"}
    assert "var(--blue)" in "".join(styles)
    fonts = {style.split("font-family:")[1].split(";")[0].strip() for style in styles if "font-family" in style}
    assert fonts == {"var(--font)"}


def test_the_head_tells_how_the_run_went(rig, data):
    page, file = Page(rig[1]), rig[0]
    summary = json.loads(netCDF4.Dataset(file).getncattr("counts"))
    words = " ".join(page.text.split())
    assert f"{summary['steps']:,}" in words
    assert f"{summary['events']:,}" in words
    assert "as kinematics calls for" in words
    assert "rms of the mean force" in words
    assert "of the strain energy" in words
    chips = [attrs for tag, attrs, above in page.elements if tag == "li" and "ul" in above and "header" in above]
    assert len(chips) > 10


def test_without_verify_the_page_says_how_to_get_an_accuracy(psh):
    assert "simulate with --verify" in Page(psh[1]).text


def test_tables_hold_the_numbers_of_the_file(psh):
    forces = json.loads(netCDF4.Dataset(psh[0]).getncattr("statistics"))
    words = Page(psh[1]).text
    assert f"{forces['psh.mesh']['mean']:,.0f}" in words
    assert f"{forces['psh.mesh']['load_factor']:.5g}" in words


def test_the_scene_stands_in_the_page_with_its_sources(rig):
    page = Page(rig[1])
    for words in ("[stages.lsp.ring]", "printed: Table 2", "Wu, Zhou, Jiang, Chen", "[loads.generator]"):
        assert words in page.text
    labels = [attrs["class"].split()[1] for attrs in page.find("span") if attrs.get("class", "").startswith("tag")]
    assert {"printed", "derived", "assumed"} <= set(labels)


def test_html_in_names_is_shown_as_text(run, psh, tmp_path):
    """Titles, comments, changes and even names in the file itself cannot become elements."""
    evil = "<img src=x onerror=alert(1)></script><b>\"'&"
    file = shutil.copy(psh[0], tmp_path / "evil.nc")
    with netCDF4.Dataset(file, "a") as opened:
        opened.delncattr(SUMS)  # as who means it would
        opened.setncattr("title", evil)
        opened.setncattr("scene", evil)
        opened.setncattr("scene_text", f"# {evil}\n[{evil}]")
        opened.setncattr("changes", json.dumps({evil: evil}))
        opened.setncattr("warnings", json.dumps([evil]))
        opened.setncattr("status", f"stopped {evil}")
        opened.variables["rotor"][0] = evil
        scene = json.loads(opened.getncattr("scene_json"))
        opened.setncattr("scene_json", json.dumps(scene | {"effects": scene["effects"] | {evil: evil}}))
    code, _, err = run("report", file)
    assert code == 0, err
    page = Page(file.with_suffix(".html").read_text("utf-8"))
    assert page.faults == []
    assert page.find("img") == []
    assert not any(key.startswith("on") for _, attrs, _ in page.elements for key in attrs)
    assert page.text.count(evil) >= 6


def test_a_run_that_stopped_early_says_so(run, psh, tmp_path):
    file = shutil.copy(psh[0], tmp_path / "early.nc")
    with netCDF4.Dataset(file, "a") as opened:
        opened.delncattr(SUMS)
        opened.setncattr("status", "the solver failed at 0.03 s")
        opened.variables["mesh_force"][300:, :] = float("nan")
    assert run("report", file)[0] == 0
    words = Page(file.with_suffix(".html").read_text("utf-8")).text
    assert "did not reach its end: the solver failed at 0.03 s" in " ".join(words.split())
    assert "are not numbers and are left out" in words


def test_a_model_without_a_scene_has_a_page_too(run, tmp_path):
    """Built in Python: no text, no sources, no modes, and each is said."""
    model = build_model(load_scene("psh"))
    result = simulate(build(obtain(model)), model.values(), t_end=0.02, rate=8192.0)
    result.save(tmp_path / "bare.nc")
    assert run("report", tmp_path / "bare.nc")[0] == 0
    words = Page((tmp_path / "bare.html").read_text("utf-8")).text
    assert "Not shown: the file holds no scene" in words
    assert "built in Python" in words


def test_changing_speeds_are_seen_over_turns(tmp_path):
    text = make_page(simulate_into(tmp_path, "start-up", 1.0), modes=False)
    page = Page(text)
    assert "spectra are taken over turns of a shaft" in page.text
    assert "order: cycles in a turn of" in page.text
    sections = [attrs["id"] for attrs in page.find("section")]
    assert sections == [*SECTIONS[:1], "course", *[name for name in SECTIONS[1:] if name != "share"]]
    drawn = [attrs["aria-label"] for attrs in page.find("svg") if "aria-label" in attrs]
    assert [sum(label.startswith(title) for label in drawn) for title in ("Speeds of rotors", "Torques")] == [1, 1]
    # The start-up loads the flank behind; the other one is idle but for the first contact.
    spectra = [label for label in drawn if label.startswith("Amplitude spectrum: normal mesh force")]
    assert [label.partition(" of ")[2].partition(".  ")[0].split(". ")[0] for label in spectra] == ["pair.mesh.back"]
    assert "The force of pair.mesh.back, the busiest mesh" in page.text


def test_steady_runs_have_no_course(psh):
    assert "Speeds of rotors" not in psh[1]


def test_a_train_at_rest_is_told_to_be_at_rest(tmp_path):
    """No force, no factor, no line; members stand."""
    page = Page(make_page(simulate_into(tmp_path, "lin-parker-3", 0.05), modes=False))
    words = " ".join(page.text.split())
    assert "Without force throughout: gear.sun_planet, gear.ring_planet." in words
    assert "At rest: gear.carrier, gear.ring, gear.sun" in words
    assert "the normal mesh force of gear.sun_planet.1 does not vary" in words
    assert "mode 1" not in words
    assert re.findall(r"gear\.sun_planet\.1(?: ?0){4} ?-", words)


@pytest.mark.parametrize("t_end", [0.06, 0.0007])
def test_trains_that_stand_and_short_records_have_pages(tmp_path, t_end):
    """Before the start nothing turns; of a few samples there is no spectrum, and the page says so."""
    page = Page(make_page(simulate_into(tmp_path, "start-up", t_end), modes=False))
    assert page.faults == []
    assert ("64 at least" in page.text) == (t_end < 0.001)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["-o", "page.pdf"], ["page.pdf", "HTML", "page.html"]),
        (["-o", "nowhere/page.html"], ["nowhere", "does not exist", "make it first"]),
        (["--at", "9"], ["--at 9", "runs from 0 s to 0.05"]),
        (["--at", "nan"], ["--at nan", "give an instant"]),
    ],
)
def test_bad_options_are_refused(refused, psh, options, words, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    err = refused("report", psh[0], *options)
    assert len(err.splitlines()) == 1
    assert all(word in err for word in words), err
    assert list(tmp_path.iterdir()) == []


def test_what_is_no_result_is_refused_with_the_reason(refused, psh, tmp_path):
    """Missing, damaged, truncated, foreign, and of another form."""
    whole = psh[0].read_bytes()
    cases = {
        "missing": None,
        "damaged": b"CDF\x01" + whole[:400],
        "cut": whole[: len(whole) // 2],
        "text": b"time,force\n",
    }
    for name, content in cases.items():
        file = tmp_path / f"{name}.nc"
        if content is not None:
            file.write_bytes(content)
        err = refused("report", file)
        assert str(file) in err
        assert "no such result" in err if content is None else "not a readable NetCDF4" in err
    foreign, older = tmp_path / "foreign.nc", shutil.copy(psh[0], tmp_path / "older.nc")
    with netCDF4.Dataset(foreign, "w") as opened:
        opened.createDimension("time", 3)
    with netCDF4.Dataset(older, "a") as opened:
        opened.setncattr("result_format", 0)
    assert "not a result of ltcgear" in refused("report", foreign)
    assert "older" in refused("report", older)
    assert not list(tmp_path.glob("*.html"))
    assert not list(tmp_path.glob(".draft*"))


def test_an_older_page_outlives_a_refusal(refused, psh, tmp_path):
    page = tmp_path / "page.html"
    page.write_text("kept", "utf-8")
    refused("report", psh[0], "-o", page, "--at", "99")
    assert page.read_text("utf-8") == "kept"


def test_without_jinja2_the_command_says_what_to_install(refused, psh, monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, "jinja2", None)
    monkeypatch.setattr("ltcgear.runtime.results.result.load", None)  # said before anything is read
    err = refused("report", psh[0], "-o", tmp_path / "page.html")
    assert "pip install 'ltcgear[report]'" in err
    assert len(err.splitlines()) == 1


@pytest.mark.parametrize(("scene", "mesh"), [("start-up", "pair.mesh.back"), ("psh", "psh.mesh")])
def test_the_mesh_that_is_shown_first_carries(tmp_path, scene, mesh):
    text = make_page(simulate_into(tmp_path, scene, 0.05), modes=False)
    assert f'"chosen":"{mesh}"' in text.replace(" ", "")
