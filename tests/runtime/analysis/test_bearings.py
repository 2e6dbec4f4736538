"""Loads of bearings against closed forms."""

import numpy as np
import pytest
from ltcgear.runtime.analysis import (
    list_bearing_loads,
)

from ..outputs import result, times

TIME = times()
TURN = 2 * np.pi
WAVE = np.sin(TURN * 8.0 * TIME)


def test_bearing_loads_are_those_of_the_magnitude():
    turning = {"psh.input": 30.0 * np.cos(TURN * 8.0 * TIME)}, {"psh.input": 30.0 * np.sin(TURN * 8.0 * TIME)}
    (found,) = list_bearing_loads(result(TIME, bearing_force_x=turning[0], bearing_force_y=turning[1]))
    assert (found.name, found.kind) == ("psh.input", "bearing")
    assert (found.mean, found.rms, found.peak) == pytest.approx((30.0, 30.0, 30.0))
    assert found.vibration == pytest.approx(0.0, abs=1e-9)
    steady = result(TIME, bearing_force_x={"a": 3.0 + WAVE}, bearing_force_y={"a": 0.0})
    (found,) = list_bearing_loads(steady)
    assert found.rms == pytest.approx(np.sqrt(9.5))
    assert found.vibration == pytest.approx(np.sqrt(0.5))
    assert list_bearing_loads(result(TIME, speed={"a": 1.0})) == ()
