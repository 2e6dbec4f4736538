"""FMUs in FMPy: what they compute is what `simulate` computes."""

import fmpy
import numpy as np
import pytest
from fmpy.validation import validate_fmu
from ltcgear.runtime.export.fmu.names import structure
from ltcgear.runtime.model.function import Kernel

from ..instances import FORCES, STEP, set_states
from ..rattling import SAMPLES, SPEED, T_END, TORQUE, steer


@pytest.fixture(scope="module")
def ours(pair):
    """Simulate it here."""
    return pair.simulate()


def run(path, **options):
    """Simulate in FMPy."""
    names = [*FORCES, "switchings", "regime_changes", "time", "pair.output.angle"]
    settings = {"start_time": 0.0, "stop_time": T_END, "output_interval": STEP, "output": names, "record_events": False}
    return fmpy.simulate_fmu(str(path), **settings | {"relative_tolerance": 1e-11, "timeout": 60} | options)


def missed(found, result):
    """Return the largest difference of the mesh forces, over the mean of the loaded one."""
    forces = result.dataset["mesh_force"].sel(mesh=list(FORCES.values())).values
    theirs = np.array([found[name] for name in FORCES]).T
    assert theirs.shape == forces.shape
    return np.abs(theirs - forces).max() / forces[:, 0].mean()


