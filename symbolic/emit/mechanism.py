"""Mechanism: bodies and connections of a model, as the manifest lists them; names of parameters, no numbers."""

from ltcgear.generated.contract import BACK, Connection, RigidBody

from ..elements.element_types import make
from ..elements.mesh import SIGN
from ..mechanics.model import Body, Instance, Model

SINGLE, DAMPER, LEVELS = ("k", "k_t"), ("c", "c_t"), ("k_1", "k_2")
"""Parameter names of a stiffness, a damper, and the two stiffnesses of a mesh level."""
LOADS = ("T", "omega_s", "omega_b", "T_b")
"""Parameter names of a load torque, and of a slip law."""


def list_bodies(model: Model) -> tuple[RigidBody, ...]:
    """List the members of the train, without points on them."""
    members = [body for body in model.bodies if body.turning != "point"]
    gears = _gears(list_connections(model))
    carriers = {body.ratio: body.name for body in members if body.part == "carrier"}
    return tuple(
        RigidBody(
            body.name, body.frame, body.part, carriers[ratio] if (ratio := model.frames[body.frame]) else "",
            body.place or (), body.ratio or "", body.mass or "", body.inertia or "", *gears.get(body.name, ("", "")),
        )
        for body in members
    )  # fmt: skip


def list_connections(model: Model) -> tuple[Connection, ...]:
    """List the connections of members, in the order of their outputs."""
    seats = {body.name: _seat(body) for body in model.bodies}
    teeth = {phase.name: phase.teeth for phase in model.phases}
    profiles = {profile.mesh: profile.numbers for profile in model.profiles if profile.quantity == "stiffness"}
    return tuple(_connection(item, seats, teeth, profiles) for item in model.instances if item.family)


def _seat(body: Body) -> str:
    """Return the member of a body or of a point on it."""
    return body.seat or body.name if body.turning == "point" else body.name


def _connection(
    instance: Instance, seats: dict[str, str], teeth: dict[str, str], profiles: dict[str, tuple[str, ...]]
) -> Connection:
    """Describe one connection."""
    kind, bind = make(instance.element).joins, instance.bind
    bodies = tuple(seats[name] for name in instance.bodies[:2])  # an orbiting mesh has its carrier as a third
    springs = [bind[key] for key in (*SINGLE, *LEVELS) if key in bind]
    damper = next((bind[key] for key in DAMPER if key in bind), "")
    stiffness = () if any(name.startswith("@") for name in springs) else tuple(springs)
    name = instance.name if kind in ("mesh", "pin") else instance.family
    shared = (name, instance.family, kind, instance.item, bodies, stiffness, damper, bind.get("hold", ""))
    if kind != "mesh":
        return Connection(*shared, law=tuple(bind[key] for key in LOADS if key in bind))
    front = instance.name.removesuffix(BACK)
    return Connection(
        *shared, SIGN[str(instance.element["kind"])], front != instance.name, bind["s"], (bind["r_1"], bind["r_2"]),
        teeth.get(front, ""), profiles.get(front, ()),
    )  # fmt: skip


def _gears(connections: tuple[Connection, ...]) -> dict[str, tuple[str, str]]:
    """Return base radius and teeth of the gears by body, of the first mesh of each."""
    found: dict[str, tuple[str, str]] = {}
    for mesh in connections:  # what is no mesh has no radii
        for body, radius, teeth in zip(mesh.bodies, mesh.radii, (mesh.teeth, ""), strict=False):
            found.setdefault(body, (radius, teeth))
    return found
