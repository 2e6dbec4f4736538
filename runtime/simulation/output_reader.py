"""Output reader: samples of an integration become filtered outputs and statistics."""

from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..model.library import Library
from ..model.operating_point import OperatingPoint
from ..model.phase_wrapping import Clocks
from ..model.quantity_names import PHASES
from ..model.rows import Batch
from ..model.tooth_deflection import Teeth
from ..results.checkpoint import Snapshot
from ..results.samples import Rows, by_quantity, join_rows, no_rows
from ..results.statistics import STATISTICS, Statistics
from .averages import Averages
from .low_pass import BandFilter
from .run_settings import RunSettings
from .trajectory import Block, Outcome, Points, Trajectory

Vector = NDArray[np.float64]

INSTANT = ("mesh_contact",)
"""Quantities that are not measured but told: they stay those of the instant."""


def outputs_of(library: Library, clocks: Clocks, samples: Block | Points | Trajectory) -> Vector:
    """Evaluate the outputs at samples, shape (m, n_y); phases count on over all turns."""
    return _outputs(Batch(library, "outputs"), clocks, samples)


def _outputs(batch: Batch, clocks: Clocks, samples: Block | Points | Trajectory) -> Vector:
    """Evaluate the outputs by a function that is bound already."""
    phi = None if isinstance(samples, Points) else samples.phi
    values = clocks.outputs(batch, samples.x, samples.s, phi, samples.turns)
    reports = batch.library.manifest.reports
    columns = [column for column, report in enumerate(reports) if report.quantity in PHASES]
    if columns and samples.turns.any():
        values[:, columns] += clocks.unwound([reports[column].item for column in columns], samples.turns)
    return values


class Reader:
    """Reads outputs block by block; no number depends on where blocks end.

    Outputs are band-limited (see ``band``) or, raw, those of the instant. Either way their statistics over the second
    half of the run are integrated along the motion (see ``averages``). A row is held back until all is there that its
    filter takes in.

    Parameters
    ----------
    point
        The model where the run begins.
    settings
        Settings, sampling rate chosen.
    """

    def __init__(self, point: OperatingPoint, settings: RunSettings) -> None:
        self.point, library = point, point.library
        self.batch, self.clocks = Batch(library, "outputs"), Clocks(library.manifest, point.p)
        self.rate, self.raw, self.taken = settings.sampling_rate, settings.raw, 0
        end = settings.samples / self.rate  # that of the last sample
        self.span = end / 2, end
        self.instant = [i for i, report in enumerate(library.manifest.reports) if report.quantity in INSTANT]
        self.held = no_rows(library)
        self.start: Vector | None = None
        self.teeth = Teeth(library, point.p)
        self.deepest = np.zeros(len(self.teeth.meshes))

    @cached_property
    def filter(self) -> BandFilter:
        """The filter."""
        return BandFilter(self.rate, self._start)

    @cached_property
    def averages(self) -> Averages:
        """The sums along the motion."""
        return Averages(self.span, self._start)

    @property
    def _start(self) -> Vector:
        """Return the outputs at time zero."""
        if self.start is None:
            raise RuntimeError("nothing was read yet")
        return self.start

    def read(self, block: Block, points: Points) -> Rows:
        """Take in a block, and the points up to its last sample; return the rows that are ready."""
        if self.start is None:
            self.start = _outputs(self.batch, self.clocks, _first(block))[0]
        self._note(points)
        index = self.taken + np.arange(len(block.time), dtype=np.int64)
        self.taken += len(index)
        values = self._values(block)
        self.held = join_rows([self.held, Rows(index, block.time, values, block.x, block.levels, block.steps)])
        return self._release(self.held.values if self.raw else self.filter.release())

    def finish(self) -> Rows:
        """Return the rows that were held back, once no more samples come."""
        if self.raw or self.start is None or not len(self.held.index):
            return self._release(self.held.values)
        return self._release(self.filter.finish(self.taken - 1, self.last - self.start))

    def statistics(self) -> Vector:
        """Return the outputs' statistics, see ``averages``, shape (5, n_y)."""
        return self.averages.statistics()

    def _note(self, points: Points) -> None:
        """Take points into filter and statistics."""
        if not len(points.time):
            return
        values = _outputs(self.batch, self.clocks, points)
        self.deepest = np.fmax(self.deepest, self.teeth.deepest(values))
        values -= self._start
        self.averages.take(points.time, points.weight, values)
        if not self.raw:
            self.filter.take(points.time, points.weight, values)

    def _values(self, block: Block) -> Vector:
        """Return what of the outputs is that of the instant; the last ones are kept for the end of the filter."""
        if self.raw or self.instant:
            values = _outputs(self.batch, self.clocks, block)
            self.last = values[-1].copy()
            return values
        self.last = _outputs(self.batch, self.clocks, _last(block))[0]
        return np.zeros((len(block.time), self.batch.width))

    def _release(self, values: Vector) -> Rows:
        """Return the rows whose values are known, and forget them."""
        count = len(values)
        rows = self.held[slice(0, count)]
        self.held = self.held[slice(count, None)]
        if not self.raw:
            instant = rows.values[:, self.instant]
            rows.values[:], rows.values[:, self.instant] = values, instant
        return rows

    def snapshot(self) -> Snapshot:
        """Return the state of the reader."""
        if self.start is None:
            return {}
        kept: Snapshot = {f"held.{name}": value for name, value in vars(self.held).items()}
        kept |= {"reader.taken": np.array(self.taken), "reader.start": self.start, "reader.last": self.last}
        kept |= {"reader.sums": self.averages.sums, "reader.deepest": self.deepest}
        return kept if self.raw else kept | {f"filter.{name}": value for name, value in self.filter.snapshot().items()}

    def restore(self, kept: Snapshot) -> None:
        """Resume from a snapshot."""
        if "reader.start" not in kept:
            return
        known: Any = kept
        self.taken, self.start, self.last = int(known["reader.taken"]), known["reader.start"], known["reader.last"]
        self.held = Rows(**_under("held.", known))
        self.averages.sums, self.deepest = known["reader.sums"].copy(), known["reader.deepest"]
        if not self.raw:
            self.filter.restore(_under("filter.", known))


