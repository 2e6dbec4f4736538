r"""Fit: the unknowns that explain the targets best without straying needlessly from what was assumed.

With z the unknowns in standard deviations of what is held of them before, and y(z) what the model says,

.. math:: \min_z \; \sum_i \left(\frac{y_i(z) - Y_i}{\sigma_i}\right)^2 + \sum_j z_j^2,

the largest posterior probability for normal distributions (Tikhonov's regularisation; Rodgers 2000, Inverse Methods
for Atmospheric Sounding). Where nothing in the targets speaks of an unknown it stays where it was.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from ltcgear.generated.errors import SolverError
from ltcgear.runtime.model.library import Library
from numpy.typing import NDArray
from scipy.optimize import least_squares

from benchmarks.identification.forecast import Forecast, Span, Target
from benchmarks.identification.unknowns import Unknown, bounds_of

Vector = NDArray[np.float64]
Values = Callable[[Vector], Vector]
STEP = 1e-4
"""Step of an unknown [standard deviations] over which the parameters, which are algebra in it, are differenced."""
SETTLED = 1e-3
"""Relative change of the sum, and of z, that ends a fit."""
REFUSED = 1e3
"""Residual in place of one that cannot be had, where a trial point gives no run."""


@dataclass(frozen=True)
class Fit:
    """A fit.

    Attributes
    ----------
    z
        The unknowns, in standard deviations from what was assumed.
    forecast
        What the model says of the targets there.
    jacobian
        Derivatives of the residuals with respect to z, shape (targets, unknowns).
    misfit, strayed
        Sums of squares: of the targets' residuals, and of z.
    runs, message
        Runs that were made, and how the search ended.
    warnings
        What the run there is warned about.
    """

    z: Vector
    forecast: Vector
    jacobian: Vector
    misfit: float
    strayed: float
    runs: int
    message: str
    warnings: tuple[str, ...] = ()


def fit(
    library: Library, values: Values, unknowns: list[Unknown], targets: list[Target], span: Span,
    start: Vector | None = None, told: Callable[[Fit], None] = lambda fit: None, most: int = 20,
) -> Fit:  # fmt: skip
    """Fit unknowns to targets by Gauss-Newton steps within bounds, with the model's own sensitivities.

    Parameters
    ----------
    library
        The model; all points share it, since only numbers change.
    values
        z -> parameters of the model, shape (n_p,).
    unknowns, targets, span
        What is sought, what is known, and the runs.
    start
        Where the search begins; the assumed values where left out.
    told
        Called with every point at which derivatives were taken.
    most
        How many points are tried at most.

    Raises
    ------
    SolverError
        If there is no run at the start.
    """
    search = _Search(library, values, unknowns, targets, span, told)
    low, high = bounds_of(unknowns)
    begin = np.clip(np.zeros(len(unknowns)) if start is None else start, low + 1e-9, high - 1e-9)
    search.at(begin)
    found = least_squares(
        search.residuals, begin, search.jacobian, bounds=(low, high), method="trf", ftol=SETTLED, xtol=SETTLED,
        gtol=1e-4, max_nfev=most,
    )  # fmt: skip
    return search.conclude(found.x, str(found.message))


class _Search:
    """The points of a search, each computed once."""

    def __init__(
        self, library: Library, values: Values, unknowns: list[Unknown], targets: list[Target], span: Span,
        told: Callable[[Fit], None],
    ) -> None:  # fmt: skip
        self.library, self.values, self.unknowns, self.targets, self.span = library, values, unknowns, targets, span
        self.told, self.runs = told, 0
        self.sigma = np.array([target.sigma for target in targets])
        self.known = np.array([target.value for target in targets])
        self._point: tuple[bytes, Forecast, Vector] | None = None
        self._slopes: tuple[bytes, Vector] | None = None

    def at(self, z: Vector) -> tuple[Forecast, Vector]:
        """Return the forecast of a point and its values."""
        key = z.tobytes()
        if self._point is None or self._point[0] != key:
            self.runs += 1
            forecast = Forecast(self.library, self.values(z), self.targets, self.span)
            self._point = key, forecast, forecast.values()
        return self._point[1], self._point[2]

    def residuals(self, z: Vector) -> Vector:
        """Return the residuals of the targets and of what is held before."""
        try:
            said = (self.at(z)[1] - self.known) / self.sigma
        except SolverError:
            said = np.full(len(self.targets), REFUSED)
        return np.concatenate([said, z])

    def jacobian(self, z: Vector) -> Vector:
        """Return the derivatives of the residuals."""
        slopes = self.slopes(z)
        self.told(self.conclude(z, ""))
        return np.vstack([slopes, np.eye(len(z))])

    def slopes(self, z: Vector) -> Vector:
        """Return the derivatives of the targets' residuals with respect to z: d y / d p of the run, times d p / d z."""
        key = z.tobytes()
        if self._slopes is None or self._slopes[0] != key:
            moves = parameter_slopes(self.values, z)
            moving = moves.any(axis=1)
            gradients = self.at(z)[0].gradients()[:, moving] / self.sigma[:, None]
            self._slopes = key, np.asarray(gradients @ moves[moving])
        return self._slopes[1]

    def conclude(self, z: Vector, message: str) -> Fit:
        """Return what is known of a point."""
        slopes, (forecast, said) = self.slopes(z), self.at(z)
        misfit = float(np.sum(((said - self.known) / self.sigma) ** 2))
        return Fit(z.copy(), said.copy(), slopes.copy(), misfit, float(z @ z), self.runs, message, forecast.warnings())


def parameter_slopes(values: Values, z: Vector) -> Vector:
    """Return d p / d z, shape (n_p, unknowns), by central differences of what builds the parameters.

    Parameters
    ----------
    values
        z -> parameters of the model, shape (n_p,).
    z
        A point [standard deviations].
    """
    steps = np.eye(len(z)) * STEP
    return np.array([(values(z + step) - values(z - step)) / (2 * STEP) for step in steps]).T


def spread_of(gradient: Vector, jacobian: Vector) -> tuple[float, float]:
    """Return the standard deviation of a number before and after the fit.

    Parameters
    ----------
    gradient
        Derivatives of the number with respect to z, shape (unknowns,).
    jacobian
        Those of the targets' residuals, shape (targets, unknowns).
    """
    covariance = np.linalg.inv(jacobian.T @ jacobian + np.eye(len(gradient)))
    return float(np.linalg.norm(gradient)), float(np.sqrt(gradient @ covariance @ gradient))
