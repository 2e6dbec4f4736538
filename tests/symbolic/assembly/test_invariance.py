"""What must not depend on how a scene is laid out, and small laws in closed form."""

import numpy as np
import pytest
from ltcgear.symbolic.assembly import build_model
from ltcgear.symbolic.describe.advice import warnings
from ltcgear.symbolic.gears import gear_geometry
from ltcgear.symbolic.scene.load import load_scene, make_scene

from ...runtime.models import case, raw_scene

FRICTION = (
    'effects.lateral = "off"',
    'effects.planet_position_error = "on"',
    "stages.lsp.position_errors = [{planet = 2, tangential = '50 um', radial = '30 um'}]",
    "stages.lsp.sun_planet.friction = {coefficient = 0.1, speed = '1e-9 m/s'}",
    "stages.lsp.ring_planet.friction = {coefficient = 0.1, speed = '1e-9 m/s'}",
)


def spread(found):
    """Largest over mean force of the meshes, second half of a short run."""
    path = found.run(method="erk", rtol=1e-7, t_end=0.2)
    forces = found.mesh_forces(path)[len(path.time) // 2 :]
    return forces.max(axis=0) / forces.mean(axis=0)


def test_a_turned_stage_runs_alike():
    """Without gravity nothing knows where up is: not even the mesh phases."""
    turned = spread(case("lsp", 'stages.lsp.line_of_centres = "10 deg"'))
    assert turned == pytest.approx(spread(case("lsp")), rel=1e-5)


@pytest.mark.parametrize("law", ["pitch-point", "sliding"])
def test_friction_presses_as_its_mesh_does_where_a_pin_is_out_of_place(law):
    """Coulomb: at any speed well above v_0 a contact rubs with mu N; both pairs rub one way in single contact."""
    found = case("lsp", *FRICTION, f"effects.mesh_friction = '{law}'")
    x = found.at.x.copy()
    rng = np.random.default_rng(3)
    for i, state in enumerate(found.library.manifest.states):
        if state.name.endswith(".rate"):
            x[i] = 1e-2 * rng.uniform(-1, 1)
    values = found.outputs(x, found.at.levels)
    meshes = [item for quantity, item in values if quantity == "mesh_friction"]
    # The spring's part alone presses friction: the damper's is what the deflection does not give.
    stiffness = {
        m: (1 - level) * found.model.values()[f"{m.rsplit('.', 1)[0]}.stiffness_single"]
        + level * found.model.values()[f"{m.rsplit('.', 1)[0]}.stiffness_double"]
        for m, level in zip(found.library.manifest.levels, found.at.levels, strict=True)
    }
    ratios = [
        abs(values["mesh_friction", m][0]) / (stiffness[m] * values["mesh_deflection", m][0])
        for m in meshes
        if m in stiffness
    ]
    assert len(ratios) >= 4
    if law == "pitch-point":
        assert ratios == pytest.approx([0.1] * len(ratios), rel=1e-6)
    else:  # pairs on both sides of the pitch point rub against each other
        assert max(ratios) < 0.1 * (1 + 1e-6)


def test_weight_of_planets_turns_a_carrier_that_cannot_move_sideways():
    """One planet on a rigid pin: the weight's energy is m g y of its pin, whatever the carrier's support."""
    raw = raw_scene(
        "hsp", 'effects.gravity = "on"', 'effects.pins = "rigid"', 'stages.hsp.planet_angles = ["0 deg"]',
        "stages.hsp.planets = 1", 'stages.hsp.carrier.support = "rigid"', 'stages.hsp.line_of_centres = "90 deg"',
    )  # fmt: skip
    model = build_model(make_scene(raw))
    values = model.values()
    assert values["hsp.carrier.seated_mass"] * values["hsp.carrier.mass_centre.y_0"] == pytest.approx(
        case("hsp").model.values()["hsp.planet.mass"] * 0.408
    )
    assert any(i.group == "gravity" and i.bodies == ("hsp.carrier.mass_centre",) for i in model.instances)


def test_thinner_teeth_open_the_gap():
    """Normal thinning is 1 / cos(beta) wider in the transverse section, and cos(alpha_t) of that along the line."""
    raw = raw_scene(
        "psh", "stages.psh.input.tooth_thinning = '60 um'", "stages.psh.output.tooth_thinning = '40 um'",
        "effects.contact = 'backlash'",
    )  # fmt: skip
    stage = make_scene(raw).stages["psh"]
    transverse = np.arctan(np.tan(np.radians(20)) / np.cos(np.radians(8)))
    expected = 100e-6 / np.cos(np.radians(8)) * np.cos(transverse)
    assert gear_geometry.backlash(stage, stage.mesh, stage.input, stage.output) == pytest.approx(expected, rel=1e-12)
    assert build_model(make_scene(raw)).values()["psh.mesh.backlash"] == pytest.approx(expected)


def test_a_computed_stiffness_that_cannot_be_computed_is_told():
    (line,) = warnings(load_scene("lsp", {"effects.mesh_stiffness": "computed"}))
    assert "computed" in line
    assert "face_width" in line
