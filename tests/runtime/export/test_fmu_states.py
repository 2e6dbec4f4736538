"""States of FMUs: kept, packed and taken up again, or refused."""

import sys

import numpy as np
import pytest
from fmpy.fmi1 import FMICallException

from ..instances import ERROR, STEP, set_states


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


@pytest.mark.parametrize("kind", ["cs", "me"])
def test_a_bit_that_was_flipped_is_seen(kind, make, request):
    instance = make(request.getfixturevalue(kind)).initialise()
    kept = instance.state("get")
    data = instance.state("serialize", kept)
    instance.state("free", kept)
    for at in [*range(0, len(data), 5), *range(len(data) - 8, len(data))]:
        bad = bytearray(data)
        bad[at] ^= 1 << at % 8
        with pytest.raises(FMICallException) as refused:
            instance.state("deserialize", bytes(bad))
        assert refused.value.status == ERROR


def checksum(data):
    """FNV-1a of 64 bits (Fowler, Noll, Vo; draft-eastlake-fnv)."""
    found = 0xCBF29CE484222325
    for byte in data:
        found = (found ^ byte) * 0x100000001B3 % 2**64
    return found


def test_a_state_that_is_refused_changes_nothing(cs, make):
    assert checksum(b"foobar") == 0x85944171F73967E8  # a vector of the draft's
    instance = make(cs).initialise()
    instance["loads.brake.torque"] = -170.0
    instance.step(0, 50)
    kept = instance.state("get")
    data = instance.state("serialize", kept)
    assert data[-8:] == checksum(data[:-8]).to_bytes(8, sys.byteorder)
    due = instance.step(50, 20)
    instance.state("set", kept)
    instance.state("free", kept)
    bad = bytearray(data[:-8])
    bad[-20] ^= 1  # within the run, whose own checksum tells
    moved = instance.state("deserialize", bytes(bad) + checksum(bad).to_bytes(8, sys.byteorder))
    with pytest.raises(FMICallException) as refused:
        instance.state("set", moved)
    assert refused.value.status == ERROR
    assert "damaged" in instance.said[-1][1]
    instance.state("free", moved)
    assert (instance["time"], instance["loads.brake.torque"]) == (50 * STEP, -170.0)
    assert np.array_equal(instance.step(50, 20), due)


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
