"""Sliding friction: proven laws, vectors by hand, tooth loss factors, the pitch point, both flanks and senses."""

from itertools import product
from math import acos, cos, pi, sin, sqrt, tan

import numpy as np
import pytest
from ltcgear.generated.errors import SceneError
from ltcgear.runtime.model.rows import over_time
from ltcgear.runtime.simulation.energy_balance import energy_residual
from ltcgear.symbolic.assembly import build_model
from ltcgear.symbolic.checks.all_checks import check_model
from ltcgear.symbolic.elements.key import ElementKey
from ltcgear.symbolic.mechanics.lower import element_function
from ltcgear.symbolic.scene.load import load_scene, make_scene

from ...runtime.models import case, raw_scene

ON = "effects.mesh_friction = 'sliding'"
MU = 1e-3


def friction(mesh, coefficient=MU):
    """Settings that switch sliding friction on in one mesh."""
    return ON, f"stages.{mesh}.friction.coefficient = {coefficient}", f"stages.{mesh}.friction.speed = '1 mm/s'"


SPUR = (
    "stages.psh.helix_angle = '0 deg'",
    "effects.mesh_stiffness = 'mean'",
    *(f"stages.psh.{part}.support = 'rigid'" for part in ("input", "output")),
    *(f"-stages.psh.{part}.bearing" for part in ("input", "output")),
)


# --- the element


@pytest.mark.parametrize("scene", ["psh", "hsp"])
@pytest.mark.parametrize("contact", ["bilateral", "backlash"])
def test_every_check_passes(scene, contact):
    meshes = ["mesh"] if scene == "psh" else ["sun_planet", "ring_planet"]
    changes = {f"stages.{scene}.{mesh}.friction.coefficient": "0.05" for mesh in meshes}
    model = build_model(load_scene(scene, changes | {"effects.mesh_friction": "sliding", "effects.contact": contact}))
    assert sum(i.group == "mesh_sliding" for i in model.instances) == sum(i.group == "mesh" for i in model.instances)
    assert [check.name for check in check_model(model) if not check.passed] == []


@pytest.mark.parametrize(("contact", "count"), [("one-flank", 1), ("backlash", 2)])
def test_pitch_point_friction_follows_the_contact(contact, count):
    changes = {"stages.psh.mesh.friction.coefficient": "0.05", "effects.contact": contact}
    model = build_model(load_scene("psh", changes | {"effects.mesh_friction": "pitch-point"}))
    assert sum(i.group == "mesh_friction" for i in model.instances) == count
    assert [check.name for check in check_model(model) if not check.passed] == []


def cross(one, two):
    return one[0] * two[1] - one[1] * two[0]


def wrench_by_hand(sigma, at, v, load, number):
    """Forces and torques on both gears from places and velocities of the touching points, by vectors."""
    one, two, s = at[:2], at[3:5], number["s"]
    d = np.linalg.norm(two - one)
    alpha = acos((number["r_1"] + sigma * number["r_2"]) / d)
    e = (two - one) / d
    n = sigma * sin(alpha) * e + s * cos(alpha) * np.array([-e[1], e[0]])
    m = s * np.array([n[1], -n[0]])
    share, total, torques = number["varsigma"], np.zeros(2), np.zeros(2)
    phase = (number["tau"] - share / 2 + 0.5) % 1.0 - 0.5
    for g in (phase, phase - np.sign(phase)):
        # From the path's ends, 1 - share / 2 away, a pair's load rises over the length of double contact.
        part = np.clip((1 - share / 2 - abs(g)) / (1 - share), 0.0, 1.0)
        xi = number["xi_m"] + s * 2 * pi * number["r_1"] / number["z_1"] * g
        point = one + number["r_1"] / cos(alpha) * e + xi * n
        arms = point - one, point - two
        speeds = [v[3 * i : 3 * i + 2] + v[3 * i + 2] * np.array([-arm[1], arm[0]]) for i, arm in enumerate(arms)]
        slip = (speeds[1] - speeds[0]) @ m
        force = -number["mu"] * part * load * np.tanh(slip / number["v_0"]) * m
        total += force
        torques += cross(arms[0], -force), cross(arms[1], force)
    return np.array([*-total, torques[0], *total, torques[1]])


