"""The loaded equilibrium against statics, and what has none."""

import numpy as np
import pytest
from ltcgear.generated.errors import SolverError
from ltcgear.runtime.model.equilibrium import find_equilibrium
from ltcgear.runtime.model.function import Kernel

from ..hand_gearing import contact_ratio
from ..models import MESHES, TORQUE_DRIVEN, Case, case, make_case

STATICS = {"lsp": 3.575e5, "hsp": 1.0357e5, "psh": 1.1834e5}
"""Normal forces [N], lossless, by torque over n r_b (READING.md)."""
G = 9.80665


def forces(c):
    """Mesh -> force at the equilibrium [N]."""
    return {item: float(v[0]) for item, v in c.quantity("mesh_force", c.at.x, c.at.levels).items()}


def stage_mean(c, mesh):
    return np.mean([value for item, value in forces(c).items() if item.startswith(mesh)])


def total(c, quantity, axis):
    return sum(float(v[0]) for v in c.quantity(f"{quantity}_{axis}", c.at.x, c.at.levels).values())


def rotors(**tables):
    return {"title": "rotors", **tables}


@pytest.mark.parametrize("scene", ["rig-2mw", "lsp", "hsp", "psh"])
def test_mean_normal_forces_are_those_of_statics(scene):
    c = case(scene)
    for stage in STATICS if scene == "rig-2mw" else [scene]:
        for mesh in MESHES[stage]:
            assert stage_mean(c, mesh) == pytest.approx(STATICS[stage], rel=5e-3)


def test_nothing_accelerates_at_an_equilibrium():
    c = case("rig-2mw")
    rate = Kernel(c.library.functions["rhs"])(c.at.x, c.at.levels, c.p)[0]
    assert np.abs(rate[c.library.index("")]).max() == 0.0
    assert c.at.residual < 1e-7
    assert c.at.iterations < 20


def test_planets_of_a_fixed_carrier_share_alike_without_gravity():
    c = case("lsp")
    values = [value for item, value in forces(c).items() if "sun_planet" in item]
    assert np.ptp(values) < 1e-8 * np.mean(values)


def test_the_means_of_levels_are_the_shares_of_double_contact():
    c = case("rig-2mw")
    stages, double = c.scene.stages, dict(zip(c.library.manifest.levels, c.at.levels, strict=True))
    # In mm: (sqrt(192^2 - 165.39^2) + sqrt(400^2 - 360.85^2) - 560 sin 20) / (16 pi cos 20) = 1.664
    assert double["lsp.sun_planet.1"] == pytest.approx(0.664, abs=5e-4)
    psh, lsp, hsp = stages["psh"], stages["lsp"], stages["hsp"]
    wanted = {
        "lsp.sun_planet.2": contact_ratio(lsp, 1, lsp.sun, lsp.planet, 0.56),
        "lsp.ring_planet.3": contact_ratio(lsp, -1, lsp.ring, lsp.planet, 0.56),
        "hsp.sun_planet.1": contact_ratio(hsp, 1, hsp.sun, hsp.planet, 0.408),
        "psh.mesh": contact_ratio(psh, 1, psh.input, psh.output, 0.36 / np.cos(np.deg2rad(8))),
    }
    for name, ratio in wanted.items():
        assert double[name] == pytest.approx(ratio - 1, rel=1e-9)


def test_an_unloaded_stage_rests_where_it_stands():
    c = case("lsp", 'loads.sun.torque = "0 N*m"')
    assert np.abs(c.at.x[c.library.index("")]).max() < 1e-15
    assert max(map(abs, forces(c).values())) < 1e-6


def test_an_unloaded_turning_carrier_lets_its_planets_go_outwards():
    c = case("hsp", *[f'loads.{key}.torque = "0 N*m"' for key in torque_loads("hsp")])
    shown = {name: c.quantity(f"pin_force_{name}", c.at.x, c.at.levels) for name in "xy"}
    pulls = [np.hypot(shown["x"][item][0], shown["y"][item][0]) for item in shown["x"]]
    values = c.model.values()
    w = values["hsp.carrier.speed_ratio"] * values["reference.speed"]
    # Pin and meshes share the centrifugal force m w^2 d; the pin takes what its stiffness's part is.
    assert 0.3 < pulls[0] / (values["hsp.planet.mass"] * w**2 * 0.408) <= 1.001
    assert np.ptp(pulls) < 1e-6 * pulls[0]


def torque_loads(name):
    return [key for key, load in case(name).scene.loads.items() if load.torque is not None]


def test_bearings_carry_the_weight():
    c = case("lsp", 'effects.gravity = "on"')
    bare = case("lsp")
    values = c.model.values()
    weight = G * (values["lsp.ring.mass"] + values["lsp.sun.mass"] + 4 * values["lsp.planet.mass"])
    assert weight > 5e4
    for axis, wanted in (("x", 0.0), ("y", weight)):
        held = total(c, "bearing_force", axis) + total(c, "pin_force", axis)
        assert held == pytest.approx(wanted, abs=1e-6 * weight)
        assert total(bare, "bearing_force", axis) + total(bare, "pin_force", axis) == pytest.approx(0, abs=1e-2)


