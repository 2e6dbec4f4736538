"""Second stage's value: the Model, what the scene's effects call for and nothing else.

A model is structure (bodies, element instances, levels) plus numbers (parameters). Structure is
baked into the C; numbers stay parameters. Nothing here needs SymPy, so a model whose C is already in
the store is ready without deriving anything.
"""

import json
from dataclasses import asdict, dataclass

LEVEL, TURN, BASIS, PHASE = "@level", "@turn", "@basis", "@phase"
BACK = ".back"
"""What a mesh's name gets for the flank that is not loaded."""


@dataclass(frozen=True)
class Parameter:
    """A number of the model: dotted name, SI value, SI unit."""

    name: str
    value: float
    unit: str


@dataclass(frozen=True)
class Body:
    """A rigid body in the plane.

    Attributes
    ----------
    name
        Dotted name, such as ``lsp.planet.2``.
    lateral
        Whether it can move sideways.
    turning
        ``free`` (own deviation from the rigid motion), ``held`` (angle zero), ``driven`` (held speed) or
        ``reference`` (its angle is the reference angle).
    mass, inertia
        Parameter names, None where nothing needs them.
    ratio
        Parameter name of its speed over the reference speed; None where it stands still.
    place
        Parameter names of its nominal position in the frame; None at the frame's origin.
    frame
        Name of the frame it is described in.
    """

    name: str
    lateral: bool
    turning: str
    mass: str | None
    inertia: str | None
    ratio: str | None
    place: tuple[str, str] | None
    frame: str


@dataclass(frozen=True)
class Instance:
    """An element at work: its type, the bodies at its ports, and where its parameters come from.

    ``bind`` maps the element's parameter names to parameter names of the model, or to ``@level`` (the
    mesh's stiffness level), ``@phase`` (its phase), ``@turn`` (how far the frame has turned) and ``@basis``.
    """

    name: str
    group: str
    element: tuple[str | bool, ...]
    bodies: tuple[str, ...]
    bind: dict[str, str]


@dataclass(frozen=True)
class Level:
    """A mesh whose stiffness is switched by its phase tau = rate * phi + start [cycles].

    Single contact while frac(tau) < share, double contact otherwise (eqs 9-11). ``rate`` is None at rest.
    """

    name: str
    rate: str | None
    start: str
    share: str


@dataclass(frozen=True)
class Phase:
    """The phase tau = rate * phi + start [cycles] of a mesh with an element that follows it; no rate at rest."""

    name: str
    rate: str | None
    start: str


@dataclass(frozen=True)
class Rolling:
    """How a mesh's phase follows from its first gear: teeth / 2 pi, and its motion against the frame."""

    mesh: str
    teeth: str
    gear: str
    start: str


@dataclass(frozen=True)
class Model:
    """A gearbox ready to be derived; see the module's head."""

    title: str
    name: str
    reference: str
    bodies: tuple[Body, ...]
    frames: dict[str, str | None]
    instances: tuple[Instance, ...]
    levels: tuple[Level, ...]
    phases: tuple[Phase, ...]
    rollings: tuple[Rolling, ...]
    parameters: tuple[Parameter, ...]
    effects: dict[str, str]
    statics: dict[str, float]

    def structure(self) -> str:
        """Return all that shapes the C, as canonical JSON: no title, no number."""
        shape = asdict(self)
        for key in ("title", "name", "effects", "statics"):
            del shape[key]
        shape["parameters"] = [(p.name, p.unit) for p in self.parameters]
        return json.dumps(shape, sort_keys=True, separators=(",", ":"))

    def values(self) -> dict[str, float]:
        """Return parameter name -> value in SI, in the order of the C."""
        return {p.name: p.value for p in self.parameters}
