"""Defects of a scene: each told once, with file, key, reason and cure, and all in one message."""

import math
import random
import re

import pytest
from ltcgear.generated.errors import SceneError
from ltcgear.symbolic.assembly import build_model
from ltcgear.symbolic.scene.load import load_scene, make_scene, restore_scene

from ...runtime.models import raw_scene


def put(tree, key, value):
    """Set a dotted key of a raw scene; a value of ``...`` removes it."""
    *path, last = key.split(".")
    for part in path:
        tree = tree.setdefault(part, {})
    if value is ...:
        del tree[last]
    else:
        tree[last] = value


def edited(name, changes):
    tree = raw_scene(name)
    for key, value in changes.items():
        put(tree, key, value)
    return tree


def message(tree):
    with pytest.raises(SceneError) as caught:
        make_scene(tree, label="gear.toml")
    assert caught.value.exit_code == 2
    return str(caught.value)


L = "stages.lsp."
DEFECTS = {
    # misspelt keys, at every depth
    "table": ("lsp", {"stage": {}}, "stage: unknown key", 'did you mean "stages"?'),
    "stage key": ("lsp", {L + "modul": "16 mm"}, "stages.lsp.modul: unknown key", 'did you mean "module"?'),
    "gear key": ("lsp", {L + "sun.teeht": 22}, "stages.lsp.sun.teeht: unknown key", 'did you mean "teeth"?'),
    "disc key": ("lsp", {L + "sun.disc.widht": "1 m"}, "stages.lsp.sun.disc.widht", 'did you mean "width"?'),
    "bearing key": (
        "lsp",
        {L + "ring.bearing.stifness": "1 N/m"},
        "stages.lsp.ring.bearing.stifness",
        'did you mean "stiffness"?',
    ),
    "friction key": (
        "lsp",
        {L + "sun_planet.friction": {"coeficient": 0.1}},
        "stages.lsp.sun_planet.friction.coeficient",
        'did you mean "coefficient"?',
    ),
    "rotor key": ("rig-2mw", {"rotors.motor.intertia": "1 kg*m^2"}, "rotors.motor.intertia", '"inertia"?'),
    "coupling key": ("rig-2mw", {"couplings.flange.betwen": []}, "couplings.flange.betwen", '"between"?'),
    "load key": ("lsp", {"loads.ring.sped": "15 rpm"}, "loads.ring.sped", '"speed"?'),
    "simulation key": ("lsp", {"simulation.tend": "1 s"}, "simulation.tend", '"t_end"?'),
    "key far from all": ("lsp", {L + "zzz": 1}, "stages.lsp.zzz: unknown key", "known keys: carrier, center_distance"),
    "key of another kind": ("psh", {"stages.psh.sunn": 1}, "stages.psh.sunn: unknown key", "known keys: "),
    "effect": ("lsp", {"effects.mesh_lwa": "paper"}, "effects.mesh_lwa: unknown effect", '"mesh_law"?'),
    "effect value": ("lsp", {"effects.mesh_law": "papre"}, "effects.mesh_law: 'papre'", 'did you mean "paper"?'),
    "effect as boolean": ("lsp", {"effects.gravity": True}, "effects.gravity: True", "values: off, on"),
    "effects as list": ("lsp", {"effects": ["gravity"]}, "effects: must be a table", "['gravity']"),
    # structure
    "no title": ("lsp", {"title": ...}, "title: is missing", ""),
    "empty title": ("lsp", {"title": ""}, "title: must not be empty", ""),
    "wrong kind": ("lsp", {L + "kind": "planetry"}, "stages.lsp.kind: 'planetry'", 'kind = "planetary"'),
    "no kind": ("lsp", {L + "kind": ...}, "stages.lsp.kind: is missing", 'kind = "pair"'),
    "kind as list": ("lsp", {L + "kind": ["pair"]}, "stages.lsp.kind: ['pair']", 'kind = "pair"'),
    "missing member": ("lsp", {L + "sun": ...}, "stages.lsp.sun: is missing", ""),
    "stage as number": ("lsp", {"stages.lsp": 3}, "stages.lsp: must be a table, not 3", ""),
    "stages as list": ("lsp", {"stages": [1]}, "stages: must be a table", ""),
    "bad name": ("lsp", {"rotors.Motor": {"inertia": "1 kg*m^2"}}, "rotors.Motor: names are small letters", ""),
    "name taken": ("lsp", {"rotors.lsp": {"inertia": "1 kg*m^2"}}, "rotors.lsp: a stage has this name", "another"),
    "reserved name": ("lsp", {"rotors.reference": {"inertia": "1 kg*m^2"}}, "rotors.reference:", "another"),
    "name set": ("lsp", {"name": "x"}, "name: is set by ltcgear", "remove it"),
    "no member at all": ("lsp", {"stages": {}, "loads": {}}, "stages: the scene has no member", "add a stage"),
    # values
    "bare number": ("lsp", {L + "module": 16}, "stages.lsp.module: 16 has no unit", '"16 mm"'),
    "bare number in text": ("lsp", {L + "module": "16"}, "stages.lsp.module: '16' has no unit", '"16 mm"'),
    "wrong dimension": ("lsp", {"loads.ring.speed": "15 Hz"}, "loads.ring.speed: '15 Hz'", '"15 rpm"'),
    "torque for stiffness": (
        "lsp",
        {L + "sun_planet.torsional_stiffness": "1e8 N*m"},
        "stages.lsp.sun_planet.torsional_stiffness: '1e8 N*m' has the wrong dimension",
        '"1.8e8 N*m/rad"',
    ),
    "injection": ("lsp", {L + "module": "__import__('os')"}, "stages.lsp.module:", "is not a number with a unit"),
    "negative mass": (
        "lsp",
        {L + "sun.disc": ..., L + "sun.mass": "-3 kg", L + "sun.inertia": "1 kg*m^2"},
        "stages.lsp.sun.mass: '-3 kg'",
        "greater than zero",
    ),
    "absurd size": ("lsp", {L + "module": "1e200 m"}, "stages.lsp.module: '1e200 m'", "out of all bounds"),
    "number as text": ("lsp", {L + "sun.teeth": "22"}, "stages.lsp.sun.teeth: must be a whole number", "'22'"),
    "teeth not whole": ("lsp", {L + "sun.teeth": 22.5}, "stages.lsp.sun.teeth: must be a whole number", "22.5"),
    "negative teeth": ("lsp", {L + "sun.teeth": -22}, "stages.lsp.sun.teeth: must be greater", "-22"),
    "damping in percent": ("lsp", {L + "pin.damping_ratio": "3 %"}, "stages.lsp.pin.damping_ratio: must be", "number"),
    "damping above one": ("lsp", {L + "pin.damping_ratio": 5}, "stages.lsp.pin.damping_ratio: must be less than 1", ""),
    "nan": ("lsp", {L + "sun_planet.phase": float("nan")}, "stages.lsp.sun_planet.phase:", "finite number"),
    "choice": ("lsp", {L + "sun.support": "bearng"}, "stages.lsp.sun.support: must be 'fixed'", '"bearing"?'),
    "gravity of three": ("lsp", {"gravity": ["0 m/s^2"] * 3}, "gravity: must have 2 items at most, not 3", ""),
    "coupling of one": (
        "rig-2mw",
        {"couplings.flange.between": ["shaft"]},
        "couplings.flange.between: must have 2 items, not 1",
        "",
    ),
    "too many samples": ("lsp", {"simulation.rate": "1e12 Hz"}, "simulation.rate:", "lower one"),
    # what does not go together
    "disc and mass": ("lsp", {L + "sun.mass": "3 kg"}, "stages.lsp.sun: give either a disc", ""),
    "mass alone": (
        "lsp",
        {L + "sun.disc": ..., L + "sun.mass": "3 kg"},
        "stages.lsp.sun: inertia is missing",
        "or a disc",
    ),
    "hollow beyond its rim": (
        "lsp",
        {L + "sun.disc.inner_diameter": "3 m"},
        "stages.lsp.sun.disc.inner_diameter: must lie between",
        "",
    ),
    "bearing without support": (
        "lsp",
        {L + "sun.bearing": {"stiffness": "1 N/m"}},
        "stages.lsp.sun: support",
        "belong together",
    ),
    "fixed and sprung": (
        "lsp",
        {L + "carrier.torsional_support": {"stiffness": "1 N*m/rad"}},
        'stages.lsp.carrier: support = "fixed"',
        "drop torsional_support",
    ),
    "two dampings": (
        "lsp",
        {L + "sun_planet.damping": "1 N*s/m"},
        "stages.lsp.sun_planet: give either damping or damping_ratio",
        "",
    ),
    "two stiffnesses": ("lsp", {L + "sun_planet.stiffness": "1 N/m"}, "stages.lsp.sun_planet: give either", ""),
    "no reference": ("lsp", {L + "sun_planet.reference": ...}, "stages.lsp.sun_planet:", "belong together"),
    "reference elsewhere": (
        "lsp",
        {L + "sun_planet.reference": "ring"},
        "stages.lsp.sun_planet.reference: must be one of sun, planet",
        "'ring'",
    ),
    "planet with drag": ("lsp", {L + "planet.drag": "1 N*m*s/rad"}, "stages.lsp.planet.drag:", "leave drag out"),
    "pin friction without arm": ("lsp", {L + "pin.friction": 0.01}, "stages.lsp.pin.diameter: is missing", ""),
    "rotor without inertia": ("rig-2mw", {"rotors.motor.inertia": ...}, "rotors.motor: give either inertia", "disc"),
    "speed and torque": ("lsp", {"loads.ring.torque": "1 N*m"}, "loads.ring: give either speed or torque", ""),
    "speed and initial speed": (
        "lsp",
        {"loads.ring.initial_speed": "1 rpm"},
        "loads.ring.initial_speed: goes with torque",
        "",
    ),
    # names that refer to nothing
    "coupling end": (
        "rig-2mw",
        {"couplings.flange.between": ["shaft", "genrator"]},
        "couplings.flange.between: there is no member 'genrator'",
        'did you mean "generator"?',
    ),
    "coupling to itself": (
        "rig-2mw",
        {"couplings.flange.between": ["shaft", "shaft"]},
        "couplings.flange.between: both ends are 'shaft'",
        "",
    ),
    "load nowhere": ("lsp", {"loads.ring.member": "lsp.rign"}, "loads.ring.member:", 'did you mean "lsp.ring"?'),
    "load on a planet": ("lsp", {"loads.ring.member": "lsp.planet"}, "loads.ring.member:", "members: lsp.ring"),
    "load on a fixed member": ("lsp", {"loads.ring.member": "lsp.carrier"}, "loads.ring.member:", "free it"),
    "speed twice": (
        "lsp",
        {"loads.again": {"member": "lsp.ring", "speed": "14 rpm"}},
        "loads: the speed of lsp.ring is given twice",
        "",
    ),
    "speed and start elsewhere": (
        "lsp",
        {"loads.again": {"member": "lsp.ring", "torque": "1 N*m", "initial_speed": "14 rpm"}},
        "loads: the speed of lsp.ring is given twice",
        "",
    ),
    "speed against a spring": (
        "lsp",
        {L + "ring.torsional_support": {"stiffness": "1 N*m/rad"}},
        "loads.ring: lsp.ring has a torsional_support",
        "drop",
    ),
    # gears that cannot mesh
    "module without pressure angle": (
        "lsp",
        {L + "pressure_angle": ...},
        "stages.lsp.pressure_angle: is missing",
        "module",
    ),
    "pressure angle of 90": ("lsp", {L + "pressure_angle": "90 deg"}, "stages.lsp.pressure_angle:", "0 and 45 deg"),
    "helix of 90": ("psh", {"stages.psh.helix_angle": "90 deg"}, "stages.psh.helix_angle:", "-45 and 45 deg"),
    "no teeth": ("lsp", {L + "sun.teeth": ...}, "stages.lsp.sun: give teeth", "or base_radius"),
    "teeth against radius": ("lsp", {L + "sun.base_radius": "0.2 m"}, "stages.lsp.sun.base_radius:", "165.386 mm"),
    "ring too small": ("lsp", {L + "ring.teeth": 48}, "stages.lsp.ring: must be larger than the planet", ""),
    "shifts too low": (
        "lsp",
        {L + "sun.profile_shift": -1.9, L + "planet.profile_shift": -1.9},
        "stages.lsp.sun_planet: the profile shifts",
        "give larger ones",
    ),
    "distances differ": ("lsp", {L + "ring.teeth": 122}, "stages.lsp.center_distance:", "592.000 mm for ring-planet"),
    "base circles apart": (
        "lsp",
        {L + "center_distance": "100 mm"},
        "stages.lsp.sun_planet: the base circles' sum 526.228 mm",
        "check teeth, module and center_distance",
    ),
    "distance in metres": ("lsp", {L + "center_distance": "56 m"}, "stages.lsp.sun_planet: the centre distance", "45"),
    "contact ratio given out of range": (
        "lsp",
        {L + "sun_planet.contact_ratio": 2.5},
        "stages.lsp.sun_planet.contact_ratio: must be less than or equal to 2",
        "2.5",
    ),
    "contact ratio computed out of range": (
        "lsp",
        {L + "pressure_angle": "1 deg"},
        "stages.lsp.sun_planet.contact_ratio: full-depth teeth would have",
        "give contact_ratio",
    ),
    "interference": (
        "psh",
        {"stages.psh.input.teeth": 5, "stages.psh.output.teeth": 5},
        "stages.psh.mesh.contact_ratio: full-depth tips",
        "give contact_ratio",
    ),
    "planets that cannot be assembled": (
        "lsp",
        {L + "planets": 3},
        "stages.lsp.planets: 3 equally spaced planets cannot be assembled",
        "give planet_angles",
    ),
    "planets between the teeth": (
        "lsp",
        {L + "planet_angles": ["0 deg", "91 deg", "180 deg", "270 deg"]},
        "stages.lsp.planet_angles.1:",
        '"90 deg"',
    ),
    "planets that overlap": ("lsp", {L + "planets": 5}, "stages.lsp.planets: neighbouring planets overlap", "fewer"),
    "planets in one place": (
        "lsp",
        {L + "planet_angles": ["0 deg", "360 deg", "180 deg", "270 deg"]},
        "stages.lsp.planet_angles: neighbouring planets overlap",
        "",
    ),
    "angles missing": ("lsp", {L + "planet_angles": ["0 deg"]}, "stages.lsp.planet_angles: 1 angles", "give one"),
    "all afloat": (
        "lin-parker-3",
        {f"stages.gear.{part}.{key}": value for part in ("sun", "ring", "carrier")
         for key, value in (("support", "floating"), ("bearing", ...))},
        "stages.gear: sun, ring and carrier all float",
        "give one of them a bearing",
    ),
    "pair afloat": (
        "psh",
        {"stages.psh.input.support": "floating", "stages.psh.input.bearing": ...},
        "stages.psh.input: nothing holds",
        "give it a bearing",
    ),
    # sources
    "label": (
        "lsp",
        {L + "module": {"value": "16 mm", "source": "guessed: x"}},
        "stages.lsp.module.source: 'guessed: x' must begin with",
        '"assumed: "',
    ),
    "label without text": (
        "lsp",
        {L + "module": {"value": "16 mm", "source": "printed: "}},
        "stages.lsp.module.source:",
        "must begin with",
    ),
    "label as number": ("lsp", {L + "module": {"value": "16 mm", "source": 3}}, "stages.lsp.module.source: 3", ""),
    "source alone": ("lsp", {L + "module": {"source": "printed: x"}}, "stages.lsp.module.source: value", "{ value ="),
    "value alone": ("lsp", {L + "module": {"value": "16 mm"}}, "stages.lsp.module.source: source is missing", ""),
    "source misspelt": (
        "lsp",
        {L + "module": {"value": "16 mm", "sorce": "printed: x"}},
        "stages.lsp.module.source: sorce does not belong here",
        "",
    ),
    "note beside source": (
        "lsp",
        {L + "module": {"value": "16 mm", "source": "printed: x", "note": "y"}},
        "stages.lsp.module.source: note does not belong here",
        "",
    ),
}  # fmt: skip


