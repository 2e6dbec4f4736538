"""What needs no second model: energy is kept, and effects meet the limits that they idealise."""

from dataclasses import replace

import numpy as np
import pytest
from ltcgear.runtime.linear.modes import find_modes
from ltcgear.runtime.linear.system import linearise
from ltcgear.runtime.model.equilibrium import _newton
from ltcgear.runtime.simulation.energy_balance import energy_residual

from reference.hand_profiles import smooth_levels

from ..models import case, quick_case
from ..variants import CARRIER_BEARING, ONE_FLANK, OPPOSITE, TORQUE, TORSIONAL, VARIANTS

OLD = ("rig", "paper law", "mesh friction", "bearing friction", "gravity", "opposite flank", "torque-driven",
       "mean stiffness, undamped", "all at once")  # fmt: skip
HAMMERING = "torsional, all of it"
"""Its teeth cross the gap; every touch is a jump of the damper, so the balance needs a finer step."""
UNDAMPED = ('effects.damping = "off"', 'effects.mesh_damping = "off"', 'effects.mesh_stiffness = "mean"')
SMOOTH, FOURIER = 'effects.mesh_stiffness = "smooth"', 'effects.mesh_stiffness = "fourier"'
STEEP = "stages.psh.mesh.double_factor = 1.5"
MESH_HZ = 59 * 638.904 / 60
"""Mesh frequency of the psh scene: teeth times revolutions a second."""
BASE_PITCH = np.pi * 9e-3 / np.cos(np.radians(8)) * np.cos(np.arctan(np.tan(np.radians(20)) / np.cos(np.radians(8))))


@pytest.mark.parametrize("variant", [name for name in VARIANTS if name not in OLD])
def test_energy_is_kept(variant):
    settings = VARIANTS[variant]
    if ONE_FLANK in settings:  # flanks opposite to the load do not hold it
        settings = tuple(setting for setting in settings if setting not in OPPOSITE)
    found = quick_case("rig-2mw", *settings)
    path = found.run(method="erk", rtol=1e-11 if variant == HAMMERING else 1e-9, t_end=0.05)
    assert path.status == "done"
    assert abs(energy_residual(found.point, path)) < 1e-7


# --- stiffness over the phase


def pair_run(*settings):
    """A run of the psh scene from the equilibrium under mean stiffness: case, trajectory, deflection."""
    found, mean = case("psh", STEEP, *settings), case("psh", STEEP, 'effects.mesh_stiffness = "mean"')
    path = found.run(at=replace(found.at, x=mean.at.x), method="erk", rtol=1e-9, t_end=0.1, rate=40960.0)
    assert path.status == "done"
    return found, path, found.quantity("mesh_deflection", path.x, path.levels)["psh.mesh"]


def mesh_lines(found, path):
    """Complex amplitudes [N] of the first five harmonics of the mesh force, after the start-up."""
    late = path.time >= 0.05
    turns = 2 * np.pi * MESH_HZ * path.time[late]
    waves = [wave(n * turns) for n in range(1, 25) for wave in (np.cos, np.sin)]
    found_terms = np.linalg.lstsq(np.array([np.ones_like(turns), *waves]).T, found.mesh_forces(path)[late, 0])[0]
    return found_terms[1:11:2] + 1j * found_terms[2:11:2]


def away(*settings):
    """How far the lines lie from those of two levels, over the largest."""
    wanted, lines = (mesh_lines(*pair_run(*given)[:2]) for given in ((), settings))
    return np.abs(lines - wanted).max() / np.abs(wanted).max()


def test_smooth_tends_to_two_levels_with_the_square_of_the_width():
    """A step that is odd about its middle changes the n-th line by a share of (n w)^2; 0.41, 0.11, 0.028 measured."""
    errors = [away(SMOOTH, f"stages.psh.mesh.transition = {w}") for w in (0.2, 0.1, 0.05)]
    assert errors[-1] < 0.03
    assert np.divide(errors[:-1], errors[1:]) == pytest.approx(np.full(2, 4.0), rel=0.15)


def test_fourier_tends_to_two_levels_with_the_number_of_harmonics():
    """The run begins at an edge, where the lines left out, b_n ~ 1/n, leave an impulse of sum b_n / n ~ 1/N."""
    wanted = pair_run()[2]
    paths = [pair_run(FOURIER, f"stages.psh.mesh.harmonics = {n}")[2] for n in (20, 40, 80)]
    errors = [np.sqrt(np.mean((path - wanted) ** 2)) / np.ptp(wanted) for path in paths]
    assert errors[-1] < 3e-4  # 8.9e-4, 4.3e-4, 2.1e-4 measured
    assert np.divide(errors[:-1], errors[1:]) == pytest.approx(np.full(2, 2.0), rel=0.15)


# --- the torque of the stiffness


@pytest.mark.parametrize("double_factor", [1.05, 1.5])
def test_the_torque_of_the_stiffness_matters_like_deflection_over_base_pitch(double_factor):
    """Over that ratio times the relative change of stiffness, the force differs by 2 (w = 0.3) or 4 to 5 (0.1)."""
    for width, most in ((0.1, 6.0), (0.3, 3.0)):
        given = (f"stages.psh.mesh.double_factor = {double_factor}", SMOOTH, f"stages.psh.mesh.transition = {width}")
        nominal, actual = case("psh", *given), case("psh", *given, TORQUE)
        runs = [c.run(at=replace(c.at, x=nominal.at.x), method="erk", rtol=1e-9) for c in (nominal, actual)]
        forces = [c.mesh_forces(path)[:, 0] for c, path in zip((nominal, actual), runs, strict=True)]
        deflection = nominal.quantity("mesh_deflection", nominal.at.x, nominal.at.levels)["psh.mesh"][0]
        change = np.sqrt(np.mean((forces[1] - forces[0]) ** 2) / np.mean(forces[0] ** 2))
        assert 1.0 < change / (deflection / BASE_PITCH * (double_factor - 1)) < most


