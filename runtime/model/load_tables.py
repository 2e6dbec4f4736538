"""Load tables over time: linear between their rows, constant beyond their ends."""

from collections.abc import Mapping, Sequence

import numpy as np
from ltcgear.generated.contract import Signal
from numpy.typing import NDArray

from .parameter_values import Pairs as Pairs
from .parameter_values import read_tables

Vector = NDArray[np.float64]


class Signals:
    """The load signals of a run.

    A segment that no knot lies in sees each signal as a linear function of time. Where a table passes
    through zero is a knot too, so that no speed turns back within a segment.

    Parameters
    ----------
    signals
        What the signals are, as the manifest lists them.
    tables
        Table name -> rows of time [s] and value, times ascending.

    Raises
    ------
    LtcgearError
        If a table is missing or unknown, or is not rows of finite numbers with ascending times.
    """

    def __init__(self, signals: Sequence[Signal], tables: Mapping[str, Pairs]) -> None:
        rows = read_tables((signal.table for signal in signals), tables)
        self.tables = [insert_zeros(rows[signal.table]) for signal in signals]
        self.sloping = [signal.slope for signal in signals]
        self.knots = np.unique(np.concatenate([np.zeros(0), *(time for time, _ in self.tables)]))

    def at(self, time: float) -> Vector:
        """Return the signals at a time [s], slopes those after it."""
        return self._values(np.array([time]), "right").ravel()

    def before(self, time: float) -> Vector:
        """Return the signals at a time [s], slopes those before it."""
        return self._values(np.array([time]), "left").ravel()

    def over(self, time: Vector) -> Vector:
        """Return the signals at many times, shape (times, signals), slopes those after each."""
        return self._values(time, "right")

    def rate(self, time: float) -> Vector:
        """Return the signals' rates after a time [s]; that of a slope is zero between knots."""
        moment = np.array([time])
        rates = [0.0 if s else _slope(t, moment, "right")[0] for t, s in zip(self.tables, self.sloping, strict=True)]
        return np.array(rates)

    def next_knot(self, time: float) -> float:
        """Return the first knot after a time [s]; infinite where none is left."""
        i = int(np.searchsorted(self.knots, time, side="right"))
        return float(self.knots[i]) if i < len(self.knots) else float("inf")

    def last_knot(self, time: float) -> float:
        """Return the last knot up to a time [s]; 0 where there was none."""
        i = int(np.searchsorted(self.knots, time, side="right"))
        return float(self.knots[i - 1]) if i else 0.0

    def _values(self, time: Vector, side: str) -> Vector:
        """Evaluate all signals, shape (times, signals)."""
        columns = [
            _slope(table, time, side) if slope else np.interp(time, *table)
            for table, slope in zip(self.tables, self.sloping, strict=True)
        ]
        return np.array(columns).reshape(len(columns), len(time)).T


def _slope(table: tuple[Vector, Vector], time: Vector, side: str) -> Vector:
    """Return a table's slope at times, on one side of each; zero beyond its ends."""
    times, values = table
    slopes = np.concatenate([[0.0], np.diff(values) / np.diff(times), [0.0]])
    return np.asarray(slopes[np.searchsorted(times, time, side="right" if side == "right" else "left")])


def insert_zeros(rows: Vector) -> tuple[Vector, Vector]:
    """Return times and values of a table, a row put in where it passes through zero."""
    time, value = rows.T
    i = np.flatnonzero(value[:-1] * value[1:] < 0)
    zeros = time[i] - value[i] * (time[i + 1] - time[i]) / (value[i + 1] - value[i])
    kept = (time[i] < zeros) & (zeros < time[i + 1])
    i, zeros = i[kept], zeros[kept]
    return np.insert(time, i + 1, zeros), np.insert(value, i + 1, 0.0)
