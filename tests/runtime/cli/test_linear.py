"""`ltcgear modes`: what it prints, writes, draws and refuses."""

import csv
import json
import os
import re
from html.parser import HTMLParser

import pytest
from ltcgear.runtime.api import restoring
from ltcgear.runtime.cli import linear

KEYS = {
    "frequency_hz", "damping_ratio", "class", "energy",
    "name", "members", "strain", "group", "multiplicity", "eigenvalue",
}  # fmt: skip


def test_modes_tell_all_of_each(data, run):
    shown = data("modes", "lin-parker-4")
    assert shown["freedoms"] == len(shown["modes"]) == 21
    assert all(mode.keys() == KEYS for mode in shown["modes"])
    real, imaginary = shown["modes"][5]["eigenvalue"]
    assert abs(complex(real, imaginary)) == pytest.approx(6.283185307 * shown["modes"][5]["frequency_hz"])
    text = run("modes", "lin-parker-4")[1]
    assert "gear.ring on" in text
    assert "translational x2" in text


def test_count_takes_the_lowest(data, run):
    everything, few = data("modes", "psh")["modes"], data("modes", "psh", "--count", "2")["modes"]
    assert few == everything[:2]
    assert "the lowest 2 of 5" in run("modes", "psh", "--count", "2")[1]
    assert "the lowest" not in run("modes", "psh")[1]


def test_large_trains_list_the_lowest_unless_more_are_asked_for(data, monkeypatch):
    monkeypatch.setattr(restoring, "MANY", 4)
    monkeypatch.setattr(restoring, "FEW", 3)
    assert len(data("modes", "psh")["modes"]) == 3
    assert len(data("modes", "psh", "--count", "5")["modes"]) == 5


def test_meshes_are_held_at_a_turn(data):
    """The mesh of the pair is stiffer in double contact; the first turns see both levels."""
    last = {turn: data("modes", "psh", "--turn", turn)["modes"][-1]["frequency_hz"] for turn in (0, 0.01, 0.012)}
    mean = data("modes", "psh")["modes"][-1]["frequency_hz"]
    assert min(last.values()) < mean < max(last.values())


def test_tables(data, run, tmp_path):
    shown = data("modes", "psh", "-o", tmp_path / "modes.json")
    written = json.loads((tmp_path / "modes.json").read_text("utf-8"))
    assert written["modes"] == shown["modes"]
    code, out, _ = run("modes", "psh", "-o", tmp_path / "modes.csv")
    assert (code, f"wrote {tmp_path / 'modes.csv'}" in out) == (0, True)
    head, *rows = csv.reader((tmp_path / "modes.csv").read_text("utf-8").splitlines())
    assert [float(row[head.index("frequency [Hz]")]) for row in rows] == [m["frequency_hz"] for m in shown["modes"]]
    column = head.index("strain psh.mesh []")
    assert [float(row[column]) for row in rows] == [mode["strain"].get("psh.mesh", 0.0) for mode in shown["modes"]]


class Reader(HTMLParser):
    """Counts tags and keeps the addresses that a page asks for."""

    def __init__(self):
        super().__init__()
        self.tags, self.addresses, self.moving = [], [], []

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.addresses += [value for key, value in attrs if key in ("src", "href")]
        self.moving += [dict(attrs) for key, _ in attrs if key == "data-m"]


def test_a_page_of_moving_shapes_needs_nothing_else(run, tmp_path):
    page = tmp_path / "modes.html"
    assert run("modes", "psh", "-o", page)[0] == 0
    text = page.read_text("utf-8")
    found = Reader()
    found.feed(text)
    assert found.tags.count("figure") == found.tags.count("svg") == 5
    assert found.addresses == []
    assert "http" not in text
    assert "687.0" in re.sub(r"<[^>]*>", " ", text) or "686.98" in text
    # Without a script the members stand in the real part of the shape: displaced, not all alike.
    stills = {part["transform"] for part in found.moving}
    assert len(stills) > 5
    x, y, turn, *_ = json.loads(found.moving[0]["data-m"])
    assert found.moving[0]["transform"].startswith(f"translate({x[0]} {y[0]}) rotate({turn[0]}")


