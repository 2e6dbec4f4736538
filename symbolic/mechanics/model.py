"""Model: bodies, element instances and parameters that a scene's effects call for.

A model is structure (bodies, element instances, levels, load signals) plus numbers (parameters, tables over
time). Structure is baked into the C; numbers stay parameters, and tables are read while the C runs. Nothing
here needs SymPy, so a model whose C is already in the store is ready without deriving anything.
"""

import json
from dataclasses import dataclass, field

from ltcgear.generated.contract import PHYSICAL, Clock, Signal

from ..elements.axes import DEVIATIONS
from ..elements.key import ElementKey

LEVEL, TURN, BASIS, PHASE = "@level", "@turn", "@basis", "@phase"
UNSHAPED = ("title", "name", "effects", "statics", "tables")
"""Parts of a model that leave its C as it is."""
STIFFNESS, SLOPE, ERROR, ERROR_RATE = "@stiffness", "@slope", "@error", "@error_rate"
HOLD = "hold."
"""How the parameters begin that hold a regime while an integrator is under way; 0 lets the state decide."""


@dataclass(frozen=True)
class Parameter:
    """A number of the model: dotted name, SI value, SI unit, and one of the contract's roles."""

    name: str
    value: float
    unit: str
    role: str = PHYSICAL


@dataclass(frozen=True)
class Body:
    """A rigid body in the plane.

    Attributes
    ----------
    name
        Dotted name, such as ``lsp.planet.2``.
    freedoms
        Letters of the deviations that are integrated: x, y, u.
    turning
        ``free`` (own deviation from the rigid motion), ``held`` (angle zero), ``driven`` (held speed),
        ``reference`` (its angle is the reference angle), ``led`` (it turns with its leader) or ``point`` (the
        same, for a point of its leader that is no member).
    mass, inertia
        Parameter names, None where nothing needs them. Both count what is rigidly joined to the body.
    ratio
        Parameter name of its speed over the reference speed; None where it stands still.
    place
        Parameter names of its nominal position in the frame, or on its seat; None at the origin.
    frame
        Name of the frame it is described in.
    leader
        The body whose deviation of angle it shares.
    seat
        The body on which it sits at its place, turning about that body's centre with it.
    moment
        Parameter names of mass times offset of what sits on it [kg m], at angle zero; None where balanced.
    part
        What it is in its stage, ``""`` for a point of another body.
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
        """Tell whether it can move sideways."""
        return any(not DEVIATIONS[letter].rotation for letter in self.freedoms)


@dataclass(frozen=True)
class Instance:
    """An element at work: its type, the bodies at its ports, and where its parameters come from.

    ``bind`` maps the element's parameter names to parameter names of the model, or to ``@level`` (the
    mesh's stiffness level), ``@phase`` (its phase), ``@turn`` (how far the frame has turned) and ``@basis``;
    or to the mesh's ``@stiffness`` at its phase and that one's ``@slope``, its ``@error`` and ``@error_rate``.
    ``family`` is the name that equal connections of the train share, ``""`` of what is no connection of its own.
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

    Gear 1's own phase is rate * phi + ``rolled`` + ``teeth`` / 2 pi times its rolling angle against the rigid motion.

    Attributes
    ----------
    name
        The mesh.
    teeth, gear
        Parameter, teeth of gear 1 in the sense in which the phase counts up, and this body.
    rate
        Parameter; None at rest, and where nothing but outputs needs it: it then follows from teeth and speed ratios.
    start, rolled
        Parameters.
    followed
        Whether stiffness, errors or friction vary with the one phase or the other.
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
    """What a mesh's ``stiffness`` or ``error`` is over its phase: a kind of ``profiles`` and its parameters.

    ``turned`` and ``opening`` are what a pin out of place takes from a deflection that knows angles only. Both flanks
    see ``error`` and ``turned`` with opposite signs, since these are motions, and ``opening`` with the same.
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
        """Return all that shapes the C, as canonical JSON: no title, no number."""
        shape = {key: value for key, value in vars(self).items() if key not in UNSHAPED}
        shape["parameters"] = [(p.name, p.unit, p.role) for p in self.parameters]
        return json.dumps(shape, sort_keys=True, separators=(",", ":"), default=vars)

    def values(self) -> dict[str, float]:
        """Return parameter name -> value in SI, in the order of the C."""
        return {p.name: p.value for p in self.parameters}

    def nominal_place(self, body: str) -> tuple[float, float]:
        """Return where a body stands in its frame when nothing has turned [m], what it sits on included."""
        numbers, here = self.values(), next(item for item in self.bodies if item.name == body)
        x, y = (numbers[name] for name in here.place) if here.place else (0.0, 0.0)
        if here.seat is None:
            return x, y
        below = self.nominal_place(here.seat)
        return below[0] + x, below[1] + y
