r"""Check of physical laws that every element must obey, at seeded random states.

Forces of springs and weights are minus the gradient of their energy. Forces and moments between two bodies cancel.
Dampers and friction dissipate power, equal to the reported loss. Every formula is dimensionally homogeneous: scaled
lengths, masses and times scale each quantity by its own unit.
"""

from collections.abc import Mapping, Sequence
from functools import cached_property

import casadi as ca
import numpy as np
import sympy as sp
from numpy.typing import NDArray

from ..elements.axes import PLANE, X, Y
from ..elements.base import Element
from ..elements.contact import Given
from ..elements.element_types import make
from ..mechanics.lower import lower
from ..mechanics.model import ERROR_RATE, TURN, Instance, Model
from ..schema.units import dimension
from .check import Check, Writer, element_types, judged, title

Array = NDArray[np.float64]

STATES, SIZE, RATE, OBLIQUE = 20, 1e-4, 1e-1, 0.7
TOLERANCE, UNIT_TOLERANCE = 1e-10, 1e-9
FACTORS = {"length": 1.7, "mass": 0.6, "time": 1.3}
RESULTS = ("wrench", "potential", "dissipation")
GIVEN = {TURN: 0.0, ERROR_RATE: 0.0}
"""Arguments that are not random: frames at their start, and constant tooth errors, since varying ones supply power."""


def _turned(x: Array, y: Array) -> tuple[Array, Array]:
    """Rotate a position or direction, so that no state has its planet on an axis."""
    cos, sin = np.cos(OBLIQUE), np.sin(OBLIQUE)
    return cos * x - sin * y, sin * x + cos * y


class ElementBench:
    """One element type with random states near its position in the model.

    Parameters
    ----------
    label
        Plain name of the element type.
    element
        The element.
    instance, model
        Source of its parameters and the positions of its bodies.
    """

    def __init__(self, label: str, element: Element, instance: Instance, model: Model) -> None:
        self.label, self.element = label, element
        self.arguments = self._draw(instance, model)

    def _draw(self, instance: Instance, model: Model) -> Array:
        """Draw coordinates, rates and parameters: one row per argument, one column per state."""
        rng = np.random.default_rng(20210611)
        numbers = model.values()
        nominal = [dict(zip((X, Y), model.nominal_place(name), strict=True)) for name in instance.bodies]
        rows = {
            port.coordinate(axis).name: place.get(axis, 0.0) + SIZE * rng.uniform(-1.0, 1.0, STATES)
            for port, place in zip(self.element.ports, nominal, strict=True)
            for axis in PLANE
        }
        rows |= {
            port.rate(axis).name: RATE * rng.uniform(-1.0, 1.0, STATES) for port in self.element.ports for axis in PLANE
        }
        for symbol in self.element.parameters:
            known = (numbers | GIVEN).get(instance.bind[symbol.name])
            rows[symbol.name] = rng.uniform(0.0, 1.0, STATES) if known is None else np.full(STATES, known)
        pairs = [(port.x.name, port.y.name) for port in self.element.ports] + [("e_x", "e_y"), ("x_0", "y_0")]
        for x, y in pairs:
            if x in rows:
                rows[x], rows[y] = _turned(rows[x], rows[y])
        return np.array([rows[symbol.name] for symbol in self.element.arguments])

    @cached_property
    def function(self) -> ca.Function:
        """Lower all expressions used by the checks."""
        element = self.element
        leaves = {symbol: ca.SX.sym(symbol.name) for symbol in element.arguments}
        reports = [output.expression for output in element.outputs.values()]
        start, potential = sp.Symbol("z_0"), element.potential
        given = list(potential.atoms(Given))
        for item in given:  # beside where it stands, it follows its slope
            potential = potential.subs(item, item.args[1] + item.args[2] * (item.args[0] - start))
        here = leaves | {start: ca.SX.sym("z_0")}
        values = lower([*element.loads, potential, element.dissipation, *reports], here)
        wrench, (potential, dissipation, *rest) = (
            ca.vertcat(*values[: len(element.loads)]),
            values[len(element.loads) :],
        )
        q = ca.vertcat(*(leaves[symbol] for symbol in element.coordinates))
        v = ca.vertcat(*(leaves[symbol] for symbol in element.velocities))
        gradient, loss = ca.gradient(potential, q), ca.dot(ca.gradient(dissipation, v), v)
        if given:
            place = lower([given[0].args[0]], leaves)[0]
            gradient, potential = ca.substitute([gradient, potential], [here[start]], [place])
        return ca.Function(
            "bench", [ca.vertcat(*leaves.values())],
            [wrench, potential, dissipation, ca.vertcat(*rest), gradient, loss],
            ["arguments"], [*RESULTS, "outputs", "gradient", "loss"],
        )  # fmt: skip

    def values(self, arguments: Array | None = None) -> dict[str, Array]:
        """Evaluate at the bench's states, or at given ones; each result has one column per state."""
        columns = self.arguments if arguments is None else arguments
        found = [self.function(arguments=column) for column in columns.T]
        return {name: np.hstack([np.asarray(one[name]).reshape(-1, 1) for one in found]) for name in found[0]}

    def on_bodies(self, rows: Array) -> list[Array]:
        """Return, for each axis of the plane, the rows of all bodies from those of all ports, zeros included."""
        known = dict(zip(self.element.freedoms, rows, strict=False))
        nothing = np.zeros(STATES)
        return [np.array([known.get((port, axis), nothing) for port in self.element.ports]) for axis in PLANE]

    @property
    def resting(self) -> Array:
        """Return the states with zero velocities."""
        still = self.arguments.copy()
        count = len(self.element.coordinates)
        still[count : 2 * count] = 0.0
        return still

    @property
    def velocities(self) -> Array:
        """Return the rates of all ports."""
        count = len(self.element.coordinates)
        return self.arguments[count : 2 * count]


