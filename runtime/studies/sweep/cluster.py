"""Dask cluster: its workers as a sweep's pool."""

import logging
import re
from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import contextmanager, suppress
from itertools import islice
from typing import Any

from distributed import CancelledError, Client, KilledWorker, WorkerPlugin, wait
from distributed.client import ClosedClientError
from ltcgear.generated.errors import LtcgearError

from ...results.terminal import tell
from .task import PointOutcome, forget_plan, keep_plan, run_point

PATIENCE = 10
"""Seconds to wait for a scheduler, for its first worker, and for a point before one looks whether there are workers."""
AHEAD = 2
"""Points under way for each thread of the cluster, so that no worker waits for its next."""
ADDRESS = re.compile(r"((tcp|tls|ws)://)?([\w.-]+|\[[0-9A-Fa-f:.]+\]):\d{1,5}/?")
"""What a scheduler's address looks like; those of tls take their certificates from Dask's configuration."""
LOST = (OSError, CancelledError, ClosedClientError)
"""Exceptions by which a lost scheduler shows."""


class KnowPlan(WorkerPlugin):
    """Makes a plan known to every worker of a cluster, those that join later too.

    Parameters
    ----------
    name, data
        The plan, as ``Plan.pack`` gives it.
    """

    def __init__(self, name: str, data: bytes) -> None:
        self.name, self.data = f"ltcgear-{name}", data
        self.plan = name

    def setup(self, worker: Any) -> None:  # noqa: ANN401
        """Make the plan known to a worker."""
        keep_plan(self.plan, self.data)

    def teardown(self, worker: Any) -> None:  # noqa: ANN401
        """Let a worker forget it."""
        forget_plan(self.plan)


class Cluster:
    """The workers of a Dask scheduler.

    Parameters
    ----------
    client
        Connection to the scheduler.
    """

    deaths: tuple[type[Exception], ...] = (KilledWorker,)

    def __init__(self, client: Any) -> None:  # noqa: ANN401
        self.client = client
        self.address = client.scheduler.address
        self.workers = sum(client.nthreads().values())
        self.warned = False

    @contextmanager
    def serve(self, name: str, data: bytes) -> Iterator["Cluster"]:
        """Make a plan known to all workers, those that join later too."""
        plugin = KnowPlan(name, data)
        with self._told_if_lost():
            try:
                self.client.register_plugin(plugin)
            except LOST:
                raise
            except Exception as error:  # whatever a worker raises that has no ltcgear
                raise LtcgearError(f"a worker cannot take the sweep: {error}; install ltcgear there as here") from error
        try:
            yield self
        finally:
            self._clear(lambda: self.client.unregister_worker_plugin(plugin.name))

    def run(self, name: str, points: Sequence[int], begun: list[int]) -> Generator[PointOutcome, None, None]:
        """Yield outcomes as they come; note the points that are on their way to a worker.

        Raises
        ------
        LtcgearError
            If the scheduler is lost.
        """
        left, under_way = iter(points), set[Any]()
        try:
            with self._told_if_lost():
                while True:
                    room = AHEAD * max(1, sum(self.client.nthreads().values())) - len(under_way)
                    for point in islice(left, max(0, room)):
                        begun.append(point)
                        under_way.add(self.client.submit(run_point, name, point, pure=False))
                    if not under_way:
                        return
                    done = self._wait(under_way)
                    under_way -= done
                    for future in sorted(done, key=lambda future: bool(future.status == "error")):
                        yield future.result()
        finally:
            self._clear(lambda: self.client.cancel(list(under_way)))

    def _wait(self, under_way: set[Any]) -> set[Any]:
        """Return the finished points, at least one; report once if there are no workers."""
        first: Any = wait  # which has no types
        while True:
            with suppress(TimeoutError), self.client.as_current():
                return set(first(under_way, timeout=PATIENCE, return_when="FIRST_COMPLETED").done)
            if not self.warned and not self.client.nthreads():
                self.warned = True
                start = f"start some with `dask worker {self.address} --nthreads 1`; Ctrl-C keeps the rows"
                tell(f"warning: the cluster has no workers left, the sweep waits; {start}")

    def _clear(self, away: Callable[[], Any]) -> None:
        """Clear up what a scheduler has, unless it is lost."""
        if self.client.status == "running":
            with suppress(*LOST):
                away()

    @contextmanager
    def _told_if_lost(self) -> Iterator[None]:
        """Return the message of a lost scheduler, with how to resume."""
        try:
            yield
        except LOST as error:
            raise LtcgearError(
                f"the scheduler {self.address} is lost ({type(error).__name__}); "
                "rows are kept, the same command goes on"
            ) from error


@contextmanager
def connect(address: str) -> Iterator[Cluster]:
    """Connect to a scheduler.

    Raises
    ------
    LtcgearError
        If it cannot be reached, or has no workers.
    """
    start = "start one with `dask scheduler`, or leave --scheduler out to use this machine's processes"
    if not ADDRESS.fullmatch(address):  # which Dask would tell after a while, in tracebacks
        raise LtcgearError(f"--scheduler {address}: is no address such as tcp://10.0.0.5:8786; {start}")
    try:
        make: Any = Client  # which has no types
        client = make(address, timeout=PATIENCE, set_as_default=False)
    except (OSError, ValueError, RuntimeError, TypeError) as error:
        raise LtcgearError(f"--scheduler {address}: cannot be reached ({error}); {start}") from error
    with _quiet(), client:
        try:
            client.wait_for_workers(1, timeout=PATIENCE)
        except (OSError, TimeoutError) as error:
            raise LtcgearError(
                f"--scheduler {address}: has no workers; start them with `dask worker {address} --nthreads 1`"
            ) from error
        yield Cluster(client)


@contextmanager
def _quiet() -> Iterator[None]:
    """Keep Dask from telling in tracebacks what is told in a line."""
    log = logging.getLogger("distributed.client")
    before = log.level
    log.setLevel(logging.CRITICAL)
    try:
        yield
    finally:
        log.setLevel(before)