@pytest.mark.parametrize(("kind", "s"), list(product(["external", "internal"], [1.0, -1.0])))
def test_wrench_is_that_of_vectors_at_the_touching_points(kind, s):
    rng = np.random.default_rng(3)
    law = {"kind": kind, "law": "involute", "switched": False}
    sliding = element_function(ElementKey.of("mesh_sliding", **law), "newton")
    mesh = element_function(ElementKey.of("mesh", damped=False, **law), "newton")
    sigma, r1, r2 = (1, 0.08, 0.05) if kind == "external" else (-1, 0.2, 0.07)
    d = (r1 + sigma * r2) / cos(0.4)
    number = {
        "r_1": r1, "r_2": r2, "k": 4e8, "mu": 0.06, "v_0": 0.05, "s": s, "e_x": 1.0, "e_y": 0.0,
        "Delta_gamma_0": 0.0, "inv_0": tan(0.4) - 0.4, "xi_m": 1e-3, "varsigma": 0.37, "hold": 0.0,
    }  # fmt: skip
    for _ in range(50):
        number |= {"tau": rng.uniform(-3, 3), "z_1": 31.0 * rng.choice([-1, 1])}
        at = rng.uniform(-1e-4, 1e-4, 6) + np.array([0, 0, 0, d * cos(0.7), d * sin(0.7), 0])
        v = rng.uniform(-2, 2, 6)
        values = dict(zip(sliding.name_in()[:12], [*at, *v], strict=True)) | number
        load = abs(float(mesh(**{key: values[key] for key in mesh.name_in()})["force"][5])) / r2
        found = np.asarray(sliding(**{key: values[key] for key in sliding.name_in()})["force"]).ravel()
        wanted = wrench_by_hand(sigma, at, v, load, number)
        assert found == pytest.approx(wanted, rel=1e-9, abs=1e-9 * np.abs(wanted).max())


# --- tooth losses


def path_ends(z1, z2, sigma, module, distance):
    """Return how far the path of contact goes from the pitch point, towards the tips of gear 2 and of gear 1.

    In base pitches, for standard full-depth teeth of 20 degrees; sigma is -1 where gear 1 is a ring.
    """
    alpha = np.radians(20)
    rb1, rb2 = (z * module * cos(alpha) / 2 for z in (z1, z2))
    working = acos((rb1 + sigma * rb2) / distance)
    length1 = sqrt((z1 * module / 2 + sigma * module) ** 2 - rb1**2)
    length2 = sqrt((z2 * module / 2 + module) ** 2 - rb2**2)
    ends = length2 - rb2 * tan(working), sigma * (length1 - rb1 * tan(working))
    return tuple(end / (pi * module * cos(alpha)) for end in ends)


def textbook(a, b):
    """Mean of part times distance, load shared in halves (Ohlendorf 1958): (1 - eps + eps_1^2 + eps_2^2) / 2."""
    return (1 - a - b + a**2 + b**2) / 2


def linear(a, b):
    """Return the same for a load that rises linearly, integrated by hand over the trapezoid of each pair."""
    return (2 - a - b + 2 * a**2 + 2 * b**2 - 2 * a * b) / 6


def mean_loss(found, mesh, pitches=2):
    """Return the mean power lost [W] over whole tooth pitches."""
    rate = abs(found.model.values()[f"{mesh}.cycles"] * found.model.values()["reference.speed"])
    count = 4000
    path = found.run(method="erk", rtol=1e-9, t_end=pitches / rate, rate=count * rate / pitches)
    assert path.status == "done"
    assert abs(energy_residual(found.point, path)) < 1e-5
    lost = over_time(found.library, "energy", path.x, path.levels, found.p)[:count, 4]
    assert (lost >= 0).all()
    return lost.mean()


@pytest.mark.parametrize(("speed", "torque"), list(product([-600.0, 600.0], [-8e3, 8e3])))
def test_tooth_losses_of_an_external_pair(speed, torque):
    loads = (f"loads.input.speed = '{speed} rpm'", f"loads.output.torque = '{torque} N*m'")
    stiff = ("-stages.psh.mesh.damping_ratio", "stages.psh.mesh.torsional_stiffness = '1e11 N*m/rad'")
    found = case("psh", *SPUR, *friction("psh.mesh"), *loads, *stiff)
    a, b = path_ends(59, 21, 1, 9e-3, 0.36)
    assert a + b == pytest.approx(2 - found.model.values()["psh.mesh.single_share"], rel=1e-9)
    power, u = abs(torque * speed * 2 * pi / 60 * 59 / 21), 21 / 59
    factor, scale = mean_loss(found, "psh.mesh") / MU / power, 2 * pi * (u + 1) / (59 * u)
    assert factor == pytest.approx(scale * linear(a, b), rel=1e-3)
    # Shared in halves, the load of double contact lies farther out: the textbook's loss is larger, by 26 % here.
    assert 0.75 < factor / (scale * textbook(a, b)) < 0.85


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_tooth_losses_of_an_internal_pair(sense):
    off = [f"effects.{name} = 'off'" for name in ("damping", "mesh_damping")]
    loads = (f"loads.ring.speed = '{15 * sense} rpm'", "stages.lsp.ring_planet.friction.speed = '0.1 mm/s'")
    found = case("lsp", *friction("lsp.ring_planet"), *loads, *off, "effects.mesh_stiffness = 'mean'")
    a, b = path_ends(118, 48, -1, 16e-3, 0.56)
    power, u = 2.365e5 * 15 * 2 * pi / 60 * 118 / 22, 48 / 118
    factor = mean_loss(found, "lsp.ring_planet") / MU / power
    assert factor == pytest.approx(2 * pi * (1 - u) / (118 * u) * linear(a, b), rel=1e-3)