def relative(difference: Array, *parts: Array) -> float:
    """Return the largest difference over the largest of the parts, row by row; infinite if not finite."""
    if not np.isfinite(difference).all():
        return float("inf")
    size = np.max([np.abs(part).max(axis=1) for part in parts], axis=0)
    largest = np.abs(difference).max(axis=1)
    return float(np.max(np.divide(largest, size, out=np.where(largest > 0, np.inf, 0.0), where=size > 0), initial=0.0))


def conservative_force(bench: ElementBench) -> Check:
    """Check that the force at rest is minus the gradient of the potential energy (by CasADi)."""
    at_rest = bench.values(bench.resting)
    value = relative(at_rest["wrench"] + at_rest["gradient"], at_rest["wrench"], at_rest["gradient"])
    note = f"wrench at rest against -grad V by automatic differentiation, {STATES} random states"
    return judged(f"{bench.label}: force is the slope of the energy", value, TOLERANCE, note)


def action_and_reaction(bench: ElementBench) -> list[Check]:
    """Check that the forces between the bodies of an element are equal and opposite, along the same line."""
    fx, fy, torque = bench.on_bodies(bench.values()["wrench"])
    x, y, _ = bench.on_bodies(bench.arguments)
    pole = np.random.default_rng(1).uniform(-1.0, 1.0, (2, STATES)) * np.abs(np.vstack([x, y])).max()
    x, y = x - pole[0], y - pole[1]
    push = np.array([fx.sum(axis=0), fy.sum(axis=0)])
    arms = np.vstack([torque, x * fy - y * fx])
    force = np.max(np.abs(np.vstack([fx, fy])), axis=0, keepdims=True)
    note = f"{STATES} random states; sum over the largest part"
    return [
        judged(f"{bench.label}: action equals reaction", relative(push, force, force), TOLERANCE, note),
        judged(
            f"{bench.label}: moments about any point balance",
            relative(arms.sum(axis=0, keepdims=True), np.max(np.abs(arms), axis=0, keepdims=True)), TOLERANCE, note,
        ),
    ]  # fmt: skip


def dissipated_power(bench: ElementBench) -> list[Check]:
    """Check that the velocity-dependent part of the wrench dissipates power, equal to the reported loss."""
    moving, at_rest = bench.values(), bench.values(bench.resting)
    power = np.sum((moving["wrench"] - at_rest["wrench"]) * bench.velocities, axis=0, keepdims=True)
    parts = np.abs(moving["wrench"] * bench.velocities).max(axis=0, keepdims=True)
    gain = relative(np.maximum(power, 0.0), parts)
    booked = relative(power + moving["loss"], parts)
    note = f"power of the wrench without its part at rest, {STATES} random states; over the largest power in it"
    return [
        judged(f"{bench.label}: never feeds energy", gain, TOLERANCE, note),
        judged(f"{bench.label}: the power it takes is the loss that is booked", booked, TOLERANCE, note),
    ]


def scale_of(unit: str) -> float:
    """Return the scale factor of a quantity when lengths, masses and times are scaled by ``FACTORS``."""
    return float(np.prod([FACTORS[name] ** power for name, power in dimension(unit).items()]))


def result_units(element: Element) -> dict[str, Sequence[str]]:
    """Return the units of an element's results."""
    return {
        "wrench": tuple(axis.load_unit for _, axis in element.freedoms),
        "potential": ("J",),
        "dissipation": ("W",),
        "outputs": tuple(output.unit for output in element.outputs.values()),
    }


def homogeneous(bench: ElementBench) -> Check:
    """Check that every formula is dimensionally homogeneous."""
    element, axes = bench.element, [axis for _, axis in bench.element.freedoms]
    units = [*(axis.unit for axis in axes), *(axis.rate_unit for axis in axes), *element.parameters.values()]
    scales = np.array([[scale_of(unit)] for unit in units])
    plain, scaled = bench.values(), bench.values(bench.arguments * scales)
    worst = 0.0
    for name, its_units in result_units(element).items():
        if its_units:
            expected = plain[name] * np.array([[scale_of(unit)] for unit in its_units])
            worst = max(worst, relative(scaled[name] - expected, *_sizes(expected, its_units)))
    factors = ", ".join(f"{name} x {factor}" for name, factor in FACTORS.items())
    note = f"{factors}: forces, energies and outputs scale by their units; an angle is a number"
    return judged(f"{bench.label}: units are consistent", worst, UNIT_TOLERANCE, note)


def _sizes(expected: Array, units: Sequence[str]) -> tuple[Array]:
    """Return the largest magnitude among rows of one unit, for each row."""
    largest: Mapping[str, float] = {
        unit: max(float(np.abs(row).max()) for row, other in zip(expected, units, strict=True) if other == unit)
        for unit in units
    }
    return (np.array([[largest[unit]] for unit in units]),)


def element_physics(bench: ElementBench) -> list[Check]:
    """Run the checks that apply to one element type."""
    element = bench.element
    checks = []
    if element.gradient and element.potential != 0:
        checks.append(conservative_force(bench))
    if len(element.ports) > 1 and element.closed:
        checks += action_and_reaction(bench)
    if sp.sympify(element.dissipation) != 0 and not element.load:
        checks += dissipated_power(bench)
    return [*checks, homogeneous(bench)]


def physics(model: Model, write: Writer = make) -> list[Check]:
    """Check every element type of a model, with the numbers of its first instance."""
    return [
        check
        for key, instance in element_types(model).items()
        for check in element_physics(ElementBench(title(key), write(key), instance, model))
    ]
