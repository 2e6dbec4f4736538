"""A small motion begun in a mode's shape decays as the mode says, by the whole model's own equations."""

from dataclasses import replace

import numpy as np
import pytest
from ltcgear.runtime.linear.modes import find_modes
from ltcgear.runtime.linear.system import linearise
from scipy.optimize import curve_fit

from ..models import case

DAMPED = (
    'effects.damping = "on"',
    "stages.gear.pin.damping_ratio = 0.02",
    *(f"stages.gear.{part}.bearing.damping_ratio = 0.03" for part in ("sun", "ring", "carrier")),
    "stages.gear.sun_planet.damping_ratio = 0.02",
)
FAST = ('loads.m.member = "gear.carrier"', 'loads.m.speed = "300 rad/s"')


def decay(c, linear, mode, cycles=12, samples=40):
    """Frequency [rad/s] and decay [1/s] of the state that a simulation shows most, fitted without the mode."""
    size = linear.scale[linear.kept]
    shape = mode.shape / np.abs(mode.shape / size).max() * 3.0
    x = c.at.x.copy()
    x[linear.kept] += shape.real
    end = cycles * 2 * np.pi / abs(mode.eigenvalue.imag)
    options = {"t_end": end, "rate": cycles * samples / end, "method": "erk", "rtol": 1e-9}
    path = c.run(at=replace(c.at, x=x), **options)
    top = linear.positions[np.abs(shape / size)[linear.positions].argmax()]
    signal = (path.x[:, linear.kept[top]] - c.at.x[linear.kept[top]]) / size[top]

    def law(t, a, b, sigma, omega):
        return np.exp(-sigma * t) * (a * np.cos(omega * t) + b * np.sin(omega * t))

    guess = (signal[0], 0.0, -mode.eigenvalue.real * 1.3 + 1.0, 1.001 * mode.eigenvalue.imag)
    fitted = curve_fit(law, path.time, signal, guess)[0]
    assert np.abs(law(path.time, *fitted) - signal).max() < 2e-3 * np.abs(signal).max()
    return fitted[3], fitted[2]


@pytest.mark.parametrize("k", [0, 2, 4, 7])
@pytest.mark.parametrize("speed", [(), FAST])
def test_free_decay_of_a_planetary_gear(k, speed):
    """At rest, and on a carrier that turns so fast that Coriolis forces part the pairs."""
    c = case("lin-parker-3", *DAMPED, *speed)
    linear = linearise(c.point)
    mode = [mode for mode in find_modes(linear) if mode.kind != "rigid"][k]
    frequency, damping = decay(c, linear, mode)
    assert frequency == pytest.approx(mode.eigenvalue.imag, rel=1e-4)
    assert damping == pytest.approx(-mode.eigenvalue.real, rel=1e-2)


def test_coriolis_forces_matter_there():
    still, fast = (case("lin-parker-3", *DAMPED, *speed) for speed in ((), FAST))
    first = [
        next(mode for mode in find_modes(linearise(c.point)) if mode.kind == "translational") for c in (still, fast)
    ]
    assert abs(first[1].frequency_hz / first[0].frequency_hz - 1) > 1e-2
    assert first[0].multiplicity == 2
    assert first[1].multiplicity == 1


def test_free_decay_of_the_loaded_rig():
    """With mean stiffness: the mode of HSP and output shaft, at full load and speed."""
    c = case("rig-2mw", 'effects.mesh_stiffness = "mean"')
    linear = linearise(c.point)
    mode = next(mode for mode in find_modes(linear) if 140 < mode.frequency_hz < 150)
    frequency, damping = decay(c, linear, mode)
    assert frequency == pytest.approx(mode.eigenvalue.imag, rel=1e-4)
    assert damping == pytest.approx(-mode.eigenvalue.real, rel=1e-2)
