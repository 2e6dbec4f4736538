"""Choice of the method: stability and steps against what the integrators really take, the cost against the best."""

from dataclasses import replace

import numpy as np
import pytest
from ltcgear.runtime.model.equilibrium import find_equilibrium
from ltcgear.runtime.model.operating_point import OperatingPoint
from ltcgear.runtime.simulation.choose_method import (
    GROWTH,
    TIMES,
    choose,
    excited_rates,
    reckon,
    stability_rate,
    step_operations,
)
from ltcgear.runtime.simulation.duty import list_duty
from ltcgear.runtime.simulation.methods.registry import METHODS
from ltcgear.runtime.simulation.run_settings import RunSettings
from ltcgear.runtime.simulation.simulate import simulate

from .. import butcher, exact
from ..models import case

LOAD = "loads.output.torque_over_time"
STILL = ('effects.mesh_stiffness = "mean"', 'effects.transmission_error = "off"')
"""Nothing that varies with the mesh phase."""
BEARING = 'stages.lsp.ring.bearing.stiffness = "{} N/m"'
SCENES = {
    "lsp": ("lsp",),
    "bearing x 1e4": ("lsp", BEARING.format("2.6e13")),
    "bearing x 1e6": ("lsp", BEARING.format("2.6e15")),
    "torsional": ("psh", *exact.SETTINGS),
    "no excitation": ("lin-parker-4",),
    "from rest": (
        "start-up",
        'effects.mesh_friction = "sliding"',
        "stages.pair.mesh.friction.coefficient = 0.05",
        'stages.pair.mesh.friction.speed = "1e-4 m/s"',
    ),
}


def operations(c, method, rtol):
    """The operations that a run really takes, by its counts."""
    path = c.run(method=method, rtol=rtol, t_end=0.1)
    assert path.status == "done"
    step = dict(zip(("erk", "rosenbrock"), step_operations(c.library), strict=True))[method]
    return (path.counts.steps + path.counts.rejected) * step + path.counts.segments * METHODS[method].segment_operations


@pytest.mark.parametrize("rtol", [1e-4, 1e-6])
@pytest.mark.parametrize("name", sorted({*SCENES} - {"no excitation"}))  # any method is done with it at once
def test_the_choice_costs_twice_the_best_at_most(name, rtol):
    c = case(*SCENES[name])
    chosen = choose(c.point, RunSettings(0.1, rtol=rtol, tables=c.model.tables))
    cost = {method: operations(c, method, rtol) for method in ("erk", "rosenbrock")}
    assert cost[chosen.method] < 2 * min(cost.values())


@pytest.mark.parametrize(
    ("name", "method"), [("lsp", "erk"), ("bearing x 1e6", "rosenbrock"), ("no excitation", "erk")]
)
def test_both_methods_are_chosen(name, method):
    c = case(*SCENES[name])
    assert choose(c.point, RunSettings(0.1, rtol=1e-4, tables=c.model.tables)).method == method


@pytest.mark.parametrize("t_end", [0.5, 1.5])
def test_a_start_from_rest_is_reckoned_by_the_time_at_each_speed(t_end):
    """At rest friction is steepest and no teeth come and go; a run that leaves it is not to be reckoned by that."""
    c = case(*SCENES["from rest"])
    pace = reckon(c.point, settings := RunSettings(t_end, rtol=1e-5, tables=c.model.tables))
    counts = c.run(method="erk", rtol=1e-5, t_end=t_end).counts
    assert t_end * pace.explicit == pytest.approx(counts.steps, rel=0.6)
    if t_end > 1:
        assert choose(c.point, settings).method == "erk"
    assert choose(c.point, replace(settings, t_end=0.1)).method == "rosenbrock"


