"""Checkpoints: a run that was stopped or killed anywhere goes on to the very result of one that was not."""

import os
import resource
import signal
import subprocess
import sys
from time import monotonic, sleep

import numpy as np
import pytest
import xarray as xr
from ltcgear.generated.errors import LtcgearError
from ltcgear.runtime.model.cstruct import FIELDS, NAMES
from ltcgear.runtime.results import checkpoint
from ltcgear.runtime.results.checkpoint import checkpoint_of
from ltcgear.runtime.results.result import load
from ltcgear.runtime.results.row_file import part_of, read_part
from ltcgear.runtime.simulation import integration, recording
from ltcgear.runtime.simulation.methods.registry import METHODS
from ltcgear.runtime.simulation.run_settings import RunSettings

from ..models import case, make_case
from .test_loads_over_time import shaft, torque
from .test_recording import SMOOTH, assert_same, told, write


class KilledError(Exception):
    """Stands for a run that is killed."""


@pytest.fixture(autouse=True)
def slices(monkeypatch):
    """Come back after every segment, so that a run may be stopped there."""
    monkeypatch.setattr(integration, "SLICE", 0.0)


@pytest.fixture
def killed(monkeypatch):
    """Write a result, killed at its n-th checkpoint and gone on with, again and again; return the summary."""

    def runner(c, target, at, **options):
        monkeypatch.setattr(integration, "MARK_SECONDS", 0.0)
        left = 0

        def fatal(*arguments):
            nonlocal left
            checkpoint.write_checkpoint(*arguments)
            left -= 1
            if not left:
                raise KilledError

        monkeypatch.setattr(recording, "write_checkpoint", fatal)
        for i, left in enumerate(at):  # noqa: B007
            with pytest.raises(KilledError):
                write(c, target, resume=i > 0, **options)
            assert not target.exists()
            assert part_of(target).exists()
        left = 0
        return write(c, target, resume=True, **options)

    return runner


def turning():
    """Two rotors under a torque over time."""
    rows = ((0.0, 1.0), (0.01, 200.0), (0.03, -50.0))
    return make_case(shaft(torque("one", *rows, initial_speed="10 rpm"), damping_ratio=0.05))


BACK = ("-loads.input.speed", 'loads.input.speed_over_time = [["0 s", "300 rpm"], ["0.1 s", "-300 rpm"]]')
FREE = (
    "-loads.input.speed",
    'loads.input.torque = "0 N*m"',
    'loads.input.initial_speed = "-20 rpm"',
)
CASES = {
    **{method: (lambda: case("psh"), {"method": method, "rtol": 1e-5}) for method in METHODS},
    "smooth": (lambda: case("psh", SMOOTH), {"rate": 100e3}),
    "raw": (lambda: case("psh"), {"raw": True}),
    "speed that turns back": (lambda: case("psh", *BACK), {"t_end": 0.1}),
    "loads over time": (turning, {"t_end": 0.4}),
}


@pytest.mark.parametrize("name", CASES)
def test_a_run_that_goes_on_is_the_one_never_stopped(killed, tmp_path, name):
    make, options = CASES[name]
    c = make()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(integration, "SLICE", np.inf)
        whole = write(c, tmp_path / "whole.nc", **options)
    summary = killed(c, tmp_path / "parts.nc", (1, 2, 5), **options)
    assert whole["status"] == "done"
    one, two = load(tmp_path / "whole.nc").dataset, load(tmp_path / "parts.nc").dataset
    assert one["state"].values.std(axis=0).max() > 0
    assert_same(one, two)
    assert told(summary) == told(whole)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["parts.nc", "whole.nc"]


@pytest.mark.parametrize(
    ("settings", "most"),
    [((), {"z", "time", "work", "jump_energy", "cells"}), (BACK, {"last_turn", "expected"}), (FREE, {"heading"})],
    ids=["held", "turned back", "free"],
)
def test_a_snapshot_holds_all_that_moves(settings, most):
    c = case("psh", *settings)
    run = RunSettings(10.0, 1e3, "erk", 1e-6, tables=c.model.tables)
    march = integration.Integration(c.point, run).march
    called = ("function", "advance")
    lasting = [name for name, kind, role in FIELDS if role in ("fixed", "kept") and kind not in called]
    before = {name: march.native.value(name) for name in lasting}
    for _ in range(4):
        march.proceed(segments=100)
        march.state.filled = 0
    moved = {name for name in lasting if not np.array_equal(before[name], march.native.value(name), equal_nan=True)}
    assert most <= moved <= set(NAMES["kept"])
    remembered = {name: np.copy(value) for name, value in march.snapshot().items()}
    other = integration.Integration(c.point, run).march
    other.restore(remembered)
    again = other.snapshot()
    assert set(again) == set(remembered)
    for name, value in remembered.items():
        assert np.array_equal(again[name], value, equal_nan=value.dtype.kind == "f"), name
        assert again[name].dtype == value.dtype


