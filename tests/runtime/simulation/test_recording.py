"""Streaming: a result written while it is computed is the one in memory; memory stays flat; few samples."""

import os
import signal
import tracemalloc
from itertools import pairwise

import numpy as np
import pytest
import xarray as xr
from ltcgear.runtime.results.result import load
from ltcgear.runtime.results.row_file import part_of
from ltcgear.runtime.simulation import integration, sampling
from ltcgear.runtime.simulation.low_pass import passing_speed
from ltcgear.runtime.simulation.methods import stepper
from ltcgear.runtime.simulation.output_reader import Reader, join_rows
from ltcgear.runtime.simulation.recording import Recorder, record
from ltcgear.runtime.simulation.run_settings import RunSettings
from ltcgear.runtime.simulation.simulate import simulate
from ltcgear.runtime.simulation.trajectory import join

from ..models import case

TIMES = {"seconds", "real_time_factor"}
SMOOTH = 'effects.mesh_stiffness = "fourier"'


def write(c, target, **options):
    options = {"t_end": 0.05, "rate": 20e3, "tables": c.model.tables} | options
    return record(c.library, c.model.values(), target, **options)


def keep(c, **options):
    options = {"t_end": 0.05, "rate": 20e3, "tables": c.model.tables} | options
    return simulate(c.library, c.model.values(), **options)


def assert_same(one, two):
    """Let two results be equal to the last bit."""
    assert set(one.variables) == set(two.variables)
    for name in one.variables:
        assert one[name].dims == two[name].dims
        assert one[name].dtype.kind == two[name].dtype.kind
        assert one[name].shape == two[name].shape
        same = one[name].values == two[name].values
        assert (same | (one[name].isnull() & two[name].isnull()).values).all(), name
        assert dict(one[name].attrs) == dict(two[name].attrs), name


def told(summary):
    """What a summary tells besides seconds."""
    return {key: value for key, value in summary.items() if key not in TIMES}


# --- the file


@pytest.mark.parametrize("raw", [False, True])
@pytest.mark.parametrize("settings", [(), (SMOOTH,)], ids=["jumps", "smooth"])
def test_a_streamed_result_is_the_one_in_memory(tmp_path, monkeypatch, settings, raw):
    monkeypatch.setattr(sampling, "BLOCK", 150)
    monkeypatch.setattr(integration, "MARK_SECONDS", 0.0)
    c = case("psh", *settings)
    summary = write(c, tmp_path / "a.nc", raw=raw, attributes={"scene": "psh"})
    monkeypatch.setattr(sampling, "BLOCK", 10**9)
    monkeypatch.setattr(integration, "MARK_SECONDS", np.inf)
    kept = keep(c, raw=raw, attributes={"scene": "psh"})
    found = load(tmp_path / "a.nc").dataset
    assert found.sizes["time"] == 1001
    assert np.ptp(found["mesh_force"].values) > 1e3
    assert_same(found, kept.dataset)
    assert told(summary) == told(kept.summary)
    assert {k: v for k, v in found.attrs.items() if k not in TIMES} == {
        k: v for k, v in kept.dataset.attrs.items() if k not in TIMES
    }
    assert [path.name for path in tmp_path.iterdir()] == ["a.nc"]


def test_a_failed_run_keeps_its_samples_and_leaves_nothing_to_go_on_from(tmp_path, monkeypatch):
    c = case("psh")
    monkeypatch.setattr(stepper, "MOST_STEPS", 2)
    summary = write(c, tmp_path / "a.nc", method="cvodes")
    assert summary["status"].startswith("cvodes stopped at t = ")
    found = load(tmp_path / "a.nc").dataset
    assert found.attrs["status"] == summary["status"]
    assert found.sizes["time"] >= 1
    assert [path.name for path in tmp_path.iterdir()] == ["a.nc"]


def test_memory_stays_flat(tmp_path, monkeypatch):
    c = case("psh")
    monkeypatch.setattr(sampling, "BLOCK", 300)

    def peak(call, t_end):
        tracemalloc.start()
        call(t_end)
        found = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        return found

    def stream(t_end):
        write(c, tmp_path / "a.nc", t_end=t_end)

    stream(0.05)  # what is made once
    assert peak(stream, 0.5) < 1.1 * peak(stream, 0.1)
    assert peak(lambda t_end: keep(c, t_end=t_end), 0.5) > 2 * peak(stream, 0.5)


# --- reading block by block


