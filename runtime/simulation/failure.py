"""Reasons of a failed integration: gears that came too close, members that run away."""

import numpy as np
from numpy.typing import NDArray

from ..model.function import Kernel
from ..model.library import Library
from .smooth_arc import Frame

Vector = NDArray[np.float64]
CLOSE = 0.05
"""Pressure angle [rad] below which base circles count as nearly touching."""
FAR = 1e4
"""Multiple of the vibration scale above which a motion counts as diverging."""

STEP, MOST_STEPS = 0.3, 50_000
"""Phase angle [rad] of the fastest motion in a step of the run-up to the failure, and the most such steps."""


def explain(library: Library, p: Vector, frame: Frame, x: Vector, s: Vector) -> str:
    """Say why an integration cannot go on from a state, and what to do; empty where that is not plain.

    Shapes as the library's functions take them; ``s`` are levels and signals.
    """
    values = Kernel(library.functions["outputs"])(x, s, p)[0]
    angles = [
        (value, report.item)
        for value, report in zip(values, library.manifest.reports, strict=True)
        if report.quantity == "pressure_angle" and not value > CLOSE
    ]
    if angles:
        return (
            f"the gears of {min(angles)[1]} come so close that their base circles touch, beyond which no teeth mesh; "
            "check the stiffness of their bearings, the loads and contact (bilateral teeth pull)"
        )
    position = library.index("")
    far = np.abs((x - frame.origin) / frame.scale)[position]
    if far.max() > FAR:
        state = library.manifest.states[position[int(far.argmax())]]
        return f"{state.body} ({state.axis}) runs away, {far.max():.0e} times the size of vibrations; check its loads"
    return ""


def last_state(
    rhs: Kernel, p: Vector, x: Vector, s: Vector, slope: Vector, fastest: float, duration: float
) -> tuple[Vector, Vector]:
    """Return the last state that can be computed, with its levels and signals, by the classical Runge-Kutta method.

    Parameters
    ----------
    rhs
        The right-hand side.
    p, x, s, slope
        Parameters, state, levels and signals, and the rates of these.
    fastest
        The fastest motion [rad/s], which steps resolve.
    duration
        Time to go at most [s].
    """
    h = STEP / fastest
    for _ in range(min(int(duration / h), MOST_STEPS)):
        one = rhs(x, s, p)[0].copy()
        two = rhs(x + h / 2 * one, s + h / 2 * slope, p)[0].copy()
        three = rhs(x + h / 2 * two, s + h / 2 * slope, p)[0].copy()
        four = rhs(x + h * three, s + h * slope, p)[0]
        after = x + h / 6 * (one + 2 * two + 2 * three + four)
        if not (np.isfinite(after).all() and np.isfinite(rhs(after, s + h * slope, p)[0]).all()):
            break
        x, s = after, s + h * slope
    return x, s
