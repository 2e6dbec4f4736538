"""Measurement of every method at every tolerance: errors and counts first, then times in turns."""

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field
from functools import partial
from time import perf_counter
from typing import Any

import numpy as np
from ltcgear.generated.errors import LtcgearError, MachineError

from ...model.function import Kernel
from ...model.phase_wrapping import Clocks
from ...simulation.output_reader import outputs_of
from ..selftest.case import Bench
from .patience import OutOfTimeError, Patience
from .reference import Reference
from .run_errors import Errors, find_errors, take_samples

ROUNDS = 7
"""Timed runs of a point, besides the first."""
BATCH, BLOCKS = 32, 40
"""Right-hand sides per timed call from Python, and number of calls; the least time counts."""
Told = Callable[[float], None]


@dataclass
class Point:
    """A method at a tolerance.

    ``integrator`` and ``user`` are seconds of its timed runs, without samples and with all samples and their outputs;
    ``first`` those of the run that gave the errors. ``reason`` says why there is none.
    """

    method: str
    rtol: float
    reason: str | None = None
    errors: Errors = field(default_factory=dict)
    trusted: bool = False
    counts: dict[str, int] = field(default_factory=dict)
    first: float = np.inf
    integrator: list[float] = field(default_factory=list)
    user: list[float] = field(default_factory=list)

    def to_json(self, t_end: float) -> dict[str, Any]:
        """Return it as the record has it; ``seconds`` is the least time of the integrator."""
        shown: dict[str, Any] = {
            "method": self.method, "rtol": self.rtol, "reason": self.reason, "errors": self.errors,
            "trusted": self.trusted, "counts": self.counts, "seconds": None, "rounds": len(self.integrator),
        }  # fmt: skip
        if self.reason is None:
            seconds = min(self.integrator, default=self.first)
            shown |= {
                "seconds": seconds,
                "integrator": _spread(self.integrator or [self.first]),
                "user": _spread(self.user) if self.user else None,
                "ns_call": 1e9 * seconds / max(self.counts["rhs"], 1),
                "real_time_factor": t_end / seconds,
            }
        return shown


def _spread(seconds: list[float]) -> dict[str, float]:
    """Return least and median."""
    return {"min": min(seconds), "median": float(np.median(seconds))}


@dataclass(frozen=True)
class Sweep:
    """What is run: methods and tolerances over a time [s] at a rate [Hz], and the time that it may take [s]."""

    methods: Sequence[str]
    rtols: Sequence[float]
    t_end: float
    rate: float
    patience: Patience
    budget: float

    def measure(self, bench: Bench, reference: Reference, told: Told = lambda done: None) -> list[Point]:
        """Run all points.

        Parameters
        ----------
        bench
            Model, parameters, start.
        reference
            What they are compared with; without samples there are no errors.
        told
            Called with the share that is done.
        """
        points = [Point(method, rtol) for method in self.methods for rtol in sorted(self.rtols, reverse=True)]
        spent: dict[str, str] = {}
        for done, point in enumerate(points):
            self._try(bench, reference, point, spent)
            told(0.7 * (done + 1) / len(points))
        timed = choose_timed(points, self.budget)
        for turn in range(ROUNDS):
            timed = [point for point in timed if self._time(bench, point)]
            told(0.7 + 0.3 * (turn + 1) / ROUNDS)
        return points

    def _try(self, bench: Bench, reference: Reference, point: Point, spent: dict[str, str]) -> None:
        """Find a point's errors and counts; looser tolerances of a method that took too long are in ``spent``."""
        if point.method in spent:
            point.reason = spent[point.method]
            return
        try:
            path = self.patience.run(bench, point.method, point.rtol, t_end=self.t_end, rate=self.rate)
        except MachineError:
            raise
        except LtcgearError as error:
            point.reason = str(error)
            if isinstance(error, OutOfTimeError):
                spent[point.method] = f"not run, since rtol {point.rtol:g} took {point.reason}"
            return
        point.counts, point.first = asdict(path.counts), path.seconds["integrate"]
        if reference.samples is not None:
            point.errors = find_errors(reference.samples, take_samples(bench, path))
            point.trusted = reference.trusts(point.errors)

    def _time(self, bench: Bench, point: Point) -> bool:
        """Run a point once without samples, and once with samples and outputs; False, and no times, if it fails."""
        run = partial(Patience(np.inf).run, bench, point.method, point.rtol, t_end=self.t_end)
        try:
            point.integrator.append(run(rate=1 / self.t_end).seconds["integrate"])
            path = run(rate=self.rate)
        except MachineError:
            raise
        except LtcgearError:
            point.integrator.clear()
            point.user.clear()
            return False
        clock = perf_counter()
        outputs_of(bench.library, Clocks(bench.library.manifest, bench.p), path)
        point.user.append(path.seconds["integrate"] + perf_counter() - clock)
        return True


def choose_timed(points: Sequence[Point], budget: float) -> list[Point]:
    """Return the points that are run again: from the cheapest on, as many as the time [s] allows."""
    ran = sorted((point for point in points if point.reason is None), key=lambda point: point.first)
    spent = np.cumsum([2 * ROUNDS * point.first for point in ran])
    chosen = {id(point) for point, sum_ in zip(ran, spent, strict=True) if sum_ <= budget}
    return [point for point in points if id(point) in chosen]


def time_call(bench: Bench) -> float:
    """Return the least time of one right-hand side [ns]."""
    batch = Kernel(bench.library.functions["rhs"].map(BATCH))
    for array, value in zip(batch.arguments, (bench.at.x, bench.at.s, bench.p), strict=True):
        array[:] = np.tile(value, BATCH)
    times = []
    for _ in range(BLOCKS):
        clock = perf_counter()
        batch.evaluate()
        times.append(perf_counter() - clock)
    return 1e9 * min(times) / BATCH
