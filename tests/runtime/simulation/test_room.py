"""Room: what a run takes of memory and disk, against what it really takes, and what there is."""

import shutil
import subprocess
import sys
from collections import namedtuple

import pytest
from ltcgear.generated.errors import LtcgearError
from ltcgear.runtime.simulation import room
from ltcgear.runtime.simulation.ensemble import simulate_many
from ltcgear.runtime.simulation.recording import record
from ltcgear.runtime.simulation.room import bytes_in_memory, bytes_on_disk
from ltcgear.runtime.simulation.simulate import simulate

from ..models import case

MEASURE = """
import re, sys
from pathlib import Path
from ltcgear.runtime.model.building import build
from ltcgear.runtime.simulation.room import bytes_in_memory
from ltcgear.runtime.simulation.simulate import simulate
from ltcgear.symbolic.assembly import build_model
from ltcgear.symbolic.emit.pipeline import obtain
from ltcgear.symbolic.scene.load import load_scene
model = build_model(load_scene(sys.argv[1]))
library, options = build(obtain(model)), {"method": "erk", "rtol": 1e-3, "tables": model.tables}
peak = lambda: 1024 * int(re.search(r"VmHWM:\\s+(\\d+)", Path("/proc/self/status").read_text())[1])
simulate(library, model.values(), t_end=0.01, rate=1e4, **options)
before, samples = peak(), float(sys.argv[2])
found = simulate(library, model.values(), t_end=samples / 2e6, rate=2e6, **options)
print((peak() - before) / bytes_in_memory(library, samples), found.summary["status"])
"""


@pytest.mark.parametrize(("scene", "samples"), [("psh", 2e5), ("lsp", 6e4)])
def test_a_run_takes_the_memory_that_is_reckoned(scene, samples):
    command = [sys.executable, "-c", MEASURE, scene, str(samples)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    share, status = done.stdout.split()
    assert status == "done"
    assert 0.7 < float(share) < 1.5


def test_a_file_takes_the_room_that_is_reckoned(tmp_path):
    c, seen = case("psh"), []
    options = {"t_end": 0.5, "rate": 2e4, "method": "erk"}

    def look(*_):
        seen.append(sum(path.stat().st_size for path in tmp_path.iterdir() if "checkpoint" not in path.name))

    record(c.library, c.model.values(), tmp_path / "a.nc", **options)
    look()
    whole = bytes_on_disk(c.library, 1e4)
    assert 0.4 < seen[0] / whole < 0.7  # the rows go to a part first, and both are there at the end


def test_a_run_of_more_than_the_memory_is_refused_and_goes_to_a_file(monkeypatch, tmp_path):
    c, options = case("psh"), {"t_end": 0.01, "rate": 8192.0}
    need = bytes_in_memory(c.library, 82)
    monkeypatch.setattr(room, "free_memory", lambda: need / 0.9)
    with pytest.raises(LtcgearError, match=r"would take \S+ GB of \S+ GB memory that is free; lower t_end or rate"):
        simulate(c.library, c.model.values(), **options)
    assert record(c.library, c.model.values(), tmp_path / "a.nc", **options)["status"] == "done"


def test_what_is_free_is_what_the_system_and_its_limits_leave(monkeypatch, tmp_path):
    stat = "anon 5\ninactive_file 200000000\nactive_file 7\n"
    for name, text in (("max", "4000000000\n"), ("current", "1000000000\n"), ("none", "max\n"), ("memory.stat", stat)):
        (tmp_path / name).write_text(text)
    (tmp_path / "meminfo").write_text("MemTotal: 9000000 kB\nMemAvailable:    8000000 kB\n")
    monkeypatch.setattr(room, "MEMINFO", tmp_path / "meminfo")
    monkeypatch.setattr(room, "LIMITS", ((tmp_path, "max", "current"),))
    assert room.free_memory() == 3.2e9
    monkeypatch.setattr(room, "LIMITS", ((tmp_path, "none", "current"), (tmp_path / "no", "max", "current")))
    assert room.free_memory() == 8000000 * 1024
    monkeypatch.setattr(room, "MEMINFO", tmp_path / "nothing")
    assert 1e8 < room.free_memory() < 1e15


def test_a_file_that_the_disk_cannot_hold_is_refused_before_anything_is_written(monkeypatch, tmp_path):
    c = case("psh")
    usage = namedtuple("usage", "total used free")
    monkeypatch.setattr(shutil, "disk_usage", lambda path: usage(10**12, 10**12, 10**6))
    with pytest.raises(
        LtcgearError, match=r"a\.nc: the disk is full: the result would take \S+ MB, and 1 MB are free; "
    ):
        record(c.library, c.model.values(), tmp_path / "a.nc", t_end=1.0, rate=1e5)
    assert not list(tmp_path.iterdir())
    assert record(c.library, c.model.values(), tmp_path / "a.nc", t_end=0.01, rate=8192.0)["status"] == "done"


def test_the_bound_on_samples_holds_however_they_are_asked_for(tmp_path, refused):
    c = case("psh")
    for options in ({"t_end": 1e4, "rate": 1e5}, {"t_end": 9e6, "rate": None}):
        for begin in (
            lambda options=options: simulate(c.library, c.model.values(), long=True, **options),
            lambda options=options: record(c.library, c.model.values(), tmp_path / "a.nc", long=True, **options),
        ):
            with pytest.raises(LtcgearError, match=r"samples, above 1e\+08; lower t_end or rate"):
                begin()
    with pytest.raises(LtcgearError, match="above 1e"):
        simulate_many(c.library, [c.model.values()], t_end=1e4, rate=1e5)
    told = refused("simulate", "psh", "--t-end", "900000", "--set", "simulation.rate=8192 Hz", "-o", tmp_path / "a.nc")
    assert "above 1e+08" in told
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"rate": float("nan")}, "rate nan: must be a number of samples a second"),
        ({"rate": -1.0}, "rate -1: must"),
        ({"rate": True}, "rate True: must"),
        ({"rate": "8192"}, "rate '8192': must"),
        ({"t_end": "1"}, "t_end '1': must be a time in seconds"),
        ({"t_end": float("nan")}, "t_end nan: must be a time"),
        ({"rtol": "1e-6"}, "rtol '1e-6': must lie between"),
        ({"rtol": None}, "rtol None: must lie between"),
    ],
)  # fmt: skip
def test_options_that_are_no_numbers_are_refused_by_name(tmp_path, options, message):
    c, options = case("psh"), {"t_end": 0.01, "rate": 8192.0} | options
    for begin in (
        lambda: simulate(c.library, c.model.values(), **options),
        lambda: record(c.library, c.model.values(), tmp_path / "a.nc", **options),
        lambda: simulate_many(c.library, [c.model.values()], **options),
    ):
        with pytest.raises(LtcgearError, match=message):
            begin()
