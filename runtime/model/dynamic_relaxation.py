"""Dynamic relaxation: bodies move under their forces until these balance, with clearances that close on the way."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]
GENTLER, BOLDER = 8.0, 4.0
"""Factors of the damping after a step that increased the forces, and after one that did not."""
GROWTH = 1.01
"""Factor by which forces may grow in a step, as they must where a potential steepens."""
MOST = 600


def relax(balance: Callable[[Vector], tuple[Vector, Vector]], q: Vector, small: float) -> Vector | None:
    """Return a position of equilibrium, or None if the iteration does not converge.

    Every step solves (K + m I) dq = f. If the forces have a convex potential, such steps reduce them for any
    sufficiently large m > 0, even if K is singular, as it is within a clearance.

    Parameters
    ----------
    balance
        Returns forces and stiffness at a position, scaled so that stiffnesses are about 1, shapes (n,), (n, n); not
        finite at an impossible position.
    q
        Start, shape (n,).
    small
        Norm of the scaled forces below which they balance.
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