@pytest.mark.parametrize("defect", DEFECTS)
def test_a_defect_is_told_with_file_key_reason_and_cure(defect):
    name, changes, key, cure = DEFECTS[defect]
    text = message(edited(name, changes))
    head, *faults = text.split("\n")
    assert re.fullmatch(r"gear\.toml: \d+ defects?", head)
    told = [fault for fault in faults if fault.startswith(f"  {key}")]
    assert told, text
    assert cure in told[0]
    assert all(len(fault) < 700 for fault in faults)


ALONE = set(DEFECTS) - {"base circles apart", "distance in metres", "contact ratio computed out of range", "no title",
                        "bad name", "friction key", "planets between the teeth", "source alone"}  # fmt: skip


@pytest.mark.parametrize("defect", sorted(ALONE))
def test_one_defect_is_told_once(defect):
    name, changes, *_ = DEFECTS[defect]
    assert message(edited(name, changes)).startswith("gear.toml: 1 defect\n")


def test_all_defects_are_told_together():
    """Misspelt key, bare number, bad label, bad effect, two bad names, teeth that do not fit, at one go."""
    changes = {
        "stages.lsp.sun.teeht": 22,
        "stages.psh.module": 9,
        "stages.hsp.planets": 4,
        "stages.hsp.module": {"value": "12 mm", "source": "somewhere"},
        "effects.gravity": "onn",
        "effects.colour": "red",
        "couplings.flange.between": ["shaft", "genrator"],
        "couplings.hsp_psh.betwen": [],
        "loads.motor.member": "moter",
        "loads.generator.torque": "1 Nm",
        "rotors.shaft.disc.width": "-1 m",
    }
    text = message(edited("rig-2mw", changes))
    for key in (
        "stages.lsp.sun.teeht: unknown key",
        "stages.psh.module: 9 has no unit",
        "stages.hsp.planets: 4 equally spaced",
        "stages.hsp.module.source: 'somewhere'",
        "effects.gravity: 'onn'",
        "effects.colour: unknown effect",
        "couplings.flange.between: there is no member 'genrator'",
        "couplings.hsp_psh.betwen: unknown key",
        "loads.motor.member: there is no member 'moter'",
        "loads.generator.torque: '1 Nm'",
        "rotors.shaft.disc.width: '-1 m'",
    ):
        assert f"\n  {key}" in text, text
    assert text.startswith("gear.toml: 11 defects\n"), text


