"""Integration: segments of smooth motion between switching instants, sampled on a uniform grid."""

from collections.abc import Callable
from time import perf_counter

import numpy as np
from ltcgear.generated.errors import SolverError
from numpy.typing import NDArray

from ..model.blas import single_threaded
from ..model.contact_levels import levels_of
from ..model.load_tables import Signals
from ..model.operating_point import OperatingPoint
from ..results.checkpoint import Snapshot
from .driver import March
from .interrupt import Interrupt
from .methods.registry import EXHAUSTED
from .run_settings import RunSettings, check_length
from .sampling import Samples
from .trajectory import Block, Outcome, Points, Told

Vector = NDArray[np.float64]
Push = Callable[[Block, Points], None]
CURE = "try another --method or a larger --rtol, and look at the last samples for a member that runs away"
MARK_SECONDS, SLICE = 2.0, 0.05
"""Seconds between two checkpoints of a run; seconds after which the C returns to check for an interrupt."""


class Integration:
    """An integration in progress, which passes on its samples.

    Parameters
    ----------
    point
        The operating point where the motion starts.
    settings
        Settings, method and sampling rate chosen.
    passing
        See ``driver.March``.

    Raises
    ------
    SolverError
        If the method cannot be set up.
    LtcgearError
        If the run is shorter than one sample, or would take more than an hour and was not asked to.
    """

    @single_threaded()
    def __init__(self, point: OperatingPoint, settings: RunSettings, *, passing: float | None = None) -> None:
        clock, method, rate = perf_counter(), settings.method, settings.sampling_rate
        check_length(settings.t_end * rate)
        self.signals = Signals(point.library.manifest.signals, settings.tables or {})
        self.stopped = f"{method} stopped at t = {{:.6g}} s (rtol {settings.rtol:g})"
        try:
            self.march = March(point, settings, self.signals, passing=passing)
        except RuntimeError as error:
            raise SolverError(f"{method} cannot be set up: {str(error).splitlines()[-1]}") from error
        self.push: Push = lambda block, points: None
        self.status = self.cause = ""
        self.samples = Samples(self.march, settings.samples, rate, self._push)
        self.seconds = {"prepare": perf_counter() - clock, "integrate": 0.0, "outputs": 0.0}
        self.clock = perf_counter()

    def proceed(self, push: Push, told: Told = lambda t: None, mark: Callable[[], None] = lambda: None) -> Outcome:
        """Integrate to the end: ``follow``, then ``conclude``."""
        self.follow(push, told, mark)
        return self.conclude()

    def follow(self, push: Push, told: Told = lambda t: None, mark: Callable[[], None] = lambda: None) -> None:
        """Integrate to the end; with ``erk`` nothing of CasADi is touched, so that another thread may do it.

        Parameters
        ----------
        push
            Takes the samples, block by block, and the points up to each block's last sample.
        told
            Called with the simulated time now and then.
        mark
            Called at the start, now and then, and when Ctrl-C stops the run, between two segments and with all samples
            handed on: a ``snapshot`` is whole then.
        """
        self.push, self.clock = push, perf_counter()
        with Interrupt() as interrupt:
            self.status = self._proceed(told, mark, interrupt)
        self.samples.flush()
        self._tick("integrate")

    def conclude(self) -> Outcome:
        """Return the status; a number of switchings other than by kinematics is a failure."""
        march, events, status = self.march, self.march.counts.events, self.status
        if self.cause:
            status += f": {march.explain_failure() or f'{self.cause}; {CURE}'}"
        expected = march.expected_events()
        if status == "done" and expected != events:
            status = f"{events} stiffness switchings, not the {expected} of kinematics: not to be used"
        signals = self.signals.at(march.time)
        energy = march.first_energy, march.energy(march.z, march.cells, signals)
        x, s = march.frame.origin + march.frame.scale * march.z, np.concatenate([levels_of(march.cells), signals])
        end = min(march.time, self.samples.end)
        return Outcome(
            march.state.work, march.state.jump_energy, energy, march.counts, expected, march.extremes, status, end,
            (x, s, march.p.copy()), self.seconds,
        )  # fmt: skip

    def snapshot(self) -> Snapshot:
        """Return a snapshot from which the integration can be resumed exactly."""
        self._tick("integrate")
        kept = {f"seconds.{name}": np.array(value) for name, value in self.seconds.items()}
        return self.march.snapshot() | kept | self.samples.snapshot()

    def restore(self, kept: Snapshot) -> None:
        """Resume from a snapshot."""
        self.march.restore(kept)
        self.samples.restore(kept)
        for name in self.seconds:
            self.seconds[name] += float(kept[f"seconds.{name}"])

    def _proceed(self, told: Told, mark: Callable[[], None], interrupt: Interrupt) -> str:
        """Integrate segment by segment to the end; return ``done``, or why it stopped and what to try."""
        shown, marked, march, samples = 0.0, -np.inf, self.march, self.samples
        while not samples.complete:
            if interrupt.pulled or perf_counter() - marked > MARK_SECONDS:
                samples.flush()
                mark()
                marked = perf_counter()
            if interrupt.pulled:
                return f"interrupted at t = {march.time:.6g} s"
            try:
                march.proceed(SLICE)
            except RuntimeError as error:
                if EXHAUSTED in str(error):
                    raise MemoryError from error
                self.cause = str(error).strip().splitlines()[-1][:200]
                return self.stopped.format(march.time)
            finally:
                samples.take()
            now = perf_counter()
            if now - shown > 0.1:
                shown = now
                told(march.time)
        return "done"

    def _push(self, block: Block, points: Points) -> None:
        """Hand a block on."""
        self._tick("integrate")
        self.push(block, points)
        self._tick("outputs")

    def _tick(self, stage: str) -> None:
        """Book the time since the last tick."""
        now = perf_counter()
        self.seconds[stage] += now - self.clock
        self.clock = now
