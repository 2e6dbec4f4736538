"""FMUs in FMPy: what they compute is what `simulate` computes, and what they refuse they refuse with a status."""

import gc
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE
from fmpy.fmi3 import FMU3Model
from fmpy.validation import validate_fmu
from ltcgear.runtime.fmu.names import structure
from ltcgear.runtime.kernel import Kernel

from .rattling import RATE, SAMPLES, SCENE, SPEED, T_END, TORQUE, steer

ERROR, DISCARD = 3, 2
STEP = 1 / RATE
FORCES = {"pair.mesh.mesh_force": "pair.mesh", "pair.mesh.back.mesh_force": "pair.mesh.back"}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Make a folder for all of it."""
    return tmp_path_factory.mktemp("fmu")


@pytest.fixture(scope="module")
def pair(folder):
    """Load the pair that rattles."""
    (folder / "rattle.toml").write_text(SCENE)
    return steer(folder / "rattle.toml")


@pytest.fixture(scope="module")
def cs(folder, pair):
    """Write it for co-simulation."""
    pair.write(folder / "cs.fmu")
    return folder / "cs.fmu"


@pytest.fixture(scope="module")
def me(folder, pair):
    """Write it for model exchange."""
    pair.write(folder / "me.fmu", kind="model-exchange")
    return folder / "me.fmu"


@pytest.fixture(scope="module")
def ours(pair):
    """Simulate it here."""
    return pair.simulate()


class Instance:
    """An instance of an FMU, variables by name."""

    def __init__(self, path, unzipped):
        self.description = fmpy.read_model_description(path)
        self.reference = {v.name: v.valueReference for v in self.description.modelVariables}
        kinds = {"2.0": (FMU2Slave, "coSimulation"), "3.0": (FMU3Model, "modelExchange")}
        kind, part = kinds[self.description.fmiVersion]
        self.two = kind is FMU2Slave
        names = {"guid": self.description.guid, "unzipDirectory": str(unzipped), "instanceName": "gears"}
        self.fmu = kind(modelIdentifier=getattr(self.description, part).modelIdentifier, **names)
        self.said = []
        self.instantiate()

    def instantiate(self):
        """Make it."""
        if self.two:

            def log(component, name, status, category, message):
                self.said.append((status, message.decode()))

            self.logger = fmi2CallbackLoggerTYPE(log)
            self.callbacks = fmi2CallbackFunctions()
            self.callbacks.logger = self.logger
            self.fmu.instantiate(callbacks=self.callbacks)
        else:
            self.fmu.instantiate()

    def initialise(self, tolerance=1e-9, **values):
        """Set values and find the equilibrium."""
        if self.two:
            self.fmu.setupExperiment(tolerance=tolerance)
        else:
            self.fmu.enterInitializationMode(tolerance=tolerance)
        for name, value in values.items():
            self[name] = value
        if self.two:
            self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()
        return self

    def __getitem__(self, name):
        get = self.fmu.getReal if self.two else self.fmu.getFloat64
        return get([self.reference[name]])[0]

    def __setitem__(self, name, value):
        setter = self.fmu.setReal if self.two else self.fmu.setFloat64
        setter([self.reference[name]], [value])

    def step(self, number, count=1):
        """Go on over communication steps from one on; return the mesh forces after each."""
        found = []
        for k in range(number, number + count):
            self.fmu.doStep(k * STEP, STEP)
            found.append([self[name] for name in FORCES])
        return np.array(found)

    def state(self, what, *values):
        """Call a function of FMU states, whose names FMPy writes differently in both versions."""
        found = {name.lower(): name for name in dir(self.fmu)}
        return getattr(self.fmu, found[f"{what}fmustate"])(*values)

    def close(self):
        """Free it."""
        self.fmu.freeInstance()


@pytest.fixture(scope="module")
def unzipped(cs, me, folder):
    """Unpack both."""
    return {path: Path(fmpy.extract(str(path), str(folder / path.stem))) for path in (cs, me)}


@pytest.fixture
def make(unzipped):
    """Make instances, and free them in the end."""
    made = []

    def maker(path):
        made.append(Instance(path, unzipped[path]))
        return made[-1]

    yield maker
    for instance in made:
        instance.close()


def run(path, **options):
    """Simulate in FMPy."""
    names = [*FORCES, "switchings", "regime_changes", "time", "pair.output.angle"]
    settings = {"start_time": 0.0, "stop_time": T_END, "output_interval": STEP, "output": names, "record_events": False}
    return fmpy.simulate_fmu(str(path), **settings, **{"relative_tolerance": 1e-11, "timeout": 60} | options)


def missed(found, result):
    """Return the largest difference of the mesh forces, over the mean of the loaded one."""
    forces = result.dataset["mesh_force"].sel(mesh=list(FORCES.values())).values
    theirs = np.array([found[name] for name in FORCES]).T
    assert theirs.shape == forces.shape
    return np.abs(theirs - forces).max() / forces[:, 0].mean()


@pytest.mark.parametrize("kind", ["cs", "me"])
def test_forces_are_those_of_simulate(kind, ours, request):
    found, counts = run(request.getfixturevalue(kind)), ours.summary["counts"]
    assert missed(found, ours) < (1e-7 if kind == "cs" else 1e-5)
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


def set_states(instance, x):
    """Set the states of an instance for model exchange."""
    values = (fmpy.fmi3.fmi3Float64 * len(x))(*x)
    instance.fmu.setContinuousStates(values, len(x))


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


def test_states_are_taken_up_again(cs, make):
    one, other = make(cs).initialise(), make(cs).initialise()
    one["loads.brake.torque"] = -170.0
    one.step(0, 100)
    kept = one.state("get")
    data = one.state("serialize", kept)
    first = one.step(100, 50)
    one.state("set", kept)
    one.state("free", kept)
    assert np.array_equal(one.step(100, 50), first)
    moved = other.state("deserialize", data)
    other.state("set", moved)
    other.state("free", moved)
    assert other["loads.brake.torque"] == -170.0
    assert np.array_equal(other.step(100, 50), first)


def test_states_of_model_exchange_are_taken_up_again(me, make):
    one, other = make(me).initialise(), make(me).initialise()
    one.fmu.updateDiscreteStates()
    one.fmu.enterContinuousTimeMode()
    one["loads.motor.acceleration"], one["loads.motor.speed"] = 7.0, 150.0
    set_states(one, [0.3, 1e-4, 0.2])
    names = [v.name for v in one.description.modelVariables if v.causality in ("output", "local")]
    kept = one.state("get")
    data = one.state("serialize", kept)
    one.state("free", kept)
    moved = other.state("deserialize", data)
    other.state("set", moved)
    other.state("free", moved)
    assert [other[name] for name in names] == [one[name] for name in names]


def test_a_damaged_state_is_refused(cs, make):
    instance = make(cs).initialise()
    kept = instance.state("get")
    data = instance.state("serialize", kept)
    instance.state("free", kept)
    for bad, why in ((data[:-8], "damaged"), (b"x" + data[1:], "another model"), (b"", "another model")):
        with pytest.raises(FMICallException) as refused:
            instance.state("deserialize", bad)
        assert refused.value.status == ERROR
        assert why in instance.said[-1][1]


def test_instances_do_not_disturb_each_other(cs, make):
    alone = make(cs).initialise().step(0, 100)
    one, other = make(cs).initialise(), make(cs).initialise(**{"pair.mesh.stiffness_single": 1.5e8})
    found, others = np.array([(one.step(k)[0], other.step(k)[0]) for k in range(100)]).transpose(1, 0, 2)
    assert np.array_equal(found, alone)
    assert np.abs(others - alone).max() > 100


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


WRONG = {
    "pair.output.inertia": (0.0, "must be at least 2"),
    "pair.input.inertia": (-1.0, "must be at least 2"),
    "pair.mesh.stiffness_single": (-1.0, "must be at least 0"),
    "pair.mesh.damping": (float("nan"), "not finite"),
    "loads.brake.torque": (float("inf"), "not finite"),
    "pair.mesh.mesh_force": (1.0, "calculated and cannot be set"),
    "time": (1.0, "calculated and cannot be set"),
}


@pytest.mark.parametrize("kind", ["cs", "me"])
def test_wrong_values_are_refused(kind, make, request):
    instance = make(request.getfixturevalue(kind))
    for name, (value, why) in WRONG.items():
        if name not in instance.reference:
            continue
        with pytest.raises(FMICallException) as refused:
            instance[name] = value
        assert refused.value.status == ERROR
        assert not instance.two or (instance.said[-1][0] == ERROR and why in instance.said[-1][1])
    instance.initialise()
    instance.reference["none"] = 10**6
    for setting in (False, True):
        with pytest.raises(FMICallException) as refused:
            instance.__setitem__("none", 1.0) if setting else instance["none"]
        assert refused.value.status == ERROR
    with pytest.raises(FMICallException) as refused:
        instance["pair.output.inertia"] = 0.05
    assert refused.value.status == ERROR


def test_fixed_parameters_are_no_variables(cs, pair, make):
    instance = make(cs)
    listed = {v.valueReference for v in instance.description.modelVariables}
    gaps = set(range(max(listed))) - listed
    assert len(gaps) > 3
    for gap in gaps:
        instance.reference["gap"] = gap
        with pytest.raises(FMICallException):
            instance["gap"] = 1.0
        with pytest.raises(FMICallException):
            instance["gap"]


def test_functions_out_of_place_are_refused(cs, make):
    instance = make(cs)
    with pytest.raises(FMICallException):
        instance.fmu.doStep(0.0, STEP)
    instance.initialise()
    for from_, step in ((0.5, STEP), (0.0, 0.0), (0.0, -STEP), (0.0, float("nan"))):
        with pytest.raises(FMICallException) as refused:
            instance.fmu.doStep(from_, step)
        assert refused.value.status == ERROR
    instance.step(0)  # and it goes on all the same


def test_a_motion_that_cannot_be_followed_is_discarded(cs, make):
    instance = make(cs).initialise()
    instance["loads.brake.torque"] = 1e300
    with pytest.raises(FMICallException) as failed:
        instance.step(0, 10)
    assert failed.value.status in (ERROR, DISCARD)
    assert "the integration stopped at" in instance.said[-1][1]


def test_an_impossible_equilibrium_is_an_error(cs, make):
    instance = make(cs)
    with pytest.raises(FMICallException) as failed:
        instance.initialise(**{"pair.mesh.stiffness_single": 0.0, "pair.mesh.stiffness_double": 0.0})
    assert failed.value.status == ERROR
    assert "equilibrium" in instance.said[-1][1]


def test_another_token_is_refused(cs, unzipped):
    fmu = FMU2Slave(guid="other", unzipDirectory=str(unzipped[cs]), modelIdentifier="rattle", instanceName="gears")
    with pytest.raises(Exception, match="instantiate"):
        fmu.instantiate()


@pytest.mark.parametrize("kind", ["cs", "me"])
def test_memory_stays_flat(kind, make, request):
    instance = make(request.getfixturevalue(kind))
    free = instance.fmu.fmi2FreeInstance if instance.two else instance.fmu.fmi3FreeInstance

    def use():
        free(instance.fmu.component)
        instance.instantiate()
        instance.initialise(**{"pair.output.inertia": 0.05})
        if instance.two:
            instance.step(0, 3)
        instance.state("free", instance.state("get"))

    for _ in range(50):
        use()
    gc.collect()
    before = resident()
    for _ in range(100):
        use()
    gc.collect()
    assert resident() - before < 100 * 2048  # an instance has more than 20 kB


def resident():
    """Return the memory of this process [bytes]."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * 4096
