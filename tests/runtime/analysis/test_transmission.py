"""Transmission errors, by angles and by deflection, against closed forms."""

import json

import numpy as np
import pytest
from ltcgear.generated.errors import LtcgearError
from ltcgear.runtime.analysis import (
    find_transmission_error,
)
from ltcgear.runtime.analysis.transmission import harmonics_of

from ..outputs import result, times

TIME = times()
TURN = 2 * np.pi
WAVE = np.sin(TURN * 8.0 * TIME)


def sheet(name, one, two, sense, flank, radii, *others):
    """Write the sheet of a stage with one mesh."""
    stage = name.partition(".")[0]
    mesh = {"name": name, "stage": stage, "one": one, "two": two, "sense": sense, "flank": flank, "radii": radii}
    discs = [{"body": body, "stage": stage, "part": body.split(".")[1]} for body in (one, two, *others)]
    return {"sheet": json.dumps({"discs": discs, "meshes": [mesh]})}


def pair(twist_1, twist_2, deflection=0.0, flank=1.0):
    return result(
        TIME, {}, mesh_deflection={"psh.mesh": deflection}, mesh_phase={"psh.mesh": 100.0 * TIME},
        twist={"psh.input": twist_1, "psh.output": twist_2},
    ).assign_attrs(sheet("psh.mesh", "psh.input", "psh.output", 1, flank, [0.25, 0.1]))  # fmt: skip


def test_an_eccentric_gear_shows_once_a_turn():
    """Gear 1 turns evenly at 100/59 Hz, its teeth 50 um out of centre; gear 2 follows: r_2 u_2 = e sin(theta_1)."""
    swing = 50e-6 * np.sin(TURN * 100.0 / 59.0 * TIME)
    found = find_transmission_error(pair(0.0, swing / 0.1), "psh.mesh", "angles")
    assert found.value == pytest.approx(swing, abs=1e-18)
    assert found.peak_to_peak == pytest.approx(100e-6, rel=1e-3)


@pytest.mark.parametrize("flank", [1.0, -1.0])
def test_by_angles_and_by_deflection(flank):
    wave = 20e-6 + 3e-6 * np.cos(TURN * 100.0 * TIME) + 1e-6 * np.cos(TURN * 300.0 * TIME)
    dataset = pair(flank * wave / 0.25, 0.0, 0.5 * wave, flank)
    found = find_transmission_error(dataset, "psh.mesh", "angles")
    assert found.mean == pytest.approx(20e-6)
    assert found.vibration == pytest.approx(np.sqrt(5.0) * 1e-6)
    assert found.harmonics == pytest.approx((3e-6, 0.0, 1e-6, 0.0, 0.0, 0.0), abs=1e-11)
    other = find_transmission_error(dataset, "psh.mesh")
    assert other.definition == "deflection"
    assert other.harmonics[0] == pytest.approx(1.5e-6, rel=1e-6)


def test_a_planets_angles_are_those_against_the_carrier():
    """A carrier that winds up and takes all with it changes nothing."""
    wound = 0.7 * WAVE
    dataset = result(
        TIME, {}, mesh_deflection={"s.ring_planet.2": 0.0},
        twist={"s.carrier": wound, "s.ring": wound + 1e-4, "s.planet.2": wound + 2e-4},
    ).assign_attrs(
        sheet("s.ring_planet.2", "s.ring", "s.planet.2", -1, 1.0, [0.9, 0.3], "s.carrier")
    )  # fmt: skip
    found = find_transmission_error(dataset, "s.ring_planet.2", "angles")
    assert found.value == pytest.approx(0.9e-4 - 0.3 * 2e-4)
    assert np.isnan(found.harmonics).all()


def test_transmission_errors_that_cannot_be_known_are_refused():
    bare = pair(0.0, 0.0).drop_attrs()
    with pytest.raises(LtcgearError, match="does not hold the base radii"):
        find_transmission_error(bare, "psh.mesh", "angles")
    with pytest.raises(LtcgearError, match=r"hsp.mesh: no such mesh; there are psh.mesh"):
        find_transmission_error(bare, "hsp.mesh")
    with pytest.raises(LtcgearError, match="must be by one of deflection, angles"):
        find_transmission_error(bare, "psh.mesh", "guess")


def test_harmonics_of_whole_cycles_are_those_of_the_signal():
    """A periodic window keeps bins orthogonal: nothing of one harmonic is read at another."""
    phase = 100.0 * TIME
    value = 7.0 + 3.0 * np.sin(TURN * phase) + 0.5 * np.cos(3.0 * TURN * phase)
    assert harmonics_of(value, phase, 4) == pytest.approx((3.0, 0.0, 0.5, 0.0), abs=1e-12)
