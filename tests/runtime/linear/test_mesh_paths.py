"""Stiffness and damper of meshes in small motions are the parameters, and what the force's derivatives say."""

import pytest
from ltcgear.runtime.linear.inputs import find_paths, project_spring
from ltcgear.runtime.linear.system import linearise

from ..models import case


def paths(name, *settings):
    c = case(name, *settings)
    linear = linearise(c.point)
    return linear, find_paths(linear)


@pytest.mark.parametrize("name", ["rig-2mw", "lin-parker-3", "start-up"])
def test_what_is_read_is_what_the_force_does(name):
    """Two levels, one number, and two flanks of which one is apart."""
    linear, found = paths(name)
    for path in found.values():
        wanted = project_spring(linear, path.deflection[linear.positions], path.force)
        assert (path.stiffness, path.damping) == pytest.approx(wanted, rel=1e-9)


def test_teeth_that_are_apart_have_no_stiffness():
    """Before the speed rises the load presses the other flanks."""
    _, found = paths("start-up")
    assert found["pair.mesh"].stiffness == found["pair.mesh"].damping == 0.0
    assert found["pair.mesh.back"].stiffness > 0.0


def test_a_constant_stiffness_is_read_to_the_last_bit():
    linear, found = paths("lin-parker-3")
    assert found["gear.sun_planet.1"].stiffness == linear.number["gear.sun_planet.stiffness"]
