"""Kinematics in CasADi: states, position and rates of every body in its frame and against the ground."""

from collections.abc import Iterator
from typing import Any

import casadi as ca
from ltcgear.generated.contract import State

from .joints import rotate
from .model import Body, Model


class Kinematics:
    """The symbols of a model and the motion of its bodies, in turning frames or in inertial coordinates."""

    def __init__(self, model: Model, derivation: str, basis: str) -> None:
        self.model, self.derivation, self.basis = model, derivation, basis
        self.bodies = {body.name: body for body in model.bodies}
        self.p = ca.SX.sym("p", len(model.parameters))
        self.number = {q.name: self.p[i] for i, q in enumerate(model.parameters)}
        self.s = ca.SX.sym("s", len(model.levels) + len(model.signals))
        self.level = {level.name: self.s[i] for i, level in enumerate(model.levels)}
        self.number |= {signal.name: self.s[len(self.level) + i] for i, signal in enumerate(model.signals)}
        self.states = tuple(self._states())
        self.x = ca.SX.sym("x", len(self.states))
        self.value = {state.name: self.x[i] for i, state in enumerate(self.states)}
        self.phi = self.value.get("reference.angle", ca.SX(0))
        self.start = {(c.ratio, c.frame): self.number[c.start] for c in model.clocks if not c.mesh}
        self.speed = self.value.get("reference.speed", self.number.get("reference.speed", ca.SX(0)))

    def _states(self) -> Iterator[State]:
        """List the states: reference angle, deviations, (reference speed), rates of the deviations."""
        moving = [(body, axis) for body in self.model.bodies for axis in self.axes(body)]
        lead = next((body for body in self.model.bodies if body.turning == "reference"), None)
        if self.model.reference != "rest":
            yield State("reference.angle", "rad", lead.name if lead else "", "theta", "", "reference angle")
        for body, axis in moving:
            yield State(
                f"{body.name}.{axis}",
                "rad" if axis == "u" else "m",
                body.name,
                axis,
                self._inertia(body, axis),
                "deviation",
            )
        if lead is not None:
            yield State("reference.speed", "rad/s", lead.name, "theta", lead.inertia or "", "reference speed")
        for body, axis in moving:
            unit = "rad/s" if axis == "u" else "m/s"
            yield State(f"{body.name}.{axis}.rate", unit, body.name, axis, self._inertia(body, axis), "rate")

    @staticmethod
    def axes(body: Body) -> tuple[str, ...]:
        """Return the axes along which a body moves on its own."""
        return body.freedoms

    @staticmethod
    def _inertia(body: Body, axis: str) -> str:
        """Return the parameter that is the inertia along an axis."""
        return (body.inertia if axis == "u" else body.mass) or ""

    def frame_turn(self, body: Body) -> tuple[Any, Any]:
        """Return angle and speed of a body's frame."""
        ratio = self.model.frames[body.frame]
        if ratio is None:
            return ca.SX(0), ca.SX(0)
        start = self.start.get((ratio, ""), 0)
        return self.number[ratio] * self.phi + start, self.number[ratio] * self.speed

    def twist(self, body: Body) -> tuple[Any, Any]:
        """Return a body's deviation of angle and its rate, which are its leader's where it has one."""
        name = body.leader or body.name
        return self.value.get(f"{name}.u", ca.SX(0)), self.value.get(f"{name}.u.rate", ca.SX(0))

    def motion(self, body: Body) -> tuple[list[Any], list[Any]]:
        """Return a body's position and rates in its frame."""
        u, w = self.twist(body)
        if body.seat is not None:
            (x, y, _), (vx, vy, _) = self.motion(self.bodies[body.seat])
            turning = self.turning(self.bodies[body.seat])[1]
            ax, ay = self.arm(body)
            return [x + ax, y + ay, u], [vx - turning * ay, vy + turning * ax, w]
        x, y = (self.value.get(f"{body.name}.{axis}", ca.SX(0)) for axis in "xy")
        vx, vy = (self.value.get(f"{body.name}.{axis}.rate", ca.SX(0)) for axis in "xy")
        if body.place is not None:
            x, y = x + self.number[body.place[0]], y + self.number[body.place[1]]
        return [x, y, u], [vx, vy, w]

    def turning(self, body: Body) -> tuple[Any, Any]:
        """Return by how much a body has turned in its frame, and how fast it turns there."""
        (u, w), frame = self.twist(body), self.model.frames[body.frame]
        if body.ratio == frame:
            return u, w
        relative = self.ratio(body) - (self.number[frame] if frame else 0)
        start = self.start.get((body.ratio or "", frame or ""), 0)
        return relative * self.phi + (start + u), relative * self.speed + w

    def ratio(self, body: Body) -> Any:  # noqa: ANN401
        """Return a body's speed over the reference speed."""
        return self.number[body.ratio] if body.ratio else ca.SX(0)

    def arm(self, body: Body) -> list[Any]:
        """Return the arm [m] from the centre of a body's seat to its own, in its frame."""
        assert body.seat is not None
        assert body.place is not None
        return rotate(self.turning(self.bodies[body.seat])[0], *(self.number[name] for name in body.place))

    def port(self, body: Body, rates: str) -> tuple[list[Any], list[Any]]:
        """Return the position and the rates that an element sees of a body, in the basis chosen."""
        (x, y, u), (vx, vy, w) = self.motion(body)
        if rates == "frame" and self.basis == "frame":
            return [x, y, u], [vx, vy, w]
        if rates == "deviation":
            return self._turned(body, [x, y, u], [vx, vy, w])
        beta, turn = self.frame_turn(body)
        vx, vy, w = vx - turn * y, vy + turn * x, w + self.ratio(body) * self.speed
        if self.basis == "frame":
            return [x, y, u], [vx, vy, w]
        return [*rotate(beta, x, y), u + self.ratio(body) * self.phi], [*rotate(beta, vx, vy), w]

    def _turned(self, body: Body, at: list[Any], rates: list[Any]) -> tuple[list[Any], list[Any]]:
        """Return position and rates in the frame, resolved in the basis chosen."""
        if self.basis == "frame":
            return at, rates
        beta, _ = self.frame_turn(body)
        return [*rotate(beta, *at[:2]), self.angle(body)], [*rotate(beta, *rates[:2]), rates[2]]

    def position(self, body: Body) -> ca.SX:
        """Return a body's position in inertial axes."""
        (x, y, _), _ = self.motion(body)
        position: ca.SX = ca.vertcat(*rotate(self.frame_turn(body)[0], x, y))
        return position

    def angle(self, body: Body) -> Any:  # noqa: ANN401
        """Return a body's absolute angle."""
        return self.ratio(body) * self.phi + self.twist(body)[0]

    def velocity(self, body: Body) -> list[Any]:
        """Return a body's velocity against the ground, in inertial axes."""
        chosen, self.basis = self.basis, "inertial"
        _, (vx, vy, _) = self.port(body, "absolute")
        self.basis = chosen
        return [vx, vy]
