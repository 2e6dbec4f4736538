"""Cluster: the workers of a Dask scheduler as a sweep's pool."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from distributed import Client, KilledWorker, WorkerPlugin
from ltcgear.generated.errors import LtcgearError

from .task import forget_plan, keep_plan

PATIENCE = 10
"""Seconds to wait for a scheduler, and for its first worker."""


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
        self.workers = sum(client.nthreads().values())

    @contextmanager
    def serve(self, name: str, data: bytes) -> Iterator[dict[str, Any]]:
        """Make a plan known to all workers."""
        plugin = KnowPlan(name, data)
        try:
            self.client.register_plugin(plugin)
        except Exception as error:  # whatever a worker raises that has no ltcgear
            raise LtcgearError(f"a worker cannot take the sweep: {error}; install ltcgear there as here") from error
        try:
            yield {"backend": "dask", "client": self.client}
        finally:
            self.client.unregister_worker_plugin(plugin.name)


@contextmanager
def connect(address: str) -> Iterator[Cluster]:
    """Connect to a scheduler.

    Raises
    ------
    LtcgearError
        If it cannot be reached, or has no workers.
    """
    start = "start one with `dask scheduler`, or leave --scheduler out to use this machine's processes"
    try:
        make: Any = Client  # which has no types
        client = make(address, timeout=PATIENCE, set_as_default=False)
    except (OSError, ValueError, RuntimeError, TypeError) as error:
        raise LtcgearError(f"--scheduler {address}: cannot be reached ({error}); {start}") from error
    with client:
        try:
            client.wait_for_workers(1, timeout=PATIENCE)
        except (OSError, TimeoutError) as error:
            raise LtcgearError(
                f"--scheduler {address}: has no workers; start them with `dask worker {address} --nthreads 1`"
            ) from error
        yield Cluster(client)
