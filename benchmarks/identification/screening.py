"""Screening: where to begin a search that may end in a valley of its own."""

from collections.abc import Callable

import numpy as np
from ltcgear.generated.errors import SolverError
from numpy.typing import NDArray
from scipy.special import ndtri
from scipy.stats import qmc

from benchmarks.identification.unknowns import Unknown, bounds_of

Vector = NDArray[np.float64]


def spread_points(unknowns: list[Unknown], count: int, seed: int) -> Vector:
    """Return points drawn evenly from what is held before: Sobol's sequence, as normal deviates within the bounds.

    Parameters
    ----------
    unknowns
        What is sought.
    count, seed
        How many points, a power of two, and the seed of the scrambling.

    Returns
    -------
    numpy.ndarray
        Shape (count, unknowns) [standard deviations].
    """
    even = qmc.Sobol(len(unknowns), rng=np.random.default_rng(seed)).random(count)
    low, high = bounds_of(unknowns)
    return np.asarray(np.clip(ndtri(even), low, high))


def screen(residuals: Callable[[Vector], Vector], points: Vector) -> list[tuple[float, Vector]]:
    """Judge points by the sum that a fit makes small; those without a run are left out.

    Parameters
    ----------
    residuals
        Residuals of the targets at a point, each over its standard deviation.
    points
        Shape (count, unknowns).

    Returns
    -------
    list of (float, numpy.ndarray)
        Sum and point, the best first.
    """
    found = []
    for z in points:
        try:
            found.append((float(np.sum(residuals(z) ** 2) + z @ z), z))
        except SolverError:
            continue
    return sorted(found, key=lambda item: item[0])
