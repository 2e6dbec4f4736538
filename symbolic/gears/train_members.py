"""Members of a train: names, mass and inertia, places of planets, speeds in the rigid motion."""

from dataclasses import dataclass

import numpy as np

from ..schema.scene_schema import Member, Planetary, Rotor, Scene


@dataclass(frozen=True)
class RigidMotion:
    """The rigid motion: which load sets the reference speed, and every member's speed over it.

    ``mode`` is ``rest``, ``speed`` (the reference is held) or ``torque`` (it is a member's own motion). Where it
    is held over time, ``speed`` is that at the start, or for a start from zero that to which it runs up.
    """

    mode: str
    member: str
    speed: float
    ratios: dict[str, float]


def members(scene: Scene) -> dict[str, Member | Rotor]:
    """Return every member by dotted name; a stage's planets appear once, as ``stage.planet``."""
    found: dict[str, Member | Rotor] = dict(scene.rotors)
    for name, stage in scene.stages.items():
        parts = ("ring", "sun", "carrier", "planet") if isinstance(stage, Planetary) else ("input", "output")
        found |= {f"{name}.{part}": getattr(stage, part) for part in parts}
    return found


def is_fixed(member: Member | Rotor) -> bool:
    """Tell whether a member is clamped."""
    return isinstance(member, Member) and member.support == "fixed"


def inertia_of(member: Member | Rotor) -> tuple[float, float]:
    """Return mass [kg] and inertia [kg m^2]: given, or of the disc (m = rho pi (R^2 - r^2) w)."""
    if member.disc is None:
        return getattr(member, "mass", None) or 0.0, member.inertia or 0.0
    outer, inner = member.disc.outer_diameter / 2, member.disc.inner_diameter / 2
    mass = member.disc.density * np.pi * (outer**2 - inner**2) * member.disc.width
    return float(mass), float(mass * (outer**2 + inner**2) / 2)


def planet_angles(stage: Planetary) -> list[float]:
    """Return where the planets stand [rad]: given, or equally spaced."""
    return stage.planet_angles or [2 * np.pi * i / stage.planets for i in range(stage.planets)]
