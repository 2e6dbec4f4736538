"""Shipped scenes: they load, every number has a source, and printed values are those of the paper."""

import re

import pytest
from ltcgear.symbolic.assembly import build_model
from ltcgear.symbolic.scene.load import load_scene, shipped_scenes
from ltcgear.symbolic.schema.effects import DEFAULTS

from ...runtime.models import raw_scene

LABELS = ("printed:", "derived:", "assumed:", "fitted:")
QUANTITY = re.compile(r"\s*[+-]?[0-9.]")


def test_the_shipped_scenes_are_there():
    assert {"rig-2mw", "lsp", "hsp", "psh", "lin-parker-3", "lin-parker-4", "lin-parker-5"} <= set(shipped_scenes())
    assert shipped_scenes() == sorted(shipped_scenes())


@pytest.mark.parametrize("name", shipped_scenes())
def test_every_shipped_scene_loads(name):
    scene = load_scene(name)
    assert scene.name == name
    assert scene.title
    assert set(scene.effects) == set(DEFAULTS)
    assert build_model(scene).values()


def numbers(node, path=()):
    """Yield dotted key and label of everything in a raw scene that is a number or a quantity."""
    if isinstance(node, dict) and set(node) == {"value", "source"}:
        if isinstance(node["value"], (int, float)) or QUANTITY.match(str(node["value"])):
            yield ".".join(path), node["source"]
    elif isinstance(node, dict):
        for key, value in node.items():
            yield from numbers(value, (*path, key))
    elif isinstance(node, list):
        for i, value in enumerate(node):
            yield from numbers(value, (*path, str(i)))
    elif isinstance(node, (int, float)) or (isinstance(node, str) and QUANTITY.match(node)):
        yield ".".join(path), None


@pytest.mark.parametrize("name", shipped_scenes())
def test_every_number_says_where_it_comes_from(name):
    tree = raw_scene(name)
    tree.pop("title")
    tree.get("simulation", {}).pop("t_end", None)
    found = dict(numbers(tree))
    assert len(found) >= 10
    assert not [key for key, source in found.items() if source is None]
    assert not [key for key, source in found.items() if not source.startswith(LABELS)]
    assert set(found) <= set(load_scene(name).sources)


# Wu, Zhou, Jiang, Chen, Appl. Sci. 2021, 11, 6876; torsional stiffness in 1e8 N m/rad, bearings in 1e9 N/m.
PRINTED = {
    # section 3.1
    "lsp.planets": 4,
    "hsp.planets": 3,
    # Table 2
    "lsp.ring.teeth": 118,
    "lsp.planet.teeth": 48,
    "lsp.sun.teeth": 22,
    "lsp.module": 0.016,
    "lsp.pressure_angle": "20 deg",
    "hsp.ring.teeth": 118,
    "hsp.planet.teeth": 50,
    "hsp.sun.teeth": 17,
    "hsp.module": 0.012,
    "hsp.pressure_angle": "20 deg",
    # Table 3
    "psh.input.teeth": 59,
    "psh.output.teeth": 21,
    "psh.helix_angle": "8 deg",
    "psh.module": 0.009,
    "psh.pressure_angle": "20 deg",
    # Table 4, single pair and variable stiffness coefficient (section 4.1 for those that switch)
    "lsp.sun_planet.torsional_stiffness": 1.54e8,
    "lsp.ring_planet.torsional_stiffness": 8.78e8,
    "hsp.sun_planet.torsional_stiffness": 1.75e8,
    "hsp.ring_planet.torsional_stiffness": 3.20e8,
    "psh.mesh.torsional_stiffness": 0.96e8,
    "lsp.sun_planet.double_factor": 1.10,
    "lsp.ring_planet.double_factor": 1.01,
    "hsp.sun_planet.double_factor": 1.40,
    "psh.mesh.double_factor": 1.05,
    # Table 6, rows 1 to 3 (positions by load, READING.md)
    "lsp.pin.stiffness": 5.02e9,
    "hsp.pin.stiffness": 4.20e9,
    "lsp.ring.bearing.stiffness": 2.60e9,
}
PRINTED_SHAFTS = {  # Table 5
    "input_shaft": 0.49e8,
    "lsp_hsp": 1.81e8,
    "hsp_psh": 0.17e8,
    "output_shaft": 0.055e8,
    "flange": 0.45e8,
}


def attribute(scene, key):
    value = scene
    for part in key.split("."):
        value = value[part] if isinstance(value, dict) else getattr(value, part)
    return value


@pytest.mark.parametrize("key", PRINTED)
def test_printed_values_are_those_of_the_paper(key):
    expected = PRINTED[key]
    for name in ("rig-2mw", key.split(".")[0]):
        scene = load_scene(name)
        in_si = float(expected.split()[0]) * 0.017453292519943295 if isinstance(expected, str) else expected
        assert attribute(scene.stages, key) == pytest.approx(in_si, rel=1e-14)
        assert scene.sources[f"stages.{key}"].startswith("printed: ")


def test_printed_values_of_shafts_and_loads():
    scene = load_scene("rig-2mw")
    for name, stiffness in PRINTED_SHAFTS.items():
        assert scene.couplings[name].stiffness == pytest.approx(stiffness, rel=1e-14)
        assert scene.sources[f"couplings.{name}.stiffness"].startswith("printed: Table 5")
    # section 4.1: 15 rpm, 1.06e4 N m, 8192 Hz
    assert scene.loads["motor"].speed == pytest.approx(15 * 2 * 3.141592653589793 / 60, rel=1e-14)
    assert scene.loads["generator"].torque == -1.06e4
    assert scene.simulation.rate == 8192.0


def test_values_derived_from_print():
    """Table 6, rows 4 to 7: two bearings a shaft stand side by side."""
    psh = load_scene("rig-2mw").stages["psh"]
    assert psh.input.bearing.stiffness == pytest.approx(3.46e9 + 3.60e9, rel=1e-14)
    assert psh.output.bearing.stiffness == pytest.approx(2.70e9 + 0.43e9, rel=1e-14)


def test_nothing_is_called_printed_that_the_table_here_does_not_hold():
    scene = load_scene("rig-2mw")
    called = {key for key, source in scene.sources.items() if source.startswith("printed:")}
    known = {f"stages.{key}" for key in PRINTED} | {f"couplings.{key}.stiffness" for key in PRINTED_SHAFTS}
    assert called == known | {"loads.motor.speed", "loads.generator.torque", "simulation.rate"}
