"""Files of a scene: pipes that are read once, devices, paths with odd names."""

import os
import subprocess
import sys
import threading
import time
from contextlib import contextmanager
from pathlib import Path

import pytest
from ltcgear.generated.errors import SceneError
from ltcgear.symbolic.emit.template import Template
from ltcgear.symbolic.scene.load import SHIPPED, load_scene, make_scene, read_source
from ltcgear.symbolic.schema import source_files

PSH = (SHIPPED / "psh.toml").read_text(encoding="utf-8")


def refused(source, changes=None):
    with pytest.raises(SceneError) as caught:
        load_scene(source, changes)
    return str(caught.value)


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
