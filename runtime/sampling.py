"""Uniform samples of a march, read off its segments and handed on block by block."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .clocks import TURN
from .march import March
from .switching import levels_of

Vector = NDArray[np.float64]

BLOCK = 2048
"""Samples from which on a block is handed on."""


@dataclass(frozen=True)
class Block:
    """Samples that follow each other: times [s], states, levels, load signals, shapes (m,) and (m, ...).

    ``phi`` and ``turns`` are the reference angle [rad] less whole turns and these, shapes (m,).
    """

    time: Vector
    x: Vector
    levels: Vector
    signals: Vector
    phi: Vector
    turns: NDArray[np.int64]

    @property
    def s(self) -> Vector:
        """Return levels and signals, the functions' second argument, shape (m, l + k)."""
        return np.hstack([self.levels, self.signals])


def join(blocks: list[Block]) -> Block:
    """Join blocks."""
    return Block(**{name: np.concatenate([vars(b)[name] for b in blocks]) for name in vars(blocks[0])})


class Samples:
    """The uniform samples of a march, at k / rate for k = 0 .. last.

    All samples of a segment are read at once, so that none depends on where a block ends.

    Parameters
    ----------
    march
        The integration; its state is the first sample.
    last
        Number of the last sample.
    rate
        Samples a second [Hz].
    push
        Takes each block.
    """

    def __init__(self, march: March, last: int, rate: float, push: Callable[[Block], None]) -> None:
        self.march, self.last, self.rate, self.push = march, last, rate, push
        self.done = self.held = 0
        self.waiting: list[Block] = []
        self._wait(np.zeros(1), march.frame.origin[None, :].copy(), levels_of(march.cells))

    @property
    def end(self) -> float:
        """Return the time of the last sample [s]."""
        return self.last / self.rate

    @property
    def complete(self) -> bool:
        """Say whether the last sample is taken."""
        return self.done > self.last

    def take(self, start: float, duration: float, path: Vector, level: Vector) -> None:
        """Read the samples that lie in a segment, its end included."""
        end = start + duration * (1 + 1e-12)
        ahead = np.arange(self.done, min(self.last, int(end * self.rate) + 1) + 1) / self.rate
        time = ahead[ahead <= end]
        if not len(time):
            return
        inside = self.march.nodes.matrix((time - start) / duration)
        self._wait(time, self.march.frame.origin + self.march.frame.scale * (inside @ path), level)
        if self.held >= BLOCK:
            self.flush()

    def _wait(self, time: Vector, x: Vector, level: Vector) -> None:
        """Keep samples until their block is handed on; the states get the turns that were taken off."""
        march, count = self.march, len(time)
        phi, turns = np.zeros(count), np.full(count, march.turns)
        if march.angle >= 0:
            phi = x[:, march.angle].copy()
            x[:, march.angle] += TURN * march.turns
        self.waiting.append(Block(time, x, np.tile(level, (count, 1)), march.signals.over(time), phi, turns))
        self.done, self.held = self.done + count, self.held + count

    def flush(self) -> None:
        """Hand on what waits."""
        if self.held:
            block = join(self.waiting)
            self.waiting, self.held = [], 0
            self.push(block)

    def goto(self, done: int) -> None:
        """Go on after ``done`` samples that were handed on before."""
        self.done, self.waiting, self.held = done, [], 0