def test_gravity_may_point_anywhere():
    c = case("lsp", 'effects.gravity = "on"', 'gravity = ["3 m/s^2", "4 m/s^2"]')
    values = c.model.values()
    mass = values["lsp.ring.mass"] + values["lsp.sun.mass"] + 4 * values["lsp.planet.mass"]
    held = [total(c, "bearing_force", axis) + total(c, "pin_force", axis) for axis in "xy"]
    assert held == pytest.approx([-3 * mass, -4 * mass], rel=1e-6)


def test_a_driven_rotor_pair_twists_by_the_inertia_it_accelerates():
    raw = rotors(
        rotors={"a": {"inertia": "2 kg*m^2"}, "b": {"inertia": "6 kg*m^2"}},
        couplings={"shaft": {"between": ["a", "b"], "stiffness": "500 N*m/rad"}},
        loads={"motor": {"member": "a", "torque": "8 N*m", "initial_speed": "10 rad/s"}},
    )
    c = make_case(raw)
    rate = Kernel(c.library.functions["rhs"])(c.at.x, c.at.levels, c.p)[0]
    assert rate[c.state("reference.speed")] == pytest.approx(1.0, rel=1e-10)
    assert c.at.x[c.state("b.u")] == pytest.approx(-6.0 / 500.0, rel=1e-10)
    assert c.at.x[c.state("reference.speed")] == 10.0


def test_a_torque_driven_train_carries_what_accelerates_it():
    c = case("rig-2mw", *TORQUE_DRIVEN)
    values, x = c.model.values(), c.at.x
    rate = Kernel(c.library.functions["rhs"])(x, c.at.levels, c.p)[0][c.state("reference.speed")]
    # Lossless statics of the accelerated train by hand: the reduced inertia takes what the torques leave over.
    torque, ratio = 1.5e6, values["generator.speed_ratio"]
    bodies = [n.removesuffix(".speed_ratio") for n in values if n.endswith(".speed_ratio")]
    count = {"lsp.planet": 4, "hsp.planet": 3}
    reduced = sum(count.get(b, 1) * values[f"{b}.inertia"] * values[f"{b}.speed_ratio"] ** 2 for b in bodies)
    turning = values["hsp.carrier.speed_ratio"]
    reduced += 3 * values["hsp.planet.mass"] * 0.408**2 * turning**2
    assert rate == pytest.approx((torque + ratio * -1.06e4) / reduced, rel=2e-3)
    assert np.abs(c.at.x[c.library.index(".rate")]).max() == 0.0
    after = (values["shaft.inertia"] + values["generator.inertia"] + values["psh.output.inertia"]) * ratio * rate
    force = (1.06e4 + after) / values["psh.mesh.base_radius_2"]
    assert stage_mean(c, "psh.mesh") == pytest.approx(force, rel=5e-3)


@pytest.mark.parametrize("other", [3e5, 0.0])
def test_an_unrestrained_rotor_is_named(other):
    tables = {
        name: {"inertia": "2 kg*m^2", "torsional_support": {"stiffness": "3e5 N*m/rad"}} for name in ("wheel", "other")
    }
    c = make_case(rotors(rotors=tables, loads={"motor": {"member": "wheel", "torque": "8 N*m"}}))
    assert c.at.x[c.state("wheel.u")] == pytest.approx(8 / 3e5)
    # A scene without the supports is refused earlier; a library takes any number.
    values = c.model.values() | {"wheel.torsional_support.stiffness": 0.0, "other.torsional_support.stiffness": other}
    with pytest.raises(SolverError, match=r"nothing holds wheel \(u\).* against the loads"):
        find_equilibrium(c.library, c.library.parameters(values))


LOOSE = ('stages.lsp.ring.support = "floating"', "-stages.lsp.ring.bearing")


def test_floating_members_without_a_load_sideways_are_no_obstacle():
    c = case("lsp", *LOOSE)
    assert stage_mean(c, "lsp") == pytest.approx(STATICS["lsp"], rel=5e-3)


def test_floating_members_under_their_weight_are_named():
    c = case("lsp", *LOOSE, 'effects.gravity = "on"')
    with pytest.raises(SolverError, match=r"nothing holds .*lsp\.(ring|sun)"):
        find_equilibrium(c.library, c.p)


def test_base_circles_pulled_together_are_refused():
    # On the flank that is not loaded the mesh pulls: 118 kN on 1 kN/mm would close the 22 mm between base circles.
    soft = [f'stages.psh.{part}.bearing.stiffness = "1e6 N/m"' for part in ("input", "output")]
    c = case("psh", *soft, 'stages.psh.mesh.flank = "printed"')
    with pytest.raises(SolverError, match=r"no equilibrium: .*(center_distance|centre distance)"):
        find_equilibrium(c.library, c.p)


