"""Printed equations of the whole model, from states to accelerations, in computing order.

It is put together from ``model.instances`` and the printed laws alone. Small scenes show it as it stands; of large
ones the book shows the laws once and which element acts on which body.
"""

from dataclasses import dataclass

import sympy as sp
from ltcgear.generated.contract import BACK

from ..elements.axes import PLANE
from ..elements.base import real
from ..mechanics.frames import FrameMotion
from ..mechanics.model import (
    BASIS,
    ERROR,
    ERROR_RATE,
    LEVEL,
    PHASE,
    SLOPE,
    STIFFNESS,
    TURN,
    Body,
    Instance,
    Model,
    Profile,
)
from . import waves
from .laws import Law, write_law
from .motion import Assignment, Leaf, PrintedMotion, rotate


@dataclass(frozen=True)
class PrintedEquations:
    """Equations of motion of a model.

    Attributes
    ----------
    assignments
        Named quantities, each of states, numbers and earlier ones.
    rates
        State -> its rate.
    leaves
        Free symbol -> state, signal, level or parameter of the C.
    terms
        Body -> (number of the element, port) of all that acts on it.
    """

    assignments: tuple[Assignment, ...]
    rates: dict[str, sp.Expr]
    leaves: dict[sp.Expr, Leaf]
    terms: dict[str, tuple[tuple[int, int], ...]]


def list_terms(model: Model) -> dict[str, tuple[tuple[int, int], ...]]:
    """Return body -> (number of the element, from 1, and its port, from 1) of all elements at it."""
    found: dict[str, list[tuple[int, int]]] = {body.name: [] for body in model.bodies}
    for number, instance in enumerate(model.instances, start=1):
        for port, body in enumerate(instance.bodies, start=1):
            found[body].append((number, port))
    return {body: tuple(items) for body, items in found.items()}


def assemble(model: Model) -> PrintedEquations:
    """Write the equations of motion of a model.

    Parameters
    ----------
    model
        The model.
    """
    made = _Writing(model)
    for number, instance in enumerate(model.instances, start=1):
        made.add_element(number, instance)
    made.sum_up()
    rates = made.write_rates()
    return PrintedEquations(tuple(made.assigned), rates, made.leaves, list_terms(model))


