"""README.md and pages of docs/: what they show runs as it stands."""

import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
from ltcgear.symbolic import build_model, load_scene

ROOT = Path(__file__).parents[1]
PAGES = (
    "README.md", "docs/getting-started.md", "docs/from-drawing.md", "docs/scenes.md", "docs/ensembles.md",
    "docs/modes.md", "docs/analysis.md",
)  # fmt: skip


def blocks(page, language):
    """Return the fenced blocks of a language, each as a parameter named by page and number."""
    found = re.findall(rf"^```{language}\n(.*?)^```$", (ROOT / page).read_text("utf-8"), re.DOTALL | re.MULTILINE)
    return [pytest.param(text, id=f"{page} {number}") for number, text in enumerate(found, start=1)]


def every(language):
    """Return the blocks of a language on all pages."""
    found = [block for page in PAGES for block in blocks(page, language)]
    assert found
    return found


def commands(page):
    """Return the ltcgear lines of a page's shell blocks."""
    lines = [line for block in blocks(page, "sh") for line in block.values[0].splitlines()]
    return [shlex.split(line, comments=True) for line in lines if line.startswith("ltcgear ")]


def started(command, folder):
    """Start a command line in a folder; it must succeed."""
    program = Path(sys.executable).with_name("ltcgear")
    done = subprocess.run([program, *command[1:]], cwd=folder, capture_output=True, text=True, check=False, timeout=180)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("text", every("toml"))
def test_scenes_load(text, tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text(text, encoding="utf-8")
    assert build_model(load_scene(path)).instances


@pytest.mark.parametrize("text", every("python"))
def test_python_runs(text, tmp_path):
    done = subprocess.run(
        [sys.executable, "-c", text], cwd=tmp_path, capture_output=True, text=True, check=False, timeout=180
    )
    assert done.returncode == 0, done.stderr


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Where README's commands are typed, one after the other."""
    return tmp_path_factory.mktemp("readme")


@pytest.mark.parametrize("command", [pytest.param(one, id=" ".join(one)) for one in commands("README.md")])
def test_commands_run(command, folder):
    started(command, folder)


def test_the_page_of_results_runs(tmp_path):
    page = "docs/results.md"
    started(["ltcgear", "simulate", "lsp", "-o", "lsp.nc"], tmp_path)
    for command in commands(page):
        started(command, tmp_path)
    for block in blocks(page, "python"):
        test_python_runs(block.values[0], tmp_path)
    assert (tmp_path / "lsp.csv").stat().st_size > 1e4


def test_the_scene_of_the_readme_simulates(tmp_path):
    (tmp_path / "hoist.toml").write_text(blocks("README.md", "toml")[0].values[0], encoding="utf-8")
    program = Path(sys.executable).with_name("ltcgear")
    for command in (["info"], ["simulate", "--t-end", "0.02"]):
        done = subprocess.run(
            [program, command[0], "hoist.toml", *command[1:]],
            cwd=tmp_path, capture_output=True, text=True, check=False, timeout=180,
        )  # fmt: skip
        assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.parametrize(
    ("page", "scene"), [("docs/getting-started.md", "fan.toml"), ("docs/from-drawing.md", "winch.toml")]
)
def test_the_commands_of_a_guide_run(page, scene, tmp_path):
    (tmp_path / scene).write_text(blocks(page, "toml")[0].values[0], encoding="utf-8")
    for command in commands(page):
        started(command, tmp_path)
    assert list(tmp_path.glob("*.nc"))


def test_the_page_of_analysis_runs(tmp_path):
    for command in commands("docs/analysis.md"):
        started(command, tmp_path)
    assert (tmp_path / "figures" / "orbits.svg").is_file()
