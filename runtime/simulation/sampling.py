"""Sampling of a motion: uniform samples and quadrature points, block by block."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..model.contact_levels import levels_of
from ..model.phase_wrapping import TURN
from .driver import March
from .trajectory import Block, Points, join

Vector = NDArray[np.float64]

BLOCK = 2048
"""Samples from which on a block is handed on."""


def no_points(march: March) -> Points:
    """Return an empty set of points."""
    x, levels, signals = (np.zeros((0, size)) for size in (len(march.z), len(march.cells), march.state.n_signals))
    return Points(np.zeros(0), np.zeros(0), x, levels, signals, np.zeros(0, dtype=np.int64))


class Samples:
    """The uniform samples of a run, at k / rate for k = 0 .. last, and the points between them.

    All samples of a segment are evaluated together, so that none depends on where a block ends.

    Parameters
    ----------
    march
        The integration; its state is the first sample.
    last
        Number of the last sample.
    rate
        Samples a second [Hz].
    push
        Takes each block, and the points up to its last sample.
    """

    def __init__(self, march: March, last: int, rate: float, push: Callable[[Block, Points], None]) -> None:
        self.march, self.last, self.rate, self.push = march, last, rate, push
        self.done = self.held = 0
        self.waiting: list[Block] = []
        self.beyond: list[Points] = []
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
        """Take the samples and points in the buffers."""
        state = self.march.state
        count, state.filled = state.filled, 0
        if count:
            self._wait(*self._left("sample", ("time", "x", "levels", "steps"), count))
        count, state.pointed = state.pointed, 0
        if count:
            time, weight, x, levels = self._left("point", ("time", "weight", "x", "levels"), count)
            turns = np.full(count, self.march.turns)
            self.beyond.append(Points(time, weight, x, levels, self.march.signals.over(time), turns))
            self.held += count
        if self.held >= BLOCK:
            self.flush()

    def _left(self, kind: str, names: tuple[str, ...], count: int) -> list[Vector]:
        """Return copies of a buffer's content."""
        return [self.march.native.arrays[f"{kind}_{name}"][:count].copy() for name in names]

    def _wait(self, time: Vector, x: Vector, levels: Vector, steps: Vector) -> None:
        """Keep samples until their block is handed on."""
        phi, turns = self._turn(x)
        self.waiting.append(Block(time, x, levels, self.march.signals.over(time), phi, turns, steps))
        self.done, self.held = self.done + len(time), self.held + len(time)

    def _turn(self, x: Vector) -> tuple[Vector, NDArray[np.int64]]:
        """Give states the turns that were taken off; return reference angles less these [rad], and these."""
        march, count = self.march, len(x)
        phi, turns = np.zeros(count), np.full(count, march.turns)
        if march.angle >= 0:
            phi = x[:, march.angle].copy()
            x[:, march.angle] += TURN * march.turns
        return phi, turns

    def flush(self) -> None:
        """Flush the buffers; points beyond the last sample are kept for the next one."""
        if not self.waiting:
            return
        block = join(self.waiting)
        self.waiting, self.held = [], 0
        self.push(block, self._up_to(float(block.time[-1])))

    def _up_to(self, time: float) -> Points:
        """Return the points up to a time, and keep the others."""
        points = join([no_points(self.march), *self.beyond])
        count = int(np.searchsorted(points.time, time, side="right"))
        before, after = ({name: value[part] for name, value in vars(points).items()}
                         for part in (slice(count), slice(count, None)))  # fmt: skip
        self.beyond = [Points(**{name: value.copy() for name, value in after.items()})]
        return Points(**before)

    def snapshot(self) -> dict[str, NDArray[np.generic]]:
        """Return what waits beyond the last sample, and how many samples were handed on."""
        points = join([no_points(self.march), *self.beyond])
        return {"samples": np.array(self.done), **{f"beyond.{name}": value for name, value in vars(points).items()}}

    def restore(self, kept: dict[str, NDArray[np.generic]]) -> None:
        """Resume after samples passed on earlier."""
        done = int(kept["samples"].item())
        self.done, self.march.state.done, self.waiting, self.held = done, done, [], 0
        found: dict[str, Any] = {name[7:]: value for name, value in kept.items() if name.startswith("beyond.")}
        self.beyond = [Points(**found)]
