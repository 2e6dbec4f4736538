"""Scenes as commands open them: files and pipes, odd names, `--set`, the store, the compiler."""

import json
import os
from contextlib import contextmanager
from pathlib import Path

import pytest
from ltcgear.generated import store as generated_store
from ltcgear.runtime.model import building, cstruct


@contextmanager
def piped(text):
    """Give the path of a pipe that holds a text, as ``<(...)`` does."""
    read, write = os.pipe()
    os.write(write, text.encode())
    os.close(write)
    try:
        yield f"/dev/fd/{read}"
    finally:
        os.close(read)


def test_a_scene_from_a_pipe_is_kept_and_varied(data, tmp_path):
    """Results keep its text, and variants are made of it, though a pipe can be read once only."""
    import xarray as xr
    from ltcgear.symbolic.scene.load import SHIPPED

    text = (SHIPPED / "psh.toml").read_text("utf-8")
    with piped(text) as path:
        assert data("info", path)["title"] == data("info", "psh")["title"]
    with piped(text) as path:
        data("simulate", path, "--t-end", "0.01", "-o", tmp_path / "a.nc")
    assert xr.open_dataset(tmp_path / "a.nc").attrs["scene_text"] == text
    with piped(text) as path:
        variants = data("cost", path, "--t-end", "0.005")["variants"]
    assert len(variants) > 3
    assert not any(row["reason"] for row in variants)


@pytest.mark.parametrize("command", ["info", "simulate", "check", "cost", "modes", "sweep"])
def test_a_path_that_cannot_be_one_is_exit_code_2(refused, command, tmp_path):
    more = ["--vary", "x=1,2", "-o", tmp_path / "a.nc"] if command == "sweep" else []
    if command == "simulate":
        (tmp_path / "a.nc").touch()
        more = ["-o", tmp_path / "a.nc"]
    assert "File name too long" in refused(command, tmp_path / ("x" * 300), *more)
    assert "File name too long" in refused(command, "x/" * 5000, *more)
    assert "is a device" in refused(command, "/dev/zero", *more)


@pytest.mark.parametrize("name", [b"gear\xff\x1b[31m.toml", b"x" * 245 + b".toml"], ids=["not UTF-8", "long"])
def test_odd_names_of_files_work_and_are_not_obeyed(run, name, tmp_path):
    from ltcgear.symbolic.scene.load import SHIPPED

    path = Path(os.fsdecode(os.fsencode(tmp_path) + b"/" + name))
    path.write_text(
        (SHIPPED / "psh.toml").read_text("utf-8") + "\n[effects]\ngravity = 'on'\nmesh_friction = 'sliding'\n"
    )
    for arguments in (["info", path], ["simulate", path, "--t-end", "0.005", "-o", tmp_path / "a.nc"]):
        code, out, err = run(*arguments)
        assert code == 0, err
        assert "warning: " in err
        assert "\x1b" not in out + err
        assert (out + err).encode()


def test_set_replaces_values(data):
    shown = data("info", "lsp", "--set", "effects.mesh_law=paper", "--set", "loads.ring.speed=7.5 rpm")
    assert shown["effects"]["mesh_law"] == "paper"
    assert data("info", "lsp", "--set", "title=a = b")["title"] == "a = b"


def test_a_bad_scene_file_is_exit_code_2(refused, tmp_path):
    path = tmp_path / "bad.toml"
    path.write_text('title = "x"\n[rotors.a]\nintertia = "1 kg"\n[effects]\ngravity = "of"\n', encoding="utf-8")
    for command in ("info", "check", "generate", "simulate", "modes"):
        text = refused(command, path, "--json")
        assert text.startswith(f"ltcgear: {path}: 2 defects\n")
        assert 'rotors.a.intertia: unknown key; did you mean "inertia"?' in text
        assert "effects.gravity: 'of'" in text


def test_a_store_others_may_write_is_refused(refused, tmp_path, monkeypatch):
    tmp_path.chmod(0o777)
    monkeypatch.setenv("LTCGEAR_CACHE", str(tmp_path))
    assert "set LTCGEAR_CACHE" in refused("info", "lsp")


def test_a_compiler_that_is_not_there_is_exit_code_3(refused, monkeypatch):
    monkeypatch.setenv("CC", "/nonexistent/cc")
    generated_store.compiler.cache_clear()
    try:
        assert "no such compiler" in refused("generate", "psh", code=3)
    finally:
        generated_store.compiler.cache_clear()


def test_without_a_compiler_the_virtual_machine_serves_all_but_simulations(run, monkeypatch):
    monkeypatch.setattr(building.store, "compiler", lambda: None)
    cstruct.engine.cache_clear()
    code, out, err = run("modes", "psh", "--json")
    assert code == 0
    assert json.loads(out)["modes"]
    assert "no C compiler found" in err
    code, out, err = run("simulate", "psh", "--t-end", "0.002", "--json")
    assert (code, out) == (3, "")
    assert err.splitlines()[-1] == f"ltcgear: {cstruct.NEEDED}"
