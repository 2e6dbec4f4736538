"""Table of effects: source of validation, warnings, costs, command line, docs and builder."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True)
class Exclusion:
    """Values of another effect that exclude one, and why."""

    effect: str
    values: tuple[str, ...]
    reason: str


@dataclass(frozen=True)
class Effect:
    """An effect that a scene can select.

    Attributes
    ----------
    name, values
        Key under ``[effects]`` and its allowed values.
    default
        Value if the scene gives none.
    without
        Value without the effect: none of its symbols, states or operations is generated.
    help
        What it does.
    source
        Equation number or citation.
    needs
        Value -> what a scene must have for it to act; without it there is a warning.
    excludes
        Value -> what it excludes; a scene with both is refused.
    """

    name: str
    values: tuple[str, ...]
    default: str
    without: str
    help: str
    source: str
    needs: Mapping[str, str] = field(default_factory=dict)
    excludes: Mapping[str, tuple[Exclusion, ...]] = field(default_factory=dict)


EFFECTS: tuple[Effect, ...] = (
    Effect(
        "mesh_law",
        ("involute", "paper"),
        "involute",
        "involute",
        "Mesh deflection: the involute's exact law, or the paper's first-order one.",
        "Wu et al. 2021 eqs 7, 23; exact law: gradient equal to the unit line of action",
        needs={"paper": "a stage"},
    ),
    Effect(
        "lateral",
        ("on", "off"),
        "on",
        "off",
        "Sideways motion of members and planets; off leaves a torsional model.",
        "x and y in Wu et al. 2021; torsional model: Kahraman 1994, J. Sound Vib. 173:125",
        excludes={
            "off": (
                Exclusion("mesh_law", ("paper",), "without sideways motion only the involute's law has a meaning"),
                Exclusion("bearing_friction", ("on",), "it acts with the pin's force, which is then not known"),
            )
        },
    ),
    Effect(
        "pins",
        ("flexible", "rigid"),
        "flexible",
        "rigid",
        "Planet bearings: a spring-damper each, or rigid, so that planets move with their carrier.",
        "flexible: Wu et al. 2021 eqs 29-30; rigid: a constraint, Newton-Euler equations of carrier and planets",
        needs={"rigid": "a planetary stage that moves sideways"},
        excludes={
            "rigid": (Exclusion("bearing_friction", ("on",), "it acts with the pin's force, a rigid one has none"),)
        },
    ),
    Effect(
        "torsional_shafts",
        ("flexible", "rigid"),
        "flexible",
        "rigid",
        "Couplings: torsional springs, or rigid, so that the members they join share one angle.",
        "flexible: Wu et al. 2021 Table 5; rigid: a constraint",
        needs={"rigid": "a coupling"},
    ),
    Effect(
        "mesh_stiffness",
        ("two-level", "mean", "smooth", "fourier", "table", "computed"),
        "two-level",
        "mean",
        "Mesh stiffness over the mesh phase: single and double contact with jumps between, their mean, the same "
        "with smooth transitions, a few harmonics of it or of a table, or the curve computed from the teeth.",
        "Wu et al. 2021 eqs 9-11; computed: potential-energy method, Yang and Lin 1987, J. Mech. Transm. Autom. Des. "
        "109:189",
        needs={
            "two-level": "a mesh with double_factor or face_width",
            "smooth": "a mesh with double_factor or face_width",
            "fourier": "a mesh with double_factor or face_width",
            "table": "a mesh with a stiffness_table",
            "computed": "a mesh with face_width and no double_factor",
        },
    ),
    Effect(
        "stiffness_torque",
        ("off", "on"),
        "off",
        "off",
        "Mesh stiffness by the gear's own angle, so that the work of its change is a torque on the gear; off, it "
        "varies with the nominal motion, from which it takes that work.",
        "Oh, Grosh and Barber 2005, J. Vib. Acoust. 127:208",
        needs={"on": "a mesh whose stiffness varies smoothly: smooth, fourier or table, with what these need"},
        excludes={
            "on": (
                Exclusion("mesh_stiffness", ("two-level", "computed"), "the torque of a jump would be an impulse"),
                Exclusion("mesh_law", ("paper",), "the paper's force is no gradient of an energy"),
            )
        },
    ),
    Effect(
        "contact",
        ("bilateral", "one-flank", "backlash"),
        "bilateral",
        "bilateral",
        "Tooth contact: the mesh may pull (the paper), pushes on one flank only, or on both with a gap between.",
        "Kahraman and Singh 1990, J. Sound Vib. 142:49, for the gap; gap from tooth thickness: DIN 3967",
        needs={"one-flank": "a stage", "backlash": "a stage"},
    ),
    Effect(
        "mesh_damping",
        ("on", "off"),
        "on",
        "off",
        "Viscous damper along the line of action.",
        "assumed form; damping ratio of the mesh on the gears' equivalent masses",
    ),
    Effect(
        "mesh_friction",
        ("off", "pitch-point", "sliding"),
        "off",
        "off",
        "Tangential mesh force: the paper's at the pitch point, made dissipative, or Coulomb's at the tooth contacts.",
        "Wu et al. 2021 eqs 14, 27; load sharing of the contacts: ISO/TR 15144-1",
        needs=dict.fromkeys(("pitch-point", "sliding"), "a mesh with a friction table; give one its coefficient"),
    ),
    Effect(
        "damping",
        ("on", "off", "rayleigh"),
        "on",
        "off",
        "Viscous dampers of bearings, couplings and supports: their own, or Rayleigh's, alpha M + beta K.",
        "assumed form; Rayleigh 1877, The Theory of Sound, vol. 1",
        needs={"rayleigh": "a rayleigh table; give it mass or stiffness"},
        excludes={
            "rayleigh": (
                Exclusion("contact", ("one-flank", "backlash"), "teeth that part have no constant damper"),
                Exclusion("bearing_clearance", ("on",), "a bearing with clearance has no constant damper"),
            )
        },
    ),
    Effect(
        "bearing_friction",
        ("off", "on"),
        "off",
        "off",
        "Friction torque of the planet bearings.",
        "Wu et al. 2021 eq 30, made dissipative",
        needs={"on": "a pin with friction or friction_damping; give one"},
    ),
    Effect(
        "bearing_clearance",
        ("off", "on"),
        "off",
        "off",
        "Radial clearance of bearings and planet bearings: no force before it is used up.",
        "Kahraman and Singh 1991, J. Sound Vib. 144:469",
        needs={"on": "a bearing or flexible pin with clearance, and sideways motion"},
    ),
    Effect(
        "planet_position_error",
        ("off", "on"),
        "off",
        "off",
        "Pins that are not at their nominal place, by position_errors of a planetary stage.",
        "geometry; load sharing under it: Kahraman 1994, Mech. Mach. Theory 29:1151",
        needs={"on": "position_errors of a planetary stage; give one"},
    ),
    Effect(
        "eccentricity",
        ("off", "on"),
        "off",
        "off",
        "Teeth whose centre lies beside the axis of their gear and turns about it.",
        "geometry; the tooth force acts at the teeth's centre and is handed on to the gear with its arm",
        needs={"on": "a gear with an eccentricity, or eccentricities of planets; give one"},
    ),
    Effect(
        "transmission_error",
        ("off", "on"),
        "off",
        "off",
        "Static transmission error by harmonics or a table, taken from the deflection along the line of action.",
        "Kahraman and Singh 1990, J. Sound Vib. 142:49",
        needs={"on": "a mesh with a transmission_error table; give one"},
    ),
    Effect(
        "tooth_errors",
        ("off", "on"),
        "off",
        "off",
        "Spacing errors of single teeth: full while the tooth carries alone, handed over in double contact.",
        "assumed form: load handed on smoothly over double contact",
        needs={"on": "a mesh with tooth_errors; give one"},
    ),
    Effect(
        "gravity",
        ("off", "on"),
        "off",
        "off",
        "Weight of every member that can move sideways, and of planets that sit unevenly on a carrier.",
        "G in Wu et al. 2021 eqs 31-38",
        needs={"on": "a member that can move sideways, or planets that sit unevenly on a carrier"},
    ),
)

DEFAULTS: dict[str, str] = {effect.name: effect.default for effect in EFFECTS}
BY_NAME: dict[str, Effect] = {effect.name: effect for effect in EFFECTS}


def contradictions(chosen: Mapping[str, str]) -> Iterator[str]:
    """Tell which of the chosen values (all effects, by name) exclude each other; one line per pair."""
    for effect in EFFECTS:
        value = chosen[effect.name]
        for exclusion in effect.excludes.get(value, ()):
            if chosen[exclusion.effect] in exclusion.values:
                beside = f"{exclusion.effect} = {chosen[exclusion.effect]!r}"
                cure = f"give {_other(effect, (value,))}, or {_other(BY_NAME[exclusion.effect], exclusion.values)}"
                yield f".{effect.name}: {value!r} and {beside} contradict each other: {exclusion.reason}; {cure}"


def _other(effect: Effect, excluded: tuple[str, ...]) -> str:
    """Write an effect with its remaining values."""
    return f"{effect.name} = " + " or ".join(f'"{value}"' for value in effect.values if value not in excluded)
