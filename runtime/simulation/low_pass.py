"""Low-pass filter of linear phase through which outputs are sampled, and its band.

Stiffness jumps excite without end, so samples taken as they are alias: components above half the sampling rate appear
below it. So the filter is applied as an integral along the motion itself, segment by segment between jumps: nothing
aliases, whatever the rate. Its response is that of a Kaiser window's low pass (Kaiser 1974; Oppenheim and Schafer,
Discrete-Time Signal Processing, section 7.5.3), symmetric in time, so that phases stay.
"""

from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..model.cstruct import engine

Vector = NDArray[np.float64]

REACH = 10
"""Samples to either side of one that its filter takes in; SciPy's ``decimate`` takes as many."""
BAND = 0.4
"""End of the band over the sampling rate: up to there amplitudes are kept, and nothing folds."""
ATTENUATION = 7.95 + 2.285 * 2 * REACH * 2 * np.pi * (1 - 2 * BAND)
"""Attenuation [dB] beyond 1 - ``BAND`` of the sampling rate, by Kaiser's formula for that length: 65."""
FINE = 512
"""Parts of a sample between which the filter is interpolated: to 2e-6 of its height."""

KEPT = ("first", "reached", "rows", "weights", "at", "share", "last")
"""What a filter remembers."""


@cache
def filter_table() -> Vector:
    """Return the filter at the samples about a point, by the part of a sample that the first lies in the reach.

    Returns
    -------
    numpy.ndarray
        Shape (FINE + 1, 2 REACH), heights over the sampling rate [1].
    """
    beta = 0.1102 * (ATTENUATION - 8.7)  # Kaiser's fit above 50 dB
    parts = np.arange(FINE + 1)[:, None] / FINE + np.arange(2 * REACH) - REACH
    window = np.i0(beta * np.sqrt(np.maximum(1 - (parts / REACH) ** 2, 0.0))) / np.i0(beta)
    return np.asarray(np.sinc(parts) * window)


def response(frequency: Vector, rate: float) -> Vector:
    """Return what the filter leaves of a vibration's amplitude [1].

    Parameters
    ----------
    frequency
        Frequencies [Hz], any shape.
    rate
        Sampling rate [Hz].
    """
    table = filter_table()
    parts = np.arange(FINE)[:, None] / FINE + np.arange(2 * REACH) - REACH
    turned = 2 * np.pi * np.multiply.outer(np.asarray(frequency, dtype=np.float64) / rate, parts)
    return np.asarray((np.cos(turned) * table[:-1]).sum(axis=(-1, -2)) / table[:-1].sum())


def passing_speed(rate: float, raw: bool) -> float:
    """Return how fast the filter itself varies [rad/s], for the points at which the motion is read; 0 without one."""
    return 0.0 if raw else np.pi * rate


class BandFilter:
    """The filter at work: takes outputs at points of a motion, and gives them at equal times.

    No number depends on how the points are cut into calls. Each row is divided by the sum of its own weights, so that
    a constant is kept to the last bit. At both ends the motion is continued by its image through the end point,
    as SciPy's ``filtfilt`` does it: the first and the last row are the motion's own.

    Parameters
    ----------
    rate
        Samples a second [Hz].
    start
        Outputs at time zero, shape (n_y,).
    """

    def __init__(self, rate: float, start: Vector) -> None:
        self.rate, self.start, self.table = rate, np.array(start, dtype=np.float64), filter_table()
        self.first, self.reached = 0, 0.0
        self.rows, self.weights = np.zeros((0, len(start))), np.zeros(0)
        self.at, self.share, self.last = np.zeros(0), np.zeros(0), np.zeros((0, len(start)))

    def take(self, time: Vector, weight: Vector, values: Vector) -> None:
        """Take points.

        Parameters
        ----------
        time, weight
            Instants [s], ascending, and their quadrature weights [s], shape (m,).
        values
            Outputs less those at the start, shape (m, n_y).
        """
        if not len(time):
            return
        at, share = time * self.rate, weight * self.rate
        self._add(at, share, values)
        self.reached = float(at[-1])
        before, near = (int(np.searchsorted(places, self.reached - REACH)) for places in (self.at, at))
        pairs = ((self.at, at), (self.share, share), (self.last, values))
        self.at, self.share, self.last = (np.concatenate([old[before:], new[near:]]) for old, new in pairs)

    def release(self) -> Vector:
        """Return the rows that no later point reaches, shape (rows, n_y)."""
        return self._hand_out(int(np.floor(self.reached)) - REACH + 1)

    def finish(self, end: int, values: Vector) -> Vector:
        """Return the rows that are left up to row ``end``; ``values`` are the outputs there less those at the start."""
        near = (self.at > end - REACH) & (self.at <= end)
        mirrored = (2 * values - self.last[near])[::-1].copy()
        self._add((2 * end - self.at[near])[::-1].copy(), self.share[near][::-1].copy(), mirrored)
        self._make_rows(end + 1)
        rows = self._hand_out(end + 1)
        if len(rows):
            rows[-1] = self.start + values
        return rows

    def snapshot(self) -> dict[str, NDArray[np.generic]]:
        """Return the state of the filter."""
        return {name: np.array(getattr(self, name)) for name in KEPT}

    def restore(self, kept: dict[str, Any]) -> None:
        """Resume from a snapshot."""
        for name in KEPT:
            setattr(self, name, kept[name].item() if kept[name].ndim == 0 else kept[name].copy())

    def _add(self, at: Vector, share: Vector, values: Vector) -> None:
        """Add points to all rows that they reach."""
        if not len(at):
            return
        self._make_rows(int(np.ceil(at[-1])) + REACH + 1)
        given = [np.ascontiguousarray(array) for array in (at, share, values)]
        engine().ltcgear_filter(
            len(at), self.rows.shape[1], REACH, FINE, self.table.ctypes.data, *(a.ctypes.data for a in given),
            self.first, self.rows.ctypes.data, self.weights.ctypes.data,
        )  # fmt: skip

    def _make_rows(self, end: int) -> None:
        """Let there be all rows before a number."""
        missing = end - self.first - len(self.rows)
        if missing > 0:
            self.rows = np.concatenate([self.rows, np.zeros((missing, self.rows.shape[1]))])
            self.weights = np.concatenate([self.weights, np.zeros(missing)])

    def _hand_out(self, ready: int) -> Vector:
        """Return the rows before a number, and forget them."""
        count = max(min(ready - self.first, len(self.rows)), 0)
        rows = self.start + self.rows[:count] / np.where(self.weights[:count] > 0, self.weights[:count], 1.0)[:, None]
        if self.first == 0 and count:
            rows[0] = self.start
        self.rows, self.weights, self.first = self.rows[count:].copy(), self.weights[count:].copy(), self.first + count
        return np.asarray(rows)
