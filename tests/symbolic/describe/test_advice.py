"""Effects that are on and cannot act are told, and only those."""

import pytest
from ltcgear.symbolic.describe.advice import warnings
from ltcgear.symbolic.scene.load import load_scene, shipped_scenes

COEFFICIENT = {"stages.lsp.sun_planet.friction.coefficient": "0.05"}


@pytest.mark.parametrize("scene", shipped_scenes())
def test_shipped_scenes_have_no_idle_effect(scene):
    assert warnings(load_scene(scene)) == []


@pytest.mark.parametrize(
    ("scene", "changes", "word"),
    [
        ("lsp", {"effects.mesh_friction": "pitch-point"}, "coefficient"),
        ("lsp", {"effects.bearing_friction": "on"}, "friction_damping"),
        ("lin-parker-3", {"effects.mesh_stiffness": "two-level"}, "double_factor"),
    ],
)
def test_an_idle_effect_is_told_with_its_cure(scene, changes, word):
    (line,) = warnings(load_scene(scene, changes))
    assert next(iter(changes)) in line
    assert word in line


def test_an_effect_with_numbers_is_not_idle():
    assert warnings(load_scene("lsp", {"effects.mesh_friction": "pitch-point"} | COEFFICIENT)) == []
    assert warnings(load_scene("lsp", {"effects.gravity": "on"})) == []
