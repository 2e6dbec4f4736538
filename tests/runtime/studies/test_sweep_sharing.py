"""The physics of a sweep: planets' shares under pin errors, against the static balance of equal springs.

A planet whose pin lies e out of place along the pin circle gives way to its two meshes as one spring between the
angles of sun and carrier. Both meshes carry the same normal force F (no torque is left on the planet), the pin 2 F
cos(alpha), so the spring is K = 1 / (1/k_s + 1/k_r + 4 cos^2(alpha) / k_p) along the sun's line of action, and the
error takes 2 cos(alpha) e from its deflection. All n springs end on one sun:

- a sun that turns about a fixed axis keeps the errors' mean only: F_i = F - 2 K cos(alpha) (e_i - mean e);
- a sun that floats moves until its forces balance, which takes the first harmonic round the stage from the forces too.
  Nothing is left of the errors of three planets; of four, (e_1 - e_2 + e_3 - e_4) / 4, with the sign of the planet.

Derived here; that three planets under a floating sun share alike whatever their errors, and that opposite ones of four
pair up, is known (Bodas and Kahraman 2004, JSME Int. J. C 47:908; Singh 2010, Mech. Mach. Theory 45:511).
"""

import math

import numpy as np
import pytest
from ltcgear.runtime.studies.sweep.design import draw_design
from ltcgear.runtime.studies.sweep.sweep_axes import read_axes

from ..models import case
from ..sweeps import run_sweep

ALTERNATE = np.array([1.0, -1.0, 1.0, -1.0])
POINTS = 6


def settings(stage, planets, *more):
    """Mean stiffnesses, so that forces are those of statics, and pin errors of all planets."""
    errors = ", ".join(f"{{planet={number}}}" for number in range(1, planets + 1))
    effects = ("effects.planet_position_error = 'on'", "effects.mesh_stiffness = 'mean'")
    return (*effects, f"stages.{stage}.position_errors = [{errors}]", *more)


def sweep(stage, planets, *more):
    """Shares of the planets at the sun and at the ring [1], errors [m], shapes (points, planets)."""
    texts = [f"stages.{stage}.position_errors.{k}.tangential=0 um:20 um" for k in range(planets)]
    design = draw_design(read_axes(texts), "normal", POINTS, 1)
    found = run_sweep(design, stage, settings(stage, planets, *more), ["load_share"], t_end=0.02, rate=8192.0)
    shares = found["load_share"].values
    return shares[:, :planets], shares[:, planets:], 1e-6 * design.values, found


def spring(stage, planets, *more):
    """The share that one metre of pin error takes [1/m]: 2 K cos(alpha) over the mean force."""
    values = case(stage, *settings(stage, planets, *more)).model.values()
    cosine = math.cos(math.radians(20.0))
    meshes = (1.0 / values[f"{stage}.{mesh}.stiffness"] for mesh in ("sun_planet", "ring_planet"))
    stiffness = 1.0 / (sum(meshes) + 4.0 * cosine**2 / values[f"{stage}.pin.stiffness"])
    mean = values["loads.sun.torque"] / planets / values[f"{stage}.sun_planet.base_radius_1"]
    return 2.0 * stiffness * cosine / mean


RIGID = ("stages.lsp.sun.support = 'rigid'", "stages.lsp.ring.support = 'rigid'", "-stages.lsp.ring.bearing")


def test_a_sun_on_a_fixed_axis_shares_by_the_springs():
    sun, ring, errors, _ = sweep("lsp", 4, *RIGID)
    expected = 1.0 - spring("lsp", 4, *RIGID) * (errors - errors.mean(axis=1, keepdims=True))
    assert np.ptp(expected) > 0.1
    assert sun == pytest.approx(expected, abs=1e-7)
    assert ring == pytest.approx(expected, abs=1e-7)


def test_a_floating_sun_leaves_four_planets_what_alternates():
    """To 2 e / (a tan alpha): the sun moves by errors' size, which changes its meshes' angles by that share."""
    sun, ring, errors, found = sweep("lsp", 4)
    left = np.outer(errors @ ALTERNATE / 4.0, ALTERNATE)
    expected = 1.0 - spring("lsp", 4) * left
    within = 2.0 * np.abs(errors).max() / (0.56 * math.tan(math.radians(20.0)))
    assert np.ptp(expected) > 100.0 * within
    assert sun == pytest.approx(expected, abs=within)
    assert ring == pytest.approx(expected, abs=within)
    largest = 1.0 + np.abs(spring("lsp", 4) * left[:, 0])
    assert found["mesh_load_factor"].sel(group="lsp.sun_planet").values == pytest.approx(largest, abs=within)


def test_a_floating_sun_leaves_three_planets_nothing():
    free = ("stages.hsp.sun.support = 'floating'", "-stages.hsp.sun.bearing", "stages.hsp.carrier.support = 'rigid'")
    sun, ring, errors, found = sweep("hsp", 3, *free)
    assert np.ptp(spring("hsp", 3, *free) * errors) > 0.05
    assert sun == pytest.approx(np.ones_like(sun), abs=5e-4)
    assert ring == pytest.approx(np.ones_like(ring), abs=5e-4)
    assert found["mesh_load_factor"].values == pytest.approx(1.0, abs=5e-4)
