"""States of FMUs: kept, packed and taken up again, or refused."""

import numpy as np
import pytest
from fmpy.fmi1 import FMICallException

from .instances import ERROR, set_states


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