def test_equal_sharing_gives_the_textbook_factor():
    """The formulas above against a sum over a pitch, so that neither is only believed."""
    a, b = path_ends(59, 21, 1, 9e-3, 0.36)
    x = np.linspace(-a, b, 2_000_001)
    single = (x > b - 1) & (x < 1 - a)
    halves = np.where(single, 1.0, 0.5)
    slopes = np.clip(np.minimum(x + a, b - x) / (a + b - 1), 0.0, 1.0)
    assert np.trapezoid(halves * np.abs(x), x) == pytest.approx(textbook(a, b), rel=1e-5)
    assert np.trapezoid(slopes * np.abs(x), x) == pytest.approx(linear(a, b), rel=1e-9)
    u = 21 / 59
    ohlendorf = pi * (1 / u + 1) / 59 * (1 - a - b + a**2 + b**2)
    assert 2 * pi * (u + 1) / (59 * u) * textbook(a, b) == pytest.approx(ohlendorf, rel=1e-12)


# --- the pitch point, and off


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_friction_turns_round_where_the_contact_passes_the_pitch_point(sense):
    stiff = ("-stages.psh.mesh.damping_ratio", "stages.psh.mesh.torsional_stiffness = '1e11 N*m/rad'")
    loads = (f"loads.input.speed = '{600 * sense} rpm'", "loads.output.torque = '-8e3 N*m'")
    found = case("psh", *SPUR, *friction("psh.mesh", 0.05), *loads, *stiff)
    values = found.model.values()
    rate = 10.0 * 59
    path = found.run(method="erk", rtol=1e-8, t_end=3 / rate, rate=rate * 20000)
    force = found.quantity("mesh_friction", path.x, path.levels)["psh.mesh"]
    phase = (rate * path.time) % 1.0
    a, b = path_ends(59, 21, 1, 9e-3, 0.36)
    share = 2 - a - b
    # A pair enters at one end with single contact beginning eps - 1 further; the pitch point lies a or b from it.
    towards_tip_1 = sense * values["psh.mesh.flank"] > 0
    passes = (a if towards_tip_1 else b) - (a + b - 1)
    assert 0 < passes < share
    turns = np.flatnonzero(np.diff(np.sign(force)) != 0)
    inside = turns[(phase[turns] > 0.01) & (phase[turns] < share - 0.01)]
    assert len(inside) == 3
    assert phase[inside] == pytest.approx(passes, abs=2e-4)


def test_no_coefficient_is_the_same_as_off():
    sliding = case("psh", *friction("psh.mesh", 0.0)).run(method="erk", rtol=1e-8, t_end=0.01)
    off = case("psh").run(method="erk", rtol=1e-8, t_end=0.01)
    assert np.abs(sliding.x - off.x).max() <= 1e-12 * np.abs(off.x).max()


def test_parted_teeth_do_not_rub():
    gap = ("effects.contact = 'backlash'", "stages.psh.mesh.backlash = '0.2 mm'")
    found = case("psh", *friction("psh.mesh", 0.05), *gap)
    x = np.zeros(len(found.library.manifest.states))
    names = [state.name for state in found.library.manifest.states]
    for turned, sides in ((0.05e-3, (True, False)), (-0.1e-3, (False, False)), (-0.25e-3, (False, True))):
        x[names.index("psh.output.u")] = -turned / found.model.values()["psh.mesh.base_radius_2"]
        rubs = found.quantity("mesh_friction", x, np.zeros(1))
        assert tuple(bool(force[0]) for force in rubs.values()) == sides


# --- scenes


@pytest.mark.parametrize(
    ("name", "settings", "words"),
    [
        ("lin-parker-3", friction("gear.sun_planet"), "sun_planet.friction: sliding needs the teeth"),
        ("psh", (*SPUR, *friction("psh.mesh"), "stages.psh.center_distance = '363 mm'",
                 "-stages.psh.mesh.double_factor", "stages.psh.input.profile_shift = -1.5"), "contact_ratio"),
        ("psh", (*friction("psh.mesh"), "stages.psh.output.teeth = 10", "stages.psh.mesh.contact_ratio = 1.9"),
         "past a base circle"),
    ],
)  # fmt: skip
def test_what_cannot_slide_is_refused(name, settings, words):
    with pytest.raises(SceneError, match=words):
        make_scene(raw_scene(name, *settings))


def test_a_given_contact_ratio_keeps_the_middle_of_the_path():
    given = case("psh", *friction("psh.mesh"), "stages.psh.mesh.contact_ratio = 1.5").model.values()
    computed = case("psh", *friction("psh.mesh")).model.values()
    assert given["psh.mesh.single_share"] == 0.5
    assert given["psh.mesh.path_middle"] == computed["psh.mesh.path_middle"] != 0.0


def test_damping_is_of_the_pitch_point_only():
    raw = (*friction("psh.mesh"), "stages.psh.mesh.friction.damping = '1e3 N*s/m'")
    assert not any("friction.damping" in name for name in case("psh", *raw).model.values())