def test_a_bad_label_does_not_hide_a_bad_value():
    text = message(edited("lsp", {L + "module": {"value": 16, "source": "guessed: x"}}))
    assert "stages.lsp.module.source: 'guessed: x'" in text
    assert "stages.lsp.module: 16 has no unit" in text


def test_two_faults_of_one_table_are_both_told():
    text = message(edited("lsp", {L + "sun.disc": ..., L + "sun.support": "bearing"}))
    assert 'support = "bearing" and a bearing table' in text
    assert "mass and inertia are missing" in text


@pytest.mark.parametrize("name", ["planetary", "pair", "source", "value"])
def test_a_stage_may_have_any_free_name(name):
    tree = raw_scene("psh")
    tree["stages"][name] = tree["stages"].pop("psh")
    tree["loads"]["input"]["member"], tree["loads"]["output"]["member"] = f"{name}.input", f"{name}.output"
    assert make_scene(tree).stages[name].kind == "pair"
    tree["stages"][name]["input"]["teeth"] = "x"
    assert f"stages.{name}.input.teeth: must be a whole number" in message(tree)


def test_rotors_named_value_and_source_are_rotors():
    rotors = {"value": {"inertia": "1 kg*m^2"}, "source": {"inertia": "1 kg*m^2"}}
    assert set(make_scene({"title": "x", "rotors": rotors}).rotors) == {"value", "source"}


