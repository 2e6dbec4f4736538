"""Topology of the train: which members each connection joins, and how members go by one name."""

from dataclasses import dataclass

from ltcgear.generated.contract import Connection, Manifest

from .members import train_of

HOUSING = "housing"


@dataclass(frozen=True)
class Linkage:
    """Equal connections of a train as one.

    Attributes
    ----------
    ends
        The two things that they join, by their labels; the second may be the housing.
    kind
        As a connection's.
    stage
        Whose meshes or pins they are, ``""`` of what is neither.
    told
        What they are called in words.
    """

    ends: tuple[str, str]
    kind: str
    stage: str
    told: str


class Topology:
    """Topology of a train, from its manifest.

    Attributes
    ----------
    labels
        Body -> its name; the planets of a stage share one.
    groups
        Connection -> the group of its equals.
    links
        Group -> what it joins, in the order of the manifest.
    """

    def __init__(self, manifest: Manifest) -> None:
        train = train_of(manifest)
        self.labels = {name: train.label(name) for name in train.members}
        self._wholes = {label: train.stage(name) for name, label in self.labels.items()}
        angles = [state.body for state in manifest.states if state.kind == "deviation" and state.turns]
        self._rank = {body: k for k, body in enumerate(angles)}
        joining = [item for item in manifest.connections if item.kind != "load"]
        self.groups = {item.name: item.group for item in joining}
        self.links = {item.group: self._link(item) for item in joining}

    def whole(self, label: str) -> str:
        """Return the stage of what has a label, or the rotor's own name."""
        return self._wholes[label]

    def _link(self, connection: Connection) -> Linkage:
        """Describe the group of a connection; of a coupling, what has an angle of its own comes first."""
        bodies, kind = connection.bodies, connection.kind
        if kind == "coupling":
            bodies = tuple(sorted(bodies, key=lambda body: self._rank.get(body, len(self._rank))))
        ends = (*(self.labels[body] for body in bodies), HOUSING)[:2]
        stage = self.whole(ends[0]) if kind in ("mesh", "pin") else ""
        return Linkage((ends[0], ends[1]), kind, stage, connection.item if kind == "coupling" else connection.group)
