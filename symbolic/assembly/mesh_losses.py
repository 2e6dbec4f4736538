"""Mesh friction: at the pitch point, or at the contacts of the teeth."""

from ltcgear.generated.contract import BACK, DAMPER, GEOMETRY, POSITIVE, SHARE

from ..elements.key import ElementKey
from ..gears import gear_geometry
from ..mechanics.model import PHASE
from .draft import Draft, MeshPlace

NOT_OF_FRICTION = ("c", "pull", "k_d", "z_1", "e_d")


def add_friction(draft: Draft, at: MeshPlace, bodies: tuple[str, ...], law: str, place: dict[str, str]) -> None:
    """Add the friction of a mesh, on each of its flanks.

    Parameters
    ----------
    draft, at
        The model and the mesh, whose own elements exist already.
    bodies, law, place
        Bodies that carry the teeth, the law of their deflection from positions, and its data.
    """
    friction = at.mesh.friction
    assert friction is not None
    bind = place | {
        "mu": draft.number(f"{at.name}.friction.coefficient", friction.coefficient, ""),
        "v_0": draft.number(f"{at.name}.friction.speed", friction.speed, "m/s", bounds=POSITIVE),
    }
    sliding = draft.scene.effects["mesh_friction"] == "sliding"
    if sliding:
        bind |= _contacts(draft, at)
    else:
        bind["c_t"] = draft.number(f"{at.name}.friction.damping", friction.damping or 0.0, "N*s/m", bounds=DAMPER)
    flanks = [i for i in draft.instances if i.group == "mesh" and i.name in (at.label, at.label + BACK)]
    for flank in flanks:
        shared = {key: value for key, value in flank.bind.items() if key not in NOT_OF_FRICTION}
        options = {key: flank.element[key] for key in ("kind", "switched", "contact", "error")}
        element = ElementKey.of("mesh_sliding" if sliding else "mesh_friction", law=law, **options)
        hold = {"hold": draft.hold(f"{flank.name}.friction", "N")}
        draft.place(flank.name, element, bodies, **shared | bind | hold)


def _contacts(draft: Draft, at: MeshPlace) -> dict[str, str]:
    """Bind the contact positions: phase, share of single contact, middle of the path, teeth of gear 1."""
    lowest, highest = gear_geometry.path_of_contact(at.stage, *at.wheels, at.sigma)
    return {
        "tau": PHASE,
        "z_1": f"{at.name}.teeth_1",
        "xi_m": draft.number(f"{at.name}.path_middle", (lowest + highest) / 2, "m", GEOMETRY),
        "varsigma": draft.number(f"{at.name}.single_share", gear_geometry.single_share(*at.geometry), "", bounds=SHARE),
    }
