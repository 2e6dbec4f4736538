"""Errors of teeth: a linear pair's exact response, and what an eccentric gear and a single tooth do."""

import numpy as np
import pytest

from ..models import case, make_case

PAIR = {
    "title": "Pair that only turns, driven at a held speed",
    "stages": {
        "pair": {
            "kind": "pair",
            "module": "5 mm",
            "pressure_angle": "20 deg",
            "input": {"teeth": 20, "support": "rigid", "inertia": "0.02 kg*m^2"},
            "output": {"teeth": 50, "support": "rigid", "inertia": "0.3 kg*m^2"},
            "mesh": {"stiffness": "4e8 N/m", "damping_ratio": 0.05},
        }
    },
    "loads": {
        "drive": {"member": "pair.input", "speed": "-600 rpm"},
        "brake": {"member": "pair.output", "torque": "-2000 N*m"},
    },
    "effects": {"mesh_stiffness": "mean"},
}


def pair(mesh=None, effects=None, **gear):
    """The pair with more keys for its mesh, its input gear and its effects."""
    raw = {**PAIR, "effects": PAIR["effects"] | (effects or {})}
    stage = PAIR["stages"]["pair"]
    raw["stages"] = {"pair": stage | {"mesh": stage["mesh"] | (mesh or {}), "input": stage["input"] | gear}}
    return make_case(raw)


def forces(c, **options):
    """Sample times and mesh force over the second half of a run."""
    path = c.run(**{"method": "erk", "rtol": 1e-9, "t_end": 0.4, "rate": 20000.0} | options)
    half = len(path.time) // 2
    return path.time[half:], c.mesh_forces(path)[half:, 0]


@pytest.mark.parametrize("lateral", ["on", "off"])
def test_a_linear_pair_answers_a_transmission_error_as_one_freedom_does(lateral):
    """Closed form: m u'' + c (u' - e') + k (u - e) = const, force amplitude |e| k m w^2 / |k - m w^2 + i c w|."""
    error = {"transmission_error": {"amplitudes": ["3 um"], "phases": ["40 deg"]}}
    c = pair(error, {"transmission_error": "on", "lateral": lateral})
    time, force = forces(c)
    radius = 0.005 * 50 / 2 * np.cos(np.radians(20))
    mass, k = 0.3 / radius**2, 4e8
    damping = 2 * 0.05 * np.sqrt(k * mass)
    omega = 2 * np.pi * 20 * 600 / 60
    # Force on the output k(u-e)+c(u'-e') with u = e (k + i c w)/(k - m w^2 + i c w): N = -m u'' magnitude m w^2 |u|.
    exact = 3e-6 * abs(k + 1j * damping * omega) / abs(k - mass * omega**2 + 1j * damping * omega) * mass * omega**2
    wave = np.exp(-1j * omega * time)
    assert 2 * abs(np.mean((force - force.mean()) * wave)) == pytest.approx(exact, rel=2e-4)
    assert force.mean() == pytest.approx(2000 / radius, rel=1e-5)


def test_an_eccentric_gear_modulates_once_a_turn():
    """Slow turning: the mesh opens and closes by the eccentricity along the line of action, the force hardly moves,
    and the output's angle follows e sin(...) / r_2 to first order.
    """
    slow = {"eccentricity": "on"}
    c = pair({}, slow, eccentricity={"radius": "40 um", "angle": "25 deg"})
    path = c.run(method="erk", rtol=1e-9, t_end=0.2, rate=5000.0)
    twist = c.quantity("twist", path.x, path.levels)["pair.output"]
    half = len(twist) // 2
    radius, omega = 0.005 * 50 / 2 * np.cos(np.radians(20)), 2 * np.pi * 10
    wave = np.exp(-1j * omega * path.time[half : half + 500])
    amplitude = 2 * abs(np.mean((twist[half : half + 500] - twist[half : half + 500].mean()) * wave))
    assert amplitude == pytest.approx(40e-6 / radius, rel=0.02)


def test_a_tooth_out_of_place_shows_once_a_turn_of_its_gear():
    error = {"tooth_errors": [{"gear": "input", "tooth": 7, "error": "20 um"}], "contact_ratio": 1.7}
    on, off = pair(error, {"tooth_errors": "on"}), pair()
    (time, with_error), (_, without) = forces(on), forces(off)
    struck = np.abs(with_error - without)
    turns = (time * 10 - 7 / 20) % 1.0  # turns of the input since its tooth 7 came
    assert struck[turns < 0.08].max() > 5 * struck[(turns > 0.5) & (turns < 0.9)].max()
    assert struck.max() > 0.05 * 20e-6 * 4e8


def test_no_error_is_no_effect():
    zero = {"transmission_error": {"amplitudes": ["0 um"]}, "contact_ratio": 1.7}
    zero["tooth_errors"] = [{"gear": "output", "tooth": 1, "error": "0 um"}]
    switched = {"transmission_error": "on", "tooth_errors": "on", "eccentricity": "on"}
    _, on = forces(pair(zero, switched, eccentricity={"radius": "0 um"}), t_end=0.02)
    _, off = forces(pair(), t_end=0.02)
    assert np.abs(on - off).max() < 1e-12 * np.abs(off).max()


def test_a_torsional_planetary_stage_shares_like_one_with_stiff_bearings():
    """Position errors reach a torsional model through its law of angles; a stiff full model carries the same loads."""
    error = (
        "effects.planet_position_error = 'on'",
        "stages.hsp.position_errors = [{planet=1, tangential='50 um', radial='20 um'}]",
    )
    stiff = (
        "effects.pins = 'rigid'",
        "stages.hsp.sun.support = 'rigid'",
        "-stages.hsp.sun.bearing",
        "stages.hsp.carrier.support = 'rigid'",
    )

    def loads(*settings):
        c = case("hsp", *error, *settings)
        return np.array(list(c.quantity("mesh_force", c.at.x, c.at.levels).values())).ravel()

    angles_only, in_plane = loads("effects.lateral = 'off'"), loads(*stiff)
    assert angles_only == pytest.approx(in_plane, rel=1e-6)
    assert np.ptp(angles_only[::2]) > 0.02 * np.mean(angles_only[::2])
