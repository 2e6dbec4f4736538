"""TOML of scenes: texts beyond all bounds are refused quickly, with the line."""

import resource
import time
import tomllib

import pytest
from ltcgear.generated.errors import SceneError
from ltcgear.symbolic.scene.load import LARGEST_FILE, load_scene, read_source, shipped_scenes
from ltcgear.symbolic.scene.toml import MOST_PARTS, find_excess, parse_toml

LIMIT = 20.0  # [s], generous: without bounds these texts take minutes and gigabytes


def refused(source, changes=None):
    with pytest.raises(SceneError) as caught:
        load_scene(source, changes)
    return str(caught.value)


ROWS = ", ".join(f'["{i} s", "{i % 7}.5 N*m"]' for i in range(10_000))
EXCESSES = {
    "one dotted key": ("a = 1\n" + "a." * 80_000 + "a = 1", "line 2: nested too deeply"),
    "dotted keys": ("\n".join("a." * 400 + f"k{i} = 1" for i in range(190)), "line 1: nested too deeply"),
    "spaced dots": ("title = 'x'\n\n" + "a . 'b'.\t" * 99 + "a = 1", "line 3: nested too deeply"),
    "a table's header": ("[" + "a." * 99 + "a]", "line 1: nested too deeply"),
    "lists": ("a = " + "[" * 99, "line 1: nested too deeply"),
    "lists over lines": ("a = [\n" + "[ # ]]]]]]\n" * 99, f"line {MOST_PARTS + 1}: nested too deeply"),
    "inline tables": ("a = " + "{a = " * 99, "line 1: nested too deeply"),
    "a key": ("\n" + "a" * 9999 + " = 1", "line 2: a key or number has more than 200 characters"),
    "a number": ('b = """\n\n"""\na = ' + "1" * 9999, "line 4: a key or number has more than 200 characters"),
}
LAWFUL = {
    "a comment": "# " + "a." * 9999 + "[" * 9999 + '"\'"""\na = 1',
    "a long text": 'a = "' + "x.[{" * 9999 + '"',
    "a text with quotes": r"""a = "\"[[[[[[[[[[[[[[[[" """ + "\nb = '[[[[[[[[[[[[[[[[[[[[\\'",
    "texts of three quotes": 'a = """[[[[[[["" \\""" [[[[[[[ a.b.c.d.e.f.g.h.i.j.k"""""\nb = '
    + "'''[[[[[[[[[\n[[[['''''",
    "a quoted key": '"' + "a." * 99 + '" = 1',
    "numbers and dates": "a = [" + "1.5e-3, 1979-05-27T07:32:00.999Z, " * 999 + "]",
    "lists that close": "a = [" + "[[[[1]]]], " * 9999 + "]",
    "a table over time": f"[loads.a]\ntorque_over_time = {{ value = [{ROWS}], source = 'assumed: x' }}",
}


@pytest.mark.parametrize("name", EXCESSES)
def test_a_text_beyond_all_bounds_is_refused_with_its_line_and_quickly(name, tmp_path):
    text, where = EXCESSES[name]
    path = tmp_path / "deep.toml"
    path.write_text(text, encoding="utf-8")
    clock, before = time.perf_counter(), resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    told = refused(path)
    assert f"deep.toml: {where}" in told
    assert ";" in told
    assert time.perf_counter() - clock < LIMIT
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 1e6  # [kB]


@pytest.mark.parametrize("name", LAWFUL)
def test_texts_comments_and_long_tables_are_within_the_bounds(name):
    assert parse_toml(LAWFUL[name]) == tomllib.loads(LAWFUL[name])


@pytest.mark.parametrize("name", shipped_scenes())
def test_every_shipped_scene_is_within_the_bounds(name):
    assert find_excess(read_source(name).text) == ""


PIECES = ['"""', "'''", '\\"""', '"', "'", '"\\', "#", "a.", " ", "[", "]", "a", "[a]\n", '"" "']


@pytest.mark.parametrize("piece", PIECES)
def test_the_scan_takes_time_in_proportion_to_any_text(piece):
    clock = time.perf_counter()
    find_excess('a = """' + piece * (LARGEST_FILE // 4 // len(piece)))
    find_excess(piece * (LARGEST_FILE // 4 // len(piece)))
    assert time.perf_counter() - clock < LIMIT


def test_changes_are_bounded_alike():
    assert "nested too deeply, 3001 parts" in refused("psh", {"a" + ".a" * 3000: "1"})
    clock = time.perf_counter()
    assert "x: unknown key" in refused("psh", {"x": "{" + "a." * 50_000 + "a = 1}"})
    assert time.perf_counter() - clock < LIMIT


def test_many_defects_are_counted_not_listed():
    clock = time.perf_counter()
    told = refused("psh", {f"unknown_{i}": "1" for i in range(20_000)})
    assert time.perf_counter() - clock < LIMIT
    assert len(told.splitlines()) < 100
    assert "more" in told.splitlines()[-1]
