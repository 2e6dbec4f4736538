"""Equations of motion: elements instanced and summed on the bodies, in CasADi (Model -> Equations).

Element types were derived in SymPy; here each instance is one call of its type's function, so the work
grows with the number of gears only as fast as the equations themselves do.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from math import pi
from typing import Any

import casadi as ca
from ltcgear.generated.contract import BACK, VARYING, Report, State

from ..elements.axes import PLANE, Axis
from ..elements.element_types import make
from .joints import Joints, rotate
from .kinematics import Kinematics
from .lower import body_function, element_function
from .model import BASIS, ERROR, ERROR_RATE, LEVEL, PHASE, SLOPE, STIFFNESS, TURN, Body, Instance, Model, Phase
from .profiles import evaluate


@dataclass(frozen=True)
class Equations:
    """Equations of motion x' = f(x, s, p) and what is read off them, as CasADi graphs.

    Attributes
    ----------
    x, s, p
        States, mesh levels (0 single, 1 double contact) with the load signals after them, and parameters.
    states, levels, parameters
        What these are, in order; parameters as (name, unit).
    xdot
        Right-hand side.
    reports, outputs
        What the outputs are, and their expressions.
    phases
        Per level: phase tau [cycles], its rate [1/s], share of single contact.
    holds, borders
        Parameters that hold a regime, and the indicators whose zeros are the borders between regimes.
    energy
        Kinetic and strain energy, that of weight [J], power put in and power lost [W].
    forces, carried
        Body -> force and torque in its frame: of the elements at it, and after rigid joints have handed theirs on.
    positions, angles
        Body -> position in inertial axes [m], absolute angle [rad].
    """

    x: ca.SX
    s: ca.SX
    p: ca.SX
    states: tuple[State, ...]
    levels: tuple[str, ...]
    parameters: tuple[tuple[str, str], ...]
    xdot: ca.SX
    reports: tuple[Report, ...]
    outputs: ca.SX
    phases: tuple[ca.SX, ca.SX, ca.SX]
    holds: tuple[str, ...]
    borders: ca.SX
    energy: ca.SX
    forces: dict[str, ca.SX]
    carried: dict[str, ca.SX]
    positions: dict[str, ca.SX]
    angles: dict[str, ca.SX]


def derive(model: Model, derivation: str = "newton", basis: str = "frame") -> Equations:
    """Derive the equations of motion of a model.

    Parameters
    ----------
    model
        The model.
    derivation
        ``newton`` or ``lagrange``: where the elements' forces and the bodies' accelerations come from.
    basis
        ``frame`` evaluates elements in the turning frames (what is emitted); ``inertial`` in the paper's
        coordinates, for the check that both are the same: only its ``forces`` have a meaning then.

    Returns
    -------
    Equations
        In a fixed order of states, levels, parameters and outputs.
    """
    return _Assembly(model, derivation, basis).equations()


class _Assembly(Kinematics):
    """One derivation under way: elements at the ports of bodies, sums of wrenches."""

    def call(self, instance: Instance) -> dict[str, Any]:
        """Evaluate one element instance."""
        element = make(instance.element)
        seen = [self.port(self.bodies[name], element.rates) for name in instance.bodies]
        coordinates, velocities = (
            [value for port, motion in zip(element.ports, seen, strict=True) for value in _along(port.axes, motion[i])]
            for i in (0, 1)
        )
        names = [symbol.name for symbol in element.arguments]
        function = element_function(instance.element, self.derivation)

        def called(bound: dict[str, Any]) -> dict[str, Any]:
            values = coordinates + velocities + [bound[symbol.name] for symbol in element.parameters]
            result: dict[str, Any] = function(**dict(zip(names, values, strict=True)))
            return result

        bound = self._bound(instance)
        if SLOPE in instance.bind.values():
            # The stiffness at gear 1's own rolling angle, which the element itself knows.
            rolling = called(bound)["out_rolling"]
            bound |= dict(zip(("k", "k_d"), self._followed(instance, rolling), strict=True))
        return called(bound)

    def _bound(self, instance: Instance) -> dict[str, Any]:
        """Return the values of an element's parameters."""
        beta, _ = self.frame_turn(self.bodies[instance.bodies[-1]])
        special = {TURN: ca.SX(0), BASIS: beta} | self._special(instance)
        if self.basis == "inertial":
            special |= {TURN: beta, BASIS: ca.SX(0)}
        bound = {key: special[name] if name in special else self.number[name] for key, name in instance.bind.items()}
        if self.basis == "inertial" and "e_x" in bound:
            bound["e_x"], bound["e_y"] = rotate(beta, bound["e_x"], bound["e_y"])
        return bound

    def _special(self, instance: Instance) -> dict[str, Any]:
        """Return what a mesh's elements see of its phase; the other flank sees errors with the other sign."""
        mesh, used = instance.name.removesuffix(BACK), set(instance.bind.values())
        special: dict[str, Any] = {LEVEL: self.level.get(mesh)}
        if PHASE in used:
            special[PHASE] = self.mesh_phase_of(mesh)
        if STIFFNESS in used:
            special[STIFFNESS], special[SLOPE] = self.profile(mesh, "stiffness", self.mesh_phase_of(mesh))
        if ERROR in used:
            sign = -1 if instance.name.endswith(BACK) else 1
            error, slope = self.profile(mesh, "error", self.mesh_phase_of(mesh))
            if instance.group == "mesh":  # friction sees in the plane where pins stand
                error = error + self.profile(mesh, "turned", ca.SX(0))[0]
                special[ERROR] = sign * error + self.profile(mesh, "opening", ca.SX(0))[0]
            special = {ERROR: sign * error} | special | {ERROR_RATE: sign * slope * self.mesh_rate_of(mesh)}
        return special

    def profile(self, mesh: str, quantity: str, tau: Any) -> tuple[Any, Any]:  # noqa: ANN401
        """Return a quantity of a mesh at a phase tau and its slope per cycle: the sum of its profiles."""
        value = slope = ca.SX(0)
        for item in self.model.profiles:
            if (item.mesh, item.quantity) == (mesh, quantity):
                level = self.level.get(mesh, ca.SX(0))
                one = evaluate(
                    item.kind, tau, level, self.number[VARYING], [self.number[name] for name in item.numbers]
                )
                value, slope = value + one[0], slope + one[1]
        return value, slope

    def mesh_phase_of(self, mesh: str) -> Any:  # noqa: ANN401
        """Return the phase tau [cycles] of a mesh by the rigid motion."""
        phase = next((phase for phase in self.model.phases if phase.name == mesh), None)
        if phase is None:
            return ca.SX(0)
        return self._rigid_cycles(phase) + self.number[phase.start]

    def _rigid_cycles(self, phase: Phase) -> Any:  # noqa: ANN401
        """Return the tooth pitches [cycles] that have gone by in the rigid motion."""
        if phase.rate is not None:
            return self.number[phase.rate] * self.phi
        body = self.bodies[phase.gear]
        frame = self.model.frames[body.frame]
        return (
            self.number[phase.teeth] / (2 * pi) * (self.ratio(body) - (self.number[frame] if frame else 0)) * self.phi
        )

    def mesh_rate_of(self, mesh: str) -> Any:  # noqa: ANN401
        """Return the rate [1/s] of a mesh's phase."""
        rate = next((phase.rate for phase in self.model.phases if phase.name == mesh), None)
        return ca.SX(0) if rate is None else self.number[rate] * self.speed

    def _followed(self, instance: Instance, rolling: Any) -> tuple[Any, Any]:  # noqa: ANN401
        """Return a mesh's stiffness and its slope where the phase is that of gear 1's own motion."""
        mesh = instance.name.removesuffix(BACK)
        phase = next(phase for phase in self.model.phases if phase.name == mesh)
        return self.profile(mesh, "stiffness", self._gear_phase(phase, rolling))

    def _gear_phase(self, phase: Phase, rolling: Any) -> Any:  # noqa: ANN401
        """Return the phase [cycles] of gear 1's own motion from its rolling angle, which inertial axes hold whole."""
        own = self.number[phase.rolled] + self.number[phase.teeth] / (2 * pi) * rolling
        return self._rigid_cycles(phase) + own if self.basis == "frame" else own

    def equations(self) -> Equations:
        """Sum everything up."""
        results = [(instance, self.call(instance)) for instance in self.model.instances]
        forces = {name: ca.SX.zeros(3) for name in self.bodies}
        for instance, result in results:
            for i, name in enumerate(instance.bodies):
                forces[name] = forces[name] + self._load(instance, result, i)
        carried = Joints(self).carry(forces)
        self.forces = Joints(self).turned_about_mass(carried)
        reports = list(self._reports(results, self.forces))
        borders = {i.bind["hold"]: result["out_border"] for i, result in results if "out_border" in result}
        return Equations(
            self.x, self.s, self.p, self.states, tuple(self.level),
            tuple((q.name, q.unit) for q in self.model.parameters),
            self._right_hand_side(self.forces), tuple(report for report, _ in reports),
            ca.vertcat(*(value for _, value in reports)), self._phases(), tuple(borders),
            ca.vertcat(*borders.values()), self._energy(results, self.forces), forces, carried,
            {b.name: self.position(b) for b in self.model.bodies},
            {b.name: self.angle(b) for b in self.model.bodies},
        )  # fmt: skip

    @staticmethod
    def _load(instance: Instance, result: dict[str, Any], number: int) -> ca.SX:
        """Return force and torque that an element puts on the port of a number."""
        element = make(instance.element)
        loads = dict(zip(element.freedoms, ca.vertsplit(result["force"]), strict=True))
        load: ca.SX = ca.vertcat(*(loads.get((element.ports[number], axis), ca.SX(0)) for axis in PLANE))
        return load

    def _reference_acceleration(self, forces: dict[str, ca.SX]) -> Any:  # noqa: ANN401
        """Return phi'': zero for a held speed, a signal for one over time, else the reference member's own."""
        for body in self.model.bodies:
            if body.turning == "reference":
                return forces[body.name][2] / Joints(self).inertia(body)
        return self.number.get("reference.acceleration", ca.SX(0))

    def _drive_torque(self, body: Body) -> Any:  # noqa: ANN401
        """Return the torque that holds a body's speed: against what acts on it, and for its acceleration."""
        own = Joints(self).inertia(body) * self.ratio(body) * self._reference_acceleration(self.forces)
        return own - self.forces[body.name][2]

    def _right_hand_side(self, forces: dict[str, ca.SX]) -> ca.SX:
        """Return x' in the order of the states."""
        phi_dd = self._reference_acceleration(forces)
        rate = {"reference.angle": self.speed, "reference.speed": phi_dd}
        for body in self.model.bodies:
            acceleration = self._acceleration(body, forces[body.name], phi_dd)
            for axis in self.axes(body):
                rate[f"{body.name}.{axis}"] = self.value[f"{body.name}.{axis}.rate"]
                rate[f"{body.name}.{axis}.rate"] = acceleration[f"a{axis}"]
        right: ca.SX = ca.vertcat(*(rate[state.name] for state in self.states))
        return right

    def _acceleration(self, body: Body, force: ca.SX, phi_dd: Any) -> dict[str, Any]:  # noqa: ANN401
        """Return a body's accelerations in its frame."""
        (x, y, _), (vx, vy, _) = self.motion(body)
        ratio = self.model.frames[body.frame]
        fx, fy = force[0], force[1]
        if body.moment is not None:
            fx, fy = Joints(self).unbalance(body, fx, fy, self._spin(body, phi_dd))
        given = {
            "x": x, "y": y, "vx": vx, "vy": vy, "fx": fx, "fy": fy, "torque": force[2],
            "m": self.number.get(body.mass or "", ca.SX(1)),
            "inertia": Joints(self).inertia(body) if body.inertia else ca.SX(1), "ratio": self.ratio(body),
            "frame_ratio": self.number[ratio] if ratio else ca.SX(0), "phi_d": self.speed, "phi_dd": phi_dd,
        }  # fmt: skip
        result: dict[str, Any] = body_function(self.derivation)(**given)
        return result

    def _spin(self, body: Body, phi_dd: Any) -> Any:  # noqa: ANN401
        """Return a body's absolute angular acceleration."""
        lead = self.bodies[body.leader or body.name]
        rigid = self.ratio(body) * phi_dd
        if lead.turning != "free":
            return rigid
        return rigid + self.forces[lead.name][2] / Joints(self).inertia(lead) - self.ratio(lead) * phi_dd

    def _reports(
        self, results: list[tuple[Instance, dict[str, Any]]], forces: dict[str, ca.SX]
    ) -> Iterator[tuple[Report, Any]]:
        """List the outputs: of elements, of mesh phases, of bodies."""
        rolling: dict[str, tuple[Any, bool]] = {}
        for instance, result in results:
            element = make(instance.element)
            if "force_x" in element.outputs:
                beta, _ = self.frame_turn(self.bodies[instance.bodies[-1]])
                result["out_force_x"], result["out_force_y"] = rotate(
                    beta, result["out_force_x"], result["out_force_y"]
                )
            for name, output in element.outputs.items():
                if output.quantity:
                    axis = output.axis.name if output.axis else ""
                    yield (
                        Report(output.quantity, instance.item, output.unit, element.joins, axis),
                        result[f"out_{name}"],
                    )
            if "out_rolling" in result:
                rolling[instance.name] = result["out_rolling"], SLOPE in instance.bind.values()
        for phase in self.model.phases:
            if phase.name in rolling:
                yield from self._phase_reports(phase, *rolling[phase.name])
        for body in self.model.bodies:
            yield from self._body_reports(body, forces[body.name])

    def _phase_reports(self, phase: Phase, rolling: Any, by_gear: bool) -> Iterator[tuple[Report, Any]]:  # noqa: ANN401
        """List the phase by which a mesh's stiffness varies, and that of gear 1's own motion."""
        own = self._gear_phase(phase, rolling)
        yield Report("mesh_phase", phase.name, "", "mesh"), own if by_gear else self.mesh_phase_of(phase.name)
        yield Report("gear_phase", phase.name, "", "mesh"), own

    def _body_reports(self, body: Body, force: ca.SX) -> Iterator[tuple[Report, Any]]:
        """List what a body shows: acceleration and displacement, speed and twist, the torque that drives it."""
        if body.lateral:
            beta, _ = self.frame_turn(body)
            mass = self.number[body.mass or ""]
            fx, fy = force[0], force[1]
            if body.moment is not None:
                fx, fy = Joints(self).unbalance(
                    body, fx, fy, self._spin(body, self._reference_acceleration(self.forces))
                )
            for axis, value in zip("xy", rotate(beta, fx / mass, fy / mass), strict=True):
                yield Report(f"acceleration_{axis}", body.name, "m/s^2", "member", axis), value
            for axis, value in zip("xy", self.velocity(body), strict=True):
                yield Report(f"velocity_{axis}", body.name, "m/s", "member", axis), value
            for axis in "xy":
                yield Report(f"displacement_{axis}", body.name, "m", "member", axis), self.value[f"{body.name}.{axis}"]
        if self.bodies[body.leader or body.name].turning != "held" and body.turning != "point":
            deviation, rate = self.twist(body)
            yield Report("speed", body.name, "rad/s", "rotor"), self.ratio(body) * self.speed + rate
            yield Report("twist", body.name, "rad", "rotor"), deviation
            turning = self._spin(body, self._reference_acceleration(self.forces))
            yield Report("angular_acceleration", body.name, "rad/s^2", "rotor"), turning
        if body.turning == "driven":
            yield Report("drive_torque", body.name, "N*m", "drive"), self._drive_torque(body)

    def _phases(self) -> tuple[ca.SX, ca.SX, ca.SX]:
        """Return phase, phase rate and share of single contact of every level (eqs 9-11)."""
        zero = ca.SX(0)
        rates = [self.number[level.rate] if level.rate else zero for level in self.model.levels]
        starts = [self.number[level.start] for level in self.model.levels]
        tau = [rate * self.phi + start for rate, start in zip(rates, starts, strict=True)]
        return (
            ca.vertcat(*tau),
            ca.vertcat(*(rate * self.speed for rate in rates)),
            ca.vertcat(*(self.number[level.share] for level in self.model.levels)),
        )

    def _energy(self, results: list[tuple[Instance, dict[str, Any]]], forces: dict[str, ca.SX]) -> ca.SX:
        """Return kinetic and strain energy, that of weight, power put in by loads and drives, power lost."""
        kinetic = strain = weight = given = lost = ca.SX(0)
        for body in self.model.bodies:
            _, (vx, vy, w) = self.port(body, "absolute")
            if body.lateral:
                kinetic += self.number[body.mass or ""] * (vx**2 + vy**2) / 2
            if body.moment is not None:
                sx, sy = Joints(self).moment(body)
                kinetic += w * (vy * sx - vx * sy)
            if body.inertia is not None:
                kinetic += self.number[body.inertia] * w**2 / 2
            if body.turning == "driven":
                given += self._drive_torque(body) * w
        for instance, result in results:
            if make(instance.element).load:
                _, (_, _, w) = self.port(self.bodies[instance.bodies[0]], "absolute")
                given += self._load(instance, result, 0)[2] * w
            elif instance.group == "gravity":
                weight += result["potential"]
            else:
                strain += result["potential"]
                lost += self._loss(instance, result)
                if instance.group == "mesh":
                    put_in, booked = self._parametric(instance, result)
                    given, lost = given + put_in, lost - booked
        return ca.vertcat(kinetic, strain, weight, given, lost)

    def _loss(self, instance: Instance, result: dict[str, Any]) -> Any:  # noqa: ANN401
        """Return the power that an element takes; one that sees deviations works against the rigid motion too."""
        if make(instance.element).rates != "deviation":
            return result["loss"]
        body = self.bodies[instance.bodies[0]]
        return -ca.dot(self._load(instance, result, 0), ca.vertcat(*self.port(body, "absolute")[1]))

    def _parametric(self, instance: Instance, result: dict[str, Any]) -> tuple[Any, Any]:
        """Return the power [W] put in by stiffness and errors that vary with the nominal phase.

        The second value is the part of it that the damper's loss, taken by the bodies' motion alone, counts too.
        """
        special, power, booked = self._special(instance), ca.SX(0), ca.SX(0)
        used = set(instance.bind.values())
        if STIFFNESS in used and SLOPE not in used:
            slope = special[SLOPE] * self.mesh_rate_of(instance.name.removesuffix(BACK))
            power += result["potential"] / special[STIFFNESS] * slope
        if ERROR in used:
            power -= result["out_force"] * special[ERROR_RATE]
            booked = result["out_damper"] * special[ERROR_RATE]
        return power, booked


def _along(axes: Iterable[Axis], values: Sequence[Any]) -> list[Any]:
    """Return the values of some axes, out of those of all."""
    return [values[PLANE.index(axis)] for axis in axes]
