"""The manifest tells the train: members, connections and roles are those of the scene, and survive their text."""

from pathlib import Path

import pytest
from ltcgear.generated.contract import (
    ANY,
    BOUNDS,
    DAMPER,
    GEOMETRY,
    NOT_NEGATIVE,
    PHYSICAL,
    POSITIVE,
    ROLES,
    SHARE,
    Connection,
    Manifest,
    RigidBody,
)
from ltcgear.symbolic.assembly import build_model
from ltcgear.symbolic.emit.mechanism import list_bodies, list_connections
from ltcgear.symbolic.scene.load import load_scene

ENDS = ("synchronous_speed", "breakdown_slip_speed", "breakdown_torque")
HOME = Path(__file__).parents[3] / "generated"


@pytest.fixture(scope="module")
def rig():
    """The committed manifest of the rig, and its scene."""
    return Manifest.from_json((HOME / "rig_2mw" / "manifest.json").read_text("utf-8")), load_scene("rig-2mw")


def connection(manifest: Manifest, name: str) -> Connection:
    return next(item for item in manifest.connections if item.name == name)


def body(manifest: Manifest, name: str) -> RigidBody:
    return next(item for item in manifest.bodies if item.name == name)


def test_the_committed_manifests_survive_their_text(rig):
    manifest, _ = rig
    assert Manifest.from_json(manifest.to_json()) == manifest
    assert all(isinstance(item.place, tuple) for item in manifest.bodies)
    assert all(isinstance(part, tuple) for item in manifest.connections for part in (item.bodies, item.radii))


def test_members_are_those_of_the_scene(rig):
    manifest, scene = rig
    planets = {name: stage.planets for name, stage in scene.stages.items() if hasattr(stage, "planets")}
    wanted = {*scene.rotors, "psh.input", "psh.output"}
    wanted |= {f"{name}.{part}" for name in planets for part in ("carrier", "ring", "sun")}
    wanted |= {f"{name}.planet.{k}" for name, count in planets.items() for k in range(1, count + 1)}
    assert {item.name for item in manifest.bodies} == wanted
    assert body(manifest, "hsp.planet.2").frame == "hsp.carrier"  # it goes round with its carrier
    assert body(manifest, "lsp.planet.2").frame == ""  # the carrier of the LSP is fixed to the housing
    assert {item.part for item in manifest.bodies if not item.stage} == {"rotor"}
    assert body(manifest, "lsp.sun").teeth == "lsp.sun_planet.teeth_1"
    assert body(manifest, "lsp.planet.3").place == ("lsp.planet.3.x_0", "lsp.planet.3.y_0")


def test_connections_are_those_of_the_scene(rig):
    manifest, scene = rig
    joined = {item.item: item.bodies for item in manifest.connections if item.kind == "coupling"}
    assert joined == {name: tuple(coupling.between) for name, coupling in scene.couplings.items()}
    loads = {item.item: item.bodies for item in manifest.connections if item.kind == "load"}
    assert loads == {name: (load.member,) for name, load in scene.loads.items() if not load.holds}
    mesh = connection(manifest, "hsp.ring_planet.2")
    assert (mesh.bodies, mesh.sense, mesh.group) == (("hsp.ring", "hsp.planet.2"), -1, "hsp.ring_planet")
    assert len(connection(manifest, "lsp.sun_planet.1").stiffness) == 2  # between which the level chooses
    assert connection(manifest, "lsp.pin.2").bodies == ("lsp.carrier", "lsp.planet.2")
    assert connection(manifest, "psh.output.bearing").bodies == ("psh.output",)


@pytest.mark.parametrize("folder", ["rig_2mw", "lin_parker_3"])
def test_all_that_is_named_is_a_parameter(folder):
    manifest = Manifest.from_json((HOME / folder / "manifest.json").read_text("utf-8"))
    known = {"", *(name for name, _ in manifest.parameters)}
    for item in manifest.bodies:
        assert {*item.place, item.ratio, item.mass, item.inertia, item.base_radius, item.teeth} <= known
    for joint in manifest.connections:
        assert {*joint.stiffness, joint.damping, joint.hold, joint.flank, *joint.radii, joint.teeth} <= known
    assert set(manifest.roles) == known - {""}
    assert set(manifest.roles.values()) <= set(ROLES)
    assert set(manifest.bounds) == known - {""}
    assert set(manifest.bounds.values()) <= set(BOUNDS)


