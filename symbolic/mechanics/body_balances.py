"""Balances of force and torque: wrenches summed on the bodies, and the accelerations that follow."""

from abc import abstractmethod
from collections.abc import Iterable

from ..elements.axes import PLANE
from ..elements.base import Element
from .joints import Joints, Loads
from .kinematics import Value
from .mesh_motion import MeshMotion
from .model import Body, Instance


class Balances(MeshMotion, Joints):
    """Newton's and Euler's laws of all bodies of a model.

    Attributes
    ----------
    acting, carried, forces
        Loads on each body: of its elements, after transfer through rigid joints, and with torques about offset centres
        of mass.
    """

    @abstractmethod
    def body_law(self, given: dict[str, Value]) -> dict[str, Value]:
        """Return the accelerations of a body by degree of freedom, given the symbols of ``FrameMotion`` by name."""

    def sum_up(self, acting: Iterable[tuple[Instance, list[list[Value]]]]) -> None:
        """Sum up the loads on the bodies, given force and torque on each port of each element."""
        self.acting: Loads = {name: [self.zero] * 3 for name in self.bodies}
        for instance, loads in acting:
            for name, load in zip(instance.bodies, loads, strict=True):
                self.acting[name] = [one + other for one, other in zip(self.acting[name], load, strict=True)]
        self.carried = self.carry(self.acting)
        self.forces = self.turned_about_mass(self.carried)

    def on_ports(self, element: Element, loads: Iterable[Value]) -> list[list[Value]]:
        """Return force and torque on each port of an element, given the loads on its degrees of freedom."""
        known = dict(zip(element.freedoms, loads, strict=True))
        return [[known.get((port, axis), self.zero) for axis in PLANE] for port in element.ports]

    def reference_acceleration(self) -> Value:
        """Return phi'': zero at constant speed, a signal for a speed over time, else that of the reference member."""
        if self.lead is not None:
            own = self.forces[self.lead.name][2] / self.inertia(self.lead)
            return self.keep("phi_dd", self.lead.name, own)
        signal = "reference.acceleration"
        return self.number(signal, "phi_dd") if signal in self.signals else self.zero

    def drive_torque(self, body: Body) -> Value:
        """Return the torque that prescribes a body's speed: against the loads on it, and for its acceleration."""
        own = self.inertia(body) * self.ratio(body.ratio) * self.reference_acceleration()
        return own - self.forces[body.name][2]

    def spin(self, body: Body) -> Value:
        """Return a body's absolute angular acceleration."""
        lead, phi_dd = self.bodies[body.leader or body.name], self.reference_acceleration()
        rigid = self.ratio(body.ratio) * phi_dd
        if lead.turning != "free":
            return rigid
        return rigid + self.forces[lead.name][2] / self.inertia(lead) - self.ratio(lead.ratio) * phi_dd

    def push(self, body: Body) -> list[Value]:
        """Return the force on a body, including that of an offset mass."""
        fx, fy, _ = self.forces[body.name]
        return [fx, fy] if body.moment is None else self.unbalance(body, fx, fy, self.spin(body))

    def accelerations(self, body: Body) -> dict[str, Value]:
        """Return a body's accelerations in its frame, by degree of freedom."""
        (x, y, _), (vx, vy, _) = self.motion(body)
        fx, fy = self.push(body)
        given = {
            "x": x, "y": y, "vx": vx, "vy": vy, "fx": fx, "fy": fy, "torque": self.forces[body.name][2],
            "ratio": self.ratio(body.ratio), "frame_ratio": self.ratio(self.model.frames[body.frame]),
            "phi_d": self.speed, "phi_dd": self.reference_acceleration(),
        }  # fmt: skip
        if body.lateral:
            given["m"] = self.mass(body)
        if "u" in body.freedoms:
            given["inertia"] = self.inertia(body)
        return self.body_law(given)

    def rates(self) -> dict[str, Value]:
        """Return the rates of all states."""
        found = {}
        if self.model.reference != "rest":
            found["reference.angle"] = self.speed
        if self.lead is not None:
            found["reference.speed"] = self.reference_acceleration()
        for body in self.model.bodies:
            accelerations = self.accelerations(body) if body.freedoms else {}
            for axis in body.freedoms:
                found[f"{body.name}.{axis}"] = self.coordinate(body, axis)[1]
                found[f"{body.name}.{axis}.rate"] = accelerations[axis]
        return found
