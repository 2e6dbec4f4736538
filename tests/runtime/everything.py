"""One small scene with data for every effect of the table, and few variants that hold every pair of values.

Whoever adds an effect adds to ``RAW`` the keys that it needs, to ``DATA`` those keys (so that it can be seen
that they leave no trace while the effect is out), and to ``ZERO`` or ``NO_ZERO`` how its amplitude becomes
zero, or why it has none. tests/symbolic/schema/test_effects.py and tests/runtime/simulation/test_pairs_of_effects.py
then cover it as it stands in the table.
"""

from collections.abc import Iterator, Mapping
from copy import deepcopy
from functools import cache
from itertools import combinations, product
from typing import Any

from ltcgear.symbolic.assembly import build_model
from ltcgear.symbolic.describe.variants import same_model
from ltcgear.symbolic.scene.load import make_scene
from ltcgear.symbolic.schema.effects import BY_NAME, DEFAULTS, EFFECTS, contradictions
from ltcgear.symbolic.schema.scene_schema import Scene

from .models import change

RAW: dict[str, Any] = {
    "title": "Two planets with data for every effect",
    "stages": {
        "gear": {
            "kind": "planetary",
            "planets": 2,
            "module": "3 mm",
            "pressure_angle": "20 deg",
            "ring": {"teeth": 60, "support": "fixed"},
            "sun": {
                "teeth": 20,
                "support": "bearing",
                "bearing": {"stiffness": "1e8 N/m", "damping_ratio": 0.03, "clearance": "2 um"},
                "eccentricity": {"radius": "3 um", "angle": "30 deg"},
                "mass": "1.5 kg",
                "inertia": "0.001 kg*m^2",
            },
            "planet": {"teeth": 20, "mass": "1.2 kg", "inertia": "0.0008 kg*m^2"},
            "carrier": {
                "support": "bearing",
                "bearing": {"stiffness": "2e8 N/m", "damping_ratio": 0.03},
                "mass": "6 kg",
                "inertia": "0.03 kg*m^2",
            },
            "sun_planet": {
                "face_width": "20 mm",
                "harmonics": 3,
                "damping_ratio": 0.05,
                "transmission_error": {"amplitudes": ["1 um", "0.5 um"], "phases": ["0 deg", "40 deg"]},
                "tooth_errors": [{"gear": "sun", "tooth": 1, "error": "1 um"}],
                "backlash": "0.05 mm",
                "friction": {"coefficient": 0.06, "speed": "0.02 m/s", "damping": "20 N*s/m"},
            },
            "ring_planet": {
                "stiffness": "4e8 N/m",
                "double_factor": 1.3,
                "contact_ratio": 1.8,
                "transition": 0.2,
                "stiffness_table": [["0", "4e8 N/m"], ["0.4", "5e8 N/m"], ["1", "4e8 N/m"]],
                "damping_ratio": 0.05,
                "backlash": "0.05 mm",
                "friction": {"coefficient": 0.06, "speed": "0.02 m/s", "damping": "20 N*s/m"},
            },
            "pin": {
                "stiffness": "2e8 N/m",
                "damping_ratio": 0.03,
                "diameter": "20 mm",
                "friction": 0.01,
                "friction_damping": "0.002 N*m*s/rad",
                "friction_speed": "2 rad/s",
                "clearance": "3 um",
            },
            "position_errors": [{"planet": 2, "radial": "2 um", "tangential": "3 um"}],
            "eccentricities": [{"planet": 1, "radius": "2 um"}],
        }
    },
    "rayleigh": {"mass": "20 1/s", "stiffness": "2e-6 s"},
    "rotors": {"motor": {"inertia": "0.01 kg*m^2"}},
    "couplings": {"shaft": {"between": ["motor", "gear.sun"], "stiffness": "2e4 N*m/rad", "damping_ratio": 0.02}},
    "loads": {
        "motor": {"member": "motor", "speed": "1500 rpm"},
        "carrier": {"member": "gear.carrier", "torque": "-600 N*m"},
    },
}
"""A scene with data for every effect; errors are so small that every planet stays loaded, as most scenes' do."""

BARE: dict[str, Any] = {"title": "A rotor that lacks what effects need", "rotors": {"lone": {"inertia": "1 kg*m^2"}}}

