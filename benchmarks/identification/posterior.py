r"""Posterior: what targets leave open about a point of which the sum of squares has kinks.

A target that is the largest value of a beating signal jumps from peak to peak as the unknowns move: its derivative
belongs to one peak and says little of the next. The strengths here are therefore secants,

.. math:: J_{ik} = \frac{r_i(z + h e_k) - r_i(z - h e_k)}{2 h},

over a step h that is a good part of the ranges sought. From them follow the covariance of all unknowns together,
:math:`(J^T J + 1)^{-1}`, and beside it stands what needs no linearisation: how far one unknown may move alone until the
sum has risen by one, and by how much the sum rises in truth at the ends of the linearised range.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from ltcgear.generated.errors import SolverError
from numpy.typing import NDArray

Vector = NDArray[np.float64]
Residuals = Callable[[Vector], Vector]
SECANT = 0.1
"""Half of the distance over which the strengths are taken [standard deviations before]."""
SHORTER = (1.0, 0.4, 0.15, 0.05)
"""Parts of a step that are tried."""
FIRST, HALVINGS = 0.01, 6
"""First step of the walk that looks for a rise [standard deviations before], and halvings between its last two."""


@dataclass(frozen=True)
class Posterior:
    """What is known at a point.

    Attributes
    ----------
    z, residuals
        The point, in standard deviations from what was assumed, and the targets' residuals there.
    jacobian
        Secants of the residuals with respect to z, shape (targets, unknowns).
    """

    z: Vector
    residuals: Vector
    jacobian: Vector

    @property
    def covariance(self) -> Vector:
        """Return the covariance of z with the targets known (linearised over the secants)."""
        return np.asarray(np.linalg.inv(self.jacobian.T @ self.jacobian + np.eye(len(self.z))))

    @property
    def narrowing(self) -> Vector:
        """Return the standard deviations of z that are left, of 1 before."""
        return np.asarray(np.sqrt(np.diag(self.covariance)))

    @property
    def determined(self) -> float:
        """Return how many numbers the targets determine (degrees of freedom for signal; Rodgers 2000)."""
        return float(len(self.z) - np.trace(self.covariance))

    @property
    def gradient(self) -> Vector:
        """Return half of the sum's slope, J' r + z: zero where the sum is level over the secants."""
        return np.asarray(self.jacobian.T @ self.residuals + self.z)

    def follow(self, k: int, share: float) -> Vector:
        """Return the point where unknown k has moved by a share of its standard deviation, the others going along.

        In linear theory the sum is larger by the square of the share there.
        """
        return np.asarray(self.z + share * self.covariance[:, k] / self.narrowing[k])


def total(residuals: Residuals, z: Vector) -> float:
    """Return the sum that a fit makes small; infinity where there is no run."""
    try:
        return float(np.sum(residuals(z) ** 2) + z @ z)
    except SolverError:
        return float("inf")


def look_around(residuals: Residuals, z: Vector, low: Vector, high: Vector, step: float = SECANT) -> Posterior:
    """Take the secants about a point.

    Parameters
    ----------
    residuals
        Residuals of the targets at a point, each over its standard deviation.
    z, low, high
        The point and its bounds, within which the secants stay.
    step
        Half of the distance between the ends of a secant.

    Raises
    ------
    SolverError
        If one of the points gives no run.
    """
    columns = []
    for move in np.eye(len(z)) * step:
        ahead, behind = np.minimum(z + move, high), np.maximum(z - move, low)
        columns.append((residuals(ahead) - residuals(behind)) / float(np.sum(ahead - behind)))
    return Posterior(z, residuals(z), np.array(columns).T)


def polish(
    residuals: Residuals, z: Vector, low: Vector, high: Vector, settle: Callable[[Vector], Vector],
    most: int = 6, enough: float = 0.02, told: Callable[[float], None] = lambda reached: None,
) -> Vector:  # fmt: skip
    """Lower the sum by Gauss-Newton steps over secants, and at kinks, where these fail, along the posterior's axes.

    Parameters
    ----------
    residuals, z, low, high
        As for ``look_around``.
    settle
        Moves a point to one that can be written: only sums at such points count.
    most, enough
        Rounds at most, and the gain below which no further one is made.
    told
        Called with the sum after each round.
    """
    best = settle(z)
    reached = total(residuals, best)
    for _ in range(most):
        here, before = look_around(residuals, best, low, high), reached
        whole = -here.covariance @ here.gradient
        widths, axes = np.linalg.eigh(here.covariance)
        for moves in ([whole], *([axis, -axis] for axis in (np.sqrt(widths) * axes).T)):
            trials = [settle(np.clip(best + part * move, low, high)) for move in moves for part in SHORTER]
            sums = [total(residuals, trial) for trial in trials]
            if min(sums) < reached:
                reached, best = min(sums), trials[int(np.argmin(sums))]
        told(reached)
        if before - reached < enough:
            break
    return best


def move_alone(
    residuals: Residuals, z: Vector, k: int, low: Vector, high: Vector, rise: float = 1.0
) -> tuple[float, float]:
    """Return how far one unknown may move while the others stay, until the sum has first risen.

    Parameters
    ----------
    residuals, z, low, high
        As for ``look_around``.
    k
        The unknown.
    rise
        By how much the sum may rise.

    Returns
    -------
    float, float
        Its lowest and highest place [standard deviations]; a bound where the sum does not rise so far before it.
    """
    allowed = total(residuals, z) + rise

    def inside(place: float) -> bool:
        there = z.copy()
        there[k] = place
        return total(residuals, there) <= allowed

    return _walk(inside, z[k], float(low[k])), _walk(inside, z[k], float(high[k]))


def _walk(inside: Callable[[float], bool], begin: float, end: float) -> float:
    """Return the last place on the way to an end that is inside, by steps that double and then halve."""
    last, step, way = float(begin), FIRST, float(np.sign(end - begin))
    while last != end:
        place = begin + way * step if step < abs(end - begin) else end
        if not inside(place):
            return _halve(inside, last, place)
        last, step = place, 2 * step
    return last


def _halve(inside: Callable[[float], bool], within: float, beyond: float) -> float:
    """Return a place between two of which the first is inside and the second is not."""
    for _ in range(HALVINGS):
        middle = (within + beyond) / 2
        within, beyond = (middle, beyond) if inside(middle) else (within, middle)
    return within