def test_ctrl_c_keeps_rows_that_can_be_read_and_what_it_takes_to_go_on(tmp_path):
    c, target = case("psh"), tmp_path / "a.nc"
    stop = {"told": lambda t: os.kill(os.getpid(), signal.SIGINT)}
    write(c, tmp_path / "whole.nc")
    summary = write(c, target, **stop)
    assert summary["status"].startswith("interrupted at t = ")
    assert summary["status"].endswith("--resume goes on")
    assert str(part_of(target)) in summary["status"]
    found = load(part_of(target)).dataset
    assert found.attrs["status"].startswith("not finished")
    assert 1 < found.sizes["time"] < 1001
    assert checkpoint_of(target).exists()
    assert not target.exists()
    assert write(c, target, resume=True)["status"] == "done"
    assert_same(load(target).dataset, load(tmp_path / "whole.nc").dataset)


def test_a_full_disk_is_told_and_the_run_goes_on_later(tmp_path, monkeypatch):
    c, target = case("psh"), tmp_path / "a.nc"
    monkeypatch.setattr(integration, "MARK_SECONDS", 0.0)
    write(c, tmp_path / "whole.nc")
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (150_000, limits[1]))
    try:
        with pytest.raises(LtcgearError, match=r"a\.part\.nc: cannot be written: .*; make room, then --resume goes on"):
            write(c, target)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert write(c, target, resume=True)["status"] == "done"
    assert_same(load(target).dataset, load(tmp_path / "whole.nc").dataset)


# --- refusals


@pytest.fixture
def stopped(killed, tmp_path):
    """A run that was killed."""
    c, target = case("psh"), tmp_path / "a.nc"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(recording, "write_checkpoint", None)
        with pytest.raises(TypeError):
            write(c, target)
    assert not checkpoint_of(target).exists()
    write(c, target, told=lambda t: os.kill(os.getpid(), signal.SIGINT))
    return c, target


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"rtol": 1e-7}, "rtol 1e-06 there, 1e-07 here"),
        ({"method": "cvodes"}, "method auto there, cvodes here"),
        ({"t_end": 0.06}, "t_end 0.05 there, 0.06 here"),
        ({"rate": 10e3}, "rate 20000.0 there, 10000.0 here"),
        ({"raw": True}, "raw False there, True here"),
        ({"rtol": 1e-7, "t_end": 1.0, "rate": 1.0, "raw": True}, " and 1 more; "),
    ],
)
def test_another_run_is_not_gone_on_with(stopped, change, reason):
    c, target = stopped
    with pytest.raises(LtcgearError, match="of another run: ") as caught:
        write(c, target, resume=True, **change)
    assert reason in str(caught.value)
    assert "--force in place of --resume begins anew" in str(caught.value)


def test_another_number_equation_or_version_is_told(stopped, monkeypatch):
    c, target = stopped
    name = c.library.manifest.parameters[0][0]
    values = c.model.values()
    values[name] += 1
    with pytest.raises(LtcgearError, match=f"parameter {name} "):
        recording.record(c.library, values, target, t_end=0.05, rate=20e3, resume=True)
    with pytest.raises(LtcgearError, match="other equations"):
        write(case("psh", SMOOTH), target, resume=True)
    monkeypatch.setattr(checkpoint, "version", lambda name: "0.0")
    with pytest.raises(LtcgearError, match=r"version of ltcgear .* there, 0\.0 here"):
        write(c, target, resume=True)


def test_parameters_that_another_processor_rounds_otherwise_are_the_same(stopped):
    c, target = stopped
    values = {name: value * (1 + 1e-15) for name, value in c.model.values().items()}
    assert recording.record(c.library, values, target, t_end=0.05, rate=20e3, resume=True)["status"] == "done"


