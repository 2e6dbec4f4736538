"""Load duration against closed forms."""

import numpy as np
import pytest
from ltcgear.runtime.analysis import (
    find_load_duration,
)

from ..outputs import output, times

TIME = times()
TURN = 2 * np.pi


def triangle(periods):
    """Up and down between 0 and 100, evenly."""
    return 100.0 * np.abs(2.0 * np.mod(periods * TIME, 1.0) - 1.0)


def test_the_loads_of_a_triangle_last_alike():
    """A triangle spends equal times in equal bins: what is exceeded falls evenly."""
    found = find_load_duration(output(triangle(4.0), TIME), output(160.0 * TIME, TIME, "mesh_phase"), bins=10)
    assert found.counted == "tooth meshes"
    assert found.seconds == pytest.approx(0.1, abs=2e-3)
    assert found.count == pytest.approx(16.0, abs=0.2)
    assert found.exceeded == pytest.approx(np.arange(160.0, 0.0, -16.0), abs=0.4)
    assert found.seconds.sum() == pytest.approx(TIME[-1])


def test_revolutions_count_where_they_pass():
    """The shaft turns only while the load is high."""
    load = np.where(TIME < 0.5, 10.0, 90.0)
    angle = TURN * 12.0 * np.maximum(TIME - 0.5, 0.0)
    found = find_load_duration(output(load, TIME), output(angle, TIME, "angle", "sun"), bins=2)
    assert found.counted == "turns"
    assert found.count == pytest.approx([0.0, 6.0], abs=0.01)
    assert found.seconds == pytest.approx([0.5, 0.5], abs=1e-3)