def test_roles_tell_sizes_from_places(rig):
    roles = rig[0].roles
    assert roles["lsp.pin.stiffness"] == PHYSICAL
    assert roles["lsp.planet.1.x_0"] == roles["psh.mesh.base_radius_1"] == GEOMETRY


def test_bounds_are_told_by_who_declares_a_parameter(rig):
    told = rig[0].bounds
    wanted = {
        "motor.inertia": POSITIVE, "lsp.ring.mass": POSITIVE, "psh.mesh.base_radius_2": POSITIVE,
        "lsp.pin.stiffness": NOT_NEGATIVE, "lsp.sun_planet.stiffness_double": NOT_NEGATIVE, "lsp.pin.damping": DAMPER,
        "couplings.input_shaft.damping": DAMPER, "lsp.sun_planet.single_share": SHARE, "lsp.planet.1.x_0": ANY,
        "loads.generator.torque": ANY,
    }  # fmt: skip
    assert {name: told[name] for name in wanted} == wanted


def test_bounds_of_what_laws_divide_by():
    rubbing = {
        "effects.mesh_friction": "pitch-point",
        "stages.psh.mesh.friction": '{ coefficient = 0.05, damping = "10 N*s/m" }',
    }  # fmt: skip
    numbers = {item.name: item.bounds for item in build_model(load_scene("psh", rubbing)).parameters}
    assert (numbers["psh.mesh.friction.speed"], numbers["psh.mesh.friction.damping"]) == (POSITIVE, DAMPER)
    assert numbers["psh.output.bearing.stiffness"] == NOT_NEGATIVE
    series = build_model(load_scene("lsp", {"effects.mesh_stiffness": "fourier"}))
    numbers = {item.name: item.bounds for item in series.parameters}
    assert numbers["lsp.sun_planet.stiffness_mean"] == NOT_NEGATIVE  # amplitudes have either sign
    assert numbers["lsp.sun_planet.stiffness_cos_1"] == ANY


def test_flanks_with_backlash_are_two_connections():
    model = build_model(load_scene("start-up"))
    front, back = (item for item in list_connections(model) if item.kind == "mesh")
    assert (front.name, back.name, front.group) == ("pair.mesh", "pair.mesh.back", back.group)
    assert (front.back, back.back) == (False, True)
    assert front.hold != back.hold
    assert front.flank != back.flank
    assert front.bodies == back.bodies == ("pair.input", "pair.output")


def test_points_of_members_are_no_members():
    changes = {"effects.eccentricity": "on", "stages.psh.input.eccentricity": '{ radius = "10 um", angle = "0 deg" }'}
    model = build_model(load_scene("psh", changes))
    assert "psh.input.teeth" in {item.name for item in model.bodies}
    assert [item.name for item in list_bodies(model)] == ["psh.input", "psh.output"]
    mesh = next(item for item in list_connections(model) if item.kind == "mesh")
    assert mesh.bodies == ("psh.input", "psh.output")


@pytest.mark.parametrize("kind", ["two-level", "fourier", "mean"])
def test_a_mesh_tells_the_parameters_of_its_stiffness(kind):
    model = build_model(load_scene("psh", {"effects.mesh_stiffness": kind}))
    [mesh] = (item for item in list_connections(model) if item.kind == "mesh")
    units = {item.name: item.unit for item in model.parameters if "stiffness" in item.name and "mesh" in item.name}
    assert {*mesh.stiffness, *mesh.profile} == units.keys()
    assert bool(mesh.profile) == (kind == "fourier")


def test_load_signals_tell_what_they_are_of_a_load():
    rows = '{ member = "psh.input", speed_over_time = [["0 s", "0 rpm"], ["1 s", "600 rpm"]] }'
    signals = build_model(load_scene("psh", {"loads.input": rows})).signals
    assert [(item.quantity, item.slope) for item in signals] == [
        ("loads.input.speed", False), ("loads.input.acceleration", True),
    ]  # fmt: skip
    assert {item.table for item in signals} == {"loads.input.speed_over_time"}


def test_loads_tell_their_torque_or_slip_law():
    slip = '{ synchronous_speed = "1500 rpm", breakdown_torque = "30 kN*m", breakdown_slip = 0.05 }'
    constant = {item.item: item.law for item in list_connections(build_model(load_scene("rig-2mw"))) if item.law}
    assert constant == {"generator": ("loads.generator.torque",)}
    machine = build_model(load_scene("rig-2mw", {"loads.generator": f'{{ member = "generator", slip = {slip} }}'}))
    assert {item.item: item.law for item in list_connections(machine) if item.law} == {
        "generator": tuple(f"loads.generator.{end}" for end in ENDS)
    }