def judge(reader: Reader, outcome: Outcome) -> Outcome:
    """Return an outcome whose status says so where a deflection went beyond a tooth."""
    wrong = reader.teeth.impossible(reader.deepest)
    return replace(outcome, status=f"{wrong}: not to be used") if wrong and outcome.status == "done" else outcome


def _under(head: str, kept: dict[str, Any]) -> dict[str, Any]:
    """Return what is kept under a heading."""
    return {name.removeprefix(head): value for name, value in kept.items() if name.startswith(head)}


def _first(block: Block) -> Block:
    """Return the first sample of a block."""
    return Block(**{name: value[:1] for name, value in vars(block).items()})


def _last(block: Block) -> Block:
    """Return the last sample of a block."""
    return Block(**{name: value[-1:] for name, value in vars(block).items()})


def motion_statistics(reader: Reader, outcome: Outcome) -> Statistics | None:
    """Return the statistics of a run that reached its end, extremes of mesh forces at the integrator's own steps.

    None if it did not: its second half, over which they are taken, is not whole.
    """
    if outcome.status != "done":
        return None
    values, columns = reader.statistics(), by_quantity(reader.batch.library).get("mesh_force", [])
    low, high = STATISTICS.index("min"), STATISTICS.index("max")
    if columns:
        values[low, columns] = np.fmin(values[low, columns], outcome.extremes.steady[0])
        values[high, columns] = np.fmax(values[high, columns], outcome.extremes.steady[1])
    return Statistics(values, reader.span)


def sampled(library: Library, path: Trajectory, p: Vector) -> Rows:
    """Evaluate the outputs of a whole trajectory at its samples, unfiltered."""
    values = outputs_of(library, Clocks(library.manifest, p), path)
    index = np.arange(len(path.time), dtype=np.int64)
    return Rows(index, path.time, values, path.x, path.levels, path.steps)