class _Writing(PrintedMotion):
    """An assembly under way."""

    def __init__(self, model: Model) -> None:
        super().__init__(model)
        self.wrenches: dict[tuple[int, int], tuple[sp.Expr, ...]] = {}
        self.named: dict[str, sp.Symbol] = {}

    # --- elements

    def add_element(self, number: int, instance: Instance) -> None:
        """Write one element in the coordinates of its bodies."""
        law, owner = write_law(instance.element), str(number)
        rename = self._ports(law, instance)
        rename |= {symbol: self._bound(symbol, instance, number) for symbol in law.element.parameters}
        rename |= {step.symbol: real(f"{step.symbol.name}#{number}") for step in law.steps}
        followed = SLOPE in instance.bind.values()
        names = [step.symbol.name for step in law.steps]
        wait = names.index("psi") + 1 if followed and "psi" in names else 0
        for step in law.steps[:wait]:
            self.name(rename[step.symbol].name, step.value.xreplace(rename), owner)
        if followed:
            self._follow(instance, number, law.outputs["rolling"].xreplace(rename))
        for step in law.steps[wait:]:
            self.name(rename[step.symbol].name, step.value.xreplace(rename), owner)
        wrench = [component.xreplace(rename) for component in law.wrench]
        loads = dict(zip(law.element.freedoms, wrench, strict=True))
        for place, port in enumerate(law.element.ports, start=1):
            self.wrenches[number, place] = tuple(loads.get((port, axis), sp.S.Zero) for axis in PLANE)

    def _ports(self, law: Law, instance: Instance) -> dict[sp.Basic, sp.Expr]:
        """Return what the coordinates and rates of an element's ports are."""
        found: dict[sp.Basic, sp.Expr] = {}
        for port, name in zip(law.element.ports, instance.bodies, strict=True):
            seen = self.port(self.bodies[name], law.element.rates)
            for axis in port.axes:
                place = PLANE.index(axis)
                found |= {port.coordinate(axis): seen[place], port.rate(axis): seen[place + len(PLANE)]}
        return found

    def _bound(self, symbol: sp.Symbol, instance: Instance, number: int) -> sp.Expr:
        """Return what a parameter of an element is."""
        bound, tag = instance.bind[symbol.name], f"#{number}"
        mesh = instance.name.removesuffix(BACK)
        if bound == TURN:
            return sp.S.Zero
        if bound == BASIS:
            return self.frame_turn(self.bodies[instance.bodies[-1]])[0]
        if bound == LEVEL:
            return self.leaf(f"level@{mesh}", Leaf("s", mesh))
        if bound == PHASE:
            return self._phase(mesh)
        if bound in (STIFFNESS, SLOPE) and SLOPE in instance.bind.values():
            return real(symbol.name + tag)
        if bound == STIFFNESS:
            return self._once(f"k@{mesh}", lambda: self._wave(mesh, "stiffness", self._phase(mesh)))
        if bound in (ERROR, ERROR_RATE):
            return self._error(instance, mesh, bound)
        return self.number(symbol.name + tag, bound)

    def _once(self, name: str, value: object) -> sp.Symbol:
        """Name a quantity of a mesh, the first time that it is asked for."""
        assert callable(value)
        if name not in self.named:
            self.named[name] = self.name(name, value(), name.split("@")[1])
        return self.named[name]

    def _phase(self, mesh: str) -> sp.Expr:
        """Return the phase of a mesh."""
        phase = next(phase for phase in self.model.phases if phase.name == mesh)

        def value() -> sp.Expr:
            rate = sp.S.Zero if phase.rate is None else self.number(f"nu@{mesh}", phase.rate)
            return rate * self.phi + self.number(f"tau_0@{mesh}", phase.start)

        return self._once(f"tau@{mesh}", value)

    def _follow(self, instance: Instance, number: int, rolling: sp.Expr) -> None:
        """Write a stiffness, and its slope, at the phase of gear 1's own motion."""
        mesh, tag = instance.name.removesuffix(BACK), f"#{number}"
        phase = next(phase for phase in self.model.phases if phase.name == mesh)
        rate = sp.S.Zero if phase.rate is None else self.number(f"nu@{mesh}", phase.rate)
        start = self.number(f"tau_0{tag}", phase.rolled)
        teeth = self.number(f"z_1{tag}", instance.bind["z_1"])
        tau = self.name(f"tau{tag}", rate * self.phi + start + teeth / (2 * sp.pi) * rolling, str(number))
        value = self._wave(mesh, "stiffness", tau)
        self.name(f"k{tag}", value, str(number))
        self.name(f"k_d{tag}", sp.diff(value, tau), str(number))

    def _wave(self, mesh: str, quantity: str, tau: sp.Expr) -> sp.Expr:
        """Return a quantity of a mesh at a phase: the sum of its profiles."""
        found = [item for item in self.model.profiles if (item.mesh, item.quantity) == (mesh, quantity)]
        return sp.Add(*(self._one_wave(item, i, tau) for i, item in enumerate(found)))

    def _one_wave(self, item: Profile, place: int, tau: sp.Expr) -> sp.Expr:
        """Return one profile in symbols of its own."""
        wave, tag = waves.WAVES[item.kind], f"@{item.mesh}" + f", {item.quantity} {place + 1}" * (place > 0)
        rename: dict[sp.Basic, sp.Expr] = {waves.TAU: tau, waves.COUNT: sp.Integer((len(item.numbers) - 1) // 2)}
        if waves.LEVEL in wave.formula.free_symbols:
            rename[waves.LEVEL] = self.leaf(f"level@{item.mesh}", Leaf("s", item.mesh))
        for base in (waves.COS, waves.SIN):
            own = sp.IndexedBase(f"{base}{tag}" + f" {item.quantity}" * (item.quantity != "stiffness"))
            rename |= {base: own, base.label: own.label}
        for symbol, number in zip(wave.numbers(len(item.numbers)), item.numbers, strict=True):
            if isinstance(symbol, sp.Indexed):
                self.leaves[symbol.xreplace(rename)] = Leaf("p", number)
            else:
                name = f"{symbol.name}{tag}" + f" {item.quantity}" * (item.quantity != "stiffness")
                rename[symbol] = self.leaf(name, Leaf("p", number))
        return wave.formula.xreplace(rename)

    def _error(self, instance: Instance, mesh: str, wanted: str) -> sp.Expr:
        """Return the error of a mesh, or its rate; the other flank sees it with the other sign."""
        sign = -1 if instance.name.endswith(BACK) else 1
        tau = self._phase(mesh)
        wave = self._wave(mesh, "error", tau)
        if wanted == ERROR_RATE:
            rate = next(phase.rate for phase in self.model.phases if phase.name == mesh)
            if rate is None:
                return sp.S.Zero
            speed = self.number(f"nu@{mesh}", rate) * self.phi_d
            return sign * self._once(f"e_d@{mesh}", lambda: speed * sp.diff(wave, tau))
        if instance.group != "mesh":
            return sign * self._once(f"e@{mesh}", lambda: wave)
        turned, opening = (self._wave(mesh, quantity, tau) for quantity in ("turned", "opening"))
        return sign * (self._once(f"e@{mesh}", lambda: wave) + turned) + opening

    # --- bodies

    def _depth(self, body: Body) -> int:
        """Return on how many seats a body sits, one on the other."""
        return 0 if body.seat is None else 1 + self._depth(self.bodies[body.seat])

    def sum_up(self) -> None:
        """Sum up what acts on the bodies, and hand on what rigid joints carry."""
        totals = {name: [sp.S.Zero] * 3 for name in self.bodies}
        for name, terms in list_terms(self.model).items():
            for term in terms:
                totals[name] = [a + b for a, b in zip(totals[name], self.wrenches[term], strict=True)]
        self.force: dict[str, tuple[sp.Expr, ...]] = {}
        order = sorted(self.bodies.values(), key=self._depth, reverse=True)
        for body in order:
            along, across, torque = totals[body.name]
            fx = self.name(f"F_x@{body.name}", along, body.name)
            fy = self.name(f"F_y@{body.name}", across, body.name)
            if body.seat is not None:
                ax, ay = self.arm(body)
                for i, value in enumerate((fx, fy, ax * fy - ay * fx)):
                    totals[body.seat][i] += value
            if body.leader is not None:
                torque = self.name(f"T@{body.name}", torque, body.name)
                totals[body.leader][2] += torque
            self.force[body.name] = (fx, fy, torque)
        self._about_mass(totals)

    def _about_mass(self, totals: dict[str, list[sp.Expr]]) -> None:
        """Put the torque about an offset centre of mass to the rest, and name all torques."""
        for body in self.model.bodies:
            if body.moment is not None:
                sx, sy = self._moment(body)
                fx, fy, _ = self.force[body.name]
                mass = self.number(f"m@{body.name}", body.mass or "")
                totals[body.leader or body.name][2] += (sy * fx - sx * fy) / mass
        for body in self.model.bodies:
            if body.leader is None:
                torque = self.name(f"T@{body.name}", totals[body.name][2], body.name)
                self.force[body.name] = (*self.force[body.name][:2], torque)

    def _moment(self, body: Body) -> tuple[sp.Expr, sp.Expr]:
        """Return mass times offset in the frame, named once."""
        names = f"s_x@{body.name}", f"s_y@{body.name}"
        if names[0] not in self.named:
            turned = rotate(self.turning(body)[0], *self._static(body))
            self.named |= {n: self.name(n, v, body.name) for n, v in zip(names, turned, strict=True)}
        return self.named[names[0]], self.named[names[1]]

    def _static(self, body: Body) -> tuple[sp.Expr, sp.Expr]:
        """Return mass times offset at angle zero."""
        assert body.moment is not None
        return self.number(f"S_x@{body.name}", body.moment[0]), self.number(f"S_y@{body.name}", body.moment[1])

    def _inertia(self, body: Body) -> sp.Expr:
        """Return what resists a body's turning, with all that shares its angle."""
        inertia = self.number(f"I@{body.name}", body.inertia or "")
        for other in self.model.bodies:
            if other.moment is not None and (other.leader or other.name) == body.name:
                sx, sy = self._static(other)
                inertia -= (sx**2 + sy**2) / self.number(f"m@{other.name}", other.mass or "")
        return inertia

    # --- accelerations

    def write_rates(self) -> dict[str, sp.Expr]:
        """Return the rates of all states."""
        rates: dict[str, sp.Expr] = {}
        phi_dd = self._reference()
        if self.model.reference != "rest":
            rates["reference.angle"] = self.phi_d
        if self.lead is not None:
            rates["reference.speed"] = phi_dd
        for body, axis in self.moving():
            rates[f"{body.name}.{axis}"] = self.coordinate(body, axis)[1]
            rates[f"{body.name}.{axis}.rate"] = self._acceleration(body, axis, phi_dd)
        return rates

    def _reference(self) -> sp.Expr:
        """Return the acceleration of the reference."""
        if self.lead is not None:
            return self.name("phi_dd", self.force[self.lead.name][2] / self._inertia(self.lead), self.lead.name)
        signal = "reference.acceleration"
        return self.leaf("phi_dd", Leaf("s", signal)) if signal in self.signals else sp.S.Zero

    def _acceleration(self, body: Body, axis: str, phi_dd: sp.Expr) -> sp.Expr:
        """Return one acceleration of a body by the law of bodies in turning frames."""
        f = FrameMotion.symbols()
        fx, fy, torque = self.force[body.name]
        if body.moment is not None and axis != "u":
            fx, fy = self._unbalanced(body, fx, fy, phi_dd)
        (x, y, _, vx, vy, _), frame = self.motion(body), self.model.frames[body.frame]
        given = {
            f.x: x, f.y: y, f.vx: vx, f.vy: vy, f.fx: fx, f.fy: fy, f.torque: torque,
            f.ratio: self.ratio(body.ratio), f.frame_ratio: self.ratio(frame), f.phi_d: self.phi_d, f.phi_dd: phi_dd,
        }  # fmt: skip
        if axis == "u":
            given[f.inertia] = self._inertia(body)
        else:
            given[f.m] = self.number(f"m@{body.name}", body.mass or "")
        return f.newton()["xyu".index(axis)].xreplace(given)

    def _unbalanced(self, body: Body, fx: sp.Expr, fy: sp.Expr, phi_dd: sp.Expr) -> tuple[sp.Expr, sp.Expr]:
        """Add to a force what the offset mass gives."""
        sx, sy = self._moment(body)
        lead, spin = self.bodies[body.leader or body.name], self.ratio(body.ratio) * phi_dd
        if lead.turning == "free":
            spin += self.force[lead.name][2] / self._inertia(lead) - self.ratio(lead.ratio) * phi_dd
        speed = self.turning(body)[1] + self.frame_turn(body)[1]
        names = f"Omega@{body.name}", f"Omega_d@{body.name}"
        if names[0] not in self.named:
            self.named |= {n: self.name(n, v, body.name) for n, v in zip(names, (speed, spin), strict=True)}
        turn, turn_d = (self.named[name] for name in names)
        return fx + turn**2 * sx + turn_d * sy, fy + turn**2 * sy - turn_d * sx