def test_soft_bearings_on_the_right_flank_do_find_theirs():
    soft = [f'stages.psh.{part}.bearing.stiffness = "1e8 N/m"' for part in ("input", "output")]
    c = case("psh", *soft)
    assert stage_mean(c, "psh.mesh") == pytest.approx(STATICS["psh"], rel=5e-3)


def test_chosen_levels_are_kept():
    c = case("lsp")
    levels = np.zeros(len(c.library.manifest.levels))
    at = find_equilibrium(c.library, c.p, levels)
    stiffer = find_equilibrium(c.library, c.p, levels + 1)
    sun = c.state("lsp.sun.u")
    assert (at.levels == 0).all()
    assert abs(at.x[sun]) > abs(stiffer.x[sun])


# --- stiff beside soft, light beside heavy


def statics_error(c):
    """The largest error of the rig's mean mesh forces against statics."""
    found = [(stage_mean(c, mesh), STATICS[stage]) for stage in STATICS for mesh in MESHES[stage]]
    return max(abs(force / wanted - 1) for force, wanted in found)


def scaled(c, factor, *endings):
    """The case with some numbers times a factor."""
    values = c.model.values()
    values |= {name: value * factor for name, value in values.items() if name.endswith(endings)}
    other = Case(c.scene, c.model, c.library)
    other.__dict__["p"] = c.library.parameters(values)
    return other


COUPLINGS = ("shaft.stiffness", "lsp_hsp.stiffness", "hsp_psh.stiffness", "flange.stiffness")


@pytest.mark.parametrize("factor", [1e4, 1e7, 1e8])
@pytest.mark.parametrize("names", [("bearing.stiffness", "pin.stiffness"), COUPLINGS])
def test_stiff_parts_are_in_equilibrium_too(names, factor):
    found = scaled(case("rig-2mw"), factor, *names)
    assert statics_error(found) < 5e-3
    assert found.at.residual < 1e-8


def test_light_planets_are_no_obstacle():
    light = scaled(case("rig-2mw"), 1e-9, "hsp.planet.mass", "hsp.planet.inertia")
    assert statics_error(light) < 5e-3


# --- torques that balance at rest


def gear_pair(one, two, contact="bilateral"):
    """A pair at rest under two torques [N m], 19 against 71 teeth."""
    gear = {"support": "rigid", "inertia": "1e-3 kg*m^2"}
    stage = {
        "kind": "pair", "module": "4 mm", "pressure_angle": "20 deg", "input": {"teeth": 19, **gear},
        "output": {"teeth": 71, **gear}, "mesh": {"stiffness": "7e8 N/m", "backlash": "0.1 mm"},
    }  # fmt: skip
    loads = {
        "one": {"member": "pair.input", "torque": f"{one} N*m"},
        "two": {"member": "pair.output", "torque": f"{two} N*m"},
    }
    effects = {"mesh_stiffness": "mean", "contact": contact}
    return make_case({"title": "pair at rest", "effects": effects, "stages": {"pair": stage}, "loads": loads})


@pytest.mark.parametrize("contact", ["bilateral", "one-flank", "backlash"])
@pytest.mark.parametrize("sign", [1, -1])
def test_torques_that_balance_need_no_support(contact, sign):
    c = gear_pair(sign * 19, sign * 71, contact)
    radius = 19 * 4e-3 / 2 * np.cos(np.radians(20))
    assert max(forces(c).values()) == pytest.approx(19 / radius, rel=1e-9)


def test_torques_that_nearly_balance_are_refused_with_what_is_missing():
    with pytest.raises(SolverError, match=r"nothing holds pair\..* out of balance there by .*e-0[45] of their size"):
        _ = gear_pair(19, 71.01).at


# --- members within their gaps

GAPS = ('effects.contact = "backlash"', *(f'stages.{mesh}.backlash = "0.2 mm"' for mesh in MESHES["lsp"]))
IDLE = 'loads.sun.torque = "0 N*m"'


@pytest.mark.parametrize("settings", [(), LOOSE])
def test_an_idle_stage_with_gaps_rests(settings):
    c = case("lsp", *GAPS, IDLE, *settings)
    assert np.abs(c.at.x[c.library.index("")]).max() < 1e-15
    assert max(forces(c).values()) < 1e-6


@pytest.mark.parametrize("settings", [(IDLE,), (IDLE, *LOOSE), LOOSE, ('loads.sun.torque = "1 N*m"',)])
def test_members_fall_through_their_gaps_until_teeth_hold_them(settings):
    """Sun and ring float: what pins and bearings carry is the weight of all, and no tooth pulls."""
    c = case("lsp", *GAPS, 'effects.gravity = "on"', *settings)
    values = c.model.values()
    weight = G * (values["lsp.ring.mass"] + values["lsp.sun.mass"] + 4 * values["lsp.planet.mass"])
    assert total(c, "bearing_force", "y") + total(c, "pin_force", "y") == pytest.approx(weight, rel=1e-6)
    assert min(forces(c).values()) >= 0.0
    assert 1e-4 < abs(c.at.x[c.state("lsp.sun.y")]) + abs(c.at.x[c.state("lsp.sun.x")]) < 1e-3
