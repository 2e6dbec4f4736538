"""Refuse, before anything is integrated, what a method cannot finish."""

import numpy as np
from ltcgear.generated.errors import LtcgearError
from numpy.typing import NDArray

from .equilibrium import Equilibrium, closed, inertias, state_matrix
from .library import Library
from .linear.modes import find_modes
from .linear.system import linearise
from .scaling import vibration_scale

Vector = NDArray[np.float64]
REACH = 3.5
"""Step times |eigenvalue| up to which the explicit Runge-Kutta pair 5(4) of Tsitouras is stable."""
MOST_STEPS = 1e9
"""Steps above which a run is refused: minutes for the smallest scenes, hours for large ones."""


STIFFEST = 5e4
"""Fastest over slowest motion beyond which Adams is refused: held at its bound of stability for so long, it was seen
to err 1e4 times its tolerance (hard case ``tiny-inertia``)."""


def check_explicit(library: Library, at: Equilibrium, p: Vector, method: str, t_end: float) -> None:
    """Refuse a run that one fast motion takes from an explicit method: too many steps, or too many for Adams.

    Raises
    ------
    LtcgearError
        It names the body and the cure.
    """
    speed, body = _fastest(library, at, p)
    slowest = _slowest(library, at, p) if method == "adams" else np.inf
    if speed > STIFFEST * slowest:
        raise LtcgearError(
            f"adams is not for stiff models: {body} swings at {speed:.1e} rad/s, {speed / slowest:.0e} times as fast "
            "as the slowest motion; use --method rosenbrock or cvodes"
        )
    steps = t_end * speed / REACH
    if steps > MOST_STEPS:
        raise LtcgearError(
            f"{method} would need about {steps:.0e} steps: {body} swings at {speed:.1e} rad/s; "
            f"use --method rosenbrock, give {body.split()[0]} more inertia or softer springs, or simulate less time"
        )


def _slowest(library: Library, at: Equilibrium, p: Vector) -> float:
    """Return the smallest natural frequency [rad/s] that is not rigid."""
    found = (mode.frequency_hz for mode in find_modes(linearise(library, p, at)) if mode.kind != "rigid")
    return 2 * np.pi * min((hertz for hertz in found if hertz > 0), default=float("inf"))


def _fastest(library: Library, at: Equilibrium, p: Vector) -> tuple[float, str]:
    """Return the largest modulus [1/s] of an eigenvalue, and the body that this motion moves most."""
    scale = vibration_scale(library, at, p)
    matrix = state_matrix(library, at.x, at.s, closed(library, p)) * scale[None, :] / scale[:, None]
    values, shapes = np.linalg.eig(matrix)
    top = int(np.abs(values).argmax())
    shape = np.abs(shapes[:, top] * scale)[library.index(".rate")]
    energy = inertias(library, p) * shape**2
    state = library.manifest.states[library.index("")[int(energy.argmax())]]
    return float(np.abs(values[top])), f"{state.body} ({state.axis})"
