"""The one table of effects: it feeds scene validation, the command line's help and the builder."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Effect:
    """One effect that a scene can call for.

    Attributes
    ----------
    name, values
        Key under ``[effects]`` and its allowed values.
    default
        Value of a scene that does not say.
    help
        What it does.
    source
        Equation number or citation.
    """

    name: str
    values: tuple[str, ...]
    default: str
    help: str
    source: str


EFFECTS: tuple[Effect, ...] = (
    Effect(
        "mesh_law",
        ("involute", "paper"),
        "involute",
        "Mesh deflection: the involute's exact law, or the paper's first-order one.",
        "Wu et al. 2021 eqs 7, 23; exact law: gradient equal to the unit line of action",
    ),
    Effect(
        "mesh_stiffness",
        ("two-level", "mean"),
        "two-level",
        "Mesh stiffness: single and double contact by mesh phase, or their mean over a tooth pitch.",
        "Wu et al. 2021 eqs 9-11",
    ),
    Effect(
        "contact",
        ("bilateral", "one-flank", "backlash"),
        "bilateral",
        "Tooth contact: the mesh may pull (the paper), pushes on one flank only, or on both with a gap between.",
        "Kahraman and Singh 1990, J. Sound Vib. 142:49, for the gap",
    ),
    Effect(
        "mesh_damping",
        ("on", "off"),
        "on",
        "Viscous damper along the line of action.",
        "assumed form; damping ratio of the mesh on the gears' equivalent masses",
    ),
    Effect(
        "mesh_friction",
        ("off", "pitch-point"),
        "off",
        "Tangential mesh force: the paper's Coulomb and viscous force, made dissipative.",
        "Wu et al. 2021 eqs 14, 27",
    ),
    Effect(
        "damping",
        ("on", "off"),
        "on",
        "Viscous dampers of bearings, torsional couplings and supports.",
        "assumed form",
    ),
    Effect(
        "bearing_friction",
        ("off", "on"),
        "off",
        "Friction torque of the planet bearings.",
        "Wu et al. 2021 eq 30, made dissipative",
    ),
    Effect(
        "planet_position_error",
        ("off", "on"),
        "off",
        "Pins that are not at their nominal place, by position_errors of a planetary stage.",
        "geometry; load sharing under it: Kahraman 1994, Mech. Mach. Theory 29:1151",
    ),
    Effect(
        "gravity",
        ("off", "on"),
        "off",
        "Weight of every member that can move sideways.",
        "G in Wu et al. 2021 eqs 31-38",
    ),
)

DEFAULTS: dict[str, str] = {effect.name: effect.default for effect in EFFECTS}
