"""Speeds and static loads of trains against closed forms and the paper's tables."""

from math import cos, pi, radians, tau

import pytest
from ltcgear.generated.errors import SceneError
from ltcgear.symbolic.assembly import build_model
from ltcgear.symbolic.gears import train
from ltcgear.symbolic.gears.train_members import inertia_of
from ltcgear.symbolic.scene.load import load_scene, make_scene

LSP, HSP, PSH = -118 / 22, 1 + 118 / 17, -59 / 21
RPM = tau / 60


def rotor(inertia="1 kg*m^2", **more):
    return {"inertia": inertia, **more}


def planetary(z_sun, z_planet, z_ring, planets=4, **support):
    """Return a planetary stage whose central members turn freely, unless ``support`` says otherwise."""
    body = {"support": "rigid", "inertia": "1 kg*m^2"}
    stage = {
        "kind": "planetary",
        "planets": planets,
        "module": "4 mm",
        "pressure_angle": "20 deg",
        "sun": body | {"teeth": z_sun},
        "ring": body | {"teeth": z_ring},
        "carrier": dict(body),
        "planet": {"teeth": z_planet, "mass": "1 kg", "inertia": "1 kg*m^2"},
        "sun_planet": {"stiffness": "1e9 N/m"},
        "ring_planet": {"stiffness": "1e9 N/m"},
        "pin": {"stiffness": "1e9 N/m"},
    }
    for part, kind in support.items():
        stage[part] = {key: value for key, value in stage[part].items() if key == "teeth"} | {"support": kind}
    return stage


def differential(loads, **support):
    return make_scene({"title": "d", "stages": {"d": planetary(20, 30, 80, **support)}, "loads": loads})


def ratios(scene):
    motion, faults = train.motion(scene)
    assert not faults
    return motion


# --- speeds


def test_the_rig_s_speed_ratios():
    found = ratios(load_scene("rig-2mw")).ratios
    assert found["lsp.ring"] == found["motor"] == 1.0
    assert found["lsp.sun"] == pytest.approx(LSP, rel=1e-12)
    assert found["hsp.sun"] / found["hsp.carrier"] == pytest.approx(HSP, rel=1e-12)
    assert found["psh.output"] / found["psh.input"] == pytest.approx(PSH, rel=1e-12)
    assert found["generator"] == pytest.approx(118 / 22 * (1 + 118 / 17) * 59 / 21, rel=1e-12)
    assert found["generator"] == pytest.approx(119.668, abs=5e-4)
    assert found["lsp.carrier"] == found["hsp.ring"] == 0.0


# Wu et al. 2021, Table 7: position -> r/min, teeth, meshing frequency [Hz]. The HSP planet's speed is
# relative to its carrier (READING.md); the paper rounds on the way, hence 638.82 for 638.90.
TABLE_7 = {
    "lsp.ring": (15, 118, 29.5),
    "lsp.planet": (36.87, 48, 29.5),
    "lsp.sun": (80.45, 22, 29.5),
    "hsp.planet": (189.84, 50, 158.2),
    "hsp.sun": (638.82, 17, 158.2),
    "psh.input": (638.82, 59, 628.3),
    "psh.output": (1794.75, 21, 628.3),
}


@pytest.mark.parametrize("member", TABLE_7)
def test_table_7(member):
    speed, teeth, frequency = TABLE_7[member]
    motion = ratios(load_scene("rig-2mw"))
    found = motion.speed / RPM * motion.ratios[member]
    carrier = motion.speed / RPM * motion.ratios.get(f"{member.split('.')[0]}.carrier", 0.0)
    shown = found - carrier if member == "hsp.planet" else found
    assert abs(shown) == pytest.approx(speed, rel=2e-4)
    assert abs(found - carrier) * teeth / 60 == pytest.approx(frequency, rel=2e-3)


