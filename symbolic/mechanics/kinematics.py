"""Kinematics: position and rates of every body in its frame and against the ground.

Written once, over whatever states and numbers are: graphs of CasADi, of which the C is made, or symbols of SymPy,
which the book prints.
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
"""Freedom -> letter of its coordinate and of the rate."""


class Kinematics(ABC):
    """Motion of the bodies of a model, in turning frames or in inertial coordinates.

    A subclass says what states and parameters are. Letters are those of the book; what belongs to a body or a mesh
    carries its name behind ``@``, what belongs to an element its number behind ``#``.

    Attributes
    ----------
    functions
        The library whose ``cos``, ``sin`` and ``pi`` are meant.
    zero
        Its zero.
    basis
        ``frame``, or ``inertial``: what elements see positions in.
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
        """Return a quantity that may get a letter of its own; ``owner`` is the body, mesh or element it belongs to."""
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
        """Return the angle from which something turns [rad]."""
        start = self.starts.get((ratio or "", frame or ""))
        if start is None or ratio is None:
            return self.zero
        return self.number(start, f"beta_0@{start.removesuffix('.start_angle')}")

    def frame_turn(self, body: Body) -> tuple[Value, Value]:
        """Return angle and speed of a body's frame."""
        ratio = self.model.frames[body.frame]
        return self.ratio(ratio) * self.phi + self._start(ratio, None), self.ratio(ratio) * self.speed

    def in_basis(self, body: Body, x: Value, y: Value) -> list[Value]:
        """Turn a vector from a body's frame into the basis of the forces."""
        return [x, y] if self.basis == "frame" else self.rotate(self.frame_turn(body)[0], x, y)

    def rotate(self, angle: Value, x: Value, y: Value) -> list[Value]:
        """Turn a vector by an angle."""
        return rotate(angle, x, y, self.functions)

    # --- bodies

    def moving(self) -> Iterator[tuple[Body, str]]:
        """List all freedoms but the reference."""
        yield from ((body, axis) for body in self.model.bodies for axis in body.freedoms)

    def coordinate(self, body: Body, axis: str) -> tuple[Value, Value]:
        """Return a coordinate of a body and its rate, zero where it has none."""
        if axis not in body.freedoms:
            return self.zero, self.zero
        state, (here, rate) = f"{body.name}.{axis}", LETTERS[axis]
        return self.state(state, f"{here}@{body.name}"), self.state(f"{state}.rate", f"{rate}@{body.name}")

    def twist(self, body: Body) -> tuple[Value, Value]:
        """Return a body's deviation of angle and its rate, which are its leader's where it has one."""
        return self.coordinate(self.bodies[body.leader or body.name], "u")

    def turning(self, body: Body) -> tuple[Value, Value]:
        """Return by how much a body has turned in its frame, and how fast it turns there."""
        (u, w), frame = self.twist(body), self.model.frames[body.frame]
        if body.ratio == frame:
            return u, w
        relative = self.ratio(body.ratio) - self.ratio(frame)
        return relative * self.phi + (self._start(body.ratio, frame) + u), relative * self.speed + w

    def place(self, body: Body) -> tuple[Value, Value]:
        """Return the nominal place of a body in its frame, or on its seat."""
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
        """Return place and velocity of what sits on another body."""
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
        """Return what the symbols of an element's ports are."""
        found: dict[Any, Value] = {}
        for port, name in zip(element.ports, instance.bodies, strict=True):
            found |= self._on_port(port, *self.port(self.bodies[name], element.rates))
        return found

    @staticmethod
    def _on_port(port: Port, at: list[Value], rates: list[Value]) -> dict[Any, Value]:
        """Return what the symbols of a port are, given all coordinates and rates of its body."""
        whole = dict(zip(PLANE, zip(at, rates, strict=True), strict=True))
        here = {port.coordinate(axis): whole[axis][0] for axis in port.axes}
        return here | {port.rate(axis): whole[axis][1] for axis in port.axes}

    def port(self, body: Body, rates: str) -> tuple[list[Value], list[Value]]:
        """Return the position and the rates that an element sees of a body, in the basis chosen."""
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
        """Return position and rates in the frame, resolved in the basis chosen."""
        if self.basis == "frame":
            return at, rates
        beta, _ = self.frame_turn(body)
        return [*self.rotate(beta, *at[:2]), self.angle(body)], [*self.rotate(beta, *rates[:2]), rates[2]]

    def ground(self, body: Body) -> tuple[list[Value], list[Value]]:
        """Return a body's position and its velocity against the ground, in inertial axes."""
        beta, turn = self.frame_turn(body)
        (x, y, _), (vx, vy, _) = self.motion(body)
        return self.rotate(beta, x, y), self.rotate(beta, vx - turn * y, vy + turn * x)