MESHES = ("stages.gear.sun_planet", "stages.gear.ring_planet")
DATA: dict[str, tuple[str, ...]] = {
    "mesh_stiffness": (f"-{MESHES[0]}.harmonics", f"-{MESHES[1]}.transition", f"-{MESHES[1]}.stiffness_table"),
    "eccentricity": ("-stages.gear.sun.eccentricity", "-stages.gear.eccentricities"),
    "transmission_error": (f"-{MESHES[0]}.transmission_error",),
    "tooth_errors": (f"-{MESHES[0]}.tooth_errors",),
    "mesh_friction": tuple(f"-{mesh}.friction" for mesh in MESHES),
    "bearing_friction": tuple(
        f"-stages.gear.pin.{key}" for key in ("friction", "friction_damping", "friction_speed", "diameter")
    ),
    "bearing_clearance": ("-stages.gear.sun.bearing.clearance", "-stages.gear.pin.clearance"),
    "planet_position_error": ("-stages.gear.position_errors",),
    "contact": tuple(f"-{mesh}.backlash" for mesh in MESHES),
    "mesh_damping": tuple(f"-{mesh}.damping_ratio" for mesh in MESHES),
    "damping": (
        "-rayleigh",
        "-stages.gear.sun.bearing.damping_ratio",
        "-stages.gear.carrier.bearing.damping_ratio",
        "-stages.gear.pin.damping_ratio",
        "-couplings.shaft.damping_ratio",
    ),
    "gravity": ("gravity = ['0 m/s^2', '0 m/s^2']",),
}
"""Effect -> the settings that take the data away that only this effect uses."""

TINY = "1e-30"
"""Where a number must be greater than zero: small enough that no digit of the result shows it."""

CONSTANT = (
    f"-{MESHES[0]}.face_width",
    f"{MESHES[0]}.stiffness = '3e8 N/m'",
    *(f"{mesh}.double_factor = 1" for mesh in MESHES),
)
"""A stiffness that is double where it is single."""

ZERO: dict[tuple[str, str], tuple[str, ...]] = {
    ("mesh_stiffness", "two-level"): CONSTANT,
    ("mesh_stiffness", "smooth"): CONSTANT,
    ("mesh_stiffness", "fourier"): CONSTANT,
    ("mesh_stiffness", "table"): (*CONSTANT, f"{MESHES[1]}.stiffness_table = [['0', '4e8 N/m'], ['1', '4e8 N/m']]"),
    ("stiffness_torque", "on"): CONSTANT,
    ("eccentricity", "on"): (
        "stages.gear.sun.eccentricity.radius = '0 m'",
        "stages.gear.eccentricities = [{ planet = 1, radius = '0 m' }]",
    ),
    ("transmission_error", "on"): (f"{MESHES[0]}.transmission_error.amplitudes = ['0 m', '0 m']",),
    ("tooth_errors", "on"): (f"{MESHES[0]}.tooth_errors = [{{ gear = 'sun', tooth = 1, error = '0 m' }}]",),
    ("mesh_damping", "on"): tuple(
        setting for mesh in MESHES for setting in (f"-{mesh}.damping_ratio", f"{mesh}.damping = '{TINY} N*s/m'")
    ),
    ("mesh_friction", "pitch-point"): tuple(
        setting
        for mesh in MESHES
        for setting in (f"{mesh}.friction.coefficient = 0", f"{mesh}.friction.damping = '{TINY} N*s/m'")
    ),
    ("damping", "on"): (
        *DATA["damping"],
        f"stages.gear.sun.bearing.damping = '{TINY} N*s/m'",
        f"stages.gear.carrier.bearing.damping = '{TINY} N*s/m'",
        f"stages.gear.pin.damping = '{TINY} N*s/m'",
        f"couplings.shaft.damping = '{TINY} N*m*s/rad'",
    ),
    ("mesh_friction", "sliding"): tuple(f"{mesh}.friction.coefficient = 0" for mesh in MESHES),
    ("damping", "rayleigh"): (  # it takes the place of the meshes' dampers too
        f"rayleigh = {{ mass = '{TINY} 1/s', stiffness = '{TINY} s' }}",
        *(f"-{mesh}.damping_ratio" for mesh in MESHES),
    ),
    ("bearing_clearance", "on"): (
        "stages.gear.sun.bearing.clearance = '0 m'",
        "stages.gear.pin.clearance = '0 m'",
    ),
    ("bearing_friction", "on"): (
        "stages.gear.pin.friction = 0",
        f"stages.gear.pin.friction_damping = '{TINY} N*m*s/rad'",
    ),
    ("planet_position_error", "on"): ("stages.gear.position_errors = [{ planet = 1 }]",),
    ("gravity", "on"): ("gravity = ['0 m/s^2', '0 m/s^2']",),
}
"""Effect and value -> the settings that make its amplitude zero: it must then do nothing at all."""

