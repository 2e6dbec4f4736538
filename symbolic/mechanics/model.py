"""Model of a scene: bodies, element instances and parameters.

A model is structure (bodies, element instances, levels, load signals) plus numbers (parameters, tables over time).
Structure is fixed in the C; numbers stay parameters, and tables are read at run time. Nothing here needs SymPy, so a
model whose C is already in the store needs no derivation.
"""

import json
from dataclasses import dataclass, field

from ltcgear.generated.contract import ANY, PHYSICAL, Clock, Signal

from ..elements.axes import DEVIATIONS
from ..elements.key import ElementKey

LEVEL, TURN, BASIS, PHASE = "@level", "@turn", "@basis", "@phase"
UNSHAPED = ("title", "name", "effects", "statics", "tables")
"""Parts of a model that do not change its C."""
STIFFNESS, SLOPE, ERROR, ERROR_RATE = "@stiffness", "@slope", "@error", "@error_rate"
HOLD = "hold."
"""Prefix of the parameters that hold a regime during integration; 0 lets the state decide."""


@dataclass(frozen=True)
class Parameter:
    """A number of the model: dotted name, SI value, SI unit, and the contract's role and kind of bounds."""

    name: str
    value: float
    unit: str
    role: str = PHYSICAL
    bounds: str = ANY


@dataclass(frozen=True)
class Body:
    """A rigid body in the plane.

    Attributes
    ----------
    name
        Dotted name, such as ``lsp.planet.2``.
    freedoms
        Letters of the integrated deviations: x, y, u.
    turning
        ``free`` (own deviation from the rigid motion), ``held`` (angle zero), ``driven`` (held speed), ``reference``
        (its angle is the reference angle), ``led`` (it rotates with its leader) or ``point`` (the same, for a point of
        its leader that is not a member).
    mass, inertia
        Parameter names, None if not needed. Both include rigidly joined bodies.
    ratio
        Parameter name of its speed over the reference speed; None at rest.
    place
        Parameter names of its nominal position in the frame, or on its seat; None at the origin.
    frame
        Name of its frame.
    leader
        The body whose deviation of angle it shares.
    seat
        The body on which it is mounted, rotating about that body's centre with it.
    moment
        Parameter names of mass times offset of the bodies mounted on it [kg m], at angle zero; None if balanced.
    part
        Its role in the stage, ``""`` for a point of another body.
    """

    name: str
    freedoms: tuple[str, ...]
    turning: str
    mass: str | None
    inertia: str | None
    ratio: str | None
    place: tuple[str, str] | None
    frame: str
    leader: str | None = None
    seat: str | None = None
    moment: tuple[str, str] | None = None
    part: str = ""

    @property
    def lateral(self) -> bool:
        """Tell whether it has lateral degrees of freedom."""
        return any(not DEVIATIONS[letter].rotation for letter in self.freedoms)


@dataclass(frozen=True)
class Instance:
    """Element instance: its type, the bodies at its ports, and the sources of its parameters.

    ``bind`` maps the element's parameter names to parameter names of the model, or to ``@level`` (the mesh's stiffness
    level), ``@phase`` (its phase), ``@turn`` (rotation of the frame) and ``@basis``; or to the mesh's ``@stiffness`` at
    its phase and its ``@slope``, its ``@error`` and ``@error_rate``. ``family`` is the common name of equal connections
    of the train, ``""`` for an element that is not a connection.
    """

    name: str
    element: ElementKey
    bodies: tuple[str, ...]
    bind: dict[str, str]
    family: str = ""

    @property
    def group(self) -> str:
        """Return the name of its law."""
        return self.element.type

    @property
    def item(self) -> str:
        """Return the item of its outputs."""
        return self.name.removeprefix("loads.")


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
    """The phase tau = rate * phi + start [cycles] of a mesh by the rigid motion.

    Gear 1's own phase is rate * phi + ``rolled`` + ``teeth`` / 2 pi times its rolling angle relative to the rigid
    motion.

    Attributes
    ----------
    name
        The mesh.
    teeth, gear
        Parameter: teeth of gear 1, positive if its rotation increases the phase; and the body of gear 1.
    rate
        Parameter; None at rest, and if only outputs need it: it is then computed from teeth and speed ratios.
    start, rolled
        Parameters.
    followed
        Whether stiffness, errors or friction vary with either phase.
    """

    name: str
    teeth: str
    gear: str
    rate: str | None
    start: str
    rolled: str
    followed: bool


@dataclass(frozen=True)
class Profile:
    """Profile of a mesh's ``stiffness`` or ``error`` over its phase: a kind of ``profiles`` and its parameters.

    ``turned`` and ``opening`` are the effects of a pin position error on a deflection of angles only. ``error`` and
    ``turned`` are motions, so they have opposite signs on the two flanks; ``opening`` has the same.
    """

    mesh: str
    quantity: str
    kind: str
    numbers: tuple[str, ...]


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
    profiles: tuple[Profile, ...]
    parameters: tuple[Parameter, ...]
    effects: dict[str, str]
    statics: dict[str, float]
    signals: tuple[Signal, ...] = ()
    tables: dict[str, tuple[tuple[float, float], ...]] = field(default_factory=dict)
    clocks: tuple[Clock, ...] = ()

    @property
    def freedoms(self) -> int:
        """Count the degrees of freedom."""
        return sum(len(body.freedoms) + (body.turning == "reference") for body in self.bodies)

    @property
    def has_turning_frame(self) -> bool:
        """Tell whether a body is described in a frame that turns."""
        return any(self.frames[body.frame] is not None for body in self.bodies)

    def structure(self) -> str:
        """Return the structure that determines the C, as canonical JSON: no title, no numbers."""
        shape = {key: value for key, value in vars(self).items() if key not in UNSHAPED}
        shape["parameters"] = [(p.name, p.unit, p.role, p.bounds) for p in self.parameters]
        return json.dumps(shape, sort_keys=True, separators=(",", ":"), default=vars)

    def values(self) -> dict[str, float]:
        """Return parameter name -> value in SI, in the order of the C."""
        return {p.name: p.value for p in self.parameters}

    def nominal_place(self, body: str) -> tuple[float, float]:
        """Return the position of a body in its frame at angle zero [m], including that of its seat."""
        numbers, here = self.values(), next(item for item in self.bodies if item.name == body)
        x, y = (numbers[name] for name in here.place) if here.place else (0.0, 0.0)
        if here.seat is None:
            return x, y
        below = self.nominal_place(here.seat)
        return below[0] + x, below[1] + y
