r"""Check of the derivations: several routes give the same right-hand side; run before every emission.

At seeded random states, accelerations from the energies are compared with those from the hand-written wrenches. Results
in the rotating frames are compared with the paper's inertial coordinates: forces rotated from one basis into the other,
and the rates of inertial momentum and angular momentum against the forces.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from ..elements.element_types import make
from ..mechanics import lagrange
from ..mechanics.equations import Equations, derive
from ..mechanics.frames import FrameMotion, rotate
from ..mechanics.model import Model
from .check import Check, judged
from .nominal import at_nominal
from .zero import vanishing

Array = NDArray[np.float64]

STATES, TOLERANCE = 20, 1e-10
SIZE, RATE, ANGLE, TURN = 1e-4, 1e-1, 50.0, 1.0
"""Deviations [m or rad], rates [m/s or rad/s], reference angle [rad]; angle of the fastest member [rad]."""


@dataclass(frozen=True)
class ComparedPoints:
    """Points of comparison: columns of states, levels and load signals, and parameters."""

    x: Array
    s: Array
    p: Array


def random_points(model: Model, equations: Equations, angle: float, size: float = 1.0) -> ComparedPoints:
    """Draw states with seeded random numbers.

    Parameters
    ----------
    model, equations
        Sources of the numbers and the order of states.
    angle
        Largest reference angle [rad].
    size
        Factor on all deviations and their rates.
    """
    rng = np.random.default_rng(20210611)
    draws = rng.uniform(-1.0, 1.0, (len(equations.states), STATES))
    values = model.values()
    for row, state in zip(draws, equations.states, strict=True):
        if state.name == "reference.angle":
            row *= angle
        elif state.name == "reference.speed":
            row[:] = values["reference.speed"] * (1.0 + 0.1 * row)
        else:
            row *= size * (RATE if state.name.endswith(".rate") else SIZE)
    levels = rng.uniform(0.0, 1.0, (len(equations.levels), STATES))
    signals = rng.uniform(-1.0, 1.0, (len(model.signals), STATES)) * signal_sizes(model)[:, None]
    numbers = np.repeat(np.array([list(values.values())]).T, STATES, axis=1)
    return ComparedPoints(draws, np.vstack([levels, signals]), numbers)


def signal_sizes(model: Model) -> Array:
    """Return the largest value of every load signal."""
    sizes = []
    for signal in model.signals:
        time, value = np.array(model.tables[signal.table]).T
        sizes.append(np.abs(np.diff(value) / np.diff(time) if signal.slope else value).max())
    return np.array(sizes, dtype=np.float64)


def evaluate(equations: Equations, expression: Any, points: ComparedPoints) -> Array:  # noqa: ANN401
    """Evaluate an expression of some equations at all points, shape (rows, points)."""
    function = ca.Function("values", [equations.x, equations.s, equations.p], [expression])
    columns = zip(points.x.T, points.s.T, points.p.T, strict=True)
    return np.array([np.asarray(function(x, s, p)).ravel() for x, s, p in columns]).T


def largest_difference(one: Array, two: Array) -> float:
    """Return the largest difference relative to the row's largest value; infinite if not finite.

    A row much smaller than the others is compared with a millionth of the largest, since it may be rounding.
    """
    if one.size == 0:
        return 0.0
    if not (np.isfinite(one).all() and np.isfinite(two).all()):
        return float("inf")
    size = np.maximum(np.abs(one), np.abs(two)).max(axis=1)
    size = np.maximum(size, 1e-6 * size.max())
    difference = np.abs(one - two).max(axis=1)
    return float(np.max(np.divide(difference, size, out=np.zeros_like(size), where=size > 0)))


def agreement(model: Model, equations: Equations) -> list[Check]:
    """Check the equations of a model before anything is emitted.

    Parameters
    ----------
    model
        The model.
    equations
        The equations under test (``derive(model)``).

    Returns
    -------
    list of Check
        Quick checks only; ``check_model`` runs all.
    """
    return [
        frame_accelerations(),
        *energies_and_forces(model, equations),
        *coordinates(model, equations),
    ]


def frame_accelerations(rows: Sequence[Any] | None = None) -> Check:
    """Prove a body's accelerations in a rotating frame: from its kinetic energy, and by hand (``rows``)."""
    by_hand = FrameMotion.symbols().newton() if rows is None else rows
    differences = [a - b for a, b in zip(lagrange.frame_accelerations(), by_hand, strict=True)]
    wrong = vanishing(differences).count(False)
    note = "kinetic energy against Coriolis, centrifugal and Euler terms by hand, proven equal symbolically"
    return judged("body in a turning frame: accelerations", wrong, 0.0, note)