NO_ZERO: dict[tuple[str, str], str] = {
    ("lateral", "on"): "it is a freedom, which no number takes away",
    ("pins", "flexible"): "it is a freedom, rigid is the limit of ever greater stiffness",
    ("torsional_shafts", "flexible"): "it is a freedom, rigid is the limit of ever greater stiffness",
    ("mesh_stiffness", "computed"): "the curve follows from the teeth, and teeth in turn are never of one stiffness",
    ("mesh_law", "paper"): "it is another law of the deflection, which no number turns into the involute's",
    ("contact", "one-flank"): "teeth part or do not, no number makes them stick",
    ("contact", "backlash"): "with a gap of zero both flanks push, and one of them still cannot pull",
}
"""Effect and value -> why nothing makes its amplitude zero."""


DISSIPATIVE = ("-rayleigh.mass",)
"""What is taken away before losses are judged: mass-proportional damping slows deviations from the rigid motion,
and its power in a train that turns has either sign."""


def everything(effects: Mapping[str, str], *settings: str) -> Scene:
    """Return the scene with data for every effect, with these effects and settings."""
    raw = deepcopy(RAW)
    raw["effects"] = dict(effects)
    for setting in settings:
        change(raw, setting)
    return make_scene(raw)


def without(effect: str) -> str:
    """Return the value that leaves an effect out."""
    return BY_NAME[effect].without


def beside(effect: str, value: str, wanted: Mapping[str, str]) -> dict[str, str]:
    """Return an effect at a value among others at the values wanted, or at their first that can stand beside it."""
    chosen = {effect: value}
    for other in EFFECTS:
        if other.name != effect:
            values = (wanted[other.name], *other.values)
            chosen[other.name] = next(v for v in values if allowed(*chosen.items(), (other.name, v)))
    return {name: chosen[name] for name in DEFAULTS}


@cache
def acting(effect: str, value: str) -> dict[str, str]:
    """Return effects among which this one acts, and can be left out: defaults where that does, else a variant."""
    for chosen in (beside(effect, value, DEFAULTS), *covering()):
        off = chosen | {effect: without(effect)}
        fits = chosen[effect] == value and allowed(*off.items())
        if fits and not same_model(build_model(everything(chosen)), build_model(everything(off))):
            return chosen
    raise AssertionError(f"{effect} = {value!r} acts in no variant; has the scene data for it?")


def allowed(*pairs: tuple[str, str]) -> bool:
    """Tell whether values of effects can stand together, as far as these go."""
    neutral = {effect.name: "" for effect in EFFECTS}
    return not any(contradictions(neutral | dict(pairs)))


def all_pairs() -> set[frozenset[tuple[str, str]]]:
    """Return every pair of values of two effects that the table allows."""
    named = [[(effect.name, value) for value in effect.values] for effect in EFFECTS]
    return {frozenset(pair) for one, two in combinations(named, 2) for pair in product(one, two) if allowed(*pair)}


@cache
def covering() -> tuple[dict[str, str], ...]:
    """Return few variants, all effects each, that hold every allowed pair: greedily, the most new pairs first."""
    missing, variants = all_pairs(), []
    while missing:
        seed = min(missing, key=sorted)
        variant = _extended(dict(seed), missing)
        if variant is None:
            raise AssertionError(f"{sorted(seed)}: no variant can hold this pair, though the table allows it")
        missing -= {frozenset(pair) for pair in combinations(variant.items(), 2)}
        variants.append({name: variant[name] for name in DEFAULTS})
    return tuple(variants)


def _extended(variant: dict[str, str], missing: set[frozenset[tuple[str, str]]]) -> dict[str, str] | None:
    """Choose the values of the other effects, those first that bring most missing pairs; None where none fit."""
    free = [effect for effect in EFFECTS if effect.name not in variant]
    if not free:
        return variant
    effect = free[0]

    def gain(value: str) -> int:
        return sum(frozenset(((effect.name, value), pair)) in missing for pair in variant.items())

    for value in sorted(effect.values, key=gain, reverse=True):
        if allowed(*variant.items(), (effect.name, value)):
            found = _extended(variant | {effect.name: value}, missing)
            if found is not None:
                return found
    return None


def labelled(variant: Mapping[str, str]) -> str:
    """Name a variant by what is not at its default."""
    return " ".join(f"{name}={value}" for name, value in variant.items() if value != DEFAULTS[name]) or "defaults"


def values_on() -> Iterator[tuple[str, str]]:
    """Yield every effect with every value that does not leave it out."""
    for effect in EFFECTS:
        yield from ((effect.name, value) for value in effect.values if value != effect.without)
