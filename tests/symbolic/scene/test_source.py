"""What a scene is read from: texts beyond all bounds, pipes, devices, and paths with odd names."""

import os
import resource
import subprocess
import sys
import threading
import time
import tomllib
from contextlib import contextmanager
from pathlib import Path

import pytest
from ltcgear.generated.errors import SceneError
from ltcgear.symbolic.emit.template import Template
from ltcgear.symbolic.scene.load import LARGEST_FILE, SHIPPED, load_scene, make_scene, read_source, shipped_scenes
from ltcgear.symbolic.scene.toml import MOST_PARTS, find_excess, parse_toml
from ltcgear.symbolic.schema import source_files

PSH = (SHIPPED / "psh.toml").read_text(encoding="utf-8")
LIMIT = 20.0  # [s], generous: without bounds these texts take minutes and gigabytes


def refused(source, changes=None):
    with pytest.raises(SceneError) as caught:
        load_scene(source, changes)
    return str(caught.value)


# --- texts

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


# --- pipes


@contextmanager
def piped(tmp_path, text, late=0.0):
    """Give a named pipe into which a text is written, in two parts with a pause before each."""
    path = tmp_path / "pipe.toml"
    os.mkfifo(path)

    def write():
        time.sleep(late)
        with path.open("w", encoding="utf-8") as file:
            for part in (text[:100], text[100:]):
                time.sleep(late)
                file.write(part)
                file.flush()

    writer = threading.Thread(target=write, daemon=True)
    writer.start()
    yield path
    writer.join(5)


@pytest.mark.parametrize("late", [0.0, 0.2])
def test_a_pipe_is_read_once_and_keeps_its_text(tmp_path, late):
    with piped(tmp_path, PSH, late) as path:
        source = read_source(path)
    assert source.text == PSH
    assert load_scene(source) == load_scene(source) == load_scene("psh").model_copy(update={"name": "pipe"})
    assert Template(source).text == PSH


def test_a_pipe_into_which_nobody_writes_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(source_files, "ABSENT", 0.1)
    os.mkfifo(tmp_path / "pipe")
    assert "into which nobody wrote for 0.1 s; start its writer" in refused(tmp_path / "pipe")


def test_a_pipe_whose_writer_is_silent_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(source_files, "SILENT", 0.1)
    os.mkfifo(tmp_path / "pipe")
    keep = os.open(tmp_path / "pipe", os.O_RDWR)
    assert "whose writer sent nothing for 0.1 s; write a file first" in refused(tmp_path / "pipe")
    os.close(keep)


def test_an_endless_pipe_is_refused(tmp_path):
    run = "import sys\ntry:\n while True: sys.stdout.write('#' * 4096)\nexcept BrokenPipeError: pass"
    with subprocess.Popen([sys.executable, "-c", run], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL) as child:
        assert "more than 1000000 bytes" in refused(f"/dev/fd/{child.stdout.fileno()}")


def test_files_named_by_a_scene_from_a_pipe_are_looked_up_in_the_current_folder():
    read, write = os.pipe()
    os.write(write, PSH.encode())
    os.close(write)
    assert read_source(f"/dev/fd/{read}").folder == Path()
    os.close(read)


def test_an_empty_pipe_without_a_writer_is_an_empty_scene_at_once():
    read, write = os.pipe()
    os.close(write)
    assert "title: is missing" in refused(f"/dev/fd/{read}")
    os.close(read)


@pytest.mark.parametrize("path", ["/dev/zero", "/dev/random", "/dev/null", "/dev"])
def test_devices_and_folders_are_refused(path):
    assert f"{path}: is a " in refused(path)
    assert "give a file" in refused(path)


def test_tables_of_pipes_are_read_once_too(tmp_path):
    """What a scene names is read with it, and not again by its variants."""
    with piped(tmp_path, "time [s],torque [N*m]\n0,0\n1,5\n") as path:
        source = read_source("psh")
        tree = source.tables()
        del tree["loads"]["output"]["torque"]
        tree["loads"]["output"]["torque_over_time"] = str(path)
        first = make_scene(tree, files=source.files)
    assert first.loads["output"].torque_over_time == ((0.0, 0.0), (1.0, 5.0))
    assert make_scene(tree, files=source.files) == first


# --- names of files


def test_a_path_that_is_no_utf_8_is_told_and_kept_out_of_names(tmp_path):
    path = Path(os.fsdecode(os.fsencode(tmp_path) + b"/\xff\x1b[31m\n.toml"))
    path.write_text(PSH, encoding="utf-8")
    scene = load_scene(path)
    assert scene.name.isprintable()
    assert scene.model_dump_json().encode()
    path.write_text("x = 1", encoding="utf-8")
    assert refused(path).encode()
    assert "\x1b" not in refused(path)


def test_a_long_path_is_told(tmp_path):
    path = tmp_path / ("x" * 245 + ".toml")
    path.write_text(PSH, encoding="utf-8")
    assert len(load_scene(path).name) <= 100
    told = refused(tmp_path / ("x" * 5000 + ".toml"))
    assert "cannot be read: File name too long; give another path" in told
    assert len(told) < 1000
