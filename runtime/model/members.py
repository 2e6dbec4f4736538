"""Members and meshes of a train by name: stage, part, group, and what holds a member."""

from collections.abc import Iterable
from dataclasses import dataclass, field

from ltcgear.generated.contract import Connection, Manifest

PLANET, CARRIER = "planet", "carrier"


@dataclass(frozen=True)
class TrainMember:
    """One member.

    Attributes
    ----------
    stage, part
        As a body's in the manifest.
    mass
        The parameter that is its mass, ``""`` where it does not move sideways.
    place
        Parameters of its nominal place on the carrier, x and y; empty at the origin.
    held
        The group of its bearing or pin, with which the names of their parameters begin; ``""`` without one.
    """

    stage: str
    part: str
    mass: str = ""
    place: tuple[str, ...] = ()
    held: str = ""


@dataclass(frozen=True)
class Joint:
    """One mesh, flank of a mesh, or pin: its stage, the group of its equals, and the mesh that a flank belongs to."""

    stage: str
    group: str
    front: str


@dataclass(frozen=True)
class Train:
    """All members, and all meshes and pins.

    Other names, such as a coupling's, are their own stage and group.
    """

    members: dict[str, TrainMember] = field(default_factory=dict)
    joints: dict[str, Joint] = field(default_factory=dict)

    def stage(self, name: str) -> str:
        """Return the stage of a member, mesh, pin or group of these."""
        found: TrainMember | Joint | None = self.members.get(name) or self.joints.get(name)
        found = found or next((joint for joint in self.joints.values() if joint.group == name), None)
        return found.stage or name if found else name

    def group(self, name: str) -> str:
        """Return the group of a mesh, pin or planet; the flank of a mesh that is not loaded is a group of its own."""
        if name in self.joints:
            return self.joints[name].group
        return f"{self.members[name].stage}.{PLANET}" if self.is_planet(name) else name

    def front(self, mesh: str) -> str:
        """Return the mesh that a flank belongs to."""
        return self.joints[mesh].front if mesh in self.joints else mesh

    def label(self, member: str) -> str:
        """Return what a member is called; the planets of a stage share a label."""
        return f"{self.members[member].stage} planets" if self.is_planet(member) else member

    def is_geared(self, name: str) -> bool:
        """Return whether it is a member of a stage, not a rotor."""
        return name in self.members and bool(self.members[name].stage)

    def is_planet(self, name: str) -> bool:
        """Return whether it is a planet."""
        return name in self.members and self.members[name].part == PLANET

    def part(self, stage: str, part: str) -> str:
        """Return the first member of a stage that is such a part, ``""`` without one."""
        return next((name for name, one in self.members.items() if (one.stage, one.part) == (stage, part)), "")


def train_of(manifest: Manifest) -> Train:
    """Return the train of a model."""
    stages = {body.name: body.stage for body in manifest.bodies}
    held = {item.bodies[-1]: item.group for item in manifest.connections if item.kind in ("bearing", "pin")}
    meshes = [item for item in manifest.connections if item.kind == "mesh"]
    loaded = {(mesh.group, mesh.bodies): mesh.item for mesh in meshes if not mesh.back}

    def joint(item: Connection) -> Joint:
        group = item.item if item.back else item.group
        return Joint(stages[item.bodies[0]], group, loaded.get((item.group, item.bodies), item.item))

    return Train(
        {b.name: TrainMember(b.stage, b.part, b.mass, b.place, held.get(b.name, "")) for b in manifest.bodies},
        {item.item: joint(item) for item in manifest.connections if item.kind in ("mesh", "pin")},
    )


def unite_trains(trains: Iterable[Train]) -> Train:
    """Return all that occurs in the variants of a train."""
    united = Train()
    for train in trains:
        united.members.update(train.members)
        united.joints.update(train.joints)
    return united
