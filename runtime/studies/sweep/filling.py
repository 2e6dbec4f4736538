"""Filling of a sweep: its missing points are computed and stored."""

from collections.abc import Iterator, Sequence
from functools import partial

from ltcgear.generated.errors import LtcgearError, MachineError

from .execution import KILLED, Pool, compute_points
from .faults import is_machines, stopped_by_machine
from .planning import Told, prepare
from .sweep_file import GO_ON, Store
from .task import UNBUILT, Plan, PointOutcome, find_places

SKIPPED = "left out by --skip"
"""Status of a point that was not to be computed."""
MOST_KILLED = 8
"""Points whose processes are killed from outside after which a sweep stops."""


def fill(plan: Plan, store: Store, pool: Pool, told: Told) -> None:
    """Compute the missing points and add their rows.

    Raises
    ------
    MachineError
        If the machine fails, at once, or if processes were killed from outside, once all other points are done.
    """
    missing, killed = store.missing(), list[int]()
    while missing:
        unbuilt: list[int] = []
        for outcome in _outcomes(plan, missing, pool, store):
            if outcome.status == UNBUILT:
                unbuilt.append(outcome.point)
                continue
            if outcome.status == KILLED:
                killed.append(outcome.point)
                if len(killed) == MOST_KILLED:
                    raise _told_killed(killed, store)
                continue
            store.add(outcome)
            told("simulate", len(store.done), plan.design.size, store.failed)
        with stopped_by_machine(partial(_advise, store)):
            missing = [point for point in unbuilt if not _build_late(plan, store, point)]
        if unbuilt:
            told("simulate", len(store.done), plan.design.size, store.failed)
    if killed:
        raise _told_killed(killed, store)


def _outcomes(plan: Plan, points: Sequence[int], pool: Pool, store: Store) -> Iterator[PointOutcome]:
    """Compute points; where the machine fails, say what is kept."""
    with stopped_by_machine(partial(_advise, store)):
        yield from compute_points(plan, points, pool)


def _advise(store: Store) -> str:
    """Say what to do where the machine failed."""
    return f"no fault of the model: mend it and {GO_ON}, or leave a point out with --skip; {_kept(store)}"


def _kept(store: Store) -> str:
    """Say how many rows are kept."""
    return f"{len(store.done)} of {store.design.size} rows are kept"


def _told_killed(killed: Sequence[int], store: Store) -> MachineError:
    """Say which points' processes were killed."""
    points = ", ".join(store.design.tell(point) for point in killed)
    skip = " ".join(f"--skip {point}" for point in killed)
    return MachineError(
        f"{points}: the process was killed from outside, twice, as where memory runs out; see that there is memory or "
        f"give fewer --workers, and {GO_ON}, or leave out what cannot be computed with {skip}; {_kept(store)}"
    )


def _build_late(plan: Plan, store: Store, point: int) -> bool:
    """Build the variant of a point whose structure neither lists nor ends of axes show; say whether that failed."""
    changes = plan.design.changes(point)
    key = plan.maker.make(changes)[0]
    if key in plan.models:
        return False
    try:
        artifact, row, _ = prepare(plan.maker, changes, plan.metrics, plan.settings)
        find_places(row, plan.form)
    except LtcgearError as error:
        if is_machines(error):
            raise
        store.add(PointOutcome(point, str(error)))
        return True
    plan.models[key], plan.rows[key] = artifact, row
    return False
