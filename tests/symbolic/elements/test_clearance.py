"""Bearings with clearance: a disc in its race against closed forms, and gears that use their clearance up."""

from math import atan, hypot, pi, sqrt

import numpy as np
import pytest
from ltcgear.generated.errors import SceneError, SolverError
from ltcgear.runtime.linear.modes import find_modes
from ltcgear.runtime.linear.system import linearise
from ltcgear.runtime.model.building import build
from ltcgear.runtime.model.continuation import follow
from ltcgear.runtime.model.equilibrium import find_equilibrium
from ltcgear.runtime.model.operating_point import OperatingPoint
from ltcgear.runtime.model.rows import over_time
from ltcgear.runtime.model.state_matrix import Equilibrium
from ltcgear.runtime.simulation.energy_balance import energy_residual
from ltcgear.symbolic.assembly import build_model
from ltcgear.symbolic.checks.all_checks import check_model
from ltcgear.symbolic.describe.advice import warnings
from ltcgear.symbolic.elements.key import ElementKey
from ltcgear.symbolic.emit.pipeline import obtain
from ltcgear.symbolic.mechanics.model import BASIS, Body, Instance, Model, Parameter
from ltcgear.symbolic.scene.load import load_scene, make_scene
from ltcgear.symbolic.schema.effects import DEFAULTS

from ...runtime.models import Case, case, raw_scene

K, M, GAP, G = 4e6, 3.0, 2e-4, 9.81
ON = "effects.bearing_clearance = 'on'"
PAIR = (ON, "stages.psh.input.bearing.clearance = '50 um'", "stages.psh.output.bearing.clearance = '80 um'")


def disc(gravity=G, damping=0.0):
    """One disc that only shifts, in a race of clearance ``GAP``, with its weight along -y."""
    numbers = {
        "disc.mass": (M, "kg"), "k": (K, "N/m"), "origin": (0.0, "m"), "clearance": (GAP, "m"), "hold.disc": (0.0, "m"),
        "bearing.closing": (0.0, ""), "bearing.rounding": (1e-9, "m"), "gravity.x": (0.0, "m/s^2"),
        "gravity.y": (-gravity, "m/s^2"),
    } | ({"c": (damping, "N*s/m")} if damping else {})  # fmt: skip
    race = {"k": "k", "x_0": "origin", "y_0": "origin", "clearance": "clearance", "closing": "bearing.closing",
            "epsilon": "bearing.rounding", "hold": "hold.disc"} | ({"c": "c"} if damping else {})  # fmt: skip
    weight = {"m": "disc.mass", "g_x": "gravity.x", "g_y": "gravity.y", "beta": BASIS}
    parts = [ElementKey.of("ground_clearance", damped=bool(damping)), ElementKey("gravity")]
    model = Model(
        "disc", "disc", "rest", (Body("disc", ("x", "y"), "held", "disc.mass", None, None, None, ""),), {"": None},
        tuple(Instance("disc", e, ("disc",), b) for e, b in zip(parts, (race, weight), strict=True)),
        (), (), (), tuple(Parameter(name, *value) for name, value in numbers.items()), DEFAULTS, {},
    )  # fmt: skip
    return Case(None, model, build(obtain(model)))


def start(found, **given):
    """Return a start with some states given."""
    x = np.zeros(len(found.library.manifest.states))
    for name, value in given.items():
        x[found.state(f"disc.{name.replace('_', '.')}")] = value
    return Equilibrium(x, np.zeros(0), 0.0, 0)


# --- a disc in its race


def test_a_disc_rests_on_its_race():
    found = disc()
    assert found.at.x[found.state("disc.y")] == pytest.approx(-(GAP + M * G / K), rel=1e-10)
    assert found.at.x[found.state("disc.x")] == 0.0


def test_a_disc_on_its_race_swings_like_a_pendulum_and_bounces_on_its_spring():
    found = disc()
    across, up = [mode.frequency_hz * 2 * pi for mode in find_modes(linearise(found.point))]
    assert across == pytest.approx(sqrt(G / (GAP + M * G / K)), rel=1e-9)
    assert up == pytest.approx(sqrt(K / M), rel=1e-9)


