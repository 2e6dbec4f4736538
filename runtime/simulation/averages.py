"""Averages along the motion: mean, root mean square and extremes of all outputs.

Means of samples depend on the sampling rate: where it is a whole multiple of the mesh frequency, all samples fall on
the same few phases of a tooth pitch. Integrals along the motion do not. They cover the second half of a run with the
smooth window w = sin(pi s)^4, so that incomplete periods at its ends do not bias the mean: for motion with any periods
it converges to the mean over all time, faster the smoother the window (weighted Birkhoff averages: Das, Saiki, Sander
and Yorke 2017, Nonlinearity 30:4111).
"""

import numpy as np
from numpy.typing import NDArray

from ..model.cstruct import engine
from ..results.statistics import taper

Vector = NDArray[np.float64]


class Averages:
    """Sums over points of a motion.

    Parameters
    ----------
    span
        First and last instant of the average [s].
    start
        Outputs at time zero, subtracted from all values so that squares keep their digits; shape (n_y,).
    """

    def __init__(self, span: tuple[float, float], start: Vector) -> None:
        self.span, self.start = span, np.array(start, dtype=np.float64)
        self.sums = np.zeros((5, len(start)))
        self.sums[3], self.sums[4] = np.inf, -np.inf

    def take(self, time: Vector, weight: Vector, values: Vector) -> None:
        """Take points; see ``BandFilter.take``."""
        begin = int(np.searchsorted(time, self.span[0]))
        if begin < len(time):
            part = (time[begin:] - self.span[0]) / (self.span[1] - self.span[0])
            shares, rows = weight[begin:] * taper(part), np.ascontiguousarray(values[begin:])
            engine().ltcgear_sums(*rows.shape, shares.ctypes.data, rows.ctypes.data, self.sums.ctypes.data)

    def statistics(self) -> Vector:
        """Return the statistics in the order of ``STATISTICS``, shape (5, n_y); NaN where nothing was taken."""
        weights, ones, squares, low, high = self.sums
        with np.errstate(invalid="ignore", divide="ignore"):
            offset = ones / weights
            std = np.sqrt(np.maximum(squares / weights - offset**2, 0.0))
            mean = self.start + offset
            return np.array([mean, np.hypot(mean, std), std, self.start + low, self.start + high])