@pytest.mark.parametrize(
    "damage", [lambda data: b"", lambda data: data[: len(data) // 2], lambda data: data[:99] + b"x" * 999]
)
def test_a_damaged_checkpoint_is_told(stopped, damage):
    c, target = stopped
    file = checkpoint_of(target)
    file.write_bytes(damage(file.read_bytes()))
    with pytest.raises(LtcgearError, match=r"a\.checkpoint\.npz: damaged .*--force in place of --resume begins anew"):
        write(c, target, resume=True)


def test_a_part_that_does_not_fit_is_told(stopped):
    c, target = stopped
    whole = part_of(target).read_bytes()
    part_of(target).write_bytes(b"nothing")
    with pytest.raises(LtcgearError, match=r"a\.part\.nc: holds something else than a NetCDF file"):
        write(c, target, resume=True)
    part_of(target).write_bytes(whole[:4] + bytes(4) + whole[8:])  # no record
    with pytest.raises(LtcgearError, match=r"holds 0 samples where the checkpoint counts \d+; to begin anew"):
        write(c, target, resume=True)
    part_of(target).write_bytes(whole)
    begin = read_part(part_of(target)).begin
    part_of(target).write_bytes(whole[:begin] + bytes(500) + whole[begin + 500 :])  # a hole of zeros
    with pytest.raises(LtcgearError, match=r"a\.part\.nc: its rows are not those of .*a\.checkpoint\.npz"):
        write(c, target, resume=True)
    place = whole.index(b"reference_angle")
    part_of(target).write_bytes(whole[:place] + b"R" + whole[place + 1 :])
    with pytest.raises(LtcgearError, match=r"a\.part\.nc: its heading is damaged"):
        write(c, target, resume=True)
    for path in (part_of(target), checkpoint_of(target)):
        path.unlink()
        with pytest.raises(LtcgearError, match=f"{path.name}: not there"):
            write(c, target, resume=True)


# --- the program, killed

PROGRAM = """
import sys
from time import sleep
from ltcgear.runtime.cli import commands
from ltcgear.runtime.simulation import integration, recording, sampling
integration.MARK_SECONDS, integration.SLICE, sampling.BLOCK = 0.01, 0.0, 64
take = recording.Recorder.take
recording.Recorder.take = lambda self, *given: (sleep(0.005), take(self, *given))  # time to be killed in
sys.argv = ["ltcgear", "simulate", "psh", "--t-end", "1.5", "-o", *sys.argv[1:]]
commands.main()
"""


def start(*arguments):
    return subprocess.Popen([sys.executable, "-c", PROGRAM, *map(str, arguments)], stderr=subprocess.PIPE, text=True)


def rows_in(target):
    """How many records the heading of a part counts."""
    with part_of(target).open("rb") as file:
        return int.from_bytes(file.read(8)[4:], "big")


def test_a_killed_program_leaves_a_readable_file_and_goes_on(tmp_path):
    whole, target = tmp_path / "whole.nc", tmp_path / "a.nc"
    with start(whole) as program:
        assert program.wait(timeout=120) == 0
    wanted, generator = load(whole).dataset, np.random.default_rng(4)
    sizes = []
    for trial in range(4):
        with start(target, *(["--resume"] if trial else [])) as program:
            begun, wanted_rows = monotonic(), sum(sizes[-1:]) + generator.integers(1, 1500)
            while not checkpoint_of(target).exists() or rows_in(target) < wanted_rows:
                assert program.poll() is None
                assert monotonic() - begun < 100
                sleep(0.002)
            sleep(generator.uniform(0.0, 0.05))
            program.kill()
            program.wait(timeout=60)
            assert program.returncode == -signal.SIGKILL
        assert not target.exists()
        with xr.open_dataset(part_of(target), engine="netcdf4") as part:
            sizes.append(part.sizes["time"])
            assert "--resume" in part.attrs["status"]
            for name in part.data_vars:
                assert (part[name].values == wanted[name].values[: sizes[-1]]).all(), name
            assert (part["time"].values == wanted["time"].values[: sizes[-1]]).all()
    assert 0 < sizes[0] < sizes[-1] < wanted.sizes["time"]
    with start(target, "--resume") as program:
        assert program.wait(timeout=120) == 0
    assert_same(load(target).dataset, wanted)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.nc", "whole.nc"]
