"""Ensembles: each run is to the last bit what it is alone, whatever goes on beside it; so are outputs read in C."""

import os
import signal
import subprocess
import sys
from threading import current_thread, main_thread
from threading import enumerate as threads

import numpy as np
import pytest
from ltcgear.generated import store
from ltcgear.generated.errors import CompileError, LtcgearError
from ltcgear.runtime import simulate_many
from ltcgear.runtime.model.building import build
from ltcgear.runtime.model.function import Kernel
from ltcgear.runtime.model.phase_wrapping import TURN, Clocks
from ltcgear.runtime.model.rows import Batch, over_time
from ltcgear.runtime.simulation import ensemble
from ltcgear.runtime.simulation.output_reader import outputs_of
from ltcgear.runtime.simulation.simulate import Run, simulate

from ..models import case
from .test_long_runs import QUICK
from .test_recording import assert_same, told

OPTIONS = {"t_end": 0.05, "rate": 8192.0, "method": "erk"}
SPEEDING = ("-loads.input.speed", 'loads.input.speed_over_time = [["0 s", "30 rpm"], ["0.05 s", "300 rpm"]]')


def loaded(c, factors, name="loads.output.torque"):
    """The model's values with one load times some factors."""
    values = c.model.values()
    return [values | {name: values[name] * factor} for factor in factors]


# --- against single runs


@pytest.mark.parametrize("workers", [1, 2, 5])
@pytest.mark.parametrize("name", ["psh", "lsp"])
def test_results_are_those_of_single_runs_in_order(name, workers):
    c = case(name)
    load = next(key for key, _ in c.library.manifest.parameters if key.startswith("loads.") and key.endswith("torque"))
    sets = loaded(c, [1.0, 0.6, 0.8, 1.1, 0.2, 0.9, 1.0], load)
    found = list(simulate_many(c.library, iter(sets), workers=workers, tables=c.model.tables, **OPTIONS))
    assert len(found) == len(sets)
    forces = []
    for values, one in zip(sets, found, strict=True):
        alone = simulate(c.library, values, tables=c.model.tables, **OPTIONS)
        assert one.summary["status"] == "done"
        assert_same(one.dataset, alone.dataset)
        assert told(one.summary) == told(alone.summary)
        forces.append(abs(one.dataset["mesh_force"].values).mean())
    assert len(set(forces)) == 6  # two sets are alike
    assert forces[0] == forces[-1]


@pytest.mark.parametrize("method", ["cvodes", "rosenbrock", "auto"])
def test_other_methods_run_one_after_the_other(method):
    """Rosenbrock's C counts its steps in one place for all runs."""
    c = case("psh")
    options = OPTIONS | {"method": method, "t_end": 0.01}
    sets = loaded(c, [1.0, 0.3, 0.7])
    for values, one in zip(sets, simulate_many(c.library, sets, workers=2, **options), strict=True):
        alone = simulate(c.library, values, **options)
        assert_same(one.dataset, alone.dataset)
        assert told(one.summary) == told(alone.summary)


def test_raw_samples_tables_and_attributes_are_those_of_a_single_run():
    c = case("psh", *SPEEDING)
    options = OPTIONS | {"raw": True, "attributes": {"scene": "psh"}, "tables": c.model.tables}
    [one] = simulate_many(c.library, [c.model.values()], **options)
    alone = simulate(c.library, c.model.values(), **options)
    assert_same(one.dataset, alone.dataset)
    assert one.dataset.attrs["scene"] == "psh"


def test_casadi_stays_in_the_calling_thread(monkeypatch):
    """Followed elsewhere, concluded here; no worker is left behind, nor does one call CasADi."""
    followed, called = [], []
    follow, evaluate, bind = Run.follow, Kernel.evaluate, Kernel.__init__

    def spy(method, log):
        return lambda self, *arguments: (log.append(current_thread()), method(self, *arguments))[1]

    monkeypatch.setattr(Run, "follow", spy(follow, followed))
    monkeypatch.setattr(Kernel, "evaluate", spy(evaluate, called))
    monkeypatch.setattr(Kernel, "__init__", spy(bind, called))
    c = case("psh")
    list(simulate_many(c.library, loaded(c, [1.0, 0.5, 0.7]), workers=2, **OPTIONS))
    assert len(followed) == 3
    assert main_thread() not in followed
    followed.clear()
    list(simulate_many(c.library, [c.model.values()], workers=2, **OPTIONS | {"method": "rosenbrock"}))
    assert followed == [main_thread()]
    assert set(called) == {main_thread()}
    assert not any(thread.name.startswith("ltcgear") for thread in threads())


# --- failures


