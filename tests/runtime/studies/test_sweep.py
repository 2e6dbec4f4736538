"""Sweeps: every point once, whatever dies; failed points are rows; what is wrong is refused before any run."""

import os
import signal
import subprocess
import sys
from collections import Counter
from pathlib import Path
from time import monotonic, sleep

import numpy as np
import pytest
import xarray as xr
from ltcgear.generated import store as models
from ltcgear.generated.errors import LtcgearError, MachineError, SceneError, SolverError
from ltcgear.runtime import build, load, load_sweep, simulate, sweep
from ltcgear.runtime.model.members import train_of
from ltcgear.runtime.results.result import save
from ltcgear.runtime.results.row_file import part_of
from ltcgear.runtime.results.train_record import TRAIN, read_train
from ltcgear.runtime.studies.sweep import run_sweep as sweeping
from ltcgear.runtime.studies.sweep import task
from ltcgear.symbolic import Template
from ltcgear.symbolic.scene.load import SHIPPED

from sweep_trace import Traced

VARY = ("loads.ring.speed=5 rpm:20 rpm", "loads.sun.torque=1e5 N*m:3e5 N*m")
DRAWN = {"sample": "lhs", "points": 60, "t_end": 0.05}
FEW = {"sample": "lhs", "points": 6, "t_end": 0.02, "workers": 1}


def assert_equal(one, two):
    """The same rows and the same attributes, to the last bit."""
    xr.testing.assert_identical(one, two)
    for name in one.data_vars:
        if one[name].dtype.kind == "f":
            assert one[name].values.tobytes() == two[name].values.tobytes(), name


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The uninterrupted sweep, computed by this process alone."""
    target = tmp_path_factory.mktemp("whole") / "whole.nc"
    summary = sweep(Template("lsp"), VARY, target, workers=1, **DRAWN)
    assert (summary["points"], summary["computed"], summary["failed"]) == (60, 60, 0)
    return load_sweep(target)


def count(target):
    """Rows in a part, by its heading."""
    part = part_of(target)
    return int.from_bytes(part.read_bytes()[4:8], "big") if part.exists() else 0


# --- what a row is


def test_a_row_is_what_a_plain_run_measures(whole):
    template = Template("lsp")
    for point in (0, 59):
        changes = {key: f"{float(whole[key][point])!r} {whole[key].units}" for key in [v.split("=")[0] for v in VARY]}
        _, values, tables = template.make(changes)
        result = simulate(build(template.obtain(changes)), values, t_end=0.05, rate=8192, tables=tables)
        forces = [one["mean"] for one in result.summary["forces"].values()]
        np.testing.assert_array_equal(whole["mesh_force_mean"][point], forces)
    assert whole["mesh_force_mean"].std("point").min() > 1e3
    assert np.ptp(whole["loads.ring.speed"].values) > 14
    assert "scene_json" in whole.attrs
    assert TRAIN in whole.attrs
    assert read_train(whole) == train_of(build(template.obtain({})).manifest)


def test_a_mean_force_carries_the_torque(whole):
    """Four meshes on a base circle of 22 teeth of 16 mm at 20 deg balance the sun's torque (statics)."""
    radius = 22 * 0.016 / 2 * np.cos(np.radians(20))
    sun = whole["mesh_force_mean"].sel(mesh=[f"lsp.sun_planet.{k}" for k in range(1, 5)]).sum("mesh")
    np.testing.assert_allclose(sun * radius, whole["loads.sun.torque"], rtol=2e-2)


# --- what dies


