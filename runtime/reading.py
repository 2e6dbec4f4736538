"""Reading: samples of an integration -> outputs at those that are kept, accelerations free of aliases."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .batch import Batch
from .clocks import Clocks
from .integration import Trajectory
from .library import Library
from .march import Snapshot
from .quantities import PHASES
from .sampling import Block

Vector = NDArray[np.float64]

REACH = 10
"""Kept samples to either side of one that its filter takes in; SciPy's ``decimate`` takes as many."""
FEWEST = 64
"""Kept samples below which a run is too short to be filtered."""


@dataclass(frozen=True)
class Rows:
    """Kept samples: numbers among all samples, times [s], outputs, states, levels, and steps so far.

    Shapes (m,), and (m, ...) of outputs, states and levels.
    """

    index: NDArray[np.int64]
    time: Vector
    values: Vector
    x: Vector
    levels: Vector
    steps: Vector

    def __getitem__(self, part: slice) -> "Rows":
        """Return some of the rows, in memory of their own."""
        return Rows(**{name: value[part].copy() for name, value in vars(self).items()})


def join_rows(rows: list[Rows]) -> Rows:
    """Join rows that follow each other."""
    return Rows(**{name: np.concatenate([vars(r)[name] for r in rows]) for name in vars(rows[0])})


def no_rows(library: Library) -> Rows:
    """Return no rows."""
    manifest = library.manifest
    sizes = {"values": manifest.reports, "x": manifest.states, "levels": manifest.levels}
    none: dict[str, Vector] = {name: np.zeros((0, len(items))) for name, items in sizes.items()}
    return Rows(np.zeros(0, dtype=np.int64), np.zeros(0), **none, steps=np.zeros(0))


def by_quantity(library: Library) -> dict[str, list[int]]:
    """Return quantity -> columns of the output vector."""
    columns: dict[str, list[int]] = {}
    for i, report in enumerate(library.manifest.reports):
        columns.setdefault(report.quantity, []).append(i)
    return columns


def outputs_of(library: Library, clocks: Clocks, samples: Block | Trajectory) -> Vector:
    """Evaluate the outputs at samples, shape (m, n_y); phases count on over all turns."""
    return _outputs(Batch(library, "outputs"), clocks, samples)


def _outputs(batch: Batch, clocks: Clocks, samples: Block | Trajectory) -> Vector:
    """Evaluate the outputs by a function that is bound already."""
    values = clocks.outputs(batch, samples.x, samples.s, samples.phi, samples.turns)
    for column, report in enumerate(batch.library.manifest.reports):
        if report.quantity in PHASES:
            values[:, column] += clocks.unwound(report.item, samples.turns)
    return values


class Reader:
    """Reads outputs at every ``oversample``-th sample, block by block; no number depends on where blocks end.

    Stiffness jumps make accelerations jump, so their spectrum has no end, and samples taken as they are
    show tones above half the sampling rate as false lines below it. Here the mean acceleration between
    samples (the difference of velocities, which are continuous) goes through SciPy's zero-phase FIR filter,
    whose band ends gently: lines up to 0.4 of the sampling rate are free of aliases. Beyond the ends of
    the run it is mirrored. A row is held back until all is there that its filter takes in.

    Parameters
    ----------
    library, p
        Model, and parameters at reference angle 0, shape (n_p,).
    rate
        Samples a second [Hz], before they are thinned.
    oversample
        How many samples make one row.
    """

    def __init__(self, library: Library, p: Vector, rate: float, oversample: int) -> None:
        self.batch, self.clocks = Batch(library, "outputs"), Clocks(library.manifest, p)
        self.rate, self.oversample = rate, oversample
        columns = by_quantity(library)
        self.filters = oversample > 1 and "velocity_x" in columns
        self.axes = [(columns[f"velocity_{a}"], columns[f"acceleration_{a}"]) for a in "xy" if self.filters]
        self.taken = self.rows = 0
        self.held: Rows | None = None

    def read(self, block: Block) -> Rows:
        """Take in a block; return the rows that are ready."""
        values = _outputs(self.batch, self.clocks, block)
        index = self.taken + np.arange(len(block.time), dtype=np.int64)
        self.taken += len(index)
        new = Rows(index, block.time, values, block.x, block.levels, block.steps)
        self.held = new if self.held is None else join_rows([self.held, new])
        ready = (self.taken - 1) // self.oversample + 1
        if self.filters:
            ready = (self.taken - 2) // self.oversample - REACH + 1 if ready >= FEWEST else 0
        return self._release(max(ready, self.rows), False)

    def finish(self) -> Rows:
        """Return the rows that were held back, once no more samples come."""
        return self._release((self.taken - 1) // self.oversample + 1, True)

    def snapshot(self) -> Snapshot:
        """Return all that the reader remembers."""
        held = {f"held.{name}": value for name, value in vars(self.held).items()} if self.held else {}
        return held | {"reader.taken": np.array(self.taken), "reader.rows": np.array(self.rows)}

    def restore(self, kept: Snapshot) -> None:
        """Go on from a snapshot."""
        self.taken, self.rows = int(kept["reader.taken"]), int(kept["reader.rows"])
        held: dict[str, Any] = {name.removeprefix("held."): v for name, v in kept.items() if name.startswith("held.")}
        self.held = Rows(**held) if held else None

    def _release(self, ready: int, last: bool) -> Rows:
        """Return the rows before number ``ready`` and forget what no later one needs."""
        if self.held is None:
            raise RuntimeError("rows are asked for before any sample was read")
        q, held, first = self.oversample, self.held, self.taken - len(self.held.index)
        rows = held[slice(self.rows * q - first, ready * q - first, q)]
        if self.filters and len(rows.index) and (not last or ready >= FEWEST):
            for velocity, acceleration in self.axes:
                rows.values[:, acceleration] = self._accelerations(held.values[:, velocity], first, ready, last)
        needed = (ready - REACH) * q - 1 if self.filters else ready * q
        self.rows, self.held = ready, held[slice(max(needed - first, 0), None)]
        return rows

    def _accelerations(self, velocity: Vector, first: int, ready: int, last: bool) -> Vector:
        """Return the filtered accelerations of the rows from the next one to ``ready``; samples begin at ``first``."""
        from scipy.signal import firwin, upfirdn

        q, reach = self.oversample, REACH * self.oversample
        mean = np.gradient(velocity, 1 / self.rate, axis=0)
        before = reach if first == 0 else 0
        longer = np.pad(mean, ((before, reach if last else 0), (0, 0)), mode="reflect")
        begin = first - before
        part = longer[self.rows * q - reach - begin : (ready - 1) * q + reach + 1 - begin]
        filtered = upfirdn(firwin(2 * reach + 1, 1 / q, window="hamming"), part, 1, q, axis=0)
        return np.asarray(filtered[2 * REACH : 2 * REACH + ready - self.rows])


def sampled(library: Library, path: Trajectory, p: Vector, oversample: int) -> Rows:
    """Read the outputs of a whole trajectory at every ``oversample``-th sample."""
    rate = (len(path.time) - 1) / (path.time[-1] - path.time[0]) if len(path.time) > 1 else 1.0
    reader = Reader(library, p, float(rate), oversample)
    block = Block(path.time, path.x, path.levels, path.signals, path.phi, path.turns, path.steps)
    return join_rows([reader.read(block), reader.finish()])
