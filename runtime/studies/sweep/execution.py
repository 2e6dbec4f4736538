"""Execution of a sweep's points by local processes (joblib) or a cluster; dead workers are replaced."""

import re
import signal
import warnings
from collections.abc import Generator, Iterator, Sequence
from concurrent.futures.process import BrokenProcessPool
from contextlib import AbstractContextManager, closing, contextmanager
from typing import Any, Protocol

from ltcgear.generated.errors import LtcgearError

from .design import INSTALL
from .faults import is_crash
from .task import Plan, PointOutcome, forget_plan, keep_plan, run_point, start_process

DIED = "the process died that computed this point, twice; {}"
KILLED = "killed"
"""Status of a point whose process was killed from outside, twice."""
SIGNAL = re.compile(r"([A-Z]+)\(-?\d+\)")
"""How joblib reports what ended a process."""


class Pool(Protocol):
    """Where points are computed.

    Attributes
    ----------
    workers
        How many are computed at a time.
    deaths
        Exceptions by which a dead worker shows.
    """

    workers: int
    deaths: tuple[type[Exception], ...]

    def serve(self, name: str, data: bytes) -> AbstractContextManager["Server"]:
        """Make a plan known to all workers, as long as the context lasts; give what computes its points."""


class Server(Protocol):
    """Computes points of a plan that all workers know."""

    def run(self, name: str, points: Sequence[int], begun: list[int]) -> Generator[PointOutcome, None, None]:
        """Yield outcomes as they come; note the points that are on their way to a worker."""


class Processes:
    """Processes of this machine; one alone is the process that calls.

    Parameters
    ----------
    workers
        How many.
    """

    deaths: tuple[type[Exception], ...] = (BrokenProcessPool,)

    def __init__(self, workers: int) -> None:
        self.workers = workers

    @contextmanager
    def serve(self, name: str, data: bytes) -> Iterator["Joblib"]:
        """Make a plan known to all workers."""
        if self.workers == 1:
            keep_plan(name, data)
            try:
                yield Joblib({"backend": "sequential"})
            finally:
                forget_plan(name)
            return
        # The matrices are small: threads of the linear algebra would only wait for each other.
        start = {"initializer": start_process, "initargs": (name, data), "inner_max_num_threads": 1}
        yield Joblib({"backend": "loky", "n_jobs": self.workers, **start})


class Joblib:
    """Joblib's pool.

    Parameters
    ----------
    settings
        Its backend, as ``joblib.parallel_config`` takes it.
    """

    def __init__(self, settings: dict[str, Any]) -> None:
        self.settings = settings

    def run(self, name: str, points: Sequence[int], begun: list[int]) -> Generator[PointOutcome, None, None]:
        """Yield outcomes as they come; note the points that are on their way to a worker."""
        from joblib import Parallel, delayed, parallel_config

        def tasks() -> Iterator[Any]:
            for point in points:
                begun.append(point)
                yield delayed(run_point)(name, point)

        with parallel_config(**self.settings):
            parallel = Parallel(return_as="generator_unordered")
        with _without_interrupts():
            started = parallel(tasks())
        with closing(started) as outcomes, warnings.catch_warnings():
            warnings.filterwarnings("ignore", module="joblib", category=UserWarning)  # about points nobody waits for
            yield from outcomes


def check_joblib() -> None:
    """Refuse a sweep where joblib is missing."""
    try:
        import joblib  # noqa: F401
    except ModuleNotFoundError as error:
        raise LtcgearError(f"sweeps need joblib: {INSTALL}") from error


def compute_points(plan: Plan, points: Sequence[int], pool: Pool) -> Iterator[PointOutcome]:
    """Compute points and yield them as they finish.

    Where a worker dies, the points that were under way are computed again one by one, so that the one that kills its
    worker is known. One that crashes it gets a reason in place of numbers; one whose worker is killed from outside, as
    where memory runs out, is `KILLED`, which is no row. All others go on.
    """
    name, data = plan.pack()
    with pool.serve(name, data) as server:
        left = dict.fromkeys(points)
        while left:
            begun: list[int] = []
            try:
                with closing(server.run(name, list(left), begun)) as outcomes:
                    for outcome in outcomes:
                        del left[outcome.point]
                        yield outcome
            except pool.deaths:
                for point in [point for point in begun if point in left]:
                    del left[point]
                    yield _run_alone(server, name, point, pool.deaths)


def _run_alone(server: Server, name: str, point: int, deaths: tuple[type[Exception], ...]) -> PointOutcome:
    """Compute a point while no other is under way."""
    try:
        [outcome] = server.run(name, [point], [])
    except deaths as error:
        signals = SIGNAL.findall(str(error))
        return PointOutcome(point, DIED.format(", ".join(sorted(set(signals)))) if is_crash(signals) else KILLED)
    return outcome


@contextmanager
def _without_interrupts() -> Iterator[None]:
    """Block Ctrl-C while processes start: they inherit this and leave it to the main process."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