def test_control_characters_do_not_reach_the_terminal():
    text = message(edited("lsp", {"stages.lsp.\x1b[31mred\x07": 1, "title": "x"}))
    assert "\x1b" not in text
    assert "\\x1b[31mred\\x07: unknown key" in text


@pytest.mark.parametrize(
    "bad", ["\n", "\t", "\r", "\x1b[31m", "\x07", "\x7f", "\x9b31m", "\u202e", "\u2066", "\u2028", "\0"]
)
def test_texts_of_a_scene_are_lines_that_no_terminal_obeys(bad):
    changes = {
        "title": f"gear{bad}box",
        "stages.lsp.module": {"value": "16 mm", "source": f"printed: Table{bad} 2"},
        f"rotors.a{bad}": {"inertia": "1 kg*m^2"},
        "loads.ring.member": f"lsp.ring{bad}",
        "effects.gravity": f"on{bad}",
    }
    text = message(edited("lsp", changes))
    assert all(c.isprintable() for c in text.replace("\n", ""))
    told = [line.strip() for line in text.splitlines()[1:]]
    for key in ("title", "stages.lsp.module.source"):
        (line,) = [line for line in told if line.startswith(f"{key}: ")]
        assert line.endswith("which is no character of a line of text; leave it out")
    for key in ("rotors.a", "loads.ring.member: there is no member", "effects.gravity: "):
        assert any(line.startswith(key) for line in told)
    kept = load_scene("lsp").model_dump_json().replace("Table 2", "Table\\u001b 2")
    with pytest.raises(SceneError, match=r"stages\.lsp\.module\.source: holds"):
        restore_scene(kept)