def test_the_torque_of_the_stiffness_at_rest_is_that_of_closed_form():
    """Gear 1 under torque T balances N r_1 + k' delta^2 z / 4 pi, so N (1 + k'/k delta / 2 p_b) = T / r_1.

    Phase 0 is the middle of a step; the load winds gear 1 up by a small part of it.
    """
    torque = 29780.0
    driven = ("-loads.input.speed", f'loads.input.torque = "{-torque} N*m"')
    held = ("-loads.output.torque", 'loads.output.speed = "1795.016 rpm"')
    found = case("psh", STEEP, SMOOTH, TORQUE, TORSIONAL, *driven, *held)
    # An equilibrium is found at the mean stiffness; here it is wanted at this very phase.
    at = _newton(found.library, found.p, found.at.x, found.at.levels, found.at.signals)
    values = found.outputs(at.x, at.levels)
    force, deflection = (values[key, "psh.mesh"][0] for key in ("mesh_force", "mesh_deflection"))
    phase = -59 * at.x[found.state("psh.input.u")] / (2 * np.pi)
    stiffness, slope = smooth_levels(phase, 1.0, 1.5, 0.4, 0.1)  # near its start the pitch's share does not count
    pull = float(slope / stiffness) * deflection / BASE_PITCH / 2
    assert pull < -0.008
    assert force * (1 + pull) == pytest.approx(torque * 2 * np.pi / (59 * BASE_PITCH), rel=1e-9)


# --- rigid joints


def frequencies(scene, *settings):
    found = case(scene, *settings)
    return np.array([mode.frequency_hz for mode in find_modes(linearise(found.point))])


def stiffened(scene, settings, springs, idealised, factors, below=np.inf):
    """Largest relative difference of the lowest frequencies from those of the idealised scene, for each factor."""
    wanted = frequencies(scene, *settings, idealised)
    kept = (wanted > 1e-3) & (wanted < below)
    assert kept.sum() >= 4
    errors = []
    for factor in factors:
        stiff = (f'{key} = "{value * factor} {unit}"' for key, value, unit in springs)
        found = frequencies(scene, *settings, *stiff)[: len(wanted)]
        errors.append(np.abs(found[kept] / wanted[kept] - 1).max())
    return errors


LIN_PARKER = [("stages.gear.pin.stiffness", 1e8, "N/m")]
HSP = [("stages.hsp.pin.stiffness", 4.2e9, "N/m")]
SHAFTS = [
    (f"couplings.{name}.stiffness", stiffness, "N*m/rad")
    for name, stiffness in (
        ("input_shaft", 0.49e8), ("lsp_hsp", 1.81e8), ("hsp_psh", 0.17e8), ("output_shaft", 0.055e8), ("flange", 0.45e8)
    )
]  # fmt: skip


@pytest.mark.parametrize(("scene", "settings", "springs"), [("lin-parker-4", (), LIN_PARKER), ("hsp", UNDAMPED, HSP)])
def test_rigid_pins_are_the_limit_of_stiff_ones(scene, settings, springs):
    errors = stiffened(scene, settings, springs, 'effects.pins = "rigid"', (1e3, 1e4))
    assert errors[0] < 3e-3
    assert errors[0] / errors[1] == pytest.approx(10.0, rel=0.02)


def test_rigid_shafts_are_the_limit_of_stiff_ones():
    """Above 600 Hz torsional modes cross others before they are near, and the order is lost."""
    errors = stiffened("rig-2mw", UNDAMPED, SHAFTS, 'effects.torsional_shafts = "rigid"', (1e4, 1e5, 1e6), below=600.0)
    assert errors[-1] < 2e-5
    assert np.divide(errors[:-1], errors[1:]) == pytest.approx(np.full(2, 10.0), rel=0.02)


@pytest.mark.parametrize(
    ("scene", "settings", "springs"),
    [
        ("lin-parker-4", (), [*LIN_PARKER, *((f"stages.gear.{part}.bearing.stiffness", 1e8, "N/m")
                                             for part in ("sun", "ring", "carrier"))]),
        ("hsp", (*UNDAMPED, *CARRIER_BEARING), [*HSP, ("stages.hsp.sun.bearing.stiffness", 2.6e9, "N/m"),
                                                ("stages.hsp.carrier.bearing.stiffness", 1e9, "N/m")]),
    ],
)  # fmt: skip
def test_torsional_only_is_the_limit_of_stiff_bearings_and_pins(scene, settings, springs):
    errors = stiffened(scene, settings, springs, TORSIONAL, (1e4, 1e6))
    assert errors[1] < 1e-5
    assert errors[0] / errors[1] == pytest.approx(100.0, rel=0.02)


@pytest.mark.parametrize("law", [SMOOTH, FOURIER])
def test_modes_are_those_of_the_mean_stiffness(law):
    """Which phase a run begins at is no property of a gearbox."""
    wanted = frequencies("psh", STEEP, 'effects.mesh_stiffness = "mean"')
    assert frequencies("psh", STEEP, law, "stages.psh.mesh.phase = 0.3") == pytest.approx(wanted, rel=1e-9)
