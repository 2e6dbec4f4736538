"""Changes of a scene, as `--set` gives them."""

import pytest
from ltcgear.generated.errors import SceneError
from ltcgear.symbolic.scene.load import load_scene


def test_changes_replace_values_and_their_labels():
    scene = load_scene(
        "lsp", {"stages.lsp.module": "15 mm", "loads.ring.speed": "'10 rpm'", "stages.lsp.sun.teeth": "22"}
    )
    assert scene.stages["lsp"].module == 0.015
    assert scene.stages["lsp"].sun.teeth == 22
    assert "stages.lsp.module" not in scene.sources


def test_a_changed_value_does_not_keep_a_printed_label():
    scene = load_scene("lsp", {"stages.lsp.module.value": "15 mm"})
    assert scene.sources["stages.lsp.module"].startswith("assumed: ")


def test_a_whole_number_is_a_place_in_a_list():
    errors = "stages.lsp.position_errors"
    changes = {errors: "[{ planet = 1 }, { planet = 3 }]", f"{errors}.1.tangential": "20 um", "title": "two pins"}
    found = load_scene("lsp", changes).stages["lsp"].position_errors
    assert [(one.planet, pytest.approx(one.tangential)) for one in found] == [(1, 0.0), (3, 20e-6)]
    with pytest.raises(
        SceneError, match=r"the list stages.lsp.position_errors has the places 0 to 1, not '2'; set the"
    ):
        load_scene("lsp", {**changes, f"{errors}.2.planet": "4"})
    with pytest.raises(SceneError, match="has the places 0 to 1, not 'first'"):
        load_scene("lsp", {**changes, f"{errors}.first.planet": "4"})
    with pytest.raises(SceneError, match="has no places, not '0'"):
        load_scene("lsp", {errors: "[]", f"{errors}.0.planet": "4"})


CHANGES = {
    "stages.lsp.module": ("16", "stages.lsp.module: 16 has no unit"),
    "stages.lsp.modul": ("16 mm", 'stages.lsp.modul: unknown key; did you mean "module"?'),
    "stages.lps.sun.teeth": ("22", "stages.lps.kind: is missing"),
    "title.x": ("1", "title.x: 'title' is a value, not a table"),
    "": ("1", "unknown key"),
    "..": ("1", "unknown key"),
    "gravity.0": ("'1 m/s^2'", "gravity.0: gravity is no list yet, so it has no place 0; set the whole list first"),
    "title": ("", "title: must not be empty"),
    "effects.gravity": ("true", "effects.gravity: True is not a value of it"),
    "x": ("[" * 50_000, "x: unknown key"),
    "y": ("9" * 6000, "y: unknown key"),
    "a" + ".a" * 3000: ("1", "nested too deeply"),
    "stages.lsp.pin.stiffness": ("'1 N/m'\n[effects]\ngravity='on'", "stages.lsp.pin.stiffness:"),
}


@pytest.mark.parametrize("key", CHANGES, ids=lambda key: key[:30] or "empty")
def test_a_bad_change_is_refused(key):
    value, reason = CHANGES[key]
    with pytest.raises(SceneError) as caught:
        load_scene("lsp", {key: value})
    assert reason in str(caught.value)
    assert len(str(caught.value)) < 1500
