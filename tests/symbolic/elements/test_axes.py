"""Axes of elements are data: dead ones cost nothing and change nothing."""

from dataclasses import replace

import casadi as ca
import pytest
import sympy as sp
from ltcgear.symbolic.assembly import build_model
from ltcgear.symbolic.checks.agree import evaluate, largest_difference, random_points
from ltcgear.symbolic.elements.axes import PLANE, THETA, X, Y
from ltcgear.symbolic.elements.element_types import keep_axes, make
from ltcgear.symbolic.elements.key import ElementKey
from ltcgear.symbolic.mechanics.equations import derive
from ltcgear.symbolic.scene.load import load_scene

MESH = ElementKey.of("mesh", kind="internal", law="involute", switched=False, damped=True)


def test_a_key_does_not_mind_the_order_of_its_options():
    assert ElementKey.of("pin", damped=True, b="c") == ElementKey.of("pin", b="c", damped=True)
    assert MESH["kind"] == "internal"


def test_a_coupling_knows_angles_only():
    element = make(ElementKey.of("coupling", damped=True))
    assert [symbol.name for symbol in element.arguments] == [
        "theta_1", "theta_2", "omega_1", "omega_2", "k_t", "c_t",
    ]  # fmt: skip
    assert {axis for _, axis in element.wrench} == {THETA}
    assert [axis.load_unit for axis in PLANE] == ["N", "N", "N*m"]


@pytest.mark.parametrize("live", [(), ("theta",), ("x",), ("x", "theta")])
def test_dead_axes_are_zeros_in_the_law(live):
    whole = make(MESH)
    one, two = whole.ports
    kept = keep_axes(whole, (live, ("x", "y", "theta")))
    dead = {one.coordinate(a): 0 for a in PLANE if a.name not in live}
    dead |= {one.rate(a): 0 for a in PLANE if a.name not in live}
    assert kept.ports == (replace(one, axes=tuple(a for a in PLANE if a.name in live)), two)
    assert not set(dead) & set(kept.arguments)
    for before, after in [(whole.potential, kept.potential), (whole.dissipation, kept.dissipation)]:
        assert after == before.xreplace(dead)
        assert not set(dead) & after.free_symbols
    for (port, axis), load in kept.wrench.items():
        assert load == whole.wrench[replace(port, axes=PLANE), axis].xreplace(dead)
    assert len(kept.loads) == len(live) + 3


def test_a_scene_whose_gears_only_turn_has_one_axis():
    torsional = build_model(load_scene("rig-2mw", changes={"effects.lateral": "off"}))
    assert {axes for item in torsional.instances for axes in item.element.live} == {("theta",)}
    assert all(set(body.freedoms) <= {"u"} for body in torsional.bodies)
    assert {axes for item in build_model(load_scene("lsp")).instances for axes in item.element.live} == {
        ("x", "y", "theta")
    }


def not_at_zero(model):
    """Return body -> names of the axes on which it is not at zero for ever."""
    found = {}
    for body in model.bodies:
        leader = next(item for item in model.bodies if item.name == (body.leader or body.name))
        sideways = bool(body.freedoms[:2] == ("x", "y") or body.place or body.seat)
        turns = body.ratio is not None or "u" in leader.freedoms
        found[body.name] = tuple(axis.name for axis in PLANE if (turns if axis.rotation else sideways))
    return found


@pytest.mark.parametrize("name", ["rig-2mw", "hsp"])
def test_each_body_may_have_axes_of_its_own(name):
    """The ring that is held has none, a motor one: the same motion, from no more operations."""
    model = build_model(load_scene(name))
    axes = not_at_zero(model)
    assert len(set(axes.values())) > 1
    own = replace(
        model,
        instances=tuple(
            replace(item, element=replace(item.element, live=tuple(axes[body] for body in item.bodies)))
            for item in model.instances
        ),
    )
    plain, bare = derive(model), derive(own)
    points = random_points(model, plain, 50.0)
    assert largest_difference(*(evaluate(e, e.xdot, points) for e in (plain, bare))) < 1e-12
    counts = [ca.Function("f", [e.x, e.s, e.p], [ca.cse(e.xdot)]).n_instructions() for e in (bare, plain)]
    assert counts[0] <= counts[1]


def test_a_force_along_a_dead_axis_is_left_out():
    pin = make(ElementKey.of("pin", damped=False))
    carrier, planet = pin.ports
    kept = keep_axes(pin, (("theta",), ("x", "y")))
    assert [(port.tag, axis) for port, axis in kept.wrench] == [("_1", THETA), ("_2", X), ("_2", Y)]
    torque = kept.wrench[kept.ports[0], THETA]
    still = {carrier.x: 0, carrier.y: 0}
    assert sp.simplify(torque - pin.wrench[carrier, THETA].xreplace(still)) == 0
    assert all(planet.theta not in load.free_symbols for load in kept.loads)
