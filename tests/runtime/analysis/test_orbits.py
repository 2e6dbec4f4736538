"""Orbits of members against closed forms."""

import numpy as np
import pytest
from ltcgear.generated.errors import LtcgearError
from ltcgear.runtime.analysis import (
    find_orbit,
)

from ..outputs import result, times

TIME = times()
TURN = 2 * np.pi
WAVE = np.sin(TURN * 8.0 * TIME)


def test_the_orbit_of_a_circle():
    x, y = 5e-6 + 2e-6 * np.cos(TURN * 8.0 * TIME), -1e-6 + 2e-6 * np.sin(TURN * 8.0 * TIME)
    dataset = result(TIME, {"s.sun.bearing.clearance": 9e-6}, displacement_x={"s.sun": x}, displacement_y={"s.sun": y})
    found = find_orbit(dataset, "s.sun")
    assert found.centre == pytest.approx((5e-6, -1e-6))
    assert (found.rms, found.largest) == pytest.approx((2e-6, 2e-6))
    assert found.static == pytest.approx((7e-6, -1e-6))
    assert found.clearance == 9e-6
    assert found.floating
    assert found.held == "no bearing"
    later = find_orbit(dataset.isel(time=slice(4000, None)), "s.sun", dataset)
    assert later.static == found.static
    assert find_orbit(dataset.isel(time=slice(4000, None)), "s.sun").static is None
    held = dataset.assign(bearing_force_x=(("time", "bearing"), np.zeros((TIME.size, 1))), bearing=["s.sun"])
    assert find_orbit(held, "s.sun").held == "bearing"
    assert not find_orbit(held, "s.sun").floating
    with pytest.raises(LtcgearError, match=r"s.planet: no member that moves sideways; there are s.sun"):
        find_orbit(dataset, "s.planet")


def test_orbits_are_in_axes_that_turn_with_the_carrier_as_it_is():
    """A planet that stays on its pin does not move, however far the carrier is turned against the rigid motion."""
    twist = 0.2 + 0.05 * WAVE
    place, off = 0.3 + 0.4j, 5e-6 - 2e-6j
    planet = (place + off) * np.exp(1j * twist) - place
    sun = 4e-6 * np.exp(1j * twist)
    paths = {"s.planet.1": planet, "s.sun": sun, "t.output": sun}
    dataset = result(
        TIME, {"s.planet.1.x_0": 0.3, "s.planet.1.y_0": 0.4}, twist={"s.sun": 1.0, "s.carrier": twist},
        displacement_x={name: path.real for name, path in paths.items()},
        displacement_y={name: path.imag for name, path in paths.items()},
    )  # fmt: skip
    assert np.abs(planet).min() > 0.05
    found = find_orbit(dataset, "s.planet.1")
    assert found.centre == pytest.approx((5e-6, -2e-6), abs=1e-15)
    assert found.static == pytest.approx((5e-6, -2e-6), abs=1e-15)
    assert found.largest == pytest.approx(0.0, abs=1e-15)
    assert (found.held, found.floating) == ("pin", False)
    assert find_orbit(dataset, "s.sun").centre == pytest.approx((4e-6, 0.0), abs=1e-15)
    assert find_orbit(dataset, "t.output").x == pytest.approx(sun.real, abs=1e-18)
    later = find_orbit(dataset.isel(time=slice(4000, None)), "s.planet.1", dataset)
    assert later.static == pytest.approx((5e-6, -2e-6), abs=1e-15)
