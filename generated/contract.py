"""Contract of the generated C: functions, order of arguments, shapes, names.

Every generated model has these functions, with x the states, s the mesh levels and after them the load
signals, p the parameters. Signals are values of the scene's tables over time, which change linearly
between the rows; the tables themselves are numbers of the scene and no part of the C.

Laws with regimes (teeth that part, races that are reached) have a border each, where an indicator g passes
through zero. With its hold, a parameter, at 0 the state decides on which side they are; a hold of ``HELD`` or
``-HELD`` keeps the side of positive or negative g whatever the state, so that what is integrated has no kink.

``motion`` is all that one stage of an integration needs, common parts joined across its results; its forces are
the reports of quantity ``mesh_force``, in their order.

============  ===========  ==========================================================
function      arguments    results
============  ===========  ==========================================================
``rhs``       x, s, p      xdot
``jac_rhs``   x, s, p, -   d xdot / d x (sparse), as CasADi expects it of ``rhs``
``outputs``   x, s, p      y
``phases``    x, s, p      tau, tau_rate, share
``borders``   x, s, p      g, one a hold
``energy``    x, s, p      kinetic, strain, weight [J], power put in, power lost [W]
``motion``    x, s, p      xdot; power put in less power lost [W]; mesh forces [N]
============  ===========  ==========================================================
"""

import json
import math
import sys
from dataclasses import asdict, dataclass, field
from typing import Any

FORMAT = 6
HELD = 1e30
"""A force [N] or length [m] beyond all others, with which a regime is held."""
MOST_SAMPLES = 1e8
"""The most that a result may hold for each of its quantities, however many a scene or a run asks for."""
BACK = ".back"
"""What a mesh's name gets for the flank that is not loaded."""
PULL = "contact.pull"
"""The parameter by which one-sided teeth may pull; 0 in every run."""
VARYING = "phase.varying"
"""The parameter that lets stiffness and errors vary with the mesh phase; 1 in every run, 0 for their means."""
CLOSING = "bearing.closing"
"""The parameter that is the part of bearings' clearance that is taken away; 0 in every run."""
FUNCTIONS = ("rhs", "jac_rhs", "outputs", "phases", "borders", "energy", "motion")
PHYSICAL, GEOMETRY, COUNT, REGIME, HOMOTOPY, CONSTANT = ROLES = (
    "physical", "geometry", "count", "regime", "homotopy", "constant",
)  # fmt: skip
"""Roles of parameters: a size of the gearbox or its loads; a radius, place, angle or phase; what follows from whole
numbers of teeth and from sides; what holds a regime; what leads a solver to the equilibrium; no number of a gearbox."""
CONTINUOUS = (PHYSICAL, GEOMETRY)
"""Roles of what can change by a little, so that it has a derivative that means something."""
LARGEST = sys.float_info.max
ANY, POSITIVE, NOT_NEGATIVE, SHARE, DAMPER = ("any", "positive", "not negative", "share", "damper")
BOUNDS = {
    ANY: (-LARGEST, LARGEST),
    POSITIVE: (sys.float_info.min, LARGEST),
    NOT_NEGATIVE: (0.0, LARGEST),
    SHARE: (sys.float_info.min, math.nextafter(1.0, 0.0)),
    DAMPER: (0.0, LARGEST),
}
"""Kind of bounds -> what a parameter may be at least and at most, both included. A damper may be negative in Python: it
then drives, as in a study of what grows."""


@dataclass(frozen=True)
class State:
    """One state.

    Attributes
    ----------
    name, unit
        Its name, and its SI unit.
    body, axis
        Whose motion it is, and along what: ``x``, ``y``, ``u`` (a deviation of angle) or ``theta`` (a whole angle).
    inertia
        The parameter that is its inertia, ``""`` where it has none.
    kind
        ``reference angle``, ``deviation``, ``reference speed`` or ``rate`` (of the deviation of that body and axis).
    """

    name: str
    unit: str
    body: str
    axis: str
    inertia: str
    kind: str

    @property
    def turns(self) -> bool:
        """Tell a rotation from a translation."""
        return self.axis in ("u", "theta")

    @property
    def is_reference(self) -> bool:
        """Tell the motion of the reference from a deviation or its rate."""
        return self.kind in ("reference angle", "reference speed")


