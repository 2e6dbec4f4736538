"""Equations of motion: elements instanced and summed on the bodies, in CasADi (Model -> Equations).

Element types were derived in SymPy; here each instance is one call of its type's function, so the work grows with the
number of gears no faster than the equations themselves.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import casadi as ca
from ltcgear.generated.contract import BACK, VARYING, Report, State

from ..elements.axes import DEVIATIONS
from ..elements.base import Element
from ..elements.element_types import make
from .body_balances import Balances
from .lower import body_function, element_function
from .model import ERROR, SLOPE, STIFFNESS, Body, Instance, Model, Phase, Profile
from .profiles import evaluate


@dataclass(frozen=True)
class Equations:
    """Equations of motion x' = f(x, s, p) and their outputs, as CasADi graphs.

    Attributes
    ----------
    x, s, p
        States, mesh levels (0 single, 1 double contact) with the load signals after them, and parameters.
    states, levels, parameters
        Descriptions of these, in order; parameters as (name, unit).
    xdot
        Right-hand side.
    reports, outputs
        Descriptions of the outputs, and their expressions.
    phases
        Per level: phase tau [cycles], its rate [1/s], share of single contact.
    holds, borders
        Parameters that hold a regime, and the event functions whose zeros are the borders between regimes.
    energy
        Kinetic, strain and gravitational energy [J], input power and power loss [W].
    forces, carried
        Body -> force and torque in its frame: of its elements, and after transfer through rigid joints.
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
        ``newton`` or ``lagrange``: source of the elements' forces and the bodies' accelerations.
    basis
        ``frame`` evaluates elements in the rotating frames (for the C); ``inertial`` in the paper's coordinates, for
        the check that both agree: only ``forces`` are then meaningful.

    Returns
    -------
    Equations
        In a fixed order of states, levels, parameters and outputs.
    """
    return _Graphs(model, derivation, basis).equations()


class _Graphs(Balances):
    """State of one derivation, in CasADi graphs."""

    functions = ca

    def __init__(self, model: Model, derivation: str, basis: str) -> None:
        super().__init__(model)
        self.derivation, self.basis, self.zero = derivation, basis, ca.SX(0)
        self.p = ca.SX.sym("p", len(model.parameters))
        self.numbers = {q.name: self.p[i] for i, q in enumerate(model.parameters)}
        self.s = ca.SX.sym("s", len(model.levels) + len(model.signals))
        self.levels = {level.name: self.s[i] for i, level in enumerate(model.levels)}
        self.numbers |= {signal.name: self.s[len(self.levels) + i] for i, signal in enumerate(model.signals)}
        self.states = tuple(self._states())
        self.x = ca.SX.sym("x", len(self.states))
        self.values = {state.name: self.x[i] for i, state in enumerate(self.states)}

    def _states(self) -> Iterator[State]:
        """List the states: reference angle, deviations, (reference speed), rates of the deviations."""
        lead = self.lead
        if self.model.reference != "rest":
            yield State("reference.angle", "rad", lead.name if lead else "", "theta", "", "reference angle")
        for body, axis in self.moving():
            unit = DEVIATIONS[axis].unit
            yield State(f"{body.name}.{axis}", unit, body.name, axis, _inertia(body, axis), "deviation")
        if lead is not None:
            yield State("reference.speed", "rad/s", lead.name, "theta", lead.inertia or "", "reference speed")
        for body, axis in self.moving():
            unit = DEVIATIONS[axis].rate_unit
            yield State(f"{body.name}.{axis}.rate", unit, body.name, axis, _inertia(body, axis), "rate")

    # --- what the laws are written over

    def state(self, name: str, letter: str) -> ca.SX:
        """Return a state."""
        return self.values[name]

    def number(self, name: str, letter: str) -> ca.SX:
        """Return a parameter or load signal."""
        return self.numbers[name]

    def level(self, mesh: str) -> Any:  # noqa: ANN401
        """Return the level of a mesh."""
        return self.levels.get(mesh, self.zero)

    def one_profile(self, item: Profile, place: int, tau: Any) -> tuple[ca.SX, ca.SX]:  # noqa: ANN401
        """Return the value of a profile at a phase and its slope per cycle."""
        numbers = [self.numbers[name] for name in item.numbers]
        return evaluate(item.kind, tau, self.level(item.mesh), self.numbers[VARYING], numbers)

    def body_law(self, given: dict[str, Any]) -> dict[str, ca.SX]:
        """Return the accelerations of a body by degree of freedom."""
        found: dict[str, Any] = body_function(self.derivation)(**{"m": ca.SX(1), "inertia": ca.SX(1)} | given)
        return {axis: found[f"a{axis}"] for axis in DEVIATIONS}

    def call(self, instance: Instance, tag: str) -> dict[str, Any]:
        """Evaluate one element instance."""
        element = make(instance.element)
        seen = {symbol.name: value for symbol, value in self.seen(element, instance).items()}
        function, bound = element_function(instance.element, self.derivation), self.bound(instance, element, tag)
        if SLOPE in instance.bind.values():
            # The stiffness at gear 1's own rolling angle, which the element itself knows.
            bound |= self.followed(instance, tag, function(**seen | bound)["out_rolling"])
        result: dict[str, Any] = function(**seen | bound)
        return result

    # --- everything

    def equations(self) -> Equations:
        """Assemble the equations."""
        instances = enumerate(self.model.instances, start=1)
        self.results = [(instance, self.call(instance, f"#{number}")) for number, instance in instances]
        self.sum_up((instance, self._loads(instance, result)) for instance, result in self.results)
        reports, rates = list(self._reports()), self.rates()
        borders = {i.bind["hold"]: result["out_border"] for i, result in self.results if "out_border" in result}
        return Equations(
            self.x, self.s, self.p, self.states, tuple(self.levels),
            tuple((q.name, q.unit) for q in self.model.parameters),
            ca.vertcat(*(rates[state.name] for state in self.states)), tuple(report for report, _ in reports),
            ca.vertcat(*(value for _, value in reports)), self._phases(), tuple(borders),
            ca.vertcat(*borders.values()), self._energy(),
            _columns(self.acting), _columns(self.carried),
            _columns({b.name: self.ground(b)[0] for b in self.model.bodies}),
            {b.name: self.angle(b) for b in self.model.bodies},
        )  # fmt: skip

    def _loads(self, instance: Instance, result: dict[str, Any]) -> list[list[ca.SX]]:
        """Return force and torque of an element on each of its ports."""
        return self.on_ports(make(instance.element), ca.vertsplit(result["force"]))

    # --- outputs

    def _reports(self) -> Iterator[tuple[Report, Any]]:
        """List the outputs: of elements, of mesh phases, of bodies."""
        rolling: dict[str, tuple[str, Any, bool]] = {}
        for number, (instance, result) in enumerate(self.results, start=1):
            yield from self._element_reports(instance, make(instance.element), result)
            if "out_rolling" in result:
                rolling[instance.name] = f"#{number}", result["out_rolling"], SLOPE in instance.bind.values()
        for phase in self.model.phases:
            if phase.name in rolling:
                yield from self._phase_reports(phase, *rolling[phase.name])
        for body in self.model.bodies:
            yield from self._shift_reports(body)
            yield from self._turn_reports(body)

    def _element_reports(
        self, instance: Instance, element: Element, result: dict[str, Any]
    ) -> Iterator[tuple[Report, Any]]:
        """List the outputs of an element, components of a force in inertial axes."""
        turned = {}
        if "force_x" in element.outputs:
            beta, _ = self.frame_turn(self.bodies[instance.bodies[-1]])
            turned = dict(zip("xy", self.rotate(beta, result["out_force_x"], result["out_force_y"]), strict=True))
        for name, output in element.outputs.items():
            axis = output.axis.name if output.axis else ""
            if output.quantity:
                value = turned[axis] if axis else result[f"out_{name}"]
                yield Report(output.quantity, instance.item, output.unit, element.joins, axis), value

    def _phase_reports(self, phase: Phase, tag: str, rolling: Any, by_gear: bool) -> Iterator[tuple[Report, Any]]:  # noqa: ANN401
        """List the phase of a mesh's stiffness, and that of gear 1's own motion."""
        own = self.gear_phase(phase, rolling, tag)
        yield Report("mesh_phase", phase.name, "", "mesh"), own if by_gear else self.phase_of(phase.name)
        yield Report("gear_phase", phase.name, "", "mesh"), own

    def _shift_reports(self, body: Body) -> Iterator[tuple[Report, Any]]:
        """List acceleration, velocity and displacement of a body with lateral motion."""
        if body.lateral:
            beta, _ = self.frame_turn(body)
            mass, (fx, fy) = self.mass(body), self.push(body)
            for axis, value in zip("xy", self.rotate(beta, fx / mass, fy / mass), strict=True):
                yield Report(f"acceleration_{axis}", body.name, "m/s^2", "member", axis), value
            for axis, value in zip("xy", self.ground(body)[1], strict=False):
                yield Report(f"velocity_{axis}", body.name, "m/s", "member", axis), value
            for axis in "xy":
                place = self.coordinate(body, axis)[0]
                yield Report(f"displacement_{axis}", body.name, "m", "member", axis), place

    def _turn_reports(self, body: Body) -> Iterator[tuple[Report, Any]]:
        """List speed, twist and angular acceleration of a body, and its drive torque."""
        if self.bodies[body.leader or body.name].turning != "held" and body.turning != "point":
            deviation, rate = self.twist(body)
            yield Report("speed", body.name, "rad/s", "rotor"), self.ratio(body.ratio) * self.speed + rate
            yield Report("twist", body.name, "rad", "rotor"), deviation
            yield Report("angular_acceleration", body.name, "rad/s^2", "rotor"), self.spin(body)
        if body.turning == "driven":
            yield Report("drive_torque", body.name, "N*m", "drive"), self.drive_torque(body)

    def _phases(self) -> tuple[ca.SX, ca.SX, ca.SX]:
        """Return phase, phase rate and share of single contact of every level (eqs 9-11)."""
        rates = [self.numbers[level.rate] if level.rate else self.zero for level in self.model.levels]
        starts = [self.numbers[level.start] for level in self.model.levels]
        tau = [rate * self.phi + start for rate, start in zip(rates, starts, strict=True)]
        return (
            ca.vertcat(*tau),
            ca.vertcat(*(rate * self.speed for rate in rates)),
            ca.vertcat(*(self.numbers[level.share] for level in self.model.levels)),
        )

    # --- energy

    def _energy(self) -> Any:  # noqa: ANN401
        """Return kinetic, strain and gravitational energy, input power of loads and drives, power loss."""
        kinetic = strain = weight = given = lost = self.zero
        for body in self.model.bodies:
            _, (vx, vy, w) = self.port(body, "absolute")
            if body.lateral:
                kinetic += self.mass(body) * (vx**2 + vy**2) / 2
            if body.moment is not None:
                sx, sy = self.moment(body)
                kinetic += w * (vy * sx - vx * sy)
            if body.inertia is not None:
                kinetic += self.numbers[body.inertia] * w**2 / 2
            if body.turning == "driven":
                given += self.drive_torque(body) * w
        for instance, result in self.results:
            if make(instance.element).load:
                given += self._power(instance, result)
            elif instance.group == "gravity":
                weight += result["potential"]
            else:
                strain += result["potential"]
                lost += self._loss(instance, result)
                if instance.group == "mesh":
                    put_in, booked = self._parametric(instance, result)
                    given, lost = given + put_in, lost - booked
        return ca.vertcat(kinetic, strain, weight, given, lost)

    def _power(self, instance: Instance, result: dict[str, Any]) -> Any:  # noqa: ANN401
        """Return the power of an element on its one body, by the body's motion relative to the ground."""
        rates = self.port(self.bodies[instance.bodies[0]], "absolute")[1]
        return ca.dot(ca.vertcat(*self._loads(instance, result)[0]), ca.vertcat(*rates))

    def _loss(self, instance: Instance, result: dict[str, Any]) -> Any:  # noqa: ANN401
        """Return the power lost in an element; one on deviations also does work against the rigid motion."""
        return -self._power(instance, result) if make(instance.element).rates == "deviation" else result["loss"]

    def _parametric(self, instance: Instance, result: dict[str, Any]) -> tuple[Any, Any]:
        """Return the input power [W] of stiffness and errors that vary with the nominal phase.

        The second value is the part already included in the damper's loss, which uses the bodies' motion alone.
        """
        power = booked = self.zero
        mesh, used = instance.name.removesuffix(BACK), set(instance.bind.values())
        if STIFFNESS in used and SLOPE not in used:
            stiffness, slope = self.stiffness(mesh)
            power += result["potential"] / stiffness * (slope * self.phase_rate(mesh))
        if ERROR in used:
            power -= result["out_force"] * self.error_rate(instance)
            booked = result["out_damper"] * self.error_rate(instance)
        return power, booked


def _columns(vectors: dict[str, list[Any]]) -> dict[str, Any]:
    """Return vectors as columns."""
    return {name: ca.vertcat(*vector) for name, vector in vectors.items()}


def _inertia(body: Body, axis: str) -> str:
    """Return the parameter that is the inertia along an axis."""
    return (body.inertia if DEVIATIONS[axis].rotation else body.mass) or ""
