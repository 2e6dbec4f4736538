"""Ensemble: many parameter sets through one compiled model, over all cores of one process.

Threads share the compiled C, which does not need the interpreter. Only the calling thread uses CasADi: it sets runs up
and concludes them, while other threads integrate.
"""

import math
import os
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor, wait
from dataclasses import asdict
from functools import partial
from typing import Any, Unpack

import numpy as np
from ltcgear.generated.errors import LtcgearError, MachineError
from numpy.typing import NDArray

from ..model.library import Library
from ..model.parameter_values import tell, value_faults
from ..results.attributes import to_attributes
from ..results.dataset import make_dataset
from ..results.result import Result
from ..results.samples import no_rows
from .choose_method import Choice
from .room import check_size
from .run_settings import RunOptions, RunSettings
from .sampling_rate import Rate
from .simulate import Run, list_settings
from .trajectory import Counts

Vector = NDArray[np.float64]
Told = Callable[[float], None]
AHEAD = 2
"""Runs set up in advance, per worker."""
LOOK = 0.1
"""Seconds between two reports of progress."""


def simulate_many(
    library: Library,
    sets: Iterable[Mapping[str, float]],
    *,
    attributes: Mapping[str, Any] | None = None,
    told: Told = lambda t: None,
    workers: int | None = None,
    **options: Unpack[RunOptions],
) -> Iterator[Result]:
    """Simulate a model with many parameter sets; each result is to the last bit that of ``simulate``.

    Results come in the order of the sets, on demand; a few runs are computed in advance. With ``erk`` (which ``auto``
    may choose) runs are parallel, with other methods one after the other. Ctrl-C stops all of them, and is raised.

    Parameters that are not listed are those of ``simulate``.

    Parameters
    ----------
    sets
        Parameter name -> value in SI, all parameters of the model in each.
    told
        Called, in the calling thread, with the time simulated so far, of all runs together [s].
    workers
        Number of parallel runs; by default the number of cores.

    Yields
    ------
    Result
        A failed run has the reason in ``summary["status"]``, and the samples computed until then, if any. The others
        go on.

    Raises
    ------
    LtcgearError
        If an option or a parameter set is wrong, before anything runs.
    """
    given, count = list(sets), _count_workers(workers)
    settings = RunSettings(**options).checked()
    if settings.verify:
        raise LtcgearError("verify: is for one run; leave it out, and verify one with simulate")
    _check_sets(library, given)
    if settings.rate is not None:
        check_size(library, settings.samples * min(len(given), AHEAD * count + 1))
    vectors = [library.parameters(values) for values in given]
    return _Ensemble(library, vectors, settings, attributes, told).results(count)


def _count_workers(workers: int | None) -> int:
    """Return the number of parallel runs."""
    if workers is None:
        return len(os.sched_getaffinity(0))
    if workers < 1:
        raise LtcgearError(f"workers {workers}: must be 1 at least; leave it out to use all cores")
    return workers


def _check_sets(library: Library, sets: Sequence[Mapping[str, float]]) -> None:
    """Refuse sets that lack a parameter, or hold one that the model does not have or that is not a number for it."""
    found = ((k, fault) for k, values in enumerate(sets) for fault in value_faults(library.manifest, values))
    tell([f"set {k}: {fault}" for k, fault in found], "parameter sets cannot be used")


class _StoppedError(Exception):
    """Ends a run whose result is no longer needed."""


class _Ensemble:
    """Runs of one model.

    No worker keeps a run after ``follow``: CasADi objects must be deleted in the thread that made them.
    """

    def __init__(
        self, library: Library, vectors: Sequence[Vector], settings: RunSettings,
        attributes: Mapping[str, Any] | None, told: Told,
    ) -> None:  # fmt: skip
        self.library, self.vectors, self.settings = library, vectors, settings
        self.attributes, self.told = attributes, told
        self.runs: dict[int, Run] = {}
        self.refused: dict[int, LtcgearError] = {}
        self.reached = [0.0] * len(vectors)
        self.stopped = False

    def results(self, workers: int) -> Iterator[Result]:
        """Yield the results in order."""
        waiting: deque[tuple[int, Future[None] | None]] = deque()
        with ThreadPoolExecutor(workers, thread_name_prefix="ltcgear") as pool:
            try:
                for k in range(len(self.vectors)):
                    waiting.append((k, self._start(k, pool)))
                    if len(waiting) > AHEAD * workers:
                        yield self._result(*waiting.popleft())
                while waiting:
                    yield self._result(*waiting.popleft())
            finally:
                self.stopped = True
                pool.shutdown(cancel_futures=True)

    def _start(self, k: int, pool: ThreadPoolExecutor) -> Future[None] | None:
        """Set a run up and let a worker follow it; one that needs CasADi all the time is followed here and now."""
        try:
            run = self.runs[k] = Run(self.library, self.vectors[k], self.settings)
        except MachineError:
            raise
        except LtcgearError as error:
            self.refused[k] = error
            return None
        if run.settings.integrator.in_march:
            return pool.submit(self._follow, k, self._note)
        self._follow(k, self._tell)
        if run.integration.status.startswith("interrupted"):
            raise KeyboardInterrupt
        return None

    def _follow(self, k: int, told: Callable[[int, float], None]) -> None:
        """Follow a run to its end."""
        self.runs[k].follow(partial(told, k))

    def _tell(self, k: int, time: float) -> None:
        """Report the progress of all runs, one of which has reached a time."""
        self.reached[k] = min(time, self.settings.t_end)
        self.told(sum(self.reached))

    def _note(self, k: int, time: float) -> None:
        """Note how far a run is; stop it if nobody waits for it."""
        if self.stopped:
            raise _StoppedError
        self.reached[k] = min(time, self.settings.t_end)

    def _result(self, k: int, future: Future[None] | None) -> Result:
        """Wait for a run and conclude it."""
        if k in self.refused:
            dataset, summary = self._nothing(k, self.refused.pop(k))
        else:
            while future is not None and wait([future], LOOK).not_done:
                self.told(sum(self.reached))
            if future is not None:
                future.result()
            dataset, summary = self.runs.pop(k).conclude()
        self._tell(k, self.settings.t_end)
        dataset.attrs |= to_attributes(self.attributes, summary)
        return Result(dataset, summary)

    def _nothing(self, k: int, error: LtcgearError) -> tuple[Any, dict[str, Any]]:
        """Return data and summary of a run that could not begin."""
        given = self.settings
        choice, sampling = Choice(given.method, None), Rate(given.rate or math.nan, None)
        settings = list_settings(self.library, choice, given.rtol, sampling, given.raw)
        counts = asdict(Counts()) | {"expected_events": 0}
        summary = settings | {"status": str(error), "simulated_s": 0.0, "counts": counts, "forces": {}, "seconds": {}}
        return make_dataset(self.library, self.vectors[k], no_rows(self.library)), summary | {"warnings": []}