@pytest.mark.parametrize("raw", [False, True])
def test_blocks_of_any_size_read_alike(raw):
    c = case("psh")
    parts = []
    options = {"t_end": 0.03, "rate": 30e3, "method": "erk", "rtol": 1e-6}
    run = integration.Integration(c.point, RunSettings(**options), passing=passing_speed(30e3, raw))
    assert run.proceed(lambda *given: parts.append(given)).status == "done"
    block, points = (join(list(given)) for given in zip(*parts, strict=True))

    def part_of_time(whole, first, last):
        some = (whole.time >= first) & (whole.time < last)
        return type(whole)(**{name: value[some] for name, value in vars(whole).items()})

    def read(edges):
        reader = Reader(c.point, RunSettings(0.03, 30e3, raw=raw))
        given = [(part_of_time(block, *pair), part_of_time(points, *pair)) for pair in pairwise(edges)]
        rows = [reader.read(samples, between) for samples, between in given if len(samples.time)]
        return join_rows([*rows, reader.finish()]), reader.statistics(), [len(row.index) for row in rows]

    whole, statistics, _ = read([-1.0, 1.0])
    assert (whole.index == np.arange(901)).all()
    assert (whole.x == block.x).all()
    generator = np.random.default_rng(3)
    for longest in (2, 40, 300):
        cuts = np.cumsum(generator.integers(1, longest, 1000)) / 30e3 + 0.5e-6
        found, again, sizes = read([-1.0, *cuts[cuts < 0.03], 1.0])
        assert longest == 300 or sum(sizes[:-1]) > 0
        assert (found.values == whole.values).all()
        assert (again == statistics).all()


# --- few samples


def test_few_samples_are_those_of_many(monkeypatch):
    c = case("psh", SMOOTH)
    many = c.run(method="erk", rtol=1e-8, rate=20e3, t_end=0.8)
    monkeypatch.setattr(stepper, "MOST_STEPS", 20_000)
    few = c.run(method="erk", rtol=1e-8, rate=2.5, t_end=0.8)
    assert few.status == "done"
    assert few.counts.steps > 3 * 20_000  # so many that no engine goes from sample to sample at once
    assert few.time == pytest.approx([0, 0.4, 0.8])
    forces = c.mesh_forces(many)
    assert np.abs(c.mesh_forces(few) - forces[::8000]).max() < 1e-4 * np.ptp(forces)


def test_few_samples_between_jumps_are_those_of_many():
    c = case("psh")
    many, few = (c.run(method="erk", rtol=1e-8, rate=rate, t_end=0.3) for rate in (20e3, 10.0))
    assert few.counts == many.counts
    assert (few.levels == many.levels[::2000]).all()
    assert np.abs(few.x - many.x[::2000]).max() <= 1e-12 * np.abs(many.x).max()


@pytest.mark.parametrize("samples", [1, 255, 257, 300, 1003, 5000])
def test_no_more_is_integrated_than_asked_for(samples):
    c = case("psh", SMOOTH)
    run = integration.Integration(c.point, RunSettings(samples / 50e3, 50e3, "erk", 1e-4))
    blocks = []
    assert run.proceed(lambda block, points: blocks.append(block)).status == "done"
    assert sum(len(block.time) for block in blocks) == samples + 1
    assert run.march.time * 50e3 < samples + 1 + samples / 256


def test_ctrl_c_stops_between_segments():
    c = case("psh")
    before = signal.getsignal(signal.SIGINT)
    path = c.run(method="erk", rate=20e3, t_end=10.0, told=lambda t: os.kill(os.getpid(), signal.SIGINT))
    assert path.status.startswith("interrupted at t = ")
    assert 0 < path.end < 10
    assert abs(path.time[-1] - path.end) < 1 / 20e3
    assert signal.getsignal(signal.SIGINT) is before


def test_ctrl_c_does_nothing_where_a_shell_has_it_ignored():
    """A run under nohup goes on."""
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        path = case("psh").run(method="erk", t_end=0.05, told=lambda t: os.kill(os.getpid(), signal.SIGINT))
        assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN
    finally:
        signal.signal(signal.SIGINT, before)
    assert path.status == "done"


@pytest.mark.parametrize("length", [0, 1000, 5000, 6000, 7000, 7900, 8000, 8100, 20000])
def test_rows_are_where_netcdf_reads_them_however_long_the_heading(length, tmp_path):
    """NetCDF pads files of some sizes; records do not end where the file does."""
    c, target = case("psh"), tmp_path / "a.nc"
    recorder = Recorder(target, Reader(c.point, RunSettings(1.0, 8192.0)), {"about": "x" * length}, None)
    with recorder.part as part:
        rows = np.zeros(3, part.record)
        for place, name in enumerate(part.record.names):
            rows[name] = place + 1
        part.append({name: rows[name] for name in part.record.names})
    with xr.open_dataset(part_of(target), engine="netcdf4") as found:
        assert found.sizes["time"] == 3
        assert all((found[name].values == k).all() for k, name in enumerate(part.record.names, start=1))


def test_memory_that_runs_out_is_no_failure_of_the_model(monkeypatch):
    c = case("psh")
    run = integration.Integration(c.point, RunSettings(0.01, 20e3, "cvodes", 1e-6))

    def exhausted(seconds):
        raise RuntimeError("Error in Function::operator(): std::bad_alloc")

    monkeypatch.setattr(run.march, "proceed", exhausted)
    with pytest.raises(MemoryError):
        run.proceed(lambda *given: None)
