"""The reference for the dead band against closed forms, and the numbers that the hard case keeps of it."""

import numpy as np
import pytest
from ltcgear.runtime.studies.selftest import dead_band as case

from .dead_band import DeadBand, Sweep, amplitudes

START = (1.05, 0.0)


def test_teeth_that_stay_together_swing_linearly():
    omega, pair = 0.6, DeadBand()
    tau, y = pair.run(Sweep((0.0,), (omega,)), 600.0, 0.02, START)
    forced = omega**2 - 2j * pair.zeta * omega
    response = pair.error * forced / (1 - omega**2 + 2j * pair.zeta * omega)
    late = tau > 400
    assert y[late] == pytest.approx(1.1 + (response * np.exp(1j * omega * tau[late])).real, abs=1e-6)


def test_teeth_that_part_bounce():
    tau, y = DeadBand(zeta=0.0, error=0.0).run(Sweep((0.0,), (1.0,)), 60.0, 0.01, (1.1, 0.15))
    early, speed = np.arcsin(0.1 / 0.15), np.sqrt(0.15**2 - 0.1**2)
    contact = np.pi + 2 * early
    since = np.mod(tau + early, contact + 2 * speed / 0.1)
    flown = since - contact
    wanted = np.where(flown < 0, 1.1 + 0.15 * np.sin(since - early), 1 + flown * (0.05 * flown - speed))
    assert y == pytest.approx(wanted, abs=1e-6)


def test_both_flanks_are_touched_alike():
    tau, y = DeadBand(zeta=0.0, force=0.0, error=0.0).run(Sweep((0.0,), (1.0,)), 40.0, 0.01, (0.0, 0.5))
    half = 2 / 0.5 + np.pi  # across the band and half a swing
    whole = tau < 39.9 - half
    assert -np.interp(tau[whole] + half, tau, y) == pytest.approx(y[whole], abs=1e-4)
    assert y.max() == pytest.approx(1.5, abs=1e-4)


def test_a_cycle_is_counted_by_its_angle():
    sweep = Sweep((0.0, 100.0), (0.5, 1.5))
    assert sweep.angle(100.0) == pytest.approx(100.0)
    assert sweep.angle(130.0) == pytest.approx(145.0)
    tau = np.arange(0.0, 100.0, 0.01)
    y = np.where(tau < 50, 0.2, 0.3) * np.sin(0.5 * tau + 0.005 * tau**2)
    _, frequency, found = amplitudes(tau, y, sweep)
    assert len(found) == int(100 / (2 * np.pi))
    assert found[:4] == pytest.approx(0.2, rel=1e-3)
    assert frequency[0] == pytest.approx(np.sqrt(0.25 + 0.02 * np.pi), rel=0.02)


def test_the_hard_case_keeps_the_jumps_of_the_reference():
    times, frequencies, end = case.SHORT_SWEEP
    sweep = Sweep(times, frequencies)
    tau, y = DeadBand().run(sweep, end, 2 * np.pi / case.SAMPLES, START)
    found = case.MeshCycles(*amplitudes(tau, y, sweep)).jumps((times[1] + times[2]) / 2)
    assert found == pytest.approx(case.JUMPS, abs=1e-4)


def test_the_hard_case_keeps_the_amplitudes_of_the_reference():
    times, frequencies = case.staircase(case.STEPS)
    sweep = Sweep(times, frequencies)
    tau, y = DeadBand().run(sweep, times[-1], 2 * np.pi / case.FINE, START)
    cycles = case.MeshCycles(*amplitudes(tau, y, sweep))
    found = [cycles.before(times[2 * i + 1]) for i in range(len(case.STEPS))]
    assert found == pytest.approx(case.AMPLITUDES, abs=1e-5)
