"""Errors and gaps beyond what a tooth can have, trains beyond all size, and machines that cannot hold their loads."""

import pytest
from ltcgear.generated.errors import SceneError
from ltcgear.symbolic.describe.advice import warnings
from ltcgear.symbolic.scene.load import load_scene, make_scene
from ltcgear.symbolic.schema.scene_schema import MOST_MEMBERS

PSH, LSP = "stages.psh.", "stages.lsp."
ERRORS = {  # key, what is written around the length; psh has a module of 9 mm, lsp one of 16 mm
    PSH + "mesh.tooth_errors": ("[{{gear='input', tooth=0, error='{}'}}]", ".0.error", 4.5),
    PSH + "mesh.transmission_error.amplitudes": ("['1 um', '-{}']", ".1", 4.5),
    PSH + "mesh.transmission_error.table": ("[[0, '0 mm'], [0.5, '-{}'], [1, '0 mm']]", "", 4.5),
    PSH + "mesh.backlash": ("'{}'", "", 9.0),
    PSH + "input.tooth_thinning": ("'{}'", "", 9.0),
    PSH + "input.eccentricity.radius": ("'{}'", "", 9.0),
    PSH + "output.bearing.clearance": ("'{}'", "", 9.0),
    LSP + "planet.tooth_thinning": ("'{}'", "", 16.0),
    LSP + "pin.clearance": ("'{}'", "", 16.0),
    LSP + "position_errors": ("[{{planet=2, tangential='-{}'}}]", ".0.tangential", 16.0),
    LSP + "eccentricities": ("[{{planet=2, radius='{}'}}]", ".0.radius", 16.0),
}


def refused(name, changes):
    with pytest.raises(SceneError) as caught:
        load_scene(name, changes)
    return str(caught.value)


@pytest.mark.parametrize("key", ERRORS)
def test_no_error_is_larger_than_half_a_module_and_no_gap_than_one(key):
    text, place, most = ERRORS[key]
    name = key.split(".")[1]
    told = refused(name, {key: text.format(f"{1.01 * most} mm")})
    assert f"{key}{place}: " in told
    assert f"{most:.4g} mm at most, {0.5 if most == 4.5 else 1:g} of the module" in told
    load_scene(name, {key: text.format(f"{0.99 * most} mm")})


def test_without_a_module_the_pitch_of_the_teeth_or_the_base_radius_bounds_errors():
    tree = {
        "title": "x",
        "stages": {
            "a": {
                "kind": "pair", "center_distance": "300 mm",
                "input": {"base_radius": "30 mm", "teeth": 30, "support": "rigid", "inertia": "1 kg*m^2"},
                "output": {"base_radius": "240 mm", "teeth": 240, "support": "rigid", "inertia": "1 kg*m^2"},
                "mesh": {"stiffness": "1e8 N/m", "transmission_error": {"amplitudes": ["0.99 mm"]}},
            }
        },
    }  # fmt: skip
    mesh = tree["stages"]["a"]["mesh"]
    make_scene(tree)
    mesh["transmission_error"] = {"amplitudes": ["1.01 mm"]}
    with pytest.raises(
        SceneError, match=r"amplitudes\.0: 1\.01 mm is no small error; 1 mm at most, 0\.5 of 2 base_radius"
    ):
        make_scene(tree)
    for gear in ("input", "output"):
        del tree["stages"]["a"][gear]["teeth"]
    make_scene(tree)
    mesh["transmission_error"] = {"amplitudes": ["5.01 mm"]}
    with pytest.raises(SceneError, match=r"5 mm at most, 0\.5 of the module of 6 teeth on the least base_radius"):
        make_scene(tree)


# --- members


def rotors(count):
    return {"title": "x", "rotors": {f"r{i}": {"inertia": "1 kg*m^2"} for i in range(count)}}


