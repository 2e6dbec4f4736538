"""The Python builder makes the same scenes as TOML, by the same checks."""

import tomllib

import pytest
from ltcgear.generated.errors import SceneError
from ltcgear.symbolic import SceneBuilder, build_model, load_scene
from ltcgear.symbolic.scene.load import SHIPPED


@pytest.mark.parametrize("name", ["rig-2mw", "psh", "lin-parker-4", "floating-off"])
def test_a_shipped_scene_built_step_by_step_is_the_same_model(name):
    raw = tomllib.loads((SHIPPED / f"{name}.toml").read_text("utf-8"))
    builder = SceneBuilder(raw["title"], **raw["effects"]) if "effects" in raw else SceneBuilder(raw["title"])
    for stage, table in raw.get("stages", {}).items():
        keys = {key: value for key, value in table.items() if key != "kind"}
        getattr(builder, table["kind"])(stage, **keys)
    for rotor, table in raw.get("rotors", {}).items():
        builder.rotor(rotor, **table)
    for coupling, table in raw.get("couplings", {}).items():
        keys = {key: value for key, value in table.items() if key != "between"}
        builder.coupling(coupling, *table["between"], **keys)
    for load, table in raw.get("loads", {}).items():
        builder.load(load, **table)
    if "simulation" in raw:
        builder.simulation(**raw["simulation"])
    built, read = build_model(builder.build(name)), build_model(load_scene(name))
    assert built.values() == read.values()
    assert built.structure() == read.structure()


def test_defects_are_told_together():
    builder = SceneBuilder("bad", mesh_law="exact").rotor("motor", inertia=3).load("drive", "moter", speed="15 Hz")
    with pytest.raises(SceneError) as caught:
        builder.build()
    for word in ("mesh_law", "rotors.motor.inertia", "moter", "15 Hz"):
        assert word in str(caught.value)


def test_a_builder_can_be_used_again():
    builder = SceneBuilder("x", gravity="on").rotor("a", inertia="1 kg*m^2").gravity("1 m/s^2", "0 m/s^2")
    first = builder.build()
    assert builder.rotor("b", inertia="2 kg*m^2").build().rotors.keys() == {"a", "b"}
    assert first.rotors.keys() == {"a"}