def test_directions_of_the_rig():
    """READING.md: ring counter-clockwise, then LSP sun and HSP carrier clockwise."""
    found = ratios(load_scene("rig-2mw")).ratios
    assert found["lsp.planet"] > 0
    assert found["lsp.sun"] < 0
    assert found["hsp.carrier"] < 0
    assert found["psh.output"] > 0


def test_stages_alone_run_as_in_the_rig():
    rig = ratios(load_scene("rig-2mw"))
    for name in ("lsp", "hsp", "psh"):
        alone = ratios(load_scene(name))
        for member, ratio in alone.ratios.items():
            assert alone.speed * ratio == pytest.approx(rig.speed * rig.ratios[member], rel=1e-5), member


def test_a_differential_with_two_speeds():
    """Willis: z_s w_s + z_r w_r = (z_s + z_r) w_c."""
    loads = {"s": {"member": "d.sun", "speed": "100 rad/s"}, "r": {"member": "d.ring", "speed": "-10 rad/s"}}
    motion = ratios(differential(loads))
    speeds = {name: motion.speed * ratio for name, ratio in motion.ratios.items()}
    assert motion.mode == "speed"
    assert speeds["d.carrier"] == pytest.approx((20 * 100 - 80 * 10) / 100, rel=1e-12)
    carrier = speeds["d.carrier"]
    assert (speeds["d.planet"] - carrier) * 30 == pytest.approx(-(100 - carrier) * 20, rel=1e-12)
    assert (speeds["d.planet"] - carrier) * 30 == pytest.approx((-10 - carrier) * 80, rel=1e-12)


@pytest.mark.parametrize("brake_first", [True, False])
def test_a_member_braked_to_zero_does_not_stop_the_others(brake_first):
    brake = {"r": {"member": "d.ring", "speed": "0 rpm"}}
    drive = {"s": {"member": "d.sun", "speed": "100 rad/s"}}
    motion = ratios(differential(brake | drive if brake_first else drive | brake))
    assert (motion.mode, motion.member, motion.speed) == ("speed", "d.sun", 100.0)
    assert motion.ratios["d.carrier"] == pytest.approx(20 / 100, rel=1e-12)
    assert motion.ratios["d.ring"] == 0.0


def test_a_braked_member_leaves_a_torque_driven_train_its_reference():
    loads = {
        "r": {"member": "d.ring", "speed": "0 rpm"},
        "s": {"member": "d.sun", "torque": "10 N*m", "initial_speed": "100 rad/s"},
    }
    scene = differential(loads)
    motion = ratios(scene)
    assert (motion.mode, motion.member, motion.speed) == ("torque", "d.sun", 100.0)
    turning = {body.name: body.turning for body in build_model(scene).bodies}
    assert turning["d.sun"] == "reference"
    assert turning["d.ring"] == "driven"


def test_a_speed_of_zero_keeps_the_ratios():
    loads = {"s": {"member": "d.sun", "speed": "0 rpm"}}
    motion = ratios(differential(loads, ring="fixed"))
    assert motion.speed == 0.0
    assert motion.ratios["d.carrier"] == pytest.approx(0.2, rel=1e-12)


def test_without_loads_all_rest():
    motion = ratios(load_scene("lin-parker-3"))
    assert motion.mode == "rest"
    assert set(motion.ratios.values()) == {0.0}


def test_base_radii_set_the_ratio_where_they_are_given():
    raw = {
        "title": "p",
        "stages": {
            "p": {
                "kind": "pair",
                "center_distance": "0.33 m",
                "input": {"base_radius": "100.02 mm", "teeth": 40, "support": "rigid", "inertia": "1 kg*m^2"},
                "output": {"base_radius": "200 mm", "teeth": 80, "support": "rigid", "inertia": "1 kg*m^2"},
                "mesh": {"stiffness": "1e8 N/m"},
            }
        },
        "loads": {"i": {"member": "p.input", "speed": "1 rad/s"}},
    }
    assert ratios(make_scene(raw)).ratios["p.output"] == pytest.approx(-100.02 / 200, rel=1e-12)


