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
    "docs/modes.md",
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


def commands():
    """Return the ltcgear lines of README's shell blocks."""
    lines = [line for block in blocks("README.md", "sh") for line in block.values[0].splitlines()]
    return [shlex.split(line, comments=True) for line in lines if line.startswith("ltcgear ")]


@pytest.mark.parametrize("text", every("toml"))
def test_scenes_load(text, tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text(text, encoding="utf-8")
    assert build_model(load_scene(path)).instances


@pytest.mark.parametrize("text", every("python"))
def test_python_runs(text, tmp_path):
    done = subprocess.run(
        [sys.executable, "-c", text], cwd=tmp_path, capture_output=True, text=True, check=False, timeout=60
    )
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("command", [pytest.param(command, id=" ".join(command)) for command in commands()])
def test_commands_run(command, tmp_path):
    program = Path(sys.executable).with_name("ltcgear")
    done = subprocess.run(
        [program, *command[1:]], cwd=tmp_path, capture_output=True, text=True, check=False, timeout=60
    )
    assert done.returncode == 0, done.stderr


def test_the_scene_of_the_readme_simulates(tmp_path):
    (tmp_path / "hoist.toml").write_text(blocks("README.md", "toml")[0].values[0], encoding="utf-8")
    program = Path(sys.executable).with_name("ltcgear")
    for command in (["info"], ["simulate", "--t-end", "0.02"]):
        done = subprocess.run(
            [program, command[0], "hoist.toml", *command[1:]],
            cwd=tmp_path, capture_output=True, text=True, check=False, timeout=60,
        )  # fmt: skip
        assert (done.returncode, done.stderr) == (0, "")