def test_trains_beyond_all_size_are_refused_before_anything_is_computed():
    assert len(make_scene(rotors(MOST_MEMBERS)).rotors) == MOST_MEMBERS
    with pytest.raises(SceneError, match=f"4000 members, planets included; join some, {MOST_MEMBERS} at most"):
        make_scene(rotors(4000))
    stages = {f"s{i}": {"kind": "planetary", "planets": 12} for i in range(21)}
    with pytest.raises(SceneError, match="315 members, planets included"):
        make_scene({"title": "x", "stages": stages})
    tree = rotors(2)
    tree["couplings"] = {f"c{i}": {"between": ["r0", "r1"], "stiffness": "1 N*m/rad"} for i in range(4000)}
    with pytest.raises(SceneError, match="couplings: has 4000 entries; leave out some"):
        make_scene(tree)
    tree = rotors(2) | {"loads": {f"l{i}": {"member": "rr", "torque": "1 N*m"} for i in range(4000)}}
    with pytest.raises(SceneError, match="loads: has 4000 entries; leave out some"):
        make_scene(tree)


def test_lists_of_planets_are_bounded():
    told = refused("lsp", {LSP + "position_errors": f"[{', '.join(['{planet = 1}'] * 20_000)}]"})
    assert "position_errors: must have 24 items at most" in told


# --- asynchronous machines

MACHINE = {
    "title": "machine", "rotors": {"motor": {"inertia": "1 kg*m^2"}},
    "loads": {
        "mains": {"member": "motor", "initial_speed": "1500 rpm",
                  "slip": {"synchronous_speed": "1500 rpm", "breakdown_torque": "290 N*m", "breakdown_slip": 0.18}},
        "brake": {"member": "motor", "torque": "-280 N*m"},
    },
}  # fmt: skip


def machine(**loads):
    return warnings(make_scene(MACHINE | {"loads": {k: MACHINE["loads"].get(k, {}) | v for k, v in loads.items()}}))


def test_a_machine_that_can_hold_its_loads_is_not_warned_about():
    assert machine(mains={}, brake={}) == []
    assert machine(mains={"initial_speed": "0 rpm"}, brake={}) == []
    assert warnings(load_scene("start-up")) == []


@pytest.mark.parametrize("torque", ["-300 N*m", "300 N*m"])
def test_loads_above_the_breakdown_torque_are_warned_about_with_their_numbers(torque):
    (line,) = machine(mains={}, brake={"torque": torque})
    assert line.startswith("loads.mains.slip: ")
    assert "300 N m" in line
    assert "breakdown_torque 290 N m" in line


def test_a_load_over_time_counts_with_what_it_ends_with():
    ends = {"torque_over_time": [["0 s", "0 N*m"], ["1 s", "-300 N*m"]]}
    passes = {"torque_over_time": [["0 s", "0 N*m"], ["1 s", "-300 N*m"], ["1.1 s", "-100 N*m"]]}
    brake = {"member": "motor"}
    tree = MACHINE | {"loads": {"mains": MACHINE["loads"]["mains"], "brake": brake | ends}}
    assert "300 N m" in warnings(make_scene(tree))[0]
    tree["loads"]["brake"] = brake | passes
    assert warnings(make_scene(tree)) == []


def test_a_machine_far_from_its_synchronous_speed_is_warned_about():
    """A speed that is held 16 times above the synchronous one: it brakes with a hundredth of its torque."""
    changes = {"loads.generator.slip.synchronous_speed": "-90 rpm"}
    (line,) = warnings(load_scene("start-up", changes))
    assert line.startswith("loads.generator.slip: at -1514.29 r/min")
    assert "beyond its breakdown_slip 0.18" in line
    assert "synchronous_speed" in line


# --- what holds a train


def test_a_torsional_support_on_a_member_that_should_turn_is_named():
    told = refused("lsp", {LSP + "sun.torsional_support.stiffness": "1e5 N*m/rad"})
    assert "stages.lsp.sun.torsional_support: holds a member that the loads turn; drop it" in told


def test_a_torsional_support_of_a_rotor_is_named():
    told = refused("rig-2mw", {"rotors.shaft.torsional_support.stiffness": "1e5 N*m/rad"})
    assert "rotors.shaft.torsional_support: holds a member that the loads turn; drop it" in told


def test_only_who_has_teeth_is_warned_about_a_default_of_theirs():
    tree = {"title": "x", "rotors": {name: {"inertia": "1 kg*m^2"} for name in "ab"},
            "couplings": {"c": {"between": ["a", "b"], "stiffness": "1e5 N*m/rad"}}}  # fmt: skip
    assert warnings(make_scene(tree)) == []
    assert warnings(make_scene(tree | {"effects": {"mesh_stiffness": "smooth"}}))
