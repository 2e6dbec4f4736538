"""Rayleigh damping: modal damping ratios in closed form, the energy balance of turning trains, and its limits."""

import numpy as np
import pytest
from ltcgear.generated.errors import SceneError
from ltcgear.runtime.linear.modes import find_modes
from ltcgear.runtime.linear.system import linearise
from ltcgear.runtime.model.rows import over_time
from ltcgear.runtime.simulation.energy_balance import energy_residual
from ltcgear.symbolic.assembly import build_model
from ltcgear.symbolic.checks.all_checks import check_model
from ltcgear.symbolic.describe.advice import warnings
from ltcgear.symbolic.scene.load import load_scene, make_scene

from ...runtime.models import TORQUE_DRIVEN, case, raw_scene

ALPHA, BETA = 40.0, 1e-6
ON = ("effects.damping = 'rayleigh'", f"rayleigh.mass = '{ALPHA} 1/s'", f"rayleigh.stiffness = '{BETA} s'")
ON_SET = {"effects.damping": "rayleigh", "rayleigh.mass": f"{ALPHA} 1/s", "rayleigh.stiffness": f"{BETA} s"}


@pytest.mark.parametrize("scene", ["lin-parker-3", "lin-parker-4", "lin-parker-5"])
@pytest.mark.parametrize(("alpha", "beta"), [(ALPHA, BETA), (ALPHA, 0.0), (0.0, BETA)])
def test_every_mode_has_the_damping_ratio_of_its_frequency(scene, alpha, beta):
    """zeta = alpha / 2 omega + beta omega / 2, at the frequencies of the undamped gear."""
    settings = ("effects.damping = 'rayleigh'", f"rayleigh.mass = '{alpha} 1/s'", f"rayleigh.stiffness = '{beta} s'")
    damped, bare = case(scene, *settings), case(scene)
    found, plain = (find_modes(linearise(c.point)) for c in (damped, bare))
    # The gear that turns freely comes to rest with exp(-alpha t): no oscillation, and no frequency of its own.
    slow = [mode for mode in found if mode.kind != "rigid" and mode.frequency_hz < 100]
    assert [mode.frequency_hz * 2 * np.pi for mode in slow] == ([pytest.approx(alpha, rel=1e-6)] if alpha else [])
    elastic = [mode for mode in found if mode.frequency_hz > 100]
    undamped_ones = [mode for mode in plain if mode.kind != "rigid"]
    assert len(elastic) == len(undamped_ones) == 3 * int(scene[-1]) + 8
    for mode, undamped in zip(elastic, undamped_ones, strict=True):
        omega = 2 * np.pi * undamped.frequency_hz
        assert mode.frequency_hz == pytest.approx(undamped.frequency_hz, rel=1e-9)
        assert mode.damping_ratio == pytest.approx(alpha / (2 * omega) + beta * omega / 2, rel=1e-9, abs=1e-13)


@pytest.mark.parametrize("scene", ["rig-2mw", "hsp", "lin-parker-3"])
def test_every_check_passes(scene):
    model = build_model(load_scene(scene, ON_SET))
    assert sum(instance.group == "rayleigh" for instance in model.instances) > 4
    assert [check.name for check in check_model(model) if not check.passed] == []


@pytest.mark.parametrize("settings", [(), TORQUE_DRIVEN])
def test_the_energy_balance_of_the_rig_closes(settings):
    found = case("rig-2mw", *ON, *settings)
    path = found.run(method="erk", rtol=1e-8, t_end=0.05)
    assert path.status == "done"
    assert abs(energy_residual(found.point, path)) < 1e-6


def test_the_rigid_motion_is_not_slowed_down():
    found, free = case("rig-2mw", *ON), case("rig-2mw", "effects.damping = 'off'", "effects.mesh_damping = 'off'")
    at = np.abs(free.at.x).max()
    assert found.at.x == pytest.approx(free.at.x, rel=1e-9, abs=1e-12 * at)
    lost = over_time(found.library, "energy", found.at.x[None], found.at.levels[None], found.p)[0, 4]
    assert abs(lost) < 1e-20


def test_every_damper_comes_from_its_spring_and_none_from_its_ratio():
    values = case("rig-2mw", *ON).model.values()
    for name, value in values.items():
        if name.endswith(".damping"):
            stem = name.removesuffix(".damping")
            spring = values.get(f"{stem}.stiffness")
            if spring is None:
                share = values[f"{stem}.single_share"]
                spring = share * values[f"{stem}.stiffness_single"] + (1 - share) * values[f"{stem}.stiffness_double"]
            assert value == pytest.approx(BETA * spring, rel=1e-12)
    assert "lsp.ring.bearing.damping" in values
    assert "psh.mesh.damping" in values


def test_a_mesh_without_damping_keeps_none():
    values = case("psh", *ON, "effects.mesh_damping = 'off'").model.values()
    assert "psh.mesh.damping" not in values
    assert "psh.input.bearing.damping" in values


def test_a_factor_of_nothing_leaves_nothing():
    settings = ("effects.damping = 'rayleigh'", "rayleigh.stiffness = '1e-6 s'")
    assert not any(instance.group == "rayleigh" for instance in case("psh", *settings).model.instances)


def test_a_scene_without_the_table_is_warned():
    (line,) = warnings(load_scene("psh", {"effects.damping": "rayleigh"}))
    assert "it needs a rayleigh table" in line
    assert warnings(load_scene("psh", ON_SET)) == []


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ((*ON[:1], "rayleigh.mass = '0 1/s'"), "damps nothing"),
        ((*ON[:1], "rayleigh.mass = '-1 1/s'"), "rayleigh.mass: must not be negative"),
        ((*ON, "effects.contact = 'backlash'"), "no constant damper"),
        ((*ON, "effects.bearing_clearance = 'on'"), "no constant damper"),
    ],
)
def test_what_does_not_go_together_is_refused(settings, words):
    with pytest.raises(SceneError, match=words):
        make_scene(raw_scene("psh", *settings))
