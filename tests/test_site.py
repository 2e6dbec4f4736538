"""The site's sources: what `make site` builds is whole, without building it."""

import ast
import re
import shlex
from math import pi

import ltcgear
import pytest
from ltcgear import runtime, symbolic
from ltcgear.runtime import analysis
from ltcgear.runtime.cli.app import app
from ltcgear.symbolic import load_scene
from ltcgear.symbolic.gears import gear_geometry
from typer.main import get_command

from regenerate import ROOT

DOCS = ROOT / "docs"
PAGES = sorted([*DOCS.glob("*.md"), *DOCS.glob("decisions/*.md"), ROOT / "README.md", ROOT / "CHANGELOG.md"])
SCRIPTS = sorted(DOCS.glob("gallery/*.py"))
COMMANDS = sorted(get_command(app).commands)
GUIDE = DOCS / "from-drawing.md"


def named(path):
    return str(path.relative_to(ROOT))


def blocks(page, language):
    """Return the fenced blocks of a language."""
    return re.findall(rf"^```{language}\n(.*?)^```$", page.read_text("utf-8"), re.DOTALL | re.MULTILINE)


# --- pages


def listed(page):
    """Return the pages in a page's toctrees."""
    found = set()
    for text in blocks(page, re.escape("{toctree}")):
        entries = [line for line in text.splitlines() if line and not line.startswith(":")]
        for entry in entries:
            found |= set(page.parent.glob(f"{entry}.md")) if ":glob:" in text else {page.parent / f"{entry}.md"}
    return found


def test_every_page_is_in_a_toctree():
    start = DOCS / "index.md"
    found = listed(start)
    assert DOCS / "decisions/index.md" in found
    wanted = {*DOCS.glob("*.md"), *DOCS.glob("decisions/*.md")} - {start}
    assert found | listed(DOCS / "decisions/index.md") == wanted | {DOCS / "examples/index.md"}


def anchors(page):
    """Return what a forge makes of a page's headings."""
    heads = re.findall(r"^#+ (.*)$", re.sub(r"^```.*?^```$", "", page.read_text("utf-8"), flags=re.M | re.S), re.M)
    return {re.sub(r"[^\w\- ]", "", head.lower()).replace(" ", "-") for head in heads}


@pytest.mark.parametrize("page", PAGES, ids=named)
def test_links_lead_somewhere(page):
    text = re.sub(r"```.*?```|`[^`\n]*`", "", page.read_text("utf-8"), flags=re.DOTALL)
    for target in re.findall(r"\]\(([^)\s]+)\)", text):
        if target.startswith(("https:", "mailto:")):
            continue
        name, _, anchor = target.partition("#")
        file = (page.parent / name).resolve() if name else page
        assert file.exists(), target
        assert not anchor or anchor in anchors(file), target


# --- commands


@pytest.mark.parametrize("command", COMMANDS)
def test_every_option_is_in_the_reference(command, run):
    """What --help prints stands in the command's section of the page."""
    code, out, _ = run(command, "--help")
    sections = (DOCS / "commands.md").read_text("utf-8").split("\n## ")
    section = next(text for text in sections if text.startswith(f"{command}\n"))
    options = set(re.findall(r"^ +(?:-\w, )?(--[a-z-]+)", out, re.MULTILINE)) - {"--help"}
    assert code == 0
    assert "--json" in options
    for option in options:
        assert re.search(rf"`{option}( [^`]+)?`", section), option


# --- Python


@pytest.mark.parametrize("part", [ltcgear, symbolic, runtime, analysis], ids=lambda part: part.__name__)
def test_every_public_name_is_documented(part):
    page = (DOCS / "python.md").read_text("utf-8")
    current, found = "", set()
    for directive, name in re.findall(
        r"^\.\. (currentmodule|autofunction|autoclass):: ([\w.]+)(?:\(.*\))?$", page, re.MULTILINE
    ):
        current = name if directive == "currentmodule" else current
        found |= {name} if directive != "currentmodule" and current == part.__name__ and "." not in name else set()
    assert found == set(part.__all__)


# --- examples


@pytest.mark.parametrize("script", SCRIPTS, ids=named)
def test_examples_compile_and_have_a_title(script):
    tree = ast.parse(script.read_text("utf-8"))
    title, rule, empty, *text = (ast.get_docstring(tree) or "").splitlines()
    assert script.name.startswith("plot_")
    assert title
    assert set(rule) == {"="}
    assert len(rule) >= len(title)
    assert empty == ""
    assert "".join(text)


def test_the_guide_shows_the_scene_of_the_gallery():
    assert blocks(GUIDE, "toml") == [(DOCS / "gallery/winch.toml").read_text("utf-8")]


def told_mistakes():
    """Return command lines and what they print, from the guide."""
    texts = blocks(GUIDE, "console")
    assert len(texts) >= 8
    lines = [text.removeprefix("$ ltcgear ").split("\n", 1) for text in texts]
    return [pytest.param(shlex.split(command), said, id=command[26:60]) for command, said in lines]


@pytest.mark.parametrize(("command", "said"), told_mistakes())
def test_the_guide_tells_what_ltcgear_says(command, said, run, monkeypatch):
    monkeypatch.chdir(DOCS / "gallery")
    code, _, err = run(*command)
    assert err == said
    assert code == (0 if "warning" in said else 2)


def test_numbers_of_the_guide_follow_from_the_drawing(data, monkeypatch):
    """What the guide reckons by hand stands in its scene, and `info` tells what the guide says it does."""
    monkeypatch.chdir(DOCS / "gallery")
    text, scene = GUIDE.read_text("utf-8"), load_scene("winch.toml")

    def in_plane(a, b):
        return 1 / ((b / (a + b)) ** 2 / 4e8 + (a / (a + b)) ** 2 / 4e8)

    def shaft(diameter, length):
        return 8e10 * pi * diameter**4 / (32 * length)

    stage = scene.stages["gear"]
    assert stage.carrier.bearing.stiffness == pytest.approx(in_plane(0.06, 0.14), rel=5e-3)
    assert in_plane(-0.06, 0.14) == pytest.approx(1.1e8, rel=1e-2)
    assert "1.1e8" in text
    assert scene.couplings["motor_shaft"].stiffness == pytest.approx(shaft(0.045, 0.3), rel=5e-3)
    assert scene.couplings["drum_shaft"].stiffness == pytest.approx(shaft(0.08, 0.25), rel=5e-3)
    assert stage.sun_planet.stiffness == pytest.approx(14e9 * 0.05)
    for ratio in (1.3, 1.475, 1.856):
        assert 2 - ratio + stage.sun_planet.double_factor * (ratio - 1) == pytest.approx(0.75 * ratio + 0.25)
    shown = data("info", "winch.toml")
    assert shown["static_mesh_forces_n"]["gear.sun_planet"] == pytest.approx(300 / (3 * 33.83e-3), rel=1e-3)
    assert f"{shown['static_mesh_forces_n']['gear.sun_planet']:.0f} N" in text
    assert gear_geometry.stage_distance(stage) == pytest.approx(96e-3, abs=1e-6)
    assert shown["speed_ratios"]["drum"] == pytest.approx(1 / (1 + 78 / 18))
