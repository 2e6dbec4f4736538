"""One-sided contact: proven laws, no tension, the other flank, the same motion as long as nothing parts."""

import numpy as np
import pytest
from ltcgear.runtime.model.function import Kernel
from ltcgear.symbolic.assembly import build_model
from ltcgear.symbolic.checks.all_checks import check_model
from ltcgear.symbolic.describe.advice import warnings
from ltcgear.symbolic.scene.load import load_scene

from ...runtime.models import case

GAP = "stages.psh.mesh.backlash = '0.2 mm'"


@pytest.mark.parametrize("law", ["involute", "paper"])
@pytest.mark.parametrize("contact", ["one-flank", "backlash"])
def test_every_check_passes(contact, law):
    model = build_model(load_scene("psh", {"effects.contact": contact, "effects.mesh_law": law}))
    assert [check.name for check in check_model(model) if not check.passed] == []


def forces(found, x, levels):
    """Return the mesh forces of a state by mesh."""
    values = Kernel(found.library.functions["outputs"])(x, levels, found.p)[0]
    pairs = zip(found.library.manifest.reports, values, strict=True)
    return {report.item: value for report, value in pairs if report.quantity == "mesh_force"}


def test_no_state_and_no_speed_makes_a_tooth_pull():
    found = case("psh", "effects.contact = 'backlash'", GAP)
    rng, states = np.random.default_rng(1), found.library.manifest.states
    scale = np.array([30.0 if s.unit.endswith("/s") else 1e-3 for s in states])
    seen = []
    for _ in range(500):
        seen.append(list(forces(found, scale * rng.standard_normal(len(states)), rng.random(1)).values()))
    assert np.min(seen) == 0.0
    assert (np.max(seen, axis=0) > 1e4).all()


def test_flanks_do_not_touch_both_inside_the_gap():
    found = case("psh", "effects.contact = 'backlash'", GAP)
    x = np.zeros(len(found.library.manifest.states))
    names = [state.name for state in found.library.manifest.states]
    flank = -1.0  # the PSH carries on the flank opposite to the printed one
    radius = 21 * 0.009 / np.cos(np.radians(8)) / 2 * np.cos(np.radians(20.18110))
    for turned, expected in ((0.05e-3, (True, False)), (-0.1e-3, (False, False)), (-0.25e-3, (False, True))):
        x[names.index("psh.output.u")] = flank * turned / radius
        front, back = forces(found, x, np.zeros(1)).values()
        assert (front > 0, back > 0) == expected


def test_while_nothing_parts_one_flank_moves_like_a_bilateral_mesh():
    bilateral = case("lsp").run(method="erk", rtol=1e-9, t_end=0.05)
    one_flank = case("lsp", "effects.contact = 'one-flank'").run(method="erk", rtol=1e-9, t_end=0.05)
    size = np.abs(bilateral.x - bilateral.x[0]).max(axis=0)
    moving = size > 1e-9  # symmetry keeps the others at rest, up to rounding
    assert moving.sum() > 15
    assert (np.abs(one_flank.x - bilateral.x).max(axis=0)[moving] <= 1e-6 * size[moving]).all()


@pytest.mark.parametrize(("torque", "flank"), [("-1.06e4 N*m", -1.0), ("1.06e4 N*m", 1.0)])
def test_the_load_decides_which_flank_carries(torque, flank):
    found = case("psh", "effects.contact = 'backlash'", GAP, f"loads.output.torque = '{torque}'")
    front, back = forces(found, found.at.x, found.at.levels).values()
    assert (front, back) == (pytest.approx(1.1834e5, rel=5e-3), 0.0)
    assert found.model.values()["psh.mesh.flank"] == flank


def test_a_missing_gap_is_told():
    assert "backlash" in warnings(load_scene("psh", {"effects.contact": "backlash"}))[0]
