"""Continuation of an equilibrium while a parameter goes from 1 to 0."""

from collections.abc import Callable

import numpy as np
from ltcgear.generated.errors import SolverError
from numpy.typing import NDArray

Vector = NDArray[np.float64]
FIRST, SMALLEST, GROWTH = 0.25, 1e-10, 4.0
"""First and smallest step of the parameter, and by how much the step after a success may be longer."""


def follow(solve: Callable[[float, Vector], Vector], start: Vector) -> Vector:
    """Return the solution at 0 of a problem whose solution at 1 can be found from the start.

    Parameters
    ----------
    solve
        Returns the solution at a value of the parameter, from a guess.
    start
        Guess for the value 1.

    Raises
    ------
    SolverError
        That of ``solve`` where even the smallest step does not succeed.
    """
    x, at, step = solve(1.0, start), 1.0, FIRST
    slope = np.zeros_like(x)
    while at > 0.0:
        there = max(at - step, 0.0)
        try:
            found = solve(there, x + slope * (there - at))
        except SolverError:
            step /= GROWTH
            if step < SMALLEST:
                raise
            continue
        slope = (found - x) / (there - at)
        x, at, step = found, there, step * GROWTH
    return x
