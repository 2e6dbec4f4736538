"""Refuse, before anything is integrated, what a method cannot finish."""

import numpy as np
from ltcgear.generated.errors import LtcgearError
from numpy.typing import NDArray

from .equilibrium import Equilibrium, inertias, pulling, state_matrix
from .library import Library
from .scaling import vibration_scale

Vector = NDArray[np.float64]
EXPLICIT = ("erk",)
"""Methods whose step is bound by the fastest motion, whether or not it vibrates."""
REACH = 3.3
"""Step times |eigenvalue| up to which the explicit Runge-Kutta pair 5(4) of Dormand and Prince is stable."""
MOST_STEPS = 1e9
"""Steps above which a run is refused: more than an hour of the smallest scenes."""


def check_explicit(library: Library, at: Equilibrium, p: Vector, t_end: float) -> None:
    """Refuse a run that an explicit method would need very many steps for because of one fast motion.

    Raises
    ------
    LtcgearError
        It names the body and the cure.
    """
    speed, body = _fastest(library, at, p)
    steps = t_end * speed / REACH
    if steps > MOST_STEPS:
        raise LtcgearError(
            f"erk would need about {steps:.0e} steps: {body} swings at {speed:.1e} rad/s; use --method rosenbrock, "
            f"give {body.split()[0]} more inertia or softer springs, or simulate a shorter time"
        )


def _fastest(library: Library, at: Equilibrium, p: Vector) -> tuple[float, str]:
    """Return the largest modulus [1/s] of an eigenvalue, and the body that this motion moves most."""
    scale = vibration_scale(library, at, p)
    matrix = state_matrix(library, at.x, at.s, pulling(library, p)) * scale[None, :] / scale[:, None]
    values, shapes = np.linalg.eig(matrix)
    top = int(np.abs(values).argmax())
    shape = np.abs(shapes[:, top] * scale)[library.index(".rate")]
    energy = inertias(library, p) * shape**2
    state = library.manifest.states[library.index("")[int(energy.argmax())]]
    return float(np.abs(values[top])), f"{state.body} ({state.axis})"
