"""Element: coordinates, a potential, a dissipation function and a hand-written wrench."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import sympy as sp

from .axes import PLANE, THETA, Axis, X, Y


@dataclass(frozen=True)
class Port:
    """The motion of one body as an element sees it: coordinates and their rates, by axis.

    Attributes
    ----------
    tag
        End of the names of its symbols, such as ``_1``.
    axes
        Axes that the element uses.
    """

    tag: str
    axes: tuple[Axis, ...] = PLANE

    @classmethod
    def numbered(cls, number: int, axes: tuple[Axis, ...] = PLANE) -> "Port":
        """Make the port of the ``number``-th body; its symbols carry that number."""
        return cls(f"_{number}", axes)

    @property
    def x(self) -> sp.Symbol:
        """Return the place along x [m]."""
        return self.coordinate(X)

    @property
    def y(self) -> sp.Symbol:
        """Return the place along y [m]."""
        return self.coordinate(Y)

    @property
    def theta(self) -> sp.Symbol:
        """Return the angle [rad]."""
        return self.coordinate(THETA)

    @property
    def vx(self) -> sp.Symbol:
        """Return the rate of x [m/s]."""
        return self.rate(X)

    @property
    def vy(self) -> sp.Symbol:
        """Return the rate of y [m/s]."""
        return self.rate(Y)

    @property
    def omega(self) -> sp.Symbol:
        """Return the rate of the angle [rad/s]."""
        return self.rate(THETA)

    def coordinate(self, axis: Axis) -> sp.Symbol:
        """Return the coordinate of an axis."""
        return real(axis.name + self.tag)

    def rate(self, axis: Axis) -> sp.Symbol:
        """Return the rate of the coordinate of an axis."""
        return real(axis.rate + self.tag)


Wrench = Mapping[tuple[Port, Axis], sp.Expr]
"""Force or torque on a port along or about an axis [N, N m]; axes not listed are zero."""


def load_on(port: Port, fx: sp.Expr, fy: sp.Expr, torque: sp.Expr = sp.S.Zero) -> dict[tuple[Port, Axis], sp.Expr]:
    """Return the wrench of a force [N] and a torque [N m] in the plane."""
    return {(port, X): fx, (port, Y): fy, (port, THETA): torque}


@dataclass(frozen=True)
class Output:
    """A quantity that an element reports.

    Attributes
    ----------
    expression, unit
        What it is.
    quantity
        Name in results; empty if only the model itself needs it.
    axis
        The axis of which it is a component, if any.
    """

    expression: sp.Expr
    unit: str
    quantity: str = ""
    axis: Axis | None = None


@dataclass(frozen=True)
class Element:
    r"""An interaction of bodies, in its own few coordinates.

    It has two descriptions that share nothing but symbols. Energies give Lagrange's generalised forces,

    .. math:: Q = -\partial V/\partial q - \partial D/\partial\dot q ,

    and ``wrench`` is the input of Newton's laws: force and torque on each port, written by hand. ``checks.agree``
    proves that they are the same. An element is frame-invariant (it may be evaluated in a rotating basis) unless
    ``rates`` is ``"absolute"`` (velocities relative to the ground, resolved in the basis) or ``"deviation"``
    (velocities in the rotating frame, whatever the basis).

    Attributes
    ----------
    title
        Name in the field, without options.
    joins
        Kind of connection (``mesh``, ``pin``, ``bearing``, ...), which is the dimension of its outputs; empty if none.
    ports
        The bodies it joins.
    parameters
        Symbol -> unit, in order.
    potential, dissipation
        V [J] and D [W]; a Coulomb part of D is a pseudo-potential whose gradient is the force.
    wrench
        (port, axis) -> force or torque on it [N, N m].
    outputs
        Quantities for results.
    source
        Equation number or citation.
    gradient
        False if by design the wrench is not the gradient of the potential (the paper's mesh law).
    load
        True for an external load: its power is input, and its energies do not belong to the train.
    closed
        False if an unwritten reaction acts on the housing, so that the ports alone are not in balance.
    """

    title: str
    joins: str
    ports: tuple[Port, ...]
    parameters: Mapping[sp.Symbol, str]
    wrench: Wrench
    source: str
    potential: sp.Expr = sp.S.Zero
    dissipation: sp.Expr = sp.S.Zero
    outputs: Mapping[str, Output] = field(default_factory=dict)
    rates: str = "frame"
    gradient: bool = True
    load: bool = False
    closed: bool = True

    @property
    def freedoms(self) -> tuple[tuple[Port, Axis], ...]:
        """Return the degrees of freedom of all ports, port by port: the order of coordinates, rates and loads."""
        return tuple((port, axis) for port in self.ports for axis in port.axes)

    @property
    def coordinates(self) -> tuple[sp.Symbol, ...]:
        """Return the coordinates of all ports, flat."""
        return tuple(port.coordinate(axis) for port, axis in self.freedoms)

    @property
    def velocities(self) -> tuple[sp.Symbol, ...]:
        """Return the rates of all ports, flat."""
        return tuple(port.rate(axis) for port, axis in self.freedoms)

    @property
    def loads(self) -> tuple[sp.Expr, ...]:
        """Return the wrench on all ports, flat, zeros included."""
        return tuple(self.wrench.get(freedom, sp.S.Zero) for freedom in self.freedoms)

    @property
    def arguments(self) -> tuple[sp.Symbol, ...]:
        """Return coordinates, rates and parameters: the signature of every function of the element."""
        return (*self.coordinates, *self.velocities, *self.parameters)


Law = Callable[..., Element]
TYPES: dict[str, Law] = {}
"""Name of an element type -> the function that writes it for given options."""


def element_type(law: Law) -> Law:
    """Register a function that writes an element as an element type, under its own name."""
    TYPES[law.__name__] = law
    return law


class LogCosh(sp.Function):  # type: ignore[misc]  # SymPy is untyped
    """ln cosh z, the pseudo-potential of tanh z; a class of its own so that its derivative never overflows."""

    def fdiff(self, argindex: int = 1) -> sp.Expr:
        """Return tanh z."""
        return sp.tanh(self.args[0])


def real(name: str) -> sp.Symbol:
    """Make a real symbol."""
    return sp.Symbol(name, real=True)


def positive(name: str) -> sp.Symbol:
    """Make a positive symbol."""
    return sp.Symbol(name, positive=True)