def test_the_duty_is_the_time_at_each_speed():
    """The motor waits for 0.1 s, then runs up linearly for 1 s, and turns on."""
    c = case("start-up")
    parts = list_duty(c.point, RunSettings(2.0, tables=c.model.tables))
    place = [signal.name for signal in c.library.manifest.signals].index("reference.speed")
    speeds = np.array([part.point.at.signals[place] for part in parts])
    shares = np.array([part.share for part in parts])
    top = speeds.max()
    assert shares.sum() == pytest.approx(1.0)
    assert shares[speeds == 0].sum() == pytest.approx(0.05, abs=1e-6)
    assert shares[speeds > 0.6 * top].sum() == pytest.approx((0.4 + 0.9) / 2, abs=2e-3)
    assert shares @ speeds == pytest.approx(top * (0.5 + 0.9) / 2, rel=0.1)


def test_a_load_over_time_sets_the_model_going():
    c = case("hard-dead-band", *STILL)
    flat, stepped = [(0.0, 70.0)], [(0.0, 70.0), (0.05, 70.0), (0.0501, 90.0)]
    tables = {"loads.input.speed_over_time": [(0.0, 100.0)], LOAD: flat}
    point = OperatingPoint(c.library, c.p, find_equilibrium(c.library, c.p, tables=tables))
    settings = RunSettings(0.1, rtol=1e-6, tables=tables)
    assert "nothing sets the model going" in choose(point, settings).why
    chosen = choose(point, replace(settings, tables=tables | {LOAD: stepped}))
    assert "accuracy calls for" in chosen.why
    slow = [(0.0, 70.0), (1e3, 90.0)]
    courses = [replace(settings, tables=tables | {LOAD: rows}) for rows in (flat, slow, stepped)]
    paces = [reckon(point, course).stiff for course in courses]
    assert 0 == paces[0] < paces[1] < 0.5 * paces[2]  # a load that creeps hardly does


def test_a_model_at_rest_that_explicit_steps_could_not_wait_for_gets_the_stiff_method():
    c = case("hard-tiny-inertia")
    assert choose(c.point, RunSettings(10.0, rtol=1e-6)).method == "rosenbrock"
    assert simulate(c.library, c.model.values(), t_end=10.0, rate=64.0).summary["status"] == "done"


def test_the_stability_bound_is_that_of_the_explicit_pair():
    # By the order conditions all but the last coefficient are those of exp; the last one is b A^5 1.
    assert pytest.approx(butcher.growth(), rel=1e-12) == GROWTH.coef
    assert 1 / stability_rate(np.array([-1.0 + 0j])) == pytest.approx(3.5, abs=0.02)
    assert 1 / stability_rate(np.array([1j, -1j])) == pytest.approx(0.97, abs=0.02)


def test_a_stiff_run_takes_the_steps_that_stability_asks_for():
    c = case(*SCENES["bearing x 1e6"])
    values, _ = excited_rates(c.point, 1e-4)
    steps = c.run(method="erk", rtol=1e-4, t_end=0.02).counts.steps
    assert steps == pytest.approx(0.02 * stability_rate(values), rel=0.25)


@pytest.mark.parametrize("rtol", [1e-4, 1e-6, 1e-8])
@pytest.mark.parametrize("name", ["lsp", "torsional"])
def test_other_runs_take_the_steps_that_accuracy_asks_for(name, rtol):
    c = case(*SCENES[name])
    rates = excited_rates(c.point, rtol)[1]
    steps = c.run(method="erk", rtol=rtol, t_end=0.1).counts.steps
    assert 0.1 * np.trapezoid(rates, TIMES) == pytest.approx(steps, rel=0.5)


def test_simulate_says_what_it_used_and_why():
    c = case("psh")
    values, options = c.model.values(), {"t_end": 0.01, "rate": 8192.0}
    summary = simulate(c.library, values, **options).summary
    assert summary["method"] == "erk"
    assert "eigenvalue" in summary["why"]
    assert simulate(c.library, values, method="cvodes", **options).summary["why"] is None