def test_a_disc_moves_straight_within_its_clearance():
    found = disc(gravity=0.0)
    vx, vy, end = 3e-3, -2e-3, 0.04
    path = found.run(at=start(found, x=-3e-5, x_rate=vx, y_rate=vy), t_end=end, rate=5000.0, method="erk", rtol=1e-9)
    assert path.status == "done"
    assert hypot(-3e-5 + vx * end, vy * end) < GAP
    assert path.x[:, found.state("disc.x")] == pytest.approx(-3e-5 + vx * path.time, abs=1e-15)
    assert path.x[:, found.state("disc.y")] == pytest.approx(vy * path.time, abs=1e-15)


def test_a_disc_that_falls_bounces_with_the_period_of_fall_and_spring():
    found = disc()
    at = start(found)
    # Fall through the gap, then half a swing about the static deflection, from -g/w^2 to the same again.
    w, speed = sqrt(K / M), sqrt(2 * G * GAP)
    period = 2 * sqrt(2 * GAP / G) + (pi + 2 * atan(G / (w * speed))) / w
    path = found.run(at=at, t_end=3 * period, rate=20000 / period, method="erk", rtol=1e-11)
    height = path.x[:, found.state("disc.y")]
    assert abs(path.energy[1] - path.energy[0] - path.work) < 1e-7 * M * G * GAP
    low = height[:20001].min()
    # m g (c + d) = k d^2 / 2
    assert -low - GAP == pytest.approx((M * G + sqrt((M * G) ** 2 + 2 * K * M * G * GAP)) / K, rel=1e-6)
    assert abs(height[60000 - 1]) < 1e-4 * GAP
    assert abs(height[40000]) < 1e-4 * GAP


def test_the_damper_acts_in_contact_only_and_its_loss_is_booked():
    found = disc(damping=2e2)
    at = start(found)
    fall = sqrt(2 * GAP / G)
    path = found.run(at=at, t_end=0.5, rate=20000.0, method="erk", rtol=1e-10)
    assert abs(energy_residual(OperatingPoint(found.library, found.p, at), path)) < 1e-6
    free = path.time < fall
    height = path.x[:, found.state("disc.y")]
    assert height[free] == pytest.approx(-G * path.time[free] ** 2 / 2, abs=1e-12)
    assert height[-1] == pytest.approx(-(GAP + M * G / K), rel=1e-3)


def test_an_unloaded_disc_rests_anywhere_and_can_be_integrated():
    found = disc(gravity=0.0)
    assert np.abs(found.at.x).max() == 0.0
    assert found.run(t_end=0.01, rate=1000.0, method="erk", rtol=1e-6).status == "done"


# --- gears


@pytest.mark.parametrize("scene", ["psh", "hsp"])
def test_every_check_passes(scene):
    changes = {"effects.bearing_clearance": "on"}
    if scene == "psh":
        changes |= {"stages.psh.input.bearing.clearance": "50 um", "effects.damping": "off"}
    else:
        changes |= {"stages.hsp.pin.clearance": "30 um", "stages.hsp.sun.bearing.clearance": "40 um",
                    "effects.bearing_friction": "on", "stages.hsp.pin.friction": "0.02",
                    "stages.hsp.pin.diameter": "300 mm"}  # fmt: skip
    model = build_model(load_scene(scene, changes))
    assert any("clearance" in instance.group for instance in model.instances)
    assert [check.name for check in check_model(model) if not check.passed] == []


@pytest.mark.parametrize("more", [(), ("effects.gravity = 'on'",), ("effects.contact = 'backlash'",
                         "stages.psh.mesh.backlash = '0.2 mm'", "effects.gravity = 'on'")])  # fmt: skip
