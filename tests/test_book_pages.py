"""The equation book as files: HTML that needs nothing beside it, LaTeX, and the command that writes them."""

import builtins
import re
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest
from ltcgear.symbolic.book import pages, volume
from ltcgear.symbolic.book.content import Book, Chapter
from ltcgear.symbolic.book.notation import escape
from ltcgear.symbolic.checks import all_checks as checks_run
from ltcgear.symbolic.checks.check import Check
from matplotlib.mathtext import MathTextParser

SLY = """Gear <b>&amp;</b> "x" {% raw %} {{ y }} $\\alpha_5^2$ 100 % #1 ~ <% z %>"""
LARGEST = 3_000_000


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """Books of a small scene, with a title made to break things, and of the rig; both kinds of file."""
    from ltcgear.runtime.cli.opening import open_scene

    folder = tmp_path_factory.mktemp("books")
    for name in ("psh", "rig-2mw"):
        opened = open_scene(name)
        scene = opened.scene.model_copy(update={"title": SLY}) if name == "psh" else opened.scene
        checks = [Check("nothing <i>moves</i>", True, 0.0, 1e-9, "by & by")]
        made = volume.make_book(scene, opened.model, opened.artifact.manifest, opened.key, checks)
        for suffix in (".html", ".tex"):
            volume.write_book(made, folder / f"{name}{suffix}")
    return folder


def page(files, name="psh"):
    """The page as a tree; it is well-formed XML too."""
    return ET.fromstring((files / f"{name}.html").read_text("utf-8").replace("<!doctype html>", "", 1))


def text(element):
    """All text of an element."""
    return "".join(element.itertext())


@pytest.mark.parametrize("name", ["psh", "rig-2mw"])
def test_a_page_needs_nothing_beside_it(files, name):
    source = (files / f"{name}.html").read_text("utf-8")
    assert len(source) < LARGEST
    root = page(files, name)
    assert not {element.tag for element in root.iter()} & {"script", "link", "img", "iframe", "object"}
    attributes = [(key, value) for element in root.iter() for key, value in element.attrib.items()]
    assert not [key for key, _ in attributes if key in ("src", "srcset", "style") or key.startswith("on")]
    assert "url(" not in source
    assert "//" not in re.sub(r"\s", "", source.split("<style>")[1].split("</style>")[0])
    assert all(value.startswith("#") for key, value in attributes if key == "href")


@pytest.mark.parametrize("name", ["psh", "rig-2mw"])
def test_every_link_has_its_place_and_every_equation_its_number(files, name):
    root = page(files, name)
    anchors = [element.attrib["id"] for element in root.iter() if "id" in element.attrib]
    assert len(set(anchors)) == len(anchors)
    links = {element.attrib["href"][1:] for element in root.iter("a")}
    assert links <= set(anchors)
    equations = [element for element in root.iter("div") if element.attrib.get("class") == "eq"]
    assert len(equations) > 90
    for equation in equations:
        number = text(equation.find("a"))
        assert equation.attrib["id"] == "eq-" + number.strip("()").replace(".", "-")
        assert equation.find("div").findall("math")


def test_nine_chapters_are_listed(files):
    root = page(files)
    heads = [text(element) for element in root.iter("h2")]
    listed = [text(item.find("a")) for item in root.find("body/nav/ol")]
    assert [f"{n}. {title}" for n, title in enumerate(listed, start=1)] == heads
    assert len(heads) == 9


def test_a_page_has_light_and_dark_and_prints_on_a4(files):
    style = text(page(files).find("head/style"))
    assert "prefers-color-scheme: dark" in style
    assert "size: A4" in style
    used, defined = set(re.findall(r"var\((--\w+)\)", style)), re.findall(r"(--\w+):", style)
    assert used <= set(defined)
    assert all(defined.count(name) >= 2 for name in used)


def test_titles_are_shown_as_text(files):
    root = page(files)
    assert text(root.find("body/header/h1")) == SLY
    assert text(root.find("head/title")) == f"{SLY}: equation book"
    assert "nothing <i>moves</i>" in text(root.find("body/main"))
    source = (files / "psh.tex").read_text("utf-8")
    assert escape(SLY) in source
    assert SLY not in source


def test_formulas_are_mathematics(files):
    root = page(files, "rig-2mw")
    assert len(list(root.iter("math"))) > 500
    assert not [element for element in root.iter("mtext") if "\\" in text(element)]
    assert not [element for element in root.iter("mi") if "\\" in text(element)]
    dotted = [text(element) for element in root.iter("mover")]
    assert "x¨" in dotted
    assert "θ˙" in dotted


def test_names_in_formulas_are_shown_as_they_are():
    assert "<mtext>lsp.sun_planet.1</mtext>" in pages.mathml(r"x_{\text{lsp.sun\_planet.1}}")
    assert "<mtext>a &lt; b &amp; c</mtext>" in pages.mathml(rf"\text{{{escape('a < b & c')}}}").replace("\u00a0", " ")