def test_a_killed_sweep_goes_on_and_computes_each_point_once(whole, tmp_path):
    target, first, second = tmp_path / "a.nc", tmp_path / "first", tmp_path / "second"
    script = Path(__file__).parents[2] / "sweep_trace.py"
    program = subprocess.Popen([sys.executable, script, first, target, *VARY], start_new_session=True)
    end = monotonic() + 60
    while count(target) < 12 and monotonic() < end:
        sleep(0.002)
    os.killpg(program.pid, signal.SIGKILL)
    program.wait()
    kept = load_sweep(part_of(target))
    assert 12 <= kept.sizes["point"] < 60
    assert kept.attrs["status"].startswith("not finished")
    with pytest.raises(LtcgearError, match=r"the sweep is under way, .*a\.part\.nc has its rows"):
        load_sweep(target)
    template = Traced(second, "lsp")
    summary = sweep(template, VARY, target, workers=2, **DRAWN)
    assert (summary["kept"], summary["computed"]) == (kept.sizes["point"], 60 - kept.sizes["point"])
    computed = Counter(text for _, text in template.made())
    assert set(computed.values()) == {1}
    rows = {float(speed) for speed in kept["loads.ring.speed"].values}
    again = {float(speed) for speed in whole["loads.ring.speed"].values if f"'{float(speed)!r} rpm'" in str(computed)}
    assert not rows & again
    assert len(rows | again) == 60
    assert_equal(load_sweep(target), whole)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.nc", "first", "second"]
    before = target.stat().st_mtime_ns
    assert sweep(template, VARY, target, workers=2, **DRAWN)["computed"] == 0
    assert target.stat().st_mtime_ns == before


def test_a_worker_that_is_killed_takes_no_point_with_it(whole, tmp_path):
    template, killed = Traced(tmp_path / "trace", "lsp"), []

    def told(stage, done, total, failed):
        if done == 10 and not killed:
            killed.append(template.made()[-1][0])
            os.kill(killed[0], signal.SIGKILL)

    sweep(template, VARY, tmp_path / "a.nc", workers=2, told=told, **DRAWN)
    assert killed
    assert len({pid for pid, _ in template.made()}) > 2
    assert_equal(load_sweep(tmp_path / "a.nc"), whole)


GRID = ("loads.ring.speed=5 rpm,10 rpm,12 rpm,15 rpm,20 rpm",)


def test_a_point_that_crashes_its_worker_twice_is_a_row(tmp_path):
    template = Traced(tmp_path / "trace", "lsp", deadly="12 rpm", by=signal.SIGSEGV)
    sweep(template, GRID, tmp_path / "a.nc", t_end=0.02, workers=2)
    found = load_sweep(tmp_path / "a.nc")
    assert [status == "done" for status in found["status"].values] == [True, True, False, True, True]
    assert "the process died that computed this point, twice; SIGSEGV" in str(found["status"].values[2])
    assert np.isnan(found["mesh_force_mean"][2]).all()
    assert template._count({"loads.ring.speed": "12 rpm"}) == 2


def test_a_point_whose_worker_is_killed_twice_from_outside_is_no_row_until_it_is_left_out(tmp_path):
    """As where memory runs out: the others are computed, and the sweep is not sealed without it."""
    template, target = Traced(tmp_path / "trace", "lsp", deadly="12 rpm"), tmp_path / "a.nc"
    told = r"^point 2 \(loads.ring.speed=12 rpm\): the process was killed .* run the same command again to go on"
    with pytest.raises(MachineError, match=rf"{told}.*leave out .* with --skip 2; 4 of 5 rows are kept"):
        sweep(template, GRID, target, t_end=0.02, workers=2)
    assert not target.exists()
    assert load_sweep(part_of(target))["point"].values.tolist() == [0, 1, 3, 4]
    summary = sweep(template, GRID, target, t_end=0.02, workers=2, skip=[2, 3])
    assert (summary["computed"], summary["kept"]) == (0, 4)
    assert summary["reasons"] == {"left out by --skip": 1}
    summary = sweep(Template("lsp"), GRID, target, t_end=0.02, workers=1, retry=True)
    assert (summary["computed"], summary["kept"], summary["failed"]) == (1, 4, 0)
    once = Traced(tmp_path / "other", "lsp", deadly="12 rpm", times=1)
    assert sweep(once, GRID, tmp_path / "b.nc", t_end=0.02, workers=2)["failed"] == 0
    assert_equal(load_sweep(target), load_sweep(tmp_path / "b.nc"))


