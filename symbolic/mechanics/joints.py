"""Rigid joints: loads on a body that sits on another, or shares its angle, are transferred to it."""

from .kinematics import Kinematics, Value
from .model import Body

Loads = dict[str, list[Value]]
"""Body -> force along x and y [N] and torque [N m]."""


class Joints(Kinematics):
    r"""The rigid joints of a model.

    A body with all that sits on it has mass :math:`m`, inertia :math:`I` about its centre, and mass times offset
    :math:`\mathbf S` (zero if balanced). Newton's and Euler's laws about the centre C,

    .. math:: m\mathbf a_C + \Omega'\,\mathbf z\times\mathbf S - \Omega^2\mathbf S = \mathbf F, \qquad
              I\Omega' + \mathbf S\times\mathbf a_C = T,

    give :math:`(I - S^2/m)\,\Omega' = T - \mathbf S\times\mathbf F/m`.
    """

    def _seats(self, body: Body) -> int:
        """Return the number of seats, one on the other, below a body."""
        return 0 if body.seat is None else 1 + self._seats(self.bodies[body.seat])

    def mass(self, body: Body) -> Value:
        """Return a body's mass [kg]."""
        return self.number(body.mass or "", f"m@{body.name}")

    def static_moment(self, body: Body) -> tuple[Value, Value]:
        """Return S [kg m] at angle zero."""
        assert body.moment is not None
        return self.number(body.moment[0], f"S_x@{body.name}"), self.number(body.moment[1], f"S_y@{body.name}")

    def moment(self, body: Body) -> list[Value]:
        """Return S [kg m] in the basis of the forces."""
        turned = self.in_basis(body, *self.rotate(self.turning(body)[0], *self.static_moment(body)))
        return [self.keep(f"s_{axis}@{body.name}", body.name, s) for axis, s in zip("xy", turned, strict=True)]

    def carry(self, forces: Loads) -> Loads:
        """Transfer forces and torques: from seated bodies to their seats, outermost first, then to leaders."""
        carried = {name: list(load) for name, load in forces.items()}
        for body in sorted(self.bodies.values(), key=self._seats, reverse=True):
            load = carried[body.name]
            fx, fy = load[:2] = [self.keep(f"F_{c}@{body.name}", body.name, load[i]) for i, c in enumerate("xy")]
            if body.seat is not None:
                ax, ay = self.in_basis(body, *self.arm(body))
                _add(carried[body.seat], fx, fy, ax * fy - ay * fx)
                load[:2] = self.zero, self.zero
        for body in self.bodies.values():
            if body.leader is not None:
                torque = self.keep(f"T@{body.name}", body.name, carried[body.name][2])
                _add(carried[body.leader], self.zero, self.zero, torque)
                carried[body.name][2] = self.zero
        return carried

    def turned_about_mass(self, carried: Loads) -> Loads:
        """Return carried forces with the torque about an offset centre of mass, T - S x F / m."""
        loads = {name: list(load) for name, load in carried.items()}
        for body in self.bodies.values():
            if body.moment is not None:
                (sx, sy), (fx, fy, _) = self.moment(body), carried[body.name]
                _add(loads[body.leader or body.name], self.zero, self.zero, (sy * fx - sx * fy) / self.mass(body))
        for body in self.bodies.values():
            if body.leader is None:
                loads[body.name][2] = self.keep(f"T@{body.name}", body.name, loads[body.name][2])
        return loads

    def inertia(self, body: Body) -> Value:
        """Return the effective inertia of a body [kg m^2], with all that shares its angle: I - S^2 / m."""
        inertia = self.number(body.inertia or "", f"I@{body.name}")
        for other in self.bodies.values():
            if other.moment is not None and (other.leader or other.name) == body.name:
                sx, sy = self.static_moment(other)
                inertia = inertia - (sx**2 + sy**2) / self.mass(other)
        return inertia

    def unbalance(self, body: Body, fx: Value, fy: Value, spin: Value) -> list[Value]:
        """Add the force of the offset mass, S Omega^2 - Omega' z x S, in the body's frame."""
        sx, sy = self.moment(body)
        turned = self.turning(body)[1] + self.frame_turn(body)[1]
        speed = self.keep(f"Omega@{body.name}", body.name, turned)
        spin = self.keep(f"Omega_d@{body.name}", body.name, spin)
        return [fx + speed**2 * sx + spin * sy, fy + speed**2 * sy - spin * sx]


def _add(load: list[Value], *more: Value) -> None:
    """Add to a load."""
    load[:] = [one + other for one, other in zip(load, more, strict=True)]