def balanced(source):
    """Whether braces and environments of a LaTeX text close in their order."""
    plain = re.sub(r"\\.", lambda found: found[0] if found[0] in (r"\b", r"\e") else "", source)
    depth = 0
    for character in plain:
        depth += {"{": 1, "}": -1}.get(character, 0)
        if depth < 0:
            return False
    stack = []
    for kind, name in re.findall(r"\\(begin|end)\{(\w+)\*?\}", source):
        if kind == "begin":
            stack.append(name)
        elif not stack or stack.pop() != name:
            return False
    return depth == 0 and not stack


@pytest.mark.parametrize("name", ["psh", "rig-2mw"])
def test_latex_is_balanced(files, name):
    source = (files / f"{name}.tex").read_text("utf-8")
    assert balanced(source)
    assert not balanced(source.replace("}", "", 1))
    assert not balanced(source.replace(r"\end{equation}", "", 1))
    assert source.count(r"\begin{equation}") == source.count(r"\tag{")
    for _, table in re.findall(r"(\\begin\{longtable\}\{\*\{(?:\d+)\}.*?\n)(.*?)\\end\{longtable\}", source, re.DOTALL):
        rows = [line for line in table.splitlines() if line.endswith(r"\\") and "multicolumn" not in line]
        assert len({len(re.findall(r"(?<!\\)&", row)) for row in rows}) == 1


def test_formulas_are_read_by_a_second_program(files):
    source = (files / "rig-2mw.tex").read_text("utf-8")
    lines = [
        line.removeprefix("&").removeprefix(r"\quad ").removesuffix(r" \\")
        for block in re.findall(r"\\begin\{aligned\}\n(.*?)\n\\end\{aligned\}", source, re.DOTALL)
        for line in block.splitlines()
    ]
    parser = MathTextParser("path")
    known = [line for line in lines if "cases" not in line]
    assert len(known) > 130
    for line in known:
        parser.parse(f"${line}$")


# --- the command


def test_the_command_tells_what_a_book_holds(data, tmp_path):
    path = tmp_path / "psh.html"
    told = data("book", "psh", "-o", path)
    assert told["scene"] == "psh"
    assert told["bytes"] == path.stat().st_size
    assert told["checks"]["failed"] == 0
    assert told["checks"]["passed"] > 10
    assert told["paper"] == {"agrees": 29, "first-order": 10, "misprint": 20}
    assert told["equations"] == sum(chapter["equations"] for chapter in told["chapters"])
    assert told["key"] in path.read_text("utf-8")
    assert [file.name for file in tmp_path.iterdir()] == ["psh.html"]


def test_people_are_told_too(run, tmp_path):
    code, out, _ = run("book", "psh", "-o", tmp_path / "psh.tex")
    assert code == 0
    assert "Equations of motion" in out
    assert (tmp_path / "psh.tex").read_text("utf-8").startswith("% Equation book")


def test_a_failed_check_is_an_exit_code_and_is_shown(run, tmp_path, monkeypatch):
    failed = Check("energy", False, 2.0, 1.0, "made up")
    monkeypatch.setattr(checks_run, "check_model", lambda model: (failed,))
    code, out, _ = run("book", "psh", "-o", tmp_path / "psh.html")
    assert code == 1
    assert "1 failed" in out
    marks = [text(e) for e in page(tmp_path).iter("span") if e.attrib.get("class") == "mark bad"]
    assert "failed" in marks


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("book", "psh", "-o", "psh.pdf"), "written as .html or .tex"),
        (("book", "psh", "-o", "psh"), "written as .html or .tex"),
        (("book", "pssh", "-o", "psh.html"), 'did you mean "psh"?'),
        (("book", "psh", "-o", "no/such/psh.html"), "make it first"),
        (("book", "psh", "-o", "psh.html", "--set", "effects.gravity=maybe"), "effects.gravity"),
    ],
)
def test_bad_input_is_refused(refused, tmp_path, monkeypatch, arguments, message):
    monkeypatch.chdir(tmp_path)
    assert message in refused(*arguments)
    assert not list(tmp_path.iterdir())


def test_a_missing_package_is_named(refused, tmp_path, monkeypatch):
    true_import = builtins.__import__

    def without(name, *arguments, **options):
        if name.split(".")[0] == "latex2mathml":
            raise ImportError(name)
        return true_import(name, *arguments, **options)

    monkeypatch.setattr(builtins, "__import__", without)
    assert "pip install 'ltcgear[report]'" in refused("book", "psh", "-o", tmp_path / "psh.html")


def test_a_broken_disk_leaves_no_draft(tmp_path, monkeypatch):
    def full(self, *arguments, **options):
        self.touch()
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "write_text", full)
    empty = Book("t", "s", {}, (Chapter(1, "One", "one"),), {"key": "k", "ltcgear": "0"}, {}, {})
    with pytest.raises(pages.LtcgearError, match="the disk is full"):
        volume.write_book(empty, tmp_path / "x.html")
    assert not list(tmp_path.iterdir())
