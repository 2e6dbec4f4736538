"""Lettering of figures: names and titles that hold signs of mathematics, and backends that are not there."""

import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest
from ltcgear.runtime.view.plots import make_canvas, save_figure
from ltcgear.runtime.view.report.theme import themed, write_svg

SIGNS = "$x^{$ \\frac{ 5 $ and 6 $ _^"
ACTS = "bell\x07 and \x1b[31m"


def lettered():
    """A figure with such names everywhere, and a logarithmic axis."""
    figure = make_canvas(6.0, 4.0)
    above, below = figure.subplots(2)
    above.semilogy([1.0, 2.0], [1e-3, 1e3], label=SIGNS)
    above.set_title(f"{SIGNS} {ACTS}", loc="left")
    above.set_xlabel(SIGNS)
    above.annotate(SIGNS, (1.0, 1.0))
    above.legend()
    below.barh([0, 1], [1.0, 2.0])
    below.set_yticks([0, 1], [SIGNS, "a $\nb"])
    figure.suptitle(SIGNS)
    figure.legend()
    return figure


@pytest.mark.parametrize("suffix", ["png", "pdf", "svg"])
def test_signs_of_mathematics_are_letters(tmp_path, suffix):
    path = save_figure(lettered(), tmp_path / f"a.{suffix}")
    if suffix == "svg":
        said = [text for element in ElementTree.parse(path).iter() for text in [element.text or ""]]
        assert said.count(SIGNS) >= 5
        assert rf"{SIGNS} bell\x07 and \x1b[31m" in said
        assert not [text for text in said if "mathdefault" in text]  # powers of ten are set as such


def test_signs_of_mathematics_are_letters_on_a_page():
    with themed():
        svg = write_svg(lettered(), "a", "a figure")
    ElementTree.fromstring(svg)
    assert SIGNS in svg


def test_latex_is_not_called(tmp_path, monkeypatch):
    import matplotlib as mpl

    monkeypatch.setenv("PATH", str(tmp_path))
    with mpl.rc_context({"text.usetex": True}):
        assert save_figure(lettered(), tmp_path / "a.svg").is_file()


def test_a_scene_may_have_such_a_name(tmp_path, run):
    shipped = Path(__file__).parents[3] / "symbolic" / "scenes" / "psh.toml"
    scene = tmp_path / "$x^{$.toml"
    scene.write_text(shipped.read_text("utf-8").replace('title = "', 'title = "$x^{$ ', 1))
    for command in (
        ("campbell", scene, "--speed", "300:900:2", "--harmonics", "1", "-o", tmp_path / "a.png"),
        ("stability", scene, "-o", tmp_path / "b.svg"),
        ("modes", scene, "-o", tmp_path / "c.png"),
    ):
        code, _, err = run(*command)
        assert (code, "Traceback" in err) == (0, False), err
        assert Path(command[-1]).is_file()


def test_own_letters_are_set_as_they_are_meant(tmp_path, run):
    path = tmp_path / "a.svg"
    assert run("stability", "psh", "-o", path)[0] == 0
    said = [element.text or "" for element in ElementTree.parse(path).iter()]
    assert "real part of µ" in said
    assert not [text for text in said if "$" in text]


@pytest.mark.parametrize("backend", ["module://nowhere.backend_inline", "nonsense"])
def test_a_backend_of_the_surroundings_is_not_needed(backend):
    code = (
        f"import os; os.environ['MPLBACKEND'] = {backend!r}\n"
        "from ltcgear.runtime.cli import commands\n"
        "from ltcgear.runtime.view.plots import make_canvas\nmake_canvas(1.0, 1.0)"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
