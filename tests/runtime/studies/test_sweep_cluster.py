"""A sweep over a real Dask scheduler and two workers on the loopback address, one of which is killed in the middle."""

import json
import os
import signal
import subprocess
import sys
from pathlib import Path
from time import monotonic, sleep

import numpy as np
import pytest
import xarray as xr
from ltcgear.generated.errors import LtcgearError, MachineError
from ltcgear.runtime import load_sweep, sweep
from ltcgear.symbolic import Template

from sweep_trace import Traced

pytest.importorskip("distributed")
VARY = ("loads.ring.speed=5 rpm:20 rpm", "loads.sun.torque=1e5 N*m:3e5 N*m")
DRAWN = {"sample": "lhs", "points": 60, "t_end": 0.05}
QUIET = {"DASK_LOGGING__DISTRIBUTED": "error"}


def start(*arguments):
    """Start a part of a cluster."""
    paths = os.pathsep.join([str(Path(__file__).parents[2]), *filter(None, [os.environ.get("PYTHONPATH")])])
    environment = {**os.environ, **QUIET, "PYTHONPATH": paths}
    return subprocess.Popen(
        [sys.executable, "-m", *arguments], env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )


@pytest.fixture
def cluster(tmp_path):
    """A scheduler without a worker: its address, and what starts a worker."""
    file, parts = tmp_path / "scheduler.json", []
    common = ("--scheduler-file", str(file), "--no-dashboard")
    parts.append(start("distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", "0", *common))

    alone = {True: (), False: ("--no-nanny",)}

    def worker(*, nanny=False):
        where = ("--local-directory", str(tmp_path / "scratch"), "--host", "127.0.0.1")
        parts.append(start("distributed.cli.dask_worker", "--nthreads", "1", *where, *common, *alone[nanny]))
        return parts[-1]

    worker.scheduler = parts[0]
    end = monotonic() + 30
    while not file.exists() and monotonic() < end:
        sleep(0.05)
    try:
        yield json.loads(file.read_text())["address"], worker
    finally:
        for part in parts[::-1]:
            part.terminate()  # a nanny ends its worker
            part.wait()


def test_a_worker_that_is_killed_loses_nothing(cluster, tmp_path):
    address, add = cluster
    workers, killed = [add(), add()], []
    template = Traced(tmp_path / "trace", "lsp")

    def told(stage, done, total, failed):
        both = {pid for pid, _ in template.made()}
        if done >= 10 and not killed and both >= {worker.pid for worker in workers}:
            killed.append(workers[0].pid)
            os.kill(workers[0].pid, signal.SIGKILL)

    summary = sweep(template, VARY, tmp_path / "a.nc", scheduler=address, told=told, **DRAWN)
    assert killed
    assert (summary["points"], summary["computed"], summary["failed"]) == (60, 60, 0)
    sweep(Template("lsp"), VARY, tmp_path / "b.nc", workers=1, **DRAWN)
    one, two = load_sweep(tmp_path / "a.nc"), load_sweep(tmp_path / "b.nc")
    xr.testing.assert_identical(one, two)
    for name in set(one.data_vars) - {"status"}:
        assert np.array_equal(one[name].values, two[name].values), name
    again = sweep(template, VARY, tmp_path / "a.nc", scheduler=address, **DRAWN)
    assert again["computed"] == 0


def test_a_cluster_without_workers_is_told(cluster, tmp_path, monkeypatch):
    from ltcgear.runtime.studies.sweep import cluster as module

    monkeypatch.setattr(module, "PATIENCE", 1)
    with pytest.raises(LtcgearError, match="has no workers; start them with `dask worker tcp://"):
        sweep(Template("lsp"), VARY, tmp_path / "a.nc", scheduler=cluster[0], **DRAWN)
    assert not (tmp_path / "a.nc").exists()


def test_one_worker_is_enough_and_what_is_lost_is_told(cluster, tmp_path, monkeypatch):
    """It is killed in the middle, which is told once; another takes its place, until the scheduler is killed."""
    from ltcgear.runtime.studies.sweep import cluster as module

    (address, add), warnings = cluster, []
    worker, few = add(), {**DRAWN, "points": 10, "t_end": 0.02}

    def kill_worker(stage, done, total, failed):
        if (stage, done) == ("simulate", 3):
            monkeypatch.setattr(module, "PATIENCE", 0.2)
            worker.kill()

    def help_out(text):
        warnings.append(text)
        add()

    monkeypatch.setattr(module, "tell", help_out)
    summary = sweep(Template("lsp"), VARY, tmp_path / "a.nc", scheduler=address, told=kill_worker, **few)
    assert (summary["workers"], summary["computed"], summary["failed"]) == (1, 10, 0)
    sweep(Template("lsp"), VARY, tmp_path / "b.nc", workers=1, **few)
    xr.testing.assert_identical(load_sweep(tmp_path / "a.nc"), load_sweep(tmp_path / "b.nc"))
    [text] = warnings
    assert "has no workers left, the sweep waits; start some with `dask worker tcp://" in text

    def kill_scheduler(stage, done, total, failed):
        if (stage, done) == ("simulate", 3):
            add.scheduler.kill()

    monkeypatch.setattr(module, "PATIENCE", 5)
    with pytest.raises(LtcgearError, match=f"the scheduler {address} is lost .*; rows are kept, the same command goes"):
        sweep(Template("lsp"), VARY, tmp_path / "c.nc", scheduler=address, told=kill_scheduler, **few)
    assert load_sweep(tmp_path / "c.part.nc").sizes["point"] >= 3


def test_a_point_that_kills_every_worker_is_no_row(cluster, tmp_path):
    """Dask does not tell by what workers ended; it ends them itself where memory runs out."""
    address, add = cluster
    add(nanny=True)
    template, target = Traced(tmp_path / "trace", "lsp", deadly="12 rpm"), tmp_path / "a.nc"
    grid = ("loads.ring.speed=5 rpm,12 rpm,20 rpm",)
    with pytest.raises(MachineError, match=r"point 1 .*: the process was killed .*--skip 1; 2 of 3 rows are kept"):
        sweep(template, grid, target, t_end=0.02, scheduler=address)
    assert sweep(template, grid, target, t_end=0.02, scheduler=address, skip=[1])["failed"] == 1
