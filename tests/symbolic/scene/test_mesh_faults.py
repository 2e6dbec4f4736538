"""What cannot be right about profiles, errors and joints of a scene is told with key, reason and cure."""

import pytest
from ltcgear.generated.errors import SceneError
from ltcgear.symbolic.assembly import build_model
from ltcgear.symbolic.scene.load import make_scene

from ...runtime.models import raw_scene

MESH = "stages.lsp.sun_planet"


@pytest.mark.parametrize(
    ("settings", "key", "word"),
    [
        ([f"{MESH}.transition = 0.5"], f"{MESH}.transition", "at most"),
        ([f"{MESH}.stiffness_table = [['0', '1e9 N/m'], ['1', '2e9 N/m']]"], f"{MESH}.stiffness_table", "close"),
        ([f"{MESH}.stiffness_table = [['0', '1e9 N/m'], ['0.3', '2e9 N/m']]"], f"{MESH}.stiffness_table", "whole"),
        ([f"{MESH}.stiffness_table = [['0', '1e9 N/m'], ['1.3', '1e9 N/m']]"], f"{MESH}.stiffness_table", "between"),
        ([f"{MESH}.stiffness_table = [['0', '0 N/m'], ['0.8', '1e9 N/m']]"], f"{MESH}.stiffness_table", "zero"),
        (
            [
                f"{MESH}.stiffness_table = [['0', '1e6 N/m'], ['0.5', '9e9 N/m'], ['0.51', '1e6 N/m']]",
                f"{MESH}.harmonics = 1",
            ],
            f"{MESH}.stiffness_table",
            "harmonics",
        ),
        ([f"{MESH}.transmission_error = {{}}"], f"{MESH}.transmission_error", "amplitudes or a table"),
        (
            [f"{MESH}.transmission_error = {{amplitudes = ['1 um'], phases = ['1 deg', '2 deg']}}"],
            f"{MESH}.transmission_error.phases",
            "one each",
        ),
        (
            [f"{MESH}.tooth_errors = [{{gear = 'ring', tooth = 1, error = '1 um'}}]"],
            f"{MESH}.tooth_errors.0.gear",
            "sun",
        ),
        (
            [f"{MESH}.tooth_errors = [{{gear = 'sun', tooth = 22, error = '1 um'}}]"],
            f"{MESH}.tooth_errors.0.tooth",
            "0 to 21",
        ),
        (
            [f"{MESH}.tooth_errors = [{{gear = 'sun', tooth = 1, error = '1 um', planet = 5}}]"],
            f"{MESH}.tooth_errors.0.planet",
            "planet 5",
        ),
        (["stages.lsp.planet.eccentricity.radius = '1 um'"], "stages.lsp.planet.eccentricity", "eccentricities"),
        (
            ["stages.lsp.eccentricities = [{planet = 1, radius = '1 um'}, {planet = 1, radius = '2 um'}]"],
            "stages.lsp.eccentricities",
            "once",
        ),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_the_defect_is_told(settings, key, word):
    with pytest.raises(SceneError) as told:
        make_scene(raw_scene("lsp", *settings))
    (line,) = str(told.value).splitlines()[1:]
    assert line.strip().startswith(f"{key}:")
    assert word in line


def test_default_transitions_give_way_where_contact_is_short():
    """With a contact ratio of 1.96 single contact lasts 0.04 pitches, less than the default transition."""
    scene = make_scene(raw_scene("lsp", f"{MESH}.contact_ratio = 1.96", "effects.mesh_stiffness = 'smooth'"))
    assert build_model(scene).values()["lsp.sun_planet.transition"] == pytest.approx(0.04)


@pytest.mark.parametrize(
    ("setting", "key"),
    [
        (f"{MESH}.backlash = '-1 mm'", f"{MESH}.backlash"),
        (f"{MESH}.backlash = '1 km'", f"{MESH}.backlash"),
        (f"{MESH}.transmission_error.amplitudes = ['1 m']", f"{MESH}.transmission_error.amplitudes.0"),
        ("stages.lsp.pin.clearance = '1 m'", "stages.lsp.pin.clearance"),
        ("stages.lsp.position_errors = [{planet = 1, radial = '1 m'}]", "stages.lsp.position_errors.0.radial"),
        ("stages.lsp.sun.eccentricity.radius = '-1 um'", "stages.lsp.sun.eccentricity.radius"),
        (f"{MESH}.transition = 1e-9", f"{MESH}.transition"),
        (
            f"{MESH}.tooth_errors = [{{gear = 'sun', tooth = 1, error = '1 um'}}, "
            "{gear = 'sun', tooth = 1, error = '2 um'}]",
            f"{MESH}.tooth_errors.1",
        ),
    ],
)
def test_gaps_and_errors_are_small_ones(setting, key):
    with pytest.raises(SceneError) as told:
        make_scene(raw_scene("lsp", setting))
    assert any(line.strip().startswith(f"{key}:") for line in str(told.value).splitlines())


def test_a_train_driven_from_rest_needs_its_speed():
    raw = raw_scene("psh", "-loads.input.speed", "loads.input.torque_over_time = [['0 s', '0 N*m'], ['1 s', '9 N*m']]")
    with pytest.raises(SceneError, match="initial_speed"):
        make_scene(raw)
    raw["loads"]["input"]["initial_speed"] = "0 rpm"
    assert make_scene(raw).loads


ERROR = f"{MESH}.tooth_errors = [{{gear = 'sun', tooth = 1, error = '1 um'}}]"
SLIDING = ("effects.mesh_friction = 'sliding'", f"{MESH}.friction.coefficient = 0.1")


@pytest.mark.parametrize(
    ("settings", "word"),
    [
        ((f"{MESH}.contact_ratio = 1.0000005",), "give 1"),
        ((f"{MESH}.contact_ratio = 1.9999999",), "give 2"),
        ((f"{MESH}.contact_ratio = 2", ERROR), "between 1 and 2"),
        ((f"{MESH}.contact_ratio = 1", *SLIDING), "between 1 and 2"),
    ],
)
def test_whole_contact_ratios_leave_nothing_to_hand_over(settings, word):
    with pytest.raises(SceneError) as told:
        make_scene(raw_scene("lsp", *settings))
    (line,) = str(told.value).splitlines()[1:]
    assert line.strip().startswith(f"{MESH}.contact_ratio:")
    assert word in line