OPEN = [
    ({"s": {"member": "d.sun", "speed": "1 rad/s"}}, "loads: the speed of .*d.ring.* is open"),
    ({"s": {"member": "d.sun", "torque": "1 N*m", "initial_speed": "1 rad/s"}}, "loads: the speed of .* is open"),
]


@pytest.mark.parametrize(("loads", "message"), OPEN)
def test_an_open_speed_is_refused(loads, message):
    with pytest.raises(SceneError, match=message):
        differential(loads)


def test_a_train_apart_is_named():
    with pytest.raises(SceneError, match="the speed of apart is open"):
        make_scene(
            {
                "title": "x",
                "rotors": {"a": rotor(), "b": rotor(), "apart": rotor()},
                "couplings": {"c": {"between": ["a", "b"], "stiffness": "1 N*m/rad"}},
                "loads": {"a": {"member": "a", "speed": "1 rpm"}},
            }
        )


CONTRADICTIONS = [
    {"s": "1 rad/s", "r": "1 rad/s", "c": "2 rad/s"},
    {"s": "1 rad/s", "r": "1 rad/s", "c": "1.00001 rad/s"},
]


@pytest.mark.parametrize("speeds", CONTRADICTIONS)
def test_contradictory_speeds_are_refused(speeds):
    names = {"s": "d.sun", "r": "d.ring", "c": "d.carrier"}
    loads = {key: {"member": names[key], "speed": speed} for key, speed in speeds.items()}
    with pytest.raises(SceneError, match="loads: the speeds contradict"):
        differential(loads)


def test_consistent_surplus_speeds_are_taken():
    names = {"s": "d.sun", "r": "d.ring", "c": "d.carrier"}
    loads = {key: {"member": name, "speed": "3 rad/s"} for key, name in names.items()}
    assert ratios(differential(loads)).ratios["d.planet"] == pytest.approx(1.0, rel=1e-12)


def test_a_shaft_that_bridges_sun_and_ring_contradicts_the_teeth():
    with pytest.raises(SceneError, match="the speeds contradict"):
        load_scene("lsp", {"couplings.c.between": '["lsp.ring", "lsp.sun"]', "couplings.c.stiffness": "1e8 N*m/rad"})


# --- static loads

T_OUT = 1.06e4  # N m at the PSH output, Wu et al. 2021, section 4.1


def test_static_mesh_forces_of_the_rig():
    """READING.md: LSP 3.575e5, HSP 1.0357e5, PSH 1.1834e5 N, lossless."""
    scene = load_scene("rig-2mw")
    forces = train.static_forces(scene, ratios(scene))
    for name, expected in {"lsp.sun_planet": 3.575e5, "hsp.ring_planet": 1.0357e5, "psh.mesh": 1.1834e5}.items():
        assert abs(forces[name]) == pytest.approx(expected, rel=5e-3)


def test_static_mesh_forces_by_hand():
    scene = load_scene("rig-2mw")
    forces = train.static_forces(scene, ratios(scene))
    psh = scene.stages["psh"]
    radius = 21 * 0.009 / cos(psh.helix_angle) / 2 * cos(radians(20.18110))
    hsp_torque = T_OUT * 59 / 21
    lsp_torque = hsp_torque * HSP
    assert abs(forces["psh.mesh"]) == pytest.approx(T_OUT / radius, rel=1e-5)
    assert abs(forces["hsp.sun_planet"]) == pytest.approx(hsp_torque / (3 * 17 * 0.006 * cos(pi / 9)), rel=1e-9)
    assert abs(forces["lsp.sun_planet"]) == pytest.approx(lsp_torque / (4 * 22 * 0.008 * cos(pi / 9)), rel=1e-9)


