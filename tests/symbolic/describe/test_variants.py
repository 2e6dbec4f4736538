"""Variants of a scene with one effect left out, what effects do in it, and why each freedom is there."""

import pytest
from ltcgear.symbolic.assembly import build_model
from ltcgear.symbolic.describe import variants
from ltcgear.symbolic.describe.freedoms import explain_freedoms
from ltcgear.symbolic.describe.variants import Change, acting_effects, list_changes
from ltcgear.symbolic.scene.load import load_scene, shipped_scenes
from ltcgear.symbolic.schema import effects
from ltcgear.symbolic.schema.effects import EFFECTS, Exclusion


def listed(name, changes=None):
    scene = load_scene(name, changes)
    return list_changes(scene, build_model(scene))


def test_effects_that_act_can_be_left_out():
    expected = {Change("mesh_stiffness", "two-level", "mean"), Change("damping", "on", "off")}
    assert expected | {Change("mesh_damping", "on", "off"), Change("lateral", "on", "off")} <= set(listed("psh"))
    assert "gravity" not in {item.effect for item in listed("psh")}
    assert Change("gravity", "on", "off") in listed("psh", {"effects.gravity": "on"})


def test_idle_effects_are_not_among_them():
    idle = {"effects.mesh_friction": "pitch-point", "effects.bearing_friction": "on", "effects.gravity": "on"}
    assert {"mesh_stiffness", "damping", "gravity"} <= {item.effect for item in listed("lsp", idle)}
    assert not {"mesh_friction", "torsional_shafts"} & {item.effect for item in listed("lsp", idle)}


def test_what_contradicts_stays_for_the_loader_to_refuse(monkeypatch):
    damping = next(effect for effect in EFFECTS if effect.name == "damping")
    exclusion = Exclusion("mesh_stiffness", ("two-level",), "it is so for this test")
    monkeypatch.setitem(damping.__dict__, "excludes", {"off": (exclusion,)})
    assert Change("damping", "on", "off") in listed("psh")
    with pytest.raises(Exception, match="it is so for this test"):
        load_scene("psh", {"effects.damping": "off"})


def test_a_value_that_takes_freedoms_away_is_offered_too(monkeypatch):
    whole = variants.build_model

    def narrowed(scene):
        model = whole(scene)
        bodies = tuple(model.bodies[:-1]) if scene.effects["mesh_law"] == "paper" else model.bodies
        return type(model)(**(model.__dict__ | {"bodies": bodies}))

    monkeypatch.setattr(variants, "build_model", narrowed)
    assert Change("mesh_law", "involute", "paper") in listed("psh")


@pytest.mark.parametrize("name", shipped_scenes())
def test_every_freedom_has_a_reason(name):
    scene = load_scene(name)
    model = build_model(scene)
    rows = explain_freedoms(scene, model)
    assert all(row["reason"] and "nothing holds its angle" not in row["reason"] for row in rows)
    many = {row["body"]: int(row["body"].rpartition("-")[2]) for row in rows if ".1-" in row["body"]}
    axes = sum(len(row["axes"]) * many.get(row["body"], 1) for row in rows if row["body"] != "reference")
    assert axes == sum(2 * body.lateral + (body.turning == "free") for body in model.bodies)


def test_a_train_driven_by_torque_alone_has_its_speed_as_a_state():
    changes = {"loads.input": "{ member = 'psh.input', torque = '1 kN*m', initial_speed = '10 rpm' }"}
    scene = load_scene("psh", changes)
    first = explain_freedoms(scene, build_model(scene))[0]
    assert (first["body"], first["axes"]) == ("reference", ["angle", "speed"])


def test_rigid_joints_take_freedoms_and_their_reasons():
    rigid = {"effects.torsional_shafts": "rigid", "effects.pins": "rigid"}
    scene = load_scene("rig-2mw", rigid)
    rows = {row["body"]: row for row in explain_freedoms(scene, build_model(scene))}
    assert not any("shaft" in row["reason"] or "pin is flexible" in row["reason"] for row in rows.values())
    assert "generator" not in rows
    assert rows["lsp.planet.1-4"]["axes"] == ["u"]
    assert any(row["reason"].endswith("u: its meshes are flexible") for row in rows.values())


def test_what_an_effect_does_is_counted():
    scene = load_scene("psh", {"effects.gravity": "on", "effects.contact": "one-flank"})
    here = {item["effect"]: item["here"] for item in acting_effects(scene, build_model(scene))}
    assert here["gravity"] == "gravity: 2 more, 2 numbers more"
    assert here["mesh_stiffness"].startswith("mesh: 1 with other terms, 1 stiffness that switches")
    idle = load_scene("psh", {"effects.bearing_friction": "on"})
    assert "bearing_friction" not in {item["effect"] for item in acting_effects(idle, build_model(idle))}


def test_freedoms_are_those_of_the_manifest():
    assert build_model(load_scene("rig-2mw")).freedoms == 41
    assert effects.BY_NAME["mesh_law"].without == "involute"


def test_a_law_of_angles_is_the_same_whatever_moves_sideways():
    scene = load_scene("rig-2mw")
    here = {row["effect"]: row["here"] for row in acting_effects(scene, build_model(scene))}
    assert "mesh: 15 with other terms" in here["lateral"]
    assert "coupling" not in here["lateral"]
    assert "torque" not in here["lateral"]
