"""Reasons of a failed integration: gears that came too close, members that run away."""

import numpy as np
from numpy.typing import NDArray

from ..model.contact_levels import levels_of
from ..model.function import Kernel
from .driver import March

Vector = NDArray[np.float64]
CLOSE = 0.05
"""Pressure angle [rad] below which base circles count as nearly touching."""
FAR = 1e4
"""Multiple of the vibration scale above which a motion counts as diverging."""

STEP, MOST_STEPS = 0.3, 50_000
"""Phase angle [rad] of the fastest motion in a step of the run-up to the failure, and the most such steps."""


def explain(march: March) -> str:
    """Return why an integration cannot continue from its state, and the cure; empty if unknown."""
    x, s = _last_state(march)
    library, p = march.library, march.p
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
    far = np.abs((x - march.frame.origin) / march.frame.scale)[position]
    if far.max() > FAR:
        state = library.manifest.states[position[int(far.argmax())]]
        return f"{state.body} ({state.axis}) runs away, {far.max():.0e} times the size of vibrations; check its loads"
    return ""


def _last_state(march: March) -> tuple[Vector, Vector]:
    """Return the last state and levels with signals that can be computed, by small steps of classical Runge-Kutta."""
    rhs = Kernel(march.library.functions["rhs"])
    rest, slope = np.zeros(len(march.cells)), march.signals.rate(march.time)
    s, rate = np.concatenate([levels_of(march.cells), march.signals.at(march.time)]), np.concatenate([rest, slope])
    x, h = march.frame.origin + march.frame.scale * march.z, STEP / march.point.fastest
    for _ in range(min(int(march.state.longest / h), MOST_STEPS)):
        one = rhs(x, s, march.p)[0].copy()
        two = rhs(x + h / 2 * one, s + h / 2 * rate, march.p)[0].copy()
        three = rhs(x + h / 2 * two, s + h / 2 * rate, march.p)[0].copy()
        four = rhs(x + h * three, s + h * rate, march.p)[0]
        after = x + h / 6 * (one + 2 * two + 2 * three + four)
        if not (np.isfinite(after).all() and np.isfinite(rhs(after, s + h * rate, march.p)[0]).all()):
            break
        x, s = after, s + h * rate
    return x, s