def test_a_torn_row_is_computed_again(tmp_path, whole):
    target = tmp_path / "a.nc"

    def stop(stage, done, total, failed):
        if done == 20:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        sweep(Template("lsp"), VARY, target, workers=1, told=stop, **DRAWN)
    data = part_of(target).read_bytes()
    part_of(target).write_bytes(data + data[-77:])  # half of a row whose count was not written
    assert sweep(Template("lsp"), VARY, target, workers=1, **DRAWN)["kept"] == 20
    assert_equal(load_sweep(target), whole)


# --- points that fail


class Unpickled(Template):
    """A maker that no other process can make."""

    def __reduce__(self):
        return (int, ("no number",))


def test_a_worker_that_cannot_begin_is_no_row(tmp_path):
    with pytest.raises(LtcgearError, match="a worker cannot use what makes the models: ValueError"):
        sweep(Unpickled("lsp"), VARY, tmp_path / "a.nc", **{**FEW, "workers": 2})
    assert count(tmp_path / "a.nc") == 0


def test_a_scene_that_is_wrong_at_a_point_is_a_row(tmp_path):
    disc = "stages.lsp.planet.disc"
    crossed = (f"{disc}.inner_diameter=400 mm,700 mm", f"{disc}.outer_diameter=600 mm,768 mm")
    summary = sweep(Template("lsp"), crossed, tmp_path / "a.nc", t_end=0.02, workers=1)
    found = load_sweep(tmp_path / "a.nc")
    bad = (found[crossed[0].split("=")[0]] > found[crossed[1].split("=")[0]]).values
    assert bad.tolist() == [False, False, True, False]
    assert [status != "done" for status in found["status"].values] == bad.tolist()
    assert np.isnan(found["mesh_force_mean"]).all("mesh").values.tolist() == bad.tolist()
    [(reason, number)] = summary["reasons"].items()
    assert (number, summary["failed"]) == (1, 1)
    assert "inner_diameter" in reason


@pytest.mark.parametrize("how", ["equilibrium", "status", "bug"])
def test_a_run_that_fails_is_a_row_with_its_reason(tmp_path, monkeypatch, how):
    reason = {"equilibrium": "no equilibrium", "status": "stopped at t = 0.01 s: steps", "bug": "ValueError: odd"}[how]

    def failing(library, values, **options):
        result = simulate(library, values, **options)
        if abs(values["reference.speed"]) < 1:
            return result
        if how == "equilibrium":
            raise SolverError(reason)
        if how == "bug":
            raise ValueError("odd")
        return type(result)(result.dataset, result.summary | {"status": reason})

    monkeypatch.setattr(task, "simulate", failing)
    sweep(Template("lsp"), ["loads.ring.speed=5 rpm,20 rpm"], tmp_path / "a.nc", t_end=0.02, workers=1)
    assert load_sweep(tmp_path / "a.nc")["status"].values.tolist() == ["done", reason]


# --- structure


def test_an_effect_on_an_axis_is_compiled_once_per_variant(tmp_path, monkeypatch):
    monkeypatch.setenv("LTCGEAR_CACHE", str(tmp_path / "store"))
    vary = ("effects.gravity=off,on", "loads.wheel.torque=100 N*m:200 N*m:4")

    def kept(folder):
        return {path.name: path.stat().st_mtime_ns for path in (models.root() / folder).iterdir()}

    summary = sweep(Template("psh"), psh(vary), tmp_path / "a.nc", t_end=0.02, workers=2, metrics=["energy_residual"])
    assert (summary["points"], summary["failed"]) == (8, 0)
    derived, compiled = kept("models"), kept("libraries")
    assert len(derived) == 2
    sweep(Template("psh"), psh(vary), tmp_path / "b.nc", t_end=0.02, workers=2, metrics=["energy_residual"])
    assert (kept("models"), kept("libraries")) == (derived, compiled)
    assert_equal(load_sweep(tmp_path / "a.nc"), load_sweep(tmp_path / "b.nc"))