def test_table_4_service_loads():
    """Wu et al. 2021, Table 4: 3.55e5, 1.04e5, 1.17e5 N; means of normal and tangential forces mixed, so 1.5 %."""
    scene = load_scene("rig-2mw")
    forces = train.static_forces(scene, ratios(scene))
    for name, printed in {"lsp.ring_planet": 3.55e5, "hsp.sun_planet": 1.04e5, "psh.mesh": 1.17e5}.items():
        assert abs(forces[name]) == pytest.approx(printed, rel=1.5e-2)


def test_table_5_service_torques():
    """Wu et al. 2021, Table 5: 127e4, 23.9e4, 2.99e4, 1.06e4 N m, from the output torque and the ratios."""
    printed = {"input_shaft": 127e4, "lsp_hsp": 23.9e4, "hsp_psh": 2.99e4, "output_shaft": 1.06e4}
    lossless = {"output_shaft": T_OUT, "hsp_psh": T_OUT * 59 / 21}
    lossless["lsp_hsp"] = lossless["hsp_psh"] * HSP
    lossless["input_shaft"] = lossless["lsp_hsp"] * 118 / 22
    for name, torque in printed.items():
        assert lossless[name] == pytest.approx(torque, rel=1.5e-2)


def flanks(scene):
    return {name: value for name, value in build_model(scene).values().items() if name.endswith(".flank")}


@pytest.mark.parametrize("scene", ["rig-2mw", "lsp", "hsp", "psh"])
def test_loads_reversed_load_the_opposite_flanks(scene):
    scene_as_shipped = load_scene(scene)
    (key, load), *_ = [item for item in scene_as_shipped.loads.items() if item[1].torque is not None]
    forward, backward = (
        flanks(scene_as_shipped),
        flanks(load_scene(scene, {f"loads.{key}.torque": f"{-load.torque} N*m"})),
    )
    assert set(forward.values()) <= {1.0, -1.0}
    assert backward == {name: -sign for name, sign in forward.items()}


def test_flanks_of_the_rig_are_as_the_notes_say():
    """READING.md: LSP and HSP on the printed flank, the PSH on the opposite one."""
    found = flanks(load_scene("rig-2mw"))
    assert {sign for name, sign in found.items() if not name.startswith("psh")} == {1.0}
    assert found["psh.mesh.flank"] == -1.0


def test_a_flank_can_be_chosen():
    keys = {"stages.psh.mesh.flank": "printed"}
    assert flanks(load_scene("psh", keys))["psh.mesh.flank"] == 1.0
    assert flanks(load_scene("psh", {"stages.psh.mesh.flank": "opposite"}))["psh.mesh.flank"] == -1.0


def test_a_turned_direction_of_running_alone_leaves_the_flanks():
    assert flanks(load_scene("lsp", {"loads.ring.speed": "-15 rpm"})) == flanks(load_scene("lsp"))


def test_a_torque_driven_train():
    """Motor and generator both by torque: the train starts at 15 rpm and its meshes carry what the torques leave."""
    balance = T_OUT * 119.66768525592053
    scene = load_scene(
        "rig-2mw",
        {"loads.motor": f'{{member = "motor", torque = "{balance!r} N*m", initial_speed = "15 rpm"}}'},
    )
    motion = ratios(scene)
    assert (motion.mode, motion.member) == ("torque", "motor")
    assert motion.speed == pytest.approx(15 * RPM, rel=1e-12)
    held = load_scene("rig-2mw")
    assert motion.ratios == pytest.approx(ratios(held).ratios, rel=1e-12)
    forces, expected = train.static_forces(scene, motion), train.static_forces(held, ratios(held))
    assert forces == pytest.approx(expected, rel=1e-9)


def test_two_rotors_share_a_torque_by_inertia():
    """A free pair of rotors, 2 and 6 kg m^2: the coupling passes 6/8 of the torque; no mesh, so ratios only."""
    raw = {
        "title": "x",
        "rotors": {"a": rotor("2 kg*m^2"), "b": rotor("6 kg*m^2")},
        "couplings": {"c": {"between": ["a", "b"], "stiffness": "1e4 N*m/rad"}},
        "loads": {"a": {"member": "a", "torque": "8 N*m", "initial_speed": "0 rad/s"}},
    }
    motion = ratios(make_scene(raw))
    assert (motion.mode, motion.speed, motion.ratios) == ("torque", 0.0, {"a": 1.0, "b": 1.0})


