"""Kinematics: position and rates of every body in its frame and relative to the ground.

Written once for both kinds of states and numbers: CasADi graphs for the C, and SymPy symbols for the book.
"""

from abc import ABC, abstractmethod
from collections.abc import Iterator
from typing import Any

from ..elements.axes import PLANE
from ..elements.base import Element, Port
from .frames import rotate
from .model import Body, Instance, Model

Value = Any  # CasADi's SX or SymPy's Expr
LETTERS = {"x": ("x", "v_x"), "y": ("y", "v_y"), "u": ("u", "u_d")}
"""Degree of freedom -> letter of its coordinate and of the rate."""


class Kinematics(ABC):
    """Motion of the bodies of a model, in rotating frames or in inertial coordinates.

    A subclass defines states and parameters. Letters are those of the book; quantities of a body or a mesh carry its
    name after ``@``, those of an element its number after ``#``.

    Attributes
    ----------
    functions
        The library of ``cos``, ``sin`` and ``pi``.
    zero
        Its zero.
    basis
        Basis of the elements' positions: ``frame`` or ``inertial``.
    """

    functions: Any
    zero: Value
    basis = "frame"

    def __init__(self, model: Model) -> None:
        self.model = model
        self.bodies = {body.name: body for body in model.bodies}
        self.signals = {signal.name for signal in model.signals}
        self.starts = {(clock.ratio, clock.frame): clock.start for clock in model.clocks if not clock.mesh}
        self.lead = next((body for body in model.bodies if body.turning == "reference"), None)

    @abstractmethod
    def state(self, name: str, letter: str) -> Value:
        """Return a state."""

    @abstractmethod
    def number(self, name: str, letter: str) -> Value:
        """Return a parameter or load signal."""

    def keep(self, letter: str, owner: str, value: Value) -> Value:
        """Return a quantity that may get its own letter; ``owner`` is its body, mesh or element."""
        return value

    # --- reference and frames

    @property
    def phi(self) -> Value:
        """Return the reference angle [rad]."""
        return self.zero if self.model.reference == "rest" else self.state("reference.angle", "phi")

    @property
    def speed(self) -> Value:
        """Return the reference speed [rad/s]: a state, a signal or a number."""
        if self.model.reference == "rest":
            return self.zero
        return (self.number if self.lead is None else self.state)("reference.speed", "phi_d")

    def ratio(self, name: str | None) -> Value:
        """Return a speed over the reference speed."""
        return self.number(name, f"rho@{name.removesuffix('.speed_ratio')}") if name else self.zero

    def _start(self, ratio: str | None, frame: str | None) -> Value:
        """Return the initial angle of a rotation [rad]."""
        start = self.starts.get((ratio or "", frame or ""))
        if start is None or ratio is None:
            return self.zero
        return self.number(start, f"beta_0@{start.removesuffix('.start_angle')}")

    def frame_turn(self, body: Body) -> tuple[Value, Value]:
        """Return angle and speed of a body's frame."""
        ratio = self.model.frames[body.frame]
        return self.ratio(ratio) * self.phi + self._start(ratio, None), self.ratio(ratio) * self.speed

    def in_basis(self, body: Body, x: Value, y: Value) -> list[Value]:
        """Rotate a vector from a body's frame into the basis of the forces."""
        return [x, y] if self.basis == "frame" else self.rotate(self.frame_turn(body)[0], x, y)

    def rotate(self, angle: Value, x: Value, y: Value) -> list[Value]:
        """Rotate a vector by an angle."""
        return rotate(angle, x, y, self.functions)

    # --- bodies

    def moving(self) -> Iterator[tuple[Body, str]]:
        """List all degrees of freedom but the reference."""
        yield from ((body, axis) for body in self.model.bodies for axis in body.freedoms)

    def coordinate(self, body: Body, axis: str) -> tuple[Value, Value]:
        """Return a coordinate of a body and its rate, zero if it has none."""
        if axis not in body.freedoms:
            return self.zero, self.zero
        state, (here, rate) = f"{body.name}.{axis}", LETTERS[axis]
        return self.state(state, f"{here}@{body.name}"), self.state(f"{state}.rate", f"{rate}@{body.name}")

    def twist(self, body: Body) -> tuple[Value, Value]:
        """Return a body's deviation of angle and its rate, or those of its leader."""
        return self.coordinate(self.bodies[body.leader or body.name], "u")

    def turning(self, body: Body) -> tuple[Value, Value]:
        """Return the rotation angle and speed of a body in its frame."""
        (u, w), frame = self.twist(body), self.model.frames[body.frame]
        if body.ratio == frame:
            return u, w
        relative = self.ratio(body.ratio) - self.ratio(frame)
        return relative * self.phi + (self._start(body.ratio, frame) + u), relative * self.speed + w

    def place(self, body: Body) -> tuple[Value, Value]:
        """Return the nominal position of a body in its frame, or on its seat."""
        assert body.place is not None
        return self.number(body.place[0], f"x_0@{body.name}"), self.number(body.place[1], f"y_0@{body.name}")

    def arm(self, body: Body) -> list[Value]:
        """Return the arm [m] from the centre of a body's seat to its own, in its frame."""
        assert body.seat is not None
        ax, ay = self.rotate(self.turning(self.bodies[body.seat])[0], *self.place(body))
        return [self.keep(f"a_x@{body.name}", body.name, ax), self.keep(f"a_y@{body.name}", body.name, ay)]

    def motion(self, body: Body) -> tuple[list[Value], list[Value]]:
        """Return a body's position and rates in its frame."""
        u, w = self.twist(body)
        if body.seat is not None:
            x, y, vx, vy = self._seated(body, self.bodies[body.seat])
        else:
            (x, vx), (y, vy) = self.coordinate(body, "x"), self.coordinate(body, "y")
            if body.place is not None:
                x, y = (here + nominal for here, nominal in zip((x, y), self.place(body), strict=True))
        return [x, y, u], [vx, vy, w]

    def _seated(self, body: Body, below: Body) -> list[Value]:
        """Return position and velocity of a body that sits on another."""
        (x, y, _), (vx, vy, _) = self.motion(below)
        turning = self.turning(below)[1]
        ax, ay = self.arm(body)
        found = {"X": x + ax, "Y": y + ay, "V_x": vx - turning * ay, "V_y": vy + turning * ax}
        return [self.keep(f"{letter}@{body.name}", body.name, value) for letter, value in found.items()]

    def angle(self, body: Body) -> Value:
        """Return a body's absolute angle."""
        return self.ratio(body.ratio) * self.phi + self.twist(body)[0]

    # --- as elements see them

    def seen(self, element: Element, instance: Instance) -> dict[Any, Value]:
        """Return the values of the symbols of an element's ports."""
        found: dict[Any, Value] = {}
        for port, name in zip(element.ports, instance.bodies, strict=True):
            found |= self._on_port(port, *self.port(self.bodies[name], element.rates))
        return found

    @staticmethod
    def _on_port(port: Port, at: list[Value], rates: list[Value]) -> dict[Any, Value]:
        """Return the values of a port's symbols, given all coordinates and rates of its body."""
        whole = dict(zip(PLANE, zip(at, rates, strict=True), strict=True))
        here = {port.coordinate(axis): whole[axis][0] for axis in port.axes}
        return here | {port.rate(axis): whole[axis][1] for axis in port.axes}

    def port(self, body: Body, rates: str) -> tuple[list[Value], list[Value]]:
        """Return the position and the rates of a body at an element's port, in the chosen basis."""
        (x, y, u), (vx, vy, w) = self.motion(body)
        if rates == "frame" and self.basis == "frame":
            return [x, y, u], [vx, vy, w]
        if rates == "deviation":
            return self._turned(body, [x, y, u], [vx, vy, w])
        beta, turn = self.frame_turn(body)
        vx, vy, w = vx - turn * y, vy + turn * x, w + self.ratio(body.ratio) * self.speed
        if self.basis == "frame":
            return [x, y, u], [vx, vy, w]
        return [*self.rotate(beta, x, y), u + self.ratio(body.ratio) * self.phi], [*self.rotate(beta, vx, vy), w]

    def _turned(self, body: Body, at: list[Value], rates: list[Value]) -> tuple[list[Value], list[Value]]:
        """Return position and rates in the frame, resolved in the chosen basis."""
        if self.basis == "frame":
            return at, rates
        beta, _ = self.frame_turn(body)
        return [*self.rotate(beta, *at[:2]), self.angle(body)], [*self.rotate(beta, *rates[:2]), rates[2]]

    def ground(self, body: Body) -> tuple[list[Value], list[Value]]:
        """Return a body's position and its velocity relative to the ground, in inertial axes."""
        beta, turn = self.frame_turn(body)
        (x, y, _), (vx, vy, _) = self.motion(body)
        return self.rotate(beta, x, y), self.rotate(beta, vx - turn * y, vy + turn * x)
