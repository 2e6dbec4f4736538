"""Uniform samples of a march, handed on block by block."""

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

    ``phi`` and ``turns`` are the reference angle [rad] less whole turns and these, ``steps`` the steps that the
    integrator had made, shapes (m,).
    """

    time: Vector
    x: Vector
    levels: Vector
    signals: Vector
    phi: Vector
    turns: NDArray[np.int64]
    steps: Vector

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
        self._wait(np.zeros(1), march.frame.origin[None, :].copy(), levels_of(march.cells)[None, :], np.zeros(1))

    @property
    def end(self) -> float:
        """Return the time of the last sample [s]."""
        return self.last / self.rate

    @property
    def complete(self) -> bool:
        """Say whether the last sample is taken."""
        return self.done > self.last

    def take(self) -> None:
        """Take what the march has sampled."""
        state, arrays = self.march.state, self.march.native.arrays
        count, state.filled = state.filled, 0
        if not count:
            return
        self._wait(*(arrays[f"sample_{name}"][:count].copy() for name in ("time", "x", "levels", "steps")))
        if self.held >= BLOCK:
            self.flush()

    def _wait(self, time: Vector, x: Vector, levels: Vector, steps: Vector) -> None:
        """Keep samples until their block is handed on; the states get the turns that were taken off."""
        march, count = self.march, len(time)
        phi, turns = np.zeros(count), np.full(count, march.turns)
        if march.angle >= 0:
            phi = x[:, march.angle].copy()
            x[:, march.angle] += TURN * march.turns
        self.waiting.append(Block(time, x, levels, march.signals.over(time), phi, turns, steps))
        self.done, self.held = self.done + count, self.held + count

    def flush(self) -> None:
        """Hand on what waits."""
        if self.held:
            block = join(self.waiting)
            self.waiting, self.held = [], 0
            self.push(block)

    def goto(self, done: int) -> None:
        """Go on after ``done`` samples that were handed on before."""
        self.done, self.march.state.done, self.waiting, self.held = done, done, [], 0