def test_a_loaded_pair_accelerates_and_its_mesh_carries_the_share():
    """Torque T on the input of a free pair, ratio -1/2: N r = T J_2 i^2 / (J_1 + J_2 i^2)."""
    gear = {"support": "rigid"}
    raw = {
        "title": "p",
        "stages": {
            "p": {
                "kind": "pair",
                "module": "4 mm",
                "pressure_angle": "20 deg",
                "input": gear | {"teeth": 20, "inertia": "1 kg*m^2"},
                "output": gear | {"teeth": 40, "inertia": "8 kg*m^2"},
                "mesh": {"stiffness": "1e8 N/m"},
            }
        },
        "loads": {"i": {"member": "p.input", "torque": "9 N*m", "initial_speed": "1 rad/s"}},
    }
    scene = make_scene(raw)
    share = 9.0 * 8.0 / 4 / (1.0 + 8.0 / 4)
    assert train.static_forces(scene, ratios(scene))["p.mesh"] == pytest.approx(share / (0.04 * cos(pi / 9)), rel=1e-9)


# --- inertia


def test_a_disc_gives_mass_and_inertia():
    disc = {"outer_diameter": "2 m", "inner_diameter": "1 m", "width": "100 mm", "density": "1000 kg/m^3"}
    scene = make_scene({"title": "x", "rotors": {"a": {"disc": disc}}})
    mass = 1000 * pi * (1 - 0.25) * 0.1
    assert inertia_of(scene.rotors["a"]) == pytest.approx((mass, mass * (1 + 0.25) / 2), rel=1e-14)


def test_heavy_planets_load_opposite_flanks_while_they_are_accelerated():
    """A light sun drives heavy planets inside a light ring: N_rp = N_sp - I_P theta_P'' / r_P, so signs differ."""
    raw = {
        "title": "p",
        "stages": {
            "p": {
                "kind": "planetary",
                "module": "4 mm",
                "pressure_angle": "20 deg",
                "planets": 3,
                "sun": {"teeth": 20, "support": "rigid", "inertia": "1e-4 kg*m^2"},
                "ring": {"teeth": 70, "support": "rigid", "inertia": "1e-3 kg*m^2"},
                "planet": {"teeth": 25, "mass": "5 kg", "inertia": "1 kg*m^2"},
                "carrier": {"support": "fixed"},
                "sun_planet": {"stiffness": "1e8 N/m"},
                "ring_planet": {"stiffness": "1e8 N/m"},
                "pin": {"stiffness": "1e9 N/m"},
            }
        },
        "loads": {"s": {"member": "p.sun", "torque": "9 N*m", "initial_speed": "1 rad/s"}},
    }
    scene = make_scene(raw)
    forces = train.static_forces(scene, ratios(scene))
    r_sun, r_planet, r_ring = (z * 0.002 * cos(pi / 9) for z in (20, 25, 70))
    reduced = 1e-4 + 3 * (20 / 25) ** 2 + 1e-3 * (20 / 70) ** 2
    sun_acceleration = 9.0 / reduced
    assert forces["p.sun_planet"] == pytest.approx((9.0 - 1e-4 * sun_acceleration) / (3 * r_sun), rel=1e-9)
    ring_acceleration = -sun_acceleration * 20 / 70
    assert forces["p.ring_planet"] == pytest.approx(-1e-3 * ring_acceleration / (3 * r_ring), rel=1e-9)
    planet = -r_planet * forces["p.sun_planet"] + r_planet * forces["p.ring_planet"]
    assert planet == pytest.approx(-sun_acceleration * 20 / 25, rel=1e-9)