# --- energies against forces


def energies_and_forces(model: Model, equations: Equations) -> list[Check]:
    """Compare Lagrange's right-hand side with the given one; meshes with the paper's law to first order."""
    name = "whole model: Lagrange's and Newton's forces and accelerations"
    note = f"{STATES} random states; largest difference over the row's largest value"
    if all(make(instance.element).gradient for instance in model.instances):
        return [judged(name, lagrange_difference(model, equations), TOLERANCE, note)]
    kept = tuple(i for i in model.instances if make(i.element).gradient)
    bare = replace(model, instances=kept)
    note += "; without the meshes, whose law is the paper's and no gradient"
    return [
        judged(name, lagrange_difference(bare, derive(bare)), TOLERANCE, note),
        second_order(model, equations),
    ]


def lagrange_difference(model: Model, equations: Equations) -> float:
    """Return the relative difference of accelerations and of forces on all bodies, including fixed and driven ones."""
    points = random_points(model, equations, ANGLE)
    both = [
        evaluate(item, ca.vertcat(item.xdot, *item.forces.values()), points)
        for item in (equations, derive(model, "lagrange"))
    ]
    return largest_difference(*both)


def second_order(model: Model, equations: Equations) -> Check:
    """Check that the difference for the paper's law is of second order in the deviations."""
    other = derive(model, "lagrange")
    sizes, scale = [], None
    for size in (0.1, 0.01):
        points = random_points(at_nominal(model), equations, ANGLE, size)
        given = evaluate(equations, equations.xdot, points)
        scale = np.abs(given).max(axis=1) if scale is None else scale
        difference = np.abs(given - evaluate(other, other.xdot, points)).max(axis=1)
        sizes.append(float(np.max(difference / np.maximum(scale, 1e-300))))
    large, small = sizes
    ratio = large / small if small > 0 else float("nan")
    note = (
        f"deviations ten times smaller: difference {ratio:.4g} times smaller (100 where forces agree to first order); "
        "the value is the distance of this factor from 100, relative; pins and teeth without errors"
    )
    return judged("whole model: the paper's mesh law, to first order", abs(ratio / 100 - 1), 0.2, note)


# --- turning frames against inertial coordinates


def coordinates(model: Model, equations: Equations) -> list[Check]:
    """Compare the rotating frames with the paper's inertial coordinates."""
    values = model.values()
    fastest = max((abs(values[body.ratio]) for body in model.bodies if body.ratio), default=1.0)
    inertial = derive(model, basis="inertial")
    checks = coordinate_checks(model, equations, inertial, TURN / fastest, "")
    if model.reference == "rest":
        return checks
    return checks + coordinate_checks(model, equations, inertial, ANGLE, " after many turns")


