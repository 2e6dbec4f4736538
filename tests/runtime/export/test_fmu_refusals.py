"""What FMUs refuse, they refuse with a status, and are as before."""

from ctypes import byref

import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave, fmi2Real

from ..instances import DISCARD, ERROR, STEP, set_states

WRONG = {
    "pair.output.inertia": (0.0, "must be at least 2"),
    "pair.input.inertia": (-1.0, "must be at least 2"),
    "pair.mesh.stiffness_single": (-1.0, "must be at least 0"),
    "pair.mesh.damping": (float("nan"), "not finite"),
    "pair.mesh.back.damping": (-1.0, "must be at least 0"),
    "pair.mesh.single_share": (1.0, "must be at most 0.99999999999999989"),
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


@pytest.mark.parametrize("kind", ["cs", "me"])
def test_values_are_set_together_or_not_at_all(kind, make, request):
    instance = make(request.getfixturevalue(kind))
    names = ["pair.output.inertia", "loads.brake.torque", "loads.motor.speed"]
    vr = [instance.reference[name] for name in names]
    put = instance.fmu.setReal if instance.two else instance.fmu.setFloat64
    before = [instance[name] for name in names]
    for bad in ([0.05, -90.0, float("nan")], [-1.0, -90.0, 1.0]):
        for order in (1, -1):
            with pytest.raises(FMICallException):
                put(vr[::order], bad[::order])
            assert [instance[name] for name in names] == before
    put(vr, [0.05, -90.0, 140.0])
    instance.initialise()
    with pytest.raises(FMICallException):
        put(vr[1:], [-80.0, float("inf")])
    assert [instance[name] for name in names] == [0.05, -90.0, 140.0]


def test_states_that_are_not_finite_are_refused(me, make):
    instance = make(me).initialise()
    instance.fmu.updateDiscreteStates()
    instance.fmu.enterContinuousTimeMode()
    set_states(instance, [0.3, 1e-4, 0.2])
    force = instance["pair.mesh.mesh_force"]
    for x in ([float("nan"), 0.0, 0.0], [0.0, 0.0, float("inf")]):
        with pytest.raises(FMICallException) as refused:
            set_states(instance, x)
        assert refused.value.status == ERROR
    assert instance["reference.angle"] == 0.3
    assert instance["pair.mesh.mesh_force"] == force


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
    instance.step(0, 3)
    reached = 3 * STEP
    for torque in (1e300, 1e12):  # in the first segment, and on the way
        instance["loads.brake.torque"] = torque
        with pytest.raises(FMICallException) as failed:
            instance.fmu.doStep(reached, 2e3 * STEP)
        assert failed.value.status == DISCARD
        assert instance.said[-1][0] == DISCARD
        assert "the integration stopped at" in instance.said[-1][1]
        assert last_time(instance) == instance["time"]
        assert (instance["time"] == reached) == (torque == 1e300)
        reached = instance["time"]
    instance["loads.brake.torque"] = -150.0
    with pytest.raises(FMICallException) as refused:
        instance.fmu.doStep(reached + 1.0, STEP)
    assert refused.value.status == ERROR


def test_a_step_of_too_many_steps_is_discarded(cs, make):
    instance = make(cs).initialise()
    with pytest.raises(FMICallException) as failed:
        instance.fmu.doStep(0.0, 1e7)
    assert (failed.value.status, last_time(instance)) == (DISCARD, 0.0)
    instance.step(0)  # a shorter one goes


def last_time(instance):
    """Return how far an instance has come, as FMI tells it."""
    found = fmi2Real()
    kind = 2  # fmi2LastSuccessfulTime
    assert instance.fmu.fmi2GetRealStatus(instance.fmu.component, kind, byref(found)) == 0
    return found.value


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
