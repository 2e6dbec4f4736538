"""README.md and pages of docs/: what they show runs as it stands, in the order in which a reader meets it."""

import importlib.util
import re
import sys

import pytest
from ltcgear.symbolic import build_model, load_scene

from regenerate import ROOT


def _load():
    """Load what the big run reads pages by, which stands apart from the tests."""
    spec = importlib.util.spec_from_file_location("torture_pages", ROOT / "tests/torture/pages.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


PAGES = _load()
COSTLY = {
    "ltcgear simulate rig-2mw --t-end 2 --verify -o rig.nc": "three runs; the page of analysis has one",
    "ltcgear report rig.nc -o rig.html": "needs that run",
    "ltcgear report rig.nc -o rig.html --at 0.05": "likewise",
    "ltcgear stability lsp --speed 100:700:60 --variation 0:3:40 -o chart.png": "2400 points",
}  # fmt: skip
"""Commands that only `make torture` runs, and why."""
LEFT = {
    "docs/tour.md": "all commands at once; tests have each of them, smaller",
    "docs/fmu.md": "compiles FMUs; tests/runtime/export/test_fmu.py does so with others",
    "docs/analysis.md": "the rig, analysed; tests/runtime/analysis/test_analyse.py analyses stages",
    "docs/book.md": "books; tests/test_book_pages.py reads one",
    "docs/resonance.md": "the rig's diagrams; tests/runtime/cli/test_resonance_commands.py draws stages'",
}
"""Pages that only `make torture` runs, since each takes a minute here, and why that is enough."""
SHOWN = [page for page in PAGES.pages() if PAGES.read_steps(page)]


def is_left(step):
    """Whether a step is not run here."""
    return step.page in LEFT or step.head in PAGES.NOT_RUN or step.head in COSTLY


@pytest.mark.parametrize("page", [page for page in SHOWN if page not in LEFT])
def test_a_page_runs_as_it_stands(page, tmp_path):
    for step in PAGES.read_steps(page):
        if not is_left(step):
            assert PAGES.run_step(step, tmp_path, 300) == "", step.head


def test_what_is_left_out_stands_on_a_page():
    heads = {step.head for page in SHOWN for step in PAGES.read_steps(page)}
    assert {*COSTLY, *PAGES.NOT_RUN} <= heads
    assert set(LEFT) <= set(SHOWN)


@pytest.mark.parametrize("page", PAGES.pages())
def test_no_command_of_a_block_is_overlooked(page):
    """Whatever looks like a command in a fence, in whatever language, is a step."""
    text = (ROOT / page).read_text("utf-8").replace("\\\n", " ")
    lines = [
        line.strip() for block in re.findall(r"^ *```.*?^ *```", text, re.DOTALL | re.MULTILINE)
        for line in block.splitlines()
    ]  # fmt: skip
    typed = [
        line.removeprefix("$ ")
        for line in lines
        if re.match(r"(\$ )?((ltcgear|make|cc|python3?|pip|dask) |\./\w)", line)
    ]
    known = [step.text.strip() for step in PAGES.read_steps(page)]
    assert [line for line in typed if line not in known] == []


def scenes():
    """Return the scenes of all pages."""
    found = [(page, step) for page in SHOWN for step in PAGES.read_steps(page) if step.kind == PAGES.SCENE]
    assert len(found) >= 4
    return [pytest.param(step.text.partition("\n")[2], id=f"{page} {step.number}") for page, step in found]


@pytest.mark.parametrize("text", scenes())
def test_scenes_load(text, tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text(text, encoding="utf-8")
    assert build_model(load_scene(path)).instances


def test_the_scene_of_the_readme_simulates(tmp_path):
    (scene,) = [step for step in PAGES.read_steps("README.md") if step.kind == PAGES.SCENE]
    assert scene.text.startswith("hoist.toml\n")
    assert PAGES.run_step(scene, tmp_path) == ""
    for number, line in enumerate(("ltcgear info hoist.toml", "ltcgear simulate hoist.toml --t-end 0.02")):
        assert PAGES.run_step(PAGES.Step("README.md", number, PAGES.SHELL, line, None), tmp_path) == ""


def test_a_command_that_fails_or_says_something_else_is_seen(tmp_path):
    for kind, text, said in (
        ("sh", "ltcgear info nothing", None), ("python", "import ltcgear.nothing", None),
        ("console", "ltcgear --version", "no\n"),
    ):  # fmt: skip
        assert PAGES.run_step(PAGES.Step("a page", 1, kind, text, said), tmp_path)