def coordinate_checks(model: Model, equations: Equations, inertial: Equations, angle: float, when: str) -> list[Check]:
    """Compare forces and accelerations at reference angles up to ``angle`` [rad]."""
    points = random_points(model, equations, angle)
    values = model.values()
    fastest = max((abs(values[body.ratio]) for body in model.bodies if body.ratio), default=0.0)
    tolerance = max(TOLERANCE, 4 * np.finfo(float).eps * fastest * angle / SIZE)
    note = f"{STATES} random states, members turned by up to {fastest * angle:.3g} rad"
    if tolerance > TOLERANCE:
        note += "; allowed is the rounding of such an angle over a deflection of 0.1 mm"
    forces = largest_difference(
        evaluate(equations, turned_forces(model, equations), points),
        evaluate(inertial, ca.vertcat(*inertial.forces.values()), points),
    )
    motion = largest_difference(
        evaluate(equations, momentum_rates(model, equations), points),
        evaluate(inertial, momentum_forces(model, inertial), points),
    )
    return [
        judged(f"inertial coordinates{when}: forces are those of the turning frames", forces, tolerance, note),
        judged(
            f"inertial coordinates{when}: momentum changes by the forces",
            motion,
            tolerance,
            note,
        ),
    ]


def turned_forces(model: Model, equations: Equations) -> Any:  # noqa: ANN401
    """Return the forces on all bodies, rotated from their frames into the inertial basis."""
    number = {name: equations.p[i] for i, (name, _) in enumerate(equations.parameters)}
    angle = next((equations.x[i] for i, s in enumerate(equations.states) if s.name == "reference.angle"), 0.0)
    rows = []
    for body in model.bodies:
        ratio = model.frames[body.frame]
        beta = number[ratio] * angle if ratio else ca.SX(0)
        fx, fy, torque = ca.vertsplit(equations.forces[body.name])
        rows += [fx * ca.cos(beta) - fy * ca.sin(beta), fx * ca.sin(beta) + fy * ca.cos(beta), torque]
    return ca.vertcat(*rows)


def momentum_rates(model: Model, equations: Equations) -> Any:  # noqa: ANN401
    """Return the rates of momentum and of angular momentum along the right-hand side, in inertial coordinates.

    Angular momentum is that of a body and of all that share its angle, each about its own centre.
    """
    number = {name: equations.p[i] for i, (name, _) in enumerate(equations.parameters)}

    sdot = signal_rates(model, equations)

    def twice(motion: Any) -> Any:  # noqa: ANN401
        for _ in range(2):
            motion = ca.jtimes(motion, equations.x, equations.xdot) + ca.jtimes(motion, equations.s, sdot)
        return motion

    rates: list[Any] = []
    offsets: dict[str, Any] = {}
    for body in model.bodies:
        if body.moment is not None:
            sx, sy = (number[name] for name in body.moment)
            offsets[body.name] = ca.vertcat(*rotate(equations.angles[body.name], sx, sy, ca))
    for body in model.bodies:
        if body.lateral:
            momentum = number[body.mass or ""] * equations.positions[body.name]
            rates.append(twice(momentum + offsets.get(body.name, 0)))
    for body in model.bodies:
        if body.turning in ("free", "reference"):
            rate = number[body.inertia or ""] * twice(equations.angles[body.name])
            for other in model.bodies:
                if other.name in offsets and body.name in (other.name, other.leader):
                    ax, ay = ca.vertsplit(twice(equations.positions[other.name]))
                    rate += offsets[other.name][0] * ay - offsets[other.name][1] * ax
            rates.append(rate)
    return ca.vertcat(*rates)


def signal_rates(model: Model, equations: Equations) -> Any:  # noqa: ANN401
    """Return the rates of s that affect the motion: those of a reference speed over time."""
    places = {signal.name: len(equations.levels) + i for i, signal in enumerate(model.signals)}
    rates = ca.SX.zeros(*equations.s.shape)
    if "reference.speed" in places:
        rates[places["reference.speed"]] = equations.s[places["reference.acceleration"]]
    return rates


def momentum_forces(model: Model, equations: Equations) -> Any:  # noqa: ANN401
    """Return the forces and torques that change momentum in inertial coordinates, in the same order."""
    lateral = [body for body in model.bodies if body.lateral]
    turning = [body for body in model.bodies if body.turning in ("free", "reference")]
    return ca.vertcat(
        *(equations.carried[body.name][:2] for body in lateral),
        *(equations.carried[body.name][2] for body in turning),
    )
