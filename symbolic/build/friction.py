"""Friction of meshes: at the pitch point, or at the contacts of the teeth."""

from .. import gears
from ..model import BACK, PHASE
from ..schema import Friction, Gear, Mesh, Pair, Planetary
from .draft import Draft

NOT_OF_FRICTION = ("c", "pull")


def add_friction(
    draft: Draft, name: str, label: str, stage: Planetary | Pair, mesh: Mesh, wheels: tuple[Gear, Gear], sigma: int
) -> None:
    """Add the friction of a mesh, on each of its flanks, where the scene calls for it."""
    chosen = draft.scene.effects["mesh_friction"]
    if chosen == "off" or mesh.friction is None:
        return
    bind = _numbers(draft, name, mesh.friction)
    if chosen == "sliding":
        bind |= _contacts(draft, name, stage, mesh, wheels, sigma)
    else:
        bind["c_t"] = draft.number(f"{name}.friction.damping", mesh.friction.damping or 0.0, "N*s/m")
    flanks = [i for i in draft.instances if i.group == "mesh" and i.name in (label, label + BACK)]
    for flank in flanks:
        _, kind, law, switched, _, *contact = flank.element
        shared = {key: value for key, value in flank.bind.items() if key not in NOT_OF_FRICTION}
        group = "mesh_sliding" if chosen == "sliding" else "mesh_friction"
        draft.place(flank.name, (group, kind, law, switched, *contact), flank.bodies, **shared, **bind)


def _numbers(draft: Draft, name: str, friction: Friction) -> dict[str, str]:
    """Bind what both laws need."""
    return {
        "mu": draft.number(f"{name}.friction.coefficient", friction.coefficient, ""),
        "v_0": draft.number(f"{name}.friction.speed", friction.speed, "m/s"),
    }


def _contacts(
    draft: Draft, name: str, stage: Planetary | Pair, mesh: Mesh, wheels: tuple[Gear, Gear], sigma: int
) -> dict[str, str]:
    """Bind where the teeth touch: phase, share of single contact, middle of the path, teeth of gear 1."""
    lowest, highest = gears.path_of_contact(stage, *wheels, sigma)
    return {
        "tau": PHASE,
        "z_1": f"{name}.teeth_1",
        "xi_m": draft.number(f"{name}.path_middle", (lowest + highest) / 2, "m"),
        "varsigma": draft.number(f"{name}.single_share", gears.single_share(stage, mesh, *wheels, sigma), ""),
    }
