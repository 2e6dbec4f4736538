"""Waterfalls of a run-up and of a steady sine."""

import numpy as np
import pytest
from ltcgear.generated.errors import LtcgearError
from ltcgear.runtime.analysis import (
    find_waterfall,
    mesh_courses,
    select_output,
)

from ..outputs import output, result, times

TIME = times()
TURN = 2 * np.pi


def run_up(first, last, seconds=2.0):
    """Time, angle [rad] and speed [rad/s] of a shaft that speeds up evenly from one to another [turns a second]."""
    time = times(seconds)
    turns = first * time + 0.5 * (last - first) / seconds * time**2
    return time, TURN * turns, TURN * (first + (last - first) / seconds * time)


def test_a_run_up_draws_a_straight_line():
    time, angle, speed = run_up(5.0, 40.0)
    dataset = result(
        time,
        mesh_force={"psh.mesh": np.sin(20.0 * angle)},
        mesh_phase={"psh.mesh": 20.0 * angle / TURN},
        speed={"psh.input": speed},
    )
    force, turning = select_output(dataset, "mesh_force:psh.mesh")[0], select_output(dataset, "speed:psh.input")[0]
    found = find_waterfall(force, turning, resolution_hz=16.0)
    ridge = found.frequency[np.argmax(found.amplitude[:, 1:], axis=1) + 1]
    course = mesh_courses(dataset, found)["psh"]
    assert np.abs(ridge - course).max() <= 16.0
    assert course == pytest.approx(20.0 * found.speed / 60.0, rel=1e-3)
    assert course == pytest.approx(20.0 * (5.0 + 17.5 * found.time), rel=1e-3)
    assert found.bandwidth == pytest.approx(24.0)
    assert found.shaft == "psh.input"
    assert np.diff(found.time) == pytest.approx(0.25 * found.segment_s)


def test_every_spectrum_of_a_steady_sine_is_the_same():
    found = find_waterfall(output(2.0 * np.sin(TURN * 512.0 * TIME), TIME), resolution_hz=8.0)
    assert found.amplitude[:, 64] == pytest.approx(2.0)
    assert found.amplitude.shape == (29, 513)


@pytest.mark.parametrize("resolution", [0.5, 1000.0, 0.0, -1.0])
def test_resolutions_that_cannot_be_are_refused(resolution):
    with pytest.raises(LtcgearError, match=r"--resolution .* must lie between 1 and 128 Hz"):
        find_waterfall(output(TIME, TIME), resolution_hz=resolution)