def psh(vary):
    """The axes in the names of the scene at hand."""
    [name] = [key for key, load in Template("psh").raw["loads"].items() if "torque" in load]
    return [text.replace("loads.wheel", f"loads.{name}") for text in vary]


DISC = "stages.lsp.planet.disc"
PLANETS = {
    **{"stages.lsp.ring.teeth": "104", "stages.lsp.sun.teeth": "16", "stages.lsp.planet.teeth": "44"},
    **{f"{DISC}.outer_diameter": "500 mm", f"{DISC}.inner_diameter": "300 mm"},
}
"""A stage that takes two, three and four planets."""


def test_variants_with_other_items_share_a_row_and_a_late_one_is_built(tmp_path):
    """Planets over a range: 4 stands at no end of it, so its structure is found by the worker that meets it."""
    sweep(Template("lsp", PLANETS), ["stages.lsp.planets=2:4:3"], tmp_path / "a.nc", t_end=0.02, workers=1)
    found = load_sweep(tmp_path / "a.nc")
    assert found["status"].values.tolist() == ["done"] * 3
    carried = found["mesh_force_mean"].sel(mesh=[f"lsp.sun_planet.{k}" for k in range(1, 5)])
    assert np.isfinite(carried).sum("mesh").values.tolist() == [2, 3, 4]
    np.testing.assert_allclose(carried.sum("mesh"), float(carried.sum("mesh")[0]), rtol=2e-2)


def test_a_late_variant_that_cannot_be_built_is_told(tmp_path, monkeypatch):
    def failing(*arguments):
        raise LtcgearError("this variant has items that no other has")

    monkeypatch.setattr(sweeping, "find_places", failing)
    told, vary = [], ["stages.lsp.planets=2:4:3"]
    template = Template("lsp", PLANETS)
    sweep(template, vary, tmp_path / "a.nc", t_end=0.02, workers=1, told=lambda *now: told.append(now))
    assert told[-1] == ("simulate", 3, 3, 1)


def test_tables_are_read_once_and_go_along(tmp_path):
    (tmp_path / "torque.csv").write_text("time [s],torque [N*m]\n0,1e5\n1,2e5\n")
    scene = tmp_path / "mine.toml"
    text = Template("lsp").text.replace('torque = { value = "2.365e5 N*m"', 'torque_over_time = { value = "torque.csv"')
    scene.write_text(text)
    template = Template(scene)
    tables = template.make({})[2]
    assert tables
    (tmp_path / "torque.csv").unlink()
    assert template.make({"loads.ring.speed": "10 rpm"})[2] == tables
    with pytest.raises(SceneError, match="no such file"):
        Template(scene).make({})


# --- refusals