def test_titles_of_any_script_are_lines():
    for title in ("Getriebe für Überlast, 2 µm", "कर\u200dम", "変速機 🚜"):
        assert make_scene(edited("lsp", {"title": title})).title == title


def places(node):
    """Yield container and key of everything in a raw scene."""
    for key, value in node.items() if isinstance(node, dict) else ():
        yield node, key
        yield from places(value)


SPOILS = [
    None, True, 0, -1, 10**40, 1e300, float("nan"), "", "x", "0 mm", "-1 kg", "1e-9 m", "1e9 N/m", "5 rpm", [], [1], {},
    {"value": 1}, "fixed", "rigid", "floating", "pair", "lsp.ring", {"inertia": "1 kg*m^2"}, "\ud800", "☃" * 99,
]  # fmt: skip


@pytest.mark.parametrize("seed", range(40))
def test_a_scene_spoilt_at_random_is_refused_or_makes_a_model(seed):
    chance = random.Random(seed)
    for _ in range(10):
        tree = raw_scene(chance.choice(["rig-2mw", "lsp", "psh", "lin-parker-4"]))
        for _ in range(chance.choice([1, 1, 2])):
            where, key = chance.choice(list(places(tree)))
            if chance.random() < 0.2:
                del where[key]
            else:
                where[chance.choice([key, key, "support", "drag", "teeth"])] = chance.choice(SPOILS)
        told = ""
        try:
            scene = make_scene(tree)
        except SceneError as error:
            told = str(error)
        if told:
            assert re.match(r"scene: \d+ defects?\n  ", told)
            assert told.encode()
        else:
            assert all(math.isfinite(value) for value in build_model(scene).values().values())
