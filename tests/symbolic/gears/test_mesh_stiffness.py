"""The two levels of a mesh's stiffness, given or computed."""

import pytest
from ltcgear.symbolic.assembly import build_model
from ltcgear.symbolic.describe.geometry_report import describe
from ltcgear.symbolic.gears.mesh_stiffness import levels
from ltcgear.symbolic.scene.load import load_scene

from ...runtime.models import case

WIDTH = ("-stages.lsp.sun_planet.torsional_stiffness", "-stages.lsp.sun_planet.reference",
         "-stages.lsp.sun_planet.double_factor", "stages.lsp.sun_planet.face_width = '400 mm'")  # fmt: skip


def test_a_torsional_stiffness_is_taken_on_its_gear():
    """Wu et al. 2021, Table 4: 1.54e8 N m/rad single, coefficient 1.10; r_b of the planet 360.842 mm."""
    stage = load_scene("lsp").stages["lsp"]
    single, double = levels(stage, stage.sun_planet, stage.sun, stage.planet, 1)
    assert single == pytest.approx(1.54e8 / 0.360842**2, rel=1e-5)
    assert double == pytest.approx(1.10 * single)


def test_a_face_width_gives_both_levels():
    found = case("lsp", *WIDTH)
    values = found.model.values()
    single, double = (values[f"lsp.sun_planet.stiffness_{word}"] for word in ("single", "double"))
    # ISO 6336-1 for this pair: c' 5.23e9, c_gamma 7.83e9 N/m; the method lies up to 30 % above.
    assert 1.0 < single / 5.23e9 < 1.3
    assert 1.5 < double / single < 1.8
    mean = single * values["lsp.sun_planet.single_share"] + double * (1 - values["lsp.sun_planet.single_share"])
    assert 1.0 < mean / 7.83e9 < 1.3
    assert describe(found.scene)["stages"]["lsp"]["meshes"]["sun_planet"]["stiffness_double_n_per_m"] == double


def test_a_computed_mesh_carries_the_static_load():
    found = case("lsp", *WIDTH)
    path = found.run(method="erk", rtol=1e-5, t_end=0.02)
    assert path.status == "done"
    assert path.counts.events == path.expected_events > 0


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"stages.lsp.helix_angle": "8 deg"}, "spur"),
        ({"stages.lsp.sun_planet.contact_ratio": "1.6"}, "drop one"),
        ({"stages.lsp.sun_planet.stiffness": "1e9 N/m"}, "give either"),
    ],
)
def test_what_cannot_be_computed_is_refused(change, word):
    from ltcgear.generated.errors import SceneError

    from ...runtime.models import make_case, raw_scene

    raw = raw_scene("lsp", *WIDTH, *(f"{key} = {value if value[0].isdigit() and ' ' not in value else repr(value)}"
                                     for key, value in change.items()))  # fmt: skip
    with pytest.raises(SceneError, match=word):
        make_case(raw)


def test_constant_without_a_second_level():
    stage = load_scene("rig-2mw").stages["hsp"]
    assert levels(stage, stage.ring_planet, stage.ring, stage.planet, -1)[1] is None
    assert build_model(load_scene("rig-2mw")).values()["hsp.ring_planet.stiffness"] == pytest.approx(4.0266e9, rel=1e-4)


@pytest.mark.parametrize(("ratio", "part"), [(1, 0), (2, 1)])
def test_a_whole_contact_ratio_has_one_level(ratio, part):
    given = levels(*mesh_of(load_scene("lsp")))
    scene = load_scene("lsp", {"stages.lsp.sun_planet.contact_ratio": str(ratio)})
    assert levels(*mesh_of(scene)) == (given[part], None)
    model = build_model(scene)
    assert not [level for level in model.levels if "sun_planet" in level.name]
    assert model.values()["lsp.sun_planet.stiffness"] == given[part]


def mesh_of(scene):
    stage = scene.stages["lsp"]
    return stage, stage.sun_planet, stage.sun, stage.planet, 1