@pytest.mark.parametrize("suffix", ["png", "svg", "pdf"])
def test_pictures(run, tmp_path, suffix):
    picture = tmp_path / f"modes.{suffix}"
    assert run("modes", "hsp", "--mode", "2", "--mode", "3", "-o", picture)[0] == 0
    assert picture.stat().st_size > 5000
    if suffix == "svg":
        assert "167.42 Hz" in picture.read_text("utf-8") or "2: " in picture.read_text("utf-8")


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--count", "0"], ["--count 0", "leave --count out"]),
        (["--turn", "nan"], ["--turn nan", "finite", "0.25"]),
        (["--turn", "inf"], ["--turn inf", "finite"]),
        (["-o", "modes.txt"], ["modes.txt", ".html", "name it modes.csv"]),
        (["-o", "nowhere/modes.csv"], ["nowhere", "does not exist", "make it first"]),
        (["--mode", "2"], ["--mode", "-o modes.png"]),
        (["--mode", "2", "-o", "modes.csv"], ["--mode", "-o modes.png"]),
        (["--mode", "0", "-o", "modes.png"], ["--mode 0", "from 1"]),
        (["--mode", "9", "-o", "modes.png"], ["--mode 9", "there are 5 modes"]),
    ],
)
def test_bad_options_are_refused(run, options, words, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    if "9" not in options:  # all but that are refused before anything is computed
        monkeypatch.setattr(linear, "open_scene", None)
    code, out, err = run("modes", "psh", *options)
    assert (code, out) == (2, "")
    assert len(err.splitlines()) == 1
    assert all(word in err for word in words), err


@pytest.mark.skipif(os.geteuid() == 0, reason="root writes everywhere")
def test_a_folder_that_cannot_be_written_is_refused_before_anything_is_computed(run, monkeypatch, tmp_path):
    tmp_path.chmod(0o500)
    monkeypatch.setattr(linear, "open_scene", None)
    code, _, err = run("modes", "psh", "-o", tmp_path / "modes.csv")
    assert code == 2
    assert "cannot be written" in err


LOOSE = """
title = "Two rotors that nothing holds"
effects = { mesh_stiffness = "mean" }
rotors = { a = { inertia = "1 kg*m^2" }, b = { inertia = "1 kg*m^2" } }
couplings = { c = { between = ["a", "b"], stiffness = "1000 N*m/rad" } }
loads = { a = { member = "a", torque = "5 N*m" } }
"""


def test_a_member_that_nothing_holds_is_named(run, tmp_path):
    scene = tmp_path / "loose.toml"
    scene.write_text(LOOSE, "utf-8")
    code, out, err = run("modes", scene)
    assert (code, out) == (3, "")
    assert "nothing holds a (u), b (u) against the loads" in err
    assert "torsional_support" in err


def test_a_stiffness_of_zero_is_refused_by_its_key(run):
    code, _, err = run("modes", "psh", "--set", "stages.psh.input.bearing.stiffness=0 N/m")
    assert code == 2
    assert "stages.psh.input.bearing.stiffness" in err


def test_modes(data, run):
    modes = data("modes", "lin-parker-3")["modes"]
    frequencies = [mode["frequency_hz"] for mode in modes]
    assert frequencies == sorted(frequencies)
    assert frequencies[0] == pytest.approx(0.0, abs=1e-2)  # the rigid-body mode is listed
    assert {"frequency_hz", "damping_ratio", "class"} <= set(modes[0])
    assert "Hz" in run("modes", "lin-parker-3")[1]


def test_a_scene_without_equilibrium_is_exit_code_3(refused):
    text = refused("modes", "lsp", "--set", "loads.ring={member='lsp.ring', torque='1 N*m'}", code=3)
    assert text.startswith("ltcgear: ")