@dataclass(frozen=True)
class Report:
    """One output: quantity, the item it belongs to, SI unit, the dimension its kind of item shares, ``x`` or ``y``."""

    quantity: str
    item: str
    unit: str
    dimension: str
    axis: str = ""


@dataclass(frozen=True)
class Signal:
    """One load signal.

    Attributes
    ----------
    name, unit
        Its name, and its SI unit.
    table, slope
        The table it is read from, and whether it is that table's slope in time.
    quantity
        What it is of its load: ``loads.NAME.torque`` or ``.speed``, as a scene gives it where it is constant, or
        ``loads.NAME.acceleration``.
    """

    name: str
    unit: str
    table: str
    slope: bool
    quantity: str


@dataclass(frozen=True)
class Clock:
    """What follows the reference angle phi without end: start + advance phi / 2 pi, a mesh phase or an angle.

    In one turn of the reference it advances by ``teeth (ratio - frame)`` cycles, or turns of an angle. Whole turns
    of the reference may be taken off phi if ``start`` takes them up, whole periods left out.

    Attributes
    ----------
    start
        Parameter [cycles], or [rad] for an angle.
    teeth, ratio, frame
        Parameters; ``""`` stands for 1, 0 and 0.
    periods
        Parameters whose values are periods [cycles] of something that follows the clock; it has the period 1 too.
    mesh
        The mesh whose phase it is, ``""`` for an angle.
    """

    start: str
    teeth: str
    ratio: str
    frame: str
    periods: tuple[str, ...] = ()
    mesh: str = ""


@dataclass(frozen=True)
class RigidBody:
    """One member of the train; what it is known by are names of parameters, ``""`` where the model needs none.

    Attributes
    ----------
    name
        Its name.
    stage, part
        The stage, ``""`` of a rotor, and what it is there: ``sun``, ``planet``, ``ring``, ``carrier``, ``input`` or
        ``output``; or ``rotor``.
    frame
        The carrier with which the axes of its deviations turn, ``""`` where they stand still.
    place
        Its nominal place in that frame, x and y; empty at the origin, and where nothing depends on it.
    ratio
        Its speed over the reference speed; ``""`` where it stands still.
    mass, inertia
        Both count what is rigidly joined to it.
    base_radius, teeth
        Of a gear. Of the teeth only those of gear 1 of a mesh are a parameter, negative where its phase counts so.
    """

    name: str
    stage: str
    part: str
    frame: str
    place: tuple[str, ...]
    ratio: str
    mass: str
    inertia: str
    base_radius: str = ""
    teeth: str = ""


@dataclass(frozen=True)
class Connection:
    """One element that joins bodies to each other or to the housing, or loads one.

    Attributes
    ----------
    name, group
        Its name, and the one that it shares with its equals: ``lsp.pin`` of ``lsp.pin.2``.
    kind
        ``mesh``, ``pin``, ``bearing``, ``coupling``, ``support`` (torsional) or ``load``.
    item
        The item of its outputs.
    bodies
        What it joins; one body alone is joined to the housing, or loaded.
    stiffness, damping
        Parameters: one stiffness, or two between which a mesh level chooses, or none where it is none of these; and
        the damper, ``""`` without one.
    hold
        The parameter that holds its contact, ``""`` where it has but one regime.
    sense
        Of a mesh: 1 external, -1 internal; 0 of what is no mesh.
    back
        Whether it is the flank of a mesh that is not loaded.
    flank, radii, teeth, profile
        Parameters of a mesh: which side is loaded, base radii of gear 1 and 2, teeth of gear 1 (``""``: not known), and
        those of its stiffness over the phase, where it has no other.
    law
        Of a load: its torque, a parameter or a signal; or synchronous speed, breakdown slip speed and breakdown torque.
    """

    name: str
    group: str
    kind: str
    item: str
    bodies: tuple[str, ...]
    stiffness: tuple[str, ...] = ()
    damping: str = ""
    hold: str = ""
    sense: int = 0
    back: bool = False
    flank: str = ""
    radii: tuple[str, ...] = ()
    teeth: str = ""
    profile: tuple[str, ...] = ()
    law: tuple[str, ...] = ()


