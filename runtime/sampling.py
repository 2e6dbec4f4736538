"""Uniform samples of a march, read off its segments."""

import numpy as np
from numpy.typing import NDArray

from .clocks import TURN
from .march import March
from .switching import levels_of

Vector = NDArray[np.float64]


class Samples:
    """The uniform samples of a march, filled segment by segment."""

    def __init__(self, march: March, time: Vector) -> None:
        self.march, self.time, self.done = march, time, 1
        self.x, self.levels = np.empty((len(time), len(march.z))), np.empty((len(time), len(march.cells)))
        self.turns, self.phi = np.zeros(len(time), dtype=np.int64), np.zeros(len(time))
        self.x[0], self.levels[0] = march.frame.origin, levels_of(march.cells)
        self._turn_on(0, 1)

    def take(self, start: float, duration: float, path: Vector, level: Vector) -> None:
        """Read the samples that lie in a segment, its end included."""
        end = start + duration * (1 + 1e-12)
        last = self.done + int(np.searchsorted(self.time[self.done :], end, side="right"))
        if self.done < last:
            inside = self.march.nodes.matrix((self.time[self.done : last] - start) / duration)
            self.x[self.done : last] = self.march.frame.origin + self.march.frame.scale * (inside @ path)
            self.levels[self.done : last] = level
            self._turn_on(self.done, last)
        self.done = last

    def _turn_on(self, first: int, last: int) -> None:
        """Keep the reference angle as it is, and give the states it with the turns that were taken off."""
        if self.march.angle >= 0:
            angle = self.x[first:last, self.march.angle]
            self.phi[first:last], self.turns[first:last] = angle, self.march.turns
            angle += TURN * self.march.turns

    def taken(self) -> tuple[Vector, Vector, Vector]:
        """Return times, states and levels so far."""
        return self.time[: self.done], self.x[: self.done], self.levels[: self.done]
