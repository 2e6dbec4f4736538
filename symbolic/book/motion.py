"""Printed kinematics: positions and rates of bodies as elements see them."""

from collections.abc import Iterator
from dataclasses import dataclass

import sympy as sp

from ..elements.base import real
from ..mechanics.model import Body, Model

Six = tuple[sp.Expr, sp.Expr, sp.Expr, sp.Expr, sp.Expr, sp.Expr]
COORDINATES = {"x": ("x", "v_x"), "y": ("y", "v_y"), "u": ("u", "u_d")}


@dataclass(frozen=True)
class Assignment:
    """One printed equation: symbol, what it is, and which body or element (by number) it belongs to."""

    symbol: sp.Expr
    value: sp.Expr
    owner: str


@dataclass(frozen=True)
class Leaf:
    """What a free symbol stands for: a state (x), a level or signal (s) or a parameter (p) of the C, by name."""

    vector: str
    name: str


def has_turning_frame(model: Model) -> bool:
    """Tell whether a body is described in a frame that turns."""
    return any(model.frames[body.frame] is not None for body in model.bodies)


def rotate(angle: sp.Expr, x: sp.Expr, y: sp.Expr) -> tuple[sp.Expr, sp.Expr]:
    """Turn a vector by an angle."""
    cos, sin = sp.cos(angle), sp.sin(angle)
    return cos * x - sin * y, sin * x + cos * y


