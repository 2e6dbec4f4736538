"""Rigid joints: a body that sits on another, or shares its angle, hands on what acts on it."""

from typing import Any, Protocol

import casadi as ca

from .model import Body


def rotate(angle: Any, x: Any, y: Any) -> list[Any]:  # noqa: ANN401
    """Turn a vector by an angle."""
    cos, sin = ca.cos(angle), ca.sin(angle)
    return [cos * x - sin * y, sin * x + cos * y]


class Derivation(Protocol):
    """What the joints must know of a derivation."""

    bodies: dict[str, Body]
    number: dict[str, Any]
    basis: str

    def arm(self, body: Body) -> list[Any]:
        """Return the arm of a body on its seat, in its frame."""

    def turning(self, body: Body) -> tuple[Any, Any]:
        """Return angle and speed of a body in its frame."""

    def frame_turn(self, body: Body) -> tuple[Any, Any]:
        """Return angle and speed of a body's frame."""


class Joints:
    r"""The rigid joints of a model.

    With what sits on a body, mass and inertia about its centre are :math:`m` and :math:`I`, and mass times
    offset is :math:`\mathbf S` (zero where it is balanced). Newton's and Euler's laws about the centre C,

    .. math:: m\mathbf a_C + \Omega'\,\mathbf z\times\mathbf S - \Omega^2\mathbf S = \mathbf F, \qquad
              I\Omega' + \mathbf S\times\mathbf a_C = T,

    give :math:`(I - S^2/m)\,\Omega' = T - \mathbf S\times\mathbf F/m`.
    """

    def __init__(self, assembly: Derivation) -> None:
        self.of = assembly

    def _seats(self, body: Body) -> int:
        """Return on how many seats a body sits, one on the other."""
        return 0 if body.seat is None else 1 + self._seats(self.of.bodies[body.seat])

    def _in_basis(self, body: Body, x: Any, y: Any) -> list[Any]:  # noqa: ANN401
        """Turn a vector from a body's frame into the basis of the forces."""
        return [x, y] if self.of.basis == "frame" else rotate(self.of.frame_turn(body)[0], x, y)

    def moment(self, body: Body) -> list[Any]:
        """Return S [kg m] in the basis of the forces."""
        assert body.moment is not None
        turned = rotate(self.of.turning(body)[0], *(self.of.number[name] for name in body.moment))
        return self._in_basis(body, *turned)

    def carry(self, forces: dict[str, ca.SX]) -> dict[str, ca.SX]:
        """Hand on forces and torques: from the seated to their seats, outermost first, then to leaders."""
        carried = dict(forces)
        for body in sorted(self.of.bodies.values(), key=self._seats, reverse=True):
            if body.seat is not None:
                fx, fy, torque = ca.vertsplit(carried[body.name])
                ax, ay = self._in_basis(body, *self.of.arm(body))
                carried[body.seat] = carried[body.seat] + ca.vertcat(fx, fy, ax * fy - ay * fx)
                carried[body.name] = ca.vertcat(0, 0, torque)
        for body in self.of.bodies.values():
            if body.leader is not None:
                carried[body.leader] = carried[body.leader] + ca.vertcat(0, 0, carried[body.name][2])
                carried[body.name] = ca.vertcat(carried[body.name][:2], 0)
        return carried

    def turned_about_mass(self, carried: dict[str, ca.SX]) -> dict[str, ca.SX]:
        """Return carried forces with what is left of the torque about an offset centre of mass, T - S x F / m."""
        torques = dict(carried)
        for body in self.of.bodies.values():
            if body.moment is not None:
                leader, (sx, sy), force = body.leader or body.name, self.moment(body), carried[body.name]
                turn = (sy * force[0] - sx * force[1]) / self.of.number[body.mass or ""]
                torques[leader] = torques[leader] + ca.vertcat(0, 0, turn)
        return torques

    def inertia(self, body: Body) -> Any:  # noqa: ANN401
        """Return what resists a body's turning [kg m^2], with all that shares its angle: I - S^2 / m."""
        inertia = self.of.number[body.inertia or ""]
        for other in self.of.bodies.values():
            if other.moment is not None and (other.leader or other.name) == body.name:
                sx, sy = (self.of.number[name] for name in other.moment)
                inertia = inertia - (sx**2 + sy**2) / self.of.number[other.mass or ""]
        return inertia

    def unbalance(self, body: Body, fx: Any, fy: Any, spin: Any) -> list[Any]:  # noqa: ANN401
        """Add to a force what the offset mass gives: S Omega^2 - Omega' z x S, in the body's frame."""
        turned, relative = self.of.turning(body)
        sx, sy = rotate(turned, *(self.of.number[name] for name in body.moment or ()))
        speed = relative + self.of.frame_turn(body)[1]
        return [fx + speed**2 * sx + spin * sy, fy + speed**2 * sy - spin * sx]