REFUSED = {
    "unknown key": (["loads.ring.sped=5 rpm:20 rpm"], {}, r'sped: unknown key; did you mean "speed"'),
    "unknown place": (["stages.lsp.position_errors.0.radial=0 um:1 um"], {}, "is no list yet, so it has no place 0"),
    "no unit": (["loads.ring.speed=5:20"], {}, "5.* has no unit"),
    "of all points": (["simulation.t_end=1 s:2 s"], {}, "is the same for all points; give --t-end"),
    "metric": (["loads.ring.speed=5 rpm:20 rpm"], {"metrics": ["forcs"]}, "no such metric"),
    "item": (["loads.ring.speed=5 rpm:20 rpm"], {"metrics": ["rms:mesh_force:lsp.x"]}, "lsp.x"),
    "too short": (["loads.ring.speed=5 rpm:20 rpm"], {"t_end": 2e-4}, "second half of a run has 1 samples"),
    "method": (["loads.ring.speed=5 rpm:20 rpm"], {"method": "euler"}, "euler"),
    "workers": (["loads.ring.speed=5 rpm:20 rpm"], {"workers": 0}, "must be 1 at least"),
    "many workers": (["loads.ring.speed=5 rpm:20 rpm"], {"workers": 100000}, "1024 at most"),
    "both": (["loads.ring.speed=5 rpm:20 rpm"], {"scheduler": "tcp://127.0.0.1:9"}, "a cluster has its own"),
    "no rate": (["loads.ring.speed=5 rpm:20 rpm"], {"rate": 0.0}, "rate 0: must be a number of samples a second"),
    "rate": (
        ["loads.ring.speed=5 rpm:20 rpm"],
        {"rate": float("nan")},
        "rate nan: must be a number of samples a second",
    ),
    "bound": (["stages.lsp.sun_planet.damping_ratio=-0.001:0.1"], {}, "damping_ratio"),
    "bad end": (["loads.ring.speed=5 rpm:20 rpm", "stages.lsp.sun_planet.damping_ratio=-1:2"], {}, "damping_ratio"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_wrong_is_refused_before_any_run(tmp_path, monkeypatch, name):
    vary, options, reason = REFUSED[name]
    monkeypatch.setattr(sweeping, "compute_points", lambda *_: pytest.fail("computed"))
    with pytest.raises(LtcgearError, match=reason):
        sweep(Template("lsp"), vary, tmp_path / "a.nc", **{**FEW, **options})
    assert not list(tmp_path.iterdir())


def test_what_the_scene_has_wrong_is_not_laid_to_an_axis(tmp_path):
    scene = Template("lsp", {"stages.lsp.sun.mass": "0 kg"})
    with pytest.raises(LtcgearError, match=r"^lsp: 1 defect\n  stages.lsp.sun.mass"):
        sweep(scene, VARY, tmp_path / "a.nc", **FEW)


def test_no_more_processes_than_points(tmp_path):
    options = {**FEW, "workers": 7, "sample": "grid", "points": None}
    assert sweep(Template("lsp"), ["loads.ring.speed=5 rpm:6 rpm:2"], tmp_path / "a.nc", **options)["workers"] == 2


def test_a_scheduler_that_is_not_there_is_told(tmp_path, monkeypatch):
    cluster = pytest.importorskip("ltcgear.runtime.studies.sweep.cluster")
    monkeypatch.setattr(cluster, "PATIENCE", 0.5)
    with pytest.raises(LtcgearError, match=r"--scheduler tcp://127.0.0.1:9: cannot be reached .*start one with"):
        sweep(Template("lsp"), VARY, tmp_path / "a.nc", **{**FEW, "workers": None}, scheduler="tcp://127.0.0.1:9")


def test_an_encrypted_scheduler_without_certificates_is_told(tmp_path, monkeypatch):
    cluster = pytest.importorskip("ltcgear.runtime.studies.sweep.cluster")
    monkeypatch.setattr(cluster, "PATIENCE", 0.5)
    with pytest.raises(LtcgearError, match=r"--scheduler tls://127.0.0.1:9: cannot be reached \(TLS .*configuration"):
        sweep(Template("lsp"), VARY, tmp_path / "a.nc", **{**FEW, "workers": None}, scheduler="tls://127.0.0.1:9")


@pytest.mark.parametrize("address", ["", "nope", "tcp://", "foo://bar:1", "a b:1", "tcp://here:port"])
def test_what_is_no_address_is_refused_at_once(tmp_path, address):
    with pytest.raises(LtcgearError, match="is no address such as tcp://"):
        sweep(Template("lsp"), VARY, tmp_path / "a.nc", **{**FEW, "workers": None}, scheduler=address)


def test_rows_are_kept_where_the_file_cannot_be_written(tmp_path, monkeypatch):
    """As on a full disk: HDF5 then fails with a RuntimeError of NetCDF's."""
    write = xr.Dataset.to_netcdf

    def fail(self, *args, **options):
        if options.get("format") == "NETCDF3_64BIT":  # the rows under way
            return write(self, *args, **options)
        raise RuntimeError("NetCDF: HDF error")

    with monkeypatch.context() as full:
        full.setattr(xr.Dataset, "to_netcdf", fail)
        with pytest.raises(LtcgearError, match=r"HDF error; see to that .* then run the same command again to go on"):
            sweep(Template("lsp"), VARY, tmp_path / "a.nc", **FEW)
    assert [path.name for path in tmp_path.iterdir()] == ["a.part.nc"]
    assert sweep(Template("lsp"), VARY, tmp_path / "a.nc", **FEW)["computed"] == 0


@pytest.fixture(scope="module")
def stored(tmp_path_factory):
    """A small sweep that is done, and one that was stopped."""
    folder = tmp_path_factory.mktemp("stored")
    sweep(Template("lsp"), VARY[:1], folder / "done.nc", **FEW)

    def stop(stage, done, total, failed):
        if done == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        sweep(Template("lsp"), VARY[:1], folder / "stopped.nc", told=stop, **FEW)
    return folder


OTHER = {
    "t_end": ({}, {"t_end": 0.03}, "t_end 0.02 there, 0.03 here"),
    "rtol": ({}, {"rtol": 1e-7}, "rtol 1e-06 there, 1e-07 here"),
    "seed": ({}, {"seed": 1}, "seed 0 there, 1 here"),
    "sample": ({}, {"sample": "sobol", "points": 8}, "sample lhs there, sobol here"),
    "metrics": ({}, {"metrics": ["forces"]}, "other metrics|metrics forces, load_share there, forces here"),
    "number": ({"loads.sun.torque": "1e5 N*m"}, {}, r"loads.sun.torque"),
    "axis": ({}, {"vary": VARY[1:]}, "axis loads.sun.torque|other axis"),
}


@pytest.mark.parametrize("name", OTHER)
@pytest.mark.parametrize("file", ["done.nc", "stopped.nc"])
def test_the_file_of_another_sweep_is_refused(stored, name, file):
    changes, options, reason = OTHER[name]
    before = {path.name: path.read_bytes() for path in stored.iterdir()}
    options = {"vary": VARY[:1], **FEW, **options}
    with pytest.raises(LtcgearError, match=reason) as caught:
        sweep(Template("lsp", changes), target=stored / file, **options)
    assert "give another -o, or delete it" in str(caught.value)
    assert {path.name: path.read_bytes() for path in stored.iterdir()} == before


@pytest.mark.parametrize("name", ["source", "title"])
def test_loads_may_be_called_as_labels_are(tmp_path, name):
    """What is said of where numbers come from makes no other sweep, but a load's number does."""
    text = (SHIPPED / "lsp.toml").read_text("utf-8").replace("[loads.sun]", f"[loads.{name}]")
    (tmp_path / "one.toml").write_text(text.replace("brakes the clockwise sun", "brakes it"))
    (tmp_path / "two.toml").write_text(text)
    one, two = (Template(tmp_path / f"{which}.toml").entries() for which in ("one", "two"))
    other = Template(tmp_path / "two.toml", {f"loads.{name}.torque": "1e5 N*m"}).entries()
    assert one | {"scene": ""} == two | {"scene": ""}
    assert {key for key in other if other[key] != two.get(key)} == {f"loads.{name}.torque"}


def test_results_and_strange_files_are_no_sweeps(tmp_path, stored):
    template, target = Template("lsp"), tmp_path / "a.nc"
    _, values, tables = template.make({})
    save(simulate(build(template.obtain({})), values, t_end=0.01, rate=8192, tables=tables).dataset, target)
    with pytest.raises(LtcgearError, match=r"a\.nc: not a sweep; give another -o"):
        sweep(template, VARY, target, **FEW)
    target.write_bytes(b"nothing")
    with pytest.raises(LtcgearError, match="holds something else than a NetCDF file"):
        sweep(template, VARY, target, **FEW)
    with pytest.raises(LtcgearError, match=r"done\.nc: a sweep, not the result of one run"):
        load(stored / "done.nc")
    with pytest.raises(LtcgearError, match=r"b\.nc: no such file"):
        load_sweep(tmp_path / "b.nc")
    with pytest.raises(LtcgearError, match=r"name it .*b\.nc"):
        sweep(template, VARY, tmp_path / "b.zarr", **FEW)