@pytest.mark.parametrize("kind", ["cs", "me"])
def test_forces_are_those_of_simulate(kind, ours, request):
    found, counts = run(request.getfixturevalue(kind)), ours.summary["counts"]
    assert missed(found, ours) < (1e-8 if kind == "cs" else 1e-6)
    assert found["switchings"][-1] == counts["events"] > 25
    assert found["regime_changes"][-1] == counts["regimes"] > 20  # teeth part and meet again
    assert found["pair.output.angle"] == pytest.approx(ours.rotor["pair.output"].angle.values, rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("kind", ["cs", "me"])
def test_a_changed_parameter_is_met(kind, pair, ours, request):
    changes = {"pair.mesh.stiffness_double": 2.2e8, "pair.output.inertia": 0.05}
    found = run(request.getfixturevalue(kind), start_values=changes)
    assert missed(found, pair.simulate(changes)) < 1e-5
    assert missed(found, ours) > 0.1


def test_a_planetary_stage(folder):
    stage = steer("lsp")
    stage.write(folder / "lsp.fmu", t_end=0.05, rate=8192)
    assert validate_fmu(str(folder / "lsp.fmu")) == []
    result = stage.simulate(t_end=0.05, rate=8192, rtol=1e-6)
    forces = result.dataset["mesh_force"].values
    names = [f"{structure(mesh)}.mesh_force" for mesh in result.dataset.mesh.values]
    found = fmpy.simulate_fmu(
        str(folder / "lsp.fmu"), stop_time=410 / 8192, output_interval=1 / 8192, output=names, relative_tolerance=1e-6
    )
    theirs = np.array([found[name] for name in names]).T
    assert np.abs(theirs - forces).max() < 1e-4 * forces.mean()
    assert names[2] == "lsp.sun_planet[2].mesh_force"


def test_a_torque_that_steps(cs, pair, make):
    instance = make(cs).initialise()
    first = instance.step(0, 200)
    instance["loads.brake.torque"] = -300.0
    forces = np.vstack([first, instance.step(200, 200)])
    rows = ((0.0, -150.0), (200 * STEP, -150.0), (200 * STEP + 1e-12, -300.0))
    ours = pair.simulate(tables={TORQUE: rows}).dataset["mesh_force"].values
    assert np.abs(forces - ours[1:]).max() < 1e-6 * ours[:, 0].mean()
    assert instance["loads.brake.torque"] == -300.0


def test_a_step_that_ends_on_a_jump(cs, pair, make):
    speed = 1500 / 60 * 2 * np.pi  # the phase is 12.4 at sample 320, where single contact ends
    forces = make(cs).initialise(**{"loads.motor.speed": speed}).step(0, SAMPLES)
    ours = pair.simulate(tables={SPEED: ((0.0, speed), (1.0, speed))}).dataset
    assert ours["mesh_phase"].values[320] == pytest.approx(12.4, abs=1e-12)
    assert np.abs(forces - ours["mesh_force"].values[1:]).max() < 1e-6 * forces[:, 0].mean()


def test_a_speed_is_reached_at_the_end_of_a_step(cs, pair, make):
    instance, rated = make(cs).initialise(), pair.tables[SPEED][0][1]
    speed = np.interp(np.arange(1, SAMPLES + 1) * STEP, [0.004, 0.012], [rated, 1.2 * rated])
    forces = []
    for k, value in enumerate(speed):
        instance["loads.motor.speed"] = value
        forces.append(instance.step(k)[0])
    ours = pair.simulate(tables={SPEED: ((0.0, rated), (0.004, rated), (0.012, 1.2 * rated))})
    assert np.abs(np.array(forces) - ours.dataset["mesh_force"].values[1:]).max() < 2e-6 * 1500
    assert instance["pair.input.speed"] == pytest.approx(1.2 * rated)


def test_loads_over_time_stay_inside(pair, folder):
    rated = pair.tables[SPEED][0][1]
    pair_of_tables = {
        SPEED: ((0.0, rated), (0.0021, rated), (0.0123, 1.1 * rated)), TORQUE: ((0.0, -150.0), (0.011, -400.0)),
    }  # fmt: skip
    pair.write(folder / "tables.fmu", kind="model-exchange", tables=pair_of_tables, inputs=())
    assert not [v for v in fmpy.read_model_description(folder / "tables.fmu").modelVariables if v.causality == "input"]
    ours = pair.simulate(tables=pair_of_tables)
    assert missed(run(folder / "tables.fmu"), ours) < 1e-4
    assert missed(run(folder / "tables.fmu", start_values={"pair.mesh.backlash": 1e-4}), ours) < 1e-4


def test_what_is_asked_early_does_not_stay(cs, make):
    instance = make(cs)
    assert instance["pair.output.u"] != 0  # in the equilibrium that was found for it
    instance.fmu.setupExperiment(startTime=0.25)
    assert instance["time"] == 0.25
    instance.fmu.enterInitializationMode()
    instance.fmu.exitInitializationMode()
    instance.fmu.doStep(0.25, STEP)
    assert instance["time"] == 0.25 + STEP


def test_a_tolerance_beyond_the_ends_is_the_nearest(cs, make):
    told = (1e-14, 1e-13, 1e-6, 0.1, 10.0, 0.0, -1.0, float("nan"))
    found = [make(cs).initialise(tolerance=rtol).step(0, 20).tolist() for rtol in told]
    assert found[0] == found[1]
    assert found[3] == found[4]
    assert found[5] == found[6] == found[7] == found[2]  # the default
    assert len({str(forces) for forces in found}) == 3


def test_rates_are_those_of_the_equations(me, pair, make):
    instance = make(me).initialise()
    rhs, rng = Kernel(pair.library.functions["rhs"]), np.random.default_rng(0)
    p = pair.library.parameters(pair.values)
    names = [signal.name for signal in pair.library.manifest.signals]
    states = [structure(state.name) for state in pair.library.manifest.states]
    instance.fmu.updateDiscreteStates()
    instance.fmu.enterContinuousTimeMode()
    for _ in range(20):
        inputs = {"speed": rng.normal(100), "acceleration": rng.normal(50), "torque": rng.normal(-100)}
        for name, value in inputs.items():
            instance[f"loads.{'brake' if name == 'torque' else 'motor'}.{name}"] = value
        x = np.array([instance[name] for name in states]) * (1 + 1e-3 * rng.standard_normal(len(states)))
        set_states(instance, x)
        levels = [instance_level(instance)]
        s = [*levels, *(inputs[name.rpartition(".")[2]] for name in names)]
        theirs = np.array([instance[f"der({name})"] for name in states])
        assert theirs == pytest.approx(rhs(x, np.array(s), p)[0], rel=1e-12)


def instance_level(instance):
    """Return the level that the pair is held at: 1 in the longer cells, of 0.6 cycles, 0 in the others."""
    length = instance["pair.mesh.border_ahead"] + instance["pair.mesh.border_behind"]
    assert min(abs(length - 0.6), abs(length - 0.4)) < 1e-6
    return float(length > 0.5)


def test_nothing_chatters(me, make):
    instance, rng = make(me).initialise(), np.random.default_rng(1)
    indicators = [v.name for v in instance.description.modelVariables if ".border" in v.name]
    states = [instance["reference.angle"], instance["pair.output.u"], instance["pair.output.u_rate"]]
    changed = 0
    for _ in range(300):
        at_border = rng.integers(0, 5) / 31 * 2 * np.pi * rng.choice([1.0, 0.4]) + rng.normal(0, 1e-9)
        x = [at_border, states[1] + rng.normal(0, 1e-3), states[2] + rng.normal(0, 3.0)]
        instance.fmu.enterContinuousTimeMode()
        set_states(instance, x)
        before = np.array([instance[name] for name in indicators])
        instance.fmu.enterEventMode()
        instance.fmu.updateDiscreteStates()
        after = np.array([instance[name] for name in indicators])
        changed += (before < 0).any()
        assert (after > 0).all()
        count = instance["switchings"], instance["regime_changes"]
        instance.fmu.updateDiscreteStates()
        assert (instance["switchings"], instance["regime_changes"]) == count
        assert np.array_equal(after, [instance[name] for name in indicators])
    assert changed > 50


def test_instances_do_not_disturb_each_other(cs, make):
    alone = make(cs).initialise().step(0, 100)
    one, other = make(cs).initialise(), make(cs).initialise(**{"pair.mesh.stiffness_single": 1.5e8})
    found, others = np.array([(one.step(k)[0], other.step(k)[0]) for k in range(100)]).transpose(1, 0, 2)
    assert np.array_equal(found, alone)
    assert np.abs(others - alone).max() > 100


STATISTICS = [f"pair.mesh.mesh_force_{name}" for name in ("mean", "rms", "min", "max")]


def test_means_over_steps_are_those_of_statics(cs):
    periods, steps, torque = 40, 4, -1500.0  # samples fall on four phases of a tooth pair
    frequency = 800.0
    options = {"stop_time": 4 * periods / frequency, "output_interval": 1 / (steps * frequency)}
    values = {"loads.brake.torque": torque, "loads.motor.speed": 2 * np.pi * frequency / 31}
    names = ["pair.mesh.mesh_force", *STATISTICS]
    found = run(cs, **options, start_values=values, output=names, relative_tolerance=1e-8)[-periods * steps :]
    sampled, mean, rms, low, high = (found[name] for name in names)
    static = abs(torque) / (0.004 * 43 / 2 * np.cos(np.radians(20)))
    assert abs(sampled.mean() / static - 1) > 1e-4
    assert mean.mean() == pytest.approx(static, rel=1e-6)
    assert (low < mean).all()
    assert (mean < rms).all()
    assert (rms < high).all()
    assert low.min() < sampled.min() < sampled.max() <= high.max()


def test_statistics_begin_with_the_instant_and_are_kept(cs, make):
    one, other = make(cs).initialise(), make(cs).initialise()
    force = one["pair.mesh.mesh_force"]
    assert [one[name] for name in STATISTICS] == [force, abs(force), force, force]
    one.fmu.doStep(0.0, 100 * STEP)
    told, data = [one[name] for name in STATISTICS], one.state("serialize", kept := one.state("get"))
    one.state("free", kept)
    moved = other.state("deserialize", data)
    other.state("set", moved)
    other.state("free", moved)
    assert [other[name] for name in STATISTICS] == told
    assert told[2] < told[0] < told[3]
    for instance in (one, other):
        instance.fmu.doStep(100 * STEP, 50 * STEP)
    assert [other[name] for name in STATISTICS] == [one[name] for name in STATISTICS] != told


def test_a_reset_begins_again(cs, make):
    instance = make(cs).initialise(**{"pair.output.inertia": 0.05})
    instance.step(0, 20)
    instance.fmu.reset()
    again = instance.initialise().step(0, 20)
    assert np.array_equal(again, make(cs).initialise().step(0, 20))


def test_steps_may_differ(cs, ours, make):
    instance, time = make(cs).initialise(), 0.0
    for k in (3, 7, 50, 200):
        instance.fmu.doStep(time, k * STEP - time)
        time = k * STEP
        force = ours.dataset["mesh_force"].sel(mesh="pair.mesh").values[k]
        assert instance["pair.mesh.mesh_force"] == pytest.approx(force, rel=1e-6)
