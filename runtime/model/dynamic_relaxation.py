"""Dynamic relaxation: forces move what they act on until they balance, through gaps that close."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]
GENTLER, BOLDER = 8.0, 4.0
"""Factors of the resistance after a step that made forces grow, and after one that did not."""
GROWTH = 1.01
"""By how much forces may grow in a step: on the way down a slope that steepens they must."""
MOST = 600


def relax(balance: Callable[[Vector], tuple[Vector, Vector]], q: Vector, small: float) -> Vector | None:
    """Return a place where forces balance, or None where they do not come to rest.

    Every step solves (K + m I) dq = f. Where the forces have a convex potential, such steps let them fall for any
    m > 0 that is large enough, whether or not K is singular, as it is within a gap.

    Parameters
    ----------
    balance
        Returns forces and stiffness at a place, scaled so that stiffnesses are about 1, shapes (n,), (n, n); not
        finite where there is no such place.
    q
        Where to begin, shape (n,).
    small
        Norm of the scaled forces that counts as balance.
    """
    force, stiffness = balance(q)
    if not (np.isfinite(force).all() and np.isfinite(stiffness).all()):
        return None
    size, resistance = float(np.linalg.norm(force)), 1.0
    for _ in range(MOST):
        if size <= small:
            return q
        trial = q + np.linalg.solve(stiffness + resistance * np.eye(len(q)), force)
        after, slope = balance(trial)
        if np.isfinite(after).all() and np.linalg.norm(after) <= size * GROWTH:
            q, force, stiffness, size = trial, after, slope, float(np.linalg.norm(after))
            resistance = max(resistance / BOLDER, 1e-12)
        else:
            resistance *= GENTLER
    return None