@dataclass(frozen=True)
class Signature:
    """Shapes of a function's arguments and results, non-zeros of the first result, operations."""

    arguments: tuple[tuple[str, int, int], ...]
    results: tuple[tuple[str, int, int], ...]
    nonzeros: int
    operations: int


@dataclass(frozen=True)
class Manifest:
    """All that a user of the C must know; it holds structure only, no scene's numbers.

    Attributes
    ----------
    key
        Content key of the C text and the graphs.
    states, levels, parameters, reports
        Names in the order of x, s, p and y; parameters as (name, unit).
    reference
        ``rest``, ``speed`` (reference speed is a parameter or a signal) or ``torque`` (it is a state).
    functions
        Signatures by name.
    casadi
        Version that emitted the C.
    signals
        Load signals, which follow the levels in s.
    holds
        Parameters that hold a regime, in the order of g.
    clocks
        What follows the reference angle without end.
    bodies, connections
        The train.
    roles, bounds
        Of the parameters, by name: one of ``ROLES``, and one of the kinds of ``BOUNDS``.
    """

    key: str
    reference: str
    states: tuple[State, ...]
    levels: tuple[str, ...]
    parameters: tuple[tuple[str, str], ...]
    reports: tuple[Report, ...]
    functions: dict[str, Signature]
    casadi: str
    signals: tuple[Signal, ...] = ()
    holds: tuple[str, ...] = ()
    clocks: tuple[Clock, ...] = ()
    bodies: tuple[RigidBody, ...] = ()
    connections: tuple[Connection, ...] = ()
    roles: dict[str, str] = field(default_factory=dict)
    bounds: dict[str, str] = field(default_factory=dict)
    format: int = FORMAT

    def to_json(self) -> str:
        """Return the manifest as JSON text, one line per entry."""
        plain = asdict(self)
        lines = []
        for key, value in plain.items():
            if isinstance(value, (list, tuple)):
                inner = ",\n".join("    " + json.dumps(item) for item in value)
                lines.append(f'  "{key}": [\n{inner}\n  ]' if value else f'  "{key}": []')
            elif isinstance(value, dict):
                inner = ",\n".join(f'    "{name}": {json.dumps(item)}' for name, item in value.items())
                lines.append(f'  "{key}": {{\n{inner}\n  }}')
            else:
                lines.append(f'  "{key}": {json.dumps(value)}')
        return "{\n" + ",\n".join(lines) + "\n}\n"

    @classmethod
    def from_json(cls, text: str) -> "Manifest":
        """Read a manifest; ValueError or KeyError if it is not one of this format."""
        raw: Any = json.loads(text)
        if not isinstance(raw, dict) or raw.get("format") != FORMAT:
            raise ValueError(f"not a manifest of format {FORMAT}")
        functions = {
            name: Signature(
                tuple((a[0], a[1], a[2]) for a in item["arguments"]),
                tuple((r[0], r[1], r[2]) for r in item["results"]),
                item["nonzeros"],
                item["operations"],
            )
            for name, item in raw["functions"].items()
        }
        return cls(
            raw["key"], raw["reference"], tuple(State(**item) for item in raw["states"]), tuple(raw["levels"]),
            tuple((name, unit) for name, unit in raw["parameters"]), tuple(Report(**item) for item in raw["reports"]),
            functions, raw["casadi"], tuple(Signal(**item) for item in raw["signals"]),
            tuple(raw["holds"]),
            tuple(Clock(**_tuples(item)) for item in raw["clocks"]),
            tuple(RigidBody(**_tuples(item)) for item in raw["bodies"]),
            tuple(Connection(**_tuples(item)) for item in raw["connections"]),
            raw["roles"], raw["bounds"],
        )  # fmt: skip


def _tuples(item: dict[str, Any]) -> dict[str, Any]:
    """Return an entry with tuples where JSON has lists."""
    return {key: tuple(value) if isinstance(value, list) else value for key, value in item.items()}


@dataclass(frozen=True)
class Artifact:
    """A generated model: C text, manifest, and the same functions serialised for CasADi's virtual machine."""

    c: str
    manifest: Manifest
    graphs: str