def test_loaded_gears_lie_a_clearance_and_a_deflection_away(more):
    found = case("psh", *PAIR, *more)
    shown = found.outputs(found.at.x, found.at.levels)
    for gear, gap in (("psh.input", 50e-6), ("psh.output", 80e-6)):
        place = np.array([found.at.x[found.state(f"{gear}.{axis}")] for axis in "xy"])
        force = np.array([shown[f"bearing_force_{axis}", gear][0] for axis in "xy"])
        stiffness = found.model.values()[f"{gear}.bearing.stiffness"]
        assert hypot(*force) > 1e5
        assert hypot(*place) == pytest.approx(gap + hypot(*force) / stiffness, rel=1e-10)
        assert place @ force == pytest.approx(-hypot(*place) * hypot(*force), rel=1e-12)


def test_planets_use_the_clearance_of_their_pins_up():
    found = case("lsp", ON, "stages.lsp.pin.clearance = '30 um'")
    shown, turned = found.outputs(found.at.x, found.at.levels), found.at.x[found.state("lsp.planet.1.y")]
    force = [hypot(shown["pin_force_x", f"lsp.pin.{i}"][0], shown["pin_force_y", f"lsp.pin.{i}"][0]) for i in (1, 2)]
    place = hypot(found.at.x[found.state("lsp.planet.1.x")], turned)
    assert place == pytest.approx(30e-6 + force[0] / found.model.values()["lsp.pin.stiffness"], rel=1e-8)
    assert force[0] == pytest.approx(force[1], rel=1e-6)


def test_a_train_with_clearance_keeps_its_energy_balance():
    found = case("psh", *PAIR, "effects.gravity = 'on'")
    path = found.run(method="erk", rtol=1e-8, t_end=0.05)
    assert path.status == "done"
    assert abs(energy_residual(found.point, path)) < 1e-6


def test_no_clearance_is_the_same_as_off():
    none, off = case("psh", ON, "stages.psh.input.bearing.clearance = '0 mm'"), case("psh")
    assert none.at.x == pytest.approx(off.at.x, rel=1e-12, abs=1e-18)
    rng = np.random.default_rng(5)
    states = [off.at.x, np.zeros_like(off.at.x), *(off.at.x + rng.normal(0, 1e-4, (20, len(off.at.x))))]
    one, other = (
        over_time(found.library, "rhs", np.array(states), np.full((22, 1), 0.3), found.p) for found in (none, off)
    )
    assert (np.abs(one - other) <= 1e-12 * np.abs(other).max(axis=0)).all()


def test_only_bearings_that_give_a_clearance_get_one():
    groups = {i.name: i.group for i in case("psh", ON, "stages.psh.input.bearing.clearance = '1 um'").model.instances}
    assert (groups["psh.input"], groups["psh.output"]) == ("ground_clearance", "ground_bearing")


def test_a_scene_without_a_clearance_is_warned_and_a_negative_one_refused():
    (line,) = warnings(load_scene("psh", {"effects.bearing_clearance": "on"}))
    assert "with clearance" in line
    with pytest.raises(SceneError, match=r"input\.bearing\.clearance: must not be negative"):
        make_scene(raw_scene("psh", ON, "stages.psh.input.bearing.clearance = '-1 um'"))


# --- the continuation


def test_following_takes_steps_as_small_as_it_must():
    asked = []

    def solve(at, guess):
        asked.append(at)
        if abs(guess[0] - (1 - at) ** 2) > 1e-3:
            raise SolverError("too far")
        return np.array([(1 - at) ** 2])

    assert follow(solve, np.zeros(1)) == pytest.approx([1.0])
    assert asked[-1] == 0.0
    assert min(abs(np.diff(asked))) < 0.1


def test_following_what_has_no_end_fails_with_the_reason():
    def solve(at, guess):
        if at < 0.5:
            raise SolverError("nothing holds it")
        return guess

    with pytest.raises(SolverError, match="nothing holds it"):
        follow(solve, np.zeros(1))


def test_a_load_that_nothing_meets_is_still_named():
    found = case("psh", *PAIR)
    values = found.model.values() | {"psh.input.bearing.stiffness": 0.0}
    with pytest.raises(SolverError, match="no equilibrium"):
        find_equilibrium(found.library, found.library.parameters(values))