def test_a_run_that_fails_leaves_the_others_alone():
    c = case("psh")
    values = c.model.values()
    loose = {name: 0.0 for name, unit in c.library.manifest.parameters if unit in ("N/m", "N*m/rad")}
    sets = [values, values | loose, values]
    first, lost, last = simulate_many(c.library, sets, workers=2, **OPTIONS)
    assert_same(first.dataset, last.dataset)
    assert lost.summary["status"] not in ("", "done")
    assert lost.summary["simulated_s"] == 0
    assert lost.dataset.sizes["time"] == 0
    assert set(lost.dataset.variables) | {"statistics", "statistic", "output", "output_unit"} == set(
        first.dataset.variables
    )
    assert lost.dataset.attrs["status"] == lost.summary["status"]
    assert first.summary.keys() - lost.summary.keys() == {"real_time_factor", "energy_residual", "static_strain_j"}


def test_a_run_that_breaks_off_keeps_what_it_has():
    """Negative damping lets vibrations grow without bound."""
    c = case("psh")
    values = c.model.values()
    driving = {name: -100 * values[name] for name in values if name.endswith(".damping")}
    sets = [values, values | driving, values]
    first, broken, last = simulate_many(c.library, sets, workers=2, **OPTIONS)
    assert first.summary["status"] == last.summary["status"] == "done"
    assert_same(first.dataset, last.dataset)
    assert "runs away" in broken.summary["status"]
    alone = simulate(c.library, sets[1], **OPTIONS)
    assert_same(broken.dataset, alone.dataset)
    assert broken.summary["status"] == alone.summary["status"]
    assert 1 < broken.dataset.sizes["time"] < first.dataset.sizes["time"]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"loads.output.torqe": 1.0}, r'set 1: loads\.output\.torqe: .*did you mean "loads\.output\.torque"\?'),
        ({"loads.output.torque": None}, r"set 1: loads\.output\.torque is missing; begin with the model's values"),
        ({"loads.output.torque": np.nan}, r"set 1: loads\.output\.torque = nan: must be a finite number \[N\*m\]"),
        ({"loads.output.torque": -np.inf}, "must be a finite number"),
        ({"loads.output.torque": "3 N*m"}, r"'3 N\*m': must be a finite number"),
    ],
)
def test_a_wrong_set_is_refused_before_anything_runs(monkeypatch, change, message):
    monkeypatch.setattr(ensemble, "Run", None)
    c = case("psh")
    values = {k: v for k, v in (c.model.values() | change).items() if v is not None}
    with pytest.raises(LtcgearError, match=message):
        simulate_many(c.library, [c.model.values(), values], **OPTIONS)


def test_wrong_options_are_refused_before_anything_runs():
    c = case("psh")
    sets = [c.model.values()]
    for options, message in (
        ({"workers": 0}, "workers 0: must be 1 at least"),
        ({"method": "euler"}, "method 'euler': unknown"),
        ({"rtol": 1.0}, "rtol 1: must lie between"),
        ({"t_end": 1e-9}, "shorter than one sample"),
    ):
        with pytest.raises(LtcgearError, match=message):
            simulate_many(c.library, sets, **OPTIONS | options)
    faults = [{} for _ in range(3)]
    with pytest.raises(LtcgearError, match=rf"and {3 * len(sets[0]) - 8} more$"):
        simulate_many(c.library, faults, **OPTIONS)
    assert list(simulate_many(c.library, [], **OPTIONS)) == []


# --- on the way


def test_progress_is_told_here_and_reaches_the_end():
    c, seen = case("psh"), []
    sets = loaded(c, [1.0, 0.5, 0.7])
    list(simulate_many(c.library, sets, told=lambda t: seen.append((t, current_thread())), workers=2, **OPTIONS))
    assert {thread for _, thread in seen} == {main_thread()}
    times = [time for time, _ in seen]
    assert times == sorted(times)
    assert times[-1] == pytest.approx(3 * OPTIONS["t_end"])


def test_results_come_while_others_run_and_no_more_than_are_asked_for(monkeypatch):
    begun = []
    monkeypatch.setattr(ensemble, "Run", lambda *a, **k: begun.append(1) or Run(*a, **k))
    c = case("psh")
    results = simulate_many(c.library, loaded(c, np.linspace(0.5, 1.0, 12)), workers=1, **OPTIONS)
    assert not begun
    next(results)
    assert len(begun) == 1 + ensemble.AHEAD
    results.close()
    assert len(begun) == 1 + ensemble.AHEAD
    assert not any(thread.name.startswith("ltcgear") for thread in threads())


