"""Element: coordinates, a potential, a dissipation function and a hand-written wrench."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import sympy as sp


@dataclass(frozen=True)
class Port:
    """The motion of one body as an element sees it: position [m], angle [rad] and their rates."""

    x: sp.Symbol
    y: sp.Symbol
    theta: sp.Symbol
    vx: sp.Symbol
    vy: sp.Symbol
    omega: sp.Symbol

    @classmethod
    def numbered(cls, number: int) -> "Port":
        """Make the port of the ``number``-th body, its symbols carrying that number."""
        names = ("x", "y", "theta", "vx", "vy", "omega")
        return cls(*(sp.Symbol(f"{name}_{number}", real=True) for name in names))

    @property
    def coordinates(self) -> tuple[sp.Symbol, ...]:
        """Return x, y, theta."""
        return (self.x, self.y, self.theta)

    @property
    def rates(self) -> tuple[sp.Symbol, ...]:
        """Return the rates of x, y, theta."""
        return (self.vx, self.vy, self.omega)


COORDINATE_UNITS = ("m", "m", "rad")
RATE_UNITS = ("m/s", "m/s", "rad/s")


@dataclass(frozen=True)
class Output:
    """A quantity that an element reports: expression and unit."""

    expression: sp.Expr
    unit: str


@dataclass(frozen=True)
class Element:
    r"""An interaction of bodies, in its own few coordinates.

    Two descriptions that share nothing but symbols stand side by side. Energies give
    Lagrange's generalised forces,

    .. math:: Q = -\partial V/\partial q - \partial D/\partial\dot q ,

    and ``wrench`` is what Newton's laws need: force and torque on each port, written by hand.
    ``checks.agree`` proves that they are the same. An element is frame-invariant (it may be
    evaluated in a turning basis) unless ``rates`` is ``"absolute"``, in which case velocities
    must be those against the ground, resolved in the basis, or ``"deviation"``, in which case they
    must be those in the turning frame, whatever the basis.

    Attributes
    ----------
    name
        Type name, unique for a structure (not for an instance).
    ports
        The bodies it joins.
    parameters
        Symbol -> unit, in order.
    potential, dissipation
        V [J] and D [W]; a Coulomb part of D is a pseudo-potential whose gradient is the force.
    wrench
        (F_x, F_y, T) on each port, flat, in the order of the ports [N, N, N m].
    outputs
        What a user may want to see of it.
    source
        Equation number or citation.
    gradient
        False where the wrench is not the gradient of the potential by design (the paper's mesh law).
    load
        True where it acts from outside: its power is given to the train, its energies are no energy of the train.
    closed
        False where the housing takes a part that is not written, so that the ports alone are not in balance.
    """

    name: str
    ports: tuple[Port, ...]
    parameters: Mapping[sp.Symbol, str]
    wrench: tuple[sp.Expr, ...]
    source: str
    potential: sp.Expr = sp.S.Zero
    dissipation: sp.Expr = sp.S.Zero
    outputs: Mapping[str, Output] = field(default_factory=dict)
    rates: str = "frame"
    gradient: bool = True
    load: bool = False
    closed: bool = True

    @property
    def coordinates(self) -> tuple[sp.Symbol, ...]:
        """Return the coordinates of all ports, flat."""
        return tuple(symbol for port in self.ports for symbol in port.coordinates)

    @property
    def velocities(self) -> tuple[sp.Symbol, ...]:
        """Return the rates of all ports, flat."""
        return tuple(symbol for port in self.ports for symbol in port.rates)

    @property
    def arguments(self) -> tuple[sp.Symbol, ...]:
        """Return coordinates, rates and parameters: the signature of every function of the element."""
        return (*self.coordinates, *self.velocities, *self.parameters)


class LogCosh(sp.Function):  # type: ignore[misc]  # SymPy is untyped
    """ln cosh z, the pseudo-potential of tanh z; of its own so that its derivative never overflows."""

    def fdiff(self, argindex: int = 1) -> sp.Expr:
        """Return tanh z."""
        return sp.tanh(self.args[0])


def real(name: str) -> sp.Symbol:
    """Make a real symbol."""
    return sp.Symbol(name, real=True)


def positive(name: str) -> sp.Symbol:
    """Make a positive symbol."""
    return sp.Symbol(name, positive=True)
