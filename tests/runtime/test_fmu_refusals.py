"""What FMUs refuse, they refuse with a status, and are as before."""

import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave

from .instances import DISCARD, ERROR, STEP

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