def test_runs_that_nobody_waits_for_are_stopped(monkeypatch):
    c, times, ended, follow = case("lsp"), [], [], Run.follow
    monkeypatch.setattr(Run, "follow", lambda self, told: (follow(self, told), ended.append(self)))

    def impatient(time):
        times.append(time)
        raise KeyboardInterrupt

    options = OPTIONS | {"t_end": 100.0, "told": impatient}
    with pytest.raises(KeyboardInterrupt):
        next(simulate_many(c.library, [c.model.values()] * 3, workers=2, **options))
    assert len(times) == 1
    assert not ended
    assert not any(thread.name.startswith("ltcgear") for thread in threads())


PROGRAM = """
import sys
from ltcgear.runtime import build, simulate_many
from ltcgear.symbolic.assembly import build_model
from ltcgear.symbolic.emit.pipeline import obtain
from ltcgear.symbolic.scene.load import load_scene
model = build_model(load_scene("lsp"))
library = build(obtain(model))
options = {"t_end": 100.0, "rate": 8192.0, "method": sys.argv[1], "told": lambda time: print("running", flush=True)}
try:
    list(simulate_many(library, [model.values()] * 4, workers=2, **options))
except KeyboardInterrupt:
    print("stopped")
"""


@pytest.mark.parametrize("method", ["erk", "cvodes"])
def test_ctrl_c_stops_all(method):
    case("lsp")
    program = subprocess.Popen(
        [sys.executable, "-c", PROGRAM, method], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert program.stdout.readline() == "running\n"
    os.kill(program.pid, signal.SIGINT)
    told, faults = program.communicate(timeout=120)
    assert told.splitlines()[-1] == "stopped"
    assert program.returncode == 0, faults


# --- outputs in C


@pytest.mark.parametrize("name", ["outputs", "energy", "rhs", "borders"])
def test_a_batch_gives_what_single_calls_give(name):
    c = case("psh", 'effects.contact = "backlash"')
    path = c.run(method="erk", t_end=0.02)
    kernel = Kernel(c.library.functions[name])
    found = over_time(c.library, name, path.x, path.s, c.p)
    wanted = np.array([kernel(x, s, c.p)[0].copy() for x, s in zip(path.x, path.s, strict=True)])
    assert len(found) > 100
    assert (found == wanted).all()
    several = over_time(c.library, name, path.x[:9:2], path.s[0], np.tile(c.p, (5, 1)))
    assert (several == over_time(c.library, name, path.x[:9:2], np.tile(path.s[0], (5, 1)), c.p)).all()


def test_outputs_follow_the_turns_that_were_taken_off():
    c = case(*QUICK["lsp, single teeth"])
    path, clocks = c.run(method="erk", t_end=0.9, rate=512.0), Clocks(c.library.manifest, c.p)
    assert len(np.unique(path.turns)) > 1
    kernel, angle = Kernel(c.library.functions["outputs"]), c.state("reference.angle")
    found = clocks.outputs(Batch(c.library, "outputs"), path.x, path.s, path.phi, path.turns)
    for k in range(0, len(path.time), 7):
        x = path.x[k].copy()
        x[angle] = path.phi[k]
        assert (kernel(x, path.s[k], clocks.parameters(int(path.turns[k])))[0] == found[k]).all()
    assert len({clocks.parameters(turns).tobytes() for turns in range(3)}) == 3
    assert path.x[-1, angle] > 2 * TURN  # the samples themselves are left as they are
    phases = [i for i, report in enumerate(c.library.manifest.reports) if report.quantity == "mesh_phase"]
    assert np.ptp(outputs_of(c.library, clocks, path)[:, phases], axis=0) == pytest.approx(
        4.5 * 118 * np.ones(len(phases)), rel=1e-3
    )


def test_arrays_that_do_not_fit_are_refused():
    c = case("psh")
    states, levels = len(c.library.manifest.states), len(c.library.manifest.levels)
    x, s = np.zeros((3, states)), np.zeros((3, levels))
    assert over_time(c.library, "outputs", x, s, c.p).shape == (3, len(c.library.manifest.reports))
    for wrong in ((x[:, 1:], s, c.p), (x[:2], s, c.p), (x[0], s[0], c.p), (x, s, c.p[1:]), (x, s), (x, c.p, s)):
        with pytest.raises(ValueError, match="outputs takes rows of"):
            over_time(c.library, "outputs", *wrong)


def test_without_a_compiler_outputs_are_not_read(monkeypatch):
    monkeypatch.setattr(store, "compiler", lambda: None)
    library = build(case("psh").library.artifact)
    with pytest.raises(CompileError, match="needs a C compiler"):
        Batch(library, "outputs")