class PrintedMotion:
    """Places, angles and rates of a model's bodies; collects the leaves, and what had to be named on the way."""

    def __init__(self, model: Model) -> None:
        self.model = model
        self.bodies = {body.name: body for body in model.bodies}
        self.leaves: dict[sp.Expr, Leaf] = {}
        self.assigned: list[Assignment] = []
        self.signals = {signal.name for signal in model.signals}
        self.starts = {(clock.ratio, clock.frame): clock.start for clock in model.clocks if not clock.mesh}
        lead = next((body for body in model.bodies if body.turning == "reference"), None)
        self.lead = lead
        rests = model.reference == "rest"
        self.phi = sp.S.Zero if rests else self.leaf("phi", Leaf("x", "reference.angle"))
        self.phi_d = sp.S.Zero if rests else self._speed()

    def _speed(self) -> sp.Expr:
        """Return the reference speed: a state, a signal or a number."""
        if self.lead is not None:
            return self.leaf("phi_d", Leaf("x", "reference.speed"))
        return self.leaf("phi_d", Leaf("s" if "reference.speed" in self.signals else "p", "reference.speed"))

    def leaf(self, name: str, leaf: Leaf) -> sp.Symbol:
        """Make a symbol that stands for a state, a signal or a number."""
        symbol = real(name)
        self.leaves[symbol] = leaf
        return symbol

    def number(self, letter: str, parameter: str) -> sp.Symbol:
        """Make the symbol of a parameter, or of a load signal."""
        return self.leaf(letter, Leaf("s" if parameter in self.signals else "p", parameter))

    def name(self, letter: str, value: sp.Expr, owner: str) -> sp.Symbol:
        """Give a value a symbol of its own."""
        symbol = real(letter)
        self.assigned.append(Assignment(symbol, sp.sympify(value), owner))
        return symbol

    @staticmethod
    def axes(body: Body) -> tuple[str, ...]:
        """Return the axes along which a body moves on its own."""
        return body.freedoms

    def coordinate(self, body: Body, axis: str) -> tuple[sp.Expr, sp.Expr]:
        """Return a coordinate of a body and its rate, zero where it has none."""
        if axis not in self.axes(body):
            return sp.S.Zero, sp.S.Zero
        here, rate = COORDINATES[axis]
        state = f"{body.name}.{axis}"
        return self.leaf(f"{here}@{body.name}", Leaf("x", state)), self.leaf(
            f"{rate}@{body.name}", Leaf("x", f"{state}.rate")
        )

    def ratio(self, name: str | None) -> sp.Expr:
        """Return a speed ratio."""
        return sp.S.Zero if name is None else self.number(f"rho@{name.removesuffix('.speed_ratio')}", name)

    def frame_turn(self, body: Body) -> tuple[sp.Expr, sp.Expr]:
        """Return angle and speed of a body's frame."""
        ratio = self.model.frames[body.frame]
        return self.ratio(ratio) * self.phi + self._start(ratio, None), self.ratio(ratio) * self.phi_d

    def _start(self, ratio: str | None, frame: str | None) -> sp.Expr:
        """Return the angle from which something turns."""
        start = self.starts.get((ratio or "", frame or ""))
        if start is None or ratio is None:
            return sp.S.Zero
        return self.number(f"beta_0@{start.removesuffix('.start_angle')}", start)

    def twist(self, body: Body) -> tuple[sp.Expr, sp.Expr]:
        """Return a body's deviation of angle and its rate, which are its leader's where it has one."""
        return self.coordinate(self.bodies[body.leader or body.name], "u")

    def turning(self, body: Body) -> tuple[sp.Expr, sp.Expr]:
        """Return by how much a body has turned in its frame, and how fast it turns there."""
        (u, w), frame = self.twist(body), self.model.frames[body.frame]
        if body.ratio == frame:
            return u, w
        relative = self.ratio(body.ratio) - self.ratio(frame)
        return relative * self.phi + self._start(body.ratio, frame) + u, relative * self.phi_d + w

    def port(self, body: Body, rates: str) -> Six:
        """Return place, angle and their rates as an element sees them, in the body's frame."""
        x, y, u, vx, vy, w = self.motion(body)
        if rates == "absolute":
            _, turn = self.frame_turn(body)
            vx, vy, w = vx - turn * y, vy + turn * x, w + self.ratio(body.ratio) * self.phi_d
        return x, y, u, vx, vy, w

    def motion(self, body: Body) -> Six:
        """Return place, angle and their rates in the body's frame."""
        u, w = self.twist(body)
        if body.seat is not None:
            x, y, vx, vy = self._seated(body)
            return x, y, u, vx, vy, w
        (x, vx), (y, vy) = self.coordinate(body, "x"), self.coordinate(body, "y")
        if body.place is not None:
            x, y = x + self.place(body)[0], y + self.place(body)[1]
        return x, y, u, vx, vy, w

    def place(self, body: Body) -> tuple[sp.Expr, sp.Expr]:
        """Return the nominal place of a body in its frame, or on its seat."""
        assert body.place is not None
        return self.number(f"x_0@{body.name}", body.place[0]), self.number(f"y_0@{body.name}", body.place[1])

    def _seated(self, body: Body) -> tuple[sp.Expr, ...]:
        """Return the motion of what sits on another body, named once."""
        names = [f"{letter}@{body.name}" for letter in ("X", "Y", "V_x", "V_y")]
        if not any(item.symbol == real(names[0]) for item in self.assigned):
            assert body.seat is not None
            below = self.bodies[body.seat]
            x, y, _, vx, vy, _ = self.motion(below)
            ax, ay = self.arm(body)
            turn = self.turning(below)[1]
            for name, value in zip(names, (x + ax, y + ay, vx - turn * ay, vy + turn * ax), strict=True):
                self.name(name, value, body.name)
        return tuple(real(name) for name in names)

    def arm(self, body: Body) -> tuple[sp.Expr, sp.Expr]:
        """Return the arm from the centre of a body's seat to its own, named once."""
        names = f"a_x@{body.name}", f"a_y@{body.name}"
        if not any(item.symbol == real(names[0]) for item in self.assigned):
            assert body.seat is not None
            turned = rotate(self.turning(self.bodies[body.seat])[0], *self.place(body))
            for name, value in zip(names, turned, strict=True):
                self.name(name, value, body.name)
        return real(names[0]), real(names[1])

    def moving(self) -> Iterator[tuple[Body, str]]:
        """List all freedoms but the reference."""
        yield from ((body, axis) for body in self.model.bodies for axis in self.axes(body))
